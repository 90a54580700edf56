//! Turns sums into formulas in the order and form of a textbook: common factors in front of brackets, squares as
//! squares, coefficients before sines and cosines, coordinates last, positive terms first.

use super::formula::{Formula, Shown, as_shown};
use crate::base::{OrderBy, Rational};
use crate::equations::energy::is_motion;
use crate::equations::names::{Names, class};
use crate::symbols::{Factor, Power, Product, Sum, Symbol, common_factors};

/// The position of a numerical fraction: `1/2 m x'^2` or `m x''/2`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fractions {
    InFront,
    Below,
}

/// Builds formulas with the names of a model.
#[derive(Clone, Copy)]
pub struct Builder<'a> {
    pub names: &'a Names,
    pub fractions: Fractions,
}

impl<'a> Builder<'a> {
    pub fn new(names: &'a Names) -> Builder<'a> {
        Builder { names, fractions: Fractions::Below }
    }

    pub fn in_front(self) -> Builder<'a> {
        Builder { fractions: Fractions::InFront, ..self }
    }

    /// A sum, including its sign if it is a single negative term.
    pub fn sum(&self, sum: &Sum) -> Formula {
        let (negative, formula) = self.sign_and_factor(sum);
        if negative { formula.negate() } else { formula }
    }

    /// A sum as a factor: its sign and the rest.
    pub fn sign_and_factor(&self, sum: &Sum) -> (bool, Formula) {
        let sum = &sum.evaluate();
        match sum.terms() {
            [] => (false, Formula::zero()),
            [(product, coefficient)] => (coefficient.signum() < 0, self.term(product, &absolute(coefficient), &[])),
            _ => {
                if let Some(square) = self.wave_squared(sum) {
                    return square;
                }
                let factored = common_factors(sum);
                if factored.squared {
                    let square = Formula::Power(Box::new(self.plain_sum(&factored.rest)), 2);
                    let term = self.term(&factored.product, &absolute(&factored.number), &[square]);
                    return (factored.number.signum() < 0, term);
                }
                let whole = factored.rest.scale(&factored.number);
                let is_divided = factored.product.factors().iter().any(|(_, exponent)| *exponent < 0);
                let number = if is_divided { over_one_bar(&whole) } else { common_numeric_factor(&whole) };
                let mut inner = whole.scale(&number.recip().unwrap_or(Rational::ONE));
                let all_negative = inner.terms().iter().all(|(_, c)| c.signum() < 0);
                if all_negative {
                    inner = -&inner;
                }
                if number.is_one() && factored.product.is_one() {
                    return (all_negative, self.plain_sum(&inner));
                }
                let bracket = self.plain_sum(&inner);
                (all_negative, self.term(&factored.product, &number, &[bracket]))
            }
        }
    }

    /// A sum term by term, positive ones first, factoring out only squares: `J + m (r + s)^2`.
    pub fn plain_sum(&self, sum: &Sum) -> Formula {
        let mut terms: Vec<(bool, Formula)> = Vec::new();
        if let Some((of_lines, rest)) = self.of_lines(sum) {
            let (squares, rest) = self.squares(&rest);
            terms.extend(squares);
            terms.extend(
                rest.terms().iter().map(|(product, c)| (c.signum() < 0, self.term(product, &absolute(c), &[]))),
            );
            terms.extend(of_lines);
            terms.order_by_key(|(negative, _)| *negative);
            return Formula::sum(terms);
        }
        let (squares, sum) = self.squares(sum);
        terms.extend(squares);
        let sum = &sum;
        // Terms with the same product of motions are bracketed together.
        let is_moving = |factor: &Factor| factor.mentions(&is_motion) || matches!(factor, Factor::Call(..));
        for (moving, rest) in sum.collect_by(is_moving) {
            if moving.is_one() {
                let parts = rest.terms().iter();
                terms.extend(parts.map(|(product, c)| (c.signum() < 0, self.term(product, &absolute(c), &[]))));
            } else {
                let (negative, coefficient) = self.sign_and_factor(&rest);
                terms.push((negative, self.with_coefficient(coefficient, &moving)));
            }
        }
        terms.order_by_key(|(negative, _)| *negative);
        Formula::sum(terms)
    }

