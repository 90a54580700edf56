//! A torsional damper: a drum with a vane in it, on a shaft between its ends or round their pivot.

use super::spiral::{INNER, RING};
use crate::picture::figure::{Pen, Stroke};
use crate::picture::geometry::{Point, arc};
use std::f64::consts::PI;

/// Half of its width on a shaft, px.
pub const HALF: f64 = 12.0;

pub fn strokes(a: Point, b: Point) -> Vec<Stroke> {
    let (middle, length) = (a.middle(b), a.distance(b));
    let Some(along) = b.minus(a).unit() else { return Vec::new() };
    let side = along.perpendicular();
    let (half, deep) = (HALF.min(length / 4.0), 6.0_f64.min(length / 6.0));
    // A drum seen from the side, closed towards the second end, and a disk that turns in it.
    let drum = [
        middle.towards(along, -deep).towards(side, half),
        middle.towards(along, deep).towards(side, half),
        middle.towards(along, deep).towards(side, -half),
        middle.towards(along, -deep).towards(side, -half),
    ];
    let vane = half - 3.5;
    vec![
        Stroke::line([a, middle], Pen::Normal),
        Stroke::line([middle.towards(side, vane), middle.towards(side, -vane)], Pen::Normal),
        Stroke::line(drum, Pen::Normal),
        Stroke::line([middle.towards(along, deep), b], Pen::Normal),
    ]
}

/// Round a pivot, outside of `place` others: an open ring and a vane between its walls.
pub fn round(at: Point, place: usize) -> Vec<Stroke> {
    let inner = INNER + RING * place as f64 + 2.0;
    let outer = inner + RING - 5.0;
    let middle = (inner + outer) / 2.0;
    let (from, to) = (0.15 * PI, 0.85 * PI);
    let mut cup = arc(at, inner, from, to, 24);
    cup.extend(arc(at, outer, to, from, 24));
    let piston = arc(at, middle, 0.5 * PI, -0.1 * PI, 20);
    vec![Stroke::line(cup, Pen::Normal), Stroke::line(piston, Pen::Normal)]
}
