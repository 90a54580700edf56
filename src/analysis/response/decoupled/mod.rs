//! The motion of a system whose damping does not couple its modes: each mode is an independent oscillator, so a step
//! needs two by two numbers a mode instead of a full matrix, and several modes and several times are computed in
//! parallel. In: a system, signals, times. Out: the result of the general method, with bounds as good, or nothing if
//! that cannot be proven here. See docs/method/response.md#modal-steps.
//!
//! With the modes X refined to double-double, X^T M X = 1 + E_M, X^T C X = D_c + E_C, X^T K X = D_k + E_K in balls, and
//! q = X eta exactly: the E are disturbances of the oscillators eta'' + c eta' + k eta = x . B u, and their effect
//! grows in the norm of z = (s eta, eta'), s^2 near |k|, at most with the logarithmic norm of the oscillators.

mod lanes;
mod oscillators;
mod step;

use super::channel::{Channel, SuddenChange, channels};
use super::trail::Trail;
use super::{History, UP};
use crate::analysis::answer::Modes;
use crate::analysis::response::signal::Source;
use crate::base::{Ball, Dd, Number, Power};
use crate::kernel::lanes::Lanes;
use crate::system::{LinearSystem, Signal};
use lanes::{Batch, Row, Samples, State};
use oscillators::{Oscillators, Output};
use std::rc::Rc;
use step::Step;

/// For fewer samples times coordinates, computing the modes does not pay.
pub const WORTH_IT: usize = 16;
/// The most samples between two evaluations of the harmonic sources' formulas.
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

/// Like [`super::respond`]; `None` if another method is needed: damping couples modes, bounds are not good enough, or
/// the general method has to report an error.
pub fn respond(
    system: &LinearSystem,
    modes: Option<&Modes>,
    drives: &[Vec<Signal>],
    times: &[Number],
) -> Option<History> {
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
    run.is_good(&values).then(|| History { times: times.to_vec(), values })
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
    oscillators: Oscillators,
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

/// The active sources during a batch.
struct Driving {
    /// By time (one more than there are steps), then by state.
    states: Vec<Dd>,
    /// Their norms, and a bound of the error of each.
    norms: Vec<f64>,
    error: f64,
    on: usize,
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
        let step = match times {
            [first, second, ..] => Some(second - first).filter(Number::is_positive),
            _ => None,
        };
        let channels = channels(system, drives, step.as_ref()).ok()?;
        let oscillators = Oscillators::of(system, modes, &channels, times)?;
        let outputs = oscillators.outputs(system, &channels);
        let n = oscillators.count();
        let rows = outputs.iter().map(|output| output.row.clone()).collect();
        let state = State { z: [Lanes::zeros(n), Lanes::zeros(n)] };
        let now = Number::ZERO;
        let (steps, scales) = (Vec::new(), Vec::new());
        let mut run = Run {
            system,
            oscillators,
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
        let (eta, rate) = run.oscillators.start(system);
        run.add(&eta, &rate);
        Some(run)
    }

    /// The events in order; simultaneous ones in the order of the channels.
    fn events(&self) -> Vec<Event> {
        let mut events: Vec<Event> = Vec::new();
        for (channel, c) in self.channels.iter().enumerate() {
            for (piece, at) in c.source.events().into_iter().enumerate() {
                events.push(Event { at: Moment::of(&at), channel, piece });
            }
        }
        events.sort_by(|a, b| a.at.seconds.total_cmp(&b.at.seconds));
        events
    }

    /// Adds displacements and velocities of the modes, which are known up to the disturbances.
    fn add(&mut self, eta: &[Ball], rate: &[Ball]) {
        let of = &self.oscillators;
        let (mut radii, mut square, mut size) = (0.0, 0.0, 0.0);
        for i in 0..of.count() {
            let changes = [Ball::exact(of.s[i]) * eta[i], rate[i]];
            for (z, change) in self.state.z.iter_mut().zip(changes) {
                let sum = Ball::exact(z.get(i)) + change;
                z.set(i, sum.mid);
                radii += sum.rad * sum.rad;
                square += sum.mid.hi * sum.mid.hi;
            }
            size += eta[i].magnitude().power(2);
        }
        let rates = rate.iter().map(|v| v.magnitude().power(2)).sum::<f64>();
        self.square = square;
        self.trail.add((radii.sqrt() + of.defect_of_change(size.sqrt() * UP, rates.sqrt() * UP)) * UP);
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
        let step = Rc::new(Step::of(&self.oscillators, &on, h)?);
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
            let scale: Vec<f64> = (0..states).map(|k| 1.0 / self.oscillators.scale[channel.first + k]).collect();
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
        let of = &self.oscillators;
        let approximations = of.approximations(self.system, &self.channels);
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
        let input = &self.system.inputs[self.channels[channel].input];
        let of = &self.oscillators;
        let zeros = || vec![Ball::ZERO; of.count()];
        let times = |x: Vec<Ball>, value: Ball| -> Vec<Ball> { x.into_iter().map(|x| x * value).collect() };
        let (eta, mut rate) = match self.channels[channel].turn_on(piece) {
            SuddenChange::None => return Some(()),
            SuddenChange::Impulse(value) => {
                if !(input.b[1].is_empty() && input.b[2].is_empty()) {
                    return None;
                }
                (zeros(), times(of.participation(&input.b[0]), value))
            }
            SuddenChange::Jump([u, speed]) => {
                let (b1, b2) = (of.participation(&input.b[1]), of.participation(&input.b[2]));
                let kick = b1.iter().zip(&b2).map(|(&b1, &b2)| b1 * u + b2 * speed).collect();
                (times(b2, u), kick)
            }
        };
        if eta.iter().chain(&rate).all(Ball::is_zero) {
            return Some(());
        }
        for (rate, (c, eta)) in rate.iter_mut().zip(of.c.iter().zip(&eta)) {
            *rate = *rate - Ball::exact(*c) * *eta;
        }
        self.add(&eta, &rate);
        Some(())
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
        let apart = respond(system, None, drives, times).unwrap_or_else(|| panic!("{what}: no such method"));
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

    #[test]
    fn all_signals_move_a_chain_as_the_whole_matrix_does() {
        let numbers = |list: &[&str]| list.iter().map(|&text| n(text)).collect::<Vec<_>>();
        let (times, values) = (numbers(&["0", "0.7", "2", "2.05"]), numbers(&["0.1", "2.1", "6", "1"]));
        let table = |course| Signal::Table(Table { times: times.clone(), values: values.clone(), course });
        let integral = |of, times| Signal::Integral { of: Box::new(of), times };
        let by = n("0.21");
        let signals = [
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
        ];
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
        let apart = respond(&system, None, &drives, &times).expect("modes apart");
        let whole = respond_by_matrix_exponential(&system, &drives, &times[10_000..]).expect("a motion");
        for (a, b) in apart.values[10_000].iter().zip(&whole.values[0]) {
            assert!((*a - *b).contains_zero(), "{a:?} {b:?}");
            assert!(a.relative_error() < 1e-19, "{a:?}");
        }
    }
}
