//! Rust: `NAME.rs`, a module or a crate, without `std`. See docs/method/emit.md.

use super::File;
use super::plan::{Field, Plan, Start, Statement, Style, Table, Target};
use super::text::{Words, decimal, line, numbers, push_decimal, statements, value};
use crate::analysis::discrete::{Again, Precision};
use crate::backend::diagnostics::readable;

/// The file.
pub fn files(plan: &Plan) -> Vec<File> {
    vec![File { name: format!("{}.rs", plan.name), text: whole(plan) }]
}

/// The syntax of Rust for the elements of a plan.
struct Rust<'a> {
    plan: &'a Plan,
    /// The name of the motion that is read or set.
    motion: &'static str,
}

impl<'a> Rust<'a> {
    fn of(plan: &'a Plan) -> Rust<'a> {
        let motion = if matches!(plan.style, Style::Equations { .. }) { "self" } else { "motion" };
        Rust { plan, motion }
    }
}

impl Words for Rust<'_> {
    fn number(&self, x: f64) -> String {
        decimal(x, self.plan.precision)
    }

    fn state(&self, array: &str, index: Option<String>) -> String {
        index.map_or_else(|| format!("self.{array}"), |index| format!("self.{array}[{index}]"))
    }

    fn input(&self, input: usize) -> String {
        format!("inputs.{}", self.plan.inputs[input].identifier)
    }

    fn output(&self, output: usize) -> String {
        format!("outputs.{}", self.plan.outputs[output].identifier)
    }

    fn motion(&self, what: &str, index: String) -> String {
        format!("{}.{what}[{index}]", self.motion)
    }

    fn derivative(&self, what: &str, index: String) -> String {
        format!("derivative.{what}[{index}]")
    }

    fn note(&self, note: &str) -> String {
        format!("// {}", readable(note))
    }

    fn constant(&self, name: &str, value: &str) -> String {
        format!("let {name} = {value};")
    }

    fn variable(&self, name: &str, value: &str) -> String {
        format!("let mut {name} = {value};")
    }

    fn lanes(&self, name: &str, width: usize) -> String {
        format!("let mut {name}: [{}; {width}] = [0.0; {width}];", real(self.plan))
    }

    fn matrix(&self, name: &str, rows: usize, columns: usize) -> String {
        format!("let mut {name} = [[0.0; {columns}]; {rows}];")
    }

    fn loop_head(&self, index: &str, count: usize) -> String {
        format!("for {index} in 0..{count} {{")
    }

    fn repeat_head(&self, count: usize) -> String {
        format!("for _ in 0..{count} {{")
    }

    fn block_heads(&self, count: usize, width: usize) -> [String; 2] {
        [format!("for block in 0..{} {{", count / width), format!("for lane in 0..{width} {{")]
    }

    fn due(&self, count: usize, again: Option<Again>) -> [Vec<String>; 2] {
        let mut after = vec!["    self.next += 1;".to_string()];
        if let Some(Again { first, ticks }) = again {
            after.push(format!("    if self.next == {count} {{"));
            after.push(format!("        self.next = {first};"));
            after.push(format!("        self.tick = self.tick.wrapping_sub({ticks});"));
            after.push("    }".to_string());
        }
        after.push("}".to_string());
        [
            vec![
                "self.tick = self.tick.wrapping_add(1);".to_string(),
                "let event = self.next as usize;".to_string(),
                format!("if event < {count} && EVENTS[event] == self.tick {{"),
            ],
            after,
        ]
    }

    fn lane(&self, width: usize) -> String {
        format!("{width} * block + lane")
    }
}

fn real(plan: &Plan) -> &'static str {
    match plan.precision {
        Precision::Double => "f64",
        Precision::Single => "f32",
    }
}

/// Some functions may have no caller; names are those of the model; loops are written as in C, so that the bits are the
/// same; a coefficient may be close to a mathematical constant.
const ALLOWED: &str =
    "\n#![allow(dead_code, non_snake_case)]\n#![allow(clippy::needless_range_loop, clippy::approx_constant)]\n";

