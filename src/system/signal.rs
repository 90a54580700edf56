//! Functions of time that drive inputs, as plain data in SI units: what a model declares, apart from its wording.
//! See docs/method/response.md.

use crate::base::Number;

/// A function of time; SI units, angles in radians, frequencies in Hz.
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
    /// value sin(2 pi frequency t + phase) from t = 0 on
    Harmonic {
        value: Number,
        frequency: Number,
        phase: Number,
    },
    /// value sin(2 pi (from t + (to - from) t^2 / (2 duration))) for 0 <= t <= duration
    Chirp {
        value: Number,
        from: Number,
        to: Number,
        duration: Number,
    },
    /// Values at ascending times, constant before the first and after the last; in between straight lines or a natural
    /// cubic spline.
    Table {
        times: Vec<Number>,
        values: Vec<Number>,
        spline: bool,
    },
}
