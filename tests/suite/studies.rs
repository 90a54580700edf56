//! Sweeps beside closed forms and beside `analyze --set`; what stops a case, and what is refused. See docs/cli.md#sweeps.

use super::documents::root;
use num_rational::BigRational;
use serde_json::Value;
use std::f64::consts::PI;
use std::fs;
use std::process::{Command, Output};

const OSCILLATOR: &str = "model one\nparam k = 100 N/m\nparam m = 1 kg\nparam c = 0 N*s/m\nbody b { mass = m, moves x }\n\
                          spring s: ground -- b { k = k }\ndamper d: ground -- b { c = c }\nforce F: b along x\noutput x = b.x\n";

fn ran(model: &str, arguments: &[&str]) -> Output {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("m.vib"), model).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    command.args(["sweep", "m.vib"]).args(arguments).current_dir(folder.path()).output().expect("the program starts")
}

/// The heading and the rows of the CSV, without quotes around fields that contain no comma.
fn table(model: &str, arguments: &[&str]) -> (Vec<String>, Vec<Vec<String>>) {
    let output = ran(model, &[arguments, &["--format", "csv"]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let mut lines = text.lines().map(fields);
    (lines.next().expect("a heading"), lines.collect())
}

fn fields(line: &str) -> Vec<String> {
    let (mut list, mut quoted) = (vec![String::new()], false);
    for letter in line.chars() {
        match letter {
            '"' => quoted = !quoted,
            ',' if !quoted => list.push(String::new()),
            _ => list.last_mut().expect("a field").push(letter),
        }
    }
    list
}

fn number(field: &str) -> f64 {
    field.parse().unwrap_or_else(|_| panic!("`{field}` is no number"))
}

/// A requirement in a repetition or a component is there once for each, with a column of its own that says which: sqrt(k/m) and 1/(k - m w^2)
/// of three blocks, and of two components.
#[test]
fn requirements_of_repetitions_and_places_have_columns_of_their_own() {
    let w = 2.0 * PI;
    let (heading, rows) = table(
        "param m0 = 1 kg\nrepeat i in 1..3 {\n  body b[i] { mass = i * m0, moves x }\n  spring s[i]: ground -- b[i] { k = 100 N/m }\n  \
         force F[i]: b[i] along x\n  output x[i] = b[i].x\n  require gain(F[i] -> x[i], 1 Hz) < 2 cm/N\n  \
         require frequency(i) < 1.5 Hz\n}\n",
        &["--over", "m0=1kg,1.1kg"],
    );
    let place =
        |name: &str| heading.iter().position(|own| own == name).unwrap_or_else(|| panic!("{name}: {heading:?}"));
    for (row, m0) in rows.iter().zip([1.0, 1.1]) {
        for i in 1..=3 {
            let gain = 1.0 / (100.0 - f64::from(i) * m0 * w * w).abs();
            let frequency = (100.0 / (f64::from(4 - i) * m0)).sqrt() / w;
            for (measure, limit, truth, unit) in [
                ("gain(F[i] -> x[i], 1 Hz)", "< 2 cm/N", 100.0 * gain, " [cm/N]"),
                ("frequency(i)", "< 1.5 Hz", frequency, " [Hz]"),
            ] {
                let found = number(&row[place(&format!("{measure} (i = {i}){unit}"))]);
                assert!((found - truth).abs() < 1e-12 * truth, "{measure} {i}: {found} {truth}");
                let most = if unit == " [Hz]" { 1.5 } else { 2.0 };
                assert_eq!(row[place(&format!("{measure} {limit} (i = {i})"))], (truth < most).to_string());
            }
        }
    }
    let (heading, rows) = table(
        "component osc(m: kg) {\n  body b { mass = m, moves x }\n  spring s: ground -- b { k = 100 N/m }\n  force F: b along x\n  \
         output out = b.x\n  require gain(F -> out, 1 Hz) < 2 cm/N\n}\nparam m0 = 1 kg\nplace near = osc(m = m0)\nplace far = osc(m = 2 * m0)\n",
        &["--over", "m0=1kg,1.1kg"],
    );
    for (name, share) in [("near", 1.0), ("far", 2.0)] {
        let place =
            heading.iter().position(|own| own.starts_with("gain") && own.ends_with(&format!("(in {name}) [cm/N]")));
        for (row, m0) in rows.iter().zip([1.0, 1.1]) {
            let truth = 100.0 / (100.0 - share * m0 * w * w).abs();
            assert!((number(&row[place.expect("a column")]) - truth).abs() < 1e-12 * truth);
        }
    }
}

/// The value is the truth, up to its bound and the rounding of the truth itself.
fn meets(row: &[String], column: usize, truth: f64) {
    let (value, bound) = (number(&row[column]), number(&row[column + 1]));
    let allowed = bound + 4.0 * f64::EPSILON * truth.abs();
    assert!((value - truth).abs() <= allowed, "{value} ± {bound:e}, not {truth}: {row:?}");
    assert!(bound <= 1e-15 * truth.abs().max(1e-3), "{row:?}");
}

#[test]
fn every_combination_is_a_case_in_order() {
    let over = ["--over", "k=50N/m..200N/m:4", "--over", "m=500g,2kg,0.25kg", "--modes", "3", "--poles"];
    let (heading, rows) = table(OSCILLATOR, &over);
    let parts = ["re [1/s]", "re_bound", "im [rad/s]", "im_bound"];
    let poles = (1..=2).flat_map(|i| parts.map(|part| format!("pole_{i}_{part}")));
    let expected = ["case", "k [N/m]", "m [kg]", "frequency_1 [Hz]", "frequency_1_bound"].map(String::from);
    let expected: Vec<String> = expected.into_iter().chain(poles).chain(["code".to_string()]).collect();
    assert_eq!(heading, expected);
    let cases = [50.0, 100.0, 150.0, 200.0].iter().flat_map(|k| [0.5, 2.0, 0.25].map(|m| (*k, m)));
    let cases: Vec<(f64, f64)> = cases.collect();
    assert_eq!(rows.len(), cases.len());
    for (i, (row, (k, m))) in rows.iter().zip(cases).enumerate() {
        assert_eq!([number(&row[0]), number(&row[1]), number(&row[2])], [i as f64, k, m]);
        let omega = f64::sqrt(k / m);
        meets(row, 3, omega / (2.0 * PI));
        for (pole, side) in [(5, -1.0), (9, 1.0)] {
            assert_eq!(&row[pole..pole + 2], ["0.0", "0.0"]);
            meets(row, pole + 2, side * omega);
        }
        assert_eq!(row.last().map(String::as_str), Some(""));
    }
}

/// The static gain is 1/k: the distance from it is compared in fractions, so that nothing of the bound is lost to rounding.
#[test]
fn bounds_hold_for_the_printed_numbers() {
    let (_, rows) = table(OSCILLATOR, &["--over", "k=1N/m..50N/m:99", "--measure", "gain(F -> x, 0 Hz)"]);
    let binary = |field: &str| BigRational::from_float(number(field)).expect("a number");
    for (i, row) in rows.iter().enumerate() {
        // k = (i + 2) / 2
        let truth = BigRational::new(2.into(), (i + 2).into());
        let off = binary(&row[2]) - &truth;
        let off = if off < BigRational::from_integer(0.into()) { -off } else { off };
        assert!(off <= binary(&row[3]), "{row:?}");
        assert!(number(&row[3]) <= 1.2e-16 * number(&row[2]), "{row:?}");
    }
    assert_eq!(rows.len(), 99);
}

/// Damping from below to above the critical one, 2 sqrt(k m) = 20 N s/m: s = (-c ± sqrt(c^2 - 4 k m)) / (2 m).
#[test]
fn poles_pass_critical_damping() {
    let (_, rows) = table(OSCILLATOR, &["--over", "c=12N*s/m,20N*s/m,25N*s/m", "--poles"]);
    let expected = [[(-6.0, -8.0), (-6.0, 8.0)], [(-10.0, 0.0); 2], [(-5.0, 0.0), (-20.0, 0.0)]];
    for (row, poles) in rows.iter().zip(expected) {
        for (i, (re, im)) in poles.into_iter().enumerate() {
            meets(row, 2 + 4 * i, re);
            meets(row, 4 + 4 * i, im);
        }
    }
}

/// A stiffness that is solved for is another one in each case: k = m (2 pi f)^2.
#[test]
fn solved_parameters_are_solved_for_in_each_case() {
    let model =
        format!("{OSCILLATOR}solve k in 1 N/m .. 10 kN/m: frequency(1) = 2 Hz\nrequire gain(F -> x, 0 Hz) < 4 mm/N\n");
    let (heading, rows) = table(&model, &["--over", "m=1kg..4kg:4", "--modes", "1"]);
    assert_eq!(heading[2], "k [N/m]");
    for (m, row) in [1.0, 2.0, 3.0, 4.0].into_iter().zip(&rows) {
        let k = m * (4.0 * PI) * (4.0 * PI);
        meets(row, 2, k);
        meets(row, 4, 2.0);
        // In the unit of the requirement.
        meets(row, 6, 1e3 / k);
        assert_eq!(row[8], (1e3 / k < 4.0).to_string());
    }
    let (heading, rows) = table(&model, &["--over", "m=1kg..4kg:4", "--modes", "1", "--hold-solved"]);
    assert_eq!(heading[2], "frequency_1 [Hz]");
    for (m, row) in [1.0, 2.0, 3.0, 4.0].into_iter().zip(&rows) {
        meets(row, 2, 2.0 / f64::sqrt(m));
    }
}

/// A case is the model with its values set.
#[test]
fn cases_are_those_of_analyze() {
    let output = ran(OSCILLATOR, &["--over", "k=3N/m,7N/m", "--over", "c=0.3N*s/m", "--poles", "--format", "json"]);
    let study: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    for (case, k) in study["cases"].as_array().expect("cases").iter().zip(["3N/m", "7N/m"]) {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fs::write(folder.path().join("m.vib"), OSCILLATOR).expect("a file");
        let set = ["--set", &format!("k={k}"), "--set", "c=0.3N*s/m", "--format", "json"];
        let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
        let output = command.args(["analyze", "m.vib"]).args(set).current_dir(folder.path()).output().expect("a run");
        let alone: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        for (i, pole) in alone["poles"].as_array().expect("poles").iter().enumerate() {
            assert_eq!(case["values"][2 + 2 * i], pole["re"], "{pole}");
            assert_eq!(case["values"][3 + 2 * i], pole["im"], "{pole}");
        }
    }
}

/// A rod of length zero is no rod; the others are computed, and the run is no failure.
#[test]
fn a_case_that_fails_is_a_row_with_its_code() {
    let cart = fs::read_to_string(root().join("examples/cart.vib")).expect("an example");
    let arguments = ["--over", "L=2m,0m,1m", "--modes", "2", "--measure", "gain(F -> x, 1 Hz)"];
    let (heading, rows) = table(&cart, &arguments);
    assert_eq!(rows[1][1..], [["0.0"].as_slice(), &[""; 6], &["vib::shape::size"]].concat());
    assert_eq!(rows[1].len(), heading.len());
    // The example's own answer, rad/s.
    for (column, omega) in [(2, 2.15818), (4, 3.74715)] {
        assert!((number(&rows[0][column]) * 2.0 * PI - omega).abs() < 5e-6, "{:?}", rows[0]);
    }
    assert!(rows[2].iter().take(8).all(|field| !field.is_empty()));
    let text = String::from_utf8(ran(&cart, &arguments).stdout).expect("UTF-8");
    assert!(text.contains("1 case with vib::shape::size, the first at L = 0 m"), "{text}");
}

#[test]
fn infinite_and_missing_numbers_are_told_apart() {
    let (_, rows) =
        table(OSCILLATOR, &["--over", "k=0N/m,4N/m", "--measure", "gain(F -> x, 0 Hz)", "--measure", "damping(2)"]);
    assert_eq!(rows[0][2..], ["inf", "", "", "", ""]);
    assert_eq!([&rows[1][2], &rows[1][4], &rows[1][5], &rows[1][6]], ["0.25", "", "", ""]);
    let output = ran(OSCILLATOR, &["--over", "k=1N/m,4N/m", "--measure", "damping(2)"]);
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(text.contains("2\u{a0}without a value: there") || text.contains("2 without a value: there"), "{text}");
}

/// Each wrong line is one message at its place.
#[test]
fn what_cannot_be_swept_is_refused() {
    let solves = format!("{OSCILLATOR}solve k in 1 N/m .. 10 kN/m: frequency(1) = 2 Hz\n");
    for (arguments, status, message) in [
        (&["--over", "k=1N/m,2N/m"][..], 1, "error[vib::setting::solved]"),
        (&["--over", "kk=1N/m,2N/m"], 1, "error[vib::setting::unknown]"),
        (&["--over", "m=1kg..2m:3"], 1, "error[vib::unit::mismatch]"),
        (&["--over", "m=2kg..2kg:3"], 1, "error[vib::solve::range]"),
        (&["--over", "m=3kg..1kg:5"], 1, "the range is empty"),
        (&["--over", "m=1kg..3kg:0"], 2, "write how many values after a colon, from 2 to 1000000000"),
        (&["--over", "m=1kg..3kg:1000000000000"], 2, "write how many values after a colon, from 2 to 1000000000"),
        (
            &["--over", "m=1kg..3kg:9", "--shard", "4/4", "--format", "csv", "-o", "part"],
            2,
            "parts are counted from 0 to 3",
        ),
        (&["--over", "m=1kg", "--over", "m=2kg"], 2, "`--over` gives values for `m` twice"),
        (&["--over", "m=1kg", "--measure", "gain(F ->"], 2, "is no measure"),
        (&["--over", "m=1kg", "--measure", "gain(G -> x, 1 Hz)"], 1, "error[vib::part::unknown]"),
        // A million million cases: refused before any memory is taken for them.
        (
            &["--over", "m=1kg..2kg:1000000", "--over", "c=1N*s/m..2N*s/m:1000000"],
            2,
            "that would be 1000000000000 cases",
        ),
        (
            &[
                "--over",
                "m=1kg..2kg:1000000000",
                "--over",
                "c=1N*s/m..2N*s/m:1000000000",
                "--over",
                "k=1N/m..2N/m:1000",
            ],
            1,
            "error[vib::setting::solved]",
        ),
    ] {
        let output = ran(&solves, arguments);
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(status), "{arguments:?}: {text}");
        assert!(text.contains(message), "{arguments:?}: {text}");
        assert_eq!(text.matches("error").count() - text.matches("1 error").count(), 1, "{arguments:?}: {text}");
        assert!(output.stdout.is_empty());
    }
}

/// A block between two slanted springs snaps through at 4.974958 N. Each row of a sweep is at the rest that a search for its own values
/// finds, although its neighbours have snapped through and could be followed back.
#[test]
fn a_row_is_at_the_rest_that_its_own_search_finds() {
    let model = "param a = 0.9\nbody b { mass = 1 kg, at = (0, 0.3 m), moves y }\n\
                 spring s: ground@(-1 m, 0) -- b { k = 500 N/m }\nspring t: b -- ground@(1 m, 0) { k = 500 N/m }\n\
                 force F: b along -y = constant(4.97495 N + 1 N * (a - 0.53)^2)\n";
    // With y the height, L = sqrt(1 + y^2) and L0 = sqrt(1.09): P = 1000 y (L0 / L - 1) and K = 1000 (1 - L0 / L^3).
    let load = |y: f64| 1000.0 * y * (1.09f64.sqrt() / y.hypot(1.0) - 1.0);
    let frequency = |y: f64| (1000.0 * (1.0 - 1.09f64.sqrt() / y.hypot(1.0).powi(3))).sqrt() / std::f64::consts::TAU;
    let height = |p: f64, mut low: f64, mut high: f64| {
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            // Over both branches the load falls as the height rises.
            if load(middle) > p { low = middle } else { high = middle }
        }
        low
    };
    let fold = (1.09f64.powf(1.0 / 3.0) - 1.0).sqrt();
    let (_, rows) = table(model, &["--over", "a=0..1:101", "--modes=1"]);
    assert_eq!(rows.len(), 101);
    let mut before = 0;
    for row in &rows {
        let p = 4.97495 + (number(&row[1]) - 0.53).powi(2);
        let y = if p < load(fold) { height(p, fold, 0.3) } else { height(p, -2.0, -0.3) };
        before += usize::from(y > 0.0);
        // At the fold the frequency is as the square root of what the load is below it: half of the digits of P are left.
        assert!((number(&row[2]) - frequency(y)).abs() < 1e-6, "{row:?} {}", frequency(y));
    }
    assert_eq!(before, 1);
}

