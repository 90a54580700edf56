//! The eigenvalues of a diagonal matrix plus a rank-one term, diag(d) + r z z^T, r > 0, d ascending: the zeros of
//!
//!   f(x) = 1/r + sum_j z_j^2 / (d_j - x),
//!
//! one between each two neighbours and one above the last. Each is computed as its distance from the nearer of its two
//! poles, so that all d_j - x keep their digits. Steps follow Li's middle way (LAPACK Working Note 89, 1993; `dlaed4`),
//! kept inside a bracket.

use crate::kernel::simd::{LANES, simd};

/// A zero: `origin` is the index of its nearer pole.
#[derive(Clone, Copy, Debug)]
pub struct Zero {
    pub origin: usize,
    pub distance: f64,
}

/// Most steps converge quadratically; any other one halves the bracket.
const MAX_STEPS: usize = 120;

/// Sums of z^2/(d - x) and z^2/(d - x)^2, over the poles up to a given one and over those beyond it.
#[derive(Clone, Copy)]
struct Sums {
    below: f64,
    below_slope: f64,
    above: f64,
    above_slope: f64,
}

/// Computes zero number `i`. `d` is ascending without repetitions; `squares` are the z_j^2, none of them zero. `delta`
/// receives d_j - x.
pub fn zero(d: &[f64], squares: &[f64], r: f64, i: usize, delta: &mut [f64]) -> Zero {
    let k = d.len();
    let whole: f64 = squares.iter().sum();
    let last = i + 1 == k;
    let width = if last { r * whole } else { d[i + 1] - d[i] };
    let shifted = |origin: usize, x: f64, delta: &mut [f64]| shift(d, d[origin], x, delta);
    shifted(i, 0.5 * width, delta);
    let middle = value(&sums(delta, squares, i), r);
    // f increases from the lower pole to the upper one.
    let (origin, mut low, mut high) = match last || middle >= 0.0 {
        true => (i, 0.0, if last && middle < 0.0 { width * (1.0 + 1e-15) } else { 0.5 * width }),
        false => (i + 1, -0.5 * width, 0.0),
    };
    if last && middle < 0.0 {
        low = 0.5 * width;
    }
    let poles = if last { (i.saturating_sub(1), i) } else { (i, i + 1) };
    let mut x = first_guess(delta, squares, r, i, poles, d[origin] - d[i], 0.5 * width);
    for _ in 0..MAX_STEPS {
        if x.is_nan() || x <= low || x >= high {
            x = middle_between(low, high);
        }
        shifted(origin, x, delta);
        let sums = sums(delta, squares, if last { poles.0 } else { i });
        let f = value(&sums, r);
        let size = 1.0 / r + sums.below.abs() + sums.above.abs();
        if f.abs() <= (k as f64 / LANES as f64 + 8.0) * f64::EPSILON * size {
            break;
        }
        if f < 0.0 {
            low = x
        } else {
            high = x
        }
        if high - low <= 2.0 * f64::EPSILON * low.abs().min(high.abs()) {
            break;
        }
        let step = middle_way(&sums, f, delta[poles.0], delta[poles.1], poles.0 == poles.1);
        x += step;
        if step.is_nan() || x + step == x {
            x = middle_between(low, high);
        }
    }
    Zero { origin, distance: x }
}

/// A number between two of one sign (or zero): the geometric middle if they are far apart.
fn middle_between(low: f64, high: f64) -> f64 {
    let (near, far) = if low >= 0.0 { (low, high) } else { (-high, -low) };
    let size = match near > 0.0 && far > 4.0 * near {
        true => near.sqrt() * far.sqrt(),
        false if near == 0.0 => far * 1e-3,
        false => 0.5 * (near + far),
    };
    if low >= 0.0 { size } else { -size }
}

fn value(sums: &Sums, r: f64) -> f64 {
    1.0 / r + sums.below + sums.above
}

/// The zero for the two nearest poles, with the others' contribution taken at the middle of the interval (to which
/// `delta` belongs).
fn first_guess(
    delta: &[f64],
    squares: &[f64],
    r: f64,
    i: usize,
    (p, q): (usize, usize),
    origin: f64,
    middle: f64,
) -> f64 {
    if p == q {
        return squares[i] * r;
    }
    let rest = value(&sums(delta, squares, i), r) - squares[p] / delta[p] - squares[q] / delta[q];
    // rest + a/(dp - x) + b/(dq - x) = 0, with the poles relative to the origin.
    let (dp, dq) = (delta[p] + middle - origin, delta[q] + middle - origin);
    let (a, b) = (squares[p], squares[q]);
    // rest x^2 - (rest (dp + dq) + a + b) x + rest dp dq + a dq + b dp = 0
    let half = 0.5 * (rest * (dp + dq) + a + b);
    let product = rest * dp * dq + a * dq + b * dp;
    let root = (half * half - rest * product).abs().sqrt();
    // The one of the two zeros that is nearer to the origin.
    if half > 0.0 { product / (half + root) } else { (half - root) / rest }
}

