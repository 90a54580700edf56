//! Errors in a model: facts, and the diagnostics for them. Each variant has one code, one primary place, and a help that
//! says what to type. See docs/diagnostics.

mod belts;
mod laws;
mod names;
mod parts;
mod places;
mod questions;
mod tolerances;
mod values;

pub use belts::BeltError;
pub use laws::LawError;
pub use names::NameError;
pub use parts::{PartError, RowFault, TABLE_UNREADABLE};
pub use places::{PlaceError, kind_with_article};
pub use questions::QuestionError;
pub use tolerances::ToleranceError;
pub use values::ValueError;

use super::scope::DefinitionKind;
use crate::base::{Change, Code, Diagnostic, Dimension, Span};

/// A finding of the check.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    Value(ValueError),
    Name(NameError),
    Part(PartError),
    Law(LawError),
    Belt(BeltError),
    Place(PlaceError),
    Question(QuestionError),
    Tolerance(ToleranceError),
}

impl Error {
    /// The diagnostic for it.
    pub fn diagnostic(self) -> Diagnostic {
        match self {
            Error::Value(error) => error.diagnostic(),
            Error::Name(error) => error.diagnostic(),
            Error::Part(error) => error.diagnostic(),
            Error::Law(error) => error.diagnostic(),
            Error::Belt(error) => error.diagnostic(),
            Error::Place(error) => error.diagnostic(),
            Error::Question(error) => error.diagnostic(),
            Error::Tolerance(error) => error.diagnostic(),
        }
    }
}

impl From<ValueError> for Error {
    fn from(error: ValueError) -> Error {
        Error::Value(error)
    }
}

impl From<ToleranceError> for Error {
    fn from(error: ToleranceError) -> Error {
        Error::Tolerance(error)
    }
}

impl From<NameError> for Error {
    fn from(error: NameError) -> Error {
        Error::Name(error)
    }
}

impl From<PartError> for Error {
    fn from(error: PartError) -> Error {
        Error::Part(error)
    }
}

impl From<BeltError> for Error {
    fn from(error: BeltError) -> Error {
        Error::Belt(error)
    }
}

impl From<LawError> for Error {
    fn from(error: LawError) -> Error {
        Error::Law(error)
    }
}

impl From<PlaceError> for Error {
    fn from(error: PlaceError) -> Error {
        Error::Place(error)
    }
}

impl From<QuestionError> for Error {
    fn from(error: QuestionError) -> Error {
        Error::Question(error)
    }
}

fn error(code: &'static str, span: Span, message: impl Into<String>) -> Diagnostic {
    Diagnostic::error(Code::model(code), span, message)
}

fn with_suggestion(diagnostic: Diagnostic, suggestion: Option<String>, help: Option<String>) -> Diagnostic {
    match (suggestion, help) {
        (Some(word), _) => {
            let at = diagnostic.primary.span;
            diagnostic.help(format!("did you mean `{word}`?")).fix(at, Change::Replace(word))
        }
        (None, Some(help)) => diagnostic.help(help),
        (None, None) => diagnostic,
    }
}

/// `mass`, `moves`, `at`
fn enumeration(words: &[&str]) -> String {
    words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ")
}

/// Five digits, enough for a reader.
fn short(value: f64) -> String {
    let rounded = format!("{value:.4e}").parse::<f64>().unwrap_or(value);
    let is_plain = rounded == 0.0 || (1e-9..1e16).contains(&rounded.abs());
    if is_plain { rounded.to_string() } else { format!("{rounded:e}") }
}

fn name_phrase(dimension: Dimension) -> String {
    dimension.noun().map_or_else(|| format!("a quantity in {dimension}"), str::to_string)
}

fn unit_or_none(dimension: Dimension) -> String {
    let unit = dimension.usual_unit();
    if unit.is_empty() { "no unit".into() } else { unit }
}

fn kind_noun(kind: DefinitionKind) -> &'static str {
    match kind {
        DefinitionKind::Param => "parameter",
        DefinitionKind::Let => "value",
        DefinitionKind::Point => "point",
    }
}
