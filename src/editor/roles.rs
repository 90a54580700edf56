//! The role of each word of a text: a keyword, a name that is declared or used, a field, a motion, a function. See
//! spec.md#keywords, spec.md#declarations and spec.md#names.
//!
//! The role follows from the neighbouring tokens, so that names keep their meaning in text that does not parse.

use super::outline::{Outline, Statement};
use super::tokens::{Token, TokenKind};
use crate::base::Field;
pub use crate::kinds::Space;
use crate::kinds::{self, Argument, Declaration, Naming, Piece, functions};
use crate::syntax::words;

/// The role of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Not a word, or a word of unknown role.
    None,
    /// The first word of a declaration.
    Keyword,
    /// `in`, `along`, `about`, `moves`, `turns`, `modal`, ...
    Word,
    /// `x` in `moves x` and `along x`.
    Direction,
    /// `mass` in `mass = 1 kg`.
    Field,
    /// `angle` in `rod.angle`.
    Member,
    Function,
    /// `pi`, `ground`, `stable`.
    Constant,
    /// The name of the model.
    Title,
    /// A name at its declaration; `scope` is the `repeat` whose index it is.
    Declaration {
        space: Space,
        scope: Option<usize>,
    },
    /// A name at its use.
    Reference {
        space: Space,
        scope: Option<usize>,
    },
}

impl Role {
    /// Name space and scope of a name.
    pub fn name(self) -> Option<(Space, Option<usize>)> {
        match self {
            Role::Declaration { space, scope } | Role::Reference { space, scope } => Some((space, scope)),
            _ => None,
        }
    }
}

/// The role of each token.
pub fn roles(text: &str, tokens: &[Token], outline: &Outline) -> Vec<Role> {
    let mut roles = vec![Role::None; tokens.len()];
    for (index, statement) in outline.statements.iter().enumerate() {
        let reader = Reader { text, tokens, outline, index, keyword: keyword(text, tokens, statement) };
        reader.read(statement, &mut roles);
    }
    roles
}

/// The keyword of a statement; empty if it starts with something else.
pub fn keyword<'t>(text: &'t str, tokens: &[Token], statement: &Statement) -> &'t str {
    let first = tokens[statement.tokens.start].text(text);
    if words::is_keyword(first) { first } else { "" }
}

struct Reader<'a> {
    text: &'a str,
    tokens: &'a [Token],
    outline: &'a Outline,
    index: usize,
    keyword: &'a str,
}

/// The state while the words of a statement are classified.
struct State {
    open: Vec<Opened>,
    /// Whether an expression follows, as after the `=` of an assignment or after `along`.
    in_ends: bool,
    /// Whether `along` or `moves` came last, so that directions follow.
    directions: bool,
}

/// An open bracket, and the function to which it belongs.
struct Opened {
    bracket: char,
    function: Option<usize>,
}

