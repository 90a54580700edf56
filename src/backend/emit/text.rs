//! Statements and expressions as text: the part that C, Rust and similar languages share. A language defines how its
//! operands and declarations are written ([`Words`]); operators, their precedence and parentheses are the same in all
//! of them. See docs/method/emit.md.

use super::plan::{Expression, Index, Statement, Target};
use crate::analysis::discrete::{Again, Precision};
use std::fmt::Write;

/// The syntax that differs between languages.
pub trait Words {
    fn number(&self, x: f64) -> String;
    fn state(&self, array: &str, index: Option<String>) -> String;
    fn input(&self, input: usize) -> String;
    fn output(&self, output: usize) -> String;
    /// An entry of a motion that is given or returned: `displacement` or `velocity`.
    fn motion(&self, what: &str, index: String) -> String;
    /// An entry of the derivative of a motion.
    fn derivative(&self, what: &str, index: String) -> String;
    fn note(&self, note: &str) -> String;
    fn constant(&self, name: &str, value: &str) -> String;
    fn variable(&self, name: &str, value: &str) -> String;
    /// Declares this many sums, all zero.
    fn lanes(&self, name: &str, width: usize) -> String;
    /// Declares a matrix of zeros.
    fn matrix(&self, name: &str, rows: usize, columns: usize) -> String;
    fn loop_head(&self, index: &str, count: usize) -> String;
    /// The head of a loop whose body does not use the index.
    fn repeat_head(&self, count: usize) -> String;
    /// The heads of the loops over `count / width` blocks and over the lanes of one.
    fn block_heads(&self, count: usize, width: usize) -> [String; 2];
    /// The lines before and after the body that runs when the next of `count` events is due, and what comes after the last.
    fn due(&self, count: usize, again: Option<Again>) -> [Vec<String>; 2];
    /// The index in blocks of this width.
    fn lane(&self, width: usize) -> String;
}

/// Statements, one per line, indented.
pub fn statements(words: &impl Words, list: &[Statement], depth: usize) -> String {
    list.iter().map(|statement| write_statement(words, statement, depth)).collect()
}

fn write_statement(words: &impl Words, statement: &Statement, depth: usize) -> String {
    match statement {
        Statement::Note(note) => line(depth, &words.note(note)),
        Statement::Let(name, e) => fold(depth, &words.constant(name, &value(words, e))),
        Statement::Variable(name, e) => fold(depth, &words.variable(name, &value(words, e))),
        Statement::Assign(target, e) => fold(depth, &assignment(words, target, e)),
        Statement::Lanes(name, width) => line(depth, &words.lanes(name, *width)),
        Statement::Matrix(name, rows, columns) => line(depth, &words.matrix(name, *rows, *columns)),
        Statement::Loop(index, count, body) => {
            line(depth, &words.loop_head(index, *count)) + &statements(words, body, depth + 1) + &line(depth, "}")
        }
        Statement::Repeat(count, body) => {
            line(depth, &words.repeat_head(*count)) + &statements(words, body, depth + 1) + &line(depth, "}")
        }
        Statement::WhenDue(count, again, body) => {
            let [before, after] = words.due(*count, *again);
            let [before, after] = [before, after].map(|lines| lines.iter().map(|l| line(depth, l)).collect::<String>());
            before + &statements(words, body, depth + 1) + &after
        }
        Statement::Blocks { count, width, body } => {
            let [outer, inner] = words.block_heads(*count, *width);
            line(depth, &outer)
                + &line(depth + 1, &inner)
                + &statements(words, body, depth + 2)
                + &line(depth + 1, "}")
                + &line(depth, "}")
        }
    }
}

/// An expression without outer parentheses.
pub fn value(words: &impl Words, e: &Expression) -> String {
    expression(words, e, Level::Sum)
}

