//! A trial: the model with some parameters at other values, checked, lowered and measured. In: a text and values. Out:
//! the measures, or the reason why there are none.

use super::exact;
use super::probe::{Measured, Plan, Probe, prepare, prepare_crossings, prepare_with_growth};
use super::range_enclosure::{Centre, Drive, QuestionOverRange};
use crate::analysis::measures::{self, Loads};
use crate::analysis::range::Family;
use crate::analysis::{
    AnalysisError, Measurement, Modal, Modes, Poles, Request, Stability, Which, is_passive, modal_from, modes,
    modes_as, peak, poles,
};
use crate::base::number::jet;
use crate::base::{Diagnostics, Number, Sources};
use crate::dynamics::{self, WrittenOut};
use crate::lower::Lowered;
use crate::lower::rest::Rest;
use crate::model::scene::{Damping, Measure, Parameter, Question, Scene};
use crate::model::{self, CheckedScene, Overrides, Setting};
use crate::syntax::tree::Tree;
use crate::system::{LinearSystem, Noise, Signal};
use std::cmp::Ordering;

/// A model's text.
#[derive(Clone, Copy)]
pub struct Text<'a> {
    pub sources: &'a Sources,
    pub tree: &'a Tree,
    pub overrides: &'a Overrides,
    /// Simulated time, s, if it is known.
    pub until: Option<&'a Number>,
    /// Whether that is the usual time of the model, which other values change.
    pub is_usual: bool,
    /// The values of a case of a study, which stay the same in all trials.
    pub case: &'a [Setting],
    /// Values that stay the same in all trials of a search.
    pub fixed: &'a [Setting],
}

/// The data that measures of signals need in addition to the system.
#[derive(Clone, Debug, Default)]
pub struct Context {
    pub drives: Vec<Vec<Signal>>,
    pub noises: Vec<Noise>,
    /// Simulated time, s; `None` if nothing specifies it.
    pub until: Option<Number>,
}

/// Results about a scene that need not be computed again.
#[derive(Clone, Copy, Debug, Default)]
pub struct Facts<'a> {
    pub system: Option<&'a WrittenOut>,
    /// All modes and poles.
    pub spectrum: Option<(&'a Modes, &'a Poles)>,
}

/// A scene with some parameters anywhere in ranges, and questions about it.
pub struct Ranged {
    pub scene: CheckedScene,
    pub lowered: Lowered,
    /// Whether the system has its damping: one by modes cannot be enclosed.
    pub is_damped: bool,
    pub questions: Vec<Question>,
    pub probes: Vec<Probe>,
    pub context: Context,
    pub loads: Loads,
}

/// In larger systems, only the lowest modes are computed if no poles are needed.
const FEW: usize = 60;

