//! A torque: a curved arrow about the body, counter-clockwise on the first end and clockwise on the second.

use super::force::point;
use super::{Sheet, Subject, arrow};
use crate::model::scene::{Attachment, Input};
use crate::picture::figure::{Kind, Pen};
use crate::picture::layout::Outline;
use crate::picture::occupied::Occupied;
use crate::picture::stage::Stage;

pub fn draw(sheet: &mut Sheet, stage: &Stage, input: &Input, ends: &[Attachment], room: &mut Occupied) {
    for (number, end) in ends.iter().enumerate() {
        let (part, _) = point(sheet, stage, end);
        let at = stage.place(part);
        let outline = &stage.layout.parts[part].outline;
        let own = match outline {
            Outline::Rod { .. } => 12.0,
            outline => outline.half().length().min(outline.half().x.max(outline.half().y) + 6.0),
        };
        let tries = arrow::offsets(own + 9.0).flat_map(|radius| match number {
            0 => arrow::arcs(at, radius, Pen::Normal, false),
            _ => arrow::arcs_back(at, radius, Pen::Normal),
        });
        let name = sheet.says.display(input.name);
        let of =
            Subject { title: format!("torque {name} on {}", sheet.says.part_name(end.part)), span: Some(input.span) };
        let tries = tries.collect();
        let Some(bounds) = sheet.choose(Kind::Torque, of, tries, room) else { continue };
        if number == 0 {
            sheet.label_beside(name, Some(input.span), bounds, &[]);
        }
    }
}
