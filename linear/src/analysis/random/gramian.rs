//! The covariance of the state under white noise, by Lyapunov's equation with a certificate. In: a system with all its modes,
//! channels of noise. Out: covariances with a bound, and so mean squares. See docs/method/random.md#certificate.
//!
//! The state is z = (S eta, v) in modal coordinates q = X eta + .., v = eta' - h w: E z' = A z + b w, where E and A are
//! known up to the small entries that double-double leaves uncertain. For any symmetric P, R = A P E^T + E P A^T + B
//! B^T is the residual. If a certificate G has A G E^T + E G A^T = -Y, Y > 0, G > 0, then A is stable, and -e Y <= R <=
//! e Y bounds the error of P by e G.

use super::channel::Channel;
use crate::analysis::answer::{ModeKind, Modes};
use crate::analysis::forms::dense;
use crate::analysis::modes::form::{ModalForm, gram, off_diagonal};
use crate::analysis::poles::companion::StateForm;
use crate::analysis::poles::schur::SchurForm;
use crate::base::{Ball, Dd, Number, larger, rounding::UNIT, up};
use crate::kernel::dense::Matrix;
use crate::kernel::dense::enclosure::Panel;
use crate::kernel::simd::simd;
use crate::kernel::squares::Squares;
use crate::system::{Form, LinearSystem, Output};
use nalgebra::DMatrix;

const UP: f64 = up::THOUSANDS;
/// With more coordinates, the Schur form takes too long.
pub const MOST: usize = 150;
/// Limit on the refinements of a solution.
const STEPS: usize = 5;
/// The residual, relative to the certificate's right-hand side and to the solution, at which refinement ends.
const SETTLED: f64 = 1e-24;

/// The reason why variances cannot be computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    Empty,
    Large,
    /// A motion has no inertia, or some modes are not known.
    Modes,
    /// A motion is held by no spring, or its kind is not certain.
    Rigid,
    /// Nothing proves that every motion decays.
    NotStable,
}

/// The system in modal coordinates, with the data that prove variances.
pub struct Space {
    pub(super) n: usize,
    shapes: Matrix<Dd>,
    /// Powers near omega_i, exact.
    pub(super) s: Vec<f64>,
    pub(super) k: Vec<Ball>,
    /// k_i / s_i
    a: Vec<Ball>,
    pub(super) c: Matrix<Ball>,
    /// The same for products.
    panel: Panel,
    /// Bounds of the entries of X^T M X - 1 and, divided by s_i s_j, of X^T K X - diag k.
    pub(super) of_m: f64,
    pub(super) of_k: f64,
    /// Whether no damper has a negative coefficient; then no motion grows.
    pub(super) is_passive: bool,
    /// A proof that every motion decays.
    certificate: Option<Certificate>,
}

/// G with A G E^T + E G A^T = -Y, Y near the diagonal D.
struct Certificate {
    schur: SchurForm,
    g: Matrix<f64>,
    /// Bounds of D^-1/2.
    scale: Vec<f64>,
    /// How far below D its Y may be, relative to it.
    theta: f64,
}

/// One white noise: S h and f in modal coordinates, and its intensity.
pub struct Drive {
    pub(super) jump: Vec<Ball>,
    pub(super) force: Vec<Ball>,
    intensity: Ball,
}

/// A covariance P with |P - true| <= epsilon G.
pub struct Covariance {
    p: Matrix<Ball>,
    epsilon: f64,
}

