//! `--robust`: values whose worst case within the tolerances is the best, compared with closed forms and with |H| written out.

use crate::measures::sources;
use vibc::model::Overrides;
use vibc::{Best, Optimised, Request, Study};

const TURN: f64 = std::f64::consts::TAU;

fn optima(text: &str) -> Vec<Optimised> {
    let (sources, file) = sources(text);
    let study = Study { robust: true, ..Study::default() };
    let outcome = vibc::analyze_with(&sources, file, &Overrides::default(), &Request::default(), &study);
    // The best value may be an end of its range.
    let said = outcome.diagnostics.iter().find(|finding| finding.code.0 != "vib::minimise::end_of_range");
    assert!(said.is_none(), "{text}: {said:?}");
    outcome.answer.expect("a report").optimised
}

fn optimum(text: &str) -> Optimised {
    optima(text).pop().expect("an optimum")
}

fn values(found: &Optimised) -> Vec<f64> {
    found.parameters.iter().map(|parameter| parameter.value.to_f64()).collect()
}

/// The worst case within so much of the truth: what is reached, a bound that holds, and what no values improve, where that is proved.
fn is_worst(found: &Optimised, truth: f64, within: f64) {
    let robust = found.robust.as_ref().expect("a worst case");
    let worst = &robust.worst;
    let reached = worst.reached.to_f64();
    assert!((reached - truth).abs() < within * truth, "{reached} {truth}");
    let (bound, _) = worst.bound.expect("a bound");
    let (best, _) = robust.best_possible.expect("a proof");
    let sign = if found.highest { -1.0 } else { 1.0 };
    // The bound is about the values that were found, which are not quite the best, and the other one about the best.
    assert!(sign * (bound.to_f64() - reached) >= -1e-15 * truth, "{bound:?} {reached}");
    assert!((bound.to_f64() - reached).abs() < within * truth, "{bound:?} {reached}");
    assert!(sign * (truth - best.to_f64()) >= -1e-14 * truth, "{best:?} {truth}");
    let left = sign * (reached - best.to_f64()) - 1e-15 * truth;
    assert!(matches!(found.best, Best::Everywhere { gap, .. } if gap.value() >= left), "{:?} {left}", found.best);
}

/// A block whose spring or mass is not known well, at 10 rad/s: |H| = 1 / |k - 100 m + 5 i|.
fn block(k: &str, m: &str) -> String {
    format!(
        "param k = 100 N/m {k}\nparam m = 0.9 kg {m}\nbody b {{ mass = m, moves x }}\nspring s: ground -- b {{ k = k }}\n\
         damper d: ground -- b {{ c = 0.5 N*s/m }}\nforce F: b along x\noutput x = b.x\n\
         maximise gain(F -> x, 10 rad/s) over m in 0.5 kg .. 2 kg\n"
    )
}

/// The mass that is best for 90 .. 120 N/m is that for the middle, 105 N/m; for 100 N/m it would be 1 kg.
#[test]
fn the_middle_of_a_range_is_the_best() {
    let found = optimum(&block("within 90 N/m .. 120 N/m", ""));
    let gain = |off: f64| 1.0 / f64::hypot(off, 5.0);
    assert!((values(&found)[0] - 1.05).abs() < 1e-7, "{:?}", values(&found));
    is_worst(&found, gain(15.0), 1e-6);
    assert!((found.value.to_f64() - gain(5.0)).abs() < 1e-7 * gain(5.0));
    let robust = found.robust.expect("a worst case");
    assert!((robust.nominal[0].to_f64() - 1.0).abs() < 1e-6 && (robust.nominal_value.to_f64() - 0.2).abs() < 1e-12);
    let nominal = robust.nominal_worst.expect("a worst case");
    assert!((nominal.reached.to_f64() - gain(20.0)).abs() < 1e-6);
    assert!(robust.parameters.len() == 1 && robust.conditions.is_empty() && robust.worst.decays);
}

/// A tolerance of the parameter that is varied moves with it: a range keeps its distances, -0.1 .. +0.3 kg, and a share is one of the new
/// value.
#[test]
fn tolerances_of_varied_parameters_move_with_them() {
    for (clause, best, off, ends) in
        [("within 0.8 kg .. 1.2 kg", 0.9, 20.0, [0.8, 1.2]), ("within 10 %", 1.0, 10.0, [0.9, 1.1])]
    {
        let found = optimum(&block("", clause));
        assert!((values(&found)[0] - best).abs() < 1e-7, "{clause} {:?}", values(&found));
        is_worst(&found, 1.0 / f64::hypot(off, 5.0), 1e-6);
        let range = found.robust.expect("a worst case").parameters[0].ends.each_ref().map(|end| end.to_f64());
        assert!(range.iter().zip(ends).all(|(end, truth)| (end - truth).abs() < 1e-7), "{range:?}");
    }
}

