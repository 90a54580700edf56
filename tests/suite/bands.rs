//! Noise in bands: root mean squares and crossings beside a closed form and beside quadrature in 30 digits (mpmath), and what of
//! them is infinite or not proved. See docs/method/random.md#bands.

// The digits of the quadrature, as it printed them.
#![allow(clippy::excessive_precision)]

use crate::random::{answer, assert_is, under_noise};
use std::f64::consts::TAU;
use vibc::Spread;
use vibc::base::{SourceFile, SourceKind, Sources};

fn oscillator(c: &str, noise: &str, outputs: &str) -> String {
    format!(
        "body b {{ mass = 2 kg, moves x }}\nspring s: ground -- b {{ k = 50 N/m }}\ndamper d: ground -- b {{ c = {c} N*s/m }}\n\
         force F: b along x = {noise}\n{outputs}"
    )
}

fn on_base(noise: &str, outputs: &str) -> String {
    format!(
        "body b {{ mass = 2 kg, moves x }}\nbase g {{ moves x }} = {noise}\nspring s: g -- b {{ k = 50 N/m }}\n\
         damper d: g -- b {{ c = 3 N*s/m }}\n{outputs}"
    )
}

/// The number within its bound, which has at least so many digits.
#[track_caller]
fn assert_near(found: &Spread, truth: f64, sharp: f64) {
    let Spread::Finite(ball) = found else { panic!("no number: {found:?}, but {truth}") };
    assert!((ball.to_f64() - truth).abs() <= ball.rad + 4.0 * f64::EPSILON * truth.abs(), "{found:?} {truth}");
    assert!(ball.relative_error() < sharp, "{found:?}");
}

/// Crandall and Mark, Random Vibration in Mechanical Systems (1963), 2.2: the integral of 1 / ((1 - r^2)^2 + (2 z r)^2) from 0 to r.
fn flat(z: f64, r: f64) -> f64 {
    let p = (1.0 - z * z).sqrt();
    let sizes = [r * r + 2.0 * p * r + 1.0, r * r - 2.0 * p * r + 1.0];
    (sizes[0] / sizes[1]).ln() / (8.0 * p) + (((r + p) / z).atan() + ((r - p) / z).atan()) / (4.0 * z)
}

#[test]
fn a_flat_band_has_its_closed_form() {
    for (c, from, to) in [(3.0, 0.5, 2.0), (3.0, 0.0, 0.3), (0.01, 0.7, 0.9), (10.0, 1.0, 50.0), (3.0, 0.0, 1e6)] {
        let text = oscillator(&c.to_string(), &format!("noise(6 N^2/Hz, {from} Hz .. {to} Hz)"), "output x = b.x\n");
        let [r, s] = [from, to].map(|f: f64| TAU * f / 5.0);
        let z = c / 20.0;
        // S (1/k^2) w_n / 2 pi
        let truth = 6.0 / 2500.0 * 5.0 / TAU * (flat(z, s) - flat(z, r));
        let [(Spread::Finite(found), _)] = &under_noise(&text)[..] else { panic!("no number") };
        let off = (found.to_f64() / truth.sqrt() - 1.0).abs();
        assert!(off < 1e-12 && found.relative_error() < 1e-20, "{c} {from} {to}: {found:?} {off:e}");
    }
}

/// Two slopes that are no whole numbers; light, usual, critical and heavy damping.
#[test]
fn corner_points_beside_quadrature() {
    let noise = "noise((0.5 Hz, 2 N^2/Hz), (4 Hz, 7 N^2/Hz), (10 Hz, 0.5 N^2/Hz))";
    for (c, sharp, x, a) in [
        (
            "1e-6",
            1e-12,
            [115.025_312_604_095_39, 0.795_774_749_644_646_2],
            [2_875.634_326_333_420_6, 0.795_785_702_282_642_6],
        ),
        (
            "3",
            1e-20,
            [0.060_828_223_151_513_703, 0.898_737_367_912_950_7],
            [3.254_521_484_876_182_9, 3.769_317_907_493_329],
        ),
        (
            "20",
            1e-20,
            [0.016_111_875_979_676_291, 1.387_486_295_390_633_7],
            [2.474_237_775_569_261, 4.634_315_553_245_241],
        ),
        (
            "400",
            1e-20,
            [0.000_980_658_657_152_558_4, 2.169_216_090_284_663],
            [0.364_582_758_913_807_2, 6.153_345_312_515_050_7],
        ),
    ] {
        let found = under_noise(&oscillator(c, noise, "output x = b.x\noutput a = b.ax\n"));
        for ((rms, crossings), truth) in found.iter().zip([x, a]) {
            assert_near(rms, truth[0], sharp);
            assert_near(crossings, truth[1], sharp);
        }
    }
}

