//! Arithmetic on triple words with a radius: ball arithmetic with some 150 bits, in which the residuals of poles are
//! evaluated. Every operation adds the bound of its own rounding error (see [`Triple::ERROR`]); zero stays exact.

use crate::base::Dd;
use crate::kernel::real::Real;
use crate::kernel::triple::{Precise, Triple};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Covers the rounding errors of a radius, and the loss when a lower word is neglected against a leading one.
const UP: f64 = 1.0 + 1.0 / (1u64 << 40) as f64;
const UNDERFLOW: f64 = Triple::UNDERFLOW;
/// Underflow error of the remainders of a long division, or of that of a root: at most a few dozen steps of binary64,
/// 3.2e-322, in an order in which nothing here is subnormal.
fn lost_of_remainder(x: Triple) -> f64 {
    3.2e-22 / (x.hi().abs().min(1e-260) * 1e300)
}

impl Precise {
    pub const ZERO: Precise = Precise { value: Triple::ZERO, radius: 0.0 };
    pub const ONE: Precise = Precise { value: Triple::ONE, radius: 0.0 };

    #[inline]
    pub fn is_zero(&self) -> bool {
        self.value.is_zero() && self.radius == 0.0
    }

    /// The square root of a non-negative number; a part of the ball below zero is cut off.
    pub fn sqrt(self) -> Precise {
        if self.is_zero() {
            return Precise::ZERO;
        }
        // r + (x - r^2) / 2r for the root r in double-double: r^2 and the difference have an error of ERROR x each, and
        // the remaining error of the Newton step is below 2^-200.
        let root = self.value.dd().abs().sqrt();
        let words = Triple::from(root);
        let rest = self.value - words * words;
        let value = words + Triple::from(rest.hi() / (2.0 * root.hi));
        // |sqrt(x) - sqrt(m)| <= |x - m| / sqrt(m), also where x is cut off at 0; never more than sqrt(|x - m|).
        let spread = if self.radius == 0.0 { 0.0 } else { (self.radius / root.hi).min(self.radius.sqrt()) };
        // The underflow error of the remainder is divided by 2r, once for the root in double-double and once for the
        // step.
        let lost = root.hi * lost_of_remainder(self.value);
        Precise { value, radius: (spread + 8.0 * Triple::ERROR * root.hi + lost + UNDERFLOW) * UP }
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
    // A call would lose the processor's fused instruction (see `fused`).
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
    /// The radius is infinite if the divisor may be zero.
    fn div(self, y: Precise) -> Precise {
        if self.is_zero() && !y.is_zero() {
            return Precise::ZERO;
        }
        let least = y.value.hi().abs() * (2.0 - UP) - y.radius;
        if least.is_nan() || least <= 0.0 {
            return Precise { value: Triple::ZERO, radius: f64::INFINITY };
        }
        let value = Triple::ratio(self.value, y.value);
        // |n/d - n'/d'| <= |dn| / |d| + |n'/d'| |dd| / |d|, in an order in which no product underflows noticeably.
        let size = value.hi().abs() * UP;
        let spread = self.radius / least + size * (y.radius / least + lost_of_remainder(self.value));
        Precise { value, radius: (spread + 8.0 * Triple::ERROR * size + UNDERFLOW) * UP }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Number, Rational};

    /// The words are split into parts whose exact values are known; the test numbers are short.
    fn encloses(x: Precise, truth: &Number) -> bool {
        let part = |x: f64| Number::from(Rational::from_f64(x).expect("finite"));
        let (dd, rest) = x.value.split();
        let value = &(&part(dd.hi) + &part(dd.lo)) + &part(rest);
        // The split loses at most 2^-159 of the value.
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

    /// Numbers near both ends of binary64, of one word and of three: a quotient times its divisor, and the square of a
    /// root, enclose the original number in exact arithmetic.
    #[test]
    fn both_ends_of_the_range_are_held_to_their_radius() {
        let part = |x: f64| Number::from(Rational::from_f64(x).expect("finite"));
        let value = |x: Triple| {
            let ([a, b], c) = ([x.split().0.hi, x.split().0.lo], x.split().1);
            &(&part(a) + &part(b)) + &part(c)
        };
        let ends = |x: Precise| {
            // The split loses at most 2^-159 of the value, or a step of binary64.
            let radius = &part(x.radius) + &part(x.value.hi().abs() * 2e-48 + 1e-323);
            [&value(x.value) - &radius, &value(x.value) + &radius]
        };
        let sizes = [1.1e-306, 1e-300, 7e-293, 1e-276, 3e-200, 0.3, 1e77, 1e290, 3e300];
        let short = sizes.map(Triple::from);
        let long = sizes.map(|a| Triple::from(Dd::new(a, a * 0.9e-16)) + Triple::from(a * 0.7e-32));
        let numbers: Vec<Triple> = short.into_iter().chain(long).collect();
        let exact = |value: Triple| Precise { value, radius: 0.0 };
        for &n in &numbers {
            let root = exact(n).sqrt();
            let [low, high] = ends(root);
            assert!(low.is_negative() || !(&low.square() - &value(n)).is_positive(), "{n:?}: {root:?}");
            assert!(!(&high.square() - &value(n)).is_negative(), "{n:?}: {root:?}");
            for &d in &numbers {
                let quotient = exact(n) / exact(d);
                if !(quotient.value.is_finite() && quotient.radius.is_finite()) {
                    continue;
                }
                let [low, high] = ends(quotient);
                assert!(!(&(&low * &value(d)) - &value(n)).is_positive(), "{n:?} / {d:?}: {quotient:?}");
                assert!(!(&(&high * &value(d)) - &value(n)).is_negative(), "{n:?} / {d:?}: {quotient:?}");
            }
        }
    }

    #[test]
    fn structural_zeros_stay_exact() {
        let third = Precise::of(&(&Number::ONE / &Number::from(3)));
        assert!((third * Precise::ZERO).is_zero());
        assert_eq!(third + Precise::ZERO, third);
    }

    /// The square of the root encloses the number, and is hardly wider.
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
