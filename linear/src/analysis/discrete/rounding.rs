//! A bound of the effect of the target's rounding on the outputs, whatever the inputs from outside are. In: the cells and
//! the direct feed-through. Out: a bound that grows with the number of steps, relative to the sum of the largest sizes
//! of the parts of an output: what each input, and the initial state, contributes through each cell and directly. See
//! docs/method/emit.md.
//!
//! A step of a cell computes F w + G u with an error of at most rho unit W in a norm in which |F^j| <= r^j; so after N steps
//! the error is at most rho unit (1 + r + ... + r^(N-1)) W. W is the sum, over the inputs, of the largest norm of the states
//! that an input causes. What an input adds is bounded by these states too: G u = w' - F w, so |G u| <= (1 + r) W. A
//! pair of complex poles has such a norm, the modulus of its modal coordinate; for other cells the powers of F are
//! bounded by squaring.
//!
//! An error e of a state reaches an output in all phases only after a long time, and never completely: over the first
//! steps the sum of |c F^j e| is computed directly, including the rounding errors of that computation.

use crate::analysis::discrete::cell::{Cell, Form, Operand};
use crate::analysis::discrete::lift::{Decay, Lift};
use crate::analysis::discrete::precision::Precision;
use crate::base::{Bound, Dd, OrderBy, Power, larger};
use crate::kernel::dense::Matrix;
use crate::kernel::dense::enclosure::norm_bound;

/// A bound of the relative error of any output after N steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Rounding {
    /// Rounding error of the sum of an output.
    output: f64,
    cells: Vec<CellRounding>,
}

/// The rounding of the states of a cell.
#[derive(Clone, Debug, PartialEq)]
struct CellRounding {
    name: String,
    /// The error of one step, and how errors of earlier steps add up.
    step: f64,
    growth: Growth,
    /// The effect on outputs of errors of the latest steps; none if no output sees the cell, or too many do.
    felt: Option<Felt>,
}

/// The error of the outputs that see a cell, relative to the largest size of its part.
#[derive(Clone, Debug, PartialEq)]
struct Felt {
    /// By the errors of the last 1, 2, 4, ..., 2^[`FOLLOWED`] steps, for the output with the largest effect.
    sums: Vec<f64>,
    /// |F^j| for the number of steps of the last sum.
    kept: f64,
}

/// Bounds of |1| + |F| + ... + |F^(N-1)|.
#[derive(Clone, Debug, PartialEq)]
enum Growth {
    /// |F^j| = r^j; the number is 1 - r, negative if the motion grows.
    Geometric(f64),
    /// For N = 1, 2, 4, 8, ...
    Doubling(Vec<f64>),
}

/// Bounds are stored for up to 2^40 steps.
const DOUBLINGS: usize = 40;
/// Errors are followed into the outputs for 2^10 steps.
const FOLLOWED: usize = 10;
/// Limit on the products of one step, over all cells and outputs, up to which errors are followed: a tenth of a second.
const MOST_FOLLOWED: usize = 50_000;
/// Products of several rounding errors, and the rounding of the bound itself.
const UP: f64 = 1.000_01;

impl Rounding {
    /// The bound after `steps` steps: |emitted - exact| is at most this times the sum of the largest sizes that the parts
    /// of the output have had. Infinite if nothing can be said, as for a motion that grows beyond its inputs.
    pub fn error_after(&self, steps: u64) -> Bound {
        let worst = self.cells.iter().map(|cell| cell.after(steps));
        self.relative(worst.fold(0.0, larger))
    }

    /// A bound for each block, by its name: |emitted - exact| is at most the sum, over the blocks, of this times the sum of
    /// the largest sizes that the parts of the output by the block have had, and for the direct part of the bound of any
    /// block.
    pub fn errors_after(&self, steps: u64) -> impl Iterator<Item = (&str, Bound)> {
        self.cells.iter().map(move |cell| (&*cell.name, self.relative(cell.after(steps))))
    }

    /// The error of the states of a cell, and of the sum of an output.
    fn relative(&self, of_states: f64) -> Bound {
        let bound = (self.output + of_states) * UP;
        // The roundings are those of the emitted states, which exceed the exact ones by the error itself.
        Bound::by_proof(if bound < 1.0 { bound / (1.0 - bound) * UP } else { f64::INFINITY })
    }
}

impl CellRounding {
    /// The accumulated effect of the errors of this many steps.
    fn after(&self, steps: u64) -> f64 {
        let whole = self.step * self.growth.after(steps);
        let Some(felt) = &self.felt else { return whole };
        let of_latest = match felt.sums.get(doublings(steps)) {
            Some(sum) => *sum,
            None => felt.sums[FOLLOWED] + self.step * felt.kept * self.growth.after(steps - (1 << FOLLOWED)) * UP,
        };
        of_latest.min(whole)
    }
}

/// The least i for which 2^i is at least this.
fn doublings(steps: u64) -> usize {
    (64 - steps.saturating_sub(1).leading_zeros()) as usize
}

impl Growth {
    fn after(&self, steps: u64) -> f64 {
        let n = steps as f64;
        match self {
            Growth::Geometric(lost) if *lost > 0.0 => n.min(UP / lost),
            Growth::Geometric(0.0) => n,
            Growth::Geometric(lost) => (libm::expm1(n * libm::log1p(-lost)) / -lost * UP).max(n),
            Growth::Doubling(sums) => sums.get(doublings(steps)).copied().unwrap_or(f64::INFINITY),
        }
    }

