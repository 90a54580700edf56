//! Claims of `solve`, `require` and `--sensitivity`, compared with closed forms: every root in a range, double roots,
//! critical damping, zero frequencies, several unknowns within their bounds; derivatives near veering and at repeated
//! frequencies; measures of a motion that nothing moves; and advice that works.

use crate::measures::sources;
use vibc::answers::ModalAnswer;
use vibc::base::{Ball, Diagnostic, Number};
use vibc::model::Overrides;
use vibc::questions::answer::{Derivative, Others, Slope, Value};
use vibc::{Failure, Outcome, Study};

fn run(text: &str) -> Outcome<ModalAnswer> {
    let (sources, file) = sources(text);
    vibc::analyze(&sources, file, &Overrides::default())
}

fn answer(text: &str) -> ModalAnswer {
    let outcome = run(text);
    assert!(outcome.diagnostics.is_empty(), "{:?}", outcome.diagnostics);
    outcome.answer.expect("a report")
}

fn finding(text: &str) -> Diagnostic {
    let outcome = run(text);
    let [finding] = &outcome.diagnostics[..] else { panic!("{:?}", outcome.diagnostics) };
    finding.clone()
}

/// All numbers in a text.
fn numbers(text: &str) -> Vec<f64> {
    text.split(|c: char| !(c.is_ascii_digit() || ".-e".contains(c))).filter_map(|word| word.parse().ok()).collect()
}

const BLOCK: &str = "param k = 10 N/m\nparam m = 1 kg\nparam c = 0.5 N*s/m\nbody block { mass = m, moves x }\n\
                     spring s: ground -- block { k = k }\ndamper d: ground -- block { c = c }\n";

/// What is left when free motions have decayed is asked of scenes in which one grows: by a damper that feeds energy in, and by
/// a spring that pushes away. A damper that feeds in less than the others take leaves all values.
#[test]
fn nothing_settles_where_a_free_motion_grows() {
    let model = |k: &str, c: [&str; 2], signal: &str, measure: &str| {
        format!(
            "body b {{ mass = 1 kg, moves x }}\nspring s: ground -- b {{ k = {k} }}\ndamper d: ground -- b {{ c = {} }}\n\
             damper e: ground -- b {{ c = {} }}\nforce F: b along x = {signal}\noutput x = b.x\nrequire {measure}\n",
            c[0], c[1]
        )
    };
    for (signal, measure, value) in [
        ("step(1 N, 0 s)", "static(x) < 2 m", 0.01),
        ("harmonic(1 N, 0.5 Hz)", "amplitude(x) < 2 m", {
            let omega = std::f64::consts::PI;
            1.0 / (100.0 - omega * omega).hypot(omega)
        }),
        ("noise(white 1 N^2/Hz)", "psd(x, 0.5 Hz) < 2 m^2/Hz", {
            let omega = std::f64::consts::PI;
            1.0 / (100.0 - omega * omega).hypot(omega).powi(2)
        }),
    ] {
        for (k, c) in [("100 N/m", ["-1 N*s/m", "0.5 N*s/m"]), ("-100 N/m", ["1 N*s/m", "1 N*s/m"])] {
            let outcome = run(&model(k, c, signal, measure));
            // Notes say that a coefficient is negative.
            let found = outcome.diagnostics.last().expect("a finding");
            assert_eq!(found.code.0, "vib::require::no_value", "{measure}");
            let shown = format!("{found:?}");
            assert!(shown.contains("a free motion grows: nothing settles"), "{shown}");
        }
        let held = run(&model("100 N/m", ["-1 N*s/m", "2 N*s/m"], signal, measure)).answer.expect("a report");
        let Value::Number(found) = &held.requirements[0].value else { panic!("{measure} has a value") };
        assert!((found.to_f64() - value).abs() <= 1e-14 * value, "{measure}: {found:?}, not {value}");
    }
}

/// A light absorber makes a narrow resonance: two of the three roots lie in a thousandth of the range.
#[test]
fn roots_between_evaluations_are_found() {
    let messages = finding(
        "param p = 10 N/m\nbody a { mass = 1 kg, moves x }\nbody b { mass = 1e-8 kg, moves x }\n\
         spring s: ground -- a { k = 20 N/m + p }\nspring t: a -- b { k = 1e-4 * p }\ndamper d: ground -- a { c = 0.01 N*s/m }\n\
         force F: a along x\noutput y = a.x\nsolve p in 1 N/m .. 100 N/m: gain(F -> y, 300 rad/s) = 1.11200e-5 m/N\n",
    );
    assert_eq!(messages.code.0, "vib::solve::several_roots");
    assert!(messages.message.starts_with("3 values"), "{}", messages.message);
    assert!(!messages.primary.text.contains("not excluded"), "{}", messages.primary.text);
    // Roots of |k_b - m_b w^2|^2 = T^2 |det|^2 in p, by polynomial roots to 60 digits.
    let roots = numbers(&messages.primary.text);
    for truth in [ROOTS_OF_THE_ABSORBER[0], ROOTS_OF_THE_ABSORBER[1], ROOTS_OF_THE_ABSORBER[2]] {
        assert!(roots.iter().any(|root| (root - truth).abs() < 1e-5 * truth), "{truth}: {}", messages.primary.text);
    }
}

