//! Text tables: names aligned left, numbers at their decimal points.
//!
//! A table that is too wide for its page is narrowed by these means, the least harmful first: titles on two lines, a
//! column with the same text in each row stated once below, shorter wordings and broken lines in columns of text, and
//! finally several tables one below the other, each with the first column.

use super::super::plain;
use super::wrap::{characters, fill_lines, longest_word, wrap_lines};
use crate::answers::report::{self, Align};
use crate::base::OrderBy;
use std::fmt::Write;

/// A table of a report as text, before it is laid out; every row has as many cells as there are columns.
#[derive(Clone, Debug, Default)]
struct Table {
    columns: Vec<Column>,
    /// Each cell with one or several wordings, the longest first.
    rows: Vec<Vec<Vec<String>>>,
}

#[derive(Clone, Debug)]
struct Column {
    /// Lines of the title.
    title: Vec<String>,
    unit: String,
    align: Align,
}

/// Space between two columns.
const GAP: usize = 2;
/// Minimum width of a broken column of text.
const LEAST: usize = 16;

/// A table of a report within `width` columns, every line indented.
pub fn text(table: &report::Table, indent: usize, width: usize) -> String {
    let room = width.saturating_sub(indent);
    let whole = Table::of(table);
    let layouts = whole.layouts();
    if width_of(&layouts) <= room {
        return whole.lines(indent, &layouts);
    }
    match &table.narrower {
        Some(narrower) => text(narrower, indent, width),
        None => whole.fit_to(indent, room),
    }
}

impl Table {
    fn of(table: &report::Table) -> Table {
        let column = |column: &report::Column| Column {
            title: vec![plain::line(&column.title)],
            unit: column.unit.to_string(),
            align: column.align,
        };
        let cell = |cell: &report::Cell| match &cell.wordings[..] {
            [] => vec![String::new()],
            wordings => wordings.iter().map(plain::line).collect(),
        };
        Table {
            columns: table.columns.iter().map(column).collect(),
            rows: table.rows.iter().map(|row| row.iter().map(cell).collect()).collect(),
        }
    }

    /// The table's width in characters, without the indent.
    fn width(&self) -> usize {
        width_of(&self.layouts())
    }

    /// The table within the room, narrowed as described in the module's documentation.
    fn fit_to(mut self, indent: usize, room: usize) -> String {
        self.fold_titles(|align| align != Align::Left);
        let shown_once = if self.width() > room { self.lift_uniform() } else { Vec::new() };
        if sum(&self.least()) > room {
            self.fold_titles(|align| align == Align::Left);
        }
        let below = shown_once.iter().map(|line| fill_lines(line, indent, 2 * indent + GAP, indent + room));
        self.split(room).iter().map(|piece| piece.text_within(indent, room)).chain(below).collect()
    }