    /// A bound of |F^j| for j = 2^FOLLOWED, and of all powers before it.
    fn powers(&self) -> [f64; 2] {
        match self {
            Growth::Geometric(lost) => {
                let last = libm::exp((1u64 << FOLLOWED) as f64 * libm::log1p(-lost)) * UP;
                [last, larger(last, 1.0)]
            }
            // A sum of norms exceeds each of them.
            Growth::Doubling(sums) => [sums[FOLLOWED + 1] / sums[FOLLOWED] * UP - 1.0, sums[FOLLOWED]],
        }
    }
}

/// The bound for these cells and this direct feed-through, one row for each output.
pub fn rounding(cells: &[Cell], direct: &[Vec<(Operand, f64)>], precision: Precision) -> Rounding {
    let unit = precision.unit();
    let frames: Vec<Frame> = cells.iter().map(Frame::of).collect();
    // For each output the number of its terms, and how much larger their sum may be than the output.
    let mut terms: Vec<(usize, f64)> = direct.iter().map(|direct| (direct.len(), 1.0)).collect();
    for (cell, frame) in cells.iter().zip(&frames) {
        for (output, row) in rows(cell) {
            let (count, most) = &mut terms[output];
            *count += row.iter().filter(|c| **c != 0.0).count();
            let size: f64 = row.iter().zip(&frame.most).map(|(c, most)| c.abs() * most).sum();
            if size > 0.0 {
                *most = larger(*most, size / frame.norm.dual(&row));
            }
        }
    }
    // Coefficient and product of each term, a difference of inputs, and the sums.
    let output = terms.into_iter().map(|(count, most)| (count as f64 + 3.0) * most * unit).fold(0.0, larger);
    let products: usize = cells.iter().map(|cell| cell.form.products()).sum();
    let follow = products * direct.len() <= MOST_FOLLOWED;
    let of_cell = |(cell, frame): (&Cell, Frame)| CellRounding {
        name: cell.name.clone(),
        step: frame.step(cell) * unit,
        felt: if follow { frame.felt_errors(cell, unit) } else { None },
        growth: frame.growth,
    };
    Rounding { output, cells: cells.iter().zip(frames).map(of_cell).collect() }
}

/// The outputs that a cell contributes to, ascending, each with the contribution of every state.
fn rows(cell: &Cell) -> impl Iterator<Item = (usize, Vec<f64>)> {
    let of_state = |(state, seen): (usize, &'_ Vec<(usize, f64)>)| {
        seen.iter().map(move |&(output, c)| (output, state, c)).collect::<Vec<_>>()
    };
    let mut seen: Vec<(usize, usize, f64)> = cell.output.iter().enumerate().flat_map(of_state).collect();
    seen.order_by_key(|(output, ..)| *output);
    let mut seen = seen.into_iter().peekable();
    let states = cell.output.len();
    std::iter::from_fn(move || {
        let &(output, ..) = seen.peek()?;
        let mut row = vec![0.0; states];
        while let Some((_, state, c)) = seen.next_if(|(next, ..)| *next == output) {
            row[state] += c;
        }
        Some((output, row))
    })
}

/// The norm in which the steps of a cell are bounded.
enum Norm {
    Euclidean,
    /// |k x + mu v|, mu by its real and imaginary part.
    Modal {
        k: f64,
        mu: [f64; 2],
    },
}

impl Norm {
    fn length(&self, w: &[f64]) -> f64 {
        match self {
            Norm::Euclidean => w.iter().map(|x| x * x).sum::<f64>().sqrt(),
            Norm::Modal { k, mu } => hypotenuse(k * w[0] + mu[0] * w[1], mu[1] * w[1]),
        }
    }

    /// The largest length of vectors whose entries are at most this large.
    fn longest(&self, w: &[f64]) -> f64 {
        match self {
            Norm::Euclidean => self.length(w),
            Norm::Modal { .. } => self.length(&[w[0], 0.0]) + self.length(&[0.0, w[1]]),
        }
    }

    /// The largest |c . w| of all w of length one, for entries of c of at most this size.
    fn largest_dual(&self, c: &[f64]) -> f64 {
        match self {
            Norm::Euclidean => self.length(c),
            Norm::Modal { k, mu } => hypotenuse(c[0] / k, (c[1] + c[0] * (mu[0] / k).abs()) / mu[1]),
        }
    }

    /// The largest |c . w| of all w of length one.
    fn dual(&self, c: &[f64]) -> f64 {
        match self {
            Norm::Euclidean => self.length(c),
            Norm::Modal { k, mu } => hypotenuse(c[0] / k, (c[1] - c[0] * mu[0] / k) / mu[1]),
        }
    }
}

/// Square roots of sums are the same on every machine; `hypot` is not.
fn hypotenuse(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}

/// A cell's norm, and what follows from it.
struct Frame {
    norm: Norm,
    growth: Growth,
    /// 1 + |F|: an input adds at most this times the largest length of the states that it causes.
    added: f64,
    /// The largest size of each state at length one.
    most: Vec<f64>,
}

/// The terms that inputs add to a state, at length one of the states that they cause.
struct Driven {
    count: f64,
    /// The largest size of an input's terms; of those that are multiplied by a coefficient.
    size: f64,
    multiplied: f64,
}