/// The stiffest spring is the best, at worst a tenth softer than it is said to be: 1 / (0.9 * 100 N/m), which no values improve, since at this place
/// within the tolerance the springs are those of 45 .. 90 N/m.
#[test]
fn what_no_values_improve_is_about_ranges_that_move() {
    let found = optimum(
        "param k = 80 N/m within 10 %\nbody b { mass = 1 kg, moves x }\nspring s: ground -- b { k = k }\n\
         damper d: ground -- b { c = 1 N*s/m }\nforce F: b along x = step(1 N, 0 s)\noutput x = b.x\n\
         minimise static(x) over k in 50 N/m .. 100 N/m\n",
    );
    is_worst(&found, 1.0 / 90.0, 1e-6);
    let (best, _) = found.robust.expect("a worst case").best_possible.expect("a proof");
    assert!((best.to_f64() - 1.0 / 90.0).abs() < 1e-8, "{best:?}");
}

/// The softest spring with a frequency above 1.5 Hz for each mass of 0.9 .. 1.2 kg holds the heaviest at 1.5 Hz.
#[test]
fn conditions_are_kept_for_all_values() {
    let found = optimum(
        "param k = 100 N/m\nparam m = 1 kg within 0.9 kg .. 1.2 kg\nbody b { mass = m, moves x }\n\
         spring s: ground -- b { k = k }\nminimise frequency(1) over k in 50 N/m .. 200 N/m while frequency(1) > 1.5 Hz\n",
    );
    let truth = 1.2 * (1.5 * TURN).powi(2);
    let k = values(&found)[0];
    assert!(k > truth && k < truth * (1.0 + 1e-5), "{k} {truth}");
    let robust = found.robust.expect("a worst case");
    let high = f64::sqrt(k / 0.9) / TURN;
    assert!((robust.worst.reached.to_f64() - high).abs() < 1e-12 && robust.worst.bound.is_some());
    assert!(matches!(robust.worst.conditions[..], [vibc::questions::answer::Throughout::Holds(_)]));
}

/// |H|^2 of the machine of mass M under its force, with the absorber of 5 kg.
fn peak(mass: f64, k: f64, c: f64) -> f64 {
    let whole = 100.0 * (TURN * 5.0).powi(2);
    let square = |w: f64| {
        let (re, im) = (k - 5.0 * w * w, w * c);
        let other = whole + k - mass * w * w;
        let bottom = [other * re - im * im - (k * k - im * im), other * im + im * re - 2.0 * k * im];
        f64::hypot(re, im) / f64::hypot(bottom[0], bottom[1])
    };
    let at = |i: usize| 20.0 + 0.005 * i as f64;
    (0..5000).map(|i| square(at(i))).fold(0.0, f64::max)
}

/// An absorber for machines of 95 .. 105 kg: no values around those found have a lower worst case on a grid of masses and frequencies, and
/// what is proved to be the best possible lies below all.
#[test]
fn an_absorber_for_a_series_of_machines() {
    let found = optimum(
        "param M = 100 kg within 5 %\nparam k = 4.5 kN/m\nparam c = 40 N*s/m\nlet K = 100 kg * (2 * pi * 5 Hz)^2\n\
         body machine { mass = M, moves x }\nbody absorber { mass = 5 kg, moves x }\nspring mount: ground -- machine { k = K }\n\
         spring leaf: machine -- absorber { k = k }\ndamper oil: machine -- absorber { c = c }\nforce F: machine along x\n\
         output x = machine.x\nminimise peak_gain(F -> x) over c in 20 N*s/m .. 80 N*s/m, k in 4 kN/m .. 5 kN/m\n",
    );
    let [c, k] = values(&found)[..] else { panic!("two values") };
    let worst =
        |k: f64, c: f64| [95.0, 97.0, 100.0, 103.0, 105.0].map(|mass| peak(mass, k, c)).into_iter().fold(0.0, f64::max);
    let here = worst(k, c);
    let robust = found.robust.as_ref().expect("a worst case");
    let (bound, _) = robust.worst.bound.expect("a bound");
    let (best, _) = robust.best_possible.expect("a proof");
    // The grid of frequencies misses some 1e-6 of a peak.
    assert!((robust.worst.reached.to_f64() / here - 1.0).abs() < 1e-5);
    assert!(bound.to_f64() >= here && bound.to_f64() < 1.00001 * here, "{bound:?} {here}");
    for (dk, dc) in [
        (-2e-3, 0.0),
        (2e-3, 0.0),
        (0.0, -2e-2),
        (0.0, 2e-2),
        (1e-3, 2e-2),
        (-1e-3, -2e-2),
        (2e-3, -2e-2),
        (-2e-3, 2e-2),
    ] {
        let there = worst(k * (1.0 + dk), c * (1.0 + dc));
        assert!(there > here * (1.0 - 2e-6) && there > best.to_f64(), "{dk} {dc}: {there} {here}");
    }
    let [a, b] = [0, 1].map(|i| robust.nominal[i].to_f64());
    assert!(worst(b, a) > 1.02 * here && best.to_f64() < here && best.to_f64() > 0.8 * here);
}