impl Space {
    /// `known`: a Schur form that may be that of the system's state matrix.
    pub fn of(system: &LinearSystem, modes: &Modes, known: Option<&StateForm>) -> Result<Space, Obstacle> {
        let n = system.n();
        if n == 0 {
            return Err(Obstacle::Empty);
        }
        if n > MOST {
            return Err(Obstacle::Large);
        }
        if modes.list.len() == n && modes.list.iter().any(|mode| mode.kind != ModeKind::Oscillation) {
            return Err(Obstacle::Rigid);
        }
        let form = ModalForm::of(system, modes, gram).ok_or(Obstacle::Modes)?;
        let mids = form.stiffnesses();
        if mids.iter().any(|k| !(k.hi > 0.0 && k.hi.is_finite())) {
            return Err(Obstacle::Rigid);
        }
        let s: Vec<f64> = mids.iter().map(|k| k.hi.sqrt()).collect();
        let squares: Vec<f64> = s.iter().map(|s| s * s).collect();
        // Only the radius of the diagonal of X^T K X, because the midpoints are k.
        let of_k = off_diagonal(&form.k, &squares, false) * UP;
        let of_m = off_diagonal(&form.m, &vec![1.0; n], true) * UP;
        let is_small = n as f64 * (of_m + of_k) < 1e-6;
        if !is_small {
            return Err(Obstacle::Modes);
        }
        let c = gram(&Squares::of_form(&system.c), &form.shapes);
        let k: Vec<Ball> = mids.into_iter().map(Ball::exact).collect();
        let a: Vec<Ball> = k.iter().zip(&s).map(|(k, s)| *k / Ball::from(*s)).collect();
        let entry = |i: usize, j: usize| match (i < n, j < n) {
            (true, true) => 0.0,
            (true, false) => {
                if i + n == j {
                    s[i]
                } else {
                    0.0
                }
            }
            (false, true) => {
                if i == j + n {
                    -a[j].to_f64()
                } else {
                    0.0
                }
            }
            (false, false) => -c[(i - n, j - n)].to_f64(),
        };
        let start = DMatrix::from_fn(2 * n, 2 * n, entry);
        let is_passive = system.c.terms().all(|term| term.weight.is_positive());
        let (panel, certificate) = (Panel::of(&c), None);
        let mut space = Space { n, shapes: form.shapes, s, k, a, c, panel, of_m, of_k, is_passive, certificate };
        space.certificate = space.certify(start, known);
        Ok(space)
    }

    /// Whether every motion is proved to decay.
    pub fn decays(&self) -> bool {
        self.certificate.is_some()
    }

    /// Finds G and proves that it is a certificate. `start`: A in binary64.
    fn certify(&self, start: DMatrix<f64>, known: Option<&StateForm>) -> Option<Certificate> {
        let (n, size) = (self.n, 2 * self.n);
        let most = (0..n).map(|i| self.c[(i, i)].to_f64()).fold(0.0, f64::max);
        if most <= 0.0 {
            return None;
        }
        let schur = match known.and_then(|known| known.of(&start)) {
            Some(form) => form.clone(),
            None => SchurForm::of(start)?,
        };
        let damping = |i: usize| self.c[(i % n, i % n)].to_f64().max(1e-12 * most);
        let d: Vec<f64> = (0..size).map(damping).collect();
        let scale: Vec<f64> = d.iter().map(|d| up::FEW / d.sqrt()).collect();
        let mut g = symmetric(&schur.lyapunov(&Matrix::from_fn(size, size, |i, j| if i == j { -d[i] } else { 0.0 })));
        let mut error = self.image(&g);
        (0..size).for_each(|i| error[(i, i)] = error[(i, i)] + Ball::from(d[i]));
        let distance = |error: &Matrix<Ball>| scaled_norm(&scale, |i, j| error[(i, j)].magnitude());
        let mut theta = distance(&error);
        if theta.is_nan() || theta >= 0.5 {
            // The rounded sum is another matrix, but a close one.
            let step = symmetric(&schur.lyapunov(&error.map(|x| -x.to_f64())));
            g = Matrix::from_fn(size, size, |i, j| g[(i, j)] + step[(i, j)]);
            error = self.image(&g);
            (0..size).for_each(|i| error[(i, i)] = error[(i, i)] + Ball::from(d[i]));
            theta = distance(&error);
        }
        (theta < 0.5 && is_positive_definite(&g)).then_some(Certificate { schur, g, scale, theta })
    }

    /// A P E^T + E P A^T for a symmetric P, including everything by which E and A may be off.
    fn image(&self, p: &Matrix<f64>) -> Matrix<Ball> {
        let n = self.n;
        // C W^T, and beside it C V.
        let columns = Matrix::from_fn(n, 2 * n, |k, j| if j < n { p[(j, n + k)] } else { p[(n + k, j)] });
        let products = self.panel.times(&columns);
        let off = self.uncertainty(p, &products);
        let mut image = Matrix::none(2 * n, 2 * n);
        combine(self, p, &products, &off, &mut image);
        image
    }

    /// The sum of q b b^T.
    fn driven(&self, drives: &[Drive]) -> Matrix<Ball> {
        let size = 2 * self.n;
        let mut sum = Matrix::none(size, size);
        for Drive { jump, force, intensity } in drives {
            let b: Vec<Ball> = jump.iter().chain(force).copied().collect();
            for j in (0..size).filter(|&j| !b[j].is_zero()) {
                let factor = b[j] * *intensity;
                for (sum, b) in sum.column_mut(j)[..=j].iter_mut().zip(&b) {
                    *sum = *sum + *b * factor;
                }
            }
        }
        mirror(&mut sum);
        sum
    }

