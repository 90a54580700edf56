//! Linear equations whose entries are sums: Gaussian elimination, with pivots that are certainly not zero at the values
//! of their names.

use super::names::Names;
use crate::symbols::{Factor, Product, Sum};

/// Left sides with right sides.
pub type Rows = Vec<(Vec<Sum>, Vec<Sum>)>;

/// Maximum number of terms of all rows together. They grow faster than any power of the unknowns, and a longer solution
/// is unreadable.
pub const MOST_TERMS: usize = 20_000;

/// Terms of one product before it is simplified.
const MOST_PRODUCTS: usize = 100_000;

/// Why rows are not solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsolved {
    /// No entry is certainly not zero, or its inverse has no form.
    NoPivot,
    /// The rows have this many terms.
    Long { terms: usize },
}

/// Solves rows of (left, right) for the given number of unknowns; dependent rows are ignored, undetermined unknowns are zero.
pub fn solve(mut rows: Rows, unknowns: usize, names: &Names) -> Result<Vec<Vec<Sum>>, Unsolved> {
    let mut done: Rows = Vec::new();
    let mut pivots: Vec<usize> = Vec::new();
    for _ in 0..unknowns {
        let (row, column) = pivot(&rows, names).ok_or(Unsolved::NoPivot)?;
        let (left, right) = rows.swap_remove(row);
        let inverse = left[column].inverse().ok_or(Unsolved::NoPivot)?;
        let scaled =
            |entries: Vec<Sum>| entries.iter().map(|entry| (entry * &inverse).simplify()).collect::<Vec<Sum>>();
        let (left, right) = (scaled(left), scaled(right));
        for (other, values) in rows.iter_mut().chain(&mut done) {
            let factor = other[column].clone();
            if factor.is_zero() {
                continue;
            }
            for (entry, own) in other.iter_mut().zip(&left).chain(values.iter_mut().zip(&right)) {
                // The number of terms, before they are multiplied out.
                let terms = size(&factor) * size(own);
                if terms > MOST_PRODUCTS {
                    return Err(Unsolved::Long { terms });
                }
                *entry = (&*entry - &(&factor * own)).simplify();
            }
        }
        done.push((left, right));
        pivots.push(column);
        let terms: usize = rows.iter().chain(&done).flat_map(|(left, right)| left.iter().chain(right)).map(size).sum();
        if terms > MOST_TERMS {
            return Err(Unsolved::Long { terms });
        }
    }
    let mut solved = vec![Vec::new(); done.first().map_or(0, |(left, _)| left.len())];
    for ((_, right), column) in done.into_iter().zip(pivots) {
        solved[column] = right;
    }
    Ok(solved)
}

/// Terms of a sum and of the sums that it divides by.
fn size(sum: &Sum) -> usize {
    let inside = |(factor, _): &(Factor, i32)| match factor {
        Factor::Whole(inner) | Factor::Root(inner) => size(inner),
        _ => 0,
    };
    let of_product = |product: &Product| 1 + product.factors().iter().map(inside).sum::<usize>();
    sum.terms().iter().map(|(product, _)| of_product(product)).sum()
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
