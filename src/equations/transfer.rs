//! Outputs as linear forms, and transfer functions as quotients of polynomials in s. In: the linearised equations; out: for each input
//! and output of a part of one or two coordinates a numerator over the part's characteristic polynomial.

use super::closed::{self, Part, in_variable, product};
use super::energy::Energies;
use super::linear::Column;
use super::lines::AtRest;
use super::motion::Motion;
use super::names::{class, without_motion};
use super::polynomial::{self, Polynomial};
use super::zeros;
use super::{Equations, Linearised};
use crate::base::{Number, Span};
use crate::model::scene::{Element, Geometry, Motion as Moved, MotionTerm, Scene};
use crate::model::written::{Pair, Written, WrittenTerm, dot};
use crate::symbols::{Factor, Lengths, Product, Sum, Symbol, common_factors};

/// A linear combination of motions.
#[derive(Clone, Debug)]
pub struct Output {
    pub name: String,
    /// Its place among the outputs of the scene, and in the model.
    pub number: usize,
    pub span: Span,
    /// For each order of the derivative, the factor of each independent coordinate.
    pub rows: Vec<Vec<Sum>>,
    /// ... and of each prescribed motion, by its input.
    pub direct: Vec<Vec<(usize, Sum)>>,
}

/// The outputs of the scene; those that have no form in symbols are left out.
pub fn outputs(scene: &Scene, written: &Written, equations: &Equations, at_rest: &AtRest) -> Vec<Output> {
    let both = scene.outputs.iter().zip(&written.outputs).enumerate();
    let output = |(number, (output, terms)): (usize, (&crate::model::scene::Output, &Vec<WrittenTerm>))| {
        let mut forms = vec![Sum::ZERO; 3];
        for (term, own) in output.terms.iter().zip(terms) {
            let (order, form) = form(scene, equations, &term.motion, (own, written), at_rest)?;
            forms[order] = &forms[order] + &(&own.coefficient * &form);
        }
        let output = Output {
            name: scene.words.display(output.name),
            number,
            span: output.span,
            rows: Vec::new(),
            direct: Vec::new(),
        };
        Some(combine(output, &forms, &equations.motion, &equations.linear))
    };
    both.filter_map(output).collect()
}

/// A motion to first order, over all coordinates, and the derivative that it is of.
fn form(
    scene: &Scene,
    equations: &Equations,
    moved: &Moved,
    (own, written): (&WrittenTerm, &Written),
    at_rest: &AtRest,
) -> Option<(usize, Sum)> {
    let Equations { motion, energies, .. } = equations;
    let none = Lengths::default();
    Some(match moved {
        Moved::Point { part, at, direction, derivative } => {
            let exact = |number: &Number| number.exact().map(|exact| Sum::number(exact.clone()));
            let direction = [exact(&direction.x)?, exact(&direction.y)?];
            let drawn = |at: &crate::base::Vec3| -> Option<Pair> { Some([exact(&at.x)?, exact(&at.y)?]) };
            let own = own.at.clone().or_else(|| written.own_place(*part));
            let at = match (own, at) {
                (Some(own), _) => Some(own),
                (None, Some(at)) => Some(drawn(at)?),
                (None, None) => None,
            };
            let place = dot(&direction, &motion.place(*part, at.as_ref()));
            (usize::from(*derivative), first_order(&place, motion, &none, at_rest))
        }
        Moved::Turn { part, derivative } => {
            (usize::from(*derivative), first_order(&motion.angle(*part).unwrap_or_default(), motion, &none, at_rest))
        }
        // Reactions need multipliers, which the reduced equations do not have.
        Moved::Reaction(_) => return None,
        Moved::Stretch { element } => (0, stretch(energies, element.index(), motion, at_rest)),
        Moved::Force { element } => {
            let own: &Element = scene.elements.get(element.index())?;
            let form = stretch(energies, element.index(), motion, at_rest);
            let mut shares = energies.elements_of(element.index());
            let tangent = match &own.law.geometry {
                // Each of its elements has the stiffness of both spans.
                Geometry::Span(_) => shares.next().map_or(Sum::ZERO, |share| share.coefficient.halve()),
                _ => shares.fold(Sum::ZERO, |sum, share| &sum + &at_rest.tangent(share)),
            };
            (own.law.kind.order as usize, &tangent * &form)
        }
    })
}

fn stretch(energies: &Energies, number: usize, motion: &Motion, at_rest: &AtRest) -> Sum {
    let mut stretches: Vec<Sum> = energies.elements_of(number).map(|element| element.stretch.sum()).collect();
    // The powers of a law have one stretch, and the first span of a belt the sum of two.
    stretches.dedup();
    let form = |stretch: &Sum| first_order(stretch, motion, &energies.lengths, at_rest);
    stretches.iter().fold(Sum::ZERO, |sum, stretch| &sum + &form(stretch))
}

