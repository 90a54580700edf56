//! Jacobi's methods: plane rotations until the columns are orthogonal or the matrix is diagonal. They are slow and
//! reliable: for graded matrices they keep relative accuracy, while methods that first reduce to tridiagonal form lose
//! it (Demmel and Veselic 1992).

use crate::kernel::dense::{Matrix, rotate};
use crate::kernel::real::Float;

/// Convergence becomes quadratic after a few sweeps; if it has not settled by then, the certificate judges the result.
const MAX_SWEEPS: usize = 40;
/// The smallest squared ratio of column lengths that a matrix of a model may have.
const LEAST_SQUARE: f64 = 1e-200;

/// Rotates the columns of `g` (and those of `x` with them) until they are orthogonal: G V = U Sigma.
///
/// One-sided Jacobi (Hestenes 1958) with de Rijk's pivoting: the longest column left comes first, so that in graded
/// matrices the large columns settle before they meet the small ones.
pub fn orthogonalise_columns<T: Float>(g: &mut Matrix<T>, mut x: Option<&mut Matrix<T>>) {
    let n = g.columns();
    // The error of a scalar product relative to the lengths of its factors.
    let tolerance = (g.rows() as f64 + 4.0) * T::ERROR;
    let mut squares: Vec<T> = (0..n).map(|j| T::dot(g.column(j), g.column(j))).collect();
    for _ in 0..MAX_SWEEPS {
        let mut rotated = false;
        for p in 0..n {
            let longest = (p..n).fold(p, |best, j| if squares[j] > squares[best] { j } else { best });
            g.swap_columns(p, longest);
            if let Some(x) = &mut x {
                x.swap_columns(p, longest);
            }
            squares.swap(p, longest);
            for q in p + 1..n {
                if let Some(turn) = orthogonalise_pair(g, &mut squares, p, q, tolerance) {
                    rotated = true;
                    if let Some(x) = &mut x {
                        turn.apply(x, p, q);
                    }
                }
            }
        }
        if !rotated {
            return;
        }
        for (j, square) in squares.iter_mut().enumerate() {
            *square = T::dot(g.column(j), g.column(j));
        }
    }
}

fn orthogonalise_pair<T: Float>(
    g: &mut Matrix<T>,
    squares: &mut [T],
    p: usize,
    q: usize,
    tolerance: f64,
) -> Option<Rotation<T>> {
    let (a, b) = (squares[p], squares[q]);
    let c = T::dot(g.column(p), g.column(q));
    // Columns beyond the rank shrink to rounding errors at each rotation and never become orthogonal: they are zero.
    let vanished = b.to_f64() <= a.to_f64() * LEAST_SQUARE;
    if vanished || c.to_f64().abs() <= tolerance * a.to_f64().sqrt() * b.to_f64().sqrt() {
        return None;
    }
    let turn = Rotation::diagonalising(a, b, c);
    turn.apply(g, p, q);
    let change = turn.tangent * c;
    for (j, before, after) in [(p, a, a - change), (q, b, b + change)] {
        // The rest after a cancellation is computed again: it may even be negative.
        squares[j] = if after.to_f64() > 0.1 * before.to_f64() { after } else { T::dot(g.column(j), g.column(j)) };
    }
    Some(turn)
}

/// Diagonalises the symmetric `k` by rotations J^T K J, applied to the columns of `x` too.
///
/// Cyclic Jacobi; an entry counts as zero where it is below the rounding error of the root of its diagonal entries' product:
/// that keeps relative accuracy on scaled diagonally dominant matrices (Barlow and Demmel 1990).
pub fn diagonalise<T: Float>(k: &mut Matrix<T>, x: &mut Matrix<T>) {
    let n = k.columns();
    for _ in 0..MAX_SWEEPS {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                let (a, b, c) = (k[(p, p)], k[(q, q)], k[(p, q)]);
                let size = a.to_f64().abs().sqrt() * b.to_f64().abs().sqrt();
                if c.to_f64() == 0.0 || c.to_f64().abs() <= T::ERROR * size {
                    continue;
                }
                rotated = true;
                let turn = Rotation::diagonalising(a, b, c);
                turn.conjugate(k, p, q);
                k[(p, p)] = a - turn.tangent * c;
                k[(q, q)] = b + turn.tangent * c;
                (k[(p, q)], k[(q, p)]) = (T::ZERO, T::ZERO);
                turn.apply(x, p, q);
            }
        }
        if !rotated {
            return;
        }
    }
}

