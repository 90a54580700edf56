//! Exact rational numbers: a machine fraction if it fits, a big one otherwise.
//!
//! Literals are decimal fractions and most arithmetic on them stays small, so the fast path allocates no memory. The
//! representation is canonical (lowest terms, positive denominator, small whenever it fits), so `==` compares values.

use super::ball::Ball;
use super::dd::Dd;
use super::two_to;
use num_bigint::{BigInt, Sign};
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// An exact rational number.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Rational(Repr);

#[derive(Debug, PartialEq, Eq, Hash)]
enum Repr {
    Small(i64, i64),
    Big(Box<BigRational>),
}

impl Clone for Repr {
    /// A copy for nearly all; only big fractions are a call.
    #[inline]
    fn clone(&self) -> Repr {
        match self {
            Repr::Small(n, d) => Repr::Small(*n, *d),
            Repr::Big(value) => copy_of_big(value),
        }
    }
}

#[cold]
fn copy_of_big(value: &BigRational) -> Repr {
    Repr::Big(Box::new(value.clone()))
}

/// The reading of literals.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Literals {
    /// A literal is the decimal fraction that it shows.
    #[default]
    Decimal,
    /// A literal is the nearest binary64 number, as in most programs.
    Binary64,
}

impl Rational {
    pub const ZERO: Rational = Rational(Repr::Small(0, 1));
    pub const ONE: Rational = Rational(Repr::Small(1, 1));

    /// numerator / denominator in lowest terms. The denominator is not zero.
    pub fn new(numerator: i64, denominator: i64) -> Rational {
        Rational::from_i128(numerator as i128, denominator as i128)
    }

    fn from_i128(numerator: i128, denominator: i128) -> Rational {
        assert!(denominator != 0, "a fraction has a denominator: callers divide by what they have checked");
        if numerator == 0 {
            return Rational::ZERO;
        }
        if let (Ok(n), Ok(d)) = (i64::try_from(numerator), i64::try_from(denominator))
            && n != i64::MIN
            && d != i64::MIN
        {
            // Words of 64 bits divide several times as fast.
            let divisor = if d == 1 { 1 } else { d.signum() * n.gcd(&d) };
            return Rational(Repr::Small(n / divisor, d / divisor));
        }
        let divisor =
            if denominator == 1 { 1 } else { gcd(numerator.unsigned_abs(), denominator.unsigned_abs()) as i128 };
        let sign = denominator.signum();
        let (n, d) = (sign * numerator / divisor, sign * denominator / divisor);
        match (i64::try_from(n), i64::try_from(d)) {
            (Ok(n), Ok(d)) => Rational(Repr::Small(n, d)),
            _ => Rational(Repr::Big(Box::new(BigRational::new_raw(n.into(), d.into())))),
        }
    }

    fn from_big(value: BigRational) -> Rational {
        match (value.numer().to_i64(), value.denom().to_i64()) {
            (Some(n), Some(d)) => Rational(Repr::Small(n, d)),
            _ => Rational(Repr::Big(Box::new(value))),
        }
    }

