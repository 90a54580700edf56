//! Maxima under response spectra beside closed forms and eigenvectors by hand, and what is refused. See
//! docs/method/response_spectra.md.

use super::program::{code, json, ran, text};
use serde_json::Value;
use std::f64::consts::PI;

const POINTS: &str = "(0.5 Hz, 3 m/s^2), (2 Hz, 8 m/s^2), (9 Hz, 8 m/s^2), (33 Hz, 3 m/s^2)";

/// The pseudo-acceleration of these points.
fn at(hertz: f64) -> f64 {
    let points: [(f64, f64); 4] = [(0.5, 3.0), (2.0, 8.0), (9.0, 8.0), (33.0, 3.0)];
    for pair in points.windows(2) {
        let ((f, a), (g, b)) = (pair[0], pair[1]);
        if hertz <= g {
            return a * (b / a).powf((hertz / f).ln() / (g / f).ln());
        }
    }
    3.0
}

fn maxima(model: &str, more: &[&str]) -> Value {
    json(model, &[&["analyze"], more].concat())["response_spectra"].clone()
}

fn meets(of: &Value, field: &str, truth: f64) {
    let number = |field: &str| of[field].as_f64().unwrap_or_else(|| panic!("{field} in {of}"));
    let value = number(field);
    let bound = match field {
        "missing" => number("missing_error_bound"),
        _ => number(&format!("{field}_error_bound")) * value.abs(),
    };
    assert!(
        (value - truth).abs() <= bound + 1e-12 * truth.abs().max(1e-9),
        "{field}: {value:e} ± {bound:e}, not {truth:e}"
    );
    assert!(bound <= 1e-13 * truth.abs().max(1.0), "{field}: {bound:e}");
}

/// One oscillator at each part of the spectrum: its maximum is S / omega^2, the force m S and the acceleration S.
#[test]
fn one_oscillator_has_the_value_of_the_spectrum() {
    for hertz in [0.5, 0.9, 3.3, 20.0, 40.0] {
        let model = format!(
            "base quake {{ moves x }} = spectrum({POINTS}, damping = 2 %)\nbody b {{ mass = 3 kg, moves x }}\n\
             spring s: quake -- b {{ k = 3 kg * (2 * pi * {hertz} Hz)^2 }}\n\
             damper d: quake -- b {{ c = 2 * 0.02 * 3 kg * 2 * pi * {hertz} Hz }}\n\
             output sway = b.x - quake.x\noutput pull = s.force\noutput load = b.ax\n"
        );
        let omega = 2.0 * PI * hertz;
        for (more, rigid) in [(&[][..], hertz > 33.0), (&["--missing-mass"], false)] {
            let all = maxima(&model, more);
            let found = &all["directions"][0];
            let whole = at(hertz);
            for (place, truth) in [whole / omega.powi(2), 3.0 * whole, whole].into_iter().enumerate() {
                let output = &found["outputs"][place];
                // Above the highest point it does not swing: what is missing has to be asked for.
                let shown = if rigid { 0.0 } else { truth };
                meets(output, "srss", shown);
                meets(output, "cqc", shown);
                meets(output, "missing", if hertz > 33.0 { truth } else { 0.0 });
                assert_eq!(output["of"], ["relative", "relative", "absolute"][place]);
            }
            assert_eq!(found["missing_mass"].as_f64().map(f64::round), Some(if hertz > 33.0 { 3.0 } else { 0.0 }));
        }
    }
}

