//! What holds for all values within the tolerances: the range of each frequency, and each requirement.

use super::table::{Align, Cell, Table};
use super::{Block, Figure, Line, Section, line};
use crate::answers::ModalAnswer;
use crate::base::{Bound, Number};
use crate::questions::answer::{RangeProof, Throughout, Tolerated, ToleratedParameter, few_digits, shown};

/// Number of modes and of parameters that are shown.
const MOST_ROWS: usize = 40;
const DIGITS: usize = 6;

pub fn section(answer: &ModalAnswer) -> Section {
    const HEADING: &str = "Tolerances";
    let Some(found) = &answer.tolerated else { return Section::new(HEADING, []) };
    let ranges = found.parameters.iter().take(MOST_ROWS).map(|parameter| {
        let [low, high] = parameter.ends.each_ref().map(|end| value(parameter, end));
        format!("{}\u{a0}=\u{a0}{low}\u{a0}..\u{a0}{high}\u{a0}{}", parameter.name, parameter.unit.text)
            .trim_end()
            .to_string()
    });
    let more = if found.parameters.len() > MOST_ROWS { ", ..." } else { "" };
    let caption = format!("for all values within {}{more}", ranges.collect::<Vec<_>>().join(", "));
    let frequencies = if found.frequencies.is_empty() { Vec::new() } else { vec![Block::from(frequencies(found))] };
    let corners = found.corners.iter().flat_map(|[low, high]| {
        [("least", low), ("largest", high)]
            .map(|(word, place)| Block::Item(line!["every frequency is ", word, " at ", at(found, place)]))
    });
    let cut = found.frequencies.len() > MOST_ROWS;
    let more = cut.then(|| Block::Line("... and more (--format json has all)".into()));
    let requirements =
        if found.requirements.is_empty() { Vec::new() } else { vec![Block::from(requirements(answer, found))] };
    let blocks = std::iter::once(Block::Line(caption.into())).chain(frequencies).chain(more);
    Section::new(HEADING, blocks.chain(corners).chain(requirements))
}

fn frequencies(found: &Tolerated) -> Table {
    let mut table = Table::new()
        .column("mode", "", Align::Right)
        .column("least f", "[Hz]", Align::Point)
        .column("error ≤", "", Align::Right)
        .column("largest f", "[Hz]", Align::Point)
        .column("error ≤", "", Align::Right)
        .column("", "", Align::Left);
    for (i, range) in found.frequencies.iter().enumerate().take(MOST_ROWS) {
        let mut cells: Vec<Cell> = vec![Line::from(i + 1).into()];
        match range.ends {
            Some(ends) => {
                for end in ends {
                    cells.extend([Figure::ball(end, DIGITS).into(), Figure::bound(Bound::relative(end)).into()]);
                }
            }
            None => cells.extend(["?".into(), Cell::default(), "?".into(), Cell::default()]),
        }
        cells.push(match (&range.proof, &range.ends) {
            (Some(RangeProof::Corners(_)), _) => Cell::default(),
            (Some(RangeProof::Boxes(..)), _) => match range.reached {
                Some([least, largest]) => {
                    let [least, largest] = [least, largest].map(|f| few_digits(f.to_f64()));
                    line!["bounds; reached ", least, " .. ", largest].into()
                }
                None => Cell::default(),
            },
            (None, Some(_)) => line!["reached at ", found.places, " places; others are not excluded"].into(),
            (None, None) => "it does not oscillate somewhere".into(),
        });
        table.row(cells);
    }
    table
}

fn requirements(answer: &ModalAnswer, found: &Tolerated) -> Table {
    let mut table = Table::new().column("requirement", "", Align::Left).column("everywhere", "", Align::Left);
    for (requirement, everywhere) in answer.requirements.iter().zip(&found.requirements) {
        let verdict = match everywhere {
            Throughout::Holds(_) => "holds".into(),
            Throughout::FailsAt(place) => line!["fails at ", at(found, place)],
            Throughout::Undetermined => {
                line!["not decided; it does not fail at the ", found.places, " places that were looked at"]
            }
        };
        table.row(vec![requirement.text.clone().into(), verdict.into()]);
    }
    table
}

/// `k = 9 N/m, m = 1.2 kg`
fn at(found: &Tolerated, place: &[Number]) -> String {
    let given = |(parameter, si): (&ToleratedParameter, &Number)| {
        let value = value(parameter, si);
        format!("{}\u{a0}=\u{a0}{value}\u{a0}{}", parameter.name, parameter.unit.text).trim_end().to_string()
    };
    let list: Vec<String> = found.parameters.iter().zip(place).take(MOST_ROWS).map(given).collect();
    list.join(", ")
}

/// In the parameter's unit.
fn value(parameter: &ToleratedParameter, si: &Number) -> String {
    few_digits(shown(si, &parameter.unit, false).number.to_f64())
}
