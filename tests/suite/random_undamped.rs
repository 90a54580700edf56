//! Noise and motions that no damper takes part in: infinite where the noise has power at their frequency, proved; finite beside
//! quadrature (mpmath, 30 digits) where it has none. See docs/method/random.md#undamped-motions.

// The digits of the quadrature, as it printed them.
#![allow(clippy::excessive_precision)]

use crate::random::{answer, assert_is, under_noise};
use std::f64::consts::TAU;
use vibc::Spread;

fn undamped(noise: &str, outputs: &str) -> String {
    format!(
        "body b {{ mass = 2 kg, moves x }}\nspring s: ground -- b {{ k = 50 N/m }}\nforce F: b along x = {noise}\n{outputs}"
    )
}

/// Two equal masses between equal springs and a damper between them: both together swing with 50 N/m and 2 kg for ever, against
/// each other with 64 N/m and 6 N*s/m.
fn pair(noise: &str, outputs: &str) -> String {
    format!(
        "body a {{ mass = 2 kg, moves x }}\nbody b {{ mass = 2 kg, moves x }}\nspring s: ground -- a {{ k = 50 N/m }}\n\
         spring t: ground -- b {{ k = 50 N/m }}\nspring u: a -- b {{ k = 7 N/m }}\ndamper d: a -- b {{ c = 3 N*s/m }}\n\
         force F: a along x = {noise}\n{outputs}"
    )
}

#[track_caller]
fn assert_infinite(found: &Spread, mode: usize) {
    let why = format!("infinite: nothing damps mode {mode}, and the noise has power at its frequency");
    assert_eq!(*found, Spread::Infinite(why.into()));
}

#[track_caller]
fn assert_open(found: &Spread, reason: &str) {
    assert!(matches!(found, Spread::Unknown(why) if why.contains(reason)), "{found:?}");
}

/// The number within its bound, which has at least fifteen digits.
#[track_caller]
fn assert_near(found: &Spread, truth: f64) {
    let Spread::Finite(ball) = found else { panic!("no number: {found:?}, but {truth}") };
    assert!((ball.to_f64() - truth).abs() <= ball.rad + 4.0 * f64::EPSILON * truth.abs(), "{found:?} {truth}");
    assert!(ball.relative_error() < 1e-15, "{found:?}");
}

/// The natural frequency is 5 rad/s, 0.7957 Hz.
#[test]
fn power_at_the_frequency_of_a_mode_is_infinite() {
    for noise in [
        "noise(white 6 N^2/Hz)",
        "noise(6 N^2/Hz, 0.5 Hz .. 1 Hz)",
        "noise(6 N^2/Hz, 0 Hz .. 0.8 Hz)",
        "noise((0.1 Hz, 2 N^2/Hz), (0.7 Hz, 7 N^2/Hz), (10 Hz, 0.5 N^2/Hz))",
    ] {
        let found = under_noise(&undamped(noise, "output x = b.x\noutput v = b.vx\n"));
        for (rms, crossings) in &found {
            assert_infinite(rms, 1);
            assert_open(crossings, "no rate of zero crossings follows");
        }
    }
    let text = undamped("noise(6 N^2/Hz, 0.5 Hz .. 1 Hz)", "output x = b.x\n");
    let report = vibc::report(&answer(&text), &Default::default());
    assert!(report.contains("rms of x: infinite: nothing damps mode 1, and the noise has power"), "{report}");
}

/// A force in the middle of a chain of three does no work on the mode in which its ends swing against each other, sqrt(28.5) rad/s
/// or 0.84966 Hz, though the noise has power there and both other modes are excited.
#[test]
fn a_mode_that_the_force_does_not_excite_is_not_infinite() {
    let found = under_noise(
        "body a { mass = 2 kg, moves x }\nbody b { mass = 2 kg, moves x }\nbody c { mass = 2 kg, moves x }\n\
         spring s: ground -- a { k = 50 N/m }\nspring t: a -- b { k = 7 N/m }\nspring u: b -- c { k = 7 N/m }\n\
         spring v: c -- ground { k = 50 N/m }\nforce F: b along x = noise(6 N^2/Hz, 0.845 Hz .. 0.855 Hz)\n\
         output x = a.x\noutput y = b.x\n",
    );
    for (rms, crossings) in &found {
        assert!(
            !matches!(rms, Spread::Infinite(_)) && !matches!(crossings, Spread::Infinite(_)),
            "{rms:?} {crossings:?}"
        );
    }
}

/// The integral of 1 / (a^2 - w^2)^2.
fn primitive(a: f64, w: f64) -> f64 {
    w / (2.0 * a * a * (a * a - w * w)) + ((a + w) / (a - w).abs()).ln() / (4.0 * a.powi(3))
}

#[test]
fn an_rms_beside_the_frequency_of_a_mode_is_finite() {
    for (from, to) in [(1.0, 2.0), (0.0, 0.7), (0.0, 0.795), (0.796, 0.9), (30.0, 40.0)] {
        let found = under_noise(&undamped(&format!("noise(6 N^2/Hz, {from} Hz .. {to} Hz)"), "output x = b.x\n"));
        let truth = (6.0 / 4.0 / TAU * (primitive(5.0, TAU * to) - primitive(5.0, TAU * from))).sqrt();
        let Spread::Finite(ball) = &found[0].0 else { panic!("{from} {to}: {found:?}") };
        let off = (ball.to_f64() / truth - 1.0).abs();
        assert!(off < 1e-11 && ball.relative_error() < 1e-18, "{from} {to}: {ball:?} {off:e}");
    }
    let outputs = "output x = b.x\noutput a = b.ax\n";
    let found = under_noise(&undamped("noise(6 N^2/Hz, 1 Hz .. 2 Hz)", outputs));
    assert_near(&found[0].0, 0.0313813821801143260439);
    assert_near(&found[0].1, 1.20457129536511220612);
    assert_near(&found[1].0, 1.924860674189310988639);
    let found = under_noise(&undamped("noise((1 Hz, 2 N^2/Hz), (4 Hz, 7 N^2/Hz))", outputs));
    assert_near(&found[0].0, 0.02041714674421281533214);
}

