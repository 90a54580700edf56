//! The roots of a polynomial with integer coefficients, as many as its degree: each with its multiplicity, and whether
//! it lies on the real or on the imaginary axis, exactly. In: a polynomial. Out: centres with enough digits that the
//! distance of any two roots, and of a root from the imaginary axis, is known to more digits than double-double has.
//! See docs/method/transfer.md#extrema.

use super::far::Far;
use crate::analysis::poles::exact::{circles, iterate, value};
use crate::base::{Ball, up};
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
    /// As many roots as the multiplicity are within the radius, and nothing more is known of them.
    Cluster,
}

impl Place {
    /// Whether the disc stands for itself alone, and not for its conjugate too.
    pub fn is_alone(self) -> bool {
        matches!(self, Place::Real | Place::Cluster)
    }
}

/// First and last working precision for roots, in bits.
const FIRST_BITS: u64 = 160;
const MOST_BITS: u64 = 2560;
/// Radii are below 2^-SHARP of the root, and of its distance from the imaginary axis.
const SHARP: i64 = 110;

/// Approximate roots are taken for a cluster if they agree to 2^-CLOSE of themselves; its centre is computed to CENTRE_BITS bits.
const CLOSE: i64 = 20;
const CENTRE_BITS: u64 = 128;

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

    /// Bounds of the size of a coefficient from below, negative if it may vanish, and from above.
    fn bounds(&self, power: usize) -> [Float; 2] {
        let middle = Float::from(self.middle.coefficients().get(power).cloned().unwrap_or_default()).abs();
        let radius = Float::from(self.radius(power));
        [&middle - &radius, &middle + &radius]
    }

    fn size(&self, power: usize) -> f64 {
        rounded_up(&self.bounds(power)[1])
    }

    /// Whether the coefficient is larger than twice its radius.
    fn is_certain(&self, power: usize) -> bool {
        is_less(&Float::from(self.radius(power)), &self.bounds(power)[0])
    }

    /// Bounds from above of all coefficients, those that may vanish included.
    fn sizes(&self) -> Vec<Float> {
        let powers = self.middle.coefficients().len().max(self.radii.len());
        (0..powers).map(|k| self.bounds(k)[1].clone()).collect()
    }

    /// The coefficients of the highest powers that may vanish are moved into radii; and R, such that for |s| = R the
    /// highest power that remains outweighs all others together. By Rouche's theorem as many roots as its exponent
    /// are within that circle, whatever the others are. `None` if there is no such circle.
    fn without_far_roots(&self) -> Option<(Coefficients, f64)> {
        let sizes = self.sizes();
        let highest = sizes.iter().rposition(|size| !size.is_zero())?;
        let last = (0..=highest).rev().find(|k| self.is_certain(*k))?;
        let far = highest - last;
        if far == 0 {
            return Some((self.clone(), f64::INFINITY));
        }
        let [least, _] = self.bounds(last);
        let beyond = (last + 1..=highest).filter(|k| self.size(*k) > 0.0).map(|k| {
            let share = least.to_f64() / (4.0 * far as f64 * self.size(k));
            libm::pow(share, 1.0 / (k - last) as f64)
        });
        let circle = beyond.fold(f64::INFINITY, f64::min);
        let radii = (0..=highest).map(|k| if k > last { self.size(k) } else { self.radius(k) }).collect();
        let middle = Polynomial::new(self.middle.coefficients()[..=last].to_vec());
        let holds = circle.is_finite() && outweighs(&sizes, last, &least, &Float::from(circle));
        holds.then_some((Coefficients { middle, radii, far }, circle))
    }

    /// The number of times that s certainly divides the polynomial, and the quotient.
    fn without_zero_roots(&self) -> (usize, Coefficients) {
        if self.is_exact() {
            let (zeros, middle) = self.middle.without_zero_roots();
            return (zeros, Coefficients { middle, ..self.clone() });
        }
        let zeros = (0..=self.middle.degree()).take_while(|k| self.size(*k) == 0.0).count();
        let middle = Polynomial::new(self.middle.coefficients()[zeros.min(self.middle.degree())..].to_vec());
        let radii = self.radii.iter().skip(zeros).copied().collect();
        (zeros, Coefficients { middle, radii, far: self.far })
    }

    /// The coefficients of the lowest powers that may vanish, moved into radii, how many there are, and the radius of a
    /// circle about zero with as many roots. `None` if there is no such circle, or if the highest coefficient may vanish.
    fn without_roots_about_zero(&self) -> Option<(Coefficients, usize, Float)> {
        let degree = self.middle.degree();
        let first = (0..=degree).find(|k| self.is_certain(*k)).filter(|_| self.is_certain(degree))?;
        if first == 0 {
            return Some((self.clone(), 0, Float::zero()));
        }
        let circle = circle_with(&self.sizes(), first, &self.bounds(first)[0])?;
        let middle = self.middle.coefficients().iter().enumerate();
        let middle = Polynomial::new(middle.map(|(k, a)| if k < first { BigInt::zero() } else { a.clone() }).collect());
        let powers = self.radii.len().max(first);
        let radii = (0..powers).map(|k| if k < first { self.size(k) } else { self.radius(k) }).collect();
        Some((Coefficients { middle, radii, far: self.far }, first, circle))
    }

    /// A circle about the mean of some approximate roots that holds as many roots. `None` if none is found.
    fn cluster(&self, values: &[&ComplexFloat]) -> Option<Root> {
        let count = values.len();
        let mean = |part: fn(&ComplexFloat) -> &Float| {
            let sum = values.iter().fold(Float::zero(), |sum, z| &sum + part(z));
            sum.divided_by(&Float::from(BigInt::from(count)), CENTRE_BITS)
        };
        let (re, im) = (mean(|z| &z.re), mean(|z| &z.im));
        // On an axis of symmetry if that is near.
        let [re, im] = [(&re, &im), (&im, &re)].map(|(part, other)| {
            let is_small = is_less(&part.abs().times_power_of_two(CLOSE), &other.abs());
            if is_small { Float::zero() } else { part.clone() }
        });
        let centre = ComplexFloat::new(re, im);
        let middle = shift(&self.middle, &centre);
        let blur = self.shifted_radii(&(&centre.re.abs() + &centre.im.abs()));
        let most = |(k, a): (usize, &ComplexFloat)| {
            let size = &a.re.abs() + &a.im.abs();
            blur.get(k).map_or(size.clone(), |blur| &size + blur)
        };
        let mut sizes: Vec<Float> = middle.iter().enumerate().map(most).collect();
        sizes.extend(blur.iter().skip(sizes.len()).cloned());
        let own = &middle[count];
        let larger = if is_less(&own.re.abs(), &own.im.abs()) { own.im.abs() } else { own.re.abs() };
        let radius = circle_with(&sizes, count, &(&larger - &blur[count]))?;
        Some(Root { centre, radius, multiplicity: count, place: Place::Cluster })
    }

    /// The radii as bounds of the coefficients of powers of s - c, |c| = size.
    fn shifted_radii(&self, size: &Float) -> Vec<Float> {
        let radius = |k: usize| Float::from(self.radius(k));
        let mut list: Vec<Float> = (0..self.radii.len().max(self.middle.coefficients().len())).map(radius).collect();
        for first in 0..list.len().saturating_sub(1) {
            for k in (first..list.len() - 1).rev() {
                list[k] = &list[k] + &(size * &list[k + 1]);
            }
        }
        list
    }
}

