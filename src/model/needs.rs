//! Properties that a body's degrees of freedom require, and properties that have no effect: mass, inertia, place. In:
//! bodies with their degrees of freedom. Out: errors for missing properties, warnings for idle ones. See
//! docs/method/kinematics.md.
//!
//! Whether a degree of freedom moves any inertia at all depends on everything that it carries, and is decided when the
//! scene is lowered. The checks here only guard against oversights.

use super::Check;
use super::error::{PartError, QuestionError};
use super::freedoms::Line;
use super::scene::{Body, BodyId, Freedom, Part};
use super::scope::{DefinitionKind, Environment};
use crate::base::{Number, Place, Span, Vec3};
use crate::syntax::tree::{DeclKind, Field};

impl<'a> Check<'a> {
    pub fn needs(&mut self) {
        for index in 0..self.scene.bodies.len() {
            let id = BodyId(index as u32);
            if self.broken_bodies.contains(&id) {
                continue;
            }
            self.walk.varies = false;
            let environment = self.instances.bodies[index].environment;
            match self.scene.bodies[index].freedom.clone() {
                Freedom::OnGround { translations, turns } => {
                    let moves = translations.first().map(|translation| translation.motion);
                    self.needs_on_ground(id, moves, turns, environment);
                }
                Freedom::FromJoints if self.broken_joints => {}
                Freedom::FromJoints => self.needs_of_joints(id, environment),
            }
        }
    }

    fn needs_on_ground(&mut self, id: BodyId, moves: Option<&'static str>, turns: bool, environment: Environment) {
        let body = &self.scene.bodies[id.index()];
        let (has_mass, has_inertia) = (body.mass.is_some(), body.inertia.is_some());
        if let Some(motion) = moves
            && !has_mass
        {
            let motion = if motion == "along" { "moves along a line" } else { "moves" };
            self.missing(id, "mass", motion, environment);
        } else if turns && !has_inertia {
            let what = if self.field_of(id, "shape").is_some() { "mass" } else { "inertia" };
            self.missing(id, what, "turns", environment);
        } else if !turns {
            self.idle_inertia(id, environment);
        } else if moves.is_none() && self.field_of(id, "shape").is_none() && !self.inertia_uses_mass(id) {
            self.warn_idle(id, "mass", "has no effect: the body only turns about its centre", environment);
        }
    }

    fn needs_of_joints(&mut self, id: BodyId, environment: Environment) {
        let part = Part::Body(id);
        let turns = self.can_turn(part);
        if !turns {
            self.idle_inertia(id, environment);
        }
        if !turns && self.line(part) == Line::Fixed {
            return self.warn_idle(id, "mass", "has no effect: the body is fixed to the ground", environment);
        }
        let body = &self.scene.bodies[id.index()];
        if body.mass.is_none() {
            if !self.turns_about_its_inertia(id) {
                self.missing(id, "mass", "moves with its joints", environment);
            }
        } else if turns && body.centre.is_none() {
            let (span, name) = (body.span, self.words.display(body.name));
            self.report(environment, PartError::CentreMissing { span, name });
        }
    }

    /// Whether the body's only joint is a pivot on the ground, at the very point that the inertia is given about, and
    /// there is no gravity: then the mass has no effect.
    fn turns_about_its_inertia(&self, id: BodyId) -> bool {
        let body = &self.scene.bodies[id.index()];
        let about = self.inertia_points.get(&id).or(body.centre.as_ref());
        let (Some(_), Some(about)) = (&body.inertia, about) else { return false };
        let joints = self.scene.joints.iter();
        let mut joints = joints.filter(|joint| joint.ends.iter().any(|end| end.part == Part::Body(id)));
        let (Some(only), None) = (joints.next(), joints.next()) else { return false };
        let on_ground = only.ends.iter().any(|end| end.part == Part::Ground);
        let hangs = self.instances.settings.iter().any(|setting| matches!(setting.decl.kind, DeclKind::Gravity { .. }));
        let centred = body.centre.as_ref().is_some_and(|centre| !super::ends::are_apart(centre, about));
        let is_about = only.at.as_ref().is_some_and(|at| !super::ends::are_apart(at, about));
        is_about && !only.kind.slides && on_ground && (!hangs || centred)
    }

