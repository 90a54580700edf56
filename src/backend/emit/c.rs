//! C99: `NAME.h` and `NAME.c`. See docs/method/emit.md.

use super::plan::{Plan, Start, Style, Table};
use super::text::{Words, decimal, line, numbers, push_decimal, statements};
use super::{File, NO_STATE};
use crate::analysis::discrete::{Again, Precision};
use crate::backend::diagnostics::readable;

/// The two files.
pub fn files(plan: &Plan) -> Vec<File> {
    vec![
        File { name: format!("{}.h", plan.name), text: header(plan) },
        File { name: format!("{}.c", plan.name), text: format!("#include \"{}.h\"\n", plan.name) + &body(plan) },
    ]
}

/// Both files as one, for a single stream.
pub fn whole(plan: &Plan) -> String {
    header(plan) + "\n" + &body(plan)
}

/// The syntax of C for the elements of a plan.
struct C<'a> {
    plan: &'a Plan,
}

impl Words for C<'_> {
    fn number(&self, x: f64) -> String {
        decimal(x, self.plan.precision) + suffix(self.plan.precision)
    }

    fn state(&self, array: &str, index: Option<String>) -> String {
        index.map_or_else(|| format!("state->{array}"), |index| format!("state->{array}[{index}]"))
    }

    fn input(&self, input: usize) -> String {
        format!("inputs->{}", self.plan.inputs[input].identifier)
    }

    fn output(&self, output: usize) -> String {
        format!("outputs->{}", self.plan.outputs[output].identifier)
    }

    fn motion(&self, what: &str, index: String) -> String {
        format!("motion->{what}[{index}]")
    }

    fn derivative(&self, what: &str, index: String) -> String {
        format!("derivative->{what}[{index}]")
    }

    fn note(&self, note: &str) -> String {
        comment(note)
    }

    fn constant(&self, name: &str, value: &str) -> String {
        format!("const {} {name} = {value};", real(self.plan))
    }

    fn variable(&self, name: &str, value: &str) -> String {
        format!("{} {name} = {value};", real(self.plan))
    }

    fn lanes(&self, name: &str, width: usize) -> String {
        format!("{} {name}[{width}] = {{{}}};", real(self.plan), vec![self.number(0.0); width].join(", "))
    }

    fn matrix(&self, name: &str, rows: usize, columns: usize) -> String {
        format!("{} {name}[{rows}][{columns}] = {{{{{}}}}};", real(self.plan), self.number(0.0))
    }

    fn loop_head(&self, index: &str, count: usize) -> String {
        format!("for (int {index} = 0; {index} < {count}; {index}++) {{")
    }

    fn repeat_head(&self, count: usize) -> String {
        self.loop_head("repeat", count)
    }

    fn block_heads(&self, count: usize, width: usize) -> [String; 2] {
        [
            format!("for (int block = 0; block < {count}; block += {width}) {{"),
            format!("for (int lane = 0; lane < {width}; lane++) {{"),
        ]
    }

    fn due(&self, count: usize, again: Option<Again>) -> [Vec<String>; 2] {
        let mut after = vec!["    state->next = event + 1u;".to_string()];
        if let Some(Again { first, ticks }) = again {
            after.push(format!("    if (state->next == {count}u) {{"));
            after.push(format!("        state->next = {first}u;"));
            after.push(format!("        state->tick = state->tick - {ticks}u;"));
            after.push("    }".to_string());
        }
        after.push("}".to_string());
        [
            vec![
                "state->tick = state->tick + 1u;".to_string(),
                format!("if (state->next < {count}u && EVENTS[state->next] == state->tick) {{"),
                "    const uint32_t event = state->next;".to_string(),
            ],
            after,
        ]
    }

    fn lane(&self, _: usize) -> String {
        "block + lane".to_string()
    }
}

fn real(plan: &Plan) -> &'static str {
    match plan.precision {
        Precision::Double => "double",
        Precision::Single => "float",
    }
}

/// Escapes a model's names, which may contain the end of a comment or parts of trigraphs.
fn comment(text: &str) -> String {
    format!("/* {} */", safe(text))
}

fn safe(text: &str) -> String {
    readable(text).replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?")
}

fn block_comment(lines: &[String]) -> String {
    let body: String = lines.iter().map(|text| format!(" * {}", safe(text)).trim_end().to_string() + "\n").collect();
    format!("/*\n{body} */\n")
}

