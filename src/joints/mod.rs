//! Joints, one file per kind: their words, and the degrees of freedom that they leave between the two parts they
//! connect, or the constraint by which they close a loop. See docs/method/kinematics.md.

pub mod kind;
pub mod pivot;
pub mod slide;
pub mod weld;

pub use kind::Kind;

use crate::base::Vec3;

/// Every kind of joint, in the order in which they are listed to users.
pub const KINDS: &[&Kind] = &[&pivot::KIND, &slide::KIND, &weld::KIND];

/// The motion that a joint allows between a part and the part that carries it.
#[derive(Clone, Debug, PartialEq)]
pub struct Relative {
    /// Whether the point of the joint stays fixed on the carrier.
    pub holds_point: bool,
    /// Whether the carried part rotates relative to its carrier.
    pub turns: bool,
    /// The direction in which it slides.
    pub slide: Option<Vec3>,
}

/// The relative motions that a joint prevents if it closes a loop.
#[derive(Clone, Debug, PartialEq)]
pub struct Held {
    pub displacement: Displacement,
    /// Whether it keeps the two parts from turning against each other.
    pub turn: bool,
}

/// The part of the relative displacement of the two ends that a joint prevents.
#[derive(Clone, Debug, PartialEq)]
pub enum Displacement {
    All,
    /// The components perpendicular to this direction, which is fixed to the first part.
    Across(Vec3),
}

impl Kind {
    /// The degrees of freedom that a joint of the tree leaves.
    pub fn freedoms(&self, along: Option<&Vec3>) -> Relative {
        Relative { holds_point: self.turns && !self.slides, turns: self.turns, slide: along.cloned() }
    }

    /// The constraint that a joint imposes if the tree does not need it.
    pub fn constrained_motions(&self, along: Option<&Vec3>) -> Held {
        let displacement = along.map_or(Displacement::All, |along| Displacement::Across(along.clone()));
        Held { displacement, turn: !self.turns }
    }
}
