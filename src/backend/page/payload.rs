//! The data that the page's script animates and draws: plain numbers, rounded to seven digits. Numbers for readers are
//! in the tables of the report, with their bounds.

use super::{Answers, Bend, Movement, Movements, Page};
use crate::analysis::fractions::{Curve, Share};
use crate::analysis::{Extremum, FeatureKind, Gain};
use crate::backend::decimal::certain;
use crate::kernel::complex::Complex;
use crate::lower::Carried;
use crate::picture::moving::MovingPart;
use crate::picture::{Item, Moving};
use crate::questions::answer::{Sensitivity, Slope};
use serde::Serialize;
use serde_json::{Value, json};

/// The payload as text within an element of a page.
pub fn payload(page: &Page) -> String {
    let value = page.answers.as_ref().map_or(Payload::default(), answers);
    // Nothing in it may end the element that contains it.
    crate::backend::json_text(&value).replace('<', "\\u003c")
}

/// The fields in the order of their names, as `json!` has them elsewhere.
#[derive(Default, Serialize)]
struct Payload {
    #[serde(skip_serializing_if = "Option::is_none")]
    figure: Option<FigureData>,
    #[serde(skip_serializing_if = "Option::is_none")]
    items: Option<Vec<String>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    motion: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    motions: Option<Vec<MotionData>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    poles: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    slopes: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    transfer: Option<Value>,
}

fn answers(of: &Answers) -> Payload {
    let items = items(of);
    let name = |item: &Item| match item {
        Item::Body(body) => format!("b{body}"),
        Item::Element(element) => format!("e{element}"),
    };
    let moves = of.movements.basis.len() == of.system.n();
    Payload {
        figure: of.figure.ok().filter(|_| moves).map(|(_, moving)| figure(moving, of.movements)),
        motions: Some(motions(of, &items)),
        items: Some(items.iter().map(name).collect()),
        poles: Some(of.poles.iter().map(pole).collect()),
        transfer: of.transfer.map(|_| transfer(of)),
        motion: of.motion.map(|_| motion(of)),
        slopes: (!of.sensitivities.is_empty()).then(|| slopes(of.sensitivities)),
    }
}

/// An object of parts that are moved into it; `json!` would copy each of them, at every level once more.
fn object<const N: usize>(parts: [(&str, Value); N]) -> Value {
    parts.into_iter().map(|(key, value)| (key.to_string(), value)).collect()
}

/// A number of a picture, to seven digits; `null` if it is not finite.
fn plain(x: f64) -> Value {
    let x = round::<7>(x);
    match x {
        _ if !x.is_finite() => Value::Null,
        _ if x == x.trunc() && x.abs() < 1e9 => Value::from(x as i64),
        _ => Value::from(x),
    }
}

/// Powers of ten that binary64 holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// A number with `DIGITS` decimal digits close to this one. A page has thousands of them, so the number is not
/// formatted and parsed.
fn round<const DIGITS: usize>(x: f64) -> f64 {
    let size = x.abs();
    let whole = POWERS[DIGITS];
    if size >= whole || size == 0.0 || !size.is_finite() {
        let written = || format!("{x:.*e}", DIGITS - 1).parse::<f64>();
        return if size == 0.0 || x.is_nan() { x } else { written().unwrap_or(x) };
    }
    // The power that brings it to DIGITS digits before the point.
    let scale = POWERS.iter().find(|power| size * **power >= POWERS[DIGITS - 1]);
    match scale {
        Some(scale) => (x * scale).round() / scale,
        None => format!("{x:.*e}", DIGITS - 1).parse().unwrap_or(x),
    }
}

/// A number that curves are computed from, whole.
fn exact(x: f64) -> Value {
    if x.is_finite() { json!(x) } else { Value::Null }
}

fn list(values: impl IntoIterator<Item = f64>) -> Value {
    values.into_iter().map(plain).collect()
}

/// How the figure moves, which the page's script computes with.
#[derive(Serialize)]
struct FigureData {
    /// For each coordinate, the values that it moves.
    basis: Vec<Vec<Slot>>,
    /// Pairs of coordinates, and the values that their product moves.
    bends: Vec<(usize, usize, Vec<Slot>)>,
    /// The number of a piece, where it carries the part, and the part's axes on the page.
    parts: Vec<[Value; 7]>,
    pieces: Vec<PieceData>,
    /// The number of values.
    slots: usize,
}

/// The index of a value, in the order of [`Poses::values`](crate::lower::Poses::values), and by how much it moves.
type Slot = (usize, Value);

#[derive(Serialize)]
struct PieceData {
    anchor: Option<[Value; 2]>,
    angle: Value,
    /// -1 for the ground, which has none.
    carrier: i64,
    /// Direction, and the place at rest.
    slides: Vec<[Value; 3]>,
}

/// The values that are not zero.
fn slots(values: impl Iterator<Item = f64>) -> Vec<Slot> {
    values.enumerate().filter(|(_, value)| *value != 0.0).map(|(slot, value)| (slot, plain(value))).collect()
}