const ROOTS_OF_THE_ABSORBER: [f64; 3] = [8.999811380441198, 8.99999995497475, 51.94358470272428];

/// 10 / (10 + (a - 0.3)^2) is 1 only at a = 0.3: the measure touches the wanted value.
#[test]
fn a_double_root_is_found() {
    let touching = "param a = 0.5\nparam F0 = 10 N\nbody b { mass = 1 kg, moves x }\n\
                    spring s: ground -- b { k = (10 + (a - 0.3)^2) * 1 N/m }\nforce F: b along x = step(F0, 0 s)\noutput x = b.x\n";
    let answer = answer(&format!("{touching}solve a in -1 .. 1.1: static(x) = 1 m\n"));
    assert_eq!(answer.solved[0].value, Number::from("0.3"));
    assert!(matches!(answer.solved[0].others, Others::None(_)), "{:?}", answer.solved[0].others);
    // A slightly larger value is never reached, a slightly smaller one twice.
    let messages = finding(&format!("{touching}solve a in -1 .. 1.1: static(x) = 1.0001 m\n"));
    assert_eq!(messages.code.0, "vib::solve::no_root");
    assert!(messages.message.starts_with("no value of `a`"), "{}", messages.message);
    let messages = finding(&format!("{touching}solve a in -1 .. 1.1: static(x) = 0.9999 m\n"));
    assert!(messages.message.starts_with("2 values"), "{}", messages.message);
}

/// A double root at a number without a short decimal cannot be distinguished from no root.
#[test]
fn undecided_solutions_have_their_own_exit_status() {
    let outcome = run(
        "param a = 0.5\nbody b { mass = 1 kg, moves x }\nspring s: ground -- b { k = (10 + (a - sqrt(0.1))^2) * 1 N/m }\n\
         force F: b along x = step(10 N, 0 s)\noutput x = b.x\nsolve a in -1 .. 1.1: static(x) = 1 m\n",
    );
    assert_eq!(outcome.diagnostics[0].code.0, "vib::solve::unsettled");
    assert_eq!(outcome.failure(), Some(Failure::Limit));
}

/// c = 2 sqrt(k m), exactly if that is rational; from there on the ratio is one.
#[test]
fn critical_damping_is_solved_for() {
    let found = answer(&format!("{BLOCK}solve c in 0.1 N*s/m .. 50 N*s/m: damping(1) = 1\n"));
    let solved = &found.solved[0];
    let off = Number::from(40).sqrt().expect("positive").to_ball() - solved.value.to_ball();
    let bound = solved.bound.expect("a bound");
    assert!(off.mid.hi.abs() <= bound + off.rad && bound < 1e-25, "{off:?} {bound:e}");
    assert!(matches!(solved.others, Others::None(_)));
    let exact = BLOCK.replace("10 N/m", "4 N/m");
    let found = answer(&format!("{exact}solve c in 0.1 N*s/m .. 50 N*s/m: damping(1) = 1\n"));
    assert_eq!(found.solved[0].value, Number::from(4));
}

/// The poles of a motion meet between two that were real before: the roots of the discriminant of det(M s^2 + C s + K), from SymPy.
#[test]
fn critical_damping_among_overdamped_motions_is_solved_for() {
    let scene = "param c = 0.5 N*s/m\nbody a { mass = 1 kg, moves x }\nbody b { mass = 2 kg, moves x }\n\
                 spring s: ground -- a { k = 10 N/m }\nspring t: a -- b { k = 5 N/m }\ndamper d: a -- b { c = c }\n\
                 damper e: ground -- a { c = c }\n";
    for (motion, high, truth) in [(1, 50, 12.593_218_195_718_02), (2, 12, 3.4539665610381527)] {
        let found = run(&format!("{scene}solve c in 0.01 N*s/m .. {high} N*s/m: damping({motion}) = 1\n"))
            .answer
            .expect("an answer");
        let off = found.solved[0].value.to_ball().to_f64() - truth;
        assert!(off.abs() <= 4.0 * f64::EPSILON * truth, "{motion}: {off:e}");
        assert!(found.solved[0].bound.is_some_and(|bound| bound < 1e-14));
    }
    // All motions are overdamped there: they have the ratio 1, but none is critically damped.
    let text = finding(&format!("{scene}solve c in 20 N*s/m .. 50 N*s/m: damping(1) = 1\n"));
    assert!(text.message.ends_with("makes `damping(1)` 1 (critical damping)"), "{text:?}");
    assert!(text.primary.text.contains("from 1 (overdamped) at c = "), "{text:?}");
}

