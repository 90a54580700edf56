//! Binary floating point of any precision: m 2^e with an integer m. In and out: numbers; sums and products are exact
//! until they are cut to a number of bits. Used for roots of polynomials that double-double does not separate. See
//! docs/method/poles.md#exact-arithmetic.

use crate::base::{Ball, Dd, two_to, up};
use num_bigint::{BigInt, Sign};
use num_traits::{Signed, ToPrimitive, Zero};
use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

/// mantissa 2^exponent
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Float {
    mantissa: BigInt,
    exponent: i64,
}

impl Default for Float {
    fn default() -> Float {
        Float::zero()
    }
}

/// A complex number of two floats.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ComplexFloat {
    pub re: Float,
    pub im: Float,
}

impl Float {
    pub fn zero() -> Float {
        Float { mantissa: BigInt::zero(), exponent: 0 }
    }

    pub fn is_zero(&self) -> bool {
        self.mantissa.is_zero()
    }

    pub fn is_negative(&self) -> bool {
        self.mantissa.is_negative()
    }

    /// The sign, as a comparison with zero.
    pub fn sign(&self) -> Ordering {
        self.mantissa.sign().cmp(&Sign::NoSign)
    }

    /// Multiplies by a power of two, exactly.
    pub fn times_power_of_two(self, power: i64) -> Float {
        Float { exponent: self.exponent + power, ..self }
    }

    /// Cuts to that many bits, towards minus infinity.
    pub fn cut(self, bits: u64) -> Float {
        let excess = self.mantissa.bits() as i64 - bits as i64;
        if excess <= 0 {
            return self;
        }
        Float { mantissa: self.mantissa >> excess as u64, exponent: self.exponent + excess }
    }

    /// self / d to that many bits, towards zero; d is not zero.
    pub fn divided_by(&self, d: &Float, bits: u64) -> Float {
        let shift = (bits as i64 + d.mantissa.bits() as i64 - self.mantissa.bits() as i64 + 1).max(0);
        Float { mantissa: (&self.mantissa << shift as u64) / &d.mantissa, exponent: self.exponent - shift - d.exponent }
    }

    /// The base-2 logarithm of |x|, rounded up to an integer; `None` for zero.
    pub fn ceiling_log2(&self) -> Option<i64> {
        (!self.is_zero()).then(|| self.mantissa.bits() as i64 + self.exponent)
    }

    /// An upper bound of sqrt(self / d) with a relative excess below 2^-50; for non-negative numbers, d not zero.
    pub fn root_of_quotient_above(&self, d: &Float) -> Float {
        if self.is_zero() {
            return Float::zero();
        }
        // Numbers of very different lengths give a longer quotient than requested.
        let quotient = self.divided_by(d, 120).cut(120);
        let even = quotient.exponent.rem_euclid(2) as u64;
        // Both the quotient and the root were rounded down.
        let root = ((quotient.mantissa + 1u32) << even).sqrt() + 1u32;
        Float { mantissa: root, exponent: (quotient.exponent - even as i64) / 2 }
    }

    /// An upper bound in binary64 of a non-negative number, infinite beyond the range; 0 only for zero.
    pub fn to_f64_above(&self) -> f64 {
        if self.is_zero() {
            return 0.0;
        }
        let excess = (self.mantissa.bits() as i64 - 53).max(0);
        let mantissa = (&self.mantissa >> excess as u64) + i32::from(excess > 0);
        // At most 2^53 and exact, so only the factor can leave the range.
        let value = mantissa.to_f64().unwrap_or(f64::INFINITY) * two_to(self.exponent + excess);
        (value * (1.0 + f64::EPSILON)).max(f64::MIN_POSITIVE)
    }

    /// The nearest binary64 number towards zero; 0 or infinite beyond the range.
    pub fn to_f64(&self) -> f64 {
        let excess = (self.mantissa.bits() as i64 - 53).max(0);
        // Cut towards zero, so that the remainder has the same sign.
        let magnitude = (self.mantissa.abs() >> excess as u64).to_f64().unwrap_or(f64::INFINITY);
        let value = magnitude * two_to(self.exponent + excess);
        if self.is_negative() { -value } else { value }
    }

    /// A nearby double-double, with a radius that covers its error and `radius`.
    pub fn to_ball(&self, radius: f64) -> Ball {
        let hi = self.to_f64();
        let rest = self - &Float::from(hi);
        let lo = rest.to_f64();
        let left = &rest - &Float::from(lo);
        let mid = Dd::new(hi, lo);
        if left.is_zero() && radius == 0.0 {
            return Ball::new(mid, 0.0);
        }
        // Near the bottom of the range the words lose bits, but two_sum loses none.
        Ball::new(mid, (left.abs().to_f64_above() + radius) * up::DOZENS + f64::MIN_POSITIVE)
    }

    pub fn abs(&self) -> Float {
        Float { mantissa: self.mantissa.abs(), exponent: self.exponent }
    }
}

impl From<BigInt> for Float {
    fn from(mantissa: BigInt) -> Float {
        Float { mantissa, exponent: 0 }
    }
}

