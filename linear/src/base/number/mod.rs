//! Numbers as a model means them: exact while they are rational, enclosed in a ball from then on.
//!
//! A literal such as `9.81` is the decimal fraction 981/100. Sums, products and quotients of such numbers stay exact, and
//! so do sums with one square root, and both times a power of pi: `60 deg` is pi/3, its sine sqrt(3)/2, 10 rad/s are 5/pi Hz.
//! Any other number is enclosed in a [`Ball`], a double-double with a rigorous radius.
//! See docs/method/numbers.md.

pub mod ball;
pub mod bound;
pub mod dd;
mod functions;
pub mod jet;
pub mod pi;
pub mod power;
pub mod rational;
pub mod rounded;
pub mod rounding;
pub mod series;
pub mod surd;

pub use ball::{Ball, larger};
pub use bound::Bound;
pub use dd::Dd;
pub use jet::Jet;
pub use pi::PiPower;
pub use power::{Power, two_to};
pub use rational::{Literals, Rational};
pub use rounded::{Rounded, Unproven};
pub use rounding::{down, up};

use jet::Ranged;
use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};
use surd::{MAX_SURD_BITS, Surd};

/// Fractions larger than this become balls: exactness is for the numbers that people write, not for their hundredth
/// powers.
const MAX_EXACT_BITS: u64 = 8192;

/// A real number: exact, or enclosed.
#[derive(Debug, PartialEq)]
pub enum Number {
    Exact(Rational),
    /// a + b sqrt(d), not rational.
    Surd(Box<Surd>),
    /// One of the two above times a power of pi.
    Pi(Box<PiPower>),
    Ball(Ball),
    /// Depends on a parameter that lies in a range: with its derivative.
    Jet(Box<Ranged>),
}

impl Number {
    pub const ZERO: Number = Number::Exact(Rational::ZERO);
    pub const ONE: Number = Number::Exact(Rational::ONE);

    pub fn pi() -> Number {
        Number::of_pi(Rational::ONE)
    }

    /// A fraction of pi.
    pub fn of_pi(fraction: Rational) -> Number {
        PiPower::number(Number::from_rational(fraction), 1)
    }

    /// The number in floating point with its error bound.
    #[inline]
    pub fn to_ball(&self) -> Ball {
        if let Number::Jet(_) = self {
            Jet::note_loss();
        }
        self.enclosure()
    }

    /// The enclosure for comparisons: unlike [`Self::to_ball`], it is not taken for a number that loses its derivative.
    #[inline]
    pub fn enclosure(&self) -> Ball {
        match self {
            Number::Exact(value) => value.to_ball(),
            Number::Surd(surd) => surd.to_ball(),
            Number::Pi(pi) => pi.to_ball(),
            Number::Ball(ball) => *ball,
            Number::Jet(jet) => jet.value,
        }
    }

    pub fn to_f64(&self) -> f64 {
        match self {
            Number::Exact(value) => value.to_f64(),
            Number::Surd(_) | Number::Pi(_) => self.to_ball().to_f64(),
            Number::Ball(ball) => ball.to_f64(),
            Number::Jet(jet) => {
                Jet::note_choice();
                jet.value.to_f64()
            }
        }
    }

    /// The exact value, if it is rational and known.
    pub fn exact(&self) -> Option<&Rational> {
        match self {
            Number::Exact(value) => Some(value),
            Number::Surd(_) | Number::Pi(_) | Number::Ball(_) | Number::Jet(_) => None,
        }
    }

    /// Whether it is enclosed over a range of a parameter.
    pub fn is_range(&self) -> bool {
        matches!(self, Number::Jet(_))
    }

    /// Whether the number is known itself, not by an enclosure.
    pub fn is_known_exactly(&self) -> bool {
        matches!(self, Number::Exact(_) | Number::Surd(_) | Number::Pi(_))
    }

    /// Whether the number is certainly zero.
    #[inline]
    pub fn is_zero(&self) -> bool {
        match self {
            Number::Exact(value) => value.is_zero(),
            Number::Surd(_) | Number::Pi(_) => false,
            Number::Ball(ball) => ball.is_zero(),
            Number::Jet(jet) => {
                jet.note_question();
                jet.is_zero()
            }
        }
    }

    /// Like [`Number::is_zero`], for uses in which the answer only saves work: over a range the product encloses all products, whether or not a factor is zero for
    /// some values, so that nothing is asked about it.
    pub fn vanishes(&self) -> bool {
        match self {
            Number::Jet(jet) => jet.is_zero(),
            number => number.is_zero(),
        }
    }

    #[inline]
    pub fn is_one(&self) -> bool {
        matches!(self, Number::Exact(value) if value.is_one())
    }

