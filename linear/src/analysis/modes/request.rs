//! The request that an analysis of modes answers.

/// The modes to compute, and their accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    pub which: Which,
    /// Largest relative bound that an omega^2 should have. If it is not reached, the modes come with the bounds that
    /// were reached.
    pub tolerance: f64,
    /// Relative bound that the user asked for, if any, of every frequency and pole; a larger bound is an error.
    pub asked: Option<f64>,
    /// Treat all independent parts as one. Splitting must not change a result; this option serves to compare.
    pub together: bool,
    /// Whether modes come with the shares of their energies, which nothing but a report of modes reads.
    pub shares: bool,
}

/// Larger bounds are reported even if no bound was asked for.
pub const DEFAULT_TOLERANCE: f64 = 1e-12;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Which {
    /// All modes, or the 20 lowest if all would take minutes.
    Usual,
    All,
    /// This many of the lowest modes, rigid ones included.
    Lowest(usize),
    /// The modes whose omega may lie in the band.
    Within(Band),
}

/// A range of omega, rad/s, ends included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    pub from: f64,
    pub to: f64,
}

/// Number of modes computed for a large system if none is requested.
pub const FEW: usize = 20;

impl Default for Request {
    fn default() -> Request {
        Request { which: Which::All, tolerance: DEFAULT_TOLERANCE, asked: None, together: false, shares: true }
    }
}

impl Request {
    /// This request with a relative error bound that must be met.
    pub fn within(self, tolerance: f64) -> Request {
        Request { tolerance: self.tolerance.min(tolerance), asked: Some(tolerance), ..self }
    }

    /// This request with up to `digits` digits computed.
    pub fn to_digits(self, digits: u32) -> Request {
        // Half a unit in the last of these digits.
        let tolerance = (0..digits).fold(0.5, |unit: f64, _| unit / 10.0);
        Request { tolerance: self.tolerance.min(tolerance), ..self }
    }

    /// This request for an answer that takes no shares of energies from its modes.
    pub fn without_shares(self) -> Request {
        Request { shares: false, ..self }
    }

    /// The limit that the bounds are compared with.
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
