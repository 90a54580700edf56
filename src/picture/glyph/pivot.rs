//! A pivot: a small circle; on the ground with its bearing.

use super::ground::hatched_line;
use super::{Sheet, Subject};
use crate::model::scene::Part;
use crate::picture::Detail;
use crate::picture::figure::{Hold, Kind, Pen, Ride, Stroke};
use crate::picture::geometry::Point;
use crate::picture::stage::Stage;

const RADIUS: f64 = 4.0;
/// Height and half width of a bearing, px.
const HIGH: f64 = 15.0;
const WIDE: f64 = 10.0;

pub fn draw(sheet: &mut Sheet, stage: &Stage, index: usize) {
    let joint = &sheet.scene.joints[index];
    let parts = sheet.parts_of();
    let numbers = [0, 1].map(|end| parts.number(joint.ends[end].part));
    let on_ground = joint.ends.iter().any(|end| end.part == Part::Ground);
    let held = if numbers[0] == 0 { numbers[1] } else { numbers[0] };
    let at = stage.point(held, stage.layout.joints[index]);
    // Its bearing is fixed to the ground.
    let mut strokes = Vec::new();
    if on_ground && sheet.detail < Detail::Plain {
        // Away from the parts that it carries, upwards or downwards.
        let body = stage.layout.parts[held].at.minus(stage.layout.joints[index]);
        let away = if body.y.abs() < body.x.abs() * 0.2 || body.y < 0.0 { 1.0 } else { -1.0 };
        let down = Point::new(0.0, away);
        let foot = at.towards(down, HIGH);
        let [left, right] = [-WIDE, WIDE].map(|x| foot.plus(Point::new(x, 0.0)));
        strokes.push(Stroke::area([at, left, right], Pen::Paper));
        let beyond = Point::new(6.0, 0.0);
        strokes.extend(hatched_line(left.minus(beyond), right.plus(beyond), down));
    }
    let pin = vec![Stroke::circle(at, RADIUS, Pen::Paper)];
    let ride = Ride::At(Hold::at_part(held, at));
    let (name, [a, b]) = (sheet.says.display(joint.name), [0, 1].map(|end| sheet.says.part_name(joint.ends[end].part)));
    let of = Subject { title: format!("pivot {name}: {a} and {b} turn about it"), span: Some(joint.span) };
    let half = if on_ground { Point::new(RADIUS + 1.0, RADIUS + 1.0) } else { Point::new(RADIUS, RADIUS) };
    sheet.push_riding(Kind::Pivot, of, vec![(Ride::Still, strokes), (ride, pin)]);
    sheet.label_tie(
        name,
        Some(joint.span),
        at,
        half,
        &[Point::new(0.8, -0.6), Point::new(-0.8, -0.6), Point::new(1.0, 0.0)],
    );
    sheet.rides(ride);
}
