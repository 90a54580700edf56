//! Whether an output is infinite at an instant: impulses, jumps and jumps of rates that reach it, and those that do not.
//! Motions are compared with closed forms.

use crate::program::ran;
use serde_json::Value as Json;

/// An oscillator of 1 kg on 4 N/m, omega = 2 rad/s, whose spring hangs on the base q.
const ON_BASE: &str = "body a { mass = 1 kg, moves x }\nspring s: q -- a { k = 4 N/m }\n";

#[derive(Clone, Copy, Debug)]
enum Truth {
    Infinite,
    Value(f64),
    /// A value that has no closed form.
    Finite,
    /// Digits do not decide.
    Open,
}
use Truth::{Finite, Infinite, Open, Value};

/// The measures of a motion up to 2.5 s, each with its limit.
#[track_caller]
fn check(model: &str, truth: &[(&str, Truth)]) {
    let asked: String = truth.iter().map(|(measure, _)| format!("require {measure}\n")).collect();
    // Requirements that do not hold end the program with a status of their own; the report is there all the same.
    let arguments = ["analyze", "--format", "json", "--until", "2.5s"];
    let report: Json = serde_json::from_slice(&ran(&format!("{model}{asked}"), &arguments).stdout).expect("a report");
    let rows = report["requirements"].as_array().unwrap_or_else(|| panic!("no requirements: {report}"));
    assert_eq!(rows.len(), truth.len());
    for (row, (measure, truth)) in rows.iter().zip(truth) {
        match truth {
            Finite => assert!(row["value"].is_number(), "{measure}: {row}"),
            Open => assert!(row["holds"].is_null() && row["value"].is_null(), "{measure}: {row}"),
            Infinite => assert!(row["holds"] == false && row["value"].is_null(), "{measure}: {row}"),
            // Rounding is left of what is zero: it has no relative bound.
            Value(0.0) => assert!(row["value"].as_f64().is_some_and(|value| value < 1e-25), "{measure}: {row}"),
            Value(truth) => {
                let (value, bound) = (row["value"].as_f64(), row["error_bound"].as_f64());
                let (value, bound) = value.zip(bound).unwrap_or_else(|| panic!("{measure} is {truth}: {row}"));
                // Bounds are relative; the closed form has a few roundings of its own.
                assert!((value - truth).abs() <= (bound + 1e-15) * truth.abs(), "{measure}: {value}, not {truth}");
            }
        }
    }
}

/// A point without mass on springs k1 = 1 N/m to the body and k2 to the ground passes k1 / (k1 + k2) of an impulse on.
#[test]
fn springs_pass_an_impulse_on() {
    let model = |k2: &str| {
        format!(
            "body a {{ mass = 1 kg, moves x }}\nbody p {{ mass = 0 kg, moves x }}\nspring t: a -- p {{ k = 1 N/m }}\n\
             spring u: ground -- p {{ k = {k2} N/m }}\nforce F: p along x = impulse(1 N*s, 1 s)\n\
             output x = a.x\noutput v = a.vx\noutput end = p.x\n"
        )
    };
    // The body hangs on 1/2 N/m: v = cos(sqrt(1/2) t) / 2.
    let truth = [("peak(v) < 1 m/s", Value(0.5)), ("peak(end) < 9 m", Infinite), ("rms(end) < 9 m", Infinite)];
    check(&model("1"), &truth);
    // Nothing holds the point but the body: v = 1 m/s, x = t - 1 s.
    check(
        &model("1e-30").replace("spring u", "// spring u"),
        &[("peak(v) < 2 m/s", Value(1.0)), ("peak(x) < 2 m", Value(1.5))],
    );
}

/// However small an impulse is, the acceleration is infinite; a body that it reaches through an inerter has one too.
#[test]
fn the_smallest_impulse_makes_an_acceleration_infinite() {
    let held = "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 4 N/m }\noutput acc = a.ax\n";
    let struck = format!("{held}force F: a along x = impulse(1e-27 N*s, 1 s)\ninitial a {{ x = 1 m }}\n");
    check(&struck, &[("peak(acc) < 10 m/s^2", Infinite), ("rms(acc) < 10 m/s^2", Infinite)]);
    let beside = "body b { mass = 1 kg, moves x }\nspring t: ground -- b { k = 4 N/m }\nforce F: b along x = impulse(1 N*s, 1 s)\n";
    check(&format!("{held}{beside}inerter j: a -- b {{ b = 1e-22 kg }}\n"), &[("peak(acc) < 10 m/s^2", Infinite)]);
    check(&format!("{held}{beside}"), &[("peak(acc) < 10 m/s^2", Value(0.0))]);
}

