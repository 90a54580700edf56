//! The coordinates and, where they fit, the matrices.

use super::super::ReportOptions;
use super::super::decimal::certain_whole;
use super::table::characters;
use super::{INDENT, WIDTH, line, unit};
use crate::answers::ModalAnswer;
use crate::base::Number;
use crate::lower::Dependent;
use crate::system::{Form, LinearSystem};

/// Matrices of more coordinates are shown on demand only.
const MOST: usize = 8;
const DIGITS: usize = 5;

pub fn text(answer: &ModalAnswer, options: &ReportOptions) -> String {
    let system = &answer.system;
    let mut text = coordinates(system) + &dependent(answer);
    if system.n() > 0 && (options.matrices || system.n() <= MOST) {
        let system = &system.clone().flattened(u64::MAX).expect("as many entries as there may be");
        text += &line("M q″ + C q′ + K q = 0, in kg, m, s, rad");
        text += &side_by_side(&[("M", &system.m), ("C", &system.c), ("K", &system.k)], system.n());
    }
    text
}

/// `q = (block.x [m], rod.angle [rad])`, broken into lines; the first and the last of many.
fn coordinates(system: &LinearSystem) -> String {
    const ENDS: usize = 6;
    let name =
        |i: usize| format!("{} [{}]", system.display(system.coordinates[i].name), unit(system.coordinates[i].kind));
    let n = system.n();
    let names: Vec<String> = if n <= 2 * ENDS {
        (0..n).map(name).collect()
    } else {
        let dots = std::iter::once(format!("... {} more", n - 2 * ENDS));
        (0..ENDS).map(name).chain(dots).chain((n - ENDS..n).map(name)).collect()
    };
    let mut text = String::new();
    let mut current = "q = (".to_string();
    for (i, name) in names.iter().enumerate() {
        let end = if i + 1 == names.len() { ")" } else { "," };
        if i > 0 && characters(&current) + characters(name) + 2 > WIDTH - INDENT {
            text += &line(current.trim_end());
            current = "     ".to_string();
        }
        current += &format!("{name}{end} ");
    }
    if names.is_empty() { line("q = (): nothing can move") } else { text + &line(current.trim_end()) }
}

/// The coordinates that closed loops and couplings leave no choice.
fn dependent(answer: &ModalAnswer) -> String {
    const MOST: usize = 8;
    let dependent = &answer.rest.dependent;
    let name = |dependent: &Dependent| answer.system.display(dependent.coordinate.name);
    let mut names: Vec<String> = dependent.iter().take(MOST).map(name).collect();
    if dependent.len() > MOST {
        names.push(format!("{} more", dependent.len() - MOST));
    }
    if names.is_empty() {
        String::new()
    } else {
        line(format!("following from q by joints and couplings: {}", names.join(", ")))
    }
}

/// Beside each other as far as they fit.
fn side_by_side(forms: &[(&str, &Form)], n: usize) -> String {
    let blocks: Vec<Vec<String>> = forms.iter().map(|(name, form)| block(name, &form.entries(n))).collect();
    let width = |block: &Vec<String>| block.first().map_or(0, |line| characters(line));
    let mut text = String::new();
    let mut group: Vec<&Vec<String>> = Vec::new();
    for block in &blocks {
        let used: usize = group.iter().map(|block| width(block) + 3).sum();
        if !group.is_empty() && used + width(block) > WIDTH - INDENT {
            text += &joined(&group);
            group.clear();
        }
        group.push(block);
    }
    text + &joined(&group)
}

fn joined(group: &[&Vec<String>]) -> String {
    let rows = group.iter().map(|block| block.len()).max().unwrap_or(0);
    (0..rows).map(|row| line(group.iter().map(|block| block[row].as_str()).collect::<Vec<_>>().join("   "))).collect()
}

/// `M = ⎡ 1.5  0.5 ⎤` in as many lines as rows, all of one width.
fn block(name: &str, matrix: &[Vec<Number>]) -> Vec<String> {
    let cells: Vec<Vec<String>> =
        matrix.iter().map(|row| row.iter().map(|entry| certain_whole(entry, DIGITS)).collect()).collect();
    let n = cells.len();
    let widths: Vec<usize> = (0..n).map(|j| cells.iter().map(|row| characters(&row[j])).max().unwrap_or(0)).collect();
    let middle = (n - 1) / 2;
    (0..n)
        .map(|i| {
            let lead = if i == middle { format!("{name} = ") } else { " ".repeat(characters(name) + 3) };
            let entries: Vec<String> =
                cells[i].iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}")).collect();
            let (left, right) = brackets(i, n);
            format!("{lead}{left} {} {right}", entries.join("  "))
        })
        .collect()
}

fn brackets(row: usize, rows: usize) -> (char, char) {
    match row {
        _ if rows == 1 => ('[', ']'),
        0 => ('⎡', '⎤'),
        _ if row + 1 == rows => ('⎣', '⎦'),
        _ => ('⎢', '⎥'),
    }
}
