//! What elimination in a tree computes with, in either precision.

use crate::analysis::numeric::dense::Real;
use crate::base::Dd;
use std::ops::{Add, Div, Mul, Sub};

/// A number that is kept away from zero where it divides.
pub trait Lane: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    /// The precision of the tree's numbers.
    type Scalar: Real;
    fn splat(x: Self::Scalar) -> Self;
    /// Self, or a tiny positive part of `scale` (which is positive) if it is smaller than that in magnitude.
    fn away_from_zero(self, scale: Self) -> Self;
}

/// A part of a number that its last bit does not see.
pub const TINY: f64 = Dd::EPSILON / 16.0;

impl Lane for f64 {
    type Scalar = f64;

    #[inline]
    fn splat(x: f64) -> f64 {
        x
    }

    #[inline]
    fn away_from_zero(self, scale: f64) -> f64 {
        if self.abs() < TINY * scale { TINY * scale } else { self }
    }
}

impl Lane for Dd {
    type Scalar = Dd;

    #[inline]
    fn splat(x: Dd) -> Dd {
        x
    }

    #[inline]
    fn away_from_zero(self, scale: Dd) -> Dd {
        let least = scale * (TINY * TINY);
        if self.abs() < least { least } else { self }
    }
}
