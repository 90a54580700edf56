//! A rotating unbalance: closed forms of the machine on a spring, the two components together beside a solution in complex
//! numbers, the forces that it stands for, and what is refused. See spec.md#unbalance.

use crate::program::{code, json, ran};
use serde_json::Value;
use std::f64::consts::{PI, TAU};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is a number"))
}

fn near(found: f64, truth: f64, share: f64) {
    assert!((found - truth).abs() <= share * truth.abs(), "{found:e}, not {truth:e}");
}

const M: f64 = 50.0;
const K: f64 = 2e6;
const C: f64 = 1e3;
const MACHINE: &str = "body frame { mass = 50 kg, moves y }\nspring s: ground -- frame { k = 2 MN/m }\n\
    damper d: ground -- frame { c = 1 kN*s/m }\nunbalance U: frame { me = 0.02 kg*m FIELDS }\n\
    output y = frame.y\noutput foot = s.force + d.force\noutput rails = frame.support_x\n";

fn machine(fields: &str) -> String {
    MACHINE.replace("FIELDS", fields)
}

/// (omega^2, omega^2 (k + i omega c)) / (k - m omega^2 + i omega c), per kg m: gain and phase.
fn closed(hertz: f64) -> [(f64, f64); 2] {
    let w = TAU * hertz;
    let below = (K - M * w * w).hypot(w * C);
    let lag = (w * C).atan2(K - M * w * w);
    [(w * w / below, -lag), (w * w * K.hypot(w * C) / below, (w * C).atan2(K) - lag)]
}

#[test]
fn a_machine_on_a_spring_has_its_closed_form() {
    for hertz in [0.5, 25.0, 31.83, 90.0] {
        let table = json(&machine(""), &["transfer", "--at", &format!("{hertz} Hz")]);
        let pairs = table["pairs"].as_array().expect("pairs");
        let of = |input: &str, output: &str| {
            let found = pairs.iter().find(|pair| pair["input"] == input && pair["output"] == output);
            let pair = found.unwrap_or_else(|| panic!("{input} -> {output} in {table}"));
            assert_eq!(pair["input_unit"], "kg*m");
            pair["values"][0].clone()
        };
        for (output, (gain, phase)) in ["y", "foot"].into_iter().zip(closed(hertz)) {
            near(number(&of("U.y", output)["gain"]), gain, 1e-13);
            near(number(&of("U.y", output)["phase_deg"]), phase * 180.0 / PI, 1e-11);
            assert_eq!(number(&of("U.x", output)["gain"]), 0.0);
        }
        // The rails hold what the frame cannot follow.
        let w = TAU * hertz;
        near(number(&of("U.x", "rails")["re"]), -w * w, 1e-14);
        assert_eq!(number(&of("U.y", "rails")["gain"]), 0.0);
    }
    // The largest gain is m e/m / (2 zeta sqrt(1 - zeta^2)) at omega_n / sqrt(1 - 2 zeta^2): zeta is 5 %.
    let zeta = C / (2.0 * (K * M).sqrt());
    let peak = 1.0 / M / (2.0 * zeta * (1.0 - zeta * zeta).sqrt());
    let asked = format!(
        "{}require {} m/kg/m < peak_gain(U.y -> y) < {} m/kg/m\n",
        machine(""),
        peak * 0.999_999_999,
        peak * 1.000_000_001
    );
    assert!(ran(&asked, &["check"]).status.success());
}

const FREE: &str = "body frame { mass = 50 kg, at = (0, 0), inertia = 2 kg*m^2, free }
spring a: ground@(-0.5 m, -1 m) -- frame@(-0.5 m, -0.3 m) { k = 1 MN/m, along = y }
spring b: ground@(0.5 m, -1 m) -- frame@(0.5 m, -0.3 m) { k = 1.5 MN/m, along = y }
spring c: ground@(-2 m, -0.3 m) -- frame@(-0.5 m, -0.3 m) { k = 1 MN/m, along = x }
damper e: ground@(-0.5 m, -1 m) -- frame@(-0.5 m, -0.3 m) { c = 1 kN*s/m, along = y }
damper f: ground@(-2 m, -0.3 m) -- frame@(-0.5 m, -0.3 m) { c = 1 kN*s/m, along = x }
output x = frame.x
output y = frame.y
output turn = frame.angle
";

