//! A compiler for mechanical vibrations: from a drawn scene to matrices, modes, poles and simulation code.
//!
//! # Steps
//! 1. [`syntax`]: text to syntax tree
//! 2. [`model`]: tree to checked scene
//! 3. [`lower`]: scene to linear system about its rest
//! 4. [`analysis`]: system to answers, each with its error bound
//! 5. [`questions`]: what the model asks of them, `solve` and `require`; it goes through the steps before as often as needed
//! 6. [`answers`]: what was found out, as one value
//! 7. [`backend`]: answers and systems to text, JSON, CSV, code
//!
//! The core does no input or output: text in, data out. Standard streams and files are touched in `main.rs` only.

pub mod analysis;
pub mod answers;
pub mod backend;
pub mod base;
pub mod bench;
pub mod editor;
pub mod elements;
pub mod joints;
pub mod lower;
pub mod model;
pub mod questions;
pub mod syntax;
pub mod system;

use analysis::discrete::parameter::{MULTIPLES, Parameterised};
use analysis::{AnalysisError, DiscreteSystem, History, Modal, Modes, Poles, Request, Which};
use answers::ModalAnswer;
use base::{Code, Diagnostic, Diagnostics, FileId, Number, Quantity, Sources, Span};
use lower::{Account, Lowered};
use model::scene::Damping;
use model::{CheckedScene, Overrides, Setting};
use questions::error::AskedError;
use questions::{Requirement, Settled, Solved, Stages, Text};
use syntax::tree::Tree;
use system::LinearSystem;

/// What a run found out about a model.
#[derive(Clone, Debug)]
pub struct Outcome<T> {
    /// `None` where an error stopped a stage.
    pub answer: Option<T>,
    /// Of every stage, sorted by place.
    pub diagnostics: Vec<Diagnostic>,
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The model is wrong.
    Model,
    /// A file that it names could not be read.
    File,
    /// The model may be right, but a number that it asks for could not be found.
    Limit,
}

/// From the text of a model to its modal report, as is usual for its size.
pub fn analyze(sources: &Sources, model: FileId, overrides: &Overrides) -> Outcome<ModalAnswer> {
    analyze_as(sources, model, overrides, &Request { which: Which::Usual, ..Request::default() })
}

/// From the text of a model to a modal report of what is asked for. Where an accuracy that was asked for is not reached, the
/// answer is there all the same, with the bounds that were.
pub fn analyze_as(sources: &Sources, model: FileId, overrides: &Overrides, request: &Request) -> Outcome<ModalAnswer> {
    analyze_with(sources, model, overrides, request, &Study::default())
}

/// What is asked besides the modal report.
#[derive(Clone, Copy, Debug, Default)]
pub struct Study<'a> {
    /// How long `peak` and `rms` follow the motion, s; from the poles and signals where it is not given.
    pub until: Option<&'a Number>,
    /// The derivatives of frequencies and damping ratios by each parameter.
    pub sensitivity: bool,
}

/// The same, and what is asked besides.
pub fn analyze_with(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    request: &Request,
    study: &Study,
) -> Outcome<ModalAnswer> {
    let mut diagnostics = Diagnostics::new();
    let answer = read(sources, model, overrides, study.until, &mut diagnostics).and_then(|read| {
        let answer = answered(&read, request, &mut diagnostics)?;
        let requirements = read.requirements(Some((&answer.modes, &answer.poles)), &mut diagnostics);
        let (modes, poles) = (&answer.modes, &answer.poles);
        let sensitivities = if study.sensitivity {
            let system = &answer.system;
            read.asked(|text| questions::sensitivities(text, &read.settings, request, system, modes, poles))
        } else {
            Vec::new()
        };
        Some(ModalAnswer { requirements, sensitivities, solved: read.solved, ..answer })
    });
    if let Some(ModalAnswer { system, modes, poles, .. }) = &answer
        && let Some(shortfall) = analysis::shortfall(system, modes, poles, request)
    {
        diagnostics.push(shortfall.to_diagnostic());
    }
    Outcome { answer, diagnostics: diagnostics.sorted() }
}

