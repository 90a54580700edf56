//! A program around emitted code: `main.c` or `main.rs`, which prints the CSV of `vibc simulate`. In: the plan, the
//! step and the number of samples. Numbers are printed with the fewest digits that read back the same, in the format of
//! that CSV; both programs print the same bytes if they compute the same bits. See docs/method/emit.md.

use super::plan::Plan;
use super::{File, Language};
use crate::analysis::discrete::Precision;
use crate::base::Number;

/// The parameters of the run.
#[derive(Clone, Debug)]
pub struct Program {
    /// Step size, s.
    pub step: Number,
    pub samples: u64,
}

/// The file with `main`.
pub fn file(plan: &Plan, columns: &[String], program: &Program, language: Language) -> File {
    let header = format!("time_s{}", columns.iter().map(|name| format!(",{}", escape(name))).collect::<String>());
    let time = time(&program.step);
    let text = match language {
        Language::C => c(plan, &header, &time, program.samples),
        Language::Rust => rust(plan, &header, &time, program.samples),
    };
    let name = match language {
        Language::C => "main.c",
        Language::Rust => "main.rs",
    };
    File { name: name.into(), text }
}

/// Names contain letters, digits, dots and brackets; any other character must not break the string.
fn escape(name: &str) -> String {
    name.replace('\\', "\\\\").replace('"', "\\\"")
}

/// The time of sample k, where `k` is a double: rounded once if the step is a fraction of small numbers.
fn time(step: &Number) -> String {
    const EXACT: f64 = 4e9;
    let small = |x: &Number| x.to_f64().abs() < EXACT && x.exact().is_some_and(|x| x.is_integer());
    for power in 0..=9 {
        let denominator = Number::from(10i64.pow(power));
        let numerator = step * &denominator;
        if small(&numerator) {
            return match power {
                0 => format!("k * {:?}", numerator.to_f64()),
                _ => format!("k * {:?} / {:?}", numerator.to_f64(), denominator.to_f64()),
            };
        }
    }
    let inverse = &Number::ONE / step;
    if small(&inverse) { format!("k / {:?}", inverse.to_f64()) } else { format!("k * {:?}", step.to_f64()) }
}

/// The functions that print numbers; times are double in any precision of the code.
fn printers(text: &str, words: impl Fn(Precision) -> Vec<(&'static str, &'static str)>, of: Precision) -> String {
    let one =
        |precision| words(precision).into_iter().fold(text.to_string(), |text, (word, by)| text.replace(word, by));
    match of {
        Precision::Double => one(Precision::Double),
        Precision::Single => one(Precision::Double) + &one(Precision::Single),
    }
}

/// The function that prints an output.
fn value_printer(precision: Precision) -> &'static str {
    match precision {
        Precision::Double => "print",
        Precision::Single => "print_single",
    }
}

fn c_words(precision: Precision) -> Vec<(&'static str, &'static str)> {
    let name = ("PRINT", value_printer(precision));
    match precision {
        Precision::Double => {
            vec![name, ("REAL", "double"), ("FEWEST", "14"), ("MOST", "16"), ("READ", "strtod"), ("ZERO", "0.0")]
        }
        Precision::Single => {
            vec![name, ("REAL", "float"), ("FEWEST", "5"), ("MOST", "8"), ("READ", "strtof"), ("ZERO", "0.0f")]
        }
    }
}

fn rust_words(precision: Precision) -> Vec<(&'static str, &'static str)> {
    let name = ("PRINT", value_printer(precision));
    match precision {
        Precision::Double => vec![name, ("REAL", "f64"), ("FEWEST", "14"), ("MOST", "16")],
        Precision::Single => vec![name, ("REAL", "f32"), ("FEWEST", "5"), ("MOST", "8")],
    }
}

