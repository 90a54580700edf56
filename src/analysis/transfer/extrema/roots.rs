//! The roots of a polynomial with integer coefficients, as many as its degree: each with its multiplicity, and whether
//! it lies on the real or on the imaginary axis, exactly. In: a polynomial. Out: centres with enough digits that the
//! distance of any two roots, and of a root from the imaginary axis, is known to more digits than double-double has.
//! See docs/method/transfer.md#extrema.

use super::far::Far;
use crate::analysis::poles::exact::{circles, iterate, value};
use crate::base::{Ball, Power, down, up};
use crate::kernel::big_float::{ComplexFloat, Float};
use crate::kernel::complex::Complex;
use crate::kernel::polynomial::Polynomial;
use num_bigint::BigInt;
use num_traits::Zero;
use std::cmp::Ordering;

/// A root, or a conjugate pair represented by the root with a positive imaginary part.
#[derive(Clone, Debug)]
pub struct Root {
    /// The root lies within the radius of this centre, rad/s; a part that is exactly zero is stored as zero.
    pub centre: ComplexFloat,
    pub radius: Float,
    pub multiplicity: usize,
    pub place: Place,
}

/// Exact information about the position of a root.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A single real root.
    Real,
    /// On the imaginary axis with its conjugate, not at zero.
    Axis,
    /// Off both axes, with its conjugate.
    Pair,
}

/// First and last working precision for roots, in bits.
const FIRST_BITS: u64 = 160;
const MOST_BITS: u64 = 2560;
/// Radii are below 2^-SHARP of the root, and of its distance from the imaginary axis.
const SHARP: i64 = 110;

/// The coefficients of a polynomial: integers, or numbers within a radius of integers.
#[derive(Clone, Debug)]
pub struct Coefficients {
    pub middle: Polynomial,
    /// By power; empty if the coefficients are exact.
    pub radii: Vec<f64>,
    /// The number of powers above those of `middle` that may be there too, each within its radius of zero: as many roots,
    /// or fewer, are beyond a frequency at which the others are the larger ones.
    pub far: usize,
}

/// f(s) = lead prod (s - z) prod (1 - s / far)
#[derive(Clone, Debug)]
pub struct Roots {
    pub list: Vec<Root>,
    pub lead: Ball,
    pub far: Far,
}

impl Coefficients {
    pub fn exact(middle: Polynomial) -> Coefficients {
        Coefficients { middle, radii: Vec::new(), far: 0 }
    }

    pub fn is_exact(&self) -> bool {
        self.radii.is_empty()
    }

    /// The coefficient of the highest power.
    pub fn lead(&self) -> Ball {
        let lead = self.middle.coefficients().last().cloned().unwrap_or_default();
        Float::from(lead).to_ball(self.radius(self.middle.degree()))
    }

    fn radius(&self, power: usize) -> f64 {
        self.radii.get(power).copied().unwrap_or(0.0)
    }

    /// The sum of radius times |s|^power at |s| = size.
    fn blur(&self, size: &Float) -> Float {
        self.radii.iter().rev().fold(Float::zero(), |sum, &radius| (&(&sum * size) + &Float::from(radius)).cut(64))
    }

    fn derivative(&self) -> Coefficients {
        let radii = self.radii.iter().enumerate().skip(1).map(|(k, radius)| radius * k as f64 * (1.0 + f64::EPSILON));
        Coefficients { middle: self.middle.derivative(), radii: radii.collect(), far: self.far }
    }

    /// The highest power that may be there.
    fn degree(&self) -> usize {
        self.middle.degree() + self.far
    }

    /// An upper bound of a coefficient.
    fn size(&self, power: usize) -> f64 {
        let middle = self.middle.coefficients().get(power).cloned().unwrap_or_default();
        rounded_up(&Float::from(middle).abs()) + self.radius(power)
    }

