//! The motion of a system as independent blocks of two states: a step needs two by two numbers a block instead of a full
//! matrix, and several blocks and several times are computed in parallel. The blocks are oscillators, one for each mode, where
//! damping does not couple the modes, otherwise the poles. In: a system, signals, times. Out: the result of the general
//! method, with bounds as good, or nothing if that cannot be proven here. See docs/method/response.md#modal-steps.
//!
//! With the modes X refined to double-double, X^T M X = 1 + E_M, X^T C X = D_c + E_C, X^T K X = D_k + E_K in balls, and
//! q = X eta exactly: the E are disturbances of the oscillators eta'' + c eta' + k eta = x . B u, and their effect
//! grows in the norm of z = (s eta, eta'), s^2 near |k|, at most with the logarithmic norm of the oscillators. Of poles
//! grows in the norm of z = (s eta, eta'), s^2 near |k|, at most with the logarithmic norm of the oscillators. For
//! poles the disturbance is the T of their proof.

mod blocks;
mod lanes;
mod oscillators;
mod poles;
mod step;

use super::channel::{Channel, SuddenChange, channels};
use super::trail::Trail;
use super::{History, UP};
use crate::analysis::answer::Modes;
use crate::analysis::modes::modes_as;
use crate::analysis::modes::request::Request;
use crate::analysis::poles::MAX_DAMPED;
use crate::analysis::response::signal::Source;
use crate::base::{Ball, Dd, Number, OrderBy};
use crate::kernel::lanes::Lanes;
use crate::system::{LinearSystem, Signal};
use blocks::Blocks;
use lanes::{Batch, Row, Samples, State};
use oscillators::{Oscillators, Output};
use poles::PoleBlocks;
use std::rc::Rc;
use step::Step;

/// For fewer samples times coordinates, computing the modes costs more than it saves.
pub const WORTH_IT: usize = 16;
/// Limit on the samples between two evaluations of the harmonic sources' formulas.
const MOST_AT_ONCE: usize = 128;
/// Number of different steps that are cached.
const STEPS_KEPT: usize = 8;
/// Times this close to equal steps are treated as equal; the bound contains the difference.
const EVEN: f64 = 1.0 / (1u128 << 95) as f64;
/// A bound is good if it is 2^-60 of the output's largest value, or some hundred rounding errors of what the state
/// could produce.
const GOOD: f64 = 1.0 / (1u64 << 60) as f64;
const GOOD_OF_CHIRPS: f64 = 1e-14;
const AS_GOOD_AS_ANY: f64 = 1e-27;

/// From this many coordinates on, poles are used where modes are coupled; below, one matrix exponential costs less.
const FROM_POLES: usize = 12;

/// A motion and whether its bounds are as good as those of the general method.
pub struct Followed {
    pub history: History,
    pub is_good: bool,
}

/// Like [`super::respond`]; `None` if another method is needed: blocks cannot be separated, or the general method has to report
/// an error.
pub fn respond(
    system: &LinearSystem,
    modes: Option<&Modes>,
    drives: &[Vec<Signal>],
    times: &[Number],
) -> Option<Followed> {
    let mut run = Run::of(system, modes, drives, times)?;
    let moments: Vec<Moment> = times.iter().map(Moment::of).collect();
    let mut values = Vec::with_capacity(times.len());
    let mut events = run.events().into_iter().peekable();
    while values.len() < times.len() {
        let first = values.len();
        while let Some(event) = events.next_if(|event| event.at.seconds <= moments[first].seconds) {
            run.go_to(&event.at)?;
            run.event(event.channel, event.piece)?;
        }
        let before = events.peek().map_or(f64::INFINITY, |event| event.at.seconds);
        run.samples(&moments[first..], before, &mut values)?;
    }
    let is_good = run.is_good(&values);
    Some(Followed { history: History { times: times.to_vec(), values }, is_good })
}

/// A time in three representations.
struct Moment {
    number: Number,
    ball: Ball,
    seconds: f64,
}

/// A source switches to a piece.
struct Event {
    at: Moment,
    channel: usize,
    piece: usize,
}

struct Run<'a> {
    system: &'a LinearSystem,
    blocks: Blocks,
    coordinates: Box<dyn Coordinates>,
    channels: Vec<Channel>,
    outputs: Vec<Output>,
    rows: Vec<Row>,
    steps: Vec<Rc<Step>>,
    state: State,
    /// |z|^2.
    square: f64,
    trail: Trail,
    /// The most recent step.
    last: Option<Rc<Step>>,
    now: Number,
    /// For each sample and output, the largest value that the state could produce.
    scales: Vec<f64>,
}

