//! Equations as a LaTeX document: `article` with `amsmath`, nothing else.

use super::document::{Document, Inline, Item};
use super::formula::{Formula, Shown, shown};
use crate::equations::names::Label;

pub fn latex(document: &Document) -> String {
    let mut text = String::from(
        "\\documentclass{article}\n\\usepackage{amsmath}\n\\usepackage[margin=25mm]{geometry}\n\\setlength{\\parindent}{0pt}\n\\begin{document}\n",
    );
    text += &format!("\\section*{{{}}}\n", prose(&document.title));
    for section in &document.sections {
        text += &format!("\n\\subsection*{{{}}}\n", prose(section.heading));
        for item in &section.items {
            text += &item_text(item);
        }
    }
    text + "\\end{document}\n"
}

fn item_text(item: &Item) -> String {
    match item {
        Item::Paragraph(inlines) => format!("{}\n\n", inlines.iter().map(inline).collect::<String>()),
        Item::Formula { formula: Formula::Equal(left, right), note } => {
            format!(
                "\\begin{{multline*}}\n{} = {}{}\n\\end{{multline*}}\n",
                formula(left),
                breakable(right),
                note_text(note)
            )
        }
        Item::Formula { formula: other, note } => {
            format!("\\begin{{equation*}}\n{}{}\n\\end{{equation*}}\n", formula(other), note_text(note))
        }
        Item::Matrices(matrices) => {
            let one = |(name, rows): &(Formula, Vec<Vec<Formula>>)| {
                format!("\\begin{{equation*}}\n{} = {}\n\\end{{equation*}}\n", formula(name), matrix(rows))
            };
            matrices.iter().map(one).collect()
        }
    }
}

/// A sum of many terms goes on in a new line after every few of them.
fn breakable(of: &Formula) -> String {
    const PER_LINE: usize = 4;
    match of {
        Formula::Sum(terms) if terms.len() > PER_LINE => {
            let mut text = String::new();
            for (index, (negative, term)) in terms.iter().enumerate() {
                if index > 0 && index % PER_LINE == 0 {
                    text += " \\\\\n";
                }
                text += sign(index, *negative);
                text += &within(term, Tight::Product);
            }
            text
        }
        other => formula(other),
    }
}

fn note_text(note: &[Inline]) -> String {
    if note.is_empty() {
        return String::new();
    }
    let text: String = note.iter().map(inline).collect();
    format!(" \\qquad \\text{{{text}}}")
}

fn inline(inline: &Inline) -> String {
    match inline {
        Inline::Text(text) => prose(text),
        Inline::Formula(of) => format!("${}$", formula(of)),
    }
}

/// Text that steers nothing.
fn prose(text: &str) -> String {
    let mut escaped = String::new();
    for c in text.chars() {
        match c {
            '\\' => escaped += "\\textbackslash{}",
            '{' | '}' | '$' | '&' | '#' | '_' | '%' => {
                escaped.push('\\');
                escaped.push(c);
            }
            '^' => escaped += "\\textasciicircum{}",
            '~' => escaped += "\\textasciitilde{}",
            '·' => escaped += "$\\cdot$",
            '≤' => escaped += "$\\le$",
            c if greek(&c.to_string()).is_some() => {
                escaped += &format!("${}$", greek(&c.to_string()).unwrap_or_default())
            }
            c if c.is_control() => escaped.push(' '),
            c if c.is_ascii() => escaped.push(c),
            _ => escaped.push('?'),
        }
    }
    escaped
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

fn sign(index: usize, negative: bool) -> &'static str {
    match (index, negative) {
        (0, false) => "",
        (0, true) => "-",
        (_, false) => " + ",
        (_, true) => " - ",
    }
}

