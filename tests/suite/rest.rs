//! The rest of scenes: drawings declared to be the rest, rests far from the drawing, published cases drawn rotated.

use super::ask::{Answer, ask, try_ask};
use vibc::Outcome;
use vibc::analysis::ModeKind;
use vibc::backend::{ReportOptions, json, report};
use vibc::base::{Diagnostic, Number, Rational, SourceFile, Sources};
use vibc::model::Overrides;
use vibc::system::Form;

/// The exact entries of a matrix, written as fractions.
fn entries(form: &Form, n: usize) -> Vec<Vec<String>> {
    let written = |entry: &Number| match entry.exact().and_then(Rational::to_fraction) {
        Some((n, 1)) => n.to_string(),
        Some((n, d)) => format!("{n}/{d}"),
        None => format!("about {}", entry.to_f64()),
    };
    form.entries(n).iter().map(|row| row.iter().map(written).collect()).collect()
}

fn tensions(answer: &Answer) -> Vec<f64> {
    answer.lowered.rest.tensions.iter().map(|found| found.tension.to_f64()).collect()
}

fn close(found: &[f64], truth: &[f64], tolerance: f64) {
    assert_eq!(found.len(), truth.len());
    for (found, truth) in found.iter().zip(truth) {
        assert!((found - truth).abs() <= tolerance * truth.abs().max(1e-3), "{found:e} against {truth:e}");
    }
}

fn errors(text: &str) -> Vec<Diagnostic> {
    match try_ask(text) {
        Ok(_) => panic!("accepted:\n{text}"),
        Err(found) => found.into_iter().filter(Diagnostic::is_error).collect(),
    }
}

/// A weight of 2 g between two slanted springs and an upright one: with the unit vectors (-+1, 1)/sqrt(2) and (0, 1),
/// the least squares are t = (1/2, 1/2, 1/sqrt 2) times the force that balances 19.62 N.
const HELD: &str = "gravity 9.81 m/s^2
    rest as drawn
    body m { mass = 2 kg, at = (0, 0), moves x y }
    spring a: ground@(-1 m, 1 m) -- m { k = 100 N/m }
    spring b: ground@(1 m, 1 m) -- m { k = 100 N/m }
    spring c: ground@(0, 1 m) -- m { k = 300 N/m }";

#[test]
fn the_least_tensions_hold_a_drawing_exactly() {
    let answer = ask(HELD);
    let rest = &answer.lowered.rest;
    assert!(rest.is_proven() && rest.residual == 0.0 && rest.displacement.iter().all(Number::is_zero));
    close(&tensions(&answer), &[9.81 / 2f64.sqrt(), 9.81 / 2f64.sqrt(), 9.81], 1e-15);
    // k/2 of each slanted spring; T/L across: 9.81 (1/2)(1/sqrt 2) N/m of each slanted one along x and y, 9.81 N/m of
    // the upright one along x. All of these are rational, although the tensions are not.
    let (x, y) = (Rational::new(100_000 + 4905 + 9810, 1000), Rational::new(100_000 + 4905 + 300_000, 1000));
    let expected = |value: &Rational| {
        let (n, d) = value.to_fraction().expect("small numbers");
        if d == 1 { n.to_string() } else { format!("{n}/{d}") }
    };
    assert_eq!(entries(&answer.lowered.system.k, 2), [[expected(&x), "0".into()], ["0".into(), expected(&y)]]);
}

/// The scene with those tensions as preloads: the general method finds the rest as drawn.
#[test]
fn the_tensions_found_are_those_that_preloads_would_be() {
    let preloaded = HELD
        .replace("rest as drawn", "")
        .replace("k = 100 N/m", "k = 100 N/m, preload = 9.81 N / sqrt(2)")
        .replace("k = 300 N/m", "k = 300 N/m, preload = 9.81 N");
    close(&ask(HELD).omegas(), &ask(&preloaded).omegas(), 1e-15);
}

/// Compares with the pseudo-inverse of the matrix of unit vectors (singular values, binary64).
#[test]
fn tensions_have_the_least_norm() {
    let anchors = [(3.0, 4.0), (-2.0, 1.0), (0.5, -2.0), (1.0, 1.0), (-4.0, -3.0), (0.25, 2.0)];
    let mut text =
        String::from("gravity (1 m/s^2, -9.81 m/s^2)\nrest as drawn\nbody m { mass = 3 kg, at = (0, 0), moves x y }\n");
    for (i, (x, y)) in anchors.iter().enumerate() {
        text += &format!("spring s{i}: m -- ground@({x} m, {y} m) {{ k = 1000 N/m }}\n");
    }
    // A tension pulls the mass towards the anchor: the sum of the pulls balances the weight.
    let unit = |i: usize, axis: usize| {
        let (x, y): (f64, f64) = anchors[i];
        [x, y][axis] / x.hypot(y)
    };
    let pulls = nalgebra::DMatrix::from_fn(2, anchors.len(), |axis, i| unit(i, axis));
    let weight = nalgebra::DVector::from_column_slice(&[-3.0, 3.0 * 9.81]);
    let least = pulls.svd(true, true).solve(&weight, 1e-12).expect("a least solution");
    close(&tensions(&ask(&text)), least.as_slice(), 1e-13);
}

