//! The command line, as clap reads it. See docs/cli.md#streams-and-exit-status.

use crate::analysis::discrete::Precision;
use crate::analysis::shock;
use crate::analysis::{Band, Frequency, Normalise, Request, Which};
use crate::backend::explain::PAGES;
use crate::base::unit::{self, Scale};
use crate::base::{Angle, Dimension, Literals, Number, Rational};
use crate::kinds;
use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use clap::{ArgMatches, Args, FromArgMatches, Parser, Subcommand, ValueEnum};
use std::ffi::OsStr;
use std::ops::RangeInclusive;
use std::path::PathBuf;

/// A compiler for mechanical vibrations: from a drawn scene to its modal report.
#[derive(Debug, Parser)]
#[command(name = "vibc", version, max_term_width = 100, arg_required_else_help = true)]
#[command(
    after_help = "Exit status: 0 done; 1 the model has errors, or a requirement fails; 2 the command line is wrong; 3 a file could not be \
                        read or written; 4 a numerical limit, such as no rest found."
)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
    #[command(flatten)]
    pub messages: Messages,
}

/// The commands, each with its line in the list of `--help`. Its options are described to clap only if it is the command
/// that runs: describing those of all commands takes longer than reading and checking a small model.
macro_rules! commands {
    ($(#[doc = $about:literal] $name:ident = $word:literal,)*) => {
        #[derive(Debug)]
        pub enum Command {
            $(#[doc = $about] $name($name),)*
        }

        impl Subcommand for Command {
            fn augment_subcommands(program: clap::Command) -> clap::Command {
                program$(.subcommand(command($word, $about, <$name as Args>::augment_args)))*
            }

            fn augment_subcommands_for_update(program: clap::Command) -> clap::Command {
                program$(.subcommand(command($word, $about, <$name as Args>::augment_args_for_update)))*
            }

            fn has_subcommand(name: &str) -> bool {
                [$($word),*].contains(&name)
            }
        }

        impl FromArgMatches for Command {
            fn from_arg_matches(matches: &ArgMatches) -> Result<Command, clap::Error> {
                Command::from_arg_matches_mut(&mut matches.clone())
            }

            fn from_arg_matches_mut(matches: &mut ArgMatches) -> Result<Command, clap::Error> {
                let (word, mut given) = matches.remove_subcommand().unwrap_or_default();
                match word.as_str() {
                    $($word => Ok(Command::$name($name::from_arg_matches_mut(&mut given)?)),)*
                    // clap has refused such command lines already.
                    _ => Err(clap::Error::new(clap::error::ErrorKind::MissingSubcommand)),
                }
            }

            fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
                *self = Command::from_arg_matches(matches)?;
                Ok(())
            }
        }
    };
}

/// A command that is described to clap when it is the one that runs.
fn command(name: &'static str, about: &'static str, options: fn(clap::Command) -> clap::Command) -> clap::Command {
    clap::Command::new(name).about(about.trim_start()).defer(options)
}

commands! {
    /// Print the modal report: rest and its stability, matrices, frequencies, mode shapes, damped poles
    Analyze = "analyze",
    /// Compute transfer functions between inputs and outputs: peaks, gain and phase over frequency
    Transfer = "transfer",
    /// Compute the time response under the model's signals and from its initial state
    Simulate = "simulate",
    /// Compute shock response spectra: the largest motions of single oscillators on a base that moves as its signal says
    Shock = "shock",
    /// Compute the model at many values of its parameters: frequencies, poles, requirements and measures of every case
    Sweep = "sweep",
    /// Join the parts of a sweep that `--shard` divided: the file that one run would have written
    Merge = "merge",
    /// Draw the scene as a textbook figure, in SVG: as drawn, at rest, or in a mode
    Draw = "draw",
    /// Write a page with everything: the figure in motion, tables, curves, the text; one HTML file that needs no network
    Report = "report",
    /// Serve the report to browsers on this machine, fresh after each save
    Watch = "watch",
    /// Emit simulation code: the exact discrete system in C99 or Rust
    Emit = "emit",
    /// Print the equations of motion in the model's own symbols, from its energies
    Equations = "equations",
    /// Check models: diagnostics, and whether the requirements hold
    Check = "check",
    /// Format model files
    Fmt = "fmt",
    /// Run the language server on standard input and output; editors start it
    Lsp = "lsp",
    /// Explain a diagnostic or a keyword: what it means, an example, how to fix it
    Explain = "explain",
    /// Print a script that completes commands and options in a shell
    Completions = "completions",
    /// Print the manual page of the program, or of one of its commands
    Man = "man",
    /// Compare speed and error: every method for each answer, its time, its true error and its bound
    Bench = "bench",
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
    #[command(flatten)]
    pub page: Page,
    #[command(flatten)]
    pub output: Output,
    /// How mode shapes are scaled: what is 1
    #[arg(long, value_enum, default_value_t = NormaliseOption::Translation)]
    pub normalise: NormaliseOption,
    /// Which entries of the shapes are printed
    #[arg(long, value_enum, default_value_t = ShapesOption::Largest)]
    pub shapes: ShapesOption,
    /// Print M, C and K even if they are large
    #[arg(long)]
    pub matrices: bool,
    /// Explain what was kept of the model, what was left out, and why
    #[arg(long)]
    pub explain_model: bool,
    /// Compute the N lowest modes [default: all, or 20 for large models]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole(1..=100_000))]
    pub modes: Option<u32>,
    /// Compute the modes with frequencies in this band, such as 10Hz..50Hz
    #[arg(long, value_name = "FROM..TO", allow_hyphen_values = true, value_parser = range, conflicts_with = "modes")]
    pub band: Option<Readings<(Number, Number)>>,
    /// Print up to N digits of frequencies and poles, as far as they are certain; at most 30
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole(1..=32))]
    pub digits: Option<u32>,
    /// The proved relative error that every frequency and pole must reach, such as 1e-14; exit status 4 if one does not
    #[arg(long, value_name = "ERROR", allow_hyphen_values = true, value_parser = tolerance)]
    pub tolerance: Option<f64>,
    /// Print the derivatives of frequencies and damping ratios with respect to each parameter
    #[arg(long)]
    pub sensitivity: bool,
    /// Print the range of each frequency over all values within the tolerances (`within`), and whether each requirement holds everywhere
    #[arg(long)]
    pub tolerances: bool,
    /// Let `minimise` and `maximise` find the values whose worst case within the tolerances is best
    #[arg(long)]
    pub robust: bool,
    /// Print participation factors and effective masses of the modes for each motion of a base
    #[arg(long)]
    pub participation: bool,
    /// Add the missing mass to the maxima under response spectra: the modes above a spectrum's highest point
    #[arg(long)]
    pub missing_mass: bool,
    /// Combine the maxima under the response spectra of several directions by SRSS, too
    #[arg(long)]
    pub across_directions: bool,
    /// Correct response spectra for modes with another damping ratio, by the factor of EN 1998-1
    #[arg(long)]
    pub other_damping: bool,
    #[command(flatten)]
    pub measured: MeasureOptions,
}