/// Two equal storeys, whose modes are the golden section's, and a third spring whose mode is rigid: contributions by hand.
#[test]
fn two_storeys_are_combined_by_hand() {
    let model = format!(
        "damping modal 5 %\nbase quake {{ moves x }} = spectrum({POINTS}, damping = 5 %)\n\
         body a {{ mass = 2 kg, moves x }}\nbody b {{ mass = 2 kg, moves x }}\n\
         spring s: quake -- a {{ k = 2 kN/m }}\nspring t: a -- b {{ k = 2 kN/m }}\n\
         output top = b.x - quake.x\noutput shear = s.force\noutput load = b.ax\noutput between in mm = b.x - a.x\n"
    );
    let found = maxima(&model, &[])["directions"][0].clone();
    let zeta = 0.05f64;
    // omega^2 = 1000 (3 -+ sqrt 5) / 2, shapes (1, x) with x = 2 - omega^2 / 1000.
    let modes: Vec<(f64, [f64; 2], f64)> = [-1.0, 1.0]
        .into_iter()
        .map(|sign| {
            let square = 1000.0 * (3.0 + sign * 5f64.sqrt()) / 2.0;
            let x = 2.0 - square / 1000.0;
            let norm = (2.0 * (1.0 + x * x)).sqrt();
            let shape = [1.0 / norm, x / norm];
            (square.sqrt(), shape, 2.0 * (shape[0] + shape[1]))
        })
        .collect();
    let r = modes[1].0 / modes[0].0;
    let rho = 8.0 * zeta * zeta * (1.0 + r) * r.powf(1.5)
        / ((1.0 - r * r).powi(2) + 4.0 * zeta * zeta * r * (1.0 + r).powi(2));
    type Part<'a> = &'a dyn Fn(&(f64, [f64; 2], f64)) -> f64;
    let rows: [Part; 4] = [
        &|(w, x, g)| x[1] * g * at(w / (2.0 * PI)) / (w * w),
        &|(w, x, g)| 2000.0 * x[0] * g * at(w / (2.0 * PI)) / (w * w),
        &|(w, x, g)| x[1] * g * at(w / (2.0 * PI)),
        &|(w, x, g)| 1000.0 * (x[1] - x[0]) * g * at(w / (2.0 * PI)) / (w * w),
    ];
    for (place, row) in rows.into_iter().enumerate() {
        let [one, other] = [row(&modes[0]), row(&modes[1])];
        let output = &found["outputs"][place];
        meets(output, "srss", one.hypot(other));
        meets(output, "cqc", (one * one + other * other + 2.0 * rho * one * other).sqrt());
        meets(output, "missing", 0.0);
    }
}

/// Towers of one frequency swing in phase, whether nothing joins them or a spring does that is never stretched: 6 kg times the spectrum's
/// acceleration at the base, with a third mode by itself, in whatever order they are declared. With different damping they are two.
#[test]
fn towers_of_one_frequency_swing_as_one() {
    let omega = 2.0 * PI * 3.0;
    let tower = |name: &str, m: f64, ratio: f64| {
        format!(
            "body {name} {{ mass = {m} kg, moves x }}\nspring s_{name}: quake -- {name} {{ k = {m} kg * (2 * pi * 3 Hz)^2 }}\n\
             damper d_{name}: quake -- {name} {{ c = {} kg * 2 * pi * 3 Hz }}\n",
            2.0 * ratio * m
        )
    };
    let other = "body o { mass = 4 kg, moves x }\nspring s_o: quake -- o { k = 4 kg * (2 * pi * 7 Hz)^2 }\n\
                 damper d_o: quake -- o { c = 2 * 0.05 * 4 kg * 2 * pi * 7 Hz }\n";
    let asked = "output sway = a.x - quake.x\noutput gap = a.x - b.x\noutput gap3 = a.x + b.x - 2 * c.x\n\
                 output shear = s_a.force + s_b.force + s_c.force + s_o.force\n";
    let scene = |parts: [&str; 4], joined: &str| {
        format!("base quake {{ moves x }} = spectrum({POINTS}, damping = 5 %)\n{}{joined}{asked}", parts.concat())
    };
    let [a, b, c] = [("a", 1.0), ("b", 2.0), ("c", 3.0)].map(|(name, m)| tower(name, m, 0.05));
    let joints = ["", "spring j: a -- b { k = 50 N/m }\nspring l: b -- c { k = 70 N/m }\n"];
    for (parts, joined) in [
        ([&a[..], &b, &c, other], joints[0]),
        ([&c[..], other, &a, &b], joints[0]),
        ([&a[..], &b, &c, other], joints[1]),
    ] {
        let found = maxima(&scene(parts, joined), &[])["directions"][0].clone();
        let value = |output: usize, field: &str| found["outputs"][output][field].as_f64().expect("a number");
        meets(&found["outputs"][0], "srss", at(3.0) / omega.powi(2));
        for gap in [1, 2] {
            assert!(value(gap, "srss") < 1e-15 && value(gap, "cqc") < 1e-9, "{found}");
        }
        meets(&found["outputs"][3], "srss", (6.0 * at(3.0)).hypot(4.0 * at(7.0)));
    }
    let other_damping = scene([&tower("a", 1.0, 0.02), &b, &c, other], "");
    let found = maxima(&other_damping, &["--other-damping"])["directions"][0].clone();
    // eta of EN 1998-1 for 2 %
    let more = (0.1f64 / 0.07).sqrt() * at(3.0);
    meets(&found["outputs"][3], "srss", more.hypot(5.0 * at(3.0)).hypot(4.0 * at(7.0)));
}

