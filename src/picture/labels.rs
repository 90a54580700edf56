//! The places of names: near the glyph that they belong to and not on top of anything, with a thin leader if no place
//! nearby is free.

use super::figure::{Glyph, Kind, Label, Pen, Ride, Stroke};
use super::geometry::{Bounds, Point};
use super::occupied::Occupied;
use crate::base::Span;

/// A name that is to be written.
#[derive(Clone, Debug)]
pub struct Wanted {
    pub text: String,
    pub span: Option<Span>,
    /// The middle of the glyph that it belongs to, and half of the glyph's size.
    pub at: Point,
    pub half: Point,
    /// Preferred directions from there.
    pub best: Vec<Point>,
    pub ride: Ride,
    /// Whether it names an element or a joint, which lies between other glyphs.
    pub is_of_tie: bool,
}

/// The gap between a label and the glyph that it belongs to, px.
const GAP: f64 = 3.0;
/// A label further away than this gets a leader.
const NEAR: f64 = 9.0;
/// Tried distances beyond the nearest, px.
const STEPS: [f64; 13] = [0.0, 4.0, 9.0, 16.0, 24.0, 34.0, 46.0, 60.0, 78.0, 100.0, 126.0, 156.0, 190.0];

const H: f64 = 0.923_879_532_511_286_7;
const L: f64 = 0.382_683_432_365_089_8;
const D: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Directions that are tried after the best ones.
const ROUND: [Point; 16] = [
    Point::new(0.0, -1.0),
    Point::new(0.0, 1.0),
    Point::new(1.0, 0.0),
    Point::new(-1.0, 0.0),
    Point::new(D, -D),
    Point::new(-D, -D),
    Point::new(D, D),
    Point::new(-D, D),
    Point::new(H, -L),
    Point::new(-H, -L),
    Point::new(H, L),
    Point::new(-H, L),
    Point::new(L, -H),
    Point::new(-L, -H),
    Point::new(L, H),
    Point::new(-L, H),
];

/// Labels that have their places.
pub struct Placing<'a> {
    pub room: &'a mut Occupied,
    pub labels: Vec<Label>,
    pub leaders: Vec<Glyph>,
    /// Names that found no room.
    pub left_out: usize,
}

impl<'a> Placing<'a> {
    pub fn new(room: &'a mut Occupied) -> Placing<'a> {
        Placing { room, labels: Vec::new(), leaders: Vec::new(), left_out: 0 }
    }

    /// Places all labels in order, so that the first ones have the most choice.
    pub fn place(&mut self, wanted: Vec<Wanted>) {
        for wanted in wanted {
            let Some((label, leader)) = wanted.place(self.room) else {
                self.left_out += 1;
                continue;
            };
            if let Some(leader) = leader {
                self.room.take(&leader);
                self.leaders.push(leader);
            }
            self.room.take_name(&label.reserved_bounds());
            self.labels.push(label);
        }
    }
}

impl Wanted {
    fn place(&self, room: &Occupied) -> Option<(Label, Option<Glyph>)> {
        // First, places nearby without crossings; then those with a leader that crosses a glyph, but never another
        // name.
        for clear in [true, false] {
            for step in STEPS {
                for direction in self.best.iter().chain(&ROUND) {
                    let label = self.place_beside(*direction, step);
                    if !room.is_free(&label.reserved_bounds()) {
                        continue;
                    }
                    if step <= NEAR {
                        return Some((label, None));
                    }
                    let (from, to) = self.leader(&label);
                    if room.is_clear(to, from, 5.0, clear) {
                        return Some((label, Some(self.draw(from, to))));
                    }
                }
            }
        }
        None
    }

    /// The label in a direction, so far off that the boxes are a gap apart.
    fn place_beside(&self, direction: Point, further: f64) -> Label {
        let mut label = Label { text: self.text.clone(), at: self.at, span: self.span, ride: self.ride };
        let own = label.reserved_bounds();
        let apart = Point::new(
            self.half.x + own.width() / 2.0 + GAP + further,
            self.half.y + own.height() / 2.0 + GAP + further,
        );
        let along = |apart: f64, part: f64| if part.abs() > 1e-6 { apart / part.abs() } else { f64::INFINITY };
        label.at = self.at.towards(direction, along(apart.x, direction.x).min(along(apart.y, direction.y)));
        label
    }

    /// The line from the edge of the label to the edge of the glyph that it belongs to.
    fn leader(&self, label: &Label) -> (Point, Point) {
        let nearest = |bounds: Bounds, to: Point| {
            Point::new(to.x.clamp(bounds.low.x, bounds.high.x), to.y.clamp(bounds.low.y, bounds.high.y))
        };
        let to = nearest(Bounds::around(self.at, self.half), label.at);
        (nearest(label.reserved_bounds(), to), to)
    }

    fn draw(&self, from: Point, to: Point) -> Glyph {
        let strokes = vec![Stroke::line([from, to], Pen::Thin)];
        let rides = vec![(0, self.ride)];
        Glyph {
            kind: Kind::Leader,
            title: self.text.clone(),
            span: self.span,
            strokes,
            rides,
            item: None,
            ghost: false,
        }
    }
}
