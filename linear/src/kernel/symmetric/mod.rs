//! All eigenvalues and eigenvectors of a dense symmetric matrix in binary64: reduction to tridiagonal form, divide and
//! conquer, back-transformation.
//!
//! The errors are about n u times the largest eigenvalue, so much smaller eigenvalues have no correct digits. The
//! results are certified elsewhere.

pub mod divide;
pub mod secular;
pub mod tridiagonal;

use crate::kernel::dense::Matrix;
use crate::kernel::symmetric::divide::Eigen;

/// Eigenvalues, ascending, and orthonormal eigenvectors; reads only the lower triangle. `None` if it is not finite.
pub fn eigen(mut a: Matrix<f64>) -> Option<Eigen> {
    let largest = a.data().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if a.data().iter().any(|x| !x.is_finite()) {
        return None;
    }
    // A power of two that keeps squares within range.
    let scale = if largest > 0.0 { f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits()) } else { 1.0 };
    let scale = if scale.is_normal() { scale } else { f64::MIN_POSITIVE };
    a.data_mut().iter_mut().for_each(|x| *x /= scale);
    let reduced = tridiagonal::reduce(a);
    let Eigen { mut values, mut vectors } = divide::solve(&reduced.diagonal, &reduced.beside);
    reduced.turn(&mut vectors);
    values.iter_mut().for_each(|x| *x *= scale);
    Some(Eigen { values, vectors })
}