/// Class A of ISO 8608 at 20 m/s under a quarter car.
#[test]
fn a_quarter_car_on_a_road() {
    let text = "body wheel { mass = 40 kg, moves y }\nbody hull { mass = 300 kg, moves y }\n\
                base lane { moves y } = noise(road(16e-6 m^3, 20 m/s))\nspring tyre: lane -- wheel { k = 180 kN/m }\n\
                spring s: wheel -- hull { k = 18 kN/m }\ndamper d: wheel -- hull { c = 1.2 kN*s/m }\n\
                output a = hull.ay\noutput y = hull.y\noutput v = hull.vy\noutput travel = hull.y - wheel.y\n\
                output grip = 180 kN/m * (wheel.y - lane.y)\n";
    let truth = [
        [0.328_548_374_304_422_62, 8.924_065_055_262_053_8],
        [0.004_854_782_611_671_948_4, 0.835_357_002_536_975_4],
        [0.025_481_311_303_748_163, 2.052_096_031_951_994_6],
        [0.002_990_538_274_746_277_6, 3.661_816_731_890_841_5],
        [192.316_160_405_560_253, 15.605_105_192_636_301],
    ];
    for ((rms, crossings), truth) in under_noise(text).iter().zip(truth) {
        assert_is(rms, truth[0]);
        assert_is(crossings, truth[1]);
    }
}

/// A base by its acceleration and by its velocity: what it drifts is finite only in a band that begins above 0 Hz.
#[test]
fn a_base_in_bands() {
    let outputs = "output z = b.x - g.x\noutput a = b.ax\noutput x = b.x\n";
    let found = under_noise(&on_base("noise(0.5 m^2/s^4/Hz, 0 Hz .. 10 Hz)", outputs));
    assert_is(&found[0].0, 0.057_734_094_043_855_134);
    assert_is(&found[0].1, 0.789_692_461_266_933_2);
    assert_is(&found[1].0, 1.505_956_440_670_824_8);
    assert_is(&found[1].1, 0.862_909_957_734_179_2);
    assert!(matches!(&found[2].0, Spread::Infinite(why) if why.contains("drifts")), "{:?}", found[2]);
    let found = under_noise(&on_base("noise(0.5 m^2/s^4/Hz, 0.5 Hz .. 10 Hz)", outputs));
    assert_is(&found[2].0, 0.065_164_658_833_126_19);
    assert_is(&found[2].1, 0.705_509_153_733_785_7);
    let found =
        under_noise(&on_base("noise(0.5 m^2/s^2/Hz, 0 Hz .. 10 Hz)", "output v = b.vx\noutput z = b.x - g.x\n"));
    assert_is(&found[0].0, 1.505_956_440_670_824_8);
    assert_is(&found[1].0, 0.286_464_108_112_456_39);
}

/// Noises of several inputs, white and not, add their mean squares.
#[test]
fn bands_and_white_noise_add_up() {
    let rms = |noise: &str| {
        let text = oscillator("3", noise, "output x = b.x\n");
        let [(Spread::Finite(found), _)] = under_noise(&text)[..] else { panic!("no number") };
        found
    };
    let band = "noise((0.5 Hz, 2 N^2/Hz), (4 Hz, 7 N^2/Hz))";
    let parts = [rms("noise(white 6 N^2/Hz)"), rms(band)];
    let whole = under_noise(&oscillator(
        "3",
        "noise(white 6 N^2/Hz)",
        &format!("force G: b along x = {band}\noutput x = b.x\n"),
    ));
    let truth = (parts[0].square() + parts[1].square()).sqrt();
    assert_is(&whole[0].0, truth.to_f64());
    // Far beyond the motion's own frequency a flat band is as good as white noise.
    let wide = rms("noise(6 N^2/Hz, 0 Hz .. 100 GHz)").to_f64();
    assert!((wide / parts[0].to_f64() - 1.0).abs() < 1e-15 && (parts[0].to_f64() - 0.1).abs() < 1e-15);
}

