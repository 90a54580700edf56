//! The sensitivities of frequencies and damping ratios: a row for each parameter.

use super::questions::derivative;
use super::table::{Align, Cell, Table};
use super::{Block, Figure, Line, Section, line};
use crate::answers::ModalAnswer;
use crate::base::Number;
use crate::questions::answer::{Sensitivity, Slope};

/// Number of frequencies and of ratios that have a column.
const MOST_COLUMNS: usize = 5;
/// Number of parameters that have a row.
const MOST_ROWS: usize = 40;
const DIGITS: usize = 4;
const VALUE: usize = 6;

pub fn section(answer: &ModalAnswer) -> Section {
    const HEADING: &str = "Sensitivities";
    let list = &answer.sensitivities;
    let Some(one) = list.first() else { return Section::new(HEADING, []) };
    let (frequencies, ratios) = (one.frequencies.len(), one.ratios.len());
    let mut table = Table::of([("parameter", Align::Left), ("value", Align::Point), ("", Align::Left)]);
    for i in 0..frequencies.min(MOST_COLUMNS) {
        table = table.column(line!["f ", one.first + i], "[%/%]", Align::Point);
    }
    for i in 0..ratios.min(MOST_COLUMNS) {
        table = table.column(line!["ζ ", i + 1], "[%/%]", Align::Point);
    }
    for sensitivity in list.iter().take(MOST_ROWS) {
        table.row(cells(sensitivity));
    }
    let cut = frequencies > MOST_COLUMNS || ratios > MOST_COLUMNS || list.len() > MOST_ROWS;
    let caption =
        "sensitivities: change of undamped frequency and damping ratio for a change of the parameter, both in percent";
    let more = cut.then(|| Block::Line("... and more (--format json has all)".into()));
    Section::new(HEADING, [Block::Line(caption.into()), table.into()].into_iter().chain(more))
}

fn cells(sensitivity: &Sensitivity) -> Vec<Cell> {
    let shown = sensitivity.in_unit();
    let value = Figure::number(shown.exact.clone().unwrap_or(Number::Ball(shown.number)), VALUE);
    let slopes = sensitivity.frequencies.iter().take(MOST_COLUMNS).chain(sensitivity.ratios.iter().take(MOST_COLUMNS));
    let cells = vec![sensitivity.parameter.clone().into(), value.into(), shown.unit.to_string().into()];
    cells.into_iter().chain(slopes.map(|slope| Cell::from(slope_text(slope)))).collect()
}

fn slope_text(slope: &Option<Slope>) -> Line {
    match slope {
        None => Line::default(),
        Some(Slope::Splits(_)) => "splits".into(),
        Some(Slope::NotComputed) => "-".into(),
        Some(Slope::Undefined) => "none".into(),
        Some(Slope::Smooth { relative, .. }) if relative.is_finite() => derivative(relative, DIGITS),
        // A change from zero has no percentage.
        Some(Slope::Smooth { absolute, .. }) => if absolute.to_f64() == 0.0 { "0" } else { "from 0" }.into(),
    }
}
