//! Sums over poles from modes against exact arithmetic, and from a basis that is not one of modes.

use super::*;
use crate::analysis::damping;
use crate::analysis::modes::form::{ModalForm, gram, kinds, shapes};
use crate::analysis::modes::modes;
use crate::analysis::test_systems::{blank, push};
use crate::analysis::transfer::extrema::{Denominator, Exactly, FeatureKind, by_expansion};
use crate::analysis::transfer::{Frequency, Gain, Transfer};
use crate::base::{Name, Number, Rational, Words};
use crate::kernel::dense::Matrix;
use crate::kernel::squares::Squares;
use crate::system::{CoordinateId, Form, Label, LinearSystem, Nature};

/// What is different about a row of masses with springs, some of them to the next but one.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Row {
    Held,
    Free,
    /// Nothing joins the two halves, so there are two rigid motions.
    Parted,
    /// A spring with negative stiffness at the end: a divergence.
    Unstable,
    /// Dampers in proportion to the springs; with the larger factor all modes are overdamped.
    Damped(&'static str),
    /// The same, and nothing holds it.
    Floating(&'static str),
}

impl Row {
    fn is_damped(self) -> bool {
        matches!(self, Row::Damped(_) | Row::Floating(_))
    }
}

/// The first input is a force, the second the motion of a base; outputs are the last displacement, its velocity, and its
/// acceleration relative to what the base does.
fn row(n: usize, what: Row) -> LinearSystem {
    let mut system = blank(n);
    let is_held = |i: usize| i > 0 || !matches!(what, Row::Free | Row::Parted | Row::Floating(_));
    let joins = |i: usize, j: usize| what != Row::Parted || (i < n / 2) == (j < n / 2);
    let mut springs: Vec<(&str, usize, Option<usize>)> = Vec::new();
    for i in 0..n {
        push(&mut system.m, ["1.2", "1.7", "1.1", "1.9"][i % 4], i, None);
        let before = i.checked_sub(1);
        if is_held(i) && before.is_none_or(|j| joins(i, j)) {
            springs.push((["2.3", "1.4", "2.9"][i % 3], i, before));
        }
        if i > 1 && i % 2 == 0 && joins(i, i - 2) {
            springs.push(("0.8", i, Some(i - 2)));
        }
    }
    if what == Row::Unstable {
        springs.push(("-1.5", n - 1, None));
    }
    for (k, i, j) in springs {
        let k = k.strip_prefix('-').map_or_else(|| Number::from(k), |size| -&Number::from(size));
        if let Row::Damped(factor) | Row::Floating(factor) = what {
            add(&mut system.c, &k * &Number::from(factor), i, j);
        }
        add(&mut system.k, k, i, j);
    }
    let at = |i: usize, x: &str| vec![(CoordinateId(i as u32), Number::from(x))];
    system.inputs.truncate(2);
    system.inputs[1].b = [at(0, "2.3"), Vec::new(), at(0, "0.3")];
    let displacement = system.outputs[n - 1].clone();
    system.outputs = vec![displacement; 3];
    system.outputs[1].p.swap(0, 1);
    system.outputs[2].p.swap(0, 2);
    system.outputs[2].d[2] = vec![(1, -&Number::ONE)];
    system
}

/// Adds weight (x_i - x_j)^2 to a form, or weight x_i^2.
fn add(form: &mut Form, weight: Number, i: usize, j: Option<usize>) {
    let source = form.source(Label { name: Name::plain(Words::new().intern("")), motion: "" });
    let ends = [(i, Number::ONE)].into_iter().chain(j.map(|j| (j, -&Number::ONE)));
    form.push(source, Nature::Property, weight, ends.map(|(i, a)| (CoordinateId(i as u32), a)));
}

const ROWS: [(usize, Row); 12] = [
    (2, Row::Held),
    (5, Row::Held),
    (6, Row::Held),
    (2, Row::Free),
    (5, Row::Free),
    (6, Row::Parted),
    (4, Row::Unstable),
    (5, Row::Damped("0.0625")),
    (4, Row::Damped("8")),
    (2, Row::Floating("0.0625")),
    (5, Row::Floating("0.03125")),
    (4, Row::Floating("8")),
];

fn sum_of(system: &LinearSystem) -> ModalSum {
    ModalSum::of(system, &modes(system).expect("modes")).expect("modes diagonalise the damping")
}

/// Zeros and poles in exact arithmetic know nothing of modes: the same extrema, gains and widths, one to one.
#[test]
fn extrema_are_those_of_exact_arithmetic() {
    let (low, high) = (Ball::from(1e-2), Ball::from(20.0));
    let (mut infinite, mut zeros, mut others) = (0, 0, 0);
    for (n, what) in ROWS {
        let system = row(n, what);
        let sum = sum_of(&system);
        let coordinates: Vec<u32> = (0..n as u32).collect();
        let denominator = Denominator::of(&system, &coordinates).expect("rational");
        for (input, output) in [(0, 0), (0, 1), (0, 2), (1, 0), (1, 2)] {
            let which = format!("{n} {what:?} {input} {output}");
            let fractions = sum.fractions(&sum.pair(&system, input, output));
            // Nothing of one half reaches the other.
            let Some(fractions) = fractions else {
                assert_eq!(what, Row::Parted, "{which}");
                continue;
            };
            let truth = Exactly::of(&denominator.pair(&system, input, output).expect("roots")).expect("in range");
            let (truth, found) = (truth.extrema(low, high), by_expansion(&fractions, low, high));
            assert!(truth.is_complete() && found.is_complete(), "{which}: {:?}", found.open);
            assert_eq!(found.list.len(), truth.list.len(), "{which}: {found:?} {truth:?}");
            for (found, truth) in found.list.iter().zip(&truth.list) {
                let agree = |a: Ball, b: Ball| (a - b).contains_zero() && a.relative_error() < 1e-18;
                assert_eq!(found.kind, truth.kind, "{which}");
                assert!(agree(found.frequency, truth.frequency), "{which}: {found:?} {truth:?}");
                match (found.gain, truth.gain) {
                    (Gain::Infinite, Gain::Infinite) => infinite += 1,
                    (Gain::Finite(a), Gain::Finite(b)) => {
                        assert!((a.value - b.value).to_f64().abs() <= a.radius + b.radius, "{which}: {a:?} {b:?}");
                        // With damping H is complex, and that it is zero where the base's own factor is remains open.
                        let is_open = what.is_damped() && b.radius == 0.0;
                        assert!(a.relative_error() < 1e-18 || is_open, "{which}: {a:?}");
                        assert!(is_open || (a.radius == 0.0) == (b.radius == 0.0), "{which}: {a:?} {b:?}");
                        if a.radius == 0.0 { zeros += 1 } else { others += 1 }
                    }
                    gains => panic!("{which}: {gains:?}"),
                }
                let widths = found.width.zip(truth.width);
                assert_eq!(found.width.is_some(), truth.width.is_some(), "{which}: {found:?} {truth:?}");
                assert!(widths.is_none_or(|(a, b)| agree(a, b)), "{which}: {found:?} {truth:?}");
            }
        }
    }
    assert!(infinite > 40 && zeros > 20 && others > 30, "{infinite} {zeros} {others}");
}

/// Shapes spoiled by 1e-10, and not refined: what X^T M X, X^T K X and X^T C X are beside their diagonals is in the bounds of
/// the poles and of H.
#[test]
fn what_the_basis_lacks_is_in_the_bounds() {
    for (n, what) in ROWS.into_iter().filter(|(_, what)| *what != Row::Parted) {
        let system = row(n, what);
        let modes = modes(&system).expect("modes");
        let spoiled = shapes(&modes.list);
        // Of rigid motions X^T C X is not small beside what else they are damped by, which is nothing.
        let scale = if matches!(what, Row::Floating(_)) { 1e-4 } else { 1.0 };
        let spoiled = Matrix::from_fn(n, n, |i, j| {
            let by = scale * [3e-11, -1e-10, 7e-11, -5e-11, 9e-11][(3 * i + 7 * j) % 5];
            spoiled[(i, j)] + Dd::from(by)
        });
        let of = |form| gram(&Squares::of_form(form), &spoiled);
        let form = ModalForm { m: of(&system.m), k: of(&system.k), shapes: spoiled.clone() };
        let sum = ModalSum::of_form(form, &of(&system.c), &kinds(&modes.list));
        let mut sum = sum.unwrap_or_else(|| panic!("{n} {what:?}"));
        sum.is_undragged = true;
        let transfer = Transfer::of(&system);
        let precise = sum_of(&system);
        for (input, output) in [(0, 0), (1, 2)] {
            let pair = sum.pair(&system, input, output);
            let known = |sum: &ModalSum, pair: &ModalPair| {
                // With damping the modes' errors are in the rest alone.
                let (list, free) = if what.is_damped() {
                    (Vec::new(), sum.of_damped(pair).expect("undragged").1)
                } else {
                    sum.of_true_modes(pair, None).expect("apart")
                };
                let products = list.iter().flat_map(|given| given.products).flat_map(|z| [z.re, z.im]);
                products.chain(free).collect::<Vec<Ball>>()
            };
            let precisely = known(&precise, &precise.pair(&system, input, output));
            for (a, b) in known(&sum, &pair).into_iter().zip(precisely) {
                assert!((a - b).contains_zero() && (b.is_zero() || b.rad < 1e-24), "{n} {what:?}: {a:?} {b:?}");
            }
            let fractions = sum.fractions(&pair).unwrap_or_else(|| panic!("{n} {what:?}"));
            let mut most = 0.0f64;
            for step in 1..60 {
                let frequency = Frequency::radians(&Number::from(Rational::new(step * 7, 100)));
                let found = fractions.gain(&frequency).disc().expect("no pole is near");
                let truth = transfer.between(&frequency, &[input], &[output])[0][0].disc().expect("finite");
                let off = (found.value - truth.value).to_f64().abs();
                assert!(off <= found.radius + truth.radius, "{n} {what:?} {step}: {off:e} {:e}", found.radius);
                most = most.max(off);
            }
            assert!(most > 1e-13 * scale, "{n} {what:?}: {most:e}");
            let peaks = by_expansion(&fractions, Ball::from(0.1), Ball::from(4.0)).list.into_iter();
            for peak in peaks.filter(|extremum| extremum.gain == Gain::Infinite) {
                assert_eq!(peak.kind, FeatureKind::Peak);
                let omega = peak.frequency * Ball::PI * Ball::from(2.0);
                let apart = |mode: &&crate::analysis::Mode| !(mode.omega - omega).contains_zero();
                assert!(modes.list.iter().filter(|mode| !apart(mode)).count() == 1 && omega.rad > 1e-15, "{omega:?}");
            }
        }
    }
}

/// Two masses of 1 kg with frequencies of 1 and 2 rad/s, or free with one of 1 rad/s: the C of one damping ratio for all modes is
/// rational, so that exact arithmetic knows all extrema, zeros and poles. However far above one the ratio is, they are known to
/// the last digit.
#[test]
fn a_ratio_far_above_one_is_exact() {
    for (held, between, sum_of_rates) in [("1", "1.5", "2"), ("0", "0.5", "0")] {
        for ratio in ["1.25", "3", "1000000000", "1000000000000000"] {
            let ratio = Number::from(ratio);
            let mut system = blank(2);
            for i in 0..2 {
                push(&mut system.m, "1", i, None);
                add(&mut system.k, Number::from(held), i, None);
            }
            push(&mut system.k, between, 1, Some(0));
            let mut written = system.clone();
            for i in 0..2 {
                add(&mut written.c, &ratio * &Number::from(sum_of_rates), i, None);
            }
            add(&mut written.c, ratio.clone(), 1, Some(0));
            let mut modes = modes(&system).expect("modes");
            damping::modal(&mut system, &ratio, &mut modes).expect("known modes");
            let sum = ModalSum::of(&system, &modes).expect("diagonal");
            let denominator = Denominator::of(&written, &[0, 1]).expect("rational");
            for output in [0, 1] {
                let which = format!("{held} {ratio:?} {output}");
                let fractions = sum.fractions(&sum.pair(&system, 0, output)).expect("real poles");
                let truth = Exactly::of(&denominator.pair(&written, 0, output).expect("roots")).expect("in range");
                let (low, high) = (Ball::from(0.01) / ratio.to_ball(), Ball::from(100.0) * ratio.to_ball());
                let (found, all) = (by_expansion(&fractions, low, high), truth.extrema(low, high));
                assert!(found.is_complete() && all.is_complete(), "{which} {:?}", found.open.first());
                assert_eq!(found.list.len(), all.list.len(), "{which}");
                // Beyond the range the terms of the sum cancel.
                let inside = |f: &Frequency| !(f.omega - low).is_negative() && !(high - f.omega).is_negative();
                let places = ["1e-16", "1e-12", "0.01", "0.2", "7", "1e6", "1e14"]
                    .map(|hertz| Frequency::hertz(&Number::from(hertz)));
                for frequency in places.iter().filter(|place| inside(place)) {
                    let found = fractions.gain(frequency).disc().expect("no pole is near");
                    let truth = truth.gain(frequency).disc().expect("finite");
                    let off = (found.value - truth.value).to_f64().abs();
                    assert!(off <= found.radius + truth.radius, "{which} {frequency:?}: {off:e} {:e}", found.radius);
                    assert!(found.relative_error() < 1e-20, "{which} {frequency:?}: {:e}", found.relative_error());
                }
            }
        }
    }
}

/// Two equal masses under equal forces: the second mode is not excited, which rounding does not show. Whether there is a pole
/// remains open, in a narrow range about it, and nowhere else.
#[test]
fn a_pole_that_may_not_be_excited_is_open_in_its_neighbourhood_alone() {
    let mut system = blank(2);
    for i in 0..2 {
        push(&mut system.m, "0.7", i, None);
        push(&mut system.k, "1.3", i, None);
    }
    push(&mut system.k, "0.45", 1, Some(0));
    system.inputs[0].b[0] = (0..2).map(|i| (CoordinateId(i), Number::from("0.1"))).collect();
    let sum = sum_of(&system);
    let Some(fractions) = sum.fractions(&sum.pair(&system, 0, 0)) else { panic!("two modes") };
    let found = by_expansion(&fractions, Ball::from(0.1), Ball::from(10.0));
    let two_pi = 2.0 * std::f64::consts::PI;
    let [first, second] = [1.3f64 / 0.7, 2.2 / 0.7].map(|square| square.sqrt() / two_pi);
    assert_eq!(found.list.len(), 1, "{found:?}");
    assert!(found.list[0].gain == Gain::Infinite && (found.list[0].frequency.to_f64() - first).abs() < 1e-12);
    let [(low, high)] = found.open[..] else { panic!("{:?}", found.open) };
    assert!(low < second && second < high && high - low < 1e-7, "{low} {high}");
}

/// Two equal frequencies have no shapes of their own, and a mode without damping beside one with it no bound on the axis.
#[test]
fn what_is_not_covered_is_refused() {
    let mut system = blank(2);
    for i in 0..2 {
        push(&mut system.m, "1", i, None);
        push(&mut system.k, "3", i, None);
    }
    let sum = sum_of(&system);
    assert!(sum.fractions(&sum.pair(&system, 0, 0)).is_none());
    push(&mut system.k, "1", 1, Some(0));
    let sum = sum_of(&system);
    assert!(sum.fractions(&sum.pair(&system, 0, 0)).is_some());
    push(&mut system.c, "0.1", 1, Some(0));
    let sum = sum_of(&system);
    assert!(sum.fractions(&sum.pair(&system, 0, 0)).is_none());
    // A rigid motion that is damped, as the others are, is not one of those that are summed by themselves.
    for held in ["0", "0.1"] {
        let mut system = blank(2);
        for i in 0..2 {
            push(&mut system.m, "1", i, None);
            push(&mut system.c, held, i, None);
        }
        push(&mut system.k, "1", 1, Some(0));
        push(&mut system.c, "0.1", 1, Some(0));
        let sum = sum_of(&system);
        assert_eq!(sum.fractions(&sum.pair(&system, 0, 0)).is_some(), held == "0");
    }
}

/// i^k for the powers k of s: real, imaginary, or both.
#[test]
fn without_damping_h_is_real_or_imaginary_by_its_powers_of_s() {
    for powers in 0..32u32 {
        for through in 0..8u32 {
            let of = |bits: u32| (0..5).filter(move |power| bits >> power & 1 == 1);
            let residues = |power: u32| Residues {
                power: power as usize,
                products: Vec::new(),
                rounded: Vec::new(),
                p_square: Vec::new(),
                b_square: Vec::new(),
                slack: Vec::new(),
                exact_slack: Vec::new(),
            };
            let feed_through =
                std::array::from_fn(|power| if through >> power & 1 == 1 { Ball::ONE } else { Ball::ZERO });
            let pair = ModalPair { residues: of(powers).map(residues).collect(), feed_through };
            let all = powers | through;
            let expected = match (all & 0b10101 != 0, all & 0b01010 != 0) {
                (_, false) => Part::Real,
                (false, true) => Part::Imaginary,
                (true, true) => Part::Both,
            };
            assert_eq!(part(&pair), expected, "{powers:b} {through:b}");
        }
    }
}
