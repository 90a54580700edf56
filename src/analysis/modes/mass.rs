//! M = L L^T and coordinates in which M is the unit matrix.

use crate::analysis::modes::terms::Terms;
use crate::analysis::numeric::dense::{Matrix, add_scaled, dot};
use crate::base::Dd;

/// sum w a a^T in double-double.
pub fn assembled(terms: &Terms, n: usize) -> Matrix<Dd> {
    let mut matrix = Matrix::zeros(n, n);
    for t in 0..terms.len() {
        let (indices, factors) = terms.row(t);
        for (&j, b) in indices.iter().zip(factors) {
            let weighted = terms.weights[t].value.dd() * b.to_dd();
            for (&i, a) in indices.iter().zip(factors) {
                matrix[(i as usize, j as usize)] += weighted * a.to_dd();
            }
        }
    }
    matrix
}

/// Cholesky's factor, below the diagonal; the coordinate at which M turns out not to be positive definite to working
/// accuracy.
pub fn factor(mut l: Matrix<Dd>) -> Result<Matrix<Dd>, usize> {
    let n = l.columns();
    let scale: Vec<f64> = (0..n).map(|j| l[(j, j)].hi).collect();
    for j in 0..n {
        let pivot = l[(j, j)];
        // What is left of a diagonal entry after cancelling to its last bits is no number to go on with.
        if pivot.hi.is_nan() || pivot.hi <= scale[j].abs() * (n as f64 * 16.0 * Dd::EPSILON) {
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

/// Whether nothing stands beside the diagonal.
pub fn is_diagonal(matrix: &Matrix<Dd>) -> bool {
    (0..matrix.columns()).all(|j| matrix.column(j).iter().enumerate().all(|(i, x)| i == j || x.is_zero()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_transpose_makes_m_the_unit_matrix() {
        let m = Matrix::from_fn(3, 3, |i, j| Dd::from(if i == j { 4.0 } else { 1.0 / (1.0 + (i + j) as f64) }));
        let l = factor(m.clone()).expect("positive definite");
        let x = inverse_transpose(&l);
        for i in 0..3 {
            for j in 0..3 {
                let image: Vec<Dd> = (0..3).map(|r| dot(m.column(r), x.column(j))).collect();
                let expected = if i == j { Dd::ONE } else { Dd::ZERO };
                assert!((dot(x.column(i), &image) - expected).abs().to_f64() < 1e-30);
            }
        }
        assert!(!is_diagonal(&m) && is_diagonal(&Matrix::identity(2)));
    }

    #[test]
    fn what_is_not_positive_definite_is_found() {
        let m = Matrix::from_fn(2, 2, |_, _| Dd::ONE / Dd::from(3.0));
        assert_eq!(factor(m), Err(1));
    }
}
