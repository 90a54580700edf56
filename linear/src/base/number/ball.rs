//! Ball arithmetic: a double-double midpoint and a radius that encloses the true value,
//! |x - mid| <= rad. Every operation adds a rigorous bound of its own rounding (see [`Dd::EPSILON`]),
//! so every number computed with balls carries an error bound that holds. See docs/method/numbers.md.
//!
//! A ball of radius zero is exact. Zero times anything finite is exactly zero, and the sum with an exact zero is exact,
//! so that structural zeros stay structural.

use super::dd::Dd;
use super::rounding::down;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number known to lie within `rad` of `mid`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    pub mid: Dd,
    /// Absolute radius, not negative; infinite where nothing is known, never NaN.
    pub rad: f64,
}

/// Inflation that covers the few roundings (at most eight) of a radius computed in binary64.
const UP: f64 = 1.0 + 1.0 / (1u64 << 49) as f64;
/// Covers the loss of a product's low part near the bottom of the exponent range.
const UNDERFLOW: f64 = 1e-318;

/// Error of a nearly subnormal reciprocal: eight steps of binary64, 4e-323, written in an order in
/// which no intermediate number is subnormal, because processors are slow with these.
#[inline]
fn lost_of_reciprocal(x: f64) -> f64 {
    x.abs().max(1e280) * 1e-300 * 4e-23
}

/// Error of the remainder of a square root by underflow.
#[inline]
fn lost_of_remainder(x: f64) -> f64 {
    4e-23 / (x.abs().min(1e-280) * 1e300)
}

/// Bound of the rounding error of a double-double result.
#[inline]
fn rounding(mid: Dd) -> f64 {
    mid.hi.abs() * (2.0 * Dd::EPSILON) + UNDERFLOW
}

/// The bound itself, or infinity for NaN: a result of infinities must not compare like a bound.
#[inline]
fn bound(x: f64) -> f64 {
    if x.is_nan() { f64::INFINITY } else { x }
}

/// The larger of two bounds, infinite if one of them is NaN (`f64::max` would return the other).
#[inline]
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::INFINITY } else { a.max(b) }
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
        // A NaN midpoint excludes nothing.
        let away = self.mid.hi.abs() * down::FEW > self.rad;
        !away
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
        bound((self.mid.hi.abs() + self.rad) * UP)
    }

    /// A lower bound of |x|, zero if the ball contains zero.
    #[inline]
    pub fn mignitude(&self) -> f64 {
        ((self.mid.hi.abs() - self.rad) * (2.0 - UP)).max(0.0)
    }

    /// A bound of the relative error of `mid`: rad / mignitude, infinite if the ball contains zero.
    pub fn relative_error(&self) -> f64 {
        if self.rad == 0.0 { 0.0 } else { bound(self.rad / self.mignitude() * UP) }
    }

    #[inline]
    pub fn to_f64(&self) -> f64 {
        self.mid.to_f64()
    }

    #[inline]
    pub fn abs(self) -> Ball {
        Ball { mid: self.mid.abs(), rad: self.rad }
    }

    /// The larger of two numbers.
    pub fn or_larger(self, other: Ball) -> Ball {
        // max(x, y) is off by no more than the worse of the two.
        let mid = if other.mid > self.mid { other.mid } else { self.mid };
        Ball { mid, rad: larger(self.rad, other.rad) }
    }

    /// The ball with its radius increased by `by`.
    #[inline]
    pub fn widen(self, by: f64) -> Ball {
        Ball { mid: self.mid, rad: bound((self.rad + by) * UP) }
    }

    /// Square root of a ball whose midpoint is not negative; the part below zero is cut off.
    pub fn sqrt(self) -> Ball {
        if self.is_zero() {
            return Ball::ZERO;
        }
        let root = self.mid.abs().sqrt();
        // |sqrt(x) - sqrt(m)| <= |x - m| / sqrt(m), also where x is cut off at 0; never more than sqrt(|x - m|).
        let spread = if self.rad == 0.0 { 0.0 } else { (self.rad / root.hi).min(self.rad.sqrt()) };
        // The root errs by what its remainder x - r^2 has lost by underflow, over 2r.
        let lost = if root.is_zero() { 0.0 } else { root.hi * lost_of_remainder(self.mid.hi) };
        Ball { mid: root, rad: bound((spread * UP + rounding(root) + lost) * UP) }
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
        Ball { mid, rad: bound((self.rad + b.rad + rounding(mid)) * UP) }
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
        // Zero times infinity is NaN.
        Ball { mid, rad: bound((spread + rounding(mid)) * UP) }
    }
}