/// Frequencies and poles of many cases are computed side by side: those of both ways agree within their bounds, whatever of the model the
/// parameter is, and a row does not depend on which others are computed with it.
#[test]
fn lines_of_cases_agree_with_the_cases_one_by_one() {
    for (model, over, asked, is_linear) in [
        ("cart", "k=5N/m..50N/m:33", "--modes=2", true),
        ("cart", "m1=-1kg..2kg:31", "--modes=2", false),
        ("cart", "m2=0.5kg..2kg:16", "--modes=2", true),
        ("cart", "L=0.5m..2m:16", "--modes=2", false),
        ("cart", "L=0.5m..2m:64", "--modes=2", true),
        // Drawn far from the rest, or much softer there: that a search ends in it is not proved for all values.
        ("double_pendulum", "l=1m..3m:200", "--modes=2", false),
        ("inverted_pendulum", "L=0.7m..1.5m:64", "--modes=1", true),
        ("stiffening_mount", "k3=4e6N/m^3..9e6N/m^3:64", "--modes=1", false),
        ("half_car", "a=1m..1.4m:40", "--modes=2", true),
        ("shear_building", "m=2t..5t:40", "--modes=6", true),
        ("shear_building", "k=5kN/m..50kN/m:40", "--modes=6", true),
        ("rotor", "m=20kg..80kg:20", "--modes=1", true),
        ("free_free_chain", "k=1N/m..9N/m:20", "--modes=3", false),
        ("shear_building", "k=0N/m..50kN/m:40", "--modes=6", true),
        ("cart", "b=0N*s/m..50N*s/m:64", "--poles", true),
        ("cart", "k=5N/m..50N/m:33", "--poles", true),
        ("cart", "m2=0.5kg..2kg:16", "--poles", true),
        ("tuned_absorber", "c=0N*s/m..400N*s/m:40", "--poles", true),
        (
            "tuned_absorber",
            "c=5N*s/m,400N*s/m,40N*s/m,1N*s/m,2N*s/m,3N*s/m,4N*s/m,6N*s/m,7N*s/m,8N*s/m,9N*s/m,10N*s/m,11N*s/m,12N*s/m,13N*s/m,14N*s/m",
            "--poles",
            true,
        ),
        ("shear_building", "k=5kN/m..50kN/m:40", "--poles", true),
        ("free_free_chain", "k=1N/m..9N/m:20", "--poles", false),
    ] {
        let model = fs::read_to_string(root().join(format!("examples/{model}.vib"))).expect("an example");
        // Requirements would be columns too.
        let asks = |line: &&str| !["require", "solve", "minimise"].iter().any(|word| line.starts_with(word));
        let text: String = model.lines().filter(asks).map(|line| format!("{line}\n")).collect();
        if !text.contains(&format!("param {}", &over[..over.find('=').expect("a name")])) {
            panic!("{over}: no such parameter");
        }
        let (heading, lines) = table(&text, &["--over", over, asked]);
        let (_, single) = table(&text, &["--over", over, asked, "--tolerance", "1e-16"]);
        assert_eq!(lines != single, is_linear, "{over} {asked}");
        for (a, b) in lines.iter().zip(&single) {
            for column in (0..heading.len()).filter(|&i| heading[i].ends_with("_bound") && !a[i].is_empty()) {
                let (off, bounds) =
                    (number(&a[column - 1]) - number(&b[column - 1]), number(&a[column]) + number(&b[column]));
                assert!(off.abs() <= bounds, "{over}: {a:?} {b:?}");
                assert!(number(&a[column]) <= 1.01e-10 * number(&a[column - 1]).abs(), "{over}: {a:?}");
            }
        }
    }
}