fn answered(read: &Read, request: &Request, diagnostics: &mut Diagnostics) -> Option<ModalAnswer> {
    let Damped { lowered, by_modes } = hanging(&read.scene, diagnostics)?;
    if lowered.system.is_chained() && analysis::takes_chained(&lowered.system, request) {
        match analysis::modal(&lowered.system, request) {
            // Written out there may be a way, or else more to say of why there is none.
            Err(AnalysisError::NotSparse { .. }) => {}
            found => {
                let modal = found.map_err(|error| diagnostics.push(error.to_diagnostic())).ok()?;
                return Some(answer(read, lowered, modal));
            }
        }
    }
    let lowered = flattened(lowered, diagnostics)?;
    let found = match by_modes {
        None => analysis::modal(&lowered.system, request),
        Some(ByModes { ratio, without }) => {
            let system = without.as_ref().unwrap_or(&lowered.system);
            analysis::modal_by_ratio(system, &ratio, request).and_then(|found| match (found, without) {
                (Some(modal), _) => Ok(modal),
                (None, Ok(_)) => analysis::modal(&lowered.system, request),
                (None, Err(too_many)) => Err(too_many),
            })
        }
    };
    let modal = found.map_err(|error| diagnostics.push(error.to_diagnostic())).ok()?;
    Some(answer(read, lowered, modal))
}

/// A model with its poles, ready for transfer tables.
#[derive(Clone, Debug)]
pub struct Dynamics {
    /// The model's name.
    pub model: String,
    pub system: LinearSystem,
    /// `None` where there are more coordinates than modes or poles are computed of: a table does without them where its
    /// range is given.
    pub spectrum: Option<(Modes, Poles)>,
}

/// From the text of a model to what transfer tables are computed from.
pub fn dynamics(sources: &Sources, model: FileId, overrides: &Overrides) -> Outcome<Dynamics> {
    let mut diagnostics = Diagnostics::new();
    let answer = checked_scene(sources, model, overrides, &mut diagnostics).and_then(|scene| {
        let damped = hanging(&scene, &mut diagnostics)?;
        if let Some(refusal) = too_long_rows(&damped.lowered.system) {
            diagnostics.push(refusal);
            return None;
        }
        let system = damped.written_out(&mut diagnostics)?.system;
        let spectrum = analysis::modes(&system).and_then(|modes| {
            let poles = analysis::poles(&system, &modes)?;
            Ok((modes, poles))
        });
        let spectrum = match spectrum {
            Ok(spectrum) => Some(spectrum),
            Err(AnalysisError::TooManyCoordinates { .. }) => None,
            Err(error) => {
                diagnostics.push(error.to_diagnostic());
                return None;
            }
        };
        Some(Dynamics { model: scene.scene().name.clone(), system, spectrum })
    });
    Outcome { answer, diagnostics: diagnostics.sorted() }
}

/// Products of entries of rows that the matrices of a transfer function are summed from: some ten seconds of them.
const MOST_PRODUCTS: u64 = 50_000_000;

/// Says that rows of so many entries are not multiplied out: each of n links that hang one under another moves with all
/// above it, which makes n^3 products.
fn too_long_rows(system: &LinearSystem) -> Option<Diagnostic> {
    let products = system.products();
    let span = system.coordinates.last()?.span;
    (products > MOST_PRODUCTS).then(|| {
        let message = format!(
            "this scene hangs so deep that its transfer function would be summed from {products} products; the most are \
             {MOST_PRODUCTS}"
        );
        Diagnostic::error(lower::error::TOO_DEEP, span, message)
            .help("use fewer links, or let bodies stand on the ground with a freedom clause")
    })
}

/// A model's motion in time.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The model's name.
    pub model: String,
    pub system: LinearSystem,
    pub history: History,
    /// What repeats for ever, for each frequency of the harmonic signals.
    pub steady: Vec<analysis::Steady>,
}

/// From the text of a model to its motion at ascending times, s, under its signals and from its initial state.
pub fn simulate(sources: &Sources, model: FileId, overrides: &Overrides, times: &[Number]) -> Outcome<Motion> {
    let mut diagnostics = Diagnostics::new();
    let answer = motion(sources, model, overrides, times, &mut diagnostics);
    Outcome { answer, diagnostics: diagnostics.sorted() }
}

