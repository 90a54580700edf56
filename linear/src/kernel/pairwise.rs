//! Sums of many numbers whose error grows with the logarithm of their count.

use std::ops::Add;

/// A running sum: blocks of [`BLOCK`] numbers are summed sequentially, blocks in pairs (Higham, Accuracy and Stability
/// of Numerical Algorithms, section 4.2).
#[derive(Clone, Debug)]
pub struct PairwiseSum<T> {
    zero: T,
    block: T,
    count: usize,
    /// Sums of 2^i blocks where bit i of the number of blocks is set.
    levels: Vec<T>,
}

const BLOCK: usize = 16;

impl<T: Copy + Add<Output = T>> PairwiseSum<T> {
    pub fn from_zero(zero: T) -> PairwiseSum<T> {
        PairwiseSum { zero, block: zero, count: 0, levels: Vec::new() }
    }

    #[inline]
    pub fn add(&mut self, x: T) {
        self.block = self.block + x;
        self.count += 1;
        if self.count.is_multiple_of(BLOCK) {
            self.carry();
        }
    }

    fn carry(&mut self) {
        let mut sum = std::mem::replace(&mut self.block, self.zero);
        let mut blocks = self.count / BLOCK;
        while blocks.is_multiple_of(2) {
            sum = sum + self.levels.pop().unwrap_or(self.zero);
            blocks /= 2;
        }
        self.levels.push(sum);
    }

    pub fn total(&self) -> T {
        self.levels.iter().rev().fold(self.block, |sum, &level| sum + level)
    }

    /// Bound of the relative error of the total of numbers of one sign, if `error` is that of one addition.
    pub fn relative_error(&self, error: f64) -> f64 {
        // Every number takes part in the sum of its block, one sum for each level, and at most as many in the total.
        let levels = (self.count / BLOCK).checked_ilog2().map_or(0, |log| log + 1);
        f64::from(BLOCK as u32 + 2 * levels) * error
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_tenths_add_up() {
        let mut sum = PairwiseSum::from_zero(0.0);
        for _ in 0..1_000_000 {
            sum.add(0.1);
        }
        // A million times the binary64 number nearest to a tenth is 1e5 to 6e-12; a sequential sum is wrong by 1e-6.
        assert!((sum.total() - 100_000.0f64).abs() <= 100_000.0 * sum.relative_error(f64::EPSILON / 2.0) + 6e-12);
        assert!(sum.relative_error(f64::EPSILON / 2.0) < 6e-15);
    }
}
