//! Correctly rounded decimals of rational numbers, double-doubles and balls.
//!
//! A double-double is a fraction too, with a power of two as its denominator. The fraction is scaled by a power of ten
//! and divided as integers, so the digits are those of the exact value, rounded half to even: the same on every
//! machine. Nothing else rounds numbers to decimals. See docs/method/report.md#numbers.

use crate::base::{Ball, Bound, Dd, Number, Power, Rational, Unproven};
use num_bigint::{BigInt, BigUint, Sign};
use num_integer::Integer;
use num_traits::{One, Zero};
use std::cmp::Ordering;

/// `0.d1 d2 d3 ... * 10^(exponent + 1)`: a number with its significant digits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decimal {
    negative: bool,
    /// Values from 0 to 9. The first digit is not 0, except in zero, whose digits are all 0.
    digits: Vec<u8>,
    /// Power of ten of the first digit.
    exponent: i32,
    /// Whether the digits are the exact value.
    exact: bool,
}

impl Decimal {
    /// The value rounded to `digits` significant digits (at least one). The value is finite.
    pub fn round(value: Dd, digits: usize) -> Decimal {
        Decimal::of_fraction(&Fraction::of(value), digits)
    }

    /// An exact number rounded to `digits` significant digits.
    pub fn round_rational(value: &Rational, digits: usize) -> Decimal {
        let value = value.to_big();
        Decimal::of_fraction(
            &Fraction { numerator: value.numer().clone(), denominator: value.denom().magnitude().clone() },
            digits,
        )
    }

    fn of_fraction(value: &Fraction, digits: usize) -> Decimal {
        let digits = digits.max(1);
        if value.numerator.is_zero() {
            return Decimal { negative: false, digits: vec![0; digits], exponent: 0, exact: true };
        }
        let exponent = value.exponent();
        let (mut rounded, exact) = value.scale(digits as i64 - 1 - exponent);
        let mut exponent = exponent as i32;
        if rounded == ten_to(digits as i64) {
            // 9.99 became 10.0.
            rounded = ten_to(digits as i64 - 1);
            exponent += 1;
        }
        let negative = value.numerator.sign() == Sign::Minus;
        Decimal { negative, digits: rounded.to_radix_be(10), exponent, exact }
    }

    /// Removes zeros at the end if they follow from an exact value: `1.5`, but `1.5000` for 1.50001.
    pub fn trim(mut self) -> Decimal {
        while self.exact && self.digits.len() > 1 && self.digits.last() == Some(&0) {
            self.digits.pop();
        }
        self
    }

    /// `0.343485`, `-12.5`, `1200`; with a power of ten (`3.1e-7`) if the plain form would hide the digits in zeros.
    pub fn text(&self) -> String {
        let sign = if self.negative { "-" } else { "" };
        let digits: String = self.digits.iter().map(|digit| char::from(b'0' + digit)).collect();
        let count = digits.len() as i32;
        match self.exponent {
            exponent @ 0.. if exponent < count => {
                let (whole, fraction) = digits.split_at(exponent as usize + 1);
                format!("{sign}{whole}{}{fraction}", if fraction.is_empty() { "" } else { "." })
            }
            // Zeros at the end of an exact integer are true digits.
            exponent @ 0..PLAIN if self.exact => {
                format!("{sign}{digits}{}", "0".repeat((exponent + 1 - count) as usize))
            }
            exponent @ -4..0 => format!("{sign}0.{}{digits}", "0".repeat((-exponent - 1) as usize)),
            _ => self.scientific(),
        }
    }

    /// Scientific notation, such as `3.1e-7`.
    pub fn scientific(&self) -> String {
        let sign = if self.negative { "-" } else { "" };
        let digits: String = self.digits.iter().map(|digit| char::from(b'0' + digit)).collect();
        let (first, rest) = digits.split_at(1);
        format!("{sign}{first}{}{rest}e{}", if rest.is_empty() { "" } else { "." }, self.exponent)
    }
}

