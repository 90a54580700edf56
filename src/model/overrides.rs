//! Values from outside the model: `--set NAME=VALUE` and a TOML file of settings. In: their texts. Out: for each
//! parameter named, a quantity of the same kind as the declared one. See spec.md#names.

use super::Check;
use super::Overrides;
use super::error::{NameError, ValueError};
use super::evaluate::Evaluated;
use super::expect::Expected;
use super::scope::{DefinitionId, DefinitionKind, Environment, Table};
use super::suggestion::nearest;
use super::value::{Scalar, Value};
use crate::base::{Angle, Dimension, FileId, Name, Number, OrderBy, Place, Quantity, Sources, Span};
use crate::syntax;

/// The expectation at places that take a number of any dimension.
pub const ANY_NUMBER: Expected = Expected::new("a number", Dimension::NONE, "10 N/m");

/// Maximum number of parameters that are listed.
const SHOWN: usize = 8;

/// A value given for a parameter.
#[derive(Clone, Debug)]
pub struct Override {
    pub value: Scalar,
    /// The place where the value is written.
    pub span: Span,
}

/// The given values by parameter name. They are known before any parameter is declared, since the bounds of a `repeat`
/// may depend on them.
#[derive(Debug, Default)]
pub struct Given {
    values: Table<Name, Override>,
    /// Trial values of an analysis, which override everything else.
    trials: Table<Name, Scalar>,
    /// Every name in order of mention, with its place.
    names: Vec<(Name, Span)>,
    /// The words as written, including the names of the enclosing tables.
    words: Vec<String>,
}

/// A line `name = value` of settings or arguments.
struct Setting {
    /// The parameter's name, or the last word of it.
    name: Span,
    /// The name with its indices, and the names of its place.
    word: String,
    value: Written,
}

/// The value in a setting.
enum Written {
    /// The text of an expression, as on the command line.
    Text(Span),
    /// A value that is not a number.
    Other(Span),
}

impl Given {
    /// Notes that a parameter gets its value from outside.
    pub fn mention(&mut self, name: Name, word: &str, span: Span) {
        self.names.push((name, span));
        self.words.push(word.to_string());
    }

    /// The place where a value is given for a parameter.
    pub fn named_at(&self, name: Name) -> Option<Span> {
        self.names.iter().find(|(known, _)| *known == name).map(|(_, span)| *span)
    }

    /// The place of the value that is given for a parameter.
    pub fn given_at(&self, name: Name) -> Option<Span> {
        self.values.get(&name).map(|given| given.span)
    }

    /// Whether an analysis tries values of parameters.
    pub fn has_trials(&self) -> bool {
        !self.trials.is_empty()
    }
}

impl<'a> Check<'a> {
    /// Reads settings and arguments; the arguments take precedence.
    pub fn overrides(&mut self, overrides: &Overrides) {
        if let Some(file) = overrides.settings {
            let settings = self.toml(file);
            self.take_settings(settings);
        }
        if let Some(file) = overrides.arguments {
            let settings = self.arguments(file);
            self.take_settings(settings);
        }
    }

    /// Sets the trial values of an analysis.
    pub fn set(&mut self, values: &[super::Setting]) {
        for (name, quantity) in values {
            let scalar = Scalar::new(quantity.clone());
            if let Some(name) = self.read_name(name) {
                self.overrides.trials.insert(name, scalar);
            }
        }
    }

    fn take_settings(&mut self, settings: Vec<Setting>) {
        for setting in settings {
            // An error in one has been reported; the others still count.
            let _ = self.take(setting);
        }
    }

    fn take(&mut self, setting: Setting) -> Evaluated<()> {
        let Some(name) = self.read_name(&setting.word) else {
            let error = NameError::SettingName { span: setting.name };
            return self.fail(Environment::TOP, error);
        };
        self.overrides.mention(name, &setting.word, setting.name);
        let span = match setting.value {
            Written::Text(span) => span,
            Written::Other(span) => return self.fail(Environment::TOP, NameError::SettingValue { span }),
        };
        let value = self.value_from_outside(span)?;
        self.overrides.values.insert(name, Override { value, span });
        Ok(())
    }

    /// Reports given names that are not parameters; by now all parameters are declared.
    pub fn overridden_names(&mut self) {
        for index in 0..self.overrides.names.len() {
            let (name, span) = self.overrides.names[index];
            let Some(id) = self.values.get(name) else {
                self.unknown_parameter(span, &self.overrides.words[index].clone());
                continue;
            };
            let definition = &self.definitions[id.0 as usize];
            if definition.kind != DefinitionKind::Param {
                let (word, kind) = (self.words.display(name), definition.kind);
                let declared = definition.span;
                self.report(Environment::TOP, NameError::NotAParameter { span, word, kind, declared });
            }
        }
    }

