//! Transfer functions from the velocity or the acceleration of a base: closed forms, limits at 0 Hz, refusals. See
//! docs/method/transfer.md#velocities-and-accelerations-of-bases.

use crate::program::{json, ran};
use serde_json::Value;
use std::f64::consts::PI;

/// 2 kg on 200 N/m and 4 N s/m from the base, and 3 N s/m to the ground.
const MODEL: &str = "base quake { moves x }\nbody block { mass = 2 kg, moves x }\n\
                     spring s: quake -- block { k = 200 N/m }\ndamper d: quake -- block { c = 4 N*s/m }\n\
                     damper g: ground -- block { c = 3 N*s/m }\noutput drift = block.x - quake.x\n\
                     output roof = block.x\noutput speed = block.vx\noutput push = block.ax\n";

type Complex = (f64, f64);

fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

fn over(a: Complex, b: Complex) -> Complex {
    let size = b.0 * b.0 + b.1 * b.1;
    times(a, (b.0 / size, -b.1 / size))
}

fn row(model: &str, from: &str, to: &str, at: &str) -> Value {
    json(model, &["transfer", "--from", from, "--to", to, "--at", at])["pairs"][0]["values"][0].clone()
}

/// x / u = (k + 4 s) / (2 s^2 + 7 s + k) and (x - u) / u = -(2 s^2 + 3 s) / (2 s^2 + 7 s + k), over s or s^2.
#[test]
fn one_mass_has_the_closed_form() {
    for hertz in [1e-6, 0.3, 1.6, 40.0, 1e5] {
        let s: Complex = (0.0, 2.0 * PI * hertz);
        let squared = times(s, s);
        let bottom = (2.0 * squared.0 + 200.0, 7.0 * s.1);
        let roof = over((200.0, 4.0 * s.1), bottom);
        let drift = over((-2.0 * squared.0, -3.0 * s.1), bottom);
        for (to, of_displacement) in
            [("drift", drift), ("roof", roof), ("speed", times(s, roof)), ("push", times(squared, roof))]
        {
            for (from, truth) in [("quake.vx", over(of_displacement, s)), ("quake.ax", over(of_displacement, squared))]
            {
                let row = row(MODEL, from, to, &format!("{hertz}Hz"));
                let number = |name: &str| row[name].as_f64().expect(name);
                let off = (number("re") - truth.0).hypot(number("im") - truth.1);
                let size = truth.0.hypot(truth.1);
                // The closed form itself is rounded a few times.
                assert!(off <= 1e-14 * size && number("error_bound") < 1e-15, "{hertz} {from} {to}: {row} {truth:?}");
            }
        }
    }
}

/// The first terms of the same quotients: -3/200 s and 1 for the drift over s, then infinite ones.
#[test]
fn at_rest_they_are_limits() {
    let value = |from: &str, to: &str| row(MODEL, from, to, "0Hz");
    for (from, to, truth) in [("quake.vx", "drift", -0.015), ("quake.vx", "speed", 1.0), ("quake.ax", "push", 1.0)] {
        let row = value(from, to);
        assert_eq!((row["re"].as_f64(), row["im"].as_f64()), (Some(truth), Some(0.0)), "{from} {to} {row}");
    }
    for (from, to) in [("quake.ax", "drift"), ("quake.vx", "roof"), ("quake.ax", "speed")] {
        assert_eq!(value(from, to)["infinite"], true, "{from} {to}");
    }
    // Without the damper to the ground the drift follows the acceleration: -m/k.
    let model = MODEL.replace("damper g: ground -- block { c = 3 N*s/m }\n", "");
    assert_eq!(row(&model, "quake.ax", "drift", "0Hz")["re"], -0.01);
    let question = "require gain(quake.ax -> drift, 0 Hz) <= 0.01 s^2\n";
    assert!(ran(&(model.clone() + question), &["analyze"]).status.success());
    let narrower = question.replace("0.01", "0.009999999999999999");
    assert!(!ran(&(model + &narrower), &["analyze"]).status.success());
}

/// The peak of |m / (m s^2 + c s + k)| is 1/(2 zeta sqrt(1 - zeta^2) omega^2), zeta = 0.1, omega = 10 rad/s.
#[test]
fn the_largest_drift_by_acceleration_is_that_of_the_textbook() {
    let model = MODEL.replace("damper g: ground -- block { c = 3 N*s/m }\n", "");
    let peak = 0.01 / (0.2 * 0.99f64.sqrt());
    let asks = |limit: f64| {
        let require = format!("require peak_gain(quake.ax -> drift) < {limit:.17} s^2\n");
        ran(&(model.clone() + &require), &["analyze"]).status.success()
    };
    assert!(asks(peak * (1.0 + 1e-13)) && !asks(peak * (1.0 - 1e-13)));
}

