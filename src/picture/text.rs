//! How much room a text takes, without asking any font: what a common sans-serif face takes, and some more.

/// Size of labels, px.
pub const SIZE: f64 = 13.0;
/// Height of a line that holds ascenders and descenders, px.
pub const HEIGHT: f64 = 16.0;
/// Wider faces than the one measured here get so much more room; `textLength` keeps most viewers within it anyway.
pub const SPARE: f64 = 1.16;

/// The width at which a label is set, px.
pub fn width(text: &str) -> f64 {
    text.chars().map(advance).sum::<f64>() * SIZE
}

/// Of a character, in units of the size (after Helvetica's).
fn advance(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | '\'' | '|' => 0.24,
        '.' | ',' | ':' | ';' | '!' | ' ' | 'I' | '[' | ']' | '/' | 't' | 'f' | '·' => 0.29,
        '(' | ')' | 'r' | '-' | '*' | '^' => 0.36,
        'm' | 'M' | 'W' | 'w' | '%' | '@' => 0.86,
        'A'..='Z' | '&' => 0.70,
        ' '..='~' => 0.56,
        '\u{80}'..='\u{2e7f}' => 0.66,
        _ => 1.05,
    }
}

/// At most this many characters of a name are shown; the title has all of them.
const LONGEST: usize = 40;

/// A text that fits beside a glyph.
pub fn clipped(text: &str) -> String {
    if text.chars().count() <= LONGEST {
        return text.into();
    }
    let kept: String = text.chars().take(LONGEST - 1).collect();
    kept + "…"
}

/// Three digits of a number that only says how large something was drawn.
pub fn few_digits(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return "0".into();
    }
    let text = format!("{x:.2e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    match exponent.parse::<i32>().unwrap_or(0) {
        power @ -3..=5 => {
            let decimals = (2 - power).max(0) as usize;
            let text = format!("{x:.decimals$}");
            if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
        }
        power => format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.')),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_digits_read_well() {
        let cases = [(0.25, "0.25"), (12.3456, "12.3"), (1234.0, "1234"), (3.0e-7, "3e-7"), (1.0, "1"), (0.0, "0")];
        for (x, text) in cases {
            assert_eq!(few_digits(x), text);
        }
    }
}
