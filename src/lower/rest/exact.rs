//! The simplest fraction near a number: if a rest found to thirty digits is a fraction of small numbers at all, it is
//! that fraction, which exact arithmetic then proves. See docs/method/rest.md.

use crate::base::{Ball, Rational};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::One;

/// Numerator and denominator below 2^40: with the hundred bits that are known, another number has such a fraction by
/// chance once in 2^20 cases, and is then rejected by the proof.
const MAX_BITS: u64 = 40;

/// The fraction with the least denominator within a ball, or within the relative distance `known` if that is wider;
/// `None` if it is not a fraction of small numbers.
pub fn simplest(ball: Ball, known: f64) -> Option<Rational> {
    let middle = &Rational::from_f64(ball.mid.hi)? + &Rational::from_f64(ball.mid.lo)?;
    let radius = Rational::from_f64(ball.rad.max(ball.mid.hi.abs() * known))?;
    let (low, high) = ((&middle - &radius).to_big(), (&middle + &radius).to_big());
    let found = if middle.signum() < 0 { -simplest_between(-high, -low)? } else { simplest_between(low, high)? };
    let small = found.numer().bits() <= MAX_BITS && found.denom().bits() <= MAX_BITS;
    small.then(|| Rational::from(found))
}

/// The simplest fraction in [low, high], 0 <= low: descent in the Stern-Brocot tree by continued fractions.
fn simplest_between(mut low: BigRational, mut high: BigRational) -> Option<BigRational> {
    let mut quotients: Vec<BigInt> = Vec::new();
    // Each quotient removes at least one bit from the denominator, and two steps remove more.
    for _ in 0..2 * MAX_BITS {
        let floor = low.floor();
        if floor == low || floor < high.floor() {
            let last = if floor == low { floor } else { floor + BigRational::one() };
            return Some(quotients.into_iter().rev().fold(last, |rest, q| BigRational::from(q) + rest.recip()));
        }
        quotients.push(floor.to_integer());
        let (rest_low, rest_high) = (&low - &floor, &high - &floor);
        low = rest_high.recip();
        high = rest_low.recip();
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Number;

    #[test]
    fn a_fraction_is_found_from_its_digits() {
        for (n, d) in [(981, 200), (-2, 3), (1, 1), (-981_000, 7), (1, 1_000_003)] {
            let ball = Number::from(Rational::new(n, d)).to_ball();
            assert_eq!(simplest(ball, 1e-28), Some(Rational::new(n, d)));
        }
    }

    #[test]
    fn an_irrational_number_is_none() {
        assert_eq!(simplest(Ball::from(2.0).sqrt(), 1e-28), None);
    }
}
