//! Gauss-Jordan elimination in exact arithmetic: reduced row echelon forms of fractions and of residues modulo a prime,
//! and from these null vectors and solutions. Any nonzero entry can be a pivot.

use crate::base::Rational;
use crate::kernel::residues::Field as Residues;

/// A field whose arithmetic is exact.
pub trait Field {
    type Number: Clone;
    fn is_zero(&self, x: &Self::Number) -> bool;
    fn product(&self, x: &Self::Number, y: &Self::Number) -> Self::Number;
    /// x - a b
    fn less(&self, x: &Self::Number, a: &Self::Number, b: &Self::Number) -> Self::Number;
    /// 1 / x of a number that is not zero.
    fn reciprocal(&self, x: &Self::Number) -> Option<Self::Number>;
}

/// The fractions.
pub struct Rationals;

impl Field for Rationals {
    type Number = Rational;

    fn is_zero(&self, x: &Rational) -> bool {
        x.is_zero()
    }

    fn product(&self, x: &Rational, y: &Rational) -> Rational {
        x * y
    }

    fn less(&self, x: &Rational, a: &Rational, b: &Rational) -> Rational {
        x - &(a * b)
    }

    fn reciprocal(&self, x: &Rational) -> Option<Rational> {
        x.recip()
    }
}

impl Field for Residues {
    type Number = u64;

    #[inline]
    fn is_zero(&self, x: &u64) -> bool {
        *x == 0
    }

    #[inline]
    fn product(&self, x: &u64, y: &u64) -> u64 {
        self.multiply(*x, *y)
    }

    #[inline]
    fn less(&self, x: &u64, a: &u64, b: &u64) -> u64 {
        self.add(*x, self.negate(self.multiply(*a, *b)))
    }

    #[inline]
    fn reciprocal(&self, x: &u64) -> Option<u64> {
        (*x != 0).then(|| self.inverse(*x))
    }
}

/// Brings rows into reduced echelon form by their first `columns`; the columns with pivots: the pivot of number k is in row k.
pub fn reduce<F: Field>(field: &F, rows: &mut [Vec<F::Number>], columns: usize) -> Vec<usize> {
    let mut pivots = Vec::new();
    for column in 0..columns {
        let top = pivots.len();
        let Some(found) = (top..rows.len()).find(|&i| !field.is_zero(&rows[i][column])) else { continue };
        rows.swap(top, found);
        let Some(reciprocal) = field.reciprocal(&rows[top][column]) else { continue };
        for entry in &mut rows[top][column..] {
            *entry = field.product(entry, &reciprocal);
        }
        let (above, rest) = rows.split_at_mut(top);
        let Some((pivot_row, below)) = rest.split_first_mut() else { continue };
        for row in above.iter_mut().chain(below).filter(|row| !field.is_zero(&row[column])) {
            let factor = row[column].clone();
            for (x, y) in row[column..].iter_mut().zip(&pivot_row[column..]) {
                if !field.is_zero(y) {
                    *x = field.less(x, &factor, y);
                }
            }
        }
        pivots.push(column);
    }
    pivots
}

/// The reduced basis of the null space of a square matrix.
pub fn null_vectors(matrix: &[Vec<Rational>]) -> Vec<Vec<Rational>> {
    let n = matrix.len();
    let mut reduced = matrix.to_vec();
    let pivots = reduce(&Rationals, &mut reduced, n);
    let free = (0..n).filter(|column| !pivots.contains(column));
    free.map(|column| {
        let mut vector = vec![Rational::ZERO; n];
        vector[column] = Rational::ONE;
        for (row, &pivot) in pivots.iter().enumerate() {
            vector[pivot] = -&reduced[row][column];
        }
        vector
    })
    .collect()
}

/// A solution of A x = b for a square matrix, and whether it is the only one; `None` if there is none.
pub fn solution(matrix: &[Vec<Rational>], b: &[Rational]) -> Option<(Vec<Rational>, bool)> {
    let n = matrix.len();
    let mut rows: Vec<Vec<Rational>> =
        matrix.iter().zip(b).map(|(row, b)| row.iter().cloned().chain([b.clone()]).collect()).collect();
    let pivots = reduce(&Rationals, &mut rows, n);
    if rows[pivots.len()..].iter().any(|row| !row[n].is_zero()) {
        return None;
    }
    let mut x = vec![Rational::ZERO; n];
    for (row, &pivot) in rows.iter().zip(&pivots) {
        x[pivot] = row[n].clone();
    }
    Some((x, pivots.len() == n))
}

/// Whether a square matrix is singular.
pub fn is_singular(mut matrix: Vec<Vec<Rational>>) -> bool {
    let n = matrix.len();
    reduce(&Rationals, &mut matrix, n).len() < n
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rational(n: i64, d: i64) -> Rational {
        &Rational::from(n) * &Rational::from(d).recip().expect("not zero")
    }

    fn matrix(rows: [[i64; 3]; 3]) -> Vec<Vec<Rational>> {
        rows.iter().map(|row| row.iter().map(|&x| Rational::from(x)).collect()).collect()
    }

    /// Rows 1 and 2 make row 3; the first pivot is not in the first row.
    #[test]
    fn a_singular_matrix_has_its_null_vector_and_solutions() {
        let a = matrix([[0, 2, 4], [3, 1, 5], [3, 3, 9]]);
        assert!(is_singular(a.clone()));
        // x_2 = -2 x_3, x_1 = -(x_2 + 5 x_3) / 3 = -x_3.
        assert_eq!(null_vectors(&a), [[-1, -2, 1].map(Rational::from).to_vec()]);
        let b = [2, 3, 5].map(Rational::from);
        assert_eq!(solution(&a, &b), Some((vec![rational(2, 3), Rational::ONE, Rational::ZERO], false)));
        assert_eq!(solution(&a, &[2, 3, 6].map(Rational::from)), None);
    }

    /// The Hilbert matrix of order 3: the solution for its first column is a unit vector.
    #[test]
    fn a_regular_matrix_has_one_solution() {
        let a: Vec<Vec<Rational>> = (0..3).map(|i| (0..3).map(|j| rational(1, i + j + 1)).collect()).collect();
        assert!(!is_singular(a.clone()) && null_vectors(&a).is_empty());
        let b: Vec<Rational> = a.iter().map(|row| row[0].clone()).collect();
        assert_eq!(solution(&a, &b), Some(([1, 0, 0].map(Rational::from).to_vec(), true)));
    }

    /// Modulo a prime, the echelon form consists of the fractions' residues.
    #[test]
    fn residues_have_the_form_of_the_fractions() {
        let field = crate::kernel::residues::PRIMES[0];
        let mut rows: Vec<Vec<u64>> = vec![vec![0, 2, 4], vec![3, 1, 5], vec![3, 3, 9]];
        assert_eq!(reduce(&field, &mut rows, 3), [0, 1]);
        assert_eq!(rows, [[1, 0, 1], [0, 1, 2], [0, 0, 0]]);
    }
}
