//! Piecewise polynomials over samples: all steps, ramps, pulses, tables and chirps of an input as one polynomial from
//! knot to knot. In: the sources of an input, the step. Out: the polynomial's states at any sample, the samples at
//! which they must be set, and the effect on a block of a step in which the polynomial changes. See
//! docs/method/emit.md.
//!
//! The states c_k = h^k u^(k) / k! give u = sum c_k s^k, with s in steps. They are set, not added to, at the sample
//! that follows each knot: otherwise the rounding error of the highest one would grow like its power of time. If a step
//! is long relative to the pieces, a piece that is continued to the end of the step may be huge; then only the states
//! that outputs read are kept for that step, and the blocks get the rest at its end.

use crate::analysis::discrete::block::Block;
use crate::analysis::discrete::hold::{propagate, source_effect};
use crate::analysis::response::signal::{self, Piece, Source};
use crate::base::{Dd, Number, OrderBy};
use crate::kernel::dense::Matrix;
use std::cmp::Ordering;

/// More changes would make tables of megabytes.
pub const MOST_EVENTS: usize = 20_000;

/// The states of one signal.
#[derive(Clone, Debug)]
pub struct Chain {
    /// The input that it drives.
    pub input: usize,
    /// s' = R s, R times the step.
    pub generator: Matrix<Dd>,
    /// u, u' and u'' as rows over s.
    pub rows: [Vec<Dd>; 3],
    pub start: Vec<Dd>,
    /// Rotation of a harmonic in a step, minus whole turns, rad.
    pub angle: Option<Dd>,
    /// The times at which the polynomial changes, ascending; a harmonic has none.
    pub knots: Vec<Knot>,
    /// The largest value at t = 0 and the knots.
    pub largest: f64,
    pub name: String,
}

/// A time between samples.
#[derive(Clone, Copy, Debug)]
pub struct When {
    /// The first sample at or after it.
    pub tick: u64,
    /// Its distance to that sample, in steps.
    pub before: Dd,
}

/// A time after t = 0 at which a polynomial changes.
#[derive(Clone, Debug)]
pub struct Knot {
    pub when: When,
    /// The states from that time on, at that time.
    pub states: Vec<Dd>,
    /// The difference from the states just before.
    pub jump: Vec<Dd>,
}

/// Beyond this multiple of the signal's largest value, a piece is not continued to the end of a step.
const MOST_BEYOND: f64 = 4.0;

impl When {
    /// The position of a time after t = 0 among the samples; `None` beyond the range of the counter.
    pub fn of(at: &Number, step: &Number) -> Option<When> {
        let samples = at / step;
        let near = samples.to_f64().ceil();
        if !(0.0..4e9).contains(&near) {
            return None;
        }
        // The quotient may have been rounded past a whole number.
        let mut tick = near as i64;
        while (&Number::from(tick) - &samples).is_negative() {
            tick += 1;
        }
        while tick > 0 && !(&Number::from(tick - 1) - &samples).is_negative() {
            tick -= 1;
        }
        let before = (&Number::from(tick) - &samples).to_ball();
        let before = if before.contains_zero() { Dd::ZERO } else { before.mid };
        Some(When { tick: tick as u64, before })
    }
}

/// The states at t = 0 and the knots after it.
type Polynomials = (Vec<Dd>, Vec<Knot>);

/// The sum of all piecewise sources. The inner `None` means that there are none, the outer one that there are too many
/// knots.
pub fn knots(sources: &[Source], step: &Number, felt: impl Fn(&Number) -> bool) -> Option<Option<Polynomials>> {
    let lists: Vec<&[Piece]> = sources.iter().filter_map(pieces).collect();
    let Some(order) = sources.iter().filter(|source| pieces(source).is_some()).map(Source::order).max() else {
        return Some(None);
    };
    let scale = scales(order, step.to_ball().mid);
    let scaled = |piece: Option<&Piece>, time: &Number| -> Vec<Dd> {
        let derivatives = piece.map_or_else(Vec::new, |piece| piece.at_time(time));
        scale.iter().enumerate().map(|(k, &scale)| derivatives.get(k).map_or(Dd::ZERO, |x| x.mid * scale)).collect()
    };
    // The current piece of each source, counted from one.
    let mut current: Vec<usize> =
        lists.iter().map(|list| list.iter().take_while(|piece| !piece.at.is_positive()).count()).collect();
    let piece = |source: usize, count: usize| count.checked_sub(1).map(|i| &lists[source][i]);
    let whole = |current: &[usize], time: &Number| {
        let each = current.iter().enumerate().map(|(source, &count)| scaled(piece(source, count), time));
        each.fold(vec![Dd::ZERO; order], |sum, own| add(sum, own, Dd::ONE))
    };
    let start = whole(&current, &Number::ZERO);
    let later = |(source, list): (usize, &&'_ [Piece])| -> Vec<(usize, usize)> {
        (current[source]..list.len()).take_while(|&i| felt(&list[i].at)).map(|i| (source, i)).collect()
    };
    let mut changes: Vec<(usize, usize)> = lists.iter().enumerate().flat_map(later).collect();
    if changes.len() > MOST_EVENTS {
        return None;
    }
    let at = |&(source, i): &(usize, usize)| &lists[source][i].at;
    changes.order_by(|a, b| signal::chronological(at(a), at(b)));
    let mut knots: Vec<Knot> = Vec::with_capacity(changes.len());
    for together in changes.chunk_by(|a, b| signal::order(at(a), at(b)) == Ordering::Equal) {
        let time = at(&together[0]);
        let mut jump = vec![Dd::ZERO; order];
        for &(source, i) in together {
            jump = add(jump, scaled(piece(source, current[source]), time), -Dd::ONE);
            current[source] = i + 1;
            jump = add(jump, scaled(piece(source, i + 1), time), Dd::ONE);
        }
        knots.push(Knot { when: When::of(time, step)?, states: whole(&current, time), jump });
    }
    Some(Some((start, knots)))
}

