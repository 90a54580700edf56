//! The contents of a page: the modal answer, the figure and its motions, transfer functions, the motion in time,
//! equations in symbols. In: a model's text, or the results that an editor already has. Out: an [`Overview`], which
//! writes the page.

use crate::analysis::fractions::{self, Curve, Parts, Pencil};
use crate::analysis::{self, Methods, Mode, ModeKind, Normalise, Pole, Request, Sweep, Which};
use crate::answers::ModalAnswer;
use crate::answers::report::{self, Options};
use crate::backend::decimal::{certain, certain_whole};
use crate::backend::page::{Answers, Bend, MotionShown, Movement, Movements, Page, PoleShown, Text, TransferShown};
use crate::backend::{draw, equations};
use crate::base::{Diagnostic, Diagnostics, FileId, Number, Sources, Span};
use crate::dynamics::{self, WrittenOut};
use crate::kernel::complex::Complex;
use crate::lower::{Displacement, Mechanism};
use crate::modal::modal_answer;
use crate::model::Overrides;
use crate::model::scene::Scene;
use crate::picture::{self, Figure, Item, Moving};
use crate::questions::answer::{Optimised, Requirement, Solved};
use crate::reading::{self, Reading};
use crate::system::{CoordinateId, Form, LinearSystem, Origin, Output};
use crate::{Outcome, Study};

/// A model as its page shows it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Overview {
    pub answer: ModalAnswer,
    figure: Result<(Figure, Moving), String>,
    movements: Movements,
    poles: Vec<PoleShown>,
    entries: Vec<Vec<Vec<Option<Span>>>>,
    transfer: Option<TransferShown>,
    motion: Option<MotionShown>,
    equations: Option<String>,
}

/// Scenes with more coordinates are not animated: each mode would add that many numbers to the page.
const MOST_MOVING: usize = 120;
/// Maximum number of coordinates for which the second-order motion of loops is computed.
const MOST_BENT: usize = 30;
/// Motions of each kind that a page lets move.
const MOST_MOTIONS: usize = 60;
/// Maximum number of pairs of inputs and outputs with curves.
const MOST_PAIRS: usize = 36;
/// Maximum number of coordinates of a system with transfer functions on a page.
const MOST_CURVES: usize = 300;
/// Maximum number of coordinates of a system whose equations a page solves at each frequency of a curve.
const MOST_SOLVED: usize = 24;
/// Maximum number of coordinates of a scene whose equations are readable in symbols.
const MOST_SYMBOLS: usize = 6;
/// Matrices of more coordinates are left out of a report.
const MOST_ENTRIES: usize = 8;
/// Samples of the motion in time.
const SAMPLES: i64 = 300;
/// Digits of values in figures.
const FIGURE_DIGITS: usize = 4;
const CAPTION_DIGITS: usize = 4;

/// The contents of a model's page.
pub fn overview(sources: &Sources, model: FileId, overrides: &Overrides, study: &Study) -> Outcome<Overview> {
    Outcome::of(|diagnostics| {
        let mut reading = reading::read_for(sources, model, overrides, study, diagnostics)?;
        let damped = dynamics::lower_with_damping(&reading.scene, diagnostics)?;
        let mechanism = damped.lowered.mechanism.clone();
        // A scene too large to be written out has no curves.
        let written = damped.clone().into_written_out(&mut Diagnostics::new());
        let request = Request { which: Which::Usual, ..Request::default() };
        let answer = modal_answer(&mut reading, damped, &request, study, diagnostics).ok()?;
        let mut overview = Overview::of(reading.scene.scene(), answer, &mechanism);
        // About an unproven rest, nothing is computed. Curves and motions are those of poles, which loss factors leave out.
        let is_shown = overview.answer.rest.is_proven() && overview.answer.system.losses.is_none();
        if let Some(written) = written.as_ref().filter(|_| is_shown) {
            overview.transfer = overview.transfer(written);
            overview.motion = overview.motion(&reading, written, study.until, &mechanism);
        }
        if overview.answer.system.n() <= MOST_SYMBOLS {
            let found = crate::equations(sources, model, overrides).answer;
            overview.equations = found.map(|found| symbols(&equations::document(&found)));
        }
        Some(overview)
    })
}

/// The results about a model that an editor already has.
pub(crate) struct Lowered<'a> {
    pub scene: &'a Scene,
    pub system: &'a LinearSystem,
    pub rest: &'a crate::lower::Rest,
    pub mechanism: &'a Mechanism,
    pub modal: &'a analysis::Modal,
    pub solved: &'a [Solved],
    pub optimised: &'a [Optimised],
    pub requirements: &'a [Requirement],
    pub noisy: Vec<analysis::Noisy>,
    pub spectral: analysis::response_spectrum::Spectral,
}

