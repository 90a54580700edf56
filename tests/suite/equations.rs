//! Output of `vibc equations`, compared with textbooks.

use super::equations_linter as linter;
use std::path::Path;
use vibc::backend::equations;
use vibc::base::{SourceFile, Sources};
use vibc::model::Overrides;

/// The equations of a model as text; the messages if there are none.
pub fn text_of(name: &str, model: &str) -> String {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model(name, model));
    crate::examples::add_used_files(&mut sources, file);
    let outcome = vibc::equations(&sources, file, &Overrides::default());
    match outcome.answer {
        Some(answer) => equations::text(&equations::document(&answer), vibc::backend::report::WIDTH),
        None => outcome.diagnostics.iter().map(|d| format!("{}: {}\n", d.code.0, d.message)).collect(),
    }
}

pub fn example(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name);
    text_of(name, &std::fs::read_to_string(path).expect("an example"))
}

/// Whether a line of the text is this formula, ignoring blanks at its ends.
pub fn says(text: &str, line: &str) -> bool {
    text.lines().any(|found| found.trim() == line)
}

/// The course's solution: (m1 + m2) x" + m2 L/2 (theta" cos theta - theta'^2 sin theta) + b x' + k x = F and
/// m2 L^2/3 theta" + m2 L/2 x" cos theta + m2 g L/2 sin theta = 0, and both linearised.
#[test]
fn the_cart_has_the_equations_of_the_course() {
    let text = example("cart.vib");
    for line in [
        "T = 1/2 (m1 + m2) x'^2 + 1/2 m2 L cos(theta) x' theta' + 1/6 m2 L^2 theta'^2",
        "V = 1/2 k x^2 - 1/2 m2 g L cos(theta)",
        "D = 1/2 b x'^2",
        "Q_x = F",
        "(m1 + m2) x'' + m2 L/2 cos(theta) theta'' - m2 L/2 sin(theta) theta'^2 + b x' + k x = F",
        "m2 L/2 cos(theta) x'' + m2 L^2/3 theta'' + m2 g L/2 sin(theta) = 0",
        "(m1 + m2) x'' + m2 L/2 theta'' + b x' + k x = F",
        "m2 L/2 x'' + m2 L^2/3 theta'' + m2 g L/2 theta = 0",
    ] {
        assert!(says(&text, line), "{line} is not in\n{text}");
    }
}

/// Den Hartog's machine with a rotating unbalance: m x'' + c x' + k x = m_u e omega^2 sin(omega t), and the run-up of a rotor with its angle.
#[test]
fn a_rotating_unbalance_is_the_force_of_the_textbook() {
    let machine = |speed: &str| {
        let model = format!(
            "param m = 50 kg\nparam m_u = 0.4 kg\nparam e = 2 mm\nparam k = 2 MN/m\nparam c = 1 kN*s/m\nparam omega = 1500 rpm\nparam f = 25 Hz\n\
             body frame {{ mass = m, moves y }}\nspring s: ground -- frame {{ k = k }}\ndamper d: ground -- frame {{ c = c }}\n\
             unbalance U: frame {{ me = m_u * e{speed} }}\noutput y = frame.y\n"
        );
        text_of("machine.vib", &model)
    };
    for (speed, lines) in [
        (
            ", speed = omega",
            &["Q_y = m_u e omega^2 sin(omega t)", "m y'' + c y' + k y = m_u e omega^2 sin(omega t)"][..],
        ),
        (", speed = omega, clockwise", &["m y'' + c y' + k y = -m_u e omega^2 sin(omega t)"]),
        (", speed = f", &["omega_U = 2 pi f    = 157.080 1/s", "m y'' + c y' + k y = m_u e omega_U^2 sin(omega_U t)"]),
        (", speed = 25 Hz", &["omega_U = 50 pi    = 157.080 1/s"]),
        ("", &["m y'' + c y' + k y = -m_u e cos(phi_U) phi_U'' + m_u e sin(phi_U) phi_U'^2"]),
    ] {
        let text = machine(speed);
        for line in lines.iter().chain(&["y/U.y = -s^2/(m s^2 + c s + k)"]) {
            assert!(says(&text, line), "{line} is not in\n{text}");
        }
    }
}

