//! Numbers of several modes side by side: one walk through a tree serves them all.

use crate::analysis::numeric::dense::Real;
use std::ops::{Add, Mul, Sub};

/// One number of each of several modes. Written as loops over places, which become vectors of the machine.
#[derive(Clone, Copy, Debug)]
pub struct Beside<T, const W: usize>(pub [T; W]);

impl<T: Real, const W: usize> Beside<T, W> {
    #[inline(always)]
    pub fn all(x: T) -> Self {
        Beside([x; W])
    }

    /// Each leading word without its sign.
    #[inline(always)]
    pub fn sizes(self) -> Beside<f64, W> {
        let mut sizes = Beside([0.0; W]);
        for lane in 0..W {
            sizes.0[lane] = self.0[lane].hi().abs();
        }
        sizes
    }
}

impl<T: Real, const W: usize> Add for Beside<T, W> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        for lane in 0..W {
            self.0[lane] = self.0[lane] + other.0[lane];
        }
        self
    }
}

impl<T: Real, const W: usize> Sub for Beside<T, W> {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        for lane in 0..W {
            self.0[lane] = self.0[lane] - other.0[lane];
        }
        self
    }
}

impl<T: Real, const W: usize> Mul for Beside<T, W> {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, other: Self) -> Self {
        for lane in 0..W {
            self.0[lane] = self.0[lane] * other.0[lane];
        }
        self
    }
}

impl<T: Real, const W: usize> Mul<T> for Beside<T, W> {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, factor: T) -> Self {
        for lane in 0..W {
            self.0[lane] = self.0[lane] * factor;
        }
        self
    }
}
