//! Operations on small matrices, one in each lane: factors, rotations, and products whose roundings are bounded. See
//! docs/method/studies.md#many-small-pencils.

use super::U;
use crate::kernel::simd::Vector;

/// Sweeps of rotations: convergence is quadratic; where they do not suffice, the bound says so.
fn sweeps(n: usize) -> usize {
    match n {
        0 | 1 => 0,
        2 => 2,
        3..=4 => 5,
        5..=8 => 6,
        _ => 7,
    }
}

/// The derivative of a polynomial of matrices: the first or the second.
#[inline(always)]
pub fn derivative<V: Vector>(at: V, parts: &[Vec<f64>], order: usize, to: &mut [V]) {
    for x in to.iter_mut() {
        *x = V::splat(0.0);
    }
    for (c, part) in parts.iter().enumerate().skip(order).rev() {
        let factor = if order == 1 { c as f64 } else { (c * (c - 1)) as f64 };
        for (x, coefficient) in to.iter_mut().zip(part) {
            *x = x.mul_add(at, V::splat(factor * coefficient));
        }
    }
}

/// Puts the numbers of each lane in ascending order.
#[inline(always)]
pub fn sort<V: Vector>(list: &mut [V]) {
    for end in (1..list.len()).rev() {
        for i in 0..end {
            let (a, b) = (list[i], list[i + 1]);
            (list[i], list[i + 1]) = (a.if_exceeds(b, b, a), a.if_exceeds(b, a, b));
        }
    }
}

/// M = L L^T and A = L^-1 K L^-T.
#[inline(always)]
pub fn reduce<V: Vector>(n: usize, k: &[V], m: &[V], l: &mut [V], a: &mut [V]) {
    for j in 0..n {
        for i in j..n {
            let mut sum = m[i * n + j];
            for c in 0..j {
                sum = (-l[i * n + c]).mul_add(l[j * n + c], sum);
            }
            l[i * n + j] = if i == j { sum.sqrt() } else { sum / l[j * n + j] };
        }
    }
    // L^-1 K, then its transpose once more.
    a.copy_from_slice(k);
    for _ in 0..2 {
        for i in 0..n {
            for c in 0..i {
                let factor = -l[i * n + c];
                for j in 0..n {
                    a[i * n + j] = factor.mul_add(a[c * n + j], a[i * n + j]);
                }
            }
            let inverse = V::splat(1.0) / l[i * n + i];
            for j in 0..n {
                a[i * n + j] = a[i * n + j] * inverse;
            }
        }
        for i in 0..n {
            for j in 0..i {
                a.swap(i * n + j, j * n + i);
            }
        }
    }
}

/// Jacobi rotations of the symmetric A (Golub and Van Loan, Matrix Computations, 8.5), gathered as the rows of W.
#[inline(always)]
pub fn turn<V: Vector>(n: usize, a: &mut [V], w: &mut [V]) {
    for i in 0..n {
        for j in 0..n {
            w[i * n + j] = V::splat(if i == j { 1.0 } else { 0.0 });
        }
    }
    let tiny = V::splat(1e-290);
    for _ in 0..sweeps(n) {
        for p in 0..n {
            for q in p + 1..n {
                // t = h sign(d) / (|d| + sqrt(d^2 + h^2)), with the quotient of two equal sizes for the sign.
                let (d, h) = (a[q * n + q] - a[p * n + p] + tiny, a[p * n + q] + a[p * n + q]);
                let length = h.mul_add(h, d * d).sqrt();
                let t = h * (d / d.abs()) / (d.abs() + length + tiny);
                let cosine = V::splat(1.0) / t.mul_add(t, V::splat(1.0)).sqrt();
                let sine = t * cosine;
                let change = t * a[p * n + q];
                a[p * n + p] = a[p * n + p] - change;
                a[q * n + q] = a[q * n + q] + change;
                a[p * n + q] = V::splat(0.0);
                // The upper triangle holds the matrix.
                for i in 0..n {
                    if i != p && i != q {
                        let (x, y) = (i.min(p) * n + i.max(p), i.min(q) * n + i.max(q));
                        let (b, c) = (a[x], a[y]);
                        a[x] = cosine.mul_add(b, -(sine * c));
                        a[y] = sine.mul_add(b, cosine * c);
                    }
                }
                for i in 0..n {
                    let (b, c) = (w[p * n + i], w[q * n + i]);
                    w[p * n + i] = cosine.mul_add(b, -(sine * c));
                    w[q * n + i] = sine.mul_add(b, cosine * c);
                }
            }
        }
    }
}

/// V = L^-T W^T, by columns: the vectors as rows of `v`.
#[inline(always)]
pub fn vectors<V: Vector>(n: usize, l: &[V], w: &[V], v: &mut [V]) {
    v.copy_from_slice(w);
    for i in (0..n).rev() {
        let inverse = V::splat(1.0) / l[i * n + i];
        for row in 0..n {
            let mut sum = v[row * n + i];
            for c in i + 1..n {
                sum = (-l[c * n + i]).mul_add(v[row * n + c], sum);
            }
            v[row * n + i] = sum * inverse;
        }
    }
}

/// A lower bound of the eigenvalues of M, by Gershgorin's circles; it may be negative.
#[inline(always)]
pub fn floor<V: Vector>(n: usize, m: &[V]) -> V {
    let mut floor = V::splat(f64::MAX);
    for i in 0..n {
        let mut beside = V::splat(0.0);
        for j in 0..n {
            if j != i {
                beside = beside + m[i * n + j].abs();
            }
        }
        floor = floor.min(m[i * n + i] * V::splat(1.0 - 1e-12) - beside * V::splat(1.0 + 1e-12));
    }
    floor
}

/// Sets the diagonal of V^T B V; a bound of the norm of what is beside it in the true product, for a B that is at most `off`
/// away. The squares of the norms of V are at most those given: the spectral one, and Frobenius' one.
#[inline(always)]
pub fn congruent<V: Vector>(
    n: usize,
    b: &[V],
    v: &[V],
    w: &mut [V],
    (norm, frobenius): (V, V),
    off: V,
    diagonal: &mut [V],
) -> V {
    let zero = V::splat(0.0);
    let (mut of_w, mut of_b) = (zero, zero);
    for x in b {
        of_b = x.mul_add(*x, of_b);
    }
    // The rows of W are those of V times B, which is symmetric.
    for row in 0..n {
        for j in 0..n {
            let mut sum = zero;
            for i in 0..n {
                sum = v[row * n + i].mul_add(b[i * n + j], sum);
            }
            w[row * n + j] = sum;
            of_w = sum.mul_add(sum, of_w);
        }
    }
    let mut beside = zero;
    for i in 0..n {
        for j in i..n {
            let mut sum = zero;
            for c in 0..n {
                sum = w[i * n + c].mul_add(v[j * n + c], sum);
            }
            match i == j {
                true => diagonal[i] = sum,
                false => beside = sum.mul_add(sum, beside),
            }
        }
    }
    // n rounded products and sums in each entry of W and of its product with V; sqrt(2), since one triangle stands for both.
    let gamma = V::splat(1.5 * n as f64 * U);
    let rounding = gamma * (frobenius.sqrt() * of_w.sqrt() + norm.sqrt() * (frobenius * of_b).sqrt()) + norm * off;
    ((beside + beside).sqrt() + rounding) * V::splat(1.01)
}
