//! Every measure compared with its definition: closed forms, dense sampling, quadrature and the simulated motion;
//! published cases; and the validity of bounds.

use vibc::analysis::grid;
use vibc::answers::ModalAnswer;
use vibc::base::{Ball, Number, Rational, SourceFile, Sources};
use vibc::model::Overrides;
use vibc::questions::answer::Value;

pub fn sources(text: &str) -> (Sources, vibc::base::FileId) {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("model.vib", text));
    (sources, file)
}

/// Measures of the motion up to a time.
fn up_to(until: &Number) -> vibc::Study<'_> {
    vibc::Study { until: Some(until), ..vibc::Study::default() }
}

/// The report of a model whose requirements may fail.
fn answer(text: &str) -> ModalAnswer {
    let (sources, file) = sources(text);
    let outcome = vibc::analyze(&sources, file, &Overrides::default());
    let messages: Vec<&str> =
        outcome.diagnostics.iter().map(|d| d.code.0).filter(|c| *c != "vib::require::fails").collect();
    assert!(messages.is_empty(), "{messages:?}\n{text}");
    outcome.answer.expect("a report")
}

/// The enclosures of measures, obtained by requirements that may fail.
fn measured(model: &str, measures: &[&str]) -> Vec<Ball> {
    let requires: String = measures.iter().map(|measure| format!("require {measure}\n")).collect();
    let answer = answer(&format!("{model}{requires}"));
    let number = |value: &Value| match value {
        Value::Number(ball) => *ball,
        other => panic!("{other:?}\n{model}{requires}"),
    };
    answer.requirements.iter().map(|requirement| number(&requirement.value)).collect()
}

fn one(model: &str, measure: &str) -> Ball {
    measured(model, &[measure])[0]
}

/// Asserts that |true - value| is within the enclosure, and that this is narrow.
fn agrees(value: Ball, truth: f64, width: f64) {
    let off = (value.to_f64() - truth).abs();
    // Rounding error of the expected number itself.
    let rounding = 1e-14 * truth.abs();
    assert!(off <= value.rad + rounding, "{value:?} is not {truth}");
    assert!(value.rad <= width * truth.abs(), "{value:?} is known to less than {width}");
}

/// A unit oscillator of 10 rad/s with a damping ratio, under a signal.
fn oscillator(zeta: f64, signal: &str) -> String {
    let c = 20.0 * zeta;
    format!(
        "body block {{ mass = 1 kg, moves x }}\nspring s: ground -- block {{ k = 100 N/m }}\n\
         damper d: ground -- block {{ c = {c} N*s/m }}\nforce F: block along x{signal}\noutput x = block.x\n"
    )
}

/// Under a step the first swing is the largest: a/k (1 + exp(-pi zeta / sqrt(1 - zeta^2))).
#[test]
fn the_peak_after_a_step_is_the_overshoot() {
    for zeta in [0.01, 0.1, 0.5, 0.9] {
        let peak = one(&oscillator(zeta, " = step(10 N, 0.3 s)"), "peak(x) < 1 m");
        let over = (-std::f64::consts::PI * zeta / (1.0 - zeta * zeta).sqrt()).exp();
        agrees(peak, 0.1 * (1.0 + over), 1e-11);
    }
}

/// With overdamping, the step response approaches its rest monotonically and is largest at the end of the time.
#[test]
fn the_peak_of_a_creeping_motion_is_at_the_end() {
    let zeta = 2.0f64;
    let root = (zeta * zeta - 1.0).sqrt();
    let (slow, fast) = (-10.0 * (zeta - root), -10.0 * (zeta + root));
    let at = |t: f64| 0.1 * (1.0 - (fast * (slow * t).exp() - slow * (fast * t).exp()) / (fast - slow));
    let model = oscillator(zeta, " = step(10 N, 0 s)") + "require peak(x) < 1 m\n";
    let (sources, file) = sources(&model);
    let until = Number::from(2);
    let request = vibc::analysis::Request::default();
    let outcome = vibc::analyze_with(&sources, file, &Overrides::default(), &request, &up_to(&until));
    let Value::Number(peak) = outcome.answer.expect("a report").requirements[0].value else { panic!("no number") };
    agrees(peak, at(2.0), 1e-11);
}

