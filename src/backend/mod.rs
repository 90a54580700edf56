//! Reports and systems as text, Markdown and JSON, and diagnostics for people and programs. Anything that an analysis
//! could compute is computed there, and numbers are rounded only here. See docs/method/report.md and docs/diagnostics.

pub mod bench;
pub mod decimal;
pub mod diagnostics;
pub mod draw;
pub mod emit;
pub mod equations;
pub mod explain;
pub mod json;
mod json_number;
mod json_questions;
mod json_spectra;
pub mod markdown;
pub mod npz;
pub mod page;
mod plain;
pub mod plot;
pub mod report;
pub mod shock;
pub mod simulation;
pub mod sweep;
mod tolerated;
pub mod transfer;

pub use crate::answers::report::Options as ReportOptions;
use crate::base::readable::escape;

/// Version of the JSON formats, described in docs/json.md: within a version, fields may only be added.
const SCHEMA: u32 = 1;

/// A value as JSON without characters that control a terminal.
fn json_text(value: &impl serde::Serialize) -> String {
    escape(serde_json::to_string(value).expect("strings and numbers always have a JSON form"))
}
