//! The program `vibc`: reads files, calls the library, writes what it returns. Nothing else touches the disk, the standard
//! streams or the exit status. See docs/cli.md#streams-and-exit-status.

mod emitting;
mod files;
mod merging;
mod named;
mod parts;
mod sweeping;
mod terminal;
mod transport;
mod watch;

use clap::{CommandFactory, FromArgMatches, Parser};
use files::{open, read, read_all, write_result};
use std::io;
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread;
use terminal::{columns, report_defect, report_error, show, terminal_columns, write_to};
use vibc::analysis::{self, AnalysisError, Methods, Modes, Sweep, Table};
use vibc::answers::report;
use vibc::backend::{self, ReportOptions, diagnostics};
use vibc::base::{SourceFile, SourceKind, Sources};
use vibc::cli::{
    self, Analyze, Bench, BenchFormat, Check, Cli, Command, Draw, Equations, EquationsFormat, Fmt, Format, Messages,
    Report, Shock, Simulate, TableFormat, Transfer,
};
use vibc::editor;
use vibc::editor::server::{self, Leave, Named};
use vibc::{Dynamics, NotDriven};

/// The exit status of the process.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Status {
    Done = 0,
    Errors = 1,
    Usage = 2,
    Io = 3,
    Limit = 4,
}

fn main() -> ExitCode {
    std::panic::set_hook(Box::new(report_defect));
    let cli = command_line().unwrap_or_else(|error| refuse(&error));
    let status = match &cli.command {
        Command::Analyze(options) => analyze(options, &cli.messages),
        Command::Transfer(options) => transfer(options, &cli.messages),
        Command::Simulate(options) => simulate(options, &cli.messages),
        Command::Shock(options) => shock(options, &cli.messages),
        Command::Sweep(options) => sweeping::sweep(options, &cli.messages),
        Command::Merge(options) => merging::merge(options),
        Command::Draw(options) => draw(options, &cli.messages),
        Command::Report(options) => page(options, &cli.messages),
        Command::Watch(options) => watch::watch(options, &cli.messages),
        Command::Emit(options) => emitting::emit(options, &cli.messages),
        Command::Equations(options) => equations(options, &cli.messages),
        Command::Check(options) => check(options, &cli.messages),
        Command::Fmt(options) => format(options, &cli.messages),
        Command::Lsp(_) => language_server(),
        Command::Explain(options) => explain(options.subject.as_deref()),
        Command::Completions(options) => completions(options.shell),
        Command::Man(options) => manual_page(options.command.as_deref()),
        Command::Bench(options) => bench(options, &cli.messages),
    };
    ExitCode::from(status as u8)
}

/// The command line of this process.
fn command_line() -> Result<Cli, clap::Error> {
    // The description is never taken apart: that would take a fiftieth of a run on a small model.
    let mut description = ManuallyDrop::new(Cli::command());
    let mut given = description.try_get_matches_from_mut(std::env::args_os())?;
    Cli::from_arg_matches_mut(&mut given).map_err(|error| error.format(&mut description))
}

/// Shows help, or the errors of the command line. clap repeats arguments as they are, so characters that would control
/// the terminal are made visible first.
fn refuse(error: &clap::Error) -> ! {
    let arguments: Vec<String> = std::env::args_os().map(|argument| argument.to_string_lossy().into_owned()).collect();
    if arguments.iter().all(|argument| diagnostics::readable(argument) == *argument) {
        error.exit();
    }
    let shown = arguments.iter().map(|argument| diagnostics::readable(argument).into_owned());
    if let Err(error) = Cli::try_parse_from(shown) {
        error.exit();
    }
    // The error was that character itself.
    let lines: Vec<String> = error.to_string().lines().map(|line| diagnostics::readable(line).into_owned()).collect();
    write_to(&mut io::stderr().lock(), &(lines.join("\n") + "\n"));
    std::process::exit(error.exit_code())
}

