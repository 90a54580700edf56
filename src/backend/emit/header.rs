//! The comment at the top of emitted code: its model, inputs and outputs, the method, and the accuracy. See
//! docs/method/emit.md.

use super::plan::Operations;
use crate::analysis::discrete::equations::Equations;
use crate::analysis::discrete::parameter::Parameterised;
use crate::analysis::discrete::{DiscreteSystem, DroppedBlock, Hold, Port, Precision, Rounding, Why};
use crate::backend::decimal::{round_unproven, upper};
use crate::backend::diagnostics::readable;
use crate::base::Unproven;

/// The most omitted parts, and blocks with bounds of their own, that are listed.
const LISTED: usize = 12;
/// A block whose bounds are at most this times the largest ones has a line of its own.
const MUCH_LESS: f64 = 0.1;

/// The lines of the header.
pub fn header(model: &str, system: &DiscreteSystem, operations: Operations) -> Vec<String> {
    let mut lines =
        vec![format!("{} · simulation code by vibc {}", readable(model), env!("CARGO_PKG_VERSION")), String::new()];
    lines.extend(ports("input", &system.inputs));
    lines.extend(ports("output", &system.outputs));
    lines.push(format!("method     the exact discrete system, {}", system.method));
    let hold = match system.hold {
        Hold::Zero => "held from sample to sample",
        Hold::First => "interpolated linearly between samples",
    };
    lines.push(format!("step       {:?} s, inputs are {hold}", system.step));
    let precision = match system.precision {
        Precision::Double => "double (binary64)",
        Precision::Single => "single (binary32)",
    };
    lines.push(format!("precision  {precision}; coefficients are computed in double-double and rounded once"));
    lines.extend(error(system));
    if let Some(tolerance) = system.tolerance {
        lines.push(format!(
            "tolerance  {tolerance:?}: omitted parts change an output by about {} of its largest gain, for",
            round_unproven(Unproven(system.left.iter().map(share).sum()), 1)
        ));
        lines.push(format!(
            "           harmonic inputs up to {:?} Hz; just after a step or an impulse the change may be larger",
            0.5 / system.step
        ));
    }
    for &output in &system.without_slope {
        lines.push(format!(
            "           output {} depends on the rate of an input; a held input does not change between samples",
            readable(&system.outputs[output].name)
        ));
    }
    for name in system.laws.iter().take(LISTED) {
        lines.push(format!("laws       {}: its tangent at rest in place of its law", readable(name)));
    }
    if let Some(more) = system.laws.len().checked_sub(LISTED).filter(|more| *more > 0) {
        lines.push(format!("           and {more} more"));
    }
    lines.push(format!("cost       {} states; {operations} a step", system.states()));
    if !system.tabled {
        lines.push(
            "state      without set_state and get_state: of so many states their tables would fill the file".into(),
        );
    }
    lines.extend(dropped_lines(&system.left));
    lines
}

/// The effect of rounding: measured if the run is known, a bound if inputs come from outside.
fn error(system: &DiscreteSystem) -> Vec<String> {
    let lines: Vec<String> = (system.measured.iter())
        .map(|measured| format!("{} in {} steps", upper(measured.error), measured.steps))
        .collect();
    if let Some((last, others)) = lines.split_last() {
        let before = if others.is_empty() { String::new() } else { format!("{} and ", others.join(", ")) };
        return vec![
            format!("error      no integrator's; from `init` on, rounding takes at most {before}{last} of the"),
            "           largest value of each output (found by the same steps in double-double beside it)".into(),
        ];
    }
    let Some(rounding) = &system.rounding else {
        return vec![
            "error      no integrator's; the effect of rounding is not bounded: signals are built in beside inputs"
                .into(),
        ];
    };
    let after = |steps| Some(rounding.error_after(steps)).filter(|bound| bound.is_finite()).map(upper);
    let parts =
        "           the largest sizes that the parts of an output have had: what each input, and the initial state,";
    let rest = "           contributes by each block and directly (a bound for every input: if all roundings conspire)";
    let blocks = better_blocks(rounding);
    match (after(1000), after(100_000)) {
        (Some(few), Some(many)) => vec![
            format!(
                "error      no integrator's; rounding at most {few} after 1e3 steps and {many} after 1e5, relative to the sum of"
            ),
            parts.into(),
            rest.into(),
        ]
        .into_iter()
        .chain(blocks)
        .collect(),
        (Some(few), None) => vec![
            format!("error      no integrator's; rounding at most {few} after 1e3 steps (no bound after 1e5), relative to the sum of"),
            parts.into(),
            rest.into(),
        ],
        _ => vec![
            "error      no integrator's; rounding has no bound after 1e3 steps: a motion grows, or the precision is too low".into(),
        ],
    }
}

