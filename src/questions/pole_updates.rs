//! All poles of a system in which the weight of one square changes. In: a system and the change. Out: the enclosed poles for many
//! values of the weight. See docs/method/studies.md#one-weight-and-all-poles.

use super::updates::{self, Changing, Part, ROUNDING_OF_CHANGE};
use crate::analysis::Feedback;
use crate::base::Ball;
use crate::kernel::rank_one::{Eigenvalue, Factor, RankOne};
use crate::system::LinearSystem;

/// The unit roundoff.
const U: f64 = f64::EPSILON / 2.0;

/// A system near one of its cases.
#[derive(Clone, Debug)]
pub struct PoleUpdates {
    part: Part,
    slope: Ball,
    /// For a weight of M, what the acceleration feeds back at once for a weight of 1.
    direct: Ball,
    matrix: RankOne,
}

impl PoleUpdates {
    /// `end` is the change of the parameter with the largest magnitude, and all changes have its sign. `None` if several
    /// squares change, or the poles at the base are not known well enough.
    pub fn of(base: &LinearSystem, changing: &[Changing], end: f64) -> Option<PoleUpdates> {
        let [of] = changing else { return None };
        let power = match of.part {
            Part::Stiffness => 0,
            Part::Damping => 1,
            Part::Mass => 2,
        };
        let feedback = Feedback::of(base, &of.row, power)?;
        let (slope, direct) = (of.slope, feedback.direct);
        let end = PoleUpdates::factor(slope, direct, of.part, end).0;
        let matrix = RankOne::new(&feedback.poles, feedback.off, end)?;
        Some(PoleUpdates { part: of.part, slope, direct, matrix })
    }

    /// The change up to which relative bounds are at most `accuracy`, where that was tried.
    pub fn reach(&self, accuracy: f64) -> f64 {
        let rho = self.matrix.reach(accuracy);
        let weight = match self.part {
            Part::Stiffness | Part::Damping => rho,
            Part::Mass => rho / (1.0 - rho * self.direct.to_f64()),
        };
        weight / self.slope.to_f64()
    }

    /// The poles for each change of the parameter in the order of `analyze`; `None` where they are not all enclosed. A change may have
    /// an error of [`ROUNDING_OF_CHANGE`].
    pub fn poles(&self, changes: &[f64]) -> Vec<Option<Vec<Eigenvalue>>> {
        let factor = |change: &f64| {
            let (rho, error) = PoleUpdates::factor(self.slope, self.direct, self.part, *change);
            Factor::new(rho, error)
        };
        self.matrix.eigenvalues(&changes.iter().map(factor).collect::<Vec<_>>())
    }

    /// The factor of the square in the equation of the poles, and a bound of its relative error.
    fn factor(slope: Ball, direct: Ball, part: Part, change: f64) -> (f64, f64) {
        let weight = change * slope.to_f64();
        let error = slope.relative_error() + 2.0 * U + ROUNDING_OF_CHANGE + 2.0 * U;
        match part {
            Part::Stiffness | Part::Damping => (weight, error),
            // M falls by the negative of the weight.
            Part::Mass => {
                let (rho, error) = updates::of_mass(-weight, error, direct);
                (-rho, error)
            }
        }
    }
}
