//! Polynomials in one variable and its magnitude, with sums as coefficients: the laws of springs and dampers.

use super::{Factor, Function, Product, Sum};
use crate::base::Rational;
use std::collections::BTreeMap;

/// x^n, or |x| x^(n-1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Power {
    pub exponent: u32,
    pub has_magnitude: bool,
}

/// A polynomial; no coefficient is zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Powers {
    terms: BTreeMap<Power, Sum>,
}

impl Power {
    pub const ZEROTH: Power = Power { exponent: 0, has_magnitude: false };
    pub const FIRST: Power = Power { exponent: 1, has_magnitude: false };

    /// The power of a sum.
    pub fn of(self, sum: &Sum) -> Sum {
        self.with_exponent(sum, self.exponent as i32).unwrap_or_default()
    }

    /// Its derivative at a sum: n x^(n-1), or n |x| x^(n-2). Zero if that would divide by zero.
    pub fn slope(self, at: &Sum) -> Sum {
        let slope = self.with_exponent(at, self.exponent as i32 - 1).unwrap_or_default();
        slope.scale(&Rational::from(i64::from(self.exponent)))
    }

    fn with_exponent(self, sum: &Sum, exponent: i32) -> Option<Sum> {
        match self.has_magnitude {
            false => sum.power(exponent),
            true => Some(&magnitude(sum) * &sum.power(exponent - 1)?),
        }
    }
}

/// |x|, not looked into.
fn magnitude(of: &Sum) -> Sum {
    match of.as_number() {
        Some(number) => Sum::number(if number.signum() < 0 { -&number } else { number }),
        None => Sum::term(Product::of(Factor::Call(Function::Abs, [of.clone()].into()), 1), Rational::ONE),
    }
}

impl Powers {
    /// The highest exponent.
    pub const MOST: u32 = 8;

    pub fn constant(value: Sum) -> Powers {
        Powers::term(Power::ZEROTH, value)
    }

    pub fn variable() -> Powers {
        Powers::term(Power::FIRST, Sum::one())
    }

    fn term(power: Power, coefficient: Sum) -> Powers {
        let mut made = Powers::default();
        made.add(power, &coefficient);
        made
    }

    fn add(&mut self, power: Power, coefficient: &Sum) {
        let whole = &self.coefficient(power) + coefficient;
        self.terms.remove(&power);
        if !whole.is_zero() {
            self.terms.insert(power, whole);
        }
    }

    pub fn coefficient(&self, power: Power) -> Sum {
        self.terms.get(&power).cloned().unwrap_or_default()
    }

    /// Powers with their coefficients, ascending.
    pub fn terms(&self) -> impl Iterator<Item = (Power, &Sum)> {
        self.terms.iter().map(|(power, coefficient)| (*power, coefficient))
    }

    /// The value if the variable does not occur.
    pub fn as_constant(&self) -> Option<Sum> {
        self.terms.keys().all(|power| *power == Power::ZEROTH).then(|| self.coefficient(Power::ZEROTH))
    }

    pub fn plus(&self, other: &Powers) -> Powers {
        let mut sum = self.clone();
        other.terms().for_each(|(power, coefficient)| sum.add(power, coefficient));
        sum
    }

    pub fn scale(&self, by: &Sum) -> Powers {
        let mut scaled = Powers::default();
        self.terms().for_each(|(power, coefficient)| scaled.add(power, &(coefficient * by)));
        scaled
    }

    /// The product; `None` above the highest exponent.
    pub fn times(&self, other: &Powers) -> Option<Powers> {
        let mut product = Powers::default();
        for (a, first) in self.terms() {
            for (b, second) in other.terms() {
                // |x|^2 = x^2
                let has_magnitude = a.has_magnitude != b.has_magnitude;
                let power = Power { exponent: a.exponent + b.exponent, has_magnitude };
                if power.exponent > Powers::MOST {
                    return None;
                }
                product.add(power, &(first * second));
            }
        }
        Some(product)
    }

    /// An integer power; `None` above the highest exponent.
    pub fn power(&self, exponent: u32) -> Option<Powers> {
        if exponent > Powers::MOST {
            return None;
        }
        (0..exponent).try_fold(Powers::constant(Sum::one()), |power, _| power.times(self))
    }

    /// The magnitude of a number times a power of the variable; `None` for anything else.
    pub fn magnitude(&self) -> Option<Powers> {
        let mut terms = self.terms();
        let Some((power, coefficient)) = terms.next() else { return Some(Powers::default()) };
        let number = coefficient.as_number().filter(|_| terms.next().is_none())?;
        let size = if number.signum() < 0 { -&number } else { number };
        let has_magnitude = power.exponent % 2 == 1;
        Some(Powers::term(Power { has_magnitude, ..power }, Sum::number(size)))
    }
}