/// Poles of an oscillator from light to heavy damping side by side, s = (-c ± sqrt(c^2 - 4 k m)) / 2 m, with frequencies beside them; a
/// spring and a mass that change; and the critical damping amid them, where both are one.
#[test]
fn poles_on_a_line_are_those_of_the_quadratic() {
    for (over, values) in [
        ("c=1N*s/m..41N*s/m:81", [0.5, 1.0]),
        ("k=36N/m..196N/m:81", [2.0, 36.0]),
        ("m=0.25kg..2.25kg:81", [0.025, 0.25]),
    ] {
        let model = OSCILLATOR.replace("c = 0", "c = 4");
        let (_, rows) = table(&model, &["--over", over, "--poles", "--modes", "1"]);
        let (mut together, mut exact) = (0, 0);
        for (i, row) in rows.iter().enumerate() {
            let value = values[1] + i as f64 * values[0];
            let [m, c, k] = match &over[..1] {
                "c" => [1.0, value, 100.0],
                "k" => [1.0, 4.0, value],
                _ => [value, 4.0, 100.0],
            };
            let omega = number(&row[2]) * 2.0 * PI;
            assert!((omega * omega - k / m).abs() < 1e-9 * k / m, "{row:?}");
            let (half, square) = (-c / (2.0 * m), c * c - 4.0 * k * m);
            let root = square.abs().sqrt() / (2.0 * m);
            let poles = match square < 0.0 {
                true => [(half, -root), (half, root)],
                // The smaller one first, from the product of both.
                false => [(k / m / (half - root), 0.0), (half - root, 0.0)],
            };
            for (j, (re, im)) in poles.into_iter().enumerate() {
                for (column, truth) in [(4 + 4 * j, re), (6 + 4 * j, im)] {
                    let (found, bound) = (number(&row[column]), number(&row[column + 1]));
                    // Near critical damping the root of the difference has lost digits in this test.
                    let own = 4.0 * f64::EPSILON * (half.abs() + k / m / root.max(1e-300));
                    assert!((found - truth).abs() <= bound + own, "{over} {i}: {found} ± {bound:e}, not {truth}");
                    assert!(bound <= 1.01e-10 * truth.abs(), "{over} {i}: {bound:e}");
                }
            }
            match number(&row[5]) > 1e-17 {
                true => together += 1,
                false => exact += 1,
            }
        }
        assert!(together > 4 * exact, "{over}: {together} side by side, {exact} by themselves");
    }
}