impl Driven {
    /// Errors of the coefficients and products of all terms, and of their sums with a number of that size.
    fn error(&self, beside: f64) -> f64 {
        if self.count == 0.0 { 0.0 } else { 2.0 * self.multiplied + self.count * (beside + self.size) }
    }
}

impl Frame {
    fn of(cell: &Cell) -> Frame {
        let whole = |f: Matrix<f64>| {
            let (n, added) = (f.rows(), 1.0 + norm(&f) * UP);
            Frame::new(Norm::Euclidean, Growth::Doubling(powers(f)), added, n)
        };
        if let Some(frame) = modal(&cell.form) {
            return frame;
        }
        match &cell.form {
            Form::Keep(r) => whole(Matrix::fill_with(1, 1, *r)),
            Form::Lose(d) => Frame::new(Norm::Euclidean, Growth::Geometric(*d), 1.0 + (1.0 - d).abs(), 1),
            Form::Pair(lift) => whole(lift.matrix().map(Dd::to_f64)),
            Form::Dense { turned, rows: e } => {
                let own = if *turned { -1.0 } else { 1.0 };
                whole(Matrix::from_fn(e.len(), e.len(), |i, j| e[i][j] + if i == j { own } else { 0.0 }))
            }
        }
    }

    fn new(norm: Norm, growth: Growth, added: f64, size: usize) -> Frame {
        let unit = |j: usize| (0..size).map(|i| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
        let most = (0..size).map(|j| norm.dual(&unit(j)) * UP).collect();
        Frame { norm, growth, added, most }
    }

    /// The largest error of one step, in units of the roundoff.
    fn step(&self, cell: &Cell) -> f64 {
        let error = match (&cell.form, self.errors(cell).as_slice()) {
            (Form::Pair(lift), [x, v]) => {
                // The error of v reaches x in the same step.
                self.norm.length(&[*x, 0.0]) + v * self.norm.length(&[lift.p, 1.0])
            }
            (_, errors) => self.norm.longest(errors),
        };
        error * UP
    }

    /// The largest error of each state in one step, in units of the roundoff; for a lifted pair without what x takes over
    /// from v.
    fn errors(&self, cell: &Cell) -> Vec<f64> {
        match &cell.form {
            Form::Keep(r) => {
                let own = if *r == 0.0 { 0.0 } else { 2.0 * r.abs() };
                vec![own + self.driven(cell, 0).error(if *r == 0.0 { 0.0 } else { r.abs() })]
            }
            // Coefficient and product, the change with its inputs, and the sum, which is the new state.
            Form::Lose(d) => vec![2.0 * d.abs() + self.driven(cell, 0).error(d.abs()) + 1.0],
            Form::Pair(lift) => self.of_pair(cell, lift).to_vec(),
            Form::Dense { rows, .. } => {
                let rows = rows.iter().enumerate().map(|(i, row)| {
                    let own: f64 = row.iter().zip(&self.most).map(|(e, most)| e.abs() * most).sum();
                    let many = row.iter().filter(|e| **e != 0.0).count() as f64;
                    let driven = self.driven(cell, i);
                    let inputs = if driven.count == 0.0 { 0.0 } else { 2.0 * driven.multiplied };
                    2.0 * own + inputs + (many + driven.count) * (own + driven.size) + self.most[i]
                });
                rows.collect()
            }
        }
    }

    /// The effect on the outputs of the errors of the latest steps.
    fn felt_errors(&self, cell: &Cell, unit: f64) -> Option<Felt> {
        let errors = self.errors(cell);
        // The directions in which the states are off, their magnitudes, and their lengths.
        let directions: Vec<(Vec<f64>, f64, f64)> = (errors.iter().enumerate())
            .map(|(i, error)| {
                let mut direction = vec![0.0; errors.len()];
                direction[i] = 1.0;
                if let (Form::Pair(lift), 1) = (&cell.form, i) {
                    direction[0] = lift.p;
                }
                let length = self.norm.length(&direction);
                (direction, error * unit, error * unit * length)
            })
            .collect();
        let [kept, largest] = self.growth.powers();
        let mut sums: Option<Vec<f64>> = None;
        for (_, row) in rows(cell) {
            if row.iter().all(|c| *c == 0.0) {
                continue;
            }
            let whole = self.norm.dual(&row);
            if whole < 1e-280 {
                // Rounding errors below the range of normal numbers are larger than assumed here.
                return None;
            }
            // The rounding errors of the row itself, and a bound of its magnitude in later steps.
            let (mut row, mut lost, mut sum) = (row, 0.0, 0.0);
            let (mut before, mut rounded) = (row.clone(), row.clone());
            let lengths: f64 = directions.iter().map(|(.., length)| length).sum();
            let mut found = Vec::new();
            for step in 1..=1u64 << FOLLOWED {
                for (direction, error, _) in &directions {
                    // And the rounding of this sum itself.
                    let (mut felt, mut size) = (0.0f64, 0.0);
                    for k in 0..row.len() {
                        let product = row[k] * direction[k];
                        felt += product;
                        size += product.abs();
                    }
                    sum += (felt.abs() + row.len() as f64 * f64::EPSILON * size) * error;
                }
                sum += lost * largest * lengths;
                if step.is_power_of_two() {
                    found.push(sum / whole * UP);
                }
                cell.form.before(&row, &mut before, &mut rounded);
                std::mem::swap(&mut row, &mut before);
                lost += self.norm.largest_dual(&rounded) * UP;
            }
            match &mut sums {
                None => sums = Some(found),
                Some(sums) => sums.iter_mut().zip(found).for_each(|(sum, found)| *sum = larger(*sum, found)),
            }
        }
        sums.map(|sums| Felt { sums, kept })
    }

    /// The errors of x and v in a lifted step: v - c v + inputs - k x, then x + p v + inputs.
    fn of_pair(&self, cell: &Cell, lift: &Lift) -> [f64; 2] {
        let (x, v) = (self.most[0], self.most[1]);
        let (lost, kept) = match lift.decay {
            Decay::Lose(0.0) => (0.0, 1.0),
            Decay::Lose(c) => (2.0 * c.abs() + (1.0 - c).abs(), (1.0 - c).abs()),
            Decay::Keep(r) => (2.0 * r.abs(), r.abs()),
        };
        // The last sum is the new state.
        let restored = if lift.k == 0.0 { 0.0 } else { 2.0 * lift.k * x + v };
        let in_v = lost * v + self.driven(cell, 1).error(kept * v) + restored;
        let advanced = if lift.p == 1.0 { 0.0 } else { 2.0 * lift.p * v };
        let in_x = advanced + x + lift.p * v + self.driven(cell, 0).error(x + lift.p * v);
        [in_x, in_v]
    }

    /// The contribution of inputs to a state.
    fn driven(&self, cell: &Cell, state: usize) -> Driven {
        let mut found = Driven { count: cell.input[state].len() as f64, size: 0.0, multiplied: 0.0 };
        for input in inputs(cell) {
            let own = || cell.input[state].iter().filter(|(operand, _)| index(*operand) == input);
            let sum: f64 = own().map(|(_, g)| g.abs()).sum();
            let multiplied: f64 = own().map(|(_, g)| g.abs()).filter(|g| *g != 1.0).sum();
            let per_length = self.added / self.added_by(cell, input) * UP;
            found.size = larger(found.size, sum * per_length);
            found.multiplied = larger(found.multiplied, multiplied * per_length);
        }
        found
    }

    /// The least length of what an input of size one adds to the states: in the first step, in which interpolated inputs
    /// have no earlier sample, or in a later one.
    fn added_by(&self, cell: &Cell, input: Option<usize>) -> f64 {
        let column = |first: bool| {
            let of = |state: &Vec<(Operand, f64)>| -> f64 {
                let seen = |o: Operand| index(o) == input && !(first && matches!(o, Operand::Ramped(_)));
                state.iter().filter(|(operand, _)| seen(*operand)).map(|(_, g)| g).sum()
            };
            let mut column: Vec<f64> = cell.input.iter().map(of).collect();
            if let Form::Pair(lift) = &cell.form {
                // x follows v.
                column[0] += lift.p * column[1];
            }
            column
        };
        let lengths = [true, false].map(column).map(|column| self.norm.length(&column));
        // If nothing is added at first, nothing is rounded.
        if lengths[0] == 0.0 { lengths[1] } else { lengths[0].min(lengths[1]) }
    }
}

impl Form {
    /// The number of products in a step.
    fn products(&self) -> usize {
        match self {
            Form::Keep(_) | Form::Lose(_) => 1,
            Form::Pair(_) => 3,
            Form::Dense { rows, .. } => rows.len() * rows.len(),
        }
    }

