//! A rotating unbalance: a curved arrow about its point, in the sense of its rotation, and the heavy spot.

use super::force::point;
use super::{Sheet, Subject, arrow};
use crate::model::scene::{Attachment, Input};
use crate::picture::figure::{Kind, Pen, Stroke};
use crate::picture::geometry::Point;
use crate::picture::occupied::Occupied;
use crate::picture::stage::Stage;

/// The radius of the heavy spot, px.
const SPOT: f64 = 3.5;

pub fn draw(sheet: &mut Sheet, stage: &Stage, input: &Input, end: &Attachment, clockwise: bool, room: &mut Occupied) {
    let (part, at) = point(sheet, stage, end);
    let outline = &stage.layout.parts[part].outline;
    let inside = at.minus(stage.place(part));
    let reach = [Point::new(1.0, 0.0), Point::new(0.0, 1.0)].map(|way| outline.reach(inside, way));
    let own = reach[0].min(reach[1]).max(8.0);
    let tries = arrow::offsets(own + 9.0).flat_map(|radius| {
        let arcs = match clockwise {
            false => arrow::arcs(at, radius, Pen::Normal, false),
            true => arrow::arcs_back(at, radius, Pen::Normal),
        };
        arcs.into_iter().map(move |mut strokes| {
            // Inside the arc, near the side that it is drawn on.
            let middle = strokes.last().map_or(at, |arc| arc.bounds().centre());
            let out = middle.minus(at).unit().unwrap_or(Point::new(1.0, 0.0));
            strokes.push(Stroke::circle(at.towards(out, radius - SPOT - 3.0), SPOT, Pen::Solid));
            strokes
        })
    });
    let name = sheet.says.display(input.name);
    let title = format!("unbalance {name} on {}", sheet.says.part_name(end.part));
    let of = Subject { title, span: Some(input.span) };
    let tries = tries.collect();
    let Some(bounds) = sheet.choose(Kind::Unbalance, of, tries, room) else { return };
    sheet.label_beside(name, Some(input.span), bounds, &[]);
}