/// The kind of state that the blocks have.
trait Coordinates {
    /// The initial state.
    fn start(&self, system: &LinearSystem) -> Change;

    /// The effect of an impulse of an input.
    fn impulse(&self, system: &LinearSystem, input: usize, value: Ball) -> Change;

    /// The effect of a jump of an input and its rate.
    fn jump(&self, system: &LinearSystem, input: usize, to: [Ball; 2]) -> Change;

    /// The norm of what the k-th derivative of an input adds to z'.
    fn force_size(&self, system: &LinearSystem, input: usize, power: usize) -> f64;

    /// Every output as rows.
    fn outputs(&self, system: &LinearSystem, channels: &[Channel], blocks: &Blocks) -> Vec<Output>;
}

/// A sudden change of the state, with a bound of its error.
struct Change {
    z: Vec<[Ball; 2]>,
    defect: f64,
}

/// The active sources during a batch.
struct Driving {
    /// By time (one more than there are steps), then by state.
    states: Vec<Dd>,
    /// Their norms, and a bound of the error of each.
    norms: Vec<f64>,
    error: f64,
    on: usize,
}

/// All modes of a system that may be separated.
fn all_modes(system: &LinearSystem) -> Option<Modes> {
    let request = Request::default().without_shares();
    if system.n() > MAX_DAMPED { None } else { modes_as(system, &request).ok() }
}

/// The blocks of a system, and their kind of state; `None` if it cannot be separated.
fn coordinates(
    system: &LinearSystem,
    modes: &Modes,
    channels: &[Channel],
    times: &[Number],
) -> Option<(Box<dyn Coordinates>, Blocks)> {
    if let Some((oscillators, blocks)) = Oscillators::of(system, modes, channels, times) {
        return Some((Box::new(oscillators), blocks));
    }
    if system.n() < FROM_POLES {
        return None;
    }
    let (poles, blocks) = PoleBlocks::of(system, modes, channels, times)?;
    Some((Box::new(poles), blocks))
}

impl Moment {
    fn of(number: &Number) -> Moment {
        Moment { ball: number.to_ball(), seconds: number.to_f64(), number: number.clone() }
    }
}

