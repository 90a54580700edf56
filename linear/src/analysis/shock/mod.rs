//! Shock response spectra: the largest motions of single oscillators whose base moves as a signal says. In: the signals of a
//! base, a damping ratio, frequencies. Out: for each frequency the largest positive and negative values during the signal and
//! after its last event, as balls: the maxima of the continuous motion, not of samples. See docs/method/shock.md.

mod base_motion;
mod course;
mod entries;
mod free;
mod oscillator;
mod sweep;
#[cfg(test)]
mod tests;

use crate::analysis::transfer::table::{linear, logarithmic};
use crate::base::{Ball, Number, OrderBy};
use crate::system::Signal;
use base_motion::BaseMotion;

/// A shock response spectrum.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ShockSpectrum {
    pub quantity: Quantity,
    pub damping: Number,
    /// The time of the last event of the signal, s: before it a maximum is primary, after it residual.
    pub end: Number,
    /// In ascending frequency.
    pub rows: Vec<ShockRow>,
}

/// The largest motions of the oscillator of one frequency: magnitudes, 0 where there is no motion to that side. In m/s^2 or m,
/// for a base that turns in rad/s^2 or rad.
#[derive(Clone, Copy, Debug)]
pub struct Sides {
    pub positive: Ball,
    pub negative: Ball,
}

#[derive(Clone, Debug)]
pub struct ShockRow {
    /// Undamped natural frequency, Hz.
    pub frequency: Number,
    /// Until the last event of the signal.
    pub primary: Sides,
    /// From then on.
    pub residual: Sides,
}

impl Sides {
    /// The larger magnitude of both.
    pub fn largest(&self) -> Ball {
        larger(self.positive, self.negative)
    }

    fn map(&self, of: impl Fn(Ball) -> Ball) -> Sides {
        Sides { positive: of(self.positive), negative: of(self.negative) }
    }

    fn exchange(self) -> Sides {
        Sides { positive: self.negative, negative: self.positive }
    }
}

impl ShockRow {
    /// The largest magnitude at any time.
    pub fn maximax(&self) -> Ball {
        larger(self.primary.largest(), self.residual.largest())
    }
}

/// The measured motion of the oscillator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// -omega^2 z for the motion z of the mass relative to the base: the acceleration of the mass if there is no damping.
    PseudoAcceleration,
    /// z
    RelativeDisplacement,
}

/// The frequencies of a spectrum.
#[derive(Clone, Debug)]
pub enum Grid {
    /// From the first to the second frequency, Hz.
    Range { ends: (Number, Number), points: usize, linear: bool },
    /// Hz
    At(Vec<Number>),
}

#[derive(Clone, Debug)]
pub struct Request {
    pub quantity: Quantity,
    /// A ratio, not negative.
    pub damping: Number,
    pub grid: Grid,
}

/// Why there is no spectrum.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Refusal {
    /// The input has no signal that moves it.
    NoSignal,
    /// A harmonic signal, or one that comes again, has no last event.
    Endless,
    /// An impulse of displacement has no finite acceleration to integrate.
    Impulse,
    /// A frequency is not above zero.
    Frequency,
    DampingNegative,
    DampingLarge,
    /// Steps of all oscillators together.
    TooLong {
        steps: f64,
    },
    /// A number is beyond the range of binary64.
    OutOfRange,
}

/// Limit on the steps of all oscillators together: some ten seconds of work.
const MOST_STEPS: f64 = 4e9;

/// Limit on damping ratios. At 1e3 maxima have at least seven digits; the steps grow with the ratio, and the candidates for a
/// maximum that are kept grow with the error.
const MOST_DAMPING: i64 = 1000;

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Refusal::NoSignal => f.write_str("it has no signal that moves it"),
            Refusal::Endless => f.write_str(
                "its signal never ends, so that there is no residual motion and no proof that a maximum is the largest: \
                 end it, as `chirp`, `half_sine` and tables do",
            ),
            Refusal::Impulse => f.write_str("an impulse of its displacement makes the relative motion infinite"),
            Refusal::Frequency => f.write_str("the frequency of an oscillator is above zero"),
            Refusal::DampingNegative => f.write_str("the damping ratio is negative"),
            Refusal::DampingLarge => write!(
                f,
                "the damping ratio is above {MOST_DAMPING}, where so many steps are needed that their errors hide the result: \
                 write one such as `5 %`"
            ),
            Refusal::TooLong { steps } => {
                write!(f, "that would take {steps:.1e} steps of oscillators; the limit is {MOST_STEPS:.0e}")
            }
            Refusal::OutOfRange => f.write_str("its numbers are outside the range of binary64"),
        }
    }
}

/// The spectrum of the signals of a base. `derivative`: 0 if they are its displacement, 1 its velocity, 2 its acceleration.
pub fn shock(signals: &[Signal], derivative: u8, request: &Request) -> Result<ShockSpectrum, Refusal> {
    if request.damping.is_negative() {
        return Err(Refusal::DampingNegative);
    }
    if (&request.damping - &Number::from(MOST_DAMPING)).is_positive() {
        return Err(Refusal::DampingLarge);
    }
    let motion = BaseMotion::of(signals, derivative)?;
    let mut frequencies = match &request.grid {
        Grid::At(list) => list.clone(),
        Grid::Range { ends: (low, _), points: 1, .. } => vec![low.clone()],
        Grid::Range { ends: (low, high), points, linear: true } => linear(low, high, *points),
        Grid::Range { ends: (low, high), points, .. } if low.is_positive() => logarithmic(low, high, *points),
        Grid::Range { .. } => return Err(Refusal::Frequency),
    };
    if !frequencies.iter().all(Number::is_positive) {
        return Err(Refusal::Frequency);
    }
    frequencies.order_by(|a, b| a.to_f64().total_cmp(&b.to_f64()));
    let damping = free::Damping::from(&request.damping);
    let omegas: Vec<Ball> = frequencies.iter().map(|f| f.to_ball() * Ball::PI * Ball::from(2.0)).collect();
    let found = sweep::sweep(&motion, damping.ratio, &omegas)?;
    let rows = frequencies.into_iter().zip(omegas).zip(found).map(|((frequency, omega), found)| {
        let residual = free::residual(&found.state, motion.last, damping, omega);
        let shown = |sides: Sides| match request.quantity {
            // Both are of omega times the lag of the mass.
            Quantity::PseudoAcceleration => sides.map(|x| x * omega),
            Quantity::RelativeDisplacement => sides.map(|x| x / omega).exchange(),
        };
        ShockRow { frequency, primary: shown(found.primary), residual: shown(residual) }
    });
    let spectrum = ShockSpectrum {
        quantity: request.quantity,
        damping: request.damping.clone(),
        end: motion.end.clone(),
        rows: rows.collect(),
    };
    let is_known = |row: &ShockRow| row.maximax().is_finite();
    if spectrum.rows.iter().all(is_known) { Ok(spectrum) } else { Err(Refusal::OutOfRange) }
}

/// A ball that holds the larger of two numbers.
fn larger(a: Ball, b: Ball) -> Ball {
    let difference = a - b;
    if !difference.contains_zero() {
        return if difference.mid.hi > 0.0 { a } else { b };
    }
    // Between the larger midpoint less its radius and the larger upper end.
    let (one, other) = if difference.mid.hi >= 0.0 { (a, b) } else { (b, a) };
    one.widen(other.rad)
}