    /// Splits off parts that are a name times the square of a sum; returns them and the remaining sum.
    fn squares(&self, sum: &Sum) -> (Vec<(bool, Formula)>, Sum) {
        /// Number of terms in the square of a sum of two.
        const LEAST: usize = 3;
        let mut found = Vec::new();
        let mut left = sum.clone();
        if sum.terms().len() <= LEAST {
            return (found, left);
        }
        let first =
            |product: &Product| product.factors().iter().find(|(_, e)| *e == 1).map(|(factor, _)| factor.clone());
        let candidates: std::collections::BTreeSet<Factor> = sum
            .terms()
            .iter()
            .filter_map(|(product, _)| first(product))
            .filter(|f| matches!(f, Factor::Name(_)))
            .collect();
        for factor in candidates {
            let (with, without): (Vec<_>, Vec<_>) =
                left.terms().iter().cloned().partition(|(product, _)| product.exponent(&factor) == 1);
            if with.len() < LEAST {
                continue;
            }
            let factored = common_factors(&Sum::of_terms(with));
            if factored.squared {
                let square = Formula::Power(Box::new(self.plain_sum(&factored.rest)), 2);
                let term = self.term(&factored.product, &absolute(&factored.number), &[square]);
                found.push((factored.number.signum() < 0, term));
                left = Sum::of_terms(without);
            }
        }
        (found, left)
    }

    /// c x^n or c |x| x^(n-1), a sum x in brackets.
    pub fn with_power(&self, coefficient: &Sum, power: Power, of: &Sum) -> (bool, Formula) {
        if of.terms().len() == 1 && !power.has_magnitude {
            return self.sign_and_factor(&(coefficient * &power.of(of)));
        }
        let (mut negative, front) = self.sign_and_factor(coefficient);
        let is_opposite = !of.is_zero() && of.terms().iter().all(|(_, c)| c.signum() < 0);
        let is_odd = (power.exponent % 2 == 1) != power.has_magnitude;
        negative ^= is_opposite && is_odd;
        let of = if is_opposite { &-of } else { of };
        (negative, Formula::product(vec![front, raise(power, self.plain_sum(of))]))
    }

    fn with_coefficient(&self, coefficient: Formula, moving: &Product) -> Formula {
        Formula::product(vec![coefficient, self.term(moving, &Rational::ONE, &[])])
    }

    /// c (1 + cos(2 a)) as 2 c cos(a)^2, and c (1 - cos(2 a)) as 2 c sin(a)^2.
    fn wave_squared(&self, sum: &Sum) -> Option<(bool, Formula)> {
        let [(plain, first), (waved, second)] = sum.terms() else { return None };
        let (wave, others) = waved.split(|factor| matches!(factor, Factor::Cosine(_)));
        let [(Factor::Cosine(angle), 1)] = wave.factors() else { return None };
        let is_even = |c: &Rational| c.is_integer() && (c * &Rational::new(1, 2)).is_integer();
        if others != *plain || absolute(first) != absolute(second) || !angle.terms().iter().all(|(_, c)| is_even(c)) {
            return None;
        }
        let is_sine = first.signum() != second.signum();
        let function = if is_sine { "sin" } else { "cos" };
        let wave = Formula::Call(function, vec![self.inner().sum(&angle.halve())]);
        let square = Formula::Power(Box::new(wave), 2);
        let coefficient = &absolute(first) + &absolute(first);
        Some((first.signum() < 0, Formula::product(vec![self.term(plain, &coefficient, &[]), square])))
    }

