//! The command line, as clap reads it. Clause: spec.md, "Report" 12.8.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;
use vibc::analysis::Normalise;

/// A compiler for mechanical vibrations: from a drawn scene to its modal report.
#[derive(Debug, Parser)]
#[command(name = "vibc", version, max_term_width = 100, arg_required_else_help = true)]
#[command(
    after_help = "Exit status: 0 done; 1 the model has errors; 2 the command line is wrong; 3 a file could not be \
                        read or written; 4 a numerical limit, such as no rest found.\n\
                        To come: transfer, simulate, emit, bench, fmt, lsp."
)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
    #[command(flatten)]
    pub messages: Messages,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// The modal report: rest and its stability, matrices, frequencies, shapes, damped poles
    Analyze(Analyze),
    /// Diagnostics, nothing else
    Check(Check),
    /// A diagnostic's long text: what it means, an example, the mend
    Explain(Explain),
    #[command(flatten)]
    Coming(Coming),
}

#[derive(Debug, Args)]
pub struct Analyze {
    /// The model; `-` reads standard input
    pub file: PathBuf,
    #[command(flatten)]
    pub overrides: OverrideOptions,
    /// What to print
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub format: Format,
    /// Write to this file instead of standard output; it is replaced whole or left as it was
    #[arg(short, long, value_name = "PATH")]
    pub output: Option<PathBuf>,
    /// What is 1 in a mode shape
    #[arg(long, value_enum, default_value_t = NormaliseOption::Translation)]
    pub normalise: NormaliseOption,
    /// Print M, C and K however large they are
    #[arg(long)]
    pub matrices: bool,
}

#[derive(Debug, Args)]
pub struct Check {
    /// The models; `-` reads standard input
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub overrides: OverrideOptions,
}

#[derive(Debug, Args)]
pub struct Explain {
    /// Such as `vib::unit::mismatch`
    pub code: String,
}

#[derive(Debug, Args)]
pub struct OverrideOptions {
    /// Give a parameter another value, as in `--set k=12N/m`; may be repeated
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting)]
    pub settings: Vec<String>,
    /// Take values of parameters from a TOML file: `k = "12 N/m"`
    #[arg(long = "settings", value_name = "FILE.toml")]
    pub settings_file: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct Messages {
    /// Colour diagnostics
    #[arg(long, value_enum, global = true, default_value_t = Colour::Auto, value_name = "WHEN")]
    pub color: Colour,
    /// How to print diagnostics
    #[arg(long, value_enum, global = true, default_value_t = MessageFormat::Human, value_name = "FORM")]
    pub message_format: MessageFormat,
    /// Leave out warnings and notes
    #[arg(short, long, global = true)]
    pub quiet: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    Text,
    Json,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Colour {
    /// On a terminal, unless NO_COLOR is set
    Auto,
    Always,
    Never,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MessageFormat {
    /// With the lines of the model drawn around each place
    Human,
    /// One JSON object a line
    Json,
    /// `file:line:column: severity[code]: message`
    Short,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum NormaliseOption {
    /// The largest translation; the largest rotation where nothing translates
    Translation,
    /// The largest entry
    Max,
    /// The first entry
    First,
    /// shape^T M shape
    Mass,
}

impl From<NormaliseOption> for Normalise {
    fn from(option: NormaliseOption) -> Normalise {
        match option {
            NormaliseOption::Translation => Normalise::Translation,
            NormaliseOption::Max => Normalise::Max,
            NormaliseOption::First => Normalise::First,
            NormaliseOption::Mass => Normalise::Mass,
        }
    }
}

/// Commands that are announced and refused by name.
#[derive(Debug, Subcommand)]
pub enum Coming {
    #[command(hide = true, disable_help_flag = true)]
    Transfer(Anything),
    #[command(hide = true, disable_help_flag = true)]
    Simulate(Anything),
    #[command(hide = true, disable_help_flag = true)]
    Emit(Anything),
    #[command(hide = true, disable_help_flag = true)]
    Bench(Anything),
    #[command(hide = true, disable_help_flag = true)]
    Fmt(Anything),
    #[command(hide = true, disable_help_flag = true)]
    Lsp(Anything),
}

/// Whatever follows a command that is to come.
#[derive(Debug, Args)]
pub struct Anything {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    pub rest: Vec<std::ffi::OsString>,
}

impl Coming {
    pub fn name(&self) -> &'static str {
        match self {
            Coming::Transfer(_) => "transfer",
            Coming::Simulate(_) => "simulate",
            Coming::Emit(_) => "emit",
            Coming::Bench(_) => "bench",
            Coming::Fmt(_) => "fmt",
            Coming::Lsp(_) => "lsp",
        }
    }
}

/// `NAME=VALUE` in one line; the model's own check judges the rest.
fn setting(text: &str) -> Result<String, String> {
    match text.split_once('=') {
        _ if text.contains(['\n', '\r']) => Err("it must be one line".into()),
        Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => Ok(text.into()),
        _ => Err("write NAME=VALUE, such as k=12N/m".into()),
    }
}
