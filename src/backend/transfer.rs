//! Transfer tables as text, CSV and JSON. Text tells the interesting points of each pair (peaks, antiresonances, half-power
//! widths), or the rows that were asked for; CSV and JSON hold every row. Clause: spec.md, "Transfer".

use super::decimal::{Decimal, certain, certain_number, upper};
use super::report::table::{Align, Table as Columns};
use crate::analysis::{Disc, Extrema, Extremum, FeatureKind, Gain, Row, Table};
use crate::base::{Ball, Dd, Number, Rounded};
use crate::system::LinearSystem;

/// Significant digits of a value in text.
const DIGITS: usize = 6;
/// Rows that the text shows of a grid that was asked for.
const MOST_ROWS: usize = 40;
/// Intervals that the text names where something is not proved.
const MOST_INTERVALS: usize = 3;
/// Of the JSON's fields.
const SCHEMA: u32 = 1;
const INDENT: usize = 2;

/// A row: one frequency, one pair. What is infinite or unknown is `None`.
#[derive(serde::Serialize)]
struct Line {
    frequency_hz: f64,
    re: Option<f64>,
    im: Option<f64>,
    gain: Option<f64>,
    gain_db: Option<f64>,
    phase_deg: Option<f64>,
    error_bound: Option<f64>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    infinite: bool,
}

/// `frequency_hz,input,output,re,im,gain,gain_db,phase_deg,error_bound` and a row for each frequency and pair. Empty fields
/// are unknown; an infinite gain is `inf`.
pub fn csv(system: &LinearSystem, table: &Table) -> String {
    let mut text = String::from("frequency_hz,input,output,re,im,gain,gain_db,phase_deg,error_bound\n");
    each_line(system, table, |input, output, line| {
        let gain = |value: Option<f64>| if line.infinite { "inf".to_string() } else { field(value) };
        let fields = [
            shortest(line.frequency_hz),
            input.to_string(),
            output.to_string(),
            field(line.re),
            field(line.im),
            gain(line.gain),
            gain(line.gain_db),
            field(line.phase_deg),
            field(line.error_bound),
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
        written(&ends.map(|(first, last)| [first.frequency.to_f64(), last.frequency.to_f64()])),
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
                not_proved_hz: found.map_or(&[], |found| &found.open),
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
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    not_proved_hz: &'a [(f64, f64)],
}

#[derive(serde::Serialize)]
struct JsonExtremum {
    kind: &'static str,
    frequency_hz: Option<f64>,
    frequency_error_bound: Option<f64>,
    gain: Option<f64>,
    gain_error_bound: Option<f64>,
    phase_deg: Option<f64>,
    phase_error_bound: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    width_hz: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    width_error_bound: Option<f64>,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    infinite: bool,
}

fn json_extremum(extremum: &Extremum) -> JsonExtremum {
    let relative = |told: Option<Rounded>| told.map(Rounded::relative_bound).filter(|bound| bound.is_finite());
    let value = |told: Option<Rounded>| told.map(Rounded::value);
    let disc = extremum.gain.disc();
    let frequency = Rounded::of(extremum.frequency);
    let gain = disc.and_then(|disc| Rounded::of(disc.gain()));
    let phase = disc.and_then(phase).and_then(Rounded::of);
    let width = extremum.width.and_then(Rounded::of);
    JsonExtremum {
        kind: kind(extremum.kind),
        frequency_hz: value(frequency),
        frequency_error_bound: relative(frequency),
        gain: value(gain),
        gain_error_bound: relative(gain),
        phase_deg: value(phase),
        phase_error_bound: phase.map(Rounded::bound),
        width_hz: value(width),
        width_error_bound: relative(width),
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
    let finite = |x: f64| Some(x + 0.0).filter(|x| x.is_finite());
    let disc = gain.disc();
    let size = disc.map(|disc| disc.gain());
    Line {
        frequency_hz: row.frequency.to_f64(),
        re: disc.and_then(|disc| finite(disc.value.re.to_f64())),
        im: disc.and_then(|disc| finite(disc.value.im.to_f64())),
        gain: size.and_then(Rounded::of).map(Rounded::value),
        gain_db: size.and_then(decibel).and_then(|level| finite(level.to_f64())),
        phase_deg: disc.and_then(phase).and_then(|phase| finite(phase.to_f64())),
        error_bound: disc.and_then(|disc| finite(error_bound(&disc))),
        infinite: gain == Gain::Infinite,
    }
}

/// 20 log10 of a gain.
pub fn decibel(gain: Ball) -> Option<Ball> {
    let midpoint = Number::Ball(Ball::exact(gain.mid));
    let level = (&midpoint.ln()? / &Number::from(10).ln()?).to_ball() * Ball::from(20.0);
    // d(20 log10 g) = 8.69 dg / g, and a little more for a wide ball.
    Some(level.widen(8.7 * gain.relative_error().min(1e300)))
}

/// The angle of a value in degrees, in (-180, 180].
pub fn phase(disc: Disc) -> Option<Ball> {
    let (re, im) = (Number::Ball(Ball::exact(disc.value.re)), Number::Ball(Ball::exact(disc.value.im)));
    let turned = Number::atan2(&im, &re)?.to_ball() * Ball::from(180.0) / Ball::PI;
    // asin of the relative radius, in degrees: less than 90 times it.
    Some(turned.widen(90.0 * disc.relative_error().min(1e300)))
}

/// Bound of |printed - true| / |true| for the numbers printed: the two parts in the complex plane, and the size.
pub(super) fn error_bound(disc: &Disc) -> f64 {
    let part = |x: Dd| Rounded::of(Ball::exact(x)).map_or(f64::INFINITY, Rounded::bound);
    let size = disc.value.to_f64().abs() * (1.0 - 1e-15) - disc.radius;
    let lost = disc.radius + part(disc.value.re) + part(disc.value.im);
    let in_the_plane = match (lost, size) {
        (0.0, _) => 0.0,
        (_, size) if size > 0.0 => lost / size * (1.0 + 1e-12),
        _ => f64::INFINITY,
    };
    in_the_plane.max(amplitude(disc).map_or(f64::INFINITY, Rounded::relative_bound))
}

/// The size of a value as it is printed.
pub(super) fn amplitude(disc: &Disc) -> Option<Rounded> {
    Rounded::of(disc.gain())
}

/// The shortest text that reads back the same.
fn shortest(x: f64) -> String {
    serde_json::to_string(&x).expect("a finite number has a JSON form")
}

fn field(value: Option<f64>) -> String {
    value.map_or(String::new(), shortest)
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
            decibel(disc.gain()).map_or(String::new(), |level| hundredths(&level)),
            phase(disc).map_or(String::new(), |phase| hundredths(&phase)),
            width.map_or(String::new(), |width| certain(&width, 4)),
            upper(error_bound(&disc)),
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