impl Analyze {
    /// The request to the analysis.
    pub fn request(&self) -> Request {
        let omega = |frequency: &Number| (&(frequency * &Number::from(2)) * &Number::pi()).to_f64();
        let which = match (self.modes, &self.band) {
            (Some(count), _) => Which::Lowest(count as usize),
            (None, Some(band)) => {
                let (from, to) = band.of_literals(self.overrides.literals);
                Which::Within(Band { from: omega(from), to: omega(to) })
            }
            (None, None) => Which::Usual,
        };
        let request = Request { which, ..Request::default() };
        let request = self.tolerance.map_or(request, |tolerance| request.within(tolerance));
        self.digits.map_or(request, |digits| request.to_digits(digits))
    }
}

#[derive(Debug, Args)]
pub struct Transfer {
    /// The model; `-` reads standard input
    pub file: PathBuf,
    #[command(flatten)]
    pub overrides: OverrideOptions,
    /// The input, by its name in the model; `quake.vx` and `quake.ax` are the velocity and the acceleration of a base [default: every input]
    #[arg(long, value_name = "INPUT")]
    pub from: Vec<String>,
    /// The output, by its name in the model [default: every output]
    #[arg(long, value_name = "OUTPUT")]
    pub to: Vec<String>,
    /// The frequencies to cover, such as 0.1Hz..100Hz [default: from the poles]
    #[arg(long, value_name = "FROM..TO", allow_hyphen_values = true, value_parser = range)]
    pub range: Option<Readings<(Number, Number)>>,
    /// The number of evenly spaced frequencies [default: a grid refined at every peak and antiresonance]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole(1..=1_000_000))]
    pub points: Option<u32>,
    /// Space the frequencies evenly instead of their logarithms
    #[arg(long)]
    pub linear: bool,
    /// A single frequency, such as 30Hz; may be repeated
    #[arg(long, value_name = "FREQUENCY", allow_hyphen_values = true, value_parser = frequency, conflicts_with_all = ["range", "points", "linear"])]
    pub at: Vec<Readings<Frequency>>,
    /// An acceptable relative error, such as 1e-12 [default: every digit of a double]
    #[arg(long, value_name = "ERROR", allow_hyphen_values = true, value_parser = tolerance)]
    pub tolerance: Option<f64>,
    /// What to print
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    pub format: TableFormat,
    /// Write a Bode plot to this file too: gain and phase, peaks and antiresonances marked
    #[arg(long, value_name = "PATH")]
    pub svg: Option<PathBuf>,
    #[command(flatten)]
    pub page: Page,
    #[command(flatten)]
    pub output: Output,
}

