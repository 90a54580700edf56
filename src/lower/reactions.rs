//! The forces and moments by which joints, couplings and supports hold parts. In: a mechanism at its rest and reactions.
//! Out: each as a row over the motions of the scene, and at rest; or why the scene does not determine it.
//! See docs/method/linearisation.md#reactions.

use super::Lowered;
use super::assembly::{self, Carried, Tensions};
use super::constraints::Constraints;
use super::error::LowerError;
use super::kinematics::Unreleased;
use super::mechanism::Mechanism;
use super::rest::{Held, Slack};
use crate::base::Span;
use crate::model::scene::{Damping, Motion, MotionTerm, Output, Reaction, Scene};

/// The parts of a rest that reactions depend on, beside the state.
#[derive(Clone, Debug, Default)]
pub struct Holding {
    pub constraints: Constraints,
    /// The tensions found for `rest as drawn`.
    pub held: Option<Held>,
    pub slack: Slack,
}

/// The reason why a reaction has no value.
#[derive(Clone, Debug, PartialEq)]
pub enum Open {
    Unreleased(Unreleased),
    /// Modal damping does not say where its forces act.
    DampedByModes,
    /// Damping by masses is relative to what follows a base, which is found for the whole scene alone.
    DampedRelative,
    /// Reactions to forces of springs with a loss factor are not computed.
    Lossy,
}

/// The reactions among some terms, each once, ascending.
fn reactions_in<'a>(terms: impl IntoIterator<Item = &'a MotionTerm>) -> Vec<Reaction> {
    let reaction = |term: &MotionTerm| if let Motion::Reaction(reaction) = term.motion { Some(reaction) } else { None };
    let mut reactions: Vec<Reaction> = terms.into_iter().filter_map(reaction).collect();
    reactions.sort_unstable();
    reactions.dedup();
    reactions
}

/// The reactions that some terms ask for.
pub struct Reactions {
    asked: Vec<Reaction>,
    carried: Vec<Carried>,
}

impl Reactions {
    fn of(&self, reaction: &Reaction) -> Option<&Carried> {
        Some(&self.carried[self.asked.binary_search(reaction).ok()?])
    }
}

impl Mechanism {
    /// The reactions among some terms that are asked for at `span`.
    pub fn reactions<'a>(
        &self,
        scene: &Scene,
        terms: impl IntoIterator<Item = &'a MotionTerm>,
        span: Span,
    ) -> Result<Reactions, LowerError> {
        let asked = reactions_in(terms);
        if asked.is_empty() {
            return Ok(Reactions { asked, carried: Vec::new() });
        }
        let found = self.reactions_at_rest(scene, &asked);
        let carried = found.map_err(|(number, why)| open(scene, &asked[number], Open::Unreleased(why), span))?;
        Ok(Reactions { asked, carried })
    }

    fn reactions_at_rest(&self, scene: &Scene, asked: &[Reaction]) -> Result<Vec<Carried>, (usize, Unreleased)> {
        let Holding { constraints, held, slack } = &self.holding;
        let released = self.kinematics.release_motions(scene, asked)?;
        let state = released.state(&self.state);
        let (constraints, reduction) = constraints.with_released(scene, &released, (asked, &self.reduction), &state)?;
        let tensions = Tensions { held: held.as_ref(), slack };
        Ok(assembly::released_reactions(scene, &released, (&constraints, &reduction), &state, tensions))
    }
}

impl Reactions {
    /// The value of a reaction at rest, N or N m.
    pub fn at_rest(&self, reaction: &Reaction) -> Option<&crate::base::Number> {
        self.of(reaction).map(|carried| &carried.at_rest)
    }
}

impl Lowered {
    /// Adds the reactions among the terms of outputs to the system's outputs from number `first` on, which have all else.
    pub(super) fn carry(&mut self, scene: &Scene, outputs: &[Output], first: usize) -> Result<(), LowerError> {
        for (number, output) in outputs.iter().enumerate() {
            let mut reactions = self.mechanism.reactions(scene, &output.terms, output.span)?;
            if self.system.losses.is_some() && !reactions.asked.is_empty() {
                return Err(open(scene, &reactions.asked[0], Open::Lossy, output.span));
            }
            match &scene.damping {
                Some(Damping::Modal { ratio, .. }) if !ratio.is_zero() && !reactions.asked.is_empty() => {
                    return Err(open(scene, &reactions.asked[0], Open::DampedByModes, output.span));
                }
                Some(Damping::Rayleigh { alpha, beta, .. }) => {
                    let is_base = |input: u32| scene.inputs[input as usize].kind.base().is_some();
                    if !alpha.is_zero() && (0..scene.inputs.len() as u32).any(is_base) && !reactions.asked.is_empty() {
                        return Err(open(scene, &reactions.asked[0], Open::DampedRelative, output.span));
                    }
                    reactions.carried.iter_mut().for_each(|carried| carried.damp(alpha, beta, is_base));
                }
                Some(Damping::Modal { .. }) | None => {}
            }
            for term in &output.terms {
                if let Motion::Reaction(reaction) = &term.motion
                    && let Some(carried) = reactions.of(reaction)
                {
                    carried.add_to(&mut self.system.outputs[first + number], &output.coefficient(term));
                }
            }
        }
        Ok(())
    }
}

fn open(scene: &Scene, reaction: &Reaction, why: Open, span: Span) -> LowerError {
    let name = scene.words.display(reaction.holder.name(scene));
    LowerError::Reaction { name, holder: reaction.holder.span(scene), span, why }
}