/// An inverted pendulum on a spring: k a^2 = m g l.
#[test]
fn a_zero_frequency_is_solved_for() {
    let text = "param k = 60 N/m\ngravity 9.81 m/s^2\nbody bob { mass = 1 kg, at = (0, 1 m) }\npivot p: ground@(0,0) -- bob\n\
                spring s: ground@(-1 m, 0.5 m) -- bob@(0, 0.5 m) { k = k }\nsolve k in 10 N/m .. 100 N/m: frequency(1) = 0 Hz\n";
    assert_eq!(answer(text).solved[0].value, Number::from("39.24"));
}

/// Two rods that snap through under a load at their hinge, and a slider crank that does so under a torque: the rest of a loop is not proved
/// to be that of every search, so that no value is excluded. The crank has every frequency from 0 Hz on just above k = 104.4943 N/m, where
/// it leaves its rest.
#[test]
fn roots_before_a_loop_snaps_through_are_not_excluded() {
    let rods = "param P = 4 N\nbody a { mass = 1 kg, shape = rod((0, 0), (1 m, 0.3 m)) }\n\
                body b { mass = 1 kg, shape = rod((1 m, 0.3 m), (2 m, 0)) }\nbody c { mass = 1 kg, at = (2 m, 0), moves x }\n\
                pivot p: ground@(0, 0) -- a\npivot q: a@(1 m, 0.3 m) -- b\npivot r: b@(2 m, 0) -- c\n\
                spring s: c -- ground@(3 m, 0) { k = 500 N/m }\nforce F: a@(1 m, 0.3 m) along -y = constant(P)\n\
                force H: a@(1 m, 0.3 m) along y\noutput y = a@(1 m, 0.3 m).y\n\
                solve P in 0 N .. 30 N: gain(H -> y, 0.01 Hz) = 500 m/N\n";
    let found = run(rods).answer.expect("an answer");
    assert!(!matches!(found.solved[0].others, Others::None(_)), "{:?}", found.solved[0].others);
    let crank = "param k = 105 N/m\ngravity 9.81 m/s^2\npoint A = (cos(100.4 deg) * 0.4 m, sin(100.4 deg) * 0.4 m)\npoint B = (1.2 m, 0)\n\
                 body cr { mass = 1.743 kg, shape = rod((0, 0), A) }\nbody co { mass = 1 kg, shape = rod(A, B) }\n\
                 body pi { mass = 2 kg, at = B, moves x }\npivot p: ground@(0, 0) -- cr\npivot q: cr@A -- co\npivot r: co@B -- pi\n\
                 spring s: pi -- ground@(2.4 m, 0) { k = k, free_length = 0.839 m }\ntorque Q: cr = constant(1.967 N*m)\n\
                 solve k in 99.8191 N/m .. 115.5 N/m: frequency(1) = 0.003 Hz\n";
    let message = &run(crank).diagnostics[0].message;
    assert!(!message.starts_with("no value"), "{message}");
}

/// Tried one at a time, each parameter gives 3 = 3; together they have two solutions, and only one if the ranges are
/// narrower.
#[test]
fn several_solutions_are_reported() {
    let text = |low: &str| {
        format!(
            "param a = 1\nparam b = 2\nbody m {{ mass = 1 kg, moves x }}\nbody n {{ mass = 1 kg, moves x }}\n\
             spring s: ground -- m {{ k = (a + b) * 1 N/m }}\nspring t: ground -- n {{ k = a * b * 1 N/m }}\n\
             force F: m along x = step(6 N, 0 s)\nforce G: n along x = step(6 N, 0 s)\noutput x = m.x\noutput y = n.x\n\
             solve a in {low} .. 4: static(x) = 1.2 m\nsolve b in 0.5 .. 4: static(y) = 1 m\n"
        )
    };
    let messages = finding(&text("0.5"));
    assert_eq!(messages.code.0, "vib::solve::several_roots");
    assert!(
        messages.primary.text.contains("a = 2, b = 3") && messages.primary.text.contains("a = 3, b = 2"),
        "{}",
        messages.primary.text
    );
    let one = answer(&text("2.6"));
    for (solved, truth) in one.solved.iter().zip([3, 2]) {
        let bound = solved.bound.expect("proven");
        let off = (solved.value.to_ball() - Ball::from(f64::from(truth))).magnitude();
        assert!(off <= bound && bound < 1e-24, "{off:e} {bound:e}");
        // It is not proved that these ranges contain no other set.
        assert!(matches!(solved.others, Others::Unknown));
    }
}