impl Reader<'_> {
    fn word(&self, at: usize) -> &str {
        self.tokens[at].text(self.text)
    }

    fn is_sign(&self, at: Option<usize>, sign: &str) -> bool {
        at.is_some_and(|at| self.word(at) == sign)
    }

    /// The next token that is neither a line end nor a comment.
    fn next(&self, at: usize) -> Option<usize> {
        let end = self.outline.statements[self.index].tokens.end;
        (at + 1..end).find(|&at| !is_gap(&self.tokens[at]))
    }

    fn read(&self, statement: &Statement, roles: &mut [Role]) {
        let start = statement.tokens.start;
        let mut state = State { open: Vec::new(), in_ends: false, directions: false };
        let mut last: Option<usize> = None;
        let mut line_ended = false;
        for at in statement.tokens.clone() {
            let token = &self.tokens[at];
            if is_gap(token) {
                line_ended |= token.kind == TokenKind::LineEnd;
                continue;
            }
            if token.kind == TokenKind::Word {
                roles[at] = match at - start {
                    0 if !self.keyword.is_empty() => Role::Keyword,
                    1 if !self.keyword.is_empty() => self.second(at),
                    _ => self.role_of_other(at, last, line_ended, &mut state),
                };
            }
            self.step(at, last, &mut state);
            last = Some(at);
            line_ended = false;
        }
    }

    /// The word after the keyword.
    fn second(&self, at: usize) -> Role {
        let Some(declaration) = kinds::declaration(self.keyword) else { return Role::None };
        match declaration.naming() {
            Some(Naming::New(Space::Components)) => Role::Declaration { space: Space::Components, scope: None },
            Some(Naming::New(space)) => Role::Declaration { space, scope: self.component() },
            Some(Naming::Index) => Role::Declaration { space: Space::Values, scope: Some(self.index) },
            Some(Naming::Title) => Role::Title,
            Some(Naming::Of(space @ (Space::Parts | Space::Places | Space::Components))) => {
                Role::Reference { space, scope: self.component() }
            }
            Some(Naming::Of(Space::Values)) => self.value(at),
            None if matches!(declaration.pieces.first(), Some(Piece::Apart)) => self.expression(at, None, &[]),
            None => Role::Word,
        }
    }

    /// A value, or the index of an enclosing `repeat`.
    fn value(&self, at: usize) -> Role {
        let word = self.word(at);
        let indexed = |repeat: &usize| {
            let statement = &self.outline.statements[*repeat];
            let repeats = keyword(self.text, self.tokens, statement) == "repeat";
            let index = self.tokens.get(statement.tokens.start + 1);
            repeats && index.is_some_and(|index| index.text(self.text) == word)
        };
        let scope = self.outline.enclosing(self.index).find(indexed).or_else(|| self.component());
        Role::Reference { space: Space::Values, scope }
    }

    /// The component that the statement belongs to; the component's names are known only inside it.
    fn component(&self) -> Option<usize> {
        let declares = |index: &usize| keyword(self.text, self.tokens, &self.outline.statements[*index]) == "component";
        std::iter::once(self.index).chain(self.outline.enclosing(self.index)).find(declares)
    }

    fn part(&self, word: &str) -> Role {
        if word == "ground" {
            return Role::Constant;
        }
        Role::Reference { space: Space::Parts, scope: self.component() }
    }

    /// A word in the brackets of a component: a port, a parameter, the unit of one, or part of a default.
    fn formal(&self, at: usize, last: Option<usize>, open: &[Opened]) -> Role {
        let starts = self.is_sign(last, "(") || self.is_sign(last, ",");
        let scope = Some(self.index);
        let goes_on = self.next(at).is_some_and(|next| self.tokens[next].kind == TokenKind::Word);
        if starts && self.word(at) == "part" && goes_on {
            return Role::Word;
        }
        if starts {
            return Role::Declaration { space: Space::Values, scope };
        }
        if last.is_some_and(|last| self.word(last) == "part" && self.tokens[last].kind == TokenKind::Word) {
            return Role::Declaration { space: Space::Parts, scope };
        }
        let unit = (self.outline.statements[self.index].tokens.start..at)
            .rev()
            .map(|before| self.word(before))
            .find(|before| matches!(*before, ":" | "=" | "," | "("));
        if unit == Some(":") { Role::None } else { self.expression(at, last, open) }
    }

    /// A word of a `place` behind its name: the component, an argument, a clause, or part of a value.
    fn place_role(&self, at: usize, last: Option<usize>, open: &[Opened]) -> Role {
        let word = self.word(at);
        let start = self.outline.statements[self.index].tokens.start;
        let is_first = (start..at).filter(|before| self.word(*before) == "=").count() == 1;
        match open.len() {
            0 if is_first && self.is_sign(last, "=") => Role::Reference { space: Space::Components, scope: None },
            0 if matches!(word, "at" | "turned" | "mirrored") => Role::Word,
            0 if last.is_some_and(|last| self.word(last) == "mirrored") => Role::Direction,
            1 if (self.is_sign(last, "(") || self.is_sign(last, ",")) && self.is_sign(self.next(at), "=") => {
                Role::Field
            }
            _ if word == "ground" && !self.is_sign(last, ".") => Role::Constant,
            _ => self.expression(at, last, open),
        }
    }

    fn role_of_other(&self, at: usize, last: Option<usize>, line_ended: bool, state: &mut State) -> Role {
        match self.keyword {
            "component" => return self.formal(at, last, &state.open),
            "place" => return self.place_role(at, last, &state.open),
            _ => {}
        }
        let (word, next) = (self.word(at), self.next(at));
        let braces = state.open.last().is_some_and(|open| open.bracket == '{');
        let after_value = last.is_some_and(|last| ends_value(&self.tokens[last]));
        let field_starts = braces && (self.is_sign(last, "{") || self.is_sign(last, ",") || line_ended && after_value);
        if field_starts {
            state.directions = matches!(word, "moves" | "along");
            let alone = !self.is_sign(next, "=") && kinds::field(word).is_some_and(Field::stands_alone);
            return if alone { Role::Word } else { Role::Field };
        }
        let of_optimum = matches!(self.keyword, "minimise" | "maximise") && state.open.is_empty();
        let of_tolerance = self.keyword == "param" && state.open.is_empty();
        let after_spread = of_tolerance && last.is_some_and(|last| self.word(last) == "spread");
        if after_spread && matches!(word, "uniform" | "lognormal") {
            return Role::Word;
        }
        if (matches!(word, "along" | "about" | "in")
            || of_optimum && matches!(word, "over" | "while")
            || of_tolerance && matches!(word, "spread" | "within"))
            && after_value
            && !self.is_sign(last, ":")
            && !self.is_sign(last, "--")
        {
            state.directions = word == "along";
            state.in_ends = false;
            return Role::Word;
        }
        if matches!((self.keyword, word), ("rest", "drawn")) || state.directions && word == "along" {
            return Role::Word;
        }
        if state.directions && matches!(word, "x" | "y") {
            return Role::Direction;
        }
        if state.in_ends && state.open.is_empty() && (self.is_sign(last, ":") || self.is_sign(last, "--")) {
            return self.part(word);
        }
        if self.keyword == "output" && state.open.is_empty() && !self.has_before(at, "=") {
            // The unit after `in`.
            return Role::None;
        }
        self.expression(at, last, &state.open)
    }

    /// Whether a sign stands before a place in the statement.
    fn has_before(&self, at: usize, sign: &str) -> bool {
        (self.outline.statements[self.index].tokens.start..at).any(|before| self.word(before) == sign)
    }

    fn expression(&self, at: usize, last: Option<usize>, open: &[Opened]) -> Role {
        let word = self.word(at);
        let end = self.tokens[at].range.end;
        if self.is_sign(last, ".") {
            return Role::Member;
        }
        if self.is_sign(last, "@") {
            return self.value(at);
        }
        if self.text[end..].starts_with('(') {
            return Role::Function;
        }
        let in_call = open.last().is_some_and(|open| open.function.is_some());
        if in_call && self.is_sign(self.next(at), "=") {
            return Role::Field;
        }
        let after = self.after_indices(at);
        let named_before = [".", "@", "->"].iter().any(|sign| self.is_sign(after, sign));
        let of_output =
            open.last().and_then(|open| open.function).is_some_and(|function| takes_part(self.word(function)));
        if named_before || self.is_sign(last, "->") || of_output {
            return self.part(word);
        }
        let is_before_number =
            || self.next(at).is_some_and(|next| matches!(self.tokens[next].kind, TokenKind::Number { .. }));
        match (self.keyword, word) {
            // `white 3 N^2/Hz`
            (_, "white") if in_call && is_before_number() => Role::Word,
            (_, "pi") | ("require", "stable") => Role::Constant,
            ("require" | "solve" | "minimise" | "maximise", "load_factor") => Role::Constant,
            _ => self.value(at),
        }
    }

    /// The token after a name and its indices.
    fn after_indices(&self, at: usize) -> Option<usize> {
        let mut next = self.next(at)?;
        while self.word(next) == "[" {
            let mut depth = 0_usize;
            loop {
                match self.tokens[next].kind {
                    TokenKind::Open => depth += 1,
                    TokenKind::Close => depth = depth.saturating_sub(1),
                    _ => {}
                }
                next = self.next(next)?;
                if depth == 0 {
                    break;
                }
            }
        }
        Some(next)
    }

    fn step(&self, at: usize, last: Option<usize>, state: &mut State) {
        let token = &self.tokens[at];
        match (token.kind, self.word(at)) {
            (TokenKind::Open, bracket) => {
                let glued = last.filter(|last| {
                    self.tokens[*last].kind == TokenKind::Word && self.tokens[*last].range.end == token.range.start
                });
                let function = glued.filter(|_| bracket == "(");
                state.open.push(Opened { bracket: bracket.chars().next().unwrap_or('('), function });
                state.directions &= bracket != "{";
            }
            (TokenKind::Close, _) => drop(state.open.pop()),
            (TokenKind::Sign, ":") if state.open.is_empty() => state.in_ends = has_ends(self.keyword),
            (TokenKind::Sign, "=") if state.open.is_empty() => (state.in_ends, state.directions) = (false, false),
            (TokenKind::Sign, ",") => state.directions = false,
            _ => {}
        }
    }
}

