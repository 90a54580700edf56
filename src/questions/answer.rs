//! Answers to the lines `solve` and `require`: plain data for reports.

use super::cover::Proof;
pub use super::followed::{Critical, Curve, Followed, Grows, Locus, Meeting, MeetingKind, Onset, Onsets, Orders};
pub use super::ranges::{
    Proved, Range, RangeProof, Robust, Throughout, Tolerated, ToleratedParameter, WorstCase, outer, outer_text,
};
use crate::base::{Ball, Bound, Number, Span, Unproven};
use crate::model::scene::Written;
use std::borrow::Cow;

/// A parameter that was solved for.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Solved {
    /// `k`, `m[3]`
    pub parameter: String,
    /// The parameter's name in the line.
    pub span: Span,
    /// In SI units. The rest of the report is about the model with exactly this number.
    pub value: Number,
    /// The unit in which it is shown.
    pub unit: Written,
    /// Bound of |value - root|, SI; `None` if none is proven.
    pub bound: Option<f64>,
    /// Whether other values in the range are excluded.
    pub others: Others,
    /// The measure as written.
    pub measure: String,
    /// The target value of the measure, and the unit in which it is shown.
    pub target: Number,
    pub target_unit: Written,
    /// Whether measure and target are frequencies written in rad/s.
    pub in_radians: bool,
    /// The measure minus its target, at this value.
    pub residual: Ball,
    /// Derivative of the measure with respect to the parameter, SI; `None` if the measure has none.
    pub slope: Option<Derivative>,
    /// Number of values of the range at which the measure was evaluated.
    pub evaluations: usize,
    /// Simulated time, s, if the measure needs one.
    pub until: Option<Number>,
}

/// Whether the range contains other values that meet the condition.
#[derive(Clone, Debug)]
pub enum Others {
    /// There is no other value, and that is proven.
    None(Proof),
    /// There is no other value outside these parts, which were not settled; their ends as text.
    Unsettled(Vec<(String, String)>),
    /// No other was found among the values that were tried.
    Unknown,
}

/// The optimum of a line `minimise` or `maximise`.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Optimised {
    pub highest: bool,
    /// The whole line.
    pub span: Span,
    /// The measure as written.
    pub measure: String,
    /// The measure's value at the parameters below. The rest of the report is about the model with exactly these.
    pub value: Ball,
    pub unit: Written,
    pub parameters: Vec<OptimisedParameter>,
    pub best: Best,
    /// Frequencies of the peaks that are equal there, Hz; empty for other measures.
    pub equal: Vec<f64>,
    /// Number of sets of values at which the measure was evaluated.
    pub evaluations: usize,
    /// Simulated time, s, if the measure needs one.
    pub until: Option<Number>,
    /// With `--robust`: the worst case within the tolerances, which the values make best. `best` is about it.
    pub robust: Option<Robust>,
}

/// A parameter of an optimum.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct OptimisedParameter {
    pub parameter: String,
    /// The parameter's name in the line.
    pub span: Span,
    /// In SI units.
    pub value: Number,
    pub unit: Written,
    /// Bound of the distance to any value that is equally good, SI; `None` if none is proven.
    pub bound: Option<f64>,
}

/// The evidence that a value is an optimum.
#[derive(Clone, Debug)]
pub enum Best {
    /// No values in the ranges are better by more than `gap`, SI.
    Everywhere { gap: Bound, proof: Everywhere },
    /// No values in these parts of the ranges are better by more than `gap`; others are not excluded.
    Near { gap: Bound, parts: Vec<(String, String)> },
    /// The best of the values that were tried.
    Seen,
}

/// Made only from the proofs of the searches over all ranges.
#[derive(Clone, Copy, Debug)]
pub struct Everywhere(());

impl From<Proof> for Everywhere {
    fn from(_: Proof) -> Everywhere {
        Everywhere(())
    }
}

impl From<Proved> for Everywhere {
    fn from(_: Proved) -> Everywhere {
        Everywhere(())
    }
}

impl From<crate::analysis::range::least::Everywhere> for Everywhere {
    fn from(_: crate::analysis::range::least::Everywhere) -> Everywhere {
        Everywhere(())
    }
}

impl Optimised {
    /// The value of the measure in its unit.
    pub fn in_unit(&self) -> Shown<'_> {
        shown_in(&Number::Ball(self.value), &self.unit, false)
    }
}

