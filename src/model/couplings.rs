//! Couplings and initial states. In: `couple` and `initial`. Out: linear combinations of motions that are zero, and
//! values of single motions at t = 0. See spec.md.

use super::Check;
use super::error::{NameError, QuestionError};
use super::evaluate::{Evaluated, Stop};
use super::motions::{Combination, Piece, negate};
use super::scene::{BodyId, Couple, Initial, Motion, MotionTerm, Part};
use super::scope::{Environment, Instance};
use crate::base::{Number, OrderBy, Span, Vec3};
use crate::kinds::motions::INITIAL_FIELDS;
use crate::syntax::tree::{DeclKind, ExprId, Fields, Ident, Path, Rare};

impl<'a> Check<'a> {
    pub fn couples(&mut self) {
        for index in 0..self.instances.couples.len() {
            let Instance { decl, environment } = self.instances.couples[index];
            let DeclKind::Rare { index } = decl.kind else { continue };
            let Rare::Couple { name, left, right } = self.tree.rare[index as usize] else { continue };
            self.walk.varies = false;
            if let Ok(couple) = self.couple(name, left, right, environment) {
                self.scene.couples.push(couple);
            }
        }
    }

    /// left - right = 0.
    fn couple(&mut self, ident: Ident, left: ExprId, right: ExprId, environment: Environment) -> Evaluated<Couple> {
        let a = self.side(left, environment);
        let b = self.side(right, environment)?;
        let Combination { mut terms, dimension, .. } = match (a?, b) {
            (Some(a), Some(b)) => self.difference(a, b, (left, right), environment)?,
            (Some(one), None) => one,
            (None, Some(one)) => negate(one),
            (None, None) => {
                let span = self.tree.expr(left).span.to(self.tree.expr(right).span);
                return self.fail(environment, QuestionError::NoMotion { span });
            }
        };
        let span = self.tree.expr(left).span.to(self.tree.expr(right).span);
        self.couples_displacements(&terms, span, environment)?;
        // There may be a million of these lists, and each has few terms.
        terms.shrink_to_fit();
        Ok(Couple { name: self.name(ident, environment)?, span: ident.span, dimension, terms })
    }

    /// One side of a coupling; `None` for a bare zero.
    fn side(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Option<Combination>> {
        match self.piece(expr, environment)? {
            Piece::Motions(combination) => Ok(Some(combination)),
            Piece::Scalar(zero) if zero.bare_zero => Ok(None),
            Piece::Scalar(_) => {
                let span = self.tree.expr(expr).span;
                self.fail(environment, QuestionError::NonLinear { span })
            }
        }
    }

    /// Checks that a coupling relates only displacements and angles, and at least one of them of a body.
    fn couples_displacements(&mut self, terms: &[MotionTerm], span: Span, environment: Environment) -> Evaluated<()> {
        let is_displacement = |term: &MotionTerm| {
            matches!(term.motion, Motion::Point { derivative: 0, .. } | Motion::Turn { derivative: 0, .. })
        };
        let is_of_body = |term: &MotionTerm| match term.motion {
            Motion::Point { part, .. } | Motion::Turn { part, .. } => matches!(part, Part::Body(_)),
            Motion::Force { .. } | Motion::Stretch { .. } | Motion::Reaction(_) => false,
        };
        if terms.iter().all(is_displacement) && terms.iter().any(is_of_body) {
            return Ok(());
        }
        self.fail(environment, QuestionError::CoupleOfOthers { span })
    }

    pub fn initials(&mut self) {
        let mut first: Vec<(BodyId, Span)> = Vec::new();
        for index in 0..self.instances.initials.len() {
            let Instance { decl, environment } = self.instances.initials[index];
            let DeclKind::Rare { index } = decl.kind else { continue };
            let Rare::Initial { body, fields } = self.tree.rare[index as usize] else { continue };
            self.walk.varies = false;
            if let Ok(initial) = self.initial(body, fields, environment) {
                first.push((initial.body, initial.span));
                self.scene.initial.push(initial);
            }
        }
        self.initial_twice(first);
    }

    fn initial_twice(&mut self, mut states: Vec<(BodyId, Span)>) {
        states.order_by_key(|(body, _)| *body);
        for pair in states.windows(2) {
            if pair[0].0 == pair[1].0 {
                let error = NameError::SettingTwice { span: pair[1].1, first: pair[0].1, what: "the initial state" };
                self.report(Environment::TOP, error);
            }
        }
    }

    fn initial(&mut self, path: Path, fields: Fields, environment: Environment) -> Evaluated<Initial> {
        let given = self.fields(fields, &INITIAL_FIELDS, environment);
        let part = self.part(path, environment)?;
        let at = self.path_span(path);
        let Part::Body(body) = part else {
            let found = if part == Part::Ground { "the ground" } else { "a base" };
            let word = self.sources.slice(at).to_string();
            return self.fail(environment, QuestionError::NoInitialState { span: at, word, found });
        };
        let mut values: Vec<(Motion, Number, Span)> = Vec::new();
        for (index, described) in INITIAL_FIELDS.iter().enumerate() {
            let Some(field) = given.get(index) else { continue };
            let value: Option<(Number, Span)> =
                self.field_number(Some(field), environment, &described.expected_number(false))?;
            let word = self.sources.slice(field.key);
            let ((motion, _), sign) = self.part_motion(part, None, word, field.key, environment)?;
            values.extend(value.map(|(value, span)| (motion, &value * &sign, span)));
        }
        let turns = self.placement(environment)?.is_some_and(|placed| !placed.scene.keeps_directions());
        if turns && !self.moves_along_line(part) {
            values = in_scene_axes(values);
        }
        if given.broken { Err(Stop::Reported) } else { Ok(Initial { body, span: at, values }) }
    }
}

/// Displacements and velocities along the rotated axes of a component, converted to x and y: the ones that are not
/// given are zero. If one of the results is certainly zero, only the other one is returned.
fn in_scene_axes(values: Vec<(Motion, Number, Span)>) -> Vec<(Motion, Number, Span)> {
    let mut of_scene: Vec<(Motion, Number, Span)> = Vec::new();
    for order in [0, 1] {
        let along = |motion: &Motion| matches!(motion, Motion::Point { derivative, .. } if *derivative == order);
        let of_order = values.iter().filter(|(motion, ..)| along(motion));
        let mut sums: Option<(Vec3, &(Motion, Number, Span))> = None;
        for value in of_order {
            let Motion::Point { direction, .. } = &value.0 else { continue };
            let share = direction.scale(&value.1);
            sums = Some(match sums {
                None => (share, value),
                Some((sum, first)) => (sum.add(&share), first),
            });
        }
        let Some((sum, (Motion::Point { part, at, .. }, _, span))) = sums else { continue };
        for (direction, component) in [(Vec3::X, sum.x), (Vec3::Y, sum.y)] {
            if !component.is_zero() {
                of_scene.push((
                    Motion::Point { part: *part, at: at.clone(), direction, derivative: order },
                    component,
                    *span,
                ));
            }
        }
    }
    of_scene.extend(values.into_iter().filter(|(motion, ..)| !matches!(motion, Motion::Point { .. })));
    of_scene
}
