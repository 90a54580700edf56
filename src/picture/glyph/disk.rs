//! A disk or a ring: a circle with a spoke, so that turning is seen.

use crate::picture::figure::{Pen, Stroke};
use crate::picture::geometry::Point;

/// Strokes of a disk. `spoke` is the direction of its mark.
pub fn strokes(at: Point, radius: f64, spoke: Point) -> Vec<Stroke> {
    vec![
        Stroke::circle(at, radius, Pen::Body),
        Stroke::line([at, at.towards(spoke, radius)], Pen::Thin),
        Stroke::circle(at, 2.0_f64.min(radius / 3.0), Pen::Solid),
    ]
}

pub fn ring(at: Point, radius: f64, spoke: Point) -> Vec<Stroke> {
    let inner = (radius - 5.0).max(radius * 0.7);
    vec![
        Stroke::circle(at, radius, Pen::Body),
        Stroke::circle(at, inner, Pen::Paper),
        Stroke::line([at, at.towards(spoke, inner)], Pen::Thin),
        Stroke::circle(at, 2.0_f64.min(radius / 3.0), Pen::Solid),
    ]
}
