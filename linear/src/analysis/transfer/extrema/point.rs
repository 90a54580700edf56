//! From brackets to extrema: each root of g is enclosed between two points at which g has different signs, and |H| and
//! its half-power width are computed there. In: zeros and poles. Out: values of H, and all extrema in a range. See
//! docs/method/transfer.md#extrema.

use super::far::Far;
use super::roots::{Place, Root};
use super::search::{Found, Interval, Search, search};
use super::slope::{Anchor, Over, anchors};
use super::{Complete, Extrema, Extremum, Factored, FeatureKind};
use crate::analysis::derived::hertz;
use crate::analysis::transfer::{Disc, Frequency, Gain};
use crate::base::{Ball, Dd, Number, down, up};
use crate::kernel::big_float::Float;
use crate::kernel::complex::Complex;
use num_bigint::BigInt;
use std::ops::RangeInclusive;

/// H of one pair of input and output, represented by its zeros and poles.
#[derive(Clone, Debug)]
pub struct Exactly {
    lead: Ball,
    anchors: Vec<Anchor>,
    /// The largest zero or pole, rad/s.
    largest: f64,
    /// Zeros, and poles.
    counts: [usize; 2],
    far: Far,
    has_clusters: bool,
}

/// A frequency as its distance from an anchor, rad/s.
#[derive(Clone, Copy, Debug)]
struct Point {
    anchor: usize,
    t: Ball,
}

/// The position of an extremum, and its kind.
#[derive(Clone, Copy, Debug)]
struct Located {
    at: Point,
    kind: FeatureKind,
    /// Whether it is a zero or a pole exactly on the axis.
    singular: bool,
}

/// Range of zeros, poles and frequencies, 1/s, and of the factor before their products.
const RANGE: RangeInclusive<f64> = 1e-100..=1e100;
/// The most steps of bisection in binary64, of Newton in double-double, and doublings of an enclosure.
const MOST_STEPS: usize = 2200;
const NEWTON_STEPS: usize = 4;
const DOUBLINGS: usize = 60;

impl Exactly {
    /// `None` if numbers lie so far from one that their products may leave the range of binary64.
    pub fn of(factored: &Factored) -> Option<Exactly> {
        let roots = factored.zeros.iter().chain(&factored.poles);
        let size = |x: f64| x.abs();
        let largest =
            roots.map(|root| size(root.centre.re.to_f64()).max(size(root.centre.im.to_f64()))).fold(0.0, f64::max);
        let roots = factored.zeros.iter().chain(&factored.poles);
        let sizes = roots.map(|root| root.centre.re.to_f64().abs().max(root.centre.im.to_f64().abs()));
        let lead = factored.lead.mid.to_f64().abs();
        let in_range = sizes.chain([lead]).all(|size| size == 0.0 || RANGE.contains(&size));
        let count = |roots: &[Root]| -> usize { roots.iter().map(Root::count).sum() };
        let counts = [count(&factored.zeros), count(&factored.poles)];
        in_range.then(|| Exactly {
            lead: factored.lead,
            anchors: anchors(factored),
            largest,
            counts,
            far: factored.far,
            has_clusters: factored.zeros.iter().chain(&factored.poles).any(|root| root.place == Place::Cluster),
        })
    }

    /// The zeros and poles of |H| omega^power, for the search of extrema alone: its values are not those of H.
    pub fn with_power(&self, power: Ball) -> Exactly {
        let at_zero = self.anchors[0].root_at_anchor();
        let anchors = self.anchors.iter().map(|anchor| anchor.with_power(power, at_zero)).collect();
        Exactly { anchors, ..self.clone() }
    }

    /// This, of |H| |omega - root|^power; the root is not at zero.
    pub fn with_factor(&self, root: Ball, power: Ball) -> Exactly {
        let anchors = self.anchors.iter().map(|anchor| anchor.with_factor(root, power)).collect();
        Exactly { anchors, ..self.clone() }
    }

    /// The number of zeros less that of poles: above 0, |H| grows with the frequency. `None` if it is not certain how
    /// many there are.
    pub fn excess(&self) -> Option<isize> {
        let excess = if self.lead.is_zero() { 0 } else { self.counts[0] as isize - self.counts[1] as isize };
        (self.far == Far::NONE).then_some(excess)
    }

    /// Whether values are limited by roots of which is known only that they are far away, or in a cluster.
    pub fn has_loose_roots(&self) -> bool {
        self.far != Far::NONE || self.has_clusters
    }

    /// The number of zeros and poles.
    pub fn roots(&self) -> usize {
        self.counts[0] + self.counts[1]
    }

    /// The largest zero or pole, rad/s: its real or its imaginary part.
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// H at a frequency; unknown at a pole or too close to one.
    pub fn gain(&self, frequency: &Frequency) -> Gain {
        if self.lead.is_zero() {
            return Gain::Finite(Disc { value: Complex::ZERO, radius: 0.0 });
        }
        let omega = frequency.omega;
        if !omega.is_zero() && !RANGE.contains(&omega.mid.to_f64()) {
            return Gain::Unknown;
        }
        let after = self.anchors.partition_point(|anchor| anchor.approximate(0.0) < omega.to_f64());
        let distance = |i: usize| (self.anchors[i].approximate(0.0) - omega.to_f64()).abs();
        let nearest = if after == self.anchors.len() || (after > 0 && distance(after - 1) < distance(after)) {
            after - 1
        } else {
            after
        };
        let anchor = &self.anchors[nearest];
        let mut t = anchor.distance_of(omega);
        // Next to a pole with hardly any damping the distance from it matters, and double-double keeps too few digits
        // of it.
        if t.mignitude() < 1e-8 * omega.magnitude()
            && let Some((omega, radius)) = wide_omega(frequency)
        {
            t = anchor.exact_distance_of(&omega, radius);
        }
        self.gain_at(Point { anchor: nearest, t })
    }

