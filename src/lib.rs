//! A compiler for mechanical vibrations: from a drawn scene to matrices, modes, poles and simulation code.
//!
//! Everything takes texts and gives values: the library reads no file and writes none.
//!
//! ```
//! use vibc::{Overrides, SourceFile, Sources};
//!
//! let mut sources = Sources::new();
//! let model = sources.add(SourceFile::model(
//!     "block.vib",
//!     "body block { mass = 2 kg, moves x }\nspring s: ground -- block { k = 200 N/m }",
//! ));
//! let outcome = vibc::analyze(&sources, model, &Overrides::default());
//! let answer = outcome.answer.expect("a model without errors");
//!
//! // Each frequency is an enclosure: 10 rad/s to the last digit, with a bound that holds.
//! let omega = answer.modes.list[0].omega;
//! assert_eq!(omega.to_f64(), 10.0);
//! assert!(omega.rad < 1e-28);
//! println!("{}", vibc::report(&answer, &Default::default()));
//! ```
//!
//! Functions that take a model through the stages return an [`Outcome`]: an answer, and the diagnostics for the model.
//! [`analyze`] finds modes and poles, [`dynamics()`] the basis of transfer functions, [`simulate`] motions, [`discrete`]
//! the system that emitted code runs; [`check`] only looks for errors.
//!
//! # Steps
//! 1. `syntax`: from text to a syntax tree
//! 2. `model`: from the tree to a checked scene
//! 3. `dynamics`: from the scene to a damped linear system about its rest; `lower` is the larger part of it
//! 4. `analysis`: from the system to answers, each with its error bound
//! 5. `questions`: the model's own questions, `solve` and `require`; they repeat the steps before as often as needed
//! 6. `answers`: all results as one value
//! 7. `backend`: from answers and systems to text, JSON, CSV, code
//!
//! # Features
//! `program` (on by default) builds the program `vibc` and makes these layers public for it and for the tests. They are
//! not part of the interface: use the library with `default-features = false`.

// `kernel::simd` alone allows it, with its reasons.
#![deny(unsafe_code)]
// The program and the tests use more of the layers than the interface does.
#![cfg_attr(not(feature = "program"), allow(dead_code, unused_imports))]
// Tests compare with the platform's functions to a few digits only.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

mod driven;
mod figures;
#[cfg(not(feature = "program"))]
mod inspection;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod inspection;
mod library;
mod modal;
#[cfg(not(feature = "program"))]
mod overview;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod overview;
mod reading;
mod shocks;
#[cfg(not(feature = "program"))]
mod sweep;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod sweep;

#[cfg(not(feature = "program"))]
mod answers;
#[cfg(not(feature = "program"))]
mod backend;
#[cfg(not(feature = "program"))]
mod dynamics;
#[cfg(not(feature = "program"))]
mod editor;
#[cfg(not(feature = "program"))]
mod elements;
#[cfg(not(feature = "program"))]
mod equations;
#[cfg(not(feature = "program"))]
mod joints;
#[cfg(not(feature = "program"))]
mod kinds;
#[cfg(not(feature = "program"))]
mod lower;
#[cfg(not(feature = "program"))]
mod model;
#[cfg(not(feature = "program"))]
mod picture;
#[cfg(not(feature = "program"))]
mod questions;
#[cfg(not(feature = "program"))]
mod symbols;
#[cfg(not(feature = "program"))]
mod syntax;

#[cfg(feature = "program")]
#[doc(hidden)]
pub mod answers;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod backend;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod cli;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod dynamics;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod editor;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod elements;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod equations;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod joints;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod kinds;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod lower;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod model;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod picture;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod questions;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod symbols;
#[cfg(feature = "program")]
#[doc(hidden)]
pub mod syntax;

#[cfg(not(feature = "program"))]
use vibc_linear::{analysis, base, bench, kernel, system};
#[cfg(feature = "program")]
#[doc(hidden)]
pub use vibc_linear::{analysis, base, bench, kernel, system};

// ---- the interface

// Texts in.
pub use base::{FileId, Literals, SourceFile, SourceKind, Sources, Span};
pub use model::Overrides;
pub use reading::{add_used_files, table_files};
/// For the program and the Python package, which read files within these limits.
#[doc(hidden)]
pub use syntax::limits;

