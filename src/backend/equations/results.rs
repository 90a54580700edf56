//! Sections 4 and 5: the rest and the linearised equations.

use super::document::{DIGITS, Inline, Item, Section, Writer, display, paragraph, words};
use super::formula::Formula;
use crate::backend::decimal::certain_number;
use crate::base::Number;
use crate::equations::Entry;
use crate::equations::names::{class, without_motion};
use crate::symbols::Factor;

/// For more coordinates, matrices are not shown as a whole.
pub const MOST_MATRIX: usize = 8;

impl Writer<'_> {
    pub fn rest(&self) -> Section {
        let rest = &self.equations.rest;
        let mut items = Vec::new();
        if rest.moved.is_empty() {
            items.push(paragraph("The scene rests as drawn: every force vanishes there, or is balanced."));
        }
        for (_, condition) in &rest.conditions {
            items.push(display(Formula::sum(self.build.collected(condition)).equal(Formula::zero())));
        }
        for (index, symbol, value) in &rest.moved {
            let closed = rest.closed.iter().find(|(place, _)| place == index);
            let shown = Formula::Decimal(certain_number(value, DIGITS));
            let unit = if self.coordinate(*index).turns { "rad" } else { "m" };
            let (formula, note) = match closed {
                Some((_, form)) => {
                    let note = format!("= {} {unit} from the drawing", certain_number(value, DIGITS));
                    (self.build.sum(form), note)
                }
                None => (shown, format!("{unit} from the drawing{}", if rest.proven { "" } else { ", not proven" })),
            };
            items.push(Item::Formula { formula: self.name(*symbol).equal(formula), note: vec![words(note)] });
        }
        for spring in self.equations.energies.elements.iter().filter(|element| !element.tension.is_zero()) {
            let [(product, _)] = spring.tension.terms() else { continue };
            let [(Factor::Name(symbol), 1)] = product.factors() else { continue };
            if let Some(value) = self.equations.names.value(*symbol).filter(|_| symbol.class() == class::TENSION) {
                let note = vec![words(format!("the tension of {} as drawn, in SI units", spring.name))];
                let value = Formula::Decimal(certain_number(&value.abs(), DIGITS));
                let is_pushed = self.equations.names.value(*symbol).is_some_and(Number::is_negative);
                let value = if is_pushed { value.negated() } else { value };
                let closed = rest.tensions.iter().find(|(known, _)| known == symbol);
                let value = closed.map_or(value.clone(), |(_, form)| self.build.sum(form).equal(value));
                items.push(Item::Formula { formula: self.name(*symbol).equal(value), note });
            }
        }
        for (multiplier, form, value) in &rest.reactions {
            let formula = match form {
                Some(form) if form.terms().len() <= 4 => self.build.sum(form),
                _ => Formula::Decimal(certain_number(value, DIGITS)),
            };
            items.push(display(self.name(*multiplier).equal(formula)));
        }
        Section { heading: "4 Rest", items }
    }

    pub fn linear(&self) -> Section {
        let linear = &self.equations.linear;
        let n = linear.coordinates.len();
        let mut items = Vec::new();
        for (index, sum) in &linear.dependent {
            let name = self.name(self.coordinate(*index).symbols[0]);
            items.push(display(name.equal(Formula::sum(self.build.collected(sum)))));
        }
        for (name, form) in &linear.ratios {
            items.push(display(self.name(*name).equal(self.build.sum(form))));
        }
        for (length, square) in &linear.lengths {
            let apart = self.equations.energies.spans.get(length.place()).cloned().unwrap_or_default();
            let apart = apart.each_ref().map(without_motion);
            items.push(display(self.name(*length).equal(self.build.length(square, &apart))));
        }
        items.extend(self.rows((0..n).map(|place| self.linear_equation(place)).collect()));
        if let Some((alpha, beta)) = &self.equations.rayleigh {
            items.push(Item::Paragraph(vec![
                words("The damping matrix contains Rayleigh damping, "),
                Inline::Formula(Formula::Sum(vec![
                    (false, Formula::product(vec![self.build.sum(alpha), self.letter("M", None)])),
                    (false, Formula::product(vec![self.build.sum(beta), self.letter("K", None)])),
                ])),
                words(", which belongs to no element."),
            ]));
        }
        if let Some(ratio) = &self.equations.modal_damping {
            let percent = certain_number(&(ratio * &Number::from(100)), DIGITS);
            items.push(paragraph(format!(
                "Modal damping of {percent} % is added mode by mode; it has no entries in symbols."
            )));
        }
        if n <= MOST_MATRIX {
            let mut matrices = vec![(self.letter("M", None), self.matrix(&linear.mass))];
            if linear.damping.iter().flatten().any(|entry| !entry.sum.is_zero()) {
                matrices.push((self.letter("C", None), self.matrix(&linear.damping)));
            }
            matrices.push((self.letter("K", None), self.matrix(&linear.stiffness)));
            items.push(Item::Matrices(matrices));
        } else if self.entries().is_some() {
            items.push(paragraph("M, C and K are symmetric; section 6 lists their entries other than zero."));
        }
        Section { heading: "5 Linearised equations", items }
    }

    fn matrix(&self, entries: &[Vec<Entry>]) -> Vec<Vec<Formula>> {
        entries.iter().map(|row| row.iter().map(|entry| self.build.sum(&entry.sum)).collect()).collect()
    }

    /// One row of M q'' + C q' + K q = B u.
    pub fn linear_equation(&self, place: usize) -> Formula {
        let linear = &self.equations.linear;
        let mut terms = Vec::new();
        for (order, matrix) in [(2, &linear.mass), (1, &linear.damping), (0, &linear.stiffness)] {
            for (column, entry) in matrix[place].iter().enumerate() {
                if entry.sum.is_zero() {
                    continue;
                }
                let symbol = self.coordinate(linear.coordinates[column]).symbols[order];
                let (negative, front) = self.build.signed(&entry.sum);
                terms.push((negative, Formula::product(vec![front, self.name(symbol)])));
            }
        }
        let mut right = Vec::new();
        for column in &linear.inputs {
            for (order, symbol) in column.symbols.iter().enumerate().rev() {
                let entry = &column.parts[order][place];
                if !entry.is_zero() {
                    let (negative, front) = self.build.signed(entry);
                    right.push((negative, Formula::product(vec![front, self.name(*symbol)])));
                }
            }
        }
        Formula::sum(terms).equal(Formula::sum(right))
    }
}
