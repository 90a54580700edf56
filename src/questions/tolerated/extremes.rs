//! The least and the largest value of a quantity for all values within the tolerances. In: the quantity, what it was at some places.
//! Out: bounds, and the places of the extremes that were reached. See docs/method/studies.md#tolerances.
//!
//! A parameter along which the quantity certainly rises, or falls, over a part of the box is put at the end where the extreme is. What
//! is left is bounded by the enclosure itself and by the mean value theorem, and cut where the bound is farthest beyond what was reached.

use super::boxes::{Boxes, Part, Sought, WHOLE};
use super::{EXCESS, EXCESS_OF_VALUE, MOST_PARTS};
use crate::base::{Ball, Number, up};
use crate::questions::answer::{Proved, Range, RangeProof};

/// With so few boxes, bounds come closer than they have to.
const FEW_PARTS: usize = 24;
const CLOSE: f64 = 0.01;

/// How long a bound is looked for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Until {
    /// It lies little beyond what was reached beside the width of the range, and on one side of a limit in its direction.
    Near(Option<f64>),
    /// It lies beyond what was reached by as little as the value is worth.
    Close,
}

/// The least and the largest value that was reached, and where.
#[derive(Clone, Debug)]
pub(super) struct Seen {
    pub ends: [(Ball, Vec<Number>); 2],
}

/// A part of the box with a bound of the quantity in it.
pub(super) struct Bounded {
    part: Part,
    /// In the direction of the extreme; infinite if nothing is known.
    pub bound: f64,
    /// The value at a place, if the extreme over the part is that.
    reached: Option<Ball>,
    /// How much the quantity may change along each parameter of the part.
    changes: Vec<f64>,
}

impl Seen {
    /// From values at places.
    pub fn of(values: impl IntoIterator<Item = (Ball, Vec<Number>)>) -> Option<Seen> {
        let mut values = values.into_iter();
        let first = values.next()?;
        let mut seen = Seen { ends: [first.clone(), first] };
        values.for_each(|(value, place)| seen.add(value, || place.clone()));
        Some(seen)
    }

    fn add(&mut self, value: Ball, place: impl Fn() -> Vec<Number>) {
        for (end, sign) in self.ends.iter_mut().zip([-1.0, 1.0]) {
            if sign * (value - end.0).mid.hi > 0.0 {
                *end = (value, place());
            }
        }
    }

    fn width(&self) -> f64 {
        (self.ends[1].0 - self.ends[0].0).mid.hi
    }

    /// What was reached, with nothing said about other values.
    pub fn without_proof(&self) -> Range {
        let [(low, low_at), (high, high_at)] = self.ends.clone();
        Range { ends: Some([low, high]), reached: Some([low, high]), at: Some([low_at, high_at]), proof: None }
    }
}

