//! Triple-word arithmetic: unevaluated sums of three binary64 numbers, some 159 bits.
//!
//! Rayleigh quotients are evaluated in it, so that the remaining error of a frequency is the part that double-double
//! cannot hold. Operands have |b| <= 2^-52 |a| and |c| <= 2^-104 |a|. The operations keep every term down to 2^-104 of
//! the result exactly, add a handful of terms of that size in binary64 (seven rounding errors of at most 2^-53 x 2^-101
//! in a sum, eight of at most 2^-53 x 2^-101.5 in a product) and drop less than 2^-154. So
//!
//!   |sum - true| <= ERROR max(|x|, |y|),   |product - true| <= ERROR |x y|,   ERROR = 2^-151,
//!
//! barring underflow. (Sharper bounds of sharper algorithms: Fabiano, Muller and Picot, IEEE Trans. Comput. 68 (2019) 1573.)

use crate::base::number::dd::{two_prod, two_sum};
use crate::base::number::surd::Surd;
use crate::base::{Ball, Dd, Number, Rational};
use std::ops::{Add, Mul, Neg, Sub};

/// An unevaluated sum a + b + c of decreasing magnitude.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Triple {
    a: f64,
    b: f64,
    c: f64,
}

impl Triple {
    pub const ZERO: Triple = Triple { a: 0.0, b: 0.0, c: 0.0 };
    pub const ONE: Triple = Triple { a: 1.0, b: 0.0, c: 0.0 };
    /// Relative error bound of one operation; see the module.
    pub const ERROR: f64 = Dd::EPSILON / (1u64 << 49) as f64;
    /// Covers the loss of low words near the lower end of the exponent range.
    pub const UNDERFLOW: f64 = 1e-318;

    /// The exact sum of the three, in normal form.
    #[inline]
    fn normalise(a: f64, b: f64, c: f64) -> Triple {
        let (b, c) = two_sum(b, c);
        let (a, b) = two_sum(a, b);
        let (b, c) = two_sum(b, c);
        let (a, b) = two_sum(a, b);
        if a != 0.0 { Triple { a, b, c } } else { Triple { a: c, b: 0.0, c: 0.0 } }
    }

    /// Applies a function to each word; it must keep their order of magnitude.
    #[inline]
    pub fn map(self, word: impl Fn(f64) -> f64) -> Triple {
        Triple { a: word(self.a), b: word(self.b), c: word(self.c) }
    }

    /// The leading word: the number rounded to binary64.
    #[inline]
    pub fn hi(self) -> f64 {
        self.a
    }

    /// The number to double-double.
    #[inline]
    pub fn dd(self) -> Dd {
        let (b, _) = two_sum(self.b, self.c);
        Dd::new(self.a, b)
    }

    /// A nearby double-double and the remainder.
    #[inline]
    pub fn split(self) -> (Dd, f64) {
        let (b, c) = two_sum(self.b, self.c);
        let (a, b) = two_sum(self.a, b);
        (Dd { hi: a, lo: b }, c)
    }

    #[inline]
    pub fn is_zero(self) -> bool {
        self.a == 0.0
    }

    #[inline]
    pub fn is_finite(self) -> bool {
        self.a.is_finite() && self.b.is_finite() && self.c.is_finite()
    }

    #[inline]
    pub fn square(self) -> Triple {
        self * self
    }

    /// n / d of exact double-doubles by long division.
    pub fn quotient(n: Dd, d: Dd) -> Triple {
        if n.lo == 0.0 && d.lo == 0.0 {
            // The remainder of a binary64 quotient is a binary64 number too.
            let left = |rest: f64, word: f64| (-word).mul_add(d.hi, rest);
            let a = n.hi / d.hi;
            let rest = left(n.hi, a);
            let b = rest / d.hi;
            return Triple::normalise(a, b, left(rest, b) / d.hi);
        }
        Triple::ratio(n.into(), d.into())
    }

    /// n / d by long division, with a relative error of 8 ERROR: the first remainder has an error of 2 ERROR of n, the
    /// later ones are small.
    pub fn ratio(n: Triple, d: Triple) -> Triple {
        let (mut rest, mut words) = (n, [0.0; 3]);
        for word in &mut words {
            *word = rest.a / d.a;
            rest = rest - d * Triple::from(*word);
        }
        Triple::normalise(words[0], words[1], words[2])
    }
}

