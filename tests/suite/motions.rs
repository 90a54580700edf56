//! Motions compared with closed forms that were evaluated to forty digits elsewhere: samples with individual bounds,
//! phases after 1e12 s, decays over fifty decades, peak and rms with their reported bounds. See docs/method/response.md
//! and docs/method/measures.md#peak-and-rms.

use vibc::analysis::{Signal, grid, respond};
use vibc::base::{Ball, Number, Rounded, SourceFile, SourceKind, Sources};
use vibc::model::Overrides;
use vibc::questions::answer::Value;

fn sources(text: &str) -> (Sources, vibc::base::FileId) {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::decode(SourceKind::Model, "motion.vib", text.as_bytes().to_vec()));
    (sources, file)
}

fn number(text: &str) -> Number {
    match text.strip_prefix('-') {
        Some(size) => -&Number::from(size),
        None => Number::from(text),
    }
}

fn motion(text: &str, times: &[Number]) -> (Vec<Vec<Ball>>, Vec<&'static str>) {
    let (sources, file) = sources(text);
    let outcome = vibc::simulate(&sources, file, &Overrides::default(), times);
    let codes = outcome.diagnostics.iter().map(|finding| finding.code.0).collect();
    (outcome.answer.map(|motion| motion.history.values).unwrap_or_default(), codes)
}

/// The values of the requirements' measures up to a time, in their order.
fn measures(text: &str, until: &str) -> Vec<Ball> {
    let (sources, file) = sources(text);
    let until = number(until);
    let study = vibc::Study { until: Some(&until), ..vibc::Study::default() };
    let request = vibc::analysis::Request::default();
    let outcome = vibc::analyze_with(&sources, file, &Overrides::default(), &request, &study);
    let of = |value: &Value| match value {
        Value::Number(ball) => *ball,
        other => panic!("{other:?}"),
    };
    outcome.answer.expect("a report").requirements.iter().map(|found| of(&found.value)).collect()
}

/// |value - truth| of the printed number and its printed bound; also checks that the enclosure contains the truth.
fn compare(what: &str, ball: Ball, truth: &str) -> (f64, f64) {
    let truth = number(truth);
    let off = (&Number::Ball(Ball::exact(ball.mid)) - &truth).to_ball().magnitude();
    // The truth is given to forty digits.
    assert!(off <= ball.rad + 1e-38 * truth.abs().to_f64(), "{what}: off by {off:e}, bound {:e}", ball.rad);
    let printed = Rounded::of(ball).expect("a number");
    let error = (&Number::Ball(Ball::from(printed.value())) - &truth).to_ball();
    assert!(error.mignitude() <= printed.bound().value(), "{what}: {error:?}, bound {:e}", printed.bound().value());
    (error.to_f64().abs(), printed.bound().value())
}

const HELD: &str = "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 100 N/m }\n\
                    damper d: ground -- a { c = 4 N*s/m }\noutput x = a.x\n";