/// A stiffness for which the drift under an acceleration of 2 Hz has a given size, from the closed form.
#[test]
fn it_is_solved_for() {
    let model = "param k = 100 N/m\nbase quake { moves x }\nbody block { mass = 2 kg, moves x }\n\
                 spring s: quake -- block { k = k }\ndamper d: quake -- block { c = 4 N*s/m }\n\
                 output drift = block.x - quake.x\nsolve k in 320 N/m .. 2 kN/m: gain(quake.ax -> drift, 2 Hz) = 0.003 s^2\n";
    let solved = json(model, &["analyze"])["solved"][0]["value"].as_f64().expect("a value");
    let omega = 4.0 * PI;
    let truth = 2.0 * omega * omega + ((2.0f64 / 0.003).powi(2) - (4.0 * omega).powi(2)).sqrt();
    assert!((solved / truth - 1.0).abs() < 1e-13, "{solved} {truth}");
}

/// Damping by modes acts on motion relative to what follows the base: exactly nothing of it is left at 0 Hz, although its matrix has
/// only so many digits. Two masses in a row: under an acceleration a the springs carry 5 kg a and 3 kg a.
#[test]
fn damping_by_modes_leaves_the_limits_as_they_are() {
    let model = "base quake { moves x }\nbody a { mass = 2 kg, moves x }\nbody b { mass = 3 kg, moves x }\n\
                 spring s: quake -- a { k = 200 N/m }\nspring t: a -- b { k = 70 N/m }\ndamping modal 3 %\n\
                 output drift = b.x - quake.x\noutput push = b.ax\noutput roof = b.x\n";
    for (from, to, truth) in
        [("quake.ax", "drift", -(5.0 / 200.0 + 3.0 / 70.0)), ("quake.ax", "push", 1.0), ("quake.vx", "drift", 0.0)]
    {
        let row = row(model, from, to, "0Hz");
        let found = row["re"].as_f64().expect("finite");
        assert!(
            (found - truth).abs() < 1e-16 && row["error_bound"].as_f64().is_none_or(|bound| bound < 1e-16),
            "{row}"
        );
    }
    // Without exact numbers it is not proved that this is infinite.
    assert!(row(model, "quake.ax", "roof", "0Hz")["re"].is_null());
}

/// The density of a displacement by the acceleration of its base grows without limit towards 0 Hz; relative to the base it is
/// S (m/k)^2 there.
#[test]
fn densities_at_rest_are_limits_too() {
    let model = MODEL
        .replace("damper g: ground -- block { c = 3 N*s/m }\n", "")
        .replace("moves x }\nbody", "moves x } = noise(3 m^2/s^4/Hz, 0 Hz .. 9 Hz)\nbody")
        + "require psd(drift, 0 Hz) < 1 m^2/Hz\nrequire psd(roof, 0 Hz) < 1 m^2/Hz\n";
    let run = ran(&model, &["analyze", "--format", "json"]);
    let rows = serde_json::from_slice::<Value>(&run.stdout).expect("JSON")["requirements"].clone();
    assert!((rows[0]["value"].as_f64().expect("finite") - 3e-4).abs() < 1e-18, "{rows}");
    assert_eq!(rows[1]["value_text"], "infinite", "{rows}");
}

/// A base that turns, one with two motions, and one along a direction have their own words; others are told.
#[test]
fn every_motion_has_its_words() {
    let model = "base floor { at = (-1 m, 0), moves x y }\nbase shaft { at = (2 m, 0), turns }\nbase ramp { moves along (3, 4) }\n\
                 body block { mass = 1 kg, at = (0, 0), moves x y }\nbody disc { inertia = 1 kg*m^2, turns }\n\
                 body sledge { mass = 1 kg, moves along (3, 4) }\n\
                 spring a: floor -- block { k = 9 N/m }\nspring b: floor@(0, 1 m) -- block { k = 4 N/m }\n\
                 spring t: shaft -- disc { k = 5 N*m/rad }\nspring r: ramp -- sledge { k = 8 N/m }\n\
                 output x = block.x - floor.x\noutput y = block.y - floor.y\noutput turn = disc.angle - shaft.angle\noutput slide = r.stretch\n";
    for (from, to, truth) in [
        ("floor.ax", "x", -1.0 / 9.0),
        ("floor.ay", "y", -0.25),
        ("shaft.alpha", "turn", -0.2),
        ("ramp.a", "slide", -0.125),
        ("floor.vx", "x", 0.0),
        ("shaft.omega", "turn", 0.0),
        ("ramp.v", "slide", 0.0),
    ] {
        assert_eq!(row(model, from, to, "0Hz")["re"].as_f64(), Some(truth), "{from} {to}");
    }
    let told = ran(model, &["transfer", "--from", "floor.alpha", "--at", "1Hz"]);
    let text = String::from_utf8_lossy(&told.stderr).into_owned();
    assert!(text.contains("`floor.alpha` is not an input") && text.contains("`floor.vx`"), "{text}");
}

