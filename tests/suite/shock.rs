//! Shock response spectra beside closed forms of single oscillators, and what is refused. See docs/method/shock.md.

use serde_json::Value;
use std::f64::consts::PI;
use std::fs;
use std::process::{Command, Output};

fn ran(model: &str, table: &str, arguments: &[&str]) -> Output {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("m.vib"), model).expect("a file");
    fs::write(folder.path().join("t.csv"), table).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    command.args(["shock", "m.vib"]).args(arguments).current_dir(folder.path()).output().expect("the program starts")
}

fn model(signal: &str) -> String {
    format!("body b {{ mass = 1 kg, moves x }}\nbase g {{ moves x }} = {signal}\nspring s: g -- b {{ k = 1 N/m }}\n")
}

/// A row of the first spectrum.
struct Row(Value, usize);

impl Row {
    /// The value holds its bound, up to the rounding of the truth, and the bound is sharp.
    fn meets(&self, field: &str, truth: f64, sharp: f64) {
        let number = |field: &str| self.0[field][self.1].as_f64().unwrap_or_else(|| panic!("{field} in {}", self.0));
        let (value, bound) = (number(field), number(&format!("{field}_error_bounds")));
        let at = number("frequency_hz");
        let off = (value - truth).abs();
        assert!(
            off <= bound + 4e-14 * truth.abs().max(1e-3),
            "{field} at {at} Hz: {value:e} ± {bound:e}, not {truth:e}"
        );
        assert!(bound <= sharp, "{field} at {at} Hz: {value:e} ± {bound:e}");
    }

    fn all(&self, primary: [f64; 2], residual: [f64; 2]) {
        for (part, sides) in [("primary", primary), ("residual", residual)] {
            for (side, truth) in ["positive", "negative"].into_iter().zip(sides) {
                self.meets(&format!("{part}_{side}"), truth, 1e-10);
            }
        }
        let largest = primary.into_iter().chain(residual).fold(0.0, f64::max);
        self.meets("maximax", largest, 1e-10);
    }
}

fn spectrum(signal: &str, table: &str, arguments: &[&str]) -> (Value, usize) {
    let output = ran(&model(signal), table, &[arguments, &["--format", "json"]].concat());
    assert!(output.status.success(), "{signal}\n{}", String::from_utf8_lossy(&output.stderr));
    let whole: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let spectrum = whole["spectra"][0].clone();
    let count = spectrum["frequency_hz"].as_array().expect("frequencies").len();
    (spectrum, count)
}

/// The row of one frequency.
fn at(signal: &str, table: &str, damping: &str, hertz: f64, more: &[&str]) -> Row {
    let frequency = format!("--at={hertz}Hz");
    let (spectrum, _) = spectrum(signal, table, &[&["--damping", damping, &frequency], more].concat());
    Row(spectrum, 0)
}

/// A half sine without damping, a = sin(pi t / T): forced motion with its maxima where cos Omega t = cos omega t, and the
/// residual amplitude (Harris and Crede, Shock and Vibration Handbook, chapter 8).
#[test]
fn a_half_sine_has_its_closed_form() {
    let duration = 0.011;
    for ratio in [0.05, 0.3, 0.49, 0.81, 1.2, 2.6, 7.3, 40.2] {
        // Periods in the pulse.
        let hertz: f64 = format!("{:.4}", ratio / duration).parse().expect("a number");
        let lambda = 1.0 / (2.0 * hertz * duration);
        let (mut positive, mut negative): (f64, f64) = (0.0, 0.0);
        for k in 1..200 {
            let turns = f64::from(k) * 2.0;
            let mut put = |value: f64| {
                positive = positive.max(value);
                negative = negative.max(-value);
            };
            if turns * lambda / (1.0 + lambda) <= 1.0 {
                put((turns * PI * lambda / (1.0 + lambda)).sin() / (1.0 - lambda));
            }
            if lambda < 1.0 && turns * lambda / (1.0 - lambda) <= 1.0 {
                put((turns * PI * lambda / (1.0 - lambda)).sin() / (1.0 + lambda));
            }
        }
        // At its end.
        let end = -lambda / (1.0 - lambda * lambda) * (PI / lambda).sin();
        positive = positive.max(end);
        negative = negative.max(-end);
        let residual = 2.0 * (lambda / (1.0 - lambda * lambda) * (PI / (2.0 * lambda)).cos()).abs();
        at("half_sine(1 m/s^2, 0 s, 11 ms)", "", "0", hertz, &[]).all([positive, negative], [residual; 2]);
    }
}

