//! Transfer functions by poles: H(s) = sum p_b (s - D_b)^-1 q_b plus a polynomial. In: the system in modal coordinates.
//! Out: blocks of one or two poles as exact numbers, and a bound of the difference between H and such a sum, valid at
//! all frequencies. See docs/method/random.md#poles.
//!
//! With z = (X_b, X_b D_b) as columns of Z and L(s) = s [C M; M 0] + [K 0; 0 -M], Z^T L(s) Z = B (s - D) + R exactly,
//! for any D and X: R_ab = X_a^T (K X_b + C X_b D_b + M X_b D_b^2) is small for accurate ones, and so are the
//! off-diagonal blocks of B. The distances between poles do not enter, only their distances from the axis.

use super::argument::{Argument, Point, Two};
use super::blocks::{Block, blocks};
use super::gramian::{Drive, Space};
use crate::base::{Ball, Power, down, up};
use crate::kernel::complex::Complex;
use std::cell::OnceCell;

const UP: f64 = up::THOUSANDS;

/// The poles of a system, all of them in the left half-plane.
pub struct Resolvent {
    n: usize,
    blocks: Vec<Exact>,
    residuals: Vec<Residual>,
    /// For the single poles -1 / (s_b + s_c) and -1 / (s_b + conj s_c), row by row, computed on demand.
    sums: OnceCell<Vec<[Point; 2]>>,
}

/// Bounds of an entry of B_d^-1 R and of B_d^-1 B - 1, in the row of one block and the column of another.
struct Residual {
    row: usize,
    column: usize,
    residual: f64,
    skew: f64,
}

/// The distances of some frequencies from every pole, and the bounds that follow from them.
pub struct Nearness {
    /// A lower bound of the distance from the mean of each block.
    far: Vec<f64>,
    /// Relative error bound of a transfer function at these frequencies, in terms of the product of its scaled rows.
    relative: f64,
    /// Pairs of blocks b, c with s_b nearly - conj s_c, as seen from the frequencies: poles that nearly lie on the
    /// axis.
    close: Vec<(usize, usize)>,
}

impl Nearness {
    fn is_close(&self, b: usize, c: usize) -> bool {
        self.close.contains(&(b, c))
    }
}

/// A block as enclosures of radius zero, and the quantities that follow from it.
struct Exact {
    is_real: bool,
    d: Vec<Vec<Point>>,
    x: Vec<Vec<Point>>,
    /// X D
    rate: Vec<Vec<Point>>,
    /// The inverse of B_bb.
    inverse: Vec<Vec<Point>>,
    /// The distance of the middle of its poles from the axis.
    far: f64,
}

/// A transfer function: rows p_b, columns q_b, factors of s^-2 .. s^2.
pub struct Parts {
    pub p: Vec<Vec<Point>>,
    q: Vec<Vec<Point>>,
    pub direct: [Ball; 5],
    /// A bound of the missing part, on the axis.
    pub slack: f64,
}

/// |H(i w)|^2 = 2 re sum p_b (i w - D_b)^-1 g_b + sum l_m w^(2 m), over all blocks, conjugates too.
pub struct Square {
    /// p_b and g_b of those blocks whose poles are real or above the axis.
    pub rows: Vec<Vec<Point>>,
    pub columns: Vec<Vec<Point>>,
    /// l_-2 .. l_2
    pub direct: [Ball; 5],
    pub slack: f64,
}

/// A function of D_b: of a block, or of its conjugate.
#[derive(Clone, Copy)]
pub enum Value {
    One(Point),
    Two(Two),
}

impl Value {
    /// The sum of two values at one block.
    pub fn plus(self, other: Value) -> Value {
        match (self, other) {
            (Value::One(a), Value::One(b)) => Value::One(a + b),
            (Value::Two(a), Value::Two(b)) => Value::Two(a.plus(b)),
            // Of different blocks.
            (Value::One(_), _) | (_, Value::One(_)) => Value::One(Complex::ZERO.widen(f64::INFINITY)),
        }
    }

    /// p f(D) g
    pub fn between(self, p: &[Point], g: &[Point]) -> Point {
        match self {
            Value::One(f) => p[0] * f * g[0],
            Value::Two(f) => (0..2).fold(Complex::ZERO, |sum, i| sum + p[i] * (f.0[i][0] * g[0] + f.0[i][1] * g[1])),
        }
    }
}

