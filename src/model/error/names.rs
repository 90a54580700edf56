//! Errors of names, indices, fields and values from outside the model: wrong declarations and references.

use super::{enumeration, error, with_suggestion};
use crate::base::{Change, Code, Diagnostic, Span};
use crate::model::expect::Expected;
use crate::model::scope::DefinitionKind;

/// The code of the count of findings that are not reported one by one.
const MORE: &str = "vib::scene::more_findings";

/// Errors of names and fields.
#[derive(Clone, Debug, PartialEq)]
pub enum NameError {
    UnknownValue { span: Span, word: String, suggestion: Option<String>, help: Option<String> },
    UnknownPart { span: Span, word: String, wanted: &'static str, suggestion: Option<String>, help: Option<String> },
    UnknownFunction { span: Span, word: String, suggestion: Option<String>, help: Option<String> },
    IndexOutOfRange { span: Span, name: String, word: String, given: usize, ranges: Vec<(i32, i32)>, declared: Span },
    TooManyIndices { span: Span },
    NotWhole { span: Span },
    Duplicate { span: Span, name: String, first: Option<Span> },
    Reserved { span: Span, word: String },
    Cycle { span: Span, members: Vec<(String, Span)> },
    TooManyInstances { span: Span, limit: u64, what: &'static str },
    MoreErrors { span: Span, count: usize },
    MoreWarnings { span: Span, count: usize },
    ReversedBounds { span: Span, first: i64, last: i64 },
    NoEqualsSign { span: Span },
    NotToml { span: Span, message: String },
    SettingName { span: Span },
    SettingValue { span: Span },
    UnknownParameter { span: Span, word: String, suggestion: Option<String>, known: Vec<String> },
    NotAParameter { span: Span, word: String, kind: DefinitionKind, declared: Span },
    SettingTwice { span: Span, first: Span, what: &'static str },
    UnknownField { span: Span, word: String, suggestion: Option<&'static str>, known: Vec<&'static str> },
    DirectionApart { span: Span, word: String },
    FieldTwice { span: Span, first: Span, word: String },
    FieldWithoutValue { span: Span, word: String },
    FlagWithValue { span: Span, word: String },
    AboutElsewhere { span: Span },
    FieldMissing { span: Span, expected: Expected },
    NotABody { span: Span, word: String, found: &'static str, declared: Span },
}

impl NameError {
    /// The diagnostic for it.
    pub fn diagnostic(self) -> Diagnostic {
        use NameError::*;
        match self {
            UnknownValue { span, word, suggestion, help } => {
                let message = format!("there is no parameter or point `{word}`");
                let help = help.or_else(|| Some(format!("declare it: `param {word} = ...` or `point {word} = ...`")));
                with_suggestion(error("vib::name::unknown", span, message), suggestion, help)
            }
            UnknownPart { span, word, wanted, suggestion, help } => {
                let message = format!("there is no {wanted} `{word}`");
                let declare = || format!("declare it: `body {word} {{ mass = 1 kg, moves x }}`");
                let help = help.or_else(|| (wanted == "body").then(declare));
                with_suggestion(error("vib::part::unknown", span, message), suggestion, help)
            }
            UnknownFunction { span, word, suggestion, help } => {
                let message = format!("there is no function `{word}`");
                with_suggestion(error("vib::function::unknown", span, message), suggestion, help)
            }
            IndexOutOfRange { span, name, word, given, ranges, declared } => {
                index_out_of_range(span, &name, &word, given, &ranges, declared)
            }
            TooManyIndices { span } => error("vib::index::too_many", span, "a name has at most three indices"),
            NotWhole { span } => error("vib::index::not_whole", span, "a whole number is expected here")
                .help("indices and bounds are whole numbers without a unit, below 2^31"),
            Duplicate { span, name, first } => duplicate(span, &name, first),
            Reserved { span, word } => {
                error("vib::name::reserved", span, format!("`{word}` is a word of the language"))
                    .help("choose another name")
            }
            Cycle { span, members } => cycle(span, &members),
            TooManyInstances { span, limit, what } => {
                error("vib::limit::repeat", span, format!("this makes more than {limit} {what}"))
                    .help("repeat less often, or split the model")
            }
            MoreErrors { span, count } => {
                let errors = if count == 1 { "error" } else { "errors" };
                error(MORE, span, format!("{count} more {errors} in this model")).help("fix the first ones first")
            }
            MoreWarnings { span, count } => {
                let findings = if count == 1 { "warning or note" } else { "warnings and notes" };
                Diagnostic::note(Code::model(MORE), span, format!("{count} more {findings} in this model"))
            }
            ReversedBounds { span, first, last } => {
                error("vib::repeat::reversed", span, "the last value of the index is below the first one")
                    .help(format!("write `{last}..{first}`"))
                    .fix(span, Change::Replace(format!("{last}..{first}")))
            }
            NoEqualsSign { span } => {
                error("vib::setting::form", span, "this is not a setting").help("write `NAME=VALUE`, such as `k=12N/m`")
            }
            NotToml { span, message } => error("vib::setting::toml", span, format!("this is not TOML: {message}"))
                .help("write a line for each parameter, such as `k = \"12 N/m\"`"),
            SettingName { span } => error("vib::setting::form", span, "this is not the name of a parameter")
                .help("write `NAME=VALUE`, such as `k=12N/m` or `k[3]=12N/m`"),
            SettingValue { span } => error("vib::setting::form", span, "a number with its unit is expected here")
                .help("write it as in a model: `12N/m`, `30 Hz`, `2 %`; in TOML in quotes"),
            UnknownParameter { span, word, suggestion, known } => {
                let message = format!("the model has no parameter `{word}`");
                let known: Vec<&str> = known.iter().map(String::as_str).collect();
                let help =
                    if known.is_empty() { "it has none".into() } else { format!("it has {}", enumeration(&known)) };
                with_suggestion(error("vib::setting::unknown", span, message), suggestion, Some(help))
            }
            NotAParameter { span, word, kind, declared } => not_a_parameter(span, &word, kind, declared),
            SettingTwice { span, first, what } => {
                error("vib::setting::duplicate", span, format!("{what} is declared twice"))
                    .with_related(first, "declared first here")
                    .help("keep one of them")
                    .fix(span, Change::DropDeclaration)
            }
            UnknownField { span, word, suggestion, known } => {
                let help = suggestion.is_none().then(|| format!("known here: {}", enumeration(&known)));
                let message = format!("there is no field `{word}` here");
                with_suggestion(error("vib::field::unknown", span, message), suggestion.map(str::to_string), help)
            }
            DirectionApart { span, word } => {
                error("vib::field::unknown", span, format!("there is no field `{word}` here"))
                    .help("write both directions after `moves`, without a comma: `moves x y`")
            }
            FieldTwice { span, first, word } => {
                let help = match &word[..] {
                    "moves" => "keep one of them; both directions together are `moves x y`",
                    _ => "keep one of them",
                };
                error("vib::field::duplicate", span, format!("`{word}` is given twice"))
                    .with_related(first, "given first here")
                    .help(help)
                    .fix(span, Change::DropField)
            }
            FieldWithoutValue { span, word } => error("vib::field::value", span, format!("`{word}` needs a value"))
                .help(format!("write `{word} = ...`")),
            FlagWithValue { span, word } => error("vib::field::value", span, format!("`{word}` takes no value"))
                .help(format!("write `{word}` alone"))
                .fix(span, Change::DropValue),
            AboutElsewhere { span } => error("vib::field::value", span, "`about` belongs to `inertia` only")
                .help("write `inertia = 0.8 kg*m^2 about A`"),
            FieldMissing { span, expected } => {
                error("vib::field::missing", span, format!("{} is missing here", expected.noun))
                    .help(format!("add `{}`", expected.example))
                    .fix_by_field(span, &[expected.example])
            }
            NotABody { span, word, found, declared } => {
                error("vib::part::kind", span, format!("`{word}` is {found}, not a body"))
                    .with_related(declared, "declared here")
                    .help("name a body, a base or `ground`")
            }
        }
    }
}

fn index_out_of_range(
    span: Span,
    name: &str,
    word: &str,
    given: usize,
    ranges: &[(i32, i32)],
    declared: Span,
) -> Diagnostic {
    let diagnostic =
        error("vib::name::index", span, format!("there is no `{name}`")).with_related(declared, "declared here");
    let indices: String = ranges.iter().map(|(low, high)| format!("[{low}..{high}]")).collect();
    match (given == ranges.len(), ranges.is_empty()) {
        (true, _) => diagnostic.help(format!("the declared ones are `{word}{indices}`")),
        (false, true) => diagnostic.help(format!("`{word}` has no index: write `{word}`")),
        (false, false) => diagnostic.help(format!("its indices are `{word}{indices}`")),
    }
}

fn duplicate(span: Span, name: &str, first: Option<Span>) -> Diagnostic {
    let diagnostic = error("vib::name::duplicate", span, format!("`{name}` is declared twice"));
    match first {
        Some(first) if first == span => {
            diagnostic.help(format!("each repetition needs its own name: write `{name}[i]`")).fix(span, Change::Rename)
        }
        Some(first) => diagnostic
            .with_related(first, "declared first here")
            .help("choose another name for one of them")
            .fix(span, Change::Rename),
        None => diagnostic.help("the enclosing `repeat` already uses this index: choose another one"),
    }
}

fn cycle(span: Span, members: &[(String, Span)]) -> Diagnostic {
    /// A longer list would not help.
    const SHOWN: usize = 8;
    let mut names: Vec<String> = members.iter().take(SHOWN).map(|(name, _)| format!("`{name}`")).collect();
    if members.len() > SHOWN {
        names.push("...".into());
    }
    names.extend(members.first().map(|(name, _)| format!("`{name}`")));
    let message = format!("the value depends on itself: {}", names.join(" -> "));
    let mut diagnostic = error("vib::parameter::cycle", span, message).label("closes the cycle");
    for (name, place) in members.iter().take(SHOWN) {
        diagnostic = diagnostic.with_related(*place, format!("`{name}` is declared here"));
    }
    diagnostic.help("give one of them a value that does not depend on the others")
}

fn not_a_parameter(span: Span, word: &str, kind: DefinitionKind, declared: Span) -> Diagnostic {
    let what = if kind == DefinitionKind::Let { "derived: declared with `let`" } else { "a point" };
    error("vib::setting::not_a_parameter", span, format!("`{word}` is not a parameter but {what}"))
        .with_related(declared, "declared here")
        .help("declare it with `param` to give it a value from outside or to solve for it")
}
