//! Closed loops and couplings, and the remaining motions: published and closed-form answers, and a second formulation
//! in absolute coordinates with multipliers, on linkages written by hand and on random ones.

use crate::ask::{Answer, ask, refusal, try_ask};
use crate::independent::{assert_formulations_agree_within, random_scenes};
use vibc::base::{Number, Rational};

/// Tolerance between both formulations. The second one differentiates numerically and eliminates in double-double:
/// 1e-22 of the energies, magnified by the lever arms of a loop near a dead centre.
const TOLERANCE: f64 = 1e-13;

fn by_both_formulations(text: &str) -> Answer {
    let answer = ask(text);
    assert_formulations_agree_within(&answer, TOLERANCE, text);
    answer
}

fn assert_omegas(answer: &Answer, truth: &[f64]) {
    let found = answer.omegas();
    assert_eq!(found.len(), truth.len(), "{found:?}");
    for (found, truth) in found.iter().zip(truth) {
        assert!((found - truth).abs() <= 1e-12 * truth.abs(), "{found:e}, published {truth:e}");
    }
}

/// The IFToMM five-bar, turned about A by some degrees; gravity turns with it.
fn five_bar(gravity: bool, turned: &str) -> String {
    let gravity = if gravity { "gravity (9.81 m/s^2 * s, -9.81 m/s^2 * c)" } else { "" };
    format!(
        "let c = cos({turned})\nlet s = sin({turned})\n{gravity}
        point A = (0, 0)
        point B = (c * 1 m, s * 1 m)
        point C = ((s - c) * 1 m, (-s - c) * 1 m)
        point D = ((c / 2 + 2 * s) * 1 m, (s / 2 - 2 * c) * 1 m)
        point E = ((2 * c + s) * 1 m, (2 * s - c) * 1 m)
        body ac {{ mass = 1 kg, shape = rod(A, C) }}
        body cd {{ mass = 1.5 kg, shape = rod(C, D) }}
        body de {{ mass = 1.5 kg, shape = rod(D, E) }}
        body eb {{ mass = 1 kg, shape = rod(E, B) }}
        pivot a: ground@A -- ac\npivot c: ac@C -- cd\npivot d: cd@D -- de\npivot e: de@E -- eb\npivot b: eb@B -- ground
        spring s1: ground@B -- ac@C {{ k = 100 N/m }}
        spring s2: ground@B -- cd@D {{ k = 100 N/m }}"
    )
}

/// P08 and P09 of the published cases.
#[test]
fn the_five_bar_finds_its_rest_and_its_frequencies() {
    let answer = by_both_formulations(&five_bar(true, "0"));
    assert_omegas(&answer, &[3.284544215896, 7.1262316531576]);
    let rest = &answer.lowered.rest;
    assert!(rest.is_proven() && rest.residual < 1e-25, "{rest:?}");
    // C turns with the rod AC about A.
    let angle = rest.displacement[0].to_f64();
    let (x, y) = (angle.sin() - angle.cos(), -angle.sin() - angle.cos());
    assert!((x + 0.79400867881339).abs() < 1e-14 && (y + 1.1702778379381).abs() < 1e-13, "{x} {y}");
    assert_omegas(&by_both_formulations(&five_bar(false, "0")), &[1.8151442052098, 7.1912609755035]);
}

#[test]
fn a_turned_drawing_has_the_same_frequencies() {
    for turned in ["30 deg", "-75 deg", "180 deg"] {
        assert_omegas(&ask(&five_bar(true, turned)), &[3.284544215896, 7.1262316531576]);
        assert_omegas(&ask(&five_bar(false, turned)), &[1.8151442052098, 7.1912609755035]);
    }
}

/// A bar hung on two parallel links of length l swings as a pendulum of that length: omega^2 = g / l, which comes
/// entirely from the curvature of the constraint.
#[test]
fn a_trapeze_is_a_pendulum() {
    let answer = by_both_formulations(
        "gravity 9.81 m/s^2
        body left { mass = 0 kg, shape = rod((0, 0), (0, -2 m)) }
        body bar { mass = 3 kg, shape = rod((0, -2 m), (1 m, -2 m)) }
        body right { mass = 0 kg, shape = rod((1 m, 0), (1 m, -2 m)) }
        pivot a: ground@(0, 0) -- left\npivot b: left@(0, -2 m) -- bar
        pivot c: bar@(1 m, -2 m) -- right\npivot d: right@(1 m, 0) -- ground",
    );
    let (m, k) = (&answer.lowered.system.m.entries(1)[0][0], &answer.lowered.system.k.entries(1)[0][0]);
    assert_eq!(&(m * &Number::from(981)) / &Number::from(200), *k);
}