    fn missing(&mut self, id: BodyId, what: &'static str, freedom: &'static str, environment: Environment) {
        let body = &self.scene.bodies[id.index()];
        let (span, name) = (body.span, self.words.display(body.name));
        self.report(environment, PartError::PropertyMissing { span, name, what, freedom });
    }

    /// The field of a body's declaration.
    fn field_of(&self, id: BodyId, word: &str) -> Option<&'a Field> {
        let DeclKind::Body { fields, .. } = self.instances.bodies[id.index()].decl.kind else { return None };
        self.tree.fields(fields).iter().find(|field| self.sources.slice(field.key) == word)
    }

    fn inertia_uses_mass(&self, id: BodyId) -> bool {
        let field = self.field_of(id, "inertia");
        field.is_some_and(|field| matches!(field.value, crate::syntax::tree::FieldValue::About(..)))
    }

    /// Warns about the inertia of a body that never turns, and about a shape that serves no other purpose.
    fn idle_inertia(&mut self, id: BodyId, environment: Environment) {
        self.warn_idle(id, "inertia", "has no effect: the body does not turn", environment);
        let Some(shape) = self.field_of(id, "shape") else { return };
        // A rod also gives the place of the centre.
        let crate::syntax::tree::FieldValue::Expr(expr) = shape.value else { return };
        if !self.sources.slice(self.tree.expr(expr).span).starts_with("rod") {
            self.warn_idle(id, "shape", "has no effect: the body does not turn", environment);
        }
    }

    fn warn_idle(&mut self, id: BodyId, word: &'static str, why: &'static str, environment: Environment) {
        // A body that nothing moves is carried by a joint or by the ground.
        if word == "mass" && self.asks_for_reactions() {
            return;
        }
        if let Some(field) = self.field_of(id, word) {
            let (span, name) = (field.key, self.words.display(self.scene.bodies[id.index()].name));
            self.report(environment, QuestionError::Idle { span, name, word, why });
        }
    }

    /// Warns about declarations that are never used, and reports a model without a body.
    pub fn warn_unused(&mut self) {
        if !self.tree.broken.is_empty() || self.diagnostics.has_errors() {
            // The broken part may have contained the use.
            return;
        }
        self.walk.varies = false;
        if self.instances.bodies.is_empty() {
            let span = Span::new(self.tree.file, 0, 0);
            return self.report(Environment::TOP, PartError::Empty { span });
        }
        self.unused_definitions();
        self.idle_gravity();
    }

    /// Notes that gravity has no effect: no mass can fall, swing or stretch its support.
    fn idle_gravity(&mut self) {
        let Some(span) = self.scene.gravity_span else { return };
        let field = self.scene.gravity.clone();
        let acts = (0..self.scene.bodies.len()).any(|index| self.gravity_acts(BodyId(index as u32), &field));
        if !acts && !self.asks_for_reactions() {
            self.report(Environment::TOP, QuestionError::IdleGravity { span });
        }
    }

    fn gravity_acts(&self, id: BodyId, field: &Vec3) -> bool {
        let body: &Body = &self.scene.bodies[id.index()];
        if body.mass.as_ref().is_none_or(Number::is_zero) || field.is_zero() {
            return false;
        }
        match &body.freedom {
            Freedom::OnGround { translations, .. } => {
                translations.iter().any(|translation| !translation.direction.dot(field).is_zero())
            }
            Freedom::FromJoints => match self.line(Part::Body(id)) {
                Line::Fixed => self.can_turn(Part::Body(id)),
                Line::Along(line) => !line.dot(field).is_zero(),
                Line::Other => true,
            },
        }
    }

    /// Warns about parameters and points that nothing refers to, once for each declaration.
    fn unused_definitions(&mut self) {
        let used: std::collections::HashSet<Span> =
            self.definitions.iter().filter(|definition| definition.used).map(|definition| definition.span).collect();
        for index in 0..self.definitions.len() {
            let definition = &self.definitions[index];
            // Points and `let`s of a component are offered to the models that place it.
            let is_offered = definition.name.place != Place::SCENE && definition.kind != DefinitionKind::Param;
            if !used.contains(&definition.span) && !is_offered {
                let (span, kind) = (definition.span, definition.kind);
                let name = self.words.text(definition.name.symbol).to_string();
                self.report(Environment::TOP, QuestionError::Unused { span, name, kind });
            }
        }
    }
}
