//! Equations as plain text: `m2 L^2/3 theta'' + m2 g L/2 theta = 0`.

use super::document::{Document, Inline, Item};
use super::formula::{Formula, Shown, shown};
use crate::base::readable::readable;
use crate::equations::names::Label;

/// Columns that paragraphs are filled to.
const WIDTH: usize = 100;

pub fn text(document: &Document) -> String {
    let mut text = format!("{}\n", readable(&document.title));
    for section in &document.sections {
        text += &format!("\n{}\n", section.heading);
        for item in &section.items {
            text += &item_text(item);
        }
    }
    text
}

fn item_text(item: &Item) -> String {
    match item {
        Item::Paragraph(inlines) => filled(&inlines.iter().map(inline).collect::<String>(), 2),
        Item::Formula { formula, note } => {
            let note = note.iter().map(inline).collect::<String>();
            let line = equation(formula);
            match (note.is_empty(), &line) {
                (true, line) => broken(line),
                (false, line) => format!("    {line}    {note}\n"),
            }
        }
        Item::Matrices(matrices) => matrices.iter().map(|(name, rows)| matrix(&formula(name), rows)).collect(),
    }
}

fn inline(inline: &Inline) -> String {
    match inline {
        Inline::Text(text) => readable(text).into_owned(),
        Inline::Formula(formula) => equation(formula),
    }
}

fn equation(of: &Formula) -> String {
    match of {
        Formula::Equal(left, right) => format!("{} = {}", formula(left), formula(right)),
        other => formula(other),
    }
}

/// Rows in brackets, columns aligned.
fn matrix(name: &str, rows: &[Vec<Formula>]) -> String {
    let cells: Vec<Vec<String>> = rows.iter().map(|row| row.iter().map(formula).collect()).collect();
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

/// How tightly a formula holds together.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Tight {
    Sum,
    Product,
    Quotient,
    Power,
}

/// A formula on one line.
pub fn formula(formula: &Formula) -> String {
    written(formula).0
}

fn written(formula: &Formula) -> (String, Tight) {
    match formula {
        Formula::Number(number) => match shown(number) {
            Shown::Whole(text) => (text, Tight::Power),
            Shown::Fraction(numerator, denominator) => (format!("{numerator}/{denominator}"), Tight::Quotient),
        },
        Formula::Decimal(text) => (text.clone(), Tight::Power),
        Formula::Imaginary => ("i".into(), Tight::Power),
        Formula::Pi => ("pi".into(), Tight::Power),
        Formula::Name(label) => (name(label), Tight::Power),
        Formula::Sum(terms) => {
            let mut text = String::new();
            for (index, (negative, term)) in terms.iter().enumerate() {
                text += match (index, negative) {
                    (0, false) => "",
                    (0, true) => "-",
                    (_, false) => " + ",
                    (_, true) => " - ",
                };
                text += &within(term, Tight::Product);
            }
            (text, Tight::Sum)
        }
        Formula::Product(factors) => {
            let written: Vec<String> = factors.iter().map(|factor| within(factor, Tight::Quotient)).collect();
            (written.join(" "), Tight::Product)
        }
        Formula::Quotient(over, under) => {
            let over = match written(over) {
                (text, Tight::Sum | Tight::Quotient) => format!("({text})"),
                (text, _) => text,
            };
            (format!("{over}/{}", within(under, Tight::Power)), Tight::Quotient)
        }
        Formula::Power(base, exponent) => (format!("{}^{exponent}", within(base, Tight::Power)), Tight::Power),
        Formula::Root(inside) => (format!("sqrt({})", self::formula(inside)), Tight::Power),
        Formula::Call(function, arguments) => {
            let arguments: Vec<String> = arguments.iter().map(self::formula).collect();
            (format!("{function}({})", arguments.join(", ")), Tight::Power)
        }
        Formula::Symbol(symbol, None) => (symbol.to_string(), Tight::Power),
        Formula::Symbol(symbol, Some(index)) => (format!("{symbol}_{}", within(index, Tight::Power)), Tight::Power),
        Formula::Matrix(rows) => {
            let rows: Vec<String> =
                rows.iter().map(|row| row.iter().map(self::formula).collect::<Vec<_>>().join(", ")).collect();
            (format!("[{}]", rows.join("; ")), Tight::Power)
        }
        Formula::Equal(..) => (equation(formula), Tight::Sum),
    }
}

fn within(formula: &Formula, least: Tight) -> String {
    let (text, tight) = written(formula);
    if tight < least { format!("({text})") } else { text }
}

/// `x_block''`, `m[3]`.
fn name(label: &Label) -> String {
    // Primes belong to the letter, but stand where they are read: at the end.
    format!("{}{}", readable(&label.plain()), "'".repeat(usize::from(label.dots)))
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

/// A long equation breaks before a sign between its terms.
fn broken(line: &str) -> String {
    let mut text = String::from("    ");
    let (mut column, mut depth) = (4, 0i32);
    let words: Vec<&str> = line.split(' ').collect();
    for (index, word) in words.iter().enumerate() {
        let is_sign = depth == 0 && ["+", "-", "="].contains(word);
        // How far the next term reaches.
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
