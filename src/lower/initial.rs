//! The state at t = 0: the values of `initial`, as values of the coordinates. See docs/method/system.md.
//!
//! Each value is a linear equation for the coordinates. The equations are solved exactly; a coordinate that no equation
//! mentions starts at zero, and one that the equations leave undetermined is an error: nothing is guessed.

use super::assembly::{Assembly, Row};
use super::error::LowerError;
use crate::base::{Number, Span};
use crate::model::scene::Scene;
use crate::system::CoordinateId;
use std::collections::{BTreeMap, BTreeSet};

/// An equation row . q = value.
struct Equation {
    row: BTreeMap<u32, Number>,
    value: Number,
    span: Span,
}

/// Displacement and velocity of each coordinate that does not start at zero.
pub fn initial(scene: &Scene, assembly: &mut Assembly) -> Result<Vec<(CoordinateId, Number, Number)>, Vec<LowerError>> {
    let mut equations = [Vec::new(), Vec::new()];
    for (motion, value, span) in scene.initial.iter().flat_map(|initial| &initial.values) {
        let (derivative, row) = assembly.placed_motion(motion);
        equations[usize::from(derivative).min(1)].push(equation(row, value, *span));
    }
    if scene.initial.is_empty() {
        return Ok(Vec::new());
    }
    let kept = assembly.states();
    let mut start: BTreeMap<u32, [Number; 2]> = BTreeMap::new();
    for (order, equations) in equations.into_iter().enumerate() {
        for (coordinate, (value, span)) in solve(equations)? {
            let is_kept = kept[order][coordinate as usize];
            if !(is_kept || value.is_zero()) {
                return Err(vec![lost_error(span, order)]);
            }
            start.entry(coordinate).or_insert([Number::ZERO, Number::ZERO])[order] = value;
        }
    }
    Ok(start.into_iter().map(|(i, [displacement, velocity])| (CoordinateId(i), displacement, velocity)).collect())
}

fn equation(row: Row, value: &Number, span: Span) -> Equation {
    let mut sums: BTreeMap<u32, Number> = BTreeMap::new();
    for (coordinate, entry) in row {
        let sum = sums.entry(coordinate).or_insert(Number::ZERO);
        *sum = &*sum + &entry;
    }
    sums.retain(|_, entry| !entry.is_zero());
    Equation { row: sums, value: value.clone(), span }
}

/// Gauss-Jordan elimination: every equation ends with a single coordinate, or becomes an error.
fn solve(equations: Vec<Equation>) -> Result<BTreeMap<u32, (Number, Span)>, Vec<LowerError>> {
    let mut solved: BTreeMap<u32, Equation> = BTreeMap::new();
    // Coordinates whose equations contain others too: only these can change through further equations.
    let mut open: BTreeSet<u32> = BTreeSet::new();
    for mut equation in equations {
        let known: Vec<u32> = equation.row.keys().copied().filter(|i| solved.contains_key(i)).collect();
        for coordinate in known {
            eliminate(&mut equation, coordinate, &solved[&coordinate]);
        }
        let Some(pivot) = pivot(&equation) else {
            if equation.value.may_be_zero() {
                continue;
            }
            return Err(vec![contradiction(equation.span)]);
        };
        normalise(&mut equation, pivot);
        for coordinate in &open {
            if let Some(other) = solved.get_mut(coordinate) {
                eliminate(other, pivot, &equation);
            }
        }
        open.insert(pivot);
        solved.insert(pivot, equation);
        open.retain(|coordinate| solved[coordinate].row.len() > 1);
    }
    if let Some(coordinate) = open.first() {
        return Err(vec![undetermined_error(solved[coordinate].span)]);
    }
    Ok(solved.into_iter().map(|(coordinate, equation)| (coordinate, (equation.value, equation.span))).collect())
}

/// The coordinate with the largest entry that is certainly not zero.
fn pivot(equation: &Equation) -> Option<u32> {
    let certain = equation.row.iter().filter(|(_, entry)| !entry.may_be_zero());
    let size = |entry: &Number| entry.to_f64().abs();
    certain.max_by(|a, b| size(a.1).total_cmp(&size(b.1)).then(b.0.cmp(a.0))).map(|(coordinate, _)| *coordinate)
}

fn normalise(equation: &mut Equation, pivot: u32) {
    let factor = equation.row[&pivot].clone();
    for entry in equation.row.values_mut() {
        *entry = &*entry / &factor;
    }
    equation.value = &equation.value / &factor;
}

/// Computes equation - entry times `by`, where `by` has 1 at the coordinate.
fn eliminate(equation: &mut Equation, coordinate: u32, by: &Equation) {
    let Some(factor) = equation.row.remove(&coordinate) else { return };
    for (other, entry) in by.row.iter().filter(|(other, _)| **other != coordinate) {
        let sum = equation.row.entry(*other).or_insert(Number::ZERO);
        *sum = &*sum - &(&factor * entry);
    }
    equation.row.retain(|_, entry| !entry.is_zero());
    equation.value = &equation.value - &(&factor * &by.value);
}

fn contradiction(span: Span) -> LowerError {
    LowerError::Initial {
        span,
        message: "this initial motion contradicts the others, or the degrees of freedom of its body".into(),
        help: "give initial motions that are compatible",
    }
}

fn undetermined_error(span: Span) -> LowerError {
    LowerError::Initial {
        span,
        message: "this initial value does not determine the motion: several motions have it".into(),
        help: "give the initial motions of the other bodies involved, such as `angle = 0`",
    }
}

fn lost_error(span: Span, order: usize) -> LowerError {
    let message = match order {
        0 => {
            "this initial position has no effect: the motion has neither mass nor damping, and springs place it at once"
        }
        _ => "this initial velocity has no effect: the motion has no mass",
    };
    LowerError::Initial {
        span,
        message: message.into(),
        help: "give a mass to the body, or the initial motion to a body that has one",
    }
}
