//! Transfer functions by poles: H(s) = sum r_j / (s - s_j) + a polynomial. In: the system in modal coordinates. Out: poles as exact
//! numbers, and a bound of what H differs from such a sum by, the same at all frequencies. See docs/method/random.md#poles.
//!
//! With z_j = (x_j, s_j x_j) as columns of Z and L(s) = s [C M; M 0] + [K 0; 0 -M], Z^T L(s) Z = B (s - D) + R exactly, whatever s_j
//! and x_j are: R_ij = x_i^T Q(s_j) x_j and B_ij = x_i^T (C + (s_i + s_j) M) x_j are small beside their diagonal for good ones.
//! How far poles are from each other does not enter, how far they are from the axis does.

use super::gramian::{Drive, Space};
use crate::analysis::poles::schur::SchurForm;
use crate::base::{Ball, Dd, larger, up};
use crate::kernel::complex::Complex;
use crate::kernel::dense::enclosure::norm_bound;
use nalgebra::DMatrix;

const UP: f64 = up::THOUSANDS;
/// The most refinements of poles and vectors; each gains at least ten digits.
const STEPS: usize = 6;
/// A step that is smaller, relative to the vector, changes nothing.
const SETTLED: f64 = 1e-30;
/// Poles that are nearer, relative to their size, are not separated by a refinement.
const CLOSE: f64 = 1e-9;
/// Dampers that couple two modes less, relative to the damping of both, do not make them start together.
const UNCOUPLED: f64 = 1e-26;

/// A pole and its vector in modal coordinates, both exact: real, or one of a conjugate pair, that above the real axis.
struct Pole {
    s: Complex<Dd>,
    x: Vec<Complex<Dd>>,
}

/// The poles of a system, all of them in the left half-plane.
pub struct Resolvent {
    n: usize,
    poles: Vec<Pole>,
    /// B_jj
    slopes: Vec<Complex<Ball>>,
    /// Bounds of the 2-norms of the scaled B_d^-1 R and of B_d^-1 B - 1.
    residual: f64,
    skew: f64,
}

/// A transfer function as residues at the poles, those of conjugates left out, and factors of s^-2 .. s^2.
pub struct Parts {
    residues: Vec<Complex<Ball>>,
    direct: [Ball; 5],
    /// A bound of what is missing, on the axis.
    slack: f64,
}

/// |H(i w)|^2 = 2 re sum c_j / (i w - s_j) + sum l_m w^(2 m), over all poles, conjugates too.
pub struct Square {
    /// Of the poles that `Resolvent::all` lists.
    pub factors: Vec<Complex<Ball>>,
    /// l_-2 .. l_2
    pub direct: [Ball; 5],
    pub slack: f64,
}

impl Pole {
    fn is_real(&self) -> bool {
        self.s.im.is_zero()
    }

    fn exact(&self) -> Complex<Ball> {
        self.s.to_ball()
    }
}

impl Resolvent {
    /// `None` if poles or vectors are not good enough for any bound.
    pub fn of(space: &Space) -> Option<Resolvent> {
        let mut poles = starts(space)?;
        refine(space, &mut poles);
        let mut resolvent =
            Resolvent { n: space.n, poles, slopes: Vec::new(), residual: f64::INFINITY, skew: f64::INFINITY };
        resolvent.certify(space)?;
        Some(resolvent)
    }

    /// Every pole, a pair one after the other.
    pub fn all(&self) -> Vec<Complex<Ball>> {
        let of = |pole: &Pole| {
            let s = pole.exact();
            if pole.is_real() { vec![s] } else { vec![s, s.conj()] }
        };
        self.poles.iter().flat_map(of).collect()
    }