/// An impulse starts the motion: x = J/(m wd) exp(-zeta w t) sin(wd t), largest where tan(wd t) = wd/(zeta w).
#[test]
fn the_peak_after_an_impulse() {
    let zeta = 0.05f64;
    let damped = 10.0 * (1.0 - zeta * zeta).sqrt();
    let t = (damped / (10.0 * zeta)).atan() / damped;
    let truth = 2.0 / damped * (-10.0 * zeta * t).exp() * (damped * t).sin();
    agrees(one(&oscillator(zeta, " = impulse(2 N*s, 0.1 s)"), "peak(x) < 1 m"), truth, 1e-11);
    // The impulse itself causes an infinite acceleration.
    let answer = answer(&(oscillator(zeta, " = impulse(2 N*s, 0.1 s)") + "require peak(block.ax) < 1 m/s^2\n"));
    assert!(matches!(answer.requirements[0].value, Value::Infinite));
}

/// Peak and rms of random chains under random signals, compared with samples of the simulated motion: none is above the
/// peak, and the nearest comes close to it; Simpson's rule gives the mean square.
#[test]
fn peak_and_rms_agree_with_dense_samples() {
    let mut random = crate::independent::random_scenes::Random::new(5);
    let signals = [
        "step(1 N, 0.2 s)",
        "harmonic(1 N, 1.3 Hz, 0.4)",
        "chirp(1 N, 0.2 Hz, 3 Hz, 4 s)",
        "pulse(2 N, 0.1 s, 0.7 s)",
        "ramp(1 N, 0.1 s, 2 s) + harmonic(0.3 N, 5 Hz)",
        "impulse(1 N*s, 0.5 s)",
    ];
    for signal in signals {
        let mut model = String::new();
        for i in 0..3 {
            let mut number = |low: u32, high: u32| f64::from(low + random.below((high - low) as usize) as u32) / 100.0;
            let (m, k, c) = (number(50, 200), number(2000, 20000), number(5, 200));
            let before = if i == 0 { "ground".to_string() } else { format!("m{}", i - 1) };
            model += &format!(
                "body m{i} {{ mass = {m} kg, moves x }}\nspring k{i}: {before} -- m{i} {{ k = {k} N/m }}\n\
                 damper c{i}: {before} -- m{i} {{ c = {c} N*s/m }}\n"
            );
        }
        model += &format!("force F: m1 along x = {signal}\noutput x = m2.x\noutput v = m0.vx\n");
        let requires = "require peak(x) < 0 m\nrequire rms(x) < 0 m\nrequire peak(v) < 0 m/s\nrequire rms(v) < 0 m/s\n";
        let (sources, file) = sources(&(model.clone() + requires));
        let until = Number::from(5);
        let request = vibc::analysis::Request::default();
        let outcome = vibc::analyze_with(&sources, file, &Overrides::default(), &request, &up_to(&until));
        let found = outcome.answer.expect("a report").requirements;
        let step = Number::from(Rational::new(1, 2000));
        let motion =
            vibc::simulate(&sources, file, &Overrides::default(), &grid(&until, &step)).answer.expect("a motion");
        for (output, pair) in found.chunks(2).enumerate() {
            let [Value::Number(peak), Value::Number(rms)] = [&pair[0].value, &pair[1].value] else {
                panic!("{pair:?}")
            };
            let samples: Vec<f64> = motion.history.values.iter().map(|row| row[output].to_f64()).collect();
            let largest = samples.iter().map(|x| x.abs()).fold(0.0, f64::max);
            assert!(peak.rad < 1e-9 * peak.to_f64() && rms.rad < 1e-9 * rms.to_f64(), "{signal} {peak:?} {rms:?}");
            assert!(largest <= peak.to_f64() + peak.rad, "{signal} {output}: {largest} above {peak:?}");
            // Between samples a curve of 30 rad/s rises by at most (30 h)^2 / 8; a jump of velocity is at a sample.
            assert!(largest >= peak.to_f64() * (1.0 - 1e-4), "{signal} {output}: {largest} below {peak:?}");
            let sum: f64 = samples.windows(3).step_by(2).map(|w| w[0] * w[0] + 4.0 * w[1] * w[1] + w[2] * w[2]).sum();
            let simpson = (sum / 6.0 / ((samples.len() - 1) / 2) as f64).sqrt();
            let off = (simpson - rms.to_f64()).abs() / rms.to_f64();
            assert!(off < 2e-4, "{signal} {output}: {simpson} {rms:?}");
        }
    }
}

