//! Lengths as a textbook writes them, by components, `sqrt((x - a)^2 + (y - h)^2)`, or by the law of cosines; and the
//! contributions of springs along lines to the equations at rest.

use super::build::{Builder, absolute};
use super::formula::Formula;
use crate::base::{OrderBy, Rational};
use crate::equations::names::class;
use crate::symbols::{Factor, Product, Sum, common_factors};

/// Terms of the law of cosines: `L^2 + a^2 - 2 L a cos(theta)`.
const LAW_OF_COSINES: usize = 3;

impl Builder<'_> {
    /// The root of a squared length, given the components of the vector.
    pub fn length(&self, square: &Sum, components: &[Sum; 2]) -> Formula {
        let has_wave =
            |(product, _): &&(Product, Rational)| product.factors().iter().any(|(factor, _)| is_wave(factor));
        // Once numbers have been added up, the two lengths can no longer be recognised.
        let is_named = square.terms().iter().all(|(product, _)| !product.is_one());
        let is_law_of_cosines =
            square.terms().iter().filter(has_wave).count() == 1 && square.terms().len() <= LAW_OF_COSINES && is_named;
        if is_law_of_cosines || components.iter().all(Sum::is_zero) {
            return self.root(square);
        }
        let moving = components.iter().filter(|component| !component.is_zero());
        let squares = moving.map(|component| (false, self.inner().square(&component.evaluate())));
        Formula::Root(Box::new(Formula::sum(squares.collect())))
    }

    /// The square of a sum: `L^2 (1 - cos(theta))^2`.
    fn square(&self, sum: &Sum) -> Formula {
        let factored = common_factors(sum);
        if factored.squared || factored.rest.terms().len() < 2 {
            return self.sum(&sum.square());
        }
        let bracket = |sum: &Sum| Formula::Power(Box::new(self.plain_sum(sum)), 2);
        if factored.product.is_one() {
            return bracket(&factored.rest.scale(&absolute(&factored.number)));
        }
        let front = factored.product.times(&factored.product);
        self.term(&front, &Rational::ONE, &[bracket(&factored.rest.scale(&absolute(&factored.number)))])
    }

    /// The contributions of springs along lines in terms of the names of their parts, k r^2 and q (a cos(theta_0) + b
    /// sin(theta_0)), each with its sign, and the rest of the sum; `None` if it contains no such names.
    pub fn of_lines(&self, sum: &Sum) -> Option<(Vec<(bool, Formula)>, Sum)> {
        let is_line = |factor: &Factor| matches!(factor, Factor::Name(symbol) if symbol.class() == class::LINE);
        let (mut lines, mut others) = (Vec::new(), Sum::ZERO);
        for (line, rest) in sum.collect_by(is_line) {
            match (line.is_one(), rest.terms()) {
                (true, _) => others = rest,
                (false, [(product, number)]) => {
                    lines.push((number.signum() < 0, self.term(&product.times(&line), &absolute(number), &[])));
                }
                (false, _) => {
                    let (negative, coefficient) = self.sign_and_factor(&rest);
                    lines.push((negative, self.term(&line, &Rational::ONE, &[coefficient])));
                }
            }
        }
        (!lines.is_empty()).then_some((lines, others))
    }

    /// A root; squares of differences in it are not multiplied out.
    pub fn root(&self, inside: &Sum) -> Formula {
        let inner = self.inner();
        let (squares, rest) = squares_of_pairs(&inside.evaluate());
        let has_wave = |(product, _): &(Product, Rational)| product.factors().iter().any(|(factor, _)| is_wave(factor));
        let is_plain = inside.terms().len() != LAW_OF_COSINES
            || !inside.terms().iter().any(has_wave)
            || !common_factors(inside).product.is_one();
        if squares.is_empty() && is_plain {
            return Formula::Root(Box::new(inner.sum(inside)));
        }
        let mut terms: Vec<(bool, Formula)> =
            squares.iter().map(|(negative, sum)| (*negative, inner.square(sum))).collect();
        let (waves, others): (Vec<_>, Vec<_>) = rest.terms().iter().cloned().partition(has_wave);
        let rest = others.iter().chain(&waves);
        terms.extend(rest.map(|(product, c)| (c.signum() < 0, inner.term(product, &absolute(c), &[]))));
        terms.order_by_key(|(negative, _)| *negative);
        Formula::Root(Box::new(Formula::sum(terms)))
    }
}

fn is_wave(factor: &Factor) -> bool {
    matches!(factor, Factor::Cosine(_) | Factor::Sine(_))
}

/// Sums of two terms whose squares are found in a sum, each with its sign, and what is left of the sum: a^2 - 2 a b + b^2 + h^2 is
/// (a - b)^2 + h^2.
fn squares_of_pairs(sum: &Sum) -> (Vec<(bool, Sum)>, Sum) {
    let (mut found, mut left) = (Vec::new(), sum.clone());
    // A factor that all terms share stays in front.
    if sum.terms().len() <= 2 || !common_factors(sum).product.is_one() {
        return (found, left);
    }
    let root = |(product, number): &(Product, Rational)| {
        let is_negative = number.signum() < 0;
        Some((is_negative, Sum::of_terms(vec![(product.clone(), absolute(number))]).exact_root()?))
    };
    let roots: Vec<(bool, Sum)> = sum
        .terms()
        .iter()
        .filter(|(product, _)| product.factors().iter().all(|(factor, exponent)| !is_wave(factor) && *exponent > 0))
        .filter_map(root)
        .collect();
    for (place, (is_negative, first)) in roots.iter().enumerate() {
        for (_, second) in roots[place + 1..].iter().filter(|(sign, _)| sign == is_negative) {
            let doubled = (first * second).scale(&Rational::from(if *is_negative { -2 } else { 2 }));
            let [(product, number)] = doubled.terms() else { continue };
            let cross = left.terms().iter().find(|(other, _)| other == product).map(|(_, number)| number);
            let pair = match cross {
                Some(cross) if cross == number => first + second,
                Some(cross) if *cross == -number => first - second,
                _ => continue,
            };
            let square = pair.square();
            let without = if *is_negative { &left + &square } else { &left - &square };
            if without.terms().len() + LAW_OF_COSINES == left.terms().len() {
                found.push((*is_negative, pair));
                left = without;
            }
        }
    }
    (found, left)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::symbols::Symbol;

    #[test]
    fn squares_of_differences_are_found_and_others_stay() {
        let [a, b, h] = [0, 1, 2].map(|place| Sum::name(Symbol::new(0, place)));
        let square = &(&a - &b).square() + &h.square();
        let (pairs, rest) = squares_of_pairs(&square);
        assert_eq!(pairs, [(false, &a - &b)]);
        assert_eq!(rest, h.square());
        let both = &(&a + &h).square() + &b.square();
        assert_eq!(squares_of_pairs(&both).0, [(false, &a + &h)]);
        let under = &b.square() - &(&a + &h).square();
        assert_eq!(squares_of_pairs(&under), (vec![(true, &a + &h)], b.square()));
        // 3 a b is no double product.
        let none = &(&a.square() + &b.square()) + &(&a * &b).scale(&Rational::from(3));
        assert!(squares_of_pairs(&none).0.is_empty());
        assert_eq!(squares_of_pairs(&none).1, none);
    }
}