/// The coefficients of powers of s - c, exactly.
fn shift(f: &Polynomial, c: &ComplexFloat) -> Vec<ComplexFloat> {
    let real = |a: &BigInt| ComplexFloat::new(Float::from(a.clone()), Float::zero());
    let mut list: Vec<ComplexFloat> = f.coefficients().iter().map(real).collect();
    for first in 0..list.len().saturating_sub(1) {
        for k in (first..list.len() - 1).rev() {
            list[k] = &list[k] + &(c * &list[k + 1]);
        }
    }
    list
}

/// Whether one coefficient, of which a lower bound is given, is larger on a circle than the sum of all others, of which
/// upper bounds are given. By Rouche's theorem as many roots as its power are then within the circle.
fn outweighs(sizes: &[Float], power: usize, least: &Float, circle: &Float) -> bool {
    let (mut at, mut others, mut own) = (Float::from(1.0), Float::zero(), Float::zero());
    for (k, size) in sizes.iter().enumerate() {
        if k == power {
            own = least * &at;
        } else {
            others = &others + &(size * &at);
        }
        at = &at * circle;
    }
    is_less(&others, &own)
}

/// The radius of a circle, small if possible, on which one coefficient outweighs the others; a power of two.
fn circle_with(sizes: &[Float], power: usize, least: &Float) -> Option<Float> {
    let own = Some(least).filter(|least| !least.is_negative())?.ceiling_log2()?;
    // All lower ones together at most a quarter of it.
    let share = 3 + i64::from(power.ilog2());
    let needed = |(k, size): (usize, &Float)| {
        let below = (power - k) as i64;
        size.ceiling_log2().map(|size| (size - own + share + below - 1).div_euclid(below))
    };
    let exponent = sizes[..power].iter().enumerate().filter_map(needed).max()?;
    let circle = Float::from(1.0).times_power_of_two(exponent);
    outweighs(sizes, power, least, &circle).then_some(circle)
}

