//! A system in state space, decomposed into the motions of its poles: z' = A z with A T = T diag(A_1, A_2, ...). In:
//! the system and its poles. Out: a block of one state for a real pole, of two for a complex pair, of more for poles so
//! close together that separating them would lose digits; one dense block if nothing can be separated. See
//! docs/method/emit.md.
//!
//! Vectors are found by inverse iteration near each pole or group of poles and corrected together: with T^-1 A T = D +
//! E, E off the blocks, the step T (I + X) with D_i X_ij - X_ij D_j = -E_ij squares the error (Stewart 1973).

use crate::analysis::answer::{Pole, Poles};
use crate::analysis::discrete::block::{Block, NOTHING, Split, add, clean_product, product, sum, without_derivatives};
use crate::analysis::error::AnalysisError;
use crate::analysis::response::propagator::{Exogenous, StateSpace};
use crate::base::{Ball, Dd};
use crate::kernel::complex::Complex;
use crate::kernel::dense::lu::{Lu, inverse};
use crate::kernel::dense::{Matrix, dot};
use crate::kernel::real::{Float, Scalar};
use crate::system::LinearSystem;

/// Poles closer than this relative distance stay in one block.
const NEAR: f64 = 1e-4;
/// The last correction of T must be below this.
const SETTLED: f64 = 1e-21;
const MOST_STEPS: usize = 8;
/// Larger blocks are refused: their products would fill the code.
const MOST_DENSE: usize = 100;
/// Larger systems start in binary64.
const MOST_PRECISE: usize = 60;
/// The time over which energy coordinates may grow by a factor e; its choice does not matter.
const HORIZON: f64 = 1.0;

/// The blocks of a system.
pub fn split(system: &LinearSystem, poles: &Poles) -> Result<Split, AnalysisError> {
    let space = StateSpace::of(system, &held_inputs(system), HORIZON)?;
    let own = Continuous::of(system, &space);
    let size = own.a.rows();
    let groups = groups(&poles.list);
    let count: usize = groups.iter().map(Group::size).sum();
    let bases = if count == size { basis(&own.a, &groups) } else { None };
    if let Some((t, inverse, d)) = bases {
        return Ok(own.into_blocks(&groups, &t, &inverse, &d));
    }
    if size > MOST_DENSE {
        return Err(AnalysisError::too_many_states(system, size, MOST_DENSE));
    }
    let one = Group { poles: poles.list.iter().map(complex).collect(), paired: false };
    let same = Matrix::identity(size);
    let d = own.a.clone();
    let mut split = own.into_blocks(&[one], &same, &same, &d);
    split.method = "one dense step: poles are too close together to be separated";
    Ok(split)
}

/// u, u' and u'' of every input as states.
fn held_inputs(system: &LinearSystem) -> Exogenous {
    let count = 3 * system.inputs.len();
    let inputs = || system.inputs.iter().enumerate();
    Exogenous {
        count,
        generator: inputs().flat_map(|(j, _)| [1, 2].map(|p| (3 * j + p - 1, 3 * j + p, Ball::ONE))).collect(),
        force: inputs()
            .flat_map(|(j, input)| {
                let power = move |p: usize| input.b[p].iter().map(move |(i, b)| (i.index(), 3 * j + p, b.to_ball()));
                (0..3).flat_map(power)
            })
            .collect(),
        longest: vec![1.0; count],
        chained: (0..count).map(|k| k % 3 != 0).collect(),
        paired: vec![false; count],
    }
}

/// xi' = A xi + B u, y = C xi, with the direct effects of inputs.
struct Continuous {
    n: usize,
    a: Matrix<Dd>,
    b: Matrix<Dd>,
    c: Matrix<Dd>,
    to: Matrix<Dd>,
    back: Matrix<Dd>,
    direct: crate::analysis::discrete::block::Direct,
}

