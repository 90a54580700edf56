//! Matrices against closed forms and against numerical derivatives.

use vibc::base::{Number, Rational, SourceFile, Sources};
use vibc::lower::{self, Lowered};
use vibc::model::{self, Overrides};
use vibc::system::Form;

/// What a model is lowered to, or the codes of what is wrong with it.
fn lowered(text: &str) -> Result<Lowered, Vec<&'static str>> {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("scene.vib", text));
    let parsed = vibc::syntax::parse(&sources, file);
    let checked = model::check(&sources, &parsed.tree, &Overrides::default());
    let before: Vec<_> = parsed.errors.iter().chain(checked.diagnostics.iter()).filter(|d| d.is_error()).collect();
    assert!(before.is_empty(), "{before:#?}");
    let outcome = lower::lower(&checked.scene.expect("a scene without errors"));
    outcome.lowered.ok_or_else(|| outcome.diagnostics.iter().map(|diagnostic| diagnostic.code.0).collect())
}

fn system(text: &str) -> Lowered {
    lowered(text).expect("a scene that can be lowered")
}

/// The exact entries of a matrix, written as fractions.
fn entries(form: &Form, n: usize) -> Vec<Vec<String>> {
    let written = |entry: &Number| match entry.exact().and_then(Rational::to_fraction) {
        Some((n, 1)) => n.to_string(),
        Some((n, d)) => format!("{n}/{d}"),
        None => format!("about {}", entry.to_f64()),
    };
    form.entries(n).iter().map(|row| row.iter().map(written).collect()).collect()
}

fn values(form: &Form, n: usize) -> Vec<Vec<f64>> {
    form.assemble(n).iter().map(|row| row.iter().map(|entry| entry.to_f64()).collect()).collect()
}

/// omega^2 of a scene with one freedom.
fn omega_squared(text: &str) -> f64 {
    let Lowered { system, .. } = system(text);
    assert_eq!(system.n(), 1);
    values(&system.k, 1)[0][0] / values(&system.m, 1)[0][0]
}

const CART: &str = "
    gravity 9.81 m/s^2
    point A = (0, 0)
    body block { mass = 1 kg, moves x }
    body rod   { mass = 0.5 kg, shape = rod(A, A + (0, -2 m)) }
    pivot  p: block@A -- rod
    spring s: ground@(-0.5 m, 0) -- block@A { k = 10 N/m, free_length = 0.5 m }
    damper d: ground@(-0.5 m, 0) -- block@A { c = 5 N*s/m }
    force  F: block along x
    output x     = block.x
    output theta = rod.angle
    output tip   = rod@(0, -2 m).x
    output pull  = s.force
    output drag  = d.force";

#[test]
fn the_cart_has_the_matrices_of_the_problem_set_exactly() {
    let Lowered { system, rest } = system(CART);
    assert_eq!(system.coordinate_names(), ["block.x", "rod.angle"]);
    assert_eq!(entries(&system.m, 2), [["3/2", "1/2"], ["1/2", "2/3"]]);
    assert_eq!(entries(&system.c, 2), [["5", "0"], ["0", "0"]]);
    assert_eq!(entries(&system.k, 2), [["10", "0"], ["0", "981/200"]]);
    assert!(rest.displacement.iter().all(Number::is_zero));
    assert_eq!((rest.residual, rest.steps, rest.proven), (0.0, 0, true));
}

#[test]
fn outputs_are_rows_and_forces_are_columns() {
    let Lowered { system, .. } = system(CART);
    let row = |row: &[(vibc::system::CoordinateId, Number)]| -> Vec<(u32, f64)> {
        row.iter().map(|(i, value)| (i.0, value.to_f64())).collect()
    };
    assert_eq!(row(&system.inputs[0].b[0]), [(0, 1.0)]);
    let outputs: Vec<_> = system.outputs.iter().map(|output| row(&output.p[0])).collect();
    assert_eq!(outputs[..4], [vec![(0, 1.0)], vec![(1, 1.0)], vec![(0, 1.0), (1, 2.0)], vec![(0, 10.0)]]);
    assert_eq!(row(&system.outputs[4].p[1]), [(0, 5.0)]);
    let units: Vec<&str> = system.outputs.iter().map(|output| output.unit.as_str()).collect();
    assert_eq!(units, ["m", "rad", "m", "N", "N"]);
}

/// A uniform rod of 1 kg and 1 m on a pivot: omega^2 = m g l/2 / (m l^2/3) = 14.715 1/s^2.
#[test]
fn a_hanging_rod_is_held_by_its_weight() {
    let hanging = "gravity 9.81 m/s^2
        body rod { mass = 1 kg, shape = rod((0, 0), (0, -1 m)) }
        pivot p: ground@(0, 0) -- rod";
    let Lowered { system, .. } = system(hanging);
    assert_eq!(entries(&system.m, 1), [["1/3"]]);
    assert_eq!(entries(&system.k, 1), [["981/200"]]);
}

#[test]
fn an_upright_rod_falls_where_its_hinge_spring_is_too_soft() {
    let upright = "gravity 9.81 m/s^2
        body rod { mass = 1 kg, shape = rod((0, 0), (0, 1 m)) }
        pivot p: ground@(0, 0) -- rod
        spring t: ground -- rod { k = 2 N*m/rad }";
    let Lowered { system, rest } = system(upright);
    assert_eq!(entries(&system.k, 1), [["-581/200"]]);
    assert!(rest.displacement[0].is_zero());
    assert!((omega_squared(upright) - -8.715).abs() < 1e-14);
}

