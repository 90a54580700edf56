//! Participation factors and effective masses: a table for each motion of a base.

use super::table::{Align, Cell, Table};
use super::{Block, Figure, Section, line};
use crate::analysis::Excitation;
use crate::answers::ModalAnswer;
use crate::base::{Ball, Bound};

/// Number of modes that are listed; the JSON has all.
const MOST: usize = 20;
const DIGITS: usize = 6;
const PERCENT: usize = 4;

pub fn section(answer: &ModalAnswer) -> Section {
    let mut blocks: Vec<Block> = Vec::new();
    for (input, found) in &answer.excitations {
        let input = &answer.system.inputs[*input];
        let name = answer.system.display(input.name);
        let unit = if input.unit == "rad" { "kg*m^2" } else { "kg" };
        match found {
            Err(why) => blocks.push(Block::Line(line!["base excitation by ", name, ": ", *why])),
            Ok(excitation) => {
                let total = Figure::ball(excitation.total, DIGITS).unit(unit);
                blocks.push(Block::Line(line!["base excitation by ", name, ": ", total, " in all modes"]));
                blocks.push(table(answer, excitation, input.unit == "rad").into());
                if excitation.modes.len() > MOST {
                    blocks.push(Block::Line("... and more (--format json has all)".into()));
                }
                if excitation.modes.iter().any(|mode| mode.mass.is_none()) {
                    let together = "?: modes of the same frequency have an effective mass only together";
                    blocks.push(Block::Line(together.into()));
                }
            }
        }
    }
    Section::new("Base excitation", blocks)
}

fn table(answer: &ModalAnswer, excitation: &Excitation, turns: bool) -> Table {
    let [root, unit] = if turns { ["[√kg*m]", "[kg*m^2]"] } else { ["[√kg]", "[kg]"] };
    let mut table = Table::new()
        .column("mode", "", Align::Right)
        .column("participation", root, Align::Point)
        .column("effective mass", unit, Align::Point)
        .column("error ≤", "", Align::Right)
        .column("share", "[%]", Align::Point)
        .column("sum", "[%]", Align::Point);
    for ((number, _), excited) in answer.modes.with_numbers().zip(&excitation.modes).take(MOST) {
        let percent = |mass: Ball| mass / excitation.total * Ball::from(100.0);
        let shown = |value: Option<Ball>, digits: usize| match value {
            Some(value) if value.is_finite() => Figure::ball(value, digits).into(),
            _ => Cell::from("?"),
        };
        let error = excited.mass.map_or_else(|| "?".into(), |mass| Figure::bound(Bound::of_midpoint(mass)).into());
        table.row(vec![
            number.into(),
            shown(excited.participation, DIGITS),
            shown(excited.mass, DIGITS),
            error,
            shown(excited.mass.map(percent), PERCENT),
            shown(excited.running.map(percent), PERCENT),
        ]);
    }
    table
}
