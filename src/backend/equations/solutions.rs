//! Layout of natural frequencies, poles and transfer functions in closed form.

use super::document::{DIGITS, Item, Section, Writer, display, words};
use super::formula::Formula;
use crate::backend::decimal::certain_number;
use crate::base::{Number, Rational};
use crate::equations::Entry;
use crate::equations::closed::{MOST_TERMS, Part, in_variable, parts, product};
use crate::equations::names::{Label, class};
use crate::equations::transfer::{Transfer, transfers};
use crate::symbols::{Factor, Product, Sum, Symbol, common_factors};

/// The most transfer functions that are written out.
const MOST_TRANSFERS: usize = 12;

impl Writer<'_> {
    pub fn solutions(&self) -> Section {
        let parts = parts(self.equations);
        let mut items = Vec::new();
        for part in &parts {
            match part.places[..] {
                [one] => items.extend(self.single(one, part, parts.len() > 1)),
                _ => items.extend(self.pair(part, parts.len() > 1)),
            }
        }
        items.extend(self.transfers(&parts));
        Section { heading: "7 Natural frequencies, poles and transfer functions", items }
    }

    /// A symbol, with the coordinate as index if there are several parts or the model uses the letter.
    fn lettered(&self, letter: &str, part: &Part, several: bool) -> Label {
        let own = self.equations.label(part.places[0]).plain();
        if several || self.equations.names.is_taken(letter) { Label::new(letter, own) } else { Label::new(letter, "") }
    }

    /// omega = sqrt(k/m), zeta = c/(2 sqrt(k m)), and the poles.
    fn single(&self, place: usize, part: &Part, several: bool) -> Vec<Item> {
        let linear = &self.equations.linear;
        let entry = |matrix: &[Vec<Entry>]| matrix[place][place].clone();
        let (mass, stiffness) = (entry(&linear.mass), entry(&linear.stiffness));
        let Some(square) = stiffness.sum.over(&mass.sum).map(|square| square.simplified()) else { return Vec::new() };
        let omega = Formula::Name(self.lettered("omega", part, several));
        let value = stiffness.value.checked_div(&mass.value);
        let mut items = Vec::new();
        match value {
            Some(value) if value.is_positive() => {
                let root = self.build.sum(&self.equations.names.length(&square));
                let shown = value.sqrt().map_or_else(String::new, |root| certain_number(&root, DIGITS));
                items.push(Item::Formula {
                    formula: omega.clone().equal(root).equal(Formula::Decimal(shown)),
                    note: vec![words("rad/s")],
                });
            }
            Some(value) if value.is_negative() => {
                let formula = Formula::Power(Box::new(omega.clone()), 2).equal(self.build.sum(&square));
                items.push(Item::Formula {
                    formula: formula.equal(signed_decimal(&value)),
                    note: vec![words("1/s^2: the rest is unstable")],
                });
                return items;
            }
            _ => return items,
        }
        if part.damped {
            items.extend(self.damped(place, part, several, &omega));
        }
        items
    }

    fn damped(&self, place: usize, part: &Part, several: bool, omega: &Formula) -> Vec<Item> {
        let linear = &self.equations.linear;
        let entry = |matrix: &[Vec<Entry>]| matrix[place][place].clone();
        let (mass, damping, stiffness) = (entry(&linear.mass), entry(&linear.damping), entry(&linear.stiffness));
        let mut items = Vec::new();
        let zeta = Formula::Name(self.lettered("zeta", part, several));
        let critical = self.equations.names.length(&(&stiffness.sum * &mass.sum)).scaled(&Rational::from(2));
        let ratio = damping.sum.over(&critical).map(|ratio| ratio.simplified()).unwrap_or_default();
        let value =
            (&stiffness.value * &mass.value).sqrt().and_then(|root| damping.value.checked_div(&(&root + &root)));
        let Some(value) = value else { return items };
        items.push(display(zeta.clone().equal(self.build.sum(&ratio)).equal(signed_decimal(&value))));
        let is_below = |number: &Number| (&Number::ONE - &number.abs()).is_positive();
        let one = Formula::Number(Rational::ONE);
        let square = Formula::Power(Box::new(zeta.clone()), 2);
        let decay = Formula::product(vec![zeta, omega.clone()]);
        if is_below(&value) {
            let label = self.lettered("omega", part, several);
            let index = if label.index.is_empty() { "d".into() } else { format!("d,{}", label.index) };
            let damped = Formula::Name(Label::new("omega", index));
            let root = Formula::Root(Box::new(Formula::Sum(vec![(false, one), (true, square)])));
            items.push(display(damped.clone().equal(Formula::product(vec![omega.clone(), root]))));
            for (index, negative) in [("1", false), ("2", true)] {
                let imaginary = Formula::product(vec![Formula::Imaginary, damped.clone()]);
                let pole = Formula::Sum(vec![(true, decay.clone()), (negative, imaginary)]);
                items.push(display(Formula::Name(self.pole(index, part, several)).equal(pole)));
            }
        } else {
            let root = Formula::Root(Box::new(Formula::Sum(vec![(false, square), (true, one)])));
            let root = Formula::product(vec![omega.clone(), root]);
            for (index, negative) in [("1", false), ("2", true)] {
                let pole = Formula::Sum(vec![(true, decay.clone()), (negative, root.clone())]);
                items.push(display(Formula::Name(self.pole(index, part, several)).equal(pole)));
            }
        }
        items
    }

    fn pole(&self, index: &str, part: &Part, several: bool) -> Label {
        let own = self.equations.label(part.places[0]).plain();
        Label::new(self.laplace().word, if several { format!("{index},{own}") } else { index.to_string() })
    }

    /// a_4 omega^4 - a_2 omega^2 + a_0 = 0 and its roots.
    fn pair(&self, part: &Part, several: bool) -> Vec<Item> {
        let linear = &self.equations.linear;
        let undamped = |i: usize, j: usize| -> Vec<Sum> {
            [&linear.stiffness, &linear.mass].map(|matrix| matrix[i][j].sum.clone()).to_vec()
        };
        let [one, other] = part.places[..] else { return Vec::new() };
        let straight = product(&undamped(one, one), &undamped(other, other));
        let across = product(&undamped(one, other), &undamped(other, one));
        let sums: Vec<Sum> = straight.iter().zip(&across).map(|(a, b)| &a.evaluated() - &b.evaluated()).collect();
        let [zeroth, second, fourth] = &sums[..] else { return Vec::new() };
        let names = &self.equations.names;
        let worth = |sum: &Sum| names.worth(sum);
        let (Some(r), Some(p), Some(q)) = (worth(zeroth), worth(second), worth(fourth)) else { return Vec::new() };
        if q.may_be_zero() || sums.iter().any(|sum| sum.terms().len() > MOST_TERMS) {
            return Vec::new();
        }
        let own = |index: &str| {
            let first = self.equations.label(one).plain();
            Formula::Name(Label::new("a", if several { format!("{index},{first}") } else { index.to_string() }))
        };
        let (a0, a2, a4) = (own("0"), own("2"), own("4"));
        let omega = Formula::Name(self.lettered("omega", part, several));
        let power = |exponent| Formula::Power(Box::new(omega.clone()), exponent);
        let polynomial = Formula::Sum(vec![
            (false, Formula::product(vec![a4.clone(), power(4)])),
            (true, Formula::product(vec![a2.clone(), power(2)])),
            (false, a0.clone()),
        ]);
        let mut items = vec![display(polynomial.equal(Formula::zero()))];
        for (name, sum) in [(&a4, fourth.clone()), (&a2, second.clone()), (&a0, zeroth.clone())] {
            items.push(display(name.clone().equal(self.build.sum(&sum))));
        }
        let number = |n: i64| Formula::Number(Rational::from(n));
        let inside = Formula::Sum(vec![
            (false, Formula::Power(Box::new(a2.clone()), 2)),
            (true, Formula::product(vec![number(4), a4.clone(), a0])),
        ]);
        // omega^2 = (a_2 -+ root)/(2 a_4)
        let discriminant = &p.square() - &(&(&q * &r) * &Number::from(4));
        let root = discriminant.sqrt();
        for (index, negative) in [("1", true), ("2", false)] {
            let over = Formula::Sum(vec![(false, a2.clone()), (negative, Formula::Root(Box::new(inside.clone())))]);
            let under = Formula::product(vec![number(2), a4.clone()]);
            let label = self.lettered("omega", part, several);
            let index = if label.index.is_empty() { index.to_string() } else { format!("{index},{}", label.index) };
            let name = Formula::Name(Label::new("omega", index));
            let formula = Formula::Power(Box::new(name.clone()), 2).equal(Formula::quotient(over, under));
            let square = root.as_ref().and_then(|root| {
                let top = if negative { &p - root } else { &p + root };
                top.checked_div(&(&q + &q))
            });
            items.push(display(formula));
            if let Some(value) = square.filter(Number::is_positive).and_then(|square| square.sqrt()) {
                let value = Formula::Decimal(certain_number(&value, DIGITS));
                items.push(Item::Formula { formula: name.equal(value), note: vec![words("rad/s")] });
            }
        }
        items
    }

    // ---- Transfer functions ----

    fn laplace(&self) -> Label {
        let free = ["s", "p", "z"].into_iter().find(|letter| !self.equations.names.is_taken(letter));
        Label::new(free.unwrap_or("s"), "")
    }

    fn transfers(&self, parts: &[Part]) -> Vec<Item> {
        let mut items = Vec::new();
        for part in parts {
            let transfers = transfers(self.equations, part);
            if transfers.is_empty() {
                continue;
            }
            let mut names = self.equations.names.clone();
            let s = Symbol::new(class::LAPLACE, 0);
            names.set(s, self.laplace(), None);
            let build = super::build::Builder { names: &names, ..self.build };
            let shared = transfers.len() > 1 && part.places.len() > 1;
            if shared {
                let whole = polynomial(&build, &part.characteristic, s);
                items.push(display(Formula::Name(self.lettered("Delta", part, parts.len() > 1)).equal(whole)));
            }
            for transfer in transfers.iter().take(MOST_TRANSFERS) {
                let short = transfer.numerator.iter().all(|sum| sum.terms().len() <= MOST_TERMS);
                if !short || transfer.numerator.is_empty() {
                    continue;
                }
                let input = Formula::Name(Label::new(self.equations.inputs[transfer.input].clone(), ""));
                let left = Formula::quotient(Formula::Name(Label::new(transfer.output.clone(), "")), input);
                let right = if shared {
                    let under = Formula::Name(self.lettered("Delta", part, parts.len() > 1));
                    fraction(polynomial(&build, &transfer.numerator, s), under)
                } else {
                    let (over, under) = reduced(transfer);
                    fraction(polynomial(&build, &over, s), polynomial(&build, &under, s))
                };
                items.push(display(left.equal(right)));
            }
        }
        items
    }
}

