//! How an output reaches its final value, as measures: settling time and overshoot. In: the system, its poles, signals,
//! an output. Out: a ball, or the reason why there is none. See docs/method/measures.md#settling-and-overshoot.

use crate::analysis::answer::{PoleKind, Poles};
use crate::analysis::error::AnalysisError;
use crate::analysis::measures::{Loads, MOVES_BY_RATE, Measurement, lasting_value, static_value};
use crate::analysis::peak::{OPEN, last_event, round_up};
use crate::analysis::response::settle::{Approach, Found};
use crate::analysis::transfer::Transfer;
use crate::base::Number;
use crate::system::{LinearSystem, Signal};

/// The motion under the signals, as far as settling and overshoot need it.
#[derive(Clone, Copy)]
pub struct Settling<'a> {
    pub system: &'a LinearSystem,
    pub transfer: &'a Transfer<'a>,
    pub poles: &'a Poles,
    pub drives: &'a [Vec<Signal>],
}

impl Settling<'_> {
    /// The time after which the output stays within `band` of its final value, as a part of that, s from t = 0.
    pub fn time(&self, output: usize, band: &Number) -> Measurement {
        self.measure(output, |approach| match approach.settling(band) {
            Ok(Found::Infinite) => Ok(Found::Lasting),
            other => other,
        })
    }

    /// How far the output goes beyond its final value, as a part of that; zero if it does not.
    pub fn overshoot(&self, output: usize) -> Measurement {
        self.measure(output, |approach| approach.overshoot())
    }

    fn measure(&self, output: usize, of: impl FnOnce(Approach) -> Result<Found, AnalysisError>) -> Measurement {
        let until = match self.until() {
            Ok(until) => until,
            Err(why) => return Measurement::None(why),
        };
        let end = match self.end(output) {
            Measurement::Value(end) if !end.contains_zero() => end,
            Measurement::Value(_) => {
                return Measurement::None("the final value is zero, or may be: there is nothing to compare with");
            }
            other => return other,
        };
        let Settling { system, drives, .. } = *self;
        match of(Approach { system, drives, output, end, until: &until }) {
            Ok(Found::Value(value)) if value.is_finite() => Measurement::Value(value),
            Ok(Found::Infinite) => Measurement::Infinite,
            Ok(Found::Open) => Measurement::None(OPEN),
            Ok(Found::Value(_) | Found::TooLong) => {
                Measurement::None("the fastest motion has too many cycles until the slowest one has decayed")
            }
            Ok(Found::Lasting) => Measurement::None("it is not proved that the output settles"),
            Err(error) => Measurement::Failed(error.to_diagnostic().message),
        }
    }

    /// The final value of the output, which the signals bring about.
    fn end(&self, output: usize) -> Measurement {
        let last = |(input, signals): (usize, &Vec<Signal>)| Some((input, lasting_value(signals)?));
        match self.drives.iter().enumerate().map(last).collect::<Option<Loads>>() {
            Some(loads) => static_value(self.transfer, &loads, output),
            None => Measurement::None(MOVES_BY_RATE),
        }
    }

    /// A time by which everything should have decayed, or the reason why nothing settles.
    fn until(&self) -> Result<Number, &'static str> {
        let mut last: f64 = 0.0;
        for signal in self.drives.iter().flatten() {
            if has_no_end(signal) {
                return Err(GOES_ON);
            }
            last = last.max(last_event(signal));
        }
        let mut slowest = f64::INFINITY;
        for pole in &self.poles.list {
            match pole.kind {
                PoleKind::Rigid => return Err("a rigid motion has no end: nothing brings it to rest"),
                PoleKind::Divergence | PoleKind::Flutter => return Err("a free motion grows: nothing settles"),
                PoleKind::Oscillation if pole.re.is_zero() => {
                    return Err("an oscillation has no damping: it never settles");
                }
                PoleKind::Undetermined | PoleKind::Oscillation | PoleKind::Overdamped => {
                    slowest = slowest.min(-pole.re.to_f64());
                }
            }
        }
        let decay = if slowest == f64::INFINITY { 1.0 } else { TIME_CONSTANTS / slowest };
        round_up(last + decay).ok_or("it is not proved that every free motion decays")
    }
}

/// The motion has then decayed to 1e-26, also beside double poles and energies that differ a lot.
const TIME_CONSTANTS: f64 = 120.0;

/// Why nothing settles under a signal without an end.
const GOES_ON: &str = "a signal goes on forever: nothing settles";

fn has_no_end(signal: &Signal) -> bool {
    match signal {
        Signal::Harmonic { value, .. } => !value.is_zero(),
        Signal::Delayed { of, .. } | Signal::Integral { of, .. } => has_no_end(of),
        signal => signal.comes_again(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::test_systems::oscillator;
    use crate::analysis::{modes, poles};

    fn measure(c: &str, signals: Vec<Signal>, of: impl Fn(&Settling) -> Measurement) -> Measurement {
        let system = oscillator("1", c, "4");
        let modes = modes(&system).expect("modes");
        let (poles, transfer) = (poles(&system, &modes).expect("poles"), Transfer::of(&system));
        of(&Settling { system: &system, transfer: &transfer, poles: &poles, drives: &[signals] })
    }

    fn step(value: i64) -> Vec<Signal> {
        vec![Signal::Step { value: Number::from(value), at: Number::ZERO }]
    }

    /// zeta = 1/2: the first swing goes exp(-pi / sqrt(3)) beyond the end, upwards and downwards.
    #[test]
    fn an_oscillator_overshoots_by_the_closed_form() {
        let truth = (-std::f64::consts::PI / 3f64.sqrt()).exp();
        for force in [1, -7] {
            let Measurement::Value(found) = measure("2", step(force), |settling| settling.overshoot(0)) else {
                panic!("no value")
            };
            assert!((found.to_f64() - truth).abs() < 1e-16 && found.rad < 1e-22, "{found:?}");
        }
    }

    #[test]
    fn nothing_is_claimed_without_decay_or_end() {
        let none = |c: &str, signals: Vec<Signal>| measure(c, signals, |settling| settling.overshoot(0));
        assert!(matches!(none("0", step(1)), Measurement::None(why) if why.contains("no damping")));
        assert!(matches!(none("2", step(0)), Measurement::None(why) if why.contains("zero")));
        let pulse = Signal::Pulse { value: Number::ONE, from: Number::ZERO, to: Number::ONE };
        assert!(matches!(none("2", vec![pulse]), Measurement::None(why) if why.contains("zero")));
    }
}
