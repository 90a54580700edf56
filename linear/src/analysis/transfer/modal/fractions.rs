//! H as a sum over poles, from the sum over modes. In: the modes and a pair of input and output. Out: poles and residues with
//! bounds, of a system that nothing damps or in which damping resists every motion that is not rigid. See
//! docs/method/transfer.md#sums-over-poles-of-modes.

use super::{ModalPair, ModalSum, Residues};
use crate::analysis::transfer::partial_fractions::{Given, Part, PartialFractions};
use crate::base::{Ball, Dd, larger, up};
use crate::kernel::complex::Complex;
use std::ops::RangeInclusive;

const UP: f64 = up::THOUSANDS;
/// The largest norm of X^T M X - 1.
const MOST_SKEW: f64 = 1e-3;
/// Residues of other sizes may lose digits to underflow that no bound accounts for; zero does not.
const SIZES: RangeInclusive<f64> = 1e-200..=1e200;

impl ModalSum {
    /// `None` where some motions are damped and others, besides rigid ones, are not, and where the frequencies of two undamped modes
    /// are not apart.
    pub fn fractions(&self, pair: &ModalPair) -> Option<PartialFractions> {
        let products = || pair.residues.iter().flat_map(|residues| &residues.products);
        let in_range = |x: &Dd| x.is_zero() || SIZES.contains(&x.hi.abs());
        if products().all(|x| x.is_zero()) || !products().all(in_range) {
            return None;
        }
        let undamped = self.c.iter().all(|c| c.is_zero()) && self.off.c.iter().all(|c| *c == 0.0);
        let beyond_critical = self.ratio.filter(|ratio| (*ratio - Ball::ONE).is_positive());
        let (list, free) = match undamped || beyond_critical.is_some() {
            true => self.of_true_modes(pair, beyond_critical)?,
            false => self.of_damped(pair)?,
        };
        let part = if undamped { part(pair) } else { Part::Both };
        PartialFractions::of_poles(list.into_iter(), free, pair.feed_through, part)
    }

    /// H as the sum over the true modes, of a system that nothing damps, or whose oscillations all have one damping ratio, above one.
    ///
    /// With y the coefficients of a true mode in the basis X, (k + E_K) y = lambda (1 + E_M) y: within
    /// d_i = (|E_K e_i| + |k_i| |E_M e_i|) / (1 - mu), mu >= |E_M|, of each k_i there is a true lambda, so exactly one if these
    /// intervals are disjoint, and with y^T (1 + E_M) y = 1
    ///
    ///   |y_j| <= (|E_K e_j| + |lambda| |E_M e_j|) / (|k_j - k_i| - d_i) / (1 - mu),   |1 - y_i| <= mu + sum y_j^2.
    ///
    /// Rigid motions have lambda = 0 exactly and are taken together, so they need no distance from each other.
    fn of_true_modes(&self, pair: &ModalPair, ratio: Option<Ball>) -> Option<(Vec<Given>, [Ball; 5])> {
        let (n, off) = (self.k.len(), &self.off);
        let (mu, reach) = self.reach()?;
        let eta = UP / (1.0 - mu);
        let mut doubts: Vec<Vec<f64>> = pair.residues.iter().map(|_| Vec::with_capacity(n)).collect();
        let seen: Vec<[Vec<f64>; 2]> = pair.residues.iter().map(sizes).collect();
        let mut others = vec![0.0; n];
        for i in 0..n {
            if self.rigid[i] {
                doubts.iter_mut().for_each(|doubts| doubts.push(0.0));
                continue;
            }
            let most = (self.k[i].hi.abs() + reach[i]) * UP;
            let mut square = 0.0;
            for j in (0..n).filter(|&j| j != i) {
                let gap = (self.k[j] - self.k[i]).hi.abs() * (1.0 - 1e-12) - reach[i];
                if gap.is_nan() || gap <= reach[j] * UP {
                    return None;
                }
                others[j] = (off.k[j] + most * off.m[j]) * eta / gap;
                square += others[j] * others[j];
            }
            others[i] = mu + square;
            for ((doubts, [p, b]), residues) in doubts.iter_mut().zip(&seen).zip(&pair.residues) {
                let of = |sizes: &[f64]| others.iter().zip(sizes).map(|(y, size)| y * size).sum::<f64>();
                let (of_p, of_b) = (of(p), of(b));
                doubts.push((p[i] * of_b + b[i] * of_p + of_p * of_b + residues.exact_slack[i]) * UP * UP);
            }
        }
        let mut list = Vec::with_capacity(n);
        for i in (0..n).filter(|&i| !self.rigid[i]) {
            let k = Ball::new(self.k[i], reach[i]);
            // 1 / (s^2 + k) = (1 / (s - z) - 1 / (s + z)) / 2z, and likewise with other roots
            let half = Ball::from(0.5);
            let products = |factor: Complex<Ball>| {
                let doubt = |which: usize| doubts[which][i];
                powers(pair, i, factor, doubt)
            };
            let of = |s: Complex<Dd>, loose: f64, factor: Complex<Ball>| Given {
                s,
                loose,
                products: products(factor),
                rest: [0.0; 5],
            };
            if let Some(ratio) = ratio.filter(|_| k.is_positive()) {
                let (omega, root) = (k.sqrt(), ((ratio - Ball::ONE) * (ratio + Ball::ONE)).sqrt());
                let factor = half / (omega * root);
                for (z, factor) in [(omega / (ratio + root), factor), (omega * (ratio + root), -factor)] {
                    list.push(of(Complex::new(-z.mid, Dd::ZERO), z.rad, Complex::real(factor)));
                }
            } else if k.is_positive() {
                let omega = k.sqrt();
                let factor = Complex::new(Ball::ZERO, -(half / omega));
                list.push(of(Complex::new(Dd::ZERO, omega.mid), omega.rad, factor));
            } else if k.is_negative() {
                let growth = (-k).sqrt();
                let factor = half / growth;
                list.push(of(Complex::new(growth.mid, Dd::ZERO), growth.rad, Complex::real(factor)));
                list.push(of(Complex::new(-growth.mid, Dd::ZERO), growth.rad, Complex::real(-factor)));
            } else {
                return None;
            }
        }
        let (free, _) = self.all_free(pair, &seen, &reach, mu)?;
        Some((list, free))
    }

