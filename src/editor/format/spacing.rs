//! The spaces in a line. See spec.md#layout.
//!
//! One space around operators, after a comma and a colon and inside braces; none inside `( )` and `[ ]`, around `.`,
//! `@` and `^`, or after the sign of a value. Indices and the range of a `repeat` are written without spaces: `m[i-1]`,
//! `2..n-1`.

use crate::editor::roles;
use crate::editor::tokens::{Token, TokenKind};

/// A token as it is written in a line.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub text: String,
    pub role: Role,
    /// Where the token starts in the text.
    pub at: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Word,
    /// A word before a value: a bracket after it is preceded by a space.
    Keyword,
    Value {
        unit: bool,
    },
    Open(char),
    Close,
    Comma,
    Colon,
    /// `.`, `@`, `^`
    Glue,
    /// `-` before a value.
    Minus,
    Operator {
        close: bool,
    },
    /// `--`, `=`, `->`, comparisons.
    Relation,
    Range {
        close: bool,
    },
    Comment,
    LineEnd,
}

/// The tokens of one declaration, each with its role in a line.
pub(super) fn pieces(text: &str, tokens: &[Token]) -> Vec<Piece> {
    let keyword = tokens.first().map_or("", |token| token.text(text));
    let mut reader =
        Reader { text, keyword, pieces: Vec::with_capacity(tokens.len()), open: Vec::new(), connected: false };
    for token in tokens {
        reader.token(token);
    }
    reader.pieces
}

/// Whether there is a space between two pieces.
pub(super) fn needs_space(left: &Piece, right: &Piece) -> bool {
    match (left.role, right.role) {
        (_, Role::Comma | Role::Colon | Role::Glue) | (Role::Glue | Role::Minus, _) => false,
        (Role::Open('(' | '['), _) | (_, Role::Open('[')) | (Role::Word, Role::Open('(')) => false,
        (Role::Open(_), Role::Close) => false,
        (_, Role::Close) => right.text == "}",
        (Role::Operator { .. }, Role::Minus) => true,
        (Role::Operator { close }, _) | (_, Role::Operator { close }) => !close,
        (Role::Range { close }, _) | (_, Role::Range { close }) => !close,
        _ => true,
    }
}

/// The pieces in one line.
pub(super) fn join<'p>(pieces: impl IntoIterator<Item = &'p Piece>) -> String {
    let mut line = String::new();
    let mut last: Option<&Piece> = None;
    for piece in pieces {
        if last.is_some_and(|last| needs_space(last, piece)) {
            line.push(' ');
        }
        line += &piece.text;
        last = Some(piece);
    }
    line
}

struct Reader<'a> {
    text: &'a str,
    /// The first word of the declaration.
    keyword: &'a str,
    pieces: Vec<Piece>,
    open: Vec<char>,
    /// Whether the `--` between two ends has been passed.
    connected: bool,
}

