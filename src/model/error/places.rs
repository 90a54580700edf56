//! Errors of components, of their places and of the files that they come from.

use super::{enumeration, error, kind_noun, name_phrase, with_suggestion};
use crate::base::{Code, Diagnostic, Dimension, Span};
use crate::model::scope::DefinitionKind;

/// A file of components that could not be read.
pub const USE_UNREADABLE: Code = Code::file("vib::use::unreadable");

/// Errors of components, places and `use` lines.
#[derive(Clone, Debug, PartialEq)]
pub enum PlaceError {
    /// The file that a `use` names.
    Unread {
        span: Span,
        reason: String,
    },
    /// A file that uses itself, through those in between.
    UseCycle {
        span: Span,
        files: Vec<String>,
    },
    UnknownComponent {
        span: Span,
        word: String,
        suggestion: Option<String>,
        known: Vec<String>,
    },
    DuplicateComponent {
        span: Span,
        word: String,
        others: Vec<Span>,
    },
    /// A component that places itself: the components in between, from it to it.
    Recursion {
        span: Span,
        chain: Vec<String>,
    },
    TooDeep {
        span: Span,
        limit: usize,
    },
    /// A declaration that may not stand in a component.
    Forbidden {
        span: Span,
        keyword: String,
        reason: &'static str,
        help: &'static str,
    },
    /// A part that is called like a motion.
    MotionName {
        span: Span,
        word: String,
    },
    /// A parameter without a unit and without a default.
    Undetermined {
        span: Span,
        word: String,
    },
    /// A default of another dimension than the unit beside it.
    UnlikeUnit {
        span: Span,
        unit: Span,
        found: Option<Dimension>,
        wanted: Dimension,
    },
    MissingArguments {
        span: Span,
        component: String,
        missing: Vec<(String, Span)>,
        example: String,
    },
    UnknownArgument {
        span: Span,
        word: String,
        component: String,
        suggestion: Option<String>,
        known: Vec<String>,
    },
    ArgumentTwice {
        span: Span,
        first: Span,
        word: String,
    },
    /// An argument for a port that is not the name of a part.
    NoPart {
        span: Span,
        port: String,
        declared: Span,
    },
    /// A port whose argument is a place or another thing that nothing can be tied to.
    PortKind {
        span: Span,
        word: String,
        found: &'static str,
        declared: Span,
    },
    /// A part of the component needs a position, and the place has none in the scene.
    NoPosition {
        span: Span,
        component: String,
        needs: Span,
    },
    MirrorAxis {
        span: Span,
    },
    /// A parameter that its place gives, and `solve` would find.
    GivenBySolve {
        span: Span,
        word: String,
        given: Span,
    },
    /// A vector that may be a place or a difference of two.
    VectorOfPlace {
        span: Span,
        word: String,
        declared: Span,
    },
    UnknownMember {
        span: Span,
        word: String,
        of: String,
        component: Span,
        wanted: &'static str,
        suggestion: Option<String>,
    },
    /// A member that is not of the kind that is needed.
    OtherMember {
        span: Span,
        word: String,
        found: &'static str,
        wanted: &'static str,
        declared: Span,
    },
    /// A name before a `.` that is no place.
    NoPlace {
        span: Span,
        word: String,
    },
    /// An input motion of a base that is turned with its component.
    TurnedMotion {
        span: Span,
        word: String,
    },
}

