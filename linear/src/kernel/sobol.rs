//! Sobol's sequence, scrambled at random: points that fill a cube far more evenly than independent ones, the same on every machine.
//! In: the index of a point, a dimension, a key. Out: a number between 0 and 1.

use super::philox::philox;

/// Dimensions that there are direction numbers for.
pub const DIMENSIONS: usize = POLYNOMIALS.len() + 1;

/// Binary digits of the sequence; the digits behind them are random.
const DIGITS: usize = 32;

/// A number between 0 and 1, both excluded: the digit of a point at each place, exchanged or not at random for each sequence of digits
/// before it (A. B. Owen, Annals of Statistics 25, 1997, 1541-1562, section 2), so that every point is uniformly distributed and the
/// points together keep Sobol's evenness. `key` tells scramblings apart, `stream` the purpose.
pub fn scramble_point(index: u32, dimension: usize, key: [u32; 2], stream: [u32; 2]) -> f64 {
    let plain = plain(index, dimension);
    let mut found = plain;
    // Seven levels of the tree of digits have 127 nodes, the random bits of one call.
    for top in (0..DIGITS).step_by(LEVELS) {
        let before = if top == 0 { 0 } else { plain >> (DIGITS - top) };
        let words = philox([before, stream[0], stream[1], (dimension as u32) << 8 | top as u32], key);
        for level in top..(top + LEVELS).min(DIGITS) {
            // The nodes of a level are numbered behind those of the levels above it.
            let way = (u64::from(plain) >> (DIGITS - level)) as u32 & ((1 << (level - top)) - 1);
            let node = (1 << (level - top)) - 1 + way as usize;
            let exchanged = words[node / 32] >> (node % 32) & 1;
            found ^= exchanged << (DIGITS - 1 - level);
        }
    }
    let [rest, ..] = philox([plain, stream[0], stream[1], (dimension as u32) << 8 | DIGITS as u32], key);
    let bits = u64::from(found) << 20 | u64::from(rest >> 12);
    (bits as f64 + 0.5) / (1u64 << 52) as f64
}

const LEVELS: usize = 7;

/// The binary digits of a point of the sequence.
fn plain(index: u32, dimension: usize) -> u32 {
    let mut point = 0;
    let mut numbers = [0u32; DIGITS];
    match dimension.checked_sub(1).map(|row| POLYNOMIALS[row]) {
        None => numbers.iter_mut().enumerate().for_each(|(k, number)| *number = 1 << (DIGITS - 1 - k)),
        Some((polynomial, initial)) => {
            let degree = initial.len();
            for k in 0..DIGITS {
                numbers[k] = match initial.get(k) {
                    Some(m) => m << (DIGITS - 1 - k),
                    None => {
                        // Bratley and Fox (ACM Transactions on Mathematical Software 14, 1988, 88-100), equation 2.
                        let taken = |j: &usize| polynomial >> (degree - j) & 1 == 1;
                        let sum = (1..degree).filter(taken).fold(0, |sum, j| sum ^ numbers[k - j]);
                        sum ^ numbers[k - degree] ^ numbers[k - degree] >> degree
                    }
                };
            }
        }
    }
    for (k, number) in numbers.iter().enumerate() {
        point ^= number * (index >> k & 1);
    }
    point
}

