//! Bounds of the eigenvalues of K x = lambda M x that hold, from any approximate eigenvectors.
//!
//! In: the stiffness and the inertia in the basis of the approximate modes, K^ = X^T K X and M^ = X^T M X, with error bounds
//! ([`Gram`]). Out: for each k an interval that contains the k-th eigenvalue.
//!
//! For a real s let T = K^ - s M^. Where X is regular, T has as many negative eigenvalues as there are lambda < s
//! (Sylvester). Take the modes near s as group C and the rest as R, and let g_j > 0 bound |T_jj| from below for j in R.
//! Scaled by g^-1/2 the rest is a diagonal of magnitude at least 1 plus an off-diagonal part of Frobenius norm q; for q < 1
//! it has the signs of its diagonal and an inverse of norm at most 1/(1-q). So the Schur complement of the group differs from
//! its own diagonal (lambda^_i - s) M^_ii, lambda^_i = K^_ii / M^_ii, by at most
//!
//!   e = max_i |K^_ii - lambda^_i M^_ii| + ||T_CC off the diagonal||_F + sum_(i in C, j in R) T_ij^2 / (g_j (1 - q)),
//!
//! and by Weyl's inequality the k-th eigenvalue lies within delta = e / min M^_ii of the k-th lambda^. The bound is
//! quadratic in the errors of the modes and counts: nothing is missed, nothing is found twice. That X is regular is shown on
//! the way: M^ has diagonal entries near 1 and, by the same scaling, q < 1 at an s beyond all of the spectrum or
//! simply ||M^ - diag||_F < min M^_ii. Clause: spec.md, "Certificates"; compare Parlett, The Symmetric Eigenvalue Problem
//! (1998), sections 10.5 and 11.

use super::gram::{Gram, SLACK};
use crate::base::{Ball, Dd};

/// The eigenvalues of a pencil, ascending, each as the column that approximates it and its enclosure.
#[derive(Clone, Debug)]
pub struct Enclosures {
    pub list: Vec<Enclosure>,
}

#[derive(Clone, Copy, Debug)]
pub struct Enclosure {
    /// Column of X.
    pub column: usize,
    /// The radius is infinite where nothing could be certified.
    pub lambda: Ball,
    /// First index of the group that was certified together.
    pub group: usize,
}

/// The pencil in the basis of its approximate modes.
struct Pencil<'a> {
    k: &'a Gram,
    m: &'a Gram,
    /// Columns ascending by lambda^.
    order: Vec<usize>,
    /// lambda^, ascending.
    lambda: Vec<Dd>,
    /// Bound of |K^_ii - lambda^_i M^_ii|.
    residual: Vec<f64>,
    /// Lower bound of M^_ii.
    mass: Vec<f64>,
}

/// Encloses every eigenvalue; see the module.
pub fn enclose(k: &Gram, m: &Gram) -> Enclosures {
    let pencil = Pencil::new(k, m);
    let n = pencil.lambda.len();
    let regular = k.is_finite() && m.is_finite() && pencil.basis_is_regular();
    let mut list = Vec::with_capacity(n);
    for (start, end) in pencil.groups() {
        let radius = if regular { pencil.radius(start, end) } else { f64::INFINITY };
        list.extend((start..end).map(|i| Enclosure {
            column: pencil.order[i],
            lambda: Ball::new(pencil.lambda[i], radius),
            group: start,
        }));
    }
    Enclosures { list }
}

