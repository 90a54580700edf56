//! The two readings of literals: the written decimal, and the binary64 number nearest to it. Scenes in which the
//! difference shows, compared with the references of tests/hardcases for each reading. See
//! docs/method/numbers.md#literals.

use super::systems::{error, number};
use vibc::analysis::{Modes, Poles};
use vibc::base::source::{SourceFile, Sources};
use vibc::base::{Ball, Literals, Number};
use vibc::model::Overrides;

fn answers(text: &str, literals: Literals) -> (Modes, Poles) {
    let mut sources = Sources::new();
    let model = sources.add(SourceFile::model("model.vib", text));
    let outcome = vibc::analyze(&sources, model, &Overrides { literals, ..Overrides::default() });
    let answer = outcome.answer.unwrap_or_else(|| panic!("{:?}", outcome.diagnostics));
    (answer.modes, answer.poles)
}

/// The reference `id` of a case: for the decimals, and for the binary64 numbers nearest to them.
fn references(case: &str, id: &str) -> [(Literals, Number); 2] {
    let path = format!("{}/tests/hardcases/{case}.json", env!("CARGO_MANIFEST_DIR"));
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path).expect("a case")).expect("a case is JSON");
    let list = json["reference"].as_array().expect("a list");
    let entry = list.iter().find(|entry| entry["id"] == id).expect("the reference is there");
    let value = |field: &str| number(entry[field].as_str().expect("a decimal"));
    [(Literals::Decimal, value("value_decimal")), (Literals::Binary64, value("value"))]
}

/// Asserts that the value is accurate to 1e-28 of itself, and within its bound; references have 36 digits.
fn assert_near(value: Ball, truth: &Number, what: &str) {
    let size = truth.abs().to_f64();
    let (error, holds) = error(value, truth, 1e-35 * size);
    assert!(holds && error <= 1e-28 * size, "{what}: {value:?}, error {error:e}");
}

/// o19: an inverted pendulum 1e-11 above its buckling load. o31: a spring against two preloaded struts.
#[test]
fn near_buckling_each_reading_has_its_own_frequency() {
    let scenes = [
        (
            "o19_inverted_pendulum",
            "gravity 9.81 m/s^2
             body bob { mass = 1 kg, at = (0, 1 m) }
             pivot p: ground@(0, 0) -- bob
             spring t: ground -- bob { k = 9.8100000001 N*m/rad }",
        ),
        (
            "o31_qzs_isolator",
            "body y { mass = 100 kg, at = (0, 0), moves y }
             spring k: ground -- y { k = 10000.00001 N/m, along = y }
             spring a: ground@(-0.15 m, 0) -- y { k = 1 N/m, preload = -750 N }
             spring b: ground@(0.15 m, 0) -- y { k = 1 N/m, preload = -750 N }",
        ),
    ];
    for (case, text) in scenes {
        for (literals, truth) in references(case, "omega_1") {
            let (modes, _) = answers(text, literals);
            assert_near(modes.list[0].omega, &truth, case);
        }
    }
}

/// o13: 1e-12 below critical damping.
#[test]
fn near_critical_damping_each_reading_has_its_own_poles() {
    let text = "body x1 { mass = 1 kg, moves x }
                spring k: ground -- x1 { k = 4 N/m }
                damper c: ground -- x1 { c = 3.999999999996 N*s/m }";
    for part in ["lambda_1_re", "lambda_1_im"] {
        for (literals, truth) in references("o13_near_critical_sdof", part) {
            let (_, poles) = answers(text, literals);
            let pole = poles.list.iter().find(|pole| pole.im.mid.hi > 0.0).expect("a pair");
            assert_near(if part.ends_with("re") { pole.re } else { pole.im }, &truth, part);
        }
    }
}

/// 0.1 + 0.2 - 0.3 is zero in decimals, and 2^-55 for the binary64 numbers nearest to them.
#[test]
fn arithmetic_on_literals_is_exact_in_both_readings() {
    let text = "param k = 0.1 N/m + 0.2 N/m - 0.3 N/m
                body b { mass = 1 kg, moves x }
                spring s: ground -- b { k = 4 N/m + k * 2 ^ 56 }";
    for (literals, omega) in [(Literals::Decimal, "2"), (Literals::Binary64, "2.449489742783178098197284074705891392")]
    {
        assert_near(answers(text, literals).0.list[0].omega, &number(omega), omega);
    }
}
