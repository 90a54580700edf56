//! A base: a hatched plate across its motion, and a double arrow along it.

use super::arrow;
use super::ground::hatched_line;
use super::{Sheet, Subject};
use crate::picture::figure::{Kind, Pen, Ride, Stroke};
use crate::picture::geometry::Point;
use crate::picture::layout::Outline;
use crate::picture::occupied::Occupied;
use crate::picture::stage::Stage;

/// Half of a double arrow, px.
const HALF: f64 = 13.0;

pub fn draw(sheet: &mut Sheet, stage: &Stage, index: usize) {
    let number = 1 + sheet.scene.bodies.len() + index;
    let placed = &stage.layout.parts[number];
    let base = &sheet.scene.bases[index];
    let Outline::Plate { along, half } = placed.outline else { return };
    let (at, along) = (stage.place(number), stage.vector(number, along));
    let side = along.perpendicular();
    let mut strokes = hatched_line(at.towards(side, -half), at.towards(side, half), along.times(-1.0));
    strokes.extend(placed.arms.iter().map(|arm| super::rod::link(at, stage.point(number, *arm))));
    let name = sheet.says.display(base.name);
    let of = Subject { title: format!("base {name}, moved from outside"), span: Some(base.span) };
    sheet.push_riding(Kind::Base, of, vec![(Ride::With(number), strokes)]);
    sheet.label(name, Some(base.span), at, placed.outline.half(), &[along.times(-1.0)]);
}

/// The motion of a base, beside its plate.
pub fn arrow(sheet: &mut Sheet, stage: &Stage, index: usize, translation: Option<usize>, room: &mut Occupied) {
    let number = 1 + sheet.scene.bodies.len() + index;
    let placed = &stage.layout.parts[number];
    let Outline::Plate { along, half } = placed.outline else { return };
    let base = &sheet.scene.bases[index];
    let at = stage.place(number);
    let name = sheet.says.display(base.name);
    let Some(translation) = translation.and_then(|which| base.translations.get(which)) else {
        let of = Subject { title: format!("the angle of {name} is prescribed"), span: Some(base.span) };
        let tries = arrow::offsets(half + 10.0).flat_map(|radius| arrow::arcs(at, radius, Pen::Thin, true));
        sheet.choose(Kind::Base, of, tries.collect(), room);
        return;
    };
    let direction = placed.direction(super::super::layout::straight(&translation.direction)).unwrap_or(along);
    let of = Subject { title: format!("{name}.{} is prescribed", translation.motion), span: Some(base.span) };
    let side = along.perpendicular();
    let places = [1.0, -1.0].into_iter().flat_map(|sign| {
        arrow::offsets(10.0).map(move |off| at.towards(side, sign * (half + off)).towards(along, -3.0))
    });
    let behind = arrow::offsets(16.0).map(|off| at.towards(along, -off - HALF));
    let tries: Vec<Vec<Stroke>> = places
        .chain(behind)
        .map(|middle: Point| {
            arrow::double(middle.towards(direction, -HALF), middle.towards(direction, HALF), Pen::Thin)
        })
        .collect();
    sheet.choose(Kind::Base, of, tries, room);
}
