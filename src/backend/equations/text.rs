//! Equations as plain text: `m2 L^2/3 theta'' + m2 g L/2 theta = 0`.

use super::document::{Document, Inline};
use super::formula::{Formula, Running};
use super::write::{self, Language, Piece, Tight};
use crate::base::readable::readable;
use crate::equations::names::Label;

/// Width to which paragraphs are filled.
const WIDTH: usize = 100;

pub fn text(document: &Document) -> String {
    write::document(&Text, document)
}

/// A formula on one line.
pub fn formula(of: &Formula) -> String {
    write::formula(&Text, of)
}

/// A sentence on one line.
pub fn sentence(inlines: &[Inline]) -> String {
    write::sentence(&Text, inlines)
}

struct Text;

impl Language for Text {
    fn decimal(&self, text: &str) -> Piece {
        (text.to_string(), Tight::Power)
    }

    fn quotient(&self, over: Piece, under: Piece) -> Piece {
        let over = match over {
            (text, Tight::Sum | Tight::Quotient) => format!("({text})"),
            (text, _) => text,
        };
        let under = match under {
            (text, Tight::Power) => text,
            (text, _) => format!("({text})"),
        };
        (format!("{over}/{under}"), Tight::Quotient)
    }

    fn imaginary(&self) -> &'static str {
        "i"
    }

    fn pi(&self) -> &'static str {
        "pi"
    }

    /// `x_block''`, `m[3]`: primes belong to the letter, but are written at the end.
    fn name(&self, label: &Label) -> String {
        format!("{}{}", readable(&label.plain()), "'".repeat(usize::from(label.dots)))
    }

    fn call(&self, function: &str, arguments: &[String], _: bool) -> Piece {
        (format!("{function}({})", arguments.join(", ")), Tight::Power)
    }

    fn indexed(&self, letter: &str, index: Option<Piece>) -> String {
        match index {
            None => letter.to_string(),
            Some((index, Tight::Power)) => format!("{letter}_{index}"),
            Some((index, _)) => format!("{letter}_({index})"),
        }
    }

    /// `sum(m x_i'^2, i = 1..4)`
    fn series(&self, Running { index, first, last }: &Running, term: &str) -> String {
        format!("sum({term}, {index} = {first}..{last})")
    }

    fn matrix(&self, rows: &[Vec<String>]) -> String {
        let rows: Vec<String> = rows.iter().map(|row| row.join(", ")).collect();
        format!("[{}]", rows.join("; "))
    }

    fn prose(&self, text: &str) -> String {
        readable(text).into_owned()
    }

    fn in_sentence(&self, formula: &str) -> String {
        formula.to_string()
    }

    fn title(&self, text: &str) -> String {
        format!("{}\n", readable(text))
    }

    fn heading(&self, text: &str) -> String {
        format!("\n{text}\n")
    }

    fn paragraph(&self, inner: &str) -> String {
        filled(inner, 2)
    }

    fn display(&self, formula: &Formula, note: &[Inline]) -> String {
        let line = self::formula(formula);
        match note.is_empty() {
            true => broken(&line),
            false => format!("{}    {}\n", broken(&line).trim_end_matches('\n'), sentence(note)),
        }
    }

    /// Rows in brackets, columns aligned.
    fn display_matrix(&self, name: &Formula, rows: &[Vec<Formula>]) -> String {
        let (name, cells) = (self::formula(name), write::cells(self, rows));
        let columns = cells.first().map_or(0, Vec::len);
        let width = |column: usize| cells.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let mut text = String::new();
        for (index, row) in cells.iter().enumerate() {
            let shown: Vec<String> = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
            let front = if index == 0 { format!("{name} = ") } else { " ".repeat(name.chars().count() + 3) };
            text += &format!("    {front}[ {} ]\n", shown.join("   "));
        }
        text
    }
}

/// Words in lines of at most [`WIDTH`] columns.
fn filled(paragraph: &str, indent: usize) -> String {
    let mut text = String::new();
    let mut column = 0;
    for word in paragraph.split_whitespace() {
        let width = word.chars().count();
        if column > 0 && column + 1 + width > WIDTH {
            text.push('\n');
            column = 0;
        }
        if column == 0 {
            text += &" ".repeat(indent);
            column = indent;
        } else {
            text.push(' ');
            column += 1;
        }
        text += word;
        column += width;
    }
    text + "\n"
}

/// Breaks a long equation before a sign between its terms.
fn broken(line: &str) -> String {
    let mut text = String::from("    ");
    let (mut column, mut depth) = (4, 0i32);
    let words: Vec<&str> = line.split(' ').collect();
    for (index, word) in words.iter().enumerate() {
        let is_sign = depth == 0 && ["+", "-", "="].contains(word);
        // The width of the next term.
        let mut ahead = 0;
        let mut inside = depth;
        for (step, next) in words[index..].iter().enumerate() {
            if step > 0 && inside == 0 && ["+", "-", "="].contains(next) {
                break;
            }
            ahead += next.chars().count() + 1;
            inside += nesting(next);
        }
        if index > 0 {
            if is_sign && index > 1 && column + ahead > WIDTH {
                text += "\n        ";
                column = 8;
            } else {
                text.push(' ');
                column += 1;
            }
        }
        text += word;
        column += word.chars().count();
        depth += nesting(word);
    }
    text + "\n"
}

fn nesting(word: &str) -> i32 {
    word.chars()
        .map(|c| match c {
            '(' | '[' => 1,
            ')' | ']' => -1,
            _ => 0,
        })
        .sum()
}
