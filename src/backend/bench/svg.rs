//! The work-precision picture: a panel for each question, time to the right and error upwards, both in decades; full dots for
//! vibc, rings for what an ordinary program does, a line along what nothing beats. See docs/method/bench.md.

use crate::bench::{Bench, Entry, Question};
use std::fmt::Write;

const WIDTH: f64 = 460.0;
const PLOT: f64 = 300.0;
const LINE: f64 = 15.0;
const MARGIN: f64 = 46.0;
/// An error of zero is drawn here.
const EXACT: f64 = 1e-17;

/// The whole picture.
pub fn svg(model: &str, bench: &Bench) -> String {
    let panels: Vec<Vec<&Entry>> = Question::ALL
        .map(|question| bench.entries.iter().filter(|e| e.question == question && e.error.is_some()).collect())
        .into_iter()
        .collect();
    let legend = |pair: &[Vec<&Entry>]| pair.iter().map(Vec::len).max().unwrap_or(0) as f64 * LINE;
    let heights: Vec<f64> = panels.chunks(2).map(|pair| PLOT + 2.0 * MARGIN + legend(pair)).collect();
    let height = heights.iter().sum::<f64>() + MARGIN;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{height}\" viewBox=\"0 0 {w} {height}\" \
         font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <text x=\"{MARGIN}\" y=\"24\" font-size=\"16\">{}: speed against error</text>\n",
        escaped(model),
        w = 2.0 * WIDTH,
    );
    let mut top = MARGIN;
    for (row, height) in heights.iter().enumerate() {
        for column in 0..2 {
            let at = 2 * row + column;
            panel(&mut text, Question::ALL[at], &panels[at], WIDTH * column as f64, top);
        }
        top += height;
    }
    text + "</svg>\n"
}

fn panel(text: &mut String, question: Question, entries: &[&Entry], left: f64, top: f64) {
    let decade = |x: f64| decades(x.max(EXACT));
    let error = |entry: &Entry| decade(entry.error.unwrap_or(EXACT));
    let time = |entry: &Entry| decades(entry.seconds.max(1e-10));
    let range = |of: &dyn Fn(&Entry) -> f64, low: f64, high: f64| {
        let ends = entries.iter().map(|e| of(e)).fold((low, high), |(low, high), x| (low.min(x), high.max(x)));
        (ends.0.floor(), ends.1.ceil().max(ends.0.floor() + 1.0))
    };
    let (x0, x1) = range(&time, f64::INFINITY, f64::NEG_INFINITY);
    let (y0, y1) = range(&error, -17.0, 0.0);
    let (x0, x1) = if x0.is_finite() { (x0, x1) } else { (-6.0, -5.0) };
    let side = WIDTH - 2.0 * MARGIN;
    let x = |value: f64| left + MARGIN + (value - x0) / (x1 - x0) * side;
    let y = |value: f64| top + MARGIN + (y1 - value) / (y1 - y0) * PLOT;
    let mut put = |line: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{line}");
    };
    put(format!(
        "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"13\">{}</text>",
        left + MARGIN,
        top + MARGIN - 10.0,
        question.name()
    ));
    for tick in (x0 as i32)..=(x1 as i32) {
        let at = x(f64::from(tick));
        put(format!("<path d=\"M{at:.1} {:.1}V{:.1}\" stroke=\"#ddd\"/>", y(y1), y(y0)));
        put(format!("<text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">1e{tick} s</text>", y(y0) + 14.0));
    }
    for tick in ((y0 as i32)..=(y1 as i32)).filter(|tick| tick % 4 == 0) {
        let at = y(f64::from(tick));
        put(format!("<path d=\"M{:.1} {at:.1}H{:.1}\" stroke=\"#ddd\"/>", x(x0), x(x1)));
        put(format!("<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">1e{tick}</text>", x(x0) - 4.0, at + 4.0));
    }
    let mut best: Vec<&&Entry> = entries.iter().filter(|entry| entry.pareto).collect();
    best.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let line: Vec<String> = best.iter().map(|e| format!("{:.1} {:.1}", x(time(e)), y(error(e)))).collect();
    if line.len() > 1 {
        put(format!("<path d=\"M{}\" fill=\"none\" stroke=\"#888\" stroke-dasharray=\"4 3\"/>", line.join("L")));
    }
    for (number, entry) in (1..).zip(entries) {
        let (cx, cy) = (x(time(entry)), y(error(entry)));
        let (fill, stroke) = if entry.ordinary { ("white", "#b34700") } else { ("#1f5fa8", "#1f5fa8") };
        put(format!(
            "<circle cx=\"{cx:.1}\" cy=\"{cy:.1}\" r=\"5\" fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"2\"/>"
        ));
        if entry.chosen {
            put(format!("<circle cx=\"{cx:.1}\" cy=\"{cy:.1}\" r=\"9\" fill=\"none\" stroke=\"#1f5fa8\"/>"));
        }
        put(format!("<text x=\"{:.1}\" y=\"{:.1}\">{number}</text>", cx + 8.0, cy - 6.0));
        let note = if entry.note.is_empty() { String::new() } else { format!(" ({})", entry.note) };
        let chosen = if entry.chosen { " — taken by itself" } else { "" };
        put(format!(
            "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"{stroke}\">{number}  {}{}{chosen}</text>",
            left + MARGIN,
            top + MARGIN + PLOT + 20.0 + LINE * f64::from(number),
            escaped(&entry.road),
            escaped(&note),
        ));
    }
}

/// log10, to the accuracy of a picture: the exponent of ten and the digits before it.
fn decades(x: f64) -> f64 {
    let written = format!("{x:e}");
    let (digits, exponent) = written.split_once('e').unwrap_or(("1", "0"));
    let (digits, exponent) = (digits.parse().unwrap_or(1.0), exponent.parse().unwrap_or(0.0));
    exponent + between(digits)
}

/// log10 of 1..10 bit by bit, by squaring: the same on every machine.
fn between(mut x: f64) -> f64 {
    let (mut sum, mut part) = (0.0, 0.5);
    for _ in 0..12 {
        x *= x;
        if x >= 10.0 {
            x /= 10.0;
            sum += part;
        }
        part *= 0.5;
    }
    sum
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_are_logarithms() {
        for x in [1e-17, 3.7e-5, 1.0, 2.5, 9.9e3] {
            assert!((decades(x) - x.log10()).abs() < 1e-3, "{x}");
        }
    }
}