impl Overview {
    pub(crate) fn of_lowered(of: Lowered) -> Overview {
        let answer = ModalAnswer {
            excitations: Vec::new(),
            damped_shapes: Vec::new(),
            nodes: Vec::new(),
            model: of.scene.name.clone(),
            system: of.system.clone(),
            rest: of.rest.clone(),
            modes: of.modal.modes.clone(),
            poles: of.modal.poles.clone(),
            stability: of.modal.stability,
            buckling: None,
            account: None,
            solved: of.solved.to_vec(),
            optimised: of.optimised.to_vec(),
            requirements: of.requirements.to_vec(),
            noisy: of.noisy,
            spectral: of.spectral,
            sensitivities: Vec::new(),
            tolerated: None,
        };
        Overview::of(of.scene, answer, of.mechanism)
    }

    /// The answer with its figure, and how that moves.
    fn of(scene: &Scene, answer: ModalAnswer, mechanism: &Mechanism) -> Overview {
        let digits = |number: &Number| certain_whole(number, FIGURE_DIGITS);
        let figure = picture::animated_figure(scene, mechanism.poses(), &digits).map_err(|refusal| refusal.to_string());
        let n = answer.system.n();
        let mut movements = Movements::default();
        let mut poles = Vec::new();
        if let (Ok((_, moving)), true) = (&figure, n <= MOST_MOVING) {
            movements.basis = (0..n).map(|i| mechanism.displacements(&moving.poses, &unit(n, i))).collect();
            movements.bends = bends(mechanism, moving, &movements.basis);
            let modes = answer.modes.with_numbers().take(MOST_MOTIONS);
            movements.list =
                modes.map(|(number, mode)| of_mode(number, mode, answer.rest.is_proven(), mechanism, moving)).collect();
            poles = damped_motions(&answer, mechanism, moving, &mut movements.list);
        }
        let entries = if n <= MOST_ENTRIES { entries(scene, &answer.system) } else { Vec::new() };
        Overview { answer, figure, movements, poles, entries, transfer: None, motion: None, equations: None }
    }

    fn transfer(&self, written: &WrittenOut) -> Option<TransferShown> {
        let (system, modes, poles) = (&written.lowered.system, &self.answer.modes, &self.answer.poles);
        let (inputs, outputs) = (system.inputs.len(), system.outputs.len());
        let few = inputs * outputs <= MOST_PAIRS && system.n() <= MOST_CURVES;
        if inputs * outputs == 0 || !few || !modes.is_complete() || poles.left_out > 0 {
            return None;
        }
        let sweep = Sweep { inputs: (0..inputs).collect(), outputs: (0..outputs).collect(), ..Sweep::default() };
        let table = analysis::table(&Methods::of(system, modes), poles, &sweep).ok()?;
        let pencil = Pencil::of(system);
        let parts = pencil.as_ref().and_then(|pencil| Parts::of(system, modes, poles, pencil));
        let curve = |i: usize, o: usize| {
            let found = parts.as_ref().map(|parts| parts.between(system, i, o));
            match found.filter(|found| found.agree(&table, i, o)) {
                Some(found) => Some(Curve::Fractions(found)),
                None if system.n() > MOST_SOLVED => None,
                None => pencil.as_ref()?.solve_equations(system, &table, (i, o)).map(Curve::Solved),
            }
        };
        let curves: Vec<Vec<Option<Curve>>> =
            (0..inputs).map(|i| (0..outputs).map(|o| curve(i, o)).collect()).collect();
        let is_solved = |curve: &Option<Curve>| matches!(curve, Some(Curve::Solved(_)));
        let pencil = pencil.filter(|_| curves.iter().flatten().any(is_solved));
        let reports = report::transfer(&self.answer.model, system, &table);
        let hertz = |omega: f64| omega / (2.0 * std::f64::consts::PI);
        let of_poles =
            poles.list.iter().flat_map(|pole| [hertz(pole.modulus().mid.to_f64()), hertz(pole.im.mid.to_f64())]);
        let extrema = table.extrema.iter().flatten().flatten().flat_map(|extrema| &extrema.list);
        let mut centres: Vec<f64> =
            of_poles.chain(extrema.map(|extremum| extremum.frequency.mid.to_f64())).filter(|f| *f > 0.0).collect();
        centres.sort_by(f64::total_cmp);
        centres.dedup();
        Some(TransferShown { table, curves, pencil, reports, centres })
    }

