//! Bounds of all eigenvalues of K x = lambda M x, for many approximate vectors at once, from their residuals.
//!
//! With P = X^T R, R = K X - M X Theta, and E = X^T M X - 1, the following holds exactly for any real s:
//!
//!   T(s) = X^T (K - s M) X = P + (1 + E)(Theta - s),
//!
//! and if |E| < 1, X is regular and M positive definite, T has as many negative eigenvalues as there are lambda < s
//! (Sylvester). P is as small as the residuals, so plain products of matrices give T with an error that is small
//! relative to them. Let C be a group of neighbours, J the rest, D_j a lower bound of |theta_j - s| on J, p_ij and e_ij
//! upper bounds of max(|P_ij|, |P_ji|) and max(|E_ij|, |E_ji|). T is symmetric, so entry (i, j) may be taken from
//! column i or j: from the one with the smaller |theta - s|. So T_JJ scaled by |theta - s|^-1/2 is a matrix of signs
//! plus one of norm at most
//!   q = |e|_F + sqrt(v^T S v),   S_ij = p_ij^2,  v_j = 1/D_j on J and zero on C,
//!
//! and for q < 1 it has the signs of its diagonal and an inverse of norm at most 1/(1 - q). For s within `span` of all theta_i
//! of the group, its Schur complement differs from diag(theta_i - s) by at most
//!
//!   max_(i in C) (p_ii + e_ii span) + |p_CC off the diagonal|_F + |e_CC|_F span + sum_(i in C, j in J) (p_ij + e_ij span)^2 v_j / (1 - q),
//!
//! so by Weyl's inequality the k-th lambda is within delta of the k-th theta if that is at most delta for
//! span = (the group's width) + delta. All sums over J for all groups are one product of matrices, S V.
//! See docs/method/modes.md#dense-matrices.

use crate::analysis::modes::dense::residual::Residuals;
use crate::analysis::modes::gram::SLACK;
use crate::base::Dd;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::product::{View, product};
use crate::kernel::symmetric::tridiagonal::dot;

/// The pencil in the basis of approximate modes, sorted by eigenvalue.
pub struct Reduced {
    pub theta: Vec<Dd>,
    pub p: Matrix<f64>,
    pub e: Matrix<f64>,
    size: Vec<f64>,
    p_slip: Vec<f64>,
    e_slip: Vec<f64>,
}

/// Neighbours from `start` to `end` (exclusive).
#[derive(Clone, Copy)]
struct Group {
    start: usize,
    end: usize,
}

/// (a + b)^2 <= PART a^2 + REST b^2, PART - 1 = 1 / (REST - 1).
const PART: f64 = 1.001;
const REST: f64 = 1001.0;

impl Reduced {
    /// Sorts the columns of X by theta; `residuals` belong to them.
    pub fn of(x: &Matrix<f64>, residuals: Residuals) -> Reduced {
        let transposed = View::of(x).transpose();
        let p = product(transposed, View::of(&residuals.r));
        let mut e = product(transposed, View::of(&residuals.y));
        (0..x.columns()).for_each(|j| e[(j, j)] -= 1.0);
        let Residuals { theta, size, r_slip, y_slip, .. } = residuals;
        Reduced { theta, p, e, size, p_slip: r_slip, e_slip: y_slip }
    }

    /// For each theta a bound of its distance to the eigenvalue of the same number; infinite if nothing could be
    /// certified.
    pub fn radii(&self) -> Vec<f64> {
        let n = self.theta.len();
        let mut radii = vec![f64::INFINITY; n];
        let largest = self.theta.iter().fold(0.0, |m: f64, theta| m.max(theta.hi.abs()));
        let unit = f64::from_bits(largest.to_bits() & f64::INFINITY.to_bits());
        if !unit.is_normal() || !self.is_finite() {
            return radii;
        }
        // In this unit squares stay within range.
        let p = self.bounds(&self.p, &self.p_slip, 1.0 / unit);
        let e = self.bounds(&self.e, &self.e_slip, 1.0);
        let angle = dot(e.data(), e.data()).sqrt() * SLACK;
        if angle >= 0.25 {
            return radii;
        }
        let groups = self.groups(&p, unit);
        let rest = Rest::of(&groups, self, &p, unit);
        let worst = e.data().iter().fold(0.0, |m: f64, e| m.max(*e));
        for (g, group) in groups.iter().enumerate() {
            let radius = rest.radius(g, group, &p, &e, angle, worst) * unit;
            radii[group.start..group.end].fill(radius * SLACK);
        }
        radii
    }

    fn is_finite(&self) -> bool {
        let mut numbers = [self.p.data(), self.e.data(), &self.size, &self.p_slip, &self.e_slip].into_iter().flatten();
        self.theta.iter().all(|theta| theta.is_finite()) && numbers.all(|x| x.is_finite())
    }

