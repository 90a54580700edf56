//! Tables that come again: beside sums of closed forms, beside the same rows written out, and with their limits and findings.
//! See docs/method/response.md#signals.

use super::emit::options;
use super::emit_exact::{check_as, observed};
use super::signals::{code, meets, ramp, ran, simulated, step};
use super::systems::{Builder, number};
use vibc::analysis::Signal;
use vibc::analysis::discrete::{Options, discretise};
use vibc::base::Number;
use vibc::system::{Course, Table};

const BLOCK: &str = "body b { mass = 2 kg, moves x }\nspring s: ground -- b { k = 50 N/m }\n\
                     force F: b along x = SIGNAL\noutput x = b.x\n";
const SHAKEN: &str = "body b { mass = 2 kg, moves x }\nbase g { moves x } = SIGNAL\nspring s: g -- b { k = 50 N/m }\n\
                      output z = b.x - g.x\noutput u = g.x\noutput v = g.vx\noutput a = b.ax\n";

/// Four rows a quarter of a period apart, from 0 to 3, down to -1, up to 2 and back to the first row: ramps that change their
/// slopes at each row, for ever. The same signal with its last row written, and with rows that begin later in the period.
#[test]
fn lines_come_again_as_ramps_do() {
    let truth = |t: f64| {
        let slopes = [12.0, -16.0, 12.0, -8.0];
        (0..60)
            .map(|i| (slopes[i % 4] - if i == 0 { 0.0 } else { slopes[(i - 1) % 4] }) * ramp(t - 0.25 * i as f64))
            .sum()
    };
    let rows = [
        "t [s], F [N]\n0, 0\n0.25, 3\n0.5, -1\n0.75, 2\n",
        "t [s], F [N]\n0, 0\n0.25, 3\n0.5, -1\n0.75, 2\n1, 0\n",
        "t [s], F [N]\n0.25, 3\n0.5, -1\n0.75, 2\n1, 0\n",
        "t [s], F [N]\n-7.5, -1\n-7.25, 2\n-7, 0\n-6.75, 3\n-6.5, -1\n",
        "t [s], F [N]\n12.5, -1\n12.75, 2\n13, 0\n13.25, 3\n",
    ];
    for table in rows {
        let model = BLOCK.replace("SIGNAL", "periodic(table(\"f.csv\"), 1 s)");
        for step in ["0.07 s", "0.25 s", "3.1 s"] {
            let rows = simulated(&model, &[("f.csv", table)], &["--until", "13.02 s", "--step", step]);
            meets(&rows, 1, truth);
        }
    }
}

/// A sawtooth: where the last row is another value at the time of the next period's first row, the force jumps.
#[test]
fn a_force_may_jump_at_the_end_of_its_period() {
    let model = BLOCK.replace("SIGNAL", "periodic(table(\"f.csv\", 1 N), 0.8 s) + step(1 N, 0.5 s)");
    let rows = simulated(&model, &[("f.csv", "0, 1\n0.8, 5\n")], &["--until", "6 s", "--step", "0.05 s"]);
    meets(&rows, 1, |t| {
        let falls: f64 = (1..9).map(|k| 4.0 * step(t - 0.8 * f64::from(k))).sum();
        step(t) + 5.0 * ramp(t) - falls + step(t - 0.5)
    });
    let late = BLOCK
        .replace("SIGNAL", "periodic(table(\"f.csv\", 1 N), 0.8 s)")
        .replace("output", "force G: b along x = delayed(F, 0.3 s)\noutput");
    let rows = simulated(&late, &[("f.csv", "0, 1\n0.8, 5\n")], &["--until", "6 s", "--step", "0.05 s"]);
    let one = |t: f64| step(t) + 5.0 * ramp(t) - (1..9).map(|k| 4.0 * step(t - 0.8 * f64::from(k))).sum::<f64>();
    meets(&rows, 1, |t| one(t) + one(t - 0.3));
}