fn motion(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    times: &[Number],
    diagnostics: &mut Diagnostics,
) -> Option<Motion> {
    let scene = read(sources, model, overrides, times.last(), diagnostics)?.scene;
    let system = damped(&scene, diagnostics)?.system;
    let drives = lower::drives(&scene).map_err(|error| diagnostics.push(error.to_diagnostic())).ok()?;
    let history = analysis::respond(&system, &drives, times);
    let history = history.map_err(|error| diagnostics.push(error.to_diagnostic())).ok()?;
    let places: Vec<base::Span> = scene.scene().outputs.iter().map(|output| output.span).collect();
    let findings = analysis::response::findings(&system, &drives, &history, &places);
    findings.into_iter().for_each(|finding| diagnostics.push(finding));
    let outputs: Vec<usize> = (0..system.outputs.len()).collect();
    let steady = if has_harmonics(&drives) {
        analysis::steady(&analysis::Transfer::of(&system), &drives, &outputs)
    } else {
        Vec::new()
    };
    Some(Motion { model: scene.scene().name.clone(), system, history, steady })
}

fn has_harmonics(drives: &[Vec<system::Signal>]) -> bool {
    drives.iter().flatten().any(|signal| matches!(signal, system::Signal::Harmonic { .. }))
}

/// The files of tables that a model names, each once, as written: who calls adds them to the sources (see
/// [`base::SourceFile::beside`]) before any other step. A model that names none is not even parsed.
pub fn table_files(sources: &Sources, model: FileId) -> Vec<String> {
    let mut files: Vec<String> = Vec::new();
    if !sources.text(model).contains("table") {
        return files;
    }
    for span in syntax::parse(sources, model).tree.texts() {
        let file = sources.slice(span).trim_matches('"');
        if files.len() < MOST_TABLES && files.iter().all(|known| known != file) {
            files.push(file.to_string());
        }
    }
    files
}

/// Different tables of one model; a run has room for 256 files.
const MOST_TABLES: usize = 200;

/// A model as far as the stages came before any analysis.
#[derive(Clone, Debug)]
pub struct Inspection {
    pub scene: Option<CheckedScene>,
    pub lowered: Option<Lowered>,
    /// What `solve` lines found, and the values that the parameters have by them.
    pub solved: Vec<Solved>,
    pub settings: Vec<Setting>,
    pub requirements: Vec<Requirement>,
    pub diagnostics: Diagnostics,
}

/// How far a model is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// As it is declared: what takes many runs or all modes (`solve`, `require`, `damping modal`) is left out.
    Quick,
    Whole,
}

/// The text of a model through the stages up to the linear system, with what each of them made: for editors, which show
/// what is known of a model that has errors too.
pub fn inspect(sources: &Sources, model: FileId, overrides: &Overrides, effort: Effort) -> Inspection {
    let mut diagnostics = Diagnostics::new();
    let whole = effort == Effort::Whole;
    let declared = declared(sources, model, overrides, None, &mut diagnostics);
    let read = declared.and_then(|read| if whole { read.settled(&mut diagnostics) } else { Some(read) });
    let Some(read) = read else {
        let (solved, settings, requirements) = Default::default();
        return Inspection { scene: None, lowered: None, solved, settings, requirements, diagnostics };
    };
    let is_modal = matches!(read.scene.scene().damping, Some(Damping::Modal { .. }));
    let lowered = if whole || !is_modal {
        damped(&read.scene, &mut diagnostics)
    } else {
        let outcome = lower::lower(&read.scene);
        diagnostics.extend(outcome.diagnostics);
        outcome.lowered
    };
    let asks = whole && lowered.is_some();
    let requirements = if asks { read.requirements(None, &mut diagnostics) } else { Vec::new() };
    let Read { scene, settings, solved, .. } = read;
    Inspection { scene: Some(scene), lowered, solved, settings, requirements, diagnostics }
}

/// A model as simulation code computes it.
#[derive(Clone, Debug)]
pub struct Emission {
    /// The model's name.
    pub model: String,
    pub system: DiscreteSystem,
}

