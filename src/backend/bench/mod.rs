//! Speed against error as text and CSV; `svg` draws the picture. See docs/method/bench.md.

pub mod svg;

use super::decimal::Decimal;
use super::report::table::Table;
use crate::answers::report::Align;
use crate::base::Dd;
use crate::bench::{Bench, Entry, Question};

const INDENT: usize = 2;

/// `question,road,ordinary,time_s,error,bound,pareto,chosen,note`; unknown values are empty fields.
pub fn csv(bench: &Bench) -> String {
    let mut text = String::from("question,road,ordinary,time_s,error,bound,pareto,chosen,note\n");
    let field = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
    for entry in &bench.entries {
        let Entry { question, road, ordinary, seconds, error, bound, pareto, chosen, note } = entry;
        let fields = [
            question.name().to_string(),
            quoted(road),
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
    let freedoms = if bench.coordinates == 1 { "1 freedom".into() } else { format!("{} freedoms", bench.coordinates) };
    let mut text = format!("{model} · {freedoms}: speed against error\n");
    for question in Question::ALL {
        text += &format!("\n  {}\n", heading(question, bench));
        text += &table(bench.entries.iter().filter(|entry| entry.question == question));
        text += &format!("  {}\n", why(question));
    }
    text += "\n  → the road that vibc takes by itself   ∙ on the Pareto line: none is both faster and more accurate\n";
    text += "  error: the worst of the answer as printed in binary64, relative, against double-double\n";
    if let Some((median, largest)) = bench.bound_quality {
        text += &format!(
            "\n  bounds of the frequencies over their true errors: median {median:.1}, largest {largest:.1}\n"
        );
    }
    if let Some(change) = bench.reading {
        let change = if change == 0.0 {
            "does not change the frequencies".into()
        } else {
            format!("changes the frequencies by {change:.1e} at most")
        };
        text += &format!("  reading the literals as binary64 numbers, as others do, {change}\n");
    }
    text += &growth(bench);
    text
}

fn heading(question: Question, bench: &Bench) -> String {
    match question {
        Question::Frequencies => "natural frequencies without damping, all of them".into(),
        Question::Poles => "poles, all of them".into(),
        Question::Transfer => "transfer function of the first coordinate, at resonances and between them".into(),
        Question::Motion => {
            let what = if bench.problem.own {
                "its own signals and initial state"
            } else {
                "the first coordinate let go at 1"
            };
            let until = Decimal::round(Dd::from(bench.problem.until), 5).text();
            format!("motion at ten times until {until} s: {what}; steps are of the fastest period")
        }
    }
}

/// Why the program chooses its method.
fn why(question: Question) -> &'static str {
    match question {
        Question::Frequencies => {
            "vibc works on the terms that M and K are sums of, for assembling loses digits; its certificate says when more precision is due"
        }
        Question::Poles => {
            "vibc corrects binary64 poles with residuals of the terms and proves a disc around each; the time holds the modes it starts from"
        }
        Question::Transfer => {
            "vibc takes the first whose bound is good enough of: sum in binary64 (where `--tolerance` allows), side by side (tables), sum in double-double, elimination"
        }
        Question::Motion => {
            "vibc's motion has no step to choose: between samples nothing is integrated, so one exponential serves them all"
        }
    }
}

fn table<'a>(entries: impl Iterator<Item = &'a Entry>) -> String {
    let mut table = Table::new()
        .column("", "", Align::Left)
        .column("road", "", Align::Left)
        .column("time", "", Align::Right)
        .column("error", "", Align::Right)
        .column("bound", "", Align::Right)
        .column("", "", Align::Left);
    for entry in entries {
        let mark = format!("{}{}", if entry.chosen { "→" } else { " " }, if entry.pareto { "∙" } else { " " });
        let shown = |value: Option<f64>| value.map_or(String::new(), scientific);
        table.row(vec![
            mark,
            entry.road.clone(),
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