fn analyze(options: &Analyze, messages: &Messages) -> Status {
    let input = match open(&options.file, &options.overrides, &options.output.file, messages) {
        Ok(input) => input,
        Err(status) => return status,
    };
    let until = options.measured.until(&options.overrides);
    let spectra = vibc::SpectrumAdditions {
        missing_mass: options.missing_mass,
        across: options.across_directions,
        other_damping: options.other_damping,
    };
    let damped_shapes = options.shapes == vibc::cli::ShapesOption::Damped;
    let nodes = options.shapes == vibc::cli::ShapesOption::All;
    let study = vibc::Study {
        until,
        sensitivity: options.sensitivity,
        tolerances: options.tolerances,
        robust: options.robust,
        participation: options.participation,
        damped_shapes,
        nodes,
        spectra,
    };
    let request = options.request();
    let (mut analysis, explained) = match options.explain_model {
        true => vibc::analyze_and_explain(&input.sources, input.model, &input.overrides, &request, &study),
        false => (vibc::analyze_with(&input.sources, input.model, &input.overrides, &request, &study), None),
    };
    let status = failure(analysis.failure());
    show(&input.sources, std::mem::take(&mut analysis.diagnostics), messages);
    let Some(answer) = &analysis.answer else {
        // A model that is too large to be analysed can still be explained.
        if let Some(explained) = explained.filter(|_| options.format == Format::Text) {
            let text = backend::report::explanation(
                &explained.model,
                &explained.account,
                &explained.system,
                columns(&options.page, options.output.file.as_deref()),
            );
            return deliver(options.output.file.as_deref(), &text).max(status);
        }
        return status;
    };
    if options.robust && answer.optimised.is_empty() {
        report_error("the model has no line `minimise` or `maximise`, whose worst case `--robust` would optimise");
        return Status::Usage;
    }
    let has_no_range = options.robust && answer.optimised.iter().any(|found| found.robust.is_none());
    if options.tolerances && answer.tolerated.is_none() || has_no_range {
        report_error(
            "no parameter of the model has a range: write `within 5 %` or `within 9 N/m .. 12 N/m` after its value",
        );
        return Status::Usage;
    }
    let wanted = ReportOptions {
        normalise: options.normalise.into(),
        matrices: options.matrices,
        digits: options.digits,
        all_shapes: options.shapes == vibc::cli::ShapesOption::All,
    };
    let text = match options.format {
        Format::Text => {
            let width = columns(&options.page, options.output.file.as_deref());
            backend::report::laid_out(&report::modal(answer, &wanted), width)
        }
        Format::Markdown => backend::markdown::markdown(&report::modal(answer, &wanted)),
        Format::Json => {
            let path = options.output.file.as_deref();
            return report_delivery(path, files::write_json(path, &backend::json::Modal { answer, options: &wanted }))
                .max(status);
        }
    };
    // An accuracy that was not reached, or a requirement that fails, is reported in addition to the answer.
    deliver(options.output.file.as_deref(), &text).max(status)
}