impl OptimisedParameter {
    /// The value in the parameter's own unit.
    pub fn in_unit(&self) -> Shown<'_> {
        shown_in(&self.value, &self.unit, false)
    }

    /// The bound in the parameter's own unit.
    pub fn shown_bound(&self) -> Option<Bound> {
        Some(self.unit.bound(Bound::by_proof(self.bound?)))
    }
}

/// A derivative.
#[derive(Clone, Copy, Debug)]
pub enum Derivative {
    Enclosed(Ball),
    /// Computed by differences; accurate if the measure is smooth.
    Estimated(Unproven),
}

/// A requirement and whether it holds.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Requirement {
    /// The requirement as written, with the place and the repetitions that it is in.
    pub text: String,
    /// These alone: `in front, i = 2`; empty outside of them.
    pub within: String,
    pub span: Span,
    /// `None` if the bound cannot decide, or if the measure has no value.
    pub holds: Option<bool>,
    pub value: Value,
    /// The limit; `None` for `stable`.
    pub limit: Option<Number>,
    /// Distance from the limit, relative to it (absolute if the limit is 0): positive if the requirement holds.
    pub margin: Option<Ball>,
    /// The unit in which value and limit are shown.
    pub unit: Written,
    /// Whether value and limit are frequencies written in rad/s.
    pub in_radians: bool,
    /// Simulated time, s, if the measure needs one.
    pub until: Option<Number>,
    /// Whether nothing that drives the scene reaches what is measured, so that it is zero.
    pub is_still: bool,
    /// The frequencies, Hz, whose amplitudes the measure adds, if there are several.
    pub added: Vec<Number>,
}

/// The derivatives of frequencies and damping ratios with respect to a parameter.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Sensitivity {
    pub parameter: String,
    /// SI
    pub value: Number,
    pub unit: Written,
    /// Number of the first mode below.
    pub first: usize,
    /// Derivatives of the undamped frequencies, Hz; `None` for a mode that does not oscillate.
    pub frequencies: Vec<Option<Slope>>,
    /// Derivatives of the damping ratios of the damped motions, as `damping(i)` counts them; empty if nothing damps.
    pub ratios: Vec<Option<Slope>>,
}

/// A derivative with respect to a parameter.
#[derive(Clone, Debug)]
pub enum Slope {
    Smooth {
        /// df/dp in SI.
        absolute: Derivative,
        /// (p/f) df/dp
        relative: Derivative,
    },
    /// Equal values that separate on both sides; the derivatives of the branches in SI, without a bound, as far as they
    /// are known.
    Splits(Vec<Unproven>),
    /// The system is too large to compute its poles twice more for each parameter.
    NotComputed,
    /// The model has no meaning on both sides, as with a number of parts.
    Undefined,
}

/// The value of a measure.
#[derive(Clone, Debug)]
pub enum Value {
    Number(Ball),
    Infinite,
    /// A word, such as `stable`.
    Verdict(String),
    /// The reason why there is no number.
    None(String),
}

/// A number in the unit that it is shown in.
#[derive(Clone, Debug)]
pub struct Shown<'a> {
    pub number: Ball,
    /// The number itself if it is exact.
    pub exact: Option<Number>,
    /// Empty for a plain number.
    pub unit: &'a str,
}

impl Solved {
    /// The value in the parameter's own unit.
    pub fn in_unit(&self) -> Shown<'_> {
        shown_in(&self.value, &self.unit, false)
    }

    /// The bound in the parameter's own unit.
    pub fn shown_bound(&self) -> Option<Bound> {
        Some(self.unit.bound(Bound::by_proof(self.bound?)))
    }

    /// The target of the measure, as it was written.
    pub fn shown_target(&self) -> Shown<'_> {
        shown_in(&self.target, &self.target_unit, self.in_radians)
    }

    /// (p / f) df/dp: the relative change of the measure for a relative change of the parameter.
    pub fn relative_slope(&self) -> Option<Derivative> {
        let factor = self.value.to_ball() / self.target.to_ball();
        match self.slope? {
            Derivative::Enclosed(slope) => Some(Derivative::Enclosed(slope * factor)),
            Derivative::Estimated(Unproven(slope)) => Some(Derivative::Estimated(Unproven(slope * factor.to_f64()))),
        }
        .filter(Derivative::is_finite)
    }
}

impl Derivative {
    pub fn is_finite(&self) -> bool {
        match self {
            Derivative::Enclosed(ball) => ball.is_finite(),
            Derivative::Estimated(Unproven(x)) => x.is_finite(),
        }
    }

