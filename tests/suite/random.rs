//! Noise: mean squares, densities and crossings beside closed forms and beside Lyapunov's equation in fractions, and what is
//! infinite. See docs/method/random.md.

use vibc::base::{SourceFile, SourceKind, Sources};
use vibc::{ModalAnswer, Spread};

pub fn answer(text: &str) -> ModalAnswer {
    let mut sources = Sources::new();
    let model = sources.add(SourceFile::decode(SourceKind::Model, "m", text.as_bytes().to_vec()));
    let outcome = vibc::analyze(&sources, model, &Default::default());
    outcome.answer.unwrap_or_else(|| panic!("an answer: {:?}", outcome.diagnostics))
}

/// Codes and messages of what the model is refused for.
pub fn refused(text: &str) -> Vec<(&'static str, String)> {
    let mut sources = Sources::new();
    let model = sources.add(SourceFile::decode(SourceKind::Model, "m", text.as_bytes().to_vec()));
    let found = vibc::analyze(&sources, model, &Default::default()).diagnostics;
    found.into_iter().filter(|finding| finding.is_error()).map(|finding| (finding.code.0, finding.message)).collect()
}

/// The rms of each output that noise reaches, and its crossings.
pub fn under_noise(text: &str) -> Vec<(Spread, Spread)> {
    answer(text).noisy.into_iter().map(|noisy| (noisy.rms, noisy.crossings)).collect()
}

/// The number, which must be the true one within its bound, and sharp.
#[track_caller]
pub fn assert_is(found: &Spread, truth: f64) {
    let Spread::Finite(ball) = found else { panic!("no number: {found:?}, but {truth}") };
    let off = (ball.to_f64() - truth).abs();
    // The truth is a rounded one.
    assert!(off <= ball.rad + 4.0 * f64::EPSILON * truth.abs(), "{found:?} {truth} {off:e}");
    assert!(ball.relative_error() < 1e-20, "{found:?}");
}

const OSCILLATOR: &str = "body b { mass = 2 kg, moves x }\nspring s: ground -- b { k = 50 N/m }\n\
                          damper d: ground -- b { c = 3 N*s/m }\n";

/// Crandall and Mark, Random Vibration in Mechanical Systems (1963), 2.2: E x^2 = S / (4 c k) with the one-sided S per Hz,
/// E x'^2 = S / (4 c m); Rice's crossings are then those of the undamped motion, whatever the damping is.
#[test]
fn an_oscillator_under_white_force() {
    for (k, c) in [("50 N/m", 3.0f64), ("50 N/m", 20.0), ("50 N/m", 1e-6), ("50 N/m", 1e4)] {
        let text = format!(
            "body b {{ mass = 2 kg, moves x }}\nspring s: ground -- b {{ k = {k} }}\n\
             damper d: ground -- b {{ c = {c} N*s/m }}\nforce F: b along x = noise(white 6 N^2/Hz)\n\
             output x = b.x\noutput v = b.vx\n"
        );
        let found = under_noise(&text);
        assert_is(&found[0].0, (6.0 / (4.0 * c * 50.0)).sqrt());
        assert_is(&found[1].0, (6.0 / (4.0 * c * 2.0)).sqrt());
        assert_is(&found[0].1, 5.0 / std::f64::consts::TAU);
    }
}

/// The integral of a function by Simpson's rule.
fn integral(of: impl Fn(f64) -> f64, [low, high]: [f64; 2]) -> f64 {
    const PARTS: usize = 20_000;
    let x = |i: usize| low + (high - low) * i as f64 / PARTS as f64;
    let weight = |i: usize| if i == 0 || i == PARTS { 1.0 } else { f64::from(2 + 2 * (i % 2) as u8) };
    (0..=PARTS).map(|i| weight(i) * of(x(i))).sum::<f64>() * (high - low) / (3 * PARTS) as f64
}