    /// See [`Anchor::over`].
    pub fn over(&self, omega: Ball) -> Option<Over> {
        if self.has_clusters { None } else { self.anchors[0].over(self.lead, omega) }
    }

    fn gain_at(&self, point: Point) -> Gain {
        let value = self.anchors[point.anchor].value(self.lead, point.t);
        let disc = Disc::of(value);
        let finite = disc.radius.is_finite() && disc.value.re.is_finite() && disc.value.im.is_finite();
        if finite { Gain::Finite(disc) } else { Gain::Unknown }
    }

    /// Every extremum between two frequencies, rad/s.
    pub fn extrema(&self, low: Ball, high: Ball) -> Extrema {
        if self.lead.is_zero() || (self.anchors[0].terms.is_empty() && self.far == Far::NONE) {
            return Extrema { list: Vec::new(), complete: Some(Complete(())), open: Vec::new() };
        }
        // A half-power width may extend beyond the range.
        let top = 2.0 * high.magnitude().max(2.0 * self.largest);
        let mut search = search(&self.anchors, top, (low.to_f64() * down::FEW, high.to_f64() * up::FEW));
        let located = self.locate(&mut search);
        let inside = |omega: Ball| !(omega - low).is_negative() && !(high - omega).is_negative();
        let list = (0..located.len())
            .filter(|&i| inside(self.omega(located[i].at)))
            .map(|i| self.extremum(&located, i, &search))
            .collect();
        let open = self.open(&search, low.to_f64(), high.to_f64());
        Extrema { list, complete: open.is_empty().then_some(Complete(())), open }
    }

    fn omega(&self, point: Point) -> Ball {
        self.anchors[point.anchor].omega(point.t)
    }

    /// The open intervals between two frequencies, Hz, with neighbours merged.
    fn open(&self, search: &Search, low: f64, high: f64) -> Vec<(f64, f64)> {
        let mut list: Vec<(f64, f64)> = Vec::new();
        for interval in &search.open {
            let ends = [interval.low, interval.high].map(|t| self.anchors[interval.anchor].approximate(t));
            let (from, to) = (ends[0].next_down().max(low), ends[1].next_up().min(high));
            if from > to {
                continue;
            }
            match list.last_mut().filter(|last| last.1 >= from * (1.0 - 1e-12)) {
                Some(last) => last.1 = to,
                None => list.push((from, to)),
            }
        }
        let hertz = |omega: f64| omega / (2.0 * std::f64::consts::PI);
        list.into_iter().map(|(from, to)| (hertz(from), hertz(to))).collect()
    }

    /// The positions of everything found. A bracket whose root is not enclosed becomes open again.
    fn locate(&self, search: &mut Search) -> Vec<Located> {
        let mut list: Vec<Located> = Vec::new();
        for found in std::mem::take(&mut search.found) {
            let (at, rising, singular) = match found {
                Found::Singular { anchor, rising } => (Point { anchor, t: Ball::ZERO }, rising, true),
                Found::Bracket { within, rising } => match self.root(within, rising) {
                    Some(t) => (Point { anchor: within.anchor, t }, rising, false),
                    None => {
                        search.open.push(within);
                        continue;
                    }
                },
            };
            let kind = if rising { FeatureKind::Antiresonance } else { FeatureKind::Peak };
            // One that is found from both sides of a cut counts once. Two of a kind in a row that are apart are two:
            // what is between them is in an open interval, or is a factor's zero.
            let is_same = |last: &Located| last.kind == kind && (self.omega(last.at) - self.omega(at)).contains_zero();
            if !list.last().is_some_and(is_same) {
                list.push(Located { at, kind, singular });
            }
        }
        list
    }

    /// The only root of g within an interval in which it is monotone, between two points at which the signs differ.
    fn root(&self, within: Interval, rising: bool) -> Option<Ball> {
        let anchor = &self.anchors[within.anchor];
        let before = if rising { -1 } else { 1 };
        let g = |t: f64| anchor.cell(t, 0.0, true).middle().0;
        let start = bisect(within.low, within.high, |t| (g(t) > 0.0) == (before > 0));
        let (mut t, mut last) = (Dd::from(start), f64::INFINITY);
        let mut blur = 0.0;
        for _ in 0..NEWTON_STEPS {
            let (g, slope) = anchor.slope(Ball::exact(t));
            let step = (g.mid / slope.mid).to_f64();
            blur = g.rad / slope.mid.hi.abs();
            if !step.is_finite() || step.abs() > last {
                break;
            }
            let next = t - g.mid / slope.mid;
            if !(next.hi >= within.low && next.hi <= within.high) {
                break;
            }
            (t, last) = (next, step.abs() * 0.5);
        }
        let sign = |t: Dd| anchor.sign_at(t);
        self.enclose(t, blur, within, |t| sign(t) == before, |t| sign(t) == -before)
    }

