//! Eigenvalues of diag(d) + rho g g^T for many rho side by side, one in each lane, with a proved bound of their errors. In: the poles d,
//! ascending, and the squares of g, none of them zero. Out: for each rho > 0 the lowest eigenvalues: the roots x of
//!
//!   f(x) = 1 + rho sum_j g_j^2 / (d_j - x),
//!
//! of which each lies between two neighbouring poles, the last above all (Golub, SIAM Review 15, 1973, 318-334). A root is found as its
//! distance from the nearer pole, so that no difference cancels (Gu and Eisenstat, SIAM J. Matrix Anal. Appl. 16, 1995, 172-191).
//! See docs/method/studies.md#one-weight.

use crate::base::Dd;
use crate::kernel::bounded::Bounded;
use crate::kernel::simd::{Vector, simd};

/// The unit roundoff.
const U: f64 = f64::EPSILON / 2.0;

/// A matrix diag(d) + rho g g^T with any rho.
#[derive(Clone, Debug)]
pub struct Secular {
    /// Ascending, each less than the next.
    poles: Vec<Dd>,
    /// The squares of g, each within 2 U of the true one.
    squares: Vec<f64>,
    /// d_j - d_i at i m + j, each within 2 U of the true one.
    apart: Vec<f64>,
}

/// A factor of the square, positive, and a bound of its relative error.
#[derive(Clone, Copy, Debug)]
pub struct Factor {
    rho: f64,
    error: f64,
}

impl Factor {
    /// No eigenvalue is proved for a factor that is not positive, of no usual size, or not known well.
    #[inline]
    pub fn new(rho: f64, error: f64) -> Factor {
        let is_usual = USUAL.contains(&rho) && (0.0..1e-3).contains(&error);
        Factor { rho: if is_usual { rho } else { f64::NAN }, error }
    }
}

impl Secular {
    /// `None` if poles are not ascending, squares are not positive, or numbers have no size at which nothing underflows or overflows.
    pub fn new(poles: Vec<Dd>, squares: Vec<f64>) -> Option<Secular> {
        let m = poles.len();
        let apart: Vec<f64> = (0..m * m).map(|at| (poles[at % m] - poles[at / m]).to_f64()).collect();
        let is_usual = |x: &f64| USUAL.contains(x);
        let fits = squares.len() == m
            && squares.iter().all(is_usual)
            && (1..m).all(|i| apart[(i - 1) * m + i] > 0.0)
            && apart.iter().all(|x| *x == 0.0 || is_usual(&x.abs()))
            && poles.iter().all(|pole| pole.is_finite() && pole.hi.abs() < USUAL.end);
        fits.then_some(Secular { poles, squares, apart })
    }

    pub fn len(&self) -> usize {
        self.poles.len()
    }

    pub fn is_empty(&self) -> bool {
        self.poles.is_empty()
    }

    /// The `count` lowest eigenvalues for each factor, ascending, with bounds of their errors; NaN where none is proved.
    pub fn lowest(&self, count: usize, factors: &[Factor]) -> Bounded {
        let mut found = Bounded::unknown(count.min(self.len()), factors.len());
        match self.len() {
            2 => roots(self, [(); 2], factors, &mut found),
            _ => roots(self, [], factors, &mut found),
        }
        found
    }
}

/// Sizes at which no product or quotient of a few numbers overflows, and none that underflows matters.
const USUAL: std::ops::Range<f64> = 1e-70..1e70;

/// Steps of an iteration: it converges quadratically, and each step that leaves the interval halves it.
const MOST_STEPS: usize = 40;

/// Sums over poles at x: of rho g^2 / (d - x), which is negative for poles below x and positive above, and of the derivatives.
#[derive(Clone, Copy)]
struct Sums<V> {
    below: V,
    above: V,
    slope_below: V,
    slope_above: V,
}

/// A root between two poles: which one is its origin in each lane (1 or 0), and the poles' distances from both.
struct Origin<'a, V> {
    is_left: V,
    is_right: V,
    from_left: &'a [f64],
    from_right: &'a [f64],
}

