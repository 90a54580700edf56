//! Maxima under response spectra: by SRSS and CQC for each direction, with the missing mass, and across directions on request.

use super::table::{Align, Cell, Table};
use super::{Block, Figure, Options, Section, line};
use crate::analysis::response_spectrum::Direction;
use crate::answers::ModalAnswer;
use crate::base::{Ball, Bound, Number};

const DIGITS: usize = 6;
const PERCENT: usize = 4;

pub fn section(answer: &ModalAnswer, options: &Options) -> Section {
    let spectral = &answer.spectral;
    let mut blocks: Vec<Block> = Vec::new();
    if !spectral.directions.is_empty() {
        let added = if spectral.added.missing_mass { "with the missing mass" } else { "without the missing mass" };
        blocks.push(Block::Line(line![
            "maxima under response spectra, the modes combined by SRSS and by CQC, ",
            added,
            "; relative: to the base; absolute: the accelerations by pseudo-accelerations"
        ]));
    }
    for (input, found) in &spectral.directions {
        let name = answer.system.display(answer.system.inputs[*input].name);
        match found {
            Err(why) => blocks.push(Block::Line(line!["by ", name, ": ", why.clone()])),
            Ok(direction) => of_direction(answer, direction, options, &mut blocks),
        }
    }
    if spectral.added.across {
        blocks.push(all_directions(answer, options));
    }
    Section::new("Response spectra", blocks)
}

fn of_direction(answer: &ModalAnswer, direction: &Direction, options: &Options, blocks: &mut Vec<Block>) {
    let input = &answer.system.inputs[direction.input];
    let turns = input.unit == "rad";
    let (mass, unit) = if turns { ("kg*m^2", "rad/s^2") } else { ("kg", "m/s^2") };
    let percent = Figure::number(&direction.damping * &Number::from(100), DIGITS).unit("%");
    let from = Figure::number(direction.rigid_from.clone(), DIGITS).unit("Hz");
    let rigid = Figure::ball(direction.rigid, DIGITS).unit(unit);
    let share = Figure::ball(direction.missing / direction.total * Ball::from(100.0), PERCENT).unit("%");
    let (missing, total) =
        (Figure::ball(direction.missing, DIGITS).unit(mass), Figure::ball(direction.total, DIGITS).unit(mass));
    blocks.push(Block::Line(line![
        "by ",
        answer.system.display(input.name),
        ": damping ",
        percent,
        ", ",
        rigid,
        " from ",
        from,
        " on; missing mass in the modes from there on: ",
        missing,
        " of ",
        total,
        ", ",
        share
    ]));
    blocks.extend(direction.corrected.iter().map(|corrected| {
        Block::Item(line![
            "mode ",
            corrected.mode,
            ": damping ",
            Figure::ball(corrected.damping * Ball::from(100.0), DIGITS).unit("%"),
            ", for which the spectrum is corrected by the factor ",
            Figure::ball(corrected.factor, DIGITS),
            " (EN 1998-1)"
        ])
    }));
    let mut table = Table::new()
        .column("output", "", Align::Left)
        .column("unit", "", Align::Left)
        .column("is", "", Align::Left)
        .column("SRSS", "", Align::Point)
        .column("CQC", "", Align::Point)
        .column("missing mass", "", Align::Point)
        .column("error ≤", "", Align::Right);
    let mut reasons = Vec::new();
    for (output, found) in &direction.outputs {
        let output = &answer.system.outputs[*output];
        let name = answer.system.display(output.name);
        let mut cells: Vec<Cell> = vec![name.clone().into(), output.unit.clone().into()];
        match found {
            Ok(maximum) => {
                cells.push(maximum.of.name().into());
                cells.extend(
                    [maximum.srss, maximum.cqc, maximum.missing]
                        .map(|x| Cell::from(Figure::ball(x, options.digits(DIGITS)))),
                );
                cells.push(
                    Figure::bound(Bound::of_midpoint(maximum.srss).or_larger(Bound::of_midpoint(maximum.cqc))).into(),
                );
            }
            Err(why) => {
                cells.extend(["".into(), "?".into(), "?".into(), "?".into(), "?".into()]);
                reasons.push(Block::Item(line![name, ": ", *why]));
            }
        }
        table.row(cells);
    }
    if !direction.outputs.is_empty() {
        blocks.push(table.into());
        blocks.extend(reasons);
    }
}

/// Over all directions.
fn all_directions(answer: &ModalAnswer, options: &Options) -> Block {
    let list = &answer.spectral.across;
    if list.is_empty() {
        return Block::Line("across directions: no output has a maximum in each of them".into());
    }
    let mut table = Table::new()
        .column("across directions", "", Align::Left)
        .column("unit", "", Align::Left)
        .column("SRSS of SRSS", "", Align::Point)
        .column("SRSS of CQC", "", Align::Point)
        .column("error ≤", "", Align::Right);
    for (output, [srss, cqc]) in list {
        let output = &answer.system.outputs[*output];
        let error = Bound::of_midpoint(*srss).or_larger(Bound::of_midpoint(*cqc));
        table.row(vec![
            answer.system.display(output.name).into(),
            output.unit.clone().into(),
            Figure::ball(*srss, options.digits(DIGITS)).into(),
            Figure::ball(*cqc, options.digits(DIGITS)).into(),
            Figure::bound(error).into(),
        ]);
    }
    table.into()
}
