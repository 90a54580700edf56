//! The motion in time under initial states and signals, exact at the requested times: z(t + h) = exp(A h) z(t), with
//! the states of the sources reset at every stop, so that nothing is integrated numerically. In: a system, a signal
//! for each input, times. Out: every output at every time as a ball. See docs/method/response.md.
//!
//! Signals are zero before t = 0, where the initial state holds; a jump has happened at its time.

mod channel;
pub(in crate::analysis) mod course;
mod decoupled;
pub(in crate::analysis) mod exponential;
mod findings;
mod infinite;
pub(in crate::analysis) mod propagator;
pub(in crate::analysis) mod settle;
pub mod signal;
pub(in crate::analysis) mod square;
mod sum;
mod trail;

use crate::analysis::answer::Modes;
use crate::analysis::error::AnalysisError;
use crate::analysis::response::channel::{Channel, SuddenChange, channels, derivatives, exogenous, fed_approximations};
use crate::analysis::response::exponential::growth;
use crate::analysis::response::propagator::{StateSpace, dense};
use crate::analysis::response::signal::order;
use crate::analysis::response::trail::Trail;
use crate::base::{Ball, Dd, Number, OrderBy, Power, Span, up};
use crate::kernel::dense::enclosure::norm_bound;
use crate::kernel::dense::{Matrix, add_scaled};
use crate::system::{LinearSystem, Signal};
use std::cell::RefCell;
use std::cmp::Ordering;
use std::rc::Rc;

pub use findings::{Unsettled, findings, moving_outputs};

/// The outputs at the requested times.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct History {
    pub times: Vec<Number>,
    /// One row for each time, one ball for each output.
    pub values: Vec<Vec<Ball>>,
}

impl History {
    /// Adds another motion at the same times; an empty one adds nothing.
    pub fn add(&mut self, other: &[Vec<Ball>]) {
        for (row, other) in self.values.iter_mut().zip(other) {
            row.iter_mut().zip(other).for_each(|(value, other)| *value = *value + *other);
        }
    }
}

/// The mechanical rows of exp(A h) for one h.
struct Step {
    h: Number,
    /// Active states: mechanical ones, then those of the sources.
    states: Vec<usize>,
    /// One column for each active state.
    f: Matrix<Dd>,
    /// Bounds of the norms of the blocks, and of the error of the whole.
    own: f64,
    /// What an error grows by during the step, at most.
    growth: f64,
    from_sources: f64,
    error: f64,
    rounding: f64,
    /// Bounds of the norms of 2^k such steps at once, computed on demand, with the powers of `f` themselves.
    powers: RefCell<Powers>,
}

/// The mechanical block of `f`, squared repeatedly in binary64, with the error of each square.
struct Powers {
    last: Matrix<f64>,
    error: f64,
    norms: Vec<f64>,
}

/// A time at which the motion is stopped: for an event, or because it is requested.
enum Stop {
    Event { channel: usize, piece: usize },
    Sample,
}

struct Run<'a> {
    system: &'a LinearSystem,
    space: StateSpace,
    channels: Vec<Channel>,
    outputs: Matrix<Ball>,
    steps: Vec<Rc<Step>>,
    /// The state: mechanical, then sources, taken as exact numbers.
    z: Vec<Dd>,
    trail: Trail,
    /// The most recent step.
    last: Option<Rc<Step>>,
    source_error: f64,
    now: Number,
}

/// Number of different steps that are cached.
const STEPS_KEPT: usize = 8;
const UNIT: f64 = 2.0 * Dd::EPSILON;
const UP: f64 = up::THOUSANDS;

/// The outputs at ascending times, for a sum of signals on each input.
pub fn respond(system: &LinearSystem, drives: &[Vec<Signal>], times: &[Number]) -> Result<History, AnalysisError> {
    respond_with(system, None, drives, times)
}

