//! A form of the system as flat numbers in triple words: the weights and sparse rows of `sum w a a^T`.
//!
//! The computation of undamped modes starts from these. Any uncertainty in the model (a root, a sine, the part of a
//! decimal that does not fit into three words) is in the radii and so in every bound.

use crate::base::{Dd, Number, Rational};
use crate::kernel::squares::Squares;
use crate::kernel::triple::{Precise, Triple};
use crate::system::Form;

/// The squares `w a a^T` of a form.
pub type Terms = Squares<Precise, Factor>;

/// An entry of a row. Most are signs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Factor {
    Plus,
    Minus,
    Other(Precise),
}

impl Terms {
    pub fn of(form: &Form) -> Terms {
        let mut terms = Squares::with_capacity(form.terms().len());
        for term in form.terms() {
            let row = form.row(term).iter().map(|(i, value)| (i.0, Factor::of_number(value)));
            terms.push(Precise::of(&term.weight), row);
        }
        terms
    }

    /// a . x of term `t`, for an exactly known x.
    #[inline]
    pub fn stretch(&self, t: usize, x: &[Triple]) -> Precise {
        let (indices, factors) = self.row(t);
        let (mut sum, mut radius) = (Triple::ZERO, 0.0);
        for (&i, factor) in indices.iter().zip(factors) {
            let x = x[i as usize];
            let part = match factor {
                Factor::Plus => x,
                Factor::Minus => -x,
                Factor::Other(a) => {
                    let part = a.value * x;
                    radius += part.hi().abs() * (2.0 * Triple::ERROR) + a.radius * x.hi().abs() * 2.0;
                    part
                }
            };
            if sum.is_zero() {
                sum = part;
            } else {
                radius += sum.hi().abs().max(part.hi().abs()) * (2.0 * Triple::ERROR);
                sum = sum + part;
            }
        }
        Precise { value: sum, radius }
    }

    /// a . x in binary64.
    #[inline]
    pub fn stretch_f64(&self, t: usize, x: &[f64]) -> f64 {
        let (indices, factors) = self.row(t);
        indices.iter().zip(factors).map(|(&i, factor)| factor.to_f64() * x[i as usize]).sum()
    }

    /// Whether all weights are certainly positive.
    pub fn all_positive(&self) -> bool {
        self.weights.iter().all(|w| w.value.hi() > 2.0 * w.radius)
    }

    pub fn is_finite(&self) -> bool {
        let finite = |x: &Precise| x.value.is_finite() && x.radius.is_finite();
        self.weights.iter().all(finite)
            && self.factors().iter().all(|factor| !matches!(factor, Factor::Other(x) if !finite(x)))
    }
}

impl Factor {
    fn of_number(value: &Number) -> Factor {
        match value.exact().and_then(Rational::to_fraction) {
            Some((1, 1)) => Factor::Plus,
            Some((-1, 1)) => Factor::Minus,
            _ => Factor::of(Precise::of(value)),
        }
    }

    fn of(value: Precise) -> Factor {
        if value.radius > 0.0 {
            Factor::Other(value)
        } else if value.value == Triple::ONE {
            Factor::Plus
        } else if value.value == -Triple::ONE {
            Factor::Minus
        } else {
            Factor::Other(value)
        }
    }

    /// The uncertainty beyond the stored words.
    #[inline]
    pub fn radius(self) -> f64 {
        match self {
            Factor::Other(x) => x.radius,
            Factor::Plus | Factor::Minus => 0.0,
        }
    }

    #[inline]
    pub fn to_triple(self) -> Triple {
        match self {
            Factor::Plus => Triple::ONE,
            Factor::Minus => -Triple::ONE,
            Factor::Other(x) => x.value,
        }
    }

    #[inline]
    pub fn to_dd(self) -> Dd {
        self.to_triple().dd()
    }

    #[inline]
    pub fn to_f64(self) -> f64 {
        self.to_triple().hi()
    }
}
