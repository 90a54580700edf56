//! An inerter: a flywheel in a box, driven by a rack from the first end; round a pivot a closed ring.

use super::spiral::{INNER, RING};
use crate::picture::figure::{Pen, Stroke};
use crate::picture::geometry::{Point, arc};
use std::f64::consts::PI;

/// Half of its width, px.
pub const HALF: f64 = 8.0;

pub fn strokes(a: Point, b: Point) -> Vec<Stroke> {
    let (middle, length) = (a.middle(b), a.distance(b));
    let Some(along) = b.minus(a).unit() else { return Vec::new() };
    let side = along.perpendicular();
    let (half, deep) = (HALF.min(length / 4.0), 12.0_f64.min(length / 5.0));
    let (front, back) = (middle.towards(along, -deep), middle.towards(along, deep));
    let walls = [
        front.towards(side, half),
        back.towards(side, half),
        back.towards(side, -half),
        front.towards(side, -half),
        front.towards(side, half),
    ];
    vec![
        Stroke::line([a, front], Pen::Normal),
        Stroke::line(walls, Pen::Normal),
        Stroke::Circle { centre: middle, radius: half * 0.6, pen: Pen::Normal },
        Stroke::line([back, b], Pen::Normal),
    ]
}

/// Round a pivot, outside of `place` others.
pub fn round(at: Point, place: usize) -> Vec<Stroke> {
    let inner = INNER + RING * place as f64 + 2.0;
    let ring = |radius: f64| Stroke::line(arc(at, radius, 0.0, 2.0 * PI, 36), Pen::Normal);
    vec![ring(inner), ring(inner + RING - 5.0)]
}
