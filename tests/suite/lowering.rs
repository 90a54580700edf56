//! Matrices compared with closed forms and with numerical derivatives.

use vibc::base::{Number, Rational, SourceFile, Sources};
use vibc::lower::{self, Lowered};
use vibc::model::{self, Overrides};
use vibc::system::Form;

/// The lowered model, or the codes of its errors.
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

/// omega^2 of a scene with one degree of freedom.
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
    let Lowered { system, rest, .. } = system(CART);
    assert_eq!(system.coordinate_names(), ["block.x", "rod.angle"]);
    assert_eq!(entries(&system.m, 2), [["3/2", "1/2"], ["1/2", "2/3"]]);
    assert_eq!(entries(&system.c, 2), [["5", "0"], ["0", "0"]]);
    assert_eq!(entries(&system.k, 2), [["10", "0"], ["0", "981/200"]]);
    assert!(rest.displacement.iter().all(Number::is_zero));
    assert_eq!((rest.residual, rest.steps, rest.is_proven()), (0.0, 0, true));
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
    let Lowered { system, rest, .. } = system(upright);
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

/// Tension T in a string of two halves of length l gives a mass the lateral stiffness 2 T / l.
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

/// A mass on a slide at 30 degrees moves along it; the length of the direction is irrational and cancels exactly.
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
fn unsupported_parts_are_reported_once_each() {
    let text = "body a { mass = 1 kg, at = (0, 0), inertia = 1 kg*m^2 }
        body b { mass = 1 kg, at = (1 m, 0), inertia = 1 kg*m^2 }
        body c { mass = 1 kg, moves x }
        pivot p: a -- b@(0, 0)";
    assert_eq!(lowered(text).err(), Some(vec!["vib::freedom::loose"]));
}

#[test]
fn a_massless_unrestrained_coordinate_is_reported() {
    let text = "body wheel { mass = 1 kg, at = (0, 0) }
        pivot p: ground@(0, 0) -- wheel";
    assert_eq!(lowered(text).err(), Some(vec!["vib::freedom::no_inertia"]));
}

fn displacement(lowered: &Lowered) -> Vec<f64> {
    lowered.rest.displacement.iter().map(Number::to_f64).collect()
}

/// A point mass of 15 kg at a distance of 4 m, drawn at 30 degrees from the horizontal: it hangs, and omega^2 = g / l.
#[test]
fn a_pendulum_finds_its_rest_from_far_away() {
    for (x, y) in [("2 m", "-2 m * sqrt(3)"), ("4 m", "0"), ("2 m", "2 m * sqrt(3)"), ("-0.004 m", "4 m")] {
        let text = format!(
            "gravity 9.81 m/s^2
            body bob {{ mass = 15 kg, at = ({x}, {y}) }}
            pivot p: ground@(0, 0) -- bob"
        );
        let lowered = system(&text);
        let rest = &lowered.rest;
        assert!(rest.is_proven(), "{x} {y}");
        assert!(rest.residual < 1e-25, "{:e}", rest.residual);
        let omega_squared = omega_squared(&text);
        let length_squared = values(&lowered.system.m, 1)[0][0] / 15.0;
        // The length follows from the drawing.
        assert!((omega_squared * length_squared.sqrt() / 9.81 - 1.0).abs() < 1e-15, "{x} {y}");
    }
    let hanging = "gravity 9.81 m/s^2
        body bob { mass = 15 kg, at = (4 m * cos(30 deg), -4 m * sin(30 deg)) }
        pivot p: ground@(0, 0) -- bob";
    let lowered = system(hanging);
    // From 30 degrees below the horizontal to straight down: 60 degrees clockwise.
    let turned = lowered.rest.displacement[0].to_ball();
    assert!((turned.to_f64() + std::f64::consts::FRAC_PI_3).abs() < 1e-15);
    assert!(turned.rad < 1e-28 && lowered.rest.is_proven());
    assert!(lowered.rest.steps < 10, "{}", lowered.rest.steps);
}

/// m g = 10 N on k = 40 N/m: exactly 1/4 m; the matrices do not depend on it.
#[test]
fn a_mass_sags_on_its_spring_by_an_exact_fraction() {
    let text = "gravity 10 m/s^2
        body block { mass = 1 kg, moves y, at = (0, 0) }
        spring s: ground@(0, 2 m) -- block { k = 40 N/m }";
    let lowered = system(text);
    assert_eq!(lowered.rest.displacement, [Number::from(Rational::new(-1, 4))]);
    assert_eq!((lowered.rest.residual, lowered.rest.is_proven()), (0.0, true));
    assert_eq!(entries(&lowered.system.k, 1), [["40"]]);
}

