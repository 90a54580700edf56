//! Derivatives.

use super::{Factor, Product, Sum, Symbol};
use crate::base::Rational;

/// Names that stand for square roots: each with the sum that it is the root of.
#[derive(Clone, Debug, Default)]
pub struct Lengths(pub Vec<(Symbol, Sum)>);

impl Lengths {
    fn square(&self, symbol: Symbol) -> Option<&Sum> {
        self.0.iter().find(|(name, _)| *name == symbol).map(|(_, square)| square)
    }
}

impl Sum {
    /// The derivative by a name; lengths depend on it as their squares do.
    pub fn derivative(&self, by: Symbol, lengths: &Lengths) -> Sum {
        let depends = |symbol: Symbol| {
            symbol == by || lengths.square(symbol).is_some_and(|square| square.mentions(&|inner| inner == by))
        };
        let mut terms = Vec::new();
        for (product, coefficient) in &self.terms {
            for (place, (factor, exponent)) in product.0.iter().enumerate() {
                if !factor.mentions(&depends) {
                    continue;
                }
                let mut others = product.0.clone();
                others.remove(place);
                let others = Sum::term(Product(others), coefficient.clone());
                let inner = factor.derivative(*exponent, by, lengths);
                terms.extend((&others * &inner).terms);
            }
        }
        Sum::of_terms(terms)
    }
}

impl Factor {
    /// The derivative of a power of it.
    fn derivative(&self, exponent: i32, by: Symbol, lengths: &Lengths) -> Sum {
        let times = Rational::from(i64::from(exponent));
        match self {
            Factor::Pi | Factor::Call(..) => Sum::ZERO,
            Factor::Name(symbol) => {
                let lowered = |by: i32| match exponent - by {
                    0 => Product::default(),
                    left => Product::of(self.clone(), left),
                };
                match lengths.square(*symbol) {
                    // d l^n = n l^(n-2) d(l^2)/2
                    Some(square) => &Sum::term(lowered(2), times) * &square.derivative(by, lengths).halved(),
                    None => Sum::term(lowered(1), times),
                }
            }
            Factor::Root(sum) => {
                let power = Sum::term(Product::of(self.clone(), exponent), times).halved();
                let inner = sum.derivative(by, lengths);
                &(&power * &inner) * &sum.inverse().unwrap_or_default()
            }
            Factor::Whole(sum) => {
                let power = Sum::term(Product::of(self.clone(), exponent - 1), times);
                &power * &sum.derivative(by, lengths)
            }
            Factor::Cosine(angle) => -&(&angle.sine() * &angle.derivative(by, lengths)),
            Factor::Sine(angle) => &angle.cosine() * &angle.derivative(by, lengths),
        }
    }
}