impl Text<'_> {
    /// The scene with some parameters at these values.
    pub fn scene(&self, values: &[Setting]) -> Result<CheckedScene, String> {
        let checked = match (self.case, self.fixed) {
            ([], []) => model::check_with(self.sources, self.tree, self.overrides, values),
            (case, fixed) => {
                model::check_with(self.sources, self.tree, self.overrides, &[case, fixed, values].concat())
            }
        };
        checked.scene.ok_or_else(|| first_error(&checked.diagnostics))
    }

    /// All parameters, at the given values if there are any.
    pub fn parameters(&self, values: &[Setting]) -> Vec<Parameter> {
        model::parameters(self.sources, self.tree, self.overrides, &[self.case, self.fixed, values].concat())
    }

    /// The measures with some parameters at these values. `choose` finds the questions in the scene.
    pub fn measure(
        &self,
        values: &[Setting],
        choose: impl Fn(&CheckedScene) -> Vec<Question>,
    ) -> Result<Vec<Measurement>, String> {
        let scene = self.scene(values)?;
        self.measure_scene(&scene, &choose(&scene), Facts::default())
    }

    /// The measures that `solve` needs, with some parameters at these values (see [`prepare_crossings`]).
    pub fn crossings(
        &self,
        values: &[Setting],
        choose: impl Fn(&CheckedScene) -> Vec<Question>,
    ) -> Result<Vec<Measurement>, String> {
        let scene = self.scene(values)?;
        let questions = choose(&scene);
        self.with_measured(&scene, &questions, Facts::default(), &prepare_crossings, |measured, probes| {
            measured.measure(probes)
        })
    }

    /// The eigenvalue or the pole that the measure of a question depends on.
    pub fn centre(&self, values: &[Setting], choose: impl Fn(&CheckedScene) -> Option<Question>) -> Option<Centre> {
        let scene = self.scene(values).ok()?;
        let question = choose(&scene)?;
        let found = self.with_measured(
            &scene,
            std::slice::from_ref(&question),
            Facts::default(),
            &prepare,
            |measured, probes| match &probes[0] {
                Probe::Frequency(mode) => {
                    let mode = mode.checked_sub(1).and_then(|i| measured.modes?.list.get(i))?;
                    Some(Centre::Eigenvalue(mode.omega_squared))
                }
                Probe::Damping(motion) => {
                    let pole = measures::damped_motion(measured.poles?, *motion).ok()?;
                    Some(Centre::Pole(pole.re, pole.im))
                }
                _ => Some(Centre::None),
            },
        );
        found.ok()?
    }

    /// Encloses the measure of a question while some of the values are ranges ([`crate::base::Jet`]).
    pub fn enclose_over<T>(
        &self,
        values: &[Setting],
        choose: impl Fn(&CheckedScene) -> Option<Question>,
        tell: impl FnOnce(&QuestionOverRange) -> T,
    ) -> Option<T> {
        let (prepared, lost) = jet::watch_divisions(|| self.prepare(values, choose));
        let (scene, question, probe, lowered, context) = prepared?;
        if lowered.rest.may_be_elsewhere() {
            return None;
        }
        let family = Family::of(&lowered.system, lost);
        let measured =
            Measured { scene: scene.scene(), lowered: &lowered, modes: None, poles: None, context: &context };
        let loads = measured.loads();
        let drive = Drive { signals: &context.drives, loads: &loads };
        let course = Family::course(&lowered.system, lost);
        let (family, drive, probe, question) = (family.as_ref(), &drive, &probe, &question);
        Some(tell(&QuestionOverRange { family, course, drive, probe, question }))
    }

    /// The system of a question with some of the values being ranges, and the probe that answers it; `None` also if a
    /// derivative was lost on the way.
    pub fn system_over(
        &self,
        values: &[Setting],
        choose: impl Fn(&CheckedScene) -> Option<Question>,
    ) -> Option<(LinearSystem, Probe)> {
        let (prepared, lost) = jet::watch_divisions(|| self.prepare(values, choose));
        let (_, _, probe, lowered, _) =
            prepared.filter(|(_, _, _, lowered, _)| !lost && !lowered.rest.may_be_elsewhere())?;
        Some((lowered.system, probe))
    }

    /// A scene with values that are ranges, its system and the probes of some questions. `None` if a derivative is lost on the way, or
    /// a question about a number has not one answer for all values.
    pub fn with_ranges(&self, values: &[Setting], choose: impl Fn(&Scene) -> Vec<Question>) -> Option<Ranged> {
        jet::without_division(|| {
            let scene = self.scene(values).ok()?;
            let questions = choose(scene.scene());
            let Plan { probes, readouts } = prepare(scene.scene(), &questions);
            // The mode shapes that define damping by modes cannot be enclosed over ranges.
            let is_damped = !matches!(scene.scene().damping, Some(Damping::Modal { .. }));
            let scene = if is_damped { scene } else { scene.without_damping() };
            let mut lowered = dynamics::lower_written_out(&scene, &mut Diagnostics::new())?.lowered;
            if !lowered.rest.is_proven() || lowered.system.losses.is_some() || lowered.system.is_chained() {
                return None;
            }
            lowered.add_readouts(scene.scene(), readouts).ok()?;
            let context = self.context(&scene, &probes).ok()?;
            let measured =
                Measured { scene: scene.scene(), lowered: &lowered, modes: None, poles: None, context: &context };
            let loads = measured.loads();
            Some(Ranged { scene, lowered, is_damped, questions, probes, context, loads })
        })?
    }

    /// The least and the largest size of the poles, 1/s, without rigid motions.
    pub fn sizes_of_poles(&self, values: &[Setting]) -> Option<(f64, f64)> {
        let modal = self.modal(values, &Request::default()).ok()?;
        let sizes = modal.poles.list.iter().map(|pole| pole.modulus().to_f64()).filter(|size| *size > 0.0);
        let (low, high) = sizes.fold((f64::INFINITY, 0.0f64), |(low, high), size| (low.min(size), high.max(size)));
        (low <= high && high.is_finite()).then_some((low, high))
    }

    /// A scene with values that are ranges, its question and its system.
    fn prepare(
        &self,
        values: &[Setting],
        choose: impl Fn(&CheckedScene) -> Option<Question>,
    ) -> Option<(CheckedScene, Question, Probe, Lowered, Context)> {
        let scene = self.scene(values).ok()?;
        let question = choose(&scene)?;
        let Plan { mut probes, readouts } = prepare_crossings(scene.scene(), std::slice::from_ref(&question));
        let probe = probes.pop()?;
        let scene = match (&scene.scene().damping, &probe) {
            // These measures do not depend on damping.
            (_, Probe::Frequency(_) | Probe::Square(_)) => scene.without_damping(),
            // The mode shapes that define this damping cannot be enclosed over ranges.
            (Some(Damping::Modal { .. }), _) => return None,
            _ => scene,
        };
        let mut diagnostics = Diagnostics::new();
        let mut lowered = dynamics::lower_written_out(&scene, &mut diagnostics)?.lowered;
        let is_enclosed = lowered.rest.is_proven() && lowered.system.losses.is_none();
        lowered.add_readouts(scene.scene(), readouts).ok().filter(|()| is_enclosed)?;
        let context = self.context(&scene, std::slice::from_ref(&probe)).ok()?;
        Some((scene, question, probe, lowered, context))
    }

    /// The measures of a scene.
    pub fn measure_scene(
        &self,
        scene: &CheckedScene,
        questions: &[Question],
        known: Facts,
    ) -> Result<Vec<Measurement>, String> {
        self.with_measured(scene, questions, known, &prepare, |measured, probes| measured.measure(probes))
    }

    /// The measures of a scene, each with whether nothing that drives the scene reaches it.
    pub fn measure_driven(
        &self,
        scene: &CheckedScene,
        questions: &[Question],
        known: Facts,
    ) -> Result<Vec<(Measurement, bool)>, String> {
        self.with_measured(scene, questions, known, &prepare, |measured, probes| {
            let is_still = probes.iter().map(|probe| measured.is_still(probe));
            measured.measure(probes).into_iter().zip(is_still).collect()
        })
    }

    /// The measures of a scene, and last the rate at which its free motions grow, relative to their poles: zero if none is
    /// proved to grow.
    pub fn measure_with_growth(
        &self,
        scene: &CheckedScene,
        questions: &[Question],
    ) -> Result<Vec<Measurement>, String> {
        let (known, prepare) = (Facts::default(), &prepare_with_growth);
        self.with_measured(scene, questions, known, prepare, |measured, probes| measured.measure(probes))
    }

    /// The verdict about the free motions of a scene.
    pub fn stability(&self, scene: &CheckedScene) -> Result<Stability, String> {
        let prepare = &prepare_with_growth;
        self.with_measured(scene, &[], Facts::default(), prepare, |measured, _| measured.stability())
    }

    /// How the measure of a question compares with its value, decided exactly; `None` if that is not possible.
    pub fn compare(&self, scene: &CheckedScene, question: &Question, known: Facts) -> Option<Ordering> {
        let questions = std::slice::from_ref(question);
        self.with_measured(scene, questions, known, &prepare, |measured, probes| {
            exact::compare(measured, &probes[0], question)
        })
        .ok()?
    }

    /// Gives the system of a scene an output for each question, computes what the probes need, and calls `apply` with it.
    fn with_measured<T>(
        &self,
        scene: &CheckedScene,
        questions: &[Question],
        known: Facts,
        prepare: &dyn Fn(&Scene, &[Question]) -> Plan,
        apply: impl FnOnce(&Measured, &[Probe]) -> T,
    ) -> Result<T, String> {
        let Plan { probes, readouts } = prepare(scene.scene(), questions);
        let WrittenOut { mut lowered, modes } = match known.system {
            Some(system) => system.clone(),
            None => {
                let mut diagnostics = Diagnostics::new();
                dynamics::lower_written_out(scene, &mut diagnostics).ok_or_else(|| first_error(&diagnostics))?
            }
        };
        lowered.add_readouts(scene.scene(), readouts).map_err(|error| error.to_diagnostic().message)?;
        let computed = match known.spectrum {
            None => Some(compute_spectrum(&lowered.system, modes, &probes)?),
            Some(_) => None,
        };
        let (modes, poles) = match (known.spectrum, &computed) {
            (Some((modes, poles)), _) => (Some(modes), Some(poles)),
            (None, Some((modes, poles))) => (modes.as_ref(), poles.as_ref()),
            (None, None) => (None, None),
        };
        let context = &self.context(scene, &probes)?;
        Ok(apply(&Measured { scene: scene.scene(), lowered: &lowered, modes, poles, context }, &probes))
    }

    /// The modes and poles with some parameters at these values.
    pub fn modal(&self, values: &[Setting], request: &Request) -> Result<Modal, String> {
        let scene = self.scene(values)?;
        let mut diagnostics = Diagnostics::new();
        let WrittenOut { lowered, modes } =
            dynamics::lower_written_out(&scene, &mut diagnostics).ok_or_else(|| first_error(&diagnostics))?;
        modal_from(&lowered.system, modes.as_ref(), request).map_err(|error| error.to_diagnostic().message)
    }

    /// The modes without damping with some parameters at these values.
    pub fn undamped_modes(&self, values: &[Setting], request: &Request) -> Result<Modes, String> {
        let scene = self.scene(values)?.without_damping();
        let mut diagnostics = Diagnostics::new();
        let system = dynamics::lower_written_out(&scene, &mut diagnostics)
            .ok_or_else(|| first_error(&diagnostics))?
            .lowered
            .system;
        modes_as(&system, request).map_err(|error| error.to_diagnostic().message)
    }

    /// Calls `tell` with the systems without and with damping, for values some of which are ranges, about a rest that was found for some of
    /// them; with `None` for a system that cannot be enclosed.
    pub fn family(&self, values: &[Setting], rest: &Rest, tell: impl FnOnce(Option<&Family>, Option<&Family>)) {
        let lowered = |damped: bool| {
            jet::watch_divisions(|| {
                let scene = self.scene(values).ok()?;
                if damped && matches!(scene.scene().damping, Some(Damping::Modal { .. })) {
                    // The mode shapes that define this damping cannot be enclosed with their derivatives.
                    return None;
                }
                let scene = if damped { scene } else { scene.without_damping() };
                let lowered = dynamics::lower_written_out(&scene, &mut Diagnostics::new())?.lowered;
                (lowered.rest.is_proven() && lowered.rest.holds(rest)).then_some(lowered.system)
            })
        };
        let (without, with) = (lowered(false), lowered(true));
        let a = without.0.as_ref().and_then(|system| Family::of(system, without.1));
        let b = with.0.as_ref().and_then(|system| Family::of(system, with.1));
        tell(a.as_ref(), b.as_ref());
    }

    /// The simulated time of the model as declared with some parameters at these values, unless it is given.
    pub fn usual_time_at(&self, values: &[Setting]) -> Option<Number> {
        let scene = self.is_usual.then(|| self.scene(values).ok()).flatten()?;
        let system = dynamics::lower_written_out(&scene, &mut Diagnostics::new())?;
        usual_time(&scene, &spectrum(&system)?.1)
    }

    /// The simulated time for a measure, if it needs one.
    pub fn simulated_time(&self, measure: &Measure) -> Option<Number> {
        measure.is_of_time().then(|| self.until.cloned()).flatten()
    }

    /// The signals, if a probe needs them.
    pub fn context(&self, scene: &CheckedScene, probes: &[Probe]) -> Result<Context, String> {
        if !probes.iter().any(Probe::of_signals) {
            return Ok(Context::default());
        }
        let mut diagnostics = Diagnostics::new();
        let drives = dynamics::drives(scene, &mut diagnostics).ok_or_else(|| first_error(&diagnostics))?;
        Ok(Context { drives, noises: dynamics::noises(scene), until: self.until.cloned() })
    }
}

