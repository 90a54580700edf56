//! The state of a source that drives an input: which of its pieces is active, the sudden changes when that switches,
//! and its part in the equations of motion: states with a generator, forces, and rows for the outputs that
//! it feeds directly.

use super::propagator::Exogenous;
use super::signal::{Source, TooManyPieces};
use super::sum::sum;
use crate::analysis::error::AnalysisError;
use crate::base::{Ball, Number};
use crate::system::{LinearSystem, Signal};

/// A source of an input, with its current piece.
pub struct Channel {
    pub input: usize,
    pub source: Source,
    /// The circular frequency of a harmonic, as given in the model.
    omega: Number,
    /// Index of its first state.
    pub first: usize,
    /// The active piece.
    pub active: Option<usize>,
}

/// Beyond this angle, rad, binary64 loses digits that its frequency and time have.
const MANY_TURNS: f64 = 1e5;

/// The sudden effect of a source.
pub enum SuddenChange {
    None,
    Impulse(Ball),
    /// Jumps of u and u'.
    Jump([Ball; 2]),
}

impl Channel {
    /// A bound of the error of the k-th derivative of the input.
    pub fn approximation(&self, k: usize) -> f64 {
        match (&self.source, self.active) {
            // A constant piece is exact.
            (Source::Pieces { pieces, .. }, Some(piece)) if pieces[piece].derivatives.len() <= 1 => 0.0,
            (source, Some(_)) => source.approximation(k),
            (_, None) => 0.0,
        }
    }

    pub fn states_on(&self) -> usize {
        match (&self.source, self.active) {
            (_, None) => 0,
            (Source::Pieces { pieces, .. }, Some(piece)) => pieces[piece].derivatives.len(),
            (source, Some(_)) => source.order(),
        }
    }

    pub fn turn_on(&mut self, piece: usize) -> SuddenChange {
        let before = self.active.replace(piece);
        match &self.source {
            Source::Impulse { value, .. } => SuddenChange::Impulse(*value),
            Source::Harmonic { amplitude, omega, at, .. } => {
                let state = self.state(at);
                SuddenChange::Jump([*amplitude * state[0], *amplitude * *omega * state[1]])
            }
            Source::Pieces { pieces, .. } if pieces[piece].jump => {
                let new = &pieces[piece];
                let old = before.map(|i| pieces[i].values_after(&new.at));
                let difference = |k: usize| {
                    let now = new.derivatives.get(k).cloned().unwrap_or(Number::ZERO);
                    let then = old.as_ref().map_or(Number::ZERO, |old| old[k].clone());
                    (&now - &then).to_ball()
                };
                SuddenChange::Jump([difference(0), difference(1)])
            }
            Source::Pieces { .. } => SuddenChange::None,
        }
    }

    /// The states at a time, from the source's formula.
    pub fn state(&self, time: &Number) -> Vec<Ball> {
        match &self.source {
            Source::Impulse { .. } => Vec::new(),
            _ if self.active.is_none() => vec![Ball::ZERO; self.source.order()],
            Source::Harmonic { omega, sine, cosine, .. } => {
                let near = *omega * time.to_ball();
                // Exact numbers lose no digits, whatever the number of turns.
                let angle = if near.magnitude() > MANY_TURNS { &self.omega * time } else { Number::Ball(near) };
                let unknown = (Number::Ball(Ball::ZERO.widen(1.0)), Number::Ball(Ball::ZERO.widen(1.0)));
                let (s, c) = angle.sin_cos().unwrap_or(unknown);
                let (s, c) = (s.to_ball(), c.to_ball());
                vec![s * *cosine + c * *sine, c * *cosine - s * *sine]
            }
            Source::Pieces { order, pieces, .. } => {
                let mut state = self.active.map_or(Vec::new(), |i| pieces[i].at_time(time));
                state.resize(*order, Ball::ZERO);
                state
            }
        }
    }
}

/// The channels of all inputs for a motion that stops at these times.
pub fn channels(
    system: &LinearSystem,
    drives: &[Vec<Signal>],
    times: &[Number],
) -> Result<Vec<Channel>, AnalysisError> {
    let step = match times {
        [first, second, ..] => Some(second - first).filter(Number::is_positive),
        _ => None,
    };
    let until = times.iter().max_by(|a, b| a.to_f64().total_cmp(&b.to_f64()));
    let mut channels = Vec::new();
    let mut first = 0;
    for (input, signals) in drives.iter().enumerate().take(system.inputs.len()) {
        for (source, omega) in
            sources(signals, step.as_ref(), until).map_err(|_| AnalysisError::signal_too_long(system, input))?
        {
            let states = source.order();
            channels.push(Channel { input, source, omega, first, active: None });
            first += states;
        }
    }
    Ok(channels)
}

