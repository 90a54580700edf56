//! Common factors of the terms of a sum, which a textbook writes in front of brackets.

use super::{Factor, Product, Sum};
use crate::base::{OrderBy, Rational};
use std::sync::Arc;

/// A sum as `number * product * rest`, with no common factors in `rest`; if `squared` is set, the square of `rest`
/// takes its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Factored {
    pub number: Rational,
    pub product: Product,
    pub rest: Sum,
    /// The rest is squared.
    pub squared: bool,
}

/// Factors out everything that all terms share.
pub fn common_factors(sum: &Sum) -> Factored {
    let (content, rest) = content(sum.terms());
    let (product, number) = content.terms.into_iter().next().unwrap_or((Product::default(), Rational::ZERO));
    let is_sum = |root: &Sum| root.terms.len() > 1;
    let opposite = -&rest;
    match (rest.exact_root().filter(is_sum), opposite.exact_root().filter(is_sum)) {
        (Some(root), _) => Factored { number, product, rest: root, squared: true },
        (None, Some(root)) => Factored { number: -&number, product, rest: root, squared: true },
        _ => Factored { number, product, rest, squared: false },
    }
}

/// The number and the powers that all terms share, as one term, and the remaining sum, whose first term is positive.
pub(super) fn content(terms: &[(Product, Rational)]) -> (Sum, Sum) {
    let Some(((first, leading), others)) = terms.split_first() else { return (Sum::ZERO, Sum::ZERO) };
    if others.is_empty() && first.wave().is_none() {
        return (Sum::term(first.clone(), leading.clone()), Sum::one());
    }
    let mut shared: Vec<(Factor, i32)> = first.0.iter().filter(|(factor, _)| !factor.is_wave()).cloned().collect();
    // A divisor of only some terms is factored out too, so that there are no quotients within quotients.
    for (product, _) in others {
        for (factor, exponent) in &product.0 {
            if *exponent < 0 && !shared.iter().any(|(known, _)| known == factor) && first.exponent(factor) == 0 {
                shared.push((factor.clone(), 0));
            }
        }
    }
    for (factor, least) in &mut shared {
        let exponents = terms.iter().map(|(product, _)| product.exponent(factor));
        *least = exponents.min().unwrap_or(0).min(*least);
    }
    shared.retain(|(_, exponent)| *exponent != 0);
    shared.order_by(|a, b| a.0.cmp(&b.0));
    let mut number = terms.iter().skip(1).fold(absolute(leading), |all, (_, c)| common(&all, &absolute(c)));
    if leading.signum() < 0 {
        number = -&number;
    }
    let inverse: Vec<(Factor, i32)> = shared.iter().map(|(factor, exponent)| (factor.clone(), -exponent)).collect();
    let (inverse, per) = (Product(inverse), number.recip().unwrap_or(Rational::ONE));
    let rest = Sum::of_terms(terms.iter().map(|(product, c)| (product.merge(&inverse), c * &per)).collect());
    (Sum::term(Product(shared), number), rest)
}

impl Sum {
    /// Cancels the divisors that divide the sum without remainder.
    pub fn simplify(&self) -> Sum {
        let divisors = self.terms.iter().flat_map(|(product, _)| product.factors());
        let whole = divisors.filter_map(|(factor, _)| match factor {
            Factor::Whole(whole) => Some(whole.clone()),
            _ => None,
        });
        for whole in whole.collect::<std::collections::BTreeSet<_>>() {
            let factor = Factor::Whole(whole.clone());
            let most = self.terms.iter().map(|(product, _)| -product.exponent(&factor)).max().unwrap_or(0);
            if let Some(quotient) = self.times_whole(&whole, most).and_then(|numerator| numerator.divide(&whole)) {
                let left = whole.power(1 - most).unwrap_or_default();
                return (&quotient * &left).simplify();
            }
        }
        self.clone()
    }

    /// The sum times a power of one of its divisors, so that no term contains that divisor.
    fn times_whole(&self, whole: &Arc<Sum>, power: i32) -> Option<Sum> {
        let factor = Factor::Whole(whole.clone());
        let mut sum = Sum::ZERO;
        for (product, coefficient) in &self.terms {
            let (_, others) = product.split(|known| *known == factor);
            let multiple = whole.power(power + product.exponent(&factor))?;
            sum = &sum + &(&Sum::term(others, coefficient.clone()) * &multiple);
        }
        Some(sum)
    }

    /// The quotient of two sums, if there is no remainder and the divisor contains no sine or cosine.
    fn divide(&self, by: &Sum) -> Option<Sum> {
        /// Terms of a quotient that are looked for.
        const MOST_TERMS: usize = 64;
        let greatest = |sum: &Sum| sum.terms.iter().max_by(|a, b| a.0.by_degree(&b.0)).cloned();
        if by.terms.iter().any(|(product, _)| product.wave().is_some()) {
            return None;
        }
        let inverse = Sum { terms: vec![greatest(by)?] }.inverse()?;
        let (mut left, mut quotient) = (self.clone(), Sum::ZERO);
        for _ in 0..MOST_TERMS {
            let Some(term) = greatest(&left) else { return Some(quotient) };
            let next = &Sum { terms: vec![term] } * &inverse;
            left = &left - &(&next * by);
            quotient = &quotient + &next;
        }
        None
    }
}

fn absolute(number: &Rational) -> Rational {
    if number.signum() < 0 { -number } else { number.clone() }
}

/// The greatest common divisor of two positive fractions: of the numerators, over the least common multiple of the denominators.
fn common(a: &Rational, b: &Rational) -> Rational {
    match (a.to_fraction(), b.to_fraction()) {
        (Some((n, d)), Some((m, e))) => {
            let multiple = (d / num_integer::gcd(d, e)).checked_mul(e);
            multiple.map_or(Rational::ONE, |multiple| Rational::new(num_integer::gcd(n, m), multiple))
        }
        _ => Rational::ONE,
    }
}
