//! A weld: a filled dot, with a stiff line to the parts that it makes one.

use super::{Sheet, Subject};
use crate::picture::figure::{Hold, Kind, Pen, Ride, Stroke};
use crate::picture::geometry::Point;
use crate::picture::stage::Stage;

const RADIUS: f64 = 3.5;

pub fn draw(sheet: &mut Sheet, stage: &Stage, index: usize) {
    let joint = &sheet.scene.joints[index];
    let parts = sheet.parts_of();
    let numbers = [0, 1].map(|end| parts.number(joint.ends[end].part));
    let held = if numbers[0] == 0 { numbers[1] } else { numbers[0] };
    let at = stage.point(held, stage.layout.joints[index]);
    let mut strokes = Vec::new();
    for number in numbers.into_iter().filter(|number| *number != 0) {
        let (place, outline) = (stage.place(number), &stage.layout.parts[number].outline);
        let Some(along) = at.minus(place).unit() else { continue };
        let edge = place.towards(along, outline.reach(Point::default(), along));
        if at.minus(place).length() > edge.minus(place).length() {
            strokes.push(Stroke::line([edge, at], Pen::Normal));
        }
    }
    strokes.push(Stroke::circle(at, RADIUS, Pen::Solid));
    let (name, [a, b]) = (sheet.says.display(joint.name), [0, 1].map(|end| sheet.says.part_name(joint.ends[end].part)));
    let of = Subject { title: format!("weld {name}: {a} and {b} move as one"), span: Some(joint.span) };
    sheet.push_riding(Kind::Weld, of, vec![(Ride::With(held), strokes)]);
    sheet.label_tie(name, Some(joint.span), at, Point::new(RADIUS, RADIUS), &[]);
    sheet.rides(Ride::At(Hold::at_part(held, at)));
}
