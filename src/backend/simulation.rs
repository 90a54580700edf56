//! The motion in time as CSV, JSON and text. See docs/method/response.md.

use super::decimal::{Decimal, certain, certain_digits, certain_number, upper};
use super::json_number::JsonNumber;
use super::report::table::{Align, Table};
use super::transfer::hundredths;
use crate::analysis::{Gain, History, Steady};
use crate::base::{Ball, Dd, Rounded};
use crate::system::{LinearSystem, Output};

const INDENT: usize = 2;
const DIGITS: usize = 6;
const DIGITS_OF_BINARY64: usize = 17;

/// `time_s` and a column for each output, named as in the model; a row a sample. With `bounds` a column `NAME_bound` follows
/// each, the bound of what stands before it; without them only digits that are settled stand there. What is unknown is an empty
/// field.
pub fn csv(system: &LinearSystem, history: &History, bounds: bool) -> String {
    let mut text = b"time_s".to_vec();
    for output in &system.outputs {
        let name = system.display(output.name);
        text.push(b',');
        text.extend_from_slice(name.as_bytes());
        if bounds {
            text.extend_from_slice(format!(",{name}_bound").as_bytes());
        }
    }
    text.push(b'\n');
    for (time, values) in history.times.iter().zip(&history.values) {
        shortest(&mut text, time.to_f64());
        for value in values.iter().map(|sample| if bounds { Rounded::of(*sample) } else { settled(sample) }) {
            text.push(b',');
            if let Some(value) = value {
                shortest(&mut text, value.value());
            }
            if bounds {
                text.push(b',');
                if let Some(value) = value {
                    shortest(&mut text, value.bound());
                }
            }
        }
        text.push(b'\n');
    }
    String::from_utf8(text).expect("names and numbers are text")
}

/// A sample as it is printed without its bound: to the last digit of binary64 where the bound settles that, else to the digits
/// that it settles, and as zero where it settles none. `None` where nothing is known. Beside its bound a sample is printed
/// whole, since what this rounding takes away would widen that.
fn settled(sample: &Ball) -> Option<Rounded> {
    let whole = Rounded::of(*sample)?;
    if whole.bound() <= whole.value().abs() * f64::EPSILON {
        return Some(whole);
    }
    let settled = match certain_digits(sample) {
        0 => 0.0,
        digits => Decimal::round(sample.mid, digits.min(DIGITS_OF_BINARY64)).text().parse().ok()?,
    };
    let away = (sample.mid - Dd::from(settled)).abs().to_f64() * (1.0 + f64::EPSILON);
    Rounded::of(Ball::from(settled).widen((sample.rad + away).next_up()))
}

/// `{"time_s": [...], "outputs": [{"name", "unit", "error_bound", "values": [...], "error_bounds": [...]}]}`: each value with its
/// own bound, absolute, and the largest of these. Under harmonic signals also `"steady_state": [{"output", "frequency_hz",
/// "amplitude", "phase_deg", "error_bound"}]`, the bound relative, in the complex plane.
pub fn json(model: &str, system: &LinearSystem, history: &History, steady: &[Steady]) -> String {
    let outputs: Vec<JsonOutput> = (system.outputs.iter().enumerate())
        .map(|(i, output)| {
            let samples = || history.values.iter().map(|row| row[i]);
            JsonOutput {
                name: system.display(output.name),
                unit: output.unit.clone(),
                error_bound: JsonNumber::bound(worst_error(history, i)),
                values: samples().map(JsonNumber::enclosed).collect(),
                error_bounds: samples().map(JsonNumber::absolute_bound).collect(),
            }
        })
        .collect();
    let report = JsonHistory {
        vibc: env!("CARGO_PKG_VERSION"),
        schema: super::SCHEMA,
        model,
        time_s: history.times.iter().map(JsonNumber::number).collect(),
        outputs,
        steady_state: steady.iter().flat_map(|part| steady_lines(system, part)).collect(),
    };
    super::json_text(&report) + "\n"
}

#[derive(serde::Serialize)]
struct JsonHistory<'a> {
    vibc: &'static str,
    schema: u32,
    model: &'a str,
    time_s: Vec<JsonNumber>,
    outputs: Vec<JsonOutput>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    steady_state: Vec<JsonSteady>,
}

/// What is infinite or unknown is `null`; then `infinite` tells which.
#[derive(serde::Serialize)]
struct JsonSteady {
    output: String,
    frequency_hz: JsonNumber,
    amplitude: JsonNumber,
    phase_deg: JsonNumber,
    error_bound: JsonNumber,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    infinite: bool,
}

