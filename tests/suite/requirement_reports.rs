//! What a requirement says that does not hold, is met exactly, or has no value: the words, the table, and the value of a parameter
//! that makes it hold.

use crate::measures::sources;
use crate::program::ran;
use vibc::model::Overrides;

/// A mass on a base whose signal is an acceleration.
const ON_BASE: &str = "body a { mass = 1 kg, moves x }\nbase g { moves x } = harmonic(1 m/s^2, 5 Hz)\nspring s: g -- a { k = 100 N/m }\n\
                       damper d: g -- a { c = 1 N*s/m }\nforce F: a along x = harmonic(1 N, 2 Hz)\noutput acc = a.ax\noutput vel = a.vx\n\
                       output x = a.x\n";

fn failure(model: &str) -> vibc::base::Diagnostic {
    let (sources, file) = sources(model);
    let found = vibc::check(&sources, file, &Overrides::default(), None).diagnostics;
    let [finding] = &found[..] else { panic!("{model}: {found:?}") };
    finding.clone()
}

/// The message and the help for a requirement of the mass on the base.
fn said(line: &str) -> (String, String) {
    let finding = failure(&format!("{ON_BASE}{line}\n"));
    (finding.message.clone(), finding.help.clone().unwrap_or_default())
}

/// A gain in 1/s^2 is no angular acceleration, and one in 1/s no frequency.
#[test]
fn a_gain_is_named_by_its_input_and_output() {
    let base = "the input of a base is its displacement";
    for (line, wanted, example, remark) in [
        ("require gain(g -> acc, 5 Hz) < 3", "a gain from m to m/s^2", "`3 /s^2`", base),
        ("require peak_gain(g -> vel) < 3", "a gain from m to m/s", "`3 /s`", base),
        ("require gain(F -> vel, 5 Hz) < 3", "a gain from N to m/s", "`3 s/kg`", ""),
        ("require gain(F -> x, 5 Hz) < 3", "a gain from N to m", "`3 m/N`", ""),
        ("require amplitude(acc) / amplitude(x) < 3", "a quantity in 1/s^2", "`3 /s^2`", ""),
        ("require amplitude(acc) * amplitude(x) < 3", "a quantity in m^2/s^2", "`3 m^2/s^2`", ""),
        ("require amplitude(acc) < 3", "an acceleration", "`3 m/s^2`", ""),
    ] {
        let (message, help) = said(line);
        assert_eq!(message, format!("{wanted} is expected here, this number has no unit"), "{line}");
        assert!(help.contains(example) && help.ends_with(remark), "{line}: {help}");
        // What the help says can be typed.
        let typed = format!("{ON_BASE}{} {}\n", line.trim_end_matches('3'), example.trim_matches('`'));
        let codes = json_codes(&typed);
        assert!(codes.iter().all(|code| code == "vib::require::fails"), "{line}: {codes:?}");
    }
    let (message, help) = said("require gain(g -> acc, 5 Hz) < 3 m");
    assert_eq!(message, "a gain from m to m/s^2 is expected here, this is a length");
    assert_eq!(help, format!("write a gain from m to m/s^2, such as `3 /s^2`; {base}"));
    // An angle in a linear combination of motions is one.
    let rod = "body rod { mass = 1 kg, shape = rod((0, 0), (1 m, 0)) }\npivot p: ground@(0, 0) -- rod\nspring s: ground -- rod { k = 9 N*m/rad }\n\
               torque T: rod = harmonic(1 N*m, 1 Hz)\n";
    for (motion, noun) in [("alpha", "an angular acceleration"), ("omega", "an angular velocity")] {
        let finding = failure(&format!("{rod}require amplitude(rod.{motion}) < 3 m\n"));
        assert_eq!(finding.message, format!("{noun} is expected here, this is a length"));
    }
}

fn json_codes(model: &str) -> Vec<String> {
    let (sources, file) = sources(model);
    let found = vibc::check(&sources, file, &Overrides::default(), None).diagnostics;
    found.iter().map(|finding| finding.code.0.to_string()).collect()
}

/// A limit that is met exactly is decided in fractions, and said as such.
#[test]
fn a_rest_at_its_limit_is_decided() {
    let model = "body a { mass = 1 kg, moves x }\nbase g { moves x } = constant(1 mm) + step(1 mm, 0 s)\n\
                 spring s: g -- a { k = 100 N/m }\ndamper d: g -- a { c = 1 N*s/m }\noutput x = a.x\n";
    for (line, holds) in [
        ("rest(a.x) <= 1 mm", true),
        ("rest(a.x) >= 1 mm", true),
        ("rest(a.x) < 1 mm", false),
        ("rest(a.x) > 1 mm", false),
        // From the rest on, by the step alone.
        ("static(x) <= 1 mm", true),
        ("static(x) < 1 mm", false),
    ] {
        let text = format!("{model}require {line}\n");
        let (sources, file) = sources(&text);
        let outcome = vibc::check(&sources, file, &Overrides::default(), None);
        let requirement = &outcome.answer.expect("an answer")[0];
        assert_eq!(requirement.holds, Some(holds), "{line}: {requirement:?}");
        assert!(requirement.margin.is_some_and(|margin| margin.is_zero()), "{line}: {requirement:?}");
        if !holds {
            let words = &outcome.diagnostics.first().expect("a finding").primary.text;
            assert!(words.ends_with("mm, exactly its limit"), "{words}");
        }
    }
}

