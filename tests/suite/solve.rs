//! `solve` and `require`: roots compared with closed forms, reports if there is no root or several, valid bounds,
//! several unknowns, and the use of the results in the rest of a run.

use crate::measures::sources;
use vibc::answers::ModalAnswer;
use vibc::backend::{ReportOptions, json};
use vibc::base::{Diagnostic, Number};
use vibc::model::Overrides;
use vibc::questions::answer::Solved;
use vibc::{Failure, Outcome};

const BLOCK: &str = "param k = 10 N/m\nparam m = 1 kg\nparam c = 0.5 N*s/m\nbody block { mass = m, moves x }\n\
                     spring s: ground -- block { k = k }\ndamper d: ground -- block { c = c }\n\
                     force F: block along x = harmonic(1 N, 1 Hz)\noutput x = block.x\n";

fn run(lines: &str) -> Outcome<ModalAnswer> {
    let (sources, file) = sources(&format!("{BLOCK}{lines}"));
    vibc::analyze(&sources, file, &Overrides::default())
}

fn solved(lines: &str) -> Vec<Solved> {
    let outcome = run(lines);
    assert!(outcome.diagnostics.is_empty(), "{lines}: {:?}", outcome.diagnostics);
    outcome.answer.expect("a report").solved
}

fn refused(lines: &str) -> Diagnostic {
    let outcome = run(lines);
    assert!(outcome.answer.is_none(), "{lines}");
    assert_eq!(outcome.failure(), Some(Failure::Model));
    let [finding] = &outcome.diagnostics[..] else { panic!("{lines}: {:?}", outcome.diagnostics) };
    finding.clone()
}

/// Asserts that the value is within its reported bound, and that this is narrow.
fn is(solved: &Solved, truth: f64, width: f64) {
    let off = (solved.value.to_f64() - truth).abs();
    assert!(
        off <= solved.bound.expect("proven") + 4e-16 * truth.abs(),
        "{} = {} is not {truth}",
        solved.parameter,
        solved.value.to_f64()
    );
    assert!(solved.bound.expect("proven") <= width * truth.abs(), "{}: bound {:?}", solved.parameter, solved.bound);
}

const TURN: f64 = std::f64::consts::TAU;

#[test]
fn each_measure_is_solved_for() {
    let w = TURN;
    // 1/|k - w^2 + i w c| = 0.1, c = 0.5: k = w^2 +- sqrt(100 - (w c)^2).
    let root = (100.0 - (0.5 * w).powi(2)).sqrt();
    let cases = [
        ("solve k in 1 N/m .. 1000 N/m: frequency(1) = 2 Hz", (2.0 * w).powi(2), 1e-25),
        ("solve k in 1 N/m .. 1000 N/m: frequency(1) = 3 rad/s", 9.0, 1e-25),
        ("solve c in 0.1 N*s/m .. 5 N*s/m: damping(1) = 5 %", 0.1 * 10f64.sqrt(), 1e-25),
        ("solve k in 40 N/m .. 100 N/m: gain(F -> x, 1 Hz) = 0.1 m/N", w * w + root, 1e-20),
        ("solve k in 1 N/m .. 39 N/m: amplitude(x) = 0.1 m", w * w - root, 1e-20),
        ("solve k in 1 N/m .. 100 N/m: phase(F -> x, 1 Hz) = -90 deg", w * w, 1e-20),
        ("solve m in 0.1 kg .. 10 kg: gain(F -> block.ax, 100 Hz) = 0.5 m/s^2/N", 2.0, 1.0),
    ];
    for (line, truth, width) in cases {
        let found = solved(line);
        if width < 1.0 {
            is(&found[0], truth, width);
        } else {
            assert!((found[0].value.to_f64() - truth).abs() < 0.01 * truth);
        }
    }
}

/// The residual is the error of the measure at the reported number, and the slope relates it to the distance from the
/// root.
#[test]
fn residual_and_slope_are_those_of_the_measure() {
    let found = &solved("solve k in 1 N/m .. 1000 N/m: frequency(1) = 2 Hz")[0];
    assert!(found.residual.magnitude() < 1e-24);
    let slope = found.slope.expect("smooth");
    // df/dk = f / 2k, and relative to both 1/2.
    let expected = 2.0 / (2.0 * (2.0 * TURN).powi(2));
    assert!((slope.to_f64() - expected).abs() < 1e-15 * expected, "{slope:?} {expected}");
    assert!((found.relative_slope().expect("finite").to_f64() - 0.5).abs() < 1e-15);
}