/// A rod on its hinge, held level by a spring at its end: T = m g / 2, and its curvature cancels that of gravity.
#[test]
fn a_turning_body_is_held_as_drawn() {
    let answer = ask("gravity 9.81 m/s^2
        rest as drawn
        body rod { mass = 1 kg, shape = rod((0, 0), (1 m, 0)) }
        pivot p: ground@(0, 0) -- rod
        spring s: rod@(1 m, 0) -- ground@(1 m, 1 m) { k = 3 N/m }");
    close(&tensions(&answer), &[4.905], 1e-16);
    assert_eq!(entries(&answer.lowered.system.k, 1), [["3"]]);
}

/// A four-bar linkage under its weight, held by a diagonal: the tension found is the preload that makes the drawing a
/// rest, and the reactions of the closing joint are included.
#[test]
fn a_loop_is_held_as_drawn() {
    let bars = "gravity 9.81 m/s^2
        body left  { mass = 1 kg, shape = rod((0, 0), (0.5 m, 1 m)) }
        body top   { mass = 2 kg, shape = rod((0.5 m, 1 m), (2 m, 1.5 m)) }
        body right { mass = 1 kg, shape = rod((2 m, 1.5 m), (2.5 m, 0)) }
        pivot a: ground@(0, 0) -- left
        pivot b: left@(0.5 m, 1 m) -- top
        pivot c: top@(2 m, 1.5 m) -- right
        pivot d: right@(2.5 m, 0) -- ground\n";
    // With a rational length the tension is rational too, and as a preload it balances the drawing exactly.
    let spring = "spring s: ground@(1.25 m, 0) -- top@(0.5 m, 1 m) { k = 500 N/m";
    let found = ask(&format!("{bars}rest as drawn\n{spring} }}"));
    let tension = found.lowered.rest.tensions[0].tension.exact().and_then(Rational::to_fraction);
    let (n, d) = tension.expect("a fraction");
    let preloaded = ask(&format!("{bars}{spring}, preload = {n} / {d} * 1 N }}"));
    assert_eq!(entries(&found.lowered.system.k, 1), entries(&preloaded.lowered.system.k, 1));
    assert!(!found.lowered.system.k.entries(1)[0][0].is_zero());
}

/// Given tensions of springs, constant forces and torques are used unchanged.
#[test]
fn given_tensions_and_constant_loads_count() {
    let answer = ask("rest as drawn
        body m { mass = 1 kg, moves x }
        body wheel { inertia = 1 kg*m^2, turns }
        spring a: ground -- m { k = 10 N/m }
        spring b: m -- ground { k = 10 N/m, preload = 4 N }
        spring t: ground -- wheel { k = 2 N*m/rad }
        force F: m along x = constant(5 N)
        torque T: wheel = constant(3 N*m)");
    close(&tensions(&answer), &[9.0, 3.0], 1e-16);
    assert!(answer.lowered.rest.displacement.iter().all(Number::is_zero));
}

#[test]
fn a_drawing_with_irrational_numbers_is_held_within_bounds() {
    let answer = ask("gravity 9.81 m/s^2
        rest as drawn
        param c = cos(20 deg)
        param s = sin(20 deg)
        body rod { mass = 1 kg, shape = rod((0, 0), (1 m * c, 1 m * s)) }
        pivot p: ground@(0, 0) -- rod
        spring t: ground -- rod { k = 30 N*m/rad }");
    let rest = &answer.lowered.rest;
    assert!(rest.is_proven());
    let tension = rest.tensions[0].tension.to_ball();
    let truth = 9.81 / 2.0 * 20f64.to_radians().cos();
    assert!((tension.to_f64().abs() - truth).abs() < 1e-15 * truth && tension.rad < 1e-28);
}

/// Three springs at 120 degrees hold a disk equally along every line, K = 3/2 k, and against rotation by 3 T (r +
/// r²/L); the drawing is as exact at 30 degrees as along the axes, and x, y and the angle are not coupled.
#[test]
fn springs_at_the_angles_of_the_drawing_board_are_exact() {
    for start in [0, 30, 45, 90, 225] {
        let answer = ask(&format!(
            "body disk {{ mass = 2 kg, shape = disk(1 m), at = (0, 0), free }}
            repeat i in 0..2 {{
                point A[i] = (1 m * cos({start} deg + i * 120 deg), 1 m * sin({start} deg + i * 120 deg))
                spring s[i]: ground@(3 * A[i]) -- disk@A[i] {{ k = 100 N/m, preload = 20 N }}
            }}"
        ));
        // 100 along the line, T/L = 10 across it: 3/2 of their sum; T r (L + r)/L = 30 for each spring.
        if start % 30 == 0 {
            let k = entries(&answer.lowered.system.k, 3);
            assert_eq!(k, [["165", "0", "0"], ["0", "165", "0"], ["0", "0", "90"]], "{start}");
        }
        assert!((answer.omegas()[2] - 90f64.sqrt()).abs() < 1e-14);
    }
}

/// A rod that stands upright on a torsional spring: K = k - m g l, in whatever form its direction is written.
#[test]
fn quarter_turns_are_drawn_exactly() {
    for angle in ["90 deg", "pi/2", "2*atan(1)", "acos(0)", "asin(1)", "atan2(3, 0)", "-3*pi/2", "0.25 rev", "450 deg"]
    {
        let answer = ask(&format!(
            "gravity 9.81 m/s^2
            body rod {{ mass = 1 kg, shape = rod((0, 0), (2 m * cos({angle}), 2 m * sin({angle}))) }}
            pivot p: ground@(0, 0) -- rod
            spring t: ground -- rod {{ k = 100 N*m/rad }}"
        ));
        let rest = &answer.lowered.rest;
        assert!(rest.residual == 0.0 && rest.displacement.iter().all(Number::is_zero), "{angle}");
        assert_eq!(entries(&answer.lowered.system.k, 1), [["9019/100"]], "{angle}");
    }
}

/// sqrt(2) + sqrt(3) is the root of 5 + 2 sqrt(6), which balls cannot show: as a position it counts as zero, as a
/// stiffness it leaves open whether the body stays, as a mass it is refused.
#[test]
fn numbers_that_may_be_zero_are_not_called_too_small() {
    let scene = |mass: &str, k: &str, at: &str| {
        format!(
            "param zero = sqrt(2) + sqrt(3) - sqrt(5 + 2 * sqrt(6))
            body b {{ mass = {mass}, at = ({at}, 0), moves x }}
            spring s: ground -- b {{ k = {k}, along = x }}"
        )
    };
    assert_eq!(ask(&scene("1 kg", "4 N/m", "zero * 1 m")).omegas(), [2.0]);
    assert_eq!(ask(&scene("1 kg", "zero * 1 N/m", "0")).modes.list[0].kind, ModeKind::Undetermined);
    let weightless = lowered(&scene("zero * 1 kg", "4 N/m", "0"));
    assert!(vibc::analysis::modes(&weightless.system).is_err());
}

#[test]
fn unbalanceable_loads_are_named() {
    let found = errors(
        "gravity 9.81 m/s^2
        rest as drawn
        body rod { mass = 1 kg, shape = rod((0, 0), (1 m, 0)) }
        pivot p: ground@(0, 0) -- rod
        body box { mass = 1 kg, moves y }
        spring s: box -- ground { k = 3 N/m }",
    );
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].code.0, "vib::rest::unbalanced");
    assert!(found[0].message.contains("`rod.angle`") && !found[0].message.contains("box"), "{}", found[0].message);
    // Two bodies on a spring that nothing holds: the remaining load on one of them is the weight of both.
    let found = errors(
        "gravity 10 m/s^2
        rest as drawn
        body a { mass = 1 kg, moves y }
        body b { mass = 2 kg, moves y }
        spring s: a -- b { k = 3 N/m }",
    );
    assert!(format!("{:?}", found[0].primary).contains("-30 N"), "{:?}", found[0].primary);
}

/// Whether sin² + cos² is 1 cannot be decided from its digits.
#[test]
fn a_force_that_may_be_zero_is_not_reported_as_balanced() {
    let pendulum = "gravity 9.81 m/s^2
        body bob { mass = 1 kg, at = ((sin(1)^2 + cos(1)^2) * 2 m, -1 m), inertia = 0 kg*m^2 }
        pivot p: ground@(2 m, 0) -- bob";
    let searched = ask(pendulum).lowered.rest;
    // It is proven to be near the drawing, wherever the bob is; that it is exactly there is not claimed.
    assert!(searched.is_proven() && searched.residual > 0.0 && !searched.displacement[0].is_zero());
    let declared = ask(&format!("rest as drawn\n{pendulum}")).lowered.rest;
    assert!(!declared.is_proven() && declared.residual > 0.0 && declared.residual < 1e-28, "{:e}", declared.residual);
}

/// Each of n springs carries the weights that follow it, in compression: exact, with work in proportion to the length
/// of the chain.
#[test]
fn a_long_chain_is_held_exactly() {
    let n = 20_000;
    let answer = {
        let text = format!(
            "gravity 10 m/s^2\nrest as drawn\nparam n = {n}
            body m[1] {{ mass = 1 kg, moves y }}
            spring k[1]: ground -- m[1] {{ k = 100 N/m }}
            repeat i in 2..n {{
              body m[i] {{ mass = 1 kg, moves y }}
              spring k[i]: m[i-1] -- m[i] {{ k = 100 N/m }}
            }}"
        );
        lowered(&text)
    };
    assert!(answer.rest.is_proven() && answer.rest.residual == 0.0);
    let found = answer.rest.tensions.iter().map(|found| found.tension.exact().cloned());
    assert!(found.zip((1..=n).rev()).all(|(found, below)| found == Some(Rational::from(-10 * below))));
}

/// Only the linear system, for scenes whose modes are not needed.
fn lowered(text: &str) -> vibc::lower::Lowered {
    let mut sources = vibc::base::Sources::new();
    let file = sources.add(vibc::base::SourceFile::model("scene.vib", text));
    let parsed = vibc::syntax::parse(&sources, file);
    let checked = vibc::model::check(&sources, &parsed.tree, &vibc::model::Overrides::default());
    let scene = checked.scene.unwrap_or_else(|| panic!("a good model"));
    vibc::lower::lower(&scene).lowered.unwrap_or_else(|| panic!("a rest"))
}

/// A grid of springs under transverse weights has more springs than coordinates: elimination cannot find their tensions
/// one by one.
#[test]
fn a_large_net_is_held_within_a_residual() {
    let n = 20;
    let mut text = String::from("gravity (9.81 m/s^2, 0)\nrest as drawn\n");
    for i in 0..n {
        for j in 0..n {
            text += &format!("body m[{i},{j}] {{ mass = 1 kg, moves x }}\n")
                .replace("[", "_")
                .replace("]", "")
                .replace(",", "_")
                .replace("kg_", "kg,");
        }
    }
    for i in 0..n {
        for j in 0..n {
            if i + 1 < n {
                text += &format!("spring a_{i}_{j}: m_{i}_{j} -- m_{}_{j} {{ k = 10 N/m }}\n", i + 1);
            }
            if j + 1 < n {
                text += &format!("spring b_{i}_{j}: m_{i}_{j} -- m_{i}_{} {{ k = 10 N/m }}\n", j + 1);
            }
        }
    }
    text += "spring g: ground -- m_0_0 { k = 10 N/m }\n";
    let rest = lowered(&text).rest;
    assert!(rest.is_proven() && rest.residual < 1e-20, "{} {:e}", rest.is_proven(), rest.residual);
    let at = |name: &str| rest.tensions.iter().position(|_| name == "g");
    assert!(at("g").is_some());
    let last = rest.tensions.last().expect("springs").tension.to_f64();
    assert!((last - 400.0 * 9.81).abs() < 1e-9, "{last}");
}

/// A net of springs of different lengths, held at its rim: the tensions that are found balance each knot's weight.
#[test]
fn the_tensions_of_a_large_slack_net_balance_its_weights() {
    let n = 16;
    let place = |i: usize, j: usize| (0.5 * i as f64 + 0.125 * j as f64, 0.25 * j as f64 + 0.03125 * (i * i) as f64);
    let mut text = String::from("gravity 10 m/s^2\nrest as drawn\n");
    let mut springs = Vec::new();
    let rim = |i: usize, j: usize| i == 0 || j == 0 || i == n || j == n;
    let end = |i: usize, j: usize| {
        let (x, y) = place(i, j);
        if rim(i, j) { format!("ground@({x} m, {y} m)") } else { format!("m[{i},{j}]") }
    };
    for (i, j) in (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))) {
        let (x, y) = place(i, j);
        if !rim(i, j) {
            text += &format!("body m[{i},{j}] {{ mass = 2 kg, at = ({x} m, {y} m), moves x y }}\n");
        }
        for (k, l) in [(i + 1, j), (i, j + 1)] {
            if k <= n && l <= n && !(rim(i, j) && rim(k, l)) {
                text += &format!("spring s[{}]: {} -- {} {{ k = 1 kN/m }}\n", springs.len(), end(i, j), end(k, l));
                springs.push([(i, j), (k, l)]);
            }
        }
    }
    let rest = lowered(&text).rest;
    assert!(rest.is_proven() && rest.residual < 1e-20, "{} {:e}", rest.is_proven(), rest.residual);
    let mut forces = vec![vec![(0.0, -20.0); n + 1]; n + 1];
    for ([a, b], found) in springs.iter().zip(&rest.tensions) {
        let ((xa, ya), (xb, yb)) = (place(a.0, a.1), place(b.0, b.1));
        let share = found.tension.to_f64() / (xb - xa).hypot(yb - ya);
        for (at, sign) in [(a, share), (b, -share)] {
            let force = &mut forces[at.0][at.1];
            *force = (force.0 + sign * (xb - xa), force.1 + sign * (yb - ya));
        }
    }
    for (i, j) in (1..n).flat_map(|i| (1..n).map(move |j| (i, j))) {
        let (x, y) = forces[i][j];
        // Four tensions of some hundred newtons, each rounded to binary64 and again with its direction.
        assert!(x.abs() < 1e-10 && y.abs() < 1e-10, "{i} {j}: {x:e} {y:e}");
    }
}

