//! Equations as a LaTeX document that needs only `article` and `amsmath`.

use super::document::{Document, Inline};
use super::formula::{Formula, Running, greek_name};
use super::write::{self, Language, Piece, Tight};
use crate::equations::names::Label;

pub fn latex(document: &Document) -> String {
    let head = "\\documentclass{article}\n\\usepackage{amsmath}\n\\usepackage[margin=25mm]{geometry}\n\\setlength{\\parindent}{0pt}\n\\begin{document}\n";
    format!("{head}{}\\end{{document}}\n", write::document(&Latex, document))
}

/// A formula in math mode.
pub fn formula(of: &Formula) -> String {
    write::formula(&Latex, of)
}

struct Latex;

impl Language for Latex {
    /// `3.1e-7` as a power of ten.
    fn decimal(&self, text: &str) -> Piece {
        let text = text.replace('≤', "\\le ");
        match text.rsplit_once('e').filter(|(_, power)| power.parse::<i32>().is_ok()) {
            Some((number, power)) => (format!("{number} \\cdot 10^{{{power}}}"), Tight::Product),
            None => (text, Tight::Power),
        }
    }

    fn quotient(&self, over: Piece, under: Piece) -> Piece {
        (format!("\\frac{{{}}}{{{}}}", over.0, under.0), Tight::Quotient)
    }

    fn imaginary(&self) -> &'static str {
        "\\mathrm{i}"
    }

    fn pi(&self) -> &'static str {
        "\\pi"
    }

    /// `\ddot{\theta}_{\mathrm{rod}}`
    fn name(&self, label: &Label) -> String {
        let (word, index) = write::letter_and_index(label);
        let letter = letters(&word);
        let letter = match label.dots {
            0 => letter,
            1 => format!("\\dot{{{letter}}}"),
            _ => format!("\\ddot{{{letter}}}"),
        };
        if index.is_empty() {
            return letter;
        }
        let part = |part: &str| if write::is_plain_index(part) { part.to_string() } else { letters(part) };
        format!("{letter}_{{{}}}", index.split(',').map(part).collect::<Vec<_>>().join(","))
    }

    fn times(&self) -> &'static str {
        " \\, "
    }

    fn brackets(&self, inner: &str) -> String {
        format!("\\left({inner}\\right)")
    }

    fn power(&self, base: &str, exponent: u32) -> String {
        format!("{base}^{{{exponent}}}")
    }

    fn root(&self, inside: &str) -> String {
        format!("\\sqrt{{{inside}}}")
    }

    fn call(&self, function: &str, arguments: &[String], single: bool) -> Piece {
        let command = match function {
            "asin" => "\\arcsin".to_string(),
            "acos" => "\\arccos".to_string(),
            "atan" => "\\arctan".to_string(),
            "atan2" | "abs" | "pow" => format!("\\operatorname{{{function}}}"),
            other => format!("\\{other}"),
        };
        match arguments {
            [argument] if single && ["sin", "cos"].contains(&function) => {
                (format!("{command} {argument}"), Tight::Product)
            }
            _ => (format!("{command}{}", self.brackets(&arguments.join(", "))), Tight::Power),
        }
    }

    /// sin^2 x
    fn call_power(&self, function: &str, arguments: &[String], exponent: u32) -> Option<String> {
        let arguments = self.brackets(&arguments.join(", "));
        ["sin", "cos"].contains(&function).then(|| format!("\\{function}^{{{exponent}}}{arguments}"))
    }

    fn with_index(&self, letter: &str, index: Option<Piece>) -> String {
        index.map_or_else(|| letter.to_string(), |(index, _)| format!("{letter}_{{{index}}}"))
    }

    fn series(&self, Running { index, first, last }: &Running, term: &str) -> String {
        format!("\\sum_{{{index}={first}}}^{{{last}}} {term}")
    }

    fn matrix(&self, rows: &[Vec<String>]) -> String {
        let rows: Vec<String> = rows.iter().map(|row| row.join(" & ")).collect();
        format!("\\begin{{bmatrix}} {} \\end{{bmatrix}}", rows.join(" \\\\ "))
    }

    fn prose(&self, text: &str) -> String {
        prose(text)
    }

    fn in_sentence(&self, formula: &str) -> String {
        format!("${formula}$")
    }

    fn title(&self, text: &str) -> String {
        format!("\\section*{{{}}}\n", prose(text))
    }

    fn heading(&self, text: &str) -> String {
        format!("\n\\subsection*{{{}}}\n", prose(text))
    }

    fn paragraph(&self, inner: &str) -> String {
        format!("{inner}\n\n")
    }

    fn display(&self, formula: &Formula, note: &[Inline]) -> String {
        let note = match note {
            [] => String::new(),
            note => format!(" \\qquad \\text{{{}}}", write::sentence(self, note)),
        };
        match formula {
            Formula::Equal(left, right) => format!(
                "\\begin{{multline*}}\n{} = {}{note}\n\\end{{multline*}}\n",
                write::formula(self, left),
                breakable(right)
            ),
            other => format!("\\begin{{equation*}}\n{}{note}\n\\end{{equation*}}\n", write::formula(self, other)),
        }
    }

    fn display_matrix(&self, name: &Formula, rows: &[Vec<Formula>]) -> String {
        let (name, matrix) = (write::formula(self, name), self.matrix(&write::cells(self, rows)));
        format!("\\begin{{equation*}}\n{name} = {matrix}\n\\end{{equation*}}\n")
    }
}

/// Breaks a sum of many terms into lines after every few of them.
fn breakable(of: &Formula) -> String {
    const PER_LINE: usize = 4;
    let Formula::Sum(terms) = of else { return formula(of) };
    let mut text = String::new();
    for (index, (negative, term)) in terms.iter().enumerate() {
        if index > 0 && index % PER_LINE == 0 {
            text += " \\\\\n";
        }
        text += &write::term(&Latex, index == 0, *negative, term);
    }
    text
}

/// Escapes text so that it contains no commands.
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

fn letters(word: &str) -> String {
    match greek(word) {
        Some(command) => command,
        None if word.chars().count() == 1 && word.is_ascii() => word.to_string(),
        None => format!("\\mathrm{{{}}}", prose_in_math(word)),
    }
}

fn prose_in_math(word: &str) -> String {
    let part = |c: char| match c {
        '_' => "\\_".to_string(),
        c if c.is_ascii_alphanumeric() || c == '.' => c.to_string(),
        c => greek(&c.to_string()).unwrap_or_else(|| "?".to_string()),
    };
    word.chars().map(part).collect()
}

/// The command of a Greek letter, written out or as a character.
fn greek(word: &str) -> Option<String> {
    let name = greek_name(word)?;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_is_only_a_bound_has_its_sign_and_its_power() {
        let decimal = |text| Latex.decimal(text).0;
        assert_eq!(decimal("3.1e-7"), "3.1 \\cdot 10^{-7}");
        assert_eq!(decimal("≤ 5e-13"), "\\le  5 \\cdot 10^{-13}");
        assert_eq!(decimal("≤ 0.5"), "\\le  0.5");
    }
}