/// Lines after each other, and a `solve` beside them: the second line is about the mass that the first has found.
#[test]
fn lines_follow_each_other() {
    let text = format!(
        "{}param n = 80 N/m\nbody z {{ mass = m, moves x }}\nspring h: ground -- z {{ k = n }}\ndamper g: ground -- z {{ c = 1 N*s/m }}\n\
         force G: z along x\noutput u = z.x\nparam q = 1 N/m\nbody y {{ mass = 1 kg, moves x }}\nspring l: ground -- y {{ k = q }}\n\
         solve q in 1 N/m .. 100 N/m: frequency(1) = 0.5 Hz\nmaximise gain(G -> u, 10 rad/s) over n in 50 N/m .. 200 N/m\n",
        block("within 90 N/m .. 120 N/m", "")
    );
    let found = optima(&text);
    assert!((values(&found[0])[0] - 1.05).abs() < 1e-6, "{:?}", values(&found[0]));
    assert!((values(&found[1])[0] - 105.0).abs() < 1e-4, "{:?}", values(&found[1]));
    is_worst(&found[1], 0.1, 1e-9);
}

/// A block whose spring is 100 N/m + (p - 0.3)^2 1000 N/m for p in 0 .. 1, softest where neither the middle nor a corner is.
fn valley(line: &str) -> String {
    format!(
        "param p = 0.5 within 0 .. 1\nparam m = 0.6 kg\nbody b {{ mass = m, moves x }}\n\
         spring s: ground -- b {{ k = 100 N/m + (p - 0.3)^2 * 1 kN/m }}\ndamper d: ground -- b {{ c = 0.5 N*s/m }}\n\
         force F: b along x\noutput x = b.x\n{line}\n"
    )
}

/// At 10 rad/s the mass that is best for 100 .. 590 N/m is that for the middle, 345 N/m; the places that are looked at first have 140 .. 590 N/m.
#[test]
fn the_worst_between_the_corners_is_not_overlooked() {
    let found = optimum(&valley("maximise gain(F -> x, 10 rad/s) over m in 0.5 kg .. 6 kg"));
    assert!((values(&found)[0] - 3.45).abs() < 1e-3, "{:?}", values(&found));
    is_worst(&found, 1.0 / f64::hypot(245.0, 5.0), 1e-3);
    let low = optimum(&valley("minimise gain(F -> x, 10 rad/s) over m in 0.5 kg .. 0.8 kg"));
    assert!((values(&low)[0] - 0.5).abs() < 1e-12, "{:?}", values(&low));
    is_worst(&low, 1.0 / f64::hypot(50.0, 5.0), 1e-5);
    let robust = low.robust.as_ref().expect("a worst case");
    assert!((robust.worst.at[0].to_f64() - 0.3).abs() < 1e-2, "{:?}", robust.worst.at);
    // What is reached is a little less than the worst, and the bound holds for that.
    let (bound, truth) = (robust.worst.bound.expect("a bound").0.to_f64(), 1.0 / f64::hypot(50.0, 5.0));
    assert!(robust.worst.reached.to_f64() < truth && bound >= truth * (1.0 - 1e-15), "{bound} {truth}");
    let least = robust.best_possible.expect("a proof").0.to_f64();
    assert!(matches!(low.best, Best::Everywhere { gap, .. } if gap.value() >= truth - least), "{:?} {least}", low.best);
}

