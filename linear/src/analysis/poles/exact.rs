//! Poles by exact arithmetic: the roots of the polynomial det(M s^2 + C s + K) with integer coefficients. In: the terms
//! of a small independent part, all rational. Out: every root with its multiplicity, however close to others, whether
//! it is real, and whether it has fewer vectors than its multiplicity. Used for parts whose discs overlap, and for
//! those with motions without inertia. See docs/method/poles.md#exact-arithmetic.

use crate::analysis::modes::parts::Part;
use crate::base::{Ball, OrderBy, Rational};
use crate::kernel::big_float::{ComplexFloat, Float};
use crate::kernel::complex::Complex;
use crate::kernel::polynomial::{Polynomial, determinant};
use crate::kernel::residues::scramble;
use crate::kernel::sturm::{HalfPlanes, half_planes, real_roots};
use crate::system::{Form, LinearSystem};
use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::One;
use std::cmp::Ordering;

/// For more coordinates than this, exact arithmetic on the polynomial takes longer than a user would wait.
pub const MOST_COORDINATES: usize = 12;
/// Initial working precision for roots, in bits; it is doubled until their discs are disjoint.
pub(super) const FIRST_BITS: u64 = 160;
/// Largest working precision. It separates roots down to a distance of 2^-1000; no polynomial here has closer roots.
pub(super) const MOST_BITS: u64 = 2560;

/// All finite poles of a part: as many as the degree of det Q. Made only by [`exact_poles`].
#[derive(Clone, Debug)]
pub struct ExactPoles {
    zeros: usize,
    roots: Vec<ExactRoot>,
    degree: usize,
}

impl ExactPoles {
    /// `None` if the number of roots and zeros is not the degree.
    pub(super) fn with_count(zeros: usize, roots: Vec<ExactRoot>, degree: usize) -> Option<ExactPoles> {
        let sides = |root: &ExactRoot| if root.real { root.multiplicity } else { 2 * root.multiplicity };
        let count = zeros + roots.iter().map(sides).sum::<usize>();
        (count == degree).then_some(ExactPoles { zeros, roots, degree })
    }

    /// The degree of det Q: the number of finite poles, zeros included.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The number of poles that are exactly zero.
    pub fn zeros(&self) -> usize {
        self.zeros
    }

    /// The nonzero poles, one of each conjugate pair (im > 0).
    pub fn roots(&self) -> &[ExactRoot] {
        &self.roots
    }
}

/// A root with its multiplicity.
#[derive(Clone, Debug)]
pub struct ExactRoot {
    pub s: Complex<Ball>,
    pub multiplicity: usize,
    pub real: bool,
    /// Whether there are fewer independent vectors x with Q(s) x = 0 than the multiplicity.
    pub defective: bool,
}

/// The result of exact arithmetic.
pub enum Exact {
    Poles(ExactPoles),
    /// det Q vanishes for every s.
    Singular,
}

/// The poles of a part; `None` if it is too large, a term is not rational, or the roots cannot be separated.
pub fn exact_poles(system: &LinearSystem, part: &Part, local: &[u32]) -> Option<Exact> {
    if part.coordinates.len() > MOST_COORDINATES {
        return None;
    }
    let matrices = Matrices::of(system, part, local)?;
    let polynomial = matrices.characteristic(false);
    if polynomial.is_zero() {
        return Some(Exact::Singular);
    }
    let (zeros, rest) = polynomial.without_zero_roots();
    let mut roots = Vec::new();
    for (index, factor) in rest.by_multiplicity()?.iter().enumerate() {
        if factor.degree() > 0 {
            roots.extend(with_multiplicity(factor, index + 1, &matrices)?);
        }
    }
    Some(Exact::Poles(ExactPoles::with_count(zeros, roots, polynomial.degree())?))
}

/// The number of poles of a part to the left of the imaginary axis, on it and to its right, without computing any of
/// them (Routh); `None` if the part is too large or a term is not rational.
pub fn half_planes_of(system: &LinearSystem, part: &Part, local: &[u32]) -> Option<HalfPlanes> {
    if part.coordinates.len() > MOST_COORDINATES {
        return None;
    }
    half_planes(&Matrices::of(system, part, local)?.characteristic(false))
}

