//! Followed modes as curves of frequency over a parameter, with veerings, crossings and onsets of instability; with orders of a rate
//! of rotation, a Campbell diagram. A curve is interrupted where it is not proved that it goes on.

use super::{Axis, Curve, Entry, Mark, Panel, Plot, Sample, Scale, Shape, Style, svg};
use crate::base::Ball;
use crate::questions::answer::{Critical, Followed, Grows, Locus, Meeting, MeetingKind, Onset, few_digits};

const HEIGHT: f64 = 380.0;
/// Marks of each kind that are drawn; the JSON has all.
const MOST_MARKS: usize = 30;
/// Room above the curves of a diagram that begins at zero.
const ROOM: f64 = 1.08;

/// The whole file.
pub fn plot(model: &str, followed: &Followed) -> String {
    let (name, unit) = (&followed.parameter.0, &followed.parameter.1.text);
    let mut rows = vec![vec![panel(followed, name, unit)]];
    if !followed.loci.is_empty() {
        rows.push(vec![root_locus(followed)]);
    }
    svg(&Plot { title: format!("{model}: modes over {name}"), rows })
}

fn panel(followed: &Followed, name: &str, unit: &str) -> Panel {
    let places: Vec<f64> = followed.places.iter().map(|&si| followed.in_unit(si).to_f64()).collect();
    let mut curves: Vec<Curve> = (0..followed.curves.len()).map(|i| curve(followed, &places, i)).collect();
    let title = if unit.is_empty() { name.to_string() } else { format!("{name} [{unit}]") };
    let (first, last) = (places.first().copied().unwrap_or(0.0), places.last().copied().unwrap_or(1.0));
    let y = height(followed, &curves);
    let mut legend: Vec<Entry> =
        (0..curves.len()).map(|i| entry(Style::Curve(i), Sample::Line, format!("curve_{}", i + 1))).collect();
    for order in &followed.orders.list {
        let at = |si: &f64| f64::from(*order) * followed.orders.per_unit * si;
        let points = places.iter().copied().zip(followed.places.iter().map(at)).collect();
        curves.push(Curve { points, style: Style::Frontier });
    }
    if !followed.orders.list.is_empty() {
        let list: Vec<String> = followed.orders.list.iter().map(u32::to_string).collect();
        legend.push(entry(Style::Frontier, Sample::Line, format!("orders {} of {name}", list.join(", "))));
    }
    Panel {
        heading: "undamped frequencies".into(),
        x: Axis::tight(title, Scale::Linear, first.min(last), first.max(last)),
        y,
        height: HEIGHT,
        curves,
        marks: marks(followed),
        legend,
    }
}

/// The poles in the complex plane, each from a ring at the first value on.
fn root_locus(followed: &Followed) -> Panel {
    let point = |[re, im]: &[Ball; 2]| (re.to_f64(), im.to_f64());
    let curve = |(number, locus): (usize, &Locus)| {
        let mut points = Vec::with_capacity(locus.points.len());
        for (i, ends) in locus.points.iter().enumerate() {
            if i > 0 && locus.links[i].is_none() {
                points.push((f64::NAN, f64::NAN));
            }
            points.push(point(ends));
        }
        Curve { points, style: Style::Curve(number) }
    };
    let curves: Vec<Curve> = followed.loci.iter().enumerate().map(curve).collect();
    let first = |(number, locus): (usize, &Locus)| {
        let at = locus.points.first().map(point)?;
        Some(Mark { at, shape: Shape::Ring, label: String::new(), style: Style::Curve(number) })
    };
    let values = |part: fn(&(f64, f64)) -> f64| curves.iter().flat_map(move |curve| curve.points.iter().map(part));
    let (from, to) = (followed.places.first(), followed.places.last());
    let [from, to] = [from, to].map(|end| few_digits(end.map_or(0.0, |si| followed.in_unit(*si).to_f64())));
    let (name, unit) = (&followed.parameter.0, &followed.parameter.1.text);
    Panel {
        heading: format!("poles from {name} = {from} (rings) to {to} {unit}").trim_end().to_string(),
        x: Axis::holding("real part [1/s]", Scale::Linear, values(|point| point.0).chain([0.0])),
        y: Axis::holding("imaginary part [rad/s]", Scale::Linear, values(|point| point.1)),
        height: HEIGHT,
        marks: followed.loci.iter().enumerate().filter_map(first).collect(),
        curves,
        legend: Vec::new(),
    }
}

fn entry(style: Style, sample: Sample, text: String) -> Entry {
    Entry { style, sample, text }
}

/// A curve, interrupted where a link is not proved.
fn curve(followed: &Followed, places: &[f64], number: usize) -> Curve {
    let own = &followed.curves[number];
    let mut points = Vec::with_capacity(places.len());
    for (i, (&x, value)) in places.iter().zip(&own.points).enumerate() {
        if own.has_link(i) && own.links[i].is_none() {
            points.push((x, f64::NAN));
        }
        points.push((x, value.map_or(f64::NAN, |value| value.to_f64())));
    }
    Curve { points, style: Style::Curve(number) }
}

/// From zero if there are orders, whose lines begin there.
fn height(followed: &Followed, curves: &[Curve]) -> Axis {
    let values = || curves.iter().flat_map(|curve| curve.points.iter().map(|(_, f)| *f)).filter(|f| f.is_finite());
    match followed.orders.list.is_empty() {
        true => Axis::holding("frequency [Hz]", Scale::Linear, values()),
        false => Axis::tight("frequency [Hz]", Scale::Linear, 0.0, ROOM * values().fold(0.0, f64::max)),
    }
}

fn marks(followed: &Followed) -> Vec<Mark> {
    let at = |place: [f64; 2]| followed.place(place).to_f64();
    let mark = |place, frequency: Ball, shape, label: String, number| Mark {
        at: (at(place), frequency.to_f64()),
        shape,
        label,
        style: Style::Curve(number),
    };
    let meeting = |meeting: &Meeting| match meeting.kind {
        MeetingKind::Veering { distance, frequency, .. } => {
            let label = format!("{} Hz apart", few_digits(distance.to_f64()));
            Some(mark(meeting.place, frequency, Shape::Ring, label, meeting.curves[0]))
        }
        MeetingKind::Crossing { frequency, .. } => {
            Some(mark(meeting.place, frequency, Shape::Dot, few_digits(at(meeting.place)), meeting.curves[0]))
        }
        MeetingKind::Undecided { .. } => None,
    };
    let critical = |critical: &Critical| {
        let label = format!("{}\u{d7} at {}", critical.order, few_digits(at(critical.place)));
        Some(mark(critical.place, critical.frequency?, Shape::Dot, label, critical.curve))
    };
    let what = match followed.onsets.of {
        Grows::Modes => "growing modes",
        Grows::Poles => "growing poles",
    };
    let onset = |onset: &Onset| {
        let label = format!("{what} {} to {}", onset.growing[0], onset.growing[1]);
        mark(onset.place, Ball::ZERO, Shape::Chosen, label, 0)
    };
    let meetings = followed.meetings.iter().filter_map(meeting).take(MOST_MARKS);
    let critical = followed.orders.critical.iter().filter_map(critical).take(MOST_MARKS);
    meetings.chain(critical).chain(followed.onsets.list.iter().map(onset).take(MOST_MARKS)).collect()
}