#[test]
fn a_root_that_is_a_short_decimal_comes_out_as_it() {
    let found = &solved("solve k in 1 N/m .. 1000 N/m: frequency(1) = 3 rad/s")[0];
    assert_eq!(found.value, Number::from(9));
}

#[test]
fn several_unknowns_are_solved_together() {
    // Each measure depends on both: w^2 = k/m = 16, zeta = c / (2 sqrt(k m)) = 0.1, 1/k = 0.02.
    let found = solved(
        "solve m in 0.1 kg .. 20 kg: frequency(1) = 4 rad/s\nsolve c in 0.01 N*s/m .. 50 N*s/m: damping(1) = 10 %\n\
         solve k in 1 N/m .. 500 N/m: gain(F -> x, 0 Hz) = 0.02 m/N",
    );
    is(&found[0], 50.0 / 16.0, 1e-20);
    is(&found[1], 0.2 * (50.0f64 * 50.0 / 16.0).sqrt(), 1e-20);
    is(&found[2], 50.0, 1e-20);
    // Two coupled unknowns: k/m = 16 and |k - m w^2 + i w c| = 10 at 1 Hz, with k the smaller.
    let found = solved(
        "solve k in 1 N/m .. 60 N/m: frequency(1) = 4 rad/s\nsolve m in 0.1 kg .. 3 kg: gain(F -> x, 1 Hz) = 0.1 m/N",
    );
    let w2 = TURN * TURN;
    let m = (100.0 - 0.25 * w2).sqrt() / (w2 - 16.0);
    is(&found[0], 16.0 * m, 1e-20);
    is(&found[1], m, 1e-20);
}

#[test]
fn evaluated_range_is_reported_if_there_is_no_root() {
    let finding = refused("solve k in 5 N/m .. 20 N/m: frequency(1) = 5 Hz");
    assert_eq!(finding.code.0, "vib::solve::no_root");
    // sqrt(5)/2pi and sqrt(20)/2pi
    assert!(finding.primary.text.contains("0.355881 Hz at k = 5 N/m"), "{}", finding.primary.text);
    assert!(finding.primary.text.contains("0.711763 Hz at k = 20 N/m"), "{}", finding.primary.text);
    let finding = refused("solve c in 0 .. 4 N*s/m: frequency(1) = 5 Hz");
    assert_eq!(finding.code.0, "vib::solve::independent");
    // Without damping the phase jumps by half a turn and is never a quarter.
    let finding = refused("solve k in 1 N/m .. 100 N/m: phase(F -> x, 1 Hz) = 90 deg");
    assert_eq!(finding.code.0, "vib::solve::no_root");
}

/// Both sides of a resonance that lies between two of the first evaluations are found.
#[test]
fn several_roots_are_all_seen() {
    let finding = refused("solve k in 1 N/m .. 100000 N/m: gain(F -> x, 1 Hz) = 0.31 m/N");
    assert_eq!(finding.code.0, "vib::solve::several_roots");
    assert!(finding.primary.text.contains(" and "), "{}", finding.primary.text);
}

#[test]
fn conditions_that_decide_nothing_are_reported() {
    let twice =
        "solve k in 1 N/m .. 60 N/m: frequency(1) = 4 rad/s\nsolve k in 1 N/m .. 50 N/m: frequency(1) = 3 rad/s";
    assert_eq!(refused(twice).code.0, "vib::solve::twice");
    // Both depend only on k/m.
    let same = "solve k in 1 N/m .. 60 N/m: frequency(1) = 4 rad/s\nsolve m in 0.1 kg .. 3 kg: frequency(1) = 4 rad/s";
    assert_eq!(refused(same).code.0, "vib::solve::singular");
}

