//! One Newton step for all modes at once: X <- X (1 + W), from the pencil in the basis of X.
//!
//! With K^ = X^T K X and M^ = X^T M X nearly diagonal, both off-diagonal parts vanish to first order for
//!
//!   W_ij = -(K^_ij - lambda_j M^_ij) / (K^_ii - lambda_j M^_ii),   i != j,
//!
//! so the errors of the modes are squared (Ogita and Aishima 2018 in the form for a pencil). The entries of K^ come
//! from the terms, so W has full relative accuracy however small it is: it removes a soft mode's spurious stretch of a
//! stiff spring even if that is below the last bit of its displacements. Modes too close for the formula are rotated
//! among themselves until their block is diagonal. See docs/method/modes.md#refinement.

use crate::analysis::modes::gram::Gram;
use crate::base::Dd;
use crate::kernel::dense::jacobi;
use crate::kernel::dense::{Matrix, add_scaled, dot};
use crate::kernel::triple::Triple;

/// A step larger than this is not small: such modes are treated as a group.
const SMALL: f64 = 1e-4;

/// The Rayleigh quotients K^_ii / M^_ii.
pub fn quotients(k: &Gram, m: &Gram) -> Vec<Dd> {
    (0..k.mid.columns()).map(|i| k.mid[(i, i)] / m.mid[(i, i)]).collect()
}

/// How much the couplings still change the eigenvalues, relative to them: max_i sum_j T_ij^2 / |lambda_i - lambda_j|
/// |lambda_i|; for members of a cluster, the coupling itself. An estimate for steering, not a bound. The first `rigid`
/// columns have no eigenvalue to be relative to.
pub fn distance_from_diagonal(k: &Gram, m: &Gram, rigid: usize) -> f64 {
    let lambda: Vec<f64> = quotients(k, m).iter().map(|x| x.hi).collect();
    let n = lambda.len();
    let mut worst = 0.0f64;
    for i in rigid..n {
        let mut sum = 0.0;
        for j in (0..n).filter(|&j| j != i) {
            let t = (k.mid[(i, j)].hi - lambda[i] * m.mid[(i, j)].hi).abs();
            let gap = (lambda[i] - lambda[j]).abs();
            sum += if t < gap { t * t / gap } else { t };
        }
        worst = worst.max(if sum == 0.0 { 0.0 } else { sum / lambda[i].abs() });
    }
    worst
}

/// One Newton step. `estimates`, if given, are eigenvalues known better (relative to themselves) than the quotients of
/// X; disproportionately large couplings then wait for the next step.
pub fn newton_step(x: &Matrix<Triple>, k: &Gram, m: &Gram, estimates: Option<&[f64]>) -> Matrix<Triple> {
    let n = x.columns();
    let lambda = match estimates {
        Some(known) => known.iter().map(|&x| Dd::from(x)).collect(),
        None => quotients(k, m),
    };
    let step = |i: usize, j: usize| {
        let t = k.mid[(i, j)] - lambda[j] * m.mid[(i, j)];
        -t / (m.mid[(i, i)] * (lambda[i] - lambda[j]))
    };
    let groups = Groups::of(n, |i, j| {
        let gap = (lambda[i] - lambda[j]).hi.abs();
        let large = |i, j| step(i, j).hi.abs() > SMALL;
        let apart = estimates.is_some() && gap > 1e-6 * lambda[i].hi.abs().min(lambda[j].hi.abs());
        (gap == 0.0 || large(i, j) || large(j, i)) && !apart
    });
    let mut result = groups.rotate_groups(x, k, m);
    for j in 0..n {
        let mut change = vec![Dd::ZERO; x.rows()];
        for i in (0..n).filter(|&i| !groups.is_joined(i, j)) {
            let w = step(i, j);
            if !w.is_zero() && w.hi.abs() < 0.5 {
                for (change, x) in change.iter_mut().zip(x.column(i)) {
                    *change += w * x.dd();
                }
            }
        }
        for (entry, &change) in result.column_mut(j).iter_mut().zip(&change) {
            *entry = *entry + Triple::from(change);
        }
    }
    result
}

/// A step that changes X by no more than this is computed to all digits of double-double in binary64.
const TINY: f64 = 4.0 * f64::EPSILON;

