//! Outputs in units of the user's choice: the same motion, divided by the unit, wherever it is shown, and nowhere else.
//! See spec.md#outputs.

use crate::program::{json, text};
use serde_json::Value;
use std::fs;
use std::process::Command;

/// A pendulum on a cart with a base, a step and a harmonic, and UNITS in the place of each unit.
const SCENE: &str = "gravity 9.81 m/s^2
base   floor { moves x }
body   cart  { mass = 1 kg, moves x }
body   rod   { mass = 1 kg, shape = rod((0, 0), (0, -2 m)) }
pivot  p: cart@(0, 0) -- rod
spring s: floor -- cart { k = 10 N/m }
damper d: floor -- cart { c = 1 N*s/m }
force  F: cart along x = step(1 N, 0 s) + harmonic(2 N, 1 Hz)
output tip {0} = rod@(0, -2 m).x - floor.x
output theta {1} = rod.angle
output w {2} = rod.omega
output bearing {3} = p.fy + p.fx
output share {4} = s.stretch / 0.3 m
";

/// The units, and the SI value of one of each.
const UNITS: [(&str, f64); 5] = [
    ("in mm", 1e-3),
    ("in deg", std::f64::consts::PI / 180.0),
    ("in rpm", std::f64::consts::PI / 30.0),
    ("in lbf", 4.448_221_615_260_5),
    ("in %", 0.01),
];

fn scene(own: bool) -> String {
    let unit = |unit: &'static str| if own { unit } else { "" };
    (UNITS.iter().enumerate())
        .fold(SCENE.to_string(), |text, (i, (word, _))| text.replace(&format!("{{{i}}}"), unit(word)))
}

fn near(own: f64, si: f64, unit: f64) {
    assert!((own * unit - si).abs() <= 4e-16 * si.abs(), "{own} of {unit} is not {si}");
}

#[test]
fn samples_and_gains_are_divided_by_the_unit() {
    let run = ["simulate", "--until", "2 s", "--step", "0.25 s"];
    let [own, si] = [true, false].map(|own| json(&scene(own), &run));
    for (i, (word, unit)) in UNITS.iter().enumerate() {
        let (own, si) = (&own["outputs"][i], &si["outputs"][i]);
        assert_eq!(own["unit"].as_str(), word.strip_prefix("in "), "{own}");
        let values = |of: &Value| of["values"].as_array().expect("values").clone();
        assert_eq!(values(own).len(), 9);
        for (own, si) in values(own).iter().zip(values(si)) {
            near(own.as_f64().expect("a number"), si.as_f64().expect("a number"), *unit);
        }
    }
    let run = ["transfer", "--at", "0.7 Hz"];
    let [own, si] = [true, false].map(|own| json(&scene(own), &run));
    let pairs = own["pairs"].as_array().expect("pairs");
    assert_eq!(pairs.len(), 10);
    for (pair, si) in pairs.iter().zip(si["pairs"].as_array().expect("pairs")) {
        let (word, unit) =
            UNITS[UNITS.iter().position(|(word, _)| Some(&word[3..]) == pair["output_unit"].as_str()).unwrap()];
        assert!(!word.is_empty());
        let gain = |pair: &Value| pair["values"][0]["gain"].as_f64().expect("a gain");
        near(gain(pair), gain(si), unit);
    }
}

#[test]
fn headings_of_csv_and_code_name_the_unit() {
    let run = ["simulate", "--until", "1 s", "--step", "0.5 s"];
    let first = |model: &str, more: &[&str]| {
        let all = text(model, &[&run[..], more].concat());
        all.lines().next().expect("a heading").to_string()
    };
    assert_eq!(first(&scene(false), &[]), "time_s,tip,theta,w,bearing,share");
    assert_eq!(first(&scene(true), &[]), "time_s,tip [mm],theta [deg],w [rpm],bearing [lbf],share [%]");
    assert!(first(&scene(true), &["--bounds"]).starts_with("time_s,tip [mm],tip_bound,theta [deg],theta_bound"));
    let si = scene(true).replace("in mm", "in m").replace("in deg", "in rad");
    assert!(first(&si, &[]).starts_with("time_s,tip,theta,w [rpm]"));
    let code = text(&scene(true), &["emit", "--target", "c", "--step", "1 ms"]);
    assert!(code.contains("double tip; /* tip in mm */"), "{code}");
}

/// What a model asks and the equations that it has are the same in any unit.
#[test]
fn measures_and_equations_do_not_change() {
    let asks = "require peak(tip) < 4 m\nrequire gain(F -> theta, 1 Hz) < 90 deg/N\nrequire static(bearing) < 100 N\n";
    let run = |own: bool, arguments: &[&str]| text(&(scene(own) + asks), arguments);
    assert_eq!(run(true, &["check"]), run(false, &["check"]));
    let equations = |own: bool| text(&scene(own), &["equations"]);
    assert_eq!(equations(true), equations(false));
    assert!(equations(true).contains("tip/F"));
}

#[test]
fn a_unit_that_does_not_fit_is_found() {
    let code = |output: &str| {
        let model = scene(false).replace("output w  =", output).replace("output w =", output);
        crate::program::code(&model, &["check"])
    };
    for output in ["output w in mm =", "output w in dB =", "output w in kg*m^2/s ="] {
        assert_eq!(code(output), "vib::unit::mismatch", "{output}");
    }
    assert_eq!(code("output w in Hz ="), "vib::unit::frequency");
    assert_eq!(code("output w in rpmm ="), "vib::unit::unknown");
    assert_eq!(code("output w in m/s*s ="), "vib::unit::ambiguous");
    for output in
        ["output w in =", "output w in 3 rpm =", "output w rpm =", "output w in /s =", "output w in \"rpm\" ="]
    {
        assert_eq!(code(output), "vib::syntax::unexpected", "{output}");
    }
}

#[test]
fn the_layout_leaves_a_unit_as_it_is() {
    let laid = |model: &str| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("m.vib");
        fs::write(&path, model).expect("a file");
        let done = Command::new(env!("CARGO_BIN_EXE_vibc")).arg("fmt").arg(&path).output().expect("the program starts");
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        fs::read_to_string(&path).expect("the file")
    };
    for unit in ["mm", "N*m/rad^2", "N·m²", "%", "°", "m^-3*m^4"] {
        let model = format!("output x in {unit} = b.x\n");
        assert_eq!(laid(&model), model);
    }
    assert_eq!(laid("output   x   in   mm=b.x\n"), "output x in mm = b.x\n");
}
