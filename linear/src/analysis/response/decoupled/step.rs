//! exp(A h) of all blocks at once, in the lanes of vectors, with the sources that act on them. In: the blocks, the active
//! states of the sources, h. Out: two by two numbers for each block, two for each source, and bounds of their errors.
//! See docs/method/response.md#modal-steps.
//!
//! A = [[A_i, B_i], [0, G]]: B_i what the sources add to z', G their generator. The blocks
//! F = exp(A_i h), Phi and R = exp(G h) are computed by scaling to |A h| <= 1/2, the Taylor polynomial of degree 24 by
//! Horner's scheme, and squaring: F <- F F, Phi <- F Phi + Phi R, R <- R R.

use super::blocks::Blocks as System;
use crate::analysis::response::exponential::growth;
use crate::base::{Ball, Dd, Number, Power, rounding, two_to, up};
use crate::kernel::dense::Matrix;
use crate::kernel::lanes::{Double, Lanes};
use crate::kernel::simd::{Vector, simd};
use std::cell::RefCell;

/// exp(A h) for one h.
#[derive(Clone, Debug)]
pub struct Step {
    pub h: Number,
    /// Active states of the sources.
    pub on: Vec<usize>,
    /// F by rows.
    pub f: [Lanes; 4],
    /// Both entries of Phi for each active state.
    pub phi: Vec<[Lanes; 2]>,
    /// R
    pub r: Matrix<Dd>,
    /// Bounds of |F| and |Phi|, over all oscillators.
    pub own: f64,
    pub from_sources: f64,
    /// Bounds of the errors of F, Phi and R.
    pub error: f64,
    pub error_of_sources: f64,
    pub error_of_r: f64,
    /// Rounding error of applying it, relative to |z| and |w|.
    pub rounding: f64,
    pub rounding_of_sources: f64,
    /// |h|, and bounds of |exp(A_i t)| and |exp(G t)| for t up to h.
    pub length: f64,
    pub growth: f64,
    pub growth_of_sources: f64,
    /// Bounds of the norms of 2^k such steps at once, without sources, computed on demand.
    powers: RefCell<Powers>,
}

/// F of each oscillator, squared repeatedly in binary64, with the error of each square.
#[derive(Clone, Debug)]
struct Powers {
    last: Vec<([f64; 4], f64)>,
    norms: Vec<f64>,
}

/// Degree of the polynomial.
const DEGREE: usize = 24;
/// Remainder of the polynomial.
const LEFT_OUT: f64 = 1e-32;
/// Twice the relative error of one operation.
const UNIT: f64 = 2.0 * Dd::EPSILON;
/// (2^-53)^2
const SQUARE: f64 = rounding::UNIT_SQUARED;
const UP: f64 = up::THOUSANDS;
/// No result is useful at a time of 2^100 over the fastest rate.
const MOST_SQUARINGS: usize = 100;

/// The input of the loop over lanes.
struct Task<'a> {
    /// A h by rows, scaled down.
    a: [Lanes; 4],
    /// B h, scaled down: the position among the active states, and its entries.
    b: Vec<(usize, [Lanes; 2])>,
    /// The sums of Horner's scheme for exp(G h), from the highest down, then the powers to be squared.
    horner: &'a [Matrix<Dd>],
    powers: &'a [Matrix<Dd>],
    size: usize,
}

/// Blocks of all oscillators, and the squares of their norms at each squaring.
struct Blocks {
    f: [Lanes; 4],
    phi: Vec<[Lanes; 2]>,
    /// By squaring, then by oscillator: |F|^2 and |Phi|^2 of the computed blocks, in the Frobenius norm.
    squares: Vec<[Vec<f64>; 2]>,
}

impl Step {
    /// The error that the step adds to the state, besides the error that it carries over: from the error before, |z|, and
    /// the sources' norm and error.
    pub fn added_error(&self, of: &System, error: f64, z: f64, w: f64, w_error: f64, approximations: f64) -> f64 {
        let carried = self.from_sources * w_error;
        let applied = (self.error + self.rounding) * (z + error)
            + (self.error_of_sources + self.rounding_of_sources) * (w + w_error);
        let pushed = (w + w_error) * self.growth_of_sources;
        let largest = self.growth * (z + error + self.length * of.force_norm * pushed);
        let disturbed = of.defect * largest + of.force_defect * pushed + approximations;
        (carried + applied + self.length * self.growth * disturbed) * UP
    }

