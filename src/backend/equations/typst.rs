//! Equations as a Typst document.

use super::document::{Document, Inline};
use super::formula::{Formula, Running, greek_letter};
use super::write::{self, Language, Piece, Tight};
use crate::equations::names::Label;

pub fn typst(document: &Document) -> String {
    write::document(&Typst, document)
}

struct Typst;

impl Language for Typst {
    fn decimal(&self, text: &str) -> Piece {
        match text.split_once('e') {
            Some((number, power)) => (format!("{number} dot 10^({power})"), Tight::Product),
            None => (text.to_string(), Tight::Power),
        }
    }

    fn quotient(&self, over: Piece, under: Piece) -> Piece {
        (format!("frac({}, {})", over.0, under.0), Tight::Quotient)
    }

    fn imaginary(&self) -> &'static str {
        "upright(i)"
    }

    fn pi(&self) -> &'static str {
        "pi"
    }

    /// `dot.double(theta)_("rod")`
    fn name(&self, label: &Label) -> String {
        let (word, index) = write::letter_and_index(label);
        let letter = letters(&word);
        let letter = match label.dots {
            0 => letter,
            1 => format!("dot({letter})"),
            _ => format!("dot.double({letter})"),
        };
        if index.is_empty() {
            return letter;
        }
        let part = |part: &str| if write::is_plain_index(part) { part.to_string() } else { letters(part) };
        let parts: Vec<String> = index.split(',').map(part).collect();
        format!("{letter}_({})", parts.join(" \",\" "))
    }

    fn call(&self, function: &str, arguments: &[String], _: bool) -> Piece {
        let function = match function {
            "asin" => "arcsin",
            "acos" => "arccos",
            "atan" => "arctan",
            "atan2" => "op(\"atan2\")",
            "abs" => "op(\"abs\")",
            "pow" => "op(\"pow\")",
            other => other,
        };
        (format!("{function}({})", arguments.join(", ")), Tight::Power)
    }

    fn with_index(&self, letter: &str, index: Option<Piece>) -> String {
        index.map_or_else(|| letter.to_string(), |(index, _)| format!("{letter}_({index})"))
    }

    fn series(&self, Running { index, first, last }: &Running, term: &str) -> String {
        format!("sum_({index} = {first})^{last} {term}")
    }

    fn matrix(&self, rows: &[Vec<String>]) -> String {
        let rows: Vec<String> = rows.iter().map(|row| row.join(", ")).collect();
        format!("mat(delim: \"[\", {})", rows.join("; "))
    }

    /// Escapes text so that it contains no commands.
    fn prose(&self, text: &str) -> String {
        let mut escaped = String::new();
        for c in text.chars() {
            if c.is_control() {
                escaped.push(' ');
            } else if c.is_ascii_punctuation() && ![',', '.', ';', '(', ')'].contains(&c) {
                escaped.push('\\');
                escaped.push(c);
            } else {
                escaped.push(c);
            }
        }
        escaped
    }

    fn in_sentence(&self, formula: &str) -> String {
        format!("${formula}$")
    }

    fn title(&self, text: &str) -> String {
        format!("= {}\n", self.prose(text))
    }

    fn heading(&self, text: &str) -> String {
        format!("\n== {}\n\n", self.prose(text))
    }

    fn paragraph(&self, inner: &str) -> String {
        format!("{inner}\n\n")
    }

    fn display(&self, formula: &Formula, note: &[Inline]) -> String {
        let in_math = |inline: &Inline| match inline {
            Inline::Text(text) => quote(text),
            Inline::Formula(of) => format!(" {} ", write::formula(self, of)),
        };
        let note: String = note.iter().map(in_math).collect();
        let gap = if note.is_empty() { "" } else { " quad " };
        format!("$ {}{gap}{note} $\n\n", write::formula(self, formula))
    }

    fn display_matrix(&self, name: &Formula, rows: &[Vec<Formula>]) -> String {
        format!("$ {} = {} $\n\n", write::formula(self, name), self.matrix(&write::cells(self, rows)))
    }
}

fn quote(text: &str) -> String {
    let inner: String = text
        .chars()
        .map(|c| match c {
            '"' | '\\' => format!("\\{c}"),
            c if c.is_control() => " ".to_string(),
            c => c.to_string(),
        })
        .collect();
    format!("\"{inner}\"")
}

fn letters(word: &str) -> String {
    match greek_letter(word) {
        Some(letter) => letter.to_string(),
        None if word.chars().count() == 1 && word.chars().all(|c| c.is_ascii_alphanumeric()) => word.to_string(),
        None => quote(word),
    }
}
