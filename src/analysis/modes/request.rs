//! What is asked of an analysis of modes.

/// Which modes, and how accurate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    pub which: Which,
    /// Relative bound that an omega^2 should have at most. Where it is not reached the modes come with the bounds that were.
    pub tolerance: f64,
    /// Relative bound that a user asked for of every frequency and pole, where one did: what is above it is an error.
    pub asked: Option<f64>,
    /// Solve all independent parts as one: what the parts save is measured against this, and must not change a result.
    pub together: bool,
}

/// Larger bounds are reported without having been asked for.
pub const DEFAULT_TOLERANCE: f64 = 1e-12;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Which {
    /// All of them, or the 20 lowest where all would take minutes.
    Usual,
    All,
    /// So many of the lowest, rigid motions included.
    Lowest(usize),
    /// Those whose omega may lie in the band.
    Within(Band),
}

/// From one omega to another, rad/s, ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    pub from: f64,
    pub to: f64,
}

/// Modes of a large system that are computed where nothing is said.
pub const FEW: usize = 20;

impl Default for Request {
    fn default() -> Request {
        Request { which: Which::All, tolerance: DEFAULT_TOLERANCE, asked: None, together: false }
    }
}

impl Request {
    /// This request with a relative error bound that must be met.
    pub fn within(self, tolerance: f64) -> Request {
        Request { tolerance: self.tolerance.min(tolerance), asked: Some(tolerance), ..self }
    }

    /// This request with up to `digits` digits computed.
    pub fn to_digits(self, digits: u32) -> Request {
        // Half a unit in the last of them.
        let tolerance = (0..digits).fold(0.5, |unit: f64, _| unit / 10.0);
        Request { tolerance: self.tolerance.min(tolerance), ..self }
    }

    /// What the bounds are held against.
    pub fn limit(&self) -> f64 {
        self.asked.unwrap_or(DEFAULT_TOLERANCE)
    }
}

impl Band {
    /// Whether omega^2 within `radius` of `value` may be in the band.
    pub(in crate::analysis) fn may_hold(self, value: f64, radius: f64) -> bool {
        // Each end was rounded a few times, the value once.
        let slack = 8.0 * f64::EPSILON;
        let low = self.from * self.from * (1.0 - slack);
        let high = self.to * self.to * (1.0 + slack);
        value + radius >= low && value - radius <= high
    }
}

impl Which {
    pub(in crate::analysis) fn limit(self) -> usize {
        match self {
            Which::All | Which::Within(_) => usize::MAX,
            Which::Usual => FEW,
            Which::Lowest(count) => count,
        }
    }
}
