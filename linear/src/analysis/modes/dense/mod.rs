//! All modes of a part with dense matrices, for up to some thousand coordinates: eigenvectors of the assembled matrices
//! in binary64, then residuals of the terms in double-double, Newton steps and a certificate.
//!
//! The assembled matrices lose everything below the last bits of the largest eigenvalue; residuals of the terms keep
//! it. So the first vectors are as good as those of any dense solver, and the bounds say for each mode what the terms
//! determine.
//!
//! See docs/method/modes.md#dense-matrices.

pub(in crate::analysis) mod basis;
mod certificate;
mod residual;
mod step;
#[cfg(test)]
mod tests;

use crate::analysis::answer::Route;
use crate::analysis::modes::gram::SLACK;
use crate::analysis::modes::pair::{Displacements, Eigenvalue, Pair, ascending};
use crate::analysis::modes::structure;
use crate::analysis::modes::terms::Terms;
use crate::base::{Dd, OrderBy, Rational, larger};
use crate::kernel::dense::Matrix;
use crate::kernel::dense::inverse_factor::inverse_factor;
use crate::kernel::dense::product::{View, product};
use crate::kernel::symmetric;
use crate::kernel::triple::Triple;
use crate::system::Form;
use certificate::Reduced;
use residual::Pencil;

/// Bounds at which all digits of a binary64 number are certain. Newton steps are taken to reach it; other methods are
/// tried only to reach the tolerance.
const PRINTED: f64 = 1e-17;
/// The relative error of a difference of close frequencies that makes as many digits certain as are printed.
const SPLIT: f64 = 1e-16;
/// After a step has resolved a repeated eigenvalue, the relative radius of its members is below this: it is quadratic
/// in the vectors' errors of some 1e-15.
const REPEATED: f64 = 1e-22;
/// If neighbouring eigenvalues are closer than this relative distance, a vector must contain no more than [`MIXED`] of
/// its neighbour's vector.
const CLOSE: f64 = 1e-6;
const MIXED: f64 = 1e-10;
/// Each step extends the range of resolved stiffnesses by eight decades.
const MAX_STEPS: usize = 5;

/// The pencil of one part.
pub struct Problem<'a> {
    pub n: usize,
    pub form: &'a Form,
    pub stiffness: &'a Terms<'a>,
    pub masses: &'a Terms<'a>,
    pub tolerance: f64,
}

/// Vectors sorted by their quotients, with bounds of the quotients' distances from the eigenvalues.
struct Candidate {
    x: Matrix<f64>,
    pencil: Reduced,
    radii: Vec<f64>,
}

/// All eigenpairs, ascending, and whether their bounds meet the tolerance and separate distinct eigenvalues; `None` if
/// M is not positive definite in binary64, or numbers overflowed.
pub fn eigenpairs(problem: &Problem) -> Option<(Vec<Pair>, bool)> {
    let (x, diagonal) = problem.first()?;
    let pencil = Pencil::new(problem.stiffness, problem.masses, &diagonal);
    let mut best = Candidate::of(&pencil, x);
    let mut rigid = problem.rigid(best.may_be_zero().count());
    let mut worst = best.worst(rigid.dimension);
    for _ in 0..MAX_STEPS {
        if worst <= problem.tolerance.min(PRINTED) && !best.is_blurred(SPLIT) && !best.is_mixed() {
            break;
        }
        let Some(x) = step::newton_step(&best.x, &best.pencil) else { break };
        let next = Candidate::of(&pencil, x);
        if rigid.dimension < next.may_be_zero().count() {
            rigid = problem.rigid(next.may_be_zero().count());
        }
        let reached = next.worst(rigid.dimension);
        // Eigenvalues that cannot be separated yet have no bound; the step may still have brought them closer to
        // separation.
        let stuck = reached.is_finite() && reached > 0.25 * worst;
        let sharper = best.is_mixed() && !next.is_mixed() && reached <= 4.0 * worst;
        if reached <= worst || sharper {
            (best, worst) = (next, reached);
        }
        if stuck {
            break;
        }
    }
    let settled = worst <= problem.tolerance && !best.is_blurred(1.0);
    best.is_finite().then(|| (best.pairs(problem, &rigid), settled))
}

/// Motions for which K is zero: the dimension of their space, if it is known not to be larger, and its vectors.
struct Rigid {
    dimension: usize,
    vectors: Vec<Vec<f64>>,
}

