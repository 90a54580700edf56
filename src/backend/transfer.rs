//! Transfer tables as text, CSV and JSON. Text tells the interesting points of each pair (peaks, antiresonances, half-power
//! widths), or the rows that were asked for; CSV and JSON hold every row. See docs/method/transfer.md.

use super::SCHEMA;
use super::decimal::{Decimal, certain, certain_number, upper};
use super::json_number::JsonNumber;
use super::report::table::{Align, Table as Columns};
use crate::analysis::{Disc, Extrema, Extremum, FeatureKind, Gain, Row, Table};
use crate::base::{Ball, Dd, Number};
use crate::system::LinearSystem;

/// Significant digits of a value in text.
const DIGITS: usize = 6;
/// Rows that the text shows of a grid that was asked for.
const MOST_ROWS: usize = 40;
/// Intervals that the text names where something is not proved.
const MOST_INTERVALS: usize = 3;
const INDENT: usize = 2;

/// A row: one frequency, one pair. What is infinite or unknown is `null`.
#[derive(serde::Serialize)]
struct Line {
    frequency_hz: JsonNumber,
    re: JsonNumber,
    im: JsonNumber,
    gain: JsonNumber,
    gain_db: JsonNumber,
    phase_deg: JsonNumber,
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

/// `{"vibc", "schema", "model", "range_hz", "pairs"}`, for each pair its extrema and the rows of the CSV. Every bound is
/// relative (of a phase: in degrees) and holds for the number that stands there; what is infinite or unknown is `null`.
pub fn json(model: &str, system: &LinearSystem, table: &Table) -> String {
    let ends = table.rows.first().zip(table.rows.last());
    let mut text = format!(
        "{{\"vibc\":{},\"schema\":{SCHEMA},\"model\":{},\"range_hz\":{},\"pairs\":[",
        written(&env!("CARGO_PKG_VERSION")),
        written(&model),
        written(&ends.map(|(first, last)| [&first.frequency, &last.frequency].map(JsonNumber::number))),
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
            // One extremum or row a line.
            text += written(&pair).trim_end_matches('}');
            text += &list("extrema", extrema.iter().map(|extremum| written(&json_extremum(extremum))));
            text += &list("values", table.rows.iter().map(|row| written(&line(row, row.gains[i][o]))));
            text += "}";
        }
    }
    text + "\n]}\n"
}

fn written(value: &impl serde::Serialize) -> String {
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
    /// No extremum in the range is missing.
    complete: bool,
    /// Where it is not proved that there is no other one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    not_proved_hz: Vec<[JsonNumber; 2]>,
}

/// The ends are places on a grid, binary64 numbers themselves.
fn interval((from, to): &(f64, f64)) -> [JsonNumber; 2] {
    [from, to].map(|end| JsonNumber::enclosed(Ball::from(*end)))
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
    let (gain, phase) = (disc.map(|disc| disc.gain()), disc.and_then(|disc| disc.phase()));
    JsonExtremum {
        kind: kind(extremum.kind),
        frequency_hz: JsonNumber::enclosed(extremum.frequency),
        frequency_error_bound: JsonNumber::relative_bound(extremum.frequency),
        gain: JsonNumber::of(gain),
        gain_error_bound: relative(gain),
        phase_deg: JsonNumber::of(phase),
        phase_error_bound: phase.map_or(JsonNumber::NULL, JsonNumber::absolute_bound),
        width_hz: JsonNumber::of(extremum.width),
        width_error_bound: relative(extremum.width),
        infinite: extremum.gain == Gain::Infinite,
    }
}

fn kind(kind: FeatureKind) -> &'static str {
    match kind {
        FeatureKind::Peak => "peak",
        FeatureKind::Antiresonance => "antiresonance",
    }
}

fn each_line(system: &LinearSystem, table: &Table, mut take: impl FnMut(&str, &str, Line)) {
    let inputs: Vec<String> = table.inputs.iter().map(|&i| system.display(system.inputs[i].name)).collect();
    let outputs: Vec<String> = table.outputs.iter().map(|&i| system.display(system.outputs[i].name)).collect();
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
    let part = |of: fn(&Disc) -> Dd| JsonNumber::of(disc.as_ref().map(|disc| Ball::exact(of(disc))));
    Line {
        frequency_hz: JsonNumber::number(&row.frequency),
        re: part(|disc| disc.value.re),
        im: part(|disc| disc.value.im),
        gain: JsonNumber::of(disc.map(|disc| disc.gain())),
        gain_db: JsonNumber::of(disc.and_then(|disc| disc.level())),
        phase_deg: JsonNumber::of(disc.and_then(|disc| disc.phase())),
        error_bound: disc.map_or(JsonNumber::NULL, |disc| JsonNumber::bound(disc.error_bound())),
        infinite: gain == Gain::Infinite,
    }
}