    /// `None` if the exponent is out of range.
    pub fn of(of: &System, on: &[usize], h: &Number) -> Option<Step> {
        let t = h.to_ball();
        let m = on.len();
        let generator = of.generator_of(on);
        let mut squarings = 0;
        while of.norm * t.magnitude() * 2.0 > two_to(squarings as i32) {
            squarings += 1;
            if squarings > MOST_SQUARINGS {
                return None;
            }
        }
        let scaled = Ball::new(t.mid.scale(two_to(-(squarings as i32))), t.rad * two_to(-(squarings as i32)));
        let times = |values: &[Dd]| Lanes::of(values.iter().map(|&x| x * scaled.mid));
        let acts = |&(_, &state): &(usize, &usize)| of.force[state].iter().flatten().any(|b| !b.is_zero());
        let entries =
            |state: usize| [0, 1].map(|k: usize| Lanes::of(of.force[state].iter().map(|b| b[k].mid * scaled.mid)));
        let b = on.iter().enumerate().filter(acts).map(|(place, &state)| (place, entries(state))).collect();
        let (horner, powers) = exponential_of_sources(&generator, m, scaled.mid, squarings);
        let task = Task {
            a: [0, 1, 2, 3].map(|entry: usize| times(&of.a[entry])),
            b,
            horner: &horner,
            powers: &powers,
            size: of.count(),
        };
        let blocks = blocks(&task);
        // Horner's scheme: a stage has (size + 4) rounding errors of sums whose absolute values are below 2 sqrt(size),
        // and its error enters the next one with |A h| / k: all of them together are less than twice the last.
        let size = (m + 2) as f64;
        let uncertain = (of.radius * scaled.magnitude() + of.norm * scaled.rad) * 2.0;
        let start = (4.0 * (size + 4.0) * size.sqrt() * UNIT + LEFT_OUT + uncertain) * UP;
        let errors = Errors::of(of, &blocks, &powers, start, t.magnitude(), squarings);
        let finite = errors.own.is_finite() && errors.from_sources.is_finite();
        if !finite || !blocks.f.iter().all(|f| f.hi.iter().all(|x| x.is_finite())) {
            return None;
        }
        let products = (size + 3.0) * (size + 3.0) * SQUARE * UP;
        let last = &blocks.squares[squarings];
        let largest = last[0].iter().copied().fold(0.0, f64::max).sqrt();
        let all = last[1].iter().sum::<f64>().sqrt();
        let block = |i: usize| [0, 1, 2, 3].map(|entry: usize| blocks.f[entry].hi[i]);
        let last_powers = (0..of.count()).map(|i| (block(i), errors.f + f64::EPSILON * largest)).collect();
        let many = RefCell::new(Powers { last: last_powers, norms: vec![errors.own] });
        let step = Step {
            powers: many,
            h: h.clone(),
            on: on.to_vec(),
            f: blocks.f,
            phi: blocks.phi,
            r: powers[squarings].clone(),
            own: errors.own,
            from_sources: errors.from_sources,
            error: errors.f,
            error_of_sources: errors.phi,
            error_of_r: errors.r,
            rounding: products * largest,
            rounding_of_sources: products * all,
            length: t.magnitude(),
            growth: growth(of.rate * t.magnitude()),
            growth_of_sources: growth(of.rate_of_sources * t.magnitude()),
        };
        Some(step)
    }
}

impl Step {
    /// A bound of the norm of 2^k of these steps at once, without sources.
    pub fn norm_of_many(&self, k: u32) -> f64 {
        let mut powers = self.powers.borrow_mut();
        while powers.norms.len() <= k as usize {
            powers.square();
        }
        powers.norms[k as usize]
    }
}

impl Powers {
    fn square(&mut self) {
        let size = |f: &[f64; 4]| f.iter().map(|x| x * x).sum::<f64>().sqrt() * UP;
        let mut largest: f64 = 0.0;
        for (f, error) in &mut self.last {
            let before = size(f);
            let [a, b, c, d] = *f;
            *f = [a * a + b * c, a * b + b * d, c * a + d * c, c * b + d * d];
            *error = (2.0 * before * *error + *error * *error + 4.0 * f64::EPSILON * before * before) * UP;
            let norm = (size(f) + *error) * UP;
            largest = if norm.is_nan() { f64::INFINITY } else { largest.max(norm) };
        }
        let before = self.norms.last().map_or(f64::INFINITY, |norm| norm * norm * UP);
        self.norms.push(largest.min(before));
    }
}

