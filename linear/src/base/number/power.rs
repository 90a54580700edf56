//! Integer powers of binary64 numbers, the same on every machine. `f64::powi` differs in the last bits between
//! machines, and between constants folded by the compiler and values computed at run time.

/// 2^exponent, exact; zero below the least subnormal number, infinite beyond the largest number.
pub fn two_to(exponent: impl Into<i64>) -> f64 {
    match exponent.into() {
        1024.. => f64::INFINITY,
        exponent @ -1022.. => f64::from_bits(((exponent + 1023) as u64) << 52),
        exponent @ -1074.. => f64::from_bits(1 << (exponent + 1074)),
        _ => 0.0,
    }
}

/// Integer powers by repeated squaring, in one order.
pub trait Power {
    /// self^exponent; a negative power is the reciprocal of the positive one. Each of the at most 2 log2 |exponent| + 1
    /// operations is rounded, and the squares carry their errors on: the relative error is at most 2 |exponent| units.
    fn power(self, exponent: i32) -> Self;
}

impl Power for f64 {
    #[inline]
    fn power(self, exponent: i32) -> f64 {
        let (mut square, mut rest, mut product) = (self, exponent.unsigned_abs(), 1.0);
        loop {
            if rest & 1 == 1 {
                product *= square;
            }
            rest >>= 1;
            if rest == 0 {
                break;
            }
            square *= square;
        }
        if exponent < 0 { 1.0 / product } else { product }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Number, Rational};

    #[test]
    fn powers_of_two_are_exact_over_the_whole_range() {
        let mut halved = 1.0;
        for exponent in 0..1080 {
            assert_eq!(two_to(-exponent), halved, "{exponent}");
            halved /= 2.0;
        }
        let mut doubled = 1.0;
        for exponent in 0..1030 {
            assert_eq!(two_to(exponent), doubled, "{exponent}");
            doubled *= 2.0;
        }
        assert_eq!((two_to(i64::MIN), two_to(i64::MAX)), (0.0, f64::INFINITY));
    }

    /// Beside the exact power, and with the bits that the order of the products fixes.
    #[test]
    fn powers_are_right_and_their_bits_are_fixed() {
        for base in [0.7, -1.3, 0.99, 3.0, 1.0 + f64::EPSILON] {
            for exponent in [-40, -7, -1, 0, 1, 2, 3, 7, 13, 32, 41] {
                let exact = Number::from(Rational::from_f64(base).expect("finite")).powi(exponent).expect("a number");
                let found = base.power(exponent);
                let off = &Number::from(Rational::from_f64(found).expect("finite")) - &exact;
                let most = f64::from(exponent.abs()) * f64::EPSILON * found.abs();
                assert!(off.to_f64().abs() <= most, "{base}^{exponent} = {found}");
            }
        }
        let square = 0.7f64 * 0.7;
        assert_eq!(0.7f64.power(7).to_bits(), ((0.7 * square) * (square * square)).to_bits());
        assert_eq!(0.0f64.power(0), 1.0);
        assert_eq!(0.5f64.power(1074), two_to(-1074));
    }
}
