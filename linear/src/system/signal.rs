//! Functions of time that drive inputs, as plain data in SI units, independent of how the model writes them. See
//! docs/method/response.md.

use super::spline;
use crate::base::{Ball, Number, Rational};

/// A function of time; SI units, angles in radians, frequencies in Hz. Zero before t = 0: only tables may have earlier times,
/// all others are made by [`Signal::from_zero`].
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
    /// After this time the rows come again, and have come before: there is no first and no last one. It is not shorter than
    /// the table; where it is longer, the course leads on to the first row of the next period.
    pub period: Option<Number>,
}

/// The values of a table between its rows and after the last one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Course {
    /// A line; the last value is kept.
    Lines,
    /// A natural cubic spline, or a closed one where the rows come again; the last value is kept.
    Spline,
    /// A line; zero after the last row.
    LinesToZero,
}

impl Table {
    /// The time from each row to the next one; that from the last row to the first one of the next period comes last, if it is
    /// not zero.
    pub fn steps(&self) -> Vec<Number> {
        let mut steps: Vec<Number> = self.times.windows(2).map(|pair| &pair[1] - &pair[0]).collect();
        if let (Some(period), Some(first), Some(last)) = (&self.period, self.times.first(), self.times.last()) {
            let rest = period - &(last - first);
            steps.extend((!rest.is_zero()).then_some(rest));
        }
        steps
    }

    /// Second derivatives at the rows of a spline.
    pub fn bends(&self) -> Vec<Number> {
        match self.period {
            None => spline::natural(&self.times, &self.values),
            Some(_) => {
                let steps = self.steps();
                let mut bends = spline::closed_derivatives(&steps, &self.values[..steps.len()]);
                // Where the last row is the first one of the next period.
                bends.extend((bends.len() < self.values.len()).then(|| bends[0].clone()));
                bends
            }
        }
    }

    /// The mean of a table that comes again, over a period.
    pub fn mean(&self) -> Option<Number> {
        let period = self.period.as_ref()?;
        let bends = if self.course == Course::Spline { self.bends() } else { Vec::new() };
        let (half, part) = (Number::from(Rational::new(1, 2)), Number::from(Rational::new(1, 24)));
        let next = |list: &[Number], i: usize| list[if i + 1 < list.len() { i + 1 } else { 0 }].clone();
        let area = self.steps().iter().enumerate().fold(Number::ZERO, |sum, (i, h)| {
            let mut mean = &(&self.values[i] + &next(&self.values, i)) * &half;
            if !bends.is_empty() {
                let bend = &bends[i] + &next(&bends, i);
                mean = &mean - &(&(&h.square() * &bend) * &part);
            }
            &sum + &(h * &mean)
        });
        area.checked_div(period)
    }

    /// The ends of a table that is zero after its last row, of its integral and of that one's integral: its area A and A t less
    /// its first moment.
    fn integrals(&self) -> Option<[[Number; 3]; 3]> {
        if self.course != Course::LinesToZero || self.period.is_some() {
            return None;
        }
        let sixth = Number::from(Rational::new(1, 6));
        let (mut area, mut moment) = (Number::ZERO, Number::ZERO);
        // The first value holds from t = 0 on.
        let first = self.times.first().zip(self.values.first()).map(|(time, value)| (Number::ZERO, value, time, value));
        let rows = self.times.windows(2).zip(self.values.windows(2));
        let pieces = rows.map(|(t, v)| (t[0].clone(), &v[0], &t[1], &v[1]));
        for (from, left, to, right) in first.into_iter().chain(pieces) {
            let width = to - &from;
            let sum = left + right;
            area = &area + &(&(&width * &sum) * &(&sixth * &Number::from(3)));
            // from (left + right) / 2 + width (left + 2 right) / 6, times the width
            let mean = &(&(&from * &sum) * &Number::from(3)) + &(&width * &(&sum + right));
            moment = &moment + &(&(&width * &mean) * &sixth);
        }
        let twice = [-&moment, area.clone(), Number::ZERO];
        Some([constant(Number::ZERO), constant(area), twice])
    }
}

fn constant(value: Number) -> [Number; 3] {
    [value, Number::ZERO, Number::ZERO]
}

fn sum(a: &[Number; 3], b: &[Number; 3]) -> [Number; 3] {
    std::array::from_fn(|k| &a[k] + &b[k])
}

/// c(t - by)
fn delay_polynomial([c0, c1, c2]: &[Number; 3], by: &Number) -> [Number; 3] {
    let half = &by.square() * &Number::from(Rational::new(1, 2));
    [&(c0 - &(c1 * by)) + &(c2 * &half), c1 - &(c2 * by), c2.clone()]
}

/// 1, t - at, (t - at)^2 / 2, times a value.
fn integrals_of_step(value: &Number, at: &Number) -> [[Number; 3]; 3] {
    let zero = || Number::ZERO;
    let powers = [[value.clone(), zero(), zero()], [zero(), value.clone(), zero()], [zero(), zero(), value.clone()]];
    powers.map(|course| delay_polynomial(&course, at))
}