fn steady_lines(system: &LinearSystem, part: &Steady) -> Vec<JsonSteady> {
    let line = |(output, gain): (&Output, &Gain)| {
        let disc = gain.disc();
        JsonSteady {
            output: system.display(output.name),
            frequency_hz: JsonNumber::number(&part.frequency),
            amplitude: JsonNumber::of(disc.map(|disc| disc.gain())),
            phase_deg: JsonNumber::of(disc.and_then(|disc| disc.phase())),
            error_bound: disc.map_or(JsonNumber::NULL, |disc| JsonNumber::bound(disc.error_bound())),
            infinite: *gain == Gain::Infinite,
        }
    };
    system.outputs.iter().zip(&part.outputs).map(line).collect()
}

#[derive(serde::Serialize)]
struct JsonOutput {
    name: String,
    unit: String,
    /// `null` where nothing is known of some sample.
    error_bound: JsonNumber,
    values: Vec<JsonNumber>,
    error_bounds: Vec<JsonNumber>,
}

/// The range of each output and where it ends, with the largest error; the steady state where there are harmonic signals.
pub fn text(model: &str, system: &LinearSystem, history: &History, steady: &[Steady]) -> String {
    let until = history.times.last().map_or("0".into(), |time| certain_number(time, DIGITS));
    let mut text = format!("{model} · motion until {until} s, {} samples\n", history.times.len());
    let mut table = Table::new()
        .column("output", "", Align::Left)
        .column("unit", "", Align::Left)
        .column("least", "", Align::Point)
        .column("at [s]", "", Align::Point)
        .column("largest", "", Align::Point)
        .column("at [s]", "", Align::Point)
        .column("at the end", "", Align::Point)
        .column("error ≤", "", Align::Right);
    for (i, output) in system.outputs.iter().enumerate() {
        table.row(cells(system.display(output.name), &output.unit, history, i));
    }
    text += &table.text(INDENT);
    if !steady.is_empty() {
        text += &steady_text(system, steady);
    }
    text
}

fn steady_text(system: &LinearSystem, steady: &[Steady]) -> String {
    let mut table = Table::new()
        .column("output", "", Align::Left)
        .column("unit", "", Align::Left)
        .column("f", "[Hz]", Align::Point)
        .column("amplitude", "", Align::Point)
        .column("phase", "[deg]", Align::Point)
        .column("error ≤", "", Align::Right);
    for part in steady {
        for (output, gain) in system.outputs.iter().zip(&part.outputs) {
            let mut cells =
                vec![system.display(output.name), output.unit.clone(), certain_number(&part.frequency, DIGITS)];
            cells.extend(match gain {
                Gain::Finite(disc) => [
                    certain(&disc.gain(), DIGITS),
                    disc.phase().map_or(String::new(), |phase| hundredths(&phase)),
                    upper(disc.error_bound()),
                ],
                Gain::Infinite => ["infinite", "", "exact"].map(String::from),
                Gain::Unknown => ["?", "", "?"].map(String::from),
            });
            table.row(cells);
        }
    }
    "\n  steady state: amplitude × sin(2π f t + phase), what stays where damping takes the rest away\n".to_string()
        + &table.text(INDENT)
}

fn cells(name: String, unit: &str, history: &History, output: usize) -> Vec<String> {
    let value = |sample: usize| history.values[sample][output];
    let known = || (0..history.values.len()).filter(|&i| value(i).is_finite());
    let by = |better: fn(f64, f64) -> bool| {
        known().reduce(|best, i| if better(value(i).to_f64(), value(best).to_f64()) { i } else { best })
    };
    let time = |sample: usize| certain_number(&history.times[sample], DIGITS);
    let mut cells = vec![name, unit.to_string()];
    for extreme in [by(|a, b| a < b), by(|a, b| a > b)] {
        cells.extend(extreme.map_or(["?".into(), "".into()], |i| [certain(&value(i), DIGITS), time(i)]));
    }
    cells.push(history.values.len().checked_sub(1).map_or(String::new(), |i| certain(&value(i), DIGITS)));
    cells.push(upper(worst_error(history, output)));
    cells
}

/// The largest |printed - true| of an output; infinite where nothing is known of some sample.
fn worst_error(history: &History, output: usize) -> f64 {
    history.values.iter().map(|row| Rounded::bound_of(row[output])).fold(0.0, f64::max)
}

/// Adds the shortest form that reads back the same.
fn shortest(text: &mut Vec<u8>, x: f64) {
    serde_json::to_writer(text, &x).expect("a finite number has a JSON form");
}
