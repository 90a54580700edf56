//! Forces, torques and bases as inputs. In: ends, direction and signal. Out: an [`Input`]. See spec.md.

use super::Check;
use super::error::{NameError, PartError, ValueError};
use super::evaluate::{Evaluated, Stop};
use super::freedoms::Line;
use super::scene::{Attachment, Axis, BaseId, Geometry, Input, InputKind, Part, Signal};
use super::scope::{Environment, Instance};
use super::signals::Signals;
use crate::base::{Number, Span, Takes, Vec3};
use crate::kinds::declarations::UNBALANCE_FIELDS;
use crate::kinds::functions::{FORCE_SIGNAL, ROTATION_SIGNALS, TORQUE_SIGNAL, TRANSLATION_SIGNALS};
use crate::syntax::tree::{DeclKind, EndId, ExprId, Field, Fields, Ident, Rare};
use crate::system::Signal as Function;
use std::sync::Arc;

impl<'a> Check<'a> {
    pub fn inputs(&mut self) {
        let mut bases = 0..;
        for index in 0..self.instances.inputs.len() {
            let Instance { decl, environment } = self.instances.inputs[index];
            let DeclKind::Rare { index } = decl.kind else { continue };
            self.walk.varies = false;
            let done = match self.tree.rare[index as usize] {
                Rare::Force { name, from, to, along, signal } => {
                    self.force(name, (from, to), along, signal, environment)
                }
                Rare::Torque { name, from, to, signal } => self.torque(name, (from, to), signal, environment),
                Rare::Unbalance { name, end, fields } => self.unbalance(name, end, fields, environment),
                Rare::Base { signal, .. } => {
                    let id = BaseId(bases.next().unwrap_or(0));
                    self.base_inputs(id, signal, environment)
                }
                _ => Ok(()),
            };
            self.broken_inputs |= done.is_err();
        }
    }

    fn force(
        &mut self,
        ident: Ident,
        ends: (EndId, Option<EndId>),
        along: Option<ExprId>,
        signal: Option<ExprId>,
        environment: Environment,
    ) -> Evaluated<()> {
        let ends = self.input_ends(ends, environment);
        let along = along.map(|along| self.direction(along, environment)).transpose()?;
        let ends = ends?;
        let kind = match (along, ends) {
            (Some(direction), ends) => InputKind::Force { ends, direction: (*direction).clone() },
            (None, ends) => self.undirected_force(ends, environment)?,
        };
        let signal = self.signal(signal, &[FORCE_SIGNAL], environment)?;
        self.push_input(ident, kind, signal, environment)
    }

    /// `force F: a -- b` acts along the line between its points or, if there is none, along the common line of the parts.
    fn undirected_force(&mut self, ends: Vec<Attachment>, environment: Environment) -> Evaluated<InputKind> {
        match <[Attachment; 2]>::try_from(ends) {
            Ok(pair) => Ok(match self.line_or_direction(&pair, environment)? {
                Geometry::Along(line) => {
                    let [a, b] = pair;
                    // A positive force drives the ends apart: the second end forwards, the first end back.
                    InputKind::Force { ends: vec![b, a], direction: (*line).clone() }
                }
                _ => InputKind::ForceBetween { ends: pair },
            }),
            Err(ends) => {
                let direction = self.only_line(&ends[0], environment)?;
                Ok(InputKind::Force { ends, direction: (*direction).clone() })
            }
        }
    }

    /// The line along which the part of a single end moves.
    fn only_line(&mut self, end: &Attachment, environment: Environment) -> Evaluated<Arc<Vec3>> {
        match self.line(end.part) {
            Line::Along(line) => Ok(self.own_line(line, end.part, environment)),
            _ if self.broken_joints => Err(Stop::Reported),
            _ => self.fail(environment, PartError::ForceWithoutDirection { span: end.span }),
        }
    }

    fn torque(
        &mut self,
        ident: Ident,
        ends: (EndId, Option<EndId>),
        signal: Option<ExprId>,
        environment: Environment,
    ) -> Evaluated<()> {
        let mut ends = self.input_ends(ends, environment)?;
        if !ends.iter().any(|end| self.can_turn(end.part)) {
            if self.broken_joints {
                return Err(Stop::Reported);
            }
            let span = ends.iter().map(|end| end.span).reduce(Span::to).unwrap_or(ident.span);
            return self.fail(environment, PartError::NoEndTurns { span, torsional: None });
        }
        if self.reverses(environment)? {
            // Counter-clockwise in a component that is mirrored: the torque on the second end has the opposite sign.
            if let [one] = &ends[..] {
                ends.push(Attachment { part: Part::Ground, at: None, span: one.span });
            }
            ends.reverse();
        }
        let signal = self.signal(signal, &[TORQUE_SIGNAL], environment)?;
        self.push_input(ident, InputKind::Torque { ends }, signal, environment)
    }