/// A shallow truss of two springs snaps through under 0.3908 kg: with y the height of its top, f(y) = 2 k (l0 / sqrt(b^2 + y^2) - 1) y is
/// largest where (b^2 + y^2)^(3/2) = l0 b^2.
#[test]
fn the_value_that_is_advised_lies_near_the_border() {
    let text = "param m = 10 kg\ngravity 9.81 m/s^2\nbody a { mass = m, at = (0, 0.1 m), moves y }\n\
                spring l: ground@(-1 m, 0) -- a@(0, 0.1 m) { k = 10 kN/m }\nspring r: ground@(1 m, 0) -- a@(0, 0.1 m) { k = 10 kN/m }\n\
                require rest(a.y) > -5 cm\n";
    let free = 1.01f64.sqrt();
    let y = (free.powf(2.0 / 3.0) - 1.0).sqrt();
    let most = 2.0 * 1e4 * (free / (1.0 + y * y).sqrt() - 1.0) * y / 9.81;
    let help = failure(text).help.expect("advice");
    let advised: f64 =
        help.split("m = ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a value").parse().unwrap();
    assert!(advised < most && advised > 0.99 * most, "{help}: {most}");
}

/// A number of parts has no fractions: n masses between walls at one end have omega = 2 sqrt(k/m) sin(pi / (4 n + 2)).
#[test]
fn a_number_of_parts_is_advised() {
    let model = "param n = 5\nbody m[1] { mass = 1 kg, moves x }\nspring s[1]: ground -- m[1] { k = 100 N/m }\nrepeat i in 2..n {\n  \
                 body m[i] { mass = 1 kg, moves x }\n  spring s[i]: m[i-1] -- m[i] { k = 100 N/m }\n}\nrequire frequency(1) > 0.8 Hz\n";
    let hertz = |n: f64| 20.0 * (std::f64::consts::PI / (4.0 * n + 2.0)).sin() / std::f64::consts::TAU;
    assert!(hertz(2.0) > 0.8 && hertz(3.0) < 0.8);
    assert_eq!(failure(model).help.as_deref(), Some("with n = 2 it holds"));
}

/// Without parameters there is nothing to advise; a value of many times its limit is said so.
#[test]
fn nothing_is_advised_without_parameters() {
    let model =
        "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 100 N/m }\nrequire frequency(1) < 1 mHz\n";
    let finding = failure(model);
    assert_eq!(finding.help, None);
    assert_eq!(finding.primary.text.as_str(), "it is 1591.55 mHz, 1590 times its limit");
    let with = format!("param e = 3\noutput x = e * a.x\n{model}");
    assert_eq!(failure(&with).help.as_deref(), Some("no parameter was found that makes it hold"));
}

/// The reason why a measure has no value is a sentence below the table: the table keeps its columns on 80.
#[test]
fn reasons_stand_below_the_table() {
    let model = "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 100 N/m }\ndamper d: ground -- a { c = -1 N*s/m }\n\
                 force F: a along x = harmonic(1 N, 1 Hz)\noutput x = a.x\nrequire amplitude(x) < 1 m\nrequire frequency(1) < 2 Hz\n";
    let out = String::from_utf8(ran(model, &["check"]).stdout).unwrap();
    let lines: Vec<&str> = out.lines().collect();
    let heading = lines.iter().position(|line| line.contains("requirement ")).expect("a table");
    assert!(lines[heading].contains("margin") && lines[heading].ends_with("error ≤"), "{out}");
    let cells = |line: usize| lines[line].split_whitespace().collect::<Vec<_>>();
    assert_eq!(cells(heading + 2)[3..], ["m", "?", "?", "1", "m"], "{out}");
    assert!(out.contains("amplitude(x) < 1 m has no value: a free motion grows: nothing settles"), "{out}");
}

/// Forms that are nearly right say what is wrong with them.
#[test]
fn forms_of_requirements_say_what_to_type() {
    for (line, message, help) in [
        (
            "require frequency(1) < 2 Hz < 3 Hz",
            "a measure is expected on one side of each comparison",
            "write the measure between its limits, as in `1 Hz < frequency(1) < 5 Hz`",
        ),
        ("require max(frequency(1), 2 Hz) < 3 Hz", "`max` takes no measures", "write a line for each measure"),
        ("require load_facter > 1", "a measure is expected here", "did you mean `load_factor`?"),
        ("require gain > 1", "a measure is expected here", "write `gain(input -> output, 30 Hz)`"),
        ("require 3 > 1", "a measure is expected here", "`frequency(1)`"),
    ] {
        let (found, advised) = said(line);
        assert_eq!(found, message, "{line}");
        assert!(advised.contains(help), "{line}: {advised}");
    }
}

