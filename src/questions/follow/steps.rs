//! Steps from one value of the parameter to the next: which curves certainly keep their order. In: the frequencies at
//! both ends. Out: what is proved, and the evaluated places between them. See docs/method/studies.md#curves.

use super::Member;
use super::places::{Bounds, Field, Place, binary};
use crate::base::OrderBy;
use std::borrow::Cow;
use std::collections::VecDeque;

/// Limit on the halvings of a step.
const DEEPEST: u32 = 30;

/// The limits of a search.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Limit on the pieces of one step.
    pub stretches: usize,
}

/// A step.
#[derive(Clone, Debug, Default)]
pub struct Step {
    /// The places between its ends, in order.
    pub inner: Vec<Place>,
    /// Modes (class, index) for which it is not proved that the next one in their class is a different curve everywhere
    /// on the step.
    pub doubtful: Vec<Member>,
    /// Classes of which nothing is known somewhere on the step: the model may not depend continuously on the parameter there.
    pub unknown: Vec<usize>,
    /// Pairs of curves of different classes that may meet within the step.
    pub near: Vec<[usize; 2]>,
}

/// The properties to be decided for a piece of a step.
pub struct Look<'a> {
    pub curves: &'a [Member],
    /// Modes whose distance to the next one in their class is needed.
    pub pairs: Vec<Member>,
}

/// The step between two places.
pub fn step(field: &Field, look: &Look, limits: Limits, ends: [&Place; 2]) -> Step {
    let mut left = VecDeque::from([(Cow::Borrowed(ends[0]), Cow::Borrowed(ends[1]), 0)]);
    let (mut found, mut looked) = (Step::default(), 0);
    while let Some((low, high, depth)) = left.pop_front() {
        let bounds = field.bounds_between([&low, &high]);
        looked += 1;
        let doubtful = look.doubtful(&bounds);
        let near = look.near_curves(&bounds, [&low, &high]);
        let unknown: Vec<usize> = (0..bounds.len()).filter(|&class| bounds[class].is_none()).collect();
        let is_undecided = !doubtful.is_empty() || !near.is_empty() || !unknown.is_empty();
        let is_open = is_undecided || look.may_dip(&bounds, [&low, &high]);
        // If nothing is proved for any class, a few more halvings show whether a shorter piece has one form.
        let deepest = if bounds.iter().all(Option::is_none) { 4 } else { DEEPEST };
        let middle = match is_open && depth < deepest && looked + left.len() < limits.stretches {
            true => number_between(&low, &high).map(|at| field.place(&at, false)),
            false => None,
        };
        match middle {
            Some(middle) => {
                drop(bounds);
                left.push_back((low, Cow::Owned(middle.clone()), depth + 1));
                left.push_back((Cow::Owned(middle.clone()), high, depth + 1));
                found.inner.push(middle);
            }
            None => {
                found.doubtful.extend(doubtful);
                found.near.extend(near);
                found.unknown.extend(unknown);
            }
        }
    }
    let rises = ends[0].at.to_f64() < ends[1].at.to_f64();
    let key = |place: &Place| if rises { place.at.to_f64() } else { -place.at.to_f64() };
    found.inner.order_by(|a, b| key(a).total_cmp(&key(b)));
    found.doubtful.sort_unstable();
    found.doubtful.dedup();
    found.near.sort_unstable();
    found.near.dedup();
    found
}

/// A binary64 number that certainly lies between two places.
fn number_between(low: &Place, high: &Place) -> Option<crate::base::Number> {
    let [low, high] = [low, high].map(|place| place.at.to_f64());
    let middle = low + (high - low) / 2.0;
    (middle > low.min(high) && middle < low.max(high)).then(|| binary(middle)).flatten()
}

impl Look<'_> {
    fn doubtful(&self, bounds: &[Option<Bounds>]) -> Vec<Member> {
        let is_apart = |pair: &&Member| bounds[pair.class].as_ref().is_some_and(|own| own.are_apart(pair.index));
        self.pairs.iter().filter(|pair| !is_apart(pair)).copied().collect()
    }

    /// Whether two curves may come nearer than half of their distances at the ends.
    fn may_dip(&self, bounds: &[Option<Bounds>], [low, high]: [&Place; 2]) -> bool {
        let dips = |pair: &Member| {
            let least = bounds[pair.class].as_ref()?.distance(pair.index)?.to_f64();
            let seen =
                [low, high].map(|place| place.distance(pair.class, pair.index).map(|distance| distance.to_f64()));
            Some(least < 0.5 * seen[0]?.min(seen[1]?))
        };
        self.pairs.iter().any(|pair| dips(pair).unwrap_or(false))
    }

    /// Curves of different classes that keep their order at the ends, but may meet between them.
    fn near_curves(&self, bounds: &[Option<Bounds>], [low, high]: [&Place; 2]) -> Vec<[usize; 2]> {
        let mut list = Vec::new();
        for (i, a) in self.curves.iter().enumerate() {
            for (j, b) in self.curves.iter().enumerate().skip(i + 1).filter(|(_, b)| b.class != a.class) {
                let side = |place: &Place| {
                    Some((place.frequency(a.class, a.index)?, place.frequency(b.class, b.index)?)).map(|(a, b)| a - b)
                };
                let (Some(first), Some(last)) = (side(low), side(high)) else { continue };
                let keeps = first.is_positive() && last.is_positive() || first.is_negative() && last.is_negative();
                if keeps && !are_apart(bounds, [*a, *b]) {
                    list.push([i, j]);
                }
            }
        }
        list
    }
}

/// Whether one curve certainly stays above the other.
fn are_apart(bounds: &[Option<Bounds>], [a, b]: [Member; 2]) -> bool {
    let above = |a: Member, b: Member| {
        let lower = bounds[a.class].as_ref()?.lower.get(a.index).copied()??;
        let upper = bounds[b.class].as_ref()?.upper.get(b.index).copied()??;
        Some((lower - upper).is_positive())
    };
    above(a, b) == Some(true) || above(b, a) == Some(true)
}