fn figure(moving: &Moving, movements: &Movements) -> FigureData {
    let part = |part: &MovingPart| {
        let [x, y] = part.axes;
        [part.piece as f64, part.from.x, part.from.y, x.x, x.y, y.x, y.y].map(plain)
    };
    let piece = |(index, piece): (usize, &Carried)| PieceData {
        anchor: piece.anchor.filter(|_| index > 0).map(|anchor| anchor.map(plain)),
        angle: plain(piece.angle.rest),
        carrier: if index == 0 { -1 } else { i64::from(piece.carrier) },
        slides: piece.slides.iter().map(|([x, y], value)| [*x, *y, value.rest].map(plain)).collect(),
    };
    let bend = |bend: &Bend| (bend.by[0], bend.by[1], slots(bend.values.iter().copied()));
    FigureData {
        basis: movements.basis.iter().map(|by| slots(by.iter().map(|by| by.shape))).collect(),
        bends: movements.bends.iter().map(bend).collect(),
        parts: moving.parts.iter().map(part).collect(),
        pieces: moving.poses.pieces.iter().enumerate().map(piece).collect(),
        slots: moving.poses.values().count(),
    }
}

/// Every body and element that has a share of some motion's energy, in order.
fn items(of: &Answers) -> Vec<Item> {
    let mut items: Vec<Item> =
        of.movements.list.iter().flat_map(|movement| movement.energy.iter().map(|(item, _)| *item)).collect();
    items.sort_unstable();
    items.dedup();
    items
}

/// A motion that the figure can be shown in.
#[derive(Default, Serialize)]
struct MotionData {
    amount: Value,
    /// The shares of energy of the items; empty if they are not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    energy: Option<Vec<Value>>,
    kind: &'static str,
    /// The coordinates, and the part that is a quarter of a period ahead if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    q: Option<Vec<Value>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    qi: Option<Vec<Value>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    s: Option<[Value; 2]>,
    says: &'static str,
}

fn motions(of: &Answers, items: &[Item]) -> Vec<MotionData> {
    let over_time = of.motion.map(|motion| MotionData {
        kind: "time",
        amount: plain(motion.amount),
        says: "the motion over time",
        ..MotionData::default()
    });
    of.movements.list.iter().map(|of| movement(of, items)).chain(over_time).collect()
}

fn movement(of: &Movement, items: &[Item]) -> MotionData {
    let energy = if of.energy.is_empty() { Vec::new() } else { shares(&of.energy, items) };
    let says = match energy.is_empty() {
        true => "",
        false => "coloured by share of the energy: springs of the strain energy, bodies of the kinetic energy",
    };
    let turns = of.shape.iter().any(|x| x.im != 0.0);
    MotionData {
        kind: "mode",
        s: Some([of.s.re, of.s.im].map(plain)),
        q: Some(of.shape.iter().map(|x| plain(x.re)).collect()),
        qi: turns.then(|| of.shape.iter().map(|x| plain(x.im)).collect()),
        amount: plain(of.amount),
        energy: Some(energy),
        says,
    }
}

/// The shares of the items, in their order.
fn shares(energy: &[(Item, f64)], items: &[Item]) -> Vec<Value> {
    let mut shares = vec![Value::from(0); items.len()];
    for (item, part) in energy {
        if let Ok(place) = items.binary_search(item) {
            shares[place] = plain(*part);
        }
    }
    shares
}

fn pole(of: &super::PoleShown) -> Value {
    object([("s", list([of.s.re, of.s.im])), ("title", of.title.as_str().into()), ("motion", of.movement.into())])
}

fn transfer(of: &Answers) -> Value {
    let Some(shown) = of.transfer else { return Value::Null };
    let (system, table) = (of.system, &shown.table);
    let inputs = table
        .inputs
        .iter()
        .map(|&i| json!({ "name": system.display(system.inputs[i].name), "unit": system.inputs[i].unit }));
    let outputs = table
        .outputs
        .iter()
        .map(|&o| json!({ "name": system.display(system.outputs[o].name), "unit": system.outputs[o].unit }));
    let pairs = (0..table.inputs.len()).map(|i| (0..table.outputs.len()).map(|o| pair(of, i, o)).collect::<Value>());
    let entry = |(i, j, entry): (usize, usize, [f64; 3])| {
        [json!(i), json!(j)].into_iter().chain(entry.map(exact)).collect::<Value>()
    };
    let matrices = shown.pencil.as_ref().map(|pencil| pencil.entries().map(entry).collect::<Value>());
    let ends = [table.rows.first(), table.rows.last()].map(|row| row.map_or(1.0, |row| row.frequency.to_f64()));
    object([
        ("inputs", inputs.collect()),
        ("outputs", outputs.collect()),
        ("pairs", pairs.collect()),
        ("range", list(ends)),
        ("centres", shown.centres.iter().map(|f| exact(*f)).collect()),
        ("matrices", matrices.into()),
        ("size", system.n().into()),
    ])
}