impl From<f64> for Triple {
    #[inline]
    fn from(a: f64) -> Triple {
        Triple { a, b: 0.0, c: 0.0 }
    }
}

impl From<Dd> for Triple {
    #[inline]
    fn from(x: Dd) -> Triple {
        Triple { a: x.hi, b: x.lo, c: 0.0 }
    }
}

impl Neg for Triple {
    type Output = Triple;
    #[inline]
    fn neg(self) -> Triple {
        Triple { a: -self.a, b: -self.b, c: -self.c }
    }
}

impl Add for Triple {
    type Output = Triple;
    #[inline(always)]
    fn add(self, y: Triple) -> Triple {
        let (s0, e0) = two_sum(self.a, y.a);
        let (s1, e1) = two_sum(self.b, y.b);
        let (s1, f1) = two_sum(s1, e0);
        Triple::normalise(s0, s1, (self.c + y.c) + (e1 + f1))
    }
}

impl Sub for Triple {
    type Output = Triple;
    #[inline]
    fn sub(self, y: Triple) -> Triple {
        self + -y
    }
}

impl Mul for Triple {
    type Output = Triple;
    #[inline(always)]
    fn mul(self, y: Triple) -> Triple {
        let (p, e) = two_prod(self.a, y.a);
        let (q1, e1) = two_prod(self.a, y.b);
        let (q2, e2) = two_prod(self.b, y.a);
        let (s, t1) = two_sum(q1, q2);
        let (s, t2) = two_sum(s, e);
        let third = self.a.mul_add(y.c, self.b.mul_add(y.b, self.c * y.a)) + ((e1 + e2) + (t1 + t2));
        Triple::normalise(p, s, third)
    }
}

/// A number of the model in triple words, with the radius of their error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precise {
    pub value: Triple,
    pub radius: f64,
}

impl Precise {
    /// The circle constant: the remainder beyond three words is below 1.2e-49.
    const PI: Precise =
        Precise { value: Triple { a: Dd::PI.hi, b: Dd::PI.lo, c: -2.9947698097183397e-33 }, radius: 2e-49 };

    pub fn of(number: &Number) -> Precise {
        match number {
            Number::Exact(rational) => Precise::of_rational(rational),
            Number::Surd(surd) => Precise::of_surd(surd),
            Number::Pi(pi) => {
                let power = (1..pi.power().unsigned_abs()).fold(Precise::PI, |product, _| product * Precise::PI);
                let factor = Precise::of(pi.factor());
                if pi.power() < 0 { factor / power } else { factor * power }
            }
            Number::Ball(_) | Number::Jet(_) => Precise::from(number.to_ball()),
        }
    }

    /// a + b sqrt(d); if the two parts nearly cancel, computed as (a² - b² d) / (a - b sqrt(d)).
    fn of_surd(surd: &Surd) -> Precise {
        let root = Precise { value: Triple::from(f64::from(surd.root)), radius: 0.0 }.sqrt();
        let sum = |surd: &Surd| Precise::of_rational(&surd.rational) + Precise::of_rational(&surd.factor) * root;
        if surd.rational.signum() * surd.factor.signum() < 0 {
            Precise::of_rational(&surd.norm()) / sum(&surd.conjugate())
        } else {
            sum(surd)
        }
    }

    fn of_rational(rational: &Rational) -> Precise {
        let fraction = rational.to_fraction();
        // Only fractions whose denominator is a power of two are binary numbers.
        if let Some((n, d)) = fraction.filter(|(_, d)| d.count_ones() > 1) {
            return Precise::near(Triple::quotient(exact(n), exact(d)));
        }
        let ball = rational.to_ball();
        if ball.is_exact() {
            return Precise::from(ball);
        }
        Precise::near(match fraction {
            Some((n, d)) => Triple::quotient(exact(n), exact(d)),
            None => {
                let rest = rational - &rational_sum(ball.mid);
                Triple::from(ball.mid) + Triple::from(rest.to_f64())
            }
        })
    }

    /// A number that does not fit into three words; near the lower end of the range the lower ones are lost.
    fn near(value: Triple) -> Precise {
        Precise { value, radius: 8.0 * Triple::ERROR * value.a.abs() + Triple::UNDERFLOW }
    }
}

impl From<Ball> for Precise {
    fn from(ball: Ball) -> Precise {
        Precise { value: ball.mid.into(), radius: ball.rad }
    }
}