/// The text of the file.
pub fn whole(plan: &Plan) -> String {
    let (words, real) = (Rust::of(plan), real(plan));
    let mut text: String =
        plan.header.iter().map(|text| format!("//! {}", readable(text)).trim_end().to_string() + "\n").collect();
    text += ALLOWED;
    if !matches!(plan.style, Style::Equations { .. }) {
        text += &state(plan);
    }
    if !plan.inputs.is_empty() {
        text += &structure("Inputs", real, &plan.inputs);
    }
    text += &structure("Outputs", real, &plan.outputs);
    if plan.tabled {
        text += &motion(plan);
    }
    for table in &plan.tables {
        text += &constants(&words, table);
    }
    if !plan.events.is_empty() {
        let ticks: Vec<String> = plan.events.iter().map(|tick| format!("    {tick},\n")).collect();
        let (count, ticks) = (ticks.len(), ticks.concat());
        text += &format!("\n/// samples with events\nstatic EVENTS: [u32; {count}] = [\n{ticks}];\n");
    }
    text += &match &plan.style {
        Style::Steps | Style::Parameter { .. } => steps(plan),
        Style::Equations { start } => equations(plan, start),
    };
    text
}

/// The type of a motion in the model's coordinates.
fn motion(plan: &Plan) -> String {
    let (n, real) = (plan.coordinates.len(), real(plan));
    let mut text = String::from(
        "\n/// The motion in the model's own coordinates, deviations from rest, with their velocities:\n///\n",
    );
    for (i, coordinate) in plan.coordinates.iter().enumerate() {
        text += &format!("/// {i}: {}\n", readable(&coordinate.note));
    }
    text += &format!(
        "#[derive(Clone, Copy, Debug, PartialEq)]\npub struct Motion {{\n    pub displacement: [{real}; {n}],\n    \
         pub velocity: [{real}; {n}],\n}}\n"
    );
    text
}

/// The type of the state.
fn state(plan: &Plan) -> String {
    let real = real(plan);
    let mut text = String::from(
        "\n/// The state: copy it to keep it.\n#[derive(Clone, Copy, Debug, PartialEq)]\npub struct State {\n",
    );
    for array in &plan.state {
        let kind = match &array.start {
            Start::Number(_) => real.to_string(),
            Start::Numbers(numbers) => format!("[{real}; {}]", numbers.len()),
        };
        text += &line(1, &format!("/// {}", readable(&array.note)));
        text += &line(1, &format!("{}: {kind},", array.name));
    }
    if !plan.events.is_empty() {
        text += "    /// steps done\n    tick: u32,\n    /// the next event\n    next: u32,\n";
    }
    text += "}\n";
    text
}

/// The methods of the state.
fn steps(plan: &Plan) -> String {
    let words = Rust::of(plan);
    let n = plan.coordinates.len();
    let mut text = String::from("\nimpl State {\n");
    let parameter = match &plan.style {
        Style::Parameter { value, statements } => Some((*value, statements)),
        Style::Steps | Style::Equations { .. } => None,
    };
    let constant = if parameter.is_some() { "" } else { "const " };
    text += &format!("    /// {}\n    pub {constant}fn init() -> State {{\n", super::INIT);
    text += &line(2, if parameter.is_some() { "let mut state = State {" } else { "State {" });
    for array in &plan.state {
        text += &line(3, &format!("{}: {},", array.name, start(&words, &array.start)));
    }
    if !plan.events.is_empty() {
        text += &(line(3, "tick: 0,") + &line(3, "next: 0,"));
    }
    match parameter {
        None => text += "        }\n    }\n\n",
        Some((value, statements)) => {
            text += "        };\n";
            text += &line(2, &format!("state.set_parameter({});", words.number(value)));
            text += "        state\n    }\n\n";
            text += &format!(
                "    /// {}\n    pub fn set_parameter(&mut self, value: {}) {{\n",
                super::SET_PARAMETER,
                real(plan)
            );
            text += &super::text::statements(&words, statements, 2);
            text += "    }\n\n";
        }
    }
    text += &format!(
        "    /// {}\n    pub fn reset(&mut self) {{\n        *self = State::init();\n    }}\n\n",
        super::RESET
    );
    let step = body_returning_outputs(&words, &plan.step);
    let inputs = inputs(plan, &step);
    text += &format!("    /// {}\n    #[inline]\n    pub fn step(&mut self{inputs}) -> Outputs {{\n", super::STEP);
    text += &(step + "    }\n");
    if plan.tabled {
        text += &state_in_coordinates(&words, n);
    }
    text += "}\n";
    text
}

/// The functions that set and read the state in the model's coordinates.
fn state_in_coordinates(words: &Rust, n: usize) -> String {
    let set_state = statements(words, &words.plan.set_state, 2);
    let motion = if set_state.contains("motion.") { "motion" } else { "_motion" };
    let mut text = format!("\n    /// {}\n    pub fn set_state(&mut self, {motion}: &Motion) {{\n", super::SET_STATE);
    text += &(set_state + "    }\n\n");
    text += &format!("    /// {}\n    pub fn get_state(&self) -> Motion {{\n", super::GET_STATE);
    text += &line(2, &format!("let mut motion = Motion {{ displacement: [0.0; {n}], velocity: [0.0; {n}] }};"));
    text += &(statements(words, &words.plan.get_state, 2) + "        motion\n    }\n");
    text
}

