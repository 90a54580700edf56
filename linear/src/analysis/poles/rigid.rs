//! The rigid motions of an independent part, exactly: K x = 0. Those that stretch no damper either continue for ever
//! and are a double pole at zero; the others come to rest anywhere, which is a single pole at zero. In: the part as a
//! system. Out: a basis of each kind, of rational vectors that are verified exactly. See
//! docs/method/poles.md#rigid-body-modes.

use crate::analysis::modes::structure::{NullSpace, enclosed_vectors, null_space};
use crate::base::{Ball, Number, Rational};
use crate::kernel::dense::{Matrix, enclosure};
use crate::system::{self, CoordinateId, Form, LinearSystem, Nature, Term};

/// Bases of the null space of K.
#[derive(Clone, Debug, Default)]
pub struct RigidMotions {
    /// K x = 0, and no damper is stretched.
    pub free: Vec<Vec<Number>>,
    /// K x = 0; independent of the free motions.
    pub dragged: Vec<Vec<Number>>,
}

/// The rigid motions of a part that has some, in a basis in which they are not coupled by inertia (the free ones) or by
/// damping (the others).
pub fn rigid_motions(part: &LinearSystem) -> RigidMotions {
    uncouple(part, any_basis(part))
}

/// Gram-Schmidt with binary64 factors: combinations of exactly rigid motions are exactly rigid, and the discs only need
/// nearly orthogonal ones.
fn uncouple(part: &LinearSystem, motions: RigidMotions) -> RigidMotions {
    let mut free: Vec<Vec<Number>> = Vec::new();
    for motion in motions.free {
        free.push(orthogonal_to(&part.m, motion, &free));
    }
    let mut dragged: Vec<Vec<Number>> = Vec::new();
    for motion in motions.dragged {
        // Adding free motions does not change the drag.
        let motion = orthogonal_to(&part.m, motion, &free);
        dragged.push(orthogonal_to(&part.c, motion, &dragged));
    }
    RigidMotions { free, dragged }
}

/// The motion minus its components along others, in the product x^T F y.
fn orthogonal_to(form: &Form, mut motion: Vec<Number>, others: &[Vec<Number>]) -> Vec<Number> {
    for other in others {
        let factor = -product(form, &motion, other) / product(form, other, other);
        let Some(factor) = Rational::from_f64(factor).filter(|factor| !factor.is_zero()) else { continue };
        let factor = Number::from(factor);
        motion.iter_mut().zip(other).for_each(|(x, y)| *x = &*x + &(&factor * y));
    }
    motion
}

/// x^T F y in binary64.
fn product(form: &Form, x: &[Number], y: &[Number]) -> f64 {
    let part = |term: Term| {
        let stretch =
            |x: &[Number]| form.row(term).iter().map(|(i, a)| a.to_f64() * x[i.index()].to_f64()).sum::<f64>();
        term.weight.to_f64() * stretch(x) * stretch(y)
    };
    form.terms().map(part).sum()
}

fn any_basis(part: &LinearSystem) -> RigidMotions {
    let n = part.n();
    let space = null_space(&part.k, n);
    if space.vectors.len() < space.dimension {
        return enclosed_motions(part, &space).unwrap_or_default();
    }
    let motions = space.vectors;
    let free = if part.k.terms().all(|term| term.weight.is_positive()) {
        null_space(&with_dampers(part), n).vectors
    } else {
        let weights = null_space(&damper_rows(part, &motions), motions.len()).vectors;
        weights.iter().map(|weights| combination(&motions, weights, n)).collect()
    };
    let dragged = complement_of(&free, &motions);
    RigidMotions { free: exact(free), dragged: exact(dragged) }
}

/// The rigid-body modes as enclosures, for numbers that are not rational. Only for positive terms, whose null space is
/// that of their rows. Free motions annihilate the rows of springs and dampers; of the motions that annihilate those of
/// K alone, the ones whose free coordinates the free motions do not already use are dragged.
fn enclosed_motions(part: &LinearSystem, space: &NullSpace) -> Option<RigidMotions> {
    if !part.k.terms().all(|term| term.weight.is_positive()) {
        return None;
    }
    let (n, both) = (part.n(), with_dampers(part));
    let free = null_space(&both, n).free;
    let motions = enclosed_vectors(&part.k, n, &space.free)?;
    let dragged = space.free.iter().zip(motions).filter(|(at, _)| !free.contains(at)).map(|(_, motion)| motion);
    let dragged: Vec<Vec<Number>> = dragged.collect();
    let free = enclosed_vectors(&both, n, &free)?;
    are_dragged(part, &dragged).then_some(RigidMotions { free, dragged })
}

/// Whether N^T C N is provably nonsingular, so that every combination of these rigid-body modes is damped. (They were
/// chosen by the rank in general position, which is larger if numbers depend on each other in a way that cannot be
/// seen.)
fn are_dragged(part: &LinearSystem, motions: &[Vec<Number>]) -> bool {
    let mut drag = Matrix::none(motions.len(), motions.len());
    for term in part.c.terms() {
        let row = part.c.row(term);
        let stretch = |x: &Vec<Number>| row.iter().fold(Ball::ZERO, |sum, (i, a)| sum + (a * &x[i.index()]).to_ball());
        let stretches: Vec<Ball> = motions.iter().map(stretch).collect();
        for (j, &b) in stretches.iter().enumerate() {
            for (entry, &a) in drag.column_mut(j).iter_mut().zip(&stretches) {
                *entry = *entry + term.weight.to_ball() * a * b;
            }
        }
    }
    enclosure::solve(&drag, &Matrix::none(motions.len(), 0)).is_some()
}

fn exact(vectors: Vec<Vec<Rational>>) -> Vec<Vec<Number>> {
    vectors.into_iter().map(|vector| vector.into_iter().map(Number::from).collect()).collect()
}

/// The positive terms of K and the dampers' rows with weight one: their common null space is that of both.
fn with_dampers(part: &LinearSystem) -> Form {
    let mut form = part.k.clone();
    push_rows(&mut form, part, |row| row.to_vec());
    form
}

/// The dampers' rows in terms of the weights y of motions: their stretches for sum y_j N_j.
fn damper_rows(part: &LinearSystem, motions: &[Vec<Rational>]) -> Form {
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

fn push_rows(form: &mut Form, part: &LinearSystem, of: impl Fn(system::Row) -> Row) {
    for term in part.c.terms() {
        let source = form.source(part.c.source_of(term.source));
        form.push(source, Nature::Property, Number::ONE, of(part.c.row(term)));
    }
}

fn combination(vectors: &[Vec<Rational>], weights: &[Rational], n: usize) -> Vec<Rational> {
    (0..n).map(|i| vectors.iter().zip(weights).fold(Rational::ZERO, |sum, (v, w)| &sum + &(&v[i] * w))).collect()
}

/// The motions that are independent of the free ones and of each other: each is reduced by those kept before.
fn complement_of(free: &[Vec<Rational>], motions: &[Vec<Rational>]) -> Vec<Vec<Rational>> {
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
        assert_eq!(complement_of(&[vector([2, 2, 2])], &motions[..2]), [vector([1, 0, 0])]);
        assert_eq!(complement_of(&[], &motions), motions[..2]);
    }
}
