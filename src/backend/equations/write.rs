//! The traversal of a formula and a document that all output formats share: it decides where brackets are needed and
//! where signs are written. An output format is a [`Language`], which only defines how each part is written.

use super::document::{Document, Inline, Item};
use super::formula::{Formula, Running, Shown, as_shown};
use crate::equations::names::Label;

/// The binding strength of a formula; a formula that binds less tightly than its position requires gets brackets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Tight {
    Sum,
    Product,
    Quotient,
    Power,
}

/// The text of a formula, and its binding strength.
pub type Piece = (String, Tight);

/// The notation of an output format for the parts of formulas and of the document around them.
pub trait Language {
    /// A whole number or a short decimal.
    fn number(&self, digits: &str) -> String {
        digits.to_string()
    }
    /// A rounded number, possibly with a power of ten.
    fn decimal(&self, text: &str) -> Piece;
    /// A quotient; both sides are given without brackets.
    fn quotient(&self, over: Piece, under: Piece) -> Piece;
    fn imaginary(&self) -> &'static str;
    fn pi(&self) -> &'static str;
    fn name(&self, label: &Label) -> String;
    /// The sign of a term, which is the first of its sum or a later one.
    fn sign(&self, first: bool, negative: bool) -> &'static str {
        match (first, negative) {
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        }
    }
    /// The separator between factors.
    fn times(&self) -> &'static str {
        " "
    }
    fn brackets(&self, inner: &str) -> String {
        format!("({inner})")
    }
    fn power(&self, base: &str, exponent: u32) -> String {
        format!("{base}^{exponent}")
    }
    fn root(&self, inside: &str) -> String {
        format!("sqrt({inside})")
    }
    /// A function of arguments; `single` means that there is one argument, a name.
    fn call(&self, function: &str, arguments: &[String], single: bool) -> Piece;
    /// The power of a function, if the format puts the exponent after the function's name.
    fn call_power(&self, _function: &str, _arguments: &[String], _exponent: u32) -> Option<String> {
        None
    }
    /// A capital letter, possibly with an index: `Q_theta`.
    fn with_index(&self, letter: &str, index: Option<Piece>) -> String;
    /// A sum over an index.
    fn series(&self, span: &Running, term: &str) -> String;
    fn matrix(&self, rows: &[Vec<String>]) -> String;
    fn equal(&self, left: &str, right: &str) -> String {
        format!("{left} = {right}")
    }
    /// Groups the parts of a sum or product, for formats with elements.
    fn group(&self, inner: String) -> String {
        inner
    }

    // ---- The document around the formulas ----

    fn prose(&self, text: &str) -> String;
    /// A formula within a sentence.
    fn in_sentence(&self, formula: &str) -> String;
    fn title(&self, text: &str) -> String;
    fn heading(&self, text: &str) -> String;
    fn paragraph(&self, inner: &str) -> String;
    /// A formula on a separate line, followed by its note.
    fn display(&self, formula: &Formula, note: &[Inline]) -> String;
    fn display_matrix(&self, name: &Formula, rows: &[Vec<Formula>]) -> String;
}

/// Title and sections.
pub fn document<L: Language>(language: &L, document: &Document) -> String {
    let mut text = language.title(&document.title);
    for section in &document.sections {
        text += &language.heading(section.heading);
        text += &section.items.iter().map(|item| self::item(language, item)).collect::<String>();
    }
    text
}

/// One item of a section.
pub fn item<L: Language>(language: &L, item: &Item) -> String {
    match item {
        Item::Paragraph(inlines) => language.paragraph(&sentence(language, inlines)),
        Item::Formula { formula, note } => language.display(formula, note),
        Item::Matrices(matrices) => matrices.iter().map(|(name, rows)| language.display_matrix(name, rows)).collect(),
    }
}

pub fn sentence<L: Language>(language: &L, inlines: &[Inline]) -> String {
    let part = |inline: &Inline| match inline {
        Inline::Text(text) => language.prose(text),
        Inline::Formula(of) => language.in_sentence(&formula(language, of)),
    };
    inlines.iter().map(part).collect()
}

pub fn formula<L: Language>(language: &L, of: &Formula) -> String {
    write(language, of).0
}

/// Each entry of a matrix.
pub fn cells<L: Language>(language: &L, rows: &[Vec<Formula>]) -> Vec<Vec<String>> {
    rows.iter().map(|row| row.iter().map(|cell| formula(language, cell)).collect()).collect()
}