fn conj(x: &[Point]) -> Vec<Point> {
    x.iter().map(|z| z.conj()).collect()
}

/// Rows times columns, as lists of columns.
fn times(x: &[Vec<Point>], d: &[Vec<Point>]) -> Vec<Vec<Point>> {
    let (order, n) = (d.len(), x[0].len());
    let entry = |i: usize, l: usize| (0..order).fold(Complex::ZERO, |sum: Point, m| sum + x[m][i] * d[m][l]);
    (0..order).map(|l| (0..n).map(|i| entry(i, l)).collect()).collect()
}

pub fn across(x: &[Point], y: &[Point]) -> Point {
    x.iter().zip(y).fold(Complex::ZERO, |sum, (x, y)| sum + *x * *y)
}

fn inverse(rows: &[Vec<Point>]) -> Vec<Vec<Point>> {
    match rows {
        [row] => vec![vec![row[0].inverse()]],
        _ => Two(std::array::from_fn(|i| std::array::from_fn(|j| rows[i][j]))).inverse().0.map(Vec::from).into(),
    }
}

fn sum_of_sizes(x: &[Point]) -> f64 {
    x.iter().map(|z| z.magnitude()).sum::<f64>() * UP
}

impl Exact {
    fn of(block: &Block) -> Option<Exact> {
        let of = |rows: &[Vec<_>]| -> Vec<Vec<Point>> {
            rows.iter().map(|row: &Vec<Complex<_>>| row.iter().map(|z| Complex::to_ball(*z)).collect()).collect()
        };
        let (d, x) = (of(&block.d), of(&block.x));
        let mean = block.mean();
        // A pole may lie on the axis where no noise in bands comes near it.
        let is_swing = d.len() == 1 && mean.re.hi.abs() <= ON_AXIS * mean.im.hi;
        let far = if is_swing { (-mean.re.hi).max(0.0) } else { -mean.re.hi };
        // The distance of D from a multiple of the unit matrix.
        let apart = (0..d.len()).flat_map(|i| {
            let d = &d;
            (0..d.len()).map(move |j| {
                let entry = if i == j { d[i][j] - mean.to_ball() } else { d[i][j] };
                entry.magnitude().power(2)
            })
        });
        let is_left = (far > 0.0 || is_swing) && far.is_finite() && apart.sum::<f64>().sqrt() * UP <= MOST_APART * far;
        is_left.then(|| Exact { is_real: block.is_real, rate: times(&x, &d), inverse: Vec::new(), d, x, far })
    }

    fn order(&self) -> usize {
        self.d.len()
    }

    /// The height of the middle of its poles above the real axis.
    fn height(&self) -> f64 {
        let sum = (0..self.d.len()).fold(Complex::ZERO, |sum: Point, i| sum + self.d[i][i]);
        sum.im.to_f64() / self.d.len() as f64
    }

    fn value(&self, f: impl Fn(&[Vec<Point>]) -> Value) -> Value {
        f(&self.d)
    }

    /// The columns of K X + C X D + M X D^2 and of C X, including everything by which M and K may be off.
    fn apply(&self, space: &Space) -> [Vec<Vec<Point>>; 2] {
        let n = space.n;
        let twice = times(&self.rate, &self.d);
        let by_c = |x: &[Point]| -> Vec<Point> {
            (0..n).map(|i| (0..n).fold(Complex::ZERO, |sum: Point, j| sum + x[j].scale(space.c[(i, j)]))).collect()
        };
        let of = |l: usize| {
            let (x, damped) = (&self.x[l], by_c(&self.rate[l]));
            let stretched = x.iter().zip(&space.s).map(|(x, s)| x.magnitude() * s).sum::<f64>() * UP;
            let moved = space.of_m * sum_of_sizes(&twice[l]);
            let force = (0..n).map(|i| {
                let slack = (moved + space.of_k * space.s[i] * stretched) * UP;
                (twice[l][i] + damped[i] + x[i].scale(space.k[i])).widen(slack)
            });
            force.collect::<Vec<Point>>()
        };
        let order = self.order();
        [(0..order).map(of).collect(), self.x.iter().map(|x| by_c(x)).collect()]
    }
}