/// An assignment; an addition to the target itself is written with `+=`.
fn assignment(words: &impl Words, target: &Target, e: &Expression) -> String {
    let place = place(words, target);
    match e {
        Expression::Sum(a, b) if value(words, a) == place => format!("{place} += {};", value(words, b)),
        Expression::Difference(a, b) if value(words, a) == place => {
            format!("{place} -= {};", expression(words, b, Level::Product))
        }
        _ => format!("{place} = {};", value(words, e)),
    }
}

/// Maximum width of a line of code.
const WIDTH: usize = 120;

/// Breaks a statement into readable lines: long sums continue in the next line, further indented.
fn fold(depth: usize, statement: &str) -> String {
    let mut lines = String::new();
    let mut rest = statement;
    let mut indent = depth;
    while 4 * indent + rest.len() > WIDTH {
        let most = WIDTH - 4 * indent;
        let signs = [" + ", " - "].map(|sign| rest[..most].rfind(sign));
        let Some(at) = signs.into_iter().flatten().max().filter(|&at| at > 0) else { break };
        lines += &line(indent, &rest[..at]);
        rest = &rest[at + 1..];
        indent = depth + 1;
    }
    lines + &line(indent, rest)
}

const INDENT: &str = "    ";

/// A line of text, indented.
pub fn line(depth: usize, content: &str) -> String {
    format!("{}{content}\n", INDENT.repeat(depth))
}

fn place(words: &impl Words, target: &Target) -> String {
    match target {
        Target::Local(name) => name.clone(),
        Target::State(array, at) => words.state(array, index(words, at)),
        Target::Output(output) => words.output(*output),
        Target::Lane(name) => format!("{name}[lane]"),
        Target::Entry(name, i, j) => {
            let at = |i: &Index| index(words, i).unwrap_or_default();
            format!("{name}[{}][{}]", at(i), at(j))
        }
        Target::Displacement(at) => words.motion("displacement", index(words, at).unwrap_or_default()),
        Target::Velocity(at) => words.motion("velocity", index(words, at).unwrap_or_default()),
        Target::DisplacementRate(at) => words.derivative("displacement", index(words, at).unwrap_or_default()),
        Target::VelocityRate(at) => words.derivative("velocity", index(words, at).unwrap_or_default()),
    }
}

fn index(words: &impl Words, index: &Index) -> Option<String> {
    match index {
        Index::At(at) => Some(at.to_string()),
        Index::Only => None,
        Index::Of(name) => Some((*name).to_string()),
        Index::Lane(width) => Some(words.lane(*width)),
        Index::Event => Some("event".to_string()),
        Index::Text(text) => Some(text.clone()),
    }
}

/// The precedence below which an operand needs parentheses.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Level {
    Sum,
    Product,
    Single,
}

fn expression(words: &impl Words, e: &Expression, allowed: Level) -> String {
    let at = |i: &Index| index(words, i).unwrap_or_default();
    let side = |e: &Expression, level: Level| expression(words, e, level);
    let (text, level) = match e {
        Expression::Number(x) => (words.number(*x), Level::Single),
        Expression::Local(name) => (name.clone(), Level::Single),
        Expression::State(array, i) => (words.state(array, index(words, i)), Level::Single),
        Expression::Table(name, i) => (format!("{name}[{}]", at(i)), Level::Single),
        Expression::Entry(name, i, j) => (format!("{name}[{}][{}]", at(i), at(j)), Level::Single),
        Expression::Input(input) => (words.input(*input), Level::Single),
        Expression::Lane(name) => (format!("{name}[lane]"), Level::Single),
        Expression::Displacement(i) => (words.motion("displacement", at(i)), Level::Single),
        Expression::Velocity(i) => (words.motion("velocity", at(i)), Level::Single),
        Expression::Sum(a, b) => (format!("{} + {}", side(a, Level::Sum), side(b, Level::Product)), Level::Sum),
        Expression::Difference(a, b) => (format!("{} - {}", side(a, Level::Sum), side(b, Level::Product)), Level::Sum),
        Expression::Product(a, b) => {
            (format!("{} * {}", side(a, Level::Product), side(b, Level::Single)), Level::Product)
        }
        Expression::Quotient(a, b) => {
            (format!("{} / {}", side(a, Level::Product), side(b, Level::Single)), Level::Product)
        }
        Expression::Negative(a) => (format!("-{}", side(a, Level::Single)), Level::Product),
        Expression::LaneSum(name, width) => lane_sum(name, 0, *width),
    };
    if level < allowed { format!("({text})") } else { text }
}

