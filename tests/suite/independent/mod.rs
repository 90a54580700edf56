//! Physics by two independent ways: derivatives that lowering forms by hand are compared with a second formulation in
//! absolute coordinates, on models written by hand and on random ones, starting from the text. The frequencies and
//! poles too are compared with the eigenvalues and roots of the second formulation's own matrices.

mod extended;
mod formulation;
pub mod random_scenes;
mod reactions;
mod spectrum;

use crate::ask::{Answer, ask};
use extended::Matrix;
use formulation::{Chosen, Formulation, Linearised};
use vibc::base::number::Dd;
use vibc::base::{Ball, Number};
use vibc::system::{CoordinateId, Form};

/// Tolerance relative to the largest entry of a matrix. The differences are accurate to 1e-22 of the energies (see
/// `formulation`); the elimination of the constraints of a chain of joints magnifies that by the lever arms, by at most
/// a factor of 10 for each joint.
const TOLERANCE: f64 = 1e-17;

/// The coordinates that lowering chose, by body and motion.
fn chosen(answer: &Answer) -> Vec<Chosen> {
    let bodies = &answer.scene.scene().bodies;
    let of = |coordinate: &vibc::system::Coordinate| Chosen {
        body: bodies.iter().position(|body| body.name == coordinate.name.name).expect("a body of the scene"),
        motion: coordinate.name.motion.to_string(),
    };
    answer.lowered.system.coordinates.iter().map(of).collect()
}

fn second_formulation(answer: &Answer, start: &[Dd]) -> Linearised {
    let method = Formulation::new(answer.scene.scene());
    method.linearised(&chosen(answer), start).expect("Newton's iteration finds a rest from one")
}

fn displacement(answer: &Answer) -> Vec<Dd> {
    answer.lowered.rest.displacement.iter().map(|d| d.to_ball().mid).collect()
}

fn from_form(form: &Form, n: usize) -> Matrix {
    let balls = form.assemble(n);
    let mut matrix = Matrix::zero(n, n);
    for (i, row) in balls.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            assert!(entry.rad <= 1e-20 * (1.0 + entry.magnitude()), "a sharp entry: {entry:?}");
            *matrix.at_mut(i, j) = entry.mid;
        }
    }
    matrix
}

/// Sparse columns side by side.
fn from_columns<'a>(n: usize, columns: impl ExactSizeIterator<Item = &'a Vec<(CoordinateId, Number)>>) -> Matrix {
    let mut matrix = Matrix::zero(n, columns.len());
    for (j, column) in columns.enumerate() {
        for (i, value) in column {
            *matrix.at_mut(i.index(), j) = value.to_ball().mid;
        }
    }
    matrix
}

fn assert_equal(found: &Matrix, truth: &Matrix, tolerance: f64, what: &str) {
    let largest = truth.largest().max(1e-3);
    assert_eq!((found.rows, found.columns), (truth.rows, truth.columns), "{what}");
    for i in 0..truth.rows {
        for j in 0..truth.columns {
            let off = (found.at(i, j) - truth.at(i, j)).abs().to_f64();
            let (a, b) = (found.at(i, j).to_f64(), truth.at(i, j).to_f64());
            assert!(off <= tolerance * largest, "{what}[{i}][{j}]: {a:e}, by the second road {b:e}, apart {off:e}");
        }
    }
}

/// Compares M, C, K, B, P, D and the rest of both formulations.
fn assert_formulations_agree(answer: &Answer, text: &str) {
    assert_formulations_agree_within(answer, TOLERANCE, text);
}

pub fn assert_formulations_agree_within(answer: &Answer, tolerance: f64, text: &str) {
    let system = &answer.lowered.system;
    let n = system.n();
    let second = second_formulation(answer, &displacement(answer));
    // A rest found by lowering is one: Newton's iteration started there stays.
    assert!(second.distance < tolerance, "moves on by {:e} in\n{text}", second.distance);
    let names = system.coordinate_names();
    for (form, truth, what) in [(&system.m, &second.m, "M"), (&system.c, &second.c, "C"), (&system.k, &second.k, "K")] {
        assert_equal(&from_form(form, n), truth, tolerance, &format!("{what} of {names:?} in\n{text}"));
    }
    for order in 0..3 {
        let b = from_columns(n, system.inputs.iter().map(|input| &input.b[order]));
        assert_equal(&b, &second.b[order], tolerance, &format!("b{order} in\n{text}"));
        let p = from_columns(n, system.outputs.iter().map(|output| &output.p[order])).transposed();
        assert_equal(&p, &second.p[order], tolerance, &format!("p{order} in\n{text}"));
        let mut d = Matrix::zero(system.outputs.len(), system.inputs.len());
        for (row, output) in system.outputs.iter().enumerate() {
            for (input, value) in &output.d[order] {
                *d.at_mut(row, *input as usize) = value.to_ball().mid;
            }
        }
        assert_equal(&d, &second.d[order], tolerance, &format!("d{order} in\n{text}"));
    }
    spectrum::assert_modes(answer, &second, tolerance, text);
    spectrum::assert_poles(answer, &second, text);
}