/// The residual amplitude of an undamped oscillator is omega |integral of a e^(-i omega t)|: sawtooth, trapezoid, haversine, the
/// same pulse later, and its mirror image.
#[test]
fn undamped_residuals_are_fourier_transforms() {
    type Transform = fn(f64) -> (f64, f64);
    let transforms: [(&str, Transform); 3] = [
        // t on (0, 1): the integral of t sin and t cos.
        ("sawtooth(1 m/s^2, 0.25 s, 1.25 s)", |w| {
            (w.sin() / w + (w.cos() - 1.0) / (w * w), w.sin() / (w * w) - w.cos() / w)
        }),
        // Rises on (0, 0.25), falls on (0.75, 1): -a'' as four impulses.
        ("trapezoid(1 m/s^2, 0 s, 0.25 s, 0.75 s, 1 s)", |w| {
            let corners = [(0.0, 4.0), (0.25, -4.0), (0.75, -4.0), (1.0, 4.0)];
            let sum = |f: fn(f64) -> f64| corners.iter().map(|(t, size)| size * f(w * t)).sum::<f64>() / (w * w);
            (sum(f64::cos), sum(f64::sin))
        }),
        // (1 - cos 2 pi t) / 2 about its middle.
        ("haversine(-1 m/s^2, 0 s, 1 s)", |w| {
            let bump = |w: f64| (0.5 * w).sin() / w;
            (bump(w) - 0.5 * (bump(w - 2.0 * PI) + bump(w + 2.0 * PI)), 0.0)
        }),
    ];
    for (signal, transform) in transforms {
        for hertz in [0.11, 0.6, 1.37, 3.9, 21.3] {
            let w = 2.0 * PI * hertz;
            let (mut re, im) = transform(w);
            if signal.starts_with("haversine") {
                // The middles of the two waves are half a period off: e^(-i (w -+ 2 pi) / 2) = -e^(-i w / 2).
                re = 0.5 * (2.0 * (0.5 * w).sin() / w)
                    + 0.25
                        * (2.0 * (0.5 * w - PI).sin() / (w - 2.0 * PI) + 2.0 * (0.5 * w + PI).sin() / (w + 2.0 * PI));
            }
            let amplitude = w * re.hypot(im);
            let row = at(signal, "", "0%", hertz, &[]);
            row.meets("residual_positive", amplitude, 1e-11);
            row.meets("residual_negative", amplitude, 1e-11);
        }
    }
}

/// An impulse of the acceleration: y = (J / beta omega) e^(-zeta omega t) sin(beta omega t), and its limits beyond critical
/// damping. All of it comes after the event.
#[test]
fn every_damping_has_its_first_maximum() {
    let (hertz, jump) = (3.0, 0.7);
    let omega = 2.0 * PI * hertz;
    for zeta in [0.0, 1e-9, 0.05, 0.5, 0.51, 0.999, 1.0, 1.001, 2.0, 30.0] {
        let beta = (1.0f64 - zeta * zeta).abs().sqrt();
        let (first, second) = if zeta < 1.0 {
            let angle = beta.atan2(zeta);
            let size = |angle: f64| (-zeta * angle / beta).exp();
            (size(angle), size(angle + PI))
        } else if zeta == 1.0 {
            ((-1f64).exp(), 0.0)
        } else {
            // x = (e^(-slow t) - e^(-fast t)) / (2 beta)
            let (fast, slow) = (zeta + beta, 1.0 / (zeta + beta));
            let time = (fast / slow).ln() / (fast - slow);
            (((-slow * time).exp() - (-fast * time).exp()) / (fast - slow), 0.0)
        };
        let size = omega * jump;
        for signal in ["impulse(0.7 m/s, 0.2 s)", "step(0.7 m/s, 0.2 s)"] {
            let row = at(signal, "", &zeta.to_string(), hertz, &[]);
            row.all([0.0, 0.0], [size * first, size * second]);
            // Of the displacement the mass is behind first.
            let row = at(signal, "", &zeta.to_string(), hertz, &["--quantity", "relative-displacement"]);
            row.all([0.0, 0.0], [jump / omega * second, jump / omega * first]);
        }
    }
}