    /// Terms collected by the moving factors in them, each with its sign.
    pub fn collect_terms(&self, sum: &Sum) -> Vec<(bool, Formula)> {
        let is_wave =
            |factor: &Factor| matches!(factor, Factor::Cosine(_) | Factor::Sine(_)) && factor.mentions(&is_dynamic);
        let mut terms = Vec::new();
        if let Some((of_lines, rest)) = self.of_lines(sum) {
            terms.extend(self.collect_terms(&rest));
            terms.extend(of_lines);
            terms.order_by_key(|(negative, _)| *negative);
            return terms;
        }
        for (wave, rest) in sum.collect_by(is_wave) {
            let parts = rest.collect_by(|factor| factor.mentions(&is_dynamic));
            if wave.is_one() {
                terms.extend(self.displacements_from_rest(parts));
                continue;
            }
            if parts.len() > 1 {
                // m g (r + s) cos(theta), not m g r cos(theta) + m g s cos(theta).
                let (negative, front) = self.sign_and_factor(&rest);
                terms.push((negative, self.with_coefficient(front, &wave)));
                continue;
            }
            for (moving, rest) in parts {
                let (negative, coefficient) = self.sign_and_factor(&rest);
                terms.push((negative, self.with_coefficient(coefficient, &moving.times(&wave))));
            }
        }
        terms
    }

    /// Terms without sines and cosines. If a coordinate and its value at rest have the same coefficient, they are
    /// written together: k (x_0 + x).
    fn displacements_from_rest(&self, parts: Vec<(Product, Sum)>) -> Vec<(bool, Formula)> {
        let (constant, moving): (Vec<_>, Vec<_>) = parts.into_iter().partition(|(moving, _)| moving.is_one());
        let mut constant = constant.into_iter().map(|(_, rest)| rest).next().unwrap_or_default();
        let mut terms = Vec::new();
        for (moving, rest) in moving {
            let (negative, coefficient) = self.sign_and_factor(&rest);
            if let Some(at_rest) = at_rest(&moving) {
                let share = &rest * &Sum::name(at_rest);
                let left = &constant - &share;
                if left.terms().len() + share.terms().len() == constant.terms().len() {
                    constant = left;
                    let both = [Sum::name(at_rest), Sum::term(moving, Rational::ONE)];
                    let both = both.map(|sum| (negative, self.sum(&sum)));
                    if matches!(&coefficient, Formula::Number(number) if number.is_one()) {
                        terms.extend(both);
                        continue;
                    }
                    let both = both.map(|(_, formula)| (false, formula)).to_vec();
                    terms.push((negative, Formula::product(vec![coefficient, Formula::Sum(both)])));
                    continue;
                }
            }
            terms.push((negative, self.with_coefficient(coefficient, &moving)));
        }
        if !constant.is_zero() {
            let own = match self.sign_and_factor(&constant) {
                (false, Formula::Sum(own)) => own,
                one => vec![one],
            };
            terms.splice(0..0, own);
        }
        terms
    }

    /// Terms collected by the rates in them: squares and products in the order of the coordinates.
    pub fn by_rates(&self, sum: &Sum) -> Vec<(bool, Formula)> {
        let is_rate = |factor: &Factor| {
            let classes = [class::VELOCITY, class::PRESCRIBED_VELOCITY];
            matches!(factor, Factor::Name(symbol) if classes.contains(&symbol.class()))
        };
        let mut parts = sum.collect_by(is_rate);
        parts.order_by_key(|(moving, _)| rates(moving));
        let term = |(moving, rest): (Product, Sum)| {
            let (negative, coefficient) = self.sign_and_factor(&rest);
            (negative, self.with_coefficient(coefficient, &moving))
        };
        parts.into_iter().map(term).collect()
    }

