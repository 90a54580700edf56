//! All eigenvalues and eigenvectors of A = J S in binary64, with S symmetric and J a diagonal matrix of signs, in a
//! third of the operations that a Schur form takes: hyperbolic reflections reduce S to tridiagonal form, after which
//! everything but the back-transformation takes n^2 operations.
//!
//! Hyperbolic reflections are not bounded as orthogonal ones are: results usually have 8 to 14 digits, but no number of
//! digits is promised. They are starting values. Callers refine and prove them, and fall back to a Schur form if that
//! fails.

pub mod eigenvalues;
pub mod eigenvectors;
pub mod reduction;

use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;

/// Eigenvalues of a real matrix, one of each conjugate pair (im > 0) and the real ones, each with its eigenvector in the
/// column of `re` and of `im`.
pub struct Eigen {
    pub values: Vec<Complex<f64>>,
    pub re: Matrix<f64>,
    pub im: Matrix<f64>,
}

/// A tridiagonal pencil T - s J: the diagonal of T, the entries beside it, and the signs J.
pub struct Tridiagonal {
    pub diagonal: Vec<f64>,
    pub beside: Vec<f64>,
    pub signs: Vec<f64>,
}

/// The eigenvalues and eigenvectors of J S; reads only the lower triangle of `s`. The reduction begins with the vector
/// `start`, which should have a component along every eigenvector. `None` if the reduction breaks down, or if
/// eigenvalues are not found in conjugate pairs.
pub fn eigen(s: &Matrix<f64>, signs: &[f64], start: &[f64]) -> Option<Eigen> {
    if s.data().iter().any(|x| !x.is_finite()) {
        return None;
    }
    let reduced = reduction::reduce(s, signs, start)?;
    let values = eigenvalues::eigenvalues(&reduced.pencil)?;
    let (mut re, mut im) = eigenvectors::eigenvectors(&reduced.pencil, &values);
    reduced.turn(&mut re);
    reduced.turn(&mut im);
    Some(Eigen { values, re, im })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// J S of a damped chain in the form [0 W; W C], C dense.
    fn damped_chain(n: usize, damping: f64) -> (Matrix<f64>, Vec<f64>, Vec<f64>) {
        let rate = |j: usize| 1.0 + j as f64 * 0.37;
        let row = |i: usize, l: usize| ((i * 31 + l * 17 + 5) % 23) as f64 / 23.0 - 0.4;
        let c = |i: usize, j: usize| damping * (0..n).map(|l| row(i, l) * row(j, l)).sum::<f64>();
        let s = Matrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
            (true, true) => 0.0,
            (false, false) => c(i - n, j - n),
            (low, _) => {
                if i % n == j % n {
                    rate(if low { i } else { j })
                } else {
                    0.0
                }
            }
        });
        let signs = (0..2 * n).map(|i| if i < n { 1.0 } else { -1.0 }).collect();
        let start = (0..2 * n).map(|i| if i < n { 0.0 } else { 0.5 + (i as f64 * 0.618_033_988_749_894_9).fract() });
        (s, signs, start.collect())
    }

    #[test]
    fn vectors_are_those_of_the_matrix() {
        for n in [1, 2, 5, 40] {
            for damping in [0.0, 1e-3, 0.1, 3.0] {
                let (s, signs, start) = damped_chain(n, damping);
                let found = eigen(&s, &signs, &start).expect("no breakdown");
                let count: usize = found.values.iter().map(|z| if z.im == 0.0 { 1 } else { 2 }).sum();
                assert_eq!(count, 2 * n, "{n} {damping}");
                for (j, &z) in found.values.iter().enumerate() {
                    let x = |i: usize| Complex::new(found.re[(i, j)], found.im[(i, j)]);
                    let size = (0..2 * n).map(|i| x(i).abs()).fold(0.0, f64::max);
                    for (i, sign) in signs.iter().enumerate() {
                        let image = (0..2 * n).fold(Complex::ZERO, |sum, l| sum + x(l).scale(s[(i, l)]));
                        let error = (image.scale(*sign) - x(i) * z).abs();
                        assert!(error < 1e-7 * size * (1.0 + damping) * n as f64, "{n} {damping} {z:?} {i}: {error}");
                    }
                }
            }
        }
    }

    /// A start without a part along half of the motions finds no more than breaks down or is not finite.
    #[test]
    fn numbers_that_are_not_finite_are_refused() {
        let (mut s, signs, start) = damped_chain(3, 0.1);
        s[(4, 3)] = f64::NAN;
        assert!(eigen(&s, &signs, &start).is_none());
    }
}
