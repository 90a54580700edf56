//! Solved parameters, and whether the requirements hold.

use super::robust;
use super::table::{Align, Cell, Table};
use super::{Block, Figure, Line, Named, Report, Section, Value, enumeration, line};
use crate::base::{Ball, Bound, Number, Unproven};
use crate::questions::answer::{self, Best, Derivative, Optimised, Others, Requirement, Shown, Solved};

/// Digits of solved parameters: all that a double holds.
const MOST: usize = 16;
const DIGITS: usize = 6;
const FEW: usize = 3;

pub fn solve_section(list: &[Solved]) -> Section {
    const HEADING: &str = "Solved parameters";
    if list.is_empty() {
        return Section::new(HEADING, []);
    }
    let mut table = Table::new()
        .column("parameter", "", Align::Left)
        .column("value", "", Align::Point)
        .column("", "", Align::Left)
        .column("error ≤", "", Align::Right)
        .column("so that", "", Align::Left)
        .column("misses by", "", Align::Right)
        .column("change", "[%/%]", Align::Point);
    for solved in list {
        let shown = solved.in_unit();
        let target = solved.shown_target();
        table.row(vec![
            Named { text: solved.parameter.clone(), place: Some(solved.span) }.into(),
            figure(&shown, MOST).into(),
            shown.unit.to_string().into(),
            solved.shown_bound().map_or_else(|| "?".into(), |bound| Figure::bound(bound).into()),
            line![solved.measure.clone(), " = ", figure(&target, DIGITS).unit(target.unit.to_string())].into(),
            Figure::bound(Bound::size(solved.residual)).into(),
            solved.relative_slope().map_or_else(Cell::default, |slope| derivative(&slope, FEW).into()),
        ]);
    }
    let remarks = list
        .iter()
        .filter_map(unproven_line)
        .chain(simulated_time_line(list.iter().find_map(|solved| solved.until.as_ref())));
    let remarks = remarks.chain(counted_from(list));
    let blocks = [Block::Line("solved".into()), table.into()];
    Section::new(HEADING, blocks.into_iter().chain(remarks.map(Block::from)))
}

/// The section with the results of `minimise` and `maximise`.
pub fn optimum_section(list: &[Optimised]) -> Section {
    let blocks = list.iter().flat_map(|found| {
        let word = if found.highest { "maximised" } else { "minimised" };
        let mut table = Table::new()
            .column("parameter", "", Align::Left)
            .column("value", "", Align::Point)
            .column("", "", Align::Left)
            .column("error ≤", "", Align::Right);
        for parameter in &found.parameters {
            let shown = parameter.in_unit();
            table.row(vec![
                Named { text: parameter.parameter.clone(), place: Some(parameter.span) }.into(),
                figure(&shown, MOST).into(),
                shown.unit.to_string().into(),
                parameter.shown_bound().map_or_else(|| "?".into(), |bound| Figure::bound(bound).into()),
            ]);
        }
        let shown = found.in_unit();
        let value = figure(&shown, MOST).unit(shown.unit.to_string());
        let first = match &found.robust {
            None => line![word, " ", found.measure.clone(), " = ", value],
            Some(robust) => robust::first_line(found, robust),
        };
        let worst = found.robust.iter().flat_map(|robust| robust::lines(found, robust));
        let remarks = [equal_line(found), simulated_time_line(found.until.as_ref())];
        let remarks = std::iter::once(best_line(found)).chain(worst).chain(remarks.into_iter().flatten());
        [Block::Line(first), table.into()].into_iter().chain(remarks.map(Block::from))
    });
    Section::new("Optimal parameters", blocks.collect::<Vec<_>>())
}

/// The reason why a value is an optimum, and how much better other values could be.
fn best_line(found: &Optimised) -> Line {
    let gap = |gap: Bound| Figure::bound(found.unit.bound(gap)).unit(found.unit.text.clone());
    let better = if found.highest { "larger" } else { "smaller" };
    match &found.best {
        Best::Everywhere { gap: by, .. } => {
            line!["no values in the ranges make it ", better, " by more than ", gap(*by), ": proved"]
        }
        Best::Near { gap: by, parts } => {
            let names = found.parameters.iter().map(|parameter| &parameter.parameter);
            let parts = names
                .zip(parts)
                .map(|(name, (low, high))| line![name.clone(), " in ", low.clone(), " .. ", high.clone()]);
            line![
                "proved for ",
                enumeration(parts),
                ": no values make it ",
                better,
                " by more than ",
                gap(*by),
                "; others are not excluded"
            ]
        }
        Best::Seen => line!["the best of ", found.evaluations, " sets of values tried; others are not excluded"],
    }
}

/// The peaks that are equal.
fn equal_line(found: &Optimised) -> Option<Line> {
    if found.equal.len() < 2 {
        return None;
    }
    let peaks = found.equal.iter().map(|hertz| Line::from(unproven(Unproven(*hertz))));
    Some(line!["equal peaks near ", enumeration(peaks), " Hz"])
}

