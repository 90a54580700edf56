//! Section 7: natural frequencies, poles and transfer functions in closed form, and with numbers for larger parts.

use super::build::{Builder, absolute};
use super::document::{DIGITS, Inline, Item, Section, Writer, display, words};
use super::formula::{Formula, Shown, as_shown};
use crate::backend::decimal::certain_number;
use crate::base::{Number, Rational};
use crate::equations::closed::{MOST_TERMS, Part};
use crate::equations::names::{Label, Names, class};
use crate::equations::transfer::Transfer;
use crate::symbols::{Factor, Product, Sum, Symbol};

/// The most transfer functions that are written out.
const MOST_TRANSFERS: usize = 12;

impl Writer<'_> {
    pub fn solutions(&self) -> Section {
        let parts = &self.equations.parts;
        let mut items = Vec::new();
        for part in parts {
            items.extend(self.introduce_part(part));
            match part.places[..] {
                [_] => items.extend(self.single(part)),
                [_, _] => items.extend(self.pair(part)),
                _ => {}
            }
        }
        for number in 0..parts.len() {
            items.extend(self.transfers(number));
        }
        Section { heading: "7 Natural frequencies, poles and transfer functions", items }
    }

    /// A letter, with the index of the part if there are several parts or the model uses the letter.
    fn part_label(&self, letter: &str, part: &Part) -> Label {
        let is_shared = self.equations.parts.len() > 1 || self.equations.names.is_taken(letter);
        Label::new(letter, if is_shared { self.index_of(part) } else { String::new() })
    }

    /// The index of a part, as short as it is its own: `theta`, the body of `x_table`, the component of `x_left.box`, else its number.
    fn index_of(&self, part: &Part) -> String {
        let parts = &self.equations.parts;
        let words = |part: &Part| -> Option<String> {
            let label = self.equations.label(part.places[0]);
            let own = if label.index.is_empty() { label.word } else { label.index };
            let shortest = own.split('.').next().unwrap_or_default().to_string();
            let is_taken = ["omega", "zeta", "Delta"]
                .iter()
                .any(|letter| self.equations.names.is_taken(&format!("{letter}_{shortest}")));
            (!is_taken).then_some(shortest)
        };
        let own = words(part);
        let is_own = own.is_some() && parts.iter().filter(|other| words(other) == own).count() == 1;
        let number = || parts.iter().position(|other| other.places == part.places).unwrap_or(0) + 1;
        own.filter(|_| is_own).unwrap_or_else(|| number().to_string())
    }

    /// The coordinates of a part, if its index does not already name one of them.
    fn introduce_part(&self, part: &Part) -> Option<Item> {
        let labels: Vec<Label> = part.places.iter().map(|place| self.equations.label(*place)).collect();
        let index = self.index_of(part);
        let is_plain = labels.len() == 1 && (labels[0].word == index || labels[0].index == index);
        if self.equations.parts.len() < 2 || is_plain || part.squares.is_empty() {
            return None;
        }
        let mut sentence = vec![words(format!("Part {index}: "))];
        for (place, label) in labels.into_iter().enumerate() {
            sentence.extend((place > 0).then(|| words(" and ")));
            sentence.push(Inline::Formula(Formula::Name(label)));
        }
        Some(Item::Paragraph(sentence))
    }

    /// The name that a sum is, which then needs no other.
    fn bare_name(&self, sum: &Sum) -> Option<Formula> {
        match sum.terms() {
            [(product, coefficient)] if coefficient.is_one() => match product.factors() {
                [(Factor::Name(symbol), 1)] => Some(Formula::Name(self.equations.names.label(*symbol))),
                _ => None,
            },
            _ => None,
        }
    }

    /// omega = sqrt(k/m), zeta = c/(2 sqrt(k m)), and the poles.
    fn single(&self, part: &Part) -> Vec<Item> {
        let Some((square, value)) = part.squares.first().and_then(|it| Some((it.form.as_ref()?, it.value.as_ref()?)))
        else {
            return Vec::new();
        };
        let omega = Formula::Name(self.part_label("omega", part));
        if value.is_negative() {
            let formula = Formula::Power(Box::new(omega), 2).equal(self.build.sum(square));
            let note = vec![words("1/s^2: the rest is unstable")];
            return vec![Item::Formula { formula: formula.equal(signed_decimal(value)), note }];
        }
        if !value.is_positive() {
            return Vec::new();
        }
        let root = self.equations.names.length(square);
        let shown = value.sqrt().map_or_else(String::new, |root| certain_number(&root, DIGITS));
        let formula = with_value(omega.clone(), self.build.sum(&root), Formula::Decimal(shown));
        let mut items = vec![Item::Formula { formula, note: vec![words("rad/s")] }];
        let omega = self.bare_name(&root).unwrap_or(omega);
        if let Some((ratio, value)) = &part.damping_ratio {
            items.extend(self.damped_items(part, ratio, value, &omega));
        }
        items
    }

    fn damped_items(&self, part: &Part, ratio: &Sum, value: &Number, omega: &Formula) -> Vec<Item> {
        let bare = self.bare_name(ratio);
        let zeta = bare.clone().unwrap_or_else(|| Formula::Name(self.part_label("zeta", part)));
        let decimal = signed_decimal(value);
        let stated = match bare {
            Some(_) => zeta.clone().equal(decimal),
            None => with_value(zeta.clone(), self.build.sum(ratio), decimal),
        };
        let mut items = vec![display(stated)];
        let is_below = (&Number::ONE - &value.abs()).is_positive();
        let one = Formula::Number(Rational::ONE);
        let square = Formula::Power(Box::new(zeta.clone()), 2);
        let decay = Formula::product(vec![zeta, omega.clone()]);
        let inside = if is_below { vec![(false, one), (true, square)] } else { vec![(false, square), (true, one)] };
        let mut root = Formula::product(vec![omega.clone(), Formula::Root(Box::new(Formula::Sum(inside)))]);
        if is_below {
            let label = self.part_label("omega", part);
            let index = if label.index.is_empty() { "d".into() } else { format!("d,{}", label.index) };
            let damped = Formula::Name(Label::new("omega", index));
            items.push(display(damped.clone().equal(root)));
            root = Formula::product(vec![Formula::Imaginary, damped]);
        }
        for (index, negative) in [("1", false), ("2", true)] {
            let pole = Formula::Sum(vec![(true, decay.clone()), (negative, root.clone())]);
            items.push(display(Formula::Name(self.pole(index, part)).equal(pole)));
        }
        items
    }

    fn pole(&self, index: &str, part: &Part) -> Label {
        let is_shared = self.equations.parts.len() > 1;
        let index = if is_shared { format!("{index},{}", self.index_of(part)) } else { index.to_string() };
        Label::new(self.laplace().word, index)
    }

    /// a_4 omega^4 - a_2 omega^2 + a_0 = 0 and its roots.
    fn pair(&self, part: &Part) -> Vec<Item> {
        let [zeroth, second, fourth] = &part.undamped[..] else { return Vec::new() };
        if fourth.vanishes() {
            return self.single(part);
        }
        let own = |index: &str| {
            let shared = self.equations.parts.len() > 1;
            let index = if shared { format!("{index},{}", self.index_of(part)) } else { index.to_string() };
            Formula::Name(Label::new("a", index))
        };
        let (a0, a2, a4) = (own("0"), own("2"), own("4"));
        let omega = Formula::Name(self.part_label("omega", part));
        let power = |exponent| Formula::Power(Box::new(omega.clone()), exponent);
        let is_free = zeroth.vanishes();
        let mut terms = vec![
            (false, Formula::product(vec![a4.clone(), power(4)])),
            (true, Formula::product(vec![a2.clone(), power(2)])),
        ];
        terms.extend((!is_free).then(|| (false, a0.clone())));
        let mut items = vec![display(Formula::Sum(terms).equal(Formula::zero()))];
        for (name, sum) in [(&a4, fourth), (&a2, second), (&a0, zeroth)] {
            if !sum.vanishes() {
                items.push(display(name.clone().equal(self.build.sum(sum))));
            }
        }
        let number = |n: i64| Formula::Number(Rational::from(n));
        let inside = Formula::Sum(vec![
            (false, Formula::Power(Box::new(a2.clone()), 2)),
            (true, Formula::product(vec![number(4), a4.clone(), a0])),
        ]);
        for ((index, negative), square) in [("1", true), ("2", false)].into_iter().zip(&part.squares) {
            let label = self.part_label("omega", part);
            let index = if label.index.is_empty() { index.to_string() } else { format!("{index},{}", label.index) };
            let name = Formula::Name(Label::new("omega", index));
            let root = square.value.as_ref().filter(|value| value.is_positive()).and_then(Number::sqrt);
            let value = root.map(|value| Formula::Decimal(certain_number(&value, DIGITS)));
            let note = vec![words("rad/s")];
            match (&square.form, value) {
                (Some(form), _) if form.is_zero() => {
                    let note = vec![words("a rigid-body mode")];
                    items.push(Item::Formula { formula: name.equal(Formula::zero()), note });
                }
                (Some(form), Some(value)) => {
                    let root = self.build.sum(&self.equations.names.length(form));
                    items.push(Item::Formula { formula: name.equal(root).equal(value), note });
                }
                (form, value) => {
                    // omega^2 = (a_2 -+ root)/(2 a_4)
                    let over =
                        Formula::Sum(vec![(false, a2.clone()), (negative, Formula::Root(Box::new(inside.clone())))]);
                    let under = Formula::product(vec![number(2), a4.clone()]);
                    let right =
                        form.as_ref().map_or_else(|| Formula::quotient(over, under), |form| self.build.sum(form));
                    items.push(display(Formula::Power(Box::new(name.clone()), 2).equal(right)));
                    items.extend(value.map(|value| Item::Formula { formula: name.equal(value), note }));
                }
            }
        }
        items
    }

    // ---- Transfer functions ----

    fn laplace(&self) -> Label {
        let free = ["s", "p", "z"].into_iter().find(|letter| !self.equations.names.is_taken(letter));
        Label::new(free.unwrap_or("s"), "")
    }

    /// The transfer functions of a part; of a larger one its characteristic polynomial too.
    fn transfers(&self, number: usize) -> Vec<Item> {
        let part = &self.equations.parts[number];
        let transfers: Vec<&Transfer> =
            self.equations.transfers.iter().filter(|transfer| transfer.part == number).collect();
        if transfers.is_empty() && part.numbers.is_empty() {
            return Vec::new();
        }
        let mut names = self.equations.names.clone();
        let build = self.build_with_laplace(&mut names);
        let is_shared = !part.numbers.is_empty() || transfers.len() > 1 && part.places.len() > 1;
        let delta = Formula::Name(self.part_label("Delta", part));
        let mut items = Vec::new();
        if is_shared {
            let whole = match part.characteristic.is_empty() {
                true => polynomial_of_numbers(&build, &part.numbers),
                false => polynomial(&build, &part.characteristic),
            };
            items.push(display(delta.clone().equal(whole)));
        }
        for transfer in transfers.into_iter().take(MOST_TRANSFERS) {
            let is_short = transfer.numerator.iter().all(|sum| sum.terms().len() <= MOST_TERMS);
            let right = match (is_shared, transfer.numerator.is_empty()) {
                (_, true) if transfer.numbers.is_empty() => Formula::zero(),
                (_, true) => fraction(polynomial_of_numbers(&build, &transfer.numbers), delta.clone()),
                _ if !is_short => continue,
                (true, false) => {
                    let (numerator, denominator) = over_whole_number(&transfer.numerator);
                    let under = Formula::product(vec![Formula::Number(denominator), delta.clone()]);
                    fraction(polynomial(&build, &numerator), under)
                }
                (false, false) => {
                    let (over, under) = without_fractions(&transfer.reduced);
                    fraction(polynomial(&build, &over), polynomial(&build, &under))
                }
            };
            let input = Formula::Name(Label::new(self.equations.inputs[transfer.input].clone(), ""));
            let output = Label::new(self.equations.outputs[transfer.output].name.clone(), "");
            items.push(display(Formula::quotient(Formula::Name(output), input).equal(right)));
        }
        items
    }

    /// The variable of Laplace's transform gets its name.
    fn build_with_laplace<'n>(&self, names: &'n mut Names) -> Builder<'n> {
        names.set(Symbol::new(class::LAPLACE, 0), self.laplace(), None);
        Builder { names, fractions: self.build.fractions }
    }
}

