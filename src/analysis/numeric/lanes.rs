//! Eight binary64 numbers that are computed with at once.

use crate::analysis::numeric::dense::Real;
use crate::base::Dd;
use std::ops::{Add, Div, Mul, Sub};

/// What elimination in a tree computes with: one number, or eight problems side by side.
pub trait Lane: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    /// The precision of the tree's numbers.
    type Scalar: Real;
    fn splat(x: Self::Scalar) -> Self;
    /// Self, or a tiny positive part of `scale` (which is positive) if it is smaller than that in magnitude.
    fn away_from_zero(self, scale: Self) -> Self;
}

/// Eight binary64 numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eight(pub [f64; 8]);

impl Eight {
    /// How many of two numbers are positive, lane by lane.
    #[inline]
    pub fn count_positive(self, counts: &mut [i64; 8]) {
        for (count, x) in counts.iter_mut().zip(self.0) {
            *count += i64::from(x > 0.0);
        }
    }
}

#[inline]
fn each(a: Eight, b: Eight, f: impl Fn(f64, f64) -> f64) -> Eight {
    Eight(std::array::from_fn(|lane| f(a.0[lane], b.0[lane])))
}

impl Add for Eight {
    type Output = Eight;
    #[inline]
    fn add(self, b: Eight) -> Eight {
        each(self, b, |x, y| x + y)
    }
}

impl Sub for Eight {
    type Output = Eight;
    #[inline]
    fn sub(self, b: Eight) -> Eight {
        each(self, b, |x, y| x - y)
    }
}

impl Mul for Eight {
    type Output = Eight;
    #[inline]
    fn mul(self, b: Eight) -> Eight {
        each(self, b, |x, y| x * y)
    }
}

impl Div for Eight {
    type Output = Eight;
    #[inline]
    fn div(self, b: Eight) -> Eight {
        each(self, b, |x, y| x / y)
    }
}

/// A part of a number that its last bit does not see.
const TINY: f64 = Dd::EPSILON / 16.0;

impl Lane for Eight {
    type Scalar = f64;

    #[inline]
    fn splat(x: f64) -> Eight {
        Eight([x; 8])
    }

    #[inline]
    fn away_from_zero(self, scale: Eight) -> Eight {
        each(self, scale, |x, s| if x.abs() < TINY * s { TINY * s } else { x })
    }
}

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
