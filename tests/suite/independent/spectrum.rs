//! Modes and poles compared with the second formulation's matrices: eigenvalues by Jacobi rotations, poles by Newton
//! steps on det Q(s).

use super::encloses;
use super::extended::{Matrix, eigenvalues};
use super::formulation::Linearised;
use crate::ask::Answer;
use vibc::analysis::{ModeKind, PoleKind};
use vibc::base::number::Dd;

/// Asserts that the reported balls of omega^2 contain the eigenvalues of (K, M) of the second formulation.
///
/// Their accuracy relative to the largest one is the tolerance of the matrices: K's error over M's smallest eigenvalue,
/// the worst case of a Rayleigh quotient.
pub fn assert_modes(answer: &Answer, second: &Linearised, tolerance: f64, text: &str) {
    let truth = eigenvalues(&second.k, &second.m).expect("a positive definite mass matrix");
    let list = &answer.modes.list;
    assert_eq!(list.len(), truth.len(), "as many modes as coordinates in\n{text}");
    let error = tolerance * truth.iter().map(|x| x.abs().to_f64()).fold(0.0, f64::max);
    for (mode, truth) in list.iter().zip(&truth) {
        let found = &mode.omega_squared;
        assert!(found.rad.is_finite(), "certified: {mode:?} in\n{text}");
        assert!(encloses(found, *truth, error), "omega^2 {found:?}, by the second road {truth:?} in\n{text}");
        let kind = match mode.kind {
            ModeKind::Oscillation => truth.to_f64() > -error,
            ModeKind::Rigid | ModeKind::Undetermined => truth.to_f64().abs() <= error,
            ModeKind::Divergence => truth.to_f64() < error,
        };
        assert!(kind, "{:?} with {truth:?} in\n{text}", mode.kind);
    }
}

#[derive(Clone, Copy, Debug)]
struct Complex {
    re: Dd,
    im: Dd,
}

impl Complex {
    const ZERO: Complex = Complex { re: Dd::ZERO, im: Dd::ZERO };
    const ONE: Complex = Complex { re: Dd::ONE, im: Dd::ZERO };

    fn minus(self, o: Complex) -> Complex {
        Complex { re: self.re - o.re, im: self.im - o.im }
    }

    fn plus(self, o: Complex) -> Complex {
        Complex { re: self.re + o.re, im: self.im + o.im }
    }

    fn times(self, o: Complex) -> Complex {
        Complex { re: self.re * o.re - self.im * o.im, im: self.re * o.im + self.im * o.re }
    }

    fn over(self, o: Complex) -> Complex {
        let norm = o.re * o.re + o.im * o.im;
        let n = self.times(Complex { re: o.re, im: -o.im });
        Complex { re: n.re / norm, im: n.im / norm }
    }

    fn magnitude(self) -> f64 {
        self.re.to_f64().hypot(self.im.to_f64())
    }
}

/// Asserts that each reported pole lies within its bound of a root of det(M s^2 + C s + K), found by Newton's iteration
/// s <- s - 1 / tr(Q^-1 Q') from the pole itself; and that the sum of all poles is that of the roots, -tr(M^-1 C).
pub fn assert_poles(answer: &Answer, second: &Linearised, text: &str) {
    let list = &answer.poles.list;
    assert_eq!(list.len(), 2 * second.m.rows, "two poles a coordinate in\n{text}");
    for pole in list {
        assert!(pole.relative_error.is_finite(), "certified: {pole:?} in\n{text}");
        if pole.kind == PoleKind::Rigid || pole.cluster.is_some() {
            // A multiple root moves by a root of the error of the matrices: there is no sharp comparison.
            continue;
        }
        let start = Complex { re: pole.re.mid, im: pole.im.mid };
        let root = newton(second, start);
        let off = root.minus(start).magnitude();
        let allowed = pole.relative_error * start.magnitude() * (1.0 + 1e-12) + 1e-16 * start.magnitude();
        assert!(off <= allowed, "{pole:?}, root {root:?}, apart {off:e} in\n{text}");
        assert!(pole.relative_error < 1e-12, "sharp: {pole:?} in\n{text}");
    }
    let sum = list.iter().fold(Dd::ZERO, |sum, pole| sum + pole.re.mid).to_f64();
    let size = list.iter().map(|pole| pole.re.magnitude().hypot(pole.im.magnitude())).fold(0.0, f64::max);
    let trace = super::extended::solve(second.m.clone(), second.c.clone()).expect("a mass matrix");
    let trace = (0..trace.rows).map(|i| trace.at(i, i).to_f64()).sum::<f64>();
    assert!((sum + trace).abs() <= 1e-12 * size, "sum of poles {sum:e}, -tr(M^-1 C) {:e} in\n{text}", -trace);
}

fn newton(second: &Linearised, mut s: Complex) -> Complex {
    for _ in 0..6 {
        let Some(trace) = log_derivative(second, s) else { return s };
        let step = Complex::ONE.over(trace);
        s = s.minus(step);
        if step.magnitude() < 1e-26 * s.magnitude() {
            break;
        }
    }
    s
}

/// d/ds ln det Q = tr(Q^-1 Q'); `None` if Q is singular to the last digit.
fn log_derivative(second: &Linearised, s: Complex) -> Option<Complex> {
    let n = second.m.rows;
    let at = |matrix: &Matrix, i: usize, j: usize| Complex { re: matrix.at(i, j), im: Dd::ZERO };
    let mut rows: Vec<Vec<Complex>> = Vec::new();
    for i in 0..n {
        let q = |j| at(&second.m, i, j).times(s).plus(at(&second.c, i, j)).times(s).plus(at(&second.k, i, j));
        let slope = |j| {
            at(&second.m, i, j).times(s).times(Complex { re: Dd::from(2.0), im: Dd::ZERO }).plus(at(&second.c, i, j))
        };
        rows.push((0..n).map(q).chain((0..n).map(slope)).collect());
    }
    for p in 0..n {
        let best = (p..n).max_by(|&a, &b| rows[a][p].magnitude().total_cmp(&rows[b][p].magnitude()))?;
        rows.swap(p, best);
        if rows[p][p].magnitude() == 0.0 {
            return None;
        }
        let pivot_row = rows[p].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != p) {
            let factor = row[p].over(pivot_row[p]);
            row.iter_mut().zip(&pivot_row).for_each(|(entry, pivot)| *entry = entry.minus(factor.times(*pivot)));
        }
    }
    Some((0..n).fold(Complex::ZERO, |sum, i| sum.plus(rows[i][n + i].over(rows[i][i]))))
}
