//! The course of one output between the stops: consecutive Taylor polynomials, each with a bound of its remainder, so
//! that the values between samples are enclosed too. In: a run, an output, a time. Out: one stretch after another, for
//! the caller to examine, and the largest value of all. See docs/method/measures.md#peak-and-rms.
//!
//! On a piece of length h with |A| h <= 1 the output is sum c A^j z0 t^j / j!, and the first omitted term bounds the
//! rest: |c A^K| sup|z| h^K / K!. All pieces are evaluated in binary64, starting every 64 pieces from a state that is
//! accurate to two words; those that may contain the largest value are then evaluated in two words.

use super::exponential::Exponential;
use super::infinite::{self, Verdict};
use super::{Run, Stop, UNIT, UP, growth, length};
use crate::analysis::error::AnalysisError;
use crate::analysis::largest::{About, Curve, Largest};
use crate::base::{Ball, Dd, Number};
use crate::kernel::dense::add_scaled;
use crate::system::{LinearSystem, Signal};
use std::rc::Rc;

/// Terms of a polynomial in binary64: the remainder is 1/18! of its scale.
pub const ROUGH: usize = 18;
/// Terms of a polynomial in double-double: the remainder is 1/29! of its scale.
pub const FINE: usize = 29;
/// A motion with more pieces takes too long.
pub(super) const MOST_PIECES: f64 = 4e6;
/// A motion with more pieces is not begun, even if it might end early.
const MOST_COUNTED: f64 = 1e9;
/// Number of pieces between two states in two words.
pub(super) const BLOCK: usize = 64;
/// Maximum number of pieces that are evaluated in two words; beyond it the binary64 values are used.
const MOST_FINE: usize = 50_000;
/// Number of stretches that are cached.
const KEPT: usize = 8;

/// The outcome of following a course.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    ToTheEnd,
    /// The output has an infinite value: an impulse on an acceleration, a jump on a velocity.
    Infinite,
    /// It is not decided whether an impulse reaches the output.
    Open,
    /// There are too many pieces.
    TooLong,
}

/// Proceeds from event to event up to `until`; `pass` moves the run on to the time that it is given.
pub(super) fn stretches(
    system: &LinearSystem,
    drives: &[Vec<Signal>],
    output: usize,
    until: &Number,
    pass: &mut dyn FnMut(&mut Run, &Number) -> Result<Outcome, AnalysisError>,
) -> Result<Outcome, AnalysisError> {
    let times = [Number::ZERO, until.clone()];
    let mut run = Run::of(system, drives, &times)?;
    match infinite::verdict(system, drives, output, until) {
        Verdict::Finite => {}
        Verdict::Infinite => return Ok(Outcome::Infinite),
        Verdict::Open => return Ok(Outcome::Open),
    }
    for (time, stop) in run.stops(&times) {
        if (&time - until).is_positive() {
            break;
        }
        if (&time - &run.now).is_positive() {
            run.set_sources();
            match pass(&mut run, &time)? {
                Outcome::ToTheEnd => run.now = time,
                other => return Ok(other),
            }
        }
        if let Stop::Event { channel, piece } = stop {
            run.event(channel, piece)?;
        }
    }
    Ok(Outcome::ToTheEnd)
}

/// Looks for the largest value of an output from 0 to `until`.
pub fn follow(
    system: &LinearSystem,
    drives: &[Vec<Signal>],
    output: usize,
    until: &Number,
    largest: &mut Largest,
) -> Result<Outcome, AnalysisError> {
    let mut known: Vec<Rc<Stretch>> = Vec::new();
    let (mut pieces, mut fine) = (0.0, MOST_FINE);
    stretches(system, drives, output, until, &mut |run, to| {
        let stretch = stretch(&mut known, run, output, to)?;
        pieces += stretch.count as f64;
        if pieces > MOST_PIECES {
            return Ok(Outcome::TooLong);
        }
        let is_free = stretch.is_free(run);
        stretch.follow(run, output, to, &mut |_, block| {
            if is_free && largest.reaches(block.to_come()) {
                return Next::Stop;
            }
            block.bound(None, largest, &mut fine);
            Next::Block
        })?;
        Ok(Outcome::ToTheEnd)
    })
}

