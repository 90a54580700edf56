//! Transfer tables as text, CSV and JSON. Text tells the interesting points of each pair (peaks, antiresonances, half-power
//! widths), or the rows that were asked for; CSV and JSON hold every row. Clause: spec.md, "Transfer".

use super::decimal::{Decimal, certain, certain_number, upper};
use super::report::table::{Align, Table as Columns};
use crate::analysis::{Disc, Feature, FeatureKind, Gain, Row, Table};
use crate::base::{Ball, Dd, Number};
use crate::system::LinearSystem;

/// Significant digits of a value in text.
const DIGITS: usize = 6;
/// Rows that the text shows of a grid that was asked for.
const MOST_ROWS: usize = 40;
const INDENT: usize = 2;

/// A row of the CSV: one frequency, one pair. What is infinite or unknown is `None`.
#[derive(serde::Serialize)]
struct Line<'a> {
    frequency_hz: f64,
    input: &'a str,
    output: &'a str,
    re: Option<f64>,
    im: Option<f64>,
    gain: Option<f64>,
    gain_db: Option<f64>,
    phase_deg: Option<f64>,
    error_bound: Option<f64>,
    #[serde(skip)]
    infinite: bool,
}

/// `frequency_hz,input,output,re,im,gain,gain_db,phase_deg,error_bound` and a row for each frequency and pair. Empty fields
/// are unknown; an infinite gain is `inf`.
pub fn csv(system: &LinearSystem, table: &Table) -> String {
    let mut text = String::from("frequency_hz,input,output,re,im,gain,gain_db,phase_deg,error_bound\n");
    each_line(system, table, |line| {
        let gain = |value: Option<f64>| if line.infinite { "inf".to_string() } else { field(value) };
        let fields = [
            shortest(line.frequency_hz),
            line.input.to_string(),
            line.output.to_string(),
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

/// The rows of the CSV as an array of objects, one a line; what is infinite or unknown is `null`.
pub fn json(system: &LinearSystem, table: &Table) -> String {
    let mut lines = Vec::new();
    each_line(system, table, |line| {
        lines.push(super::json_text(&line));
    });
    format!("[\n{}\n]\n", lines.join(",\n"))
}

fn each_line(system: &LinearSystem, table: &Table, mut take: impl FnMut(Line)) {
    let inputs: Vec<String> = table.inputs.iter().map(|&i| system.display(system.inputs[i].name)).collect();
    let outputs: Vec<String> = table.outputs.iter().map(|&i| system.display(system.outputs[i].name)).collect();
    for row in &table.rows {
        for (input, gains) in inputs.iter().zip(&row.gains) {
            for (output, gain) in outputs.iter().zip(gains) {
                take(line(row, input, output, *gain));
            }
        }
    }
}

fn line<'a>(row: &Row, input: &'a str, output: &'a str, gain: Gain) -> Line<'a> {
    let finite = |x: f64| Some(x + 0.0).filter(|x| x.is_finite());
    let disc = gain.disc();
    let size = disc.map(|disc| disc.gain());
    Line {
        frequency_hz: row.frequency.to_f64(),
        input,
        output,
        re: disc.and_then(|disc| finite(disc.value.re.to_f64())),
        im: disc.and_then(|disc| finite(disc.value.im.to_f64())),
        gain: size.and_then(|size| finite(size.to_f64())),
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

/// Bound of |printed - true| / |true| in the complex plane, for the two binary64 numbers printed.
pub(super) fn error_bound(disc: &Disc) -> f64 {
    let lost = |x: Dd| (x - Dd::from(x.to_f64())).abs().to_f64();
    let size = disc.value.to_f64().abs();
    let rounding = lost(disc.value.re) + lost(disc.value.im);
    if disc.radius == 0.0 && rounding == 0.0 {
        return 0.0;
    }
    (disc.relative_error() + rounding / size) * (1.0 + 1e-12)
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
            let features: Vec<&Feature> = table.features.iter().filter(|f| (f.input, f.output) == (i, o)).collect();
            text += &if table.refined { points(&features, table, i, o) } else { rows(table, i, o) };
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

fn points(features: &[&Feature], table: &Table, input: usize, output: usize) -> String {
    let mut columns = columns(true);
    let ends = [table.rows.first().map(|row| ("low end", row)), table.rows.last().map(|row| ("high end", row))];
    let [low, high] =
        ends.map(|end| end.map(|(name, row)| cells(name, &row.frequency, row.gains[input][output], None)));
    low.into_iter().for_each(|row| columns.row(row));
    for feature in features {
        let kind = match feature.kind {
            FeatureKind::Peak => "peak",
            FeatureKind::Antiresonance => "antiresonance",
        };
        columns.row(cells(kind, &feature.frequency, feature.gain, feature.half_power));
    }
    high.into_iter().for_each(|row| columns.row(row));
    columns.text(INDENT)
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

fn cells(kind: &str, frequency: &Number, gain: Gain, half_power: Option<(f64, f64)>) -> Vec<String> {
    let mut cells = vec![kind.to_string(), hertz(frequency)];
    match gain {
        Gain::Infinite => cells.extend(["infinite", "", "", "", "exact"].map(String::from)),
        Gain::Unknown => cells.extend(["?", "", "", "", "?"].map(String::from)),
        Gain::Finite(disc) => cells.extend([
            certain(&disc.gain(), DIGITS),
            decibel(disc.gain()).map_or(String::new(), |level| hundredths(&level)),
            phase(disc).map_or(String::new(), |phase| hundredths(&phase)),
            half_power.map_or(String::new(), |(low, high)| Decimal::round(Dd::from(high) - Dd::from(low), 4).text()),
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
