//! The room that a text takes, without asking any font: that of DejaVu Sans and of Verdana, which is as wide. Figures
//! name these two, so that nearly every machine has one of them.

/// Size of labels, px.
pub const SIZE: f64 = 12.0;
/// Height of a line that holds ascenders and descenders, px.
pub const HEIGHT: f64 = 15.0;
/// Other faces get so much more room; `textLength` keeps most viewers within it anyway.
pub const SPARE: f64 = 1.08;

/// Thousandths of the size that each character from the blank to the tilde takes.
const ADVANCES: [u16; 95] = [
    318, 401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361, 318, 337, 636, 636, 636, 636, 636, 636, 636,
    636, 636, 636, 337, 337, 838, 838, 838, 531, 1000, 684, 686, 698, 770, 632, 575, 775, 752, 295, 295, 656, 557, 863,
    748, 787, 603, 787, 695, 635, 611, 732, 684, 989, 685, 611, 685, 390, 337, 390, 838, 500, 500, 613, 635, 550, 635,
    615, 352, 635, 634, 278, 278, 579, 278, 974, 634, 612, 635, 635, 411, 521, 392, 634, 592, 818, 592, 592, 525, 636,
    337, 636, 838,
];

/// The width at which a label is set, px.
pub fn width(text: &str) -> f64 {
    text.chars().map(advance).sum::<f64>() * SIZE
}

/// The advance width of a character, in units of the font size.
fn advance(c: char) -> f64 {
    let known = (c as usize).checked_sub(' ' as usize).and_then(|place| ADVANCES.get(place));
    match (known, c) {
        (Some(thousandths), _) => f64::from(*thousandths) / 1000.0,
        // Greek, Cyrillic and the like; ideographs.
        (None, ..'\u{2e80}') => 0.68,
        (None, _) => 1.02,
    }
}

/// Maximum number of characters of a name that are shown; the title has all of them.
const LONGEST: usize = 40;

/// A text that fits beside a glyph.
pub fn clip(text: &str) -> String {
    if text.chars().count() <= LONGEST {
        return text.into();
    }
    let kept: String = text.chars().take(LONGEST - 1).collect();
    kept + "…"
}

/// Three digits of a number that only gives the scale of a drawing.
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
