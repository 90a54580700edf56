//! Poles and their vectors as exact numbers near the true ones: starting values in binary64 and their refinement. Two
//! poles that nearly or exactly coincide, with nearly one vector, form a block. In: the system in modal coordinates.
//! Out: blocks without bounds; `resolvent` bounds them. See docs/method/random.md#poles.

use super::gramian::Space;
use crate::analysis::poles::schur::{ComplexColumns, SchurForm};
use crate::base::{Dd, OrderBy, larger};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::kernel::dense::lu::Lu;
use nalgebra::DMatrix;

type Short = Complex<f64>;
type Long = Complex<Dd>;

/// Limit on the refinements of poles and vectors; each gains at least ten digits.
const STEPS: usize = 6;
/// A step that is smaller than this, relative to the vector, has no effect.
const SETTLED: f64 = 1e-30;
/// Poles of different blocks that are nearer than this, relative to their magnitude, are not separated by a refinement.
const CLOSE: f64 = 1e-12;
/// Dampers that couple two modes by less than this, relative to the damping of both, are ignored for starting values.
const UNCOUPLED: f64 = 1e-26;
/// Poles nearer to each other than this, relative to their distance from the axis, form a block.
const NEAR: f64 = 1e-3;
/// The coupling between the two vectors of a block, relative to that distance.
const COUPLING: f64 = 1.0 / 64.0;

/// Columns X and a matrix D of order one or two with Q(X, D) = M X D^2 + C X D + K X near zero; real, or one of a conjugate pair,
/// that above the real axis.
pub struct Block {
    pub is_real: bool,
    /// Rows of D.
    pub d: Vec<Vec<Long>>,
    /// Columns of X.
    pub x: Vec<Vec<Long>>,
}

impl Block {
    fn of_one(s: Long, x: Vec<Long>) -> Block {
        Block { is_real: s.im.is_zero(), d: vec![vec![s]], x: vec![x] }
    }

    /// mean + [0, coupling; square / coupling, 0]: the poles are mean +- the root of the square.
    fn of_two(is_real: bool, mean: Long, square: Long, coupling: Dd, x: [Vec<Long>; 2]) -> Block {
        let lower = Complex::new(square.re / coupling, square.im / coupling);
        let d = vec![vec![mean, Complex::real(coupling)], vec![lower, mean]];
        Block { is_real, d, x: x.into() }
    }

    pub fn order(&self) -> usize {
        self.d.len()
    }

    /// The middle of the poles.
    pub fn mean(&self) -> Long {
        match &self.d[..] {
            [row] => row[0],
            _ => {
                let sum = self.d[0][0] + self.d[1][1];
                Complex::new(sum.re.scale(0.5), sum.im.scale(0.5))
            }
        }
    }

    fn short(&self) -> ShortBlock {
        ShortBlock {
            is_real: self.is_real,
            d: self.d.iter().map(|row| row.iter().map(|z| z.to_f64()).collect()).collect(),
            x: self.x.iter().map(|column| column.iter().map(|z| z.to_f64()).collect()).collect(),
        }
    }

    /// Multiplies the columns by a power of two.
    fn scale(mut self, space: &Space) -> Block {
        let short = self.short();
        let slope = short.slope(space);
        let size = slope.iter().flatten().map(|z| z.one_norm()).fold(0.0, larger).sqrt();
        let exponent = -libm::log2(size).round();
        let factor = if exponent.abs() < 500.0 { libm::exp2(exponent) } else { 1.0 };
        let scaled = |z: &mut Long| *z = Complex::new(z.re.scale(factor), z.im.scale(factor));
        self.x.iter_mut().flatten().for_each(scaled);
        self
    }
}

/// A block in binary64.
struct ShortBlock {
    is_real: bool,
    d: Vec<Vec<Short>>,
    x: Vec<Vec<Short>>,
}

impl ShortBlock {
    fn conj(&self) -> ShortBlock {
        let of = |rows: &[Vec<Short>]| rows.iter().map(|row| row.iter().map(|z| z.conj()).collect()).collect();
        ShortBlock { is_real: self.is_real, d: of(&self.d), x: of(&self.x) }
    }

    fn mean(&self) -> Short {
        let sum = (0..self.d.len()).fold(Complex::ZERO, |sum: Short, i| sum + self.d[i][i]);
        sum.scale(1.0 / self.d.len() as f64)
    }

    /// X D
    fn rate(&self) -> Vec<Vec<Short>> {
        let n = self.x[0].len();
        let entry =
            |i: usize, l: usize| (0..self.d.len()).fold(Complex::ZERO, |sum, m| sum + self.x[m][i] * self.d[m][l]);
        (0..self.d.len()).map(|l| (0..n).map(|i| entry(i, l)).collect()).collect()
    }