    /// Whether the number is zero, or cannot be distinguished from zero with the known digits.
    pub fn may_be_zero(&self) -> bool {
        match self {
            Number::Exact(value) => value.is_zero(),
            Number::Surd(_) | Number::Pi(_) => false,
            Number::Ball(ball) => ball.contains_zero(),
            Number::Jet(jet) => {
                jet.note_question();
                jet.value.contains_zero()
            }
        }
    }

    /// Whether the number is certainly greater than zero.
    pub fn is_positive(&self) -> bool {
        match self {
            Number::Exact(value) => value.signum() > 0,
            Number::Surd(surd) => surd.signum() > 0,
            Number::Pi(pi) => pi.factor().is_positive(),
            Number::Ball(ball) => ball.is_positive(),
            Number::Jet(jet) => {
                jet.note_question();
                jet.value.is_positive()
            }
        }
    }

    /// Whether the number is certainly less than zero.
    pub fn is_negative(&self) -> bool {
        match self {
            Number::Exact(value) => value.signum() < 0,
            Number::Surd(surd) => surd.signum() < 0,
            Number::Pi(pi) => pi.factor().is_negative(),
            Number::Ball(ball) => ball.is_negative(),
            Number::Jet(jet) => {
                jet.note_question();
                jet.value.is_negative()
            }
        }
    }

    /// Whether the number has a known size within the range of binary64.
    pub fn is_finite(&self) -> bool {
        self.enclosure().is_finite()
    }

    /// The order of two numbers; `None` if their balls overlap.
    pub fn compare(&self, other: &Number) -> Option<Ordering> {
        if let (Number::Exact(a), Number::Exact(b)) = (self, other) {
            return Some(a.cmp(b));
        }
        let difference = self - other;
        if difference.is_zero() {
            Some(Ordering::Equal)
        } else if difference.is_positive() {
            Some(Ordering::Greater)
        } else if difference.is_negative() {
            Some(Ordering::Less)
        } else {
            None
        }
    }

    pub fn abs(&self) -> Number {
        match self {
            _ if self.is_negative() => -self,
            // Either sign: its size is still within the radius of the midpoint's.
            Number::Ball(ball) => Number::Ball(ball.abs()),
            Number::Jet(jet) if jet.value.contains_zero() => {
                Number::from(Jet { value: jet.value.abs(), slope: Ball::ZERO.widen(jet.slope.magnitude()) })
            }
            _ => self.clone(),
        }
    }

    #[inline]
    pub fn square(&self) -> Number {
        self * self
    }

    /// 1 / self; `None` if self may be zero.
    pub fn recip(&self) -> Option<Number> {
        Number::ONE.checked_div(self)
    }

    /// self / other; `None` if the divisor may be zero.
    pub fn checked_div(&self, other: &Number) -> Option<Number> {
        (!other.may_be_zero()).then(|| self / other)
    }

    /// a + b sqrt(d), d without a square in it.
    fn with_root(rational: Rational, factor: Rational, root: u32) -> Number {
        if factor.is_zero() {
            return Number::from_rational(rational);
        }
        if root == 1 {
            return Number::from_rational(&rational + &factor);
        }
        let surd = Surd { rational, factor, root };
        if surd.bits() <= MAX_SURD_BITS { Number::Surd(Box::new(surd)) } else { Number::Ball(surd.to_ball()) }
    }

    fn from_rational(value: Rational) -> Number {
        if value.bits() <= MAX_EXACT_BITS { Number::Exact(value) } else { Number::Ball(value.to_ball()) }
    }
}

impl Clone for Number {
    /// Small fractions and balls are copied where they stand; only the rest is a call.
    #[inline]
    fn clone(&self) -> Number {
        match self {
            Number::Exact(value) => Number::Exact(value.clone()),
            Number::Ball(ball) => Number::Ball(*ball),
            Number::Surd(_) | Number::Pi(_) | Number::Jet(_) => self.clone_of_boxed(),
        }
    }
}

impl Number {
    #[cold]
    fn clone_of_boxed(&self) -> Number {
        match self {
            Number::Exact(value) => Number::Exact(value.clone()),
            Number::Ball(ball) => Number::Ball(*ball),
            Number::Surd(surd) => Number::Surd(surd.clone()),
            Number::Pi(pi) => Number::Pi(pi.clone()),
            Number::Jet(jet) => Number::Jet(jet.clone()),
        }
    }
}

impl From<i64> for Number {
    fn from(n: i64) -> Number {
        Number::Exact(Rational::from(n))
    }
}

impl From<Rational> for Number {
    fn from(value: Rational) -> Number {
        Number::from_rational(value)
    }
}

impl From<Ball> for Number {
    fn from(ball: Ball) -> Number {
        Number::Ball(ball)
    }
}

