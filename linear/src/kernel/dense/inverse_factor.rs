//! L^-1 of M = L L^T in binary64, by recursive halving: all but the smallest blocks are products of matrices.

use crate::kernel::dense::Matrix;
use crate::kernel::dense::product::{View, add_product, product};

/// Smaller blocks are inverted entry by entry.
const SMALL: usize = 32;

/// L^-1, lower triangular; only the lower triangle is read. `None` if M is not positive definite in binary64.
pub fn inverse_factor(m: &Matrix<f64>) -> Option<Matrix<f64>> {
    let n = m.columns();
    if n <= SMALL {
        return inverse_small(m);
    }
    let cut = n / 2;
    let block =
        |(row, column): (usize, usize), rows, columns| Matrix::from_fn(rows, columns, |i, j| m[(row + i, column + j)]);
    let first = inverse_factor(&block((0, 0), cut, cut))?;
    // L21 = M21 L11^-T; the remainder of M22 is M22 - L21 L21^T.
    let below = product(View::of(&block((cut, 0), n - cut, cut)), View::of(&first).transpose());
    let mut rest = block((cut, cut), n - cut, n - cut);
    add_product(rest.data_mut(), n - cut, -1.0, View::of(&below), View::of(&below).transpose());
    let second = inverse_factor(&rest)?;
    let corner = product(View::of(&product(View::of(&second), View::of(&below))), View::of(&first));
    Some(Matrix::from_fn(n, n, |i, j| match (i < cut, j < cut) {
        (true, true) => first[(i, j)],
        (false, false) => second[(i - cut, j - cut)],
        (false, true) => -corner[(i - cut, j)],
        (true, false) => 0.0,
    }))
}

fn inverse_small(m: &Matrix<f64>) -> Option<Matrix<f64>> {
    let n = m.columns();
    let mut l = Matrix::fill_with(n, n, 0.0);
    for j in 0..n {
        for i in j..n {
            let rest = m[(i, j)] - (0..j).map(|k| l[(i, k)] * l[(j, k)]).sum::<f64>();
            if i > j {
                l[(i, j)] = rest / l[(j, j)];
            } else if rest > m[(j, j)].abs() * f64::EPSILON * n as f64 {
                l[(j, j)] = rest.sqrt();
            } else {
                return None;
            }
        }
    }
    let mut inverse = Matrix::fill_with(n, n, 0.0);
    for j in 0..n {
        inverse[(j, j)] = 1.0 / l[(j, j)];
        for i in j + 1..n {
            let sum: f64 = (j..i).map(|k| l[(i, k)] * inverse[(k, j)]).sum();
            inverse[(i, j)] = -sum / l[(i, i)];
        }
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_makes_m_the_unit_matrix() {
        let n = 75;
        let m = Matrix::from_fn(n, n, |i, j| 1.0 / (1.0 + i.abs_diff(j) as f64) + f64::from(i == j));
        let inverse = inverse_factor(&m).expect("diagonally dominant enough");
        let half = product(View::of(&inverse), View::of(&m));
        let unit = product(View::of(&half), View::of(&inverse).transpose());
        for j in 0..n {
            for i in 0..n {
                assert!((unit[(i, j)] - f64::from(i == j)).abs() < 1e-14 && (i >= j || inverse[(i, j)] == 0.0));
            }
        }
        assert!(inverse_factor(&Matrix::fill_with(40, 40, 1.0)).is_none());
    }
}
