//! What a signal does, beside closed forms: pulses, bases by rate and acceleration, delays, tables in units of their own.
//! See docs/method/response.md#signals.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// The samples of a model, one row a time; tables stand beside it.
pub fn simulated(model: &str, tables: &[(&str, &str)], more: &[&str]) -> Vec<Vec<f64>> {
    let output = ran(model, tables, &[&["simulate"], more].concat());
    assert!(output.status.success(), "{model}\n{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout);
    text.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().expect("a number")).collect()).collect()
}

pub fn ran(model: &str, tables: &[(&str, &str)], arguments: &[&str]) -> Output {
    let folder = tempfile::tempdir().expect("a temporary folder");
    put(&folder, "m.vib", model);
    for (name, text) in tables {
        put(&folder, name, text);
    }
    let path: &Path = folder.path();
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    command.args(arguments).arg(path.join("m.vib")).output().expect("the program starts")
}

fn put(folder: &TempDir, name: &str, text: &str) {
    fs::write(folder.path().join(name), text).expect("a file");
}

/// Regression: a chirp or a half sine that is short beside a step had "too many cycles", as if it lasted all the step.
#[test]
fn a_short_signal_ends_in_a_long_step() {
    for signal in ["chirp(1 N, 1 Hz, 9 Hz, 5 s)", "half_sine(1 N, 0.1 s, 0.3 s)"] {
        let model = format!(
            "body b {{ mass = 1 kg, moves x }}\nspring s: ground -- b {{ k = 100 N/m }}\n\
             damper d: ground -- b {{ c = 1e-4 N*s/m }}\nforce F: b along x = {signal}\noutput x = b.x\n"
        );
        let last = |step: &str| {
            let rows = simulated(&model, &[], &["--until", "40000s", "--step", step, "--format", "csv"]);
            rows.last().expect("a row")[1]
        };
        let (short, long) = (last("400s"), last("40000s"));
        assert!(short != 0.0 && (long / short - 1.0).abs() < 1e-9, "{signal}: {long} {short}");
    }
}

/// Delayed inputs have the rows of their table at other times, so that they take memory for each.
#[test]
fn rows_of_delayed_tables_count_for_each_input() {
    let model = |inputs: u32| {
        format!(
            "body b {{ mass = 1 kg, moves x }}\nspring s: ground -- b {{ k = 100 N/m }}\n\
             force F[1]: b along x = table(\"t.csv\", 1 N)\n\
             repeat i in 2..{inputs} {{ force F[i]: b along x = delayed(F[i-1], 1 s) }}\noutput x = b.x\n"
        )
    };
    let rows: String = (0..50_000).map(|i| format!("{i},{}\n", i % 7)).collect();
    let tables = [("t.csv", rows.as_str())];
    let refused = ran(&model(81), &tables, &["simulate", "--until", "1s", "--step", "1s", "--message-format", "json"]);
    assert_eq!(refused.status.code(), Some(4));
    let found: serde_json::Value = serde_json::from_slice(&refused.stderr).expect("one finding");
    assert_eq!(found["code"], "vib::limit::values");
    assert_eq!(
        found["message"],
        "the tables that drive all inputs have 4050000 rows, counted anew for each delayed input; the limit is 4000000"
    );
}

/// The first finding of a model, as its code.
pub fn code(model: &str, tables: &[(&str, &str)]) -> String {
    let output = ran(model, tables, &["check", "--message-format", "json"]);
    let text = String::from_utf8_lossy(&output.stderr);
    let Some(line) = text.lines().next() else { return String::new() };
    let found: serde_json::Value = serde_json::from_str(line).expect("one object a line");
    found["code"].as_str().expect("a code").to_string()
}

const M: f64 = 2.0;
const K: f64 = 50.0;
const W: f64 = 5.0;

/// x of the undamped oscillator, from rest, under a force that starts at 0 as a step, a ramp or a harmonic.
pub fn step(t: f64) -> f64 {
    if t < 0.0 { 0.0 } else { (1.0 - (W * t).cos()) / K }
}

pub fn ramp(t: f64) -> f64 {
    if t < 0.0 { 0.0 } else { (t - (W * t).sin() / W) / K }
}

fn sine(rate: f64, t: f64) -> f64 {
    if t < 0.0 { 0.0 } else { ((rate * t).sin() - rate / W * (W * t).sin()) / (M * (W * W - rate * rate)) }
}

