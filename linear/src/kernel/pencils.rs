//! Eigenvalues of many small symmetric pencils K - lambda M side by side, one in each lane, with a bound of their errors. In: matrices
//! that are polynomials in one number, or linear in several. Out: for each case the eigenvalues, or nothing where M is not certainly
//! positive definite.
//! See docs/method/studies.md#many-small-pencils.

mod lanes;

use crate::base::{Ball, Power};
use crate::kernel::bounded::{Bounded, load};
use crate::kernel::simd::simd;
use lanes::{congruent, derivative, floor, reduce, sort, turn, vectors};

/// The most coordinates: larger pencils are reduced faster by other means.
pub const MOST: usize = 16;

/// The unit roundoff.
const U: f64 = f64::EPSILON / 2.0;

/// K(d) = `k[0]` + d `k[1]` + d^2 `k[2]` + ... and M(d) with as many; symmetric, row by row.
#[derive(Clone, Debug)]
pub struct Line {
    pub n: usize,
    k: Vec<Vec<f64>>,
    m: Vec<Vec<f64>>,
    /// Bounds of the distance (Frobenius) of the true K and M at d from the computed ones, as polynomials in |d|.
    off: [Vec<f64>; 2],
    /// Bounds of the first three derivatives (Frobenius) of the computed K and M, for all d up to the largest size.
    slopes: [[f64; 3]; 2],
}

/// The coefficients of a matrix that is a polynomial.
type Coefficients<'a> = &'a [Vec<Vec<Ball>>];

/// The eigenvalues of one pencil.
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenvalues {
    /// Ascending.
    pub list: Vec<f64>,
    /// Bounds of their errors, each of the one with the same place in ascending order.
    pub bounds: Vec<f64>,
}

impl Line {
    /// From enclosures of the coefficients of both matrices, for numbers up to a size. `None` if the numbers are not of a size at which
    /// nothing underflows.
    pub fn new(n: usize, k: Coefficients, m: Coefficients, most: f64) -> Option<Line> {
        let sizes: Vec<f64> = (0..k.len().max(m.len())).map(|at| most.power(at as i32)).collect();
        // The rounding of the power of d, and those on the way of this coefficient to the entry at d.
        let (numbers, off) = scale_coefficients(n, [k, m], &sizes, |at| [at.max(1) as f64, at as f64 + 2.0])?;
        let slopes = numbers.each_ref().map(|parts| [1, 2, 3].map(|order| slope(n, parts, most, order)));
        let [k, m] = numbers;
        Some(Line { n, k, m, off, slopes })
    }

    /// The eigenvalues for each d, which may be [`ROUNDING_OF_D`] off, with bounds that hold for all numbers within `half` of it (as many as
    /// d, none of them beyond the size given at first): ascending, each bound of the one with the same place in ascending order; NaN where
    /// they are not certain.
    pub fn side_by_side(&self, d: &[f64], half: &[f64]) -> Bounded {
        let mut found = Bounded::unknown(self.n, d.len());
        let at = At::Powers { d, half };
        all(self.n, [&self.k, &self.m], [&self.off[0], &self.off[1]], self.slopes, at, d.len(), &mut found);
        found
    }

    /// The same for each d; `None` where they are not certain.
    pub fn eigenvalues(&self, d: &[f64], half: &[f64]) -> Vec<Option<Eigenvalues>> {
        let found = self.side_by_side(d, half);
        let of_case = |case: usize| {
            let (list, bounds): (Vec<f64>, Vec<f64>) = (0..self.n).map(|i| found.pair(i, case).into()).unzip();
            list.iter().all(|x| !x.is_nan()).then_some(Eigenvalues { list, bounds })
        };
        (0..d.len()).map(of_case).collect()
    }
}

/// K = `k[0]` + x `k[1]` + y `k[2]` + ... of several numbers x, y, ..., and M with as many.
#[derive(Clone, Debug)]
pub struct Plane {
    n: usize,
    k: Vec<Vec<f64>>,
    m: Vec<Vec<f64>>,
    /// Bounds of the distance (Frobenius) of the true K and M from the computed ones: the first, and what is to be multiplied by the size
    /// of each number.
    off: [Vec<f64>; 2],
}