impl Neg for &Number {
    type Output = Number;
    fn neg(self) -> Number {
        match self {
            Number::Exact(value) => Number::Exact(-value),
            Number::Surd(surd) => {
                Number::Surd(Box::new(Surd { rational: -&surd.rational, factor: -&surd.factor, root: surd.root }))
            }
            Number::Pi(pi) => PiPower::number(-pi.factor(), pi.power()),
            Number::Ball(ball) => Number::Ball(-*ball),
            Number::Jet(jet) => jet.negative(),
        }
    }
}

impl Add for &Number {
    type Output = Number;
    fn add(self, other: &Number) -> Number {
        match (self, other) {
            (Number::Exact(a), _) if a.is_zero() => other.clone(),
            (_, Number::Exact(b)) if b.is_zero() => self.clone(),
            (Number::Jet(_), _) | (_, Number::Jet(_)) => jet::sum(self, other),
            (Number::Exact(a), Number::Exact(b)) => Number::from_rational(a + b),
            (Number::Pi(a), Number::Pi(b)) if a.power() == b.power() => {
                PiPower::number(a.factor() + b.factor(), a.power())
            }
            (Number::Exact(b), Number::Surd(a)) | (Number::Surd(a), Number::Exact(b)) => {
                Number::with_root(&a.rational + b, a.factor.clone(), a.root)
            }
            (Number::Surd(a), Number::Surd(b)) if a.root == b.root => {
                Number::with_root(&a.rational + &b.rational, &a.factor + &b.factor, a.root)
            }
            _ => Number::Ball(self.to_ball() + other.to_ball()),
        }
    }
}

impl Sub for &Number {
    type Output = Number;
    fn sub(self, other: &Number) -> Number {
        match (self, other) {
            (Number::Exact(a), Number::Exact(b)) => Number::from_rational(a - b),
            _ => self + &-other,
        }
    }
}

impl Mul for &Number {
    type Output = Number;
    fn mul(self, other: &Number) -> Number {
        match (self, other) {
            (Number::Exact(a), _) if a.is_one() => other.clone(),
            (_, Number::Exact(b)) if b.is_one() => self.clone(),
            (Number::Exact(a), Number::Exact(b)) => Number::from_rational(a * b),
            (Number::Exact(b), Number::Surd(a)) | (Number::Surd(a), Number::Exact(b)) => {
                Number::with_root(&a.rational * b, &a.factor * b, a.root)
            }
            (Number::Surd(a), Number::Surd(b)) if a.root == b.root => {
                let root = Rational::from(i64::from(a.root));
                let rational = &(&a.rational * &b.rational) + &(&(&a.factor * &b.factor) * &root);
                let factor = &(&a.rational * &b.factor) + &(&a.factor * &b.rational);
                Number::with_root(rational, factor, a.root)
            }
            (Number::Surd(a), Number::Surd(b)) if a.rational.is_zero() && b.rational.is_zero() => {
                let product = Rational::from(i64::from(a.root) * i64::from(b.root));
                match Surd::root_of(&product) {
                    Some((factor, root)) => Number::with_root(Rational::ZERO, &(&a.factor * &b.factor) * &factor, root),
                    None => Number::Ball(a.to_ball() * b.to_ball()),
                }
            }
            // An exact zero stays exact whatever it is multiplied with.
            _ if self.vanishes() || other.vanishes() => Number::ZERO,
            (Number::Jet(_), _) | (_, Number::Jet(_)) => jet::product(self, other),
            (Number::Pi(_), _) | (_, Number::Pi(_)) => pi::product(self, other),
            _ => Number::Ball(self.to_ball() * other.to_ball()),
        }
    }
}

impl Div for &Number {
    type Output = Number;
    /// The quotient; a ball of infinite radius if the divisor may be zero.
    fn div(self, other: &Number) -> Number {
        match (self, other) {
            (_, Number::Exact(b)) if b.is_one() => self.clone(),
            (Number::Jet(_), _) | (_, Number::Jet(_)) => jet::quotient(self, other),
            (Number::Exact(a), Number::Exact(b)) if !b.is_zero() => Number::from_rational(a / b),
            (Number::Surd(a), Number::Exact(b)) if !b.is_zero() => {
                Number::with_root(&a.rational / b, &a.factor / b, a.root)
            }
            (Number::Exact(_) | Number::Surd(_), Number::Surd(b)) => {
                let inverse = &Number::Surd(Box::new(b.conjugate())) / &Number::from_rational(b.norm());
                self * &inverse
            }
            (Number::Pi(_), _) | (_, Number::Pi(_)) => pi::quotient(self, other),
            _ => Number::Ball(self.to_ball() / other.to_ball()),
        }
    }
}
