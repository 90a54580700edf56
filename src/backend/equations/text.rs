//! Equations as plain text: `m2 L^2/3 theta'' + m2 g L/2 theta = 0`.

use super::build::Builder;
use super::document::{Document, Inline, Writer};
use super::formula::{Formula, Running};
use super::lines::break_lines;
use super::write::{self, Language, Piece, Tight};
use crate::backend::report::wrap::fill_lines;
use crate::base::readable::readable;
use crate::equations::Equations;
use crate::equations::names::Label;

/// Indent of sentences and of formulas.
const SENTENCE: usize = 2;
const FORMULA: usize = 4;
/// Between a formula and its note.
const BESIDE: &str = "    ";

/// The document in lines of at most `width` columns; a name that is longer than a line is not broken.
pub fn text(document: &Document, width: usize) -> String {
    write::document(&Text { width }, document)
}

/// A formula on one line.
pub fn formula(of: &Formula) -> String {
    write::formula(&Text { width: usize::MAX }, of)
}

/// A sentence on one line.
pub fn sentence(inlines: &[Inline]) -> String {
    write::sentence(&Text { width: usize::MAX }, inlines)
}

/// The equations of the coordinates of some bodies, one a line: before anything is linearised, and about rest.
pub fn of_bodies(equations: &Equations, bodies: &[String]) -> (Vec<String>, Vec<String>) {
    let writer = Writer { equations, build: Builder::new(&equations.names) };
    let is_own = |index: usize| bodies.contains(&equations.bodies[index]);
    let moving = equations.nonlinear.iter().filter(|equation| is_own(equation.coordinate));
    let moving = moving.map(|equation| formula(&writer.equation(equation))).collect();
    let linear = equations.linear.coordinates.iter().enumerate().filter(|(_, index)| is_own(**index));
    (moving, linear.map(|(place, _)| formula(&writer.linear_equation(place, false))).collect())
}

struct Text {
    width: usize,
}

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

    fn with_index(&self, letter: &str, index: Option<Piece>) -> String {
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
        fill_lines(inner, SENTENCE, SENTENCE, self.width)
    }

    /// A formula and its note, beside its last line or, if it is long, as a sentence below.
    fn display(&self, formula: &Formula, note: &[Inline]) -> String {
        let formula = self::formula(formula);
        if note.is_empty() {
            return break_lines(&formula, self.width);
        }
        let note = sentence(note);
        let beside = |width: usize| format!("{}{BESIDE}{note}\n", break_lines(&formula, width).trim_end_matches('\n'));
        let fits = |text: &String| text.lines().last().is_none_or(|last| last.chars().count() <= self.width);
        let shorter = self.width.saturating_sub(BESIDE.len() + note.chars().count());
        [self.width, shorter.max(self.width / 2)].into_iter().map(beside).find(fits).unwrap_or_else(|| {
            format!("{}{}", break_lines(&formula, self.width), fill_lines(&note, SENTENCE, SENTENCE, self.width))
        })
    }

    /// Rows in brackets with their columns aligned; where they are too wide, the entries that are not zero.
    fn display_matrix(&self, name: &Formula, rows: &[Vec<Formula>]) -> String {
        let (name, cells) = (self::formula(name), write::cells(self, rows));
        let columns = cells.first().map_or(0, Vec::len);
        let width = |column: usize| cells.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..columns).map(width).collect();
        let front = name.chars().count() + 3;
        let brackets = 4 + 3 * columns.saturating_sub(1);
        if FORMULA + front + brackets + widths.iter().sum::<usize>() > self.width {
            return self.entries(&name, &cells);
        }
        let mut text = String::new();
        for (index, row) in cells.iter().enumerate() {
            let shown: Vec<String> = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
            let front = if index == 0 { format!("{name} = ") } else { " ".repeat(front) };
            text += &format!("    {front}[ {} ]\n", shown.join("   "));
        }
        text
    }
}

impl Text {
    /// `K_(1,2) = K_(2,1) = -k`: a line for each entry of a matrix that is not zero, of a symmetric one for each pair.
    fn entries(&self, name: &str, cells: &[Vec<String>]) -> String {
        let n = cells.len();
        let is_square = cells.iter().all(|row| row.len() == n);
        let is_symmetric = is_square && (0..n).all(|i| (0..i).all(|j| cells[i][j] == cells[j][i]));
        let entry = |i: usize, j: usize| format!("{name}_({},{})", i + 1, j + 1);
        let mut text = String::new();
        for (i, row) in cells.iter().enumerate() {
            let first = if is_symmetric { i } else { 0 };
            for (j, cell) in row.iter().enumerate().skip(first).filter(|(_, cell)| *cell != "0") {
                let mirrored = if is_symmetric && i != j { format!(" = {}", entry(j, i)) } else { String::new() };
                text += &break_lines(&format!("{}{mirrored} = {cell}", entry(i, j)), self.width);
            }
        }
        if cells.iter().flatten().all(|cell| cell != "0") {
            return text;
        }
        let (rows, columns) = (n, cells.first().map_or(0, Vec::len));
        let left_out = format!("{name} is {rows} by {columns}; entries that are not listed are zero.");
        text + &fill_lines(&left_out, SENTENCE, SENTENCE, self.width)
    }
}
