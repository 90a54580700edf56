//! The motion in time: the range and the final value of each output, and the steady state under harmonic signals.

use super::table::{Align, Cell, Table};
use super::transfer::hundredths;
use super::{Block, Figure, Line, Report, Section, line};
use crate::analysis::{Gain, History, Steady, is_passive};
use crate::base::Number;
use crate::system::LinearSystem;

const DIGITS: usize = 6;

/// The least, the largest and the last value of each output, with the largest error of all its samples.
pub fn motion(model: &str, system: &LinearSystem, history: &History, steady: &[Steady]) -> Report {
    let until = Figure::number(history.times.last().cloned().unwrap_or(Number::ZERO), DIGITS).unit("s");
    let title = line![model.to_string(), " · motion until ", until, ", ", history.times.len(), " samples"];
    let mut table = Table::of([
        ("output", Align::Left),
        ("unit", Align::Left),
        ("least", Align::Point),
        ("at [s]", Align::Point),
        ("largest", Align::Point),
        ("at [s]", Align::Point),
        ("at the end", Align::Point),
        ("error ≤", Align::Right),
    ]);
    for (i, output) in system.outputs.iter().enumerate() {
        table.row(cells(system.display(output.name), &output.unit, history, i));
    }
    let steady = if steady.is_empty() { Vec::new() } else { steady_state(system, steady) };
    Report::new(title, [Section::new("Motion", [table.into()]), Section::new("Steady state", steady)])
}

fn steady_state(system: &LinearSystem, steady: &[Steady]) -> Vec<Block> {
    let mut table = Table::new()
        .column("output", "", Align::Left)
        .column("unit", "", Align::Left)
        .column("f", "[Hz]", Align::Point)
        .column("amplitude", "", Align::Point)
        .column("phase", "[deg]", Align::Point)
        .column("error ≤", "", Align::Right);
    for part in steady {
        for (output, gain) in system.outputs.iter().zip(&part.outputs) {
            let [amplitude, phase, error] = match gain {
                Gain::Finite(disc) => [
                    Figure::ball(disc.gain(), DIGITS).into(),
                    disc.phase().map(hundredths).into(),
                    Figure::bound(disc.error_bound()).into(),
                ],
                Gain::Infinite => ["infinite".into(), Cell::default(), "exact".into()],
                Gain::Unknown => ["?".into(), Cell::default(), "?".into()],
            };
            let (name, unit) = (system.display(output.name), output.unit.clone());
            let frequency = Figure::number(part.frequency.clone(), DIGITS);
            table.row(vec![name.into(), unit.into(), frequency.into(), amplitude, phase, error]);
        }
    }
    let caption = if is_passive(system) {
        "steady state, without the free motion: amplitude × sin(2π f t + phase)"
    } else {
        "periodic part, amplitude × sin(2π f t + phase); the free motion may grow"
    };
    vec![Line::from(caption).into(), table.into()]
}

fn cells(name: String, unit: &str, history: &History, output: usize) -> Vec<Cell> {
    let value = |sample: usize| history.values[sample][output];
    let known = || (0..history.values.len()).filter(|&i| value(i).is_finite());
    let by = |better: fn(f64, f64) -> bool| {
        known().reduce(|best, i| if better(value(i).to_f64(), value(best).to_f64()) { i } else { best })
    };
    let figure = |sample: usize| Cell::from(Figure::ball(value(sample), DIGITS));
    let time = |sample: usize| Cell::from(Figure::number(history.times[sample].clone(), DIGITS));
    let mut cells = vec![name.into(), unit.to_string().into()];
    for extreme in [by(|a, b| a < b), by(|a, b| a > b)] {
        cells.extend(extreme.map_or(["?".into(), Cell::default()], |i| [figure(i), time(i)]));
    }
    cells.push(history.values.len().checked_sub(1).map_or_else(Cell::default, figure));
    cells.push(Figure::bound(history.error_bound(output)).into());
    cells
}
