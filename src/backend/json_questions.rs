//! Answers of `solve`, `minimise` and `require`, and sensitivities, as JSON. See docs/json.md.

use super::json_number::{Bounds, JsonNumber};
use super::tolerated::JsonRobust;
use crate::base::Unproven;
use crate::questions::answer::{
    Best, Derivative, Optimised, OptimisedParameter, Others, Requirement, Sensitivity, Slope, Solved, Value,
};
use std::borrow::Cow;

/// Value and bound in the parameter's own unit; the measure in SI units, frequencies in Hz.
#[derive(serde::Serialize)]
pub struct JsonSolved<'a> {
    parameter: &'a str,
    value: JsonNumber,
    unit: &'a str,
    error_bound: JsonNumber,
    si: JsonNumber,
    measure: &'a str,
    target: JsonNumber,
    residual: JsonNumber,
    residual_error_bound: JsonNumber,
    slope: JsonNumber,
    slope_error_bound: JsonNumber,
    relative_slope: JsonNumber,
    relative_slope_error_bound: JsonNumber,
    others: &'static str,
    unsettled: Vec<[String; 2]>,
    evaluations: usize,
    until_s: JsonNumber,
    /// The values at which every other number of the answer is evaluated.
    bounds_from: &'static str,
}

/// An optimum; the measure in SI units, frequencies in Hz.
#[derive(serde::Serialize)]
pub struct JsonOptimised<'a> {
    highest: bool,
    measure: &'a str,
    value: JsonNumber,
    error_bound: JsonNumber,
    parameters: Vec<JsonOptimisedParameter<'a>>,
    /// `everywhere`, `near` or `seen`.
    proved: &'static str,
    /// Bound of how much better the measure can be at other values.
    gap: JsonNumber,
    near: Vec<[&'a str; 2]>,
    equal_peaks_hz: Vec<JsonNumber>,
    evaluations: usize,
    until_s: JsonNumber,
    worst_case: Option<JsonRobust<'a>>,
}

/// Value and bound in the parameter's own unit.
#[derive(serde::Serialize)]
struct JsonOptimisedParameter<'a> {
    parameter: &'a str,
    value: JsonNumber,
    unit: &'a str,
    error_bound: JsonNumber,
    si: JsonNumber,
}

/// In SI units, frequencies in Hz.
#[derive(serde::Serialize)]
pub struct JsonRequirement<'a> {
    text: &'a str,
    holds: Option<bool>,
    value: JsonNumber,
    limit: JsonNumber,
    margin: JsonNumber,
    /// Absolute bound, because a margin may be 0.
    margin_error_bound: JsonNumber,
    error_bound: JsonNumber,
    value_text: Cow<'a, str>,
    until_s: JsonNumber,
}

/// Derivatives in SI units: Hz and ratios per SI unit of the parameter.
#[derive(serde::Serialize)]
pub struct JsonSensitivity<'a> {
    parameter: &'a str,
    value: JsonNumber,
    unit: &'a str,
    si: JsonNumber,
    frequencies: Vec<JsonSlope>,
    damping: Vec<JsonSlope>,
}

/// `derivative` and `relative` are `null` if there is no derivative: `kind` is then `splits`, `undefined` or `none`.
#[derive(serde::Serialize)]
struct JsonSlope {
    #[serde(skip_serializing_if = "Option::is_none")]
    mode: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    motion: Option<usize>,
    kind: &'static str,
    derivative: JsonNumber,
    error_bound: JsonNumber,
    relative: JsonNumber,
    relative_error_bound: JsonNumber,
    /// Slopes of the branches into which equal frequencies split, without a bound.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    slopes: Vec<JsonNumber>,
}

pub fn json_solved(solved: &Solved, bounds: Bounds) -> JsonSolved<'_> {
    let (shown, relative_slope) = (solved.in_unit(), solved.relative_slope());
    JsonSolved {
        parameter: &solved.parameter,
        value: JsonNumber::from_enclosure(shown.number),
        unit: shown.unit,
        error_bound: (solved.shown_bound())
            .map_or(JsonNumber::NULL, |bound| bounds.relative(shown.number.widen(bound.value()))),
        si: JsonNumber::number(&solved.value),
        measure: &solved.measure,
        target: JsonNumber::number(&solved.target),
        residual: JsonNumber::from_enclosure(solved.residual),
        residual_error_bound: bounds.absolute(solved.residual),
        slope: solved.slope.as_ref().map_or(JsonNumber::NULL, derivative),
        slope_error_bound: solved.slope.as_ref().map_or(JsonNumber::NULL, |slope| derivative_bound(slope, bounds)),
        relative_slope: relative_slope.as_ref().map_or(JsonNumber::NULL, derivative),
        relative_slope_error_bound: (relative_slope.as_ref())
            .map_or(JsonNumber::NULL, |slope| derivative_bound(slope, bounds)),
        others: match solved.others {
            Others::None(_) => "none",
            Others::Unsettled(_) => "unsettled",
            Others::Unknown => "unknown",
        },
        unsettled: match &solved.others {
            Others::Unsettled(parts) => parts.iter().map(|(low, high)| [low.clone(), high.clone()]).collect(),
            Others::None(_) | Others::Unknown => Vec::new(),
        },
        evaluations: solved.evaluations,
        bounds_from: if solved.bound == Some(0.0) { "root" } else { "value" },
        until_s: solved.until.as_ref().map_or(JsonNumber::NULL, JsonNumber::number),
    }
}