/// Chopra, Dynamics of Structures, section 13.8: the five-storey shear frame (100 kips a floor, 31.54 kips/in a storey, 5 %) under El
/// Centro. Of the printed base shears of the modes follow the values of the spectrum; SRSS and CQC of the base shear and of the top
/// storey's are compared with the printed ones (tables 13.8.4 and 13.8.5: 66.066, 66.507, 30.074, 29.338 kips).
#[test]
fn the_five_storey_frame_of_chopra() {
    const KIP: f64 = 4_448.221_615_260_5;
    const INCH: f64 = 0.0254;
    let shears = [60.469, 24.533, 9.867, 2.943, 0.595];
    let (m, k) = (100.0 * KIP / (386.09 * INCH), 31.54 * KIP / INCH);
    // Shapes sin((2 n - 1) j pi / 11), omega = 2 sqrt(k / m) sin((2 n - 1) pi / 22).
    let points = shears.iter().enumerate().flat_map(|(n, shear)| {
        let angle = (2 * n + 1) as f64 * PI / 11.0;
        let shape: Vec<f64> = (1..=5).map(|j| (angle * j as f64).sin()).collect();
        let (sum, square) = (shape.iter().sum::<f64>(), shape.iter().map(|x| x * x).sum::<f64>());
        let hertz = 2.0 * (k / m).sqrt() * (0.5 * angle).sin() / (2.0 * PI);
        let value = shear * KIP / (m * sum * sum / square);
        [(0.99 * hertz, value), (1.01 * hertz, value)]
    });
    let points: Vec<String> = points.map(|(f, a)| format!("({f:.9} Hz, {a:.12} m/s^2)")).collect();
    let mut model =
        format!("damping modal 5 %\nbase quake {{ moves x }} = spectrum({}, damping = 5 %)\n", points.join(", "));
    for i in 1..=5 {
        let below = if i == 1 { "quake".to_string() } else { format!("f{}", i - 1) };
        model +=
            &format!("body f{i} {{ mass = {m:.9} kg, moves x }}\nspring s{i}: {below} -- f{i} {{ k = {k:.9} N/m }}\n");
    }
    model += "output base_shear = s1.force\noutput top = s5.force\n";
    let found = maxima(&model, &[])["directions"][0].clone();
    for (place, srss, cqc) in [(0, 66.066, 66.507), (1, 30.074, 29.338)] {
        for (field, printed) in [("srss", srss), ("cqc", cqc)] {
            let value = found["outputs"][place][field].as_f64().expect("a number") / KIP;
            // Base shears have three decimals.
            assert!((value - printed).abs() < 1.5e-3, "{field} of {place}: {value}, printed {printed}");
        }
    }
}

/// Code_Aster's SDLD301: two masses between two supports with spectra of their own, S = a w^2 / |w_0^2 - w^2|, undamped and
/// independent of each other. With m = 2533 kg and k = 1e5, 2e5, 1e5 N/m the modes are sqrt(k/m) and sqrt(5 k/m), a support carries 3/5
/// and 2/5 of its motion, and the participation factors are sqrt(m/2) (1, 1/5).
#[test]
fn two_supports_have_spectra_of_their_own() {
    let squares = [1e5 / 2533.0, 5e5 / 2533.0];
    let spectrum = |hertz: f64| -> [f64; 2] { squares.map(|w| 0.5 * w / ((2.0 * PI * hertz).powi(2) - w).abs()) };
    let words = |[one, other]: [f64; 2]| {
        format!(
            "spectrum((0.9 Hz, {one:.17} m/s^2), (1.1 Hz, {one:.17} m/s^2), (2.1 Hz, {other:.17} m/s^2), (2.4 Hz, {other:.17} m/s^2), damping = 0 %)"
        )
    };
    let (left, right) = (spectrum(1.5), spectrum(2.0));
    let model = format!(
        "base no1 {{ moves x }} = {}\nbase no4 {{ moves x }} = {}\nbody a {{ mass = 2533 kg, moves x }}\n\
         body b {{ mass = 2533 kg, moves x }}\nspring k1: no1 -- a {{ k = 100 kN/m }}\nspring k2: a -- b {{ k = 200 kN/m }}\n\
         spring k3: b -- no4 {{ k = 100 kN/m }}\noutput da = a.x - 0.6 * no1.x - 0.4 * no4.x\n\
         output db = b.x - 0.4 * no1.x - 0.6 * no4.x\noutput aa = a.ax\n",
        words(left),
        words(right)
    );
    let all = maxima(&model, &["--across-directions"]);
    let part = |s: [f64; 2], order: i32| [0.5 * s[0] / squares[0].powi(order), 0.1 * s[1] / squares[1].powi(order)];
    let size = |[a, b]: [f64; 2]| a.hypot(b);
    for (place, order) in [(0, 1), (1, 1), (2, 0)] {
        let (one, other) = (size(part(left, order)), size(part(right, order)));
        meets(&all["directions"][0]["outputs"][place], "srss", one);
        meets(&all["directions"][1]["outputs"][place], "srss", other);
        meets(&all["across_directions"][place], "srss", one.hypot(other));
        meets(&all["across_directions"][place], "cqc", one.hypot(other));
    }
}