    /// X^T C X + X^T X D + D^T X^T X
    fn slope(&self, space: &Space) -> Vec<Vec<Short>> {
        let rate = self.rate();
        let n = self.x[0].len();
        let damped = |l: usize, i: usize| {
            (0..n).fold(Complex::ZERO, |sum: Short, j| sum + self.x[l][j].scale(space.c[(i, j)].to_f64()))
        };
        let order = self.d.len();
        let damped: Vec<Vec<Short>> = (0..order).map(|l| (0..n).map(|i| damped(l, i)).collect()).collect();
        let entry =
            |k: usize, l: usize| dot(&self.x[k], &damped[l]) + dot(&self.x[k], &rate[l]) + dot(&rate[k], &self.x[l]);
        (0..order).map(|k| (0..order).map(|l| entry(k, l)).collect()).collect()
    }
}

fn dot(x: &[Short], y: &[Short]) -> Short {
    x.iter().zip(y).fold(Complex::ZERO, |sum, (x, y)| sum + *x * *y)
}

/// The poles of a system, refined.
pub fn blocks(space: &Space) -> Option<Vec<Block>> {
    let mut list = Vec::with_capacity(2 * space.n);
    for part in coupled_modes(space) {
        match part[..] {
            [mode] => list.extend(of_mode(space, mode)),
            _ => list.extend(of_part(space, &part)?),
        }
    }
    let mut list: Vec<Block> = list.into_iter().map(|block| block.scale(space)).collect();
    refine(space, &mut list);
    Some(list)
}

/// The modes that dampers couple, directly or by way of others.
fn coupled_modes(space: &Space) -> Vec<Vec<usize>> {
    let n = space.n;
    let c = |i: usize, j: usize| space.c[(i, j)].to_f64();
    let is_coupled = |i: usize, j: usize| c(i, j).abs() > UNCOUPLED * (c(i, i) * c(j, j)).sqrt();
    let mut parts: Vec<Vec<usize>> = Vec::new();
    let mut is_free = vec![true; n];
    for first in 0..n {
        if !std::mem::replace(&mut is_free[first], false) {
            continue;
        }
        let (mut part, mut next) = (vec![first], 0);
        while let Some(&i) = part.get(next) {
            for (j, is_free) in is_free.iter_mut().enumerate().filter(|(j, is_free)| **is_free && is_coupled(i, *j)) {
                *is_free = false;
                part.push(j);
            }
            next += 1;
        }
        part.sort_unstable();
        parts.push(part);
    }
    parts
}

/// The poles of a single mode, s^2 + c s + k = 0.
fn of_mode(space: &Space, mode: usize) -> Vec<Block> {
    let (half, k) = (space.c[(mode, mode)].mid.scale(0.5), space.k[mode].mid);
    let square = half.square() - k;
    let unit = |size: Dd| {
        let mut x = vec![Complex::ZERO; space.n];
        x[mode] = Complex::real(size);
        x
    };
    if square.hi.abs().sqrt() < NEAR * half.hi {
        // (1, s) and (0, coupling)
        let x = [unit(Dd::ONE), unit(Dd::ZERO)];
        return vec![Block::of_two(true, Complex::real(-half), Complex::real(square), half.scale(COUPLING), x)];
    }
    let root = square.abs().sqrt();
    if square.hi < 0.0 {
        return vec![Block::of_one(Complex::new(-half, root), unit(Dd::ONE))];
    }
    // The slow one of two real poles without cancellation.
    let fast = -(half + root);
    [fast, k / fast].map(|s| Block::of_one(Complex::real(s), unit(Dd::ONE))).into()
}

