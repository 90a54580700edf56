//! The long text of a diagnostic: its clause in spec.md, for a terminal. Clause: spec.md, "Diagnostics".

use strsim::damerau_levenshtein;

const SPECIFICATION: &str = include_str!("../../spec.md");

/// The clause of a code, or the known code that is nearest to what was asked. `unit::mismatch` is short for
/// `vib::unit::mismatch`.
pub fn explain(asked: &str) -> Result<String, Unknown> {
    let code = if asked.starts_with("vib::") { asked.to_string() } else { format!("vib::{asked}") };
    match clauses().find(|(name, _)| *name == code) {
        Some((name, body)) => Ok(format!("{name}\n\n{}", terminal(body))),
        None => Err(Unknown { nearest: nearest(&code) }),
    }
}

/// A numbered clause of the specification, such as 5.7.
pub fn numbered(number: &str) -> Option<&'static str> {
    let start = SPECIFICATION.find(&format!("\n{number} "))? + 1;
    let text = &SPECIFICATION[start..];
    let next = |line: &str| line.starts_with("## ") || clause_number(line).is_some_and(|found| found != number);
    let mut end = 0;
    for line in text.split_inclusive('\n').take_while(|line| !next(line)) {
        end += line.len();
    }
    Some(text[..end].trim())
}

/// The number that a clause begins with: `5.7`, `13a.2`.
fn clause_number(line: &str) -> Option<&str> {
    let (number, _) = line.split_once(' ')?;
    let (section, clause) = number.split_once('.')?;
    let counts = |text: &str| text.bytes().all(|b| b.is_ascii_digit()) && !text.is_empty();
    (section.starts_with(|c: char| c.is_ascii_digit()) && counts(clause)).then_some(number)
}

/// How a declaration with this keyword is written, and what it declares: its row in the table of clause 1.3.
pub fn keyword(word: &str) -> Option<(&'static str, &'static str)> {
    let table = numbered("1.3")?;
    let row = table.lines().find(|line| line.starts_with('|') && line.contains(&format!("`{word} ")))?;
    let (form, meaning) = row.strip_prefix("| ")?.strip_suffix(" |")?.rsplit_once(" | ")?;
    Some((form, meaning))
}

/// A code that no clause explains.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unknown {
    pub nearest: Option<&'static str>,
}

/// Code and text of each clause, in the order of the specification.
pub fn clauses() -> impl Iterator<Item = (&'static str, &'static str)> {
    SPECIFICATION.split("\n### ").filter(|section| section.starts_with("vib::")).map(|section| {
        let (name, rest) = section.split_once('\n').unwrap_or((section, ""));
        let body = rest.split("\n## ").next().unwrap_or(rest);
        (name.trim(), body.trim_matches('\n'))
    })
}

fn nearest(code: &str) -> Option<&'static str> {
    let distance = |name: &str| damerau_levenshtein(name, code);
    let (name, _) = clauses().min_by_key(|(name, _)| distance(name))?;
    (distance(name) * 3 <= code.chars().count()).then_some(name)
}

/// Columns of a paragraph.
const WIDTH: usize = 96;

/// Fenced blocks indented as they are written, paragraphs and items of lists filled to the width of a terminal.
fn terminal(markdown: &str) -> String {
    let mut text = String::new();
    let mut paragraph = String::new();
    let mut fenced = false;
    for line in markdown.lines() {
        let fence = line.starts_with("```");
        if fence || fenced || line.is_empty() || line.starts_with("- ") {
            text += &filled(&std::mem::take(&mut paragraph));
        }
        match (fence, fenced) {
            (true, _) => fenced = !fenced,
            (false, true) => text += &format!("    {line}\n"),
            (false, false) if line.is_empty() => text.push('\n'),
            (false, false) => paragraph += &format!("{line} "),
        }
    }
    text + &filled(&paragraph)
}

/// Words in lines of at most [`WIDTH`] characters, the further lines of a list's item indented.
fn filled(paragraph: &str) -> String {
    let indent = if paragraph.starts_with("- ") { "  " } else { "" };
    let mut text = String::new();
    let mut column = 0;
    for word in paragraph.split_whitespace() {
        let width = word.chars().count();
        if column > 0 && column + 1 + width > WIDTH {
            text += &format!("\n{indent}");
            column = indent.len();
        } else if column > 0 {
            text.push(' ');
            column += 1;
        }
        text += word;
        column += width;
    }
    if !text.is_empty() {
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paragraphs_are_filled_and_models_are_not() {
        let clause = format!(
            "{}\n{}\n\n```vib\nbody b {{ moves x }}\n```\n\n- {}",
            "one ".repeat(20),
            "two ".repeat(10),
            "three ".repeat(20)
        );
        let text = terminal(&clause);
        assert!(text.lines().all(|line| line.chars().count() <= WIDTH));
        assert!(text.contains("one two") && text.contains("\n\n    body b { moves x }\n\n- three"), "{text}");
        assert!(text.ends_with("\n  three three three three three\n"), "{text}");
    }

    #[test]
    fn an_unknown_code_gets_the_nearest() {
        assert_eq!(explain("unit::mismach"), Err(Unknown { nearest: Some("vib::unit::mismatch") }));
        assert_eq!(explain("something else"), Err(Unknown { nearest: None }));
        assert!(explain("vib::unit::mismatch").is_ok_and(|text| text.starts_with("vib::unit::mismatch\n\nA value")));
    }
}