// Published cases, drawn rotated by 30 degrees about their support: the rest is found, and is the same.

/// A rotation by 30 degrees of the point (x, y).
const TURN: &str = "param c = cos(30 deg)\nparam s = sin(30 deg)\n";

fn turned(x: f64, y: f64) -> String {
    format!("({x} m * c - {y} m * s, {x} m * s + {y} m * c)")
}

fn frequencies(text: &str, published: &[f64]) -> Answer {
    let answer = ask(&(TURN.to_string() + text));
    assert!(answer.lowered.rest.is_proven(), "{text}");
    assert_eq!(
        vibc::analysis::stability(&answer.lowered.system, &answer.modes, &answer.poles),
        vibc::analysis::Stability::Stable
    );
    close(&answer.omegas(), published, 1e-13);
    answer
}

fn pendulum(n: usize) -> String {
    let mut text = String::from("gravity 9.81 m/s^2\n");
    for i in 1..=n {
        let above = if i == 1 { "ground".to_string() } else { format!("b{}", i - 1) };
        text += &format!("body b{i} {{ mass = 1 kg, at = {}, inertia = 0 kg*m^2 }}\n", turned(0.0, -(i as f64)));
        text += &format!("pivot p{i}: {above}@{} -- b{i}\n", turned(0.0, 1.0 - i as f64));
    }
    text
}