impl Plane {
    /// From enclosures of the coefficients, for numbers up to these sizes; `None` as for [`Line::new`].
    pub fn new(n: usize, k: Coefficients, m: Coefficients, most: &[f64]) -> Option<Plane> {
        let sizes = [&[1.0], most].concat();
        // Each number may be off, and each product is rounded, and every sum behind it.
        let roundings = sizes.len() as f64 + 2.0;
        let ([k, m], off) = scale_coefficients(n, [k, m], &sizes, |_| [1.0, roundings])?;
        Some(Plane { n, k, m, off })
    }

    /// The eigenvalues for each case, with bounds as those of [`Line::side_by_side`]. `numbers` has a list for each number, with that of
    /// each case, which may be [`ROUNDING_OF_D`] off.
    pub fn side_by_side(&self, numbers: &[Vec<f64>]) -> Bounded {
        let cases = numbers.first().map_or(0, Vec::len);
        let mut found = Bounded::unknown(self.n, cases);
        let off = [&self.off[0][..], &self.off[1][..]];
        all(self.n, [&self.k, &self.m], off, [[0.0; 3]; 2], At::Each(numbers), cases, &mut found);
        found
    }
}

/// The places of the cases.
#[derive(Clone, Copy)]
enum At<'a> {
    /// Powers of the number of a case, and half of the width of the range about it.
    Powers { d: &'a [f64], half: &'a [f64] },
    /// Several numbers, each for all cases.
    Each(&'a [Vec<f64>]),
}

/// The coefficients of two matrices, and bounds of the distances of theirs from the true ones.
type Scaled = ([Vec<Vec<f64>>; 2], [Vec<f64>; 2]);

/// The coefficients of K and M in binary64, scaled by powers of two to a diagonal of M near one. `sizes`: the largest of what each coefficient
/// is multiplied by, the first of which is one; `roundings`: how many times that may be [`ROUNDING_OF_D`] off, and how many roundings there
/// are on the way to an entry. `None` if the numbers are not of a size at which nothing underflows.
fn scale_coefficients(
    n: usize,
    [k, m]: [Coefficients; 2],
    sizes: &[f64],
    roundings: impl Fn(usize) -> [f64; 2],
) -> Option<Scaled> {
    let none = vec![vec![Ball::ZERO; n]; n];
    let mass = |i: usize| m.iter().zip(sizes).map(|(part, size)| part[i][i].magnitude() * size).sum::<f64>();
    let scale: Vec<f64> = (0..n).map(|i| power_near(mass(i).sqrt())).collect::<Option<_>>()?;
    let split = |part: &[Vec<Ball>], at: usize| {
        let (mut numbers, mut off, mut size) = (Vec::with_capacity(n * n), 0.0, 0.0);
        for at in 0..n * n {
            let entry = times_power(part[at / n][at % n], scale[at / n] * scale[at % n]);
            let rounded = entry.to_f64();
            let away = (entry - Ball::from(rounded)).magnitude();
            off += away * away;
            size += rounded * rounded;
            numbers.push(rounded);
        }
        let (off, size) = (root(off), root(size));
        let is_usual = size * sizes[at] == 0.0 || is_usual(size) && is_usual(size * sizes[at]);
        let [of_number, on_the_way] = roundings(at);
        let off = (off + of_number * ROUNDING_OF_D * (size + off) + on_the_way * U * size) * 1.001;
        is_usual.then_some((numbers, off + UNDERFLOW))
    };
    let parts = |list: Coefficients| {
        let parts = (0..sizes.len()).map(|at| split(list.get(at).unwrap_or(&none), at));
        Some(parts.collect::<Option<Vec<_>>>()?.into_iter().unzip::<Vec<f64>, f64, Vec<_>, Vec<_>>())
    };
    let ((k, off_k), (m, off_m)) = (parts(k)?, parts(m)?);
    Some(([k, m], [off_k, off_m]))
}

