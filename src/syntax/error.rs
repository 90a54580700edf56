//! Syntax errors: facts with their places, and the diagnostic for each.
//! See spec.md#text and docs/diagnostics, `vib::syntax::*`.
//!
//! Messages say in words what was expected and what to type; rules of the grammar are not named.

use super::limits;
use crate::base::{Change, Code, Diagnostic, Span};
use crate::kinds::{DECLARATIONS, Declaration, Piece, Shape, enumeration};

const UNKNOWN_KEYWORD: Code = Code::model("vib::syntax::unknown_keyword");
const UNEXPECTED: Code = Code::model("vib::syntax::unexpected");
const UNCLOSED: Code = Code::model("vib::syntax::unclosed");
const STRAY: Code = Code::model("vib::syntax::stray");
const UNCLOSED_STRING: Code = Code::model("vib::syntax::unclosed_string");
const CHARACTER: Code = Code::model("vib::syntax::character");
const TOO_DEEP: Code = Code::model("vib::syntax::too_deep");
const TOO_LARGE: Code = Code::model("vib::syntax::too_large");
const INNER: Code = Code::model("vib::component::inner");
const MORE: Code = Code::model("vib::syntax::more_errors");

/// A syntax error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SyntaxError {
    /// A declaration does not start with a keyword.
    UnknownKeyword {
        at: Span,
        found: String,
        meant: Intent,
    },
    /// A text that does not match the grammar.
    Unexpected {
        at: Span,
        found: Option<String>,
        expected: Expected,
        remark: Remark,
    },
    /// An opening bracket is not closed before the next declaration, or before the end of the file.
    Unclosed {
        open: Span,
        bracket: char,
        before: Option<Span>,
        /// The keyword whose body it opens.
        of: Option<&'static str>,
    },
    /// An opening bracket is closed by one of another kind.
    Mismatch {
        open: Span,
        bracket: char,
        close: Span,
        found: char,
    },
    /// A closing bracket closes nothing.
    Stray {
        at: Span,
        bracket: char,
    },
    /// A string is not closed on its line.
    UnclosedString {
        open: Span,
    },
    /// A character that is not allowed anywhere.
    Character {
        at: Span,
        character: char,
    },
    /// Brackets that are nested too deeply.
    Nesting {
        at: Span,
    },
    /// `repeat`s that are nested too deeply.
    RepeatNesting {
        at: Span,
    },
    /// `component` or `use` inside a `repeat` or a component.
    InnerComponent {
        at: Span,
        keyword: &'static str,
    },
    /// An expression whose tree is too deep.
    ExpressionDepth {
        at: Span,
    },
    DeclarationLength {
        at: Span,
    },
    WordLength {
        at: Span,
    },
    NumberLength {
        at: Span,
    },
    FileLength {
        at: Span,
    },
    /// Further errors, counted but not reported one by one.
    More {
        at: Span,
        count: usize,
    },
}

/// The likely intention behind a line that does not start with a keyword.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Intent {
    Declaration(&'static Declaration),
    /// `k = 10 N/m`, without `param` or `let`.
    Value,
    /// `s: ground -- block`, without a keyword such as `spring`.
    Part,
    /// `# as drawn`
    Comment,
    Nothing,
}