    /// The coefficients of the highest powers that may vanish are moved into radii; and R, such that for |s| = R the
    /// highest power that remains outweighs all others together. By Rouche's theorem as many roots as its exponent
    /// are within that circle, whatever the others are. `None` if there is no such circle.
    fn without_far_roots(&self) -> Option<(Coefficients, f64)> {
        let powers = self.middle.coefficients().len().max(self.radii.len());
        let highest = (0..powers).rev().find(|k| self.size(*k) > 0.0)?;
        let least = |k: usize| {
            let middle = self.middle.coefficients().get(k).cloned().unwrap_or_default();
            Float::from(middle).abs().to_f64() * down::FEW - self.radius(k)
        };
        let last = (0..=highest).rev().find(|k| least(*k) > self.radius(*k))?;
        let far = highest - last;
        if far == 0 {
            return Some((self.clone(), f64::INFINITY));
        }
        let beyond = (last + 1..=highest).filter(|k| self.size(*k) > 0.0).map(|k| {
            let share = least(last) / (4.0 * far as f64 * self.size(k));
            libm::pow(share, 1.0 / (k - last) as f64)
        });
        let circle = beyond.fold(f64::INFINITY, f64::min);
        let others = (0..=highest).filter(|k| *k != last);
        let others: f64 = others.map(|k| self.size(k) * circle.power(k as i32 - last as i32)).sum();
        let radii = (0..=highest).map(|k| if k > last { self.size(k) } else { self.radius(k) }).collect();
        let middle = Polynomial::new(self.middle.coefficients()[..=last].to_vec());
        (others * up::MILLIONS < least(last)).then_some((Coefficients { middle, radii, far }, circle))
    }

    /// How often s certainly divides the polynomial, and the quotient; `None` if the number of roots, or of those at
    /// zero, is not certain.
    fn without_zero_roots(&self) -> Option<(usize, Coefficients)> {
        let (zeros, middle) = self.middle.without_zero_roots();
        let radii: Vec<f64> = self.radii.iter().skip(zeros).copied().collect();
        let nothing = |radius: &f64| *radius == 0.0;
        let certain = self.radii.iter().take(zeros).all(nothing)
            && radii.iter().skip(middle.degree() + self.far + 1).all(nothing);
        let rest = Coefficients { middle, radii, far: self.far };
        let ends = [0, rest.middle.degree()].map(|power| {
            Float::from(rest.middle.coefficients()[power].clone()).to_f64().abs() > 2.0 * rest.radius(power)
        });
        (certain && ends == [true; 2]).then_some((zeros, rest))
    }
}

/// The largest product of the numbers of near and far roots and the ratio of their sizes.
const FAR: f64 = 1e-3;

/// The roots of a polynomial of which the highest coefficients may be zero: those that are certainly there, and how far
/// away the others are at least. `None` if they cannot be separated.
pub fn near_and_far(f: &Coefficients) -> Option<Roots> {
    if f.is_exact() {
        return Some(Roots { list: roots(f)?, lead: f.lead(), far: Far::NONE });
    }
    let (near, beyond) = f.without_far_roots()?;
    let list = roots(&near)?;
    let size = |root: &Root| {
        let centre = rounded_up(&root.centre.re.abs()) + rounded_up(&root.centre.im.abs());
        centre + rounded_up(&root.radius)
    };
    let largest = list.iter().map(size).fold(0.0, f64::max);
    let far = Far { count: near.far, beyond };
    // The coefficient of the highest near power is the factor, times 1 + the sum of products of as many near roots as
    // reciprocals of far ones.
    let spread = far.count as f64 * near.middle.degree() as f64 * (largest / beyond) * up::DOZENS;
    let lead = near.lead();
    (spread <= FAR).then(|| Roots { list, lead: lead.widen(2.0 * spread * lead.magnitude()), far })
}

/// All roots; `None` if they cannot be separated.
pub fn roots(f: &Coefficients) -> Option<Vec<Root>> {
    let (zeros, rest) = f.without_zero_roots()?;
    let mut list = Vec::new();
    if zeros > 0 {
        let (centre, radius) = (ComplexFloat::zero(), Float::zero());
        list.push(Root { centre, radius, multiplicity: zeros, place: Place::Real });
    }
    if f.is_exact() {
        for (index, factor) in rest.middle.by_multiplicity()?.iter().enumerate() {
            let (even, other) = split(factor)?;
            list.extend(simple(&Coefficients::exact(even), true, index + 1)?);
            list.extend(simple(&Coefficients::exact(other), false, index + 1)?);
        }
    } else {
        let even = rest.middle.coefficients().iter().skip(1).step_by(2).all(Zero::is_zero)
            && rest.radii.iter().skip(1).step_by(2).all(|radius| *radius == 0.0);
        list.extend(simple(&rest, even, 1)?);
    }
    let count: usize = list.iter().map(Root::count).sum();
    (count == f.middle.degree()).then_some(list)
}

