//! The equations of motion against derivatives of the energies: energies are evaluated on numbers with two nilpotent parts.

use super::{Fractions, agree, defect};
use crate::base::{Ball, Number, Rational};
use crate::elements::Order;
use crate::equations::constraint::Constraint;
use crate::equations::energy::{Energies, Stretch};
use crate::equations::lagrange::{Equation, force_variable};
use crate::equations::loops::Reduced;
use crate::equations::{Equations, EquationsError};
use crate::symbols::{Dependence, Factor, Function, Power, Sum, Symbol};
use std::collections::BTreeMap;

/// x + a y + b z + a b w with a^2 = b^2 = 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Jet {
    pub value: Ball,
    pub a: Ball,
    pub b: Ball,
    pub ab: Ball,
}

impl Jet {
    pub fn constant(value: Ball) -> Jet {
        let zero = Ball::from(0.0);
        Jet { value, a: zero, b: zero, ab: zero }
    }

    fn plus(self, o: Jet) -> Jet {
        Jet { value: self.value + o.value, a: self.a + o.a, b: self.b + o.b, ab: self.ab + o.ab }
    }

    fn times(self, o: Jet) -> Jet {
        Jet {
            value: self.value * o.value,
            a: self.value * o.a + self.a * o.value,
            b: self.value * o.b + self.b * o.value,
            ab: self.value * o.ab + self.a * o.b + self.b * o.a + self.ab * o.value,
        }
    }

    /// f of it, by f, f' and f'' at its value.
    fn through(self, f: Ball, first: Ball, second: Ball) -> Jet {
        Jet { value: f, a: first * self.a, b: first * self.b, ab: first * self.ab + second * self.a * self.b }
    }

    fn root(self) -> Jet {
        let root = self.value.sqrt();
        let first = Ball::from(0.5) / root;
        self.through(root, first, -(first / (self.value * Ball::from(2.0))))
    }

    fn inverse(self) -> Jet {
        let inverse = Ball::from(1.0) / self.value;
        let first = -(inverse * inverse);
        self.through(inverse, first, -(Ball::from(2.0) * first * inverse))
    }

    /// The arc sine: its derivatives are 1/sqrt(1 - x^2) and x/sqrt(1 - x^2)^3.
    fn asin(self) -> Option<Jet> {
        let value = Number::Ball(self.value).asin()?.to_ball();
        let (one, square) = (Ball::from(1.0), self.value * self.value);
        let first = one / (one - square).sqrt();
        Some(self.through(value, first, self.value * first * first * first))
    }

    /// The arc tangent: its derivatives are 1/(1 + x^2) and -2 x/(1 + x^2)^2.
    fn atan(self) -> Option<Jet> {
        let value = Number::atan2(&Number::Ball(self.value), &Number::ONE)?.to_ball();
        let first = Ball::from(1.0) / (Ball::from(1.0) + self.value * self.value);
        Some(self.through(value, first, -(Ball::from(2.0) * self.value * first * first)))
    }

    fn power(self, exponent: i32) -> Jet {
        let base = if exponent < 0 { self.inverse() } else { self };
        (0..exponent.unsigned_abs()).fold(Jet::constant(Ball::from(1.0)), |power, _| power.times(base))
    }

    /// x^n, or |x| x^(n-1); `None` if the sign is not known.
    fn pow(self, exponent: u32, has_magnitude: bool) -> Option<Jet> {
        let power = self.power(exponent as i32);
        match Number::Ball(self.value) {
            _ if !has_magnitude => Some(power),
            value if value.is_positive() => Some(power),
            value if value.is_negative() => Some(Jet::constant(Ball::from(-1.0)).times(power)),
            _ => None,
        }
    }

    /// The integral of a power: x^(n+1)/(n+1), or |x| x^n/(n+1).
    fn integral(self, power: Power) -> Option<Jet> {
        let next = power.exponent + 1;
        let share = Ball::from(1.0) / Ball::from(f64::from(next));
        Some(Jet::constant(share).times(self.pow(next, power.has_magnitude)?))
    }
}

/// A value for each name: motions carry nilpotent parts.
pub(super) struct Point<'a> {
    pub motions: BTreeMap<Symbol, Jet>,
    pub equations: &'a Equations,
}