/// Like [`respond`], if all undamped modes of the system may be known already.
pub fn respond_with(
    system: &LinearSystem,
    modes: Option<&Modes>,
    drives: &[Vec<Signal>],
    times: &[Number],
) -> Result<History, AnalysisError> {
    AnalysisError::refuse_losses(system)?;
    if system.outputs.is_empty() {
        return Ok(History { times: times.to_vec(), values: vec![Vec::new(); times.len()] });
    }
    let is_worth_it = times.len() * system.n() >= decoupled::WORTH_IT;
    let apart = if is_worth_it { decoupled::respond(system, modes, drives, times) } else { None };
    let mut history = match apart {
        Some(apart) if apart.is_good => apart.history,
        // Where the general method is refused, a wide bound is better than none.
        Some(apart) => respond_by_matrix_exponential(system, drives, times).unwrap_or(apart.history),
        None => respond_by_matrix_exponential(system, drives, times)?,
    };
    // An output that nothing reaches is exactly zero, not a rounding error of other motions.
    for (output, _) in moving_outputs(system, drives).iter().enumerate().filter(|(_, is_moved)| !**is_moved) {
        history.values.iter_mut().for_each(|row| row[output] = Ball::ZERO);
    }
    Ok(history)
}

/// The motion by the general method: all coordinates at once, with any damping.
fn respond_by_matrix_exponential(
    system: &LinearSystem,
    drives: &[Vec<Signal>],
    times: &[Number],
) -> Result<History, AnalysisError> {
    let mut run = Run::of(system, drives, times)?;
    let mut values = Vec::with_capacity(times.len());
    for (time, stop) in run.stops(times) {
        run.advance(&time)?;
        match stop {
            Stop::Event { channel, piece } => run.event(channel, piece)?,
            Stop::Sample => {
                run.set_sources();
                values.push(run.read());
            }
        }
    }
    Ok(History { times: times.to_vec(), values })
}

/// A request for more samples than this is probably a mistake.
pub const MOST_SAMPLES: f64 = 4e6;

/// The values of a motion, all outputs together: each takes 24 bytes as an enclosure, twice that beside noise, and up to 80
/// more as text, so that this many take 1 to 2 GB.
pub const MOST_VALUES: usize = 20_000_000;

/// An error if a motion has more values than fit into memory. `at`: an output of the model.
pub fn refuse_too_many(times: usize, outputs: usize, at: Span) -> Result<(), AnalysisError> {
    match times.saturating_mul(outputs) > MOST_VALUES {
        true => Err(AnalysisError::TooManySamples { times, outputs, limit: MOST_VALUES, at }),
        false => Ok(()),
    }
}

/// Number of sample times.
pub fn samples(until: &Number, step: &Number) -> u64 {
    let count = (until / step).to_f64();
    // A last sample that misses `until` only by rounding counts.
    (count * (1.0 + 1e-12)).floor() as u64 + 1
}

/// The times 0, step, 2 step, ... up to `until`.
pub fn grid(until: &Number, step: &Number) -> Vec<Number> {
    (0..samples(until, step) as i64).map(|i| step * &Number::from(i)).collect()
}

