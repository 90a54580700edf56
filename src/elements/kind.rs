//! What a kind of element is: its words, its fields and its law. See spec.md and docs/method/linearisation.md.
//!
//! An element lies between two ends and feels their stretch e. Its force is its coefficient times a derivative of e, and a
//! spring's tension as drawn besides. So the law is one number, the order of that derivative: an element of order p adds
//! coefficient (grad e)(grad e)^T to K (p = 0), C (p = 1) or M (p = 2), the prescribed motions of its ends to the input
//! columns of the same order, and the p-th derivative of its stretch to outputs of its force. All of it is linear in the
//! coefficient, which is what derivatives with respect to parameters use.

use crate::base::{Code, Field, Takes};

/// A kind of element.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    pub keyword: &'static str,
    /// With its article: "a spring".
    pub noun: &'static str,
    pub plural: &'static str,
    /// A declaration as it is written.
    pub form: &'static str,
    /// More of them, one a line.
    pub forms: &'static str,
    /// What it declares, in one sentence.
    pub summary: &'static str,
    /// Its rules, as Markdown paragraphs.
    pub rules: &'static str,
    /// The heading of `spec.md` with the whole story.
    pub heading: &'static str,
    /// What other programs and textbooks call it.
    pub synonyms: &'static [&'static str],
    /// Its coefficient first, then what else it takes.
    pub fields: &'static [Field],
    /// The units that its coefficient is shown in: along a line, on the rotation.
    pub units: [&'static str; 2],
    pub order: Order,
    pub negative: Negative,
}

/// The derivative of the stretch that an element's force is proportional to, and the matrix that this makes it part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// K
    Displacement = 0,
    /// C
    Velocity = 1,
    /// M
    Acceleration = 2,
}

/// What is said of a coefficient below zero.
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

    /// Whether it holds its ends where they are: it has a tension at rest, and stores strain energy.
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