/// The stretch from the present to `to`: a cached one, or a new one.
pub(super) fn stretch(
    known: &mut Vec<Rc<Stretch>>,
    run: &Run,
    output: usize,
    to: &Number,
) -> Result<Rc<Stretch>, AnalysisError> {
    let (whole, states) = (to - &run.now, run.states_on());
    if let Some(stretch) = known.iter().find(|stretch| stretch.whole == whole && stretch.states == states) {
        return Ok(stretch.clone());
    }
    let new = Stretch::of(run, output, whole, states).ok_or_else(|| AnalysisError::out_of_range(run.system))?;
    if known.len() == KEPT {
        known.remove(0);
    }
    let new = Rc::new(new);
    known.push(new.clone());
    Ok(new)
}

/// Whether the time to `to` has so many pieces that a stretch of them is not worth setting up.
pub(super) fn is_hopeless(run: &Run, to: &Number) -> bool {
    let norm = run.space.generator(&run.states_on()).norm;
    let pieces = (to - &run.now).to_f64() * norm;
    pieces.is_nan() || pieces > MOST_COUNTED
}

/// The time between two stops, divided into pieces.
pub(super) struct Stretch {
    whole: Number,
    h: Number,
    count: usize,
    states: Vec<usize>,
    /// exp(A h) over the active states, and its columns in binary64.
    step: Exponential,
    columns: Vec<Vec<f64>>,
    /// c A^j h^j / j! for j = 0..=FINE, with bounds of the rows' norms and errors.
    rows: Vec<Vec<Dd>>,
    rough_rows: Vec<Vec<f64>>,
    norms: Vec<f64>,
    errors: Vec<f64>,
    /// A bound of |exp(A t)| for t up to h.
    growth: f64,
}

/// The part of a stretch that is still needed.
pub(super) enum Next {
    Block,
    /// Only the state at its end.
    Stop,
    Nothing,
}

/// Consecutive pieces of a stretch, and the state at their beginning.
#[derive(Clone)]
pub(super) struct Block {
    stretch: Rc<Stretch>,
    /// The time at its beginning.
    at: Number,
    pieces: usize,
    z: Vec<Dd>,
    /// A bound of the error of z.
    error: f64,
    /// Contribution of the sources' own errors to the state in a piece, and directly to the output.
    approximations: f64,
    fed: f64,
}

impl Stretch {
    fn of(run: &Run, output: usize, whole: Number, states: Vec<usize>) -> Option<Stretch> {
        let generator = run.space.generator(&states);
        let count = (whole.to_f64() * generator.norm).ceil().clamp(1.0, MOST_COUNTED) as usize;
        let h = &whole / &Number::from(count as i64);
        let n = states.len();
        let length_of_piece = h.to_ball();
        let step = generator.exponential(length_of_piece)?;
        let mut row: Vec<Dd> = states.iter().map(|&i| run.outputs[(output, i)].mid).collect();
        let mut error: f64 = states.iter().map(|&i| run.outputs[(output, i)].rad).sum();
        let (mut rows, mut norms, mut errors) = (Vec::new(), Vec::new(), Vec::new());
        for j in 0..=FINE {
            let size = length(&row);
            norms.push((size + error) * UP);
            errors.push(error * UP);
            let share = length_of_piece.mid / Dd::from(j as f64 + 1.0);
            let factor = share.to_f64().abs() * UP;
            let next: Vec<Dd> = (0..n).map(|k| dot(&row, generator.a.column(k)) * share).collect();
            error = (error * generator.norm + size * (generator.error + (n as f64 + 6.0) * UNIT * generator.norm))
                * factor
                * UP
                + length(&next) * (length_of_piece.rad / length_of_piece.mid.hi.abs());
            rows.push(std::mem::replace(&mut row, next));
        }
        let columns = (0..n).map(|k| step.f.column(k).iter().map(|x| x.to_f64()).collect()).collect();
        let rough_rows = rows[..ROUGH].iter().map(|row| row.iter().map(|x| x.to_f64()).collect()).collect();
        let growth = growth(generator.rate.max(0.0) * h.to_f64() * UP);
        Some(Stretch { whole, h, count, states, step, columns, rows, rough_rows, norms, errors, growth })
    }

