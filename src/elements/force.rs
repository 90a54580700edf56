//! Loads that stay as they are while the scene moves. See docs/method/linearisation.md.
//!
//! - a dead force F on a point u: V = -F . u, so grad^2 V = -F . grad^2 u (weight is one: F = m g)
//! - a pull P between two points: V = P e of their stretch e: a spring of preload P without stiffness.
//!   A force that drives two points apart is a negative pull.

use super::{Scalar, Spring, Stretch, Vector};

/// A force of fixed size and direction.
#[derive(Clone, Debug)]
pub struct DeadForce<S> {
    pub force: Vector<S>,
}

impl<S: Scalar> DeadForce<S> {
    pub fn energy(&self, displacement: &Vector<S>) -> S {
        self.force.dot(displacement).negated()
    }
}

/// A pull of fixed size between two ends (or a fixed torque, where the stretch is a turn).
#[derive(Clone, Debug)]
pub struct Pull<S> {
    pub stretch: Stretch<S>,
    pub pull: S,
}

impl<S: Scalar> Pull<S> {
    pub fn spring(&self) -> Spring<S> {
        Spring { stretch: self.stretch.clone(), stiffness: S::zero(), preload: self.pull.clone() }
    }
}
