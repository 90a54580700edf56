//! Signals of time that drive inputs, as plain data in SI: what a model declares, without its words.
//! See docs/method/response.md.

use crate::base::Number;

/// A signal of time; SI, angles in radians, frequencies in Hz.
#[derive(Clone, Debug, PartialEq)]
pub enum Signal {
    Step {
        value: Number,
        at: Number,
    },
    /// `value` is the time integral.
    Impulse {
        value: Number,
        at: Number,
    },
    /// From 0 at `from` to `value` at `to`, which it keeps.
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
    /// Times ascending and values, kept before the first and after the last; between them a line or a natural cubic spline.
    Table {
        times: Vec<Number>,
        values: Vec<Number>,
        spline: bool,
    },
}
