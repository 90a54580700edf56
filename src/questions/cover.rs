//! The proof that a range contains no other root. In: the roots that were found, each between two numbers on different
//! sides, and information about the measure over parts of the range. Out: a proof, or the parts that could not be
//! settled, and parts in which roots were missed. See docs/method/measures.md.
//!
//! A part is settled if an enclosure of the measure does not contain the target, or if the measure is monotone there
//! and lies on the same side at both ends. Other parts are halved until the limit on evaluations is reached.

use super::range_enclosure::RangeEnclosure;
use crate::base::{Ball, Dd, OrderBy, two_to, up};
use std::cmp::Ordering;

/// A part of a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    pub low: Dd,
    pub high: Dd,
}

/// The status of the rest of a range, apart from the roots that were found.
#[derive(Clone, Debug, PartialEq)]
pub enum Rest {
    /// The range contains no other root.
    Empty(Proof),
    /// These parts were not settled; outside them there is no other root.
    Open(Vec<Part>),
    /// The measure cannot be enclosed over ranges: nothing is known beyond the values that were tried.
    Unknown,
}

/// Made only by [`cover`], if the whole range was settled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proof(());

/// Number of evaluations without any information, after which the measure counts as one that cannot be enclosed.
const SILENT: usize = 48;
/// Maximum number of parts that are reported.
const MOST_PARTS: usize = 8;

/// The measure as functions of parts and of numbers, which decide parts of a range.
pub struct Cover<'a> {
    /// The measure over a part.
    pub over: &'a dyn Fn(Ball) -> RangeEnclosure,
    /// The side of the target on which the measure certainly lies at a number; equal if that is not certain.
    pub side: &'a dyn Fn(Dd) -> Option<Ordering>,
    /// Maximum number of parts that are evaluated.
    pub most: usize,
}

/// The result of settling parts.
pub struct Covered {
    pub rest: Rest,
    /// Parts at whose ends the measure lies on different sides: they contain roots that were not known.
    pub missed: Vec<Part>,
    pub evaluations: usize,
}

impl Rest {
    /// A proof, if no part is left open.
    pub fn or_proof(self) -> Rest {
        match self {
            Rest::Open(parts) if parts.is_empty() => Rest::Empty(Proof(())),
            rest => rest,
        }
    }
}

impl Cover<'_> {
    /// Settles these parts, which lie between the brackets of the known roots.
    pub fn settle(&self, parts: Vec<Part>) -> Covered {
        let (mut open, mut missed) = (Vec::new(), Vec::new());
        let (mut evaluations, mut silent, mut heard) = (0, 0, false);
        // Breadth first, so that remaining parts are small everywhere.
        let mut waiting = std::collections::VecDeque::from(parts);
        while let Some(part) = waiting.pop_front() {
            if evaluations >= self.most || !heard && silent >= SILENT {
                open.push(part);
                continue;
            }
            evaluations += 1;
            let over = (self.over)(part.ball());
            if over.is_silent() {
                // Measures that can never be enclosed need no second evaluation.
                silent += if over.is_hopeless() { SILENT } else { 1 };
            } else {
                heard = true;
            }
            if over.excludes() {
                continue;
            }
            if over.is_monotone() {
                match ((self.side)(part.low), (self.side)(part.high)) {
                    (Some(a), Some(b)) if a == b && a != Ordering::Equal => continue,
                    (Some(a), Some(b)) if a == b.reverse() && a != Ordering::Equal => {
                        missed.push(part);
                        continue;
                    }
                    _ => {}
                }
            }
            match part.halves() {
                Some(halves) => waiting.extend(halves),
                None => open.push(part),
            }
        }
        let rest = match (heard, open.is_empty()) {
            (_, true) => Rest::Empty(Proof(())),
            (true, false) => Rest::Open(merge_parts(open)),
            (false, false) => Rest::Unknown,
        };
        Covered { rest, missed, evaluations }
    }
}

impl Part {
    /// A ball that contains the part.
    pub fn ball(&self) -> Ball {
        let middle = (self.low + self.high).scale(0.5);
        let radius = (self.high - middle).hi.abs().max((middle - self.low).hi.abs());
        Ball::exact(middle).widen(radius * up::FEW + middle.hi.abs() * two_to(-100))
    }

    /// The distance from a number to the part's far end.
    pub fn reach(&self, from: Dd) -> f64 {
        (self.low - from).abs().to_f64().max((self.high - from).abs().to_f64()) * up::FEW
    }

    /// `None` if no number lies between the ends.
    fn halves(&self) -> Option<[Part; 2]> {
        let middle = (self.low + self.high).scale(0.5);
        let width = (self.high - self.low).to_f64();
        let size = self.low.hi.abs().max(self.high.hi.abs());
        let between = middle > self.low && middle < self.high && width > size * two_to(-96);
        between.then_some([Part { low: self.low, high: middle }, Part { low: middle, high: self.high }])
    }
}

