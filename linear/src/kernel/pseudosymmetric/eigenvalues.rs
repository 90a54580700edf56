//! The eigenvalues of a tridiagonal pencil T - s J with real entries and signs J.
//!
//! The QL method for the complex symmetric matrix J^-1/2 T J^-1/2 (Cullum and Willoughby, SIAM J. Matrix Anal. 17
//! (1996) 83) finds all of them in about n^2 steps, but a few of them with few digits, because its rotations are not
//! bounded. The Ehrlich-Aberth iteration on det(T - s J) (Bini, Gemignani and Tisseur, SIAM J. Matrix Anal. 27
//! (2005) 153) then refines them to the digits that the pencil determines.

use crate::kernel::complex::Complex;
use crate::kernel::lanes::Pair;
use crate::kernel::pseudosymmetric::Tridiagonal;
use crate::kernel::simd::{MOST, Twice, Vector, each, simd};

/// Two steps for each eigenvalue are usual.
const MOST_STEPS: usize = 60;
/// From the QL method's values, three sweeps are usually enough.
const MOST_SWEEPS: usize = 12;
/// A smaller relative step is rounding error.
const SETTLED: f64 = 1e-13;
/// Below this part of the modulus an imaginary part may be rounding error; then a conjugate partner decides.
const NEARLY_REAL: f64 = 1e-2;

/// One eigenvalue of each conjugate pair, im > 0, and the real ones. `None` if the QL method does not converge, or if
/// eigenvalues are not found in pairs.
pub fn eigenvalues(pencil: &Tridiagonal) -> Option<Vec<Complex<f64>>> {
    let mut values = by_rotations(pencil)?;
    polish(pencil, &mut values);
    let real: Vec<bool> = (0..values.len()).map(|i| is_real(&values, i)).collect();
    for (value, &real) in values.iter_mut().zip(&real) {
        if real {
            value.im = 0.0;
        }
    }
    let upper: Vec<Complex<f64>> = values.iter().copied().filter(|z| z.im >= 0.0).collect();
    let count: usize = upper.iter().map(|z| if z.im == 0.0 { 1 } else { 2 }).sum();
    (count == values.len() && upper.iter().all(|z| z.is_finite())).then_some(upper)
}

/// Whether an eigenvalue near the real axis has no partner on the other side.
fn is_real(values: &[Complex<f64>], i: usize) -> bool {
    let z = values[i];
    if z.im.abs() >= NEARLY_REAL * z.one_norm() {
        return false;
    }
    let is_partner = |(j, other): (usize, &Complex<f64>)| j != i && (*other - z.conj()).one_norm() < 0.1 * z.im.abs();
    !values.iter().enumerate().any(is_partner)
}

/// The implicit QL method with complex rotations.
fn by_rotations(pencil: &Tridiagonal) -> Option<Vec<Complex<f64>>> {
    let n = pencil.diagonal.len();
    let mut d: Vec<Complex<f64>> =
        pencil.diagonal.iter().zip(&pencil.signs).map(|(d, sign)| Complex::real(d * sign)).collect();
    let mut e: Vec<Complex<f64>> = (1..n)
        .map(|i| match pencil.signs[i] == pencil.signs[i - 1] {
            true => Complex::real(pencil.beside[i - 1]),
            false => Complex::new(0.0, pencil.beside[i - 1]),
        })
        .collect();
    e.push(Complex::ZERO);
    for l in 0..n {
        let mut step = 0;
        loop {
            let small = |m: &usize| e[*m].one_norm() <= f64::EPSILON * (d[*m].one_norm() + d[m + 1].one_norm());
            let m = (l..n - 1).find(small).unwrap_or(n - 1);
            if m == l {
                break;
            }
            step += 1;
            if step > MOST_STEPS {
                return None;
            }
            rotate_up(&mut d, &mut e, (l, m), step);
        }
    }
    Some(d)
}

