//! A torsional spring: a spiral round the pivot of its two ends, or in the middle of a shaft between them.

use crate::picture::figure::{Pen, Stroke};
use crate::picture::geometry::{Point, spiral};
use std::f64::consts::PI;

/// Half of its width on a shaft, px.
pub const HALF: f64 = 12.0;
/// Inner radius round a point, and the increment for each further element, px.
pub const INNER: f64 = 8.0;
pub const RING: f64 = 12.0;

pub fn strokes(a: Point, b: Point) -> Vec<Stroke> {
    let (middle, length) = (a.middle(b), a.distance(b));
    let Some(along) = b.minus(a).unit() else { return Vec::new() };
    let radius = HALF.min(length / 4.0);
    // From the middle, where the shaft of one end stops, two and a half turns outwards to the shaft of the other.
    let start = if along.x.abs() >= along.y.abs() {
        if along.x > 0.0 { 0.0 } else { PI }
    } else if along.y < 0.0 {
        PI / 2.0
    } else {
        -PI / 2.0
    };
    let turns = spiral(middle, (1.5, radius), (start - 4.0 * PI, start), 72);
    let last = turns.last().copied().unwrap_or(middle);
    let inner = a.minus(middle).unit().unwrap_or_default();
    vec![
        Stroke::line([a, middle.towards(inner, 1.5)], Pen::Thin),
        Stroke::line(turns, Pen::Normal),
        Stroke::line([last, b], Pen::Normal),
    ]
}

/// Round a pivot, outside of `place` others.
pub fn round(at: Point, place: usize) -> Vec<Stroke> {
    let inner = INNER + RING * place as f64;
    let turns = spiral(at, (inner, inner + RING - 3.0), (-PI / 2.0, 2.75 * PI), 60);
    vec![Stroke::line(turns, Pen::Normal)]
}
