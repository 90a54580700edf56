//! Diagnostics for people: drawn by miette, from an excerpt of the file that is safe to show.

use super::excerpt::{CONTEXT, Excerpt};
use super::places::Places;
use super::readable::readable;
use crate::base::{Diagnostic, Severity, Sources};
use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, ThemeCharacters, ThemeStyles};
use std::fmt;

/// Findings that are drawn; the rest are counted. Nobody reads a hundred, and the other forms have them all.
pub const MAX_SHOWN: usize = 20;
/// Width at which messages wrap, whatever the terminal: the same bytes everywhere.
const WIDTH: usize = 100;

/// How to draw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HumanStyle {
    pub colour: bool,
    /// Only ASCII characters for the drawing.
    pub ascii: bool,
}

/// The drawings of the first [`MAX_SHOWN`] findings, errors first in doubt, and how many there are of each kind.
pub fn human(sources: &Sources, diagnostics: &[Diagnostic], style: HumanStyle) -> String {
    let places = Places::new(sources);
    let handler = handler(style);
    let mut text = String::new();
    for diagnostic in shown(diagnostics) {
        let drawing = Drawing::new(&places, diagnostic);
        // Writing to a string fails only if the drawing itself does; the short form then still tells the finding.
        if handler.render_report(&mut text, &drawing).is_err() {
            text += &super::short(sources, std::slice::from_ref(diagnostic));
        }
        text.push('\n');
    }
    text + &summary(diagnostics)
}

/// In their order; when there are too many, errors are kept before warnings.
fn shown(diagnostics: &[Diagnostic]) -> Vec<&Diagnostic> {
    let errors = diagnostics.iter().filter(|diagnostic| diagnostic.is_error()).count();
    let others = MAX_SHOWN.saturating_sub(errors);
    let (mut errors_left, mut others_left) = (MAX_SHOWN, others);
    let mut take = |diagnostic: &&Diagnostic| {
        let left = if diagnostic.is_error() { &mut errors_left } else { &mut others_left };
        let taken = *left > 0;
        *left = left.saturating_sub(1);
        taken
    };
    diagnostics.iter().filter(|diagnostic| take(diagnostic)).collect()
}

/// `2 errors, 1 warning`, with what was left out.
fn summary(diagnostics: &[Diagnostic]) -> String {
    if diagnostics.is_empty() {
        return String::new();
    }
    let count = |severity| diagnostics.iter().filter(|diagnostic| diagnostic.severity == severity).count();
    let kinds = [(Severity::Error, "error"), (Severity::Warning, "warning"), (Severity::Note, "note")];
    let counts: Vec<String> = kinds
        .iter()
        .map(|(severity, word)| (count(*severity), word))
        .filter(|(count, _)| *count > 0)
        .map(|(count, word)| if count == 1 { format!("1 {word}") } else { format!("{count} {word}s") })
        .collect();
    match diagnostics.len().checked_sub(MAX_SHOWN) {
        None | Some(0) => format!("{}\n", counts.join(", ")),
        Some(left) => {
            format!("and {left} more: {} in all (`--message-format short` lists every one)\n", counts.join(", "))
        }
    }
}

fn handler(style: HumanStyle) -> GraphicalReportHandler {
    let characters = if style.ascii { ThemeCharacters::ascii() } else { ThemeCharacters::unicode() };
    let styles = if style.colour { ThemeStyles::ansi() } else { ThemeStyles::none() };
    GraphicalReportHandler::new_themed(GraphicalTheme { characters, styles })
        .with_links(false)
        .with_width(WIDTH)
        .with_context_lines(CONTEXT)
        .without_cause_chain()
}

/// A diagnostic as miette takes it.
#[derive(Debug)]
struct Drawing {
    severity: Severity,
    code: &'static str,
    message: String,
    help: Option<String>,
    excerpt: Excerpt,
}

impl Drawing {
    fn new(places: &Places, diagnostic: &Diagnostic) -> Drawing {
        Drawing {
            severity: diagnostic.severity,
            code: diagnostic.code.0,
            message: readable(&diagnostic.message).into_owned(),
            help: diagnostic.help.as_deref().map(readable_lines),
            excerpt: Excerpt::new(places, diagnostic),
        }
    }
}

/// Line by line: a help text may hold several.
fn readable_lines(text: &str) -> String {
    text.split('\n').map(readable).collect::<Vec<_>>().join("\n")
}

impl fmt::Display for Drawing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Drawing {}

impl miette::Diagnostic for Drawing {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.code))
    }

    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.severity {
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
            Severity::Note => miette::Severity::Advice,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display + 'a>)
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        Some(&self.excerpt)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.excerpt.labels()))
    }
}
