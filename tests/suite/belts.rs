//! Belts: closed forms between fixed centres, the rest and the second derivatives of the energy of a drive whose disks move,
//! written here by the lengths of the belt, and what is refused. See spec.md#belts.

use crate::program::{code, json, text};
use vibc::{ModalAnswer, Overrides, SourceFile, Sources};

fn analyzed(model: &str) -> ModalAnswer {
    let mut sources = Sources::new();
    let file = sources.add(SourceFile::model("m.vib", model));
    let outcome = vibc::analyze(&sources, file, &Overrides::default());
    let shown = vibc::diagnostics_short(&sources, &outcome.diagnostics);
    outcome.answer.unwrap_or_else(|| panic!("{model}\n{shown}"))
}

fn near(found: f64, truth: f64, share: f64) {
    assert!((found - truth).abs() <= share * truth.abs(), "{found:e}, not {truth:e}");
}

/// Between fixed centres the spans are stretched by +-(r1 a1 -+ r2 a2): omega^2 = 2 k (r1^2/J1 + r2^2/J2), with a motion that
/// stretches nothing, in the ratio of the radii. A pretension changes neither.
#[test]
fn a_belt_between_fixed_centres_has_its_closed_form() {
    for (more, sense) in
        [("", 1.0), (", crossed", -1.0), (", preload = 50 N", 1.0), (", preload = 50 N, crossed", -1.0)]
    {
        let answer = analyzed(&format!(
            "body motor {{ mass = 2 kg, shape = disk(0.1 m), at = (0, 0), turns }}\n\
             body pump {{ mass = 5 kg, shape = disk(0.25 m), at = (0.7 m, 0.2 m), turns }}\n\
             belt r: motor -- pump {{ k = 200 kN/m{more} }}\n"
        ));
        // J = m r^2 / 2
        let omega = (4e5_f64 * (2.0 / 2.0 + 2.0 / 5.0)).sqrt();
        let [rigid, swing] = &answer.modes.list[..] else { panic!("two modes") };
        assert!(rigid.omega.is_zero(), "{:?}", rigid.omega);
        near(swing.omega.to_f64(), omega, 1e-13);
        assert!(swing.omega.rad < 1e-12 * omega);
        near(rigid.shape[0] / rigid.shape[1], sense * 2.5, 1e-12);
    }
}

/// The stretches of both spans, by the angles of their normals.
pub fn spans(from: [f64; 3], to: [f64; 3], radii: [f64; 2], crossed: bool) -> [f64; 2] {
    let other = if crossed { -radii[1] } else { radii[1] };
    let gap = radii[0] - other;
    [1.0, -1.0].map(|side: f64| {
        let (x, y) = (to[0] - from[0], to[1] - from[1]);
        let length = (x * x + y * y - gap * gap).sqrt();
        let normal = y.atan2(x) + side * (gap / x.hypot(y)).acos();
        // What is not wound up on either disk.
        length + side * (radii[0] * (from[2] - normal) - other * (to[2] - normal))
    })
}

