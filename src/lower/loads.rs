//! Builds the stretch and load of each element, to be evaluated at any configuration.
//! See docs/method/linearisation.md.

use super::kinematics::{End, Index, Kinematics, Path, PathEvaluation, State};
use crate::base::{Number, Vec3};
use crate::elements::stretch::over_length;
use crate::elements::{Pull, Response, Scalar, Spring, Stretch, Stretched, Vector};
use crate::model::scene::{
    Attachment, BaseId, Element, Geometry, Input, InputKind, Law, Part, Scene, Signal, SpringRest,
};

/// The path between two ends, and the angles of both.
#[derive(Clone, Debug)]
pub struct EndPath<S> {
    pub path: Path<S>,
    /// Angles of the first and of the second end; `None` for an end that does not turn.
    pub angles: [Option<Index>; 2],
    /// For a belt: the length of its span that a turn of each disk winds up, m/rad.
    pub winds: Option<[S; 2]>,
}

impl<S> Default for EndPath<S> {
    fn default() -> EndPath<S> {
        EndPath { path: Path::default(), angles: [None; 2], winds: None }
    }
}

impl<S: Scalar> EndPath<S> {
    /// The relative rotation, second end minus first; of a belt the length that the disks wind up.
    pub fn turn(&self, state: &State<S>) -> S {
        let angle = |end: usize| self.angles[end].map_or_else(S::zero, |angle| state.value(angle).clone());
        match &self.winds {
            Some([first, second]) => first.times(&angle(0)).plus(&second.times(&angle(1))),
            None => angle(1).minus(&angle(0)),
        }
    }

    /// The gradient of the relative rotation.
    pub fn turn_row(&self, row: &mut Vec<(Index, S)>) {
        row.clear();
        row.extend(self.angles[0].map(|angle| (angle, S::one().negate())));
        row.extend(self.angles[1].map(|angle| (angle, S::one())));
    }

    /// Adds the gradient of the length that a belt's disks wind up, times a factor.
    fn wind_row(&self, factor: &S, row: &mut Vec<(Index, S)>) {
        let Some(winds) = &self.winds else { return };
        for (angle, wind) in self.angles.iter().zip(winds) {
            let Some(angle) = angle else { continue };
            let value = wind.times(factor);
            // A disk may carry its centre along.
            match row.iter_mut().find(|(known, _)| known == angle) {
                Some((_, sum)) => *sum = sum.plus(&value),
                None => row.push((*angle, value)),
            }
        }
    }
}

impl EndPath<Number> {
    pub fn convert<S: Scalar>(&self) -> EndPath<S> {
        let winds = self.winds.as_ref().map(|winds| winds.each_ref().map(S::of));
        EndPath { path: self.path.convert(), angles: self.angles, winds }
    }

    /// Sets the path to that between two ends; returns the stretch between them.
    ///
    /// A line whose ends can only move along it is equivalent to a fixed direction: its squares do not depend on the
    /// state.
    pub fn set_ends(
        &mut self,
        kinematics: &Kinematics,
        ends: &[Attachment; 2],
        geometry: &Geometry,
    ) -> Stretch<Number> {
        let [a, b] = [0, 1].map(|end| kinematics.end(&ends[end]));
        self.angles = [a, b].map(|end| kinematics.angle(end.piece));
        if self.angles[0] == self.angles[1] {
            self.angles = [None; 2];
        }
        self.winds = None;
        match geometry {
            Geometry::Torsion => Stretch::Torsion,
            Geometry::Along(direction) => {
                kinematics.path_between(a, b, &mut self.path);
                Stretch::Along { direction: first_to_second(direction, ends) }
            }
            Geometry::Line => {
                kinematics.path_between(a, b, &mut self.path);
                let drawn = drawn_line(ends).expect("the check lets a line run between two places only");
                if self.path.keeps_to(&drawn) { Stretch::Along { direction: drawn } } else { Stretch::Line { drawn } }
            }
            Geometry::Span(span) => {
                kinematics.path_between(a, b, &mut self.path);
                self.winds = Some(span.turns.clone());
                let drawn = drawn_line(ends).expect("the check lets a belt run between two centres only");
                Stretch::Span { drawn, gap: span.gap.clone(), left: span.left }
            }
        }
    }
}

