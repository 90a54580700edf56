//! Makes the text of a user's file safe to show: characters that would move a terminal's cursor or change its colours
//! or the reading direction are made visible instead.

use std::borrow::Cow;

/// Control characters as their pictures (`␛`), characters that are invisible or turn the reading direction as `\u{fffd}`.
/// Line feeds become spaces too: the result is one line.
pub fn readable(text: &str) -> Cow<'_, str> {
    if text.chars().all(|c| visible(c) == c) {
        Cow::Borrowed(text)
    } else {
        text.chars().map(visible).collect::<String>().into()
    }
}

/// The character itself, or its visible replacement.
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

/// Whether some character of a text is hidden. Most texts are plain ASCII, which bytes tell faster than characters.
fn contains(text: &str, hidden: impl Fn(char) -> bool) -> bool {
    let mut rest = text;
    while let Some(at) = rest.bytes().position(|byte| !(b' '..0x7f).contains(&byte)) {
        let mut from_there = rest[at..].chars();
        if from_there.next().is_some_and(&hidden) {
            return true;
        }
        rest = from_there.as_str();
    }
    false
}

/// JSON with each character that [`readable`] replaces written as its escaped, so that it reads back as the same text.
/// Line feeds between values stay.
pub fn escape(json: String) -> String {
    let hidden = |c: char| c != '\n' && visible(c) != c;
    if !contains(&json, hidden) {
        return json;
    }
    let mut escaped = String::with_capacity(json.len() + 64);
    for c in json.chars() {
        if hidden(c) {
            escaped.extend(c.encode_utf16(&mut [0; 2]).iter().map(|unit| format!("\\u{unit:04x}")));
        } else {
            escaped.push(c);
        }
    }
    escaped
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
    fn escaped_json_is_the_same_value() {
        let text = "a\u{202e}b\u{9b}1m\u{e0041}\u{7f}ω\u{200b}";
        let json = escape(format!("[\"{text}\",\n1]"));
        assert_eq!(json, "[\"a\\u202eb\\u009b1m\\udb40\\udc41\\u007fω\\u200b\",\n1]");
        let value: serde_json::Value = serde_json::from_str(&json).expect("JSON");
        assert_eq!(value[0], text);
        // A visible letter that is not ASCII hides nothing behind it.
        assert_eq!(escape("[\"ωζ\u{202e}\"]".into()), "[\"ωζ\\u202e\"]");
        assert_eq!(escape("[\"ωζ\"]".into()), "[\"ωζ\"]");
    }

    #[test]
    fn plain_text_is_not_copied() {
        assert!(matches!(readable("ω₁ = 3 N/m"), Cow::Borrowed(_)));
    }
}
