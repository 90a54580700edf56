//! Joints: pivots, slides, welds. In: two ends. Out: a [`Joint`] whose ends coincide as drawn. See spec.md.

use super::Check;
use super::ends::are_apart;
use super::error::PartError;
use super::evaluate::Evaluated;
use super::scene::{Attachment, Joint, Part};
use super::scope::{Environment, Instance};
use crate::base::Vec3;
use crate::joints::Kind;
use crate::syntax::tree::{DeclKind, End, EndId, ExprId, Ident, Rare};
use std::sync::Arc;

impl<'a> Check<'a> {
    pub fn joints(&mut self) {
        for index in 0..self.instances.joints.len() {
            let Instance { decl, environment } = self.instances.joints[index];
            let DeclKind::Rare { index } = decl.kind else { continue };
            let Rare::Joint { kind, name, ends, along } = self.tree.rare[index as usize] else { continue };
            self.walk.varies = false;
            match self.joint(kind.kind(), name, ends, along, environment) {
                Ok(joint) => self.scene.joints.push(joint),
                Err(_) => self.broken_joints = true,
            }
        }
    }

    fn joint(
        &mut self,
        kind: &'static Kind,
        name: Ident,
        ends: EndId,
        along: Option<ExprId>,
        environment: Environment,
    ) -> Evaluated<Joint> {
        let span = name.span;
        let pair = self.attachments(ends, environment);
        let along = along.map(|along| self.direction(along, environment)).transpose()?;
        let (mut pair, name) = (pair?, self.name(name, environment)?);
        self.require_unbroken(&pair)?;
        if pair[0].part == pair[1].part {
            let (span, part) = (pair[0].span.to(pair[1].span), self.part_name(pair[0].part));
            return self.fail(environment, PartError::JointOfOnePart { span, part });
        }
        let at = match kind.turns {
            true => Some((*self.common_point(ends, &mut pair, environment)?).clone()),
            false => None,
        };
        if kind.slides && along.is_none() {
            return self.fail(environment, PartError::SlideWithoutDirection { span, kind });
        }
        if kind.is_rigid() {
            self.welded_points(ends, &pair, environment)?;
        }
        let along = along.map(|along| (*along).clone());
        Ok(Joint { name, span, kind, ends: pair, at, along })
    }

    /// The position of a pivot: the given point, which then belongs to both ends, or the common position of both parts.
    fn common_point(
        &mut self,
        ends: EndId,
        pair: &mut [Attachment; 2],
        environment: Environment,
    ) -> Evaluated<Arc<Vec3>> {
        let tree = self.tree;
        let (a, b) = tree.pair(ends);
        let given = |end: &End, attachment: &Attachment| end.at.and(attachment.at.clone());
        let at = match (given(a, &pair[0]), given(b, &pair[1])) {
            (Some(at), None) | (None, Some(at)) => at,
            (Some(first), Some(second)) => self.require_coincident(first, &second, pair, environment)?,
            (None, None) => match (pair[0].at.clone(), pair[1].at.clone()) {
                (Some(first), Some(second)) => self.require_coincident(first, &second, pair, environment)?,
                _ => {
                    let span = pair[0].span.to(pair[1].span);
                    let part = self.part_name(pair[0].part);
                    return self.fail(environment, PartError::PivotWithoutPlace { span, part });
                }
            },
        };
        pair[0].at = Some(at.clone());
        pair[1].at = Some(at.clone());
        Ok(at)
    }

    fn require_coincident(
        &mut self,
        first: Arc<Vec3>,
        second: &Arc<Vec3>,
        pair: &[Attachment; 2],
        environment: Environment,
    ) -> Evaluated<Arc<Vec3>> {
        if are_apart(&first, second) {
            let places = [position_text(&first), position_text(second)];
            return self.fail(environment, PartError::EndsApart { spans: [pair[0].span, pair[1].span], places });
        }
        Ok(first)
    }

    /// A weld connects two parts wherever they are; if both ends name a point, it must be the same point.
    fn welded_points(&mut self, ends: EndId, pair: &[Attachment; 2], environment: Environment) -> Evaluated<()> {
        let tree = self.tree;
        let (a, b) = tree.pair(ends);
        if let (Some(_), Some(_), Some(first), Some(second)) = (a.at, b.at, pair[0].at.clone(), &pair[1].at) {
            self.require_coincident(first, second, pair, environment)?;
        }
        Ok(())
    }

    /// Reports bodies that have neither a freedom clause nor a joint.
    pub fn jointless_bodies(&mut self) {
        if self.broken_joints {
            return;
        }
        for index in self.freedoms.without_joint(&self.scene) {
            let body = &self.scene.bodies[index];
            let (span, name) = (body.span, self.words.display(body.name));
            if !self.is_broken(Part::Body(super::scene::BodyId(index as u32))) {
                self.report(self.instances.bodies[index].environment, PartError::NoFreedom { span, name });
            }
        }
    }
}

/// A position for use in a message.
fn position_text(place: &Vec3) -> (f64, f64) {
    (place.x.to_f64(), place.y.to_f64())
}