    /// A ball about t, as small as possible, such that `before` holds at its lower end and `behind` at its upper end.
    fn enclose(
        &self,
        t: Dd,
        blur: f64,
        within: Interval,
        before: impl Fn(Dd) -> bool,
        behind: impl Fn(Dd) -> bool,
    ) -> Option<Ball> {
        let mut reach = (2.0 * blur).max(t.abs().to_f64() * 1e-31).max(f64::MIN_POSITIVE);
        for _ in 0..DOUBLINGS {
            let (low, high) = (t - Dd::from(reach), t + Dd::from(reach));
            if low.hi < within.low || high.hi > within.high {
                // At the end of an interval, at which the sign is known already.
                let low_is_outside = low.hi < within.low;
                if low_is_outside && high.hi > within.high {
                    return None;
                }
                let held = if low_is_outside { behind(high) } else { before(low) };
                return held.then(|| Ball::new(t, 2.0 * reach));
            }
            if before(low) && behind(high) {
                return Some(Ball::new(t, reach * up::THOUSANDS));
            }
            reach *= 2.0;
        }
        None
    }

    fn extremum(&self, located: &[Located], index: usize, search: &Search) -> Extremum {
        let Located { at, kind, singular } = located[index];
        let gain = match (singular, kind) {
            (true, FeatureKind::Peak) => Gain::Infinite,
            (true, FeatureKind::Antiresonance) => Gain::Finite(Disc { value: Complex::ZERO, radius: 0.0 }),
            (false, _) => self.gain_at(at),
        };
        let width = (kind == FeatureKind::Peak && !singular).then(|| self.width(located, index, search)).flatten();
        Extremum { kind, frequency: hertz(self.omega(at)), gain, width: width.map(hertz) }
    }

    /// The half-power width of a peak, rad/s.
    fn width(&self, located: &[Located], index: usize, search: &Search) -> Option<Ball> {
        let at = located[index].at;
        let peak = self.anchors[at.anchor].size(self.lead.abs(), at.t);
        // sqrt(2) |H| / peak is one at the half-power points.
        let factor = self.lead.abs() * Ball::from(2.0).sqrt() / peak;
        if !factor.is_finite() {
            return None;
        }
        let before = index.checked_sub(1).map(|i| located[i].at);
        let left = self.crossing(factor, at, before, search, false)?;
        let right = self.crossing(factor, at, located.get(index + 1).map(|next| next.at), search, true)?;
        let between = self.anchors[left.anchor].distance_to(&self.anchors[right.anchor]);
        Some(if left.anchor == right.anchor { right.t - left.t } else { right.t - left.t + between })
    }

    /// The point between a peak and the next extremum at which |H| has fallen to half its power; |H| is monotone there.
    fn crossing(&self, factor: Ball, from: Point, to: Option<Point>, search: &Search, up: bool) -> Option<Point> {
        let mut segment = from.anchor;
        loop {
            let whole = search.segments[segment];
            let inner = if segment == from.anchor {
                from.t.to_f64()
            } else if up {
                whole.low
            } else {
                whole.high
            };
            let end = to.filter(|to| to.anchor == segment).map(|to| to.t.to_f64());
            let outer = end.unwrap_or(if up { whole.high } else { whole.low });
            let path = Interval { anchor: segment, low: inner.min(outer), high: inner.max(outer) };
            if search.open.iter().any(|open| open.anchor == segment && open.low <= path.high && open.high >= path.low) {
                return None;
            }
            if self.anchors[segment].near_size(factor.to_f64(), outer) < 1.0 {
                return Some(Point { anchor: segment, t: self.half_power(factor, path, up)? });
            }
            // The half-power point would be beyond the next extremum, below rest or beyond all roots.
            if end.is_some() {
                return None;
            }
            segment = if up { segment + 1 } else { segment.checked_sub(1)? };
            if segment >= search.segments.len() {
                return None;
            }
        }
    }

    /// The point at which `factor` |H| is one, in an interval over which |H| is monotone: falling if `up`.
    fn half_power(&self, factor: Ball, within: Interval, up: bool) -> Option<Ball> {
        let anchor = &self.anchors[within.anchor];
        let start = bisect(within.low, within.high, |t| (anchor.near_size(factor.to_f64(), t) > 1.0) == up);
        let mut t = Dd::from(start);
        let mut blur = 0.0;
        for _ in 0..NEWTON_STEPS {
            let size = anchor.size(factor, Ball::exact(t));
            let slope = anchor.slope(Ball::exact(t)).0.mid * size.mid;
            blur = size.rad / slope.hi.abs();
            let next = t - (size.mid - Dd::ONE) / slope;
            if !(next.hi > within.low && next.hi < within.high) {
                break;
            }
            t = next;
        }
        let more = |t: Dd| (anchor.size(factor, Ball::exact(t)) - Ball::ONE).is_positive();
        let less = |t: Dd| (anchor.size(factor, Ball::exact(t)) - Ball::ONE).is_negative();
        let strictly = |t: Ball| (t.mid.hi - t.rad > within.low && t.mid.hi + t.rad < within.high).then_some(t);
        if up { self.enclose(t, blur, within, more, less) } else { self.enclose(t, blur, within, less, more) }
            .and_then(strictly)
    }
}

