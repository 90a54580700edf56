//! The real Schur form A = Q T Q^T: eigenvalues, and (A - s)^-1 b for many shifts s at the cost of one triangular solve
//! each. In: a square binary64 matrix. Out: starting values and corrections, in binary64; nothing here is printed.
//!
//! T is upper triangular except for 2 x 2 blocks on its diagonal (Golub and Van Loan, Matrix Computations, 4th ed.,
//! 7.4). Each column of T is read once for a group of right-hand sides, because reading it dominates the cost of a
//! solve.

mod lyapunov;

use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::product::{View, product};
use crate::kernel::simd::simd;
use nalgebra::{DMatrix, Schur};

/// Number of right-hand sides for which a column of T is read once.
const GROUP: usize = 8;

/// A complex matrix stored as its real and imaginary parts, because all products here have a real factor.
#[derive(Clone, Debug)]
pub struct ComplexColumns {
    pub re: Matrix<f64>,
    pub im: Matrix<f64>,
}

/// An eigenvalue, real or with im > 0, and the first row of its block in T.
#[derive(Clone, Copy, Debug)]
pub struct Eigenvalue {
    pub value: Complex<f64>,
    pub place: usize,
}

/// A = Q T Q^T.
#[derive(Clone, Debug)]
pub struct SchurForm {
    q: Matrix<f64>,
    t: Matrix<f64>,
    /// A smaller pivot is rounding error.
    least_pivot: f64,
}

impl ComplexColumns {
    pub fn zeros(rows: usize, columns: usize) -> ComplexColumns {
        let zeros = Matrix::fill_with(rows, columns, 0.0);
        ComplexColumns { re: zeros.clone(), im: zeros }
    }

    pub fn columns(&self) -> usize {
        self.re.columns()
    }

    pub fn at(&self, i: usize, j: usize) -> Complex<f64> {
        Complex::new(self.re[(i, j)], self.im[(i, j)])
    }

    pub fn set(&mut self, i: usize, j: usize, z: Complex<f64>) {
        self.re[(i, j)] = z.re;
        self.im[(i, j)] = z.im;
    }

    /// Multiplies column j by `factor(j)`.
    pub fn scale(&mut self, factor: impl Fn(usize) -> Complex<f64>) {
        for j in 0..self.columns() {
            let f = factor(j);
            for (re, im) in self.re.column_mut(j).iter_mut().zip(self.im.column_mut(j)) {
                let z = Complex::new(*re, *im) * f;
                (*re, *im) = (z.re, z.im);
            }
        }
    }

    /// A X for a real A.
    pub fn times(&self, a: View) -> ComplexColumns {
        ComplexColumns { re: product(a, View::of(&self.re)), im: product(a, View::of(&self.im)) }
    }
}

/// Sizes below which an entry beside the diagonal splits the matrix, relative to its neighbours. If roundings keep the
/// iteration above the first one, a larger one is tried: the form is the start of proofs, which do not depend on it.
const SPLITS: [f64; 3] = [f64::EPSILON, 16.0 * f64::EPSILON, 1024.0 * f64::EPSILON];

impl SchurForm {
    /// `None` if the iteration does not converge, or a number is not finite.
    pub fn of(a: DMatrix<f64>) -> Option<SchurForm> {
        if a.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let n = a.nrows();
        if n == 0 {
            // All motions of the part are rigid, as far as binary64 can tell; nalgebra's Schur form does not handle an
            // empty matrix.
            let empty = Matrix::fill_with(0, 0, 0.0);
            return Some(SchurForm { q: empty.clone(), t: empty, least_pivot: 0.0 });
        }
        if n == 1 {
            // nalgebra does not handle this case either.
            let (q, t) = (Matrix::fill_with(1, 1, 1.0), Matrix::fill_with(1, 1, a[(0, 0)]));
            return Some(SchurForm { q, t, least_pivot: (a[(0, 0)].abs() * f64::EPSILON).max(f64::MIN_POSITIVE) });
        }
        let (q, t) = SPLITS.iter().find_map(|split| Schur::try_new(a.clone(), *split, 100 * n))?.unpack();
        let [q, t] = [q, t].map(|m| Matrix::from_fn(n, n, |i, j| m[(i, j)]));
        let largest = t.data().iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
        Some(SchurForm { q, t, least_pivot: (largest * f64::EPSILON).max(f64::MIN_POSITIVE) })
    }

    pub fn n(&self) -> usize {
        self.t.rows()
    }