/// A motor on a rocker and a pump on springs, with pretension: the rest is where the energy has no slope, and the squares of
/// the frequencies are the eigenvalues of its second differences.
#[test]
fn a_belt_between_disks_that_move_has_the_derivatives_of_its_energy() {
    for (crossed, word) in [(false, ""), (true, ", crossed")] {
        let answer = analyzed(&format!(
            "gravity 9.81 m/s^2\nbody motor {{ mass = 1 kg, shape = disk(0.1 m), at = (0, 0), moves x, turns }}\n\
             body pump {{ mass = 1 kg, shape = disk(0.2 m), at = (0.6 m, 0.3 m), moves y, turns }}\n\
             spring s: ground -- motor {{ k = 3 kN/m, along = x }}\nspring u: ground -- pump {{ k = 5 kN/m, along = y }}\n\
             spring t: ground -- motor {{ k = 40 N*m/rad }}\nspring v: ground -- pump {{ k = 60 N*m/rad }}\n\
             belt r: motor -- pump {{ k = 2 kN/m, preload = 90 N{word} }}\n"
        ));
        assert!(answer.rest.is_proven());
        let drawn = spans([0.0; 3], [0.6, 0.3, 0.0], [0.1, 0.2], crossed);
        let energy = |q: [f64; 4]| {
            let now = spans([q[0], 0.0, q[1]], [0.6, 0.3 + q[2], q[3]], [0.1, 0.2], crossed);
            let belt: f64 =
                now.iter().zip(drawn).map(|(now, drawn)| 90.0 * (now - drawn) + 1e3 * (now - drawn).powi(2)).sum();
            belt + 1500.0 * q[0] * q[0] + 2500.0 * q[2] * q[2] + 20.0 * q[1] * q[1] + 30.0 * q[3] * q[3] + 9.81 * q[2]
        };
        let names: Vec<String> = answer.system.coordinates.iter().map(|c| answer.system.display(c.name)).collect();
        assert_eq!(names, ["motor.x", "motor.angle", "pump.y", "pump.angle"]);
        let rest: [f64; 4] = std::array::from_fn(|i| answer.rest.displacement[i].to_f64());
        assert!(rest[0].abs() > 1e-3 && rest[1].abs() > 1e-5, "{rest:?}");
        // Differences of fourth order: h^4 times derivatives of the size 1e5, and eps V / h^2.
        let h = 1e-3;
        let moved = |steps: [f64; 4]| energy(std::array::from_fn(|i| rest[i] + h * steps[i]));
        let unit = |i: usize, by: f64| -> [f64; 4] { std::array::from_fn(|j| if i == j { by } else { 0.0 }) };
        for i in 0..4 {
            let slope = (8.0 * (moved(unit(i, 1.0)) - moved(unit(i, -1.0))) - moved(unit(i, 2.0))
                + moved(unit(i, -2.0)))
                / (12.0 * h);
            assert!(slope.abs() < 1e-6, "{i}: {slope:e}");
        }
        let along = |direction: [f64; 4]| {
            let at = |by: f64| moved(direction.map(|part| by * part));
            (16.0 * (at(1.0) + at(-1.0)) - at(2.0) - at(-2.0) - 30.0 * at(0.0)) / (12.0 * h * h)
        };
        let k = nalgebra::DMatrix::from_fn(4, 4, |i, j| {
            let both: [f64; 4] = std::array::from_fn(|l| f64::from(l == i) + f64::from(l == j));
            if i == j { along(unit(i, 1.0)) } else { 0.5 * (along(both) - along(unit(i, 1.0)) - along(unit(j, 1.0))) }
        });
        let inertias = [1.0, 0.005, 1.0, 0.02_f64];
        let k = nalgebra::DMatrix::from_fn(4, 4, |i, j| k[(i, j)] / (inertias[i] * inertias[j]).sqrt());
        let mut squares: Vec<f64> = k.symmetric_eigenvalues().iter().copied().collect();
        squares.sort_by(f64::total_cmp);
        for (mode, square) in answer.modes.list.iter().zip(squares) {
            assert!(mode.omega.rad < 1e-12 * mode.omega.to_f64());
            near(mode.omega.to_f64().powi(2), square, 3e-7);
        }
    }
}