/// The terms of first order in the coordinates.
fn first_order(sum: &Sum, motion: &Motion, lengths: &Lengths, at_rest: &AtRest) -> Sum {
    let terms = motion.coordinates.iter().map(|coordinate| {
        let slope = at_rest.of(&sum.derivative(coordinate.symbols[0], lengths));
        &slope * &Sum::name(coordinate.symbols[0])
    });
    terms.fold(Sum::ZERO, |sum, term| &sum + &term)
}

/// Over the independent coordinates and the prescribed motions.
fn combine(output: Output, forms: &[Sum], motion: &Motion, linear: &Linearised) -> Output {
    let none = Lengths::default();
    let dependent = |symbol| {
        let found = linear.dependent.iter().find(|(index, _)| motion.coordinates[*index].symbols[0] == symbol);
        found.map(|(_, sum)| sum.clone())
    };
    let forms: Vec<Sum> = forms.iter().map(|form| form.replace(&dependent)).collect();
    let factor =
        |form: &Sum, index: usize| without_motion(&form.derivative(motion.coordinates[index].symbols[0], &none));
    let rows = forms.iter().map(|form| linear.coordinates.iter().map(|index| factor(form, *index)).collect());
    let prescribed = |form: &Sum| {
        let driven = (motion.free..motion.coordinates.len()).filter_map(|index| {
            let entry = factor(form, index);
            (!entry.is_zero()).then_some((motion.coordinates[index].input?, entry))
        });
        driven.collect()
    };
    let direct = forms.iter().map(prescribed).collect();
    Output { rows: rows.collect(), direct, ..output }
}

/// A transfer function within a part, over the part's characteristic polynomial.
#[derive(Clone, Debug)]
pub struct Transfer {
    /// Index of the part of the equations.
    pub part: usize,
    pub input: usize,
    /// Index of the output of the equations.
    pub output: usize,
    /// Coefficients by powers of s, the constant first; empty if there are only numbers.
    pub numerator: Vec<Sum>,
    /// Numerator and denominator with their common factors cancelled.
    pub reduced: (Vec<Sum>, Vec<Sum>),
    /// The numerator of a larger part.
    pub numbers: Polynomial,
}

/// The outputs of reactions: only their values at rest, the multipliers of joints, are in the equations.
pub fn reaction_outputs(scene: &Scene) -> Vec<String> {
    let is_reaction = |term: &MotionTerm| matches!(term.motion, Moved::Reaction(_));
    let outputs = scene.outputs.iter().filter(|output| output.terms.iter().any(is_reaction));
    outputs.map(|output| scene.words.display(output.name)).collect()
}

/// The transfer functions within each part, between the inputs and outputs that are declared.
pub fn transfers(equations: &Equations, parts: &[Part]) -> Vec<Transfer> {
    let mut transfers = Vec::new();
    for (number, part) in parts.iter().enumerate() {
        for column in &equations.linear.inputs {
            let drives = |place: &usize| column.parts.iter().any(|entries| !entries[*place].is_zero());
            if !part.places.iter().any(drives) {
                continue;
            }
            let outputs = equations.outputs.iter().enumerate().filter(|(_, output)| output.is_of(part));
            transfers
                .extend(outputs.filter_map(|(output, row)| transfer(equations, (number, part), column, (output, row))));
        }
    }
    transfers
}

impl Output {
    /// Whether it depends on coordinates of a part, and on no others.
    fn is_of(&self, part: &Part) -> bool {
        let inside = |(place, entry): (usize, &Sum)| entry.is_zero() || part.places.contains(&place);
        let rows = || self.rows.iter();
        rows().all(|row| row.iter().enumerate().all(inside)) && !rows().flatten().all(Sum::is_zero)
    }
}

fn transfer(
    equations: &Equations,
    (number, part): (usize, &Part),
    column: &Column,
    (output, row): (usize, &Output),
) -> Option<Transfer> {
    let own = Transfer {
        part: number,
        input: column.input,
        output,
        numerator: Vec::new(),
        reduced: Default::default(),
        numbers: Vec::new(),
    };
    if !part.characteristic.is_empty() {
        let numerator = numerator(equations, part, column, row);
        let reduced = cancel_factors(&numerator, &part.characteristic);
        return Some(Transfer { numerator, reduced, ..own });
    }
    let numbers = (!part.numbers.is_empty()).then(|| numerator_of_numbers(equations, part, column, row)).flatten()?;
    Some(Transfer { numbers, ..own })
}

/// Common factors of numerator and denominator cancelled.
fn cancel_factors(numerator: &[Sum], denominator: &[Sum]) -> (Vec<Sum>, Vec<Sum>) {
    // Powers of two different variables keep the terms apart.
    let variables = [0, 1].map(|place| Symbol::new(class::LAPLACE, place + 1));
    let both = &in_variable(numerator, variables[0]) + &in_variable(denominator, variables[1]);
    let shared = common_factors(&both);
    let number = if shared.number.signum() < 0 { -&shared.number } else { shared.number.clone() };
    let is_variable = |factor: &Factor| matches!(factor, Factor::Name(symbol) if symbol.class() == class::LAPLACE);
    let (_, factors): (Product, Product) = shared.product.split(is_variable);
    let inverse = Sum::term(factors, number).inverse().unwrap_or_else(Sum::one);
    // Powers of s, too: where an output does not move with a rigid motion.
    let zeros = numerator.iter().zip(denominator).take_while(|(over, under)| over.is_zero() && under.is_zero()).count();
    let divided = |sums: &[Sum]| sums.iter().skip(zeros).map(|sum| sum * &inverse).collect();
    (divided(numerator), divided(denominator))
}

