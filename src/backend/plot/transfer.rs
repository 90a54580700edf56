//! Transfer functions as a Bode plot: for each input gain and phase over frequency, a curve an output; peaks and
//! antiresonances marked with their frequencies.

use super::{Axis, Curve, Entry, Mark, Panel, Plot, Sample, Scale, Shape, Style, svg};
use crate::analysis::{Disc, Extremum, FeatureKind, Gain, Table};
use crate::backend::decimal::certain;
use crate::system::LinearSystem;

const HEIGHTS: [f64; 2] = [260.0, 170.0];
/// Decades of gain that are shown below the largest.
const DECADES: f64 = 8.0;
/// Digits of a marked frequency.
const DIGITS: usize = 4;
/// Steps of the phase beyond this are its turn from 180 to -180 degrees.
const WRAP: f64 = 180.0;
/// Ranges that are shorter than this have a linear axis: half a decade.
const SHORT: f64 = 3.2;

/// The whole file.
pub fn plot(model: &str, system: &LinearSystem, table: &Table) -> String {
    let rows = (0..table.inputs.len()).flat_map(|input| of_input(system, table, input)).collect();
    svg(&Plot { title: format!("{model}: transfer functions"), rows })
}

fn of_input(system: &LinearSystem, table: &Table, input: usize) -> Vec<Vec<Panel>> {
    let from = &system.inputs[table.inputs[input]];
    let name = system.display(from.name);
    let frequencies: Vec<f64> = table.rows.iter().map(|row| row.frequency.to_f64()).collect();
    let (low, high) = (frequencies.first().copied().unwrap_or(0.0), frequencies.last().copied().unwrap_or(1.0));
    let scale = if low > 0.0 && high / low > SHORT { Scale::Decades } else { Scale::Linear };
    let x = || Axis::tight("frequency [Hz]", scale, low, high);
    let gain = |row: usize, output: usize| table.rows[row].gains[input][output];
    let each = || 0..table.outputs.len();
    let sizes = each().flat_map(|o| (0..table.rows.len()).map(move |row| size(gain(row, o))));
    // Infinite and vanishing gains are marked at the edge.
    let y = Axis::holding(gain_title(system, table, from.unit), Scale::Decades, sizes).in_whole_decades(DECADES);
    let gains = each().map(|output| Curve {
        points: frequencies.iter().enumerate().map(|(row, f)| (*f, size(gain(row, output)))).collect(),
        style: Style::Curve(output),
    });
    let marks = each().flat_map(|output| {
        let found = table.extrema.as_ref().map(|extrema| &extrema[input][output].list[..]).unwrap_or_default();
        found.iter().map(move |extremum| mark(extremum, Style::Curve(output)))
    });
    let legend = each().map(|output| Entry {
        style: Style::Curve(output),
        sample: Sample::Line,
        text: system.display(system.outputs[table.outputs[output]].name),
    });
    let phases = each().map(|output| {
        let points = frequencies.iter().enumerate().map(|(row, f)| (*f, angle(gain(row, output))));
        Curve { points: unwrapped(points), style: Style::Curve(output) }
    });
    let above = Panel {
        heading: format!("gain from {name}"),
        x: x(),
        y,
        height: HEIGHTS[0],
        curves: gains.collect(),
        marks: marks.collect(),
        legend: Vec::new(),
    };
    let below = Panel {
        heading: format!("phase from {name}"),
        x: x(),
        y: Axis::holding("phase [deg]", Scale::Degrees, std::iter::empty()),
        height: HEIGHTS[1],
        curves: phases.collect(),
        marks: Vec::new(),
        legend: legend.collect(),
    };
    vec![vec![above], vec![below]]
}

/// `gain [m/N]`, where all outputs have one unit.
fn gain_title(system: &LinearSystem, table: &Table, from: &str) -> String {
    let mut units: Vec<&str> = table.outputs.iter().map(|output| system.outputs[*output].unit.as_str()).collect();
    units.dedup();
    match units[..] {
        [unit] if unit == from => "gain".into(),
        [unit] => format!("gain [{unit}/({from})]").replace("/(N)", "/N").replace("/(m)", "/m"),
        _ => format!("gain [unit of the output/({from})]"),
    }
}

fn size(gain: Gain) -> f64 {
    gain.disc().map_or(f64::NAN, |disc| disc.gain().mid.to_f64())
}

fn angle(gain: Gain) -> f64 {
    gain.disc().as_ref().and_then(Disc::phase).map_or(f64::NAN, |phase| phase.mid.to_f64())
}

/// The curve with gaps where the phase turns over.
fn unwrapped(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut list: Vec<(f64, f64)> = Vec::new();
    for (f, phase) in points {
        if list.last().is_some_and(|(_, before)| (phase - before).abs() > WRAP) {
            list.push((f, f64::NAN));
        }
        list.push((f, phase));
    }
    list
}

fn mark(extremum: &Extremum, style: Style) -> Mark {
    let (f, label) = (extremum.frequency.mid.to_f64(), format!("{} Hz", certain(&extremum.frequency, DIGITS)));
    let shape = match extremum.kind {
        FeatureKind::Peak => Shape::Peak,
        FeatureKind::Antiresonance => Shape::Dip,
    };
    match extremum.gain {
        Gain::Infinite => Mark::infinite(f, format!("{label}, infinite"), style),
        Gain::Finite(disc) => Mark { at: (f, disc.gain().mid.to_f64()), shape, label, style },
        Gain::Unknown => Mark { at: (f, f64::NAN), shape, label, style },
    }
}
