//! Numbers of several modes in parallel lanes, so that one traversal of a tree serves all of them.

use crate::kernel::real::Float;
use std::ops::{Add, Mul, Sub};

/// One number for each of several modes. The loops over lanes compile to vector instructions.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<T, const W: usize>(pub [T; W]);

impl<T: Float, const W: usize> Lanes<T, W> {
    #[inline(always)]
    pub fn all(x: T) -> Self {
        Lanes([x; W])
    }

    /// The magnitude of each leading word.
    #[inline(always)]
    pub fn sizes(self) -> Lanes<f64, W> {
        let mut sizes = Lanes([0.0; W]);
        for lane in 0..W {
            sizes.0[lane] = self.0[lane].to_f64().abs();
        }
        sizes
    }
}

impl<T: Float, const W: usize> Add for Lanes<T, W> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        for lane in 0..W {
            self.0[lane] = self.0[lane] + other.0[lane];
        }
        self
    }
}

impl<T: Float, const W: usize> Sub for Lanes<T, W> {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        for lane in 0..W {
            self.0[lane] = self.0[lane] - other.0[lane];
        }
        self
    }
}

impl<T: Float, const W: usize> Mul for Lanes<T, W> {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, other: Self) -> Self {
        for lane in 0..W {
            self.0[lane] = self.0[lane] * other.0[lane];
        }
        self
    }
}

impl<T: Float, const W: usize> Mul<T> for Lanes<T, W> {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, factor: T) -> Self {
        for lane in 0..W {
            self.0[lane] = self.0[lane] * factor;
        }
        self
    }
}
