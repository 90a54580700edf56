//! Sections 2 and 3: energies, dissipation and forces, and the equations of motion before anything is linearised.

use super::build::is_dynamic;
use super::document::{Inline, Item, Section, Writer, display, words};
use super::formula::Formula;
use crate::equations::energy::{Element, Stretch};
use crate::equations::lagrange::{Equation, Line};
use crate::equations::names::{Label, class, still};
use crate::symbols::{Factor, Lengths, Sum, Symbol};

impl Writer<'_> {
    pub fn energies(&self) -> Section {
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

    /// `1/2 k (x_2 - x_1)^2`, plus the term of a pretension.
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

    /// c x^2/2; a sum is squared in brackets.
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

    pub fn nonlinear(&self) -> Section {
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

    /// Accelerations first, then terms with squares of rates, rates and positions; prescribed terms go to the
    /// right-hand side.
    fn equation(&self, equation: &Equation) -> Formula {
        let plain = self.without_balance(equation);
        let (mut left, mut right) = (Vec::new(), Vec::new());
        for (moving, part) in plain.collected(is_driving) {
            match moving.factors() {
                [] => left.push(part),
                _ => {
                    let whole = &Sum::term(moving, crate::base::Rational::ONE) * &part;
                    // A prescribed motion without a free factor goes to the right.
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

    /// The equation without the forces that balance each other at rest, if these are its only constant terms.
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
    fn line(&self, line: &Line) -> (bool, Formula) {
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