/// A free undamped oscillation: the peak is its amplitude, and over whole half-periods the rms is the amplitude over
/// sqrt 2.
#[test]
fn a_free_oscillation_has_its_amplitude_and_rms() {
    let model = "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 1 N/m }\n\
                 initial a { x = 3 mm, vx = 4 mm/s }\noutput x = a.x\n";
    agrees(one(model, "peak(x) < 1 m"), 5e-3, 1e-10);
    let text = format!("{model}require rms(x) < 1 m\n");
    let (sources, file) = sources(&text);
    let until = &Number::pi() * &Number::from(7);
    let request = vibc::analysis::Request::default();
    let outcome = vibc::analyze_with(&sources, file, &Overrides::default(), &request, &up_to(&until));
    let Value::Number(rms) = outcome.answer.expect("a report").requirements[0].value else { panic!("no number") };
    agrees(rms, 5e-3 / 2f64.sqrt(), 1e-10);
}

/// After the transients the simulated motion oscillates with the steady amplitude.
#[test]
fn the_amplitude_is_that_after_the_transients() {
    let model = oscillator(0.1, " = harmonic(10 N, 1 Hz) + harmonic(4 N, 2 Hz, 30 deg)");
    let amplitude = one(&model, "amplitude(x) < 1 m");
    let part = |force: f64, f: f64| {
        let w = std::f64::consts::TAU * f;
        force / ((100.0 - w * w).powi(2) + (2.0 * w).powi(2)).sqrt()
    };
    agrees(amplitude, part(10.0, 1.0) + part(4.0, 2.0), 1e-15);
    let single = oscillator(0.1, " = harmonic(10 N, 1 Hz)");
    let amplitude = one(&single, "amplitude(x) < 1 m").to_f64();
    let (sources, file) = sources(&single);
    let times: Vec<Number> = (0..4000).map(|i| Number::from(Rational::new(40_000 + i, 1000))).collect();
    let motion = vibc::simulate(&sources, file, &Overrides::default(), &times).answer.expect("a motion");
    let largest = motion.history.values.iter().map(|row| row[0].to_f64().abs()).fold(0.0, f64::max);
    assert!((largest / amplitude - 1.0).abs() < 1e-5, "{largest} {amplitude}");
}

/// Static values, frequencies, ratios, gains and phases of one oscillator.
#[test]
fn the_others_by_their_formulas() {
    let model = oscillator(0.05, " = step(10 N, 0 s)");
    let measures = [
        "static(x) < 1 m",
        "frequency(1) < 1 Hz",
        "damping(1) < 1",
        "gain(F -> x, 1 Hz) < 1 m/N",
        "phase(F -> x, 1 Hz) < 0 deg",
        "gain(F -> block.ax, 10 rad/s) < 1 m/s^2/N",
    ];
    let found = measured(&model, &measures);
    let w = std::f64::consts::TAU;
    let (re, im) = (100.0 - w * w, w);
    let expected = [0.1, 10.0 / w, 0.05, 1.0 / re.hypot(im), -im.atan2(re), 100.0 / 10.0];
    for (value, truth) in found.into_iter().zip(expected) {
        agrees(value, truth, 1e-20);
    }
}

