//! Splits any text into words, numbers, signs and comments; text with errors has tokens too. See spec.md#text.
//!
//! The parser keeps no comments and no signs, and no content of a declaration that it rejects; the formatter and an
//! editor need all of these. Tokens follow the grammar's rules of words, numbers and units exactly; their meaning is
//! left to the tree.

use crate::syntax::words;
use std::ops::Range;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenKind {
    Word,
    /// A number with its unit: the number takes this many bytes, and the unit is the rest, possibly after one blank.
    Number {
        number_len: usize,
    },
    /// A string with its quotes; to the end of the line if it is not closed.
    Text,
    /// A comment from its slashes to the last character of the line that is not a blank.
    Comment,
    LineEnd,
    /// `(`, `[` or `{`
    Open,
    /// `)`, `]` or `}`
    Close,
    /// Everything else: operators, `:`, `,`, `@`, `.`, and characters that are not part of the language.
    Sign,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token {
    pub kind: TokenKind,
    pub range: Range<usize>,
}

impl Token {
    pub fn text<'t>(&self, text: &'t str) -> &'t str {
        &text[self.range.clone()]
    }

    /// The unit of a number, with the slash of `0.1 /s`.
    pub fn unit(&self, text: &str) -> Option<Range<usize>> {
        let TokenKind::Number { number_len } = self.kind else { return None };
        let after = self.range.start + number_len;
        let start =
            after + text[after..self.range.end].len() - text[after..self.range.end].trim_start_matches(' ').len();
        (start < self.range.end).then_some(start..self.range.end)
    }
}

/// The characters that the language treats as blanks in a line; blanks of other scripts are ordinary characters.
const BLANKS: [char; 3] = [' ', '\t', '\r'];

/// Every token of a text, in order, separated by blanks.
pub fn tokens(text: &str) -> Vec<Token> {
    let mut tokens = Vec::with_capacity(text.len() / 4);
    let mut at = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    while let Some(first) = text[at..].chars().next() {
        if BLANKS.contains(&first) {
            at += 1;
            continue;
        }
        let (kind, end) = token(text, at, first);
        tokens.push(Token { kind, range: at..end });
        // A comment does not include the blanks at its end.
        at = end;
    }
    tokens
}

fn token(text: &str, at: usize, first: char) -> (TokenKind, usize) {
    let rest = &text[at..];
    if rest.starts_with("//") {
        let line = rest.find('\n').map_or(rest, |end| &rest[..end]);
        return (TokenKind::Comment, at + line.trim_end_matches(BLANKS).len());
    }
    if let Some(end) = number_end(text, at) {
        return (TokenKind::Number { number_len: end - at }, unit_after(text, end).unwrap_or(end));
    }
    match first {
        '\n' => (TokenKind::LineEnd, at + 1),
        '(' | '[' | '{' => (TokenKind::Open, at + 1),
        ')' | ']' | '}' => (TokenKind::Close, at + 1),
        '"' => (TokenKind::Text, at + string_len(rest)),
        _ if words::is_letter(first) => (TokenKind::Word, word_end(text, at)),
        _ => (TokenKind::Sign, at + sign_len(rest, first)),
    }
}

/// Signs of two characters, before those of one.
const SIGNS: [&str; 6] = ["--", "->", "..", "<=", ">=", "=="];

fn sign_len(rest: &str, first: char) -> usize {
    if SIGNS.iter().any(|sign| rest.starts_with(sign)) { 2 } else { first.len_utf8() }
}

fn string_len(rest: &str) -> usize {
    match rest[1..].find(['"', '\n']) {
        Some(end) if rest[1 + end..].starts_with('"') => end + 2,
        Some(end) => 1 + rest[1..1 + end].trim_end_matches(BLANKS).len(),
        None => 1 + rest[1..].trim_end_matches(BLANKS).len(),
    }
}

/// The end of the word that continues at a place.
fn word_end(text: &str, at: usize) -> usize {
    let rest = &text[at..];
    at + rest.find(|c: char| !words::is_letter(c) && !c.is_ascii_digit()).unwrap_or(rest.len())
}