/// A sudden acceleration that lasts: 1 + e^(-zeta pi / beta) times itself, or just itself without oscillation.
#[test]
fn a_step_overshoots() {
    for zeta in [0.0, 0.02, 0.3, 0.7, 1.0, 4.0f64] {
        let beta = (1.0 - zeta * zeta).max(0.0).sqrt();
        let over = if beta > 0.0 { (-zeta * PI / beta).exp() } else { 0.0 };
        at("step(-2 m/s^2, 1 s)", "", &zeta.to_string(), 5.0, &[]).all([0.0, 0.0], [0.0, 2.0 * (1.0 + over)]);
        // A long pulse has the same maximum before its end.
        let row = at("pulse(2 m/s^2, 1 s, 51 s)", "", &zeta.to_string(), 5.0, &[]);
        row.meets("primary_positive", 2.0 * (1.0 + over), 1e-9);
        row.meets("primary_negative", 0.0, 1e-9);
    }
}

/// A jump of the displacement by d: the mass is left behind by d, and hurled by the damper.
#[test]
fn a_base_may_jump() {
    let (zeta, hertz, jump) = (0.1f64, 2.0, 0.03);
    let beta = (1.0 - zeta * zeta).sqrt();
    let row = at("step(30 mm, 0 s)", "", "10%", hertz, &["--quantity", "relative-displacement"]);
    // From y = d, y' = -2 zeta omega d: q stays d^2, and the first extremum is the lowest.
    let angle = PI + (beta * -2.0 * zeta).atan2(1.0 - 2.0 * zeta * zeta);
    let lowest = jump * (-zeta * angle / beta).exp();
    // The value at the jump itself belongs to the signal, too.
    row.meets("residual_negative", jump, 1e-12);
    row.meets("residual_positive", lowest, 1e-12);
    row.meets("maximax", jump, 1e-12);
}

/// The same motion by its acceleration, its velocity and its displacement.
#[test]
fn derivatives_of_the_base_agree() {
    let pairs = [
        ("pulse(3 m/s^2, 0.5 s, 1.5 s)", "ramp(3 m/s, 0.5 s, 1.5 s)"),
        ("step(3 m/s^2, 0 s) + step(-3 m/s^2, 1 s) + impulse(-3 m/s, 1 s)", "sawtooth(3 m/s, 0 s, 1 s)"),
        ("impulse(2 m/s, 0 s) + impulse(-2 m/s, 0.75 s)", "ramp(1.5 m, 0 s, 0.75 s)"),
    ];
    for (one, other) in pairs {
        for zeta in ["0", "0.07", "1.5"] {
            let [a, b] = [one, other].map(|signal| at(signal, "", zeta, 1.3, &[]));
            for field in ["maximax", "primary_positive", "primary_negative", "residual_positive", "residual_negative"] {
                b.meets(field, a.0[field][0].as_f64().expect("a number"), 1e-11);
            }
        }
    }
}

/// Between two rows that are far apart the oscillator swings, and its maximum lies at no row: the closed form of a ramp that
/// stops, y omega^2 = t - sin(omega t) / omega.
#[test]
fn the_maximum_lies_between_the_rows() {
    let (hertz, omega) = (0.6, 2.0 * PI * 0.6);
    let row = at("table(\"t.csv\", 1 m/s^2)", "0,0\n1,1\n3,1\n4,0\n", "0", hertz, &[]);
    // On (1, 3): 1 + A cos(omega (t - 1)) + B sin(..), from value and slope at 1.
    let (value, slope) = (1.0 - omega.sin() / omega, (1.0 - omega.cos()) / omega);
    row.meets("primary_positive", 1.0 + (value - 1.0f64).hypot(slope), 1e-12);
    // The samples alone do not have it.
    assert!(1.0 + (value - 1.0f64).hypot(slope) > value + 0.01);
}