/// exp(-2 t) sin(w t) / w, w = sqrt 96: over 52 decades each sample keeps the digits of binary64, by both methods.
#[test]
fn decaying_motions_keep_their_digits() {
    let truth = [
        ("0.25", "0.03950436744914303143747441295480280446474"),
        ("1.5", "0.00430583448110263402286479198775141596965"),
        ("12.25", "1.403993502296368482598167316161451657128e-12"),
        ("24.75", "-1.824125804186982552680153195037361729823e-23"),
        ("36.5", "-9.968197620698092679682930777192777750614e-34"),
        ("48", "-1.67020982502842728513880864766515903375e-43"),
        ("60", "-3.045419004003640185374797249028711695549e-54"),
    ];
    let alone = format!("{HELD}initial a {{ vx = 1 m/s }}\n");
    // A second body whose damper couples its modes, so that the modal method cannot be used for either.
    let beside = format!(
        "{alone}body b {{ mass = 1 kg, moves x }}\nbody c {{ mass = 2 kg, moves x }}\nspring t: ground -- b {{ k = 90 N/m }}\n\
         spring u: b -- c {{ k = 90 N/m }}\ndamper e: ground -- b {{ c = 5 N*s/m }}\ndamper f: ground -- c {{ c = 9 N*s/m }}\n"
    );
    for model in [alone, beside] {
        let times = grid(&number("60"), &number("0.25"));
        let (values, codes) = motion(&model, &times);
        assert!(codes.is_empty(), "{codes:?}");
        let mut sharpest: f64 = 0.0;
        for (t, truth) in truth {
            let sample = times.iter().position(|time| *time == number(t)).expect("a sample");
            let (error, bound) = compare(t, values[sample][0], truth);
            assert!(bound <= 1.2e-16 * number(truth).abs().to_f64(), "{t}: {bound:e}");
            sharpest = sharpest.max(error / bound);
        }
        assert!(sharpest > 0.5, "bounds of a tenth would do: {sharpest}");
        assert_eq!(Rounded::of(values[0][0]).expect("a number").value(), 0.0);
    }
}

/// 50 Hz, 30 degrees, on 1 kg, 2 N s/m, 400 N/m: the motion after long times, with a phase of 1/3 of a turn after more
/// than 3e14 rad.
#[test]
fn phases_after_a_million_million_seconds() {
    let model = "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 400 N/m }\n\
                 damper d: ground -- a { c = 2 N*s/m }\nforce F: a along x = harmonic(1 N, 50 Hz, 30 deg)\noutput x = a.x\n";
    let cases = [
        (1e-18, "3000000.001", "-7.603474257029164648519359781757085265383e-6"),
        (1e-15, "123456789.0123", "9.6623260279160773833898386557416788938e-6"),
        (1e-11, "1000000000000.001", "-7.603474257029164648519359781757085265383e-6"),
    ];
    for (most, t, truth) in cases {
        let (values, codes) = motion(model, &[Number::ZERO, number(t)]);
        let (_, bound) = compare(t, values[1][0], truth);
        // A single step over all that time loses digits, and reports it.
        assert_eq!(
            codes.contains(&"vib::motion::unsettled"),
            values[1][0].rad > 0.5f64.powi(50) * 7.6e-6,
            "{t}: {bound:e}"
        );
        assert!(bound < most, "{t}: {bound:e}");
    }
}

/// Force and motion of a base, read directly: no state is involved, so only the phase matters.
#[test]
fn a_base_has_its_phase_at_any_time() {
    let model = "base g { moves x } = harmonic(1 m, 50 Hz, 30 deg)\nbody a { mass = 1 kg, moves x }\n\
                 spring s: g -- a { k = 400 N/m }\ndamper d: g -- a { c = 2 N*s/m }\noutput x = g.x\n";
    // sin(2 pi (0.05 + 1/12)) = sin(48 deg)
    let truth = "0.7431448254773942350146970489742569771891";
    for t in ["0.001", "3000000.001", "1000000000000.001"] {
        let (values, codes) = motion(model, &[Number::ZERO, number(t)]);
        let (_, bound) = compare(t, values[1][0], truth);
        assert!(bound <= 1.2e-16 && codes.is_empty(), "{t}: {bound:e} {codes:?}");
    }
}

