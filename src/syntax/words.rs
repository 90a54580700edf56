//! The words that start declarations. Clause: spec.md 1.3.

/// What a declaration may start with, in the order of spec.md.
pub const KEYWORDS: [&str; 22] = [
    "model", "param", "let", "gravity", "point", "body", "pivot", "slide", "weld", "couple", "spring", "damper",
    "base", "force", "torque", "initial", "output", "damping", "rest", "repeat", "solve", "require",
];

pub fn is_keyword(word: &str) -> bool {
    KEYWORDS.contains(&word)
}

/// The word of small letters at the start of a text; may be empty.
pub(super) fn first_word(text: &[u8]) -> &[u8] {
    let end = text.iter().position(|b| !b.is_ascii_lowercase()).unwrap_or(text.len());
    &text[..end]
}

/// A line that nothing but a declaration begins: a keyword and, after blanks, a word (or a value, for `gravity`).
pub(super) fn starts_declaration(line: &[u8]) -> bool {
    let line = line.trim_ascii_start();
    let word = first_word(line);
    let rest = &line[word.len()..];
    let after = rest.trim_ascii_start();
    let starts_word = |b: &u8| b.is_ascii_alphabetic() || *b == b'_' || *b >= 0x80;
    std::str::from_utf8(word).is_ok_and(is_keyword)
        && rest.first().is_some_and(|b| matches!(b, b' ' | b'\t'))
        && (after.first().is_some_and(starts_word)
            || word == b"gravity" && after.first().is_some_and(|b| b.is_ascii_digit() || *b == b'('))
}

/// The text before a `{` is the head of a `repeat`, or of what was meant as one: another word with a range after it.
pub(super) fn opens_repeat(head: &str) -> bool {
    let word = first_word(head.as_bytes());
    word == b"repeat" || !std::str::from_utf8(word).is_ok_and(is_keyword) && head.contains("..")
}
