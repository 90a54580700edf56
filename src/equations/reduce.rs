//! Constraints eliminated: the linearised equations over the independent coordinates. In: the equations over all coordinates and the
//! constraints; out: entries over those that the lowered system has, in its order.
//!
//! With dq = N dq_i + N_u du along the constraints, M is N^T M N, C likewise, and K is N^T (K + sum lambda grad^2 g) N.

use super::constraint::Constraint;
use super::elimination::{self, Rows, Unsolved, solve};
use super::error::EquationsError;
use super::lagrange::Equation;
use super::linear::{Column, Linear, Matrix};
use super::lines::AtRest;
use super::loops::Follow;
use super::motion::Motion;
use super::names::{Label, Names, class, without_motion};
use super::rest::Rest;
use super::{Entry, Linearised};
use crate::base::{Number, Rational, Span};
use crate::lower::Lowered;
use crate::symbols::{Factor, Lengths, Product, Sum, Symbol};

/// Maximum number of constraint equations that are solved at once.
const MOST_EQUATIONS: usize = 12;

#[allow(clippy::too_many_arguments)]
pub fn reduce(
    coordinates: Vec<usize>,
    motion: &Motion,
    constraints: &[Constraint],
    equations: &[Equation],
    full: &Linear,
    names: &mut Names,
    rest: &mut Rest,
    at_rest: &AtRest,
    follows_in_motion: Option<&[Follow]>,
) -> Result<Linearised, EquationsError> {
    let span = motion.coordinates.first().map_or_else(super::no_span, |coordinate| coordinate.span);
    let n = motion.free;
    let none = Lengths::default();
    // Columns: one for each independent coordinate, then one for each prescribed motion.
    let width = coordinates.len() + motion.coordinates.len() - n;
    let mut follows = vec![vec![Sum::ZERO; width]; n];
    for (column, index) in coordinates.iter().enumerate() {
        follows[*index][column] = Sum::one();
    }
    let mut stiffness = full.stiffness.clone();
    let (mut dependent, mut ratios) = (Vec::new(), Vec::new());
    if !constraints.is_empty() {
        let others: Vec<usize> = (0..n).filter(|index| !coordinates.contains(index)).collect();
        if others.len() > MOST_EQUATIONS && constraints.iter().any(|constraint| !constraint.is_linear) {
            let span = constraints[0].span;
            return Err(EquationsError::LargeLoop { span, equations: others.len(), most: MOST_EQUATIONS });
        }
        let columns: Vec<usize> = coordinates.iter().copied().chain(n..motion.coordinates.len()).collect();
        let solved = match follows_in_motion {
            Some(follows) => others.iter().map(|index| at_rest_ratios(follows, *index, &columns)).collect(),
            None => all_together(motion, constraints, &others, &columns, names)?,
        };
        for (index, row) in others.iter().zip(solved) {
            let row = name_ratios(row, (*index, &columns), motion, names, &mut ratios);
            let symbols = columns.iter().map(|column| Sum::name(motion.coordinates[*column].symbols[0]));
            let sum = row.iter().zip(symbols).fold(Sum::ZERO, |sum, (entry, symbol)| &sum + &(entry * &symbol));
            dependent.push((*index, sum));
            follows[*index] = row;
        }
        reactions(motion, constraints, equations, &others, names, rest, at_rest)?;
        for constraint in constraints.iter().filter(|constraint| !constraint.is_linear) {
            let multiplier = at_rest_multiplier(rest, constraint.multiplier);
            for (row, of_row) in stiffness.iter_mut().zip(&motion.coordinates[..n]) {
                let first = constraint.equation.derivative(of_row.symbols[0], &none);
                for (entry, of_column) in row.iter_mut().zip(&motion.coordinates[..n]) {
                    let second = without_motion(&first.derivative(of_column.symbols[0], &none));
                    *entry = &*entry + &(&multiplier * &second);
                }
            }
        }
    }
    let congruent = |matrix: &Matrix| congruent(&follows, matrix, coordinates.len());
    let (mass, damping, whole_stiffness) = (congruent(&full.mass), congruent(&full.damping), congruent(&stiffness));
    let inputs = inputs(motion, full, &stiffness, &follows, coordinates.len());
    let valued = |matrix: Matrix| -> Result<Vec<Vec<Entry>>, EquationsError> {
        let entry = |sum: Sum| {
            let value = names.value_of(&sum).ok_or(EquationsError::NoForm { span })?;
            Ok(Entry { sum, value })
        };
        matrix.into_iter().map(|row| row.into_iter().map(entry).collect()).collect()
    };
    Ok(Linearised {
        mass: valued(mass)?,
        damping: valued(damping)?,
        stiffness: valued(whole_stiffness)?,
        coordinates,
        inputs,
        carried: Vec::new(),
        dependent,
        ratios,
        lengths: full.lengths.clone(),
        parts: full.parts.clone(),
    })
}