/// The parts in ascending order, adjacent ones merged; the narrowest gaps are closed if there are too many parts to
/// report.
pub fn merge_parts(mut parts: Vec<Part>) -> Vec<Part> {
    parts.order_by(|a, b| a.low.hi.total_cmp(&b.low.hi).then(a.low.lo.total_cmp(&b.low.lo)));
    let mut list: Vec<Part> = Vec::new();
    for part in parts {
        match list.last_mut() {
            Some(last) if last.high >= part.low => last.high = part.high,
            _ => list.push(part),
        }
    }
    while list.len() > MOST_PARTS {
        let gap = |i: usize| (list[i + 1].low - list[i].high).to_f64();
        let closest = (0..list.len() - 1).fold(0, |best, i| if gap(i) < gap(best) { i } else { best });
        list[closest].high = list[closest + 1].high;
        list.remove(closest + 1);
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The result of settling a range, for a measure with its derivative.
    fn settle_range(low: f64, high: f64, most: usize, f: impl Fn(Ball) -> (Ball, Ball)) -> Covered {
        let over = |x: Ball| {
            let (value, slope) = f(x);
            RangeEnclosure::sample(value, slope)
        };
        let side = |x: Dd| match f(Ball::exact(x)).0 {
            value if value.is_positive() => Some(Ordering::Greater),
            value if value.is_negative() => Some(Ordering::Less),
            _ => Some(Ordering::Equal),
        };
        Cover { over: &over, side: &side, most }.settle(vec![Part { low: Dd::from(low), high: Dd::from(high) }])
    }

    /// Whether one of the parts contains a number.
    fn hold(parts: &[Part], x: f64) -> bool {
        parts.iter().any(|part| part.low.to_f64() <= x && x <= part.high.to_f64())
    }

    fn square_less(two: f64) -> impl Fn(Ball) -> (Ball, Ball) {
        move |x| (x * x - Ball::from(two), x * Ball::from(2.0))
    }

    #[test]
    fn a_range_without_a_root_is_proven_to_have_none() {
        let covered = settle_range(1.5, 40.0, 1000, square_less(2.0));
        assert!(matches!(covered.rest, Rest::Empty(_)) && covered.missed.is_empty());
    }

    /// The measure differs from the target in an enclosure that covers half of a part, but not at its end.
    #[test]
    fn the_ends_of_a_part_belong_to_it() {
        let part = Part { low: Dd::from(1.0), high: Dd::from(3.0) };
        let ball = part.ball();
        assert!(ball.mid.hi - ball.rad <= 1.0 && ball.mid.hi + ball.rad >= 3.0, "{ball:?}");
    }

    /// Both roots of x^2 = 2, whichever halves they are in.
    #[test]
    fn roots_that_were_not_known_are_missed() {
        let covered = settle_range(-3.1, 4.3, 1000, square_less(2.0));
        for root in [2f64.sqrt(), -2f64.sqrt()] {
            assert!(hold(&covered.missed, root), "{:?}", covered.missed);
        }
    }

    /// (x - 1)^2 touches zero: the part around it stays open, however many are evaluated.
    #[test]
    fn a_double_root_stays_open() {
        let touches = |x: Ball| ((x - Ball::ONE).square(), (x - Ball::ONE) * Ball::from(2.0));
        for most in [0, 1, 3, 20, 100_000] {
            let covered = settle_range(-2.1, 3.3, most, touches);
            let open = match covered.rest {
                Rest::Open(parts) => hold(&parts, 1.0),
                Rest::Unknown => most == 0,
                Rest::Empty(_) => false,
            };
            assert!(open, "{most}");
        }
    }

    /// A monotone measure that is certainly on neither side excludes nothing.
    #[test]
    fn uncertain_sides_decide_nothing() {
        let blurred = |x: Ball| ((x - Ball::ONE).widen(10.0), Ball::ONE);
        let covered = settle_range(0.0, 2.0, 1000, blurred);
        assert!(matches!(&covered.rest, Rest::Open(parts) if hold(parts, 1.0)), "{:?}", covered.rest);
    }

    #[test]
    fn ranges_that_may_contain_zero_are_neither_excluded_nor_monotone() {
        let near = Ball::from(0.15).widen(0.2);
        assert!(!RangeEnclosure::sample(near, near).excludes() && !RangeEnclosure::sample(near, near).is_monotone());
        let far = Ball::from(0.25).widen(0.2);
        assert!(RangeEnclosure::sample(far, near).excludes() && RangeEnclosure::sample(near, far).is_monotone());
    }
}
