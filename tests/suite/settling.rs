//! Settling time and overshoot beside closed forms, and the reasons why there is none. See
//! docs/method/measures.md#settling-and-overshoot.

use crate::program::json;
use serde_json::Value;
use std::f64::consts::PI;

/// The rows of the requirements of a model.
fn rows(model: &str) -> Vec<Value> {
    json(model, &["analyze"])["requirements"].as_array().cloned().unwrap_or_default()
}

fn number(row: &Value, field: &str) -> f64 {
    row[field].as_f64().unwrap_or_else(|| panic!("{field} in {row}"))
}

/// The value holds its relative bound, up to the rounding of the truth, and the bound is sharp.
fn meets(row: &Value, truth: f64) {
    let (value, bound) = (number(row, "value"), number(row, "error_bound"));
    assert!((value - truth).abs() <= bound * truth.abs() + 1e-13 * truth.abs(), "{value:e} ± {bound:e}, not {truth:e}");
    assert!(bound < 1e-13, "{bound:e}");
}

fn oscillator(c: f64, signal: &str, asked: &[&str]) -> String {
    let asked: String = asked.iter().map(|asked| format!("require {asked}\n")).collect();
    format!(
        "body b {{ mass = 1 kg, moves x }}\nspring s: ground -- b {{ k = 4 N/m }}\n\
         damper d: ground -- b {{ c = {c} N*s/m }}\nforce F: b along x = {signal}\noutput x = b.x\n{asked}"
    )
}

/// The unit step response of the oscillator above, minus its end, as a part of it.
fn apart(c: f64, t: f64) -> f64 {
    let (rate, wd) = (c / 2.0, (4.0 - c * c / 4.0).sqrt());
    -(-rate * t).exp() * ((wd * t).cos() + rate / wd * (wd * t).sin())
}

/// The last time at which it is at or above a band: between the last swing above it and the next zero.
fn last_outside(c: f64, band: f64) -> f64 {
    let (rate, wd) = (c / 2.0, (4.0 - c * c / 4.0).sqrt());
    let swings = (-band.ln() / rate * wd / PI).floor();
    let (mut low, mut high) = (swings * PI / wd, (swings + 1.0) * PI / wd);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if apart(c, middle).abs() >= band { low = middle } else { high = middle }
    }
    low
}

#[test]
fn an_oscillator_settles_by_its_closed_form() {
    for c in [2.0, 0.8, 0.1, 3.9] {
        for band in [0.02, 0.05, 0.3, 1e-5] {
            let settling = format!("settling(x, {}) < 1000 s", band);
            let model = oscillator(c, "step(-3 N, 0 s)", &[&settling, "overshoot(x) < 200 %"]);
            let found = rows(&model);
            meets(&found[0], last_outside(c, band));
            let (rate, wd) = (c / 2.0, (4.0 - c * c / 4.0_f64).sqrt());
            meets(&found[1], (-rate * PI / wd).exp());
        }
    }
}

/// A later step moves everything with it; the time is counted from t = 0. A step and a pulse add up.
#[test]
fn times_are_counted_from_the_beginning() {
    let found = rows(&oscillator(2.0, "step(3 N, 1.5 s)", &["settling(x, 2 %) < 9 s", "overshoot(x) < 1"]));
    meets(&found[0], 1.5 + last_outside(2.0, 0.02));
    let found = rows(&oscillator(2.0, "step(3 N, 0 s) + pulse(6 N, 0 s, 50 s)", &["settling(x, 200e-1 %) < 99 s"]));
    // At 50 s two thirds of 9 N go: 6 N are left over 3 N, as a step from twice the end.
    let (mut low, mut high) = (50.0, 53.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if 2.0 * apart(2.0, middle - 50.0).abs() >= 0.2 { low = middle } else { high = middle }
    }
    let value = number(&found[0], "value");
    let again = 50.0 + (PI / 3f64.sqrt());
    let truth = if 2.0 * apart(2.0, again - 50.0).abs() >= 0.2 { last(again) } else { low };
    assert!((value - truth).abs() < 1e-11, "{value} {truth}");
}

/// The crossing after a swing at `from`.
fn last(from: f64) -> f64 {
    let (mut low, mut high) = (from, from + PI / 3f64.sqrt());
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if 2.0 * apart(2.0, middle - 50.0).abs() >= 0.2 { low = middle } else { high = middle }
    }
    low
}

/// Critical damping: (1 + 2 t) exp(-2 t) is the band, and nothing goes beyond the end, to 20 digits.
#[test]
fn what_creeps_does_not_overshoot() {
    let found = rows(&oscillator(4.0, "step(1 N, 0 s)", &["settling(x, 2 %) < 9 s", "overshoot(x) < 1e-15"]));
    let (mut low, mut high) = (0.0f64, 20.0);
    for _ in 0..60 {
        let t = 0.5 * (low + high);
        if (1.0 + 2.0 * t) * (-2.0 * t).exp() >= 0.02 { low = t } else { high = t }
    }
    meets(&found[0], low);
    assert_eq!(found[1]["holds"], true);
    assert!(number(&found[1], "value").abs() < 1e-19);
}