fn pieces(source: &Source) -> Option<&[Piece]> {
    match source {
        Source::Pieces { pieces, .. } => Some(pieces),
        Source::Harmonic { .. } | Source::Impulse { .. } => None,
    }
}

fn add(mut sum: Vec<Dd>, own: Vec<Dd>, factor: Dd) -> Vec<Dd> {
    sum.iter_mut().zip(own).for_each(|(sum, x)| *sum += factor * x);
    sum
}

/// Whether outputs read u, u' and u'' directly.
pub type FeedThroughOrders = [bool; 3];

impl Chain {
    pub fn size(&self) -> usize {
        self.start.len()
    }

    /// The effect of the chain's states on those of a block in `steps` steps.
    pub fn effect_on(&self, block: &Block, steps: Dd, h: Dd) -> Option<Matrix<Dd>> {
        let drive = Matrix::from_fn(block.size(), self.size(), |i, j| block.b[(i, self.input)] * self.rows[0][j]);
        source_effect(&block.a, &drive, &self.generator, steps, h)
    }

    /// The knots strictly between a sample and the next one.
    fn knots_within(&self, tick: u64) -> &[Knot] {
        let first = self.knots.partition_point(|knot| knot.when.tick <= tick);
        let rest = &self.knots[first..];
        let count = rest.partition_point(|knot| knot.when.tick == tick + 1 && !knot.when.before.is_zero());
        &rest[..count]
    }

    /// The states at a sample.
    fn at(&self, tick: u64) -> Vec<Dd> {
        let count = self.knots.partition_point(|knot| knot.when.tick <= tick);
        match count.checked_sub(1).map(|i| &self.knots[i]) {
            Some(knot) => shift(&knot.states, Dd::from((tick - knot.when.tick) as f64) + knot.when.before),
            None => shift(&self.start, Dd::from(tick as f64)),
        }
    }

    /// Whether the states at a sample occur again this many samples later; those of a motion that drifts away do not.
    /// They differ only by the rounding of their times, about 1e-31 of their magnitudes.
    pub fn comes_again(&self, tick: u64, ticks: u64) -> bool {
        let (now, later) = (self.at(tick), self.at(tick + ticks));
        let sizes = self.knots.iter().map(|knot| &knot.states).chain([&now, &later]);
        let sizes = sizes.fold(vec![0.0; self.size()], |sizes: Vec<f64>, states| {
            sizes.iter().zip(states).map(|(size, x)| size.max(x.hi.abs())).collect()
        });
        now.iter().zip(&later).zip(sizes).all(|((a, b), size)| (*a - *b).hi.abs() <= 1e-25 * size)
    }

    /// Whether the piece at a sample ends before the next one, and would be huge there.
    fn is_cut(&self, tick: u64) -> bool {
        let beyond: f64 = self.at(tick).iter().skip(1).map(|x| x.hi.abs()).sum();
        !self.knots_within(tick).is_empty() && beyond > MOST_BEYOND * self.largest
    }

    /// The states with which a step begins.
    pub fn states_used(&self, tick: u64, seen: FeedThroughOrders) -> Vec<Dd> {
        let mut states = self.at(tick);
        if self.is_cut(tick) {
            let keep = |k: usize| k == 0 || seen.get(k).is_some_and(|&seen| seen);
            states.iter_mut().enumerate().filter(|(k, _)| !keep(*k)).for_each(|(_, x)| *x = Dd::ZERO);
        }
        states
    }