    /// Puts titles that are wider than their cells on two lines.
    fn fold_titles(&mut self, chosen: impl Fn(Align) -> bool) {
        let cells = |i: usize| self.rows.iter().map(move |row| characters(&row[i][0])).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.columns.len()).map(cells).collect();
        for (column, cells) in self.columns.iter_mut().zip(widths).filter(|(column, _)| chosen(column.align)) {
            if characters(&column.title.join(" ")) > cells.max(characters(&column.unit)) || column.align == Align::Left
            {
                column.fold_title();
            }
        }
    }

    /// Removes the columns of text that are the same in each row, and returns sentences with their content.
    fn lift_uniform(&mut self) -> Vec<String> {
        let mut lines = Vec::new();
        for at in (1..self.columns.len()).rev() {
            let column = &self.columns[at];
            let title = column.title.join(" ");
            let same = self.rows.windows(2).all(|rows| rows[0][at] == rows[1][at]);
            if column.align == Align::Left && !title.is_empty() && same && !self.rows.is_empty() {
                let text = self.rows[0][at][0].clone();
                self.columns.remove(at);
                self.rows.iter_mut().for_each(|row| drop(row.remove(at)));
                let where_ = if self.rows.len() > 1 { " in each row" } else { "" };
                lines.push(format!("{title}: {text}{where_}"));
            }
        }
        lines.reverse();
        lines
    }

    /// The minimum width of each column.
    fn least(&self) -> Vec<usize> {
        let word = |at: usize| self.rows.iter().filter_map(|row| row[at].last()).map(|cell| longest_word(cell)).max();
        let least = |(at, layout): (usize, &Layout)| match layout.align {
            Align::Left => layout.width.min(LEAST.max(layout.title).max(word(at).unwrap_or(0))),
            Align::Right | Align::Point => layout.width,
        };
        self.layouts().iter().enumerate().map(least).collect()
    }

    /// Tables that fit, each with the first column; a column that fits nowhere gets a separate table.
    fn split(&self, room: usize) -> Vec<Table> {
        let least = self.least();
        let mut pieces: Vec<Vec<usize>> = Vec::new();
        let mut used = 0;
        for at in 1..self.columns.len() {
            match pieces.last_mut() {
                Some(piece) if used + GAP + least[at] <= room => piece.push(at),
                _ => {
                    pieces.push(vec![0, at]);
                    used = least[0];
                }
            }
            used += GAP + least[at];
        }
        if pieces.len() <= 1 {
            return vec![self.clone()];
        }
        pieces.iter().map(|columns| self.select(columns)).collect()
    }

    fn select(&self, columns: &[usize]) -> Table {
        Table {
            columns: columns.iter().map(|at| self.columns[*at].clone()).collect(),
            rows: self.rows.iter().map(|row| columns.iter().map(|at| row[*at].clone()).collect()).collect(),
        }
    }

    /// Lays out the table; columns of text share the room that numbers leave.
    fn text_within(&self, indent: usize, room: usize) -> String {
        let mut layouts = self.layouts();
        let least = self.least();
        let mut spare = room.saturating_sub(sum(&least));
        let mut wanting: Vec<usize> = (0..layouts.len()).filter(|at| layouts[*at].width > least[*at]).collect();
        // The column that needs the least is served first, so that the others get what it leaves.
        wanting.order_by_key(|at| layouts[*at].width - least[*at]);
        let count = wanting.len();
        for (served, at) in wanting.into_iter().enumerate() {
            let more = (layouts[at].width - least[at]).min(spare / (count - served));
            layouts[at].width = least[at] + more;
            spare -= more;
        }
        self.lines(indent, &layouts)
    }

    /// The lines, each indented by `indent` spaces; no line ends in spaces.
    fn lines(&self, indent: usize, layouts: &[Layout]) -> String {
        let mut text = String::new();
        let mut line = |cells: Vec<String>| {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{:indent$}{}", "", cells.join(&" ".repeat(GAP)).trim_end());
        };
        let height = self.columns.iter().map(|column| column.title.len()).max().unwrap_or(0);
        for i in 0..height {
            // The last line of each title is above its unit.
            let title =
                |column: &Column| (i + column.title.len()).checked_sub(height).map(|at| column.title[at].clone());
            let titles = self.columns.iter().map(|column| title(column).unwrap_or_default());
            line(titles.zip(layouts).map(|(title, layout)| layout.title(&title)).collect());
        }
        if self.columns.iter().any(|column| !column.unit.is_empty()) {
            line(self.columns.iter().zip(layouts).map(|(column, layout)| layout.title(&column.unit)).collect());
        }
        for row in &self.rows {
            let cells: Vec<Vec<&str>> =
                row.iter().zip(layouts).map(|(cell, layout)| layout.fitting_lines(cell)).collect();
            let height = cells.iter().map(Vec::len).max().unwrap_or(0);
            for i in 0..height {
                let at = |cell: &Vec<&str>| cell.get(i).copied().unwrap_or_default().to_string();
                line(cells.iter().zip(layouts).map(|(cell, layout)| layout.cell(&at(cell))).collect());
            }
        }
        text
    }

    fn layouts(&self) -> Vec<Layout> {
        let cells = |i: usize| self.rows.iter().map(move |row| &row[i][0]);
        self.columns.iter().enumerate().map(|(i, column)| Layout::of(column, cells(i))).collect()
    }
}

/// The width of a table of such columns.
fn width_of(layouts: &[Layout]) -> usize {
    sum(&layouts.iter().map(|layout| layout.width).collect::<Vec<_>>())
}

/// The width of columns with their gaps.
fn sum(widths: &[usize]) -> usize {
    (widths.iter().sum::<usize>() + GAP * widths.len()).saturating_sub(GAP)
}

impl Column {
    /// Splits the title into two lines of similar width.
    fn fold_title(&mut self) {
        let title = self.title.join(" ");
        let halves = title.match_indices(' ').map(|(at, _)| (&title[..at], &title[at + 1..]));
        let widest = |(first, second): &(&str, &str)| characters(first).max(characters(second));
        if let Some((first, second)) = halves.min_by_key(widest) {
            self.title = vec![first.to_string(), second.to_string()];
        }
    }
}

