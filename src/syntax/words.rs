//! The words that start declarations, and what a declaration of each looks like. See spec.md#keywords.

use std::ops::Range;

/// What a declaration may start with, in the order of spec.md.
pub const KEYWORDS: [&str; 22] = [
    "model", "param", "let", "gravity", "point", "body", "pivot", "slide", "weld", "couple", "spring", "damper",
    "base", "force", "torque", "initial", "output", "damping", "rest", "repeat", "solve", "require",
];

/// What other languages and textbooks call them.
const SYNONYMS: [(&str, &str); 26] = [
    ("parameter", "param"),
    ("var", "param"),
    ("variable", "param"),
    ("const", "let"),
    ("def", "let"),
    ("define", "let"),
    ("node", "point"),
    ("mass", "body"),
    ("link", "body"),
    ("rigid", "body"),
    ("hinge", "pivot"),
    ("pin", "pivot"),
    ("joint", "pivot"),
    ("revolute", "pivot"),
    ("slider", "slide"),
    ("prismatic", "slide"),
    ("fixed", "weld"),
    ("gear", "couple"),
    ("rack", "couple"),
    ("dashpot", "damper"),
    ("support", "base"),
    ("moment", "torque"),
    ("sensor", "output"),
    ("for", "repeat"),
    ("assert", "require"),
    ("check", "require"),
];

pub fn is_keyword(word: &str) -> bool {
    KEYWORDS.contains(&word)
}

/// A declaration of this keyword as it is written.
pub fn form(keyword: &str) -> &'static str {
    match keyword {
        "model" => "model cart",
        "param" => "param k = 10 N/m",
        "let" => "let w = sqrt(k / m)",
        "gravity" => "gravity 9.81 m/s^2",
        "point" => "point A = (0, 1 m)",
        "body" => "body block { mass = 1 kg, moves x }",
        "pivot" => "pivot p: block@A -- rod",
        "slide" => "slide g: arm -- slug along (1, 0)",
        "weld" => "weld w: block -- box",
        "couple" => "couple r: wheel.angle = -block.x / 0.3 m",
        "spring" => "spring s: ground -- block { k = 10 N/m }",
        "damper" => "damper d: ground -- block { c = 5 N*s/m }",
        "base" => "base floor { moves y }",
        "force" => "force F: block along x = harmonic(10 N, 1.5 Hz)",
        "torque" => "torque T: rod",
        "initial" => "initial block { x = 16 mm, vx = 0.375 m/s }",
        "output" => "output theta = rod.angle",
        "damping" => "damping modal 2 %` or `damping rayleigh(0.1 /s, 1e-4 s)",
        "rest" => "rest as drawn",
        "repeat" => "repeat i in 2..100 {",
        "solve" => "solve f in 5 Hz .. 29 Hz: gain(floor -> table.y, 30 Hz) = -12 dB",
        _ => "require frequency(1) > 2 Hz",
    }
}

/// The keyword that a word may have been meant as: a synonym, or the nearest one by the number of letters to change.
pub(super) fn nearest(word: &str) -> Option<&'static str> {
    let word = word.to_lowercase();
    if let Some((_, keyword)) = SYNONYMS.iter().find(|(synonym, _)| *synonym == word) {
        return Some(keyword);
    }
    let distance = |keyword: &&&str| strsim::damerau_levenshtein(keyword, &word);
    let nearest = KEYWORDS.iter().min_by_key(distance)?;
    // A third of the letters, as rustc does.
    (distance(&nearest) * 3 <= word.chars().count().max(nearest.len())).then_some(*nearest)
}

/// The word of small letters at the start of a text; may be empty.
pub(super) fn first_word(text: &[u8]) -> &[u8] {
    let end = text.iter().position(|b| !b.is_ascii_lowercase()).unwrap_or(text.len());
    &text[..end]
}

/// The keyword of a line that nothing but a declaration begins with: a keyword and, after blanks, a word (or a value, for
/// `gravity`).
pub fn starts_declaration(line: &[u8]) -> Option<Range<usize>> {
    let start = line.len() - skip_blanks(line).len();
    let word = first_word(&line[start..]);
    let rest = &line[start + word.len()..];
    let after = skip_blanks(rest);
    let starts = std::str::from_utf8(word).is_ok_and(is_keyword)
        && rest.first().is_some_and(|b| matches!(b, b' ' | b'\t'))
        && (after.first().is_some_and(|b| continues(*b) && !b.is_ascii_digit())
            || word == b"gravity" && after.first().is_some_and(|b| b.is_ascii_digit() || *b == b'('));
    starts.then_some(start..start + word.len())
}

/// Not past the line: what is read for every line of a file must not read on in it.
fn skip_blanks(text: &[u8]) -> &[u8] {
    let blanks = text.iter().take_while(|b| matches!(b, b' ' | b'\t')).count();
    &text[blanks..]
}

/// The text before a `{` is the head of a `repeat`, or of what was meant as one: another word with a range after it.
pub(super) fn opens_repeat(head: &str) -> bool {
    let word = first_word(head.as_bytes());
    word == b"repeat" || !std::str::from_utf8(word).is_ok_and(is_keyword) && head.contains("..")
}

/// A byte inside a word: letters, digits, `_` and the Greek letters, whose bytes are above ASCII.
pub(super) fn continues(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_' || byte >= 0x80
}

/// A letter of names: rule `letter` of the grammar.
pub fn is_letter(c: char) -> bool {
    c.is_ascii_alphabetic()
        || matches!(c, '_' | '\u{391}'..='\u{3c9}' | '\u{3d0}'..='\u{3d6}' | '\u{3f0}'..='\u{3f5}' | '\u{b5}')
}
