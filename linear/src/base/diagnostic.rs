//! Diagnostics: facts, a code, one primary place, related places, and a help that says what to type.
//!
//! Every stage has its own error enum next to it. All of them are converted into this form.

use super::source::Span;
use crate::base::OrderBy;
use std::collections::HashMap;
use std::fmt;

/// A stable name of a kind of diagnostic, such as `vib::unit::mismatch`, and what an error of that kind means for the run. Its page
/// is `docs/diagnostics/unit/mismatch.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Code(pub &'static str, Failure);

/// The kind of failure behind an error; decides the exit status.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Failure {
    /// The model is wrong.
    Model,
    /// A file that it names could not be read.
    File,
    /// The model may be right, but a number that it asks for could not be computed.
    Limit,
}

impl Code {
    /// The model is wrong, or worth a remark.
    pub const fn model(name: &'static str) -> Code {
        Code(name, Failure::Model)
    }

    /// A file that the model names could not be read.
    pub const fn file(name: &'static str) -> Code {
        Code(name, Failure::File)
    }

    /// The model may be right, but a number that it asks for could not be computed.
    pub const fn limit(name: &'static str) -> Code {
        Code(name, Failure::Limit)
    }

    /// The kind of failure that an error with this code reports.
    pub const fn failure(self) -> Failure {
        self.1
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

/// The severity. Errors stop the stage; warnings and notes do not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    Error,
    Warning,
    Note,
}

/// A place with a text about it, which may be empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    pub span: Span,
    pub text: String,
}

/// One finding, as it is shown to a user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    pub severity: Severity,
    pub code: Code,
    /// The fact, as one sentence without a full stop.
    pub message: String,
    pub primary: Label,
    /// Other places, such as the other declaration.
    pub related: Vec<Label>,
    /// The help, which says what to type.
    pub help: Option<String>,
    /// Obvious edits of the text, each of which would fix it; the likeliest first.
    pub fixes: Vec<Fix>,
}

/// An edit of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    pub at: Span,
    pub change: Change,
}

/// A change at a place. The editor finds the exact position in the declaration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// Replace it by this; an empty text deletes it.
    Replace(String),
    /// Write this after it.
    After(String),
    /// Write this unit after the number at the end of the enclosing declaration, if it ends with one.
    Unit(String),
    /// Multiply it by this.
    Times(&'static str),
    /// Close the bracket at this place.
    Close(char),
    /// Write this field into the braces of the enclosing declaration.
    AddField(String),
    /// Write this at the end of the enclosing declaration.
    Append(&'static str),
    /// Delete the field that starts here.
    DropField,
    /// Delete the value of the field that starts here.
    DropValue,
    /// Delete the enclosing declaration.
    DropDeclaration,
    /// Rename the declaration at this place, or give it the index of the enclosing `repeat`.
    Rename,
    /// Write this as a separate declaration.
    Declare(&'static str),
}

impl Diagnostic {
    pub fn error(code: Code, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic {
            severity: Severity::Error,
            code,
            message: message.into(),
            primary: Label { span, text: String::new() },
            related: Vec::new(),
            help: None,
            fixes: Vec::new(),
        }
    }

    pub fn warning(code: Code, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic { severity: Severity::Warning, ..Diagnostic::error(code, span, message) }
    }

    pub fn note(code: Code, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic { severity: Severity::Note, ..Diagnostic::error(code, span, message) }
    }

    /// The text shown at the primary place.
    pub fn label(mut self, text: impl Into<String>) -> Diagnostic {
        self.primary.text = text.into();
        self
    }

    pub fn with_related(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.related.push(Label { span, text: text.into() });
        self
    }

    pub fn help(mut self, text: impl Into<String>) -> Diagnostic {
        self.help = Some(text.into());
        self
    }

    /// Adds an edit that would fix it.
    pub fn fix(mut self, at: Span, change: Change) -> Diagnostic {
        self.fixes.push(Fix { at, change });
        self
    }

    /// Adds fields, any of which would fix it.
    pub fn fix_by_field(mut self, at: Span, fields: &[&str]) -> Diagnostic {
        self.fixes.extend(fields.iter().map(|field| Fix { at, change: Change::AddField(field.to_string()) }));
        self
    }

    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }

    /// Whether both say the same, perhaps of different places.
    fn is_like(&self, other: &Diagnostic) -> bool {
        (self.severity, self.code) == (other.severity, other.code)
            && (&self.message, &self.primary.text, &self.help) == (&other.message, &other.primary.text, &other.help)
            && (&self.related, &self.fixes) == (&other.related, &other.fixes)
    }

    /// The same, of other places too.
    fn also_at(mut self, places: &[Span]) -> Diagnostic {
        let shown = &places[..places.len().min(MOST_PLACES)];
        self.related.extend(shown.iter().map(|&span| Label { span, text: "and here".into() }));
        let left = places.len() - shown.len();
        if let Some(last) = self.related.last_mut().filter(|_| left > 0) {
            last.text = format!("and here, and in {left} more {}", if left == 1 { "place" } else { "places" });
        }
        self
    }
}

/// The findings of a run, in the order in which they were reported.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
}