    /// mu and the d_i above.
    fn reach(&self) -> Option<(f64, Vec<f64>)> {
        let off = &self.off;
        let mu = off.m.iter().map(|m| m * m).sum::<f64>().sqrt() * UP;
        if mu.is_nan() || mu > MOST_SKEW {
            return None;
        }
        let of = |i: usize| (off.k[i] + self.k[i].hi.abs() * off.m[i]) * UP / (1.0 - mu) * UP;
        Some((mu, (0..self.k.len()).map(of).collect()))
    }

    /// The sums over the rigid motions by power of s, and bounds of p . N and N . b of each of the residues.
    fn all_free(
        &self,
        pair: &ModalPair,
        seen: &[[Vec<f64>; 2]],
        reach: &[f64],
        mu: f64,
    ) -> Option<([Ball; 5], Vec<[f64; 2]>)> {
        let (mut free, mut sizes) = ([Ball::ZERO; 5], vec![[0.0; 2]; pair.residues.len()]);
        if self.rigid.contains(&true) {
            for ((residues, seen), sizes) in pair.residues.iter().zip(seen).zip(&mut sizes) {
                let (sum, both) = self.free(residues, seen, reach, mu)?;
                free[residues.power] = free[residues.power] + sum;
                *sizes = both;
            }
        }
        Some((free, sizes))
    }

    /// The sum of (p . x)(x . b) over the rigid motions, and bounds of the norms of p . x and x . b over them. Of such an x = X y,
    /// r of them, |y_j| <= |E_K e_j| / k_j / (1 - mu) beside the rigid ones of X, and in these the r columns y are orthonormal up
    /// to mu / (1 - mu) + r sum y_j^2.
    fn free(&self, residues: &Residues, [p, b]: &[Vec<f64>; 2], reach: &[f64], mu: f64) -> Option<(Ball, [f64; 2])> {
        let (mut sum, mut squares, mut own, mut beside) = (Ball::ZERO, 0.0, [0.0; 2], [0.0; 2]);
        for j in 0..p.len() {
            if self.rigid[j] {
                sum = sum + Ball::new(residues.products[j], residues.exact_slack[j]);
                own = [own[0] + p[j] * p[j], own[1] + b[j] * b[j]];
            } else {
                let least = self.k[j].hi.abs() - reach[j];
                if least.is_nan() || least <= 0.0 {
                    return None;
                }
                let y = self.off.k[j] / least * UP / (1.0 - mu);
                squares += y * y;
                beside = [beside[0] + y * p[j], beside[1] + y * b[j]];
            }
        }
        let count = self.rigid.iter().filter(|rigid| **rigid).count() as f64;
        let [p, b] = own.map(f64::sqrt);
        let [of_p, of_b] = beside.map(|y| y * count.sqrt());
        let skew = mu / (1.0 - mu) + count * squares;
        let sum = sum.widen((p * b * skew + (1.0 + skew) * (p * of_b + b * of_p) + of_p * of_b) * UP * UP);
        Some((sum, [p * (1.0 + skew) + of_p, b * (1.0 + skew) + of_b].map(|x| x * UP)))
    }

