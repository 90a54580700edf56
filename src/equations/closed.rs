//! Natural frequencies and poles in closed form, part by part: coordinates that no entry joins are parts of their own. In: the
//! linearised equations; out: for parts of one and two coordinates the characteristic polynomial and what solves it.

use super::{Entry, Equations};
use crate::symbols::{Factor, Product, Sum, Symbol};

/// Coordinates that are coupled.
#[derive(Clone, Debug)]
pub struct Part {
    /// Their places among the independent coordinates.
    pub places: Vec<usize>,
    /// det(M s^2 + C s + K) by powers of s, the constant first.
    pub characteristic: Vec<Sum>,
    /// Whether C has an entry.
    pub damped: bool,
}

/// Terms of a coefficient beyond which a closed form says less than its numbers.
pub const MOST_TERMS: usize = 16;

/// The parts of one and two coordinates whose closed form is short.
pub fn parts(equations: &Equations) -> Vec<Part> {
    let linear = &equations.linear;
    // Damping of the whole scene has no symbols in C.
    if equations.rayleigh.is_some() || equations.modal_damping.is_some() {
        return Vec::new();
    }
    let groups = groups(linear.coordinates.len(), &[&linear.mass, &linear.damping, &linear.stiffness]);
    let short = |part: &Part| part.characteristic.iter().all(|sum| sum.terms().len() <= MOST_TERMS);
    groups.into_iter().filter(|places| places.len() <= 2).map(|places| part(equations, places)).filter(short).collect()
}

fn part(equations: &Equations, places: Vec<usize>) -> Part {
    let linear = &equations.linear;
    let entry = |matrix: &[Vec<Entry>], i: usize, j: usize| matrix[i][j].sum.clone();
    let s = |i: usize, j: usize| -> Vec<Sum> {
        vec![entry(&linear.stiffness, i, j), entry(&linear.damping, i, j), entry(&linear.mass, i, j)]
    };
    let characteristic = match places[..] {
        [one] => s(one, one),
        [one, other] => {
            let straight = product(&s(one, one), &s(other, other));
            let across = product(&s(one, other), &s(other, one));
            straight.iter().zip(&across).map(|(a, b)| &a.evaluated() - &b.evaluated()).collect()
        }
        _ => Vec::new(),
    };
    let damped = places.iter().any(|i| places.iter().any(|j| !linear.damping[*i][*j].sum.is_zero()));
    Part { places, characteristic, damped }
}

/// The product of two polynomials in s.
pub fn product(a: &[Sum], b: &[Sum]) -> Vec<Sum> {
    let mut product = vec![Sum::ZERO; (a.len() + b.len()).saturating_sub(1)];
    for (i, first) in a.iter().enumerate() {
        for (j, second) in b.iter().enumerate() {
            product[i + j] = &product[i + j] + &(first * second);
        }
    }
    product
}

/// Places that entries join, each group ascending.
pub fn groups(n: usize, matrices: &[&Vec<Vec<Entry>>]) -> Vec<Vec<usize>> {
    let mut group: Vec<usize> = (0..n).collect();
    for matrix in matrices {
        for i in 0..n {
            for j in 0..n {
                if group[i] != group[j] && !matrix[i][j].sum.is_zero() {
                    let (keeps, joins) = (group[i].min(group[j]), group[i].max(group[j]));
                    group.iter_mut().filter(|own| **own == joins).for_each(|own| *own = keeps);
                }
            }
        }
    }
    let groups = (0..n).map(|first| (0..n).filter(|place| group[*place] == first).collect::<Vec<usize>>());
    groups.filter(|places| !places.is_empty()).collect()
}

/// A polynomial in a variable as a sum.
pub fn in_variable(coefficients: &[Sum], variable: Symbol) -> Sum {
    let term = |(power, coefficient): (usize, &Sum)| match power {
        0 => coefficient.clone(),
        power => {
            let power = Product::of(Factor::Name(variable), power as i32);
            &Sum::term(power, crate::base::Rational::ONE) * coefficient
        }
    };
    coefficients.iter().enumerate().map(term).fold(Sum::ZERO, |sum, term| &sum + &term)
}