#[test]
fn chains_of_pendulums_drawn_turned_hang_down() {
    frequencies(&pendulum(2), &[2.3971993978641, 5.7873512980361]);
    frequencies(&pendulum(3), &[2.0195911472489, 4.7441427396672, 7.8552123627319]);
    frequencies(&pendulum(5), &[1.6079573179767, 3.7236385444663, 5.9397758218564, 8.3373734567593, 11.135809637487]);
    let ten = [
        1.1626495370499,
        2.6750605844777,
        4.2118694027798,
        5.7765097226575,
        7.3803785224083,
        9.0398450454507,
        10.779032380961,
        12.637227517372,
        14.689673475457,
        17.132484866195,
    ];
    let answer = frequencies(&pendulum(10), &ten);
    for angle in &answer.lowered.rest.displacement {
        assert!((angle.to_f64() + std::f64::consts::FRAC_PI_6).abs() < 1e-15);
    }
}

#[test]
fn rods_drawn_turned_hang_down() {
    let end = |y: f64| turned(0.0, y);
    let rod = format!(
        "gravity 9.81 m/s^2\nbody rod {{ mass = 1 kg, shape = rod((0, 0), {}) }}\npivot p: ground@(0, 0) -- rod\n",
        end(-1.0)
    );
    frequencies(&rod, &[14.715f64.sqrt()]);
    // The hinge spring is relaxed 30 degrees back, where the rod hangs.
    let hinge = "spring k: ground -- rod { k = 5 N*m/rad, free_length = -30 deg }";
    frequencies(&(rod + hinge), &[29.715f64.sqrt()]);
    let rods = format!(
        "gravity 9.81 m/s^2
        body upper {{ mass = 1 kg, shape = rod((0, 0), {one}) }}
        body lower {{ mass = 1 kg, shape = rod({one}, {two}) }}
        pivot a: ground@(0, 0) -- upper\npivot b: upper@{one} -- lower",
        one = end(-1.0),
        two = end(-2.0)
    );
    frequencies(&rods, &[2.6801140122534, 7.1886708702877]);
    let cart = format!(
        "gravity 9.81 m/s^2
        body cart {{ mass = 2 kg, moves x }}
        body rod {{ mass = 1 kg, shape = rod((0, 0), {}) }}
        pivot p: cart@(0, 0) -- rod
        spring k: ground -- cart {{ k = 40 N/m, along = x }}",
        end(-1.0)
    );
    frequencies(&cart, &[3.0521263999316, 5.2992737442614]);
}

/// ANSYS VM91: L = 100 inch, g = 386 inch/s^2, drawn at the point of release, (60, -80).
#[test]
fn the_simple_pendulum_hangs_down_from_where_it_is_let_go() {
    frequencies(
        "gravity 386 inch/s^2
        body bob { mass = 1 lb, at = (60 inch, -80 inch), inertia = 0 kg*m^2 }
        pivot p: ground@(0, 0) -- bob",
        &[3.86f64.sqrt()],
    );
}

