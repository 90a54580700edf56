//! Inerters compared with closed forms: the force is b times the relative acceleration of the ends, with b in kg or,
//! for rotation, kg*m^2 (Smith, IEEE Trans. Automat. Control 47 (2002) 1648).

use crate::ask::{ask, refusal, try_ask};
use crate::emit::{emission, options, write};
use crate::emit_state::numbers;
use crate::measures::sources;
use vibc::Study;
use vibc::analysis::discrete::Options;
use vibc::backend::emit::{self, Language};
use vibc::base::Ball;
use vibc::lower::account;
use vibc::model::Overrides;
use vibc::questions::answer::{Derivative, Slope, Value};

fn near(found: f64, truth: f64) {
    assert!((found - truth).abs() <= 8e-15 * truth.abs(), "{found:e} is not {truth:e}");
}

fn omegas(text: &str, truths: &[f64]) {
    let found = ask(text).omegas();
    assert_eq!(found.len(), truths.len(), "{found:?} for\n{text}");
    for (found, truth) in found.iter().zip(truths) {
        near(*found, *truth);
    }
}

/// omega^2 = k / (m + b); without a mass k / b.
#[test]
fn an_inerter_to_the_ground_adds_its_inertance() {
    let block = |mass: &str| {
        format!(
            "body block {{ mass = {mass}, moves x }}\nspring s: ground -- block {{ k = 100 N/m }}\n\
             inerter j: ground -- block {{ b = 20 kg }}\n"
        )
    };
    omegas(&block("5 kg"), &[2.0]);
    omegas(&block("0 kg"), &[5f64.sqrt()]);
}

/// Two bodies: omega^2 = k s / (1 + b s) with s = 1/m1 + 1/m2, and the rigid motion is that of the masses alone.
#[test]
fn an_inerter_between_bodies_resists_their_relative_motion() {
    let s: f64 = 1.0 / 2.0 + 1.0 / 3.0;
    let truth = (60.0 * s / (1.0 + 6.0 * s)).sqrt();
    omegas(
        "body a { mass = 2 kg, moves x }\nbody b { mass = 3 kg, moves x }\nspring s: a -- b { k = 60 N/m }\n\
         inerter j: a -- b { b = 6 kg }\n",
        &[0.0, truth],
    );
    omegas(
        "body a { inertia = 2 kg*m^2, turns }\nbody b { inertia = 3 kg*m^2, turns }\n\
         spring s: a -- b { k = 60 N*m/rad }\ninerter j: a -- b { b = 6 kg*m^2 }\n",
        &[0.0, truth],
    );
}

/// In the direction (3, 4)/5 the ends of an inerter move by 3/5 of a motion along x: 9/25 of its inertance.
#[test]
fn an_inerter_in_a_direction_counts_with_the_square_of_its_cosine() {
    for inerter in ["ground -- a { b = 25 kg, along = (3, 4) }", "ground@(-3 m, 4 m) -- a { b = 25 kg }"] {
        omegas(
            &format!(
                "body a {{ mass = 1 kg, at = (0, 0), moves x }}\nspring s: ground -- a {{ k = 40 N/m, along = x }}\n\
                 inerter j: {inerter}\n"
            ),
            &[2.0],
        );
    }
}

/// A rod drawn level that hangs at rest: m g L/2 over m L^2/3 + b (de/dtheta)^2 with the gradient there. From a point
/// beside the hanging tip the inerter follows all of its motion, from a point below none of it; as drawn it would be
/// the other way round.
#[test]
fn at_a_displaced_rest_the_gradient_there_counts() {
    let rod = |from: &str| {
        format!(
            "gravity 10 m/s^2\nbody rod {{ mass = 3 kg, shape = rod((0, 0), (2 m, 0)) }}\npivot p: ground@(0, 0) -- rod\n\
             inerter j: ground@{from} -- rod@(2 m, 0) {{ b = 5 kg }}\n"
        )
    };
    let bare: f64 = 3.0 * 10.0 * 1.0;
    near(ask(&rod("(5 m, -2 m)")).omegas()[0], (bare / (4.0 + 5.0 * 4.0)).sqrt());
    near(ask(&rod("(0, -7 m)")).omegas()[0], (bare / 4.0).sqrt());
    let answer = ask(&rod("(5 m, -2 m)"));
    assert!((answer.lowered.rest.displacement[0].to_f64() + std::f64::consts::FRAC_PI_2).abs() < 1e-15);
}