// Numbers, exact or with bounds that hold.
pub use base::{Ball, Bound, Dd, Number, Rational, Rounded, Unproven};

// Diagnostics about a model.
pub use backend::diagnostics::{
    HumanStyle, human as diagnostics_text, json as diagnostics_json, short as diagnostics_short,
};
pub use base::{Code, Diagnostic, Diagnostics, Failure, Label as DiagnosticLabel, Severity};

// The linear system of a model.
pub use lower::{Account, Dependent, LawAtRest, Remark, Rest, Tension};
pub use system::{
    Coordinate, CoordinateId, CoordinateKind, Form, Input, Label, LinearSystem, Nature, Origin, Output, Signal, Source,
    Term,
};

// Modes, poles, and the stability of the rest that follows from them.
pub use analysis::response_spectrum::{Additions as SpectrumAdditions, Spectral};
pub use analysis::{
    AnalysisError, Band, Before, Buckling, Mode, ModeKind, Modes, Noisy, Normalise, Peak, Pole, PoleCount, PoleKind,
    Poles, Reason, Request, Route, Share, Spread, Stability, Verdict, Which, normalise,
};
pub use answers::{ModalAnswer, Shock, by_name as shares_by_name};
pub use questions::answer::{Best, Optimised, OptimisedParameter, Requirement, Sensitivity, Solved, Value};

// Shock response spectra.
pub use analysis::shock::{Grid as ShockGrid, Quantity as ShockQuantity, Request as ShockRequest};

// Transfer functions and motions.
pub use analysis::{
    Disc, Extrema, Extremum, FeatureKind, Frequency, Gain, History, MOST_SAMPLES, Methods, Row, Steady, Sweep, Table,
    Transfer, grid as times, rates::Rate, table as transfer_table,
};
pub use driven::NotDriven;

// The model at many values of its parameters.
pub use questions::answer::{Entry, Holds};
pub use questions::cases::Study as Cases;
pub use sweep::{Draws, StudyRequest, cases as computed_cases, study as cases_of};

// Equations of motion in the model's own symbols.
pub use equations::Equations;

// Simulation code.
pub use analysis::discrete::{DiscreteSystem, Hold, Options as DiscreteOptions, Precision};
pub use backend::emit::{File as EmittedFile, Language, Program, files as emitted_files};

// Text, JSON, CSV, figures and tables of a page out.
pub use backend::ReportOptions;
pub use backend::draw::svg as figure_svg;
pub use backend::json::json as report_json;
pub use backend::page::modal_table;
pub use backend::report::text as report;
pub use backend::simulation::{csv as motion_csv, json as motion_json};
pub use backend::transfer::{csv as transfer_csv, json as transfer_json};

use lower::Lowered;

/// The result of a run on a model.
#[derive(Clone, Debug)]
pub struct Outcome<T> {
    /// `None` if an error stopped a stage.
    pub answer: Option<T>,
    /// The diagnostics of all stages, sorted by place.
    pub diagnostics: Vec<Diagnostic>,
}

impl<T> Outcome<T> {
    fn of(run: impl FnOnce(&mut Diagnostics) -> Option<T>) -> Outcome<T> {
        let mut diagnostics = Diagnostics::new();
        let answer = run(&mut diagnostics);
        Outcome { answer, diagnostics: diagnostics.into_sorted() }
    }

    /// `None` if nothing failed; `Failure::Model` if the errors differ in kind.
    pub fn failure(&self) -> Option<Failure> {
        let errors = self.diagnostics.iter().filter(|diagnostic| diagnostic.is_error());
        let mut failures = errors.map(|error| error.code.failure());
        let first = failures.next()?;
        Some(if failures.all(|failure| failure == first) { first } else { Failure::Model })
    }
}