fn digits_end(text: &str, at: usize) -> usize {
    at + text[at..].bytes().take_while(u8::is_ascii_digit).count()
}

/// `10`, `0.5`, `.5`, `1e-4`: the end of the number that starts at a place.
fn number_end(text: &str, at: usize) -> Option<usize> {
    let mut end = digits_end(text, at);
    if text[end..].starts_with('.') {
        let fraction = digits_end(text, end + 1);
        if fraction > end + 1 {
            end = fraction;
        }
    }
    if end == at {
        return None;
    }
    if text[end..].starts_with(['e', 'E']) {
        let sign = usize::from(text[end + 1..].starts_with(['+', '-']));
        let exponent = digits_end(text, end + 1 + sign);
        if exponent > end + 1 + sign {
            end = exponent;
        }
    }
    Some(end)
}

/// The end of the unit of a number that ends at a place: directly after it, after one blank, or after ` /`.
fn unit_after(text: &str, end: usize) -> Option<usize> {
    let rest = &text[end..];
    let start = match rest.strip_prefix(' ') {
        Some(after) => end + 1 + usize::from(after.starts_with('/')),
        None => end,
    };
    if words::FOLLOWS.contains(&&text[start..word_end(text, start)]) {
        return None;
    }
    let mut end = power_end(text, unit_word_end(text, start)?);
    while let Some(sign) = text[end..].chars().next().filter(|c| matches!(c, '*' | '/' | '·' | '⋅')) {
        let Some(word) = unit_word_end(text, end + sign.len_utf8()) else { break };
        end = power_end(text, word);
    }
    Some(end)
}

fn unit_word_end(text: &str, at: usize) -> Option<usize> {
    let letter = |c: char| words::is_letter(c) || matches!(c, '%' | '°');
    let rest = &text[at..];
    rest.starts_with(letter).then(|| at + rest.find(|c: char| !letter(c) && !c.is_ascii_digit()).unwrap_or(rest.len()))
}

fn power_end(text: &str, at: usize) -> usize {
    let rest = &text[at..];
    if rest.starts_with(['²', '³']) {
        return at + 2;
    }
    let Some(power) = rest.strip_prefix('^') else { return at };
    let start = at + 1 + usize::from(power.starts_with('-'));
    let end = digits_end(text, start);
    if end > start { end } else { at }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &str) -> Vec<&str> {
        tokens(text).iter().map(|token| token.text(text)).collect()
    }

    #[test]
    fn a_number_takes_its_unit_with_it() {
        assert_eq!(texts("10 N/m * L"), ["10 N/m", "*", "L"]);
        assert_eq!(texts("10 N / m, 0.1 /s, 1/s"), ["10 N", "/", "m", ",", "0.1 /s", ",", "1", "/", "s"]);
        assert_eq!(texts("5 %  1e-4kg·m² 2 about 2e x"), ["5 %", "1e-4kg·m²", "2", "about", "2e", "x"]);
        assert_eq!(texts("2..100 .5 m^-2^n"), ["2", "..", "100", ".5 m^-2", "^", "n"]);
    }

    #[test]
    fn a_comment_ends_where_the_parser_ends_it() {
        // No-break, ogham, en, figure, line and paragraph separators, narrow, mathematical, ideographic.
        for blank in "\u{a0}\u{1680}\u{2000}\u{2007}\u{2028}\u{2029}\u{202f}\u{205f}\u{3000}".chars() {
            let text = format!("// note{blank} \t\r\nx");
            assert_eq!(texts(&text), [&format!("// note{blank}"), "\n", "x"], "{blank:?}");
        }
    }

    #[test]
    fn any_text_has_tokens() {
        assert_eq!(
            texts("\u{feff}a@(b) -- \"open  \n/// doc \r\n\u{1}é"),
            ["a", "@", "(", "b", ")", "--", "\"open", "\n", "/// doc", "\n", "\u{1}", "é"]
        );
        let unit = |text: &str| tokens(text)[0].unit(text).map(|unit| text[unit].to_string());
        assert_eq!([unit("0.1 /s"), unit("10N"), unit("3")], [Some("/s".into()), Some("N".into()), None]);
    }
}