    /// With N the rigid motions, orthonormal by M, a column x_d of X becomes x_d - N a_d, a_d = N^T M x_d, so that K, C and M couple
    /// it to none of them: bounds of |a_d|. N is X y as above, so that |a_d| <= |y_d| + |y| |E_M e_d| for each.
    fn along_rigid(&self, reach: &[f64], mu: f64) -> Option<Vec<f64>> {
        let count = self.rigid.iter().filter(|rigid| **rigid).count() as f64;
        let of = |d: usize| {
            let least = self.k[d].hi.abs() - reach[d];
            let both = (self.off.k[d] / least + self.off.m[d]) * count.sqrt() * UP * UP / (1.0 - mu);
            if count == 0.0 || self.rigid[d] { Some(0.0) } else { (least > 0.0).then_some(both) }
        };
        (0..self.k.len()).map(of).collect()
    }

    /// D_i = s^2 + c_i s + k_i = (s - z)(s - z') with rounded z and z', and what that changes counts as part of epsilon. For s
    /// on the imaginary axis and half as far around as to the nearest pole, |s - z| >= |re z| / 2 and one of both distances is
    /// at least |z - z'| / 2, so that V is bounded, and 1 / |D_i| <= 2 / |z - z'| (1 / |s - z| + 1 / |s - z'|).
    ///
    /// Rigid motions, which nothing damps, are a sum by themselves, and the other modes are taken [without them](Self::along_rigid).
    fn of_damped(&self, pair: &ModalPair) -> Option<(Vec<Given>, [Ball; 5])> {
        if !self.is_undragged {
            return None;
        }
        let n = self.k.len();
        let (mu, reach) = self.reach()?;
        let along = self.along_rigid(&reach, mu)?;
        let seen: Vec<[Vec<f64>; 2]> = pair.residues.iter().map(sizes).collect();
        let (free, of_rigid) = self.all_free(pair, &seen, &reach, mu)?;
        let mut roots = Vec::with_capacity(n);
        let (mut rounded, mut v) = (0.0, 0.0);
        for i in 0..n {
            if self.rigid[i] {
                roots.push(([Complex::ZERO; 2], true, Complex::ZERO, 0.0));
                continue;
            }
            let (k, c) = (self.k[i], self.c[i]);
            let (half, sizes) = (c.scale(0.5), (self.k_size[i], self.c_size[i]));
            let below = half * half - k;
            let is_pair = below.hi < 0.0;
            let root = below.abs().sqrt();
            let roots_of = match is_pair {
                true => [Complex::new(-half, root), Complex::new(-half, -root)],
                false => {
                    let first = -(half + root);
                    [Complex::new(first, Dd::ZERO), Complex::new(k / first, Dd::ZERO)]
                }
            };
            let [z, other] = roots_of.map(Complex::to_ball);
            let (sum, product, between) = (z + other, z * other, z - other);
            let misses = [(Ball::exact(c) + sum.re, sizes.1), (Ball::exact(k) - product.re, sizes.0)];
            for (miss, size) in misses {
                rounded = larger(rounded, miss.magnitude() / size);
            }
            let largest = larger(z.magnitude(), other.magnitude());
            let least = z.re.mignitude().min(other.re.mignitude());
            let apart = larger(between.re.mignitude(), between.im.mignitude());
            if least.is_nan() || least <= 0.0 || apart <= 0.0 || z.re.is_positive() || other.re.is_positive() {
                return None;
            }
            let (near, far) = (1.0 + 2.0 * largest / least, 1.0 + 2.0 * largest / apart);
            v += near * far + sizes.1 * near * (2.0 / apart) + sizes.0 * (2.0 / least) * (2.0 / apart);
            roots.push((roots_of, is_pair, Complex::real(Ball::ONE) / between, 2.0 / apart));
        }
        let most_along = along.iter().fold(0.0, |most, &a| larger(most, a));
        let epsilon = (self.epsilon + 2.0 * rounded + most_along * most_along) * UP;
        let contraction = epsilon * v * UP * UP;
        if contraction.is_nan() || contraction > 0.5 {
            return None;
        }
        let rest = contraction / (1.0 - contraction) * UP;
        // |p . x|^2 and |x . b|^2 without the rigid motions, and what that changes of the products.
        let square = |which: usize, part: usize, i: usize| {
            let size = seen[which][part][i] + of_rigid[which][part] * along[i];
            size * size * UP
        };
        let change = |which: usize, i: usize| {
            let [p, b] = [0, 1].map(|part| of_rigid[which][part] * along[i]);
            (p * seen[which][1][i] + b * seen[which][0][i] + p * b) * UP
        };
        let squares: Vec<[Vec<f64>; 2]> =
            (0..seen.len()).map(|which| [0, 1].map(|part| (0..n).map(|i| square(which, part, i)).collect())).collect();
        let weights: Vec<[f64; 2]> = squares.iter().map(|squares| balance(squares, &roots)).collect();
        let mut list = Vec::with_capacity(n);
        for (i, (roots, is_pair, factor, apart)) in roots.iter().enumerate().filter(|(i, _)| !self.rigid[*i]) {
            let mut rests = [0.0; 5];
            for ((residues, squares), [of_p, of_b]) in pair.residues.iter().zip(&squares).zip(&weights) {
                let both = of_p * squares[0][i] + of_b * squares[1][i];
                rests[residues.power] += rest * 0.5 * both * apart * UP;
            }
            let of = |s: Complex<Dd>, factor: Complex<Ball>| {
                let doubt = |which: usize| (pair.residues[which].exact_slack[i] + change(which, i)) * UP;
                Given { s, loose: 0.0, products: powers(pair, i, factor, doubt), rest: rests }
            };
            list.push(of(roots[0], *factor));
            if !is_pair {
                list.push(of(roots[1], -*factor));
            }
        }
        Some((list, free))
    }
}

