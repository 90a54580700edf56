//! Transfer tables as CSV and JSON, which contain every row. See docs/method/transfer.md.

use super::SCHEMA;
use super::json_number::JsonNumber;
use super::report;
use crate::analysis::{Extremum, Gain, Row, Table};
use crate::base::Ball;
use crate::system::LinearSystem;

/// A row: one frequency of one pair. Infinite or unknown values are `null`.
#[derive(serde::Serialize)]
struct Line {
    frequency_hz: JsonNumber,
    re: JsonNumber,
    im: JsonNumber,
    gain: JsonNumber,
    gain_error_bound: JsonNumber,
    gain_db: JsonNumber,
    gain_db_error_bound: JsonNumber,
    phase_deg: JsonNumber,
    phase_error_bound: JsonNumber,
    error_bound: JsonNumber,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    infinite: bool,
}

/// `frequency_hz,input,output,re,im,gain,gain_db,phase_deg,error_bound` and a row for each frequency and pair. Empty fields
/// are unknown; an infinite gain is `inf`.
pub fn csv(system: &LinearSystem, table: &Table) -> String {
    let mut text = String::from("frequency_hz,input,output,re,im,gain,gain_db,phase_deg,error_bound\n");
    each_line(system, table, |input, output, line| {
        let gain = |value: JsonNumber| if line.infinite { "inf".to_string() } else { value.field() };
        let fields = [
            line.frequency_hz.field(),
            input.to_string(),
            output.to_string(),
            line.re.field(),
            line.im.field(),
            gain(line.gain),
            gain(line.gain_db),
            line.phase_deg.field(),
            line.error_bound.field(),
        ];
        text += &fields.join(",");
        text.push('\n');
    });
    text
}

/// `{"vibc", "schema", "model", "range_hz", "pairs"}`: for each pair its extrema and the rows of the CSV. Every bound
/// is relative (of a phase: in degrees) and holds for the printed number; infinite or unknown values are `null`.
pub fn json(model: &str, system: &LinearSystem, table: &Table) -> String {
    let ends = table.rows.first().zip(table.rows.last());
    let mut text = format!(
        "{{\"vibc\":{},\"schema\":{SCHEMA},\"model\":{},\"range_hz\":{},\"pairs\":[",
        to_json(&env!("CARGO_PKG_VERSION")),
        to_json(&model),
        to_json(&ends.map(|(first, last)| [&first.frequency, &last.frequency].map(JsonNumber::number))),
    );
    for (i, &input) in table.inputs.iter().enumerate() {
        for (o, &output) in table.outputs.iter().enumerate() {
            let (from, to) = (&system.inputs[input], &system.outputs[output]);
            let found = table.extrema.as_ref().map(|extrema| &extrema[i][o]);
            let extrema: &[Extremum] = found.map_or(&[], |found| &found.list);
            let pair = JsonPair {
                input: system.display(from.name),
                input_unit: from.unit,
                output: system.display(to.name),
                output_unit: &to.unit,
                complete: found.is_some_and(|found| found.complete.is_some()),
                not_proved_hz: found.map_or(Vec::new(), |found| found.open.iter().map(interval).collect()),
            };
            text += if i + o == 0 { "\n" } else { ",\n" };
            // One extremum or row per line.
            text += to_json(&pair).trim_end_matches('}');
            text += &list("extrema", extrema.iter().map(|extremum| to_json(&json_extremum(extremum))));
            text += &list("values", table.rows.iter().map(|row| to_json(&line(row, row.gains[i][o]))));
            text += "}";
        }
    }
    text + "\n]}\n"
}

fn to_json(value: &impl serde::Serialize) -> String {
    super::json_text(value)
}

fn list(name: &str, lines: impl Iterator<Item = String>) -> String {
    let lines: Vec<String> = lines.map(|line| format!("\n  {line}")).collect();
    format!(",\n \"{name}\":[{}]", lines.join(","))
}