/// In a component the words are those of its own directions, however it is placed: the drift is -m/k of the acceleration along y,
/// which has the angle 180 degrees.
#[test]
fn a_turned_component_keeps_its_own_directions() {
    let model = "component axle(k: N/m) {\n  base road { moves y }\n  body hub { mass = 1 kg, moves y }\n\
                 spring s: road -- hub { k = k }\n  require gain(road.ay -> hub.y - road.y, 0 Hz) <= 0.1 s^2\n\
                 require phase(road.ay -> hub.y - road.y, 0 Hz) > 179 deg\n}\n\
                 place front = axle(k = 10 N/m) at (0, 0)\nplace side = axle(k = 10 N/m) at (3 m, 0) turned 90 deg\n\
                 place skew = axle(k = 10 N/m) at (5 m, 0) turned 30 deg\nplace back = axle(k = 10 N/m) at (7 m, 0) turned 180 deg\n\
                 place other = axle(k = 10 N/m) at (9 m, 0) mirrored y\n";
    let run = ran(model, &["analyze", "--format", "json"]);
    let rows = serde_json::from_slice::<Value>(&run.stdout).expect("JSON")["requirements"].clone();
    let rows = rows.as_array().expect("requirements");
    assert!(rows.len() == 10 && rows.iter().all(|row| row["holds"] == true), "{rows:?}");
    let wrong = ran(&model.replace("gain(road.ay", "gain(road.ax"), &["check"]);
    let told = String::from_utf8_lossy(&wrong.stderr).into_owned();
    assert!(told.contains("`ax` is no motion of this base") && told.contains("`road.ay`"), "{told}");
}

/// A lossy spring that another one stretches, however slowly the base moves: with the complex stiffness k (1 + i loss) and one more spring
/// and damper to the ground, X/U = k' / (k' + g (1 + i l) + c s + m s^2), at every frequency but 0.
#[test]
fn what_loses_energy_in_following_the_base_has_values_at_frequencies() {
    let model = "base quake { moves x }\nbody block { mass = 2 kg, moves x }\nspring s: quake -- block { k = 90 N/m, loss = 0.1 }\n\
                 spring g: ground -- block { k = 30 N/m, loss = 0.4 }\ndamper d: ground -- block { c = 3 N*s/m }\n\
                 output drift = block.x - quake.x\noutput roof = block.x\noutput push = block.ax\noutput pull = s.force\n";
    for hertz in [1e-6, 0.3, 1.2, 40.0] {
        let s: Complex = (0.0, 2.0 * PI * hertz);
        let squared = times(s, s);
        let bottom = (90.0 + 30.0 + 2.0 * squared.0, 9.0 + 12.0 + 3.0 * s.1);
        let roof = over((90.0, 9.0), bottom);
        let drift = over((-30.0 - 2.0 * squared.0, -12.0 - 3.0 * s.1), bottom);
        for (to, of_displacement) in
            [("drift", drift), ("roof", roof), ("push", times(squared, roof)), ("pull", times((90.0, 9.0), drift))]
        {
            for (from, truth) in [("quake.vx", over(of_displacement, s)), ("quake.ax", over(of_displacement, squared))]
            {
                let row = row(model, from, to, &format!("{hertz}Hz"));
                let number = |name: &str| row[name].as_f64().expect(name);
                let off = (number("re") - truth.0).hypot(number("im") - truth.1);
                let size = truth.0.hypot(truth.1);
                assert!(off <= 1e-14 * size && number("error_bound") < 1e-15, "{hertz} {from} {to}: {row} {truth:?}");
            }
        }
    }
    let text = format!(
        "{model}require gain(quake.ax -> drift, 2 Hz) < 1 s^2\nrequire gain(quake.ax -> drift, 0 Hz) < 1 s^2\n"
    );
    let run = ran(&text, &["analyze", "--format", "json"]);
    let rows = serde_json::from_slice::<Value>(&run.stdout).expect("JSON")["requirements"].clone();
    assert!(rows[0]["holds"] == true && rows[1]["value"].is_null(), "{rows}");
    assert!(String::from_utf8_lossy(&run.stderr).contains("its loss has no limit at 0 Hz"));
    for asked in [&["--at", "0Hz"][..], &["--range", "0Hz..1Hz", "--points", "3"]] {
        let told = ran(model, &[&["transfer", "--from", "quake.ax"], asked].concat());
        let text = String::from_utf8_lossy(&told.stderr).into_owned();
        assert!(!told.status.success() && text.contains("`quake.ax` at 0 Hz: a spring with a loss factor"), "{text}");
    }
}