#[derive(Debug, Args)]
pub struct Simulate {
    /// The model; `-` reads standard input
    pub file: PathBuf,
    #[command(flatten)]
    pub overrides: OverrideOptions,
    /// The time of the last sample, such as 10s
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = time)]
    pub until: Readings<Number>,
    /// The time between samples, such as 1ms
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = time)]
    pub step: Readings<Number>,
    /// Add the motion under a realisation of the model's noise: another one for each number
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true, value_parser = seed)]
    pub seed: Option<u64>,
    /// Add a column NAME_bound after each column of the CSV: the error bound of each sample
    #[arg(long)]
    pub bounds: bool,
    /// What to print
    #[arg(long, value_enum, default_value_t = TableFormat::Csv)]
    pub format: TableFormat,
    #[command(flatten)]
    pub page: Page,
    /// Write a plot of the outputs over time to this file too
    #[arg(long, value_name = "PATH")]
    pub svg: Option<PathBuf>,
    #[command(flatten)]
    pub output: Output,
}

#[derive(Debug, Args)]
pub struct Shock {
    /// The model; `-` reads standard input
    pub file: PathBuf,
    /// The unit of a damping ratio that is written as in a model, with a blank: `--damping 5 %`
    #[arg(hide = true, value_parser = ["%"], requires = "damping")]
    pub percent: Option<String>,
    #[command(flatten)]
    pub overrides: OverrideOptions,
    /// The base, by its name in the model [default: every base with a signal]
    #[arg(long, value_name = "BASE")]
    pub from: Vec<String>,
    /// The damping ratio of the oscillators, such as 5% or 0.05
    #[arg(long, value_name = "RATIO", allow_hyphen_values = true, value_parser = ratio, default_value = "5%")]
    pub damping: Readings<Number>,
    /// The frequencies of the oscillators, such as 0.1Hz..50Hz
    #[arg(long, value_name = "FROM..TO", allow_hyphen_values = true, value_parser = range, required_unless_present = "at")]
    pub range: Option<Readings<(Number, Number)>>,
    /// The number of frequencies, evenly spaced in their logarithms
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole(1..=100_000), default_value_t = 200)]
    pub points: u32,
    /// Space the frequencies evenly instead of their logarithms
    #[arg(long)]
    pub linear: bool,
    /// A single frequency, such as 30Hz; may be repeated
    #[arg(long, value_name = "FREQUENCY", allow_hyphen_values = true, value_parser = frequency, conflicts_with_all = ["range", "points", "linear"])]
    pub at: Vec<Readings<Frequency>>,
    /// What is measured of the oscillators
    #[arg(long, value_enum, default_value_t = QuantityOption::PseudoAcceleration)]
    pub quantity: QuantityOption,
    /// What to print
    #[arg(long, value_enum, default_value_t = TableFormat::Text)]
    pub format: TableFormat,
    /// Write a plot of the spectra to this file too
    #[arg(long, value_name = "PATH")]
    pub svg: Option<PathBuf>,
    #[command(flatten)]
    pub page: Page,
    #[command(flatten)]
    pub output: Output,
}

impl Shock {
    /// The request to the analysis.
    pub fn request(&self) -> shock::Request {
        let literals = self.overrides.literals;
        let damping = self.damping.of_literals(literals);
        let grid = match &self.range {
            Some(range) => shock::Grid::Range {
                ends: range.of_literals(literals).clone(),
                points: self.points as usize,
                linear: self.linear,
            },
            None => shock::Grid::At(self.at.iter().map(|at| at.of_literals(literals).hertz.clone()).collect()),
        };
        let damping = if self.percent.is_some() { damping / &Number::from(100) } else { damping.clone() };
        shock::Request { quantity: self.quantity.into(), damping, grid }
    }
}