    /// Sets `before` to the row c F of a row c, and `rounded` to a bound of the rounding of each of its entries. The sign is that
    /// of a step that does not turn by more than a quarter: sizes do not depend on it.
    fn before(&self, c: &[f64], before: &mut [f64], rounded: &mut [f64]) {
        match self {
            Form::Keep(r) => (before[0], rounded[0]) = (c[0] * r, (c[0] * r).abs()),
            Form::Lose(d) => (before[0], rounded[0]) = (c[0] - c[0] * d, c[0].abs() * (1.0 + d.abs())),
            Form::Pair(lift) => {
                let (keep, size) = match lift.decay {
                    Decay::Lose(c) => (1.0 - c, 1.0 + c.abs()),
                    Decay::Keep(r) => (r, r.abs()),
                };
                // v' reaches x' as well.
                let of_v = c[1] + c[0] * lift.p;
                let most = c[1].abs() + (c[0] * lift.p).abs();
                (before[0], rounded[0]) = (c[0] - of_v * lift.k, c[0].abs() + most * lift.k.abs());
                (before[1], rounded[1]) = (of_v * keep, most * size);
            }
            Form::Dense { turned, rows } => {
                let sign = if *turned { -1.0 } else { 1.0 };
                let column = |j: usize| rows.iter().zip(c).map(move |(row, c)| row[j] * c);
                for j in 0..c.len() {
                    before[j] = column(j).sum::<f64>() + sign * c[j];
                    rounded[j] = column(j).map(f64::abs).sum::<f64>() + c[j].abs();
                }
            }
        }
        // Each entry has at most three operations beside those of a sum.
        let each = (c.len() as f64 + 3.0) * f64::EPSILON;
        rounded.iter_mut().for_each(|size| *size *= each);
    }
}

/// The inputs that act on a cell. All states of signals count as one.
fn inputs(cell: &Cell) -> Vec<Option<usize>> {
    let mut found: Vec<Option<usize>> = cell.input.iter().flatten().map(|(operand, _)| index(*operand)).collect();
    found.sort_unstable();
    found.dedup();
    found
}

fn index(operand: Operand) -> Option<usize> {
    match operand {
        Operand::Input(j) | Operand::Ramped(j) | Operand::Slope(j) => Some(j),
        Operand::Signal(_) => None,
    }
}

/// The modulus of a modal coordinate, if two states have complex poles that are well separated.
fn modal(form: &Form) -> Option<Frame> {
    let (norm, growth, r) = match form {
        Form::Pair(lift) => {
            let (k, p) = (lift.k, lift.p);
            let (keep, lost) = match lift.decay {
                // 1 - r, r = sqrt(1 - c)
                Decay::Lose(c) => (1.0 - c, c / (1.0 + (1.0 - c).sqrt())),
                Decay::Keep(r) => (r, 1.0 - r.sqrt()),
            };
            // The step is [1 - p k, p keep; -k, keep].
            (eigenvector([[-p * k, p * keep], [-k, keep - 1.0]])?, lost, keep.sqrt())
        }
        Form::Dense { turned, rows } if rows.len() == 2 => {
            let [a, b, c, d] = [rows[0][0], rows[0][1], rows[1][0], rows[1][1]];
            let sign = if *turned { -1.0 } else { 1.0 };
            // r^2 - 1 = det(E +- 1) - 1
            let terms = [sign * a, sign * d, a * d, -b * c];
            let more: f64 = terms.iter().sum::<f64>() + 8.0 * f64::EPSILON * terms.iter().map(|x| x.abs()).sum::<f64>();
            let r = (1.0 + more).max(0.0).sqrt();
            (eigenvector([[a, b], [c, d]])?, -more / (1.0 + r), r)
        }
        _ => return None,
    };
    Some(Frame::new(norm, Growth::Geometric(growth), 1.0 + r, 2))
}

/// zeta = k x + mu v, (k, mu) the left eigenvector of E: of F = E + 1 as well.
fn eigenvector([[a, b], [c, d]]: [[f64; 2]; 2]) -> Option<Norm> {
    let half = (a - d) / 2.0;
    let imaginary = (-half * half - b * c).max(0.0).sqrt();
    let mu = [-half, imaginary];
    let apart = imaginary > 0.05 * hypotenuse(mu[0], mu[1]) && c != 0.0;
    apart.then_some(Norm::Modal { k: c, mu })
}

/// Bounds of 1 + |F| + ... over 2^i steps: S(2 m) <= S(m) (1 + |F^m|).
fn powers(f: Matrix<f64>) -> Vec<f64> {
    let n = f.rows();
    let mut power = f;
    let mut sums = vec![1.0];
    // The error of the computed power: its entries were rounded once.
    let mut off = f64::EPSILON * (1.0 + norm_bound(n, n, |i, j| power[(i, j)].abs()));
    for i in 0..DOUBLINGS {
        let size = norm(&power);
        let entries = norm_bound(n, n, |i, j| power[(i, j)].abs());
        sums.push(sums[i] * (1.0 + size + off) * UP);
        off = 2.0 * size * off + off * off + (n as f64 + 2.0) * f64::EPSILON * entries * entries;
        power = Matrix::from_fn(n, n, |i, j| (0..n).map(|k| power[(i, k)] * power[(k, j)]).sum());
    }
    sums
}

/// A bound of the 2-norm.
fn norm(f: &Matrix<f64>) -> f64 {
    let n = f.rows();
    let bound = norm_bound(n, n, |i, j| f[(i, j)].abs());
    if n != 2 {
        return bound;
    }
    let squares = (0..4).map(|i| f[(i / 2, i % 2)].power(2)).sum::<f64>();
    let det = f[(0, 0)] * f[(1, 1)] - f[(0, 1)] * f[(1, 0)];
    let apart = (squares * squares - 4.0 * det * det).max(0.0).sqrt();
    // A root of a difference that cancels is off by at most 1e-7 of the whole.
    bound.min(((squares + apart) / 2.0).sqrt() * UP)
}

#[cfg(test)]
mod extremes;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::discrete::lift::lift;
    use crate::analysis::discrete::turn::turn;
    use std::ops::{Add, Mul, Sub};