    /// The eigenvalues in the order of T, one of each conjugate pair.
    pub fn eigenvalues(&self) -> Vec<Eigenvalue> {
        let (mut list, mut k) = (Vec::with_capacity(self.n()), 0);
        while k < self.n() {
            if !self.is_block(k) {
                list.push(Eigenvalue { value: Complex::real(self.t[(k, k)]), place: k });
                k += 1;
                continue;
            }
            let middle = 0.5 * (self.t[(k, k)] + self.t[(k + 1, k + 1)]);
            let half = 0.5 * (self.t[(k, k)] - self.t[(k + 1, k + 1)]);
            let square = half * half + self.t[(k, k + 1)] * self.t[(k + 1, k)];
            let root = square.abs().sqrt();
            if square < 0.0 {
                list.push(Eigenvalue { value: Complex::new(middle, root), place: k });
            } else {
                list.extend([-root, root].map(|r| Eigenvalue { value: Complex::real(middle + r), place: k }));
            }
            k += 2;
        }
        list
    }

    /// A column for each eigenvalue: A x = s x to the accuracy of binary64.
    pub fn eigenvectors(&self, list: &[Eigenvalue]) -> ComplexColumns {
        let mut w = ComplexColumns::zeros(self.n(), list.len());
        for (column, eigenvalue) in list.iter().enumerate() {
            let k = eigenvalue.place;
            for (offset, z) in self.block_vector(eigenvalue).into_iter().enumerate().take(self.block_size(k)) {
                w.set(k + offset, column, z);
                let above = &self.t.column(k + offset)[..k];
                subtract(&mut w.re.column_mut(column)[..k], z.re, above);
                subtract(&mut w.im.column_mut(column)[..k], z.im, above);
            }
        }
        let shifts: Vec<Complex<f64>> = list.iter().map(|eigenvalue| eigenvalue.value).collect();
        let places: Vec<usize> = list.iter().map(|eigenvalue| eigenvalue.place).collect();
        self.back_substitute(&shifts, &places, &mut w);
        w.times(View::of(&self.q))
    }

    /// (A - s_j)^-1 b_j, column by column.
    pub fn solve(&self, shifts: &[Complex<f64>], b: &ComplexColumns) -> ComplexColumns {
        let q = View::of(&self.q);
        let mut w = b.times(q.transpose());
        self.back_substitute(shifts, &vec![self.n(); shifts.len()], &mut w);
        w.times(q)
    }

    fn is_block(&self, k: usize) -> bool {
        k + 1 < self.n() && self.t[(k + 1, k)] != 0.0
    }

    fn block_size(&self, k: usize) -> usize {
        1 + usize::from(self.is_block(k))
    }

    /// The eigenvector of the diagonal block; one of the two formulas vanishes only if the block is a multiple of 1.
    fn block_vector(&self, eigenvalue: &Eigenvalue) -> [Complex<f64>; 2] {
        let k = eigenvalue.place;
        if !self.is_block(k) {
            return [Complex::real(1.0), Complex::ZERO];
        }
        let entry = |i: usize, j: usize| Complex::real(self.t[(k + i, k + j)]);
        let (upper, lower) = (eigenvalue.value - entry(0, 0), eigenvalue.value - entry(1, 1));
        let size = |x: [Complex<f64>; 2]| x[0].one_norm() + x[1].one_norm();
        let (a, b) = ([entry(0, 1), upper], [lower, entry(1, 0)]);
        let vector = if size(a) >= size(b) { a } else { b };
        let scale = 1.0 / size(vector);
        vector.map(|z| z.scale(scale))
    }

    /// Solves (T - s_j) w_j = b_j in place, for rows before `places[j]` only.
    fn back_substitute(&self, shifts: &[Complex<f64>], places: &[usize], w: &mut ComplexColumns) {
        let n = self.n();
        for first in (0..shifts.len()).step_by(GROUP) {
            let group = first..(first + GROUP).min(shifts.len());
            let mut end = group.clone().map(|column| places[column]).max().unwrap_or(0).min(n);
            while end > 0 {
                let start = if end > 1 && self.is_block(end - 2) { end - 2 } else { end - 1 };
                for column in group.clone().filter(|&column| places[column] >= end) {
                    let x = self.block_solution(start, end - start, shifts[column], w, column);
                    for (offset, z) in x.into_iter().enumerate().take(end - start) {
                        w.set(start + offset, column, z);
                        let above = &self.t.column(start + offset)[..start];
                        subtract(&mut w.re.column_mut(column)[..start], z.re, above);
                        subtract(&mut w.im.column_mut(column)[..start], z.im, above);
                    }
                }
                end = start;
            }
        }
    }