impl<'a> Run<'a> {
    fn of(
        system: &'a LinearSystem,
        modes: Option<&Modes>,
        drives: &[Vec<Signal>],
        times: &[Number],
    ) -> Option<Run<'a>> {
        let channels = channels(system, drives, times).ok()?;
        let (coordinates, blocks): (Box<dyn Coordinates>, Blocks) = match modes {
            Some(modes) => coordinates(system, modes, &channels, times)?,
            None => coordinates(system, &all_modes(system)?, &channels, times)?,
        };
        let outputs = coordinates.outputs(system, &channels, &blocks);
        let n = blocks.count();
        let rows = outputs.iter().map(|output| output.row.clone()).collect();
        let state = State { z: [Lanes::zeros(n), Lanes::zeros(n)] };
        let now = Number::ZERO;
        let (steps, scales) = (Vec::new(), Vec::new());
        let mut run = Run {
            system,
            blocks,
            coordinates,
            channels,
            outputs,
            rows,
            steps,
            state,
            square: 0.0,
            trail: Trail::default(),
            last: None,
            now,
            scales,
        };
        let start = run.coordinates.start(system);
        run.add(&start);
        Some(run)
    }

    /// The events in order; simultaneous ones in the order of the channels.
    fn events(&self) -> Vec<Event> {
        let mut events: Vec<Event> = Vec::new();
        for (channel, c) in self.channels.iter().enumerate() {
            for (piece, at) in c.source.events().into_iter().enumerate() {
                events.push(Event { at: Moment::of(at), channel, piece });
            }
        }
        events.order_by(|a, b| a.at.seconds.total_cmp(&b.at.seconds));
        events
    }

    /// Adds a change to the state.
    fn add(&mut self, change: &Change) {
        let (mut radii, mut square) = (0.0, 0.0);
        for (i, change) in change.z.iter().enumerate() {
            for (z, &change) in self.state.z.iter_mut().zip(change) {
                let sum = Ball::exact(z.get(i)) + change;
                z.set(i, sum.mid);
                radii += sum.rad * sum.rad;
                square += sum.mid.hi * sum.mid.hi;
            }
        }
        self.square = square;
        self.trail.add((radii.sqrt() + change.defect) * UP);
    }

    /// Moves on to a time without computing the outputs.
    fn go_to(&mut self, time: &Moment) -> Option<()> {
        let rows = std::mem::take(&mut self.rows);
        let done = self.advance(std::slice::from_ref(time), None);
        self.rows = rows;
        done
    }

    /// Computes the first samples that come before an event and lie at equal steps, as many as are processed at once.
    fn samples(&mut self, moments: &[Moment], before: f64, values: &mut Vec<Vec<Ball>>) -> Option<()> {
        let first = &moments[0];
        let h = (&first.number - &self.now).to_ball().mid;
        let is_even = |(steps, moment): &(usize, &Moment)| {
            let reached = first.ball.mid + h * (*steps as f64);
            moment.seconds < before && (moment.ball.mid - reached).abs().hi <= 0.5 * EVEN * moment.seconds
        };
        let more = (1..).zip(&moments[1..]).take(MOST_AT_ONCE - 1).take_while(is_even).count();
        let count = if first.number == self.now { 1 } else { 1 + more };
        self.advance(&moments[..count], Some(values))
    }

    /// Goes through samples at equal steps, and appends a row of outputs for each if `values` is given.
    fn advance(&mut self, moments: &[Moment], values: Option<&mut Vec<Vec<Ball>>>) -> Option<()> {
        let h = &moments[0].number - &self.now;
        let step = if h.is_zero() { None } else { Some(self.step(&h)?) };
        let count = moments.len();
        let driving = self.driving(step.as_deref(), moments);
        let batch =
            Batch { step: step.as_deref(), count, sources: &driving.states[..count * driving.on], rows: &self.rows };
        let samples = lanes::run(&batch, &mut self.state);
        let last = &moments[count - 1];
        // Error of the last time if it is reached in equal steps.
        let slack = if count > 1 { EVEN * last.seconds } else { 0.0 };
        if let Some(step) = &step
            && !self.last.as_ref().is_some_and(|last| Rc::ptr_eq(last, step))
        {
            self.trail.turn();
            self.last = Some(step.clone());
        }
        self.read(step.as_deref(), &driving, &samples, slack, values);
        self.now = last.number.clone();
        self.square = samples.squares[count - 1];
        Some(())
    }

    fn step(&mut self, h: &Number) -> Option<Rc<Step>> {
        if !h.is_positive() {
            return None;
        }
        let on = self.active_states();
        if let Some(step) = self.steps.iter().find(|step| step.h == *h && step.on == on) {
            return Some(step.clone());
        }
        let step = Rc::new(Step::of(&self.blocks, &on, h)?);
        if self.steps.len() == STEPS_KEPT {
            self.steps.remove(0);
        }
        self.steps.push(step.clone());
        Some(step)
    }

    /// The indices of the active sources' states.
    fn active_states(&self) -> Vec<usize> {
        self.channels.iter().flat_map(|c| c.first..c.first + c.states_on()).collect()
    }

    /// The sources' states at the beginning of a batch and at each of its times: harmonics are rotated, starting from
    /// their formula; constants stay; other polynomials are evaluated.
    fn driving(&self, step: Option<&Step>, moments: &[Moment]) -> Driving {
        let on = self.active_states();
        let count = moments.len();
        let mut driving = Driving {
            states: vec![Dd::ZERO; (count + 1) * on.len()],
            norms: Vec::with_capacity(count + 1),
            error: 0.0,
            on: on.len(),
        };
        let mut place = 0;
        for channel in self.channels.iter().filter(|channel| channel.states_on() > 0) {
            let states = channel.states_on();
            let scale: Vec<f64> = (0..states).map(|k| 1.0 / self.blocks.scale[channel.first + k]).collect();
            let error = match &channel.source {
                Source::Harmonic { .. } => {
                    let now = channel.state(&self.now);
                    turn(&now, scale[0], step, &mut driving, place, count)
                }
                _ => polynomial(channel, self.now.to_ball(), moments, &scale, &mut driving, place),
            };
            driving.error = (driving.error + error) * UP;
            place += states;
        }
        for states in 0..=count {
            let range = states * on.len()..(states + 1) * on.len();
            let square: f64 = driving.states[range].iter().map(|w| w.hi * w.hi).sum();
            driving.norms.push(square.sqrt() * UP);
        }
        driving
    }

    /// Carries the error bound through the samples, and stores their outputs.
    fn read(
        &mut self,
        step: Option<&Step>,
        driving: &Driving,
        samples: &Samples,
        slack: f64,
        mut values: Option<&mut Vec<Vec<Ball>>>,
    ) {
        let of = &self.blocks;
        let approximations = self.approximations();
        let fed: Vec<f64> =
            self.outputs.iter().map(|output| output.approximations(&self.channels, &of.scale)).collect();
        let outputs = self.rows.len();
        let mut size = self.square.sqrt() * UP;
        for (sample, square) in samples.squares.iter().enumerate() {
            let from = if step.is_some() { sample } else { sample + 1 };
            if let Some(step) = step {
                let error = self.trail.error;
                let local = step.added_error(of, error, size, driving.norms[from], driving.error, approximations);
                self.trail.step(step.own, local);
                self.trail.decay(0, |k| step.norm_of_many(k));
            }
            size = square.sqrt() * UP;
            let at = sample + 1;
            let sources = driving.norms[at] + driving.error;
            // A time that is off by the slack changes z by its rate.
            let error = self.trail.error;
            let moved = slack * (of.norm * (size + error) + of.force_norm * sources);
            if let Some(values) = values.as_deref_mut() {
                let w = &driving.states[at * driving.on..(at + 1) * driving.on];
                let row = self.outputs.iter().zip(&samples.values[sample * outputs..]).zip(&fed).map(
                    |((output, &value), fed)| {
                        let value = output.with_sources(value, w, &self.channels);
                        let off = OutputErrors {
                            z: size,
                            error: error + moved,
                            w: driving.norms[at],
                            w_error: driving.error + slack * of.norm * sources,
                            acceleration: of.defect * (size + error) + of.force_defect * sources,
                        };
                        Ball::new(value, (output.radius(&off, value) + fed) * UP)
                    },
                );
                values.push(row.collect());
                self.scales.extend(self.outputs.iter().map(|output| output.scale(size, driving.norms[at])));
            }
            if sample + 1 == samples.squares.len() {
                self.trail.add(moved);
            }
        }
    }

    /// Applies an event, as in the general method.
    fn event(&mut self, channel: usize, piece: usize) -> Option<()> {
        let (system, input) = (self.system, self.channels[channel].input);
        let change = match self.channels[channel].turn_on(piece) {
            SuddenChange::None => return Some(()),
            SuddenChange::Impulse(value) => {
                let b = &system.inputs[input].b;
                if !(b[1].is_empty() && b[2].is_empty()) {
                    return None;
                }
                self.coordinates.impulse(system, input, value)
            }
            SuddenChange::Jump(to) => self.coordinates.jump(system, input, to),
        };
        if !change.z.iter().flatten().all(Ball::is_zero) {
            self.add(&change);
        }
        Some(())
    }

    /// Errors of the sources' approximations, as rates of change of the state.
    fn approximations(&self) -> f64 {
        let of = |channel: &Channel| -> f64 {
            let b = &self.system.inputs[channel.input].b;
            let size =
                |k: usize| self.coordinates.force_size(self.system, channel.input, k) * channel.approximation(k) * 2.0;
            (0..3).filter(|&k| channel.approximation(k) > 0.0 && !b[k].is_empty()).map(size).sum()
        };
        self.channels.iter().map(of).sum()
    }

    /// Whether all bounds are good enough for this method.
    fn is_good(&self, values: &[Vec<Ball>]) -> bool {
        let outputs = self.outputs.len();
        // The error of a chirp's approximation is the same for every method.
        let good = if self.channels.iter().any(|c| c.source.approximation(0) > 0.0) { GOOD_OF_CHIRPS } else { GOOD };
        (0..outputs).all(|output| {
            let largest = values.iter().map(|row| row[output].mid.hi.abs()).fold(0.0, f64::max);
            let scales = self.scales.iter().skip(output).step_by(outputs.max(1));
            values.iter().zip(scales).all(|(row, scale)| {
                let bound = row[output].rad;
                bound <= good * largest || bound <= AS_GOOD_AS_ANY * scale
            })
        })
    }
}