/// Noise of a base's displacement acts through the damping of the whole scene as through dampers: |H|^2 = (k^2 + (c w)^2) / |k - m w^2 +
/// i c w|^2 with c = 0.01 s k, or 2 zeta sqrt(k m); with alpha M, which damps motion relative to the base, c = alpha m.
#[test]
fn damping_of_the_whole_scene_carries_the_noise_of_a_base() {
    for (damping, c) in [("rayleigh(0 /s, 0.01 s)", 1.0), ("rayleigh(1 /s, 0 s)", 1.0), ("modal 5 %", 1.0)] {
        let text = format!(
            "damping {damping}\nbase g {{ moves x }} = noise(1 m^2/Hz, 0.5 Hz .. 2 Hz)\nbody b {{ mass = 1 kg, moves x }}\n\
             spring s: g -- b {{ k = 100 N/m }}\noutput x = b.x\noutput r = b.x - g.x\n"
        );
        let found = under_noise(&text);
        let square = |top: fn(f64, f64) -> f64, power: i32| {
            let of = |f: f64| {
                let w = std::f64::consts::TAU * f;
                top(c, w) * w.powi(power) / ((100.0 - w * w).powi(2) + (c * w).powi(2))
            };
            integral(of, [0.5, 2.0])
        };
        let carried = |c: f64, w: f64| 1e4 + (c * w).powi(2);
        let relative = |_: f64, w: f64| w.powi(4);
        for ((rms, crossings), top) in found.iter().zip([carried as fn(f64, f64) -> f64, relative]) {
            let (of, of_rate) = (square(top, 0), square(top, 2));
            for (found, truth) in [(rms, of.sqrt()), (crossings, (of_rate / of).sqrt() / std::f64::consts::TAU)] {
                let Spread::Finite(ball) = found else { panic!("{damping}: {found:?}") };
                // The rule is that accurate.
                assert!((ball.to_f64() - truth).abs() < 1e-11 * truth, "{damping}: {found:?} {truth}");
            }
        }
    }
}

/// A base's acceleration along x, and a body along (1, 1), whose static response is no rational number: the stretch is that of one
/// oscillator with k = 50 N/m and 5 %, |H| = 1 / |w0^2 - w^2 + 2 i zeta w0 w|.
#[test]
fn noise_of_an_acceleration_along_another_direction() {
    let found = under_noise(
        "damping modal 5 %\nbase g { moves x } = noise(1 m^2/s^4/Hz, 1 Hz .. 3 Hz)\nbody b { mass = 1 kg, moves along (1, 1) }\n\
         spring s: g -- b { k = 100 N/m, along = x }\noutput r = s.stretch\n",
    );
    let of = |f: f64| {
        let w = std::f64::consts::TAU * f;
        1.0 / ((50.0 - w * w).powi(2) + 0.01 * 50.0 * w * w)
    };
    let Spread::Finite(ball) = found[0].0 else { panic!("{found:?}") };
    let truth = integral(of, [1.0, 3.0]).sqrt();
    assert!((ball.to_f64() - truth).abs() < 1e-11 * truth, "{found:?} {truth}");
}

/// c = 2 sqrt(k m): both poles are one, and the matrix has a single eigenvector.
#[test]
fn critical_damping_is_no_special_case() {
    let text = "body b { mass = 2 kg, moves x }\nspring s: ground -- b { k = 50 N/m }\n\
                damper d: ground -- b { c = 20 N*s/m }\nforce F: b along x = noise(white 6 N^2/Hz)\noutput x = b.x\n";
    assert_is(&under_noise(text)[0].0, (6.0f64 / 4000.0).sqrt());
}

/// The same density per Hz and per rad/s.
#[test]
fn a_density_is_per_hertz_or_per_radian() {
    let rms = |noise: &str| {
        let text = format!("{OSCILLATOR}force F: b along x = noise(white {noise})\noutput x = b.x\n");
        under_noise(&text)[0].0.clone()
    };
    assert_is(&rms("6 N^2/Hz"), (6.0f64 / 600.0).sqrt());
    for per_radian in ["6 N^2/(rad/s)", "6 N^2*s/rad", "2 * 3 N^2/(rad/s)"] {
        assert_is(&rms(per_radian), (6.0 * std::f64::consts::TAU / 600.0).sqrt());
    }
}