/// Peak and rms of a decay, an oscillation, a beat, a step and a ramp. The printed bound is at most a hundred errors,
/// except for errors below a hundredth of a unit in the last place; and the bounds as a whole could not be ten times
/// smaller.
#[test]
fn peak_and_rms_are_those_of_the_closed_forms() {
    let free = "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 49 N/m }\noutput x = a.x\n";
    let both = "require peak(x) < 0 m\nrequire rms(x) < 0 m\n";
    let rms = "require rms(x) < 0 m\n";
    let cases: [(String, &str, &[&str]); 5] = [
        (
            format!("{HELD}initial a {{ vx = 1 m/s }}\n{both}"),
            "10",
            &["0.07561349268383102703430530879449589567122", "0.0111803398874989484532007864508629564446"],
        ),
        (
            format!("{free}initial a {{ x = 0.3 m, vx = 0.5 m/s }}\n{both}"),
            "1000",
            &["0.3083861877846128999880067506583778827972", "0.2180698434332490391482356050277066322542"],
        ),
        (
            format!("{free}force F: a along x = harmonic(2 N, 6 rad/s)\n{both}"),
            "20",
            &["0.2836311068851582836573576141407200512411", "0.1400770931264241659271161738900285603893"],
        ),
        (
            format!("{HELD}force F: a along x = step(10 N, 0.25 s)\n{both}"),
            "5",
            // The rms of the first 4.75 s after the step, over 5 s.
            &["0.1526620599330302998130485739734638300782", "0.09813243354297558532786350495332919545689"],
        ),
        (
            format!("{HELD}force F: a along x = ramp(10 N, 0 s, 2 s)\n{rms}"),
            "5",
            &["0.08527858166603846272435429731154752500299"],
        ),
    ];
    let mut sharpest: f64 = 0.0;
    for (model, until, truths) in cases {
        for (ball, truth) in measures(&model, until).into_iter().zip(truths) {
            let (error, bound) = compare(truth, ball, truth);
            let last_place = f64::EPSILON * number(truth).to_f64();
            assert!(bound <= 100.0 * error.max(0.01 * last_place), "{truth}: bound {bound:e}, error {error:e}");
            assert!(ball.rad <= 1e-19 * ball.to_f64(), "{truth}: {ball:?}");
            sharpest = sharpest.max(error / bound);
        }
    }
    assert!(sharpest > 0.5, "bounds of a tenth would do: {sharpest}");
}

/// sin(2 pi (u + 8 u^2 / 3)) up to 1.5 s, by Duhamel's integral.
#[test]
fn a_chirp_moves_as_duhamel_says() {
    let model = format!("{HELD}force F: a along x = chirp(1 N, 1 Hz, 9 Hz, 1.5 s)\n");
    let truth = [
        ("0.7", "-0.001678593010773203013928262761161136622507"),
        ("1.5", "0.001077729645848850302408471777110118647018"),
        ("3", "6.445653486229363430522226489300580474413e-5"),
    ];
    for step in ["0.1", "0.0125"] {
        let times = grid(&number("3"), &number(step));
        let (values, _) = motion(&model, &times);
        for (t, truth) in truth {
            let sample = times.iter().position(|time| *time == number(t)).expect("a sample");
            let (_, bound) = compare(t, values[sample][0], truth);
            assert!(bound < 2e-16 * 0.0017, "{t}: {bound:e}");
        }
    }
    let base = "base g { moves x } = chirp(2 m, 1 Hz, 9 Hz, 1.5 s)\nbody a { mass = 1 kg, moves x }\n\
                spring s: g -- a { k = 400 N/m }\noutput x = g.x\nrequire rms(x) < 0 m\n";
    let (_, bound) = compare("rms", measures(base, "1.5")[0], "1.405984351655656536095573409841116988632");
    assert!(bound < 2.5e-16, "{bound:e}");
}

/// A scene without outputs ends; a scene that nothing moves is reported, and so is an output that nothing reaches.
#[test]
fn nothing_moves_in_silence() {
    let still = "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 4 N/m }\n";
    let times = grid(&number("1"), &number("0.05"));
    assert_eq!(motion(still, &times).1, Vec::<&str>::new());
    let (values, codes) = motion(&format!("{still}output x = a.x\n"), &times);
    assert!(values.iter().all(|row| row[0].is_zero()));
    assert_eq!(codes, ["vib::motion::still"]);
    let zero = format!("{still}force F: a along x = step(0 N, 0 s)\noutput x = a.x\n");
    assert_eq!(motion(&zero, &times).1, ["vib::motion::still"]);
    let beside =
        "body b { mass = 1 kg, moves x }\nspring t: ground -- b { k = 4 N/m }\noutput x = b.x\noutput y = a.x\n";
    let (values, codes) = motion(&format!("{still}{beside}force F: a along x = step(1 N, 0 s)\n"), &times);
    assert!(values.iter().all(|row| row[0].is_zero()) && !values[20][1].is_zero());
    assert_eq!(codes, ["vib::motion::still"]);
}