fn cosine(rate: f64, t: f64) -> f64 {
    if t < 0.0 { 0.0 } else { ((rate * t).cos() - (W * t).cos()) / (M * (W * W - rate * rate)) }
}

pub fn meets(rows: &[Vec<f64>], column: usize, truth: impl Fn(f64) -> f64) {
    let scale = rows.iter().map(|row| row[column].abs()).fold(0.0, f64::max);
    assert!(scale > 0.0);
    for row in rows {
        let (found, truth) = (row[column], truth(row[0]));
        assert!((found - truth).abs() < 1e-13 * scale, "t = {}: {found:e}, not {truth:e}", row[0]);
    }
}

/// Each pulse as a sum of steps, ramps and waves that begin at its corners.
#[test]
fn pulses_move_an_oscillator_as_their_closed_forms_say() {
    let model = |signal: &str| {
        format!(
            "body b {{ mass = 2 kg, moves x }}\nspring s: ground -- b {{ k = 50 N/m }}\n\
             force F: b along x = {signal}\noutput x = b.x\n"
        )
    };
    let run = |signal: &str| simulated(&model(signal), &[], &["--until", "2 s", "--step", "0.03 s"]);
    let pi = std::f64::consts::PI;
    let (from, to) = (0.25, 0.75);
    let half = pi / (to - from);
    meets(&run("half_sine(3 N, 0.25 s, 0.75 s)"), 1, |t| 3.0 * (sine(half, t - from) + sine(half, t - to)));
    let turn = 2.0 * half;
    meets(&run("haversine(3 N, 0.25 s, 0.75 s)"), 1, |t| {
        1.5 * (step(t - from) - step(t - to) - cosine(turn, t - from) + cosine(turn, t - to))
    });
    meets(&run("sawtooth(3 N, 0.25 s, 0.75 s)"), 1, |t| 6.0 * (ramp(t - from) - ramp(t - to)) - 3.0 * step(t - to));
    meets(&run("trapezoid(3 N, 0.25 s, 0.5 s, 1 s, 1.1 s)"), 1, |t| {
        12.0 * (ramp(t - 0.25) - ramp(t - 0.5)) - 30.0 * (ramp(t - 1.0) - ramp(t - 1.1))
    });
}

/// Signals act from t = 0 on: what begins before is there what is left of it, whatever kind it is. Closed forms from sums of steps,
/// ramps and waves that begin at 0.
#[test]
fn a_signal_that_begins_before_zero_is_cut_there() {
    let model = |signal: &str| {
        format!(
            "body b {{ mass = 2 kg, moves x }}\nspring s: ground -- b {{ k = 50 N/m }}\n\
             force F: b along x = {signal}\noutput x = b.x\n"
        )
    };
    let rows = [("early.csv", "-1,0\n1,2\n"), ("past.csv", "-2,1\n-1,3\n"), ("at_zero.csv", "-1,0\n0,1\n1,3\n")];
    let half = std::f64::consts::PI / 2.0;
    type Truth = Box<dyn Fn(f64) -> f64>;
    let cases: [(&str, Truth); 11] = [
        ("step(3 N, -1 s)", Box::new(|t| 3.0 * step(t))),
        ("pulse(3 N, -1 s, 0.5 s)", Box::new(|t| 3.0 * (step(t) - step(t - 0.5)))),
        ("ramp(4 N, -1 s, 1 s)", Box::new(|t| 2.0 * (step(t) + ramp(t) - ramp(t - 1.0)))),
        ("ramp(4 N, -2 s, -1 s)", Box::new(|t| 4.0 * step(t))),
        // sin(pi (t + 1) / 2) = cos(pi t / 2), which goes on to 1 s and is -sin(pi (t - 1) / 2) from there
        ("half_sine(3 N, -1 s, 1 s)", Box::new(move |t| 3.0 * (cosine(half, t) + sine(half, t - 1.0)))),
        (
            "haversine(3 N, -1 s, 1 s)",
            Box::new(move |t| 1.5 * (step(t) - step(t - 1.0) + cosine(2.0 * half, t) + cosine(2.0 * half, t - 1.0))),
        ),
        ("sawtooth(4 N, -1 s, 1 s)", Box::new(|t| 2.0 * (step(t) + ramp(t) - ramp(t - 1.0)) - 4.0 * step(t - 1.0))),
        ("trapezoid(4 N, -2 s, -0.5 s, 0.5 s, 1.5 s)", Box::new(|t| 4.0 * (step(t) - ramp(t - 0.5) + ramp(t - 1.5)))),
        ("table(\"early.csv\", 1 N)", Box::new(|t| step(t) + ramp(t) - ramp(t - 1.0))),
        ("table(\"past.csv\", 1 N)", Box::new(|t| 3.0 * step(t))),
        ("table(\"at_zero.csv\", 1 N)", Box::new(|t| step(t) + 2.0 * (ramp(t) - ramp(t - 1.0)))),
    ];
    for (signal, truth) in cases {
        let output = ran(&model(signal), &rows, &["simulate", "--until", "2 s", "--step", "0.04 s"]);
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && told.contains("vib::signal::cut"), "{signal}: {told}");
        meets(&simulated(&model(signal), &rows, &["--until", "2 s", "--step", "0.04 s"]), 1, truth);
    }
}