/// Miles's problem, exactly: m z'' + c z' + k z = -m w; the acceleration is -(c z' + k z) / m.
#[test]
fn a_base_with_white_acceleration() {
    let text = "body b { mass = 2 kg, moves x }\nbase g { moves x } = noise(white 0.5 m^2/s^4/Hz)\n\
                spring s: g -- b { k = 50 N/m }\ndamper d: g -- b { c = 3 N*s/m }\n\
                output z = b.x - g.x\noutput a = b.ax\noutput x = b.x\noutput zdot = b.vx - g.vx\n";
    let found = under_noise(text);
    let (m, c, k, s) = (2.0f64, 3.0f64, 50.0f64, 0.5f64);
    assert_is(&found[0].0, (m * m * s / (4.0 * c * k)).sqrt());
    assert_is(&found[1].0, (s * (c / (4.0 * m) + k / (4.0 * c))).sqrt());
    assert!(matches!(&found[2].0, Spread::Infinite(why) if why.contains("drifts")), "{:?}", found[2]);
    assert_is(&found[3].0, (m * m * s / (4.0 * c * m)).sqrt());
}

/// The integral I2 of the textbooks (Newland, Random Vibrations, appendix 1): a base whose displacement is white moves a mass by a
/// spring and a damper; H = (k + c s) / (m s^2 + c s + k).
#[test]
fn a_base_with_white_displacement() {
    let text = "body b { mass = 2 kg, moves x }\nbase g { moves x } = noise(white 0.5 m^2/Hz)\n\
                spring s: g -- b { k = 50 N/m }\ndamper d: g -- b { c = 3 N*s/m }\n\
                output x = b.x\noutput v = b.vx\noutput z = b.x - g.x\n";
    let found = under_noise(text);
    let (m, c, k, s) = (2.0f64, 3.0f64, 50.0f64, 0.5f64);
    assert_is(&found[0].0, (s / 2.0 * (c * c * k + k * k * m) / (2.0 * k * c * m)).sqrt());
    assert!(matches!(&found[1].0, Spread::Infinite(why) if why.contains("damper")), "{:?}", found[1]);
    assert!(matches!(&found[2].0, Spread::Infinite(why) if why.contains("without any inertia")), "{:?}", found[2]);
}

/// Three masses whose dampers couple the modes, by Lyapunov's equation in fractions (python-flint, 40 digits).
#[test]
fn a_chain_beside_fractions() {
    let text = "body a { mass = 3 kg, moves x }\nbody b { mass = 2 kg, moves x }\nbody c { mass = 5 kg, moves x }\n\
                spring s: ground -- a { k = 1000 N/m }\nspring t: a -- b { k = 400 N/m }\n\
                spring u: b -- c { k = 700 N/m }\ndamper d: ground -- a { c = 4 N*s/m }\n\
                damper e: b -- c { c = 9 N*s/m }\nforce F: c along x = noise(white 6 N^2/Hz)\n\
                output x1 = a.x\noutput x2 = b.x\noutput x3 = c.x\noutput v1 = a.vx\noutput v3 = c.vx\n\
                output z = c.x - a.x\n";
    let found = under_noise(text);
    let truth = [
        0.024_080_486_981_253_449,
        0.077_856_605_958_287_74,
        0.101_311_147_984_608_15,
        0.148_949_853_263_658_15,
        0.578_511_387_096_046,
        0.077_500_807_623_168_5,
    ];
    for ((found, _), truth) in found.iter().zip(truth) {
        assert_is(found, truth);
    }
    assert_is(&found[0].1, 0.984_452_907_375_95);
    let shares: f64 = answer(text).noisy[0].shares.iter().map(|(_, share)| share.0).sum();
    assert!((shares - 1.0).abs() < 1e-12, "{shares}");
}

/// Two independent noises add their mean squares; the other part of the scene feels neither.
#[test]
fn independent_noises_add_up() {
    let text = format!(
        "{OSCILLATOR}force F: b along x = noise(white 6 N^2/Hz)\nforce G: b along x = noise(white 10 N^2/Hz)\n\
         body far {{ mass = 1 kg, moves x }}\nspring u: ground -- far {{ k = 1 N/m }}\n\
         damper e: ground -- far {{ c = 1 N*s/m }}\noutput x = b.x\noutput y = far.x\n"
    );
    let found = under_noise(&text);
    assert_eq!(found.len(), 1, "noise reaches one output");
    assert_is(&found[0].0, (16.0f64 / 600.0).sqrt());
}

