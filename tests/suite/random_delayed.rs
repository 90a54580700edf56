//! Noise that drives several inputs, each later than the other: mean squares, densities and crossings beside closed forms and
//! beside quadrature; what delays leave infinite. See docs/method/random.md#delays.

use super::random::{answer, assert_is, refused, under_noise};
use std::f64::consts::{PI, TAU};
use vibc::Spread;

const OSCILLATOR: &str = "body b { mass = 2 kg, moves x }\nspring s: ground -- b { k = 50 N/m }\n\
                          damper d: ground -- b { c = 3 N*s/m }\n";

/// The correlation of an oscillator's motion under white noise, relative to its mean square (Crandall and Mark, 2.2).
fn correlation(c: f64, time: f64) -> f64 {
    let (m, k) = (2.0, 50.0);
    let decay = c / (2.0 * m);
    let square = k / m - decay * decay;
    if square.abs() < 1e-12 {
        return (-decay * time).exp() * (1.0 + decay * time);
    }
    if square > 0.0 {
        let damped = square.sqrt();
        return (-decay * time).exp() * ((damped * time).cos() + decay / damped * (damped * time).sin());
    }
    let damped = (-square).sqrt();
    (-decay * time).exp() * ((damped * time).cosh() + decay / damped * (damped * time).sinh())
}

/// The same white force twice, the second time later: 2 R(0) + 2 R(T). Below, above and at critical damping.
#[test]
fn a_white_force_that_comes_again() {
    for c in [3.0f64, 20.0, 40.0] {
        for (delay, time) in [("0.4 s", 0.4f64), ("1.7 s", 1.7), ("0 s", 0.0)] {
            let text = format!(
                "body b {{ mass = 2 kg, moves x }}\nspring s: ground -- b {{ k = 50 N/m }}\n\
                 damper d: ground -- b {{ c = {c} N*s/m }}\nforce F: b along x = noise(white 6 N^2/Hz)\n\
                 force G: b along x = delayed(F, {delay})\noutput x = b.x\n"
            );
            let square = 6.0 / (4.0 * c * 50.0) * 2.0 * (1.0 + correlation(c, time));
            assert_is(&under_noise(&text)[0].0, square.sqrt());
        }
    }
}

/// A delay of a delay is their sum, and forces that are delayed by the same time add up.
#[test]
fn delays_add_up() {
    let text = format!(
        "{OSCILLATOR}force F: b along x = noise(white 6 N^2/Hz)\nforce G: b along x = delayed(F, 0.3 s)\n\
         force H: b along x = delayed(G, 0.1 s)\nforce I: b along x = delayed(F, 0.4 s)\noutput x = b.x\n"
    );
    // Weights 1, 1, 2 at 0, 0.3 and 0.4 s.
    let r = |time: f64| correlation(3.0, time);
    let sum = 1.0 + 1.0 + 4.0 + 2.0 * (r(0.3) + 2.0 * r(0.4) + 2.0 * r(0.1));
    assert_is(&under_noise(&text)[0].0, (6.0 / 600.0 * sum).sqrt());
}

/// Two masses that do not touch, one later than the other: the difference has 2 R(0) - 2 R(T).
#[test]
fn a_difference_of_two_that_follow_each_other() {
    let text = format!(
        "{OSCILLATOR}body e {{ mass = 2 kg, moves x }}\nspring t: ground -- e {{ k = 50 N/m }}\n\
         damper f: ground -- e {{ c = 3 N*s/m }}\nforce F: b along x = noise(white 6 N^2/Hz)\n\
         force G: e along x = delayed(F, 0.4 s)\noutput x = b.x\noutput z = e.x - b.x\n"
    );
    let found = under_noise(&text);
    assert_is(&found[0].0, (6.0f64 / 600.0).sqrt());
    assert_is(&found[1].0, (6.0 / 600.0 * 2.0 * (1.0 - correlation(3.0, 0.4))).sqrt());
}

