//! From a checked scene to a damped linear system: lowering, then the damping declared for the whole scene. In: a checked
//! scene. Out: its linear system with the complete C, and the intermediate results. Every analysis of a scene starts
//! here. See docs/method/rest.md, docs/method/linearisation.md and docs/method/response.md.

mod laws;
mod records;

pub use laws::{beyond_tangents, laws_in_code, laws_under_noise, names_of_laws};
pub use records::drifts;

use crate::analysis;
use crate::analysis::damping::{self, Relative};
use crate::analysis::{AnalysisError, Modal, Modes, Request, modal, modal_by_ratio, modal_from, modes, takes_chained};
use crate::base::{Ball, Code, Diagnostic, Diagnostics, Number, ResponseSpectrum, Span};
use crate::lower::{self, Lowered, Rest};
use crate::model::CheckedScene;
use crate::model::scene::{self, Damping};
use crate::system::{Form, LinearSystem, Noise, Signal};

/// A lowered scene with the damping declared for the whole of it.
#[derive(Clone, Debug)]
pub struct Damped {
    /// Rows may be chained if the scene hangs deep.
    pub lowered: Lowered,
    by_modes: Option<ByModes>,
}

/// A damping ratio that every mode has.
#[derive(Clone, Debug)]
struct ByModes {
    ratio: Number,
    /// The result of adding it to C as terms, or why that failed.
    spread: Result<Spread, AnalysisError>,
}

/// The values that are kept when the ratio is expressed as terms of C.
#[derive(Clone, Debug)]
struct Spread {
    /// C without the ratio.
    dampers: Form,
    /// All undamped modes.
    modes: Modes,
}

/// A scene with all of its damping in C and its rows written out over the coordinates.
#[derive(Clone, Debug)]
pub struct WrittenOut {
    pub lowered: Lowered,
    /// All undamped modes, if the damping needed them.
    pub modes: Option<Modes>,
}

/// The linear system of a scene about a proven rest, with its rows written out. Results computed from it are valid for
/// the scene. Made only by [`WrittenOut::about_rest`].
#[derive(Clone, Debug)]
pub struct AboutRest {
    system: LinearSystem,
    modes: Option<Modes>,
}

/// Lowers a scene and adds its damping. `None` after an error, which is among the diagnostics.
pub fn lower_with_damping(scene: &CheckedScene, diagnostics: &mut Diagnostics) -> Option<Damped> {
    let lowered = lower_undamped(scene, diagnostics)?;
    with_damping(scene, lowered, diagnostics).ok()
}

/// Like [`lower_with_damping`], with the rows written out, as most analyses need them.
pub fn lower_written_out(scene: &CheckedScene, diagnostics: &mut Diagnostics) -> Option<WrittenOut> {
    lower_with_damping(scene, diagnostics)?.into_written_out(diagnostics)
}

/// Like [`lower_written_out`], about a rest that is proven.
pub fn about_rest(scene: &CheckedScene, diagnostics: &mut Diagnostics) -> Option<AboutRest> {
    let found = lower_written_out(scene, diagnostics)?.about_rest(diagnostics)?;
    refuse_losses(scene, diagnostics)?;
    Some(found)
}

/// An error for a spring with a loss factor, of which harmonic motion alone takes account.
pub fn refuse_losses(scene: &CheckedScene, diagnostics: &mut Diagnostics) -> Option<()> {
    let Some(lossy) = scene.scene().elements.iter().find(|element| element.law.loss.is_some()) else { return Some(()) };
    let error = AnalysisError::Loss { at: lossy.span };
    diagnostics.push(error.to_diagnostic());
    None
}

/// Like [`about_rest`], for a transfer function, whose matrices are sums of products of entries of rows. An error if
/// there are too many products.
pub fn for_transfer(scene: &CheckedScene, diagnostics: &mut Diagnostics) -> Option<AboutRest> {
    let damped = lower_with_damping(scene, diagnostics)?;
    if let Some(refusal) = too_long_rows(&damped.lowered.system) {
        diagnostics.push(refusal);
        return None;
    }
    damped.into_written_out(diagnostics)?.about_rest(diagnostics)
}