/// The layout of a column.
struct Layout {
    align: Align,
    width: usize,
    /// Width of the title and the unit.
    title: usize,
    /// Number of characters from the decimal point on.
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
        let title = column.title.iter().chain([&column.unit]).map(|text| characters(text)).max().unwrap_or(0);
        let cells = cells.map(|cell| characters(cell)).max().unwrap_or(0);
        Layout { align: column.align, width: title.max(cells).max(whole + fraction), title, fraction }
    }

    /// The longest wording that fits; if none does, the shortest one, broken into lines.
    fn fitting_lines<'a>(&self, wordings: &'a [String]) -> Vec<&'a str> {
        match wordings.iter().find(|wording| characters(wording) <= self.width).or(wordings.last()) {
            Some(wording) if self.align == Align::Left => wrap_lines(wording, self.width),
            Some(wording) => vec![wording],
            None => Vec::new(),
        }
    }

    fn title(&self, text: &str) -> String {
        if self.align == Align::Left { self.pad_right(text) } else { self.right(text) }
    }

    fn cell(&self, text: &str) -> String {
        match self.align {
            Align::Left => self.pad_right(text),
            Align::Right => self.right(text),
            Align::Point if is_number(text) => {
                self.right(&format!("{text}{}", " ".repeat(self.fraction - at_point(text).1)))
            }
            Align::Point => self.right(text),
        }
    }

    fn pad_right(&self, text: &str) -> String {
        format!("{text}{}", " ".repeat(self.width.saturating_sub(characters(text))))
    }

    fn right(&self, text: &str) -> String {
        format!("{}{text}", " ".repeat(self.width.saturating_sub(characters(text))))
    }
}

/// Words (`rigid`) are not aligned at a decimal point.
fn is_number(cell: &str) -> bool {
    cell.contains(|c: char| c.is_ascii_digit())
}

/// Number of characters before the decimal point, and from it on.
fn at_point(cell: &str) -> (usize, usize) {
    let at = cell.find('.').unwrap_or(cell.len());
    (characters(&cell[..at]), characters(&cell[at..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(words: &[&str]) -> Vec<String> {
        words.iter().map(|word| word.to_string()).collect()
    }

    fn of_columns(columns: &[(&str, &str, Align)]) -> Table {
        let column = |(title, unit, align): &(&str, &str, Align)| Column {
            title: words(&[title]),
            unit: unit.to_string(),
            align: *align,
        };
        Table { columns: columns.iter().map(column).collect(), rows: Vec::new() }
    }

    fn table() -> Table {
        let columns = [("part", "", Align::Left), ("ω", "[rad/s]", Align::Point), ("n", "", Align::Right)];
        let rows = [["μ₁", "12.5", "1"], ["rod", "1e-7", "20"], ["", "0.1234", ""]];
        let rows = rows.map(|row| row.map(|cell| words(&[cell])).to_vec());
        Table { rows: rows.to_vec(), ..of_columns(&columns) }
    }

    #[test]
    fn decimal_points_align_and_names_keep_their_width() {
        let expected = "
part          ω   n
        [rad/s]
μ₁      12.5      1
rod   1e-7       20
         0.1234
";
        assert_eq!(table().fit_to(0, 100), expected.trim_start_matches('\n'));
        assert_eq!(table().width(), 19);
    }

    #[test]
    fn columns_that_do_not_fit_follow_below_with_the_first_one() {
        let expected = "
part          ω
        [rad/s]
μ₁      12.5
rod   1e-7
         0.1234
part   n
μ₁     1
rod   20

";
        assert_eq!(table().fit_to(0, 15), expected.trim_start_matches('\n'));
    }

    #[test]
    fn text_is_shortened_then_wrapped_and_common_notes_appear_once() {
        let mut table = of_columns(&[
            ("n", "", Align::Right),
            ("decay time", "[s]", Align::Point),
            ("what moves in it", "", Align::Left),
            ("kind", "", Align::Left),
        ]);
        let kind = words(&["oscillation"]);
        table.rows.push(vec![words(&["1"]), words(&["0.5"]), words(&["one 50 %, two 50 %", "one 50 %"]), kind.clone()]);
        table.rows.push(vec![words(&["2"]), words(&["10"]), words(&["a sentence of some words"]), kind]);
        let expected = "
   decay
n   time  what moves in it
     [s]
1    0.5  one 50 %
2   10    a sentence of
          some words
kind: oscillation in each
  row
";
        assert_eq!(table.fit_to(0, 26), expected.trim_start_matches('\n'));
    }
}