type Roots = ([Complex<Dd>; 2], bool, Complex<Ball>, f64);

/// l and 1 / l such that (l P + B / l) / 2, a bound of the root of P B, is the least of these where both are largest.
fn balance(squares: &[Vec<f64>; 2], roots: &[Roots]) -> [f64; 2] {
    let sum = |squares: &[f64]| squares.iter().zip(roots).map(|(square, root)| square * root.3).sum::<f64>();
    let (p, b) = (sum(&squares[0]), sum(&squares[1]));
    if p == 0.0 || b == 0.0 { [0.0; 2] } else { [(b / p).sqrt() * UP, (p / b).sqrt() * UP] }
}

/// |p . x_i| and |x_i . b|
fn sizes(residues: &Residues) -> [Vec<f64>; 2] {
    [&residues.p_square, &residues.b_square].map(|squares| squares.iter().map(|square| square.sqrt() * UP).collect())
}

/// The products of a mode times a factor, by power of s.
fn powers(pair: &ModalPair, mode: usize, factor: Complex<Ball>, doubt: impl Fn(usize) -> f64) -> [Complex<Ball>; 5] {
    let mut products = [Complex::<Ball>::ZERO; 5];
    for (which, residues) in pair.residues.iter().enumerate() {
        let product = Ball::new(residues.products[mode], doubt(which));
        let at = &mut products[residues.power];
        *at = *at + factor.scale(product);
    }
    products
}

/// Without damping H is real if all powers of s are even, and imaginary if they are odd.
fn part(pair: &ModalPair) -> Part {
    let through = pair.feed_through.iter().enumerate().filter(|(_, d)| !d.is_zero()).map(|(power, _)| power);
    let powers: Vec<usize> = pair.residues.iter().map(|residues| residues.power).chain(through).collect();
    match powers.iter().map(|power| power % 2).sum::<usize>() {
        0 => Part::Real,
        odd if odd == powers.len() => Part::Imaginary,
        _ => Part::Both,
    }
}

#[cfg(test)]
mod extremes;
#[cfg(test)]
mod single_bounds;
#[cfg(test)]
mod tests;