    /// The solution of a diagonal block, 1 x 1 or 2 x 2.
    fn block_solution(
        &self,
        k: usize,
        size: usize,
        s: Complex<f64>,
        w: &ComplexColumns,
        column: usize,
    ) -> [Complex<f64>; 2] {
        let entry = |i: usize, j: usize| Complex::real(self.t[(k + i, k + j)]);
        if size == 1 {
            let pivot = self.away_from_zero(entry(0, 0) - s, self.least_pivot);
            return [w.at(k, column) * pivot.recip(), Complex::ZERO];
        }
        let (a, d) = (entry(0, 0) - s, entry(1, 1) - s);
        let determinant = a * d - entry(0, 1) * entry(1, 0);
        let scale = a.one_norm() + d.one_norm() + entry(0, 1).one_norm() + entry(1, 0).one_norm();
        let inverse = self.away_from_zero(determinant, self.least_pivot * scale).recip();
        let (r0, r1) = (w.at(k, column), w.at(k + 1, column));
        [(r0 * d - r1 * entry(0, 1)) * inverse, (r1 * a - r0 * entry(1, 0)) * inverse]
    }

    /// Replaces a zero pivot by a very small one: the matrix of an eigenvalue is singular, and inverse iteration relies
    /// on that.
    fn away_from_zero(&self, pivot: Complex<f64>, least: f64) -> Complex<f64> {
        if pivot.one_norm() < least { Complex::real(least) } else { pivot }
    }
}

simd! {
    /// y <- y - factor x
    fn subtract(y: &mut [f64], factor: f64, x: &[f64]) {
        for (y, &x) in y.iter_mut().zip(x) {
            *y = (-factor).mul_add(x, *y);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudo-random rows: fractional parts of multiples of the golden ratio, minus a half.
    fn matrix(n: usize) -> DMatrix<f64> {
        DMatrix::from_fn(n, n, |i, j| ((i * n + j + 1) as f64 * 0.618_033_988_749_894_9).fract() - 0.5)
    }

    fn apply(a: &DMatrix<f64>, x: &ComplexColumns) -> ComplexColumns {
        let a = Matrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)]);
        x.times(View::of(&a))
    }

    #[test]
    fn eigenvectors_are_those_of_the_matrix() {
        let a = matrix(23);
        let form = SchurForm::of(a.clone()).expect("converges");
        let list = form.eigenvalues();
        let count: usize = list.iter().map(|e| if e.value.im == 0.0 { 1 } else { 2 }).sum();
        assert_eq!(count, 23);
        let x = form.eigenvectors(&list);
        let ax = apply(&a, &x);
        for (j, eigenvalue) in list.iter().enumerate() {
            let size = (0..23).map(|i| x.at(i, j).one_norm()).fold(0.0, f64::max);
            for i in 0..23 {
                // The backward error is some units of |A| <= 23 / 2.
                assert!((ax.at(i, j) - x.at(i, j) * eigenvalue.value).one_norm() < 1e-13 * size, "{i} {j}");
            }
        }
    }

    /// The smallest matrices: none, and one number.
    #[test]
    fn a_number_is_its_own_eigenvalue() {
        let form = SchurForm::of(DMatrix::from_element(1, 1, -3.0)).expect("a form");
        let list = form.eigenvalues();
        assert_eq!(list.len(), 1);
        assert_eq!(list[0].value, Complex::real(-3.0));
        assert_eq!(form.eigenvectors(&list).at(0, 0), Complex::real(1.0));
        // -3 x - 3 x = 12
        assert_eq!(form.lyapunov(&Matrix::fill_with(1, 1, 12.0))[(0, 0)], -2.0);
        assert_eq!(SchurForm::of(DMatrix::zeros(0, 0)).expect("a form").eigenvalues().len(), 0);
    }

    #[test]
    fn solutions_satisfy_their_equations() {
        let a = matrix(17);
        let form = SchurForm::of(a.clone()).expect("converges");
        let shifts: Vec<Complex<f64>> = (0..11).map(|j| Complex::new(0.3 * j as f64 - 1.0, 0.2 * j as f64)).collect();
        let mut b = ComplexColumns::zeros(17, 11);
        (0..11).for_each(|j| (0..17).for_each(|i| b.set(i, j, Complex::new((i + j) as f64, (i * j) as f64))));
        let x = form.solve(&shifts, &b);
        let ax = apply(&a, &x);
        for (j, &s) in shifts.iter().enumerate() {
            for i in 0..17 {
                let residual = ax.at(i, j) - x.at(i, j) * s - b.at(i, j);
                assert!(residual.one_norm() < 1e-11, "{i} {j}: {residual:?}");
            }
        }
    }
}