fn pair(of: &Answers, input: usize, output: usize) -> Value {
    let Some(shown) = of.transfer else { return Value::Null };
    let extrema = shown.table.extrema.as_ref().map(|extrema| &extrema[input][output].list[..]);
    let marks = extrema.unwrap_or_default().iter().map(mark).collect::<Value>();
    let curve = match &shown.curves[input][output] {
        Some(Curve::Fractions(curve)) => Some(curve),
        Some(Curve::Solved(solved)) => {
            let share = |share: &Share| json!([share.power, share.coordinate, exact(share.weight)]);
            return object([
                ("b", solved.input.iter().map(share).collect()),
                ("p", solved.output.iter().map(share).collect()),
                ("feed", solved.feed.iter().map(|x| exact(*x)).collect()),
                ("marks", marks),
            ]);
        }
        None => None,
    };
    let Some(curve) = curve else {
        let sample = |row: &crate::analysis::Row| match row.gains[input][output] {
            Gain::Finite(disc) => {
                let Complex { re, im } = disc.value.to_f64();
                list([row.frequency.to_f64(), re, im])
            }
            Gain::Infinite | Gain::Unknown => json!([plain(row.frequency.to_f64()), null, null]),
        };
        return object([("samples", shown.table.rows.iter().map(sample).collect()), ("marks", marks)]);
    };
    let term = |part: &crate::analysis::fractions::Fraction| {
        let numbers = part.numerator.iter().chain(&part.denominator).map(|x| exact(*x));
        std::iter::once(json!(part.power)).chain(numbers).collect::<Value>()
    };
    let terms = curve.list.iter().filter(|part| part.numerator != [0.0; 2]);
    object([
        ("terms", terms.map(term).collect()),
        ("feed", curve.feed.iter().map(|x| exact(*x)).collect()),
        ("marks", marks),
    ])
}

fn mark(of: &Extremum) -> Value {
    const DIGITS: usize = 6;
    let gain = match of.gain {
        Gain::Finite(disc) => Some(disc.gain()),
        Gain::Infinite | Gain::Unknown => None,
    };
    let says = match (of.gain, gain) {
        (_, Some(gain)) => certain(&gain, DIGITS),
        (Gain::Infinite, _) => "infinite".into(),
        _ => "unknown".into(),
    };
    json!({
        "f": exact(of.frequency.mid.to_f64()),
        "gain": gain.map(|gain| plain(gain.mid.to_f64())),
        "down": of.kind == FeatureKind::Antiresonance,
        "title": format!("{} at {} Hz, gain {says}", of.kind.name(), certain(&of.frequency, DIGITS)),
    })
}

/// Relative changes per parameter, for bars; `null` if there is no derivative.
fn slopes(of: &[Sensitivity]) -> Value {
    let value = |slope: &Option<Slope>| match slope {
        Some(Slope::Smooth { relative, .. }) if relative.is_finite() => plain(relative.to_f64()),
        _ => Value::Null,
    };
    let row = |one: &Sensitivity| one.frequencies.iter().chain(&one.ratios).map(value).collect::<Value>();
    json!({
        "parameters": of.iter().map(|one| json!(one.parameter)).collect::<Value>(),
        "values": of.iter().map(row).collect::<Value>(),
    })
}

fn motion(of: &Answers) -> Value {
    let Some(shown) = of.motion else { return Value::Null };
    let outputs = of.system.outputs.iter().enumerate().map(|(index, output)| {
        let values = shown.history.values.iter().map(|row| row[index].mid.to_f64());
        let (name, unit) = (of.system.display(output.name).to_string(), output.unit.as_str());
        object([("name", name.into()), ("unit", unit.into()), ("values", short(values))])
    });
    object([
        ("times", short(shown.history.times.iter().map(|time| time.to_f64()))),
        ("outputs", outputs.collect()),
        ("states", shown.states.iter().map(|row| short(row.iter().copied())).collect()),
    ])
}

/// Samples of curves, of which a page has thousands: five digits.
fn short(values: impl IntoIterator<Item = f64>) -> Value {
    values.into_iter().map(|x| plain(round::<5>(x))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding gives the same as formatting with that number of digits; the last digit may differ by one if the next
    /// ones are about a half.
    #[test]
    fn numbers_have_so_many_digits() {
        let mut state = 1u64;
        for _ in 0..20_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let fraction = (state >> 11) as f64 / (1u64 << 53) as f64;
            let x = (fraction - 0.5) * 10f64.powi((state % 60) as i32 - 30);
            let (found, written) = (round::<7>(x), format!("{x:.6e}").parse::<f64>().unwrap());
            assert!((found - written).abs() <= 1.000001e-6 * written.abs(), "{x:e}: {found:e}, {written:e}");
            assert!((found - x).abs() <= 0.500001e-6 * x.abs(), "{x:e}: {found:e}");
            assert_eq!(format!("{found:.6e}").parse::<f64>().unwrap(), found, "{x:e} has no more than seven digits");
        }
        assert_eq!([round::<5>(0.0), round::<5>(1.0), round::<5>(-2.5e-3)], [0.0, 1.0, -2.5e-3]);
        assert!(plain(f64::NAN).is_null() && plain(f64::INFINITY).is_null());
        assert_eq!(plain(3.0), json!(3));
    }
}