/// Slopes so steep that panels are narrow, and bands so narrow that the density is nearly constant.
#[test]
fn steep_and_narrow_bands() {
    let w = TAU;
    let gain = 1.0 / ((50.0 - 2.0 * w * w).powi(2) + 9.0 * w * w);
    let narrow = under_noise(&oscillator("3", "noise(6 N^2/Hz, 0.9999999 Hz .. 1.0000001 Hz)", "output x = b.x\n"));
    let Spread::Finite(found) = narrow[0].0 else { panic!("{narrow:?}") };
    assert!((found.to_f64().powi(2) / (6.0 * gain * 2e-7) - 1.0).abs() < 1e-8, "{found:?}");
    // (f / 1 Hz)^300 up to 1.001 Hz: nearly all of the integral is in the gain at 1 Hz.
    let steep = under_noise(&oscillator(
        "3",
        "noise((0.99 Hz, 1 N^2/Hz), (1 Hz, 1e9 N^2/Hz), (1.01 Hz, 1 N^2/Hz))",
        "output x = b.x\n",
    ));
    let Spread::Finite(found) = steep[0].0 else { panic!("{steep:?}") };
    let slopes = [9.0 * 10f64.ln() / -(0.99f64.ln()), 9.0 * 10f64.ln() / 1.01f64.ln()];
    let size = 1e9 / (slopes[0] + 1.0) + 1e9 / (slopes[1] - 1.0);
    assert!((found.to_f64().powi(2) / (gain * size) - 1.0).abs() < 1e-3, "{found:?} {}", (gain * size).sqrt());
    assert!(found.relative_error() < 1e-20, "{found:?}");
}

/// Densities whose ratio leaves the range of numbers: nothing is claimed, not even that what drifts is infinite, for the band begins
/// above 0 Hz.
#[test]
fn beyond_the_range_nothing_is_claimed() {
    let noise = "noise((1 Hz, 1e-200 m^2/s^4/Hz), (2 Hz, 1e200 m^2/s^4/Hz))";
    for (rms, crossings) in under_noise(&on_base(noise, "output x = b.x\noutput z = b.x - g.x\n")) {
        assert!(matches!((&rms, &crossings), (Spread::Unknown(_), Spread::Unknown(_))), "{rms:?} {crossings:?}");
    }
}

/// The same motion between two frequencies: parts add up to the whole, also of white noise, which has no ends of its own.
#[test]
fn an_rms_within_a_band() {
    let value = |noise: &str, require: &str| {
        let text = oscillator("3", noise, &format!("output x = b.x\nrequire {require} < 1 km\n"));
        answer(&text).requirements[0].shown_value().expect("a number").number.to_f64()
    };
    let white = "noise(white 6 N^2/Hz)";
    let flat = value("noise(6 N^2/Hz, 0.5 Hz .. 2 Hz)", "rms(x)");
    assert!((value(white, "rms(x, 0.5 Hz .. 2 Hz)") / flat - 1.0).abs() < 1e-15);
    let corners = "noise((0.5 Hz, 2 N^2/Hz), (4 Hz, 7 N^2/Hz), (10 Hz, 0.5 N^2/Hz))";
    let parts = ["0 Hz .. 1 Hz", "1 Hz .. 5 Hz", "5 Hz .. 1 kHz"];
    let sum: f64 = parts.iter().map(|part| value(corners, &format!("rms(x, {part})")).powi(2)).sum();
    assert!((sum.sqrt() / value(corners, "rms(x)") - 1.0).abs() < 1e-14, "{sum}");
    assert_eq!(value(corners, "rms(x, 11 Hz .. 12 Hz)"), 0.0);
    // With a motion in time besides, a band is of the noise alone.
    let text = oscillator("3", white, "output x = b.x\ninitial b { x = 1 m }\nrequire rms(x, 0.5 Hz .. 2 Hz) < 1 km\n");
    assert!(
        (answer(&text).requirements[0].shown_value().expect("a number").number.to_f64() / flat - 1.0).abs() < 1e-15
    );
}