#[test]
fn what_is_no_belt_is_one_finding() {
    let scene = |belt: &str| {
        format!(
            "body a {{ mass = 1 kg, shape = disk(0.1 m), at = (0, 0), turns }}\nbody b {{ mass = 1 kg, shape = disk(0.2 m), at = (1 m, 0), turns }}\n\
             body near {{ mass = 1 kg, shape = disk(0.2 m), at = (0.25 m, 0), turns }}\nbody within {{ mass = 1 kg, shape = disk(0.2 m), at = (0.05 m, 0), turns }}\n\
             body crate {{ mass = 1 kg, shape = box(1 m, 1 m), at = (3 m, 0), turns }}\nbody bare {{ mass = 1 kg, shape = disk(0.1 m), turns }}\n\
             body still {{ mass = 1 kg, shape = disk(0.1 m), at = (5 m, 0), moves x }}\nbody idle {{ mass = 1 kg, shape = disk(0.1 m), at = (6 m, 0), moves x }}\n\
             base wall {{ at = (4 m, 0), turns }}\n\
             spring s1: ground -- a {{ k = 1 N*m/rad }}\nspring s2: ground -- b {{ k = 1 N*m/rad }}\nspring s3: ground -- near {{ k = 1 N*m/rad }}\n\
             spring s4: ground -- crate {{ k = 1 N*m/rad }}\nspring s5: ground -- bare {{ k = 1 N*m/rad }}\nspring s6: wall -- within {{ k = 1 N*m/rad }}\n\
             spring s7: ground -- still {{ k = 1 N/m }}\nspring s8: ground -- idle {{ k = 1 N/m }}\n{belt}\n"
        )
    };
    // Inertias that nothing turns are warned of in every scene with them.
    let scene = |belt: &str| {
        let text = scene(belt);
        let drop = |line: &&str| !["still", "idle"].iter().any(|name| line.contains(name) && !belt.contains(name));
        text.lines().filter(drop).collect::<Vec<_>>().join("\n")
    };
    for (belt, wanted) in [
        ("belt r: a -- crate { k = 1 kN/m }", "vib::belt::no_disk"),
        ("belt r: a -- ground { k = 1 kN/m }", "vib::belt::no_disk"),
        ("belt r: wall -- a { k = 1 kN/m }", "vib::belt::no_disk"),
        ("belt r: a -- bare { k = 1 kN/m }", "vib::belt::no_disk"),
        ("belt r: a@(0, 0) -- b { k = 1 kN/m }", "vib::belt::no_disk"),
        ("belt r: a -- near { k = 1 kN/m, crossed }", "vib::belt::overlap"),
        ("belt r: a -- within { k = 1 kN/m }", "vib::belt::overlap"),
        ("belt r: a -- a { k = 1 kN/m }", "vib::element::equal_ends"),
        ("belt r: a -- b { }", "vib::field::missing"),
        ("belt r: a -- b { k = 1 N*m/rad }", "vib::unit::mismatch"),
        ("belt r: a -- b { k = 1 kN/m, free_length = 1 m }", "vib::field::unknown"),
        ("belt r: a -- b { k = 1 kN/m, crossed = 1 }", "vib::field::value"),
        ("belt r: a -- c { k = 1 kN/m }", "vib::part::unknown"),
    ] {
        assert_eq!(code(&scene(belt), &["check"]), wanted, "{belt}");
    }
}

/// Both spans of a belt hold a mode: one part of the model, one share, in words and in JSON.
#[test]
fn the_spans_of_a_belt_have_one_share() {
    let model = "body motor { mass = 2 kg, shape = disk(0.1 m), at = (0, 0), turns }\n\
                 body pump { mass = 5 kg, shape = disk(0.25 m), at = (0.7 m, 0.2 m), turns }\n\
                 belt r: motor -- pump { k = 200 kN/m }\n";
    let report = json(model, &["analyze"]);
    let strain = report["modes"][1]["strain"].as_array().expect("shares");
    assert_eq!(strain.len(), 1, "{strain:?}");
    assert_eq!(strain[0]["of"], "r");
    near(strain[0]["share"].as_f64().unwrap(), 1.0, 1e-12);
    let text = text(model, &["analyze"]);
    assert!(text.contains("r\u{a0}100\u{a0}%") || text.contains("r 100 %"), "{text}");
}

/// A torque of 30 N m on the pump is the difference of both tensions times 0.2 m: 75 N more in one span and less in the other,
/// whatever holds the motor.
#[test]
fn a_span_that_pushes_at_rest_is_told() {
    let told = |preload: &str| {
        let model = format!(
            "body motor {{ mass = 1 kg, shape = disk(0.1 m), at = (0, 0), turns }}\n\
             spring s: ground -- motor {{ k = 900 N*m/rad }}\n\
             body pump {{ mass = 1 kg, shape = disk(0.2 m), at = (0.7 m, 0), turns }}\n\
             torque T: pump = constant(30 N*m)\nbelt r: motor -- pump {{ k = 1 MN/m{preload} }}\n"
        );
        let output = crate::program::ran(&model, &["check"]);
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    for (preload, force) in [(", preload = 70 N", "5 N"), ("", "75 N"), (", preload = -300 N, crossed", "375 N")] {
        let text = told(preload);
        assert_eq!(text.matches("vib::belt::slack").count(), 1, "{preload}: {text}");
        assert!(text.contains(&format!("pushes with {force}")), "{text}");
    }
    assert!(!told(", preload = 75.001 N").contains("vib::belt::slack"));
}