/// Bounds of several unknowns, compared with roots of the equations in closed form: w1^2 + w2^2 and w1^2 w2^2 of two
/// masses on three springs.
#[test]
fn bounds_of_several_unknowns_hold() {
    // K = [[k + q, -q], [-q, k + q]], m = 1: w1^2 = k, w2^2 = k + 2 q.
    let found = answer(
        "param k = 1 N/m\nparam q = 1 N/m\nbody a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\n\
         spring s: ground -- a { k = k }\nspring t: a -- b { k = q + 0.1 * k }\nspring u: ground -- b { k = k + 0.1 * q }\n\
         solve k in 1 N/m .. 30 N/m: frequency(1) = 2 rad/s\nsolve q in 1 N/m .. 30 N/m: frequency(2) = 4 rad/s\n",
    );
    let [k, q] = &found.solved[..] else { panic!("two") };
    // Trace and determinant of K at the reported values: 20 and 64 within the bounds.
    let at = |solved: &vibc::questions::Solved| solved.value.to_ball();
    let (k_value, q_value) = (at(k), at(q));
    let tenth = Number::from("0.1").to_ball();
    let trace = k_value * (Ball::from(2.0) + tenth * Ball::from(2.0)) + q_value * (Ball::from(2.0) + tenth);
    let (a, b, c) = (k_value, q_value + tenth * k_value, k_value + tenth * q_value);
    let determinant = (a + b) * (b + c) - b * b;
    let width = 100.0 * (k.bound.expect("proven") + q.bound.expect("proven"));
    assert!(width < 1e-20);
    assert!((trace - Ball::from(20.0)).magnitude() <= width, "{:?}", trace);
    assert!((determinant - Ball::from(64.0)).magnitude() <= width, "{:?}", determinant);
}

/// df1/dp of two oscillators with a weak coupling q, near veering: lambda = (a + b)/2 - sqrt((a - b)^2/4 + q^2), a = p
/// + q, b = 1 + q.
#[test]
fn slopes_near_veering_are_enclosed() {
    for coupling in ["1e-3", "1e-6", "1e-9", "3e-10", "1e-12"] {
        let text = format!(
            "param p = 1.000000001 N/m\nbody a {{ mass = 1 kg, moves x }}\nbody b {{ mass = 1 kg, moves x }}\n\
             spring s: ground -- a {{ k = p }}\nspring t: ground -- b {{ k = 1 N/m }}\nspring u: a -- b {{ k = {coupling} N/m }}\n"
        );
        let (q, half) = (Number::from(coupling), Number::from("0.0000000005"));
        let root = (&half.square() + &q.square()).sqrt().expect("positive");
        let mean = &(&Number::ONE + &half) + &q;
        for (mode, sign) in [(0, -1), (1, 1)] {
            let sign = Number::from(sign);
            let square = &mean + &(&sign * &root);
            // d lambda / dp = 1/2 +- half / (2 root), df = d lambda / (4 pi sqrt(lambda)).
            let slope = &Number::from("0.5") + &(&sign * &(&(&half / &root) / &Number::from(2)));
            let truth = &slope / &(&(&Number::from(4) * &Number::pi()) * &square.sqrt().expect("positive"));
            holds(&text, mode, &truth, 1e-12);
        }
    }
}

/// Asserts that the slope of a frequency by the first parameter is enclosed to a relative width and contains the truth.
fn holds(text: &str, mode: usize, truth: &Number, width: f64) {
    let study = Study { sensitivity: true, ..Study::default() };
    let (sources, file) = sources(text);
    let request = vibc::analysis::Request::default();
    let outcome = vibc::analyze_with(&sources, file, &Overrides::default(), &request, &study);
    let sensitivities = outcome.answer.expect("a report").sensitivities;
    match &sensitivities[0].frequencies[mode] {
        Some(Slope::Smooth { absolute: Derivative::Enclosed(ball), .. }) => {
            let off = *ball - truth.to_ball();
            assert!(off.contains_zero(), "{text}: {ball:?} {truth:?}");
            assert!(ball.relative_error() < width, "{text}: {ball:?}");
        }
        other => panic!("{text}: {other:?}"),
    }
}

fn sensitivities(text: &str) -> Vec<vibc::questions::Sensitivity> {
    let study = Study { sensitivity: true, ..Study::default() };
    let (sources, file) = sources(text);
    let request = vibc::analysis::Request::default();
    vibc::analyze_with(&sources, file, &Overrides::default(), &request, &study).answer.expect("a report").sensitivities
}