/// Two equal masses between walls on three equal springs and dampers: one number weighs three rows, and the poles are those of two
/// oscillators, of k and of 3 k, which pass critical damping one after the other.
#[test]
fn poles_of_three_springs_alike_are_those_of_two_quadratics() {
    let model = "model alike\nparam k = 1 N/m\nparam m = 1 kg\nparam c = 2 N*s/m\nbody a { mass = m, moves x }\nbody b { mass = m, moves x }\n\
        spring s1: ground -- a { k = k }\nspring s2: a -- b { k = k }\nspring s3: b -- ground { k = k }\n\
        damper d1: ground -- a { c = c }\ndamper d2: a -- b { c = c }\ndamper d3: b -- ground { c = c }\n";
    for (over, step, low) in [("k=0.25N/m..6.25N/m:97", 0.0625, 0.25), ("m=1kg..7kg:97", 0.0625, 1.0)] {
        let (heading, rows) = table(model, &["--over", over, "--poles"]);
        let (_, single) = table(model, &["--over", over, "--poles", "--tolerance", "1e-16"]);
        let together = rows.iter().zip(&single).filter(|(a, b)| a != b).count();
        assert!(together > 60, "{over}: {together} side by side");
        for (i, row) in rows.iter().enumerate() {
            let value = low + step * i as f64;
            let [k, m] = if over.starts_with('k') { [value, 1.0] } else { [1.0, value] };
            let mut truth: Vec<(f64, f64)> = Vec::new();
            for times in [1.0, 3.0] {
                let (half, square) = (-times / m, times * times / (m * m) - times * k / m);
                let root = square.abs().sqrt();
                truth.extend(match square < 0.0 {
                    true => [(half, -root), (half, root)],
                    false => [(times * k / m / (half - root), 0.0), (half - root, 0.0)],
                });
            }
            let places = (0..heading.len()).filter(|&at| heading[at].ends_with("_re_bound"));
            for at in places.filter(|&at| !row[at].is_empty()) {
                let [re, of_re, im, of_im] = [0, 1, 2, 3].map(|more| number(&row[at - 1 + more]));
                let nearest = truth.iter().map(|(x, y)| (re - x).hypot(im - y)).fold(f64::INFINITY, f64::min);
                // The digits that this test has of the root of a difference.
                let own = 1e-14 + 4.0 * f64::EPSILON / nearest_root(&truth).max(1e-8);
                assert!(nearest <= of_re.hypot(of_im) + own, "{over} {value}: {re} {im}, {nearest:e} off");
            }
        }
    }
}