/// Limit on the products of row entries that the matrices of a transfer function are summed from: some ten seconds of work.
const MOST_PRODUCTS: u64 = 50_000_000;

/// The error for rows with too many entries to multiply out: each of n links that hang one below another moves with all
/// links above it, which makes n^3 products.
fn too_long_rows(system: &LinearSystem) -> Option<Diagnostic> {
    let products = system.products();
    let span = system.coordinates.last()?.span;
    (products > MOST_PRODUCTS).then(|| {
        let message = format!(
            "the links of this scene hang so deep that its transfer function would sum {products} products; the limit is \
             {MOST_PRODUCTS}"
        );
        Diagnostic::error(lower::error::TOO_DEEP, span, message)
            .help("use fewer links, or let bodies move on the ground with a freedom clause")
    })
}

/// Lowers a scene, without the damping declared for the whole of it.
pub fn lower_undamped(scene: &CheckedScene, diagnostics: &mut Diagnostics) -> Option<Lowered> {
    let outcome = lower::lower(scene);
    diagnostics.extend(outcome.diagnostics);
    outcome.lowered
}

/// Adds the declared damping to a lowered scene; after an error, returns the lowered scene.
pub fn with_damping(
    scene: &CheckedScene,
    mut lowered: Lowered,
    diagnostics: &mut Diagnostics,
) -> Result<Damped, Box<Lowered>> {
    if spectrum_place(scene).is_some() && refuse_losses(scene, diagnostics).is_none() {
        return Err(Box::new(lowered));
    }
    let mut by_modes = None;
    match &scene.scene().damping {
        None => {}
        Some(Damping::Rayleigh { alpha, beta, span }) => {
            if moves_bases(scene) && flatten(&mut lowered, diagnostics).is_none() {
                return Err(Box::new(lowered));
            }
            diagnostics.extend(rayleigh_relative_to_bases(scene, &mut lowered.system, (alpha, beta), *span));
            damping::rayleigh(&mut lowered.system, alpha, beta);
        }
        Some(Damping::Modal { ratio, span }) => {
            // Modal damping couples all coordinates, so its rows are not short.
            if flatten(&mut lowered, diagnostics).is_none() {
                return Err(Box::new(lowered));
            }
            let spread = match add_modal_damping(&mut lowered.system, ratio) {
                Err(error) if !matches!(error, AnalysisError::TooManyCoordinates { .. }) => {
                    diagnostics.push(error.to_diagnostic());
                    return Err(Box::new(lowered));
                }
                spread => spread,
            };
            if let Ok(Spread { dampers, .. }) = &spread
                && !ratio.is_zero()
            {
                diagnostics.extend(relative_to_bases(scene, &mut lowered.system, dampers.terms().len(), *span));
            }
            by_modes = Some(ByModes { ratio: ratio.clone(), spread });
        }
    }
    Ok(Damped { lowered, by_modes })
}

/// Adds terms to C that give every mode the damping ratio.
fn add_modal_damping(system: &mut LinearSystem, ratio: &Number) -> Result<Spread, AnalysisError> {
    let mut modes = modes(system)?;
    let dampers = system.c.clone();
    damping::modal(system, ratio, &mut modes)?;
    Ok(Spread { dampers, modes })
}

