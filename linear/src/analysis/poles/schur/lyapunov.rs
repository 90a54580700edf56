//! Lyapunov's equation A X + X A^T = R by the Schur form of A (Bartels and Stewart, Comm. ACM 15 (1972) 820). In: a right-hand
//! side. Out: X in binary64, without a bound: a start and a correction, which its user checks.

use super::{ComplexColumns, SchurForm};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::product::{View, product};

impl SchurForm {
    /// X with A X + X A^T = R. With X = Q Y Q^T that is T Y + Y T^T = Q^T R Q, solved from the last column of Y to the first:
    /// those of a block of T are combined with an eigenvector u of the block's transpose, T (Y u) + lambda (Y u) = ...
    pub fn lyapunov(&self, r: &Matrix<f64>) -> Matrix<f64> {
        let (n, q) = (self.n(), View::of(&self.q));
        let mut right = product(product_of(q.transpose(), r).view(), q);
        let mut y = Matrix::fill_with(n, n, 0.0);
        let mut end = n;
        while end > 0 {
            let start = end - self.size_before(end);
            let size = end - start;
            // The right-hand side minus the contribution of the known columns: right_j - sum over k of y_k t_jk.
            for j in start..end {
                for k in end..n {
                    let factor = self.t[(j, k)];
                    if factor != 0.0 {
                        let known = y.column(k).to_vec();
                        super::subtract(right.column_mut(j), factor, &known);
                    }
                }
            }
            if size == 1 {
                let shift = Complex::real(-self.t[(start, start)]);
                let solved = self.solve_shifted(&[shift], &[[1.0, 0.0]], &[[0.0; 2]], &right, start, 1);
                y.column_mut(start).copy_from_slice(solved.re.column(0));
            } else {
                self.block(start, &right, &mut y);
            }
            end = start;
        }
        product(product_of(q, &y).view(), q.transpose())
    }

    fn size_before(&self, end: usize) -> usize {
        if end > 1 && self.is_block(end - 2) { 2 } else { 1 }
    }

    /// Two columns at once.
    fn block(&self, start: usize, right: &Matrix<f64>, y: &mut Matrix<f64>) {
        let n = self.n();
        let t = |i: usize, j: usize| self.t[(start + i, start + j)];
        let (middle, half) = (0.5 * (t(0, 0) + t(1, 1)), 0.5 * (t(0, 0) - t(1, 1)));
        let square = half * half + t(0, 1) * t(1, 0);
        let root = square.abs().sqrt();
        // B^T u = lambda u with the block B: u = (t10, lambda - t00).
        let vector = |lambda: Complex<f64>| [Complex::real(t(1, 0)), lambda - Complex::real(t(0, 0))];
        if square < 0.0 {
            let lambda = Complex::new(middle, root);
            let u = vector(lambda);
            let z = self.solve_shifted(
                &[Complex::real(0.0) - lambda],
                &[[u[0].re, u[1].re]],
                &[[u[0].im, u[1].im]],
                right,
                start,
                2,
            );
            // Y (re u, im u) = (re z, im z)
            let unit = 1.0 / (u[0].re * u[1].im - u[1].re * u[0].im);
            for i in 0..n {
                let (re, im) = (z.re[(i, 0)], z.im[(i, 0)]);
                y[(i, start)] = (re * u[1].im - im * u[1].re) * unit;
                y[(i, start + 1)] = (im * u[0].re - re * u[0].im) * unit;
            }
        } else {
            let lambdas = [middle - root, middle + root];
            let u = lambdas.map(|lambda| vector(Complex::real(lambda)));
            let shifts = lambdas.map(|lambda| Complex::real(-lambda));
            let z = self.solve_shifted(&shifts, &u.map(|u| [u[0].re, u[1].re]), &[[0.0; 2]; 2], right, start, 2);
            let unit = 1.0 / (u[0][0].re * u[1][1].re - u[0][1].re * u[1][0].re);
            for i in 0..n {
                let (a, b) = (z.re[(i, 0)], z.re[(i, 1)]);
                y[(i, start)] = (a * u[1][1].re - b * u[0][1].re) * unit;
                y[(i, start + 1)] = (b * u[0][0].re - a * u[1][0].re) * unit;
            }
        }
    }

    /// (T - shift) z = the columns of a block combined by the factors, for each shift.
    fn solve_shifted(
        &self,
        shifts: &[Complex<f64>],
        re: &[[f64; 2]],
        im: &[[f64; 2]],
        right: &Matrix<f64>,
        start: usize,
        size: usize,
    ) -> ComplexColumns {
        let n = self.n();
        let mut z = ComplexColumns::zeros(n, shifts.len());
        let combined = |i: usize, factors: &[f64; 2]| -> f64 {
            (0..size).map(|offset| right[(i, start + offset)] * factors[offset]).sum()
        };
        for (column, (re, im)) in re.iter().zip(im).enumerate() {
            for i in 0..n {
                z.re[(i, column)] = combined(i, re);
                z.im[(i, column)] = combined(i, im);
            }
        }
        self.back_substitute(shifts, &vec![n; shifts.len()], &mut z);
        z
    }
}

/// A product that is a factor of another one.
struct Product(Matrix<f64>);

fn product_of(a: View, b: &Matrix<f64>) -> Product {
    Product(product(a, View::of(b)))
}

impl Product {
    fn view(&self) -> View<'_> {
        View::of(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// Fractional parts of multiples of the golden ratio, moved to the left of the axis.
    fn matrix(n: usize, left: f64) -> DMatrix<f64> {
        DMatrix::from_fn(n, n, |i, j| {
            let x = ((i * n + j + 1) as f64 * 0.618_033_988_749_894_9).fract() - 0.5;
            if i == j { x - left } else { x }
        })
    }

    /// Complex pairs and real eigenvalues, alone and beside each other.
    #[test]
    fn the_solution_satisfies_its_equation() {
        for (n, left) in [(2, 1.0), (3, 2.0), (7, 3.0), (24, 5.0)] {
            let a = matrix(n, left);
            let r = Matrix::from_fn(n, n, |i, j| ((i * j + i + j) as f64 * 0.37).fract());
            let x = SchurForm::of(a.clone()).expect("converges").lyapunov(&r);
            for i in 0..n {
                for j in 0..n {
                    let sum: f64 = (0..n).map(|k| a[(i, k)] * x[(k, j)] + x[(i, k)] * a[(j, k)]).sum();
                    assert!((sum - r[(i, j)]).abs() < 1e-12, "{n} {i} {j}: {sum} {}", r[(i, j)]);
                }
            }
        }
    }
}
