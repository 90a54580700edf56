//! What was solved for, and how the requirements stand.

use super::super::decimal::{certain, certain_number, upper};
use super::table::{Align, Table};
use super::{INDENT, line};
use crate::base::{Ball, Number, Unproven};
use crate::questions::answer::{Derivative, Others, Requirement, Shown, Solved};

/// Digits of what was solved for: all that a double holds.
const MOST: usize = 16;
const DIGITS: usize = 6;
const FEW: usize = 3;

pub fn solved(list: &[Solved]) -> String {
    if list.is_empty() {
        return String::new();
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
        let shown = solved.shown();
        let target = solved.shown_target();
        table.row(vec![
            solved.parameter.clone(),
            number(&shown, MOST),
            shown.unit.to_string(),
            solved.shown_bound().map_or_else(|| "?".to_string(), upper),
            format!("{} = {}", solved.measure, with_unit(&target, DIGITS)),
            upper(solved.residual.magnitude()),
            solved.relative_slope().map_or(String::new(), |slope| derivative(&slope, FEW)),
        ]);
    }
    let others: String = list.iter().filter_map(others).map(line).collect();
    line("solved") + &table.text(INDENT) + &others + &followed(list.iter().find_map(|solved| solved.until.as_ref()))
}

/// What is not proven of the range that a value was looked for in.
fn others(solved: &Solved) -> Option<String> {
    let name = &solved.parameter;
    match &solved.others {
        Others::None(_) => None,
        Others::Unsettled(parts) => {
            let parts: Vec<String> = parts.iter().map(|(low, high)| format!("{low} .. {high}")).collect();
            Some(format!("{name}: the one found; not settled is {}, elsewhere there is no other", parts.join(", ")))
        }
        Others::Unknown => {
            let looks = solved.looked_at;
            Some(format!("{name}: the one found with {looks} values tried; others are not excluded"))
        }
    }
}

/// An enclosed derivative to the digits that are certain; one that is not proven to few, and marked.
pub fn derivative(derivative: &Derivative, digits: usize) -> String {
    match derivative {
        Derivative::Enclosed(ball) => certain(ball, digits),
        Derivative::Seen(Unproven(x)) => format!("≈{}", few_digits_of(*x)),
    }
}

fn few_digits_of(x: f64) -> String {
    certain(&Ball::from(x), 3)
}

pub fn requirements(list: &[Requirement]) -> String {
    if list.is_empty() {
        return String::new();
    }
    line("requirements") + &table(list)
}

/// The requirements of several models, each line with its model's name.
pub fn checked(model: &str, list: &[Requirement]) -> String {
    if list.is_empty() { String::new() } else { format!("{model}\n") + &table(list) }
}

/// How long `peak` and `rms` follow the motion, where one of them is asked.
fn followed(until: Option<&Number>) -> String {
    until.map_or(String::new(), |until| {
        line(format!("peak and rms are those of the motion up to {} s (--until)", certain_number(until, DIGITS)))
    })
}

fn table(list: &[Requirement]) -> String {
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
    table.text(INDENT) + &followed(list.iter().find_map(|requirement| requirement.until.as_ref()))
}

fn cells(requirement: &Requirement) -> Vec<String> {
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
        requirement.text.clone(),
        holds.to_string(),
        value.as_ref().map_or_else(|| requirement.told().into_owned(), |value| number(value, DIGITS)),
        limit.as_ref().map_or(String::new(), |limit| number(limit, DIGITS)),
        limit.as_ref().map_or("", |limit| limit.unit).to_string(),
        margin.map_or(String::new(), |margin| certain(&margin, FEW)),
        value.map_or(String::new(), |value| upper(value.number.relative_error())),
    ]
}

fn number(shown: &Shown, most: usize) -> String {
    certain_number(shown.exact.as_ref().unwrap_or(&Number::Ball(shown.number)), most)
}

fn with_unit(shown: &Shown, most: usize) -> String {
    let number = number(shown, most);
    if shown.unit.is_empty() { number } else { format!("{number} {}", shown.unit) }
}