/// The resonance library's ball in a channel: its matrices through a coupling. With y = phi - theta, M = mp l^2 phi^2 +
/// mb r^2 y^2 and K = mb g r (2 phi - y)^2 + (mp l - mb r) g phi^2.
#[test]
fn ball_in_a_channel() {
    let answer =
        ask("param mp = 0.012 kg\nparam mb = 0.0035 kg\nparam l = 0.2 m\nparam r = 0.1 m\nparam g = 9.81 m/s^2
        body pendulum { inertia = mp * l^2, turns }
        body ball { inertia = mb * r^2, turns }
        body twice { inertia = 0 kg*m^2, turns }
        couple c: twice.angle = 2 * pendulum.angle
        spring a: ground -- pendulum { k = g * (mp * l - mb * r) * 1 /rad }
        spring b: twice -- ball { k = g * mb * r * 1 /rad }");
    close(&answer.omegas(), &[5.43672938835891, 11.7920035853859], 1e-13);
}

/// VM9 with drawing and load rotated: the displacement rotates with them.
#[test]
fn vm9_turned() {
    let answer = ask(&format!(
        "{TURN}body p {{ mass = 1 lbf*s^2/inch, at = (0, 0), moves x y }}
        spring lower: ground@(10 inch * s, -10 inch * c) -- p {{ k = 1 lbf/inch }}
        spring upper: ground@(-10 inch * s, 10 inch * c) -- p {{ k = 8 lbf/inch }}
        force fx: p along x = constant(5 lbf * c - 5 lbf * s)
        force fy: p along y = constant(5 lbf * s + 5 lbf * c)"
    ));
    assert!(answer.lowered.rest.is_proven());
    let (c, s) = (0.75f64.sqrt(), 0.5);
    let inches: Vec<f64> = answer.lowered.rest.displacement.iter().map(|d| d.to_f64() / 0.0254).collect();
    let (x, y) = (8.632066133347, 4.531906698982);
    close(&inches, &[c * x - s * y, s * x + c * y], 1e-12);
}

/// A strut that can snap through: the drawing lies above, the rest on the same side is taken, and its distance is
/// reported.
#[test]
fn of_several_rests_the_one_reached_from_the_drawing_is_used() {
    let strut = |height: &str| {
        format!(
            "body m {{ mass = 1 kg, at = (0, {height}), moves y }}
            spring a: ground@(-1 m, 0) -- m {{ k = 100 N/m, free_length = 1.25 m }}
            spring b: ground@(1 m, 0) -- m {{ k = 100 N/m, free_length = 1.25 m }}"
        )
    };
    // Both springs are relaxed at heights of +-3/4 m.
    for (height, rest) in [("0.5 m", 0.25), ("-0.5 m", -0.25), ("0.01 m", 0.74)] {
        let answer = ask(&strut(height));
        close(&[answer.lowered.rest.displacement[0].to_f64()], &[rest], 1e-14);
    }
}

/// Links with springs between them, drawn away from their rest: more coordinates than a dense inverse is made for. The
/// bound is still proven, and the torques balance: with absolute angles a_i, k (2 a_i - a_(i-1) - a_(i+1)) is the
/// torque of the weights of the link and of all below it.
#[test]
fn a_long_chain_of_springy_links_finds_its_rest() {
    let n = 350;
    let text = format!(
        "gravity 10 m/s^2\nparam n = {n}
        body b[1] {{ mass = 1 kg, inertia = 0.1 kg*m^2, at = (0.6 m, -0.8 m) }}
        pivot p[1]: ground@(0, 0) -- b[1]
        spring t[1]: ground -- b[1] {{ k = 500 N*m/rad }}
        repeat i in 2..n {{
          body b[i] {{ mass = 1 kg, inertia = 0.1 kg*m^2, at = (i * 0.6 m, -i * 0.8 m) }}
          pivot p[i]: b[i-1]@((i-1) * 0.6 m, -(i-1) * 0.8 m) -- b[i]
          spring t[i]: b[i-1] -- b[i] {{ k = 500 N*m/rad }}
        }}"
    );
    let rest = lowered(&text).rest;
    assert!(rest.is_proven() && rest.residual < 1e-25, "{} {:e}", rest.is_proven(), rest.residual);
    let turned: Vec<f64> = rest.displacement.iter().map(Number::to_f64).collect();
    assert!(rest.displacement.iter().all(|angle| angle.to_ball().rad < 1e-25));
    for i in 0..n {
        let next = if i + 1 < n { turned[i + 1] - turned[i] } else { 0.0 };
        let springs = 500.0 * (turned[i] - if i > 0 { turned[i - 1] } else { 0.0 } - next);
        // The link is drawn along (0.6, -0.8): a rotation by a moves its end along x by 0.6 cos a + 0.8 sin a.
        let lever = 0.6 * turned[i].cos() + 0.8 * turned[i].sin();
        let weights = (n - i) as f64 * 10.0 * lever;
        assert!((springs + weights).abs() < 1e-10 * 3500.0, "link {i}: {springs} and {weights}");
    }
}

/// A row of links so long that its mass matrix is kept as chained rows: written out, they are the same as for a shorter
/// row, the sum over links of m (l_1 u_1 + ... + l_i u_i)^2 with u the unit vectors across.
#[test]
fn deep_chains_keep_short_rows() {
    let n = 600usize;
    let lowered = lowered(&links(n, "0.6", "0.8", "0 kg*m^2"));
    let system = &lowered.system;
    assert!(system.is_chained());
    let entries: usize = system.m.terms().map(|term| system.m.row(term).len()).sum::<usize>()
        + system.chain.iter().map(Vec::len).sum::<usize>();
    assert!(entries < 10 * n, "{entries} numbers for {n} links");
    assert!(lowered.rest.is_proven() && lowered.rest.displacement.iter().all(|q| !q.is_zero()));
    // Hanging straight down, M_ij = m l^2 (n - max(i, j)), i and j from 0.
    let flat = system.clone().into_flat(10_000_000).expect("room");
    assert!(!flat.is_chained());
    for (i, j) in [(0, 0), (0, 5), (7, 3), (599, 0), (599, 599), (300, 299)] {
        let product = |term| {
            let row = flat.m.row(term);
            let at = |k: usize| row.iter().find(|(c, _)| c.index() == k).map_or(0.0, |(_, value)| value.to_f64());
            term.weight.to_f64() * at(i) * at(j)
        };
        let entry: f64 = flat.m.terms().map(product).sum();
        let truth = (n - i.max(j)) as f64;
        assert!((entry - truth).abs() < 1e-12 * truth, "M[{i}][{j}] = {entry}, {truth}");
    }
    assert!(system.clone().into_flat(1000).is_err());
}

/// Links of 1 kg and 1 m, one under another.
fn links(n: usize, x: &str, y: &str, inertia: &str) -> String {
    format!(
        "gravity 9.81 m/s^2\nparam n = {n}
        body b[1] {{ mass = 1 kg, inertia = {inertia}, at = ({x} m, -{y} m) }}
        pivot p[1]: ground@(0, 0) -- b[1]
        repeat i in 2..n {{
          body b[i] {{ mass = 1 kg, inertia = {inertia}, at = (i * {x} m, -i * {y} m) }}
          pivot p[i]: b[i-1]@((i-1) * {x} m, -(i-1) * {y} m) -- b[i]
        }}"
    )
}

/// 100,000 links neither overflow the stack nor fill the memory.
#[test]
fn a_hundred_thousand_links_are_lowered() {
    let n = 100_000;
    let lowered = lowered(&links(n, "0", "1", "0.1 kg*m^2"));
    assert_eq!(lowered.system.n(), n);
    assert!(lowered.rest.displacement.iter().all(Number::is_zero));
    let weight = |place: usize| lowered.system.k.term(place).weight.to_f64();
    // K of the angle i is m g l (n - i): only gravity, in the order of the bodies.
    assert!((weight(0) - 9.81 * n as f64).abs() < 1e-6 && (weight(n - 1) - 9.81).abs() < 1e-12);
}

/// A rod drawn slightly off its upright position falls, however little it leans, alone or connected to another one.
#[test]
fn a_rod_that_leans_does_not_stay_upright() {
    let rod = |name: &str, at: &str, lean: &str| {
        format!(
            "body {name} {{ mass = 1 kg, shape = rod(({at}, 0), ({at} + sin({lean}) * 1 m, cos({lean}) * 1 m)) }}
            pivot p_{name}: ground@({at}, 0) -- {name}\n"
        )
    };
    let hangs = (3.0 * 9.81 / 2.0f64).sqrt();
    for lean in ["0.5 deg", "1e-7 deg", "-1e-9 deg", "1e-13 deg", "1e-30 deg"] {
        let one = ask(&format!("gravity 9.81 m/s^2\n{}", rod("a", "0 m", lean)));
        let sign = if lean.starts_with('-') { 1.0 } else { -1.0 };
        let turned = one.lowered.rest.displacement[0].to_f64();
        assert!((turned - sign * std::f64::consts::PI).abs() < 0.01, "{lean}: {turned}");
        close(&one.omegas(), &[hangs], 1e-14);
        assert!(one.lowered.rest.is_proven());
    }
    for lean in ["0.5 deg", "1e-7 deg", "1e-9 deg"] {
        let rods = rod("a", "0 m", lean) + &rod("b", "3 m", lean);
        let tied = ask(&format!("gravity 9.81 m/s^2\n{rods}couple c: a.angle = b.angle"));
        close(&tied.omegas(), &[hangs], 1e-14);
        // With a spring that is stretched by a hundred newtons.
        let loaded = ask(&format!(
            "gravity 9.81 m/s^2\n{}body m {{ mass = 10 kg, at = (2 m, 0), moves y }}
            spring s: ground -- m {{ k = 1e4 N/m, along = (0, 1) }}
            spring t: m -- a@(0, 0) {{ k = 1e-3 N/m, along = (0, 1) }}",
            rod("a", "0 m", lean)
        ));
        assert_eq!(loaded.modes.list[0].kind, ModeKind::Oscillation);
    }
}

/// A rod that is exactly upright stays (docs/method/rest.md#search), because no load acts on it.
#[test]
fn a_rod_that_is_upright_stays() {
    let text = "gravity 9.81 m/s^2
        body a { mass = 1 kg, shape = rod((0, 0), (0, 1 m)) }
        pivot p: ground@(0, 0) -- a";
    let answer = ask(text);
    assert!(answer.lowered.rest.displacement[0].is_zero() && answer.modes.list[0].kind == ModeKind::Divergence);
}

/// A free body on one stretched spring: it can rest at any point of a circle about the anchor, in any orientation. The
/// rest is one of these, without tension, and the two motions along them are rigid.
#[test]
fn a_free_body_on_one_spring_rests_where_the_spring_is_slack() {
    // (mass, inertia, centre, stiffness, anchor on the body, anchor on the base, free length)
    let scenes = [
        ("", "ground", 351_600.0, 1380.0, [0.967, -1.055], 5.206, [1.412, -1.999], [-0.799, -0.891], "2.40751"),
        (
            "base bs { at = (-2.819 m, -0.94 m), moves x }",
            "bs",
            0.2022,
            8.664,
            [-1.644, -1.561],
            9.678,
            [-2.354, 0.226],
            [0.767, -0.822],
            "3.09273",
        ),
    ];
    for (base, other, mass, inertia, centre, k, own, anchor, free) in scenes {
        let text = format!(
            "{base}
            body b {{ mass = {mass} kg, at = ({} m, {} m), inertia = {inertia} kg*m^2, free }}
            spring s: b@({} m, {} m) -- {other}@({} m, {} m) {{ k = {k} N/m, free_length = {free} m }}",
            centre[0], centre[1], own[0], own[1], anchor[0], anchor[1]
        );
        let answer = ask(&text);
        let rest = &answer.lowered.rest;
        assert!(rest.is_proven() && rest.residual == 0.0, "{rest:?}");
        let kinds: Vec<ModeKind> = answer.modes.list.iter().map(|mode| mode.kind).collect();
        assert_eq!(kinds, [ModeKind::Rigid, ModeKind::Rigid, ModeKind::Oscillation]);
        let [x, y, turn] = [0, 1, 2].map(|i| rest.displacement[i].to_f64());
        let arm = [own[0] - centre[0], own[1] - centre[1]];
        let arm = [turn.cos() * arm[0] - turn.sin() * arm[1], turn.sin() * arm[0] + turn.cos() * arm[1]];
        let line = [centre[0] + x + arm[0] - anchor[0], centre[1] + y + arm[1] - anchor[1]];
        let length = line[0].hypot(line[1]);
        let slack: f64 = free.parse().expect("a number");
        assert!((length - slack).abs() < 1e-14 * slack, "{length} {slack}");
        // One square k (direction . dx + lever dturn)^2.
        let lever = (arm[0] * line[1] - arm[1] * line[0]) / length;
        let truth = (k * (1.0 / mass + lever * lever / inertia)).sqrt();
        close(&answer.omegas()[2..], &[truth], 1e-13);
        // The rest is near if possible: the drawing is off by less than about two centimetres.
        assert!(x.hypot(y) < 0.2 && turn.abs() < 0.2, "{x} {y} {turn}");
    }
}

/// Two springs of 1 m between supports 2 m apart: V grows as y^4, so derivatives locate the rest only to a few digits,
/// and no proof is found.
#[test]
fn a_rest_whose_proof_fails_is_reported_as_not_proven() {
    let text = "body m { mass = 1 kg, at = (0, 0.1 m), moves y }
        spring a: ground@(-1 m, 0) -- m@(0, 0.1 m) { k = 100 N/m, free_length = 1 m }
        spring b: ground@(1 m, 0) -- m@(0, 0.1 m) { k = 100 N/m, free_length = 1 m }";
    let answer = ask(text);
    assert!(!answer.lowered.rest.is_proven());
    assert!((answer.lowered.rest.displacement[0].to_f64() + 0.1).abs() < 1e-3);
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("quartic.vib", text));
    let outcome = vibc::analyze(&sources, file, &Overrides::default());
    let answer = outcome.answer.expect("an answer");
    let report = report::text(&answer, &ReportOptions::default());
    assert!(report.contains("NOT proven") && !report.contains(", proven"), "{report}");
    let reported: serde_json::Value =
        serde_json::from_str(&json::json(&answer, &ReportOptions::default())).expect("JSON");
    assert_eq!(reported["rest"]["proven"], false);
    let rest = &reported["rest"];
    let bounds = [&rest["displacement_error_bound"]["m.y"], &rest["distance"]["translation_error_bound"]];
    assert!(bounds.iter().all(|bound| bound.is_null()), "{rest}");
    assert!(reported["modes"][0]["omega_error_bound"].is_null());
    let codes: Vec<&str> = outcome.diagnostics.iter().map(|found| found.code.0).collect();
    assert_eq!(codes, ["vib::rest::unproven"]);
}