/// The poles of modes that dampers couple, by the Schur form.
fn of_part(space: &Space, part: &[usize]) -> Option<Vec<Block>> {
    let n = part.len();
    let entry = |i: usize, j: usize| match (i < n, j < n) {
        (true, false) if i + n == j => space.s[part[i]],
        (false, true) if i == j + n => -space.k[part[j]].to_f64() / space.s[part[j]],
        (false, false) => -space.c[(part[i - n], part[j - n])].to_f64(),
        _ => 0.0,
    };
    let schur = SchurForm::of(DMatrix::from_fn(2 * n, 2 * n, entry))?;
    let list = schur.eigenvalues();
    let states = schur.eigenvectors(&list);
    let mut pairs: Vec<(Short, Vec<Short>)> = list
        .iter()
        .enumerate()
        .map(|(column, eigenvalue)| (eigenvalue.value, places(space, part, &states, column, eigenvalue.value)))
        .collect();
    pairs.order_by(|(a, _), (b, _)| a.im.total_cmp(&b.im).then(a.re.total_cmp(&b.re)));
    let mut blocks = Vec::new();
    while let Some((s, x)) = pairs.pop() {
        let reach = NEAR * s.re.abs();
        if s.im != 0.0 && s.im < reach {
            blocks.push(join_poles([(s, &x), (s.conj(), &x.iter().map(|z| z.conj()).collect::<Vec<_>>())], true));
            continue;
        }
        let near = pairs.iter().position(|(other, y)| (*other - s).one_norm() < reach && is_parallel(&x, y));
        if let Some(near) = near {
            let (other, y) = pairs.remove(near);
            blocks.push(join_poles([(s, &x), (other, &y)], s.im == 0.0));
            continue;
        }
        // Vectors that are close but not parallel are made orthogonal, as those of a multiple pole may be.
        let own = ShortBlock { is_real: s.im == 0.0, d: vec![vec![s]], x: vec![x.clone()] };
        let slope = own.slope(space)[0][0];
        for (other, y) in pairs.iter_mut().filter(|(other, _)| (*other - s).one_norm() < reach) {
            let damped =
                |i: usize| (0..x.len()).fold(Complex::ZERO, |sum: Short, j| sum + x[j].scale(space.c[(i, j)].to_f64()));
            let both = (0..x.len()).fold(Complex::ZERO, |sum: Short, i| sum + y[i] * (damped(i) + x[i] * (s + *other)));
            let factor = both * slope.recip();
            y.iter_mut().zip(&x).for_each(|(y, x)| *y = *y - *x * factor);
        }
        blocks.push(Block::of_one(s.into(), x.into_iter().map(Long::from).collect()));
    }
    Some(blocks)
}

/// A state's column as places of all modes, the largest of them one.
fn places(space: &Space, part: &[usize], states: &ComplexColumns, column: usize, s: Short) -> Vec<Short> {
    let mut x = vec![Complex::ZERO; space.n];
    // The larger one of the place and the rate of a mode is more accurate.
    for (i, &mode) in part.iter().enumerate() {
        let (place, rate) = (states.at(i, column), states.at(part.len() + i, column));
        let is_place = place.one_norm() >= rate.one_norm();
        x[mode] = if is_place { place.scale(1.0 / space.s[mode]) } else { rate * s.recip() };
    }
    let largest = x.iter().copied().fold(Complex::ZERO, |a: Short, b| if b.one_norm() > a.one_norm() { b } else { a });
    let inverse = largest.recip();
    x.iter_mut().for_each(|z| *z = *z * inverse);
    if s.im == 0.0 {
        x.iter_mut().for_each(|z| z.im = 0.0);
    }
    x
}

fn is_parallel(x: &[Short], y: &[Short]) -> bool {
    const MOST: f64 = 0.1;
    let apart = x.iter().zip(y).map(|(x, y)| (*x - *y).one_norm()).fold(0.0, larger);
    apart < MOST
}

/// Two poles with nearly one vector: the mean of their vectors, and the scaled difference.
fn join_poles([(a, x), (b, y)]: [(Short, &[Short]); 2], is_real: bool) -> Block {
    let (mean, half) = ((a + b).scale(0.5), (a - b).scale(0.5));
    let coupling = COUPLING * mean.re.abs();
    // Poles that coincide in binary64 have no difference of vectors to start from.
    let half = if half.one_norm() > 0.0 { half } else { Complex::real(1.0) };
    let factor = half.scale(2.0).recip().scale(coupling);
    let exact = |z: Short| if is_real { Complex::real(Dd::from(z.re)) } else { Long::from(z) };
    let middle = x.iter().zip(y).map(|(x, y)| exact((*x + *y).scale(0.5))).collect();
    let apart = x.iter().zip(y).map(|(x, y)| exact((*x - *y) * factor)).collect();
    Block::of_two(is_real, exact(mean), exact(half * half), Dd::from(coupling), [middle, apart])
}

/// The steps of a block: of D, and of the columns of X.
struct Step {
    d: Vec<Vec<Short>>,
    x: Vec<Vec<Short>>,
}

