//! `minimise` and `maximise`: optima compared with closed forms and published numbers, what is proved about them, what is refused.

use crate::measures::sources;
use vibc::answers::ModalAnswer;
use vibc::base::Diagnostic;
use vibc::model::Overrides;
use vibc::{Best, Optimised, Outcome};

const BLOCK: &str = "param k = 10 N/m\nparam m = 1 kg\nparam c = 0.5 N*s/m\nbody block { mass = m, moves x }\n\
                     spring s: ground -- block { k = k }\ndamper d: ground -- block { c = c }\n\
                     force F: block along x\noutput x = block.x\n";

const TURN: f64 = std::f64::consts::TAU;

fn analyzed(text: &str) -> Outcome<ModalAnswer> {
    let (sources, file) = sources(text);
    vibc::analyze(&sources, file, &Overrides::default())
}

fn optima(text: &str) -> Vec<Optimised> {
    let outcome = analyzed(text);
    assert!(outcome.diagnostics.is_empty(), "{text}: {:?}", outcome.diagnostics);
    outcome.answer.expect("a report").optimised
}

fn optimum(text: &str) -> Optimised {
    optima(text).pop().expect("an optimum")
}

fn findings(text: &str) -> Vec<Diagnostic> {
    analyzed(text).diagnostics
}

/// What is proved: that no values in the ranges are better by more than this.
fn gap(found: &Optimised) -> f64 {
    match found.best {
        Best::Everywhere { gap, .. } => gap.value(),
        _ => panic!("not proved: {found:?}"),
    }
}

/// The exact optimum of the largest gain of a damped absorber on an undamped system: O. Nishihara and T. Asami, Journal of Vibration
/// and Acoustics 124 (2002) 576, with the tuning, the damping ratio and the peak in closed form.
fn exact_optimum(mu: f64) -> [f64; 3] {
    let r = (4.0 + 3.0 * mu).sqrt();
    let a =
        2.0 * (16.0 + 23.0 * mu + 9.0 * mu * mu + 2.0 * (2.0 + mu) * r) / (3.0 * (64.0 + 80.0 * mu + 27.0 * mu * mu));
    let tuning = 2.0 / (1.0 + mu) * a.sqrt();
    let ratio = ((8.0 + 9.0 * mu - 4.0 * r) / (1.0 + mu)).sqrt() / 4.0;
    let under = ((8.0 + 9.0 * mu).powi(2) * (16.0 + 9.0 * mu) - 128.0 * (4.0 + 3.0 * mu).powf(1.5))
        / (3.0 * (32.0 + 27.0 * mu));
    [tuning, ratio, under.sqrt() / (3.0 * mu)]
}

fn absorber(mu: f64) -> String {
    format!(
        "param k = 0.05 N/m\nparam c = 0.02 N*s/m\nbody b {{ mass = 1 kg, moves x }}\nbody t {{ mass = {mu} kg, moves x }}\n\
         spring s: ground -- b {{ k = 1 N/m }}\nspring u: b -- t {{ k = k }}\ndamper d: b -- t {{ c = c }}\nforce F: b along x\n\
         output x = b.x\n"
    )
}

/// Both parameters of the absorber and its peak, to 12 digits and within their bounds, the best of all in the ranges; at two ratios of
/// masses.
#[test]
fn an_absorber_is_tuned_exactly() {
    for (mu, ranges) in [
        (0.05, "c in 0.008 N*s/m .. 0.018 N*s/m, k in 0.04 N/m .. 0.05 N/m"),
        (0.2, "k in 0.1 N/m .. 0.2 N/m, c in 0.05 N*s/m .. 0.15 N*s/m"),
    ] {
        let [tuning, ratio, peak] = exact_optimum(mu);
        let (k, c) = (mu * tuning * tuning, 2.0 * mu * tuning * ratio);
        let found = optimum(&format!("{}minimise peak_gain(F -> x) over {ranges}\n", absorber(mu)));
        assert!((found.value.to_f64() - peak).abs() < 1e-12 * peak, "{mu}: {} {peak}", found.value.to_f64());
        assert!(gap(&found) < 1e-25 * peak, "{mu}: {}", gap(&found));
        assert_eq!(found.equal.len(), 2);
        for parameter in &found.parameters {
            let truth = if parameter.parameter == "k" { k } else { c };
            let off = (parameter.value.to_f64() - truth).abs();
            let bound = parameter.bound.expect("a bound");
            // The closed form in binary64 loses a few digits of the damping ratio by cancellation.
            assert!(off <= bound + 1e-12 * truth, "{mu} {}: {off} {bound}", parameter.parameter);
            assert!(bound < 1e-9 * truth, "{mu} {}: {bound}", parameter.parameter);
        }
    }
}