/// The stroke of a damper on a storey answers the storey's acceleration alone; a beam that is held alike on both sides does not tilt under its own
/// force. The masses are roots, so that no coefficient is a fraction.
#[test]
fn numerators_that_cancel_are_zero() {
    let absorber = text_of(
        "absorber.vib",
        "param m = 3 kg * sqrt(2)\nparam k = m * (2 * pi * 3 Hz)^2\nbody lower { mass = 5 kg, moves x }\nbody upper { mass = 2 * m, moves x }\n\
         body machine { mass = m, moves x }\nspring a: ground -- lower { k = 40 * k }\nspring b: lower -- upper { k = 30 * k }\n\
         spring c: upper -- machine { k = k }\ndamper d: upper -- machine { c = 2 N*s/m * pi }\nforce F: upper along x\noutput stroke = c.stretch\n",
    );
    let line = absorber.lines().find(|line| line.contains("stroke/F = ")).expect("a transfer function");
    assert!(line.contains(" s^2)/Delta") && !line.contains('≤'), "{line}");
    let beam = text_of(
        "beam.vib",
        "param w = sqrt(2) * 1 /s\nbody deck { mass = 10 kg, inertia = 1 kg*m^2, at = (0, 0), moves y, turns }\nbody l { mass = 1 kg, moves y }\n\
         body r { mass = 1 kg, moves y }\nspring a: ground@(-1 m, -1 m) -- deck@(-1 m, 0) { k = 3 kg * w^2, along = y }\n\
         spring b: ground@(1 m, -1 m) -- deck@(1 m, 0) { k = 3 kg * w^2 * pi / pi, along = y }\nspring c: l -- deck@(-1 m, 0) { k = 1 kg * w * pi, along = y }\n\
         spring d: r -- deck@(1 m, 0) { k = 1 kg * w * pi, along = y }\nforce F: deck along y\noutput tilt = deck.angle\noutput y = deck.y\n"
            .replace("* w * pi", "* w^2 * pi").as_str(),
    );
    assert!(says(&beam, "tilt/F = 0"), "{beam}");
}

/// Lever arms r and tensions by length q of the lines that are named, by the geometry at rest.
#[test]
fn names_of_levers_and_tensions_have_the_values_of_the_geometry() {
    let (_, model) = SCENES.iter().find(|(name, _)| *name == "braced_rod").expect("a scene");
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("braced_rod", *model));
    let equations = vibc::equations(&sources, file, &Overrides::default()).answer.expect("equations");
    let rest = |index: usize| {
        let found = equations.rest.moved.iter().find(|(place, ..)| *place == index);
        found.map_or(0.0, |(.., value)| value.to_f64())
    };
    let (theta, x) = (rest(0), rest(1));
    assert!(theta != 0.0 && x != 0.0, "the scene rests away from its drawing");
    let arm = (1.2 * theta.cos() + 0.8 * theta.sin(), 1.2 * theta.sin() - 0.8 * theta.cos());
    let (tip, drawn, trolley) = ((0.1 + arm.0, arm.1), (1.3, -0.8), (0.3 + x, 0.4));
    let apart = |a: (f64, f64), b: (f64, f64)| (b.0 - a.0, b.1 - a.1);
    let size = |d: (f64, f64)| d.0.hypot(d.1);
    // Each line from its fixed or first end, as it rests and as it is drawn, and how its second and first ends move by theta and x.
    let turn = (-arm.1, arm.0);
    let (still, along) = ((0.0, 0.0), (1.0, 0.0));
    let lines = [
        ("s", 300.0, apart((1.9, 0.45), tip), apart((1.9, 0.45), drawn), [(turn, "s"), (still, "")]),
        ("t", 40.0, apart((0.7, 0.0), trolley), apart((0.7, 0.0), (0.3, 0.4)), [(still, ""), (along, "t")]),
        ("u", 20.0, apart(tip, trolley), apart(drawn, (0.3, 0.4)), [((-turn.0, -turn.1), "u,theta"), (along, "u,x")]),
    ];
    let mut expected = Vec::new();
    for (name, k, now, before, moves) in lines {
        expected.push((format!("l_{name},0"), size(now)));
        expected.push((format!("q_{name}"), k * (size(now) - size(before)) / size(now)));
        for (moved, index) in moves.into_iter().filter(|(_, index)| !index.is_empty()) {
            expected.push((format!("r_{index}"), (now.0 * moved.0 + now.1 * moved.1) / size(now)));
        }
    }
    let squares = equations.linear.lengths.iter().map(|(name, square)| (name, square.root()));
    let forms: Vec<_> = squares.chain(equations.linear.parts.iter().map(|(name, form)| (name, form.clone()))).collect();
    assert_eq!(forms.len(), expected.len());
    for (name, value) in expected {
        let (symbol, form) =
            forms.iter().find(|(symbol, _)| equations.names.label(**symbol).plain() == name).expect(&name);
        // What is printed, and the value that entries are computed with.
        for found in [equations.names.value_of(form), equations.names.value(**symbol).cloned()] {
            let found = found.expect("a value").to_f64();
            assert!((found - value).abs() < 1e-12 * (1.0 + value.abs()), "{name}: {found}, not {value}");
        }
    }
}

