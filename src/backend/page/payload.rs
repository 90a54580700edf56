//! The data that the page's script animates and draws: plain numbers, rounded to seven digits. Numbers that are read stand in
//! the tables of the report, with their bounds.

use super::{Answers, Bend, Movement, Movements, Page};
use crate::analysis::{Extremum, FeatureKind, Gain};
use crate::backend::decimal::certain;
use crate::kernel::complex::Complex;
use crate::lower::Poses;
use crate::picture::{Item, Moving};
use crate::questions::answer::{Sensitivity, Slope};
use serde_json::{Map, Value, json};

/// The payload as text within an element of a page.
pub fn payload(page: &Page) -> String {
    let value = page.answers.as_ref().map_or(json!({}), answers);
    // Nothing in it ends the element that holds it.
    crate::backend::json_text(&value).replace('<', "\\u003c")
}

fn answers(of: &Answers) -> Value {
    let mut map = Map::new();
    if let Ok((_, moving)) = of.figure
        && of.movements.basis.len() == of.system.n()
    {
        map.insert("figure".into(), figure(moving, of.movements));
    }
    map.insert("motions".into(), motions(of));
    map.insert("poles".into(), of.poles.iter().map(pole).collect());
    if of.transfer.is_some() {
        map.insert("transfer".into(), transfer(of));
    }
    if of.motion.is_some() {
        map.insert("motion".into(), motion(of));
    }
    if !of.sensitivities.is_empty() {
        map.insert("slopes".into(), slopes(of.sensitivities));
    }
    Value::Object(map)
}

/// A number of a picture.
fn plain(x: f64) -> Value {
    const DIGITS: usize = 6;
    let rounded = format!("{x:.DIGITS$e}").parse::<f64>().ok().filter(|x| x.is_finite());
    rounded.map_or(Value::Null, |x| if x == x.trunc() && x.abs() < 1e9 { json!(x as i64) } else { json!(x) })
}

/// A number that curves are computed from, whole.
fn exact(x: f64) -> Value {
    if x.is_finite() { json!(x) } else { Value::Null }
}

fn list(values: impl IntoIterator<Item = f64>) -> Value {
    values.into_iter().map(plain).collect()
}

/// What is not zero of values in the order of [`Poses::values`], with its place.
fn slots(values: impl Iterator<Item = f64>) -> Value {
    values.enumerate().filter(|(_, value)| *value != 0.0).map(|(slot, value)| json!([slot, plain(value)])).collect()
}

fn figure(moving: &Moving, movements: &Movements) -> Value {
    let part = |part: &crate::picture::moving::MovingPart| {
        let [x, y] = part.axes;
        list([part.piece as f64, part.from.x, part.from.y, x.x, x.y, y.x, y.y])
    };
    let pieces = moving.poses.pieces.iter().enumerate().map(|(index, piece)| {
        json!({
            // The ground is carried by nothing.
            "carrier": if index == 0 { -1 } else { i64::from(piece.carrier) },
            "anchor": piece.anchor.filter(|_| index > 0).map(list),
            "angle": plain(piece.angle.rest),
            "slides": piece.slides.iter().map(|([x, y], value)| list([*x, *y, value.rest])).collect::<Value>(),
        })
    });
    let basis = movements.basis.iter().map(|poses: &Poses| slots(poses.values().map(|value| value.shape)));
    let bend = |bend: &Bend| json!([bend.by[0], bend.by[1], slots(bend.values.iter().copied())]);
    json!({
        "parts": moving.parts.iter().map(part).collect::<Value>(),
        "pieces": pieces.collect::<Value>(),
        "slots": moving.poses.values().count(),
        "basis": basis.collect::<Value>(),
        "bends": movements.bends.iter().map(bend).collect::<Value>(),
    })
}

fn motions(of: &Answers) -> Value {
    let mut all: Vec<Value> = of.movements.list.iter().map(movement).collect();
    if let Some(motion) = of.motion {
        all.push(json!({ "kind": "time", "amount": plain(motion.amount), "says": "the motion over time" }));
    }
    Value::Array(all)
}

fn movement(of: &Movement) -> Value {
    let item = |item: &Item| match item {
        Item::Body(body) => format!("b{body}"),
        Item::Element(element) => format!("e{element}"),
    };
    let energy: Map<String, Value> = of.energy.iter().map(|(of, part)| (item(of), plain(*part))).collect();
    let says = match energy.is_empty() {
        true => "",
        false => "coloured by share of the energy: springs of the strain energy, bodies of the kinetic energy",
    };
    let mut value = json!({
        "kind": "mode",
        "s": list([of.s.re, of.s.im]),
        "q": list(of.shape.iter().map(|x| x.re)),
        "amount": plain(of.amount),
        "energy": energy,
        "says": says,
    });
    if of.shape.iter().any(|x| x.im != 0.0) {
        value["qi"] = list(of.shape.iter().map(|x| x.im));
    }
    value
}

fn pole(of: &super::PoleShown) -> Value {
    json!({ "s": list([of.s.re, of.s.im]), "title": of.title, "motion": of.movement })
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
    let ends = [table.rows.first(), table.rows.last()].map(|row| row.map_or(1.0, |row| row.frequency.to_f64()));
    json!({
        "inputs": inputs.collect::<Value>(),
        "outputs": outputs.collect::<Value>(),
        "pairs": pairs.collect::<Value>(),
        "range": list(ends),
        "centres": shown.centres.iter().map(|f| exact(*f)).collect::<Value>(),
    })
}

fn pair(of: &Answers, input: usize, output: usize) -> Value {
    let Some(shown) = of.transfer else { return Value::Null };
    let extrema = shown.table.extrema.as_ref().map(|extrema| &extrema[input][output].list[..]);
    let marks = extrema.unwrap_or_default().iter().map(mark).collect::<Value>();
    let Some(curve) = &shown.curves[input][output] else {
        let sample = |row: &crate::analysis::Row| match row.gains[input][output] {
            Gain::Finite(disc) => {
                let Complex { re, im } = disc.value.to_f64();
                list([row.frequency.to_f64(), re, im])
            }
            Gain::Infinite | Gain::Unknown => json!([plain(row.frequency.to_f64()), null, null]),
        };
        return json!({ "samples": shown.table.rows.iter().map(sample).collect::<Value>(), "marks": marks });
    };
    let term = |part: &crate::analysis::fractions::Fraction| {
        let numbers = part.numerator.iter().chain(&part.denominator).map(|x| exact(*x));
        std::iter::once(json!(part.power)).chain(numbers).collect::<Value>()
    };
    let terms = curve.list.iter().filter(|part| part.numerator != [0.0; 2]);
    json!({
        "terms": terms.map(term).collect::<Value>(),
        "feed": curve.feed.iter().map(|x| exact(*x)).collect::<Value>(),
        "marks": marks,
    })
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

/// Relative changes by parameter, for bars; null where there is no derivative.
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
        json!({ "name": of.system.display(output.name), "unit": output.unit, "values": short(values) })
    });
    json!({
        "times": short(shown.history.times.iter().map(|time| time.to_f64())),
        "outputs": outputs.collect::<Value>(),
        "states": shown.states.iter().map(|row| short(row.iter().copied())).collect::<Value>(),
    })
}

/// Samples of curves, of which a page has thousands: five digits.
fn short(values: impl IntoIterator<Item = f64>) -> Value {
    let value = |x: f64| format!("{x:.4e}").parse::<f64>().map_or(Value::Null, plain);
    values.into_iter().map(value).collect()
}
