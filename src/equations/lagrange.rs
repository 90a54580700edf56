//! Lagrange's equations. In: energies. Out: for each free coordinate q
//!
//!   d/dt dT/dq' - dT/dq + dV/dq + dD/dq' + sum lambda dg/dq = Q,
//!
//! nothing approximated. Where the lever of a spring or damper turns with the motion, what it adds stays apart as pull times lever;
//! so do the higher powers of a law, and the stretches of a belt that have a name.

use super::constraint::Constraint;
use super::energy::{Element, Energies, Stretch, is_motion};
use super::motion::Motion;
use super::names::{class, without_motion};
use crate::elements::Order;
use crate::symbols::{Lengths, Sum, Symbol};

/// One equation of motion: `plain + lines = forces`.
#[derive(Clone, Debug, PartialEq)]
pub struct Equation {
    /// Its coordinate, among those of the motion.
    pub coordinate: usize,
    pub plain: Sum,
    pub lines: Vec<Line>,
    /// Reactions of constraints: the multiplier and the slope of its constraint.
    pub reactions: Vec<(Symbol, Sum)>,
    pub forces: Sum,
}

/// A spring, damper or inerter at work on a coordinate by a lever that the motion changes, with a higher power, or with a stretch that has a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its place among the elements of the energies.
    pub element: usize,
    /// The derivative of the stretch; of a length half that of its square.
    pub slope: Sum,
}

/// All equations, in the order of the free coordinates.
pub fn equations(motion: &Motion, energies: &Energies, constraints: &[Constraint]) -> Vec<Equation> {
    let none = Lengths::default();
    let rates: Vec<Sum> = energies.elements.iter().map(|element| plain_rate(motion, &element.stretch)).collect();
    let equation = |index: usize| {
        let [displacement, velocity, _] = motion.coordinates[index].symbols;
        let momentum = energies.kinetic.derivative(velocity, &none);
        let mut plain = &motion.rate(&momentum, &none) - &energies.kinetic.derivative(displacement, &none);
        plain = &plain + &energies.weights.derivative(displacement, &energies.lengths);
        let mut lines = Vec::new();
        for (number, element) in energies.elements.iter().enumerate() {
            match &element.stretch {
                Stretch::Plain(stretch) => {
                    let slope = stretch.derivative(displacement, &energies.lengths);
                    if slope.is_zero() {
                        continue;
                    }
                    let is_length = |symbol: Symbol| symbol.class() == class::LENGTH;
                    if slope.mentions(&is_motion) || !element.is_linear() || stretch.mentions(&is_length) {
                        lines.push(Line { element: number, slope });
                        continue;
                    }
                    let force =
                        if element.is_spring() { element.pull() } else { &element.coefficient * &rates[number] };
                    plain = &plain + &(&force * &slope);
                }
                Stretch::Line { square, .. } => {
                    let slope = square.derivative(displacement, &none).halve();
                    if !slope.is_zero() {
                        lines.push(Line { element: number, slope });
                    }
                }
            }
        }
        let reactions = constraints.iter().filter_map(|constraint| {
            let slope = constraint.equation.derivative(displacement, &none);
            (!slope.is_zero()).then_some((constraint.multiplier, slope))
        });
        let forces = energies.works.iter().fold(Sum::ZERO, |sum, work| {
            let slope = work.displacement.derivative(displacement, &energies.lengths);
            &sum + &(&Sum::name(work.force) * &slope)
        });
        Equation { coordinate: index, plain, lines, reactions: reactions.collect(), forces }
    };
    (0..motion.free).map(equation).collect()
}

/// The rate of a stretch that is no length.
fn plain_rate(motion: &Motion, stretch: &Stretch) -> Sum {
    match stretch {
        Stretch::Plain(sum) => motion.rate(sum, &Lengths::default()),
        Stretch::Line { .. } => Sum::ZERO,
    }
}

impl Equation {
    /// The left side less the right with every motion at zero; lengths stay names.
    pub fn at_rest(&self, energies: &Energies) -> Sum {
        let mut whole = without_motion(&(&self.plain - &self.forces));
        for line in &self.lines {
            whole = &whole + &line.force_at_rest(energies);
        }
        for (multiplier, slope) in &self.reactions {
            whole = &whole + &(&Sum::name(*multiplier) * &without_motion(slope));
        }
        whole
    }
}

impl Line {
    /// The pull of its element times its lever, with every motion at zero: that of a spring.
    pub fn force_at_rest(&self, energies: &Energies) -> Sum {
        let element = &energies.elements[self.element];
        if !element.is_spring() {
            return Sum::ZERO;
        }
        let pull = element.pull_at(&without_motion(&element.elongation()));
        let force = &pull * &without_motion(&self.slope);
        match &element.stretch {
            Stretch::Line { length, .. } => &force * &Sum::name(*length).inverse().unwrap_or_default(),
            Stretch::Plain(_) => force,
        }
    }
}

/// The variable of an element's force, of which it is a power times the coefficient: e - e_free for a spring, e' for a
/// damper, e'' for an inerter.
pub fn force_variable(element: &Element, motion: &Motion) -> Sum {
    let none = Lengths::default();
    match (element.order, &element.stretch) {
        (Order::Displacement, _) => element.elongation(),
        (Order::Velocity, Stretch::Plain(stretch)) => motion.rate(stretch, &none),
        (Order::Acceleration, Stretch::Plain(stretch)) => motion.rate(&motion.rate(stretch, &none), &none),
        (order, Stretch::Line { length, square, .. }) => {
            let inverse = Sum::name(*length).inverse().unwrap_or_default();
            // l l' = (l^2)'/2, and l l'' = (l^2)''/2 - l'^2
            let half_rate = motion.rate(square, &none).halve();
            let rate = &half_rate * &inverse;
            match order {
                Order::Acceleration => &(&motion.rate(&half_rate, &none) - &rate.square()) * &inverse,
                _ => rate,
            }
        }
    }
}
