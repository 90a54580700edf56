//! Speed against error as CSV; `svg` draws the picture, and its report is laid out like others. See docs/method/bench.md.

pub mod svg;

use crate::bench::{Bench, Entry};

/// `question,method,ordinary,time_s,error,bound,pareto,chosen,note`; unknown values are empty fields.
pub fn csv(bench: &Bench) -> String {
    let mut text = String::from("question,method,ordinary,time_s,error,bound,pareto,chosen,note\n");
    let field = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
    for entry in &bench.entries {
        let Entry { question, method, ordinary, seconds, error, bound, pareto, chosen, note } = entry;
        let fields = [
            question.name().to_string(),
            quote(method),
            ordinary.to_string(),
            field(Some(*seconds)),
            field(*error),
            field(*bound),
            pareto.to_string(),
            chosen.to_string(),
            quote(note),
        ];
        text += &fields.join(",");
        text.push('\n');
    }
    text
}

fn quote(text: &str) -> String {
    if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_string() }
}
