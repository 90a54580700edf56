//! Realisations of noise by a seed (`vibc simulate --seed`): samples beside an independent computation, their mean square, delays,
//! and what has no realisation. See docs/method/random.md#realisations.

// The digits of the other computation, as it printed them.
#![allow(clippy::excessive_precision)]

use super::program::{finding, json, ran};
use serde_json::Value;

const OSCILLATOR: &str = "body b { mass = 2 kg, moves x }\nspring s: ground -- b { k = 50 N/m }\n\
                          damper d: ground -- b { c = 3 N*s/m }\n";

fn simulated(model: &str, until: &str, step: &str, seed: &str) -> Value {
    json(model, &["simulate", "--until", until, "--step", step, "--seed", seed])
}

/// The samples of an output, and their bounds.
fn samples(motion: &Value, output: usize) -> Vec<(f64, f64)> {
    let output = &motion["outputs"][output];
    let list = |name: &str| -> Vec<f64> {
        output[name].as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
    };
    list("values").into_iter().zip(list("error_bounds")).collect()
}

#[track_caller]
fn assert_near((value, bound): (f64, f64), truth: f64) {
    assert!((value - truth).abs() <= bound + 4.0 * f64::EPSILON * truth.abs(), "{value} {truth} {bound}");
    assert!(bound <= 1e-14 * truth.abs(), "{value} {bound}");
}

/// Philox, the grid of lines and the transfer function by mpmath with 30 digits, from the text of docs/method/random.md.
#[test]
fn samples_beside_an_independent_computation() {
    let text = format!(
        "{OSCILLATOR}force F: b along x = noise(6 N^2/Hz, 0.3 Hz .. 1.7 Hz)\noutput x = b.x\noutput v = b.vx\n"
    );
    let motion = simulated(&text, "8s", "0.5s", "7");
    let truths = [
        [0.048_265_456_817_044_973, -0.049_623_438_691_194_222, 0.191_751_316_170_516_45],
        [-0.250_341_947_041_702_17, 0.451_051_424_953_067_62, -0.571_167_519_612_280_26],
    ];
    for (output, truth) in truths.iter().enumerate() {
        let found = samples(&motion, output);
        for (index, truth) in [0, 4, 16].into_iter().zip(truth) {
            assert_near(found[index], *truth);
        }
    }
    let text = "body b { mass = 2 kg, moves x }\nbase g { moves x } = noise((0.5 Hz, 0.5 m^2/s^4/Hz), (3 Hz, 2 m^2/s^4/Hz))\n\
                spring s: g -- b { k = 50 N/m }\ndamper d: g -- b { c = 3 N*s/m }\noutput z = b.x - g.x\n";
    let found = samples(&simulated(text, "4s", "1s", "12"), 0);
    for (index, truth) in
        [(0, -0.001_639_337_397_641_357_6), (1, -0.044_885_263_868_160_585), (4, -0.056_668_612_050_570_586)]
    {
        assert_near(found[index], truth);
    }
}

/// The step only chooses the samples; the seed chooses the motion.
#[test]
fn a_realisation_does_not_depend_on_the_step() {
    let text = format!("{OSCILLATOR}force F: b along x = noise(6 N^2/Hz, 0.3 Hz .. 1.7 Hz)\noutput x = b.x\n");
    let [coarse, fine] = ["0.5s", "0.01s"].map(|step| samples(&simulated(&text, "8s", step, "7"), 0));
    for (index, (value, bound)) in coarse.iter().enumerate() {
        let (other, also) = fine[50 * index];
        assert!((value - other).abs() <= bound + also, "{index}: {value} {other}");
    }
    assert_ne!(coarse, samples(&simulated(&text, "8s", "0.5s", "8"), 0));
    assert_eq!(coarse, samples(&simulated(&text, "8s", "0.5s", "7"), 0));
}

/// Lines are turned from sample to sample, here by an eighth of a turn and less: bounds do not grow with the turns.
#[test]
fn bounds_do_not_grow_from_sample_to_sample() {
    let text = format!("{OSCILLATOR}force F: b along x = noise(6 N^2/Hz, 1 Hz .. 13 Hz)\noutput x = b.x\n");
    let found = samples(&simulated(&text, "4s", "0.01s", "7"), 0);
    let largest = found.iter().map(|(value, _)| value.abs()).fold(0.0, f64::max);
    for (index, (_, bound)) in found.iter().enumerate() {
        assert!(*bound <= 1e-15 * largest, "{index}: {bound}");
    }
}

