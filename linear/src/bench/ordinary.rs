//! The methods of an ordinary program: matrices assembled in binary64, then a general library.

use crate::system::{Form, LinearSystem};
use nalgebra::{Complex, DMatrix, DVector};

/// M, C and K as numbers.
pub struct Matrices {
    pub m: DMatrix<f64>,
    pub c: DMatrix<f64>,
    pub k: DMatrix<f64>,
}

impl Matrices {
    pub fn of(system: &LinearSystem) -> Matrices {
        let matrix = |form: &Form| {
            let mut dense = DMatrix::zeros(system.n(), system.n());
            for term in form.terms() {
                for (i, a) in form.row(term) {
                    for (j, b) in form.row(term) {
                        dense[(i.index(), j.index())] += term.weight.to_f64() * a.to_f64() * b.to_f64();
                    }
                }
            }
            dense
        };
        Matrices { m: matrix(&system.m), c: matrix(&system.c), k: matrix(&system.k) }
    }

    pub fn n(&self) -> usize {
        self.m.nrows()
    }

    /// omega^2 of L^-1 K L^-T, M = L L^T, ascending, as computed by `eigh`.
    pub fn symmetric(&self) -> Option<Vec<f64>> {
        Some(sort(self.standard()?.symmetric_eigen().eigenvalues.iter().copied().collect()))
    }

    /// omega^2 and modes X with X^T M X = 1.
    pub fn modes(&self) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let l = self.m.clone().cholesky()?.l();
        let eigen = self.standard()?.symmetric_eigen();
        let shapes = l.transpose().solve_upper_triangular(&eigen.eigenvectors)?;
        Some((eigen.eigenvalues, shapes))
    }

    fn standard(&self) -> Option<DMatrix<f64>> {
        let l = self.m.clone().cholesky()?.l();
        let half = l.solve_lower_triangular(&self.k)?;
        let whole = l.solve_lower_triangular(&half.transpose())?;
        Some((&whole + whole.transpose()) * 0.5)
    }

    /// omega^2 of M^-1 K, real parts, ascending.
    pub fn unsymmetric(&self) -> Option<Vec<f64>> {
        let product = self.m.clone().lu().solve(&self.k)?;
        let values = product.try_schur(f64::EPSILON, 10_000)?.complex_eigenvalues();
        Some(sort(values.iter().map(|z| z.re).collect()))
    }

    /// Eigenvalues of the companion matrix.
    pub fn companion(&self) -> Option<Vec<Complex<f64>>> {
        let a = self.first_order()?;
        Some(a.try_schur(f64::EPSILON, 10_000)?.complex_eigenvalues().iter().copied().collect())
    }

    /// [0 1; -M^-1 K, -M^-1 C]
    pub fn first_order(&self) -> Option<DMatrix<f64>> {
        let (n, lu) = (self.n(), self.m.clone().lu());
        let (k, c) = (lu.solve(&self.k)?, lu.solve(&self.c)?);
        if !k.iter().chain(c.iter()).all(|x| x.is_finite()) {
            return None;
        }
        Some(DMatrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
            (true, true) => 0.0,
            (true, false) => f64::from(i == j - n),
            (false, true) => -k[(i - n, j)],
            (false, false) => -c[(i - n, j - n)],
        }))
    }

    /// p^T (K - omega^2 M + i omega C)^-1 b for unit vectors.
    pub fn solve(&self, omega: f64, input: usize, output: usize) -> Option<Complex<f64>> {
        let n = self.n();
        let q = DMatrix::from_fn(n, n, |i, j| {
            Complex::new(self.k[(i, j)] - omega * omega * self.m[(i, j)], omega * self.c[(i, j)])
        });
        let load = DVector::from_fn(n, |i, _| Complex::new(f64::from(i == input), 0.0));
        Some(q.lu().solve(&load)?[output])
    }
}

/// omega^2 as squares of singular values of G = sqrt(w) A L^-T: the terms are kept separate, and a general library does
/// the rest.
pub fn singular_values(system: &LinearSystem, matrices: &Matrices) -> Option<Vec<f64>> {
    let n = system.n();
    if system.k.terms().any(|term| term.weight.to_f64() <= 0.0) {
        return None;
    }
    let rows = system.k.terms().len().max(n);
    let mut a = DMatrix::zeros(rows, n);
    for (t, term) in system.k.terms().enumerate() {
        for (i, value) in system.k.row(term) {
            a[(t, i.index())] = term.weight.to_f64().sqrt() * value.to_f64();
        }
    }
    let l = matrices.m.clone().cholesky()?.l();
    let g = l.solve_lower_triangular(&a.transpose())?.transpose();
    let values = g.try_svd(false, false, f64::EPSILON, 10_000)?.singular_values;
    Some(sort(values.iter().map(|s| s * s).collect()))
}

fn sort(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}
