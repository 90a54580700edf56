//! Equations as a page with MathML, which browsers show without any script.

use super::document::{Document, Inline, Item};
use super::formula::{Formula, Shown, greek_letter, shown};
use super::latex::split;
use crate::base::readable::readable;
use crate::equations::names::Label;

pub fn mathml(document: &Document) -> String {
    let title = escaped(&document.title);
    let mut text = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n<style>body {{ max-width: 60rem; \
         margin: 2rem auto; font-family: serif; }} math[display=block] {{ margin: 0.6rem 0; }}</style>\n</head>\n<body>\n"
    );
    text += &fragment(document);
    text + "</body>\n</html>\n"
}

/// The sections without the page around them: for reports.
pub fn fragment(document: &Document) -> String {
    let mut text = format!("<h1>{}</h1>\n", escaped(&document.title));
    for section in &document.sections {
        text += &format!("<h2>{}</h2>\n", escaped(section.heading));
        for item in &section.items {
            text += &item_text(item);
        }
    }
    text
}

fn item_text(item: &Item) -> String {
    match item {
        Item::Paragraph(inlines) => format!("<p>{}</p>\n", inlines.iter().map(inline).collect::<String>()),
        Item::Formula { formula: of, note } => {
            let note: String = note.iter().map(in_math).collect();
            let gap = if note.is_empty() { "" } else { "<mspace width=\"2em\"/>" };
            format!("<math display=\"block\">{}{gap}{note}</math>\n", formula(of))
        }
        Item::Matrices(matrices) => {
            let one = |(name, rows): &(Formula, Vec<Vec<Formula>>)| {
                format!("<math display=\"block\">{}<mo>=</mo>{}</math>\n", formula(name), matrix(rows))
            };
            matrices.iter().map(one).collect()
        }
    }
}

fn inline(inline: &Inline) -> String {
    match inline {
        Inline::Text(text) => escaped(text),
        Inline::Formula(of) => format!("<math>{}</math>", formula(of)),
    }
}

fn in_math(inline: &Inline) -> String {
    match inline {
        Inline::Text(text) => format!("<mtext>{}</mtext>", escaped(text)),
        Inline::Formula(of) => formula(of),
    }
}

fn escaped(text: &str) -> String {
    readable(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Tight {
    Sum,
    Product,
    Power,
}

/// A formula as one element.
pub fn formula(of: &Formula) -> String {
    written(of).0
}

fn row(inner: String) -> String {
    format!("<mrow>{inner}</mrow>")
}

fn written(of: &Formula) -> (String, Tight) {
    match of {
        Formula::Number(number) => match shown(number) {
            Shown::Whole(text) => (format!("<mn>{text}</mn>"), Tight::Power),
            Shown::Fraction(over, under) => (format!("<mfrac><mn>{over}</mn><mn>{under}</mn></mfrac>"), Tight::Product),
        },
        Formula::Decimal(text) => match text.split_once('e') {
            Some((number, power)) => {
                let power = format!("<msup><mn>10</mn><mn>{power}</mn></msup>");
                (row(format!("<mn>{number}</mn><mo>·</mo>{power}")), Tight::Product)
            }
            None => (format!("<mn>{}</mn>", escaped(text)), Tight::Power),
        },
        Formula::Imaginary => ("<mi mathvariant=\"normal\">i</mi>".into(), Tight::Power),
        Formula::Pi => ("<mi>π</mi>".into(), Tight::Power),
        Formula::Name(label) => (name(label), Tight::Power),
        Formula::Sum(terms) => {
            let mut text = String::new();
            for (index, (negative, term)) in terms.iter().enumerate() {
                text += match (index, negative) {
                    (0, false) => "",
                    (_, true) => "<mo>−</mo>",
                    (_, false) => "<mo>+</mo>",
                };
                text += &within(term, Tight::Product);
            }
            (row(text), Tight::Sum)
        }
        Formula::Product(factors) => {
            let factors: Vec<String> = factors.iter().map(|factor| within(factor, Tight::Product)).collect();
            (row(factors.join("<mo>&#x2062;</mo>")), Tight::Product)
        }
        Formula::Quotient(over, under) => {
            (format!("<mfrac>{}{}</mfrac>", formula(over), formula(under)), Tight::Product)
        }
        Formula::Power(base, exponent) => {
            (format!("<msup>{}<mn>{exponent}</mn></msup>", within(base, Tight::Power)), Tight::Power)
        }
        Formula::Root(inside) => (format!("<msqrt>{}</msqrt>", formula(inside)), Tight::Power),
        Formula::Call(function, arguments) => {
            let arguments: Vec<String> = arguments.iter().map(formula).collect();
            let arguments = arguments.join("<mo>,</mo>");
            (row(format!("<mi>{function}</mi><mo>&#x2061;</mo><mo>(</mo>{arguments}<mo>)</mo>")), Tight::Power)
        }
        Formula::Symbol(symbol, None) => (format!("<mi>{symbol}</mi>"), Tight::Power),
        Formula::Symbol(symbol, Some(index)) => {
            (format!("<msub><mi>{symbol}</mi>{}</msub>", formula(index)), Tight::Power)
        }
        Formula::Matrix(rows) => (matrix(rows), Tight::Power),
        Formula::Equal(left, right) => (row(format!("{}<mo>=</mo>{}", formula(left), formula(right))), Tight::Sum),
    }
}

fn within(of: &Formula, least: Tight) -> String {
    let (text, tight) = written(of);
    if tight < least { row(format!("<mo>(</mo>{text}<mo>)</mo>")) } else { text }
}

fn matrix(rows: &[Vec<Formula>]) -> String {
    let cell = |cell: &Formula| format!("<mtd>{}</mtd>", formula(cell));
    let rows: String =
        rows.iter().map(|row| format!("<mtr>{}</mtr>", row.iter().map(cell).collect::<String>())).collect();
    row(format!("<mo>[</mo><mtable>{rows}</mtable><mo>]</mo>"))
}

fn name(label: &Label) -> String {
    let (word, mut index) = split(&label.word);
    if !label.index.is_empty() {
        index = if index.is_empty() { label.index.clone() } else { format!("{index},{}", label.index) };
    }
    let letter = letters(&word);
    let letter = match label.dots {
        0 => letter,
        1 => format!("<mover accent=\"true\">{letter}<mo>˙</mo></mover>"),
        _ => format!("<mover accent=\"true\">{letter}<mo>¨</mo></mover>"),
    };
    if index.is_empty() {
        return letter;
    }
    let parts: Vec<String> = index
        .split(',')
        .map(|part| if part.chars().all(|c| c.is_ascii_digit()) { format!("<mn>{part}</mn>") } else { letters(part) })
        .collect();
    format!("<msub>{letter}{}</msub>", row(parts.join("<mo>,</mo>")))
}

fn letters(word: &str) -> String {
    match greek_letter(word) {
        Some(letter) => format!("<mi>{letter}</mi>"),
        None => format!("<mi>{}</mi>", escaped(word)),
    }
}
