//! The description of a kind of element: its words, its fields and its law. See spec.md and docs/method/linearisation.md.
//!
//! An element connects two ends and acts on their stretch e. Its force is its coefficient times a derivative of e, plus,
//! for a spring, its tension as drawn. So the law is one number, the order of that derivative: an element of order p adds
//! coefficient (grad e)(grad e)^T to K (p = 0), C (p = 1) or M (p = 2), the prescribed motions of its ends to the input
//! columns of the same order, and the p-th derivative of its stretch to outputs of its force. All of it is linear in the
//! coefficient; derivatives with respect to parameters rely on this.

use crate::base::{Code, Field, Manual, Takes};

/// A kind of element.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    pub keyword: &'static str,
    /// The noun with its article: "a spring".
    pub noun: &'static str,
    pub plural: &'static str,
    /// An example of a declaration.
    pub form: &'static str,
    pub manual: Manual,
    /// Its names in other programs and textbooks.
    pub synonyms: &'static [&'static str],
    /// The coefficient first, then the other fields.
    pub fields: &'static [Field],
    /// Units in which the coefficient is shown: translational, torsional.
    pub units: [&'static str; 2],
    pub order: Order,
    pub negative: Negative,
    pub acts: Acts,
}

/// The ends between which an element's stretch is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acts {
    /// Two points, directions or angles.
    BetweenEnds,
    /// Along both common tangents of two disks.
    RoundDisks,
}

/// The order of the derivative of the stretch that an element's force is proportional to, which decides the matrix that
/// the element adds to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// K
    Displacement = 0,
    /// C
    Velocity = 1,
    /// M
    Acceleration = 2,
}

/// The reaction to a negative coefficient.
#[derive(Clone, Copy, Debug)]
pub enum Negative {
    Noted(Code, &'static str),
    Refused,
}

impl Kind {
    /// The field that holds the coefficient.
    pub const fn coefficient(&self) -> &'static Field {
        &self.fields[0]
    }

    /// Whether it has a tension at rest and stores strain energy.
    pub fn is_elastic(&self) -> bool {
        self.order == Order::Displacement
    }

    /// The unit of the coefficient.
    pub fn unit(&self, torsional: bool) -> &'static str {
        self.units[usize::from(torsional)]
    }
}

impl PartialEq for Kind {
    /// Each keyword has one kind.
    fn eq(&self, other: &Kind) -> bool {
        self.keyword == other.keyword
    }
}

/// The field that gives an element a fixed direction.
pub const ALONG: Field = Field::new("along", Takes::Direction, "along = x", "The fixed direction in which it acts.");
