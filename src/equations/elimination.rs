//! Linear equations whose entries are sums: Gauss's elimination, with pivots that are certainly not zero at the values of their names.

use super::names::Names;
use crate::symbols::Sum;

/// Left sides with right sides.
pub type Rows = Vec<(Vec<Sum>, Vec<Sum>)>;

/// Solves rows of (left, right) for the given number of unknowns; dependent rows are ignored, undetermined unknowns are zero.
pub fn solve(mut rows: Rows, unknowns: usize, names: &Names) -> Option<Vec<Vec<Sum>>> {
    let mut done: Rows = Vec::new();
    let mut pivots: Vec<usize> = Vec::new();
    for _ in 0..unknowns {
        let (row, column) = pivot(&rows, names)?;
        let (left, right) = rows.swap_remove(row);
        let inverse = left[column].inverse()?;
        let scaled =
            |entries: Vec<Sum>| entries.iter().map(|entry| (entry * &inverse).simplified()).collect::<Vec<Sum>>();
        let (left, right) = (scaled(left), scaled(right));
        for (other, values) in rows.iter_mut().chain(&mut done) {
            let factor = other[column].clone();
            if factor.is_zero() {
                continue;
            }
            for (entry, own) in other.iter_mut().zip(&left).chain(values.iter_mut().zip(&right)) {
                *entry = (&*entry - &(&factor * own)).simplified();
            }
        }
        done.push((left, right));
        pivots.push(column);
    }
    let mut solved = vec![Vec::new(); done.first().map_or(0, |(left, _)| left.len())];
    for ((_, right), column) in done.into_iter().zip(pivots) {
        solved[column] = right;
    }
    Some(solved)
}

/// The simplest entry that is certainly not zero.
fn pivot(rows: &Rows, names: &Names) -> Option<(usize, usize)> {
    let mut best: Option<(usize, (usize, usize))> = None;
    for (row, (left, _)) in rows.iter().enumerate() {
        for (column, entry) in left.iter().enumerate() {
            let usable = names.value_of(entry).is_some_and(|value| !value.may_be_zero());
            let size = if entry.as_number().is_some() { 0 } else { entry.terms().len() };
            if usable && best.is_none_or(|(least, _)| size < least) {
                best = Some((size, (row, column)));
            }
        }
    }
    best.map(|(_, place)| place)
}
