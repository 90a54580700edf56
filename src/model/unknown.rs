//! Messages about an unknown word: the nearest known one, or the kind of thing that the word names. In: the word. Out:
//! an [`Error`] with the facts. See spec.md#names.

use super::Check;
use super::error::{Error, NameError, ValueError};
use super::evaluate::{Evaluated, Stop};
use super::scope::{Environment, Group, Part, Space};
use super::suggestion::nearest;
use super::value::FUNCTIONS;
use crate::base::unit::{self, UnitError};
use crate::base::{Name, Span};
use crate::kinds::functions::{self, FunctionKind};
use crate::syntax::tree::Ident;

/// Limit on the searches for suggestions: a file with more unknown words is not mistyped but something else.
const MAX_SEARCHES: u32 = 100;

/// The description of a function that may stand in one kind of place only, and that place.
fn describe_misplaced_function(name: &str) -> Option<String> {
    let (kind, function) = functions::function(name)?;
    let is_called = !function.arguments.is_empty() && kind != FunctionKind::Number;
    is_called.then(|| format!("`{name}` is {}", kind.describe(function)))
}

/// Words for the ground in other programs and drawings.
const WORDS_FOR_GROUND: [&str; 14] = [
    "wall",
    "floor",
    "ceiling",
    "earth",
    "soil",
    "world",
    "fixed",
    "frame",
    "base",
    "support",
    "foundation",
    "origin",
    "inertial",
    "bench",
];

impl<'a> Check<'a> {
    /// Like [`Check::fail`], but silent about words of declarations that could not be read, and about a word that was
    /// already reported as unknown: a missing declaration is one mistake.
    pub fn fail_unless_broken<T>(
        &mut self,
        environment: Environment,
        word: Span,
        error: impl Into<Error>,
    ) -> Evaluated<T> {
        let (text, error) = (self.sources.slice(word), error.into());
        if self.broken_words.contains(text) {
            return Err(Stop::Reported);
        }
        if let Error::Name(NameError::UnknownValue { .. }) = &error
            && self.continues_a_unit_in_brackets(word)
        {
            return Err(Stop::Reported);
        }
        if let Error::Name(NameError::UnknownValue { .. } | NameError::UnknownPart { .. }) = &error {
            self.broken_words.insert(text);
        }
        self.fail(environment, error)
    }

    /// Whether a unit is glued to one that stands in brackets, as `s` in `1 m/(m/s^2)`, and that was reported.
    fn continues_a_unit_in_brackets(&mut self, word: Span) -> bool {
        if !unit::is_known(self.sources.slice(word)) {
            return false;
        }
        let text = self.sources.text(word.file());
        let glued =
            |between: &str| !between.is_empty() && between.chars().all(|c| "*/^-·⋅".contains(c) || c.is_ascii_digit());
        let before = self.unit_in_brackets.filter(|before| before.file() == word.file());
        let continues = before.and_then(|before| text.get(before.end()..word.start())).is_some_and(glued);
        if continues || self.opens_brackets_of_a_unit(word) {
            self.unit_in_brackets = Some(word);
        }
        continues
    }

    fn opens_brackets_of_a_unit(&self, word: Span) -> bool {
        let before = self.sources.text(word.file()).get(..word.start()).unwrap_or("");
        before.ends_with("/(") || before.ends_with("*(")
    }

    /// The error for a word, with the values of its indices, that is not a parameter, point or index.
    pub fn unknown_value(&mut self, ident: Ident, name: Option<Name>, environment: Environment) -> NameError {
        let word = ident.span;
        let text = self.sources.slice(word);
        if let Some(error) =
            name.and_then(|name| self.wrong_index(&self.values, Check::value_span, name, ident, environment))
        {
            return error;
        }
        let brackets = (unit::is_known(text) && self.opens_brackets_of_a_unit(word))
            .then(|| format!("`{text}` is a unit, which stands without brackets: `N/(m/s)` is written `N*s/m`"));
        let help = self.describe_as_value(text, environment).map(|help| brackets.unwrap_or(help));
        let help = help.or_else(|| self.outside_of_component(text, environment));
        let suggestion = if help.is_none() { self.nearest_value(text, environment) } else { None };
        NameError::UnknownValue { span: word, word: text.to_string(), suggestion, help }
    }

    /// Describes a word that was used like a parameter.
    fn describe_as_value(&self, text: &str, environment: Environment) -> Option<String> {
        if self.outside {
            return Some("a value from outside cannot use names of the model: write a number with its unit".into());
        }
        let place = self.place_of(environment);
        let part = self.words.get(text).and_then(|symbol| self.parts.get(Name::plain(symbol).in_place(place)));
        if let Some(Part::Place(_)) = part {
            return Some(format!("`{text}` is a place of a component: what is in it is written `{text}.k`"));
        }
        if let Some(part) = part {
            return Some(format!("`{text}` is {}, not a number", self.noun_of(part)));
        }
        if let Some(place) = describe_misplaced_function(text) {
            return Some(place);
        }
        if matches!(text, "stretch" | "rate") {
            return Some(match self.law_over {
                Some(word) => format!("this law is over `{word}`"),
                None => format!("`{text}` stands in the `law` of a spring or damper alone"),
            });
        }
        unit::is_known(text)
            .then(|| format!("`{text}` is a unit: it follows a number, as in `1 {text}` or `1 /{text}`"))
    }

