//! Motions: the quantities that may follow a part and a dot. See spec.md#outputs.

use crate::base::{Dimension, Expected, Field};

/// A motion of a body, a base, or a point of one.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    pub name: &'static str,
    pub direction: Direction,
    /// 0 for a displacement, 1 for a velocity, 2 for an acceleration.
    pub derivative: u8,
    pub dimension: Dimension,
    pub meaning: &'static str,
}

/// The direction in which a motion is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    X,
    Y,
    /// A rotation, which has no direction.
    Turn,
}

const fn motion(
    name: &'static str,
    direction: Direction,
    derivative: u8,
    dimension: Dimension,
    meaning: &'static str,
) -> Motion {
    Motion { name, direction, derivative, dimension, meaning }
}

/// The motions of a body.
pub const BODY_MOTIONS: [Motion; 9] = [
    motion("x", Direction::X, 0, Dimension::LENGTH, "Displacement along x from rest, m."),
    motion("y", Direction::Y, 0, Dimension::LENGTH, "Displacement along y from rest, m."),
    motion("angle", Direction::Turn, 0, Dimension::NONE, "Rotation from rest, rad, counter-clockwise."),
    motion("vx", Direction::X, 1, Dimension::VELOCITY, "Velocity along x, m/s."),
    motion("vy", Direction::Y, 1, Dimension::VELOCITY, "Velocity along y, m/s."),
    motion("omega", Direction::Turn, 1, Dimension::ANGULAR_VELOCITY, "Angular velocity, rad/s."),
    motion("ax", Direction::X, 2, Dimension::ACCELERATION, "Acceleration along x, m/s^2."),
    motion("ay", Direction::Y, 2, Dimension::ACCELERATION, "Acceleration along y, m/s^2."),
    motion("alpha", Direction::Turn, 2, Dimension::ANGULAR_ACCELERATION, "Angular acceleration, rad/s^2."),
];

/// The words for the velocity and the acceleration of a base along its own direction, which has no axis.
const ALONG_RATES: [&str; 2] = ["v", "a"];

/// The word for the velocity (1) or the acceleration (2) of a motion of a base: `ax` of `x`.
pub fn rate_of(motion: &str, derivative: u8) -> Option<&'static str> {
    if motion == "along" {
        return ALONG_RATES.get(usize::from(derivative).checked_sub(1)?).copied();
    }
    let direction = BODY_MOTIONS.iter().find(|known| known.name == motion)?.direction;
    let is_rate = |known: &&Motion| known.direction == direction && known.derivative == derivative;
    BODY_MOTIONS.iter().find(is_rate).map(|rate| rate.name)
}

/// The motion of a base of which a word is the velocity or the acceleration, and which of the two: `ax` is 2 of `x`.
pub fn motion_of_rate(word: &str) -> Option<(&'static str, u8)> {
    let motions = ["x", "y", "angle", "along"];
    let all = motions.into_iter().flat_map(|motion| [(motion, 1), (motion, 2)]);
    all.into_iter().find(|(motion, derivative)| rate_of(motion, *derivative) == Some(word))
}

/// A quantity of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementMotion {
    Force,
    Stretch,
}

/// The quantities of an element, with their names and meanings.
pub const ELEMENT_MOTIONS: [(ElementMotion, &str, &str); 2] = [
    (
        ElementMotion::Force,
        "force",
        "The change of a spring's tension from rest (pull positive); the force of another element. N or N*m.",
    ),
    (ElementMotion::Stretch, "stretch", "The change of its stretch from rest, m or rad."),
];

/// A component of the load on a joint, a coupling or a support.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ReactionComponent {
    X,
    Y,
    Moment,
    /// The whole force or torque of a coupling.
    Coupling,
}

/// The reactions of a joint, with their names and meanings.
pub const JOINT_REACTIONS: [(ReactionComponent, &str, &str); 3] = [
    (ReactionComponent::X, "fx", "The force of the joint on its second part along x: its change from rest, N."),
    (ReactionComponent::Y, "fy", "The force of the joint on its second part along y: its change from rest, N."),
    (
        ReactionComponent::Moment,
        "moment",
        "The moment of a slide or weld on its second part, about the joint's place: its change from rest, N*m.",
    ),
];

/// The reaction of a coupling.
pub const COUPLE_REACTIONS: [(ReactionComponent, &str, &str); 1] = [(
    ReactionComponent::Coupling,
    "force",
    "The force or torque of a coupling, which does work on its left side minus its right side: its change from rest.",
)];

/// The reactions of the support that a body's freedom clause represents.
pub const SUPPORT_REACTIONS: [(ReactionComponent, &str, &str); 3] = [
    (
        ReactionComponent::X,
        "support_x",
        "The force along x by which the ground guides the body: its change from rest, N.",
    ),
    (
        ReactionComponent::Y,
        "support_y",
        "The force along y by which the ground guides the body: its change from rest, N.",
    ),
    (
        ReactionComponent::Moment,
        "support_moment",
        "The moment by which the ground keeps the body from turning, about its own place: its change from rest, N*m.",
    ),
];

/// The reactions of joints, couplings and supports, with their names and meanings.
pub fn reactions() -> impl Iterator<Item = (&'static str, &'static str)> {
    let all = JOINT_REACTIONS.iter().chain(&COUPLE_REACTIONS).chain(&SUPPORT_REACTIONS);
    all.map(|(_, name, meaning)| (*name, *meaning))
}

/// Whether a word names a motion of a body, a quantity of an element or a reaction. No part of a component can have
/// such a name.
pub fn is_motion(word: &str) -> bool {
    BODY_MOTIONS.iter().any(|motion| motion.name == word)
        || ELEMENT_MOTIONS.iter().any(|(_, name, _)| *name == word)
        || reactions().any(|(name, _)| name == word)
}

/// The initial motions that an `initial` may give, measured from rest.
pub const INITIAL_FIELDS: [Field; 6] = [
    Field::number(
        "x",
        Expected::new("a displacement", Dimension::LENGTH, "x = 16 mm"),
        "Displacement along x at t = 0, from rest.",
    ),
    Field::number(
        "y",
        Expected::new("a displacement", Dimension::LENGTH, "y = 16 mm"),
        "Displacement along y at t = 0, from rest.",
    ),
    Field::number(
        "angle",
        Expected::new("an angle", Dimension::NONE, "angle = 2 deg"),
        "Rotation at t = 0, from rest; counter-clockwise.",
    ),
    Field::number(
        "vx",
        Expected::new("a velocity", Dimension::VELOCITY, "vx = 0.375 m/s"),
        "Velocity along x at t = 0.",
    ),
    Field::number(
        "vy",
        Expected::new("a velocity", Dimension::VELOCITY, "vy = 0.375 m/s"),
        "Velocity along y at t = 0.",
    ),
    Field::number(
        "omega",
        Expected::new("an angular velocity", Dimension::ANGULAR_VELOCITY, "omega = 2 rad/s"),
        "Angular velocity at t = 0.",
    ),
];
