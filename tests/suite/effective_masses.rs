//! Participation factors and effective masses of base excitation, beside closed forms. See
//! docs/method/measures.md#effective-masses.

use crate::program::{finding, json, ran, text};
use serde_json::Value;
use std::f64::consts::PI;

/// What each motion of a base excites.
fn excited(model: &str) -> Vec<Value> {
    let whole = json(model, &["analyze", "--participation"]);
    whole["base_excitation"].as_array().cloned().unwrap_or_default()
}

fn code(model: &str) -> String {
    crate::program::code(model, &["check"])
}

/// The value holds its bound, up to the rounding of the truth, and the bound is sharp.
fn meets(of: &Value, field: &str, truth: f64) {
    meets_within(of, field, truth, 1e-15 * truth.abs().max(1e-3));
}

fn meets_within(of: &Value, field: &str, truth: f64, least: f64) {
    let number = |name: &str| of[name].as_f64().unwrap_or_else(|| panic!("{name} in {of}"));
    let (value, bound) = (number(field), number(&format!("{field}_error_bound")));
    assert!((value - truth).abs() <= bound + 4e-15 * truth.abs(), "{field} {value:e} ± {bound:e}, not {truth:e}");
    assert!(bound <= least, "{field}: {bound:e}");
}

fn chain(n: usize, m: f64) -> String {
    let mut text = format!(
        "base soil {{ moves x }}\nbody f[1] {{ mass = {m} kg, moves x }}\nspring c[1]: soil -- f[1] {{ k = 5 kN/m }}\n"
    );
    for i in 2..=n {
        let before = i - 1;
        text += &format!(
            "body f[{i}] {{ mass = {m} kg, moves x }}\nspring c[{i}]: f[{before}] -- f[{i}] {{ k = 5 kN/m }}\n"
        );
    }
    text
}

/// Equal masses and springs on a base: x_i(j) = sin(2 j a) with a = (2 i - 1) pi / (4 n + 2).
#[test]
fn storeys_have_their_closed_form() {
    for n in [1, 2, 4, 9, 40] {
        let m = 4000.0;
        let list = excited(&chain(n, m));
        assert_eq!((list.len(), list[0]["unit"].as_str(), list[0]["input"].as_str()), (1, Some("kg"), Some("soil")));
        meets(&list[0], "total", m * n as f64);
        let mut sum = 0.0;
        for i in 1..=n {
            // The sum of the sines is cot(a)/2, that of their squares (2 n + 1)/4, with the half angle a.
            let whole = (2 * n + 1) as f64;
            let [half, other] = [(2 * i - 1) as f64 / 2.0, (n + 1 - i) as f64].map(|part| (part * PI / whole).tan());
            let mass = m / whole * if half < other { 1.0 / (half * half) } else { other * other };
            sum += mass;
            let found = &list[0]["modes"][i - 1];
            // Forty shapes are in binary64.
            let least = m * n as f64 * if n == 40 { 1e-12 } else { 1e-15 };
            meets_within(found, "effective_mass", mass, least);
            meets_within(found, "sum", sum, least);
            let factor = found["participation"].as_f64().expect("a factor");
            assert!((factor * factor - mass).abs() < 1e-11 * mass.max(1.0));
        }
    }
}

/// Two different storeys, by the quadratic equation.
#[test]
fn two_storeys_by_hand() {
    let model = "base g { moves y }\nbody a { mass = 3 kg, moves y }\nbody b { mass = 1 kg, moves y }\n\
                 spring s: g -- a { k = 700 N/m }\nspring t: a -- b { k = 200 N/m }\ndamping modal 3 %\n";
    let list = excited(model);
    // (900 - 3 z)(200 - z) = 200^2; the shape is (1, 200 / (200 - z)).
    let middle = 1500.0 / 6.0;
    let apart = (middle * middle - 140_000.0_f64 / 3.0).sqrt();
    for (mode, z) in [middle - apart, middle + apart].into_iter().enumerate() {
        let b = 200.0 / (200.0 - z);
        let mass = (3.0 + b).powi(2) / (3.0 + b * b);
        let found = &list[0]["modes"][mode];
        let (value, truth) = (found["effective_mass"].as_f64().expect("a mass"), mass);
        assert!((value - truth).abs() < 1e-12 * truth, "{value}, not {truth}");
    }
    meets(&list[0], "total", 4.0);
}

