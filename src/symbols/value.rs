//! Values of sums: an enclosure wherever the values of the names are enclosures.

use super::{Factor, Function, Sum, Symbol};
use crate::base::Number;

impl Sum {
    /// The value of the sum, given values of its names; `None` if a name has none, or if a divisor may be zero.
    pub fn value(&self, of: &impl Fn(Symbol) -> Option<Number>) -> Option<Number> {
        let mut sum = Number::ZERO;
        for (product, coefficient) in &self.terms {
            let mut value = Number::from(coefficient.clone());
            for (factor, exponent) in &product.0 {
                value = &value * &factor.value(of)?.powi(*exponent)?;
            }
            sum = &sum + &value;
        }
        Some(sum)
    }
}

impl Factor {
    fn value(&self, of: &impl Fn(Symbol) -> Option<Number>) -> Option<Number> {
        match self {
            Factor::Pi => Some(Number::pi()),
            Factor::Name(symbol) => of(*symbol),
            Factor::Call(function, arguments) => {
                let values: Option<Vec<Number>> = arguments.iter().map(|argument| argument.value(of)).collect();
                function.value(&values?)
            }
            Factor::Root(sum) => sum.value(of)?.sqrt(),
            Factor::Whole(sum) => sum.value(of),
            Factor::Cosine(angle) => angle.value(of)?.sin_cos().map(|(_, cosine)| cosine),
            Factor::Sine(angle) => angle.value(of)?.sin_cos().map(|(sine, _)| sine),
        }
    }
}

impl Function {
    fn value(self, values: &[Number]) -> Option<Number> {
        let first = values.first()?;
        let extreme = |wanted| {
            values.iter().skip(1).try_fold(first.clone(), |best, value| {
                let order = value.compare(&best)?;
                Some(if order == wanted { value.clone() } else { best })
            })
        };
        match self {
            Function::Abs => Some(first.abs()),
            Function::Min => extreme(std::cmp::Ordering::Less),
            Function::Max => extreme(std::cmp::Ordering::Greater),
            Function::Tan => {
                let (sine, cosine) = first.sin_cos()?;
                sine.checked_div(&cosine)
            }
            Function::Asin => first.asin(),
            Function::Acos => first.acos(),
            Function::Atan => Number::atan2(first, &Number::ONE),
            Function::Atan2 => Number::atan2(first, values.get(1)?),
            Function::Exp => first.exp(),
            Function::Ln => first.ln(),
            Function::Power => first.pow(values.get(1)?),
        }
    }
}
