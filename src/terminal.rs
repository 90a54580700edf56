//! Findings and errors on standard error, and the width and colours of the terminal. See
//! docs/cli.md#streams-and-exit-status.

use std::io::{self, IsTerminal, Write};
use std::path::Path;
use vibc::backend::{self, diagnostics};
use vibc::base::{Diagnostic, Sources};
use vibc::cli::{Colour, MessageFormat, Messages, Page};

/// Writes diagnostics to standard error.
pub fn show(sources: &Sources, mut findings: Vec<Diagnostic>, messages: &Messages) {
    findings.retain(|finding| !messages.quiet || finding.is_error());
    if findings.is_empty() {
        return;
    }
    let text = match messages.message_format {
        MessageFormat::Human => diagnostics::human(sources, &findings, style(messages.color)),
        MessageFormat::Json => diagnostics::json(sources, &findings),
        MessageFormat::Short => diagnostics::short(sources, &findings),
    };
    write_to(&mut io::stderr().lock(), &text);
}

fn style(colour: Colour) -> diagnostics::HumanStyle {
    let stream = io::stderr();
    let colour = match colour {
        Colour::Always => true,
        Colour::Never => false,
        // NO_COLOR, CLICOLOR, TERM, and whether it is a terminal at all.
        Colour::Auto => anstream::AutoStream::choice(&stream) != anstream::ColorChoice::Never,
    };
    diagnostics::HumanStyle { colour, ascii: stream.is_terminal() && !locale_is_unicode() }
}

/// Whether the locale is Unicode. A terminal with another encoding gets plain characters; files always get the same
/// bytes.
fn locale_is_unicode() -> bool {
    let named =
        ["LC_ALL", "LC_CTYPE", "LANG"].iter().find_map(|name| std::env::var(name).ok().filter(|v| !v.is_empty()));
    named.is_none_or(|name| name.to_ascii_lowercase().replace('-', "").contains("utf8"))
}

/// The width of a text report in columns: as requested, that of the terminal it is shown on, or that of a page.
pub fn columns(page: &Page, output: Option<&Path>) -> usize {
    let shown = output.is_none_or(|path| path == Path::new("-"));
    let asked = page.width.map(|width| width as usize);
    asked.or_else(|| terminal_columns().filter(|_| shown)).unwrap_or(backend::report::WIDTH)
}

/// The width of the terminal that standard output is, if it is one.
pub fn terminal_columns() -> Option<usize> {
    let (width, _) = terminal_size::terminal_size_of(io::stdout())?;
    // A window of a few columns is too narrow to read.
    Some(usize::from(width.0)).filter(|width| *width >= 40)
}

/// A failure to write to standard error cannot be reported anywhere.
pub fn write_to(stream: &mut impl Write, text: &str) {
    let _ = stream.write_all(text.as_bytes());
}

/// Writes an error as a single line, like errors of the command line, whatever file names and arguments it repeats.
pub fn report_error(text: &str) {
    write_to(&mut io::stderr().lock(), &format!("error: {}\n", diagnostics::readable(text)));
}

/// A panic is a defect of the program, whatever the input. Reports it, and asks for the data that help to fix it.
pub fn report_defect(panic: &std::panic::PanicHookInfo) {
    let version = env!("CARGO_PKG_VERSION");
    let text = format!(
        "error: a defect of vibc, not of the model: {panic}\n\
         Report it with the model, the command line and the version ({version}).\n"
    );
    write_to(&mut io::stderr().lock(), &text);
}
