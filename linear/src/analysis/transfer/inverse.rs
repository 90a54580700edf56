//! An approximate inverse R of a complex symmetric matrix Q, and a proof of its accuracy: with E = I - R Q, the
//! solution of Q x = b satisfies x - y = R (b - Q y) + E (x - y) for every y. In: the entries of Q as enclosures. Out:
//! R, a bound of |E| entry by entry, and from these a bound of |x - y| for any residual (Rump, *Verification methods*,
//! Acta Numerica 19 (2010), section 10). See docs/method/transfer.md.

use crate::base::{Ball, Dd, larger, two_to, up};
use crate::kernel::complex::Complex;
use crate::kernel::dense::{Matrix, lu};
use crate::kernel::real;

/// The numbers of an inverse: `Complex<f64>` first, `Complex<Dd>` if that is not enough.
pub trait Scalar: real::Scalar {
    /// Relative error of one real operation, doubled.
    const UNIT: f64;
    fn from_dd(z: Complex<Dd>) -> Self;
    fn to_dd(self) -> Complex<Dd>;
}

impl Scalar for Complex<f64> {
    const UNIT: f64 = f64::EPSILON;
    fn from_dd(z: Complex<Dd>) -> Self {
        z.to_f64()
    }
    fn to_dd(self) -> Complex<Dd> {
        self.into()
    }
}

impl Scalar for Complex<Dd> {
    const UNIT: f64 = 2.0 * Dd::EPSILON;
    fn from_dd(z: Complex<Dd>) -> Self {
        z
    }
    fn to_dd(self) -> Complex<Dd> {
        self
    }
}

/// An entry of Q, both triangles.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    pub i: u32,
    pub j: u32,
    pub value: Complex<Ball>,
}

/// R = D R' D, where D is a diagonal of powers of two that bring the rows of Q' = D Q D near one.
#[derive(Clone, Debug)]
pub struct Inverse<T> {
    n: usize,
    scale: Vec<f64>,
    /// R', row by row.
    inverse: Vec<T>,
    /// |R'|
    sizes: Vec<f64>,
    /// A bound of |I - R' Q'|, row by row.
    error: Vec<f64>,
    /// Positive weights w, and the contraction theta = max (|E| w)_i / w_i < 1/2.
    weights: Vec<f64>,
    contraction: f64,
}

/// With a larger contraction a certificate would still hold, but the refinement hardly converges.
const CONTRACTION_LIMIT: f64 = 0.25;
/// Covers underflow in sums of scaled products.
const TINY: f64 = 1e-290;
/// Added to each component, which may have underflowed at any scale.
const UNDERFLOW: f64 = 1e-317;
/// Covers the roundings of a bound that is itself a sum of a few thousand numbers in binary64.
const UP: f64 = up::THOUSANDS;

impl<T: Scalar> Inverse<T> {
    /// `None` if Q is singular to the precision of T, or its inverse cannot be proven.
    pub fn of(n: usize, entries: &[Entry]) -> Option<Inverse<T>> {
        let scale = equilibrate(n, entries)?;
        let mut scaled = vec![T::ZERO; n * n];
        for entry in entries {
            let factor = scale[entry.i as usize] * scale[entry.j as usize];
            let mid = entry.value.mid();
            let mid = Complex::new(mid.re.scale(factor), mid.im.scale(factor));
            scaled[entry.i as usize * n + entry.j as usize] = T::from_dd(mid);
        }
        let inverse = lu::inverse(Matrix::from_fn(n, n, |i, j| scaled[i * n + j]))?;
        let inverse: Vec<T> = (0..n * n).map(|at| inverse[(at / n, at % n)]).collect();
        let sizes: Vec<f64> = inverse.iter().map(|z| z.size()).collect();
        let error = defect(n, entries, &scale, &scaled, &inverse, &sizes);
        let (weights, contraction) = contraction(n, &sizes, &error)?;
        Some(Inverse { n, scale, inverse, sizes, error, weights, contraction })
    }

