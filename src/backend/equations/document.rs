//! The layout of the equations: sections of sentences and formulas, the same for every form.

use super::build::{Builder, is_dynamic};
use super::formula::Formula;
use crate::backend::decimal::{certain_number, certain_whole};
use crate::base::{Dimension, Number};
use crate::equations::energy::{Element, Stretch};
use crate::equations::lagrange::Equation;
use crate::equations::linear::still;
use crate::equations::motion::Coordinate;
use crate::equations::names::{Label, class};
use crate::equations::{Entry, Equations};
use crate::symbols::{Factor, Lengths, Sum, Symbol};

/// What is written.
#[derive(Clone, Debug)]
pub struct Document {
    pub title: String,
    pub sections: Vec<Section>,
}

#[derive(Clone, Debug)]
pub struct Section {
    pub heading: &'static str,
    pub items: Vec<Item>,
}

#[derive(Clone, Debug)]
pub enum Item {
    Paragraph(Vec<Inline>),
    Formula {
        formula: Formula,
        note: Vec<Inline>,
    },
    /// Matrices with their names, in rows.
    Matrices(Vec<(Formula, Vec<Vec<Formula>>)>),
}

#[derive(Clone, Debug)]
pub enum Inline {
    Text(String),
    Formula(Formula),
}

/// Matrices of more coordinates are not shown as matrices.
const MOST_MATRIX: usize = 8;
pub const DIGITS: usize = 6;

pub fn document(equations: &Equations) -> Document {
    let writer = Writer { equations, build: Builder::new(&equations.names) };
    let sections = [
        writer.assumptions(),
        writer.energies(),
        writer.nonlinear(),
        writer.rest(),
        writer.linear(),
        writer.values(),
        writer.solutions(),
    ];
    let n = equations.linear.coordinates.len();
    let title =
        format!("{} · equations of motion, {n} {}", equations.model, if n == 1 { "freedom" } else { "freedoms" });
    Document { title, sections: sections.into_iter().filter(|section| !section.items.is_empty()).collect() }
}

pub struct Writer<'a> {
    pub equations: &'a Equations,
    pub build: Builder<'a>,
}

pub fn words(text: impl Into<String>) -> Inline {
    Inline::Text(text.into())
}

pub fn paragraph(text: impl Into<String>) -> Item {
    Item::Paragraph(vec![words(text)])
}

pub fn display(formula: Formula) -> Item {
    Item::Formula { formula, note: Vec::new() }
}