/// A real part that is less than this part of the imaginary one may be zero.
const ON_AXIS: f64 = 1e-14;
/// The sum of a pole and the conjugate of another that is less than this part of their distances from a band.
const CLOSE: f64 = 1e-9;
/// The Frobenius norm of D - mean, relative to the distance of the mean from the axis.
const MOST_APART: f64 = 0.05;

/// A row of Z^T L Z: a column of a block, or of its conjugate.
#[derive(Clone, Copy)]
struct Row {
    block: usize,
    is_mirrored: bool,
}

impl Resolvent {
    /// `None` if poles or vectors are not accurate enough for any bound.
    pub fn of(space: &Space) -> Option<Resolvent> {
        let found = blocks(space)?;
        let blocks: Vec<Exact> = found.iter().map(Exact::of).collect::<Option<_>>()?;
        let count: usize = blocks.iter().map(|block| block.order() * if block.is_real { 1 } else { 2 }).sum();
        if count != 2 * space.n {
            return None;
        }
        let mut resolvent = Resolvent { n: space.n, blocks, residuals: Vec::new(), sums: OnceCell::new() };
        resolvent.certify(space);
        Some(resolvent)
    }

    /// The distances and bounds for all frequencies.
    pub fn on_axis(&self) -> Option<Nearness> {
        self.near(self.blocks.iter().map(|block| block.far).collect())
    }

    /// The distances and bounds between angular frequencies.
    pub fn within(&self, ranges: &[[Ball; 2]]) -> Option<Nearness> {
        if ranges.is_empty() {
            return self.on_axis();
        }
        let far = |block: &Exact| {
            let height = block.height();
            let apart = |[from, to]: &[Ball; 2]| {
                let (low, high) = (from.mid.hi - from.rad, to.mid.hi + to.rad);
                let beside = (low - height).max(height - high).max(0.0);
                (block.far * block.far + beside * beside).sqrt() * down::THOUSANDS
            };
            ranges.iter().map(apart).fold(f64::INFINITY, f64::min).max(block.far)
        };
        self.near(self.blocks.iter().map(far).collect())
    }

    /// Rows and columns are weighted by the distances.
    fn near(&self, far: Vec<f64>) -> Option<Nearness> {
        let is_known = far.iter().all(|far| far.is_finite() && *far > 0.0);
        if !is_known {
            return None;
        }
        let norm = |of: &dyn Fn(&Residual) -> f64| {
            let squares: f64 = self.residuals.iter().map(|entry| of(entry).power(2)).sum();
            squares.sqrt() * UP
        };
        let residual = norm(&|entry| entry.residual / (far[entry.row] * far[entry.column]).sqrt() * UP);
        let skew = norm(&|entry| entry.skew * (far[entry.column] / far[entry.row]).sqrt() * UP);
        Some(Nearness { relative: relative(residual, skew)?, close: self.close(&far), far })
    }

    fn close(&self, far: &[f64]) -> Vec<(usize, usize)> {
        let single: Vec<usize> =
            (0..self.blocks.len()).filter(|&b| !self.blocks[b].is_real && self.blocks[b].order() == 1).collect();
        let pole = |b: usize| self.blocks[b].d[0][0];
        let is_close = |b: usize, c: usize| {
            let apart = (pole(b) + pole(c).conj()).to_f64().one_norm();
            apart < CLOSE * far[b].min(far[c])
        };
        let pairs = single.iter().flat_map(|&b| single.iter().map(move |&c| (b, c)));
        pairs.filter(|&(b, c)| is_close(b, c)).collect()
    }

