//! The factor of M = L L^T, and coordinates in which M is the unit matrix.

use crate::analysis::modes::terms::Terms;
use crate::base::Dd;
use crate::kernel::dense::{Matrix, add_scaled, dot};

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

/// A coordinate whose inertia has no certain digit, because the uncertainty of weights and factors is as large as their
/// sum.
pub fn doubtful(terms: &Terms, n: usize) -> Option<usize> {
    let (mut size, mut doubt) = (vec![0.0; n], vec![0.0; n]);
    for t in 0..terms.len() {
        let (indices, factors) = terms.row(t);
        let weight = terms.weights[t];
        for (&i, factor) in indices.iter().zip(factors) {
            let (a, slip) = (factor.to_f64().abs(), factor.radius());
            size[i as usize] += weight.value.hi() * a * a;
            doubt[i as usize] +=
                weight.radius * (a + slip) * (a + slip) + weight.value.hi().abs() * slip * (2.0 * a + slip);
        }
    }
    // Entries without any inertia are left to the factorisation, which detects them.
    (0..n).find(|&i| doubt[i] > 0.0 && doubt[i] >= size[i].abs())
}

/// The Cholesky factor, below the diagonal; an error with the coordinate at which M is not positive definite to working
/// accuracy.
pub fn factor(mut l: Matrix<Dd>) -> Result<Matrix<Dd>, usize> {
    let n = l.columns();
    let scale: Vec<f64> = (0..n).map(|j| l[(j, j)].hi).collect();
    for j in 0..n {
        let pivot = l[(j, j)];
        // A diagonal entry that has cancelled to its last bits is not usable as a pivot.
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

/// L^-T, upper triangular, one column at a time from L^T x = e_j.
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

/// Whether all entries off the diagonal are zero.
pub fn is_diagonal(matrix: &Matrix<Dd>) -> bool {
    (0..matrix.columns()).all(|j| matrix.column(j).iter().enumerate().all(|(i, x)| i == j || x.is_zero()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};
    use crate::base::{Ball, Number};
    use crate::system::{CoordinateId, Nature};

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

    /// It is found wherever the midpoint of its enclosure happens to be.
    #[test]
    fn a_mass_that_may_be_zero_is_found() {
        for (mid, found) in [(1e-32, Some(1)), (-1e-32, Some(1)), (0.0, Some(1)), (1e-20, None)] {
            let mut system = blank(2);
            push(&mut system.m, "1", 0, None);
            let source = system.m.source(system.coordinates[0].name);
            let mass = Number::Ball(Ball::new(Dd::from(mid), 1e-31));
            system.m.push(source, Nature::Property, mass, [(CoordinateId(1), Number::ONE)]);
            assert_eq!(doubtful(&Terms::of(&system.m), 2), found, "{mid:e}");
        }
    }

    #[test]
    fn what_is_not_positive_definite_is_found() {
        let m = Matrix::from_fn(2, 2, |_, _| Dd::ONE / Dd::from(3.0));
        assert_eq!(factor(m), Err(1));
    }
}
