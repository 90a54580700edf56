//! Derivatives.

use super::{Factor, Product, Sum, Symbol};
use crate::base::Rational;

/// Names that depend on other names, each on none but those in front of it.
#[derive(Clone, Debug, Default)]
pub struct Lengths(pub Vec<(Symbol, Dependence)>);

/// The definition of a name that depends on coordinates.
#[derive(Clone, Debug, PartialEq)]
pub enum Dependence {
    /// The square root of a sum.
    Root(Sum),
    /// A form whose derivative is the sum of `factor * d inner`.
    Form { form: Sum, gradient: Vec<(Sum, Sum)> },
}

impl Lengths {
    fn of(&self, symbol: Symbol) -> Option<&Dependence> {
        self.0.iter().find(|(name, _)| *name == symbol).map(|(_, dependence)| dependence)
    }

    /// The names that are square roots, with what they are the roots of.
    pub fn roots(&self) -> impl Iterator<Item = (Symbol, &Sum)> {
        self.0.iter().filter_map(|(name, dependence)| match dependence {
            Dependence::Root(square) => Some((*name, square)),
            Dependence::Form { .. } => None,
        })
    }

    /// Whether a name is another one or depends on it.
    fn depends(&self, symbol: Symbol, by: Symbol) -> bool {
        let inside = |sum: &Sum| sum.mentions(&|inner| self.depends(inner, by));
        symbol == by
            || match self.of(symbol) {
                None => false,
                Some(Dependence::Root(square)) => inside(square),
                Some(Dependence::Form { gradient, .. }) => gradient.iter().any(|(_, inner)| inside(inner)),
            }
    }
}

impl Sum {
    /// The derivative by a name; what names stand for depends on it.
    pub fn derivative(&self, by: Symbol, lengths: &Lengths) -> Sum {
        let depends = |symbol: Symbol| lengths.depends(symbol, by);
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
                match lengths.of(*symbol).filter(|_| *symbol != by) {
                    // d l^n = n l^(n-2) d(l^2)/2
                    Some(Dependence::Root(square)) => {
                        &Sum::term(lowered(2), times) * &square.derivative(by, lengths).halve()
                    }
                    Some(Dependence::Form { gradient, .. }) => {
                        let slope = gradient
                            .iter()
                            .fold(Sum::ZERO, |sum, (factor, inner)| &sum + &(factor * &inner.derivative(by, lengths)));
                        &Sum::term(lowered(1), times) * &slope
                    }
                    None => Sum::term(lowered(1), times),
                }
            }
            Factor::Root(sum) => {
                let power = Sum::term(Product::of(self.clone(), exponent), times).halve();
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
