//! Sums of products with rational coefficients, and their arithmetic.

use super::{Factor, Product, Symbol};
use crate::base::{OrderBy, Rational};
use std::ops::{Add, Mul, Neg, Sub};
use std::sync::Arc;

/// A polynomial in canonical form: terms in ascending order of their products, no coefficient zero.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Sum {
    pub(super) terms: Vec<(Product, Rational)>,
}

impl Sum {
    pub const ZERO: Sum = Sum { terms: Vec::new() };

    pub fn one() -> Sum {
        Sum::number(Rational::ONE)
    }

    pub fn number(value: Rational) -> Sum {
        Sum::term(Product::default(), value)
    }

    pub fn fraction(numerator: i64, denominator: i64) -> Sum {
        Sum::number(Rational::new(numerator, denominator))
    }

    pub fn name(symbol: Symbol) -> Sum {
        Sum::factor(Factor::Name(symbol))
    }

    pub fn pi() -> Sum {
        Sum::factor(Factor::Pi)
    }

    pub(super) fn factor(factor: Factor) -> Sum {
        Sum::term(Product::of(factor, 1), Rational::ONE)
    }

    /// One term; its product has to be canonical.
    pub fn term(product: Product, coefficient: Rational) -> Sum {
        if coefficient.is_zero() { Sum::ZERO } else { Sum { terms: vec![(product, coefficient)] } }
    }

    /// Terms in any order.
    pub fn of_terms(mut terms: Vec<(Product, Rational)>) -> Sum {
        terms.order_by(|a, b| a.0.cmp(&b.0));
        let mut merged: Vec<(Product, Rational)> = Vec::with_capacity(terms.len());
        for (product, coefficient) in terms {
            match merged.last_mut() {
                Some(last) if last.0 == product => last.1 = &last.1 + &coefficient,
                _ => merged.push((product, coefficient)),
            }
        }
        merged.retain(|(_, coefficient)| !coefficient.is_zero());
        Sum { terms: merged }
    }

    pub fn terms(&self) -> &[(Product, Rational)] {
        &self.terms
    }

    pub fn is_zero(&self) -> bool {
        self.terms.is_empty()
    }

    /// The number that it is.
    pub fn as_number(&self) -> Option<Rational> {
        match &self.terms[..] {
            [] => Some(Rational::ZERO),
            [(product, coefficient)] if product.is_one() => Some(coefficient.clone()),
            _ => None,
        }
    }

    pub fn mentions(&self, wanted: &impl Fn(Symbol) -> bool) -> bool {
        self.terms.iter().any(|(product, _)| product.mentions(wanted))
    }

    /// Calls `see` with every name that occurs, possibly more than once.
    pub fn names(&self, see: &mut dyn FnMut(Symbol)) {
        for (factor, _) in self.terms.iter().flat_map(|(product, _)| &product.0) {
            factor.names(see);
        }
    }

    pub fn scale(&self, by: &Rational) -> Sum {
        if by.is_zero() {
            return Sum::ZERO;
        }
        Sum { terms: self.terms.iter().map(|(product, c)| (product.clone(), c * by)).collect() }
    }

    pub fn halve(&self) -> Sum {
        self.scale(&Rational::new(1, 2))
    }

    pub fn square(&self) -> Sum {
        self * self
    }

    /// An integer power of the sum; `None` for a negative power of zero.
    pub fn power(&self, exponent: i32) -> Option<Sum> {
        if exponent < 0 {
            return self.inverse()?.power(exponent.checked_neg()?);
        }
        let mut result = Sum::one();
        for _ in 0..exponent {
            result = &result * self;
        }
        Some(result)
    }

    /// One divided by the sum; a divisor of several terms stays whole. `None` for zero.
    pub fn inverse(&self) -> Option<Sum> {
        match &self.terms[..] {
            [] => None,
            [(product, coefficient)] if product.wave().is_none() => {
                let inverted = product.0.iter().map(|(factor, exponent)| (factor.clone(), -exponent)).collect();
                // A whole sum that was divided by is multiplied with.
                Some(&Sum::term(Product(inverted), coefficient.recip()?) * &Sum::one())
            }
            terms => {
                // Sums that differ by a factor have the same whole.
                let (common, rest) = super::factors::content(terms);
                let whole = Sum::term(Product::of(Factor::Whole(Arc::new(rest)), -1), Rational::ONE);
                Some(&whole * &common.inverse()?)
            }
        }
    }