impl Point<'_> {
    pub fn sum(&self, sum: &Sum) -> Option<Jet> {
        let mut total = Jet::constant(Ball::from(0.0));
        for (product, coefficient) in sum.terms() {
            let mut value = Jet::constant(coefficient.to_ball());
            for (factor, exponent) in product.factors() {
                value = value.times(self.factor(factor)?.power(*exponent));
            }
            total = total.plus(value);
        }
        Some(total)
    }

    fn factor(&self, factor: &Factor) -> Option<Jet> {
        let wave = |angle: &Sum| -> Option<(Jet, Ball, Ball)> {
            let angle = self.sum(angle)?;
            let (sine, cosine) = Number::Ball(angle.value).sin_cos()?;
            Some((angle, sine.to_ball(), cosine.to_ball()))
        };
        match factor {
            Factor::Name(symbol) => match self.motions.get(symbol) {
                Some(jet) => Some(*jet),
                None => self.equations.names.value(*symbol).map(|value| Jet::constant(value.to_ball())),
            },
            Factor::Root(sum) => Some(self.sum(sum)?.root()),
            Factor::Whole(sum) => self.sum(sum),
            Factor::Cosine(angle) => {
                let (angle, sine, cosine) = wave(angle)?;
                Some(angle.through(cosine, -sine, -cosine))
            }
            Factor::Sine(angle) => {
                let (angle, sine, cosine) = wave(angle)?;
                Some(angle.through(sine, cosine, -sine))
            }
            Factor::Call(Function::Asin, arguments) => self.sum(arguments.first()?)?.asin(),
            Factor::Call(Function::Atan, arguments) => self.sum(arguments.first()?)?.atan(),
            // Nothing that moves is inside.
            Factor::Pi | Factor::Call(..) => {
                let value = Sum::term(crate::symbols::Product::of(factor.clone(), 1), Rational::ONE);
                Some(Jet::constant(self.equations.names.value_of(&value)?.to_ball()))
            }
        }
    }

    /// Evaluates the names that depend on coordinates by their definitions.
    fn lengths(&mut self, energies: &Energies) -> Option<()> {
        for (name, dependence) in &energies.lengths.0 {
            let value = match dependence {
                Dependence::Root(square) => self.sum(square)?.root(),
                Dependence::Form { form, .. } => self.sum(form)?,
            };
            self.motions.insert(*name, value);
        }
        Some(())
    }
}

/// Number of states in which every equation is evaluated.
const STATES: u64 = 2;
/// Maximum number of equations that are compared; larger scenes are compared at some of their coordinates.
const MOST_EQUATIONS: usize = 24;

pub fn verify(equations: &Equations) -> Result<(), EquationsError> {
    for seed in 0..STATES {
        let state = State::random(equations, seed);
        let free = equations.motion.free;
        let step = free.div_ceil(MOST_EQUATIONS).max(1);
        for index in (0..free).step_by(step) {
            let Some((written, derived)) = state.both_values(index) else { continue };
            if !agree(&written, &derived) {
                return Err(state.defect(index, "the equation", &written, &derived));
            }
        }
        if let Some(reduced) = equations.reduced_form() {
            state.check_reduced(reduced)?;
        }
    }
    Ok(())
}

/// Displacements, velocities and accelerations, forces and multipliers.
struct State<'a> {
    equations: &'a Equations,
    motions: Vec<[Ball; 3]>,
    given: Vec<(Symbol, Ball)>,
}

