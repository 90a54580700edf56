//! Equations as a Typst document.

use super::document::{Document, Inline, Item};
use super::formula::{Formula, Shown, greek_letter, shown};
use super::latex::split;
use crate::equations::names::Label;

pub fn typst(document: &Document) -> String {
    let mut text = format!("= {}\n", prose(&document.title));
    for section in &document.sections {
        text += &format!("\n== {}\n\n", prose(section.heading));
        for item in &section.items {
            text += &item_text(item);
        }
    }
    text
}

fn item_text(item: &Item) -> String {
    match item {
        Item::Paragraph(inlines) => format!("{}\n\n", inlines.iter().map(inline).collect::<String>()),
        Item::Formula { formula: of, note } => {
            let note: String = note.iter().map(inline_in_math).collect();
            let gap = if note.is_empty() { "" } else { " quad " };
            format!("$ {}{gap}{note} $\n\n", formula(of))
        }
        Item::Matrices(matrices) => {
            let one =
                |(name, rows): &(Formula, Vec<Vec<Formula>>)| format!("$ {} = {} $\n\n", formula(name), matrix(rows));
            matrices.iter().map(one).collect()
        }
    }
}

fn inline(inline: &Inline) -> String {
    match inline {
        Inline::Text(text) => prose(text),
        Inline::Formula(of) => format!("${}$", formula(of)),
    }
}

fn inline_in_math(inline: &Inline) -> String {
    match inline {
        Inline::Text(text) => quoted(text),
        Inline::Formula(of) => format!(" {} ", formula(of)),
    }
}

/// Text that steers nothing.
fn prose(text: &str) -> String {
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

fn quoted(text: &str) -> String {
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

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Tight {
    Sum,
    Product,
    Power,
}

pub fn formula(of: &Formula) -> String {
    written(of).0
}

fn written(of: &Formula) -> (String, Tight) {
    match of {
        Formula::Number(number) => match shown(number) {
            Shown::Whole(text) => (text, Tight::Power),
            Shown::Fraction(over, under) => (format!("frac({over}, {under})"), Tight::Product),
        },
        Formula::Decimal(text) => match text.split_once('e') {
            Some((number, power)) => (format!("{number} dot 10^({power})"), Tight::Product),
            None => (text.clone(), Tight::Power),
        },
        Formula::Imaginary => ("upright(i)".into(), Tight::Power),
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
            let factors: Vec<String> = factors.iter().map(|factor| within(factor, Tight::Product)).collect();
            (factors.join(" "), Tight::Product)
        }
        Formula::Quotient(over, under) => (format!("frac({}, {})", formula(over), formula(under)), Tight::Product),
        Formula::Power(base, exponent) => (format!("{}^{exponent}", within(base, Tight::Power)), Tight::Power),
        Formula::Root(inside) => (format!("sqrt({})", formula(inside)), Tight::Power),
        Formula::Call(function, arguments) => {
            let function = match *function {
                "asin" => "arcsin",
                "acos" => "arccos",
                "atan" => "arctan",
                "atan2" => "op(\"atan2\")",
                "abs" => "op(\"abs\")",
                "pow" => "op(\"pow\")",
                other => other,
            };
            let arguments: Vec<String> = arguments.iter().map(formula).collect();
            (format!("{function}({})", arguments.join(", ")), Tight::Power)
        }
        Formula::Symbol(symbol, None) => ((*symbol).to_string(), Tight::Power),
        Formula::Symbol(symbol, Some(index)) => (format!("{symbol}_({})", formula(index)), Tight::Power),
        Formula::Matrix(rows) => (matrix(rows), Tight::Power),
        Formula::Equal(left, right) => (format!("{} = {}", formula(left), formula(right)), Tight::Sum),
    }
}

fn within(of: &Formula, least: Tight) -> String {
    let (text, tight) = written(of);
    if tight < least { format!("({text})") } else { text }
}

fn matrix(rows: &[Vec<Formula>]) -> String {
    let rows: Vec<String> = rows.iter().map(|row| row.iter().map(formula).collect::<Vec<_>>().join(", ")).collect();
    format!("mat(delim: \"[\", {})", rows.join("; "))
}

/// `dot.double(theta)_"rod"`
fn name(label: &Label) -> String {
    let (word, mut index) = split(&label.word);
    if !label.index.is_empty() {
        index = if index.is_empty() { label.index.clone() } else { format!("{index},{}", label.index) };
    }
    let letter = letters(&word);
    let letter = match label.dots {
        0 => letter,
        1 => format!("dot({letter})"),
        _ => format!("dot.double({letter})"),
    };
    if index.is_empty() {
        return letter;
    }
    let parts: Vec<String> = index
        .split(',')
        .map(|part| if part.chars().all(|c| c.is_ascii_digit()) { part.to_string() } else { letters(part) })
        .collect();
    format!("{letter}_({})", parts.join(" \",\" "))
}

fn letters(word: &str) -> String {
    match greek_letter(word) {
        Some(letter) => letter.to_string(),
        None if word.chars().count() == 1 && word.chars().all(|c| c.is_ascii_alphanumeric()) => word.to_string(),
        None => quoted(word),
    }
}