impl Diagnostics {
    pub fn new() -> Diagnostics {
        Diagnostics::default()
    }

    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.list.push(diagnostic);
    }

    pub fn extend(&mut self, other: impl IntoIterator<Item = Diagnostic>) {
        self.list.extend(other);
    }

    /// Turns warnings of this code into errors with this help, if the run cannot continue after them.
    pub fn refuse(&mut self, code: Code, help: &str) {
        for found in self.list.iter_mut().filter(|found| found.code == code) {
            found.severity = Severity::Error;
            found.help = Some(help.into());
        }
    }

    pub fn has_errors(&self) -> bool {
        self.list.iter().any(Diagnostic::is_error)
    }

    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    pub fn iter(&self) -> impl Iterator<Item = &Diagnostic> {
        self.list.iter()
    }

    /// The findings sorted by place, then severity, without exact repetitions, and with one for all uses of what is wrong at its
    /// declaration.
    pub fn into_sorted(mut self) -> Vec<Diagnostic> {
        self.list.order_by(|a, b| {
            (a.primary.span.file(), a.primary.span.start(), a.severity, a.code, &a.message).cmp(&(
                b.primary.span.file(),
                b.primary.span.start(),
                b.severity,
                b.code,
                &b.message,
            ))
        });
        self.list.dedup();
        one_for_each_declaration(self.list)
    }
}

/// Further places that a finding shows when it stands for several.
const MOST_PLACES: usize = 3;

/// Joins findings that differ in nothing but their place and blame the same other one, such as a parameter in the wrong unit
/// that three springs use: the first stands for all, and shows where the others are.
fn one_for_each_declaration(list: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut kept: Vec<(Diagnostic, Vec<Span>)> = Vec::with_capacity(list.len());
    let mut by_cause: HashMap<(Code, Span), Vec<usize>> = HashMap::new();
    for next in list {
        let Some(cause) = next.related.first() else {
            kept.push((next, Vec::new()));
            continue;
        };
        let alike = by_cause.entry((next.code, cause.span)).or_default();
        match alike.iter().find(|&&i| kept[i].0.is_like(&next)) {
            Some(&i) => kept[i].1.push(next.primary.span),
            None => {
                alike.push(kept.len());
                kept.push((next, Vec::new()));
            }
        }
    }
    kept.into_iter().map(|(finding, others)| finding.also_at(&others)).collect()
}

impl IntoIterator for Diagnostics {
    type Item = Diagnostic;
    type IntoIter = std::vec::IntoIter<Diagnostic>;
    fn into_iter(self) -> Self::IntoIter {
        self.list.into_iter()
    }
}