#[inline(always)]
fn sums<V: Vector>(squares: &[f64], split: usize, origin: &Origin<V>, tau: V, rho: V) -> Sums<V> {
    let (below, slope_below) = part(squares, 0..split, origin, tau);
    let (above, slope_above) = part(squares, split..squares.len(), origin, tau);
    Sums { below: below * rho, above: above * rho, slope_below: slope_below * rho, slope_above: slope_above * rho }
}

/// The sum over some poles, and its derivative.
#[inline(always)]
fn part<V: Vector>(squares: &[f64], poles: std::ops::Range<usize>, origin: &Origin<V>, tau: V) -> (V, V) {
    let (mut sum, mut slope) = (V::splat(0.0), V::splat(0.0));
    for j in poles {
        // One of the two products is zero, so that the sum is exact.
        let right = origin.is_right * V::splat(origin.from_right[j]);
        let distance = origin.is_left.mul_add(V::splat(origin.from_left[j]), right) - tau;
        let inverse = V::splat(1.0) / distance;
        let term = V::splat(squares[j]) * inverse;
        sum = sum + term;
        slope = term.mul_add(inverse, slope);
    }
    (sum, slope)
}

/// A root of c y^2 - a y + b without cancellation: (a - d) / 2c with the square root d of the discriminant, or (a + d) / 2c.
#[inline(always)]
fn quadratic<V: Vector>(a: V, b: V, c: V, is_other: bool) -> V {
    let zero = V::splat(0.0);
    let disc = (V::splat(-4.0) * b).mul_add(c, a * a).max(zero).sqrt();
    let disc = if is_other { -disc } else { disc };
    // Where a and d have one sign, their sum is safe.
    let is_sum = if is_other { -a } else { a };
    let above = is_sum.if_exceeds(zero, b + b, a - disc);
    let below = is_sum.if_exceeds(zero, a + disc, c + c);
    above / below
}