fn exact(n: i64) -> Dd {
    let hi = n as f64;
    Dd::new(hi, (i128::from(n) - hi as i128) as f64)
}

fn rational_sum(x: Dd) -> Rational {
    let part = |x: f64| Rational::from_f64(x).unwrap_or(Rational::ZERO);
    &part(x.hi) + &part(x.lo)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// |x - true| / scale for the exact value of a triple.
    fn error(x: Triple, truth: &Number, scale: &Number) -> f64 {
        let part = |x: f64| Number::from(crate::base::Rational::from_f64(x).expect("finite"));
        let value = &(&part(x.a) + &part(x.b)) + &part(x.c);
        ((&value - truth).abs().to_f64() / scale.to_f64()).abs()
    }

    #[test]
    fn sums_and_products_keep_their_bounds() {
        let numbers: Vec<Number> =
            ["1.1", "2.7182818284590452353602874713526624977572", "3e-17", "123456789.123456789", "1.1000000000000001"]
                .map(Number::from)
                .into_iter()
                .collect();
        for x in &numbers {
            for y in &numbers {
                let (a, b) = (Precise::of(x).value, Precise::of(y).value);
                let larger = if x.to_f64() > y.to_f64() { x } else { y };
                // The operands are within 8 ERROR of the exact numbers.
                assert!(error(a + b, &(x + y), larger) <= 17.0 * Triple::ERROR);
                assert!(error(a - b, &(x - y), larger) <= 17.0 * Triple::ERROR);
                assert!(error(a * b, &(x * y), &(x * y)) <= 17.0 * Triple::ERROR);
            }
        }
    }

    #[test]
    fn numbers_of_the_model_are_held_to_their_radius() {
        for (n, d) in [("1", "3"), ("9.81", "7"), ("1e-30", "3.3"), ("2.00000000000000000000000001", "1")] {
            let x = &Number::from(n) / &Number::from(d);
            let precise = Precise::of(&x);
            assert!(error(precise.value, &x, &Number::ONE) <= precise.radius);
            assert!(precise.radius <= 1e-40 * x.to_f64());
        }
        assert_eq!(Precise::of(&Number::from("0.375")), Precise { value: Triple::from(0.375), radius: 0.0 });
    }

    /// (a + b sqrt d)² = a² + b² d + 2 a b sqrt d, also if a and b sqrt(d) nearly cancel.
    #[test]
    fn numbers_with_a_root_are_held_to_three_words() {
        let root = Number::from(2).sqrt().expect("positive");
        for rational in ["0", "1.5", "1.41421356237309504880168872", "3"] {
            let x = &root - &Number::from(rational);
            let (precise, square) = (Precise::of(&x), Precise::of(&x.square()));
            let difference = precise * precise - square;
            assert!(difference.value.hi().abs() <= difference.radius, "{rational}");
            assert!(precise.radius <= 1e-43 * x.to_f64().abs(), "{rational}: {precise:?}");
        }
        let whole = Precise::of(&Number::pi())
            - Precise::of(&(&Number::pi() / &Number::from(3))) * Precise::of(&Number::from(3));
        assert!(whole.value.hi().abs() <= whole.radius && whole.radius < 1e-43);
    }

    /// The third word of 1e-300 is below the range of binary64, and the second has few bits.
    #[test]
    fn tiny_numbers_of_the_model_are_held_to_their_radius() {
        for text in ["1e-270", "1.1e-290", "1e-300", "0.7e-303", "3.3e-307"] {
            let (x, precise) = (Number::from(text), Precise::of(&Number::from(text)));
            // Multiplied by 2^900, exactly, so that neither the error nor the radius underflows.
            let up = Number::from(crate::base::Rational::from_f64(2f64.powi(900)).expect("finite"));
            let part = |x: f64| Number::from(crate::base::Rational::from_f64(x).expect("finite"));
            let value = &(&part(precise.value.a) + &part(precise.value.b)) + &part(precise.value.c);
            let error = &(&value - &x).abs() * &up;
            assert!(error.to_f64() <= (&part(precise.radius) * &up).to_f64(), "{text}: {precise:?}");
            assert!(precise.radius < 1e-314, "{text}: {precise:?}");
        }
    }

    #[test]
    fn cancellation_leaves_a_normal_form() {
        let x = Triple { a: 1.0, b: 1e-17, c: 1e-34 };
        assert_eq!(x - Triple { a: 1.0, b: 1e-17, c: 0.0 }, Triple::from(1e-34));
    }
}