/// The least distance between two of some numbers.
fn nearest_root(list: &[(f64, f64)]) -> f64 {
    let pairs = list.iter().enumerate().flat_map(|(i, a)| list[..i].iter().map(move |b| (a.0 - b.0).hypot(a.1 - b.1)));
    pairs.fold(f64::INFINITY, f64::min)
}

/// What one parameter weighs on several rows: a body that moves and turns, a spring and its damper, masses in parts that nothing couples,
/// one of which does not feel it.
#[test]
fn poles_of_a_few_weights_agree_with_the_cases_one_by_one() {
    let plate = "model plate
param m = 2 kg
param k = 90 N/m
body a { mass = m, inertia = m * (0.3 m)^2, at = (0 m, 0 m), moves x y, turns }
spring s1: ground@(-1 m, 0 m) -- a@(-0.4 m, 0 m) { k = k }
spring s2: ground@(0.1 m, -1 m) -- a@(0.1 m, -0.2 m) { k = k }
spring s3: ground@(1 m, 1 m) -- a@(0.3 m, 0.2 m) { k = 70 N/m }
damper d: ground@(-1 m, 0.1 m) -- a@(-0.4 m, 0.1 m) { c = 1 N*s/m }
damper e: ground@(0.1 m, -1 m) -- a@(0.1 m, -0.2 m) { c = 0.5 N*s/m }
";
    let parts = "model parts
param k = 50 N/m
param m = 2 kg
body a { mass = m, moves x }
body b { mass = 3 kg, moves x }
body c { mass = m, moves x }
body f { mass = 1 kg, moves x }
spring s1: ground -- a { k = k }
spring s2: a -- b { k = 30 N/m }
damper d1: ground -- a { c = 0.02 s * k }
spring s3: ground -- c { k = 2 * k }
damper d3: ground -- c { c = 3 N*s/m }
spring s4: ground -- f { k = 20 N/m }
damper d4: ground -- f { c = 11 N*s/m }
";
    for (model, over) in [
        (plate, "m=1kg..4kg:48"),
        (plate, "k=40N/m..160N/m:48"),
        (parts, "k=40N/m..90N/m:48"),
        (parts, "m=2kg..3kg:48"),
    ] {
        let (heading, lines) = table(model, &["--over", over, "--poles"]);
        let (_, single) = table(model, &["--over", over, "--poles", "--tolerance", "1e-16"]);
        let together = lines.iter().zip(&single).filter(|(a, b)| a != b).count();
        assert!(together > 30, "{over}: {together} side by side");
        for (a, b) in lines.iter().zip(&single) {
            for column in (0..heading.len()).filter(|&i| heading[i].ends_with("_bound") && !a[i].is_empty()) {
                let (off, bounds) =
                    (number(&a[column - 1]) - number(&b[column - 1]), number(&a[column]) + number(&b[column]));
                assert!(off.abs() <= bounds, "{over}: {a:?} {b:?}");
            }
        }
    }
}

