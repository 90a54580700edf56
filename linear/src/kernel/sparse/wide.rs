//! L D L^T of a sparse symmetric matrix in floats of many bits, with any signs of the pivots. In: the values of a pattern. Out: the
//! factors, how many pivots are negative, and the size of the products that were rounded, from which a bound of the error follows.

use crate::kernel::big_float::Float;
use crate::kernel::sparse::ldl::Symmetric;

/// The factors of a matrix.
#[derive(Clone, Debug)]
pub struct WideFactors {
    place: Vec<u32>,
    starts: Vec<usize>,
    rows: Vec<u32>,
    values: Vec<Float>,
    pivots: Vec<Float>,
    bits: u64,
    /// Every product l_ri d_i l_ki lies below two to this power.
    pub growth: i64,
}

/// An exponent below that of any number.
const LEAST: i64 = i64::MIN / 4;

impl Symmetric {
    /// L D L^T of the matrix of these values, one for each entry of the pattern, in the order of elimination of the pattern. No row is
    /// exchanged: that makes the products larger, not the result wrong. `None` if a pivot is zero.
    pub fn factor_wide(&self, given: &[Float], bits: u64) -> Option<WideFactors> {
        let n = self.n;
        let starts = self.tree.starts().to_vec();
        let mut rows = vec![0u32; starts[n]];
        let mut values = vec![Float::zero(); starts[n]];
        let mut pivots: Vec<Float> = Vec::with_capacity(n);
        let mut sizes = vec![[LEAST; 2]; n];
        let mut filled = starts.clone();
        let mut y = vec![Float::zero(); n];
        let mut walk = self.tree.walk();
        let mut growth = LEAST;
        for k in 0..n {
            let column = self.starts[k]..self.starts[k + 1];
            for at in column.clone() {
                y[self.rows[at] as usize] = given[at].clone();
            }
            let mut pivot = std::mem::take(&mut y[k]);
            for &i in walk.row(k, self.rows[column].iter().copied()) {
                let i = i as usize;
                let yi = std::mem::take(&mut y[i]);
                for at in starts[i]..filled[i] {
                    let y = &mut y[rows[at] as usize];
                    *y = (&*y - &(&values[at] * &yi)).cut(bits);
                }
                let l = yi.divided_by(&pivots[i], bits).cut(bits);
                pivot = (&pivot - &(&l * &yi)).cut(bits);
                for (size, x) in sizes[i].iter_mut().zip([&l, &yi]) {
                    *size = (*size).max(x.ceiling_log2().unwrap_or(LEAST));
                }
                (rows[filled[i]], values[filled[i]]) = (k as u32, l);
                filled[i] += 1;
            }
            growth = growth.max(pivot.ceiling_log2()?);
            pivots.push(pivot);
        }
        let growth = sizes.iter().fold(growth, |growth, [l, y]| growth.max(l + y));
        Some(WideFactors { place: self.place.clone(), starts, rows, values, pivots, bits, growth })
    }

    /// For each entry that was given to the pattern, the index of its value.
    pub fn slots(&self) -> &[u32] {
        &self.slots
    }

    /// The number of values, one for each place of an entry or of the diagonal.
    pub fn value_count(&self) -> usize {
        self.values.len()
    }

    /// The index of the value at each place of the diagonal, by rows as given.
    pub fn diagonal_slots(&self) -> impl Iterator<Item = usize> {
        self.place.iter().map(|&place| self.starts[place as usize + 1] - 1)
    }

    /// A x for the matrix A of these values.
    pub fn times(&self, given: &[Float], x: &[Float], bits: u64) -> Vec<Float> {
        let mut row_of = vec![0; self.n];
        self.place.iter().enumerate().for_each(|(row, &place)| row_of[place as usize] = row);
        let mut y = vec![Float::zero(); self.n];
        for k in 0..self.n {
            for at in self.starts[k]..self.starts[k + 1] {
                let (i, j) = (row_of[self.rows[at] as usize], row_of[k]);
                if given[at].is_zero() {
                    continue;
                }
                y[j] = (&y[j] + &(&given[at] * &x[i])).cut(bits);
                if i != j {
                    y[i] = (&y[i] + &(&given[at] * &x[j])).cut(bits);
                }
            }
        }
        y
    }

