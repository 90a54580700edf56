//! Differences of close natural frequencies, heard as beats. In: certified modes. Out: for each two close neighbours,
//! the difference of their frequencies with a bound.
//!
//! Frequencies are known to 2^-102 of themselves, so a relative difference of 1e-14 still has 16 digits; the difference
//! of two printed numbers would have two. See docs/method/modes.md#beats.

use crate::analysis::answer::{Mode, ModeKind, Modes};
use crate::base::Ball;

/// Neighbours that differ by less than this part of their frequency are reported: their beat takes more than a hundred
/// cycles.
const CLOSE: f64 = 0.01;

/// Two neighbouring modes that are close but certainly distinct.
#[derive(Clone, Copy, Debug)]
pub struct Split {
    /// Number of the lower mode; the other is the next.
    pub lower: usize,
    /// omega of the upper mode minus omega of the lower one, rad/s; certainly positive.
    pub omega: Ball,
}

/// All close neighbours, ascending. Neighbours whose enclosures overlap are a cluster, and are reported as such
/// instead.
pub fn splits(modes: &Modes) -> Vec<Split> {
    let neighbours = modes.with_numbers().zip(modes.list.iter().skip(1));
    let close = |((lower, a), b): ((usize, &Mode), &Mode)| {
        let oscillate = a.kind == ModeKind::Oscillation && b.kind == ModeKind::Oscillation;
        let omega = b.omega - a.omega;
        let separate = oscillate && omega.is_positive() && omega.magnitude() <= CLOSE * b.omega.mignitude();
        separate.then_some(Split { lower, omega })
    };
    neighbours.filter_map(close).collect()
}