    /// Bounds the residuals.
    fn certify(&mut self, space: &Space) {
        let applied: Vec<[Vec<Vec<Point>>; 2]> = self.blocks.iter().map(|block| block.apply(space)).collect();
        let rows: Vec<Row> = (0..self.blocks.len())
            .flat_map(|block| {
                let count = if self.blocks[block].is_real { 1 } else { 2 };
                [false, true].into_iter().take(count).map(move |is_mirrored| Row { block, is_mirrored })
            })
            .collect();
        for (b, [_, damped]) in applied.iter().enumerate() {
            let own = Row { block: b, is_mirrored: false };
            self.blocks[b].inverse = inverse(&self.slope(space, own, b, damped));
        }
        for (b, [force, damped]) in applied.iter().enumerate() {
            // The columns of conjugates have the same magnitudes in another order of rows, and the bound is in the
            // Frobenius norm.
            let count = if self.blocks[b].is_real { 1 } else { 2 };
            for &row in &rows {
                let other = &self.blocks[row.block];
                let turned = |rows: &[Vec<Point>]| -> Vec<Vec<Point>> {
                    if row.is_mirrored { rows.iter().map(|x| conj(x)).collect() } else { rows.to_vec() }
                };
                let (x, inverse) = (turned(&other.x), turned(&other.inverse));
                let slope = self.slope(space, row, b, damped);
                let is_own = row.block == b && !row.is_mirrored;
                let mut found = Vec::new();
                for (l, force) in force.iter().enumerate() {
                    let right: Vec<Point> = x.iter().map(|x| across(x, force)).collect();
                    for inverse in &inverse {
                        let skew =
                            (0..other.order()).fold(Complex::ZERO, |sum: Point, k| sum + inverse[k] * slope[k][l]);
                        found.push((across(inverse, &right).magnitude(), if is_own { 0.0 } else { skew.magnitude() }));
                    }
                }
                for (residual, skew) in found {
                    for _ in 0..count {
                        self.residuals.push(Residual { row: row.block, column: b, residual, skew });
                    }
                }
            }
        }
    }

    /// A block of B: X_a^T C X_b + X_a^T M X_b D_b + (X_a D_a)^T M X_b.
    fn slope(&self, space: &Space, row: Row, b: usize, damped: &[Vec<Point>]) -> Vec<Vec<Point>> {
        let (a, b) = (&self.blocks[row.block], &self.blocks[b]);
        let turned = |x: &[Point]| if row.is_mirrored { conj(x) } else { x.to_vec() };
        let entry = |k: usize, l: usize| {
            let (x, rate) = (turned(&a.x[k]), turned(&a.rate[k]));
            let slack = sum_of_sizes(&x) * sum_of_sizes(&b.rate[l]) + sum_of_sizes(&rate) * sum_of_sizes(&b.x[l]);
            let sum = across(&x, &damped[l]) + across(&x, &b.rate[l]) + across(&rate, &b.x[l]);
            sum.widen(space.of_m * slack * UP)
        };
        (0..a.order()).map(|k| (0..b.order()).map(|l| entry(k, l)).collect()).collect()
    }

