//! Section 3: the equations of motion before anything is linearised.

use super::build::is_dynamic;
use super::document::{Inline, Item, Section, Writer, display, paragraph, words};
use super::fold;
use super::formula::{Formula, Running};
use crate::base::{OrderBy, Rational};
use crate::elements::Order;
use crate::equations::lagrange::{Equation, Line};
use crate::equations::loops::{Kept, MOST_TERMS, MOST_TOGETHER, Ratio};
use crate::equations::names::{class, without_motion};
use crate::symbols::{Factor, Lengths, Sum, Symbol};

impl Writer<'_> {
    pub fn nonlinear(&self) -> Section {
        let mut items = Vec::new();
        for constraint in &self.equations.constraints {
            let multiplier = Inline::Formula(self.name(constraint.multiplier));
            let note = vec![words(format!("held by {}, with the multiplier ", constraint.name)), multiplier];
            let formula = Formula::sum(self.build.collect_terms(&constraint.equation)).equal(Formula::zero());
            items.push(Item::Formula { formula, note });
        }
        items.extend(self.rows(self.equations.nonlinear.iter().map(|equation| self.equation(equation)).collect()));
        items.extend(self.length_rates());
        items.extend(self.reduced_items());
        Section { heading: "3 Equations of motion", items }
    }

    /// Equations; those of a `repeat` are written once.
    pub fn rows(&self, rows: Vec<Formula>) -> Vec<Item> {
        let item = |(formula, running): (Formula, Option<Running>)| {
            let range = running.map(|Running { index, first, last }| {
                let numbers =
                    if last > first + 1 { format!("{first}, ..., {last}") } else { format!("{first}, {last}") };
                words(format!("{index} = {numbers}"))
            });
            Item::Formula { formula, note: range.into_iter().collect() }
        };
        fold::rows(rows, fold::index_letter(&self.equations.names)).into_iter().map(item).collect()
    }

    /// The rates of the lengths on which dampers and inerters act.
    fn length_rates(&self) -> Vec<Item> {
        let none = Lengths::default();
        let motion = &self.equations.motion;
        let elements = || self.equations.energies.elements.iter();
        let mut items = Vec::new();
        for (length, square) in self.equations.energies.lengths.roots() {
            let orders = elements().filter(|element| element.stretch.sum() == Sum::name(length)).map(|it| it.order);
            let most = orders.max_by_key(|order| *order as usize);
            let dotted = |dots| self.length_rate(length, dots);
            let rate = motion.rate(square, &none).halve();
            if most.is_some_and(|most| most != Order::Displacement) {
                items.push(display(dotted(1).equal(Formula::quotient(self.build.sum(&rate), dotted(0)))));
            }
            if most == Some(Order::Acceleration) {
                let mut over = self.order_terms(&motion.rate(&rate, &none));
                over.push((true, Formula::Power(Box::new(dotted(1)), 2)));
                items.push(display(dotted(2).equal(Formula::quotient(Formula::sum(over), dotted(0)))));
            }
        }
        items
    }

    /// The equations without multipliers, and how the dependent coordinates follow.
    fn reduced_items(&self) -> Vec<Item> {
        let reduced = match &self.equations.reduced {
            None => return Vec::new(),
            Some(Err(kept)) => {
                return vec![paragraph(format!("The equations stay with their multipliers: {}.", reason(*kept)))];
            }
            Some(Ok(reduced)) => reduced,
        };
        let mut items = vec![paragraph(
            "The constraints give the dependent coordinates or their velocities; put in, the multipliers drop out:",
        )];
        let names = &self.equations.motion.coordinates;
        for follow in &reduced.follows {
            let order = usize::from(!follow.is_constant());
            let term = |ratio: &Ratio| &ratio.short() * &Sum::name(names[ratio.by].symbols[order]);
            let sum = follow.ratios.iter().fold(Sum::ZERO, |sum, ratio| &sum + &term(ratio));
            let left = self.name(names[follow.coordinate].symbols[order]);
            items.push(display(left.equal(Formula::sum(self.build.collect_terms(&sum)))));
        }
        for ratio in reduced.follows.iter().flat_map(|follow| &follow.ratios) {
            if let Some(name) = ratio.name {
                items.push(display(self.name(name).equal(self.build.sum(&ratio.form))));
            }
        }
        items.extend(self.rows(reduced.equations.iter().map(|equation| self.equation(equation)).collect()));
        items
    }

    /// Accelerations first, then terms in squares of rates, rates and positions; prescribed terms are on the right.
    pub fn equation(&self, equation: &Equation) -> Formula {
        let plain = self.without_balance(equation);
        let (mut left, mut right) = (Vec::new(), Vec::new());
        for (moving, part) in plain.collect_by(is_driving) {
            match moving.factors() {
                [] => left.push(part),
                _ => {
                    let whole = &Sum::term(moving, Rational::ONE) * &part;
                    // A prescribed motion without a free factor goes to the right.
                    if part.mentions(&is_free_motion) { left.push(whole) } else { right.push(-&whole) }
                }
            }
        }
        let left = left.iter().fold(Sum::ZERO, |sum, part| &sum + part);
        let forces = self.equations.energies.with_forces(&equation.forces);
        let right = right.iter().fold(forces, |sum, part| &sum + part);
        let mut terms = self.rank_terms(&left);
        for (element, slope) in self.merged_lines(&equation.lines) {
            let (negative, formula) = self.line(&element, &slope);
            let rank = match element.is_linear() {
                true => BEHIND,
                false if element.is_spring() => POSITION,
                false => RATE,
            };
            terms.push((rank, negative, formula));
        }
        terms.order_by_key(|(rank, ..)| *rank);
        let mut terms: Vec<(bool, Formula)> =
            terms.into_iter().map(|(_, negative, formula)| (negative, formula)).collect();
        for (multiplier, slope) in &equation.reactions {
            let (negative, slope) = self.build.sign_and_factor(slope);
            terms.push((negative, Formula::product(vec![slope, self.name(*multiplier)])));
        }
        Formula::sum(terms).equal(Formula::sum(self.order_terms(&right)))
    }

    /// The equation without the forces that balance each other at rest, if these are its only constant terms.
    fn without_balance(&self, equation: &Equation) -> Sum {
        let constant: Vec<_> =
            equation.plain.terms().iter().filter(|(product, _)| !product.mentions(&is_dynamic)).cloned().collect();
        let constant = Sum::of_terms(constant);
        let varying = &equation.plain - &constant;
        // A power of a rate is no force at rest.
        let rests = |line: &Line| {
            let element = &self.equations.energies.elements[line.element];
            !element.is_spring() && !element.is_linear()
        };
        let balanced =
            equation.lines.iter().all(rests) && equation.reactions.is_empty() && without_motion(&varying).is_zero();
        if balanced { varying } else { equation.plain.clone() }
    }

    /// Terms collected by acceleration, then by products of rates, then by position.
    pub fn order_terms(&self, sum: &Sum) -> Vec<(bool, Formula)> {
        let mut terms = self.rank_terms(sum);
        terms.order_by_key(|(rank, ..)| *rank);
        terms.into_iter().map(|(_, negative, formula)| (negative, formula)).collect()
    }

    /// Terms, each with its rank.
    fn rank_terms(&self, sum: &Sum) -> Vec<(u8, bool, Formula)> {
        let mut terms: Vec<(u8, bool, Formula)> = Vec::new();
        for (quick, part) in sum.collect_by(is_quick) {
            let behind = self.build.term(&quick, &Rational::ONE, &[]);
            let order = match quick.factors() {
                [] => {
                    let places = self.build.collect_terms(&part);
                    terms.extend(places.into_iter().map(|(negative, formula)| (POSITION, negative, formula)));
                    continue;
                }
                [(factor, 1)] if !is_rate(factor) => 0,
                [(_, 1)] => RATE,
                _ => 1,
            };
            let (negative, front) = self.build.sign_and_factor(&part);
            terms.push((order, negative, Formula::product(vec![front, behind])));
        }
        terms
    }
}

/// Ranks of terms in an equation: behind accelerations and products of rates.
const RATE: u8 = 2;
const POSITION: u8 = 3;
const BEHIND: u8 = 4;

/// The reason why there is no form without multipliers.
fn reason(kept: Kept) -> String {
    match kept {
        Kept::Together { dependent } => {
            format!("{dependent} coordinates depend on each other, and up to {MOST_TOGETHER} are solved for in symbols")
        }
        Kept::Long { terms } => format!("a velocity ratio would have {terms} terms, and the most are {MOST_TERMS}"),
        Kept::Undecided => "the constraints are not proved to be independent of each other at rest".to_string(),
    }
}

/// Whether a factor is an acceleration, a rate or a force, which coefficients precede.
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
