//! What follows a base statically, in symbols: K r = b. In most scenes it is a motion carried along, of zeros and ones. In: the
//! stiffness matrix, the column of the base. Out: r, or nothing where it has no short form or is not determined.

use super::Entry;
use super::elimination::{self, Rows};
use super::names::Names;
use crate::base::Ball;
use crate::symbols::Sum;

/// r with K r = b, if K is certainly regular at the values of its names.
pub fn follows(stiffness: &[Vec<Entry>], pushed: &[Sum], names: &Names) -> Option<Vec<Sum>> {
    let places = reachable(stiffness, pushed);
    if !is_regular(stiffness, &places) {
        return None;
    }
    let mut all = vec![Sum::ZERO; pushed.len()];
    places.iter().for_each(|&i| all[i] = Sum::fraction(1, 1));
    if is_solution(stiffness, pushed, &all) {
        return Some(all);
    }
    let row = |&i: &usize| {
        let left = places.iter().map(|&j| stiffness[i][j].sum.clone()).collect();
        (left, vec![pushed[i].clone()])
    };
    let rows: Rows = places.iter().map(row).collect();
    let found = elimination::solve(rows, places.len(), names).ok()?;
    for (&i, mut value) in places.iter().zip(found) {
        all[i] = value.pop()?;
    }
    Some(all)
}

/// The coordinates that springs tie to those that are pushed, ascending.
fn reachable(stiffness: &[Vec<Entry>], pushed: &[Sum]) -> Vec<usize> {
    let mut is_in: Vec<bool> = pushed.iter().map(|entry| !entry.is_zero()).collect();
    let mut next: Vec<usize> = (0..pushed.len()).filter(|&i| is_in[i]).collect();
    while let Some(i) = next.pop() {
        for j in 0..pushed.len() {
            if !is_in[j] && !stiffness[i][j].sum.is_zero() {
                is_in[j] = true;
                next.push(j);
            }
        }
    }
    (0..pushed.len()).filter(|&i| is_in[i]).collect()
}

fn is_solution(stiffness: &[Vec<Entry>], pushed: &[Sum], r: &[Sum]) -> bool {
    stiffness.iter().zip(pushed).all(|(row, pushed)| {
        let force = row.iter().zip(r).fold(Sum::ZERO, |sum, (entry, r)| &sum + &(&entry.sum * r));
        (&force - pushed).simplify().is_zero()
    })
}

/// Whether elimination finds a pivot that is certainly not zero in every column.
fn is_regular(stiffness: &[Vec<Entry>], places: &[usize]) -> bool {
    let mut rows: Vec<Vec<Ball>> =
        places.iter().map(|&i| places.iter().map(|&j| stiffness[i][j].value.to_ball()).collect()).collect();
    for column in 0..places.len() {
        let size = |row: &Vec<Ball>| row[column].mignitude();
        let best = (column..rows.len()).max_by(|&a, &b| size(&rows[a]).total_cmp(&size(&rows[b])));
        let Some(best) = best.filter(|&best| size(&rows[best]) > 0.0) else { return false };
        rows.swap(column, best);
        let (done, rest) = rows.split_at_mut(column + 1);
        let pivot = &done[column];
        for row in rest.iter_mut().filter(|row| !row[column].is_zero()) {
            let factor = row[column] / pivot[column];
            row.iter_mut().zip(pivot).skip(column).for_each(|(x, p)| *x = *x - factor * *p);
        }
    }
    true
}