/// One step on the block of rows l to m.
fn rotate_up(d: &mut [Complex<f64>], e: &mut [Complex<f64>], (l, m): (usize, usize), step: usize) {
    let one = Complex::real(1.0);
    let half = (d[l + 1] - d[l]) * (e[l] + e[l]).recip();
    let root = (half * half + one).sqrt();
    let sum = if (half + root).one_norm() >= (half - root).one_norm() { half + root } else { half - root };
    // Now and then another shift, against a cycle.
    let shift = if step % 11 == 10 { e[l] * Complex::new(0.7, 0.3) } else { e[l] * sum.recip() };
    let mut g = d[m] - d[l] + shift;
    let (mut s, mut c, mut p) = (one, one, Complex::ZERO);
    for i in (l..m).rev() {
        let (f, b) = (s * e[i], c * e[i]);
        let mut r = (f * f + g * g).sqrt();
        if r.one_norm() <= f64::EPSILON * (f.one_norm() + g.one_norm()) {
            // No rotation takes an isotropic vector to an axis; later steps correct the error of this one.
            r = Complex::real((f.one_norm() + g.one_norm()) * 1e-8 + f64::MIN_POSITIVE);
        }
        e[i + 1] = r;
        let inverse = r.recip();
        (s, c) = (f * inverse, g * inverse);
        g = d[i + 1] - p;
        let t = (d[i] - g) * s + (c * b).scale(2.0);
        p = s * t;
        d[i + 1] = g + p;
        g = c * t - b;
    }
    d[l] = d[l] - p;
    e[l] = g;
    e[m] = Complex::ZERO;
}

/// Sweeps of Ehrlich and Aberth's iteration until no value moves.
fn polish(pencil: &Tridiagonal, values: &mut [Complex<f64>]) {
    let mut moving: Vec<(usize, f64)> = (0..values.len()).map(|i| (i, f64::INFINITY)).collect();
    for _ in 0..MOST_SWEEPS {
        if moving.is_empty() {
            return;
        }
        let steps = corrections(pencil, values, &moving);
        let mut still = Vec::new();
        for (&(i, last), step) in moving.iter().zip(steps) {
            let size = step.one_norm() / values[i].one_norm();
            // A step that is not finite, or that rounding alone makes, would do harm.
            if size < last {
                values[i] = values[i] - step;
                if size > SETTLED {
                    still.push((i, size));
                }
            }
        }
        moving = still;
    }
}

/// 1 / (p'/p - sum 1 / (s_i - s_j)) with p = det(T - s J), for each of the values that move.
fn corrections(pencil: &Tridiagonal, values: &[Complex<f64>], moving: &[(usize, f64)]) -> Vec<Complex<f64>> {
    let squares: Vec<f64> = pencil.beside.iter().map(|e| e * e).collect();
    let re: Vec<f64> = values.iter().map(|z| z.re).collect();
    let im: Vec<f64> = values.iter().map(|z| z.im).collect();
    let which: Vec<usize> = moving.iter().map(|&(i, _)| i).collect();
    let (mut step_re, mut step_im) = (Vec::new(), Vec::new());
    corrections_side_by_side(pencil, &squares, &re, &im, &which, &mut step_re, &mut step_im);
    step_re.into_iter().zip(step_im).map(|(re, im)| Complex::new(re, im)).collect()
}

simd! {
    fn corrections_side_by_side<V: Vector>(
        pencil: &Tridiagonal,
        squares: &[f64],
        re: &[f64],
        im: &[f64],
        which: &[usize],
        step_re: &mut Vec<f64>,
        step_im: &mut Vec<f64>
    ) {
        for chunk in which.chunks(Twice::<V>::WIDTH) {
            let lanes: [usize; MOST] = each(|i| chunk[i.min(chunk.len() - 1)]);
            let step = correction::<Twice<V>>(pencil, squares, re, im, &lanes);
            step_re.extend_from_slice(&step.re.to_array()[..chunk.len()]);
            step_im.extend_from_slice(&step.im.to_array()[..chunk.len()]);
        }
    }
}

