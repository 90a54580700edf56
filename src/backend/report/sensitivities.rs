//! What moves the frequencies and damping ratios: a row for each parameter.

use super::super::decimal::certain_number;
use super::questions::derivative;
use super::table::{Align, Table};
use super::{INDENT, line};
use crate::answers::ModalAnswer;
use crate::base::Number;
use crate::questions::answer::{Sensitivity, Slope};

/// Frequencies and ratios that have a column.
const MOST_COLUMNS: usize = 5;
/// Parameters that have a row.
const MOST_ROWS: usize = 40;
const DIGITS: usize = 4;
const VALUE: usize = 6;

pub fn text(answer: &ModalAnswer) -> String {
    let list = &answer.sensitivities;
    let Some(one) = list.first() else { return String::new() };
    let (frequencies, ratios) = (one.frequencies.len(), one.ratios.len());
    let mut table =
        Table::new().column("parameter", "", Align::Left).column("value", "", Align::Point).column("", "", Align::Left);
    for i in 0..frequencies.min(MOST_COLUMNS) {
        table = table.column(format!("f {}", one.first + i), "[%/%]", Align::Point);
    }
    for i in 0..ratios.min(MOST_COLUMNS) {
        table = table.column(format!("ζ {}", i + 1), "[%/%]", Align::Point);
    }
    for sensitivity in list.iter().take(MOST_ROWS) {
        table.row(cells(sensitivity));
    }
    let cut = frequencies > MOST_COLUMNS || ratios > MOST_COLUMNS || list.len() > MOST_ROWS;
    let more = if cut { line("... and more (--format json has all)") } else { String::new() };
    line("sensitivities: change of undamped frequency and damping ratio for a change of the parameter, both in percent")
        + &table.text(INDENT)
        + &more
}

fn cells(sensitivity: &Sensitivity) -> Vec<String> {
    let shown = sensitivity.shown();
    let value = certain_number(shown.exact.as_ref().unwrap_or(&Number::Ball(shown.number)), VALUE);
    let slopes = |list: &[Option<Slope>]| list.iter().take(MOST_COLUMNS).map(told).collect::<Vec<String>>();
    let mut cells = vec![sensitivity.parameter.clone(), value, shown.unit.to_string()];
    cells.extend(slopes(&sensitivity.frequencies));
    cells.extend(slopes(&sensitivity.ratios));
    cells
}

fn told(slope: &Option<Slope>) -> String {
    match slope {
        None => String::new(),
        Some(Slope::Splits(_)) => "splits".to_string(),
        Some(Slope::NotComputed) => "-".to_string(),
        Some(Slope::Undefined) => "none".to_string(),
        Some(Slope::Smooth { relative, .. }) if relative.is_finite() => derivative(relative, DIGITS),
        // Of what is zero there is no percentage.
        Some(Slope::Smooth { absolute, .. }) => if absolute.to_f64() == 0.0 { "0" } else { "from 0" }.to_string(),
    }
}
