//! A rod: a rounded bar to scale; and the thin rigid line by which a joint or an element holds a body at some distance.

use crate::picture::figure::{Pen, Stroke};
use crate::picture::geometry::{Point, spiral};
use std::f64::consts::PI;

/// Half of its width, px.
const HALF: f64 = 4.5;
const LINK: f64 = 2.0;

/// `arm`: from the middle to one end.
pub fn strokes(at: Point, arm: Point) -> Vec<Stroke> {
    vec![bar(at.minus(arm), at.plus(arm), HALF)]
}

pub fn link(from: Point, to: Point) -> Stroke {
    bar(from, to, LINK)
}

fn bar(a: Point, b: Point, half: f64) -> Stroke {
    let along = b.minus(a).unit().unwrap_or(Point::new(1.0, 0.0));
    // A half circle over the end at the right, turned into place.
    let cap = |at: Point, along: Point| {
        let half_circle = spiral(Point::default(), (half, half), (-PI / 2.0, PI / 2.0), 8);
        half_circle.into_iter().map(move |p| at.towards(along, p.x).towards(along.perpendicular(), p.y))
    };
    let mut points: Vec<Point> = cap(b, along).collect();
    points.extend(cap(a, along.times(-1.0)));
    Stroke::area(points, Pen::Body)
}
