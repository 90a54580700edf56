//! All extrema of |H| where H is a sum over poles. The frequencies are cut into intervals, each small beside the distance of
//! the nearest pole, over which H is a Taylor polynomial with a bound of its error. So is F = re(conj H dH/domega), whose
//! changes of sign are the extrema: over each piece of an interval either F has no root, or F' has none and the signs of F at
//! both ends decide. Pieces that stay open are reported. In: H, a range. Out: its extrema, with half-power widths. See
//! docs/method/transfer.md#extrema-from-sums-over-poles.

mod product;
mod widths;

use super::{Complete, Extrema, Extremum, FeatureKind};
use crate::analysis::derived::hertz;
use crate::analysis::transfer::partial_fractions::{Expansion, Local, PartialFractions, size};
use crate::analysis::transfer::{Disc, Gain};
use crate::base::{Ball, Dd, down, up};
use product::{CUT, Piece, Product};
use widths::Widths;

/// A range of frequencies, rad/s.
#[derive(Clone, Copy, Debug)]
struct Interval {
    low: Dd,
    high: Dd,
    /// The number of times that a piece stayed open and was expanded anew, in more digits.
    renewed: u32,
}

/// A root of F: an extremum and what is known about it.
#[derive(Clone, Copy, Debug)]
struct Located {
    omega: Ball,
    kind: FeatureKind,
    gain: Disc,
    /// An approximation of F' there.
    bend: f64,
}

/// The most intervals; a few for each pole are usual.
const MOST_INTERVALS: usize = 20_000;
/// The most outside of the range, where only half-power points may lie.
const MOST_BEYOND: usize = 2_000;
/// An interval is expanded if its half is at most the distance from the nearest pole over this.
const CLEAR: f64 = 3.0;
/// Number of times that a piece may be expanded anew.
const MOST_RENEWALS: u32 = 12;
/// The most steps towards a root in binary64.
const MOST_STEPS: usize = 80;
/// The most steps in double-double.
const REFINEMENTS: usize = 6;

/// Every extremum between two frequencies, rad/s.
pub fn expanded(h: &PartialFractions, low: Ball, high: Ball) -> Extrema {
    if h.is_nothing() {
        return Extrema { list: Vec::new(), complete: Some(Complete(())), open: Vec::new() };
    }
    let (from, to) = ((low.to_f64() * down::FEW).max(0.0), high.to_f64() * up::FEW);
    let mut inside = Search::new(h, MOST_INTERVALS);
    inside.search(from, to);
    // A half-power width may extend beyond the range.
    let mut below = Search::new(h, MOST_BEYOND);
    below.search(0.0, from);
    let mut above = Search::new(h, MOST_BEYOND);
    let top = 2.0 * to.max(2.0 * h.largest());
    above.search(to, top);
    let (located, gaps) = distinct([below.found, inside.found, above.found].concat());
    inside.open.extend(&gaps);
    let open = [&below.open[..], &inside.open, &above.open].concat();
    let within = |omega: Ball| !(omega - low).is_negative() && !(high - omega).is_negative();
    let widths = Widths { h, located: &located, open: &open, top };
    let list = (0..located.len())
        .filter(|&i| within(located[i].omega))
        .map(|i| Extremum {
            kind: located[i].kind,
            frequency: hertz(located[i].omega),
            gain: Gain::Finite(located[i].gain),
            width: if located[i].kind == FeatureKind::Peak { widths.of(i).map(hertz) } else { None },
        })
        .collect();
    let open = merged(inside.open);
    Extrema { list, complete: open.is_empty().then_some(Complete(())), open }
}

/// Intervals overlap by a rounding error, and a root there is found twice. Maxima and minima alternate: of two of a kind in a
/// row that are certainly apart one is missing between them: such gaps, rad/s.
fn distinct(found: Vec<Located>) -> (Vec<Located>, Vec<(f64, f64)>) {
    let (mut list, mut gaps): (Vec<Located>, Vec<(f64, f64)>) = (Vec::with_capacity(found.len()), Vec::new());
    for next in found {
        match list.last().filter(|last| last.kind == next.kind) {
            Some(last) if (next.omega - last.omega).contains_zero() => {}
            Some(last) => {
                gaps.push((last.omega.to_f64(), next.omega.to_f64()));
                list.push(next);
            }
            None => list.push(next),
        }
    }
    (list, gaps)
}

