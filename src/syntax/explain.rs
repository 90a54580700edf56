//! Finds the first mistake in a declaration that does not match the grammar.
//!
//! In: the text of a declaration that pest has refused. Out: the position of the mistake, what was expected there, and
//! a hint. pest reports its progress in terms of its rules, but an engineer wants to know what to type. So this module
//! reads the text once more, piece by piece as the table of kinds lists them, and stops at the first mistake. It builds
//! nothing from what it reads; tests show that it agrees with the grammar. See spec.md#text.

use super::error::{Expected, Remark};
use super::words;
use crate::base::{Takes, unit};
use crate::kinds::{self, Declaration, Piece, Shape};
use std::ops::Range;
use strsim::damerau_levenshtein;

/// The first mistake in a declaration; positions are byte offsets into its text.
#[derive(Debug)]
pub(super) struct Problem {
    pub at: Range<usize>,
    /// The text found, as messages show it; `None` at the end of the declaration.
    pub found: Option<String>,
    pub expected: Expected,
    pub remark: Remark,
}

type Read = Result<(), Problem>;

/// Finds the first mistake in the text of a declaration, which starts with its keyword.
pub(super) fn explain(declaration: &'static Declaration, text: &str) -> Problem {
    let mut reader = Reader { text, at: declaration.keyword.len(), declaration };
    match reader.pieces(declaration.pieces).and_then(|()| reader.line_end()) {
        Err(problem) => problem,
        Ok(()) => {
            reader.at = 0;
            reader.problem(Expected::Form)
        }
    }
}

/// The declaration whose keyword a text starts with.
pub(super) fn declaration_of(text: &str) -> Option<&'static Declaration> {
    let end = text.find(|c: char| !in_word(c)).unwrap_or(text.len());
    kinds::declaration(&text[..end])
}

/// The range of the token at a position: a word or number, an operator, or one character.
pub(super) fn token_range(text: &str, at: usize) -> Range<usize> {
    let rest = &text[at..];
    let word = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
    if word > 0 {
        return at..at + word;
    }
    let operators = ["--", "->", "==", "<=", ">=", "**", "..", "!="];
    match operators.iter().find(|operator| rest.starts_with(**operator)) {
        Some(operator) => at..at + operator.len(),
        None => at..at + rest.chars().next().map_or(0, char::len_utf8),
    }
}

/// Source text as messages show it: in back-ticks, shortened, invisible characters by their code point.
pub(super) fn quoted_source(thing: &str) -> String {
    match thing.chars().next() {
        Some(c)
            if c.is_whitespace() && !c.is_ascii() || matches!(c, '\u{200b}'..='\u{200f}' | '\u{feff}' | '\u{ad}') =>
        {
            format!("an invisible character, or one that looks like a blank (U+{:04X})", c as u32)
        }
        Some('\n') => "a line end".into(),
        _ if thing.chars().count() > 40 => format!("`{}...`", thing.chars().take(37).collect::<String>()),
        _ => format!("`{thing}`"),
    }
}

/// The character of the language that a look-alike should be replaced by.
fn look_alike(c: char) -> Option<&'static str> {
    Some(match c {
        '\u{2212}' | '\u{2010}'..='\u{2015}' => "`-`",
        '\u{d7}' | '\u{b7}' | '\u{22c5}' | '\u{2219}' | '\u{2022}' => "`*`",
        '\u{f7}' | '\u{2215}' | '\u{2044}' => "`/`",
        '\u{201c}'..='\u{201f}' | '\u{ab}' | '\u{bb}' | '\u{2018}'..='\u{201b}' | '\'' => "`\"`",
        '\u{2264}' => "`<=`",
        '\u{2265}' => "`>=`",
        '\u{2192}' => "`->`",
        '\u{b2}' => "`^2`",
        '\u{b3}' => "`^3`",
        '\u{221a}' => "`sqrt(x)`",
        '\u{a0}' | '\u{2000}'..='\u{200a}' | '\u{202f}' | '\u{205f}' | '\u{3000}' => "an ordinary blank",
        '\u{200b}'..='\u{200f}' | '\u{feff}' | '\u{ad}' => "nothing there",
        _ => return None,
    })
}