fn transfer(options: &Transfer, messages: &Messages) -> Status {
    let input = match open(&options.file, &options.overrides, options.output.file.iter().chain(&options.svg), messages)
    {
        Ok(input) => input,
        Err(status) => return status,
    };
    let outcome = vibc::dynamics(&input.sources, input.model, &input.overrides);
    let status = failure(outcome.failure());
    show(&input.sources, outcome.diagnostics, messages);
    let Some(dynamics) = outcome.answer else { return status };
    let (wanted, others): (Vec<_>, Vec<_>) = dynamics.rates().partition(|(name, _)| options.from.contains(name));
    let not_driven = |why: NotDriven| {
        match why {
            NotDriven::Because(name, why) => report_error(&format!("no transfer function from {name}: {why}")),
            NotDriven::Failed(error) => show(&input.sources, vec![*error], messages),
        }
        Status::Limit
    };
    let mut dynamics = match dynamics.with_rates(&wanted) {
        Ok(dynamics) => dynamics,
        Err(why) => return not_driven(why),
    };
    let system = &dynamics.system;
    let inputs: Vec<String> = system.inputs.iter().map(|input| system.display(input.name)).collect();
    let outputs: Vec<String> = system.outputs.iter().map(|output| system.display(output.name)).collect();
    let others: Vec<String> = others.into_iter().map(|(name, _)| name).collect();
    let chosen = indices_of("input", &options.from, &inputs, &others)
        .and_then(|i| Ok((i, indices_of("output", &options.to, &outputs, &[])?)));
    let (inputs, outputs) = match chosen {
        Ok(chosen) => chosen,
        Err(text) => {
            report_error(&text);
            return Status::Usage;
        }
    };
    let literals = options.overrides.literals;
    let sweep = Sweep {
        range: options.range.as_ref().map(|range| range.of_literals(literals).clone()),
        points: options.points.map(|points| points as usize),
        linear: options.linear,
        at: options.at.iter().map(|at| at.of_literals(literals).clone()).collect(),
        tolerance: options.tolerance,
        // The report shows extrema; files and figures hold the curve.
        features_only: matches!(options.format, TableFormat::Text | TableFormat::Markdown) && options.svg.is_none(),
        inputs,
        outputs,
    };
    if let Some(why) = dynamics.without_limit(&sweep) {
        return not_driven(why);
    }
    let around = analysis::table_around(&dynamics.system, &sweep);
    let table = match around {
        Ok(Some(table)) => table,
        Err(error) => {
            show(&input.sources, vec![error.to_diagnostic()], messages);
            return Status::Limit;
        }
        Ok(None) => match table_of_all(&mut dynamics, &sweep, &input.sources, messages) {
            Ok(table) => table,
            Err(status) => return status,
        },
    };
    show(&input.sources, dynamics.findings(&table, &sweep), messages);
    let system = &dynamics.system;
    let text = match options.format {
        TableFormat::Text => {
            let width = columns(&options.page, options.output.file.as_deref());
            backend::report::all_laid_out(&report::transfer(&dynamics.model, system, &table), width)
        }
        TableFormat::Markdown => backend::markdown::all(&report::transfer(&dynamics.model, system, &table)),
        TableFormat::Csv => backend::transfer::csv(system, &table),
        TableFormat::Json => backend::transfer::json(&dynamics.model, system, &table),
    };
    let picture = || backend::plot::transfer::plot(&dynamics.model, system, &table);
    let drawn = options.svg.as_deref().map_or(Status::Done, |path| deliver(Some(path), &picture()));
    drawn.max(deliver(options.output.file.as_deref(), &text))
}

/// A table for which all poles are computed, where there are not too many.
fn table_of_all(
    dynamics: &mut Dynamics,
    sweep: &Sweep,
    sources: &Sources,
    messages: &Messages,
) -> Result<Table, Status> {
    if dynamics.modes.is_none() && sweep.finds_extrema() {
        dynamics.modes = analysis::modes_of_many(&dynamics.system);
    }
    let system = &dynamics.system;
    let refused = |error: AnalysisError| {
        show(sources, vec![error.to_diagnostic()], messages);
        Status::Limit
    };
    let poles = dynamics.poles_for(sweep).map_err(refused)?;
    if poles.is_none() && sweep.range.is_none() {
        report_error(&match system.losses.is_some() {
            true => "the poles with these loss factors are not found: give the frequencies with `--range` or `--at`"
                .to_string(),
            false => {
                format!("the poles of {} coordinates are not computed: give the frequencies with `--range`", system.n())
            }
        });
        return Err(Status::Limit);
    }
    let no_modes = Modes::default();
    let modes = dynamics.modes.as_ref().filter(|_| poles.is_some()).unwrap_or(&no_modes);
    analysis::table(&Methods::of(system, modes), &poles.unwrap_or_default(), sweep).map_err(refused)
}

/// The indices of the requested names, or of all names.
/// `others`: names that could be asked for as well.
fn indices_of(what: &str, wanted: &[String], names: &[String], others: &[String]) -> Result<Vec<usize>, String> {
    if names.is_empty() {
        return Err(format!("the model declares no {what}"));
    }
    if wanted.is_empty() {
        return Ok((0..names.len()).collect());
    }
    let place = |name: &String| {
        let found = names.iter().position(|known| known == name);
        found.ok_or_else(|| {
            let known = first_names(&[names, others].concat());
            format!("`{}` is not an {what} of the model; it has {known}", diagnostics::readable(name))
        })
    };
    wanted.iter().map(place).collect()
}

/// The first few names.
fn first_names(names: &[String]) -> String {
    const MOST: usize = 8;
    let shown: Vec<String> = names.iter().take(MOST).map(|name| format!("`{name}`")).collect();
    let more = if names.len() > MOST { ", ..." } else { "" };
    shown.join(", ") + more
}

