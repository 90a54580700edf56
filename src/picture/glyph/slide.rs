//! A slide: a rail with hatching along its direction, beside the body that runs on it.

use super::ground::hatched_line;
use super::{Sheet, Subject};
use crate::base::Vec3;
use crate::model::scene::Part;
use crate::picture::figure::{Hold, Kind, Pen, Ride, Stroke};
use crate::picture::geometry::Point;
use crate::picture::layout::straight;
use crate::picture::stage::Stage;

/// Half of a rail, beyond the body that runs on it, px.
const BEYOND: f64 = 18.0;

pub fn draw(sheet: &mut Sheet, stage: &Stage, index: usize, along: &Vec3) {
    let joint = &sheet.scene.joints[index];
    let parts = sheet.parts_of();
    let numbers = [0, 1].map(|end| parts.number(joint.ends[end].part));
    // The rail belongs to the first part, whose direction it keeps; the second part runs on it.
    let (rail, runner) = if numbers[1] == 0 { (numbers[1], numbers[0]) } else { (numbers[0], numbers[1]) };
    let placed = &stage.layout.parts[runner];
    let direction = stage.layout.parts[rail].direction(straight(along)).unwrap_or(Point::new(1.0, 0.0));
    let half = placed.outline.half();
    let extent = half.x * direction.x.abs() + half.y * direction.y.abs();
    // Below or beside it, as drawn.
    let mut aside = direction.perpendicular();
    if aside.y < -0.1 {
        aside = aside.times(-1.0);
    }
    let beside = half.x * aside.x.abs() + half.y * aside.y.abs() + 2.0;
    let middle = placed.at.towards(aside, beside);
    let ends = [-1.0, 1.0].map(|sign| stage.point(rail, middle.towards(direction, sign * (extent + BEYOND))));
    let behind = stage.vector(rail, aside);
    let mut strokes = hatched_line(ends[0], ends[1], behind);
    if joint.ends.iter().all(|end| end.part != Part::Ground) {
        // The rail is fixed to a body: a thin line connects them.
        let at = stage.place(rail);
        let nearest = if ends[0].distance(at) < ends[1].distance(at) { ends[0] } else { ends[1] };
        strokes.push(Stroke::line([nearest, at], Pen::Thin));
    }
    let (name, [a, b]) = (sheet.says.display(joint.name), [0, 1].map(|end| sheet.says.part_name(joint.ends[end].part)));
    let of = Subject { title: format!("slide {name}: {b} runs along {a}"), span: Some(joint.span) };
    sheet.push_riding(Kind::Slide, of, vec![(Ride::With(rail), strokes)]);
    let at = ends[1];
    sheet.label(name, Some(joint.span), at, Point::new(2.0, 8.0), &[direction, aside]);
    sheet.rides(Ride::At(Hold::at_part(rail, at)));
}