/// Bounds of norms and errors after all squarings.
struct Errors {
    own: f64,
    from_sources: f64,
    f: f64,
    phi: f64,
    r: f64,
}

impl Errors {
    /// With F = exp + e, |F^2 - exp^2| <= 2 |exp| |e| + |e|^2 + rounding; correspondingly for the other blocks.
    fn of(of: &System, blocks: &Blocks, powers: &[Matrix<Dd>], start: f64, time: f64, squarings: usize) -> Errors {
        let n = of.count();
        let m = powers[0].columns() as f64;
        let (mut f, mut phi, mut r) = (vec![start; n], vec![start; n], start);
        let (mut own, mut from_sources) = (vec![0.0; n], vec![0.0; n]);
        for (level, power) in powers.iter().enumerate() {
            let time = time * 0.5f64.power((squarings - level) as i32);
            let (allowed, allowed_r) = (growth(of.rate * time), growth(of.rate_of_sources * time));
            let computed_r = frobenius(power);
            let norm_r = allowed_r.min(computed_r + r);
            let [f_squares, phi_squares] = &blocks.squares[level];
            for i in 0..n {
                let (f_size, phi_size) = (f_squares[i].sqrt() * UP, phi_squares[i].sqrt() * UP);
                own[i] = allowed.min(f_size + f[i]) * UP;
                from_sources[i] = (phi_size + phi[i]) * UP;
                if level == squarings {
                    continue;
                }
                let lost = UNIT * (m + 4.0) * (f_size * phi_size + phi_size * computed_r);
                phi[i] =
                    (own[i] * phi[i] + f[i] * (phi_size + phi[i]) + phi[i] * (norm_r + r) + phi_size * r + lost) * UP;
                f[i] = (2.0 * own[i] * f[i] + f[i] * f[i] + UNIT * 4.0 * f_size * f_size) * UP;
            }
            if level < squarings {
                r = (2.0 * norm_r * r + r * r + UNIT * (m + 2.0) * computed_r * computed_r) * UP;
            }
        }
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let together = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>().sqrt() * UP;
        Errors { own: largest(&own), from_sources: together(&from_sources), f: largest(&f), phi: together(&phi), r }
    }
}

fn frobenius(a: &Matrix<Dd>) -> f64 {
    (0..a.columns()).flat_map(|j| a.column(j)).map(|x| x.hi * x.hi).sum::<f64>().sqrt() * UP
}

/// The sums of Horner's scheme for exp(G h / 2^squarings), and its powers by squaring.
fn exponential_of_sources(
    generator: &[(usize, usize, Dd)],
    m: usize,
    h: Dd,
    squarings: usize,
) -> (Vec<Matrix<Dd>>, Vec<Matrix<Dd>>) {
    let mut horner = vec![Matrix::identity(m)];
    for k in (1..=DEGREE).rev() {
        let last = &horner[horner.len() - 1];
        let factor = h / Dd::from(k as f64);
        let mut next = Matrix::identity(m);
        for &(i, j, value) in generator {
            let scaled = value * factor;
            for column in 0..m {
                if !last[(j, column)].is_zero() {
                    next[(i, column)] += scaled * last[(j, column)];
                }
            }
        }
        horner.push(next);
    }
    let mut powers = vec![horner[DEGREE].clone()];
    for k in 0..squarings {
        let r = &powers[k];
        let square = Matrix::from_fn(m, m, |i, j| {
            (0..m)
                .filter(|&l| !r[(i, l)].is_zero() && !r[(l, j)].is_zero())
                .fold(Dd::ZERO, |sum, l| sum + r[(i, l)] * r[(l, j)])
        });
        powers.push(square);
    }
    (horner, powers)
}

