//! Advice on how to make a requirement hold: a parameter, and a value of it at which the requirement was found to hold.
//! In: a requirement that fails. Out: the parameter that changes its measure most, with a value if one was found. See
//! docs/method/measures.md.

use super::answer::{Requirement, Value, few_digits, shown_in, shown_text};
use super::derivative::{slope, step};
use super::error::ParameterChange;
use super::require::holds_for;
use super::trial::{Facts, Text};
use crate::analysis::Measurement;
use crate::base::{Ball, Number, OrderBy, Power, Quantity, Rational};
use crate::model::Setting;
use crate::model::scene::{Parameter, Question, Require};

/// Maximum number of parameters that are tried: if a scene has thousands, most are repetitions.
const MOST_TRIED: usize = 200;
/// Maximum number of parameters whose value is searched for.
const MOST_ADVISED: usize = 4;
/// Maximum number of parameters that are tried if the requirement has no slope.
const MAX_FACTORS: usize = 12;
/// A value more than this many times the present one is not worth advising.
const MOST_RAISED: f64 = 1000.0;
/// Factors on a parameter, tried in this order: the smallest changes first.
const FACTORS: [f64; 8] = [2.0, 0.5, 5.0, 0.2, 20.0, 0.05, 500.0, 0.002];
/// Steps to the estimate and beyond; the first at which the requirement holds is reported.
const BEYOND: [f64; 6] = [1.0, 1.01, 1.05, 1.25, 2.0, 4.0];
/// Number of bisections between a value that fails and one that holds.
const HALVINGS: usize = 12;
/// Steps up and down from a whole number.
const MOST_COUNTED: i64 = 8;

/// A requirement that fails, and its model.
pub struct Advice<'a> {
    pub text: &'a Text<'a>,
    pub settings: &'a [Setting],
    /// The parameters that are not solved for.
    pub parameters: &'a [Parameter],
    /// Number of the requirement.
    pub index: usize,
    pub require: &'a Require,
}