    /// Bounds of what the errors of X^T M X - 1 and X^T K X - diag k may add to the blocks of the image beside and below the
    /// first one.
    fn uncertainty(&self, p: &Matrix<f64>, products: &Matrix<Ball>) -> [Matrix<f64>; 2] {
        /// Products of two of the small entries are far smaller than this share of the sums.
        const MORE: f64 = 1.01;
        let n = self.n;
        let of_row = |i: usize, from: usize| (from..from + n).map(|j| p[(i, j)].abs()).sum::<f64>();
        let sums = |row: usize, from: usize| (0..n).map(|i| of_row(row + i, from)).collect::<Vec<f64>>();
        let (of_z, of_w, down_w, of_v) = (sums(0, 0), sums(0, n), sums(n, 0), sums(n, n));
        let of_cv: Vec<f64> = (0..n).map(|i| (n..2 * n).map(|j| products[(i, j)].magnitude()).sum()).collect();
        let mixed = |i: usize, j: usize| self.of_m * self.s[i] * of_v[i] + self.of_k * self.s[j] * of_z[i];
        let own: Vec<f64> = (0..n).map(|i| self.of_m * (self.a[i].magnitude() * of_w[i] + of_cv[i])).collect();
        let one = |i: usize, j: usize| self.of_k * self.s[i] * down_w[j] + own[i];
        [
            Matrix::from_fn(n, n, |i, j| MORE * mixed(i, j) * UP),
            Matrix::from_fn(n, n, |i, j| MORE * (one(i, j) + one(j, i)) * UP),
        ]
    }

    /// The drive of a channel.
    pub fn drive(&self, channel: &Channel, intensity: Ball) -> Drive {
        // (X^T M X)^-1 y = y + F y, |F_ij| at most this.
        let off = self.inverse_off();
        let jump = self.in_modes(&channel.jump);
        let slack = off * jump.iter().map(|x| x.magnitude()).sum::<f64>() * UP;
        let scaled = jump.iter().zip(&self.s).map(|(x, s)| {
            let x = if slack > 0.0 { x.widen(slack) } else { *x };
            x * Ball::from(*s)
        });
        Drive { jump: scaled.collect(), force: self.in_modes(&channel.force), intensity }
    }

    fn inverse_off(&self) -> f64 {
        self.of_m / (1.0 - self.n as f64 * self.of_m) * UP
    }

    /// X^T A X
    pub(super) fn in_all_modes(&self, form: &Form) -> Matrix<Ball> {
        gram(&Squares::of_form(form), &self.shapes)
    }

    /// The accelerations in an output due to forces on the modes.
    pub(super) fn acceleration(&self, output: &Output, forces: &[Ball]) -> Ball {
        if output.p[2].is_empty() {
            return Ball::ZERO;
        }
        let row = self.in_modes(&dense(self.n, &output.p[2]));
        let size = |list: &[Ball]| list.iter().map(Ball::magnitude).sum::<f64>();
        let slack = self.inverse_off() * size(&row) * size(forces) * UP;
        row.iter().zip(forces).fold(Ball::ZERO, |sum, (p, force)| sum + *p * *force).widen(slack)
    }

    /// x_i . a for each mode
    pub(super) fn in_modes(&self, a: &[Number]) -> Vec<Ball> {
        let nonzero: Vec<(usize, Ball)> =
            a.iter().enumerate().filter(|(_, a)| !a.is_zero()).map(|(i, a)| (i, a.to_ball())).collect();
        let of = |mode: usize| {
            let column = self.shapes.column(mode);
            nonzero.iter().fold(Ball::ZERO, |sum, (i, a)| sum + *a * Ball::exact(column[*i]))
        };
        (0..self.n).map(of).collect()
    }

    /// The covariance under independent white noises; `None` if it is not proved that one exists.
    pub fn covariance(&self, drives: &[Drive]) -> Option<Covariance> {
        let Certificate { schur, scale, theta, .. } = self.certificate.as_ref()?;
        let size = 2 * self.n;
        let mut p = Matrix::none(size, size);
        let mut left = self.driven(drives);
        let rest = |left: &Matrix<Ball>| scaled_norm(scale, |i, j| left[(i, j)].magnitude());
        let mut best = rest(&left);
        for _ in 0..STEPS {
            let step = symmetric(&schur.lyapunov(&left.map(|x| -x.to_f64())));
            // The residual of a sum is the residual of its first part plus the image of the second.
            let after = sum(&left, &self.image(&step));
            let now = rest(&after);
            let is_better = now < best;
            if !is_better {
                break;
            }
            let is_slow = now > 0.25 * best;
            p = sum(&p, &step.map(Ball::from));
            (left, best) = (after, now);
            let large = (0..size).map(|i| p[(i, i)].mid.hi).fold(0.0, f64::max);
            if is_slow || best <= SETTLED * large {
                break;
            }
        }
        Some(Covariance { p, epsilon: best / (1.0 - theta) * UP })
    }