/// A plane rotation.
struct Rotation<T> {
    cosine: T,
    sine: T,
    tangent: T,
}

impl<T: Float> Rotation<T> {
    /// The smaller rotation that makes [a c; c b] diagonal: t = sign(z) / (|z| + sqrt(1 + z^2)), z = (b - a) / 2c
    /// (Golub and Van Loan, Matrix Computations, section 8.5).
    fn diagonalising(a: T, b: T, c: T) -> Rotation<T> {
        let z = (b - a) / (c + c);
        let tangent = if z.to_f64().abs() < 1e100 {
            let magnitude = if z.to_f64() < 0.0 { -z } else { z };
            let size = T::ONE / (magnitude + (T::ONE + z * z).sqrt());
            if z.to_f64() < 0.0 { -size } else { size }
        } else {
            // Such a small tangent is 1 / 2z; z itself may have overflowed.
            c / (b - a)
        };
        let cosine = T::ONE / (T::ONE + tangent * tangent).sqrt();
        Rotation { cosine, sine: cosine * tangent, tangent }
    }

    fn apply(&self, m: &mut Matrix<T>, p: usize, q: usize) {
        let (x, y) = m.column_pair(p, q);
        rotate(x, y, self.cosine, self.sine);
    }

    /// J^T K J, columns then rows; the 2 x 2 block itself is set by the caller.
    fn conjugate(&self, k: &mut Matrix<T>, p: usize, q: usize) {
        self.apply(k, p, q);
        for j in 0..k.columns() {
            if j != p && j != q {
                (k[(p, j)], k[(q, j)]) = (k[(j, p)], k[(j, q)]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Dd;

    fn hilbert(n: usize) -> Matrix<Dd> {
        Matrix::from_fn(n, n, |i, j| Dd::ONE / Dd::from((i + j + 1) as f64))
    }

    #[test]
    fn singular_values_are_the_roots_of_the_eigenvalues() {
        let n = 6;
        let mut g = hilbert(n);
        orthogonalise_columns(&mut g, None);
        let (mut k, mut x) = (hilbert(n), Matrix::identity(n));
        diagonalise(&mut k, &mut x);
        let mut singular: Vec<f64> = (0..n).map(|j| Dd::dot(g.column(j), g.column(j)).sqrt().to_f64()).collect();
        let mut eigen: Vec<f64> = (0..n).map(|j| k[(j, j)].to_f64()).collect();
        singular.sort_by(f64::total_cmp);
        eigen.sort_by(f64::total_cmp);
        for (s, e) in singular.iter().zip(&eigen) {
            assert!((s - e).abs() <= 1e-15 * s, "{s} {e}");
        }
        // The least eigenvalue of the Hilbert matrix of order 6: 1.0827994845655498e-7.
        assert!((eigen[0] - 1.0827994845655498e-7).abs() < 1e-22);
    }

    #[test]
    fn the_vectors_stay_orthogonal() {
        let (mut k, mut x) = (hilbert(5), Matrix::identity(5));
        diagonalise(&mut k, &mut x);
        for i in 0..5 {
            for j in 0..5 {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((Dd::dot(x.column(i), x.column(j)).to_f64() - expected).abs() < 1e-29);
            }
        }
    }

    #[test]
    fn graded_columns_keep_their_small_values_in_binary64() {
        // B D with a well conditioned B: the small singular value is 1e-20 |b_2 orthogonal to b_1| to first order.
        let mut g = Matrix::from_fn(2, 2, |i, j| [[1.0, 1e-20], [1.0, 3e-20]][i][j]);
        orthogonalise_columns(&mut g, None);
        let least = (0..2).map(|j| f64::dot(g.column(j), g.column(j)).sqrt()).fold(f64::INFINITY, f64::min);
        assert!((least - 2e-20 / 2f64.sqrt()).abs() < 1e-35);
    }

    #[test]
    fn columns_beyond_the_rank_end_as_zero() {
        let mut g = Matrix::from_fn(1, 3, |_, j| Dd::ONE / Dd::from(j as f64 + 3.0));
        orthogonalise_columns(&mut g, None);
        assert!(g[(0, 0)].is_finite() && g[(0, 1)].abs().to_f64() < 1e-60);
    }
}
