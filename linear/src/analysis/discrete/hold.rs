//! One step of a block, exactly: w(t + h) = F w(t) + the effect of an input that is held, or interpolated linearly, in
//! between. In: A and h. Out: F = exp(A h), P1 = int exp(A s) ds and P2 = int (h - s) exp(A s) ds over the step, in
//! double-double, by the series of the last and doubling. The effect of a source is a block of the exponential of one larger matrix
//! (Van Loan, IEEE Trans. AC-23 (1978) 395). See docs/method/emit.md.

use crate::analysis::response::exponential::Generator;
use crate::base::{Ball, Dd, two_to};
use crate::kernel::dense::Matrix;
use crate::kernel::dense::enclosure::norm_bound;

/// The degree of the series, for norms up to one half.
const DEGREE: usize = 24;
/// 2^100 radians in a step are longer than any useful time.
const MOST_DOUBLINGS: i32 = 100;

/// The matrices of one step.
#[derive(Clone, Debug)]
pub struct Propagator {
    pub f: Matrix<Dd>,
    pub p1: Matrix<Dd>,
    pub p2: Matrix<Dd>,
}

/// The step of w' = A w + B u; `None` if it is out of range. With z = A h, F = exp z, P1 = h f1(z), P2 = h^2 f2(z),
/// f2(z) = sum z^k / (k + 2)!, f1 = 1 + z f2, F = 1 + z f1, and over twice the time
///
///   4 f2(2 z) = f1 + (1 + F) f2,   2 f1(2 z) = (1 + F) f1,   exp(2 z) = F^2.
pub fn propagator(a: &Matrix<Dd>, h: Dd) -> Option<Propagator> {
    let n = a.rows();
    let scale = balance(a);
    let whole = Matrix::from_fn(n, n, |i, j| (a[(i, j)] * h).scale(scale[j] / scale[i]));
    let norm = norm_bound(n, n, |i, j| whole[(i, j)].hi.abs());
    let doublings = (0..=MOST_DOUBLINGS).find(|&k| norm <= 0.5 * two_to(k))?;
    let z = whole.map(|x| x.scale(1.0 / two_to(doublings)));
    let plus_one = |mut x: Matrix<Dd>| {
        (0..n).for_each(|i| x[(i, i)] += Dd::ONE);
        x
    };
    // What is left out is below 2^-25 / 27!.
    let sum = (1..=DEGREE).rev().fold(Matrix::<Dd>::identity(n), |sum, k| {
        let part = Dd::ONE / Dd::from((k + 2) as f64);
        plus_one(z.times(&sum).map(|x| x * part))
    });
    let mut second = sum.map(|x| x.scale(0.5));
    let mut first = plus_one(z.times(&second));
    let mut f = plus_one(z.times(&first));
    for _ in 0..doublings {
        let both = plus_one(f.clone());
        let later = both.times(&second);
        second = Matrix::from_fn(n, n, |i, j| (first[(i, j)] + later[(i, j)]).scale(0.25));
        first = both.times(&first).map(|x| x.scale(0.5));
        f = f.times(&f);
    }
    let is_finite = |x: &Matrix<Dd>| (0..n).all(|j| x.column(j).iter().all(|x| x.is_finite()));
    if ![&f, &first, &second].into_iter().all(is_finite) {
        return None;
    }
    let part =
        |x: Matrix<Dd>, factor: Dd| Matrix::from_fn(n, n, |i, j| (x[(i, j)] * factor).scale(scale[i] / scale[j]));
    Some(Propagator { f: part(f, Dd::ONE), p1: part(first, h), p2: part(second, h * h) })
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
    use crate::base::Number;

    /// An oscillator of 3 rad/s under a force of 1: displacement (1 - cos 3h) / 9; under a ramp t: (h - sin(3h)/3) / 9. To some 29
    /// digits, in steps of a part of a period and of hundreds of periods.
    #[test]
    fn a_held_force_and_a_ramp() {
        let a = Matrix::from_fn(2, 2, |i, j| Dd::from([[0.0, 1.0], [-9.0, 0.0]][i][j]));
        for h in [0.0625, 0.5, 700.0] {
            let p = propagator(&a, Dd::from(h)).expect("in range");
            let (sin, cos) = Number::from(Ball::from(3.0 * h)).sin_cos().expect("in range");
            let (sin, cos) = (sin.to_ball(), cos.to_ball());
            let (h, three, nine) = (Ball::from(h), Ball::from(3.0), Ball::from(9.0));
            let truths = [
                (p.p1[(0, 1)], (Ball::ONE - cos) / nine, 1.0),
                (p.p2[(0, 1)], (h - sin / three) / nine, h.to_f64()),
                (p.p1[(1, 1)], sin / three, 1.0),
                (p.f[(0, 0)], cos, 1.0),
                (p.f[(1, 0)], -(sin * three), 3.0),
            ];
            for (value, truth, size) in truths {
                let error = (Ball::exact(value) - truth).magnitude();
                assert!(error < 1e-29 * size * h.to_f64().max(1.0), "{h:?}: {value:?} {truth:?} {error:e}");
            }
        }
    }

    /// Two real rates, of which one leaves next to nothing in a step, in one block: (1 - e^(r h)) / -r and (e^(r h) - 1 - r h) / r^2.
    #[test]
    fn rates_that_are_far_apart() {
        let rates = [-100.0, -0.5];
        let a = Matrix::from_fn(2, 2, |i, j| if i == j { Dd::from(rates[i]) } else { Dd::ZERO });
        let p = propagator(&a, Dd::from(2.0)).expect("in range");
        for (i, r) in rates.into_iter().enumerate() {
            let (e, r) = (Number::from(Ball::from(2.0 * r)).exp().expect("in range").to_ball(), Ball::from(r));
            let truths = [
                (p.f[(i, i)], e),
                (p.p1[(i, i)], (e - Ball::ONE) / r),
                (p.p2[(i, i)], (e - Ball::ONE - r * Ball::from(2.0)) / (r * r)),
            ];
            for (value, truth) in truths {
                let error = (Ball::exact(value) - truth).magnitude();
                assert!(error <= 1e-27 * truth.to_f64().abs(), "{r:?}: {value:?} {truth:?} {error:e}");
            }
        }
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
