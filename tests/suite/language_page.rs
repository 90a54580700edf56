//! Small models as a user writes them, one for each form of each declaration: accepted with the number that a pocket
//! calculator gives, or refused with the right code. Every expected number is derived in the test itself.

use crate::ask::{Answer, ask, refusal};

/// Asserts frequencies in rad/s to a few units of the last place, because the expected ones are computed in binary64.
fn assert_omegas(text: &str, expected: &[f64]) -> Answer {
    let answer = ask(text);
    let found = answer.omegas();
    assert_eq!(found.len(), expected.len(), "{found:?} for\n{text}");
    for (found, truth) in found.iter().zip(expected) {
        assert!((found - truth).abs() <= 4e-15 * truth.abs(), "{found:e}, by hand {truth:e}, for\n{text}");
    }
    answer
}

fn root(x: f64) -> f64 {
    x.sqrt()
}

fn assert_refused(text: &str, code: &str) {
    assert_eq!(refusal(text), [code], "{text}");
}

// Bodies.

#[test]
fn a_body_moves_along_an_axis() {
    assert_omegas("body b { mass = 2 kg, moves x }\nspring k: ground -- b { k = 8 N/m }", &[2.0]);
    assert_omegas("body b { mass = 2 kg, moves y }\nspring k: ground -- b { k = 8 N/m }", &[2.0]);
}

#[test]
fn a_body_moves_in_the_plane() {
    assert_omegas(
        "body b { mass = 1 kg, moves x y }
spring kx: ground -- b { k = 4 N/m, along = x }
spring ky: ground -- b { k = 9 N/m, along = y }",
        &[2.0, 3.0],
    );
}

#[test]
fn a_body_moves_along_an_oblique_line() {
    // Along (3, 4)/5 a spring in x follows 3/5 of the motion: k cos^2 = 25 * 9/25.
    assert_omegas(
        "body b { mass = 1 kg, moves along (3, 4) }\nspring k: ground -- b { k = 25 N/m, along = x }",
        &[3.0],
    );
    // A spring with no position acts on the line on which the body moves.
    assert_omegas("body b { mass = 1 kg, moves along (1, 1) }\nspring k: ground -- b { k = 16 N/m }", &[4.0]);
}

#[test]
fn a_body_turns() {
    // A disc: m r^2 / 2 = 0.09 kg m^2.
    assert_omegas(
        "body wheel { mass = 2 kg, at = (0, 1 m), shape = disk(0.3 m), turns }\nspring k: ground -- wheel { k = 0.36 N*m/rad }",
        &[2.0],
    );
    assert_omegas("body wheel { inertia = 0.5 kg*m^2, turns }\nspring k: ground -- wheel { k = 4.5 N*m/rad }", &[3.0]);
}

#[test]
fn a_free_body_has_three_motions() {
    // Springs of k at (+-a, 0) along y and one along x through the centre: 2k/m, 2ka^2/I, kx/m.
    assert_omegas(
        "body plate { mass = 2 kg, inertia = 0.5 kg*m^2, at = (0, 0), free }
spring left: ground -- plate@(-1 m, 0) { k = 4 N/m, along = y }
spring right: ground -- plate@(1 m, 0) { k = 4 N/m, along = y }
spring side: ground -- plate { k = 18 N/m, along = x }",
        &[2.0, 3.0, 4.0],
    );
}

#[test]
fn shapes_give_centre_and_inertia() {
    let with =
        |shape: &str| format!("body b {{ mass = 3 kg, {shape}, turns }}\nspring k: ground -- b {{ k = 1 N*m/rad }}");
    // rod m l^2/12 = 3*4/12 = 1; ring m r^2; box m (w^2 + h^2)/12; disc m r^2/2.
    assert_omegas(&with("shape = rod((0, 0), (0, -2 m))"), &[1.0]);
    assert_omegas(&with("at = (0, 0), shape = ring(0.5 m)"), &[root(1.0 / 0.75)]);
    assert_omegas(&with("at = (0, 0), shape = box(1 m, 2 m)"), &[root(1.0 / 1.25)]);
    assert_omegas(&with("at = (0, 0), shape = disk(1 m)"), &[root(1.0 / 1.5)]);
}