/// Many rows of uneven lengths, and frequencies above and below them, beside the sum of the ramps between the rows, on a fine
/// grid: never above the largest value, and near it.
#[test]
fn a_table_beside_a_fine_grid() {
    let rows: Vec<(f64, f64)> =
        (0..60).map(|i| (f64::from(i * i % 7 + 10 * i) / 64.0, f64::from((i * 37 + 11) % 23) / 8.0 - 1.25)).collect();
    let table: String = rows.iter().map(|(t, a)| format!("{t},{a}\n")).collect();
    for (hertz, zeta) in [(0.2, 0.0), (1.7, 0.05), (9.0, 0.3), (33.0, 0.02), (2.0, 1.0), (2.0, 3.0)] {
        let row = at("table(\"t.csv\", 1 m/s^2)", &table, &zeta.to_string(), hertz, &[]);
        let (mut y, mut v, mut largest) = (0.0, 0.0, [0.0f64; 2]);
        let omega = 2.0 * PI * hertz;
        for pair in rows.windows(2) {
            let ((from, a), (to, b)) = (pair[0], pair[1]);
            let count = 4000;
            let h = (to - from) / f64::from(count);
            for k in 0..count {
                let force = |part: f64| a + (b - a) * (f64::from(k) + part) / f64::from(count);
                let rate = |y: f64, v: f64, part: f64| (v, force(part) - 2.0 * zeta * omega * v - omega * omega * y);
                // Runge and Kutta
                let one = rate(y, v, 0.0);
                let two = rate(y + 0.5 * h * one.0, v + 0.5 * h * one.1, 0.5);
                let three = rate(y + 0.5 * h * two.0, v + 0.5 * h * two.1, 0.5);
                let four = rate(y + h * three.0, v + h * three.1, 1.0);
                y += h / 6.0 * (one.0 + 2.0 * two.0 + 2.0 * three.0 + four.0);
                v += h / 6.0 * (one.1 + 2.0 * two.1 + 2.0 * three.1 + four.1);
                largest = [largest[0].max(omega * omega * y), largest[1].max(-omega * omega * y)];
            }
        }
        for (field, seen) in ["primary_positive", "primary_negative"].into_iter().zip(largest) {
            let value = row.0[field][0].as_f64().expect("a number");
            let above = value - seen;
            assert!(above > -1e-9 && above < 1e-5 * value.max(1.0), "{field} {hertz} Hz {zeta}: {value} {seen}");
        }
    }
}

/// A swing that hardly decays: rows meet a later, lower swing nearer to its top than the highest one. After the pulse, from
/// y and v, the tops are those of e^(-zeta omega t) (y cos + (v + zeta omega y) / beta omega sin).
#[test]
fn the_highest_row_may_stand_in_another_swing_than_the_maximum() {
    let (step, zeta) = (0.01, 0.001);
    let table: String =
        (0..60).map(|i| format!("{},{}\n", f64::from(i) / 100.0, f64::from(u8::from(i == 1)))).collect();
    let mut elsewhere = 0;
    for k in 0..24 {
        let hertz = 21.0 + 0.83 * f64::from(k);
        let omega = 2.0 * PI * hertz;
        let beta = omega * (1.0f64 - zeta * zeta).sqrt();
        // The response to the ramp t / step, times omega^2, and its rate; the pulse is a ramp, less two of them later.
        let ramp = |t: f64| {
            let (decay, slope) = ((-zeta * omega * t).exp(), 1.0 / step);
            let (c, d) = (2.0 * zeta / omega, (2.0 * zeta * zeta - 1.0) / beta);
            let y = slope * (t - c + decay * (c * (beta * t).cos() + d * (beta * t).sin()));
            let v = slope
                * (1.0
                    + decay
                        * ((d * beta - zeta * omega * c) * (beta * t).cos()
                            - (c * beta + zeta * omega * d) * (beta * t).sin()));
            [y, v]
        };
        let (two, one) = (ramp(2.0 * step), ramp(step));
        let [y, v] = [two[0] - 2.0 * one[0], two[1] - 2.0 * one[1]];
        let free = |t: f64| {
            (-zeta * omega * t).exp() * (y * (beta * t).cos() + (v + zeta * omega * y) / beta * (beta * t).sin())
        };
        // v = 0 where tan(beta t) = v beta / (zeta omega v + omega^2 y).
        let first = (v * beta).atan2(zeta * omega * v + omega * omega * y);
        let tops: Vec<f64> = (-1..60).map(|half| (first + PI * f64::from(half)) / beta).collect();
        let inside = |t: &&f64| **t >= 0.0 && **t <= 57.0 * step;
        let row = at("table(\"t.csv\", 1 m/s^2)", &table, &zeta.to_string(), hertz, &[]);
        for (field, sign) in [("primary_positive", 1.0), ("primary_negative", -1.0)] {
            let value = |t: f64| sign * free(t);
            let highest =
                tops.iter().filter(inside).copied().max_by(|a, b| value(*a).total_cmp(&value(*b))).expect("one");
            // In the pulse itself it stays below.
            let pulse = (0..2000).map(|i| f64::from(i) * step / 1000.0).map(|t| {
                let early = ramp(t)[0] - 2.0 * if t > step { ramp(t - step)[0] } else { 0.0 };
                sign * early
            });
            if pulse.fold(0.0, f64::max) >= value(highest) {
                continue;
            }
            row.meets(field, value(highest), 1e-10);
            let sampled = (0..58).map(|i| f64::from(i) * step).max_by(|a, b| value(*a).total_cmp(&value(*b)));
            elsewhere += u32::from((sampled.expect("one") - highest).abs() * beta > PI);
        }
    }
    assert!(elsewhere > 8, "{elsewhere} of 48");
}

