//! A Newton step for all modes at once from their residuals, in binary64: X <- X (1 + W) B.
//!
//! To first order K^ and M^ become diagonal for W_ij = -P_ij / (theta_i - theta_j), with P = X^T (K X - M X Theta),
//! whose entries are known relative to the residuals (compare [`correction`](crate::analysis::modes::correction)).
//! Modes too close for that are rotated among themselves by the eigenvectors B of their own block of the pencil. The
//! entries of the block have digits of their own, far below those of the largest eigenvalue: so modes that one
//! reduction of the whole matrix cannot separate are separated by the next one, of the soft modes alone. See
//! docs/method/modes.md#dense-matrices.

use crate::analysis::modes::dense::certificate::Reduced;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::product::{View, add_product, product};
use crate::kernel::symmetric;

/// A larger change is not a small correction.
const SMALL: f64 = 1e-4;

/// The vectors after the step; `None` if numbers overflowed.
pub fn newton_step(x: &Matrix<f64>, pencil: &Reduced) -> Option<Matrix<f64>> {
    let n = x.columns();
    let w = |i: usize, j: usize| -pencil.p[(i, j)] / (pencil.theta[i] - pencil.theta[j]).hi;
    let mut group: Vec<usize> = (0..n).collect();
    for j in 0..n {
        for i in 0..n {
            // Equal quotients would divide by zero.
            if i != j && (w(i, j).is_nan() || w(i, j).abs() > SMALL) {
                join(&mut group, i, j);
            }
        }
    }
    let root: Vec<usize> = (0..n).map(|i| root(&group, i)).collect();
    let change = Matrix::from_fn(n, n, |i, j| match i == j {
        true => -0.5 * pencil.e[(j, j)],
        false if root[i] == root[j] => 0.0,
        false => w(i, j),
    });
    let mut next = x.clone();
    add_product(next.data_mut(), x.rows(), 1.0, View::of(x), View::of(&change));
    for first in 0..n {
        let members: Vec<usize> = (first..n).filter(|&i| root[i] == first).collect();
        if root[first] == first && members.len() > 1 {
            turn(&mut next, pencil, &members)?;
        }
    }
    next.data().iter().all(|x| x.is_finite()).then_some(next)
}

/// The least member of i's group.
fn root(group: &[usize], mut i: usize) -> usize {
    while group[i] != i {
        i = group[i];
    }
    i
}

fn join(group: &mut [usize], i: usize, j: usize) {
    let (i, j) = (root(group, i), root(group, j));
    group[i.max(j)] = i.min(j);
}

/// Replaces the members' columns by combinations that diagonalise their block of the pencil.
fn turn(x: &mut Matrix<f64>, pencil: &Reduced, members: &[usize]) -> Option<()> {
    let size = members.len();
    let origin = pencil.theta[members[0]];
    let block = |a: usize, b: usize| {
        let (i, j) = (members[a], members[b]);
        let gap = (pencil.theta[j] - origin).hi;
        pencil.p[(i, j)] + (f64::from(a == b) + pencil.e[(i, j)]) * gap
    };
    // K^ - theta_0 M^, and (1 + E)^(-1/2) to first order.
    let k = Matrix::from_fn(size, size, |a, b| 0.5 * (block(a, b) + block(b, a)));
    // The diagonal of E was removed by the change above.
    let half = Matrix::from_fn(size, size, |a, b| match a == b {
        true => 1.0,
        false => -0.5 * pencil.e[(members[a], members[b])],
    });
    let square = product(View::of(&product(View::of(&half), View::of(&k))), View::of(&half));
    let vectors = symmetric::eigen(square)?.vectors;
    let turned = product(View::of(&x.select_columns(members)), View::of(&product(View::of(&half), View::of(&vectors))));
    for (j, &column) in members.iter().enumerate() {
        x.column_mut(column).copy_from_slice(turned.column(j));
    }
    Some(())
}
