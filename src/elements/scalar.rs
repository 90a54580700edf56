//! The number types of the mechanics: binary64 for steps that only steer a search, [`Number`] for results.

use super::curve;
use crate::base::{Ball, Dd, Number};
use std::fmt::Debug;

/// A field with square roots and sines. Operations are methods, since operators on references to generic operands read
/// worse.
pub trait Scalar: Clone + Debug {
    fn zero() -> Self;
    fn one() -> Self;
    fn of(number: &Number) -> Self;
    fn plus(&self, other: &Self) -> Self;
    fn minus(&self, other: &Self) -> Self;
    fn times(&self, other: &Self) -> Self;
    fn over(&self, other: &Self) -> Self;
    fn negate(&self) -> Self;
    /// The sum of the products of three numbers with three others.
    #[inline]
    fn dot(a: [&Self; 3], b: [&Self; 3]) -> Self {
        a[0].times(b[0]).plus(&a[1].times(b[1])).plus(&a[2].times(b[2]))
    }
    /// Square root of a number that is not negative.
    fn root(&self) -> Self;
    fn sin_cos(&self) -> (Self, Self);
    /// The angle of the direction (x, y).
    fn atan2(y: &Self, x: &Self) -> Self;
    /// Whether it is certainly zero, so that products with it can be left out.
    fn is_zero(&self) -> bool;
    /// About this value, in the middle of a range: for sizes, and for what is proved afterwards.
    fn to_f64(&self) -> f64;
    /// This value as a [`Number`](crate::base::Number).
    fn number(&self) -> Number;
    /// The middle of the values that this one takes over a range, exactly, and how far each is from it; `None` if it takes one.
    fn middle_and_change(&self) -> Option<(Self, Self)> {
        None
    }
    /// A value of which nothing is known.
    fn unknown() -> Self;
    /// The integral of a function from 0, which only a search needs.
    fn integral(f: impl FnMut(f64) -> f64, to: &Self) -> Self;
}

impl Scalar for f64 {
    fn zero() -> f64 {
        0.0
    }

    fn one() -> f64 {
        1.0
    }

    fn of(number: &Number) -> f64 {
        number.to_f64()
    }

    #[inline]
    fn plus(&self, other: &f64) -> f64 {
        self + other
    }

    #[inline]
    fn minus(&self, other: &f64) -> f64 {
        self - other
    }

    #[inline]
    fn times(&self, other: &f64) -> f64 {
        self * other
    }

    #[inline]
    fn over(&self, other: &f64) -> f64 {
        self / other
    }

    #[inline]
    fn negate(&self) -> f64 {
        -self
    }

    #[inline]
    fn root(&self) -> f64 {
        self.sqrt()
    }

    /// Uses the ball functions: those of the standard library differ between machines, and the search for the rest
    /// reports its number of steps.
    fn sin_cos(&self) -> (f64, f64) {
        let (sine, cosine) = Number::Ball(Ball::from(*self)).sin_cos().unwrap_or((Number::ZERO, Number::ONE));
        (sine.to_f64(), cosine.to_f64())
    }

    fn atan2(y: &f64, x: &f64) -> f64 {
        Number::atan2(&y.number(), &x.number()).map_or(f64::NAN, |angle| angle.to_f64())
    }

    #[inline]
    fn is_zero(&self) -> bool {
        *self == 0.0
    }

    #[inline]
    fn to_f64(&self) -> f64 {
        *self
    }

    fn number(&self) -> Number {
        Number::Ball(Ball::from(*self))
    }

    fn unknown() -> f64 {
        f64::NAN
    }

    fn integral(mut f: impl FnMut(f64) -> f64, to: &f64) -> f64 {
        curve::integral(&mut f, *to)
    }
}

impl Scalar for Number {
    fn zero() -> Number {
        Number::ZERO
    }

    fn one() -> Number {
        Number::ONE
    }

    fn of(number: &Number) -> Number {
        number.clone()
    }

    #[inline]
    fn plus(&self, other: &Number) -> Number {
        self + other
    }

    #[inline]
    fn minus(&self, other: &Number) -> Number {
        self - other
    }

    #[inline]
    fn times(&self, other: &Number) -> Number {
        self * other
    }

    #[inline]
    fn over(&self, other: &Number) -> Number {
        self / other
    }

    #[inline]
    fn negate(&self) -> Number {
        -self
    }

    /// Most components of most directions are zero.
    fn dot(a: [&Number; 3], b: [&Number; 3]) -> Number {
        let is_zero = |number: &Number| matches!(number, Number::Exact(value) if value.is_zero());
        let products = a.into_iter().zip(b).filter(|(a, b)| !(is_zero(a) || is_zero(b))).map(|(a, b)| a * b);
        products.reduce(|sum, product| &sum + &product).unwrap_or(Number::ZERO)
    }

    fn root(&self) -> Number {
        self.sqrt().unwrap_or_else(Scalar::unknown)
    }

    fn sin_cos(&self) -> (Number, Number) {
        // Beyond the range of the argument reduction, both are only known to lie in [-1, 1].
        let anywhere = || Number::Ball(Ball::new(Dd::ZERO, 1.0));
        Number::sin_cos(self).unwrap_or_else(|| (anywhere(), anywhere()))
    }

    fn atan2(y: &Number, x: &Number) -> Number {
        Number::atan2(y, x).unwrap_or_else(Scalar::unknown)
    }

    #[inline]
    fn is_zero(&self) -> bool {
        self.vanishes()
    }

    fn to_f64(&self) -> f64 {
        self.enclosure().to_f64()
    }

    fn number(&self) -> Number {
        self.clone()
    }

    fn middle_and_change(&self) -> Option<(Number, Number)> {
        let middle = || Number::Ball(Ball::exact(self.enclosure().mid));
        self.is_range().then(middle).map(|middle| (middle.clone(), self - &middle))
    }

    /// A ball that contains every number.
    fn unknown() -> Number {
        Number::Ball(Ball::new(Dd::ZERO, f64::INFINITY))
    }

    fn integral(_: impl FnMut(f64) -> f64, _: &Number) -> Number {
        Number::unknown()
    }
}