/// In Hz, with neighbours joined.
fn merged(mut open: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    open.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut list: Vec<(f64, f64)> = Vec::new();
    for (from, to) in open {
        match list.last_mut().filter(|last| last.1 >= from * (1.0 - 1e-12)) {
            Some(last) => last.1 = last.1.max(to),
            None => list.push((from, to)),
        }
    }
    let hertz = |omega: f64| omega / (2.0 * std::f64::consts::PI);
    list.into_iter().map(|(from, to)| (hertz(from), hertz(to))).collect()
}

struct Search<'a> {
    h: &'a PartialFractions,
    found: Vec<Located>,
    /// rad/s
    open: Vec<(f64, f64)>,
    left: usize,
}

impl Search<'_> {
    fn new(h: &PartialFractions, most: usize) -> Search<'_> {
        Search { h, found: Vec::new(), open: Vec::new(), left: most }
    }

    fn search(&mut self, low: f64, high: f64) {
        let has_width = low < high;
        if !has_width {
            return;
        }
        let mut stack = vec![Interval { low: low.into(), high: high.into(), renewed: 0 }];
        while let Some(interval) = stack.pop() {
            let width = (interval.high - interval.low).to_f64();
            let is_divisible = width > interval.high.to_f64() * 1e-28;
            if self.left == 0 || !is_divisible || interval.renewed > MOST_RENEWALS {
                self.open.push((interval.low.to_f64().next_down(), interval.high.to_f64().next_up()));
                continue;
            }
            // An expansion in double-double takes some ten times as long.
            self.left = self.left.saturating_sub(if interval.renewed > 0 { 10 } else { 1 });
            // From zero on, |H| is even and F odd: the interval is taken on both sides of it.
            let from_zero = interval.low.is_zero();
            let (middle, half) = match from_zero {
                true => (Dd::ZERO, width),
                false => ((interval.low + interval.high).scale(0.5), 0.5 * width),
            };
            // Covers the rounding of both.
            let half = half * up::DOZENS + middle.hi * 4.0 * Dd::EPSILON;
            let clear = self.h.clearance(middle) >= CLEAR * half;
            let expansion = if clear { self.h.expansion(middle, half, interval.renewed > 0) } else { None };
            let Some(expansion) = expansion else {
                stack.extend(cut(interval));
                continue;
            };
            let product = Product::of(&expansion);
            if from_zero {
                if !product.piece(0.0, 1.0).is_monotone() {
                    stack.extend(cut(Interval { renewed: interval.renewed + 1, ..interval }));
                }
                continue;
            }
            let (roots, left) = product.roots();
            let at = Cell { h: self.h, middle, half, expansion: &expansion, product: &product };
            for root in roots {
                match at.located(&root) {
                    Some(located) => self.found.push(located),
                    None => self.open.push((at.omega(root.low()).to_f64(), at.omega(root.high()).to_f64())),
                }
            }
            let renewed = interval.renewed + 1;
            let again = |piece: &Piece| Interval { low: at.omega(piece.low()), high: at.omega(piece.high()), renewed };
            for piece in left.iter().rev().map(|piece| (piece, again(piece))) {
                // In double-double and in a smaller interval, F would drown in the same error.
                if interval.renewed > 0 && piece.0.value.abs() + piece.0.swing < product.noise {
                    self.open.push((piece.1.low.to_f64(), piece.1.high.to_f64()));
                } else {
                    stack.push(piece.1);
                }
            }
        }
        self.found.sort_by(|a, b| a.omega.to_f64().total_cmp(&b.omega.to_f64()));
    }
}

/// Both parts, the lower one last.
fn cut(interval: Interval) -> [Interval; 2] {
    let at = interval.low + (interval.high - interval.low) * Dd::from(CUT);
    [Interval { low: at, ..interval }, Interval { high: at, ..interval }]
}

/// An interval with its polynomials.
struct Cell<'a> {
    h: &'a PartialFractions,
    middle: Dd,
    half: f64,
    expansion: &'a Expansion,
    product: &'a Product,
}

