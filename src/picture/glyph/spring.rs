//! A spring: a zigzag between two short straight ends.

use crate::picture::figure::{Pen, Stroke};
use crate::picture::geometry::Point;

/// Half of its width, px.
pub const HALF: f64 = 7.0;
/// Between two teeth, px.
const PITCH: f64 = 7.0;

pub fn strokes(a: Point, b: Point) -> Vec<Stroke> {
    let length = a.distance(b);
    let Some(along) = b.minus(a).unit() else { return Vec::new() };
    let half = HALF.min(length / 5.0);
    let end = (length * 0.14).clamp(2.0, 14.0).min(length / 4.0);
    let coiled = length - 2.0 * end;
    let teeth = ((coiled / PITCH).round() as usize).clamp(4, 24);
    let step = coiled / teeth as f64;
    let mut points = vec![a, a.towards(along, end)];
    for tooth in 0..teeth {
        let side = if tooth % 2 == 0 { half } else { -half };
        points.push(a.towards(along, end + (tooth as f64 + 0.5) * step).towards(along.perpendicular(), side));
    }
    points.extend([b.towards(along, -end), b]);
    vec![Stroke::line(points, Pen::Normal)]
}