    /// A product of factors; further ones follow the names of parameters.
    pub fn term(&self, product: &Product, coefficient: &Rational, brackets: &[Formula]) -> Formula {
        let (mut over, mut under): (Vec<(u8, Formula)>, Vec<Formula>) = Default::default();
        let mut front = None;
        match as_shown(coefficient) {
            Shown::Whole(text) if text == "1" => {}
            Shown::Whole(text) => over.push((0, number(&text, coefficient))),
            Shown::Fraction(numerator, denominator) => {
                let is_divided = product.factors().iter().any(|(_, exponent)| *exponent < 0);
                if self.fractions == Fractions::InFront && !is_divided {
                    let fraction = Formula::quotient(plain(&numerator), plain(&denominator));
                    front = Some(fraction);
                } else {
                    if numerator != "1" {
                        over.push((0, plain(&numerator)));
                    }
                    under.push(plain(&denominator));
                }
            }
        }
        // Coordinates and their rates are written after a fraction, not in its numerator.
        let mut behind = Vec::new();
        for (factor, exponent) in product.factors() {
            let formula = self.factor(factor, exponent.unsigned_abs());
            let rank = self.rank(factor);
            if *exponent < 0 {
                under.push(formula);
            } else if rank >= WAVE {
                behind.push((rank, formula));
            } else {
                over.push((rank, formula));
            }
        }
        over.extend(brackets.iter().map(|bracket| (WAVE - 1, bracket.clone())));
        over.order_by_key(|(rank, _)| *rank);
        behind.order_by_key(|(rank, _)| *rank);
        let coefficient = Formula::product(over.into_iter().map(|(_, formula)| formula).collect());
        let is_one = matches!(&coefficient, Formula::Number(number) if number.is_one());
        let mut factors: Vec<Formula> = front.into_iter().collect();
        if !under.is_empty() {
            // A lone denominator goes below the moving factor: x/2, not 1/2 x.
            if is_one && !behind.is_empty() {
                let moving = Formula::product(behind.drain(..).map(|(_, formula)| formula).collect());
                factors.push(Formula::quotient(moving, Formula::product(under)));
            } else {
                factors.push(Formula::quotient(coefficient, Formula::product(under)));
            }
        } else if !is_one {
            factors.push(coefficient);
        }
        factors.extend(behind.into_iter().map(|(_, formula)| formula));
        Formula::product(factors)
    }

    fn factor(&self, factor: &Factor, exponent: u32) -> Formula {
        let base = match factor {
            Factor::Pi => Formula::Pi,
            Factor::Name(symbol) => match self.names.angle_of_cosine(*symbol) {
                Some(angle) => Formula::Call("cos", vec![Formula::Name(self.names.label(angle))]),
                None => Formula::Name(self.names.label(*symbol)),
            },
            Factor::Call(function, arguments) => {
                let arguments = arguments.iter().map(|argument| self.inner().sum(argument)).collect();
                Formula::Call(function.name(), arguments)
            }
            Factor::Root(sum) => self.root(sum),
            Factor::Whole(sum) => self.inner().sum(sum),
            Factor::Cosine(angle) => Formula::Call("cos", vec![self.inner().sum(angle)]),
            Factor::Sine(angle) => Formula::Call("sin", vec![self.inner().sum(angle)]),
        };
        if exponent == 1 { base } else { Formula::Power(Box::new(base), exponent) }
    }

    /// The order of factors in a term.
    fn rank(&self, factor: &Factor) -> u8 {
        match factor {
            Factor::Name(symbol) if self.names.angle_of_cosine(*symbol).is_some() => WAVE,
            _ => rank(factor),
        }
    }

    /// The builder for arguments of functions, in which numerical fractions are written as `x/2`.
    pub fn inner(&self) -> Builder<'a> {
        Builder { fractions: Fractions::Below, ..*self }
    }
}

/// x^n; |x| x^(n-1), and |x|^n if that is the same.
pub fn raise(power: Power, of: Formula) -> Formula {
    let raised = |of: Formula, exponent: u32| match exponent {
        1 => of,
        _ => Formula::Power(Box::new(of), exponent),
    };
    let size = |of: &Formula| Formula::Call("abs", vec![of.clone()]);
    match power {
        Power { exponent, has_magnitude: false } => raised(of, exponent),
        Power { exponent, .. } if exponent % 2 == 1 => raised(size(&of), exponent),
        Power { exponent, .. } => Formula::product(vec![size(&of), raised(of, exponent - 1)]),
    }
}

/// The value at rest of the coordinate that a product is.
fn at_rest(product: &Product) -> Option<Symbol> {
    match product.factors() {
        [(Factor::Name(symbol), 1)] if symbol.class() == class::COORDINATE => {
            Some(Symbol::new(class::REST, symbol.place()))
        }
        _ => None,
    }
}

/// The rates in a product, each as often as it is a factor: squares and products in the order of the coordinates.
fn rates(product: &Product) -> Vec<Symbol> {
    let of = |(factor, exponent): &(Factor, i32)| match factor {
        Factor::Name(symbol) if [class::VELOCITY, class::PRESCRIBED_VELOCITY].contains(&symbol.class()) => {
            vec![*symbol; exponent.unsigned_abs() as usize]
        }
        _ => Vec::new(),
    };
    product.factors().iter().flat_map(of).collect()
}