impl Advice<'_> {
    /// The best advice; `None` if no parameter was found that changes the measure.
    pub fn remedy(&self, requirement: &Requirement) -> Option<ParameterChange> {
        let found = match requirement.value {
            Value::Number(here) => self.by_slope(here),
            Value::Infinite | Value::Verdict(_) | Value::None(_) => self.by_factors(),
        };
        match found {
            Some(ParameterChange { wanted: Some(_), .. }) => found,
            _ => self.by_counts().or(found),
        }
    }

    /// Tries the parameters with the largest slopes first.
    fn by_slope(&self, here: Ball) -> Option<ParameterChange> {
        let varied = self.parameters.iter().filter(|p| !p.value.si.may_be_zero()).take(MOST_TRIED);
        let mut slopes: Vec<(&Parameter, f64)> = varied
            .filter_map(|parameter| {
                let slope = self.slope(parameter, here)?.to_f64() * parameter.value.si.to_f64();
                (slope != 0.0 && slope.is_finite()).then_some((parameter, slope))
            })
            .collect();
        // The sort is stable: among equal slopes the first declared comes first.
        slopes.order_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        let (first, slope) = *slopes.first()?;
        let percent = |slope: f64| few_digits(three_digits(slope / here.to_f64()));
        let found = slopes.iter().take(MOST_ADVISED).find_map(|&(parameter, slope)| {
            let wanted = self.estimate_target(parameter, &here, slope)?;
            let value = self.at_or_beyond(parameter, wanted)?;
            Some((parameter, slope, self.at_the_border(parameter, value)))
        });
        Some(match found {
            Some((parameter, slope, value)) => ParameterChange {
                percent: Some(percent(slope)).filter(|_| here.to_f64() != 0.0),
                most: parameter.name == first.name,
                ..self.mover_at(parameter, Some(value))
            },
            None => ParameterChange {
                percent: Some(percent(slope)).filter(|_| here.to_f64() != 0.0),
                most: true,
                ..self.mover_at(first, None)
            },
        })
    }

    /// Multiplies every parameter by the same factors until the requirement holds, then bisects back to the value from
    /// which it holds.
    fn by_factors(&self) -> Option<ParameterChange> {
        let parameters = || self.parameters.iter().filter(|p| !p.value.si.may_be_zero()).take(MAX_FACTORS);
        let (parameter, factor) = FACTORS.iter().find_map(|&factor| {
            parameters().find_map(|parameter| {
                let value = decimal(parameter, parameter.value.si.to_f64() * factor)?;
                self.holds_at(parameter, &value).then_some((parameter, factor))
            })
        })?;
        let found = decimal(parameter, parameter.value.si.to_f64() * factor)?;
        Some(self.mover_at(parameter, Some(self.nearest(parameter, found, HALVINGS))))
    }

    /// The value nearest to the present one at which the requirement holds, by bisection of the ratio of the two, starting
    /// from a value at which it holds.
    fn nearest(&self, parameter: &Parameter, found: Number, halvings: usize) -> Number {
        let start = parameter.value.si.to_f64();
        let (mut fails, mut holds) = (1.0, found.to_f64() / start);
        let mut best = found;
        for _ in 0..halvings {
            let middle: f64 = (fails * holds).sqrt();
            let Some(value) = decimal(parameter, start * middle) else { break };
            if self.holds_at(parameter, &value) {
                (holds, best) = (middle, value);
            } else {
                fails = middle;
            }
        }
        best
    }

    /// Tries the whole numbers next to those that may count something: a number of parts has no fractions between.
    fn by_counts(&self) -> Option<ParameterChange> {
        let counts = || {
            self.parameters.iter().filter(|p| {
                p.value.dimension.is_none() && p.value.si.exact().is_some_and(|value| value.to_i64().is_some())
            })
        };
        let places = (1..=MOST_COUNTED).flat_map(|step| [-step, step]);
        places.into_iter().find_map(|step| {
            counts().take(MOST_ADVISED).find_map(|parameter| {
                let value = &parameter.value.si + &Number::from(step);
                let usable = !value.is_negative() && self.holds_at(parameter, &value);
                usable.then(|| self.mover_at(parameter, Some(value)))
            })
        })
    }

    fn mover_at(&self, parameter: &Parameter, wanted: Option<Number>) -> ParameterChange {
        let in_unit = |si: Number| shown_text(&shown_in(&si, &parameter.unit, false));
        ParameterChange {
            name: parameter.name.clone(),
            declared: parameter.span,
            percent: None,
            most: false,
            wanted: wanted.map(in_unit),
            value: in_unit(parameter.value.si.clone()),
        }
    }

    /// The first value, from the estimate onwards away from the present one, at which the requirement certainly holds.
    fn at_or_beyond(&self, parameter: &Parameter, wanted: f64) -> Option<Number> {
        let now = parameter.value.si.to_f64();
        let values = BEYOND.iter().filter_map(|times| decimal_from(parameter, now, now + (wanted - now) * times));
        let mut usable = values.filter(|value| {
            let ratio = value.to_f64() / now;
            ratio > 0.0 && ratio < MOST_RAISED
        });
        usable.find(|value| self.holds_at(parameter, value))
    }

    /// A value near the border from which the requirement holds. The estimate misses it by far if the measure jumps on the
    /// way; then the requirement holds halfway, too.
    fn at_the_border(&self, parameter: &Parameter, found: Number) -> Number {
        let halfway = self.nearest(parameter, found.clone(), 1);
        if halfway == found { found } else { self.nearest(parameter, halfway, HALVINGS) }
    }

    /// Whether the requirement holds in a run of the model with this value, whose simulated time is another one unless it is given.
    fn holds_at(&self, parameter: &Parameter, value: &Number) -> bool {
        let quantity = Quantity { si: value.clone(), ..parameter.value.clone() };
        let of_time = self.require.question.measure.is_of_time();
        let usual = of_time.then(|| self.text.usual_time_at(&[(parameter.name.clone(), quantity)])).flatten();
        let text = Text { until: usual.as_ref().or(self.text.until), ..*self.text };
        self.measure(&text, parameter, value).is_some_and(|(question, measured)| {
            holds_for(&measured, self.require.comparison, &question.value) == Some(true)
        })
    }

    fn measure(&self, text: &Text, parameter: &Parameter, value: &Number) -> Option<(Question, Measurement)> {
        let quantity = Quantity { si: value.clone(), ..parameter.value.clone() };
        let others = self.settings.iter().filter(|(name, _)| *name != parameter.name).cloned();
        let moved: Vec<Setting> = others.chain([(parameter.name.clone(), quantity)]).collect();
        let scene = text.scene(&moved).ok()?;
        let question = scene.scene().requires.get(self.index)?.question.clone();
        let measured = text.measure_scene(&scene, std::slice::from_ref(&question), Facts::default()).ok()?.pop()?;
        Some((question, measured))
    }

    /// The derivative of the requirement's measure with respect to a parameter, by differences: it selects parameters,
    /// and is reported to three digits.
    fn slope(&self, parameter: &Parameter, here: Ball) -> Option<Ball> {
        let h = step(&parameter.value.si, &Number::ONE, here.relative_error());
        let at = |si: Number| match self.measure(self.text, parameter, &si)? {
            (_, Measurement::Value(value)) => Some(value),
            _ => None,
        };
        let value = &parameter.value.si;
        slope(at(value - &h), Some(here), at(value + &h), &h).ok()
    }

    /// An estimate of the parameter value at which the measure reaches its limit: along the power law with the given
    /// slope (stiffnesses and masses act like powers), or along the tangent if the signs rule out a power. `slope` is
    /// with respect to the relative change of the parameter.
    fn estimate_target(&self, parameter: &Parameter, here: &Ball, slope: f64) -> Option<f64> {
        let (value, limit) = (parameter.value.si.to_f64(), self.require.question.value.to_f64());
        let (here, ratio) = (here.to_f64(), limit / here.to_f64());
        let power = here / slope;
        let wanted = if ratio > 0.0 && power.abs() < 100.0 {
            let ratio = Rational::from_f64(ratio).map(Number::from)?;
            let power = Rational::from_f64(power).map(Number::from)?;
            value * ratio.pow(&power)?.to_f64()
        } else {
            value * (1.0 + (limit - here) / slope)
        };
        wanted.is_finite().then_some(wanted)
    }
}

fn three_digits(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}

/// Three digits in the parameter's own unit, as reported.
fn decimal(parameter: &Parameter, x: f64) -> Option<Number> {
    let factor = parameter.unit.factor.clone().unwrap_or(Number::ONE);
    let short = Rational::from_decimal(&format!("{:.2e}", x / factor.to_f64()))?;
    Some(&Number::from(short) * &factor)
}

/// Three digits in the parameter's own unit, rounded away from `start`.
fn decimal_from(parameter: &Parameter, start: f64, x: f64) -> Option<Number> {
    let rounded = decimal(parameter, x)?;
    if (rounded.to_f64() - x) * (x - start) >= 0.0 {
        return Some(rounded);
    }
    let factor = parameter.unit.factor.as_ref().map_or(1.0, Number::to_f64);
    let unit = 10f64.power(format!("{:e}", x / factor).split_once('e')?.1.parse::<i32>().ok()? - 2);
    decimal(parameter, rounded.to_f64() + (unit * factor.abs()).copysign(x - start))
}