    /// Whether no source is active: then the energy of the system bounds the rest of its motion.
    fn is_free(&self, run: &Run) -> bool {
        let is_steady = run.channels.iter().all(|channel| channel.states_on() <= 1);
        let is_off = self.states.iter().all(|&i| i < run.space.mechanical || run.z[i].is_zero());
        is_steady && is_off && run.source_error == 0.0 && run.space.own_rate * self.whole.to_f64() < 0.5
    }

    /// Takes the run through all blocks up to `to`; `visit` returns what is needed of the rest.
    pub(super) fn follow(
        self: &Rc<Stretch>,
        run: &mut Run,
        output: usize,
        to: &Number,
        visit: &mut dyn FnMut(&Run, &Block) -> Next,
    ) -> Result<(), AnalysisError> {
        let start = run.now.clone();
        let times = |pieces: usize| &self.h * &Number::from(pieces as i64);
        let whole_block = if self.count > BLOCK { Some(run.step(&times(BLOCK))?) } else { None };
        let mut done = 0;
        while done < self.count {
            run.set_sources();
            let pieces = BLOCK.min(self.count - done);
            let block = Block {
                stretch: self.clone(),
                at: run.now.clone(),
                pieces,
                z: self.states.iter().map(|&i| run.z[i]).collect(),
                error: (run.trail.error + run.source_error) * UP,
                approximations: run.approximation_errors() * self.h.to_f64() * self.growth * UP,
                fed: run.feed_through_error(output),
            };
            match visit(run, &block) {
                Next::Block => {}
                Next::Stop => return run.advance(to),
                Next::Nothing => return Ok(()),
            }
            done += pieces;
            match &whole_block {
                _ if done == self.count => run.advance(to)?,
                Some(step) => run.take(step, &(&start + &times(done))),
                None => {}
            }
        }
        Ok(())
    }

    fn rough_terms(&self, z: &[f64]) -> Vec<f64> {
        self.rough_rows.iter().map(|row| row.iter().zip(z).map(|(c, x)| c * x).sum()).collect()
    }

    /// The rounding error of the first terms in binary64.
    fn rounding(&self, length: f64) -> f64 {
        (self.states.len() as f64 + 8.0) * f64::EPSILON * self.norms[..ROUGH].iter().sum::<f64>() * length * UP
    }

    /// The error of the first `terms` terms of the polynomial, for a state of this length and error.
    fn left_out(&self, terms: usize, length: f64, error: f64, from: &Block) -> f64 {
        let seen: f64 =
            self.norms[..terms].iter().zip(&self.errors).map(|(norm, off)| norm * error + off * length).sum();
        let rest = self.norms[terms] * (length + error) * self.growth;
        let late = self.norms[0] * from.approximations;
        (seen + rest + late + from.fed) * UP
    }
}

impl Block {
    pub(super) fn pieces(&self) -> usize {
        self.pieces
    }

    /// A bound of |output| from here on, if nothing drives the system any more and no motion grows.
    fn to_come(&self) -> f64 {
        self.stretch.norms[0] * (length(&self.z) + self.error) * 1.7
    }

    /// The time of a place in a piece, in parts of it.
    pub(super) fn time(&self, piece: usize, part: Dd) -> Ball {
        let pieces = Ball::from(piece as f64) + Ball::exact(part);
        self.at.to_ball() + self.stretch.h.to_ball() * pieces
    }