/// Scenes beside the examples: what a course asks for, and what is hard to write well.
const SCENES: [(&str, &str); 30] = [
    (
        "pendulum",
        "param m = 1 kg\nparam L = 1 m\ngravity 9.81 m/s^2\nbody bob { mass = m, inertia = 0 kg*m^2, at = (0, -L) }\npivot p: ground@(0, 0) -- bob\n",
    ),
    (
        "compound_pendulum",
        "param m = 2 kg\nparam J = 0.5 kg*m^2\nparam d = 0.4 m\ngravity 9.81 m/s^2\nbody b { mass = m, inertia = J about (0, 0), at = (0, -d) }\npivot p: ground@(0, 0) -- b\n",
    ),
    (
        "hanging_mass",
        "param m = 1 kg\nparam k = 20 N/m\ngravity 9.81 m/s^2\nbody b { mass = m, moves y, at = (0, 0) }\nspring s: ground@(0, 1 m) -- b { k = k }\n",
    ),
    (
        "bead",
        "param m = 1 kg\nparam J = 0.4 kg*m^2\nparam k = 20 N/m\nparam r0 = 0.5 m\ngravity 9.81 m/s^2\nbody arm { mass = 3 kg, inertia = J, at = (0, 0) }\nbody bead { mass = m, at = (0, -r0), inertia = 0 kg*m^2 }\npivot p: ground@(0, 0) -- arm\nslide g: arm -- bead along (0, -1)\nspring s: arm@(0, 0) -- bead { k = k, free_length = r0 }\n",
    ),
    (
        "rolling_disk",
        "param m = 2 kg\nparam r = 0.3 m\nparam k = 100 N/m\nbody wheel { mass = m, shape = disk(r), moves x, turns, at = (0, r) }\ncouple roll: wheel.angle = -wheel.x / r\nspring s: ground@(-1 m, r) -- wheel { k = k }\nforce F: wheel along x\noutput x = wheel.x\n",
    ),
    (
        "leaning_rod",
        "param m = 1 kg\nparam L = 1 m\nparam k = 30 N*m/rad\ngravity 9.81 m/s^2\nbody rod { mass = m, shape = rod((0, 0), (0.5 * L, 0.8 * L)) }\npivot p: ground@(0, 0) -- rod\nspring s: ground -- rod { k = k }\n",
    ),
    (
        "as_drawn",
        "param m = 1 kg\nparam L = 2 m\ngravity 9.81 m/s^2\nrest as drawn\nbody rod { mass = m, shape = rod((0, 0), (L, 0)) }\npivot p: ground@(0, 0) -- rod\nspring s: ground@(L, 1 m) -- rod@(L, 0) { k = 50 N/m }\n",
    ),
    (
        "rayleigh",
        "param m = 1 kg\nparam k = 20 N/m\nparam alpha = 0.1 /s\nparam beta = 1e-4 s\nbody b { mass = m, moves x }\nspring s: ground -- b { k = k }\ndamping rayleigh(alpha, beta)\n",
    ),
    (
        "modal",
        "param m = 1 kg\nparam k = 20 N/m\nbody b { mass = m, moves x }\nspring s: ground -- b { k = k }\ndamping modal 2 %\n",
    ),
    (
        "base_pendulum",
        "param m = 1 kg\nparam L = 1 m\ngravity 9.81 m/s^2\nbase hand { moves x, at = (0, 0) }\nbody bob { mass = m, inertia = 0 kg*m^2, at = (0, -L) }\npivot p: hand@(0, 0) -- bob\noutput a = bob.angle\n",
    ),
    (
        "oblique",
        "param m = 1 kg\nparam k = 20 N/m\nparam alpha = 30 deg\nbody b { mass = m, moves along (cos(alpha), sin(alpha)) }\nspring s: ground -- b { k = k, along = x }\n",
    ),
    (
        "shaft",
        "param J1 = 1 kg*m^2\nparam J2 = 2 kg*m^2\nparam kt = 50 N*m/rad\nparam ct = 0.1 N*m*s/rad\nbody a { inertia = J1, turns }\nbody b { inertia = J2, turns }\nspring s: a -- b { k = kt }\ndamper d: a -- b { c = ct }\ntorque M: a\noutput x = b.angle\n",
    ),
    (
        "string",
        "param m = 1 kg\nparam T = 100 N\nparam a = 0.5 m\nbody b { mass = m, moves y, at = (0, 0) }\nspring l: ground@(-a, 0) -- b { k = 0 N/m, preload = T }\nspring r: ground@(a, 0) -- b { k = 0 N/m, preload = T }\n",
    ),
    (
        "turning_inerter",
        "param m = 1 kg\nparam L = 1 m\nparam a = 0.4 m\nparam b = 2 kg\ngravity 9.81 m/s^2\nbody rod { mass = m, shape = rod((0, 0), (0, -L)) }\npivot p: ground@(0, 0) -- rod\ninerter q: ground@(a, -L) -- rod@(0, -L) { b = b }\noutput angle = rod.angle\n",
    ),
    (
        "crank_and_piston",
        "param r = 0.1 m\nparam h = 0.24 m\nparam m = 1 kg\nparam J = 0.01 kg*m^2\nparam kt = 100 N*m/rad\nbody crank { mass = m, inertia = J, at = (0, 0) }\nbody rod { mass = m, shape = rod((0, r), (h, 0)) }\nbody piston { mass = m, moves x, at = (h, 0) }\npivot a: ground@(0, 0) -- crank\npivot b: crank@(0, r) -- rod\npivot c: rod@(h, 0) -- piston\nspring s: ground -- crank { k = kt }\nforce F: piston along x\noutput x = piston.x\n",
    ),
    (
        "three_links",
        "param m = 1 kg\nparam L = 1 m\ngravity 9.81 m/s^2\nbody a { mass = m, inertia = 0 kg*m^2, at = (0, -L) }\nbody b { mass = m, inertia = 0 kg*m^2, at = (0, -2 * L) }\nbody c { mass = m, inertia = 0 kg*m^2, at = (0, -3 * L) }\npivot p: ground@(0, 0) -- a\npivot q: a@(0, -L) -- b\npivot r: b@(0, -2 * L) -- c\n",
    ),
    (
        "braced_rod",
        "param m = 2 kg\nparam a = 0.3 m\nparam b = 0.7 m\nparam h = 0.4 m\ngravity 9.81 m/s^2\nbody rod { mass = m, shape = rod((0.1 m, 0), (1.3 m, -0.8 m)) }\npivot p: ground@(0.1 m, 0) -- rod\nspring s: ground@(1.9 m, 0.45 m) -- rod@(1.3 m, -0.8 m) { k = 300 N/m }\nbody box { mass = 3 kg, moves x, at = (a, h) }\nspring t: ground@(b, 0) -- box { k = 40 N/m }\nspring u: rod@(1.3 m, -0.8 m) -- box { k = 20 N/m }\nforce F: box along x\noutput x = box.x\ndamping rayleigh(0.1 /s, 1e-4 s)\n",
    ),
    (
        "swing_door",
        "param J = 3 kg*m^2\nparam L = 0.9 m\nparam a = 0.4 m\nparam k = 60 N/m\nparam c = 8 N*s/m\nparam l0 = 0.3 m\nbody door { mass = 12 kg, inertia = J about (0, 0), at = (L / 2, 0) }\npivot p: ground@(0, 0) -- door\nspring s: ground@(a, L) -- door@(L, 0) { k = k, free_length = l0 }\ndamper d: ground@(0, -a) -- door@(L, 0) { c = c }\ntorque M: door\noutput theta = door.angle\n",
    ),
    (
        "trolley_and_spring",
        "param m = 4 kg\nparam k = 90 N/m\nparam a = 0.5 m\nparam h = 0.6 m\nparam x0 = 0.2 m\nbody trolley { mass = m, moves x, at = (x0, 0) }\nspring s: ground@(a, h) -- trolley { k = k }\nspring t: ground@(a, -h) -- trolley { k = k }\n",
    ),
    (
        "placed",
        "component car(part ahead, m = 20 t, k = 400 kN/m) {\nbody box { mass = m, moves x }\nspring coupler: ahead -- box { k = k, along = x }\noutput pull = coupler.force\n}\nbody engine { mass = 80 t, moves x }\nplace first = car(ahead = engine)\nplace second = car(ahead = first.box, m = 30 t)\nforce F: engine along x\n",
    ),
    (
        "placed_turned",
        "component arm(m = 2 kg, L = 0.6 m, k = 50 N/m) {\nbody rod { mass = m, shape = rod((0, 0), (0, -L)) }\npivot p: ground@(0, 0) -- rod\nspring s: ground@(0.4 m, -L) -- rod@(0, -L) { k = k, along = x }\n}\ngravity 9.81 m/s^2\nplace hanging = arm() at (0, 0)\nplace lying = arm(m = 1 kg) at (2 m, 0) turned 90 deg\nplace slanted = arm() at (4 m, 0) turned 30 deg\n",
    ),
    (
        "placed_mirrored",
        "component leg(part deck, m = 5 kg, k = 2 kN/m, c = 30 N*s/m) {\nbody foot { mass = m, moves y, at = (0.5 m, -1 m) }\nspring s: foot -- deck@(0.5 m, 0) { k = k, along = y }\ndamper d: foot -- deck@(0.5 m, 0) { c = c, along = y }\nspring t: ground@(0.5 m, -1.5 m) -- foot { k = 10 * k, along = y }\n}\nparam M = 100 kg\nparam J = 8 kg*m^2\nbody deck { mass = M, inertia = J, moves y, turns, at = (0, 0) }\nplace right = leg(deck = deck) at (0, 0)\nplace left = leg(deck = deck) at (0, 0) mirrored x\nforce F: deck along y\noutput tilt = deck.angle\n",
    ),
    (
        "placed_nested",
        "component cell(part from, m = 1 kg, k = 10 N/m) {\nbody mass { mass = m, moves x }\nspring s: from -- mass { k = k, along = x }\n}\ncomponent pair(part from, k = 10 N/m) {\nplace a = cell(from = from, k = k)\nplace b = cell(from = a.mass, k = 2 * k)\n}\nplace one = pair(from = ground)\nplace two = pair(from = one.b.mass, k = 5 N/m) turned 90 deg\n",
    ),
    (
        "placed_from_library",
        "use \"std/quarter_car.vib\"\nuse \"std/absorber.vib\"\nparam M = 400 kg\nbody car { mass = M, moves y, at = (0, 0.5 m) }\nplace corner = quarter_car(car = car) at (0, 0)\nbody tower { mass = 1 t, moves x }\nspring s: ground -- tower { k = 40 kN/m }\nplace damping = absorber(main = tower, m = 20 kg, main_mass = 1 t, f = 1 Hz)\n",
    ),
    (
        "unbalances",
        "param m = 50 kg\nparam J = 2 kg*m^2\nparam e = 2 mm\nparam m_u = 0.4 kg\nparam h = 0.3 m\nparam k = 200 kN/m\nparam f = 20 Hz\ngravity 9.81 m/s^2\nbody frame { mass = m, inertia = J, at = (0, 0), moves x y, turns }\nspring a: ground@(-0.5 m, -1 m) -- frame@(-0.5 m, 0) { k = k, along = y }\nspring b: ground@(0.5 m, -1 m) -- frame@(0.5 m, 0) { k = k, along = y }\nspring c: ground@(-1.5 m, 0) -- frame@(-0.5 m, 0) { k = k, along = x }\nunbalance U: frame@(0, h) { me = m_u * e, speed = f, clockwise }\nunbalance V: frame@(0, h) { me = m_u * e, speed = f }\nunbalance W: frame@(0, 0) { me = 3 g*m }\noutput y = frame.y\noutput p = frame.angle\n",
    ),
    (
        "placed_unbalances",
        "gravity 9.81 m/s^2\ncomponent rotor(part p, e = 3 mm, f = 10 Hz) {\n  unbalance U: p@(0.2 m, 0) { me = 0.5 kg * e, speed = f, clockwise }\n}\nparam L = 1 m\nparam t = 3 m\nbody rod { mass = 2 kg, shape = rod((0, 0), (0, -L)) }\nbody box { mass = t*1 kg/m, moves x, at = (4 m, 0) }\nspring s: ground@(3 m, 0) -- box { k = 300 N/m }\npivot p: ground@(0, 0) -- rod\nunbalance V: rod@(0, -L) { me = 0.1 kg*m, speed = 3 rad/s }\nplace left = rotor(p = rod) at (0, 0) mirrored x\nplace right = rotor(p = box, f = 11 Hz) at (4 m, 0) turned 30 deg\nunbalance W: box { me = 0.1 kg*m }\nunbalance Z: box { me = 0 }\noutput a = rod.angle\noutput x = box.x\n",
    ),
    (
        "belt",
        "param r1 = 0.1 m\nparam r2 = 0.25 m\nparam m1 = 2 kg\nparam m2 = 5 kg\nparam k = 200 kN/m\nparam T = 80 N\nbody motor { mass = m1, shape = disk(r1), at = (0, 0), turns }\nbody pump { mass = m2, shape = disk(r2), at = (0.7 m, 0), turns }\nbelt r: motor -- pump { k = k, preload = T }\ntorque M: motor\noutput pull = r.force\n",
    ),
    (
        "belt_on_arm",
        "param r1 = 0.1 m\nparam r2 = 0.05 m\nparam L = 0.5 m\nparam k = 200 kN/m\nparam kt = 10 N*m/rad\nbody arm { mass = 2 kg, shape = rod((0, 0), (L, 0)) }\npivot p: ground@(0, 0) -- arm\nbody sun { mass = 3 kg, shape = disk(r1), at = (0, 0), turns }\nbody planet { mass = 1 kg, shape = disk(r2), at = (L, 0) }\npivot q: arm@(L, 0) -- planet\nspring s: ground -- arm { k = kt }\nspring t: ground -- sun { k = kt }\nbelt b: sun -- planet { k = k, preload = 50 N }\n",
    ),
    (
        "belt_crossed_on_rails",
        "param r1 = 0.1 m\nparam r2 = 0.2 m\nparam m = 3 kg\nparam k = 20 kN/m\nparam T = 80 N\nparam a = 0.8 m\nbody motor { mass = 2 kg, shape = disk(r1), at = (0, 0), turns }\nbody pump { mass = m, shape = disk(r2), at = (a, 0), moves x y, turns }\nbelt b: motor -- pump { k = k, preload = T, crossed }\nspring u: ground -- pump { k = 5 kN/m, along = y }\nspring w: ground@(2*a, 0) -- pump { k = 5 kN/m, along = x }\nrest as drawn\noutput stretch = b.stretch\n",
    ),
    (
        "belt_at_another_rest",
        "gravity 9.81 m/s^2\nbody motor { mass = 1 kg, shape = disk(0.1 m), at = (0, 0), moves x, turns }\nbody pump { mass = 1 kg, shape = disk(0.2 m), at = (0.6 m, 0.3 m), moves y, turns }\nspring s: ground -- motor { k = 3 kN/m, along = x }\nspring u: ground -- pump { k = 5 kN/m, along = y }\nspring t: ground -- motor { k = 40 N*m/rad }\nspring v: ground -- pump { k = 60 N*m/rad }\nbelt r: motor -- pump { k = 2 kN/m, preload = 90 N }\n",
    ),
];

