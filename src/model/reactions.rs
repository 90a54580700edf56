//! Reactions as motions: `p.fx` of a joint, `r.force` of a coupling, `block.support_y` of a freedom clause. In: a word
//! after the name of a joint, coupling or body. Out: components along the axes of the scene. See spec.md#outputs.

use super::Check;
use super::error::QuestionError;
use super::evaluate::{Evaluated, Stop};
use super::motions::{Combination, Piece};
use super::scene::{BodyId, Freedom, Holder, JointId, Motion, MotionTerm, Part, Reaction};
use super::scope::{self, Environment};
use super::suggestion::nearest;
use crate::base::{Angle, Dimension, Number, Span, Vec3};
use crate::kinds::motions::{COUPLE_REACTIONS, JOINT_REACTIONS, ReactionComponent, SUPPORT_REACTIONS};
use std::sync::Arc;

/// Whether a word after a body asks for a reaction of the ground.
pub fn is_of_support(word: &str) -> bool {
    SUPPORT_REACTIONS.iter().any(|(_, name, _)| *name == word)
}

/// A word and its place.
type Word<'w> = (&'w str, Span);

impl Check<'_> {
    /// Whether the model asks for a load on a joint or the ground. Weights that move nothing then matter.
    pub fn asks_for_reactions(&self) -> bool {
        let is_reaction = |word: &str| {
            let known = JOINT_REACTIONS.iter().chain(&SUPPORT_REACTIONS);
            known.into_iter().any(|(_, name, _)| *name == word)
        };
        self.tree.members().any(|word| is_reaction(self.sources.slice(word)))
    }

    /// `p.fx`
    pub fn joint_reaction(
        &mut self,
        index: u32,
        has_point: bool,
        word: Word,
        environment: Environment,
    ) -> Evaluated<Piece> {
        if self.broken_joints {
            return Err(Stop::Reported);
        }
        let Some(kind) = self.scene.joints.get(index as usize).map(|joint| joint.kind) else {
            return Err(Stop::Reported);
        };
        let found = JOINT_REACTIONS.iter().find(|(_, name, _)| *name == word.0 && !has_point);
        let Some((component, ..)) = found.copied() else {
            let known = JOINT_REACTIONS.iter().map(|(_, name, _)| *name).collect();
            return self.no_reaction(self.noun_of(scope::Part::Joint(index)), known, word, environment);
        };
        if component == ReactionComponent::Moment && kind.turns {
            let name = self.words.display(self.scene.joints[index as usize].name);
            let (why, help) = ("turns freely: it carries no moment", "write `fx` or `fy`, or remove it");
            return self.fail(environment, QuestionError::NoSuchReaction { span: word.1, name, why, help });
        }
        self.reaction_direction(Holder::Joint(JointId(index)), component, environment)
    }

    /// `r.force`
    pub fn couple_reaction(
        &mut self,
        index: u32,
        has_point: bool,
        word: Word,
        environment: Environment,
    ) -> Evaluated<Piece> {
        let [(component, name, _)] = COUPLE_REACTIONS;
        if word.0 != name || has_point {
            return self.no_reaction(self.noun_of(scope::Part::Couple(index)), vec![name], word, environment);
        }
        // Its force does work on the sum that it keeps at zero.
        let relation = self.scene.couples.get(index as usize).map(|couple| couple.dimension);
        let dimension = relation.and_then(|relation| Dimension::TORQUE.per(relation)).ok_or(Stop::Reported)?;
        let reaction = Reaction { holder: Holder::Couple(index), component };
        Ok(combination(vec![(Number::ONE, reaction)], dimension))
    }

    /// `block.support_y`
    pub fn support_reaction(&mut self, body: BodyId, word: Word, environment: Environment) -> Evaluated<Piece> {
        if self.is_broken(Part::Body(body)) {
            return Err(Stop::Reported);
        }
        let Some((component, ..)) = SUPPORT_REACTIONS.iter().find(|(_, name, _)| *name == word.0).copied() else {
            return Err(Stop::Reported);
        };
        let axis = match component {
            ReactionComponent::X => Some(Vec3::X),
            ReactionComponent::Y => Some(Vec3::Y),
            ReactionComponent::Moment | ReactionComponent::Coupling => None,
        };
        let direction = match axis {
            Some(axis) => Some((*self.rotate_to_scene(Arc::new(axis), environment)?).clone()),
            None => None,
        };
        let free = match (&self.scene.bodies[body.index()].freedom, direction) {
            (Freedom::FromJoints, _) => {
                let why = "has no freedom clause: joints hold it";
                return self.no_support(body, why, "ask for the reaction of a joint: `p.fx`", word, environment);
            }
            (Freedom::OnGround { turns, .. }, None) => *turns,
            (Freedom::OnGround { translations, .. }, Some(direction)) => match &translations[..] {
                [] => false,
                [only] => only.direction.cross(&direction).is_zero(),
                _ => true,
            },
        };
        if free {
            let help = "ask for the reaction along a motion that its freedom clause leaves out";
            return self.no_support(
                body,
                "is free to move this way: the ground carries nothing",
                help,
                word,
                environment,
            );
        }
        self.reaction_direction(Holder::Support(body), component, environment)
    }

    fn no_support(
        &mut self,
        body: BodyId,
        why: &'static str,
        help: &'static str,
        word: Word,
        environment: Environment,
    ) -> Evaluated<Piece> {
        let name = self.part_name(Part::Body(body));
        self.fail(environment, QuestionError::NoSuchReaction { span: word.1, name, why, help })
    }

    /// A component in the axes of the part of the model that mentions it, in terms of the components along the axes of
    /// the scene.
    fn reaction_direction(
        &mut self,
        holder: Holder,
        component: ReactionComponent,
        environment: Environment,
    ) -> Evaluated<Piece> {
        let axis = match component {
            ReactionComponent::X => Vec3::X,
            ReactionComponent::Y => Vec3::Y,
            ReactionComponent::Moment | ReactionComponent::Coupling => {
                let sign = Number::from(if self.reverses(environment)? { -1 } else { 1 });
                return Ok(combination(vec![(sign, Reaction { holder, component })], Dimension::TORQUE));
            }
        };
        let direction = self.rotate_to_scene(Arc::new(axis), environment)?;
        let parts = [(direction.x.clone(), ReactionComponent::X), (direction.y.clone(), ReactionComponent::Y)];
        let parts = parts.into_iter().filter(|(factor, _)| !factor.is_zero());
        let terms = parts.map(|(factor, component)| (factor, Reaction { holder, component })).collect();
        Ok(combination(terms, Dimension::FORCE))
    }

    fn no_reaction(
        &mut self,
        of: &'static str,
        known: Vec<&'static str>,
        (word, span): Word,
        environment: Environment,
    ) -> Evaluated<Piece> {
        let suggestion = nearest(word, known.iter().copied());
        self.fail(environment, QuestionError::UnknownMotion { span, word: word.to_string(), of, suggestion, known })
    }
}

fn combination(terms: Vec<(Number, Reaction)>, dimension: Dimension) -> Piece {
    let term = |(coefficient, reaction)| MotionTerm { coefficient, motion: Motion::Reaction(reaction) };
    Piece::Motions(Combination { terms: terms.into_iter().map(term).collect(), dimension, angle: Angle::Plain })
}
