//! One file a kind of joint: its words, the freedoms it leaves between the two parts it ties, or the constraint it closes.
//! See docs/method/kinematics.md.

pub mod kind;
pub mod pivot;
pub mod slide;
pub mod weld;

pub use kind::Kind;

use crate::base::Vec3;

/// Every kind of joint, in the order in which they are listed to people.
pub const KINDS: &[&Kind] = &[&pivot::KIND, &slide::KIND, &weld::KIND];

/// What a joint leaves free between a part and the part that carries it.
#[derive(Clone, Debug, PartialEq)]
pub struct Relative {
    /// Whether the carried part keeps one point, that of the joint, on its carrier.
    pub holds_point: bool,
    /// Whether the carried part turns on its own.
    pub turns: bool,
    /// The direction in which it slides.
    pub slide: Option<Vec3>,
}

/// What a joint that closes a loop holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Held {
    pub displacement: Displacement,
    /// Whether it keeps the two parts from turning against each other.
    pub turn: bool,
}

/// How much of the relative displacement of the two ends a joint holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Displacement {
    All,
    /// What is across this direction, which is fixed to the first part.
    Across(Vec3),
}

impl Kind {
    /// The freedoms that a joint of the tree leaves.
    pub fn freedoms(&self, along: Option<&Vec3>) -> Relative {
        Relative { holds_point: self.turns && !self.slides, turns: self.turns, slide: along.cloned() }
    }

    /// The constraint that a joint is where the tree does not need it.
    pub fn held(&self, along: Option<&Vec3>) -> Held {
        let displacement = along.map_or(Displacement::All, |along| Displacement::Across(along.clone()));
        Held { displacement, turn: !self.turns }
    }
}
