//! Work on all cores. No item depends on its neighbours, so neither the division of a list nor the number of cores changes a bit of
//! the result.

use crate::base::OrderBy;
use std::sync::Mutex;
use std::thread;

/// Pieces for each core: one that is late, because other programs run on it, has a smaller share in the end.
const PIECES: usize = 4;

/// Applies `work` to the whole list, in pieces of at least `least` items, each a multiple of `multiple`; returns the results in
/// order.
pub fn in_pieces<T: Sync, U: Send>(
    items: &[T],
    least: usize,
    multiple: usize,
    work: impl Fn(&[T]) -> Vec<U> + Sync,
) -> Vec<U> {
    let (cores, length) = division(items.len(), least);
    let length = length.next_multiple_of(multiple);
    if length >= items.len() {
        return work(items);
    }
    let pieces = items.chunks(length).enumerate();
    let found = Mutex::new(Vec::with_capacity(pieces.len()));
    on_cores(cores, pieces, |(at, piece)| {
        let results = work(piece);
        found.lock().expect("nobody panics with the lock").push((at, results));
    });
    let mut found = found.into_inner().expect("nobody panics with the lock");
    found.order_by_key(|(at, _)| *at);
    found.into_iter().flat_map(|(_, results)| results).collect()
}

/// Applies `work` to each item of a list, on one core if there are fewer than twice `least`; returns the results in order.
pub fn one_by_one<T: Send, U: Send>(items: Vec<T>, least: usize, work: impl Fn(T) -> U + Sync) -> Vec<U> {
    let (cores, _) = division(items.len(), least);
    if cores == 1 {
        return items.into_iter().map(work).collect();
    }
    let found = Mutex::new(Vec::with_capacity(items.len()));
    on_cores(cores, items.into_iter().enumerate(), |(at, item)| {
        let result = work(item);
        found.lock().expect("nobody panics with the lock").push((at, result));
    });
    let mut found = found.into_inner().expect("nobody panics with the lock");
    found.order_by_key(|(at, _)| *at);
    found.into_iter().map(|(_, result)| result).collect()
}

/// Applies `work` to the numbers of a slice in pieces of whole columns, `stride` numbers each, of at least `least` columns; with the
/// index of each piece's first column and the number of its columns. The last column may be shorter than the stride.
pub fn in_columns(
    numbers: &mut [f64],
    (stride, columns, least): (usize, usize, usize),
    work: impl Fn(&mut [f64], usize, usize) + Sync,
) {
    let (cores, length) = division(columns, least);
    if length >= columns {
        return work(numbers, 0, columns);
    }
    let pieces = numbers.chunks_mut(stride * length).zip((0..columns).step_by(length));
    on_cores(cores, pieces, |(piece, at)| work(piece, at, length.min(columns - at)));
}

/// Applies `work` to each piece; every core takes the next one when it is done with its last.
fn on_cores<P: Send>(cores: usize, pieces: impl Iterator<Item = P> + Send, work: impl Fn(P) + Sync) {
    let pieces = Mutex::new(pieces);
    let next = || pieces.lock().expect("nobody panics with the lock").next();
    let some = || {
        while let Some(piece) = next() {
            work(piece);
        }
    };
    thread::scope(|scope| {
        let others: Vec<_> = (1..cores).map(|_| scope.spawn(some)).collect();
        some();
        for other in others {
            other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        }
    });
}

/// The number of cores for so many items, and the length of a piece.
fn division(count: usize, least: usize) -> (usize, usize) {
    let least = least.max(1);
    // Asking for the number of cores takes some microseconds.
    if count < least.saturating_mul(2) {
        return (1, count.max(1));
    }
    let cores = thread::available_parallelism().map_or(1, |cores| cores.get()).min(count / least);
    let pieces = if cores == 1 { 1 } else { cores * PIECES };
    (cores, count.div_ceil(pieces).max(least))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_come_back_in_order_and_whole() {
        let numbers: Vec<usize> = (0..1000).collect();
        let doubled = |some: &[usize]| some.iter().map(|x| 2 * x).collect::<Vec<usize>>();
        for (least, multiple) in [(1, 1), (300, 8), (7, 16), (usize::MAX / 4, 1)] {
            assert_eq!(in_pieces(&numbers, least, multiple, doubled), doubled(&numbers));
        }
        assert_eq!(in_pieces(&[], 1, 8, doubled), [0; 0]);
        for least in [0, 1, 300, 1000] {
            assert_eq!(one_by_one(numbers.clone(), least, |x| 2 * x), doubled(&numbers));
        }
    }

    /// Columns of five numbers, of which the last lacks two, as of a part of a matrix.
    #[test]
    fn each_column_is_worked_on_once() {
        for least in [1, 2, 50] {
            let mut numbers = vec![0.0; 5 * 21 - 2];
            in_columns(&mut numbers, (5, 21, least), |piece, first, columns| {
                for (j, column) in piece.chunks_mut(5).enumerate() {
                    column.iter_mut().for_each(|x| *x += (first + j) as f64);
                }
                assert_eq!(piece.len().div_ceil(5), columns);
            });
            let expected: Vec<f64> = (0..numbers.len()).map(|i| (i / 5) as f64).collect();
            assert_eq!(numbers, expected, "{least}");
        }
    }
}
