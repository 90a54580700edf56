//! Sorting lists, compiled once.
//!
//! The sort of the standard library is fast for millions of items, and is compiled anew for each comparison: six thousand bytes
//! of code, an eighth of all the time that the program took to build. Lists that a scene's size does not make long are ordered
//! by [`OrderBy`] instead: few items are inserted one by one; of many, their indices are sorted by the one sort that all lists
//! share, and the items follow. Both keep equal items in their order, as [`slice::sort_by`] does.

use std::cmp::Ordering;

/// Up to here insertion beats an allocation; the sort of the standard library changes over at 20 as well.
const FEW: usize = 20;

pub trait OrderBy<T> {
    /// Sorts by a total order; equal items stay in their order.
    fn order_by(&mut self, compare: impl FnMut(&T, &T) -> Ordering);

    /// Sorts by a key; items with equal keys stay in their order.
    fn order_by_key<K: Ord>(&mut self, mut key: impl FnMut(&T) -> K) {
        self.order_by(|a, b| key(a).cmp(&key(b)));
    }
}

impl<T> OrderBy<T> for [T] {
    fn order_by(&mut self, mut compare: impl FnMut(&T, &T) -> Ordering) {
        if self.len() > FEW {
            let order = order_of(self.len(), &mut |i, j| compare(&self[i], &self[j]));
            return arrange(self, order);
        }
        for last in 1..self.len() {
            let mut at = last;
            while at > 0 && compare(&self[at], &self[at - 1]) == Ordering::Less {
                self.swap(at, at - 1);
                at -= 1;
            }
        }
    }
}

/// The indices below `count` in the order of what they stand for.
fn order_of(count: usize, compare: &mut dyn FnMut(usize, usize) -> Ordering) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&i, &j| compare(i, j));
    order
}

/// Puts item `order[i]` at place i, cycle by cycle.
fn arrange<T>(items: &mut [T], mut order: Vec<usize>) {
    for start in 0..items.len() {
        let mut at = start;
        while order[at] != start {
            let next = order[at];
            items.swap(at, next);
            order[at] = at;
            at = next;
        }
        order[at] = at;
    }
}

/// The first `count` items of a list in a total order; equal items stay in the list's order. What comes behind them is not sorted, so a
/// few of a million cost one pass.
pub fn first_by<T>(items: impl IntoIterator<Item = T>, count: usize, compare: impl Fn(&T, &T) -> Ordering) -> Vec<T> {
    let mut first: Vec<T> = Vec::new();
    for item in items {
        if first.len() == count && first.last().is_none_or(|last| compare(&item, last) != Ordering::Less) {
            continue;
        }
        first.insert(first.partition_point(|known| compare(known, &item) != Ordering::Greater), item);
        first.truncate(count);
    }
    first
}

#[cfg(test)]
mod tests {
    use super::{OrderBy, first_by};

    /// Beside the standard library's stable sort: lists of every length up to 100, with keys that repeat.
    #[test]
    fn lists_are_sorted_as_the_standard_library_sorts_them() {
        let mut state = 1_u64;
        for length in 0..100 {
            let list: Vec<(u64, usize)> = (0..length)
                .map(|at| {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    ((state >> 33) % 13, at)
                })
                .collect();
            let (mut expected, mut by, mut by_key) = (list.clone(), list.clone(), list.clone());
            expected.sort_by_key(|item| item.0);
            by.order_by(|a, b| a.0.cmp(&b.0));
            by_key.order_by_key(|item| item.0);
            assert_eq!(by, expected);
            assert_eq!(by_key, expected);
            for count in [0, 1, 3, length] {
                let first = first_by(list.iter().copied(), count, |a, b| a.0.cmp(&b.0));
                assert_eq!(first, expected[..count.min(length)]);
            }
        }
    }
}