/// For a rest that is not proven, every bound in JSON is null, every verdict open, and no measure has a value. A mass
/// next to the springs of the quartic has a frequency of 1/2pi Hz, certain to 30 digits if the rest is.
#[test]
fn nothing_about_a_rest_that_is_not_proven_has_a_bound() {
    let text = "param c = 0.1 N*s/m
        body m { mass = 1 kg, at = (0, 0.1 m), moves y }
        spring a: ground@(-1 m, 0) -- m@(0, 0.1 m) { k = 100 N/m, free_length = 1 m }
        spring b: ground@(1 m, 0) -- m@(0, 0.1 m) { k = 100 N/m, free_length = 1 m }
        body n[1] { mass = 1 kg, moves x }\nbody n[2] { mass = 1 kg, moves x }
        spring s: ground -- n[1] { k = 1 N/m }\nspring t: ground -- n[2] { k = 1.00001 N/m }
        damper d: ground -- n[1] { c = c }
        require frequency(2) > 0.1 Hz\nrequire stable";
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("quartic.vib", text));
    let outcome = vibc::analyze(&sources, file, &Overrides::default());
    let answer = outcome.answer.expect("an answer");
    assert_eq!(answer.stability.kind(), vibc::analysis::Stability::Undetermined);
    let options = ReportOptions { digits: Some(20), ..ReportOptions::default() };
    let reported: serde_json::Value = serde_json::from_str(&json::json(&answer, &options)).expect("JSON");
    let mut bounds = Vec::new();
    collect(&reported, "", &mut bounds);
    assert!(bounds.len() > 20 && bounds.iter().all(|(_, value)| value.is_null()), "{bounds:?}");
    assert_eq!(reported["rest"]["kind"], "undetermined");
    assert!(
        reported["modes"].as_array().is_some_and(|modes| modes.iter().any(|mode| mode["omega"] == 1.0)),
        "{reported}"
    );
    let report = report::text(&answer, &options);
    let tables = &report[report.find("undamped modes").expect("the table of modes")..];
    assert!(tables.contains(" ? ") && !tables.contains("e-1") && !tables.contains("e-2"), "{report}");
    let held: Vec<Option<bool>> = answer.requirements.iter().map(|line| line.holds).collect();
    assert_eq!(held, [None; 2]);
}

