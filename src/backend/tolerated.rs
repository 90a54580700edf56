//! Results for all values within the tolerances, as JSON.

use super::json_number::{Bounds, JsonNumber};
use crate::base::{Ball, Number};
use crate::questions::answer::{
    Optimised, Range, Requirement, Robust, Throughout, Tolerated, ToleratedParameter, WorstCase, outer,
};
use serde::ser::{Serialize, SerializeMap, Serializer};

#[derive(serde::Serialize)]
pub(super) struct JsonTolerated<'a> {
    parameters: Vec<JsonRange<'a>>,
    frequencies: Vec<JsonFrequencies<'a>>,
    damping_ratios: Vec<JsonRatios<'a>>,
    poles: Vec<JsonPoles<'a>>,
    least_at: Option<Place<'a>>,
    largest_at: Option<Place<'a>>,
    requirements: Vec<JsonThroughout<'a>>,
    places: usize,
    follows_rest: bool,
    not_proved: Option<&'static str>,
}

#[derive(serde::Serialize)]
struct JsonRange<'a> {
    parameter: &'a str,
    least: JsonNumber,
    largest: JsonNumber,
}

#[derive(serde::Serialize)]
struct JsonFrequencies<'a> {
    mode: usize,
    least_hz: JsonNumber,
    least_error_bound: JsonNumber,
    largest_hz: JsonNumber,
    largest_error_bound: JsonNumber,
    proved: bool,
    reached_hz: Option<[JsonNumber; 2]>,
    reached_at: Option<[Place<'a>; 2]>,
}

#[derive(serde::Serialize)]
struct JsonRatios<'a> {
    motion: usize,
    #[serde(flatten)]
    range: JsonEnds<'a>,
}

#[derive(serde::Serialize)]
struct JsonPoles<'a> {
    pole: usize,
    re: JsonEnds<'a>,
    im: JsonEnds<'a>,
}

/// The values of a quantity, SI.
#[derive(serde::Serialize)]
struct JsonEnds<'a> {
    least: JsonNumber,
    least_error_bound: JsonNumber,
    largest: JsonNumber,
    largest_error_bound: JsonNumber,
    proved: bool,
    reached: Option<[JsonNumber; 2]>,
    reached_at: Option<[Place<'a>; 2]>,
}

#[derive(serde::Serialize)]
struct JsonThroughout<'a> {
    text: &'a str,
    verdict: &'static str,
    at: Option<Place<'a>>,
    values: Option<JsonEnds<'a>>,
    never_proved: Option<&'static str>,
}

/// A value for each parameter, SI.
struct Place<'a> {
    of: &'a [ToleratedParameter],
    values: &'a [Number],
}

impl Serialize for Place<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.values.len()))?;
        for (parameter, value) in self.of.iter().zip(self.values) {
            map.serialize_entry(&parameter.name, &JsonNumber::number(value))?;
        }
        map.end()
    }
}

impl<'a> JsonTolerated<'a> {
    pub(super) fn of(found: &'a Tolerated, requirements: &'a [Requirement], bounds: Bounds) -> JsonTolerated<'a> {
        let place = |values: &'a Vec<Number>| Place { of: &found.parameters, values };
        let ends = |range: &'a Range| {
            let [least, largest] = [0, 1].map(|end| range.ends.map(|ends| ends[end]));
            let bound = |end: Option<_>| end.map_or(JsonNumber::NULL, |end| bounds.relative(end));
            JsonEnds {
                least: JsonNumber::of(least),
                least_error_bound: bound(least),
                largest: JsonNumber::of(largest),
                largest_error_bound: bound(largest),
                proved: range.proof.is_some(),
                reached: range.reached.map(|ends| ends.map(JsonNumber::from_enclosure)),
                reached_at: range.at.as_ref().map(|at| at.each_ref().map(place)),
            }
        };
        let frequencies = found.frequencies.iter().enumerate().map(|(i, range)| {
            let JsonEnds { least, least_error_bound, largest, largest_error_bound, proved, reached, reached_at } =
                ends(range);
            JsonFrequencies {
                mode: i + 1,
                least_hz: least,
                least_error_bound,
                largest_hz: largest,
                largest_error_bound,
                proved,
                reached_hz: reached,
                reached_at,
            }
        });
        let ratio = |(i, range): (usize, &'a Range)| JsonRatios { motion: i + 1, range: ends(range) };
        let pole = |(i, [re, im]): (usize, &'a [Range; 2])| JsonPoles { pole: i + 1, re: ends(re), im: ends(im) };
        let everywhere = |(index, everywhere): (usize, &'a Throughout)| {
            let at = match everywhere {
                Throughout::FailsAt(values) => Some(place(values)),
                Throughout::Holds(_) | Throughout::Undetermined => None,
            };
            let verdict = verdict(everywhere);
            let values = found.measures.get(index).and_then(Option::as_ref).map(ends);
            let text = requirements.get(index).map_or("", |own| &own.text);
            let never_proved = found.never.get(index).copied().flatten();
            JsonThroughout { text, verdict, at, values, never_proved }
        };
        JsonTolerated {
            parameters: found.parameters.iter().map(JsonRange::of).collect(),
            frequencies: frequencies.collect(),
            damping_ratios: found.ratios.iter().enumerate().map(ratio).collect(),
            poles: found.poles.iter().enumerate().map(pole).collect(),
            least_at: found.corners.as_ref().map(|[low, _]| place(low)),
            largest_at: found.corners.as_ref().map(|[_, high]| place(high)),
            requirements: found.requirements.iter().enumerate().map(everywhere).collect(),
            places: found.places,
            follows_rest: found.follows_rest,
            not_proved: found.not_proved,
        }
    }
}

