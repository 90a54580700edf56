//! Signals built into the state, so that nothing is lost between samples: a harmonic is two rotating states; a step, a
//! ramp or a polynomial is a chain of states. In: the signals of each input. Out: separate cells, their effect on the
//! other blocks, and the changes between samples. See docs/method/emit.md.
//!
//! The states of a chain are u, h u', h^2 u''/2!, ...: one step adds binomial multiples of each other, for any h.

use crate::analysis::discrete::pieces::{self, Chain, Knot, MOST_EVENTS, When, scales};
use crate::analysis::peak::last_event;
use crate::analysis::response::signal::Source;
use crate::base::{Dd, Number, OrderBy, Rational};
use crate::kernel::dense::Matrix;
use crate::system::{LinearSystem, Signal};
use num_integer::Integer;

/// An impulse on an input.
#[derive(Clone, Debug)]
pub struct Impulse {
    pub input: usize,
    pub value: Dd,
    pub when: When,
}

/// All signals, prepared for emission.
#[derive(Clone, Debug, Default)]
pub struct Signals {
    pub chains: Vec<Chain>,
    /// Ascending.
    pub impulses: Vec<Impulse>,
    pub repeat: Option<Repeat>,
}

/// After the sample `from`, everything repeats with this period in samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Repeat {
    pub from: u64,
    pub ticks: u64,
}

/// Error: the signal of this input has no form for emitted code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The signal needs too many pieces.
    TooLong { input: usize },
    /// The signal is periodic, but its period is not a whole number of steps, or its motion does not repeat.
    NeverRepeats { input: usize },
}

impl Signals {
    /// The signals of each input until `until` (without it, all of them), for steps of `step`.
    pub fn of(drives: &[Vec<Signal>], step: &Number, until: Option<&Number>) -> Result<Signals, Fault> {
        let repeat = if until.is_none() { repeat(drives, step)? } else { None };
        let end = repeat.map(|repeat| step * &Number::from((repeat.from + repeat.ticks) as i64 + AFTER));
        let until = until.or(end.as_ref());
        let mut signals = Signals { repeat, ..Signals::default() };
        let felt = |at: &Number| until.is_none_or(|until| !(until - at).is_negative());
        for (input, list) in drives.iter().enumerate() {
            let too_long = Fault::TooLong { input };
            let list: Vec<Signal> = list.iter().flat_map(from_zero).collect();
            let sources: Result<Vec<Source>, _> = list.iter().map(|signal| Source::of(signal, None, until)).collect();
            let sources = sources.map_err(|_| too_long)?;
            let polynomials = pieces::knots(&sources, step, felt).ok_or(too_long)?;
            signals.chains.extend(polynomials.map(|(start, knots)| polynomial(input, start, knots, step)));
            for (signal, source) in list.iter().zip(&sources) {
                match (signal, source) {
                    (Signal::Harmonic { frequency, .. }, Source::Harmonic { .. }) => {
                        signals.chains.extend(harmonic(input, source, frequency, step));
                    }
                    (_, Source::Impulse { value, at }) if felt(at) => {
                        let when = When::of(at, step).ok_or(too_long)?;
                        signals.impulses.push(Impulse { input, value: value.mid, when });
                    }
                    _ => {}
                }
            }
        }
        signals.impulses.order_by_key(|impulse| impulse.when.tick);
        if let Some(repeat) = repeat {
            let open = |chain: &&Chain| chain.angle.is_none() && !chain.comes_again(repeat.from, repeat.ticks);
            if let Some(chain) = signals.chains.iter().find(open) {
                return Err(Fault::NeverRepeats { input: chain.input });
            }
        }
        Ok(signals)
    }

    /// The impulses in the step to a sample.
    pub fn impulses_at(&self, tick: u64) -> &[Impulse] {
        let first = self.impulses.partition_point(|impulse| impulse.when.tick < tick);
        let count = self.impulses[first..].partition_point(|impulse| impulse.when.tick == tick);
        &self.impulses[first..first + count]
    }

    /// An input that prescribes a motion and has an impulse, which would need infinite forces.
    pub fn base_with_impulse(&self, system: &LinearSystem) -> Option<usize> {
        let moves = |input: usize| {
            let b = &system.inputs[input].b;
            !(b[1].is_empty() && b[2].is_empty())
        };
        self.impulses.iter().map(|impulse| impulse.input).find(|&input| moves(input))
    }

    /// Keeps the signals of inputs that have an effect.
    pub fn retain_effective(mut self, felt: impl Fn(usize) -> bool) -> Signals {
        self.chains.retain(|chain| felt(chain.input));
        self.impulses.retain(|impulse| felt(impulse.input));
        self
    }
}

/// Number of samples after the last one that repeats; their pieces decide how the last step is taken.
const AFTER: i64 = 3;