/// Roots of the given multiplicity m, those with fewer than m vectors told from the others: det [Q, u; u^T, 0] is -u^T adj(Q) u, and
/// adj(Q) vanishes to the order m - 1 where there are m independent vectors that Q annihilates. If it does not for some u, there are fewer.
fn with_multiplicity(factor: &Polynomial, multiplicity: usize, matrices: &Matrices) -> Option<Vec<ExactRoot>> {
    if multiplicity == 1 {
        return roots_of_factor(factor, 1, false);
    }
    let (mut several, mut bordered) = (factor.clone(), matrices.characteristic(true));
    for _ in 1..multiplicity {
        several = several.gcd(&bordered)?;
        bordered = bordered.divided_by(&several)?;
    }
    let mut roots = roots_of_factor(&factor.divided_by(&several)?, multiplicity, true)?;
    roots.extend(roots_of_factor(&several, multiplicity, false)?);
    Some(roots)
}

pub(super) fn roots_of_factor(factor: &Polynomial, multiplicity: usize, defective: bool) -> Option<Vec<ExactRoot>> {
    let root = |(s, real)| ExactRoot { s, multiplicity, real, defective };
    Some(roots(factor)?.into_iter().map(root).collect())
}

/// M, C and K, multiplied by one integer that clears all denominators.
struct Matrices {
    m: Vec<Vec<BigInt>>,
    c: Vec<Vec<BigInt>>,
    k: Vec<Vec<BigInt>>,
}

impl Matrices {
    fn of(system: &LinearSystem, part: &Part, local: &[u32]) -> Option<Matrices> {
        let n = part.coordinates.len();
        let m = assemble(&system.m, &part.m, local, n)?;
        let c = assemble(&system.c, &part.c, local, n)?;
        let k = assemble(&system.k, &part.k, local, n)?;
        let denominators = [&m, &c, &k].into_iter().flatten().flatten().map(|x| x.to_big().denom().clone());
        let common = denominators.fold(BigInt::one(), |lcm, d| lcm.lcm(&d));
        let cleared = |matrix: &[Vec<Rational>]| {
            let entry = |x: &Rational| x.to_big().numer() * (&common / x.to_big().denom());
            matrix.iter().map(|row| row.iter().map(entry).collect()).collect()
        };
        Some(Matrices { m: cleared(&m), c: cleared(&c), k: cleared(&k) })
    }

    /// det Q(s), or det [Q(s), u; u^T, 0] for a pseudo-random vector u, interpolated from its values at small integers.
    fn characteristic(&self, bordered: bool) -> Polynomial {
        let n = self.m.len();
        let values: Vec<BigInt> = (0..=2 * n as i64).map(|s| determinant(self.at(s, bordered))).collect();
        Polynomial::through(&values)
    }

    fn at(&self, s: i64, bordered: bool) -> Vec<Vec<BigInt>> {
        let n = self.m.len();
        let border = |i: usize| BigInt::from(scramble(i as u64) % 1000 + 1);
        let mut rows: Vec<Vec<BigInt>> =
            (0..n).map(|i| (0..n).map(|j| (&self.m[i][j] * s + &self.c[i][j]) * s + &self.k[i][j]).collect()).collect();
        if bordered {
            rows.iter_mut().enumerate().for_each(|(i, row)| row.push(border(i)));
            rows.push((0..n).map(border).chain([BigInt::default()]).collect());
        }
        rows
    }
}

/// sum w a a^T of the chosen terms.
pub(in crate::analysis) fn assemble(form: &Form, terms: &[u32], local: &[u32], n: usize) -> Option<Vec<Vec<Rational>>> {
    let mut matrix = vec![vec![Rational::ZERO; n]; n];
    for &index in terms {
        let term = form.term(index as usize);
        let weight = term.weight.exact()?;
        for (i, a) in form.row(term) {
            let weighted = weight * a.exact()?;
            for (j, b) in form.row(term) {
                let entry = &mut matrix[local[i.index()] as usize][local[j.index()] as usize];
                *entry = &*entry + &(&weighted * b.exact()?);
            }
        }
    }
    Some(matrix)
}

/// The roots of a polynomial without repeated or zero roots: one of each conjugate pair and the real ones (marked),
/// ascending in magnitude, each in a separate disc.
pub(in crate::analysis) fn roots(f: &Polynomial) -> Option<Vec<(Complex<Ball>, bool)>> {
    if f.degree() == 0 {
        return Some(Vec::new());
    }
    let slope = f.derivative();
    let mut values = circles(f);
    let mut bits = FIRST_BITS;
    while bits <= MOST_BITS {
        iterate(f, &slope, &mut values, bits);
        if let Some(roots) = disjoint_discs(f, &slope, &values) {
            return Some(roots);
        }
        bits *= 2;
    }
    None
}