impl Boxes<'_> {
    /// The range of a quantity. With a limit, the search goes on until it is certain on which side of it all values are.
    pub fn range(&self, quantity: Sought, mut seen: Seen, limit: Option<Ball>) -> Range {
        self.begin();
        let mut ends = Vec::with_capacity(2);
        let mut count = 0;
        for sign in [-1.0, 1.0] {
            let limit = limit.map(|limit| sign * limit.to_f64());
            let (bound, boxes) = self.extreme(quantity, sign, &mut seen, Until::Near(limit));
            count += boxes;
            ends.push(bound);
        }
        let [(low, low_at), (high, high_at)] = seen.ends.clone();
        let (reached, at) = (Some([low, high]), Some([low_at, high_at]));
        match ends[..] {
            [Some((least, first)), Some((largest, second))] => {
                let proof = match first && second {
                    true => RangeProof::Corners(Proved(())),
                    false => RangeProof::Boxes(count, Proved(())),
                };
                Range { ends: Some([least, largest]), reached, at, proof: Some(proof) }
            }
            _ => seen.without_proof(),
        }
    }

    /// A bound of a quantity in a direction, and whether it is reached; the number of boxes that were looked at.
    pub fn extreme(&self, quantity: Sought, sign: f64, seen: &mut Seen, until: Until) -> (Option<(Ball, bool)>, usize) {
        let side = usize::from(sign > 0.0);
        let whole: Part = vec![[0, WHOLE]; self.corners.free.len()];
        let mut boxes = vec![self.bound_over(whole, quantity, sign, seen)];
        loop {
            let worst = (0..boxes.len()).max_by(|&a, &b| boxes[a].bound.total_cmp(&boxes[b].bound).then(b.cmp(&a)));
            let Some(worst) = worst else { return (None, 0) };
            let best = sign * seen.ends[side].0.to_f64();
            let found = &boxes[worst];
            let (share, limit) = match until {
                Until::Close => (0.0, None),
                Until::Near(limit) => (if boxes.len() < FEW_PARTS { CLOSE } else { EXCESS }, limit),
            };
            let is_open = limit.is_some_and(|limit| best < limit && found.bound >= limit);
            let allowed = share * seen.width() + EXCESS_OF_VALUE * best.abs();
            let is_done = found.reached.is_some() || found.bound - best <= allowed && !is_open;
            let cut = if is_done { None } else { halves(found) };
            let Some(halves) = cut.filter(|_| boxes.len() < MOST_PARTS && self.may_go_on()) else {
                return (outermost(&boxes, worst, sign).filter(|_| !self.strays()), boxes.len());
            };
            let [first, second] = halves.map(|part| self.bound_over(part, quantity, sign, seen));
            // What holds over the whole holds over its halves.
            let above = boxes[worst].bound;
            let within = |half: Bounded| Bounded { bound: half.bound.min(above), ..half };
            boxes[worst] = within(first);
            boxes.push(within(second));
        }
    }

    /// A bound of a quantity over a part of the box.
    pub fn bound_over(&self, mut part: Part, quantity: Sought, sign: f64, seen: &mut Seen) -> Bounded {
        let unknown = |part: Part| {
            let changes = self.changes(&part);
            Bounded { bound: f64::INFINITY, reached: None, changes, part }
        };
        loop {
            let free: Vec<usize> = (0..part.len()).filter(|&i| part[i][0] < part[i][1]).collect();
            let middle = Boxes::middle(&part);
            let here = self.at(&self.point(&middle), quantity);
            if let Some(value) = here {
                seen.add(value, || self.place(&middle));
            }
            if free.is_empty() {
                let Some(value) = here else {
                    return Bounded { bound: f64::INFINITY, reached: None, changes: Vec::new(), part };
                };
                return Bounded { part, bound: end(value, sign), reached: Some(value), changes: Vec::new() };
            }
            let Some(over) = self.enclose_over(&part, quantity) else { return unknown(part) };
            let mut is_less = false;
            for (&i, slope) in free.iter().zip(&over.slopes) {
                let falls = if sign > 0.0 { slope.is_negative() } else { slope.is_positive() };
                let rises = if sign > 0.0 { slope.is_positive() } else { slope.is_negative() };
                if slope.is_finite() && (rises || falls) || slope.is_zero() {
                    let at = part[i][usize::from(rises)];
                    part[i] = [at, at];
                    is_less = true;
                }
            }
            if is_less {
                continue;
            }
            let changes: Vec<f64> =
                free.iter().zip(&over.slopes).map(|(&i, slope)| slope.magnitude() * self.half(i, part[i])).collect();
            let farthest = changes.iter().fold(0.0, |sum, change| sum + change) * up::THOUSANDS;
            let by_mean = here.map_or(f64::INFINITY, |here| end(here, sign) + farthest);
            let by_mean = if by_mean.is_nan() { f64::INFINITY } else { by_mean.next_up() };
            return Bounded { bound: end(over.value, sign).min(by_mean), reached: None, changes, part };
        }
    }

    /// Half the width of a part of a parameter's range, SI.
    fn half(&self, parameter: usize, [low, high]: [u32; 2]) -> f64 {
        let ends = self.corners.free[parameter].within.as_ref();
        let whole = ends.map_or(0.0, |[low, high]| (high - low).to_ball().magnitude());
        whole * (f64::from(high - low) / f64::from(WHOLE)) * 0.5 * up::FEW
    }
}