/// Equal point masses and lengths, absolute angles: M = m l^2 [2 1; 1 1], K = m g l diag(2, 1).
#[test]
fn a_double_pendulum_has_its_textbook_matrices() {
    let text = "gravity 9.81 m/s^2
        body upper { mass = 1 kg, at = (0, -1 m) }
        body lower { mass = 1 kg, at = (0, -2 m) }
        pivot q: lower -- upper@(0, -1 m)
        pivot p: upper -- ground@(0, 0)";
    let Lowered { system, .. } = system(text);
    assert_eq!(entries(&system.m, 2), [["2", "1"], ["1", "1"]]);
    assert_eq!(entries(&system.k, 2), [["981/50", "0"], ["0", "981/100"]]);
}

#[test]
fn a_base_drives_through_springs_and_dampers() {
    let text = "body table { mass = 200 kg, moves y }
        base floor { moves y }
        spring k: floor -- table { k = 800 N/m }
        damper c: floor -- table { c = 20 N*s/m }
        output gap = table.y - floor.y";
    let Lowered { system, .. } = system(text);
    let input = &system.inputs[0];
    assert_eq!(system.display(input.name), "floor");
    let entry = |order: usize| input.b[order].iter().map(|(_, value)| value.to_f64()).collect::<Vec<_>>();
    assert_eq!((entry(0), entry(1), entry(2)), (vec![800.0], vec![20.0], vec![]));
    assert_eq!(system.outputs[0].d[0], [(0, Number::from(-1))]);
}

/// Tension T in a string of two halves of length l holds the mass across it with 2 T / l.
#[test]
fn tension_stiffens_across_and_compression_softens() {
    let string = |tension: &str| {
        format!(
            "body bead {{ mass = 1 kg, at = (0, 0), moves y }}
            spring a: ground@(-2 m, 0) -- bead {{ k = 100 N/m, preload = {tension} }}
            spring b: bead -- ground@(2 m, 0) {{ k = 100 N/m, preload = {tension} }}"
        )
    };
    assert_eq!(entries(&system(&string("30 N")).system.k, 1), [["30"]]);
    assert_eq!(entries(&system(&string("-30 N")).system.k, 1), [["-30"]]);
}

/// A mass on a slide at 30 degrees moves along it; the direction's length is irrational and cancels exactly.
#[test]
fn an_oblique_slide_is_measured_along_itself_and_stays_exact() {
    let text = "body a { mass = 3 kg, moves along (1, 1) }
        body b { mass = 2 kg, moves along (1, 1) }
        spring s: ground -- a { k = 10 N/m }
        spring t: a -- b { k = 7 N/m }";
    let Lowered { system, .. } = system(text);
    assert_eq!(entries(&system.m, 2), [["3", "0"], ["0", "2"]]);
    assert_eq!(entries(&system.k, 2), [["17", "-7"], ["-7", "7"]]);
}

/// A bead on a rod that turns: absolute angle, distance along the rod.
/// V'' of the drawing at rest: gravity m g r theta^2/2 for the bead, and the mixed term m g s theta is zero by symmetry.
#[test]
fn a_slide_on_a_turning_body_turns_with_it() {
    let text = "gravity 10 m/s^2
        body rod  { mass = 3 kg, shape = rod((0, 0), (0, -2 m)) }
        body bead { mass = 1 kg, at = (0, -1 m) }
        pivot p: ground@(0, 0) -- rod
        slide g: rod -- bead along (0, -1)
        spring s: ground@(0, 1 m) -- bead { k = 40 N/m, preload = 10 N }";
    let Lowered { system, .. } = system(text);
    assert_eq!(system.coordinate_names(), ["rod.angle", "bead.slide"]);
    // Inertia of the rod about its end is 4, the bead adds 1.
    assert_eq!(entries(&system.m, 2), [["5", "0"], ["0", "1"]]);
    // Gravity 3 10 1 + 1 10 1 = 40. The spring from (0, 1) to r = 1: l = 2, T = 10: with the law of cosines
    // l^2 = 1 + r^2 + 2 r cos theta, d2l/dtheta^2 = -r / l = -1/2, so -5.
    assert_eq!(entries(&system.k, 2), [["35", "0"], ["0", "40"]]);
}

#[test]
fn what_nothing_holds_is_told_once_for_each_set() {
    let text = "body a { mass = 1 kg, at = (0, 0), inertia = 1 kg*m^2 }
        body b { mass = 1 kg, at = (1 m, 0), inertia = 1 kg*m^2 }
        body c { mass = 1 kg, moves x }
        pivot p: a -- b@(0, 0)";
    assert_eq!(lowered(text).err(), Some(vec!["vib::freedom::loose"]));
}

#[test]
fn a_freedom_without_inertia_is_told() {
    let text = "body wheel { mass = 1 kg, at = (0, 0) }
        pivot p: ground@(0, 0) -- wheel
        spring t: ground -- wheel { k = 2 N*m/rad }";
    assert_eq!(lowered(text).err(), Some(vec!["vib::freedom::no_inertia"]));
}