    /// A name of the scene, in a component.
    fn outside_of_component(&self, text: &str, environment: Environment) -> Option<String> {
        let symbol = self.words.get(text)?;
        let inside = !environment.is_top() && self.environments.frame(environment).is_some();
        let known =
            self.values.family(Group::SCENE, symbol).is_some() || self.parts.family(Group::SCENE, symbol).is_some();
        let how = "a component sees its own names alone: hand it over in the brackets behind its name";
        (inside && known).then(|| format!("`{text}` is a name of the scene, and {how}"))
    }

    fn nearest_value(&mut self, text: &str, environment: Environment) -> Option<String> {
        let group = self.group_of(environment);
        self.may_search().then(|| {
            let declared = self.values.words(group).iter().map(|&symbol| self.words.text(symbol));
            nearest(text, declared.chain(["pi"]).chain(self.law_over)).map(str::to_string)
        })?
    }

    /// The error for an unknown part; `wanted` names the kinds of part that the place takes.
    pub fn unknown_part(
        &mut self,
        ident: Ident,
        name: Name,
        wanted: &'static str,
        environment: Environment,
    ) -> NameError {
        let word = ident.span;
        let text = self.sources.slice(word);
        if let Some(error) = self.wrong_index(&self.parts, Check::part_span, name, ident, environment) {
            return error;
        }
        let group = self.group_of(environment);
        let value = self.words.get(text).and_then(|symbol| self.values.family(group, symbol));
        let help = value.map(|_| format!("`{text}` is a parameter or a point"));
        let help = help.or_else(|| self.outside_of_component(text, environment));
        let suggestion = if help.is_none() { self.nearest_part(text, environment) } else { None };
        let ground = || {
            let is_meant = WORDS_FOR_GROUND.contains(&text.to_ascii_lowercase().as_str());
            is_meant.then(|| {
                "a support that does not move is `ground`; one with a prescribed motion is a `base`".to_string()
            })
        };
        let help = help.or_else(ground);
        NameError::UnknownPart { span: word, word: text.to_string(), wanted, suggestion, help }
    }

    fn nearest_part(&mut self, text: &str, environment: Environment) -> Option<String> {
        let group = self.group_of(environment);
        self.may_search().then(|| {
            let declared = self.parts.words(group).iter().map(|&symbol| self.words.text(symbol));
            nearest(text, declared.chain(["ground"])).map(str::to_string)
        })?
    }

    /// The error for a word that is declared, but not with these indices.
    fn wrong_index<T: Copy>(
        &self,
        space: &Space<T>,
        span_of: impl Fn(&Self, T) -> Span,
        name: Name,
        ident: Ident,
        environment: Environment,
    ) -> Option<NameError> {
        let word = self.words.text(name.symbol).to_string();
        self.wrong_index_of(space, span_of, name, (ident, word), self.group_of(environment))
    }

    /// The error for a wrong index of a name in a component, given the word as it is written.
    pub fn wrong_index_of<T: Copy>(
        &self,
        space: &Space<T>,
        span_of: impl Fn(&Self, T) -> Span,
        name: Name,
        (ident, word): (Ident, String),
        group: Group,
    ) -> Option<NameError> {
        let declared = span_of(self, space.family(group, name.symbol)?.first);
        Some(NameError::IndexOutOfRange {
            span: self.ident_span(ident),
            name: self.words.display(name),
            word,
            given: name.indices().len(),
            ranges: space.ranges(group, name)?,
            declared,
        })
    }

    /// The error for a function that does not exist, or may not be used here.
    pub fn unknown_function(&mut self, word: Span) -> NameError {
        let text = self.sources.slice(word);
        let help = describe_misplaced_function(text);
        let suggestion = if help.is_some() { None } else { nearest(text, FUNCTIONS.iter().map(|f| f.name)) };
        NameError::UnknownFunction {
            span: word,
            word: text.to_string(),
            suggestion: suggestion.map(str::to_string),
            help,
        }
    }

    fn may_search(&mut self) -> bool {
        self.searches += 1;
        self.searches <= MAX_SEARCHES
    }

    /// The error for a unit that cannot be read, at its place in the file.
    pub fn unit_error(&mut self, text: &str, span: Span, error: UnitError, environment: Environment) -> ValueError {
        let group = self.group_of(environment);
        let at = |range: std::ops::Range<usize>| {
            Span::new(span.file(), span.start() + range.start, span.start() + range.end)
        };
        match error {
            UnitError::Unknown { word } => {
                let symbol = text[word.clone()].to_string();
                let is_value =
                    self.words.get(&symbol).is_some_and(|symbol| self.values.family(group, symbol).is_some());
                let suggestion = unit::suggestion(&symbol);
                ValueError::UnitUnknown { span: at(word), symbol, suggestion, is_value }
            }
            UnitError::Ambiguous { tail } => {
                let (head, tail) = text.split_at(tail.start);
                let tail = tail.chars().skip(1).collect();
                ValueError::UnitAmbiguous { span, head: head.to_string(), tail }
            }
            UnitError::Malformed { at: range } => ValueError::UnitMalformed { span: at(range) },
            UnitError::Power { at: range } => ValueError::UnitMalformed { span: at(range) },
            UnitError::DecibelInProduct { word } => ValueError::DecibelInProduct { span: at(word) },
        }
    }
}
