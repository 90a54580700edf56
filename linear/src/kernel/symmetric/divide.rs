//! All eigenvalues and eigenvectors of a symmetric tridiagonal matrix by divide and conquer.
//!
//! With r = |e| at the cut and u = (0..0, 1, sign e, 0..0) the matrix is diag(T1, T2) + r u u^T, so with the halves
//! solved, Q^T T Q = D + r z z^T (Cuppen, Numer. Math. 36 (1981) 177). Negligible entries of z, and one of two equal d,
//! are deflated; the other eigenvalues are zeros of a rational function ([`secular`](super::secular)); the vectors are
//! those of the z whose zeros are exactly the computed ones, which makes them orthogonal however close they are (Gu and
//! Eisenstat, SIAM J. Matrix Anal. Appl. 16 (1995) 172). The rest is products of matrices. Repeated eigenvalues make it
//! faster, not slower.

use crate::base::OrderBy;
use crate::kernel::dense::jacobi;
use crate::kernel::dense::product::{View, product};
use crate::kernel::dense::{Matrix, rotate};
use crate::kernel::symmetric::secular;
use crate::kernel::symmetric::tridiagonal::dot;

/// Up to this size Jacobi's method is as fast.
const SMALL: usize = 16;

/// Eigenvalues, ascending, and orthonormal eigenvectors.
pub struct Eigen {
    pub values: Vec<f64>,
    pub vectors: Matrix<f64>,
}

/// The eigensystem of the tridiagonal matrix with these entries on the diagonal and beside it.
pub fn solve(diagonal: &[f64], beside: &[f64]) -> Eigen {
    let n = diagonal.len();
    if n <= SMALL {
        return solve_small(diagonal, beside);
    }
    let cut = n / 2;
    let coupling = beside[cut - 1];
    let (mut upper, mut lower) = (diagonal[..cut].to_vec(), diagonal[cut..].to_vec());
    upper[cut - 1] -= coupling.abs();
    lower[0] -= coupling.abs();
    let (first, second) = (solve(&upper, &beside[..cut - 1]), solve(&lower, &beside[cut..]));
    Merge::new(first, second, coupling).into_eigen()
}

fn solve_small(diagonal: &[f64], beside: &[f64]) -> Eigen {
    let n = diagonal.len();
    let mut t = Matrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => beside[i.min(j)],
        _ => 0.0,
    });
    let mut vectors = Matrix::from_fn(n, n, |i, j| f64::from(i == j));
    jacobi::diagonalise(&mut t, &mut vectors);
    let mut order: Vec<usize> = (0..n).collect();
    order.order_by(|&a, &b| t[(a, a)].total_cmp(&t[(b, b)]));
    Eigen { values: order.iter().map(|&i| t[(i, i)]).collect(), vectors: vectors.select_columns(&order) }
}

/// The half in which a column of diag(Q1, Q2) has entries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Half {
    First,
    Both,
    Second,
}

/// D + r z z^T in the basis of the halves' eigenvectors.
struct Merge {
    cut: usize,
    r: f64,
    d: Vec<f64>,
    z: Vec<f64>,
    /// diag(Q1, Q2), with some columns rotated among themselves.
    q: Matrix<f64>,
    halves: Vec<Half>,
}

impl Merge {
    fn new(first: Eigen, second: Eigen, coupling: f64) -> Merge {
        let (cut, rest) = (first.values.len(), second.values.len());
        let n = cut + rest;
        let mut q = Matrix::fill_with(n, n, 0.0);
        for j in 0..cut {
            q.column_mut(j)[..cut].copy_from_slice(first.vectors.column(j));
        }
        for j in 0..rest {
            q.column_mut(cut + j)[cut..].copy_from_slice(second.vectors.column(j));
        }
        let sign = if coupling < 0.0 { -1.0 } else { 1.0 };
        let last = (0..cut).map(|j| first.vectors[(cut - 1, j)]);
        Merge {
            cut,
            r: coupling.abs(),
            z: last.chain((0..rest).map(|j| sign * second.vectors[(0, j)])).collect(),
            d: [first.values, second.values].concat(),
            q,
            halves: (0..n).map(|j| if j < cut { Half::First } else { Half::Second }).collect(),
        }
    }

