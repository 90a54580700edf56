//! Factorisation A = L D L^T of a sparse symmetric matrix in binary64, with columns ordered for little fill. In: entries
//! of one triangle. Out: the factors, or the pivot that was not positive. It only steers: results are refined with exact
//! residuals.
//!
//! Up-looking factorisation along the [elimination tree](super::tree). The order is that of approximate minimum degree.

use crate::kernel::sparse::order::least_fill;
use crate::kernel::sparse::tree::EliminationTree;

/// A symmetric matrix: the upper triangle by columns, rows ascending, in the order of elimination.
#[derive(Clone, Debug)]
pub struct Symmetric {
    pub(super) n: usize,
    /// Position of each row in the order of elimination.
    pub(super) place: Vec<u32>,
    pub(super) starts: Vec<usize>,
    pub(super) rows: Vec<u32>,
    pub(super) values: Vec<f64>,
    /// For each given entry, its index in `values`.
    pub(super) slots: Vec<u32>,
    pub(super) tree: EliminationTree,
}

/// The factors of a matrix.
#[derive(Clone, Debug)]
pub struct Factors {
    place: Vec<u32>,
    starts: Vec<usize>,
    rows: Vec<u32>,
    values: Vec<f64>,
    pivots: Vec<f64>,
}

/// A failed factorisation: the row of the pivot that is not positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotPositive {
    pub row: usize,
}

impl Symmetric {
    /// The pattern of a matrix of n rows with entries at these places, in either triangle; a place may be given more than
    /// once.
    pub fn pattern(n: usize, entries: &[(u32, u32)]) -> Symmetric {
        let place = order(n, entries);
        let mut keys: Vec<(u32, u32, u32)> = Vec::with_capacity(entries.len() + n);
        for (slot, (i, j)) in entries.iter().enumerate() {
            let (a, b) = (place[*i as usize], place[*j as usize]);
            keys.push((a.max(b), a.min(b), slot as u32));
        }
        // The diagonal is always stored, since shifts are added to it.
        keys.extend((0..n as u32).map(|i| (i, i, u32::MAX)));
        keys.sort_unstable();
        let (mut starts, mut rows, mut slots) = (vec![0; n + 1], Vec::new(), vec![0; entries.len()]);
        let mut last = None;
        for (column, row, slot) in keys {
            if last != Some((column, row)) {
                last = Some((column, row));
                rows.push(row);
                starts[column as usize + 1] = rows.len();
            }
            if slot != u32::MAX {
                slots[slot as usize] = (rows.len() - 1) as u32;
            }
        }
        let column = |k: usize| rows[starts[k]..starts[k + 1]].iter().copied();
        let tree = EliminationTree::of(n, column, usize::MAX).expect("any number of entries is allowed");
        let values = vec![0.0; rows.len()];
        Symmetric { n, place, starts, rows, values, slots, tree }
    }

    /// Sets the values of the entries, in the order in which they were given to `pattern`; values at the same place are
    /// added up.
    pub fn fill(&mut self, values: impl IntoIterator<Item = f64>) {
        self.values.fill(0.0);
        for (slot, value) in self.slots.iter().zip(values) {
            self.values[*slot as usize] += value;
        }
    }

    /// The diagonal, by rows as given.
    pub fn diagonal(&self) -> Vec<f64> {
        self.place.iter().map(|&place| self.values[self.starts[place as usize + 1] - 1]).collect()
    }

    /// Factors A + diag(shift). Stops at a pivot that is not greater than `least` times the sum of the magnitudes of its
    /// diagonal entry and of all that is subtracted from it.
    pub fn factor(&self, shift: impl Fn(usize) -> f64, least: f64) -> Result<Factors, NotPositive> {
        let n = self.n;
        let mut row_of = vec![0usize; n];
        for (row, place) in self.place.iter().enumerate() {
            row_of[*place as usize] = row;
        }
        let starts = self.tree.starts().to_vec();
        let mut factors = Factors {
            place: self.place.clone(),
            rows: vec![0; starts[n]],
            values: vec![0.0; starts[n]],
            pivots: vec![0.0; n],
            starts: starts.clone(),
        };
        let mut filled = starts;
        let mut y = vec![0.0; n];
        let mut walk = self.tree.walk();
        for k in 0..n {
            let column = self.starts[k]..self.starts[k + 1];
            for at in column.clone() {
                y[self.rows[at] as usize] += self.values[at];
            }
            let mut pivot = shift(row_of[k]) + std::mem::replace(&mut y[k], 0.0);
            let mut made_from = pivot.abs();
            for &i in walk.row(k, self.rows[column].iter().copied()) {
                let i = i as usize;
                let yi = std::mem::replace(&mut y[i], 0.0);
                for at in factors.starts[i]..filled[i] {
                    y[factors.rows[at] as usize] -= factors.values[at] * yi;
                }
                let l = yi / factors.pivots[i];
                pivot -= l * yi;
                made_from += (l * yi).abs();
                factors.rows[filled[i]] = k as u32;
                factors.values[filled[i]] = l;
                filled[i] += 1;
            }
            if pivot.is_nan() || pivot <= least * made_from {
                return Err(NotPositive { row: row_of[k] });
            }
            factors.pivots[k] = pivot;
        }
        Ok(factors)
    }
}

