//! Exact numbers that are a rational number or a surd times a power of pi: angles in degrees, frequencies in rad/s, and the
//! squares of both. Two such numbers of the same power cancel exactly; pi is transcendental (F. Lindemann, Math. Ann. 20,
//! 1882, 213-225), so that none of them is zero.

use super::{Ball, Number, Rational};

/// factor pi^power
#[derive(Clone, Debug, PartialEq)]
pub struct PiPower {
    /// A rational number or a surd, not zero.
    factor: Number,
    /// Not zero.
    power: i32,
}

/// Powers beyond this one are enclosed.
const MOST: u32 = 64;

impl PiPower {
    /// factor pi^power as a number, exact if the factor is.
    pub(super) fn number(factor: Number, power: i32) -> Number {
        match factor {
            factor if power == 0 || factor.is_zero() => factor,
            factor @ (Number::Exact(_) | Number::Surd(_)) if power.unsigned_abs() <= MOST => {
                Number::Pi(Box::new(PiPower { factor, power }))
            }
            factor => Number::Ball(times_power(factor.to_ball(), power)),
        }
    }

    pub fn factor(&self) -> &Number {
        &self.factor
    }

    pub fn power(&self) -> i32 {
        self.power
    }

    pub(super) fn to_ball(&self) -> Ball {
        times_power(self.factor.to_ball(), self.power)
    }

    /// The power of pi alone.
    pub fn power_of_pi(&self) -> Ball {
        let size = size_of(self.power);
        if self.power < 0 { Ball::ONE / size } else { size }
    }

    /// The fraction of which this is the product with pi.
    pub fn fraction_of_pi(&self) -> Option<&Rational> {
        self.factor.exact().filter(|_| self.power == 1)
    }
}

impl Number {
    /// self pi^power, exact if self is.
    pub fn times_power_of_pi(&self, power: i32) -> Number {
        if power == 0 { self.clone() } else { self * &PiPower::number(Number::ONE, power) }
    }

    /// The rational number and the power of pi of which this is the product.
    pub fn rational_and_power_of_pi(&self) -> Option<(&Rational, i32)> {
        let (factor, power) = split(self);
        Some((factor.exact()?, power))
    }
}

fn times_power(factor: Ball, power: i32) -> Ball {
    let size = size_of(power);
    if power < 0 { factor / size } else { factor * size }
}

/// pi to the size of a power that is not zero.
fn size_of(power: i32) -> Ball {
    (1..power.unsigned_abs()).fold(Ball::PI, |product, _| product * Ball::PI)
}

/// A number as a factor and a power of pi.
fn split(number: &Number) -> (&Number, i32) {
    match number {
        Number::Pi(pi) => (&pi.factor, pi.power),
        other => (other, 0),
    }
}

/// The product of two numbers that are no jets, one of them with a power of pi.
pub(super) fn product(a: &Number, b: &Number) -> Number {
    let ((a, m), (b, n)) = (split(a), split(b));
    PiPower::number(a * b, m + n)
}

/// The quotient of two numbers that are no jets, one of them with a power of pi.
pub(super) fn quotient(a: &Number, b: &Number) -> Number {
    let ((a, m), (b, n)) = (split(a), split(b));
    PiPower::number(a / b, m - n)
}

/// An integer power; `None` if the power of pi is too large.
pub(super) fn pow(number: &PiPower, exponent: i32) -> Option<Number> {
    let power = number.power.checked_mul(exponent).filter(|power| power.unsigned_abs() <= MOST)?;
    Some(PiPower::number(number.factor.powi(exponent)?, power))
}

/// The root of a positive number with a power of pi.
pub(super) fn root(number: &PiPower) -> Option<Number> {
    let half = number.power / 2;
    let root = number.factor.sqrt()?;
    match number.power % 2 {
        0 => Some(PiPower::number(root, half)),
        _ => Some(Number::Ball(number.to_ball().sqrt())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(text: &str) -> Number {
        Number::from(text)
    }

    #[test]
    fn powers_of_pi_cancel_exactly() {
        let omega = &Number::pi() * &number("2.5");
        let k = &omega.square() * &number("3");
        assert_eq!(&k - &(&omega.square() * &number("3")), Number::ZERO);
        assert_eq!((&k / &number("3")).sqrt(), Some(omega.clone()));
        assert_eq!(&k / &omega.square(), number("3"));
        assert_eq!(&(&number("7") / &k) * &k, number("7"));
        assert_eq!((&omega * &omega.recip().expect("not zero")), Number::ONE);
        // With a surd: (pi sqrt 2)^2 = 2 pi^2.
        let diagonal = &number("2").sqrt().expect("positive") * &Number::pi();
        assert_eq!(diagonal.square(), &number("2") * &Number::pi().square());
        assert!((-&diagonal).is_negative() && !diagonal.may_be_zero());
        assert_eq!((&Number::ZERO / &diagonal), Number::ZERO);
    }

    /// pi^2 and 1/pi^3 to 20 digits (mpmath).
    #[test]
    fn enclosures_of_powers_hold_the_value() {
        let near = |value: &Number, text: &str| {
            let off = value - &number(text);
            assert!(off.to_f64().abs() < 1e-19, "{value:?}");
        };
        near(&Number::pi().square(), "9.8696044010893586188");
        near(&Number::pi().powi(-3).expect("a number"), "0.032251534433199489184");
        assert!(matches!(Number::pi().powi(200), Some(Number::Ball(_))));
    }
}