    /// The samples at which the states are set.
    pub fn ticks(&self) -> impl Iterator<Item = u64> + '_ {
        self.knots.iter().flat_map(|knot| {
            let tick = knot.when.tick;
            let cut = tick > 0 && !knot.when.before.is_zero() && self.is_cut(tick - 1);
            cut.then(|| tick - 1).into_iter().chain([tick])
        })
    }

    /// The effect of the signal on a block in the step to a sample, minus the effect of its states at the previous
    /// sample.
    pub fn correction(&self, block: &Block, tick: u64, seen: FeedThroughOrders, h: Dd) -> Option<Vec<Dd>> {
        let mut sum = vec![Dd::ZERO; block.size()];
        let Some(last) = tick.checked_sub(1) else { return Some(sum) };
        let within = self.knots_within(last);
        if !self.is_cut(last) {
            for knot in within {
                let own = self.solve_forced(block, vec![Dd::ZERO; block.size()], &knot.jump, knot.when.before, h)?;
                sum = add(sum, own, Dd::ONE);
            }
            return Some(sum);
        }
        let mut states = self.at(last);
        let mut time = Dd::ZERO;
        for knot in within {
            let next = Dd::ONE - knot.when.before;
            sum = self.solve_forced(block, sum, &states, next - time, h)?;
            (time, states) = (next, knot.states.clone());
        }
        sum = self.solve_forced(block, sum, &states, Dd::ONE - time, h)?;
        let given =
            self.solve_forced(block, vec![Dd::ZERO; block.size()], &self.states_used(last, seen), Dd::ONE, h)?;
        Some(add(sum, given, -Dd::ONE))
    }

    /// Solves w' = A w + b u over `steps` steps, from w and the states of u.
    fn solve_forced(&self, block: &Block, w: Vec<Dd>, states: &[Dd], steps: Dd, h: Dd) -> Option<Vec<Dd>> {
        let size = block.size();
        let drive: Vec<Dd> = (0..size).map(|i| block.b[(i, self.input)] * h).collect();
        let rate = (0..size).flat_map(|i| (0..size).map(move |j| (i, j))).map(|(i, j)| match i == j {
            true => block.a[(i, i)].hi.abs(),
            false => (block.a[(i, j)] * block.a[(j, i)]).hi.abs().sqrt(),
        });
        let turned = (rate.sum::<f64>() * (h * steps).hi).ceil().max(1.0);
        if turned > MOST_PARTS {
            let forces = Matrix::from_fn(size, self.size(), |i, j| block.b[(i, self.input)] * self.rows[0][j]);
            let forced = source_effect(&block.a, &forces, &self.generator, steps, h)?;
            let own = propagate(&block.a, &w, steps * h)?;
            let of = |i: usize| (0..self.size()).fold(Dd::ZERO, |sum, j| sum + forced[(i, j)] * states[j]);
            return Some(own.into_iter().enumerate().map(|(i, x)| x + of(i)).collect());
        }
        let part = steps / Dd::from(turned);
        let a = block.a.map(|x| x * h);
        let (mut w, mut states) = (w, states.to_vec());
        for _ in 0..turned as usize {
            w = series(&a, &drive, w, &states, part);
            states = shift(&states, part);
        }
        w.iter().all(|x| x.is_finite()).then_some(w)
    }
}

/// Limit on the parts into which a step is divided; beyond that, squaring is faster.
const MOST_PARTS: f64 = 64.0;
/// Number of terms beyond those of the polynomial: 1/30! is 4e-33.
const TERMS: usize = 30;

/// The Taylor series of w' = A w + b sum c_k s^k: w_(j+1) = (A w_j + b c_j) / (j + 1).
fn series(a: &Matrix<Dd>, drive: &[Dd], w: Vec<Dd>, states: &[Dd], s: Dd) -> Vec<Dd> {
    let size = drive.len();
    let mut sum = w.clone();
    let (mut term, mut power) = (w, Dd::ONE);
    for j in 0..states.len() + TERMS {
        // Terms contain the factor s^j.
        let c = states.get(j).map_or(Dd::ZERO, |&c| c * power);
        let next = |i: usize| (0..size).fold(drive[i] * c, |sum, k| sum + a[(i, k)] * term[k]);
        let scale = s / Dd::from((j + 1) as f64);
        term = (0..size).map(|i| next(i) * scale).collect();
        power = power * s;
        sum.iter_mut().zip(&term).for_each(|(sum, &x)| *sum += x);
    }
    sum
}

/// The coefficients of a polynomial of s + by, by repeated Horner steps.
fn shift(states: &[Dd], by: Dd) -> Vec<Dd> {
    let mut states = states.to_vec();
    if by.is_zero() {
        return states;
    }
    for i in 0..states.len() {
        for j in (i..states.len() - 1).rev() {
            let next = states[j + 1];
            states[j] += by * next;
        }
    }
    states
}

/// h^k / k!
pub fn scales(order: usize, h: Dd) -> Vec<Dd> {
    let mut scale = vec![Dd::ONE];
    for k in 1..order {
        scale.push(scale[k - 1] * h / Dd::from(k as f64));
    }
    scale
}