    /// R r, as a correction.
    pub fn apply(&self, residual: &[Complex<Ball>]) -> Vec<Complex<Dd>> {
        let scaled: Vec<T> = (0..self.n)
            .map(|j| {
                let r = residual[j].mid();
                T::from_dd(Complex::new(r.re.scale(self.scale[j]), r.im.scale(self.scale[j])))
            })
            .collect();
        (0..self.n)
            .map(|i| {
                let row = &self.inverse[i * self.n..(i + 1) * self.n];
                let x = row.iter().zip(&scaled).fold(T::ZERO, |sum, (&r, &b)| sum + r * b).to_dd();
                Complex::new(x.re.scale(self.scale[i]), x.im.scale(self.scale[i]))
            })
            .collect()
    }

    /// A bound of |x - y| for each component, from the residual b - Q y: |x - y| <= t + |E| |x - y| with t = |R| |r|, so
    /// |x - y| <= eta w with eta = max t_i / w_i / (1 - theta), and then |x - y| <= t + eta |E| w.
    pub fn error(&self, residual: &[Complex<Ball>]) -> Vec<f64> {
        let sizes: Vec<f64> = residual.iter().zip(&self.scale).map(|(r, d)| r.magnitude() * d).collect();
        let t = multiply(self.n, &self.sizes, &sizes);
        let eta = t.iter().zip(&self.weights).map(|(t, w)| t / w).fold(0.0, larger) / (1.0 - self.contraction);
        let rest = multiply(self.n, &self.error, &self.weights);
        (0..self.n).map(|i| (t[i] + eta * rest[i] + TINY) * self.scale[i] * UP + UNDERFLOW).collect()
    }
}

/// Powers of two d that bring the largest |d_i Q_ij d_j| of each row near one (Ruiz 2001, symmetric); `None` for a row
/// of zeros or numbers that are not finite.
fn equilibrate(n: usize, entries: &[Entry]) -> Option<Vec<f64>> {
    let mut exponent = vec![0i32; n];
    for _ in 0..4 {
        let mut largest = vec![i32::MIN; n];
        for entry in entries {
            let size = entry.value.mid().to_f64().one_norm();
            if !size.is_finite() {
                return None;
            }
            if size > 0.0 {
                let (i, j) = (entry.i as usize, entry.j as usize);
                largest[i] = largest[i].max(binary_exponent(size) + exponent[i] + exponent[j]);
            }
        }
        for (e, largest) in exponent.iter_mut().zip(&largest) {
            if *largest == i32::MIN {
                return None;
            }
            *e -= largest.div_euclid(2);
        }
    }
    exponent.iter().all(|e| e.abs() < 500).then(|| exponent.iter().map(|&e| two_to(e)).collect())
}

