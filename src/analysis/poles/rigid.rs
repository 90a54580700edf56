//! The rigid motions of an independent part, exactly: K x = 0. Those that no damper feels either move on for ever and are a
//! double pole at zero; the others come to rest at any place, which is a single pole at zero. In: the part as a system.
//! Out: a basis of each kind, of rational vectors that are verified exactly. Clause: spec.md 11.7.

use crate::analysis::modes::structure::null_space;
use crate::base::{Number, Rational};
use crate::system::{CoordinateId, Form, LinearSystem, Nature};

/// Bases of the null space of K.
#[derive(Clone, Debug, Default)]
pub struct RigidMotions {
    /// K x = 0, and no damper is stretched.
    pub free: Vec<Vec<Number>>,
    /// K x = 0; independent of the free ones.
    pub dragged: Vec<Vec<Number>>,
}

/// The rigid motions of a part that has some.
pub fn rigid_motions(part: &LinearSystem) -> RigidMotions {
    let n = part.n();
    let motions = null_space(&part.k, n).vectors;
    let free = if part.k.terms().iter().all(|term| term.weight.is_positive()) {
        null_space(&with_dampers(part), n).vectors
    } else {
        let weights = null_space(&felt(part, &motions), motions.len()).vectors;
        weights.iter().map(|weights| combination(&motions, weights, n)).collect()
    };
    let dragged = completing(&free, &motions);
    RigidMotions { free: exact(free), dragged: exact(dragged) }
}

fn exact(vectors: Vec<Vec<Rational>>) -> Vec<Vec<Number>> {
    vectors.into_iter().map(|vector| vector.into_iter().map(Number::from).collect()).collect()
}

/// The positive terms of K and the dampers' rows with the weight one: together they annihilate what neither feels.
fn with_dampers(part: &LinearSystem) -> Form {
    let mut form = part.k.clone();
    push_rows(&mut form, part, |row| row.to_vec());
    form
}

/// The dampers' rows on the weights of motions: what they stretch when sum y_j N_j moves.
fn felt(part: &LinearSystem, motions: &[Vec<Rational>]) -> Form {
    let mut form = Form::new();
    push_rows(&mut form, part, |row| {
        let stretch = |motion: &Vec<Rational>| {
            row.iter().fold(Number::ZERO, |sum, (i, a)| &sum + &(a * &Number::from(motion[i.index()].clone())))
        };
        motions.iter().enumerate().map(|(j, motion)| (CoordinateId(j as u32), stretch(motion))).collect()
    });
    form
}

type Row = Vec<(CoordinateId, Number)>;

fn push_rows(form: &mut Form, part: &LinearSystem, of: impl Fn(&[(CoordinateId, Number)]) -> Row) {
    for term in part.c.terms() {
        let source = form.source(part.c.source_name(term.source));
        form.push(source, Nature::Property, Number::ONE, of(part.c.row(term)));
    }
}

fn combination(vectors: &[Vec<Rational>], weights: &[Rational], n: usize) -> Vec<Rational> {
    (0..n).map(|i| vectors.iter().zip(weights).fold(Rational::ZERO, |sum, (v, w)| &sum + &(&v[i] * w))).collect()
}

/// Those of the motions that are independent of the free ones and of each other: each is reduced by what was kept before.
fn completing(free: &[Vec<Rational>], motions: &[Vec<Rational>]) -> Vec<Vec<Rational>> {
    let mut reduced: Vec<(usize, Vec<Rational>)> = Vec::new();
    let mut kept = Vec::new();
    for (at, vector) in free.iter().chain(motions).enumerate() {
        let mut rest = vector.clone();
        for (pivot, row) in &reduced {
            let factor = rest[*pivot].clone();
            if !factor.is_zero() {
                rest.iter_mut().zip(row).for_each(|(x, r)| *x = &*x - &(&factor * r));
            }
        }
        let Some(pivot) = rest.iter().position(|x| !x.is_zero()) else { continue };
        let head = rest[pivot].clone();
        rest.iter_mut().for_each(|x| *x = &*x / &head);
        reduced.push((pivot, rest));
        if at >= free.len() {
            kept.push(vector.clone());
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_motions_are_completed_by_independent_ones() {
        let vector = |entries: [i64; 3]| entries.map(Rational::from).to_vec();
        let motions = [vector([1, 0, 0]), vector([0, 1, 1]), vector([1, 1, 1])];
        assert_eq!(completing(&[vector([2, 2, 2])], &motions[..2]), [vector([1, 0, 0])]);
        assert_eq!(completing(&[], &motions), motions[..2]);
    }
}