/// Two bases on one road whose own motions are seen: the integral of S (2 + 2 cos(2 pi f T)) over a flat band.
#[test]
fn bases_themselves_beside_the_closed_form() {
    let text = "base g { moves x } = noise(1e-4 m^2/Hz, 1 Hz .. 9 Hz)\nbase h { moves x } = delayed(g, 0.35 s)\n\
                body b { mass = 2 kg, moves x }\nspring s: g -- b { k = 50 N/m }\ndamper d: h -- b { c = 3 N*s/m }\n\
                output sum = g.x + h.x\noutput difference = g.x - h.x\noutput rate = g.vx - h.vx\n";
    let (a, b, t) = (1.0f64, 9.0f64, 0.35f64);
    let found = under_noise(text);
    let mixed = ((TAU * b * t).sin() - (TAU * a * t).sin()) / (PI * t);
    assert_is(&found[0].0, (1e-4 * (2.0 * (b - a) + mixed)).sqrt());
    assert_is(&found[1].0, (1e-4 * (2.0 * (b - a) - mixed)).sqrt());
    // The integral of w^2 cos(w T), w = 2 pi f.
    let part = |f: f64| {
        let w = TAU * f;
        (w * w * (w * t).sin() / t + 2.0 * w * (w * t).cos() / (t * t) - 2.0 * (w * t).sin() / (t * t * t)) / TAU
    };
    let plain = TAU * TAU * (b.powi(3) - a.powi(3)) / 3.0;
    assert_is(&found[2].0, (1e-4 * 2.0 * (plain - (part(b) - part(a)))).sqrt());
}

/// A pair of axles on a road (ISO 8608), and a force between corner points of a slope that is no whole number, beside Simpson's rule
/// over |sum H e^(-i w T)|^2 S of the equations of motion.
#[test]
fn two_axles_beside_quadrature() {
    let text = "body a { mass = 4 kg, moves y }\nbody b { mass = 3 kg, moves y }\n\
                base front { moves y } = noise(road(16e-6 m^3, 20 m/s))\nbase rear { moves y } = delayed(front, 0.125 s)\n\
                spring s: front -- a { k = 900 N/m }\nspring t: rear -- b { k = 700 N/m }\nspring u: a -- b { k = 300 N/m }\n\
                damper d: front -- a { c = 12 N*s/m }\ndamper e: rear -- b { c = 15 N*s/m }\n\
                output y = a.y\noutput z = b.y - a.y\noutput acc = b.ay\noutput gap = b.y - rear.y\n";
    let found = under_noise(text);
    let density = |f: f64| {
        let n = f / 20.0;
        16e-6 * (n / 0.1).powi(-2) / 20.0
    };
    // (K + i w C - w^2 M) q = (k + i w c) u for two coordinates by Cramer's rule.
    let outputs = |w: f64| -> [[f64; 2]; 4] {
        let stiff = |k: f64, c: f64| [k, w * c];
        let (p, q) = (stiff(900.0, 12.0), stiff(700.0, 15.0));
        let late = [(w * 0.125).cos(), -(w * 0.125).sin()];
        let (d1, d2) = (add(add(p, [300.0, 0.0]), [-w * w * 4.0, 0.0]), add(add(q, [300.0, 0.0]), [-w * w * 3.0, 0.0]));
        let (f1, f2) = (p, times(q, late));
        let determinant = add(times(d1, d2), [-300.0 * 300.0, 0.0]);
        let a = over(add(times(f1, d2), scale(f2, 300.0)), determinant);
        let b = over(add(times(f2, d1), scale(f1, 300.0)), determinant);
        [a, add(b, scale(a, -1.0)), scale(b, -w * w), add(b, scale(late, -1.0))]
    };
    for (i, (rms, _)) in found.iter().enumerate() {
        let power = |f: f64| outputs(TAU * f)[i].iter().map(|x| x * x).sum::<f64>() * density(f);
        let truth = simpson(power, 0.011 * 20.0, 2.83 * 20.0).sqrt();
        let Spread::Finite(value) = rms else { panic!("{rms:?}") };
        assert!((value.to_f64() / truth - 1.0).abs() < 1e-11, "{i}: {value:?} {truth}");
        assert!(value.relative_error() < 1e-20, "{value:?}");
    }
    // The density at one frequency, and the crossings by the density times w^2.
    let answer = answer(&format!("{text}require psd(z, 2 Hz) < 1 m^2/Hz\n"));
    let shown = answer.requirements[0].shown_value().expect("a number").number.to_f64();
    let truth = outputs(2.0 * TAU)[1].iter().map(|x| x * x).sum::<f64>() * density(2.0);
    assert!((shown / truth - 1.0).abs() < 1e-13, "{shown} {truth}");
    let power = |f: f64| outputs(TAU * f)[1].iter().map(|x| x * x).sum::<f64>() * density(f);
    let rate = simpson(|f| power(f) * f * f, 0.22, 56.6) / simpson(power, 0.22, 56.6);
    let Spread::Finite(crossings) = &found[1].1 else { panic!("{:?}", found[1]) };
    assert!((crossings.to_f64() / rate.sqrt() - 1.0).abs() < 1e-11, "{crossings:?} {rate}");
}

