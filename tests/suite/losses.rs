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
    assert_eq!(answer["rest"]["kind"], "stable");
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
    for measure in ["peak(x) < 1 m", "peak_gain(F -> x) < 1 m/N", "settling(x, 2 %) < 1 s"] {
        let text = told(&format!("{MODEL}require {measure}\n"), &["check"]);
        assert!(text.contains("vib::require::no_value") && text.contains("loss factor"), "{measure}: {text}");
    }
    let noise = MODEL.replace("harmonic(5 N, 1.5 Hz)", "noise(white 3 N^2/Hz)");
    assert!(told(&noise, &["simulate", "--until", "1s", "--step", "1ms", "--seed", "1"]).contains("vib::limit::loss"));
    let negative = MODEL.replace("loss = 0.1", "loss = -0.1");
    assert!(told(&negative, &["check"]).contains("vib::value::negative"));
    let law = MODEL.replace("k = 200 N/m", "law = 200 N/m * stretch");
    assert!(told(&law, &["check"]).contains("vib::law::and_coefficient"));
}

/// m s^2 + c s + k (1 + i loss) = 0 above the real axis, by the square root of its discriminant; the other root would grow, and is
/// none of the poles. Beside it an oscillator without a loss factor, whose poles are those of its own quadratic.
#[test]
fn poles_are_those_above_the_axis() {
    let (m, c, k, loss) = (2.0f64, 3.0f64, 200.0f64, 0.4f64);
    let (re, im) = (c * c - 4.0 * m * k, -4.0 * m * k * loss);
    let size = re.hypot(im);
    // The root of the discriminant with a positive imaginary part.
    let (x, y) = (-((size + re) / 2.0).sqrt(), ((size - re) / 2.0).sqrt());
    let lossy = ((x - c) / (2.0 * m), y / (2.0 * m));
    assert!(-x - c > 0.0, "the other root grows");
    let plain = (-0.5f64, (9.0f64 - 0.25).sqrt());
    let model = format!(
        "{}body other {{ mass = 1 kg, moves x }}\nspring q: ground -- other {{ k = 9 N/m }}\n\
         damper r: ground -- other {{ c = 1 N*s/m }}\nrequire stable\nrequire damping(2) > 1 %\n",
        MODEL.replace("loss = 0.1", "loss = 0.4")
    );
    let answer = json(&model, &["analyze"]);
    let poles = answer["poles"].as_array().expect("poles");
    assert_eq!(poles.len(), 4);
    for (pair, truth) in poles.chunks(2).zip([plain, lossy]) {
        for (pole, side) in pair.iter().zip([-1.0, 1.0]) {
            let number = |name: &str| pole[name].as_f64().expect(name);
            let off = (number("re") - truth.0).hypot(number("im") - side * truth.1);
            assert!(off < 1e-14 * truth.1 && number("error_bound") < 1e-15, "{pole} {truth:?}");
        }
    }
    let ratio = -lossy.0 / lossy.0.hypot(lossy.1);
    let found = answer["requirements"][1]["value"].as_f64().expect("a ratio");
    assert!((found / 100.0 - ratio).abs() < 1e-15 || (found - ratio).abs() < 1e-15, "{found} {ratio}");
}