/// Whether the model asks for measures of its motion in time.
pub fn asks_of_motion(scene: &CheckedScene) -> bool {
    let (solves, requires) = (&scene.scene().solves, &scene.scene().requires);
    let optima = &scene.scene().optima;
    let limits = optima.iter().flat_map(|optimum| &optimum.limits);
    let asked = scene.scene().asked.iter();
    let questions =
        solves.iter().map(|s| &s.question).chain(asked).chain(requires.iter().chain(limits).map(|r| &r.question));
    let mut questions = questions.chain(optima.iter().map(|optimum| &optimum.question));
    questions.any(|question| question.measure.is_of_time())
}

/// All modes and poles of a system.
pub fn spectrum(of: &WrittenOut) -> Option<(Modes, Poles)> {
    let system = &of.lowered.system;
    let modes = of.modes.clone().map_or_else(|| modes(system), Ok).ok()?;
    let poles = poles(system, &modes).ok()?;
    Some((modes, poles))
}

/// Default simulation time of a scene, from its poles and signals.
pub fn usual_time(scene: &CheckedScene, poles: &Poles) -> Option<Number> {
    peak::usual_time(poles, &dynamics::drives(scene, &mut Diagnostics::new())?)
}

/// The modes and poles that the probes need; `known` are all modes.
fn compute_spectrum(
    system: &LinearSystem,
    known: Option<Modes>,
    probes: &[Probe],
) -> Result<(Option<Modes>, Option<Poles>), String> {
    let may_grow = probes.iter().any(Probe::of_growth) && !is_passive(system);
    let of_poles = may_grow || probes.iter().any(Probe::of_poles);
    if !of_poles && !probes.iter().any(Probe::of_modes) {
        return Ok((None, None));
    }
    let takes_all = probes.iter().any(Probe::takes_all_modes);
    let highest = probes.iter().map(Probe::highest_mode).max();
    let lowest = Which::Lowest(highest.unwrap_or(1));
    let diagnostics = |error: AnalysisError| error.to_diagnostic().message;
    let found = match known {
        Some(modes) => Ok(modes),
        None if of_poles || takes_all || system.n() <= FEW => modes(system),
        None => modes_as(system, &Request { which: lowest, ..Request::default() }),
    };
    let modes = found.map_err(diagnostics)?;
    let poles = if of_poles { Some(poles(system, &modes).map_err(diagnostics)?) } else { None };
    Ok((Some(modes), poles))
}

/// The message of the first error of a trial.
fn first_error(diagnostics: &Diagnostics) -> String {
    diagnostics.iter().find(|finding| finding.is_error()).map_or_else(String::new, |error| error.message.clone())
}