/// Whether the first argument of a function is an input or an output.
pub fn takes_part(function: &str) -> bool {
    let function = functions::function(function);
    function.is_some_and(|(_, function)| matches!(function.arguments.first(), Some(Argument::Output | Argument::Input)))
}

/// Whether declarations with this keyword connect two ends.
pub fn has_ends(keyword: &str) -> bool {
    kinds::declaration(keyword).is_some_and(Declaration::has_ends)
}

fn is_gap(token: &Token) -> bool {
    matches!(token.kind, TokenKind::LineEnd | TokenKind::Comment)
}

fn ends_value(token: &Token) -> bool {
    matches!(token.kind, TokenKind::Word | TokenKind::Number { .. } | TokenKind::Text | TokenKind::Close)
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    /// Each word with a letter for its role.
    fn mark_roles(text: &str) -> String {
        let tokens = tokens(text);
        let outline = Outline::new(text, &tokens);
        let roles = roles(text, &tokens, &outline);
        let words = tokens.iter().zip(roles).filter(|(token, _)| token.kind == TokenKind::Word);
        let marked = words.map(|(token, role)| {
            let mark = match role {
                Role::None => "?",
                Role::Keyword => "K",
                Role::Word => "w",
                Role::Direction => "d",
                Role::Field => "f",
                Role::Member => "m",
                Role::Function => "F",
                Role::Constant => "c",
                Role::Title => "t",
                Role::Declaration { space: Space::Values, scope: None } => "V",
                Role::Declaration { space: Space::Values, .. } => "I",
                Role::Declaration { space: Space::Parts, .. } => "P",
                Role::Reference { space: Space::Values, scope: None } => "v",
                Role::Reference { space: Space::Values, .. } => "i",
                Role::Reference { space: Space::Parts, .. } => "p",
                Role::Declaration { space: Space::Places, .. } => "L",
                Role::Reference { space: Space::Places, .. } => "l",
                Role::Declaration { space: Space::Components, .. } => "C",
                Role::Reference { space: Space::Components, .. } => "n",
            };
            format!("{}:{mark}", token.text(text))
        });
        marked.collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn every_word_has_its_role() {
        for (text, expected) in [
            ("param k = 2 N/m + f(a)", "param:K k:V f:F a:v"),
            (
                "body b { mass = m, moves x y, at = A\n turns\n shape = rod(A, B) }",
                "body:K b:P mass:f m:v moves:w x:d y:d at:f A:v turns:w shape:f rod:F A:v B:v",
            ),
            (
                "spring k: ground@A -- b[i] { k = k, along = x }",
                "spring:K k:P ground:c A:v b:p i:v k:f k:v along:f x:d",
            ),
            (
                "repeat i in 1..n {\n pivot p[i]: a[i]@O -- a[i+1]\n}",
                "repeat:K i:I in:w n:v pivot:K p:P i:i a:p i:i O:v a:p i:i",
            ),
            ("force F: b along x = harmonic(x, f)", "force:K F:P b:p along:w x:d harmonic:F x:v f:v"),
            ("output y[i] in N*m = b.x", "output:K y:P i:v in:w N:? m:? b:p x:m"),
            ("output y = 2 * b@A.x + s[i + 1].force", "output:K y:P b:p A:v x:m s:p i:v force:m"),
            ("require gain(floor -> table.y, f) < peak(tip)", "require:K gain:F floor:p table:p y:m f:v peak:F tip:p"),
            (
                "minimise peak(y) + a over c in 1 .. b, k in d .. 2 while peak(y) < 3, damping(1) > e",
                "minimise:K peak:F y:p a:v over:w c:v in:w b:v k:v in:w d:v while:w peak:F y:p damping:F e:v",
            ),
            (
                "param e = a spread lognormal b within c .. d",
                "param:K e:V a:v spread:w lognormal:w b:v within:w c:v d:v",
            ),
            ("param e = a spread uniform within b", "param:K e:V a:v spread:w uniform:w within:w b:v"),
            ("param spread = within", "param:K spread:V within:v"),
            ("correlate k, m[i] a", "correlate:K k:v m:v i:v a:v"),
            ("solve fn in a .. b: static(y) = c", "solve:K fn:v in:w a:v b:v static:F y:p c:v"),
            ("initial b { x = 1 mm }", "initial:K b:p x:f"),
            ("damping modal z", "damping:K modal:w z:v"),
            (
                "component c(part p, m: kg, k = 2 * q) {\n body b { mass = m, at = A }\n spring s: p -- b { k = k }\n}",
                "component:K c:C part:w p:P m:I kg:? k:I q:i body:K b:P mass:f m:i at:f A:i spring:K s:P p:p b:p k:f k:i",
            ),
            ("place f = c(p = ground, m = n) at (x, 0)", "place:K f:L c:n p:f ground:c m:f n:v at:w x:v"),
            (
                "place f = c(p = b, m = n) at (x, 0) mirrored x turned a",
                "place:K f:L c:n p:f b:v m:f n:v at:w x:v mirrored:w x:d turned:w a:v",
            ),
            (
                "body b { inertia = j about A, moves along d }",
                "body:K b:P inertia:f j:v about:w A:v moves:w along:w d:v",
            ),
        ] {
            assert_eq!(mark_roles(text), expected);
        }
    }
}
