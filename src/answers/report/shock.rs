//! Shock response spectra: the request behind each, and some of its frequencies.

use super::table::{Align, Cell, Table};
use super::{Block, Figure, Line, Report, Section, line};
use crate::analysis::shock::{Quantity, ShockRow, Sides};
use crate::answers::{Shock, ShockOf};
use crate::base::{Ball, Bound, Number};

const DIGITS: usize = 6;
/// Number of frequencies that are shown.
const MOST_ROWS: usize = 40;

/// A report for each base.
pub fn shock(shock: &Shock) -> Vec<Report> {
    shock.list.iter().map(|of| Report::new(title(&shock.model, of), [section(of)])).collect()
}

/// `drop · shock response spectrum of table: pseudo-acceleration [m/s^2], damping 5 %`
fn title(model: &str, of: &ShockOf) -> Line {
    let spectrum = &of.spectrum;
    let percent = Number::from(100);
    let damping = Figure::number(&spectrum.damping * &percent, DIGITS).unit("%");
    let quantity = quantity(spectrum.quantity);
    line![
        model.to_string(),
        " · shock response spectrum of ",
        of.input.clone(),
        ": ",
        quantity,
        " [",
        of.unit,
        "], damping ",
        damping
    ]
}

pub fn quantity(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::PseudoAcceleration => "pseudo-acceleration",
        Quantity::RelativeDisplacement => "relative displacement",
    }
}

fn section(of: &ShockOf) -> Section {
    let rows = &of.spectrum.rows;
    let every = rows.len().div_ceil(MOST_ROWS).max(1);
    let mut table = Table::new().column("f", "[Hz]", Align::Point).column("maximax", "", Align::Point);
    for title in ["primary +", "primary -", "residual +", "residual -"] {
        table = table.column(title, "", Align::Point);
    }
    let mut table = table.column("error of maximax ≤", "", Align::Right);
    for row in rows.iter().step_by(every) {
        table.row(cells(row));
    }
    let end = Figure::number(of.spectrum.end.clone(), DIGITS).unit("s");
    let mut blocks: Vec<Block> =
        vec![Block::Line(line!["primary: until the last event of the signal, ", end, "; residual: from then on"])];
    if let Some(largest) = largest(rows) {
        let at = Figure::number(largest.frequency.clone(), DIGITS).unit("Hz");
        let value = figure(largest.maximax()).unit(of.unit);
        blocks.push(Block::Line(line!["largest of these frequencies: ", value, " at ", at]));
    }
    blocks.push(table.into());
    if every > 1 {
        let total = rows.len();
        blocks.push(Block::Line(line!["one in ", every, " of ", total, " frequencies (--format csv has all)"]));
    }
    Section::new("Shock response spectrum", blocks)
}

fn largest(rows: &[ShockRow]) -> Option<&ShockRow> {
    let is_larger = |a: &ShockRow, b: &ShockRow| (a.maximax() - b.maximax()).mid.hi > 0.0;
    rows.iter().reduce(|best, row| if is_larger(row, best) { row } else { best })
}

fn cells(row: &ShockRow) -> Vec<Cell> {
    let maximax = row.maximax();
    let mut cells = vec![Figure::number(row.frequency.clone(), DIGITS).into(), figure(maximax).into()];
    for Sides { positive, negative } in [row.primary, row.residual] {
        // Magnitudes: a negative side is shown with its sign.
        let negative = if negative.is_zero() { negative } else { -negative };
        cells.extend([Cell::from(figure(positive)), figure(negative).into()]);
    }
    cells.push(Figure::bound(Bound::of_midpoint(maximax)).into());
    cells
}

fn figure(value: Ball) -> Figure {
    Figure::ball(value, DIGITS)
}