/// Refines all blocks together, each along the vectors of all others (see `analysis::poles::together`).
fn refine(space: &Space, blocks: &mut [Block]) {
    let mut last = f64::INFINITY;
    for _ in 0..STEPS {
        let own: Vec<ShortBlock> = blocks.iter().map(Block::short).collect();
        let others: Vec<(usize, ShortBlock, Option<Lu<Short>>)> = own
            .iter()
            .enumerate()
            .flat_map(|(at, block)| {
                let mirrored = (!block.is_real).then(|| (at, block.conj()));
                let direct = ShortBlock { is_real: block.is_real, d: block.d.clone(), x: block.x.clone() };
                [(at, direct)].into_iter().chain(mirrored)
            })
            .map(|(at, block)| {
                let slope = block.slope(space);
                let factors = Lu::of(Matrix::from_fn(slope.len(), slope.len(), |i, j| slope[i][j]));
                (at, block, factors)
            })
            .collect();
        let steps: Option<Vec<Step>> =
            (0..blocks.len()).map(|at| step(at, &own[at], &others, &residual(space, &blocks[at]))).collect();
        let Some(steps) = steps else { return };
        let size = |x: &[Vec<Short>]| x.iter().flatten().map(|x| x.one_norm()).fold(0.0, larger);
        let largest = steps
            .iter()
            .zip(&own)
            .map(|(step, own)| larger(size(&step.d) / size(&own.d), size(&step.x) / size(&own.x)))
            .fold(0.0, larger);
        let is_progress = largest < last && largest < 1e-2;
        if !is_progress {
            return;
        }
        last = largest;
        for (block, step) in blocks.iter_mut().zip(steps) {
            let is_real = block.is_real;
            let add = |z: &mut Long, d: Short| {
                *z = if is_real { Complex::real(z.re + Dd::from(d.re)) } else { *z + d.into() };
            };
            block.d.iter_mut().flatten().zip(step.d.into_iter().flatten()).for_each(|(z, d)| add(z, d));
            block.x.iter_mut().flatten().zip(step.x.into_iter().flatten()).for_each(|(z, d)| add(z, d));
        }
        if largest < SETTLED {
            return;
        }
    }
}

/// K X + C X D + M X D^2, rounded.
fn residual(space: &Space, block: &Block) -> Vec<Vec<Short>> {
    let (n, order) = (space.n, block.order());
    let by_d = |x: &[Vec<Long>]| -> Vec<Vec<Long>> {
        let entry = |i: usize, l: usize| (0..order).fold(Complex::ZERO, |sum: Long, m| sum + x[m][i] * block.d[m][l]);
        (0..order).map(|l| (0..n).map(|i| entry(i, l)).collect()).collect()
    };
    let rate = by_d(&block.x);
    let twice = by_d(&rate);
    let force = |i: usize, l: usize| {
        let damped = (0..n).fold(Complex::ZERO, |sum: Long, j| sum + rate[l][j].scale(space.c[(i, j)].mid));
        (twice[l][i] + damped + block.x[l][i].scale(space.k[i].mid)).to_f64()
    };
    (0..order).map(|l| (0..n).map(|i| force(i, l)).collect()).collect()
}

/// With E = - B^-1 X^T Q(X, D) the step of D is E of the block itself, and along another block b it is W of D_b W - W D = - E.
fn step(
    at: usize,
    own: &ShortBlock,
    others: &[(usize, ShortBlock, Option<Lu<Short>>)],
    residual: &[Vec<Short>],
) -> Option<Step> {
    let (order, n) = (own.d.len(), own.x[0].len());
    let mut step = Step { d: Vec::new(), x: vec![vec![Complex::ZERO; n]; order] };
    let mut is_first = true;
    for (index, other, factors) in others {
        let factors = factors.as_ref()?;
        // Columns of E.
        let error: Vec<Vec<Short>> = residual
            .iter()
            .map(|force| {
                let mut column: Vec<Short> = other.x.iter().map(|x| -dot(x, force)).collect();
                factors.solve(&mut column);
                column
            })
            .collect();
        if *index == at && std::mem::replace(&mut is_first, false) {
            step.d = (0..order).map(|k| (0..order).map(|l| error[l][k]).collect()).collect();
            continue;
        }
        if (own.mean() - other.mean()).one_norm() <= CLOSE * own.mean().one_norm() {
            continue;
        }
        let along = sylvester(&other.d, &own.d, &error)?;
        for (l, column) in along.iter().enumerate() {
            for (factor, x) in column.iter().zip(&other.x) {
                step.x[l].iter_mut().zip(x).for_each(|(d, x)| *d = *d + *x * *factor);
            }
        }
    }
    Some(step)
}

/// The columns of W with A W - W D = - E.
fn sylvester(a: &[Vec<Short>], d: &[Vec<Short>], error: &[Vec<Short>]) -> Option<Vec<Vec<Short>>> {
    let (rows, columns) = (a.len(), d.len());
    if rows == 1 && columns == 1 {
        return Some(vec![vec![-(error[0][0] * (a[0][0] - d[0][0]).recip())]]);
    }
    let matrix = Matrix::from_fn(rows * columns, rows * columns, |i, j| {
        let ((k, l), (m, o)) = ((i % rows, i / rows), (j % rows, j / rows));
        let left = if l == o { a[k][m] } else { Complex::ZERO };
        let right = if k == m { d[o][l] } else { Complex::ZERO };
        left - right
    });
    let mut w: Vec<Short> = error.iter().flatten().map(|z| -*z).collect();
    Lu::of(matrix)?.solve(&mut w);
    Some(w.chunks(rows).map(<[Short]>::to_vec).collect())
}
