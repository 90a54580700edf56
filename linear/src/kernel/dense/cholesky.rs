//! Cholesky's factors A = L L^T of symmetric positive definite matrices in double-double, without error bounds, and coordinates
//! in which A is the unit matrix. ([`inverse_factor`](super::inverse_factor) is the blocked one in binary64.)

use crate::base::Dd;
use crate::kernel::dense::{Matrix, add_scaled, dot};

/// Computes L, below the diagonal; reads only the lower triangle of A. If a pivot is at most `least` times the diagonal
/// entry that it was made from, A is not positive definite to that accuracy, and the error is the pivot's row.
pub fn factor(mut l: Matrix<Dd>, least: f64) -> Result<Matrix<Dd>, usize> {
    let n = l.columns();
    let scale: Vec<f64> = (0..n).map(|j| l[(j, j)].hi).collect();
    for j in 0..n {
        let pivot = l[(j, j)];
        if !pivot.is_finite() || pivot.hi <= scale[j].abs() * least {
            return Err(j);
        }
        let root = pivot.sqrt();
        for entry in &mut l.column_mut(j)[j..] {
            *entry = *entry / root;
        }
        for i in j + 1..n {
            let factor = l[(i, j)];
            if !factor.is_zero() {
                let (done, rest) = l.column_pair(j, i);
                add_scaled(&mut rest[i..], -factor, &done[i..]);
            }
        }
    }
    Ok(l)
}

/// L^T, upper triangular with zeros below; `None` if [`factor`] finds that A is not positive definite.
pub fn upper(a: &Matrix<Dd>, least: f64) -> Option<Matrix<Dd>> {
    let l = factor(a.clone(), least).ok()?;
    Some(Matrix::from_fn(l.columns(), l.columns(), |i, j| if i <= j { l[(j, i)] } else { Dd::ZERO }))
}

/// The rounding error of a zero pivot after n steps, relative to its diagonal entry.
pub fn rounding(n: usize) -> f64 {
    n as f64 * 16.0 * Dd::EPSILON
}

/// L^-T, upper triangular, column by column: L^T x = e_j.
pub fn inverse_transpose(lower: &Matrix<Dd>) -> Matrix<Dd> {
    let n = lower.columns();
    let mut x = Matrix::zeros(n, n);
    for j in 0..n {
        x[(j, j)] = lower[(j, j)].recip();
        for i in (0..j).rev() {
            let sum = dot(&lower.column(i)[i + 1..=j], &x.column(j)[i + 1..=j]);
            if !sum.is_zero() {
                x[(i, j)] = -sum / lower[(i, i)];
            }
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_transpose_makes_the_matrix_a_unit_matrix() {
        let m = Matrix::from_fn(3, 3, |i, j| Dd::from(if i == j { 4.0 } else { 1.0 / (1.0 + (i + j) as f64) }));
        let l = factor(m.clone(), rounding(3)).expect("positive definite");
        let x = inverse_transpose(&l);
        for i in 0..3 {
            for j in 0..3 {
                let image: Vec<Dd> = (0..3).map(|r| dot(m.column(r), x.column(j))).collect();
                let expected = if i == j { Dd::ONE } else { Dd::ZERO };
                assert!((dot(x.column(i), &image) - expected).abs().to_f64() < 1e-30);
            }
        }
    }

    #[test]
    fn indefinite_matrices_are_found() {
        let m = Matrix::from_fn(2, 2, |_, _| Dd::ONE / Dd::from(3.0));
        assert_eq!(factor(m.clone(), rounding(2)), Err(1));
        assert_eq!(factor(m, 1e-20), Err(1));
        assert_eq!(factor(Matrix::fill_with(1, 1, Dd::from(-1.0)), 0.0), Err(0));
        assert_eq!(factor(Matrix::fill_with(1, 1, Dd::from(f64::NAN)), 0.0), Err(0));
    }
}
