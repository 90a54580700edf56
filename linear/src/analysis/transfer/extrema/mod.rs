//! Peaks and antiresonances of |H|, all of them. In: a system, an input, an output and a range. Out: each extremum with its
//! frequency, its value and its half-power width as enclosures, and whether it is proved that there are no others.
//! See docs/method/transfer.md#extrema.

mod bracketed;
mod expanded;
mod expansion;
mod far;
mod fraction;
mod jet;
mod path;
mod point;
mod roots;
mod search;
mod slope;
mod supremum;

pub use bracketed::{bracket, sharpen};
pub use expanded::by_expansion;
pub(in crate::analysis) use fraction::MOST_ENCLOSED;
pub(in crate::analysis) use fraction::Quotient;
pub(in crate::analysis) use fraction::coordinates_between;
pub use fraction::{Denominator, Factored};
pub(in crate::analysis) use path::by_path;
pub use point::Exactly;
pub(in crate::analysis) use roots::{Coefficients, Place, near_and_far};
pub(in crate::analysis) use slope::{Over, product};
pub use supremum::{Supremum, supremum};

use crate::analysis::transfer::Gain;
use crate::base::{Ball, OrderBy};

/// A peak or an antiresonance.
#[derive(Clone, Debug)]
pub struct Extremum {
    pub kind: FeatureKind,
    /// Hz
    pub frequency: Ball,
    pub gain: Gain,
    /// The distance of the two frequencies at which |H| is its peak over the root of 2, Hz; `None` if |H| rises again
    /// before.
    pub width: Option<Ball>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeatureKind {
    Peak,
    Antiresonance,
}

impl FeatureKind {
    /// The name in JSON and in reports.
    pub fn name(self) -> &'static str {
        match self {
            FeatureKind::Peak => "peak",
            FeatureKind::Antiresonance => "antiresonance",
        }
    }
}

/// Proof that no extremum in the range is missing. Only the search makes it, when every interval of the range is
/// settled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Complete(());

/// The extrema of one pair of input and output.
#[derive(Clone, Debug, Default)]
pub struct Extrema {
    pub list: Vec<Extremum>,
    pub complete: Option<Complete>,
    /// Ranges in which there may be other extrema, Hz, from and to.
    pub open: Vec<(f64, f64)>,
}

impl Extrema {
    /// Whether it is proved that none is missing.
    pub fn is_complete(&self) -> bool {
        self.complete.is_some()
    }

    /// Adds extrema that another method has enclosed.
    pub(in crate::analysis) fn with(mut self, others: Vec<Extremum>) -> Extrema {
        let known = |list: &[Extremum], other: &Extremum| {
            list.iter().any(|extremum| (extremum.frequency - other.frequency).contains_zero())
        };
        for other in others {
            if !known(&self.list, &other) {
                self.list.push(other);
            }
        }
        self.list.order_by(|a, b| a.frequency.to_f64().total_cmp(&b.frequency.to_f64()));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::analysis::transfer::Gain;

    #[test]
    fn a_feature_found_by_two_methods_is_listed_once() {
        let at = |hertz: f64| Extremum {
            kind: FeatureKind::Peak,
            frequency: Ball::from(hertz).widen(1e-12),
            gain: Gain::Infinite,
            width: None,
        };
        let list = Extrema { list: vec![at(2.0)], complete: None, open: Vec::new() };
        let all = list.with(vec![at(2.0 + 1e-13), at(1.0)]).list;
        assert_eq!(all.iter().map(|e| e.frequency.to_f64()).collect::<Vec<f64>>(), [1.0, 2.0]);
    }
}
