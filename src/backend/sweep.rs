//! Studies as CSV and JSON: a row for each case, made one by one. See docs/cli.md#sweeps.

use super::SCHEMA;
use super::json_number::JsonNumber;
use crate::questions::answer::{Case, Column, Entry, Holds};
use crate::questions::answer::{Critical, Curve, Followed, Grows, Locus, Meeting, MeetingKind, Onset};

/// Whether a column is followed by one with bounds.
pub(super) fn has_bound(column: &Column) -> bool {
    !matches!(column.holds, Holds::Parameter | Holds::Verdict | Holds::Link)
}

/// `case,k [N/m],frequency_1 [Hz],frequency_1_bound,...,code`
pub fn csv_heading(columns: &[Column]) -> String {
    let mut text = "case".to_string();
    for of in columns {
        text += &format!(",{}", quote(&column_title(of)));
        if has_bound(of) {
            text += &format!(",{}", quote(&format!("{}_bound", of.name)));
        }
    }
    text + ",code\n"
}

/// `k [N/m]`
fn column_title(column: &Column) -> String {
    match column.unit.as_str() {
        "" => column.name.clone(),
        unit => format!("{} [{unit}]", column.name),
    }
}

/// Adds a row in UTF-8, with its line feed.
pub fn csv_row(columns: &[Column], case: &Case, text: &mut Vec<u8>) {
    text.extend(case.number.to_string().as_bytes());
    for (column, entry) in columns.iter().zip(&case.entries) {
        text.push(b',');
        let mut bound = JsonNumber::NULL;
        match *entry {
            Entry::Enclosed(value) => {
                JsonNumber::from_enclosure(value).push_field(text);
                bound = JsonNumber::absolute_bound(value);
            }
            Entry::Unproven(value) => JsonNumber::unproven(value).push_field(text),
            Entry::Infinite => text.extend(b"inf"),
            Entry::Verdict(holds) => text.extend(if holds { &b"true"[..] } else { b"false" }),
            Entry::None(_) => {}
        };
        if has_bound(column) {
            text.push(b',');
            bound.push_field(text);
        }
    }
    text.push(b',');
    text.extend(case.code.unwrap_or("").as_bytes());
    text.push(b'\n');
}

/// A field of CSV as RFC 4180 has it.
fn quote(text: &str) -> String {
    match text.contains([',', '"']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_string(),
    }
}

/// `{"vibc", "schema", "model", "columns": [...], "cases": [`
pub fn json_heading(model: &str, columns: &[Column], followed: Option<&Followed>) -> String {
    let columns: Vec<JsonColumn> = columns
        .iter()
        .map(|column| JsonColumn { name: &column.name, unit: &column.unit, holds: word(column.holds) })
        .collect();
    let heading = JsonHeading {
        vibc: env!("CARGO_PKG_VERSION"),
        schema: SCHEMA,
        model,
        columns,
        following: followed.map(following),
    };
    let text = super::json_text(&heading);
    format!("{},\"cases\":[", text.strip_suffix('}').unwrap_or(&text))
}

/// A row as an object; a comma comes before all but the first.
pub fn json_row(case: &Case) -> String {
    let values = case.entries.iter().map(|entry| match *entry {
        Entry::Enclosed(value) => JsonValue::Number(JsonNumber::from_enclosure(value)),
        Entry::Unproven(value) => JsonValue::Number(JsonNumber::unproven(value)),
        Entry::Verdict(holds) => JsonValue::Verdict(holds),
        Entry::Infinite | Entry::None(_) => JsonValue::Number(JsonNumber::NULL),
    });
    let bounds = case.entries.iter().map(|entry| match *entry {
        Entry::Enclosed(value) => JsonNumber::absolute_bound(value),
        _ => JsonNumber::NULL,
    });
    let infinite = case.entries.iter().enumerate().filter(|(_, entry)| **entry == Entry::Infinite).map(|(i, _)| i);
    let row = JsonCase {
        case: case.number,
        values: values.collect(),
        error_bounds: bounds.collect(),
        infinite: infinite.collect(),
        code: case.code,
    };
    super::json_text(&row)
}

/// The end of the JSON.
pub const JSON_END: &str = "]}\n";

#[derive(serde::Serialize)]
struct JsonHeading<'a> {
    vibc: &'static str,
    schema: u32,
    model: &'a str,
    columns: Vec<JsonColumn<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    following: Option<JsonFollowing>,
}