/// A number at which the model has no meaning, amid others where it has one.
#[test]
fn a_case_without_meaning_amid_a_line_keeps_its_code() {
    let model = OSCILLATOR.replace("k = k", "k = k - 10 N/m");
    let (_, rows) = table(&model, &["--over", "k=0N/m..20N/m:21", "--over", "m=-7kg..8kg:16", "--modes", "1"]);
    let (_, single) = table(
        &model,
        &["--over", "k=0N/m..20N/m:21", "--over", "m=-7kg..8kg:16", "--modes", "1", "--tolerance", "1e-16"],
    );
    assert_eq!(rows, single);
    assert!(rows.iter().any(|row| !row[5].is_empty()) && rows.iter().any(|row| row[5].is_empty()));
}

/// Blocks and cores divide the cases; the bytes are those of the cases one by one.
#[test]
fn the_division_of_the_cases_changes_no_byte() {
    let arguments = ["--over", "k=1N/m..9N/m:4200", "--modes", "1", "--tolerance", "1e-16", "--format", "csv"];
    let whole = String::from_utf8(ran(OSCILLATOR, &arguments).stdout).expect("UTF-8");
    let rows: Vec<&str> = whole.lines().skip(1).collect();
    assert_eq!(rows.len(), 4200);
    for (i, row) in rows.iter().enumerate().step_by(613) {
        // k = 1 + 8 i / 4199, as the value of a list.
        let k = format!("k=({}/4199)*1N/m", 4199 + 8 * i);
        let (_, alone) = table(OSCILLATOR, &["--over", &k, "--modes", "1"]);
        assert_eq!(fields(row)[1..], alone[0][1..], "{k}");
        assert_eq!(fields(row)[0], i.to_string());
    }
}

/// Products of frequencies are of frequencies in Hz, and their headings say so; other products have the units of SI.
#[test]
fn products_of_measures_have_their_units() {
    let model = "param k = 10 N/m\nbody b { mass = 1 kg, moves x }\nspring s: ground -- b { k = k }\nforce F: b along x\noutput x = b.x\n";
    let asked = ["frequency(1)*frequency(1)", "frequency(1)*2", "gain(F -> x, 0 Hz)*gain(F -> x, 0 Hz)"];
    let arguments: Vec<&str> =
        ["--over", "k=10N/m,40N/m"].into_iter().chain(asked.iter().flat_map(|one| ["--measure", one])).collect();
    let (heading, rows) = table(model, &arguments);
    for (name, unit) in asked.iter().zip(["Hz^2", "Hz", "s^4/kg^2"]) {
        assert!(heading.contains(&format!("{name} [{unit}]")), "{heading:?}");
    }
    let column = heading.iter().position(|name| name.starts_with(asked[0])).expect("a column");
    meets(&rows[0], column, 10.0 / std::f64::consts::TAU.powi(2));
}