/// Two equal oscillators: a stiffness of both moves both equally; that of one alone splits them, with the slopes of the
/// branches.
#[test]
fn slopes_of_repeated_frequencies() {
    let text = |second: &str| {
        format!(
            "param p = 4 N/m\nbody a {{ mass = 1 kg, moves x }}\nbody b {{ mass = 1 kg, moves x }}\n\
             spring s: ground -- a {{ k = p }}\nspring t: ground -- b {{ k = {second} }}\nspring u: a -- b {{ k = 0 * p }}\n"
        )
    };
    let truth = Number::pi().recip().map(|one| &one / &Number::from(8)).expect("not zero");
    for mode in [0, 1] {
        holds(&text("p"), mode, &truth, 1e-12);
    }
    let parted = sensitivities(&text("4 N/m"));
    let Some(Slope::Splits(slopes)) = &parted[0].frequencies[0] else { panic!("{:?}", parted[0].frequencies) };
    assert!(slopes[0].0.abs() < 1e-12 && (slopes[1].0 - truth.to_f64()).abs() < 1e-12, "{slopes:?}");
}

/// zeta = c / (2 sqrt(k m)): d zeta/dc = zeta / c, d zeta/dk = -zeta / 2k.
#[test]
fn slopes_of_damping_ratios_are_enclosed() {
    let list = sensitivities(BLOCK);
    let zeta = &Number::from("0.25") / &Number::from(10).sqrt().expect("positive");
    let truths = [&zeta / &Number::from(-20), &zeta / &Number::from(-2), &zeta * &Number::from(2)];
    for (sensitivity, truth) in list.iter().zip(truths) {
        match &sensitivity.ratios[0] {
            Some(Slope::Smooth { absolute: Derivative::Enclosed(ball), .. }) => {
                assert!(
                    (*ball - truth.to_ball()).contains_zero() && ball.relative_error() < 1e-20,
                    "{ball:?} {truth:?}"
                );
            }
            other => panic!("{}: {other:?}", sensitivity.parameter),
        }
    }
}

/// The advice that makes an unstable rest stable works; a parameter that `solve` determines is not part of it.
#[test]
fn advice_works() {
    let pendulum = |k: &str| {
        format!(
            "param m = 1 kg\nparam k = {k}\ngravity 9.81 m/s^2\nbody bob {{ mass = m, at = (0, 1 m) }}\npivot p: ground@(0,0) -- bob\n\
             spring s: ground@(-1 m, 0.5 m) -- bob@(0, 0.5 m) {{ k = k }}\nrequire stable\n"
        )
    };
    let messages = finding(&pendulum("30 N/m"));
    let help = messages.help.expect("advice");
    let wanted = help.split(" = ").nth(1).and_then(|rest| rest.split(" it").next()).expect("a value");
    assert!(help.starts_with("with k") || help.starts_with("with m"), "{help}");
    let fixed = if help.starts_with("with k") { pendulum(wanted) } else { pendulum("30 N/m").replace("1 kg", wanted) };
    assert!(run(&fixed).diagnostics.is_empty(), "{help}");
    let messages = finding(
        "param k = 100 N/m\nparam m = 1 kg\nbody b { mass = m, moves x }\nspring s: ground -- b { k = k }\ndamper d: ground -- b { c = 1 N*s/m }\n\
         force F: b = step(1 N, 0 s)\noutput x = b.x\nsolve k in 1 N/m .. 1000 N/m: frequency(1) = 2 Hz\nrequire peak(x) < 2 mm\n",
    );
    assert!(
        messages.help.as_ref().is_some_and(|help| !help.contains("`k`") && !help.contains("k =")),
        "{:?}",
        messages.help
    );
    // A softer spring takes longer to come to rest, and the rms is one over that time: in a run of its own it holds too.
    let shaken = "param k = 106 N/m\nbody a { mass = 1.11 kg, moves x }\nbody b { mass = 1.36 kg, moves x }\n\
                  spring s: ground -- a { k = k }\nspring t: a -- b { k = 9.29 N/m }\ndamper d: ground -- a { c = 0.114 N*s/m }\n\
                  damper e: a -- b { c = 0.155 N*s/m }\nforce F: b along x = pulse(0.619 N, 0 s, 1 s)\noutput x = a.x\n\
                  require rms(x) > 0.0669 m\n";
    let help = finding(shaken).help.expect("advice");
    let wanted = help.split("k = ").nth(1).and_then(|rest| rest.split(" it").next()).expect("a value");
    assert!(run(&shaken.replace("106 N/m", wanted)).diagnostics.is_empty(), "{help}");
}

