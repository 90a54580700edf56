//! An initial motion: a faint arrow the way that it displaces or moves its body.

use super::couple::direction;
use super::{Sheet, Subject, arrow, values};
use crate::model::scene::{Initial, Motion, Part};
use crate::picture::figure::{Kind, Pen, Stroke};
use crate::picture::geometry::Point;
use crate::picture::occupied::Occupied;
use crate::picture::stage::Stage;

const LENGTH: f64 = 24.0;

pub fn draw(sheet: &mut Sheet, stage: &Stage, initial: &Initial, room: &mut Occupied) {
    let part = sheet.parts_of().number(Part::Body(initial.body));
    let (at, outline) = (stage.place(part), &stage.layout.parts[part].outline);
    for (motion, value, _) in &initial.values {
        if value.is_zero() {
            continue;
        }
        let sign = if value.is_negative() { -1.0 } else { 1.0 };
        let tries: Vec<Vec<Stroke>> = match direction(stage, part, motion) {
            Some(direction) => {
                let direction = direction.times(sign);
                let sides = arrow::offsets(8.0).flat_map(|off| [(off, 1.0), (off, -1.0)]);
                let places = sides.map(|(off, side)| {
                    let side = direction.perpendicular().times(side);
                    at.towards(side, outline.reach(Point::default(), side) + off)
                });
                let half = direction.times(LENGTH / 2.0);
                places.map(|middle| faint(middle.minus(half), middle.plus(half))).collect()
            }
            None => {
                let own = outline.half().x.max(outline.half().y).min(40.0);
                let back = value.is_negative();
                let tries = arrow::offsets(own + 8.0).flat_map(|radius| {
                    if back {
                        arrow::arcs_back(at, radius, Pen::Faint)
                    } else {
                        arrow::arcs(at, radius, Pen::Faint, false)
                    }
                });
                tries.collect()
            }
        };
        let name = sheet.says.part_name(Part::Body(initial.body));
        let says =
            format!("{}({name}) = {}", values::motion_word(motion), values::motion_value(sheet.says, motion, value));
        let of = Subject { title: format!("initial: {says}"), span: Some(initial.span) };
        let Some(bounds) = sheet.choose(Kind::Initial, of, tries, room) else { continue };
        if sheet.request.values {
            let text =
                format!("{}0 = {}", values::motion_word(motion), values::motion_value(sheet.says, motion, value));
            sheet.label_beside(text, Some(initial.span), bounds, &[]);
        }
    }
}

fn faint(from: Point, to: Point) -> Vec<Stroke> {
    let along = to.minus(from).unit().unwrap_or_default();
    let side = along.perpendicular();
    let back = to.towards(along, -7.0);
    let head = [back.towards(side, 3.5), to, back.towards(side, -3.5)];
    vec![Stroke::line([from, to], Pen::Faint), Stroke::line(head, Pen::Faint)]
}

/// Whether a motion is the rate of another one; its letter is then a `v`.
pub fn is_rate(motion: &Motion) -> bool {
    matches!(motion, Motion::Point { derivative: 1, .. } | Motion::Turn { derivative: 1, .. })
}
