//! H over a range of frequencies that holds few of many poles, as a sum over the poles in and around the range and a sum over points
//! of an ellipse about them, which stands for all others. In: a system, a frequency up to which H is wanted. Out: such sums for pairs
//! of input and output, with bounds of what they and their derivatives are off by. See docs/method/transfer.md#a-range-of-many-poles.
//!
//! R, H without the summands of the poles in the outer ellipse, is analytic there: by Cauchy's formula it is an integral over an
//! inner ellipse, and the trapezoidal rule makes a sum over some of its points of it.

use super::partial_fractions::{Given, Part, PartialFractions};
use super::{Transfer, feed_through};
use crate::analysis::poles::targeted::around::{Around, Drag};
use crate::analysis::transfer::inverse::Entry;
use crate::base::{Ball, Dd, Number, Power, larger, up};
use crate::kernel::complex::Complex;
use crate::kernel::disc::Disc;
use crate::system::CoordinateId;

/// The number of points of the inner ellipse: as many as are needed for this relative error of the rule, if the most suffice.
const POINTS: [usize; 3] = [64, 128, 256];
const ENOUGH: f64 = 1e-26;
/// A pole must not be nearer to the axis than its uncertainty times this.
const CLEAR: f64 = 1e6;
const UP: f64 = up::MILLIONS;

/// What is prepared for all pairs.
pub struct Surroundings {
    around: Around,
    /// The inner ellipse: the sum of its semi-axes over `reach`, and its points in the first and fourth quarter turned to the upper
    /// half plane, with (u - 1 / u) / 2 of each.
    inner: f64,
    nodes: Vec<Node>,
    count: usize,
    /// p^T Q^-1 b at each point, `[point][input][output]`
    samples: Vec<Vec<Vec<Complex<Ball>>>>,
}

struct Node {
    s: Complex<Dd>,
    /// A bound of its distance from the ellipse's own point.
    off: f64,
    turn: Complex<Ball>,
}

impl Surroundings {
    /// For frequencies up to `reach`, rad/s.
    pub fn of(transfer: &Transfer, inputs: &[usize], outputs: &[usize], reach: f64) -> Option<Surroundings> {
        let around = Around::of(transfer.system, reach, transfer.drag(reach)?)?;
        let inner = around.rho.sqrt();
        let part = |&count: &usize| quadrature(&around, inner, count)[0];
        let count = POINTS.into_iter().find(|count| part(count) < ENOUGH).unwrap_or(POINTS[POINTS.len() - 1]);
        let nodes = nodes(reach, inner, count);
        let at = |node: &Node| transfer.beside_axis(node.s, inputs, outputs);
        let samples = nodes.iter().map(at).collect::<Option<Vec<_>>>()?;
        Some(Surroundings { around, inner, nodes, count, samples })
    }