/// Integers from 10^PLAIN on are shown with a power of ten.
const PLAIN: i32 = 9;

/// At most `most` significant digits of a ball: those that its radius determines. `≤ 3e-9` if it determines none, and
/// `?` if nothing is known.
pub fn certain(value: &Ball, most: usize) -> String {
    if !value.is_finite() {
        return "?".into();
    }
    if value.is_zero() {
        return "0".into();
    }
    match certain_digits(value).min(most) {
        0 => format!("≤ {}", upper(Bound::size(*value))),
        digits if value.is_exact() => Decimal::round(value.mid, digits).trim().text(),
        digits => Decimal::round(value.mid, digits).text(),
    }
}

/// Like [`certain`], for a number that may be exact: all its digits are then certain.
pub fn certain_number(value: &Number, most: usize) -> String {
    // An integer with so few digits is its own decimal.
    let is_short = |integer: &i64| integer.unsigned_abs() < 10u64.pow(most.min(PLAIN as usize) as u32);
    match value {
        Number::Exact(value) => match value.to_i64().filter(is_short) {
            Some(integer) => integer.to_string(),
            None => Decimal::round_rational(value, most).trim().text(),
        },
        Number::Surd(_) | Number::Pi(_) | Number::Ball(_) | Number::Jet(_) => certain(&value.to_ball(), most),
    }
}

/// Like [`certain_number`], with every digit before the decimal point unless there are too many: `103168` rather than `1.0317e5`.
pub fn certain_whole(value: &Number, most: usize) -> String {
    let size = value.to_f64().abs();
    let whole = (most..=WHOLE).find(|digits| size < 10f64.power(*digits as i32)).unwrap_or(most);
    certain_number(value, whole)
}

/// Like [`certain_number`], but always with a power of ten: `-5e8`; zero stays `0`.
pub fn certain_scientific(value: &Number, most: usize) -> String {
    let digits = if value.exact().is_some() { most } else { certain_digits(&value.to_ball()).min(most) };
    match value {
        value if value.is_zero() || digits == 0 || !value.to_ball().is_finite() => certain_number(value, most),
        Number::Exact(value) => Decimal::round_rational(value, digits).trim().scientific(),
        value => Decimal::round(value.to_ball().mid, digits).scientific(),
    }
}

/// Digits before the decimal point that are shown without a power of ten.
const WHOLE: usize = 8;

/// The number of significant digits that a radius settles: |x - mid| is at most half a unit of the last one.
pub fn certain_digits(value: &Ball) -> usize {
    let error = value.relative_error();
    let mut bound = 0.05;
    let mut digits = 0;
    while digits < MOST_DIGITS && error <= bound {
        digits += 1;
        bound *= 0.1;
    }
    digits
}

/// A number without a bound, rounded to a number of significant digits; `?` if it is not finite.
pub fn round_unproven(Unproven(number): Unproven, digits: usize) -> String {
    match number {
        0.0 => "0".into(),
        number if number.is_finite() => Decimal::round(Dd::from(number), digits).text(),
        _ => "?".into(),
    }
}

/// The most digits of a double-double.
const MOST_DIGITS: usize = 32;

/// An upper bound in one digit: `3e-16`. Exact zero is `0`.
pub fn upper(bound: Bound) -> String {
    let bound = bound.value();
    if bound == 0.0 {
        return "0".into();
    }
    if !bound.is_finite() {
        return "?".into();
    }
    let rounded = Decimal::round(Dd::from(bound), 1);
    let (mut digit, mut exponent) = (rounded.digits[0], rounded.exponent);
    if rounded.compare(bound) == Ordering::Less {
        digit += 1;
    }
    if digit == 10 {
        (digit, exponent) = (1, exponent + 1);
    }
    format!("{digit}e{exponent}")
}

