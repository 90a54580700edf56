//! What is said about a model: facts, a code, one primary place, related places, and what to type.
//!
//! Every stage has an error enum of its own beside it; this is the form that they all turn into.

use super::source::Span;
use std::fmt;

/// A stable name of a kind of diagnostic, such as `vib::unit::mismatch`, and what an error of that kind means for the run. Its page
/// is `docs/diagnostics/unit/mismatch.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Code(pub &'static str, Failure);

/// What has failed where errors were found; decides the exit status.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Failure {
    /// The model is wrong.
    Model,
    /// A file that it names could not be read.
    File,
    /// The model may be right, but a number that it asks for could not be found.
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

    /// The model may be right, but a number that it asks for could not be found.
    pub const fn limit(name: &'static str) -> Code {
        Code(name, Failure::Limit)
    }

    /// What an error with this code says has failed.
    pub const fn failure(self) -> Failure {
        self.1
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }
}

/// How bad it is. Errors stop the stage; warnings and notes do not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    Error,
    Warning,
    Note,
}

/// A place and what is to be seen there. The text may be empty.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    pub span: Span,
    pub text: String,
}

/// One finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    pub severity: Severity,
    pub code: Code,
    /// One sentence without a full stop: the fact.
    pub message: String,
    pub primary: Label,
    /// Where the other one is declared.
    pub related: Vec<Label>,
    /// What to type.
    pub help: Option<String>,
    /// Edits of the text each of which would fix it, where such are obvious; the likeliest first.
    pub fixes: Vec<Fix>,
}

/// An edit of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    pub at: Span,
    pub change: Change,
}

/// What to do at a place. Where the place lies in a declaration is the editor's to find.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// Write this in its place; nothing deletes it.
    Replace(String),
    /// Write this behind it.
    After(String),
    /// Write this unit behind the number that the declaration around it ends with, where it ends with one.
    Unit(String),
    /// Multiply it by this.
    Times(&'static str),
    /// Close the bracket that stands here.
    Close(char),
    /// Write this field into the braces of the declaration around it.
    AddField(String),
    /// Write this at the end of the declaration around it.
    Append(&'static str),
    /// Leave the field out that starts here.
    DropField,
    /// Leave the value of the field out that starts here.
    DropValue,
    /// Leave the declaration around it out.
    DropDeclaration,
    /// Give the declared name that stands here another one, or the index of the `repeat` around it.
    Rename,
    /// Write this as a declaration of its own.
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

    pub fn related(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
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
}

/// The findings of a run, in the order in which they were made.
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

    /// Turns warnings of this code into errors with this help: what they say leaves nothing to go on with.
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

    /// Sorted by place, then severity; exact repetitions removed.
    pub fn sorted(mut self) -> Vec<Diagnostic> {
        self.list.sort_by(|a, b| {
            (a.primary.span.file(), a.primary.span.start(), a.severity, a.code, &a.message).cmp(&(
                b.primary.span.file(),
                b.primary.span.start(),
                b.severity,
                b.code,
                &b.message,
            ))
        });
        self.list.dedup();
        self.list
    }
}

impl IntoIterator for Diagnostics {
    type Item = Diagnostic;
    type IntoIter = std::vec::IntoIter<Diagnostic>;
    fn into_iter(self) -> Self::IntoIter {
        self.list.into_iter()
    }
}