    /// The poles in the ellipse, rad/s.
    pub fn poles(&self) -> impl Iterator<Item = Complex<Ball>> + '_ {
        self.around.poles.iter().map(|pole| pole.s)
    }

    /// H of one pair, given their places in the lists of inputs and outputs too; `None` if a bound is not finite.
    pub fn pair(
        &self,
        transfer: &Transfer,
        (i, input): (usize, usize),
        (o, output): (usize, usize),
    ) -> Option<PartialFractions> {
        let system = transfer.system;
        let (b, p) = (&system.inputs[input].b, &system.outputs[output].p);
        let (around, count) = (&self.around, self.count as f64);
        let residues: Vec<Complex<Ball>> = around.poles.iter().map(|pole| around.residue(pole, p, b)).collect();
        let mut list = Vec::with_capacity(around.poles.len() + self.nodes.len());
        let mut most = around.most(p, b);
        for (pole, r) in around.poles.iter().zip(&residues) {
            most += 2.0 * r.magnitude() / pole.clearance * UP;
            let mut products = [Complex::<Ball>::ZERO; 5];
            products[0] = *r;
            let mut given = Given { s: pole.s.mid(), loose: pole.s.radius(), products, rest: [0.0; 5] };
            if !pole.s.re.is_zero() {
                // |r / (s - s_j) - r / (s - z)| <= |r| |s_j - z| / |s - s_j| / |s - z|, and |s - s_j| is at least a quarter of |re z|
                // half as far around a point of the axis as to the nearest pole.
                let decay = pole.s.re.mignitude();
                if decay <= CLEAR * given.loose {
                    return None;
                }
                given.rest[0] = 4.0 * r.magnitude() * given.loose / decay * UP;
                given.loose = 0.0;
            }
            list.push(given);
        }
        let own = list.iter().map(|given| (given.s, given.products[0].mid())).collect::<Vec<_>>();
        let mut flat = quadrature(around, self.inner, self.count).map(|part| part * most);
        let gap = around.size - 0.5 * around.reach * (self.inner + 1.0 / self.inner);
        for (node, samples) in self.nodes.iter().zip(&self.samples) {
            let mut rest = samples[i][o];
            let mut doubt = 0.0;
            for ((z, r), (pole, residue)) in own.iter().zip(around.poles.iter().zip(&residues)) {
                for (z, r) in [(*z, *r), (z.conj(), r.conj())] {
                    let distance = (node.s - z).to_ball();
                    rest = rest - r.to_ball() / distance;
                    // What the true pole and the true residue change.
                    let far = (node.s - z).to_f64().abs() * (1.0 - 1e-12);
                    let moved = pole.s.radius();
                    doubt += residue.radius() / far + residue.magnitude() * moved / (far * (far - moved));
                }
            }
            // The sample is taken beside the ellipse's own point: |R'| is at most that.
            doubt += most * node.off / (gap * (1.0 - 1e-9) - node.off);
            let rest = Complex::new(rest.re.widen(doubt * UP), rest.im.widen(doubt * UP));
            // -i reach R (u - 1 / u) / 2 / count
            let scaled = (rest * node.turn).scale(Ball::from(around.reach) / Ball::from(count));
            let product = Complex::new(scaled.im, -scaled.re);
            // And 1 / (i omega - s) is that of a point beside it.
            let least = node.s.re.to_f64().abs() - node.off;
            let moved = 2.0 * product.magnitude() * node.off;
            for (k, flat) in flat.iter_mut().enumerate() {
                *flat += [1.0, 2.0, 6.0][k] * moved / least.power(k as i32 + 2) * UP;
            }
            let mut products = [Complex::<Ball>::ZERO; 5];
            products[0] = product;
            list.push(Given { s: node.s, loose: 0.0, products, rest: [0.0; 5] });
        }
        let through = feed_through(&system.outputs[output], input);
        let part = if system.c.is_empty() { part_of(p, b, &through) } else { Part::Both };
        let flat = flat.map(|x| x * UP);
        // Intervals may extend beyond their ends by a rounding.
        let reach = around.reach * (1.0 - 1e-9);
        PartialFractions::of_poles(list.into_iter(), [Ball::ZERO; 5], through, part)?.over(reach, flat)
    }
}

/// Without damping H is real if all powers of s are even, and imaginary if all are odd.
fn part_of(p: &[Vec<(CoordinateId, Number)>; 3], b: &[Vec<(CoordinateId, Number)>; 3], through: &[Ball; 3]) -> Part {
    let mut odd = [false; 2];
    for i in (0..3).filter(|&i| !p[i].is_empty()) {
        (0..3).filter(|&j| !b[j].is_empty()).for_each(|j| odd[(i + j) % 2] = true);
    }
    through.iter().enumerate().filter(|(_, d)| !d.is_zero()).for_each(|(power, _)| odd[power % 2] = true);
    match odd {
        [_, false] => Part::Real,
        [false, true] => Part::Imaginary,
        [true, true] => Part::Both,
    }
}

/// Bounds of the error of the rule with n points and of its first two derivatives, beside a bound of R on the outer ellipse.
///
/// With i omega = i reach t, R = sum a_m T_m(t), |a_m| <= 2 most / rho^m. The rule makes T_m + sum of c_q T_q v^p of T_m, |c_q| <= 1,
/// with v the inner sum of semi-axes: p = m - q = n, 2 n, .. if m >= n, p = m - q = -n, -2 n, .., and p = -m - q = -n, -2 n, .. The
/// derivatives of T_q are at most q^2 and q^4 / 3.
fn quadrature(around: &Around, inner: f64, count: usize) -> [f64; 3] {
    let n = count as f64;
    let power = (1.0 / inner).power(count as i32) * UP;
    if power > 1e-3 {
        return [f64::INFINITY; 3];
    }
    // sum (1 + m)^4 x^m <= 24 / (1 - x)^5, and (n + m) <= n (1 + m).
    let sum = |x: f64| 24.0 / (1.0 - x).power(5);
    let (x, y) = (1.0 / around.rho, inner / around.rho);
    let both = 4.0 * (y.power(count as i32) * sum(y) + 2.0 * power * sum(x)) * UP;
    let slopes = [1.0, n * n / around.reach, n.power(4) / 3.0 / (around.reach * around.reach)];
    slopes.map(|slope| slope * both * UP)
}

