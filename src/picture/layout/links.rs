//! The ends of elements on the page: elements between the same two points lie side by side, and all of them end at the
//! outlines of the parts that they connect.

use super::outline::own_axes;
use super::parts::GROUND;
use super::{Foot, Link, Outline, Placed};
use crate::picture::geometry::Point;
use std::collections::BTreeMap;

/// The points that an element ties, before it is set beside others.
#[derive(Clone, Copy, Debug)]
pub struct Tie {
    pub parts: [usize; 2],
    pub at: [Point; 2],
    /// Drawn round one point.
    pub round: bool,
    /// Between its axis and that of one beside it, px.
    pub side: f64,
}

/// The key of elements that lie side by side: the two parts and points, the smaller part first.
type Bundle = [(usize, i64, i64); 2];

impl Tie {
    fn bundle(&self) -> Bundle {
        /// Points closer than this are one, px.
        const SAME: f64 = 0.5;
        let whole = |x: f64| (x / SAME).round() as i64;
        let key = |end: usize| (self.parts[end], whole(self.at[end].x), whole(self.at[end].y));
        let (a, b) = (key(0), key(1));
        if a <= b { [a, b] } else { [b, a] }
    }

    fn is_turned_round(&self) -> bool {
        let bundle = self.bundle();
        (self.parts[0], self.parts[1]) != (bundle[0].0, bundle[1].0)
    }
}

/// For each element, its number among those beside it, and how many of them there are.
pub fn places(ties: &[Tie]) -> Vec<(usize, usize)> {
    let mut count: BTreeMap<Bundle, usize> = BTreeMap::new();
    let numbers: Vec<(Bundle, usize)> = ties
        .iter()
        .map(|tie| {
            let bundle = tie.bundle();
            let number = count.entry(bundle).or_insert(0);
            *number += 1;
            (bundle, *number - 1)
        })
        .collect();
    numbers.into_iter().map(|(bundle, number)| (number, count[&bundle])).collect()
}

/// The elements with their ends.
pub fn links(ties: &[Tie], placed: &[Placed]) -> Vec<Link> {
    ties.iter().zip(places(ties)).map(|(tie, (number, of))| link(tie, number, of, placed)).collect()
}

fn link(tie: &Tie, number: usize, of: usize, placed: &[Placed]) -> Link {
    let direction = tie.at[1].minus(tie.at[0]).unit();
    let (Some(direction), false) = (direction, tie.round) else {
        let foot = |end: usize| Foot {
            part: tie.parts[end],
            at: tie.at[end],
            lead: Vec::new(),
            wall: (tie.parts[end] == GROUND).then_some(Point::new(0.0, 1.0)),
        };
        return Link { feet: [foot(0), foot(1)], round: Some(number) };
    };
    let mut offset = (number as f64 - (of as f64 - 1.0) / 2.0) * tie.side;
    if tie.is_turned_round() {
        offset = -offset;
    }
    let aside = direction.perpendicular().times(offset);
    let foot = |end: usize, inwards: Point| -> Foot {
        let (part, point) = (tie.parts[end], tie.at[end]);
        let beside = point.plus(aside);
        if part == GROUND {
            return Foot { part, at: beside, lead: Vec::new(), wall: Some(inwards.times(-1.0)) };
        }
        let Placed { at: centre, outline, .. } = &placed[part];
        let inside = beside.minus(*centre);
        let reach = outline.reach(inside, inwards);
        let ends_at_it = reach > 0.0 || offset == 0.0 || is_at(outline, inside);
        let lead = if ends_at_it { Vec::new() } else { vec![point] };
        Foot { part, at: beside.towards(inwards, reach), lead, wall: None }
    };
    Link { feet: [foot(0, direction), foot(1, direction.times(-1.0))], round: None }
}

/// Whether a point lies on an outline at which several elements end.
fn is_at(outline: &Outline, point: Point) -> bool {
    match outline {
        Outline::Plate { along, half } => point.dot(along.perpendicular()).abs() <= *half,
        Outline::Block { half } => point.x.abs() <= half.x + 0.5 && point.y.abs() <= half.y + 0.5,
        Outline::Box { half, along } => {
            let point = own_axes(*along, point);
            point.x.abs() <= half.x + 0.5 && point.y.abs() <= half.y + 0.5
        }
        _ => false,
    }
}
