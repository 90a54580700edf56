//! Answers and systems to text and JSON; diagnostics to what people and programs read. Nothing is computed here that an
//! analysis could have computed, and rounding happens nowhere else. See docs/method/report.md and docs/diagnostics.

pub mod bench;
pub mod decimal;
pub mod diagnostics;
pub mod draw;
pub mod emit;
pub mod equations;
pub mod explain;
pub mod json;
mod json_number;
pub mod plot;
pub mod report;
pub mod simulation;
pub mod transfer;

use crate::analysis::Normalise;
use crate::base::readable::escaped;

/// Version of the JSON forms, described in docs/json.md: fields may be added within one, nothing else.
const SCHEMA: u32 = 1;

/// A value as JSON that steers no terminal.
fn json_text(value: &impl serde::Serialize) -> String {
    escaped(serde_json::to_string(value).expect("strings and numbers always have a JSON form"))
}

/// `1, 2, 3, ... 17 more`
fn counted_names(names: &[String]) -> String {
    const MOST: usize = 6;
    match names.len().checked_sub(MOST) {
        Some(more) if more > 1 => format!("{}, {more} more", names[..MOST].join(", ")),
        _ => names.join(", "),
    }
}

/// Options for rendering a modal report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReportOptions {
    pub normalise: Normalise,
    /// The matrices, however large.
    pub matrices: bool,
    /// Digits of frequencies and poles, as many of them as are certain; a handful in the text without it.
    pub digits: Option<u32>,
}

impl ReportOptions {
    /// Digits of a number that shows so many without being asked for more.
    fn digits(&self, usual: usize) -> usize {
        self.digits.map_or(usual, |digits| digits as usize)
    }
}