impl<'a> State<'a> {
    /// Coordinates that follow others in proportion do so.
    fn random(equations: &'a Equations, seed: u64) -> State<'a> {
        let mut fractions = Fractions::new(seed);
        // Small motions: lengths stay away from zero.
        let size = Rational::new(1, 4);
        let count = equations.motion.coordinates.len();
        let motions = (0..count).map(|_| [0, 1, 2].map(|_| (&fractions.next() * &size).to_ball())).collect();
        let works = equations.energies.works.iter().map(|work| work.force);
        let multipliers = equations.constraints.iter().map(|constraint| constraint.multiplier);
        let given = works.chain(multipliers).map(|symbol| (symbol, fractions.next().to_ball())).collect();
        let mut state = State { equations, motions, given };
        for follow in equations.reduced_form().into_iter().flat_map(|reduced| &reduced.follows) {
            for order in 0..3 {
                let value = follow.in_proportion(&equations.motion, order).and_then(|sum| state.value(&sum));
                state.motions[follow.coordinate][order] = value.unwrap_or(state.motions[follow.coordinate][order]);
            }
        }
        let ratios =
            equations.reduced_form().into_iter().flat_map(|reduced| &reduced.follows).flat_map(|follow| &follow.ratios);
        let named: Vec<(Symbol, Ball)> =
            ratios.filter_map(|ratio| Some((ratio.name?, state.value(&ratio.form)?))).collect();
        state.given.extend(named);
        state
    }

    fn value(&self, sum: &Sum) -> Option<Ball> {
        Some(self.point(Perturbed::Nothing, Perturbed::Nothing)?.sum(sum)?.value)
    }

    /// Checks that velocity ratios satisfy the constraints, and that the equations without multipliers are the sums of
    /// the others that they should be.
    fn check_reduced(mut self, reduced: &Reduced) -> Result<(), EquationsError> {
        // Redundant constraints follow from the others where these are satisfied, not at any state.
        for (index, constraint) in self.equations.constraints.iter().enumerate() {
            if !reduced.held.contains(&index) {
                self.given.retain(|(symbol, _)| *symbol != constraint.multiplier);
                self.given.push((constraint.multiplier, Ball::from(0.0)));
            }
        }
        let step = reduced.equations.len().div_ceil(MOST_EQUATIONS).max(1);
        for equation in reduced.equations.iter().step_by(step) {
            let index = equation.coordinate;
            if let Some((constraint, left)) = self.drift(reduced, index) {
                let what = format!("the rate of the constraint of {}", constraint.name);
                return Err(defect(constraint.span, what, &left, &Number::ZERO));
            }
            let Some((written, derived)) = self.project(reduced, equation) else { continue };
            if !agree(&written, &derived) {
                return Err(self.defect(index, "the equation without multipliers", &written, &derived));
            }
        }
        Ok(())
    }

    /// A constraint that does not stay fulfilled while one independent coordinate moves and the others follow.
    fn drift(&self, reduced: &Reduced, index: usize) -> Option<(&'a Constraint, Number)> {
        let slope = |constraint: &Constraint, by: usize| {
            Some(self.point(Perturbed::Displacement(by), Perturbed::Nothing)?.sum(&constraint.equation)?.a)
        };
        reduced.held.iter().map(|held| &self.equations.constraints[*held]).find_map(|constraint| {
            let mut rate = slope(constraint, index)?;
            for follow in &reduced.follows {
                if let Some(ratio) = follow.ratios.iter().find(|ratio| ratio.by == index) {
                    rate = rate + self.value(&ratio.short())? * slope(constraint, follow.coordinate)?;
                }
            }
            let rate = Number::Ball(rate);
            (!rate.may_be_zero()).then_some((constraint, rate))
        })
    }

    /// The values of an equation without multipliers, and of the corresponding sum of those with multipliers.
    fn project(&self, reduced: &Reduced, equation: &Equation) -> Option<(Number, Number)> {
        let point = self.point(Perturbed::Nothing, Perturbed::Nothing)?;
        let written = Number::Ball(point.printed_residual(equation)?);
        let (_, mut derived) = self.both_values(equation.coordinate)?;
        for follow in &reduced.follows {
            if let Some(ratio) = follow.ratios.iter().find(|ratio| ratio.by == equation.coordinate) {
                let (_, other) = self.both_values(follow.coordinate)?;
                derived = &derived + &(&Number::Ball(self.value(&ratio.short())?) * &other);
            }
        }
        Some((written, derived))
    }

    fn defect(&self, index: usize, what: &str, written: &Number, derived: &Number) -> EquationsError {
        let coordinate = &self.equations.motion.coordinates[index];
        let label = self.equations.names.label(coordinate.symbols[0]).plain();
        defect(coordinate.span, format!("{what} of {label} at a random state"), written, derived)
    }

    /// The state whose moving parts are nilpotent; `None` if a length is not positive.
    fn point(&self, a: Perturbed, b: Perturbed) -> Option<Point<'a>> {
        let equations = self.equations;
        let mut motions = BTreeMap::new();
        for (number, (coordinate, values)) in equations.motion.coordinates.iter().zip(&self.motions).enumerate() {
            for order in 0..3 {
                let mut jet = Jet::constant(values[order]);
                let one = |on: bool| if on { Ball::from(1.0) } else { Ball::from(0.0) };
                jet.a = one(a.matches(number, order));
                jet.b = match b {
                    Perturbed::AlongMotion if order < 2 => values[order + 1],
                    other => one(other.matches(number, order)),
                };
                motions.insert(coordinate.symbols[order], jet);
            }
        }
        motions.extend(self.given.iter().map(|(symbol, value)| (*symbol, Jet::constant(*value))));
        let mut point = Point { motions, equations };
        point.lengths(&equations.energies)?;
        Some(point)
    }