/// f = g(s^2) h(s) with the largest g: with f = E(s^2) + s O(s^2) it is the common divisor of E and O. A root on the
/// imaginary axis is one of E and O, so h has none.
fn split(f: &Polynomial) -> Option<(Polynomial, Polynomial)> {
    let part = |from: usize| Polynomial::new(f.coefficients().iter().skip(from).step_by(2).cloned().collect());
    let common = part(0).gcd(&part(1))?;
    let spread = common.coefficients().iter().flat_map(|a| [a.clone(), BigInt::zero()]).collect();
    let even = Polynomial::new(spread);
    let other = f.primitive().divided_by(&even.primitive())?;
    Some((even, other))
}

/// The roots of a polynomial whose roots are simple and nonzero. Those of a polynomial in s^2 (`even`) are symmetric
/// about both axes.
fn simple(f: &Coefficients, even: bool, multiplicity: usize) -> Option<Vec<Root>> {
    if f.middle.degree() == 0 {
        return Some(Vec::new());
    }
    let slope = f.derivative();
    let mut values = in_binary64(&f.middle, circles(&f.middle));
    let mut bits = FIRST_BITS;
    // More digits do not help if the coefficients are not exact.
    let most = if f.is_exact() { MOST_BITS } else { FIRST_BITS };
    while bits <= most {
        iterate(&f.middle, &slope.middle, &mut values, bits);
        if let Some(discs) = discs(f, &slope, &values, even) {
            return Some(discs.into_iter().filter_map(|disc| disc.root(multiplicity)).collect());
        }
        bits *= 2;
    }
    None
}

/// The most sweeps in binary64; a dozen are usual.
const MOST_SWEEPS: usize = 80;

/// Better initial values, as good as binary64 allows: the Ehrlich-Aberth iteration on f(2^e z), scaled so that the
/// roots' geometric mean is near one. Nothing is proved here; if coefficients leave the range of binary64, returns
/// `start`.
fn in_binary64(f: &Polynomial, start: Vec<ComplexFloat>) -> Vec<ComplexFloat> {
    let a = f.coefficients();
    let d = f.degree();
    let bits = |k: usize| a[k].bits() as i64;
    let e = (bits(0) - bits(d)).div_euclid(d as i64);
    let raised = |k: usize| Float::from(a[k].clone()).times_power_of_two(e * k as i64);
    let most = (0..=d).filter_map(|k| raised(k).ceiling_log2()).max().unwrap_or(0);
    let scaled: Vec<f64> = (0..=d).map(|k| raised(k).times_power_of_two(-most).to_f64()).collect();
    let mut z: Vec<Complex<f64>> = (start.iter())
        .map(|z| {
            Complex::new(z.re.clone().times_power_of_two(-e).to_f64(), z.im.clone().times_power_of_two(-e).to_f64())
        })
        .collect();
    for _ in 0..MOST_SWEEPS {
        let mut largest = 0.0f64;
        for i in 0..z.len() {
            let others = (z.iter().enumerate().filter(|(j, _)| *j != i))
                .fold(Complex::ZERO, |sum, (_, &other)| sum + (z[i] - other).recip());
            let step = (logarithmic_slope(&scaled, z[i]) - others).recip();
            if step.is_finite() {
                z[i] = z[i] - step;
                largest = largest.max(step.one_norm() / z[i].one_norm());
            }
        }
        if largest < 1e-14 {
            break;
        }
    }
    if !z.iter().all(|z| z.is_finite() && z.one_norm() > 0.0) {
        return start;
    }
    let back = |x: f64| Float::from(x).times_power_of_two(e);
    z.iter().map(|z| ComplexFloat::new(back(z.re), back(z.im))).collect()
}