/// From the text of a model to the discrete system that emitted code runs.
pub fn discrete(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    options: &analysis::discrete::Options,
) -> Outcome<Emission> {
    let mut diagnostics = Diagnostics::new();
    let answer = emission(sources, model, overrides, options, &mut diagnostics);
    Outcome { answer, diagnostics: diagnostics.sorted() }
}

/// From the text of a model to its linear system as a function of one parameter; the inner error tells why there is none.
pub fn parameterised(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    name: &str,
) -> Outcome<(String, Result<Parameterised, String>)> {
    let mut diagnostics = Diagnostics::new();
    let answer = read(sources, model, overrides, None, &mut diagnostics).map(|read| {
        let found = read.over_parameter(name);
        (read.scene.scene().name.clone(), found)
    });
    Outcome { answer, diagnostics: diagnostics.sorted() }
}

/// From the text of a model to its linear system.
pub fn linear(sources: &Sources, model: FileId, overrides: &Overrides) -> Outcome<(String, LinearSystem)> {
    let mut diagnostics = Diagnostics::new();
    let scene = read(sources, model, overrides, None, &mut diagnostics).map(|read| read.scene);
    let answer = scene.and_then(|scene| Some((scene.scene().name.clone(), damped(&scene, &mut diagnostics)?.system)));
    Outcome { answer, diagnostics: diagnostics.sorted() }
}

fn emission(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    options: &analysis::discrete::Options,
    diagnostics: &mut Diagnostics,
) -> Option<Emission> {
    let scene = read(sources, model, overrides, options.until.as_ref(), diagnostics)?.scene;
    let system = damped(&scene, diagnostics)?.system;
    let mut options = options.clone();
    if options.built_in {
        options.internal = lower::drives(&scene).map_err(|error| diagnostics.push(error.to_diagnostic())).ok()?;
    }
    let discrete = analysis::modes(&system).and_then(|modes| analysis::discretise(&system, &modes, &options));
    let system = discrete.map_err(|error| diagnostics.push(error.to_diagnostic())).ok()?;
    Some(Emission { model: scene.scene().name.clone(), system })
}

/// What a model was taken for: kept, left out, and why.
#[derive(Clone, Debug)]
pub struct Explained {
    /// The model's name.
    pub model: String,
    pub system: LinearSystem,
    pub account: Account,
}

/// From the text of a model to what was kept of it; no analysis is needed for that.
pub fn explain(sources: &Sources, model: FileId, overrides: &Overrides) -> Outcome<Explained> {
    let mut diagnostics = Diagnostics::new();
    let scene = checked_scene(sources, model, overrides, &mut diagnostics);
    let explained = scene.and_then(|scene| {
        // As the analyses take it, where it fits; a scene that hangs deeper is explained all the same.
        let lowered = lower::lower(&scene).lowered?;
        let system = lower::flattened(lowered.clone()).unwrap_or(lowered).system;
        let account = lower::account(&scene, &system);
        Some(Explained { model: scene.scene().name.clone(), system, account })
    });
    Outcome { answer: explained, diagnostics: diagnostics.sorted() }
}

/// Speed against error of a model: its name, and every road to its answers. `clock` tells the time in s.
pub fn bench(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    clock: &mut bench::Clock,
) -> Outcome<(String, bench::Bench)> {
    let mut diagnostics = Diagnostics::new();
    let answer = checked_scene(sources, model, overrides, &mut diagnostics).and_then(|scene| {
        let system = damped(&scene, &mut diagnostics)?.system;
        let drives = lower::drives(&scene).map_err(|error| diagnostics.push(error.to_diagnostic())).ok()?;
        let read = Overrides { literals: base::Literals::Binary64, ..*overrides };
        let mut unheard = Diagnostics::new();
        let other = checked_scene(sources, model, &read, &mut unheard).and_then(|scene| damped(&scene, &mut unheard));
        let found = bench::bench(&system, other.as_ref().map(|other| &other.system), &drives, &chain, clock);
        let found = found.map_err(|error| diagnostics.push(error.to_diagnostic())).ok()?;
        Some((scene.scene().name.clone(), found))
    });
    Outcome { answer, diagnostics: diagnostics.sorted() }
}