/// By Cramer's rule: each column of M s^2 + C s + K in turn is replaced by the input's.
fn numerator_of_numbers(equations: &Equations, part: &Part, column: &Column, output: &Output) -> Option<Polynomial> {
    let worth = |sum: &Sum| equations.names.value_of(sum);
    let whole = closed::matrix_of_numbers(equations, &part.places)?;
    let driven =
        |place: &usize| column.parts.iter().map(|entries| worth(&entries[*place])).collect::<Option<Polynomial>>();
    let driven: Vec<Polynomial> = part.places.iter().map(driven).collect::<Option<_>>()?;
    let mut sum = Vec::new();
    for (index, place) in part.places.iter().enumerate() {
        let row: Polynomial = output.rows.iter().map(|row| worth(&row[*place])).collect::<Option<_>>()?;
        if row.iter().all(Number::is_zero) {
            continue;
        }
        let mut replaced = whole.clone();
        for (cells, driven) in replaced.iter_mut().zip(&driven) {
            cells[index] = driven.clone();
        }
        sum = polynomial::sum(&sum, &polynomial::product(&row, &polynomial::determinant(&replaced)?));
    }
    for (order, direct) in output.direct.iter().enumerate() {
        for (_, entry) in direct.iter().filter(|(input, _)| *input == column.input) {
            let mut shifted = vec![Number::ZERO; order];
            shifted.push(worth(entry)?);
            sum = polynomial::sum(&sum, &polynomial::product(&shifted, &part.numbers));
        }
    }
    // No motion of all coordinates alike, which nothing resists, is in the output: zeros as exact as those of the denominator.
    let is_exact_zero = |number: &Number| number.exact().is_some_and(crate::base::Rational::is_zero);
    let zeros = part.numbers.iter().take(2).take_while(|number| is_exact_zero(number)).count();
    let is_relative = |row: &Vec<Sum>| part.places.iter().fold(Sum::ZERO, |sum, place| &sum + &row[*place]).vanishes();
    if zeros == 2 && output.rows.iter().all(is_relative) {
        sum.iter_mut().take(zeros).for_each(|coefficient| *coefficient = Number::ZERO);
    }
    if sum.iter().any(|coefficient| coefficient.may_be_zero() && !coefficient.is_zero())
        && let Some(form) = zeros::numerator(equations, part, column, output)
    {
        for (power, coefficient) in sum.iter_mut().enumerate() {
            if form.get(power).is_none_or(Sum::vanishes) {
                *coefficient = Number::ZERO;
            }
        }
    }
    while sum.last().is_some_and(Number::is_zero) {
        sum.pop();
    }
    Some(sum)
}

/// p adj(Z) b + d det(Z).
fn numerator(equations: &Equations, part: &Part, column: &Column, output: &Output) -> Vec<Sum> {
    let z = |i: usize, j: usize| closed::entry(equations, i, j);
    let negated = |polynomial: Vec<Sum>| polynomial.iter().map(|sum| -sum).collect::<Vec<Sum>>();
    let b = |place: usize| column.parts.iter().map(|entries| entries[place].clone()).collect::<Vec<Sum>>();
    let p = |place: usize| output.rows.iter().map(|row| row[place].clone()).collect::<Vec<Sum>>();
    let mut sum = match part.places[..] {
        [one] => product(&p(one), &b(one)),
        [one, other] => {
            let terms = [
                product(&p(one), &product(&z(other, other), &b(one))),
                product(&p(one), &product(&negated(z(one, other)), &b(other))),
                product(&p(other), &product(&negated(z(other, one)), &b(one))),
                product(&p(other), &product(&z(one, one), &b(other))),
            ];
            terms.into_iter().fold(Vec::new(), add)
        }
        _ => Vec::new(),
    };
    for (order, direct) in output.direct.iter().enumerate() {
        for (_, entry) in direct.iter().filter(|(input, _)| *input == column.input) {
            let mut shifted = vec![Sum::ZERO; order];
            shifted.push(entry.clone());
            sum = add(sum, product(&shifted, &part.characteristic));
        }
    }
    while sum.last().is_some_and(Sum::is_zero) {
        sum.pop();
    }
    sum
}

fn add(a: Vec<Sum>, b: Vec<Sum>) -> Vec<Sum> {
    let zero = Sum::ZERO;
    (0..a.len().max(b.len())).map(|i| a.get(i).unwrap_or(&zero) + b.get(i).unwrap_or(&zero)).collect()
}