    fn into_eigen(mut self) -> Eigen {
        let kept = self.deflate();
        let zeros = Zeros::of(&kept.iter().map(|&j| self.d[j]).collect::<Vec<_>>(), &self.entries(&kept), self.r);
        let turned = self.rotate_vectors(&kept, &zeros);
        let n = self.d.len();
        let mut is_kept = vec![false; n];
        kept.iter().for_each(|&j| is_kept[j] = true);
        let aside: Vec<usize> = (0..n).filter(|&j| !is_kept[j]).collect();
        let value = |i: usize| if i < kept.len() { zeros.values[i] } else { self.d[aside[i - kept.len()]] };
        let column = |i: usize| if i < kept.len() { turned.column(i) } else { self.q.column(aside[i - kept.len()]) };
        let mut order: Vec<usize> = (0..n).collect();
        order.order_by(|&a, &b| value(a).total_cmp(&value(b)));
        let mut vectors = Matrix::fill_with(n, n, 0.0);
        for (j, &i) in order.iter().enumerate() {
            vectors.column_mut(j).copy_from_slice(column(i));
        }
        Eigen { values: order.iter().map(|&i| value(i)).collect(), vectors }
    }

    fn entries(&self, kept: &[usize]) -> Vec<f64> {
        kept.iter().map(|&j| self.z[j]).collect()
    }

    /// Deflates the columns that are decoupled to working accuracy; returns the others, ascending in d with no two
    /// equal.
    fn deflate(&mut self) -> Vec<usize> {
        let n = self.d.len();
        let size = self.d.iter().fold(2.0 * self.r, |m, d| m.max(d.abs()));
        let tolerance = 8.0 * f64::EPSILON * size;
        let mut order: Vec<usize> = (0..n).collect();
        order.order_by(|&a, &b| self.d[a].total_cmp(&self.d[b]));
        let mut kept: Vec<usize> = Vec::new();
        for j in order {
            if 2.0 * self.r * self.z[j].abs() <= tolerance {
                continue;
            }
            if let Some(&before) = kept.last()
                && self.decouples(before, j, tolerance)
            {
                kept.pop();
            }
            kept.push(j);
        }
        kept
    }

    /// Rotates the two columns so that `p` is decoupled, if the remaining coupling is within the tolerance.
    fn decouples(&mut self, p: usize, q: usize, tolerance: f64) -> bool {
        let length = libm::hypot(self.z[p], self.z[q]);
        let (c, s) = (self.z[q] / length, self.z[p] / length);
        let distance = self.d[q] - self.d[p];
        if (distance * c * s).abs() > tolerance {
            return false;
        }
        let (low, high) = (p.min(q), p.max(q));
        let (x, y) = self.q.column_pair(low, high);
        rotate(x, y, c, if low == p { s } else { -s });
        (self.z[p], self.z[q]) = (0.0, length);
        (self.d[p], self.d[q]) = (self.d[p] + distance * s * s, self.d[q] - distance * s * s);
        if self.halves[p] != self.halves[q] {
            (self.halves[p], self.halves[q]) = (Half::Both, Half::Both);
        }
        true
    }

    /// The kept columns times the vectors of the zeros; each half of the rows uses only the columns that have entries
    /// there.
    fn rotate_vectors(&self, kept: &[usize], zeros: &Zeros) -> Matrix<f64> {
        let (n, k) = (self.d.len(), kept.len());
        let mut turned = Matrix::fill_with(n, k, 0.0);
        let parts = [(0..self.cut, Half::Second), (self.cut..n, Half::First)];
        for (rows, without) in parts {
            let places: Vec<usize> = (0..k).filter(|&place| self.halves[kept[place]] != without).collect();
            let basis = Matrix::from_fn(rows.len(), places.len(), |i, j| self.q[(rows.start + i, kept[places[j]])]);
            let chosen = zeros.vectors.select_rows(&places);
            let part = product(View::of(&basis), View::of(&chosen));
            for j in 0..k {
                turned.column_mut(j)[rows.clone()].copy_from_slice(part.column(j));
            }
        }
        turned
    }
}

/// Eigenvalues and orthonormal eigenvectors of D + r z z^T.
struct Zeros {
    values: Vec<f64>,
    vectors: Matrix<f64>,
}

