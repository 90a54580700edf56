//! The motion in time: a panel for each unit, a curve for each output.

use super::{Axis, Curve, Entry, Panel, Plot, Sample, Scale, Style, svg};
use crate::analysis::History;
use crate::system::LinearSystem;

const HEIGHT: f64 = 220.0;
/// Columns of a panel; if several samples fall into one column, only its extremes are drawn.
const COLUMNS: usize = 850;

/// The whole file.
pub fn plot(model: &str, system: &LinearSystem, history: &History) -> String {
    let mut units: Vec<&str> = Vec::new();
    for output in &system.outputs {
        if !units.contains(&output.unit.as_str()) {
            units.push(&output.unit);
        }
    }
    let rows = units.into_iter().map(|unit| vec![of_unit(system, history, unit)]).collect();
    svg(&Plot { title: format!("{model}: motion"), rows })
}

fn of_unit(system: &LinearSystem, history: &History, unit: &str) -> Panel {
    let outputs = system.outputs.iter().enumerate().filter(|(_, output)| output.unit == unit);
    let outputs: Vec<(usize, String)> = outputs.map(|(index, output)| (index, system.display(output.name))).collect();
    let times: Vec<f64> = history.times.iter().map(crate::base::Number::to_f64).collect();
    let curves: Vec<Curve> = outputs
        .iter()
        .enumerate()
        .map(|(number, (index, _))| {
            let values = history.values.iter().map(|row| row[*index].mid.to_f64());
            Curve { points: column_extremes(times.iter().copied().zip(values).collect()), style: Style::Curve(number) }
        })
        .collect();
    let values = curves.iter().flat_map(|curve| curve.points.iter().map(|(_, value)| *value));
    // Zero, where motions start, is always visible.
    let title = match &outputs[..] {
        [(_, name)] => format!("{name} [{unit}]"),
        _ => format!("outputs [{unit}]"),
    };
    let y = Axis::holding(title, Scale::Linear, values.chain([0.0]));
    let entry =
        |number: usize, name: &str| Entry { style: Style::Curve(number), sample: Sample::Line, text: name.into() };
    let (from, to) = (times.first().copied().unwrap_or(0.0), times.last().copied().unwrap_or(1.0));
    Panel {
        heading: outputs.iter().map(|(_, name)| name.as_str()).collect::<Vec<_>>().join(", "),
        x: Axis::tight("time [s]", Scale::Linear, from, to),
        y,
        height: HEIGHT,
        legend: outputs.iter().enumerate().map(|(number, (_, name))| entry(number, name)).collect(),
        curves,
        marks: Vec::new(),
    }
}

/// The first, the lowest, the highest and the last of the samples in each column, in their order.
fn column_extremes(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let each = points.len().div_ceil(COLUMNS);
    if each <= 4 {
        return points;
    }
    let mut kept = Vec::with_capacity(4 * COLUMNS);
    for column in points.chunks(each) {
        let index = |best: fn(f64, f64) -> bool| {
            (0..column.len()).fold(0, |found, k| if best(column[k].1, column[found].1) { k } else { found })
        };
        let mut places = [0, index(|a, b| a < b), index(|a, b| a > b), column.len() - 1];
        places.sort_unstable();
        for (k, place) in places.into_iter().enumerate() {
            if k == 0 || places[k - 1] != place {
                kept.push(column[place]);
            }
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_every_extreme() {
        let points: Vec<(f64, f64)> =
            (0..100_000).map(|k| (f64::from(k), if k == 54_321 { 9.0 } else { 0.0 })).collect();
        let kept = column_extremes(points);
        assert!(kept.len() <= 4 * COLUMNS && kept.contains(&(54_321.0, 9.0)));
        assert!(kept.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
}