/// A signal that is over by t = 0 never acts: the check says so, and every answer is that of a scene without it.
#[test]
fn a_signal_that_is_over_by_zero_never_acts() {
    let model = |signal: &str| {
        format!(
            "base g {{ moves x }} = {signal}\nbody b {{ mass = 2 kg, moves x }}\nspring s: g -- b {{ k = 50 N/m }}\n\
             damper d: ground -- b {{ c = 1 N*s/m }}\ninitial b {{ vx = 1 m/s }}\noutput x = b.x\nrequire peak(x) < 1 m\n"
        )
    };
    let tables = [("past.csv", "-2,1\n-1,3\n")];
    let asked: [&[&str]; 3] = [
        &["analyze", "--until", "2 s"],
        &["simulate", "--until", "2 s", "--step", "0.1 s"],
        &["shock", "--range", "1Hz..10Hz", "--points", "3"],
    ];
    let later = "pulse(1 m/s^2, 1 s, 3 s)";
    for over in [
        "impulse(1 m/s, -1 s)",
        "pulse(1 m/s^2, -2 s, 0 s)",
        "half_sine(1 m/s^2, -2 s, -1 s)",
        "haversine(1 m/s^2, -2 s, 0 s)",
        "sawtooth(1 m/s^2, -2 s, -1 s)",
        "trapezoid(1 m/s^2, -5 s, -4 s, -3 s, -1 s)",
        "table(\"past.csv\", 1 m/s^2)",
    ] {
        assert_eq!(code(&model(&format!("{later} + {over}")), &tables), "vib::unused::signal", "{over}");
        for arguments in asked {
            let [without, with] = [later.to_string(), format!("{later} + {over}")]
                .map(|signal| ran(&model(&signal), &tables, &[arguments, &["-q"]].concat()));
            let [with, without] = [with, without].map(|ran| String::from_utf8_lossy(&ran.stdout).into_owned());
            assert!(with == without && !with.is_empty(), "{over}, {arguments:?}:\n{with}\nnot\n{without}");
        }
    }
    let pushed = "body b { mass = 2 kg, moves x }\nspring s: ground -- b { k = 50 N/m }\noutput x = b.x\n\
                  force F: b along x = impulse(1 N*s, -1 s)\n";
    let still = simulated(pushed, &[], &["--until", "1 s", "--step", "0.5 s"]);
    assert!(still.iter().all(|row| row[1] == 0.0), "{still:?}");
}

/// Emitted code builds in the same signals: compiled, it prints the samples of `simulate`.
#[test]
fn emitted_code_cuts_signals_at_zero() {
    let model = "body b { mass = 2 kg, moves x }\nspring s: ground -- b { k = 50 N/m }\ndamper d: ground -- b { c = 1 N*s/m }\n\
                 force F: b along x = half_sine(3 N, -1 s, 1 s) + impulse(9 N*s, -1 s) + ramp(1 N, -2 s, 1 s)\noutput x = b.x\n";
    let wanted = simulated(model, &[], &["--until", "2 s", "--step", "0.1 s"]);
    let printed = crate::program::emitted(model, "0.1 s", "2 s");
    assert_eq!(printed.len(), wanted.len());
    for (row, wanted) in printed.iter().zip(&wanted) {
        assert!((row[1] - wanted[1]).abs() < 1e-14, "{row:?}, not {wanted:?}");
    }
}

