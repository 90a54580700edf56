//! `vibc explain`: the page of a diagnostic, laid out for a terminal, and the list of all codes. The pages are
//! the files of `docs/diagnostics`.

mod pages;

use super::report::wrap::fill_lines;
pub use pages::{PAGES, Page};
use strsim::damerau_levenshtein;

/// Width of a page that is not shown on a terminal.
pub const WIDTH: usize = 96;

/// The page of a code in `width` columns, or the most similar one of the codes and of `words`. `unit::mismatch` is short for
/// `vib::unit::mismatch`.
pub fn explain(asked: &str, words: impl Iterator<Item = &'static str>, width: usize) -> Result<String, Unknown> {
    let code = if asked.starts_with("vib::") { asked.to_string() } else { format!("vib::{asked}") };
    match PAGES.iter().find(|page| page.code == code) {
        Some(page) => Ok(terminal(page.markdown, width)),
        None => Err(Unknown { nearest: nearest(asked, &code, words) }),
    }
}

/// All codes, one per line, in alphabetical order.
pub fn codes() -> String {
    PAGES.iter().map(|page| format!("{}\n", page.code)).collect()
}

/// A word that is not a code, and the code or word of the language that may have been meant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unknown {
    pub nearest: Option<&'static str>,
}

fn nearest(asked: &str, code: &str, words: impl Iterator<Item = &'static str>) -> Option<&'static str> {
    let codes = PAGES.iter().map(|page| (page.code, damerau_levenshtein(page.code, code)));
    let words = words.map(|name| (name, damerau_levenshtein(name, asked)));
    let (name, distance) = codes.chain(words).min_by_key(|&(_, distance)| distance)?;
    (distance * 3 <= asked.chars().count()).then_some(name)
}

/// Markdown for a terminal: headings without their marks, fenced blocks indented, paragraphs and list items in lines of at
/// most `width` columns. Models keep their lines.
pub fn terminal(markdown: &str, width: usize) -> String {
    let mut text = String::new();
    let mut paragraph = String::new();
    let mut fenced = false;
    for line in markdown.lines() {
        let fence = line.starts_with("```");
        if fence || fenced || line.is_empty() || line.starts_with("- ") {
            text += &fill(&std::mem::take(&mut paragraph), width);
        }
        match (fence, fenced) {
            (true, _) => fenced = !fenced,
            (false, true) => text += &format!("    {line}\n"),
            (false, false) if line.is_empty() => text.push('\n'),
            (false, false) => paragraph += &format!("{} ", line.strip_prefix("# ").unwrap_or(line).trim_end()),
        }
    }
    text + &fill(&paragraph, width)
}

/// The lines of a paragraph; those after the first of a list item are indented.
fn fill(paragraph: &str, width: usize) -> String {
    let indent = if paragraph.starts_with("- ") { 2 } else { 0 };
    match paragraph.trim_end() {
        "" => String::new(),
        text => fill_lines(text, 0, indent, width),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paragraphs_are_filled_and_models_are_not() {
        let page = format!(
            "# Title\n\n{}\n{}\n\n```vib\nbody b {{ moves x }}\n```\n\n- {}",
            "one ".repeat(20),
            "two ".repeat(10),
            "three ".repeat(20)
        );
        let text = terminal(&page, WIDTH);
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH));
        assert!(
            text.starts_with("Title\n\none")
                && text.contains("one two")
                && text.contains("\n\n    body b { moves x }\n\n- three"),
            "{text}"
        );
        assert!(text.ends_with("\n  three three three three three\n"), "{text}");
    }

    /// Models keep their lines; everything else is filled.
    #[test]
    fn pages_fit_a_narrow_terminal() {
        for page in PAGES {
            for line in terminal(page.markdown, 60).lines().filter(|line| !line.starts_with("    ")) {
                let is_one_word = !line.trim().contains(' ');
                assert!(line.chars().count() <= 60 || is_one_word, "{}: {line}", page.code);
            }
        }
    }

    #[test]
    fn an_unknown_word_gets_the_nearest() {
        let explain = |asked| explain(asked, ["harmonic"].into_iter(), WIDTH);
        assert_eq!(explain("unit::mismach"), Err(Unknown { nearest: Some("vib::unit::mismatch") }));
        assert_eq!(explain("harmonik"), Err(Unknown { nearest: Some("harmonic") }));
        assert_eq!(explain("something else"), Err(Unknown { nearest: None }));
        assert!(explain("vib::unit::mismatch").is_ok_and(|text| text.starts_with("vib::unit::mismatch\n\nA value")));
    }
}