    pub(super) fn cell(form: Form, size: usize) -> Cell {
        let none = || vec![Vec::new(); size];
        let (input, output) = (none(), vec![Vec::new(); size]);
        Cell { name: String::new(), form, input, output, to: vec![], back: vec![], start: vec![1.0; size] }
    }

    /// One step with errors in units of the roundoff: the states after it, and the largest error of each, from
    /// coefficients, products and sums.
    fn step(form: &Form, w: &[f64]) -> (Vec<f64>, Vec<f64>) {
        match form {
            Form::Keep(r) => (vec![r * w[0]], vec![2.0 * (r * w[0]).abs()]),
            Form::Lose(d) => (vec![w[0] - d * w[0]], vec![2.0 * (d * w[0]).abs() + (w[0] - d * w[0]).abs()]),
            Form::Dense { rows, .. } => {
                let size = |row: &Vec<f64>| row.iter().zip(w).map(|(e, w)| (e * w).abs()).sum::<f64>();
                let change = |row: &Vec<f64>| row.iter().zip(w).map(|(e, w)| e * w).sum::<f64>();
                let next: Vec<f64> = rows.iter().zip(w).map(|(row, w)| w + change(row)).collect();
                let of = |(row, next): (&Vec<f64>, &f64)| (1.0 + w.len() as f64) * size(row) + next.abs();
                (next.clone(), rows.iter().zip(&next).map(of).collect())
            }
            Form::Pair(lift) => {
                let (x, v) = (w[0], w[1]);
                let (kept, lost) = match lift.decay {
                    Decay::Lose(c) => (v - c * v, 2.0 * (c * v).abs() + (v - c * v).abs()),
                    Decay::Keep(r) => (r * v, 2.0 * (r * v).abs()),
                };
                let sign = if lift.turned { -1.0 } else { 1.0 };
                let next = kept - lift.k * x;
                let in_v = lost + 2.0 * (lift.k * x).abs() + next.abs();
                let moved = x + lift.p * next;
                let in_x = 2.0 * (lift.p * next).abs() + moved.abs();
                // The error of v reaches x in the same step.
                (vec![sign * moved, sign * next], vec![in_x + lift.p * in_v, in_v])
            }
        }
    }