/// A bound of a derivative of a polynomial of matrices, at all numbers up to a size: that of the sizes of its
/// coefficients.
fn slope(n: usize, parts: &[Vec<f64>], most: f64, order: usize) -> f64 {
    let factor = |at: usize| (at + 1 - order..=at).product::<usize>() as f64;
    let entry = |i: usize| {
        let terms = parts.iter().enumerate().skip(order);
        terms.map(|(at, part)| factor(at) * part[i].abs() * most.power((at - order) as i32)).sum::<f64>()
    };
    root((0..n * n).map(|i| entry(i) * entry(i)).sum::<f64>()) * 1.001 + UNDERFLOW
}

/// The relative error that d may have.
pub const ROUNDING_OF_D: f64 = 4.0 * U;

/// Whether squares and products of numbers of this size neither overflow nor matter where they underflow.
pub fn is_usual(x: f64) -> bool {
    (1e-100..1e100).contains(&x)
}

/// 1 / x as a power of two; `None` outside the usual sizes.
fn power_near(x: f64) -> Option<f64> {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    is_usual(x).then(|| 1.0 / f64::from_bits(x.to_bits() & EXPONENT))
}

/// x times a power of two.
fn times_power(x: Ball, power: f64) -> Ball {
    Ball::new(x.mid.scale(power), x.rad * power).widen(UNDERFLOW)
}

/// More than what squares that underflow leave out of a norm.
const UNDERFLOW: f64 = 1e-140;

/// A square root, not below the true one.
fn root(x: f64) -> f64 {
    x.sqrt() * (1.0 + 4096.0 * U)
}

