//! Extrema of systems that are too large for computing their zeros, found between the frequencies of a grid. In: a
//! prepared system, its poles, values on a grid. Out: the grid's maxima and minima, each with its own enclosure; it is
//! not proved that there are no others. See docs/method/transfer.md#extrema-of-larger-systems.

use super::jet::Jet;
use super::{Extrema, Extremum, FeatureKind};
use crate::analysis::answer::Poles;
use crate::analysis::derived::hertz;
use crate::analysis::transfer::modal::{ModalPair, ModalSum};
use crate::analysis::transfer::{Disc, Frequency, Gain, Transfer};
use crate::base::{Ball, Dd, Number, OrderBy, Rational, down, up};
use crate::kernel::complex::{Complex, arc};

/// The most steps towards one extremum, and the most doublings of its enclosure.
const MOST_STEPS: usize = 100;
const DOUBLINGS: usize = 40;
/// Relative step below which binary64 gains nothing more.
const ROUGH: f64 = 1e-9;
/// Relative distance from an undamped pole at which |H| is evaluated, the relative radius of the circle about the pole
/// on which |H| is compared with that value, and the number of arcs that cover the circle.
const BESIDE_POLE: f64 = 1e-9;
const CIRCLE: f64 = 1e-6;
const ARCS: usize = 32;

/// One pair of input and output.
struct Pair<'a> {
    transfer: &'a Transfer<'a>,
    input: usize,
    output: usize,
    /// The same H as a sum over modes, if damping does not couple them.
    by_modes: Option<(&'a ModalSum, &'a ModalPair)>,
}

/// An interval of omega, rad/s.
type Interval = (f64, f64);

/// `gains` are the values on the grid, in ascending frequency, Hz. `open` are the ranges in which extrema are looked for, Hz; all
/// of the grid if there are none.
pub fn bracket(
    transfer: &Transfer,
    (input, output): (usize, usize),
    by_modes: Option<(&ModalSum, &ModalPair)>,
    poles: &Poles,
    gains: &[(f64, Gain)],
    open: &[(f64, f64)],
) -> Extrema {
    let pair = Pair { transfer, input, output, by_modes };
    let two_pi = 2.0 * std::f64::consts::PI;
    let (Some(first), Some(last)) = (gains.first(), gains.last()) else {
        return Extrema { list: Vec::new(), complete: None, open: Vec::new() };
    };
    // A little more than the range, whose ends are rounded here.
    let range = (first.0 * two_pi * down::FEW, last.0 * two_pi * up::FEW);
    let infinite = axis_poles(poles, range);
    let is_open = |(low, high): Interval| {
        open.is_empty()
            || open.iter().any(|(from, to)| low <= to * two_pi * up::FEW && high >= from * two_pi * down::FEW)
    };
    let holds_pole = |(low, high): Interval| infinite.iter().any(|pole| (low..=high).contains(&pole.to_f64()));
    let mut list: Vec<Extremum> = (significant_brackets(gains).into_iter())
        .filter(|(bracket, _)| is_open(*bracket) && !holds_pole(*bracket))
        .filter_map(|(bracket, kind)| Some(pair.extremum(pair.root(bracket, kind)?, kind)))
        .collect();
    let in_open = |pole: &Ball| is_open((pole.to_f64(), pole.to_f64()));
    for pole in infinite.into_iter().filter(in_open).filter(|pole| pair.has_pole_at(*pole, poles)) {
        let frequency = hertz(pole);
        list.push(Extremum { kind: FeatureKind::Peak, frequency, gain: Gain::Infinite, width: None });
    }
    list.order_by(|a, b| a.frequency.to_f64().total_cmp(&b.frequency.to_f64()));
    list.dedup_by(|b, a| (a.frequency - b.frequency).contains_zero());
    Extrema { list, complete: None, open: vec![(first.0, last.0)] }
}