/// Analysis, transfer, simulation, emitted code and the check all use the model with the value that was found.
#[test]
fn every_answer_uses_the_solution() {
    let text = format!("{BLOCK}solve k in 1 N/m .. 1000 N/m: frequency(1) = 2 Hz\nrequire frequency(1) > 1.9 Hz\n");
    let (sources, file) = sources(&text);
    let none = Overrides::default();
    let report = vibc::analyze(&sources, file, &none).answer.expect("a report");
    let stiffness = (2.0 * TURN).powi(2);
    let near = |value: f64, truth: f64| assert!((value / truth - 1.0).abs() < 1e-14, "{value} {truth}");
    near(report.system.k.entries(1)[0][0].to_f64(), stiffness);
    near(vibc::dynamics(&sources, file, &none).answer.expect("poles").system.k.entries(1)[0][0].to_f64(), stiffness);
    let motion = vibc::simulate(&sources, file, &none, &[Number::ZERO, Number::ONE]).answer.expect("a motion");
    near(motion.system.k.entries(1)[0][0].to_f64(), stiffness);
    let stand = vibc::check(&sources, file, &none, None).answer.expect("requirements");
    assert_eq!(stand[0].holds, Some(true));
    let text = json::json(&report, &ReportOptions::default());
    assert!(text.contains("\"solved\":[{\"parameter\":\"k\",\"value\":157.9"), "{text}");
    assert!(text.contains("\"requirements\":[{\"text\":\"frequency(1) > 1.9 Hz\",\"holds\":true,\"value\":2.0,\"limit\":1.9,\"margin\":0.05"), "{text}");
}

/// A limit closer to the value than binary64 can show is decided; one within the bound is not.
#[test]
fn requirements_are_decided_as_far_as_the_bound_goes() {
    let stand = |line: &str| run(line).answer.expect("a report").requirements[0].holds;
    // sqrt(10) = 3.16227766016837933199889354443...
    assert_eq!(stand("require frequency(1) > 3.1622776601683793319988935 rad/s"), Some(true));
    assert_eq!(stand("require frequency(1) > 3.1622776601683793319988936 rad/s"), Some(false));
    assert_eq!(stand("require frequency(1) <= sqrt(k/m) * 1 rad"), None);
    assert_eq!(run("require frequency(1) <= sqrt(k/m) * 1 rad").failure(), Some(Failure::Limit));
    assert_eq!(run("require frequency(1) > 4 rad/s").failure(), Some(Failure::Model));
    assert_eq!(run("require frequency(1) < 4 rad/s").failure(), None);
}

/// The named parameter has the largest effect on the measure, and the advised value satisfies the requirement.
#[test]
fn advice_would_do() {
    let outcome = run("require frequency(1) > 1 Hz");
    let help = outcome.diagnostics[0].help.clone().expect("advice");
    assert!(help.starts_with("`k` changes it most: by 0.5 %"), "{help}");
    let wanted = help.split("with k = ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a value");
    // (2 pi)^2 = 39.478: three digits, rounded to the side that satisfies the requirement.
    let wanted = wanted.parse::<f64>().expect("a number");
    assert!(wanted > 39.478 && wanted < 39.6, "{wanted}");
}

/// Exactly at its limit, a rational measure is decided in rational numbers.
#[test]
fn a_rational_measure_at_its_limit_is_decided() {
    let stand = |line: &str| run(line).answer.expect("a report").requirements[0].holds;
    let three = "solve k in 1 N/m .. 1000 N/m: frequency(1) = 3 rad/s\n";
    for (line, equal) in [("<=", true), (">=", true), ("<", false), (">", false)] {
        assert_eq!(stand(&format!("{three}require frequency(1) {line} 3 rad/s")), Some(equal), "{line}");
        assert_eq!(stand(&format!("require gain(F -> x, 0 Hz) {line} 0.1 m/N")), Some(equal), "{line}");
        // c^2 = 4 zeta^2 k m: 0.25 = 4 * 0.0025 * 25 * 1.
        let damped = "solve k in 1 N/m .. 1000 N/m: frequency(1) = 5 rad/s\n";
        assert_eq!(stand(&format!("{damped}require damping(1) {line} 5 %")), Some(equal), "{line}");
    }
}

/// A block on a spring under a load of 10 N times `load`, so that x = load at rest: the codes of findings, and p.
fn solved_at_rest(load: &str, range: &str) -> (Vec<String>, Option<f64>) {
    let text = format!(
        "param p = 0.5\nbody b {{ mass = 1 kg, moves x }}\nspring s: ground -- b {{ k = 10 N/m }}\n\
         force F: b along x = step(10 N * ({load}), 0 s)\noutput x = b.x\nsolve p in {range}: static(x) = 1 m"
    );
    let (sources, file) = sources(&text);
    let outcome = vibc::analyze(&sources, file, &Overrides::default());
    let codes = outcome.diagnostics.iter().map(|finding| finding.code.to_string()).collect();
    (codes, outcome.answer.map(|answer| answer.solved[0].value.to_f64()))
}

