//! Arrows: straight, double and curved.

use crate::picture::figure::{Pen, Stroke};
use crate::picture::geometry::{Point, arc};
use std::f64::consts::PI;

/// Length and half width of a head, px.
const HEAD: f64 = 8.0;
const WIDE: f64 = 3.2;

/// Distances at which an arrow is tried, px, from near to far.
pub fn offsets(first: f64) -> impl Iterator<Item = f64> + Clone {
    (0..16).map(move |k| first + f64::from(k) * (7.0 + 0.7 * f64::from(k)))
}

pub fn head(tip: Point, along: Point) -> Stroke {
    let back = tip.towards(along, -HEAD);
    Stroke::area(
        [tip, back.towards(along.perpendicular(), WIDE), back.towards(along.perpendicular(), -WIDE)],
        Pen::Solid,
    )
}

pub fn single(from: Point, to: Point, pen: Pen) -> Vec<Stroke> {
    let along = to.minus(from).unit().unwrap_or(Point::new(1.0, 0.0));
    vec![Stroke::line([from, to.towards(along, -HEAD * 0.7)], pen), head(to, along)]
}

pub fn double(a: Point, b: Point, pen: Pen) -> Vec<Stroke> {
    let along = b.minus(a).unit().unwrap_or(Point::new(1.0, 0.0));
    let inner = [a.towards(along, HEAD * 0.7), b.towards(along, -HEAD * 0.7)];
    vec![Stroke::line(inner, pen), head(b, along), head(a, along.times(-1.0))]
}

/// A coordinate: an arrow with a mark across its start.
pub fn coordinate(from: Point, to: Point, pen: Pen) -> Vec<Stroke> {
    let across = to.minus(from).unit().unwrap_or_default().perpendicular();
    let mut strokes = single(from, to, pen);
    strokes.push(Stroke::line([from.towards(across, 4.0), from.towards(across, -4.0)], pen));
    strokes
}

/// A curved arrow counter-clockwise about a point, above it, at its right, below it and at its left.
pub fn arcs(centre: Point, radius: f64, pen: Pen, both: bool) -> Vec<Vec<Stroke>> {
    [0.5, 0.0, -0.5, 1.0].map(|quarter| curved_arrow(centre, radius, quarter * PI, pen, both, false)).to_vec()
}

/// Like [`arcs`], but clockwise.
pub fn arcs_back(centre: Point, radius: f64, pen: Pen) -> Vec<Vec<Stroke>> {
    [0.5, 0.0, -0.5, 1.0].map(|quarter| curved_arrow(centre, radius, quarter * PI, pen, false, true)).to_vec()
}

fn curved_arrow(centre: Point, radius: f64, middle: f64, pen: Pen, both: bool, back: bool) -> Vec<Stroke> {
    let half = (20.0 / radius).clamp(0.35, 1.1);
    let (from, to) = if back { (middle + half, middle - half) } else { (middle - half, middle + half) };
    let points = arc(centre, radius, from, to, 16);
    let tip = |last: Point, before: Point| {
        let along = last.minus(before).unit().unwrap_or_default();
        head(last.towards(along, 3.0), along)
    };
    let count = points.len();
    let mut strokes = vec![tip(points[count - 1], points[count - 3])];
    if both {
        strokes.push(tip(points[0], points[2]));
    }
    strokes.push(Stroke::line(points, pen));
    strokes
}