/// Inertia between base and body: an inerter, a pendulum on a hand that moves, a shaft on a base that turns.
#[test]
fn inertia_may_connect_a_base() {
    let list = excited(
        "base g { moves x }\nbody m { mass = 3 kg, moves x }\nspring s: g -- m { k = 8 N/m }\ninerter b: g -- m { b = 1 kg }\n",
    );
    meets(&list[0]["modes"][0], "effective_mass", 9.0 / 4.0);
    meets(&list[0], "total", 9.0 / 4.0);
    let list = excited(
        "gravity 9.81 m/s^2\nbase hand { moves x, at = (0, 0) }\nbody bob { mass = 2 kg, inertia = 0.5 kg*m^2, at = (0, -1 m) }\n\
         pivot p: hand@(0, 0) -- bob\n",
    );
    // (m L)^2 / (m L^2 + J)
    meets(&list[0]["modes"][0], "effective_mass", 4.0 / 2.5);
    let list = excited(
        "base motor { turns, at = (0, 0) }\nbody a { inertia = 2 kg*m^2, turns }\nbody b { inertia = 3 kg*m^2, turns }\n\
         spring s: motor -- a { k = 100 N*m/rad }\nspring t: a -- b { k = 40 N*m/rad }\n",
    );
    assert_eq!(list[0]["unit"], "kg*m^2");
    meets(&list[0], "total", 5.0);
    meets(&list[0]["modes"][1], "sum", 5.0);
}

/// A body between two bases follows each by its share of the stiffness: r = k/(k + l).
#[test]
fn each_base_has_its_own() {
    let list = excited(
        "base a { moves x }\nbase b { moves x }\nbody m { mass = 2 kg, moves x }\nspring s: a -- m { k = 30 N/m }\n\
         spring t: b -- m { k = 10 N/m }\n",
    );
    meets(&list[0], "total", 2.0 * 0.5625);
    meets(&list[1], "total", 2.0 * 0.0625);
    meets(&list[0]["modes"][0], "effective_mass", 2.0 * 0.5625);
}

/// Three masses in a ring on one base: together at k, and two motions against each other at k + 3 l.
const RING: &str = "base g { moves x }\nbody a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\nbody c { mass = 1 kg, moves x }\n\
    spring s: g -- a { k = 9 N/m }\nspring t: g -- b { k = 9 N/m }\nspring u: g -- c { k = 9 N/m }\n\
    spring v: a -- b { k = 2 N/m }\nspring w: b -- c { k = 2 N/m }\nspring y: c -- a { k = 2 N/m }\n";

#[test]
fn equal_frequencies_have_masses_only_together() {
    let list = excited(RING);
    meets(&list[0]["modes"][0], "effective_mass", 3.0);
    for mode in [1, 2] {
        assert!(list[0]["modes"][mode]["effective_mass"].is_null());
        assert!(list[0]["modes"][mode]["participation"].is_null());
    }
    assert!(list[0]["modes"][1]["sum"].is_null());
    meets(&list[0]["modes"][2], "sum", 3.0);
    let text = text(RING, &["analyze", "--participation"]);
    assert!(text.contains("base excitation by g: 3.00000 kg in all modes") && text.contains("only together"), "{text}");
    assert_eq!(code(&format!("{RING}require effective_mass(g, 2) > 1 kg\n")), "vib::require::no_value");
    // Parts that do not touch each other have shapes of their own, whatever their frequencies.
    let apart = RING.lines().filter(|line| !line.contains("2 N/m")).collect::<Vec<_>>().join("\n");
    let list = excited(
        &apart.replace("body b { mass = 1 kg", "body b { mass = 4 kg").replace("g -- b { k = 9", "g -- b { k = 36"),
    );
    for (mode, mass) in [1.0, 4.0, 1.0].into_iter().enumerate() {
        meets(&list[0]["modes"][mode], "effective_mass", mass);
    }
}

