//! The lines `require`: the value of each measure, whether it certainly keeps its limit, and the parameter that changes
//! it most. In: measured numbers. Out: for each requirement whether it holds, and a finding for each that does not. See
//! docs/method/measures.md.

use super::advice::Advice;
use super::answer::{Requirement, Value, few_digits, shown_in, shown_text};
use super::error::{AskedError, Remedy};
use super::trial::{Facts, Text};
use crate::analysis::Measurement;
use crate::base::{Ball, Diagnostics, Number};
use crate::dynamics;
use crate::model::scene::{Comparison, Measure, Parameter, Question, Require};
use crate::model::{CheckedScene, Setting};
use crate::system::Signal;
use std::cmp::Ordering;

/// A value beyond this multiple of its limit is compared with it by a factor.
const MANY_TIMES: f64 = 10.0;
/// The verdict on a rest at which nothing grows, but some motion does not return.
const NEUTRAL: &str = "neutral";

/// Every requirement of a scene.
pub fn requirements(
    text: &Text,
    scene: &CheckedScene,
    settings: &[Setting],
    known: Facts,
) -> (Vec<Requirement>, Vec<AskedError>) {
    let requires = &scene.scene().requires;
    let list = judge(text, scene, known);
    // Parameters that are solved for cannot be changed.
    let solved = |parameter: &Parameter| scene.scene().determined_names().any(|name| name == parameter.name);
    let fails = list.iter().any(|requirement| requirement.holds == Some(false));
    let mut parameters = if fails { text.parameters(settings) } else { Vec::new() };
    parameters.retain(|parameter| !solved(parameter));
    let findings = list.iter().zip(requires).enumerate().filter_map(|(index, (requirement, require))| {
        let advice = Advice { text, settings, parameters: &parameters, index, require };
        finding(requirement, || match parameters[..] {
            [] => Remedy::NoParameter,
            _ => advice.remedy(requirement).map_or(Remedy::NotFound, Remedy::Change),
        })
    });
    let findings = findings.collect();
    (list, findings)
}

/// The value of each requirement of a scene, and whether it holds.
pub fn judge(text: &Text, scene: &CheckedScene, known: Facts) -> Vec<Requirement> {
    let requires = &scene.scene().requires;
    let questions: Vec<Question> = requires.iter().map(|require| require.question.clone()).collect();
    let measured = text.measure_driven(scene, &questions, known).unwrap_or_else(|why| {
        // All of them fail for the same reason.
        questions.iter().map(|_| (Measurement::Failed(why.clone()), false)).collect()
    });
    let each = requires.iter().zip(measured);
    each.map(|(require, (measured, is_still))| Requirement {
        is_still,
        ..requirement(text, scene, known, require, measured)
    })
    .collect()
}

/// One line alone.
pub fn judged_alone(text: &Text, scene: &CheckedScene, known: Facts, require: &Require) -> Option<Requirement> {
    let measured = text.measure_scene(scene, std::slice::from_ref(&require.question), known);
    let measured = measured.map_or_else(|why| Some(Measurement::Failed(why)), |mut list| list.pop())?;
    Some(requirement(text, scene, known, require, measured))
}

fn requirement(
    text: &Text,
    scene: &CheckedScene,
    known: Facts,
    require: &Require,
    measured: Measurement,
) -> Requirement {
    let question = &require.question;
    let mut holds = holds_for(&measured, require.comparison, &question.value);
    let mut margin = match (&measured, require.comparison) {
        (Measurement::Value(value), Some(comparison)) => Some(margin(value, comparison, &question.value)),
        _ => None,
    };
    let mut measured = measured;
    if let (None, Some(_), Some(comparison)) = (holds, &margin, require.comparison) {
        let order = text.compare(scene, question, known);
        holds = order.map(|order| keeps(order, comparison));
        if order == Some(Ordering::Equal) {
            (measured, margin) = (Measurement::Value(question.value.to_ball()), Some(Ball::ZERO));
        }
    }
    let value = match measured {
        Measurement::Value(value) if matches!(question.measure, Measure::Stable) => {
            let verdict = match value.is_exact() {
                true if value == Ball::ONE => "stable",
                true if value.is_zero() => NEUTRAL,
                true => "not stable",
                false => "undetermined",
            };
            Value::Verdict(verdict.to_string())
        }
        Measurement::Value(value) => Value::Number(value),
        Measurement::Infinite => Value::Infinite,
        Measurement::None(why) => Value::None(why.to_string()),
        Measurement::Failed(why) => Value::None(why),
    };
    Requirement {
        text: question.name(text.sources.slice(require.span)),
        within: question.within.clone(),
        span: require.span,
        holds,
        value,
        limit: require.comparison.map(|_| question.value.clone()),
        margin,
        unit: question.unit.clone(),
        in_radians: question.radians.is_some(),
        until: text.simulated_time(&question.measure),
        is_still: false,
        added: added_frequencies(scene, &question.measure),
    }
}

