//! The simplest fraction near a number: if a rest found to thirty digits is a fraction of small numbers at all, it is
//! that fraction, which exact arithmetic then proves. See docs/method/rest.md.

use crate::base::{Ball, Rational};
use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::float::FloatCore;
use num_traits::{Signed, ToPrimitive, Zero};

/// Numerator and denominator below 2^40: with the hundred bits that are known, another number has such a fraction by
/// chance once in 2^20 cases, and is then rejected by the proof.
const MAX_BITS: u64 = 40;

/// The fraction with the least denominator within a ball, or within the relative distance `known` if that is wider;
/// `None` if it is not a fraction of small numbers.
pub fn simplest(ball: Ball, known: f64) -> Option<Rational> {
    let parts = [ball.mid.hi, ball.mid.lo, ball.rad.max(ball.mid.hi.abs() * known)];
    let [hi, lo, radius] = parts.map(|x| x.is_finite().then(|| x.integer_decode()));
    // All three as whole numbers times one power of two.
    let least = [hi?, lo?, radius?].iter().filter(|(mantissa, ..)| *mantissa != 0).map(|(_, power, _)| *power).min();
    let Some(least) = least else { return Some(Rational::ZERO) };
    let whole = |(mantissa, power, sign): (u64, i16, i8)| {
        let shift = if mantissa == 0 { 0 } else { power - least };
        (BigInt::from(mantissa) * i64::from(sign)) << shift as u64
    };
    let (middle, radius) = (whole(hi?) + whole(lo?), whole(radius?));
    let power = BigInt::from(1) << i32::from(least).unsigned_abs();
    let fraction = |x: BigInt| if least < 0 { (x, power.clone()) } else { (x * &power, BigInt::from(1)) };
    let (low, high) = (&middle - &radius, &middle + &radius);
    if !low.is_positive() && !high.is_negative() {
        return Some(Rational::ZERO);
    }
    match middle.is_negative() {
        true => simplest_between(fraction(-high), fraction(-low)).map(|found| -&found),
        false => simplest_between(fraction(low), fraction(high)),
    }
}

/// The simplest fraction in [low, high], 0 <= low: descent in the Stern-Brocot tree by continued fractions. Fractions of integers that
/// are not reduced have the same quotients, and need no common divisors.
fn simplest_between(mut low: (BigInt, BigInt), mut high: (BigInt, BigInt)) -> Option<Rational> {
    // Numerator and denominator of the last two convergents: those of the result are no smaller.
    let (mut last, mut before) = ([1u128, 0], [0, 1]);
    loop {
        let (floor, rest) = low.0.div_rem(&low.1);
        let (floor_of_high, rest_of_high) = high.0.div_rem(&high.1);
        let is_found = rest.is_zero() || floor < floor_of_high;
        let quotient = floor.to_u64()? + u64::from(is_found && !rest.is_zero());
        let next =
            |i: usize| Some(last[i].checked_mul(u128::from(quotient))? + before[i]).filter(|x| x >> MAX_BITS == 0);
        let convergent = [next(0)?, next(1)?];
        if is_found {
            return Some(Rational::new(convergent[0] as i64, convergent[1] as i64));
        }
        (before, last) = (last, convergent);
        (low, high) = ((high.1, rest_of_high), (low.1, rest));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Number;

    #[test]
    fn a_fraction_is_found_from_its_digits() {
        let largest = (1 << MAX_BITS) - 1;
        let list = [(981, 200), (-2, 3), (1, 1), (-981_000, 7), (1, 1_000_003), (largest, largest - 2), (0, 1)];
        for (n, d) in list {
            let ball = Number::from(Rational::new(n, d)).to_ball();
            assert_eq!(simplest(ball, 1e-28), Some(Rational::new(n, d)));
        }
    }

    /// Beside all fractions in the order of their denominators.
    #[test]
    fn no_fraction_within_the_distance_is_simpler() {
        for (x, known) in
            [(0.3, 1e-1), (0.3, 1e-3), (2.7, 1e-4), (1.414, 1e-3), (-0.0123, 1e-2), (7.99, 1e-2), (1e-3, 0.3)]
        {
            let fits = |n: i64, d: i64| (n as f64 / d as f64 - x).abs() <= x.abs() * known;
            let by_denominator = (1..).find_map(|d| (-10 * d..10 * d).find(|n| fits(*n, d)).map(|n| (n, d)));
            let found = simplest(Ball::from(x), known).and_then(|found| found.to_fraction()).expect("small");
            assert_eq!(Some(found.1), by_denominator.map(|(_, d)| d), "{x}: {found:?} {by_denominator:?}");
            assert!(fits(found.0, found.1), "{x}: {found:?}");
        }
    }

    #[test]
    fn zero_is_the_simplest_of_all() {
        for ball in
            [Ball::new(1e-30.into(), 2e-30), Ball::new((-1e-30).into(), 1e-30), Ball::ZERO, Ball::new(0.5.into(), 0.5)]
        {
            assert_eq!(simplest(ball, 0.0), Some(Rational::ZERO), "{ball:?}");
        }
        // 1 / (1e-9 + 1e-12) lies just above 999 000 999.
        assert_eq!(simplest(Ball::new(1e-9.into(), 1e-12), 0.0), Some(Rational::new(1, 999_001_000)));
        assert_eq!(simplest(Ball::new(f64::NAN.into(), 0.0), 0.0), None);
    }

    #[test]
    fn an_irrational_number_is_none() {
        assert_eq!(simplest(Ball::from(2.0).sqrt(), 1e-28), None);
        // A numerator and a denominator that are too large.
        assert_eq!(simplest(Number::from(1 << (MAX_BITS + 1)).to_ball(), 1e-28), None);
        assert_eq!(simplest((&Number::ONE / &Number::from((1 << MAX_BITS) + 1)).to_ball(), 1e-28), None);
    }
}