#[derive(Debug, Args)]
#[command(group(clap::ArgGroup::new("values").required(true)))]
pub struct Sweep {
    /// The model; `-` reads standard input
    pub file: PathBuf,
    #[command(flatten)]
    pub overrides: OverrideOptions,
    /// Values of a parameter: `k=5N/m..50N/m:200` for 200 at equal distances, `m=0.1kg,0.5kg,1kg` for these; may be repeated, then every combination is a case
    #[arg(long, value_name = "NAME=VALUES", value_parser = parse_swept, group = "values")]
    pub over: Vec<String>,
    /// So many cases with random values of the parameters that have `spread` or `within`
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole(1..=1_000_000_000), group = "values")]
    pub samples: Option<u32>,
    /// The seed of the random values [default: 0]
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true, value_parser = seed, conflicts_with = "over")]
    pub seed: Option<u64>,
    /// Values that fill their ranges evenly: 16 scrambled Sobol sequences in turn, which need far fewer cases
    #[arg(long, conflicts_with = "over")]
    pub sobol: bool,
    /// A measure as in a model, such as 'gain(F -> x, 3 Hz)'; may be repeated
    #[arg(long, value_name = "MEASURE", value_parser = measure)]
    pub measure: Vec<String>,
    /// The frequencies of the N lowest modes [default: 6 if nothing else is asked for, otherwise none]
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole(1..=1000))]
    pub modes: Option<u32>,
    /// Follow the modes as curves that keep their identity, and tell where they veer or cross; for one `--over`
    #[arg(long)]
    pub follow: bool,
    /// With `--follow` over a rate of rotation: where the curves have these multiples of it, as in a Campbell diagram
    #[arg(long, value_name = "N,N", value_delimiter = ',', allow_hyphen_values = true, value_parser = whole(1..=1000), requires = "follow")]
    pub orders: Vec<u32>,
    /// Write a plot of the followed curves to this file too
    #[arg(long, value_name = "PATH", requires = "follow")]
    pub svg: Option<PathBuf>,
    /// The damped poles
    #[arg(long)]
    pub poles: bool,
    /// A relative error bound that is good enough for frequencies, such as 1e-14 [default: 1e-10]
    #[arg(long, value_name = "ERROR", allow_hyphen_values = true, value_parser = tolerance)]
    pub tolerance: Option<f64>,
    /// Keep parameters that the model determines (`solve`, `minimise`) at their values for the model as declared
    #[arg(long)]
    pub hold_solved: bool,
    #[command(flatten)]
    pub measured: MeasureOptions,
    /// Compute the cases k with k mod N = I, as a part for `vibc merge`; `auto` or `auto/N` takes I from the job array of Slurm, Kubernetes or HyperQueue
    #[arg(long, value_name = "I/N", value_parser = shard, requires = "output")]
    pub shard: Option<ShardOption>,
    /// What to print: the ranges as text, or every case
    #[arg(long, value_enum, default_value_t = SweepFormat::Text)]
    pub format: SweepFormat,
    #[command(flatten)]
    pub page: Page,
    #[command(flatten)]
    pub output: Output,
}

#[derive(Debug, Args)]
pub struct Merge {
    /// The parts, each once, in any order
    #[arg(required = true, value_name = "PART")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub output: Output,
}

/// One of the parts that a study is divided into: the cases k with k mod count = index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    pub index: u64,
    pub count: u64,
}

impl Shard {
    pub const WHOLE: Shard = Shard { index: 0, count: 1 };

    /// The number of its cases, and of all cases.
    pub fn rows(self, cases: u64) -> u64 {
        cases / self.count + u64::from(self.index < cases % self.count)
    }

