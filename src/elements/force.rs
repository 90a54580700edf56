//! Loads that stay constant while the scene moves. See docs/method/linearisation.md.
//!
//! - a dead force F on a point u: V = -F . u, so grad^2 V = -F . grad^2 u (weight is one: F = m g)
//! - a pull P between two points with stretch e: V = P e, as of a spring with preload P and no stiffness.
//!   A force that drives two points apart is a negative pull.

use super::{Response, Scalar, Spring, Stretch, Vector};

/// A force of fixed size and direction.
#[derive(Clone, Debug)]
pub struct DeadForce<S> {
    pub force: Vector<S>,
}

impl<S: Scalar> DeadForce<S> {
    pub fn energy(&self, displacement: &Vector<S>) -> S {
        self.force.dot(displacement).negate()
    }
}

/// A pull of fixed size between two ends (a fixed torque if the stretch is a rotation).
#[derive(Clone, Debug)]
pub struct Pull<S> {
    pub stretch: Stretch<S>,
    pub pull: S,
}

impl<S: Scalar> Pull<S> {
    pub fn spring(&self) -> Spring<S> {
        let response = Response::Linear { stiffness: S::zero(), preload: self.pull.clone() };
        Spring { stretch: self.stretch.clone(), response }
    }
}