impl Reader<'_> {
    fn token(&mut self, token: &Token) {
        let text = token.text(self.text);
        let role = match token.kind {
            TokenKind::Word if self.is_keyword(text) => Role::Keyword,
            TokenKind::Word | TokenKind::Text => Role::Word,
            TokenKind::Number { .. } => return self.number(token),
            TokenKind::Comment => Role::Comment,
            TokenKind::LineEnd => Role::LineEnd,
            TokenKind::Open => {
                let bracket = text.chars().next().unwrap_or('(');
                self.open.push(bracket);
                Role::Open(bracket)
            }
            TokenKind::Close => {
                self.open.pop();
                Role::Close
            }
            TokenKind::Sign => return self.sign(token, text),
        };
        self.push(text, role, token.range.start);
    }

    fn push(&mut self, text: &str, role: Role, at: usize) {
        self.pieces.push(Piece { text: text.into(), role, at });
    }

    /// Whether a word is a keyword at this place: the word that starts the declaration, or one after a name or a value.
    /// Elsewhere, a parameter called `in` or a part called `about` is a name.
    fn is_keyword(&self, word: &str) -> bool {
        match self.visible().map(|last| last.role) {
            None => true,
            Some(Role::Word | Role::Value { .. } | Role::Close) => {
                let clause =
                    self.keyword == "place" && self.open.is_empty() && matches!(word, "at" | "turned" | "mirrored");
                let of_optimum = matches!(self.keyword, "minimise" | "maximise")
                    && self.open.is_empty()
                    && matches!(word, "over" | "while");
                let of_tolerance =
                    self.keyword == "param" && self.open.is_empty() && matches!(word, "spread" | "within");
                clause || of_optimum || of_tolerance || matches!(word, "in" | "along" | "about")
            }
            Some(Role::Keyword) => {
                matches!((self.keyword, word), ("damping", "modal") | ("param", "uniform" | "lognormal" | "within"))
            }
            Some(_) => false,
        }
    }

    /// The previous piece, ignoring line ends and comments.
    fn visible(&self) -> Option<&Piece> {
        self.pieces.iter().rev().find(|piece| !matches!(piece.role, Role::Comment | Role::LineEnd))
    }

    fn number(&mut self, token: &Token) {
        let TokenKind::Number { number_len } = token.kind else { return };
        let number = &self.text[token.range.start..token.range.start + number_len];
        let (text, unit) = match token.unit(self.text) {
            Some(unit) => (format!("{number} {}", &self.text[unit]), true),
            None => (number.into(), false),
        };
        self.pieces.push(Piece { text, role: Role::Value { unit }, at: token.range.start });
    }

    fn sign(&mut self, token: &Token, text: &str) {
        let at = token.range.start;
        if text == "--" && !self.connects() {
            self.minus(at);
            return self.minus(at + 1);
        }
        let role = match text {
            // In the unit of a component's parameter, or of an output.
            "/" | "*" | "·" | "⋅" if self.is_unit() => Role::Glue,
            "²" | "³" if self.is_unit() => Role::Close,
            "%" | "°" if self.is_unit() => Role::Word,
            "," => Role::Comma,
            ":" => Role::Colon,
            "." | "@" | "^" => Role::Glue,
            ".." => Role::Range { close: self.is_close() },
            "-" => return self.minus(at),
            "+" => Role::Operator { close: self.is_close() },
            "*" | "/" => {
                // Directly after a unit, they would become part of it.
                let unit = matches!(self.visible(), Some(Piece { role: Role::Value { unit: true }, .. }));
                Role::Operator { close: self.is_close() && !unit }
            }
            _ => Role::Relation,
        };
        self.push(text, role, at);
    }

    fn minus(&mut self, at: usize) {
        let after_value =
            self.visible().is_some_and(|last| matches!(last.role, Role::Word | Role::Value { .. } | Role::Close));
        let after_value = after_value && !self.starts_coefficient();
        let role = if after_value { Role::Operator { close: self.is_close() } } else { Role::Minus };
        self.push("-", role, at);
    }

    /// Whether the coefficient of `correlate k, m -0.8` starts here: after the second path, which holds no two words in a row.
    fn starts_coefficient(&self) -> bool {
        let path = self.pieces.iter().rposition(|piece| piece.role == Role::Comma).map(|at| &self.pieces[at..]);
        let begins = |pair: &[Piece]| {
            matches!(pair[0].role, Role::Word | Role::Close)
                && matches!(pair[1].role, Role::Word | Role::Value { .. } | Role::Minus | Role::Open('('))
        };
        self.keyword == "correlate" && self.open.is_empty() && path.is_some_and(|path| !path.windows(2).any(begins))
    }

    /// Whether the current piece belongs to the unit after a colon, `k: N*m/rad`, or after the `in` of an output.
    fn is_unit(&self) -> bool {
        if self.keyword == "output" {
            return self.open.is_empty() && !self.pieces.iter().any(|piece| piece.text == "=");
        }
        let ends =
            |piece: &&Piece| matches!(piece.role, Role::Colon | Role::Comma | Role::Open(_)) || piece.text == "=";
        let before = self.pieces.iter().rev().find(ends);
        self.keyword == "component" && before.is_some_and(|piece| piece.role == Role::Colon)
    }

    /// Whether the place is in an index or in the range of a `repeat`.
    fn is_close(&self) -> bool {
        self.open.contains(&'[') || self.keyword == "repeat"
    }

    /// Whether the `--` at this place connects the two ends of a part, as opposed to two signs of a value.
    fn connects(&mut self) -> bool {
        let has_ends = roles::has_ends(self.keyword);
        let after_end = self.visible().is_some_and(|last| matches!(last.role, Role::Word | Role::Close));
        let connects = has_ends && after_end && self.open.is_empty() && !self.connected;
        self.connected |= connects;
        connects
    }
}