    pub fn over(&self, divisor: &Sum) -> Option<Sum> {
        Some(self * &divisor.inverse()?)
    }

    /// Whether the sum is zero for all values of its names, with denominators cleared.
    pub fn vanishes(&self) -> bool {
        let mut sum = self.evaluate();
        loop {
            let divisor =
                sum.terms.iter().flat_map(|(product, _)| &product.0).find_map(|(factor, exponent)| match factor {
                    Factor::Whole(_) | Factor::Root(_) if *exponent < 0 => Some(factor.clone()),
                    _ => None,
                });
            let Some(divisor) = divisor else { return sum.is_zero() };
            let most = sum.terms.iter().map(|(product, _)| -product.exponent(&divisor)).max().unwrap_or(0);
            let scale = match &divisor {
                Factor::Whole(whole) => whole.power(most),
                _ => Sum::factor(divisor.clone()).power(most),
            };
            let Some(scale) = scale else { return false };
            let mut cleared = Sum::ZERO;
            for (product, coefficient) in &sum.terms {
                let exponent = product.exponent(&divisor);
                let (_, others) = product.split(|factor| *factor == divisor);
                let term = Sum::term(others, coefficient.clone());
                let multiple = match &divisor {
                    Factor::Whole(whole) => whole.power(most + exponent),
                    _ => Sum::factor(divisor.clone()).power(most + exponent),
                };
                let Some(multiple) = multiple else { return false };
                cleared = &cleared + &(&term * &multiple);
            }
            // Each pass takes one divisor away for good, unless it would not shrink.
            if cleared == sum || scale.is_zero() {
                return false;
            }
            sum = cleared;
        }
    }

    /// Terms by one part of their products: each part with the sum that it is multiplied with, in ascending order.
    pub fn collect_by(&self, part: impl Fn(&Factor) -> bool) -> Vec<(Product, Sum)> {
        let mut parts: Vec<(Product, Vec<(Product, Rational)>)> = Vec::new();
        let mut split: Vec<(Product, (Product, Rational))> = self
            .terms
            .iter()
            .map(|(product, coefficient)| {
                let (chosen, others) = product.split(&part);
                (chosen, (others, coefficient.clone()))
            })
            .collect();
        split.order_by(|a, b| a.0.cmp(&b.0));
        for (chosen, term) in split {
            match parts.last_mut() {
                Some((last, terms)) if *last == chosen => terms.push(term),
                _ => parts.push((chosen, vec![term])),
            }
        }
        parts.into_iter().map(|(chosen, terms)| (chosen, Sum::of_terms(terms))).collect()
    }

    /// The sum with names replaced.
    pub fn replace(&self, by: &impl Fn(Symbol) -> Option<Sum>) -> Sum {
        let mentioned = |symbol: Symbol| by(symbol).is_some();
        let mut kept = Vec::new();
        let mut made = Sum::ZERO;
        for (product, coefficient) in &self.terms {
            if !product.mentions(&mentioned) {
                kept.push((product.clone(), coefficient.clone()));
                continue;
            }
            let mut value = Sum::number(coefficient.clone());
            for (factor, exponent) in &product.0 {
                let factor = factor.replace(by);
                value = &value * &factor.power(*exponent).unwrap_or_default();
            }
            made = &made + &value;
        }
        &Sum { terms: kept } + &made
    }
}

impl Factor {
    fn names(&self, see: &mut dyn FnMut(Symbol)) {
        match self {
            Factor::Pi => {}
            Factor::Name(symbol) => see(*symbol),
            Factor::Call(_, arguments) => arguments.iter().for_each(|argument| argument.names(see)),
            Factor::Root(sum) | Factor::Whole(sum) | Factor::Cosine(sum) | Factor::Sine(sum) => sum.names(see),
        }
    }