/// A term of a sum with its sign.
pub fn term<L: Language>(language: &L, first: bool, negative: bool, term: &Formula) -> String {
    format!("{}{}", language.sign(first, negative), write_within(language, term, Tight::Product))
}

fn write<L: Language>(language: &L, of: &Formula) -> Piece {
    let power = |text: String| (text, Tight::Power);
    let list = |formulas: &[Formula]| formulas.iter().map(|each| formula(language, each)).collect::<Vec<String>>();
    match of {
        Formula::Number(number) => match as_shown(number) {
            Shown::Whole(text) => power(language.number(&text)),
            Shown::Fraction(over, under) => {
                language.quotient(power(language.number(&over)), power(language.number(&under)))
            }
        },
        Formula::Decimal(text) => language.decimal(text),
        Formula::Imaginary => power(language.imaginary().to_string()),
        Formula::Pi => power(language.pi().to_string()),
        Formula::Name(label) => power(language.name(label)),
        Formula::Sum(terms) => {
            let terms = terms.iter().enumerate();
            let text = terms.map(|(index, (negative, each))| term(language, index == 0, *negative, each)).collect();
            (language.group(text), Tight::Sum)
        }
        Formula::Product(factors) => {
            let factors: Vec<String> =
                factors.iter().map(|each| write_within(language, each, Tight::Product)).collect();
            (language.group(factors.join(language.times())), Tight::Product)
        }
        Formula::Quotient(over, under) => language.quotient(write(language, over), write(language, under)),
        Formula::Power(base, exponent) => {
            let of_call = match &**base {
                Formula::Call(function, arguments) => language.call_power(function, &list(arguments), *exponent),
                _ => None,
            };
            power(of_call.unwrap_or_else(|| language.power(&write_within(language, base, Tight::Power), *exponent)))
        }
        Formula::Root(inside) => power(language.root(&formula(language, inside))),
        Formula::Call(function, arguments) => {
            let single = matches!(&arguments[..], [Formula::Name(_)]);
            language.call(function, &list(arguments), single)
        }
        Formula::Symbol(letter, index) => {
            power(language.with_index(letter, index.as_ref().map(|index| write(language, index))))
        }
        Formula::Series(span, each) => {
            (language.series(span, &write_within(language, each, Tight::Product)), Tight::Product)
        }
        Formula::Matrix(rows) => power(language.matrix(&cells(language, rows))),
        Formula::Equal(left, right) => {
            (language.group(language.equal(&formula(language, left), &formula(language, right))), Tight::Sum)
        }
    }
}

fn write_within<L: Language>(language: &L, of: &Formula, least: Tight) -> String {
    let (text, tight) = write(language, of);
    if tight < least { language.brackets(&text) } else { text }
}

/// `m1` is m with the index 1, `m[3]` too, `k_front` k with the index front, `front.k` of a component as well; the
/// label's own index follows.
pub fn letter_and_index(label: &Label) -> (String, String) {
    let (word, index) = match label.word.rsplit_once('.') {
        Some((path, word)) if !path.is_empty() && !word.is_empty() => {
            let (word, index) = split(word);
            let path = path.replace("][", ",").replace('[', ",").replace(']', "");
            (word, if index.is_empty() { path } else { format!("{index},{path}") })
        }
        _ => split(&label.word),
    };
    match (index.is_empty(), label.index.is_empty()) {
        (_, true) => (word, index),
        (true, false) => (word, label.index.clone()),
        (false, false) => (word, format!("{index},{}", label.index)),
    }
}

fn split(word: &str) -> (String, String) {
    let word = word.replace("][", ",").replace('[', "_").replace(']', "");
    if let Some((letter, index)) =
        word.split_once('_').filter(|(letter, index)| !letter.is_empty() && !index.is_empty())
    {
        return (letter.to_string(), index.replace('_', ","));
    }
    let digits = word.len() - word.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    let (letter, index) = word.split_at(word.len() - digits);
    if letter.is_empty() { (word, String::new()) } else { (letter.to_string(), index.to_string()) }
}

/// A part of an index that is kept unchanged: a number, or a running index with an offset (`i-1`).
pub fn is_plain_index(part: &str) -> bool {
    let running = part.split_once(['+', '-']).is_some_and(|(letter, by)| letter.len() == 1 && is_digits(by));
    is_digits(part) || running
}

fn is_digits(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_ascii_digit())
}
