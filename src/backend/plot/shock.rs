//! Shock response spectra: a panel for each base, with the largest motion at any time, during the signal and after it.

use super::{Axis, Curve, Entry, Panel, Plot, Sample, Scale, Style, svg};
use crate::analysis::shock::ShockRow;
use crate::answers::report::shock::quantity;
use crate::answers::{Shock, ShockOf};
use crate::base::Ball;

const HEIGHT: f64 = 300.0;
/// Decades that are shown below the largest value.
const DECADES: f64 = 4.0;
/// Shorter ranges have a linear axis.
const SHORT: f64 = 3.2;

/// The whole file.
pub fn plot(shock: &Shock) -> String {
    let rows = shock.list.iter().map(|of| vec![panel(of)]).collect();
    svg(&Plot { title: format!("{}: shock response spectra", shock.model), rows })
}

fn panel(of: &ShockOf) -> Panel {
    let rows = &of.spectrum.rows;
    let frequencies: Vec<f64> = rows.iter().map(|row| row.frequency.to_f64()).collect();
    let curve = |number: usize, value: fn(&ShockRow) -> Ball| Curve {
        points: frequencies.iter().copied().zip(rows.iter().map(|row| value(row).mid.to_f64())).collect(),
        style: Style::Curve(number),
    };
    let curves = vec![
        curve(0, ShockRow::maximax),
        curve(1, |row| row.primary.largest()),
        curve(2, |row| row.residual.largest()),
    ];
    let values = curves.iter().flat_map(|curve| curve.points.iter().map(|(_, value)| *value));
    let title = format!("{} [{}]", quantity(of.spectrum.quantity), of.unit);
    let y = Axis::holding(title, Scale::Decades, values).in_whole_decades(DECADES);
    let (low, high) = (frequencies.first().copied().unwrap_or(0.0), frequencies.last().copied().unwrap_or(1.0));
    let scale = if low > 0.0 && high / low > SHORT { Scale::Decades } else { Scale::Linear };
    let entry =
        |(number, text): (usize, &str)| Entry { style: Style::Curve(number), sample: Sample::Line, text: text.into() };
    Panel {
        heading: format!("shock response spectrum of {}", of.input),
        x: Axis::tight("frequency [Hz]", scale, low, high),
        y,
        height: HEIGHT,
        legend: ["maximax", "primary", "residual"].into_iter().enumerate().map(entry).collect(),
        curves,
        marks: Vec::new(),
    }
}
