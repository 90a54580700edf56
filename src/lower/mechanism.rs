//! A scene's mechanism at its rest: how points move with the coordinates, which of these are independent, and where they
//! rest. Lowering passes it on beside the linear system, so that later questions (the tension of a spring at rest, a
//! further output, why something was left out) need no second lowering. See docs/method/rest.md and
//! docs/method/linearisation.md.

use super::constraints::Reduction;
use super::error::LowerError;
use super::kinematics::{Kinematics, PathEvaluation, State};
use super::loads::{self, EndPath};
use super::reactions::Holding;
use super::rest::Rest;
use super::{Lowered, assembly};
use crate::base::{Dimension, Name, Number, Span};
use crate::elements::stretch::over_length;
use crate::elements::{Response, Vector};
use crate::model::scene::{ElementId, Motion, MotionTerm, Output, Scene};

/// The kinematics of a scene and the state in which it rests.
#[derive(Clone, Debug)]
pub struct Mechanism {
    pub(super) kinematics: Kinematics,
    pub(super) reduction: Reduction,
    pub(super) state: State<Number>,
    pub(super) holding: Holding,
}

/// A spring at rest.
#[derive(Clone, Debug)]
pub struct SpringAtRest {
    pub element: ElementId,
    /// N or N m; pull is positive.
    pub tension: Number,
    /// Change of length from the drawing to the rest, m or rad.
    pub change: Number,
    /// Stretch from the free length, or that of its law; `None` if that is not determined.
    pub stretch: Option<Number>,
    /// The stiffness; for a nonlinear spring, the tangent at rest.
    pub stiffness: Number,
}

impl Mechanism {
    /// `state` has a value for every coordinate, including dependent ones.
    pub(super) fn new(
        kinematics: Kinematics,
        reduction: Reduction,
        state: State<Number>,
        holding: Holding,
    ) -> Mechanism {
        Mechanism { kinematics, reduction, state, holding }
    }

    /// All springs of the scene that this mechanism was lowered from, in order of declaration. `rest` is the one found
    /// with the mechanism; the list is empty if it is not proven.
    pub fn springs_at_rest(&self, scene: &Scene, rest: &Rest) -> Vec<SpringAtRest> {
        if !rest.is_proven() {
            return Vec::new();
        }
        let (mut between, mut reach) = (EndPath::default(), PathEvaluation::default());
        let mut list = Vec::new();
        for (index, element) in (0..).zip(&scene.elements) {
            if !element.law.kind.is_elastic() {
                continue;
            }
            let spring = loads::spring(&self.kinematics, &element.ends, &element.law, &mut between);
            reach.measure(&self.kinematics, &self.state, &between.path);
            let stretched = spring.stretch.at(&reach.displacement, &between.turn(&self.state));
            let (tension, change) = (spring.tension(&stretched), stretched.change().clone());
            let stiffness = spring.stiffness(&stretched);
            let stretch = match &spring.response {
                Response::Curve { offset, .. } => Some(offset + &change),
                Response::Linear { .. } => None,
            };
            list.push(SpringAtRest { element: ElementId(index), tension, change, stretch, stiffness });
        }
        // If the drawing is declared to be the rest, these tensions hold it.
        for found in &rest.tensions {
            let spring = list.binary_search_by_key(&found.element, |spring| spring.element);
            if let Ok(place) = spring {
                list[place].tension = found.tension.clone();
            }
        }
        for spring in list.iter_mut().filter(|spring| spring.stretch.is_none()) {
            let SpringAtRest { tension, stiffness, .. } = spring;
            spring.stretch = if tension.is_zero() { Some(Number::ZERO) } else { tension.checked_div(stiffness) };
        }
        list
    }
}

impl Mechanism {
    /// A combination of motions at rest, measured from the drawing. A spring contributes its whole tension, and a
    /// reaction its whole force or moment. `rest` is the one found with this mechanism. An error at `span` for a
    /// reaction that is not determined.
    pub fn at_rest(&self, scene: &Scene, rest: &Rest, terms: &[MotionTerm], span: Span) -> Result<Number, LowerError> {
        let reactions = self.reactions(scene, terms, span)?;
        let has_force = terms.iter().any(|term| matches!(term.motion, Motion::Force { .. }));
        let springs = if has_force { self.springs_at_rest(scene, rest) } else { Vec::new() };
        let (mut between, mut reach) = (EndPath::default(), PathEvaluation::default());
        let mut value = |motion: &Motion| match motion {
            Motion::Force { element } => {
                // An element that is not a spring has no force if nothing moves.
                let spring = springs.binary_search_by_key(element, |spring| spring.element);
                spring.map_or(Number::ZERO, |place| springs[place].tension.clone())
            }
            Motion::Stretch { element } => {
                let element = &scene.elements[element.index()];
                let stretch = between.set_ends(&self.kinematics, &element.ends, &element.law.geometry);
                reach.measure(&self.kinematics, &self.state, &between.path);
                stretch.at(&reach.displacement, &between.turn(&self.state)).change().clone()
            }
            Motion::Point { part, at, direction, .. } => {
                let end = self.kinematics.point(*part, at.as_deref());
                loads::path_from_ground(&self.kinematics, end, &mut between.path);
                reach.measure(&self.kinematics, &self.state, &between.path);
                let direction = Vector::of(direction);
                over_length(reach.displacement.dot(&direction), &direction.norm_squared())
            }
            Motion::Turn { part, .. } => {
                let angle = self.kinematics.angle(self.kinematics.tree.piece(*part));
                angle.map_or(Number::ZERO, |angle| self.state.value(angle).clone())
            }
            Motion::Reaction(reaction) => reactions.at_rest(reaction).cloned().unwrap_or(Number::ZERO),
        };
        Ok(terms.iter().fold(Number::ZERO, |sum, term| &sum + &(&value(&term.motion) * &term.coefficient)))
    }
}

/// A combination of motions to be evaluated although the scene does not declare it as an output.
#[derive(Clone, Debug)]
pub struct Readout {
    pub terms: Vec<MotionTerm>,
    /// The place that asks for it.
    pub span: Span,
}

impl Lowered {
    /// Adds an output for each readout, after those that the scene declares.
    pub fn add_readouts(&mut self, scene: &Scene, readouts: Vec<Readout>) -> Result<(), LowerError> {
        let Mechanism { kinematics, reduction, state, .. } = &self.mechanism;
        let mut nowhere = readouts.iter().flat_map(|read| kinematics.read_without_place(scene, &read.terms, read.span));
        if let Some(error) = nowhere.next() {
            return Err(error);
        }
        let name = Name::plain(self.system.words.intern("measure"));
        let output = |Readout { terms, span }| Output {
            name,
            span,
            terms,
            dimension: Dimension::NONE,
            is_angle: false,
            unit: None,
        };
        let outputs: Vec<Output> = readouts.into_iter().map(output).collect();
        let first = self.system.outputs.len();
        self.system.outputs.extend(assembly::outputs(scene, kinematics, reduction, state, &outputs));
        if let Some(losses) = &mut self.system.losses {
            for (p, d) in assembly::losses::of_outputs(scene, kinematics, reduction, state, &outputs) {
                losses.p.push(p);
                losses.d.push(d);
            }
        }
        self.carry(scene, &outputs, first)
    }
}
