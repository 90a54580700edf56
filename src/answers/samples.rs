//! Hand-made answers for the tests of this folder and of the back ends.

use super::ModalAnswer;
use crate::analysis::{
    Mode, ModeKind, Modes, Pole, PoleCount, PoleKind, Poles, Reason, Route, Share, Stability, Verdict,
};
use crate::base::{Ball, Dd, FileId, Name, Number, Rational, Span, Unproven, Words};
use crate::lower::Rest;
use crate::system::{Coordinate, CoordinateId, CoordinateKind, Form, Label, LinearSystem, Nature, Source};

/// The cart with a rod: the mass matrix, springs and damper of the problem set, with answers to twelve digits.
pub fn cart() -> ModalAnswer {
    let mut words = Words::new();
    let coordinates = vec![
        coordinate(&mut words, "block", "x", CoordinateKind::Translation),
        coordinate(&mut words, "rod", "angle", CoordinateKind::Rotation),
    ];
    let spring = label(&mut words, "s", "");
    let gravity = label(&mut words, "gravity", "");
    let [block, rod] = ["block", "rod"].map(|name| label(&mut words, name, ""));
    let m = form(&[(block, (1, 1), &[(0, 1)]), (rod, (1, 2), &[(0, 1), (1, 1)])]).with((rod, (1, 6), &[(1, 1)]));
    let c = form(&[(label(&mut words, "d", ""), (5, 1), &[(0, 1)])]);
    let k = form(&[(spring, (10, 1), &[(0, 1)]), (gravity, (981, 200), &[(1, 1)])]);
    let modes = vec![
        oscillation(
            2.15817927443011,
            &[0.6318, 0.8175],
            &[(rod, 0.74), (block, 0.26)],
            &[(spring, 0.55), (gravity, 0.45)],
        ),
        oscillation(
            3.74715239993107,
            &[0.757, -1.1927],
            &[(block, 0.57), (rod, 0.43)],
            &[(gravity, 0.5), (spring, 0.5)],
        ),
    ];
    let poles = vec![
        pole(-0.309953841, 2.636171869),
        pole(-0.309953841, -2.636171869),
        pole(-1.912268381, 2.371873795),
        pole(-1.912268381, -2.371873795),
    ];
    let system = free(words, coordinates, [m, c, k]);
    answer("cart", system, modes, poles, Stability::Stable)
}

/// Two free carts connected by a spring: a rigid-body mode and an oscillation.
pub fn free_pair() -> ModalAnswer {
    let mut words = Words::new();
    let coordinates = vec![
        coordinate(&mut words, "α", "x", CoordinateKind::Translation),
        coordinate(&mut words, "β", "x", CoordinateKind::Translation),
    ];
    let spring = label(&mut words, "s", "");
    let [alpha, beta] = ["α", "β"].map(|name| label(&mut words, name, ""));
    let m = form(&[(alpha, (2, 1), &[(0, 1)]), (beta, (2, 1), &[(1, 1)])]);
    let system = free(words, coordinates, [m, Form::new(), form(&[(spring, (4, 1), &[(0, 1), (1, -1)])])]);
    let half = [(alpha, 0.5), (beta, 0.5)];
    let mut rigid = oscillation(0.0, &[0.5, 0.5], &half, &[]);
    (rigid.kind, rigid.route, rigid.input_condition) = (ModeKind::Rigid, Route::Exact, None);
    (rigid.omega, rigid.omega_squared) = (Ball::ZERO, Ball::ZERO);
    let shaking = oscillation(2.0, &[0.5, -0.5], &half, &[(spring, 1.0)]);
    let poles = vec![zero_pole(), zero_pole(), pole(0.0, 2.0), pole(0.0, -2.0)];
    answer("free pair", system, vec![rigid, shaking], poles, Stability::Neutral)
}

/// A system without inputs, outputs and initial motion.
fn free(words: Words, coordinates: Vec<Coordinate>, [m, c, k]: [Form; 3]) -> LinearSystem {
    let (chain, inputs, outputs, initial) = Default::default();
    LinearSystem { words, coordinates, m, c, k, chain, inputs, outputs, initial, losses: None }
}

/// The answer for a system that is at rest as drawn; it has all poles, and energy decides its stability.
fn answer(model: &str, system: LinearSystem, modes: Vec<Mode>, poles: Vec<Pole>, stability: Stability) -> ModalAnswer {
    ModalAnswer {
        excitations: Vec::new(),
        damped_shapes: Vec::new(),
        nodes: Vec::new(),
        model: model.into(),
        rest: as_drawn(system.n()),
        system,
        modes: Modes { list: modes, infinite: 0, ..Modes::default() },
        poles: all(poles),
        stability: Verdict::sample(stability, Reason::Energy),
        buckling: None,
        solved: Vec::new(),
        optimised: Vec::new(),
        requirements: Vec::new(),
        noisy: Vec::new(),
        spectral: crate::analysis::response_spectrum::Spectral::default(),
        sensitivities: Vec::new(),
        tolerated: None,
        account: None,
    }
}

