//! Diagnostics for people: drawn by miette, from an excerpt of the file that is safe to show.

use super::excerpt::{CONTEXT, Excerpt};
use super::places::Places;
use super::severity_name;
use crate::base::readable::readable;
use crate::base::{Diagnostic, Severity, Sources};
use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan, ThemeCharacters, ThemeStyles};
use std::fmt;
use textwrap::{WordSeparator, WordSplitter};

/// Maximum number of findings that are drawn; the others are only counted. Nobody reads a hundred, and the other
/// formats contain all of them.
pub const MAX_SHOWN: usize = 20;
/// Width at which messages wrap, whatever the terminal: the output is the same everywhere.
const WIDTH: usize = 100;

/// Options of the drawing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HumanStyle {
    pub colour: bool,
    /// Whether to draw with ASCII characters only.
    pub ascii: bool,
}

/// Draws the first findings (errors before warnings if there are too many), and counts those of each severity.
pub fn human(sources: &Sources, diagnostics: &[Diagnostic], style: HumanStyle) -> String {
    let places = Places::new(sources);
    let handler = handler(style);
    let mut text = String::new();
    for diagnostic in select_shown(diagnostics) {
        let drawing = Drawing::new(&places, diagnostic);
        // Writing to a string fails only if the drawing itself does; the short form then still reports the finding.
        if handler.render_report(&mut text, &drawing).is_err() {
            text += &super::short(sources, std::slice::from_ref(diagnostic));
        }
        text.push('\n');
    }
    text + &summary(diagnostics)
}

/// The findings in their order; if there are too many, errors are kept before warnings.
fn select_shown(diagnostics: &[Diagnostic]) -> Vec<&Diagnostic> {
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

/// `2 errors, 1 warning`, and how many were omitted.
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
        // Only at spaces, so that `1/s` and `N^2/Hz` stay whole.
        .with_word_separator(WordSeparator::AsciiSpace)
        .with_word_splitter(WordSplitter::NoHyphenation)
        .with_context_lines(CONTEXT)
        .without_cause_chain()
}

/// A diagnostic in the form that miette draws.
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

