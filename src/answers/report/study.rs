//! A study: the range of each column over all cases, and which cases stopped.

use super::table::{Align, Cell, Table};
use super::{Block, Figure, Line, Report, Section, line};
use crate::answers::ranges::{Drawing, MOST_KEPT, Moments, Range, Ranges};
use crate::kernel::binomial;
use crate::questions::answer::Followed;
use crate::questions::answer::{Case, Column, Entry, Holds, REPLICATES, few_digits};

const DIGITS: usize = 6;

/// Number of standard deviations within which a normal variable lies with a probability of 95 %.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Like [`NORMAL_95`], for Student's distribution of 15 degrees of freedom.
const STUDENT_95: f64 = 2.131_449_545_559_323;

/// The least and the largest value of each column, with the cases that have them.
pub fn study(model: &str, columns: &[Column], ranges: &Ranges, followed: Option<&Followed>) -> Report {
    // Random values say little and are many: the number of the case finds them.
    let at = |case: &Case| match ranges.is_random() {
        true => line!["case\u{a0}", case.number as usize],
        false => place(columns, case),
    };
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
    for (column, range) in of(|holds| !matches!(holds, Holds::Verdict | Holds::Link)) {
        let mut cells: Vec<Cell> = vec![column.name.clone().into(), column.unit.clone().into()];
        let is_given = column.holds == Holds::Parameter;
        match &range.ends {
            Some(ends) => {
                for (value, case) in ends {
                    match is_given {
                        true => cells.extend([few_digits(value.to_f64()).into(), Cell::default()]),
                        false => cells.extend([Figure::ball(*value, DIGITS).into(), at(case).into()]),
                    }
                }
            }
            None => cells.extend(["?".into(), Cell::default(), "?".into(), Cell::default()]),
        }
        cells.push(range.bound.filter(|_| !is_given).map_or_else(Cell::default, |bound| Figure::bound(bound).into()));
        cells.push(remark(range).into());
        table.row(cells);
    }
    let mut statistics = Table::of([
        ("", Align::Left),
        ("unit", Align::Left),
        ("mean", Align::Point),
        ("±, 95 %", Align::Right),
        ("standard deviation", Align::Point),
    ]);
    for (column, range) in of(|holds| holds != Holds::Verdict).filter(|_| ranges.is_random()) {
        // A mean without the cases that have no finite value is none of the distribution.
        let is_whole = range.moments.number == ranges.cases && ranges.cases > 1;
        let cell = |value: f64| if is_whole { Cell::from(few_digits(value)) } else { Cell::from("?") };
        statistics.row(vec![
            column.name.clone().into(),
            column.unit.clone().into(),
            cell(range.moments.mean),
            cell(half_width(range)),
            cell(range.moments.deviation()),
        ]);
    }
    let estimated = if statistics.rows.is_empty() { Vec::new() } else { vec![Block::from(statistics)] };
    let estimated: Vec<Block> = estimated.into_iter().chain(quantiles(columns, ranges)).collect();
    // Without random cases the last column stays empty.
    let probability_heading = if ranges.is_random() { "probability, 95 %" } else { "" };
    let mut verdicts = Table::of([
        ("requirement", Align::Left),
        ("holds", Align::Right),
        ("fails", Align::Right),
        ("not decided", Align::Right),
        (probability_heading, Align::Right),
    ]);
    for (column, range) in of(|holds| holds == Holds::Verdict) {
        let counts = [range.holds, range.fails, range.none].map(|count| Cell::from(Line::from(count as usize)));
        let estimate = if ranges.is_random() { probability(range, ranges.cases).into() } else { Cell::default() };
        verdicts.row([vec![column.name.clone().into()], counts.to_vec(), vec![estimate]].concat());
    }
    let required = if verdicts.rows.is_empty() { Vec::new() } else { vec![Block::from(verdicts)] };
    let codes = ranges.codes.iter().map(|(code, number, first)| {
        let line = line![count(*number, "case", "cases"), " with ", *code, ", the first at ", at(first)];
        Block::Line(line.and(": `vibc explain ").and(*code).and("`"))
    });
    Report::new(
        title,
        [
            Section::new("Estimates", estimated),
            Section::new("Ranges", [table.into()]),
            followed.map_or_else(|| Section::new("Curves", []), super::curves::section),
            Section::new("Requirements", required),
            Section::new("Stopped", codes),
        ],
    )
}

