//! What is asked of an analysis of modes.

/// Which modes, and how accurate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    pub which: Which,
    /// Relative bound that an omega^2 should have at most. Where it is not reached the modes come with the bounds that were.
    pub tolerance: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    All,
    /// So many of the lowest, rigid motions included.
    Lowest(usize),
}

impl Default for Request {
    fn default() -> Request {
        Request { which: Which::All, tolerance: 1e-12 }
    }
}

impl Which {
    pub(in crate::analysis) fn limit(self) -> usize {
        match self {
            Which::All => usize::MAX,
            Which::Lowest(count) => count,
        }
    }
}