impl Problem<'_> {
    /// M-normalised vectors from the assembled matrices, and M's diagonal.
    fn first(&self) -> Option<(Matrix<f64>, Vec<f64>)> {
        let n = self.n;
        let (mut k, mut m) = (assemble(self.stiffness, n), assemble(self.masses, n));
        let diagonal: Vec<f64> = (0..n).map(|i| m[(i, i)]).collect();
        if !diagonal.iter().all(|m| m.is_normal() && *m > 0.0) {
            return None;
        }
        let scale: Vec<f64> = diagonal.iter().map(|m| 1.0 / m.sqrt()).collect();
        let scaled = |a: &mut Matrix<f64>| {
            for j in 0..n {
                a.column_mut(j).iter_mut().zip(&scale).for_each(|(a, s)| *a *= s * scale[j]);
            }
        };
        scaled(&mut k);
        let mut x = match is_diagonal(&m) {
            true => symmetric::eigen(k)?.vectors,
            false => {
                scaled(&mut m);
                let inverse = inverse_factor(&m)?;
                let half = product(View::of(&inverse), View::of(&k));
                let whole = product(View::of(&half), View::of(&inverse).transpose());
                drop((k, m, half));
                let z = symmetric::eigen(whole)?.vectors;
                product(View::of(&inverse).transpose(), View::of(&z))
            }
        };
        for j in 0..n {
            x.column_mut(j).iter_mut().zip(&scale).for_each(|(x, s)| *x *= s);
        }
        Some((x, diagonal))
    }

    /// The exactly known part of the null space, if at most `count` eigenvalues may be zero.
    fn rigid(&self, count: usize) -> Rigid {
        let ones = vec![Rational::ONE; self.n];
        if count == 0 {
            return Rigid { dimension: 0, vectors: Vec::new() };
        }
        if count == 1 && structure::is_rigid(self.form, &ones) {
            return Rigid { dimension: 1, vectors: vec![vec![1.0; self.n]] };
        }
        let space = structure::null_space(self.form, self.n);
        let plain = |v: &Vec<Rational>| v.iter().map(|x| x.to_f64()).collect();
        Rigid { dimension: space.dimension, vectors: space.vectors.iter().map(plain).collect() }
    }
}

/// sum w a a^T in binary64.
fn assemble(terms: &Terms, n: usize) -> Matrix<f64> {
    let mut matrix = Matrix::fill_with(n, n, 0.0);
    for t in 0..terms.len() {
        let (indices, factors) = terms.row(t);
        for (&j, b) in indices.iter().zip(factors.iter()) {
            let weighted = terms.weight(t).value.hi() * b.to_f64();
            for (&i, a) in indices.iter().zip(factors.iter()) {
                matrix[(i.index(), j.index())] += weighted * a.to_f64();
            }
        }
    }
    matrix
}

fn is_diagonal(m: &Matrix<f64>) -> bool {
    (0..m.columns()).all(|j| m.column(j).iter().enumerate().all(|(i, &x)| i == j || x == 0.0))
}

impl Candidate {
    fn of(pencil: &Pencil, x: Matrix<f64>) -> Candidate {
        let residuals = pencil.residuals(&x);
        let mut order: Vec<usize> = (0..x.columns()).collect();
        order.order_by(|&a, &b| compare(residuals.theta[a], residuals.theta[b]));
        let (x, residuals) = (x.select_columns(&order), residuals.reorder(&order));
        let pencil = Reduced::of(&x, residuals);
        Candidate { radii: pencil.radii(), x, pencil }
    }

    fn is_finite(&self) -> bool {
        self.pencil.theta.iter().all(|theta| theta.is_finite())
    }