#[derive(serde::Serialize)]
struct JsonPair<'a> {
    input: String,
    input_unit: &'a str,
    output: String,
    output_unit: &'a str,
    /// Whether it is proved that no extremum in the range is missing.
    complete: bool,
    /// Ranges in which it is not proved that there are no further extrema.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    not_proved_hz: Vec<[JsonNumber; 2]>,
}

/// The ends are points of a grid, exact binary64 numbers.
fn interval((from, to): &(f64, f64)) -> [JsonNumber; 2] {
    [from, to].map(|end| JsonNumber::from_enclosure(Ball::from(*end)))
}

#[derive(serde::Serialize)]
struct JsonExtremum {
    kind: &'static str,
    frequency_hz: JsonNumber,
    frequency_error_bound: JsonNumber,
    gain: JsonNumber,
    gain_error_bound: JsonNumber,
    phase_deg: JsonNumber,
    phase_error_bound: JsonNumber,
    #[serde(skip_serializing_if = "JsonNumber::is_null")]
    width_hz: JsonNumber,
    #[serde(skip_serializing_if = "JsonNumber::is_null")]
    width_error_bound: JsonNumber,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    infinite: bool,
}

fn json_extremum(extremum: &Extremum) -> JsonExtremum {
    let relative = |value: Option<Ball>| value.map_or(JsonNumber::NULL, JsonNumber::relative_bound);
    let disc = extremum.gain.disc();
    let gain = disc.map(|disc| disc.gain());
    let [phase_deg, phase_error_bound] = JsonNumber::phase(disc.and_then(|disc| disc.phase()));
    JsonExtremum {
        kind: extremum.kind.name(),
        frequency_hz: JsonNumber::from_enclosure(extremum.frequency),
        frequency_error_bound: JsonNumber::relative_bound(extremum.frequency),
        gain: JsonNumber::of(gain),
        gain_error_bound: relative(gain),
        phase_deg,
        phase_error_bound,
        width_hz: JsonNumber::of(extremum.width),
        width_error_bound: relative(extremum.width),
        infinite: extremum.gain == Gain::Infinite,
    }
}

fn each_line(system: &LinearSystem, table: &Table, mut take: impl FnMut(&str, &str, Line)) {
    let inputs: Vec<String> = table.inputs.iter().map(|&i| system.display(system.inputs[i].name)).collect();
    let outputs: Vec<String> = table.outputs.iter().map(|&i| system.column(&system.outputs[i])).collect();
    for row in &table.rows {
        for (input, gains) in inputs.iter().zip(&row.gains) {
            for (output, gain) in outputs.iter().zip(gains) {
                take(input, output, line(row, *gain));
            }
        }
    }
}

fn line(row: &Row, gain: Gain) -> Line {
    let disc = gain.disc();
    let [re, im] = disc.map_or([JsonNumber::NULL; 2], |disc| disc.parts().map(JsonNumber::from_enclosure));
    let size = disc.map(|disc| disc.gain());
    // 20 log10 of a gain that may be zero has no lower end: its bound is 8.7 times the relative one or more.
    let [gain_db, gain_db_error_bound] = JsonNumber::with_absolute_bound(disc.and_then(|disc| disc.level()), 8.6);
    let [phase_deg, phase_error_bound] = JsonNumber::phase(disc.and_then(|disc| disc.phase()));
    Line {
        frequency_hz: JsonNumber::number(&row.frequency),
        re,
        im,
        gain: JsonNumber::of(size),
        gain_error_bound: size.map_or(JsonNumber::NULL, JsonNumber::relative_bound),
        gain_db,
        gain_db_error_bound,
        phase_deg,
        phase_error_bound,
        error_bound: disc.map_or(JsonNumber::NULL, |disc| JsonNumber::bound(disc.error_bound())),
        infinite: gain == Gain::Infinite,
    }
}

/// The extrema of each pair, or the requested rows, as tables.
pub fn text(model: &str, system: &LinearSystem, table: &Table) -> String {
    report::all_laid_out(&crate::answers::report::transfer(model, system, table), report::WIDTH)
}