    /// The bounds of the scaled residuals. Rows and columns are weighed by the distances of the poles from the axis.
    fn certify(&mut self, space: &Space) -> Option<()> {
        let count: usize = self.poles.iter().map(|pole| if pole.is_real() { 1 } else { 2 }).sum();
        if count != 2 * self.n || self.poles.iter().any(|pole| !(pole.s.re.hi < 0.0 && pole.s.re.is_finite())) {
            return None;
        }
        let columns: Vec<[Vec<Complex<Ball>>; 2]> = self.poles.iter().map(|pole| applied(space, pole)).collect();
        // Rows: all poles; columns: one of each pair, for the others are conjugates.
        let rows: Vec<(usize, bool)> = self
            .poles
            .iter()
            .enumerate()
            .flat_map(|(i, pole)| [(i, false), (i, true)].into_iter().take(if pole.is_real() { 1 } else { 2 }))
            .collect();
        let across = |row: &(usize, bool), column: &[Complex<Ball>]| {
            self.poles[row.0].x.iter().zip(column).fold(Complex::ZERO, |sum, (x, y)| {
                let x = if row.1 { x.conj() } else { *x };
                sum + x.to_ball() * *y
            })
        };
        let size = |x: &[Complex<Dd>]| x.iter().map(|x| x.to_f64().one_norm()).sum::<f64>() * UP;
        let own = |i: usize| {
            let pole = &self.poles[i];
            // x^T C x + 2 s x^T M x
            let square = across(&(i, false), &pole.x.iter().map(|x| x.to_ball()).collect::<Vec<_>>());
            let twice = pole.exact().scale(Ball::from(2.0));
            let slack = space.of_m * size(&pole.x).powi(2) * twice.magnitude() * UP;
            widened(across(&(i, false), &columns[i][1]) + twice * square, slack)
        };
        self.slopes = (0..self.poles.len()).map(own).collect();
        let inverse: Vec<f64> =
            self.slopes.iter().map(|slope| (Complex::real(Ball::ONE) / *slope).magnitude()).collect();
        let far: Vec<f64> = self.poles.iter().map(|pole| pole.s.re.hi.abs()).collect();
        let (mut residuals, mut skews) = (Vec::new(), Vec::new());
        for (j, pole) in self.poles.iter().enumerate() {
            let of_x: Vec<Complex<Ball>> = pole.x.iter().map(|x| x.to_ball()).collect();
            for row in &rows {
                let residual = across(row, &columns[j][0]).magnitude() * inverse[row.0];
                residuals.push(residual / (far[row.0] * far[j]).sqrt());
                if *row == (j, false) {
                    skews.push(0.0);
                    continue;
                }
                let other = if row.1 { self.poles[row.0].exact().conj() } else { self.poles[row.0].exact() };
                let sum = other + pole.exact();
                let slack = space.of_m * size(&self.poles[row.0].x) * size(&pole.x) * sum.magnitude() * UP;
                let skew = across(row, &columns[j][1]) + sum * across(row, &of_x);
                skews.push((skew.magnitude() + slack) * inverse[row.0] * (far[j] / far[row.0]).sqrt());
            }
        }
        // A column of a conjugate has the same sizes in another order of rows.
        let mirror: Vec<usize> = rows
            .iter()
            .enumerate()
            .map(|(at, row)| match (row.1, self.poles[row.0].is_real()) {
                (_, true) => at,
                (false, _) => at + 1,
                (true, _) => at - 1,
            })
            .collect();
        let norm = |list: &[f64]| {
            norm_bound(rows.len(), rows.len(), |i, j| {
                let row = if rows[j].1 { mirror[i] } else { i };
                list[rows[j].0 * rows.len() + row]
            })
        };
        (self.residual, self.skew) = (norm(&residuals) * UP, norm(&skews) * UP);
        self.relative().map(|_| ())
    }

    /// What a transfer function may be off by, relative to the product of its scaled rows.
    fn relative(&self) -> Option<f64> {
        const MOST: f64 = 0.1;
        if !(self.skew < MOST && self.residual < MOST) {
            return None;
        }
        let of_inverse = self.skew / (1.0 - self.skew);
        let residual = self.residual / (1.0 - self.skew) * UP;
        let of_poles = residual / (1.0 - residual);
        Some((of_poles * (1.0 + of_inverse) + of_inverse) * UP)
    }

    /// The transfer function from a noise to the row of an output over the state, and what reaches it directly.
    pub fn parts(&self, space: &Space, drive: &Drive, row: &[Ball], direct: [Ball; 5]) -> Option<Parts> {
        let n = self.n;
        let jump: Vec<Ball> = drive.jump.iter().zip(&space.s).map(|(jump, s)| *jump / Ball::from(*s)).collect();
        let size = jump.iter().map(|h| h.magnitude()).sum::<f64>() * UP;
        // f + C h and M h, M = 1 but for small entries.
        let force: Vec<Ball> =
            (0..n).map(|i| (0..n).fold(drive.force[i], |sum, j| sum + space.c[(i, j)] * jump[j])).collect();
        let moved: Vec<Ball> =
            jump.iter().map(|h| if size > 0.0 { h.widen(space.of_m * size * UP) } else { *h }).collect();
        let (mut residues, mut left, mut right) = (Vec::new(), 0.0, 0.0);
        for (pole, slope) in self.poles.iter().zip(&self.slopes) {
            let s = pole.exact();
            let (mut p, mut q) = (Complex::ZERO, Complex::ZERO);
            for i in 0..n {
                let x = pole.x[i].to_ball();
                p = p + x * (Complex::real(row[i] * Ball::from(space.s[i])) + s.scale(row[n + i]));
                q = q + x * (Complex::real(force[i]) + s.scale(moved[i]));
            }
            let q = q / *slope;
            let (count, far) = (if pole.is_real() { 1.0 } else { 2.0 }, pole.s.re.hi.abs());
            left += count * p.magnitude().powi(2) / far;
            right += count * q.magnitude().powi(2) / far;
            residues.push(p * q);
        }
        let slack = self.relative()? * (left * UP).sqrt() * (right * UP).sqrt() * UP;
        slack.is_finite().then_some(Parts { residues, direct, slack })
    }