impl Continuous {
    fn of(system: &LinearSystem, space: &StateSpace) -> Continuous {
        let (n, size, inputs) = (system.n(), space.mechanical, system.inputs.len());
        let all = space.matrix();
        let a = Matrix::from_fn(size, size, |i, j| all[(i, j)]);
        let source = |j: usize, p: usize| size + 3 * j + p;
        let unscaled = |x: Dd, j: usize, p: usize| x.scale(1.0 / space.scale[3 * j + p]);
        let force = |p: usize| Matrix::from_fn(size, inputs, |i, j| unscaled(all[(i, source(j, p))], j, p));
        let (b, [e0, e1]) = without_derivatives(&a, [force(0), force(1), force(2)]);
        let rows = [0, 1, 2].map(|p| space.rows[p].mid());
        let at_once = |rows: &Matrix<Dd>, p: usize| {
            Matrix::from_fn(rows.rows(), inputs, |i, j| unscaled(rows[(i, source(j, p))], j, p))
        };
        let own = |rows: &Matrix<Dd>| Matrix::from_fn(rows.rows(), size, |i, j| rows[(i, j)]);
        // Outputs are rows over the motions of the coordinates.
        let mut seen = Matrix::zeros(system.outputs.len(), space.size());
        for (i, output) in system.outputs.iter().enumerate() {
            for (p, terms) in output.p.iter().enumerate() {
                for (coordinate, value) in terms {
                    for j in 0..space.size() {
                        seen[(i, j)] += value.to_ball().mid * rows[p][(coordinate.index(), j)];
                    }
                }
            }
        }
        let c = own(&seen);
        let mut direct = super::direct_of(system);
        add(&mut direct.outputs[0], &sum(&at_once(&seen, 0), &product(&c, &e0)));
        add(&mut direct.outputs[1], &sum(&at_once(&seen, 1), &product(&c, &e1)));
        add(&mut direct.outputs[2], &at_once(&seen, 2));
        let stacked = Matrix::from_fn(2 * n, space.size(), |i, j| rows[i / n][(i % n, j)]);
        let back = own(&stacked);
        add(&mut direct.state[0], &sum(&at_once(&stacked, 0), &product(&back, &e0)));
        add(&mut direct.state[1], &sum(&at_once(&stacked, 1), &product(&back, &e1)));
        direct.outputs.iter_mut().chain(&mut direct.state).for_each(without_rounding);
        Continuous { n, a, b, c, to: space.motion_rows(n), back, direct }
    }

    /// The blocks in the coordinates T.
    fn into_blocks(self, groups: &[Group], t: &Matrix<Dd>, inverse: &Matrix<Dd>, d: &Matrix<Dd>) -> Split {
        let (b, c) = (clean_product(inverse, &self.b), clean_product(&self.c, t));
        let (to, back) = (clean_product(inverse, &self.to), clean_product(&self.back, t));
        let mut first = 0;
        let blocks = groups.iter().map(|group| {
            let size = group.size();
            let rows = |m: &Matrix<Dd>| Matrix::from_fn(size, m.columns(), |i, j| m[(first + i, j)]);
            let columns = |m: &Matrix<Dd>| Matrix::from_fn(m.rows(), size, |i, j| m[(i, first + j)]);
            let block = Block {
                name: group.name(),
                rate: group.poles.iter().map(|s| s.abs()).fold(0.0, f64::max),
                a: columns(&rows(d)),
                b: rows(&b),
                c: columns(&c),
                to: rows(&to),
                back: columns(&back),
            };
            first += size;
            block
        });
        let blocks = blocks.collect();
        debug_assert!(self.back.rows() == 2 * self.n);
        Split { blocks, direct: self.direct, method: "a block of real states for each pole or complex pair" }
    }
}

/// Sets entries below the rounding error of the largest entry of their column to zero.
fn without_rounding(m: &mut Matrix<Dd>) {
    for j in 0..m.columns() {
        let most = m.column(j).iter().map(|x| x.hi.abs()).fold(0.0, f64::max);
        m.column_mut(j).iter_mut().filter(|x| x.hi.abs() <= NOTHING * most).for_each(|x| *x = Dd::ZERO);
    }
}

