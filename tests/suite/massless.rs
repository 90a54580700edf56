//! Bodies without mass: how a coordinate without inertia follows the others, and the effect of the field's elements
//! with inner nodes (springs in series, Maxwell, Zener) in every answer. The hard cases o17, o18 and o33 as models.

use super::ask::{Answer, ask};
use super::systems::number;
use vibc::analysis::{Frequency, Transfer, respond};
use vibc::base::{Ball, Diagnostic, Number, Rational, SourceFile, Sources};
use vibc::model::Overrides;

/// A massless node between springs of 1e14, 1 and 3e5 N/m.
const SERIES: &str = "
    body m1 { mass = 2 kg, moves x }
    body n  { mass = 0 kg, moves x }
    body m3 { mass = 1 kg, moves x }
    spring a: m1 -- n { k = 1e14 N/m }
    spring b: n -- ground { k = 1 N/m }
    spring c: n -- m3 { k = 3e5 N/m }
    initial m3 { x = 1 mm }
    output x1 = m1.x
    output x3 = m3.x";

/// The equivalent of `SERIES` without the node: each pair of its springs becomes one of k_i k_j / sum k (star to mesh).
const MESH: &str = "
    param a = 1e14 N/m
    param b = 1 N/m
    param c = 3e5 N/m
    body m1 { mass = 2 kg, moves x }
    body m3 { mass = 1 kg, moves x }
    spring ab: m1 -- ground { k = a * b / (a + b + c) }
    spring ac: m1 -- m3     { k = a * c / (a + b + c) }
    spring bc: m3 -- ground { k = b * c / (a + b + c) }
    initial m3 { x = 1 mm }
    output x1 = m1.x
    output x3 = m3.x";

/// A mass on a spring in parallel with a spring and a damper in series (Zener).
const ZENER: &str = "
    body m { mass = 1 kg, moves x }
    body n { mass = 0 kg, moves x }
    spring k1: m -- ground { k = 100 N/m }
    spring k2: m -- n { k = 1e6 N/m }
    damper c: n -- ground { c = 0.01 N*s/m }
    force F: m along x
    initial m { x = 1 mm }
    output x = m.x
    output y = n.x";

/// Whether a ball contains a number that is known to 36 digits, and is no wider than 1e-15 of it.
fn holds(ball: Ball, truth: &str) {
    let difference = (&Number::Ball(ball) - &number(truth)).to_ball();
    let size = ball.to_f64().abs();
    assert!(difference.mid.abs().to_f64() <= difference.rad + 1e-35 * size, "{ball:?} against {truth}");
    assert!(ball.rad <= 1e-15 * size, "{ball:?}");
}

fn times(list: &[i64]) -> Vec<Number> {
    list.iter().map(|t| Number::from(Rational::new(*t, 100))).collect()
}

fn motion(answer: &Answer, times: &[Number]) -> Vec<Vec<Ball>> {
    let drives = vibc::lower::drives(&answer.scene).expect("signals");
    respond(&answer.lowered.system, &drives, times).expect("a motion").values
}

#[test]
fn a_massless_node_between_springs_is_condensed_exactly() {
    let answer = ask(SERIES);
    assert_eq!((answer.modes.list.len(), answer.modes.infinite), (2, 1));
    holds(answer.modes.list[0].omega, "0.577350162272858466438480994543097374");
    holds(answer.modes.list[1].omega, "670.820516469783538439306049635983381");
}

#[test]
fn a_massless_node_moves_as_the_mesh_of_its_springs_would() {
    let at = times(&[0, 5, 37, 1000]);
    let (node, mesh) = (motion(&ask(SERIES), &at), motion(&ask(MESH), &at));
    for (node, mesh) in node.iter().flatten().zip(mesh.iter().flatten()) {
        let apart = (*node - *mesh).mid.abs().to_f64();
        assert!(apart <= node.rad + mesh.rad, "{node:?} against {mesh:?}");
        assert!(apart <= 1e-15 * 1e-3, "{node:?} against {mesh:?}");
    }
}

#[test]
fn a_node_with_a_damper_keeps_its_relaxation_as_a_real_pole() {
    let answer = ask(ZENER);
    let poles = &answer.poles;
    assert_eq!((poles.list.len(), poles.infinite()), (3, Some(1)));
    let upper = poles.list.iter().find(|pole| pole.im.is_positive()).expect("an oscillation");
    holds(upper.re, "-0.00500000000049995000009998000052499250");
    holds(upper.im, "9.99999875049992168760270980318944494");
    let real = poles.list.iter().find(|pole| pole.im.is_zero()).expect("a relaxation");
    holds(real.re, "-99999999.9899999999990000999998000400");
}