/// A uniform chain of so many masses, as a model's text would give it.
fn chain(masses: usize) -> Option<LinearSystem> {
    let text = format!(
        "body m[1] {{ mass = 1 kg, moves x }}\nspring k[1]: ground -- m[1] {{ k = 1 kN/m }}\nrepeat i in 2..{masses} {{\n\
         body m[i] {{ mass = 1 kg, moves x }}\nspring k[i]: m[i-1] -- m[i] {{ k = 1 kN/m }}\n}}\n"
    );
    let mut sources = Sources::new();
    let model = sources.add(base::SourceFile::model("chain.vib", text));
    let mut unheard = Diagnostics::new();
    let scene = checked_scene(&sources, model, &Overrides::default(), &mut unheard)?;
    Some(damped(&scene, &mut unheard)?.system)
}

/// The text of a model in its one layout; no answer where it is not in the grammar.
pub fn format(sources: &Sources, model: FileId) -> Outcome<String> {
    let mut diagnostics = Diagnostics::new();
    diagnostics.extend(not_utf8(sources, model));
    let parsed = syntax::parse(sources, model);
    diagnostics.extend(parsed.errors);
    let answer = (!diagnostics.has_errors()).then(|| editor::format::format(sources.text(model), &parsed.tree));
    Outcome { answer, diagnostics: diagnostics.sorted() }
}

/// The diagnostics, and how the model's requirements stand.
pub fn check(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    until: Option<&Number>,
) -> Outcome<Vec<Requirement>> {
    let mut diagnostics = Diagnostics::new();
    let answer = read(sources, model, overrides, until, &mut diagnostics).and_then(|read| {
        let scene = read.scene.scene();
        if scene.requires.is_empty() && scene.damping.is_none() {
            // No number is asked for: a scene may hang deeper than analyses take.
            let outcome = lower::lower(&read.scene);
            diagnostics.extend(outcome.diagnostics);
            outcome.lowered?;
            return Some(Vec::new());
        }
        hanging(&read.scene, &mut diagnostics)?;
        Some(read.requirements(None, &mut diagnostics))
    });
    Outcome { answer, diagnostics: diagnostics.sorted() }
}

/// The scene, with what it solves for at the values that were found.
fn checked_scene(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    diagnostics: &mut Diagnostics,
) -> Option<CheckedScene> {
    read(sources, model, overrides, None, diagnostics).map(|read| read.scene)
}

/// The lowered scene with the damping that is declared for all of it, its rows written out.
fn damped(scene: &CheckedScene, diagnostics: &mut Diagnostics) -> Option<Lowered> {
    hanging(scene, diagnostics)?.written_out(diagnostics)
}

fn flattened(lowered: Lowered, diagnostics: &mut Diagnostics) -> Option<Lowered> {
    lower::flattened(lowered).map_err(|error| diagnostics.push(error.to_diagnostic())).ok()
}

/// A lowered scene with its damping, and the ratio that its modes have, which C does not hold where they are too many.
struct Damped {
    lowered: Lowered,
    by_modes: Option<ByModes>,
}

/// A damping ratio that every oscillation has.
struct ByModes {
    ratio: Number,
    /// The system without it, beside the one whose C holds it; or why no C holds it.
    without: Result<LinearSystem, AnalysisError>,
}

impl Damped {
    fn written_out(self, diagnostics: &mut Diagnostics) -> Option<Lowered> {
        match self.by_modes {
            None | Some(ByModes { without: Ok(_), .. }) => flattened(self.lowered, diagnostics),
            Some(ByModes { without: Err(too_many), .. }) => {
                diagnostics.push(too_many.to_diagnostic());
                None
            }
        }
    }
}

/// The same with rows chained where the scene hangs deep.
fn hanging(scene: &CheckedScene, diagnostics: &mut Diagnostics) -> Option<Damped> {
    let outcome = lower::lower(scene);
    diagnostics.extend(outcome.diagnostics);
    let mut lowered = outcome.lowered?;
    let mut by_modes = None;
    match &scene.scene().damping {
        None => {}
        Some(Damping::Rayleigh { alpha, beta, .. }) => analysis::damping::rayleigh(&mut lowered.system, alpha, beta),
        Some(Damping::Modal { ratio, .. }) => {
            // Damping that joins all coordinates has no short rows.
            lowered = flattened(lowered, diagnostics)?;
            let ratio = ratio.clone();
            match analysis::modes(&lowered.system) {
                Ok(modes) => {
                    let without = Ok(lowered.system.clone());
                    analysis::damping::modal(&mut lowered.system, &ratio, &modes);
                    by_modes = Some(ByModes { ratio, without });
                }
                Err(too_many @ AnalysisError::TooManyCoordinates { .. }) => {
                    by_modes = Some(ByModes { ratio, without: Err(too_many) });
                }
                Err(error) => {
                    diagnostics.push(error.to_diagnostic());
                    return None;
                }
            }
        }
    }
    Some(Damped { lowered, by_modes })
}

