//! Traits for the operations that generic algorithms need. [`Real`]: f64, [`Dd`], [`Ball`] and
//! [`Precise`](crate::kernel::triple::Precise), whose constants and sums make complex numbers. [`Float`]: f64 and
//! [`Dd`], which also have an order and roots. [`Scalar`]: the real and complex numbers used in elimination.

use crate::base::{Ball, Dd};
use crate::kernel::simd::simd;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number with sums and products.
pub trait Real:
    Copy + PartialEq + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    const ZERO: Self;
    const ONE: Self;
    /// The number nearest to x.
    fn of_dd(x: Dd) -> Self;
    /// The nearest binary64 number, within an ulp: the leading word, or that of the midpoint.
    fn to_f64(self) -> f64;
}

/// A number with an order, quotients and roots, each rounded within [`Float::ERROR`].
pub trait Float: Real + PartialOrd + Div<Output = Self> {
    /// Relative error bound of a sum, product or quotient.
    const ERROR: f64;
    /// Without rounding.
    fn to_dd(self) -> Dd;
    fn sqrt(self) -> Self;
    /// a . b
    fn dot(a: &[Self], b: &[Self]) -> Self;
}

/// A number used in elimination. It has no error bound: results are starting values, or are checked afterwards.
pub trait Scalar: Copy + PartialEq + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    const ZERO: Self;
    const ONE: Self;
    fn of_f64(x: f64) -> Self;
    fn recip(self) -> Self;
    /// The modulus within a factor of two, used to choose pivots.
    fn size(self) -> f64;

    /// x_i <- x_i - f_i y
    #[inline]
    fn subtract_products(x: &mut [Self], f: &[Self], y: Self) {
        for (x, &f) in x.iter_mut().zip(f) {
            *x = *x - f * y;
        }
    }
}

impl Real for f64 {
    const ZERO: f64 = 0.0;
    const ONE: f64 = 1.0;

    #[inline]
    fn of_dd(x: Dd) -> f64 {
        x.to_f64()
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self
    }
}

impl Real for Dd {
    const ZERO: Dd = Dd::ZERO;
    const ONE: Dd = Dd::ONE;

    #[inline]
    fn of_dd(x: Dd) -> Dd {
        x
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self.hi
    }
}

impl Real for Ball {
    const ZERO: Ball = Ball::ZERO;
    const ONE: Ball = Ball::ONE;

    #[inline]
    fn of_dd(x: Dd) -> Ball {
        Ball::exact(x)
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self.mid.hi
    }
}

impl Float for f64 {
    const ERROR: f64 = f64::EPSILON / 2.0;

    #[inline]
    fn to_dd(self) -> Dd {
        Dd::from(self)
    }

    #[inline]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }

    /// The dot product, in four interleaved sums whose order is the same on every machine.
    #[inline]
    fn dot(a: &[f64], b: &[f64]) -> f64 {
        let mut sums = [0.0; 4];
        let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
        let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(x, y)| x * y).sum();
        for (x, y) in a4.zip(b4) {
            for lane in 0..4 {
                sums[lane] += x[lane] * y[lane];
            }
        }
        ((sums[0] + sums[1]) + (sums[2] + sums[3])) + rest
    }
}

impl Float for Dd {
    const ERROR: f64 = Dd::EPSILON;

    #[inline]
    fn to_dd(self) -> Dd {
        self
    }

    #[inline]
    fn sqrt(self) -> Dd {
        Dd::sqrt(self)
    }

    #[inline]
    fn dot(a: &[Dd], b: &[Dd]) -> Dd {
        dot(a, b)
    }
}

impl Scalar for f64 {
    const ZERO: f64 = 0.0;
    const ONE: f64 = 1.0;

    fn of_f64(x: f64) -> f64 {
        x
    }

    #[inline]
    fn recip(self) -> f64 {
        1.0 / self
    }

    #[inline]
    fn size(self) -> f64 {
        self.abs()
    }
}

impl Scalar for Dd {
    const ZERO: Dd = Dd::ZERO;
    const ONE: Dd = Dd::ONE;

    fn of_f64(x: f64) -> Dd {
        Dd::from(x)
    }

    #[inline]
    fn recip(self) -> Dd {
        Dd::recip(self)
    }

    #[inline]
    fn size(self) -> f64 {
        self.hi.abs()
    }

    fn subtract_products(x: &mut [Dd], f: &[Dd], y: Dd) {
        subtract_double_products(x, f, y);
    }
}

simd! {
    /// x_i <- x_i - f_i y
    fn subtract_double_products(x: &mut [Dd], f: &[Dd], y: Dd) {
        for (x, &f) in x.iter_mut().zip(f) {
            *x -= f * y;
        }
    }
}

simd! {
    /// a . b
    pub fn dot(a: &[Dd], b: &[Dd]) -> Dd {
        a.iter().zip(b).fold(Dd::ZERO, |sum, (&x, &y)| sum + x * y)
    }
}
