//! Many frequencies on all cores. No frequency depends on its neighbours, so neither the division of the list nor the
//! number of cores changes a bit of the result. See docs/method/transfer.md#two-sided-approximation.

use super::Frequency;
use crate::kernel::simd::MOST;
use std::thread;

/// Less work than this, in coordinates times frequencies, takes a millisecond: starting threads would take a part of
/// that.
const WORTH_IT: usize = 1 << 18;

/// Applies `work` to the whole list, split into a piece for each core if there is enough work; returns the results in
/// order.
pub(super) fn in_pieces<T: Send>(
    frequencies: &[Frequency],
    coordinates: usize,
    work: impl Fn(&[Frequency]) -> Vec<T> + Sync,
) -> Vec<T> {
    let cores = if frequencies.len().saturating_mul(coordinates) < WORTH_IT { 1 } else { cores() };
    // Pieces consist of whole vectors of frequencies.
    let length = frequencies.len().div_ceil(cores).next_multiple_of(MOST);
    if length >= frequencies.len() {
        return work(frequencies);
    }
    let (first, others) = frequencies.split_at(length);
    thread::scope(|scope| {
        let started: Vec<_> = others.chunks(length).map(|piece| scope.spawn(|| work(piece))).collect();
        let mut results = work(first);
        for piece in started {
            results.extend(piece.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        results
    })
}

fn cores() -> usize {
    thread::available_parallelism().map_or(1, |cores| cores.get())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Number;

    #[test]
    fn pieces_come_back_in_order_and_whole() {
        let frequencies: Vec<Frequency> = (1..1000).map(|i| Frequency::hertz(&Number::from(i))).collect();
        let hertz = |some: &[Frequency]| some.iter().map(|f| f.hertz.to_f64()).collect::<Vec<f64>>();
        for coordinates in [1, 300, usize::MAX] {
            assert_eq!(in_pieces(&frequencies, coordinates, hertz), hertz(&frequencies));
        }
        assert_eq!(in_pieces(&[], 5, hertz), [0.0; 0]);
    }
}