    /// The number of products in a factorisation.
    pub fn products(&self) -> usize {
        self.tree.starts().windows(2).map(|ends| (ends[1] - ends[0]) * (ends[1] - ends[0] + 3) / 2).sum()
    }
}

impl WideFactors {
    pub fn negative_pivots(&self) -> usize {
        self.pivots.iter().filter(|pivot| pivot.is_negative()).count()
    }

    /// A^-1 b
    pub fn solve(&self, b: &[Float]) -> Vec<Float> {
        let mut x = vec![Float::zero(); b.len()];
        for (row, place) in self.place.iter().enumerate() {
            x[*place as usize] = b[row].clone();
        }
        for k in 0..x.len() {
            let xk = std::mem::take(&mut x[k]);
            for at in self.starts[k]..self.starts[k + 1] {
                let x = &mut x[self.rows[at] as usize];
                *x = (&*x - &(&self.values[at] * &xk)).cut(self.bits);
            }
            x[k] = xk;
        }
        for k in (0..x.len()).rev() {
            let mut xk = x[k].divided_by(&self.pivots[k], self.bits).cut(self.bits);
            for at in self.starts[k]..self.starts[k + 1] {
                xk = (&xk - &(&self.values[at] * &x[self.rows[at] as usize])).cut(self.bits);
            }
            x[k] = xk;
        }
        self.place.iter().map(|&place| x[place as usize].clone()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three springs of 1, 10^40 and -2 N/m in a row from the ground: det = -2 10^40 + ..., one negative eigenvalue; K x = b exactly.
    #[test]
    fn factors_of_any_ratio_count_and_solve() {
        let stiff = 1e40;
        let pattern = Symmetric::pattern(3, &[(0, 0), (0, 1), (1, 1), (1, 2), (2, 2)]);
        let mut values = vec![Float::zero(); pattern.value_count()];
        let given = [(1.0, stiff), (-stiff, 0.0), (stiff, -2.0), (2.0, 0.0), (-2.0, 0.0)];
        let sums: Vec<Float> = given.iter().map(|&(a, b)| &Float::from(a) + &Float::from(b)).collect();
        pattern.slots().iter().zip(&sums).for_each(|(&slot, x)| values[slot as usize] = x.clone());
        let factors = pattern.factor_wide(&values, 300).expect("regular");
        assert_eq!(factors.negative_pivots(), 1);
        // At the end 1 N: it stretches the springs by 1, 10^-40 and -1/2 m.
        let x = factors.solve(&[Float::zero(), Float::zero(), Float::from(1.0)]);
        let stretch = (&x[1] - &x[0]).to_f64();
        assert!((stretch * stiff - 1.0).abs() < 1e-15, "{stretch}");
        assert!((x[2].to_f64() - 0.5).abs() < 1e-15 && (x[0].to_f64() - 1.0).abs() < 1e-15);
        assert!(factors.growth >= 133, "{}", factors.growth);
        for (slot, truth) in pattern.diagonal_slots().zip([stiff, stiff, -2.0]) {
            assert!((values[slot].to_f64() / truth - 1.0).abs() < 1e-15);
        }
    }

    /// [e 0 1; 0 -e 1; 1 1 1], whose two small pivots add 1 / e and -1 / e to the last one: no pivot is large, but the products are.
    #[test]
    fn products_that_cancel_count_as_growth() {
        let small = 2f64.powi(-40);
        let pattern = Symmetric::pattern(3, &[(0, 0), (0, 2), (1, 1), (1, 2), (2, 2)]);
        let mut values = vec![Float::zero(); pattern.value_count()];
        let given = [small, 1.0, -small, 1.0, 1.0];
        pattern.slots().iter().zip(given).for_each(|(&slot, x)| values[slot as usize] = Float::from(x));
        let factors = pattern.factor_wide(&values, 100).expect("regular");
        assert_eq!(factors.negative_pivots(), 1);
        assert!(factors.pivots.iter().all(|pivot| pivot.to_f64().abs() <= 1.0));
        assert!(factors.growth >= 40, "{}", factors.growth);
    }
}
