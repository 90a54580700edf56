//! All poles at once, for systems whose state matrix has lost some of them: the Ehrlich-Aberth iteration on det(s^2 +
//! C~ s + Omega^2) in modal coordinates (Bini, Noferini, LAA 439 (2013) 1130). Each value moves by Newton's step for
//! the polynomial with the other values divided out, so no two converge to the same simple pole. In: the basis and
//! rough values. Out: better ones, in binary64; nothing here is printed. See docs/method/poles.md#general-systems.

use crate::analysis::poles::companion::Basis;
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::lu::Lu;

/// Far more than the dozen sweeps that bad starts take.
const MOST_SWEEPS: usize = 60;

/// Improves a list of one value of each conjugate pair (im > 0) and the real values; returns such a list.
pub fn aberth(basis: &Basis, starts: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let mut values = spread_starts(starts, 2 * basis.n() - basis.zeros());
    for _ in 0..MOST_SWEEPS {
        let mut largest = 0.0f64;
        for i in 0..values.len() {
            let step = correction(basis, &values, i);
            values[i] = values[i] - step;
            largest = largest.max(step.one_norm() / values[i].one_norm());
        }
        if largest < 1e-14 {
            break;
        }
    }
    upper_half(&values)
}

/// As many values as there are poles, conjugates included, each rotated a little by a different angle: otherwise equal
/// values would stay equal, and real ones real.
fn spread_starts(starts: &[Complex<f64>], count: usize) -> Vec<Complex<f64>> {
    let both = starts.iter().flat_map(|&z| if z.im > 0.0 { vec![z, z.conj()] } else { vec![z] });
    let mut values: Vec<Complex<f64>> = both.collect();
    let size = values.iter().map(|z| z.abs()).fold(0.0, f64::max);
    while values.len() < count {
        values.push(Complex::real(-size));
    }
    values.truncate(count);
    let turned = |(i, z): (usize, &Complex<f64>)| {
        let angle = 1e-3 * (1.0 + i as f64 * 0.618);
        let z = if z.one_norm() == 0.0 { Complex::real(-size * 1e-3) } else { *z };
        z * Complex::new(1.0 - angle, angle)
    };
    values.iter().enumerate().map(turned).collect()
}

/// 1 / (p'/p - sum 1 / (s_i - s_j)), p'/p = tr(Q^-1 Q') less the poles that are exactly zero.
fn correction(basis: &Basis, values: &[Complex<f64>], i: usize) -> Complex<f64> {
    let s = values[i];
    let Some(slope) = logarithmic_slope(basis, s) else { return Complex::ZERO };
    let inverse = |z: Complex<f64>| if z.one_norm() == 0.0 { Complex::ZERO } else { z.recip() };
    let others = (0..values.len()).filter(|&j| j != i).fold(Complex::ZERO, |sum, j| sum + inverse(s - values[j]));
    let zeros = inverse(s).scale(basis.zeros() as f64);
    let step = inverse(slope - zeros - others);
    if step.is_finite() { step } else { Complex::ZERO }
}

/// s^2 + C~ s + Omega^2
fn modal(basis: &Basis, s: Complex<f64>, i: usize, j: usize) -> Complex<f64> {
    let damped = s.scale(basis.damping[(i, j)]);
    if i == j { s * s + damped + Complex::real(basis.omega_squared[i]) } else { damped }
}

/// p'(s) / p(s) for p = det Q; `None` if s is a pole to the last bit.
fn logarithmic_slope(basis: &Basis, s: Complex<f64>) -> Option<Complex<f64>> {
    let n = basis.n();
    let scale: Vec<f64> = (0..n).map(|i| equilibrating(modal(basis, s, i, i).one_norm())).collect();
    let scaled = |z: Complex<f64>, i: usize, j: usize| z.scale(scale[i] * scale[j]);
    let factors = Lu::nearly_singular(Matrix::from_fn(n, n, |i, j| scaled(modal(basis, s, i, j), i, j)))?;
    let mut trace = Complex::ZERO;
    for j in 0..n {
        let mut column: Vec<Complex<f64>> = (0..n)
            .map(|i| {
                let inertia = if i == j { s.scale(2.0) } else { Complex::ZERO };
                scaled(inertia + Complex::real(basis.damping[(i, j)]), i, j)
            })
            .collect();
        factors.solve(&mut column);
        trace = trace + column[j];
    }
    trace.is_finite().then_some(trace)
}

/// 1 / sqrt(x), or 1 if x is not suitable for scaling.
fn equilibrating(x: f64) -> f64 {
    let scale = 1.0 / x.sqrt();
    if scale.is_finite() && scale > 0.0 { scale } else { 1.0 }
}

/// The values with im > 0, and those that are real up to rounding.
fn upper_half(values: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let is_real = |z: &Complex<f64>| z.im.abs() <= 1e-13 * z.re.abs();
    values
        .iter()
        .filter(|z| z.im > 0.0 || is_real(z))
        .map(|z| if is_real(z) { Complex::real(z.re) } else { *z })
        .collect()
}