    /// Eigenvalues whose enclosures contain zero.
    fn may_be_zero(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.radii.len()).filter(|&i| self.holds_zero(i))
    }

    fn holds_zero(&self, i: usize) -> bool {
        self.pencil.theta[i].hi.abs() <= self.radii[i] * SLACK
    }

    /// The largest relative bound, not counting `zeros` eigenvalues that are zero.
    fn worst(&self, zeros: usize) -> f64 {
        let zeros = if self.may_be_zero().count() <= zeros { zeros } else { 0 };
        let separate = (0..self.radii.len()).filter(|&i| zeros == 0 || !self.holds_zero(i));
        separate
            .map(|i| self.radii[i] / self.pencil.theta[i].hi.abs())
            .fold(0.0, |worst, x| if x.is_nan() { f64::INFINITY } else { worst.max(x) })
    }

    /// Whether some neighbours within 1 %, whose difference is reported, have bounds above `part` of that difference.
    fn is_blurred(&self, part: f64) -> bool {
        let size = |i: usize| self.pencil.theta[i].hi.abs();
        (1..self.radii.len()).any(|i| {
            let radii = self.radii[i - 1] + self.radii[i];
            let gap = (self.pencil.theta[i] - self.pencil.theta[i - 1]).hi;
            let separate = gap <= 0.01 * size(i) && !(self.holds_zero(i - 1) && self.holds_zero(i));
            separate && radii > part * gap && radii > REPEATED * size(i)
        })
    }

    /// Whether vectors of close neighbours contain a noticeable part of each other; the eigenvalues depend only on its
    /// square.
    fn is_mixed(&self) -> bool {
        let theta = &self.pencil.theta;
        let gap = |i: usize, j: usize| (theta[j] - theta[i]).hi;
        (0..theta.len()).any(|i| {
            let close = (i + 1..theta.len()).take_while(|&j| gap(i, j) <= CLOSE * theta[j].hi.abs());
            close.map(|j| (gap(i, j), self.pencil.p[(i, j)])).any(|(gap, p)| p.abs() > MIXED * gap && gap > 0.0)
        })
    }

    /// As in [`eigen`](crate::analysis::modes::eigen): if no more eigenvalues may be zero than the null space has
    /// dimensions, all of those are zero; otherwise each lies in the union of their enclosures.
    fn pairs(&self, problem: &Problem, rigid: &Rigid) -> Vec<Pair> {
        let doubtful: Vec<usize> = self.may_be_zero().collect();
        let certain = doubtful.len() <= rigid.dimension;
        let known = certain && doubtful.len() == rigid.vectors.len();
        let positive =
            problem.stiffness.all_positive() && rigid.dimension == rigid.vectors.len() && rigid.dimension == 0;
        let size = |i: usize| self.pencil.theta[i].hi.abs();
        let union = doubtful.iter().map(|&i| (size(i) + self.radii[i]) * SLACK).fold(0.0, larger);
        let motions = if known { orthonormal(&rigid.vectors, problem.masses) } else { Vec::new() };
        let mut motions = motions.into_iter();
        let pair = |i: usize| {
            let zero = certain && self.holds_zero(i);
            let radius = if self.holds_zero(i) { (size(i) + union) * SLACK } else { self.radii[i] };
            let value = match zero {
                true => Eigenvalue::Zero,
                false => Eigenvalue::Near { value: Triple::from(self.pencil.theta[i]), radius, positive },
            };
            let exact = if zero { motions.next() } else { None };
            let x = Displacements::Plain(exact.unwrap_or_else(|| self.normalise(i)));
            Pair { value, x, route: if zero { Route::Exact } else { Route::Dense } }
        };
        let mut pairs: Vec<Pair> = (0..self.radii.len()).map(pair).collect();
        pairs.order_by(|a, b| ascending(&a.value, &b.value));
        pairs
    }

    fn normalise(&self, i: usize) -> Vec<f64> {
        let scale = 1.0 / (1.0 + self.pencil.e[(i, i)]).sqrt();
        self.x.column(i).iter().map(|x| x * scale).collect()
    }
}

fn compare(a: Dd, b: Dd) -> std::cmp::Ordering {
    (a - b).hi.partial_cmp(&0.0).unwrap_or(std::cmp::Ordering::Equal)
}

/// The vectors made M-orthonormal by Gram-Schmidt, applied twice.
fn orthonormal(vectors: &[Vec<f64>], masses: &Terms) -> Vec<Vec<f64>> {
    let product = |x: &[f64], y: &[f64]| -> f64 {
        let part = |t: usize| masses.weight(t).value.hi() * masses.stretch_f64(t, x) * masses.stretch_f64(t, y);
        (0..masses.len()).map(part).sum()
    };
    let mut done: Vec<Vec<f64>> = Vec::new();
    for vector in vectors {
        let mut vector = vector.clone();
        for _ in 0..2 {
            for other in &done {
                let along = product(other, &vector);
                vector.iter_mut().zip(other).for_each(|(x, y)| *x -= along * y);
            }
            let length = product(&vector, &vector).sqrt();
            vector.iter_mut().for_each(|x| *x /= length);
        }
        done.push(vector);
    }
    done
}