/// A condition that fails at p = 0.3 alone, for masses above 100 N/m / (3 pi / s)^2: all places that are looked at first keep it.
#[test]
fn conditions_are_kept_between_the_corners() {
    let found = optimum(&valley("minimise frequency(1) over m in 0.5 kg .. 2 kg while frequency(1) > 1.5 Hz"));
    let truth = 100.0 / (1.5 * TURN).powi(2);
    let m = values(&found)[0];
    assert!(m <= truth * (1.0 + 1e-12) && m > truth * (1.0 - 1e-3), "{m} {truth}");
    let robust = found.robust.expect("a worst case");
    assert!((robust.worst.reached.to_f64() - f64::sqrt(590.0 / m) / TURN).abs() < 1e-9, "{:?}", robust.worst);
    assert!(!matches!(robust.worst.conditions[..], [vibc::questions::answer::Throughout::FailsAt(_)]));
}

/// The peak of a step response, F / k (1 + exp(-pi zeta / sqrt(1 - zeta^2))), is not enclosed over ranges: what is reached is told, and
/// nothing that is proved.
#[test]
fn what_is_not_enclosed_is_reached_alone() {
    let found = optimum(
        "param k = 100 N/m within 90 N/m .. 110 N/m\nparam c = 4 N*s/m\nbody b { mass = 1 kg, moves x }\n\
         spring s: ground -- b { k = k }\ndamper d: ground -- b { c = c }\nforce F: b along x = step(1 N, 0 s)\noutput x = b.x\n\
         minimise peak(x) over c in 2 N*s/m .. 6 N*s/m\n",
    );
    let zeta = 3.0 / f64::sqrt(90.0);
    let truth = (1.0 + f64::exp(-0.5 * TURN * zeta / f64::sqrt(1.0 - zeta * zeta))) / 90.0;
    let robust = found.robust.as_ref().expect("a worst case");
    assert!((values(&found)[0] - 6.0).abs() < 1e-6, "{:?}", values(&found));
    assert!((robust.worst.reached.to_f64() / truth - 1.0).abs() < 1e-6, "{:?} {truth}", robust.worst);
    assert!(robust.worst.bound.is_none() && robust.best_possible.is_none() && matches!(found.best, Best::Seen));
}

/// |H| has a value where a motion grows, too: with a damper of 10 (p - 0.3)^2 - 0.05 N s/m that is so about p = 0.3, where nothing else shows
/// it. With + 0.05 N s/m it is proved that nothing grows. The worst is |H| for p = 1, at 100 N/m.
#[test]
fn a_motion_that_may_grow_is_told() {
    for (more, largest, decays) in [("- 0.05", 4.85, false), ("+ 0.05", 4.95, true)] {
        let found = optimum(&format!(
            "param p = 0.5 within 0 .. 1\nparam k = 90 N/m\nbody b {{ mass = 1 kg, moves x }}\nspring s: ground -- b {{ k = k }}\n\
             damper d: ground -- b {{ c = (10 * (p - 0.3)^2 {more}) * 1 N*s/m }}\nforce F: b along x\noutput x = b.x\n\
             maximise gain(F -> x, 10 rad/s) over k in 50 N/m .. 195 N/m\n"
        ));
        let worst = &found.robust.as_ref().expect("a worst case").worst;
        assert_eq!(worst.decays, decays, "{more}");
        assert!((worst.reached.to_f64() * 10.0 * largest - 1.0).abs() < 1e-6, "{worst:?}");
        // Where the matrix may be singular at 10 rad/s, |H| has no bound.
        if decays {
            is_worst(&found, 0.1 / largest, 1e-6);
        }
    }
}

/// Where `solve` is repeated at each trial, what is reached has a bound, and nothing is said about other values: the spring t is that for which
/// b, without the spring s, would have 1 Hz.
#[test]
fn nothing_is_claimed_of_other_values_where_solve_is_repeated() {
    let found = optimum(&format!(
        "{}param t = 40 N/m\nbody q {{ mass = m, moves x }}\nspring u: ground -- q {{ k = t }}\n\
         solve t in 1 N/m .. 100 N/m: frequency(1) = 0.5 Hz\n",
        block("within 90 N/m .. 120 N/m", "")
    ));
    let robust = found.robust.as_ref().expect("a worst case");
    assert!((values(&found)[0] - 1.05).abs() < 1e-4, "{:?}", values(&found));
    assert!(robust.worst.bound.is_some() && robust.best_possible.is_none() && matches!(found.best, Best::Seen));
}