    /// Every piece in binary64: its number, and the terms of its polynomial on [0, 1] with a bound of their error.
    pub(super) fn rough(&self, visit: &mut dyn FnMut(usize, &[f64], f64)) {
        let stretch = &*self.stretch;
        let n = stretch.states.len();
        let mut z: Vec<f64> = self.z.iter().map(|x| x.to_f64()).collect();
        let mut error = (self.error + size(&z) * f64::EPSILON) * UP;
        // Rounding of entries and states to binary64, of products and of sums.
        let rounding = (n as f64 + 8.0) * f64::EPSILON * stretch.step.absolute_norm + stretch.step.error;
        for piece in 0..self.pieces {
            let length = size(&z);
            let terms = stretch.rough_terms(&z);
            visit(piece, &terms, stretch.left_out(ROUGH, length, error, self) + stretch.rounding(length));
            if piece + 1 == self.pieces {
                break;
            }
            let mut next = vec![0.0; n];
            for (x, column) in z.iter().zip(&stretch.columns) {
                next.iter_mut().zip(column).for_each(|(sum, f)| *sum += f * x);
            }
            error = (stretch.step.norm * error + rounding * (length + error) + self.approximations) * UP;
            z = next;
        }
    }

    /// The pieces in two words, in ascending order.
    pub(super) fn fine(&self) -> Fine<'_> {
        Fine { block: self, z: self.z.clone(), error: self.error, at: 0 }
    }

    /// Looks for the largest value, or the one farthest beyond an end: in all pieces in binary64, then in those that may
    /// contain it in two words.
    pub(super) fn bound(&self, about: Option<&About>, largest: &mut Largest, left: &mut usize) {
        let mut wanted: Vec<(usize, f64)> = Vec::new();
        self.rough(&mut |piece, terms, error| {
            let curve = about.map_or_else(|| Curve::rough(terms, error), |about| about.rough(terms, error));
            if let Some(high) = largest.bound_rough(&curve) {
                wanted.push((piece, high));
            }
        });
        let mut fine = self.fine();
        for (piece, high) in wanted {
            if largest.reaches(high) {
                continue;
            }
            if *left == 0 {
                largest.at_most(high);
                continue;
            }
            *left -= 1;
            let (mut terms, error) = fine.piece(piece);
            let curve = match about {
                Some(about) => about.fine(&mut terms, error),
                None => Curve::fine(&terms, error),
            };
            largest.bound_fine(&curve);
        }
    }
}

/// The pieces of a block in two words.
pub(super) struct Fine<'a> {
    block: &'a Block,
    z: Vec<Dd>,
    error: f64,
    at: usize,
}

impl Fine<'_> {
    /// The terms of a piece, not before the last one that was asked for, with a bound of their error.
    pub(super) fn piece(&mut self, piece: usize) -> (Vec<Dd>, f64) {
        let stretch = &*self.block.stretch;
        let n = stretch.states.len();
        let rounding = (n as f64 + 4.0) * UNIT * stretch.step.absolute_norm + stretch.step.error;
        while self.at < piece {
            let mut next = vec![Dd::ZERO; n];
            for (column, &x) in self.z.iter().enumerate() {
                add_scaled(&mut next, x, stretch.step.f.column(column));
            }
            let carried = stretch.step.norm * self.error + rounding * (length(&self.z) + self.error);
            self.error = (carried + self.block.approximations) * UP;
            self.z = next;
            self.at += 1;
        }
        let length = length(&self.z);
        let terms = stretch.rows[..FINE].iter().map(|row| dot(row, &self.z)).collect();
        let rounding = (n as f64 + 6.0) * UNIT * stretch.norms[..FINE].iter().sum::<f64>() * length;
        (terms, stretch.left_out(FINE, length, self.error, self.block) + rounding)
    }
}

fn dot(a: &[Dd], b: &[Dd]) -> Dd {
    a.iter().zip(b).fold(Dd::ZERO, |sum, (x, y)| sum + *x * *y)
}

fn size(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt() * UP
}