/// N equal masses in a row, with k and b in parallel between neighbours and walls: with mu = 4 sin^2(j pi / (2 (N +
/// 1))) the squares are k mu / (m + b mu). Small rows are correct to the last digit, large ones use other methods.
#[test]
fn rows_of_inerters_have_their_frequencies() {
    for n in [3, 40, 90, 400] {
        let text = format!(
            "body m[0] {{ mass = 2 kg, moves x }}\nspring s[0]: ground -- m[0] {{ k = 700 N/m }}\n\
             inerter j[0]: ground -- m[0] {{ b = 3 kg }}\nspring e: m[{last}] -- ground {{ k = 700 N/m }}\n\
             inerter f: m[{last}] -- ground {{ b = 3 kg }}\nrepeat i in 1..{last} {{\n  body m[i] {{ mass = 2 kg, moves x }}\n\
             spring s[i]: m[i-1] -- m[i] {{ k = 700 N/m }}\n  inerter j[i]: m[i-1] -- m[i] {{ b = 3 kg }}\n}}\n",
            last = n - 1
        );
        let answer = ask(&text);
        assert_eq!(answer.modes.list.len(), n);
        for (j, mode) in answer.modes.list.iter().enumerate() {
            let half = (j + 1) as f64 * std::f64::consts::PI / (2 * (n + 1)) as f64;
            let mu = 4.0 * half.sin() * half.sin();
            let truth = (700.0 * mu / (2.0 + 3.0 * mu)).sqrt();
            let off = (mode.omega.to_f64() - truth).abs();
            assert!(off <= mode.omega.rad + 4e-14 * truth, "{n}, mode {}: {:?} is not {truth}", j + 1, mode.omega);
        }
    }
}

fn measured(text: &str, until: Option<&str>) -> Vec<Ball> {
    let (sources, file) = sources(text);
    let until = until.map(vibc::base::Number::from);
    let study = Study { until: until.as_ref(), ..Study::default() };
    let request = vibc::analysis::Request::default();
    let outcome = vibc::analyze_with(&sources, file, &Overrides::default(), &request, &study);
    let messages: Vec<&str> =
        outcome.diagnostics.iter().map(|d| d.code.0).filter(|code| *code != "vib::require::fails").collect();
    assert!(messages.is_empty(), "{messages:?}");
    let number = |value: &Value| match value {
        Value::Number(ball) => *ball,
        other => panic!("{other:?}"),
    };
    outcome.answer.expect("a report").requirements.iter().map(|requirement| number(&requirement.value)).collect()
}

fn holds(found: Ball, truth: f64) {
    assert!((found.to_f64() - truth).abs() <= found.rad + 1e-13 * truth.abs(), "{found:?} is not {truth}");
    assert!(found.rad <= 1e-10 * truth.abs(), "{found:?}");
}

/// A table on a spring and an inerter: y/u = (k - b w^2) / (k - (m + b) w^2), and the inerter's force is -b w^2 (y - u).
#[test]
fn a_moving_base_drives_through_an_inerter() {
    let (k, b, m, w) = (1000.0, 5.0, 15.0, 3.0 * std::f64::consts::TAU);
    let found = measured(
        "base floor { moves y }\nbody table { mass = 15 kg, moves y }\nspring s: floor -- table { k = 1000 N/m }\n\
         inerter j: floor -- table { b = 5 kg }\noutput y = table.y\noutput f = j.force\n\
         require gain(floor -> y, 3 Hz) < 1\nrequire gain(floor -> f, 3 Hz) < 1 N/m\nrequire gain(floor -> y, 1e6 Hz) < 1\n",
        None,
    );
    let y = (k - b * w * w) / (k - (m + b) * w * w);
    holds(found[0], y.abs());
    holds(found[1], (b * w * w * (y - 1.0)).abs());
    assert!((found[2].to_f64() - b / (m + b)).abs() < 1e-9, "far above it follows by b / (m + b)");
}

/// A step on m + b = 20 kg and 80 N/m: x = F/k (1 - cos 2t), so the peak is 2 F/k, and the inerter's force b x'' starts
/// at its largest value, b F / (m + b).
#[test]
fn the_motion_has_the_inertance_in_it() {
    let found = measured(
        "body block { mass = 15 kg, moves x }\nspring s: ground -- block { k = 80 N/m }\n\
         inerter j: ground -- block { b = 5 kg }\nforce F: block along x = step(8 N, 0 s)\n\
         output x = block.x\noutput f = j.force\nrequire peak(x) < 1 m\nrequire peak(f) < 1 N\n",
        Some("2"),
    );
    holds(found[0], 0.2);
    holds(found[1], 2.0);
}