/// The shape at a pole has the loss factor too: (m s^2 + k (1 + i loss)) x_b = k (1 + i loss) x_a of the outer mass, and the force of the
/// spring between them is k (1 + i loss) (x_b - x_a).
#[test]
fn shapes_of_damped_motions_have_it() {
    let model = "body a { mass = 2 kg, moves x }\nbody b { mass = 1 kg, moves x }\nspring s: ground -- a { k = 200 N/m, loss = 0.1 }\n\
                 spring t: a -- b { k = 100 N/m, loss = 0.3 }\nforce F: b along x\noutput pull = t.force\n";
    let answer = json(model, &["analyze", "--shapes", "damped"]);
    let number = |value: &serde_json::Value, name: &str| value[name].as_f64().expect(name);
    let times = |a: (f64, f64), b: (f64, f64)| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    let poles: Vec<_> =
        answer["poles"].as_array().expect("poles").iter().filter(|pole| number(pole, "im") > 0.0).collect();
    let shapes = answer["damped_shapes"].as_array().expect("shapes");
    assert_eq!((poles.len(), shapes.len()), (2, 2));
    for (pole, shape) in poles.into_iter().zip(shapes) {
        let s = (number(pole, "re"), number(pole, "im"));
        let entry = |name: &str| (number(&shape["shape"][name], "re"), number(&shape["shape"][name], "im"));
        let (a, b, pull) = (entry("a.x"), entry("b.x"), &shape["outputs"]["pull"]);
        let lossy = (100.0, 30.0);
        let square = times(s, s);
        let left = times((square.0 + lossy.0, square.1 + lossy.1), b);
        let right = times(lossy, a);
        assert!((left.0 - right.0).hypot(left.1 - right.1) < 1e-12, "{shape}");
        let force = times(lossy, (b.0 - a.0, b.1 - a.1));
        assert!((number(pull, "re") - force.0).hypot(number(pull, "im") - force.1) < 1e-12, "{shape} {force:?}");
    }
}

/// A damper that feeds energy in makes a pole above the axis grow: the mirror image is none, but this is a finding.
#[test]
fn a_motion_that_grows_in_spite_of_its_loss_is_found() {
    let model = MODEL.replace("c = 3 N*s/m", "c = -30 N*s/m");
    assert_eq!(json(&model, &["analyze"])["rest"]["kind"], "unstable");
    // Less of it than the loss takes: m s^2 + c s + k (1 + i loss) has its upper root on the left.
    let model = MODEL.replace("c = 3 N*s/m", "c = -1 N*s/m");
    assert_eq!(json(&model, &["analyze"])["rest"]["kind"], "stable");
    // Beside it an oscillation that only ever goes on: energy proves nothing here, and no pole is on the left for certain.
    let model = model + "body other { mass = 1 kg, moves x }\nspring o: ground -- other { k = 3 N/m }\n";
    assert_eq!(json(&model, &["analyze"])["rest"]["kind"], "undetermined");
}

/// A table without a range takes it from the poles.
#[test]
fn a_table_has_a_range_of_its_own() {
    let rows = json(MODEL, &["transfer", "--from", "F"])["pairs"][0]["values"].as_array().expect("rows").len();
    assert!(rows > 100, "{rows}");
}

/// With more coordinates than exact arithmetic takes, and with numbers that are no fractions, there are no poles, and no verdict.
#[test]
fn poles_that_are_not_found_are_told() {
    let mut chain =
        String::from("body m[0] { mass = 1 kg, moves x }\nspring s: ground -- m[0] { k = 5 N/m, loss = 0.1 }\n");
    for i in 1..13 {
        chain +=
            &format!("body m[{i}] {{ mass = 1 kg, moves x }}\nspring t[{i}]: m[{}] -- m[{i}] {{ k = 5 N/m }}\n", i - 1);
    }
    let root = MODEL.replace("200 N/m", "200 N/m * sqrt(2)");
    // A massless joint between a damper and a spring with losses has its only root below the axis.
    let joint = MODEL.to_string()
        + "body j { mass = 0 kg, moves x }\nspring u: block -- j { k = 9 N/m, loss = 0.2 }\n\
           damper v: j -- ground { c = 1 N*s/m }\n";
    // Of three equal masses about a fourth, two motions have the same pole.
    let star = "body hub { mass = 1 kg, moves x }\nspring s: ground -- hub { k = 5 N/m }\n".to_string()
        + &["a", "b", "c"]
            .map(|m| {
                format!("body {m} {{ mass = 1 kg, moves x }}\nspring s{m}: hub -- {m} {{ k = 7 N/m, loss = 0.1 }}\n")
            })
            .concat();
    // What holds no loss factor is no obstacle, and has poles of its own; where one part has none, there are none.
    let beside = chain.clone() + "body other { mass = 1 kg, moves x }\nspring o: ground -- other { k = 1 N/m }\n";
    for model in [chain, root, joint, star, beside] {
        let answer = json(&model, &["analyze"]);
        assert_eq!(answer["poles"].as_array().map(Vec::len), Some(0));
        assert_eq!(answer["rest"]["kind"], "undetermined");
        let text = told(&format!("{model}require damping(1) > 1 %\n"), &["check"]);
        assert!(text.contains("vib::require::no_value") && text.contains("loss factors"), "{text}");
    }
}