/// Error bounds of an output's parts.
struct OutputErrors {
    z: f64,
    error: f64,
    w: f64,
    w_error: f64,
    /// Error of the modes' accelerations caused by the disturbances.
    acceleration: f64,
}

/// Fills in the sine and cosine of a harmonic at each time; returns a bound of their errors.
fn turn(now: &[Ball], scale: f64, step: Option<&Step>, driving: &mut Driving, place: usize, count: usize) -> f64 {
    let mut state = [now[0].mid.scale(scale), now[1].mid.scale(scale)];
    let size = state.map(|x| x.hi.abs()).iter().sum::<f64>();
    let rotation = step.map(|step| [0, 1, 2, 3].map(|i| step.r[(place + i / 2, place + i % 2)]));
    for time in 0..=count {
        let to = time * driving.on + place;
        driving.states[to..to + 2].copy_from_slice(&state);
        if let Some([a, b, c, d]) = rotation {
            state = [a * state[0] + b * state[1], c * state[0] + d * state[1]];
        }
    }
    let start = (now[0].rad + now[1].rad) * scale;
    let each = step.map_or(0.0, |step| step.error_of_r + 16.0 * Dd::EPSILON);
    // A rotation does not change lengths; the errors of the steps add up.
    (start + each * count as f64 * (size + start) * 1.5) * UP
}