fn simulate(options: &Simulate, messages: &Messages) -> Status {
    let literals = options.overrides.literals;
    let (until, step) = (options.until.of_literals(literals), options.step.of_literals(literals));
    let samples = (until / step).to_f64();
    if samples > cli::MOST_SAMPLES {
        let count = match samples {
            ..1e15 => format!("{samples:.0}"),
            ..=f64::MAX => format!("{samples:.0e}"),
            _ => "more than 1e308".to_string(),
        };
        report_error(&format!("that would be {count} samples; the limit is {}", cli::MOST_SAMPLES));
        return Status::Usage;
    }
    let input = match open(&options.file, &options.overrides, options.output.file.iter().chain(&options.svg), messages)
    {
        Ok(input) => input,
        Err(status) => return status,
    };
    let times = analysis::grid(until, step);
    let outcome = vibc::simulate_with_noise(&input.sources, input.model, &input.overrides, &times, options.seed);
    let status = failure(outcome.failure());
    show(&input.sources, outcome.diagnostics, messages);
    let Some(motion) = &outcome.answer else { return status };
    if motion.system.outputs.is_empty() {
        report_error("the model declares no output");
        return Status::Usage;
    }
    if options.seed.is_some() && !motion.has_noise {
        report_error(
            "the model has no noise that `--seed` could add: write one, such as `noise(1 N^2/Hz, 1 Hz .. 20 Hz)`",
        );
        return Status::Usage;
    }
    let report = || report::motion(&motion.model, &motion.system, &motion.history, &motion.steady);
    let text = match options.format {
        TableFormat::Text => {
            backend::report::laid_out(&report(), columns(&options.page, options.output.file.as_deref()))
        }
        TableFormat::Markdown => backend::markdown::markdown(&report()),
        TableFormat::Csv => backend::simulation::csv(&motion.system, &motion.history, options.bounds),
        TableFormat::Json => backend::simulation::json(&motion.model, &motion.system, &motion.history, &motion.steady),
    };
    let picture = || backend::plot::motion::plot(&motion.model, &motion.system, &motion.history);
    let drawn = options.svg.as_deref().map_or(Status::Done, |path| deliver(Some(path), &picture()));
    deliver(options.output.file.as_deref(), &text).max(drawn).max(status)
}

fn shock(options: &Shock, messages: &Messages) -> Status {
    let input = match open(&options.file, &options.overrides, options.output.file.iter().chain(&options.svg), messages)
    {
        Ok(input) => input,
        Err(status) => return status,
    };
    let outcome = vibc::shock(&input.sources, input.model, &input.overrides, &options.from, &options.request());
    let status = failure(outcome.failure());
    show(&input.sources, outcome.diagnostics, messages);
    let shock = match &outcome.answer {
        None => return status,
        Some(Ok(shock)) => shock,
        Some(Err(reason)) => {
            report_error(reason);
            return Status::Usage;
        }
    };
    let text = match options.format {
        TableFormat::Text => {
            let width = columns(&options.page, options.output.file.as_deref());
            backend::report::all_laid_out(&report::shock(shock), width)
        }
        TableFormat::Markdown => backend::markdown::all(&report::shock(shock)),
        TableFormat::Csv => backend::shock::csv(shock),
        TableFormat::Json => backend::shock::json(shock),
    };
    let picture = || backend::plot::shock::plot(shock);
    let drawn = options.svg.as_deref().map_or(Status::Done, |path| deliver(Some(path), &picture()));
    deliver(options.output.file.as_deref(), &text).max(drawn).max(status)
}

fn draw(options: &Draw, messages: &Messages) -> Status {
    let input = match open(&options.file, &options.overrides, &options.output.file, messages) {
        Ok(input) => input,
        Err(status) => return status,
    };
    let drawn = vibc::FigureOptions { rest: options.rest, mode: options.mode, values: options.values };
    let outcome = vibc::draw(&input.sources, input.model, &input.overrides, &drawn);
    let status = failure(outcome.failure());
    show(&input.sources, outcome.diagnostics, messages);
    match &outcome.answer {
        None => status,
        Some(Ok(figure)) => {
            let text = backend::draw::svg(figure, &input.sources, input.model);
            deliver(options.output.file.as_deref(), &text).max(status)
        }
        Some(Err(reason)) => {
            report_error(reason);
            Status::Usage
        }
    }
}

