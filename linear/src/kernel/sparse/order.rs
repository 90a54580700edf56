//! The order of elimination of a sparse symmetric matrix: approximate minimum degree (Amestoy, Davis, Duff, SIAM J.
//! Matrix Anal. 17 (1996) 886; crate `amd`). In: the places of its entries. Out: the position of each row in the order.

/// The position of each of n rows in an order with little fill. Entries may be in either triangle and given more than
/// once; rows without entries get a position too. `None` if the pattern is too large for the crate's integers.
pub fn least_fill(n: usize, entries: impl IntoIterator<Item = (u32, u32)>) -> Option<Vec<u32>> {
    if n == 0 {
        return Some(Vec::new());
    }
    // With the diagonal, and each entry once: the crate assumes that there are at least as many entries as rows, and
    // that the number of off-diagonal entries is the one it counts itself.
    let diagonal = (0..n as u32).map(|i| (i, i));
    let pairs = entries.into_iter().chain(diagonal);
    let mut pairs: Vec<(i32, i32)> = pairs.map(|(i, j)| (i.min(j) as i32, i.max(j) as i32)).collect();
    pairs.sort_unstable();
    pairs.dedup();
    let mut starts = vec![0i32; n + 1];
    pairs.iter().for_each(|pair| starts[pair.0 as usize + 1] += 1);
    for column in 0..n {
        starts[column + 1] += starts[column];
    }
    let rows: Vec<i32> = pairs.iter().map(|pair| pair.1).collect();
    let (_, places, _) = amd::order(i32::try_from(n).ok()?, &starts, &rows, &amd::Control::default()).ok()?;
    Some(places.into_iter().map(|place| place as u32).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_permutation(places: &[u32]) -> bool {
        let mut sorted = places.to_vec();
        sorted.sort_unstable();
        sorted.iter().copied().eq(0..places.len() as u32)
    }

    /// The crate subtracts the number of rows from that of entries.
    #[test]
    fn a_pattern_may_have_fewer_entries_than_rows() {
        for entries in [vec![], vec![(3, 7)], vec![(7, 3), (11, 0), (0, 11)]] {
            let places = least_fill(12, entries.iter().copied()).expect("a small pattern");
            assert!(is_permutation(&places), "{places:?}");
        }
        assert_eq!(least_fill(0, []), Some(vec![]));
    }

    #[test]
    fn entries_may_be_given_often_and_in_both_triangles() {
        let arrow: Vec<(u32, u32)> = (1..10).flat_map(|i| [(0, i), (i, 0), (0, i)]).collect();
        let places = least_fill(10, arrow.iter().copied()).expect("a small pattern");
        assert!(is_permutation(&places));
        // The hub of an arrow goes last, or next to last.
        assert!(places[0] >= 8, "{places:?}");
    }
}
