//! What holds for all values within the tolerances: the range of each frequency, damping ratio, pole and measure, and each
//! requirement.

use super::table::{Align, Cell, Table};
use super::{Block, Figure, Line, Section, line};
use crate::answers::ModalAnswer;
use crate::base::{Ball, Bound, Number};
use crate::questions::answer::{
    Range, RangeProof, Throughout, Tolerated, ToleratedParameter, few_digits, shown_in, shown_text,
};

/// Number of modes and of parameters that are shown.
const MOST_ROWS: usize = 40;
const DIGITS: usize = 6;

pub fn section(answer: &ModalAnswer) -> Section {
    const HEADING: &str = "Tolerances";
    let Some(found) = &answer.tolerated else { return Section::new(HEADING, []) };
    let caption = format!("for all values within {}", ranges(&found.parameters));
    let corners = found.corners.iter().flat_map(|[low, high]| {
        [("least", low), ("largest", high)]
            .map(|(word, place)| Block::Item(line!["every frequency is ", word, " at ", at(found, place)]))
    });
    let cut = found.frequencies.len().max(found.poles.len()) > MOST_ROWS;
    let more = cut.then(|| Block::Line("... and more (--format json has all)".into()));
    let numbered =
        |ranges: &[Range]| (1..).zip(ranges).map(|(i, range)| (Line::from(i), range.clone())).collect::<Vec<_>>();
    let parts = |part: usize| found.poles.iter().map(|pole| pole[part].clone()).collect::<Vec<_>>();
    let tables = [
        table(found, "mode", "f", "[Hz]", numbered(&found.frequencies)),
        table(found, "motion", "damping ratio", "", numbered(&found.ratios)),
        table(found, "pole", "re s", "[1/s]", numbered(&parts(0))),
        table(found, "pole", "im s", "[rad/s]", numbered(&parts(1))),
    ];
    let [frequencies, others @ ..] = tables;
    let others = others.into_iter().flatten().map(Block::from);
    let requirements =
        if found.requirements.is_empty() { Vec::new() } else { vec![Block::from(requirements(answer, found))] };
    let blocks = std::iter::once(Block::Line(caption.into())).chain(frequencies.map(Block::from)).chain(corners);
    let never = answer.requirements.iter().zip(&found.never).filter_map(|(requirement, why)| {
        let text = requirement.text.clone();
        why.map(|why| Block::Line(line!["what is only reached of ", text, " is not proved: ", why]))
    });
    let why = found.not_proved.map(|why| Block::Line(line!["what is only reached is not proved: ", why]));
    let rest = found
        .follows_rest
        .then(|| Block::Line("ranges are about the rest that the declared rest becomes as these values move; a search may end in another".into()));
    Section::new(HEADING, blocks.chain(others).chain(more).chain(requirements).chain(never).chain(rest).chain(why))
}

/// Ranges of one kind; `None` if there are none.
fn table(
    found: &Tolerated,
    number: &'static str,
    name: &str,
    unit: &'static str,
    ranges: Vec<(Line, Range)>,
) -> Option<Table> {
    if ranges.is_empty() {
        return None;
    }
    let mut table = Table::new()
        .column(number, "", Align::Right)
        .column(format!("least {name}"), unit, Align::Point)
        .column("error ≤", "", Align::Right)
        .column(format!("largest {name}"), unit, Align::Point)
        .column("error ≤", "", Align::Right)
        .column("", "", Align::Left);
    for (label, range) in ranges.into_iter().take(MOST_ROWS) {
        let mut cells: Vec<Cell> = vec![label.into()];
        match range.ends {
            Some(ends) => {
                for end in ends {
                    cells.extend([Figure::ball(end, DIGITS).into(), Figure::bound(Bound::relative(end)).into()]);
                }
            }
            None => cells.extend(["?".into(), Cell::default(), "?".into(), Cell::default()]),
        }
        let remark = remark(found, &range, |ball| few_digits(ball.to_f64()));
        cells.push(remark.map_or(Cell::default(), Cell::from));
        table.row(cells);
    }
    Some(table)
}

