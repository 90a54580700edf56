//! Transfer functions as a Bode plot: for each input, gain and phase over frequency with a curve for each output; peaks
//! and antiresonances are marked with their frequencies.

use super::{Axis, Curve, Entry, Mark, Panel, Plot, Sample, Scale, Shape, Style, svg};
use crate::analysis::{Disc, Extremum, FeatureKind, Gain, Table};
use crate::backend::decimal::certain;
use crate::system::LinearSystem;

const HEIGHTS: [f64; 2] = [260.0, 170.0];
/// Decades of gain that are shown below the largest.
const DECADES: f64 = 8.0;
/// Digits of a marked frequency.
const DIGITS: usize = 4;
/// A larger step of the phase is its jump from 180 to -180 degrees.
const WRAP: f64 = 180.0;
/// Shorter ranges (half a decade) have a linear axis.
const SHORT: f64 = 3.2;

/// The whole file.
pub fn plot(model: &str, system: &LinearSystem, table: &Table) -> String {
    let rows = (0..table.inputs.len()).flat_map(|input| of_input(system, table, input)).collect();
    svg(&Plot { title: format!("{model}: transfer functions"), rows })
}

/// A gain panel for each unit of the outputs, then the phases of all.
fn of_input(system: &LinearSystem, table: &Table, input: usize) -> Vec<Vec<Panel>> {
    let shown = Shown::of(system, table, input);
    let mut units: Vec<&str> = Vec::new();
    for output in &table.outputs {
        let unit = system.outputs[*output].unit.as_str();
        if !units.contains(&unit) {
            units.push(unit);
        }
    }
    let mut rows: Vec<Vec<Panel>> = units.into_iter().map(|unit| vec![shown.gains(unit)]).collect();
    rows.push(vec![shown.phases()]);
    rows
}

/// The plot of one input.
struct Shown<'a> {
    system: &'a LinearSystem,
    table: &'a Table,
    input: usize,
    name: String,
    unit: &'a str,
    frequencies: Vec<f64>,
}

impl<'a> Shown<'a> {
    fn of(system: &'a LinearSystem, table: &'a Table, input: usize) -> Shown<'a> {
        let from = &system.inputs[table.inputs[input]];
        let frequencies = table.rows.iter().map(|row| row.frequency.to_f64()).collect();
        Shown { system, table, input, name: system.display(from.name), unit: from.unit, frequencies }
    }

    fn x(&self) -> Axis {
        let (low, high) = (self.frequencies.first().copied(), self.frequencies.last().copied());
        let (low, high) = (low.unwrap_or(0.0), high.unwrap_or(1.0));
        let scale = if low > 0.0 && high / low > SHORT { Scale::Decades } else { Scale::Linear };
        Axis::tight("frequency [Hz]", scale, low, high)
    }

    /// An output over frequency.
    fn curve(&self, output: usize, value: fn(Gain) -> f64) -> Vec<(f64, f64)> {
        let gains = self.table.rows.iter().map(|row| value(row.gains[self.input][output]));
        self.frequencies.iter().copied().zip(gains).collect()
    }

    fn gains(&self, unit: &str) -> Panel {
        let all = self.table.outputs.iter().enumerate();
        let own: Vec<usize> =
            all.filter(|(_, output)| self.system.outputs[**output].unit == unit).map(|(place, _)| place).collect();
        let curves: Vec<Curve> =
            own.iter().map(|o| Curve { points: self.curve(*o, size), style: Style::Curve(*o) }).collect();
        let sizes = curves.iter().flat_map(|curve| curve.points.iter().map(|(_, size)| *size));
        // Infinite and vanishing gains are marked at the edge.
        let y = Axis::holding(self.gain_title(unit), Scale::Decades, sizes).in_whole_decades(DECADES);
        let marks = own.iter().flat_map(|output| {
            let extrema = self.table.extrema.as_ref().map(|extrema| &extrema[self.input][*output].list[..]);
            extrema.unwrap_or_default().iter().map(|extremum| mark(extremum, Style::Curve(*output)))
        });
        Panel {
            heading: format!("gain from {}", self.name),
            x: self.x(),
            y,
            height: HEIGHTS[0],
            marks: marks.collect(),
            curves,
            legend: Vec::new(),
        }
    }

    fn phases(&self) -> Panel {
        let each = || self.table.outputs.iter().enumerate();
        let curve = |(place, _): (usize, &usize)| Curve {
            points: with_gaps_at_jumps(self.curve(place, angle).into_iter()),
            style: Style::Curve(place),
        };
        let entry = |(place, output): (usize, &usize)| Entry {
            style: Style::Curve(place),
            sample: Sample::Line,
            text: self.system.display(self.system.outputs[*output].name),
        };
        Panel {
            heading: format!("phase from {}", self.name),
            x: self.x(),
            y: Axis::holding("phase [deg]", Scale::Degrees, std::iter::empty()),
            height: HEIGHTS[1],
            curves: each().map(curve).collect(),
            marks: Vec::new(),
            legend: each().map(entry).collect(),
        }
    }

    /// `gain [m/N]`; a product in the denominator is bracketed.
    fn gain_title(&self, unit: &str) -> String {
        match self.unit {
            own if own == unit => "gain".into(),
            own if own.contains(['*', '/', ' ']) => format!("gain [{unit}/({own})]"),
            own => format!("gain [{unit}/{own}]"),
        }
    }
}

fn size(gain: Gain) -> f64 {
    gain.disc().map_or(f64::NAN, |disc| disc.gain().mid.to_f64())
}

fn angle(gain: Gain) -> f64 {
    gain.disc().as_ref().and_then(Disc::phase).map_or(f64::NAN, |phase| phase.mid.to_f64())
}

/// The curve with gaps where the phase jumps.
fn with_gaps_at_jumps(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
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