    /// Upper bounds of max(|entry (i, j)|, |entry (j, i)|) in units of 1 / `factor`.
    fn bounds(&self, matrix: &Matrix<f64>, slip: &[f64], factor: f64) -> Matrix<f64> {
        let n = self.theta.len();
        let mut bounds = Matrix::fill_with(n, n, 0.0);
        for j in 0..n {
            let column = matrix.column(j);
            for i in 0..n {
                bounds[(i, j)] = SLACK * factor * (column[i].abs() + self.size[i] * slip[j]);
            }
        }
        for j in 0..n {
            for i in 0..j {
                let larger = bounds[(i, j)].max(bounds[(j, i)]);
                (bounds[(i, j)], bounds[(j, i)]) = (larger, larger);
            }
        }
        bounds
    }

    /// theta_j - theta_i in units of `unit`.
    fn distance(&self, i: usize, j: usize, unit: f64) -> f64 {
        (self.theta[j] - self.theta[i]).hi / unit
    }

    /// Neighbours whose distance is comparable to their couplings form a group.
    fn groups(&self, p: &Matrix<f64>, unit: f64) -> Vec<Group> {
        let n = self.theta.len();
        let near = |i: usize, j: usize| self.distance(i, j, unit) <= 8.0 * (p[(j, i)] + p[(i, i)] + p[(j, j)]);
        let (mut groups, mut start) = (Vec::with_capacity(n), 0);
        while start < n {
            let (mut end, mut i) = (start, start);
            while i <= end {
                let last = (end.max(i) + 1..n).rev().find(|&j| near(i, j));
                (end, i) = (last.unwrap_or(end), i + 1);
            }
            groups.push(Group { start, end: end + 1 });
            start = end + 1;
        }
        groups
    }
}

/// For each group, sums over the modes outside it.
struct Rest {
    /// Width of each group.
    width: Vec<f64>,
    /// The assumed distance of s beyond the group.
    assumed: Vec<f64>,
    /// v^T S v
    within: Vec<f64>,
    /// sum_(i in C) (S v)_i
    across: Vec<f64>,
    /// sum v
    whole: Vec<f64>,
}

impl Rest {
    fn of(groups: &[Group], reduced: &Reduced, p: &Matrix<f64>, unit: f64) -> Rest {
        let (n, count) = (reduced.theta.len(), groups.len());
        let (mut v, mut width, mut assumed) = (Matrix::fill_with(n, count, 0.0), Vec::new(), Vec::new());
        for (g, &Group { start, end }) in groups.iter().enumerate() {
            let distance = |j: usize| match j < start {
                true => reduced.distance(j, start, unit),
                false => reduced.distance(end - 1, j, unit),
            } * (2.0 - SLACK);
            let nearest = [start.checked_sub(1), (end < n).then_some(end)].into_iter().flatten().map(distance);
            // A quarter of the gap; if there is no neighbour, as far as can matter.
            let reach = 0.25 * nearest.fold(8.0, f64::min);
            for j in (0..start).chain(end..n) {
                v[(j, g)] = SLACK / (distance(j) - reach);
            }
            width.push(reduced.distance(start, end - 1, unit).abs() * SLACK);
            assumed.push(reach);
        }
        let squares = p.map(|p| p * p);
        let sums = product(View::of(&squares), View::of(&v));
        let column = |g: usize| sums.column(g);
        Rest {
            within: (0..count).map(|g| dot(column(g), v.column(g)) * SLACK).collect(),
            across: (0..count).map(|g| column(g)[groups[g].start..groups[g].end].iter().sum::<f64>() * SLACK).collect(),
            whole: (0..count).map(|g| v.column(g).iter().sum::<f64>() * SLACK).collect(),
            width,
            assumed,
        }
    }

    /// The delta of the module's text.
    fn radius(&self, g: usize, group: &Group, p: &Matrix<f64>, e: &Matrix<f64>, angle: f64, worst: f64) -> f64 {
        let q = angle + self.within[g].sqrt() * SLACK;
        if q.is_nan() || q >= 0.5 {
            return f64::INFINITY;
        }
        let members = group.start..group.end;
        let (mut diagonal, mut coupling, mut angles) = ((0.0f64, 0.0f64), 0.0, 0.0);
        for j in members.clone() {
            diagonal = (diagonal.0.max(p[(j, j)]), diagonal.1.max(e[(j, j)]));
            for i in members.clone().filter(|&i| i != j) {
                coupling += p[(i, j)] * p[(i, j)];
                angles += e[(i, j)] * e[(i, j)];
            }
        }
        let fixed = diagonal.0 + coupling.sqrt() + PART * self.across[g] / (1.0 - q);
        let slope = diagonal.1 + angles.sqrt();
        let curve = REST * worst * worst * self.whole[g] * members.len() as f64 / (1.0 - q);
        let bound = |delta: f64| {
            let span = (self.width[g] + delta) * SLACK;
            (fixed + span * (slope + span * curve)) * SLACK
        };
        let mut delta = self.assumed[g];
        // The bound grows with delta, so each step from a valid delta leads to a smaller valid one.
        for _ in 0..4 {
            let next = bound(delta);
            if next.is_nan() || next > delta {
                return if delta == self.assumed[g] { f64::INFINITY } else { delta };
            }
            delta = next;
        }
        delta
    }
}

#[cfg(test)]
mod extremes;