/// The points i reach (u + 1 / u) / 2, u = v e^(i pi (2 k + 1) / n), in the upper half plane.
fn nodes(reach: f64, inner: f64, count: usize) -> Vec<Node> {
    // cos and sin of pi / n: n is a power of two.
    let (one, half) = (Ball::ONE, Ball::from(0.5));
    let (mut cos, mut angles) = (Ball::ZERO, 2);
    let mut sin = one;
    while angles < count {
        let next = ((one + cos) * half).sqrt();
        sin = sin * half / next;
        cos = next;
        angles *= 2;
    }
    let first = Complex::new(cos, sin);
    let step = first * first;
    let (v, inverse) = (Ball::from(inner), one / Ball::from(inner));
    let mut turn = first;
    let mut list = Vec::with_capacity(count / 2);
    for _ in 0..count / 4 {
        for turn in [turn, turn.conj()] {
            let (u, back) = (turn.scale(v), turn.conj().scale(inverse));
            let t = (u + back).scale(half * Ball::from(reach));
            // i t
            let s = Complex::new(-t.im, t.re);
            list.push(Node { s: s.mid(), off: s.radius() * UP, turn: (u - back).scale(half) });
        }
        turn = turn * step;
    }
    list
}

impl Transfer<'_> {
    /// x (M + K / reach^2) >= C >= 0 with an x that is about the least; `None` if none is found.
    fn drag(&self, reach: f64) -> Option<Drag> {
        let reference = reach * reach;
        if self.system.c.is_empty() {
            return Some(Drag { weight: 0.0, reference });
        }
        let takes_energy = self.system.c.terms().all(|term| term.weight.is_zero() || term.weight.is_positive());
        let diagonal = self.entries.iter().filter(|e| e.i == e.j);
        let least = diagonal
            .map(|e| e.c.magnitude() / (e.m.to_f64() + e.k.to_f64() / reference))
            .filter(|x| x.is_finite())
            .fold(0.0, larger);
        let pattern = self.pattern.as_ref().filter(|_| takes_energy && least > 0.0)?;
        let holds = |weight: &f64| {
            let value =
                |e: &super::MatrixEntry| Complex::real(Ball::from(*weight) * (e.m + e.k / Ball::from(reference)) - e.c);
            let entries: Vec<Entry> = self.entries.iter().map(|e| Entry { i: e.i, j: e.j, value: value(e) }).collect();
            pattern.factor::<Disc>(&entries).is_some_and(|factors| factors.is_positive())
        };
        let weight = [1.01, 1.1, 1.5, 2.0, 3.0, 5.0, 10.0].map(|by| by * least).into_iter().find(holds)?;
        Some(Drag { weight, reference })
    }

    /// p(s)^T Q(s)^-1 b(s) anywhere, `[input][output]`, without what is fed through; `None` if elimination fails.
    fn beside_axis(&self, s: Complex<Dd>, inputs: &[usize], outputs: &[usize]) -> Option<Vec<Vec<Complex<Ball>>>> {
        let s = s.to_ball();
        let square = s * s;
        let value = |e: &super::MatrixEntry| square.scale(e.m) + s.scale(e.c) + Complex::real(e.k);
        let entries: Vec<Entry> = self.entries.iter().map(|e| Entry { i: e.i, j: e.j, value: value(e) }).collect();
        let factors = self.pattern.as_ref()?.factor::<Disc>(&entries)?;
        let powers = [Complex::real(Ball::ONE), s, square];
        let of_input = |&input: &usize| {
            let mut load = vec![Complex::<Ball>::ZERO; self.system.n()];
            for (power, column) in powers.iter().zip(&self.system.inputs[input].b) {
                for (i, value) in column {
                    load[i.index()] = load[i.index()] + power.scale(value.to_ball());
                }
            }
            let x = factors.solve(&load);
            let of_output = |&output: &usize| {
                let mut sum = Complex::<Ball>::ZERO;
                for (power, row) in powers.iter().zip(&self.system.outputs[output].p) {
                    for (i, value) in row {
                        let Disc { value: x, radius } = x[i.index()];
                        let x = Complex::new(Ball::new(x.re, radius), Ball::new(x.im, radius));
                        sum = sum + *power * x.scale(value.to_ball());
                    }
                }
                sum
            };
            outputs.iter().map(of_output).collect()
        };
        Some(inputs.iter().map(of_input).collect())
    }
}

#[cfg(test)]
mod tests;
