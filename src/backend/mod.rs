//! Reports and systems to text, Markdown and JSON; diagnostics to what people and programs read. Nothing is computed here that
//! an analysis could have computed, and rounding happens nowhere else. See docs/method/report.md and docs/diagnostics.

pub mod bench;
pub mod decimal;
pub mod diagnostics;
pub mod draw;
pub mod emit;
pub mod equations;
pub mod explain;
pub mod json;
mod json_number;
pub mod markdown;
mod plain;
pub mod plot;
pub mod report;
pub mod simulation;
pub mod transfer;

pub use crate::answers::report::Options as ReportOptions;
use crate::base::readable::escaped;

/// Version of the JSON forms, described in docs/json.md: fields may be added within one, nothing else.
const SCHEMA: u32 = 1;

/// A value as JSON that steers no terminal.
fn json_text(value: &impl serde::Serialize) -> String {
    escaped(serde_json::to_string(value).expect("strings and numbers always have a JSON form"))
}