    /// The integrals of a function over i w - D_b, for every block and its conjugate.
    pub fn values<'r>(
        &'r self,
        one: impl Fn(Point) -> Point + 'r,
        two: impl Fn(Two) -> Two + 'r,
    ) -> impl Iterator<Item = [Value; 2]> + 'r {
        let of = move |d: &[Vec<Point>]| match d {
            [row] => Value::One(one(row[0])),
            _ => Value::Two(two(Two(std::array::from_fn(|i| std::array::from_fn(|j| d[i][j]))))),
        };
        self.blocks.iter().map(move |block| {
            let direct = block.value(&of);
            let mirrored: Vec<Vec<Point>> = block.d.iter().map(|row| conj(row)).collect();
            [direct, if block.is_real { direct } else { of(&mirrored) }]
        })
    }

    /// Whether a block is its own conjugate.
    pub fn is_real(&self, block: usize) -> bool {
        self.blocks[block].is_real
    }

    /// The transfer function from a noise to an output given as a row over the state, and its direct path.
    pub fn parts(
        &self,
        space: &Space,
        drive: &Drive,
        row: &[Ball],
        direct: [Ball; 5],
        near: &Nearness,
    ) -> Option<Parts> {
        let n = self.n;
        let jump: Vec<Ball> = drive.jump.iter().zip(&space.s).map(|(jump, s)| *jump / Ball::from(*s)).collect();
        let size = jump.iter().map(|h| h.magnitude()).sum::<f64>() * UP;
        // f + C h and M h, where M is the unit matrix up to small entries.
        let force = |i: usize| (0..n).fold(drive.force[i], |sum, j| sum + space.c[(i, j)] * jump[j]);
        let force: Vec<Ball> = (0..n).map(force).collect();
        let moved: Vec<Ball> =
            jump.iter().map(|h| if size > 0.0 { h.widen(space.of_m * size * UP) } else { *h }).collect();
        let places: Vec<Ball> = (0..n).map(|i| row[i] * Ball::from(space.s[i])).collect();
        let along = |x: &[Point], by: &[Ball]| {
            x.iter().zip(by).filter(|(_, by)| !by.is_zero()).fold(Complex::ZERO, |sum, (x, by)| sum + x.scale(*by))
        };
        let (mut left, mut right) = (0.0, 0.0);
        let (mut rows, mut columns) = (Vec::new(), Vec::new());
        for (block, far) in self.blocks.iter().zip(&near.far) {
            let each = || block.x.iter().zip(&block.rate);
            let p: Vec<Point> = each().map(|(x, rate)| along(x, &places) + along(rate, &row[n..])).collect();
            let driven: Vec<Point> = each().map(|(x, rate)| along(x, &force) + along(rate, &moved)).collect();
            let q: Vec<Point> = block.inverse.iter().map(|inverse| across(inverse, &driven)).collect();
            let count = if block.is_real { 1.0 } else { 2.0 };
            let square = |x: &[Point]| x.iter().map(|z| z.magnitude().power(2)).sum::<f64>();
            left += count * square(&p) / far;
            right += count * square(&q) / far;
            rows.push(p);
            columns.push(q);
        }
        let slack = near.relative * (left * UP).sqrt() * (right * UP).sqrt() * UP;
        slack.is_finite().then_some(Parts { p: rows, q: columns, direct, slack })
    }

    /// |H|^2 as H(s) H(-s), by partial fractions; without close pairs, see [`Resolvent::close_pairs`].
    pub fn square(&self, parts: &Parts, near: &Nearness) -> Square {
        let columns = (0..self.blocks.len()).map(|b| self.mirror(parts, parts, b, |c| near.is_close(b, c))).collect();
        Square { rows: parts.p.clone(), columns, direct: self.even_coefficients(parts), slack: parts.slack }
    }

    /// For each close pair b, c the matrix with s_b and - conj s_c on its diagonal and a corner: the corner of a function of it, over
    /// the corner, is the divided difference of the function.
    pub fn close_pairs(&self, near: &Nearness) -> Vec<(Two, Ball)> {
        let of = |&(b, c): &(usize, usize)| {
            let corner = Ball::from(0.125 * near.far[b].min(near.far[c]));
            let [s, t] = [self.blocks[b].d[0][0], -self.blocks[c].d[0][0].conj()];
            (Two([[s, Complex::real(corner)], [Complex::ZERO, t]]), corner)
        };
        near.close.iter().map(of).collect()
    }

    /// The factors of 1 / ((s - s_b) (s + conj s_c)) in H(s) H(-s) for each close pair.
    pub fn close_factors(&self, parts: &Parts, near: &Nearness) -> Vec<Point> {
        let own = |b: usize| parts.p[b][0] * parts.q[b][0];
        near.close.iter().map(|&(b, c)| -(own(b) * own(c).conj())).collect()
    }

    /// The columns g_b with which H(s) G(-s) has the poles D_b of H, for every block: G(-D_b) q_b.
    pub fn mirrored_all(&self, own: &Parts, other: &Parts) -> Vec<Vec<Point>> {
        (0..self.blocks.len()).map(|b| self.mirror(own, other, b, |_| false)).collect()
    }

    /// `is_left_out`: whether the conjugate of a block is ignored.
    fn mirror(&self, own: &Parts, parts: &Parts, b: usize, is_left_out: impl Fn(usize) -> bool) -> Vec<Point> {
        let (is_seen, q) = (own.p[b].iter().any(|p| !(p.re.is_zero() && p.im.is_zero())), &own.q[b]);
        let mut sum = vec![Complex::ZERO; q.len()];
        if !is_seen {
            return sum;
        }
        let own = &self.blocks[b];
        let mut add = |found: Vec<Point>| sum.iter_mut().zip(found).for_each(|(sum, x)| *sum = *sum + x);
        let sums = self.sums.get_or_init(|| self.inverse_sums());
        for (c, other) in self.blocks.iter().enumerate() {
            if let ([p], [r], [q]) = (&parts.p[c][..], &parts.q[c][..], &q[..]) {
                let product = *r * *p;
                let [direct, mirrored] = sums[b * self.blocks.len() + c];
                let is_alone = other.is_real || is_left_out(c);
                let both = if is_alone { product * direct } else { product * direct + product.conj() * mirrored };
                add(vec![both * *q]);
                continue;
            }
            add(coupled_product((&own.d, q), (&other.d, &parts.q[c]), &parts.p[c]));
            if !other.is_real {
                let d: Vec<Vec<Point>> = other.d.iter().map(|row| conj(row)).collect();
                add(coupled_product((&own.d, q), (&d, &conj(&parts.q[c])), &conj(&parts.p[c])));
            }
        }
        add(laurent(&parts.direct, &own.d, q));
        sum
    }

    fn inverse_sums(&self) -> Vec<[Point; 2]> {
        let of = |a: Point, b: Point| Complex::real(-Ball::ONE) / (a + b);
        let pair = |a: &Exact, b: &Exact| [of(a.d[0][0], b.d[0][0]), of(a.d[0][0], b.d[0][0].conj())];
        self.blocks.iter().flat_map(|a| self.blocks.iter().map(move |b| pair(a, b))).collect()
    }

    /// The sum over all blocks of p f(D) q, f a power of D.
    pub fn sum(&self, parts: &Parts, power: i32) -> Ball {
        self.over_blocks(|b, d| across(&parts.p[b], &pow(d, &parts.q[b], power)))
    }

    /// The sum of a function of D_b over all blocks, conjugates too.
    pub fn over_blocks(&self, of: impl Fn(usize, &[Vec<Point>]) -> Point) -> Ball {
        let term = |(b, block): (usize, &Exact)| {
            let value = of(b, &block.d).re;
            if block.is_real { value } else { value + value }
        };
        self.blocks.iter().enumerate().map(term).fold(Ball::ZERO, |sum, x| sum + x)
    }

    /// The largest distance of a pole from the axis.
    pub fn farthest(&self) -> f64 {
        self.blocks.iter().map(|block| block.far).fold(0.0, f64::max)
    }

    /// The coefficients of w^-4 .. w^4 in |H|^2.
    fn even_coefficients(&self, parts: &Parts) -> [Ball; 5] {
        let (two, direct) = (Ball::from(2.0), &parts.direct);
        // Powers of s from -4 to 4: products of the direct paths, then products with the poles.
        let mut powers = [Ball::ZERO; 9];
        for (k, a) in direct.iter().enumerate() {
            for (l, b) in direct.iter().enumerate() {
                let product = *a * *b;
                powers[k + l] = powers[k + l] + if l % 2 == 0 { product } else { -product };
            }
        }
        if !direct[3].is_zero() {
            powers[4] = powers[4] - two * direct[3] * self.sum(parts, 0);
        }
        if !direct[4].is_zero() {
            powers[4] = powers[4] + two * direct[4] * self.sum(parts, 1);
        }
        if !direct[0].is_zero() {
            powers[2] = powers[2] - two * direct[0] * self.sum(parts, -1);
        }
        // s^2 = -w^2
        [powers[0], -powers[2], powers[4], -powers[6], powers[8]]
    }
}

