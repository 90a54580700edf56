//! Double-double arithmetic: an unevaluated sum `hi + lo` of two binary64 numbers, |lo| <= ulp(hi)/2.
//!
//! The algorithms are those of Joldes, Muller and Popescu, *Tight and rigorous error bounds for basic building
//! blocks of double-word arithmetic*, ACM TOMS 44 (2017), no. 2, article 15res. With u = 2^-53 their relative errors are:
//! sum 3u^2 (AccurateDWPlusDW, Alg. 6), product 5u^2 (DWTimesDW2, Alg. 11), quotient 9.8u^2 (DWDivDW3, Alg. 18),
//! square root 25u^2/8. Every one of them is below [`Dd::EPSILON`] = 2^-102 = 16u^2, barring overflow and underflow.
//! `f64::mul_add` is correctly rounded on every target, so results are the same on every machine.

use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// An unevaluated sum of two binary64 numbers.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Dd {
    pub hi: f64,
    pub lo: f64,
}

/// s + e = a + b exactly (Knuth).
#[inline]
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let bb = s - a;
    (s, (a - (s - bb)) + (b - bb))
}

/// s + e = a + b exactly, for |a| >= |b| or a = 0 (Dekker).
#[inline]
pub fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    (s, b - (s - a))
}

/// p + e = a b exactly, barring underflow.
#[inline]
pub fn two_prod(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    (p, a.mul_add(b, -p))
}

impl Dd {
    pub const ZERO: Dd = Dd { hi: 0.0, lo: 0.0 };
    pub const ONE: Dd = Dd { hi: 1.0, lo: 0.0 };
    /// Circle constant, correct to 2^-107 relative.
    pub const PI: Dd = Dd { hi: std::f64::consts::PI, lo: 1.2246467991473532e-16 };
    /// Natural logarithm of 2, correct to 2^-107 relative.
    pub const LN_2: Dd = Dd { hi: std::f64::consts::LN_2, lo: 2.3190468138462996e-17 };
    /// Relative error bound of one operation of this module.
    pub const EPSILON: f64 = 1.0 / (1u128 << 102) as f64;

    /// The sum of two numbers, normalised.
    #[inline]
    pub fn new(a: f64, b: f64) -> Dd {
        let (hi, lo) = two_sum(a, b);
        Dd { hi, lo }
    }

    /// Nearest binary64 number.
    #[inline]
    pub fn to_f64(self) -> f64 {
        self.hi + self.lo
    }

    #[inline]
    pub fn is_finite(self) -> bool {
        self.hi.is_finite() && self.lo.is_finite()
    }

    #[inline]
    pub fn is_zero(self) -> bool {
        self.hi == 0.0
    }

    #[inline]
    pub fn abs(self) -> Dd {
        if self.hi < 0.0 { -self } else { self }
    }

    /// Non-negative square root; NaN for a negative number.
    #[inline]
    pub fn sqrt(self) -> Dd {
        if self.hi == 0.0 {
            return Dd::ZERO;
        }
        let s = self.hi.sqrt();
        let rest = (-s).mul_add(s, self.hi) + self.lo;
        let (hi, lo) = fast_two_sum(s, rest / (2.0 * s));
        Dd { hi, lo }
    }

    /// Product with a power of two: exact, barring overflow and underflow.
    #[inline]
    pub fn scale(self, power_of_two: f64) -> Dd {
        Dd { hi: self.hi * power_of_two, lo: self.lo * power_of_two }
    }

    /// The product of two binary64 numbers, exact barring underflow.
    #[inline]
    pub fn product(a: f64, b: f64) -> Dd {
        let (hi, lo) = two_prod(a, b);
        Dd { hi, lo }
    }

    #[inline]
    pub fn square(self) -> Dd {
        self * self
    }

    #[inline]
    pub fn recip(self) -> Dd {
        Dd::ONE / self
    }
}

impl From<f64> for Dd {
    #[inline]
    fn from(x: f64) -> Dd {
        Dd { hi: x, lo: 0.0 }
    }
}

impl Neg for Dd {
    type Output = Dd;
    #[inline]
    fn neg(self) -> Dd {
        Dd { hi: -self.hi, lo: -self.lo }
    }
}

impl Add for Dd {
    type Output = Dd;
    #[inline]
    fn add(self, b: Dd) -> Dd {
        let (sh, sl) = two_sum(self.hi, b.hi);
        let (th, tl) = two_sum(self.lo, b.lo);
        let (vh, vl) = fast_two_sum(sh, sl + th);
        let (hi, lo) = fast_two_sum(vh, tl + vl);
        Dd { hi, lo }
    }
}

impl Sub for Dd {
    type Output = Dd;
    #[inline]
    fn sub(self, b: Dd) -> Dd {
        self + -b
    }
}

impl Mul for Dd {
    type Output = Dd;
    #[inline]
    fn mul(self, b: Dd) -> Dd {
        let (ch, cl) = two_prod(self.hi, b.hi);
        let tl = self.hi * b.lo;
        let cl2 = self.lo.mul_add(b.hi, tl);
        let (hi, lo) = fast_two_sum(ch, cl + cl2);
        Dd { hi, lo }
    }
}

impl Mul<f64> for Dd {
    type Output = Dd;
    #[inline]
    fn mul(self, b: f64) -> Dd {
        let (ch, cl) = two_prod(self.hi, b);
        let (hi, lo) = fast_two_sum(ch, self.lo.mul_add(b, cl));
        Dd { hi, lo }
    }
}

impl Div for Dd {
    type Output = Dd;
    #[inline]
    fn div(self, b: Dd) -> Dd {
        // DWDivDW3: the reciprocal of b by one Newton step, then one product.
        let th = 1.0 / b.hi;
        let rh = (-b.hi).mul_add(th, 1.0);
        let rl = -(b.lo * th);
        let (eh, el) = fast_two_sum(rh, rl);
        let d = Dd { hi: eh, lo: el } * th;
        let (mh, ml) = fast_two_sum(th, d.hi);
        let m = Dd { hi: mh, lo: ml + d.lo };
        self * m
    }
}

impl AddAssign for Dd {
    #[inline]
    fn add_assign(&mut self, b: Dd) {
        *self = *self + b;
    }
}

impl SubAssign for Dd {
    #[inline]
    fn sub_assign(&mut self, b: Dd) {
        *self = *self - b;
    }
}

impl PartialOrd for Dd {
    #[inline]
    fn partial_cmp(&self, other: &Dd) -> Option<Ordering> {
        match self.hi.partial_cmp(&other.hi) {
            Some(Ordering::Equal) => self.lo.partial_cmp(&other.lo),
            order => order,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Dd, b: Dd) -> bool {
        (a - b).abs().to_f64() <= 4.0 * Dd::EPSILON * b.abs().to_f64()
    }

    #[test]
    fn a_third_times_three_is_one() {
        let third = Dd::ONE / Dd::from(3.0);
        assert!(close(third * Dd::from(3.0), Dd::ONE));
        assert_eq!(third.lo, 1.850371707708594e-17);
    }

    #[test]
    fn the_square_of_a_root_is_the_number() {
        for x in [2.0, 3.0, 1e-200, 7.7e150] {
            assert!(close(Dd::from(x).sqrt().square(), Dd::from(x)));
        }
    }

    #[test]
    fn sums_keep_what_binary64_loses() {
        let x = Dd::ONE + Dd::from(1e-25);
        assert!(close(x - Dd::ONE, Dd::from(1e-25)) || (x - Dd::ONE - Dd::from(1e-25)).abs().to_f64() < 1e-32);
    }
}