/// The signals of an input, combined into few sources; harmonics with their circular frequencies.
fn sources(
    signals: &[Signal],
    step: Option<&Number>,
    until: Option<&Number>,
) -> Result<Vec<(Source, Number)>, TooManyPieces> {
    let (mut list, mut jumps) = (Vec::new(), Vec::new());
    for signal in signals {
        let source = Source::of(signal, step, until)?;
        let omega = match signal {
            Signal::Harmonic { frequency, .. } => &(&Number::pi() * &Number::from(2)) * frequency,
            _ => Number::ZERO,
        };
        if source.is_sum_of_jumps() { jumps.push(source) } else { list.push((source, omega)) }
    }
    let sum = if jumps.len() > 1 { Some(sum(&jumps)) } else { jumps.pop() };
    list.extend(sum.map(|sum| (sum, Number::ZERO)));
    Ok(list)
}

/// Error that the sources' own approximations cause in an output with direct feed-through, for these factors of their
/// states.
pub fn fed_approximations(channels: &[Channel], factor: impl Fn(usize) -> f64) -> f64 {
    let of = |channel: &Channel| -> f64 {
        if channel.approximation(0) == 0.0 {
            return 0.0;
        }
        let fed = (0..channel.states_on()).map(|k| (k, factor(channel.first + k)));
        fed.filter(|(_, factor)| *factor > 0.0).map(|(k, factor)| factor * channel.approximation(k)).sum()
    };
    channels.iter().map(of).sum()
}

/// For each state of each channel, the longest time between stops while it is active. A constant drives the system for
/// its whole duration, but a later piece may be far from constant and short.
fn longest_steps(channels: &[Channel], times: &[Number]) -> Vec<f64> {
    let mut stops: Vec<f64> = channels.iter().flat_map(|c| c.source.events()).map(|at| at.to_f64()).collect();
    stops.extend(times.iter().map(Number::to_f64));
    stops.push(0.0);
    stops.sort_by(f64::total_cmp);
    let last = times.iter().map(Number::to_f64).fold(0.0, f64::max);
    // The longest step that begins in [from, to).
    let longest = |from: f64, to: f64| {
        let begin = stops.partition_point(|&at| at < from);
        let steps = stops[begin..].windows(2).take_while(|w| w[0] < to);
        steps.map(|w| w[1].min(last) - w[0]).fold(0.0, f64::max)
    };
    let of = |channel: &Channel| {
        let mut states = vec![0.0f64; channel.source.order()];
        match &channel.source {
            Source::Pieces { pieces, .. } => {
                for (i, piece) in pieces.iter().enumerate() {
                    let end = pieces.get(i + 1).map_or(f64::INFINITY, |next| next.at.to_f64());
                    let step = longest(piece.at.to_f64(), end);
                    states[..piece.derivatives.len()].iter_mut().for_each(|state| *state = state.max(step));
                }
            }
            _ => states.fill(longest(0.0, f64::INFINITY)),
        }
        states
    };
    channels.iter().flat_map(of).map(|longest| if longest > 0.0 { longest } else { 1.0 }).collect()
}

/// u, u' and u'' of a source as rows over its states.
pub fn derivatives(source: &Source) -> [Vec<(usize, Ball)>; 3] {
    match source {
        Source::Harmonic { amplitude, omega, .. } => {
            let speed = *amplitude * *omega;
            [vec![(0, *amplitude)], vec![(1, speed)], vec![(0, -(speed * *omega))]]
        }
        Source::Pieces { order, .. } => [0, 1, 2].map(|k| if k < *order { vec![(k, Ball::ONE)] } else { Vec::new() }),
        Source::Impulse { .. } => Default::default(),
    }
}

pub fn exogenous(system: &LinearSystem, channels: &[Channel], times: &[Number]) -> Exogenous {
    let count = channels.iter().map(|channel| channel.source.order()).sum();
    let mut sources = Exogenous {
        count,
        generator: Vec::new(),
        force: Vec::new(),
        longest: longest_steps(channels, times),
        chained: vec![false; count],
        paired: vec![false; count],
    };
    for channel in channels {
        let first = channel.first;
        match &channel.source {
            Source::Harmonic { omega, .. } => {
                sources.generator.extend([(first, first + 1, *omega), (first + 1, first, -*omega)]);
                sources.paired[first + 1] = true;
            }
            Source::Pieces { order, .. } => {
                for k in 1..*order {
                    sources.generator.push((first + k - 1, first + k, Ball::ONE));
                    sources.chained[first + k] = true;
                }
            }
            Source::Impulse { .. } => {}
        }
        for (b, row) in system.inputs[channel.input].b.iter().zip(derivatives(&channel.source)) {
            for (i, value) in b {
                let forces = row.iter().map(|&(k, factor)| (i.index(), first + k, value.to_ball() * factor));
                sources.force.extend(forces);
            }
        }
    }
    sources
}