/// A mass in the plane between two springs drawn at half their free lengths: they push it out to where both are
/// relaxed.
#[test]
fn a_spring_drawn_at_half_its_length_relaxes() {
    let text = "body ball { mass = 1 kg, at = (0, 0.1 m), moves x y }
        spring a: ground@(-1 m, 0) -- ball { k = 100 N/m, free_length = 2 m }
        spring b: ball -- ground@(1 m, 0) { k = 100 N/m, free_length = 2 m }";
    let lowered = system(text);
    let [x, y] = displacement(&lowered)[..] else { panic!("two coordinates") };
    // An equilateral triangle of side 2: height sqrt(3). By symmetry x stays.
    assert!(lowered.rest.displacement[0].may_be_zero() && x.abs() < 1e-25, "{x}");
    assert!((y + 0.1 - 3f64.sqrt()).abs() < 1e-15 && lowered.rest.is_proven());
    let k = values(&lowered.system.k, 2);
    assert!((k[0][0] - 50.0).abs() < 1e-12 && (k[1][1] - 150.0).abs() < 1e-12, "{k:?}");
}

/// P13 of the published cases (ANSYS VM9): large displacements under a dead load, which is a constant force here.
#[test]
fn a_constant_force_is_part_of_rest() {
    let text = "body P { mass = 1 kg, at = (0, 0), moves x y }
        spring a: ground@(0, -10 m) -- P { k = 1 N/m }
        spring b: ground@(0, 10 m) -- P { k = 8 N/m }
        force F: P along (1, 1) = constant(sqrt(50) * 1 N)";
    let lowered = system(text);
    let [x, y] = displacement(&lowered)[..] else { panic!("two coordinates") };
    assert!((x - 8.632066133347).abs() < 1e-12 && (y - 4.531906698982).abs() < 1e-12, "{x} {y}");
    assert!(lowered.rest.is_proven());
}

#[test]
fn an_upright_rod_on_a_sagging_cart_stays_upright() {
    let text = "gravity 10 m/s^2
        body cart { mass = 1 kg, moves y, at = (0, 0) }
        body rod { mass = 1 kg, shape = rod((0, 0), (0, 1 m)) }
        pivot p: cart@(0, 0) -- rod
        spring s: ground@(0, -1 m) -- cart { k = 100 N/m }";
    let lowered = system(text);
    assert_eq!(lowered.rest.displacement, [Number::from(Rational::new(-1, 5)), Number::ZERO]);
    assert_eq!(entries(&lowered.system.k, 2), [["100", "0"], ["0", "-5"]]);
}

#[test]
fn unsupported_bodies_fall() {
    let text = "gravity 10 m/s^2
        body stone { mass = 1 kg, moves x y }
        spring s: ground -- stone { k = 10 N/m, along = x }";
    assert_eq!(lowered(text).err(), Some(vec!["vib::rest::not_found"]));
    let swinging = "gravity 10 m/s^2
        body cart { mass = 1 kg, moves x y, at = (0, 0) }
        body rod { mass = 1 kg, shape = rod((0, 0), (1 m, 0)) }
        pivot p: cart@(0, 0) -- rod
        spring s: ground@(-1 m, 0) -- rod@(1 m, 0) { k = 1 N/m, along = x }";
    assert_eq!(lowered(swinging).err(), Some(vec!["vib::rest::not_found"]));
}

/// Two masses pushed apart by a spring, without ground: they move in opposite directions, and the chain as a whole
/// stays in place.
#[test]
fn a_free_chain_relaxes_in_place() {
    let text = "body a { mass = 1 kg, moves x }
        body b { mass = 1 kg, moves x }
        spring s: a -- b { k = 10 N/m, preload = -20 N }";
    let lowered = system(text);
    let exact: Vec<Number> = [-1, 1].map(Number::from).to_vec();
    assert_eq!(lowered.rest.displacement, exact);
    assert!(lowered.rest.is_proven());
}