#[test]
fn what_is_infinite_says_why() {
    for (text, why) in [
        (format!("{OSCILLATOR}force F: b along x = noise(white 6 N^2/Hz)\noutput a = b.ax\n"), "without any inertia"),
        (
            "body b { mass = 2 kg, moves x }\ndamper d: ground -- b { c = 3 N*s/m }\n\
             force F: b along x = noise(white 6 N^2/Hz)\noutput x = b.x\n"
                .to_string(),
            "nothing brings back",
        ),
        (
            "body b { mass = 2 kg, moves x }\nforce F: b along x = noise(white 6 N^2/Hz)\noutput x = b.x\n".to_string(),
            "nothing brings back",
        ),
        (
            "body b { mass = 2 kg, moves x }\nspring s: ground -- b { k = 50 N/m }\n\
             force F: b along x = noise(white 6 N^2/Hz)\noutput x = b.x\n"
                .to_string(),
            "nothing damps",
        ),
    ] {
        let found = under_noise(&text);
        assert!(matches!(&found[0].0, Spread::Infinite(reason) if reason.contains(why)), "{text}\n{found:?}");
    }
}

/// The acceleration of a mass that the noise reaches through a spring only is finite: white noise is felt by the other mass.
#[test]
fn an_acceleration_behind_a_spring_is_finite() {
    let text = format!(
        "{OSCILLATOR}body far {{ mass = 1 kg, moves x }}\nspring u: b -- far {{ k = 7 N/m }}\n\
         damper e: ground -- far {{ c = 1 N*s/m }}\nforce F: b along x = noise(white 6 N^2/Hz)\n\
         output a = far.ax\noutput sum = (7 * b.x - 7 * far.x) / 1 s^2 - far.vx * 1 /s\n"
    );
    let found = under_noise(&text);
    let [(Spread::Finite(a), _), (Spread::Finite(sum), _)] = &found[..] else { panic!("{found:?}") };
    assert!((a.to_f64() - sum.to_f64()).abs() <= a.rad + sum.rad + 1e-15 * a.to_f64(), "{a:?} {sum:?}");
}

/// In `require`: the number, the density as |H|^2 S, and what needs to be said where other motion reaches the output too.
#[test]
fn measures_of_noise() {
    let scene = format!("{OSCILLATOR}force F: b along x = noise(white 6 N^2/Hz)\noutput x = b.x\n");
    let value = |require: &str| {
        let answer = answer(&format!("{scene}require {require}\n"));
        answer.requirements[0].shown_value().map(|shown| shown.number.to_f64())
    };
    let close = |found: Option<f64>, truth: f64| {
        assert!(found.is_some_and(|found| (found - truth).abs() < 1e-14 * truth), "{found:?} {truth}");
    };
    close(value("rms(x) < 2 m"), (6.0f64 / 600.0).sqrt());
    close(value("rms(x, noise) < 2 m"), (6.0f64 / 600.0).sqrt());
    close(value("crossings(x) < 2 Hz"), 5.0 / std::f64::consts::TAU);
    let w = std::f64::consts::TAU * 0.5;
    close(value("psd(x, 0.5 Hz) < 2 m^2/Hz"), 6.0 / ((50.0 - 2.0 * w * w).powi(2) + 9.0 * w * w));
    let both = format!("{scene}initial b {{ x = 1 mm }}\n");
    let found = refused(&format!("{both}require rms(x) < 1 m\n"));
    assert_eq!(found.len(), 1, "{found:?}");
    close(
        answer(&format!("{both}require rms(x, noise) < 1 m\n")).requirements[0]
            .shown_value()
            .map(|v| v.number.to_f64()),
        0.1,
    );
}

/// Code_Aster V2.01.023, SDLD23: eight masses of 10 kg between two walls, springs of 1e5 N/m and dampers of 50 N s/m, white noise on the
/// fourth mass. Its printed density there at 5.5259 Hz is 0.1059e-5 m^2/Hz.
#[test]
fn eight_masses_of_code_aster() {
    let mut text = String::new();
    (1..=8).for_each(|i| text += &format!("body p{i} {{ mass = 10 kg, moves x }}\n"));
    for i in 0..=8 {
        let end = |i: usize| if i == 0 || i == 9 { "ground".to_string() } else { format!("p{i}") };
        let (a, b) = (end(i), end(i + 1));
        text += &format!("spring s{i}: {a} -- {b} {{ k = 1e5 N/m }}\ndamper d{i}: {a} -- {b} {{ c = 50 N*s/m }}\n");
    }
    text += "force F: p4 along x = noise(white 1 N^2/Hz)\noutput x = p4.x\nrequire psd(x, 5.5259 Hz) < 1 m^2/Hz\n";
    let found = answer(&text).requirements[0].shown_value().expect("a number").number.to_f64();
    // Half a unit of the last printed digit.
    assert!((found - 0.1059e-5).abs() <= 0.5e-9, "{found}");
}

