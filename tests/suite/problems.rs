//! The six problems of MIT 2.003's problem set 10: each answer of the sheet, computed from the example's own text.

use std::fs;
use std::path::Path;
use vibc::analysis::grid;
use vibc::answers::ModalAnswer;
use vibc::base::{FileId, Number, Rational, SourceFile, Sources};
use vibc::model::Overrides;
use vibc::questions::answer::Value;

fn example(name: &str) -> (Sources, FileId) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/{name}.vib"));
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model(format!("{name}.vib"), fs::read_to_string(path).expect("an example")));
    (sources, file)
}

fn report(name: &str) -> ModalAnswer {
    let (sources, file) = example(name);
    let outcome = vibc::analyze(&sources, file, &Overrides::default());
    assert!(outcome.diagnostics.is_empty(), "{:?}", outcome.diagnostics);
    outcome.answer.expect("a report")
}

/// A solved parameter, in its own unit: its value is within its bound of the closed form, and the bound is small.
fn solved(report: &ModalAnswer, parameter: &str, unit: &str, truth: f64) {
    let found = report.solved.iter().find(|solved| solved.parameter == parameter).expect("solved for");
    let shown = found.in_unit();
    assert_eq!(shown.unit, unit);
    let off = (shown.number.to_f64() - truth).abs();
    // The closed form is rounded to binary64.
    assert!(
        off <= found.shown_bound().expect("proven").value() + 4e-16 * truth.abs(),
        "{parameter}: {shown:?} {truth}"
    );
    assert!(found.shown_bound().expect("proven").value() < 1e-20 * truth.abs(), "{parameter}: {found:?}");
}

/// The measured value of a requirement of the example.
fn measured(report: &ModalAnswer, measure: &str) -> f64 {
    let found = report.requirements.iter().find(|requirement| requirement.text.starts_with(measure));
    let found = found.expect("a requirement");
    assert_eq!(found.holds, Some(true));
    match &found.value {
        Value::Number(ball) => ball.to_f64(),
        other => panic!("{other:?}"),
    }
}

fn near(value: f64, truth: f64, relative: f64) {
    assert!((value / truth - 1.0).abs() <= relative, "{value} {truth}");
}

const TURN: f64 = std::f64::consts::TAU;

#[test]
fn cart_with_a_rod() {
    let report = report("cart");
    let omegas: Vec<f64> = report.modes.list.iter().map(|mode| mode.omega.to_f64()).collect();
    near(omegas[0], 2.158179, 1e-6);
    near(omegas[1], 3.747152, 1e-6);
    let ratio = |i: usize| report.modes.list[i].shape[1] / report.modes.list[i].shape[0];
    near(ratio(0), 1.2939, 1e-4);
    near(ratio(1), -1.5756, 1e-4);
}

#[test]
fn isolation_table() {
    let report = report("isolation_table");
    let fn_ = 30.0 / (1.0 + 10f64.powf(0.6)).sqrt();
    solved(&report, "fn", "Hz", fn_);
    // With a tenth of critical damping: |1 + 2 i zeta r| / |1 - r^2 + 2 i zeta r|.
    let r = 30.0 / fn_;
    let truth = 1f64.hypot(0.2 * r) / (1.0 - r * r).hypot(0.2 * r);
    near(measured(&report, "gain(floor -> yd"), truth, 1e-15);
    near(truth, 0.274, 3e-3);
}

#[test]
fn light_station() {
    let report = report("light_station");
    solved(&report, "F0", "N", 160.6878);
    near(measured(&report, "amplitude(x)"), 0.003 * 9.81 / (TURN * TURN), 1e-15);
}

#[test]
fn hinged_body() {
    let report = report("hinged_body");
    solved(&report, "kt", "N*m/rad", 800.0);
    solved(&report, "J", "kg*m^2", 800.0 / (TURN * 5.0).powi(2));
    assert_eq!(report.solved[0].value, Number::from(800), "found as the whole number that it is");
}

#[test]
fn stacked_blocks() {
    let report = report("stacked_blocks");
    near(report.modes.list[0].omega.to_f64(), 4.767313, 1e-6);
    solved(&report, "F0", "N", 0.35 * 9.81 * 2.0 * 0.05 * 11.0);
}

/// The motion after firing compared with its closed form, and the ratio of displacements five damped periods apart.
#[test]
fn mortar() {
    let report = report("mortar");
    near(measured(&report, "frequency(1)") * TURN, 1.2566, 2e-5);
    near(measured(&report, "damping(1)"), 0.01, 1e-4);
    let (sources, file) = example("mortar");
    let (m, k, c) = (10_000.0f64, 15_791.0f64, 251.33f64);
    let (w, decay) = ((k / m).sqrt(), c / (2.0 * m));
    let damped = (w * w - decay * decay).sqrt();
    let (x0, v0) = (25.0 * 9.81 / k, 25.0 * 150.0 / m);
    let times = grid(&Number::from(30), &Number::from(Rational::new(1, 4)));
    let motion = vibc::simulate(&sources, file, &Overrides::default(), &times).answer.expect("a motion");
    for (time, row) in motion.history.times.iter().zip(&motion.history.values) {
        let t = time.to_f64();
        let downwards =
            (-decay * t).exp() * (x0 * (damped * t).cos() + (v0 + decay * x0) / damped * (damped * t).sin());
        assert!((row[0].to_f64() + downwards).abs() < 1e-14, "{t}");
    }
    let five = TURN * 5.0 / damped;
    let times = [Number::ZERO, Number::from(Rational::from_f64(five).expect("finite"))];
    let motion = vibc::simulate(&sources, file, &Overrides::default(), &times).answer.expect("a motion");
    near(motion.history.values[1][0].to_f64() / motion.history.values[0][0].to_f64(), 0.7304, 1e-4);
}