/// Motion is measured from the rest, of which constant loads are a part: `static` is where `simulate` ends, and `settling` and
/// `overshoot` count from there. A hardening spring shows that a constant load has no such value of its own: 100 N/m * 0.2 m + 1 kN/m^3 *
/// (0.2 m)^3 = 28 N, tangent 220 N/m.
#[test]
fn a_static_value_counts_from_the_rest() {
    let model = |signal: &str| {
        format!(
            "body b {{ mass = 2 kg, moves x }}\nspring s: ground -- b {{ law = 100 N/m * stretch + 1 kN/m^3 * stretch^3 }}\n\
             damper d: ground -- b {{ c = 40 N*s/m }}\nforce F: b along x = {signal}\noutput x = b.x\n"
        )
    };
    let value = |signal: &str, measure: &str| {
        let text = format!("{}require {measure}\n", model(signal));
        let told = crate::program::json(&text, &["analyze"]);
        told["requirements"][0]["value"].as_f64().unwrap_or_else(|| panic!("{signal} {measure}: {told}"))
    };
    for signal in ["constant(28 N) + step(11 N, 0 s)", "step(11 N, 0 s) + constant(14 N) + constant(14 N)"] {
        assert!((value(signal, "static(x) < 1 m") - 0.05).abs() < 1e-15);
        assert!((value(signal, "rest(b.x) < 1 m") - 0.2).abs() < 1e-15);
        let end = crate::signals::simulated(&model(signal), &[], &["--until", "60 s", "--step", "60 s"]);
        assert!((end[1][1] - 0.05).abs() < 1e-15, "{end:?}");
        // Poles -10 +- sqrt(100 - 110) i
        let overshoot = (-10.0 * std::f64::consts::PI / 10f64.sqrt()).exp();
        assert!((value(signal, "overshoot(x) < 1") - overshoot).abs() < 1e-15);
    }
    let alone = format!("{}require static(x) < 1 m\n", model("constant(28 N)"));
    let found = crate::program::finding(&alone, &["check"]);
    assert_eq!(found["code"], "vib::require::no_value");
    assert!(found.to_string().contains("constant loads are part of the rest"), "{found}");
}

/// Den Hartog's tuned damper (V10 of the published cases): with the classic tuning the two peaks are not quite equal.
#[test]
fn den_hartog() {
    let model = "let mu = 0.05\nlet f = 1/(1 + mu)\nlet zeta = sqrt(3*mu/(8*(1 + mu)))\n\
                 body a { mass = 1 kg, moves x }\nbody b { mass = mu * 1 kg, moves x }\n\
                 spring s: ground -- a { k = 1 N/m }\nspring t: a -- b { k = mu*f^2 * 1 N/m }\n\
                 damper d: a -- b { c = 2*zeta*mu*f * 1 N*s/m }\nforce F: a along x\n";
    for (ratio, height) in [(0.899102590673, 6.40749226153), (1.05275472685, 6.40844316970)] {
        let gain = one(model, &format!("gain(F -> a.x, {ratio} rad/s) < 1 m/N"));
        // The heights are printed with twelve digits.
        assert!((gain.to_f64() / height - 1.0).abs() < 1e-11, "{gain:?} {height}");
    }
}

/// C04 (ANSYS VM90): two masses between three springs, 200 N on the first.
#[test]
fn harmonic_answers_of_two_masses() {
    let model = "body a { mass = 0.5 kg, moves x }\nbody b { mass = 0.5 kg, moves x }\n\
                 spring r: ground -- a { k = 200 N/m }\nspring s: a -- b { k = 200 N/m }\nspring t: b -- ground { k = 200 N/m }\n\
                 force F: a along x = harmonic(200 N, f)\noutput u1 = a.x\noutput u2 = b.x\n";
    for (f, u1, u2) in [
        ("1.5", 0.822718011937, 0.462738244367),
        ("4", 0.511455279575, 1.21525275463),
        ("6.5", 0.585117376324, 0.269650793591),
    ] {
        let model = format!("param f = {f} Hz\n{model}");
        let found = measured(&model, &["amplitude(u1) < 1 m", "amplitude(u2) < 1 m"]);
        for (value, truth) in found.into_iter().zip([u1, u2]) {
            assert!((value.to_f64() / truth - 1.0).abs() < 1e-10, "{value:?} {truth}");
        }
    }
}