/// Lets damping by modes, the terms of C from number `first` on, act on motion relative to the bases; a warning for a base of
/// which it is not known what follows it.
fn relative_to_bases(
    scene: &CheckedScene,
    system: &mut LinearSystem,
    first: usize,
    damping: Span,
) -> Option<Diagnostic> {
    let scene = scene.scene();
    let bases = scene.inputs.iter().enumerate().filter_map(|(input, of)| Some((input, of.kind.base()?)));
    let mut unknown = None;
    for (input, base) in bases {
        if damping::relative_to(system, first, input).is_none() {
            unknown.get_or_insert(base);
        }
    }
    let base = &scene.bases[unknown?.index()];
    let message = format!(
        "this damping acts against the ground, since it is not known what follows the base `{}` statically",
        scene.words.display(base.name)
    );
    let found = Diagnostic::warning(Code::model("vib::damping::base"), damping, message);
    Some(found.with_related(base.span, "it moves relative to the ground").help(
        "it is known where springs hold every motion and all numbers at the rest are rational; or write dampers: `damper d: base -- body { c = 1 N*s/m }`",
    ))
}

fn moves_bases(scene: &CheckedScene) -> bool {
    scene.scene().inputs.iter().any(|input| input.kind.base().is_some())
}

/// Lets Rayleigh damping act on motion relative to the bases; a note where some motions are damped against the ground all the same,
/// a warning where it is not known what follows a base.
fn rayleigh_relative_to_bases(
    scene: &CheckedScene,
    system: &mut LinearSystem,
    (alpha, beta): (&Number, &Number),
    span: Span,
) -> Option<Diagnostic> {
    let scene = scene.scene();
    let bases = scene.inputs.iter().enumerate().filter_map(|(input, of)| Some((input, of.kind.base()?)));
    let found: Vec<_> = bases
        .map(|(input, base)| (damping::rayleigh_relative_to(system, alpha, beta, input), base))
        .filter(|(found, _)| *found != Relative::Known)
        .collect();
    let unknown = found.iter().find(|(found, _)| *found == Relative::Unknown);
    let (kind, base) = unknown.or(found.first())?;
    let base = &scene.bases[base.index()];
    let (name, code) = (scene.words.display(base.name), Code::model("vib::damping::base"));
    let finding = match kind {
        Relative::Unknown => Diagnostic::warning(
            code,
            span,
            format!("the part of this damping by masses acts against the ground, since it is not known what follows the base `{name}` statically"),
        )
        .help("it is known where springs hold every motion and all numbers at the rest are rational; or write dampers: `damper d: base -- body { c = 1 N*s/m }`"),
        _ => Diagnostic::note(
            code,
            span,
            format!("motions that no spring restrains are damped against the ground, all others relative to the base `{name}`"),
        )
        .help("springs that hold every motion make it relative to the base; or write dampers"),
    };
    Some(finding.with_related(base.span, "it moves relative to the ground"))
}

fn flatten(lowered: &mut Lowered, diagnostics: &mut Diagnostics) -> Option<()> {
    lowered.flatten().map_err(|error| diagnostics.push(error.to_diagnostic())).ok()
}

/// The signals that drive each input of a scene.
pub fn drives(scene: &CheckedScene, diagnostics: &mut Diagnostics) -> Option<Vec<Vec<Signal>>> {
    lower::drives(scene).map_err(|error| diagnostics.push(error.to_diagnostic())).ok()
}

/// The signals of an input as they are declared, and which derivative of the input they are.
pub fn declared_signals(input: &scene::Input, diagnostics: &mut Diagnostics) -> Option<Vec<Signal>> {
    lower::declared_signals(input).map_err(|error| diagnostics.push(error.to_diagnostic())).ok()
}

/// Whether noise acts on a scene.
pub fn has_noise(scene: &CheckedScene) -> bool {
    noise_place(scene).is_some()
}

/// The place of the first noise.
fn noise_place(scene: &CheckedScene) -> Option<Span> {
    let is_noise = |signal: &scene::Signal| matches!(signal, scene::Signal::Noise(_));
    scene.scene().inputs.iter().find(|input| input.signal.iter().any(is_noise)).and_then(|input| input.signal_span)
}

