//! Speed against error: a table for each question, the sharpness of the bounds, the two readings of literals, and growth.
//! See docs/method/bench.md.

use super::table::{Align, Cell, Table};
use super::{Block, Figure, Line, Report, Section, Value, count_of, line};
use crate::base::Unproven;
use crate::bench::{Bench, Entry, Question};

/// The results for the model of this name.
pub fn bench(model: &str, bench: &Bench) -> Report {
    let size = count_of(bench.coordinates, "degree of freedom", "degrees of freedom");
    let questions = Question::ALL.map(|question| self::question(question, bench));
    let rest = [Section::new("Marks", marks()), Section::new("Readings", readings(bench)), growth(bench)];
    Report::new(line![model.to_string(), " · ", size, ": speed against error"], questions.into_iter().chain(rest))
}

fn question(question: Question, bench: &Bench) -> Section {
    let (name, heading) = match question {
        Question::Frequencies => ("Frequencies", line!["all undamped natural frequencies"]),
        Question::Poles => ("Poles", line!["all poles"]),
        Question::Transfer => {
            ("Transfer", line!["transfer function of the first coordinate, at resonances and between them"])
        }
        Question::Motion => {
            let what = match bench.problem.own {
                true => "its own signals and initial state",
                false => "the first coordinate released at 1",
            };
            let until = Figure::of(Value::Unproven { number: Unproven(bench.problem.until), digits: 5 }).unit("s");
            ("Motion", line!["motion at ten times up to ", until, ": ", what, "; steps are per fastest period"])
        }
    };
    let entries = bench.entries.iter().filter(|entry| entry.question == question);
    Section::new(name, [Block::Line(heading), table(entries).into(), Block::Line(reason(question).into())])
}

/// Why the program chooses its method.
fn reason(question: Question) -> &'static str {
    match question {
        Question::Frequencies => {
            "vibc works on the terms of M and K, because assembling them loses digits; its certificate decides when more precision is needed"
        }
        Question::Poles => {
            "vibc corrects binary64 poles with residuals of the terms and proves a disc around each; the time includes the modes from which it starts"
        }
        Question::Transfer => {
            "vibc uses the first of these whose bound is good enough: sum in binary64 (if `--tolerance` allows it), several frequencies at once (tables), sum in double-double, elimination"
        }
        Question::Motion => {
            "vibc needs no time step: nothing is integrated between samples, so one matrix exponential serves them all"
        }
    }
}

fn table<'a>(entries: impl Iterator<Item = &'a Entry>) -> Table {
    let mut table = Table::of([
        ("", Align::Left),
        ("method", Align::Left),
        ("time", Align::Right),
        ("error", Align::Right),
        ("bound", Align::Right),
        ("", Align::Left),
    ]);
    for entry in entries {
        let mark = match (entry.chosen, entry.pareto) {
            (true, true) => "→∙",
            (true, false) => "→",
            (false, true) => "\u{a0}∙",
            (false, false) => "",
        };
        table.row(vec![
            mark.into(),
            entry.method.clone().into(),
            duration(entry.seconds).into(),
            entry.error.map_or("fails".into(), |error| scientific(error).into()),
            entry.bound.map_or_else(Cell::default, |bound| scientific(bound).into()),
            if entry.error.is_none() { Cell::default() } else { entry.note.into() },
        ]);
    }
    table
}

fn marks() -> [Block; 2] {
    [
        Block::Line(
            "→ the method that vibc chooses\u{a0}\u{a0} ∙ on the Pareto front: no other method is both faster and more accurate"
                .into(),
        ),
        Block::Line(
            "error: largest relative error of the answer as printed in binary64, compared with double-double".into(),
        ),
    ]
}

fn readings(bench: &Bench) -> Vec<Block> {
    let quality = bench.bound_quality.map(|(median, largest)| {
        let ratio = |value: f64| Line::from(format!("{value:.1}"));
        line!["ratio of bound to true error of the frequencies: median ", ratio(median), ", largest ", ratio(largest)]
    });
    let reading = bench.reading.map(|change| {
        let change = match change {
            0.0 => line!["does not change the frequencies"],
            change => line!["changes the frequencies by at most ", scientific(change)],
        };
        line!["reading the literals as binary64 numbers, as other programs do, ", change]
    });
    quality.into_iter().chain(reading).map(Block::Line).collect()
}

fn growth(bench: &Bench) -> Section {
    if bench.growth.is_empty() {
        return Section::new("Growth", []);
    }
    let mut table = Table::new()
        .column("masses", "", Align::Right)
        .column("vibc", "time", Align::Right)
        .column("", "error", Align::Right)
        .column("assembled", "time", Align::Right)
        .column("", "error", Align::Right);
    for row in &bench.growth {
        let times = [row.ours, row.ordinary].map(|(seconds, error)| [duration(seconds), scientific(error)]);
        let cells = times.into_iter().flatten().map(Cell::from);
        table.row([Cell::from(row.coordinates)].into_iter().chain(cells).collect());
    }
    Section::new("Growth", [Block::Line("growth: all frequencies of a uniform chain".into()), table.into()])
}

fn scientific(value: f64) -> String {
    if value == 0.0 { "0".into() } else { format!("{value:.1e}") }
}

fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1e-6 => format!("{:.0} ns", s * 1e9),
        s if s < 1e-3 => format!("{:.1} µs", s * 1e6),
        s if s < 1.0 => format!("{:.2} ms", s * 1e3),
        s => format!("{s:.2} s"),
    }
}