/// C07 (ANSYS VM149): the first peak of a chain with 2 % in every mode, near its first frequency.
#[test]
fn a_chain_with_modal_damping() {
    let mut model = String::from("damping modal 2 %\n");
    for i in 1..=4 {
        let mass = if i == 4 { "0.5" } else { "1" };
        let before = if i == 1 { "ground".to_string() } else { format!("m{}", i - 1) };
        model +=
            &format!("body m{i} {{ mass = {mass} kg, moves x }}\nspring k{i}: {before} -- m{i} {{ k = 1e4 N/m }}\n");
    }
    model += "spring k5: m4 -- ground { k = 1e4 N/m }\nforce F: m3 along x\n";
    let found = measured(
        &model,
        &[
            "frequency(1) < 1 Hz",
            "frequency(4) < 1 Hz",
            "gain(F -> m3.x, 10.102 Hz) < 1 m/N",
            "gain(F -> k4.force, 10.102 Hz) < 1",
        ],
    );
    for (value, truth) in found.into_iter().zip([10.1552531694642, 34.9632476435319, 2.26121625e-3, 10.0403497]) {
        assert!((value.to_f64() / truth - 1.0).abs() < 5e-8, "{value:?} {truth}");
    }
}

/// S11 (ANSYS VM88) and S08 (VM74), S09 (VM75): amplitudes at and above resonance, and the largest motion.
#[test]
fn published_amplitudes_and_peaks() {
    let unbalance = |force: &str, f: &str| {
        format!(
            "body a {{ mass = 0.02590673 kg, moves x }}\nspring s: ground -- a {{ k = 30 N/m }}\n\
             damper d: ground -- a {{ c = 0.11754533 N*s/m }}\nforce F: a along x = harmonic({force} N, {f} Hz)\n"
        )
    };
    for (force, f, truth) in [("2.4", "5.415947", 0.600000466516), ("24000", "541.5947", 0.0800079494981)] {
        let amplitude = one(&unbalance(force, f), "amplitude(a.x) < 1 m");
        assert!((amplitude.to_f64() / truth - 1.0).abs() < 1e-11, "{amplitude:?} {truth}");
    }
    let mass = "body a { mass = 0.5 kg, moves x }\nspring s: ground -- a { k = 200 N/m }\nforce F: a along x";
    // Without damping, a step doubles its static value; an impulse causes oscillations of J / sqrt(k m).
    agrees(one(&format!("{mass} = step(200 N, 0 s)\n"), "peak(a.x) < 9 m"), 2.0, 1e-10);
    agrees(one(&format!("{mass} = impulse(10 N*s, 0 s)\n"), "peak(a.x) < 9 m"), 1.0, 1e-10);
}

/// A parameter, and the relative slopes of the frequencies and of the damping ratios.
type Slopes = (String, Vec<Ball>, Vec<Ball>);

/// The slopes by every parameter.
fn sensitivities(text: &str) -> Vec<Slopes> {
    let (sources, file) = sources(text);
    let study = vibc::Study { sensitivity: true, ..vibc::Study::default() };
    let request = vibc::analysis::Request::default();
    let outcome = vibc::analyze_with(&sources, file, &Overrides::default(), &request, &study);
    use vibc::questions::answer::{Derivative, Slope};
    let relative = |slope: &Option<Slope>| match slope {
        Some(Slope::Smooth { relative: Derivative::Enclosed(ball), .. }) => *ball,
        // By differences, if the rest moves too.
        Some(Slope::Smooth { relative: Derivative::Estimated(x), .. }) => Ball::from(x.0).widen(1e-13 * x.0.abs()),
        other => panic!("{other:?}"),
    };
    let list = outcome.answer.expect("a report").sensitivities;
    let reported = list.iter().map(|sensitivity| {
        let frequencies = sensitivity.frequencies.iter().map(relative).collect();
        (sensitivity.parameter.clone(), frequencies, sensitivity.ratios.iter().map(relative).collect())
    });
    reported.collect()
}

