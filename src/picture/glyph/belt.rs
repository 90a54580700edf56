//! A span of a belt: the line from disk to disk along their common tangent.

use super::Sheet;
use crate::model::scene::{BeltSpan, Element};
use crate::picture::figure::{Hold, Pen, Ride, Stroke};
use crate::picture::geometry::Point;
use crate::picture::stage::Stage;

/// The two points at which the span touches its disks, on the page, and the motion of its strokes.
pub fn span(sheet: &Sheet, stage: &Stage, element: &Element, span: &BeltSpan) -> (Ride, [Point; 2], Vec<Stroke>) {
    let parts = sheet.parts_of();
    let numbers = [0, 1].map(|end| parts.number(element.ends[end].part));
    let centres = numbers.map(|number| stage.place(number));
    let radii = numbers.map(|number| stage.layout.parts[number].outline.half().x);
    let apart = centres[1].minus(centres[0]);
    let crossed = span.is_crossed();
    // On the page y points down, so the left side of the way is the other one.
    let side = if span.left { -1.0 } else { 1.0 };
    let gap = if crossed { radii[0] + radii[1] } else { radii[0] - radii[1] };
    let length = (apart.dot(apart) - gap * gap).max(0.0).sqrt();
    // n with n . apart = gap
    let square = apart.dot(apart).max(1.0);
    let across = Point::new(-apart.y, apart.x);
    let normal = apart.times(gap / square).plus(across.times(side * length / square));
    let second = if crossed { -radii[1] } else { radii[1] };
    let at = [centres[0].towards(normal, radii[0]), centres[1].towards(normal, second)];
    let hold = |end: usize| Hold { part: numbers[end], of: centres[end], at: at[end] };
    (Ride::Between([hold(0), hold(1)]), at, vec![Stroke::line(at, Pen::Normal)])
}
