//! Polynomials with enclosed coefficients, the constant first, and determinants of small matrices of them.

use crate::base::Number;

/// Coefficients by ascending powers.
pub type Polynomial = Vec<Number>;

pub fn sum(a: &[Number], b: &[Number]) -> Polynomial {
    let at = |of: &[Number], power: usize| of.get(power).cloned().unwrap_or(Number::ZERO);
    (0..a.len().max(b.len())).map(|power| &at(a, power) + &at(b, power)).collect()
}

pub fn product(a: &[Number], b: &[Number]) -> Polynomial {
    let mut product = vec![Number::ZERO; (a.len() + b.len()).saturating_sub(1)];
    for (i, first) in a.iter().enumerate().filter(|(_, number)| !number.is_zero()) {
        for (j, second) in b.iter().enumerate() {
            product[i + j] = &product[i + j] + &(first * second);
        }
    }
    product
}

pub fn value(of: &[Number], at: &Number) -> Number {
    of.iter().rev().fold(Number::ZERO, |sum, coefficient| &(&sum * at) + coefficient)
}

/// Rows of a matrix at most.
const MOST_ROWS: usize = 10;

/// Row by row over the subsets of columns: n 2^n products. `None` for a matrix of more than ten rows.
pub fn determinant(matrix: &[Vec<Polynomial>]) -> Option<Polynomial> {
    let n = matrix.len();
    if n > MOST_ROWS {
        return None;
    }
    let mut minors: Vec<Polynomial> = vec![Vec::new(); 1 << n];
    minors[0] = vec![Number::ONE];
    for columns in 1usize..1 << n {
        let row = columns.count_ones() as usize - 1;
        let mut sum = Vec::new();
        for column in (0..n).filter(|column| columns & (1 << column) != 0) {
            // The number of columns after this one determines the sign.
            let behind = (columns >> (column + 1)).count_ones();
            let term = product(&matrix[row][column], &minors[columns & !(1 << column)]);
            let term = if behind % 2 == 0 { term } else { term.iter().map(|number| -number).collect() };
            sum = self::sum(&sum, &term);
        }
        minors[columns] = sum;
    }
    minors.pop()
}