/// Poles of one block.
#[derive(Clone, Debug)]
struct Group {
    /// The poles with im >= 0; near the real axis both of a pair.
    poles: Vec<Complex<f64>>,
    /// Whether the conjugates belong to the block too.
    paired: bool,
}

impl Group {
    fn size(&self) -> usize {
        if self.paired { 2 * self.poles.len() } else { self.poles.len() }
    }

    fn name(&self) -> String {
        let number = |x: f64| format!("{x:.5e}");
        let of = |s: &Complex<f64>| match s.im {
            0.0 => number(s.re),
            im => format!("{} {} {}i", number(s.re), if self.paired { "+-" } else { "+" }, number(im.abs())),
        };
        match self.poles.as_slice() {
            [s] => format!("pole {} 1/s", of(s)),
            list => format!("{} poles near {} 1/s", self.size(), list.first().map_or(String::new(), of)),
        }
    }
}

fn complex(pole: &Pole) -> Complex<f64> {
    Complex::new(pole.re.to_f64(), pole.im.to_f64())
}

/// Groups of poles that are well separated from each other, in the order of their first poles.
fn groups(poles: &[Pole]) -> Vec<Group> {
    let all: Vec<Complex<f64>> = poles.iter().map(complex).collect();
    let near = |a: Complex<f64>, b: Complex<f64>| (a - b).abs() <= NEAR * a.abs().max(b.abs());
    let mut group_of: Vec<usize> = (0..all.len()).collect();
    for i in 0..all.len() {
        for j in 0..i {
            if near(all[i], all[j]) && group_of[i] != group_of[j] {
                let (from, to) = (group_of[i].max(group_of[j]), group_of[i].min(group_of[j]));
                group_of.iter_mut().filter(|g| **g == from).for_each(|g| *g = to);
            }
        }
    }
    let mut groups = Vec::new();
    for first in 0..all.len() {
        if group_of[first] != first {
            continue;
        }
        let members: Vec<Complex<f64>> = (first..all.len()).filter(|&i| group_of[i] == first).map(|i| all[i]).collect();
        let upper = members.iter().all(|s| s.im > 0.0);
        let lower = members.iter().all(|s| s.im < 0.0);
        if !lower {
            groups.push(Group { poles: members, paired: upper });
        }
    }
    groups
}

/// T, T^-1 and T^-1 A T.
type Basis = (Matrix<Dd>, Matrix<Dd>, Matrix<Dd>);

fn basis(a: &Matrix<Dd>, groups: &[Group]) -> Option<Basis> {
    let precise = || refine(a, groups, vectors::<Dd>(a, groups)?);
    if a.rows() <= MOST_PRECISE { precise() } else { refine(a, groups, vectors::<f64>(a, groups)?) }
}

/// Columns that span the motions of each group.
fn vectors<T: Float>(a: &Matrix<Dd>, groups: &[Group]) -> Option<Matrix<Dd>>
where
    Complex<T>: Scalar,
{
    let n = a.rows();
    let least =
        groups.iter().flat_map(|g| &g.poles).map(|s| s.abs()).filter(|s| *s > 0.0).fold(f64::INFINITY, f64::min);
    let parts = independent(a);
    let mut columns: Vec<Vec<Dd>> = Vec::with_capacity(n);
    for (seed, group) in groups.iter().enumerate() {
        let count = group.poles.len() as f64;
        let mean = group.poles.iter().fold(Complex::<f64>::ZERO, |sum, &s| sum + s).scale(1.0 / count);
        let aside = if mean.abs() > 0.0 { mean.abs() * 1e-10 } else { least.min(1.0) * 1e-10 };
        let im = if group.paired { mean.im } else { 0.0 };
        let shift = Complex::new(mean.re + aside, im);
        let matrix = Matrix::from_fn(n, n, |i, j| {
            let own = if i == j { shift } else { Complex::ZERO };
            Complex::new(T::of_dd(a[(i, j)] - Dd::from(own.re)), T::of_dd(Dd::from(-own.im)))
        });
        let factors = Lu::of(matrix)?;
        let mut space: Vec<Vec<Complex<T>>> =
            (0..group.poles.len()).map(|k| (0..n).map(|i| scrambled_number(i, 31 * seed + k)).collect()).collect();
        for _ in 0..4 {
            space.iter_mut().for_each(|x| factors.solve(x));
            orthonormal(&mut space)?;
        }
        confine(&mut space, &parts);
        for x in &space {
            columns.extend(real_columns(x, group.paired));
        }
    }
    (columns.len() == n).then(|| Matrix::from_fn(n, n, |i, j| columns[j][i]))
}

