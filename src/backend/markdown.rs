//! Reports as Markdown: headings, sentences, lists and tables in GitHub's dialect, matrices as blocks of text. Names of
//! the model are escaped, so that they appear literally. See docs/method/report.md.

use super::plain::{self, NO_BREAK};
use super::report::block_of_matrices;
use crate::answers::report::{Align, Block, Cell, Column, Line, Part, Report, Section, Table};
use crate::base::readable::readable;

/// A report, ending in a line feed.
pub fn markdown(report: &Report) -> String {
    let mut text = format!("# {}\n", line(&report.title));
    report.sections.iter().for_each(|part| text += &section(part));
    text.replace(NO_BREAK, " ")
}

/// Reports one below the other.
pub fn all(reports: &[Report]) -> String {
    reports.iter().map(markdown).collect::<Vec<_>>().join("\n")
}

fn section(section: &Section) -> String {
    let mut text = format!("\n## {}\n", section.heading);
    let mut in_list = false;
    for (number, block) in section.blocks.iter().enumerate() {
        let item = matches!(block, Block::Item(_));
        let repeats = |line: &Line| number == 0 && plain::line(line).eq_ignore_ascii_case(section.heading);
        let repeated = matches!(block, Block::Line(line) if repeats(line));
        let follows_item = item && in_list;
        if !repeated && !follows_item {
            text.push('\n');
        }
        in_list = item;
        match block {
            Block::Line(line) if repeats(line) => {}
            Block::Line(words) => text += &format!("{}\n", at_start(line(words))),
            Block::Item(words) => text += &format!("- {}\n", at_start(line(words))),
            Block::Table(list) => text += &table(list),
            Block::Matrices(list) => text += &format!("```text\n{}```\n", block_of_matrices(list)),
        }
    }
    text
}

fn table(table: &Table) -> String {
    let align = |column: &Column| match column.align {
        Align::Left => ":---",
        Align::Right | Align::Point => "---:",
    };
    let title = |column: &Column| match column.unit {
        "" => line(&column.title),
        unit => format!("{} {unit}", line(&column.title)),
    };
    let row = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
    let mut text = row(table.columns.iter().map(title).collect());
    text += &row(table.columns.iter().map(|column| align(column).to_string()).collect());
    let cell = |cell: &Cell| line(&cell.longest());
    table.rows.iter().for_each(|cells| text += &row(cells.iter().map(cell).collect()));
    text
}

fn line(line: &Line) -> String {
    let part = |part: &Part| match part {
        Part::Words(words) => escape(words, "\\`*_<|~"),
        Part::Named(named) => name(&named.text),
        Part::Figure(figure) => escape(&plain::figure(figure), "\\`*_<>|~[]&"),
    };
    line.parts.iter().map(part).collect()
}

/// Text of the model, with every character escaped that could begin markup.
fn name(text: &str) -> String {
    let text = escape(&readable(text), "\\`*_<>|~[]&#$!^@:/{}");
    // Addresses become links without any bracket.
    if text.to_ascii_lowercase().contains("www.") { text.replace('.', "\\.") } else { text }
}

fn escape(text: &str, special: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        if special.contains(c) {
            escaped.push('\\');
        }
        escaped.push(c);
    }
    escaped
}

/// Escapes the start of a paragraph that would otherwise be an item of a list or the underline of a heading.
fn at_start(text: String) -> String {
    let digits = text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    match text[digits..].chars().next() {
        Some('.' | ')') if digits > 0 => format!("{}\\{}", &text[..digits], &text[digits..]),
        Some('-' | '+' | '=') if digits == 0 => format!("\\{text}"),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_harmless() {
        assert_eq!(name("<b>|[x](y)*_`"), "\\<b\\>\\|\\[x\\](y)\\*\\_\\`");
        assert_eq!(name("www.evil.example"), "www\\.evil\\.example");
        assert_eq!(name("a\nb\u{202e}"), "a b\u{fffd}");
        assert_eq!(at_start("1. a".into()), "1\\. a");
        assert_eq!(at_start("- a".into()), "\\- a");
        assert_eq!(at_start("12 modes".into()), "12 modes");
    }
}