/// Roots that lie so close together that no value between them is told from the target, and a whole interval of them: one is found
/// and the others are not excluded, which is said.
#[test]
fn roots_that_are_not_told_apart_are_not_one() {
    let loads = [
        // 1, 1 +- 5e-7 and 1 +- 1e-6
        "1 + (p - 1) * ((p - 1)^2 - 1e-12) * ((p - 1)^2 - 2.5e-13)",
        // 1 and 1 +- 1e-10
        "1 + (p - 1) * ((p - 1)^2 - 1e-20)",
        // 1 .. 1.02, and 1 .. 1 + 1e-9
        "min(p, max(1, p - 0.02))",
        "min(p, max(1, p - 1e-9))",
        // One root, of which the slope says nothing.
        "1 + (p - 1)^9",
    ];
    for load in loads {
        let (codes, _) = solved_at_rest(load, "0 .. 3");
        assert_eq!(codes, ["vib::solve::unsettled"], "{load}");
    }
    // All weights of K grow or stay: frequencies rise, but not from 6 to 6.02 N/m.
    let stays = "param q = 5 N/m\nspring t: ground -- block { k = min(q, max(6 N/m, q - 0.02 N/m)) }\n\
                 solve q in 1 N/m .. 30 N/m: frequency(1) = 4 rad/s";
    let [finding] = &run(stays).diagnostics[..] else { panic!("{:?}", run(stays).diagnostics) };
    assert_eq!(finding.code.to_string(), "vib::solve::unsettled");
    // Two that are far enough apart, and one of three equal ones.
    assert_eq!(solved_at_rest("1 + (p - 1) * ((p - 1)^2 - 1e-4)", "0 .. 3").0, ["vib::solve::several_roots"]);
    assert_eq!(solved_at_rest("p + (p - 1)^3", "0 .. 3"), (vec![], Some(1.0)));
}

/// A root beyond the end of a range is none, however close; one at the end is one.
#[test]
fn a_root_beyond_the_range_is_none() {
    for load in ["p", "p + (p - 1)^3", "2 * p - 1"] {
        for (range, found) in [
            ("0 .. 1", Some(1.0)),
            ("1 .. 3", Some(1.0)),
            ("0 .. 1 - 1e-13", None),
            ("0 .. 1 - 1e-20", None),
            ("1 + 1e-20 .. 3", None),
            ("1 + 1e-9 .. 3", None),
        ] {
            let (codes, p) = solved_at_rest(load, range);
            let codes: Vec<&str> = codes.iter().map(String::as_str).collect();
            match found {
                Some(found) => assert_eq!((codes, p), (vec![], Some(found)), "{load}, {range}"),
                None => assert_eq!((codes, p), (vec!["vib::solve::no_root"], None), "{load}, {range}"),
            }
        }
    }
    // Within what is resolved of a flat measure it is not known.
    for range in ["0 .. 0.9999", "0 .. 1 - 1e-12", "1 + 1e-5 .. 3"] {
        assert_eq!(solved_at_rest("1 + (p - 1)^9", range).0, ["vib::solve::unsettled"], "{range}");
    }
}

/// A root at zero is as good as any other, within the range and at its ends.
#[test]
fn a_root_at_zero_is_found() {
    let truth = "1 + (p - 1)";
    assert_eq!(solved_at_rest(truth, "0.5 .. 2"), (vec![], Some(1.0)));
    for load in ["1 + p", "1 + p / 3", "1 + p + p^2"] {
        for range in ["-0.4 .. 0.4", "0 .. 0.4", "-0.4 .. 0", "-0.1 .. 0.3"] {
            assert_eq!(solved_at_rest(load, range), (vec![], Some(0.0)), "{load}, {range}");
        }
    }
    let detuned = "param z = 0.1\nspring t: ground -- block { k = 90 N/m * (1 + z) }\nsolve z in -0.5 .. 0.5: frequency(1) = 10 rad/s";
    let found = solved(detuned);
    assert!(found[0].value.is_zero() && found[0].bound.is_some_and(|bound| bound < 1e-24), "{found:?}");
}
