//! Text of a user's file as it may be shown: what would move a terminal's cursor, change its colours or turn the reading
//! direction is made visible instead.

use std::borrow::Cow;

/// Control characters as their pictures (`␛`), characters that are invisible or turn the reading direction as `\u{fffd}`.
/// Line feeds become spaces too: what is shown is one line.
pub fn readable(text: &str) -> Cow<'_, str> {
    if text.chars().all(|c| visible(c) == c) {
        Cow::Borrowed(text)
    } else {
        text.chars().map(visible).collect::<String>().into()
    }
}

/// The character itself, or what stands for it.
pub fn visible(c: char) -> char {
    match c {
        '\n' => ' ',
        '\u{0}'..='\u{1f}' => char::from_u32(0x2400 + c as u32).unwrap_or('\u{fffd}'),
        '\u{7f}' => '\u{2421}',
        // C1 controls; soft hyphen; Arabic letter mark; zero width, joiners, marks, embeddings and isolates; BOM; tags.
        '\u{80}'..='\u{9f}' | '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' => {
            '\u{fffd}'
        }
        '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e0fff}' => '\u{fffd}',
        _ => c,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_steers_a_terminal_is_left() {
        assert_eq!(readable("a\u{1b}[31mb\rc\u{7}"), "a␛[31mb␍c␇");
        assert_eq!(readable("x\u{202e}y\u{2066}z\u{200b}\u{9b}1m"), "x\u{fffd}y\u{fffd}z\u{fffd}\u{fffd}1m");
    }

    #[test]
    fn plain_text_is_not_copied() {
        assert!(matches!(readable("ω₁ = 3 N/m"), Cow::Borrowed(_)));
    }
}