    fn motion(
        &self,
        reading: &Reading,
        written: &WrittenOut,
        until: Option<&Number>,
        mechanism: &Mechanism,
    ) -> Option<MotionShown> {
        let (Ok((_, moving)), true) = (&self.figure, !self.movements.basis.is_empty()) else { return None };
        let mut quiet = Diagnostics::new();
        let drives = dynamics::drives(&reading.scene, &mut quiet)?;
        let own = &written.lowered.system;
        if drives.iter().all(Vec::is_empty) && own.initial.is_empty() {
            return None;
        }
        let outputs = &reading.scene.scene().outputs;
        if outputs
            .first()
            .is_some_and(|first| analysis::refuse_too_many(SAMPLES as usize + 1, outputs.len(), first.span).is_err())
        {
            return None;
        }
        let until = until.cloned().or_else(|| analysis::peak::usual_time(&self.answer.poles, &drives))?;
        let times = analysis::grid(&until, &(&until / &Number::from(SAMPLES)));
        // The coordinates are outputs too: the figure moves with them.
        let (outputs, n) = (own.outputs.len(), own.n());
        let mut system = own.clone();
        system.outputs.extend((0..n).map(|i| Output {
            name: own.coordinates[i].name,
            unit: String::new(),
            p: [vec![(CoordinateId(i as u32), Number::ONE)], Vec::new(), Vec::new()],
            d: Default::default(),
        }));
        let mut history = analysis::respond_with(&system, written.modes.as_ref(), &drives, &times).ok()?;
        let mut states = Vec::with_capacity(history.values.len());
        let mut largest = vec![0.0f64; n];
        for row in &mut history.values {
            let state: Vec<f64> = row.split_off(outputs).iter().map(|value| value.mid.to_f64()).collect();
            largest.iter_mut().zip(&state).for_each(|(largest, x)| *largest = largest.max(x.abs()));
            states.push(state);
        }
        let amount = moving.amount(&mechanism.displacements(&moving.poses, &largest));
        let steady = analysis::steady_alone(own, &drives);
        let report = report::motion(&self.answer.model, own, &history, &steady);
        Some(MotionShown { history, states, amount, report })
    }

    /// The page. `of`: the texts that this is the overview of.
    pub fn page(&self, of: (&Sources, FileId), shown: &Shown) -> String {
        let mut report = report::modal(&self.answer, &Options { matrices: false, ..Options::default() });
        // Beside an editor, poles are shown as soon as they are known.
        if shown.without_text && self.answer.poles.list.is_empty() && !self.answer.system.c.is_empty() {
            report.sections.retain(|section| section.heading != "Damped motion");
        }
        let answers = Answers {
            system: &self.answer.system,
            figure: self.figure.as_ref().map_err(String::as_str),
            movements: &self.movements,
            report: &report,
            entries: &self.entries,
            equations: self.equations.as_deref(),
            poles: &self.poles,
            transfer: self.transfer.as_ref(),
            motion: self.motion.as_ref(),
            sensitivities: &self.answer.sensitivities,
        };
        page(&self.answer.model, of, shown, Some(answers))
    }
}

/// The sections of the equations, with headings.
fn symbols(document: &equations::Document) -> String {
    let section = |section: &equations::Section| {
        format!("<h3>{}</h3>\n{}", draw::escape(section.heading), equations::mathml_section(section))
    };
    document.sections.iter().map(section).collect()
}

/// Options for a page.
#[derive(Clone, Copy, Default)]
pub struct Shown<'a> {
    /// A newer text than that of the answers, if there is one.
    pub newer: Option<(&'a Sources, FileId)>,
    /// The errors of the newest text.
    pub findings: &'a [Diagnostic],
    /// Beside an editor, which shows the text itself.
    pub without_text: bool,
    /// The version that is served, if the page asks its server for newer ones.
    pub version: Option<u64>,
}

/// The page of a model that has never been without errors.
pub fn page_of_errors(name: &str, of: (&Sources, FileId), shown: &Shown) -> String {
    page(name, of, shown, None)
}

fn page(name: &str, of: (&Sources, FileId), shown: &Shown, answers: Option<Answers>) -> String {
    let text = |(sources, model)| Text { sources, model };
    crate::backend::page::page(&Page {
        name,
        of: text(of),
        text: text(shown.newer.unwrap_or(of)),
        shows_text: !shown.without_text,
        findings: shown.findings,
        version: shown.version,
        answers,
    })
}

fn unit(n: usize, i: usize) -> Vec<f64> {
    let mut unit = vec![0.0; n];
    unit[i] = 1.0;
    unit
}