    /// The factor as a sum, with names replaced; a whole sum is a divisor through its exponent.
    fn replace(&self, by: &impl Fn(Symbol) -> Option<Sum>) -> Sum {
        match self {
            Factor::Pi => Sum::pi(),
            Factor::Name(symbol) => by(*symbol).unwrap_or_else(|| Sum::name(*symbol)),
            Factor::Call(function, arguments) => {
                let arguments = arguments.iter().map(|argument| argument.replace(by)).collect();
                Sum::factor(Factor::Call(*function, arguments))
            }
            Factor::Root(sum) => sum.replace(by).root(),
            Factor::Whole(sum) => sum.replace(by),
            Factor::Cosine(angle) => angle.replace(by).cosine(),
            Factor::Sine(angle) => angle.replace(by).sine(),
        }
    }
}

impl Add for &Sum {
    type Output = Sum;
    fn add(self, other: &Sum) -> Sum {
        if other.terms.is_empty() {
            return self.clone();
        }
        if self.terms.is_empty() {
            return other.clone();
        }
        let (mut a, mut b) = (self.terms.iter().peekable(), other.terms.iter().peekable());
        let mut terms = Vec::with_capacity(self.terms.len() + other.terms.len());
        while let (Some(first), Some(second)) = (a.peek(), b.peek()) {
            match first.0.cmp(&second.0) {
                std::cmp::Ordering::Less => terms.extend(a.next().cloned()),
                std::cmp::Ordering::Greater => terms.extend(b.next().cloned()),
                std::cmp::Ordering::Equal => {
                    let coefficient = &first.1 + &second.1;
                    if !coefficient.is_zero() {
                        terms.push((first.0.clone(), coefficient));
                    }
                    a.next();
                    b.next();
                }
            }
        }
        terms.extend(a.cloned());
        terms.extend(b.cloned());
        Sum { terms }
    }
}

impl Neg for &Sum {
    type Output = Sum;
    fn neg(self) -> Sum {
        Sum { terms: self.terms.iter().map(|(product, c)| (product.clone(), -c)).collect() }
    }
}

impl Sub for &Sum {
    type Output = Sum;
    fn sub(self, other: &Sum) -> Sum {
        self + &-other
    }
}

impl Mul for &Sum {
    type Output = Sum;
    fn mul(self, other: &Sum) -> Sum {
        let mut terms = Vec::with_capacity(self.terms.len() * other.terms.len());
        for a in &self.terms {
            for b in &other.terms {
                multiply(a, b, &mut terms);
            }
        }
        Sum::of_terms(terms)
    }
}

/// The product of two terms. It has several terms if two sines or cosines are multiplied, or a root by itself.
fn multiply(a: &(Product, Rational), b: &(Product, Rational), terms: &mut Vec<(Product, Rational)>) {
    let coefficient = &a.1 * &b.1;
    if let (Some(first), Some(second)) = (a.0.wave(), b.0.wave()) {
        let waves = super::trigonometry::product(first, second);
        let rest = Product(a.0.0[..a.0.0.len() - 1].to_vec()).merge(&Product(b.0.0[..b.0.0.len() - 1].to_vec()));
        let rest = multiply_out(rest, coefficient);
        return terms.extend((&rest * &waves).terms);
    }
    let merged = a.0.merge(&b.0);
    if is_settled(&merged) {
        terms.push((merged, coefficient));
    } else {
        terms.extend(multiply_out(merged, coefficient).terms);
    }
}

fn is_settled(product: &Product) -> bool {
    product.0.iter().all(|(factor, exponent)| match factor {
        Factor::Root(_) => exponent.abs() < 2,
        Factor::Whole(_) => *exponent < 0,
        _ => true,
    })
}

/// Roots of exponents beyond one and whole sums that are multiplied with, multiplied out.
fn multiply_out(product: Product, coefficient: Rational) -> Sum {
    if is_settled(&product) {
        return Sum::term(product, coefficient);
    }
    let mut kept = Vec::new();
    let mut out = Sum::one();
    for (factor, exponent) in product.0 {
        match &factor {
            Factor::Root(sum) if exponent.abs() >= 2 => {
                out = &out * &sum.power(exponent / 2).unwrap_or_default();
                if exponent % 2 != 0 {
                    kept.push((factor, exponent % 2));
                }
            }
            Factor::Whole(sum) if exponent > 0 => out = &out * &sum.power(exponent).unwrap_or_default(),
            _ => kept.push((factor, exponent)),
        }
    }
    &Sum::term(Product(kept), coefficient) * &out
}