/// A requirement for a motion that nothing moves has no value.
#[test]
fn an_undriven_motion_has_no_measure() {
    let still =
        "body b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 100 N/m }\nforce G: b along x\noutput x = b.x\n";
    for measure in ["amplitude", "static", "peak", "rms"] {
        let messages = finding(&format!("{still}require {measure}(x) < 1 mm\n"));
        assert_eq!(messages.code.0, "vib::require::no_value", "{measure}");
    }
}

/// K = diag(k, -m g l) of a body that stands on the pivot of a cart: its stiffness at rest is negative, not missing, and no
/// multiple of the loads changes that, whether the cart is free (k = 0) or held.
#[test]
fn what_topples_under_any_load_has_no_load_factor() {
    let model = "gravity 9.81 m/s^2\nbody cart { mass = 1 kg, moves x }\n\
                 body pole { mass = 1 kg, inertia = 0.1 kg*m^2, at = (0, 0.5 m) }\n\
                 pivot p: cart@(0, 0) -- pole@(0, 0)\n";
    for spring in ["", "spring s: ground -- cart { k = 10 N/m }\n"] {
        let found = finding(&format!("{model}{spring}require load_factor > 1\n"));
        assert_eq!(found.code.0, "vib::require::no_value", "{spring}");
        let text = &found.primary.text;
        assert!(text.contains("neither the springs alone nor springs and loads together are shown to hold"), "{text}");
    }
}

/// Undamped at its own frequency, in rad/s: infinite, and reported as such.
#[test]
fn an_undamped_resonance_is_infinite() {
    let messages = finding(
        "body b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 100 N/m }\nforce F: b = harmonic(1 N, 10 rad/s)\noutput x = b.x\n\
         require amplitude(x) < 1 mm\n",
    );
    assert_eq!(messages.code.0, "vib::require::fails");
    assert!(messages.primary.text.contains("infinite"), "{}", messages.primary.text);
}

#[test]
fn forms_that_are_not_there_are_named() {
    let text = "body a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\nspring s: ground -- a { k = 100 N/m }\n\
                spring t: a -- b { k = 100 N/m }\n";
    for (condition, code) in [
        ("sqrt(frequency(2)) > 2 Hz", "vib::measure::value"),
        ("2 * stable > 1", "vib::measure::value"),
        ("frequency(1) ^ 2 > 2", "vib::measure::value"),
        ("1 Hz < frequency(1) > 5 Hz", "vib::require::form"),
        ("frequency(1) + 1", "vib::require::form"),
        ("frequency(1) > damping(1)", "vib::unit::mismatch"),
        ("frequency(1) + 1 m > 2 Hz", "vib::unit::mismatch"),
        ("frequency(1) - 3 /s > 2 Hz", "vib::unit::frequency"),
        ("1 Hz < 2 Hz", "vib::measure::unknown"),
        ("frequncy(1) > 2 Hz", "vib::measure::unknown"),
    ] {
        assert_eq!(finding(&format!("{text}require {condition}\n")).code.0, code, "{condition}");
    }
    let messages = finding(&format!("{text}require zzzzzz(1) > 2 Hz\n"));
    let help = messages.help.expect("the measures");
    for measure in vibc::kinds::functions::MEASURES {
        assert!(help.contains(measure.function.name), "{}: {help}", measure.function.name);
    }
    let messages = finding(&format!("{text}require stabel\n"));
    assert_eq!(messages.help.as_deref(), Some("did you mean `stable`?"));
}

/// Poles of one block in closed form: +-2i; twice 0, which drifts by v t; 0 and -c/m, which stays where it comes to a stop;
/// of two blocks with a spring between them twice 0 and +-i sqrt(2); 1/4 +- i sqrt(63)/4; +-2, under a negative stiffness.
#[test]
fn a_rest_is_stable_if_nothing_grows_and_stiffness_restrains_every_motion() {
    use vibc::questions::answer::Value;
    let block = "body a { mass = 1 kg, moves x }\n";
    for (parts, holds, word) in [
        ("spring s: ground -- a { k = 4 N/m }\n", true, "stable"),
        ("", false, "neutral"),
        ("damper d: ground -- a { c = 1 N*s/m }\n", false, "neutral"),
        ("body b { mass = 1 kg, moves x }\nspring s: a -- b { k = 1 N/m }\n", false, "neutral"),
        ("spring s: ground -- a { k = 4 N/m }\ndamper d: ground -- a { c = -0.5 N*s/m }\n", false, "not stable"),
        ("spring s: ground -- a { k = -4 N/m }\n", false, "not stable"),
    ] {
        let outcome = run(&format!("{block}{parts}require stable\n"));
        let told: Vec<&Diagnostic> = outcome.diagnostics.iter().filter(|d| d.code.0 == "vib::require::fails").collect();
        let answer = outcome.answer.expect("a report");
        let [row] = &answer.requirements[..] else { panic!("{parts}") };
        assert!(matches!(&row.value, Value::Verdict(text) if text == word), "{parts}: {:?}", row.value);
        assert_eq!(row.holds, Some(holds), "{parts}");
        assert_eq!(told.len(), usize::from(!holds), "{parts}: {:?}", outcome.diagnostics);
        let text = told.first().map_or("", |finding| finding.primary.text.as_str());
        assert_eq!(text.contains("no stiffness restrains"), word == "neutral", "{parts}: {text}");
    }
}