/// X plus the change that one more step would make, for callers that need the digits of X itself; the eigenvalues,
/// whose errors are the squares of those of X, need no such step. It is cheap, because binary64 is enough for such
/// small couplings; larger ones belong to modes too close for the formula, and are left alone. Entries that are exactly
/// zero stay zero.
pub fn refine_shapes(x: &Matrix<Triple>, k: &Gram, m: &Gram) -> Matrix<Triple> {
    let (n, lambda) = (x.columns(), quotients(k, m));
    let light = x.map(|x| x.hi());
    let mut result = x.clone();
    for j in 0..n {
        let mut change = vec![0.0; x.rows()];
        for i in (0..n).filter(|&i| i != j) {
            let coupling = (k.mid[(i, j)] - lambda[j] * m.mid[(i, j)]).hi;
            let w = -coupling / (m.mid[(i, i)].hi * (lambda[i] - lambda[j]).hi);
            if w.abs() <= TINY {
                change.iter_mut().zip(light.column(i)).for_each(|(change, x)| *change += w * x);
            }
        }
        for (entry, &change) in result.column_mut(j).iter_mut().zip(&change).filter(|(entry, _)| entry.hi() != 0.0) {
            *entry = *entry + Triple::from(change);
        }
    }
    result
}

/// Groups of modes that are rotated among themselves.
struct Groups {
    members: Vec<Vec<usize>>,
    group: Vec<usize>,
}

impl Groups {
    fn of(n: usize, close: impl Fn(usize, usize) -> bool) -> Groups {
        let mut group: Vec<usize> = (0..n).collect();
        for j in 0..n {
            for i in 0..j {
                if group[i] != group[j] && close(i, j) {
                    let (keep, drop) = (group[i].min(group[j]), group[i].max(group[j]));
                    group.iter_mut().filter(|g| **g == drop).for_each(|g| *g = keep);
                }
            }
        }
        let members = (0..n).map(|g| (0..n).filter(|&i| group[i] == g).collect()).collect();
        Groups { members, group }
    }

    fn is_joined(&self, i: usize, j: usize) -> bool {
        self.group[i] == self.group[j]
    }

    /// X with each group's columns M-orthonormal and its block of K diagonal; single columns normalised.
    fn rotate_groups(&self, x: &Matrix<Triple>, k: &Gram, m: &Gram) -> Matrix<Triple> {
        let mut result = x.clone();
        for members in &self.members {
            match members.as_slice() {
                [] => {}
                [i] => {
                    let scale = Triple::from(m.mid[(*i, *i)].sqrt().recip());
                    result.column_mut(*i).iter_mut().for_each(|x| *x = *x * scale);
                }
                _ => turn(&mut result, x, k, m, members),
            }
        }
        result
    }
}

/// Replaces the members' columns by combinations that diagonalise their block of the pencil.
fn turn(result: &mut Matrix<Triple>, x: &Matrix<Triple>, k: &Gram, m: &Gram, members: &[usize]) {
    let size = members.len();
    let block = |gram: &Gram| Matrix::from_fn(size, size, |i, j| gram.mid[(members[i], members[j])]);
    let mut z = orthonormal(&block(m));
    let mut reduced = congruent(&block(k), &z);
    jacobi::diagonalise(&mut reduced, &mut z);
    for (j, &column) in members.iter().enumerate() {
        for row in 0..x.rows() {
            let terms = members.iter().enumerate().map(|(i, &from)| x[(row, from)] * Triple::from(z[(i, j)]));
            result[(row, column)] = terms.fold(Triple::ZERO, |sum, term| sum + term);
        }
    }
}

/// Columns that are orthonormal with respect to the positive definite `m`: Gram-Schmidt on the unit vectors, applied
/// twice.
fn orthonormal(m: &Matrix<Dd>) -> Matrix<Dd> {
    let n = m.columns();
    let mut z = Matrix::identity(n);
    for _ in 0..2 {
        for j in 0..n {
            for i in 0..j {
                let (done, column) = z.column_pair(i, j);
                let image = product(m, done);
                let factor = -dot(&image, column);
                add_scaled(column, factor, done);
            }
            let length = dot(&product(m, z.column(j)), z.column(j)).sqrt();
            z.column_mut(j).iter_mut().for_each(|x| *x = *x / length);
        }
    }
    z
}

fn product(m: &Matrix<Dd>, x: &[Dd]) -> Vec<Dd> {
    (0..m.columns()).map(|i| dot(m.column(i), x)).collect()
}

/// Z^T K Z
fn congruent(k: &Matrix<Dd>, z: &Matrix<Dd>) -> Matrix<Dd> {
    let images: Vec<Vec<Dd>> = (0..z.columns()).map(|j| product(k, z.column(j))).collect();
    Matrix::from_fn(z.columns(), z.columns(), |i, j| dot(z.column(i), &images[j]))
}