/// Analyses a model: its modes, poles and stability, with the usual number of modes for its size.
///
/// ```
/// use vibc::{Failure, Overrides, SourceFile, Sources, Stability};
///
/// let mut sources = Sources::new();
/// let text = "gravity 9.81 m/s^2\nbody bob { mass = 1 kg, inertia = 0 kg*m^2, at = (0 m, 1 m) }\npivot p: ground@(0 m, 0 m) -- bob";
/// let model = sources.add(SourceFile::model("upright.vib", text));
/// let answer = vibc::analyze(&sources, model, &Overrides::default()).answer.expect("a model without errors");
/// assert_eq!(answer.stability.kind(), Stability::Unstable);
///
/// let model = sources.add(SourceFile::model("wrong.vib", "body bob { mass = 1 m, moves x }"));
/// let outcome = vibc::analyze(&sources, model, &Overrides::default());
/// assert!(outcome.answer.is_none());
/// assert_eq!(outcome.failure(), Some(Failure::Model));
/// assert!(vibc::diagnostics_short(&sources, &outcome.diagnostics).starts_with("wrong.vib:1:"));
/// ```
pub fn analyze(sources: &Sources, model: FileId, overrides: &Overrides) -> Outcome<ModalAnswer> {
    analyze_as(sources, model, overrides, &Request { which: Which::Usual, ..Request::default() })
}

/// Analyses a model like [`analyze`], with the requested modes and accuracy. If a requested accuracy is not reached,
/// there is an answer all the same, with the bounds that were reached.
pub fn analyze_as(sources: &Sources, model: FileId, overrides: &Overrides, request: &Request) -> Outcome<ModalAnswer> {
    analyze_with(sources, model, overrides, request, &Study::default())
}

/// Requests in addition to the modal report.
#[derive(Clone, Copy, Debug, Default)]
pub struct Study<'a> {
    /// Simulated time for `peak` and `rms`, s; if not given, it follows from the poles and signals.
    pub until: Option<&'a Number>,
    /// Compute the derivatives of frequencies and damping ratios with respect to each parameter.
    pub sensitivity: bool,
    /// Compute the range of each frequency, and judge each requirement, over all values within the tolerances.
    pub tolerances: bool,
    /// Make the worst case of `minimise` and `maximise` within the tolerances the best.
    pub robust: bool,
    /// Compute participation factors and effective masses of the modes for each motion of a base.
    pub participation: bool,
    /// Compute the complex shapes of the damped motions.
    pub damped_shapes: bool,
    /// Find the points of turning bodies that stay in place in each mode.
    pub nodes: bool,
    /// Contributions that are added to the maxima under response spectra.
    pub spectra: analysis::response_spectrum::Additions,
}

/// Like [`analyze_as`], with additional requests.
pub fn analyze_with(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    request: &Request,
    study: &Study,
) -> Outcome<ModalAnswer> {
    Outcome::of(|diagnostics| {
        let mut reading = reading::read_for(sources, model, overrides, study, diagnostics)?;
        let damped = dynamics::lower_with_damping(&reading.scene, diagnostics)?;
        modal::modal_answer(&mut reading, damped, request, study, diagnostics).ok()
    })
}

/// Like [`analyze_with`], with an account of what was kept of the model: part of the answer, or separate if the model is
/// too large to be analysed.
pub fn analyze_and_explain(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    request: &Request,
    study: &Study,
) -> (Outcome<ModalAnswer>, Option<Explained>) {
    let mut explained = None;
    let outcome = Outcome::of(|diagnostics| {
        let mut reading = reading::read_for(sources, model, overrides, study, diagnostics)?;
        let (name, lowered) = (reading.name(), dynamics::lower_undamped(&reading.scene, diagnostics)?);
        let account = lower::account(&reading.scene, &lowered);
        match dynamics::with_damping(&reading.scene, lowered, diagnostics) {
            Ok(damped) => match modal::modal_answer(&mut reading, damped, request, study, diagnostics) {
                Ok(answer) => Some(ModalAnswer { account: Some(account), ..answer }),
                Err(damped) => {
                    explained = Some(Explained::new(name, damped.lowered, account));
                    None
                }
            },
            Err(lowered) => {
                explained = Some(Explained::new(name, *lowered, account));
                None
            }
        }
    });
    (outcome, explained)
}