/// For each dimension from the second on a primitive polynomial, its highest coefficient first, and the first direction numbers: those
/// of S. Joe and F. Y. Kuo (SIAM Journal on Scientific Computing 30, 2008, 2635-2654), file new-joe-kuo-6.21201.
const POLYNOMIALS: [(u32, &[u32]); 39] = [
    (3, &[1]),
    (7, &[1, 3]),
    (11, &[1, 3, 1]),
    (13, &[1, 1, 1]),
    (19, &[1, 1, 3, 3]),
    (25, &[1, 3, 5, 13]),
    (37, &[1, 1, 5, 5, 17]),
    (41, &[1, 1, 5, 5, 5]),
    (47, &[1, 1, 7, 11, 19]),
    (55, &[1, 1, 5, 1, 1]),
    (59, &[1, 1, 1, 3, 11]),
    (61, &[1, 3, 5, 5, 31]),
    (67, &[1, 3, 3, 9, 7, 49]),
    (91, &[1, 1, 1, 15, 21, 21]),
    (97, &[1, 3, 1, 13, 27, 49]),
    (103, &[1, 1, 1, 15, 7, 5]),
    (109, &[1, 3, 1, 15, 13, 25]),
    (115, &[1, 1, 5, 5, 19, 61]),
    (131, &[1, 3, 7, 11, 23, 15, 103]),
    (137, &[1, 3, 7, 13, 13, 15, 69]),
    (143, &[1, 1, 3, 13, 7, 35, 63]),
    (145, &[1, 3, 5, 9, 1, 25, 53]),
    (157, &[1, 3, 1, 13, 9, 35, 107]),
    (167, &[1, 3, 1, 5, 27, 61, 31]),
    (171, &[1, 1, 5, 11, 19, 41, 61]),
    (185, &[1, 3, 5, 3, 3, 13, 69]),
    (191, &[1, 1, 7, 13, 1, 19, 1]),
    (193, &[1, 3, 7, 5, 13, 19, 59]),
    (203, &[1, 1, 3, 9, 25, 29, 41]),
    (211, &[1, 3, 5, 13, 23, 1, 55]),
    (213, &[1, 3, 7, 3, 13, 59, 17]),
    (229, &[1, 3, 1, 3, 5, 53, 69]),
    (239, &[1, 1, 5, 5, 23, 33, 13]),
    (241, &[1, 1, 7, 7, 1, 61, 123]),
    (247, &[1, 1, 7, 9, 13, 61, 49]),
    (253, &[1, 3, 3, 5, 3, 55, 33]),
    (285, &[1, 3, 1, 15, 31, 13, 49, 245]),
    (299, &[1, 3, 5, 15, 31, 59, 63, 97]),
    (301, &[1, 3, 1, 11, 11, 11, 77, 249]),
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Points 1, 2, 3, 5, 21 and 63 in some dimensions, as SciPy's qmc.Sobol has them without scrambling, which visits them in the
    /// order of Gray's code: its point k is ours of the index k ^ (k >> 1).
    #[test]
    fn points_are_those_of_joe_and_kuo() {
        let known: [(usize, [f64; 6]); 5] = [
            (1, [0.5, 0.25, 0.75, 0.875, 0.59375, 0.796875]),
            (2, [0.5, 0.25, 0.75, 0.125, 0.34375, 0.359375]),
            (4, [0.5, 0.75, 0.25, 0.875, 0.65625, 0.859375]),
            (11, [0.5, 0.75, 0.25, 0.875, 0.53125, 0.671875]),
            (39, [0.5, 0.25, 0.75, 0.375, 0.53125, 0.171875]),
        ];
        for (dimension, values) in known {
            for (k, value) in [1u32, 2, 3, 5, 21, 63].into_iter().zip(values) {
                assert_eq!(f64::from(plain(k ^ k >> 1, dimension)) / 4_294_967_296.0, value, "{dimension} {k}");
            }
        }
    }

    /// Any 2^m points from a multiple of 2^m on have one in each of 2^m equal intervals of a dimension, and of the first two dimensions
    /// one in each rectangle of that area whose sides are powers of two: scrambled or not.
    #[test]
    fn scrambled_points_keep_their_evenness() {
        let (m, key) = (8u32, [3, 9]);
        for from in [0u32, 256, 5 << 8] {
            let of = |dimension: usize| -> Vec<f64> {
                (from..from + 256).map(|index| scramble_point(index, dimension, key, [7, 1])).collect()
            };
            for dimension in [0, 1, 2, 13, 39] {
                let mut cells: Vec<usize> = of(dimension).iter().map(|x| (x * 256.0) as usize).collect();
                cells.sort_unstable();
                assert_eq!(cells, (0..256).collect::<Vec<_>>(), "{dimension}");
            }
            let (x, y) = (of(0), of(1));
            for wide in 0..=m {
                let sides = [f64::from(1u32 << wide), f64::from(1u32 << (m - wide))];
                let mut cells: Vec<usize> =
                    x.iter().zip(&y).map(|(x, y)| (x * sides[0]) as usize * 256 + (y * sides[1]) as usize).collect();
                cells.sort_unstable();
                cells.dedup();
                assert_eq!(cells.len(), 256, "{wide}");
            }
        }
    }

    /// Over many keys, one point is anywhere with the same probability: 4,000 values in eight intervals, 500 in each but for five
    /// standard deviations of 21; and neighbouring digits are independent.
    #[test]
    fn each_point_is_uniform() {
        for (index, dimension) in [(0, 0), (1, 1), (12, 5)] {
            let mut counts = [0; 8];
            for key in 0..4000 {
                counts[(scramble_point(index, dimension, [key, 1], [0, 0]) * 8.0) as usize] += 1;
            }
            assert!(counts.iter().all(|count: &i32| (count - 500).abs() < 105), "{index} {dimension}: {counts:?}");
        }
    }
}