/// Jumps after the end do not count, nor jumps at one time that cancel, of one input or of two.
#[test]
fn jumps_that_cancel_are_none() {
    let swinging = format!("{ON_BASE}initial a {{ x = 1 mm }}\noutput v = a.vx - q.vx\n");
    // 1 mm cos 2 t
    let later = format!("base q {{ moves x }} = step(1 mm, 3 s)\n{swinging}");
    let rms = 2e-3 * (0.5 * (1.0 - (10f64).sin() / 10.0)).sqrt();
    check(&later, &[("peak(v) < 3 mm/s", Value(2e-3)), ("rms(v) < 3 mm/s", Value(rms))]);
    let twice = format!("base q {{ moves x }} = step(1 mm, 1 s) + step(-1 mm, 1 s)\n{swinging}");
    check(&twice, &[("peak(v) < 3 mm/s", Value(2e-3))]);
    let once = format!("base q {{ moves x }} = step(1 mm, 1 s) + step(-1 mm, 2 s)\n{swinging}");
    check(&once, &[("peak(v) < 3 mm/s", Infinite)]);
    let bases = "base q { moves x } = step(1 mm, 0 s)\nbase r { moves x } = step(1 mm, 0 s)\n";
    check(&format!("{bases}{ON_BASE}output z = q.vx - r.vx\n"), &[("peak(z) < 3 mm/s", Value(0.0))]);
    // Two impulses at one time; two equal bodies that are struck alike.
    let free = "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 4 N/m }\noutput acc = a.ax\n";
    let struck = format!("{free}force F: a along x = impulse(1 N*s, 1 s) + impulse(-1 N*s, 1 s)\n");
    check(&struck, &[("peak(acc) < 1 m/s^2", Value(0.0))]);
    let alike = format!(
        "{free}body b {{ mass = 1 kg, moves x }}\nspring t: ground -- b {{ k = 4 N/m }}\noutput d = a.ax - b.ax\n\
         force F: a along x = impulse(1 N*s, 1 s)\nforce G: b along x = impulse(1 N*s, 1 s)\n"
    );
    check(&alike, &[("peak(acc) < 1 m/s^2", Infinite), ("peak(d) < 1 m/s^2", Value(0.0))]);
}

/// An inerter of the body's own mass takes it along by half of a jump, so 2 a.vx - q.vx has no impulse: after a jump of 1 mm
/// the body swings with sqrt(2) rad/s about 1 mm, from 1/2 mm and at rest.
#[test]
fn what_a_body_follows_can_cancel_a_jump() {
    let model = format!(
        "base q {{ moves x }} = step(1 mm, 1 s)\n{ON_BASE}inerter j: q -- a {{ b = 1 kg }}\n\
         output v = 2*a.vx - q.vx\noutput w = 2.001*a.vx - q.vx\n"
    );
    check(&model, &[("peak(v) < 3 mm/s", Value(2f64.sqrt() * 1e-3)), ("peak(w) < 3 mm/s", Infinite)]);
}

/// A haversine begins and ends at zero with zero slope; its acceleration is amplitude / 2 (2 pi / duration)^2. A harmonic of
/// half a turn begins at zero, with a slope.
#[test]
fn smooth_signals_have_no_jumps() {
    let pi = std::f64::consts::PI;
    let bump = format!(
        "base q {{ moves x }} = haversine(1 mm, 0 s, 1 s)\n{ON_BASE}damper d: q -- a {{ c = 4 N*s/m }}\n\
         output v = q.vx\noutput acc = q.ax\noutput x = a.ax\n"
    );
    let truth = [("peak(v) < 1 m/s", Value(1e-3 * pi)), ("peak(acc) < 1 m/s^2", Value(2e-3 * pi * pi))];
    check(&bump, &truth);
    check(&bump.replace("haversine(1 mm, 0 s, 1 s)", "pulse(1 mm, 0 s, 1 s)"), &[("peak(x) < 1 m/s^2", Infinite)]);
    for signal in ["harmonic(1 mm, 1 Hz, 180 deg)", "harmonic(1 mm, 1 Hz, 90 deg) + step(-1 mm, 0 s)"] {
        let waves = format!("base q {{ moves x }} = {signal}\n{ON_BASE}output v = q.vx\n");
        check(&waves, &[("peak(v) < 1 m/s", Value(2e-3 * pi))]);
    }
    // The base's motion is the integral of its velocity: it does not jump, and the damper passes no impulse on.
    let velocity = "base q { moves x } = harmonic(1 m/s, 1 Hz)\nbody a { mass = 1 kg, moves x }\n\
                    damper d: q -- a { c = 1 N*s/m }\noutput acc = q.ax\noutput x = a.ax\n";
    check(velocity, &[("peak(acc) < 10 m/s^2", Value(2.0 * pi))]);
}

/// A support carries an impulse across its direction; a point without mass on a spring jumps under a step.
#[test]
fn reactions_and_coordinates_that_follow_are_infinite() {
    let carried = "body a { mass = 1 kg, at = (0, 0), moves x }\nspring s: ground@(-1 m, 0) -- a { k = 4 N/m, along = x }\n\
                   force F: a along (0, 1) = impulse(1 N*s, 1 s)\noutput r = a.support_y\n";
    check(carried, &[("peak(r) < 10 N", Infinite), ("rms(r) < 10 N", Infinite)]);
    let point = "body a { mass = 0 kg, moves x }\nspring s: ground -- a { k = 3 N/m }\n\
                 force F: a along x = step(1 N, 0.5 s)\noutput v = a.vx\noutput x = a.x\n";
    check(point, &[("peak(v) < 1 m/s", Infinite), ("peak(x) < 1 m", Value(1.0 / 3.0))]);
}