#[test]
fn a_model_asks_for_it() {
    let model = chain(4, 4000.0) + "force F: f[1] along x\n";
    let holds = |asked: &str| ran(&format!("{model}require {asked}\n"), &["check"]).status.success();
    assert!(holds("14 t < effective_mass(soil, 1) < 16 t"));
    assert!(holds(
        "0.999999 * 16 t < effective_mass(soil, 1) + effective_mass(soil, 2) + effective_mass(soil, 3) + effective_mass(soil, 4) < 1.000001 * 16 t"
    ));
    assert!(!holds("effective_mass(soil, 1) > 15 t"));
    let found = |asked: &str| code(&format!("{model}require {asked}\n"));
    assert_eq!(found("effective_mass(F, 1) > 1 kg"), "vib::measure::input");
    assert_eq!(found("effective_mass(soil, 0) > 1 kg"), "vib::measure::mode");
    let both = "base table { moves x, turns }\n".to_string() + &model;
    let of_both = finding(&format!("{both}require effective_mass(table, 1) > 1 kg\n"), &["check"]);
    assert_eq!(of_both["help"], "write `table.x` or `table.angle`");
    assert_eq!(found("effective_mass(soil, 5) > 1 kg"), "vib::require::no_value");
    assert_eq!(found("effective_mass(soil) > 1 kg"), "vib::measure::arguments");
    assert_eq!(found("effective_mass(soil, 1) > 1 kg*m^2"), "vib::unit::mismatch");
    // What nothing holds follows no base.
    let free = model.replace("spring c[1]: soil -- f[1] { k = 5 kN/m }", "damper c: soil -- f[1] { c = 5 kN*s/m }");
    assert_eq!(code(&format!("{free}require effective_mass(soil, 1) > 1 kg\n")), "vib::require::no_value");
    let refused = excited(&free);
    assert!(refused[0]["not_computed"].as_str().is_some_and(|why| why.contains("oscillate")), "{refused:?}");
    // Solved for: an upper mass of 2 kg, by (900 - 3 z)(200 - 2 z) = 200^2 and the shape (1, 200 / (200 - 2 z)).
    let asked = "param m = 1 kg\nbase g { moves x }\nbody a { mass = 3 kg, moves x }\nbody b { mass = m, moves x }\n\
        spring s: g -- a { k = 700 N/m }\nspring t: a -- b { k = 200 N/m }\nsolve m in 1.5 kg .. 3 kg: effective_mass(g, 1) = ";
    let z = 200.0 - (40_000.0 - 70_000.0_f64 / 3.0).sqrt();
    let b = 200.0 / (200.0 - 2.0 * z);
    let truth = (3.0 + 2.0 * b).powi(2) / (3.0 + 2.0 * b * b);
    let whole = json(&format!("{asked}{truth:e} kg\n"), &["analyze"]);
    let found = whole["solved"][0]["si"].as_f64().expect("a mass");
    assert!((found - 2.0).abs() < 1e-12, "{found}");
}

/// Two bodies of different parts with one frequency: which of them is the first mode is a matter of the text, so neither mass is that of
/// mode 1. Of equal bodies it does not matter.
#[test]
fn equal_frequencies_of_different_parts_have_no_mass_of_their_own() {
    let said = |m: &str, k: &str| {
        let model = format!(
            "base q {{ moves x }}\nbody a {{ mass = 1 kg, moves x }}\nbody b {{ mass = {m}, moves x }}\n\
             spring s: q -- a {{ k = 10 N/m }}\nspring t: q -- b {{ k = {k} }}\nrequire effective_mass(q, 1) <= 2 kg\n"
        );
        let output = ran(&model, &["check"]);
        (
            output.status.code(),
            String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr),
        )
    };
    let (status, text) = said("3 kg", "30 N/m");
    assert!(status != Some(0) && text.contains("only together"), "{text}");
    assert_eq!(said("1 kg", "10 N/m").0, Some(0));
    assert_eq!(said("3 kg", "31 N/m").0, Some(0));
}