    /// The sum over all poles of a function that is conjugate at a conjugate.
    fn sum(&self, of: impl Fn(usize, Complex<Ball>) -> Complex<Ball>) -> Ball {
        let term = |(j, pole): (usize, &Pole)| {
            let value = of(j, pole.exact()).re;
            if pole.is_real() { value } else { value + value }
        };
        self.poles.iter().enumerate().map(term).fold(Ball::ZERO, |sum, x| sum + x)
    }

    /// |H|^2 as H(s) H(-s), by partial fractions.
    pub fn square(&self, parts: &Parts) -> Square {
        let Parts { residues, direct, slack } = parts;
        let all = self.all();
        let conjugate: Vec<Complex<Ball>> = self
            .poles
            .iter()
            .zip(residues)
            .flat_map(|(pole, r)| if pole.is_real() { vec![*r] } else { vec![*r, r.conj()] })
            .collect();
        let mirrored = |s: Complex<Ball>| {
            let sum = all
                .iter()
                .zip(&conjugate)
                .fold(Complex::ZERO, |sum: Complex<Ball>, (other, r)| sum - *r / (s + *other));
            sum + laurent(direct, -s)
        };
        let mut factors = Vec::with_capacity(all.len());
        for (pole, r) in self.poles.iter().zip(residues) {
            let factor = if r.re.is_zero() && r.im.is_zero() { Complex::ZERO } else { *r * mirrored(pole.exact()) };
            factors.push(factor);
            if !pole.is_real() {
                factors.push(factor.conj());
            }
        }
        Square { factors, direct: self.even(residues, direct), slack: *slack }
    }

    /// What |H|^2 has of w^-4 .. w^4.
    fn even(&self, residues: &[Complex<Ball>], direct: &[Ball; 5]) -> [Ball; 5] {
        let two = Ball::from(2.0);
        // Powers of s from -4 to 4: those of the direct parts among each other, then those with the poles.
        let mut powers = [Ball::ZERO; 9];
        for (k, a) in direct.iter().enumerate() {
            for (l, b) in direct.iter().enumerate() {
                let product = *a * *b;
                powers[k + l] = powers[k + l] + if l % 2 == 0 { product } else { -product };
            }
        }
        if !direct[3].is_zero() {
            powers[4] = powers[4] - two * direct[3] * self.sum(|j, _| residues[j]);
        }
        if !direct[4].is_zero() {
            powers[4] = powers[4] + two * direct[4] * self.sum(|j, s| residues[j] * s);
        }
        if !direct[0].is_zero() {
            powers[2] = powers[2] - two * direct[0] * self.sum(|j, s| residues[j] / s);
        }
        // s^2 = -w^2
        [powers[0], -powers[2], powers[4], -powers[6], powers[8]]
    }
}

/// The sum of factors of s^-2 .. s^2.
fn laurent(factors: &[Ball; 5], s: Complex<Ball>) -> Complex<Ball> {
    let mut sum = Complex::ZERO;
    if factors[..2].iter().any(|factor| !factor.is_zero()) {
        let inverse = Complex::real(Ball::ONE) / s;
        sum = (inverse.scale(factors[0]) + Complex::real(factors[1])) * inverse;
    }
    sum + (s.scale(factors[4]) + Complex::real(factors[3])) * s + Complex::real(factors[2])
}

fn widened(z: Complex<Ball>, by: f64) -> Complex<Ball> {
    Complex::new(z.re.widen(by), z.im.widen(by))
}