/// The velocity ratios of a dependent coordinate at rest.
fn at_rest_ratios(follows: &[Follow], index: usize, columns: &[usize]) -> Vec<Sum> {
    let follow = follows.iter().find(|follow| follow.coordinate == index);
    let ratio = |by: &usize| {
        let found = follow.and_then(|follow| follow.ratios.iter().find(|ratio| ratio.by == *by));
        found.map_or(Sum::ZERO, |ratio| without_motion(&ratio.form).simplify())
    };
    columns.iter().map(ratio).collect()
}

/// All dependent coordinates to first order, solved for at once.
fn all_together(
    motion: &Motion,
    constraints: &[Constraint],
    others: &[usize],
    columns: &[usize],
    names: &Names,
) -> Result<Vec<Vec<Sum>>, EquationsError> {
    let none = Lengths::default();
    let slope = |constraint: &Constraint, index: usize| {
        without_motion(&constraint.equation.derivative(motion.coordinates[index].symbols[0], &none))
    };
    let left = |c: &Constraint| others.iter().map(|index| slope(c, *index)).collect::<Vec<Sum>>();
    let right = |c: &Constraint| columns.iter().map(|index| -&slope(c, *index)).collect::<Vec<Sum>>();
    let rows = constraints.iter().map(|constraint| (left(constraint), right(constraint))).collect();
    solve(rows, others.len(), names).map_err(|why| unsolved_error(why, constraints[0].span))
}

fn unsolved_error(why: Unsolved, span: Span) -> EquationsError {
    match why {
        Unsolved::NoPivot => EquationsError::NoForm { span },
        Unsolved::Long { terms } => EquationsError::LongLoop { span, terms, most: elimination::MOST_TERMS },
    }
}

/// Long ratios get a name, with their definition beside it, so that entries made of them stay readable.
fn name_ratios(
    row: Vec<Sum>,
    (index, columns): (usize, &[usize]),
    motion: &Motion,
    names: &mut Names,
    ratios: &mut Vec<(Symbol, Sum)>,
) -> Vec<Sum> {
    let is_long = |form: &Sum| {
        let divides = |(product, _): &(Product, Rational)| {
            product.factors().iter().any(|(factor, _)| matches!(factor, Factor::Whole(_)))
        };
        form.terms().len() > 2 || form.terms().iter().any(divides)
    };
    let label = |index: usize, names: &Names| {
        let label = names.label(motion.coordinates[index].symbols[0]);
        if label.index.is_empty() { label.word } else { label.index }
    };
    let name = |(form, by): (Sum, &usize)| {
        if !is_long(&form) {
            return form;
        }
        let own = label(index, names);
        let index = if columns.len() > 1 { format!("{own},{},0", label(*by, names)) } else { format!("{own},0") };
        let symbol = Symbol::new(class::REST_RATIO, ratios.len());
        let value = names.value_of(&form);
        names.set(symbol, Label::new("h", index), value);
        ratios.push((symbol, form));
        Sum::name(symbol)
    };
    row.into_iter().zip(columns).map(name).collect()
}

/// The coordinates of the lowered system among those of the motion.
pub fn independent(lowered: &Lowered, motion: &Motion) -> Result<Vec<usize>, EquationsError> {
    let span = motion.coordinates.first().map_or_else(super::no_span, |coordinate| coordinate.span);
    let place = |coordinate: &crate::system::Coordinate| {
        motion
            .coordinates
            .iter()
            .take(motion.free)
            .position(|own| own.owner_name == coordinate.name.name && own.motion == coordinate.name.motion)
    };
    let places: Option<Vec<usize>> = lowered.system.coordinates.iter().map(place).collect();
    let places = places.filter(|places| places.len() + lowered.rest.dependent.len() == motion.free);
    places.ok_or_else(|| EquationsError::Defect {
        span,
        what: "the number of coordinates".into(),
        symbols: motion.free.to_string(),
        lowered: (lowered.system.n() + lowered.rest.dependent.len()).to_string(),
    })
}

fn at_rest_multiplier(rest: &Rest, multiplier: Symbol) -> Sum {
    let known = rest.reactions.iter().find(|(symbol, ..)| *symbol == multiplier);
    match known {
        Some((_, _, value)) if value.is_zero() => Sum::ZERO,
        // A short reaction is written out.
        Some((_, Some(form), _)) if form.terms().len() <= 3 => form.clone(),
        Some((symbol, ..)) => Sum::name(Symbol::new(class::MULTIPLIER, symbol.place())),
        None => Sum::ZERO,
    }
}