    /// The number of its case with this index.
    pub fn case(self, index: u64) -> u64 {
        self.index + index * self.count
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShardOption {
    Given(Shard),
    /// The index is a variable of a job array, and so is the number of parts if it is not given.
    Auto(Option<u64>),
}

/// The most orders of a rate of rotation that are compared with curves.
pub const MOST_ORDERS: usize = 20;

/// The most parts of a study.
pub const MOST_SHARDS: u64 = 10_000;

/// `3/64`, `auto` or `auto/64`
fn shard(text: &str) -> Result<ShardOption, String> {
    let (index, count) = match text.split_once('/') {
        None if text == "auto" => return Ok(ShardOption::Auto(None)),
        None => return Err("write I/N, such as 3/64 for the fourth of 64 parts, or auto".into()),
        Some((index, count)) => (index, count),
    };
    let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit()).then(|| text.parse::<u64>().ok())?;
    let count = digits(count).filter(|count| (1..=MOST_SHARDS).contains(count));
    let count = count.ok_or(format!("the number of parts lies between 1 and {MOST_SHARDS}"))?;
    match digits(index).filter(|index| *index < count) {
        Some(index) => Ok(ShardOption::Given(Shard { index, count })),
        None if index == "auto" => Ok(ShardOption::Auto(Some(count))),
        None => Err(format!("parts are counted from 0 to {}", count - 1)),
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SweepFormat {
    Text,
    Csv,
    Json,
    /// Arrays for NumPy, as a file (`-o`)
    Npz,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum QuantityOption {
    /// omega^2 times the motion relative to the base: the acceleration of the mass if there is no damping
    PseudoAcceleration,
    /// The motion relative to the base
    RelativeDisplacement,
}

impl From<QuantityOption> for shock::Quantity {
    fn from(option: QuantityOption) -> shock::Quantity {
        match option {
            QuantityOption::PseudoAcceleration => shock::Quantity::PseudoAcceleration,
            QuantityOption::RelativeDisplacement => shock::Quantity::RelativeDisplacement,
        }
    }
}

#[derive(Debug, Args)]
pub struct Draw {
    /// The model; `-` reads standard input
    pub file: PathBuf,
    #[command(flatten)]
    pub overrides: OverrideOptions,
    /// Draw the scene at rest instead of as drawn
    #[arg(long, conflicts_with = "mode")]
    pub rest: bool,
    /// Draw the shape of this mode over the rest, counted from 1
    #[arg(long, value_name = "N", allow_hyphen_values = true, value_parser = whole(1..=100_000))]
    pub mode: Option<u32>,
    /// Write values beside names, such as k = 10 N/m
    #[arg(long)]
    pub values: bool,
    #[command(flatten)]
    pub output: Output,
}

#[derive(Debug, Args)]
pub struct Emit {
    /// The model; `-` reads standard input
    pub file: PathBuf,
    #[command(flatten)]
    pub overrides: OverrideOptions,
    /// The language
    #[arg(long, value_enum)]
    pub target: TargetOption,
    /// The time between steps, such as 1ms
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = time, default_value = "1ms")]
    pub step: Readings<Number>,
    /// Leave out modes that add less than this share to every output under harmonic inputs, such as 1e-6; their static part stays
    #[arg(long, value_name = "SHARE", allow_hyphen_values = true, value_parser = tolerance)]
    pub tolerance: Option<f64>,
    /// The type of numbers in the code
    #[arg(long, value_enum, default_value_t = PrecisionOption::F64)]
    pub precision: PrecisionOption,
    /// How inputs vary between samples: held, or interpolated linearly
    #[arg(long, value_enum, default_value_t = HoldOption::Zero)]
    pub hold: HoldOption,
    /// What the code does: exact steps, or the right-hand side of the equations for your own integrator
    #[arg(long, value_enum, default_value_t = StyleOption::Steps)]
    pub style: StyleOption,
    /// Keep this parameter changeable at run time (small models)
    #[arg(long, value_name = "NAME", conflicts_with_all = ["program", "tolerance", "style", "signals", "hold"])]
    pub parameter: Option<String>,
    /// Which signals are built in: none, or those that the model declares
    #[arg(long, value_enum, default_value_t = SignalsOption::External)]
    pub signals: SignalsOption,
    /// Add a program that prints the CSV of `vibc simulate`, with the model's signals built in
    #[arg(long, requires = "until", requires = "output")]
    pub program: bool,
    /// The time of the program's last sample, such as 10s
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = time, requires = "program")]
    pub until: Option<Readings<Number>>,
    /// Write NAME.c and NAME.h, or NAME.rs, into this directory instead of to standard output
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TargetOption {
    Rust,
    C,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum StyleOption {
    Steps,
    Equations,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SignalsOption {
    /// Every input is an argument of each step
    External,
    /// Inputs with signals are computed inside; only the others are arguments
    Internal,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PrecisionOption {
    F64,
    F32,
}

impl From<PrecisionOption> for Precision {
    fn from(option: PrecisionOption) -> Precision {
        match option {
            PrecisionOption::F64 => Precision::Double,
            PrecisionOption::F32 => Precision::Single,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum HoldOption {
    Zero,
    First,
}

#[derive(Debug, Args)]
pub struct Bench {
    /// The model; `-` reads standard input
    pub file: PathBuf,
    #[command(flatten)]
    pub overrides: OverrideOptions,
    /// What to print
    #[arg(long, value_enum, default_value_t = BenchFormat::Text)]
    pub format: BenchFormat,
    /// Write the plot to this file too
    #[arg(long, value_name = "PATH")]
    pub svg: Option<PathBuf>,
    #[command(flatten)]
    pub page: Page,
    #[command(flatten)]
    pub output: Output,
}

#[derive(Debug, Args)]
pub struct Report {
    /// The model; `-` reads standard input
    pub file: PathBuf,
    #[command(flatten)]
    pub overrides: OverrideOptions,
    #[command(flatten)]
    pub measured: MeasureOptions,
    /// With the derivatives of frequencies and damping ratios by each parameter
    #[arg(long)]
    pub sensitivity: bool,
    #[command(flatten)]
    pub output: Output,
}

#[derive(Debug, Args)]
pub struct Watch {
    /// The model
    pub file: PathBuf,
    #[command(flatten)]
    pub overrides: OverrideOptions,
    #[command(flatten)]
    pub measured: MeasureOptions,
    /// The port on 127.0.0.1 [default: a free one]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub port: u16,
}

#[derive(Debug, Args)]
pub struct Equations {
    /// The model; `-` reads standard input
    pub file: PathBuf,
    #[command(flatten)]
    pub overrides: OverrideOptions,
    /// What to print
    #[arg(long, value_enum, default_value_t = EquationsFormat::Text)]
    pub format: EquationsFormat,
    #[command(flatten)]
    pub page: Page,
    #[command(flatten)]
    pub output: Output,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EquationsFormat {
    Text,
    /// A document for `article` with amsmath
    Latex,
    /// A Typst document
    Typst,
    /// A page with MathML
    Mathml,
    Json,
}

#[derive(Debug, Args)]
pub struct Check {
    /// The models; `-` reads standard input
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub page: Page,
    #[command(flatten)]
    pub overrides: OverrideOptions,
    #[command(flatten)]
    pub measured: MeasureOptions,
}

#[derive(Debug, Args)]
pub struct MeasureOptions {
    /// The simulated time of `peak` and `rms`, such as 10s [default: from the poles and signals]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = time)]
    pub until: Option<Readings<Number>>,
}

impl MeasureOptions {
    /// The time, as its number is read beside the model.
    pub fn until(&self, overrides: &OverrideOptions) -> Option<&Number> {
        self.until.as_ref().map(|until| until.of_literals(overrides.literals))
    }
}

#[derive(Debug, Args)]
pub struct Fmt {
    /// The models, formatted in place; `-` reads standard input and writes standard output
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Change nothing; print the names of files that are not formatted, and exit with status 1 if there are any
    #[arg(long)]
    pub check: bool,
}

#[derive(Debug, Args)]
pub struct Lsp {
    /// Accepted because editors pass it; there is no other transport
    #[arg(long, hide = true)]
    pub stdio: bool,
}

#[derive(Debug, Args)]
pub struct Completions {
    /// The shell that reads the script
    #[arg(value_enum)]
    pub shell: clap_complete::Shell,
}

#[derive(Debug, Args)]
pub struct Man {
    /// A command, such as `analyze`
    #[arg(value_parser = AnyText(commands), hide_possible_values = true)]
    pub command: Option<String>,
}

#[derive(Debug, Args)]
pub struct Explain {
    /// A code such as `vib::unit::mismatch`, or a word such as `spring` or `mm`; without it, all codes are listed
    #[arg(value_name = "CODE", value_parser = AnyText(subjects), hide_possible_values = true)]
    pub subject: Option<String>,
}

/// The commands that have a manual page.
fn commands() -> Vec<&'static str> {
    let program = Command::augment_subcommands(clap::Command::new("vibc"));
    // clap takes names of the program's whole life; these few are made once, for a script or an error.
    program.get_subcommands().map(|command| &*String::from(command.get_name()).leak()).collect()
}

/// The topics that can be explained: codes and words of the language.
fn subjects() -> Vec<&'static str> {
    let mut subjects: Vec<&'static str> = PAGES.iter().map(|page| page.code).chain(kinds::names()).collect();
    subjects.sort_unstable();
    subjects.dedup();
    subjects
}

/// Takes any text, and gives shells words to complete.
#[derive(Clone, Debug)]
struct AnyText(fn() -> Vec<&'static str>);

impl TypedValueParser for AnyText {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        arg: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, arg, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new((self.0)().into_iter().map(PossibleValue::new)))
    }
}

#[derive(Debug, Args)]
pub struct OverrideOptions {
    /// Give a parameter another value, as in `--set k=12N/m`; may be repeated
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = setting)]
    pub settings: Vec<String>,
    /// Take values of parameters from a TOML file: `k = "12 N/m"`
    #[arg(long = "settings", value_name = "FILE.toml")]
    pub settings_file: Option<PathBuf>,
    /// Also read tables below this folder, not only below the model's own
    #[arg(long, value_name = "DIR")]
    pub root: Option<PathBuf>,
    /// How to read a literal such as 9.81
    #[arg(long, value_enum, default_value_t = LiteralsOption::Decimal, value_name = "READING")]
    pub literals: LiteralsOption,
}

#[derive(Debug, Args)]
pub struct Output {
    /// Write to this file instead of standard output; it is replaced completely or not at all
    #[arg(id = "output", short, long = "output", value_name = "PATH")]
    pub file: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct Page {
    /// Width of text reports in columns [default: that of the terminal, or 100]
    #[arg(long, value_name = "COLUMNS", allow_hyphen_values = true, value_parser = whole(20..=10_000))]
    pub width: Option<u32>,
}

#[derive(Debug, Args)]
pub struct Messages {
    /// Colour diagnostics
    #[arg(long, value_enum, global = true, default_value_t = Colour::Auto, value_name = "WHEN")]
    pub color: Colour,
    /// How to print diagnostics
    #[arg(long, value_enum, global = true, default_value_t = MessageFormat::Human, value_name = "FORM")]
    pub message_format: MessageFormat,
    /// Do not print warnings and notes
    #[arg(short, long, global = true)]
    pub quiet: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    Text,
    Json,
    /// The text report for pages and notes
    Markdown,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TableFormat {
    Text,
    Csv,
    Json,
    /// The text report for pages and notes
    Markdown,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BenchFormat {
    Text,
    Csv,
    /// The work-precision plot
    Svg,
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
    /// With the lines of the model around each place
    Human,
    /// One JSON object per line
    Json,
    /// `file:line:column: severity[code]: message`
    Short,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LiteralsOption {
    /// The decimal fraction that it shows
    Decimal,
    /// The nearest binary64 number, as most programs read it
    Binary64,
}

impl From<LiteralsOption> for Literals {
    fn from(option: LiteralsOption) -> Literals {
        match option {
            LiteralsOption::Decimal => Literals::Decimal,
            LiteralsOption::Binary64 => Literals::Binary64,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ShapesOption {
    /// The largest ones, or all of up to 10 coordinates
    Largest,
    /// All, with a row for each coordinate
    All,
    /// Those of damped motions, complex: magnitude and phase of each coordinate and output
    Damped,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum NormaliseOption {
    /// The largest translation, or the largest rotation if nothing translates
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

/// `NAME=VALUE` in one line; the model's own check judges the rest.
fn setting(text: &str) -> Result<String, String> {
    match text.split_once('=') {
        _ if text.contains(['\n', '\r']) => Err("it must be one line".into()),
        Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => Ok(text.into()),
        _ => Err("write NAME=VALUE, such as k=12N/m".into()),
    }
}

/// `NAME=VALUES` in one line, of a form that the model's check reads.
fn parse_swept(text: &str) -> Result<String, String> {
    let (name, values) =
        setting(text).ok().and_then(|_| text.split_once('=')).ok_or("write k=5N/m..50N/m:200 or k=5N/m,10N/m")?;
    match crate::model::shape_of_values(values) {
        Ok(_) if !name.trim().is_empty() => Ok(text.into()),
        Ok(_) => Err("write the name of a parameter first: k=5N/m..50N/m:200".into()),
        Err(help) => Err(help.into()),
    }
}

/// A measure in one line; the model's own check judges the rest.
fn measure(text: &str) -> Result<String, String> {
    let is_line = !text.trim().is_empty() && !text.contains(['\n', '\r']);
    if is_line { Ok(text.trim().into()) } else { Err("write a measure in one line, such as 'frequency(1)'".into()) }
}

pub use crate::analysis::MOST_SAMPLES;

/// The most cases of a run.
pub const MOST_CASES: u64 = 1_000_000_000;

/// A program that is emitted prints them as it goes.
pub const MOST_PROGRAM_SAMPLES: f64 = 4e9;

/// `30Hz`, as in a model without spaces: the value in SI, and how its angle was written. `example`: what to type.
fn quantity(text: &str, dimension: Dimension, literals: Literals, example: &str) -> Result<(Number, Angle), String> {
    if text.starts_with('-') && quantity(&text[1..], dimension, literals, example).is_ok() {
        return Err(format!("it must not be negative: write {example}"));
    }
    // A number may end in an exponent, so the longest one that reads is meant.
    let split = (1..=text.len()).rev().filter(|&at| text.is_char_boundary(at));
    let read = split
        .filter_map(|at| Rational::from_literal(&text[..at], literals).map(|value| (Number::from(value), &text[at..])));
    let Some((value, rest)) = read.take(1).next() else {
        return Err(format!("it does not begin with a number: write {example}"));
    };
    if rest.starts_with(|c: char| c.is_ascii_digit()) {
        // `1e-398Hz`: what reads as `1e-39` is not the number that is written.
        return Err("its number is outside the range of binary64".into());
    }
    let rest = rest.trim();
    if rest.is_empty() {
        return if value.is_zero() {
            Ok((value, Angle::Plain))
        } else {
            Err(format!("it needs a unit: write {example}"))
        };
    }
    let unit = unit::parse(rest).map_err(|_| format!("`{rest}` is not a unit: write {example}"))?;
    let value = match unit.scale {
        Scale::Linear(factor) if unit.dimension == dimension => &value * &factor,
        _ => {
            return Err(format!("`{rest}` is not a unit of {}: write {example}", dimension.noun().unwrap_or("this")));
        }
    };
    // As in a model: zero, or a size that binary64 has in full precision.
    let size = value.to_f64().abs();
    if !(value.is_zero() || (f64::MIN_POSITIVE..=f64::MAX).contains(&size)) {
        return Err("it is outside the range of binary64 in SI units".into());
    }
    Ok((value, unit.angle))
}

/// A value of the command line in both readings of its literals.
#[derive(Clone, Debug)]
pub struct Readings<T> {
    decimal: T,
    binary64: T,
}

impl<T> Readings<T> {
    fn of(read: impl Fn(Literals) -> Result<T, String>) -> Result<Readings<T>, String> {
        Ok(Readings { decimal: read(Literals::Decimal)?, binary64: read(Literals::Binary64)? })
    }

    pub fn of_literals(&self, literals: LiteralsOption) -> &T {
        match literals {
            LiteralsOption::Decimal => &self.decimal,
            LiteralsOption::Binary64 => &self.binary64,
        }
    }
}

/// A frequency in cycles or radians: an exact `2rad/s` stays one.
fn frequency(text: &str) -> Result<Readings<Frequency>, String> {
    Readings::of(|literals| frequency_as(text, literals))
}

fn frequency_as(text: &str, literals: Literals) -> Result<Frequency, String> {
    let (value, angle) = quantity(text, Dimension::FREQUENCY, literals, "a frequency such as 30Hz or 2rad/s")?;
    match angle {
        Angle::Radians => Ok(Frequency::radians(&value)),
        Angle::Cycles => Ok(Frequency::hertz(&value)),
        Angle::Plain if value.is_zero() => Ok(Frequency::hertz(&value)),
        Angle::Plain | Angle::PerCycle | Angle::PerRadian => Err("write Hz for cycles or rad/s for radians".into()),
    }
}

/// A range of frequencies in Hz, from below to above.
fn range(text: &str) -> Result<Readings<(Number, Number)>, String> {
    Readings::of(|literals| range_as(text, literals))
}

fn range_as(text: &str, literals: Literals) -> Result<(Number, Number), String> {
    let (from, to) = text.split_once("..").ok_or("write FROM..TO, such as 0.1Hz..100Hz")?;
    let (from, to) = (frequency_as(from, literals)?.hertz, frequency_as(to, literals)?.hertz);
    if (&to - &from).is_positive() {
        Ok((from, to))
    } else {
        Err("the range is empty: write the lower end first".into())
    }
}

/// A ratio that is not negative: `5%` or `0.05`.
fn ratio(text: &str) -> Result<Readings<Number>, String> {
    Readings::of(|literals| {
        let (number, percent) = match text.trim_end().strip_suffix('%') {
            Some(number) => (number.trim_end(), true),
            None => (text, false),
        };
        let read = Rational::from_literal(number.strip_prefix('-').unwrap_or(number), literals);
        let value = Number::from(read.ok_or("write a ratio, such as 5% or 0.05")?);
        if number.starts_with('-') && !value.is_zero() {
            return Err("it must not be negative".into());
        }
        Ok(if percent { &value / &Number::from(100) } else { value })
    })
}

/// A time in s, greater than zero.
fn time(text: &str) -> Result<Readings<Number>, String> {
    Readings::of(|literals| time_as(text, literals))
}

fn time_as(text: &str, literals: Literals) -> Result<Number, String> {
    let (value, _) = quantity(text, Dimension::TIME, literals, "a time such as 10s")?;
    if value.is_positive() { Ok(value) } else { Err("it must be greater than zero".into()) }
}

/// A count within limits.
fn whole(limits: RangeInclusive<u32>) -> impl Fn(&str) -> Result<u32, String> + Clone + Send + Sync + 'static {
    move |text| {
        let count = text.parse().ok().filter(|count| limits.contains(count));
        count.ok_or_else(|| format!("write a whole number from {} to {}", limits.start(), limits.end()))
    }
}

fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("write a whole number from 0 to {}", u64::MAX))
}

fn tolerance(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "write a number, such as 1e-12")?;
    if value > 0.0 && value < 1.0 { Ok(value) } else { Err("it must lie between 0 and 1".into()) }
}