/// Q(s) x and C x, with all that M and K may be off by.
fn applied(space: &Space, pole: &Pole) -> [Vec<Complex<Ball>>; 2] {
    let (n, s) = (space.n, pole.exact());
    let x: Vec<Complex<Ball>> = pole.x.iter().map(|x| x.to_ball()).collect();
    let damped: Vec<Complex<Ball>> =
        (0..n).map(|i| (0..n).fold(Complex::ZERO, |sum: Complex<Ball>, j| sum + x[j].scale(space.c[(i, j)]))).collect();
    let sizes: Vec<f64> = pole.x.iter().map(|x| x.to_f64().one_norm() * UP).collect();
    let (square, size) = (s * s, sizes.iter().sum::<f64>() * UP);
    let stretched = sizes.iter().zip(&space.s).map(|(x, s)| x * s).sum::<f64>() * UP;
    let force = (0..n).map(|i| {
        let slack = square.magnitude() * space.of_m * size + space.of_k * space.s[i] * stretched;
        widened((square + Complex::real(space.k[i])) * x[i] + s * damped[i], slack * UP)
    });
    [force.collect(), damped]
}

/// Starting values from the modes that dampers couple, part by part: they are proved afterwards.
fn starts(space: &Space) -> Option<Vec<Pole>> {
    let mut poles = Vec::with_capacity(2 * space.n);
    for part in coupled(space) {
        match part[..] {
            [mode] => poles.extend(of_one(space, mode)),
            _ => poles.extend(of_several(space, &part)?),
        }
    }
    Some(poles)
}

/// The modes that dampers couple, directly or by way of others.
fn coupled(space: &Space) -> Vec<Vec<usize>> {
    let n = space.n;
    let c = |i: usize, j: usize| space.c[(i, j)].to_f64();
    let is_coupled = |i: usize, j: usize| c(i, j).abs() > UNCOUPLED * (c(i, i) * c(j, j)).sqrt();
    let mut parts: Vec<Vec<usize>> = Vec::new();
    let mut is_free = vec![true; n];
    for first in 0..n {
        if !std::mem::replace(&mut is_free[first], false) {
            continue;
        }
        let (mut part, mut next) = (vec![first], 0);
        while let Some(&i) = part.get(next) {
            for (j, is_free) in is_free.iter_mut().enumerate().filter(|(j, is_free)| **is_free && is_coupled(i, *j)) {
                *is_free = false;
                part.push(j);
            }
            next += 1;
        }
        part.sort_unstable();
        parts.push(part);
    }
    parts
}

/// The poles of a mode by itself. A double pole is split a little: the difference is part of the residual.
fn of_one(space: &Space, mode: usize) -> Vec<Pole> {
    /// Of what half the damping is, squared.
    const SPLIT: f64 = 1e-20;
    let (half, k) = (space.c[(mode, mode)].mid.scale(0.5), space.k[mode].mid);
    let mut square = half.square() - k;
    if square.hi.abs() < SPLIT * k.hi {
        square = Dd::from(-SPLIT * k.hi);
    }
    let root = square.abs().sqrt();
    let of = |s: Complex<Dd>| {
        let mut x = vec![Complex::ZERO; space.n];
        x[mode] = Complex::real(Dd::from(scale((s.to_f64().one_norm() * 2.0).sqrt())));
        Pole { s, x }
    };
    if square.hi < 0.0 {
        return vec![of(Complex::new(-half, root))];
    }
    // The slow one of two real poles without cancellation.
    let fast = -(half + root);
    vec![of(Complex::real(fast)), of(Complex::real(k / fast))]
}

fn of_several(space: &Space, part: &[usize]) -> Option<Vec<Pole>> {
    let n = part.len();
    let entry = |i: usize, j: usize| match (i < n, j < n) {
        (true, false) if i + n == j => space.s[part[i]],
        (false, true) if i == j + n => -space.k[part[j]].to_f64() / space.s[part[j]],
        (false, false) => -space.c[(part[i - n], part[j - n])].to_f64(),
        _ => 0.0,
    };
    let schur = SchurForm::of(DMatrix::from_fn(2 * n, 2 * n, entry))?;
    let list = schur.eigenvalues();
    let vectors = schur.eigenvectors(&list);
    let of = |(column, eigenvalue): (usize, &crate::analysis::poles::schur::Eigenvalue)| {
        let s = eigenvalue.value;
        let mut x = vec![Complex::ZERO; space.n];
        // Of the place and the rate of each mode the larger one is the more accurate.
        for (i, &mode) in part.iter().enumerate() {
            let (place, rate) = (vectors.at(i, column), vectors.at(n + i, column));
            let value =
                if place.one_norm() >= rate.one_norm() { place.scale(1.0 / space.s[mode]) } else { rate * s.recip() };
            x[mode] = if s.im == 0.0 { Complex::real(value.re) } else { value };
        }
        let slope = slope(space, s, &x).one_norm().sqrt();
        let scale = scale(slope);
        Pole { s: s.into(), x: x.into_iter().map(|x| x.scale(scale).into()).collect() }
    };
    Some(list.iter().enumerate().map(of).collect())
}