struct Reader<'a> {
    text: &'a str,
    at: usize,
    declaration: &'static Declaration,
}

impl Reader<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn next(&self) -> Option<char> {
        self.rest().chars().next()
    }

    /// The character before the current position.
    fn last(&self) -> Option<char> {
        self.text[..self.at].chars().next_back()
    }

    /// The last character before the current position that is not a blank.
    fn last_visible(&self) -> Option<char> {
        self.text[..self.at].trim_end().chars().next_back()
    }

    fn eat(&mut self, sign: &str) -> bool {
        let found = self.rest().starts_with(sign);
        if found {
            self.at += sign.len();
        }
        found
    }

    /// Steps over `word` unless a letter or digit follows it.
    fn eat_word(&mut self, word: &str) -> bool {
        let rest = self.rest();
        let found = rest.starts_with(word) && !rest[word.len()..].starts_with(|c: char| in_word(c));
        if found {
            self.at += word.len();
        }
        found
    }

    /// Steps over blanks and line ends; returns whether there were any.
    fn blanks(&mut self) -> bool {
        let start = self.at;
        self.at += self.rest().bytes().take_while(|b| matches!(b, b' ' | b'\t' | b'\n' | b'\r')).count();
        self.at > start
    }

    fn blanks_in_line(&mut self) {
        self.at += self.rest().bytes().take_while(|b| matches!(b, b' ' | b'\t' | b'\r')).count();
    }

    /// The problem that the text at the current position is not what was expected.
    fn problem(&self, expected: Expected) -> Problem {
        if let Some(problem) = self.misspelt_white().or_else(|| self.misspelt_tolerance()) {
            return problem;
        }
        let remark = self.remark(expected);
        let at = match remark {
            Remark::UnitWithOne => self.at..self.at + self.unit_length(),
            _ => token_range(self.text, self.at),
        };
        let found = (!at.is_empty()).then(|| quoted_source(&self.text[at.clone()]));
        Problem { remark, at, found, expected }
    }

    /// `noise(wite 3 N^2/Hz)`: a value after a word that is nearly `white`.
    fn misspelt_white(&self) -> Option<Problem> {
        let before = self.text[..self.at].strip_suffix([' ', '\t'])?.trim_end();
        let start = before.trim_end_matches(in_word).len();
        let word = &before[start..];
        let is_near = (1..=2).contains(&damerau_levenshtein(&word.to_lowercase(), "white")) || word == "White";
        let of_noise = before[..start].trim_end().strip_suffix('(').is_some_and(|call| call.ends_with("noise"));
        let is_value = self.next().is_some_and(|c| c.is_ascii_digit() || c == '.');
        (is_near && of_noise && is_value).then(|| Problem {
            remark: Remark::Write("`white`"),
            at: start..before.len(),
            found: Some(quoted_source(word)),
            expected: Expected::Value("`white` or a density"),
        })
    }

    /// `2.4 t spred 2 %`, `2.4 withn 5 %`, `spread lognorml 15 %`: a word here, or the one before a value here, that is nearly one of
    /// a tolerance; and `spread uniform 3 %`, where `within` is missing.
    fn misspelt_tolerance(&self) -> Option<Problem> {
        let may_have = self.declaration.pieces.iter().any(|piece| matches!(piece, Piece::Tolerance));
        let is_value = self.next().is_some_and(|c| c.is_ascii_digit() || c == '.');
        let end = if is_value { self.text[..self.at].trim_end().len() } else { token_range(self.text, self.at).end };
        let start = self.text[..end].trim_end_matches(in_word).len();
        let word = &self.text[start..end];
        let near = |(of, _): &(&str, &str)| {
            let edits = damerau_levenshtein(&word.to_lowercase(), of);
            word != *of && edits * 3 <= of.len()
        };
        let (_, write) = match word {
            "uniform" if is_value => ("", "`uniform within`"),
            _ => words::OF_TOLERANCE.into_iter().find(near)?,
        };
        if !may_have {
            return None;
        }
        let found = Some(quoted_source(word));
        Some(Problem { remark: Remark::Write(write), at: start..end, found, expected: Expected::LineEnd })
    }

    fn problem_with(&self, expected: Expected, remark: Remark) -> Problem {
        Problem { remark, ..self.problem(expected) }
    }

    /// The hint for the text at the current position, where something else is expected.
    fn remark(&self, expected: Expected) -> Remark {
        let Some(next) = self.next() else {
            let operator = matches!(self.last_visible(), Some('+' | '-' | '*' | '/' | '^' | '=' | '<' | '>' | ','));
            return if matches!(expected, Expected::Value(_)) && operator {
                Remark::LineGoesOn
            } else if words::OF_TOLERANCE.iter().any(|(word, _)| self.text.trim_end().ends_with(word)) {
                Remark::Write("a value after the word, such as `5 %`")
            } else {
                Remark::Form(self.declaration)
            };
        };
        if matches!(next, '\'' | '\u{2019}' | '\u{2032}' | '\u{2033}') && self.last().is_some_and(in_word) {
            return Remark::Derivative;
        }
        if let Some(write) = self.point_of_decimal_comma(next) {
            return Remark::DecimalPoint(write);
        }
        if let Some(write) = look_alike(next) {
            let is_dash = write == "`-`" && matches!(expected, Expected::Sign("--", _));
            return Remark::Write(if is_dash { "`--`" } else { write });
        }
        match (expected, next) {
            (_, ';') => Remark::Semicolon,
            (_, '#') => Remark::Hash,
            (Expected::Value(_), '+') => Remark::Plus,
            (Expected::Value(_), '*') if self.last() == Some('*') => Remark::Power,
            (Expected::Name(_), '"') => Remark::NameQuoted,
            (Expected::Name(_), c) if c.is_ascii_digit() => Remark::NameStart,
            (_, c) if c.is_alphabetic() && !words::is_letter(c) => Remark::NameLetters,
            (Expected::Sign(..), '-' | '.') if self.joins_name() => Remark::NameJoined,
            (Expected::LineEnd | Expected::Separator | Expected::Comma(_), _) => {
                self.remark_after_value(expected, next)
            }
            _ => Remark::Form(self.declaration),
        }
    }

    /// The number `1.5` of `1,5`, if a comma between two digits stands here or just before.
    fn point_of_decimal_comma(&self, next: char) -> Option<String> {
        let comma = if next == ',' { self.at } else { self.at.checked_sub(1)? };
        let (before, after) = (self.text.get(..comma)?, self.text.get(comma..)?.strip_prefix(',')?);
        let start = before.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.').len();
        let end = after.find(|c: char| !c.is_ascii_digit()).unwrap_or(after.len());
        let (whole, part) = (before[start..].replace('.', ""), &after[..end]);
        let in_word = before[..start].chars().next_back().is_some_and(in_word);
        (!whole.is_empty() && !part.is_empty() && !in_word).then(|| format!("{whole}.{part}"))
    }

    /// Whether a name continues, as in `left-wheel`, of which only `left` was read.
    fn joins_name(&self) -> bool {
        self.last().is_some_and(in_word) && self.rest()[1..].starts_with(in_word)
    }

    /// The hint for something that follows a complete value.
    fn remark_after_value(&self, expected: Expected, next: char) -> Remark {
        let apart = self.text[..self.at].ends_with([' ', '\t']);
        let after_digit = self.last_visible().is_some_and(|c| c.is_ascii_digit());
        let after_word = self.last_visible().is_some_and(in_word);
        match next {
            '(' if apart && after_word && !after_digit => Remark::FunctionApart,
            '(' if after_word && !after_digit => Remark::UnitGlued,
            '[' if apart && after_word => Remark::IndexApart,
            _ if after_digit && apart && (words::is_letter(next) || matches!(next, '%' | '°')) => Remark::UnitApart,
            '1' if after_digit && self.rest().starts_with("1/") && self.starts_unit() => Remark::UnitWithOne,
            _ if apart && self.starts_unit() => Remark::UnitOfNoNumber,
            '=' if self.declaration.shape == Shape::Require => Remark::Comparison,
            _ if expected == Expected::LineEnd && self.starts_keyword() => Remark::LineOfItsOwn,
            ',' if expected == Expected::LineEnd && self.declaration.shape != Shape::Point => Remark::LineOfItsOwn,
            _ if expected == Expected::LineEnd && self.declaration.shape == Shape::Model => Remark::NameJoined,
            _ if expected == Expected::LineEnd && !self.ends_with_value() => Remark::Form(self.declaration),
            _ if expected != Expected::Separator && (next == '(' || in_word(next)) => Remark::OperatorMissing,
            _ => Remark::Form(self.declaration),
        }
    }

    /// Whether the text up to the next blank, bracket or comma is a unit.
    fn starts_unit(&self) -> bool {
        unit::parse(&self.rest()[..self.unit_length()]).is_ok()
    }

    /// The length of what could be a unit at the current position.
    fn unit_length(&self) -> usize {
        self.rest().find([' ', '\t', '\n', ',', ')', '}', '=']).unwrap_or(self.rest().len())
    }

    fn ends_with_value(&self) -> bool {
        matches!(self.declaration.pieces.last(), Some(Piece::Value(..) | Piece::OneOf(..) | Piece::Tolerance))
    }

    fn starts_keyword(&self) -> bool {
        declaration_of(self.rest()).is_some()
    }

    // ---- Declarations, as the table of kinds has them ----

    fn pieces(&mut self, pieces: &'static [Piece]) -> Read {
        pieces.iter().try_for_each(|piece| self.piece(piece))
    }

    fn piece(&mut self, piece: &'static Piece) -> Read {
        match *piece {
            Piece::Blank => self.skip_blank(),
            Piece::Apart => self.are_separated(),
            Piece::Word(_, whose) => self.word(whose),
            Piece::Name(_, whose) => self.name(whose),
            Piece::Sign(sign, place) => self.sign(sign, place),
            Piece::Marker(word, place) => self.marker(word, place),
            Piece::OneOf(words, place, rest) => match words.iter().position(|word| self.eat_word(word)) {
                Some(which) => self.pieces(rest[which]),
                None => Err(self.problem(Expected::OneOf(words, place))),
            },
            Piece::Value(which, _) => self.expression(which),
            Piece::Arguments(place, what) => self.arguments(place, what),
            Piece::End(which) => self.end(which),
            Piece::OtherEnd(which) => self.other_end(which),
            Piece::Along => self.along_clause(),
            Piece::Signal(_) => self.signal(),
            Piece::InUnit(whose) => self.in_unit(whose),
            Piece::Fields => self.fields(),
            Piece::Formals => self.formals(),
            Piece::Actuals => self.actuals(),
            Piece::Placing => self.read_placement(),
            Piece::Text(which) => self.text(which),
            Piece::Path(_, whose) => self.path(whose),
            Piece::Varied => self.varied_parameters(),
            Piece::Limits => self.limits(),
            Piece::Tolerance => self.tolerance(),
        }
    }

    fn skip_blank(&mut self) -> Read {
        if self.blanks() {
            return Ok(());
        }
        Err(match self.next() {
            None => self.problem(self.first()),
            Some(_) => self.problem(Expected::Blank(self.declaration.keyword)),
        })
    }

    /// The first token after the keyword and its blank.
    fn first(&self) -> Expected {
        match self.declaration.pieces.get(1) {
            Some(Piece::Word(_, whose) | Piece::Name(_, whose) | Piece::Path(_, whose)) => Expected::Name(whose),
            Some(Piece::Marker(word, place)) => Expected::Sign(word, place),
            Some(Piece::OneOf(words, place, _)) => Expected::OneOf(words, place),
            _ => Expected::Value("a value"),
        }
    }

    /// Requires a blank or a bracket before a value.
    fn are_separated(&mut self) -> Read {
        if self.next() == Some('(') || self.blanks() {
            return Ok(());
        }
        Err(match self.next() {
            None => self.problem(Expected::Value("a value")),
            Some(_) => self.problem(Expected::Sign("a blank", "before the value")),
        })
    }

    fn sign(&mut self, sign: &'static str, place: &'static str) -> Read {
        self.blanks();
        if !self.eat(sign) {
            return Err(self.problem(Expected::Sign(sign, place)));
        }
        self.blanks();
        Ok(())
    }

    /// Requires a word of the language, which blanks may precede.
    fn marker(&mut self, word: &'static str, place: &'static str) -> Read {
        self.blanks();
        if self.eat_word(word) { Ok(()) } else { Err(self.problem(Expected::Sign(word, place))) }
    }

    fn word(&mut self, whose: &'static str) -> Read {
        if !self.next().is_some_and(words::is_letter) {
            return Err(self.problem(Expected::Name(whose)));
        }
        self.at += self.rest().find(|c: char| !in_word(c)).unwrap_or(self.rest().len());
        Ok(())
    }

    fn name(&mut self, whose: &'static str) -> Read {
        self.word(whose)?;
        self.indices()
    }

    fn indices(&mut self) -> Read {
        while self.eat("[") {
            self.blanks();
            self.list("an index", ']')?;
        }
        Ok(())
    }

    /// Values up to the closing bracket.
    fn list(&mut self, what: &'static str, closing: char) -> Read {
        self.comma_separated(closing, |reader| reader.expression(what))
    }

    /// At least one item, with commas between items, up to the closing bracket.
    fn comma_separated(&mut self, closing: char, mut item: impl FnMut(&mut Self) -> Read) -> Read {
        loop {
            item(self)?;
            self.blanks();
            if self.next() == Some(closing) {
                self.at += 1;
                return Ok(());
            }
            if !self.eat(",") {
                return Err(self.problem(Expected::Comma(closing)));
            }
            self.blanks();
        }
    }

    /// A sign and what follows it, if the sign is there; blanks may precede both.
    fn optional(&mut self, sign: &str, then: impl FnOnce(&mut Self) -> Read) -> Read {
        let before = self.at;
        self.blanks();
        if !self.eat(sign) {
            self.at = before;
            return Ok(());
        }
        self.blanks();
        then(self)
    }

    /// `(0.1 /s, 1e-4 s)`
    fn arguments(&mut self, place: &'static str, what: &'static str) -> Read {
        self.sign("(", place)?;
        if self.eat(")") { Ok(()) } else { self.list(what, ')') }
    }

    /// A name, and names of a component behind it.
    fn path(&mut self, whose: &'static str) -> Read {
        self.name(whose)?;
        while self.next() == Some('.') && !self.rest().starts_with("..") {
            self.at += 1;
            self.name("a part or quantity of the component")?;
        }
        Ok(())
    }

    // ---- Components ----

    /// `(part chassis, m: kg, k = 150 kN/m)`
    fn formals(&mut self) -> Read {
        self.blanks();
        if !self.eat("(") {
            return Err(self.problem(Expected::Sign("(", "after the component's name")));
        }
        self.read_list(Self::formal)?;
        self.blanks();
        Ok(())
    }

    /// Any number of items, separated by commas, up to the closing bracket.
    fn read_list(&mut self, item: fn(&mut Self) -> Read) -> Read {
        self.blanks();
        if self.eat(")") { Ok(()) } else { self.comma_separated(')', item) }
    }

    fn formal(&mut self) -> Read {
        let start = self.at;
        self.word("a parameter")?;
        let is_part = &self.text[start..self.at] == "part";
        let after = self.at;
        self.blanks();
        if is_part && self.next().is_some_and(words::is_letter) {
            return self.word("the part");
        }
        if self.eat(":") {
            self.blanks();
            self.dimension("a unit that says the dimension, such as `kg`, or `1`")?;
        } else {
            self.at = after;
        }
        self.optional("=", |reader| reader.expression("the default"))
    }

    /// A unit without a number: `kg`, `/s`, `1`.
    fn dimension(&mut self, which: &'static str) -> Read {
        let start = self.at;
        if !self.eat("1") {
            self.eat("/");
            self.at = if self.factors() { self.at } else { start };
        }
        if self.at == start { Err(self.problem(Expected::Value(which))) } else { Ok(()) }
    }

    /// `in mm`, if present.
    fn in_unit(&mut self, which: &'static str) -> Read {
        let before = self.at;
        if self.blanks() && self.eat_word("in") {
            self.skip_blank()?;
            let start = self.at;
            if self.factors() {
                return Ok(());
            }
            self.at = start;
            return Err(self.problem(Expected::Value(which)));
        }
        self.at = before;
        Ok(())
    }

    /// `(m = 40 kg)`
    fn actuals(&mut self) -> Read {
        self.blanks();
        if !self.eat("(") {
            return Err(self.problem(Expected::Sign("(", "after the component")));
        }
        self.read_list(Self::actual)
    }

    fn actual(&mut self) -> Read {
        if !self.next().is_some_and(words::is_letter) {
            return Err(self.problem_with(Expected::Name("a parameter of the component"), Remark::ArgumentName));
        }
        self.word("a parameter of the component")?;
        self.blanks();
        if !self.eat("=") {
            return Err(
                self.problem_with(Expected::Sign("=", "after a parameter of the component"), Remark::ArgumentName)
            );
        }
        self.blanks();
        self.expression("the parameter's value")
    }

    /// `at (1 m, 0) mirrored x turned 10 deg`
    fn read_placement(&mut self) -> Read {
        loop {
            let before = self.at;
            self.blanks();
            if self.eat_word("at") {
                self.are_separated()?;
                self.expression("a place `(x, y)`")?;
            } else if self.eat_word("turned") {
                self.are_separated()?;
                self.expression("an angle")?;
            } else if self.eat_word("mirrored") {
                self.blanks();
                if !self.next().is_some_and(char::is_alphabetic) {
                    return Err(self.problem(Expected::OneOf(&["x", "y"], "after `mirrored`")));
                }
                self.word("an axis")?;
            } else {
                self.at = before;
                return Ok(());
            }
        }
    }

    /// `c in 1 N*s/m .. 100 N*s/m, k in 1 N/m .. 50 N/m`
    fn varied_parameters(&mut self) -> Read {
        loop {
            self.path("the parameter")?;
            self.skip_blank()?;
            self.marker("in", "before the range")?;
            self.are_separated()?;
            self.expression("the lower bound")?;
            self.sign("..", "between the bounds")?;
            self.expression("the upper bound")?;
            if !self.comma() {
                return Ok(());
            }
        }
    }

    /// `while peak(y) < 20 mm, damping(1) > 1 %`, if present.
    fn limits(&mut self) -> Read {
        let before = self.at;
        if !(self.blanks() && self.eat_word("while")) {
            self.at = before;
            return Ok(());
        }
        self.are_separated()?;
        self.expression("a condition")?;
        while self.comma() {
            self.expression("a condition")?;
        }
        Ok(())
    }

    /// `spread 10 % within 30 %`, each of them if present.
    fn tolerance(&mut self) -> Read {
        let before = self.at;
        if self.blanks() && self.eat_word("spread") {
            self.are_separated()?;
            if !self.eat_word("uniform") {
                if self.eat_word("lognormal") {
                    self.are_separated()?;
                }
                self.expression("the standard deviation")?;
            }
        } else {
            self.at = before;
        }
        let before = self.at;
        if !(self.blanks() && self.eat_word("within")) {
            self.at = before;
            return Ok(());
        }
        self.are_separated()?;
        self.expression("a half-width or the lower bound")?;
        self.optional("..", |reader| reader.expression("the upper bound"))
    }

    /// Steps over a comma and the blanks around it.
    fn comma(&mut self) -> bool {
        let before = self.at;
        self.blanks();
        let found = self.eat(",");
        self.at = if found { self.at } else { before };
        found && {
            self.blanks();
            true
        }
    }

    /// `"axles.vib"`
    fn text(&mut self, which: &'static str) -> Read {
        self.blanks();
        if !self.eat("\"") {
            return Err(self.problem(Expected::Value(which)));
        }
        self.at += self.rest().find('"').map_or(self.rest().len(), |at| at + 1);
        Ok(())
    }

    fn end(&mut self, which: &'static str) -> Read {
        self.path(which)?;
        self.optional("@", Self::place)
    }

    /// `-- box`, if present.
    fn other_end(&mut self, which: &'static str) -> Read {
        self.optional("--", |reader| reader.end(which))
    }

    /// The point after `@`.
    fn place(&mut self) -> Read {
        self.blanks();
        if self.eat("(") {
            self.blanks();
            return self.list("a coordinate", ')');
        }
        if !self.next().is_some_and(words::is_letter) {
            return Err(self.problem(Expected::Value("a point, its name or `(x, y)`")));
        }
        self.path("a point")
    }

    fn along_clause(&mut self) -> Read {
        let before = self.at;
        if self.blanks() && self.eat_word("along") {
            self.are_separated()?;
            return self.expression("a direction");
        }
        self.at = before;
        Ok(())
    }

    fn signal(&mut self) -> Read {
        self.optional("=", |reader| reader.expression("a signal"))
    }

    fn line_end(&mut self) -> Read {
        self.blanks();
        if self.rest().is_empty() { Ok(()) } else { Err(self.problem(Expected::LineEnd)) }
    }

    // ---- Fields ----

    fn fields(&mut self) -> Read {
        self.blanks();
        if !self.eat("{") {
            return Err(self.problem(Expected::Sign("{", "before the fields")));
        }
        self.blanks();
        while !self.eat("}") {
            self.field()?;
            self.blanks_in_line();
            match self.next() {
                Some('}') => {}
                Some(',') => self.at += 1,
                Some('\n') => {
                    self.blanks();
                    self.eat(",");
                }
                _ => return Err(self.problem(Expected::Separator)),
            }
            self.blanks();
        }
        Ok(())
    }

    fn field(&mut self) -> Read {
        if !self.next().is_some_and(words::is_letter) {
            return Err(self.problem(Expected::Field));
        }
        let start = self.at;
        self.word("a field")?;
        let key = &self.text[start..self.at];
        let takes = kinds::field(key).map(|field| field.takes);
        let flag = matches!(takes, Some(Takes::Nothing));
        let moves = matches!(takes, Some(Takes::Motions));
        let after = self.at;
        let apart = self.blanks();
        if self.eat("=") {
            self.blanks();
            self.expression("the field's value")?;
            return self.about_clause();
        }
        if moves && apart && self.next().is_some_and(words::is_letter) {
            return self.moves();
        }
        self.at = after;
        self.blanks_in_line();
        match self.next() {
            None | Some('}' | ',' | '\n') if !moves => self.at = after,
            _ if moves => return Err(self.problem(Expected::Motion)),
            Some(':') => return Err(self.problem_with(Expected::Sign("=", "after a field's name"), Remark::FieldColon)),
            Some(';') => return Err(self.problem(Expected::Separator)),
            _ if flag => {}
            Some(_) if takes.is_none() && words::is_near(key, "moves") => {
                let remark = Remark::Moves(self.directions());
                return Err(self.problem_with(Expected::Sign("=", "after a field's name"), remark));
            }
            _ => return Err(self.problem(Expected::Sign("=", "after a field's name"))),
        }
        Ok(())
    }

    /// The directions of motion that stand here, as they are written after `moves`.
    fn directions(&self) -> &'static str {
        let words = self.rest().split([',', '}', '\n']).next().unwrap_or_default().split_whitespace();
        match words.take(3).collect::<Vec<_>>()[..] {
            ["y"] => "y",
            ["x", "y"] => "x y",
            ["y", "x"] => "y x",
            [first, ..] if first.starts_with("along") => "along (a, b)",
            _ => "x",
        }
    }

    fn moves(&mut self) -> Read {
        if self.eat_word("along") {
            self.are_separated()?;
            return self.expression("a direction");
        }
        loop {
            self.word("a motion")?;
            let after = self.at;
            self.blanks_in_line();
            if self.at == after || !self.next().is_some_and(words::is_letter) {
                self.at = after;
                return Ok(());
            }
        }
    }

    fn about_clause(&mut self) -> Read {
        let before = self.at;
        if self.blanks() && self.eat_word("about") {
            self.are_separated()?;
            return self.expression("a point");
        }
        self.at = before;
        Ok(())
    }

    // ---- Expressions ----

    fn expression(&mut self, what: &'static str) -> Read {
        let mut what = what;
        loop {
            while self.next() == Some('-') && !self.rest().starts_with("->") {
                self.at += 1;
                self.blanks();
                what = "a value after `-`";
            }
            self.operand(what)?;
            let after = self.at;
            self.blanks();
            if !self.operator() {
                self.at = after;
                return Ok(());
            }
            self.blanks();
            what = "a value after the operator";
        }
    }

    fn operator(&mut self) -> bool {
        ["->", "<=", ">=", "==", "+", "-", "*", "/", "^", "<", ">"].into_iter().any(|operator| self.eat(operator))
    }

    fn operand(&mut self, what: &'static str) -> Read {
        match self.next() {
            Some(c) if words::is_letter(c) => self.reference(),
            Some(c) if c.is_ascii_digit() => self.literal(),
            Some('.') if self.rest()[1..].starts_with(|c: char| c.is_ascii_digit()) => self.literal(),
            Some('(') => {
                self.at += 1;
                self.blanks();
                self.list("a value", ')')
            }
            Some('"') => {
                self.at += 1;
                self.at += self.rest().find('"').map_or(self.rest().len(), |at| at + 1);
                Ok(())
            }
            _ => Err(self.problem(Expected::Value(what))),
        }
    }

    /// The name in `speed = 20 m/s` and the `=`, if the next argument has them.
    fn argument_name(&mut self) {
        let before = self.at;
        let has_name = self.word("an argument").is_ok();
        self.blanks();
        if has_name && !self.rest().starts_with("==") && self.eat("=") {
            self.blanks();
        } else {
            self.at = before;
        }
    }

    /// Arguments up to the closing bracket.
    fn call(&mut self) -> Read {
        self.comma_separated(')', |reader| {
            reader.argument_name();
            reader.expression("an argument")?;
            reader.optional("..", |reader| reader.expression("the upper end of the range"))
        })
    }

    fn reference(&mut self) -> Read {
        self.word("a quantity")?;
        if self.eat("(") {
            self.blanks();
            if !self.eat(")") {
                self.call()?;
            }
        } else {
            self.indices()?;
        }
        loop {
            if self.next() == Some('.') && !self.rest().starts_with("..") {
                self.at += 1;
                self.name("a motion or quantity of the part")?;
            } else if self.eat("@") {
                self.place()?;
            } else {
                return Ok(());
            }
        }
    }

    fn digits(&mut self) -> bool {
        let count = self.rest().bytes().take_while(u8::is_ascii_digit).count();
        self.at += count;
        count > 0
    }

    fn literal(&mut self) -> Read {
        self.digits();
        let point = self.at;
        if !(self.eat(".") && self.digits()) {
            self.at = point;
        }
        let exponent = self.at;
        if self.eat("e") || self.eat("E") {
            let _sign = self.eat("+") || self.eat("-");
            if !self.digits() {
                self.at = exponent;
            }
        }
        self.unit();
        Ok(())
    }

    /// Steps over a unit and an optional blank before it.
    fn unit(&mut self) {
        let number = self.at;
        if self.eat(" ") {
            self.eat("/");
        }
        let word = self.at;
        let follows = words::FOLLOWS.into_iter().any(|word| self.eat_word(word));
        self.at = word;
        if follows || !self.factors() {
            self.at = number;
        }
    }

    /// Units, glued together.
    fn factors(&mut self) -> bool {
        if !self.factor() {
            return false;
        }
        loop {
            let after = self.at;
            let glued = ["*", "/", "·", "⋅"].into_iter().any(|sign| self.eat(sign));
            if !(glued && self.factor()) {
                self.at = after;
                return true;
            }
        }
    }

    fn factor(&mut self) -> bool {
        let unit_letter = |c: char| words::is_letter(c) || matches!(c, '%' | '°');
        if !self.next().is_some_and(unit_letter) {
            return false;
        }
        let len = self.rest().find(|c: char| !unit_letter(c) && !c.is_ascii_digit()).unwrap_or(self.rest().len());
        self.at += len;
        let power = self.at;
        if self.eat("^") {
            self.eat("-");
            if !self.digits() {
                self.at = power;
            }
        } else if !self.eat("²") {
            self.eat("³");
        }
        true
    }
}

fn in_word(c: char) -> bool {
    words::is_letter(c) || c.is_ascii_digit()
}