/// Two modes, of 0.442 Hz and 1.384 Hz, and a band between them.
#[test]
fn a_band_between_two_undamped_modes() {
    let scene = |noise: &str| {
        format!(
            "body a {{ mass = 2 kg, moves x }}\nbody b {{ mass = 3 kg, moves x }}\nspring s: ground -- a {{ k = 50 N/m }}\n\
             spring t: a -- b {{ k = 70 N/m }}\nforce F: a along x = {noise}\noutput y = b.x\noutput x = a.x\n"
        )
    };
    let found = under_noise(&scene("noise(6 N^2/Hz, 0.6 Hz .. 1.1 Hz)"));
    assert_near(&found[0].0, 0.02581258810189850538655);
    assert_near(&found[1].0, 0.01009434673381165566568);
    assert_infinite(&under_noise(&scene("noise(6 N^2/Hz, 0.4 Hz .. 0.5 Hz)"))[0].0, 1);
    assert_infinite(&under_noise(&scene("noise(6 N^2/Hz, 1 Hz .. 2 Hz)"))[1].0, 2);
}

/// A mode that dampers leave alone is found exactly beside a damped one: what shows it is infinite in its band and finite beside it,
/// and what does not show it, or does not drive it, has the number of the other mode alone.
#[test]
fn a_damper_at_rest_damps_nothing() {
    let outputs = "output x = a.x\noutput z = b.x - a.x\n";
    let found = under_noise(&pair("noise(white 6 N^2/Hz)", outputs));
    assert_infinite(&found[0].0, 1);
    assert_is(&found[1].0, (6.0f64 / (4.0 * 6.0 * 64.0)).sqrt());
    assert_is(&found[1].1, 32f64.sqrt() / TAU);
    let found = under_noise(&pair("noise(6 N^2/Hz, 1 Hz .. 3 Hz)", outputs));
    assert_near(&found[0].0, 0.02758360187167710329855);
    let found = under_noise(&pair("noise(6 N^2/Hz, 0.5 Hz .. 3 Hz)", outputs));
    assert_infinite(&found[0].0, 1);
    assert_near(&found[1].0, 0.05475903305338855194447);
    // Opposite forces do not drive what moves both together.
    let driven = pair("noise(white 6 N^2/Hz)", "force G: b along x = delayed(F, 0 s)\noutput x = a.x\n");
    assert_infinite(&under_noise(&driven)[0].0, 1);
    let opposite = driven.replace("force F: a along x", "force F: a along (-1, 0)");
    assert_is(&under_noise(&opposite)[0].0, (6.0f64 / (4.0 * 6.0 * 64.0)).sqrt());
}

/// Motions of their own without springs or dampers, which no noise reaches or the output does not show, change nothing.
#[test]
fn what_takes_no_part_does_not_matter() {
    let damped = "body b { mass = 2 kg, moves x y }\nspring s: ground -- b { k = 50 N/m, along = x }\n\
                  damper d: ground -- b { c = 3 N*s/m, along = x }\nforce F: b along x = noise(white 6 N^2/Hz)\n\
                  output x = b.x\n";
    let free = "body far { mass = 1 kg, moves x }\n";
    let swing = "spring t: ground -- b { k = 9 N/m, along = y }\n";
    for more in ["", free, swing] {
        let found = under_noise(&format!("{damped}{more}"));
        assert_is(&found[0].0, (6.0f64 / 600.0).sqrt());
        assert_is(&found[0].1, 5.0 / TAU);
    }
    let shares = answer(&format!("{damped}{swing}")).noisy[0].shares.clone();
    assert!(shares.len() == 1 && shares[0].0 == 2 && (shares[0].1.0 - 1.0).abs() < 1e-12, "{shares:?}");
}

/// A mode exactly at the end of a band, and noises with delays.
#[test]
fn what_is_not_settled_is_said() {
    let edge = "body b { mass = 2 kg, moves x }\nspring s: ground -- b { k = 2 kg * (2 * pi * 1 Hz)^2 }\n\
                force F: b along x = noise(6 N^2/Hz, 1 Hz .. 2 Hz)\noutput x = b.x\n";
    assert_open(&under_noise(edge)[0].0, "an undamped motion is not decided");
    let later = pair("noise(6 N^2/Hz, 1 Hz .. 3 Hz)", "force G: b along x = delayed(F, 1 s)\noutput x = a.x\n");
    assert_open(&under_noise(&later)[0].0, "noises with delays");
    // A negative damper: it is not even proved that nothing grows.
    let grows = pair("noise(6 N^2/Hz, 1 Hz .. 3 Hz)", "output x = a.x\n").replace("c = 3 N*s/m", "c = -3 N*s/m");
    assert_open(&under_noise(&grows)[0].0, "every motion decays");
}