/// One parameter, one peak: closed forms of an oscillator with a force, and of two equal masses between three springs.
#[test]
fn one_parameter_has_its_closed_form() {
    // |k - m w^2 + i c w| is least at k = m w^2.
    let found = optimum(&format!("{BLOCK}maximise gain(F -> x, 0.5 Hz) over k in 1 N/m .. 100 N/m\n"));
    let w = TURN / 2.0;
    assert!((found.parameters[0].value.to_f64() - w * w).abs() < 1e-6 * w * w, "{found:?}");
    assert!((found.value.to_f64() - 1.0 / (0.5 * w)).abs() < 1e-12, "{found:?}");
    assert!(gap(&found) < 3e-9 * found.value.to_f64());
    // The first frequency of the pair is highest where both outer springs are the same: k = 3 N/m, omega^2 = 3.
    let pair = "param k = 1 N/m\nbody a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\nspring s: ground -- a { k = k }\n\
                spring t: a -- b { k = 3 N/m }\nspring u: b -- ground { k = 6 N/m - k }\n";
    let found = optimum(&format!("{pair}maximise frequency(1) over k in 0.5 N/m .. 5.5 N/m\n"));
    assert!((found.parameters[0].value.to_f64() - 3.0).abs() < 1e-6, "{found:?}");
    assert!((found.value.to_f64() - 3f64.sqrt() / TURN).abs() < 1e-12, "{found:?}");
    assert!(gap(&found) < 3e-9 * found.value.to_f64());
}

/// The undamped machine with an absorber whose stiffness is given: the best damping alone lies where one of the two peaks is highest at
/// a fixed point (J. P. Den Hartog, Mechanical Vibrations, section 3.3), which no damping lowers.
#[test]
fn no_damping_lowers_a_fixed_point() {
    let mu = 0.25;
    let text = absorber(mu).replace("param k = 0.05 N/m", "param k = 0.25 N/m");
    let found = optimum(&format!("{text}minimise peak_gain(F -> x) over c in 0.01 N*s/m .. 1 N*s/m\n"));
    // Fixed points for f = 1: g^4 - 2 g^2 (1 + f^2 + mu f^2) / (2 + mu) + 2 f^2 / (2 + mu) = 0, where |H| = 1 / |1 - g^2 (1 + mu)|.
    let half = (2.0 + mu) / (2.0 + mu);
    let root = (half * half - 2.0 / (2.0 + mu)).sqrt();
    let gains = [half - root, half + root].map(|square: f64| 1.0 / (1.0 - square * (1.0 + mu)).abs());
    let most = gains[0].max(gains[1]);
    assert!((found.value.to_f64() - most).abs() < 1e-12 * most, "{} {most}", found.value.to_f64());
    assert!(gap(&found) < 1e-20, "{}", gap(&found));
}

/// `solve` inside of each trial: k = c^2 / (4 z^2 m) keeps the damping ratio, and the gain at w is largest at k = m w^2 (1 - 2 z^2).
#[test]
fn what_depends_on_the_optimum_is_solved_at_each_trial() {
    let text = format!(
        "{BLOCK}solve k in 0.5 N/m .. 400 N/m: damping(1) = 20 %\nmaximise gain(F -> x, 0.5 Hz) over c in 0.5 N*s/m .. 3 N*s/m\n\
         require 19.99 % < damping(1) < 20.01 %\n"
    );
    let answer = analyzed(&text).answer.expect("a report");
    let [found] = &answer.optimised[..] else { panic!("one optimum") };
    let (z, w) = (0.2, TURN / 2.0);
    let k = w * w * (1.0 - 2.0 * z * z);
    assert!((found.parameters[0].value.to_f64() - 2.0 * z * k.sqrt()).abs() < 1e-6, "{found:?}");
    assert!((answer.solved[0].value.to_f64() - k).abs() < 1e-5 * k, "{:?}", answer.solved);
    // The conditions of `solve` are not enclosed over ranges here, so nothing is claimed.
    assert!(matches!(found.best, Best::Seen));
    assert!(answer.requirements.iter().all(|requirement| requirement.holds == Some(true)));
}

