//! Sections 4 and 5: the rest and the linearised equations.

use super::document::{DIGITS, Inline, Item, Section, Writer, display, paragraph, words};
use super::formula::Formula;
use crate::backend::decimal::certain_number;
use crate::base::Number;
use crate::equations::Entry;
use crate::equations::names::{Label, class, without_motion};
use crate::symbols::{Factor, Sum, Symbol};

/// Maximum number of coordinates for which matrices are shown as a whole.
pub const MOST_MATRIX: usize = 8;

impl Writer<'_> {
    pub fn rest(&self) -> Section {
        let rest = &self.equations.rest;
        let mut items = Vec::new();
        if rest.moved.is_empty() {
            items.push(paragraph("The scene rests as drawn: every force vanishes there, or is balanced."));
        }
        for (_, condition) in &rest.conditions {
            items.push(display(Formula::sum(self.build.collect_terms(condition)).equal(Formula::zero())));
        }
        items.extend(self.names_at_rest(|symbol| self.is_of_rest(symbol)));
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
        let mut shown = Vec::new();
        for spring in self.equations.energies.elements.iter().filter(|element| !element.tension.is_zero()) {
            // Of the spans of a belt there are two in a sum, which is followed by their difference.
            for (product, _) in spring.tension.terms() {
                let [(Factor::Name(symbol), 1)] = product.factors() else { continue };
                if symbol.class() == class::TENSION && !shown.contains(symbol) {
                    shown.push(*symbol);
                    items.extend(self.tension(*symbol, &spring.name));
                }
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

    /// A tension that holds the drawing.
    fn tension(&self, symbol: Symbol, of: &str) -> Option<Item> {
        let value = self.equations.names.value(symbol)?;
        let note = vec![words(format!("the tension of {of} as drawn, in SI units"))];
        let shown = Formula::Decimal(certain_number(&value.abs(), DIGITS));
        let shown = if value.is_negative() { shown.negate() } else { shown };
        let closed = self.equations.rest.tensions.iter().find(|(known, _)| *known == symbol);
        let shown = match closed {
            Some((_, form)) if form.as_number().is_none() => self.build.sum(form).equal(shown),
            _ => shown,
        };
        Some(Item::Formula { formula: self.name(symbol).equal(shown), note })
    }

    pub fn linear(&self) -> Section {
        let linear = &self.equations.linear;
        let n = linear.coordinates.len();
        let mut items = Vec::new();
        for (index, sum) in &linear.dependent {
            let name = self.name(self.coordinate(*index).symbols[0]);
            items.push(display(name.equal(Formula::sum(self.build.collect_terms(sum)))));
        }
        for (name, form) in &linear.ratios {
            items.push(display(self.name(*name).equal(self.build.sum(form))));
        }
        items.extend(self.names_at_rest(|symbol| !self.is_of_rest(symbol)));
        items.extend(self.rows((0..n).map(|place| self.linear_equation(place, self.has_listed_entries())).collect()));
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
            let matrix = |name: &'static str, entries| (self.letter(name, None), self.matrix(name, entries));
            let mut matrices = vec![matrix("M", &linear.mass)];
            if linear.damping.iter().flatten().any(|entry| !entry.sum.is_zero()) {
                matrices.push(matrix("C", &linear.damping));
            }
            matrices.push(matrix("K", &linear.stiffness));
            items.push(Item::Matrices(matrices));
        } else if self.entries().is_some() {
            items.push(paragraph("M, C and K are symmetric; section 6 lists their entries other than zero."));
        }
        Section { heading: "5 Linearised equations", items }
    }

    /// The definitions of chosen names at rest: lengths, lever arms, and tensions divided by lengths.
    fn names_at_rest(&self, is_chosen: impl Fn(Symbol) -> bool) -> Vec<Item> {
        let linear = &self.equations.linear;
        let length = |(length, square): &(Symbol, Sum)| {
            let apart = self.equations.energies.spans.get(length.place()).cloned().unwrap_or_default();
            let form = self.build.length(square, &apart.each_ref().map(without_motion));
            display(self.name(*length).equal(form))
        };
        let part = |(name, form): &(Symbol, Sum)| display(self.name(*name).equal(self.build.sum(form)));
        let lengths = linear.lengths.iter().filter(|(symbol, _)| is_chosen(*symbol)).map(length);
        let parts = linear.parts.iter().filter(|(symbol, _)| is_chosen(*symbol)).map(part);
        lengths.chain(parts).collect()
    }

    /// Whether the conditions of rest mention a name, directly or through the definition of another name.
    fn is_of_rest(&self, symbol: Symbol) -> bool {
        let stands_for = |known: Symbol| self.equations.names.angle_of_cosine(known).unwrap_or(known);
        let is_mentioned =
            |sum: &Sum, symbol: Symbol| sum.mentions(&|known| known == symbol || stands_for(known) == symbol);
        let in_conditions = |symbol: Symbol| {
            self.equations.rest.conditions.iter().any(|(_, condition)| is_mentioned(condition, symbol))
        };
        let parts = &self.equations.linear.parts;
        in_conditions(symbol) || parts.iter().any(|(name, form)| in_conditions(*name) && is_mentioned(form, symbol))
    }

    fn matrix(&self, name: &str, entries: &[Vec<Entry>]) -> Vec<Vec<Formula>> {
        let cell = |i: usize, j: usize| {
            let (negative, formula) = self.entry(name, (i, j), &entries[i][j].sum, true);
            if negative { formula.negate() } else { formula }
        };
        (0..entries.len()).map(|i| (0..entries.len()).map(|j| cell(i, j)).collect()).collect()
    }

    /// Whether section 6 lists the entries, so that a long entry can be written as `K_12` here.
    fn has_listed_entries(&self) -> bool {
        self.equations.linear.coordinates.len() <= MOST_MATRIX
    }

    /// An entry with its sign: by its name in section 6 if it is long and `by_name`. The matrices are symmetric.
    fn entry(&self, name: &str, (i, j): (usize, usize), sum: &Sum, by_name: bool) -> (bool, Formula) {
        /// Terms that are read at a glance.
        const MOST_TERMS: usize = 8;
        if by_name && sum.terms().len() > MOST_TERMS {
            let index = format!("{}{}", i.min(j) + 1, i.max(j) + 1);
            return (false, Formula::Name(Label::new(name, index)));
        }
        self.build.sign_and_factor(sum)
    }

    /// One row of M q'' + C q' + K q = B u, with long entries by their names in section 6, or written out.
    pub fn linear_equation(&self, place: usize, by_name: bool) -> Formula {
        let linear = &self.equations.linear;
        let mut terms = Vec::new();
        for (name, order, matrix) in [("M", 2, &linear.mass), ("C", 1, &linear.damping), ("K", 0, &linear.stiffness)] {
            for (column, entry) in matrix[place].iter().enumerate() {
                if entry.sum.is_zero() {
                    continue;
                }
                let symbol = self.coordinate(linear.coordinates[column]).symbols[order];
                let (negative, front) = self.entry(name, (place, column), &entry.sum, by_name);
                terms.push((negative, Formula::product(vec![front, self.name(symbol)])));
            }
        }
        let mut right = Vec::new();
        for column in &linear.inputs {
            for (order, symbol) in column.symbols.iter().enumerate().rev() {
                let entry = &column.parts[order][place];
                if !entry.is_zero() {
                    let (negative, front) = self.build.sign_and_factor(entry);
                    right.push((negative, Formula::product(vec![front, self.name(*symbol)])));
                }
            }
        }
        right.extend(self.order_terms(&self.unbalances(place)));
        Formula::sum(terms).equal(Formula::sum(right))
    }

    /// The forces of all unbalances on a coordinate, at rest.
    fn unbalances(&self, place: usize) -> Sum {
        let forces = self.equations.linear.inputs.iter().filter_map(|column| Some((column, column.force.as_ref()?)));
        forces.fold(Sum::ZERO, |sum, (column, force)| {
            let entry = column.parts.get(2).and_then(|part| part.get(place)).cloned().unwrap_or_default();
            &sum - &(&entry * force)
        })
    }
}
