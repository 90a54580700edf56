//! The complex shapes of the damped motions: magnitude and phase of each coordinate and output.

use super::table::{Align, Cell, Table};
use super::transfer::hundredths;
use super::{Block, Figure, Section, coordinate, line, unit};
use crate::analysis::{DampedShape, ShapeEntries};
use crate::answers::ModalAnswer;

const DIGITS: usize = 6;

pub fn section(answer: &ModalAnswer) -> Section {
    let mut blocks: Vec<Block> = Vec::new();
    if answer.damped_shapes.iter().any(|shape| shape.found.is_ok()) {
        let caption = "shapes of the damped motion (leading entry 1, phases against it)";
        blocks.extend([Block::Line(caption.into()), table(answer).into()]);
    }
    for DampedShape { number, found, .. } in &answer.damped_shapes {
        if let Err(why) = found {
            blocks.push(Block::Line(line!["pole ", *number, ": ", *why]));
        }
    }
    Section::new("Shapes of the damped motion", blocks)
}

fn table(answer: &ModalAnswer) -> Table {
    let mut table = Table::new()
        .column("pole", "", Align::Right)
        .column("motion", "", Align::Left)
        .column("unit", "", Align::Left)
        .column("magnitude", "", Align::Point)
        .column("phase", "[deg]", Align::Point)
        .column("error ≤", "", Align::Right);
    for DampedShape { number, found, .. } in &answer.damped_shapes {
        let Ok(ShapeEntries { coordinates, outputs, .. }) = found else { continue };
        let system = &answer.system;
        let own = system.coordinates.iter().map(|of| (Cell::from(coordinate(system, of)), Cell::from(unit(of.kind))));
        let theirs = system
            .outputs
            .iter()
            .map(|output| (Cell::from(system.display(output.name)), Cell::from(output.unit.clone())));
        for (place, ((name, unit), disc)) in own.chain(theirs).zip(coordinates.iter().chain(outputs)).enumerate() {
            let first = if place == 0 { Cell::from(*number) } else { Cell::default() };
            let [magnitude, phase, error] = match disc.is_zero() {
                true => ["0".into(), Cell::default(), Figure::exact().into()],
                false => [
                    Figure::ball(disc.gain(), DIGITS).into(),
                    disc.phase().map(hundredths).into(),
                    Figure::bound(disc.error_bound()).into(),
                ],
            };
            table.row(vec![first, name, unit, magnitude, phase, error]);
        }
    }
    table
}