/// What a damper alone joins to the base does not follow it, however slowly it moves.
#[test]
fn what_does_not_follow_the_base_is_refused() {
    let loose = "base quake { moves x }\nbody block { mass = 2 kg, moves x }\ndamper d: quake -- block { c = 4 N*s/m }\n\
                 output drift = block.x - quake.x\n";
    let told = ran(loose, &["transfer", "--from", "quake.ax", "--at", "1Hz"]);
    let text = String::from_utf8_lossy(&told.stderr).into_owned();
    assert!(!told.status.success() && text.contains("no spring holds some motion"), "{text}");
    assert_eq!(row(loose, "quake.vx", "drift", "0Hz")["re"].as_f64(), Some(-0.5));
}

/// What follows a base that moves by its acceleration, in the end: -c v / k beside a damper c to the ground, -m a / k, and the
/// displacement of the base where it comes to rest.
#[test]
fn a_final_value_under_a_moving_base_is_that_of_the_textbook() {
    let folder = tempfile::tempdir().expect("a folder");
    // Kept at 2 m/s^2 from 0 to 1 s, then a line to 6 m/s^2 at 3 s: 10 m/s.
    std::fs::write(folder.path().join("push.csv"), "time [s], acc [m/s^2]\n1,2\n3,6\n").expect("a table");
    std::fs::write(folder.path().join("early.csv"), "time [s], v [m/s]\n-1,0\n1,1\n").expect("a table");
    let scene = |signal: &str, damper: &str| {
        format!(
            "base quake {{ moves x }} = {signal}\nbody block {{ mass = 2 kg, moves x }}\n\
             spring s: quake -- block {{ k = 200 N/m }}\ndamper d: {damper} -- block {{ c = 4 N*s/m }}\n\
             output drift = block.x - quake.x\noutput roof = block.x\n"
        )
    };
    let rest = "pulse(1 m/s^2, 1 s, 2 s) + pulse(-1 m/s^2, 2 s, 3 s)";
    let ramps = "ramp(1 m/s^2, 0 s, 2 s) + ramp(-1 m/s^2, 2 s, 6 s) + pulse(-1 m/s^2, 0 s, 3 s)";
    for (signal, damper, output, truth) in [
        ("step(3 m/s^2, 1 s)", "quake", "drift", Some(-0.03)),
        ("step(3 m/s, 1 s)", "ground", "drift", Some(-0.06)),
        ("step(3 m/s, 1 s)", "quake", "drift", Some(0.0)),
        ("pulse(1 m/s^2, 1 s, 3 s)", "ground", "drift", Some(-0.04)),
        ("table(\"push.csv\")", "ground", "drift", Some(-0.2)),
        (rest, "ground", "roof", Some(1.0)),
        // 0.5 + 4/24 - (8 + 16/24) + 4.5
        (ramps, "quake", "roof", Some(-3.5)),
        ("step(3 m/s, 1 s)", "quake", "roof", None),
        // From t = 0 on: the area of what is left.
        ("pulse(1 m/s, -3 s, 1 s)", "quake", "roof", Some(1.0)),
        ("sawtooth(1 m/s, -1 s, 1 s)", "quake", "roof", Some(0.75)),
        ("trapezoid(1 m/s, -3 s, -1 s, 1 s, 2 s)", "quake", "roof", Some(1.5)),
        ("impulse(5 m, -1 s) + impulse(2 m, 1 s)", "quake", "roof", Some(2.0)),
        ("table(\"early.csv\")", "quake", "roof", Some(0.75)),
        // v = t/2 + t^2/4 up to 1 s, and back to 0 at 2 s: 1/3 + 3/8
        ("sawtooth(1 m/s^2, -1 s, 1 s) + pulse(-0.75 m/s^2, 1 s, 2 s)", "quake", "roof", Some(17.0 / 24.0)),
    ] {
        let path = folder.path().join("scene.vib");
        let text = scene(signal, damper) + &format!("require static({output}) < 1 km\n");
        std::fs::write(&path, text).expect("a scene");
        let run = std::process::Command::new(env!("CARGO_BIN_EXE_vibc"))
            .args(["analyze", "--format", "json"])
            .arg(&path)
            .output()
            .expect("runs");
        let told: Value = serde_json::from_slice(&run.stdout).expect("JSON");
        let row = &told["requirements"][0];
        match (row["value"].as_f64(), truth) {
            (Some(value), Some(truth)) => assert!((value - truth).abs() < 1e-15, "{signal} {damper}: {row}"),
            (value, truth) => assert!(value == truth && row["value_text"] == "infinite", "{signal}: {row}"),
        }
    }
}
