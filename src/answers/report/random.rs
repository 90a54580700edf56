//! Outputs under noise: root mean squares and three times that, zero crossings, and the contributions of the modes.

use super::table::{Align, Cell, Table};
use super::{Block, Figure, Line, Options, Section, line};
use crate::analysis::{Noisy, Peak, Spread};
use crate::answers::ModalAnswer;
use crate::base::{Ball, Bound, OrderBy, Unproven, first_by};

const DIGITS: usize = 6;
/// Modes are named until they make up this much.
const COVERED: f64 = 0.98;
const MOST: usize = 3;

pub fn section(answer: &ModalAnswer, options: &Options) -> Section {
    const HEADING: &str = "Noise";
    if answer.noisy.is_empty() {
        return Section::new(HEADING, []);
    }
    let mut table = Table::new()
        .column("output", "", Align::Left)
        .column("unit", "", Align::Left)
        .column("rms", "", Align::Point)
        .column("3 sigma", "", Align::Point)
        .column("crossings", "[Hz]", Align::Point)
        .column("error of rms ≤", "", Align::Right)
        .column("modes", "", Align::Left);
    let mut reasons = Vec::new();
    for noisy in &answer.noisy {
        let output = &answer.system.outputs[noisy.output];
        let name = answer.system.display(output.name);
        table.row(cells(&name, &output.unit, noisy, options.digits(DIGITS)));
        // A reason that applies to both is shown once.
        let of_rms = reason(&noisy.rms);
        let of_crossings = reason(&noisy.crossings).filter(|why| of_rms != Some(*why));
        for (what, why) in [("rms of ", of_rms), ("crossings of ", of_crossings)] {
            if let Some(why) = why {
                reasons.push(Block::Item(line![what, name.clone(), ": ", why.to_string()]));
            }
        }
    }
    let peaks = peaks(answer, options);
    let intro =
        Block::Line("stationary response to noise (one-sided densities; 3 sigma is three times the rms)".into());
    Section::new(HEADING, [intro, Block::Table(table)].into_iter().chain(reasons).chain(peaks))
}

/// The highest peaks of each density, by frequency.
fn peaks(answer: &ModalAnswer, options: &Options) -> Vec<Block> {
    let mut table = Table::new()
        .column("output", "", Align::Left)
        .column("peak", "[Hz]", Align::Point)
        .column("density", "", Align::Point)
        .column("unit", "", Align::Left)
        .column("error ≤", "", Align::Right);
    let mut reasons: Vec<Block> = Vec::new();
    let mut is_empty = true;
    for noisy in &answer.noisy {
        let output = &answer.system.outputs[noisy.output];
        let name = answer.system.display(output.name);
        let found = match &noisy.peaks {
            Ok(found) => found,
            Err(why) if matches!(noisy.rms, Spread::Finite(_)) => {
                reasons.push(Block::Item(line!["peaks of the density of ", name, ": ", why.to_string()]));
                continue;
            }
            // The reason is already in the list.
            Err(_) => continue,
        };
        let mut highest: Vec<&Peak> = first_by(found, MOST, |a, b| b.density.to_f64().total_cmp(&a.density.to_f64()));
        highest.order_by(|a, b| a.frequency.to_f64().total_cmp(&b.frequency.to_f64()));
        for peak in highest {
            is_empty = false;
            let bound = Bound::of_midpoint(peak.frequency).or_larger(Bound::of_midpoint(peak.density));
            table.row(vec![
                name.clone().into(),
                Figure::ball(peak.frequency, options.digits(DIGITS)).into(),
                Figure::ball(peak.density, options.digits(DIGITS)).into(),
                density_unit(&output.unit).into(),
                line![Figure::bound(bound)].into(),
            ]);
        }
    }
    let table = (!is_empty).then_some(Block::Table(table));
    table.into_iter().chain(reasons).collect()
}

fn reason(spread: &Spread) -> Option<&str> {
    match spread {
        Spread::Finite(_) => None,
        Spread::Infinite(why) => Some(why),
        Spread::Unknown(why) => Some(why),
    }
}

fn cells(name: &str, unit: &str, noisy: &Noisy, digits: usize) -> Vec<Cell> {
    let shown = |spread: &Spread, factor: f64| -> Cell {
        match spread {
            Spread::Finite(value) => Figure::ball(*value * Ball::from(factor), digits).into(),
            Spread::Infinite(_) => "infinite".into(),
            Spread::Unknown(_) => "?".into(),
        }
    };
    let error = match &noisy.rms {
        Spread::Finite(value) => line![Figure::bound(Bound::of_midpoint(*value))],
        Spread::Infinite(_) => Line::default(),
        Spread::Unknown(_) => "?".into(),
    };
    vec![
        name.to_string().into(),
        unit.to_string().into(),
        shown(&noisy.rms, 1.0),
        shown(&noisy.rms, 3.0),
        shown(&noisy.crossings, 1.0),
        error.into(),
        shares(&noisy.shares).into(),
    ]
}

/// The unit of the density of an output with a unit: `mm^2/Hz`, `(m/s^2)^2/Hz`.
fn density_unit(unit: &str) -> String {
    match unit {
        "" => "1/Hz".to_string(),
        _ if unit.contains(['/', '*', '^']) => format!("({unit})^2/Hz"),
        _ => format!("{unit}^2/Hz"),
    }
}

/// `1 61 %, 2 39 %`
fn shares(list: &[(usize, Unproven)]) -> Line {
    let mut named = Line::default();
    let mut sum = 0.0;
    for (mode, share) in list.iter().take(MOST) {
        if sum >= COVERED {
            break;
        }
        let separator = if sum == 0.0 { "" } else { ", " };
        named = line![named, separator, *mode, ":\u{a0}", Figure::share(*share)];
        sum += share.0.abs();
    }
    named
}