/// A model with its modes, ready for transfer tables.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Dynamics {
    /// The model's name.
    pub model: String,
    pub system: LinearSystem,
    /// `None` if there are too many coordinates to compute them; a table works without modes and poles if its range is
    /// given.
    pub modes: Option<Modes>,
    /// Each input that moves a base, and the motion: `x`, `y`, `along` or `angle`.
    bases: Vec<(usize, &'static str)>,
    /// Where each output is declared.
    places: Vec<base::Span>,
}

/// The basis of a model's transfer functions: its linear system and modes.
///
/// ```
/// use vibc::{Frequency, Number, Overrides, SourceFile, Sources, Transfer};
///
/// let mut sources = Sources::new();
/// let text = "body block { mass = 2 kg, moves x }\nspring s: ground -- block { k = 200 N/m }\n\
///             force push: block along x\noutput x = block.x";
/// let model = sources.add(SourceFile::model("block.vib", text));
/// let dynamics = vibc::dynamics(&sources, model, &Overrides::default()).answer.expect("a model without errors");
/// let transfer = Transfer::of(&dynamics.system);
/// let gain = &transfer.between(&Frequency::hertz(&Number::from(0)), &[0], &[0])[0][0];
/// let disc = gain.disc().expect("no pole at zero");
/// assert!((disc.value.to_f64().re - 1.0 / 200.0).abs() < 1e-17);
/// ```
pub fn dynamics(sources: &Sources, model: FileId, overrides: &Overrides) -> Outcome<Dynamics> {
    Outcome::of(|diagnostics| {
        let reading = reading::read_and_solve(sources, model, overrides, None, diagnostics)?;
        let (system, modes) = dynamics::for_transfer(&reading.scene, diagnostics)?.into_parts();
        let modes = match driven::modes(&system, modes) {
            Ok(modes) => modes,
            Err(error) => return push_error(&error, diagnostics),
        };
        let scene = reading.scene.scene();
        let motions = scene.inputs.iter().map(|input| scene.motion_of_base(&input.kind));
        let bases = (0..).zip(motions).filter_map(|(input, motion)| Some((input, motion?))).collect();
        let places = scene.outputs.iter().map(|output| output.span).collect();
        Some(Dynamics { model: reading.name(), system, modes, bases, places })
    })
}

fn push_error<T>(error: &AnalysisError, diagnostics: &mut Diagnostics) -> Option<T> {
    diagnostics.push(error.to_diagnostic());
    None
}

/// A model's motion in time.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Motion {
    /// The model's name.
    pub model: String,
    pub system: LinearSystem,
    pub history: History,
    /// The steady state for each frequency of the harmonic signals.
    pub steady: Vec<analysis::Steady>,
    /// Whether noise acts on the model. A motion contains it only if a seed is given.
    pub has_noise: bool,
}

/// The motion of a model at ascending times, s, under its signals and from its initial state.
///
/// ```
/// use vibc::{Number, Overrides, SourceFile, Sources};
///
/// let mut sources = Sources::new();
/// let text = "body block { mass = 1 kg, moves x }\nspring s: ground -- block { k = 1 N/m }\n\
///             initial block { x = 1 m }\noutput x = block.x";
/// let model = sources.add(SourceFile::model("block.vib", text));
/// let times = vibc::times(&Number::from(2), &Number::from(1));
/// let motion = vibc::simulate(&sources, model, &Overrides::default(), &times).answer.expect("a motion");
/// let x = motion.history.values[2][0];
/// assert!((x.to_f64() - 2f64.cos()).abs() <= x.rad + 1e-16);
/// ```
pub fn simulate(sources: &Sources, model: FileId, overrides: &Overrides, times: &[Number]) -> Outcome<Motion> {
    simulate_with_noise(sources, model, overrides, times, None)
}