fn page(options: &Report, messages: &Messages) -> Status {
    let input = match open(&options.file, &options.overrides, &options.output.file, messages) {
        Ok(input) => input,
        Err(status) => return status,
    };
    let until = options.measured.until(&options.overrides);
    let study = vibc::Study { until, sensitivity: options.sensitivity, ..vibc::Study::default() };
    let outcome = vibc::overview::overview(&input.sources, input.model, &input.overrides, &study);
    let status = failure(outcome.failure());
    show(&input.sources, outcome.diagnostics, messages);
    let Some(overview) = &outcome.answer else { return status };
    let page = overview.page((&input.sources, input.model), &vibc::overview::Shown::default());
    deliver(options.output.file.as_deref(), &page).max(status)
}

fn equations(options: &Equations, messages: &Messages) -> Status {
    let input = match open(&options.file, &options.overrides, &options.output.file, messages) {
        Ok(input) => input,
        Err(status) => return status,
    };
    let outcome = vibc::equations(&input.sources, input.model, &input.overrides);
    let status = failure(outcome.failure());
    show(&input.sources, outcome.diagnostics, messages);
    let Some(equations) = &outcome.answer else { return status };
    let document = backend::equations::document(equations);
    let text = match options.format {
        EquationsFormat::Text => {
            backend::equations::text(&document, columns(&options.page, options.output.file.as_deref()))
        }
        EquationsFormat::Latex => backend::equations::latex(&document),
        EquationsFormat::Typst => backend::equations::typst(&document),
        EquationsFormat::Mathml => backend::equations::mathml(&document),
        EquationsFormat::Json => backend::equations::json(equations, &document),
    };
    deliver(options.output.file.as_deref(), &text).max(status)
}

fn bench(options: &Bench, messages: &Messages) -> Status {
    let outputs = options.output.file.iter().chain(&options.svg);
    let input = match open(&options.file, &options.overrides, outputs, messages) {
        Ok(input) => input,
        Err(status) => return status,
    };
    let start = std::time::Instant::now();
    let mut clock = || start.elapsed().as_secs_f64();
    let outcome = vibc::bench(&input.sources, input.model, &input.overrides, &mut clock);
    let status = failure(outcome.failure());
    show(&input.sources, outcome.diagnostics, messages);
    let Some((model, found)) = &outcome.answer else { return status };
    let picture = || backend::bench::svg::svg(model, found);
    let drawn = options.svg.as_deref().map_or(Status::Done, |path| deliver(Some(path), &picture()));
    let text = match options.format {
        BenchFormat::Text => {
            let width = columns(&options.page, options.output.file.as_deref());
            backend::report::laid_out(&report::bench(model, found), width)
        }
        BenchFormat::Csv => backend::bench::csv(found),
        BenchFormat::Svg => picture(),
    };
    drawn.max(deliver(options.output.file.as_deref(), &text))
}

/// Writes a result, and reports errors.
fn deliver(output: Option<&Path>, text: &str) -> Status {
    report_delivery(output, write_result(output, text))
}

/// Reports a result that could not be written.
fn report_delivery(output: Option<&Path>, written: io::Result<()>) -> Status {
    match written {
        Ok(()) => Status::Done,
        Err(error) => {
            let name = output.unwrap_or(Path::new("standard output"));
            report_error(&format!("cannot write `{}`: {error}", name.display()));
            Status::Io
        }
    }
}

fn check(options: &Check, messages: &Messages) -> Status {
    let checked = options.files.iter().map(|file| match read_all(file, &options.overrides) {
        Ok(input) => {
            let until = options.measured.until(&options.overrides);
            let outcome = vibc::check(&input.sources, input.model, &input.overrides, until);
            let status = failure(outcome.failure());
            let stand = outcome.answer.map_or(String::new(), |list| {
                backend::report::requirements(
                    &input.sources.file(input.model).name,
                    &list,
                    columns(&options.page, None),
                )
            });
            show(&input.sources, outcome.diagnostics, messages);
            if stand.is_empty() { status } else { deliver(None, &stand).max(status) }
        }
        Err(unreadable) => unreadable.report(messages),
    });
    checked.max().unwrap_or(Status::Done)
}

fn format(options: &Fmt, messages: &Messages) -> Status {
    let formatted = options.files.iter().map(|file| match read(file, SourceKind::Model) {
        Ok(source) => format_one(file, source, options.check, messages),
        Err(unreadable) => unreadable.report(messages),
    });
    formatted.max().unwrap_or(Status::Done)
}