#[test]
fn a_node_with_a_damper_is_in_the_transfer_function() {
    let answer = ask(ZENER);
    let at = |omega: i64| {
        let frequency = Frequency::radians(&Number::from(omega));
        let gains = Transfer::of(&answer.lowered.system).between(&frequency, &[0], &[0, 1]);
        [0, 1].map(|output: usize| gains[0][output].disc().expect("a gain"))
    };
    let truths = [
        (1, ["0.0101010099979388838086065228303272408", "0.0101010099979286797581035748760874432"]),
        (1000, ["-1.00010001000099009700940090008501791e-6", "-1.00010001000100009900970094009000850e-6"]),
        (100_000_000, ["-1.00000000005001000000000100009975000e-16", "-5.00000000050005000002501000050000075e-17"]),
    ];
    for (omega, truth) in truths {
        for (gain, truth) in at(omega).iter().zip(truth) {
            let truth = number(truth).to_f64();
            assert!((gain.value.re.to_f64() - truth).abs() <= gain.radius + 1e-16 * truth.abs(), "{omega}: {gain:?}");
        }
    }
}

/// x(t) = 2 Re(a exp(s t)) + w exp(r t) from the poles s and r alone, with x(0) = 1 mm, x'(0) = 0 and x''(0) = -(k1 +
/// k2) x(0) / m, because the node is initially at rest.
#[test]
fn a_node_with_a_damper_relaxes_in_time() {
    let answer = ask(ZENER);
    let (re, im, r) = (-0.00500000000049995, 9.999998750499922, -99999999.99);
    let s2 = [re * re - im * im, 2.0 * re * im];
    // Rows: displacement, velocity over |r|, acceleration over r^2; unknowns Re a, Im a, w.
    let matrix = nalgebra::Matrix3::new(
        2.0,
        0.0,
        1.0,
        2.0 * re / r,
        -2.0 * im / r,
        1.0,
        2.0 * s2[0] / (r * r),
        -2.0 * s2[1] / (r * r),
        1.0,
    );
    let start = nalgebra::Vector3::new(1e-3, 0.0, -1_000_100.0 * 1e-3 / (r * r));
    let a = matrix.lu().solve(&start).expect("poles that differ");
    let at = times(&[5, 50, 300]);
    for (t, values) in at.iter().zip(motion(&answer, &at)) {
        let t = t.to_f64();
        let truth = 2.0 * (re * t).exp() * (a.x * (im * t).cos() - a.y * (im * t).sin()) + a.z * (r * t).exp();
        // The system of equations is solved in binary64; its condition number is |r / im| = 1e7.
        assert!((values[0].to_f64() - truth).abs() <= 1e-9 * 1e-3, "{t} s: {} against {truth}", values[0].to_f64());
    }
}

