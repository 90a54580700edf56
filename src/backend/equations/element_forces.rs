//! The term of an element in an equation of motion: its force times its lever.

use super::build::raise;
use super::document::Writer;
use super::energies::{add, is_alike};
use super::formula::Formula;
use crate::base::Rational;
use crate::equations::energy::{Element, Stretch};
use crate::equations::lagrange::Line;
use crate::equations::names::Label;
use crate::symbols::{Lengths, Sum};

impl Writer<'_> {
    /// `k (l - l_0) + T`
    pub(super) fn pull(&self, element: &Element) -> Formula {
        let (negative, stiffness) = self.build.sign_and_factor(&element.coefficient);
        let stretched = self.build.plain_sum(&(&element.stretch.sum() - &element.free));
        let (opposite, tension) = self.build.sign_and_factor(&element.tension);
        if element.coefficient.is_zero() {
            return if opposite { tension.negate() } else { tension };
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
    pub(super) fn merged_lines(&self, lines: &[Line]) -> Vec<(Element, Sum)> {
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
        let answered = self.force_variable(element);
        let is_single = |sum: &Sum| sum.terms().len() == 1;
        let holds = is_plain && is_single(&answered) && is_single(slope);
        holds.then(|| &(&element.coefficient * &answered) * slope)
    }

    /// The stretch that a spring answers, or the rate that a damper does.
    pub(super) fn force_variable(&self, element: &Element) -> Sum {
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
            let answered = self.force_variable(element);
            if slope.terms().len() == 1 {
                return self.build.with_power(&(coefficient * slope), power, &answered);
            }
            let (negative, pull) = self.build.with_power(coefficient, power, &answered);
            let (opposite, slope) = self.build.sign_and_factor(slope);
            return (negative != opposite, Formula::product(vec![pull, slope]));
        };
        let (mut negative, slope) = self.build.sign_and_factor(slope);
        let (opposite, pull) = match element.is_spring() {
            true => self.build.with_power(coefficient, power, &element.elongation()),
            false => {
                let (opposite, front) = self.build.sign_and_factor(coefficient);
                (opposite, Formula::product(vec![front, raise(power, self.length_rate(*length, 1))]))
            }
        };
        negative ^= opposite;
        (negative, Formula::product(vec![Formula::quotient(pull, self.name(*length)), slope]))
    }

    /// `k (1 - l_0/l) slope`.
    pub(super) fn line(&self, element: &Element, slope: &Sum) -> (bool, Formula) {
        if !element.is_linear() {
            return self.power(element, slope);
        }
        if let Some(single) = self.single_term(element, slope) {
            return self.build.sign_and_factor(&single);
        }
        if let (Stretch::Plain(_), [_], true) = (&element.stretch, slope.terms(), element.tension.is_zero()) {
            // k/2 cos(theta) (y + sin(theta)/2): the lever arm in front of the brackets.
            let (negative, front) = self.build.sign_and_factor(&(&element.coefficient * slope));
            let (opposite, answered) = self.build.sign_and_factor(&self.force_variable(element));
            return (negative != opposite, Formula::product(vec![front, answered]));
        }
        // A lever with a divisor stands in front of brackets, which may hold fractions.
        let is_divided =
            slope.terms().iter().flat_map(|(product, _)| product.factors()).any(|(_, exponent)| *exponent < 0);
        let (mut negative, slope) = self.build.sign_and_factor(slope);
        let name = match &element.stretch {
            Stretch::Line { length, .. } => self.name(*length),
            Stretch::Plain(stretch) if is_divided && element.is_spring() && stretch.terms().len() > 1 => {
                let (opposite, front) = self.build.sign_and_factor(&element.coefficient);
                if !element.tension.is_zero() {
                    return (negative, Formula::product(vec![slope, self.pull(element)]));
                }
                let stretched = self.build.plain_sum(&(stretch - &element.free));
                return (negative != opposite, Formula::product(vec![front, slope, stretched]));
            }
            Stretch::Plain(stretch) => {
                let pull = if element.is_spring() {
                    if element.tension.is_zero() {
                        let (opposite, front) = self.build.sign_and_factor(&element.coefficient);
                        let (other, stretched) = self.build.sign_and_factor(&(stretch - &element.free));
                        negative ^= opposite != other;
                        Formula::product(vec![front, stretched])
                    } else {
                        self.pull(element)
                    }
                } else {
                    let rate = self.equations.motion.rate(stretch, &Lengths::default());
                    let (opposite, front) = self.build.sign_and_factor(&element.coefficient);
                    let (other, rate) = self.build.sign_and_factor(&rate);
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
            let (opposite, coefficient) = self.build.sign_and_factor(&element.coefficient);
            let pull = Formula::quotient(Formula::product(vec![coefficient, rate]), name);
            return (negative != opposite, Formula::product(vec![pull, slope]));
        }
        let (opposite, stiffness) = self.build.sign_and_factor(&element.coefficient);
        negative ^= opposite;
        let pull = if element.tension.is_zero() {
            let (shorter, free) = self.build.sign_and_factor(&element.free);
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