impl Writer<'_> {
    fn name(&self, symbol: Symbol) -> Formula {
        Formula::Name(self.equations.names.label(symbol))
    }

    /// `T`, `V_2`; the letter of a quantity that is not a name of the model.
    /// Where the model has a name of its own like it, energies are E_kin, E_pot, E_dis and matrices have the index mat.
    fn letter(&self, symbol: &'static str, index: Option<Formula>) -> Formula {
        let taken = self.equations.names.is_taken(symbol) || self.equations.inputs.iter().any(|input| input == symbol);
        let (symbol, distinct) = match symbol {
            _ if !taken || index.is_some() => (symbol, None),
            "T" => ("E", Some("kin")),
            "V" => ("E", Some("pot")),
            "D" => ("E", Some("dis")),
            other => (other, Some("mat")),
        };
        let distinct = distinct.map(|word| Formula::Name(Label::new(word, "")));
        Formula::Symbol(symbol, index.or(distinct).map(Box::new))
    }

    fn coordinate(&self, index: usize) -> &Coordinate {
        &self.equations.motion.coordinates[index]
    }

    // ---- 1 Assumptions ----

    fn assumptions(&self) -> Section {
        let motion = &self.equations.motion;
        let mut items = vec![paragraph(
            "Bodies are rigid, joints without friction, and the motion stays in the plane. x points right, y up; angles are positive \
             counter-clockwise. Springs and dampers follow their laws at any displacement; the linearised equations keep terms of \
             first order in the coordinates and neglect those of second order and above.",
        )];
        let moved = &self.equations.rest.moved;
        items.push(paragraph(if moved.is_empty() {
            "Coordinates are measured from rest, which is the scene as drawn."
        } else {
            "Coordinates are measured from rest, which differs from the scene as drawn by the values of section 4."
        }));
        for (index, coordinate) in motion.coordinates.iter().enumerate() {
            let what = self.described(index, coordinate);
            items.push(Item::Paragraph(vec![
                Inline::Formula(self.name(coordinate.symbols[0])),
                words(format!(": {what}")),
            ]));
        }
        items.extend(self.names());
        Section { heading: "1 Assumptions and coordinates", items }
    }

    fn described(&self, index: usize, coordinate: &Coordinate) -> String {
        let body = &self.equations.bodies[index];
        let prescribed = if coordinate.input.is_some() { ", prescribed" } else { "" };
        match coordinate.motion {
            "x" => format!("displacement of {body} to the right{prescribed}"),
            "y" => format!("displacement of {body} upwards{prescribed}"),
            "along" => format!("displacement of {body} along its direction{prescribed}"),
            "slide" => format!("displacement of {body} along its slide"),
            _ => format!("angle of {body}, counter-clockwise{prescribed}"),
        }
    }

    /// What names stand for: the `let`s, and the names that were made up here.
    fn names(&self) -> Vec<Item> {
        let used = self.used();
        let mut items = Vec::new();
        for named in &self.equations.names.given {
            if !used.contains(&named.symbol) {
                continue;
            }
            let name = self.name(named.symbol);
            if let Some(definition) = &named.definition {
                let value = format!("= {}", certain_number(&named.value, DIGITS));
                let unit = match named.dimension {
                    Dimension::FREQUENCY => "1/s".to_string(),
                    dimension => dimension.usual_unit(),
                };
                let note = if definition.as_number().is_some() { unit } else { format!("{value} {unit}") };
                items.push(Item::Formula {
                    formula: name.equal(self.build.sum(definition)),
                    note: vec![words(note.trim())],
                });
            } else if named.text == "g" && self.is_made_up(named.symbol) {
                let value = Formula::Decimal(certain_number(&named.value, DIGITS));
                items.push(Item::Formula {
                    formula: name.equal(value),
                    note: vec![words("m/s^2, the gravity of the model")],
                });
            } else if let Some(source) = &named.source {
                let value = Formula::Decimal(certain_number(&named.value, DIGITS));
                items
                    .push(Item::Formula { formula: name.equal(value), note: vec![words(format!("written {source}"))] });
            }
        }
        items
    }

    fn is_made_up(&self, symbol: Symbol) -> bool {
        symbol.place() == Symbol::new(0, usize::MAX).place()
    }

    /// Names that occur in the energies or equations, those of definitions included.
    fn used(&self) -> std::collections::BTreeSet<Symbol> {
        let energies = &self.equations.energies;
        let mut used = std::collections::BTreeSet::new();
        let mut look = |sum: &Sum| {
            sum.names(&mut |symbol| {
                used.insert(symbol);
            });
        };
        look(&energies.kinetic);
        look(&energies.weights);
        for element in &energies.elements {
            [&element.coefficient, &element.free, &element.tension].into_iter().for_each(&mut look);
            let (Stretch::Plain(sum) | Stretch::Line { square: sum, .. }) = &element.stretch;
            look(sum);
        }
        self.equations.energies.works.iter().for_each(|work| look(&work.displacement));
        self.equations.constraints.iter().for_each(|constraint| look(&constraint.equation));
        if let Some((alpha, beta)) = &self.equations.rayleigh {
            look(alpha);
            look(beta);
        }
        // A `let` may stand on others.
        for named in self.equations.names.given.iter().rev() {
            if let Some(definition) = named.definition.as_ref().filter(|_| used.contains(&named.symbol)) {
                definition.names(&mut |symbol| {
                    used.insert(symbol);
                });
            }
        }
        used
    }

    // ---- 2 Energies ----

    fn energies(&self) -> Section {
        let energies = &self.equations.energies;
        let build = self.build.in_front();
        let mut items = vec![display(self.letter("T", None).equal(Formula::sum(build.by_rates(&energies.kinetic))))];
        let mut potential = build.collected(&energies.weights);
        for spring in energies.elements.iter().filter(|element| element.is_spring) {
            potential.extend(self.spring_energy(spring));
        }
        if !potential.is_empty() {
            potential.sort_by_key(|(negative, _)| *negative);
            items.push(display(self.letter("V", None).equal(Formula::sum(potential))));
        }
        let mut dissipation = Vec::new();
        for damper in energies.elements.iter().filter(|element| !element.is_spring) {
            dissipation.extend(self.damper_power(damper));
        }
        if !dissipation.is_empty() {
            items.push(display(self.letter("D", None).equal(Formula::sum(dissipation))));
        }
        for equation in &self.equations.nonlinear {
            if !equation.forces.is_zero() {
                let index = self.name(self.coordinate(equation.coordinate).symbols[0]);
                let force = Formula::sum(self.ordered(&equation.forces));
                items.push(display(self.letter("Q", Some(index)).equal(force)));
            }
        }
        items.extend(self.lengths());
        Section { heading: "2 Energies, dissipation and generalised forces", items }
    }

    fn lengths(&self) -> Vec<Item> {
        let lengths = self.equations.energies.lengths.0.iter();
        lengths
            .map(|(length, square)| display(self.name(*length).equal(Formula::Root(Box::new(self.build.sum(square))))))
            .collect()
    }

    /// `1/2 k (x_2 - x_1)^2`, and the tension that it has besides.
    fn spring_energy(&self, spring: &Element) -> Vec<(bool, Formula)> {
        let build = self.build.in_front();
        let stretched = &spring.stretch.sum() - &spring.free;
        let mut terms = Vec::new();
        terms.extend(self.half_square(&spring.coefficient, &stretched));
        if !spring.tension.is_zero() {
            let (negative, stretch) = build.signed(&stretched);
            let (opposite, tension) = build.signed(&spring.tension);
            terms.push((negative != opposite, Formula::product(vec![tension, stretch])));
        }
        terms
    }

    fn damper_power(&self, damper: &Element) -> Vec<(bool, Formula)> {
        match &damper.stretch {
            Stretch::Plain(stretch) => {
                let rate = self.equations.motion.rate(stretch, &Lengths::default());
                self.half_square(&damper.coefficient, &rate).into_iter().collect()
            }
            Stretch::Line { length, .. } => {
                let label = self.equations.names.label(*length);
                let rate = Formula::Power(Box::new(Formula::Name(Label { dots: 1, ..label })), 2);
                let half = Sum::one().halved();
                let (negative, coefficient) = self.build.in_front().signed(&(&damper.coefficient * &half));
                vec![(negative, Formula::product(vec![coefficient, rate]))]
            }
        }
    }

    /// c x^2/2: a sum is squared in brackets.
    fn half_square(&self, coefficient: &Sum, of: &Sum) -> Option<(bool, Formula)> {
        let build = self.build.in_front();
        if of.is_zero() || coefficient.is_zero() {
            return None;
        }
        if of.terms().len() == 1 {
            let whole = (coefficient * &of.square()).halved();
            return Some(build.signed(&whole));
        }
        let (negative, front) = build.signed(&coefficient.halved());
        let square = Formula::Power(Box::new(build.plain_sum(of)), 2);
        Some((negative, Formula::product(vec![front, square])))
    }

    // ---- 3 Nonlinear equations ----

    fn nonlinear(&self) -> Section {
        let mut items = Vec::new();
        for constraint in &self.equations.constraints {
            let multiplier = Inline::Formula(self.name(constraint.multiplier));
            let note = vec![words(format!("held by {}, with the multiplier ", constraint.name)), multiplier];
            let formula = Formula::sum(self.build.collected(&constraint.equation)).equal(Formula::zero());
            items.push(Item::Formula { formula, note });
        }
        for equation in &self.equations.nonlinear {
            items.push(display(self.equation(equation)));
        }
        let dampers = self.equations.energies.elements.iter().filter(|element| !element.is_spring);
        for damper in dampers {
            if let Stretch::Line { length, square, .. } = &damper.stretch {
                let rate = self.equations.motion.rate(square, &Lengths::default()).halved();
                let label = self.equations.names.label(*length);
                let left = Formula::Name(Label { dots: 1, ..label });
                let right = Formula::quotient(self.build.sum(&rate), self.name(*length));
                items.push(display(left.equal(right)));
            }
        }
        Section { heading: "3 Equations of motion", items }
    }

    /// Accelerations first, then what squares of rates, rates and positions do; what is prescribed stands on the right.
    fn equation(&self, equation: &Equation) -> Formula {
        let plain = self.without_balance(equation);
        let (mut left, mut right) = (Vec::new(), Vec::new());
        for (moving, part) in plain.collected(is_driving) {
            match moving.factors() {
                [] => left.push(part),
                _ => {
                    let whole = &Sum::term(moving, crate::base::Rational::ONE) * &part;
                    // A prescribed motion that nothing else multiplies.
                    if part.mentions(&is_free_motion) { left.push(whole) } else { right.push(-&whole) }
                }
            }
        }
        let left = left.iter().fold(Sum::ZERO, |sum, part| &sum + part);
        let right = right.iter().fold(equation.forces.clone(), |sum, part| &sum + part);
        let mut terms = self.ordered(&left);
        for line in &equation.lines {
            terms.push(self.line(line));
        }
        for (multiplier, slope) in &equation.reactions {
            let (negative, slope) = self.build.signed(slope);
            terms.push((negative, Formula::product(vec![slope, self.name(*multiplier)])));
        }
        Formula::sum(terms).equal(Formula::sum(self.ordered(&right)))
    }

    /// The equation less the forces that balance each other at rest, where these are all that is constant.
    fn without_balance(&self, equation: &Equation) -> Sum {
        let constant: Vec<_> =
            equation.plain.terms().iter().filter(|(product, _)| !product.mentions(&is_dynamic)).cloned().collect();
        let constant = Sum::of_terms(constant);
        let varying = &equation.plain - &constant;
        let balanced = equation.lines.is_empty() && equation.reactions.is_empty() && still(&varying).is_zero();
        if balanced { varying } else { equation.plain.clone() }
    }

    /// Terms collected by acceleration, then by products of rates, then by position.
    fn ordered(&self, sum: &Sum) -> Vec<(bool, Formula)> {
        let mut terms: Vec<(u8, bool, Formula)> = Vec::new();
        for (quick, part) in sum.collected(is_quick) {
            let behind = self.build.term(&quick, &crate::base::Rational::ONE, &[]);
            let order = match quick.factors() {
                [] => {
                    let places = self.build.collected(&part);
                    terms.extend(places.into_iter().map(|(negative, formula)| (3, negative, formula)));
                    continue;
                }
                [(factor, 1)] if !is_rate(factor) => 0,
                [(_, 1)] => 2,
                _ => 1,
            };
            let (negative, front) = self.build.signed(&part);
            terms.push((order, negative, Formula::product(vec![front, behind])));
        }
        terms.sort_by_key(|(order, ..)| *order);
        terms.into_iter().map(|(_, negative, formula)| (negative, formula)).collect()
    }

    /// `k (l - l_0) + T`
    fn pull(&self, element: &Element) -> Formula {
        let (negative, stiffness) = self.build.signed(&element.coefficient);
        let stretched = self.build.plain_sum(&(&element.stretch.sum() - &element.free));
        let (opposite, tension) = self.build.signed(&element.tension);
        if element.coefficient.is_zero() {
            return if opposite { tension.negated() } else { tension };
        }
        Formula::Sum(vec![(negative, Formula::product(vec![stiffness, stretched])), (opposite, tension)])
    }

    /// `k (1 - l_0/l) slope`.
    fn line(&self, line: &crate::equations::lagrange::Line) -> (bool, Formula) {
        let element = &self.equations.energies.elements[line.element];
        let (mut negative, slope) = self.build.signed(&line.slope);
        let name = match &element.stretch {
            Stretch::Line { length, .. } => self.name(*length),
            Stretch::Plain(stretch) => {
                let pull = if element.is_spring {
                    if element.tension.is_zero() {
                        let (opposite, front) = self.build.signed(&element.coefficient);
                        let (other, stretched) = self.build.signed(&(stretch - &element.free));
                        negative ^= opposite != other;
                        Formula::product(vec![front, stretched])
                    } else {
                        self.pull(element)
                    }
                } else {
                    let rate = self.equations.motion.rate(stretch, &Lengths::default());
                    let (opposite, front) = self.build.signed(&element.coefficient);
                    let (other, rate) = self.build.signed(&rate);
                    negative ^= opposite != other;
                    Formula::product(vec![front, rate])
                };
                return (negative, Formula::product(vec![pull, slope]));
            }
        };
        if !element.is_spring {
            let Formula::Name(label) = &name else { return (false, Formula::zero()) };
            let rate = Formula::Name(Label { dots: 1, ..label.clone() });
            let (opposite, coefficient) = self.build.signed(&element.coefficient);
            let pull = Formula::quotient(Formula::product(vec![coefficient, rate]), name);
            return (negative != opposite, Formula::product(vec![pull, slope]));
        }
        let (opposite, stiffness) = self.build.signed(&element.coefficient);
        negative ^= opposite;
        let pull = if element.tension.is_zero() {
            let (shorter, free) = self.build.signed(&element.free);
            if element.free.is_zero() {
                stiffness
            } else {
                let share = Formula::Quotient(Box::new(free), Box::new(name));
                let one = Formula::Number(crate::base::Rational::ONE);
                Formula::product(vec![stiffness, Formula::Sum(vec![(false, one), (!shorter, share)])])
            }
        } else {
            Formula::quotient(self.pull(element), name)
        };
        (negative, Formula::product(vec![pull, slope]))
    }

    // ---- 4 Rest ----

    fn rest(&self) -> Section {
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
                let value = if self.equations.names.value(*symbol).is_some_and(Number::is_negative) {
                    value.negated()
                } else {
                    value
                };
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

    // ---- 5 Linearised ----

    fn linear(&self) -> Section {
        let linear = &self.equations.linear;
        let n = linear.coordinates.len();
        let mut items = Vec::new();
        for (index, sum) in &linear.dependent {
            let name = self.name(self.coordinate(*index).symbols[0]);
            items.push(display(name.equal(Formula::sum(self.build.collected(sum)))));
        }
        for (length, square) in &linear.lengths {
            items.push(display(self.name(*length).equal(Formula::Root(Box::new(self.build.sum(square))))));
        }
        for place in 0..n {
            items.push(display(self.linear_equation(place)));
        }
        if let Some((alpha, beta)) = &self.equations.rayleigh {
            items.push(Item::Paragraph(vec![
                words("Rayleigh damping adds "),
                Inline::Formula(Formula::Sum(vec![
                    (false, Formula::product(vec![self.build.sum(alpha), self.letter("M", None)])),
                    (false, Formula::product(vec![self.build.sum(beta), self.letter("K", None)])),
                ])),
                words(" to the damping matrix."),
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
        }
        Section { heading: "5 Linearised equations", items }
    }

    fn matrix(&self, entries: &[Vec<Entry>]) -> Vec<Vec<Formula>> {
        entries.iter().map(|row| row.iter().map(|entry| self.build.sum(&entry.sum)).collect()).collect()
    }

    /// One row of M q'' + C q' + K q = B u.
    fn linear_equation(&self, place: usize) -> Formula {
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

    // ---- 6 Values ----

    fn values(&self) -> Section {
        let linear = &self.equations.linear;
        let mut items = Vec::new();
        if linear.coordinates.len() <= MOST_MATRIX {
            for (name, matrix) in [("M", &linear.mass), ("C", &linear.damping), ("K", &linear.stiffness)] {
                for (i, row) in matrix.iter().enumerate() {
                    for (j, entry) in row.iter().enumerate().skip(i) {
                        if entry.sum.is_zero() || entry.sum.as_number().is_some() {
                            continue;
                        }
                        let value = Formula::Decimal(certain_whole(&entry.value, DIGITS));
                        let formula =
                            Formula::Symbol(name, Some(Box::new(self.place(i, j)))).equal(self.build.sum(&entry.sum));
                        items.push(Item::Formula { formula: formula.equal(value), note: Vec::new() });
                    }
                }
            }
        }
        items.push(paragraph(
            "Every entry of M, C, K and of the inputs has been compared with those of `vibc analyze`, and the equations of motion \
             with derivatives of the energies at random states.",
        ));
        Section { heading: "6 Values", items }
    }

    /// `11`, or `1,12` where a coordinate has two digits.
    fn place(&self, i: usize, j: usize) -> Formula {
        let comma = if self.equations.linear.coordinates.len() > 9 { "," } else { "" };
        Formula::Decimal(format!("{}{comma}{}", i + 1, j + 1))
    }
}

/// Accelerations, rates and forces: what coefficients stand before.
fn is_quick(factor: &Factor) -> bool {
    let forces = [class::ACCELERATION, class::PRESCRIBED_ACCELERATION, class::FORCE];
    is_rate(factor) || matches!(factor, Factor::Name(symbol) if forces.contains(&symbol.class()))
}

fn is_rate(factor: &Factor) -> bool {
    let rates = [class::VELOCITY, class::PRESCRIBED_VELOCITY];
    matches!(factor, Factor::Name(symbol) if rates.contains(&symbol.class()))
}

fn is_driving(factor: &Factor) -> bool {
    matches!(factor, Factor::Name(symbol) if (class::PRESCRIBED..=class::PRESCRIBED_ACCELERATION).contains(&symbol.class()))
}

fn is_free_motion(symbol: Symbol) -> bool {
    (class::COORDINATE..=class::ACCELERATION).contains(&symbol.class()) || symbol.class() == class::LENGTH
}
