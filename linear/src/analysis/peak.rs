//! Measures of the motion in time: the largest |output|, also between the samples, and the root of its mean square. In:
//! the system, signals, an output, a time. Out: a ball that contains the true number. See docs/method/measures.md.

use crate::analysis::answer::{PoleKind, Poles};
use crate::analysis::error::AnalysisError;
use crate::analysis::largest::Largest;
use crate::analysis::measures::Measurement;
use crate::analysis::response::course::{Outcome, follow};
use crate::analysis::response::square::mean_square;
use crate::base::{Ball, Number, Rational};
use crate::system::{LinearSystem, Signal, Table};

const TOO_LONG: Measurement =
    Measurement::None("the fastest motion has too many cycles in that time: choose a shorter one with `--until`");

/// Digits do not decide whether the output is infinite at an instant.
pub const OPEN: &str = "it is not decided whether an impulse reaches the output where a signal jumps";

/// The largest |output| from 0 to `until`.
pub fn peak(system: &LinearSystem, drives: &[Vec<Signal>], output: usize, until: &Number) -> Measurement {
    let mut largest = Largest::default();
    measure(follow(system, drives, output, until, &mut largest), |()| largest.ball())
}

/// sqrt(integral of output^2 / until) from 0 to `until`.
pub fn rms(system: &LinearSystem, drives: &[Vec<Signal>], output: usize, until: &Number) -> Measurement {
    let mut square = None;
    let followed = mean_square(system, drives, output, until).map(|(followed, value)| {
        square = value;
        followed
    });
    measure(followed, |()| square.map_or(Ball::ZERO.widen(f64::INFINITY), Ball::sqrt))
}

fn measure(followed: Result<Outcome, AnalysisError>, value: impl FnOnce(()) -> Ball) -> Measurement {
    match followed {
        Ok(Outcome::ToTheEnd) => Some(value(())).filter(Ball::is_finite).map_or(TOO_LONG, Measurement::Value),
        Ok(Outcome::Infinite) => Measurement::Infinite,
        Ok(Outcome::Open) => Measurement::None(OPEN),
        Ok(Outcome::TooLong) => TOO_LONG,
        Err(error) => Measurement::Failed(error.to_diagnostic().message),
    }
}

/// The default simulation time: until the last signal has ended and the motion has then decayed to a thousandth, but at
/// most a hundred and at least three periods of the slowest motion; rounded up to two digits. `None` if the motion
/// grows, or if no time follows from poles and signals.
pub fn usual_time(poles: &Poles, drives: &[Vec<Signal>]) -> Option<Number> {
    let mut last: f64 = 0.0;
    let mut period: f64 = 0.0;
    for signal in drives.iter().flatten() {
        let (event, cycle) = times_of(signal);
        (last, period) = (last.max(event), period.max(cycle));
    }
    let mut decay: f64 = 0.0;
    for pole in &poles.list {
        let (re, im) = (pole.re.to_f64(), pole.im.to_f64().abs());
        match pole.kind {
            PoleKind::Divergence | PoleKind::Flutter | PoleKind::Undetermined => return None,
            PoleKind::Rigid => {}
            PoleKind::Oscillation | PoleKind::Overdamped => {
                if im > 0.0 {
                    period = period.max(std::f64::consts::TAU / im);
                }
                decay = decay.max(if re < 0.0 { THOUSANDTH / -re } else { f64::INFINITY });
            }
        }
    }
    let after = if period > 0.0 { decay.min(100.0 * period).max(3.0 * period) } else { decay };
    let time = if after > 0.0 && after.is_finite() { last + after } else { 2.0 * last };
    round_up(time)
}

/// ln 1000
const THOUSANDTH: f64 = 6.907_755_278_982_137;

/// The time of the signal's last event, and its period, s.
fn times_of(signal: &Signal) -> (f64, f64) {
    match signal {
        Signal::Step { at, .. } | Signal::Impulse { at, .. } => (at.to_f64(), 0.0),
        Signal::Ramp { to, .. } | Signal::Pulse { to, .. } => (to.to_f64(), 0.0),
        Signal::Harmonic { frequency, at, .. } if frequency.to_f64() != 0.0 => {
            (at.to_f64(), 1.0 / frequency.to_f64().abs())
        }
        Signal::Harmonic { at, .. } => (at.to_f64(), 0.0),
        Signal::Chirp { duration, at, .. } => ((at + duration).to_f64(), 0.0),
        Signal::Table(Table { period: Some(period), .. }) => (0.0, period.to_f64()),
        Signal::Table(table) => (table.times.last().map_or(0.0, Number::to_f64).max(0.0), 0.0),
        Signal::Integral { of, .. } => times_of(of),
        Signal::Delayed { of, by } => {
            let (event, cycle) = times_of(of);
            (event + by.to_f64(), cycle)
        }
    }
}

/// The time of the signal's last event, s.
pub(in crate::analysis) fn last_event(signal: &Signal) -> f64 {
    times_of(signal).0
}

/// Rounds up to two digits.
pub(in crate::analysis) fn round_up(time: f64) -> Option<Number> {
    if !(time.is_finite() && time > 0.0) {
        return None;
    }
    let text = format!("{time:.1e}");
    let (digits, exponent) = text.split_once('e')?;
    let rounded = Rational::from_decimal(&text)?;
    if rounded.to_f64() >= time {
        return Some(Number::from(rounded));
    }
    let more = Rational::from_decimal(&format!("{digits}e{exponent}"))?;
    let unit = Rational::from_decimal(&format!("0.1e{exponent}"))?;
    Some(Number::from(&more + &unit))
}
