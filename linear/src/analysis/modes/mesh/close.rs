//! Vectors of frequencies that lie close together. In: approximate vectors that span the right space. Out: the same
//! span, with a separate vector for each frequency.
//!
//! A vector's component along another mode is its residual over the distance of the two eigenvalues. If these agree to
//! ten digits or more, vectors of working precision are arbitrary mixtures; but their span is still accurate, and in it
//! K and M are small matrices (Rayleigh-Ritz), formed from the terms in double-double and diagonalised by Jacobi's
//! method after the eigenvalues' common part is subtracted. See docs/method/modes.md#sparse-parts.

use crate::analysis::modes::gram::Gram;
use crate::analysis::modes::terms::Terms;
use crate::base::{Dd, OrderBy};
use crate::kernel::dense::{Matrix, add_scaled, dot};
use crate::kernel::dense::{cholesky, jacobi};
use crate::kernel::triple::Triple;
use std::ops::Range;

/// Eigenvalues nearer than this part of themselves are close.
pub const CLOSE: f64 = 1e-6;
/// If more vectors than this are close together, they count as a repeated frequency: any basis of its span consists of
/// modes.
const MOST: usize = 40;

/// Runs of two or more close neighbours in an ascending list of eigenvalues.
pub fn runs(lambda: &[f64]) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let mut start = 0;
    for end in 1..=lambda.len() {
        let goes_on = end < lambda.len() && lambda[end] - lambda[end - 1] <= CLOSE * lambda[end].abs();
        if !goes_on {
            if end - start > 1 && end - start <= MOST {
                runs.push(start..end);
            }
            start = end;
        }
    }
    runs
}

/// The vectors of the single modes in the span of `x`; `None` if `x` does not span it to working accuracy.
pub fn separate_close_modes(stiffness: &Terms, masses: &Terms, x: &[Vec<Dd>]) -> Option<Vec<Vec<Dd>>> {
    let n = x.first()?.len();
    let columns = Matrix::from_fn(n, x.len(), |i, j| Triple::from(x[j][i]));
    let (mut k, m) = (Gram::of(stiffness, &columns).mid, Gram::of(masses, &columns).mid);
    let common = k[(0, 0)] / m[(0, 0)];
    for j in 0..x.len() {
        for i in 0..x.len() {
            k[(i, j)] -= common * m[(i, j)];
        }
    }
    let basis = cholesky::inverse_transpose(&cholesky::factor(m, cholesky::rounding(x.len())).ok()?);
    let image = |j: usize| {
        let mut image = vec![Dd::ZERO; x.len()];
        (0..x.len()).for_each(|l| add_scaled(&mut image, basis[(l, j)], k.column(l)));
        image
    };
    let images: Vec<Vec<Dd>> = (0..x.len()).map(image).collect();
    let mut small = Matrix::from_fn(x.len(), x.len(), |i, j| {
        let entry = |i: usize, j: usize| dot(basis.column(i), &images[j]);
        (entry(i, j) + entry(j, i)).scale(0.5)
    });
    let mut turned = basis.clone();
    jacobi::diagonalise(&mut small, &mut turned);
    let mut order: Vec<usize> = (0..x.len()).collect();
    order.order_by(|&a, &b| small[(a, a)].hi.total_cmp(&small[(b, b)].hi));
    let vector = |&j: &usize| {
        let mut vector = vec![Dd::ZERO; n];
        (0..x.len()).for_each(|l| add_scaled(&mut vector, turned[(l, j)], &x[l]));
        vector
    };
    let vectors: Vec<Vec<Dd>> = order.iter().map(vector).collect();
    vectors.iter().flatten().all(|x| x.is_finite()).then_some(vectors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::{blank, push};

    /// Two oscillators that differ by 1e-14 and are coupled by 1e-14, K = [1 + 1e-14, -1e-14; -1e-14, 1 + 2e-14]: from
    /// any mixture of the two, the modes are those of [1, -1; -1, 2], x2 / x1 = (sqrt 5 - 1) / 2 and -(sqrt 5 + 1) / 2.
    #[test]
    fn mixed_modes_are_separated() {
        let mut system = blank(2);
        (0..2).for_each(|i| push(&mut system.m, "1", i, None));
        push(&mut system.k, "1", 0, None);
        push(&mut system.k, "1.00000000000001", 1, None);
        push(&mut system.k, "1e-14", 0, Some(1));
        let (k, m) = (Terms::of(&system.k), Terms::of(&system.m));
        let mixed = [[0.8, 0.6], [-0.6, 0.8]].map(|x| x.map(Dd::from).to_vec());
        let found = separate_close_modes(&k, &m, &mixed).expect("a basis");
        let ratio = |x: &[Dd]| (x[1] / x[0]).to_f64();
        assert!((ratio(&found[0]) - (5f64.sqrt() - 1.0) / 2.0).abs() < 1e-14, "{}", ratio(&found[0]));
        assert!((ratio(&found[1]) + (5f64.sqrt() + 1.0) / 2.0).abs() < 1e-14, "{}", ratio(&found[1]));
    }

    #[test]
    fn close_neighbours_form_one_run() {
        assert_eq!(runs(&[1.0, 1.0 + 1e-9, 1.0 + 2e-9, 2.0, 3.0, 3.0]), [0..3, 4..6]);
        assert!(runs(&[-1.0, 1.0, 2.0]).is_empty() && runs(&[]).is_empty());
    }
}
