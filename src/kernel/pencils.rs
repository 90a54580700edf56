//! Eigenvalues of many small symmetric pencils K - lambda M side by side, one in each lane, with a bound of their errors. In: matrices
//! that depend linearly on one number. Out: for each number the eigenvalues, or nothing where M is not certainly positive definite.
//! See docs/method/studies.md#many-small-pencils.

use crate::base::Ball;
use crate::kernel::simd::{Vector, simd};

/// The most coordinates: larger pencils are reduced faster by other means.
pub const MOST: usize = 16;

/// The unit roundoff.
const U: f64 = f64::EPSILON / 2.0;

/// K(d) = `k[0]` + d `k[1]` and M(d) alike; symmetric, row by row.
#[derive(Clone, Debug)]
pub struct Line {
    pub n: usize,
    k: [Vec<f64>; 2],
    m: [Vec<f64>; 2],
    /// Bounds of the distance (Frobenius) of the true K and M at d from the computed ones: the first and |d| times the second.
    off: [[f64; 2]; 2],
}

/// The eigenvalues of one pencil.
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenvalues {
    /// Ascending.
    pub list: Vec<f64>,
    /// Bounds of their errors, each of the one with the same place in ascending order.
    pub bounds: Vec<f64>,
}

impl Line {
    /// From enclosures of both parts of both matrices. `None` if the numbers are not of a size at which nothing underflows.
    pub fn new(n: usize, k: [&[Vec<Ball>]; 2], m: [&[Vec<Ball>]; 2], most: f64) -> Option<Line> {
        let mass = |i: usize| {
            m.map(|part| part[i][i].magnitude()).into_iter().zip([1.0, most]).map(|(x, d)| x * d).sum::<f64>()
        };
        let scale: Vec<f64> = (0..n).map(|i| power_near(mass(i).sqrt())).collect::<Option<_>>()?;
        let split = |part: &[Vec<Ball>], d: f64| {
            let (mut numbers, mut off, mut size) = (Vec::with_capacity(n * n), 0.0, 0.0);
            for at in 0..n * n {
                let entry = times_power(part[at / n][at % n], scale[at / n] * scale[at % n]);
                let rounded = entry.to_f64();
                let away = (entry - Ball::from(rounded)).magnitude();
                off += away * away;
                size += rounded * rounded;
                numbers.push(rounded);
            }
            let (off, size) = (root(off), root(size));
            let is_usual = size * d == 0.0 || is_usual(size) && is_usual(size * d);
            // The rounding of d, and that of each entry at d.
            let off = (off + ROUNDING_OF_D * (size + off) + 2.0 * U * size) * 1.001 + UNDERFLOW;
            is_usual.then_some((numbers, off))
        };
        let parts = |[first, slope]: [&[Vec<Ball>]; 2]| Some((split(first, 1.0)?, split(slope, most)?));
        let (((k0, a), (k1, b)), ((m0, c), (m1, d))) = (parts(k)?, parts(m)?);
        Some(Line { n, k: [k0, k1], m: [m0, m1], off: [[a, b], [c, d]] })
    }

    /// The eigenvalues for each d, which may be [`ROUNDING_OF_D`] off; `None` where they are not certain.
    pub fn eigenvalues(&self, d: &[f64]) -> Vec<Option<Eigenvalues>> {
        let n = self.n;
        let mut found = vec![0.0; d.len() * (n + 1) * 2];
        all(n, [&self.k[0], &self.k[1], &self.m[0], &self.m[1]], self.off, d, &mut found);
        found.chunks(2 * (n + 1)).map(|numbers| sort(n, numbers)).collect()
    }
}

/// Quotients of the diagonals and what limits their errors, put in order.
fn sort(n: usize, numbers: &[f64]) -> Option<Eigenvalues> {
    let (off_t, off_s, least) = (numbers[n], numbers[n + 1], numbers[n + 2]);
    let room = (least - off_s) * (1.0 - 4.0 * U);
    // NaN, of a factor that does not exist, fails too.
    if !(room > 0.5 * least && off_t.is_finite() && numbers[..n].iter().all(|x| x.is_finite())) {
        return None;
    }
    let mut list = numbers[..n].to_vec();
    list.sort_by(f64::total_cmp);
    let bound = |x: &f64| ((off_t + x.abs() * off_s) / room + 2.0 * U * x.abs()) * (1.0 + 16.0 * U);
    Some(Eigenvalues { bounds: list.iter().map(bound).collect(), list })
}

/// The relative error that d may have.
pub const ROUNDING_OF_D: f64 = 4.0 * U;

/// Whether squares and products of numbers of this size neither overflow nor matter where they underflow.
pub fn is_usual(x: f64) -> bool {
    (1e-100..1e100).contains(&x)
}