/// N^T A N over the independent columns.
fn congruent(follows: &[Vec<Sum>], matrix: &Matrix, width: usize) -> Matrix {
    let half = product(matrix, follows, width);
    transposed_product(follows, &half, width)
}

/// A N, of the first columns.
fn product(matrix: &Matrix, follows: &[Vec<Sum>], width: usize) -> Matrix {
    let entry = |row: &[Sum], column: usize| {
        let terms = row.iter().zip(follows).filter(|(entry, follow)| !entry.is_zero() && !follow[column].is_zero());
        terms.fold(Sum::ZERO, |sum, (entry, follow)| &sum + &(entry * &follow[column]))
    };
    matrix.iter().map(|row| (0..width).map(|column| entry(row, column)).collect()).collect()
}

fn transposed_product(follows: &[Vec<Sum>], half: &Matrix, width: usize) -> Matrix {
    let columns = half.first().map_or(0, Vec::len);
    let entry = |i: usize, j: usize| {
        let terms = follows.iter().zip(half).filter(|(follow, row)| !follow[i].is_zero() && !row[j].is_zero());
        terms.fold(Sum::ZERO, |sum, (follow, row)| &sum + &(&follow[i] * &row[j]))
    };
    (0..width).map(|i| (0..columns).map(|j| entry(i, j)).collect()).collect()
}

/// The columns of the inputs: N^T B, minus the effect of prescribed motions on the dependent coordinates.
fn inputs(motion: &Motion, full: &Linear, stiffness: &Matrix, follows: &[Vec<Sum>], width: usize) -> Vec<Column> {
    let matrices = [stiffness, &full.damping, &full.mass];
    let column = |column: &Column| {
        let prescribed = motion.coordinates.iter().skip(motion.free).position(|own| own.input == Some(column.input));
        let parts = column.parts.iter().enumerate().map(|(order, part)| {
            let mut part: Matrix = part.iter().map(|entry| vec![entry.clone()]).collect();
            if let Some(prescribed) = prescribed {
                let driven: Vec<Vec<Sum>> = follows.iter().map(|row| vec![row[width + prescribed].clone()]).collect();
                for (row, moved) in part.iter_mut().zip(product(matrices[order], &driven, 1)) {
                    row[0] = &row[0] - &moved[0];
                }
            }
            transposed_product(follows, &part, width)
                .into_iter()
                .map(|row| row.into_iter().next().unwrap_or_default())
                .collect()
        });
        Column { parts: parts.collect(), ..column.clone() }
    };
    full.inputs.iter().map(column).collect()
}

/// The multipliers at rest: G_d^T lambda = -f_d on the dependent coordinates, where f are all other forces.
fn reactions(
    motion: &Motion,
    constraints: &[Constraint],
    equations: &[Equation],
    others: &[usize],
    names: &mut Names,
    rest: &mut Rest,
    at_rest: &AtRest,
) -> Result<(), EquationsError> {
    let none = Lengths::default();
    let mut rows: Rows = Vec::new();
    for index in others {
        let slopes = constraints.iter().map(|constraint| {
            without_motion(&constraint.equation.derivative(motion.coordinates[*index].symbols[0], &none))
        });
        let equation = &equations[*index];
        let condition = rest.conditions.iter().find(|(coordinate, _)| coordinate == index);
        let force = condition.map_or(Sum::ZERO, |(_, condition)| without_multipliers(&at_rest.of(condition)));
        debug_assert_eq!(equation.coordinate, *index);
        rows.push((slopes.collect(), vec![-&force]));
    }
    // Constraints that depend on each other have no unique reactions: the last ones are set to zero.
    let unknowns = constraints.len().min(others.len());
    let solved = solve(rows, unknowns, names).map_err(|why| unsolved_error(why, constraints[0].span))?;
    for (constraint, row) in constraints.iter().zip(solved) {
        let form = row.into_iter().next().unwrap_or_default();
        let value = names.value_of(&form).unwrap_or(Number::ZERO);
        names.set_value(constraint.multiplier, value.clone());
        rest.reactions.push((constraint.multiplier, Some(form), value));
    }
    if rest.reactions.iter().all(|(_, form, _)| form.as_ref().is_some_and(Sum::is_zero)) {
        // There is no constraint force.
        let is_multiplier = |symbol: Symbol| symbol.class() == class::MULTIPLIER;
        rest.conditions
            .retain(|(_, condition)| !without_multipliers(condition).is_zero() || !condition.mentions(&is_multiplier));
        rest.reactions.clear();
    }
    Ok(())
}

fn without_multipliers(sum: &Sum) -> Sum {
    sum.replace(&|symbol| (symbol.class() == class::MULTIPLIER).then_some(Sum::ZERO))
}