/// A quotient with its minus sign in front.
fn fraction(over: Formula, under: Formula) -> Formula {
    match over {
        Formula::Sum(terms) if terms.iter().all(|(negative, _)| *negative) => {
            let positive = terms.into_iter().map(|(_, term)| (false, term)).collect();
            Formula::quotient(Formula::sum(positive), under).negate()
        }
        over => Formula::quotient(over, under),
    }
}

/// Coefficients without fractions, over a whole number, so that the numerator contains no quotients.
fn over_whole_number(coefficients: &[Sum]) -> (Vec<Sum>, Rational) {
    let mut numbers = coefficients.iter().flat_map(|sum| sum.terms()).map(|(_, number)| number.to_fraction());
    let common = numbers.try_fold(1i64, |all, number| {
        let (_, denominator) = number?;
        all.checked_mul(denominator / num_integer::gcd(all, denominator))
    });
    let common = Rational::from(common.unwrap_or(1));
    (coefficients.iter().map(|sum| sum.scale(&common)).collect(), common)
}

/// Numerator and denominator, with the denominators of the numerator's fractions moved to the denominator.
fn without_fractions((over, under): &(Vec<Sum>, Vec<Sum>)) -> (Vec<Sum>, Vec<Sum>) {
    let is_fraction = |(_, number): &(Product, Rational)| matches!(as_shown(&absolute(number)), Shown::Fraction(..));
    let over: Vec<Sum> = over.iter().map(Sum::evaluate).collect();
    if !over.iter().flat_map(|sum| sum.terms()).any(is_fraction) {
        return (over, under.clone());
    }
    let (over, common) = over_whole_number(&over);
    (over, under.iter().map(|sum| sum.scale(&common)).collect())
}