/// An upright rod on a soft hinge spring, at rest leaning by 0.01 rad: it falls.
pub fn upright_rod() -> ModalAnswer {
    let mut answer = cart();
    let gravity = answer.system.k.source_of(1).name;
    let rod = answer.system.m.source_of(1).name;
    let mut falling = oscillation(2.95211788391, &[1.7320508], &[(rod, 1.0)], &[(gravity, 1.0)]);
    falling.kind = ModeKind::Divergence;
    falling.omega_squared = -falling.omega_squared;
    answer.model = "upright".into();
    answer.system.coordinates.remove(0);
    answer.system.m = Form::new();
    answer.system.c = Form::new();
    answer.system.k = Form::new();
    answer.rest = Rest {
        displacement: vec![Number::Ball(Ball::new(Dd::from(0.01), 1e-18))],
        residual: 3e-17,
        steps: 4,
        ..Rest::without_loads()
    };
    answer.modes = Modes { list: vec![falling], infinite: 0, ..Modes::default() };
    let grow = |re: f64, kind| Pole { kind, damping_ratio: Some(Ball::from(-re.signum())), ..pole(re, 0.0) };
    answer.poles = all(vec![grow(-2.95211788391, PoleKind::Overdamped), grow(2.95211788391, PoleKind::Divergence)]);
    answer.stability = Verdict::sample(Stability::Unstable, Reason::Growth);
    answer
}

/// A complete, counted list of poles.
fn all(list: Vec<Pole>) -> Poles {
    Poles { count: Some(PoleCount::sample(list.len(), 0)), list, ..Poles::default() }
}

fn label(words: &mut Words, name: &str, motion: &'static str) -> Label {
    Label { name: Name::plain(words.intern(name)), motion }
}

fn coordinate(words: &mut Words, body: &str, motion: &'static str, kind: CoordinateKind) -> Coordinate {
    Coordinate { name: label(words, body, motion), kind, span: Span::new(FileId(0), 0, 1) }
}

type Square<'a> = (Label, (i64, i64), &'a [(u32, i64)]);

fn form(squares: &[Square]) -> Form {
    squares.iter().fold(Form::new(), |form, square| form.with(*square))
}

trait With {
    fn with(self, square: Square) -> Self;
}

impl With for Form {
    fn with(mut self, (name, (numerator, denominator), row): Square) -> Form {
        let source = self.source(name);
        let weight = Number::Exact(Rational::new(numerator, denominator));
        self.push(
            source,
            Nature::Property,
            weight,
            row.iter().map(|(i, value)| (CoordinateId(*i), Number::from(*value))),
        );
        self
    }
}

fn as_drawn(n: usize) -> Rest {
    Rest { displacement: vec![Number::ZERO; n], ..Rest::without_loads() }
}

fn oscillation(omega: f64, shape: &[f64], kinetic: &[(Label, f64)], strain: &[(Label, f64)]) -> Mode {
    let omega = Ball::new(Dd::from(omega), omega * 1e-30);
    Mode {
        kind: ModeKind::Oscillation,
        omega_squared: omega.square(),
        omega,
        cluster: None,
        shape: shape.to_vec(),
        precise: None,
        input_condition: Some(Unproven(2.0)),
        leading: Some(CoordinateId(0)),
        kinetic: kinetic.iter().map(|(of, part)| Share { of: Source::from(*of), part: Unproven(*part) }).collect(),
        strain: strain.iter().map(|(of, part)| Share { of: Source::from(*of), part: Unproven(*part) }).collect(),
        route: Route::FactoredDoubleDouble,
    }
}

fn pole(re: f64, im: f64) -> Pole {
    let (re, im) = (Ball::from(re), Ball::from(im));
    let modulus = (re.square() + im.square()).sqrt();
    Pole {
        re,
        im,
        relative_error: 2e-17,
        damping_ratio: Some(-re / modulus),
        kind: PoleKind::Oscillation,
        cluster: None,
        defective: false,
        route: Route::Refined,
    }
}

fn zero_pole() -> Pole {
    Pole { relative_error: 0.0, damping_ratio: None, kind: PoleKind::Rigid, route: Route::Exact, ..pole(0.0, 0.0) }
}