/// The vector from the first to the second end as drawn.
fn drawn_line(ends: &[Attachment; 2]) -> Option<Vector<Number>> {
    let (first, second) = (ends[0].at.as_deref()?, ends[1].at.as_deref()?);
    Some(Vector::of(&second.sub(first)))
}

/// The direction, reversed if the drawing runs against it: tension is positive if the ends are pulled apart.
fn first_to_second(direction: &Vec3, ends: &[Attachment; 2]) -> Vector<Number> {
    let direction = Vector::of(direction);
    match drawn_line(ends) {
        Some(drawn) if drawn.dot(&direction).is_negative() => direction.negate(),
        _ => direction,
    }
}

/// Length between the ends as drawn, along the element's direction; the relative angle of a torsion is zero as drawn.
fn drawn_length(stretch: &Stretch<Number>, ends: &[Attachment; 2], geometry: &Geometry) -> Number {
    match (stretch, geometry) {
        (Stretch::Torsion | Stretch::Span { .. }, _) => Number::ZERO,
        (Stretch::Along { direction } | Stretch::Line { drawn: direction }, Geometry::Line) => {
            direction.norm_squared().root()
        }
        (Stretch::Along { direction } | Stretch::Line { drawn: direction }, _) => {
            let along = drawn_line(ends).map_or(Number::ZERO, |drawn| drawn.dot(direction));
            over_length(along, &direction.norm_squared())
        }
    }
}

/// A spring of the scene, ready to be evaluated.
pub fn spring(
    kinematics: &Kinematics,
    ends: &[Attachment; 2],
    law: &Law,
    between: &mut EndPath<Number>,
) -> Spring<Number> {
    spring_of(between.set_ends(kinematics, ends, &law.geometry), ends, law)
}

/// The spring with a given stretch between two ends.
pub fn spring_of(stretch: Stretch<Number>, ends: &[Attachment; 2], law: &Law) -> Spring<Number> {
    let stretched = match &law.rest {
        SpringRest::FreeLength(free) => &drawn_length(&stretch, ends, &law.geometry) - free,
        SpringRest::AsDrawn | SpringRest::Preload(_) => Number::ZERO,
    };
    let response = match (&law.curve, &law.rest) {
        (Some(curve), _) => Response::Curve { curve: curve.clone(), offset: stretched },
        (None, SpringRest::Preload(tension)) => {
            Response::Linear { stiffness: law.coefficient.clone(), preload: tension.clone() }
        }
        (None, _) => Response::Linear { stiffness: law.coefficient.clone(), preload: &law.coefficient * &stretched },
    };
    Spring { stretch, response }
}

/// grad e for a stretch whose path is in `reach`, as a row to be divided by the square root of the returned number.
pub fn slope<S: Scalar>(
    stretched: &Stretched<S>,
    reach: &PathEvaluation<S>,
    between: &EndPath<S>,
    row: &mut Vec<(Index, S)>,
) -> S {
    match stretched {
        Stretched::Displacement { direction, length_squared, .. } => {
            reach.row(direction, row);
            if between.winds.is_some() {
                between.wind_row(&length_squared.root(), row);
            }
            length_squared.clone()
        }
        Stretched::Turn { .. } => {
            between.turn_row(row);
            S::one()
        }
    }
}

/// The path of a point relative to the ground.
pub fn path_from_ground(kinematics: &Kinematics, end: End, path: &mut Path<Number>) {
    kinematics.path_between(End::GROUND, end, path);
}

/// A source of potential energy.
#[derive(Clone, Copy, Debug)]
pub enum Load<'a> {
    /// A spring, or a constant push between two points.
    Spring(&'a Spring<Number>, &'a EndPath<Number>),
    /// A weight or a constant force.
    Dead(&'a Vector<Number>, &'a Path<Number>),
    /// A constant torque on an angle.
    Torque(Index, &'a Number),
}