/// f'/f in binary64, from the reversed polynomial outside the unit circle.
fn logarithmic_slope(a: &[f64], z: Complex<f64>) -> Complex<f64> {
    let horner = |mut coefficients: Box<dyn Iterator<Item = &f64> + '_>, z: Complex<f64>| {
        let first = coefficients.next().copied().unwrap_or(0.0);
        coefficients.fold((Complex::real(first), Complex::ZERO), |(value, slope), &a| {
            (value * z + Complex::real(a), slope * z + value)
        })
    };
    if z.abs() <= 1.0 {
        let (value, slope) = horner(Box::new(a.iter().rev()), z);
        slope * value.recip()
    } else {
        // With q(w) = w^d f(1/w): f'/f = w (d - w q'/q).
        let w = z.recip();
        let (value, slope) = horner(Box::new(a.iter()), w);
        w * (Complex::real((a.len() - 1) as f64) - w * slope * value.recip())
    }
}

/// A disc that contains a root.
struct RootDisc {
    centre: ComplexFloat,
    radius: Float,
}

/// Discs |s - z| <= d |f / f'|: each contains a root (Laguerre; Henrici, Applied and Computational Complex Analysis I,
/// 6.4), and d disjoint ones contain them all. `None` if they touch one another or the real axis, or are wider than
/// necessary.
fn discs(f: &Coefficients, slope: &Coefficients, values: &[ComplexFloat], even: bool) -> Option<Vec<RootDisc>> {
    let discs: Vec<RootDisc> = values.iter().map(|z| RootDisc::around(f, slope, z, even)).collect::<Option<_>>()?;
    let apart = |(i, a): (usize, &RootDisc)| discs[..i].iter().all(|b| a.is_apart_from(b));
    let sharp = |disc: &RootDisc| disc.is_certain() && (!f.is_exact() || disc.is_sharp());
    let whole = discs.len() == f.middle.degree() && discs.iter().enumerate().all(apart) && discs.iter().all(sharp);
    whole.then_some(discs)
}

impl RootDisc {
    /// The disc around z; if that meets an axis of symmetry, the disc around the nearest point of the axis instead: it
    /// also contains the mirror image of its root, so that the root, if it is the only one, is on the axis.
    fn around(f: &Coefficients, slope: &Coefficients, z: &ComplexFloat, even: bool) -> Option<RootDisc> {
        let radius = radius(f, slope, z)?;
        let centre = if !is_less(&radius, &z.im.abs()) {
            ComplexFloat::new(z.re.clone(), Float::zero())
        } else if even && !is_less(&radius, &z.re.abs()) {
            ComplexFloat::new(Float::zero(), z.im.clone())
        } else {
            return Some(RootDisc { centre: z.clone(), radius });
        };
        let radius = self::radius(f, slope, &centre)?;
        Some(RootDisc { centre, radius })
    }

    fn is_apart_from(&self, other: &RootDisc) -> bool {
        let reach = &self.radius + &other.radius;
        is_less(&(&reach * &reach), &(&self.centre - &other.centre).norm())
    }

    /// Whether it is certain that its root is real, or one of a pair.
    fn is_certain(&self) -> bool {
        !self.centre.is_zero() && (self.centre.im.is_zero() || is_less(&self.radius, &self.centre.im.abs()))
    }

    /// Whether the radius is small relative to the root and its distance from the imaginary axis.
    fn is_sharp(&self) -> bool {
        let wide = self.radius.clone().times_power_of_two(SHARP);
        let clear = self.centre.re.is_zero() || is_less(&wide, &self.centre.re.abs());
        clear && is_less(&(&wide * &wide), &self.centre.norm())
    }

    /// `None` for the lower root of a pair.
    fn root(self, multiplicity: usize) -> Option<Root> {
        let RootDisc { centre, radius } = self;
        let place = match (centre.re.is_zero(), centre.im.is_zero()) {
            (_, true) => Place::Real,
            (true, false) => Place::Axis,
            (false, false) => Place::Pair,
        };
        (!centre.im.is_negative()).then_some(Root { centre, radius, multiplicity, place })
    }
}

impl Root {
    /// Number of roots of the polynomial that this disc represents.
    fn count(&self) -> usize {
        if self.place == Place::Real { self.multiplicity } else { 2 * self.multiplicity }
    }
}

