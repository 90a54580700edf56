//! Columns of text: names to the left, numbers aligned at their decimal points.

use std::fmt::Write;

/// A table under construction; every row has as many cells as there are columns.
#[derive(Debug)]
pub struct Table {
    columns: Vec<Column>,
    rows: Vec<Vec<String>>,
}

#[derive(Debug)]
struct Column {
    title: String,
    unit: String,
    align: Align,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    Left,
    Right,
    /// At the decimal point.
    Point,
}

/// Space between two columns.
const GAP: usize = 2;

impl Table {
    pub fn new() -> Table {
        Table { columns: Vec::new(), rows: Vec::new() }
    }

    /// A column with its title and, in a line below, its unit.
    pub fn column(mut self, title: impl Into<String>, unit: impl Into<String>, align: Align) -> Table {
        self.columns.push(Column { title: title.into(), unit: unit.into(), align });
        self
    }

    pub fn row(&mut self, cells: Vec<String>) {
        self.rows.push(cells);
    }

    /// The table's width in characters, the indent not counted.
    pub fn width(&self) -> usize {
        self.layouts().iter().map(|layout| layout.width + GAP).sum::<usize>().saturating_sub(GAP)
    }

    /// Every line indented by so many spaces; no line ends in spaces.
    pub fn text(&self, indent: usize) -> String {
        let layouts = self.layouts();
        let mut text = String::new();
        let mut line = |cells: &mut dyn Iterator<Item = String>| {
            let line: Vec<String> = cells.collect();
            let line = line.join(&" ".repeat(GAP));
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{:indent$}{}", "", line.trim_end());
        };
        line(&mut self.columns.iter().zip(&layouts).map(|(column, layout)| layout.title(&column.title)));
        if self.columns.iter().any(|column| !column.unit.is_empty()) {
            line(&mut self.columns.iter().zip(&layouts).map(|(column, layout)| layout.title(&column.unit)));
        }
        for row in &self.rows {
            line(&mut row.iter().zip(&layouts).map(|(cell, layout)| layout.cell(cell)));
        }
        text
    }

    fn layouts(&self) -> Vec<Layout> {
        self.columns
            .iter()
            .enumerate()
            .map(|(i, column)| Layout::of(column, self.rows.iter().map(|row| &row[i])))
            .collect()
    }
}

/// The measures of a column.
struct Layout {
    align: Align,
    width: usize,
    /// Characters from the decimal point on.
    fraction: usize,
}

impl Layout {
    fn of<'a>(column: &Column, cells: impl Iterator<Item = &'a String> + Clone) -> Layout {
        let (whole, fraction) = match column.align {
            Align::Point => {
                let numbers = || cells.clone().filter(|cell| is_number(cell)).map(|cell| at_point(cell));
                (numbers().map(|parts| parts.0).max().unwrap_or(0), numbers().map(|parts| parts.1).max().unwrap_or(0))
            }
            _ => (0, 0),
        };
        let titles = characters(&column.title).max(characters(&column.unit));
        let cells = cells.map(|cell| characters(cell)).max().unwrap_or(0);
        Layout { align: column.align, width: titles.max(cells).max(whole + fraction), fraction }
    }

    fn title(&self, text: &str) -> String {
        if self.align == Align::Left { self.left(text) } else { self.right(text) }
    }

    fn cell(&self, text: &str) -> String {
        match self.align {
            Align::Left => self.left(text),
            Align::Right => self.right(text),
            Align::Point if is_number(text) => {
                self.right(&format!("{text}{}", " ".repeat(self.fraction - at_point(text).1)))
            }
            Align::Point => self.right(text),
        }
    }

    fn left(&self, text: &str) -> String {
        format!("{text}{}", " ".repeat(self.width - characters(text)))
    }

    fn right(&self, text: &str) -> String {
        format!("{}{text}", " ".repeat(self.width.saturating_sub(characters(text))))
    }
}

/// Words (`rigid`) have no decimal point to stand at.
fn is_number(cell: &str) -> bool {
    cell.contains(|c: char| c.is_ascii_digit())
}

/// Characters before the decimal point, and from it on.
fn at_point(cell: &str) -> (usize, usize) {
    let at = cell.find('.').unwrap_or(cell.len());
    (characters(&cell[..at]), characters(&cell[at..]))
}

/// Names hold letters that are one column wide each: Latin, Greek, digits.
pub fn characters(text: &str) -> usize {
    text.chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_stand_below_each_other_and_names_keep_their_width() {
        let mut table = Table::new().column("part", "", Align::Left).column("ω", "[rad/s]", Align::Point).column(
            "n",
            "",
            Align::Right,
        );
        table.row(vec!["μ₁".into(), "12.5".into(), "1".into()]);
        table.row(vec!["rod".into(), "1e-7".into(), "20".into()]);
        table.row(vec!["".into(), "0.1234".into(), "".into()]);
        let expected = "
part          ω   n
        [rad/s]
μ₁      12.5      1
rod   1e-7       20
         0.1234
";
        assert_eq!(table.text(0), expected.trim_start_matches('\n'));
        assert_eq!(table.width(), 19);
    }
}
