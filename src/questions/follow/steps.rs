//! Steps from one value of the parameter to the next: which curves certainly keep their order. In: the frequencies at
//! both ends. Out: what is proved, and the evaluated places between them. See docs/method/studies.md#curves.

use super::Member;
use super::by_class::{Between, ByClass};
use super::places::{Field, Place, binary};
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

/// The step between two places, with bounds over all of it where they are known already; `None` if everything is proved about it at once.
pub fn step(
    field: &Field,
    look: &Look,
    limits: Limits,
    ends: [&Place; 2],
    over: Option<&[ByClass; 2]>,
) -> Option<Box<Step>> {
    let over = match over {
        Some([lower, upper]) => Between::Known([lower, upper]),
        None => field.bounds_between(ends),
    };
    if look.is_settled(&over, ends) {
        return None;
    }
    let mut known = Some(over);
    let mut left = VecDeque::from([(Cow::Borrowed(ends[0]), Cow::Borrowed(ends[1]), 0)]);
    let (mut found, mut looked) = (Step::default(), 0);
    while let Some((low, high, depth)) = left.pop_front() {
        let between = known.take().unwrap_or_else(|| field.bounds_between([&low, &high]));
        looked += 1;
        let doubtful: Vec<Member> = look.doubtful(&between).collect();
        let near: Vec<[usize; 2]> = look.near_curves(&between, [&low, &high]).collect();
        let unknown: Vec<usize> = between.unknown().collect();
        let is_open = !look.is_settled(&between, [&low, &high]);
        // If nothing is proved for any class, a few more halvings show whether a shorter piece has one form.
        let deepest = if between.is_unknown() { 4 } else { DEEPEST };
        let middle = match is_open && depth < deepest && looked + left.len() < limits.stretches {
            true => number_between(&low, &high).map(|at| field.place(&at, false)),
            false => None,
        };
        match middle {
            Some(middle) => {
                drop(between);
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
    let rises = ends[0].x < ends[1].x;
    let key = |place: &Place| if rises { place.x } else { -place.x };
    found.inner.order_by(|a, b| key(a).total_cmp(&key(b)));
    found.doubtful.sort_unstable();
    found.doubtful.dedup();
    found.near.sort_unstable();
    found.near.dedup();
    Some(Box::new(found))
}

/// A binary64 number that certainly lies between two places.
fn number_between(low: &Place, high: &Place) -> Option<crate::base::Number> {
    let [low, high] = [low, high].map(|place| place.x);
    let middle = low + (high - low) / 2.0;
    (middle > low.min(high) && middle < low.max(high)).then(|| binary(middle)).flatten()
}

impl Look<'_> {
    /// Whether nothing is left to be decided between two places.
    fn is_settled(&self, between: &Between, ends: [&Place; 2]) -> bool {
        between.unknown().next().is_none()
            && self.doubtful(between).next().is_none()
            && !self.may_dip(between, ends)
            && self.near_curves(between, ends).next().is_none()
    }

    fn doubtful(&self, between: &Between) -> impl Iterator<Item = Member> {
        let is_apart = |pair: &&Member| between.class(pair.class).is_some_and(|own| own.are_apart(pair.index));
        self.pairs.iter().filter(move |pair| !is_apart(pair)).copied()
    }

    /// Whether two curves may come nearer than half of their distances at the ends.
    fn may_dip(&self, between: &Between, [low, high]: [&Place; 2]) -> bool {
        let dips = |pair: &Member| {
            let least = between.class(pair.class)?.distance(pair.index)?.to_f64();
            let seen = |place: &Place| place.approximate_distance(pair.class, pair.index);
            Some(least < 0.5 * seen(low)?.min(seen(high)?))
        };
        self.pairs.iter().any(|pair| dips(pair).unwrap_or(false))
    }

    /// Curves of different classes that keep their order at the ends, but may meet between them.
    fn near_curves(&self, between: &Between, [low, high]: [&Place; 2]) -> impl Iterator<Item = [usize; 2]> {
        let is_near = move |a: &Member, b: &Member| {
            let side = |place: &Place| Some(place.frequency(a.class, a.index)? - place.frequency(b.class, b.index)?);
            let (Some(first), Some(last)) = (side(low), side(high)) else { return false };
            let keeps = first.is_positive() && last.is_positive() || first.is_negative() && last.is_negative();
            keeps && !are_apart(between, [*a, *b])
        };
        self.curves.iter().enumerate().flat_map(move |(i, a)| {
            let others = self.curves.iter().enumerate().skip(i + 1).filter(|(_, b)| b.class != a.class);
            others.filter(move |(_, b)| is_near(a, b)).map(move |(j, _)| [i, j])
        })
    }
}

/// Whether one curve certainly stays above the other.
fn are_apart(between: &Between, [a, b]: [Member; 2]) -> bool {
    let above = |a: Member, b: Member| {
        let lower = between.class(a.class)?.lower.get(a.index).copied()??;
        let upper = between.class(b.class)?.upper.get(b.index).copied()??;
        Some((lower - upper).is_positive())
    };
    above(a, b) == Some(true) || above(b, a) == Some(true)
}
