//! The motion in time as CSV and JSON. See docs/method/response.md.

use super::decimal::{Decimal, certain_digits};
use super::json_number::JsonNumber;
use super::report;
use crate::analysis::{Gain, History, Steady, is_passive};
use crate::base::{Ball, Dd, Rounded};
use crate::system::{LinearSystem, Output};

const DIGITS_OF_BINARY64: usize = 17;

/// `time_s` and a column for each output, named as in the model, with its unit if that is not the SI unit; one row for each sample. With `bounds`, each is
/// followed by a column `NAME_bound` with the bound of the value before it; without them, only settled digits are
/// printed. Unknown values are empty fields.
pub fn csv(system: &LinearSystem, history: &History, bounds: bool) -> String {
    let mut text = b"time_s".to_vec();
    for output in &system.outputs {
        text.push(b',');
        text.extend_from_slice(system.column(output).as_bytes());
        if bounds {
            text.extend_from_slice(format!(",{}_bound", system.display(output.name)).as_bytes());
        }
    }
    text.push(b'\n');
    for (time, values) in history.times.iter().zip(&history.values) {
        shortest(&mut text, time.to_f64());
        for value in values.iter().map(|sample| if bounds { Rounded::of(*sample) } else { settle(sample) }) {
            text.push(b',');
            if let Some(value) = value {
                shortest(&mut text, value.value());
            }
            if bounds {
                text.push(b',');
                if let Some(value) = value {
                    shortest(&mut text, value.bound().value());
                }
            }
        }
        text.push(b'\n');
    }
    String::from_utf8(text).expect("names and numbers are text")
}

/// A sample as printed without its bound: to the last digit of binary64 if the bound settles that, otherwise to the
/// digits that it settles, and as zero if it settles none. `None` if nothing is known. Next to its bound a sample is
/// printed in full, because this rounding would widen the bound.
fn settle(sample: &Ball) -> Option<Rounded> {
    let whole = Rounded::of(*sample)?;
    if whole.bound().value() <= whole.value().abs() * f64::EPSILON {
        return Some(whole);
    }
    let settled = match certain_digits(sample) {
        0 => 0.0,
        digits => Decimal::round(sample.mid, digits.min(DIGITS_OF_BINARY64)).text().parse().ok()?,
    };
    let away = (sample.mid - Dd::from(settled)).abs().to_f64() * (1.0 + f64::EPSILON);
    Rounded::of(Ball::from(settled).widen((sample.rad + away).next_up()))
}

/// `{"time_s": [...], "outputs": [{"name", "unit", "error_bound", "values": [...], "error_bounds": [...]}]}`: each
/// value with its own absolute bound, and the largest of these. Under harmonic signals also `"steady_state":
/// [{"output", "frequency_hz", "amplitude", "phase_deg", "error_bound"}]`, where the bound is relative, in the complex
/// plane, and `"nothing_grows"`: whether it is proved that the free motion does not, so that this may remain.
pub fn json(model: &str, system: &LinearSystem, history: &History, steady: &[Steady]) -> String {
    let outputs: Vec<JsonOutput> = (system.outputs.iter().enumerate())
        .map(|(i, output)| {
            let samples = || history.values.iter().map(|row| row[i]);
            JsonOutput {
                name: system.display(output.name),
                unit: output.unit.clone(),
                error_bound: JsonNumber::bound(history.error_bound(i)),
                values: samples().map(JsonNumber::from_enclosure).collect(),
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
        nothing_grows: (!steady.is_empty()).then(|| is_passive(system)),
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
    #[serde(skip_serializing_if = "Option::is_none")]
    nothing_grows: Option<bool>,
}

/// Infinite or unknown values are `null`; then `infinite` says which.
#[derive(serde::Serialize)]
struct JsonSteady {
    output: String,
    frequency_hz: JsonNumber,
    amplitude: JsonNumber,
    phase_deg: JsonNumber,
    phase_error_bound: JsonNumber,
    error_bound: JsonNumber,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    infinite: bool,
}

fn steady_lines(system: &LinearSystem, part: &Steady) -> Vec<JsonSteady> {
    let line = |(output, gain): (&Output, &Gain)| {
        let disc = gain.disc();
        let [phase_deg, phase_error_bound] = JsonNumber::phase(disc.and_then(|disc| disc.phase()));
        JsonSteady {
            output: system.display(output.name),
            frequency_hz: JsonNumber::number(&part.frequency),
            amplitude: JsonNumber::of(disc.map(|disc| disc.gain())),
            phase_deg,
            phase_error_bound,
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
    /// `null` if some sample is unknown.
    error_bound: JsonNumber,
    values: Vec<JsonNumber>,
    error_bounds: Vec<JsonNumber>,
}

/// Adds the shortest form that reads back the same.
fn shortest(text: &mut Vec<u8>, x: f64) {
    serde_json::to_writer(text, &x).expect("a finite number has a JSON form");
}

/// The range of each output and its final value, as a table.
pub fn text(model: &str, system: &LinearSystem, history: &History, steady: &[Steady]) -> String {
    report::laid_out(&crate::answers::report::motion(model, system, history, steady), report::WIDTH)
}
