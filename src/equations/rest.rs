//! The rest in symbols: its conditions, and its closed form if one is found. In: the equations with every motion at
//! zero. Out: conditions over `q_0`, and solutions that agree with the numerical rest.

use super::coordinate::Coordinate;
use super::energy::Energies;
use super::lagrange::Equation;
use super::lines::AtRest;
use super::motion::Motion;
use super::names::{Label, Names, class};
use crate::base::{Name, Number, Rational};
use crate::lower::Lowered;
use crate::symbols::{Factor, Sum, Symbol};

/// The rest of the free coordinates.
#[derive(Clone, Debug, Default)]
pub struct Rest {
    /// `condition = 0`, for each coordinate whose condition is not satisfied identically.
    pub conditions: Vec<(usize, Sum)>,
    /// Coordinates that do not rest as drawn, each with its symbol and its value.
    pub moved: Vec<(usize, Symbol, Number)>,
    /// Closed forms of some of them.
    pub closed: Vec<(usize, Sum)>,
    /// Reactions at rest: multiplier and closed form or value.
    pub reactions: Vec<(Symbol, Option<Sum>, Number)>,
    /// Tensions that hold a drawing, in closed form.
    pub tensions: Vec<(Symbol, Sum)>,
    /// Whether the numbers of the rest are proven.
    pub proven: bool,
}

/// Displacements at rest by the coordinate's body and motion.
pub struct Numbers {
    list: Vec<(Name, &'static str, Number)>,
    proven: bool,
}

pub fn numbers(lowered: &Lowered) -> Numbers {
    let system = &lowered.system;
    let rest = &lowered.rest;
    let own = system.coordinates.iter().zip(&rest.displacement);
    let own = own.map(|(coordinate, value)| (coordinate.name.name, coordinate.name.motion, value.clone()));
    let dependent = rest.dependent.iter();
    let dependent = dependent.map(|d| (d.coordinate.name.name, d.coordinate.name.motion, d.displacement.clone()));
    Numbers { list: own.chain(dependent).collect(), proven: rest.is_proven() }
}

impl Numbers {
    fn of(&self, coordinate: &Coordinate) -> Number {
        let found =
            self.list.iter().find(|(name, motion, _)| *name == coordinate.owner_name && *motion == coordinate.motion);
        found.map_or(Number::ZERO, |(.., value)| value.clone())
    }
}

/// The value of a coordinate at rest: zero if the drawing is the rest.
pub fn symbol(names: &mut Names, coordinate: &Coordinate, index: usize, numbers: &Numbers) -> Sum {
    let value = numbers.of(coordinate);
    if value.is_zero() {
        return Sum::ZERO;
    }
    let symbol = Symbol::new(class::REST, index);
    let label = names.label(coordinate.symbols[0]);
    let index = if label.index.is_empty() { "0".into() } else { format!("{},0", label.index) };
    names.set(symbol, Label::new(label.word, index), Some(value));
    Sum::name(symbol)
}

impl Rest {
    pub fn new(
        motion: &Motion,
        energies: &Energies,
        equations: &[Equation],
        names: &mut Names,
        numbers: &Numbers,
    ) -> Rest {
        let mut rest = Rest { proven: numbers.proven, ..Rest::default() };
        for equation in equations {
            let condition = equation.at_rest(energies);
            if !condition.is_zero() {
                rest.conditions.push((equation.coordinate, condition));
            }
        }
        for (index, coordinate) in motion.coordinates.iter().take(motion.free).enumerate() {
            let symbol = Symbol::new(class::REST, index);
            if !coordinate.rest.is_zero()
                && let Some(value) = names.value(symbol)
            {
                rest.moved.push((index, symbol, value.clone()));
            }
        }
        rest
    }

