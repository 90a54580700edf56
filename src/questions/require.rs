//! The lines `require`: what each measure came to, whether it keeps its limit for certain, and which parameter moves it most.
//! In: measured numbers. Out: how each requirement stands, and a finding for each that does not hold.
//! Clause: spec.md, "Measures, `solve`, `require`".

use super::answer::{Requirement, Value, few_digits, shown, told};
use super::derivative::{slope, step};
use super::error::{AskedError, Mover};
use super::trial::Text;
use crate::analysis::{Measurement, Modes, Poles};
use crate::base::{Ball, Number, Quantity, Rational};
use crate::model::scene::{Comparison, Parameter, Question, Require};
use crate::model::{CheckedScene, Setting};
use std::cmp::Ordering;

/// Every requirement of a scene. `known` modes and poles are not computed again.
pub fn requirements(
    text: &Text,
    scene: &CheckedScene,
    settings: &[Setting],
    known: Option<(&Modes, &Poles)>,
) -> (Vec<Requirement>, Vec<AskedError>) {
    let requires = &scene.scene().requires;
    let questions: Vec<Question> = requires.iter().map(|require| require.question.clone()).collect();
    let measured = text.measure_scene(scene, &questions, known).unwrap_or_else(|why| {
        // One reason for all of them.
        questions.iter().map(|_| Measurement::Failed(why.clone())).collect()
    });
    let list: Vec<Requirement> =
        requires.iter().zip(measured).map(|(require, measured)| requirement(text, scene, require, measured)).collect();
    let parameters = if list.iter().all(|r| r.holds == Some(true)) { Vec::new() } else { text.parameters(settings) };
    let findings = list.iter().zip(requires).enumerate().filter_map(|(index, (requirement, require))| {
        finding(requirement, || mover(text, &parameters, settings, (index, require), requirement))
    });
    let findings = findings.collect();
    (list, findings)
}

fn requirement(text: &Text, scene: &CheckedScene, require: &Require, measured: Measurement) -> Requirement {
    let question = &require.question;
    let (holds, margin) = match (&measured, require.comparison) {
        (Measurement::Value(value), None) => (value.is_exact().then(|| *value == Ball::ONE), None),
        (Measurement::Value(value), Some(comparison)) => {
            let order = || text.compared(scene, question).map(|order| keeps(order, comparison));
            let holds = holds(value, comparison, &question.value).or_else(order);
            (holds, Some(margin(value, comparison, &question.value)))
        }
        (Measurement::Infinite, Some(Comparison::Greater | Comparison::GreaterEqual)) => (Some(true), None),
        (Measurement::Infinite, Some(_)) => (Some(false), None),
        _ => (None, None),
    };
    let value = match measured {
        Measurement::Value(value) if require.comparison.is_none() => {
            let said = if value == Ball::ONE { "stable" } else { "not stable" };
            Value::Said(if value.is_exact() { said } else { "not certain whether it is stable" }.to_string())
        }
        Measurement::Value(value) => Value::Number(value),
        Measurement::Infinite => Value::Infinite,
        Measurement::None(why) => Value::Said(why.to_string()),
        Measurement::Failed(why) => Value::Said(why),
    };
    Requirement {
        text: text.sources.slice(require.span).to_string(),
        span: require.span,
        holds,
        value,
        limit: require.comparison.map(|_| question.value.clone()),
        margin,
        unit: question.unit.clone(),
        in_radians: question.radians.is_some(),
        until: text.followed(&question.measure),
    }
}