impl Div for Ball {
    type Output = Ball;
    /// The quotient; its radius is infinite if the divisor contains zero.
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
        // |a/b - m/n| <= |a - m| / |b| + |m/n| |b - n| / |b|, in an order in which no product underflows that counts.
        let size = mid.hi.abs() * UP;
        let spread = self.rad / low + size * (b.rad / low);
        // The quotient is a product with 1/n, which is subnormal, or has a subnormal low word, where n is near the top of the range.
        let reciprocal = size * lost_of_reciprocal(b.mid.hi);
        Ball { mid, rad: bound((spread * UP + reciprocal + rounding(mid)) * UP) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Number, Rational};

    #[test]
    fn a_quotient_encloses_the_true_value() {
        let third = Ball::ONE / Ball::from(3.0);
        let back = third * Ball::from(3.0) - Ball::ONE;
        assert!(back.contains_zero());
        assert!(third.relative_error() < 1e-29);
    }

    /// Bounds of the size of a number are on their side of it, low word included.
    /// It contains the larger of any two members, whichever ball is named first, and is no wider than the wider one.
    #[test]
    fn the_larger_of_two_contains_that_of_their_members() {
        let ball = |mid: f64, rad: f64| Ball::from(mid).widen(rad);
        for (a, b) in
            [(ball(3.0, 0.1), ball(2.0, 0.5)), (ball(1.0, 2.0), ball(1.5, 0.1)), (ball(-2.0, 0.0), ball(-5.0, 4.0))]
        {
            for larger in [a.or_larger(b), b.or_larger(a)] {
                assert!(larger.rad <= a.rad.max(b.rad));
                let members = |ball: Ball| [ball.mid.hi - ball.rad, ball.mid.hi, ball.mid.hi + ball.rad];
                for x in members(a).into_iter().flat_map(|x| members(b).map(|y| x.max(y))) {
                    assert!((larger.mid.hi - x).abs() <= larger.rad, "{x} and {larger:?}");
                }
            }
        }
    }

    #[test]
    fn sizes_are_bounded_from_both_sides() {
        for hi in [1.0, -1.0, 3e-308, 1e300] {
            for lo in [0.0, 1e-17 * hi, -1e-17 * hi] {
                let ball = Ball::exact(Dd { hi, lo });
                let size = hi.abs();
                assert!(ball.magnitude() >= size && ball.mignitude() <= size, "{ball:?}");
                assert!(lo == 0.0 || (ball.magnitude() > size && ball.mignitude() < size), "{ball:?}");
            }
        }
    }

    /// Words of numbers near both ends of binary64 and between, with and without a low word.
    fn numbers_everywhere() -> Vec<Dd> {
        let sizes = [1e-323, 3.7e-308, 1.1e-306, 1e-300, 7e-293, 1e-276, 3e-200, 0.3, 1e77, 1e290, 3e300, 1.7e308];
        sizes.iter().flat_map(|&hi| [Dd::from(hi), Dd::new(hi, hi * 0.9e-16)]).collect()
    }

    fn number(x: f64) -> Number {
        Number::from(Rational::from_f64(x).expect("finite"))
    }

    fn ends(ball: Ball) -> [Number; 2] {
        let mid = &number(ball.mid.hi) + &number(ball.mid.lo);
        [&mid - &number(ball.rad), &mid + &number(ball.rad)]
    }

    /// The ends of the quotient times the divisor are on both sides of the dividend, in exact arithmetic.
    #[test]
    fn quotients_are_enclosed_at_both_ends_of_the_range() {
        for a in numbers_everywhere() {
            for b in numbers_everywhere() {
                for wide in [0.0, 1e-30] {
                    let divisor = Ball::new(b, b.hi * wide);
                    let quotient = Ball::exact(a) / divisor;
                    if !quotient.is_finite() {
                        continue;
                    }
                    let [low, high] = ends(quotient);
                    let [from, to] = ends(divisor);
                    let a = &number(a.hi) + &number(a.lo);
                    assert!(!(&(&low * &to) - &a).is_positive(), "{a:?} / {b:?} {wide:e}: {quotient:?}");
                    assert!(!(&(&high * &from) - &a).is_negative(), "{a:?} / {b:?} {wide:e}: {quotient:?}");
                }
            }
        }
    }

    /// And the squares of a root's ends are on both sides of the number.
    #[test]
    fn roots_are_enclosed_at_both_ends_of_the_range() {
        for x in numbers_everywhere() {
            let root = Ball::exact(x).sqrt();
            let [low, high] = ends(root);
            let x = &number(x.hi) + &number(x.lo);
            assert!(low.is_negative() || !(&low.square() - &x).is_positive(), "{x:?}: {root:?}");
            assert!(!(&high.square() - &x).is_negative(), "{x:?}: {root:?}");
        }
    }