impl Zeros {
    fn of(d: &[f64], z: &[f64], r: f64) -> Zeros {
        let k = d.len();
        let squares: Vec<f64> = z.iter().map(|z| z * z).collect();
        // d_j - x_i in column i.
        let mut delta = Matrix::fill_with(k, k, 0.0);
        let mut values = Vec::with_capacity(k);
        for i in 0..k {
            let zero = secular::zero(d, &squares, r, i, delta.column_mut(i));
            values.push(d[zero.origin] + zero.distance);
        }
        let exact = exact_entries(d, z, &delta);
        let mut vectors = delta;
        for i in 0..k {
            let column = vectors.column_mut(i);
            column.iter_mut().zip(&exact).for_each(|(x, z)| *x = z / *x);
            let length = dot(column, column).sqrt();
            column.iter_mut().for_each(|x| *x /= length);
        }
        Zeros { values, vectors }
    }
}

/// The z (up to a factor) for which the computed zeros are exact: z_j^2 ~ prod_i (x_i - d_j) / prod_(i /= j) (d_i - d_j)
/// (Löwner).
fn exact_entries(d: &[f64], z: &[f64], delta: &Matrix<f64>) -> Vec<f64> {
    let mut squares = vec![1.0; d.len()];
    for (i, &pole) in d.iter().enumerate() {
        let column = delta.column(i);
        let quotient = |square: &mut f64, delta: f64, d: f64| *square *= delta / (d - pole);
        let (head, tail) = squares.split_at_mut(i);
        head.iter_mut().zip(column).zip(d).for_each(|((square, &delta), &d)| quotient(square, delta, d));
        tail[0] *= column[i];
        tail[1..].iter_mut().zip(&column[i + 1..]).zip(&d[i + 1..]).for_each(|((s, &delta), &d)| quotient(s, delta, d));
    }
    squares.iter().zip(z).map(|(square, z)| square.abs().sqrt().copysign(*z)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::real::Float;

    /// Largest residual and largest deviation from orthonormality.
    fn errors(diagonal: &[f64], beside: &[f64]) -> (f64, f64) {
        let n = diagonal.len();
        let Eigen { values, vectors } = solve(diagonal, beside);
        assert!(values.is_sorted());
        let (mut residual, mut angle) = (0.0f64, 0.0f64);
        for (j, value) in values.iter().enumerate() {
            let x = vectors.column(j);
            for i in 0..n {
                let below = if i > 0 { beside[i - 1] * x[i - 1] } else { 0.0 };
                let above = if i + 1 < n { beside[i] * x[i + 1] } else { 0.0 };
                residual = residual.max((below + diagonal[i] * x[i] + above - value * x[i]).abs());
            }
            for i in 0..=j {
                let expected = f64::from(i == j);
                angle = angle.max((f64::dot(vectors.column(i), x) - expected).abs());
            }
        }
        (residual, angle)
    }

    #[test]
    fn a_chain_has_its_closed_form() {
        let n = 203;
        let Eigen { values, .. } = solve(&vec![2.0; n], &vec![-1.0; n - 1]);
        for (j, value) in values.iter().enumerate() {
            let truth = 4.0 * (std::f64::consts::PI * (j + 1) as f64 / (2 * (n + 1)) as f64).sin().powi(2);
            assert!((value - truth).abs() <= 20.0 * f64::EPSILON, "{j}: {value} {truth}");
        }
    }

    #[test]
    fn hard_matrices_have_orthonormal_vectors() {
        let n = 170;
        let wilkinson: Vec<f64> = (0..n).map(|i| (i as f64 - 84.5).abs()).collect();
        let glued: Vec<f64> = (0..n - 1).map(|i| if i % 21 == 20 { 1e-9 } else { 1.0 }).collect();
        let periodic: Vec<f64> = (0..n).map(|i| (i % 21) as f64).collect();
        let scrambled: Vec<f64> = (0..n).map(|i| ((i * 7919) % 1009) as f64 / 100.0).collect();
        let graded: Vec<f64> = (0..n).map(|i| 0.8f64.powi(i as i32)).collect();
        let cases = [
            (vec![1.0; n], vec![0.0; n - 1]),
            (vec![0.0; n], vec![1.0; n - 1]),
            (wilkinson, vec![1.0; n - 1]),
            (periodic, glued),
            (scrambled.clone(), scrambled[..n - 1].to_vec()),
            (graded.clone(), graded[1..].to_vec()),
        ];
        for (case, (diagonal, beside)) in cases.iter().enumerate() {
            let size = diagonal.iter().chain(beside).fold(0.0, |m: f64, x| m.max(x.abs()));
            let (residual, angle) = errors(diagonal, beside);
            assert!(
                residual <= 100.0 * f64::EPSILON * size && angle <= 100.0 * f64::EPSILON,
                "{case}: {residual} {angle}"
            );
        }
    }
}