/// A power of two near 1 / size.
fn scale(size: f64) -> f64 {
    let exponent = -libm::log2(size).round();
    if exponent.abs() < 500.0 { libm::exp2(exponent) } else { 1.0 }
}

/// x^T (C + 2 s) x in binary64.
fn slope(space: &Space, s: Complex<f64>, x: &[Complex<f64>]) -> Complex<f64> {
    (0..x.len()).fold(Complex::ZERO, |sum, i| {
        let damped = (0..x.len()).fold(Complex::ZERO, |sum, j| sum + x[j].scale(space.c[(i, j)].to_f64()));
        sum + x[i] * (damped + x[i] * s.scale(2.0))
    })
}

/// Refines all poles together, each along the vectors of all others (see `analysis::poles::together`), in modal coordinates.
fn refine(space: &Space, poles: &mut [Pole]) {
    let mut last = f64::INFINITY;
    for _ in 0..STEPS {
        let short: Vec<(Complex<f64>, Vec<Complex<f64>>)> =
            poles.iter().map(|pole| (pole.s.to_f64(), pole.x.iter().map(|x| x.to_f64()).collect())).collect();
        let slopes: Vec<Complex<f64>> = short.iter().map(|(s, x)| slope(space, *s, x)).collect();
        let mut largest = 0.0f64;
        let steps: Vec<(Complex<f64>, Vec<Complex<f64>>)> = (0..poles.len())
            .map(|j| {
                let residual = residual(space, &poles[j]);
                let step = step(&short, &slopes, j, &residual);
                let size = |x: &[Complex<f64>]| x.iter().map(|x| x.one_norm()).fold(0.0, larger);
                let relative = larger(step.0.one_norm() / short[j].0.one_norm(), size(&step.1) / size(&short[j].1));
                largest = larger(largest, relative);
                step
            })
            .collect();
        let is_progress = largest < last && largest < 1e-3;
        if !is_progress {
            break;
        }
        last = largest;
        for (pole, (ds, dx)) in poles.iter_mut().zip(steps) {
            let is_real = pole.is_real();
            let add = |z: Complex<Dd>, d: Complex<f64>| {
                if is_real { Complex::real(z.re + Dd::from(d.re)) } else { z + d.into() }
            };
            pole.s = add(pole.s, ds);
            pole.x.iter_mut().zip(dx).for_each(|(x, d)| *x = add(*x, d));
        }
        if largest < SETTLED {
            break;
        }
    }
}

/// Q(s) x, rounded.
fn residual(space: &Space, pole: &Pole) -> Vec<Complex<f64>> {
    let (n, s, x) = (space.n, pole.s, &pole.x);
    let square = s * s;
    (0..n)
        .map(|i| {
            let damped = (0..n).fold(Complex::ZERO, |sum: Complex<Dd>, j| sum + x[j].scale(space.c[(i, j)].mid));
            ((square + Complex::real(space.k[i].mid)) * x[i] + s * damped).to_f64()
        })
        .collect()
}

/// The step of the Rayleigh quotient, and of the vector along all others.
fn step(
    short: &[(Complex<f64>, Vec<Complex<f64>>)],
    slopes: &[Complex<f64>],
    own: usize,
    residual: &[Complex<f64>],
) -> (Complex<f64>, Vec<Complex<f64>>) {
    let s = short[own].0;
    let mut dx = vec![Complex::ZERO; residual.len()];
    let mut ds = Complex::ZERO;
    for (i, ((other, x), slope)) in short.iter().zip(slopes).enumerate() {
        for is_mirrored in [false, true] {
            let turned = |z: Complex<f64>| if is_mirrored { z.conj() } else { z };
            if is_mirrored && other.im == 0.0 {
                continue;
            }
            let across = x.iter().zip(residual).fold(Complex::ZERO, |sum, (x, r)| sum + turned(*x) * *r);
            let factor = across * turned(*slope).recip();
            if i == own && !is_mirrored {
                ds = -factor;
                continue;
            }
            let gap = s - turned(*other);
            if gap.one_norm() <= CLOSE * s.one_norm() {
                continue;
            }
            let factor = -(factor * gap.recip());
            dx.iter_mut().zip(x).for_each(|(d, x)| *d = *d + turned(*x) * factor);
        }
    }
    (ds, dx)
}
