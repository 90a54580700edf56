//! The number of poles. In: the finite and infinite poles that each method found of a part. Out: the count of a whole
//! system, or nothing if it is not proved that every pole was found exactly once.
//! See docs/method/poles.md#definition and docs/method/poles.md#exact-arithmetic.

/// Proof that every finite pole of a system is in a list, each in a certain enclosure (a cluster in one that contains
/// as many poles as it has members), and that finite and infinite ones together are two for each coordinate. Only
/// `Tally` makes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PoleCount {
    finite: usize,
    infinite: usize,
}

impl PoleCount {
    /// The degree of det Q(s).
    pub fn finite(self) -> usize {
        self.finite
    }

    /// Number of infinite poles, from motions without inertia.
    pub fn infinite(self) -> usize {
        self.infinite
    }

    /// A count for tests of reports, without an analysis.
    #[cfg(test)]
    pub fn sample(finite: usize, infinite: usize) -> PoleCount {
        PoleCount { finite, infinite }
    }
}

/// Counts part by part.
#[derive(Debug, Default)]
pub struct Tally {
    finite: usize,
    infinite: usize,
    coordinates: usize,
    /// Whether the count of some part was wrong.
    broken: bool,
}

impl Tally {
    /// Adds a part with this many coordinates, all of whose poles are found: the finite ones, all enclosed, and the
    /// infinite ones.
    pub fn part(&mut self, coordinates: usize, finite: usize, infinite: usize) {
        self.coordinates += coordinates;
        self.finite += finite;
        self.infinite += infinite;
        self.broken |= finite + infinite != 2 * coordinates;
    }

    /// Records a pole of which nothing is certain.
    pub fn add_uncertain(&mut self) {
        self.broken = true;
    }

    /// The count of a system with this many coordinates.
    pub fn certain_count(&self, coordinates: usize) -> Option<PoleCount> {
        let whole = !self.broken && self.coordinates == coordinates;
        whole.then_some(PoleCount { finite: self.finite, infinite: self.infinite })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_poles_for_each_coordinate_are_a_count() {
        let mut tally = Tally::default();
        tally.part(2, 3, 1);
        assert_eq!(tally.certain_count(5), None, "a part is missing");
        tally.part(3, 6, 0);
        assert_eq!(tally.certain_count(5), Some(PoleCount { finite: 9, infinite: 1 }));
    }

    #[test]
    fn a_pole_too_few_or_too_many_or_without_a_bound_is_no_count() {
        for (finite, infinite, doubt) in [(3, 0, false), (5, 0, false), (3, 2, false), (4, 0, true)] {
            let mut tally = Tally::default();
            tally.part(2, finite, infinite);
            if doubt {
                tally.add_uncertain();
            }
            assert_eq!(tally.certain_count(2), None, "{finite} {infinite} {doubt}");
        }
    }
}