/// Like [`simulate`], with the stationary motion that a realisation of the model's noise by this seed adds; without a
/// seed, noise is left out.
pub fn simulate_with_noise(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    times: &[Number],
    seed: Option<u64>,
) -> Outcome<Motion> {
    Outcome::of(|diagnostics| {
        let reading = reading::read_and_solve(sources, model, overrides, times.last(), diagnostics)?;
        let outputs = &reading.scene.scene().outputs;
        let few = outputs.first().map(|first| analysis::refuse_too_many(times.len(), outputs.len(), first.span));
        if let Some(Err(error)) = few {
            return push_error(&error, diagnostics);
        }
        dynamics::refuse_losses(&reading.scene, diagnostics)?;
        let written = dynamics::lower_written_out(&reading.scene, diagnostics)?;
        let drives = dynamics::drives(&reading.scene, diagnostics)?;
        if let Some(end) = times.last() {
            diagnostics.extend(match seed.is_some() && dynamics::noise_left_out(&reading.scene).is_some() {
                true => dynamics::laws_under_noise(&reading.scene).into_iter().collect(),
                false => dynamics::beyond_tangents(&reading.scene, &written.lowered, &drives, end),
            });
        }
        let (system, modes) = written.about_rest(diagnostics)?.into_parts();
        diagnostics.extend(dynamics::spectrum_left_out(&reading.scene));
        diagnostics.extend(dynamics::drifts(&reading.scene));
        let history = analysis::respond_with(&system, modes.as_ref(), &drives, times);
        let mut history = history.or_else(|error| push_error(&error, diagnostics).ok_or(())).ok()?;
        let places: Vec<base::Span> = reading.scene.scene().outputs.iter().map(|output| output.span).collect();
        let noise = seed.map(|seed| dynamics::realisation(&reading.scene, (&system, modes.as_ref()), seed, times));
        match noise {
            None => diagnostics.extend(dynamics::noise_left_out(&reading.scene)),
            Some(Ok(noise)) => history.add(&noise),
            Some(Err(refused)) => {
                diagnostics.push(*refused);
                return None;
            }
        }
        diagnostics.extend(analysis::response::findings(&system, &drives, &history, &places));
        let steady = analysis::steady_alone(&system, &drives);
        let has_noise = dynamics::has_noise(&reading.scene);
        Some(Motion { model: reading.name(), system, history, steady, has_noise })
    })
}

/// Shock response spectra of a model's bases; `from` names them, and is empty for all that have a signal.
/// The inner error says why there is none.
///
/// ```
/// use vibc::{Number, Overrides, ShockGrid, ShockQuantity, ShockRequest, SourceFile, Sources};
///
/// let mut sources = Sources::new();
/// let text = "body block { mass = 1 kg, moves x }\nbase table { moves x } = step(1 m/s^2, 0 s)\n\
///             spring s: table -- block { k = 1 N/m }";
/// let model = sources.add(SourceFile::model("block.vib", text));
/// let request = ShockRequest {
///     quantity: ShockQuantity::PseudoAcceleration,
///     damping: Number::from(0),
///     grid: ShockGrid::At(vec![Number::from(7)]),
/// };
/// let shock = vibc::shock(&sources, model, &Overrides::default(), &[], &request).answer.expect("a model without errors");
/// // Without damping a sudden acceleration acts twice.
/// let row = &shock.expect("a spectrum").list[0].spectrum.rows[0];
/// assert!((row.maximax().to_f64() - 2.0).abs() < 1e-15);
/// ```
pub fn shock(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    from: &[String],
    request: &analysis::shock::Request,
) -> Outcome<Result<Shock, String>> {
    Outcome::of(|diagnostics| {
        let reading = reading::read_and_solve(sources, model, overrides, None, diagnostics)?;
        shocks::of_bases(&reading, from, request, diagnostics)
    })
}

/// A model as simulation code computes it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Emission {
    /// The model's name.
    pub model: String,
    pub system: DiscreteSystem,
}

