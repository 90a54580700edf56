//! Shock response spectra as CSV and JSON, which contain every frequency. See docs/method/shock.md.

use super::SCHEMA;
use super::json_number::JsonNumber;
use super::report;
use crate::analysis::shock::{Quantity, ShockRow};
use crate::answers::{Shock, ShockOf};
use crate::base::Ball;

/// The values in a row, in order.
const VALUES: [&str; 5] = ["maximax", "primary_positive", "primary_negative", "residual_positive", "residual_negative"];

fn values(row: &ShockRow) -> [Ball; 5] {
    let (primary, residual) = (row.primary, row.residual);
    [row.maximax(), primary.positive, primary.negative, residual.positive, residual.negative]
}

/// `frequency_hz,input,` and for each value a column and one with the absolute bound of its error; all values are magnitudes.
pub fn csv(shock: &Shock) -> String {
    let columns: Vec<String> = VALUES.iter().map(|value| format!("{value},{value}_bound")).collect();
    let mut text = format!("frequency_hz,input,{}\n", columns.join(","));
    for of in &shock.list {
        for row in &of.spectrum.rows {
            text += &format!("{},{}", JsonNumber::number(&row.frequency).field(), of.input);
            for value in values(row) {
                let fields =
                    [JsonNumber::from_enclosure(value), JsonNumber::absolute_bound(value)].map(JsonNumber::field);
                text += &format!(",{}", fields.join(","));
            }
            text.push('\n');
        }
    }
    text
}

/// `{"vibc", "schema", "model", "spectra"}`: for each base the rows of the CSV, with absolute bounds.
pub fn json(shock: &Shock) -> String {
    let report = JsonShock {
        vibc: env!("CARGO_PKG_VERSION"),
        schema: SCHEMA,
        model: &shock.model,
        spectra: shock.list.iter().map(spectrum).collect(),
    };
    super::json_text(&report) + "\n"
}

#[derive(serde::Serialize)]
struct JsonShock<'a> {
    vibc: &'static str,
    schema: u32,
    model: &'a str,
    spectra: Vec<JsonSpectrum<'a>>,
}

#[derive(serde::Serialize)]
struct JsonSpectrum<'a> {
    input: &'a str,
    quantity: &'static str,
    unit: &'static str,
    damping_ratio: JsonNumber,
    /// The time of the last event of the signal.
    end_s: JsonNumber,
    frequency_hz: Vec<JsonNumber>,
    #[serde(flatten)]
    columns: Columns,
}

/// For each value, its column and the absolute bounds of its errors.
#[derive(serde::Serialize)]
struct Columns {
    maximax: Vec<JsonNumber>,
    maximax_error_bounds: Vec<JsonNumber>,
    primary_positive: Vec<JsonNumber>,
    primary_positive_error_bounds: Vec<JsonNumber>,
    primary_negative: Vec<JsonNumber>,
    primary_negative_error_bounds: Vec<JsonNumber>,
    residual_positive: Vec<JsonNumber>,
    residual_positive_error_bounds: Vec<JsonNumber>,
    residual_negative: Vec<JsonNumber>,
    residual_negative_error_bounds: Vec<JsonNumber>,
}

fn spectrum(of: &ShockOf) -> JsonSpectrum<'_> {
    let rows = &of.spectrum.rows;
    let column = |place: usize| rows.iter().map(|row| JsonNumber::from_enclosure(values(row)[place])).collect();
    let bounds = |place: usize| rows.iter().map(|row| JsonNumber::absolute_bound(values(row)[place])).collect();
    JsonSpectrum {
        input: &of.input,
        quantity: match of.spectrum.quantity {
            Quantity::PseudoAcceleration => "pseudo_acceleration",
            Quantity::RelativeDisplacement => "relative_displacement",
        },
        unit: of.unit,
        damping_ratio: JsonNumber::number(&of.spectrum.damping),
        end_s: JsonNumber::number(&of.spectrum.end),
        frequency_hz: rows.iter().map(|row| JsonNumber::number(&row.frequency)).collect(),
        columns: Columns {
            maximax: column(0),
            maximax_error_bounds: bounds(0),
            primary_positive: column(1),
            primary_positive_error_bounds: bounds(1),
            primary_negative: column(2),
            primary_negative_error_bounds: bounds(2),
            residual_positive: column(3),
            residual_positive_error_bounds: bounds(3),
            residual_negative: column(4),
            residual_negative_error_bounds: bounds(4),
        },
    }
}

/// Some frequencies of each spectrum as tables.
pub fn text(shock: &Shock) -> String {
    report::all_laid_out(&crate::answers::report::shock(shock), report::WIDTH)
}
