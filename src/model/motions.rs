//! Motions and their linear combinations: outputs, couplings, initial states. In: an expression such as `rod.angle` or
//! `table.y - floor.y`. Out: coefficients and motions, with dimensions checked. See spec.md.

use super::Check;
use super::error::{NameError, QuestionError, ValueError};
use super::evaluate::{Evaluated, Stop};
use super::freedoms::Line;
use super::reactions::is_of_support;
use super::scene::{BaseId, BodyId, ElementId, Freedom, Geometry, Motion, MotionTerm, Output, Part, Written};
use super::scope::{self, Environment, Instance};
use super::suggestion::nearest;
use super::value::{Fault, Scalar, Value};
use crate::base::unit::Scale;
use crate::base::{Angle, Dimension, Number, Span, Vec3};
use crate::kinds::body_or_element;
use crate::kinds::motions::{self, BODY_MOTIONS, Direction, ELEMENT_MOTIONS, ElementMotion};
use crate::syntax::tree::{Binary, DeclKind, ExprId, ExprKind, Ident, Rare};
use std::sync::Arc;

/// A linear combination of motions.
#[derive(Clone, Debug)]
pub struct Combination {
    pub terms: Vec<MotionTerm>,
    pub dimension: Dimension,
    pub angle: Angle,
}

/// The value of an expression that may contain motions.
pub enum Piece {
    Scalar(Scalar),
    Motions(Combination),
}

/// The direction of a motion; `None` for a rotation.
fn axis(direction: Direction) -> Option<Vec3> {
    match direction {
        Direction::X => Some(Vec3::X),
        Direction::Y => Some(Vec3::Y),
        Direction::Turn => None,
    }
}

impl<'a> Check<'a> {
    pub fn outputs(&mut self) {
        for index in 0..self.instances.outputs.len() {
            let Instance { decl, environment } = self.instances.outputs[index];
            let DeclKind::Rare { index } = decl.kind else { continue };
            let Rare::Output { name, unit, value } = self.tree.rare[index as usize] else { continue };
            self.walk.varies = false;
            if let Ok(output) = self.output(name, unit, value, environment) {
                self.scene.outputs.push(output);
            }
        }
    }

    fn output(
        &mut self,
        ident: Ident,
        unit: Option<Span>,
        value: ExprId,
        environment: Environment,
    ) -> Evaluated<Output> {
        let Combination { terms, dimension, angle } = self.combination(value, environment)?;
        if terms.is_empty() {
            let span = self.tree.expr(value).span;
            return self.fail(environment, QuestionError::NoMotion { span });
        }
        let name = self.name(ident, environment)?;
        let is_angle = angle == Angle::Radians;
        let unit = unit.map(|unit| self.output_unit(unit, (dimension, is_angle), environment)).transpose()?;
        Ok(Output { name, span: ident.span, terms, dimension, is_angle, unit })
    }

    /// The unit after `in`, which must be one of the output's dimension.
    fn output_unit(
        &mut self,
        span: Span,
        (wanted, is_angle): (Dimension, bool),
        environment: Environment,
    ) -> Evaluated<Written> {
        let text: &'a str = self.sources.slice(span);
        let unit = self.unit(text, span, environment)?;
        let factor = match unit.scale {
            Scale::Linear(factor) => factor,
            Scale::Decibel => return self.fail(environment, QuestionError::LevelOfOutput { span }),
        };
        if unit.dimension != wanted {
            let found = (unit.dimension, unit.angle);
            return self.fail(environment, QuestionError::OutputUnit { span, found, wanted, is_angle });
        }
        if is_angle && unit.angle == Angle::Cycles {
            return self.fail(environment, QuestionError::CyclesOfOutput { span });
        }
        Ok(Written { text: text.to_string(), factor: Some(factor) })
    }