/// The names of all examples.
fn examples() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let files = std::fs::read_dir(folder).expect("examples").map(|entry| entry.expect("an entry").path());
    let models = files.filter(|path| path.extension().is_some_and(|extension| extension == "vib"));
    let mut names: Vec<String> =
        models.filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned())).collect();
    names.sort();
    assert!(names.len() >= 31, "{names:?}");
    names
}

/// Outputs by name.
fn outputs() -> Vec<(String, String)> {
    let examples = examples().into_iter().map(|name| (name.clone(), example(&format!("{name}.vib"))));
    let scenes = SCENES.iter().map(|(name, model)| (name.to_string(), text_of(name, model)));
    examples.chain(scenes).collect()
}

#[test]
fn outputs_match_their_declarations() {
    for (name, text) in outputs() {
        insta::with_settings!({
            snapshot_path => "snapshots/equations",
            prepend_module_to_snapshot => false,
            omit_expression => true,
        }, {
            insta::assert_snapshot!(name, text);
        });
    }
}

#[test]
fn unused_notation_is_not_reported() {
    let mut wrong = Vec::new();
    for (name, text) in outputs() {
        for formula in linter::formulas(&text) {
            wrong.extend(linter::faults(&formula).into_iter().map(|fault| format!("{name}: {fault} in {formula}")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The printed solutions of the course's problem set, and what its examples answer.
#[test]
fn the_six_problems_have_their_equations() {
    for (name, lines) in [
        ("isolation_table.vib", &["m y_table'' + m wn^2 y_table = m wn^2 v", "y/floor = wn^2/(s^2 + wn^2)"][..]),
        ("light_station.vib", &["m x'' + 2 zeta m wn x' + m wn^2 x = machine"]),
        ("hinged_body.vib", &["J theta'' + kt theta = T"]),
        ("stacked_blocks.vib", &["m x'' + 2 zeta sqrt(m k) x' + k x = F", "m = small + large    = 11 kg"]),
        ("mortar.vib", &["m y'' + c y' + k y = 0", "zeta = c/(2 sqrt(m k)) = 0.0100002"]),
        ("double_pendulum.vib", &["2 m l^2 theta_upper'' + m l^2 theta_lower'' + 2 m g l theta_upper = l push"]),
        ("four_bar.vib", &["(13 m + 10 l)/3 theta_left'' + 3 g (m + l) theta_left = 2 F"]),
    ] {
        let text = example(name);
        for line in lines {
            assert!(says(&text, line), "{name}: {line} is not in\n{text}");
        }
    }
}

/// A knot without mass between a spring and a damper: one natural frequency, sqrt(k/m), and no division by the mass of the knot. A
/// train that nothing holds: the denominator has the factor s^2, and so have the forces in it.
#[test]
fn motions_without_inertia_and_rigid_motions_leave_no_zeros() {
    let hall = example("test_hall.vib");
    assert!(hall.contains("omega_instrument = 0.2 sqrt(mount.k) = 17.8885    rad/s"), "{hall}");
    assert!(!hall.contains("a_4,instrument"), "{hall}");
    let train = example("train.vib");
    assert!(train.contains("2.71712e39 s^2\n") && !train.contains('≤'), "{train}");
}

/// omega from the closed form agrees with `analyze`: 2.15818 and 3.74715 rad/s.
#[test]
fn closed_forms_have_the_values_of_the_analysis() {
    let text = example("cart.vib");
    assert!(text.contains("omega_1 = 2.15818    rad/s") && text.contains("omega_2 = 3.74715    rad/s"), "{text}");
    assert!(says(&text, "a_4 = m2 L^2 (4 m1 + m2)/12"), "{text}");
}

#[test]
fn equations_that_are_too_large_are_refused_with_their_size() {
    let chain = "body m[1] { mass = 1 kg, moves x }\nrepeat i in 2..250 {\nbody m[i] { mass = 1 kg, moves x }\nspring s[i]: m[i-1] -- m[i] { k = 1 N/m }\n}\n";
    assert_eq!(
        text_of("chain", chain),
        "vib::equations::too_large: equations of 250 coordinates are not written in symbols; the most are 200\n"
    );
}

#[test]
fn every_format_is_written_and_nothing_in_it_is_executed() {
    let mut sources = Sources::new();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/cart.vib");
    let file = sources.add(SourceFile::model("cart", std::fs::read_to_string(path).expect("an example")));
    let answer = vibc::equations(&sources, file, &Overrides::default()).answer.expect("equations");
    let document = equations::document(&answer);
    let latex = equations::latex(&document);
    assert!(
        latex.contains(r"\left(m_{1} + m_{2}\right) \, \ddot{x} + \frac{m_{2} \, L}{2} \, \ddot{\theta}"),
        "{latex}"
    );
    let typst = equations::typst(&document);
    assert!(typst.contains("dot.double(θ)"), "{typst}");
    let page = equations::mathml(&document);
    assert!(page.contains("<mover accent=\"true\"><mi>θ</mi><mo>¨</mo></mover>"), "{page}");
    let json: serde_json::Value = serde_json::from_str(&equations::json(&answer, &document)).expect("JSON");
    assert_eq!(json["schema"], "vibc-equations-2");
    // 2/3 is the nearest binary64 number, and half a unit in its last place the bound.
    let entry = &json["mass"][1][1];
    assert_eq!(entry["text"], "m2 L^2/3");
    let (value, bound) = (entry["value"].as_f64().expect("a number"), entry["bound"].as_f64().expect("a bound"));
    assert!(value == 2.0 / 3.0 && bound > 0.0 && bound < 2f64.powi(-53), "{entry}");
    assert_eq!(json["coordinates"][1]["role"], "independent");
    assert_eq!(json["transfer_functions"][1]["numerator"][2]["text"], "-6");
}

/// Cranks in a row, each joined to the next by a bar: loops that follow each other. What is too long is refused with its size, and
/// takes no time without limit.
#[test]
fn loops_that_are_not_solved_in_symbols_say_why() {
    let cranks = |count: usize| {
        let mut model = String::from("gravity 9.81 m/s^2\n");
        for i in 0..count {
            let (foot, tip) = (3 * i, format!("({} m, -{} m)", 3 * i + 1, 2 + i % 2));
            model += &format!(
                "body c{i} {{ mass = 1 kg, shape = rod(({foot} m, 0), {tip}) }}\npivot g{i}: ground@({foot} m, 0) -- c{i}\n"
            );
            if i > 0 {
                let last = format!("({} m, -{} m)", 3 * i - 2, 2 + (i - 1) % 2);
                model += &format!(
                    "body b{i} {{ mass = 1 kg, shape = rod({last}, {tip}) }}\npivot l{i}: c{}@{last} -- b{i}\npivot r{i}: b{i}@{tip} -- c{i}\n",
                    i - 1
                );
            }
        }
        text_of("cranks", &model)
    };
    assert!(cranks(2).contains("the multipliers drop"), "one loop");
    let long = cranks(5);
    assert!(
        long.starts_with("vib::equations::too_large: the constraint equations of these loops would have ")
            || long.contains("The equations stay with their multipliers:"),
        "{long}"
    );
    assert!(
        cranks(9).starts_with("vib::equations::too_large: 16 constraint equations"),
        "sixteen dependent coordinates"
    );
}

/// Terms of energies, equations and matrices: they grow with the square of a hanging chain's links and in proportion to a row of masses.
#[test]
fn formulas_grow_as_polynomials() {
    let links = |n: usize| {
        let mut model = String::from("param m = 1 kg\nparam L = 1 m\ngravity 9.81 m/s^2\n");
        for i in 1..=n {
            let carrier = if i == 1 { "ground".to_string() } else { format!("b{}", i - 1) };
            model += &format!(
                "body b{i} {{ mass = m, inertia = 0 kg*m^2, at = (0, -{i} * L) }}\npivot p{i}: {carrier}@(0, -{} * L) -- b{i}\n",
                i - 1
            );
        }
        model
    };
    let row = |n: usize| {
        format!(
            "param m = 1 kg\nparam k = 1 N/m\nbody b[1] {{ mass = m, moves x }}\nrepeat i in 2..{n} {{\nbody b[i] {{ mass = m, moves x }}\nspring s[i]: b[i-1] -- b[i] {{ k = k }}\n}}\n"
        )
    };
    let counts = |model: &dyn Fn(usize) -> String| [4, 8, 16].map(|n| terms_of(&model(n)) as f64);
    // (8/4)^2 and (16/8)^2 with what constants and lower powers may add or take away.
    let [small, middle, large] = counts(&links);
    assert!(middle / small < 4.2 && large / middle < 4.2, "links: {small} {middle} {large}");
    let [small, middle, large] = counts(&row);
    assert!(middle / small < 2.4 && large / middle < 2.4, "row: {small} {middle} {large}");
}

fn terms_of(model: &str) -> usize {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("growth", model));
    let answer = vibc::equations(&sources, file, &Overrides::default()).answer.expect("equations");
    let energies = answer.energies.kinetic.terms().len();
    let moving = answer.nonlinear.iter().map(|equation| equation.plain.terms().len()).sum::<usize>();
    let linear = [&answer.linear.mass, &answer.linear.damping, &answer.linear.stiffness];
    let entries = linear.into_iter().flatten().flatten().map(|entry| entry.sum.terms().len()).sum::<usize>();
    energies + moving + entries
}

/// A number that is its own closed form stands once.
#[test]
fn a_number_is_not_said_twice() {
    let model = "body a { mass = 1 kg, moves x }\nspring s: ground -- a { k = 40000 N/m }\ndamper d: ground -- a { c = 20 N*s/m }\n";
    let out = crate::program::text(model, &["equations"]);
    assert!(out.contains("omega = 200"), "{out}");
    assert!(!out.contains("= 200 = 200") && !out.contains("= 0.05 = 0.05"), "{out}");
}
