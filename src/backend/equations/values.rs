//! Section 6: the entries of the matrices with their values; entries of a `repeat` are written once.

use super::document::{DIGITS, Item, Section, Writer, paragraph};
use super::formula::Formula;
use super::results::MOST_MATRIX;
use crate::backend::decimal::certain_whole;
use crate::equations::Entry;
use crate::equations::names::Label;

/// If matrices are not shown as a whole, their entries are listed if a row has at most this many on average, and if at
/// most this many lines per matrix remain after folding.
const MOST_PER_ROW: usize = 8;
const MOST_LINES: usize = 24;

impl Writer<'_> {
    pub fn values(&self) -> Section {
        let mut items = self.entries().unwrap_or_default();
        items.push(paragraph(
            "Every entry of M, C, K, of the inputs and of the outputs, the natural frequencies and the transfer functions have been \
             compared with the linear system of `vibc analyze`, and the equations of motion with derivatives of the energies at \
             random states.",
        ));
        if !self.equations.carried.is_empty() {
            items.push(paragraph(format!(
                "Left out: {}. The forces of joints are no coordinates of these equations; `vibc transfer` has their numbers, and \
                 the multipliers in section 4 are what joints carry at rest.",
                self.equations.carried.join(", ")
            )));
        }
        Section { heading: "6 Values", items }
    }

    /// The entries of all matrices; `None` if there are too many to read.
    pub fn entries(&self) -> Option<Vec<Item>> {
        let linear = &self.equations.linear;
        let matrices = [("M", &linear.mass), ("C", &linear.damping), ("K", &linear.stiffness)];
        let listed = matrices.map(|(name, matrix)| self.entries_of(name, matrix));
        listed.into_iter().collect::<Option<Vec<_>>>().map(|lists| lists.into_iter().flatten().collect())
    }

    /// The upper triangle by rows, or by diagonals where entries follow one rule along them. Numbers are left out if the
    /// matrix itself is shown.
    fn entries_of(&self, name: &str, matrix: &[Vec<Entry>]) -> Option<Vec<Item>> {
        let n = matrix.len();
        let is_whole = n <= MOST_MATRIX;
        let is_listed = |&(i, j): &(usize, usize)| {
            let sum = &matrix[i][j].sum;
            let is_seen = is_whole && sum.as_number().is_some();
            !sum.is_zero() && !is_seen
        };
        let places: Vec<(usize, usize)> = (0..n).flat_map(|i| (i..n).map(move |j| (i, j))).filter(is_listed).collect();
        if !is_whole && places.len() > MOST_PER_ROW * n {
            return None;
        }
        let entry = |(i, j): (usize, usize), comma: &str| {
            let place = Formula::Name(Label::new(name, format!("{}{comma}{}", i + 1, j + 1)));
            let value = Formula::Decimal(certain_whole(&matrix[i][j].value, DIGITS));
            match matrix[i][j].sum.as_number() {
                Some(_) => place.equal(value),
                None => place.equal(self.build.sum(&matrix[i][j].sum)).equal(value),
            }
        };
        let on_diagonal = |offset: usize| places.iter().filter(move |(i, j)| j - i == offset);
        let folded: Vec<Item> = (0..n)
            .flat_map(|offset| self.rows(on_diagonal(offset).map(|place| entry(*place, ",")).collect()))
            .collect();
        if folded.len() < places.len() && folded.len() <= MOST_LINES {
            return Some(folded);
        }
        let by_rows = |place: &(usize, usize)| Item::Formula { formula: entry(*place, ""), note: Vec::new() };
        is_whole.then(|| places.iter().map(by_rows).collect())
    }
}