/// The discrete system that code emitted for a model runs.
///
/// ```
/// use vibc::{DiscreteOptions, Hold, Language, Number, Overrides, Precision, SourceFile, Sources};
///
/// let mut sources = Sources::new();
/// let text = "body block { mass = 1 kg, moves x }\nspring s: ground -- block { k = 1 N/m }\n\
///             force push: block along x\noutput x = block.x";
/// let model = sources.add(SourceFile::model("block.vib", text));
/// let options = DiscreteOptions {
///     step: Number::from("0.001"),
///     hold: Hold::Zero,
///     precision: Precision::Double,
///     tolerance: None,
///     unpruned: false,
///     built_in: false,
///     internal: Vec::new(),
///     until: None,
/// };
/// let emission = vibc::discrete(&sources, model, &Overrides::default(), &options).answer.expect("a model without errors");
/// let files = vibc::emitted_files("block", &emission.system, Language::C, None);
/// assert!(files.iter().any(|file| file.name.ends_with(".c")));
/// ```
pub fn discrete(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    options: &analysis::discrete::Options,
) -> Outcome<Emission> {
    Outcome::of(|diagnostics| {
        let reading = reading::read_and_solve(sources, model, overrides, options.until.as_ref(), diagnostics)?;
        let (system, modes) = dynamics::about_rest(&reading.scene, diagnostics)?.into_parts();
        if let Some(refusal) =
            dynamics::noise_refused(&reading.scene).or_else(|| dynamics::spectrum_refused(&reading.scene))
        {
            diagnostics.push(refusal);
            return None;
        }
        let mut options = options.clone();
        if options.built_in {
            options.internal = dynamics::drives(&reading.scene, diagnostics)?;
        } else if let Some(refusal) = dynamics::unbalance_refused(&reading.scene) {
            diagnostics.push(refusal);
            return None;
        }
        let modes = modes.map_or_else(|| analysis::discrete::all_modes(&system), Ok);
        let system = modes.and_then(|modes| analysis::discretise(&system, &modes, &options));
        let mut system = system.map_err(|error| diagnostics.push(error.to_diagnostic())).ok()?;
        diagnostics.extend(dynamics::laws_in_code(&reading.scene));
        system.laws = dynamics::names_of_laws(&reading.scene);
        Some(Emission { model: reading.name(), system })
    })
}

/// The linear system of a model as a function of one parameter; the inner error says why there is none.
pub fn over_parameter(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    name: &str,
) -> Outcome<(String, Result<analysis::discrete::parameter::Parameterised, String>)> {
    Outcome::of(|diagnostics| {
        let reading = reading::read_and_solve(sources, model, overrides, None, diagnostics)?;
        diagnostics.extend(dynamics::laws_in_code(&reading.scene));
        Some((reading.name(), reading.over_parameter(name)))
    })
}

/// The linear system of a model.
pub fn linear(sources: &Sources, model: FileId, overrides: &Overrides) -> Outcome<(String, LinearSystem)> {
    Outcome::of(|diagnostics| {
        let reading = reading::read_and_solve(sources, model, overrides, None, diagnostics)?;
        let (system, _) = dynamics::about_rest(&reading.scene, diagnostics)?.into_parts();
        diagnostics.extend(dynamics::laws_in_code(&reading.scene));
        Some((reading.name(), system))
    })
}

/// An account of a model: what was kept, what was left out, and why.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Explained {
    /// The model's name.
    pub model: String,
    pub system: LinearSystem,
    pub account: Account,
}

impl Explained {
    /// The system is shown in the form that analyses use, if it fits; a scene that hangs deeper is explained all the
    /// same.
    fn new(model: String, mut lowered: Lowered, account: Account) -> Explained {
        let _ = lowered.flatten();
        Explained { model, system: lowered.system, account }
    }
}

/// The equations of motion of a model in symbols, compared with its linear system.
pub fn equations(sources: &Sources, model: FileId, overrides: &Overrides) -> Outcome<Equations> {
    Outcome::of(|diagnostics| {
        let (scene, written) = reading::read_written(sources, model, overrides, diagnostics)?;
        dynamics::refuse_losses(&scene, diagnostics)?;
        let mut lowered = dynamics::lower_undamped(&scene, diagnostics)?;
        lowered.flatten().map_err(|error| diagnostics.push(error.to_diagnostic())).ok()?;
        let derived = equations::derive(scene.scene(), &written, &lowered);
        derived.map_err(|error| diagnostics.push(error.to_diagnostic())).ok()
    })
}

/// An account of the parts of a model that were kept and left out, which needs no analysis.
pub fn explain(sources: &Sources, model: FileId, overrides: &Overrides) -> Outcome<Explained> {
    Outcome::of(|diagnostics| {
        let reading = reading::read_and_solve(sources, model, overrides, None, diagnostics)?;
        let lowered = lower::lower(&reading.scene).lowered?;
        let account = lower::account(&reading.scene, &lowered);
        Some(Explained::new(reading.name(), lowered, account))
    })
}