/// An acceleration 1, -1 in lines, a second apart, from the middle of the way down on. Motions of the
/// oscillator are those of ramps; as a velocity they are one derivative lower.
#[test]
fn a_base_moves_by_the_integrals_of_what_comes_again() {
    let table = [("a.csv", "t [s], a [m/s^2]\n-0.5, 1\n0.5, -1\n1.5, 1\n")];
    let rows = simulated(
        &SHAKEN.replace("SIGNAL", "periodic(table(\"a.csv\"), 2 s)"),
        &table,
        &["--until", "9 s", "--step", "0.05 s"],
    );
    let sign = |i: i32| if i % 2 == 0 { 4.0 } else { -4.0 };
    let corners =
        |t: f64, of: fn(f64) -> f64| -2.0 * of(t) + (0..12).map(|i| sign(i) * of(t - 0.5 - f64::from(i))).sum::<f64>();
    meets(&rows, 1, |t| -2.0 * corners(t, ramp));
    meets(&rows, 3, |t| corners(t, |t| t.max(0.0).powi(2) / 2.0));
    meets(&rows, 2, |t| corners(t, |t| t.max(0.0).powi(3) / 6.0));
    // As a velocity.
    let table = [("v.csv", "t [s], v [m/s]\n0, 0\n0.5, -1\n1.5, 1\n2, 0\n")];
    let model = SHAKEN.replace("SIGNAL", "periodic(table(\"v.csv\"), 2 s)");
    let rows = simulated(&model, &table, &["--until", "9 s", "--step", "0.05 s"]);
    meets(&rows, 3, |t| corners(t, |t| t.max(0.0)));
    meets(&rows, 2, |t| corners(t, |t| t.max(0.0).powi(2) / 2.0));
}

/// The closed spline through 0, 1, 0, -1: (3 s - s^3) / 2 from row to row, s from 0 to 1, as its bends are 0, -3, 0, 3 by symmetry.
/// The base is on it from t = 0 on, with its velocity.
#[test]
fn a_displacement_comes_again_without_a_kink() {
    let truth = |t: f64| {
        let (row, s) = ((4.0 * t).floor(), (4.0 * t).fract());
        let rise = |s: f64| 0.5 * s * (3.0 - s * s);
        let [up, sign] = [row.rem_euclid(2.0), if row.rem_euclid(4.0) < 2.0 { 1.0 } else { -1.0 }];
        sign * if up == 0.0 { rise(s) } else { rise(1.0 - s) }
    };
    for (table, shift) in [
        ("t [s], u [mm]\n0, 0\n0.25, 1\n0.5, 0\n0.75, -1\n", 0.0),
        ("t [s], u [mm]\n0, 0\n0.25, 1\n0.5, 0\n0.75, -1\n1, 0\n", 0.0),
        ("t [s], u [mm]\n0.1, 0\n0.35, 1\n0.6, 0\n0.85, -1\n1.1, 0\n", 0.9),
    ] {
        let model = SHAKEN.replace("SIGNAL", "periodic(table(\"u.csv\"), 1 s)");
        let rows = simulated(&model, &[("u.csv", table)], &["--until", "4 s", "--step", "0.03 s"]);
        for row in &rows[1..] {
            let (found, truth) = (row[2], 1e-3 * truth(row[0] + shift));
            assert!((found - truth).abs() < 1e-17, "t = {}: {found:e}, not {truth:e}", row[0]);
        }
        // The motion of the mass follows from that of the base: b'' = -25 z, checked by differences of its acceleration.
        let h = 0.03;
        let speed = |at: usize| (rows[at + 1][2] - rows[at - 1][2]) / (2.0 * h);
        let worst = (2..rows.len() - 2).map(|at| (rows[at][3] - speed(at)).abs()).fold(0.0, f64::max);
        assert!(worst < 2e-4, "{worst:e}");
        assert!(rows.iter().all(|row| (row[4] + 25.0 * row[1]).abs() < 1e-15));
    }
}

/// The largest value and the root of the mean square over whole periods, of an output that is the signal itself.
#[test]
fn peaks_and_means_of_what_comes_again() {
    let model = "body b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 9 N/m }\n\
                 base g { moves x } = periodic(table(\"u.csv\"), 1 s)\nspring t: g -- b { k = 1 N/m }\noutput u = g.x\n\
                 require peak(u) < 1 m\nrequire rms(u) < 1 m\n";
    // The square of (3 s - s^3) / 2 has the mean (9/3 - 6/5 + 1/7) / 4 = 17/35.
    let table = [("u.csv", "t [s], u [m]\n0, 0\n0.25, 1\n0.5, 0\n0.75, -1\n")];
    let output = ran(model, &table, &["analyze", "--until", "3 s", "--format", "json"]);
    let text = String::from_utf8_lossy(&output.stdout);
    let report: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let value = |at: usize| report["requirements"][at]["value"].as_f64().unwrap_or_else(|| panic!("{text}"));
    assert!((value(0) - 1.0).abs() < 1e-14, "{}", value(0));
    assert!((value(1) - (17.0_f64 / 35.0).sqrt()).abs() < 1e-14, "{}", value(1));
}