    /// The nearest binary64 number, with or without a bound.
    pub fn to_f64(&self) -> f64 {
        match self {
            Derivative::Enclosed(ball) => ball.to_f64(),
            Derivative::Estimated(Unproven(x)) => *x,
        }
    }

    pub fn scale(&self, by: Ball) -> Derivative {
        match self {
            Derivative::Enclosed(ball) => Derivative::Enclosed(*ball * by),
            Derivative::Estimated(Unproven(x)) => Derivative::Estimated(Unproven(*x * by.to_f64())),
        }
    }
}

impl Sensitivity {
    /// The value in the parameter's own unit.
    pub fn in_unit(&self) -> Shown<'_> {
        shown_in(&self.value, &self.unit, false)
    }
}

impl Requirement {
    pub fn shown_value(&self) -> Option<Shown<'_>> {
        match &self.value {
            Value::Number(ball) if self.limit.is_some() => {
                Some(shown_in(&Number::Ball(*ball), &self.unit, self.in_radians))
            }
            _ => None,
        }
    }

    pub fn shown_limit(&self) -> Option<Shown<'_>> {
        self.limit.as_ref().map(|limit| shown_in(limit, &self.unit, self.in_radians))
    }

    /// The value of the measure as text.
    pub fn value_text(&self) -> Cow<'_, str> {
        match (&self.value, self.shown_value()) {
            (_, Some(shown)) => Cow::Owned(shown_text(&shown)),
            (Value::Verdict(text) | Value::None(text), _) => Cow::Borrowed(text),
            (Value::Infinite, _) => Cow::Borrowed("infinite"),
            (Value::Number(ball), None) => Cow::Owned(few_digits(ball.to_f64())),
        }
    }
}

/// A number (a frequency in Hz) in the unit that was written; a level if that was decibels.
pub fn shown_in<'a>(si: &Number, unit: &'a Written, in_radians: bool) -> Shown<'a> {
    let turned = if in_radians { si * &(&Number::pi() * &Number::from(2)) } else { si.clone() };
    let number = match &unit.factor {
        Some(factor) => &turned / factor,
        None => turned.abs().to_decibel().unwrap_or(Number::Ball(Ball::ZERO.widen(f64::INFINITY))),
    };
    let exact = number.exact().map(|_| number.clone());
    Shown { number: number.to_ball(), exact, unit: &unit.text }
}

/// A number and its unit, to be used in a sentence.
pub fn shown_text(shown: &Shown) -> String {
    let number = few_digits(shown.number.to_f64());
    match shown.unit {
        "" => number,
        unit => format!("{number} {unit}"),
    }
}

/// The number with at most six digits.
pub fn few_digits(x: f64) -> String {
    let short: f64 = format!("{x:.5e}").parse().unwrap_or(x);
    let size = short.abs();
    if size != 0.0 && !(1e-4..1e7).contains(&size) { format!("{short:e}") } else { format!("{}", short + 0.0) }
}

/// A column of the table of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// `k`, `frequency 1`, `gain(F -> x, 3 Hz)`, `frequency(1) > 2 Hz`
    pub name: String,
    /// The unit of the values; empty for a plain number.
    pub unit: String,
    pub holds: Holds,
}

/// The content of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holds {
    /// The given values of a parameter.
    Parameter,
    /// Values that the model's own lines give to a parameter.
    Determined,
    Frequency,
    /// The frequency of a mode that is followed.
    Curve,
    /// Whether it is proved that a curve continues from the previous case.
    Link,
    PoleRe,
    PoleIm,
    /// The measure of a requirement.
    Required,
    /// Whether a requirement holds.
    Verdict,
    /// A measure that was asked for from outside.
    Measure,
}

/// An entry of the table of a study, in the unit of its column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Entry {
    Enclosed(Ball),
    Infinite,
    /// A number without a bound.
    Unproven(Unproven),
    /// Whether a requirement certainly holds or certainly fails.
    Verdict(bool),
    /// There is no such number, or it is not known; with the reason, if this case has a reason of its own.
    None(Option<&'static str>),
}

/// Replicates of a study by Sobol's sequence, each with its own scrambling, so that the spread of their means shows
/// their error: case number k belongs to replicate k mod 16.
pub const REPLICATES: u64 = 16;

/// A row of the table of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Counted from 0.
    pub number: u64,
    /// In the order of the columns.
    pub entries: Vec<Entry>,
    /// The code of the error that left entries without a value, or of a warning about them.
    pub code: Option<&'static str>,
}
