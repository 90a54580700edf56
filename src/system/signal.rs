//! Functions of time that drive inputs, as plain data in SI units, independent of how the model writes them. See
//! docs/method/response.md.

use crate::base::Number;

/// A function of time; SI units, angles in radians, frequencies in Hz. Zero before t = 0.
#[derive(Clone, Debug, PartialEq)]
pub enum Signal {
    Step {
        value: Number,
        at: Number,
    },
    /// `value` is the integral over time.
    Impulse {
        value: Number,
        at: Number,
    },
    /// Rises from 0 at `from` to `value` at `to`, and keeps that value.
    Ramp {
        value: Number,
        from: Number,
        to: Number,
    },
    Pulse {
        value: Number,
        from: Number,
        to: Number,
    },
    /// value sin(2 pi frequency t + phase) from the time `at` on, which is not negative
    Harmonic {
        value: Number,
        frequency: Number,
        phase: Number,
        at: Number,
    },
    /// value sin(2 pi (from t + (to - from) t^2 / (2 duration)) + phase) for 0 <= t <= duration, t from the time `at` on
    Chirp {
        value: Number,
        from: Number,
        to: Number,
        duration: Number,
        at: Number,
        phase: Number,
    },
    Table(Table),
    /// The repeated integral of a signal over time, starting from zero at t = 0. Integrals of harmonics and impulses
    /// are not written like this: they are other signals of this enum.
    Integral {
        of: Box<Signal>,
        times: u8,
    },
    /// A signal delayed by a time that is not negative.
    Delayed {
        of: Box<Signal>,
        by: Number,
    },
}

/// Times ascending and values; kept before the first one.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    pub times: Vec<Number>,
    pub values: Vec<Number>,
    pub course: Course,
}

/// The values of a table between its rows and after the last one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// A line; the last value is kept.
    Lines,
    /// A natural cubic spline; the last value is kept.
    Spline,
    /// A line; zero after the last row.
    LinesToZero,
}

impl Signal {
    /// The constant value that remains in the end; zero for a harmonic. `None` for an integral, which may grow without
    /// limit; where it ends is not computed.
    pub fn lasting(&self) -> Option<Number> {
        match self {
            Signal::Step { value, .. } | Signal::Ramp { value, .. } => Some(value.clone()),
            Signal::Table(Table { values, course: Course::Lines | Course::Spline, .. }) => values.last().cloned(),
            Signal::Delayed { of, .. } => of.lasting(),
            Signal::Integral { .. } => None,
            _ => Some(Number::ZERO),
        }
    }

    /// The signal with the opposite sign.
    pub fn negated(&self) -> Signal {
        let mut signal = self.clone();
        match &mut signal {
            Signal::Step { value, .. }
            | Signal::Impulse { value, .. }
            | Signal::Ramp { value, .. }
            | Signal::Pulse { value, .. }
            | Signal::Harmonic { value, .. }
            | Signal::Chirp { value, .. } => *value = -&*value,
            Signal::Table(table) => table.values.iter_mut().for_each(|value| *value = -&*value),
            Signal::Integral { of, .. } | Signal::Delayed { of, .. } => **of = of.negated(),
        }
        signal
    }

    /// Whether the signal is not zero at all times.
    pub fn is_felt(&self) -> bool {
        match self {
            Signal::Step { value, .. }
            | Signal::Impulse { value, .. }
            | Signal::Ramp { value, .. }
            | Signal::Pulse { value, .. }
            | Signal::Harmonic { value, .. }
            | Signal::Chirp { value, .. } => !value.is_zero(),
            Signal::Table(table) => table.values.iter().any(|value| !value.is_zero()),
            Signal::Integral { of, .. } | Signal::Delayed { of, .. } => of.is_felt(),
        }
    }
}