/// omega to a hundred digits with a bound of its error, if the frequency is exact.
fn wide_omega(frequency: &Frequency) -> Option<(Float, f64)> {
    const BITS: u64 = 360;
    let (fraction, of_pi) = match (frequency.exact().and_then(Number::exact), &frequency.hertz) {
        (Some(omega), _) => (omega.to_big(), false),
        (None, Number::Exact(hertz)) => (hertz.to_big() * BigInt::from(2), true),
        _ => return None,
    };
    let part = |x: &BigInt| Float::from(x.clone());
    let rational = part(fraction.numer()).divided_by(&part(fraction.denom()), BITS);
    let omega = if of_pi { &rational * &wide_pi() } else { rational };
    // Both factors are cut off after 360 bits.
    let radius = omega.to_f64().abs() / (1u128 << 100) as f64 / (1u128 << 100) as f64 / (1u128 << 100) as f64;
    Some((omega, radius + f64::MIN_POSITIVE))
}

/// 400 bits of pi by Machin's formula, 16 atan (1/5) - 4 atan (1/239).
fn wide_pi() -> Float {
    const BITS: usize = 420;
    let atan_of_reciprocal = |x: u32| {
        let (mut sum, mut power, mut k) = (BigInt::from(0), (BigInt::from(1) << BITS) / x, 1u32);
        while power != BigInt::from(0) {
            let term = &power / k;
            sum = if k % 4 == 1 { sum + term } else { sum - term };
            power /= x * x;
            k += 2;
        }
        sum
    };
    let pi = atan_of_reciprocal(5) * 16 - atan_of_reciprocal(239) * 4;
    Float::from(pi).times_power_of_two(-(BITS as i64))
}