/// The functions of the equations.
fn equations(plan: &Plan, start: &[(f64, f64)]) -> String {
    let words = Rust::of(plan);
    let n = plan.coordinates.len();
    let list = |of: fn(&(f64, f64)) -> f64| start.iter().map(|x| words.number(of(x))).collect::<Vec<_>>().join(", ");
    let (q, v) = (list(|x| x.0), list(|x| x.1));
    let mut text = format!("\nimpl Motion {{\n    /// {}\n    pub const fn init() -> Motion {{\n", super::INIT);
    text += &line(2, &format!("Motion {{ displacement: [{q}], velocity: [{v}] }}"));
    let derivative = statements(&words, &plan.step, 2);
    let given = inputs(plan, &derivative);
    text += &format!("    }}\n\n    /// {}\n    pub fn derivative(&self{given}) -> Motion {{\n", super::DERIVATIVE);
    text += &line(2, &format!("let mut derivative = Motion {{ displacement: [0.0; {n}], velocity: [0.0; {n}] }};"));
    text += &(derivative + "        derivative\n    }\n\n");
    let observe = body_returning_outputs(&words, &plan.observe);
    let given = inputs(plan, &observe);
    text += &format!("    /// {}\n    pub fn observe(&self{given}) -> Outputs {{\n", super::OBSERVE);
    text += &(observe + "    }\n}\n");
    text
}

/// Statements that end with the outputs, as a body that returns them.
fn body_returning_outputs(words: &Rust, list: &[Statement]) -> String {
    let first = list.iter().position(|statement| matches!(statement, Statement::Assign(Target::Output(_), _)));
    let (before, outputs) = list.split_at(first.unwrap_or(list.len()));
    let mut text = statements(words, before, 2) + &line(2, "Outputs {");
    for statement in outputs {
        if let Statement::Assign(Target::Output(output), e) = statement {
            let (name, value) = (&words.plan.outputs[*output].identifier, value(words, e));
            text += &line(3, &if *name == value { format!("{name},") } else { format!("{name}: {value},") });
        }
    }
    text + &line(2, "}")
}

/// The parameter for inputs, if there are any; an underscore marks it as unused in this function.
fn inputs(plan: &Plan, body: &str) -> &'static str {
    match (plan.inputs.is_empty(), body.contains("inputs.")) {
        (true, _) => "",
        (false, true) => ", inputs: &Inputs",
        (false, false) => ", _inputs: &Inputs",
    }
}

fn structure(name: &str, real: &str, fields: &[Field]) -> String {
    let body: String = fields
        .iter()
        .map(|field| {
            line(1, &format!("/// {}", readable(&field.note))) + &line(1, &format!("pub {}: {real},", field.identifier))
        })
        .collect();
    format!("\n#[derive(Clone, Copy, Debug, PartialEq)]\npub struct {name} {{\n{body}}}\n")
}

fn start(words: &Rust, start: &Start) -> String {
    match start {
        Start::Number(x) => words.number(*x),
        Start::Numbers(list) if list.iter().all(|&x| x == 0.0) => format!("[0.0; {}]", list.len()),
        Start::Numbers(list) => {
            let numbers: Vec<String> = list.iter().map(|&x| words.number(x)).collect();
            format!("[{}]", numbers.join(", "))
        }
    }
}

fn constants(words: &Rust, table: &Table) -> String {
    let real = real(words.plan);
    let count = table.values.len();
    let push = |text: &mut String, x| push_decimal(text, x, words.plan.precision);
    let list = |values: &[f64], depth| numbers(values, depth, push);
    if table.columns == 0 {
        let (note, name, list) = (readable(&table.note), &table.name, list(&table.values, 1));
        return format!("\n/// {note}\nstatic {name}: [{real}; {count}] = [\n{list}];\n");
    }
    let rows: String =
        table.values.chunks(table.columns).map(|row| format!("    [\n{}    ],\n", list(row, 2))).collect();
    let (rows_count, columns) = (count / table.columns, table.columns);
    let (note, name) = (readable(&table.note), &table.name);
    format!("\n/// {note}\nstatic {name}: [[{real}; {columns}]; {rows_count}] = [\n{rows}];\n")
}
