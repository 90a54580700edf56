//! A force: an arrow that pulls at the body, or pushes it if there is no room on that side.

use super::{Sheet, Subject, arrow};
use crate::base::Vec3;
use crate::model::scene::{Attachment, Input};
use crate::picture::figure::{Kind, Pen, Stroke};
use crate::picture::geometry::Point;
use crate::picture::layout::straight;
use crate::picture::occupied::Occupied;
use crate::picture::stage::Stage;

const LENGTH: f64 = 36.0;

/// Along a fixed direction on the first end, against it on the second.
pub fn fixed_direction(
    sheet: &mut Sheet,
    stage: &Stage,
    input: &Input,
    ends: &[Attachment],
    direction: &Vec3,
    room: &mut Occupied,
) {
    for (number, end) in ends.iter().enumerate() {
        let part = sheet.parts_of().number(end.part);
        let drawn = stage.layout.parts[part].direction(straight(direction)).unwrap_or(Point::new(1.0, 0.0));
        let direction = if number == 0 { drawn } else { drawn.times(-1.0) };
        one(sheet, stage, input, end, direction, number == 0, room);
    }
}

/// Apart, along the line between two points.
pub fn draw_between(sheet: &mut Sheet, stage: &Stage, input: &Input, ends: &[Attachment; 2], room: &mut Occupied) {
    let [a, b] = [0, 1].map(|end| point(sheet, stage, &ends[end]).1);
    let apart = b.minus(a).unit().unwrap_or(Point::new(1.0, 0.0));
    one(sheet, stage, input, &ends[0], apart.times(-1.0), true, room);
    one(sheet, stage, input, &ends[1], apart, false, room);
}

fn one(
    sheet: &mut Sheet,
    stage: &Stage,
    input: &Input,
    end: &Attachment,
    direction: Point,
    named: bool,
    room: &mut Occupied,
) {
    let (part, at) = point(sheet, stage, end);
    let outline = &stage.layout.parts[part].outline;
    let inside = at.minus(stage.place(part));
    let reach = |way: Point| outline.reach(inside, way) + 2.0;
    let mut tries: Vec<Vec<Stroke>> = Vec::new();
    let mut add = |from: Point, to: Point| tries.push(arrow::single(from, to, Pen::Normal));
    let edge = at.towards(direction, reach(direction));
    add(edge, edge.towards(direction, LENGTH));
    let back = direction.times(-1.0);
    let edge = at.towards(back, reach(back));
    add(edge.towards(back, LENGTH), edge);
    for off in arrow::offsets(8.0) {
        for side in [direction.perpendicular(), direction.perpendicular().times(-1.0)] {
            let middle = at.towards(side, reach(side) + off);
            add(middle.towards(back, LENGTH / 2.0), middle.towards(direction, LENGTH / 2.0));
        }
    }
    let name = sheet.says.display(input.name);
    let of = Subject { title: format!("force {name} on {}", sheet.says.part_name(end.part)), span: Some(input.span) };
    let Some(bounds) = sheet.choose(Kind::Force, of, tries, room) else { return };
    if named {
        sheet.label_beside(name, Some(input.span), bounds, &[Point::new(0.0, -1.0), direction]);
    }
}

/// The part of an end, and its point on the page.
pub fn point(sheet: &Sheet, stage: &Stage, end: &Attachment) -> (usize, Point) {
    let part = sheet.parts_of().number(end.part);
    let placed = &stage.layout.parts[part];
    let drawn = match (end.at.as_deref(), stage.layout.scale) {
        (Some(at), Some(_)) => placed.point([at.x.to_f64(), at.y.to_f64()]),
        _ => placed.at,
    };
    (part, stage.point(part, drawn))
}