/// A quotient with its minus sign in front.
fn fraction(over: Formula, under: Formula) -> Formula {
    match over {
        Formula::Sum(terms) if terms.iter().all(|(negative, _)| *negative) => {
            let positive = terms.into_iter().map(|(_, term)| (false, term)).collect();
            Formula::quotient(Formula::sum(positive), under).negated()
        }
        over => Formula::quotient(over, under),
    }
}

/// Cancels common factors of numerator and denominator.
fn reduced(transfer: &Transfer) -> (Vec<Sum>, Vec<Sum>) {
    // Powers of two different variables keep the terms separate.
    let variables = [0, 1].map(|place| Symbol::new(class::LAPLACE, place + 1));
    let both = &in_variable(&transfer.numerator, variables[0]) + &in_variable(&transfer.denominator, variables[1]);
    let shared = common_factors(&both);
    let number = if shared.number.signum() < 0 { -&shared.number } else { shared.number.clone() };
    let is_variable = |factor: &Factor| matches!(factor, Factor::Name(symbol) if symbol.class() == class::LAPLACE);
    let (_, factors): (Product, Product) = shared.product.split(is_variable);
    let Some(inverse) = Sum::term(factors, number).inverse() else {
        return (transfer.numerator.clone(), transfer.denominator.clone());
    };
    let divided = |sums: &[Sum]| sums.iter().map(|sum| sum * &inverse).collect();
    (divided(&transfer.numerator), divided(&transfer.denominator))
}

/// Highest power first.
fn polynomial(build: &super::build::Builder, coefficients: &[Sum], variable: Symbol) -> Formula {
    let mut terms = Vec::new();
    for (power, coefficient) in coefficients.iter().enumerate().rev().filter(|(_, sum)| !sum.is_zero()) {
        let (negative, front) = build.signed(coefficient);
        let behind = match power {
            0 => Formula::Number(Rational::ONE),
            power => build.term(&Product::of(Factor::Name(variable), power as i32), &Rational::ONE, &[]),
        };
        terms.push((negative, Formula::product(vec![front, behind])));
    }
    Formula::sum(terms)
}

fn signed_decimal(value: &Number) -> Formula {
    let decimal = Formula::Decimal(certain_number(&value.abs(), DIGITS));
    if value.is_negative() { decimal.negated() } else { decimal }
}
