//! What the language has and this version cannot do yet. In: the scene; out: an error for each feature that would change
//! the answer. This list is the only place; a feature that comes is a line that goes.

use super::Check;
use super::error::QuestionError;
use super::scene::{Scene, Signal};
use super::scope::Environment;
use crate::base::Span;

/// What it is called, and where a scene has it first.
type Feature = (&'static str, fn(&Scene) -> Option<Span>);

const NOT_AVAILABLE: [Feature; 5] = [
    ("`couple`", |scene| scene.couples.first().map(|couple| couple.span)),
    ("`solve`", |scene| scene.solves.first().map(|solve| solve.span)),
    ("`require`", |scene| scene.requires.first().map(|require| require.span)),
    ("`rest as drawn`", |scene| scene.rest_as_drawn),
    ("a constant load", constant_load),
];

/// A constant load moves the rest, from which everything is measured.
fn constant_load(scene: &Scene) -> Option<Span> {
    let is_constant = |signal: &Signal| matches!(signal, Signal::Constant { .. });
    scene.inputs.iter().find(|input| input.signal.iter().any(is_constant))?.signal_span
}

impl Check<'_> {
    pub fn features(&mut self) {
        self.walk.varies = false;
        for (what, first) in NOT_AVAILABLE {
            if let Some(span) = first(&self.scene) {
                self.report(Environment::TOP, QuestionError::NotAvailable { span, what });
            }
        }
    }
}