impl Decimal {
    /// Compares the decimal with a number, exactly.
    fn compare(&self, value: f64) -> Ordering {
        let number = self.digits.iter().fold(BigInt::zero(), |n, digit| n * 10 + i32::from(*digit));
        let number = if self.negative { -number } else { number };
        let ten = i64::from(self.exponent) + 1 - self.digits.len() as i64;
        let value = Fraction::of(Dd::from(value));
        let left = number * BigInt::from(ten_to(ten) * value.denominator);
        left.cmp(&(value.numerator * BigInt::from(ten_to(-ten))))
    }
}

/// A rational number; the denominator is positive.
struct Fraction {
    numerator: BigInt,
    denominator: BigUint,
}

impl Fraction {
    /// The exact value of a finite double-double.
    fn of(value: Dd) -> Fraction {
        let ((high, high_power), (low, low_power)) = (parts(value.hi), parts(value.lo));
        let power = if low == 0 { high_power } else { high_power.min(low_power) };
        let low = if low == 0 { BigInt::zero() } else { BigInt::from(low) << (low_power - power) };
        let mantissa = (BigInt::from(high) << (high_power - power)) + low;
        Fraction { numerator: mantissa << power.max(0), denominator: BigUint::one() << (-power).max(0) }
    }

    /// The power of ten of the first digit; the value is not zero.
    fn exponent(&self) -> i64 {
        // The value is more than 2^(bits - 1). 0.30103 is log10(2) to 5e-9, and what is taken off in hundred-thousandths is
        // more than that for each bit: so the start is never too large, and within the range of binary64 too small by one
        // at most.
        let bits = self.numerator.bits() as i64 - self.denominator.bits() as i64;
        let mut exponent = ((bits - 1) * 30103 - 1 - bits.abs() / 1000).div_euclid(100_000);
        while self.reaches(exponent + 1) {
            exponent += 1;
        }
        exponent
    }

    /// Whether the magnitude is at least 10^exponent.
    fn reaches(&self, exponent: i64) -> bool {
        self.numerator.magnitude() * ten_to(-exponent) >= &self.denominator * ten_to(exponent)
    }

    /// The magnitude times 10^ten, rounded half to even to an integer, and whether that was exact.
    fn scale(&self, ten: i64) -> (BigUint, bool) {
        let denominator = &self.denominator * ten_to(-ten);
        let (quotient, rest) = (self.numerator.magnitude() * ten_to(ten)).div_rem(&denominator);
        let up = match (&rest * 2u32).cmp(&denominator) {
            Ordering::Less => false,
            Ordering::Equal => quotient.is_odd(),
            Ordering::Greater => true,
        };
        (quotient + u32::from(up), rest.is_zero())
    }
}

/// A finite binary64 number as mantissa * 2^power.
fn parts(x: f64) -> (i64, i64) {
    let bits = x.to_bits();
    let biased = (bits >> 52 & 0x7ff) as i64;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let (mantissa, power) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    (if x < 0.0 { -mantissa } else { mantissa }, power)
}