fn c(plan: &Plan, header: &str, time: &str, samples: u64) -> String {
    let (name, value) = (&plan.name, value_printer(plan.precision));
    let print = printers(C_PRINT, c_words, plan.precision);
    let prints: String = (plan.outputs.iter())
        .map(|field| format!("        putchar(',');\n        {value}(outputs.{});\n", field.identifier))
        .collect();
    let zero = if plan.precision == Precision::Single { "0.0f" } else { "0.0" };
    let (inputs, argument) = if plan.inputs.is_empty() {
        (String::new(), "")
    } else {
        let zeros: Vec<&str> = plan.inputs.iter().map(|_| zero).collect();
        (format!("    const {name}_inputs inputs = {{{}}};\n", zeros.join(", ")), "&inputs, ")
    };
    format!(
        "/* Prints the motion of the model under its own signals, from its initial state:
 * cc -std=c99 -O2 *.c -lm
 */
#include \"{name}.h\"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
{print}
int main(void)
{{
    {name}_state state;
    {name}_outputs outputs;
{inputs}    {name}_init(&state);
    puts(\"{header}\");
    for (unsigned long sample = 0; sample < {samples}ul; sample++) {{
        const double k = (double)sample;
        {name}_step(&state, {argument}&outputs);
        print({time});
{prints}        putchar('\\n');
    }}
    return 0;
}}
"
    )
}

/// Digits as from `%e`, with the fewest that read back the same.
const C_PRINT: &str = "
/* The fewest digits that read back the same. */
static void PRINT(REAL x)
{
    char text[40];
    char digits[24];
    int precision = FEWEST;
    int count = 0;
    int exponent;
    int i;
    const char *at;
    if (x == ZERO) {
        fputs(\"0.0\", stdout);
        return;
    }
    do {
        sprintf(text, \"%.*e\", precision, (double)x);
        precision++;
    } while (precision <= MOST && READ(text, NULL) != x);
    for (at = text; *at != 'e' && *at != '\\0'; at++) {
        if (*at >= '0' && *at <= '9') {
            digits[count] = *at;
            count++;
        }
    }
    if (*at == '\\0') {
        /* infinite, or no number */
        return;
    }
    exponent = atoi(at + 1) + 1;
    while (count > 1 && digits[count - 1] == '0') {
        count--;
    }
    digits[count] = '\\0';
    if (text[0] == '-') {
        putchar('-');
    }
    if (exponent >= count && exponent <= 16) {
        fputs(digits, stdout);
        for (i = count; i < exponent; i++) {
            putchar('0');
        }
        fputs(\".0\", stdout);
    } else if (exponent > 0 && exponent <= 16) {
        printf(\"%.*s.%s\", exponent, digits, digits + exponent);
    } else if (exponent > -5 && exponent <= 0) {
        fputs(\"0.\", stdout);
        for (i = exponent; i < 0; i++) {
            putchar('0');
        }
        fputs(digits, stdout);
    } else if (count == 1) {
        printf(\"%se%d\", digits, exponent - 1);
    } else {
        printf(\"%c.%se%d\", digits[0], digits + 1, exponent - 1);
    }
}
";

fn rust(plan: &Plan, header: &str, time: &str, samples: u64) -> String {
    let (name, value) = (&plan.name, value_printer(plan.precision));
    let print = printers(RUST_PRINT, rust_words, plan.precision);
    let prints: String = (plan.outputs.iter())
        .map(|field| format!("        text.push(',');\n        {value}(outputs.{}, &mut text);\n", field.identifier))
        .collect();
    let (inputs, argument) = if plan.inputs.is_empty() {
        (String::new(), "")
    } else {
        let zeros: Vec<String> = plan.inputs.iter().map(|field| format!("{}: 0.0", field.identifier)).collect();
        (format!("    let inputs = {name}::Inputs {{ {} }};\n", zeros.join(", ")), "&inputs")
    };
    format!(
        "//! Prints the motion of the model under its own signals, from its initial state: rustc -O main.rs

mod {name};

use std::{{io, io::Write}};
{print}
fn main() {{
    let mut state = {name}::State::init();
{inputs}    let mut out = io::BufWriter::new(io::stdout().lock());
    let mut text = String::from(\"{header}\\n\");
    for sample in 0..{samples}u64 {{
        let k = sample as f64;
        let outputs = state.step({argument});
        print({time}, &mut text);
{prints}        text.push('\\n');
        if out.write_all(text.as_bytes()).is_err() {{
            // Whoever reads has seen enough.
            return;
        }}
        text.clear();
    }}
}}
"
    )
}

const RUST_PRINT: &str = "
/// The fewest digits that read back the same.
fn PRINT(x: REAL, text: &mut String) {
    if x == 0.0 {
        text.push_str(\"0.0\");
        return;
    }
    let written = |precision: usize| format!(\"{:.*e}\", precision, x.abs());
    let reads = |text: &String| text.parse::<REAL>() == Ok(x.abs());
    let Some(shortest) = (FEWEST..=MOST).map(written).find(reads) else { return };
    let Some((mantissa, exponent)) = shortest.split_once('e') else { return };
    let digits = mantissa.replace('.', \"\");
    let digits = match digits.trim_end_matches('0') {
        \"\" => \"0\",
        digits => digits,
    };
    let count = digits.len() as i32;
    let exponent = exponent.parse::<i32>().unwrap_or(0) + 1;
    if x < 0.0 {
        text.push('-');
    }
    if exponent >= count && exponent <= 16 {
        text.push_str(digits);
        text.push_str(&\"0\".repeat((exponent - count) as usize));
        text.push_str(\".0\");
    } else if exponent > 0 && exponent <= 16 {
        let (whole, part) = digits.split_at(exponent as usize);
        text.push_str(&format!(\"{whole}.{part}\"));
    } else if exponent > -5 && exponent <= 0 {
        text.push_str(\"0.\");
        text.push_str(&\"0\".repeat(-exponent as usize));
        text.push_str(digits);
    } else if count == 1 {
        text.push_str(&format!(\"{digits}e{}\", exponent - 1));
    } else {
        let (first, rest) = digits.split_at(1);
        text.push_str(&format!(\"{first}.{rest}e{}\", exponent - 1));
    }
}
";