/// ANSYS VM68: two masses on a base that shakes with 0.1 g^2/Hz from 10 to 100 Hz, 2 % in each mode. Its standard deviations, 9.059 and
/// 10.63 g by a sum over the frequencies 0.001 Hz apart, are those of the accelerations relative to the base.
#[test]
fn two_masses_of_ansys() {
    let found = answer(
        "damping modal 2 %\nbase g { moves x } = noise(0.1 g0^2/Hz, 10 Hz .. 100 Hz)\n\
         body a { mass = 0.5 lbf*s^2/inch, moves x }\nbody b { mass = 1 lbf*s^2/inch, moves x }\n\
         spring s: g -- a { k = 42832 lbf/inch }\nspring t: a -- b { k = 32416 lbf/inch }\n\
         output u in g0 = a.ax - g.ax\noutput v in g0 = b.ax - g.ax\nrequire rms(u) < 99 g0\nrequire rms(v) < 99 g0\n",
    );
    // Half a unit of the last printed digit.
    for (row, (printed, half)) in [(9.059, 0.0005), (10.63, 0.005)].into_iter().enumerate() {
        let rms = found.requirements[row].shown_value().expect("a number").number.to_f64();
        assert!((rms - printed).abs() <= half, "{rms} {printed}");
    }
}

/// Code_Aster V2.01.101: 100 kg on 1e6 N/m with 5 %, on a base that shakes with one density from 0 to 100 Hz: the densities of the
/// absolute and of the relative acceleration by its closed forms.
#[test]
fn a_mass_on_a_shaken_base_of_code_aster() {
    for frequency in [0.0f64, 5.0, 10.0, 15.0, 20.0] {
        let found = answer(&format!(
            "damping modal 5 %\nbase g {{ moves x }} = noise(1 m^2/s^4/Hz, 0 Hz .. 100 Hz)\nbody m {{ mass = 100 kg, moves x }}\n\
             spring s: g -- m {{ k = 1e6 N/m }}\noutput u = m.ax\noutput v = m.ax - g.ax\n\
             require psd(u, {frequency} Hz) < 999 m^2/s^4/Hz\nrequire psd(v, {frequency} Hz) < 999 m^2/s^4/Hz\n"
        ));
        let (w, w0, zeta) = (frequency * std::f64::consts::TAU, 100.0f64, 0.05);
        let below = (w0 * w0 - w * w).powi(2) + (2.0 * zeta * w0 * w).powi(2);
        let truth = [(w0.powi(4) + (2.0 * zeta * w0 * w).powi(2)) / below, w.powi(4) / below];
        for (row, truth) in truth.into_iter().enumerate() {
            let density = found.requirements[row].shown_value().expect("a number").number.to_f64();
            assert!((density - truth).abs() <= 1e-13 * truth.max(1e-3), "{frequency} Hz: {density} {truth}");
        }
    }
}

/// The density of noise in bands, between its corner points and outside of them.
#[test]
fn densities_of_bands() {
    let w = |f: f64| std::f64::consts::TAU * f;
    let gain2 = |f: f64| 1.0 / ((50.0 - 2.0 * w(f) * w(f)).powi(2) + 9.0 * w(f) * w(f));
    for (noise, at, density) in [
        ("noise(6 N^2/Hz, 1 Hz .. 2 Hz)", 1.5, 6.0),
        ("noise(6 N^2/Hz, 1 Hz .. 2 Hz)", 2.5, 0.0),
        ("noise((1 Hz, 2 N^2/Hz), (100 Hz, 8 N^2/Hz))", 10.0, 4.0),
        ("noise((1 Hz, 2 N^2/Hz), (4 Hz, 8 N^2/Hz))", 2.0, 4.0),
    ] {
        let text =
            format!("{OSCILLATOR}force F: b along x = {noise}\noutput x = b.x\nrequire psd(x, {at} Hz) < 1 m^2/Hz\n");
        let found = answer(&text).requirements[0].shown_value().expect("a number").number.to_f64();
        let truth = density * gain2(at);
        assert!((found - truth).abs() <= 1e-13 * truth, "{noise}: {found} {truth}");
    }
}