/// 1 / x as a power of two; `None` outside the usual sizes.
fn power_near(x: f64) -> Option<f64> {
    const EXPONENT: u64 = 0x7ff0_0000_0000_0000;
    is_usual(x).then(|| 1.0 / f64::from_bits(x.to_bits() & EXPONENT))
}

/// x times a power of two.
fn times_power(x: Ball, power: f64) -> Ball {
    Ball::new(x.mid.scale(power), x.rad * power).widen(UNDERFLOW)
}

/// More than what squares that underflow leave out of a norm.
const UNDERFLOW: f64 = 1e-140;

/// A square root, not below the true one.
fn root(x: f64) -> f64 {
    x.sqrt() * (1.0 + 4096.0 * U)
}

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

simd! {
    /// For each d, `n` quotients, then bounds of what is beside both diagonals, and the least entry of that of M.
    fn all<V: Vector>(n: usize, parts: [&[f64]; 4], off: [[f64; 2]; 2], d: &[f64], found: &mut [f64]) {
        let room = || vec![V::splat(0.0); n * n];
        let (mut k, mut m, mut a, mut l, mut v, mut w) = (room(), room(), room(), room(), room(), room());
        let mut lanes = vec![0.0; V::WIDTH];
        for (ds, out) in d.chunks(V::WIDTH).zip(found.chunks_mut(2 * (n + 1) * V::WIDTH)) {
            lanes.fill(ds[0]);
            lanes[..ds.len()].copy_from_slice(ds);
            let at = V::load(&lanes);
            let off_at = |[first, slope]: [f64; 2]| at.abs().mul_add(V::splat(slope), V::splat(first));
            for i in 0..n * n {
                k[i] = V::splat(parts[1][i]).mul_add(at, V::splat(parts[0][i]));
                m[i] = V::splat(parts[3][i]).mul_add(at, V::splat(parts[2][i]));
            }
            reduce(n, &k, &m, &mut l, &mut a);
            turn(n, &mut a, &mut w);
            vectors(n, &l, &w, &mut v);
            let (mut of_v, mut most) = (V::splat(0.0), V::splat(0.0));
            for x in &v {
                of_v = x.mul_add(*x, of_v);
            }
            of_v = of_v * V::splat(1.001);
            let off_m = off_at(off[1]);
            let (s, beside_s) = congruent(n, &m, &v, &mut w, (of_v, of_v), off_m);
            let mut least = V::splat(f64::MAX);
            for x in &s {
                (least, most) = (least.min(*x), most.max(*x));
            }
            // |V|^2 is at most |V^T M V| / min x^T M x, and at most its Frobenius norm.
            let floor = (floor(n, &m) - off_m).max(V::splat(1e-290));
            let norm = of_v.min((most + beside_s) * V::splat(1.001) / floor);
            let (diagonal, beside_t) = congruent(n, &k, &v, &mut w, (norm, of_v), off_at(off[0]));
            let mut put = |place: usize, x: V| {
                let x = x.to_array();
                for (lane, row) in out.chunks_mut(2 * (n + 1)).enumerate() {
                    row[place] = x[lane];
                }
            };
            for i in 0..n {
                put(i, diagonal[i] / s[i]);
            }
            put(n, beside_t);
            put(n + 1, beside_s);
            // `min` passes over NaN; a sum does not, nor does its product with 0.
            let sum = s.iter().fold(V::splat(0.0), |sum, x| sum + *x);
            put(n + 2, sum.mul_add(V::splat(0.0), least));
        }
    }
}

/// M = L L^T and A = L^-1 K L^-T.
#[inline(always)]
fn reduce<V: Vector>(n: usize, k: &[V], m: &[V], l: &mut [V], a: &mut [V]) {
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
fn turn<V: Vector>(n: usize, a: &mut [V], w: &mut [V]) {
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
fn vectors<V: Vector>(n: usize, l: &[V], w: &[V], v: &mut [V]) {
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
fn floor<V: Vector>(n: usize, m: &[V]) -> V {
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

/// The diagonal of V^T B V, and a bound of the norm of what is beside it in the true product, for a B that is at most `off`
/// away. The squares of the norms of V are at most those given: the spectral one, and Frobenius' one.
#[inline(always)]
fn congruent<V: Vector>(n: usize, b: &[V], v: &[V], w: &mut [V], (norm, frobenius): (V, V), off: V) -> (Vec<V>, V) {
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
    let (mut diagonal, mut beside) = (vec![zero; n], zero);
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
    let beside = ((beside + beside).sqrt() + rounding) * V::splat(1.01);
    (diagonal, beside)
}