    /// The row of an output over the state: y = row z.
    pub fn row(&self, output: &Output) -> Vec<Ball> {
        let n = self.n;
        let in_modes = |power: usize| self.in_modes(&dense(n, &output.p[power]));
        let (p0, p1) = (in_modes(0), in_modes(1));
        if output.p[2].is_empty() {
            return (0..n).map(|i| p0[i] / Ball::from(self.s[i])).chain(p1).collect();
        }
        // The acceleration is (X^T M X)^-1 (-X^T K X eta - X^T C X v + f w).
        let p2 = in_modes(2);
        let sum = p2.iter().map(|x| x.magnitude()).sum::<f64>() * UP;
        let stiffest = self.s.iter().copied().fold(0.0, larger);
        let off = self.inverse_off();
        let by_place = (0..n).map(|i| {
            let slack = sum * (off * self.k[i].magnitude() + 1.01 * self.of_k * self.s[i] * stiffest);
            ((p0[i] - p2[i] * self.k[i]) / Ball::from(self.s[i])).widen(slack / self.s[i] * UP)
        });
        let by_rate = (0..n).map(|i| {
            let column = || (0..n).map(move |j| self.c[(j, i)]);
            let damped = column().zip(&p2).fold(Ball::ZERO, |sum, (c, p)| sum + c * *p);
            let size = column().map(|c| c.magnitude()).sum::<f64>();
            (p1[i] - damped).widen(sum * off * size * UP)
        });
        by_place.collect::<Vec<_>>().into_iter().chain(by_rate.collect::<Vec<_>>()).collect()
    }

    /// The variance of an output.
    pub fn variance(&self, covariance: &Covariance, row: &[Ball]) -> Ball {
        let seen: Vec<usize> = (0..2 * self.n).filter(|&i| !row[i].is_zero()).collect();
        let bound = self.certified_bound(&seen, row) * covariance.epsilon * UP;
        let value = quadratic(&covariance.p, row, &seen).widen(bound);
        // A variance is not negative.
        if value.mid.hi < 0.0 { Ball::new(Dd::ZERO, value.magnitude()) } else { value }
    }

    /// A bound of row G row^T.
    fn certified_bound(&self, seen: &[usize], row: &[Ball]) -> f64 {
        let size: Vec<f64> = seen.iter().map(|&i| row[i].magnitude()).collect();
        let Some(Certificate { g, .. }) = &self.certificate else { return f64::INFINITY };
        let column = |(j, size_j): (&usize, &f64)| {
            let sum: f64 = seen.iter().zip(&size).map(|(&i, size_i)| size_i * g[(i, *j)].abs()).sum();
            sum * size_j
        };
        seen.iter().zip(&size).map(column).sum::<f64>() * UP
    }

    /// The contribution of each mode to the variance: cov(part of the mode, whole).
    pub fn contributions(&self, covariance: &Covariance, row: &[Ball]) -> Vec<f64> {
        let n = self.n;
        let row: Vec<f64> = row.iter().map(Ball::to_f64).collect();
        let of = |j: usize| {
            let column = covariance.p.column(j).iter().zip(&row);
            row[j] * column.map(|(p, factor)| p.to_f64() * factor).sum::<f64>()
        };
        (0..n).map(|i| of(i) + of(n + i)).collect()
    }
}

simd! {
    /// Combines the blocks of an image: those of P, of C W^T and C V, and the uncertain part.
    fn combine(
        space: &Space,
        p: &Matrix<f64>,
        products: &Matrix<Ball>,
        off: &[Matrix<f64>; 2],
        image: &mut Matrix<Ball>,
    ) {
        let n = space.n;
        let s = |i: usize| Ball::from(space.s[i]);
        let at = |i: usize, j: usize| Ball::from(p[(i, j)]);
        let [mixed, lower] = off;
        for j in 0..n {
            for i in 0..=j {
                image[(i, j)] = s(i) * at(j, n + i) + s(j) * at(i, n + j);
                let one = |i: usize, j: usize| space.a[i] * at(i, n + j) + products[(i, n + j)];
                image[(n + i, n + j)] = (-(one(i, j) + one(j, i))).widen(lower[(i, j)]);
            }
            for i in 0..n {
                let sum = s(i) * at(n + i, n + j) - at(i, j) * space.a[j] - products[(j, i)];
                image[(i, n + j)] = sum.widen(mixed[(i, j)]);
            }
        }
        mirror(image);
    }
}