/// The exponent e of 2^e <= x < 2^(e+1), for normal numbers.
fn binary_exponent(x: f64) -> i32 {
    ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

/// A bound of |I - R' Q'|: the computed difference, its rounding, and the uncertainty and rounding of Q.
fn defect<T: Scalar>(
    n: usize,
    entries: &[Entry],
    scale: &[f64],
    scaled: &[T],
    inverse: &[T],
    sizes: &[f64],
) -> Vec<f64> {
    let mut product = vec![T::ZERO; n * n];
    let mut slack = vec![0.0f64; n * n];
    let rounding = (2 * n + 8) as f64 * T::UNIT;
    for entry in entries {
        let (k, j) = (entry.i as usize, entry.j as usize);
        let q = scaled[k * n + j];
        let uncertain = entry.value.radius() * (scale[k] * scale[j]) + q.size() * (rounding + T::UNIT);
        for i in 0..n {
            product[i * n + j] = product[i * n + j] + inverse[i * n + k] * q;
            slack[i * n + j] += sizes[i * n + k] * uncertain;
        }
    }
    for i in 0..n {
        product[i * n + i] = product[i * n + i] - T::ONE;
    }
    product.iter().zip(&slack).map(|(p, s)| (p.size() * UP + s + T::UNIT * p.size()) * UP + TINY).collect()
}

/// Weights that make the contraction small: the row sizes of R, then a few steps of the power method towards the Perron
/// vector of |E|. `None` if E is not certainly small.
fn contraction(n: usize, sizes: &[f64], error: &[f64]) -> Option<(Vec<f64>, f64)> {
    let ones = vec![1.0; n];
    let mut weights = multiply(n, sizes, &ones);
    let mut best: Option<(Vec<f64>, f64)> = None;
    for _ in 0..4 {
        if !weights.iter().all(|w| *w > 0.0 && w.is_finite()) {
            break;
        }
        let image = multiply(n, error, &weights);
        let theta = image.iter().zip(&weights).map(|(e, w)| e / w).fold(0.0, larger) * UP;
        if theta.is_finite() && best.as_ref().is_none_or(|(_, known)| theta < *known) {
            best = Some((weights.clone(), theta));
        }
        let largest = image.iter().copied().fold(0.0, f64::max);
        weights = image.iter().map(|w| w / largest + 1e-12).collect();
    }
    best.filter(|(_, theta)| *theta <= CONTRACTION_LIMIT)
}

fn multiply(n: usize, matrix: &[f64], x: &[f64]) -> Vec<f64> {
    (0..n).map(|i| matrix[i * n..(i + 1) * n].iter().zip(x).map(|(a, b)| a * b).sum::<f64>() * UP).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn symmetric(n: usize, value: impl Fn(usize, usize) -> f64) -> Vec<Entry> {
        let entry = |i: usize, j: usize| Entry {
            i: i as u32,
            j: j as u32,
            value: Complex::new(Ball::from(value(i.min(j), i.max(j))), Ball::ZERO),
        };
        (0..n * n).map(|at| entry(at / n, at % n)).collect()
    }

    /// The Hilbert matrix of order 6 times a vector of ones: the bound covers the distance of any y from the solution.
    #[test]
    fn the_bound_holds_for_any_approximation() {
        let n = 6;
        let entries = symmetric(n, |i, j| 1.0 / (i + j + 1) as f64);
        let inverse = Inverse::<Complex<f64>>::of(n, &entries).expect("a condition of 1.5e7 is no obstacle");
        let y = [1.0, 1.0 + 1e-9, 1.0, 1.0 - 1e-7, 1.0, 1.0];
        let mut residual = vec![Complex::<Ball>::ZERO; n];
        for entry in &entries {
            let difference = Complex::new(Ball::from(1.0) - Ball::from(y[entry.j as usize]), Ball::ZERO);
            residual[entry.i as usize] = residual[entry.i as usize] + entry.value * difference;
        }
        let bound = inverse.error(&residual);
        assert!(bound[1] >= 0.99e-9 && bound[3] >= 0.99e-7);
        assert!(bound.iter().all(|b| *b < 1.0), "{bound:?}");
    }

    /// Nearly singular matrices, whose inverses in binary64 have three correct digits: |R| |r| alone is less than the
    /// distance whenever R came out too small.
    #[test]
    fn the_bound_holds_with_a_poor_inverse() {
        let mut too_small = 0;
        for i in 1..200 {
            let a = 1.0 + f64::from(i) / 300.0;
            let b = a * (1.0 - 2e-13);
            let entries = symmetric(2, |i, j| if i == j { a } else { b });
            let Some(inverse) = Inverse::<Complex<f64>>::of(2, &entries) else { continue };
            // x - y = (1, -1), so the residual is (a - b)(1, -1), exactly.
            let residual = [a - b, b - a].map(|r| Complex::new(Ball::from(r), Ball::ZERO));
            let bound = inverse.error(&residual);
            assert!(bound.iter().all(|bound| *bound >= 1.0), "{a} {bound:?}");
            let sizes: Vec<f64> = residual.iter().zip(&inverse.scale).map(|(r, d)| r.magnitude() * d).collect();
            let alone = multiply(2, &inverse.sizes, &sizes);
            too_small += usize::from(alone.iter().zip(&inverse.scale).any(|(t, d)| t * d * UP < 1.0));
        }
        assert!(too_small > 5, "the case is not met: {too_small}");
    }

    /// Rows and columns in other units: D H D with powers of two from 2^-60 to 2^60, where the solution is D^-1 times ones.
    #[test]
    fn the_bound_holds_in_graded_units_too() {
        let n = 4;
        let unit = |i: usize| 2f64.powi(40 * i as i32 - 60);
        let entries = symmetric(n, |i, j| unit(i) * unit(j) / (i + j + 1) as f64);
        let inverse = Inverse::<Complex<f64>>::of(n, &entries).expect("a condition of 15,000");
        for off in 0..n {
            let y = |j: usize| if j == off { 1.0 + 1e-7 } else { 1.0 } / unit(j);
            let mut residual = vec![Complex::<Ball>::ZERO; n];
            for entry in &entries {
                let difference = Ball::from(1.0 / unit(entry.j as usize)) - Ball::from(y(entry.j as usize));
                let i = entry.i as usize;
                residual[i] = residual[i] + entry.value * Complex::new(difference, Ball::ZERO);
            }
            let bound = inverse.error(&residual);
            assert!(bound[off] >= 0.99e-7 / unit(off), "{off}: {bound:?}");
            assert!(bound.iter().enumerate().all(|(i, bound)| bound * unit(i) < 1e-2), "{bound:?}");
        }
    }

    /// The solution of Q x = Q (1, 2, 3) in the same units, to what binary64 leaves of a condition of 500.
    #[test]
    fn a_correction_is_the_solution() {
        let n = 3;
        let unit = |i: usize| 2f64.powi(40 * i as i32 - 60);
        let entries = symmetric(n, |i, j| unit(i) * unit(j) / (i + j + 1) as f64);
        let inverse = Inverse::<Complex<f64>>::of(n, &entries).expect("a condition of 500");
        let x = |j: usize| (j + 1) as f64 / unit(j);
        let mut residual = vec![Complex::<Ball>::ZERO; n];
        for entry in &entries {
            let (i, j) = (entry.i as usize, entry.j as usize);
            residual[i] = residual[i] + entry.value * Complex::new(Ball::from(x(j)), Ball::from(-x(j)));
        }
        let found = inverse.apply(&residual);
        assert_eq!(found.len(), n);
        for (j, found) in found.iter().enumerate() {
            let off = [found.re.to_f64() - x(j), found.im.to_f64() + x(j)];
            assert!(off.iter().all(|off| off.abs() < 1e-12 * x(j)), "{j}: {found:?}");
        }
    }

    /// (1 1/2; 1/2 1) with every entry uncertain by 0.3 may be singular, whatever its unit.
    #[test]
    fn a_possibly_singular_matrix_has_no_proven_inverse_in_any_unit() {
        for unit in [1e-20, 1.0, 1e20] {
            let uncertain = |by: f64| {
                let mut entries = symmetric(2, |i, j| if i == j { unit } else { 0.5 * unit });
                entries.iter_mut().for_each(|entry| entry.value.re = entry.value.re.widen(by * unit));
                Inverse::<Complex<f64>>::of(2, &entries).is_some()
            };
            assert!(!uncertain(0.3) && uncertain(1e-3), "{unit:e}");
        }
    }

    #[test]
    fn a_singular_matrix_has_no_proven_inverse() {
        let entries = symmetric(2, |_, _| 3.0);
        assert!(Inverse::<Complex<f64>>::of(2, &entries).is_none());
        assert!(Inverse::<Complex<Dd>>::of(2, &entries).is_none());
    }

    #[test]
    fn double_double_inverts_where_double_precision_cannot() {
        let entries = symmetric(2, |i, j| if i == j { 1.0 } else { 1.0 - 1e-16 });
        assert!(Inverse::<Complex<f64>>::of(2, &entries).is_none());
        assert!(Inverse::<Complex<Dd>>::of(2, &entries).is_some());
    }
}