/// What does not depend on the optimum is solved for once, before; and lines are taken in the order of their dependence.
#[test]
fn lines_are_taken_in_order() {
    let text = format!(
        "{BLOCK}maximise gain(F -> x, 0.5 Hz) over c in 0.25 N*s/m .. 3 N*s/m\nsolve m in 0.1 kg .. 10 kg: frequency(1) = 0.6 Hz\n"
    );
    let answer = analyzed(&text).answer.expect("a report");
    assert_eq!(answer.optimised[0].parameters[0].value.to_f64(), 0.25);
    assert_eq!(answer.solved.len(), 1);
}

/// A condition that the unbounded optimum breaks: the best that keeps it lies where it is just met, and nothing is claimed to be proved.
#[test]
fn a_condition_is_kept() {
    let text = format!("{BLOCK}minimise gain(F -> x, 0 Hz) over k in 1 N/m .. 300 N/m while frequency(1) < 2 Hz\n");
    let found = optimum(&text);
    let k = (2.0 * TURN).powi(2);
    let off = k - found.parameters[0].value.to_f64();
    assert!((0.0..1e-6 * k).contains(&off), "{off}");
    assert!(matches!(found.best, Best::Seen));
    // One that is met anyway costs no proof.
    let text = format!(
        "{}minimise peak_gain(F -> x) over c in 0.01 N*s/m .. 0.015 N*s/m, k in 0.044 N/m .. 0.047 N/m while frequency(1) < 2 Hz\n",
        absorber(0.05)
    );
    let found = optimum(&text);
    assert!((found.value.to_f64() - exact_optimum(0.05)[2]).abs() < 1e-11);
    assert!(gap(&found) < 1e-20);
}

/// Each mistake is one finding, at its place.
#[test]
fn mistakes_are_found() {
    let one = |lines: &str, code: &str, at: &str| {
        let text = format!("{BLOCK}{lines}\n");
        let list = findings(&text);
        let [finding] = &list[..] else { panic!("{lines}: {list:?}") };
        assert_eq!(finding.code.0, code, "{lines}");
        let span = finding.primary.span;
        assert_eq!(&text[span.start()..span.end()], at, "{lines}");
    };
    one("minimise gain(F -> x, 0 Hz) over k in 5 N/m .. 20 N/m", "vib::minimise::end_of_range", "k");
    one("minimise frequency(1) over c in 5 N*s/m .. 20 N*s/m", "vib::minimise::plateau", "c");
    one(
        "minimise frequency(2) over k in 5 N/m .. 20 N/m",
        "vib::minimise::no_value",
        "minimise frequency(2) over k in 5 N/m .. 20 N/m",
    );
    one(
        "minimise gain(F -> x, 1 Hz) over c in 1 N*s/m .. 2 N*s/m while frequency(1) > 2 Hz",
        "vib::minimise::never_met",
        "frequency(1) > 2 Hz",
    );
    one("minimise frequency(1) over k in 5 N/m .. 2 N/m", "vib::solve::range", "5 N/m .. 2 N/m");
    one("minimise frequency(1) over k in 5 N/m .. 20 N/m, k in 1 N/m .. 2 N/m", "vib::minimise::twice", "k");
    one("minimise frequency(1) over x in 5 N/m .. 20 N/m", "vib::name::unknown", "x");
    one("minimise frequency(1) over k in 5 kg .. 20 N/m", "vib::unit::mismatch", "5 kg");
    one("minimise stable over k in 5 N/m .. 20 N/m", "vib::measure::value", "stable");
    one("minimise 3 over k in 5 N/m .. 20 N/m", "vib::measure::unknown", "3");
    one(
        "minimise gain(F -> x, 0.5 Hz) over c in 0.1 N*s/m .. 5 N*s/m\nmaximise gain(F -> x, 0.3 Hz) over k in 1 N/m .. 20 N/m",
        "vib::minimise::circle",
        "minimise gain(F -> x, 0.5 Hz) over c in 0.1 N*s/m .. 5 N*s/m",
    );
}

