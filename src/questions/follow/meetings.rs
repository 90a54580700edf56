//! Places where curves come near each other: veerings, the least distances between curves of one class, and crossings
//! of curves of different classes. In: the frequencies at all places in order. Out: each veering and crossing with its
//! enclosed place. See docs/method/studies.md#curves.

use super::by_class::Between;
use super::places::{Field, Place, binary};
use super::{Meeting, MeetingKind, Member};
use crate::base::{Ball, Number};
use crate::questions::answer::Proved;
use crate::questions::tolerated::hull;

/// Number of neighbours searched for one that is certainly farther away.
const MOST_NEIGHBOURS: usize = 8;
/// Steps of one search; each shortens the interval by at least a third.
const MOST_STEPS: usize = 200;

/// The veerings between a curve and the next one of its class.
pub fn veerings(field: &Field, places: &[&Place], member: Member, curves: [usize; 2]) -> Vec<Meeting> {
    let distances: Vec<Option<Ball>> = places.iter().map(|place| place.distance(member.class, member.index)).collect();
    let distance = |i: usize| *distances.get(i)?;
    let (mut list, mut after) = (Vec::new(), 0);
    for i in 1..places.len().saturating_sub(1) {
        let (Some(before), Some(own), Some(next)) = (distance(i - 1), distance(i), distance(i + 1)) else { continue };
        if i < after || !(own.mid < before.mid && own.mid <= next.mid) {
            continue;
        }
        let farther = |j: &usize| distance(*j).is_some_and(|other| (other - own).is_positive());
        let first = (i.saturating_sub(MOST_NEIGHBOURS)..i).rev().find(farther);
        let last = (i + 1..places.len().min(i + 1 + MOST_NEIGHBOURS)).find(farther);
        if let (Some(first), Some(last)) = (first, last) {
            after = last;
            list.extend(veering(field, member, curves, [first, i, last].map(|i| places[i].x)));
        }
    }
    list
}

/// The golden section of the longer one of two intervals.
fn golden_section([(first, _), (middle, _), (last, _)]: &[Seen; 3]) -> f64 {
    let farther = if (last - middle).abs() > (middle - first).abs() { last } else { first };
    middle + 0.381_966 * (farther - middle)
}

/// The next place to look at, by the parabola through three: its vertex, which is where the least distance soon is, if both ends are about as
/// near to the middle; otherwise a place on the longer side a few times as far from the middle as the vertex, behind which the distance is
/// larger again. `None` where no nearer place is certainly farther.
fn near_vertex(three: &[Seen; 3]) -> Option<f64> {
    let [(first, before), (middle, own), (last, behind)] = *three;
    let (s, t) = (first - middle, last - middle);
    let rises = [(before - own).to_f64() / s, (behind - own).to_f64() / t];
    let curvature = (rises[0] - rises[1]) / (s - t);
    let vertex = -0.5 * (rises[0] - curvature * s) / curvature;
    // Nearer to the vertex the distance rises by less than is known of it, or places are no other numbers.
    let least = 4.0 * (2.0 * own.rad / curvature).sqrt() + 8.0 * f64::EPSILON * middle.abs();
    let (longer, shorter) = if t.abs() > s.abs() { (t, s) } else { (s, t) };
    let reach = (4.0 * vertex.abs()).max(least);
    let at = match () {
        () if longer.abs() > 2.0 * reach => middle + reach * longer.signum(),
        () if vertex.abs() > least => middle + vertex,
        () if longer.abs() > 2.0 * least && longer.abs() > 2.0 * shorter.abs() => golden_section(three),
        () => return None,
    };
    at.is_finite().then_some(at)
}

/// A place, and the distance of two curves there.
type Seen = (f64, Ball);

/// The least distance between the outer two of three places; at the middle one the distance is certainly smaller than
/// at the ends.
fn veering(field: &Field, member: Member, curves: [usize; 2], places: [f64; 3]) -> Option<Meeting> {
    let distance = |x: f64| field.place(&binary(x)?, true).distance(member.class, member.index);
    let seen = |x: f64| Some((x, distance(x)?));
    let [first, middle, last] = places;
    let mut three = [seen(first)?, seen(middle)?, seen(last)?];
    let own = three[1].1;
    if ![three[0], three[2]].iter().all(|(_, other)| (*other - own).is_positive()) {
        return None;
    }
    let mut is_smooth = true;
    for _ in 0..MOST_STEPS {
        let next = if is_smooth { near_vertex(&three) } else { Some(golden_section(&three)) };
        let Some(other) = next.filter(|x| *x != three[1].0).and_then(seen) else { break };
        // On the side of the last place, or of the first one.
        let side = if (other.0 > three[1].0) == (three[2].0 > three[1].0) { 2 } else { 0 };
        let own = three[1].1;
        match ((own - other.1).is_positive(), (other.1 - own).is_positive()) {
            (true, _) => (three[2 - side], three[1]) = (three[1], other),
            (_, true) => three[side] = other,
            _ if is_smooth => is_smooth = false,
            _ => break,
        }
    }
    let [(first, _), (_, own), (last, _)] = three;
    let ends = [binary(first)?, binary(last)?];
    let between = field.bounds([&ends[0], &ends[1]]);
    let apart = between.class(member.class).and_then(|bounds| {
        let least = bounds.distance(member.index).filter(|least| least.is_positive())?;
        Some((least, hull(bounds.lower[member.index]?, bounds.upper[member.index + 1]?)))
    });
    let kind = match apart {
        Some((least, frequency)) => MeetingKind::Veering { distance: hull(least, own), frequency, proof: Proved(()) },
        None => MeetingKind::Undecided { distance: Some(own) },
    };
    Some(Meeting { curves, place: [first, last], kind })
}

