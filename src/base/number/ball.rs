//! Ball arithmetic: a double-double midpoint and a radius that encloses the true value,
//! |x - mid| <= rad. Every operation adds a rigorous bound of its own rounding (see [`Dd::EPSILON`]),
//! so whatever is computed with balls carries an error bound that holds. Clause: spec.md, "Numbers".
//!
//! A ball of radius zero is exact. Zero times anything finite is exactly zero, and the sum with an exact zero is exact,
//! so that structural zeros stay structural.

use super::dd::Dd;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number known to lie within `rad` of `mid`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    pub mid: Dd,
    /// Absolute radius, not negative; infinite where nothing is known.
    pub rad: f64,
}

/// Inflation that covers the few roundings (at most eight) of a radius computed in binary64.
const UP: f64 = 1.0 + 1.0 / (1u64 << 49) as f64;
/// Covers the loss of a product's low part near the bottom of the exponent range.
const UNDERFLOW: f64 = 1e-318;

/// Bound of the rounding error of a double-double result.
#[inline]
fn rounding(mid: Dd) -> f64 {
    mid.hi.abs() * (2.0 * Dd::EPSILON) + UNDERFLOW
}

impl Ball {
    pub const ZERO: Ball = Ball { mid: Dd::ZERO, rad: 0.0 };
    pub const ONE: Ball = Ball { mid: Dd::ONE, rad: 0.0 };
    pub const PI: Ball = Ball { mid: Dd::PI, rad: 3.0e-32 };
    pub const LN_2: Ball = Ball { mid: Dd::LN_2, rad: 6.0e-33 };

    /// A number known exactly.
    #[inline]
    pub fn exact(mid: Dd) -> Ball {
        Ball { mid, rad: 0.0 }
    }

    #[inline]
    pub fn new(mid: Dd, rad: f64) -> Ball {
        Ball { mid, rad }
    }

    #[inline]
    pub fn is_exact(&self) -> bool {
        self.rad == 0.0
    }

    /// Exactly zero: no value but zero is possible.
    #[inline]
    pub fn is_zero(&self) -> bool {
        self.mid.is_zero() && self.rad == 0.0
    }

    #[inline]
    pub fn is_finite(&self) -> bool {
        self.mid.is_finite() && self.rad.is_finite()
    }

    #[inline]
    pub fn contains_zero(&self) -> bool {
        self.mid.hi.abs() * (1.0 - 1e-15) <= self.rad
    }

    /// Certainly greater than zero.
    #[inline]
    pub fn is_positive(&self) -> bool {
        self.mid.hi > 0.0 && !self.contains_zero()
    }

    /// Certainly less than zero.
    #[inline]
    pub fn is_negative(&self) -> bool {
        self.mid.hi < 0.0 && !self.contains_zero()
    }

    /// An upper bound of |x|.
    #[inline]
    pub fn magnitude(&self) -> f64 {
        (self.mid.hi.abs() + self.rad) * UP
    }

    /// A lower bound of |x|, zero if the ball contains zero.
    #[inline]
    pub fn mignitude(&self) -> f64 {
        ((self.mid.hi.abs() - self.rad) * (2.0 - UP)).max(0.0)
    }

    /// A bound of the relative error of `mid`: rad / mignitude, infinite if the ball contains zero.
    pub fn relative_error(&self) -> f64 {
        if self.rad == 0.0 { 0.0 } else { self.rad / self.mignitude() * UP }
    }

    #[inline]
    pub fn to_f64(&self) -> f64 {
        self.mid.to_f64()
    }

    #[inline]
    pub fn abs(self) -> Ball {
        Ball { mid: self.mid.abs(), rad: self.rad }
    }

    /// The same ball made larger by `by`.
    #[inline]
    pub fn widen(self, by: f64) -> Ball {
        Ball { mid: self.mid, rad: (self.rad + by) * UP }
    }