/// Initial values on circles whose radii are those of the Newton polygon (Bini, Numer. Algorithms 13 (1996) 179):
/// between corners i and j of the upper hull of log2 |a_i| there are j - i roots of about 2^((l_i - l_j) / (j - i)).
pub(in crate::analysis) fn circles(f: &Polynomial) -> Vec<ComplexFloat> {
    let corners = upper_hull(f);
    let (mut values, mut turn) = (Vec::new(), Complex::new(0.96, 0.28));
    for pair in corners.windows(2) {
        let ((i, low), (j, high)) = (pair[0], pair[1]);
        let exponent = (low - high) as f64 / (j - i) as f64;
        let whole = exponent.floor();
        for _ in i..j {
            // An angle that is not a rational part of a full turn.
            turn = turn * Complex::new(0.28, 0.96);
            let scale = Float::from(1.0 + (exponent - whole)).times_power_of_two(whole as i64);
            values.push(ComplexFloat::new(&Float::from(turn.re) * &scale, &Float::from(turn.im) * &scale));
        }
    }
    values
}

/// Corners of the least concave majorant of (i, bits of a_i).
fn upper_hull(f: &Polynomial) -> Vec<(usize, i64)> {
    let mut hull: Vec<(usize, i64)> = Vec::new();
    for (i, a) in f.coefficients().iter().enumerate().filter(|(_, a)| a.bits() > 0) {
        let point = (i, a.bits() as i64);
        while let [.., a, b] = hull[..] {
            let rise = |p: (usize, i64), q: (usize, i64)| (i128::from(q.1 - p.1), (q.0 - p.0) as i128);
            let ((dy, dx), (ey, ex)) = (rise(a, b), rise(a, point));
            if dy * ex > ey * dx {
                break;
            }
            hull.pop();
        }
        hull.push(point);
    }
    hull
}

/// The Ehrlich-Aberth iteration until no value moves by more than half of its bits, for a limited number of sweeps.
pub(in crate::analysis) fn iterate(
    f: &dyn Holomorphic,
    slope: &dyn Holomorphic,
    values: &mut [ComplexFloat],
    bits: u64,
) {
    for _ in 0..100 {
        let mut settled = true;
        for i in 0..values.len() {
            let Some(step) = correction(f, slope, values, i, bits) else { continue };
            settled &= is_small(&step, &values[i], bits as i64 / 2);
            values[i] = (&values[i] - &step).cut(bits);
        }
        if settled {
            break;
        }
    }
}

/// |step| < 2^-places |z|
fn is_small(step: &ComplexFloat, z: &ComplexFloat, places: i64) -> bool {
    match (step.norm().ceiling_log2(), z.norm().ceiling_log2()) {
        (Some(step), Some(z)) => step < z - 2 * places,
        (None, _) => true,
        (_, None) => false,
    }
}

/// f / (f' - f sum 1 / (z_i - z_j)); zero if f or the divisor vanishes.
fn correction(
    f: &dyn Holomorphic,
    slope: &dyn Holomorphic,
    values: &[ComplexFloat],
    i: usize,
    bits: u64,
) -> Option<ComplexFloat> {
    let z = &values[i];
    let (p, q) = (f.at(z, Some(bits)), slope.at(z, Some(bits)));
    let mut others = ComplexFloat::zero();
    for (_, other) in values.iter().enumerate().filter(|(j, _)| *j != i) {
        let difference = z - other;
        if !difference.is_zero() {
            others = (&others + &difference.recip(bits)).cut(bits);
        }
    }
    let divisor = (&q - &(&p * &others)).cut(bits);
    (!p.is_zero() && !divisor.is_zero()).then(|| (&p * &divisor.recip(bits)).cut(bits))
}

/// A function whose zeros are looked for.
pub(in crate::analysis) trait Holomorphic {
    /// Its value, truncated to `bits` bits; exact if `bits` is `None`.
    fn at(&self, z: &ComplexFloat, bits: Option<u64>) -> ComplexFloat;
}

impl Holomorphic for Polynomial {
    fn at(&self, z: &ComplexFloat, bits: Option<u64>) -> ComplexFloat {
        value(self, z, bits)
    }
}