/// Models with a parameter `p`, its range, and a measure with the unit in which it is compared: geometry, a rest that
/// moves, resonances in the range, several coordinates.
const FAMILIES: [(&str, f64, f64, &str, &str); 7] = [
    (
        "param p = 6 N*m\ngravity 10 m/s^2\nbody rod { mass = 2 kg, shape = rod((0, 0), (0, -1.5 m)) }\npivot o: ground@(0, 0) -- rod\n\
         spring s: ground -- rod { k = 20 N*m/rad }\ntorque T: rod = constant(p)\n",
        1.0,
        12.0,
        "frequency(1)",
        "Hz",
    ),
    (
        "param p = 0.7 m\nbody b { mass = 2 kg, at = (0, 0), moves x y }\nspring s: ground@(-1 m, p) -- b { k = 100 N/m }\n\
         spring t: ground@(1 m, p) -- b { k = 150 N/m }\nspring u: ground@(0, -1 m) -- b { k = 30 N/m }\n",
        0.2,
        3.0,
        "frequency(1)",
        "Hz",
    ),
    (CHAIN, 20.0, 900.0, "frequency(2)", "Hz"),
    (CHAIN, 20.0, 900.0, "gain(F -> y, 1.3 Hz)", "m/N"),
    (CHAIN, 20.0, 900.0, "phase(F -> y, 1.3 Hz)", "rad"),
    (CHAIN, 20.0, 900.0, "static(c.x - a.x)", "m"),
    (
        "param p = 2 kg\nbody a { mass = 1 kg, moves x }\nbody b { mass = p, moves x }\nspring s: ground -- a { k = 100 N/m }\n\
         spring t: a -- b { k = 80 N/m }\nforce F: a = harmonic(2 N, 1.1 Hz)\n",
        0.5,
        6.0,
        "amplitude(b.x)",
        "m",
    ),
];

const CHAIN: &str = "param p = 100 N/m\nbody a { mass = 1 kg, moves x }\nbody b { mass = 2 kg, moves x }\nbody c { mass = 1.5 kg, moves x }\n\
                     spring s: ground -- a { k = 200 N/m }\nspring t: a -- b { k = p }\nspring u: b -- c { k = 150 N/m }\n\
                     damper d: a -- b { c = 1 N*s/m }\ndamper e: b -- c { c = 0.01 * p * 1 s }\nforce F: c = step(3 N, 0 s)\noutput y = c.x\n";

/// The value of a measure at some parameter value is taken as the wanted one: then that parameter value is found, or is
/// one of several; it is never proved that there is no solution or only a different one.
#[test]
fn no_root_is_excluded() {
    let mut state = 20261122u64;
    let mut random = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    for (text, low, high, measure, unit) in FAMILIES {
        let declared = text.lines().next().expect("a parameter");
        let dimension = declared.rsplit(' ').next().expect("a unit");
        for _ in 0..3 {
            let truth = low + (high - low) * random();
            let at = text.replacen(declared, &format!("param p = {truth} {dimension}"), 1);
            let read = run(&format!("{at}require {measure} > -1000 {unit}\n"));
            let value =
                match &read.answer.unwrap_or_else(|| panic!("{at}: {:?}", read.diagnostics)).requirements[0].value {
                    vibc::questions::answer::Value::Number(ball) => ball.to_f64(),
                    other => panic!("{measure}: {other:?}"),
                };
            let asked =
                format!("{text}solve p in {low} {dimension} .. {high} {dimension}: {measure} = {value:e} {unit}\n");
            let outcome = run(&asked);
            let messages: String =
                outcome.diagnostics.iter().map(|d| format!("{} {}", d.message, d.primary.text)).collect();
            let among = || numbers(&messages).iter().any(|x| (x - truth).abs() < 1e-5 * truth);
            match outcome.answer.map(|answer| answer.solved) {
                Some(solved) => {
                    let off = (solved[0].value.to_f64() - truth).abs();
                    assert!(off < 1e-10 * truth, "{measure} at {truth}: {:?}", solved[0]);
                }
                None => assert!(messages.contains(" values of `p`") && among(), "{measure} at {truth}: {messages}"),
            }
        }
    }
}

