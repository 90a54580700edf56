//! Sines and cosines: angles in one form, and products of two as sums of one.

use super::{Factor, Product, Sum};
use crate::base::Rational;
use std::sync::Arc;

impl Sum {
    pub fn sine(&self) -> Sum {
        wave(self, true)
    }

    pub fn cosine(&self) -> Sum {
        wave(self, false)
    }
}

/// The sine or cosine of an angle, with the first name of the angle positive and its multiple of pi from -1/4 to 1/4.
fn wave(angle: &Sum, is_sine: bool) -> Sum {
    let pi = Product::of(Factor::Pi, 1);
    let turns =
        angle.terms.iter().find(|(product, _)| *product == pi).map_or(Rational::ZERO, |(_, turns)| turns.clone());
    let rest = Sum { terms: angle.terms.iter().filter(|(product, _)| *product != pi).cloned().collect() };
    let turned_round = rest.terms.first().map_or(turns.signum() < 0, |(_, coefficient)| coefficient.signum() < 0);
    if turned_round {
        let wave = wave(&-angle, is_sine);
        return if is_sine { -&wave } else { wave };
    }
    let (quarter, turns) = quarters(&turns);
    let (is_sine, is_negative) = match (is_sine, quarter) {
        (sine, 0) => (sine, false),
        (true, 1) => (false, false),
        (true, 2) => (true, true),
        (true, _) => (false, true),
        (false, 1) => (true, true),
        (false, 2) => (false, true),
        (false, _) => (true, false),
    };
    let value = match rest.is_zero() && turns.is_zero() {
        true if is_sine => Sum::ZERO,
        true => Sum::one(),
        false => {
            let angle = Arc::new(&rest + &Sum::pi().scale(&turns));
            Sum::factor(if is_sine { Factor::Sine(angle) } else { Factor::Cosine(angle) })
        }
    };
    if is_negative { -&value } else { value }
}

/// turns = quarter/2 + rest with the rest above -1/4 and at most 1/4, the quarter from 0 to 3.
fn quarters(turns: &Rational) -> (u8, Rational) {
    let half = Rational::new(1, 2);
    let nearest = &(&(turns + turns) + &half);
    // Upwards, so that 1/4 stays 1/4.
    let floor = nearest.floor();
    let nearest = if &floor == nearest { &floor - &Rational::ONE } else { floor };
    let rest = turns - &(&nearest * &half);
    let whole = &(&nearest / &Rational::from(4)).floor() * &Rational::from(4);
    let quarter = (&nearest - &whole).to_i64().unwrap_or(0);
    (quarter as u8, rest)
}

impl Sum {
    /// The sum with sines of 30, 45 and 60 degrees written as numbers and roots. Before, they are kept: products with other sines
    /// then find the angles that add up.
    pub fn evaluate(&self) -> Sum {
        let is_constant =
            |factor: &Factor| matches!(factor, Factor::Sine(a) | Factor::Cosine(a) if turns_of(a).is_some());
        if !self.terms.iter().any(|(product, _)| product.wave().is_some_and(is_constant)) {
            return self.clone();
        }
        let mut sum = Sum::ZERO;
        for (product, coefficient) in &self.terms {
            let known = match product.wave() {
                Some(Factor::Sine(angle)) => turns_of(angle).and_then(|turns| constant(&turns, true)),
                Some(Factor::Cosine(angle)) => turns_of(angle).and_then(|turns| constant(&turns, false)),
                _ => None,
            };
            let term = match known {
                Some(value) => {
                    let others = Product(product.0[..product.0.len() - 1].to_vec());
                    &Sum::term(others, coefficient.clone()) * &value
                }
                None => Sum::term(product.clone(), coefficient.clone()),
            };
            sum = &sum + &term;
        }
        sum
    }
}

/// The multiple of pi that an angle is.
fn turns_of(angle: &Sum) -> Option<Rational> {
    match &angle.terms[..] {
        [(product, turns)] if *product == Product::of(Factor::Pi, 1) => Some(turns.clone()),
        _ => None,
    }
}

/// The sine or cosine of a fraction of pi, if it is a fraction or a root of one.
fn constant(turns: &Rational, is_sine: bool) -> Option<Sum> {
    let (size, is_negative) = if turns.signum() < 0 { (-turns, true) } else { (turns.clone(), false) };
    let half_root = |of: i64| Sum::number(Rational::from(of)).root().halve();
    let sixth = size == Rational::new(1, 6);
    let value = match (is_sine, size) {
        (true, size) if size.is_zero() => Sum::ZERO,
        (false, size) if size.is_zero() => Sum::one(),
        (true, _) if sixth => Sum::fraction(1, 2),
        (false, _) if sixth => half_root(3),
        (_, size) if size == Rational::new(1, 4) => half_root(2),
        _ => return None,
    };
    Some(if is_sine && is_negative { -&value } else { value })
}

/// Werner's formulas: sin a sin b = (cos(a - b) - cos(a + b))/2 and so on.
pub(super) fn product(first: &Factor, second: &Factor) -> Sum {
    let sum = |a: &Arc<Sum>, b: &Arc<Sum>| &**a + &**b;
    let difference = |a: &Arc<Sum>, b: &Arc<Sum>| &**a - &**b;
    let doubled = match (first, second) {
        (Factor::Sine(a), Factor::Sine(b)) => &difference(a, b).cosine() - &sum(a, b).cosine(),
        (Factor::Cosine(a), Factor::Cosine(b)) => &difference(a, b).cosine() + &sum(a, b).cosine(),
        (Factor::Sine(a), Factor::Cosine(b)) | (Factor::Cosine(b), Factor::Sine(a)) => {
            &difference(a, b).sine() + &sum(a, b).sine()
        }
        _ => unreachable_waves(first, second),
    };
    doubled.halve()
}

/// Only called with sines and cosines, which `wave` returns.
fn unreachable_waves(first: &Factor, second: &Factor) -> Sum {
    debug_assert!(first.is_wave() && second.is_wave());
    Sum::ZERO
}