/// EN 1998-1:2004, 3.2.2.2 (3): eta = sqrt(10 / (5 + xi)), at least 0.55, of a spectrum for 5 %; of another one the ratio of two. CQC takes
/// the damping of each mode, a rigid mode is not corrected, and without the option the direction is refused.
#[test]
fn a_spectrum_is_corrected_for_other_damping() {
    let eta = |zeta: f64| (0.10 / (0.05 + zeta)).sqrt().max(0.55);
    let scene = |spectrum: f64, mode: f64| {
        format!(
            "base quake {{ moves x }} = spectrum({POINTS}, damping = {spectrum})\nbody b {{ mass = 3 kg, moves x }}\n\
             spring s: quake -- b {{ k = 3 kg * (2 * pi * 3.3 Hz)^2 }}\ndamping modal {mode}\noutput pull = s.force\n"
        )
    };
    for (spectrum, mode) in [(0.05, 0.02), (0.05, 0.1), (0.02, 0.05), (0.05, 0.4), (0.1, 0.0)] {
        let all = maxima(&scene(spectrum, mode), &["--other-damping"]);
        assert_eq!(all["damping_corrected"], true);
        let found = &all["directions"][0];
        let factor = eta(mode) / eta(spectrum);
        meets(&found["outputs"][0], "srss", 3.0 * at(3.3) * factor);
        meets(&found["corrected_modes"][0], "factor", factor);
        assert_eq!(found["corrected_modes"][0]["mode"], 1);
        let refused = maxima(&scene(spectrum, mode), &[])["directions"][0].clone();
        assert!(refused["reason"].as_str().is_some_and(|reason| reason.contains("--other-damping")), "{refused}");
    }
    let report = text(&scene(0.05, 0.02), &["analyze", "--other-damping"]);
    assert!(
        report.contains("mode 1: damping 2.00000 %, for which the spectrum is corrected by the factor 1.19523"),
        "{report}"
    );
    let same = maxima(&scene(0.05, 0.05), &["--other-damping"]);
    assert_eq!(same["directions"][0]["corrected_modes"].as_array().map(Vec::len), Some(0));
    let stiff = scene(0.05, 0.02).replace("3.3 Hz", "40 Hz");
    let found = maxima(&stiff, &["--other-damping", "--missing-mass"])["directions"][0].clone();
    assert_eq!(found["corrected_modes"].as_array().map(Vec::len), Some(0));
    meets(&found["outputs"][0], "srss", 9.0);
}

/// A light body on a stiff spring: its mode has 1e-24 of the mass, and a hundredth of the force of the spring. It counts like any other and
/// is corrected too.
#[test]
fn a_mode_that_hardly_moves_counts() {
    let scene = |damping: &str| {
        format!(
            "base quake {{ moves x }} = spectrum((0.1 Hz, 1 m/s^2), (0.2 Hz, 1 m/s^2), (1000 Hz, 1e7 m/s^2), (1e7 Hz, 1e7 m/s^2), damping = 5 %)\n\
             body heavy {{ mass = 1 t, moves x }}\nbody light {{ mass = 1 g, moves x }}\nspring soft: quake -- heavy {{ k = 1 kN/m }}\n\
             spring stiff: heavy -- light {{ k = 1 MN/m }}\n{damping}\noutput pull = stiff.force\n"
        )
    };
    let [plain, corrected] = ["5 %", "2 %"]
        .map(|ratio| maxima(&scene(&format!("damping modal {ratio}")), &["--other-damping"])["directions"][0].clone());
    let factor = (0.10f64 / 0.07).sqrt();
    meets(&corrected["outputs"][0], "srss", factor * plain["outputs"][0]["srss"].as_f64().expect("a number"));
    assert_eq!(corrected["corrected_modes"].as_array().map(Vec::len), Some(2));
}