/// Speed against error for a model: its name, and every method for its answers. `clock` returns the time in s.
#[cfg(feature = "program")]
#[doc(hidden)]
pub fn bench(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    clock: &mut bench::Clock,
) -> Outcome<(String, bench::Bench)> {
    Outcome::of(|diagnostics| {
        let reading = reading::read_and_solve(sources, model, overrides, None, diagnostics)?;
        let (system, _) = dynamics::about_rest(&reading.scene, diagnostics)?.into_parts();
        let drives = dynamics::drives(&reading.scene, diagnostics)?;
        let rounded = Overrides { literals: base::Literals::Binary64, ..*overrides };
        let rounded = linear(sources, model, &rounded).answer.map(|(_, system)| system);
        let found = bench::bench(&system, rounded.as_ref(), &drives, &chain, clock);
        let found = found.map_err(|error| diagnostics.push(error.to_diagnostic())).ok()?;
        Some((reading.name(), found))
    })
}

/// A uniform chain with this many masses, lowered from the text of a model.
fn chain(masses: usize) -> Option<LinearSystem> {
    let text = format!(
        "body m[1] {{ mass = 1 kg, moves x }}\nspring k[1]: ground -- m[1] {{ k = 1 kN/m }}\nrepeat i in 2..{masses} {{\n\
         body m[i] {{ mass = 1 kg, moves x }}\nspring k[i]: m[i-1] -- m[i] {{ k = 1 kN/m }}\n}}\n"
    );
    let mut sources = Sources::new();
    let model = sources.add(base::SourceFile::model("chain.vib", text));
    Some(linear(&sources, model, &Overrides::default()).answer?.1)
}

/// Options of a figure, in addition to the scene as drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FigureOptions {
    /// The scene at rest.
    pub rest: bool,
    /// This mode, superposed on the rest; counted from 1.
    pub mode: Option<u32>,
    /// Show values beside names.
    pub values: bool,
}

/// The figure of a model; the inner error says why there is none.
pub fn draw(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    drawn: &FigureOptions,
) -> Outcome<Result<picture::Figure, String>> {
    Outcome::of(|diagnostics| {
        let reading = reading::read_and_solve(sources, model, overrides, None, diagnostics)?;
        figures::figure(&reading, drawn, diagnostics)
    })
}

/// The text of a model in the standard layout; no answer if it does not match the grammar.
///
/// ```
/// let mut sources = vibc::Sources::new();
/// let model = sources.add(vibc::SourceFile::model("block.vib", "body  block{mass=1 kg,moves x}"));
/// assert_eq!(vibc::format(&sources, model).answer.as_deref(), Some("body block { mass = 1 kg, moves x }\n"));
/// ```
pub fn format(sources: &Sources, model: FileId) -> Outcome<String> {
    Outcome::of(|diagnostics| {
        diagnostics.extend(reading::not_utf8(sources, model));
        let parsed = syntax::parse_alone(sources, model);
        diagnostics.extend(parsed.errors);
        (!diagnostics.has_errors()).then(|| editor::format::format(sources.text(model), &parsed.tree))
    })
}

/// The diagnostics for a model, and whether its requirements hold.
pub fn check(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    until: Option<&Number>,
) -> Outcome<Vec<Requirement>> {
    Outcome::of(|diagnostics| {
        let mut reading = reading::read_and_solve(sources, model, overrides, until, diagnostics)?;
        let scene = reading.scene.scene();
        if scene.requires.is_empty() && scene.damping.is_none() {
            reading.forget_tree();
            // No number is requested, so the scene may hang deeper than analyses allow.
            let found = lower::check(&reading.scene);
            let fails = found.has_errors();
            diagnostics.extend(found);
            return (!fails).then(Vec::new);
        }
        let damped = dynamics::lower_with_damping(&reading.scene, diagnostics)?;
        // If it cannot be written out, each requirement reports that.
        let system = damped.into_written_out(&mut Diagnostics::new());
        Some(reading.requirements(system.as_ref(), None, diagnostics))
    })
}