    /// The value of a decimal literal such as `9.81`, `1e-4`, `25`; `None` if the text is not one,
    /// or if its exponent is beyond +-`MAX_EXPONENT`.
    pub fn from_decimal(text: &str) -> Option<Rational> {
        let (mantissa, exponent) = match text.find(['e', 'E']) {
            Some(at) => (&text[..at], text[at + 1..].parse::<i64>().ok()?),
            None => (text, 0),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        if whole.len() + fraction.len() == 0 || !(whole.bytes().chain(fraction.bytes())).all(|b| b.is_ascii_digit()) {
            return None;
        }
        let scale = exponent.checked_sub(fraction.len() as i64)?;
        if scale.abs() > MAX_EXPONENT || whole.len() + fraction.len() > MAX_EXPONENT as usize {
            return None;
        }
        if whole.len() + fraction.len() <= 18 && scale.abs() <= 18 {
            let digits = whole.bytes().chain(fraction.bytes()).fold(0i64, |n, b| n * 10 + i64::from(b - b'0'));
            let power = 10i64.pow(scale.unsigned_abs() as u32);
            return Some(if scale < 0 {
                Rational::new(digits, power)
            } else {
                Rational::from_i128(digits as i128 * power as i128, 1)
            });
        }
        let digits: BigInt = format!("{whole}{fraction}").parse().ok()?;
        let power = BigInt::from(10).pow(scale.unsigned_abs() as u32);
        Some(Rational::from_big(if scale < 0 {
            BigRational::new(digits, power)
        } else {
            BigRational::from_integer(digits * power)
        }))
    }

    /// The value of a literal in one of the two readings; `None` also where binary64 overflows.
    pub fn from_literal(text: &str, literals: Literals) -> Option<Rational> {
        let decimal = Rational::from_decimal(text)?;
        match literals {
            Literals::Decimal => Some(decimal),
            Literals::Binary64 => Rational::from_f64(text.parse().ok()?),
        }
    }

    /// The exact value of a finite binary64 number; `None` for infinities and NaN.
    pub fn from_f64(x: f64) -> Option<Rational> {
        if !x.is_finite() {
            return None;
        }
        // An odd number times a power of two is in lowest terms.
        let bits = x.to_bits();
        let (exponent, fraction) = (((bits >> 52) & 0x7ff) as i32, (bits & ((1 << 52) - 1)) as i64);
        if exponent > 0 {
            let mantissa = fraction | (1 << 52);
            let odd = mantissa >> mantissa.trailing_zeros();
            let power = exponent - 1075 + mantissa.trailing_zeros() as i32;
            let signed = if x < 0.0 { -odd } else { odd };
            match power {
                -62..0 => return Some(Rational(Repr::Small(signed, 1 << -power))),
                0..10 => return Some(Rational(Repr::Small(signed << power, 1))),
                _ => {}
            }
        }
        BigRational::from_float(x).map(Rational::from_big)
    }

    pub fn to_big(&self) -> BigRational {
        match &self.0 {
            Repr::Small(n, d) => BigRational::new_raw((*n).into(), (*d).into()),
            Repr::Big(value) => (**value).clone(),
        }
    }

    #[inline]
    pub fn is_zero(&self) -> bool {
        self.0 == Repr::Small(0, 1)
    }

    #[inline]
    pub fn is_one(&self) -> bool {
        self.0 == Repr::Small(1, 1)
    }

    /// -1, 0 or 1.
    pub fn signum(&self) -> i32 {
        match &self.0 {
            Repr::Small(n, _) => n.signum() as i32,
            Repr::Big(value) => {
                if value.is_zero() {
                    0
                } else if value.is_negative() {
                    -1
                } else {
                    1
                }
            }
        }
    }

    pub fn is_integer(&self) -> bool {
        match &self.0 {
            Repr::Small(_, d) => *d == 1,
            Repr::Big(value) => value.is_integer(),
        }
    }

    /// The largest whole number that is not above it.
    pub fn floor(&self) -> Rational {
        match &self.0 {
            Repr::Small(n, d) => Rational::from(n.div_euclid(*d)),
            Repr::Big(value) => Rational::from_big(value.floor()),
        }
    }

    /// The value as a machine integer, if it is one that fits.
    pub fn to_i64(&self) -> Option<i64> {
        match &self.0 {
            Repr::Small(n, 1) => Some(*n),
            _ => None,
        }
    }

    /// Numerator and denominator, if both are machine integers.
    pub fn to_fraction(&self) -> Option<(i64, i64)> {
        match &self.0 {
            Repr::Small(n, d) => Some((*n, *d)),
            Repr::Big(_) => None,
        }
    }

    /// Number of bits in the numerator and the denominator together, a measure of the number's cost.
    pub fn bits(&self) -> u64 {
        match &self.0 {
            Repr::Small(..) => 64,
            Repr::Big(value) => value.numer().bits() + value.denom().bits(),
        }
    }

    /// The power of two below or above which the magnitude is by less than a factor of two.
    pub fn floor_log2(&self) -> i32 {
        let bits = |x: i64| (64 - x.unsigned_abs().leading_zeros()) as i32;
        match &self.0 {
            Repr::Small(n, d) => bits(*n) - bits(*d),
            Repr::Big(value) => (value.numer().bits() as i64 - value.denom().bits() as i64) as i32,
        }
    }

    /// Numerator and denominator modulo a prime below 2^62.
    pub fn residues(&self, prime: u64) -> (u64, u64) {
        match &self.0 {
            Repr::Small(n, d) => (n.rem_euclid(prime as i64) as u64, *d as u64 % prime),
            Repr::Big(value) => {
                let modulo = |x: &BigInt| x.mod_floor(&prime.into()).to_u64().unwrap_or(0);
                (modulo(value.numer()), modulo(value.denom()))
            }
        }
    }

    /// 1 / self; `None` for zero.
    pub fn recip(&self) -> Option<Rational> {
        match &self.0 {
            Repr::Small(0, _) => None,
            Repr::Small(n, d) => Some(Rational::from_i128(*d as i128, *n as i128)),
            Repr::Big(value) => Some(Rational::from_big(value.recip())),
        }
    }

    /// self^power; `None` for a negative power of zero or a result of more than `limit` bits.
    pub fn pow(&self, power: i32, limit: u64) -> Option<Rational> {
        let bits = match &self.0 {
            Repr::Small(n, d) => u64::from(128 - n.unsigned_abs().leading_zeros() - d.unsigned_abs().leading_zeros()),
            Repr::Big(_) => self.bits(),
        };
        if bits.saturating_mul(u64::from(power.unsigned_abs())) > limit.max(128) && !self.is_one() && !self.is_zero() {
            return None;
        }
        let raised = Rational::from_big(num_traits::pow(self.to_big(), power.unsigned_abs() as usize));
        if power < 0 { raised.recip() } else { Some(raised) }
    }

    /// The square root if it is rational.
    pub fn exact_sqrt(&self) -> Option<Rational> {
        if self.signum() < 0 {
            return None;
        }
        let big = self.to_big();
        let (n, d) = (big.numer().sqrt(), big.denom().sqrt());
        (&n * &n == *big.numer() && &d * &d == *big.denom()).then(|| Rational::from_big(BigRational::new_raw(n, d)))
    }

    /// The value as a ball of relative radius at most 2^-100; exact if the number is a double-double.
    pub fn to_ball(&self) -> Ball {
        match &self.0 {
            Repr::Small(n, 1) => Ball::exact(dd_from_i64(*n)),
            Repr::Small(n, d) => {
                let quotient = Ball::exact(dd_from_i64(*n)) / Ball::exact(dd_from_i64(*d));
                if d.count_ones() == 1 { Ball::exact(quotient.mid) } else { quotient }
            }
            Repr::Big(value) => big_to_ball(value),
        }
    }

    /// The nearest binary64 number; for big fractions, ties and the last bit are as double-double rounding leaves them.
    pub fn to_f64(&self) -> f64 {
        match &self.0 {
            // Both are exact in binary64 below 2^53: the quotient is correctly rounded.
            Repr::Small(n, d) if n.unsigned_abs() < 1 << 53 && *d < 1 << 53 => *n as f64 / *d as f64,
            _ => self.to_ball().to_f64(),
        }
    }
}

/// Largest power of ten that a literal may carry: far beyond binary64, small enough to stay cheap.
pub const MAX_EXPONENT: i64 = 400;

fn gcd(a: u128, b: u128) -> u128 {
    match (u64::try_from(a), u64::try_from(b)) {
        (Ok(a), Ok(b)) => a.gcd(&b) as u128,
        _ => a.gcd(&b),
    }
}

fn dd_from_i64(n: i64) -> Dd {
    let hi = n as f64;
    if n.unsigned_abs() < 1 << 53 {
        return Dd::from(hi);
    }
    Dd::new(hi, (n as i128 - hi as i128) as f64)
}

/// Long division to 128 bits, cut into three binary64 pieces of which two are kept.
fn big_to_ball(value: &BigRational) -> Ball {
    let shift = 128 - (value.numer().bits() as i64 - value.denom().bits() as i64);
    let (numerator, denominator) = if shift >= 0 {
        (value.numer() << shift as u64, value.denom().clone())
    } else {
        (value.numer().clone(), value.denom() << (-shift) as u64)
    };
    let (quotient, rest) = numerator.div_rem(&denominator);
    let magnitude = quotient.magnitude();
    // 127..=129 bits: the top ones as three pieces of at most 43 bits each, exact in binary64.
    let piece = |low: u64| -> f64 {
        let mask = (num_bigint::BigUint::one() << 43u32) - 1u32;
        ((magnitude >> low) & mask).to_f64().unwrap_or(0.0)
    };
    let mut mid = Dd::from(piece(86) * two_to(86));
    mid += Dd::from(piece(43) * two_to(43));
    mid += Dd::from(piece(0));
    let sign = if quotient.sign() == Sign::Minus { -1.0 } else { 1.0 };
    // Two scalings, so that neither power of two overflows before the result does.
    let half = -shift / 2;
    let mid = mid.scale(two_to(half)).scale(two_to(-shift - half)).scale(sign);
    if rest.is_zero() && magnitude.trailing_zeros().unwrap_or(0) + 106 >= magnitude.bits() && mid.hi.abs() > 1e-250 {
        return Ball::exact(mid);
    }
    Ball::new(mid, mid.hi.abs() * (4.0 * Dd::EPSILON) + 1e-318)
}

impl From<BigRational> for Rational {
    /// A fraction in lowest terms with positive denominator, as all of `BigRational`'s own operations make them.
    fn from(value: BigRational) -> Rational {
        Rational::from_big(value)
    }
}

impl From<i64> for Rational {
    fn from(n: i64) -> Rational {
        Rational(Repr::Small(n, 1))
    }
}

impl Neg for &Rational {
    type Output = Rational;
    fn neg(self) -> Rational {
        match &self.0 {
            // In lowest terms as it is.
            Repr::Small(n, d) if *n != i64::MIN => Rational(Repr::Small(-n, *d)),
            Repr::Small(n, d) => Rational::from_i128(-(*n as i128), *d as i128),
            Repr::Big(value) => Rational::from_big(-(**value).clone()),
        }
    }
}

impl Add for &Rational {
    type Output = Rational;
    fn add(self, other: &Rational) -> Rational {
        if let (Repr::Small(a, b), Repr::Small(c, d)) = (&self.0, &other.0) {
            if (*b, *d) == (1, 1)
                && let Some(sum) = a.checked_add(*c)
            {
                return Rational(Repr::Small(sum, 1));
            }
            let (a, b, c, d) = (*a as i128, *b as i128, *c as i128, *d as i128);
            if b == d {
                return Rational::from_i128(a + c, b);
            }
            // Each product is below 2^126 in size, so the sum is below 2^127.
            return Rational::from_i128(a * d + c * b, b * d);
        }
        Rational::from_big(self.to_big() + other.to_big())
    }
}

impl Sub for &Rational {
    type Output = Rational;
    fn sub(self, other: &Rational) -> Rational {
        if let (Repr::Small(a, b), Repr::Small(c, d)) = (&self.0, &other.0) {
            let (a, b, c, d) = (*a as i128, *b as i128, *c as i128, *d as i128);
            // As for sums.
            return if b == d { Rational::from_i128(a - c, b) } else { Rational::from_i128(a * d - c * b, b * d) };
        }
        Rational::from_big(self.to_big() - other.to_big())
    }
}

impl Mul for &Rational {
    type Output = Rational;
    fn mul(self, other: &Rational) -> Rational {
        if let (Repr::Small(a, b), Repr::Small(c, d)) = (&self.0, &other.0) {
            // Whole numbers, among them the components of most directions.
            if (*b, *d) == (1, 1)
                && let Some(product) = a.checked_mul(*c)
            {
                return Rational(Repr::Small(product, 1));
            }
            return Rational::from_i128(*a as i128 * *c as i128, *b as i128 * *d as i128);
        }
        Rational::from_big(self.to_big() * other.to_big())
    }
}

impl Div for &Rational {
    type Output = Rational;
    /// The quotient; panics for a zero divisor, which callers have checked.
    fn div(self, other: &Rational) -> Rational {
        if let (Repr::Small(a, b), Repr::Small(c, d)) = (&self.0, &other.0) {
            return Rational::from_i128(*a as i128 * *d as i128, *b as i128 * *c as i128);
        }
        Rational::from_big(self.to_big() / other.to_big())
    }
}

impl PartialOrd for Rational {
    fn partial_cmp(&self, other: &Rational) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Rational {
    fn cmp(&self, other: &Rational) -> Ordering {
        if let (Repr::Small(a, b), Repr::Small(c, d)) = (&self.0, &other.0) {
            return (*a as i128 * *d as i128).cmp(&(*c as i128 * *b as i128));
        }
        self.to_big().cmp(&other.to_big())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_literal_has_two_readings() {
        let read = |text, literals| Rational::from_literal(text, literals);
        assert_eq!(read("0.1", Literals::Decimal), Some(Rational::new(1, 10)));
        assert_eq!(read("0.1", Literals::Binary64), Some(Rational::new(3_602_879_701_896_397, 1 << 55)));
        assert_eq!(read("0.375", Literals::Binary64), read("0.375", Literals::Decimal));
        assert_eq!(read("1e309", Literals::Binary64), None);
        assert_eq!(read("0x1", Literals::Binary64), None);
    }

    fn decimal(text: &str) -> Rational {
        Rational::from_decimal(text).expect("a decimal literal")
    }

    #[test]
    fn literals_keep_their_decimal_value() {
        assert_eq!(decimal("9.81"), Rational::new(981, 100));
        assert_eq!(decimal("1e-4"), Rational::new(1, 10000));
        assert_eq!(&decimal("1.3") - &decimal("0.9"), decimal("0.4"));
        assert_eq!(&decimal("0.1") + &decimal("0.2"), decimal("0.3"));
        assert_eq!(decimal("1e30").to_f64(), 1e30);
        assert_eq!(decimal("123456789.123456789123456789").to_f64(), 123_456_789.123_456_79);
    }

    #[test]
    fn non_literals_are_refused() {
        for text in ["", ".", "e5", "1e", "1e999999999999", "1e5000", "0x1", "1.2.3", "nan", "-1"] {
            assert_eq!(Rational::from_decimal(text), None, "{text}");
        }
    }

    #[test]
    fn small_and_big_agree() {
        let third = Rational::new(1, 3);
        let mut power = Rational::ONE;
        for _ in 0..60 {
            power = &power * &third;
        }
        let mut back = power.clone();
        for _ in 0..60 {
            back = &back * &Rational::from(3);
        }
        assert!(power.bits() > 90);
        assert_eq!(back, Rational::ONE);
    }

    #[test]
    fn balls_enclose_big_fractions() {
        for text in ["1e40", "1e-40", "3.14159265358979323846264338327950288419716939937510", "1e300", "1e-280"] {
            let ball = decimal(text).to_ball();
            assert!(ball.relative_error() < 1e-29, "{text}: {}", ball.relative_error());
            let value: f64 = text.parse().expect("a number");
            assert!((ball.to_f64() - value).abs() <= value * 2.3e-16, "{text}");
        }
        let pi = decimal("3.14159265358979323846264338327950288419716939937510").to_ball();
        assert!((pi.mid - Dd::PI).abs().to_f64() < 1e-30);
    }

    #[test]
    fn roots_that_are_rational_stay_so() {
        assert_eq!(Rational::new(9, 16).exact_sqrt(), Some(Rational::new(3, 4)));
        assert_eq!(Rational::from(2).exact_sqrt(), None);
        assert_eq!(Rational::from(-4).exact_sqrt(), None);
    }

    #[test]
    fn the_least_integer_does_not_overflow() {
        let least = Rational::from(i64::MIN);
        assert_eq!(&-&-&least, &least);
        assert_eq!(least.recip().and_then(|r| r.recip()), Some(least));
    }

    /// The quick way and the general one give the same fraction.
    #[test]
    fn binary64_numbers_are_exact_fractions() {
        let list = [
            0.0,
            -0.0,
            1.0,
            -1.5,
            0.1,
            2.0f64.powi(-62),
            2.0f64.powi(-63),
            1e-300,
            5e-324,
            1e15 + 0.5,
            2.0f64.powi(62),
            1e300,
        ];
        for x in list.into_iter().chain((0..40).map(|i| 0.7f64.powi(i) * if i % 2 == 0 { 1e3 } else { -1e3 })) {
            let expected = BigRational::from_float(x).map(Rational::from_big);
            assert_eq!(Rational::from_f64(x), expected, "{x:e}");
        }
        assert_eq!((Rational::from_f64(f64::NAN), Rational::from_f64(f64::INFINITY)), (None, None));
    }
}