    /// Replaces names by lengths at rest, or `by_parts` if a line has names for its parts; conditions that hold
    /// identically are dropped.
    pub fn settle(&mut self, at_rest: &AtRest, names: &Names, by_parts: impl Fn(usize) -> Option<Sum>) {
        for (coordinate, condition) in &mut self.conditions {
            *condition = by_parts(*coordinate).unwrap_or_else(|| at_rest.of(condition).simplify());
        }
        self.conditions.retain(|(_, condition)| !condition.vanishes());
        let is_unknown = |symbol: Symbol| [class::TENSION, class::MULTIPLIER].contains(&symbol.class());
        for (_, condition) in &self.conditions {
            let mut unknown = std::collections::BTreeSet::new();
            condition.names(&mut |symbol| unknown.extend(is_unknown(symbol).then_some(symbol)));
            let (Some(symbol), 1) = (unknown.first().copied(), unknown.len()) else { continue };
            let form = solved_linear(condition, symbol).map(|form| form.simplify());
            let agrees = |form: &Sum| {
                names
                    .value_of(form)
                    .zip(names.value(symbol))
                    .is_some_and(|(worth, value)| (&worth - value).may_be_zero())
            };
            if symbol.class() == class::TENSION
                && !self.tensions.iter().any(|(known, _)| *known == symbol)
                && let Some(form) = form.filter(agrees)
            {
                self.tensions.push((symbol, form));
            }
        }
    }

    /// Closed forms, one coordinate after the other, each from a condition with one remaining unknown.
    pub fn closed_forms(&self, names: &Names) -> Vec<(usize, Sum)> {
        let mut found: Vec<(usize, Sum)> = Vec::new();
        let mut conditions: Vec<Sum> = self.conditions.iter().map(|(_, condition)| condition.clone()).collect();
        for _ in 0..self.moved.len() {
            let before = found.len();
            for place in 0..conditions.len() {
                let condition = &conditions[place];
                let unknown: Vec<&(usize, Symbol, Number)> = self
                    .moved
                    .iter()
                    .filter(|(index, symbol, _)| {
                        condition.mentions(&|s| s == *symbol) && !found.iter().any(|(known, _)| known == index)
                    })
                    .collect();
                let &[(index, symbol, value)] = &unknown[..] else { continue };
                let solved = solved_linear(condition, *symbol).into_iter().chain(solved_wave(condition, *symbol));
                // Of several angles, the one that was found numerically.
                let agrees = |form: &Sum| names.value_of(form).is_some_and(|worth| (&worth - value).may_be_zero());
                let Some(form) = solved.into_iter().find(agrees) else { continue };
                found.push((*index, form.clone()));
                let replace = |s: Symbol| (s == *symbol).then(|| form.clone());
                for condition in &mut conditions {
                    *condition = condition.replace(&replace);
                }
            }
            if found.len() == before {
                break;
            }
        }
        found
    }
}

/// a x + b = 0.
fn solved_linear(condition: &Sum, unknown: Symbol) -> Option<Sum> {
    let factor = Factor::Name(unknown);
    let (mut slope, mut rest) = (Sum::ZERO, Sum::ZERO);
    for (part, others) in condition.collect_by(|known| known.mentions(&|symbol| symbol == unknown)) {
        match part.factors() {
            [] => rest = others,
            [(known, 1)] if *known == factor => slope = others,
            _ => return None,
        }
    }
    Some(-&rest.over(&slope)?)
}

/// c sin(x + a) = 0 or c cos(x + a) = 0.
fn solved_wave(condition: &Sum, unknown: Symbol) -> Vec<Sum> {
    let parts = condition.collect_by(|known| known.mentions(&|symbol| symbol == unknown));
    let [(part, _)] = &parts[..] else { return Vec::new() };
    let (angle, quarter) = match part.factors() {
        [(Factor::Sine(angle), 1)] => (angle, 0),
        [(Factor::Cosine(angle), 1)] => (angle, 1),
        _ => return Vec::new(),
    };
    let half_turns = [0, 1, -1].map(|half| Rational::new(2 * half + quarter, 2));
    let zeros = half_turns.into_iter().filter_map(|turns| {
        let left = &**angle - &Sum::pi().scale(&turns);
        solved_linear(&left, unknown)
    });
    zeros.collect()
}
