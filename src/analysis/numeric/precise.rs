//! Arithmetic on triple words with their radius: the ball arithmetic of some 150 bits in which residuals of poles are
//! evaluated. Every operation adds the bound of its own rounding (see [`Triple::ERROR`]); zero is exact and stays so.

use crate::analysis::numeric::complex::Real;
use crate::analysis::numeric::triple::{Precise, Triple};
use crate::base::Dd;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Covers the roundings of a radius, and what a word of lower order may lose of a leading one.
const UP: f64 = 1.0 + 1.0 / (1u64 << 40) as f64;
const UNDERFLOW: f64 = Triple::UNDERFLOW;

impl Precise {
    pub const ZERO: Precise = Precise { value: Triple::ZERO, radius: 0.0 };
    pub const ONE: Precise = Precise { value: Triple::ONE, radius: 0.0 };

    #[inline]
    pub fn is_zero(&self) -> bool {
        self.value.is_zero() && self.radius == 0.0
    }

    /// Square root of what is positive; the part below zero is cut off.
    pub fn sqrt(self) -> Precise {
        if self.is_zero() {
            return Precise::ZERO;
        }
        // r + (x - r^2) / 2r for the root r in double-double: r^2 and the difference err by ERROR x each, what Newton's step
        // leaves is below 2^-200.
        let root = self.value.dd().abs().sqrt();
        let words = Triple::from(root);
        let rest = self.value - words * words;
        let value = words + Triple::from(rest.hi() / (2.0 * root.hi));
        // |sqrt(x) - sqrt(m)| <= |x - m| / sqrt(m), also where x is cut off at 0; never more than sqrt(|x - m|).
        let spread = if self.radius == 0.0 { 0.0 } else { (self.radius / root.hi).min(self.radius.sqrt()) };
        Precise { value, radius: (spread + 8.0 * Triple::ERROR * root.hi + UNDERFLOW) * UP }
    }
}

impl Real for Precise {
    const ZERO: Precise = Precise::ZERO;
    const ONE: Precise = Precise::ONE;

    #[inline]
    fn of_dd(x: Dd) -> Precise {
        Precise { value: x.into(), radius: 0.0 }
    }

    #[inline]
    fn to_f64(self) -> f64 {
        self.value.hi()
    }
}

impl Neg for Precise {
    type Output = Precise;
    #[inline]
    fn neg(self) -> Precise {
        Precise { value: -self.value, radius: self.radius }
    }
}

impl Add for Precise {
    type Output = Precise;
    #[inline(always)]
    fn add(self, y: Precise) -> Precise {
        if self.is_zero() {
            return y;
        }
        if y.is_zero() {
            return self;
        }
        let larger = self.value.hi().abs().max(y.value.hi().abs());
        let radius = (self.radius + y.radius + larger * Triple::ERROR * UP) * UP;
        Precise { value: self.value + y.value, radius }
    }
}

impl Sub for Precise {
    type Output = Precise;
    #[inline]
    fn sub(self, y: Precise) -> Precise {
        self + -y
    }
}

impl Mul for Precise {
    type Output = Precise;
    // A call would leave the processor's fused instruction behind (see `fused`).
    #[inline(always)]
    fn mul(self, y: Precise) -> Precise {
        if self.is_zero() || y.is_zero() {
            return Precise::ZERO;
        }
        let (a, b) = (self.value.hi().abs() * UP, y.value.hi().abs() * UP);
        let radius = a * y.radius + (b + y.radius) * self.radius + a * b * Triple::ERROR;
        Precise { value: self.value * y.value, radius: (radius + UNDERFLOW) * UP }
    }
}

impl Div for Precise {
    type Output = Precise;
    /// Of infinite radius where the divisor may be zero.
    fn div(self, y: Precise) -> Precise {
        if self.is_zero() && !y.is_zero() {
            return Precise::ZERO;
        }
        let least = y.value.hi().abs() * (2.0 - UP) - y.radius;
        if least.is_nan() || least <= 0.0 {
            return Precise { value: Triple::ZERO, radius: f64::INFINITY };
        }
        let value = Triple::ratio(self.value, y.value);
        // |n/d - n'/d'| <= (|dn| + |n'/d'| |dd|) / |d|
        let size = value.hi().abs() * UP;
        let spread = (self.radius + size * y.radius) / least;
        Precise { value, radius: (spread + 8.0 * Triple::ERROR * size + UNDERFLOW) * UP }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Number, Rational};

    /// The exact value of a triple word's leading words is within what it leaves; the test numbers are short.
    fn encloses(x: Precise, truth: &Number) -> bool {
        let part = |x: f64| Number::from(Rational::from_f64(x).expect("finite"));
        let (dd, rest) = x.value.split();
        let value = &(&part(dd.hi) + &part(dd.lo)) + &part(rest);
        // Splitting forgets at most 2^-159 of the value.
        (&value - truth).abs().to_f64() <= x.radius + 1e-47 * dd.hi.abs()
    }

    #[test]
    fn sums_and_products_enclose_the_true_values() {
        let numbers = ["1.1", "0.3333333333333333333333333333333333333333333", "123456.789", "1e-20"].map(Number::from);
        for x in &numbers {
            for y in &numbers {
                let (a, b) = (Precise::of(x), Precise::of(y));
                assert!(encloses(a + b, &(x + y)) && encloses(a - b, &(x - y)) && encloses(a * b, &(x * y)));
                assert!((a * b).radius <= 1e-43 * (x * y).to_f64());
                assert!(encloses(a / b, &(x / y)) && (a / b).radius <= 1e-43 * (x / y).to_f64());
            }
        }
    }

    #[test]
    fn structural_zeros_stay_exact() {
        let third = Precise::of(&(&Number::ONE / &Number::from(3)));
        assert!((third * Precise::ZERO).is_zero());
        assert_eq!(third + Precise::ZERO, third);
    }

    /// The square of the root encloses the number, and hardly more.
    #[test]
    fn roots_enclose_the_true_values() {
        for text in ["2", "3", "0.7", "1e-40", "123456789.987654321"] {
            let x = Number::from(text);
            let root = Precise::of(&x).sqrt();
            assert!(encloses(root * root, &x), "{text}");
            assert!(root.radius <= 1e-44 * x.to_f64().sqrt(), "{text}");
        }
    }
}