impl PlaceError {
    /// The error as a diagnostic.
    pub fn diagnostic(self) -> Diagnostic {
        use PlaceError::*;
        match self {
            Unread { span, reason } => {
                Diagnostic::error(USE_UNREADABLE, span, format!("this file of components cannot be read: {reason}"))
                    .help("the path is relative to the file with the `use`; `\"std/...\"` are the components that come with the program")
            }
            UseCycle { span, files } => {
                error("vib::use::cycle", span, format!("the file uses itself: {}", files.join(" -> ")))
                    .help("put the components that both need into a third file")
            }
            UnknownComponent { span, word, suggestion, known } => {
                let message = format!("there is no component `{word}`");
                let known: Vec<&str> = known.iter().map(String::as_str).collect();
                let help = match known.is_empty() {
                    true => "declare it with `component`, or name the file that it is in: `use \"axles.vib\"`".into(),
                    false => format!("known here: {}", enumeration(&known)),
                };
                with_suggestion(error("vib::component::unknown", span, message), suggestion, Some(help))
            }
            DuplicateComponent { span, word, others } => {
                let diagnostic = error("vib::component::duplicate", span, format!("there are two components `{word}`"));
                let diagnostic = others.into_iter().fold(diagnostic, |diagnostic, other| diagnostic.with_related(other, "one of this name is declared here"));
                diagnostic.help("rename one of them")
            }
            Recursion { span, chain } => {
                error("vib::component::recursion", span, format!("the component contains itself: {}", chain.join(" -> ")))
                    .help("a component can place only other components; use `repeat` for rows of them")
            }
            TooDeep { span, limit } => {
                error("vib::component::recursion", span, format!("components contain each other more than {limit} levels deep"))
                    .help("place some of them in the scene")
            }
            Forbidden { span, keyword, reason, help } => {
                error("vib::component::forbidden", span, format!("`{keyword}` is not allowed in a component: {reason}"))
                    .help(help)
            }
            MotionName { span, word } => {
                error("vib::component::motion_name", span, format!("`{word}` is the name of a motion"))
                    .label("it is used as the name of a part or output in a component")
                    .help(format!("choose another name: from outside, `front.{word}` would mean two things"))
            }
            Undetermined { span, word } => {
                error("vib::component::dimension", span, format!("the dimension of `{word}` is not known"))
                    .help(format!("write its unit or a default: `{word}: kg`, `{word} = 1 kg`, `{word}: 1` for a plain number"))
            }
            UnlikeUnit { span, unit, found, wanted } => {
                let found = found.map_or("a point".to_string(), name_phrase);
                error("vib::component::dimension", span, format!("the default is {found}, but the unit is that of {}", name_phrase(wanted)))
                    .with_related(unit, "the unit")
                    .help("change or remove one of them: a default is enough")
            }
            MissingArguments { span, component, missing, example } => {
                let words: Vec<&str> = missing.iter().map(|(word, _)| word.as_str()).collect();
                let message = format!("the component `{component}` needs {}", enumeration(&words));
                let diagnostic = error("vib::place::missing", span, message);
                let diagnostic = missing.iter().fold(diagnostic, |diagnostic, (_, at)| diagnostic.with_related(*at, "declared here, without a default"));
                diagnostic.help(format!("write `{component}({example})`"))
            }
            UnknownArgument { span, word, component, suggestion, known } => {
                let message = format!("the component `{component}` has no parameter or port `{word}`");
                let known: Vec<&str> = known.iter().map(String::as_str).collect();
                let help = if known.is_empty() { "it has none".into() } else { format!("it has {}", enumeration(&known)) };
                with_suggestion(error("vib::place::unknown", span, message), suggestion, Some(help))
            }
            ArgumentTwice { span, first, word } => {
                error("vib::place::duplicate", span, format!("`{word}` is given twice"))
                    .with_related(first, "given first here")
                    .help("keep one of them")
            }
            NoPart { span, port, declared } => {
                error("vib::part::kind", span, format!("the port `{port}` takes a part of the scene"))
                    .with_related(declared, "the port")
                    .help("name a body, a base or `ground`")
            }
            PortKind { span, word, found, declared } => {
                error("vib::part::kind", span, format!("`{word}` is {found}, not a body"))
                    .with_related(declared, "declared here")
                    .help("a port takes a body, a base or `ground`")
            }
            NoPosition { span, component, needs } => {
                error("vib::place::position", span, format!("the component `{component}` contains positions, but its place has none"))
                    .with_related(needs, "this is a position")
                    .help("write the position of its origin: `at (0, 0)`")
            }
            MirrorAxis { span } => error("vib::place::mirrored", span, "a component can be mirrored only along x or y")
                .help("write `mirrored x`, which changes the sign of its x, or `mirrored y`"),
            GivenBySolve { span, word, given } => {
                error("vib::place::solved", span, format!("`{word}` already has a value, given where its component is placed"))
                    .with_related(given, "given here")
                    .help("omit it there, or pass a `param` of the scene and solve for that")
            }
            VectorOfPlace { span, word, declared } => {
                error("vib::place::vector", span, format!("`{word}` could be a position or a difference of two positions"))
                    .with_related(declared, "declared with `let`")
                    .help("a position moves with the component, a difference only turns with it: declare it as a `point`")
            }
            UnknownMember { span, word, of, component, wanted, suggestion } => {
                let code = if wanted == "parameter or point" { "vib::name::unknown" } else { "vib::part::unknown" };
                let diagnostic = error(code, span, format!("`{of}` has no {wanted} `{word}`"));
                with_suggestion(diagnostic.with_related(component, "its component"), suggestion, None)
            }
            OtherMember { span, word, found, wanted, declared } => {
                error("vib::part::kind", span, format!("`{word}` is {found}, not a {wanted}"))
                    .with_related(declared, "declared here")
            }
            NoPlace { span, word } => {
                error("vib::part::kind", span, format!("`{word}` is not a place of a component: it has no parts or parameters"))
                    .help("write the name of a `place` before the `.`")
            }
            TurnedMotion { span, word } => {
                error("vib::place::turned_input", span, format!("the motion `{word}` of this base is not an input of the scene"))
                    .help("the base moves along x and y of the scene, but its component is turned: write the measure in the scene, or use two bases")
            }
        }
    }
}

/// A declared quantity with its article.
pub fn kind_with_article(kind: DefinitionKind) -> &'static str {
    match kind_noun(kind) {
        "parameter" => "a parameter",
        "point" => "a point",
        _ => "a value",
    }
}