/// An output that jumps to its end: of a base that a block without mass follows, and of a reaction.
#[test]
fn an_output_may_be_at_its_end_at_once() {
    let model = "base g { moves x }\nbody b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 4 N/m }\n\
                 damper d: ground -- b { c = 2 N*s/m }\nforce F: b along x = step(8 N, 0 s)\n\
                 require settling(b.ax * 0.25 s^2 + b.vx * 0.5 s + b.x, 2 %) < 1 s\n\
                 require overshoot(b.ax * 0.25 s^2 + b.vx * 0.5 s + b.x) < 1 %\n";
    let found = rows(model);
    assert!(found.iter().all(|row| row["holds"] == true), "{found:?}");
    assert!(number(&found[0], "value") < 1e-12 && number(&found[1], "value") < 1e-19, "{found:?}");
}

fn reason(model: &str) -> String {
    let output = crate::program::ran(model, &["check", "--message-format", "json"]);
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn what_has_no_end_has_no_value() {
    let model = |damper: &str, signal: &str| {
        format!(
            "body b {{ mass = 1 kg, moves x }}\nspring s: ground -- b {{ k = 4 N/m }}\n{damper}\
             force F: b along x = {signal}\noutput x = b.x\nrequire settling(x, 2 %) < 9 s\n"
        )
    };
    let damper = "damper d: ground -- b { c = 2 N*s/m }\n";
    for (text, why) in [
        (model("", "step(1 N, 0 s)"), "an oscillation has no damping"),
        (model("damper d: ground -- b { c = -1 N*s/m }\n", "step(1 N, 0 s)"), "a free motion grows"),
        (model(damper, "pulse(1 N, 0 s, 1 s)"), "the final value is zero"),
        (model(damper, "step(1 N, 0 s) + harmonic(1 N, 1 Hz)"), "a signal goes on forever"),
        (model(damper, "step(1 N, 0 s) + noise(white 3 N^2/Hz)"), "noise reaches it"),
        // The end of a chirp's integral is no quotient of its numbers.
        (
            "base g { moves x } = chirp(2 m/s^2, 1 Hz, 5 Hz, 3 s)\nbody b { mass = 1 kg, moves x }\n\
             spring s: g -- b { k = 4 N/m }\ndamper d: g -- b { c = 2 N*s/m }\nrequire static(b.x - g.x) > -1 m\n"
                .to_string(),
            "no final value is computed under such a signal",
        ),
        (
            "body b { mass = 1 kg, moves x }\ndamper d: ground -- b { c = 2 N*s/m }\n\
             force F: b along x = step(1 N, 0 s)\nrequire overshoot(b.vx) < 1 %\n"
                .to_string(),
            "a rigid motion has no end",
        ),
    ] {
        let told = reason(&text);
        assert!(told.contains(why) && told.contains("vib::require::no_value"), "{why}: {told}");
    }
}

/// The damper at which an oscillator goes 10 % beyond its end: zeta = -ln(0.1) / sqrt(pi^2 + ln(0.1)^2), c = 4 zeta.
#[test]
fn a_damper_is_found_by_its_overshoot() {
    let model = oscillator(1.0, "step(1 N, 0 s)", &[]).replace("c = 1 N*s/m", "c = c")
        + "param c = 1 N*s/m\nsolve c in 0.5 N*s/m .. 3 N*s/m: overshoot(x) = 10 %\n";
    let log = 0.1f64.ln();
    let truth = 4.0 * -log / (PI * PI + log * log).sqrt();
    let found = number(&json(&model, &["analyze"])["solved"][0], "value");
    assert!((found - truth).abs() < 1e-12, "{found} {truth}");
}

/// Two motions whose rates are a factor 1000 apart: the slow one decides, and its pieces are those of the fast one.
#[test]
fn slow_and_fast_motions_together() {
    let model = "body a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves y }\n\
                 spring s: ground -- a { k = 1 MN/m }\ndamper d: ground -- a { c = 100 N*s/m }\n\
                 spring t: ground -- b { k = 1 N/m }\ndamper e: ground -- b { c = 0.4 N*s/m }\n\
                 force F: a along x = step(2 MN, 0 s)\nforce G: b along y = step(2 N, 0 s)\n\
                 require settling(b.y, 1 %) < 99 s\nrequire settling(a.x, 1 %) < 1 s\n";
    let settled = |rate: f64, wd: f64, band: f64| {
        let at = |t: f64| ((wd * t).cos() + rate / wd * (wd * t).sin()).abs() * (-rate * t).exp();
        let swings = (-band.ln() / rate * wd / PI).floor();
        let (mut low, mut high) = (swings * PI / wd, (swings + 1.0) * PI / wd);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if at(middle) >= band { low = middle } else { high = middle }
        }
        low
    };
    let found = rows(model);
    meets(&found[0], settled(0.2, 0.96f64.sqrt(), 0.01));
    meets(&found[1], settled(50.0, (1e6 - 2500f64).sqrt(), 0.01));
}

/// A spring of next to nothing beside a damper: the slow decay takes 1e16 times as long as the fast one, which is said, at once.
#[test]
fn a_decay_that_takes_next_to_for_ever_is_refused_at_once() {
    let model = "body b { mass = 2 kg, moves x }\nspring s: ground -- b { k = 1e-14 N/m }\ndamper d: ground -- b { c = 32 N*s/m }\n\
                 force F: b along x = step(10 N, 0 s)\noutput x = b.x\nrequire settling(x, 2 %) < 1 s\nrequire overshoot(x) < 1 %\n";
    let output = crate::program::ran(model, &["check"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(said.matches("vib::require::no_value").count(), 2, "{said}");
    assert_eq!(said.matches("── the fastest motion has too many cycles").count(), 2, "{said}");
}