/// A place where one number passes another, and their value there if that is proved.
#[derive(Clone, Debug)]
pub struct Passage {
    pub place: [f64; 2],
    pub value: Option<Ball>,
}

/// Two numbers that depend on the parameter.
pub struct Two<'a> {
    /// Whether the first is certainly above the second, or below it; the outer `None` means that one of them does not
    /// exist.
    pub side: &'a dyn Fn(&Place) -> Option<Option<bool>>,
    /// An enclosure of the first number between two places; `None` if continuity there is not proved.
    pub value: &'a dyn Fn([&Number; 2]) -> Option<Ball>,
}

/// The crossings of two curves of different classes, and the places where their order is not certain.
pub fn crossings(field: &Field, places: &[&Place], of: [Member; 2], curves: [usize; 2]) -> Vec<Meeting> {
    let value = |ends: [&Number; 2]| {
        let between = field.bounds(ends);
        enclose(&between, of[1]).and(enclose(&between, of[0]))
    };
    let meeting = |passage: Passage| Meeting {
        curves,
        place: passage.place,
        kind: match passage.value {
            Some(frequency) => MeetingKind::Crossing { frequency, proof: Proved(()) },
            None => MeetingKind::Undecided { distance: None },
        },
    };
    let two = Two { side: &|place| side(place, of), value: &value };
    passages(field, places, &two).into_iter().map(meeting).collect()
}

/// Places where two numbers pass each other, and places where their order is not certain.
pub fn passages(field: &Field, places: &[&Place], two: &Two) -> Vec<Passage> {
    let mut list = Vec::new();
    let open = |ends: [usize; 2]| Passage { place: ends.map(|i| places[i].x), value: None };
    // The last place where the order is certain, and the first place after it where it is not.
    let (mut certain, mut doubtful): (Option<(usize, bool)>, Option<usize>) = (None, None);
    for (i, place) in places.iter().enumerate() {
        let Some(sign) = (two.side)(place) else {
            (certain, doubtful) = (None, None);
            continue;
        };
        let Some(above) = sign else {
            doubtful = doubtful.or(Some(i));
            continue;
        };
        match (certain, doubtful) {
            (Some((last, was)), _) if was != above => {
                list.push(passage(field, two, [last, i].map(|i| places[i].x), was));
            }
            (_, Some(first)) => list.push(open([first, i - 1])),
            _ => {}
        }
        (certain, doubtful) = (Some((i, above)), None);
    }
    list.extend(doubtful.map(|first| open([first, places.len() - 1])));
    list
}

/// Encloses a passage between two places: the first number is certainly above the other at the first of them (`above`), and below at
/// the second, or the reverse. Numbers that are continuous between them meet there.
fn passage(field: &Field, two: &Two, ends: [f64; 2], above: bool) -> Passage {
    let at = |x: f64| (two.side)(&field.place(&binary(x)?, true))?;
    if at(ends[0]) != Some(above) || at(ends[1]) != Some(!above) {
        return Passage { place: ends, value: None };
    }
    let place = super::narrow(ends, |x| Some(at(x)? == above));
    let value = match place.map(binary) {
        [Some(low), Some(high)] => (two.value)([&low, &high]),
        _ => None,
    };
    Passage { place, value }
}

/// A curve between two places.
pub fn enclose(between: &Between, of: Member) -> Option<Ball> {
    let own = between.class(of.class)?;
    Some(hull((*own.lower.get(of.index)?)?, (*own.upper.get(of.index)?)?))
}

pub fn undecided_meeting(curves: [usize; 2], ends: [&Place; 2]) -> Meeting {
    Meeting { curves, place: ends.map(|place| place.x), kind: MeetingKind::Undecided { distance: None } }
}

/// Whether the first of two curves is certainly above the second, or below; the outer `None` if one has no frequency, or both are
/// rigid.
fn side(place: &Place, [a, b]: [Member; 2]) -> Option<Option<bool>> {
    let (a, b) = (place.frequency(a.class, a.index)?, place.frequency(b.class, b.index)?);
    let apart = a - b;
    match (apart.is_positive(), apart.is_negative()) {
        _ if a.is_zero() && b.is_zero() => None,
        (false, false) => Some(None),
        (above, _) => Some(Some(above)),
    }
}