impl Cell<'_> {
    fn omega(&self, t: f64) -> Dd {
        self.middle + Dd::product(self.half, t)
    }

    /// The only root in a piece, with H there; `None` if there is no bound of its distance.
    fn located(&self, piece: &Piece) -> Option<Located> {
        let rising = piece.slope > 0.0;
        let start = self.product.bisect(piece, rising);
        // Close to the root F' varies less, and the bound of the root's distance is sharper.
        let near = self.product.piece(start, piece.half * (1.0 / 64.0));
        let holds = |t: f64| (piece.low()..=piece.high()).contains(&t);
        let [low, high] = [near.low(), near.high()];
        let certain = holds(low) && holds(high) && near.is_monotone();
        let certain = certain && self.product.sign(low) * self.product.sign(high) < 0;
        let piece = if certain { &near } else { piece };
        // The polynomial's own root is good to what it leaves out: the secant through two points makes the rest fast.
        let mut bend = near.slope / (self.half * self.half);
        let mut omega = self.omega(start);
        let mut local = self.h.at(omega);
        let (mut f, mut error) = slope_of(&local);
        for _ in 0..REFINEMENTS {
            let next = omega - f / Dd::from(bend);
            let inside = next > self.omega(piece.low()) && next < self.omega(piece.high());
            let step = (next - omega).to_f64();
            if !inside || f.to_f64().abs() <= 2.0 * error || step == 0.0 {
                break;
            }
            let before = f;
            (omega, local) = (next, self.h.at(next));
            (f, error) = slope_of(&local);
            let secant = (f - before).to_f64() / step;
            if (secant / bend - 1.0).abs() < 0.5 {
                bend = secant;
            }
        }
        // By the mean value theorem.
        let reach = (f.to_f64().abs() + error) / (piece.least_slope() / (self.half * self.half)) * up::FEW;
        let reach = reach + omega.hi * 4.0 * Dd::EPSILON;
        if !reach.is_finite() {
            return None;
        }
        let steeper = (size(&self.expansion.coefficients, 2) + self.expansion.errors[2]) / (self.half * self.half);
        let steepest = local.slope.to_f64().abs() + local.errors[1] + reach * steeper;
        let radius = (local.errors[0] + reach * steepest) * up::DOZENS;
        let kind = if rising { FeatureKind::Antiresonance } else { FeatureKind::Peak };
        Some(Located { omega: Ball::new(omega, reach), kind, gain: Disc { value: local.h, radius }, bend })
    }
}