impl Signal {
    /// The signal from t = 0 on as a sum of signals none of whose times is negative; empty if it is over by then. A table
    /// is left as it is.
    pub fn from_zero(self) -> Vec<Signal> {
        let zero = || Number::ZERO;
        let is_over = |end: &Number| end.is_negative() || end.is_zero();
        match self {
            Signal::Step { value, at } if at.is_negative() => vec![Signal::Step { value, at: zero() }],
            Signal::Impulse { at, .. } if at.is_negative() => Vec::new(),
            // It acts or not, by the sign of a time that is not known.
            Signal::Impulse { value, at } if !at.is_positive() && !at.is_zero() => {
                let part = Number::Ball(Ball::from(0.5).widen(0.5));
                vec![Signal::Impulse { value: &value * &part, at }]
            }
            Signal::Pulse { to, .. } if is_over(&to) => Vec::new(),
            Signal::Pulse { value, from, to } if from.is_negative() => vec![Signal::Pulse { value, from: zero(), to }],
            Signal::Ramp { value, to, .. } if is_over(&to) => vec![Signal::Step { value, at: zero() }],
            Signal::Ramp { value, from, to } if from.is_negative() => {
                let risen = &value * &(&-&from / &(&to - &from));
                let rest = &value - &risen;
                vec![Signal::Step { value: risen, at: zero() }, Signal::Ramp { value: rest, from: zero(), to }]
            }
            Signal::Chirp { value, from, to, duration, at, phase } if at.is_negative() => {
                let left = &at + &duration;
                if is_over(&left) {
                    return Vec::new();
                }
                let gone = -&at;
                let now = &from + &(&(&(&to - &from) * &gone) / &duration);
                // The mean of the two frequencies times 2 pi.
                let turned = &(&Number::pi() * &gone) * &(&from + &now);
                let phase = &phase + &turned;
                vec![Signal::Chirp { value, from: now, to, duration: left, at: zero(), phase }]
            }
            signal => vec![signal],
        }
    }

    /// The constant value that remains in the end, about which a table that comes again swings; zero for a harmonic. `None`
    /// for an integral, which may grow without limit: see [`Signal::in_the_end`].
    pub fn final_value(&self) -> Option<Number> {
        match self {
            Signal::Step { value, .. } | Signal::Ramp { value, .. } => Some(value.clone()),
            Signal::Table(table @ Table { period: Some(_), .. }) => table.mean(),
            Signal::Table(Table { values, course: Course::Lines | Course::Spline, .. }) => values.last().cloned(),
            Signal::Delayed { of, .. } => of.final_value(),
            Signal::Integral { .. } => None,
            _ => Some(Number::ZERO),
        }
    }

    /// The polynomial c0 + c1 t + c2 t^2 / 2 about which the signal oscillates in the end. `None` under the integral of
    /// a chirp, whose end is no quotient of its numbers.
    pub fn in_the_end(&self) -> Option<[Number; 3]> {
        match self {
            Signal::Integral { of, times } => {
                let [at_once, once, twice] = of.integrals()?;
                match times {
                    0 => Some(at_once),
                    1 => Some(once),
                    _ => Some(twice),
                }
            }
            Signal::Delayed { of, by } => of.in_the_end().map(|course| delay_polynomial(&course, by)),
            signal => signal.final_value().map(constant),
        }
    }

    /// The ends of a signal, of its integral and of that one's integral.
    fn integrals(&self) -> Option<[[Number; 3]; 3]> {
        let half = Number::from(Rational::new(1, 2));
        match self {
            Signal::Step { value, at } => Some(integrals_of_step(value, at)),
            Signal::Pulse { value, from, to } => {
                let (on, off) = (integrals_of_step(value, from), integrals_of_step(&-value, to));
                Some([sum(&on[0], &off[0]), sum(&on[1], &off[1]), sum(&on[2], &off[2])])
            }
            Signal::Ramp { value, from, to } => {
                let (width, middle) = (to - from, &(from + to) * &half);
                // Its integral is that of a step in the middle; the next one is larger by value width^2 / 24.
                let [at_once, once, mut twice] = integrals_of_step(value, &middle);
                twice[0] = &twice[0] + &(&(value * &width.square()) * &Number::from(Rational::new(1, 24)));
                Some([at_once, once, twice])
            }
            Signal::Table(table) => table.integrals(),
            Signal::Delayed { of, by } => of.integrals().map(|ends| ends.map(|course| delay_polynomial(&course, by))),
            _ => None,
        }
    }

    /// Whether the signal is a table that comes again: it never ends, and is no harmonic.
    pub fn comes_again(&self) -> bool {
        match self {
            Signal::Table(table) => table.period.is_some() && self.is_felt(),
            Signal::Integral { of, .. } | Signal::Delayed { of, .. } => of.comes_again(),
            _ => false,
        }
    }

    /// The signal with the opposite sign.
    pub fn negate(&self) -> Signal {
        let mut signal = self.clone();
        match &mut signal {
            Signal::Step { value, .. }
            | Signal::Impulse { value, .. }
            | Signal::Ramp { value, .. }
            | Signal::Pulse { value, .. }
            | Signal::Harmonic { value, .. }
            | Signal::Chirp { value, .. } => *value = -&*value,
            Signal::Table(table) => table.values.iter_mut().for_each(|value| *value = -&*value),
            Signal::Integral { of, .. } | Signal::Delayed { of, .. } => **of = of.negate(),
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