/// For each state, the number of its part: no entry of A leads from one part to another.
fn independent(a: &Matrix<Dd>) -> Vec<usize> {
    let n = a.rows();
    let mut parts = vec![usize::MAX; n];
    for first in 0..n {
        if parts[first] != usize::MAX {
            continue;
        }
        let mut waiting = vec![first];
        parts[first] = first;
        while let Some(i) = waiting.pop() {
            for j in 0..n {
                if parts[j] == usize::MAX && !(a[(i, j)].is_zero() && a[(j, i)].is_zero()) {
                    parts[j] = first;
                    waiting.push(j);
                }
            }
        }
    }
    parts
}

/// Above any component that a vector of one part has left in another after the iteration, which is at most 1e-10 of the
/// vector itself.
const LEFT_OVER: f64 = 1e-8;

/// Sets the entries of vectors to zero in parts that do not take part in their motion: what the iteration leaves there would
/// be states that inputs of another part seem to reach, by 1e-50 or so.
fn confine<T: Float>(space: &mut [Vec<Complex<T>>], parts: &[usize]) {
    let mut most = vec![0.0f64; parts.len()];
    for x in space.iter() {
        for (&part, z) in parts.iter().zip(x) {
            most[part] = most[part].max(z.to_f64().abs());
        }
    }
    let largest = most.iter().copied().fold(0.0, f64::max);
    for x in space {
        let entries = parts.iter().zip(x).filter(|(part, _)| most[**part] <= LEFT_OVER * largest);
        entries.for_each(|(_, z)| *z = Complex::ZERO);
    }
}

/// Numbers without a pattern, so that no vector starts orthogonal to what is looked for.
fn scrambled_number<T: Float>(i: usize, seed: usize) -> Complex<T> {
    let mixed =
        (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (seed as u64 + 7).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0x94d0_49bb_1331_11eb);
    let value = (mixed >> 40) as f64 / (1u64 << 24) as f64 - 0.5;
    Complex::real(T::of_dd(Dd::from(value)))
}

/// Gram and Schmidt, twice.
fn orthonormal<T: Float>(space: &mut [Vec<Complex<T>>]) -> Option<()> {
    for k in 0..space.len() {
        for _ in 0..2 {
            let (before, rest) = space.split_at_mut(k);
            let x = &mut rest[0];
            // Normalise first: solutions near a pole are huge.
            let most = x.iter().map(|z| z.to_f64().abs()).fold(0.0, f64::max);
            if !(most.is_finite() && most > 0.0) {
                return None;
            }
            let scale = T::ONE / T::of_dd(Dd::from(most));
            x.iter_mut().for_each(|z| *z = z.scale(scale));
            for y in before {
                let overlap = y.iter().zip(x.iter()).fold(Complex::ZERO, |sum, (&y, &x)| sum + y.conj() * x);
                x.iter_mut().zip(y.iter()).for_each(|(x, &y)| *x = *x - overlap * y);
            }
            let square = x.iter().fold(T::ZERO, |sum, z| sum + z.re * z.re + z.im * z.im);
            let root = Dd::from(square.to_f64()).sqrt();
            let inverse = T::ONE / T::of_dd(root);
            x.iter_mut().for_each(|z| *z = z.scale(inverse));
        }
    }
    Some(())
}

