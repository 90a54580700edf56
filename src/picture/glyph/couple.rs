//! A coupling: a dashed line between its motions, or a pair of gears if two disks touch and turn against each other.

use super::{Sheet, Subject, gear};
use crate::model::scene::{Motion, Part};
use crate::picture::figure::{Hold, Kind, Pen, Ride, Stroke};
use crate::picture::geometry::Point;
use crate::picture::layout::straight;
use crate::picture::stage::Stage;

pub fn draw(sheet: &mut Sheet, stage: &Stage, index: usize) {
    let couple = &sheet.scene.couples[index];
    let name = sheet.says.display(couple.name);
    let of = Subject { title: format!("coupling {name}"), span: Some(couple.span) };
    let parts = sheet.parts_of();
    let mut points: Vec<(usize, Point)> = Vec::new();
    for term in &couple.terms {
        let (part, at) = match &term.motion {
            Motion::Point { part, at, .. } => (*part, at.as_ref()),
            Motion::Turn { part, .. } => (*part, None),
            Motion::Force { .. } | Motion::Stretch { .. } | Motion::Reaction(_) => continue,
        };
        if part == Part::Ground {
            continue;
        }
        let (number, placed) = (parts.number(part), &stage.layout.parts[parts.number(part)]);
        let drawn = at.map_or(placed.at, |at| placed.point([at.x.to_f64(), at.y.to_f64()]));
        let point = (number, stage.point(number, drawn));
        if !points.contains(&point) {
            points.push(point);
        }
    }
    if let Some((strokes, at)) = gear::strokes(stage, &couple.terms, &parts) {
        sheet.push_riding(Kind::Gear, of, strokes);
        return sheet.label(
            name,
            Some(couple.span),
            at,
            Point::new(7.0, 7.0),
            &[Point::new(1.0, 0.0), Point::new(-1.0, 0.0)],
        );
    }
    let mut strokes = Vec::new();
    for pair in points.windows(2) {
        let [(a, from), (b, to)] = [pair[0], pair[1]];
        let Some(along) = to.minus(from).unit() else { continue };
        let edge = |number: usize, at: Point, along: Point| {
            let placed = &stage.layout.parts[number];
            at.towards(along, placed.outline.reach(at.minus(stage.place(number)), along))
        };
        let ends = [edge(a, from, along), edge(b, to, along.times(-1.0))];
        let ride = Ride::Between([Hold::at_part(a, ends[0]), Hold::at_part(b, ends[1])]);
        strokes.push((ride, vec![Stroke::line(ends, Pen::Dashed)]));
    }
    let Some((ride, ends)) = strokes.first().and_then(|(ride, own)| match &own[..] {
        [Stroke::Line { points, .. }] => Some((*ride, [points[0], points[1]])),
        _ => None,
    }) else {
        // Motions of one part: a dash beside it.
        let Some((number, at)) = points.first().copied() else { return };
        let half = stage.layout.parts[number].outline.half();
        let line = [at.plus(Point::new(half.x + 4.0, -half.y)), at.plus(Point::new(half.x + 4.0, half.y))];
        let ride = Ride::At(Hold::at_part(number, at));
        sheet.push_riding(Kind::Couple, of, vec![(ride, vec![Stroke::line(line, Pen::Dashed)])]);
        return sheet.label(name, Some(couple.span), line[0], Point::new(2.0, 2.0), &[Point::new(1.0, 0.0)]);
    };
    let middle = ends[0].middle(ends[1]);
    let side = ends[1].minus(ends[0]).unit().unwrap_or_default().perpendicular();
    sheet.push_riding(Kind::Couple, of, strokes);
    sheet.label(name, Some(couple.span), middle, Point::new(3.0, 3.0), &[side, side.times(-1.0)]);
    sheet.rides(ride);
}

/// The direction of a motion on the page; `None` for a rotation.
pub fn direction(stage: &Stage, number: usize, motion: &Motion) -> Option<Point> {
    match motion {
        Motion::Point { direction, .. } => stage.layout.parts[number].direction(straight(direction)),
        Motion::Turn { .. } | Motion::Force { .. } | Motion::Stretch { .. } | Motion::Reaction(_) => None,
    }
}
