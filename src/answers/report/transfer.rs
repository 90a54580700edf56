//! Transfer functions: the peaks, antiresonances and half-power widths of each pair of input and output, or the rows of a
//! requested grid.

use super::table::{Align, Cell, Table};
use super::{Block, Figure, Line, Report, Section, Value, enumeration, line};
use crate::analysis::{self, Extrema, Gain};
use crate::base::{Ball, Number};
use crate::system::LinearSystem;

/// Significant digits of a value.
const DIGITS: usize = 6;
/// Number of rows that are shown of a requested grid.
const MOST_ROWS: usize = 40;
/// Maximum number of intervals that are listed if something is not proved.
const MOST_INTERVALS: usize = 3;

/// A report for each pair of an input and an output.
pub fn transfer(model: &str, system: &LinearSystem, table: &analysis::Table) -> Vec<Report> {
    let pairs = (0..table.inputs.len()).flat_map(|i| (0..table.outputs.len()).map(move |o| (i, o)));
    pairs.map(|(i, o)| Report::new(title(model, system, table, i, o), [section(table, i, o)])).collect()
}

/// `absorber · x [m] from F [N], 0.1 Hz to 10 Hz`
fn title(model: &str, system: &LinearSystem, table: &analysis::Table, input: usize, output: usize) -> Line {
    let (from, to) = (&system.inputs[table.inputs[input]], &system.outputs[table.outputs[output]]);
    let to = line![system.display(to.name), " [", to.unit.clone(), "]"];
    let from = line![system.display(from.name), " [", from.unit, "]"];
    line![model.to_string(), " · ", to, " from ", from, range(table)]
}

/// `, 0.1 Hz to 10 Hz`
fn range(table: &analysis::Table) -> Line {
    match &table.rows[..] {
        [first, .., last] => line![", ", hertz(&first.frequency).unit("Hz"), " to ", hertz(&last.frequency).unit("Hz")],
        _ => Line::default(),
    }
}

fn hertz(frequency: &Number) -> Figure {
    Figure::number(frequency.clone(), DIGITS)
}

fn section(table: &analysis::Table, input: usize, output: usize) -> Section {
    match &table.extrema {
        Some(extrema) => {
            let extrema = &extrema[input][output];
            let open = not_proved(extrema).map(Block::from);
            let points = Block::Table(points(extrema, table, input, output));
            Section::new("Peaks and antiresonances", [points].into_iter().chain(open))
        }
        None => Section::new("Values", rows(table, input, output)),
    }
}

fn columns(table: Table) -> Table {
    table.column("f", "[Hz]", Align::Point).column("gain", "", Align::Point).column("", "[dB]", Align::Point).column(
        "phase",
        "[deg]",
        Align::Point,
    )
}

fn points(extrema: &Extrema, table: &analysis::Table, input: usize, output: usize) -> Table {
    let mut points = columns(Table::of([("", Align::Left)])).column("half-power width", "[Hz]", Align::Point).column(
        "error ≤",
        "",
        Align::Right,
    );
    let mut row = |name: &'static str, frequency: Figure, gain: Gain, width: Option<Ball>| {
        let [gain, level, phase, error] = values(gain);
        let width = width.map(|width| Figure::ball(width, 4));
        points.row(vec![name.into(), frequency.into(), gain, level, phase, width.into(), error]);
    };
    if let Some(end) = table.rows.first() {
        row("low end", hertz(&end.frequency), end.gains[input][output], None);
    }
    for extremum in &extrema.list {
        row(extremum.kind.name(), Figure::ball(extremum.frequency, DIGITS), extremum.gain, extremum.width);
    }
    if let Some(end) = table.rows.last() {
        row("high end", hertz(&end.frequency), end.gains[input][output], None);
    }
    points
}

/// The intervals in which there may be more extrema than are listed.
fn not_proved(extrema: &Extrema) -> Option<Line> {
    if extrema.complete.is_some() {
        return None;
    }
    let end = |hertz: f64| Figure::ball(Ball::from(hertz), DIGITS).unit("Hz");
    let interval = |(from, to): &(f64, f64)| line![end(*from), " to ", end(*to)];
    let more = extrema.open.len().saturating_sub(MOST_INTERVALS);
    let more = (more > 0).then(|| line![more, " more intervals"]);
    let intervals = enumeration(extrema.open.iter().take(MOST_INTERVALS).map(interval).chain(more));
    let places = if intervals.is_empty() { intervals } else { line![" from ", intervals] };
    Some(line!["not proved: that there is no other peak or antiresonance", places])
}

fn rows(table: &analysis::Table, input: usize, output: usize) -> Vec<Block> {
    let mut list = columns(Table::new()).column("error ≤", "", Align::Right);
    for row in table.rows.iter().take(MOST_ROWS) {
        let frequency = Cell::from(hertz(&row.frequency));
        list.row([frequency].into_iter().chain(values(row.gains[input][output])).collect());
    }
    let more = table.rows.len().saturating_sub(MOST_ROWS);
    let more = (more > 0).then(|| Block::Line(line!["... and ", more, " more (--format csv has all)"]));
    [list.into()].into_iter().chain(more).collect()
}

/// The gain, its level in dB, its phase and the bound.
fn values(gain: Gain) -> [Cell; 4] {
    let none = Cell::default;
    match gain {
        Gain::Infinite => ["infinite".into(), none(), none(), "exact".into()],
        Gain::Unknown => ["?".into(), none(), none(), "?".into()],
        Gain::Finite(disc) => [
            Figure::ball(disc.gain(), DIGITS).into(),
            disc.level().map(hundredths).into(),
            disc.phase().map(hundredths).into(),
            Figure::bound(disc.error_bound()).into(),
        ],
    }
}

pub(super) fn hundredths(value: Ball) -> Figure {
    Figure::of(Value::Hundredths(value))
}