#[test]
fn a_node_between_only_dampers_is_a_free_state() {
    let answer = ask("body m { mass = 2 kg, moves x }
        body n { mass = 0 kg, moves x }
        spring s: m -- ground { k = 8 N/m }
        damper c: m -- n { c = 1 N*s/m }
        damper d: n -- ground { c = 3 N*s/m }");
    // In series the two dampers are equivalent to one of 3/4 N s/m: s^2 + (3/8) s + 4 = 0, and the node can rest
    // anywhere.
    let upper = answer.poles.list.iter().find(|pole| pole.im.is_positive()).expect("an oscillation");
    assert!((upper.re.to_f64() + 3.0 / 16.0).abs() < 1e-15);
    assert!(answer.poles.list.iter().any(|pole| pole.re.is_zero() && pole.im.is_zero()));
    assert_eq!(answer.poles.list.len(), 3);
}

#[test]
fn massless_links_and_levers_carry_their_loads() {
    // A bob pinned to a massless link, kept upright by a spring: the pendulum's frequency is sqrt(g/l).
    let pendulum = ask("gravity 9.81 m/s^2
        body link { mass = 0 kg, shape = rod((0, 0), (0, -1 m)) }
        body bob { mass = 2 kg, inertia = 0 kg*m^2, at = (0, -1 m) }
        pivot p: ground@(0, 0) -- link
        pivot q: link@(0, -1 m) -- bob
        spring s: ground -- bob { k = 2 N*m/rad }");
    assert_eq!((pendulum.modes.list.len(), pendulum.modes.infinite), (1, 1));
    assert!((pendulum.omegas()[0] - 9.81f64.sqrt()).abs() < 1e-15);
    // A massless lever of ratio 2 on a spring k: the mass at half its length acts on 4 k in series with its own spring.
    let lever = ask("body lever { mass = 0 kg, shape = rod((0, 0), (2 m, 0)) }
        pivot p: ground@(0, 0) -- lever
        body m { mass = 1 kg, at = (1 m, 1 m), moves y }
        spring a: lever@(2 m, 0) -- ground@(2 m, -1 m) { k = 100 N/m }
        spring b: m -- lever@(1 m, 0) { k = 1000 N/m }");
    assert!((lever.omegas()[0] - (400.0f64 * 1000.0 / 1400.0).sqrt()).abs() < 1e-13);
}

/// The findings of `analyze` and `simulate` for a model.
fn refused(text: &str) -> [Vec<Diagnostic>; 2] {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("model.vib", text));
    let simulated = vibc::simulate(&sources, file, &Overrides::default(), &times(&[0, 100]));
    [vibc::analyze(&sources, file, &Overrides::default()).diagnostics, simulated.diagnostics]
}

/// Two springs of 3 N/m in series carry a mass: of a.x and b.x, which both move it, one combination has no inertia. It
/// is not free to move, and an initial value of it is not lost in silence: motions in time say that they do not take it.
#[test]
fn coordinates_that_move_one_mass_together_are_named_by_motions() {
    for (more, what) in [("", "inertia"), ("damper d: a -- ground { c = 1 N*s/m }\n", "inertia")] {
        let text = format!(
            "body a {{ mass = 0 kg, moves x }}\nbody b {{ mass = 0 kg, moves x }}\nbody m {{ mass = 1 kg, moves x }}\n\
             couple q: m.x = a.x + b.x\nspring t: b -- ground {{ k = 3 N/m }}\nspring u: a -- ground {{ k = 3 N/m }}\n\
             {more}output x = m.x\ninitial a {{ x = 1 mm, vx = 2 m/s }}\ninitial b {{ x = 0 mm, vx = 0 m/s }}\n"
        );
        if more.is_empty() {
            let answer = ask(&text);
            assert_eq!((answer.modes.list.len(), answer.modes.infinite), (1, 1));
            assert!((answer.omegas()[0] - 1.5f64.sqrt()).abs() < 1e-15);
        }
        let [_, simulated] = refused(&text);
        assert_eq!((simulated.len(), simulated[0].code.0), (1, "vib::mass::singular"));
        let said = format!("some combination of a.x, b.x moves without {what}, and springs");
        assert!(simulated[0].message.starts_with(&said), "{}", simulated[0].message);
    }
    // A damper between two points without mass: their common motion has none.
    let text = "body a { mass = 0 kg, moves x }\nbody b { mass = 0 kg, moves x }\ndamper d: a -- b { c = 1 N*s/m }\n\
                spring t: b -- ground { k = 3 N/m }\nspring u: a -- ground { k = 3 N/m }\noutput x = a.x\n\
                initial a { x = 1 mm }\ninitial b { x = 0 mm }\n";
    let [_, simulated] = refused(text);
    let said = "some combination of a.x, b.x moves without inertia and damping, and springs";
    assert!(simulated.len() == 1 && simulated[0].message.starts_with(said), "{simulated:?}");
}

#[test]
fn nodes_that_float_are_named_by_every_command() {
    let text = "body m1 { mass = 1 kg, moves x }
        body a { mass = 0 kg, moves x }
        body b { mass = 0 kg, moves x }
        spring k1: m1 -- ground { k = 10 N/m }
        spring k2: a -- b { k = 5 N/m }
        output x = m1.x";
    for found in refused(text) {
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].code.0, "vib::mass::singular");
        assert!(found[0].message.contains("a.x") && found[0].message.contains("b.x"), "{}", found[0].message);
    }
}

#[test]
fn a_body_with_neither_inertia_nor_stiffness_nor_damper_is_named() {
    let text = "body cart { mass = 1 kg, moves x }
        spring s: ground -- cart { k = 10 N/m }
        body idler { mass = 0 kg, moves x }
        output x = cart.x";
    for found in refused(text) {
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].code.0, "vib::freedom::no_inertia");
        assert!(found[0].message.contains("`idler.x`"), "{}", found[0].message);
    }
}