/// F and a bound of its error.
fn slope_of(local: &Local) -> (Dd, f64) {
    let Local { h, slope, errors } = local;
    let [h0, h1] = [h, slope].map(|z| z.to_f64().abs() * up::FEW);
    let error = h0 * errors[1] + h1 * errors[0] + errors[0] * errors[1] + 8.0 * Dd::EPSILON * h0 * h1;
    (h.re * slope.re + h.im * slope.im, error * up::DOZENS + f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::modes::modes;
    use crate::analysis::poles::poles_and_residues;
    use crate::analysis::test_systems::{blank, push};
    use crate::analysis::transfer::extrema::{Denominator, Exactly};
    use crate::analysis::transfer::{Frequency, Transfer};
    use crate::base::{Number, Rational};
    use crate::kernel::complex::Complex;
    use crate::system::{CoordinateId, LinearSystem};

    /// Masses in a row, each with a spring and a damper to the one before, and some to the one before that. The first input is
    /// a force, the second the motion of the base, which enters by a spring and a damper; outputs are the last displacement, its
    /// velocity and its acceleration, each relative to what the base does.
    fn network(n: usize, damping: usize) -> LinearSystem {
        let dampers = [["0.013", "0.02", "0.007"], ["0.3", "1.1", "0.2"], ["2.5", "0.1", "7"]][damping];
        let mut system = blank(n);
        for i in 0..n {
            push(&mut system.m, ["1.2", "1.7", "1.1", "1.9"][i % 4], i, None);
            push(&mut system.k, ["2.3", "1.4", "2.9"][i % 3], i, i.checked_sub(1));
            push(&mut system.c, dampers[i % 3], i, i.checked_sub(1));
            if i > 1 && i % 2 == 0 {
                push(&mut system.k, "0.8", i, Some(i - 2));
                push(&mut system.c, dampers[(i + 1) % 3], i, Some(i - 2));
            }
        }
        let at = |i: usize, x: &str| vec![(CoordinateId(i as u32), Number::from(x))];
        system.inputs.truncate(2.min(n));
        if n > 1 {
            system.inputs[1].b = [at(0, "2.3"), at(0, dampers[0]), Vec::new()];
        }
        let displacement = system.outputs[n - 1].clone();
        system.outputs = vec![displacement; 3];
        for power in 1..3 {
            system.outputs[power].p.swap(0, power);
            system.outputs[power].d[power] = vec![(1, -&Number::ONE)];
        }
        system
    }

    fn fractions(system: &LinearSystem, input: usize, output: usize) -> PartialFractions {
        let poles = poles_and_residues(system, &modes(system).expect("modes")).expect("poles");
        let residues = poles.residues.expect("no pole is on the axis");
        PartialFractions::of(system, &residues, input, output).expect("finite")
    }

    /// Zeros and poles in exact arithmetic know nothing of residues: the same extrema, gains and widths, one to one.
    #[test]
    fn extrema_are_those_of_exact_arithmetic() {
        let (low, high) = (Ball::from(1e-2), Ball::from(20.0));
        let mut compared = 0;
        for (n, damping) in [(2, 0), (4, 0), (3, 1), (5, 1), (3, 2)] {
            let system = network(n, damping);
            let coordinates: Vec<u32> = (0..n as u32).collect();
            let denominator = Denominator::of(&system, &coordinates).expect("rational");
            for (input, output) in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 2)] {
                let factored = denominator.pair(&system, input, output).expect("roots");
                let truth = Exactly::of(&factored).expect("in range").extrema(low, high);
                let found = expanded(&fractions(&system, input, output), low, high);
                let which = format!("{n} {damping} {input} {output}");
                assert!(truth.is_complete() && found.is_complete(), "{which}: {:?}", found.open);
                assert_eq!(found.list.len(), truth.list.len(), "{which}: {found:?} {truth:?}");
                for (found, truth) in found.list.iter().zip(&truth.list) {
                    let agree = |a: Ball, b: Ball| (a - b).contains_zero() && a.relative_error() < 1e-18;
                    assert_eq!(found.kind, truth.kind, "{which}");
                    assert!(agree(found.frequency, truth.frequency), "{which}: {found:?} {truth:?}");
                    let [a, b] = [found, truth].map(|extremum| extremum.gain.disc().expect("finite"));
                    assert!((a.value - b.value).to_f64().abs() <= a.radius + b.radius, "{which}: {a:?} {b:?}");
                    assert!(a.relative_error() < 1e-18, "{which}: {a:?}");
                    assert_eq!(found.width.is_some(), truth.width.is_some(), "{which}: {found:?} {truth:?}");
                    assert!(
                        found.width.zip(truth.width).is_none_or(|(a, b)| agree(a, b)),
                        "{which}: {found:?} {truth:?}"
                    );
                    compared += 1;
                }
            }
        }
        assert!(compared > 40, "{compared}");
    }

    /// Beside elimination in discs, at ordinary frequencies, next to poles and far above all.
    #[test]
    fn values_and_slopes_are_within_their_bounds() {
        for damping in 0..3 {
            let system = network(6, damping);
            let transfer = Transfer::of(&system);
            for (input, output) in (0..2).flat_map(|i| (0..3).map(move |o| (i, o))) {
                let sum = fractions(&system, input, output);
                for omega in [1e-3, 0.73, 1.9, 3.1, 200.0] {
                    let frequency = Frequency::radians(&Number::from(Rational::from_f64(omega).expect("finite")));
                    let truth = transfer.between(&frequency, &[input], &[output])[0][0].disc().expect("finite");
                    let found = sum.gain(&frequency).disc().expect("finite");
                    let off = (found.value - truth.value).to_f64().abs();
                    assert!(
                        off <= found.radius + truth.radius,
                        "{damping} {input} {output} {omega}: {found:?} {truth:?}"
                    );
                    let by_differences = |side: f64| {
                        let local = sum.at(Dd::from(omega) + Dd::from(side * 1e-9 * omega));
                        (local.h, local.slope)
                    };
                    let ((above, slope), (below, _)) = (by_differences(1.0), by_differences(-1.0));
                    let quotient = (above - below).scale(Dd::from(0.5e9 / omega));
                    let off = (quotient - slope).to_f64().abs();
                    assert!(off < 1e-6 * slope.to_f64().abs() + 1e-12 * quotient.to_f64().abs(), "{omega}: {off:e}");
                }
            }
        }
    }

    /// The bounds include what the sum neglects: if the remainder of an excitation is made large, they prove nothing and say so.
    #[test]
    fn what_the_sum_leaves_out_is_in_the_bounds() {
        let system = network(6, 1);
        let poles = poles_and_residues(&system, &modes(&system).expect("modes")).expect("poles");
        let mut residues = (*poles.residues.expect("residues")).clone();
        let frequency = Frequency::radians(&Number::ONE);
        let before =
            PartialFractions::of(&system, &residues, 0, 0).expect("finite").gain(&frequency).disc().expect("finite");
        for rest in &mut residues.inputs[0][0].as_mut().expect("a force").rest {
            *rest = 1e-3;
        }
        let sum = PartialFractions::of(&system, &residues, 0, 0).expect("finite");
        let after = sum.gain(&frequency).disc().expect("finite");
        assert!(before.radius < 1e-25 && after.radius > 1e-4, "{before:?} {after:?}");
        assert!(!expanded(&sum, Ball::from(0.9), Ball::from(1.0)).is_complete());
    }

    /// Residues known to 1e-9: frequencies and gains hold those of residues that are off by nearly as much.
    #[test]
    fn uncertainty_of_residues_is_in_the_extrema() {
        let system = network(4, 0);
        let poles = poles_and_residues(&system, &modes(&system).expect("modes")).expect("poles");
        let residues = (*poles.residues.expect("residues")).clone();
        let with = |change: &dyn Fn(&mut Complex<Ball>, usize)| {
            let mut residues = residues.clone();
            let force = residues.inputs[0][0].as_mut().expect("a force");
            force.amplitudes.iter_mut().enumerate().for_each(|(j, amplitude)| change(amplitude, j));
            let sum = PartialFractions::of(&system, &residues, 0, 0).expect("finite");
            expanded(&sum, Ball::from(1e-2), Ball::from(20.0))
        };
        let found = with(&|amplitude, _| {
            *amplitude = Complex::new(amplitude.re.widen(1e-9), amplitude.im.widen(1e-9));
        });
        let truth = with(&|amplitude, j| {
            let by = Ball::from(if j % 2 == 0 { 0.9e-9 } else { -0.9e-9 });
            *amplitude = Complex::new(amplitude.re + by, amplitude.im - by);
        });
        assert!(truth.is_complete() && truth.list.len() > 4 && found.list.len() == truth.list.len());
        for (found, truth) in found.list.iter().zip(&truth.list) {
            assert!((found.frequency - truth.frequency).contains_zero(), "{found:?} {truth:?}");
            let [a, b] = [found, truth].map(|extremum| extremum.gain.disc().expect("finite"));
            assert!((a.value - b.value).to_f64().abs() <= a.radius, "{a:?} {b:?}");
            assert!(a.relative_error() < 1e-4 && b.relative_error() < 1e-20, "{a:?} {b:?}");
        }
    }

    /// Two maxima in a row that are certainly apart have a minimum between them that was not found; two in one place are one.
    #[test]
    fn extrema_alternate_or_leave_a_gap() {
        let at = |omega: f64, kind: FeatureKind| Located {
            omega: Ball::from(omega).widen(1e-9),
            kind,
            gain: Disc { value: Complex::ZERO, radius: 0.0 },
            bend: 1.0,
        };
        use FeatureKind::{Antiresonance, Peak};
        let (list, gaps) = distinct(vec![at(1.0, Peak), at(2.0, Peak), at(2.0 + 1e-10, Peak), at(3.0, Antiresonance)]);
        assert_eq!((list.len(), gaps), (3, vec![(1.0, 2.0)]));
        let (list, gaps) = distinct(vec![at(1.0, Peak), at(2.0, Antiresonance), at(3.0, Peak)]);
        assert_eq!((list.len(), gaps.len()), (3, 0));
    }

    /// An output that is its input alone: |H| is 1 at every frequency, no sign of F is certain, nothing is proved, and all of the
    /// range is open.
    #[test]
    fn a_gain_that_is_the_same_everywhere_is_left_open() {
        let mut system = network(2, 1);
        system.outputs[0].p = [Vec::new(), Vec::new(), Vec::new()];
        system.outputs[0].d[0] = vec![(0, Number::ONE)];
        let found = expanded(&fractions(&system, 0, 0), Ball::from(0.5), Ball::from(2.0));
        assert!(!found.is_complete() && found.list.is_empty(), "{found:?}");
        let (low, high) = found.open.iter().fold((f64::INFINITY, 0.0f64), |(a, b), x| (a.min(x.0), b.max(x.1)));
        let two_pi = 2.0 * std::f64::consts::PI;
        assert!(low * two_pi < 0.5001 && high * two_pi > 1.9999, "{:?}", found.open);
    }
}
