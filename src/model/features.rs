//! What the language has and this version cannot do yet. In: the scene; out: an error for each feature that would change
//! the answer. This list is the only place; a feature that comes is a line that goes.

use super::Check;
use super::error::QuestionError;
use super::scene::Scene;
use super::scope::Environment;
use crate::base::Span;

/// What it is called, and where a scene has it first.
type Feature = (&'static str, fn(&Scene) -> Option<Span>);

const NOT_AVAILABLE: [Feature; 2] = [
    ("`solve`", |scene| scene.solves.first().map(|solve| solve.span)),
    ("`require`", |scene| scene.requires.first().map(|require| require.span)),
];

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