/// A frame along two directions: SRSS over them on request, and a direction that does not move an output adds nothing.
#[test]
fn directions_are_combined_on_request() {
    let model = format!(
        "base east {{ moves x }} = spectrum({POINTS}, damping = 0 %)\n\
         base north {{ moves y }} = spectrum((0.5 Hz, 1 m/s^2), (33 Hz, 1 m/s^2), damping = 0 %)\n\
         body b {{ mass = 1 kg, at = (0, 0), moves x y }}\n\
         spring s: east -- b {{ k = 400 N/m, along = x }}\nspring t: north -- b {{ k = 900 N/m, along = y }}\n\
         output x = b.x - east.x\noutput y = b.y - north.y\noutput both = b.ax + b.ay\n"
    );
    let plain = maxima(&model, &[]);
    assert!(plain["across_directions"].is_null());
    let all = maxima(&model, &["--across-directions"]);
    let first = at(20.0 / (2.0 * PI));
    for (place, truth) in [first / 400.0, 1.0 / 900.0, first.hypot(1.0)].into_iter().enumerate() {
        meets(&all["across_directions"][place], "srss", truth);
        meets(&all["across_directions"][place], "cqc", truth);
    }
    meets(&all["directions"][1]["outputs"][2], "srss", 1.0);
}

/// Velocities and displacements are converted; a table is read as points.
#[test]
fn spectra_have_three_units() {
    let scene = |signal: &str| {
        format!(
            "damping modal 5 %\nbase quake {{ moves x }} = {signal}\nbody b {{ mass = 1 kg, moves x }}\n\
             spring s: quake -- b {{ k = 400 N/m }}\noutput x = b.x - quake.x\n"
        )
    };
    let hertz = 20.0 / (2.0 * PI);
    let value = |signal: &str| maxima(&scene(signal), &[])["directions"][0]["outputs"][0].clone();
    meets(
        &value("spectrum((1 Hz, 0.1 m/s), (10 Hz, 0.4 m/s), damping = 5 %)"),
        "srss",
        0.1 * 4f64.powf(hertz.log10()) / 20.0,
    );
    meets(&value("spectrum((1 Hz, 30 mm), (10 Hz, 3 mm), damping = 5 %)"), "srss", 0.03 / hertz);
}

/// A table has the maxima of the same points.
#[test]
fn a_table_is_read_as_points() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let run = |signal: &str| -> Value {
        let model = format!(
            "damping modal 5 %\nbase quake {{ moves x }} = {signal}\nbody b {{ mass = 1 kg, moves x }}\n\
             spring s: quake -- b {{ k = 400 N/m }}\noutput x = b.x - quake.x\n"
        );
        std::fs::write(folder.path().join("m.vib"), model).expect("a file");
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_vibc"));
        let command = command.args(["analyze", "m.vib", "--format", "json"]).current_dir(folder.path());
        let output = command.output().expect("the program starts");
        let text = String::from_utf8_lossy(&output.stderr);
        serde_json::from_slice(&output.stdout).unwrap_or_else(|_| Value::from(text.into_owned()))
    };
    let rows = "frequency [Hz],acc [g0]\n0.5,0.3\n2,0.8\n9,0.8\n33,0.3\n";
    std::fs::write(folder.path().join("s.csv"), rows).expect("a file");
    let points = "spectrum((0.5 Hz, 0.3 g0), (2 Hz, 0.8 g0), (9 Hz, 0.8 g0), (33 Hz, 0.3 g0), damping = 5 %)";
    let [table, written] = ["spectrum(table(\"s.csv\", 1 g0), damping = 5 %)", points].map(run);
    assert!(written["response_spectra"]["directions"][0]["outputs"][0]["srss"].is_number(), "{written}");
    assert_eq!(table["response_spectra"], written["response_spectra"], "{table}");
    std::fs::write(folder.path().join("s.csv"), "0,1\n2,3\n").expect("a file");
    let refused = run("spectrum(table(\"s.csv\", 1 g0), damping = 5 %)");
    assert!(refused.as_str().is_some_and(|text| text.contains("vib::spectrum::points")), "{refused}");
}