/// Newton's iteration from the drawing reaches the same rest, for scenes with small loads.
fn assert_rest_from_the_drawing(answer: &Answer, text: &str) {
    let start = vec![Dd::ZERO; answer.lowered.system.n()];
    let second = second_formulation(answer, &start);
    for (found, truth) in answer.lowered.rest.displacement.iter().zip(&second.rest) {
        let found = found.to_ball();
        let off = (found.mid - *truth).abs().to_f64();
        assert!(off <= found.rad + 1e-17, "rest {found:?}, by the second road {truth:?} in\n{text}");
    }
}

/// Random trees with springs, dampers, inerters, loads and outputs of every kind, without forces as drawn.
#[test]
fn random_trees_at_rest_as_drawn() {
    for seed in 1..=40 {
        let text = random_scenes::tree(seed, 5, false);
        let answer = ask(&text);
        assert_formulations_agree(&answer, &text);
        assert_rest_from_the_drawing(&answer, &text);
    }
}

#[test]
fn random_networks() {
    for seed in 1..=40 {
        let text = random_scenes::network(seed, 8);
        assert_formulations_agree(&ask(&text), &text);
    }
}

/// Whether a ball contains a number that is known independently, up to the error of that.
fn encloses(ball: &Ball, truth: Dd, truth_error: f64) -> bool {
    (ball.mid - truth).abs().to_f64() <= ball.rad + truth_error
}

/// Random trees under weights, preloads and constant forces.
#[test]
fn random_trees_under_loads() {
    for seed in 1..=40 {
        let text = random_scenes::tree(seed, 5, true);
        let answer = ask(&text);
        assert_formulations_agree(&answer, &text);
        assert_rest_from_the_drawing(&answer, &text);
    }
}

/// A pendulum of three different links drawn far from its rest.
#[test]
fn links_drawn_aside() {
    for (x, y) in [("2 m", "0"), ("1 m", "-1 m"), ("1.5 m", "1 m")] {
        let text = format!(
            "gravity 9.81 m/s^2
body a {{ mass = 1 kg, shape = rod((0, 0), ({x}, {y})) }}
body b {{ mass = 2 kg, inertia = 0.3 kg*m^2, at = (1.2 m, 2 m) }}
body c {{ mass = 0.5 kg, shape = rod((1 m, 1 m), (3 m, 2 m)) }}
pivot p: ground@(0, 0) -- a\npivot q: a@({x}, {y}) -- b\npivot r: b@(1 m, 1 m) -- c
damper d: ground@(-4 m, 1 m) -- c@(3 m, 2 m) {{ c = 0.7 N*s/m }}
output tip = c@(3 m, 2 m).x"
        );
        let answer = ask(&text);
        assert_formulations_agree(&answer, &text);
        assert!(answer.omegas().iter().all(|omega| *omega > 0.0), "hangs: {:?}", answer.omegas());
    }
}

/// Belts, open and crossed, whose disks turn and move away from the drawing.
#[test]
fn belts_between_moving_disks() {
    for word in ["", ", crossed"] {
        let text = format!(
            "gravity 9.81 m/s^2
body motor {{ mass = 3 kg, shape = disk(0.1 m), at = (0, 0), free }}
body pump {{ mass = 2 kg, shape = disk(0.2 m), at = (0.6 m, 0.3 m), moves y, turns }}
body fan {{ mass = 1 kg, shape = disk(0.15 m), at = (-0.7 m, 0.2 m), turns }}
spring s: ground@(-1 m, 1 m) -- motor {{ k = 3 kN/m }}\nspring t: ground@(0.5 m, 1 m) -- motor {{ k = 2 kN/m }}
spring u: ground -- pump {{ k = 5 kN/m, along = y }}\nspring v: ground -- fan {{ k = 40 N*m/rad }}
belt r: motor -- pump {{ k = 2 kN/m, preload = 90 N{word} }}\nbelt q: fan -- motor {{ k = 3 kN/m, preload = 70 N }}
damper d: ground -- pump {{ c = 2 N*m*s/rad }}\noutput slip = motor.angle - pump.angle\noutput pull = r.force"
        );
        let answer = ask(&text);
        assert_formulations_agree(&answer, &text);
        assert!(displacement(&answer).iter().any(|x| x.hi.abs() > 1e-3), "it settles");
    }
}

/// Supports that shake bodies through springs and dampers of every geometry.
#[test]
fn supports() {
    let text = "gravity 9.81 m/s^2
base floor { moves x y, at = (0, -1 m) }
base shaft { turns, at = (3 m, 0) }
body table { mass = 3 kg, inertia = 0.4 kg*m^2, at = (0.2 m, 0.5 m), free }
body disc { inertia = 0.2 kg*m^2, mass = 1 kg, at = (3 m, 0), turns }
spring a: floor@(-1 m, -1 m) -- table@(-0.5 m, 0.5 m) { k = 300 N/m, preload = -4 N }
spring b: floor@(1.5 m, -1 m) -- table@(0.7 m, 0.5 m) { k = 500 N/m }
spring c: floor -- table { k = 80 N/m, along = x }
damper d: floor@(1 m, -1 m) -- table@(0.2 m, 0.7 m) { c = 7 N*s/m }
spring t: shaft -- disc { k = 5 N*m/rad }
spring u: shaft@(3 m, 1 m) -- table@(0.5 m, 0.6 m) { k = 20 N/m }
output shake = table@(0.5 m, 0.6 m).vy - floor.vy
output lean = table.angle - shaft.angle
output grip = u.force + d.force";
    assert_formulations_agree(&ask(text), text);
}
