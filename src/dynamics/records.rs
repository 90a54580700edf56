//! Records of accelerations that leave a base moving: the velocity that remains after the last row. In: a scene. Out: a
//! note for each such table. See spec.md#signals.

use super::laws::short;
use crate::base::{Ball, Code, Diagnostic, Number};
use crate::model::CheckedScene;
use crate::model::scene::{InputKind, Signal, TableRows};

const DRIFT: Code = Code::model("vib::table::drift");

/// A note for each record of an acceleration after which its base moves on.
pub fn drifts(scene: &CheckedScene) -> Vec<Diagnostic> {
    let scene = scene.scene();
    let mut notes = Vec::new();
    for input in &scene.inputs {
        let InputKind::Base { base, translation } = &input.kind else { continue };
        let (length, rate) = if translation.is_some() { ("m", "m/s") } else { ("rad", "rad/s") };
        for signal in &input.signal {
            let Signal::Table { span, rows: Some(rows), .. } = signal else { continue };
            if input.derivative != 2 {
                continue;
            }
            let [place, speed] = end(rows).map(Ball::abs);
            if !speed.contains_zero() {
                let name = scene.words.display(scene.bases[base.index()].name);
                let message = format!(
                    "after this record the base `{name}` moves on at about {} {rate}, {} {length} from where it began",
                    short(speed.to_f64()),
                    short(place.to_f64()),
                );
                let help =
                    "motions relative to the base do not feel it; for others, use a record that is corrected for drift";
                notes.push(Diagnostic::note(DRIFT, *span, message).help(help));
            }
        }
    }
    notes
}

/// Displacement and velocity after the last row, with an acceleration that is linear between the rows and has its first value
/// before them.
fn end(rows: &TableRows) -> [Ball; 2] {
    let zero = Number::ZERO;
    let before = rows.times.first().map(|first| (&zero, first, 0, 0)).filter(|(_, first, ..)| first.is_positive());
    let between = rows.times.windows(2).enumerate().map(|(i, pair)| (&pair[0], &pair[1], i, i + 1));
    let (mut u, mut v) = (Ball::ZERO, Ball::ZERO);
    for (from, to, i, j) in before.into_iter().chain(between).filter(|(_, to, ..)| to.is_positive()) {
        let [mut a, b] = [i, j].map(|row| rows.values[row].to_ball());
        let mut h = (to - from).to_ball();
        if from.is_negative() {
            // The base is at rest at t = 0, whatever the record says about earlier times.
            a = b + (a - b) * to.to_ball() / h;
            h = to.to_ball();
        }
        u = u + h * v + h.square() * (a + a + b) / Ball::from(6.0);
        v = v + h * (a + b) * Ball::from(0.5);
    }
    [u, v]
}
