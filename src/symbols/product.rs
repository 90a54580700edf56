//! Products of powers: the terms of a sum without their coefficients.

use super::{Sum, Symbol};
use std::cmp::Ordering;
use std::sync::Arc;

/// A factor of a product. The order of the variants is the order of factors.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Factor {
    Pi,
    Name(Symbol),
    /// A function that is not looked into.
    Call(Function, Arc<[Sum]>),
    /// The square root of a sum.
    Root(Arc<Sum>),
    /// A sum that is divided by; its exponent is negative.
    Whole(Arc<Sum>),
    Cosine(Arc<Sum>),
    Sine(Arc<Sum>),
}

/// A function of numbers that stays as it is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Function {
    Abs,
    Min,
    Max,
    Tan,
    Asin,
    Acos,
    Atan,
    Atan2,
    Exp,
    Ln,
    Power,
}

impl Function {
    pub fn function_by_name(name: &str) -> Option<Function> {
        let all = [
            Function::Abs,
            Function::Min,
            Function::Max,
            Function::Tan,
            Function::Asin,
            Function::Acos,
            Function::Atan,
            Function::Atan2,
            Function::Exp,
            Function::Ln,
        ];
        all.into_iter().find(|function| function.name() == name)
    }

    pub fn name(self) -> &'static str {
        match self {
            Function::Abs => "abs",
            Function::Min => "min",
            Function::Max => "max",
            Function::Tan => "tan",
            Function::Asin => "asin",
            Function::Acos => "acos",
            Function::Atan => "atan",
            Function::Atan2 => "atan2",
            Function::Exp => "exp",
            Function::Ln => "ln",
            Function::Power => "pow",
        }
    }
}

/// Factors in ascending order with nonzero exponents. At most one of them is a sine or cosine, with exponent one.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Product(pub(super) Vec<(Factor, i32)>);

impl Product {
    pub fn of(factor: Factor, exponent: i32) -> Product {
        Product(vec![(factor, exponent)])
    }

    pub fn factors(&self) -> &[(Factor, i32)] {
        &self.0
    }

    /// Whether it is the empty product, one.
    pub fn is_one(&self) -> bool {
        self.0.is_empty()
    }

    pub fn exponent(&self, factor: &Factor) -> i32 {
        self.0.iter().find(|(known, _)| known == factor).map_or(0, |(_, exponent)| *exponent)
    }

    /// The sine or cosine in it.
    pub(super) fn wave(&self) -> Option<&Factor> {
        self.0.last().map(|(factor, _)| factor).filter(|factor| factor.is_wave())
    }

    /// The product with added exponents; not made canonical in any other way.
    pub(super) fn merge(&self, other: &Product) -> Product {
        let (mut a, mut b) = (self.0.iter().peekable(), other.0.iter().peekable());
        let mut merged = Vec::with_capacity(self.0.len() + other.0.len());
        while let (Some(first), Some(second)) = (a.peek(), b.peek()) {
            match first.0.cmp(&second.0) {
                Ordering::Less => merged.extend(a.next().cloned()),
                Ordering::Greater => merged.extend(b.next().cloned()),
                Ordering::Equal => {
                    let exponent = first.1 + second.1;
                    if exponent != 0 {
                        merged.push((first.0.clone(), exponent));
                    }
                    a.next();
                    b.next();
                }
            }
        }
        merged.extend(a.cloned());
        merged.extend(b.cloned());
        Product(merged)
    }

    /// Compares by the exponent of the greatest factor, then of the next: an order that multiplication preserves.
    pub(super) fn by_degree(&self, other: &Product) -> Ordering {
        let (mut a, mut b) = (self.0.iter().rev().peekable(), other.0.iter().rev().peekable());
        loop {
            let order = match (a.peek(), b.peek()) {
                (None, None) => return Ordering::Equal,
                (Some((_, exponent)), None) => exponent.cmp(&0),
                (None, Some((_, exponent))) => 0.cmp(exponent),
                (Some(first), Some(second)) => match first.0.cmp(&second.0) {
                    Ordering::Greater => first.1.cmp(&0),
                    Ordering::Less => 0.cmp(&second.1),
                    Ordering::Equal => first.1.cmp(&second.1),
                },
            };
            if order != Ordering::Equal {
                return order;
            }
            a.next();
            b.next();
        }
    }

    /// The product of two that share no factor.
    pub fn times(&self, other: &Product) -> Product {
        self.merge(other)
    }

    /// The factors that are chosen, and the others.
    pub fn split(&self, chosen: impl Fn(&Factor) -> bool) -> (Product, Product) {
        let (yes, no) = self.0.iter().cloned().partition(|(factor, _)| chosen(factor));
        (Product(yes), Product(no))
    }

    pub fn mentions(&self, wanted: &impl Fn(Symbol) -> bool) -> bool {
        self.0.iter().any(|(factor, _)| factor.mentions(wanted))
    }
}

impl Factor {
    pub(super) fn is_wave(&self) -> bool {
        matches!(self, Factor::Cosine(_) | Factor::Sine(_))
    }

    /// Whether a name that satisfies a condition occurs in it.
    pub fn mentions(&self, wanted: &impl Fn(Symbol) -> bool) -> bool {
        match self {
            Factor::Pi => false,
            Factor::Name(symbol) => wanted(*symbol),
            Factor::Call(_, arguments) => arguments.iter().any(|argument| argument.mentions(wanted)),
            Factor::Root(sum) | Factor::Whole(sum) | Factor::Cosine(sum) | Factor::Sine(sum) => sum.mentions(wanted),
        }
    }
}
