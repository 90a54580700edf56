//! The positions of the columns of a group, and the folds of a row that gets too long.

use super::families::Families;
use crate::picture::geometry::Point;

/// A row that is not longer than this does not turn, px: to the right, and upwards.
const LONGEST: [f64; 2] = [620.0, 560.0];

pub struct Folds {
    /// For each column, its row, and its position along the row.
    rows: Vec<usize>,
    along: Vec<f64>,
    /// For each row, the offset that is added to the heights in it.
    shifts: Vec<f64>,
}

impl Folds {
    pub fn of(families: &Families, upright: bool) -> Folds {
        let columns = families.columns();
        // Long ropes are folded into something square.
        let whole: f64 = (1..columns).map(|column| families.step(column)).sum();
        let square = (whole * (families.row_gap() + 40.0)).sqrt();
        let rows = rows(families, square.max(LONGEST[usize::from(upright)]));
        let mut along: Vec<f64> = vec![0.0; columns];
        for column in 1..columns {
            let way = if rows[column].is_multiple_of(2) { 1.0 } else { -1.0 };
            along[column] = if rows[column] == rows[column - 1] {
                along[column - 1] + way * families.step(column)
            } else {
                // The fold: straight below the last one.
                along[column - 1]
            };
        }
        let count = rows.last().map_or(0, |row| row + 1);
        let mut extents = vec![[f64::INFINITY, f64::NEG_INFINITY]; count];
        for member in 0..families.members.len() {
            let (at, half) = (families.height(member), families.half_across(member));
            let extent = &mut extents[rows[families.column[member]]];
            *extent = [extent[0].min(at - half), extent[1].max(at + half)];
        }
        let mut shifts: Vec<f64> = vec![0.0; count];
        for row in 1..count {
            shifts[row] = shifts[row - 1] + extents[row - 1][1] - extents[row][0] + families.row_gap();
        }
        Folds { rows, along, shifts }
    }

    pub fn row(&self, column: usize) -> usize {
        self.rows[column]
    }

    /// Whether a column is the first of the whole group.
    pub fn starts(&self, column: usize) -> bool {
        column == 0
    }

    pub fn direction_of(&self, column: usize) -> f64 {
        if self.rows[column].is_multiple_of(2) { 1.0 } else { -1.0 }
    }

    pub fn at(&self, families: &Families, member: usize) -> Point {
        let column = families.column[member];
        Point::new(self.along[column], families.height(member) + self.shifts[self.rows[column]])
    }
}

/// The row of each column. A new row begins after a full one, where a single element leads on.
fn rows(families: &Families, longest: f64) -> Vec<usize> {
    let columns = families.columns();
    let thin = thin(families);
    let mut rows = vec![0; columns];
    let (mut row, mut length) = (0, 0.0);
    for column in 1..columns {
        length += families.step(column);
        if length > longest && thin[column] {
            row += 1;
            length = 0.0;
        }
        rows[column] = row;
    }
    rows
}

/// For each column, whether it and the column before have a single member each, and no element passes over it.
fn thin(families: &Families) -> Vec<bool> {
    let mut members = vec![0usize; families.columns()];
    let mut long = vec![false; families.columns()];
    for (member, column) in families.column.iter().enumerate() {
        members[*column] += 1;
        if let Some(parent) = families.parent[member]
            && families.column[parent] + 1 < *column
        {
            long[families.column[parent] + 1..=*column].fill(true);
        }
    }
    (0..families.columns()).map(|c| c > 0 && members[c] == 1 && members[c - 1] == 1 && !long[c]).collect()
}