fn format_one(path: &Path, source: SourceFile, check: bool, messages: &Messages) -> Status {
    let mut sources = Sources::new();
    let model = sources.add(source);
    let outcome = vibc::format(&sources, model);
    show(&sources, outcome.diagnostics, messages);
    let Some(text) = outcome.answer else { return Status::Errors };
    let changed = text != sources.text(model);
    let stream = path == Path::new("-");
    match check {
        true if !changed => Status::Done,
        true => match write_result(None, &format!("{}\n", diagnostics::readable(&sources.file(model).name))) {
            Ok(()) => Status::Errors,
            Err(_) => Status::Io,
        },
        // A file that is already formatted keeps its modification time.
        false if !changed && !stream => Status::Done,
        false => deliver((!stream).then_some(path), &text),
    }
}

/// Serves an editor until it disconnects.
fn language_server() -> Status {
    // Room for the messages that arrive while a text goes through the stages; a client that sends more has to wait.
    let (incoming, receiver) = crossbeam_channel::bounded(64);
    let (sender, outgoing) = crossbeam_channel::unbounded();
    // Reading ends with `exit`, with the stream, or with the process.
    thread::spawn(move || transport::receive_all(&mut io::stdin().lock(), &incoming, || io::stdout().lock()));
    let writer = thread::spawn(move || transport::send_all(&outgoing, || io::stdout().lock()));
    let connection = lsp_server::Connection { sender, receiver };
    let folders = |folders: &[String]| folders.iter().map(PathBuf::from).collect::<Vec<_>>();
    let outside = "it lies outside the folder that is open";
    let read = |path: &str, below: &[String], what: Named| match what {
        Named::Table => files::Named::tables(folders(below), outside).read_keyed(Path::new(path)),
        Named::Components => files::Named::components(folders(below), outside).read_keyed(Path::new(path)),
    };
    let leave = server::serve(&connection, &read);
    // The writing thread ends with the last sender.
    drop(connection);
    match (leave, writer.join()) {
        // As the protocol requires.
        (Leave::Announced, Ok(Ok(()))) => Status::Done,
        (Leave::Unannounced, Ok(Ok(()))) => Status::Errors,
        _ => {
            report_error("cannot write to the editor");
            Status::Io
        }
    }
}

/// Prints a completion script for a shell.
fn completions(shell: clap_complete::Shell) -> Status {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "vibc", &mut script);
    deliver(None, &String::from_utf8_lossy(&script))
}

/// Prints a page for `man`, with the same text as `--help`.
fn manual_page(command: Option<&str>) -> Status {
    let mut program = Cli::command();
    program.build();
    let page = match command {
        None => program,
        Some(name) => match program.find_subcommand(name).filter(|command| !command.is_hide_set()) {
            // Its page is `vibc-analyze`, as in git.
            Some(command) => command.clone(),
            None => {
                report_error(&format!("there is no command `{}`", diagnostics::readable(name)));
                return Status::Usage;
            }
        },
    };
    let mut text = Vec::new();
    match clap_mangen::Man::new(page).render(&mut text) {
        Ok(()) => deliver(None, &String::from_utf8_lossy(&text)),
        Err(_) => Status::Io,
    }
}

/// The page of a diagnostic or of a word of the language; without an argument, all codes.
fn explain(asked: Option<&str>) -> Status {
    let Some(asked) = asked else { return deliver(None, &backend::explain::codes()) };
    let width = terminal_columns().map_or(backend::explain::WIDTH, |columns| columns.min(backend::explain::WIDTH));
    if let Some(page) = editor::meanings(asked) {
        return deliver(None, &backend::explain::terminal(&page, width));
    }
    match backend::explain::explain(asked, vibc::kinds::names(), width) {
        Ok(text) => deliver(None, &text),
        Err(unknown) => {
            let nearest = unknown.nearest.map_or(String::new(), |code| format!("; did you mean `{code}`?"));
            let asked = diagnostics::readable(asked);
            report_error(&format!("no diagnostic has the code `{asked}`, and it is no word of the language{nearest}"));
            Status::Usage
        }
    }
}

fn failure(failure: Option<vibc::Failure>) -> Status {
    match failure {
        None => Status::Done,
        Some(vibc::Failure::Model) => Status::Errors,
        Some(vibc::Failure::File) => Status::Io,
        Some(vibc::Failure::Limit) => Status::Limit,
    }
}