/// A loss factor of zero is none.
#[test]
fn zero_is_no_loss() {
    let plain = MODEL.replace(", loss = 0.1", "");
    let zero = MODEL.replace("loss = 0.1", "loss = 0");
    let report = |model: &str| ran(model, &["analyze"]).stdout;
    assert_eq!(report(&plain), report(&zero));
}

/// The rows of the outputs under noise.
fn noisy(model: &str) -> Vec<serde_json::Value> {
    json(model, &["analyze"])["noise"].as_array().expect("noise").clone()
}

fn near(row: &serde_json::Value, name: &str, truth: f64) {
    let (value, bound) =
        (row[name].as_f64().expect(name), row[format!("{}_error_bound", name.trim_end_matches("_hz"))].as_f64());
    assert!(
        (value - truth).abs() <= 1e-13 * truth && bound.is_some_and(|bound| bound < 1e-15),
        "{name} {truth}: {row}"
    );
}

/// Under white noise of the density S the integral of 1 / |z - w^2|^2, z = k (1 + i loss) / m, by its residues at the roots of z:
/// rms^2 = S re(root z) / (4 m^2 im z |z|), that of the rate S re(root z) / (4 m^2 im z), and so |z|^(1/2) / 2 pi crossings a second.
#[test]
fn white_noise_has_the_closed_form() {
    for loss in [1e-4f64, 0.1, 2.0] {
        let model = format!(
            "body b {{ mass = 2 kg, moves x }}\nspring s: ground -- b {{ k = 200 N/m, loss = {loss} }}\n\
             force F: b along x = noise(white 3 N^2/Hz)\noutput x = b.x\noutput v = b.vx\noutput pull = s.force\noutput a = b.ax\n\
             require rms(x) < 9 m\nrequire psd(x, 1.5 Hz) < 1 m^2/Hz\n"
        );
        let (re, im) = (100.0f64, 100.0 * loss);
        let size = re.hypot(im);
        let square = 3.0 * ((size + re) / 2.0).sqrt() / (16.0 * im * size);
        let rows = noisy(&model);
        near(&rows[0], "rms", square.sqrt());
        near(&rows[0], "crossings_hz", size.sqrt() / (2.0 * PI));
        near(&rows[1], "rms", (square * size).sqrt());
        near(&rows[2], "rms", square.sqrt() * 200.0 * 1f64.hypot(loss));
        for (row, infinite) in [(&rows[1], "crossings_reason"), (&rows[3], "rms_reason")] {
            assert!(
                row[infinite].as_str().is_some_and(|why| why.starts_with("infinite: white noise reaches it")),
                "{row}"
            );
        }
        let [peak] = &rows[0]["peaks"].as_array().expect("peaks")[..] else { panic!("{}", rows[0]) };
        near(peak, "frequency_hz", 10.0 / (2.0 * PI));
        near(peak, "density", 3.0 / (200.0 * loss).powi(2));
        let found = json(&model, &["analyze"]);
        let w = 3.0 * PI;
        let density = 3.0 / ((200.0 - 2.0 * w * w).powi(2) + (200.0 * loss).powi(2));
        let told = found["requirements"]
            .as_array()
            .expect("requirements")
            .iter()
            .map(|row| row["value"].as_f64().expect("value"));
        for (told, truth) in told.zip([square.sqrt(), density]) {
            assert!((told - truth).abs() <= 1e-13 * truth, "{told} {truth}");
        }
    }
}