/// The second-order motion of loops for each product of two coordinates: the bend of both together, minus those of each
/// alone.
fn bends(mechanism: &Mechanism, moving: &Moving, basis: &[Vec<Displacement>]) -> Vec<Bend> {
    let n = basis.len();
    if n > MOST_BENT || !mechanism.closes_loops() {
        return Vec::new();
    }
    let alone = |i: usize| basis[i].iter().map(|by| by.bend);
    let mut list = Vec::new();
    for i in 0..n {
        list.push(Bend { by: [i, i], values: alone(i).collect() });
        for j in 0..i {
            let mut both = unit(n, i);
            both[j] = 1.0;
            let both = mechanism.displacements(&moving.poses, &both);
            let values = both.iter().zip(alone(i).zip(alone(j))).map(|(both, (one, other))| both.bend - one - other);
            list.push(Bend { by: [i, j], values: values.collect() });
        }
    }
    list.retain(|bend| bend.values.iter().any(|value| *value != 0.0));
    list
}

fn of_mode(number: usize, mode: &Mode, proven: bool, mechanism: &Mechanism, moving: &Moving) -> Movement {
    let shape: Vec<f64> = analysis::normalise(mode, Normalise::Translation).iter().map(|x| x.0).collect();
    let omega = mode.omega.mid.to_f64();
    let s = match mode.kind {
        ModeKind::Oscillation => Complex::new(0.0, omega),
        ModeKind::Divergence => Complex::new(omega, 0.0),
        ModeKind::Rigid | ModeKind::Undetermined => Complex::new(0.0, 0.0),
    };
    let energy = mode.kinetic.iter().chain(&mode.strain);
    let energy = energy.filter_map(|share| {
        let item = match share.of.origin {
            Origin::Body(body) => Item::Body(body as usize),
            Origin::Element(element) => Item::Element(element as usize),
            _ => return None,
        };
        Some((item, share.part.0))
    });
    Movement {
        caption: draw::mode_caption(number as u32, mode, proven),
        s,
        energy: energy.collect(),
        amount: moving.amount(&mechanism.displacements(&moving.poses, &shape)),
        shape: shape.into_iter().map(|x| Complex::new(x, 0.0)).collect(),
    }
}

/// The poles in their plane; those of a damped system move as well.
fn damped_motions(
    answer: &ModalAnswer,
    mechanism: &Mechanism,
    moving: &Moving,
    list: &mut Vec<Movement>,
) -> Vec<PoleShown> {
    let system = &answer.system;
    let pencil = Some(system).filter(|system| !system.c.is_empty() && !system.is_chained()).and_then(Pencil::of);
    let mut shown = Vec::new();
    for (number, pole) in answer.motions().take(MOST_MOTIONS) {
        let caption = match answer.rest.is_proven() {
            true => pole_caption(number, pole),
            false => format!("pole {number}, about a rest that is not proven"),
        };
        let s = fractions::place(pole);
        let shape = pencil.as_ref().and_then(|pencil| pencil.shape(s));
        let movement = shape.map(|shape| {
            let sizes: Vec<f64> = shape.iter().map(|x| libm::hypot(x.re, x.im)).collect();
            let amount = moving.amount(&mechanism.displacements(&moving.poses, &sizes));
            list.push(Movement { caption: caption.clone(), s, shape, amount, energy: Vec::new() });
            list.len() - 1
        });
        shown.push(PoleShown { s, title: caption.clone(), movement });
        if s.im != 0.0 {
            shown.push(PoleShown { s: s.conj(), title: caption, movement });
        }
    }
    shown
}

/// `pole 2: 0.4849 Hz, ζ 0.6276`
fn pole_caption(number: usize, pole: &Pole) -> String {
    if !pole.is_complex() {
        return format!("pole {number}: {}, {} 1/s", pole.kind.name(), certain(&pole.re, CAPTION_DIGITS));
    }
    let frequency = certain(&pole.frequency(), CAPTION_DIGITS);
    match &pole.damping_ratio {
        Some(ratio) => format!("pole {number}: {frequency} Hz, ζ {}", certain(ratio, CAPTION_DIGITS)),
        None => format!("pole {number}: {frequency} Hz"),
    }
}

/// For each entry of M, C and K the declaration of the first item that adds to it.
fn entries(scene: &Scene, system: &LinearSystem) -> Vec<Vec<Vec<Option<Span>>>> {
    let place = |origin: Origin| match origin {
        Origin::Body(body) => scene.bodies.get(body as usize).map(|body| body.span),
        Origin::Element(element) => scene.elements.get(element as usize).map(|element| element.span),
        _ => None,
    };
    let of = |form: &Form| {
        let mut list = vec![vec![None; system.n()]; system.n()];
        for term in form.terms() {
            let (row, span) = (form.row(term), place(form.source_of(term.source).origin));
            for (i, _) in row {
                for (j, _) in row {
                    let entry: &mut Option<Span> = &mut list[i.index()][j.index()];
                    *entry = entry.or(span);
                }
            }
        }
        list
    };
    if system.is_chained() { Vec::new() } else { vec![of(&system.m), of(&system.c), of(&system.k)] }
}