/// f(z) by Horner's scheme; exact if `bits` is `None`.
pub(in crate::analysis) fn value(f: &Polynomial, z: &ComplexFloat, bits: Option<u64>) -> ComplexFloat {
    let cut = |sum: ComplexFloat| match bits {
        Some(bits) => sum.cut(bits),
        None => sum,
    };
    let mut falling = f.coefficients().iter().rev().map(|a| Float::from(a.clone()));
    let Some(leading) = falling.next() else { return ComplexFloat::zero() };
    falling.fold(cut(ComplexFloat::new(leading, Float::zero())), |sum, a| {
        let product = &sum * z;
        cut(ComplexFloat::new(&product.re + &a, product.im))
    })
}

/// A disc that contains a root.
pub(super) struct Rooted {
    pub z: ComplexFloat,
    pub radius: Float,
}

impl Rooted {
    /// The disc around z; if that meets the real axis, the disc around the real part of z instead: a disc around a real
    /// centre that contains one root contains a real one.
    fn disc_around(f: &Polynomial, slope: &Polynomial, z: &ComplexFloat) -> Option<Rooted> {
        let disc = Rooted { z: z.clone(), radius: radius(f, slope, z, f.degree())? };
        if disc.is_clear_of_the_axis() {
            return Some(disc);
        }
        let z = ComplexFloat::new(z.re.clone(), Float::zero());
        let radius = radius(f, slope, &z, f.degree())?;
        Some(Rooted { z, radius })
    }

    fn is_real(&self) -> bool {
        self.z.im.is_zero()
    }

    pub fn is_clear_of_the_axis(&self) -> bool {
        is_less(&self.radius, &self.z.im.abs())
    }

    pub fn is_apart_from(&self, other: &Rooted) -> bool {
        let reach = &self.radius + &other.radius;
        is_less(&(&reach * &reach), &(&self.z - &other.z).norm())
    }

    /// The disc as balls; a real centre is that of a real root.
    pub fn enclosure(&self) -> Complex<Ball> {
        let radius = self.radius.to_f64_above();
        let im = if self.is_real() { Ball::ZERO } else { self.z.im.to_ball(radius) };
        Complex::new(self.z.re.to_ball(radius), im)
    }

    /// Whether the disc determines all digits that double-double can represent.
    pub fn is_sharp(&self) -> bool {
        let wide = self.radius.clone().times_power_of_two(110);
        is_less(&(&wide * &wide), &self.z.norm())
    }
}

fn is_less(a: &Float, b: &Float) -> bool {
    (b - a).sign() == Ordering::Greater
}

/// The disc |s - z| <= d |f / f'| contains a root (Laguerre; Henrici, Applied and Computational Complex Analysis I,
/// 6.4); d disjoint discs contain one each, and those are all roots. A disc around a real centre also contains the
/// conjugate of its root, which is therefore the root itself; one clear of the real axis contains one root of a
/// conjugate pair. Sturm's chain counts the real roots independently. `None` if discs touch, or leave digits open that
/// double-double can represent.
fn disjoint_discs(f: &Polynomial, slope: &Polynomial, values: &[ComplexFloat]) -> Option<Vec<(Complex<Ball>, bool)>> {
    let discs: Vec<Rooted> = values.iter().map(|z| Rooted::disc_around(f, slope, z)).collect::<Option<_>>()?;
    let apart = |(i, a): (usize, &Rooted)| discs[..i].iter().all(|b| a.is_apart_from(b));
    let on_or_off_the_axis = |disc: &Rooted| disc.is_real() || disc.is_clear_of_the_axis();
    let hold_one_each = discs.len() == f.degree() && discs.iter().enumerate().all(apart);
    if !hold_one_each || !discs.iter().all(|disc| disc.is_sharp() && on_or_off_the_axis(disc)) {
        return None;
    }
    let real = discs.iter().filter(|disc| disc.is_real()).count();
    let upper: Vec<&Rooted> = discs.iter().filter(|disc| !disc.is_real() && !disc.z.im.is_negative()).collect();
    if real + 2 * upper.len() != f.degree() || real_roots(f).is_some_and(|count| count != real) {
        return None;
    }
    let mut list: Vec<&Rooted> = discs.iter().filter(|disc| disc.is_real()).chain(upper).collect();
    list.order_by(|a, b| (&a.z.norm() - &b.z.norm()).sign());
    Some(list.into_iter().map(|disc| (disc.enclosure(), disc.is_real())).collect())
}