/// The tokens that the grammar expects at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expected {
    /// A blank after a keyword.
    Blank(&'static str),
    /// A name, and the noun for the thing that it names.
    Name(&'static str),
    /// A sign or word, and a phrase for its place: "after a field's name".
    Sign(&'static str, &'static str),
    /// One of several words, and a phrase for their place.
    OneOf(&'static [&'static str], &'static str),
    /// A value, and a phrase for it: "a direction".
    Value(&'static str),
    /// A direction after `moves`.
    Motion,
    /// A field in braces.
    Field,
    /// A separator between two fields.
    Separator,
    /// A comma between two values, or this closing bracket.
    Comma(char),
    LineEnd,
    /// Another form of the declaration; only reached if the grammar and `explain` disagree.
    Form,
}

/// A hint that accompanies what was expected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Remark {
    /// The form of the declaration.
    Form(&'static Declaration),
    /// The replacement of a look-alike character.
    Write(&'static str),
    /// The number that is written with a decimal comma, with a point.
    DecimalPoint(String),
    Plus,
    Power,
    UnitApart,
    /// `2 m*cos(x)`: the word before the bracket is glued to a unit.
    UnitGlued,
    /// `L N/m`: a unit after something that is not a number.
    UnitOfNoNumber,
    /// `5 1/s`: a unit that begins with a number.
    UnitWithOne,
    FunctionApart,
    IndexApart,
    OperatorMissing,
    NameJoined,
    NameLetters,
    NameStart,
    NameQuoted,
    FieldColon,
    /// `move y`: the directions that follow.
    Moves(&'static str),
    LineGoesOn,
    LineOfItsOwn,
    Semicolon,
    Hash,
    Comparison,
    /// `at (0, 0) at (1 m, 0)`
    OnceEach,
    /// `axle(40 kg)`
    ArgumentName,
    /// `b.x'`
    Derivative,
}

impl SyntaxError {
    pub fn at(&self) -> Span {
        match self {
            SyntaxError::Unclosed { open, .. }
            | SyntaxError::Mismatch { open, .. }
            | SyntaxError::UnclosedString { open } => *open,
            SyntaxError::UnknownKeyword { at, .. }
            | SyntaxError::Unexpected { at, .. }
            | SyntaxError::Stray { at, .. }
            | SyntaxError::Character { at, .. }
            | SyntaxError::Nesting { at }
            | SyntaxError::RepeatNesting { at }
            | SyntaxError::InnerComponent { at, .. }
            | SyntaxError::ExpressionDepth { at }
            | SyntaxError::DeclarationLength { at }
            | SyntaxError::WordLength { at }
            | SyntaxError::NumberLength { at }
            | SyntaxError::FileLength { at }
            | SyntaxError::More { at, .. } => *at,
        }
    }

    /// Whether the `{` of fields or of a `repeat` is missing at the end of the line.
    pub(super) fn lacks_brace(&self) -> bool {
        matches!(self, SyntaxError::Unexpected { found: None, expected: Expected::Sign("{", _), .. })
    }

    pub fn to_diagnostic(&self) -> Diagnostic {
        let error = |code, message: String| Diagnostic::error(code, self.at(), message);
        match self {
            SyntaxError::UnknownKeyword { found, meant, .. } => {
                let diagnostic =
                    error(UNKNOWN_KEYWORD, format!("{found} does not start a declaration")).help(meant.help());
                meant.with_fix(diagnostic)
            }
            SyntaxError::Unexpected { found, expected, remark, .. } => {
                unexpected_token(self.at(), found, *expected, remark)
            }
            SyntaxError::Unclosed { bracket, before, of, .. } => {
                let of = of.map_or(String::new(), |keyword| format!(" of `{keyword}`"));
                let closing = closing(*bracket);
                let end = if before.is_some() { "the next declaration" } else { "the end of the file" };
                let diagnostic = error(UNCLOSED, format!("the `{bracket}`{of} is not closed"))
                    .help(format!("write `{closing}` before {end}"));
                let diagnostic = diagnostic.fix(self.at(), Change::Close(closing));
                match before {
                    Some(span) => diagnostic.with_related(*span, "the next declaration starts here"),
                    None => diagnostic,
                }
            }
            SyntaxError::Mismatch { bracket, close, found, .. } => {
                error(UNCLOSED, format!("the `{bracket}` is not closed before `{found}`"))
                    .with_related(*close, format!("`{}` is missing before this", closing(*bracket)))
                    .help(format!("write `{}` where the bracket ends", closing(*bracket)))
                    .fix(self.at(), Change::Close(closing(*bracket)))
            }
            SyntaxError::Stray { bracket, .. } => error(STRAY, format!("this `{bracket}` has no opening bracket"))
                .help(format!("delete it, or write the `{}` that it closes", opening(*bracket)))
                .fix(self.at(), Change::Replace(String::new())),
            SyntaxError::UnclosedString { .. } => error(UNCLOSED_STRING, "this string is not closed".into())
                .help("write `\"` at its end; a string ends on its line")
                .fix(self.at(), Change::Close('"')),
            SyntaxError::Character { character, .. } => character_error(self.at(), *character),
            SyntaxError::Nesting { .. } => {
                error(TOO_DEEP, format!("brackets are nested more than {} levels deep", limits::BRACKETS))
                    .help("name the inner values with `let`")
            }
            SyntaxError::RepeatNesting { .. } => {
                error(TOO_DEEP, format!("`repeat`s are nested more than {} levels deep", limits::REPEATS))
                    .help("a name has at most three indices; write separate `repeat`s")
            }
            SyntaxError::InnerComponent { keyword, .. } => {
                error(INNER, format!("`{keyword}` is not allowed inside another declaration"))
                    .help("write it at the top level of the file; to use a component here, write `place`")
            }
            SyntaxError::ExpressionDepth { .. } => {
                error(TOO_DEEP, format!("this expression has more than {} levels", limits::EXPRESSION_DEPTH))
                    .help("each operator in a row adds a level; name parts of the expression with `let`")
            }
            SyntaxError::DeclarationLength { .. } => {
                error(TOO_LARGE, format!("this declaration is longer than {} bytes", limits::DECLARATION))
                    .help("a declaration ends at the end of its line; split it into several")
            }
            SyntaxError::WordLength { .. } => {
                error(TOO_LARGE, format!("this word is longer than {} bytes", limits::WORD)).help("shorten it")
            }
            SyntaxError::NumberLength { .. } => {
                error(TOO_LARGE, format!("this number is longer than {} bytes", limits::NUMBER))
                    .help("write it with fewer digits")
            }
            SyntaxError::FileLength { .. } => {
                error(TOO_LARGE, format!("this file is larger than {} MiB", limits::FILE >> 20))
                    .help("write repeated parts with `repeat`")
            }
            SyntaxError::More { count, .. } => {
                let errors = if *count == 1 { "error" } else { "errors" };
                error(MORE, format!("{count} more syntax {errors} from here on")).help("fix the first ones first")
            }
        }
    }
}

fn unexpected_token(at: Span, found: &Option<String>, expected: Expected, remark: &Remark) -> Diagnostic {
    let (wanted, expected) = (expected, expected.words());
    let message = match found {
        Some(found) => format!("expected {expected}, found {found}"),
        None => format!("expected {expected}, but the declaration ends"),
    };
    let diagnostic = Diagnostic::error(UNEXPECTED, at, message).help(remark.help());
    match remark.fix(found.as_deref(), wanted) {
        Some(change) => diagnostic.fix(at, change),
        None => diagnostic,
    }
}

impl Expected {
    fn words(self) -> String {
        match self {
            Expected::Blank(keyword) => format!("a blank after `{keyword}`"),
            Expected::Name(whose) => format!("the name of {whose}"),
            Expected::Sign(sign, place) => format!("`{sign}` {place}"),
            Expected::OneOf(words, place) => format!("{} {place}", enumeration(&quote(words), "or")),
            Expected::Value(which) => which.into(),
            Expected::Motion => "a direction of motion: `x`, `y` or `along (a, b)`".into(),
            Expected::Field => "a field".into(),
            Expected::Separator => "a comma or a line end between two fields".into(),
            Expected::Comma(closing) => format!("`,` or `{closing}`"),
            Expected::LineEnd => "the end of the line".into(),
            Expected::Form => "another form of this declaration".into(),
        }
    }
}

impl Intent {
    fn with_fix(&self, diagnostic: Diagnostic) -> Diagnostic {
        let at = diagnostic.primary.span;
        let start = Span::new(at.file(), at.start(), at.start());
        match self {
            Intent::Declaration(meant) => diagnostic.fix(at, Change::Replace(meant.keyword.to_string())),
            Intent::Value => {
                diagnostic.fix(start, Change::After("param ".into())).fix(start, Change::After("let ".into()))
            }
            Intent::Comment => diagnostic.fix(at, Change::Replace("//".into())),
            Intent::Part | Intent::Nothing => diagnostic,
        }
    }

    fn help(&self) -> String {
        match self {
            Intent::Declaration(meant) => format!("did you mean `{}`? Write it as `{}`", meant.keyword, forms(meant)),
            Intent::Value => "write `param` before it, or `let` if it follows from other values".into(),
            Intent::Part => {
                let of = |is: fn(Shape) -> bool| DECLARATIONS.iter().filter(move |d| is(d.shape)).map(|d| d.keyword);
                let elements = of(|shape| matches!(shape, Shape::Element(_)));
                let joints = of(|shape| matches!(shape, Shape::Joint(_)));
                let keywords: Vec<&str> = elements.chain(joints).chain(of(|shape| shape == Shape::Force)).collect();
                format!("start the line with its kind: {}, ...", quote(&keywords).join(", "))
            }
            Intent::Comment => Remark::Hash.help(),
            Intent::Nothing => {
                let keywords: Vec<&str> = DECLARATIONS.iter().map(|declaration| declaration.keyword).collect();
                format!("a declaration starts with one of: {}", keywords.join(", "))
            }
        }
    }
}

impl Remark {
    /// The edit that fixes the error, if it is obvious.
    fn fix(&self, found: Option<&str>, expected: Expected) -> Option<Change> {
        let write = |text: &str| Some(Change::Replace(text.into()));
        // `found` is stored as it is shown, in back-ticks.
        let found = found?.strip_prefix('`')?.strip_suffix('`')?;
        match (self, expected) {
            (Remark::Write(what), _) => write(what.strip_prefix('`')?.strip_suffix('`')?),
            (Remark::Plus | Remark::Semicolon, _) => write(""),
            (Remark::DecimalPoint(_), _) => None,
            (Remark::Hash, _) => write("//"),
            (Remark::FieldColon, _) => write(" ="),
            (Remark::UnitGlued | Remark::Moves(_), _) => None,
            (Remark::UnitWithOne, _) => write(found.strip_prefix('1')?),
            (Remark::UnitOfNoNumber, _) => Some(Change::Replace(format!("* 1 {found}"))),
            (Remark::OperatorMissing, _) => Some(Change::Replace(format!("* {found}"))),
            (_, Expected::Separator) => Some(Change::Replace(format!(", {found}"))),
            (_, Expected::Sign(sign @ (":" | "=" | "--"), _)) if !matches!(self, Remark::ArgumentName) => {
                Some(Change::Replace(format!("{sign} {found}")))
            }
            _ => None,
        }
    }

    fn help(&self) -> String {
        let text = match self {
            Remark::Form(declaration) => return format!("write it as `{}`", forms(declaration)),
            Remark::Write(what) => return format!("write {what}"),
            Remark::DecimalPoint(number) => {
                return format!("write a decimal point, and no other mark, in a number: `{number}`");
            }
            Remark::Plus => "leave out the `+` before a value",
            Remark::Power => "write `^` for powers: `x^2`",
            Remark::UnitApart => "write one blank, or none, between a number and its unit: `10 N/m`",
            Remark::UnitGlued => {
                "a word directly after a number is its unit; to multiply, write ` * ` with spaces: `2 m * cos(x)`"
            }
            Remark::UnitOfNoNumber => {
                "a unit can only follow a number; multiply anything else by one unit: `L * 1 N/m`"
            }
            Remark::UnitWithOne => "leave out the `1`: a unit may begin with `/`, as in `5 /s`",
            Remark::FunctionApart => "write a function and its bracket without a blank between them: `sqrt(x)`",
            Remark::IndexApart => "write a name and its index without a blank between them: `m[1]`",
            Remark::OperatorMissing => "write an operator between two values, such as `*`",
            Remark::NameJoined => "join the words of a name with `_`",
            Remark::NameLetters => "names are made of the letters a to z, Greek letters, digits and `_`",
            Remark::NameQuoted => "write the name without quotes, its words joined with `_`: `main_rotor`",
            Remark::NameStart => "a name starts with a letter or `_`",
            Remark::FieldColon => "write `=` between a field and its value: `mass = 1 kg`",
            Remark::Moves(directions) => {
                return format!("the word before directions of motion is `moves`: `moves {directions}`");
            }
            Remark::LineGoesOn => {
                "a declaration ends at the end of its line; put a value in brackets to continue it on the next line"
            }
            Remark::LineOfItsOwn => "write each declaration on its own line",
            Remark::Semicolon => {
                "write no `;`: a declaration ends with its line, fields are separated by commas or line ends"
            }
            Remark::Hash => "write `//` before a comment",
            Remark::Derivative => "write `b.vx` for the velocity of `b.x` and `b.ax` for its acceleration",
            Remark::OnceEach => "`at`, `mirrored` and `turned` stand at most once each",
            Remark::ArgumentName => "write `=` between a parameter of the component and its value: `axle(m = 40 kg)`",
            Remark::Comparison => "a requirement compares with `<`, `<=`, `>` or `>=`",
        };
        text.into()
    }
}

fn quote(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| format!("`{word}`")).collect()
}

/// The form of a declaration. The two kinds of damping differ so much that both are shown.
fn forms(declaration: &Declaration) -> String {
    let chooses = declaration.pieces.iter().any(|piece| matches!(piece, Piece::OneOf(..)));
    if chooses { declaration.manual.forms.replace('\n', "` or `") } else { declaration.form.into() }
}

fn character_error(at: Span, character: char) -> Diagnostic {
    let number = character as u32;
    let (message, help) = match character {
        '\0' => (
            "this file contains a NUL character: it is not text".to_string(),
            "save the file as UTF-8; a `.vib` file of another program cannot be read",
        ),
        '\r' => ("a carriage return without a line feed".to_string(), "save the file with line ends of LF or CR LF"),
        '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => (
            format!("a character that reverses the direction of the text (U+{number:04X}) is not allowed"),
            "delete it: it makes the text look different from what it is",
        ),
        _ => (format!("a control character (U+{number:04X}) is not allowed"), "delete it"),
    };
    let diagnostic = Diagnostic::error(CHARACTER, at, message).help(help);
    // A carriage return in the middle of a text may be meant as a line end; the other characters have no use.
    if character == '\r' { diagnostic } else { diagnostic.fix(at, Change::Replace(String::new())) }
}

fn closing(bracket: char) -> char {
    match bracket {
        '(' => ')',
        '[' => ']',
        _ => '}',
    }
}

fn opening(bracket: char) -> char {
    match bracket {
        ')' => '(',
        ']' => '[',
        _ => '{',
    }
}