type Complex = (f64, f64);

fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}

fn over(a: Complex, b: Complex) -> Complex {
    let size = b.0 * b.0 + b.1 * b.1;
    ((a.0 * b.0 + a.1 * b.1) / size, (a.1 * b.0 - a.0 * b.1) / size)
}

/// Gauss-Jordan elimination without exchanges, for matrices with a large diagonal.
fn solved(mut a: [[Complex; 3]; 3], mut b: [Complex; 3]) -> [Complex; 3] {
    for k in 0..3 {
        for i in (0..3).filter(|i| *i != k) {
            let factor = over(a[i][k], a[k][k]);
            let less = |from: Complex, by: Complex| {
                let product = times(factor, by);
                (from.0 - product.0, from.1 - product.1)
            };
            let pivot = a[k];
            for (entry, by) in a[i].iter_mut().zip(pivot).skip(k) {
                *entry = less(*entry, by);
            }
            b[i] = less(b[i], b[k]);
        }
    }
    [0, 1, 2].map(|k| over(b[k], a[k][k]))
}

/// The amplitudes of a free frame under a force that turns at the point (0, 0.2 m), in either sense: the rows of the springs
/// and dampers are written out by hand.
#[test]
fn both_components_act_a_quarter_of_a_turn_apart() {
    let rows = [([0.0, 1.0, -0.5], 1e6, 1e3), ([0.0, 1.0, 0.5], 1.5e6, 0.0), ([1.0, 0.0, 0.3], 1e6, 1e3)];
    let w = TAU * 25.0;
    let masses = [50.0, 50.0, 2.0];
    let mut a = [[(0.0, 0.0); 3]; 3];
    for (row, k, c) in rows {
        for i in 0..3 {
            for j in 0..3 {
                a[i][j].0 += row[i] * row[j] * k;
                a[i][j].1 += row[i] * row[j] * c * w;
            }
        }
    }
    (0..3).for_each(|i| a[i][i].0 -= masses[i] * w * w);
    for (word, sense) in [("", 1.0), (", clockwise", -1.0)] {
        // cos is the real part of exp(i w t), sin that of -i exp(i w t); the arm of the force along x is -0.2 m.
        let size = 0.01 * w * w;
        let truth = solved(a, [(size, 0.0), (0.0, -sense * size), (-0.2 * size, 0.0)]);
        let unbalance = format!("unbalance U: frame@(0, 0.2 m) {{ me = 0.01 kg*m, speed = 1500 rpm{word} }}\n");
        for (output, (re, im)) in ["x", "y", "turn"].into_iter().zip(truth) {
            let unit = if output == "turn" { "rad" } else { "m" };
            let size = re.hypot(im);
            let (low, high) = (size * (1.0 - 1e-12), size * (1.0 + 1e-12));
            let asked = format!("{FREE}{unbalance}require {low:e} {unit} < amplitude({output}) < {high:e} {unit}\n");
            let found = ran(&asked, &["check"]);
            assert!(found.status.success(), "{}", String::from_utf8_lossy(&found.stdout));
        }
    }
}

fn samples(model: &str) -> Vec<Vec<f64>> {
    let motion = json(model, &["simulate", "--until", "0.3 s", "--step", "0.01 s"]);
    let outputs = motion["outputs"].as_array().expect("outputs");
    outputs.iter().map(|output| output["values"].as_array().expect("values").iter().map(number).collect()).collect()
}