/// A pole or its conjugate in binary64, with its factors in a noise and an output, mode by mode.
pub struct Line {
    pub s: Complex<f64>,
    /// The contribution of each mode to p.
    pub of_modes: Vec<Complex<f64>>,
    pub p: Complex<f64>,
    pub q: Complex<f64>,
}

impl Resolvent {
    /// The lines of a transfer function; `None` if two poles nearly coincide.
    pub fn lines(&self, space: &Space, parts: &Parts, row: &[Ball]) -> Option<Vec<Line>> {
        let mut lines = Vec::with_capacity(2 * self.n);
        for (block, q) in self.blocks.iter().zip(&parts.q) {
            let ([x], [q]) = (&block.x[..], &q[..]) else { return None };
            let (s, q) = (block.d[0][0].to_f64(), q.to_f64());
            let of_mode = |i: usize| {
                let place = Complex::real(row[i].to_f64() * space.s[i]);
                x[i].to_f64() * (place + s.scale(row[self.n + i].to_f64()))
            };
            let of_modes: Vec<Complex<f64>> = (0..self.n).map(of_mode).collect();
            let p = of_modes.iter().fold(Complex::ZERO, |sum, p| sum + *p);
            if !block.is_real {
                let of_modes = of_modes.iter().map(|p| p.conj()).collect();
                lines.push(Line { s: s.conj(), of_modes, p: p.conj(), q: q.conj() });
            }
            lines.push(Line { s, of_modes, p, q });
        }
        Some(lines)
    }
}