/// Between which values quantiles lie, in at least 95 % of all studies whatever the distribution.
fn quantiles(columns: &[Column], ranges: &Ranges) -> Vec<Block> {
    if ranges.drawing != Drawing::Independent || ranges.cases < 2 {
        return Vec::new();
    }
    if !ranges.keeps_values() {
        return vec![Block::Line(
            format!("no quantiles: they need every value, and {MOST_KEPT} are kept at most").into(),
        )];
    }
    let wanted = [0.05, 0.5, 0.95].map(|p| binomial::ranks_of_quantile(p, ranges.cases));
    let mut table = Table::of([
        ("", Align::Left),
        ("unit", Align::Left),
        ("5 % quantile, 95 %", Align::Right),
        ("median, 95 %", Align::Right),
        ("95 % quantile, 95 %", Align::Right),
    ]);
    for (column, range) in columns.iter().zip(&ranges.columns).filter(|(column, _)| has_values(column)) {
        let mut sorted = range.values.clone();
        sorted.sort_by(f64::total_cmp);
        let is_whole = sorted.len() as u64 == ranges.cases;
        let at = |rank: Option<u64>| match rank.filter(|_| is_whole) {
            Some(rank) => few_digits(sorted[rank as usize - 1]),
            None => "?".into(),
        };
        let names = [Cell::from(column.name.clone()), column.unit.clone().into()];
        let intervals = wanted.map(|[low, high]| Cell::from(format!("{} .. {}", at(low), at(high))));
        table.row([&names[..], &intervals].concat());
    }
    vec![table.into()]
}

/// Whether a column holds numbers of a distribution.
fn has_values(column: &Column) -> bool {
    !matches!(column.holds, Holds::Verdict | Holds::Link)
}

/// Half of the 95 % confidence interval of a mean.
fn half_width(range: &Range) -> f64 {
    match range.replicates.is_empty() {
        true => NORMAL_95 * range.moments.deviation() / (range.moments.number as f64).sqrt(),
        false => of_means(&Moments::of(range.replicates.iter().map(|(moments, _)| moments.mean))),
    }
}

/// Half-width of the 95 % confidence interval of a mean that is itself the mean of the replicates' means.
fn of_means(means: &Moments) -> f64 {
    STUDENT_95 * means.deviation() / (REPLICATES as f64).sqrt()
}

/// The interval of the probability that a requirement holds; its ends are rounded outwards. Cases that are not decided may go either way.
fn probability(range: &Range, cases: u64) -> String {
    let [least, most] = match range.replicates.is_empty() {
        true => {
            [binomial::least_probability(range.holds, cases), 1.0 - binomial::least_probability(range.fails, cases)]
        }
        false => {
            let share = |which: usize| {
                let own = range.replicates.iter().map(|(_, verdicts)| verdicts[which] as f64);
                Moments::of(own.map(|number| number * REPLICATES as f64 / cases as f64))
            };
            let [holds, fails] = [share(0), share(1)];
            // Replicates that agree say nothing about how far they are off.
            if holds.deviation() == 0.0 || fails.deviation() == 0.0 {
                return "?".into();
            }
            [(holds.mean - of_means(&holds)).max(0.0), (1.0 - fails.mean + of_means(&fails)).min(1.0)]
        }
    };
    format!("{} .. {}", few_digits((least * 1e4).floor() / 1e4), few_digits((most * 1e4).ceil() / 1e4))
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
fn remark(range: &Range) -> Line {
    let mut line = Line::default();
    let kinds = [(range.infinite, "infinite"), (range.unproven, "without a bound"), (range.none, "without a value")];
    for (number, what) in kinds {
        if number > 0 {
            let comma = if line.is_empty() { "" } else { ", " };
            line = line.and(comma).and(number as usize).and("\u{a0}").and(what);
        }
    }
    match range.reason {
        Some(reason) => line.and(": ").and(reason),
        None => line,
    }
}