simd! {
    /// For `M` poles, or any number of them if that is zero.
    fn roots<V: Vector, const M: usize>(of: &Secular, _poles: [(); M], factors: &[Factor], found: &mut Bounded) {
        let (m, zero, one) = (if M > 0 { M } else { of.poles.len() }, V::splat(0.0), V::splat(1.0));
        let (squares, poles) = (&of.squares[..m], &of.poles[..m]);
        let count = found.count();
        let mut lanes = [0.0; crate::kernel::simd::MOST];
        let total = squares.iter().sum::<f64>();
        for (block, factors) in factors.chunks(V::WIDTH).enumerate() {
            lanes.fill(factors[0].rho);
            for (lane, factor) in lanes.iter_mut().zip(factors) {
                *lane = factor.rho;
            }
            let rho = V::load(&lanes);
            lanes.fill(factors[0].error);
            for (lane, factor) in lanes.iter_mut().zip(factors) {
                *lane = factor.error;
            }
            let error = V::load(&lanes);
            // Each term has a relative error of 9 U at most: 2 of the square, 5 of the difference of the distance and tau (the distance,
            // known within 2 U, is at most twice the difference), 2 of the quotient and the product. The sum of m terms adds m U.
            let noise = error + V::splat((m as f64 + 16.0) * U * 1.01);
            for i in 0..count {
                let is_last = i + 1 == m;
                let from_left = &of.apart[i * m..(i + 1) * m];
                let (gap, from_right) = match is_last {
                    true => (V::splat(0.0), from_left),
                    false => (V::splat(from_left[i + 1]), &of.apart[(i + 1) * m..(i + 2) * m]),
                };
                let mut origin = Origin { is_left: one, is_right: zero, from_left, from_right };
                let (mut low, mut high, mut tau);
                if is_last {
                    // Where rho g^T g is added, f is not negative.
                    let most = rho * V::splat(total * (1.0 + (m as f64 + 8.0) * U));
                    (low, high, tau) = (zero, most, most);
                    if m > 1 {
                        // The two upper poles exactly, and all others as at that place.
                        let gap = V::splat(from_left[i - 1].abs());
                        let (s, t) = (rho * V::splat(squares[i - 1]), rho * V::splat(squares[i]));
                        let rest = one + rho * part(squares, 0..i - 1, &origin, most).0;
                        tau = clamp_or_middle(quadratic((s + t) - rest * gap, -(t * gap), rest, true), zero, most);
                    }
                } else {
                    let half = gap * V::splat(0.5);
                    let at = sums(squares, i + 1, &origin, half, rho);
                    let value = one + (at.below + at.above);
                    origin.is_left = value.if_exceeds(zero, one, zero);
                    origin.is_right = one - origin.is_left;
                    let (s, t) = (rho * V::splat(squares[i]), rho * V::splat(squares[i + 1]));
                    // The poles on both sides exactly, and all others as at the middle.
                    let rest = value + (s - t) / half;
                    let whole = rest * gap;
                    let a = origin.is_left.if_exceeds(zero, whole, -whole) + (s + t);
                    let b = origin.is_left.if_exceeds(zero, s * gap, -(t * gap));
                    low = origin.is_left.if_exceeds(zero, zero, -half);
                    high = origin.is_left.if_exceeds(zero, half, zero);
                    tau = clamp_or_middle(quadratic(a, b, rest, false), low, high);
                }
                let (mut open, mut reach) = (one, V::splat(f64::INFINITY));
                // Above the last root there is no pole: its own takes the place of the upper one, and the one before that of the lower.
                let split = if is_last { i } else { i + 1 };
                for _ in 0..MOST_STEPS {
                    let at = sums(squares, split, &origin, tau, rho);
                    let (sum, slope) = (at.below + at.above, at.slope_below + at.slope_above);
                    let value = one + sum;
                    let sizes = if is_last { -sum } else { at.above - at.below };
                    let off = sizes.mul_add(noise, V::splat(4.0 * U));
                    reach = open.if_exceeds(zero, (value.abs() + off) / slope, reach);
                    open = value.abs().if_exceeds(off, open, zero);
                    if open.exceeds(zero) == 0 {
                        break;
                    }
                    low = value.if_exceeds(zero, low, tau);
                    high = value.if_exceeds(zero, tau, high);
                    let step = if m == 1 {
                        // One pole alone, exactly.
                        sum * value / slope
                    } else {
                        // The middle way (Li, LAPACK Working Note 89, 1993).
                        let (left, right) = match is_last {
                            true => (V::splat(from_left[i - 1]) - tau, -tau),
                            false => (-tau - origin.is_right * gap, origin.is_left * gap - tau),
                        };
                        let product = left * right;
                        let a = (left + right) * value - product * slope;
                        let c = value - left * at.slope_below - right * at.slope_above;
                        quadratic(a, product * value, c, is_last)
                    };
                    tau = open.if_exceeds(zero, clamp_or_middle(tau + step, low, high), tau);
                }
                // Where the steps did not suffice, tau is not where f was last computed.
                reach = open.if_exceeds(zero, V::splat(f64::NAN), reach);
                // f rises by at least 0.97 of its slope here times the distance, as long as that is small beside the nearest pole's.
                let bound = reach * V::splat(1.05);
                let is_near = (tau.abs() * V::splat(0.01)).if_exceeds(bound, zero, V::splat(f64::NAN));
                let [near, far] = [&poles[i], &poles[if is_last { i } else { i + 1 }]];
                let high_word = origin.is_left.if_exceeds(zero, V::splat(near.hi), V::splat(far.hi));
                let low_word = origin.is_left.if_exceeds(zero, V::splat(near.lo), V::splat(far.lo));
                let root = high_word + (low_word + tau);
                let bound = (bound + (root.abs() + tau.abs()) * V::splat(2.0 * U)) * V::splat(1.0 + 8.0 * U) + is_near;
                let (roots, bounds) = found.whole_lanes(i);
                root.store(&mut roots[block * V::WIDTH..]);
                bound.store(&mut bounds[block * V::WIDTH..]);
            }
        }
    }
}

/// A number if it lies between two others, else their middle.
#[inline(always)]
fn clamp_or_middle<V: Vector>(x: V, low: V, high: V) -> V {
    let middle = (low + high) * V::splat(0.5);
    x.if_exceeds(low, high.if_exceeds(x, x, middle), middle)
}