/// The period of everything, if some signal is periodic.
fn repeat(drives: &[Vec<Signal>], step: &Number) -> Result<Option<Repeat>, Fault> {
    let mut ticks: Option<u64> = None;
    let mut from: u64 = 0;
    for (input, list) in drives.iter().enumerate() {
        let never = Fault::NeverRepeats { input };
        for signal in list {
            let begin = match period(signal) {
                None => last_event(signal) / step.to_f64(),
                Some((period, delay)) => {
                    let own = steps_of(period, step).ok_or(never)?;
                    let all = ticks.map_or(own, |ticks| ticks.lcm(&own));
                    ticks = Some(all).filter(|all| *all < MOST_TICKS).map(Some).ok_or(never)?;
                    delay / step.to_f64()
                }
            };
            if !(0.0..MOST_TICKS as f64).contains(&begin.ceil()) {
                return Err(Fault::TooLong { input });
            }
            from = from.max(begin.ceil() as u64 + 1);
        }
    }
    Ok(ticks.map(|ticks| Repeat { from, ticks }))
}

/// Beyond this the counter of samples would overflow.
const MOST_TICKS: u64 = 1_000_000_000;

/// The period of a periodic signal, and the time at which it begins, s.
fn period(signal: &Signal) -> Option<(&Number, f64)> {
    match signal {
        Signal::Table(table) => table.period.as_ref().map(|period| (period, 0.0)),
        Signal::Integral { of, .. } => period(of),
        Signal::Delayed { of, by } => period(of).map(|(period, begin)| (period, begin + by.to_f64())),
        _ => None,
    }
}

/// The number of steps after which a period and a sample begin together.
fn steps_of(period: &Number, step: &Number) -> Option<u64> {
    let steps = period / step;
    let steps = steps.exact()?;
    let whole = |periods: usize| (steps * &Rational::from(periods as i64)).to_i64();
    (1..=MOST_EVENTS).find_map(whole).and_then(|ticks| u64::try_from(ticks).ok()).filter(|ticks| *ticks > 0)
}

/// A harmonic that begins later as one from t = 0 on, less its polynomials until then.
fn from_zero(signal: &Signal) -> Vec<Signal> {
    match signal {
        Signal::Harmonic { value, frequency, phase, at } if !at.is_zero() => {
            let (value, frequency, phase) = (value.clone(), frequency.clone(), phase.clone());
            let before = Signal::Chirp {
                value: -&value,
                from: frequency.clone(),
                to: frequency.clone(),
                duration: at.clone(),
                at: Number::ZERO,
                phase: phase.clone(),
            };
            vec![Signal::Harmonic { value, frequency, phase, at: Number::ZERO }, before]
        }
        signal => vec![signal.clone()],
    }
}

/// A chain for the sum of all polynomials of an input.
fn polynomial(input: usize, start: Vec<Dd>, knots: Vec<Knot>, step: &Number) -> Chain {
    let order = start.len();
    let scale = scales(order, step.to_ball().mid);
    let rows = [0, 1, 2].map(|p| (0..order).map(|k| if k == p { Dd::ONE / scale[k] } else { Dd::ZERO }).collect());
    let generator = Matrix::from_fn(order, order, |i, j| if j == i + 1 { Dd::from(j as f64) } else { Dd::ZERO });
    let values = knots.iter().map(|knot| &knot.states).chain([&start]).filter_map(|states| states.first());
    let largest = values.map(|x| x.hi.abs()).fold(0.0, f64::max);
    Chain { input, generator, rows, start, angle: None, knots, largest, name: "piecewise signals".into() }
}

fn harmonic(input: usize, source: &Source, frequency: &Number, step: &Number) -> Option<Chain> {
    let Source::Harmonic { amplitude, omega, sine, cosine, .. } = source else { return None };
    let turn = omega.mid * step.to_ball().mid;
    let generator = Matrix::from_fn(2, 2, |i, j| match (i, j) {
        (0, 1) => turn,
        (1, 0) => -turn,
        _ => Dd::ZERO,
    });
    let (a, w) = (amplitude.mid, omega.mid);
    Some(Chain {
        input,
        generator,
        rows: [vec![a, Dd::ZERO], vec![Dd::ZERO, a * w], vec![-(a * w * w), Dd::ZERO]],
        start: vec![sine.mid, cosine.mid],
        angle: Some(angle(&(frequency * step)).unwrap_or(turn)),
        knots: Vec::new(),
        largest: a.hi.abs(),
        name: "harmonic signal".into(),
    })
}

/// 2 pi times the fractional part of a number of turns, if that number is exact.
fn angle(turns: &Number) -> Option<Dd> {
    let turns = turns.exact()?;
    let whole = (turns + &Rational::new(1, 2)).floor();
    Some(Dd::PI * (&(turns - &whole) * &Rational::from(2)).to_ball().mid)
}