    /// The values of an equation as written, and by derivatives of the energies; `None` if a length or a root is not
    /// positive there.
    fn both_values(&self, index: usize) -> Option<(Number, Number)> {
        let (equations, energies) = (self.equations, &self.equations.energies);
        let momentum = self.point(Perturbed::Velocity(index), Perturbed::AlongMotion)?;
        let inerters = energies.elements.iter().filter(|element| element.order == Order::Acceleration);
        let kinetic =
            inerters.fold(energies.kinetic.clone(), |sum, inerter| &sum + &inerter.rate_energy(&equations.motion));
        let mut derived = momentum.sum(&kinetic)?.ab;
        let shifted = self.point(Perturbed::Displacement(index), Perturbed::AlongMotion)?;
        derived = derived - shifted.sum(&kinetic)?.a + shifted.sum(&energies.weights)?.a;
        for element in energies.elements.iter().filter(|element| element.order != Order::Acceleration) {
            let stretch = shifted.sum(&element.stretch.sum())?;
            if stretch.a.is_zero() {
                continue;
            }
            let coefficient = shifted.sum(&element.coefficient)?.value;
            if element.is_spring() {
                let stretched = shifted.sum(&element.elongation())?;
                let tension = shifted.sum(&element.tension)?.value;
                derived = derived + coefficient * stretched.integral(element.power)?.a + tension * stretch.a;
            } else {
                // The rate of the stretch is its part along the motion; its slope by the velocity that by the displacement.
                let rate = Jet { a: stretch.a, ..Jet::constant(stretch.b) };
                derived = derived + coefficient * rate.integral(element.power)?.a;
            }
        }
        for constraint in &equations.constraints {
            let multiplier = shifted.motions.get(&constraint.multiplier)?.value;
            derived = derived + multiplier * shifted.sum(&constraint.equation)?.a;
        }
        for work in &energies.works {
            let force = shifted.motions.get(&work.force)?.value;
            derived = derived - force * shifted.sum(&work.displacement)?.a;
        }
        let written = shifted.printed_residual(&equations.nonlinear[index])?;
        (derived.is_finite() && written.is_finite()).then_some((Number::Ball(written), Number::Ball(derived)))
    }
}

impl Point<'_> {
    /// The left side less the right, in the form that is printed.
    fn printed_residual(&self, equation: &Equation) -> Option<Ball> {
        let mut whole = self.sum(&equation.plain)?.value - self.sum(&equation.forces)?.value;
        for line in &equation.lines {
            let element = &self.equations.energies.elements[line.element];
            let answered = self.sum(&force_variable(element, &self.equations.motion))?.value;
            let power = Jet::constant(answered).pow(element.power.exponent, element.power.has_magnitude)?.value;
            let pull = self.sum(&element.coefficient)?.value * power + self.sum(&element.tension)?.value;
            let force = pull * self.sum(&line.slope)?.value;
            whole = match &element.stretch {
                Stretch::Line { length, .. } => whole + force / self.motions.get(length)?.value,
                Stretch::Plain(_) => whole + force,
            };
        }
        for (multiplier, slope) in &equation.reactions {
            whole = whole + self.motions.get(multiplier)?.value * self.sum(slope)?.value;
        }
        Some(whole)
    }
}

/// The quantity that a nilpotent part perturbs.
#[derive(Clone, Copy)]
enum Perturbed {
    Displacement(usize),
    Velocity(usize),
    /// Every coordinate as the motion proceeds.
    AlongMotion,
    Nothing,
}

impl Perturbed {
    fn matches(self, number: usize, order: usize) -> bool {
        match self {
            Perturbed::Displacement(index) => number == index && order == 0,
            Perturbed::Velocity(index) => number == index && order == 1,
            Perturbed::AlongMotion | Perturbed::Nothing => false,
        }
    }
}