/// Replaces the frequencies and values of a complete list by enclosures from H itself, if these are better: the
/// accuracy of those from zeros and poles is limited by that of the zeros and poles.
pub fn sharpen(transfer: &Transfer, input: usize, output: usize, mut found: Extrema) -> Extrema {
    let pair = Pair { transfer, input, output, by_modes: None };
    for index in 0..found.list.len() {
        let Extremum { kind, frequency, gain, .. } = found.list[index];
        let singular = gain == Gain::Infinite || gain.disc().is_some_and(|disc| disc.radius == 0.0);
        let neighbours = [index.checked_sub(1), Some(index + 1)].map(|i| Some(found.list.get(i?)?.frequency));
        let omega = (frequency * Ball::from(2.0) * Ball::PI).widen(f64::MIN_POSITIVE);
        let reach = omega.rad.max(omega.to_f64() * 1e-13);
        let better = match singular {
            true => None,
            false => pair.root((omega.to_f64() - reach, omega.to_f64() + reach), kind),
        };
        let Some(better) = better.map(|omega| pair.extremum(omega, kind)) else { continue };
        // A root of the slope that lies within the ball of one extremum and of no other belongs to that extremum.
        let apart = |other: &Ball| !(*other - better.frequency).contains_zero();
        let same = (better.frequency.mid - frequency.mid).abs().to_f64() + better.frequency.rad <= frequency.rad;
        if same && neighbours.iter().flatten().all(apart) {
            found.list[index].frequency = better.frequency;
            found.list[index].gain = better.gain;
        }
    }
    found
}

/// Poles exactly on the imaginary axis.
fn axis_poles(poles: &Poles, (low, high): Interval) -> Vec<Ball> {
    let on_axis = poles.list.iter().filter(|pole| pole.re.is_zero() && pole.im.is_positive()).map(|pole| pole.im);
    on_axis.filter(|omega| (low..=high).contains(&omega.to_f64())).collect()
}

/// The maxima and minima of the grid between two values with at least one correct digit: between others there is only
/// rounding error.
fn significant_brackets(gains: &[(f64, Gain)]) -> Vec<(Interval, FeatureKind)> {
    let two_pi = 2.0 * std::f64::consts::PI;
    let is_reported = |gain: Gain| gain.disc().is_some_and(|disc| disc.relative_error() <= 0.1);
    let size = |gain: Gain| gain.disc().map_or(f64::INFINITY, |disc| disc.value.to_f64().abs());
    let of_three = |three: &[(f64, Gain)]| {
        let [(low, left), (_, here), (high, right)] = three else { return None };
        if !is_reported(*left) || !is_reported(*right) {
            return None;
        }
        let [left, here, right] = [*left, *here, *right].map(size);
        let kind = if here > left && here >= right {
            FeatureKind::Peak
        } else if here < left && here <= right {
            FeatureKind::Antiresonance
        } else {
            return None;
        };
        Some(((low * two_pi, high * two_pi), kind))
    };
    gains.windows(3).filter_map(of_three).collect()
}