/// Visits all sources of potential energy: the weights, then the others in order of declaration. With `loaded_only`,
/// springs that are unstretched as drawn are left out.
pub fn visit(scene: &Scene, kinematics: &Kinematics, loaded_only: bool, mut see: impl FnMut(Load)) {
    if !scene.gravity.is_zero() {
        let path = kinematics.mass_weighted_path(scene, &scene.gravity);
        see(Load::Dead(&Vector::of(&scene.gravity), &path));
    }
    let mut between = EndPath::default();
    for element in &scene.elements {
        if element.law.kind.is_elastic() && (!loaded_only || element.law.may_be_loaded()) {
            let spring = spring(kinematics, &element.ends, &element.law, &mut between);
            see(Load::Spring(&spring, &between));
        }
    }
    for input in &scene.inputs {
        if let Some(size) = constant(input) {
            visit_constant(kinematics, input, &size, &mut between, &mut see);
        }
    }
}

fn visit_constant(
    kinematics: &Kinematics,
    input: &Input,
    size: &Number,
    between: &mut EndPath<Number>,
    see: &mut impl FnMut(Load),
) {
    match &input.kind {
        InputKind::Force { ends, direction } => {
            for (end, force) in ends.iter().zip(opposite_forces(size, direction)) {
                path_from_ground(kinematics, kinematics.end(end), &mut between.path);
                see(Load::Dead(&force, &between.path));
            }
        }
        InputKind::ForceBetween { ends } => {
            let spring = pushing_spring(kinematics, ends, size, between);
            see(Load::Spring(&spring, between));
        }
        InputKind::Torque { ends } => {
            for (end, torque) in ends.iter().zip([size.clone(), -size]) {
                if let Some(angle) = kinematics.angle(kinematics.tree.piece(end.part)) {
                    see(Load::Torque(angle, &torque));
                }
            }
        }
        // A constant displacement of a base is part of the state; an unbalance has no constant part.
        InputKind::Base { .. } | InputKind::Unbalance { .. } => {}
    }
}

/// A force of this size along a direction: on the first end, and its opposite on the second.
pub fn opposite_forces(size: &Number, direction: &Vec3) -> [Vector<Number>; 2] {
    let direction = Vector::of(direction);
    let force = direction.scale(&over_length(size.clone(), &direction.norm_squared()));
    [force.clone(), force.negate()]
}

/// The state as drawn, with the bases displaced by their constant signals.
pub fn state_as_drawn(scene: &Scene, kinematics: &Kinematics) -> State<Number> {
    let mut state = State::as_drawn();
    for (place, input) in kinematics.prescribed_inputs.iter().enumerate() {
        if let Some(value) = constant(&scene.inputs[*input as usize]) {
            let coordinate = (kinematics.n() + place) as Index;
            let length_squared = kinematics.length_squared(coordinate).cloned().unwrap_or(Number::ONE);
            state.set(kinematics, coordinate, over_length(value, &length_squared));
        }
    }
    state
}

/// The constant part of an input's signal; `None` for zero.
pub fn constant(input: &Input) -> Option<Number> {
    let mut sum = Number::ZERO;
    for signal in &input.signal {
        if let Signal::Constant { value } = signal {
            sum = &sum + value;
        }
    }
    (!sum.is_zero()).then_some(sum)
}

/// Whether an input displaces a base for good to which an element is attached: it then pulls or pushes otherwise, which may change the
/// rest and the stiffness.
pub fn displaces_a_base(scene: &Scene, input: &Input) -> bool {
    let holds = |base: BaseId, element: &Element| {
        !element.law.is_zero() && element.ends.iter().any(|end| end.part == Part::Base(base))
    };
    let is_held = |base: BaseId| scene.elements.iter().any(|element| holds(base, element));
    input.kind.base().is_some_and(|base| constant(input).is_some() && is_held(base))
}

/// A constant force that pushes two points apart, represented as a spring without stiffness.
pub fn pushing_spring(
    kinematics: &Kinematics,
    ends: &[Attachment; 2],
    force: &Number,
    between: &mut EndPath<Number>,
) -> Spring<Number> {
    let stretch = between.set_ends(kinematics, ends, &Geometry::Line);
    Pull { stretch, pull: -force }.spring()
}