/// Highest power first.
fn polynomial(build: &Builder, coefficients: &[Sum]) -> Formula {
    let terms = coefficients.iter().enumerate().rev().filter(|(_, sum)| !sum.is_zero());
    by_powers(build, terms.map(|(power, coefficient)| (power, build.sign_and_factor(coefficient))))
}

fn polynomial_of_numbers(build: &Builder, coefficients: &[Number]) -> Formula {
    let terms = coefficients.iter().enumerate().rev().filter(|(_, number)| !number.is_zero());
    let shown = |number: &Number| match number.exact() {
        Some(one) if one.is_one() || (-one).is_one() => Formula::Number(Rational::ONE),
        _ => Formula::Decimal(certain_number(&number.abs(), DIGITS)),
    };
    by_powers(build, terms.map(|(power, number)| (power, (number.is_negative(), shown(number)))))
}

fn by_powers(build: &Builder, terms: impl Iterator<Item = (usize, (bool, Formula))>) -> Formula {
    let term = |(power, (negative, front)): (usize, (bool, Formula))| {
        let variable = Product::of(Factor::Name(Symbol::new(class::LAPLACE, 0)), power as i32);
        let behind = match power {
            0 => Formula::Number(Rational::ONE),
            _ => build.term(&variable, &Rational::ONE, &[]),
        };
        (negative, Formula::product(vec![front, behind]))
    };
    Formula::sum(terms.map(term).collect())
}

/// `omega = sqrt(k/m) = 200`, and `omega = 200` if the form is that number.
fn with_value(name: Formula, form: Formula, decimal: Formula) -> Formula {
    let number = |formula: &Formula| match formula {
        Formula::Number(number) => Some(number.clone()),
        Formula::Decimal(text) => Rational::from_decimal(text),
        _ => None,
    };
    let is_number = number(&form).is_some_and(|form| number(&decimal) == Some(form));
    if is_number { name.equal(decimal) } else { name.equal(form).equal(decimal) }
}

fn signed_decimal(value: &Number) -> Formula {
    let decimal = Formula::Decimal(certain_number(&value.abs(), DIGITS));
    if value.is_negative() { decimal.negate() } else { decimal }
}