/// Whether the comparison is certain, one way or the other.
fn holds(value: &Ball, comparison: Comparison, limit: &Number) -> Option<bool> {
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

/// (value - limit) / |limit|, or its opposite: positive on the side that is required; the difference itself for a limit of 0.
fn margin(value: &Ball, comparison: Comparison, limit: &Number) -> Ball {
    let difference = *value - limit.to_ball();
    let relative = if limit.may_be_zero() { difference } else { difference / limit.to_ball().abs() };
    match comparison {
        Comparison::Less | Comparison::LessEqual => -relative,
        Comparison::Greater | Comparison::GreaterEqual => relative,
    }
}

fn finding(requirement: &Requirement, mover: impl FnOnce() -> Option<Mover>) -> Option<AskedError> {
    let span = requirement.span;
    let value = requirement.told().into_owned();
    match (requirement.holds, &requirement.value) {
        (Some(true), _) => None,
        (Some(false), _) => {
            let by = match (&requirement.margin, requirement.limit.as_ref().filter(|limit| !limit.may_be_zero())) {
                (Some(margin), Some(_)) => percent(-margin.to_f64()),
                (Some(_), None) | (None, _) => missed_by(requirement),
            };
            Some(AskedError::Fails { span, value, by, mover: mover() })
        }
        (None, Value::Number(ball)) => {
            let limit = requirement.shown_limit().map_or(String::new(), |limit| told(&limit));
            Some(AskedError::Undetermined { span, value, limit, bound: format!("{:.0e}", ball.rad) })
        }
        (None, Value::Infinite) => None,
        (None, Value::Said(why)) => Some(AskedError::NoNumber { span, why: why.clone() }),
    }
}

/// The distance from a limit of 0, or from anything where it is infinite.
fn missed_by(requirement: &Requirement) -> String {
    match (&requirement.value, &requirement.margin) {
        (Value::Number(_), Some(margin)) => {
            told(&shown(&Number::Ball(-*margin), &requirement.unit, requirement.in_radians))
        }
        (Value::Infinite, _) => "any amount".to_string(),
        _ => "being unstable or neutral".to_string(),
    }
}

fn percent(part: f64) -> String {
    format!("{} %", few_digits(three_digits(100.0 * part)))
}

fn three_digits(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}

/// Parameters that are tried, at most: a scene of thousands has them in repetitions.
const MOST_TRIED: usize = 200;

/// The parameter with the largest relative sensitivity.
fn mover(
    text: &Text,
    parameters: &[Parameter],
    settings: &[Setting],
    (index, require): (usize, &Require),
    requirement: &Requirement,
) -> Option<Mover> {
    let Value::Number(here) = requirement.value else { return None };
    let varied = parameters.iter().filter(|p| !p.value.si.may_be_zero()).take(MOST_TRIED);
    let slopes = varied.filter_map(|parameter| {
        let slope = sensitivity(text, settings, index, parameter, here)?;
        Some((parameter, slope, (slope * parameter.value.si.to_ball()).to_f64()))
    });
    let (parameter, slope, _) = slopes.fold(None, |best: Option<(&Parameter, Ball, f64)>, next| match best {
        Some(best) if best.2.abs() >= next.2.abs() => Some(best),
        _ if next.2 == 0.0 => best,
        _ => Some(next),
    })?;
    let value = &parameter.value.si;
    let relative = (slope * value.to_ball() / here).to_f64();
    let wanted = reaching(value, &here, &require.question.value, slope);
    let keeps_sign = wanted.to_f64() * value.to_f64() > 0.0 && (wanted.to_f64() / value.to_f64()) < MOST_RAISED;
    let in_unit = |si: Number| told(&shown(&si, &parameter.unit, false));
    let rounded = |ball: Ball| Rational::from_decimal(&format!("{:.2e}", ball.to_f64())).map(Number::from);
    Some(Mover {
        name: parameter.name.clone(),
        declared: parameter.span,
        percent: few_digits(three_digits(relative)),
        wanted: keeps_sign.then(|| rounded(wanted)).flatten().map(in_unit),
        value: in_unit(value.clone()),
    })
}

/// More than so many times its value is no advice.
const MOST_RAISED: f64 = 1000.0;

/// About where the measure reaches its limit: along the power of the parameter that the slope says (stiffnesses and masses act
/// like powers), or along the tangent where signs forbid a power.
fn reaching(value: &Number, here: &Ball, limit: &Number, slope: Ball) -> Ball {
    let power = (*here / (slope * value.to_ball())).to_f64();
    let ratio = limit.to_ball() / *here;
    let power = Rational::from_f64(power).map(Number::from).filter(|power| power.to_f64().abs() < 100.0);
    let factor = power.filter(|_| ratio.is_positive()).and_then(|power| Number::Ball(ratio).pow(&power));
    match factor {
        Some(factor) => value.to_ball() * factor.to_ball(),
        None => value.to_ball() + (limit.to_ball() - *here) / slope,
    }
}

/// The derivative of a requirement's measure by a parameter.
fn sensitivity(text: &Text, settings: &[Setting], index: usize, parameter: &Parameter, here: Ball) -> Option<Ball> {
    let h = step(&parameter.value.si, &Number::ONE, here.relative_error());
    let at = |si: Number| {
        let quantity = Quantity { si, ..parameter.value.clone() };
        let moved = settings.iter().filter(|(name, _)| *name != parameter.name).cloned();
        let moved: Vec<Setting> = moved.chain([(parameter.name.clone(), quantity)]).collect();
        let question = |scene: &CheckedScene| -> Vec<Question> {
            scene.scene().requires.get(index).map(|require| require.question.clone()).into_iter().collect()
        };
        match text.measure(&moved, question).ok()?.pop()? {
            Measurement::Value(value) => Some(value),
            _ => None,
        }
    };
    let value = &parameter.value.si;
    slope(at(value - &h), Some(here), at(value + &h), &h).ok()
}
