//! Jacobi's methods in double-double: plane rotations until everything is orthogonal. Slow and sure: on what is graded
//! they keep relative accuracy where methods that first reduce to tridiagonal form lose it (Demmel and Veselic 1992).

use super::dense::{Matrix, dot, rotate};
use crate::base::Dd;

/// Rotates the columns of `g` (and those of `x` with them) until they are orthogonal: G V = U Sigma.
///
/// One-sided Jacobi (Hestenes 1958) with de Rijk's pivoting: the longest column left comes first, so that in graded
/// matrices the large columns settle before they meet the small ones.
pub fn orthogonalise_columns(g: &mut Matrix<Dd>, x: &mut Matrix<Dd>) {
    let n = g.columns();
    // The error of one scalar product relative to the lengths of its factors.
    let tolerance = (3.0 * g.rows() as f64 + 8.0) * Dd::EPSILON / 16.0;
    let mut squares: Vec<Dd> = (0..n).map(|j| dot(g.column(j), g.column(j))).collect();
    for _ in 0..MAX_SWEEPS {
        let mut rotated = false;
        for p in 0..n {
            let longest = (p..n).fold(p, |best, j| if squares[j] > squares[best] { j } else { best });
            g.swap_columns(p, longest);
            x.swap_columns(p, longest);
            squares.swap(p, longest);
            for q in p + 1..n {
                rotated |= orthogonalise_pair(g, x, &mut squares, p, q, tolerance);
            }
        }
        if !rotated {
            return;
        }
        for (j, square) in squares.iter_mut().enumerate() {
            *square = dot(g.column(j), g.column(j));
        }
    }
}

fn orthogonalise_pair(
    g: &mut Matrix<Dd>,
    x: &mut Matrix<Dd>,
    squares: &mut [Dd],
    p: usize,
    q: usize,
    tolerance: f64,
) -> bool {
    let (a, b) = (squares[p], squares[q]);
    let c = dot(g.column(p), g.column(q));
    // Columns beyond the rank shrink by 2^-100 at each rotation and never become orthogonal: they are zero.
    let vanished = b.hi <= a.hi * LEAST_SQUARE;
    if vanished || c.hi.abs() <= tolerance * a.hi.sqrt() * b.hi.sqrt() {
        return false;
    }
    let turn = Rotation::diagonalising(a, b, c);
    turn.apply(g, p, q);
    turn.apply(x, p, q);
    let change = turn.tangent * c;
    for (j, before, after) in [(p, a, a - change), (q, b, b + change)] {
        // What is left of a cancellation is measured anew: it may even have come out negative.
        squares[j] = if after.hi > 0.1 * before.hi { after } else { dot(g.column(j), g.column(j)) };
    }
    true
}

/// Diagonalises the symmetric `k` by rotations J^T K J, applied to the columns of `x` too.
///
/// Cyclic Jacobi; an entry counts as zero where it is below `EPSILON` times the root of its diagonal entries
/// (relative accuracy on scaled diagonally dominant matrices, Barlow and Demmel 1990) or times the smallest number that
/// still matters for the largest diagonal entry.
pub fn diagonalise(k: &mut Matrix<Dd>, x: &mut Matrix<Dd>) {
    let n = k.columns();
    for _ in 0..MAX_SWEEPS {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                let (a, b, c) = (k[(p, p)], k[(q, q)], k[(p, q)]);
                if c.hi.abs() <= Dd::EPSILON / 16.0 * a.hi.abs().sqrt() * b.hi.abs().sqrt() {
                    continue;
                }
                rotated = true;
                let turn = Rotation::diagonalising(a, b, c);
                turn.conjugate(k, p, q);
                k[(p, p)] = a - turn.tangent * c;
                k[(q, q)] = b + turn.tangent * c;
                (k[(p, q)], k[(q, p)]) = (Dd::ZERO, Dd::ZERO);
                turn.apply(x, p, q);
            }
        }
        if !rotated {
            return;
        }
    }
}

/// The square of the ratio of columns that one matrix of a model may have.
const LEAST_SQUARE: f64 = 1e-200;

/// Quadratic convergence sets in after a few sweeps; what is not settled by then is judged by the certificate.
const MAX_SWEEPS: usize = 40;

/// A plane rotation.
struct Rotation {
    cosine: Dd,
    sine: Dd,
    tangent: Dd,
}

impl Rotation {
    /// The smaller rotation that makes [a c; c b] diagonal: t = sign(z) / (|z| + sqrt(1 + z^2)), z = (b - a) / 2c
    /// (Golub and Van Loan, Matrix Computations, section 8.5).
    fn diagonalising(a: Dd, b: Dd, c: Dd) -> Rotation {
        let z = (b - a) / c.scale(2.0);
        let root = if z.hi.abs() > 1e100 { z.abs() } else { (Dd::ONE + z.square()).sqrt() };
        let size = Dd::ONE / (z.abs() + root);
        let tangent = if z.hi < 0.0 { -size } else { size };
        let cosine = Dd::ONE / (Dd::ONE + tangent.square()).sqrt();
        Rotation { cosine, sine: cosine * tangent, tangent }
    }

    fn apply(&self, m: &mut Matrix<Dd>, p: usize, q: usize) {
        let (x, y) = m.column_pair(p, q);
        rotate(x, y, self.cosine, self.sine);
    }

    /// J^T K J, columns then rows; the 2 x 2 block itself is set by the caller.
    fn conjugate(&self, k: &mut Matrix<Dd>, p: usize, q: usize) {
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

    fn hilbert(n: usize) -> Matrix<Dd> {
        Matrix::from_fn(n, n, |i, j| Dd::ONE / Dd::from((i + j + 1) as f64))
    }

    #[test]
    fn singular_values_are_the_roots_of_the_eigenvalues() {
        let n = 6;
        let (mut g, mut v) = (hilbert(n), Matrix::identity(n));
        orthogonalise_columns(&mut g, &mut v);
        let (mut k, mut x) = (hilbert(n), Matrix::identity(n));
        diagonalise(&mut k, &mut x);
        let mut singular: Vec<f64> = (0..n).map(|j| dot(g.column(j), g.column(j)).sqrt().to_f64()).collect();
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
                assert!((dot(x.column(i), x.column(j)).to_f64() - expected).abs() < 1e-29);
            }
        }
    }
}