#[inline(always)]
fn correction<V: Vector>(
    pencil: &Tridiagonal,
    squares: &[f64],
    re: &[f64],
    im: &[f64],
    lanes: &[usize; MOST],
) -> Pair<V> {
    let s =
        Pair { re: V::load(&each::<f64, MOST>(|l| re[lanes[l]])), im: V::load(&each::<f64, MOST>(|l| im[lanes[l]])) };
    let slope = logarithmic_slope(pencil, squares, s);
    let mut others = Pair::<V>::zero();
    for (j, (&re, &im)) in re.iter().zip(im).enumerate() {
        let difference = Pair { re: s.re - V::splat(re), im: s.im - V::splat(im) };
        // The reciprocal of the distance from itself would be infinite.
        let own: [f64; MOST] = each(|l| if lanes[l] == j { 0.0 } else { 1.0 });
        let own = V::load(&own);
        let safe = Pair { re: difference.re + (V::splat(1.0) - own), im: difference.im };
        let inverse = safe.recip();
        others = Pair { re: own.mul_add(inverse.re, others.re), im: own.mul_add(inverse.im, others.im) };
    }
    Pair { re: slope.re - others.re, im: slope.im - others.im }.recip()
}

/// p'/p for p = det(T - s J), the sum of r_i'/r_i with the pivots r_i = d_i - s J_i - e^2 / r of the row before.
#[inline(always)]
fn logarithmic_slope<V: Vector>(pencil: &Tridiagonal, squares: &[f64], s: Pair<V>) -> Pair<V> {
    let mut sum = Pair::<V>::zero();
    let (mut inverse, mut ratio) = (Pair::<V>::zero(), Pair::<V>::zero());
    for i in 0..pencil.diagonal.len() {
        let (d, sign) = (V::splat(pencil.diagonal[i]), V::splat(pencil.signs[i]));
        let square = V::splat(if i > 0 { squares[i - 1] } else { 0.0 });
        // e^2 / r of the row before, and its r'/r.
        let coupled = Pair { re: square * inverse.re, im: square * inverse.im };
        let pivot = Pair { re: d - sign * s.re - coupled.re, im: -(sign * s.im) - coupled.im };
        let slope = Pair { re: -sign, im: V::splat(0.0) }.plus_product(coupled, ratio);
        // A pivot that is exactly zero is moved by less than its rounding.
        inverse = Pair { re: pivot.re + V::splat(f64::MIN_POSITIVE), im: pivot.im }.recip();
        ratio = slope.times(inverse);
        sum = Pair { re: sum.re + ratio.re, im: sum.im + ratio.im };
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// T = tridiag(1, d, 1) of order n with J = 1 has the eigenvalues d + 2 cos(pi k / (n + 1)).
    #[test]
    fn values_are_those_of_the_closed_form() {
        let n = 50;
        let pencil = Tridiagonal { diagonal: vec![0.5; n], beside: vec![1.0; n - 1], signs: vec![1.0; n] };
        let mut found: Vec<f64> = eigenvalues(&pencil).expect("converges").iter().map(|z| z.re).collect();
        found.sort_by(f64::total_cmp);
        assert_eq!(found.len(), n);
        for (k, value) in found.into_iter().rev().enumerate() {
            let angle = std::f64::consts::PI * (k + 1) as f64 / (n + 1) as f64;
            assert!((value - 0.5 - 2.0 * libm::cos(angle)).abs() < 1e-12, "{k}");
        }
    }

    /// Pairs (0 w; w c) with the signs (1, -1): s^2 + c s + w^2, oscillating, overdamped and without damping.
    #[test]
    fn independent_oscillators_have_their_own_poles() {
        let (rates, damping): ([f64; 4], [f64; 4]) = ([1.0, 2.0, 3.5, 7.0], [0.1, 0.0, 40.0, 13.0]);
        let pencil = Tridiagonal {
            diagonal: damping.iter().flat_map(|&c| [0.0, c]).collect(),
            beside: rates.iter().flat_map(|&w| [w, 0.0]).take(7).collect(),
            signs: [1.0, -1.0].repeat(4),
        };
        let found = eigenvalues(&pencil).expect("converges");
        assert_eq!(found.iter().filter(|z| z.im == 0.0).count(), 2);
        for (w, c) in rates.into_iter().zip(damping) {
            let root = Complex::real(c * c / 4.0 - w * w).sqrt();
            for expected in [Complex::real(-c / 2.0) + root, Complex::real(-c / 2.0) - root] {
                let near = |z: &Complex<f64>| (*z - expected).abs() < 1e-11 * expected.abs();
                assert!(expected.im < 0.0 || found.iter().any(near), "{expected:?}");
            }
        }
    }
}