/// ISO 8608, class A: Gd(0.1 /m) = 16e-6 m^3; at 20 m/s that is the density at 2 Hz times the speed.
#[test]
fn a_road_is_a_density_over_time() {
    let text = "body b { mass = 2 kg, moves y }\nbase lane { moves y } = noise(road(16e-6 m^3, 20 m/s))\n\
                spring s: lane -- b { k = 50 N/m }\ndamper d: lane -- b { c = 3 N*s/m }\noutput y = lane.y\n\
                require psd(y, 2 Hz) < 1 m^2/Hz\nrequire psd(y, 4 Hz) < 1 m^2/Hz\nrequire psd(y, 60 Hz) < 1 m^2/Hz\n";
    let answer = answer(text);
    let value = |i: usize| answer.requirements[i].shown_value().expect("a number").number.to_f64();
    assert!((value(0) - 8e-7).abs() < 1e-20 && (value(1) - 2e-7).abs() < 1e-20, "{} {}", value(0), value(1));
    assert_eq!(value(2), 0.0);
}

/// One clear finding for each mistake.
#[test]
fn what_is_wrong_is_found_where_it_stands() {
    for (noise, code) in [
        ("noise(white 3 N^2*s)", "vib::noise::reading"),
        ("noise(white 3 N)", "vib::unit::mismatch"),
        ("noise(3 N^2/Hz)", "vib::signal::arguments"),
        ("noise(white = 3 N^2/Hz)", "vib::signal::arguments"),
        ("noise(3 N^2/Hz, 2 Hz .. 1 Hz)", "vib::noise::frequency"),
        ("noise(3 N^2/Hz, -2 Hz .. 1 Hz)", "vib::noise::frequency"),
        ("noise((2 Hz, 1 N^2/Hz), (2 Hz, 3 N^2/Hz))", "vib::noise::frequency"),
        ("noise((0 Hz, 1 N^2/Hz), (2 Hz, 3 N^2/Hz))", "vib::noise::frequency"),
        ("noise((1 Hz, 1 N^2/Hz), (2 Hz, 0 N^2/Hz))", "vib::noise::density"),
        ("noise((1 Hz, 1 N^2/Hz))", "vib::signal::arguments"),
        ("noise()", "vib::signal::arguments"),
        ("noise(raod(16e-6 m^3, 20 m/s))", "vib::signal::arguments"),
    ] {
        let found = refused(&format!("{OSCILLATOR}force F: b along x = {noise}\noutput x = b.x\n"));
        assert_eq!(found.iter().map(|(code, _)| *code).collect::<Vec<_>>(), [code], "{noise}: {found:?}");
    }
}

/// A misspelt function of `noise` is named, with the known one that is nearest.
#[test]
fn a_misspelt_road_has_a_suggestion() {
    let findings = |word: &str| {
        let text = format!(
            "body b {{ mass = 2 kg, moves y }}\nbase lane {{ moves y }} = noise({word}(16e-6 m^3, 20 m/s))\n\
             spring s: lane -- b {{ k = 50 N/m }}\noutput y = b.y\n"
        );
        let mut sources = Sources::new();
        let model = sources.add(SourceFile::decode(SourceKind::Model, "m", text.as_bytes().to_vec()));
        let found = vibc::analyze(&sources, model, &Default::default()).diagnostics;
        let shown = found.into_iter().filter(|finding| finding.is_error());
        shown.map(|finding| format!("{} {:?}", finding.message, finding.help)).collect::<Vec<_>>()
    };
    let found = findings("raod");
    assert!(found.len() == 1 && found[0].contains("`raod`") && found[0].contains("did you mean `road`"), "{found:?}");
    let found = findings("spectrogram");
    assert!(found.len() == 1 && found[0].contains("noise(road("), "{found:?}");
}

