//! The nearest known word to an unknown one.

/// The candidate nearest to `word`, if one is near enough to be meant; among equals, the first.
pub fn nearest<'c>(word: &str, candidates: impl IntoIterator<Item = &'c str>) -> Option<&'c str> {
    let length = word.chars().count();
    // A third of the letters may differ: one in `mas`, two in `freelenght`.
    let allowed = (length / 3).max(1);
    let near = candidates
        .into_iter()
        .map(|candidate| (distance(word, candidate), candidate))
        // Two words of one letter have only their length in common.
        .filter(|&(distance, candidate)| distance <= allowed && distance < candidate.chars().count().max(length));
    near.min_by_key(|&(distance, _)| distance).map(|(_, candidate)| candidate)
}

/// Number of letters to change, insert, drop or swap; case is ignored, so `M1` is nearest to `m1`.
fn distance(a: &str, b: &str) -> usize {
    strsim::damerau_levenshtein(&a.to_lowercase(), &b.to_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_of_the_hand_is_found_and_another_word_is_not() {
        let fields = ["mass", "inertia", "shape", "moves", "free_length"];
        assert_eq!(nearest("mas", fields), Some("mass"));
        assert_eq!(nearest("Mass", fields), Some("mass"));
        assert_eq!(nearest("freelenght", fields), Some("free_length"));
        assert_eq!(nearest("colour", fields), None);
        assert_eq!(nearest("k", ["c", "b"]), None);
    }
}