impl<'a> JsonRange<'a> {
    fn of(parameter: &'a ToleratedParameter) -> JsonRange<'a> {
        let [least, largest] = parameter.ends.each_ref().map(JsonNumber::number);
        JsonRange { parameter: &parameter.name, least, largest }
    }
}

fn verdict(everywhere: &Throughout) -> &'static str {
    match everywhere {
        Throughout::Holds(_) => "holds",
        Throughout::FailsAt(_) => "fails",
        Throughout::Undetermined => "undetermined",
    }
}

/// The worst case of an optimum within the tolerances; all numbers are SI.
#[derive(serde::Serialize)]
pub(super) struct JsonRobust<'a> {
    parameters: Vec<JsonRange<'a>>,
    /// No value is worse; `null` if that is not proved.
    bound: JsonNumber,
    reached: JsonNumber,
    reached_at: Place<'a>,
    conditions: Vec<JsonCondition<'a>>,
    decay_proved: bool,
    /// No values in the ranges have a better worst case.
    best_possible: JsonNumber,
    nominal: JsonNominal<'a>,
}

#[derive(serde::Serialize)]
struct JsonCondition<'a> {
    text: &'a str,
    verdict: &'static str,
}

/// The optimum at the values of the model.
#[derive(serde::Serialize)]
struct JsonNominal<'a> {
    value: JsonNumber,
    at: Values<'a>,
    worst_bound: JsonNumber,
    worst_reached: JsonNumber,
}

/// A value for each varied parameter, SI.
struct Values<'a>(&'a Optimised, &'a [Number]);

impl Serialize for Values<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(
            self.0.parameters.iter().zip(self.1).map(|(own, value)| (&own.parameter, JsonNumber::number(value))),
        )
    }
}

impl<'a> JsonRobust<'a> {
    pub(super) fn of(robust: &'a Robust, found: &'a Optimised) -> JsonRobust<'a> {
        // The outer end, so that it is a bound of its own.
        let outer = |ball: Ball, upper: bool| JsonNumber::from_enclosure(outer(ball, upper));
        let bound = |worst: &WorstCase| worst.bound.map_or(JsonNumber::NULL, |(ball, _)| outer(ball, !found.highest));
        let worst = &robust.worst;
        let conditions = robust.conditions.iter().zip(&worst.conditions);
        let nominal = robust.nominal_worst.as_ref();
        JsonRobust {
            parameters: robust.parameters.iter().map(JsonRange::of).collect(),
            bound: bound(worst),
            reached: JsonNumber::from_enclosure(worst.reached),
            reached_at: Place { of: &robust.parameters, values: &worst.at },
            conditions: conditions
                .map(|(text, everywhere)| JsonCondition { text, verdict: verdict(everywhere) })
                .collect(),
            decay_proved: worst.decays,
            best_possible: robust.best_possible.map_or(JsonNumber::NULL, |(ball, _)| outer(ball, found.highest)),
            nominal: JsonNominal {
                value: JsonNumber::from_enclosure(robust.nominal_value),
                at: Values(found, &robust.nominal),
                worst_bound: nominal.map_or(JsonNumber::NULL, bound),
                worst_reached: nominal.map_or(JsonNumber::NULL, |worst| JsonNumber::from_enclosure(worst.reached)),
            },
        }
    }
}