#[test]
fn inertia_about_a_point_is_moved_to_the_centre() {
    // I about the hinge A is given, the centre is 0.5 m from A: m g d / I_A = 2 * 10 * 0.5 / 2.5 = 4.
    assert_omegas(
        "gravity 10 m/s^2\npoint A = (1 m, 1 m)
body arm { mass = 2 kg, at = A + (0, -0.5 m), inertia = 2.5 kg*m^2 about A }
pivot p: ground@A -- arm",
        &[2.0],
    );
}

// Joints.

#[test]
fn a_pivot_on_a_body_with_a_clause() {
    // A light cart on a stiff rail is not a cart: here m1 is heavy and held, so omega is that of the rod alone, 3 g / 2
    // L.
    let answer = ask("gravity 9.81 m/s^2
body cart { mass = 1 kg, moves x }\nbody rod { mass = 1 kg, shape = rod((0, 0), (0, -1 m)) }
pivot p: cart@(0, 0) -- rod\nspring k: ground -- cart { k = 1e12 N/m }");
    // Rayleigh: the cart moves by some (m l / 2)^2 omega^4 / k = 1e-11.
    assert!((answer.omegas()[0] - root(14.715)).abs() < 1e-10);
}

#[test]
fn a_slide_between_two_bodies() {
    // A slug on an arm that is held only by its slide: relative motion with the reduced mass of 2 and 6.
    assert_omegas(
        "body cart { mass = 2 kg, moves x }\nbody slug { mass = 6 kg }
slide g: cart -- slug along (1, 0)\nspring k: cart -- slug { k = 6 N/m, along = x }",
        &[0.0, 2.0],
    );
}

#[test]
fn a_slug_in_a_turning_arm() {
    // An arm turning about its centre with a slug of 1 kg drawn 2 m out, held along the arm by 9 N/m and the arm by
    // a torsion spring of 36 N m/rad: the slug 3 rad/s, the arm sqrt(36 / (5 + 1 * 4)) = 2 rad/s.
    assert_omegas(
        "body arm { mass = 1 kg, inertia = 5 kg*m^2, at = (0, 0), turns }
body slug { mass = 1 kg, at = (2 m, 0), inertia = 0 kg*m^2 }
slide g: arm -- slug along (1, 0)
spring t: ground -- arm { k = 36 N*m/rad }
spring k: arm@(0.5 m, 0) -- slug { k = 9 N/m }",
        &[2.0, 3.0],
    );
}

#[test]
fn a_weld_makes_one_body_of_two() {
    assert_omegas(
        "body a { mass = 1 kg, moves x }\nbody b { mass = 3 kg }\nweld w: a -- b\nspring k: ground -- b { k = 16 N/m, along = x }",
        &[2.0],
    );
}

// Springs and dampers.

#[test]
fn a_line_spring_across_its_motion_stiffens_with_tension() {
    // Two strings of 1 m with 3 N each: 2 T / (L m) = 6.
    assert_omegas(
        "body bead { mass = 1 kg, at = (0, 0), moves y }
spring left: ground@(-1 m, 0) -- bead { k = 100 N/m, preload = 3 N }
spring right: bead -- ground@(1 m, 0) { k = 100 N/m, preload = 3 N }",
        &[root(6.0)],
    );
}

#[test]
fn a_compressed_spring_softens_and_buckles() {
    // In line with the body's freedom only k counts; across it T / L = k (1 - L0 / L).
    let model = |free: &str| {
        format!(
            "body bead {{ mass = 1 kg, at = (0, 0), moves y }}
spring hold: ground -- bead {{ k = 10 N/m, along = y }}
spring left: ground@(-1 m, 0) -- bead {{ k = 20 N/m, free_length = {free} }}
spring right: bead -- ground@(1 m, 0) {{ k = 20 N/m, free_length = {free} }}"
        )
    };
    // 10 + 2 * 20 (1 - 1.15) = 4; 10 + 2 * 20 (1 - 1.475) = -9: the drawing is an unstable rest.
    assert_omegas(&model("1.15 m"), &[2.0]);
    assert_omegas(&model("1.475 m"), &[-3.0]);
}

#[test]
fn an_inclined_spring_counts_with_the_square_of_its_cosine() {
    assert_omegas(
        "body b { mass = 1 kg, at = (0, 0), moves x }\nspring k: ground@(-3 m, 4 m) -- b { k = 25 N/m }",
        &[3.0],
    );
}

#[test]
fn elements_along_a_fixed_direction() {
    for (along, cosine_squared) in [("x", 1.0), ("(3, 4)", 0.36), ("(-3, 4)", 0.36)] {
        let model =
            format!("body b {{ mass = 1 kg, moves x }}\nspring v: ground -- b {{ k = 5 N/m, along = {along} }}");
        assert_omegas(&model, &[root(5.0 * cosine_squared)]);
    }
}

#[test]
fn a_torsion_spring_between_two_bodies() {
    // Two discs of 1 and 2 kg m^2 on a shaft of 6 N m/rad: reduced inertia 2/3, omega 3.
    assert_omegas(
        "body a { inertia = 1 kg*m^2, turns }\nbody b { inertia = 2 kg*m^2, turns }\nspring shaft: a -- b { k = 6 N*m/rad }",
        &[0.0, 3.0],
    );
}

#[test]
fn dampers_of_each_kind() {
    let one = |damper: &str| {
        let model = format!(
            "body b {{ mass = 1 kg, at = (0, 0), moves x }}\nspring k: ground -- b {{ k = 25 N/m, along = x }}\n{damper}"
        );
        ask(&model).poles.list[0].damping_ratio.expect("not at zero").to_f64()
    };
    // zeta = c / (2 m omega) = 2 / 10; along (3, 4) its 0.36.
    assert!((one("damper d: ground -- b { c = 2 N*s/m, along = x }") - 0.2).abs() < 1e-15);
    assert!((one("damper d: ground@(0, 0) -- b { c = 2 N*s/m, along = (3, 4) }") - 0.072).abs() < 1e-15);
    assert!((one("damper d: ground@(-3 m, 4 m) -- b { c = 2 N*s/m }") - 0.072).abs() < 1e-15);
    let turning = ask(
        "body w { inertia = 1 kg*m^2, turns }\nspring k: ground -- w { k = 25 N*m/rad }\ndamper d: ground -- w { c = 2 N*m*s/rad }",
    );
    assert!((turning.poles.list[0].damping_ratio.expect("not at zero").to_f64() - 0.2).abs() < 1e-15);
}

#[test]
fn a_negative_stiffness_is_noted() {
    let answer = assert_omegas(
        "body b { mass = 1 kg, moves x }\nspring k: ground -- b { k = 10 N/m }\nspring n: ground -- b { k = -1 N/m }",
        &[3.0],
    );
    assert_eq!(answer.remarks.len(), 1, "{:?}", answer.remarks);
}

// Inputs and outputs.

#[test]
fn supports_drive_through_their_springs() {
    let answer = assert_omegas(
        "body table { mass = 1 kg, moves y }\nbase floor { moves y }
spring k: floor -- table { k = 4 N/m }\ndamper c: floor -- table { c = 3 N*s/m }\noutput gap = table.y - floor.y",
        &[2.0],
    );
    let system = &answer.lowered.system;
    let b: Vec<f64> = system.inputs[0].b.iter().map(|b| b.iter().map(|(_, v)| v.to_f64()).sum()).collect();
    assert_eq!(b, [4.0, 3.0, 0.0]);
    assert_eq!(system.outputs[0].d[0].iter().map(|(_, v)| v.to_f64()).collect::<Vec<f64>>(), [-1.0]);
}

#[test]
fn forces_and_torques_of_each_form() {
    let answer = ask("body a { mass = 1 kg, inertia = 1 kg*m^2, at = (0, 0), free }
body b { mass = 1 kg, at = (3 m, 4 m), moves x y }
spring x: ground -- a { k = 1 N/m, along = x }\nspring y: ground -- a { k = 1 N/m, along = y }\nspring t: ground -- a { k = 1 N*m/rad }
spring u: ground -- b { k = 1 N/m, along = x }\nspring v: ground -- b { k = 1 N/m, along = y }
force F: a@(0, 2 m) along x\nforce G: a -- b\ntorque T: a\nforce H: b along (3, 4) = harmonic(10 N, 1.5 Hz)");
    let system = &answer.lowered.system;
    let names = system.coordinate_names();
    assert_eq!(names, ["a.x", "a.y", "a.angle", "b.x", "b.y"]);
    let column = |i: usize| {
        let mut dense = [0.0; 5];
        for (at, value) in &system.inputs[i].b[0] {
            dense[at.index()] = value.to_f64();
        }
        dense
    };
    // A force along x, 2 m above the centre, turns clockwise.
    assert_eq!(column(0), [1.0, 0.0, -2.0, 0.0, 0.0]);
    // Between two bodies, a positive force pushes them apart.
    assert_eq!(column(1), [-0.6, -0.8, 0.0, 0.6, 0.8]);
    assert_eq!(column(2), [0.0, 0.0, 1.0, 0.0, 0.0]);
    assert_eq!(column(3), [0.0, 0.0, 0.0, 0.6, 0.8]);
}

#[test]
fn outputs_of_each_form() {
    let answer = ask("body rod { mass = 1 kg, shape = rod((0, 0), (0, -2 m)) }\npivot p: ground@(0, 0) -- rod
spring s: ground@(-1 m, -2 m) -- rod@(0, -2 m) { k = 7 N/m }\ndamper d: ground -- rod { c = 5 N*m*s/rad }
output theta = rod.angle\noutput tip = rod@(0, -2 m).x\noutput pull = s.force\noutput stretched = s.stretch\noutput brake = d.force
output speed = rod@(0, -2 m).vx\noutput spin = rod.omega\noutput jerk = rod.alpha + 3 * rod.alpha\noutput mixed = 2 * rod.x - rod.angle * 1 m");
    let row =
        |i: usize, order: usize| answer.lowered.system.outputs[i].p[order].iter().map(|(_, v)| v.to_f64()).sum::<f64>();
    // Turning by 1 rad moves the tip by 2 m to the right and the centre by 1 m; the spring points to the right.
    assert_eq!(row(0, 0), 1.0);
    assert_eq!(row(1, 0), 2.0);
    assert_eq!(row(2, 0), 14.0);
    assert_eq!(row(3, 0), 2.0);
    assert_eq!(row(4, 1), 5.0);
    assert_eq!(row(5, 1), 2.0);
    assert_eq!(row(6, 1), 1.0);
    assert_eq!(row(7, 2), 4.0);
    assert_eq!(row(8, 0), 1.0);
}

// Parameters, units, repeat, lexis.

#[test]
fn parameters_in_any_order_and_with_names_of_parts() {
    assert_omegas(
        "let w = sqrt(k / m)\nspring k: ground -- m { k = m * w^2 }\nbody m { mass = m, moves x }\nparam m = 2 kg\nparam k = 8 N/m",
        &[2.0],
    );
}

#[test]
fn hertz_counts_cycles() {
    // 2 pi f as an engineer writes it, and f in cycles by 1 rev.
    assert_omegas(
        "param f = 10 Hz\nlet w = 2*pi*f\nbody m { mass = 3 kg, moves x }\nspring k: ground -- m { k = 3 kg * w^2 }",
        &[20.0 * std::f64::consts::PI],
    );
}

#[test]
fn units_of_the_page() {
    // Each line is a stiffness of 1000 N/m on 10 kg: omega 10.
    for k in [
        "1000 N/m",
        "1 kN/m",
        "1 N/mm",
        "10 N/cm",
        "1e-6 N/um * 1e3",
        "1 kN / 1 m",
        "1000 kg/s^2",
        "1000 J/m^2",
        "1 kPa * 1 m",
        "1e-3 MPa * 1 m",
        "1000 W*s/m^2",
        "1000 N*m/m^2",
        "60 kN*s/m/min",
        "1000 / 0.45359237 / 9.80665 * 0.3048 * 1 lbf/ft",
        "1000 / 0.45359237 / 9.80665 * 0.0254 * 1 lbf/inch",
        "1 / 0.45359237 / 9.80665 * 0.0254 * 1 kip/inch",
        "1000 * 0.0254 / 0.45359237 / 9.80665 * 1 psi * 1 inch",
        "1000 / 9.80665 * 1 kg * 1 g0 / 1 m",
        "1000 / 0.45359237 * 1 lb/s^2",
        "10 kg * (10 rad/s)^2",
    ] {
        let text = format!("body m {{ mass = 10 kg, moves x }}\nspring k: ground -- m {{ k = {k} }}");
        assert_omegas(&text, &[10.0]);
    }
}

#[test]
fn angles_and_percent() {
    // sin 30 deg = 1/2; 50 % = 1/2; 0.5 rev = pi rad; 30 rpm = pi rad/s.
    for k in ["sin(30 deg) * 8 N/m", "50 % * 8 N/m", "-cos(0.5 rev) * 4 N/m", "4 N/m * (30 rpm / (pi * 1 rad/s))"] {
        assert_omegas(&format!("body m {{ mass = 1 kg, moves x }}\nspring k: ground -- m {{ k = {k} }}"), &[2.0]);
    }
}

#[test]
fn repeat_with_bounds_included_and_indices() {
    let answer = ask("param n = 4
body m[1] { mass = 1 kg, moves x }
repeat i in 2..n {
  body m[i] { mass = 1 kg, moves x }
  spring k[i]: m[i-1] -- m[i] { k = 1 N/m }
}
spring first: ground -- m[1] { k = 1 N/m }
output last = m[n].x");
    assert_eq!(answer.lowered.system.coordinate_names(), ["m[1].x", "m[2].x", "m[3].x", "m[4].x"]);
}

#[test]
fn a_net_with_two_indices() {
    let answer = ask("repeat i in 1..3 { repeat j in 1..2 {
  body m[i][j] { mass = 1 kg, moves x }
  spring g[i][j]: ground -- m[i][j] { k = 4 N/m }
} }");
    assert_eq!(answer.omegas(), [2.0; 6]);
}

#[test]
fn line_ends_comments_and_documentation() {
    assert_omegas(
        "/// What stands on the floor.\n// a comment\nmodel page // another\n\n\tbody block {\n  mass = 1 kg // in braces\n  moves x\n}\r
spring s: ground -- block {\n\n k = 1 N/m,\n}\n",
        &[1.0],
    );
    assert_omegas("body Ωmega_2 { mass = 1 kg, moves x }\nspring κ: ground -- Ωmega_2 { k = 1 N/m }", &[1.0]);
}

#[test]
fn a_bare_zero_fits_every_dimension() {
    let answer = ask("gravity (0, -10 m/s^2)\npoint A = (0, 0)
body rod { mass = 1 kg, shape = rod(A, (0, -3 m)) }\npivot p: ground@A -- rod");
    assert!((answer.omegas()[0] - root(5.0)).abs() < 1e-15);
}

#[test]
fn gravity_points_where_it_says() {
    // Along +x: a rod drawn along x hangs.
    assert_omegas(
        "gravity (10 m/s^2, 0)\nbody rod { mass = 1 kg, shape = rod((0, 0), (3 m, 0)) }\npivot p: ground@(0, 0) -- rod",
        &[root(5.0)],
    );
}

// Refusals: one mistake, one error.

#[test]
fn an_unknown_direction() {
    // The body moves in x and y, and the element has no positions.
    assert_refused(
        "body b { mass = 1 kg, moves x y }\nspring k: ground -- b { k = 1 N/m }",
        "vib::element::direction_unknown",
    );
}

#[test]
fn wrong_and_missing_units() {
    assert_refused("body b { mass = 1 m, moves x }\nspring k: ground -- b { k = 1 N/m }", "vib::unit::mismatch");
    assert_refused("body b { mass = 1, moves x }\nspring k: ground -- b { k = 1 N/m }", "vib::unit::missing");
    assert_refused("body b { mass = 1 kgg, moves x }\nspring k: ground -- b { k = 1 N/m }", "vib::unit::unknown");
}

#[test]
fn a_free_length_and_a_preload() {
    let codes = refusal(
        "body b { mass = 1 kg, at = (0, 0), moves x }
spring k: ground@(-1 m, 0) -- b { k = 1 N/m, free_length = 1 m, preload = 1 N }",
    );
    assert_eq!(codes.len(), 1, "{codes:?}");
}

#[test]
fn a_body_without_any_freedom() {
    let codes = refusal(
        "body b { mass = 1 kg, at = (0, 0) }\nbody c { mass = 1 kg, moves x }\nspring k: ground -- c { k = 1 N/m }",
    );
    assert_eq!(codes.len(), 1, "{codes:?}");
}

#[test]
fn a_mass_that_a_freedom_needs() {
    let codes = refusal("body b { moves x }\nspring k: ground -- b { k = 1 N/m }");
    assert_eq!(codes.len(), 1, "{codes:?}");
}

#[test]
fn a_hanging_mass_sinks_by_its_weight() {
    let answer = assert_omegas(
        "gravity 9.81 m/s^2\nbody b { mass = 2 kg, moves y }\nspring k: ground -- b { k = 8 N/m }",
        &[2.0],
    );
    assert_eq!(answer.lowered.rest.displacement[0].to_f64(), -2.4525);
}

#[test]
fn a_spring_of_free_length_reaches_its_rest() {
    // Drawn 0.3 m too long: it pulls the body back to 1 m.
    let answer = assert_omegas(
        "body b { mass = 1 kg, at = (0, 0), moves x }\nspring k: ground@(-1.3 m, 0) -- b { k = 4 N/m, free_length = 1 m }",
        &[2.0],
    );
    assert_eq!(answer.lowered.rest.displacement[0].to_f64(), -0.3);
}

/// A body's own centre is where it is, whatever is known of its coordinates: x and y do not turn it.
#[test]
fn an_initial_state_of_a_free_body_needs_no_angle() {
    let answer = ask("param a = 10 deg\nbody b { mass = 2 kg, inertia = 1 kg*m^2, at = (cos(a) * 1 m, 0), free }
spring a: ground -- b { k = 20 N*m/rad }\nspring v: ground -- b { k = 192 N/m, along = x }
spring u: ground -- b { k = 183 N/m, along = y }\ninitial b { x = -1 m, y = 0.5 m }");
    let initial = answer.lowered.system.initial;
    let values: Vec<(usize, f64)> = initial.iter().map(|(at, x, _)| (at.index(), x.to_f64())).collect();
    assert_eq!(values, [(0, -1.0), (1, 0.5)]);
}

#[test]
fn an_initial_state_is_kept() {
    let answer = ask("body block { mass = 1 kg, moves x }\nspring k: ground -- block { k = 1 N/m }
initial block { x = 16 mm, vx = 0.375 m/s }");
    let (at, displacement, velocity) = &answer.lowered.system.initial[0];
    assert_eq!((at.index(), displacement.to_f64(), velocity.to_f64()), (0, 0.016, 0.375));
}