/// The mean square over the period of the lines is that under the noise, but for what the lines leave out between them.
#[test]
fn its_mean_square_is_that_of_the_noise() {
    let text = format!("{OSCILLATOR}force F: b along x = noise(6 N^2/Hz, 0 Hz .. 3 Hz)\noutput x = b.x\n");
    let found = samples(&simulated(&text, "32s", "0.125s", "3"), 0);
    let mean: f64 = found[..256].iter().map(|(x, _)| x * x).sum::<f64>() / 256.0;
    let answer = json(&text, &["analyze"]);
    let rms = answer["noise"][0]["rms"].as_f64().expect("a number");
    assert!((mean.sqrt() / rms - 1.0).abs() < 1e-4, "{} {rms}", mean.sqrt());
}

/// A base that follows another one does the same later.
#[test]
fn a_delay_is_one_of_the_realisation_too() {
    // Two outputs and two inputs: each output by each of them.
    let text = "base g { moves x } = noise(1e-4 m^2/Hz, 1 Hz .. 9 Hz)\nbase h { moves x } = delayed(g, 0.5 s)\n\
                body b { mass = 2 kg, moves x }\nspring s: g -- b { k = 50 N/m }\ndamper d: h -- b { c = 3 N*s/m }\n\
                output first = g.x\noutput second = h.x\n";
    let motion = simulated(text, "4s", "0.25s", "1");
    let (first, second) = (samples(&motion, 0), samples(&motion, 1));
    for index in 0..first.len() - 2 {
        let ((a, bound), (b, also)) = (first[index], second[index + 2]);
        assert!((a - b).abs() <= bound + also && a != 0.0, "{index}: {a} {b}");
    }
}

/// Other signals act as ever, and the noise is added.
#[test]
fn it_adds_to_other_motion() {
    let noise = format!("{OSCILLATOR}force F: b along x = noise(6 N^2/Hz, 0.3 Hz .. 1.7 Hz)\noutput x = b.x\n");
    let both = format!("{noise}force G: b along x = step(10 N, 1 s)\n");
    let plain = format!("{OSCILLATOR}force G: b along x = step(10 N, 1 s)\noutput x = b.x\n");
    let alone = json(&plain, &["simulate", "--until", "4s", "--step", "0.5s"]);
    let [noise, both] = [&noise, &both].map(|text| samples(&simulated(text, "4s", "0.5s", "5"), 0));
    for ((noise, both), (plain, bound)) in noise.iter().zip(&both).zip(samples(&alone, 0)) {
        assert!((noise.0 + plain - both.0).abs() <= noise.1 + both.1 + bound + 1e-15, "{noise:?} {both:?} {plain}");
    }
}

/// White noise, motions that do not decay and too many lines: one finding each, at the noise.
#[test]
fn what_has_no_realisation() {
    let seeded = ["simulate", "--until", "4s", "--step", "1s", "--seed", "7"];
    let white = format!("{OSCILLATOR}force F: b along x = noise(white 6 N^2/Hz)\noutput x = b.x\n");
    let wide = format!("{OSCILLATOR}force F: b along x = noise(6 N^2/Hz, 0 Hz .. 1 MHz)\noutput x = b.x\n");
    let undamped = "body b { mass = 2 kg, moves x }\nspring s: ground -- b { k = 50 N/m }\n\
                    force F: b along x = noise(6 N^2/Hz, 3 Hz .. 4 Hz)\noutput x = b.x\n";
    for (text, why) in
        [(&white[..], "mean square is infinite"), (&wide, "too many lines"), (undamped, "every motion decays")]
    {
        let found = finding(text, &seeded);
        let of = (found["code"].as_str(), found["severity"].as_str());
        assert_eq!(of, (Some("vib::noise::realisation"), Some("error")));
        assert!(found["message"].as_str().is_some_and(|message| message.contains(why)), "{found}");
        assert!(!ran(text, &seeded).status.success());
    }
    // A seed that would change nothing is a mistake of the command line.
    let quiet = format!("{OSCILLATOR}force F: b along x = step(1 N, 0 s)\noutput x = b.x\n");
    let output = ran(&quiet, &seeded);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("the model has no noise that `--seed` could add"));
    // Without a seed it is left out, with a note that names the option.
    let stepped = format!("{white}force G: b along x = step(10 N, 1 s)\n");
    let found = finding(&stepped, &["simulate", "--until", "4s", "--step", "1s"]);
    assert_eq!(found["severity"].as_str(), Some("note"));
    assert!(found["help"].as_str().is_some_and(|help| help.contains("--seed 7")), "{found}");
}