/// A spring that pulls with 100 N and more at any length draws its mass onto its other end, where no force is balanced: the
/// energy has a kink there. That is no rest, not even one without a proof.
#[test]
fn a_spring_that_pulls_to_no_length_leaves_no_rest() {
    let text = "gravity 9.81 m/s^2
        body m { mass = 1 kg, inertia = 1 kg*m^2, at = (1 m, 0.3 m), free }
        spring s: ground@(0, 0) -- m { k = 1 N/m, preload = 100 N }";
    assert_eq!(super::ask::refusal(text), ["vib::rest::not_found"]);
}

/// Transfer functions, motions, code and benchmarks have no place for saying that a number has no bound: they are refused by
/// one finding, as a limit; the caption of a drawn mode has no digits.
#[test]
fn no_stage_continues_from_an_unproven_rest() {
    let text = "param k = 1 N/m
        body m { mass = 1 kg, at = (0, 0.1 m), moves y }
        spring a: ground@(-1 m, 0) -- m@(0, 0.1 m) { k = 100 N/m, free_length = 1 m }
        spring b: ground@(1 m, 0) -- m@(0, 0.1 m) { k = 100 N/m, free_length = 1 m }
        body n { mass = 1 kg, moves x }
        spring s: ground -- n { k = k }
        force f: n along x = step(1 N, 0 s)
        output x = n.x";
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("quartic.vib", text));
    let none = Overrides::default();
    let times = vibc::times(&Number::ONE, &Number::ONE);
    let refused: [Outcome<()>; 5] = [
        nothing(vibc::dynamics(&sources, file, &none)),
        nothing(vibc::simulate(&sources, file, &none, &times)),
        nothing(vibc::discrete(&sources, file, &none, &discrete_options())),
        nothing(vibc::bench(&sources, file, &none, &mut || 0.0)),
        nothing(vibc::linear(&sources, file, &none)),
    ];
    for outcome in refused {
        assert!(outcome.answer.is_none());
        let messages: Vec<_> = outcome.diagnostics.iter().map(|found| (found.code.0, found.is_error())).collect();
        assert_eq!(messages, [("vib::rest::unproven", true)]);
        assert_eq!(outcome.failure(), Some(vibc::Failure::Limit));
    }
    let over = vibc::over_parameter(&sources, file, &none, "k").answer.expect("a model without errors").1;
    assert!(over.is_err_and(|reason| reason.contains("no rest that is proven")));
    let drawn = vibc::FigureOptions { mode: Some(2), ..vibc::FigureOptions::default() };
    let figure = vibc::draw(&sources, file, &none, &drawn).answer.expect("an answer").expect("a figure");
    let captions: Vec<&str> = figure.notes.iter().map(|note| note.text.as_str()).collect();
    assert!(
        captions.iter().any(|text| text.contains("not proven")) && !captions.concat().contains("Hz"),
        "{captions:?}"
    );
}