const SHAKEN: &str = "body b { mass = 2 kg, moves x }\nbase g { moves x } = SIGNAL\nspring s: g -- b { k = 50 N/m }\n\
                      output z = b.x - g.x\noutput u = g.x\noutput v = g.vx\noutput a = b.ax\n";

/// A record whose accelerations do not add up: 2 t up to 1 s, then 2 - 3 (t - 1) up to 2 s leaves 1.5 m/s, after
/// 1/3 + 1 + 1/2 m. One that adds up says nothing, and nor does a velocity.
#[test]
fn a_record_that_drifts_is_noted() {
    let told = |record: &str| {
        let (model, tables) = (SHAKEN.replace("SIGNAL", "table(\"quake.csv\")"), [("quake.csv", record)]);
        String::from_utf8_lossy(&ran(&model, &tables, &["simulate", "--until", "3 s", "--step", "1 s"]).stderr)
            .into_owned()
    };
    let note = told("t [s], a [m/s^2]\n0, 0\n1, 2\n2, -1\n");
    assert!(
        note.contains("vib::table::drift") && note.contains("at about 1.5 m/s, 1.8 m from where it began"),
        "{note}"
    );
    // The first value holds from t = 0 on, and what is before t = 0 does not count: 2 + 1 and 1.
    assert!(told("t [s], a [m/s^2]\n1, 2\n2, 0\n").contains("at about 3 m/s, 3.7 m from"));
    assert!(told("t [s], a [m/s^2]\n-1, 0\n1, 2\n").contains("at about 1.5 m/s, 0.67 m from"));
    assert!(!told("t [s], a [m/s^2]\n0, 0\n1, 2\n2, 0\n3, -2\n4, 0\n").contains("drift"));
    assert!(!told("t [s], v [m/s]\n0, 0\n1, 2\n2, 0\n").contains("drift"));
}

/// z'' + w^2 z = -a for z against the base, and the base's own motion from rest by integrals.
#[test]
fn a_base_by_its_acceleration_or_rate_starts_at_rest() {
    let run = |signal: &str, tables: &[(&str, &str)]| {
        simulated(&SHAKEN.replace("SIGNAL", signal), tables, &["--until", "3 s", "--step", "0.05 s"])
    };
    let held = |f: fn(f64) -> f64, t: f64| -M * f(t);
    let rows = run("step(4 m/s^2, 0.5 s)", &[]);
    meets(&rows, 1, |t| 4.0 * held(step, t - 0.5));
    meets(&rows, 2, |t| 2.0 * (t - 0.5).max(0.0).powi(2));
    meets(&rows, 3, |t| 4.0 * (t - 0.5).max(0.0));
    let rows = run("impulse(0.3 m/s, 0.5 s)", &[]);
    meets(&rows, 2, |t| 0.3 * (t - 0.5).max(0.0));
    let rows = run("step(0.3 m/s, 0.5 s)", &[]);
    meets(&rows, 1, |t| -0.3 * (W * (t - 0.5).max(0.0)).sin() / W);
    meets(&rows, 2, |t| 0.3 * (t - 0.5).max(0.0));
    // a sin(r t + p): the velocity is a (cos p - cos(r t + p)) / r.
    let (r, p) = (2.0 * std::f64::consts::PI, std::f64::consts::FRAC_PI_3);
    let rows = run("harmonic(4 m/s^2, 1 Hz, 60 deg)", &[]);
    meets(&rows, 1, |t| -M * 4.0 * (p.cos() * sine(r, t) + p.sin() * cosine(r, t)));
    meets(&rows, 3, |t| 4.0 * (p.cos() - (r * t + p).cos()) / r);
    meets(&rows, 2, |t| 4.0 * (p.cos() * t / r - ((r * t + p).sin() - p.sin()) / (r * r)));
    // A record of lines, zero after its last row: 2 t up to 1, then 2 - 3 (t - 1) up to 2, then nothing.
    let record = "t [s], a [m/s^2]\n0, 0\n1, 2\n2, -1\n";
    let rows = run("table(\"quake.csv\")", &[("quake.csv", record)]);
    let before = |t: f64| 2.0 * ramp(t) - 5.0 * ramp(t - 1.0);
    meets(&rows, 1, |t| -M * (before(t) + 3.0 * ramp(t - 2.0) + step(t - 2.0)));
    let cubic = |t: f64| t.max(0.0).powi(3) / 6.0;
    let square = |t: f64| t.max(0.0).powi(2) / 2.0;
    meets(&rows, 2, |t| 2.0 * cubic(t) - 5.0 * cubic(t - 1.0) + 3.0 * cubic(t - 2.0) + square(t - 2.0));
    let half = run("half_sine(4 m/s^2, 0.5 s, 0.75 s)", &[]);
    let r = 4.0 * std::f64::consts::PI;
    meets(&half, 1, |t| -M * 4.0 * (sine(r, t - 0.5) + sine(r, t - 0.75)));
    let pulse = |t: f64| if t < 0.0 { 0.0 } else { (t - (r * t).sin() / r) / r };
    meets(&half, 2, |t| 4.0 * (pulse(t - 0.5) + pulse(t - 0.75)));
}