/// The largest product of the numbers of near and far roots and the ratio of their sizes.
const FAR: f64 = 1e-3;

/// The roots of a polynomial of which the highest coefficients may be zero: those that are certainly there, and how far
/// away the others are at least. `None` if they cannot be separated.
pub fn near_and_far(f: &Coefficients) -> Option<Roots> {
    if f.is_exact() {
        return Some(Roots { list: roots(f)?, lead: f.lead(), far: Far::NONE });
    }
    if !f.radii.iter().all(|radius| radius.is_finite()) {
        return None;
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
    let (zeros, rest) = f.without_zero_roots();
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
        let (rest, about_zero, circle) = rest.without_roots_about_zero()?;
        // Even or odd: symmetric about both axes.
        let other = (about_zero + 1) % 2;
        let even = rest.middle.coefficients().iter().skip(other).step_by(2).all(Zero::is_zero)
            && rest.radii.iter().skip(other).step_by(2).all(|radius| *radius == 0.0);
        let others = simple(&rest, even, 1)?;
        if about_zero > 0 {
            let centre = ComplexFloat::zero();
            let about_zero = Root { centre, radius: circle, multiplicity: about_zero, place: Place::Cluster };
            // All others are outside of the circle, and as many as are left: none is counted twice.
            if !others.iter().all(|root| root.is_apart_from(&about_zero)) {
                return None;
            }
            list.push(about_zero);
        }
        list.extend(others);
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

/// The roots of a polynomial whose roots are simple and nonzero, but for those about zero where its lowest coefficients
/// may vanish. Those of a polynomial in s^2 (`even`), or of s times one, are symmetric about both axes.
fn simple(f: &Coefficients, even: bool, multiplicity: usize) -> Option<Vec<Root>> {
    let (_, others) = f.middle.without_zero_roots();
    if others.degree() == 0 {
        return Some(Vec::new());
    }
    let (slope, slope_of_others) = (f.derivative(), others.derivative());
    let mut values = in_binary64(&others, circles(&others));
    let mut bits = FIRST_BITS;
    // More digits do not help if the coefficients are not exact.
    let most = if f.is_exact() { MOST_BITS } else { FIRST_BITS };
    while bits <= most {
        iterate(&others, &slope_of_others, &mut values, bits);
        if let Some(discs) = discs(f, &slope, &values, even) {
            return Some(discs.into_iter().map(|disc| disc.root(multiplicity)).filter(Root::is_listed).collect());
        }
        bits *= 2;
    }
    if f.is_exact() { None } else { in_clusters(f, &slope, &values, even) }
}

/// Roots that no discs separate, such as double ones of a polynomial that is not exact, as clusters. `None` if these and the
/// discs of the others are not disjoint.
fn in_clusters(f: &Coefficients, slope: &Coefficients, values: &[ComplexFloat], even: bool) -> Option<Vec<Root>> {
    let mut groups: Vec<Vec<&ComplexFloat>> = Vec::new();
    for z in values {
        let wide = |other: &ComplexFloat| (other - z).norm().times_power_of_two(2 * CLOSE);
        match groups.iter_mut().find(|group| is_less(&wide(group[0]), &z.norm())) {
            Some(group) => group.push(z),
            None => groups.push(vec![z]),
        }
    }
    let root = |group: &Vec<&ComplexFloat>| match group[..] {
        [z] => Some(RootDisc::disc_around(f, slope, z, even)?).filter(RootDisc::is_certain).map(|disc| disc.root(1)),
        _ => f.cluster(group),
    };
    let all: Vec<Root> = groups.iter().map(root).collect::<Option<_>>()?;
    let apart = |(i, a): (usize, &Root)| all[..i].iter().all(|b| a.is_apart_from(b));
    let whole = all.iter().enumerate().all(apart);
    whole.then(|| all.into_iter().filter(Root::is_listed).collect())
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
/// 6.4), and as many disjoint ones as there are roots contain them all. `None` if they touch one another or the real axis,
/// or are wider than necessary.
fn discs(f: &Coefficients, slope: &Coefficients, values: &[ComplexFloat], even: bool) -> Option<Vec<RootDisc>> {
    let discs: Vec<RootDisc> =
        values.iter().map(|z| RootDisc::disc_around(f, slope, z, even)).collect::<Option<_>>()?;
    let apart = |(i, a): (usize, &RootDisc)| discs[..i].iter().all(|b| a.is_apart_from(b));
    let sharp = |disc: &RootDisc| disc.is_certain() && (!f.is_exact() || disc.is_sharp());
    let whole = discs.iter().enumerate().all(apart) && discs.iter().all(sharp);
    whole.then_some(discs)
}

impl RootDisc {
    /// The disc around z; if that meets an axis of symmetry, the disc around the nearest point of the axis instead: it
    /// also contains the mirror image of its root, so that the root, if it is the only one, is on the axis.
    fn disc_around(f: &Coefficients, slope: &Coefficients, z: &ComplexFloat, even: bool) -> Option<RootDisc> {
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
        are_apart((&self.centre, &self.radius), (&other.centre, &other.radius))
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

    fn root(self, multiplicity: usize) -> Root {
        let RootDisc { centre, radius } = self;
        let place = match (centre.re.is_zero(), centre.im.is_zero()) {
            (_, true) => Place::Real,
            (true, false) => Place::Axis,
            (false, false) => Place::Pair,
        };
        Root { centre, radius, multiplicity, place }
    }
}

/// Whether two discs are disjoint.
fn are_apart(a: (&ComplexFloat, &Float), b: (&ComplexFloat, &Float)) -> bool {
    let reach = a.1 + b.1;
    is_less(&(&reach * &reach), &(a.0 - b.0).norm())
}

impl Root {
    /// `false` for the lower root of a pair.
    fn is_listed(&self) -> bool {
        self.place.is_alone() || !self.centre.im.is_negative()
    }

    fn is_apart_from(&self, other: &Root) -> bool {
        are_apart((&self.centre, &self.radius), (&other.centre, &other.radius))
    }

    /// Number of roots of the polynomial that this disc represents.
    pub fn count(&self) -> usize {
        if self.place.is_alone() { self.multiplicity } else { 2 * self.multiplicity }
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
    use crate::base::two_to;
    use num_traits::One;

    fn polynomial(coefficients: &[i64]) -> Polynomial {
        Polynomial::new(coefficients.iter().map(|&a| a.into()).collect())
    }

    fn round(x: &Float) -> f64 {
        x.to_ball(0.0).to_f64()
    }

    fn report(f: &Polynomial) -> Vec<(f64, f64, usize, Place)> {
        let mut list: Vec<_> = (roots(&Coefficients::exact(f.clone())).expect("roots").iter())
            .map(|root| (round(&root.centre.re), round(&root.centre.im), root.multiplicity, root.place))
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
        assert_eq!(report(&f), expected);
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
        assert_eq!(report(&f), [(-2.0, 0.0, 3, Place::Real), (0.0, 1.0, 2, Place::Axis)]);
    }

    /// s^2 + 2 s + 5 with coefficients off by 1e-3: the discs contain the roots of s^2 + 2.001 s + 5.001.
    #[test]
    fn uncertain_coefficients_widen_the_discs() {
        let f = Coefficients { middle: polynomial(&[5, 2, 1]), radii: vec![1e-3, 1e-3, 0.0], far: 0 };
        let found = roots(&f).expect("apart");
        let (re, im) = (-1.0005, (5.001f64 - 1.0005 * 1.0005).sqrt());
        let distance = (round(&found[0].centre.re) - re).hypot(round(&found[0].centre.im) - im);
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
        let disc = RootDisc::disc_around(&f, &f.derivative(), &at, false).expect("a slope");
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

    /// 1 + 3 s + s^2 on |s| = 1 has 3 > 1 + 1, and one root within it; with 2 s it has a double root on it.
    #[test]
    fn a_coefficient_that_does_not_outweigh_the_others_counts_no_roots() {
        let holds = |own: f64| {
            let sizes = [1.0, own, 1.0].map(Float::from);
            outweighs(&sizes, 1, &sizes[1], &Float::from(1.0))
        };
        assert!(holds(3.0) && !holds(2.0) && !holds(1.0));
        // Circles that hold a root and no other, and none where there is no such circle.
        let circle = |sizes: &[f64], power: usize| {
            let sizes: Vec<Float> = sizes.iter().map(|size| Float::from(*size)).collect();
            circle_with(&sizes, power, &sizes[power]).map(|circle| circle.to_f64())
        };
        // 1e-9 + s + s^2: 1e-9 and nearly 1.
        assert!(circle(&[1e-9, 1.0, 1.0], 1).is_some_and(|radius| radius > 1e-9 && radius < 1e-8));
        assert_eq!(circle(&[1.0, 1.0, 1.0], 1), None);
        assert_eq!(circle(&[1.0, 0.0, 1.0], 1), None);
    }

    /// s^2 (s + 2)(s + 3) known to 1e-20 of its coefficients: two roots are about zero, of 1e-20 + 1e-20 s + 6 s^2 + ... they
    /// are 4e-11 away; and if the coefficient of s^2 may vanish, too, as in s^2 (s + 2) (s + 3e-20), nothing is known.
    #[test]
    fn roots_that_may_be_zero_are_about_it() {
        let of = |middle: &[i64], radius: f64| {
            let radii = vec![radius; middle.len()];
            roots(&Coefficients { middle: polynomial(middle), radii, far: 0 })
        };
        let list = of(&[0, 0, 6, 5, 1], 1e-20).expect("roots");
        let about_zero = list.iter().find(|root| root.place == Place::Cluster).expect("a cluster");
        assert!(about_zero.centre.is_zero() && about_zero.multiplicity == 2);
        let radius = about_zero.radius.to_f64();
        assert!((4.1e-11..1e-9).contains(&radius), "{radius:e}");
        let mut others: Vec<f64> = list.iter().map(|root| round(&root.centre.re)).filter(|re| *re != 0.0).collect();
        others.sort_by(f64::total_cmp);
        assert!(others.iter().zip([-3.0, -2.0]).all(|(root, truth)| (root - truth).abs() < 1e-18) && others.len() == 2);
        assert!(of(&[0, 0, 0, 2, 1], 0.5).is_none());
    }

    /// (s + 4)^2 (s + 5) times s^2 + w^2 for ten larger w, with a constant that is off by as much as moves the roots near -4
    /// and -5: the circle about the double root and the disc of -5, 23 |f / f'|, are found one by one, and are of no use where they meet.
    #[test]
    fn a_cluster_is_apart_from_the_other_roots() {
        let mut terms: Vec<BigInt> = [80, 56, 13, 1].map(BigInt::from).to_vec();
        let far = (1..=10).map(|j| 10 << (2 * j));
        for omega in far.clone() {
            let mut next: Vec<BigInt> = terms.iter().map(|a| a * BigInt::from(omega as i64 * omega as i64)).collect();
            next.extend([BigInt::from(0), BigInt::from(0)]);
            terms.iter().enumerate().for_each(|(k, a)| next[k + 2] += a);
            terms = next;
        }
        let middle = Polynomial::new(terms);
        let size = middle.coefficients()[0].to_string().parse::<f64>().expect("a number") / 80.0;
        let real = |re: f64| ComplexFloat::new(Float::from(re), Float::zero());
        let mut values = vec![real(-4.0), real(-4.0), real(-5.0)];
        for omega in far {
            values
                .extend([1.0, -1.0].map(|sign| ComplexFloat::new(Float::zero(), Float::from(sign * f64::from(omega)))));
        }
        let found = |share: f64| {
            let f = Coefficients { middle: middle.clone(), radii: vec![share * size], far: 0 };
            in_clusters(&f, &f.derivative(), &values, false)
        };
        let list = found(1e-3).expect("roots");
        assert_eq!(list.iter().filter(|root| root.place == Place::Cluster).count(), 1);
        assert!(found(0.015).is_none());
    }

    /// (s + 1)^2 (s + 3), (s^2 + 2 s + 5)^2 and (s + 1)^3 known to 1e-20: clusters that hold the roots with the coefficients
    /// moved as far as they may be, and reach no farther than they need to.
    #[test]
    fn double_roots_that_are_not_exact_are_clusters() {
        let clusters = |middle: &[i64], radius: f64| -> Option<Vec<(f64, f64, usize, f64)>> {
            let radii = vec![radius; middle.len()];
            let list = roots(&Coefficients { middle: polynomial(middle), radii, far: 0 })?;
            let clusters = list.iter().filter(|root| root.place == Place::Cluster);
            let of =
                |root: &Root| (round(&root.centre.re), round(&root.centre.im), root.multiplicity, root.radius.to_f64());
            Some(clusters.map(of).collect())
        };
        // (s + 1)^2 = -d / (s + 3): with d = 8e-20 at s = -1, a distance of sqrt(4e-20).
        let found = clusters(&[3, 7, 5, 1], 1e-20).expect("roots");
        let &[(re, im, 2, radius)] = &found[..] else { panic!("{found:?}") };
        assert!((re + 1.0).abs() < 1e-30 + radius && im == 0.0 && (1.4e-10..4e-9).contains(&radius), "{found:?}");
        let mut pairs = clusters(&[25, 20, 14, 4, 1], 1e-20).expect("roots");
        pairs.sort_by(|a, b| a.1.total_cmp(&b.1));
        assert_eq!(pairs.iter().map(|cluster| cluster.2).collect::<Vec<_>>(), [2, 2]);
        for ((re, im, _, radius), truth) in pairs.iter().zip([-2.0, 2.0]) {
            assert!((re + 1.0).hypot(im - truth) <= *radius && (1e-10..1e-8).contains(radius), "{pairs:?}");
        }
        let found = clusters(&[1, 3, 3, 1], 1e-21).expect("roots");
        let &[(_, _, 3, radius)] = &found[..] else { panic!("{found:?}") };
        assert!((2e-7..5e-6).contains(&radius), "{found:?}");
        // Radii that let the roots reach each other leave nothing.
        assert!(clusters(&[3, 7, 5, 1], 1.0).is_none());
    }

    /// (s + 1000)^2 (s + 1001)(s + 1007) and s^2 (s + 1)(s + 7), known to more and fewer digits: what is enclosed is disjoint,
    /// and holds as many roots as the degree.
    #[test]
    fn enclosures_are_disjoint_however_little_is_known() {
        let mut kinds = [0, 0];
        for middle in [&[1_008_007_000_000, 4_024_021_000, 6_024_007, 4008, 1][..], &[0, 0, 7, 8, 1]] {
            for exponent in 0..90 {
                let radii = middle.iter().map(|&a| (a as f64).max(1.0) * two_to(-exponent)).collect();
                let Some(list) = roots(&Coefficients { middle: polynomial(middle), radii, far: 0 }) else { continue };
                assert_eq!(list.iter().map(Root::count).sum::<usize>(), 4);
                for (i, a) in list.iter().enumerate() {
                    assert!(list[..i].iter().all(|b| a.is_apart_from(b)), "{exponent}: {list:?}");
                }
                kinds[usize::from(list.iter().any(|root| root.place == Place::Cluster))] += 1;
            }
        }
        assert!(kinds[1] > 30, "{kinds:?}");
    }
}
