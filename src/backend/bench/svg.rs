//! The work-precision diagram: a panel for each question, with time to the right and error upwards, both in decades;
//! full dots for vibc, rings for an ordinary program, a line along the methods that no other one beats. See
//! docs/method/bench.md.

use crate::backend::plot::{self, Axis, Curve, Entry as Line, Mark, Panel, Plot, Sample, Scale, Shape, Style};
use crate::base::OrderBy;
use crate::bench::{Bench, Entry, Question};

const HEIGHT: f64 = 300.0;
/// Position of an error of zero.
const EXACT: f64 = 1e-17;
/// Position of a time below the resolution of the clock, s.
const INSTANT: f64 = 1e-10;

/// The whole picture.
pub fn svg(model: &str, bench: &Bench) -> String {
    let panels = Question::ALL.map(|question| {
        let entries: Vec<&Entry> =
            bench.entries.iter().filter(|e| e.question == question && e.error.is_some()).collect();
        panel(question, &entries)
    });
    let mut rows: Vec<Vec<Panel>> = Vec::new();
    for (number, panel) in panels.into_iter().enumerate() {
        match rows.last_mut() {
            Some(row) if number % 2 == 1 => row.push(panel),
            _ => rows.push(vec![panel]),
        }
    }
    plot::svg(&Plot { title: format!("{model}: speed against error"), rows })
}

fn place(entry: &Entry) -> (f64, f64) {
    (entry.seconds.max(INSTANT), entry.error.unwrap_or(EXACT).max(EXACT))
}

fn panel(question: Question, entries: &[&Entry]) -> Panel {
    let places = || entries.iter().map(|entry| place(entry));
    let times = Axis::holding("time [s]", Scale::Decades, places().map(|(time, _)| time)).in_whole_decades(20.0);
    let errors = places().map(|(_, error)| error).chain([EXACT, 1.0]);
    let mut best: Vec<(f64, f64)> = entries.iter().filter(|entry| entry.pareto).map(|entry| place(entry)).collect();
    best.order_by(|a, b| a.0.total_cmp(&b.0));
    let style = |entry: &Entry| Style::Curve(usize::from(entry.ordinary));
    let shape = |entry: &Entry| match entry {
        Entry { chosen: true, .. } => Shape::Chosen,
        Entry { ordinary: true, .. } => Shape::Ring,
        _ => Shape::Dot,
    };
    let mark = |(number, entry): (usize, &&Entry)| Mark {
        at: place(entry),
        shape: shape(entry),
        label: number.to_string(),
        style: style(entry),
    };
    let line = |(number, entry): (usize, &&Entry)| {
        let note = if entry.note.is_empty() { String::new() } else { format!(" ({})", entry.note) };
        let chosen = if entry.chosen { " — taken by itself" } else { "" };
        let text = format!("{number}  {}{note}{chosen}", entry.method);
        Line { style: style(entry), sample: Sample::Shape(shape(entry)), text }
    };
    Panel {
        heading: question.name().into(),
        x: times,
        y: Axis::holding("relative error", Scale::Decades, errors).in_whole_decades(40.0),
        height: HEIGHT,
        curves: vec![Curve { points: best, style: Style::Frontier }],
        marks: (1..).zip(entries).map(mark).collect(),
        legend: (1..).zip(entries).map(line).collect(),
    }
}