fn header(plan: &Plan) -> String {
    let (name, real) = (&plan.name, real(plan));
    let guard = format!("VIBC_{}_H", name.to_uppercase());
    let mut text = block_comment(&plan.header);
    text += &format!("#ifndef {guard}\n#define {guard}\n\n#ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n");
    if !plan.events.is_empty() {
        text = text.replace("#ifdef __cplusplus\nextern", "#include <stdint.h>\n\n#ifdef __cplusplus\nextern");
    }
    if !matches!(plan.style, Style::Equations { .. }) {
        text += &state(plan);
    }
    let structure = |what: &str, fields: &[super::plan::Field]| {
        let body: String = fields
            .iter()
            .map(|field| line(1, &format!("{real} {}; {}", field.identifier, comment(&field.note))))
            .collect();
        format!("typedef struct {name}_{what} {{\n{body}}} {name}_{what};\n\n")
    };
    if !plan.inputs.is_empty() {
        text += &structure("inputs", &plan.inputs);
    }
    text += &structure("outputs", &plan.outputs);
    if plan.tabled {
        text += &motion(plan);
    }
    for Function { note, head, .. } in functions(plan) {
        text += &format!("{}\n{head};\n", comment(note));
    }
    text += "\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n";
    text
}

/// The type of a motion in the model's coordinates.
fn motion(plan: &Plan) -> String {
    let (name, real) = (&plan.name, real(plan));
    let n = plan.coordinates.len();
    let mut text =
        String::from("/* The motion in the model's own coordinates, deviations from rest, with their velocities:\n");
    for (i, coordinate) in plan.coordinates.iter().enumerate() {
        text += &format!(" * {i}: {}\n", safe(&coordinate.note));
    }
    text += " */\n";
    text += &format!(
        "typedef struct {name}_motion {{\n    {real} displacement[{n}];\n    {real} velocity[{n}];\n}} {name}_motion;\n\n"
    );
    text
}

/// The type of the state.
fn state(plan: &Plan) -> String {
    let (name, real) = (&plan.name, real(plan));
    let mut text = String::from("/* The state: copy it to keep it. */\n");
    text += &format!("typedef struct {name}_state {{\n");
    if plan.state.is_empty() {
        text +=
            &line(1, &format!("{real} {NO_STATE}; {}", comment("there is no state, and C has no empty structures")));
    }
    for array in &plan.state {
        let size = match &array.start {
            Start::Number(_) => String::new(),
            Start::Numbers(numbers) => format!("[{}]", numbers.len()),
        };
        text += &line(1, &format!("{real} {}{size}; {}", array.name, comment(&array.note)));
    }
    if !plan.events.is_empty() {
        text += &line(1, &format!("uint32_t tick; {}", comment("steps done")));
        text += &line(1, &format!("uint32_t next; {}", comment("the next event")));
    }
    text += &format!("}} {name}_state;\n\n");
    text
}

/// A function: its comment, declaration and body.
struct Function {
    note: &'static str,
    head: String,
    body: String,
}

fn functions(plan: &Plan) -> Vec<Function> {
    let (name, words) = (&plan.name, C { plan });
    let inputs = if plan.inputs.is_empty() { String::new() } else { format!("const {name}_inputs *inputs, ") };
    let written = |list| statements(&words, list, 1);
    let function = |note, head: String, body| Function { note, head: format!("void {name}_{head}"), body };
    if let Style::Equations { start } = &plan.style {
        let motion = format!("const {name}_motion *motion");
        return vec![
            function(super::INIT, format!("init({name}_motion *motion)"), motion_start(&words, start)),
            function(
                super::DERIVATIVE,
                format!("derivative({motion}, {inputs}{name}_motion *derivative)"),
                written(&plan.step),
            ),
            function(
                super::OBSERVE,
                format!("observe({motion}, {inputs}{name}_outputs *outputs)"),
                written(&plan.observe),
            ),
        ];
    }
    let state = format!("{name}_state *state");
    let mut beginning = start(&words) + &events_start(plan);
    let mut more = Vec::new();
    if let Style::Parameter { value, statements } = &plan.style {
        beginning += &line(1, &format!("{name}_set_parameter(state, {});", words.number(*value)));
        let head = format!("set_parameter({state}, {} value)", real(plan));
        more.push(function(super::SET_PARAMETER, head, written(statements)));
    }
    let mut all = vec![
        function(super::INIT, format!("init({state})"), beginning),
        function(super::RESET, format!("reset({state})"), line(1, &format!("{name}_init(state);"))),
        function(super::STEP, format!("step({state}, {inputs}{name}_outputs *outputs)"), written(&plan.step)),
    ];
    if plan.tabled {
        let set = format!("set_state({state}, const {name}_motion *motion)");
        let get = format!("get_state(const {state}, {name}_motion *motion)");
        all.push(function(super::SET_STATE, set, written(&plan.set_state)));
        all.push(function(super::GET_STATE, get, written(&plan.get_state)));
    }
    all.extend(more);
    all
}