/// The parts of the searched range for which nothing is proven.
fn unproven_line(solved: &Solved) -> Option<Line> {
    let name = solved.parameter.clone();
    match &solved.others {
        Others::None(_) => None,
        Others::Unsettled(parts) => {
            let parts = enumeration(parts.iter().map(|(low, high)| line![low.clone(), " .. ", high.clone()]));
            Some(line![name, ": the one found; undetermined in ", parts, ", elsewhere there is no other"])
        }
        Others::Unknown => {
            Some(line![name, ": the one found with ", solved.evaluations, " values tried; others are not excluded"])
        }
    }
}

/// The values at which the rest of the report is evaluated, if one of them is not exactly the root.
fn counted_from(list: &[Solved]) -> Option<Line> {
    let is_root = |solved: &Solved| solved.bound == Some(0.0);
    let value = if list.len() == 1 { "this value" } else { "these values" };
    let about =
        line!["the rest is about exactly ", value, ": its error bounds count from there, not from the true root"];
    (!list.iter().all(is_root)).then_some(about)
}

/// An enclosed derivative with its certain digits; an unproven one with few digits and a mark.
pub fn derivative(derivative: &Derivative, digits: usize) -> Line {
    match derivative {
        Derivative::Enclosed(ball) => Figure::ball(*ball, digits).into(),
        Derivative::Estimated(seen) => line!["≈", unproven(*seen)],
    }
}

fn unproven(number: Unproven) -> Figure {
    Figure::of(Value::Unproven { number, digits: FEW })
}

/// The section of a modal report.
pub fn requirement_section(list: &[Requirement]) -> Section {
    const HEADING: &str = "Requirements";
    if list.is_empty() {
        return Section::new(HEADING, []);
    }
    Section::new(HEADING, [Block::Line("requirements".into())].into_iter().chain(blocks(list)))
}

/// The requirements of a file and whether they hold, under the file's name; nothing if it has none.
pub fn requirements(file: &str, list: &[Requirement]) -> Option<Report> {
    let section = Section::new("Requirements", blocks(list));
    (!list.is_empty()).then(|| Report::new(line![file.to_string()], [section]))
}

fn blocks(list: &[Requirement]) -> impl Iterator<Item = Block> {
    let followed = simulated_time_line(list.iter().find_map(|requirement| requirement.until.as_ref()));
    let reasons = list.iter().filter_map(reason);
    let added = list.iter().find(|requirement| !requirement.added.is_empty()).map(added_line);
    [Block::Table(table(list))].into_iter().chain(reasons.chain(added).chain(followed).map(Block::from))
}

/// How amplitudes at several frequencies are combined.
fn added_line(requirement: &Requirement) -> Line {
    let frequencies = enumeration(requirement.added.iter().map(|hertz| Figure::number(hertz.clone(), DIGITS).into()));
    line!["amplitudes at ", frequencies, " Hz are added: the motion never exceeds their sum, and may not reach it"]
}

/// The reason why a measure has no value. It is a sentence, too long for the column of values.
fn reason(requirement: &Requirement) -> Option<Line> {
    let answer::Value::None(why) = &requirement.value else { return None };
    let text = Named { text: requirement.text.clone(), place: Some(requirement.span) };
    Some(line![text, " has no value: ", why.clone()])
}

/// The simulated time for `peak` and `rms`, if one of them is used.
fn simulated_time_line(until: Option<&Number>) -> Option<Line> {
    let until = Figure::number(until?.clone(), DIGITS).unit("s");
    Some(line!["peak and rms are of the motion up to ", until, " (--until)"])
}

fn table(list: &[Requirement]) -> Table {
    let mut table = Table::new()
        .column("requirement", "", Align::Left)
        .column("holds", "", Align::Left)
        .column("value", "", Align::Point)
        .column("limit", "", Align::Point)
        .column("", "", Align::Left)
        .column("margin", "[%]", Align::Point)
        .column("error ≤", "", Align::Right);
    for requirement in list {
        table.row(cells(requirement));
    }
    table
}

fn cells(requirement: &Requirement) -> Vec<Cell> {
    let holds = match requirement.holds {
        Some(true) => "yes",
        Some(false) => "NO",
        None => "?",
    };
    let value = requirement.shown_value();
    let limit = requirement.shown_limit();
    let relative = requirement.limit.as_ref().is_some_and(|limit| !limit.may_be_zero());
    let margin = requirement.margin.filter(|_| relative).map(|margin| margin * Ball::from(100.0));
    vec![
        Named { text: requirement.text.clone(), place: Some(requirement.span) }.into(),
        holds.into(),
        match (&value, &requirement.value) {
            (Some(value), _) => figure(value, DIGITS).into(),
            (None, answer::Value::None(_)) => "?".into(),
            (None, _) => requirement.value_text().into_owned().into(),
        },
        limit.as_ref().map(|limit| figure(limit, DIGITS)).into(),
        limit.as_ref().map_or_else(Cell::default, |limit| limit.unit.to_string().into()),
        margin.map(|margin| Figure::ball(margin, FEW)).into(),
        value.map(|value| Figure::bound(Bound::of_midpoint(value.number))).into(),
    ]
}

fn figure(shown: &Shown, digits: usize) -> Figure {
    Figure::number(shown.exact.clone().unwrap_or(Number::Ball(shown.number)), digits)
}