/// `static` is about the mean of the signal: 9/8 N of the lines, 0 and 1/48 h^2 of a bend of the spline.
#[test]
fn the_final_value_is_about_the_mean() {
    let value = |model: &str, table: &str| {
        let output = ran(model, &[("f.csv", table)], &["analyze", "--format", "json"]);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let report: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        report["requirements"][0]["value"].as_f64().unwrap_or_else(|| panic!("{text}"))
    };
    let model = format!("{}require static(x) < 1 m\n", BLOCK.replace("SIGNAL", "periodic(table(\"f.csv\", 1 N), 1 s)"));
    assert!((value(&model, "0, 0\n0.25, 3\n0.5, -1\n0.75, 2.5\n") - 1.125 / 50.0).abs() < 1e-17);
    // Values 0, 1, 0, 0 at 0, 1, 2, 3 of 4: bends b = M^-1 r of the circulant (4, 1, 0, 1) with r = 6 (1, -2, 1, 0), whose sum is zero.
    let model = "body b { mass = 2 kg, moves x }\nbase g { moves x } = periodic(table(\"f.csv\", 1 m), 4 s)\n\
                 spring s: g -- b { k = 50 N/m }\noutput x = b.x\nrequire static(x) < 1 m\n";
    assert!((value(model, "0, 0\n1, 1\n2, 0\n3, 0\n") - 0.25).abs() < 1e-15);
    // Uneven rows: 0, 1, 0 at 0, 1, 2 of 4. By symmetry about 1 the bends at 0 and 2 are equal: p; at 1 q. Rows: 2 (2 + 1) p + 2 p + q
    // = 6 (1 - 0) and 4 q + 2 p = -12; p = 6/5, q = -18/5. Area 1 - ((p + q) + (q + p) + 8 (2 p)) / 24 = 1 - 3/5.
    assert!((value(model, "0, 0\n1, 1\n2, 0\n4, 0\n") - 0.1).abs() < 1e-15);
}

#[test]
fn what_has_no_end_says_so() {
    let table = [("f.csv", "0, 0\n0.25, 3\n0.5, -1\n0.75, 2\n")];
    let damped = |more: &str| {
        format!(
            "{}damper d: ground -- b {{ c = 1 N*s/m }}\n{more}",
            BLOCK.replace("SIGNAL", "periodic(table(\"f.csv\", 1 N), 1 s)")
        )
    };
    for (measure, why) in [
        ("amplitude(x) < 1 m", "no input has a harmonic signal"),
        ("settling(x, 2 %) < 1 s", "a signal goes on forever"),
    ] {
        let output = ran(&damped(&format!("require {measure}\n")), &table, &["analyze"]);
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(text.contains(why), "{text}");
    }
    let both = damped("require amplitude(x) < 1 m\n").replace(", 1 s)", ", 1 s) + harmonic(1 N, 1 Hz)");
    let output = ran(&both, &table, &["analyze"]);
    assert!(String::from_utf8_lossy(&output.stdout).contains("a table that comes again has many harmonics"));
    let shaken = SHAKEN.replace("SIGNAL", "periodic(table(\"f.csv\", 1 m/s^2), 1 s)");
    let output = ran(&shaken, &table, &["shock", "--range", "1 Hz..10 Hz"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("its signal never ends"), "{output:?}");
    // A hundred days of a second.
    let output = ran(&damped(""), &table, &["simulate", "--until", "8640000 s", "--step", "3600 s"]);
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && text.contains("vib::limit::signal"), "{text}");
}

/// Each period that cannot be meant, once and at its place.
#[test]
fn a_wrong_period_is_found() {
    let rows = "0, 0\n0.25, 3\n0.5, -1\n0.75, 2\n";
    let found = |signal: &str| code(&BLOCK.replace("SIGNAL", signal), &[("f.csv", rows)]);
    for (period, wanted) in [
        ("1 s", ""),
        ("0.75 s", ""),
        ("0.74 s", "vib::signal::period"),
        ("1.01 s", "vib::signal::period"),
        ("0 s", "vib::signal::period"),
        ("-1 s", "vib::signal::period"),
        ("1 Hz", "vib::unit::mismatch"),
        ("1", "vib::unit::missing"),
    ] {
        assert_eq!(found(&format!("periodic(table(\"f.csv\", 1 N), {period})")), wanted, "{period}");
    }
    assert_eq!(found("periodic(step(1 N, 0 s), 1 s)"), "vib::signal::arguments");
    assert_eq!(found("periodic(3 N, 1 s)"), "vib::signal::arguments");
    assert_eq!(found("periodic(table(\"f.csv\", 1 N))"), "vib::signal::arguments");
    assert_eq!(found("periodic(table(\"f.csv\", 1 m), 1 s)"), "vib::unit::mismatch");
    let moved = |rows| {
        let model = SHAKEN.replace("SIGNAL", "periodic(table(\"f.csv\", 1 m), 1 s)");
        code(&model, &[("f.csv", rows)])
    };
    assert_eq!(moved("0, 0\n0.5, 1\n1, 0.1\n"), "vib::signal::period");
    assert_eq!(moved("0, 0\n0.5, 1\n1, 0\n"), "");
}