/// Two gears on parallel shafts and three discs: T03 of the published cases (Friswell).
#[test]
fn a_gear_pair_between_rotors() {
    let answer = ask("body motor { inertia = 400e-6 kg*m^2, turns }
        body pinion { inertia = 25e-6 kg*m^2, turns }
        body gear { inertia = 25e-6 kg*m^2, turns }
        body first { inertia = 700e-6 kg*m^2, turns }
        body second { inertia = 700e-6 kg*m^2, turns }
        spring s: motor -- pinion { k = 1e4 N*m/rad }
        spring t: pinion -- first { k = 5000 N*m/rad }
        spring u: gear -- second { k = 5000 N*m/rad }
        couple mesh: gear.angle = -pinion.angle");
    let found = answer.frequencies();
    for (found, truth) in found.iter().zip([0.0, 425.359477472, 634.072760023, 3247.19235372]) {
        assert!((found - truth).abs() <= 1e-11 * truth, "{found} {truth}");
    }
    assert_eq!(found.len(), 4);
}

/// Two damped shafts with a gear pair of 10 and 60 teeth: T09, the matrices of openTorsion's test, divided by the
/// inertia of the pair.
#[test]
fn geared_shafts_have_their_published_matrices() {
    let answer = ask("body d[1] { inertia = 1 kg*m^2, turns }
        body d[2] { inertia = 0.1 kg*m^2, turns }
        body d[3] { inertia = 0.1 kg*m^2, turns }
        body d[4] { inertia = 1 kg*m^2, turns }
        spring k1: d[1] -- d[2] { k = 400 N*m/rad }\ndamper c1: d[1] -- d[2] { c = 1 N*m*s/rad }
        spring k2: d[3] -- d[4] { k = 800 N*m/rad }\ndamper c2: d[3] -- d[4] { c = 0.5 N*m*s/rad }
        damper b1: ground -- d[1] { c = 0.5 N*m*s/rad }\ndamper b2: ground -- d[2] { c = 0.1 N*m*s/rad }
        damper b3: ground -- d[3] { c = 0.1 N*m*s/rad }\ndamper b4: ground -- d[4] { c = 1 N*m*s/rad }
        couple mesh: d[3].angle * 60 = -10 * d[2].angle");
    let system = &answer.lowered.system;
    assert_eq!(system.coordinate_names(), ["d[1].angle", "d[2].angle", "d[4].angle"]);
    let entries = [&system.m, &system.c, &system.k].map(|form| form.entries(3));
    let quotient = |of: usize, i: usize, j: usize| -(&entries[of][i][j] / &entries[0][i][i]).to_f64();
    let row = |of: usize, i: usize| [0, 1, 2].map(|j| quotient(of, i, j));
    let published = [
        (row(2, 0), [-400.0, 400.0, 0.0]),
        (row(1, 0), [-1.5, 1.0, 0.0]),
        (row(2, 1), [3891.891891891892, -4108.108108108108, -1297.297297297297]),
        (row(1, 1), [9.72972972972973, -10.864864864864865, -0.810810810810811]),
        (row(2, 2), [0.0, -133.33333333333333, -800.0]),
        (row(1, 2), [0.0, -0.08333333333333333, -1.5]),
    ];
    for (found, truth) in published {
        for (found, truth) in found.iter().zip(truth) {
            assert!((found - truth).abs() <= 1e-14 * truth.abs(), "{found} {truth}");
        }
    }
}

/// A rolling disc: x = -r theta, so that M = m r^2 + J, K = k r^2, omega^2 = 2 k / 3 m.
#[test]
fn a_rolling_disc_carries_its_inertia() {
    let answer = by_both_formulations(
        "body disc { mass = 2 kg, at = (0, 0.3 m), shape = disk(0.3 m), free }
        couple roll: disc.x = -disc.angle * 0.3 m
        couple road: disc.y = 0
        spring s: ground@(-1 m, 0.3 m) -- disc { k = 30 N/m }",
    );
    assert_omegas(&answer, &[10f64.sqrt()]);
}

/// Two weights over a massive pulley, one of them on a spring: a rope of fixed length.
#[test]
fn a_pulley_turns_with_its_rope() {
    let answer = by_both_formulations(
        "gravity 9.81 m/s^2
        body left { mass = 3 kg, moves y, at = (-0.2 m, -1 m) }
        body right { mass = 2 kg, moves y, at = (0.2 m, -1 m) }
        body wheel { mass = 4 kg, at = (0, 0), shape = disk(0.2 m), turns }
        couple rope: left.y = -right.y
        couple grip: wheel.angle * 0.2 m = right.y
        spring s: ground@(0.2 m, -3 m) -- right { k = 70 N/m }",
    );
    // 3 + 2 + J / r^2 = 7 kg on 70 N/m; the heavier one sinks by g / 70.
    assert_omegas(&answer, &[10f64.sqrt()]);
    let rest = &answer.lowered.rest;
    assert_eq!(answer.lowered.system.coordinate_names(), ["left.y"]);
    assert_eq!(rest.displacement, [Number::from(Rational::new(-981, 7000))]);
    assert!(rest.is_proven());
}

/// A lever with arms a and b between two masses: the coupling is linear in the displacements.
#[test]
fn a_lever_multiplies() {
    let answer = by_both_formulations(
        "body m { mass = 1 kg, moves y }\nbody n { mass = 9 kg, moves y }
        couple lever: m.y / 3 m = -n.y / 1 m
        spring s: ground -- n { k = 36 N/m }",
    );
    // In the displacement of n: 9 + 9 kg on 36 N/m.
    assert_omegas(&answer, &[2f64.sqrt()]);
}

/// A slider-crank: the piston follows the crank through a rod; a closing slide or a freedom clause gives the same
/// result.
#[test]
fn a_slider_crank_is_the_same_however_the_piston_is_guided() {
    let with = |piston: &str, guide: &str| {
        format!(
            "gravity 9.81 m/s^2
            point A = (0, 0)\npoint B = (0.3 m, 0.4 m)\npoint C = (1.5 m, -0.5 m)
            body crank {{ mass = 2 kg, shape = rod(A, B) }}
            body rod {{ mass = 1 kg, shape = rod(B, C) }}
            body piston {{ mass = 3 kg, at = C{piston} }}
            pivot a: ground@A -- crank\npivot b: crank@B -- rod\npivot c: rod@C -- piston
            {guide}
            spring s: ground@(3 m, -0.5 m) -- piston {{ k = 200 N/m, preload = 10 N }}
            damper d: ground -- crank {{ c = 0.2 N*m*s/rad }}
            force F: piston along x\noutput x = piston.x\noutput turn = rod.angle"
        )
    };
    let guided = by_both_formulations(&with(", moves x", ""));
    let slid = by_both_formulations(&with("", "slide g: ground -- piston along (1, 0)"));
    let along = by_both_formulations(&with(", inertia = 1 kg*m^2, free", "slide g: piston -- ground along (-2, 0)"));
    assert_eq!(guided.omegas().len(), 1);
    for other in [slid, along] {
        for (a, b) in guided.omegas().iter().zip(other.omegas()) {
            assert!((a - b).abs() <= 1e-14 * a, "{a} {b}");
        }
    }
}

/// A scissor lift of three stages under a load, on a slide at its foot: one degree of freedom.
#[test]
fn a_scissor_lift() {
    let mut text = String::from(
        "gravity 9.81 m/s^2
        body foot { mass = 1 kg, at = (1.6 m, 0), moves x }
        spring s: ground@(0, 0) -- foot { k = 90000 N/m, preload = 200 N }\n",
    );
    for i in 0..3 {
        let (low, high) = (f64::from(i) * 1.2, f64::from(i + 1) * 1.2);
        text += &format!(
            "body up{i} {{ mass = 2 kg, shape = rod((0, {low:.1} m), (1.6 m, {high:.1} m)) }}
            body down{i} {{ mass = 2 kg, shape = rod((1.6 m, {low:.1} m), (0, {high:.1} m)) }}
            pivot m{i}: up{i}@(0.8 m, {:.1} m) -- down{i}\n",
            0.5 * (low + high)
        );
        text += &match i {
            0 => "pivot a: ground@(0, 0) -- up0\npivot b: foot@(1.6 m, 0) -- down0\n".to_string(),
            _ => format!(
                "pivot a{i}: down{0}@(0, {low:.1} m) -- up{i}\npivot b{i}: up{0}@(1.6 m, {low:.1} m) -- down{i}\n",
                i - 1
            ),
        };
    }
    let answer = by_both_formulations(&text);
    assert_eq!(answer.omegas().len(), 1);
    assert!(answer.lowered.rest.is_proven() && answer.remarks.is_empty(), "{:?}", answer.remarks);
}

/// Bases that carry a tree, a loop and a turning arm.
#[test]
fn bases_carry_loops() {
    let text = "gravity 9.81 m/s^2
        base floor { moves x y, at = (0, 0) }
        base shaft { turns, at = (4 m, 0) }
        body left { mass = 1 kg, shape = rod((0, 0), (0.3 m, -1 m)) }
        body bar { mass = 2 kg, shape = rod((0.3 m, -1 m), (1.5 m, -1.1 m)) }
        body right { mass = 1 kg, shape = rod((2 m, 0), (1.5 m, -1.1 m)) }
        pivot a: floor@(0, 0) -- left\npivot b: left@(0.3 m, -1 m) -- bar
        pivot c: bar@(1.5 m, -1.1 m) -- right\npivot d: right@(2 m, 0) -- floor
        body arm { mass = 1 kg, shape = rod((4.5 m, 0), (4.8 m, -1 m)) }
        pivot e: shaft@(4.5 m, 0) -- arm
        body nut { mass = 0.5 kg, inertia = 0.1 kg*m^2, at = (4 m, 1 m) }
        slide f: shaft -- nut along (0, 1)
        spring n: shaft@(4 m, 0) -- nut { k = 500 N/m, preload = -4 N }
        spring h: shaft -- arm { k = 20 N*m/rad }
        damper w: floor -- bar { c = 3 N*m*s/rad }
        output swing = bar.x - floor.x\noutput tip = arm@(4.8 m, -1 m).ax\noutput pull = n.force";
    let answer = by_both_formulations(text);
    let system = &answer.lowered.system;
    assert_eq!(system.inputs.len(), 3);
    assert!(system.inputs.iter().all(|input| !input.b[2].is_empty()), "inertia is driven");
}

/// A base whose motion drives a loop by a coupling.
#[test]
fn a_cam_drives_a_linkage() {
    let text = "base cam { turns, at = (0, 0) }
        body follower { mass = 2 kg, moves y, at = (0, 1 m) }
        body load { mass = 1 kg, moves y, at = (0, 2 m) }
        couple lift: follower.y = cam.angle * 0.05 m
        spring s: follower -- load { k = 100 N/m }
        damper d: ground -- load { c = 1 N*s/m }";
    let answer = by_both_formulations(text);
    assert_omegas(&answer, &[10.0]);
    assert_eq!(answer.lowered.system.inputs[0].b[0][0].1, Number::from(5));
}

/// The redundant constraints of the third bar of a parallel linkage are reported, and change nothing.
#[test]
fn a_third_bar_is_redundant() {
    let linkage = |bars: usize| {
        format!(
            "gravity 9.81 m/s^2
            body bar {{ mass = 2 kg, shape = rod((0, -1 m), (2 m, -1 m)) }}
            repeat i in 0..{} {{
              body  link[i] {{ mass = 0 kg, shape = rod((i * 1 m, 0), (i * 1 m, -1 m)) }}
              pivot a[i]: ground@(i * 1 m, 0) -- link[i]
              pivot b[i]: bar@(i * 1 m, -1 m) -- link[i]
            }}",
            bars - 1
        )
    };
    let (two, three) = (by_both_formulations(&linkage(2)), by_both_formulations(&linkage(3)));
    assert_eq!((two.omegas(), two.remarks.len()), (three.omegas(), 0));
    assert_is_seen_redundant(&three);
}

/// Two arms that turn alike see their crossing under one angle (Euclid, Elements III.21 and 31): it stays on the circle through
/// both pivots, here one of diameter. A massless link from its centre, or a third arm that turns with them, changes nothing; the
/// curvatures of slots and links cancel along two motions as well.
#[test]
fn what_a_circle_already_says_is_redundant() {
    let scene = |turn: &str, both: &str, more: &str| {
        let text = format!(
            "let c = cos({turn}) * 1 m\nlet s = sin({turn}) * 1 m
            body one {{ mass = 1 kg, shape = rod(P(0 0), P(0 2)) }}
            body two {{ mass = 2 kg, shape = rod(P(1 1), P(-1 1)) }}
            body first {{ mass = 0.5 kg, inertia = 0.01 kg*m^2, at = P(0 1) }}
            body second {{ mass = 0.25 kg, inertia = 0.01 kg*m^2, at = P(0 1) }}
            pivot a: ground@P(0 0) -- one\npivot b: ground@P(1 1) -- two
            slide in_one: one -- first along P(0 1)\nslide in_two: two -- second along P(1 0)
            pivot pin: first@P(0 1) -- second
            spring k: ground@P(-3 0) -- one@P(0 2) {{ k = 100 N/m }}
            {both}\n{more}\n"
        );
        in_turned_frame(text)
    };
    let link = "body link { mass = 0 kg, shape = rod(P(0.5 0.5), P(0 1)) }
        pivot e: ground@P(0.5 0.5) -- link\npivot f: first@P(0 1) -- link";
    let arm = "body three { mass = 0 kg, shape = rod(P(1 0), P(-1 2)) }\nbody third { mass = 0 kg, inertia = 0 kg*m^2, at = P(0 1) }
        pivot g: ground@P(1 0) -- three\nslide in_three: three -- third along P(-1 1)
        pivot also: second@P(0 1) -- third\ncouple all: three.angle = one.angle";
    let alike = "couple alike: two.angle = one.angle";
    // Both weights are small, so that the arm's angle is what follows from the other two.
    let differential = "body p { inertia = 1 kg*m^2, turns }\nbody q { inertia = 2 kg*m^2, turns }
        couple first_arm: one.angle = p.angle / 5 + q.angle / 4\ncouple second_arm: two.angle = p.angle / 5 + q.angle / 4
        spring held: ground -- q { k = 10 N*m/rad }";
    // As drawn all numbers are exact; turned, their sums are zero within balls.
    for turn in ["0", "31 deg"] {
        for both in [alike, differential] {
            let plain = by_both_formulations(&scene(turn, both, ""));
            assert_eq!(plain.remarks.len(), 0);
            for more in [link, arm] {
                assert_changes_nothing(&by_both_formulations(&scene(turn, both, more)), &plain.omegas());
            }
        }
    }
}

/// A link from each of two pivots to the ends of a coupler: its middle draws nearly a straight line (J. Watt, 1784), with tangent
/// and curvature where it is drawn, but not further. Peaucellier's linkage (1864) draws one exactly, by inversion: P is on the
/// ray through the other two corners of a rhombus, and the product of their distances from the pivot is constant. So a guide along
/// the line locks the first and adds nothing to the second.
#[test]
fn a_guide_along_the_line_of_a_linkage_is_redundant_if_the_line_is_straight() {
    let watt = |arm: &str, guide: &str| {
        format!(
            "body left {{ mass = 1 kg, shape = rod((-{arm}, 0.5 m), (0, 0.5 m)) }}
            body right {{ mass = 1 kg, shape = rod(({arm}, -0.5 m), (0, -0.5 m)) }}
            body link {{ mass = 1 kg, shape = rod((0, 0.5 m), (0, -0.5 m)) }}
            pivot a: ground@(-{arm}, 0.5 m) -- left\npivot b: ground@({arm}, -0.5 m) -- right
            pivot c: left@(0, 0.5 m) -- link\npivot d: right@(0, -0.5 m) -- link
            spring k: ground@(-2 m, 3 m) -- left@(-1 m, 0.5 m) {{ k = 100 N/m }}\n{guide}"
        )
    };
    let guide = "body slug { mass = 1 kg, at = (0, 0), moves y }\npivot e: slug@(0, 0) -- link";
    // With a wheel that turns a hundred times as far as the crank, too.
    let geared =
        format!("{guide}\nbody motor {{ inertia = 1 kg*m^2, turns }}\ncouple r: motor.angle = 100 * left.angle");
    for arm in ["2 m", "20 m", "0.6 m"] {
        assert_eq!(refusal(&watt(arm, guide)), ["vib::loop::conflict"], "{arm}");
        assert_eq!(refusal(&watt(arm, &geared)), ["vib::loop::conflict"], "{arm}");
        assert_eq!(ask(&watt(arm, "")).omegas().len(), 1);
    }
    // Arms of sqrt(13) m from O, a rhombus with sides of sqrt(5) m: the product of the distances of N and F is 13 - 5 = 2 times 4
    // m^2. The crank carries N on a circle through O.
    let peaucellier = |turn: &str, guide: &str| {
        let text = format!(
            "let c = cos({turn}) * 1 m\nlet s = sin({turn}) * 1 m\npoint O = P(0 0)\npoint N = P(2 0)\npoint F = P(4 0)
            point U = P(3 2)\npoint L = P(3 -2)\npoint C = P(1 0)
            body up {{ mass = 1 kg, shape = rod(O, U) }}\nbody low {{ mass = 1 kg, shape = rod(O, L) }}
            body crank {{ mass = 1 kg, shape = rod(C, N) }}
            body one {{ mass = 1 kg, shape = rod(N, U) }}\nbody two {{ mass = 1 kg, shape = rod(N, L) }}
            body three {{ mass = 1 kg, shape = rod(F, U) }}\nbody four {{ mass = 1 kg, shape = rod(F, L) }}
            pivot a: ground@O -- up\npivot b: ground@O -- low\npivot c: ground@C -- crank
            pivot d: crank@N -- one\npivot e: crank@N -- two\npivot f: up@U -- one\npivot g: low@L -- two
            pivot h: up@U -- three\npivot i: low@L -- four\npivot j: three@F -- four
            spring k: ground@P(1 5) -- crank@N {{ k = 100 N/m }}\n{guide}"
        );
        in_turned_frame(text)
    };
    let guide = "body slug { mass = 0 kg, at = F }\nslide along: ground -- slug along P(0 1)\npivot l: slug@F -- three";
    let plain = by_both_formulations(&peaucellier("0", "")).omegas();
    for turn in ["0", "31 deg"] {
        assert_changes_nothing(&by_both_formulations(&peaucellier(turn, guide)), &plain);
    }
    // A crank a little longer than the distance of its pivot from O: the line becomes a circle of a large radius, which has a
    // curvature.
    let longer = peaucellier("0", guide).replace("point C = ((1)", "point C = ((1.001)");
    assert_eq!(refusal(&longer), ["vib::loop::conflict"]);
}

/// Hart's linkage (1874), a crossed parallelogram: three points of a line parallel to its diagonals are O, N and P with ON times OP
/// constant, so that P is on a straight line where N is on a circle through O. It is flat: a parallelogram, of which P leaves the
/// line, is not far away. A lattice of parallelograms that turns on a bar has two motions.
#[test]
fn what_holds_on_the_branch_of_the_drawing_is_redundant() {
    // A and B are 6 m apart, C and D 4 m, 0.3 m above; the links AD and BC cross. O, N and P are the middles of AC, AD and BC.
    let hart = |turn: &str, guide: &str| {
        in_turned_frame(format!(
            "let c = cos({turn}) * 1 m\nlet s = sin({turn}) * 1 m
            body low {{ mass = 1 kg, shape = rod(P(0 0), P(5 0.3)) }}\nbody left {{ mass = 1 kg, shape = rod(P(0 0), P(1 0.3)) }}
            body high {{ mass = 1 kg, shape = rod(P(1 0.3), P(6 0)) }}\nbody right {{ mass = 1 kg, shape = rod(P(6 0), P(5 0.3)) }}
            pivot a: low@P(0 0) -- left\npivot b: left@P(1 0.3) -- high\npivot d: high@P(6 0) -- right\npivot e: right@P(5 0.3) -- low
            pivot o: ground@P(0.5 0.15) -- left
            body crank {{ mass = 1 kg, shape = rod(P(1.5 0.15), P(2.5 0.15)) }}
            pivot q: ground@P(1.5 0.15) -- crank\npivot n: crank@P(2.5 0.15) -- low
            spring k: ground@P(2.5 5) -- crank@P(2.5 0.15) {{ k = 100 N/m }}\n{guide}"
        ))
    };
    let guide = "body slug { mass = 0 kg, at = P(3.5 0.15) }\nslide along: ground -- slug along P(0 1)\npivot l: slug@P(3.5 0.15) -- high";
    let plain = ask(&hart("0", "")).omegas();
    for turn in ["0", "31 deg"] {
        assert_changes_nothing(&ask(&hart(turn, guide)), &plain);
    }
    // A scissor that is nearly closed: its upper end is above its fixed foot anyway (Scott Russell). What is left open of the loops
    // moves that end sixty times as far.
    let scissor = |guide: &str| {
        in_turned_frame(format!(
            "let c = cos(31 deg) * 1 m\nlet s = sin(31 deg) * 1 m
            body one {{ mass = 1 kg, shape = rod(P(0 0), P(0.05 3)) }}\nbody two {{ mass = 1 kg, shape = rod(P(0.05 0), P(0 3)) }}
            pivot a: ground@P(0 0) -- one\npivot b: one@P(0.025 1.5) -- two
            spring k: ground@P(-5 4) -- two@P(0 3) {{ k = 100 N/m }}
            body foot {{ mass = 1 kg, at = P(0.05 0) }}\nslide f: ground -- foot along P(1 0)\npivot g: foot@P(0.05 0) -- two\n{guide}"
        ))
    };
    let guide =
        "body top { mass = 0 kg, at = P(0 3) }\nslide h: ground -- top along P(0 1)\npivot i: top@P(0 3) -- two";
    assert_changes_nothing(&ask(&scissor(guide)), &ask(&scissor("")).omegas());
    // The second motion turns all bars alike; rounding of turned numbers is none of a curvature.
    let lattice = |turn: &str| {
        let mut text = format!(
            "let c = cos({turn}) * 1 m\nlet s = sin({turn}) * 1 m
            body base {{ mass = 1 kg, shape = rod(P(0 0), P(4 0)) }}\npivot z: ground@P(0 0) -- base
            spring hold: ground@P(1 3) -- base@P(4 0) {{ k = 50 N/m }}
            body top {{ mass = 1 kg, shape = rod(P(0 1), P(4 1)) }}
            spring up: ground@P(-3 2) -- top@P(0 1) {{ k = 70 N/m }}\n"
        );
        for i in 0..3 {
            let x = 2 * i;
            text += &format!(
                "body l{i} {{ mass = 1 kg, shape = rod(P({x} 0), P({x} 1)) }}\npivot a{i}: base@P({x} 0) -- l{i}\npivot b{i}: top@P({x} 1) -- l{i}\n"
            );
        }
        in_turned_frame(text)
    };
    let plain = ask(&lattice("0")).omegas();
    assert_eq!(plain.len(), 2);
    assert_changes_nothing(&ask(&lattice("31 deg")), &plain);
}

/// One note: that something is redundant, in two other positions too.
#[track_caller]
fn assert_is_seen_redundant(answer: &Answer) {
    let [note] = answer.remarks.as_slice() else { panic!("{:?}", answer.remarks) };
    assert_eq!(note.code.to_string(), "vib::loop::redundant");
    assert!(note.help.as_ref().is_some_and(|help| help.contains("as two other positions show")), "{note:?}");
}

/// The same, and the frequencies are those without it, to the last digits of quotients of two of them.
#[track_caller]
fn assert_changes_nothing(answer: &Answer, plain: &[f64]) {
    assert_is_seen_redundant(answer);
    let found = answer.omegas();
    assert_eq!(found.len(), plain.len());
    for (found, plain) in found.iter().zip(plain) {
        assert!((found / plain - 1.0).abs() < 1e-14, "{found} {plain}");
    }
}

/// Replaces `P(x y)` by that place, or direction, in the frame turned by the angle of c and s.
fn in_turned_frame(mut text: String) -> String {
    while let Some(at) = text.find("P(") {
        let end = at + text[at..].find(')').expect("closed");
        let (x, y) = text[at + 2..end].split_once(' ').expect("two numbers");
        text.replace_range(at..=end, &format!("(({x}) * c - ({y}) * s, ({x}) * s + ({y}) * c)"));
    }
    text
}

#[test]
fn immobile_and_branching_mechanisms_are_refused() {
    let three_bars = |last: &str| {
        format!(
            "gravity 9.81 m/s^2
            body bar {{ mass = 2 kg, shape = rod((0, -1 m), (2 m, -1 m)) }}
            body l1 {{ mass = 1 kg, shape = rod((0, 0), (0, -1 m)) }}
            body l2 {{ mass = 1 kg, shape = rod((1 m, 0), (1 m, -1 m)) }}
            body l3 {{ mass = 1 kg, shape = rod({last}, (2 m, -1 m)) }}
            pivot a1: ground@(0, 0) -- l1\npivot b1: bar@(0, -1 m) -- l1
            pivot a2: ground@(1 m, 0) -- l2\npivot b2: bar@(1 m, -1 m) -- l2
            pivot a3: ground@{last} -- l3\npivot b3: bar@(2 m, -1 m) -- l3"
        )
    };
    // A shorter bar, and one to the side: both lock.
    assert_eq!(refusal(&three_bars("(2 m, -0.3 m)")), ["vib::loop::conflict"]);
    assert_eq!(refusal(&three_bars("(2.5 m, 0)")), ["vib::loop::conflict"]);
    // However little longer a bar is: the drawing is rational, so nothing is taken for zero.
    assert_eq!(refusal(&three_bars("(2 m, 1e-20 m)")), ["vib::loop::conflict"]);
    let gears = "body a { inertia = 1 kg*m^2, turns }\nbody b { inertia = 1 kg*m^2, turns }
        body m { mass = 1 kg, moves x }\nspring s: ground -- m { k = 1 N/m }
        couple one: a.angle = 2 * b.angle\ncouple two: a.angle = 3 * b.angle";
    assert_eq!(refusal(gears), ["vib::loop::conflict"]);
    let driven = "base floor { moves y }\nbody m { mass = 1 kg, moves x, at = (0, 0) }\nbody n { mass = 1 kg, moves x }
        weld w: floor -- m";
    assert_eq!(refusal(driven), ["vib::loop::conflict"]);
    // P18 of the published cases: links of 1 m and 1 kg, all in line.
    for turned in ["0", "30 deg"] {
        let mut text = format!("gravity 9.81 m/s^2\nlet c = cos({turned}) * 1 m\nlet s = sin({turned}) * 1 m\n");
        for i in 0..3 {
            text += &format!(
                "body l{i} {{ mass = 1 kg, shape = rod(({i} * c, {i} * s), (({i} + 1) * c, ({i} + 1) * s)) }}\n"
            );
            let carrier = if i == 0 { "ground".to_string() } else { format!("l{}", i - 1) };
            text += &format!("pivot p{i}: {carrier}@({i} * c, {i} * s) -- l{i}\n");
        }
        text += "pivot p3: ground@(3 * c, 3 * s) -- l2\n";
        assert_eq!(refusal(&text), ["vib::loop::rank_drop"], "{turned}");
    }
}

/// A flat parallelogram whose coupler consists of two links, coupled at a pivot beside the line: not all pivots are in
/// line, and still the cranks may turn in the same or in opposite directions from here.
#[test]
fn a_position_from_which_motions_branch_off_is_refused_off_the_line_too() {
    let flat = |turn: &str| {
        format!(
            "let c = cos({turn}) * 1 m\nlet s = sin({turn}) * 1 m
            body one {{ mass = 1 kg, shape = rod((0, 0), (2 * c, 2 * s)) }}
            body two {{ mass = 1 kg, shape = rod((c, s), (3 * c, 3 * s)) }}
            body left {{ mass = 1 kg, shape = rod((2 * c, 2 * s), (2.5 * c - s, 2.5 * s + c)) }}
            body right {{ mass = 1 kg, shape = rod((2.5 * c - s, 2.5 * s + c), (3 * c, 3 * s)) }}
            pivot a: ground@(0, 0) -- one\npivot b: one@(2 * c, 2 * s) -- left
            pivot e: left@(2.5 * c - s, 2.5 * s + c) -- right\npivot d: ground@(c, s) -- two
            couple stiff: left.angle = right.angle
            pivot closing: two@(3 * c, 3 * s) -- right\n"
        )
    };
    assert_eq!(refusal(&flat("0")), ["vib::loop::rank_drop"]);
    // Stretched between supports too far apart for any motion, the same links lock.
    let locked =
        flat("0").replace("ground@(c, s) -- two", "ground@(5 * c, s) -- two").replace("(c, s), (3", "(5 * c, s), (3");
    assert_eq!(refusal(&locked), ["vib::loop::conflict"]);
}

const RANDOM: u64 = 120;

/// Random loops, as drawn and under loads. A scene that is refused is over-constrained, or has no such motion.
#[test]
fn random_linkages() {
    let mut met = 0;
    for seed in 1..=RANDOM {
        let text = random_scenes::linkage(seed, 5, seed % 2 == 0);
        match try_ask(&text) {
            Ok(answer) => {
                met += usize::from(!answer.lowered.rest.dependent.is_empty());
                assert_formulations_agree_within(&answer, TOLERANCE, &text);
            }
            Err(diagnostics) => {
                for error in diagnostics.iter().filter(|diagnostic| diagnostic.is_error()) {
                    let known = ["vib::loop::conflict", "vib::element::no_end_turns", "vib::motion::impossible"];
                    assert!(known.contains(&error.code.0), "{error:?} in\n{text}");
                }
            }
        }
    }
    assert!(met > 60, "{met}");
}

/// Stiff springs instead of constraints approach these as their stiffness grows: the difference of every frequency
/// falls as 1/k.
#[test]
fn penalty_springs_tend_to_the_constraint() {
    let linkage = |last: &str| {
        format!(
            "gravity 9.81 m/s^2
            body a {{ mass = 1 kg, shape = rod((0, 0), (-1 m, -1 m)) }}
            body b {{ mass = 2 kg, shape = rod((-1 m, -1 m), (1 m, -1.5 m)) }}
            body c {{ mass = 1 kg, shape = rod((1 m, -1.5 m), (1.5 m, 0)) }}
            pivot p: ground@(0, 0) -- a\npivot q: a@(-1 m, -1 m) -- b\npivot r: ground@(1.5 m, 0) -- c
            spring s: ground -- a {{ k = 5 N*m/rad }}\n{last}"
        )
    };
    let truth = ask(&linkage("pivot w: b@(1 m, -1.5 m) -- c")).omegas();
    let gap = |k: &str| {
        let spring = |axis: &str| {
            format!("spring w{axis}: b@(1 m, -1.5 m) -- c@(1 m, -1.5 m) {{ k = {k} N/m, along = {axis} }}\n")
        };
        let omegas = ask(&linkage(&(spring("x") + &spring("y")))).omegas();
        truth.iter().zip(&omegas).map(|(a, b)| (a - b).abs() / a).fold(0.0, f64::max)
    };
    let gaps = [gap("1e6"), gap("1e8"), gap("1e10")];
    assert!(gaps[0] < 1e-3, "{gaps:?}");
    for pair in gaps.windows(2) {
        assert!((pair[0] / pair[1] - 100.0).abs() < 5.0, "{gaps:?}");
    }
}

/// A train of 400 gear pairs under a torque T at its end, each pair reversing the rotation: every shaft of stiffness k
/// is wound by T / k, so the last disc turns by T / k_0 + 400 T / k. Solved by sparse factors, not as a dense loop.
#[test]
fn a_long_gear_train_is_wound_by_its_torque() {
    let answer = system(
        "body d[0] { inertia = 1 kg*m^2, turns }
        spring g: ground -- d[0] { k = 10 N*m/rad }
        repeat i in 1..400 {
          body d[i] { inertia = 1 kg*m^2, turns }
          body e[i] { inertia = 0.3 kg*m^2, turns }
          spring s[i]: d[i-1] -- e[i] { k = 100 N*m/rad }
          couple c[i]: d[i].angle = -e[i].angle
        }
        torque T: d[400] = constant(5 N*m)",
    );
    let turned: Vec<f64> = answer.rest.displacement.iter().map(Number::to_f64).collect();
    let names = answer.system.coordinate_names();
    for (name, turned) in names.iter().zip(&turned) {
        let stage: i32 = name[2..name.len() - 7].parse().expect("d[number].angle");
        let truth = (0.5 + 0.05 * f64::from(stage)) * if stage % 2 == 0 { 1.0 } else { -1.0 };
        assert!((turned - truth).abs() < 1e-13 * truth.abs(), "{name}: {turned}, {truth}");
    }
    assert_eq!((turned.len(), answer.rest.dependent.len()), (401, 400));
}

/// Masses of 1 kg on springs of 1 N/m, each coupled to move 15/14 times as much as the one before. With r = (14/15)²: M
/// = 1 + r + ... + r^(n-1) at the last mass, and the springs stretch by 1/15 of the motion of their far ends.
#[test]
fn a_long_chain_of_ratios_has_its_closed_form() {
    let chain = |n: u32| {
        ask(&format!(
            "body m[1] {{ mass = 1 kg, moves x }}\nspring k[1]: ground -- m[1] {{ k = 1 N/m }}
            repeat i in 2..{n} {{
              body m[i] {{ mass = 1 kg, moves x }}
              spring k[i]: m[i-1] -- m[i] {{ k = 1 N/m }}
              couple c[i]: m[i].x = 1.5 * m[i-1].x / 1.4
            }}"
        ))
    };
    for n in [2, 40, 150] {
        let r = (14.0_f64 / 15.0).powi(2);
        let mass: f64 = (0..n).map(|i| r.powi(i)).sum();
        let stiffness: f64 = (0..n - 1).map(|i| r.powi(i) / 225.0).sum::<f64>() + r.powi(n - 1);
        assert_omegas(&chain(n as u32), &[(stiffness / mass).sqrt()]);
    }
    // r^3000 is 1e-180: the first spring has no effect, and omega is 1/15. Fractions of more than 8192 bits are balls.
    let omega = chain(3000).modes.list[0].omega;
    assert!((omega - Rational::new(1, 15).to_ball()).contains_zero(), "{omega:?}");
    assert!(omega.relative_error() < 1e-26, "{omega:?}");
}

/// Weights act along x on a chain of couplings that ends at the point (px, py) of a lever; a spring with the torque
/// that balances them holds it. The chain pulls at the lever with Q = g (1 + s + ... + s^(n-1)), where s = 14/15 is the
/// ratio of a step: the reaction in the first coupling. X = px cos a - py sin a - px, so K = k - Q X'' = k + Q px, with
/// px from the drawing.
#[test]
fn a_chain_of_couplings_loads_the_lever_that_it_hangs_at() {
    for (n, px, py) in [(1, 0.3, 1.0), (6, 0.3, 1.0), (60, -0.2, 0.5)] {
        let answer = ask(&format!(
            "gravity (10 m/s^2, 0)\nrest as drawn
            body lever {{ mass = 2 kg, at = (0, 0), inertia = 3 kg*m^2 }}
            pivot p: ground@(0, 0) -- lever
            spring k: ground -- lever {{ k = 4000 N*m/rad }}
            body m[1] {{ mass = 1 kg, moves x }}
            couple c[1]: lever@({px} m, {py} m).x = m[1].x
            repeat i in 2..{n} {{
              body m[i] {{ mass = 1 kg, moves x }}
              couple c[i]: m[i-1].x = 1.5 * m[i].x / 1.4
            }}"
        ));
        let s: f64 = 14.0 / 15.0;
        let pull = 10.0 * (0..n).map(|i| s.powi(i)).sum::<f64>();
        let inertia = 3.0 + py * py * (0..n).map(|i| s.powi(2 * i)).sum::<f64>();
        let torque = answer.lowered.rest.tensions[0].tension.to_f64().abs();
        assert!((torque - pull * py).abs() < 1e-12 * torque, "{torque}, {}", pull * py);
        assert_omegas(&answer, &[((4000.0 + pull * px) / inertia).sqrt()]);
    }
}

/// A ring of couplings that no motion satisfies is one mistake, however long it is; each coupling that follows from a
/// chain gets a note of its own.
#[test]
fn long_rings_of_couplings_are_judged() {
    let ring = |n: u32, ratio: &str, closing: &str| {
        format!(
            "body m[1] {{ mass = 1 kg, moves x }}\nbody free {{ mass = 1 kg, moves x }}
            repeat i in 2..{n} {{ body m[i] {{ mass = 1 kg, moves x }}\n couple c[i]: m[i].x = {ratio} * m[i-1].x }}
            {closing}"
        )
    };
    assert_eq!(refusal(&ring(700, "1", "couple e: m[700].x = 2 * m[1].x")), ["vib::loop::conflict"]);
    assert_eq!(refusal(&ring(120, "15/14", "couple e: m[120].x = 2 * m[1].x")), ["vib::loop::conflict"]);
    let two = "couple e: m[40].x = 2 * m[1].x
        body n[1] { mass = 1 kg, moves x }\nbody n[2] { mass = 1 kg, moves x }
        couple f: n[1].x = n[2].x\ncouple g: n[1].x = 3 * n[2].x";
    assert_eq!(refusal(&ring(40, "15/14", two)), ["vib::loop::conflict"; 2]);
    let closed = ask(&ring(60, "15/14", "repeat i in 1..20 { couple e[i]: m[60].x = (15/14)^59 * m[1].x }"));
    let codes: Vec<String> = closed.remarks.iter().map(|d| d.code.to_string()).collect();
    assert_eq!((codes.len(), closed.lowered.system.n()), (20, 2), "{codes:?}");
    assert!(codes.iter().all(|code| code == "vib::loop::redundant"), "{codes:?}");
}

/// Chains closed by thousands of couplings would need a number for each pair of them.
#[test]
fn loops_without_room_are_refused() {
    let text = "body m[1] { mass = 1 kg, moves x }
        repeat i in 2..2500 { body m[i] { mass = 1 kg, moves x }\n couple c[i]: m[i].x = m[i-1].x }
        repeat i in 1..2500 { couple e[i]: m[2500].x = m[1].x }";
    assert_eq!(refusal(text), ["vib::limit::loops"]);
}

/// A base that a constant signal holds to the side moves the parts that couplings and joints tie to it, exactly if
/// these are linear.
#[test]
fn a_base_held_aside_takes_its_loops_along() {
    let cam = system(
        "base cam { turns, at = (0, 0) } = constant(0.5 rad)
        body follower { mass = 2 kg, moves y, at = (0, 1 m) }
        body load { mass = 1 kg, moves y, at = (0, 2 m) }
        couple lift: follower.y = cam.angle * 0.05 m
        spring s: follower -- load { k = 100 N/m }",
    );
    assert_eq!(cam.rest.displacement, [Number::from(Rational::new(1, 40))]);
    assert_eq!(cam.rest.dependent[0].displacement, Number::from(Rational::new(1, 40)));
}

/// The lowered system, without its modes.
fn system(text: &str) -> vibc::lower::Lowered {
    let mut sources = vibc::base::Sources::new();
    let file = sources.add(vibc::base::SourceFile::model("model.vib", text));
    let parsed = vibc::syntax::parse(&sources, file);
    let checked = vibc::model::check(&sources, &parsed.tree, &vibc::model::Overrides::default());
    let scene = checked.scene.unwrap_or_else(|| panic!("{:?} {:?}", parsed.errors, checked.diagnostics));
    let outcome = vibc::lower::lower(&scene);
    outcome.lowered.unwrap_or_else(|| panic!("{:?}", outcome.diagnostics))
}

/// P22 of the published cases, an anchor chain whose links are drawn as a V between two fixed ends, far from its rest;
/// also turned. It hangs like a catenary: symmetric, with a smaller slope at every link, and stable.
#[test]
fn a_chain_between_two_ends_finds_its_rest() {
    let chain = |turned: &str| {
        format!(
            "let c = cos({turned})\nlet s = sin({turned})
            gravity (9.81 m/s^2 * s, -9.81 m/s^2 * c)
            repeat i in 0..9 {{ point L[i] = ((c * i / 4 + s * i * 3 / 5) * 1 m, (s * i / 4 - c * i * 3 / 5) * 1 m) }}
            repeat i in 10..20 {{
              point L[i] = ((c * i / 4 + s * (20 - i) * 3 / 5) * 1 m, (s * i / 4 - c * (20 - i) * 3 / 5) * 1 m)
            }}
            repeat i in 1..20 {{ body l[i] {{ mass = 10 kg, shape = rod(L[i-1], L[i]) }} }}
            repeat i in 2..20 {{ pivot p[i]: l[i-1]@(L[i-1]) -- l[i] }}
            pivot p[1]: ground@(L[0]) -- l[1]\npivot p[21]: l[20]@(L[20]) -- ground"
        )
    };
    let plain = ask(&chain("0"));
    assert!(plain.lowered.rest.is_proven() && plain.lowered.rest.residual < 1e-25, "{:?}", plain.lowered.rest.residual);
    let omegas = plain.omegas();
    assert!(omegas.len() == 18 && omegas.iter().all(|omega| *omega > 0.0), "{omegas:?}");
    let rest = &plain.lowered.rest;
    let names = plain.lowered.system.coordinate_names();
    let own = names.into_iter().zip(&rest.displacement);
    let words = &plain.lowered.system;
    let dependent = rest.dependent.iter().map(|d| (words.display(d.coordinate.name), &d.displacement));
    let turned: std::collections::BTreeMap<String, f64> = own.chain(dependent).map(|(n, d)| (n, d.to_f64())).collect();
    let slope = |i: i32| {
        let drawn = if i <= 10 { -1f64 } else { 1.0 } * (0.6f64 / 0.25).atan();
        (drawn + turned[&format!("l[{i}].angle")]).tan()
    };
    // Weight of one link over the horizontal pull: equal for all neighbours.
    let step = slope(2) - slope(1);
    for i in 2..20 {
        assert!((slope(i + 1) - slope(i) - step).abs() < 1e-12, "{i}");
    }
    assert!((slope(1) + slope(20)).abs() < 1e-12);
    for (a, b) in omegas.iter().zip(ask(&chain("30 deg")).omegas()) {
        assert!((a - b).abs() < 1e-13 * a, "{a} {b}");
    }
}
