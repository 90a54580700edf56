//! A box to scale, a block for a body without a shape, a dot for one without a mass.

use crate::picture::figure::{Pen, Stroke};
use crate::picture::geometry::Point;

pub fn strokes(at: Point, half: Point, turned: impl Fn(Point) -> Point) -> Vec<Stroke> {
    let corners =
        [half, Point::new(-half.x, half.y), half.times(-1.0), Point::new(half.x, -half.y)].map(|c| at.plus(turned(c)));
    vec![Stroke::area(corners, Pen::Body)]
}

pub fn dot(at: Point, radius: f64) -> Vec<Stroke> {
    let pen = if radius > 6.0 { Pen::Body } else { Pen::Solid };
    vec![Stroke::circle(at, radius, pen)]
}
