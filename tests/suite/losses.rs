//! Loss factors of springs: closed forms in harmonic motion, and what is refused. See spec.md#springs-and-dampers.

use crate::program::{json, ran};
use std::f64::consts::PI;

const MODEL: &str = "body block { mass = 2 kg, moves x }\nbase floor { moves x }\n\
                     spring s: floor -- block { k = 200 N/m, loss = 0.1 }\ndamper d: floor -- block { c = 3 N*s/m }\n\
                     force F: block along x = harmonic(5 N, 1.5 Hz)\noutput x = block.x\noutput pull = s.force\n";

fn told(model: &str, arguments: &[&str]) -> String {
    String::from_utf8_lossy(&ran(model, arguments).stderr).into_owned()
}

/// x = (F + (k' + i c w) u) / (k' + i c w - m w^2) and pull = k' (x - u), k' = k (1 + 0.1 i); at 0 Hz k' = k.
#[test]
fn one_mass_has_the_closed_form() {
    let asked = ["transfer", "--at", "0Hz", "--at", "1.5Hz", "--at", "7Hz"];
    let table = json(MODEL, &asked);
    let mut compared = 0;
    for pair in table["pairs"].as_array().expect("pairs") {
        for row in pair["values"].as_array().expect("rows") {
            let number = |name: &str| row[name].as_f64().expect(name);
            let w = 2.0 * PI * number("frequency_hz");
            let lossy = (200.0, if w > 0.0 { 20.0 } else { 0.0 });
            let times = |a: (f64, f64), b: (f64, f64)| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
            let bottom = (lossy.0 - 2.0 * w * w, lossy.1 + 3.0 * w);
            let size = bottom.0 * bottom.0 + bottom.1 * bottom.1;
            let from_base = pair["input"] == "floor";
            let top = if from_base { (lossy.0, lossy.1 + 3.0 * w) } else { (1.0, 0.0) };
            let x = times(top, (bottom.0 / size, -bottom.1 / size));
            let stretch = (x.0 - if from_base { 1.0 } else { 0.0 }, x.1);
            let truth = if pair["output"] == "x" { x } else { times(lossy, stretch) };
            let off = (number("re") - truth.0).hypot(number("im") - truth.1);
            assert!(off <= 1e-12 * truth.0.hypot(truth.1).max(1e-9), "{pair} {truth:?}");
            // An enclosure of zero has no relative bound.
            assert!(row["error_bound"].as_f64().map_or(truth == (0.0, 0.0), |bound| bound < 1e-15), "{row}");
            compared += 1;
        }
    }
    assert_eq!(compared, 12);
}

/// |x| = 5 N / |k' + i c w - m w^2|, and its first natural frequency without damping is 10 rad/s.
#[test]
fn measures_of_harmonic_motion_have_it() {
    let w = 3.0 * PI;
    let gain = 1.0 / (200.0 - 2.0 * w * w).hypot(20.0 + 3.0 * w);
    let model = format!(
        "{MODEL}require gain(F -> x, 1.5 Hz) < 1 m/N\nrequire amplitude(x) < 1 m\nrequire frequency(1) < 2 Hz\n"
    );
    let answer = json(&model, &["analyze"]);
    let value = |row: usize| answer["requirements"][row]["value"].as_f64().expect("a value");
    assert!((value(0) - gain).abs() < 1e-15 && (value(1) - 5.0 * gain).abs() < 1e-15, "{answer}");
    assert_eq!(answer["poles"].as_array().map(Vec::len), Some(0));
    assert_eq!(answer["rest"]["kind"], "undetermined");
}

/// Nothing is computed as if the factor were not there.
#[test]
fn what_has_no_meaning_with_it_is_refused() {
    for arguments in [
        &["simulate", "--until", "1s", "--step", "0.1s"][..],
        &["emit", "--target", "c", "--step", "1ms"],
        &["equations"],
        &["bench"],
    ] {
        let text = told(MODEL, arguments);
        assert!(text.contains("vib::limit::loss"), "{arguments:?}: {text}");
    }
    assert!(told(MODEL, &["transfer"]).contains("not computed with loss factors"));
    for measure in
        ["damping(1) > 1 %", "stable", "peak(x) < 1 m", "peak_gain(F -> x) < 1 m/N", "settling(x, 2 %) < 1 s"]
    {
        let text = told(&format!("{MODEL}require {measure}\n"), &["check"]);
        assert!(text.contains("vib::require::no_value") && text.contains("loss factor"), "{measure}: {text}");
    }
    let noise = MODEL.replace("harmonic(5 N, 1.5 Hz)", "noise(white 3 N^2/Hz)");
    assert!(told(&noise, &["analyze"]).contains("vib::limit::loss"));
    let negative = MODEL.replace("loss = 0.1", "loss = -0.1");
    assert!(told(&negative, &["check"]).contains("vib::value::negative"));
    let law = MODEL.replace("k = 200 N/m", "law = 200 N/m * stretch");
    assert!(told(&law, &["check"]).contains("vib::law::and_coefficient"));
}

/// A loss factor of zero is none.
#[test]
fn zero_is_no_loss() {
    let plain = MODEL.replace(", loss = 0.1", "");
    let zero = MODEL.replace("loss = 0.1", "loss = 0");
    let report = |model: &str| ran(model, &["analyze"]).stdout;
    assert_eq!(report(&plain), report(&zero));
}