/// A velocity with a mean, an acceleration with one, and one that leaves a velocity: 1, -1 from its top on gives 1/4 m/s on average.
#[test]
fn drifts_are_noted() {
    let told = |signal: &str, rows: &str| {
        let (model, tables) = (SHAKEN.replace("SIGNAL", signal), [("f.csv", rows)]);
        let output = ran(&model, &tables, &["simulate", "--until", "3 s", "--step", "1 s"]);
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let velocity = "periodic(table(\"f.csv\", 1 m/s), 2 s)";
    let acceleration = "periodic(table(\"f.csv\", 1 m/s^2), 2 s)";
    assert!(told(velocity, "0, 0\n1, 1\n2, 0\n").contains("this velocity has the mean 0.5 m/s over a period"));
    assert!(!told(velocity, "0, 0\n0.5, 1\n1.5, -1\n2, 0\n").contains("drift"));
    assert!(told(acceleration, "0, 0\n1, 1\n2, 0\n").contains("this acceleration has the mean 0.5 m/s^2"));
    assert!(!told(acceleration, "0, 1\n1, -1\n2, 1\n").contains("drift"));
    // From 0: sin-like lines up to 1 at 0.5, down to -1 at 1.5: the velocity is 0 .. 1/2, its mean 1/4.
    let note = told(acceleration, "0, 0\n0.5, 1\n1.5, -1\n2, 0\n");
    assert!(note.contains("moves away at about 0.25 m/s"), "{note}");
    let note = told(acceleration, "0.5, 1\n1.5, -1\n2.5, 1\n");
    assert!(note.contains("moves away at about 0.25 m/s"), "{note}");
    // More periods before the first row than a computer counts: a limit, and nothing about a mean.
    let far = "1000000000000000000000, 0\n1000000000000000000001, 1\n1000000000000000000002, 0\n";
    let refused = told(velocity, far);
    assert!(refused.contains("vib::limit::signal") && !refused.contains("mean"), "{refused}");
    // At the base, not at the first body.
    assert!(refused.contains("m.vib:2:6]"), "{refused}");
}

/// Emitted code goes on for ever with the rows of one period, beside other signals and delays, with steps that divide the period, that
/// do so only after several periods, and that are longer; a period that no number of steps meets is refused, and a drift.
#[test]
fn code_repeats_a_period() {
    let mut b = Builder::numbered(2);
    for (i, (k, c)) in [("90", "0.7"), ("400", "0.1")].iter().enumerate() {
        b.mass(i, &Number::ONE);
        b.spring(None, i, &number(k));
        b.damper(None, i, &number(c));
    }
    let system = observed(&b.finish());
    let row = |i: i64| (&Number::from(i * i % 17 - 8) / &Number::from(5), &Number::from(i) / &number("20"));
    let (values, times): (Vec<Number>, Vec<Number>) = (2..9).map(row).unzip();
    let table = |course| {
        let (times, values) = (times.clone(), values.clone());
        Signal::Table(Table { times, values, course, period: Some(number("0.35")) })
    };
    let late = |signal: Signal| Signal::Delayed { of: Box::new(signal), by: number("0.31") };
    let pulse = Signal::Pulse { value: number("3"), from: number("0.2"), to: number("2.71") };
    let impulse = Signal::Impulse { value: number("0.1"), at: number("1.003") };
    for drives in [
        vec![vec![table(Course::Lines)], vec![late(table(Course::Spline)), pulse.clone()]],
        vec![vec![impulse, table(Course::Spline)], vec![pulse]],
    ] {
        for step in ["0.01", "0.007", "0.02", "0.4"] {
            let wanted = Options { built_in: true, internal: drives.clone(), ..options(step) };
            check_as(5001, "again", &system, &drives, step, &wanted, 1e-12);
        }
    }
    let modes = vibc::analysis::modes(&system).expect("modes");
    let refused = |signal: Signal, step: &str| {
        let internal = vec![vec![signal], Vec::new()];
        let wanted = Options { built_in: true, internal, ..options(step) };
        discretise(&system, &modes, &wanted).expect_err("a refusal").to_diagnostic().message
    };
    let message = refused(table(Course::Lines), "0.0100000001");
    assert!(message.contains("not after whole steps"), "{message}");
    let drifting = Signal::Integral { of: Box::new(table(Course::LinesToZero)), times: 1 };
    assert!(refused(drifting, "0.01").contains("comes again"));
}