impl Pair<'_> {
    fn jet(&self, omega: Ball) -> Option<Jet> {
        Jet::of(self.transfer, omega, self.input, self.output)
    }

    /// The sign of d|H|^2 / d omega; 0 if it is not certain.
    fn sign(&self, omega: Dd) -> i8 {
        self.jet(Ball::exact(omega)).map_or(0, |jet| sign_of(jet.slope()))
    }

    /// A root of the slope with a change of sign, the only one in the ball.
    fn root(&self, (low, high): Interval, kind: FeatureKind) -> Option<Ball> {
        let before = if kind == FeatureKind::Peak { 1 } else { -1 };
        let mut omega = Dd::from(self.rough_root((low, high), before));
        let (mut low, mut high) = (Dd::from(low), Dd::from(high));
        let mut blur = 0.0;
        for _ in 0..MOST_STEPS {
            let jet = self.jet(Ball::exact(omega))?;
            let (slope, curvature) = (jet.slope(), jet.curvature());
            match sign_of(slope) {
                0 => {}
                sign if sign == before => low = omega,
                _ => high = omega,
            }
            blur = slope.rad / curvature.mid.hi.abs();
            let mut next = omega - slope.mid / curvature.mid;
            let newton = next > low && next < high && next.is_finite();
            if !newton {
                next = (low + high) * 0.5;
            }
            let step = (next - omega).abs().to_f64();
            omega = next;
            if step <= 1e-29 * omega.to_f64() || (newton && step <= blur) {
                break;
            }
        }
        let mut reach = (2.0 * blur).max(omega.to_f64() * 1e-30);
        for _ in 0..DOUBLINGS {
            let ends = [omega - Dd::from(reach), omega + Dd::from(reach)];
            if self.sign(ends[0]) == before && self.sign(ends[1]) == -before {
                let ball = Ball::new(omega, reach * up::THOUSANDS);
                let alone = self.jet(ball).is_some_and(|jet| sign_of(jet.curvature()) == -before);
                return alone.then_some(ball);
            }
            reach *= 4.0;
        }
        None
    }

    /// Approximates the root in binary64 as far as possible, starting in the middle: `before` is the sign of the slope
    /// below the root.
    fn rough_root(&self, (mut low, mut high): Interval, before: i8) -> f64 {
        let mut omega = 0.5 * (low + high);
        for _ in 0..MOST_STEPS {
            let Some(jet) = Jet::in_binary64(self.transfer, omega, self.input, self.output) else { break };
            let (slope, curvature) = (jet.slope().to_f64(), jet.curvature().to_f64());
            if (slope > 0.0) == (before > 0) {
                low = omega;
            } else {
                high = omega;
            }
            let newton = omega - slope / curvature;
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            let step = (next - omega).abs();
            omega = next;
            if step <= ROUGH * omega {
                break;
            }
        }
        omega
    }

    fn extremum(&self, omega: Ball, kind: FeatureKind) -> Extremum {
        let gain = match self.jet(omega).map(|jet| Disc::of(jet.value())) {
            Some(disc) if disc.radius.is_finite() => Gain::Finite(disc),
            _ => Gain::Unknown,
        };
        Extremum { kind, frequency: hertz(omega), gain, width: None }
    }

    /// Whether H has a pole at a pole of the system on the axis: if it had none, |H| within a circle would be at most
    /// its maximum on the circle (the maximum principle). No other pole may be near.
    fn has_pole_at(&self, pole: Ball, poles: &Poles) -> bool {
        let radius = pole.to_f64() * CIRCLE;
        let centre = Complex::new(Ball::ZERO, pole);
        let far = |other: &crate::analysis::answer::Pole| {
            let distance = Complex::new(other.re, other.im - pole);
            distance.re.mignitude().max(distance.im.mignitude()) > 2.0 * radius
        };
        let near = poles.list.iter().filter(|other| !far(other)).count();
        if near != 1 || poles.left_out > 0 {
            return false;
        }
        if self.exceeds_circle_by_modes(pole, radius) {
            return true;
        }
        let mut most = 0.0f64;
        for i in 0..ARCS {
            let s = arc(centre, radius, [i, i + 1].map(|i| std::f64::consts::TAU * i as f64 / ARCS as f64));
            match Jet::at(self.transfer, s, self.input, self.output) {
                Some(jet) => most = most.max(jet.value().magnitude()),
                None => return false,
            }
        }
        let inside = self.jet(Ball::from(pole.to_f64() * (1.0 - BESIDE_POLE))).map(|jet| jet.value());
        inside.is_some_and(|h| h.re.mignitude().max(h.im.mignitude()) > most)
    }

    /// Whether the sum over modes proves that |H| inside the circle exceeds its maximum on it: two sums instead of an
    /// elimination for each arc.
    fn exceeds_circle_by_modes(&self, pole: Ball, radius: f64) -> bool {
        let Some((sum, pair)) = self.by_modes else { return false };
        let Some(inside) = Rational::from_f64(pole.to_f64() * (1.0 - BESIDE_POLE)) else { return false };
        let inside = sum.accurate(pair, &Frequency::radians(&Number::from(inside)));
        inside.disc().is_some_and(|disc| disc.gain().mignitude() > sum.most_on_circle(pair, pole.mid, radius))
    }
}