/// An upper bound of d |f(z) / f'(z)| for all coefficients within their radii.
fn radius(f: &Coefficients, slope: &Coefficients, z: &ComplexFloat) -> Option<Float> {
    let (p, q) = (value(&f.middle, z, None).norm(), value(&slope.middle, z, None).norm());
    if q.is_zero() {
        return None;
    }
    let degree = Float::from(BigInt::from(f.degree()));
    let exactly = &p.root_of_quotient_above(&q) * &degree;
    if f.is_exact() {
        return Some(exactly);
    }
    // (|f| + df) / (|f'| - df') <= (|f / f'| + df / |f'|) / (1 - df' / |f'|), and the divisor must be above a half.
    let size = &z.re.abs() + &z.im.abs();
    let over = |blur: Float| (&blur * &blur).root_of_quotient_above(&q);
    let (above, below) = (over(f.blur(&size)), over(slope.blur(&size)));
    let sum = &exactly + &(&above * &degree);
    is_less(&below, &Float::from(0.5)).then(|| sum.times_power_of_two(1))
}

/// Not below the number, which is not negative.
fn rounded_up(x: &Float) -> f64 {
    if x.is_zero() { 0.0 } else { x.to_f64() * (1.0 + 4.0 * f64::EPSILON) + f64::MIN_POSITIVE }
}

