//! Extrema of sums over poles against exact arithmetic, and of sums that are uncertain.

use super::*;
use crate::analysis::modes::modes;
use crate::analysis::poles::poles_and_residues;
use crate::analysis::test_systems::{blank, push};
use crate::analysis::transfer::extrema::{Denominator, Exactly};
use crate::analysis::transfer::partial_fractions::{Given, Part};
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
            let found = by_expansion(&fractions(&system, input, output), low, high);
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
                assert!(found.width.zip(truth.width).is_none_or(|(a, b)| agree(a, b)), "{which}: {found:?} {truth:?}");
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
                assert!(off <= found.radius + truth.radius, "{damping} {input} {output} {omega}: {found:?} {truth:?}");
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
    assert!(!by_expansion(&sum, Ball::from(0.9), Ball::from(1.0)).is_complete());
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
        by_expansion(&sum, Ball::from(1e-2), Ball::from(20.0))
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
        gain: Gain::Finite(Disc::ZERO),
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
    let found = by_expansion(&fractions(&system, 0, 0), Ball::from(0.5), Ball::from(2.0));
    assert!(!found.is_complete() && found.list.is_empty(), "{found:?}");
    let (low, high) = found.open.iter().fold((f64::INFINITY, 0.0f64), |(a, b), x| (a.min(x.0), b.max(x.1)));
    let two_pi = 2.0 * std::f64::consts::PI;
    assert!(low * two_pi < 0.5001 && high * two_pi > 1.9999, "{:?}", found.open);
}

/// The sum over these poles, (-decay + i omega, residue, what it is uncertain by), and over their conjugates.
fn over(poles: &[(Complex<f64>, Complex<f64>, f64)]) -> PartialFractions {
    let given = poles.iter().map(|&(s, r, doubt)| {
        let none = Complex::<Ball>::ZERO;
        let r =
            Complex::new(Ball::from(r.re).widen(doubt), Ball::from(r.im).widen(if s.im == 0.0 { 0.0 } else { doubt }));
        let s = Complex::new(Dd::from(s.re), Dd::from(s.im));
        Given { s, loose: 0.0, products: [r, none, none, none, none], rest: [0.0; 5] }
    });
    PartialFractions::of_poles(given, [Ball::ZERO; 5], [Ball::ZERO; 3], Part::Both).expect("finite")
}

/// H = (a + s) / ((1 + s) (2 + s)), whose |H|^2 = (a^2 + x) / ((1 + x) (4 + x)), x = omega^2, is largest where
/// x^2 + 2 a^2 x + 5 a^2 - 4 = 0: close to zero, in the first interval, from zero on.
#[test]
fn an_extremum_next_to_zero_is_found() {
    for a in [0.893f64, 0.8944] {
        let of = |s: f64, r: f64| (Complex::new(s, 0.0), Complex::new(r, 0.0), 0.0);
        let found = by_expansion(&over(&[of(-1.0, a - 1.0), of(-2.0, 2.0 - a)]), Ball::ZERO, Ball::from(10.0));
        assert!(found.is_complete(), "{found:?}");
        let [peak] = &found.list[..] else { panic!("{found:?}") };
        let square = a * a;
        let x = (square * square + 4.0 - 5.0 * square).sqrt() - square;
        let omega = peak.frequency.to_f64() * 2.0 * std::f64::consts::PI;
        // Differences of numbers near one, under a root.
        assert!(peak.kind == FeatureKind::Peak && (omega - x.sqrt()).abs() < 1e-13, "{omega} {}", x.sqrt());
    }
}

/// Two peaks so close that |H|^2 stays above half of the first one between them: it has no width of its own, wherever the range
/// ends, and the second is its neighbour if the range ends before it.
#[test]
fn what_lies_beyond_the_range_bounds_a_width() {
    let of = |omega: f64| (Complex::new(-0.05, omega), Complex::new(0.0, -0.5 / omega), 0.0);
    let sum = over(&[of(1.0), of(1.1)]);
    let size = |omega: f64| {
        let h = [1.0f64, 1.1].map(|own| {
            let (re, im) = (own * own + 0.0025 - omega * omega, 0.1 * omega);
            [re, -im].map(|x| x / (re * re + im * im))
        });
        (h[0][0] + h[1][0]).powi(2) + (h[0][1] + h[1][1]).powi(2)
    };
    let least = (0..=200).map(|step| size(0.99 + 5e-4 * f64::from(step))).fold(f64::INFINITY, f64::min);
    assert!(least > 0.55 * size(0.9931) && size(1.1043) > 1.4 * least);
    for high in [1.02, 1.07, 2.0] {
        let found = by_expansion(&sum, Ball::from(0.5), Ball::from(high));
        assert!(found.is_complete() && found.list[0].width.is_none(), "{high}: {found:?}");
    }
    // A range that ends next to a peak, and one that begins there: the width reaches out of both.
    let alone = over(&[of(1.0)]);
    let widths = [(0.5, 2.0), (0.5, 0.9995), (0.995, 2.0)].map(|(low, high)| {
        let found = by_expansion(&alone, Ball::from(low), Ball::from(high));
        assert_eq!(found.list.len(), 1, "{found:?}");
        found.list[0].width.expect("a width")
    });
    // |H|^2 = 1 / ((x - w^2 + d^2)^2 + ..): half of the peak is at x = x_0 -+ 2 d w in x = omega^2, exactly.
    let (d, w) = (0.05f64, 1.0f64);
    let truth = [1.0, -1.0].map(|side| (w * w - d * d + side * 2.0 * d * w).sqrt());
    let truth = (truth[0] - truth[1]) / (2.0 * std::f64::consts::PI);
    assert!(widths.iter().all(|width| (width.to_f64() - truth).abs() < 1e-14), "{widths:?} {truth}");
}

/// An extremum so flat that what is not known of the residues moves it far: the gain is that of where it may be, of all residues that
/// are within what is known, and there it differs by more than at any one frequency.
#[test]
fn gains_of_a_flat_extremum_hold_those_of_all_residues() {
    // Two peaks that all but meet: with 1.056 for 1.057 there is one.
    const DOUBT: f64 = 1e-9;
    let sum = |turn: [f64; 2], doubt: f64| {
        let first = Complex::new(DOUBT * turn[0], DOUBT * turn[1] - 0.5);
        over(&[
            (Complex::new(-0.05, 1.0), first, doubt),
            (Complex::new(-0.05, 1.057), Complex::new(0.0, -0.5 / 1.057), 0.0),
        ])
    };
    let range = (Ball::from(0.9), Ball::from(1.2));
    let found = by_expansion(&sum([0.0; 2], DOUBT * 1.0001), range.0, range.1);
    assert_eq!(found.list.len(), 3, "{found:?}");
    let mut tightest = 0.0f64;
    for turn in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
        let truth = by_expansion(&sum(turn, 0.0), range.0, range.1);
        for extremum in &found.list {
            let near = truth.list.iter().filter(|other| (other.frequency - extremum.frequency).contains_zero());
            let [other] = near.collect::<Vec<_>>()[..] else { panic!("{extremum:?} {truth:?}") };
            let [a, b] = [extremum, other].map(|extremum| extremum.gain.disc().expect("finite"));
            let off = (a.value - b.value).to_f64().abs();
            assert!(off <= a.radius + b.radius, "{off:e} {a:?} {b:?}");
            tightest = tightest.max(off / a.radius);
        }
    }
    assert!(tightest > 0.1, "{tightest}");
}