/// d |f(z) / f'(z)|, exact except for one rounding upwards.
pub(super) fn radius(f: &dyn Holomorphic, slope: &dyn Holomorphic, z: &ComplexFloat, d: usize) -> Option<Float> {
    let (p, q) = (f.at(z, None).norm(), slope.at(z, None).norm());
    (!q.is_zero()).then(|| &p.root_of_quotient_above(&q) * &Float::from(BigInt::from(d)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, oscillator, push};
    use crate::base::Number;
    use crate::system::{CoordinateId, Nature};

    fn of_whole(system: &LinearSystem) -> Option<Exact> {
        let local: Vec<u32> = (0..system.n() as u32).collect();
        exact_poles(system, &Part::whole(system), &local)
    }

    fn poles_of(system: &LinearSystem) -> ExactPoles {
        match of_whole(system) {
            Some(Exact::Poles(poles)) => poles,
            _ => panic!("as many as the degree"),
        }
    }

    /// Oscillators side by side: m, c and k of each.
    fn side_by_side(list: &[[&str; 3]]) -> LinearSystem {
        let mut system = blank(list.len());
        for (i, [m, c, k]) in list.iter().enumerate() {
            for (form, weight) in [(&mut system.m, m), (&mut system.c, c), (&mut system.k, k)] {
                if !weight.is_empty() {
                    push(form, weight, i, None);
                }
            }
        }
        system
    }

    /// (s + 1)^2 with one vector and with two, a pair, a motion that is free, one without mass, and three masses in a row between
    /// walls, where s^2 = -2 + sqrt 2, -2 and -2 - sqrt 2.
    #[test]
    fn poles_of_small_systems_are_those_of_the_closed_form() {
        let check = |system: &LinearSystem, degree: usize, zeros: usize, expected: &[(f64, f64, usize, bool)]| {
            let found = poles_of(system);
            assert_eq!((found.degree(), found.zeros()), (degree, zeros));
            assert_eq!(found.roots().len(), expected.len(), "{found:?}");
            for (root, &(re, im, multiplicity, defective)) in found.roots().iter().zip(expected) {
                let facts = (root.multiplicity, root.defective, root.real);
                assert_eq!(facts, (multiplicity, defective, im == 0.0), "{root:?}");
                for (part, truth) in [(root.s.re, re), (root.s.im, im)] {
                    assert!((part.to_f64() - truth).abs() <= part.rad + 1e-15 && part.rad < 1e-30, "{root:?}");
                }
            }
        };
        check(&oscillator("1", "2", "1"), 2, 0, &[(-1.0, 0.0, 2, true)]);
        let same = ["1", "3", "2"];
        check(&side_by_side(&[same, same]), 4, 0, &[(-1.0, 0.0, 2, false), (-2.0, 0.0, 2, false)]);
        check(&oscillator("1", "2", "5"), 2, 0, &[(-1.0, 2.0, 1, false)]);
        check(&side_by_side(&[["1", "1", ""], ["", "1", "3"]]), 3, 1, &[(-1.0, 0.0, 1, false), (-3.0, 0.0, 1, false)]);
        let mut row = side_by_side(&[["1", "", ""]; 3]);
        (0..3).for_each(|i| push(&mut row.k, "1", i, i.checked_sub(1)));
        push(&mut row.k, "1", 2, None);
        let root = 2f64.sqrt();
        let expected = [2.0 - root, 2.0, 2.0 + root].map(|square| (0.0, square.sqrt(), 1, false));
        check(&row, 6, 0, &expected);
    }

    #[test]
    fn what_has_no_polynomial_or_a_large_one_is_told() {
        assert!(matches!(of_whole(&side_by_side(&[["1", "1", "1"], ["", "", ""]])), Some(Exact::Singular)));
        let large = side_by_side(&[["1", "", "1"]; MOST_COORDINATES + 1]);
        let local: Vec<u32> = (0..large.n() as u32).collect();
        assert!(of_whole(&large).is_none() && half_planes_of(&large, &Part::whole(&large), &local).is_none());
    }

    /// 2 (3 x - y / 2)^2 + 5 y^2
    #[test]
    fn a_matrix_is_the_sum_of_its_terms() {
        let mut form = Form::new();
        push(&mut form, "5", 1, None);
        let source = form.term(0).source;
        let row = [(CoordinateId(0), Number::from("3")), (CoordinateId(1), -&Number::from("0.5"))];
        form.push(source, Nature::Property, Number::from("2"), row);
        let found = assemble(&form, &[0, 1], &[0, 1], 2).expect("rational");
        let found: Vec<f64> = found.iter().flatten().map(Rational::to_f64).collect();
        assert_eq!(found, [18.0, -3.0, -3.0, 5.5]);
    }

    fn polynomial(coefficients: &[i64]) -> Polynomial {
        Polynomial::new(coefficients.iter().map(|&a| a.into()).collect())
    }

    /// s^2 + 4 s + 3 at 2, and at i: 2 + 4 i.
    #[test]
    fn a_polynomial_has_its_values() {
        let f = polynomial(&[3, 4, 1]);
        for (s, truth) in [((2.0, 0.0), (15.0, 0.0)), ((0.0, 1.0), (2.0, 4.0))] {
            let found = super::value(&f, &value(s.0, s.1), None);
            let same = |a: &Float, b: f64| (a - &Float::from(b)).sign() == Ordering::Equal;
            assert!(same(&found.re, truth.0) && same(&found.im, truth.1), "{s:?}");
        }
    }

    #[test]
    fn the_hull_gives_the_sizes_of_roots() {
        // (s + 1)(s + 2^20)
        let f = polynomial(&[1 << 20, 1 + (1 << 20), 1]);
        assert_eq!(upper_hull(&f), [(0, 21), (1, 21), (2, 1)]);
    }

    #[test]
    fn roots_closer_than_double_double_are_separated() {
        // (10^20 s - 10^20 - 1)(s - 1) and a pair.
        let big = BigInt::from(10).pow(40u32);
        let near = Polynomial::new(vec![&big + 1, -(&big * BigInt::from(2) + BigInt::one()), big]);
        let roots = roots(&near).expect("they are simple");
        assert_eq!(roots.len(), 2);
        assert!(roots.iter().all(|(s, real)| *real && (s.re.to_f64() - 1.0).abs() < 1e-15));
    }

    #[test]
    fn roots_on_and_off_the_axis() {
        // (s^2 + 2 s + 5)(s + 3)
        let roots = roots(&polynomial(&[15, 11, 5, 1])).expect("they are simple");
        let near = |s: &Complex<Ball>, re: f64, im: f64| (s.re.to_f64(), s.im.to_f64()) == (re, im);
        assert!(near(&roots[0].0, -1.0, 2.0) && !roots[0].1);
        assert!(near(&roots[1].0, -3.0, 0.0) && roots[1].1);
    }

    fn value(re: f64, im: f64) -> ComplexFloat {
        ComplexFloat::new(Float::from(re), Float::from(im))
    }

    /// Discs that touch, a missing disc, and discs on and off the axis that contain the same root prove nothing.
    #[test]
    fn values_that_are_not_separated_are_not_roots() {
        // (s + 1)(s + 3)
        let f = polynomial(&[3, 4, 1]);
        let slope = f.derivative();
        let tiny = 1e-80;
        let separated = |values: &[ComplexFloat]| disjoint_discs(&f, &slope, values);
        assert_eq!(separated(&[value(-1.0, 0.0), value(-3.0, 0.0)]).map(|list| list.len()), Some(2));
        assert!(separated(&[value(-1.0, 0.0), value(-1.0, tiny)]).is_none(), "one twice");
        assert!(separated(&[value(-1.0, tiny), value(-1.0, -tiny)]).is_none(), "a real one as a pair");
        assert!(separated(&[value(-1.0, 0.0)]).is_none(), "one is missing");
        assert!(separated(&[value(-1.0, 0.0), value(-2.9, 0.0)]).is_none(), "not sharp");
        // The distance from the axis is less than the disc's radius.
        let real = separated(&[value(-1.0, tiny), value(-3.0, -tiny)]).expect("they are simple");
        assert!(real.iter().all(|(s, real)| *real && s.im.is_zero()));
    }

    /// Discs that touch are not separated roots, even for values whose squares exceed binary64.
    #[test]
    fn large_values_are_separated_exactly() {
        let big = BigInt::from(10).pow(160u32);
        // (s + b)(s + 3 b)
        let f = Polynomial::new(vec![BigInt::from(3) * &big * &big, BigInt::from(4) * &big, BigInt::one()]);
        let at = |times: i64| ComplexFloat::new(Float::from(BigInt::from(-times) * &big), Float::zero());
        assert_eq!(disjoint_discs(&f, &f.derivative(), &[at(1), at(3)]).map(|list| list.len()), Some(2));
        assert!(disjoint_discs(&f, &f.derivative(), &[at(1), at(1)]).is_none());
    }

    /// The nearest root of (s + 1)^3 is exactly as far away as n |f / f'| says: no smaller radius would do.
    #[test]
    fn a_radius_reaches_the_nearest_root() {
        let f = polynomial(&[1, 3, 3, 1]);
        let radius = radius(&f, &f.derivative(), &value(-0.5, 0.0), f.degree()).expect("a slope");
        assert!(!is_less(&radius, &Float::from(0.5)), "{radius:?}");
    }

    /// Discs of radius 1 whose centres are 1.5 apart meet, although each is outside the other's centre.
    #[test]
    fn discs_that_meet_are_not_disjoint() {
        let disc = |at: f64, radius: f64| Rooted { z: value(at, 0.0), radius: Float::from(radius) };
        for unit in [1e-6, 1.0, 1e6] {
            assert!(!disc(0.0, unit).is_apart_from(&disc(1.5 * unit, unit)));
            assert!(disc(0.0, 0.5 * unit).is_apart_from(&disc(1.5 * unit, 0.5 * unit)));
            // 2^-110 is the last bit that is kept.
            let is_sharp = |share: f64| disc(unit, share * unit).is_sharp();
            assert!(is_sharp(2f64.powi(-111)) && !is_sharp(2f64.powi(-109)));
        }
    }

    /// A disc of s^2 + 1 that meets the axis is moved there, and needs the radius of its new centre to contain i or -i.
    #[test]
    fn a_disc_that_is_moved_to_the_axis_still_holds_a_root() {
        let f = polynomial(&[1, 0, 1]);
        let disc = Rooted::disc_around(&f, &f.derivative(), &value(0.01, 0.7)).expect("a slope");
        let to_a_root = &disc.z - &value(0.0, 1.0);
        assert!(!is_less(&(&disc.radius * &disc.radius), &to_a_root.norm()), "{:?}", disc.radius);
    }

    #[test]
    fn roots_that_are_not_as_many_as_the_degree_are_no_list() {
        let root = ExactRoot { s: Complex::new(Ball::ZERO, Ball::ONE), multiplicity: 2, real: false, defective: false };
        assert!(ExactPoles::with_count(1, vec![root.clone()], 5).is_some());
        assert!(ExactPoles::with_count(1, vec![root.clone()], 6).is_none());
        assert!(ExactPoles::with_count(1, vec![root], 4).is_none());
    }

    /// Two blocks with the poles -1 and -2, each double and with one vector, twice in turned coordinates: four poles with two vectors.
    #[test]
    fn four_poles_with_two_vectors_are_defective() {
        let mut four = blank(4);
        let number = |x: &str| match x.strip_prefix('-') {
            Some(x) => -&Number::from(x),
            None => Number::from(x),
        };
        let add = |form: &mut Form, weight: &str, row: &[(u32, Number)]| {
            let source = form.source(blank(1).coordinates[0].name);
            form.push(source, Nature::Property, number(weight), row.iter().map(|(i, x)| (CoordinateId(*i), x.clone())));
        };
        for turn in [["0.6", "0.8"], ["0.8", "-0.6"]] {
            let [p, q] = turn.map(number);
            let first = [(0, p.clone()), (2, q.clone())];
            let second = [(1, p.clone()), (3, q.clone())];
            let between = [(0, p.clone()), (1, -&p), (2, q.clone()), (3, -&q)];
            add(&mut four.m, "1", &first);
            add(&mut four.m, "1", &second);
            add(&mut four.k, "2", &first);
            add(&mut four.k, "2", &between);
            add(&mut four.c, "3", &first);
            add(&mut four.c, "1", &second);
            add(&mut four.c, "1", &between);
        }
        let found = poles_of(&four);
        let told: Vec<(f64, usize, bool)> =
            found.roots().iter().map(|root| (root.s.re.to_f64(), root.multiplicity, root.defective)).collect();
        assert_eq!(told, [(-1.0, 4, true), (-2.0, 4, true)]);
    }
}