/// The warning that a motion in time is computed without the noise of the scene.
pub fn noise_left_out(scene: &CheckedScene) -> Option<Diagnostic> {
    let message = "noise has no time history: the motion is computed without it";
    let left_out = |span| Diagnostic::note(Code::model("vib::noise::left_out"), span, message);
    noise_place(scene).map(|span| {
        left_out(span).help("`vibc analyze` has root mean squares under noise; `--seed 7` adds a realisation of it")
    })
}

/// The motion at these times, s, that a realisation of the noise by a seed adds.
pub fn realisation(
    scene: &CheckedScene,
    (system, known): (&LinearSystem, Option<&Modes>),
    seed: u64,
    times: &[Number],
) -> Result<Vec<Vec<Ball>>, Box<Diagnostic>> {
    let Some(span) = noise_place(scene) else { return Ok(Vec::new()) };
    let own;
    let modes = match known {
        Some(modes) => modes,
        None => {
            own = modes(system).map_err(|error| Box::new(error.to_diagnostic()))?;
            &own
        }
    };
    let refused = |why: &str| Box::new(Diagnostic::error(Code::model("vib::noise::realisation"), span, why));
    analysis::random::realisation(system, modes, &noises(scene), seed, times).map_err(refused)
}

/// The error that no code is emitted for noise.
pub fn noise_refused(scene: &CheckedScene) -> Option<Diagnostic> {
    let message = "code cannot be emitted for noise, which has no time history";
    let refused = |span| Diagnostic::error(Code::model("vib::noise::emit"), span, message);
    noise_place(scene)
        .map(|span| refused(span).help("leave the signal out: the code then takes this input in each step"))
}

/// The error that no code is emitted for an unbalance whose motion is not built in: it acts through its second
/// derivative, which cannot be found from a value between two samples.
pub fn unbalance_refused(scene: &CheckedScene) -> Option<Diagnostic> {
    let is_unbalance = |input: &&scene::Input| matches!(input.kind, scene::InputKind::Unbalance { .. });
    let input = scene.scene().inputs.iter().find(is_unbalance)?;
    let message = "code cannot take an unbalance from sample to sample, since its force turns in between";
    let refused = Diagnostic::error(Code::model("vib::unbalance::emit"), input.span, message);
    Some(refused.help("build its rotation in by `--signals internal`, or give its components as forces"))
}

/// The place of the first response spectrum.
fn spectrum_place(scene: &CheckedScene) -> Option<Span> {
    let is_spectrum = |signal: &scene::Signal| matches!(signal, scene::Signal::Spectrum(_));
    scene.scene().inputs.iter().find(|input| input.signal.iter().any(is_spectrum)).and_then(|input| input.signal_span)
}

/// The warning that a motion in time is computed without the response spectra of the scene.
pub fn spectrum_left_out(scene: &CheckedScene) -> Option<Diagnostic> {
    let message = "a response spectrum has no time history: the motion is computed without it";
    let left_out = |span| Diagnostic::note(Code::model("vib::spectrum::left_out"), span, message);
    spectrum_place(scene).map(|span| left_out(span).help("`vibc analyze` has the maxima under response spectra"))
}

/// The error that no code is emitted for a response spectrum.
pub fn spectrum_refused(scene: &CheckedScene) -> Option<Diagnostic> {
    let message = "code cannot be emitted for a response spectrum, which has no time history";
    let refused = |span| Diagnostic::error(Code::model("vib::spectrum::emit"), span, message);
    spectrum_place(scene)
        .map(|span| refused(span).help("leave the signal out: the code then takes this input in each step"))
}

/// The response spectra of the inputs.
pub fn spectra(scene: &CheckedScene) -> Vec<(usize, ResponseSpectrum)> {
    lower::spectra(scene)
}

/// The noises of the inputs.
pub fn noises(scene: &CheckedScene) -> Vec<Noise> {
    lower::noises(scene)
}