/// Emitted C steps through the same motion, x = F/k (1 - cos 2t), and through the inerter's force b F / (m + b) cos 2t.
#[test]
fn emitted_code_has_the_inertance_in_it() {
    let emission = emission(
        "inert",
        "body block { mass = 15 kg, moves x }\nspring s: ground -- block { k = 80 N/m }\n\
         inerter j: ground -- block { b = 5 kg }\nforce F: block along x = step(8 N, 0 s)\n\
         output x = block.x\noutput f = j.force\n",
        &Options { built_in: true, ..options("0.01") },
    );
    let folder = tempfile::tempdir().expect("a folder");
    write(&folder, &emit::files("inert", &emission.system, Language::C, None));
    let main = "#include <stdio.h>\n#include \"inert.h\"\n\
                int main(void) { inert_state s; inert_outputs y; int k; inert_init(&s);\n\
                for (k = 0; k < 300; k++) { inert_step(&s, &y); printf(\"%.17g %.17g\\n\", y.x, y.f); } return 0; }\n";
    let found = numbers(&folder, main, &["inert.c".to_string()]);
    assert_eq!(found.len(), 600);
    for (k, row) in found.chunks(2).enumerate() {
        let cosine = (0.02 * k as f64).cos();
        let truth = [0.1 * (1.0 - cosine), 2.0 * cosine];
        for (found, truth) in row.iter().zip(truth) {
            assert!((found - truth).abs() < 1e-13, "{k}: {found:e} is not {truth:e}");
        }
    }
}

/// f = sqrt(k / (m + b)) / 2 pi: df/db = -f / (2 (m + b)); and the b for a frequency is k / omega^2 - m.
#[test]
fn frequencies_have_slopes_by_the_inertance_and_are_solved_for_it() {
    let model = "param b = 20 kg\nbody block { mass = 5 kg, moves x }\nspring s: ground -- block { k = 100 N/m }\n\
                 inerter j: ground -- block { b = b }\n";
    let (read, file) = sources(model);
    let study = Study { sensitivity: true, ..Study::default() };
    let request = vibc::analysis::Request::default();
    let answer = vibc::analyze_with(&read, file, &Overrides::default(), &request, &study).answer.expect("a report");
    let truth = -(2.0 / std::f64::consts::TAU) / 50.0;
    match &answer.sensitivities[0].frequencies[0] {
        Some(Slope::Smooth { absolute: Derivative::Enclosed(ball), .. }) => holds(*ball, truth),
        other => panic!("{other:?}"),
    }
    let (read, file) = sources(&format!("{model}solve b in 1 kg .. 200 kg: frequency(1) = 1 rad/s\n"));
    let solved = vibc::analyze(&read, file, &Overrides::default()).answer.expect("a report").solved;
    near(solved[0].value.to_f64(), 95.0);
}

/// Inerters are kept or left out like springs and dampers, and the report says so.
#[test]
fn the_explanation_names_inerters() {
    let answer = ask(
        "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 1 N/m }\ninerter j: ground -- a { b = 1 kg }\n\
         inerter z: ground -- a { b = 0 kg }\n",
    );
    let account = account(&answer.scene, &answer.lowered);
    assert!(account.kept.iter().any(|remark| remark.what == "1 spring and 1 inerter"), "{account:?}");
    assert!(
        account.left_out.iter().any(|remark| remark.what == "z" && remark.why == "its value is zero"),
        "{account:?}"
    );
    let idle = ask("body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 1 N/m }\n\
         inerter j: ground@(0, 1 m) -- a@(0, 0) { b = 1 kg, along = y }\n");
    assert!(idle.remarks[0].message.starts_with("the inerter `j` has no effect"), "{:?}", idle.remarks);
}

#[test]
fn inerters_have_their_own_messages() {
    let with = |inerter: &str| format!("body a {{ mass = 1 kg, moves x }}\ninerter j: ground -- a {{ {inerter} }}\n");
    assert_eq!(refusal(&with("b = -1 kg")), ["vib::value::negative"]);
    assert_eq!(refusal(&with("")), ["vib::field::missing"]);
    assert_eq!(refusal(&with("b = 1 kg, preload = 2 N")), ["vib::field::unknown"]);
    assert_eq!(refusal(&with("b = 1 kg*m^2")), ["vib::element::no_end_turns"]);
    let Err(errors) = try_ask(&with("b = 1 N/m")) else { panic!("accepted") };
    assert!(errors[0].message.contains("an inertance"), "{}", errors[0].message);
}
