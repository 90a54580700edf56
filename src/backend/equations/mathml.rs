//! Equations in MathML, which browsers display without scripts: a complete page, or sections for a report.

use super::document::{Document, Inline, Section};
use super::formula::{Formula, Running, greek_letter};
use super::write::{self, Language, Piece, Tight};
use crate::base::readable::readable;
use crate::equations::names::Label;

pub fn mathml(document: &Document) -> String {
    let title = escape(&document.title);
    let head = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n<style>body {{ max-width: 60rem; \
         margin: 2rem auto; padding: 0 1rem; font-family: serif; }} h1 {{ font-size: 1.5rem; overflow-wrap: anywhere; }} \
         math[display=block] {{ margin: 0.6rem 0; overflow-x: auto; \
         overflow-y: hidden; }}</style>\n</head>\n<body>\n"
    );
    format!("{head}{}</body>\n</html>\n", write::document(&MathMl, document))
}

/// The items of one section without its heading: paragraphs, and each formula as a `math` element. Text is escaped;
/// there is no script, no style and no reference to anything outside the page.
pub fn section(section: &Section) -> String {
    section.items.iter().map(|item| write::item(&MathMl, item)).collect()
}

fn escape(text: &str) -> String {
    readable(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

struct MathMl;

impl Language for MathMl {
    fn number(&self, digits: &str) -> String {
        format!("<mn>{digits}</mn>")
    }

    fn decimal(&self, text: &str) -> Piece {
        match text.split_once('e') {
            Some((number, power)) => {
                let power = format!("<msup><mn>10</mn><mn>{}</mn></msup>", escape(power));
                (self.group(format!("<mn>{}</mn><mo>·</mo>{power}", escape(number))), Tight::Product)
            }
            None => (format!("<mn>{}</mn>", escape(text)), Tight::Power),
        }
    }

    fn quotient(&self, over: Piece, under: Piece) -> Piece {
        (format!("<mfrac>{}{}</mfrac>", over.0, under.0), Tight::Quotient)
    }

    fn imaginary(&self) -> &'static str {
        "<mi mathvariant=\"normal\">i</mi>"
    }

    fn pi(&self) -> &'static str {
        "<mi>π</mi>"
    }

    fn name(&self, label: &Label) -> String {
        let (word, index) = write::letter_and_index(label);
        let letter = letters(&word);
        let letter = match label.dots {
            0 => letter,
            1 => format!("<mover accent=\"true\">{letter}<mo>˙</mo></mover>"),
            _ => format!("<mover accent=\"true\">{letter}<mo>¨</mo></mover>"),
        };
        if index.is_empty() {
            return letter;
        }
        let part = |part: &str| if write::is_plain_index(part) { format!("<mn>{part}</mn>") } else { letters(part) };
        let parts: Vec<String> = index.split(',').map(part).collect();
        format!("<msub>{letter}{}</msub>", self.group(parts.join("<mo>,</mo>")))
    }

    fn sign(&self, first: bool, negative: bool) -> &'static str {
        match (first, negative) {
            (true, false) => "",
            (_, true) => "<mo>−</mo>",
            (false, false) => "<mo>+</mo>",
        }
    }

    fn times(&self) -> &'static str {
        "<mo>&#x2062;</mo>"
    }

    fn brackets(&self, inner: &str) -> String {
        self.group(format!("<mo>(</mo>{inner}<mo>)</mo>"))
    }

    fn power(&self, base: &str, exponent: u32) -> String {
        format!("<msup>{base}<mn>{exponent}</mn></msup>")
    }

    fn root(&self, inside: &str) -> String {
        format!("<msqrt>{inside}</msqrt>")
    }

    fn call(&self, function: &str, arguments: &[String], _: bool) -> Piece {
        let arguments = arguments.join("<mo>,</mo>");
        let text = format!("<mi>{function}</mi><mo>&#x2061;</mo><mo>(</mo>{arguments}<mo>)</mo>");
        (self.group(text), Tight::Power)
    }

    fn with_index(&self, letter: &str, index: Option<Piece>) -> String {
        match index {
            None => format!("<mi>{letter}</mi>"),
            Some((index, _)) => format!("<msub><mi>{letter}</mi>{index}</msub>"),
        }
    }

    fn series(&self, Running { index, first, last }: &Running, term: &str) -> String {
        let below = self.group(format!("<mi>{index}</mi><mo>=</mo><mn>{first}</mn>"));
        self.group(format!("<munderover><mo>∑</mo>{below}<mn>{last}</mn></munderover>{term}"))
    }

    fn matrix(&self, rows: &[Vec<String>]) -> String {
        let row = |row: &Vec<String>| {
            let cells: String = row.iter().map(|cell| format!("<mtd>{cell}</mtd>")).collect();
            format!("<mtr>{cells}</mtr>")
        };
        let rows: String = rows.iter().map(row).collect();
        self.group(format!("<mo>[</mo><mtable>{rows}</mtable><mo>]</mo>"))
    }

    fn equal(&self, left: &str, right: &str) -> String {
        format!("{left}<mo>=</mo>{right}")
    }

    fn group(&self, inner: String) -> String {
        format!("<mrow>{inner}</mrow>")
    }

    fn prose(&self, text: &str) -> String {
        escape(text)
    }

    fn in_sentence(&self, formula: &str) -> String {
        format!("<math>{formula}</math>")
    }

    fn title(&self, text: &str) -> String {
        format!("<h1>{}</h1>\n", escape(text))
    }

    fn heading(&self, text: &str) -> String {
        format!("<h2>{}</h2>\n", escape(text))
    }

    fn paragraph(&self, inner: &str) -> String {
        format!("<p>{inner}</p>\n")
    }

    fn display(&self, formula: &Formula, note: &[Inline]) -> String {
        let in_math = |inline: &Inline| match inline {
            Inline::Text(text) => format!("<mtext>{}</mtext>", escape(text)),
            Inline::Formula(of) => write::formula(self, of),
        };
        let note: String = note.iter().map(in_math).collect();
        let gap = if note.is_empty() { "" } else { "<mspace width=\"2em\"/>" };
        format!("<math display=\"block\">{}{gap}{note}</math>\n", write::formula(self, formula))
    }

    fn display_matrix(&self, name: &Formula, rows: &[Vec<Formula>]) -> String {
        let (name, matrix) = (write::formula(self, name), self.matrix(&write::cells(self, rows)));
        format!("<math display=\"block\">{name}<mo>=</mo>{matrix}</math>\n")
    }
}

fn letters(word: &str) -> String {
    match greek_letter(word) {
        Some(letter) => format!("<mi>{letter}</mi>"),
        None => format!("<mi>{}</mi>", escape(word)),
    }
}
