//! The words that start declarations, as the parser meets them in a text. See spec.md#keywords.

use crate::kinds::{self, DECLARATIONS, Declaration};
use std::ops::Range;

/// Words that continue a declaration after a number and so are not units. The rule `follows` of the grammar.
pub const FOLLOWS: [&str; 8] = ["about", "at", "turned", "mirrored", "over", "while", "within", "spread"];

/// The words of a tolerance, and how messages show them.
pub(super) const OF_TOLERANCE: [(&str, &str); 4] =
    [("within", "`within`"), ("spread", "`spread`"), ("lognormal", "`lognormal`"), ("uniform", "`uniform`")];

pub fn is_keyword(word: &str) -> bool {
    kinds::declaration(word).is_some()
}

/// The declaration that a word may be meant to start: the one of which it is a synonym, or the one whose keyword needs
/// the fewest edits.
pub(super) fn nearest(word: &str) -> Option<&'static Declaration> {
    let word = word.to_lowercase();
    if let Some(declaration) = DECLARATIONS.iter().find(|declaration| declaration.synonyms.contains(&&*word)) {
        return Some(declaration);
    }
    let distance = |declaration: &&Declaration| strsim::damerau_levenshtein(declaration.keyword, &word);
    DECLARATIONS.iter().min_by_key(distance).filter(|nearest| is_near(&word, nearest.keyword))
}

/// Whether a word may be a known one with letters mistyped: a third of them, as rustc does.
pub(super) fn is_near(word: &str, known: &str) -> bool {
    strsim::damerau_levenshtein(known, word) * 3 <= word.chars().count().max(known.len())
}

/// The lower-case word at the start of a text; may be empty.
pub(super) fn first_word(text: &[u8]) -> &[u8] {
    let end = text.iter().position(|b| !b.is_ascii_lowercase()).unwrap_or(text.len());
    &text[..end]
}

/// The keyword at the start of a line that can only be a declaration: a keyword and, after blanks, a word (or a value,
/// for `gravity`).
pub fn starts_declaration(line: &[u8]) -> Option<Range<usize>> {
    let start = line.len() - skip_blanks(line).len();
    let word = first_word(&line[start..]);
    let rest = &line[start + word.len()..];
    let after = skip_blanks(rest);
    let starts = std::str::from_utf8(word).is_ok_and(is_keyword)
        && rest.first().is_some_and(|b| matches!(b, b' ' | b'\t'))
        && (after.first().is_some_and(|b| is_word_byte(*b) && !b.is_ascii_digit())
            || word == b"use" && after.first() == Some(&b'"')
            || word == b"gravity" && after.first().is_some_and(|b| b.is_ascii_digit() || *b == b'('));
    starts.then_some(start..start + word.len())
}

/// Stays within the line: it runs for every line of a file, so it must not read on through the file.
fn skip_blanks(text: &[u8]) -> &[u8] {
    let blanks = text.iter().take_while(|b| matches!(b, b' ' | b'\t')).count();
    &text[blanks..]
}

/// Whether the text before a `{` is the head of a `repeat` or `component`, or was meant as the head of a `repeat`:
/// another word with a range after it.
pub(super) fn opens_repeat(head: &str) -> bool {
    let word = first_word(head.as_bytes());
    std::str::from_utf8(word).is_ok_and(has_body)
        || !std::str::from_utf8(word).is_ok_and(is_keyword) && head.contains("..")
}

/// Whether a body of declarations follows the head that starts with this keyword.
pub fn has_body(keyword: &str) -> bool {
    matches!(keyword, "repeat" | "component")
}

/// Whether a byte may be part of a word: letters, digits, `_` and the Greek letters, whose bytes are above ASCII.
pub(super) fn is_word_byte(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_' || byte >= 0x80
}

/// Whether a character is a letter of names: rule `letter` of the grammar.
pub fn is_letter(c: char) -> bool {
    c.is_ascii_alphabetic()
        || matches!(c, '_' | '\u{391}'..='\u{3c9}' | '\u{3d0}'..='\u{3d6}' | '\u{3f0}'..='\u{3f5}' | '\u{b5}')
}