/// Base motion by its acceleration, white: relative to the base as under a force of -m a. In a band with hardly any loss it is what it
/// is without, up to the square of the loss.
#[test]
fn noise_of_a_base_and_in_bands() {
    let relative = noisy(
        "base g { moves x } = noise(white 3 m^2/s^4/Hz)\nbody b { mass = 2 kg, moves x }\n\
         spring s: g -- b { k = 200 N/m, loss = 0.1 }\noutput z = b.x - g.x\noutput x = b.x\n",
    );
    let size = 100.0f64.hypot(10.0);
    near(&relative[0], "rms", (3.0 * ((size + 100.0) / 2.0).sqrt() / (4.0 * 10.0 * size)).sqrt());
    assert!(relative[1]["rms_reason"].as_str().is_some_and(|why| why.contains("drifts")), "{}", relative[1]);
    let model = |loss: &str, noise: &str| {
        format!(
            "body b {{ mass = 2 kg, moves x }}\nbody c {{ mass = 1 kg, moves x }}\nspring s: ground -- b {{ k = 200 N/m{loss} }}\n\
             spring t: b -- c {{ k = 300 N/m{loss} }}\ndamper d: b -- c {{ c = 0.3 N*s/m }}\ndamper e: ground -- b {{ c = 0.1 N*s/m }}\n\
             force F: b along x = noise({noise})\nforce G: c along x = delayed(F, 0.3 s)\noutput x = c.x\n"
        )
    };
    for noise in ["5 N^2/Hz, 0 Hz .. 4 Hz", "(0.2 Hz, 1 N^2/Hz), (2 Hz, 7 N^2/Hz), (9 Hz, 0.1 N^2/Hz)"] {
        let [plain, lossy] =
            ["", ", loss = 1e-9"].map(|loss| noisy(&model(loss, noise))[0]["rms"].as_f64().expect("rms"));
        // To first order the loss factor is a damper beside those there are, which are ten million times as large.
        let off = (plain - lossy) / plain;
        assert!(off > 1e-10 && off < 1e-6, "{noise}: {off}");
    }
}

/// White displacement of a base pushes two masses at once; with equal springs that cancels in the difference of their accelerations, but
/// not what different loss factors add: no finite number is told.
#[test]
fn what_a_loss_factor_passes_on_at_once_is_not_forgotten() {
    let rows = noisy(
        "base g { moves x } = noise(white 3 m^2/Hz)\nbody b { mass = 1 kg, moves x }\nbody c { mass = 1 kg, moves x }\n\
         spring s: g -- b { k = 200 N/m, loss = 0.1 }\nspring t: g -- c { k = 200 N/m, loss = 0.3 }\n\
         output a = b.ax - c.ax\noutput x = b.x - c.x\n",
    );
    assert!(rows[0]["rms"].is_null() && rows[0]["rms_reason"].is_string(), "{}", rows[0]);
    assert!(rows[1]["rms"].is_f64(), "{}", rows[1]);
}

/// Two equal masses between three equal springs of one loss factor: the modes are those without it, H_i = 1/2 / (w_i^2 (1 + i loss) - w^2),
/// and a mode's share is the integral of re H_i conj H over that of |H|^2, here by Simpson's rule.
#[test]
fn shares_of_modes_under_loss_factors() {
    let loss = 0.2;
    let model = format!(
        "body a {{ mass = 1 kg, moves x }}\nbody b {{ mass = 1 kg, moves x }}\n\
         spring r: ground -- a {{ k = 100 N/m, loss = {loss} }}\nspring s: a -- b {{ k = 100 N/m, loss = {loss} }}\n\
         spring t: b -- ground {{ k = 100 N/m, loss = {loss} }}\nforce F: a along x = NOISE\noutput x = a.x\noutput v = a.vx\n"
    );
    let integrals = |[from, to]: [f64; 2], power: i32| {
        let (count, mut sums) = (400_000, [0.0; 2]);
        let step = (to - from) / f64::from(count);
        for i in 0..=count {
            let w = from + step * f64::from(i);
            let weight = if i == 0 || i == count { 1.0 } else { f64::from(2 + 2 * (i % 2)) } * w.powi(power);
            let of = |square: f64| {
                let (re, im) = (square - w * w, square * loss);
                [0.5 * re / (re * re + im * im), -0.5 * im / (re * re + im * im)]
            };
            let (one, two) = (of(100.0), of(300.0));
            for (sum, own) in sums.iter_mut().zip([one, two]) {
                *sum += weight * (own[0] * (one[0] + two[0]) + own[1] * (one[1] + two[1]));
            }
        }
        sums.map(|sum| sum / (sums[0] + sums[1]))
    };
    let whole = [1e-9, 2000.0];
    let band = [2.0 * PI, 6.0 * PI];
    for (noise, range, outputs) in [("noise(white 1 N^2/Hz)", whole, 1), ("noise(1 N^2/Hz, 1 Hz .. 3 Hz)", band, 2)] {
        let rows = noisy(&model.replace("NOISE", noise));
        for (index, row) in rows.iter().enumerate().take(outputs) {
            let truth = integrals(range, 2 * index as i32);
            let told = row["modes"].as_array().expect("modes");
            assert_eq!(told.len(), 2, "{row}");
            for share in told {
                let number = share["mode"].as_u64().expect("a number") as usize;
                let off = share["share"].as_f64().expect("a share") - truth[number - 1];
                assert!(off.abs() < 1e-8, "{row} {truth:?}");
            }
        }
    }
}