/// Eight bodies, each connected to each, six of them without mass: every elimination step would square the number of
/// terms, up to 1e12 and more at the end. All springs have k = 1 N/m, and each of the two heavy bodies is connected to
/// the ground: by symmetry the massless ones move as the mean of the heavy ones, so these are connected by 1 + 6 / 2 =
/// 4 N/m.
#[test]
fn a_symmetric_dense_net_of_massless_bodies_is_eliminated() {
    let mut text = String::from(
        "repeat i in 1..2 { body m[i] { mass = 1 kg, moves x }\n spring g[i]: ground -- m[i] { k = 1 N/m } }\n\
         repeat i in 3..8 { body m[i] { mass = 0 kg, moves x } }\n",
    );
    for i in 1..=8 {
        for j in i + 1..=8 {
            text += &format!("spring k{i}{j}: m[{i}] -- m[{j}] {{ k = 1 N/m }}\n");
        }
    }
    let mut sources = vibc::base::Sources::new();
    let file = sources.add(vibc::base::SourceFile::model("net.vib", &text));
    let outcome = vibc::analyze(&sources, file, &vibc::model::Overrides::default());
    let answer = outcome.answer.expect("an answer");
    assert_eq!(answer.modes.infinite, 6);
    // K = [1 + k, -k; -k, 1 + k], k = 4: 1 and 1 + 2 k = 9, omega 1 and 3.
    let found: Vec<f64> = answer.modes.list.iter().map(|mode| mode.omega.to_f64()).collect();
    assert!(found.len() == 2 && (found[0] - 1.0).abs() < 1e-15 && (found[1] - 3.0).abs() < 1e-15, "{found:?}");
}

/// 24 bodies, each connected to each by springs of 15 different stiffnesses, all but two of them without mass, compared
/// with Gaussian elimination of the assembled matrix in fractions.
#[test]
fn a_dense_net_of_massless_bodies_is_their_schur_complement() {
    const N: usize = 24;
    let stiffness = |i: usize, j: usize| (1 + (7 * i + 11 * j) % 15) as i64;
    let mut k = vec![vec![Rational::ZERO; N]; N];
    let mut text = String::new();
    for i in 0..N {
        text += &format!("body m{i} {{ mass = {} kg, moves x }}\n", [2, 3].get(i).unwrap_or(&0));
        text += &format!("spring g{i}: ground -- m{i} {{ k = {} N/m }}\n", 1 + i % 2);
        k[i][i] = &k[i][i] + &Rational::from(1 + i as i64 % 2);
        for j in i + 1..N {
            let value = Rational::from(stiffness(i, j));
            text += &format!("spring k{i}_{j}: m{i} -- m{j} {{ k = {} N/m }}\n", stiffness(i, j));
            for (a, b, sign) in [(i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)] {
                k[a][b] = &k[a][b] + &(&value * &Rational::from(sign));
            }
        }
    }
    for pivot in (2..N).rev() {
        let inverse = k[pivot][pivot].recip().expect("positive");
        for i in 0..pivot {
            for j in 0..pivot {
                k[i][j] = &k[i][j] - &(&(&k[i][pivot] * &k[pivot][j]) * &inverse);
            }
        }
    }
    // For 2 and 3 kg: the sum and the product of both omega².
    let per = |value: &Rational, by: i64| value * &Rational::new(1, by);
    let sum = &per(&k[0][0], 2) + &per(&k[1][1], 3);
    let product = per(&(&(&k[0][0] * &k[1][1]) - &(&k[0][1] * &k[1][0])), 6);
    let answer = ask(&text);
    assert_eq!((answer.modes.list.len(), answer.modes.infinite), (2, N - 2));
    let [one, two] = [0, 1].map(|i| answer.modes.list[i].omega_squared);
    for (found, truth) in [(one + two, sum), (one * two, product)] {
        assert!((found - truth.to_ball()).contains_zero() && found.relative_error() < 1e-25, "{found:?}");
    }
}