fn add(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

fn times(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn scale(a: [f64; 2], by: f64) -> [f64; 2] {
    [a[0] * by, a[1] * by]
}

fn over(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let size = b[0] * b[0] + b[1] * b[1];
    scale(times(a, [b[0], -b[1]]), 1.0 / size)
}

/// Simpson's rule over the logarithm of the frequency.
fn simpson(of: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let count = 60_000;
    let step = (to / from).ln() / count as f64;
    let at = |k: usize| {
        let f = from * (k as f64 * step).exp();
        of(f) * f
    };
    let weight = |k: usize| if k == 0 || k == count { 1.0 } else { 2.0 + 2.0 * (k % 2) as f64 };
    (0..=count).map(|k| weight(k) * at(k)).sum::<f64>() * step / 3.0
}

/// White noise by the corner: a band whose slope is no whole number, and a delay that turns the phase a hundred times.
#[test]
fn a_long_delay_in_a_band_of_corner_points() {
    let text = format!(
        "{OSCILLATOR}force F: b along x = noise((0.2 Hz, 1 N^2/Hz), (1 Hz, 7 N^2/Hz), (5 Hz, 2 N^2/Hz))\n\
         force G: b along x = delayed(F, 20 s)\noutput x = b.x\noutput v = b.vx\n"
    );
    let density = |f: f64| {
        let [(f1, s1), (f2, s2)] = if f < 1.0 { [(0.2, 1.0), (1.0, 7.0)] } else { [(1.0, 7.0), (5.0, 2.0f64)] };
        s1 * (f / f1).powf((s2 / s1).ln() / (f2 / f1).ln())
    };
    let gain = |f: f64| {
        let w = TAU * f;
        4.0 * (w * 10.0).cos().powi(2) / ((50.0 - 2.0 * w * w).powi(2) + 9.0 * w * w)
    };
    let found = under_noise(&text);
    for (i, (rms, _)) in found.iter().enumerate() {
        let power = |f: f64| gain(f) * density(f) * (TAU * f).powi(2 * i as i32);
        let truth = (simpson(power, 0.2, 1.0) + simpson(power, 1.0, 5.0)).sqrt();
        let Spread::Finite(value) = rms else { panic!("{rms:?}") };
        assert!((value.to_f64() / truth - 1.0).abs() < 1e-10, "{i}: {value:?} {truth}");
        assert!(value.relative_error() < 1e-20, "{value:?}");
    }
    // Far beyond, the phase turns too often: no number.
    let found = under_noise(&text.replace("20 s", "1e7 s"));
    assert!(matches!(&found[0].0, Spread::Unknown(why) if why.contains("turns too often")), "{found:?}");
}

/// White noise of two bases' velocities: one base drifts, and what lies between two that follow each other is not claimed to.
#[test]
fn what_drifts_together_is_not_claimed() {
    let text = "base g { moves x } = noise(white 0.5 m^2/s^2/Hz)\nbase h { moves x } = delayed(g, 0.4 s)\n\
                body b { mass = 2 kg, moves x }\nbody e { mass = 2 kg, moves x }\n\
                spring s: g -- b { k = 50 N/m }\ndamper d: ground -- b { c = 3 N*s/m }\n\
                spring t: h -- e { k = 50 N/m }\ndamper f: ground -- e { c = 3 N*s/m }\n\
                output one = b.x\noutput apart = e.x - b.x\noutput stretch = b.x - g.x\noutput both = b.x + e.x\n";
    let found = under_noise(text);
    assert!(matches!(&found[0].0, Spread::Infinite(why) if why.contains("drifts")), "{:?}", found[0]);
    assert!(matches!(&found[1].0, Spread::Unknown(why) if why.contains("follows")), "{:?}", found[1]);
    assert!(matches!(&found[2].0, Spread::Finite(_)), "{:?}", found[2]);
    assert!(matches!(&found[3].0, Spread::Infinite(why) if why.contains("drifts")), "{:?}", found[3]);
}

/// Inputs that act at different times do not cancel: a direct path stays one.
#[test]
fn direct_paths_do_not_cancel() {
    let text = format!(
        "{OSCILLATOR}force F: b along x = noise(white 6 N^2/Hz)\nforce G: b along x = delayed(F, 0.4 s)\noutput a = b.ax\n"
    );
    assert!(matches!(&under_noise(&text)[0].0, Spread::Infinite(why) if why.contains("without any inertia")));
}

/// Still refused: a delay of another kind of input, and of itself.
#[test]
fn what_noise_cannot_be_delayed_from() {
    let base = "base g { moves x } = noise(white 0.5 m^2/s^4/Hz)\n";
    let text = format!("{OSCILLATOR}{base}force F: b along x = delayed(g, 0.4 s)\noutput x = b.x\n");
    let codes: Vec<&str> = refused(&text).iter().map(|(code, _)| *code).collect();
    assert_eq!(codes, ["vib::signal::delayed"]);
}

/// Two equal masses whose modes are the sum and the difference: shares beside quadrature of impulse responses.
#[test]
fn shares_of_modes_under_white_noise_that_comes_again() {
    let text = "body a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\nspring s: ground -- a { k = 9 N/m }\n\
                spring t: ground -- b { k = 9 N/m }\nspring u: a -- b { k = 8 N/m }\ndamper d: ground -- a { c = 0.5 N*s/m }\n\
                damper e: ground -- b { c = 0.5 N*s/m }\nforce F: a along x = noise(white 6 N^2/Hz)\n\
                force G: b along x = delayed(F, 0.4 s)\noutput x = a.x\n";
    let shares = &answer(text).noisy[0].shares;
    let h = |square: f64, u: f64| {
        let damped = (square - 0.0625f64).sqrt();
        (-0.25 * u).exp() * (damped * u).sin() / damped
    };
    // The parts of the modes in a.x by a force on a, and by one on b.
    let by_a = |mode: usize, u: f64| 0.5 * h([9.0, 25.0][mode], u);
    let by_b = |mode: usize, u: f64| if mode == 0 { by_a(0, u) } else { -by_a(1, u) };
    let (all_a, all_b) = (|u: f64| by_a(0, u) + by_a(1, u), |u: f64| by_b(0, u) + by_b(1, u));
    let part = |mode: usize| {
        simpson(|u| by_a(mode, u) * all_a(u) + by_b(mode, u) * all_b(u), 1e-7, 80.0)
            + simpson(|u| by_a(mode, u + 0.4) * all_b(u) + by_b(mode, u) * all_a(u + 0.4), 1e-7, 80.0)
    };
    let parts = [part(0), part(1)];
    assert_eq!(shares.len(), 2);
    for (mode, share) in shares {
        let truth = parts[mode - 1] / (parts[0] + parts[1]);
        assert!((share.0 - truth).abs() < 1e-6, "{mode}: {share:?} {truth}");
    }
}

/// The same masses under a force and under the acceleration of a base in bands, each again later: shares of displacements, and of the
/// motion relative to the base, whose own part belongs to no mode, beside quadrature of re H_i conj H.
#[test]
fn shares_of_modes_in_bands_that_come_again() {
    type C = (f64, f64);
    let times = |a: C, b: C| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    let bodies = "body a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\nspring u: a -- b { k = 8 N/m }\n";
    let forces = format!(
        "{bodies}spring s: ground -- a {{ k = 9 N/m }}\nspring t: ground -- b {{ k = 9 N/m }}\n\
         damper d: ground -- a {{ c = 0.5 N*s/m }}\ndamper e: ground -- b {{ c = 0.5 N*s/m }}\n\
         force F: a along x = noise((0.3 Hz, 2 N^2/Hz), (1.1 Hz, 7 N^2/Hz))\nforce G: b along x = delayed(F, 0.4 s)\n\
         output x = a.x\noutput acc = b.ax\n"
    );
    let bases = format!(
        "{bodies}base g {{ moves x }} = noise(2 m^2/Hz, 0.3 Hz .. 1.1 Hz)\nbase h {{ moves x }} = delayed(g, 0.4 s)\n\
         spring s: g -- a {{ k = 9 N/m }}\nspring t: h -- b {{ k = 9 N/m }}\ndamper d: g -- a {{ c = 0.5 N*s/m }}\n\
         damper e: h -- b {{ c = 0.5 N*s/m }}\noutput x = a.x\noutput z = a.x - g.x\noutput r = a.vx - g.vx\n"
    );
    let density = |w: f64, is_flat: bool| {
        let slope = 3.5f64.ln() / (1.1f64 / 0.3).ln();
        if is_flat { 2.0 } else { 2.0 * (w / (0.3 * TAU)).powf(slope) }
    };
    for (text, is_base) in [(forces, false), (bases, true)] {
        for (place, noisy) in answer(&text).noisy.iter().enumerate() {
            // The part of each mode in the output, a.x or b.x'', and the whole.
            let parts = |w: f64| {
                let load = if is_base { (9.0, 0.5 * w) } else { (1.0, 0.0) };
                let turn = ((0.4 * w).cos(), -(0.4 * w).sin());
                let of = |mode: usize| {
                    let bottom = ([9.0, 25.0][mode] - w * w, 0.5 * w);
                    let size = bottom.0 * bottom.0 + bottom.1 * bottom.1;
                    let sign = if mode == 0 { 1.0 } else { -1.0 };
                    let both = times(load, (1.0 + sign * turn.0, sign * turn.1));
                    let x = times(both, (0.5 * bottom.0 / size, -0.5 * bottom.1 / size));
                    // In b the second mode is the other way round. What a force accelerates at once is no mode's, nor is the jump of
                    // a rate by the rate of a base.
                    match (is_base, place) {
                        (false, 1) => (sign * (-w * w * x.0 - 0.5 * both.0), sign * (-w * w * x.1 - 0.5 * both.1)),
                        (true, 2) => (-w * x.1 - 0.25 * (1.0 + sign * turn.0), w * x.0 - 0.25 * sign * turn.1),
                        _ => x,
                    }
                };
                let direct = match (is_base, place) {
                    (true, 1) => (-1.0, 0.0),
                    (false, 1) => turn,
                    // Both halves of the jump of `a`, and the base itself.
                    (true, 2) => (0.5, -w),
                    _ => (0.0, 0.0),
                };
                let modes = [of(0), of(1)];
                (modes, (modes[0].0 + modes[1].0 + direct.0, modes[0].1 + modes[1].1 + direct.1))
            };
            let over = |of: &dyn Fn(f64) -> f64| simpson(|w| of(w) * density(w, is_base), 0.3 * TAU, 1.1 * TAU);
            let whole = over(&|w| {
                let (_, all) = parts(w);
                all.0 * all.0 + all.1 * all.1
            });
            assert_eq!(noisy.shares.len(), 2, "{noisy:?}");
            for (mode, share) in &noisy.shares {
                let truth = over(&|w| {
                    let (modes, all) = parts(w);
                    modes[mode - 1].0 * all.0 + modes[mode - 1].1 * all.1
                }) / whole;
                assert!((share.0 - truth).abs() < 1e-6, "{is_base} {place} {mode}: {share:?} {truth}");
            }
        }
    }
}

/// Limits say what they are.
#[test]
fn a_noise_that_drives_too_many_inputs_is_not_integrated() {
    let mut text = format!("{OSCILLATOR}force F0: b along x = noise(2 N^2/Hz, 1 Hz .. 30 Hz)\noutput x = b.x\n");
    for i in 1..100 {
        text += &format!("force F{i}: b along x = delayed(F0, {i} ms)\n");
    }
    let found = &answer(&text).noisy[0].rms;
    assert!(matches!(found, Spread::Unknown(why) if why.contains("more than 64 inputs")), "{found:?}");
}

/// The same bases by their accelerations: what the masses follow of a base at once, H(0) + s H'(0) of each mode over s^2, and the jump of
/// the rates that this leaves, belong to no mode.
#[test]
fn shares_of_modes_under_accelerations_that_come_again() {
    type C = (f64, f64);
    let plus = |a: C, b: C| (a.0 + b.0, a.1 + b.1);
    let times = |a: C, b: C| (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0);
    let over = |a: C, b: C| {
        let size = b.0 * b.0 + b.1 * b.1;
        times(a, (b.0 / size, -b.1 / size))
    };
    let text = "body a { mass = 1 kg, moves x }\nbody b { mass = 1 kg, moves x }\nspring u: a -- b { k = 8 N/m }\n\
                base g { moves x } = noise(2 m^2/s^4/Hz, 0.3 Hz .. 1.1 Hz)\nbase h { moves x } = delayed(g, 0.4 s)\n\
                spring s: g -- a { k = 9 N/m }\nspring t: h -- b { k = 9 N/m }\ndamper d: g -- a { c = 0.5 N*s/m }\n\
                damper e: h -- b { c = 0.5 N*s/m }\noutput x = a.x\noutput v = a.vx\n";
    for (power, noisy) in answer(text).noisy.iter().enumerate() {
        let parts = |w: f64| {
            let s = (0.0, w);
            let square = (-w * w, 0.0);
            let turn = ((0.4 * w).cos(), -(0.4 * w).sin());
            let of = |mode: usize| {
                let (k, sign) = ([9.0, 25.0][mode], [1.0, -1.0][mode]);
                let both = plus((1.0, 0.0), (sign * turn.0, sign * turn.1));
                let h = over((4.5, 0.25 * w), (k - w * w, 0.5 * w));
                let (at_once, rate) = (4.5 / k, (0.25 * k - 4.5 * 0.5) / (k * k));
                let apart = over(plus(h, (-at_once, -rate * w)), square);
                let (own, all) = match power {
                    0 => (apart, over(h, square)),
                    _ => (plus(times(s, apart), (rate, 0.0)), over(times(s, h), square)),
                };
                (times(own, both), times(all, both))
            };
            let [first, second] = [of(0), of(1)];
            ([first.0, second.0], plus(first.1, second.1))
        };
        let integral = |of: &dyn Fn(f64) -> f64| simpson(of, 0.3 * TAU, 1.1 * TAU);
        let whole = integral(&|w| {
            let (_, all) = parts(w);
            all.0 * all.0 + all.1 * all.1
        });
        assert_eq!(noisy.shares.len(), 2, "{noisy:?}");
        for (mode, share) in &noisy.shares {
            let truth = integral(&|w| {
                let (modes, all) = parts(w);
                modes[mode - 1].0 * all.0 + modes[mode - 1].1 * all.1
            }) / whole;
            assert!((share.0 - truth).abs() < 1e-6, "{power} {mode}: {share:?} {truth}");
        }
    }
}