/// The interesting points of each pair, or the rows that were asked for.
pub fn text(model: &str, system: &LinearSystem, table: &Table) -> String {
    let mut text = String::new();
    for (i, &input) in table.inputs.iter().enumerate() {
        for (o, &output) in table.outputs.iter().enumerate() {
            if !text.is_empty() {
                text.push('\n');
            }
            let (from, to) = (&system.inputs[input], &system.outputs[output]);
            let names = (system.display(from.name), system.display(to.name));
            text += &format!("{model} · {} [{}] from {} [{}]", names.1, to.unit, names.0, from.unit);
            text += &range(table);
            text.push('\n');
            text += &match &table.extrema {
                Some(extrema) => points(&extrema[i][o], table, i, o) + &not_proved(&extrema[i][o]),
                None => rows(table, i, o),
            };
        }
    }
    text
}

/// `, 0.1 Hz to 10 Hz`
fn range(table: &Table) -> String {
    let ends = table.rows.first().zip(table.rows.last());
    match ends {
        Some((first, last)) if table.rows.len() > 1 => {
            format!(", {} Hz to {} Hz", hertz(&first.frequency), hertz(&last.frequency))
        }
        _ => String::new(),
    }
}

fn hertz(frequency: &Number) -> String {
    certain_number(frequency, DIGITS)
}

fn columns(kind: bool) -> Columns {
    let columns = if kind { Columns::new().column("", "", Align::Left) } else { Columns::new() };
    let columns = columns
        .column("f", "[Hz]", Align::Point)
        .column("gain", "", Align::Point)
        .column("", "[dB]", Align::Point)
        .column("phase", "[deg]", Align::Point);
    let columns = if kind { columns.column("half-power width", "[Hz]", Align::Point) } else { columns };
    columns.column("error ≤", "", Align::Right)
}

fn points(extrema: &Extrema, table: &Table, input: usize, output: usize) -> String {
    let mut columns = columns(true);
    let ends = [table.rows.first().map(|row| ("low end", row)), table.rows.last().map(|row| ("high end", row))];
    let [low, high] =
        ends.map(|end| end.map(|(name, row)| cells(name, &row.frequency, row.gains[input][output], None)));
    low.into_iter().for_each(|row| columns.row(row));
    for extremum in &extrema.list {
        let frequency = Number::Ball(extremum.frequency);
        columns.row(cells(kind(extremum.kind), &frequency, extremum.gain, extremum.width));
    }
    high.into_iter().for_each(|row| columns.row(row));
    columns.text(INDENT)
}

/// Where there may be more than what is listed.
fn not_proved(extrema: &Extrema) -> String {
    if extrema.complete.is_some() {
        return String::new();
    }
    let interval = |(from, to): &(f64, f64)| format!("{} Hz to {} Hz", short(*from), short(*to));
    let mut intervals: Vec<String> = extrema.open.iter().take(MOST_INTERVALS).map(interval).collect();
    match extrema.open.len().saturating_sub(MOST_INTERVALS) {
        0 => {}
        left => intervals.push(format!("{left} more intervals")),
    }
    let places = if intervals.is_empty() { String::new() } else { format!(" from {}", intervals.join(", ")) };
    format!("{:INDENT$}not proved: that there is no other peak or antiresonance{places}\n", "")
}

fn short(hertz: f64) -> String {
    Decimal::round(Dd::from(hertz), DIGITS).trimmed().text()
}

fn rows(table: &Table, input: usize, output: usize) -> String {
    let mut columns = columns(false);
    for row in table.rows.iter().take(MOST_ROWS) {
        let mut cells = cells("", &row.frequency, row.gains[input][output], None);
        cells.remove(5);
        cells.remove(0);
        columns.row(cells);
    }
    let left = table.rows.len().saturating_sub(MOST_ROWS);
    let more =
        if left > 0 { format!("{:INDENT$}... and {left} more (--format csv has all)\n", "") } else { String::new() };
    columns.text(INDENT) + &more
}

fn cells(kind: &str, frequency: &Number, gain: Gain, width: Option<Ball>) -> Vec<String> {
    let mut cells = vec![kind.to_string(), hertz(frequency)];
    match gain {
        Gain::Infinite => cells.extend(["infinite", "", "", "", "exact"].map(String::from)),
        Gain::Unknown => cells.extend(["?", "", "", "", "?"].map(String::from)),
        Gain::Finite(disc) => cells.extend([
            certain(&disc.gain(), DIGITS),
            disc.level().map_or(String::new(), |level| hundredths(&level)),
            disc.phase().map_or(String::new(), |phase| hundredths(&phase)),
            width.map_or(String::new(), |width| certain(&width, 4)),
            upper(disc.error_bound()),
        ]),
    }
    cells
}

/// Two digits after the point, as levels and angles are read.
pub(super) fn hundredths(value: &Ball) -> String {
    if !value.is_finite() || value.rad > 0.005 {
        return "?".into();
    }
    let steps = (value.mid * 100.0).to_f64().round();
    let (sign, size) = (if steps < 0.0 { "-" } else { "" }, steps.abs() as u64);
    format!("{sign}{}.{:02}", size / 100, size % 100)
}