/// The steady state knows nothing of the drift: |z| = a / |w^2 - r^2|. A base that moves on for ever settles nowhere.
#[test]
fn the_steady_state_is_without_drift() {
    let model = SHAKEN.replace("SIGNAL", "harmonic(4 m/s^2, 1 Hz)");
    let r = 2.0 * std::f64::consts::PI;
    let exact = 4.0 / (r * r - W * W);
    let near =
        format!("{model}require amplitude(z) < {} m\nrequire amplitude(z) > {} m\n", exact + 1e-12, exact - 1e-12);
    assert_eq!(code(&near, &[]), "");
    assert_eq!(code(&format!("{model}require amplitude(z) < {} m\n", exact - 1e-12), &[]), "vib::require::fails");
    assert_eq!(code(&format!("{model}require static(z) < 1 m\n"), &[]), "vib::require::no_value");
}

/// Every kind of signal, later: the second of two equal oscillators does what the first one did.
#[test]
fn a_delayed_signal_does_the_same_later() {
    let table = [("road.csv", "x [m], y [mm]\n0, 0\n1, 3\n2, -1\n4, 0\n")];
    for signal in [
        "harmonic(3 mm, 1.5 Hz, 20 deg)",
        "step(3 mm, 0.1 s) + ramp(2 mm, 0.2 s, 0.33 s)",
        "chirp(3 mm, 1 Hz, 4 Hz, 0.7 s)",
        "half_sine(3 mm, 0.1 s, 0.3 s)",
        "table(\"road.csv\", speed = 5 m/s)",
        "harmonic(2 m/s^2, 1.5 Hz)",
        "half_sine(2 m/s^2, 0.1 s, 0.4 s)",
        "pulse(0.1 m/s, 0.1 s, 0.4 s)",
    ] {
        let model = format!(
            "body a {{ mass = 2 kg, moves y }}\nbody b {{ mass = 2 kg, moves y }}\n\
             base rear {{ moves y }} = delayed(middle, 0.25 s)\nbase front {{ moves y }} = {signal}\n\
             base middle {{ moves y }} = delayed(front, 0.5 s)\n\
             spring s: front -- a {{ k = 50 N/m }}\nspring t: rear -- b {{ k = 50 N/m }}\n\
             damper c: front -- a {{ c = 1 N*s/m }}\ndamper d: rear -- b {{ c = 1 N*s/m }}\noutput first = a.y\noutput second = b.y\n"
        );
        let rows = simulated(&model, &table, &["--until", "3 s", "--step", "0.05 s"]);
        let scale = rows.iter().map(|row| row[1].abs()).fold(0.0, f64::max);
        assert!(scale > 1e-4, "{signal}");
        for (i, row) in rows.iter().enumerate() {
            let before = i.checked_sub(15).map_or(0.0, |i| rows[i][1]);
            assert!((row[2] - before).abs() < 1e-13 * scale, "{signal} at {}: {} {before}", row[0], row[2]);
        }
    }
}

