//! The floating-point formats of the target: rounding to them, and their rounding errors. See docs/method/emit.md.

use crate::base::{Ball, Dd, Number};

/// The floating-point format of emitted code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    Double,
    Single,
}

impl Precision {
    /// The nearest number of the target, as a double.
    pub fn round(self, x: Dd) -> f64 {
        match self {
            Precision::Double => x.to_f64() + 0.0,
            Precision::Single => f64::from(x.to_f64() as f32) + 0.0,
        }
    }

    /// The name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Precision::Double => "double",
            Precision::Single => "single",
        }
    }

    /// The smallest normal number: smaller ones have fewer digits.
    pub fn least(self) -> f64 {
        match self {
            Precision::Double => f64::MIN_POSITIVE,
            Precision::Single => f64::from(f32::MIN_POSITIVE),
        }
    }

    /// Whether the largest of these numbers, unless all are zero, keeps all its digits.
    pub fn keeps(self, numbers: impl IntoIterator<Item = Dd>) -> bool {
        let largest = numbers.into_iter().map(|x| x.hi.abs()).fold(0.0, f64::max);
        largest == 0.0 || self.round(Dd::from(largest)) >= self.least()
    }

    /// The next larger number in magnitude.
    pub fn next(self, x: f64) -> f64 {
        match self {
            Precision::Double => f64::from_bits(x.to_bits() + 1),
            Precision::Single => f64::from(f32::from_bits((x as f32).to_bits() + 1)),
        }
    }

    /// Relative error of one rounding.
    pub fn unit(self) -> f64 {
        match self {
            Precision::Double => f64::EPSILON / 2.0,
            Precision::Single => f64::from(f32::EPSILON) / 2.0,
        }
    }
}

/// exp(x) - 1 without cancellation; `None` if out of range.
pub fn exp_minus_one(x: Dd) -> Option<Dd> {
    if x.hi < -700.0 {
        return Some(-Dd::ONE);
    }
    if x.hi.abs() > 0.03 {
        return Some(Number::Ball(Ball::exact(x)).exp()?.to_ball().mid - Dd::ONE);
    }
    // The remainder after fifteen terms is 0.03^15 / 16! of the first.
    let (mut term, mut sum) = (x, x);
    for i in 2..=15 {
        term = term * x / Dd::from(f64::from(i));
        sum += term;
    }
    Some(sum)
}
