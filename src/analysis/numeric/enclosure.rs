//! Small dense matrices of balls: products, solutions and triangular factors whose errors are known.

use crate::analysis::numeric::dense::Matrix;
use crate::base::{Ball, Dd};

/// A bound of the 2-norm of |A|: the smaller of the Frobenius norm and sqrt(norm_1 norm_inf).
pub fn norm_bound(rows: usize, columns: usize, size: impl Fn(usize, usize) -> f64) -> f64 {
    let (mut squares, mut row_sums, mut largest_column) = (0.0, vec![0.0; rows], 0.0f64);
    for j in 0..columns {
        let mut column = 0.0;
        for (i, row) in row_sums.iter_mut().enumerate() {
            let x = size(i, j);
            squares += x * x;
            *row += x;
            column += x;
        }
        largest_column = largest_column.max(column);
    }
    let largest_row = row_sums.iter().copied().fold(0.0, f64::max);
    // A thousand rows of sums in binary64 lose less than 1e-12.
    squares.sqrt().min((largest_row * largest_column).sqrt()) * (1.0 + 1e-12)
}

impl Matrix<Ball> {
    pub fn none(rows: usize, columns: usize) -> Matrix<Ball> {
        Matrix::filled(rows, columns, Ball::ZERO)
    }

    pub fn mid(&self) -> Matrix<Dd> {
        self.map(|ball| ball.mid)
    }

    pub fn is_finite(&self) -> bool {
        (0..self.columns()).all(|j| self.column(j).iter().all(Ball::is_finite))
    }

    /// A bound of the 2-norm of what the midpoints are off by.
    pub fn radius(&self) -> f64 {
        norm_bound(self.rows(), self.columns(), |i, j| self[(i, j)].rad)
    }
}

/// A B
pub fn product(a: &Matrix<Ball>, b: &Matrix<Ball>) -> Matrix<Ball> {
    let mut c = Matrix::none(a.rows(), b.columns());
    for j in 0..b.columns() {
        for (k, &factor) in b.column(j).iter().enumerate() {
            if factor.is_zero() {
                continue;
            }
            for (c, &a) in c.column_mut(j).iter_mut().zip(a.column(k)) {
                *c = *c + a * factor;
            }
        }
    }
    c
}

/// A^-1 B by Gaussian elimination with partial pivoting; `None` where A may be singular.
pub fn solve(a: &Matrix<Ball>, b: &Matrix<Ball>) -> Option<Matrix<Ball>> {
    let n = a.rows();
    let mut rows: Vec<Vec<Ball>> =
        (0..n).map(|i| (0..n).map(|j| a[(i, j)]).chain((0..b.columns()).map(|j| b[(i, j)])).collect()).collect();
    for step in 0..n {
        let pivot = (step..n)
            .fold(step, |best, i| if rows[i][step].mignitude() > rows[best][step].mignitude() { i } else { best });
        if rows[pivot][step].contains_zero() || !rows[pivot][step].is_finite() {
            return None;
        }
        rows.swap(pivot, step);
        let (top, below) = rows.split_at_mut(step + 1);
        for row in below {
            subtract_multiple(row, &top[step], step);
        }
    }
    for step in (0..n).rev() {
        let (above, rest) = rows.split_at_mut(step);
        let pivot = rest[0][step];
        for x in &mut rest[0][n..] {
            *x = *x / pivot;
        }
        for row in above {
            let factor = row[step];
            for (x, &y) in row[n..].iter_mut().zip(&rest[0][n..]) {
                *x = *x - factor * y;
            }
        }
    }
    Some(Matrix::from_fn(n, b.columns(), |i, j| rows[i][n + j]))
}

fn subtract_multiple(row: &mut [Ball], pivot_row: &[Ball], step: usize) {
    if row[step].is_zero() {
        return;
    }
    let factor = row[step] / pivot_row[step];
    for (x, &y) in row.iter_mut().zip(pivot_row).skip(step) {
        *x = *x - factor * y;
    }
}

/// An upper triangular S with S^T S near A, in double-double without a bound; `None` unless A is safely positive definite.
pub fn cholesky(a: &Matrix<Dd>) -> Option<Matrix<Dd>> {
    let n = a.rows();
    let mut s = Matrix::zeros(n, n);
    for j in 0..n {
        for i in 0..=j {
            let mut rest = a[(i, j)];
            for k in 0..i {
                rest -= s[(k, i)] * s[(k, j)];
            }
            if i < j {
                s[(i, j)] = rest / s[(i, i)];
            } else {
                // A pivot made of rounding is below 2^-100 of its diagonal; twenty digits keep a distance from that.
                if !(rest.hi > 1e-20 * a[(j, j)].hi && rest.is_finite()) {
                    return None;
                }
                s[(j, j)] = rest.sqrt();
            }
        }
    }
    Some(s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solution_encloses_the_true_one() {
        // The Hilbert matrix of order 5; the solution for a sum of its rows is all ones.
        let n = 5;
        let a = Matrix::from_fn(n, n, |i, j| Ball::ONE / Ball::from((i + j + 1) as f64));
        let b = product(&a, &Matrix::filled(n, 1, Ball::ONE));
        let x = solve(&a, &b).expect("regular");
        for i in 0..n {
            assert!((x[(i, 0)] - Ball::ONE).contains_zero());
            assert!(x[(i, 0)].rad < 1e-20);
        }
    }

    #[test]
    fn the_norm_is_not_below_the_true_one() {
        // [3 4; 0 0] has the 2-norm 5.
        let bound = norm_bound(2, 2, |i, j| if i == 0 { [3.0, 4.0][j] } else { 0.0 });
        assert!((5.0..5.3).contains(&bound));
    }

    #[test]
    fn an_indefinite_matrix_has_no_factor() {
        assert!(cholesky(&Matrix::filled(2, 2, Dd::ONE)).is_none());
        assert!(cholesky(&Matrix::from_fn(1, 1, |_, _| Dd::from(-1.0))).is_none());
    }
}