/// In time it is a force along each axis; in a component that is mirrored or turned, along the axes of the component.
#[test]
fn in_time_it_is_two_harmonic_forces() {
    let pair = |size: &str, x: &str, y: &str| {
        format!(
            "force X: frame@(0, 0.2 m) along {x} = harmonic({size}, 25 Hz, 90 deg)\n\
             force Y: frame@(0, 0.2 m) along {y} = harmonic({size}, 25 Hz)\n"
        )
    };
    let size = "0.01 kg*m * (2 * pi * 25 Hz)^2";
    let own = |more: &str| format!("unbalance U: frame@(0, 0.2 m) {{ me = 0.01 kg*m, speed = 1500 rpm{more} }}\n");
    let placed = |placing: &str| {
        format!(
            "component rotor(part p) {{\n  unbalance U: p@(0, 0) {{ me = 0.01 kg*m, speed = 25 Hz }}\n}}\n\
             place r = rotor(p = frame) at (0, 0.2 m) {placing}\n"
        )
    };
    for (unbalance, forces) in [
        (own(""), pair(size, "x", "y")),
        (own(", clockwise"), pair(size, "x", "-y")),
        (placed(""), pair(size, "x", "y")),
        (placed("mirrored x"), pair(size, "-x", "y")),
        (placed("turned 90 deg"), pair(size, "y", "-x")),
        (placed("mirrored y turned 90 deg"), pair(size, "y", "x")),
    ] {
        let [found, truth] = [&unbalance, &forces].map(|more| samples(&(FREE.to_string() + more)));
        let largest = truth[1].iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        assert!(largest > 1e-5);
        for (found, truth) in found.iter().flatten().zip(truth.iter().flatten()) {
            assert!((found - truth).abs() < 1e-13 * largest, "{unbalance}: {found:e}, not {truth:e}");
        }
    }
}

#[test]
fn what_does_not_fit_is_found() {
    let check = |fields: &str| code(&MACHINE.replace("{ me = 0.02 kg*m FIELDS }", fields), &["check"]);
    assert_eq!(check("{ speed = 25 Hz }"), "vib::field::missing");
    assert_eq!(check("{ me = 0.02 kg }"), "vib::unit::mismatch");
    assert_eq!(check("{ me = -0.02 kg*m }"), "vib::value::negative");
    assert_eq!(check("{ me = 0.02 }"), "vib::unit::missing");
    assert_eq!(check("{ me = 0.02 kg*m, speed = 100 /s }"), "vib::unit::frequency");
    assert_eq!(check("{ me = 0.02 kg*m, clockwise = 1 }"), "vib::field::value");
    assert_eq!(check("{ me = 0.02 kg*m, phase = 1 }"), "vib::field::unknown");
    assert_eq!(check("{ mee = 0.02 kg*m }"), "vib::field::unknown");
    assert_eq!(check("= 3"), "vib::syntax::unexpected");
    let on = |end: &str| code(&machine("").replace("U: frame", end), &["check"]);
    assert_eq!(on("U: ground"), "vib::input::no_effect");
    assert_eq!(on("U: nothing"), "vib::part::unknown");
    let asked = |asked: &str| code(&(machine(", speed = 25 Hz") + asked), &["check"]);
    assert_eq!(asked("require gain(U -> y, 1 Hz) < 1 m/kg/m\n"), "vib::measure::input");
    assert_eq!(asked("require gain(U.angle -> y, 1 Hz) < 1 m/kg/m\n"), "vib::measure::input");
    assert_eq!(asked("force F: frame along y = delayed(U.y, 1 s)\n"), "vib::signal::delayed");
}

#[test]
fn what_needs_a_speed_or_a_course_says_so() {
    let motion = ["simulate", "--until", "1 s", "--step", "0.1 s"];
    assert_eq!(code(&machine(""), &motion), "vib::unbalance::speed");
    for measure in ["peak(y)", "amplitude(y)"] {
        assert_eq!(code(&format!("{}require {measure} < 1 m\n", machine("")), &["check"]), "vib::require::no_value");
    }
    assert_eq!(code(&machine(", speed = 25 Hz"), &["emit", "--target", "c"]), "vib::unbalance::emit");
    let internal = ["emit", "--target", "c", "--signals", "internal"];
    assert_eq!(code(&machine(""), &internal), "vib::unbalance::speed");
    assert!(ran(&machine(", speed = 25 Hz"), &internal).status.success());
    assert!(ran(&machine(""), &["equations"]).status.success());
    // Nothing turns where there is no unbalance, and what stands still does not move.
    assert!(ran(&machine("").replace("0.02 kg*m", "0"), &motion).status.success());
    let still = samples(&machine(", speed = 0 Hz"));
    assert!(still.iter().flatten().all(|value| *value == 0.0), "{still:?}");
}