fn motion_start(words: &C, start: &[(f64, f64)]) -> String {
    let one = |(i, (q, v)): (usize, &(f64, f64))| {
        line(1, &format!("motion->displacement[{i}] = {};", words.number(*q)))
            + &line(1, &format!("motion->velocity[{i}] = {};", words.number(*v)))
    };
    start.iter().enumerate().map(one).collect()
}

fn body(plan: &Plan) -> String {
    let words = C { plan };
    let mut text = String::from(CONTRACTION);
    for table in &plan.tables {
        text += &constants(&words, table);
    }
    if !plan.events.is_empty() {
        let ticks: Vec<String> = plan.events.iter().map(|tick| format!("    {tick}u,\n")).collect();
        let (note, count) = (comment("samples with events"), ticks.len());
        text += &format!("\n{note}\nstatic const uint32_t EVENTS[{count}] = {{\n{}}};\n", ticks.concat());
    }
    for Function { head, body, .. } in functions(plan) {
        text += &function(&head, &body);
    }
    text
}

/// A product and a sum must stay two operations, so that every machine computes the same bits.
const CONTRACTION: &str = "
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize(\"fp-contract=off\")
#endif
";

/// A function that marks its unused parameters.
fn function(head: &str, body: &str) -> String {
    let unused: String = (["state", "inputs", "outputs", "motion"].iter())
        .filter(|name| {
            head.contains(&format!("*{name}")) && !body.contains(&format!("{name}->")) && !body.contains("_init(state)")
        })
        .map(|name| line(1, &format!("(void){name};")))
        .collect();
    format!("\n{head}\n{{\n{unused}{body}}}\n")
}

fn start(words: &C) -> String {
    let mut text = String::new();
    if words.plan.state.is_empty() {
        text += &line(1, &format!("state->{NO_STATE} = {};", words.number(0.0)));
    }
    for array in &words.plan.state {
        match &array.start {
            Start::Number(x) => text += &line(1, &format!("state->{} = {};", array.name, words.number(*x))),
            Start::Numbers(list) if list.iter().all(|&x| x == 0.0) => {
                text += &line(1, &words.loop_head("i", list.len()));
                text += &line(2, &format!("state->{}[i] = {};", array.name, words.number(0.0)));
                text += &line(1, "}");
            }
            Start::Numbers(list) => {
                for (i, x) in list.iter().enumerate() {
                    text += &line(1, &format!("state->{}[{i}] = {};", array.name, words.number(*x)));
                }
            }
        }
    }
    text
}

fn events_start(plan: &Plan) -> String {
    if plan.events.is_empty() { String::new() } else { line(1, "state->tick = 0u;") + &line(1, "state->next = 0u;") }
}

/// What follows a number: without it, all would be computed in double precision.
fn suffix(precision: Precision) -> &'static str {
    if precision == Precision::Single { "f" } else { "" }
}

fn constants(words: &C, table: &Table) -> String {
    let real = real(words.plan);
    let count = table.values.len();
    let precision = words.plan.precision;
    let push = |text: &mut String, x| {
        push_decimal(text, x, precision);
        text.push_str(suffix(precision));
    };
    let list = |values: &[f64], depth| numbers(values, depth, push);
    if table.columns == 0 {
        let (note, name, list) = (comment(&table.note), &table.name, list(&table.values, 1));
        return format!("\n{note}\nstatic const {real} {name}[{count}] = {{\n{list}}};\n");
    }
    let rows: String =
        table.values.chunks(table.columns).map(|row| format!("    {{\n{}    }},\n", list(row, 2))).collect();
    let (rows_count, columns) = (count / table.columns, table.columns);
    let (note, name) = (comment(&table.note), &table.name);
    format!("\n{note}\nstatic const {real} {name}[{rows_count}][{columns}] = {{\n{rows}}};\n")
}