fn nothing<T>(outcome: Outcome<T>) -> Outcome<()> {
    Outcome { answer: outcome.answer.map(|_| ()), diagnostics: outcome.diagnostics }
}

fn discrete_options() -> vibc::DiscreteOptions {
    vibc::DiscreteOptions {
        step: Number::from("0.001"),
        hold: vibc::Hold::Zero,
        precision: vibc::Precision::Double,
        tolerance: None,
        unpruned: false,
        built_in: false,
        internal: Vec::new(),
        until: None,
    }
}

/// The bounds and certain digits of a JSON value, with their paths.
fn collect<'a>(value: &'a serde_json::Value, at: &str, bounds: &mut Vec<(String, &'a serde_json::Value)>) {
    let is_bound = at.contains("error_bound") || at.ends_with("_digits");
    match value {
        serde_json::Value::Object(map) => {
            map.iter().for_each(|(key, value)| collect(value, &format!("{at}.{key}"), bounds));
        }
        serde_json::Value::Array(list) => list.iter().for_each(|value| collect(value, at, bounds)),
        leaf if is_bound => bounds.push((at.to_string(), leaf)),
        _ => {}
    }
}

/// The sensitivity of a frequency to weights does not include their effect through the rest.
#[test]
fn conditions_leave_out_no_change_of_the_rest() {
    let conditions = |text: &str| -> Vec<Option<f64>> {
        let mut sources = Sources::new();
        let file = sources.add(SourceFile::model("model.vib", text));
        let answer = vibc::analyze(&sources, file, &Overrides::default()).answer.expect("an answer");
        answer.modes.list.iter().map(|mode| mode.input_condition.map(|condition| condition.0)).collect()
    };
    let weight = |extra: &str| {
        format!(
            "gravity 9.81 m/s^2\n{extra}
            body m {{ mass = 1 kg, at = (1 m, 0), moves y }}
            spring s: ground -- m {{ k = 100 N/m }}
            spring t: ground@(0, 0) -- m@(1 m, 0) {{ k = 100 N/m }}"
        )
    };
    // A weight on a linear spring moves the rest, but changes no term.
    let linear = "gravity 9.81 m/s^2\nbody m { mass = 1 kg, moves y }\nspring s: ground -- m { k = 100 N/m }";
    assert_eq!(conditions(linear), [Some(2.0)]);
    // If the second spring rotates as the body sinks, its stretch and its tension depend on the weight.
    assert_eq!(conditions(&weight("")), [None]);
    // Tensions that hold the drawing change with the weights that they balance.
    let held = "gravity 9.81 m/s^2\nrest as drawn
        body rod { mass = 1 kg, shape = rod((0, 0), (1 m, 0)) }
        pivot p: ground@(0, 0) -- rod\nspring s: ground@(0, 1 m) -- rod@(1 m, 0) { k = 100 N/m }";
    assert_eq!(conditions(held), [None]);
}

/// Two wheels that roll, held by springs of which the drawing has tension: at rest nothing pulls but what is smaller than rounding.
#[test]
fn a_rest_without_forces_is_measured_by_those_of_the_drawing() {
    let model = "body cart { mass = 2 kg, at = (0, 1 m), moves x }\n\
                 body w { mass = 1 kg, at = (0, 0.3 m), shape = disk(0.3 m), moves x, turns }\n\
                 body q { mass = 3 kg, at = (2 m, 0.5 m), shape = ring(0.2 m), moves x, turns }\n\
                 spring s: ground@(-2 m, 1 m) -- cart { k = 50 N/m, preload = 4 N }\n\
                 spring t: cart -- w { k = 30 N/m, along = x }\n\
                 spring u: w@(0, 0.6 m) -- q@(2 m, 0.6 m) { k = 20 N/m }\n\
                 couple r: w.x = -0.3 m * w.angle\ncouple r2: q.x = -0.2 m * q.angle\noutput x = cart.x\n";
    let answer = ask(model);
    assert!(
        answer.lowered.rest.is_proven() && answer.lowered.rest.residual < 1e-20,
        "{:e}",
        answer.lowered.rest.residual
    );
    let moved = answer.lowered.rest.displacement[0].to_f64();
    assert!((moved + 0.08).abs() < 1e-15, "{moved}");
}
