//! Tables of a report.

use super::{Figure, Line, Named};

/// A table; every row has as many cells as there are columns. The first column names the rows.
#[derive(Clone, Debug, Default)]
pub struct Table {
    pub columns: Vec<Column>,
    pub rows: Vec<Vec<Cell>>,
    /// A table with the same content in fewer columns, in case these do not fit.
    pub narrower: Option<Box<Table>>,
}

#[derive(Clone, Debug)]
pub struct Column {
    pub title: Line,
    /// Shown in brackets below the title, or after it; may be empty.
    pub unit: &'static str,
    pub align: Align,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    Left,
    Right,
    /// Numbers aligned at the decimal point.
    Point,
}

/// The content of a cell, in one or more wordings, the longest first: a layout takes the first that fits.
#[derive(Clone, Debug, Default)]
pub struct Cell {
    pub wordings: Vec<Line>,
}

impl Table {
    pub(super) fn new() -> Table {
        Table::default()
    }

    /// A table with columns of these titles and without units.
    pub(super) fn of<const N: usize>(columns: [(&'static str, Align); N]) -> Table {
        columns.into_iter().fold(Table::new(), |table, (title, align)| table.column(title, "", align))
    }

    pub(super) fn column(mut self, title: impl Into<Line>, unit: &'static str, align: Align) -> Table {
        self.columns.push(Column { title: title.into(), unit, align });
        self
    }

    pub(super) fn row(&mut self, cells: Vec<Cell>) {
        self.rows.push(cells);
    }

    /// Marks all bounds in the table as unknown.
    pub(super) fn forget_bounds(&mut self) {
        let cells = self.rows.iter_mut().flatten();
        cells.flat_map(|cell| &mut cell.wordings).for_each(Line::forget_bounds);
        if let Some(narrower) = &mut self.narrower {
            narrower.forget_bounds();
        }
    }
}

impl Cell {
    /// A cell with several wordings, the longest first.
    pub(super) fn wordings(wordings: impl IntoIterator<Item = Line>) -> Cell {
        Cell { wordings: wordings.into_iter().collect() }
    }

    /// The most complete wording.
    pub fn longest(&self) -> Line {
        self.wordings.first().cloned().unwrap_or_default()
    }
}

impl From<Line> for Cell {
    fn from(line: Line) -> Cell {
        Cell { wordings: vec![line] }
    }
}

impl From<&'static str> for Cell {
    fn from(words: &'static str) -> Cell {
        Line::from(words).into()
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Cell {
        Line::from(text).into()
    }
}

impl From<Named> for Cell {
    fn from(named: Named) -> Cell {
        Line::from(named).into()
    }
}

impl From<Figure> for Cell {
    fn from(figure: Figure) -> Cell {
        Line::from(figure).into()
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Cell {
        Line::from(count).into()
    }
}

/// `None` gives an empty cell.
impl From<Option<Figure>> for Cell {
    fn from(figure: Option<Figure>) -> Cell {
        figure.map_or_else(Cell::default, Cell::from)
    }
}
