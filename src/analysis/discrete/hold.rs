//! One step of a block, exactly: w(t + h) = F w(t) + the effect of an input that is held, or interpolated linearly, in
//! between. In: A and h. Out: F = exp(A h), P1 = int exp(A s) ds and P2 = int (h - s) exp(A s) ds over the step, in
//! double-double. They are blocks of the exponential of one larger matrix (Van Loan, IEEE Trans. AC-23 (1978) 395). See
//! docs/method/emit.md.

use crate::analysis::response::exponential::Generator;
use crate::base::{Ball, Dd, two_to};
use crate::kernel::dense::Matrix;
use crate::kernel::dense::enclosure::norm_bound;

/// The matrices of one step.
#[derive(Clone, Debug)]
pub struct Propagator {
    pub f: Matrix<Dd>,
    pub p1: Matrix<Dd>,
    pub p2: Matrix<Dd>,
}

/// The step of w' = A w + B u; `None` if it is out of range.
pub fn propagator(a: &Matrix<Dd>, h: Dd) -> Option<Propagator> {
    let n = a.rows();
    let scale = balance(a);
    // In units of the step: [A h, I, 0; 0, 0, I; 0, 0, 0].
    let augmented = Matrix::from_fn(3 * n, 3 * n, |i, j| {
        if i < n && j < n {
            (a[(i, j)] * h).scale(scale[j] / scale[i])
        } else if j == i + n {
            Dd::ONE
        } else {
            Dd::ZERO
        }
    });
    let e = exponential(augmented)?;
    let part = |block: usize, factor: Dd| {
        Matrix::from_fn(n, n, |i, j| (e[(i, j + block * n)] * factor).scale(scale[i] / scale[j]))
    };
    Some(Propagator { f: part(0, Dd::ONE), p1: part(1, h), p2: part(2, h * h) })
}

/// The effect of a source on w' = A w + drive s, s' = (R / h) s, in `steps` steps of h: the corner of exp([A, drive; 0,
/// R / h] t).
pub fn source_effect(a: &Matrix<Dd>, drive: &Matrix<Dd>, r: &Matrix<Dd>, steps: Dd, h: Dd) -> Option<Matrix<Dd>> {
    let (n, m) = (a.rows(), r.rows());
    let scale = balance(a);
    // A power of two brings the drive, which has its own unit, near one.
    let force = |i: usize, j: usize| (drive[(i, j)] * h).scale(1.0 / scale[i]);
    let most = (0..m).flat_map(|j| (0..n).map(move |i| (i, j))).map(|(i, j)| force(i, j).hi.abs()).fold(0.0, f64::max);
    if most == 0.0 || steps.is_zero() {
        return Some(Matrix::zeros(n, m));
    }
    let unit = two_to(exponent(most).clamp(-1000, 1000));
    let augmented = Matrix::from_fn(n + m, n + m, |i, j| {
        let entry = match (i < n, j < n) {
            (true, true) => (a[(i, j)] * h).scale(scale[j] / scale[i]),
            (true, false) => force(i, j - n).scale(1.0 / unit),
            (false, false) => r[(i - n, j - n)],
            (false, true) => Dd::ZERO,
        };
        entry * steps
    });
    let e = exponential(augmented)?;
    Some(Matrix::from_fn(n, m, |i, j| e[(i, n + j)].scale(unit * scale[i])))
}

/// exp(A t) x
pub fn propagate(a: &Matrix<Dd>, x: &[Dd], t: Dd) -> Option<Vec<Dd>> {
    let n = a.rows();
    let scale = balance(a);
    let e = exponential(Matrix::from_fn(n, n, |i, j| (a[(i, j)] * t).scale(scale[j] / scale[i])))?;
    let entry = |i: usize, j: usize| e[(i, j)].scale(scale[i] / scale[j]);
    Some((0..n).map(|i| (0..n).fold(Dd::ZERO, |sum, j| sum + entry(i, j) * x[j])).collect())
}

/// exp of a dimensionless matrix.
pub fn exponential(a: Matrix<Dd>) -> Option<Matrix<Dd>> {
    let norm = norm_bound(a.rows(), a.columns(), |i, j| a[(i, j)].hi.abs());
    if !norm.is_finite() {
        return None;
    }
    let e = Generator { a, error: 0.0, rate: norm, norm }.exponential(Ball::ONE)?.f;
    (0..e.columns()).all(|j| e.column(j).iter().all(|x| x.is_finite())).then_some(e)
}

/// Powers of two that bring rows and columns to the same magnitude (Osborne 1960), so that units do not make the norm
/// large.
fn balance(a: &Matrix<Dd>) -> Vec<f64> {
    let n = a.rows();
    let mut scale = vec![1.0f64; n];
    for _ in 0..40 {
        let mut changed = false;
        for i in 0..n {
            let size = |i: usize, j: usize| a[(i, j)].hi.abs() * scale[j] / scale[i];
            let (row, column) =
                (0..n).filter(|&j| j != i).fold((0.0, 0.0), |(r, c), j| (r + size(i, j), c + size(j, i)));
            if row > 0.0 && column > 0.0 && !(0.25..4.0).contains(&(row / column)) {
                let exponent = exponent((row / column).sqrt()).clamp(-400, 400);
                scale[i] *= two_to(exponent);
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    scale
}

/// The exponent of a positive number: the largest power of two not above it.
fn exponent(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An oscillator of 3 rad/s under a force of 1: displacement (1 - cos 3h) / 9; under a ramp t: (h - sin(3h)/3) / 9.
    #[test]
    fn a_held_force_and_a_ramp() {
        let a = Matrix::from_fn(2, 2, |i, j| Dd::from([[0.0, 1.0], [-9.0, 0.0]][i][j]));
        let p = propagator(&a, Dd::from(0.5)).expect("in range");
        assert!((p.p1[(0, 1)].to_f64() - (1.0 - 1.5f64.cos()) / 9.0).abs() < 1e-16);
        assert!((p.p2[(0, 1)].to_f64() - (0.5 - 1.5f64.sin() / 3.0) / 9.0).abs() < 1e-16);
        assert!((p.f[(1, 0)].to_f64() + 3.0 * 1.5f64.sin()).abs() < 1e-15);
    }

    /// A stiff oscillator in SI units: the norm of A is 1e12, its natural frequency 1e6 rad/s.
    #[test]
    fn units_do_not_cost_digits() {
        let a = Matrix::from_fn(2, 2, |i, j| Dd::from([[0.0, 1.0], [-1e12, 0.0]][i][j]));
        let p = propagator(&a, Dd::from(1e-6)).expect("in range");
        assert!((p.f[(0, 0)].to_f64() - 1f64.cos()).abs() < 1e-16);
        assert!((p.f[(0, 1)].to_f64() * 1e6 - 1f64.sin()).abs() < 1e-15);
    }
}