    /// Results hold those of the ends of both numbers, in exact arithmetic, and are hardly wider than they need to be.
    #[test]
    fn results_hold_those_of_the_ends() {
        let sides = [(3.0, 0.5), (0.3, 1e-3), (-700.0, 40.0), (5.0, 0.0), (5.0, 0.25), (0.02, 1e-3), (1e9, 1e5)];
        let balls = sides.map(|(mid, rad)| Ball::new(Dd::from(mid), rad));
        let holds = |x: Ball, truth: &Number| {
            let [low, high] = ends(x);
            !(truth - &low).is_negative() && !(&high - truth).is_negative()
        };
        for (a, b) in balls.iter().flat_map(|&a| balls.map(|b| (a, b))) {
            let (x, y) = (a.mid.hi.abs(), b.mid.hi.abs());
            let results = [a + b, a - b, a * b, a / b];
            for (p, q) in ends(a).iter().flat_map(|p| ends(b).map(|q| (p.clone(), q))) {
                let truths = [&p + &q, &p - &q, &p * &q, &p / &q];
                assert!(results.iter().zip(&truths).all(|(&x, truth)| holds(x, truth)), "{a:?} {b:?}: {results:?}");
            }
            let of_product = x * b.rad + y * a.rad + a.rad * b.rad;
            let of_quotient = (a.rad + x / y * b.rad) / (y - b.rad);
            for (found, needed) in results.iter().zip([a.rad + b.rad, a.rad + b.rad, of_product, of_quotient]) {
                assert!(found.rad <= needed * (1.0 + 1e-12) + 1e-28 * found.magnitude(), "{a:?} {b:?} {found:?}");
            }
        }
        for a in balls {
            assert!(ends(a).iter().all(|end| holds(a.square(), &end.square())), "{a:?}");
            assert!(ends(a.widen(2.0)).iter().zip(ends(a)).all(|(wide, end)| (wide - &end).to_f64().abs() >= 2.0));
            assert!(a.widen(2.0).rad <= (a.rad + 2.0) * (1.0 + 1e-12) && a.to_f64() == a.mid.hi);
            assert_eq!((a.is_exact(), a.is_finite()), (a.rad == 0.0, true));
            let known = a.rad / (a.mid.hi.abs() - a.rad);
            assert!(known <= a.relative_error() && a.relative_error() <= known * (1.0 + 1e-9) + 1e-300, "{a:?}");
            if a.is_positive() {
                let [low, high] = ends(a.sqrt());
                let [from, to] = ends(a);
                assert!(!(&from - &low.square()).is_negative() && !(&high.square() - &to).is_negative(), "{a:?}");
            }
        }
    }

    /// An overflow, or a product with an unknown number, is unknown: it has no sign, and its bounds are infinite.
    #[test]
    fn nan_proves_nothing() {
        let unknown = Ball::new(Dd::from(5.0), f64::INFINITY);
        let huge = Ball::from(1e300);
        let none = [Ball::ONE * unknown, unknown * Ball::ONE, huge * huge, huge * huge - huge * huge, unknown / huge];
        for x in none.into_iter().chain([(huge * huge).sqrt(), (huge * huge).widen(1.0), huge * huge + Ball::ONE]) {
            assert_eq!((x.rad, x.magnitude(), x.mignitude()), (f64::INFINITY, f64::INFINITY, 0.0), "{x:?}");
            assert!(x.contains_zero() && !x.is_positive() && !x.is_negative() && x.relative_error().is_infinite());
        }
        assert_eq!([larger(1.0, f64::NAN), larger(f64::NAN, 1.0)], [f64::INFINITY; 2]);
        assert_eq!([larger(1.0, 2.0), larger(f64::INFINITY, 2.0)], [2.0, f64::INFINITY]);
    }

    #[test]
    fn a_sign_is_certain_or_there_is_none() {
        let certain = [(1.0, 0.0, 1), (-1.0, 0.0, -1), (1.0, 0.5, 1), (-1.0, 0.5, -1)];
        let open = [(1.0, 2.0, 0), (-1.0, 2.0, 0), (0.0, 0.0, 0), (0.0, 1.0, 0), (1.0, 1.0, 0)];
        for (mid, radius, sign) in certain.into_iter().chain(open) {
            let x = Ball::new(Dd::from(mid), radius);
            assert_eq!((x.is_positive(), x.is_negative(), x.contains_zero()), (sign > 0, sign < 0, sign == 0), "{x:?}");
        }
    }

    #[test]
    fn structural_zeros_stay_exact() {
        let x = Ball::PI;
        assert!((x * Ball::ZERO).is_zero());
        assert_eq!(x + Ball::ZERO, x);
        assert!((Ball::from(3.0) - Ball::from(3.0)).is_zero());
    }

    #[test]
    fn dividing_by_a_ball_around_zero_gives_no_enclosure() {
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
