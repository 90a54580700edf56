//! The numerator of a transfer function in symbols, for cases in which its numbers do not show which coefficients are
//! zero: those that cancel for all values, as for a force that cannot stretch the spring in question.

use super::Equations;
use super::closed::{self, Part};
use super::linear::Column;
use super::transfer::Output;
use crate::symbols::Sum;

/// Rows of the determinant, and products of terms that it is summed from.
const MOST_ROWS: usize = 10;
const MOST_PRODUCTS: usize = 40_000;

/// p adj(Z) b + d det(Z) by powers of s: the determinant of Z with b as an additional column and -p as an additional
/// row. `None` if it is too long.
pub fn numerator(equations: &Equations, part: &Part, column: &Column, output: &Output) -> Option<Vec<Sum>> {
    let places = &part.places;
    let mut matrix: Vec<Vec<Vec<Sum>>> = Vec::new();
    for &i in places {
        let mut row: Vec<Vec<Sum>> = places.iter().map(|&j| closed::entry(equations, i, j)).collect();
        row.push(column.parts.iter().map(|entries| entries[i].clone()).collect());
        matrix.push(row);
    }
    let mut last: Vec<Vec<Sum>> = places.iter().map(|&j| output.rows.iter().map(|row| -&row[j]).collect()).collect();
    let own = |direct: &Vec<(usize, Sum)>| {
        let of_input = direct.iter().filter(|(input, _)| *input == column.input);
        of_input.fold(Sum::ZERO, |sum, (_, entry)| &sum + entry)
    };
    last.push(output.direct.iter().map(own).collect());
    matrix.push(last);
    determinant(&matrix)
}

/// Row by row over the subsets of columns.
fn determinant(matrix: &[Vec<Vec<Sum>>]) -> Option<Vec<Sum>> {
    let n = matrix.len();
    if n > MOST_ROWS {
        return None;
    }
    let mut products = 0;
    let mut minors: Vec<Vec<Sum>> = vec![Vec::new(); 1 << n];
    minors[0] = vec![Sum::one()];
    for columns in 1usize..1 << n {
        let row = columns.count_ones() as usize - 1;
        let mut sum = Vec::new();
        for column in (0..n).filter(|column| columns & (1 << column) != 0) {
            let (entry, minor) = (&matrix[row][column], &minors[columns & !(1 << column)]);
            let count = |sums: &[Sum]| sums.iter().map(|sum| sum.terms().len()).sum::<usize>();
            products += count(entry) * count(minor);
            if products > MOST_PRODUCTS {
                return None;
            }
            // The number of columns after this one determines the sign.
            let is_odd = (columns >> (column + 1)).count_ones() % 2 == 1;
            let term = closed::product(entry, minor);
            add(&mut sum, if is_odd { term.iter().map(|sum| -sum).collect() } else { term });
        }
        minors[columns] = sum;
    }
    minors.pop()
}

fn add(to: &mut Vec<Sum>, other: Vec<Sum>) {
    if to.len() < other.len() {
        to.resize(other.len(), Sum::ZERO);
    }
    for (own, other) in to.iter_mut().zip(other) {
        *own = &*own + &other;
    }
}