/// A hub without mass between 300 others makes 45,150 squares of different rows.
#[test]
fn a_star_of_hundreds_is_condensed() {
    // Each of n equal masses hangs on the hub by k, and the hub on the ground by n k: moving together, each is on k /
    // 2; moving against each other, they leave the hub at rest.
    let answer = ask("body hub { mass = 0 kg, moves x }\nspring g: ground -- hub { k = 300 N/m }
        repeat i in 1..300 {
          body m[i] { mass = 1 kg, moves x }
          spring k[i]: hub -- m[i] { k = 1 N/m }
        }");
    let omegas = answer.omegas();
    assert_eq!((omegas.len(), answer.modes.infinite), (300, 1));
    assert!((omegas[0] - 0.5_f64.sqrt()).abs() < 1e-15 && omegas[1..].iter().all(|omega| (omega - 1.0).abs() < 1e-15));
}

/// If the elimination exceeds its limit, the limit is named instead of an undetermined motion: 60 nodes in the plane,
/// each connected to each by springs along irrational directions, so that no two squares are known to be proportional.
#[test]
fn a_net_without_room_is_refused_as_such() {
    let mut text = String::from("body m[1] { mass = 1 kg, at = (0, 0), moves x y }\n");
    for i in 2..=60 {
        text += &format!("body m[{i}] {{ mass = 0 kg, at = ({} m, {} m), moves x y }}\n", i * i % 61, i * i * i % 61);
    }
    for i in 1..=60 {
        text += &format!("spring g{i}: ground@({i} m, 100 m) -- m[{i}] {{ k = 1 N/m }}\n");
        for j in i + 1..=60 {
            let angle = 60 * i + j;
            text +=
                &format!("spring k{i}_{j}: m[{i}] -- m[{j}] {{ k = 1 N/m, along = (cos({angle}), sin({angle})) }}\n");
        }
    }
    let [found, _] = refused(&text);
    assert_eq!(found.iter().map(|found| found.code.0).collect::<Vec<_>>(), ["vib::limit::massless"], "{found:?}");
}

/// Beyond exact arithmetic a node with a damper is refused because its pole is not computed, although its motion is
/// determined.
#[test]
fn nodes_with_dampers_beyond_exact_arithmetic_are_named() {
    let many = |k: &str| {
        format!(
            "body node {{ mass = 0 kg, moves x }}\ndamper d: ground -- node {{ c = 1 N*s/m }}
            repeat i in 1..12 {{ body m[i] {{ mass = 1 kg, moves x }}\n spring k[i]: node -- m[i] {{ k = {k} }} }}"
        )
    };
    let few = "body node { mass = 0 kg, moves x }\ndamper d: ground -- node { c = sin(1) * 1 N*s/m }
        body m { mass = 1 kg, moves x }\nspring k: node -- m { k = 1 N/m }";
    for (text, why) in [(many("i * 1 N/m"), "this one has 13"), (few.to_string(), "some are not")] {
        let mut sources = vibc::base::Sources::new();
        let file = sources.add(vibc::base::SourceFile::model("node.vib", &text));
        let outcome = vibc::analyze(&sources, file, &vibc::model::Overrides::default());
        let found: Vec<&Diagnostic> = outcome.diagnostics.iter().collect();
        assert_eq!((found.len(), found[0].code.0), (1, "vib::limit::massless"), "{found:?}");
        assert!(found[0].message.starts_with("node.x moves without inertia") && found[0].message.contains(why));
    }
}

/// `damping modal` damps modes alone, so a node without mass stays one: springs of 100 and 500 N/m in series hold 1 kg. Emitted code, the
/// motion and the poles by the closed form of a step.
#[test]
fn damping_by_modes_leaves_a_node_without_mass_to_follow() {
    let model = "damping modal 3 %\nbody a { mass = 1 kg, moves x }\nbody n { mass = 0 kg, moves x }\n\
                 spring s: ground -- n { k = 100 N/m }\nspring t: n -- a { k = 500 N/m }\n\
                 force F: a along x = step(2 N, 0 s)\noutput x = a.x\noutput y = n.x\n";
    let k: f64 = 500.0 / 6.0;
    let (omega, ratio) = (k.sqrt(), 0.03f64);
    let own = omega * (1.0 - ratio * ratio).sqrt();
    let swing = |t: f64| (own * t).cos() + ratio * omega / own * (own * t).sin();
    let printed = crate::program::emitted(model, "50 ms", "3 s");
    let simulated = crate::signals::simulated(model, &[], &["--until", "3 s", "--step", "50 ms"]);
    assert_eq!(printed.len(), 61);
    for row in printed.iter().chain(&simulated) {
        let x = 2.0 / k * (1.0 - (-ratio * omega * row[0]).exp() * swing(row[0]));
        assert!((row[1] - x).abs() < 1e-15 && (row[2] - x * 5.0 / 6.0).abs() < 1e-15, "{row:?}, not {x:e}");
    }
    let told = crate::program::json(model, &["analyze"]);
    let poles = told["poles"].as_array().expect("poles");
    assert_eq!(poles.len(), 2, "{told}");
    for pole in poles {
        let [re, im] = ["re", "im"].map(|part| pole[part].as_f64().expect("a number"));
        assert!((re + ratio * omega).abs() < 1e-15 && (im.abs() - own).abs() < 1e-14, "{pole}");
    }
}