/// Harmonics of 1 Hz and 2 Hz: the amplitude is the sum of both, which the report says; of one frequency it is the amplitude.
#[test]
fn a_sum_of_amplitudes_is_said_to_be_one() {
    let scene = |signal: &str| {
        format!(
            "body a {{ mass = 1 kg, moves x }}\nspring s: ground -- a {{ k = 100 N/m }}\ndamper d: ground -- a {{ c = 1 N*s/m }}\n\
             force F: a along x = {signal}\noutput x = a.x\nrequire amplitude(x) < 1 m\n"
        )
    };
    let out = |signal: &str| String::from_utf8(ran(&scene(signal), &["check"]).stdout).unwrap();
    let both = out("harmonic(1 N, 1 Hz) + harmonic(1 N, 2 Hz)");
    assert!(both.contains("amplitudes at 1, 2 Hz are added: the motion never exceeds their sum"), "{both}");
    let w = std::f64::consts::TAU;
    let gain = |w: f64| 1.0 / ((100.0 - w * w).powi(2) + w * w).sqrt();
    let value = format!("{:.7}", gain(w) + gain(2.0 * w));
    assert!(both.contains(&value), "{value}: {both}");
    assert!(!out("harmonic(1 N, 1 Hz) + harmonic(1 N, 1 Hz)").contains("are added"));
}

/// Poles of critical damping are neither oscillations nor overdamped.
#[test]
fn critical_damping_is_a_kind() {
    let model = "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 100 N/m }\ndamper d: ground -- a { c = 20 N*s/m }\n";
    let out = String::from_utf8(ran(model, &["analyze"]).stdout).unwrap();
    let kinds = out.lines().filter(|line| line.ends_with(" critical")).count();
    assert_eq!((kinds, out.contains("overdamped")), (2, false), "{out}");
}

/// A number that begins with a minus is read as the value of its option, and refused for what it is.
#[test]
fn negative_values_of_options_are_values() {
    for arguments in [
        &["simulate", "--until", "1s", "--step", "-1ms"][..],
        &["simulate", "--until", "-1s", "--step", "1ms"],
        &["transfer", "--at", "-1Hz"],
        &["analyze", "--modes", "-2"],
    ] {
        let output = ran(ON_BASE, arguments);
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(!text.contains("tip:") && !text.contains("unexpected argument"), "{arguments:?}: {text}");
    }
}

/// What is wrong stays so, whatever is not decided beside it: 1; what is not decided alone: 4.
#[test]
fn a_failure_counts_more_than_what_is_not_decided() {
    let model =
        "param k = 10 N/m\nparam m = 1 kg\nbody block { mass = m, moves x }\nspring s: ground -- block { k = k }\n";
    let open = "require frequency(1) <= sqrt(k/m) * 1 rad\n";
    for (others, status) in [
        ("", 4),
        ("require frequency(1) > 0.1 Hz\n", 4),
        ("require frequency(2) > 2 Hz\n", 1),
        ("require frequency(1) > 9 Hz\n", 1),
    ] {
        for text in [format!("{model}{open}{others}"), format!("{model}{others}{open}")] {
            assert_eq!(ran(&text, &["check"]).status.code(), Some(status), "{others}");
        }
    }
}

/// A measure at a negative frequency: a density has none, and of a gain it is no frequency that anybody means.
#[test]
fn a_measure_takes_no_negative_frequency() {
    for measure in ["gain(F -> x, -2 Hz)", "phase(F -> x, -2 rad/s)", "psd(x, -2 Hz)", "gain(g.ax -> x, 1 Hz - 2 Hz)"] {
        let found = crate::program::finding(&format!("{ON_BASE}require {measure} < 1\n"), &["check"]);
        assert_eq!(
            (found["code"].as_str(), found["message"].as_str()),
            (Some("vib::measure::arguments"), Some("this frequency is negative"))
        );
    }
}

/// A time beyond which no motion is computed is named, not a mass that is there.
#[test]
fn a_time_that_is_too_long_is_named() {
    let model = "body b { mass = 1 kg, moves x }\ndamper d: ground -- b { c = 1 N*s/m }\nforce F: b along x = step(1 N, 0 s)\noutput v = b.vx\n";
    let found = crate::program::finding(model, &["simulate", "--until", "1e300s", "--step", "1e300s"]);
    assert_eq!(found["code"], "vib::limit::range");
    assert!(found["help"].as_str().is_some_and(|help| help.contains("shorter time")), "{found}");
}