/// Frequencies are homogeneous of degree 1/2 in all stiffnesses together and of degree -1/2 in all masses; damping
/// ratios stay the same if masses, dampers and stiffnesses are scaled by the same factor, and if dampers are scaled by
/// the root of that of stiffnesses (Euler's theorem). No sum of wrong slopes would satisfy that for each mode.
#[test]
fn sensitivities_obey_eulers_theorem() {
    let mut model = String::new();
    for i in 1..=4 {
        let before = if i == 1 { "ground".to_string() } else { format!("m{}", i - 1) };
        model += &format!(
            "param m_{i} = {i}.5 kg\nparam k_{i} = 1{i}0 N/m\nparam c_{i} = 0.{i} N*s/m\n\
             body m{i} {{ mass = m_{i}, moves x }}\nspring k{i}: {before} -- m{i} {{ k = k_{i} }}\n\
             damper c{i}: {before} -- m{i} {{ c = c_{i} }}\n"
        );
    }
    let list = sensitivities(&model);
    for mode in 0..4 {
        let sum = |kind: &str, of: fn(&Slopes) -> &Vec<Ball>| {
            let slopes = list.iter().filter(|(name, ..)| name.starts_with(kind)).map(|entry| of(entry)[mode]);
            slopes.fold(Ball::ZERO, |sum, slope| sum + slope)
        };
        // Each slope is that at a value within 2^-33 of the parameter.
        let is = |found: Ball, expected: f64| (found.to_f64() - expected).abs() <= found.rad + 1e-15;
        for (kind, degree) in [("m_", -0.5), ("k_", 0.5), ("c_", 0.0)] {
            assert!(is(sum(kind, |(_, slopes, _)| slopes), degree), "{kind} {mode}");
        }
        let [m, k, c] = ["m_", "k_", "c_"].map(|kind| sum(kind, |(.., slopes)| slopes));
        assert!(is(m + k + c, 0.0) && is(k + k + c, 0.0), "{mode}: {m:?} {k:?} {c:?}");
        assert!(c.to_f64() > 0.9, "lightly damped, a ratio goes with the dampers");
    }
}

/// A rod that a torsional spring with an offset holds at an angle: k q = t - m g (L/2) sin q. Both the stiffness and
/// the rest depend on each parameter; the formula is differentiated by hand.
#[test]
fn sensitivities_follow_the_rest() {
    let model = "param k = 20 N*m/rad\nparam t = 6 N*m\nparam m = 2 kg\nlet L = 1.5 m\ngravity 10 m/s^2\n\
                 body rod { mass = m, shape = rod((0, 0), (0, -L)) }\npivot p: ground@(0, 0) -- rod\n\
                 spring s: ground -- rod { k = k }\ntorque T: rod = constant(t)\n";
    let (k, t, m) = (20.0f64, 6.0, 2.0);
    let g = m * 10.0 * 0.75;
    let mut q = 0.2;
    for _ in 0..50 {
        q -= (k * q - t + g * f64::sin(q)) / (k + g * f64::cos(q));
    }
    let (sine, cosine) = q.sin_cos();
    let stiffness = k + g * cosine;
    // dq/dp from the rest, then d(stiffness)/dp; frequency goes with sqrt(stiffness / m).
    let dq = [-q / stiffness, 1.0 / stiffness, -(g / m) * sine / stiffness];
    let direct = [1.0, 0.0, g / m * cosine];
    let values = [k, t, m];
    let list = sensitivities(model);
    for i in 0..3 {
        let slope = direct[i] - g * sine * dq[i];
        let expected = 0.5 * values[i] * slope / stiffness - if i == 2 { 0.5 } else { 0.0 };
        let found = list[i].1[0];
        assert!((found.to_f64() - expected).abs() < 1e-13, "{}: {found:?} {expected}", list[i].0);
        assert!(found.rad < 1e-16, "enclosed, not by differences: {found:?}");
    }
}

/// On a spring of -1 N/m the poles are 0.618 1/s and -1.618 1/s: one grows and one decays, so there is no damping ratio. With
/// k = 1 N/m and c = -3 N*s/m both grow, and it is -1.
#[test]
fn poles_on_both_sides_of_zero_have_no_damping_ratio() {
    let said = |k: &str, c: &str| {
        let text = format!(
            "body a {{ mass = 1 kg, moves x }}\nspring s: ground -- a {{ k = {k} N/m }}\n\
             damper d: ground -- a {{ c = {c} N*s/m }}\nrequire damping(1) < -2\n"
        );
        String::from_utf8(crate::program::ran(&text, &["analyze"]).stderr).expect("text")
    };
    assert!(said("-1", "1").contains("no common damping ratio"), "{}", said("-1", "1"));
    assert!(said("1", "-3").contains("it is -1,"), "{}", said("1", "-3"));
    assert!(said("1", "3").contains("it is 1,"), "{}", said("1", "3"));
}
