//! Records of accelerations that leave a base moving: the velocity that remains after the last row. In: a scene. Out: a
//! note for each such table. See spec.md#signals.

use super::laws::short;
use crate::base::{Ball, Code, Diagnostic, Number};
use crate::model::CheckedScene;
use crate::model::scene::{InputKind, Signal, TableRows};

const DRIFT: Code = Code::model("vib::table::drift");

/// A note for each record after which its base moves on, and for each that comes again and lets its base drift away.
pub fn drifts(scene: &CheckedScene) -> Vec<Diagnostic> {
    let scene = scene.scene();
    let mut notes = Vec::new();
    for input in &scene.inputs {
        let InputKind::Base { base, translation } = &input.kind else { continue };
        let (length, rate) = if translation.is_some() { ("m", "m/s") } else { ("rad", "rad/s") };
        for signal in &input.signal {
            let Signal::Table { span, rows: Some(rows), period, .. } = signal else { continue };
            let name = scene.words.display(scene.bases[base.index()].name);
            let found = match (period, input.derivative) {
                (Some(period), 1 | 2) => drift(rows, period, input.derivative, &name, rate),
                (None, 2) => {
                    let [place, speed] = end(rows).map(Ball::abs);
                    (!speed.contains_zero()).then(|| {
                        let message = format!(
                            "after this record the base `{name}` moves on at about {} {rate}, {} {length} from where it began",
                            short(speed.to_f64()),
                            short(place.to_f64()),
                        );
                        let help = "motions relative to the base do not feel it; for others, use a record that is corrected for drift";
                        (message, help)
                    })
                }
                _ => None,
            };
            notes.extend(found.map(|(message, help)| Diagnostic::note(DRIFT, *span, message).help(help)));
        }
    }
    notes
}

/// What a velocity or an acceleration that comes again lets its base do, and what helps; `None` if the base comes back.
fn drift(rows: &TableRows, period: &Number, derivative: u8, name: &str, rate: &str) -> Option<(String, &'static str)> {
    let [mean, moment] = moments(rows, period);
    if !mean.contains_zero() {
        let (quantity, per) = if derivative == 1 { ("velocity", "") } else { ("acceleration", "^2") };
        let message = format!(
            "this {quantity} has the mean {} {rate}{per} over a period: the base `{name}` moves away",
            short(mean.to_f64())
        );
        return Some((
            message,
            "subtract the mean from the values; motions relative to the base feel none of a constant velocity",
        ));
    }
    // From rest the velocity is the integral of the acceleration, whose mean over a period is -moment / period.
    if derivative == 1 || moment.contains_zero() {
        return None;
    }
    let message = format!(
        "the base `{name}` starts at rest, so that under this acceleration it moves away at about {} {rate}",
        short((moment / period.to_ball()).abs().to_f64())
    );
    Some((
        message,
        "motions relative to the base do not feel it; for others, let the table begin where the velocity is zero",
    ))
}

/// Periods between t = 0 and a table's first row that are counted without rounding errors.
const MOST_PERIODS: f64 = 1e15;

/// The mean of a table over a period that begins at t = 0, and its integral times t.
fn moments(rows: &TableRows, period: &Number) -> [Ball; 2] {
    let n = rows.times.len();
    let third = Ball::ONE / Ball::from(3.0);
    let (mut area, mut moment) = (Ball::ZERO, Ball::ZERO);
    let first = rows.times.first().map_or(0.0, |first| (first / period).to_f64());
    // f64 cannot count this many periods exactly, so the mean is unknown.
    if first.abs() > MOST_PERIODS {
        return [Ball::ZERO.widen(f64::INFINITY); 2];
    }
    // The periods that begin before t = 0, and those that begin before its end.
    let start = (-first).floor() as i64 - 1;
    for k in start..=start + 3 {
        let shift = period * &Number::from(k);
        for i in 0..n {
            let from = &rows.times[i] + &shift;
            let (to, j) = match rows.times.get(i + 1) {
                Some(next) => (next + &shift, i + 1),
                None => (&(&rows.times[0] + &shift) + period, 0),
            };
            let width = &to - &from;
            let begin = if from.is_negative() { Number::ZERO } else { from.clone() };
            let finish = if (&to - period).is_positive() { period.clone() } else { to };
            if !width.is_positive() || !(&finish - &begin).is_positive() {
                continue;
            }
            let [left, right] = [i, j].map(|row| rows.values[row].to_ball());
            let value = |t: &Number| left + (right - left) * (t - &from).to_ball() / width.to_ball();
            let (a, b, t) = (value(&begin), value(&finish), begin.to_ball());
            let h = (&finish - &begin).to_ball();
            let own = h * (a + b) * Ball::from(0.5);
            area = area + own;
            moment = moment + t * own + h.square() * (a + b + b) * third * Ball::from(0.5);
        }
    }
    [area / period.to_ball(), moment]
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