simd! {
    fn blocks<V: Vector>(task: &Task) -> Blocks {
        let m = task.horner[0].columns();
        let squarings = task.powers.len() - 1;
        let zeros = || Lanes::zeros(task.size);
        let mut blocks = Blocks {
            f: [zeros(), zeros(), zeros(), zeros()],
            phi: (0..m).map(|_| [zeros(), zeros()]).collect(),
            squares: (0..=squarings).map(|_| [vec![0.0; task.size], vec![0.0; task.size]]).collect(),
        };
        let mut phi: Vec<[Double<V>; 2]> = vec![[Double::zero(); 2]; m];
        let mut next = phi.clone();
        for at in (0..task.size).step_by(V::WIDTH) {
            let mut f = taylor::<V>(task, at, &mut phi);
            for level in 0..=squarings {
                norms(&f, &phi, at, &mut blocks.squares[level]);
                if level < squarings {
                    square(&mut f, &mut phi, &mut next, &task.powers[level]);
                }
            }
            blocks.f.iter_mut().zip(f).for_each(|(to, f)| to.put(at, f));
            for (to, phi) in blocks.phi.iter_mut().zip(&phi) {
                to.iter_mut().zip(phi).for_each(|(to, phi)| to.put(at, *phi));
            }
        }
        blocks
    }
}

/// P <- 1 + A h P / k for k from the degree down to one; stores the block of the sources in `phi`.
#[inline(always)]
fn taylor<V: Vector>(task: &Task, at: usize, phi: &mut [[Double<V>; 2]]) -> [Double<V>; 4] {
    let one = Double::splat(Dd::ONE);
    let mut f = [one, Double::zero(), Double::zero(), one];
    phi.fill([Double::zero(); 2]);
    for (stage, sums) in task.horner[..DEGREE].iter().enumerate() {
        let share = Double::splat(Dd::ONE / Dd::from((DEGREE - stage) as f64));
        let [a, b, c, d] = [0, 1, 2, 3].map(|i: usize| task.a[i].at::<V>(at).times(share));
        f = [
            one.plus(a.times(f[0]).plus(b.times(f[2]))),
            a.times(f[1]).plus(b.times(f[3])),
            c.times(f[0]).plus(d.times(f[2])),
            one.plus(c.times(f[1]).plus(d.times(f[3]))),
        ];
        for (column, phi) in phi.iter_mut().enumerate() {
            let mut next = [a.times(phi[0]).plus(b.times(phi[1])), c.times(phi[0]).plus(d.times(phi[1]))];
            for (place, force) in &task.b {
                let sum = sums[(*place, column)];
                if !sum.is_zero() {
                    for (next, force) in next.iter_mut().zip(force) {
                        *next = next.plus(force.at::<V>(at).times(share).times(Double::splat(sum)));
                    }
                }
            }
            *phi = next;
        }
    }
    f
}

#[inline(always)]
fn square<V: Vector>(f: &mut [Double<V>; 4], phi: &mut [[Double<V>; 2]], next: &mut [[Double<V>; 2]], r: &Matrix<Dd>) {
    for (column, next) in next.iter_mut().enumerate() {
        let [a, b] = phi[column];
        let mut sums = [f[0].times(a).plus(f[1].times(b)), f[2].times(a).plus(f[3].times(b))];
        for (l, phi) in phi.iter().enumerate() {
            let factor = r[(l, column)];
            if !factor.is_zero() {
                let factor = Double::splat(factor);
                sums = [sums[0].plus(phi[0].times(factor)), sums[1].plus(phi[1].times(factor))];
            }
        }
        *next = sums;
    }
    phi.copy_from_slice(next);
    let [a, b, c, d] = *f;
    let cross = b.times(c);
    *f = [a.times(a).plus(cross), a.times(b).plus(b.times(d)), c.times(a).plus(d.times(c)), cross.plus(d.times(d))];
}

/// Squares of Frobenius norms.
#[inline(always)]
fn norms<V: Vector>(f: &[Double<V>; 4], phi: &[[Double<V>; 2]], at: usize, squares: &mut [Vec<f64>; 2]) {
    let zero = V::splat(0.0);
    let of_f = f.iter().fold(zero, |sum, x| x.hi.mul_add(x.hi, sum)).to_array();
    let of_phi = phi.iter().flatten().fold(zero, |sum, x| x.hi.mul_add(x.hi, sum)).to_array();
    for lane in 0..V::WIDTH.min(squares[0].len() - at) {
        (squares[0][at + lane], squares[1][at + lane]) = (of_f[lane], of_phi[lane]);
    }
}