fn with_table(text: &str, rows: &str) -> vibc::Outcome<vibc::ModalAnswer> {
    let mut sources = Sources::new();
    let model = sources.add(SourceFile::decode(SourceKind::Model, "m", text.as_bytes().to_vec()));
    for name in vibc::table_files(&sources, model) {
        sources.add(SourceFile::decode(SourceKind::Table, name, rows.as_bytes().to_vec()));
    }
    vibc::analyze(&sources, model, &Default::default())
}

/// A table is straight between its rows: beside quadrature (mpmath), and one of two rows beside a flat band.
#[test]
fn a_table_of_densities() {
    let text = oscillator("3", "noise(table(\"psd.csv\", 2 N^2/Hz))", "output x = b.x\n");
    let rms = |rows: &str| with_table(&text, rows).answer.expect("an answer").noisy[0].rms.clone();
    assert_is(&rms("f [Hz],density\n0.5,1\n1,4\n3,0\n"), 0.085_733_462_368_081_081);
    assert_is(&rms("0,3\n1000,3\n"), {
        let flat = under_noise(&oscillator("3", "noise(6 N^2/Hz, 0 Hz .. 1 kHz)", "output x = b.x\n"));
        let Spread::Finite(flat) = flat[0].0 else { panic!("{flat:?}") };
        flat.to_f64()
    });
    for (rows, code) in [
        ("f [Hz],density\n2,1\n1,4\n", "vib::table::order"),
        ("f [s],density\n1,1\n2,4\n", "vib::table::first_column"),
        ("f [rad/s],density\n1,1\n2,4\n", "vib::table::first_column"),
        ("1,1\n2,-4\n", "vib::noise::density"),
        ("-1,1\n2,4\n", "vib::noise::density"),
        ("1,0\n2,0\n", "vib::noise::density"),
    ] {
        let found = with_table(&text, rows).diagnostics;
        let codes: Vec<&str> = found.iter().filter(|f| f.is_error()).map(|f| f.code.0).collect();
        assert_eq!(codes, [code], "{rows}: {found:?}");
    }
}

/// In a band that is as good as all frequencies the shares of the modes are those under white noise; they add up to one in any band.
#[test]
fn shares_of_modes() {
    let shares = |noise: &str| {
        let text = format!(
            "body a {{ mass = 3 kg, moves x }}\nbody b {{ mass = 2 kg, moves x }}\nspring s: ground -- a {{ k = 1000 N/m }}\n\
             spring t: a -- b {{ k = 400 N/m }}\ndamper d: ground -- a {{ c = 4 N*s/m }}\ndamper e: a -- b {{ c = 9 N*s/m }}\n\
             force F: b along x = {noise}\noutput x = b.x\noutput z = b.x - a.x\n"
        );
        let noisy = answer(&text).noisy;
        noisy.into_iter().map(|noisy| noisy.shares.into_iter().map(|(mode, share)| (mode, share.0)).collect()).collect()
    };
    let white: Vec<Vec<(usize, f64)>> = shares("noise(white 6 N^2/Hz)");
    let wide: Vec<Vec<(usize, f64)>> = shares("noise(6 N^2/Hz, 0 Hz .. 1 GHz)");
    for (white, wide) in white.iter().zip(&wide) {
        assert_eq!(white.len(), 2);
        for ((mode, a), (same, b)) in white.iter().zip(wide) {
            assert!(mode == same && (a - b).abs() < 1e-9, "{white:?} {wide:?}");
        }
    }
    let narrow: Vec<Vec<(usize, f64)>> = shares("noise((3 Hz, 1 N^2/Hz), (5 Hz, 7 N^2/Hz))");
    for list in narrow.iter().chain(&wide) {
        let sum: f64 = list.iter().map(|(_, share)| share).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{list:?}");
    }
    // By quadrature of each mode's part with the whole (mpmath).
    let of_two = [0.221_991_109_283_184_16, 0.827_846_859_509_253_98];
    for (list, truth) in narrow.iter().zip(of_two) {
        let found = list.iter().find(|(mode, _)| *mode == 2).expect("the second mode").1;
        assert!((found - truth).abs() < 1e-12, "{list:?} {truth}");
    }
}