    /// Square root of a ball that holds no negative number in its midpoint; the part below zero is cut off.
    pub fn sqrt(self) -> Ball {
        if self.is_zero() {
            return Ball::ZERO;
        }
        let root = self.mid.abs().sqrt();
        // |sqrt(x) - sqrt(m)| <= |x - m| / sqrt(m), also where x is cut off at 0; never more than sqrt(|x - m|).
        let spread = if self.rad == 0.0 { 0.0 } else { (self.rad / root.hi).min(self.rad.sqrt()) };
        Ball { mid: root, rad: (spread * UP + rounding(root)) * UP }
    }

    #[inline]
    pub fn square(self) -> Ball {
        self * self
    }
}

impl From<f64> for Ball {
    #[inline]
    fn from(x: f64) -> Ball {
        Ball::exact(Dd::from(x))
    }
}

impl Neg for Ball {
    type Output = Ball;
    #[inline]
    fn neg(self) -> Ball {
        Ball { mid: -self.mid, rad: self.rad }
    }
}

impl Add for Ball {
    type Output = Ball;
    #[inline]
    fn add(self, b: Ball) -> Ball {
        if self.is_zero() {
            return b;
        }
        if b.is_zero() {
            return self;
        }
        let mid = self.mid + b.mid;
        if self.rad == 0.0 && b.rad == 0.0 && mid.is_zero() {
            // AccurateDWPlusDW has relative error at most 3u^2, so a computed zero is a true one.
            return Ball::ZERO;
        }
        Ball { mid, rad: (self.rad + b.rad + rounding(mid)) * UP }
    }
}

impl Sub for Ball {
    type Output = Ball;
    #[inline]
    fn sub(self, b: Ball) -> Ball {
        self + -b
    }
}

impl Mul for Ball {
    type Output = Ball;
    #[inline]
    fn mul(self, b: Ball) -> Ball {
        if self.is_zero() || b.is_zero() {
            return Ball::ZERO;
        }
        let mid = self.mid * b.mid;
        let spread = self.rad * (b.mid.hi.abs() * UP + b.rad) + self.mid.hi.abs() * b.rad * UP;
        Ball { mid, rad: (spread + rounding(mid)) * UP }
    }
}

impl Div for Ball {
    type Output = Ball;
    /// The quotient; a radius of infinity where the divisor contains zero.
    #[inline]
    fn div(self, b: Ball) -> Ball {
        if self.is_zero() && !b.contains_zero() {
            return Ball::ZERO;
        }
        let mid = self.mid / b.mid;
        let low = b.mignitude();
        if low == 0.0 || !mid.is_finite() {
            return Ball { mid: Dd::ZERO, rad: f64::INFINITY };
        }
        // |a/b - m/n| <= (|a - m| + |m/n| |b - n|) / |b|.
        let spread = (self.rad + mid.hi.abs() * UP * b.rad) / low;
        Ball { mid, rad: (spread * UP + rounding(mid)) * UP }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quotient_encloses_the_true_value() {
        let third = Ball::ONE / Ball::from(3.0);
        let back = third * Ball::from(3.0) - Ball::ONE;
        assert!(back.contains_zero());
        assert!(third.relative_error() < 1e-29);
    }

    #[test]
    fn structural_zeros_stay_exact() {
        let x = Ball::PI;
        assert!((x * Ball::ZERO).is_zero());
        assert_eq!(x + Ball::ZERO, x);
        assert!((Ball::from(3.0) - Ball::from(3.0)).is_zero());
    }

    #[test]
    fn dividing_by_a_ball_around_zero_tells_nothing() {
        let q = Ball::ONE / Ball::new(Dd::ZERO, 1.0);
        assert!(q.rad.is_infinite());
    }

    #[test]
    fn the_root_of_an_uncertain_number_covers_its_ends() {
        let x = Ball::new(Dd::from(2.0), 0.5).sqrt();
        for end in [1.5f64, 2.5] {
            assert!((end.sqrt() - x.mid.hi).abs() <= x.rad);
        }
    }
}