/// The step to the zero of c + s/(d_p - x) + t/(d_q - x), which matches f's value and both sums' slopes here.
fn middle_way(sums: &Sums, f: f64, p: f64, q: f64, single: bool) -> f64 {
    if single {
        return -f / (sums.below_slope + sums.above_slope);
    }
    let c = f - p * sums.below_slope - q * sums.above_slope;
    let a = (p + q) * f - p * q * (sums.below_slope + sums.above_slope);
    let b = p * q * f;
    let root = (a * a - 4.0 * b * c).abs().sqrt();
    let inside = p * q < 0.0;
    match (inside, a <= 0.0) {
        // Between the poles, the zero of the model lies where its denominators do not change sign.
        (true, true) => (a - root) / (2.0 * c),
        (true, false) => 2.0 * b / (a + root),
        (false, true) => 2.0 * b / (a - root),
        (false, false) => (a + root) / (2.0 * c),
    }
}

simd! {
    /// delta_j = (d_j - d_origin) - x
    fn shift<V: Eight>(d: &[f64], origin: f64, x: f64, delta: &mut [f64]) {
        let length = d.len().min(delta.len());
        let (d, delta) = (&d[..length], &mut delta[..length]);
        let whole = length / LANES * LANES;
        for i in (0..whole).step_by(LANES) {
            (V::load(&d[i..]) - V::splat(origin) - V::splat(x)).store(&mut delta[i..]);
        }
        for i in whole..length {
            delta[i] = (d[i] - origin) - x;
        }
    }
}

fn sums(delta: &[f64], squares: &[f64], split: usize) -> Sums {
    let (below, below_slope) = side(&delta[..=split], &squares[..=split]);
    let (above, above_slope) = side(&delta[split + 1..], &squares[split + 1..]);
    Sums { below, below_slope, above, above_slope }
}

simd! {
    /// sum z^2/delta and sum z^2/delta^2
    fn side<V: Eight>(delta: &[f64], squares: &[f64]) -> (f64, f64) {
        let (mut sum, mut slope) = (V::splat(0.0), V::splat(0.0));
        let length = delta.len().min(squares.len());
        let (delta, squares) = (&delta[..length], &squares[..length]);
        let whole = length / LANES * LANES;
        let (mut rest, mut rest_slope) = (0.0, 0.0);
        for i in whole..length {
            let part = squares[i] / delta[i];
            (rest, rest_slope) = (rest + part, rest_slope + part / delta[i]);
        }
        for i in (0..whole).step_by(LANES) {
            let one = V::splat(1.0) / V::load(&delta[i..]);
            let part = V::load(&squares[i..]) * one;
            (sum, slope) = (sum + part, part.mul_add(one, slope));
        }
        (sum.sum() + rest, slope.sum() + rest_slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_lie_between_the_poles_and_add_up() {
        // The trace: sum of zeros = sum of poles + r |z|^2.
        for spread in [1.0f64, 1e-9, 1e6] {
            let k = 41;
            let d: Vec<f64> = (0..k).map(|j| j as f64 + (j * j % 7) as f64 * 0.1 * spread.min(1.0)).collect();
            let squares: Vec<f64> = (0..k).map(|j| spread * (1 + j * 13 % 5) as f64 * 1e-3).collect();
            let (mut delta, r) = (vec![0.0; k], 2.0);
            let mut sum = 0.0;
            for i in 0..k {
                let zero = zero(&d, &squares, r, i, &mut delta);
                let x = d[zero.origin] + zero.distance;
                assert!(x >= d[i] && (i + 1 == k || x <= d[i + 1]), "{spread}: {i} {x}");
                assert!((0..k).all(|j| (delta[j] < 0.0) == (j <= i)));
                sum += x - d[i];
            }
            let truth = r * squares.iter().sum::<f64>();
            assert!((sum - truth).abs() <= 1e-12 * (truth + d[k - 1]), "{spread}: {sum} {truth}");
        }
    }
}