simd! {
    fn all<V: Vector>(n: usize, parts: [&[Vec<f64>]; 2], off: [&[f64]; 2], slopes: [[f64; 3]; 2], places: At<'_>, cases: usize, found: &mut Bounded) {
        let room = || vec![V::splat(0.0); n * n];
        let (mut k, mut m, mut a, mut l, mut v, mut w) = (room(), room(), room(), room(), room(), room());
        let mut diagonals = [vec![V::splat(0.0); n], vec![V::splat(0.0); n]];
        // How much the diagonals of a range change at most; the highest quotients.
        let (mut widths, mut highest) = ([Vec::new(), Vec::new()], vec![V::splat(0.0); n]);
        for block in 0..cases.div_ceil(V::WIDTH) {
            let some = block * V::WIDTH..cases.min((block + 1) * V::WIDTH);
            let (at, half) = match places {
                At::Powers { d, half } => (load::<V>(&d[some.clone()]), load::<V>(&half[some.clone()])),
                At::Each(_) => (V::splat(0.0), V::splat(0.0)),
            };
            let mut offs = [V::splat(0.0); 2];
            match places {
                At::Powers { .. } => {
                    for i in 0..n * n {
                        (k[i], m[i]) = (V::splat(0.0), V::splat(0.0));
                    }
                    // By Horner's rule, from the highest power on.
                    for c in (0..parts[0].len()).rev() {
                        let (of_k, of_m) = (&parts[0][c], &parts[1][c]);
                        for i in 0..n * n {
                            k[i] = k[i].mul_add(at, V::splat(of_k[i]));
                            m[i] = m[i].mul_add(at, V::splat(of_m[i]));
                        }
                        for (sum, off) in offs.iter_mut().zip(off) {
                            *sum = sum.mul_add(at.abs() + half, V::splat(off[c]));
                        }
                    }
                }
                At::Each(numbers) => {
                    for i in 0..n * n {
                        (k[i], m[i]) = (V::splat(parts[0][0][i]), V::splat(parts[1][0][i]));
                    }
                    offs = off.map(|off| V::splat(off[0]));
                    for (c, numbers) in (1..).zip(numbers) {
                        let (x, of_k, of_m) = (load::<V>(&numbers[some.clone()]), &parts[0][c], &parts[1][c]);
                        for i in 0..n * n {
                            k[i] = x.mul_add(V::splat(of_k[i]), k[i]);
                            m[i] = x.mul_add(V::splat(of_m[i]), m[i]);
                        }
                        for (sum, off) in offs.iter_mut().zip(off) {
                            *sum = x.abs().mul_add(V::splat(off[c]), *sum);
                        }
                    }
                }
            }
            reduce(n, &k, &m, &mut l, &mut a);
            turn(n, &mut a, &mut w);
            vectors(n, &l, &w, &mut v);
            let (mut of_v, mut most) = (V::splat(0.0), V::splat(0.0));
            for x in &v {
                of_v = x.mul_add(*x, of_v);
            }
            of_v = of_v * V::splat(1.001);
            let off_m = offs[1];
            let [t, s] = &mut diagonals;
            let mut beside_s = congruent(n, &m, &v, &mut w, (of_v, of_v), off_m, s);
            let mut least = V::splat(f64::MAX);
            for x in s.iter() {
                (least, most) = (least.min(*x), most.max(*x));
            }
            // |V|^2 is at most |V^T M V| / min x^T M x, and at most its Frobenius norm.
            let floor = (floor(n, &m) - off_m).max(V::splat(1e-290));
            let norm = of_v.min((most + beside_s) * V::splat(1.001) / floor);
            let mut beside_t = congruent(n, &k, &v, &mut w, (norm, of_v), offs[0], t);
            let zero = V::splat(0.0);
            let is_range = half.exceeds(zero) != 0;
            if is_range {
                for (c, (beside, width)) in [&mut beside_t, &mut beside_s].into_iter().zip(&mut widths).enumerate() {
                    *width = vec![zero; n];
                    let mut change = half * half * half * norm * V::splat(slopes[c][2] / 6.0);
                    let mut factor = half;
                    for order in 1..parts[c].len().min(3) {
                        derivative(at, parts[c], order, &mut k);
                        // What its roundings leave out.
                        let off = V::splat((parts[c].len() as f64 + 4.0) * U * slopes[c][order - 1]);
                        let off_diagonal = congruent(n, &k, &v, &mut w, (norm, of_v), off, &mut m[..n]);
                        change = factor.mul_add(off_diagonal, change);
                        for (width, x) in width.iter_mut().zip(&m[..n]) {
                            *width = factor.mul_add(x.abs(), *width);
                        }
                        factor = factor * half * V::splat(0.5);
                    }
                    for width in width {
                        *width = half.if_exceeds(zero, *width * V::splat(1.001), zero);
                    }
                    *beside = half.if_exceeds(zero, (*beside + change) * V::splat(1.001), *beside);
                }
                for (x, width) in s.iter().zip(&widths[1]) {
                    least = least.min(*x - *width);
                }
            }
            let room = (least - beside_s) * V::splat(1.0 - 4.0 * U);
            // Zero, or NaN where a number is none: `min` passes over that, and a product with zero does not.
            let mut known = room.if_exceeds(V::splat(0.5) * least, beside_t * V::splat(0.0), V::splat(f64::NAN));
            for i in 0..n {
                known = s[i].mul_add(V::splat(0.0), known);
                if is_range {
                    // The quotients of all diagonals within the widths.
                    let (low, high) = (t[i] - widths[0][i], t[i] + widths[0][i]);
                    let (least, most) = (s[i] - widths[1][i], s[i] + widths[1][i]);
                    highest[i] = high / high.if_exceeds(zero, least, most);
                    t[i] = low / low.if_exceeds(zero, most, least);
                    known = highest[i].mul_add(V::splat(0.0), known);
                } else {
                    t[i] = t[i] / s[i];
                }
                known = t[i].mul_add(V::splat(0.0), known);
            }
            sort(t);
            if is_range {
                sort(&mut highest);
            } else {
                highest.copy_from_slice(t);
            }
            for (i, (low, high)) in t.iter().zip(&highest).enumerate() {
                let (middle, size) = ((*low + *high) * V::splat(0.5), low.abs().max(high.abs()));
                let spread = (*high - *low) * V::splat(0.5);
                // Of the quotients, or of their ends.
                let rounding = V::splat(if is_range { 8.0 * U } else { 2.0 * U });
                let bound = spread + (size.mul_add(beside_s, beside_t) / room + rounding * size) * V::splat(1.0 + 16.0 * U);
                let (numbers, bounds) = found.whole_lanes(i);
                (middle + known).store(&mut numbers[block * V::WIDTH..]);
                (bound + known).store(&mut bounds[block * V::WIDTH..]);
            }
        }
    }
}