impl<'a> Pencil<'a> {
    fn new(k: &'a Gram, m: &'a Gram) -> Pencil<'a> {
        let n = k.mid.columns();
        let quotient: Vec<Dd> = (0..n).map(|i| k.mid[(i, i)] / m.mid[(i, i)]).collect();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| quotient[a].partial_cmp(&quotient[b]).unwrap_or(std::cmp::Ordering::Equal));
        let lambda: Vec<Dd> = order.iter().map(|&i| quotient[i]).collect();
        let residual = order
            .iter()
            .map(|&i| {
                let division = k.mid[(i, i)].hi.abs() * Dd::EPSILON;
                SLACK * (k.radius(i, i) + quotient[i].hi.abs() * m.radius(i, i) + division)
            })
            .collect();
        let mass = order.iter().map(|&i| m.mid[(i, i)].hi * (2.0 - SLACK) - m.radius(i, i)).collect();
        Pencil { k, m, order, lambda, residual, mass }
    }

    /// M^ is positive definite, so X is regular: its off-diagonal norm is below its least diagonal entry.
    fn basis_is_regular(&self) -> bool {
        let n = self.lambda.len();
        let least = self.mass.iter().fold(f64::INFINITY, |a, &b| a.min(b));
        let mut sum = 0.0;
        for j in 0..n {
            for i in 0..j {
                let entry = self.m.magnitude(i, j);
                sum += 2.0 * entry * entry;
            }
        }
        least > 0.0 && sum.sqrt() * SLACK < least
    }

    /// Bound of |T_ij| at s = lambda^_i + h for all |h| <= span.
    fn coupling(&self, i: usize, j: usize, span: f64) -> f64 {
        let (a, b) = (self.order[i], self.order[j]);
        let (k, m, s) = (self.k.mid[(a, b)].hi, self.m.mid[(a, b)].hi, self.lambda[i].hi);
        let size = s.abs() + span;
        let rounding = 1e-15 * (k.abs() + (s * m).abs());
        let t = (k - s * m).abs() + rounding + span * m.abs();
        SLACK * (t + self.k.radius(a, b) + size * self.m.radius(a, b))
    }

    /// Neighbours that are closer than their coupling and their residuals go together.
    fn groups(&self) -> Vec<(usize, usize)> {
        let n = self.lambda.len();
        let mut last = Vec::with_capacity(n);
        for i in 0..n {
            let near = |j: &usize| {
                let gap = (self.lambda[*j] - self.lambda[i]).hi;
                gap <= 8.0 * (self.coupling(i, *j, 0.0) + self.residual[i] + self.residual[*j])
            };
            last.push((i + 1..n).rev().find(near).unwrap_or(i));
        }
        let (mut groups, mut start) = (Vec::with_capacity(n), 0);
        while start < n {
            let (mut end, mut i) = (last[start], start);
            while i < end {
                i += 1;
                end = end.max(last[i]);
            }
            groups.push((start, end + 1));
            start = end + 1;
        }
        groups
    }

    /// A radius that holds for all modes of the group start..end, infinite if none is found.
    fn radius(&self, start: usize, end: usize) -> f64 {
        let mut assumed = 0.0;
        for _ in 0..MAX_TRIALS {
            let found = self.radius_assuming(start, end, assumed);
            if found <= assumed || !found.is_finite() {
                return found;
            }
            // The dependence on the assumption is weak; doubling it leaves room.
            assumed = 2.0 * found;
        }
        f64::INFINITY
    }

    /// The delta of the module's text, valid if it comes out not above `assumed`: s runs over the group's lambda^, widened
    /// by `assumed`.
    fn radius_assuming(&self, start: usize, end: usize, assumed: f64) -> f64 {
        let n = self.lambda.len();
        let (low, high) = (self.lambda[start], self.lambda[end - 1]);
        let span = ((high - low).hi.abs() + assumed) * SLACK;
        let largest = (low.hi.abs().max(high.hi.abs()) + assumed) * SLACK;
        let mut inverse_root_gap = vec![0.0; n];
        for j in (0..start).chain(end..n) {
            let distance = if j < start { (low - self.lambda[j]).hi } else { (self.lambda[j] - high).hi };
            let gap = (distance * (2.0 - SLACK) - assumed) * self.mass[j] * (2.0 - SLACK) - self.residual[j];
            if gap.is_nan() || gap <= 0.0 {
                return f64::INFINITY;
            }
            inverse_root_gap[j] = (1.0 / gap).sqrt() * SLACK;
        }
        let q = self.rest_norm(start, end, largest, &inverse_root_gap);
        if q.is_nan() || q >= 0.5 {
            return f64::INFINITY;
        }
        let (mut inner, mut outer, mut residual, mut mass) = (0.0, 0.0, 0.0f64, f64::INFINITY);
        for i in start..end {
            residual = residual.max(self.residual[i]);
            mass = mass.min(self.mass[i]);
            for (j, scale) in inverse_root_gap.iter().enumerate() {
                let t = if i == j { 0.0 } else { self.coupling(i, j, span) };
                if (start..end).contains(&j) {
                    inner += t * t;
                } else {
                    outer += (t * scale).powi(2);
                }
            }
        }
        (residual + inner.sqrt() + outer / (1.0 - q)) / mass * SLACK
    }

    /// q of the module's text.
    fn rest_norm(&self, start: usize, end: usize, largest: f64, inverse_root_gap: &[f64]) -> f64 {
        let n = self.lambda.len();
        let mut sum = 0.0;
        for j in (0..start).chain(end..n) {
            for l in (0..start.min(j)).chain(end..j.max(end)) {
                let (a, b) = (self.order[l], self.order[j]);
                let t = self.k.magnitude(a, b) + largest * self.m.magnitude(a, b);
                sum += 2.0 * (t * inverse_root_gap[j] * inverse_root_gap[l]).powi(2);
            }
        }
        sum.sqrt() * SLACK
    }
}

/// The radius is found at the second trial unless the modes are poor.
const MAX_TRIALS: usize = 12;
