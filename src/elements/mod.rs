//! Elements, one file per kind: their contributions to energy, dissipation and load, with first and second derivatives.
//! See docs/method/linearisation.md.
//!
//! An element depends only on the relative displacement of its two ends; `lower::kinematics` computes how the ends move
//! with the coordinates. The formulas are written once, for binary64 (the search for the rest) and for
//! [`Number`](crate::base::Number) (the matrices): see [`Scalar`].

pub mod belt;
pub mod curve;
pub mod damper;
#[cfg(test)]
mod dummy;
pub mod force;
pub mod inerter;
pub mod kind;
pub mod scalar;
pub mod spring;
pub mod stretch;
pub mod vector;

pub use curve::Curve;
pub use force::{DeadForce, Pull};
pub use kind::{Acts, Kind, Negative, Order};
pub use scalar::Scalar;
pub use spring::{Response, Spring};
pub use stretch::{Stretch, Stretched};
pub use vector::Vector;

/// Every kind of element, in the order in which they are listed to users.
pub const KINDS: &[&Kind] = &[
    &spring::KIND,
    &damper::KIND,
    &inerter::KIND,
    &belt::KIND,
    #[cfg(test)]
    &dummy::KIND,
];

/// A signed square `weight (direction . delta)^2` of a second derivative, of a relative displacement delta.
#[derive(Clone, Debug)]
pub struct Square<S> {
    pub weight: S,
    pub direction: Vector<S>,
}