/// The same record in other units, in the call, in the heading, and with a distance for the time.
#[test]
fn a_table_has_the_unit_that_it_is_given() {
    let run = |signal: &str, table: &str| {
        let model = SHAKEN.replace("SIGNAL", signal);
        simulated(&model, &[("r.csv", table)], &["--until", "2 s", "--step", "0.25 s"])
    };
    let plain = run("table(\"r.csv\", 1 m)", "0, 0\n0.5, 0.25\n1.5, -1\n");
    for (signal, table) in [
        ("table(\"r.csv\", 1 mm)", "0, 0\n0.5, 250\n1.5, -1000\n"),
        ("table(\"r.csv\", 2 mm)", "0, 0\n0.5, 125\n1.5, -500\n"),
        ("table(\"r.csv\")", "t [ms], y [cm]\n0, 0\n500, 25\n1500, -100\n"),
        ("table(\"r.csv\", 1 cm)", "t [ms], y [cm]\n0, 0\n500, 25\n1500, -100\n"),
        ("table(\"r.csv\", 1 m, speed = 4 m/s)", "0, 0\n2, 0.25\n6, -1\n"),
        ("table(\"r.csv\", speed = 4 m/s)", "s [mm], y [m]\n0, 0\n2000, 0.25\n6000, -1\n"),
    ] {
        assert_eq!(run(signal, table), plain, "{signal}");
    }
    let quake = run("table(\"r.csv\", 1 m/s^2)", "0, 0\n0.5, 0.980665\n1, 0\n");
    assert_eq!(run("table(\"r.csv\", 1 g0)", "0, 0\n0.5, 0.1\n1, 0\n"), quake);
    assert_eq!(run("table(\"r.csv\")", "time [s], acc [g0]\n0, 0\n0.5, 0.1\n1, 0\n"), quake);
}

/// One finding for each way in which the words of a signal and its table do not fit.
#[test]
fn misfitting_signals_are_found() {
    let bare = "0, 0\n1, 2\n";
    for (signal, table, wanted) in [
        ("table(\"r.csv\")", bare, "vib::table::unit"),
        ("table(\"r.csv\")", "t, acc\n0, 0\n1, 2\n", "vib::table::heading"),
        ("table(\"r.csv\", 1 mm)", "t, acc\n0, 0\n1, 2\n", "vib::table::heading"),
        ("table(\"r.csv\", 1 g0)", "t, acc\n0, 0\n1, 2\n", ""),
        ("table(\"r.csv\", 1 g0)", "t, acc [m/s^2]\n0, 0\n1, 2\n", "vib::table::units_differ"),
        ("table(\"r.csv\")", "t, acc [g]\n0, 0\n1, 2\n", "vib::table::heading"),
        ("table(\"r.csv\")", "t, acc [wow]\n0, 0\n1, 2\n", "vib::unit::unknown"),
        ("table(\"r.csv\")", "s [m], y [m]\n0, 0\n1, 2\n", "vib::table::first_column"),
        ("table(\"r.csv\", speed = 1 m/s)", "t [s], y [m]\n0, 0\n1, 2\n", "vib::table::first_column"),
        ("table(\"r.csv\", speed = 0 m/s)", "s [m], y [m]\n0, 0\n1, 2\n", "vib::table::scale"),
        ("table(\"r.csv\", 0 m)", bare, "vib::table::scale"),
        ("table(\"r.csv\", 1 N)", bare, "vib::unit::mismatch"),
        ("table(\"r.csv\", fast = 1 m/s)", bare, "vib::signal::arguments"),
        ("step(1 m, 0 s) + step(1 m/s, 0 s)", bare, "vib::signal::differ"),
        ("constant(1 m/s)", bare, "vib::signal::constant_rate"),
        ("delayed(g, 1 s)", bare, "vib::signal::cycle"),
        ("delayed(g, -1 s)", bare, "vib::signal::delayed"),
        ("delayed(b, 1 s)", bare, "vib::measure::input"),
        ("delayed(nobody, 1 s)", bare, "vib::part::unknown"),
        ("step(1 m, 0 s) + delayed(g, 1 s)", bare, "vib::signal::delayed"),
        ("trapezoid(1 mm, 0 s, 2 s, 1 s, 3 s)", bare, "vib::signal::times"),
        ("step(speed = 1 m)", bare, "vib::signal::arguments"),
    ] {
        assert_eq!(code(&SHAKEN.replace("SIGNAL", signal), &[("r.csv", table)]), wanted, "{signal} {table}");
    }
}