/// Fills in a polynomial's states at each time; returns a bound of their errors.
fn polynomial(
    channel: &Channel,
    now: Ball,
    moments: &[Moment],
    scale: &[f64],
    driving: &mut Driving,
    place: usize,
) -> f64 {
    let Source::Pieces { pieces, .. } = &channel.source else { return 0.0 };
    let Some(piece) = channel.active.map(|i| &pieces[i]) else { return 0.0 };
    let derivatives: Vec<Ball> = piece.derivatives.iter().map(Number::to_ball).collect();
    let start = piece.at.to_ball();
    let mut error: f64 = 0.0;
    for (time, ball) in std::iter::once(now).chain(moments.iter().map(|moment| moment.ball)).enumerate() {
        let t = ball - start;
        let mut radii = 0.0;
        for k in 0..derivatives.len() {
            let value = taylor(&derivatives[k..], t);
            driving.states[time * driving.on + place + k] = value.mid.scale(scale[k]);
            radii += value.rad * scale[k];
        }
        error = error.max(radii);
    }
    error
}

/// sum d_k t^k / k!
fn taylor(derivatives: &[Ball], t: Ball) -> Ball {
    let mut sum = Ball::ZERO;
    for (k, d) in derivatives.iter().enumerate().rev() {
        sum = sum * t / Ball::from(k as f64 + 1.0) + *d;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::response::respond_by_matrix_exponential;
    use crate::analysis::test_systems::{blank, push};
    use crate::base::Power;
    use crate::system::CoordinateId;
    use crate::system::{Course, Table};

    fn n(text: &str) -> Number {
        Number::from(text)
    }

    /// A chain with its first mass held or free, with damping proportional to its springs; displacement, velocity and
    /// acceleration of each mass as outputs.
    fn chain(size: usize, held: bool, damping: &str) -> LinearSystem {
        let mut system = blank(size);
        for i in 0..size {
            push(&mut system.m, "1.3", i, None);
            if i > 0 || held {
                let j = i.checked_sub(1);
                push(&mut system.k, "1000", i, j);
                push(&mut system.c, damping, i, j);
            }
        }
        for i in 0..size {
            for power in [1, 2] {
                let mut output = system.outputs[i].clone();
                output.p.swap(0, power);
                system.outputs.push(output);
            }
        }
        system
    }

    /// Checks that the enclosures of both methods overlap; returns the largest bound relative to the largest value of
    /// its output.
    fn meets(what: &str, system: &LinearSystem, drives: &[Vec<Signal>], times: &[Number]) -> f64 {
        let apart = respond(system, None, drives, times).unwrap_or_else(|| panic!("{what}: no such method")).history;
        let whole = respond_by_matrix_exponential(system, drives, times).expect("a motion");
        let mut worst: f64 = 0.0;
        for output in 0..system.outputs.len() {
            let column = || apart.values.iter().map(|row| row[output]);
            let largest = column().map(|y| y.mid.hi.abs()).fold(0.0, f64::max);
            for ((a, b), t) in column().zip(&whole.values).zip(times) {
                let b = b[output];
                assert!((a - b).contains_zero(), "{what}, output {output}, t = {}: {a:?} {b:?}", t.to_f64());
                if largest > 0.0 {
                    worst = worst.max(a.rad / largest);
                }
            }
        }
        worst
    }

    fn grid(until: &str, step: &str) -> Vec<Number> {
        crate::analysis::grid(&n(until), &n(step))
    }

    fn harmonic(hertz: &str, phase: &str) -> Signal {
        Signal::Harmonic { value: n("2"), frequency: n(hertz), phase: n(phase), at: n("0") }
    }

    /// One of every kind of signal, and sums of some.
    fn all_signals() -> Vec<Vec<Signal>> {
        let numbers = |list: &[&str]| list.iter().map(|&text| n(text)).collect::<Vec<_>>();
        let (times, values) = (numbers(&["0", "0.7", "2", "2.05"]), numbers(&["0.1", "2.1", "6", "1"]));
        let table =
            |course| Signal::Table(Table { times: times.clone(), values: values.clone(), course, period: None });
        let integral = |of, times| Signal::Integral { of: Box::new(of), times };
        let by = n("0.21");
        vec![
            vec![harmonic("1.5", "0.3"), harmonic("40", "0")],
            vec![Signal::Harmonic { value: n("2"), frequency: n("1.5"), phase: n("0.3"), at: n("0.77") }],
            vec![integral(table(Course::LinesToZero), 2), integral(Signal::Step { value: n("1"), at: n("0.4") }, 1)],
            vec![Signal::Delayed { of: Box::new(table(Course::Spline)), by: by.clone() }],
            vec![Signal::Delayed { of: Box::new(integral(Signal::Impulse { value: n("3"), at: n("0") }, 0)), by }],
            vec![Signal::Step { value: n("3"), at: n("0.33") }, Signal::Impulse { value: n("7"), at: n("1") }],
            vec![Signal::Ramp { value: n("4"), from: n("0.1"), to: n("1.7") }],
            vec![Signal::Pulse { value: n("4"), from: n("0.4"), to: n("0.45") }],
            vec![table(Course::Lines)],
            vec![table(Course::Spline)],
            vec![Signal::Chirp {
                value: n("2"),
                from: n("1"),
                to: n("10"),
                duration: n("1.5"),
                at: n("0.1"),
                phase: n("0.3"),
            }],
        ]
    }

    #[test]
    fn all_signals_move_a_chain_as_the_whole_matrix_does() {
        let signals = all_signals();
        for (size, held) in [(1, true), (3, true), (9, true), (3, false)] {
            let mut system = chain(size, held, "0.7");
            system.initial = vec![(CoordinateId(0), n("0.01"), -&n("0.2"))];
            for (which, signal) in signals.iter().enumerate() {
                let mut drives = vec![Vec::new(); size];
                drives[size - 1] = signal.clone();
                let bound = meets(&format!("{size} {held} {which}"), &system, &drives, &grid("2.5", "0.0625"));
                assert!(bound < 1e-18, "{size} {held} {which}: {bound:e}");
            }
        }
    }

    /// A moving base: it acts through a spring, a damper and inertia, and is added to the outputs.
    #[test]
    fn a_base_moves_a_chain_as_the_whole_matrix_does() {
        let mut system = chain(3, true, "0.7");
        let at = |value: &str| vec![(CoordinateId(0), n(value))];
        system.inputs[0].b = [at("1000"), at("0.7"), at("0.2")];
        for (output, power) in [(0, 0), (1, 1), (2, 2)] {
            system.outputs[output].d[power].push((0, -&n("1.5")));
        }
        for signal in [
            harmonic("3", "0.9"),
            Signal::Step { value: n("0.1"), at: n("0.5") },
            Signal::Ramp { value: n("0.1"), from: n("0.5"), to: n("1.1") },
            Signal::Chirp { value: n("0.1"), from: n("4"), to: n("0"), duration: n("2"), at: n("0"), phase: n("0") },
        ] {
            let bound = meets(&format!("{signal:?}"), &system, &[vec![signal]], &grid("2.5", "0.03125"));
            // A chirp's second derivative, which enters inertia forces and accelerations, is known to some 1e-16.
            assert!(bound < 1e-15, "{bound:e}");
        }
    }

    /// Dampers that couple the modes: a light one, one so heavy that poles are real, and one that drives energy in.
    #[test]
    fn poles_move_a_chain_as_the_whole_matrix_does() {
        for (damper, bound) in [("5", 1e-18), ("900", 1e-18), ("-0.9", 1e-18)] {
            let mut system = chain(FROM_POLES, true, "0.7");
            let size = n(damper.trim_start_matches('-'));
            let weight = if damper.starts_with('-') { -&size } else { size };
            let source = system.c.source(system.inputs[0].name);
            system.c.push(source, crate::system::Nature::Property, weight, [(CoordinateId(7), Number::ONE)]);
            system.initial = vec![(CoordinateId(0), n("0.01"), -&n("0.2")), (CoordinateId(5), n("0.02"), n("0"))];
            // Every signal goes through the same blocks: all of them once, then a harmonic and a step with an impulse.
            let some = |which: &usize| damper == "5" || [0, 5].contains(which);
            for (which, signal) in all_signals().into_iter().enumerate().filter(|(which, _)| some(which)) {
                let mut drives = vec![Vec::new(); FROM_POLES];
                drives[3] = signal;
                let found = meets(&format!("{damper} {which}"), &system, &drives, &grid("2.5", "0.25"));
                // A chirp is known to some 1e-20 of its amplitude, and drives poles of very different sizes.
                let bound = if which == 10 { 1e3 * bound } else { bound };
                assert!(found < bound, "{damper} {which}: {found:e}");
            }
        }
    }

    /// A base that moves a chain through springs, dampers and inertia, and is added to the outputs: its jumps are impulses and
    /// their derivatives.
    #[test]
    fn a_base_moves_poles_as_the_whole_matrix_does() {
        let mut system = chain(FROM_POLES, true, "0.7");
        push(&mut system.c, "40", 4, None);
        let at = |value: &str| vec![(CoordinateId(0), n(value))];
        system.inputs[0].b = [at("1000"), at("0.7"), at("0.2")];
        for (output, power) in [(0, 0), (1, 1), (2, 2)] {
            system.outputs[output].d[power].push((0, -&n("1.5")));
        }
        for signal in [
            harmonic("3", "0.9"),
            Signal::Step { value: n("0.1"), at: n("0.5") },
            Signal::Ramp { value: n("0.1"), from: n("0.5"), to: n("1.1") },
            Signal::Chirp { value: n("0.1"), from: n("4"), to: n("0"), duration: n("2"), at: n("0"), phase: n("0") },
        ] {
            let bound = meets(&format!("{signal:?}"), &system, &[vec![signal]], &grid("2.5", "0.0625"));
            // The second derivative of a chirp, which enters inertia forces and accelerations, is known to some 1e-16.
            assert!(bound < 1e-14, "{bound:e}");
        }
    }

    /// More states than a matrix exponential is computed for: a chain of 201 unit masses and springs, held at both ends, with
    /// C = K^2 / 2, so that fast motions are overdamped. The mode sin(i k pi / (n + 1)) has omega = 2 sin(k pi / (2 (n + 1))).
    #[test]
    fn two_hundred_masses_move_as_the_closed_form_says() {
        let size = 201;
        let mut system = blank(size);
        let source = system.c.source(system.inputs[0].name);
        for i in 0..size {
            push(&mut system.m, "1", i, None);
            push(&mut system.k, "1", i, i.checked_sub(1));
            let row = [(i.checked_sub(1), -1), (Some(i), 2), (Some(i + 1).filter(|&j| j < size), -1)];
            let row = row.into_iter().filter_map(|(j, a)| Some((CoordinateId(j? as u32), Number::from(a))));
            system.c.push(source, crate::system::Nature::Property, n("0.5"), row.collect::<Vec<_>>());
        }
        push(&mut system.k, "1", size - 1, None);
        system.initial = vec![(CoordinateId(3), n("1"), n("0"))];
        system.outputs.truncate(8);
        let times = grid("20", "2.5");
        let history = crate::analysis::response::respond(&system, &[], &times).expect("a motion");
        let angle = |k: usize| k as f64 * std::f64::consts::PI / (size + 1) as f64;
        for (row, t) in history.values.iter().zip(&times) {
            let t = t.to_f64();
            for (i, y) in row.iter().enumerate() {
                let of_mode = |k: usize| {
                    let omega = 2.0 * libm::sin(0.5 * angle(k));
                    let half = 0.25 * omega.power(4);
                    let square = half * half - omega * omega;
                    let root = square.abs().sqrt();
                    let (even, odd) = match square > 0.0 {
                        // cosh and sinh, each with the decay, so that neither overflows.
                        true => {
                            let (slow, fast) = (libm::exp((root - half) * t), libm::exp((-root - half) * t));
                            (0.5 * (slow + fast), 0.5 * (slow - fast) / root)
                        }
                        false => {
                            let decay = libm::exp(-half * t);
                            (decay * libm::cos(root * t), decay * libm::sin(root * t) / root)
                        }
                    };
                    let shape = |i: usize| libm::sin((i + 1) as f64 * angle(k));
                    shape(i) * shape(3) * (even + half * odd) * 2.0 / (size + 1) as f64
                };
                let expected: f64 = (1..=size).map(of_mode).sum();
                assert!((y.to_f64() - expected).abs() < 1e-12, "{t} {i}: {y:?} {expected}");
                assert!(y.rad < 1e-22, "{t} {i}: {y:?}");
            }
        }
    }

    /// What couples the poles is in the bound: a proof that allows more for it has wider bounds, by as much.
    #[test]
    fn the_coupling_of_poles_is_in_the_bound() {
        let mut system = chain(FROM_POLES, true, "0.7");
        push(&mut system.c, "5", 2, None);
        system.initial = vec![(CoordinateId(0), n("0.01"), n("0"))];
        let times = grid("2", "0.25");
        let widest = |coupling: f64| {
            let mut run = Run::of(&system, None, &[], &times).expect("poles");
            run.blocks.defect = coupling;
            let mut values = Vec::new();
            let moments: Vec<Moment> = times.iter().map(Moment::of).collect();
            while values.len() < times.len() {
                let first = values.len();
                run.samples(&moments[first..], f64::INFINITY, &mut values).expect("samples");
            }
            values[8].iter().map(|y| y.rad).fold(0.0, f64::max)
        };
        let (little, much) = (widest(1e-12), widest(1e-9));
        assert!(widest(0.0) < 1e-3 * little && much > 900.0 * little && much < 1100.0 * little, "{little:e} {much:e}");
    }

    /// Resonance without damping, critical and overcritical damping, growth, and unequal time steps.
    #[test]
    fn hard_oscillators_move_as_the_whole_matrix_says() {
        let oscillator = |c: &str, k: &str| {
            let mut system = blank(1);
            push(&mut system.m, "1", 0, None);
            for (form, text) in [(&mut system.c, c), (&mut system.k, k)] {
                let source = form.source(system.inputs[0].name);
                let size = n(text.trim_start_matches('-'));
                let weight = if text.starts_with('-') { -&size } else { size };
                form.push(source, crate::system::Nature::Property, weight, [(CoordinateId(0), Number::ONE)]);
            }
            system.initial = vec![(CoordinateId(0), n("1"), n("0.5"))];
            system
        };
        let own = Signal::Harmonic {
            value: n("1"),
            frequency: Number::pi().recip().expect("not zero"),
            phase: n("0"),
            at: n("0"),
        };
        let mut uneven: Vec<Number> = (1..40).map(|i| &n("7") / &Number::from(41 - i)).collect();
        uneven.insert(0, Number::ZERO);
        for times in [grid("20", "0.25"), uneven] {
            for (c, k) in [("0", "4"), ("4", "4"), ("4.0000001", "4"), ("50", "4"), ("-0.1", "4"), ("0", "-0.25")] {
                let bound = meets(&format!("{c} {k}"), &oscillator(c, k), &[vec![own.clone()]], &times);
                assert!(bound < 1e-19, "{c} {k}: {bound:e}");
            }
        }
    }

    /// The method does not apply if damping couples the modes.
    #[test]
    fn joined_modes_are_refused() {
        let mut system = chain(3, true, "0.7");
        push(&mut system.c, "5", 2, None);
        assert!(respond(&system, None, &[], &grid("2", "0.1")).is_none());
    }

    /// A damper that couples the modes slightly, by one part in 10^8 to 10^28: whichever method is chosen, the digits
    /// are correct.
    #[test]
    fn nearly_separated_modes_keep_their_digits() {
        for digits in (8..=28).step_by(2) {
            let mut system = chain(3, true, "0.7");
            push(&mut system.c, &format!("1e-{digits}"), 2, None);
            system.initial = vec![(CoordinateId(0), n("0.01"), -&n("0.2"))];
            let history = crate::analysis::response::respond(&system, &[], &grid("2.5", "0.0625")).expect("a motion");
            for output in 0..system.outputs.len() {
                let column = || history.values.iter().map(|row| row[output]);
                let largest = column().map(|y| y.mid.hi.abs()).fold(0.0, f64::max);
                let widest = column().map(|y| y.rad).fold(0.0, f64::max);
                assert!(widest < 1e-18 * largest, "1e-{digits}, output {output}: {widest:e} of {largest:e}");
            }
        }
    }

    /// Compares a long run in many batches with one step of the whole matrix.
    #[test]
    fn ten_thousand_steps_keep_their_digits() {
        let mut system = chain(4, true, "0.0001");
        system.initial = vec![(CoordinateId(3), n("1"), n("0"))];
        let drives = [vec![harmonic("4", "0.5")]];
        let times = grid("1000", "0.1");
        let apart = respond(&system, None, &drives, &times).expect("modes apart").history;
        let whole = respond_by_matrix_exponential(&system, &drives, &times[10_000..]).expect("a motion");
        for (a, b) in apart.values[10_000].iter().zip(&whole.values[0]) {
            assert!((*a - *b).contains_zero(), "{a:?} {b:?}");
            assert!(a.relative_error() < 1e-19, "{a:?}");
        }
    }
}
