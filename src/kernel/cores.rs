//! Work on all cores. No item depends on its neighbours, so neither the division of a list nor the number of cores changes a bit of
//! the result.

use std::thread;

/// Applies `work` to the whole list, split into a piece for each core of at least `least` items, each a multiple of `multiple`;
/// returns the results in order.
pub(crate) fn in_pieces<T: Sync, U: Send>(
    items: &[T],
    least: usize,
    multiple: usize,
    work: impl Fn(&[T]) -> Vec<U> + Sync,
) -> Vec<U> {
    let length = piece(items.len(), least).next_multiple_of(multiple);
    if length >= items.len() {
        return work(items);
    }
    let (first, others) = items.split_at(length);
    thread::scope(|scope| {
        let started: Vec<_> = others.chunks(length).map(|piece| scope.spawn(|| work(piece))).collect();
        let mut results = work(first);
        for piece in started {
            results.extend(piece.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        results
    })
}

/// Applies `work` to the numbers of a slice in pieces of whole columns, `stride` numbers each, of at least `least` columns; with the
/// index of each piece's first column and the number of its columns. The last column may be shorter than the stride.
pub(crate) fn in_columns(
    numbers: &mut [f64],
    (stride, columns, least): (usize, usize, usize),
    work: impl Fn(&mut [f64], usize, usize) + Sync,
) {
    let length = piece(columns, least);
    if length >= columns {
        return work(numbers, 0, columns);
    }
    thread::scope(|scope| {
        let mut pieces = numbers.chunks_mut(stride * length).zip((0..columns).step_by(length));
        let first = pieces.next();
        for (piece, at) in pieces {
            let work = &work;
            scope.spawn(move || work(piece, at, length.min(columns - at)));
        }
        if let Some((piece, at)) = first {
            work(piece, at, length);
        }
    });
}

/// The length of a piece.
fn piece(count: usize, least: usize) -> usize {
    // Asking for the number of cores takes some microseconds.
    if count < 2 * least.max(1) {
        return count.max(1);
    }
    let cores = thread::available_parallelism().map_or(1, |cores| cores.get());
    count.div_ceil(cores).max(least.max(1))
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
