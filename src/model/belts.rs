//! Belts: two disks and the common tangents of their circles. In: two ends and the fields. Out: the two spans. See
//! spec.md#belts.

use super::Check;
use super::ends::are_apart;
use super::error::{BeltError, PartError};
use super::evaluate::{Evaluated, Stop};
use super::fields::Given;
use super::scene::{Attachment, BeltSpan, Geometry, Part, Shape};
use super::scope::Environment;
use crate::base::{Number, Span};
use crate::syntax::tree::EndId;
use std::sync::Arc;

impl<'a> Check<'a> {
    /// The disks of a belt, and its two spans; the first one is the span that tightens if the first disk turns
    /// counter-clockwise.
    pub fn spans(
        &mut self,
        ends: EndId,
        given: &Given<'a>,
        environment: Environment,
    ) -> Evaluated<([Attachment; 2], [Geometry; 2])> {
        let crossed = self.flag(given.by_name("crossed").map(|field| field.0), environment)?;
        let tree = self.tree;
        let (a, b) = tree.pair(ends);
        let placed = [a, b].map(|end| end.at.map(|at| tree.expr(at).span));
        let pair = self.attachments(ends, environment)?;
        self.require_unbroken(&pair)?;
        let span = pair[0].span.to(pair[1].span);
        if let Some(at) = placed.into_iter().flatten().next() {
            return self.fail(environment, BeltError::Point { span: at });
        }
        if pair[0].part == pair[1].part {
            let part = self.part_name(pair[0].part);
            return self.fail(environment, PartError::EqualEnds { span, part });
        }
        let [first, second] = [self.radius(&pair[0], environment)?, self.radius(&pair[1], environment)?];
        let (Some(from), Some(to)) = (&pair[0].at, &pair[1].at) else { return Err(Stop::Reported) };
        let gap = if crossed { &first + &second } else { &first - &second };
        let apart = to.sub(from);
        let square = &(&apart.x * &apart.x) + &(&apart.y * &apart.y);
        if !are_apart(from, to) || !(&square - &(&gap * &gap)).is_positive() {
            return self.fail(environment, BeltError::Overlap { span, crossed });
        }
        if !pair.iter().any(|end| self.can_turn(end.part)) {
            if self.broken_joints {
                return Err(Stop::Reported);
            }
            return self.fail(environment, BeltError::NoneTurns { span });
        }
        let other = if crossed { second } else { -&second };
        let left = BeltSpan { left: true, gap: gap.clone(), turns: [first.clone(), other.clone()] };
        let right = BeltSpan { left: false, gap, turns: [-&first, -&other] };
        Ok((pair, [left, right].map(|span| Geometry::Span(Arc::new(span)))))
    }

    /// The radius of a disk that has a centre.
    fn radius(&mut self, end: &Attachment, environment: Environment) -> Evaluated<Number> {
        let Part::Body(id) = end.part else { return self.not_a_disk(end.span, end.part, environment) };
        let body = &self.scene.bodies[id.index()];
        match body.shape.as_deref() {
            Some(Shape::Disk { radius } | Shape::Ring { radius }) if body.centre.is_some() => Ok(radius.clone()),
            Some(Shape::Disk { .. } | Shape::Ring { .. }) => {
                let name = self.part_name(end.part);
                self.fail(environment, BeltError::NoCentre { span: end.span, name })
            }
            _ => self.not_a_disk(end.span, end.part, environment),
        }
    }

    fn not_a_disk(&mut self, span: Span, part: Part, environment: Environment) -> Evaluated<Number> {
        let name = self.part_name(part);
        self.fail(environment, BeltError::NoDisk { span, name })
    }
}
