//! What holds for all values within the tolerances, as JSON.

use super::json_number::{Bounds, JsonNumber};
use crate::base::Number;
use crate::questions::answer::{Requirement, Throughout, Tolerated, ToleratedParameter};
use serde::ser::{Serialize, SerializeMap, Serializer};

#[derive(serde::Serialize)]
pub(super) struct JsonTolerated<'a> {
    parameters: Vec<JsonRange<'a>>,
    frequencies: Vec<JsonFrequencies>,
    least_at: Option<Place<'a>>,
    largest_at: Option<Place<'a>>,
    requirements: Vec<JsonThroughout<'a>>,
    places: usize,
}

#[derive(serde::Serialize)]
struct JsonRange<'a> {
    parameter: &'a str,
    least: JsonNumber,
    largest: JsonNumber,
}

#[derive(serde::Serialize)]
struct JsonFrequencies {
    mode: usize,
    least_hz: JsonNumber,
    least_error_bound: JsonNumber,
    largest_hz: JsonNumber,
    largest_error_bound: JsonNumber,
    proved: bool,
    reached_hz: Option<[JsonNumber; 2]>,
}

#[derive(serde::Serialize)]
struct JsonThroughout<'a> {
    text: &'a str,
    verdict: &'static str,
    at: Option<Place<'a>>,
}

/// A value for each parameter, SI.
struct Place<'a> {
    of: &'a Tolerated,
    values: &'a [Number],
}

impl Serialize for Place<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.values.len()))?;
        for (parameter, value) in self.of.parameters.iter().zip(self.values) {
            map.serialize_entry(&parameter.name, &JsonNumber::number(value))?;
        }
        map.end()
    }
}

impl<'a> JsonTolerated<'a> {
    pub(super) fn of(found: &'a Tolerated, requirements: &'a [Requirement], bounds: Bounds) -> JsonTolerated<'a> {
        let place = |values: &'a Vec<Number>| Place { of: found, values };
        let range = |parameter: &'a ToleratedParameter| {
            let [least, largest] = parameter.ends.each_ref().map(JsonNumber::number);
            JsonRange { parameter: &parameter.name, least, largest }
        };
        let frequencies = found.frequencies.iter().enumerate().map(|(i, range)| {
            let [least, largest] = [0, 1].map(|end| range.ends.map(|ends| ends[end]));
            let bound = |end: Option<_>| end.map_or(JsonNumber::NULL, |end| bounds.relative(end));
            JsonFrequencies {
                mode: i + 1,
                least_hz: JsonNumber::of(least),
                least_error_bound: bound(least),
                largest_hz: JsonNumber::of(largest),
                largest_error_bound: bound(largest),
                proved: range.proof.is_some(),
                reached_hz: range.reached.map(|ends| ends.map(JsonNumber::enclosed)),
            }
        });
        let everywhere = |(requirement, everywhere): (&'a Requirement, &'a Throughout)| {
            let (verdict, at) = match everywhere {
                Throughout::Holds(_) => ("holds", None),
                Throughout::FailsAt(values) => ("fails", Some(place(values))),
                Throughout::Undetermined => ("undetermined", None),
            };
            JsonThroughout { text: &requirement.text, verdict, at }
        };
        JsonTolerated {
            parameters: found.parameters.iter().map(range).collect(),
            frequencies: frequencies.collect(),
            least_at: found.corners.as_ref().map(|[low, _]| place(low)),
            largest_at: found.corners.as_ref().map(|[_, high]| place(high)),
            requirements: requirements.iter().zip(&found.requirements).map(everywhere).collect(),
            places: found.places,
        }
    }
}
