//! The elimination tree of a sparse symmetric matrix A = L D L^T: the pattern of L, known before any of its numbers. In: the
//! rows of each column of A on or above the diagonal. Out: how many entries each column of L has, and the columns of L that
//! each of its rows needs.
//!
//! The parent of a column is the first row below the diagonal of L in it; row k of L is the part of the tree between the
//! entries of column k of A and k: T. A. Davis, *Algorithm 849: a concise sparse Cholesky factorization package*, ACM TOMS 31
//! (2005) 587-591.

use std::iter::Rev;
use std::slice::Iter;

#[derive(Clone, Debug)]
pub struct EliminationTree {
    parents: Vec<u32>,
    /// Index at which each column of L begins, and at the end their number; without the diagonal.
    starts: Vec<usize>,
}

/// Goes through the rows of L one after another.
pub struct Walk<'a> {
    parents: &'a [u32],
    /// The last row that reached a column.
    mark: Vec<u32>,
    path: Vec<u32>,
    /// The columns that a row needs, the last one first.
    needed: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl EliminationTree {
    /// The tree of n columns. `None` if L would have more than `most` entries.
    pub fn of<R: Iterator<Item = u32>>(n: usize, rows: impl Fn(usize) -> R, most: usize) -> Option<EliminationTree> {
        let (mut parents, mut mark, mut counts) = (vec![NONE; n], vec![NONE; n], vec![0; n]);
        let mut total = 0;
        for k in 0..n {
            mark[k] = k as u32;
            for row in rows(k) {
                let mut i = row as usize;
                while mark[i] != k as u32 {
                    if parents[i] == NONE {
                        parents[i] = k as u32;
                    }
                    counts[i] += 1;
                    total += 1;
                    mark[i] = k as u32;
                    i = parents[i] as usize;
                }
            }
            if total > most {
                return None;
            }
        }
        let mut starts = vec![0; n + 1];
        for i in 0..n {
            starts[i + 1] = starts[i] + counts[i];
        }
        Some(EliminationTree { parents, starts })
    }

    /// Index at which each column of L begins, and at the end the number of entries; without the diagonal.
    pub fn starts(&self) -> &[usize] {
        &self.starts
    }

    pub fn walk(&self) -> Walk<'_> {
        let mark = vec![NONE; self.parents.len()];
        Walk { parents: &self.parents, mark, path: Vec::new(), needed: Vec::new() }
    }
}

impl Walk<'_> {
    /// The columns of L that row k needs, in the order of elimination, given the rows of column k of A. Each row once.
    #[inline]
    pub fn row(&mut self, k: usize, rows: impl Iterator<Item = u32>) -> Rev<Iter<'_, u32>> {
        self.needed.clear();
        self.mark[k] = k as u32;
        for row in rows {
            self.path.clear();
            let mut i = row;
            while self.mark[i as usize] != k as u32 {
                self.path.push(i);
                self.mark[i as usize] = k as u32;
                i = self.parents[i as usize];
            }
            // A path leads up the tree; the newest path goes before the earlier ones.
            self.needed.extend(self.path.iter().rev());
        }
        self.needed.iter().rev()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pattern of L by elimination itself: the neighbours of an eliminated column become neighbours of each other.
    fn by_elimination(n: usize, entries: &[(u32, u32)]) -> Vec<Vec<usize>> {
        let mut full = vec![vec![false; n]; n];
        for &(i, j) in entries {
            full[i as usize][j as usize] = true;
            full[j as usize][i as usize] = true;
        }
        for p in 0..n {
            for i in p + 1..n {
                for j in p + 1..n {
                    full[i][j] |= full[i][p] && full[p][j];
                }
            }
        }
        (0..n).map(|k| (0..k).filter(|&i| full[k][i]).collect()).collect()
    }

    #[test]
    fn rows_of_the_factor_are_those_that_elimination_fills() {
        let n = 40;
        let entries: Vec<(u32, u32)> =
            (0..70u32).map(|t| (t * 7 % 40, (t * t * 3 + 5) % 40)).map(|(i, j)| (i.min(j), i.max(j))).collect();
        let column = |k: usize| {
            entries.iter().filter(move |&&(_, column)| column as usize == k).map(|&(row, _)| row).collect::<Vec<_>>()
        };
        let truth = by_elimination(n, &entries);
        let count: usize = truth.iter().map(Vec::len).sum();
        let rows = |k: usize| column(k).into_iter();
        assert!(EliminationTree::of(n, rows, count - 1).is_none());
        let tree = EliminationTree::of(n, rows, count).expect("as many entries as allowed");
        let mut walk = tree.walk();
        let mut counts = vec![0; n];
        for (k, truth) in truth.iter().enumerate() {
            let order: Vec<usize> = walk.row(k, rows(k)).map(|&i| i as usize).collect();
            order.iter().for_each(|&i| counts[i] += 1);
            // Each column comes before those that need it.
            for (at, &i) in order.iter().enumerate() {
                assert!(order[at + 1..].iter().all(|&later| !(later < i && truth_needs(&tree, later, i))), "row {k}");
            }
            let mut sorted = order;
            sorted.sort_unstable();
            assert_eq!(&sorted, truth, "row {k}");
        }
        assert!((0..n).all(|i| tree.starts()[i + 1] - tree.starts()[i] == counts[i]));
    }

    /// Whether column i is above `below` in the tree.
    fn truth_needs(tree: &EliminationTree, below: usize, i: usize) -> bool {
        std::iter::successors(Some(below as u32), |&at| Some(tree.parents[at as usize]).filter(|&up| up != NONE))
            .any(|at| at as usize == i)
    }
}
