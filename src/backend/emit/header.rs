//! The comment on top of emitted code: which model, what goes in and out, how it is computed and how well. Clause: spec.md,
//! "Simulation code".

use crate::analysis::discrete::equations::Equations;
use crate::analysis::discrete::parameter::Parameterised;
use crate::analysis::discrete::{Decay, DiscreteSystem, Form, Hold, Left, Operand, Port, Precision, Why};
use crate::backend::decimal::upper;

/// Parts that are not emitted are listed up to this number.
const LISTED: usize = 12;

/// The lines of the header.
pub fn header(model: &str, system: &DiscreteSystem) -> Vec<String> {
    let mut lines =
        vec![format!("{} · simulation code by vibc {}", plain(model), env!("CARGO_PKG_VERSION")), String::new()];
    lines.extend(ports("input", &system.inputs));
    lines.extend(ports("output", &system.outputs));
    lines.push(format!("method     the exact discrete system, {}", system.method));
    let hold = match system.hold {
        Hold::Zero => "held from sample to sample",
        Hold::First => "run along a line from sample to sample",
    };
    lines.push(format!("step       {:?} s, inputs are {hold}", system.step));
    let precision = match system.precision {
        Precision::Double => "double (binary64)",
        Precision::Single => "single (binary32)",
    };
    lines.push(format!("precision  {precision}; coefficients are computed in double-double and rounded once"));
    let bound = |steps| upper(system.rounding.after(steps));
    lines.push(format!(
        "error      no integrator's; rounding at most {} after 1e3 steps and {} after 1e5, relative to the sum of",
        bound(1000),
        bound(100_000)
    ));
    lines.push("           the largest sizes that the parts of an output have had (if all roundings conspire)".into());
    if let Some(tolerance) = system.tolerance {
        lines.push(format!(
            "tolerance  {tolerance:?}: what is left out for it adds at most {} to an output, beside its largest gain, for inputs",
            upper(system.left.iter().map(share).sum())
        ));
        lines.push(format!("           up to {:?} Hz", 0.5 / system.step));
    }
    for &output in &system.without_slope {
        lines.push(format!(
            "           output {} follows how fast an input changes; between samples a held input does not",
            plain(&system.outputs[output].name)
        ));
    }
    let (multiplications, additions) = operations(system);
    lines.push(format!(
        "cost       {} states; {multiplications} multiplications and {additions} additions a step",
        system.states()
    ));
    lines.extend(left(&system.left));
    lines
}

/// The lines of the header of equations.
pub fn of_equations(model: &str, equations: &Equations) -> Vec<String> {
    let mut lines =
        vec![format!("{} · equations of motion by vibc {}", plain(model), env!("CARGO_PKG_VERSION")), String::new()];
    lines.extend(ports("input", &equations.inputs));
    lines.extend(ports("output", &equations.outputs));
    lines.push(
        "method     the right-hand side of a first-order system, for an integrator of your own; its error is the"
            .into(),
    );
    lines.push("           integrator's. Deviations from rest, linearised there.".into());
    let precision = match equations.precision {
        Precision::Double => "double (binary64)",
        Precision::Single => "single (binary32)",
    };
    lines.push(format!("precision  {precision}"));
    lines.push(format!("cost       {} springs and dampers between coordinates", equations.stretches.len()));
    lines
}

/// The lines of the header of code with a parameter that may be set.
pub fn of_parameter(model: &str, system: &Parameterised, step: f64) -> Vec<String> {
    let title = format!("{} · simulation code by vibc {}", plain(model), env!("CARGO_PKG_VERSION"));
    let mut lines = vec![title, String::new()];
    lines.extend(ports("input", &system.inputs));
    lines.extend(ports("output", &system.outputs));
    let (name, value) = (plain(&system.name), system.value);
    lines.push(format!(
        "parameter  {name}, {value:?} in SI until `set_parameter`; from {:?} to {:?}",
        system.range.0, system.range.1
    ));
    lines.push(
        "method     one dense step; `set_parameter` assembles it anew and takes the matrix exponential in the".into(),
    );
    lines.push("           code's own precision, by a number of operations that does not depend on the value".into());
    lines.push(format!("step       {step:?} s, inputs are held from sample to sample"));
    let (n, width) = (2 * system.coordinates.len(), 2 * system.coordinates.len() + system.inputs.len());
    let products = (n + system.outputs.len()) * width;
    lines.push(format!("cost       {n} states; {products} multiplications and as many additions a step"));
    lines.push("error      no integrator's; what rounding of the exponential costs is not bounded here".into());
    lines
}

fn ports(what: &str, ports: &[Port]) -> Vec<String> {
    let unit = |port: &Port| if port.unit.is_empty() { String::new() } else { format!(", {}", port.unit) };
    if ports.is_empty() {
        return vec![format!("{what}      none")];
    }
    ports.iter().map(|port| format!("{what:<9}  {}{}", plain(&port.name), unit(port))).collect()
}

/// Names hold letters, but a comment holds lines.
fn plain(name: &str) -> String {
    name.chars().map(|c| if c.is_control() { '?' } else { c }).collect()
}

fn share(left: &Left) -> f64 {
    match left.why {
        Why::Small(share) => share,
        Why::Unreached | Why::Unseen => 0.0,
    }
}

fn left(left: &[Left]) -> Vec<String> {
    let line = |left: &Left| {
        let why = match left.why {
            Why::Unreached => "no input reaches it, and it starts at rest".to_string(),
            Why::Unseen => "no output sees it".to_string(),
            Why::Small(share) => format!("it contributes at most {}, its static part is kept", upper(share)),
        };
        format!("left out   {}: {why}", left.name)
    };
    let more = left.len().saturating_sub(LISTED);
    let rest = (more > 0).then(|| format!("           and {more} more"));
    left.iter().take(LISTED).map(line).chain(rest).collect()
}

/// Multiplications and additions of a step.
fn operations(system: &DiscreteSystem) -> (usize, usize) {
    let mut terms: Vec<f64> = system.direct.iter().flatten().map(|(_, d)| *d).collect();
    // Factors of states that nothing is added to.
    let mut alone = 0;
    for cell in &system.cells {
        terms.extend(cell.input.iter().flatten().map(|(_, g)| *g));
        terms.extend(cell.output.iter().flatten().map(|(_, c)| *c));
        match &cell.form {
            Form::Keep(_) => alone += 1,
            Form::Lose(d) => terms.push(*d),
            Form::Pair(lift) => {
                match lift.decay {
                    Decay::Lose(c) => terms.push(c),
                    Decay::Keep(_) => alone += 1,
                }
                terms.extend([lift.k, lift.p]);
            }
            Form::Dense(rows) => terms.extend(rows.iter().flatten()),
        }
    }
    terms.retain(|factor| *factor != 0.0);
    let of_inputs = |j: usize| {
        usize::from(system.uses(|o| *o == Operand::Ramped(j))) + usize::from(system.uses(|o| *o == Operand::Slope(j)))
    };
    let of_inputs: usize = (0..system.inputs.len()).map(of_inputs).sum();
    let products = terms.iter().filter(|factor| factor.abs() != 1.0).count() + alone + of_inputs;
    // The first term of a sum needs no addition.
    (products, terms.len().saturating_sub(system.outputs.len()))
}
