//! Noise that drives inputs, as plain data in SI units. See docs/method/random.md.

use crate::base::Density;

/// Stationary noise of an input, independent of every other one.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// Index of the input.
    pub input: usize,
    /// Which derivative of the input it is: 0 the input itself, 1 its rate, 2 its acceleration.
    pub derivative: u8,
    /// One-sided.
    pub density: Density,
}
