//! The command `emit`: the exact discrete system, the equations, or a system with one parameter left open, as code. See
//! docs/cli.md.

use crate::files::{Input, read_all, refuse_overwriting};
use crate::{Status, deliver, failure, report_error, show};
use std::fs;
use std::path::{Path, PathBuf};
use vibc::analysis::{self, discrete::Hold};
use vibc::backend::emit::{Language, Program};
use vibc::backend::{self, diagnostics};
use vibc::cli::{self, Emit, HoldOption, Messages, SignalsOption, StyleOption, TargetOption};

pub fn emit(options: &Emit, messages: &Messages) -> Status {
    let literals = options.overrides.literals;
    let step = options.step.of_literals(literals);
    let until = options.until.as_ref().map(|until| until.of_literals(literals));
    let samples = until.map_or(0.0, |until| (until / step).to_f64());
    if samples > cli::MOST_PROGRAM_SAMPLES {
        report_error(&format!("that would be {samples:.0} samples; the limit is {}", cli::MOST_PROGRAM_SAMPLES));
        return Status::Usage;
    }
    let program = until.map(|until| Program { step: step.clone(), samples: analysis::samples(until, step) });
    let input = match read_all(&options.file, &options.overrides) {
        Ok(input) => input,
        Err(unreadable) => return unreadable.report(messages),
    };
    let language = match options.target {
        TargetOption::C => Language::C,
        TargetOption::Rust => Language::Rust,
    };
    if let Some(name) = &options.parameter {
        return emit_parameter(options, name, &input, language, messages);
    }
    if options.style == StyleOption::Equations {
        return emit_equations(options, &input, language, messages);
    }
    let wanted = analysis::discrete::Options {
        step: step.clone(),
        hold: match options.hold {
            HoldOption::Zero => Hold::Zero,
            HoldOption::First => Hold::First,
        },
        precision: options.precision.into(),
        tolerance: options.tolerance,
        unpruned: false,
        built_in: options.program || options.signals == SignalsOption::Internal,
        internal: Vec::new(),
        until: until.cloned(),
    };
    let outcome = vibc::discrete(&input.sources, input.model, &input.overrides, &wanted);
    let status = failure(outcome.failure());
    show(&input.sources, outcome.diagnostics, messages);
    let Some(emission) = &outcome.answer else { return status };
    if emission.system.outputs.is_empty() {
        report_error("the model declares no output");
        return Status::Usage;
    }
    match &options.output {
        None => deliver(None, &backend::emit::whole(&emission.model, &emission.system, language)),
        Some(folder) => {
            let files = backend::emit::files(&emission.model, &emission.system, language, program.as_ref());
            deliver_all(folder, &files, options, &input)
        }
    }
}

fn emit_equations(options: &Emit, input: &Input, language: Language, messages: &Messages) -> Status {
    if options.program || options.tolerance.is_some() {
        report_error(
            "`--style equations` has neither `--program` nor `--tolerance`: it is the model itself, not its motion",
        );
        return Status::Usage;
    }
    let outcome = vibc::linear(&input.sources, input.model, &input.overrides);
    let status = failure(outcome.failure());
    show(&input.sources, outcome.diagnostics, messages);
    let Some((model, system)) = &outcome.answer else { return status };
    if system.outputs.is_empty() {
        report_error("the model declares no output");
        return Status::Usage;
    }
    match analysis::discrete::equations::equations(system, options.precision.into()) {
        Ok(equations) => match &options.output {
            None => deliver(None, &backend::emit::equation_text(model, &equations, language)),
            Some(folder) => {
                deliver_all(folder, &backend::emit::equation_files(model, &equations, language), options, input)
            }
        },
        Err(none) => {
            report_error(&none.to_string());
            Status::Limit
        }
    }
}

fn emit_parameter(options: &Emit, name: &str, input: &Input, language: Language, messages: &Messages) -> Status {
    let outcome = vibc::over_parameter(&input.sources, input.model, &input.overrides, name);
    let status = failure(outcome.failure());
    show(&input.sources, outcome.diagnostics, messages);
    let Some((model, found)) = &outcome.answer else { return status };
    let system = match found {
        Ok(system) if system.outputs.is_empty() => {
            report_error("the model declares no output");
            return Status::Usage;
        }
        Ok(system) => system,
        Err(reason) => {
            report_error(&format!("`--parameter {}` cannot stay changeable: {reason}", diagnostics::readable(name)));
            return Status::Usage;
        }
    };
    let step = options.step.of_literals(options.overrides.literals).to_f64();
    let precision = options.precision.into();
    let out_of_range = || {
        report_error(
            "a number of the code leaves the range of its precision: check the units, or use `--precision f64`",
        );
        Status::Limit
    };
    match &options.output {
        None => match backend::emit::parameter_text(model, system, step, precision, language) {
            Some(text) => deliver(None, &text),
            None => out_of_range(),
        },
        Some(folder) => match backend::emit::parameter_files(model, system, step, precision, language) {
            Some(files) => deliver_all(folder, &files, options, input),
            None => out_of_range(),
        },
    }
}

/// Writes files into a folder, which is created if necessary, unless one of the files is also read.
fn deliver_all(folder: &Path, files: &[backend::emit::File], options: &Emit, input: &Input) -> Status {
    let paths: Vec<PathBuf> = files.iter().map(|file| folder.join(&file.name)).collect();
    if let Err(status) = refuse_overwriting(input, &options.file, &options.overrides, &paths) {
        return status;
    }
    if let Err(error) = fs::create_dir_all(folder) {
        report_error(&format!("cannot make the directory `{}`: {error}", folder.display()));
        return Status::Io;
    }
    files.iter().map(|file| deliver(Some(&folder.join(&file.name)), &file.text)).max().unwrap_or(Status::Done)
}