/// The sum of lanes in pairs, and pairs of pairs: the left part has the largest power of two.
fn lane_sum(name: &str, first: usize, width: usize) -> (String, Level) {
    if width <= 1 {
        return (format!("{name}[{first}]"), Level::Single);
    }
    let half = width.next_power_of_two() / 2;
    let part = |first: usize, width: usize| match lane_sum(name, first, width) {
        (text, Level::Sum) => format!("({text})"),
        (text, _) => text,
    };
    (format!("{} + {}", part(first, half), part(first + half, width - half)), Level::Sum)
}

/// The shortest decimal that reads back as the same number of the target, always with a point or an exponent.
pub fn decimal(x: f64, precision: Precision) -> String {
    let mut text = String::new();
    push_decimal(&mut text, x, precision);
    text
}

/// Appends such a decimal.
pub fn push_decimal(text: &mut String, x: f64, precision: Precision) {
    // Writing to a string does not fail.
    let _ = match precision {
        Precision::Double if is_common(x) => {
            text.push_str(zmij::Buffer::new().format_finite(x));
            Ok(())
        }
        Precision::Double => write!(text, "{x:?}"),
        Precision::Single => write!(text, "{:?}", x as f32),
    };
}

/// Whether `zmij`, which takes a fifth of the time, writes a number exactly as the standard library does. Others have another
/// form there (`0.00002`, `1e+16`), or may lie in the middle of two shortest decimals, of which the two choose different ones: the
/// number, a fraction with p digits behind its point in binary, has as many in decimal, and at most 18 digits in all. With more
/// than 43 bits that takes p < 8, and a number above 2^34.
fn is_common(x: f64) -> bool {
    let size = x.abs();
    let has_many_bits = x.to_bits().trailing_zeros() < 10;
    has_many_bits && [1e-300..1e-5, 1e-4..1e10].iter().any(|range| range.contains(&size))
}

/// A list of numbers, a few per line; `push` appends one.
pub fn numbers(values: &[f64], depth: usize, push: impl Fn(&mut String, f64)) -> String {
    let mut text = String::with_capacity(24 * values.len());
    for chunk in values.chunks(4) {
        (0..depth).for_each(|_| text.push_str(INDENT));
        for (i, &x) in chunk.iter().enumerate() {
            text.push_str(if i == 0 { "" } else { ", " });
            push(&mut text, x);
        }
        text.push_str(",\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_those_of_the_standard_library() {
        // Whole and broken powers of two and ten, numbers halfway between two decimals, and a million others.
        let mut numbers: Vec<f64> = (-1074..1024).map(|e| libm::ldexp(1.0, e)).collect();
        numbers.extend((-324..309).flat_map(|e| {
            ["1", "9.999999999999999", "-2.5"].map(|m| format!("{m}e{e}").parse::<f64>().expect("a number"))
        }));
        numbers.extend((1u64..200).map(|i| 1_658_206_780_088_562.0 + 0.25 * i as f64));
        let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
        for i in 0..1_000_000_u64 {
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            numbers.push(f64::from_bits(bits));
            // Numbers of few bits, and those of the sizes that code has.
            numbers.push(f64::from_bits(bits & (u64::MAX << (i % 53))));
            numbers.push(bits as i64 as f64 * [1e-18, 1e-22, 1e-12, 1e-8][i as usize % 4]);
        }
        for x in numbers.into_iter().filter(|x| x.is_finite()) {
            assert_eq!(decimal(x, Precision::Double), format!("{x:?}"));
        }
    }
}