/// A grid has both ends, ascends, and each of its rows is that of the frequency alone.
#[test]
fn a_grid_is_made_of_single_frequencies() {
    let signal = "half_sine(1 m/s^2, 0 s, 0.1 s)";
    for more in [&[][..], &["--linear"]] {
        let (whole, count) = spectrum(signal, "", &[&["--range", "0.5Hz..80Hz", "--points", "21"], more].concat());
        assert_eq!(count, 21);
        let number = |field: &str, i: usize| whole[field][i].as_f64().expect("a number");
        assert_eq!((number("frequency_hz", 0), number("frequency_hz", 20)), (0.5, 80.0));
        for i in [0, 3, 8, 16, 20] {
            let one = at(signal, "", "5%", number("frequency_hz", i), &[]);
            one.meets("maximax", number("maximax", i), 1e-12);
        }
        assert!((1..21).all(|i| number("frequency_hz", i) > number("frequency_hz", i - 1)));
    }
}

/// `--damping 5 %` as a model writes it, `5%` and `0.05`.
#[test]
fn damping_is_written_as_in_a_model() {
    let row = |arguments: &[&str]| {
        let output = ran(&model("step(1 m/s^2, 0 s)"), "", &[arguments, &["--at", "1Hz", "--format", "csv"]].concat());
        assert!(output.status.success(), "{arguments:?} {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).expect("text")
    };
    let known = row(&["--damping", "0.05"]);
    for arguments in [&["--damping", "5", "%"][..], &["--damping", "5%"], &["--damping", "5 %"], &[]] {
        assert_eq!(row(arguments), known, "{arguments:?}");
    }
    assert_ne!(row(&["--damping", "5"]), known);
}

/// One line with the reason, and no spectrum.
#[test]
fn what_has_no_spectrum_is_refused() {
    let scene = |signal: &str| model(signal);
    let plain = "base g { moves x }\nbody b { mass = 1 kg, moves x }\nspring s: g -- b { k = 1 N/m }\n".to_string();
    let forced =
        "body b { mass = 1 kg, moves x }\nspring s: ground -- b { k = 1 N/m }\nforce F: b along x = step(1 N, 0 s)\n";
    let usual = ["--at", "1Hz"];
    let cases: [(String, &[&str], &str); 13] = [
        (plain.clone(), &usual, "no base of the model has a signal"),
        (plain, &["--from", "g", "--at", "1Hz"], "it has no signal that moves it"),
        (forced.into(), &["--from", "F", "--at", "1Hz"], "`F` is not a base of the model; it has none"),
        (scene("step(1 m, 0 s)"), &["--from", "h", "--at", "1Hz"], "it has `g`"),
        (scene("harmonic(1 m/s^2, 2 Hz)"), &usual, "never ends"),
        (scene("constant(1 m)"), &usual, "it has no signal that moves it"),
        (scene("impulse(1 m*s, 0 s)"), &usual, "an impulse of its displacement"),
        (scene("noise(white 1 m^2/s^4/Hz)"), &usual, "noise has no time history"),
        (scene("step(1 m, 0 s)"), &["--at", "0Hz"], "above zero"),
        // Minutes of work and gigabytes of candidates, for maxima without digits.
        (scene("ramp(50 mm, 0.1 s, 0.15 s)"), &["--damping", "1e9", "--at", "1Hz"], "the damping ratio is above 1000"),
        (scene("step(1 m, 0 s)"), &["--range", "0Hz..2Hz"], "above zero"),
        (
            scene("pulse(1 m/s^2, 0 s, 100000 s)"),
            &["--range", "1kHz..9kHz", "--points", "100000"],
            "steps of oscillators; the limit is",
        ),
        (scene("step(1e300 m/s^2, 0 s) + pulse(1e300 m/s^2, 0 s, 1e9 s)"), &["--at", "1e-9Hz"], ""),
    ];
    for (model, arguments, reason) in cases {
        let output = ran(&model, "", arguments);
        let text = String::from_utf8_lossy(&output.stderr);
        if reason.is_empty() {
            // Whatever it says, it is no defect.
            assert!(!text.contains("defect"), "{text}");
            continue;
        }
        assert!(output.stdout.is_empty() && output.status.code() == Some(2), "{model}{arguments:?}: {text}");
        assert!(text.contains(reason) && text.lines().filter(|line| line.starts_with("error")).count() == 1, "{text}");
    }
}