#[derive(serde::Serialize)]
struct JsonFollowing {
    curves: Vec<JsonCurve>,
    meetings: Vec<JsonMeeting>,
    /// The poles as curves.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    loci: Vec<JsonLocus>,
    onsets: Vec<JsonOnset>,
    #[serde(skip_serializing_if = "Option::is_none")]
    critical: Option<Vec<JsonCritical>>,
    /// Cases for which it is not known how many motions grow.
    undecided_growth: usize,
}

/// A rate of rotation at which an order has the frequency of a curve.
#[derive(serde::Serialize)]
struct JsonCritical {
    order: u32,
    curve: String,
    parameter: [JsonNumber; 2],
    frequency_hz: Option<[JsonNumber; 2]>,
}

#[derive(serde::Serialize)]
struct JsonOnset {
    of: &'static str,
    growing: [usize; 2],
    parameter: [JsonNumber; 2],
    proved: bool,
}

#[derive(serde::Serialize)]
struct JsonCurve {
    name: String,
    block: usize,
    open_links: Vec<usize>,
}

#[derive(serde::Serialize)]
struct JsonLocus {
    name: String,
    open_links: Vec<usize>,
}

#[derive(serde::Serialize)]
struct JsonMeeting {
    kind: &'static str,
    curves: [String; 2],
    /// In the unit of the column, and the bound of its error.
    parameter: [JsonNumber; 2],
    #[serde(skip_serializing_if = "Option::is_none")]
    distance_hz: Option<[JsonNumber; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    frequency_hz: Option<[JsonNumber; 2]>,
}

/// The curves and what is proved of them.
fn following(followed: &Followed) -> JsonFollowing {
    let name = |i: usize| format!("curve_{}", i + 1);
    let curve = |(i, curve): (usize, &Curve)| JsonCurve {
        name: name(i),
        block: curve.class,
        open_links: curve.open_links().collect(),
    };
    let bounded = |value| [JsonNumber::from_enclosure(value), JsonNumber::absolute_bound(value)];
    let meeting = |meeting: &Meeting| {
        let place = followed.place(meeting.place);
        let (kind, distance, frequency) = match meeting.kind {
            MeetingKind::Veering { distance, .. } => ("veering", Some(distance), None),
            MeetingKind::Crossing { frequency, .. } => ("crossing", None, Some(frequency)),
            MeetingKind::Undecided { distance } => ("undecided", distance, None),
        };
        JsonMeeting {
            kind,
            curves: meeting.curves.map(name),
            parameter: bounded(place),
            distance_hz: distance.map(bounded),
            frequency_hz: frequency.map(bounded),
        }
    };
    let of = match followed.onsets.of {
        Grows::Modes => "modes",
        Grows::Poles => "poles",
    };
    let onset = |onset: &Onset| JsonOnset {
        of,
        growing: onset.growing,
        parameter: bounded(followed.place(onset.place)),
        proved: onset.proof.is_some(),
    };
    let critical = |critical: &Critical| JsonCritical {
        order: critical.order,
        curve: name(critical.curve),
        parameter: bounded(followed.place(critical.place)),
        frequency_hz: critical.frequency.map(bounded),
    };
    let locus = |(i, locus): (usize, &Locus)| JsonLocus {
        name: format!("pole_{}", i + 1),
        open_links: locus.open_links().collect(),
    };
    JsonFollowing {
        loci: followed.loci.iter().enumerate().map(locus).collect(),
        curves: followed.curves.iter().enumerate().map(curve).collect(),
        meetings: followed.meetings.iter().map(meeting).collect(),
        onsets: followed.onsets.list.iter().map(onset).collect(),
        critical: (!followed.orders.list.is_empty()).then(|| followed.orders.critical.iter().map(critical).collect()),
        undecided_growth: followed.onsets.undecided,
    }
}

#[derive(serde::Serialize)]
struct JsonColumn<'a> {
    name: &'a str,
    unit: &'a str,
    holds: &'static str,
}

#[derive(serde::Serialize)]
struct JsonCase {
    case: u64,
    values: Vec<JsonValue>,
    error_bounds: Vec<JsonNumber>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    infinite: Vec<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    code: Option<&'static str>,
}

#[derive(serde::Serialize)]
#[serde(untagged)]
enum JsonValue {
    Number(JsonNumber),
    Verdict(bool),
}

fn word(holds: Holds) -> &'static str {
    match holds {
        Holds::Parameter => "parameter",
        Holds::Determined => "determined",
        Holds::Frequency => "frequency",
        Holds::Curve => "curve",
        Holds::Link => "link",
        Holds::PoleRe => "pole_re",
        Holds::PoleIm => "pole_im",
        Holds::Required => "required",
        Holds::Verdict => "verdict",
        Holds::Measure => "measure",
    }
}
