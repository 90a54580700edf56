//! A part of a scene near its rest, without constraints: the input of the two proofs of its rest, dense
//! ([`enclosure`](super::enclosure)) and sparse ([`convex`](super::convex)).

use super::potential::{Detail, Energy, Potential};
use super::survey::Part;
use crate::base::{Ball, Dd, Number};
use crate::lower::kinematics::{Index, Kinematics, State};

/// A part near its rest.
pub struct Refinement<'a> {
    pub kinematics: &'a Kinematics,
    pub coordinates: &'a [Index],
    pub potential: &'a Potential<Number>,
    pub state: &'a mut State<Number>,
    /// The longest spring or arm of the part, m.
    pub length: f64,
}

impl<'a> Refinement<'a> {
    pub fn new(
        kinematics: &'a Kinematics,
        part: &'a Part,
        length: f64,
        state: &'a mut State<Number>,
    ) -> Refinement<'a> {
        let (coordinates, potential) = (&part.coordinates[..], &part.potential);
        Refinement { kinematics, coordinates, potential, state, length }
    }

    pub fn set(&mut self, coordinate: Index, value: Ball) {
        let value = if value.is_zero() { Number::ZERO } else { Number::Ball(value) };
        self.state.set(self.kinematics, coordinate, value);
    }

    pub fn energy(&self, local: &[u32], n: usize, detail: Detail) -> Energy<Number> {
        self.potential.at(self.kinematics, self.state, local, n, detail)
    }

    /// Puts the moving coordinates at these middles with these radii.
    pub fn place(&mut self, moving: &[Index], middle: &[Dd], radius: impl Fn(usize) -> f64) {
        for (place, coordinate) in moving.iter().enumerate() {
            self.set(*coordinate, Ball::new(middle[place], radius(place)));
        }
    }
}