/// A complex vector as two real columns at right angles, each of length one; a real one as one.
fn real_columns<T: Float>(x: &[Complex<T>], paired: bool) -> Vec<Vec<Dd>> {
    let to_dd = |z: T| Dd::from(z.to_f64());
    let (re, im): (Vec<Dd>, Vec<Dd>) = x.iter().map(|z| (to_dd(z.re), to_dd(z.im))).unzip();
    if !paired {
        return vec![unit(re)];
    }
    // Rotated by the angle that makes x^T x real.
    let (squares, cross) = (dot(&re, &re) - dot(&im, &im), dot(&re, &im) * 2.0);
    let size = (squares.hi * squares.hi + cross.hi * cross.hi).sqrt();
    let cosine = if size > 0.0 { squares.hi / size } else { 1.0 };
    // The half angle.
    let (c, s) = ((0.5 * (1.0 + cosine)).sqrt(), (0.5 * (1.0 - cosine)).sqrt());
    let s = if cross.hi < 0.0 { -s } else { s };
    let turned = |a: f64, b: f64| re.iter().zip(&im).map(|(&x, &y)| x * a + y * b).collect::<Vec<Dd>>();
    vec![unit(turned(c, s)), unit(turned(-s, c))]
}

fn unit(mut x: Vec<Dd>) -> Vec<Dd> {
    let inverse = Dd::ONE / dot(&x, &x).sqrt();
    x.iter_mut().for_each(|x| *x = *x * inverse);
    x
}

/// Corrects the columns until the off-diagonal blocks are negligible.
fn refine(a: &Matrix<Dd>, groups: &[Group], mut t: Matrix<Dd>) -> Option<Basis> {
    let n = a.rows();
    let places: Vec<(usize, usize)> = groups
        .iter()
        .scan(0, |first, group| {
            *first += group.size();
            Some((*first - group.size(), group.size()))
        })
        .collect();
    let mut last = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let inverse = inverse(t.clone())?;
        let d = product(&inverse, &product(a, &t));
        let mut x = Matrix::zeros(n, n);
        let mut size = 0.0f64;
        for &(i, rows) in &places {
            for &(j, columns) in places.iter().filter(|place| place.0 != i) {
                let part = |p: usize, q: usize, r: usize, c: usize| Matrix::from_fn(r, c, |k, l| d[(p + k, q + l)].hi);
                let step =
                    sylvester(&part(i, i, rows, rows), &part(j, j, columns, columns), &part(i, j, rows, columns))?;
                for k in 0..rows {
                    for l in 0..columns {
                        size = size.max(step[(k, l)].abs());
                        x[(i + k, j + l)] = Dd::from(-step[(k, l)]);
                    }
                }
            }
        }
        if !size.is_finite() || size > 0.5 {
            return None;
        }
        if size <= SETTLED {
            return Some((t, inverse, d));
        }
        // Rounding errors prevent further progress.
        if size > 0.5 * last {
            return None;
        }
        last = size;
        t = sum(&t, &product(&t, &x));
    }
    None
}

/// X with A X - X B = C, by elimination of its few unknowns, in binary64.
fn sylvester(a: &Matrix<f64>, b: &Matrix<f64>, c: &Matrix<f64>) -> Option<Matrix<f64>> {
    let (m, n) = (a.rows(), b.rows());
    let size = m * n;
    if size == 1 {
        return Some(Matrix::fill_with(1, 1, c[(0, 0)] / (a[(0, 0)] - b[(0, 0)])));
    }
    let mut matrix = Matrix::fill_with(size, size, 0.0);
    let mut x = vec![0.0; size];
    for i in 0..m {
        for j in 0..n {
            let row = i + m * j;
            (0..m).for_each(|k| matrix[(row, k + m * j)] += a[(i, k)]);
            (0..n).for_each(|k| matrix[(row, i + m * k)] -= b[(k, j)]);
            x[row] = c[(i, j)];
        }
    }
    Lu::of(matrix)?.solve(&mut x);
    Some(Matrix::from_fn(m, n, |i, j| x[i + m * j]))
}
