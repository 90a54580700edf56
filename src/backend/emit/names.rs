//! Names of a model as identifiers that C, C++ and Rust all take: ASCII letters, digits and `_`, no word of these languages,
//! none twice. In: names as displayed (`m[3].x`, `α`). Out: identifiers in the same order (`m_3_x`, `u03b1`).

/// Words that mean something in C99, C++ or Rust, or to their usual headers.
const RESERVED: [&str; 125] = [
    "abstract",
    "alignas",
    "alignof",
    "and",
    "and_eq",
    "as",
    "asm",
    "async",
    "auto",
    "await",
    "become",
    "bitand",
    "bitor",
    "bool",
    "box",
    "break",
    "case",
    "catch",
    "char",
    "class",
    "compl",
    "concept",
    "const",
    "const_cast",
    "constexpr",
    "continue",
    "crate",
    "decltype",
    "default",
    "delete",
    "do",
    "double",
    "dyn",
    "dynamic_cast",
    "else",
    "enum",
    "errno",
    "explicit",
    "export",
    "extern",
    "f32",
    "f64",
    "false",
    "final",
    "float",
    "fn",
    "for",
    "friend",
    "gen",
    "goto",
    "if",
    "impl",
    "in",
    "inline",
    "int",
    "let",
    "linux",
    "long",
    "loop",
    "macro",
    "main",
    "match",
    "mod",
    "move",
    "mut",
    "mutable",
    "namespace",
    "new",
    "noexcept",
    "not",
    "not_eq",
    "nullptr",
    "operator",
    "or",
    "or_eq",
    "override",
    "priv",
    "private",
    "protected",
    "pub",
    "ref",
    "register",
    "reinterpret_cast",
    "requires",
    "restrict",
    "return",
    "self",
    "short",
    "signed",
    "sizeof",
    "static",
    "static_assert",
    "static_cast",
    "struct",
    "super",
    "switch",
    "template",
    "this",
    "thread_local",
    "throw",
    "trait",
    "true",
    "try",
    "type",
    "typedef",
    "typeid",
    "typename",
    "typeof",
    "union",
    "unix",
    "unsafe",
    "unsized",
    "unsigned",
    "use",
    "using",
    "virtual",
    "void",
    "volatile",
    "wchar_t",
    "where",
    "while",
    "xor",
    "xor_eq",
    "yield",
    "Self",
];

/// Identifiers for names, each different from the others.
pub fn identifiers<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    let mut taken: Vec<String> = Vec::new();
    for name in names {
        let plain = identifier(name);
        let mut unique = plain.clone();
        let mut count = 1;
        while taken.contains(&unique) {
            count += 1;
            unique = format!("{plain}_{count}");
        }
        taken.push(unique);
    }
    taken
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
    // A leading underscore belongs to compilers.
    let text = text.trim_start_matches('_');
    let text = if text.is_empty() || text.starts_with(|c: char| c.is_ascii_digit()) {
        format!("n{text}")
    } else {
        text.into()
    };
    if RESERVED.contains(&text.as_str()) { text + "_" } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_identifiers() {
        let found = identifiers(["m[3].x", "m_3_x", "α", "2nd", "double", "block.x", "_a"]);
        assert_eq!(found, ["m_3_x", "m_3_x_2", "u03b1", "n2nd", "double_", "block_x", "a"]);
    }
}
