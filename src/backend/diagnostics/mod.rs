//! Diagnostics in three forms: for people (miette), for programs (one JSON object a line), and one short line each.
//! See docs/diagnostics.

mod excerpt;
mod human;
mod json;
mod places;

pub use human::{HumanStyle, MAX_SHOWN, human};
pub use json::{json, unreadable_json};

pub use crate::base::readable::readable;

use crate::base::{Diagnostic, Severity, Sources};
use places::Places;

/// One line for each diagnostic: `file:line:column: severity[code]: message`.
pub fn short(sources: &Sources, diagnostics: &[Diagnostic]) -> String {
    let places = Places::new(sources);
    let mut text = String::new();
    for diagnostic in diagnostics {
        let span = diagnostic.primary.span;
        let (start, _) = places.positions(span);
        let file = readable(&sources.file(span.file()).name);
        let (severity, code) = (severity_name(diagnostic.severity), diagnostic.code);
        let message = readable(&diagnostic.message);
        text += &format!("{file}:{}:{}: {severity}[{code}]: {message}\n", start.line, start.column);
    }
    text
}

fn severity_name(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    }
}
