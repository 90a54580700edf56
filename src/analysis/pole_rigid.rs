//! The rigid motions of an independent part, exactly: K x = 0 on rational numbers. Those that C does not feel either
//! (C x = 0) move on for ever and are a double pole at zero; the others come to rest at any place, which is a single
//! pole at zero. In: the part's terms. Out: a basis of each kind, or nothing where a term is no rational number.
//! Clause: spec.md 11.6.

use super::pole_parts::Part;
use crate::base::{Number, Rational};
use crate::system::{Form, LinearSystem};

/// Exact bases of the null space of K.
#[derive(Clone, Debug, Default)]
pub struct RigidMotions {
    /// K x = 0 and C x = 0
    pub free: Vec<Vec<Number>>,
    /// K x = 0, and independent of the free ones after C.
    pub dragged: Vec<Vec<Number>>,
}

type Rows = Vec<Vec<Rational>>;

/// The rigid motions; `None` where a term of K or C is not rational, so that nothing is decided.
pub fn rigid_motions(system: &LinearSystem, part: &Part, local: &[u32]) -> Option<RigidMotions> {
    let n = part.coordinates.len();
    let k = assemble(&system.k, &part.k, local, n)?;
    let c = assemble(&system.c, &part.c, local, n)?;
    let motions = null_space(k, n);
    if motions.is_empty() {
        return Some(RigidMotions::default());
    }
    // C N y = 0 picks the free ones among the motions N y; unit vectors complete them.
    let felt: Rows = c.iter().map(|row| motions.iter().map(|motion| dot(row, motion)).collect()).collect();
    let (free, pivots) = null_space_and_pivots(felt, motions.len());
    let free = free.iter().map(|weights| exact(combination(&motions, weights, n))).collect();
    let dragged = pivots.iter().map(|&pivot| exact(motions[pivot].clone())).collect();
    Some(RigidMotions { free, dragged })
}

fn exact(vector: Vec<Rational>) -> Vec<Number> {
    vector.into_iter().map(Number::from).collect()
}

fn combination(vectors: &Rows, weights: &[Rational], n: usize) -> Vec<Rational> {
    (0..n).map(|i| vectors.iter().zip(weights).fold(Rational::ZERO, |sum, (v, w)| &sum + &(&v[i] * w))).collect()
}

fn dot(a: &[Rational], b: &[Rational]) -> Rational {
    a.iter().zip(b).fold(Rational::ZERO, |sum, (x, y)| if x.is_zero() || y.is_zero() { sum } else { &sum + &(x * y) })
}

/// sum w a a^T of the chosen terms.
fn assemble(form: &Form, terms: &[u32], local: &[u32], n: usize) -> Option<Rows> {
    let mut matrix = vec![vec![Rational::ZERO; n]; n];
    for &index in terms {
        let term = &form.terms()[index as usize];
        let weight = term.weight.exact()?;
        for (i, a) in form.row(term) {
            let weighted = weight * a.exact()?;
            for (j, b) in form.row(term) {
                let entry = &mut matrix[local[i.index()] as usize][local[j.index()] as usize];
                *entry = &*entry + &(&weighted * b.exact()?);
            }
        }
    }
    Some(matrix)
}

fn null_space(rows: Rows, columns: usize) -> Rows {
    null_space_and_pivots(rows, columns).0
}

/// Gauss-Jordan elimination: a basis of the null space, one vector for each column without a pivot, and the pivots' columns.
fn null_space_and_pivots(mut rows: Rows, columns: usize) -> (Rows, Vec<usize>) {
    let mut pivots = Vec::new();
    for column in 0..columns {
        let rank = pivots.len();
        let Some(found) = (rank..rows.len()).find(|&r| !rows[r][column].is_zero()) else { continue };
        rows.swap(rank, found);
        clear(&mut rows, rank, column);
        pivots.push(column);
    }
    let basis = (0..columns).filter(|column| !pivots.contains(column)).map(|column| {
        let mut vector = vec![Rational::ZERO; columns];
        vector[column] = Rational::ONE;
        for (row, &pivot) in pivots.iter().enumerate() {
            vector[pivot] = -&rows[row][column];
        }
        vector
    });
    (basis.collect(), pivots)
}

/// Scales the pivot to one and clears its column in all other rows.
fn clear(rows: &mut Rows, pivot: usize, column: usize) {
    let head = rows[pivot][column].clone();
    for entry in &mut rows[pivot] {
        *entry = &*entry / &head;
    }
    let source = rows[pivot].clone();
    for (r, row) in rows.iter_mut().enumerate() {
        if r != pivot && !row[column].is_zero() {
            let factor = row[column].clone();
            for (entry, s) in row.iter_mut().zip(&source) {
                if !s.is_zero() {
                    *entry = &*entry - &(&factor * s);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_null_space_is_what_the_matrix_annihilates() {
        let rows: Rows = [[1, -1, 0], [-1, 2, -1], [0, -1, 1]].map(|row| row.map(Rational::from).to_vec()).to_vec();
        let (basis, pivots) = null_space_and_pivots(rows.clone(), 3);
        assert_eq!((basis.len(), pivots), (1, vec![0, 1]));
        assert!(rows.iter().all(|row| dot(row, &basis[0]).is_zero()));
    }
}
