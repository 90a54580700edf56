//! Differences of close natural frequencies: what is heard as a beat. In: certified modes. Out: for each two neighbours that
//! are close, how far they are apart, with a bound.
//!
//! Frequencies are known to 2^-102 of themselves, so a difference of 1e-14 of them still has 16 digits; the difference of
//! two printed numbers would have two. See docs/method/modes.md#beats.

use crate::analysis::answer::{Mode, ModeKind, Modes};
use crate::base::Ball;

/// Neighbours closer than this part of their frequency are reported: their beat takes more than a hundred cycles.
const CLOSE: f64 = 0.01;

/// Two neighbouring modes that are close but certainly apart.
#[derive(Clone, Copy, Debug)]
pub struct Split {
    /// The lower one's number; the other is the next.
    pub lower: usize,
    /// omega of the upper less omega of the lower mode, rad/s; certainly positive.
    pub omega: Ball,
}

/// All close neighbours, ascending. Those whose enclosures overlap are a cluster, and told as such.
pub fn splits(modes: &Modes) -> Vec<Split> {
    let neighbours = modes.numbered().zip(modes.list.iter().skip(1));
    let close = |((lower, a), b): ((usize, &Mode), &Mode)| {
        let oscillate = a.kind == ModeKind::Oscillation && b.kind == ModeKind::Oscillation;
        let omega = b.omega - a.omega;
        let told = oscillate && omega.is_positive() && omega.magnitude() <= CLOSE * b.omega.mignitude();
        told.then_some(Split { lower, omega })
    };
    neighbours.filter_map(close).collect()
}