/// Two equal masses between equal springs, a damper between them alone, and numbers that are no fractions: the undamped motion is not
/// found. No certificate exists, and the report has no number but says what is not proved.
#[test]
fn without_a_certificate_there_is_no_number() {
    let text = "body a { mass = 2 kg * sqrt(2), moves x }\nbody b { mass = 2 kg * sqrt(2), moves x }\n\
                spring s: ground -- a { k = 50 N/m }\nspring t: ground -- b { k = 50 N/m }\nspring u: a -- b { k = 7 N/m }\n\
                damper d: a -- b { c = 3 N*s/m }\nforce F: a along x = noise(white 6 N^2/Hz)\noutput x = a.x\n\
                output z = b.x - a.x\n";
    let found = under_noise(text);
    for (rms, crossings) in &found {
        for spread in [rms, crossings] {
            assert!(
                matches!(spread, Spread::Unknown(why) if why.contains("not proved that every motion decays")),
                "{spread:?}"
            );
        }
    }
    let report = vibc::report(&answer(text), &Default::default());
    let section = &report[report.find("stationary response to noise").expect("a section")..];
    let row = section.lines().find(|line| line.trim_start().starts_with("x ")).expect("a row");
    assert!(!row.chars().any(|c| c.is_ascii_digit()), "{row}");
    assert!(section.contains("rms of x: it is not proved that every motion decays"), "{section}");
    // With the least damping of that motion there is a number again.
    let damped = format!("{text}damper e: ground -- a {{ c = 1e-6 N*s/m }}\n");
    assert!(under_noise(&damped).iter().all(|(rms, _)| matches!(rms, Spread::Finite(_))));
}

/// The chain of `a_chain_beside_fractions` by `scipy.linalg.solve_continuous_lyapunov` (SciPy 1.x), which has fourteen digits.
#[test]
fn a_chain_beside_scipy() {
    let text = "body a { mass = 3 kg, moves x }\nbody b { mass = 2 kg, moves x }\nbody c { mass = 5 kg, moves x }\n\
                spring s: ground -- a { k = 1000 N/m }\nspring t: a -- b { k = 400 N/m }\n\
                spring u: b -- c { k = 700 N/m }\ndamper d: ground -- a { c = 4 N*s/m }\n\
                damper e: b -- c { c = 9 N*s/m }\nforce F: c along x = noise(white 6 N^2/Hz)\noutput x1 = a.x\n\
                output x2 = b.x\noutput x3 = c.x\noutput v1 = a.vx\noutput v3 = c.vx\noutput z = c.x - a.x\n";
    let scipy = [
        0.024_080_486_981_248_86,
        0.077_856_605_958_275_14,
        0.101_311_147_984_592_4,
        0.148_949_853_263_554_7,
        0.578_511_387_095_967_1,
        0.077_500_807_623_156_82,
    ];
    for ((found, _), truth) in under_noise(text).iter().zip(scipy) {
        let Spread::Finite(found) = found else { panic!("{found:?}") };
        assert!((found.to_f64() / truth - 1.0).abs() < 1e-12, "{found:?} {truth}");
    }
}

/// A density is in the square of its output's unit, and says so: the same output in m, in mm and as a velocity.
#[test]
fn densities_have_the_units_of_their_outputs() {
    let text = crate::program::text(
        &format!(
            "{OSCILLATOR}force F: b along x = noise(white 6 N^2/Hz)\noutput x = b.x\noutput z in mm = b.x\noutput v = b.vx\n"
        ),
        &["analyze"],
    );
    let row = |name: &str, unit: &str| -> f64 {
        let line = text.lines().find(|line| line.trim_start().starts_with(name) && line.contains(unit));
        let line = line.unwrap_or_else(|| panic!("{name} {unit}: {text}"));
        line.split_whitespace().nth(2).expect("a density").parse().expect("a number")
    };
    let (metres, millimetres) = (row("x ", " m^2/Hz"), row("z ", " mm^2/Hz"));
    assert!((millimetres / metres - 1e6).abs() < 10.0, "{metres} {millimetres}");
    // The peak of |1 / (k - m w^2 + i c w)|^2 S, at w^2 = k/m - c^2 / (2 m^2): S / (c^2 (k/m - c^2 / (4 m^2))).
    let truth = 6.0 / (9.0 * (25.0 - 9.0 / 16.0));
    assert!((metres - truth).abs() < 1e-5 * truth, "{metres} {truth}");
    row("v ", " (m/s)^2/Hz");
    assert!(!text.contains("SI^2"), "{text}");
}
