//! Diagnostics for programs: one JSON object per line. Lines and columns from 1, columns in characters.

use super::places::Places;
use super::severity_name;
use crate::backend::json_text;
use crate::base::{Diagnostic, Label, Sources};
use serde::Serialize;

#[derive(Serialize)]
struct Line<'a> {
    code: &'a str,
    severity: &'a str,
    message: &'a str,
    file: &'a str,
    line: usize,
    column: usize,
    end_line: usize,
    end_column: usize,
    /// The text of the label; empty if the message is enough.
    label: &'a str,
    help: Option<&'a str>,
    related: Vec<Related<'a>>,
}

#[derive(Serialize)]
struct Related<'a> {
    message: &'a str,
    file: &'a str,
    line: usize,
    column: usize,
    end_line: usize,
    end_column: usize,
}

/// All diagnostics, one object per line.
pub fn json(sources: &Sources, diagnostics: &[Diagnostic]) -> String {
    let places = Places::new(sources);
    let mut text = String::new();
    for diagnostic in diagnostics {
        let line = line(&places, diagnostic);
        text += &json_text(&line);
        text.push('\n');
    }
    text
}

/// A file that could not be read, in the same form as a diagnostic: code `io`, line 1, column 1.
pub fn unreadable_json(file: &str, reason: &str) -> String {
    let message = format!("cannot read the file: {reason}");
    let (line, column) = (1, 1);
    let object = Line {
        code: "io",
        severity: "error",
        message: &message,
        file,
        line,
        column,
        end_line: line,
        end_column: column,
        label: "",
        help: None,
        related: Vec::new(),
    };
    json_text(&object) + "\n"
}

fn line<'a>(places: &Places<'a>, diagnostic: &'a Diagnostic) -> Line<'a> {
    let span = diagnostic.primary.span;
    let (start, end) = places.positions(span);
    Line {
        code: diagnostic.code.0,
        severity: severity_name(diagnostic.severity),
        message: &diagnostic.message,
        file: &places.sources.file(span.file()).name,
        line: start.line,
        column: start.column,
        end_line: end.line,
        end_column: end.column,
        label: &diagnostic.primary.text,
        help: diagnostic.help.as_deref(),
        related: diagnostic.related.iter().map(|label| related_place(places, label)).collect(),
    }
}

fn related_place<'a>(places: &Places<'a>, label: &'a Label) -> Related<'a> {
    let (start, end) = places.positions(label.span);
    Related {
        message: &label.text,
        file: &places.sources.file(label.span.file()).name,
        line: start.line,
        column: start.column,
        end_line: end.line,
        end_column: end.column,
    }
}
