//! Section 2: energies, dissipation and generalised forces.

use super::build::raise;
use super::document::{Section, Writer, display};
use super::fold;
use super::formula::Formula;
use crate::base::{OrderBy, Rational};
use crate::elements::Order;
use crate::equations::energy::{Element, Stretch};
use crate::equations::names::Label;
use crate::symbols::{Lengths, Power, Sum, Symbol, common_factors};

impl Writer<'_> {
    pub fn energies(&self) -> Section {
        let energies = &self.equations.energies;
        let build = self.build.in_front();
        let mut kinetic = build.by_rates(&energies.kinetic);
        for inerter in merge(&energies.elements, Order::Acceleration) {
            kinetic.extend(self.rate_energy(&inerter));
        }
        let letter = fold::index_letter(&self.equations.names);
        let folded = |terms| Formula::sum(fold::terms(terms, letter));
        let mut items = vec![display(self.letter("T", None).equal(folded(kinetic)))];
        let mut potential = build.collect_terms(&energies.weights);
        for spring in merge(&energies.elements, Order::Displacement) {
            potential.extend(self.spring_energy(&spring));
        }
        if !potential.is_empty() {
            potential.order_by_key(|(negative, _)| *negative);
            items.push(display(self.letter("V", None).equal(folded(potential))));
        }
        let mut dissipation = Vec::new();
        for damper in merge(&energies.elements, Order::Velocity) {
            dissipation.extend(self.rate_energy(&damper));
        }
        if !dissipation.is_empty() {
            items.push(display(self.letter("D", None).equal(folded(dissipation))));
        }
        for equation in &self.equations.nonlinear {
            if !equation.forces.is_zero() {
                let index = self.name(self.coordinate(equation.coordinate).symbols[0]);
                let force = Formula::sum(self.order_terms(&energies.with_forces(&equation.forces)));
                items.push(display(self.letter("Q", Some(index)).equal(force)));
            }
        }
        items.extend(self.lengths());
        Section { heading: "2 Energies, dissipation and generalised forces", items }
    }

    /// `1/2 k (x_2 - x_1)^2`, plus the term of a pretension.
    fn spring_energy(&self, spring: &Element) -> Vec<(bool, Formula)> {
        let build = self.build.in_front();
        let stretched = spring.elongation();
        let mut terms = Vec::new();
        terms.extend(match spring.is_linear() {
            true => self.half_square(&spring.coefficient, &stretched),
            false => Some(self.integral(spring, &stretched)),
        });
        if !spring.tension.is_zero() {
            let (negative, stretch) = build.sign_and_factor(&stretched);
            let (opposite, tension) = build.sign_and_factor(&spring.tension);
            terms.push((negative != opposite, Formula::product(vec![tension, stretch])));
        }
        terms
    }

    /// `1/4 k (x_2 - x_1)^4`, `1/3 c |x'|^3`: the integral of a power of a law.
    pub(super) fn integral(&self, element: &Element, of: &Sum) -> (bool, Formula) {
        let (build, exponent) = (self.build.in_front(), element.power.exponent + 1);
        let front = element.coefficient.scale(&Rational::new(1, i64::from(exponent)));
        let power = Power { exponent, ..element.power };
        match &element.stretch {
            Stretch::Line { length, .. } if !element.is_spring() => {
                let (negative, front) = build.sign_and_factor(&front);
                (negative, Formula::product(vec![front, raise(power, self.length_rate(*length, 1))]))
            }
            _ => build.with_power(&front, power, of),
        }
    }

    /// `1/2 c l'^2`: half the power of a damper, or the energy of an inerter. For a law, the function whose derivative
    /// is the force.
    fn rate_energy(&self, element: &Element) -> Vec<(bool, Formula)> {
        if !element.is_linear() {
            return vec![self.integral(element, &self.force_variable(element))];
        }
        match &element.stretch {
            Stretch::Plain(stretch) => {
                let rate = self.equations.motion.rate(stretch, &Lengths::default());
                self.half_square(&element.coefficient, &rate).into_iter().collect()
            }
            Stretch::Line { length, .. } => {
                let rate = Formula::Power(Box::new(self.length_rate(*length, 1)), 2);
                let half = Sum::one().halve();
                let (negative, coefficient) = self.build.in_front().sign_and_factor(&(&element.coefficient * &half));
                vec![(negative, Formula::product(vec![coefficient, rate]))]
            }
        }
    }

    /// A length or its rate.
    pub(super) fn length_rate(&self, length: Symbol, dots: u8) -> Formula {
        Formula::Name(Label { dots, ..self.equations.names.label(length) })
    }

    /// c x^2/2; a sum is squared in brackets.
    fn half_square(&self, coefficient: &Sum, of: &Sum) -> Option<(bool, Formula)> {
        let build = self.build.in_front();
        if of.is_zero() || coefficient.is_zero() {
            return None;
        }
        if of.terms().len() == 1 {
            let whole = (coefficient * &of.square()).halve();
            return Some(build.sign_and_factor(&whole));
        }
        // k r^2 (theta_1 - theta_2)^2, not k (r theta_1 - r theta_2)^2.
        let shared = common_factors(of);
        let is_plain = shared.product.is_one() || shared.squared;
        let (front, of) = match is_plain {
            true => (coefficient.clone(), of.clone()),
            false => {
                let shared_square = Sum::term(shared.product.times(&shared.product), Rational::ONE);
                (coefficient * &shared_square, shared.rest.scale(&shared.number))
            }
        };
        let (negative, front) = build.sign_and_factor(&front.halve());
        let of = if of.terms().iter().all(|(_, c)| c.signum() < 0) { -&of } else { of };
        let square = Formula::Power(Box::new(build.plain_sum(&of)), 2);
        Some((negative, Formula::product(vec![front, square])))
    }
}

/// Elements of one order; elements with the same stretch are merged into one.
fn merge(elements: &[Element], order: Order) -> Vec<Element> {
    let mut list: Vec<Element> = Vec::new();
    for element in elements.iter().filter(|element| element.order == order) {
        match list.iter_mut().find(|known| is_alike(known, element)) {
            Some(known) => add(known, element),
            None => list.push(element.clone()),
        }
    }
    list
}

/// Whether two elements act on one stretch by one law, so that their coefficients add up.
pub fn is_alike(a: &Element, b: &Element) -> bool {
    a.order == b.order && a.power == b.power && a.stretch.sum() == b.stretch.sum() && a.free == b.free
}

pub fn add(to: &mut Element, other: &Element) {
    to.coefficient = &to.coefficient + &other.coefficient;
    to.tension = &to.tension + &other.tension;
}