impl WrittenOut {
    /// The system about a proven rest. An error if the rest is not proven: bounds of numbers about it would say nothing
    /// about the scene.
    pub fn about_rest(self, diagnostics: &mut Diagnostics) -> Option<AboutRest> {
        let WrittenOut { lowered: Lowered { system, rest, .. }, modes } = self;
        if !rest.is_proven() && system.n() > 0 {
            let help = "no number about this place would have a bound that holds for the scene; `vibc analyze` shows where it is. \
                        Draw the scene nearer to its rest, or hold what hardly any spring holds there";
            diagnostics.refuse(lower::error::UNPROVEN, help);
            return None;
        }
        Some(AboutRest { system, modes })
    }
}

impl AboutRest {
    pub fn system(&self) -> &LinearSystem {
        &self.system
    }

    /// The system, and all undamped modes if the damping needed them.
    pub fn into_parts(self) -> (LinearSystem, Option<Modes>) {
        (self.system, self.modes)
    }
}

impl Damped {
    /// Writes the rows over the coordinates alone. An error if C cannot hold the damping, or if the rows would be too
    /// long.
    pub fn into_written_out(mut self, diagnostics: &mut Diagnostics) -> Option<WrittenOut> {
        let modes = match self.by_modes {
            None => None,
            Some(ByModes { spread: Ok(spread), .. }) => Some(spread.modes),
            Some(ByModes { spread: Err(too_many), .. }) => {
                diagnostics.push(too_many.to_diagnostic());
                return None;
            }
        };
        flatten(&mut self.lowered, diagnostics)?;
        Some(WrittenOut { lowered: self.lowered, modes })
    }

    /// Modes and poles of the system. Its rows are written out if the method needs that.
    pub fn modal(&mut self, request: &Request, diagnostics: &mut Diagnostics) -> Option<Modal> {
        let found = self.modal_of_system(request, diagnostics)?;
        Some(without_undecidable(&self.lowered.rest, found))
    }

    fn modal_of_system(&mut self, request: &Request, diagnostics: &mut Diagnostics) -> Option<Modal> {
        let system = &self.lowered.system;
        if system.is_chained() && takes_chained(system, request) {
            match modal(system, request) {
                // With the rows written out there may be a method, or a better explanation of why there is none.
                Err(AnalysisError::NotSparse { .. }) => {}
                found => {
                    return found.map_err(|error| diagnostics.push(error.to_diagnostic())).ok();
                }
            }
        }
        flatten(&mut self.lowered, diagnostics)?;
        let found = match &self.by_modes {
            None => modal(&self.lowered.system, request),
            Some(by_modes) => by_modes.modal(&mut self.lowered.system, request),
        };
        found.map_err(|error| diagnostics.push(error.to_diagnostic())).ok()
    }
}

/// Removes what the system alone does not decide: the stability of a rest that is not proven or at which a law has no
/// tangent, and the sensitivity of modes to the model's numbers if these change the rest as well.
fn without_undecidable(rest: &Rest, mut found: Modal) -> Modal {
    if rest.moves_terms {
        found.modes.list.iter_mut().for_each(|mode| mode.input_condition = None);
    }
    let stability = if rest.has_flat_law() { found.stability.with_flat_law() } else { found.stability };
    Modal { stability: stability.of_rest(rest.is_proven()), ..found }
}

impl ByModes {
    /// Modes and poles in closed form if the dampers do not couple the modes, otherwise from the complete C.
    fn modal(&self, system: &mut LinearSystem, request: &Request) -> Result<Modal, AnalysisError> {
        let Spread { dampers, modes } = match &self.spread {
            Ok(spread) => spread,
            Err(too_many) => {
                let found = modal_by_ratio(system, &self.ratio, None, request)?;
                return found.ok_or_else(|| too_many.clone());
            }
        };
        let whole = std::mem::replace(&mut system.c, dampers.clone());
        let found = modal_by_ratio(system, &self.ratio, Some(modes), request);
        system.c = whole;
        match found? {
            Some(found) => Ok(found),
            None => modal_from(system, Some(modes), request),
        }
    }
}