/// A model that was read, with what it solves for at the values that were found.
struct Read<'a> {
    sources: &'a Sources,
    overrides: &'a Overrides,
    /// How long the motion in time is followed, where that is given, s.
    until: Option<Number>,
    tree: Tree,
    scene: CheckedScene,
    settings: Vec<Setting>,
    solved: Vec<Solved>,
}

/// What every run begins with: text to scene, and every `solve` settled.
fn read<'a>(
    sources: &'a Sources,
    model: FileId,
    overrides: &'a Overrides,
    until: Option<&'a Number>,
    diagnostics: &mut Diagnostics,
) -> Option<Read<'a>> {
    declared(sources, model, overrides, until, diagnostics)?.settled(diagnostics)
}

/// The scene as it is declared.
fn declared<'a>(
    sources: &'a Sources,
    model: FileId,
    overrides: &'a Overrides,
    until: Option<&'a Number>,
    diagnostics: &mut Diagnostics,
) -> Option<Read<'a>> {
    let files = [Some(model), overrides.settings, overrides.arguments];
    diagnostics.extend(files.into_iter().flatten().filter_map(|file| not_utf8(sources, file)));
    if diagnostics.has_errors() {
        return None;
    }
    let parsed = syntax::parse(sources, model);
    let broken = parsed.errors.has_errors();
    diagnostics.extend(parsed.errors);
    // A broken declaration does not hide what is wrong with the others.
    let checked = model::check(sources, &parsed.tree, overrides);
    diagnostics.extend(checked.diagnostics);
    let scene = checked.scene.filter(|_| !broken)?;
    let (tree, until) = (parsed.tree, until.cloned());
    Some(Read { sources, overrides, until, tree, scene, settings: Vec::new(), solved: Vec::new() })
}

impl<'a> Read<'a> {
    /// The same with a time to follow motions for, and with what it solves for.
    fn settled(mut self, diagnostics: &mut Diagnostics) -> Option<Read<'a>> {
        if self.until.is_none() {
            self.until = self.asked(|text| text.usual_time(&self.scene));
        }
        self.solve(diagnostics)
    }

    /// The scene with every unknown of its `solve` lines at its value; as it is where there are none.
    fn solve(self, diagnostics: &mut Diagnostics) -> Option<Read<'a>> {
        if self.scene.scene().solves.is_empty() {
            return Some(self);
        }
        match self.asked(|text| questions::solve(text, &self.scene)) {
            Ok(Settled { scene, settings, solved, unsettled }) => {
                diagnostics.extend(unsettled.iter().map(AskedError::to_diagnostic));
                Some(Read { scene, settings, solved, ..self })
            }
            Err(errors) => {
                diagnostics.extend(errors.iter().map(AskedError::to_diagnostic));
                None
            }
        }
    }

    /// The linear system over a parameter.
    fn over_parameter(&self, name: &str) -> Result<Parameterised, String> {
        if !self.scene.scene().solves.is_empty() {
            return Err("the model solves for parameters, which would move with it".into());
        }
        let all = model::parameters(self.sources, &self.tree, self.overrides, &[]);
        let Some(parameter) = all.iter().find(|parameter| parameter.name == name) else {
            let names: Vec<&str> = all.iter().map(|parameter| parameter.name.as_str()).collect();
            return Err(format!("it is no parameter of the model; there are {}", names.join(", ")));
        };
        let si = &parameter.value.si;
        if si.may_be_zero() {
            return Err("its value is zero, so there is no range to look at".into());
        }
        let system = |(a, b): &(i64, i64)| {
            let value = &(si * &Number::from(*a)) / &Number::from(*b);
            let setting = (name.to_string(), Quantity { si: value, ..parameter.value.clone() });
            let checked = model::check_with(self.sources, &self.tree, self.overrides, &[setting]);
            let mut diagnostics = Diagnostics::new();
            let scene = checked.scene.ok_or("the model has errors at other values of it")?;
            Ok(damped(&scene, &mut diagnostics).ok_or("the model has errors at other values of it")?.system)
        };
        let systems: Result<Vec<LinearSystem>, String> = MULTIPLES.iter().map(system).collect();
        analysis::discrete::parameter::parameterised(name, si, &systems?)
    }

    /// How the requirements stand; `known` modes and poles are not computed again.
    fn requirements(&self, known: Option<(&Modes, &Poles)>, diagnostics: &mut Diagnostics) -> Vec<Requirement> {
        if self.scene.scene().requires.is_empty() {
            return Vec::new();
        }
        let known = known.filter(|(modes, poles)| modes.is_complete() && poles.left_out == 0);
        let (list, errors) = self.asked(|text| questions::requirements(text, &self.scene, &self.settings, known));
        diagnostics.extend(errors.iter().map(AskedError::to_diagnostic));
        list
    }

    /// Asks something of the model, which may take it through all stages many times.
    fn asked<T>(&self, ask: impl FnOnce(&Text) -> T) -> T {
        let Read { sources, overrides, until, tree, .. } = self;
        let stages = Stages {
            lower: &|scene, diagnostics| damped(scene, diagnostics),
            drives: &|scene, diagnostics| {
                lower::drives(scene).map_err(|error| diagnostics.push(error.to_diagnostic())).ok()
            },
        };
        ask(&Text { sources, tree, overrides, stages, until: until.as_ref() })
    }
}