/// The frequencies of the harmonic signals, if a measure adds the amplitudes of several.
fn added_frequencies(scene: &CheckedScene, measure: &Measure) -> Vec<Number> {
    if !measure.is_of_amplitude() {
        return Vec::new();
    }
    let drives = dynamics::drives(scene, &mut Diagnostics::new()).unwrap_or_default();
    let mut list: Vec<Number> = Vec::new();
    for mut signal in drives.iter().flatten() {
        while let Signal::Delayed { of, .. } = signal {
            signal = of;
        }
        if let Signal::Harmonic { frequency, .. } = signal
            && !list.contains(frequency)
        {
            list.push(frequency.clone());
        }
    }
    if list.len() > 1 { list } else { Vec::new() }
}

/// Whether a measured number keeps its limit; `None` if that is not certain.
pub fn holds_for(measured: &Measurement, comparison: Option<Comparison>, limit: &Number) -> Option<bool> {
    match (measured, comparison) {
        (Measurement::Value(value), None) => value.is_exact().then(|| *value == Ball::ONE),
        (Measurement::Value(value), Some(comparison)) => holds(value, comparison, limit),
        (Measurement::Infinite, Some(Comparison::Greater | Comparison::GreaterEqual)) => Some(true),
        (Measurement::Infinite, Some(_)) => Some(false),
        _ => None,
    }
}

/// Whether the comparison holds; `None` if that is not certain.
pub(super) fn holds(value: &Ball, comparison: Comparison, limit: &Number) -> Option<bool> {
    let value = if value.is_zero() { Number::ZERO } else { Number::Ball(*value) };
    value.compare(limit).map(|order| keeps(order, comparison))
}

fn keeps(order: Ordering, comparison: Comparison) -> bool {
    match comparison {
        Comparison::Less => order.is_lt(),
        Comparison::LessEqual => order.is_le(),
        Comparison::Greater => order.is_gt(),
        Comparison::GreaterEqual => order.is_ge(),
    }
}

/// (value - limit) / |limit|, or its negative, so that it is positive on the required side; the difference itself for a
/// limit of 0.
pub(super) fn margin(value: &Ball, comparison: Comparison, limit: &Number) -> Ball {
    let difference = *value - limit.to_ball();
    let relative = if limit.may_be_zero() { difference } else { difference / limit.to_ball().abs() };
    match comparison {
        Comparison::Less | Comparison::LessEqual => -relative,
        Comparison::Greater | Comparison::GreaterEqual => relative,
    }
}

fn finding(requirement: &Requirement, remedy: impl FnOnce() -> Remedy) -> Option<AskedError> {
    let span = requirement.span;
    let value = requirement.value_text().into_owned();
    match (requirement.holds, &requirement.value) {
        (Some(true), _) => requirement.is_still.then_some(AskedError::Still { span }),
        (Some(false), _) => {
            let by = match (&requirement.margin, requirement.limit.as_ref().filter(|limit| !limit.may_be_zero())) {
                (Some(margin), _) if margin.is_zero() => Some("exactly its limit".to_string()),
                (Some(margin), Some(limit)) => Some(relative(-margin.to_f64(), limit)),
                (Some(_), None) | (None, _) => missed_by(requirement),
            };
            let within = Some(requirement.within.clone()).filter(|within| !within.is_empty());
            let by = by.into_iter().chain(within).reduce(|by, within| format!("{by}, {within}"));
            Some(AskedError::Fails { span, value, by, remedy: remedy() })
        }
        (None, Value::Number(ball)) => {
            let limit = requirement.shown_limit().map_or(String::new(), |limit| shown_text(&limit));
            Some(AskedError::Undetermined { span, value, limit, bound: format!("{:.0e}", ball.rad) })
        }
        (None, Value::Infinite) => None,
        (None, Value::Verdict(why) | Value::None(why)) => Some(AskedError::NoNumber { span, why: why.clone() }),
    }
}

/// How far a requirement is missed if no percentage is given: the distance from a limit of 0, or what makes a rest neutral.
fn missed_by(requirement: &Requirement) -> Option<String> {
    match (&requirement.value, &requirement.margin) {
        (Value::Number(_), Some(margin)) => {
            let by = shown_text(&shown_in(&Number::Ball(-*margin), &requirement.unit, requirement.in_radians));
            Some(format!("off by {by}"))
        }
        (Value::Verdict(verdict), _) if verdict == NEUTRAL => Some("no stiffness restrains some motion".to_string()),
        _ => None,
    }
}

/// The part of its limit by which a requirement is missed: percent, or a factor of a positive limit.
fn relative(part: f64, limit: &Number) -> String {
    let short = |x: f64| few_digits(format!("{x:.2e}").parse().unwrap_or(x));
    match part >= MANY_TIMES - 1.0 && limit.is_positive() {
        true => format!("{} times its limit", short(part + 1.0)),
        false => format!("off by {} %", short(100.0 * part)),
    }
}