/// The bound of all boxes, of which one has the outermost, and whether it is reached.
fn outermost(boxes: &[Bounded], worst: usize, sign: f64) -> Option<(Ball, bool)> {
    let bound = boxes[worst].bound;
    let Some(mut value) = boxes[worst].reached else {
        return bound.is_finite().then(|| (Ball::from(sign * bound), false));
    };
    for reached in boxes.iter().filter_map(|other| other.reached) {
        if sign * (reached - value).mid.hi > 0.0 {
            value = reached;
        }
    }
    let mut beyond = 0.0f64;
    for other in boxes.iter().filter(|other| other.bound > sign * value.to_f64()) {
        // As far as is known it may lie beyond the value, by its last digit.
        let Some(reached) = other.reached else { return Some((Ball::from(sign * bound), false)) };
        // A value that is less, but not known so well.
        if reached != value {
            let ahead = Ball::exact(reached.mid) - Ball::exact(value.mid);
            beyond = beyond.max((sign * ahead.mid.hi + ahead.rad + reached.rad) * up::FEW);
        }
    }
    Some((if beyond > value.rad { value.widen(beyond - value.rad) } else { value }, true))
}

/// The end of an enclosure in a direction, times it.
fn end(value: Ball, sign: f64) -> f64 {
    let end = sign * value.mid.hi + value.rad + value.mid.lo.abs();
    if end.is_nan() { f64::INFINITY } else { end.next_up().next_up() }
}

/// A part cut across the parameter along which the quantity may change most, or that is widest if that is not known; `None` if it is
/// too narrow to be cut.
fn halves(of: &Bounded) -> Option<[Part; 2]> {
    let free: Vec<usize> = (0..of.part.len()).filter(|&i| of.part[i][0] < of.part[i][1]).collect();
    let width = |i: usize| f64::from(of.part[i][1] - of.part[i][0]);
    let known = of.changes.len() == free.len() && of.changes.iter().all(|change| change.is_finite());
    let weight = |place: usize| if known { of.changes[place] } else { width(free[place]) };
    let most = (0..free.len()).max_by(|&a, &b| weight(a).total_cmp(&weight(b)).then(b.cmp(&a)))?;
    let i = free[most];
    let [low, high] = of.part[i];
    let middle = low + (high - low) / 2;
    let with = |ends: [u32; 2]| {
        let mut half = of.part.clone();
        half[i] = ends;
        half
    };
    (high - low >= 4).then(|| [with([low, middle]), with([middle, high])])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of two extremes over parts, the less may be known so badly that it is beyond the other.
    #[test]
    fn the_outermost_value_holds_what_others_may_be() {
        let reached = |value: f64, rad: f64, sign: f64| {
            let value = Ball::from(sign * value).widen(rad);
            Bounded { part: Vec::new(), bound: end(value, sign), reached: Some(value), changes: Vec::new() }
        };
        for sign in [-1.0, 1.0] {
            let boxes = [reached(2.0, 1e-9, sign), reached(1.999, 0.01, sign), reached(1.0, 0.5, sign)];
            let (value, is_reached) = outermost(&boxes, 1, sign).expect("bounded");
            // From 2 - 1e-9 to 1.999 + 0.01, outwards.
            assert!(is_reached && (sign * value.to_f64() - 2.0).abs() < 1e-12, "{value:?}");
            assert!((0.009..0.009_001).contains(&value.rad), "{value:?}");
            let boxes = [reached(2.0, 1e-9, sign), reached(1.0, 0.5, sign)];
            let (value, _) = outermost(&boxes, 0, sign).expect("bounded");
            assert!(value.rad < 1.1e-9, "{value:?}");
            let open = Bounded { part: Vec::new(), bound: 3.0, reached: None, changes: Vec::new() };
            let boxes = [reached(2.0, 1e-9, sign), open];
            assert_eq!(outermost(&boxes, 1, sign), Some((Ball::from(3.0 * sign), false)));
            assert_eq!(outermost(&boxes, 0, sign).map(|(_, is_reached)| is_reached), Some(false));
        }
    }
}