fn sign_of(x: Ball) -> i8 {
    i8::from(x.is_positive()) - i8::from(x.is_negative())
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::analysis::modes::modes;
    use crate::analysis::poles::poles;
    use crate::analysis::test_systems::{blank, oscillator, push};
    use crate::system::LinearSystem;

    /// m = 1, k = 1, c = 0.2: a peak at sqrt 0.98, and no other extremum.
    #[test]
    fn a_bracket_without_an_extremum_gives_none() {
        let system = oscillator("1", "0.2", "1");
        let transfer = Transfer::of(&system);
        let pair = Pair { transfer: &transfer, input: 0, output: 0, by_modes: None };
        let found = pair.root((0.9, 1.1), FeatureKind::Peak).expect("a peak");
        assert!((found.to_f64() - 0.98f64.sqrt()).abs() <= found.rad + 1e-15, "{found:?}");
        assert_eq!(pair.root((0.9, 1.1), FeatureKind::Antiresonance), None);
        for bracket in [(0.9, 0.95), (0.97, 0.985), (0.995, 1.01), (1.2, 1.4)] {
            for kind in [FeatureKind::Peak, FeatureKind::Antiresonance] {
                assert_eq!(pair.root(bracket, kind), None, "{bracket:?}");
            }
        }
    }

    /// Two uncoupled oscillators: the receptance of the first is infinite at its own frequency, and no pole of the
    /// second is a pole of it, whether it is far away or closer to 1 rad/s than the circle on which |H| is evaluated.
    #[test]
    fn a_pole_that_an_output_does_not_see_is_no_peak() {
        for (stiffness, omega) in [("4", 2.0), ("1.0000000200000001", 1.00000001)] {
            let mut system = blank(2);
            for (i, stiffness) in ["1", stiffness].into_iter().enumerate() {
                push(&mut system.m, "1", i, None);
                push(&mut system.k, stiffness, i, None);
            }
            let poles = poles(&system, &modes(&system).expect("modes")).expect("poles");
            let near = |omega: f64| {
                let at = poles.list.iter().map(|pole| pole.im).find(|im| (im.to_f64() - omega).abs() < 1e-12);
                at.expect("a pole")
            };
            let transfer = Transfer::of(&system);
            let sum = ModalSum::of(&system, &modes(&system).expect("modes")).expect("undamped");
            let modal = sum.pair(&system, 0, 0);
            for by_modes in [None, Some((&sum, &modal))] {
                let pair = Pair { transfer: &transfer, input: 0, output: 0, by_modes };
                assert!(!pair.has_pole_at(near(omega), &poles), "{omega}");
                // A pole with a neighbour within the circle is not reported.
                assert_eq!(pair.has_pole_at(near(1.0), &poles), omega == 2.0);
                let alone = pair.exceeds_circle_by_modes(near(1.0), CIRCLE);
                assert_eq!(alone, by_modes.is_some());
                // The circle about the second's pole holds that of the first if it is so near.
                let other = pair.exceeds_circle_by_modes(near(omega), omega * CIRCLE);
                assert_eq!(other, by_modes.is_some() && omega != 2.0);
            }
        }
    }

    /// The largest of 64 values on a circle about i omega, by elimination: of the last coordinate by a force on the first.
    fn largest_on_circle(transfer: &Transfer, n: usize, omega: Dd, radius: f64) -> f64 {
        let value = |step: u32| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(step) / 64.0);
            let s = Complex::new(Ball::from(radius * sin), Ball::exact(omega) + Ball::from(radius * cos));
            Jet::at(transfer, s, 0, n - 1).expect("no pole").value().mid().to_f64().abs()
        };
        (0..64).map(value).fold(0.0, f64::max)
    }

    /// Between the largest of 64 values on a circle, by elimination, and a hundred times as much: circles about a pole, beside
    /// one, and around several.
    #[test]
    fn no_value_on_a_circle_is_larger_than_its_bound() {
        for n in [1, 6] {
            let mut system = blank(n);
            for i in 0..n {
                push(&mut system.m, "1", i, None);
                push(&mut system.k, "1000", i, i.checked_sub(1));
            }
            let modes = modes(&system).expect("modes");
            let sum = ModalSum::of(&system, &modes).expect("undamped");
            let (modal, transfer) = (sum.pair(&system, 0, n - 1), Transfer::of(&system));
            let poles = poles(&system, &modes).expect("poles");
            let own: Vec<Dd> = poles.list.iter().map(|pole| pole.im.mid).filter(|im| im.hi > 0.0).collect();
            assert_eq!(own.len(), n);
            for (omega, relative) in own.iter().flat_map(|w| [(*w, 1e-6), (*w * 1.0000001, 1e-6), (*w, 1e-2)]) {
                let radius = omega.hi * relative;
                let largest = largest_on_circle(&transfer, n, omega, radius);
                let bound = sum.most_on_circle(&modal, omega, radius);
                assert!(largest <= bound * (1.0 + 1e-9), "{omega:?} {largest:e} {bound:e}");
                assert!(bound < 100.0 * largest, "{omega:?} {largest:e} {bound:e}");
            }
            // A circle through a pole, and one about zero.
            let first = own.iter().fold(own[0], |least, w| if w.hi < least.hi { *w } else { least });
            assert_eq!(sum.most_on_circle(&modal, first * 0.75, first.hi * 0.25), f64::INFINITY);
            assert_eq!(sum.most_on_circle(&modal, Dd::ZERO, 1.0), f64::INFINITY);
            // Damping that does not couple the modes brings each pole half of the circle's radius nearer to it.
            for i in 0..n {
                push(&mut system.c, "0.1", i, None);
            }
            let modes = crate::analysis::modes(&system).expect("modes");
            let sum = ModalSum::of(&system, &modes).expect("damping in proportion to masses");
            let (modal, transfer) = (sum.pair(&system, 0, n - 1), Transfer::of(&system));
            for omega in own {
                let radius = 0.1;
                let largest = largest_on_circle(&transfer, n, omega, radius);
                let bound = sum.most_on_circle(&modal, omega, radius);
                assert!(largest <= bound * (1.0 + 1e-9) && bound < 100.0 * largest, "{omega:?} {largest:e} {bound:e}");
            }
        }
    }

    fn known(size: f64) -> Gain {
        Gain::Finite(Disc { value: Complex::new(Dd::ZERO, Dd::from(-size)), radius: 1e-20 })
    }

    /// Maxima and minima of a grid; at a plateau they count once, and beside a value without a correct digit not at all.
    #[test]
    fn brackets_are_the_maxima_and_minima_of_a_grid() {
        let of = |sizes: &[f64]| {
            let list: Vec<(f64, Gain)> = (1..).zip(sizes).map(|(i, &size)| (f64::from(i), known(size))).collect();
            significant_brackets(&list)
        };
        let two_pi = 2.0 * std::f64::consts::PI;
        let at = |low: f64, kind: FeatureKind| ((low * two_pi, (low + 2.0) * two_pi), kind);
        use FeatureKind::{Antiresonance, Peak};
        assert_eq!(of(&[1.0, 3.0, 2.0, 1.0, 4.0]), [at(1.0, Peak), at(3.0, Antiresonance)]);
        assert_eq!(of(&[1.0, 3.0, 3.0, 2.0, 2.0, 5.0]), [at(1.0, Peak), at(3.0, Antiresonance)]);
        assert!(of(&[3.0, 3.0, 3.0]).is_empty() && of(&[1.0, 1.0, 2.0]).is_empty() && of(&[2.0, 2.0, 1.0]).is_empty());
        for which in 0..3 {
            let mut list = [(1.0, known(1.0)), (2.0, known(3.0)), (3.0, known(2.0))];
            list[which].1 = Gain::Unknown;
            assert_eq!(significant_brackets(&list).len(), usize::from(which == 1), "{which}");
            list[which].1 = Gain::Finite(Disc { value: Complex::real(Dd::ONE), radius: 0.5 });
            assert!(which == 1 || significant_brackets(&list).is_empty(), "{which}");
        }
    }

    /// Two masses in a row from a wall, of which only the first is damped: between the frequencies of a grid both peaks and the
    /// minimum at 1 rad/s are found, and in open ranges only those in them; nothing is said of the rest.
    #[test]
    fn a_grid_leads_to_the_extrema_in_its_open_ranges() {
        let mut system = blank(2);
        for i in 0..2 {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, "1", i, i.checked_sub(1));
        }
        let poles = poles(&system, &modes(&system).expect("modes")).expect("poles");
        let mut damped = system.clone();
        push(&mut damped.c, "0.01", 0, None);
        let two_pi = 2.0 * std::f64::consts::PI;
        let grid: Vec<f64> = (1..60).map(|i| 0.04 * f64::from(i) / two_pi).collect();
        let found = |system: &LinearSystem, poles: &Poles, open: &[(f64, f64)]| {
            let transfer = Transfer::of(system);
            let exact = |hertz: f64| Number::from(Rational::from_f64(hertz).expect("finite"));
            let at = |hertz: f64| transfer.at(&Frequency::hertz(&exact(hertz)))[0][0];
            let gains: Vec<(f64, Gain)> = grid.iter().map(|&hertz| (hertz, at(hertz))).collect();
            let found = bracket(&transfer, (0, 0), None, poles, &gains, open);
            assert!(found.complete.is_none());
            assert_eq!(found.open, [(grid[0], grid[58])]);
            found
                .list
                .iter()
                .map(|one| (one.kind, one.gain == Gain::Infinite, one.frequency.to_f64() * two_pi))
                .collect::<Vec<_>>()
        };
        let root = 5f64.sqrt();
        let expected = [
            (FeatureKind::Peak, ((3.0 - root) / 2.0).sqrt()),
            (FeatureKind::Antiresonance, 1.0),
            (FeatureKind::Peak, ((3.0 + root) / 2.0).sqrt()),
        ];
        let none = Poles::default();
        for (system, poles, infinite) in [(&system, &poles, true), (&damped, &none, false)] {
            for open in 0..8u32 {
                // About each of them, in any number.
                let about = |i: usize| ((expected[i].1 - 0.1) / two_pi, (expected[i].1 + 0.1) / two_pi);
                let ranges: Vec<(f64, f64)> = (0..3).filter(|i| open >> i & 1 == 1).map(about).collect();
                let list = found(system, poles, &ranges);
                let wanted: Vec<usize> = (0..3).filter(|i| open == 0 || open >> i & 1 == 1).collect();
                assert_eq!(list.len(), wanted.len(), "{open} {list:?}");
                for (found, &i) in list.iter().zip(&wanted) {
                    let facts = (found.0, found.1);
                    assert_eq!(
                        facts,
                        (expected[i].0, infinite && expected[i].0 == FeatureKind::Peak),
                        "{open} {list:?}"
                    );
                    assert!((found.2 - expected[i].1).abs() < if infinite { 1e-14 } else { 1e-3 }, "{open} {list:?}");
                }
            }
        }
    }

    /// Peaks at sqrt 0.98: what was known to 1e-12 is known to more digits afterwards, unless the ball does not hold the extremum, or
    /// another ball meets it; a zero and what is infinite stay.
    #[test]
    fn an_extremum_is_sharpened_within_its_ball_alone() {
        let system = oscillator("1", "0.2", "1");
        let transfer = Transfer::of(&system);
        let truth = Number::from("0.98").sqrt().expect("positive").to_ball() / (Ball::from(2.0) * Ball::PI);
        let known = |off: f64, radius: f64, gain: Gain| Extremum {
            kind: FeatureKind::Peak,
            frequency: Ball::new(truth.mid + Dd::from(off), radius),
            gain,
            width: None,
        };
        let rough = Gain::Finite(Disc { value: Complex::real(Dd::from(5.0)), radius: 1.0 });
        let sharpened =
            |list: Vec<Extremum>| sharpen(&transfer, 0, 0, Extrema { list, complete: None, open: Vec::new() }).list;
        for (off, radius, is_sharp) in [
            (1e-13, 1e-12, true),
            (-1e-13, 1e-12, true),
            (1e-9, 1e-8, true),
            (2e-12, 1e-12, false),
            (-3e-14, 1e-15, false),
        ] {
            let before = known(off, radius, rough);
            let after = sharpened(vec![before.clone()]).remove(0);
            if is_sharp {
                assert!((after.frequency - truth).contains_zero() && after.frequency.rad < 1e-25, "{off:e}: {after:?}");
                // 1 / (2 zeta sqrt(1 - zeta^2)) with zeta = 0.1
                let gain = after.gain.disc().expect("finite").gain();
                assert!((gain.to_f64() - 1.0 / (0.2 * 0.99f64.sqrt())).abs() < 1e-14 && gain.rad < 1e-20, "{gain:?}");
            } else {
                assert_eq!((after.frequency, after.gain), (before.frequency, before.gain), "{off:e}");
            }
        }
        for gain in [Gain::Infinite, Gain::Finite(Disc { value: Complex::ZERO, radius: 0.0 })] {
            let before = known(1e-13, 1e-12, gain);
            let after = sharpened(vec![before.clone()]).remove(0);
            assert_eq!((after.frequency, after.gain), (before.frequency, gain));
        }
        // Of two balls that hold it neither is sharpened; one that is apart from it says nothing.
        let both = sharpened(vec![known(-1e-13, 1e-12, rough), known(1e-13, 1e-12, rough)]);
        assert!(both.iter().all(|one| one.frequency.rad == 1e-12), "{both:?}");
        for (list, at) in [([1e-13, 1e-3], 0), ([-1e-3, 1e-13], 1)] {
            let list = sharpened(list.map(|off| known(off, 1e-12, rough)).to_vec());
            assert!(list[at].frequency.rad < 1e-25 && list[1 - at].frequency.rad == 1e-12, "{list:?}");
        }
    }
}
