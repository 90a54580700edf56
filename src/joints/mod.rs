//! One file a kind of joint: the freedoms it leaves between the two parts it ties, or the constraint it closes.
//! See docs/method/kinematics.md.

pub mod pivot;
pub mod slide;
pub mod weld;

use crate::base::Vec3;
use crate::model::scene::JointKind;

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

/// The freedoms that a joint of the tree leaves.
pub fn freedoms(kind: &JointKind) -> Relative {
    match kind {
        JointKind::Pivot { .. } => pivot::freedoms(),
        JointKind::Slide { along } => slide::freedoms(along),
        JointKind::Weld => weld::freedoms(),
    }
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

/// The constraint that a joint is where the tree does not need it.
pub fn held(kind: &JointKind) -> Held {
    match kind {
        JointKind::Pivot { .. } => pivot::held(),
        JointKind::Slide { along } => slide::held(along),
        JointKind::Weld => weld::held(),
    }
}
