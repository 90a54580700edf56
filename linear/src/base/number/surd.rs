//! Exact numbers a + b sqrt(d), with a and b rational, b not zero, and d > 1 a square-free integer. Drawings at 30, 45
//! and 60 degrees and diagonals of rectangles consist of such numbers, and they cancel exactly. See
//! docs/method/numbers.md#surds.

use super::{Ball, Rational};
use std::cmp::Ordering;

#[derive(Clone, Debug, PartialEq)]
pub struct Surd {
    /// a
    pub rational: Rational,
    /// b
    pub factor: Rational,
    /// d
    pub root: u32,
}

/// Square factors are looked for in integers up to this one. It covers lengths that people write, at negligible cost.
const MAX_RADICAND: u64 = 1_000_000_000;
/// More bits than this are not worth their cost.
pub const MAX_SURD_BITS: u64 = 1024;

impl Surd {
    /// The root of a positive rational number as b sqrt(d), with d = 1 if it is rational; `None` for numbers too large
    /// to look for square factors.
    pub fn root_of(value: &Rational) -> Option<(Rational, u32)> {
        let (numerator, denominator) = value.to_fraction()?;
        let (n, n_left) = without_squares(u64::try_from(numerator).ok()?)?;
        let (d, d_left) = without_squares(u64::try_from(denominator).ok()?)?;
        // sqrt(n² r / (d² s)) = n / (d s) sqrt(r s); r and s have no factor in common.
        let factor = Rational::new(i64::from(n), i64::from(d) * i64::from(d_left));
        Some((factor, u32::try_from(u64::from(n_left) * u64::from(d_left)).ok()?))
    }

    pub fn bits(&self) -> u64 {
        self.rational.bits() + self.factor.bits()
    }

    /// a - b sqrt(d)
    pub fn conjugate(&self) -> Surd {
        Surd { factor: -&self.factor, ..self.clone() }
    }

    /// (a + b sqrt d)(a - b sqrt d) = a² - b² d, which is not zero.
    pub fn norm(&self) -> Rational {
        let factor = &self.factor * &self.factor;
        &(&self.rational * &self.rational) - &(&factor * &Rational::from(i64::from(self.root)))
    }

    /// The sign, exactly: that of the larger of |a| and |b| sqrt d.
    pub fn signum(&self) -> i32 {
        match (self.rational.signum(), self.factor.signum()) {
            (0, sign) => sign,
            (a, b) if a == b => a,
            (a, b) => match self.norm().signum().cmp(&0) {
                Ordering::Greater => a,
                _ => b,
            },
        }
    }

    pub fn root_ball(&self) -> Ball {
        Ball::from(f64::from(self.root)).sqrt()
    }

    /// The enclosure; if the two parts nearly cancel, computed as the norm divided by the conjugate.
    pub fn to_ball(&self) -> Ball {
        let sum = |a: &Rational, b: &Rational| a.to_ball() + b.to_ball() * self.root_ball();
        if self.rational.signum() * self.factor.signum() < 0 {
            self.norm().to_ball() / sum(&self.rational, &-&self.factor)
        } else {
            sum(&self.rational, &self.factor)
        }
    }
}

/// s and r with n = s² r, r without a square in it.
fn without_squares(n: u64) -> Option<(u32, u32)> {
    if n > MAX_RADICAND {
        return None;
    }
    let (mut square, mut left, mut rest, mut p) = (1u32, 1u32, n as u32, 2u32);
    // Beyond the cube root, the rest has at most two prime factors: it is a square, or it is square-free.
    while u64::from(p).pow(3) <= u64::from(rest) {
        while rest.is_multiple_of(p * p) {
            (rest, square) = (rest / (p * p), square * p);
        }
        if rest.is_multiple_of(p) {
            (rest, left) = (rest / p, left * p);
        }
        p += if p == 2 { 1 } else { 2 };
    }
    let root = rest.isqrt();
    if root * root == rest { Some((square * root, left)) } else { Some((square, left * rest)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Number;

    #[test]
    fn squares_are_taken_out() {
        for n in (1..3000u64).chain([999_999_937, 961_000_000, 31_607 * 31_607, 2 * 22_343 * 22_343, 3 * 1009 * 1009]) {
            let (s, r) = without_squares(n).expect("small");
            assert_eq!(u64::from(s).pow(2) * u64::from(r), n);
            assert!((2..40_000u64).take_while(|p| p * p <= u64::from(r)).all(|p| u64::from(r) % (p * p) != 0), "{n}");
        }
        assert_eq!(without_squares(MAX_RADICAND + 1), None);
    }

    #[test]
    fn surds_cancel_exactly() {
        let root = |n: i64| Number::from(n).sqrt().expect("positive");
        assert_eq!(&root(2) * &root(2), Number::from(2));
        assert_eq!(&(&root(2) * &root(3)) - &root(6), Number::ZERO);
        assert_eq!(root(12), &Number::from(2) * &root(3));
        assert_eq!(Number::from("0.75").sqrt(), Some(&root(3) / &Number::from(2)));
        let golden = &(&Number::ONE + &root(5)) / &Number::from(2);
        assert_eq!(&golden.square() - &golden, Number::ONE);
        assert_eq!(golden.recip(), Some(&golden - &Number::ONE));
        assert_eq!(golden.powi(-2), Some(&Number::from(2) - &golden));
        assert_eq!(&(&golden / &golden) - &Number::ONE, Number::ZERO);
    }

    /// 99 - 70 sqrt(2) = 0.00505..., and its powers: (99 - 70 sqrt 2)(99 + 70 sqrt 2) = 1.
    #[test]
    fn signs_and_enclosures_survive_cancellation() {
        let small = &Number::from(99) - &(&Number::from(70) * &Number::from(2).sqrt().expect("positive"));
        let mut power = small.clone();
        let mut value = 0.005_050_633_883_346_584;
        for _ in 0..5 {
            assert!(power.is_positive() && (-&power).is_negative() && !power.may_be_zero());
            let ball = power.to_ball();
            assert!((ball.to_f64() / value - 1.0).abs() < 1e-14, "{ball:?}");
            assert!(ball.relative_error() < 1e-28, "{ball:?}");
            (power, value) = (&power * &small, value * 0.005_050_633_883_346_584);
        }
        assert_eq!(small.compare(&power), Some(Ordering::Greater));
    }

    #[test]
    fn angles_of_the_drawing_board_have_exact_sines() {
        let degrees = |n: i64| Number::of_pi(Rational::new(n, 180));
        for n in [30, 45, 60, 120, 135, 150, 210, 225, 300, 315, -30, -45, 390, 405] {
            let (s, c) = degrees(n).sin_cos().expect("an angle");
            assert_eq!(&s.square() + &c.square(), Number::ONE, "{n}");
            let reduced = (n + 179).rem_euclid(360) - 179;
            assert_eq!(Number::atan2(&s, &c), Some(degrees(reduced)), "{n}");
        }
        let root = |n: i64| Number::from(n).sqrt().expect("positive");
        assert_eq!((&root(3) / &Number::from(2)).asin(), Some(degrees(60)));
        assert_eq!((-&(&root(2) / &Number::from(2))).acos(), Some(degrees(135)));
    }
}