fn is_less(a: &Float, b: &Float) -> bool {
    (b - a).sign() == Ordering::Greater
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_traits::One;

    fn polynomial(coefficients: &[i64]) -> Polynomial {
        Polynomial::new(coefficients.iter().map(|&a| a.into()).collect())
    }

    fn rounded(x: &Float) -> f64 {
        x.to_ball(0.0).to_f64()
    }

    fn reported(f: &Polynomial) -> Vec<(f64, f64, usize, Place)> {
        let mut list: Vec<_> = (roots(&Coefficients::exact(f.clone())).expect("roots").iter())
            .map(|root| (rounded(&root.centre.re), rounded(&root.centre.im), root.multiplicity, root.place))
            .collect();
        list.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        list
    }

    /// s^2 (s^2 + 4)(s^2 - 9)(s + 1)(s^2 + 2 s + 5), multiplied out by hand.
    #[test]
    fn roots_on_the_axes_and_off_them() {
        // (s^2 + 4)(s^2 - 9) = s^4 - 5 s^2 - 36; (s + 1)(s^2 + 2 s + 5) = s^3 + 3 s^2 + 7 s + 5.
        let f = polynomial(&[0, 0, -180, -252, -133, -71, -10, 2, 3, 1]);
        let expected = [
            (-3.0, 0.0, 1, Place::Real),
            (-1.0, 0.0, 1, Place::Real),
            (-1.0, 2.0, 1, Place::Pair),
            (0.0, 0.0, 2, Place::Real),
            (0.0, 2.0, 1, Place::Axis),
            (3.0, 0.0, 1, Place::Real),
        ];
        assert_eq!(reported(&f), expected);
    }

    /// 10^60 s^2 + 2 s + 10^60: a damping ratio of 1e-60 is not zero.
    #[test]
    fn a_root_next_to_the_axis_is_not_on_it() {
        let big = BigInt::from(10).pow(60u32);
        let roots = roots(&Coefficients::exact(Polynomial::new(vec![big.clone(), 2.into(), big]))).expect("roots");
        assert_eq!((roots.len(), roots[0].place), (1, Place::Pair));
        assert!((roots[0].centre.re.to_f64() / -1e-60 - 1.0).abs() < 1e-15);
    }

    #[test]
    fn repeated_roots_are_counted() {
        // (s^2 + 1)^2 (s + 2)^3
        let f = polynomial(&[8, 12, 22, 25, 20, 14, 6, 1]);
        assert_eq!(reported(&f), [(-2.0, 0.0, 3, Place::Real), (0.0, 1.0, 2, Place::Axis)]);
    }

    /// s^2 + 2 s + 5 with coefficients off by 1e-3: the discs contain the roots of s^2 + 2.001 s + 5.001.
    #[test]
    fn uncertain_coefficients_widen_the_discs() {
        let f = Coefficients { middle: polynomial(&[5, 2, 1]), radii: vec![1e-3, 1e-3, 0.0], far: 0 };
        let found = roots(&f).expect("apart");
        let (re, im) = (-1.0005, (5.001f64 - 1.0005 * 1.0005).sqrt());
        let distance = (rounded(&found[0].centre.re) - re).hypot(rounded(&found[0].centre.im) - im);
        let radius = found[0].radius.to_f64();
        assert!(distance <= radius && radius < 5e-3, "{distance} {radius}");
        // A root that may be at zero is not reported.
        assert!(roots(&Coefficients { middle: polynomial(&[5, 2, 1]), radii: vec![6.0, 0.0, 0.0], far: 0 }).is_none());
    }

    #[test]
    fn a_constant_has_none() {
        assert!(roots(&Coefficients::exact(Polynomial::new(vec![BigInt::one()]))).expect("no roots").is_empty());
    }

    /// The nearest root of (s + 1)^3 is exactly as far away as n |f / f'| says: no smaller radius would do.
    #[test]
    fn a_radius_reaches_the_nearest_root() {
        let f = Coefficients::exact(polynomial(&[1, 3, 3, 1]));
        let at = ComplexFloat::new(Float::from(-0.5), Float::zero());
        let radius = radius(&f, &f.derivative(), &at).expect("a slope");
        assert!(!is_less(&radius, &Float::from(0.5)), "{radius:?}");
    }

    /// (s - 1)(s - 100), with the middle coefficient known to 60: the slope at 1, -99, is known to 60, which is more
    /// than half of it.
    #[test]
    fn a_slope_that_is_hardly_known_gives_no_radius() {
        let at = ComplexFloat::new(Float::from(1.0), Float::zero());
        let radius = |wide: f64| {
            let f = Coefficients { middle: polynomial(&[100, -101, 1]), radii: vec![0.0, wide, 0.0], far: 0 };
            radius(&f, &f.derivative(), &at)
        };
        assert!(radius(60.0).is_none() && radius(1.0).is_some());
    }

    /// Discs of radius 1 whose centres are 1.5 apart meet, although each is outside the other's centre.
    #[test]
    fn discs_that_meet_are_not_disjoint() {
        let disc =
            |at: f64| RootDisc { centre: ComplexFloat::new(Float::from(at), Float::zero()), radius: Float::from(1.0) };
        assert!(!disc(0.0).is_apart_from(&disc(1.5)) && disc(0.0).is_apart_from(&disc(2.5)));
    }

    /// A disc of s^2 + 1 that meets the axis is moved there, and needs the radius of its new centre to contain i or -i.
    #[test]
    fn a_disc_that_is_moved_to_an_axis_still_holds_a_root() {
        let f = Coefficients::exact(polynomial(&[1, 0, 1]));
        let at = ComplexFloat::new(Float::from(0.01), Float::from(0.7));
        let disc = RootDisc::around(&f, &f.derivative(), &at, false).expect("a slope");
        let to_a_root = &disc.centre - &ComplexFloat::new(Float::zero(), Float::from(1.0));
        assert!(!is_less(&(&disc.radius * &disc.radius), &to_a_root.norm()), "{:?}", disc.radius);
    }

    /// (s + 2)(s + 3)(1e12 - s) with a highest coefficient that may be zero: two roots, one at 1e12 or beyond, and the
    /// factor 1e12. The constant 0 and coefficients that leave nothing certain give none.
    #[test]
    fn roots_that_may_be_at_infinity_are_far() {
        let middle = polynomial(&[6_000_000_000_000, 4_999_999_999_994, 999_999_999_995, -1]);
        let found = near_and_far(&Coefficients { middle, radii: vec![0.0, 0.0, 0.0, 1.0], far: 0 }).expect("roots");
        let mut places: Vec<Ball> =
            found.list.iter().map(|root| root.centre.re.to_ball(rounded_up(&root.radius))).collect();
        places.sort_by(|a, b| a.mid.hi.total_cmp(&b.mid.hi));
        for (place, truth) in places.iter().zip([-3.0, -2.0]) {
            assert!((*place - Ball::from(truth)).contains_zero() && place.rad < 1e-9, "{place:?}");
        }
        assert_eq!((places.len(), found.far.count), (2, 1));
        // -2 s^3 may be there: a root at 5e11.
        assert!((1e10..=5e11).contains(&found.far.beyond), "{:?}", found.far);
        assert!((found.lead - Ball::from(1e12)).contains_zero() && found.lead.relative_error() < 1e-8, "{found:?}");
        // s^2 + (0 +- 1) s^3: the far root may be at 1.
        let near = Coefficients { middle: polynomial(&[1, 0, 1]), radii: vec![0.0, 0.0, 0.0, 1.0], far: 0 };
        assert!(near_and_far(&near).is_none());
    }
}
