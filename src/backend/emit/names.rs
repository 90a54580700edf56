//! Converts names of a model to identifiers that C, C++ and Rust all accept: ASCII letters, digits and `_`, no reserved
//! word of these languages, and no duplicates. In: names as displayed (`m[3].x`, `α`). Out: identifiers in the same
//! order (`m_3_x`, `u03b1`).

use super::reserved::{HEADERS, KEYWORDS, MACROS, MODULES};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;

/// The words that no identifier may be.
static RESERVED: LazyLock<BTreeSet<&str>> = LazyLock::new(|| KEYWORDS.split(' ').chain(MACROS.split(' ')).collect());

/// Identifiers for names, all different.
pub fn identifiers<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    let mut taken: BTreeSet<String> = BTreeSet::new();
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    let unique = |name: &str| {
        let plain = identifier(name);
        let count = counts.entry(plain.clone()).or_insert(0);
        loop {
            *count += 1;
            let candidate = if *count == 1 { plain.clone() } else { format!("{plain}_{count}") };
            if taken.insert(candidate.clone()) {
                return candidate;
            }
        }
    };
    names.into_iter().map(unique).collect()
}

/// The model's name as the prefix of everything in C, a module of Rust, and the name of the files, which must not hide
/// a standard header.
pub fn model_identifier(name: &str) -> String {
    let text = identifier(name);
    if is_among(HEADERS, &text.to_lowercase()) || is_among(MODULES, &text) { text + "_" } else { text }
}

fn is_among(words: &str, text: &str) -> bool {
    words.split(' ').any(|word| word == text)
}

/// One name as an identifier.
pub fn identifier(name: &str) -> String {
    let mut text = String::new();
    let mut gap = false;
    for character in name.chars() {
        if character.is_ascii_alphanumeric() || character == '_' {
            if gap && !text.is_empty() {
                text.push('_');
            }
            gap = false;
            text.push(character);
        } else if character.is_alphanumeric() {
            text += &format!("u{:04x}", u32::from(character));
        } else {
            gap = true;
        }
    }
    // Identifiers with a leading underscore are reserved for compilers.
    let text = text.trim_start_matches('_');
    let text = if text.is_empty() || text.starts_with(|c: char| c.is_ascii_digit()) {
        format!("n{text}")
    } else {
        text.into()
    };
    if RESERVED.contains(text.as_str()) { text + "_" } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_identifiers() {
        let found = identifiers(["m[3].x", "m_3_x", "α", "2nd", "double", "block.x", "_a"]);
        assert_eq!(found, ["m_3_x", "m_3_x_2", "u03b1", "n2nd", "double_", "block_x", "a"]);
        assert_eq!(identifiers(["NULL", "NULL_", "EOF", "I", "F"]), ["NULL_", "NULL__2", "EOF_", "I_", "F"]);
        assert_eq!(["stdio", "String", "Math", "cart"].map(model_identifier), ["stdio_", "String_", "Math_", "cart"]);
    }
}