/// A mass on a spring with a damper that may feed energy in. |H| of the damper -c is that of the damper c, so the least peak over both
/// signs lies at the larger size; only the damper that takes energy out is a design.
const FED: &str = "param c = 1 N*s/m\nbody a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 100 N/m }\n\
                   damper d: ground -- a { c = c }\nforce F: a along x\noutput x = a.x\n";

/// The codes of an outcome, and the optima of its report.
fn codes_and_optima(lines: &str) -> (Vec<&'static str>, Vec<Optimised>) {
    let outcome = analyzed(&format!("{FED}{lines}\n"));
    let codes = outcome.diagnostics.iter().map(|finding| finding.code.0).collect();
    (codes, outcome.answer.map_or_else(Vec::new, |answer| answer.optimised))
}

/// Of a response, no unstable values are an optimum, though they are "better": 1 / (c w_d) at c = 2 N s/m, not 1 / (10 w_d) at -10.
#[test]
fn a_response_has_no_optimum_where_a_motion_grows() {
    let (codes, found) = codes_and_optima("minimise peak_gain(F -> x) over c in -10 N*s/m .. 2 N*s/m");
    assert_eq!(codes, ["vib::minimise::end_of_range"]);
    assert_eq!(found[0].parameters[0].value.to_f64(), 2.0);
    let most = 1.0 / (2.0 * (100f64 - 1.0).sqrt());
    assert!((found[0].value.to_f64() - most).abs() < 1e-12 * most, "{:?}", found[0]);
    // The unstable values are smaller, so nothing is claimed of the whole range.
    assert!(!matches!(found[0].best, Best::Everywhere { .. }), "{:?}", found[0].best);
    // The gain at one frequency, and as a part of a measure: |100 - 25 + 5 i c| at 5 rad/s.
    let at = "gain(F -> x, 5 rad/s)";
    let (_, found) = codes_and_optima(&format!("minimise {at} over c in -10 N*s/m .. 2 N*s/m"));
    assert_eq!(found[0].parameters[0].value.to_f64(), 2.0);
    let (_, found) = codes_and_optima(&format!("minimise 2 * {at} over c in -10 N*s/m .. 2 N*s/m"));
    assert_eq!(found[0].parameters[0].value.to_f64(), 2.0);
    let (_, found) =
        codes_and_optima(&format!("minimise damping(1) over c in -10 N*s/m .. 2 N*s/m while {at} > 1 mm/N"));
    assert!(found[0].parameters[0].value.to_f64() > -1e-9, "{:?}", found[0]);
    // Nowhere in the range is a design.
    let (codes, found) = codes_and_optima("minimise peak_gain(F -> x) over c in -10 N*s/m .. -1 N*s/m");
    assert_eq!((codes, found.len()), (vec!["vib::minimise::no_value"], 0));
    let (codes, _) =
        codes_and_optima(&format!("minimise {at} over c in -10 N*s/m .. -1 N*s/m while frequency(1) > 1 Hz"));
    assert_eq!(codes, ["vib::minimise::never_met"]);
}

/// Of other measures they are, with a warning; so are values that are solved for.
#[test]
fn unstable_values_of_other_measures_are_warned_of() {
    let (codes, found) = codes_and_optima("minimise damping(1) over c in -10 N*s/m .. 2 N*s/m");
    assert_eq!(codes, ["vib::minimise::unstable", "vib::minimise::end_of_range"]);
    assert_eq!(found[0].parameters[0].value.to_f64(), -10.0);
    // 1 / |75 + 5 i c| = 10 mm/N: c = sqrt(100^2 - 75^2) / 5, with either sign.
    let solved = |range: &str| codes_and_optima(&format!("solve c in {range}: gain(F -> x, 5 rad/s) = 10 mm/N")).0;
    assert_eq!(solved("-20 N*s/m .. 0 N*s/m"), ["vib::solve::unstable"]);
    assert_eq!(solved("0 N*s/m .. 20 N*s/m"), Vec::<&str>::new());
    // `require stable` says it as an error.
    let (codes, _) = codes_and_optima("minimise damping(1) over c in -10 N*s/m .. 2 N*s/m\nrequire stable");
    assert!(codes.contains(&"vib::require::fails") && !codes.contains(&"vib::minimise::unstable"), "{codes:?}");
}