    /// The error of the first state after `steps` steps if all rounding errors conspire, in units of the roundoff and
    /// of the largest magnitude of the state.
    fn worst_case(form: &Form, start: &[f64], steps: usize) -> f64 {
        let n = start.len();
        let unit = |j: usize| (0..n).map(|i| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
        let columns: Vec<Vec<f64>> = (0..n).map(|j| step(form, &unit(j)).0).collect();
        let mut states = vec![start.to_vec()];
        let mut errors = Vec::new();
        for _ in 0..steps {
            let (next, error) = step(form, &states[states.len() - 1]);
            states.push(next);
            errors.push(error);
        }
        // As if an input kept the motion at its largest magnitude.
        let error: Vec<f64> = (0..n).map(|i| errors.iter().map(|error| error[i]).fold(0.0, f64::max)).collect();
        // The effect of a change of the states before the last steps on the first state at the end.
        let mut felt = unit(0);
        let mut total = 0.0;
        for _ in 0..steps {
            total += felt.iter().zip(&error).map(|(a, b)| (a * b).abs()).sum::<f64>();
            felt = columns.iter().map(|column| column.iter().zip(&felt).map(|(f, g)| f * g).sum()).collect();
        }
        total / states.iter().map(|w| w[0].abs()).fold(0.0, f64::max)
    }

    /// Conspiring rounding errors stay below the bound, and come near it: oscillators without and with damping, turning
    /// by little and by more than a quarter, critical ones, single states, a dense step.
    #[test]
    fn the_bound_exceeds_the_worst_roundings_but_not_by_far() {
        let mut forms: Vec<(Form, Vec<f64>)> = Vec::new();
        let oscillators = [(400.0, 0.0), (400.0, 2.0), (1e4, 0.0), (4e4, 3.0), (9e4, 0.0), (1.0, 0.0), (4e4, 100.0)];
        for (k, c) in oscillators.into_iter().chain([(1e4, 200.0), (100.0, 20.0)]) {
            let a = Matrix::from_fn(2, 2, |i, j| Dd::from([[0.0, 1.0], [-k, -c]][i][j]));
            let turn = turn(&a.map(|x| x * 0.01), None).expect("in range");
            let lifted = lift(&turn, None, Precision::Double).expect("a form");
            forms.push((Form::Pair(lifted.lift), vec![1.0, 0.3]));
        }
        forms.extend([(Form::Keep(0.3), vec![1.0]), (Form::Lose(1e-4), vec![1.0]), (Form::Lose(0.0), vec![1.0])]);
        let turn = vec![vec![0.1f64.cos() - 1.0, 0.1f64.sin()], vec![-0.1f64.sin(), 0.1f64.cos() - 1.0]];
        forms.push((Form::Dense { turned: false, rows: turn }, vec![1.0, 0.0]));
        let mut ratios = Vec::new();
        for (form, start) in &forms {
            for steps in [1023, 65535] {
                let bound = rounding(&[cell(form.clone(), start.len())], &[], Precision::Double);
                let bound = (bound.error_after(steps).value() - bound.output) / Precision::Double.unit();
                let worst = worst_case(form, start, steps as usize);
                let over = bound / worst;
                assert!((1.0..100.0).contains(&over), "{form:?}, {steps}: {bound:e} for {worst:e}");
                ratios.push(over);
            }
        }
        ratios.sort_by(f64::total_cmp);
        assert!(ratios[ratios.len() / 2] < 15.0, "{ratios:?}");
    }

    /// One step as it is emitted, in binary64 or in double-double.
    pub(super) fn advance<T>(cell: &Cell, w: &[T], u: f64) -> Vec<T>
    where
        T: Copy + From<f64> + Add<Output = T> + Sub<Output = T> + Mul<Output = T>,
    {
        let of = T::from;
        let driven = |sum: T, state: usize| cell.input[state].iter().fold(sum, |sum, &(_, g)| sum + of(g) * of(u));
        match &cell.form {
            Form::Keep(r) => vec![driven(of(*r) * w[0], 0)],
            Form::Lose(d) => vec![w[0] + (driven(of(0.0), 0) - of(*d) * w[0])],
            Form::Dense { turned, rows } => {
                let sign = of(if *turned { -1.0 } else { 1.0 });
                let change = |i: usize| {
                    rows[i].iter().zip(w).fold(driven(of(0.0), i), |sum, (&e, &w)| sum + of(e) * w) + sign * w[i]
                };
                (0..rows.len()).map(change).collect()
            }
            Form::Pair(Lift { turned, decay, k, p }) => {
                let sign = of(if *turned { -1.0 } else { 1.0 });
                let kept = match decay {
                    Decay::Lose(c) => w[1] - of(*c) * w[1],
                    Decay::Keep(r) => of(*r) * w[1],
                };
                let v = driven(sign * kept, 1) - sign * (of(*k) * w[0]);
                vec![driven(sign * w[0] + of(*p) * v, 0), v]
            }
        }
    }

    /// The bound of the first state after some steps, and its largest error where at each step the one of eight inputs is
    /// taken that makes the errors of the states largest: both relative to the largest size of its part.
    fn bound_and_error(form: Form, input: &[f64], steps: u64) -> (f64, f64) {
        let mut cell = cell(form, input.len());
        cell.input = input.iter().map(|&g| if g == 0.0 { vec![] } else { vec![(Operand::Input(0), g)] }).collect();
        cell.output[0] = vec![(0, 1.0)];
        let frame = Frame::of(&cell);
        let (mut w, mut truth) = (vec![0.0; input.len()], vec![Dd::ZERO; input.len()]);
        let errors = |w: &[f64], truth: &[Dd]| -> Vec<f64> {
            w.iter().zip(truth).map(|(&w, &truth)| (Dd::from(w) - truth).to_f64()).collect()
        };
        let (mut largest, mut seen) = (0.0f64, 0.0f64);
        let mut bits = 88_172_645_463_325_252u64;
        for _ in 0..steps {
            let trials = (0..8).map(|_| {
                bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let u = (bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
                (advance(&cell, &w, u), advance(&cell, &truth, u))
            });
            let badness = |(w, truth): &(Vec<f64>, Vec<Dd>)| frame.norm.length(&errors(w, truth));
            let worst = trials.max_by(|a, b| badness(a).total_cmp(&badness(b)));
            (w, truth) = worst.expect("eight trials");
            largest = largest.max(frame.norm.length(&truth.iter().map(|x| x.to_f64()).collect::<Vec<f64>>()));
            seen = seen.max(errors(&w, &truth)[0].abs());
        }
        let bound = rounding(&[cell], &[Vec::new()], Precision::Double).error_after(steps).value();
        (bound, seen / (largest * frame.most[0]))
    }

    /// A motion that takes 50,000 steps for a period: after a thousand of them an output of its displacement has hardly felt
    /// errors of the velocity. Conspiring errors stay below the bound, which is far below that of all phases.
    #[test]
    fn errors_that_an_output_does_not_feel_yet_are_not_in_the_bound() {
        for (k, c) in [(0.0157, 0.0), (0.0157, 0.15), (2.0, 0.3)] {
            let a = Matrix::from_fn(2, 2, |i, j| Dd::from([[0.0, 1.0], [-k, -c]][i][j]));
            let turn = turn(&a.map(|x| x * 1e-3), None).expect("in range");
            let form = Form::Pair(lift(&turn, None, Precision::Double).expect("a form").lift);
            let mut cell = cell(form.clone(), 2);
            cell.output[0] = vec![(0, 1.0)];
            let frame = Frame::of(&cell);
            let largest = frame.norm.dual(&[1.0, 0.0]);
            // The row of the output in double-double, by the columns of a step.
            let columns: Vec<Vec<f64>> = [[1.0, 0.0], [0.0, 1.0]].iter().map(|unit| step(&form, unit).0).collect();
            let errors = frame.errors(&cell);
            let p = match form {
                Form::Pair(lift) => lift.p,
                _ => unreachable!(),
            };
            let rounding = rounding(&[cell], &[Vec::new()], Precision::Double);
            let mut row = [Dd::ONE, Dd::ZERO];
            let mut worst = 0.0;
            for step in 1..=60_000u64 {
                worst += row[0].abs().to_f64() * errors[0];
                worst += (row[0] * Dd::from(p) + row[1]).abs().to_f64() * errors[1];
                if [1, 7, 1000, 1024, 1025, 60_000].contains(&step) {
                    let bound = (rounding.error_after(step).value() - rounding.output) / Precision::Double.unit();
                    let over = bound / (worst / largest);
                    assert!((1.0..if step > 1000 { 4.0 } else { 3.0 }).contains(&over), "{k} {c} {step}: {over}");
                    // What is left is the displacement's own rounding.
                    let by_norm = rounding.cells[0].step * rounding.cells[0].growth.after(step);
                    assert!(step != 1000 || k > 1.0 || bound * Precision::Double.unit() < 0.6 * by_norm, "{k} {c}");
                }
                row = [0, 1].map(|j| row[0] * Dd::from(columns[j][0]) + row[1] * Dd::from(columns[j][1]));
            }
        }
    }

    /// Inputs can make roundings conspire, and the bound is not far above what they reach: single states, lifted pairs
    /// without and with damping, slow and turning by more than a quarter, a dense pair near a whole turn.
    #[test]
    fn inputs_that_make_roundings_conspire_come_near_the_bound() {
        let mut forms: Vec<(Form, Vec<f64>)> = vec![
            (Form::Keep(0.3), vec![0.7]),
            (Form::Lose(1e-4), vec![0.7]),
            (Form::Lose(0.0), vec![1.0]),
            (Form::Dense { turned: false, rows: vec![vec![-8e-4, 0.04], vec![-0.04, -8.1e-4]] }, vec![0.3, 0.9]),
        ];
        for (k, c) in [(400.0, 0.0), (400.0, 2.0), (9e4, 0.0), (1.0, 0.0), (1e4, 200.0)] {
            let a = Matrix::from_fn(2, 2, |i, j| Dd::from([[0.0, 1.0], [-k, -c]][i][j]));
            let turn = turn(&a.map(|x| x * 0.01), None).expect("in range");
            let lifted = lift(&turn, None, Precision::Double).expect("a form");
            forms.push((Form::Pair(lifted.lift), vec![0.0, 1.0]));
            forms.push((Form::Pair(lifted.lift), vec![-0.37, 0.61]));
        }
        for (form, input) in forms {
            for steps in [1000, 20_000] {
                let (bound, seen) = bound_and_error(form.clone(), &input, steps);
                let over = bound / seen;
                assert!((1.0..300.0).contains(&over), "{form:?} {input:?}, {steps}: {bound:e} for {seen:e}");
            }
        }
    }

    /// Two inputs that cancel in the states: each is rounded all the same.
    #[test]
    fn inputs_that_cancel_are_parts_by_themselves() {
        let mut cell = cell(Form::Keep(0.5), 1);
        cell.input = vec![vec![(Operand::Input(0), 0.7), (Operand::Input(1), -0.7)]];
        let one = rounding(&[cell.clone()], &[Vec::new()], Precision::Double).error_after(1000).value();
        let huge = 1e16 / 3.0;
        // x <- x / 2 + 0.7 u - 0.7 u: each part is 1.4 u at most, and the states are what is left of the roundings.
        let (mut x, mut largest) = (0.25f64, 0.0f64);
        for _ in 0..1000 {
            x = 0.5 * x + 0.7 * huge + -0.7 * huge;
            largest = largest.max((x - 0.0).abs());
        }
        assert!(largest <= one * 2.0 * 1.4 * huge + 0.25, "{largest:e}");
        assert!(one < 1e-14);
    }

    /// A motion that grows has no bound in terms of its size: inputs can hold the motion, and not its errors.
    #[test]
    fn a_motion_that_grows_has_no_bound_after_long() {
        let bound = rounding(&[cell(Form::Lose(-0.01), 1)], &[], Precision::Double);
        assert!(bound.error_after(100).value() < 1e-12);
        assert_eq!(bound.error_after(100_000).value(), f64::INFINITY);
    }

    /// A pair that nothing damps, seen through a millionth, beside a state that forgets at once: relative to both parts
    /// together, the worst bound is a thousand times what is seen; that of each for its own part is not.
    #[test]
    fn each_block_has_a_bound_of_its_own() {
        let a = Matrix::from_fn(2, 2, |i, j| Dd::from([[0.0, 1.0], [-400.0, 0.0]][i][j]));
        let lifted =
            lift(&turn(&a.map(|x| x * 0.01), None).expect("in range"), None, Precision::Double).expect("a form");
        let mut pair = cell(Form::Pair(lifted.lift), 2);
        let mut keep = cell(Form::Keep(0.3), 1);
        (pair.name, keep.name) = ("pair".into(), "keep".into());
        pair.input = vec![vec![], vec![(Operand::Input(0), 1.0)]];
        keep.input = vec![vec![(Operand::Input(0), 0.7)]];
        (pair.output[0], keep.output[0]) = (vec![(0, 1e-9)], vec![(0, 1.0)]);
        let frames = [Frame::of(&pair), Frame::of(&keep)];
        let steps = 20_000;
        let (mut w, mut truth) = (vec![vec![0.0; 2], vec![0.0]], vec![vec![Dd::ZERO; 2], vec![Dd::ZERO]]);
        let (mut sizes, mut seen) = ([0.0f64; 2], 0.0f64);
        let mut bits = 88_172_645_463_325_252u64;
        for _ in 0..steps {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let u = (bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
            for (i, cell) in [&pair, &keep].into_iter().enumerate() {
                (w[i], truth[i]) = (advance(cell, &w[i], u), advance(cell, &truth[i], u));
                let length = frames[i].norm.length(&truth[i].iter().map(|x| x.to_f64()).collect::<Vec<f64>>());
                sizes[i] = sizes[i].max(length * frames[i].most[0] * [1e-9, 1.0][i]);
            }
            let output = 1e-9 * w[0][0] + w[1][0];
            let exact = truth[0][0] * Dd::from(1e-9) + truth[1][0];
            seen = seen.max((Dd::from(output) - exact).to_f64().abs());
        }
        let rounding = rounding(&[pair, keep], &[Vec::new()], Precision::Double);
        let bounds: Vec<(&str, f64)> =
            rounding.errors_after(steps).map(|(name, bound)| (name, bound.value())).collect();
        assert_eq!((bounds[0].0, bounds[1].0), ("pair", "keep"));
        let worst = rounding.error_after(steps).value();
        assert!(worst == bounds[0].1 && worst > 100.0 * bounds[1].1, "{bounds:?}");
        let both = bounds[0].1 * sizes[0] + bounds[1].1 * sizes[1];
        assert!((1.0..100.0).contains(&(both / seen)), "{both:e} for {seen:e}");
        assert!(worst * (sizes[0] + sizes[1]) > 1e3 * seen, "{worst:e}");
    }
}