/// The blocks of which much less is lost than of the worst one; without a bound after many steps that of few is not enough.
fn better_blocks(rounding: &Rounding) -> Vec<String> {
    let steps = [1000, 100_000];
    let [few, many] = steps.map(|steps| rounding.errors_after(steps));
    let worst = steps.map(|steps| rounding.error_after(steps).value());
    let better: Vec<String> = (few.zip(many))
        .filter(|((_, few), (_, many))| few.value() <= MUCH_LESS * worst[0] && many.value() <= MUCH_LESS * worst[1])
        .map(|((name, few), (_, many))| format!("{name}: at most {} and {}", upper(few), upper(many)))
        .collect();
    let first = (!better.is_empty()).then(|| "           of these parts, those by".to_string());
    let more = better.len().saturating_sub(LISTED);
    let rest = (more > 0).then(|| format!("           and {more} more"));
    let lines = better.iter().take(LISTED).map(|line| format!("           - {line}"));
    first.into_iter().chain(lines).chain(rest).collect()
}

/// The lines of the header of equations.
pub fn of_equations(model: &str, equations: &Equations, operations: Operations) -> Vec<String> {
    let mut lines =
        vec![format!("{} · equations of motion by vibc {}", readable(model), env!("CARGO_PKG_VERSION")), String::new()];
    lines.extend(ports("input", &equations.inputs));
    lines.extend(ports("output", &equations.outputs));
    lines.push(
        "method     the right-hand side of a first-order system, for your own integrator; its error is the".into(),
    );
    lines.push("           integrator's. Deviations from rest, linearised there.".into());
    let precision = match equations.precision {
        Precision::Double => "double (binary64)",
        Precision::Single => "single (binary32)",
    };
    lines.push(format!("precision  {precision}"));
    lines.push(format!("cost       {operations} a derivative"));
    lines
}

/// The lines of the header of code with an adjustable parameter.
pub fn of_parameter(model: &str, system: &Parameterised, step: f64, operations: Operations) -> Vec<String> {
    let title = format!("{} · simulation code by vibc {}", readable(model), env!("CARGO_PKG_VERSION"));
    let mut lines = vec![title, String::new()];
    lines.extend(ports("input", &system.inputs));
    lines.extend(ports("output", &system.outputs));
    let (name, value) = (readable(&system.name), system.value);
    lines.push(format!(
        "parameter  {name}, {value:?} in SI until `set_parameter`; from {:?} to {:?}",
        system.range.0, system.range.1
    ));
    lines.push(
        "method     one dense step; `set_parameter` reassembles it and computes the matrix exponential in the".into(),
    );
    lines.push("           code's own precision, in a number of operations that does not depend on the value".into());
    lines.push(format!("step       {step:?} s, inputs are held from sample to sample"));
    lines.push(format!("cost       {} states; {operations} a step", 2 * system.coordinates.len()));
    lines.push("error      no integrator's; what rounding of the exponential costs is not bounded here".into());
    lines
}

fn ports(what: &str, ports: &[Port]) -> Vec<String> {
    let unit = |port: &Port| if port.unit.is_empty() { String::new() } else { format!(", {}", port.unit) };
    if ports.is_empty() {
        return vec![format!("{what}      none")];
    }
    ports.iter().map(|port| format!("{what:<9}  {}{}", readable(&port.name), unit(port))).collect()
}

fn share(left: &DroppedBlock) -> f64 {
    match left.why {
        Why::Small(Unproven(share)) => share,
        Why::Unreached | Why::Unseen => 0.0,
    }
}

fn dropped_lines(left: &[DroppedBlock]) -> Vec<String> {
    let line = |left: &DroppedBlock| {
        let why = match left.why {
            Why::Unreached => "no input reaches it, and it starts at rest".to_string(),
            Why::Unseen => "no output depends on it".to_string(),
            Why::Small(share) => format!("it contributes about {}, its static part is kept", round_unproven(share, 1)),
        };
        format!("left out   {}: {why}", left.name)
    };
    let more = left.len().saturating_sub(LISTED);
    let rest = (more > 0).then(|| format!("           and {more} more"));
    left.iter().take(LISTED).map(line).chain(rest).collect()
}