    /// A word and whole numbers in brackets; in a component behind the names of its place: `mount[3].k`.
    pub(super) fn read_name(&mut self, text: &str) -> Option<Name> {
        let mut place = Place::SCENE;
        let mut rest = text;
        while let Some((first, more)) = rest.split_once('.') {
            let name = self.read_word(first)?.in_place(place);
            (place, rest) = (self.words.mention_place(name), more);
        }
        Some(self.read_word(rest)?.in_place(place))
    }

    fn read_word(&mut self, text: &str) -> Option<Name> {
        let (word, indices) = text.split_once('[').map_or((text, None), |(word, rest)| (word, Some(rest)));
        let is_word = !word.is_empty() && word.chars().all(|letter| letter.is_alphanumeric() || letter == '_');
        let symbol = is_word.then(|| self.words.intern(word))?;
        let Some(indices) = indices else { return Some(Name::plain(symbol)) };
        let indices = indices.strip_suffix(']')?.replace("][", ",");
        let indices: Option<Vec<i32>> = indices.split(',').map(|index| index.trim().parse().ok()).collect();
        Name::with_indices(symbol, &indices?)
    }

    fn unknown_parameter(&mut self, span: Span, text: &str) {
        let word = text.split(['[', '.']).next().unwrap_or(text);
        if self.broken_words.contains(word) {
            return;
        }
        /// Names in components are compared whole; a scene may have very many.
        const COMPARED: usize = 1000;
        let params = self.definitions.iter().filter(|definition| definition.kind == DefinitionKind::Param);
        let known: Vec<String> = match text.contains('.') {
            true => params.take(COMPARED).map(|definition| self.words.display(definition.name)).collect(),
            false => {
                let own = params.filter(|definition| definition.name.place == Place::SCENE);
                own.map(|definition| self.words.text(definition.name.symbol).to_string()).collect()
            }
        };
        let word = if text.contains('.') { text } else { word };
        let suggestion = nearest(word, known.iter().map(String::as_str)).map(str::to_string);
        let known = known.into_iter().take(SHOWN).collect();
        let word = text.to_string();
        self.report(Environment::TOP, NameError::UnknownParameter { span, word, suggestion, known });
    }

    /// Evaluates a value from outside the model, which knows no names of it.
    pub(super) fn value_from_outside(&mut self, span: Span) -> Evaluated<Scalar> {
        let sources: &'a Sources = self.sources;
        let Some((tree, expr)) = syntax::parse_value(sources, span) else {
            return self.fail(Environment::TOP, NameError::SettingValue { span });
        };
        let mut outside = Check::new(sources, &tree, self.literals);
        outside.outside = true;
        let value = outside.evaluate(expr, Environment::TOP);
        if let Ok(Value::Scalar(scalar)) = &value {
            // A value out of range is reported below.
            let _ = outside.check_range(&scalar.quantity.si, expr, Environment::TOP);
        }
        self.diagnostics.extend(std::mem::take(&mut outside.diagnostics));
        match value? {
            Value::Scalar(scalar) => Ok(scalar),
            Value::Vector(_) => {
                self.fail(Environment::TOP, ValueError::Kind { span, needed: "a number", found: "a point" })
            }
        }
    }

    /// The value of a parameter, given its declared value.
    pub fn overridden(&mut self, id: DefinitionId, declared: Scalar) -> Evaluated<Scalar> {
        let name = self.definitions[id.0 as usize].name;
        if let Some(tried) = self.overrides.trials.get(&name) {
            return Ok(tried.clone());
        }
        let Some(Override { value, span }) = self.overrides.values.get(&name) else { return Ok(declared) };
        let span = *span;
        match coerce_to(&declared, value) {
            Ok(value) => Ok(value),
            Err(mismatch) => {
                let definition = &self.definitions[id.0 as usize];
                let declaration = (self.words.display(definition.name), definition.span);
                self.fail(Environment::TOP, mismatch.error(span, &declared).declared_at(declaration))
            }
        }
    }

    /// The lines `NAME=VALUE`.
    fn arguments(&mut self, file: FileId) -> Vec<Setting> {
        let text = self.sources.text(file);
        let mut settings = Vec::new();
        let mut start = 0;
        for line in text.split_inclusive('\n') {
            let line_start = start;
            start += line.len();
            let line = line.trim_end_matches(['\n', '\r']);
            if line.trim().is_empty() {
                continue;
            }
            match line.find('=') {
                Some(at) => settings.push(Setting {
                    name: trimmed_span(file, line_start, &line[..at]),
                    word: line[..at].trim().to_string(),
                    value: Written::Text(trimmed_span(file, line_start + at + 1, &line[at + 1..])),
                }),
                None => {
                    let span = trimmed_span(file, line_start, line);
                    self.report(Environment::TOP, NameError::NoEqualsSign { span });
                }
            }
        }
        settings
    }

