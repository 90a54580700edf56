//! Outputs as linear forms, and transfer functions as quotients of polynomials in s. In: the linearised equations; out: for each input
//! and output of a part of one or two coordinates a numerator over the part's characteristic polynomial.

use super::closed::{Part, product};
use super::energy::{Energies, Stretch};
use super::linear::AtRest;
use super::motion::Motion;
use super::names::still;
use super::{Equations, Linearised};
use crate::base::Number;
use crate::model::scene::{Element, Motion as Moved, Scene};
use crate::model::written::{Pair, Written, WrittenTerm, dot};
use crate::symbols::{Lengths, Sum};

/// A linear combination of motions.
#[derive(Clone, Debug)]
pub struct Output {
    pub name: String,
    /// By the order of the derivative: the factor of each independent coordinate.
    pub rows: Vec<Vec<Sum>>,
    /// ... and of each prescribed motion, by its input.
    pub direct: Vec<Vec<(usize, Sum)>>,
}

/// The outputs of the scene; those that have no form in symbols are left out.
pub fn outputs(scene: &Scene, written: &Written, equations: &Equations, at_rest: &AtRest) -> Vec<Output> {
    let both = scene.outputs.iter().zip(&written.outputs);
    let output = |(output, terms): (&crate::model::scene::Output, &Vec<WrittenTerm>)| {
        let mut forms = vec![Sum::ZERO; 3];
        for (term, own) in output.terms.iter().zip(terms) {
            let (order, form) = form(scene, equations, &term.motion, (own, written), at_rest)?;
            forms[order] = &forms[order] + &(&own.coefficient * &form);
        }
        let name = scene.words.display(output.name);
        Some(combined(name, &forms, &equations.motion, &equations.linear))
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
        Moved::Stretch { element } => (0, stretch(energies, element.index(), motion, at_rest)),
        Moved::Force { element } => {
            let own: &Element = scene.elements.get(element.index())?;
            let form = stretch(energies, element.index(), motion, at_rest);
            let coefficient = energies.element_of(element.index());
            let coefficient = coefficient.map_or(Sum::ZERO, |known| known.coefficient.clone());
            (own.law.kind.order as usize, &coefficient * &form)
        }
    })
}

fn stretch(energies: &Energies, number: usize, motion: &Motion, at_rest: &AtRest) -> Sum {
    let Some(element) = energies.element_of(number) else { return Sum::ZERO };
    match &element.stretch {
        Stretch::Plain(sum) => first_order(sum, motion, &Lengths::default(), at_rest),
        Stretch::Line { .. } => first_order(&element.stretch.sum(), motion, &energies.lengths, at_rest),
    }
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
fn combined(name: String, forms: &[Sum], motion: &Motion, linear: &Linearised) -> Output {
    let none = Lengths::default();
    let dependent = |symbol| {
        let found = linear.dependent.iter().find(|(index, _)| motion.coordinates[*index].symbols[0] == symbol);
        found.map(|(_, sum)| sum.clone())
    };
    let forms: Vec<Sum> = forms.iter().map(|form| form.replaced(&dependent)).collect();
    let factor = |form: &Sum, index: usize| still(&form.derivative(motion.coordinates[index].symbols[0], &none));
    let rows = forms.iter().map(|form| linear.coordinates.iter().map(|index| factor(form, *index)).collect());
    let prescribed = |form: &Sum| {
        let driven = (motion.free..motion.coordinates.len()).filter_map(|index| {
            let entry = factor(form, index);
            (!entry.is_zero()).then_some((motion.coordinates[index].input?, entry))
        });
        driven.collect()
    };
    let direct = forms.iter().map(prescribed).collect();
    Output { name, rows: rows.collect(), direct }
}

/// A transfer function: numerator and denominator by powers of s, the constant first.
#[derive(Clone, Debug)]
pub struct Transfer {
    pub input: usize,
    pub output: String,
    pub numerator: Vec<Sum>,
    pub denominator: Vec<Sum>,
}

/// The transfer functions within a part: those of the declared outputs, or of the coordinates where none is declared.
pub fn transfers(equations: &Equations, part: &Part) -> Vec<Transfer> {
    let mut transfers = Vec::new();
    for column in &equations.linear.inputs {
        let drives = |place: &usize| column.parts.iter().any(|entries| !entries[*place].is_zero());
        if !part.places.iter().any(drives) {
            continue;
        }
        for output in &equations.outputs {
            let inside = |place: usize| part.places.contains(&place);
            let touched = |row: &Vec<Sum>| {
                row.iter().enumerate().filter(|(_, entry)| !entry.is_zero()).all(|(place, _)| inside(place))
            };
            if !output.rows.iter().all(touched) || output.rows.iter().flatten().all(Sum::is_zero) {
                continue;
            }
            let numerator = numerator(equations, part, column, output);
            let denominator = part.characteristic.clone();
            transfers.push(Transfer { input: column.input, output: output.name.clone(), numerator, denominator });
        }
    }
    transfers
}

/// p adj(Z) b + d det(Z).
fn numerator(equations: &Equations, part: &Part, column: &super::linear::Column, output: &Output) -> Vec<Sum> {
    let linear = &equations.linear;
    let z = |i: usize, j: usize| -> Vec<Sum> {
        [&linear.stiffness, &linear.damping, &linear.mass].iter().map(|matrix| matrix[i][j].sum.clone()).collect()
    };
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
            terms.into_iter().fold(Vec::new(), added)
        }
        _ => Vec::new(),
    };
    for (order, direct) in output.direct.iter().enumerate() {
        for (_, entry) in direct.iter().filter(|(input, _)| *input == column.input) {
            let mut shifted = vec![Sum::ZERO; order];
            shifted.push(entry.clone());
            sum = added(sum, product(&shifted, &part.characteristic));
        }
    }
    while sum.last().is_some_and(Sum::is_zero) {
        sum.pop();
    }
    sum
}

fn added(a: Vec<Sum>, b: Vec<Sum>) -> Vec<Sum> {
    let zero = Sum::ZERO;
    (0..a.len().max(b.len())).map(|i| a.get(i).unwrap_or(&zero) + b.get(i).unwrap_or(&zero)).collect()
}
