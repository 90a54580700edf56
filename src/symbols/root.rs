//! Square roots of squares and of numbers, with the remaining factors under the root.

use super::{Factor, Product, Sum};
use crate::base::Rational;
use std::sync::Arc;

/// Factors of numbers that are looked for below this.
const MOST_FACTOR: i64 = 1000;

impl Sum {
    /// The square root. Squares of numbers are taken out; those of names are not, because their sign is unknown here.
    pub fn root(&self) -> Sum {
        if self.is_zero() {
            return Sum::ZERO;
        }
        let (content, rest) = super::factors::content(&self.terms);
        let number = match &content.terms[..] {
            [(_, coefficient)] => coefficient.clone(),
            _ => Rational::ONE,
        };
        if number.signum() < 0 {
            return Sum::factor(Factor::Root(Arc::new(self.clone())));
        }
        let alone = rest.as_number().is_some() && content.terms.iter().all(|(product, _)| product.is_one());
        let (outside, inside) = if alone { split_square(&number) } else { split_parts(&number) };
        let product = content.terms.first().map_or_else(Product::default, |(product, _)| product.clone());
        let inside = &Sum::term(product, inside) * &rest;
        let root = if inside.as_number().is_some_and(|n| n.is_one()) {
            Sum::one()
        } else {
            Sum::factor(Factor::Root(Arc::new(inside)))
        };
        root.scale(&outside)
    }

    /// The root of a perfect square, up to its sign; `None` for any other sum.
    pub fn exact_root(&self) -> Option<Sum> {
        match &self.terms[..] {
            [] => Some(Sum::ZERO),
            [(product, coefficient)] => {
                let root = coefficient.exact_sqrt()?;
                let halves = product
                    .0
                    .iter()
                    .map(|(factor, exponent)| (exponent % 2 == 0).then(|| (factor.clone(), exponent / 2)));
                Some(Sum::term(Product(halves.collect::<Option<Vec<_>>>()?), root))
            }
            terms => root_of_several(self, terms),
        }
    }
}

/// The root term by term: the first is the root of a square, and each further one is the remainder divided by twice the
/// first.
fn root_of_several(square: &Sum, terms: &[(Product, Rational)]) -> Option<Sum> {
    /// Maximum number of terms of a root that is searched for.
    const MOST_TERMS: usize = 6;
    // The greatest product is the square of the greatest.
    let greatest = |terms: &[(Product, Rational)]| terms.iter().max_by(|a, b| a.0.by_degree(&b.0)).cloned();
    let leading = Sum { terms: vec![greatest(terms)?] }.exact_root()?;
    let twice = leading.scale(&Rational::from(2)).inverse()?;
    let mut root = leading;
    for _ in 0..MOST_TERMS {
        let left = square - &root.square();
        let Some(next) = greatest(&left.terms) else { return Some(root) };
        let next = &Sum { terms: vec![next] } * &twice;
        let sound = next.terms.iter().all(|(product, _)| product.0.iter().all(|(_, exponent)| *exponent > 0));
        if !sound || next.terms.len() != 1 {
            return None;
        }
        root = &root + &next;
    }
    (square - &root.square()).is_zero().then_some(root)
}

/// The root of numerator and denominator separately: factors next to names stay a quotient.
fn split_parts(number: &Rational) -> (Rational, Rational) {
    let Some((numerator, denominator)) = number.to_fraction() else { return (Rational::ONE, number.clone()) };
    let (over, inside) = split_square(&Rational::from(numerator));
    let (under, below) = split_square(&Rational::from(denominator));
    (&over / &under, &inside / &below)
}

/// A positive number as a^2 b, b free of small squares: (a, b), b whole.
fn split_square(number: &Rational) -> (Rational, Rational) {
    if let Some(root) = number.exact_sqrt() {
        return (root, Rational::ONE);
    }
    let Some((numerator, denominator)) = number.to_fraction() else { return (Rational::ONE, number.clone()) };
    let Some(mut left) = numerator.checked_mul(denominator) else { return (Rational::ONE, number.clone()) };
    let mut outside = Rational::new(1, denominator);
    let mut factor = 2;
    while factor <= MOST_FACTOR && factor * factor <= left {
        while left % (factor * factor) == 0 {
            left /= factor * factor;
            outside = &outside * &Rational::from(factor);
        }
        factor += 1;
    }
    (outside, Rational::from(left))
}