    /// The entries of a TOML table: `k = "12 N/m"`, `n = 5`.
    fn toml(&mut self, file: FileId) -> Vec<Setting> {
        let text = self.sources.text(file);
        let table = match toml::de::DeTable::parse(text) {
            Ok(table) => table,
            Err(error) => {
                let range = error.span().unwrap_or(0..0);
                let span = Span::new(file, range.start, range.end);
                self.report(Environment::TOP, NameError::NotToml { span, message: error.message().to_string() });
                return Vec::new();
            }
        };
        let mut settings: Vec<Setting> = Vec::new();
        entries(text, file, table.get_ref(), "", &mut settings);
        settings.order_by_key(|setting| setting.name.start());
        settings
    }
}

/// The entries of a table and of the tables nested in it: `front.k = "..."` and `k = "..."` below `[front]` are the
/// same.
fn entries(text: &str, file: FileId, table: &toml::de::DeTable<'_>, path: &str, settings: &mut Vec<Setting>) {
    for (key, value) in table {
        let name = unquote(text, file, key.span());
        let word = if path.is_empty() { key.get_ref().to_string() } else { format!("{path}.{}", key.get_ref()) };
        match value.get_ref() {
            // The TOML reader limits how deep tables are nested.
            toml::de::DeValue::Table(inner) => entries(text, file, inner, &word, settings),
            _ => settings.push(Setting { name, word, value: written_value(text, file, value) }),
        }
    }
}

/// The value of a TOML entry.
fn written_value(text: &str, file: FileId, value: &toml::Spanned<toml::de::DeValue<'_>>) -> Written {
    use toml::de::DeValue;
    let whole = Span::new(file, value.span().start, value.span().end);
    match value.get_ref() {
        DeValue::Integer(_) | DeValue::Float(_) => Written::Text(whole),
        DeValue::String(content) => {
            let inside = unquote(text, file, value.span());
            // A string with escapes differs from the text in the file; no number needs escapes.
            if text.get(inside.range()) == Some(content) { Written::Text(inside) } else { Written::Other(whole) }
        }
        _ => Written::Other(whole),
    }
}

/// The range without its quotes.
fn unquote(text: &str, file: FileId, range: std::ops::Range<usize>) -> Span {
    let inner = text.get(range.clone()).unwrap_or("");
    let quote = inner.starts_with(['"', '\'']);
    if quote && inner.len() >= 2 {
        return trimmed_span(file, range.start + 1, &inner[1..inner.len() - 1]);
    }
    Span::new(file, range.start, range.end)
}

/// The span of a text that starts at `start`, without surrounding blanks.
pub(super) fn trimmed_span(file: FileId, start: usize, text: &str) -> Span {
    let from = start + (text.len() - text.trim_start().len());
    Span::new(file, from, from + text.trim().len())
}

/// The difference in kind between a given value and the declared one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KindMismatch {
    Dimension(Dimension),
    /// A value in plain 1/s for a declaration in cycles or radians: it could mean either.
    Reading,
}

impl KindMismatch {
    /// The error for a value written at `span`.
    pub fn error(self, span: Span, declared: &Scalar) -> ValueError {
        match self {
            KindMismatch::Reading => ValueError::ReadingLike { span, declared: declared.quantity.angle },
            KindMismatch::Dimension(found) => {
                ValueError::UnlikeDeclared { span, found, wanted: declared.quantity.dimension, declared: None }
            }
        }
    }
}

/// The given value as one of the declared kind: the same dimension, and a frequency in cycles or radians as declared.
pub fn coerce_to(declared: &Scalar, given: &Scalar) -> Result<Scalar, KindMismatch> {
    let (Some(wanted), Some(found)) = (declared.dimension(), given.dimension()) else {
        return Ok(zero_of_kind(declared, given));
    };
    if wanted != found {
        return Err(KindMismatch::Dimension(found));
    }
    let Quantity { si, .. } = &given.quantity;
    let turn = &Number::from(2) * &Number::pi();
    let si = match (declared.quantity.angle, given.quantity.angle) {
        _ if wanted != Dimension::FREQUENCY => si.clone(),
        (Angle::Plain, _) => return Ok(given.clone()),
        (Angle::Cycles, Angle::Radians) => si / &turn,
        (Angle::Radians, Angle::Cycles) => si * &turn,
        (_, Angle::Plain) => return Err(KindMismatch::Reading),
        _ => si.clone(),
    };
    Ok(Scalar { quantity: Quantity { si, ..declared.quantity.clone() }, ..declared.clone() })
}

/// A bare zero takes the declared dimension; a parameter declared as a bare zero takes any.
fn zero_of_kind(declared: &Scalar, given: &Scalar) -> Scalar {
    if declared.bare_zero {
        return given.clone();
    }
    Scalar { quantity: Quantity { si: Number::ZERO, ..declared.quantity.clone() }, ..declared.clone() }
}
