//! Warnings that accompany a table: values of which nothing is known, or few digits. In: a table and the places of the outputs. Out: findings. See docs/method/transfer.md.

use super::Gain;
use super::table::Table;
use crate::base::{Code, Diagnostic, Number, Span};
use crate::system::LinearSystem;

const UNSETTLED: Code = Code::limit("vib::limit::transfer");

/// Limit of a bound relative to its value. The bound of each value stands beside it, so next to a pole, where all values are
/// known less well, a table needs no warning until fewer digits are left than are read off one.
const FEW_DIGITS: f64 = 1e-6;

/// One warning for each pair with values that are not known well, or as well as `tolerance` asks.
pub fn findings(system: &LinearSystem, table: &Table, tolerance: Option<f64>, places: &[Span]) -> Vec<Diagnostic> {
    let enough = tolerance.map_or(FEW_DIGITS, |tolerance| tolerance.max(FEW_DIGITS));
    let mut list = Vec::new();
    for (i, input) in table.inputs.iter().enumerate() {
        for (j, output) in table.outputs.iter().enumerate() {
            let Some(&place) = places.get(*output) else { continue };
            let pair = Pair::of(table, (i, j), enough);
            let names = [system.inputs[*input].name, system.outputs[*output].name].map(|name| system.display(name));
            list.extend(pair.message(&names).map(|message| {
                Diagnostic::warning(UNSETTLED, place, message)
                    .help("ask for other frequencies, or choose stiffnesses and masses of more similar magnitude")
            }));
        }
    }
    list
}

/// What is not settled about one pair of input and output.
#[derive(Default)]
struct Pair {
    rows: usize,
    unknown: usize,
    first_unknown: Option<Number>,
    /// The largest bound relative to its value, and where.
    widest: Option<(f64, Number)>,
}

impl Pair {
    fn of(table: &Table, (i, j): (usize, usize), enough: f64) -> Pair {
        let disc = |gain: &Gain| gain.disc().map(|disc| (disc.value.to_f64().abs(), disc.radius));
        let mut sizes: Vec<f64> = table.rows.iter().filter_map(|row| Some(disc(&row.gains[i][j])?.0)).collect();
        sizes.sort_by(f64::total_cmp);
        // Beside an antiresonance next to nothing is left of a value: its digits count from those of the others on.
        let middle = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
        let mut pair = Pair { rows: table.rows.len(), ..Pair::default() };
        for row in &table.rows {
            let (size, radius) = match &row.gains[i][j] {
                Gain::Infinite => continue,
                Gain::Unknown => (0.0, f64::INFINITY),
                gain => disc(gain).unwrap_or((0.0, f64::INFINITY)),
            };
            if !radius.is_finite() {
                pair.unknown += 1;
                pair.first_unknown.get_or_insert_with(|| row.frequency.clone());
            } else if radius > enough * size.max(middle) {
                let relative = radius / size;
                if pair.widest.as_ref().is_none_or(|(widest, _)| relative > *widest) {
                    pair.widest = Some((relative, row.frequency.clone()));
                }
            }
        }
        pair
    }

    fn message(&self, [input, output]: &[String; 2]) -> Option<String> {
        if let Some(at) = &self.first_unknown {
            let (unknown, rows) = (self.unknown, self.rows);
            return Some(format!(
                "nothing is known of {unknown} of the {rows} values of `{output}` from `{input}`, the first at {} Hz",
                hertz(at)
            ));
        }
        let (relative, at) = self.widest.as_ref()?;
        let at = hertz(at);
        Some(match *relative < 1.0 {
            true => format!(
                "few digits of `{output}` from `{input}` are certain: at {at} Hz its relative error is up to {relative:.1e}"
            ),
            false => format!("no digit of `{output}` from `{input}` is certain at {at} Hz"),
        })
    }
}

fn hertz(at: &Number) -> String {
    let at = at.to_f64();
    if at == 0.0 || (1e-9..1e16).contains(&at) { at.to_string() } else { format!("{at:e}") }
}