/// Seventy links that hang one under another: the mass matrix couples all of them, and is far from singular.
#[test]
fn seventy_hanging_links_move() {
    let model = "gravity 9.81 m/s^2\nbody r[1] { mass = 1 kg, shape = rod((0,0),(0,-1 m)) }\npivot p[1]: ground@(0,0) -- r[1]\n\
                 repeat i in 2..70 {\n body r[i] { mass = 1 kg, shape = rod((0,-(i-1)*1 m),(0,-i*1 m)) }\n \
                 pivot p[i]: r[i-1]@(0,-(i-1)*1 m) -- r[i]\n}\nforce F: r[1] along x = step(1 N, 0 s)\noutput x = r[1].x\n";
    let (values, codes) = motion(model, &[Number::ZERO, number("0.5"), Number::ONE]);
    assert!(codes.is_empty(), "{codes:?}");
    let [_, half, whole] = &values[..] else { panic!("{codes:?}") };
    assert!(half[0].relative_error() < 1e-16 && whole[0].relative_error() < 1e-16, "{half:?} {whole:?}");
}

/// 500 steps of a force and of a base, which once were a state each, compared with the sum of 500 closed forms; and the
/// time after a chirp of short pieces: a lasting force is as accurate in a long step as without the chirp.
#[test]
fn sums_of_signals_cost_no_digits() {
    let jump = |i: i64| ((i * 7919) % 41 - 20, 31 * i);
    let text = "base g { moves x }\nbody a { mass = 1 kg, moves x }\nspring s: g -- a { k = 100 N/m }\n\
                damper d: ground -- a { c = 2 N*s/m }\nforce F: a along x\noutput x = a.x\n";
    let (sources, file) = sources(text);
    let system = vibc::linear(&sources, file, &Overrides::default()).answer.expect("a system").1;
    let thousandth = number("0.001");
    let step = |size: Number, at: i64| Signal::Step { value: size, at: &thousandth * &Number::from(at) };
    let drives: Vec<Vec<Signal>> = (system.inputs.iter())
        .map(|input| {
            let unit = if system.display(input.name) == "g" { thousandth.clone() } else { Number::ONE };
            (0..500).map(jump).map(|(size, at)| step(&unit * &Number::from(size), at)).collect()
        })
        .collect();
    let times = grid(&number("16"), &number("0.8"));
    let values = respond(&system, &drives, &times).expect("a motion").values;
    // 100 N/m times a millimetre is a tenth of a newton.
    let step = |t: f64| {
        let w = 99f64.sqrt();
        1.1 * (1.0 - (-t).exp() * ((w * t).cos() + (w * t).sin() / w)) / 100.0
    };
    for (row, time) in values.iter().zip(&times) {
        let t = time.to_f64();
        let before = (0..500).map(jump).filter(|(_, at)| *at as f64 / 1000.0 <= t);
        let wanted: f64 = before.map(|(size, at)| size as f64 * step(t - at as f64 / 1000.0)).sum();
        assert!((row[0].to_f64() - wanted).abs() < 1e-12, "{t}: {:?} {wanted}", row[0]);
        assert!(row[0].rad < 1e-22, "{t}: {:e}", row[0].rad);
    }
    let text = format!("{HELD}force F: a along x = chirp(1 N, 60 Hz, 80 Hz, 1 s) + ramp(3 N, 0.5 s, 0.9 s)\n");
    let (values, codes) = motion(&text, &grid(&number("40"), &number("4")));
    assert!(codes.is_empty(), "{codes:?}");
    for row in &values {
        assert!(row[0].rad < 1e-19, "{:?}", row[0]);
    }
}
