//! Many frequencies on all cores. No frequency depends on its neighbours, so neither the division of the list nor the
//! number of cores changes a bit of the result. See docs/method/transfer.md#two-sided-approximation.

use super::Frequency;
use crate::kernel::cores;
use crate::kernel::simd::MOST;

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
    let is_worth_it = frequencies.len().saturating_mul(coordinates) >= WORTH_IT;
    // Pieces consist of whole vectors of frequencies.
    cores::in_pieces(frequencies, if is_worth_it { 1 } else { frequencies.len() }, MOST, work)
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