fn written(of: &Formula) -> (String, Tight) {
    match of {
        Formula::Number(number) => match shown(number) {
            Shown::Whole(text) => (text, Tight::Power),
            Shown::Fraction(over, under) => (format!("\\frac{{{over}}}{{{under}}}"), Tight::Product),
        },
        Formula::Decimal(text) => (decimal(text), Tight::Power),
        Formula::Imaginary => ("\\mathrm{i}".into(), Tight::Power),
        Formula::Pi => ("\\pi".into(), Tight::Power),
        Formula::Name(label) => (name(label), Tight::Power),
        Formula::Sum(terms) => {
            let term = |(index, (negative, term)): (usize, &(bool, Formula))| {
                format!("{}{}", sign(index, *negative), within(term, Tight::Product))
            };
            (terms.iter().enumerate().map(term).collect(), Tight::Sum)
        }
        Formula::Product(factors) => {
            let factors: Vec<String> = factors.iter().map(|factor| within(factor, Tight::Product)).collect();
            (factors.join(" \\, "), Tight::Product)
        }
        Formula::Quotient(over, under) => {
            (format!("\\frac{{{}}}{{{}}}", formula(over), formula(under)), Tight::Product)
        }
        Formula::Power(base, exponent) => match &**base {
            // sin^2 x
            Formula::Call(function @ ("sin" | "cos"), arguments) => {
                (format!("\\{function}^{{{exponent}}}{}", bracketed(arguments)), Tight::Power)
            }
            base => (format!("{}^{{{exponent}}}", within(base, Tight::Power)), Tight::Power),
        },
        Formula::Root(inside) => (format!("\\sqrt{{{}}}", formula(inside)), Tight::Power),
        Formula::Call(function, arguments) => {
            let function = match *function {
                "asin" => "\\arcsin".to_string(),
                "acos" => "\\arccos".to_string(),
                "atan" => "\\arctan".to_string(),
                "atan2" | "abs" | "pow" => format!("\\operatorname{{{function}}}"),
                other => format!("\\{other}"),
            };
            match &arguments[..] {
                [argument @ Formula::Name(_)] if ["\\sin", "\\cos"].contains(&function.as_str()) => {
                    (format!("{function} {}", formula(argument)), Tight::Product)
                }
                _ => (format!("{function}{}", bracketed(arguments)), Tight::Power),
            }
        }
        Formula::Symbol(symbol, None) => ((*symbol).to_string(), Tight::Power),
        Formula::Symbol(symbol, Some(index)) => (format!("{symbol}_{{{}}}", formula(index)), Tight::Power),
        Formula::Matrix(rows) => (matrix(rows), Tight::Power),
        Formula::Equal(left, right) => (format!("{} = {}", formula(left), formula(right)), Tight::Sum),
    }
}

/// `3.1e-7` as a power of ten.
fn decimal(text: &str) -> String {
    match text.split_once('e') {
        Some((number, power)) => format!("{number} \\cdot 10^{{{power}}}"),
        None => text.replace('≤', "\\le "),
    }
}

fn bracketed(arguments: &[Formula]) -> String {
    let arguments: Vec<String> = arguments.iter().map(formula).collect();
    format!("\\left({}\\right)", arguments.join(", "))
}

fn within(of: &Formula, least: Tight) -> String {
    let (text, tight) = written(of);
    if tight < least { format!("\\left({text}\\right)") } else { text }
}

fn matrix(rows: &[Vec<Formula>]) -> String {
    let rows: Vec<String> = rows.iter().map(|row| row.iter().map(formula).collect::<Vec<_>>().join(" & ")).collect();
    format!("\\begin{{bmatrix}} {} \\end{{bmatrix}}", rows.join(" \\\\ "))
}

/// `\ddot{\theta}_{\mathrm{rod}}`
fn name(label: &Label) -> String {
    let (word, mut index) = split(&label.word);
    if !label.index.is_empty() {
        index = if index.is_empty() { label.index.clone() } else { format!("{index},{}", label.index) };
    }
    let mut text = letters(&word);
    match label.dots {
        0 => {}
        1 => text = format!("\\dot{{{text}}}"),
        _ => text = format!("\\ddot{{{text}}}"),
    }
    if index.is_empty() { text } else { format!("{text}_{{{}}}", index_text(&index)) }
}

/// `m1` is m with the index 1, `m[3]` too, `k_front` k with the index front.
pub(super) fn split(word: &str) -> (String, String) {
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

fn letters(word: &str) -> String {
    match greek(word) {
        Some(command) => command,
        None if word.chars().count() == 1 && word.is_ascii() => word.to_string(),
        None => format!("\\mathrm{{{}}}", prose_in_math(word)),
    }
}

fn index_text(index: &str) -> String {
    let parts = index
        .split(',')
        .map(|part| if part.chars().all(|c| c.is_ascii_digit()) { part.to_string() } else { letters(part) });
    parts.collect::<Vec<_>>().join(",")
}

fn prose_in_math(word: &str) -> String {
    let part = |c: char| match c {
        '_' => "\\_".to_string(),
        c if c.is_ascii_alphanumeric() => c.to_string(),
        c => greek(&c.to_string()).unwrap_or_else(|| "?".to_string()),
    };
    word.chars().map(part).collect()
}

/// The command of a Greek letter, written out or as a character.
fn greek(word: &str) -> Option<String> {
    let name = super::formula::greek_name(word)?;
    // Capitals that look like Latin ones have no command.
    let latin = [
        ("Alpha", "A"),
        ("Beta", "B"),
        ("Epsilon", "E"),
        ("Zeta", "Z"),
        ("Eta", "H"),
        ("Iota", "I"),
        ("Kappa", "K"),
        ("Mu", "M"),
        ("Nu", "N"),
        ("Omicron", "O"),
        ("Rho", "P"),
        ("Tau", "T"),
        ("Chi", "X"),
        ("omicron", "o"),
    ];
    let found = latin.iter().find(|(greek, _)| *greek == name);
    Some(found.map_or_else(|| format!("\\{name}"), |(_, letter)| format!("\\mathrm{{{letter}}}")))
}