/// What a spectrum does not say is said, with its reason.
#[test]
fn what_has_no_maximum_is_named() {
    let scene = |damper: &str, spectrum: &str| {
        format!(
            "base quake {{ moves x }} = spectrum({spectrum})\nbody b {{ mass = 1 kg, moves x }}\nbody c {{ mass = 2 kg, moves x }}\n\
             spring s: quake -- b {{ k = 400 N/m }}\nspring t: b -- c {{ k = 300 N/m }}\n{damper}\n\
             output far = c.x\noutput speed = b.vx\noutput slip = c.ax - quake.ax\noutput sway = c.x - b.x\n"
        )
    };
    let usual = format!("{POINTS}, damping = 5 %");
    let found = maxima(&scene("damping modal 5 %", &usual), &[])["directions"][0].clone();
    for (place, why) in ["an absolute displacement", "a velocity", "relative to the base"].into_iter().enumerate() {
        assert!(found["outputs"][place]["reason"].as_str().is_some_and(|reason| reason.contains(why)), "{found}");
        assert!(found["outputs"][place]["srss"].is_null());
    }
    assert!(found["outputs"][3]["srss"].is_number());
    for (damper, spectrum, why) in [
        ("damper d: b -- c { c = 3 N*s/m }", usual.as_str(), "couple the modes"),
        ("damping modal 4 %", &usual, "mode 1 has a damping ratio of 4.000 %, and the spectrum is for 5.000 %"),
        (
            "damping modal 5 %",
            "(5 Hz, 1 m/s^2), (9 Hz, 1 m/s^2), damping = 5 %",
            "mode 1 lies below the lowest frequency",
        ),
        ("damper d: ground -- b { c = 1 N*s/m }\ndamper e: ground -- c { c = 2 N*s/m }", &usual, ""),
    ] {
        let found = maxima(&scene(damper, spectrum), &[])["directions"][0].clone();
        let reason = found["reason"].as_str().unwrap_or_else(|| panic!("{damper}: {found}"));
        assert!(reason.contains(why), "{damper}: {reason}");
        assert!(text(&scene(damper, spectrum), &["analyze"]).contains("by quake: "), "{damper}");
    }
}

#[test]
fn wrong_spectra_are_one_finding_each() {
    let behind = |signal: &str| {
        format!(
            "body b {{ mass = 1 kg, moves x }}\nbase q {{ moves x }} = {signal}\nspring s: q -- b {{ k = 1 N/m }}\n"
        )
    };
    for (signal, expected) in [
        ("spectrum((1 Hz, 1 m), (2 Hz, 1 m))", "vib::spectrum::damping"),
        ("spectrum((1 Hz, 1 m), (2 Hz, 1 m), damping = -5 %)", "vib::spectrum::damping"),
        ("spectrum((1 Hz, 1 m), damping = 5 %)", "vib::signal::arguments"),
        ("spectrum(1 Hz, 2 m, damping = 5 %)", "vib::signal::arguments"),
        ("spectrum(damping = 5 %)", "vib::signal::arguments"),
        ("spectrum((1 Hz, 1 m), (2 Hz, 1 m), ratio = 5 %)", "vib::signal::arguments"),
        ("spectrum((0 Hz, 1 m), (2 Hz, 1 m), damping = 5 %)", "vib::spectrum::points"),
        ("spectrum((1 Hz, 1 m), (1 Hz, 1 m), damping = 5 %)", "vib::spectrum::points"),
        ("spectrum((1 Hz, 1 m), (2 Hz, 0 m), damping = 5 %)", "vib::spectrum::points"),
        ("spectrum((1 Hz, 1 m), (2 Hz, 1 m/s), damping = 5 %)", "vib::signal::differ"),
        ("spectrum((1 Hz, 1 N), (2 Hz, 1 N), damping = 5 %)", "vib::unit::mismatch"),
        ("spectrum((1 Hz, 1 m), (2 Hz, 1 m), damping = 5 kg)", "vib::unit::mismatch"),
        ("step(1 m, 0 s) + spectrum((1 Hz, 1 m), (2 Hz, 1 m), damping = 5 %)", "vib::spectrum::input"),
    ] {
        assert_eq!(code(&behind(signal), &["check"]), expected, "{signal}");
    }
    // No shock spectrum of a spectrum, and no peak without a motion.
    let right = behind("spectrum((0.1 Hz, 1 m), (2 Hz, 1 m), damping = 5 %)");
    let output = ran(&right, &["shock", "--at", "1Hz"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("a response spectrum already"));
    let delayed = right + "base r { moves x } = delayed(q, 1 s)\nspring t: r -- b { k = 1 N/m }\n";
    assert_eq!(code(&delayed, &["check"]), "vib::spectrum::input");
}