/// Two steps that cancel if they come at the same time: at pi^2/8 s they do, with whatever is known of pi; of exp(1) s a few
/// digits are known, and one step could come before the other.
#[test]
fn what_digits_do_not_decide_is_open() {
    let model = |first: &str, second: &str| {
        format!(
            "base q {{ moves x }} = step(1 mm, {first}) + step(-1 mm, {second})\n{ON_BASE}output v = q.vx\noutput x = q.x\n"
        )
    };
    check(&model("pi^2/8 * 1 s", "pi*pi/8 * 1 s"), &[("peak(v) < 1 m/s", Value(0.0))]);
    check(&model("exp(0.5) * 1 s", "exp(0.5) * 1 s"), &[("peak(v) < 1 m/s", Open)]);
    check(&model("exp(0.5) * 1 s", "exp(0.6) * 1 s"), &[("peak(v) < 1 m/s", Infinite)]);
}

/// A base with a harmonic acceleration begins at rest: its velocity is a / omega (cos phase - cos(omega t + phase)), and neither
/// a spring nor a damper passes anything infinite on, at whatever phase.
#[test]
fn a_base_that_starts_at_rest_does_not_jump() {
    let omega = 10.0 * std::f64::consts::PI;
    for (phase, angle) in [("0 deg", 0.0), ("30 deg", 30.0), ("45 deg", 45.0), ("-60 deg", 60.0), ("180 deg", 180.0)] {
        let peak = 2.0 / omega * (1.0 + f64::to_radians(angle).cos().abs());
        let model = format!(
            "base q {{ moves x }} = harmonic(2 m/s^2, 5 Hz, {phase})\n{ON_BASE}damper d: q -- a {{ c = 1 N*s/m }}\n\
             output v = q.vx\noutput acc = a.ax\n"
        );
        check(&model, &[("peak(v) < 3 m/s", Value(peak)), ("peak(acc) < 3 m/s^2", Finite)]);
    }
}

/// A point without mass is where springs put it at once: it has no position of its own at t = 0. On a damper of c = 1 N*s/m
/// it creeps back by exp(-k t / c), k being 2 N/m.
#[test]
fn an_initial_state_belongs_to_what_has_mass_or_damping() {
    let model = |more: &str| {
        format!("body p {{ mass = 0 kg, moves x }}\nspring s: ground -- p {{ k = 2 N/m }}\noutput x = p.x\n{more}\n")
    };
    let said = |more: &str| String::from_utf8_lossy(&ran(&model(more), &["check"]).stderr).into_owned();
    let damper = "damper d: ground -- p { c = 1 N*s/m }\n";
    for lost in ["initial p { x = 1 mm }", "initial p { vx = 1 mm/s }", &format!("{damper}initial p {{ vx = 1 mm/s }}")]
    {
        let text = said(lost);
        assert!(text.contains("vib::initial::undetermined") && text.contains("has no effect"), "{lost}: {text}");
    }
    // C = alpha M + beta K, of which the point has only the part of its stiffness.
    let rayleigh = |beta: &str| said(&format!("damping rayleigh(1 /s, {beta})\ninitial p {{ x = 1 mm }}"));
    assert!(rayleigh("0 s").contains("has no effect") && !rayleigh("0.5 s").contains("has no effect"));
    let zero = said("initial p { x = 0 mm }");
    assert!(!zero.contains("initial::"), "{zero}");
    let creep = model(&format!("{damper}initial p {{ x = 1 mm }}"));
    let motion = ran(&creep, &["simulate", "--until", "1s", "--step", "1s"]).stdout;
    let motion = String::from_utf8(motion).expect("UTF-8");
    let last: f64 =
        motion.lines().last().and_then(|line| line.split(',').nth(1)).expect("x").parse().expect("a number");
    assert!((last - 1e-3 * (-2f64).exp()).abs() < 1e-18, "{motion}");
}

/// Rows of a chain of 200 links are chained: its links have inertia, and a node without mass below the last one has none.
#[test]
fn an_initial_state_of_a_deep_chain_is_looked_into() {
    let mut model = String::from("gravity 10 m/s^2\n");
    for i in 0..200 {
        let above = if i == 0 { "ground".to_string() } else { format!("b{}", i - 1) };
        model += &format!("body b{i} {{ mass = 1 kg, shape = rod((0, -{i} m), (0, -{} m)) }}\n", i + 1);
        model += &format!("pivot p{i}: {above}@(0, -{i} m) -- b{i}\n");
    }
    model += "body n { mass = 0 kg, moves x }\nspring s: ground -- n { k = 2 N/m }\n";
    let said = |more: &str| String::from_utf8_lossy(&ran(&format!("{model}{more}\n"), &["check"]).stderr).into_owned();
    let kept = said("initial b0 { angle = 1 deg }\ninitial b199 { omega = 1 rad/s }");
    assert!(!kept.contains("error"), "{kept}");
    let lost = said("initial n { x = 1 mm }");
    assert!(lost.contains("vib::initial::undetermined") && lost.contains("has no effect"), "{lost}");
}