/// The binary64 number after which `holds` fails; it holds at the low end and fails at the high one.
fn bisect(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..MOST_STEPS {
        let middle = 0.5 * (low + high);
        if !(low < middle && middle < high) || (high - low) <= 1e-15 * low.abs().min(high.abs()) {
            break;
        }
        if holds(middle) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, oscillator, push};
    use crate::analysis::transfer::extrema::Denominator;
    use crate::base::Number;
    use crate::system::LinearSystem;

    fn exact_transfer(system: &LinearSystem, input: usize, output: usize) -> Exactly {
        let coordinates: Vec<u32> = (0..system.n() as u32).collect();
        let denominator = Denominator::of(system, &coordinates).expect("rational");
        Exactly::of(&denominator.pair(system, input, output).expect("roots")).expect("in range")
    }

    fn all(system: &LinearSystem, input: usize, output: usize) -> Extrema {
        exact_transfer(system, input, output).extrema(Ball::from(1e-6), Ball::from(1e6))
    }

    /// m = 1, k = 1, c = 2 zeta: a peak at sqrt(1 - 2 zeta^2) of height 1 / (2 zeta sqrt(1 - zeta^2)); |H|^2 is half of
    /// its peak at w^2 = 1 - 2 zeta^2 +- 2 zeta sqrt(1 - zeta^2).
    #[test]
    fn an_oscillator_of_any_damping_has_its_textbook_peak() {
        for exponent in [0, 2, 7, 16, 17, 40, 60, 100] {
            let zeta = Number::from(format!("2e-{exponent}").as_str());
            let zeta = if exponent == 0 { Number::from("0.2") } else { zeta };
            let system = oscillator("1", &format!("{}e-{exponent}", if exponent == 0 { "0.4" } else { "4" }), "1");
            let found = all(&system, 0, 0);
            assert!(found.complete.is_some(), "{exponent} {:?}", found.open);
            let [peak] = &found.list[..] else { panic!("{exponent}: {:?}", found.list) };
            assert_eq!(peak.kind, FeatureKind::Peak);
            let one = Number::ONE;
            let square = zeta.square();
            let root = (&one - &square).sqrt().expect("positive");
            let near = &one - &(&square * &Number::from(2));
            let agree = |name: &str, reported: Ball, truth: Ball, most: f64| {
                assert!((reported - truth).contains_zero(), "{exponent} {name}: {reported:?} {truth:?}");
                assert!(reported.relative_error() < most, "{exponent} {name}: {:e}", reported.relative_error());
            };
            let two_pi = Ball::from(2.0) * Ball::PI;
            agree("frequency", peak.frequency * two_pi, near.sqrt().expect("positive").to_ball(), 1e-25);
            let height = (&(&zeta * &Number::from(2)) * &root).recip().expect("not zero");
            agree("gain", peak.gain.disc().expect("finite").gain(), height.to_ball(), 1e-24);
            let apart = &(&zeta * &root) * &Number::from(2);
            // sqrt(a + d) - sqrt(a - d) = 2 d / (sqrt(a + d) + sqrt(a - d))
            let ends = [&near + &apart, &near - &apart].map(|x| x.sqrt().expect("positive"));
            let width = &(&apart * &Number::from(2)) / &(&ends[0] + &ends[1]);
            agree("width", peak.width.expect("a width") * two_pi, width.to_ball(), 1e-20);
        }
    }

    /// To 100 decimals.
    #[test]
    fn pi_is_pi() {
        let known =
            "31415926535897932384626433832795028841971693993751058209749445923078164062862089986280348253421170679";
        let known: BigInt = known.parse().expect("digits");
        let scaled = &wide_pi() * &Float::from(BigInt::from(10).pow(100u32));
        assert!((&scaled - &Float::from(known)).to_f64().abs() < 1.0);
    }

    /// A frequency of 1/7 Hz, 2 pi / 7 rad/s, to what 360 bits leave, beside the exact quotient of pi.
    #[test]
    fn an_exact_frequency_is_known_to_a_hundred_digits() {
        let check = |frequency: &Frequency, times: BigInt, truth: &Float| {
            let (found, radius) = wide_omega(frequency).expect("exact");
            let off = (&(&found * &Float::from(times)) - truth).to_f64().abs();
            assert!(off <= 8.0 * radius && radius < 1e-85, "{off:e} {radius:e}");
        };
        let seventh = Number::from(7).recip().expect("not zero");
        check(&Frequency::hertz(&seventh), BigInt::from(7), &(&wide_pi() * &Float::from(2.0)));
        check(&Frequency::radians(&seventh), BigInt::from(7), &Float::from(1.0));
        assert!(wide_omega(&Frequency::hertz(&Number::Ball(Ball::ONE))).is_none());
    }

    /// The peak at sqrt 0.98 in ranges that end on either side of it, and the numbers of zeros and poles.
    #[test]
    fn extrema_are_those_within_the_range() {
        let exactly = exact_transfer(&oscillator("1", "0.2", "1"), 0, 0);
        for (low, high, count) in [(1e-3, 0.98, 0), (1e-3, 0.995, 1), (0.98, 0.995, 1), (0.995, 1e3, 0), (0.98, 1e3, 1)]
        {
            let found = exactly.extrema(Ball::from(low), Ball::from(high));
            assert!(found.complete.is_some() && found.open.is_empty(), "{low} {high}: {found:?}");
            assert_eq!(found.list.len(), count, "{low} {high}: {found:?}");
        }
        let of_far = |far: Far| Exactly { far, ..exactly.clone() };
        let loose = of_far(Far { count: 1, beyond: 1e9 });
        assert_eq!((exactly.excess(), loose.excess(), exactly.roots()), (Some(-2), None, 2));
        assert_eq!((exactly.has_loose_roots(), loose.has_loose_roots()), (false, true));
        assert!((exactly.largest() - 0.99f64.sqrt()).abs() < 1e-15);
        let nothing = Exactly { lead: Ball::ZERO, ..exactly.clone() };
        assert!(nothing.excess() == Some(0) && nothing.extrema(Ball::from(1e-3), Ball::from(1e3)).complete.is_some());
        // Of two real poles the larger.
        let exactly = exact_transfer(&oscillator("1", "5", "4"), 0, 0);
        assert!((exactly.largest() - 4.0).abs() < 1e-15);
    }

    /// At a frequency next to the peak of an oscillator with zeta = 1e-20: 1 / (k - omega^2 + i omega c).
    #[test]
    fn near_a_pole_all_digits_are_kept() {
        let system = oscillator("1", "2e-20", "1");
        let omega = Number::from("1.00000000000000000003");
        let gain = exact_transfer(&system, 0, 0).gain(&Frequency::radians(&omega));
        let re = &Number::ONE - &omega.square();
        let im = &omega * &Number::from("2e-20");
        let norm = &re.square() + &im.square();
        let truth = Complex::new((&re / &norm).to_ball(), (&-&im / &norm).to_ball());
        let disc = gain.disc().expect("finite");
        assert!(disc.relative_error() < 1e-25, "{:e}", disc.relative_error());
        let error = (disc.value - truth.mid()).to_f64().abs();
        assert!(error <= disc.radius + truth.radius(), "{error:e} {:e}", disc.radius);
    }

    #[test]
    fn without_damping_a_peak_is_infinite_and_a_zero_is_zero() {
        let mut system = blank(2);
        for i in 0..2 {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, "1", i, i.checked_sub(1));
        }
        let found = all(&system, 0, 0);
        assert!(found.complete.is_some());
        let reported: Vec<(FeatureKind, bool, f64)> = (found.list.iter())
            .map(|e| (e.kind, e.gain == Gain::Infinite, (e.frequency * Ball::from(2.0) * Ball::PI).to_f64()))
            .collect();
        // omega^2 = (3 -+ sqrt 5) / 2; only the second mass stands still at 1 rad/s.
        let root = 5f64.sqrt();
        let expected = [
            (FeatureKind::Peak, true, ((3.0 - root) / 2.0).sqrt()),
            (FeatureKind::Antiresonance, false, 1.0),
            (FeatureKind::Peak, true, ((3.0 + root) / 2.0).sqrt()),
        ];
        assert_eq!(reported.len(), 3, "{reported:?}");
        for (reported, expected) in reported.iter().zip(expected) {
            assert!(
                (reported.0, reported.1) == (expected.0, expected.1) && (reported.2 - expected.2).abs() < 1e-15,
                "{reported:?}"
            );
        }
        assert_eq!(found.list[1].gain, Gain::Finite(Disc { value: Complex::ZERO, radius: 0.0 }));
    }

    /// With damping above 1 / sqrt 2 there is no peak, and that is proved.
    #[test]
    fn heavy_damping_leaves_no_peak() {
        let found = all(&oscillator("1", "1.5", "1"), 0, 0);
        assert!(found.list.is_empty() && found.complete.is_some(), "{found:?}");
    }

    /// At exactly 1 / sqrt 2, g has a triple root at rest, and none above it.
    #[test]
    fn a_flat_top_at_rest_is_no_peak() {
        let mut system = oscillator("1", "1", "1");
        system.k = crate::system::Form::new();
        push(&mut system.k, "0.5", 0, None);
        let found = exact_transfer(&system, 0, 0).extrema(Ball::from(1e-3), Ball::from(1e6));
        assert!(found.list.is_empty() && found.complete.is_some(), "{found:?}");
    }

    /// Two pendulums, one below the other, whose numbers come from sines, with a relative uncertainty of 1e-31.
    #[test]
    fn enclosed_numbers_give_the_same_extremum() {
        let mut system = blank(2);
        let source = system.m.source(system.coordinates[0].name);
        let at = |i: u32, x: &str| (crate::system::CoordinateId(i), Number::from(x));
        let nature = crate::system::Nature::Property;
        // M = [2 1; 1 1], K = [19.62 0; 0 9.81]
        system.m.push(source, nature, Number::ONE, [at(0, "1")]);
        system.m.push(source, nature, Number::ONE, [at(0, "1"), at(1, "1")]);
        let source = system.k.source(system.coordinates[0].name);
        let around = |x: f64| Number::Ball(Ball::new(Dd::from(x), 1e-31 * x));
        system.k.push(source, nature, around(19.62), [at(0, "1")]);
        system.k.push(source, nature, around(9.81), [at(1, "1")]);
        let found = all(&system, 1, 1);
        assert!(found.complete.is_some(), "{found:?}");
        let reported: Vec<(FeatureKind, bool)> =
            found.list.iter().map(|e| (e.kind, e.gain == Gain::Infinite)).collect();
        use FeatureKind::{Antiresonance, Peak};
        assert_eq!(reported, [(Peak, true), (Antiresonance, false), (Peak, true)]);
    }

    /// Poles at re +- i im, with a radius of uncertainty.
    fn resonance(re: f64, im: f64, radius: f64) -> Exactly {
        use crate::analysis::transfer::extrema::roots::{Place, Root};
        use crate::kernel::big_float::ComplexFloat;
        let centre = ComplexFloat::new(Float::from(re), Float::from(im));
        let pole = Root { centre, radius: Float::from(radius), multiplicity: 1, place: Place::Pair };
        Exactly::of(&Factored { lead: Ball::ONE, unit: 1.0, zeros: Vec::new(), poles: vec![pole], far: Far::NONE })
            .expect("in range")
    }

    /// However poor the first guess, the reported enclosure contains the change of sign, or nothing is reported.
    #[test]
    fn an_enclosure_holds_the_change_of_sign() {
        let exactly = resonance(-0.1, 1.0, 0.0);
        let within = Interval { anchor: 0, low: 0.0, high: 3.0 };
        for (at, change) in [(1.0, 1.2), (1.2, 1.2), (2.9, 2.0), (0.05, 1.0), (2.9, 2.95), (0.1, 0.05)] {
            for blur in [0.0, 0.2] {
                let found = exactly.enclose(Dd::from(at), blur, within, |t| t.hi < change, |t| t.hi > change);
                let holds = |t: Ball| (t.mid.hi - change).abs() <= t.rad;
                assert!(found.is_none_or(holds), "{at} {change} {blur}: {found:?}");
            }
        }
    }

    /// Poles known to 1e-9 leave the place of the peak open by as much: in a bracket that is narrower it is not enclosed, and
    /// the bracket is open again, so that the list is not complete.
    #[test]
    fn a_bracket_whose_root_is_not_enclosed_is_open() {
        let exactly = resonance(-0.1, 1.0, 1e-9);
        let mut search = search(&exactly.anchors, 10.0, (0.1, 3.0));
        // The peak at sqrt 0.99, seen from the anchor at 1.
        let peak = 0.99f64.sqrt() - 1.0;
        for (half, is_enclosed) in [(1e-12, false), (1e-3, true)] {
            let within = Interval { anchor: 1, low: peak - half, high: peak + half };
            search.found = vec![Found::Bracket { within, rising: false }];
            search.open.clear();
            assert_eq!(exactly.locate(&mut search).len(), usize::from(is_enclosed));
            assert_eq!(search.open.len(), usize::from(!is_enclosed));
            assert_eq!(exactly.open(&search, 0.1, 3.0).len(), usize::from(!is_enclosed));
            if !is_enclosed {
                // Two more, of which one meets it, cut off at the range.
                search.open.push(Interval { anchor: 1, low: peak + half, high: peak + 0.1 });
                search.open.push(Interval { anchor: 0, low: 2.0, high: 4.0 });
                let two_pi = 2.0 * std::f64::consts::PI;
                let expected = [(1.0 + peak - half, 1.1 + peak), (2.0, 3.0)];
                for (found, truth) in exactly.open(&search, 0.1, 3.0).into_iter().zip(expected) {
                    let off = [found.0 * two_pi - truth.0, found.1 * two_pi - truth.1];
                    assert!(off.iter().all(|off| off.abs() < 1e-14), "{found:?}");
                }
                assert_eq!((exactly.open(&search, 0.1, 3.0).len(), exactly.open(&search, 0.1, 0.5).len()), (2, 0));
            }
        }
    }

    /// Poles known to 0.05: the enclosures of the peak, its height and its width also cover poles anywhere in there, or
    /// the list is not reported as complete.
    #[test]
    fn uncertainty_of_a_pole_is_in_the_extremum() {
        for radius in [1e-9, 1e-4, 0.05] {
            let (reported, truth) =
                (resonance(-0.1, 1.0, radius), resonance(-0.1 - 0.7 * radius, 1.0 + 0.7 * radius, 0.0));
            let [reported, truth] = [reported, truth].map(|exactly| exactly.extrema(Ball::from(1e-3), Ball::from(1e3)));
            let [peak] = &truth.list[..] else { panic!("{truth:?}") };
            assert!(truth.complete.is_some());
            let Some(found) = reported.list.first() else {
                assert!(reported.complete.is_none(), "{reported:?}");
                continue;
            };
            assert!((found.frequency - peak.frequency).contains_zero(), "{radius} {found:?} {peak:?}");
            let gain = |e: &Extremum| e.gain.disc().map(|disc| disc.gain());
            assert!(
                gain(found).is_none_or(|reported| (reported - gain(peak).expect("finite")).contains_zero()),
                "{radius}"
            );
            assert!(
                found.width.is_none_or(|reported| (reported - peak.width.expect("a width")).contains_zero()),
                "{radius}"
            );
            assert!(radius > 1e-6 || (gain(found).is_some() && found.width.is_some() && reported.complete.is_some()));
        }
    }

    /// Where |H| is less than half of the peak's power already, on either side, no half-power point is found.
    #[test]
    fn a_path_without_a_half_power_point_has_none() {
        let exactly = resonance(-0.1, 1.0, 0.0);
        let peak = exactly.anchors[1].size(Ball::ONE, Ball::from(0.99f64.sqrt() - 1.0));
        let factor = Ball::from(2.0).sqrt() / peak;
        let found = |low: f64, high: f64, up: bool| exactly.half_power(factor, Interval { anchor: 1, low, high }, up);
        assert!(found(0.2, 0.5, true).is_none() && found(-0.5, -0.2, false).is_none());
        // (omega^2 + 1.01)^2 - 4 omega^2 is twice what it is at the peak, 0.04.
        for (low, high, up) in [(0.0, 0.5, true), (-0.5, -0.01, false)] {
            let omega = 1.0 + found(low, high, up).expect("a crossing").to_f64();
            let square = (omega * omega + 1.01).powi(2) - 4.0 * omega * omega;
            assert!((square - 0.08).abs() < 1e-14, "{omega} {square}");
        }
    }

    /// Poles at -0.33 +- i: one end of the half-power width, 0.48, is nearer to rest than to the pole.
    #[test]
    fn a_wide_peak_has_its_width() {
        let found = resonance(-0.33, 1.0, 0.0).extrema(Ball::from(1e-3), Ball::from(1e3));
        let [peak] = &found.list[..] else { panic!("{found:?}") };
        let square = 1.0 + 0.33f64 * 0.33;
        let (near, apart) = (1.0 - 2.0 * 0.33 * 0.33 / square, 2.0 * 0.33 / square);
        let width = (square * (near + apart)).sqrt() - (square * (near - apart)).sqrt();
        let reported = peak.width.expect("a width").to_f64() * 2.0 * std::f64::consts::PI;
        assert!((reported - width).abs() < 1e-14, "{reported} {width}");
    }

    /// Poles at -0.33 +- i, whose |H| no zero and pole at one place change: these are anchors between the peak and its half-power points.
    fn wide_peak_in_segments(anchors: &[f64]) -> (Exactly, f64, [f64; 2]) {
        use crate::analysis::transfer::extrema::roots::{Place, Root};
        use crate::kernel::big_float::ComplexFloat;
        let root = |re: f64, im: f64| Root {
            centre: ComplexFloat::new(Float::from(re), Float::from(im)),
            radius: Float::zero(),
            multiplicity: 1,
            place: Place::Pair,
        };
        let zeros: Vec<Root> = anchors.iter().map(|&im| root(-8.0, im)).collect();
        let poles = std::iter::once(root(-0.33, 1.0)).chain(zeros.iter().cloned()).collect();
        let factored = Factored { lead: Ball::ONE, unit: 1.0, zeros, poles, far: Far::NONE };
        let square = 1.0 + 0.33f64 * 0.33;
        let (near, apart) = (1.0 - 2.0 * 0.33 * 0.33 / square, 2.0 * 0.33 / square);
        let ends = [near - apart, near + apart].map(|x| (square * x).sqrt());
        (Exactly::of(&factored).expect("in range"), (square * near).sqrt(), ends)
    }

    #[test]
    fn a_width_is_the_same_over_any_number_of_segments() {
        for anchors in [&[][..], &[0.6], &[1.125], &[0.5, 0.6, 0.75], &[1.05, 1.125, 1.2], &[0.6, 0.75, 1.1, 1.2, 3.0]]
        {
            let (exactly, peak, ends) = wide_peak_in_segments(anchors);
            let found = exactly.extrema(Ball::from(1e-3), Ball::from(1e3));
            assert!(found.complete.is_some(), "{anchors:?}");
            let [one] = &found.list[..] else { panic!("{anchors:?}: {found:?}") };
            let two_pi = 2.0 * std::f64::consts::PI;
            assert!((one.frequency.to_f64() * two_pi - peak).abs() < 1e-13, "{anchors:?}");
            let width = one.width.expect("a width").to_f64() * two_pi;
            assert!((width - (ends[1] - ends[0])).abs() < 1e-13, "{anchors:?}: {width}");
        }
    }

    /// From the peak to where it has half its power: not over what is open, not beyond the next extremum, and not where there is none.
    #[test]
    fn a_half_power_point_is_on_the_way_to_the_next_extremum() {
        let anchors = [0.6, 0.75, 1.1, 1.2];
        let (exactly, peak, ends) = wide_peak_in_segments(&anchors);
        let mut search = search(&exactly.anchors, 10.0, (0.1, 3.0));
        assert!(search.open.is_empty());
        let point = |omega: f64| {
            let of = |i: usize| omega - exactly.anchors[i].approximate(0.0);
            let near = |i: &usize| (search.segments[*i].low..search.segments[*i].high).contains(&of(*i));
            let anchor = (0..exactly.anchors.len()).find(near).expect("a segment");
            Point { anchor, t: Ball::from(of(anchor)) }
        };
        let from = point(peak);
        let height = exactly.anchors[from.anchor].size(Ball::ONE, from.t);
        let factor = Ball::from(2.0).sqrt() / height;
        let is_there = |found: Option<Point>, truth: f64| {
            found.is_some_and(|found| (exactly.omega(found).to_f64() - truth).abs() < 1e-13)
        };
        // The next extremum nearer than the half-power point, next to it, and further off.
        for (to, up, is_reached) in [
            (1.05, true, false),
            (1.15, true, false),
            (ends[1] - 0.01, true, false),
            (ends[1] + 0.01, true, true),
            (3.0, true, true),
            (0.85, false, false),
            (0.7, false, false),
            (ends[0] + 0.01, false, false),
            (ends[0] - 0.01, false, true),
            (0.125, false, true),
        ] {
            let found = exactly.crossing(factor, from, Some(point(to)), &search, up);
            let truth = ends[usize::from(up)];
            assert!(if is_reached { is_there(found, truth) } else { found.is_none() }, "{to} {up}: {found:?}");
        }
        // A tenth of the peak is far off, and three halves of it nowhere.
        for up in [true, false] {
            assert!(is_there(exactly.crossing(factor, from, None, &search, up), ends[usize::from(up)]));
            let more = factor * Ball::from(1000.0);
            assert!(exactly.crossing(more, from, None, &search, up).is_none(), "{up}");
        }
        // What is open on the way, at its ends, and elsewhere.
        for (low, high, is_in_the_way) in [
            (1.055, 1.06, [false, true]),
            (0.9, 0.91, [true, false]),
            (1.15, 1.151, [false, true]),
            (0.7, 0.701, [true, false]),
            (0.1, 0.2, [false, false]),
            (peak - 0.001, peak + 0.001, [true, true]),
        ] {
            let at = [low, high].map(&point);
            assert_eq!(at[0].anchor, at[1].anchor);
            let [low, high] = at.map(|point| point.t.to_f64());
            search.open = vec![Interval { anchor: at[0].anchor, low, high }];
            for up in [false, true] {
                let found = exactly.crossing(factor, from, None, &search, up);
                assert_eq!(found.is_none(), is_in_the_way[usize::from(up)], "{low} {high} {up}: {found:?}");
            }
        }
    }

    /// Where H is zero there are no extrema, and where roots are known to be far and no more, there may be some.
    #[test]
    fn without_roots_there_are_no_extrema_unless_some_may_be_far() {
        let of = |lead: Ball, far: Far, poles: Exactly| Exactly { lead, far, ..poles };
        let nothing = of(Ball::ZERO, Far::NONE, resonance(-0.1, 1.0, 0.0)).extrema(Ball::from(1e-3), Ball::from(1e3));
        assert!(nothing.list.is_empty() && nothing.complete.is_some(), "{nothing:?}");
        let without = |far: Far| {
            let factored = Factored { lead: Ball::ONE, unit: 1.0, zeros: Vec::new(), poles: Vec::new(), far };
            Exactly::of(&factored).expect("in range").extrema(Ball::from(0.5), Ball::from(8.0))
        };
        let (constant, loose) = (without(Far::NONE), without(Far { count: 2, beyond: 2.0 }));
        assert!(constant.list.is_empty() && constant.complete.is_some(), "{constant:?}");
        assert!(loose.complete.is_none() && !loose.open.is_empty(), "{loose:?}");
    }

    /// Two zeros within 0.1 of rest, on either axis: the product at 1 rad/s, and the slope, hold those of each place.
    #[test]
    fn zeros_of_a_cluster_may_be_anywhere_in_it() {
        use crate::analysis::transfer::extrema::roots::{Place, Root};
        use crate::kernel::big_float::ComplexFloat;
        let centre = ComplexFloat::zero();
        let cluster = Root { centre, radius: Float::from(0.1), multiplicity: 2, place: Place::Cluster };
        let factored = Factored { lead: Ball::ONE, unit: 1.0, zeros: vec![cluster], poles: Vec::new(), far: Far::NONE };
        let exactly = Exactly::of(&factored).expect("in range");
        assert!(exactly.has_loose_roots());
        let found = exactly.gain(&Frequency::radians(&Number::ONE)).disc().expect("finite");
        let (slope, _) = exactly.anchors[0].slope(Ball::ONE);
        for (re, im) in [(0.1, 0.0), (-0.1, 0.0), (0.0, 0.1), (0.07, 0.07)] {
            let factor = Complex::new(-re, 1.0 - im);
            let truth = factor * factor;
            let off = Complex::new(found.value.re.to_f64() - truth.re, found.value.im.to_f64() - truth.im);
            assert!(off.abs() <= found.radius, "{re} {im}: {found:?}");
            let parts = exactly.anchors[0].value(Ball::ONE, Ball::ONE);
            for (part, truth) in [(parts.re, truth.re), (parts.im, truth.im)] {
                assert!((part.to_f64() - truth).abs() <= part.rad * 1.000_001, "{re} {im}: {parts:?}");
            }
            let truth = 2.0 * (1.0 - im) / ((1.0 - im) * (1.0 - im) + re * re);
            assert!((slope.to_f64() - truth).abs() <= slope.rad, "{re} {im}: {slope:?}");
        }
        assert!(found.radius < 0.4 && slope.rad < 1.0, "{found:?} {slope:?}");
    }
}