/// Copies the upper triangle to the lower one.
fn mirror(x: &mut Matrix<Ball>) {
    for j in 0..x.columns() {
        for i in 0..j {
            x[(j, i)] = x[(i, j)];
        }
    }
}

simd! {
    /// row P row^T for a symmetric P; `seen`: where the row is not zero.
    fn quadratic(p: &Matrix<Ball>, row: &[Ball], seen: &[usize]) -> Ball {
        let (mut sum, two) = (Ball::ZERO, Ball::from(2.0));
        for (at, &j) in seen.iter().enumerate() {
            let before = seen[..at].iter().fold(Ball::ZERO, |sum, &i| sum + row[i] * p[(i, j)]);
            sum = sum + (before * two + row[j] * p[(j, j)]) * row[j];
        }
        sum
    }
}

simd! {
    fn sum(a: &Matrix<Ball>, b: &Matrix<Ball>) -> Matrix<Ball> {
        Matrix::from_fn(a.rows(), a.columns(), |i, j| a[(i, j)] + b[(i, j)])
    }
}

/// A bound of the 2-norm of D^-1/2 R D^-1/2 for a symmetric R, by bounds of D^-1/2 and of the magnitudes of R: the largest sum of a
/// column.
fn scaled_norm(scale: &[f64], magnitude: impl Fn(usize, usize) -> f64) -> f64 {
    let column = |j: usize| {
        let sum = scale.iter().enumerate().map(|(i, scale)| magnitude(i, j) * scale).sum::<f64>();
        sum * scale[j] * UP
    };
    (0..scale.len()).map(column).fold(0.0, larger)
}

fn symmetric(x: &Matrix<f64>) -> Matrix<f64> {
    Matrix::from_fn(x.rows(), x.columns(), |i, j| 0.5 * (x[(i, j)] + x[(j, i)]))
}

/// Whether a symmetric matrix, exact in binary64, is certainly positive definite: Cholesky's factorisation of the matrix, scaled
/// to a diagonal near one and less what rounding may do, goes through (Rump, BIT 46 (2006) 433).
fn is_positive_definite(a: &Matrix<f64>) -> bool {
    let n = a.rows();
    let scale: Vec<f64> = (0..n).map(|i| power_of_two(a[(i, i)])).collect();
    if (0..n).any(|i| !(a[(i, i)] > 0.0 && scale[i].is_finite() && scale[i] > 0.0)) {
        return false;
    }
    // The trace of the scaled matrix is at most 4 n.
    let less = 8.0 * n as f64 * (n as f64 + 4.0) * UNIT;
    let mut l = Matrix::from_fn(n, n, |i, j| a[(i, j)] * scale[i] * scale[j] - if i == j { less } else { 0.0 });
    for j in 0..n {
        let root = l[(j, j)].sqrt();
        // This rejects NaN, too.
        if !(root > 0.0 && root.is_finite()) {
            return false;
        }
        l.column_mut(j)[j..].iter_mut().for_each(|x| *x /= root);
        for k in j + 1..n {
            let (factor, column) = (l[(k, j)], l.column(j)[k..].to_vec());
            l.column_mut(k)[k..].iter_mut().zip(column).for_each(|(x, y)| *x -= factor * y);
        }
    }
    true
}

/// A power of two near 1 / sqrt(x).
fn power_of_two(x: f64) -> f64 {
    let exponent = (-0.5 * libm::log2(x)).round();
    if exponent.abs() < 300.0 { libm::exp2(exponent) } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn definite_matrices_are_told_from_others() {
        let good = Matrix::from_fn(3, 3, |i, j| if i == j { 1e6 } else { 4.9e5 });
        let bad = Matrix::from_fn(3, 3, |i, j| if i == j { 1e6 } else { -5.1e5 });
        assert!(is_positive_definite(&good));
        assert!(!is_positive_definite(&bad));
        // On the edge, where rounding would decide.
        assert!(!is_positive_definite(&Matrix::fill_with(2, 2, 3.0)));
    }
}