/// Makes a text readable line by line: a help text may have several lines.
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
    /// `error[vib::part::unknown]`: the command line's errors begin with the same word.
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(format!("{}[{}]", severity_name(self.severity), self.code)))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::{Code, FileId, SourceFile, SourceKind, Span};
    use proptest::prelude::*;

    const CODE: Code = Code::model("a::code");

    fn sources(text: &str) -> Sources {
        let mut sources = Sources::new();
        sources.add(SourceFile::model("cart.vib", text));
        sources
    }

    fn at(text: &str, what: &str) -> Span {
        let start = text.find(what).expect("the text holds it");
        Span::new(FileId(0), start, start + what.len())
    }

    fn draw_one(text: &str, diagnostic: Diagnostic) -> String {
        human(&sources(text), &[diagnostic], HumanStyle::default())
    }

    #[test]
    fn a_place_and_where_the_other_one_is() {
        let text = "model cart\nparam m1 = 1 kg\nbody b { moves x }\n\n\nspring s: ground -- b { k = m1 }\n";
        let diagnostic = Diagnostic::error(CODE, at(text, "m1 }"), "a stiffness is expected here, this is a mass")
            .label("kg")
            .with_related(at(text, "m1"), "declared here")
            .help("write a stiffness, such as `k = 10 N/m`");
        insta::assert_snapshot!(draw_one(text, diagnostic));
    }

    #[test]
    fn a_hostile_line_cannot_steer_the_terminal() {
        let text = "param a\u{1b}[2J = 1 kg // \u{202e}gnirps\n\tbody\tω { }\r\n";
        let diagnostic =
            Diagnostic::warning(CODE, at(text, "ω"), "the name \u{1b}]0;x\u{7} is odd").label("here\u{9b}");
        insta::assert_snapshot!(draw_one(text, diagnostic));
    }

    #[test]
    fn a_long_line_is_clipped_around_the_place() {
        let text =
            format!("// {}\nparam x = {}", "é".repeat(300), "1 + ".repeat(100_000)) + "oops" + &" + 2".repeat(1000);
        let diagnostic =
            Diagnostic::error(CODE, at(&text, "oops"), "unknown name").with_related(at(&text, "x"), "needed here");
        insta::assert_snapshot!(draw_one(&text, diagnostic));
    }

    #[test]
    fn the_end_of_a_file_has_a_place() {
        let text = "body b {\n";
        let end = Span::new(FileId(0), text.len(), text.len());
        let diagnostic =
            Diagnostic::error(CODE, end, "the file ends inside a brace").with_related(at(text, "{"), "opened here");
        insta::assert_snapshot!(draw_one(text, diagnostic));
    }

    #[test]
    fn an_empty_file_has_a_place() {
        insta::assert_snapshot!(draw_one("", Diagnostic::error(CODE, Span::new(FileId(0), 0, 0), "the file is empty")));
    }

    #[test]
    fn a_place_over_many_lines_is_shown_by_its_first() {
        let text = "repeat i in 1..9 {\n".to_string() + &"  param a[i] = 1\n".repeat(40) + "}\n";
        let few = Diagnostic::error(CODE, Span::new(FileId(0), 19, 60), "three lines").label("all of this");
        let many = Diagnostic::error(CODE, Span::new(FileId(0), 0, text.len()), "many lines").label("all of this");
        insta::assert_snapshot!(human(&sources(&text), &[few, many], HumanStyle::default()));
    }

    #[test]
    fn places_in_two_files() {
        let mut sources = sources("model a\nparam k = 1 N/m\n");
        let arguments = SourceFile { kind: SourceKind::Arguments, ..SourceFile::model("--set", "j=1\nk=3kg\n") };
        let file = sources.add(arguments);
        let diagnostic = Diagnostic::error(CODE, Span::new(file, 6, 9), "a stiffness is expected here, this is a mass")
            .with_related(Span::new(FileId(0), 14, 15), "declared here as a stiffness");
        insta::assert_snapshot!(human(&sources, &[diagnostic], HumanStyle { ascii: true, colour: false }));
    }

    #[test]
    fn of_too_many_the_errors_are_drawn_and_the_rest_counted() {
        let text = "x\n".repeat(100);
        let finding = |i: usize| {
            let span = Span::new(FileId(0), 2 * i, 2 * i + 1);
            if i % 10 == 9 { Diagnostic::error(CODE, span, "wrong") } else { Diagnostic::warning(CODE, span, "unused") }
        };
        let all: Vec<Diagnostic> = (0..100).map(finding).collect();
        let drawn = human(&sources(&text), &all, HumanStyle::default());
        assert_eq!(drawn.matches("wrong").count(), 10);
        assert_eq!(drawn.matches("unused").count(), MAX_SHOWN - 10);
        assert!(
            drawn.ends_with("and 80 more: 10 errors, 90 warnings in all (`--message-format short` lists every one)\n")
        );
    }

    #[test]
    fn colour_is_only_where_it_is_asked_for() {
        let diagnostic = Diagnostic::error(CODE, Span::new(FileId(0), 0, 1), "wrong");
        let coloured =
            human(&sources("x"), std::slice::from_ref(&diagnostic), HumanStyle { colour: true, ascii: false });
        assert!(coloured.contains('\u{1b}'));
        assert!(!draw_one("x", diagnostic).contains('\u{1b}'));
    }

    /// Characters that have broken drawings: line ends of every kind, tabs, wide, combining and control characters.
    const PIECES: [&str; 12] =
        ["a", "k = ", "\n", "\r\n", "\r", "\t", "ω", "質量", "e\u{301}", "\u{1b}[2J", "\u{202e}", "\u{1f9ea}"];

    proptest! {
        /// Places may be anywhere, even inside a character or beyond the end.
        #[test]
        fn any_place_in_any_text_can_be_drawn(
            pieces in prop::collection::vec(0..PIECES.len(), 0..60),
            places in prop::collection::vec((0usize..200, 0usize..90), 1..5),
            repeated in 1usize..40,
        ) {
            let text: String = pieces.iter().map(|piece| PIECES[*piece]).collect::<String>().repeat(repeated);
            let span = |(start, len): &(usize, usize)| {
                let start = (*start).min(text.len());
                Span::new(FileId(0), start, start + len)
            };
            let mut diagnostic = Diagnostic::error(CODE, span(&places[0]), "wrong").label("here");
            for place in &places[1..] {
                diagnostic = diagnostic.with_related(span(place), "and here");
            }
            let drawn = draw_one(&text, diagnostic.clone());
            prop_assert!(drawn.contains("wrong") && drawn.ends_with("1 error\n"));
            prop_assert!(drawn.chars().all(|c| c == '\n' || crate::base::readable::visible(c) == c), "{drawn:?}");
            let sources = sources(&text);
            let line = super::super::json(&sources, std::slice::from_ref(&diagnostic));
            prop_assert!(serde_json::from_str::<serde_json::Value>(&line).is_ok());
            prop_assert_eq!(super::super::short(&sources, &[diagnostic]).lines().count(), 1);
        }
    }
}