/// 10^power; 1 for a negative power, which then appears in the other factor.
fn ten_to(power: i64) -> BigUint {
    BigUint::from(10u32).pow(power.max(0) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn text(value: f64, digits: usize) -> String {
        Decimal::round(Dd::from(value), digits).text()
    }

    #[test]
    fn digits_are_those_of_the_exact_value() {
        assert_eq!(text(0.1, 20), "0.10000000000000000555");
        assert_eq!(text(2.5, 1), "2");
        assert_eq!(text(3.5, 1), "4");
        assert_eq!(text(9.9996, 4), "10.00");
        assert_eq!(text(-0.000_999_96, 4), "-0.001000");
        assert_eq!(text(5e-324, 3), "4.94e-324");
        assert_eq!(text(f64::MAX, 5), "1.7977e308");
        assert_eq!(text(0.0, 3), "0.00");
        assert_eq!(Decimal::round(Dd::PI, 32).text(), "3.1415926535897932384626433832795");
    }

    #[test]
    fn a_power_of_ten_is_used_where_zeros_would_hide_the_digits() {
        assert_eq!(text(1234.0, 6), "1234.00");
        assert_eq!(Decimal::round(Dd::from(1200.0), 2).text(), "1200");
        assert_eq!(text(123_456.0, 2), "1.2e5");
        assert_eq!(text(0.000_123_4, 3), "0.000123");
        assert_eq!(text(0.000_012_34, 3), "1.23e-5");
        assert_eq!(text(2.73e5, 3), "273000");
        assert_eq!(text(3e24, 3), "3.00e24");
    }

    #[test]
    fn exact_values_lose_their_zeros_and_no_others_do() {
        assert_eq!(Decimal::round(Dd::from(1.5), 6).trim().text(), "1.5");
        assert_eq!(Decimal::round(Dd::from(10.0), 6).trim().text(), "10");
        assert_eq!(Decimal::round(Dd::from(1.500_000_001), 6).trim().text(), "1.50000");
        assert_eq!(Decimal::round(Dd::ZERO, 6).trim().text(), "0");
        assert_eq!(certain_number(&Number::Exact(Rational::new(4905, 1000)), 6), "4.905");
        assert_eq!(certain_number(&Number::Exact(Rational::new(-2, 3)), 6), "-0.666667");
        assert_eq!(certain_whole(&Number::Exact(Rational::new(-1_031_684, 10)), 5), "-103168");
        assert_eq!(certain_whole(&Number::Exact(Rational::new(1_031_684_000, 1)), 5), "1.0317e9");
    }

    #[test]
    fn only_settled_digits_are_shown() {
        let third = Ball::ONE / Ball::from(3.0);
        assert_eq!(certain(&third, 6), "0.333333");
        assert_eq!(certain(&Ball::new(Dd::from(0.5), 1e-4), 6), "0.500");
        assert_eq!(certain(&Ball::new(Dd::from(1e-20), 3e-9), 6), "≤ 4e-9");
        assert_eq!(certain(&Ball::new(Dd::ONE, f64::INFINITY), 6), "?");
        assert_eq!(certain(&Ball::ZERO, 6), "0");
        assert_eq!(certain(&Ball::from(10.0), 6), "10");
    }

    #[test]
    fn bounds_are_rounded_up() {
        assert_eq!(upper(Bound::by_proof(2.220446e-16)), "3e-16");
        assert_eq!(upper(Bound::by_proof(9.5e-16)), "1e-15");
        assert_eq!(upper(Bound::by_proof(0.25)), "3e-1");
        assert_eq!(upper(Bound::by_proof(4.0)), "4e0");
        assert_eq!(upper(Bound::by_proof(0.0)), "0");
    }

    proptest! {
        /// The standard library's formatting of binary64 is exact too: an independent source of the same digits.
        #[test]
        fn it_agrees_with_the_standard_library(bits in any::<u64>(), digits in 1usize..25) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite() && value != 0.0);
            let ours = Decimal::round(Dd::from(value), digits);
            let (mantissa, exponent) = {
                let theirs = format!("{value:.*e}", digits - 1);
                let (m, e) = theirs.split_once('e').map(|(m, e)| (m.to_string(), e.to_string())).unwrap_or_default();
                (m.replace(['-', '.'], ""), e)
            };
            prop_assert_eq!(ours.digits.iter().map(|d| char::from(b'0' + d)).collect::<String>(), mantissa);
            prop_assert_eq!(ours.exponent.to_string(), exponent);
        }

        #[test]
        fn an_upper_bound_is_above_by_less_than_one_digit(bits in any::<u64>()) {
            let value = f64::from_bits(bits).abs();
            prop_assume!(value.is_finite() && value > 1e-300 && value < 1e300);
            let shown: f64 = upper(Bound::by_proof(value)).parse().unwrap_or(0.0);
            prop_assert!(shown * (1.0 + 1e-15) >= value && shown <= value * 2.0 * (1.0 + 1e-15));
        }
    }
}
