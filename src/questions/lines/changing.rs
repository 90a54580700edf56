//! What changes of the matrices of a system while a parameter takes all values of a range, if no row does.

use crate::base::{Ball, Number};
use crate::questions::updates::{Changing, Part};
use crate::system::{Form, LinearSystem, Row};

/// The squares of these matrices whose weights change, if all rows are the same everywhere. `over` holds over the range, `base` at one of
/// its ends.
pub fn changing(over: &LinearSystem, base: &LinearSystem, parts: &[Part]) -> Option<Vec<Changing>> {
    let mut list: Vec<(Row, Changing)> = Vec::new();
    for &part in parts {
        let (over, base) = (part.form(over), part.form(base));
        for (row, slope) in moving(over, base)? {
            match list.iter_mut().find(|(other, of)| of.part == part && *other == row) {
                Some((_, of)) => of.slope = of.slope + slope,
                None => {
                    let entries = row.iter().map(|(at, a)| (at.index(), a.to_ball())).collect();
                    let known = list.iter().find(|(other, _)| are_alike(*other, row));
                    let number = known.map_or(list.len(), |(_, of)| of.number);
                    list.push((row, Changing { part, row: entries, number, slope }));
                }
            }
        }
    }
    Some(list.into_iter().map(|(_, changing)| changing).collect())
}

/// Whether two rows have the same square.
fn are_alike(a: Row, b: Row) -> bool {
    let both = || a.iter().zip(b);
    let has_places = a.len() == b.len() && both().all(|((i, _), (j, _))| i == j);
    has_places && (a == b || both().all(|((_, a), (_, b))| *a == -b))
}

/// The rows whose weights change, with the derivatives of these; `None` if a row changes.
fn moving<'a>(over: &'a Form, base: &Form) -> Option<Vec<(Row<'a>, Ball)>> {
    if over.terms().len() != base.terms().len() {
        return None;
    }
    let mut list = Vec::new();
    for (term, other) in over.terms().zip(base.terms()) {
        let row = over.row(term);
        let is_fixed = row.iter().all(|(_, entry)| !matches!(entry, Number::Jet(_)));
        if !is_fixed || row != base.row(other) {
            return None;
        }
        match term.weight {
            Number::Jet(jet) => list.push((row, jet.slope)),
            weight if weight == other.weight => {}
            _ => return None,
        }
    }
    Some(list)
}

/// The derivative of the matrix of a form, if its rows are the same everywhere and only weights change. `over` holds over the range,
/// `centred` in its middle.
pub fn slopes(over: &Form, centred: &Form, n: usize) -> Option<Vec<Vec<Ball>>> {
    let mut matrix = vec![vec![Ball::ZERO; n]; n];
    for (row, slope) in moving(over, centred)? {
        for (i, a) in row {
            for (j, b) in row {
                let entry = &mut matrix[i.index()][j.index()];
                *entry = *entry + slope * a.to_ball() * b.to_ball();
            }
        }
    }
    Some(matrix)
}
