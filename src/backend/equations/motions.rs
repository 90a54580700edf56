//! Sections 2 and 3: energies, dissipation and forces, and the equations of motion before anything is linearised.

use super::build::{is_dynamic, powered};
use super::document::{Inline, Item, Section, Writer, display, paragraph, words};
use super::fold;
use super::formula::{Formula, Running};
use crate::base::Rational;
use crate::elements::Order;
use crate::equations::energy::{Element, Stretch};
use crate::equations::lagrange::{Equation, Line};
use crate::equations::loops::{Kept, MOST_TERMS, MOST_TOGETHER, Ratio};
use crate::equations::names::{Label, class, without_motion};
use crate::symbols::{Factor, Lengths, Power, Sum, Symbol, common_factors};

impl Writer<'_> {
    pub fn energies(&self) -> Section {
        let energies = &self.equations.energies;
        let build = self.build.in_front();
        let mut kinetic = build.by_rates(&energies.kinetic);
        for inerter in merged(&energies.elements, Order::Acceleration) {
            kinetic.extend(self.rate_energy(&inerter));
        }
        let letter = fold::index_letter(&self.equations.names);
        let folded = |terms| Formula::sum(fold::terms(terms, letter));
        let mut items = vec![display(self.letter("T", None).equal(folded(kinetic)))];
        let mut potential = build.collected(&energies.weights);
        for spring in merged(&energies.elements, Order::Displacement) {
            potential.extend(self.spring_energy(&spring));
        }
        if !potential.is_empty() {
            potential.sort_by_key(|(negative, _)| *negative);
            items.push(display(self.letter("V", None).equal(folded(potential))));
        }
        let mut dissipation = Vec::new();
        for damper in merged(&energies.elements, Order::Velocity) {
            dissipation.extend(self.rate_energy(&damper));
        }
        if !dissipation.is_empty() {
            items.push(display(self.letter("D", None).equal(folded(dissipation))));
        }
        for equation in &self.equations.nonlinear {
            if !equation.forces.is_zero() {
                let index = self.name(self.coordinate(equation.coordinate).symbols[0]);
                let force = Formula::sum(self.ordered(&energies.with_forces(&equation.forces)));
                items.push(display(self.letter("Q", Some(index)).equal(force)));
            }
        }
        items.extend(self.lengths());
        Section { heading: "2 Energies, dissipation and generalised forces", items }
    }

    /// `1/2 k (x_2 - x_1)^2`, plus the term of a pretension.
    fn spring_energy(&self, spring: &Element) -> Vec<(bool, Formula)> {
        let build = self.build.in_front();
        let stretched = spring.stretched();
        let mut terms = Vec::new();
        terms.extend(match spring.is_linear() {
            true => self.half_square(&spring.coefficient, &stretched),
            false => Some(self.integral(spring, &stretched)),
        });
        if !spring.tension.is_zero() {
            let (negative, stretch) = build.signed(&stretched);
            let (opposite, tension) = build.signed(&spring.tension);
            terms.push((negative != opposite, Formula::product(vec![tension, stretch])));
        }
        terms
    }

    /// `1/4 k (x_2 - x_1)^4`, `1/3 c |x'|^3`: the integral of a power of a law.
    fn integral(&self, element: &Element, of: &Sum) -> (bool, Formula) {
        let (build, exponent) = (self.build.in_front(), element.power.exponent + 1);
        let front = element.coefficient.scaled(&Rational::new(1, i64::from(exponent)));
        let power = Power { exponent, ..element.power };
        match &element.stretch {
            Stretch::Line { length, .. } if !element.is_spring() => {
                let (negative, front) = build.signed(&front);
                (negative, Formula::product(vec![front, powered(power, self.dotted(*length, 1))]))
            }
            _ => build.with_power(&front, power, of),
        }
    }

    /// `1/2 c l'^2`: half the power of a damper, or the energy of an inerter. For a law, the function whose derivative
    /// is the force.
    fn rate_energy(&self, element: &Element) -> Vec<(bool, Formula)> {
        if !element.is_linear() {
            return vec![self.integral(element, &self.answered(element))];
        }
        match &element.stretch {
            Stretch::Plain(stretch) => {
                let rate = self.equations.motion.rate(stretch, &Lengths::default());
                self.half_square(&element.coefficient, &rate).into_iter().collect()
            }
            Stretch::Line { length, .. } => {
                let rate = Formula::Power(Box::new(self.dotted(*length, 1)), 2);
                let half = Sum::one().halved();
                let (negative, coefficient) = self.build.in_front().signed(&(&element.coefficient * &half));
                vec![(negative, Formula::product(vec![coefficient, rate]))]
            }
        }
    }

    /// A length or its rate.
    fn dotted(&self, length: Symbol, dots: u8) -> Formula {
        Formula::Name(Label { dots, ..self.equations.names.label(length) })
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
        // k r^2 (theta_1 - theta_2)^2, not k (r theta_1 - r theta_2)^2.
        let shared = common_factors(of);
        let is_plain = shared.product.is_one() || shared.squared;
        let (front, of) = match is_plain {
            true => (coefficient.clone(), of.clone()),
            false => {
                let shared_square = Sum::term(shared.product.times(&shared.product), Rational::ONE);
                (coefficient * &shared_square, shared.rest.scaled(&shared.number))
            }
        };
        let (negative, front) = build.signed(&front.halved());
        let of = if of.terms().iter().all(|(_, c)| c.signum() < 0) { -&of } else { of };
        let square = Formula::Power(Box::new(build.plain_sum(&of)), 2);
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
        items.extend(self.rows(self.equations.nonlinear.iter().map(|equation| self.equation(equation)).collect()));
        items.extend(self.length_rates());
        items.extend(self.reduced());
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
            let dotted = |dots| self.dotted(length, dots);
            let rate = motion.rate(square, &none).halved();
            if most.is_some_and(|most| most != Order::Displacement) {
                items.push(display(dotted(1).equal(Formula::quotient(self.build.sum(&rate), dotted(0)))));
            }
            if most == Some(Order::Acceleration) {
                let mut over = self.ordered(&motion.rate(&rate, &none));
                over.push((true, Formula::Power(Box::new(dotted(1)), 2)));
                items.push(display(dotted(2).equal(Formula::quotient(Formula::sum(over), dotted(0)))));
            }
        }
        items
    }

    /// The equations without multipliers, and how the dependent coordinates follow.
    fn reduced(&self) -> Vec<Item> {
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
            items.push(display(left.equal(Formula::sum(self.build.collected(&sum)))));
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
        for (moving, part) in plain.collected(is_driving) {
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
        let mut terms = self.ranked(&left);
        for (element, slope) in self.merged_lines(&equation.lines) {
            let (negative, formula) = self.line(&element, &slope);
            let rank = match element.is_linear() {
                true => BEHIND,
                false if element.is_spring() => POSITION,
                false => RATE,
            };
            terms.push((rank, negative, formula));
        }
        terms.sort_by_key(|(rank, ..)| *rank);
        let mut terms: Vec<(bool, Formula)> =
            terms.into_iter().map(|(_, negative, formula)| (negative, formula)).collect();
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
    pub fn ordered(&self, sum: &Sum) -> Vec<(bool, Formula)> {
        let mut terms = self.ranked(sum);
        terms.sort_by_key(|(rank, ..)| *rank);
        terms.into_iter().map(|(_, negative, formula)| (negative, formula)).collect()
    }

    /// Terms, each with its rank.
    fn ranked(&self, sum: &Sum) -> Vec<(u8, bool, Formula)> {
        let mut terms: Vec<(u8, bool, Formula)> = Vec::new();
        for (quick, part) in sum.collected(is_quick) {
            let behind = self.build.term(&quick, &Rational::ONE, &[]);
            let order = match quick.factors() {
                [] => {
                    let places = self.build.collected(&part);
                    terms.extend(places.into_iter().map(|(negative, formula)| (POSITION, negative, formula)));
                    continue;
                }
                [(factor, 1)] if !is_rate(factor) => 0,
                [(_, 1)] => RATE,
                _ => 1,
            };
            let (negative, front) = self.build.signed(&part);
            terms.push((order, negative, Formula::product(vec![front, behind])));
        }
        terms
    }

    /// `k (l - l_0) + T`
    fn pull(&self, element: &Element) -> Formula {
        let (negative, stiffness) = self.build.signed(&element.coefficient);
        let stretched = self.build.plain_sum(&(&element.stretch.sum() - &element.free));
        let (opposite, tension) = self.build.signed(&element.tension);
        if element.coefficient.is_zero() {
            return if opposite { tension.negated() } else { tension };
        }
        let mut terms = vec![(negative, Formula::product(vec![stiffness, stretched]))];
        match tension {
            // Of the two spans of a belt.
            Formula::Sum(own) if !opposite => terms.extend(own),
            tension => terms.push((opposite, tension)),
        }
        Formula::Sum(terms)
    }

    /// Elements that answer one stretch with one lever, as one.
    fn merged_lines(&self, lines: &[Line]) -> Vec<(Element, Sum)> {
        let mut list: Vec<(Element, Sum)> = Vec::new();
        for line in lines {
            let element = &self.equations.energies.elements[line.element];
            let known = list.iter_mut().find(|(known, slope)| is_alike(known, element) && *slope == line.slope);
            match known {
                Some((known, _)) => add(known, element),
                None => list.push((element.clone(), line.slope.clone())),
            }
        }
        list
    }

    /// k L^2 sin(theta) cos(theta): a force and a lever arm of one term each.
    fn single_term(&self, element: &Element, slope: &Sum) -> Option<Sum> {
        let is_plain = matches!(element.stretch, Stretch::Plain(_)) && element.tension.is_zero();
        let answered = self.answered(element);
        let is_single = |sum: &Sum| sum.terms().len() == 1;
        let holds = is_plain && is_single(&answered) && is_single(slope);
        holds.then(|| &(&element.coefficient * &answered) * slope)
    }

    /// The stretch that a spring answers, or the rate that a damper does.
    fn answered(&self, element: &Element) -> Sum {
        let stretch = element.stretch.sum();
        match element.is_spring() {
            true => &stretch - &element.free,
            false => self.equations.motion.rate(&stretch, &Lengths::default()),
        }
    }

    /// `k (l - l_0)^3 slope`: a power of a law.
    fn power(&self, element: &Element, slope: &Sum) -> (bool, Formula) {
        let (power, coefficient) = (element.power, &element.coefficient);
        let Stretch::Line { length, .. } = &element.stretch else {
            let answered = self.answered(element);
            if slope.terms().len() == 1 {
                return self.build.with_power(&(coefficient * slope), power, &answered);
            }
            let (negative, pull) = self.build.with_power(coefficient, power, &answered);
            let (opposite, slope) = self.build.signed(slope);
            return (negative != opposite, Formula::product(vec![pull, slope]));
        };
        let (mut negative, slope) = self.build.signed(slope);
        let (opposite, pull) = match element.is_spring() {
            true => self.build.with_power(coefficient, power, &element.stretched()),
            false => {
                let (opposite, front) = self.build.signed(coefficient);
                (opposite, Formula::product(vec![front, powered(power, self.dotted(*length, 1))]))
            }
        };
        negative ^= opposite;
        (negative, Formula::product(vec![Formula::quotient(pull, self.name(*length)), slope]))
    }

    /// `k (1 - l_0/l) slope`.
    fn line(&self, element: &Element, slope: &Sum) -> (bool, Formula) {
        if !element.is_linear() {
            return self.power(element, slope);
        }
        if let Some(single) = self.single_term(element, slope) {
            return self.build.signed(&single);
        }
        if let (Stretch::Plain(_), [_], true) = (&element.stretch, slope.terms(), element.tension.is_zero()) {
            // k/2 cos(theta) (y + sin(theta)/2): the lever arm in front of the brackets.
            let (negative, front) = self.build.signed(&(&element.coefficient * slope));
            let (opposite, answered) = self.build.signed(&self.answered(element));
            return (negative != opposite, Formula::product(vec![front, answered]));
        }
        // A lever with a divisor stands in front of brackets, which may hold fractions.
        let is_divided =
            slope.terms().iter().flat_map(|(product, _)| product.factors()).any(|(_, exponent)| *exponent < 0);
        let (mut negative, slope) = self.build.signed(slope);
        let name = match &element.stretch {
            Stretch::Line { length, .. } => self.name(*length),
            Stretch::Plain(stretch) if is_divided && element.is_spring() && stretch.terms().len() > 1 => {
                let (opposite, front) = self.build.signed(&element.coefficient);
                if !element.tension.is_zero() {
                    return (negative, Formula::product(vec![slope, self.pull(element)]));
                }
                let stretched = self.build.plain_sum(&(stretch - &element.free));
                return (negative != opposite, Formula::product(vec![front, slope, stretched]));
            }
            Stretch::Plain(stretch) => {
                let pull = if element.is_spring() {
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
        if !element.is_spring() {
            let Formula::Name(label) = &name else { return (false, Formula::zero()) };
            let dots = element.order as u8;
            let rate = Formula::Name(Label { dots, ..label.clone() });
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
                let one = Formula::Number(Rational::ONE);
                Formula::product(vec![stiffness, Formula::Sum(vec![(false, one), (!shorter, share)])])
            }
        } else {
            Formula::quotient(self.pull(element), name)
        };
        (negative, Formula::product(vec![pull, slope]))
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

/// Elements of one order; elements with the same stretch are merged into one.
fn merged(elements: &[Element], order: Order) -> Vec<Element> {
    let mut list: Vec<Element> = Vec::new();
    for element in elements.iter().filter(|element| element.order == order) {
        match list.iter_mut().find(|known| is_alike(known, element)) {
            Some(known) => add(known, element),
            None => list.push(element.clone()),
        }
    }
    list
}

fn is_alike(a: &Element, b: &Element) -> bool {
    a.order == b.order && a.power == b.power && a.stretch.sum() == b.stretch.sum() && a.free == b.free
}

fn add(to: &mut Element, other: &Element) {
    to.coefficient = &to.coefficient + &other.coefficient;
    to.tension = &to.tension + &other.tension;
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
