//! Speed against error as text and CSV; `svg` draws the picture. See docs/method/bench.md.

pub mod svg;

use super::decimal::Decimal;
use super::report::table::Table;
use crate::answers::report::Align;
use crate::base::Dd;
use crate::bench::{Bench, Entry, Question};

const INDENT: usize = 2;

/// `question,method,ordinary,time_s,error,bound,pareto,chosen,note`; unknown values are empty fields.
pub fn csv(bench: &Bench) -> String {
    let mut text = String::from("question,method,ordinary,time_s,error,bound,pareto,chosen,note\n");
    let field = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
    for entry in &bench.entries {
        let Entry { question, method, ordinary, seconds, error, bound, pareto, chosen, note } = entry;
        let fields = [
            question.name().to_string(),
            quoted(method),
            ordinary.to_string(),
            field(Some(*seconds)),
            field(*error),
            field(*bound),
            pareto.to_string(),
            chosen.to_string(),
            quoted(note),
        ];
        text += &fields.join(",");
        text.push('\n');
    }
    text
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
}

/// A table for each question, the sharpness of the bounds, the two readings of literals, and growth.
pub fn text(model: &str, bench: &Bench) -> String {
    let freedoms = if bench.coordinates == 1 {
        "1 degree of freedom".into()
    } else {
        format!("{} degrees of freedom", bench.coordinates)
    };
    let mut text = format!("{model} · {freedoms}: speed against error\n");
    for question in Question::ALL {
        text += &format!("\n  {}\n", heading(question, bench));
        text += &table(bench.entries.iter().filter(|entry| entry.question == question));
        text += &format!("  {}\n", why(question));
    }
    text += "\n  → the method that vibc chooses   ∙ on the Pareto front: no other method is both faster and more accurate\n";
    text += "  error: largest relative error of the answer as printed in binary64, compared with double-double\n";
    if let Some((median, largest)) = bench.bound_quality {
        text +=
            &format!("\n  ratio of bound to true error of the frequencies: median {median:.1}, largest {largest:.1}\n");
    }
    if let Some(change) = bench.reading {
        let change = if change == 0.0 {
            "does not change the frequencies".into()
        } else {
            format!("changes the frequencies by at most {change:.1e}")
        };
        text += &format!("  reading the literals as binary64 numbers, as other programs do, {change}\n");
    }
    text += &growth(bench);
    text
}

fn heading(question: Question, bench: &Bench) -> String {
    match question {
        Question::Frequencies => "all undamped natural frequencies".into(),
        Question::Poles => "all poles".into(),
        Question::Transfer => "transfer function of the first coordinate, at resonances and between them".into(),
        Question::Motion => {
            let what = if bench.problem.own {
                "its own signals and initial state"
            } else {
                "the first coordinate released at 1"
            };
            let until = Decimal::round(Dd::from(bench.problem.until), 5).text();
            format!("motion at ten times up to {until} s: {what}; steps are per fastest period")
        }
    }
}

/// Why the program chooses its method.
fn why(question: Question) -> &'static str {
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

fn table<'a>(entries: impl Iterator<Item = &'a Entry>) -> String {
    let mut table = Table::new()
        .column("", "", Align::Left)
        .column("method", "", Align::Left)
        .column("time", "", Align::Right)
        .column("error", "", Align::Right)
        .column("bound", "", Align::Right)
        .column("", "", Align::Left);
    for entry in entries {
        let mark = format!("{}{}", if entry.chosen { "→" } else { " " }, if entry.pareto { "∙" } else { " " });
        let shown = |value: Option<f64>| value.map_or(String::new(), scientific);
        table.row(vec![
            mark,
            entry.method.clone(),
            duration(entry.seconds),
            entry.error.map_or("fails".into(), scientific),
            shown(entry.bound),
            if entry.error.is_none() { String::new() } else { entry.note.into() },
        ]);
    }
    table.text(INDENT)
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

fn growth(bench: &Bench) -> String {
    if bench.growth.is_empty() {
        return String::new();
    }
    let mut table = Table::new()
        .column("masses", "", Align::Right)
        .column("vibc", "time", Align::Right)
        .column("", "error", Align::Right)
        .column("assembled", "time", Align::Right)
        .column("", "error", Align::Right);
    for row in &bench.growth {
        table.row(vec![
            row.coordinates.to_string(),
            duration(row.ours.0),
            scientific(row.ours.1),
            duration(row.ordinary.0),
            scientific(row.ordinary.1),
        ]);
    }
    format!("\n  growth: all frequencies of a uniform chain\n{}", table.text(INDENT))
}