/// An acceleration in a band has crossings: the root of the quotient of the integrals of w^6 and w^4 over |k (1 + i loss) - m w^2|^2, here
/// by Simpson's rule. Under white noise it has none.
#[test]
fn crossings_of_an_acceleration() {
    let model = |noise: &str| {
        format!(
            "body b {{ mass = 2 kg, moves x }}\nspring s: ground -- b {{ k = 200 N/m, loss = 0.1 }}\n\
             force F: b along x = {noise}\noutput a = b.ax\n"
        )
    };
    let integral = |power: i32| {
        let count = 20_000;
        let step = 4.0 * PI / f64::from(count);
        let of = |i: i32| {
            let w = 2.0 * PI + step * f64::from(i);
            let weight = if i == 0 || i == count { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
            weight * w.powi(power) / ((200.0 - 2.0 * w * w).powi(2) + 400.0)
        };
        (0..=count).map(of).sum::<f64>()
    };
    let row = &noisy(&model("noise(3 N^2/Hz, 1 Hz .. 3 Hz)"))[0];
    let told = row["crossings_hz"].as_f64().expect("crossings");
    let truth = (integral(6) / integral(4)).sqrt() / (2.0 * PI);
    // Simpson's rule is off by some 1e-11 in this band.
    assert!((told / truth - 1.0).abs() < 1e-9, "{row} {truth}");
    let white = &noisy(&model("noise(white 3 N^2/Hz)"))[0];
    assert!(white["crossings_reason"].as_str().is_some_and(|why| why.contains("mean square is infinite")), "{white}");
}

/// What moves apart is told apart: an oscillator with loss beside one that nothing damps, in whose band the noise excites it without
/// end. Of their difference nothing is told.
#[test]
fn parts_with_and_without_losses() {
    let rows = noisy(
        "body b { mass = 2 kg, moves x }\nbody c { mass = 1 kg, moves x }\nspring s: ground -- b { k = 200 N/m, loss = 0.1 }\n\
         spring t: ground -- c { k = 300 N/m }\nforce F: b along x = noise(white 3 N^2/Hz)\n\
         force G: c along x = noise(5 N^2/Hz, 1 Hz .. 5 Hz)\noutput x = b.x\noutput z = c.x\noutput d = b.x - c.x\n",
    );
    let size = 100.0f64.hypot(10.0);
    near(&rows[0], "rms", (3.0 * ((size + 100.0) / 2.0).sqrt() / (16.0 * 10.0 * size)).sqrt());
    assert!(rows[1]["rms_reason"].as_str().is_some_and(|why| why.contains("nothing damps mode 2")), "{}", rows[1]);
    assert!(rows[2]["rms_reason"].as_str().is_some_and(|why| why.contains("takes too long")), "{}", rows[2]);
}

/// A delay that turns the phase more often than can be integrated is refused before it is.
#[test]
fn a_delay_that_is_too_long_is_refused_at_once() {
    let rows = noisy(
        "body b { mass = 2 kg, moves x }\nspring s: ground -- b { k = 200 N/m, loss = 0.1 }\n\
         force F: b along x = noise(3 N^2/Hz, 1 Hz .. 10 kHz)\nforce G: b along x = delayed(F, 1000 s)\noutput x = b.x\n",
    );
    assert!(rows[0]["rms_reason"].as_str().is_some_and(|why| why.contains("phase turns too often")), "{}", rows[0]);
}
