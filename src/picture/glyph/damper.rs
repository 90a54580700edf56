//! A damper: a dashpot, its piston on the side of the first end and its cup on that of the second.

use crate::picture::figure::{Pen, Stroke};
use crate::picture::geometry::Point;

/// Half of its width, px.
pub const HALF: f64 = 8.0;

pub fn strokes(a: Point, b: Point) -> Vec<Stroke> {
    let length = a.distance(b);
    let Some(along) = b.minus(a).unit() else { return Vec::new() };
    let side = along.perpendicular();
    let half = HALF.min(length / 4.0);
    let cup = (length * 0.34).clamp(4.0, 24.0);
    // The cup is in the middle, and the piston in the middle of the cup.
    let (open, bottom) = (a.towards(along, (length - cup) / 2.0), a.towards(along, (length + cup) / 2.0));
    let piston = open.middle(bottom);
    let walls =
        [open.towards(side, half), bottom.towards(side, half), bottom.towards(side, -half), open.towards(side, -half)];
    let plate = half - 2.5;
    vec![
        Stroke::line([a, piston], Pen::Normal),
        Stroke::line([piston.towards(side, plate), piston.towards(side, -plate)], Pen::Normal),
        Stroke::line(walls, Pen::Normal),
        Stroke::line([bottom, b], Pen::Normal),
    ]
}
