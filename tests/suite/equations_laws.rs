//! Equations with the laws of springs and dampers written out, compared with closed forms.

use super::equations::{example, says, text_of};
use super::equations_faults::{assert_reported, changed, doubled, scene_of};
use vibc::base::Number;
use vibc::symbols::{Powers, Sum};

fn assert_says(text: &str, lines: &[&str]) {
    for line in lines {
        assert!(says(text, line), "{line} is not in\n{text}");
    }
}

const DUFFING: &str = "param m = 2 kg\nparam c = 3 N*s/m\nparam k1 = 50 N/m\nparam k3 = 400 N/m^3\n\
     body b { mass = m, moves y }\nspring s: ground -- b { law = k1 * stretch + k3 * stretch^3 }\n\
     damper d: ground -- b { c = c }\nforce F: b along y\noutput pull = s.force\n";

/// G. Duffing, *Erzwungene Schwingungen bei veränderlicher Eigenfrequenz* (1918): m y'' + c y' + k1 y + k3 y^3 = F. Unloaded, the
/// tangent is k1 alone.
#[test]
fn an_unloaded_duffing_oscillator_has_its_equation() {
    assert_says(
        &text_of("duffing", DUFFING),
        &[
            "V = 1/2 k1 y^2 + 1/4 k3 y^4",
            "D = 1/2 c y'^2",
            "m y'' + c y' + k1 y + k3 y^3 = F",
            "m y'' + c y' + k1 y = F",
            "pull/F = k1/(m s^2 + c s + k1)",
        ],
    );
}

/// Under its weight it rests at y_0 with k1 y_0 + k3 y_0^3 = -m g, where the tangent is k1 + 3 k3 y_0^2.
#[test]
fn a_loaded_duffing_oscillator_is_linearised_where_it_rests() {
    let text = text_of("duffing", &format!("gravity 9.81 m/s^2\n{DUFFING}"));
    assert_says(
        &text,
        &[
            "V = m g y + 1/2 k1 (y_0 + y)^2 + 1/4 k3 (y_0 + y)^4",
            "m y'' + c y' + m g + k1 (y_0 + y) + k3 (y_0 + y)^3 = F",
            "m g + k1 y_0 + k3 y_0^3 = 0",
            "m y'' + c y' + (k1 + 3 k3 y_0^2) y = F",
        ],
    );
}

/// Quadratic damping: the force is c2 |y'| y', no part of which is left at rest; the function that it is the derivative of is
/// c2 |y'|^3/3.
#[test]
fn a_square_law_of_a_damper_keeps_its_sign() {
    let model = "param m = 2 kg\nparam k = 50 N/m\nparam c1 = 3 N*s/m\nparam c2 = 7 N*s^2/m^2\nbody b { mass = m, moves y }\n\
                 spring s: ground -- b { k = k }\ndamper d: ground -- b { law = c1 * rate + c2 * rate * abs(rate) }\n";
    assert_says(
        &text_of("square", model),
        &["D = 1/2 c1 y'^2 + 1/3 c2 abs(y')^3", "m y'' + c1 y' + c2 abs(y') y' + k y = 0", "m y'' + c1 y' + k y = 0"],
    );
}

/// A law along a line that turns: k (l - l_free)^3 with the lever of the line. Its form agrees with the lowering and the energies, which
/// the program compares by itself.
#[test]
fn laws_on_lines_that_turn_and_on_angles_agree_with_the_lowering() {
    for element in [
        "spring v: ground@(1 m, -0.5 m) -- rod@(0, -1 m) { law = 40 N/m * stretch + 300 N/m^3 * stretch^3, free_length = 0.9 m }",
        "spring v: ground@(1 m, -0.5 m) -- rod@(0, -1 m) { law = 6 N + 40 N/m^2 * stretch * abs(stretch), free_length = 0.9 m }",
        "damper v: ground@(1 m, -0.5 m) -- rod@(0, -1 m) { law = 4 N*s/m * rate + 3 N*s^2/m^2 * rate * abs(rate) }",
        "spring v: ground -- rod { law = 40 N*m/rad * stretch - 20 N*m * stretch^2, free_length = 0.2 rad }",
        "damper v: ground -- rod { law = 4 N*m*s/rad * rate + 3 N*m*s^3/rad^3 * rate^3 }",
        "spring v: ground@(-1 m, -1 m) -- rod@(0, -1 m) { law = 40 N/m * stretch + 90 N/m^2 * stretch^2, along = x }",
        "spring v: rod@(0, -1 m) -- ground@(-1 m, -1 m) { law = 40 N/m * stretch + 90 N/m^2 * stretch^2, along = x }",
    ] {
        let model = format!(
            "gravity 9.81 m/s^2\nbody rod {{ mass = 2 kg, shape = rod((0, 0), (0, -1 m)) }}\npivot p: ground@(0, 0) -- rod\n\
             spring t: ground -- rod {{ k = 30 N*m/rad }}\n{element}\nforce F: rod@(0, -1 m) along x\noutput pull = v.force\n"
        );
        let text = text_of("line", &model);
        assert!(text.contains("7 Natural frequencies"), "{element}:\n{text}");
        assert!(text.matches("    q_v = ").count() <= 1, "one name for two things:\n{text}");
    }
}

/// The mount of the example, as a textbook has it.
#[test]
fn the_stiffening_mount_has_its_equation() {
    assert_says(
        &example("stiffening_mount.vib"),
        &[
            "m y'' + 60 y' + 40 abs(y') y' + m g + k1 (y_0 + y) + k3 (y_0 + y)^3 = F",
            "m y'' + 60 y' + (k1 + 3 k3 y_0^2) y = F",
        ],
    );
}

#[test]
fn faults_in_laws_are_reported_where_they_are() {
    let scene = scene_of(&format!("gravity 9.81 m/s^2\n{DUFFING}"));
    // In the lowered tangent.
    let mut lowered = scene.lowered();
    let system = lowered.system.clone();
    let display = |source| system.display(system.k.source_of(source));
    lowered.system.k = changed(&system.k, &["s"], display, |weight, _, _| {
        *weight = &*weight * &Number::from(2);
        true
    });
    assert_eq!(scene.place(scene.derive(&scene.written, &lowered).expect_err("a tangent")), "s");
    // In what the symbols are made from.
    let lowered = scene.lowered();
    for by in [Sum::fraction(-1, 1), Sum::fraction(101, 100)] {
        let mut written = scene.written.clone();
        written.elements[0].law = written.elements[0].law.as_ref().map(|law: &Powers| law.scale(&by));
        assert_eq!(scene.place(scene.derive(&written, &lowered).expect_err("a law")), "s");
    }
    // In what is derived.
    assert_reported(
        &scene,
        &[
            ("the tangent", |e| doubled(&mut e.linear.stiffness[0][0].sum), "b"),
            ("the slope of the cubic part", |e| doubled(&mut e.nonlinear[0].lines[0].slope), "b"),
            ("the condition of rest", |e| e.rest.conditions[0].1 = &e.rest.conditions[0].1 + &Sum::one(), "b"),
            ("the force that is put out", |e| doubled(&mut e.outputs[0].rows[0][0]), "pull"),
        ],
    );
}