/// The relative error of a transfer function that follows from bounds of the residual and of the skewness; its
/// resolvent is at most 1 / (1 - `MOST_APART`) on the axis once it is scaled.
fn relative(residual: f64, skew: f64) -> Option<f64> {
    const MOST: f64 = 0.1;
    const RESOLVENT: f64 = 1.0 / (1.0 - MOST_APART) * UP;
    let is_small = skew < MOST && residual < MOST;
    if !is_small {
        return None;
    }
    let of_inverse = skew / (1.0 - skew);
    let residual = residual / (1.0 - skew) * RESOLVENT * UP;
    let of_poles = residual / (1.0 - residual);
    Some((of_poles * (1.0 + of_inverse) + of_inverse) * RESOLVENT * UP)
}

/// P p^T for D P + P E^T = - q r^T, where the blocks D and E have columns q and r.
fn coupled_product((d, q): (&[Vec<Point>], &[Point]), (e, r): (&[Vec<Point>], &[Point]), p: &[Point]) -> Vec<Point> {
    if let ([d], [e]) = (d, e) {
        return vec![-(q[0] * r[0] * p[0]) / (d[0] + e[0])];
    }
    let mean = |d: &[Vec<Point>]| {
        let sum = (0..d.len()).fold(Complex::ZERO, |sum: Point, i| sum + d[i][i]).mid();
        let part = 1.0 / d.len() as f64;
        Complex::new(sum.re.scale(part), sum.im.scale(part)).to_ball()
    };
    let (a, b) = (mean(d), mean(e));
    let less = |d: &[Vec<Point>], mean: Point| -> Vec<Vec<Point>> {
        let entry = |i: usize, j: usize| if i == j { d[i][j] - mean } else { d[i][j] };
        (0..d.len()).map(|i| (0..d.len()).map(|j| entry(i, j)).collect()).collect()
    };
    let (rest_d, rest_e) = (less(d, a), less(e, b));
    let inverse = (a + b).inverse();
    // (a + b) P = - q r^T - N P - P N'^T, term by term of the geometric series.
    let mut term: Vec<Vec<Point>> = q.iter().map(|q| r.iter().map(|r| -(*q * *r) * inverse).collect()).collect();
    let mut sum = term.clone();
    let size = |m: &[Vec<Point>]| m.iter().flatten().map(|z| z.magnitude().power(2)).sum::<f64>().sqrt() * UP;
    let ratio = (size(&rest_d) + size(&rest_e)) * inverse.magnitude() * UP;
    let is_small = ratio < 0.5;
    for _ in 0..MOST_TERMS {
        let next = |i: usize, j: usize| {
            let left = (0..d.len()).fold(Complex::ZERO, |sum: Point, k| sum + rest_d[i][k] * term[k][j]);
            let both = (0..e.len()).fold(left, |sum, k| sum + term[i][k] * rest_e[j][k]);
            -(both * inverse)
        };
        term = (0..d.len()).map(|i| (0..e.len()).map(|j| next(i, j)).collect()).collect();
        sum.iter_mut().flatten().zip(term.iter().flatten()).for_each(|(sum, x)| *sum = *sum + *x);
        if size(&term) <= 1e-36 * size(&sum) {
            break;
        }
    }
    let beyond = if is_small { 2.0 * ratio * size(&term) * UP } else { f64::INFINITY };
    sum.iter()
        .map(|row| row.iter().zip(p).fold(Complex::ZERO, |sum: Point, (x, p)| sum + x.widen(beyond) * *p))
        .collect()
}

const MOST_TERMS: usize = 60;

/// D^power q
fn pow(d: &[Vec<Point>], q: &[Point], power: i32) -> Vec<Point> {
    let by = if power < 0 { inverse(d) } else { d.to_vec() };
    (0..power.abs()).fold(q.to_vec(), |q, _| by.iter().map(|row| across(row, &q)).collect())
}

/// The factors of s^-2 .. s^2 at - D, times q.
fn laurent(factors: &[Ball; 5], d: &[Vec<Point>], q: &[Point]) -> Vec<Point> {
    let mut sum = vec![Complex::ZERO; q.len()];
    for (place, factor) in factors.iter().enumerate().filter(|(_, factor)| !factor.is_zero()) {
        let signed = if place % 2 == 0 { *factor } else { -*factor };
        let raised = pow(d, q, place as i32 - 2);
        sum.iter_mut().zip(raised).for_each(|(sum, x)| *sum = *sum + Complex::scale(x, signed));
    }
    sum
}