    /// An input for each axis, with the harmonic of its speed.
    fn unbalance(&mut self, ident: Ident, end: EndId, fields: Fields, environment: Environment) -> Evaluated<()> {
        let given = self.fields(fields, &UNBALANCE_FIELDS, environment);
        let [me, speed, clockwise] = [0, 1, 2].map(|place| given.get(place));
        let clockwise = self.flag(clockwise, environment);
        // Its name may be the mistake.
        let size = match me {
            None if given.broken => Err(Stop::Reported),
            me => self.unbalance_size(me, ident, environment),
        };
        let speed = speed.map(|field| {
            let expr = self.field_expr(field, environment)?;
            Ok((self.frequency(expr, environment)?, self.tree.expr(expr).span))
        });
        let speed = speed.transpose();
        let end = self.input_ends((end, None), environment)?;
        let (clockwise, size, speed) = (clockwise?, size?, speed?);
        if given.broken {
            return Err(Stop::Reported);
        }
        let (name, reverses) = (self.name(ident, environment)?, self.reverses(environment)?);
        let needs_speed = speed.is_none() && !size.is_zero();
        let signal_span = speed.as_ref().map(|(_, span)| *span);
        for (axis, local) in [(Axis::X, Vec3::X), (Axis::Y, Vec3::Y)] {
            let direction = self.rotate_to_scene(Arc::new(local), environment)?;
            let signal = speed.iter().map(|(speed, _)| centripetal(&size, speed, axis, clockwise)).collect();
            let kind = InputKind::Unbalance {
                end: [end[0].clone()],
                direction: (*direction).clone(),
                axis,
                clockwise: clockwise != reverses,
                needs_speed,
            };
            self.scene.inputs.push(Input { name, span: ident.span, kind, signal, derivative: 2, signal_span });
        }
        Ok(())
    }

    fn unbalance_size(&mut self, me: Option<&Field>, ident: Ident, environment: Environment) -> Evaluated<Number> {
        let Takes::Number(expected) = UNBALANCE_FIELDS[0].takes else { return Err(Stop::Reported) };
        match self.field_number(me, environment, &expected)? {
            Some((size, span)) if size.to_f64() < 0.0 => {
                self.fail(environment, ValueError::Negative { span, what: "an unbalance" })
            }
            Some((size, _)) => Ok(size),
            None => self.fail(environment, NameError::FieldMissing { span: ident.span, expected }),
        }
    }

    /// One or two ends; at least one must be on a body, and two ends must be on different parts.
    fn input_ends(
        &mut self,
        (from, to): (EndId, Option<EndId>),
        environment: Environment,
    ) -> Evaluated<Vec<Attachment>> {
        let tree = self.tree;
        let first = self.attachment(tree.end(from), environment);
        let second = to.map(|to| self.attachment(tree.end(to), environment)).transpose()?;
        let first = first?;
        let ends: Vec<Attachment> = std::iter::once(first).chain(second).collect();
        self.require_unbroken(&ends)?;
        let span = ends.iter().map(|end| end.span).reduce(Span::to).unwrap_or(ends[0].span);
        if let [a, b] = &ends[..]
            && a.part == b.part
        {
            let part = self.part_name(a.part);
            return self.fail(environment, PartError::EqualEnds { span, part });
        }
        if !ends.iter().any(|end| matches!(end.part, Part::Body(_))) {
            let part = self.part_name(ends[0].part);
            return self.fail(environment, PartError::InputWithoutEffect { span, part });
        }
        Ok(ends)
    }

    fn push_input(
        &mut self,
        ident: Ident,
        kind: InputKind,
        signals: Signals,
        environment: Environment,
    ) -> Evaluated<()> {
        let name = self.name(ident, environment)?;
        let Signals { list: signal, span: signal_span, derivative, delay } = signals;
        if let Some(delay) = delay {
            self.delay_next_input(delay, environment);
        }
        self.scene.inputs.push(Input { name, span: ident.span, kind, signal, derivative, signal_span });
        Ok(())
    }

    /// Makes an input for each motion of a base.
    fn base_inputs(&mut self, base: BaseId, signal: Option<ExprId>, environment: Environment) -> Evaluated<()> {
        if self.broken_bases.contains(&base) {
            return Err(Stop::Reported);
        }
        let (name, span) = (self.scene.bases[base.index()].name, self.scene.bases[base.index()].span);
        let translations = self.scene.bases[base.index()].translations.len();
        let turns = self.scene.bases[base.index()].turns;
        let motions = (0..translations).map(Some).chain(turns.then_some(None));
        let motions: Vec<Option<usize>> = motions.collect();
        let signals = match (signal, &motions[..]) {
            (Some(signal), [one]) => {
                let kinds = if one.is_some() { &TRANSLATION_SIGNALS } else { &ROTATION_SIGNALS };
                self.signal(Some(signal), kinds, environment)?
            }
            (Some(signal), _) => {
                let span = self.tree.expr(signal).span;
                return self.fail(environment, PartError::SignalOfManyMotions { span });
            }
            (None, _) => Signals::default(),
        };
        let Signals { list: signal, span: signal_span, derivative, delay } = signals;
        if let Some(delay) = delay {
            self.delay_next_input(delay, environment);
        }
        let reverses = self.reverses(environment)?;
        for translation in motions {
            let kind = InputKind::Base { base, translation };
            // Counter-clockwise in a component that is mirrored.
            let is_reversed = translation.is_none() && reverses;
            let signal =
                signal.iter().map(|signal| if is_reversed { signal.negate() } else { signal.clone() }).collect();
            self.scene.inputs.push(Input { name, span, kind, signal, derivative, signal_span });
        }
        Ok(())
    }
}

/// The second derivative of a component of the heavy spot's place times its mass: that of m e cos(omega t) along x, and of
/// m e sin(omega t) along y, or the opposite.
fn centripetal(size: &Number, speed: &Number, axis: Axis, clockwise: bool) -> Signal {
    let omega = &(&Number::pi() * &Number::from(2)) * speed;
    let value = -&(size * &(&omega * &omega));
    let (value, phase) = match axis {
        Axis::X => (value, &Number::pi() / &Number::from(2)),
        Axis::Y => (if clockwise { -&value } else { value }, Number::ZERO),
    };
    Function::Harmonic { value, frequency: speed.clone(), phase, at: Number::ZERO }.into()
}