/// Rank from which factors are written after a fraction.
const WAVE: u8 = 4;

/// The order of factors in a term, by their kind.
fn rank(factor: &Factor) -> u8 {
    match factor {
        Factor::Pi => 1,
        Factor::Name(symbol) if symbol.class() < class::TENSION => 1,
        Factor::Root(_) | Factor::Call(..) | Factor::Whole(_) => 2,
        Factor::Name(symbol) if symbol.class() < class::COORDINATE => 2,
        Factor::Cosine(_) | Factor::Sine(_) => WAVE,
        Factor::Name(symbol) => WAVE + 1 + (symbol.class() - class::COORDINATE),
    }
}

/// Whether a name is a motion, the time, a force or a multiplier.
pub fn is_dynamic(symbol: Symbol) -> bool {
    let others = [class::FORCE, class::MULTIPLIER, class::LENGTH_RATE, class::TIME];
    is_motion(symbol) || others.contains(&symbol.class())
}

pub fn absolute(number: &Rational) -> Rational {
    if number.signum() < 0 { -number } else { number.clone() }
}

fn plain(text: &str) -> Formula {
    Formula::Decimal(text.to_string())
}

fn number(text: &str, value: &Rational) -> Formula {
    if value.is_integer() { Formula::Number(value.clone()) } else { Formula::Decimal(text.to_string()) }
}

/// The common numeric factor of a sum above a fraction bar, so that the sum contains no quotients.
fn over_one_bar(sum: &Sum) -> Rational {
    let fractions: Option<Vec<(i64, i64)>> = sum.terms().iter().map(|(_, c)| c.to_fraction()).collect();
    let Some(fractions) = fractions else { return Rational::ONE };
    // Decimals are not treated as fractions, unless there is a fraction beside them.
    let is_decimal = |c: &Rational| !c.is_integer() && matches!(as_shown(&absolute(c)), Shown::Whole(_));
    let is_fraction = |c: &Rational| matches!(as_shown(&absolute(c)), Shown::Fraction(..));
    if sum.terms().iter().any(|(_, c)| is_decimal(c)) && !sum.terms().iter().any(|(_, c)| is_fraction(c)) {
        return Rational::ONE;
    }
    let shared = fractions.iter().fold(0i64, |all, (numerator, _)| num_integer::gcd(all, *numerator)).max(1);
    let common = fractions
        .iter()
        .try_fold(1i64, |all, (_, denominator)| all.checked_mul(denominator / num_integer::gcd(all, *denominator)));
    common.map_or(Rational::ONE, |common| Rational::new(shared, common))
}

/// Common denominators that are still read at a glance.
const MOST_COMMON: i64 = 60;

/// The number that is factored out: the common divisor of all numerators, over a denominator that all terms have.
fn common_numeric_factor(sum: &Sum) -> Rational {
    let fractions: Option<Vec<(i64, i64)>> = sum.terms().iter().map(|(_, c)| c.to_fraction()).collect();
    let Some(fractions) = fractions else { return Rational::ONE };
    // Decimals are not treated as fractions.
    if sum.terms().iter().any(|(_, c)| matches!(as_shown(&absolute(c)), Shown::Whole(_)) && !c.is_integer()) {
        return Rational::ONE;
    }
    let shared = fractions.iter().fold(0i64, |all, (numerator, _)| num_integer::gcd(all, *numerator)).max(1);
    // A common denominator is used only if every term has one: (4 m + M)/12, but m + M/3.
    let all_have = fractions.iter().all(|(_, denominator)| *denominator > 1);
    let common = fractions.iter().fold(1i64, |all, (_, denominator)| num_integer::lcm(all, *denominator));
    let denominator = if all_have && common <= MOST_COMMON { common } else { 1 };
    let number = Rational::new(shared, denominator);
    // A number is factored out only if a bare name remains in the brackets: 3100 + 210 r^2, not 10 (310 + 21 r^2).
    let bares = sum.terms().iter().any(|(product, c)| !product.is_one() && absolute(c) == number);
    if bares || denominator > 1 { number } else { Rational::ONE }
}