pub fn json_optimised(found: &Optimised, bounds: Bounds) -> JsonOptimised<'_> {
    let parameter = |found: &'_ OptimisedParameter| -> (JsonNumber, JsonNumber) {
        let number = found.in_unit().number;
        let bound = found.shown_bound();
        (
            JsonNumber::from_enclosure(number),
            bound.map_or(JsonNumber::NULL, |bound| bounds.relative(number.widen(bound.value()))),
        )
    };
    let (proved, gap) = match &found.best {
        Best::Everywhere { gap, .. } => ("everywhere", Some(*gap)),
        Best::Near { gap, .. } => ("near", Some(*gap)),
        Best::Seen => ("seen", None),
    };
    JsonOptimised {
        highest: found.highest,
        measure: &found.measure,
        value: JsonNumber::from_enclosure(found.value),
        error_bound: bounds.relative(found.value),
        parameters: (found.parameters.iter())
            .map(|own| {
                let (value, error_bound) = parameter(own);
                let (unit, si) = (own.unit.text.as_str(), JsonNumber::number(&own.value));
                JsonOptimisedParameter { parameter: &own.parameter, value, unit, error_bound, si }
            })
            .collect(),
        proved,
        gap: gap.map_or(JsonNumber::NULL, |gap| bounds.of(gap)),
        near: match &found.best {
            Best::Near { parts, .. } => parts.iter().map(|(low, high)| [low.as_str(), high.as_str()]).collect(),
            Best::Everywhere { .. } | Best::Seen => Vec::new(),
        },
        equal_peaks_hz: found.equal.iter().map(|hertz| JsonNumber::unproven(Unproven(*hertz))).collect(),
        evaluations: found.evaluations,
        until_s: found.until.as_ref().map_or(JsonNumber::NULL, JsonNumber::number),
        worst_case: found.robust.as_ref().map(|robust| JsonRobust::of(robust, found)),
    }
}

pub fn json_requirement(requirement: &Requirement, bounds: Bounds) -> JsonRequirement<'_> {
    let value = match &requirement.value {
        Value::Number(ball) => Some(ball),
        _ => None,
    };
    JsonRequirement {
        text: &requirement.text,
        holds: requirement.holds,
        value: value.map_or(JsonNumber::NULL, |ball| JsonNumber::from_enclosure(*ball)),
        limit: requirement.limit.as_ref().map_or(JsonNumber::NULL, JsonNumber::number),
        margin: JsonNumber::of(requirement.margin),
        margin_error_bound: requirement.margin.map_or(JsonNumber::NULL, |value| bounds.absolute(value)),
        error_bound: value.map_or(JsonNumber::NULL, |ball| bounds.relative(*ball)),
        value_text: requirement.value_text(),
        until_s: requirement.until.as_ref().map_or(JsonNumber::NULL, JsonNumber::number),
    }
}

pub fn json_sensitivity(sensitivity: &Sensitivity, bounds: Bounds) -> JsonSensitivity<'_> {
    let shown = sensitivity.in_unit();
    let slopes = |list: &[Option<Slope>], number: fn(usize, usize) -> (Option<usize>, Option<usize>)| {
        let numbered =
            list.iter().enumerate().map(|(i, slope)| json_slope(slope, number(sensitivity.first, i), bounds));
        numbered.collect()
    };
    JsonSensitivity {
        parameter: &sensitivity.parameter,
        value: JsonNumber::from_enclosure(shown.number),
        unit: shown.unit,
        si: JsonNumber::number(&sensitivity.value),
        frequencies: slopes(&sensitivity.frequencies, |first, i| (Some(first + i), None)),
        damping: slopes(&sensitivity.ratios, |_, i| (None, Some(i + 1))),
    }
}

fn json_slope(slope: &Option<Slope>, (mode, motion): (Option<usize>, Option<usize>), bounds: Bounds) -> JsonSlope {
    let (kind, found) = match slope {
        None => ("none", None),
        Some(Slope::Splits(_)) => ("splits", None),
        Some(Slope::NotComputed) => ("not_computed", None),
        Some(Slope::Undefined) => ("undefined", None),
        Some(Slope::Smooth { absolute, relative }) => (
            if matches!(absolute, Derivative::Enclosed(_)) { "smooth" } else { "unproven" },
            Some((absolute, relative)),
        ),
    };
    JsonSlope {
        mode,
        motion,
        kind,
        derivative: found.map_or(JsonNumber::NULL, |(absolute, _)| derivative(absolute)),
        error_bound: found.map_or(JsonNumber::NULL, |(absolute, _)| derivative_bound(absolute, bounds)),
        relative: found.map_or(JsonNumber::NULL, |(_, relative)| derivative(relative)),
        relative_error_bound: found.map_or(JsonNumber::NULL, |(_, relative)| derivative_bound(relative, bounds)),
        slopes: match slope {
            Some(Slope::Splits(slopes)) => slopes.iter().copied().map(JsonNumber::unproven).collect(),
            _ => Vec::new(),
        },
    }
}

fn derivative(derivative: &Derivative) -> JsonNumber {
    match derivative {
        Derivative::Enclosed(ball) => JsonNumber::from_enclosure(*ball),
        Derivative::Estimated(seen) => JsonNumber::unproven(*seen),
    }
}

/// `null` if the derivative has no proven bound.
fn derivative_bound(derivative: &Derivative, bounds: Bounds) -> JsonNumber {
    match derivative {
        Derivative::Enclosed(ball) => bounds.relative(*ball),
        Derivative::Estimated(_) => JsonNumber::NULL,
    }
}