impl<'a> Run<'a> {
    fn of(system: &'a LinearSystem, drives: &[Vec<Signal>], times: &[Number]) -> Result<Run<'a>, AnalysisError> {
        let channels = channels(system, drives, times)?;
        let sources = exogenous(system, &channels, times);
        let horizon = times.iter().map(Number::to_f64).fold(0.0, f64::max);
        let space = StateSpace::of(system, &sources, if horizon > 0.0 { horizon } else { 1.0 })?;
        let outputs = output_rows(system, &channels, &space);
        let z = vec![Dd::ZERO; space.size()];
        let mut run = Run {
            system,
            space,
            channels,
            outputs,
            steps: Vec::new(),
            z,
            trail: Trail::default(),
            last: None,
            source_error: 0.0,
            now: Number::ZERO,
        };
        run.start();
        Ok(run)
    }

    /// The initial state.
    fn start(&mut self) {
        let n = self.system.n();
        let (mut q, mut v) = (vec![Ball::ZERO; n], vec![Ball::ZERO; n]);
        for (i, displacement, velocity) in &self.system.initial {
            q[i.index()] = displacement.to_ball();
            v[i.index()] = velocity.to_ball();
        }
        let state = self.space.state(&q, &v);
        self.add(&state);
    }

    /// Adds a change to the mechanical state.
    fn add(&mut self, change: &[Ball]) {
        let mut radii = 0.0;
        for (z, change) in self.z.iter_mut().zip(change) {
            let sum = Ball::exact(*z) + *change;
            *z = sum.mid;
            radii += sum.rad * sum.rad;
        }
        self.trail.add(radii.sqrt() * UP);
    }

    /// Events and samples in order; an event at a sample's time comes first.
    fn stops(&self, times: &[Number]) -> Vec<(Number, Stop)> {
        let mut stops: Vec<(Number, Stop)> = Vec::new();
        for (channel, c) in self.channels.iter().enumerate() {
            let events = c.source.events().into_iter().enumerate();
            stops.extend(events.map(|(piece, at)| (at.clone(), Stop::Event { channel, piece })));
        }
        stops.extend(times.iter().map(|time| (time.clone(), Stop::Sample)));
        let is_sample = |stop: &Stop| matches!(stop, Stop::Sample);
        stops.order_by(|a, b| a.0.to_f64().total_cmp(&b.0.to_f64()).then(is_sample(&a.1).cmp(&is_sample(&b.1))));
        let last = stops.iter().rposition(|(_, stop)| is_sample(stop)).map_or(0, |at| at + 1);
        stops.truncate(last);
        stops
    }

    /// Moves on to a time.
    fn advance(&mut self, time: &Number) -> Result<(), AnalysisError> {
        let h = time - &self.now;
        if h.is_zero() {
            return Ok(());
        }
        let step = self.step(&h)?;
        self.take(&step, time);
        Ok(())
    }

    /// Takes a step that leads to this time.
    fn take(&mut self, step: &Rc<Step>, time: &Number) {
        self.set_sources();
        let mechanical = self.space.mechanical;
        let (own, sources) = (length(&self.z[..mechanical]), length(&self.z[mechanical..]));
        let mut next = vec![Dd::ZERO; mechanical];
        for (column, &state) in step.states.iter().enumerate() {
            add_scaled(&mut next, self.z[state], step.f.column(column));
        }
        self.z[..mechanical].copy_from_slice(&next);
        let size = own + sources + self.trail.error + self.source_error;
        let h = step.h.abs().to_f64();
        let approximations = self.approximation_errors() * h * step.growth;
        let local = step.from_sources * self.source_error + (step.error + step.rounding) * size + approximations;
        if !self.last.as_ref().is_some_and(|last| Rc::ptr_eq(last, step)) {
            self.trail.turn();
            self.last = Some(step.clone());
        }
        self.trail.step(step.own, local);
        self.trail.decay(2 * mechanical, |k| step.norm_of_many(k));
        self.now = time.clone();
    }

    fn step(&mut self, h: &Number) -> Result<Rc<Step>, AnalysisError> {
        let states = self.states_on();
        if let Some(step) = self.steps.iter().find(|step| step.h == *h && step.states == states) {
            return Ok(step.clone());
        }
        let step = self.new_step(h, states).ok_or_else(|| AnalysisError::out_of_range(self.system))?;
        if self.steps.len() == STEPS_KEPT {
            self.steps.remove(0);
        }
        let step = Rc::new(step);
        self.steps.push(step.clone());
        Ok(step)
    }

    fn states_on(&self) -> Vec<usize> {
        let mechanical = self.space.mechanical;
        let of = |channel: &Channel| {
            let first = mechanical + channel.first;
            first..first + channel.states_on()
        };
        (0..mechanical).chain(self.channels.iter().flat_map(of)).collect()
    }

    fn new_step(&self, h: &Number, states: Vec<usize>) -> Option<Step> {
        let t = h.to_ball();
        let e = self.space.generator(&states).exponential(t)?;
        let (mechanical, size) = (self.space.mechanical, states.len());
        let f = Matrix::from_fn(mechanical, size, |i, j| e.f[(i, j)]);
        let block = norm_bound(mechanical, mechanical, |i, j| f[(i, j)].hi.abs() * UP) + e.error;
        let growth = growth(self.space.own_rate * t.magnitude());
        let own = block.min(growth);
        let sources = size - mechanical;
        let from_sources = norm_bound(mechanical, sources, |i, j| f[(i, mechanical + j)].hi.abs() * UP) + e.error;
        let rounding = (size as f64 + 4.0) * UNIT * e.absolute_norm;
        let powers = RefCell::new(Powers {
            last: Matrix::from_fn(mechanical, mechanical, |i, j| f[(i, j)].to_f64()),
            error: (e.error + f64::EPSILON * e.absolute_norm) * UP,
            norms: vec![own],
        });
        Some(Step { h: h.clone(), states, f, own, growth, from_sources, error: e.error, rounding, powers })
    }

    /// The sources' states at the present time, from their formulas.
    fn set_sources(&mut self) {
        let mechanical = self.space.mechanical;
        let mut radii = 0.0;
        for channel in &self.channels {
            for (k, value) in channel.state(&self.now).into_iter().enumerate() {
                let index = channel.first + k;
                let scaled = 1.0 / self.space.scale[index];
                self.z[mechanical + index] = value.mid.scale(scaled);
                radii += (value.rad * scaled).power(2);
            }
        }
        self.source_error = radii.sqrt() * UP;
    }

    /// Applies an event: the next piece becomes active; a jump of a base's motion, or an impulse, changes the state at
    /// once.
    fn event(&mut self, channel: usize, piece: usize) -> Result<(), AnalysisError> {
        let input = &self.system.inputs[self.channels[channel].input];
        let n = self.system.n();
        let (g0, g1) = match self.channels[channel].turn_on(piece) {
            SuddenChange::None => return Ok(()),
            SuddenChange::Impulse(value) => {
                if !(input.b[1].is_empty() && input.b[2].is_empty()) {
                    return Err(AnalysisError::impulse_on_base(self.system, self.channels[channel].input));
                }
                let g0: Vec<Ball> = dense(&input.b[0], n).into_iter().map(|b| b * value).collect();
                (g0, vec![Ball::ZERO; n])
            }
            SuddenChange::Jump([u, rate]) => {
                let (b1, b2) = (dense(&input.b[1], n), dense(&input.b[2], n));
                let g0 = b1.iter().zip(&b2).map(|(&b1, &b2)| b1 * u + b2 * rate).collect();
                (g0, b2.iter().map(|&b| b * u).collect())
            }
        };
        if g0.iter().chain(&g1).all(Ball::is_zero) {
            return Ok(());
        }
        let change =
            self.space.impulse_response_jump(&g0, &g1).ok_or_else(|| AnalysisError::out_of_range(self.system))?;
        self.add(&change);
        Ok(())
    }

    /// Errors of the sources' approximations, as rates of change of the state.
    fn approximation_errors(&self) -> f64 {
        let of = |channel: &Channel| -> f64 {
            if channel.approximation(0) == 0.0 {
                return 0.0;
            }
            let b = &self.system.inputs[channel.input].b;
            let zeros = vec![Ball::ZERO; self.system.n()];
            let size = |k: usize| {
                let impulse = self.space.impulse_response_jump(&dense(&b[k], self.system.n()), &zeros);
                impulse.map_or(f64::INFINITY, |z| z.iter().map(|x| x.magnitude().power(2)).sum::<f64>().sqrt())
            };
            (0..3).filter(|&k| !b[k].is_empty()).map(|k| size(k) * channel.approximation(k)).sum()
        };
        self.channels.iter().map(of).sum()
    }

    /// Error of the sources' approximations in an output with direct feed-through.
    fn feed_through_error(&self, output: usize) -> f64 {
        let mechanical = self.space.mechanical;
        let factor = |state: usize| self.outputs[(output, mechanical + state)].magnitude() / self.space.scale[state];
        fed_approximations(&self.channels, factor)
    }

    fn read(&self) -> Vec<Ball> {
        let (mechanical, size) = (self.space.mechanical, self.space.size());
        let of = |row: usize| {
            let mut y = Ball::ZERO;
            let (mut own, mut sources) = (0.0, 0.0);
            for j in 0..size {
                let factor = self.outputs[(row, j)];
                y = y + factor * Ball::exact(self.z[j]);
                let square = factor.magnitude().power(2);
                if j < mechanical { own += square } else { sources += square }
            }
            y.widen(
                (own.sqrt() * self.trail.error + sources.sqrt() * self.source_error + self.feed_through_error(row))
                    * UP,
            )
        };
        (0..self.outputs.rows()).map(of).collect()
    }
}

impl Step {
    /// A bound of the norm of 2^k of these steps at once, without sources.
    fn norm_of_many(&self, k: u32) -> f64 {
        let mut powers = self.powers.borrow_mut();
        while powers.norms.len() <= k as usize {
            powers.square();
        }
        powers.norms[k as usize]
    }
}

impl Powers {
    fn square(&mut self) {
        let n = self.last.rows();
        let mut next = Matrix::fill_with(n, n, 0.0);
        for j in 0..n {
            for k in 0..n {
                let factor = self.last[(k, j)];
                let column = next.column_mut(j).iter_mut().zip(self.last.column(k));
                column.for_each(|(sum, f)| *sum += factor * f);
            }
        }
        let size = norm_bound(n, n, |i, j| self.last[(i, j)].abs());
        let rounding = (n as f64 + 4.0) * f64::EPSILON * size * size;
        self.error = (2.0 * size * self.error + self.error * self.error + rounding) * UP;
        self.last = next;
        let before = self.norms.last().map_or(f64::INFINITY, |norm| norm * norm * UP);
        let norm = norm_bound(n, n, |i, j| self.last[(i, j)].abs()) + self.error;
        // `min` returns the other operand if this one is NaN.
        self.norms.push((norm * UP).min(before));
    }
}

/// Every output as a row over z.
fn output_rows(system: &LinearSystem, channels: &[Channel], space: &StateSpace) -> Matrix<Ball> {
    let size = space.size();
    let mut rows = Matrix::none(system.outputs.len(), size);
    for (row, output) in system.outputs.iter().enumerate() {
        for (p, motion) in output.p.iter().zip(&space.rows) {
            for (i, factor) in p {
                for j in 0..size {
                    rows[(row, j)] = rows[(row, j)] + factor.to_ball() * motion[(i.index(), j)];
                }
            }
        }
        for channel in channels {
            for (d, derivative) in output.d.iter().zip(derivatives(&channel.source)) {
                for (_, value) in d.iter().filter(|(input, _)| *input as usize == channel.input) {
                    for (k, factor) in &derivative {
                        let index = channel.first + k;
                        let entry = &mut rows[(row, space.mechanical + index)];
                        *entry = *entry + value.to_ball() * *factor * Ball::from(space.scale[index]);
                    }
                }
            }
        }
    }
    rows
}

fn length(z: &[Dd]) -> f64 {
    z.iter().map(|x| x.hi * x.hi).sum::<f64>().sqrt() * UP
}

/// Whether times ascend strictly.
pub fn ascending(times: &[Number]) -> bool {
    times.windows(2).all(|w| order(&w[0], &w[1]) == Ordering::Less)
}