impl From<f64> for Float {
    /// Converts exactly; a number that is not finite becomes zero.
    fn from(x: f64) -> Float {
        if !x.is_finite() || x == 0.0 {
            return Float::zero();
        }
        let bits = x.to_bits();
        let (biased, fraction) = ((bits >> 52 & 0x7ff) as i64, bits & ((1 << 52) - 1));
        let (mantissa, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
        let mantissa = BigInt::from(mantissa);
        Float { mantissa: if x < 0.0 { -mantissa } else { mantissa }, exponent }
    }
}

impl Neg for &Float {
    type Output = Float;
    fn neg(self) -> Float {
        Float { mantissa: -&self.mantissa, exponent: self.exponent }
    }
}

impl Add for &Float {
    type Output = Float;
    fn add(self, other: &Float) -> Float {
        if self.is_zero() || other.is_zero() {
            return if self.is_zero() { other.clone() } else { self.clone() };
        }
        let (low, high) = if self.exponent <= other.exponent { (self, other) } else { (other, self) };
        let raised = &high.mantissa << (high.exponent - low.exponent) as u64;
        Float { mantissa: raised + &low.mantissa, exponent: low.exponent }
    }
}

impl Sub for &Float {
    type Output = Float;
    fn sub(self, other: &Float) -> Float {
        self + &-other
    }
}

impl Mul for &Float {
    type Output = Float;
    fn mul(self, other: &Float) -> Float {
        Float { mantissa: &self.mantissa * &other.mantissa, exponent: self.exponent + other.exponent }
    }
}

impl ComplexFloat {
    pub fn new(re: Float, im: Float) -> ComplexFloat {
        ComplexFloat { re, im }
    }

    pub fn zero() -> ComplexFloat {
        ComplexFloat::new(Float::zero(), Float::zero())
    }

    pub fn is_zero(&self) -> bool {
        self.re.is_zero() && self.im.is_zero()
    }

    pub fn cut(self, bits: u64) -> ComplexFloat {
        ComplexFloat::new(self.re.cut(bits), self.im.cut(bits))
    }

    /// |z|^2
    pub fn norm(&self) -> Float {
        &(&self.re * &self.re) + &(&self.im * &self.im)
    }

    /// 1 / z to that many bits; z is not zero.
    pub fn recip(&self, bits: u64) -> ComplexFloat {
        let norm = self.norm();
        ComplexFloat::new(self.re.divided_by(&norm, bits), (-&self.im).divided_by(&norm, bits))
    }

    pub fn conj(&self) -> ComplexFloat {
        ComplexFloat::new(self.re.clone(), -&self.im)
    }
}

impl Add for &ComplexFloat {
    type Output = ComplexFloat;
    fn add(self, other: &ComplexFloat) -> ComplexFloat {
        ComplexFloat::new(&self.re + &other.re, &self.im + &other.im)
    }
}

impl Sub for &ComplexFloat {
    type Output = ComplexFloat;
    fn sub(self, other: &ComplexFloat) -> ComplexFloat {
        ComplexFloat::new(&self.re - &other.re, &self.im - &other.im)
    }
}

impl Mul for &ComplexFloat {
    type Output = ComplexFloat;
    fn mul(self, other: &ComplexFloat) -> ComplexFloat {
        ComplexFloat::new(
            &(&self.re * &other.re) - &(&self.im * &other.im),
            &(&self.re * &other.im) + &(&self.im * &other.re),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn binary64_numbers_come_back() {
        for x in [1.0, -0.1, 1e300, 4.9e-324, 123_456.789] {
            assert_eq!(Float::from(x).to_f64(), x);
        }
    }

    #[test]
    fn a_third_is_enclosed_by_its_double_double() {
        let third = Float::from(1.0).divided_by(&Float::from(3.0), 300);
        let ball = third.to_ball(0.0);
        assert!(ball.rad < 1e-32 && ball.rad > 0.0);
        let back = &Float::from(ball.mid.hi) + &Float::from(ball.mid.lo);
        assert!((&back - &third).to_f64().abs() <= ball.rad);
    }

    #[test]
    fn roots_of_quotients_are_bounded_from_above() {
        for (a, d) in [(2.0, 1.0), (9.0, 4.0), (1e-200, 3.0), (5.0, 1e200)] {
            let bound = Float::from(a).root_of_quotient_above(&Float::from(d)).to_f64_above();
            let root = (a / d).sqrt();
            assert!(bound >= root && bound < root * (1.0 + 1e-10), "{a} {d}: {bound}");
        }
    }

    /// A quotient of a long number by a short one has more bits than binary64 has exponents.
    #[test]
    fn roots_of_quotients_of_long_numbers_are_bounded_too() {
        let third = |bits: u64| Float::from(1.0).divided_by(&Float::from(3.0), bits);
        for (bits, d) in [(3000, 1.0), (5000, 1e300), (1000, 7.0), (60, 0.3)] {
            let (a, d) = (third(bits).times_power_of_two(-700), Float::from(d));
            let bound = a.root_of_quotient_above(&d);
            let slack = |x: &Float| x * &Float::from(1.0 + 1e-14);
            assert!((&(&(&bound * &bound) * &d) - &a).sign() == Ordering::Greater, "{bits}");
            assert!((&slack(&a) - &(&(&bound * &bound) * &d)).sign() == Ordering::Greater, "{bits}");
        }
    }

    #[test]
    fn numbers_below_binary64_are_not_zero() {
        let tiny = Float::from(1.0).times_power_of_two(-1300);
        assert!(tiny.to_f64_above() > 0.0);
        assert!(tiny.to_ball(0.0).rad > 0.0);
        let huge = Float::from(1.0).times_power_of_two(1300);
        assert_eq!(huge.to_f64_above(), f64::INFINITY);
        let least = Float::from(1.0).times_power_of_two(-1022);
        assert!(least.to_f64_above() >= f64::MIN_POSITIVE && least.to_f64_above() < 1e-307);
    }

    #[test]
    fn a_number_times_its_reciprocal_is_one() {
        let z = ComplexFloat::new(Float::from(3.0), Float::from(-0.7));
        let one = &z * &z.recip(200);
        assert!((&one.re - &Float::from(1.0)).ceiling_log2().is_none_or(|e| e < -190));
        assert!(one.im.ceiling_log2().is_none_or(|e| e < -190));
    }
}
