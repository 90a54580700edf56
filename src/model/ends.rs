//! Ends of elements, joints and inputs: `block`, `block@A`, `ground@(0, 1 m)`. In: an end as written. Out: the part and
//! its drawn position. See spec.md.

use super::Check;
use super::error::NameError;
use super::evaluate::{Evaluated, Stop};
use super::scene::{Attachment, BaseId, BodyId, Part};
use super::scope::{self, Environment};
use crate::base::{Name, Span, Vec3};
use crate::syntax::tree::{End, EndId, Ident, Path};
use std::sync::Arc;

impl<'a> Check<'a> {
    pub fn attachment(&mut self, end: &End, environment: Environment) -> Evaluated<Attachment> {
        // Both are evaluated, so that both mistakes are reported.
        let part = self.part(end.part(), environment);
        let at = end.at.map(|at| self.position(at, environment)).transpose()?;
        let part = part?;
        Ok(Attachment { part, at: at.or_else(|| self.own_position(part)), span: end.span })
    }

    /// Both ends of an element or joint.
    pub fn attachments(&mut self, first: EndId, environment: Environment) -> Evaluated<[Attachment; 2]> {
        let tree = self.tree;
        let (a, b) = tree.pair(first);
        let a = self.attachment(a, environment);
        let b = self.attachment(b, environment)?;
        Ok([a?, b])
    }

    /// The place where a part is drawn, if it has one.
    pub fn own_position(&self, part: Part) -> Option<Arc<Vec3>> {
        match part {
            Part::Ground => None,
            Part::Body(id) => self.scene.bodies[id.index()].centre.clone(),
            Part::Base(id) => self.scene.bases[id.index()].at.clone(),
        }
    }

    /// The ground, body or base of this name.
    pub fn part(&mut self, path: Path, environment: Environment) -> Evaluated<Part> {
        let Path { first, whole } = path;
        if whole.is_none() && first.indices.is_empty() && self.sources.slice(first.span) == "ground" {
            return Ok(Part::Ground);
        }
        match self.path_part(path, environment, "body")? {
            scope::Part::Body(index) => Ok(Part::Body(BodyId(index))),
            scope::Part::Base(index) => Ok(Part::Base(BaseId(index))),
            scope::Part::Ground => Ok(Part::Ground),
            other => {
                let span = self.path_span(path);
                let (word, found) = (self.sources.slice(span).to_string(), self.noun_of(other));
                let error = NameError::NotABody { span, word, found, declared: self.part_span(other) };
                self.fail(environment, error)
            }
        }
    }

    /// The place where a part is named, without its indices if it has a single name.
    pub fn path_span(&self, path: Path) -> Span {
        path.whole.map_or(path.first.span, |whole| self.tree.expr(whole).span)
    }

    /// The part of any kind that has this name; `wanted` names what the place requires, for messages.
    pub fn named_part(
        &mut self,
        ident: Ident,
        environment: Environment,
        wanted: &'static str,
    ) -> Evaluated<scope::Part> {
        let name = self.name(ident, environment)?;
        self.find_part(name, ident, environment, wanted)
    }

    pub fn find_part(
        &mut self,
        name: Name,
        ident: Ident,
        environment: Environment,
        wanted: &'static str,
    ) -> Evaluated<scope::Part> {
        if let Some(part) = self.parts.get(name) {
            return self.resolve_port(part);
        }
        let error = self.unknown_part(ident, name, wanted, environment);
        self.fail_unless_broken(environment, ident.span, error)
    }

    /// Whether a body could not be checked. Errors that follow from that are not reported.
    pub fn is_broken(&self, part: Part) -> bool {
        matches!(part, Part::Body(id) if self.broken_bodies.contains(&id))
    }

    /// Stops silently if one of the parts is broken.
    pub fn require_unbroken(&self, ends: &[Attachment]) -> Evaluated<()> {
        if ends.iter().any(|end| self.is_broken(end.part)) { Err(Stop::Reported) } else { Ok(()) }
    }

    /// The name of a part as the model writes it.
    pub fn part_name(&self, part: Part) -> String {
        match part {
            Part::Ground => "ground".into(),
            Part::Body(id) => self.words.display(self.scene.bodies[id.index()].name),
            Part::Base(id) => self.words.display(self.scene.bases[id.index()].name),
        }
    }
}

/// Whether two points certainly differ.
pub fn are_apart(a: &Vec3, b: &Vec3) -> bool {
    !a.sub(b).may_be_zero()
}