/// What the ends of a range are, unless they are reached.
fn remark(found: &Tolerated, range: &Range, shown: impl Fn(Ball) -> String) -> Option<Line> {
    match (&range.proof, range.ends) {
        (Some(RangeProof::Corners(_)), _) => None,
        (Some(RangeProof::Boxes(..)), _) => {
            let [least, largest] = range.reached?.map(shown);
            Some(line!["bounds; reached ", least, " .. ", largest])
        }
        (None, Some(_)) => Some(line!["reached at ", found.places, " places; others are not excluded"]),
        (None, None) => Some("it has no value somewhere".into()),
    }
}

fn requirements(answer: &ModalAnswer, found: &Tolerated) -> Table {
    let mut table = Table::new()
        .column("requirement", "", Align::Left)
        .column("least", "", Align::Right)
        .column("largest", "", Align::Right)
        .column("", "", Align::Left)
        .column("everywhere", "", Align::Left);
    let rows = answer.requirements.iter().zip(&found.measures).zip(&found.requirements);
    for ((requirement, range), everywhere) in rows {
        let verdict = match everywhere {
            Throughout::Holds(_) => "holds".into(),
            Throughout::FailsAt(place) => line!["fails at ", at(found, place)],
            Throughout::Undetermined => {
                line!["not decided; it does not fail at the ", found.places, " places that were looked at"]
            }
        };
        let in_unit =
            |ball: Ball| shown_text(&shown_in(&Number::Ball(ball), &requirement.unit, requirement.in_radians));
        let ends = range.as_ref().and_then(|range| range.ends).map(|ends| ends.map(in_unit));
        let [least, largest] = ends.map_or(["?".to_string(), "?".to_string()], |ends| ends);
        let remark = match (range, requirement.limit.is_some()) {
            (Some(range), _) => remark(found, range, in_unit),
            (None, true) => Some("it has no value somewhere".into()),
            (None, false) => None,
        };
        let ends: [Cell; 2] = match requirement.limit.is_some() {
            true => [least.into(), largest.into()],
            false => [Cell::default(), Cell::default()],
        };
        let [least, largest] = ends;
        let remark = remark.map_or(Cell::default(), Cell::from);
        table.row(vec![requirement.text.clone().into(), least, largest, remark, verdict.into()]);
    }
    table
}

/// `k = 9 .. 11 N/m, m = 0.9 .. 1.2 kg`
pub fn ranges(parameters: &[ToleratedParameter]) -> String {
    let ranges = parameters.iter().take(MOST_ROWS).map(|parameter| {
        let [low, high] = parameter.ends.each_ref().map(|end| value(parameter, end));
        format!("{}\u{a0}=\u{a0}{low}\u{a0}..\u{a0}{high}\u{a0}{}", parameter.name, parameter.unit.text)
            .trim_end()
            .to_string()
    });
    let more = if parameters.len() > MOST_ROWS { ", ..." } else { "" };
    ranges.collect::<Vec<_>>().join(", ") + more
}

/// `k = 9 N/m, m = 1.2 kg`
fn at(found: &Tolerated, place: &[Number]) -> String {
    place_text(&found.parameters, place)
}

pub fn place_text(parameters: &[ToleratedParameter], place: &[Number]) -> String {
    let given = |(parameter, si): (&ToleratedParameter, &Number)| {
        let value = value(parameter, si);
        format!("{}\u{a0}=\u{a0}{value}\u{a0}{}", parameter.name, parameter.unit.text).trim_end().to_string()
    };
    let list: Vec<String> = parameters.iter().zip(place).take(MOST_ROWS).map(given).collect();
    list.join(", ")
}

/// In the parameter's unit.
fn value(parameter: &ToleratedParameter, si: &Number) -> String {
    few_digits(shown_in(si, &parameter.unit, false).number.to_f64())
}