/// An undamped resonance in the middle of the range: both values are found and proved to be all.
#[test]
fn roots_on_both_sides_of_a_resonance_are_all() {
    let undamped = "param k = 10 N/m\nparam m = 1 kg\nbody block { mass = m, moves x }\nspring s: ground -- block { k = k }\nforce F: block along x\n";
    let messages = finding(&format!("{undamped}solve k in 5 N/m .. 100 N/m: gain(F -> block.x, 1 Hz) = 0.05 m/N\n"));
    assert_eq!(messages.primary.text, "k = 19.4784 N/m and 59.4784 N/m");
}

/// A block between two slanted springs snaps through at 4.974958 N, and just below the stiffness falls to zero: with L0 = sqrt(1.09) and
/// K = 1000 (1 - L0 / L^3) = (0.02 pi)^2 it is 0.01 Hz at some load. A rest that is followed back from where it has snapped through must
/// not hide that.
#[test]
fn a_root_before_the_block_snaps_through_is_not_excluded() {
    let block = |mass: &str, more: &str| {
        format!(
            "param P = 4.9749584632131012034761461069323 N\nbody b {{ mass = {mass}, at = (0, 0.3 m), moves y }}\n\
             spring s: ground@(-1 m, 0) -- b {{ k = 500 N/m }}\nspring t: b -- ground@(1 m, 0) {{ k = 500 N/m }}\n\
             force F: b along -y = constant(P)\n{more}"
        )
    };
    // Just below the fold the block is at sqrt(1.09^(1/3) - 1) = 0.1708 m, and P = 1000 y (L0 / L - 1).
    let l0 = 1.09f64.sqrt();
    let length = (l0 / (1.0 - (0.02 * std::f64::consts::PI).powi(2) / 1000.0)).cbrt();
    let y = (length * length - 1.0).sqrt();
    let load = 1000.0 * y * (l0 / length - 1.0);
    let set = answer(&block("1 kg", "").replace("4.9749584632131012034761461069323", &format!("{load:.17}")));
    let frequency = set.modes.list[0].omega_squared.to_f64().sqrt() / std::f64::consts::TAU;
    assert!((frequency - 0.01).abs() < 1e-5 && (0.0..20.0).contains(&load), "{frequency} {load}");

    // What is left undetermined has to hold that load, whether or not the other root, of a block that gets heavy, is found.
    let holds_it = |label: &str| matches!(numbers(label)[..], [.., low, high] if low < load && load < high);
    let none = finding(&block("1 kg", "solve P in 0 N .. 20 N: frequency(1) = 0.01 Hz"));
    assert_eq!(none.code.0, "vib::solve::unsettled");
    assert!(holds_it(none.primary.text.split(';').next().expect("a label")), "{none:?}");
    let heavy = run(&block("1 kg + 1e6 kg/N * max(P - 10 N, 0 N)", "solve P in 0 N .. 20 N: frequency(1) = 0.01 Hz"));
    let solved = heavy.answer.expect("a report").solved.remove(0);
    let Others::Unsettled(parts) = &solved.others else { panic!("{:?}", solved.others) };
    assert!(parts.iter().any(|(low, high)| holds_it(&format!("{low} {high}"))), "{parts:?}");
}

/// A rod of 1 m on a torsion spring of 10 N m/rad: a load of 9 N on its end drives nothing, but leaves 1 N m/rad, so it is not called
/// without effect, and nor is a base that is displaced for good. A load across the only motion of a block is.
#[test]
fn what_changes_the_stiffness_alone_has_an_effect() {
    let rod = "body rod { mass = 3 kg, shape = rod((0, 0), (0, 1 m)) }\npivot p: ground@(0, 0) -- rod\nspring s: ground -- rod { k = 10 N*m/rad }\n";
    let square = |more: &str| answer(&format!("{rod}{more}")).modes.list[0].omega_squared.to_f64();
    assert!((square("force F: rod@(0, 1 m) along -y = constant(9 N)\n") - 1.0).abs() < 1e-14);
    // The spring of 100 N/m pulls with 20 N, along the rod, at its end, 0.8 m from the base.
    let base = "base g { at = (0, 2 m), moves y } = constant(-20 cm)\nspring z: g -- rod@(0, 1 m) { k = 100 N/m }\n";
    assert!((square(base) - (10.0 - 20.0 * (1.0 + 1.0 / 0.8))).abs() < 1e-12, "{}", square(base));
    let across =
        "body b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 1 N/m }\nforce F: b along y = constant(9 N)\n";
    assert_eq!(finding(across).code.0, "vib::unused::input");
}