fn answer(read: &Read, lowered: Lowered, modal: Modal) -> ModalAnswer {
    let model = read.scene.scene().name.clone();
    let Lowered { system, rest } = lowered;
    let Modal { modes, poles, stability } = modal;
    let buckling = analysis::buckling(&system);
    let (solved, requirements, sensitivities) = (Vec::new(), Vec::new(), Vec::new());
    ModalAnswer {
        model,
        system,
        rest,
        modes,
        poles,
        stability,
        buckling,
        solved,
        requirements,
        sensitivities,
        account: None,
    }
}

/// A byte that belongs to no character: the file is no text at all, most likely.
const NOT_UTF8: Code = Code("vib::file::not_utf8");

fn not_utf8(sources: &Sources, file: FileId) -> Option<Diagnostic> {
    let (offset, byte) = sources.file(file).first_bad_byte?;
    // What stands for the byte is three bytes long.
    let span = Span::new(file, offset, offset + 3);
    let diagnostic = Diagnostic::error(NOT_UTF8, span, "this file is not UTF-8 text")
        .label(format!("byte 0x{byte:02x} belongs to no character"))
        .help("save the file as UTF-8 (plain ASCII is UTF-8 too); a `.vib` file of another program cannot be read");
    Some(diagnostic)
}

/// What says that a number could not be found, rather than that the model is wrong.
const LIMITS: [&str; 11] = [
    "vib::motion::unsettled",
    "vib::rest::not_found",
    "vib::limit::depth",
    "vib::limit::loops",
    "vib::limit::modes",
    "vib::limit::range",
    "vib::limit::states",
    "vib::limit::signal",
    "vib::limit::tolerance",
    "vib::require::undetermined",
    "vib::solve::unsettled",
];

/// What says that a file which the model names could not be read.
const FILES: [&str; 1] = ["vib::table::unreadable"];

impl<T> Outcome<T> {
    /// `None` where nothing failed.
    pub fn failure(&self) -> Option<Failure> {
        let errors: Vec<&str> = self.diagnostics.iter().filter(|d| d.is_error()).map(|error| error.code.0).collect();
        let (first, all) = (errors.first()?, |of: &[&str]| errors.iter().all(|code| of.contains(code)));
        Some(match *first {
            _ if all(&FILES) => Failure::File,
            _ if all(&LIMITS) => Failure::Limit,
            _ => Failure::Model,
        })
    }
}
