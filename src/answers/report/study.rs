//! A study: the range of each column over all cases, and which cases stopped.

use super::table::{Align, Cell, Table};
use super::{Block, Figure, Line, Report, Section, line};
use crate::answers::ranges::Ranges;
use crate::questions::answer::{Case, Column, Entry, Holds, few_digits};

const DIGITS: usize = 6;

/// A normal variable is as close to its mean as so many standard deviations with a probability of 95 %.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// The least and the largest value of each column, with the cases that have them.
pub fn study(model: &str, columns: &[Column], ranges: &Ranges) -> Report {
    let title = line![model.to_string(), " · ", count(ranges.cases, "case", "cases")];
    let of =
        |wanted: fn(Holds) -> bool| columns.iter().zip(&ranges.columns).filter(move |(column, _)| wanted(column.holds));
    let mut table = Table::of([
        ("", Align::Left),
        ("unit", Align::Left),
        ("least", Align::Point),
        ("at", Align::Left),
        ("largest", Align::Point),
        ("at", Align::Left),
        ("error ≤", Align::Right),
        ("", Align::Left),
    ]);
    for (column, range) in of(|holds| holds != Holds::Verdict) {
        let mut cells: Vec<Cell> = vec![column.name.clone().into(), column.unit.clone().into()];
        let is_given = column.holds == Holds::Parameter;
        match &range.ends {
            Some(ends) => {
                for (value, case) in ends {
                    match is_given {
                        true => cells.extend([few_digits(value.to_f64()).into(), Cell::default()]),
                        false => cells.extend([Figure::ball(*value, DIGITS).into(), place(columns, case).into()]),
                    }
                }
            }
            None => cells.extend(["?".into(), Cell::default(), "?".into(), Cell::default()]),
        }
        cells.push(range.bound.filter(|_| !is_given).map_or_else(Cell::default, |bound| Figure::bound(bound).into()));
        cells.push(remark(range.infinite, range.unproven, range.none).into());
        table.row(cells);
    }
    let mut statistics = Table::of([
        ("", Align::Left),
        ("unit", Align::Left),
        ("mean", Align::Point),
        ("±, 95 %", Align::Right),
        ("standard deviation", Align::Point),
    ]);
    for (column, range) in of(|holds| holds != Holds::Verdict).filter(|_| ranges.random) {
        let (number, mean, squares) = range.moments;
        let number_of = number as f64;
        // A mean without the cases that have no finite value is none of the distribution.
        let is_whole = number == ranges.cases && number > 1;
        let deviation = (squares / (number_of - 1.0)).sqrt();
        let within = NORMAL_95 * deviation / number_of.sqrt();
        let cell = |value: f64| if is_whole { Cell::from(few_digits(value)) } else { Cell::from("?") };
        statistics.row(vec![
            column.name.clone().into(),
            column.unit.clone().into(),
            cell(mean),
            cell(within),
            cell(deviation),
        ]);
    }
    let estimated = if statistics.rows.is_empty() { Vec::new() } else { vec![Block::from(statistics)] };
    let mut verdicts = Table::of([
        ("requirement", Align::Left),
        ("holds", Align::Right),
        ("fails", Align::Right),
        ("not decided", Align::Right),
    ]);
    for (column, range) in of(|holds| holds == Holds::Verdict) {
        let counts = [range.holds, range.fails, range.none].map(|count| Cell::from(Line::from(count as usize)));
        verdicts.row([vec![column.name.clone().into()], counts.to_vec()].concat());
    }
    let required = if verdicts.rows.is_empty() { Vec::new() } else { vec![Block::from(verdicts)] };
    let codes = ranges.codes.iter().map(|(code, number, first)| {
        let line = line![count(*number, "case", "cases"), " with ", *code, ", the first at ", place(columns, first)];
        Block::Line(line.and(": `vibc explain ").and(*code).and("`"))
    });
    Report::new(
        title,
        [
            Section::new("Ranges", [table.into()]),
            Section::new("Estimates", estimated),
            Section::new("Requirements", required),
            Section::new("Stopped", codes),
        ],
    )
}

fn count(number: u64, one: &'static str, many: &'static str) -> Line {
    line![number as usize, "\u{a0}", if number == 1 { one } else { many }]
}

/// `k = 5 N/m, m2 = 0.1 kg`
fn place(columns: &[Column], case: &Case) -> Line {
    let given = columns.iter().zip(&case.entries).filter(|(column, _)| column.holds == Holds::Parameter);
    let mut line = Line::default();
    for (column, entry) in given {
        let value = if let Entry::Enclosed(value) = entry { value.to_f64() } else { f64::NAN };
        let unit = if column.unit.is_empty() { "" } else { "\u{a0}" };
        let comma = if line.is_empty() { "" } else { ", " };
        let given = format!("{}\u{a0}=\u{a0}{}{unit}{}", column.name, few_digits(value), column.unit);
        line = line.and(comma).and(given);
    }
    line
}

/// Cases without a number.
fn remark(infinite: u64, unproven: u64, none: u64) -> Line {
    let mut line = Line::default();
    for (number, what) in [(infinite, "infinite"), (unproven, "without a bound"), (none, "without a value")] {
        if number > 0 {
            let comma = if line.is_empty() { "" } else { ", " };
            line = line.and(comma).and(number as usize).and("\u{a0}").and(what);
        }
    }
    line
}
