//! Noise that drives inputs, as plain data in SI units. See docs/method/random.md.

use crate::base::{Density, Number};

/// Stationary noise, independent of every other one.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// Indices of the inputs that it drives, and how much later it reaches each, s.
    pub inputs: Vec<(usize, Number)>,
    /// The derivative of the inputs that the noise is: 0 the inputs themselves, 1 their rates, 2 their accelerations.
    pub derivative: u8,
    /// One-sided density.
    pub density: Density,
}