    /// A combination of motions.
    pub fn combination(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Combination> {
        match self.piece(expr, environment)? {
            Piece::Motions(combination) => Ok(combination),
            Piece::Scalar(_) => {
                let span = self.tree.expr(expr).span;
                self.fail(environment, QuestionError::NoMotion { span })
            }
        }
    }

    /// A combination of quantities at rest: `s.tension`, `s.stretch`, `rod.angle`, `block.x`.
    pub fn at_rest(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Combination> {
        self.reads_rest = true;
        let found = self.combination(expr, environment);
        self.reads_rest = false;
        let combination = found?;
        let moves = |term: &MotionTerm| match term.motion {
            Motion::Point { derivative, .. } | Motion::Turn { derivative, .. } => derivative > 0,
            Motion::Force { .. } | Motion::Stretch { .. } | Motion::Reaction(_) => false,
        };
        if combination.terms.iter().any(moves) {
            let span = self.tree.expr(expr).span;
            return self.fail(environment, QuestionError::RateAtRest { span });
        }
        Ok(combination)
    }

    /// A number, or a combination of motions.
    pub fn piece(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Piece> {
        let node = *self.tree.expr(expr);
        if !self.has_motion(expr, environment) {
            return match self.evaluate(expr, environment)? {
                Value::Scalar(scalar) => Ok(Piece::Scalar(scalar)),
                Value::Vector(_) => {
                    self.fail(environment, ValueError::Kind { span: node.span, needed: "a motion", found: "a point" })
                }
            };
        }
        match node.kind {
            ExprKind::Member { base, member_len, indices } => {
                let word = self.tree.member(base, member_len, indices).span;
                self.member(base, word, environment)
            }
            ExprKind::Negate { operand } => {
                let piece = self.piece(operand, environment)?;
                Ok(scale(piece, &Number::from(-1)))
            }
            ExprKind::Binary { operator, left, right } => self.combine(operator, left, right, environment),
            ExprKind::At { .. } => self.fail(environment, QuestionError::PointWithoutMotion { span: node.span }),
            _ => self.fail(environment, QuestionError::NonLinear { span: node.span }),
        }
    }

    /// Whether an expression mentions a motion; `front.k` is not a motion.
    pub fn has_motion(&mut self, expr: ExprId, environment: Environment) -> bool {
        let tree = self.tree;
        match tree.expr(expr).kind {
            ExprKind::Member { base, .. } => !self.is_value_of_place(base, environment),
            ExprKind::At { .. } => true,
            ExprKind::Negate { operand } => self.has_motion(operand, environment),
            ExprKind::Binary { left, right, .. } => {
                self.has_motion(left, environment) || self.has_motion(right, environment)
            }
            ExprKind::Call { arguments, .. } => {
                tree.list(arguments).iter().any(|&argument| self.has_motion(argument, environment))
            }
            ExprKind::Tuple { items } => tree.list(items).iter().any(|&item| self.has_motion(item, environment)),
            ExprKind::Named { value, .. } => self.has_motion(value, environment),
            ExprKind::Range { low, high } => self.has_motion(low, environment) || self.has_motion(high, environment),
            ExprKind::Literal { .. } | ExprKind::Name { .. } | ExprKind::Text => false,
        }
    }

    fn combine(&mut self, operator: Binary, left: ExprId, right: ExprId, environment: Environment) -> Evaluated<Piece> {
        let span = self.tree.expr(left).span.to(self.tree.expr(right).span);
        let a = self.piece(left, environment);
        let b = self.piece(right, environment)?;
        let places = (left, right);
        match (operator, a?, b) {
            (Binary::Add, Piece::Motions(a), Piece::Motions(b)) => {
                self.sum(operator, a, b, places, environment).map(Piece::Motions)
            }
            (Binary::Subtract, Piece::Motions(a), Piece::Motions(b)) => {
                self.difference(a, b, places, environment).map(Piece::Motions)
            }
            (Binary::Add | Binary::Subtract, Piece::Motions(a), Piece::Scalar(zero)) if zero.bare_zero => {
                Ok(Piece::Motions(a))
            }
            (Binary::Multiply, Piece::Motions(a), Piece::Scalar(b)) => self.product(a, &b, places, environment),
            (Binary::Multiply, Piece::Scalar(a), Piece::Motions(b)) => self.product(b, &a, places, environment),
            (Binary::Divide, Piece::Motions(a), Piece::Scalar(b)) => {
                let inverse = self.inverse(&b, places, environment)?;
                self.product(a, &inverse, places, environment)
            }
            _ => self.fail(environment, QuestionError::NonLinear { span }),
        }
    }

    /// a - b.
    pub fn difference(
        &mut self,
        a: Combination,
        b: Combination,
        places: (ExprId, ExprId),
        environment: Environment,
    ) -> Evaluated<Combination> {
        self.sum(Binary::Subtract, a, negate(b), places, environment)
    }

    fn sum(
        &mut self,
        operator: Binary,
        mut a: Combination,
        b: Combination,
        (left, right): (ExprId, ExprId),
        environment: Environment,
    ) -> Evaluated<Combination> {
        if a.dimension != b.dimension {
            let fault = Fault::Dimensions(a.dimension, b.dimension);
            let (left, right) = (self.tree.expr(left).span, self.tree.expr(right).span);
            return self.fail(environment, ValueError::Operation { fault, operator, left, right });
        }
        if a.angle != b.angle {
            a.angle = Angle::Plain;
        }
        a.terms.extend(b.terms);
        Ok(a)
    }

    /// A combination times a number, with dimension and angle as in any product.
    fn product(
        &mut self,
        combination: Combination,
        factor: &Scalar,
        (left, right): (ExprId, ExprId),
        environment: Environment,
    ) -> Evaluated<Piece> {
        let unit =
            crate::base::Quantity { si: Number::ONE, dimension: combination.dimension, angle: combination.angle };
        let product = super::value::multiply(&unit.into(), &Value::Scalar(factor.clone()));
        match product {
            Ok(Value::Scalar(Scalar { quantity, .. })) => {
                let terms = scaled_terms(combination.terms, &quantity.si);
                Ok(Piece::Motions(Combination { terms, dimension: quantity.dimension, angle: quantity.angle }))
            }
            Ok(Value::Vector(_)) | Err(_) => {
                let (left, right) = (self.tree.expr(left).span, self.tree.expr(right).span);
                let error = ValueError::Operation { fault: Fault::Exponent, operator: Binary::Multiply, left, right };
                self.fail(environment, error)
            }
        }
    }

    fn inverse(
        &mut self,
        divisor: &Scalar,
        (left, right): (ExprId, ExprId),
        environment: Environment,
    ) -> Evaluated<Scalar> {
        let one = Value::from(crate::base::Quantity::plain(Number::ONE));
        match super::value::divide(&one, &Value::Scalar(divisor.clone())) {
            Ok(Value::Scalar(inverse)) => Ok(inverse),
            Ok(Value::Vector(_)) => Err(Stop::Reported),
            Err(fault) => {
                let (left, right) = (self.tree.expr(left).span, self.tree.expr(right).span);
                self.fail(environment, ValueError::Operation { fault, operator: Binary::Divide, left, right })
            }
        }
    }

    /// `rod.angle`, `rod@(0, -2 m).x`, `s.force`, `front.wheel.y`: the path before the word of the motion, and that word.
    fn member(&mut self, base: ExprId, word: Span, environment: Environment) -> Evaluated<Piece> {
        let node = *self.tree.expr(base);
        let (owner, at) = match node.kind {
            ExprKind::At { base, point } => (base, Some(self.position(point, environment)?)),
            _ => (base, None),
        };
        let owner_node = *self.tree.expr(owner);
        let text = self.sources.slice(word);
        let ((motion, dimension), coefficient) = match self.expression_part(owner, environment, body_or_element())? {
            scope::Part::Body(index) if at.is_none() && is_of_support(text) => {
                return self.support_reaction(BodyId(index), (text, word), environment);
            }
            scope::Part::Body(index) => self.part_motion(Part::Body(BodyId(index)), at, text, word, environment)?,
            scope::Part::Base(index) => self.part_motion(Part::Base(BaseId(index)), at, text, word, environment)?,
            scope::Part::Element(index) => {
                (self.element_motion(index, at.is_some(), text, word, environment)?, Number::ONE)
            }
            scope::Part::Joint(index) => return self.joint_reaction(index, at.is_some(), (text, word), environment),
            scope::Part::Couple(index) => return self.couple_reaction(index, at.is_some(), (text, word), environment),
            scope::Part::Ground => return self.motion_of_ground(text, word, environment),
            other => {
                let span = match owner_node.kind {
                    ExprKind::Name { .. } => self.word_of(owner_node.span),
                    _ => owner_node.span,
                };
                let (word, found) = (self.sources.slice(span).to_string(), self.noun_of(other));
                let declared = self.part_span(other);
                return self.fail(environment, NameError::NotABody { span, word, found, declared });
            }
        };
        let is_angle = matches!(motion, Motion::Turn { .. }) || dimension.is_none();
        let angle = if is_angle { Angle::Radians } else { Angle::Plain };
        let terms = vec![MotionTerm { coefficient, motion }];
        Ok(Piece::Motions(Combination { terms, dimension, angle }))
    }

    /// A port that is tied to the ground does not move.
    fn motion_of_ground(&mut self, text: &str, word: Span, environment: Environment) -> Evaluated<Piece> {
        let &motions::Motion { direction, dimension, .. } = self.known_motion(text, word, environment)?;
        let angle = if direction == Direction::Turn { Angle::Radians } else { Angle::Plain };
        Ok(Piece::Motions(Combination { terms: Vec::new(), dimension, angle }))
    }

    /// A motion of bodies by its word.
    fn known_motion(
        &mut self,
        text: &str,
        word: Span,
        environment: Environment,
    ) -> Evaluated<&'static motions::Motion> {
        if let Some(motion) = BODY_MOTIONS.iter().find(|motion| motion.name == text) {
            return Ok(motion);
        }
        let known = || BODY_MOTIONS.iter().map(|motion| motion.name);
        let (suggestion, of) = (nearest(text, known()), "a body");
        let known = known().collect();
        self.fail(
            environment,
            QuestionError::UnknownMotion { span: word, word: text.to_string(), of, suggestion, known },
        )
    }

    /// A motion of a body or base given by its word, in the axes of the component that mentions it, and the factor to
    /// multiply it by.
    pub fn part_motion(
        &mut self,
        part: Part,
        at: Option<Arc<Vec3>>,
        text: &str,
        word: Span,
        environment: Environment,
    ) -> Evaluated<((Motion, Dimension), Number)> {
        let &motions::Motion { direction, derivative, dimension, .. } = self.known_motion(text, word, environment)?;
        self.require_unbroken_part(part)?;
        let direction = match axis(direction) {
            Some(axis) => Some((*self.rotate_to_scene(Arc::new(axis), environment)?).clone()),
            None => None,
        };
        if !self.has_freedom(part, at.as_deref(), direction.as_ref()) {
            let name = self.part_name(part);
            let error = QuestionError::NoSuchFreedom { span: word, name, turns: direction.is_none() };
            return self.fail(environment, error);
        }
        Ok(match direction {
            Some(direction) => {
                let at = at.or_else(|| self.own_position(part));
                ((Motion::Point { part, at, direction, derivative }, dimension), Number::ONE)
            }
            None => {
                let sign = if self.reverses(environment)? { -1 } else { 1 };
                ((Motion::Turn { part, derivative }, dimension), Number::from(sign))
            }
        })
    }

    fn require_unbroken_part(&self, part: Part) -> Evaluated<()> {
        let broken = match part {
            Part::Base(id) => self.broken_bases.contains(&id),
            part => self.is_broken(part),
        };
        if broken || self.broken_joints { Err(Stop::Reported) } else { Ok(()) }
    }

    /// Whether a part can move in this way: along a direction, or turn if none is given.
    fn has_freedom(&self, part: Part, at: Option<&Vec3>, direction: Option<&Vec3>) -> bool {
        let turns = self.can_turn(part);
        let Some(direction) = direction else { return turns };
        let own = self.own_position(part);
        let has_lever = match (at, &own) {
            (Some(at), Some(own)) => super::ends::are_apart(at, own),
            (at, _) => at.is_some(),
        };
        if turns && has_lever {
            return true;
        }
        let translations = match part {
            Part::Ground => return false,
            Part::Base(id) => &self.scene.bases[id.index()].translations,
            Part::Body(id) => match &self.scene.bodies[id.index()].freedom {
                Freedom::OnGround { translations, .. } => translations,
                Freedom::FromJoints => return self.line_reaches(part, direction),
            },
        };
        translations.iter().any(|translation| !translation.direction.dot(direction).is_zero())
    }

    /// Whether a part moves along a single line.
    pub fn moves_along_line(&self, part: Part) -> bool {
        matches!(self.line(part), Line::Along(_))
    }

    /// Whether the motion that joints leave a part may have a component along a direction.
    fn line_reaches(&self, part: Part, direction: &Vec3) -> bool {
        match self.line(part) {
            Line::Fixed => false,
            Line::Along(line) => !line.dot(direction).is_zero(),
            Line::Other => true,
        }
    }

    fn element_motion(
        &mut self,
        index: u32,
        has_point: bool,
        text: &str,
        word: Span,
        environment: Environment,
    ) -> Evaluated<(Motion, Dimension)> {
        // The tension at rest is constant and is not part of the motion.
        let reads_rest = self.reads_rest;
        let name_of = |entry: &(ElementMotion, &'static str, &'static str)| match entry.0 {
            ElementMotion::Force if reads_rest => "tension",
            _ => entry.1,
        };
        let found = ELEMENT_MOTIONS.iter().find(|entry| name_of(entry) == text && !has_point);
        let Some((motion, ..)) = found else {
            let known: Vec<&str> = ELEMENT_MOTIONS.iter().map(name_of).collect();
            let (suggestion, of) = (nearest(text, known.iter().copied()), self.noun_of(scope::Part::Element(index)));
            let error = QuestionError::UnknownMotion { span: word, word: text.to_string(), of, suggestion, known };
            return self.fail(environment, error);
        };
        if self.broken_elements {
            return Err(Stop::Reported);
        }
        let element = ElementId(index);
        let torsional = self.scene.elements[element.index()].law.geometry == Geometry::Torsion;
        Ok(match (motion, torsional) {
            (ElementMotion::Force, false) => (Motion::Force { element }, Dimension::FORCE),
            (ElementMotion::Force, true) => (Motion::Force { element }, Dimension::TORQUE),
            (ElementMotion::Stretch, false) => (Motion::Stretch { element }, Dimension::LENGTH),
            (ElementMotion::Stretch, true) => (Motion::Stretch { element }, Dimension::NONE),
        })
    }
}

fn scaled_terms(terms: Vec<MotionTerm>, by: &Number) -> Vec<MotionTerm> {
    let scaled = |term: MotionTerm| MotionTerm { coefficient: &term.coefficient * by, ..term };
    terms.into_iter().map(scaled).collect()
}

pub fn negate(combination: Combination) -> Combination {
    let terms = scaled_terms(combination.terms, &Number::from(-1));
    Combination { terms, ..combination }
}

fn scale(piece: Piece, by: &Number) -> Piece {
    match piece {
        Piece::Scalar(mut scalar) => {
            scalar.quantity.si = &scalar.quantity.si * by;
            Piece::Scalar(scalar)
        }
        Piece::Motions(Combination { terms, dimension, angle }) => {
            Piece::Motions(Combination { terms: scaled_terms(terms, by), dimension, angle })
        }
    }
}