/// A chain of 1000 masses hanging under gravity sags by m g / k times 1000 + 999 + ... at each.
#[test]
fn a_long_chain_sags_as_the_sum_of_its_weights() {
    let text = "gravity 10 m/s^2
        body m[1] { mass = 1 kg, moves y }
        spring k[1]: ground -- m[1] { k = 10000 N/m }
        repeat i in 2..1000 {
            body m[i] { mass = 1 kg, moves y }
            spring k[i]: m[i-1] -- m[i] { k = 10000 N/m }
        }";
    let lowered = system(text);
    assert!(lowered.rest.is_proven());
    let last = lowered.rest.displacement[999].to_ball();
    assert!((last.to_f64() + 500.5).abs() <= last.rad && last.rad < 1e-20, "{last:?}");
}

/// `torque T: a -- b` acts on a, and on b in the opposite direction (spec.md#forces-and-torques).
#[test]
fn a_torque_between_two_bodies_acts_on_both() {
    let text = "body a { inertia = 1 kg*m^2, turns }
        body b { inertia = 2 kg*m^2, turns }
        spring s: ground -- a { k = 3 N*m/rad }
        spring t: a -- b { k = 5 N*m/rad }
        torque T: a -- b\ntorque one: b";
    let Lowered { system, .. } = system(text);
    let column = |input: usize| {
        let entries = system.inputs[input].b[0].iter();
        entries.map(|(i, value)| (i.index(), value.to_f64())).collect::<Vec<_>>()
    };
    assert_eq!(column(0), [(0, 1.0), (1, -1.0)]);
    assert_eq!(column(1), [(1, 1.0)]);
}

/// `force F: a -- b along d` acts on a in the direction d, and on b in the opposite one; without `along` a positive force
/// pushes the ends apart (spec.md#forces-and-torques). The pages that editors show say the same.
#[test]
fn a_force_between_two_bodies_acts_on_both() {
    let text = "body a { mass = 1 kg, moves x }
        body b { mass = 2 kg, moves x }
        spring s: ground -- a { k = 3 N/m }
        spring t: a -- b { k = 5 N/m }
        force F: a -- b along x\nforce G: a -- b";
    let Lowered { system, .. } = system(text);
    let column = |input: usize| {
        let entries = system.inputs[input].b[0].iter();
        entries.map(|(i, value)| (i.index(), value.to_f64())).collect::<Vec<_>>()
    };
    assert_eq!(column(0), [(0, 1.0), (1, -1.0)]);
    assert_eq!(column(1), [(0, -1.0), (1, 1.0)]);
    let says = |keyword: &str| vibc::kinds::declaration(keyword).expect("a keyword").manual.rules;
    assert!(says("force").contains("with `along` it acts on a in"), "{}", says("force"));
    assert!(says("torque").contains("acts on a, and on b in the opposite direction"), "{}", says("torque"));
}

#[test]
fn a_check_drops_terms_and_finds_the_same() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut texts: Vec<(String, String)> = Vec::new();
    for folder in ["examples", "tests/diagnostics"] {
        for entry in std::fs::read_dir(root.join(folder)).expect("a folder of models") {
            let path = entry.expect("an entry").path();
            if path.extension().is_some_and(|extension| extension == "vib") {
                let text = String::from_utf8_lossy(&std::fs::read(&path).expect("a model")).into_owned();
                texts.push((path.display().to_string(), text));
            }
        }
    }
    // What acts on nothing, and coordinates that nothing determines, at rest as drawn.
    let loose =
        "repeat i in 1..3 { body m[i] { mass = 0, moves x } } body b { mass = 1 kg, moves x, inertia = 2 kg*m^2 }
        damper d: m[1] -- b { c = 1 N*s/m } body still { mass = 1 kg, moves y } spring s: ground -- still { k = 2 N/m }
        spring idle: ground -- b { k = 1 N/m, along (0, 1) }";
    texts.push(("loose".into(), loose.into()));
    let (mut found, mut scenes) = (0, 0);
    for (name, text) in &texts {
        let mut sources = Sources::new();
        let file = sources.add(SourceFile::model("scene.vib", text.as_str()));
        let parsed = vibc::syntax::parse(&sources, file);
        let Some(scene) = model::check(&sources, &parsed.tree, &Overrides::default()).scene else { continue };
        let whole = lower::lower(&scene).diagnostics;
        assert_eq!(lower::check(&scene), whole, "{name}");
        found += whole.iter().count();
        scenes += 1;
    }
    assert!(scenes > 40 && found > 15, "{scenes} scenes, {found} findings");
}