impl Factors {
    /// The largest number of entries in a row of L, not counting the diagonal.
    pub fn longest_row(&self) -> usize {
        let mut counts = vec![0usize; self.pivots.len()];
        self.rows.iter().for_each(|row| counts[*row as usize] += 1);
        counts.into_iter().max().unwrap_or(0)
    }

    /// x = A^-1 b, in place.
    pub fn solve(&self, b: &mut [f64]) {
        let n = self.pivots.len();
        let mut x = vec![0.0; n];
        for (row, place) in self.place.iter().enumerate() {
            x[*place as usize] = b[row];
        }
        for k in 0..n {
            for at in self.starts[k]..self.starts[k + 1] {
                x[self.rows[at] as usize] -= self.values[at] * x[k];
            }
        }
        for (value, pivot) in x.iter_mut().zip(&self.pivots) {
            *value /= pivot;
        }
        for k in (0..n).rev() {
            for at in self.starts[k]..self.starts[k + 1] {
                x[k] -= self.values[at] * x[self.rows[at] as usize];
            }
        }
        for (row, place) in self.place.iter().enumerate() {
            b[row] = x[*place as usize];
        }
    }
}

/// Up to this size the order makes too little difference to pay for finding it.
const SMALL: usize = 8;

/// The position of each row in the order of elimination.
fn order(n: usize, entries: &[(u32, u32)]) -> Vec<u32> {
    let as_given = || (0..n as u32).collect();
    if n <= SMALL {
        return as_given();
    }
    least_fill(n, entries.iter().copied()).unwrap_or_else(as_given)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid of springs: the discrete Laplacian of side m, with a weak spring to ground at every node.
    fn grid(m: usize) -> (usize, Vec<(u32, u32)>, Vec<f64>) {
        let (mut places, mut values) = (Vec::new(), Vec::new());
        let at = |i: usize, j: usize| (i * m + j) as u32;
        let mut spring = |a: u32, b: u32| {
            places.extend([(a, a), (b, b), (a, b)]);
            values.extend([1.0, 1.0, -1.0]);
        };
        for i in 0..m {
            for j in 1..m {
                spring(at(i, j - 1), at(i, j));
                spring(at(j - 1, i), at(j, i));
            }
        }
        places.extend((0..(m * m) as u32).map(|i| (i, i)));
        values.extend((0..m * m).map(|_| 0.1));
        (m * m, places, values)
    }

    #[test]
    fn a_solution_satisfies_its_equations() {
        let (n, places, values) = grid(13);
        let mut matrix = Symmetric::pattern(n, &places);
        matrix.fill(values.iter().copied());
        let b: Vec<f64> = (0..n).map(|i| ((i * 7919) % 101) as f64 - 50.0).collect();
        let mut x = b.clone();
        matrix.factor(|_| 0.0, 0.0).expect("positive definite").solve(&mut x);
        let mut product = vec![0.0; n];
        for ((i, j), value) in places.iter().zip(&values) {
            product[*i as usize] += value * x[*j as usize];
            if i != j {
                product[*j as usize] += value * x[*i as usize];
            }
        }
        // The condition number is below 8.1 / 0.1; each of the few hundred operations on a number rounds by 1e-16.
        let worst = product.iter().zip(&b).map(|(p, b)| (p - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-10, "{worst:e}");
    }

    /// Masses with hardly any connections.
    #[test]
    fn a_pattern_of_few_entries_has_its_factors() {
        let mut matrix = Symmetric::pattern(12, &[(3, 3), (3, 7), (7, 7)]);
        matrix.fill([2.0, 1.0, 2.0]);
        let mut x: Vec<f64> = (0..12).map(f64::from).collect();
        matrix.factor(|i| if i == 3 || i == 7 { 0.0 } else { 1.0 }, 0.0).expect("positive definite").solve(&mut x);
        let solution = [(3, -1.0 / 3.0), (7, 11.0 / 3.0), (5, 5.0)];
        assert!(solution.iter().all(|&(i, value): &(usize, f64)| (x[i] - value).abs() < 1e-15), "{x:?}");
    }

    #[test]
    fn an_indefinite_matrix_is_reported_and_a_shift_fixes_it() {
        let mut matrix = Symmetric::pattern(2, &[(0, 0), (1, 1), (0, 1)]);
        matrix.fill([1.0, 1.0, 2.0]);
        assert!(matrix.factor(|_| 0.0, 0.0).is_err());
        let factors = matrix.factor(|_| 3.0, 0.0).expect("shifted by more than 1");
        let mut x = [6.0, 6.0];
        factors.solve(&mut x);
        assert_eq!(x, [1.0, 1.0]);
    }
}
