//! A trial: the model with some parameters at other values, taken through check, lowering and the measures asked. In: a text
//! and values; out: the measures, or why there are none.

use super::exact;
use super::probe::{Measured, Probe, prepare};
use crate::analysis::{
    AnalysisError, Measurement, Modal, Modes, Poles, Request, Which, modal, modes, modes_as, peak, poles,
};
use crate::base::{Diagnostics, Number, Sources};
use crate::lower::Lowered;
use crate::model::scene::{Measure, Parameter, Question};
use crate::model::{self, CheckedScene, Overrides, Setting};
use crate::syntax::tree::Tree;
use crate::system::{LinearSystem, Signal};
use std::cmp::Ordering;

/// A model's text.
#[derive(Clone, Copy)]
pub struct Text<'a> {
    pub sources: &'a Sources,
    pub tree: &'a Tree,
    pub overrides: &'a Overrides,
    pub stages: Stages<'a>,
    /// How long the motion in time is followed, where that is known, s.
    pub until: Option<&'a Number>,
}

/// A stage: from a scene to what it makes of it, or to findings.
type Stage<'a, T> = &'a dyn Fn(&CheckedScene, &mut Diagnostics) -> Option<T>;

/// The stages that a scene goes through before it can be measured.
#[derive(Clone, Copy)]
pub struct Stages<'a> {
    pub lower: Stage<'a, Lowered>,
    pub drives: Stage<'a, Vec<Vec<Signal>>>,
}

/// What measures of signals need besides the system.
#[derive(Clone, Debug, Default)]
pub struct Context {
    pub drives: Vec<Vec<Signal>>,
    /// How long the motion is followed, s; `None` where nothing says how long.
    pub until: Option<Number>,
}

/// Parts larger than this give their lowest modes alone.
const FEW: usize = 60;

impl Text<'_> {
    /// The scene with some parameters at these values.
    pub fn scene(&self, values: &[Setting]) -> Result<CheckedScene, String> {
        let checked = model::check_with(self.sources, self.tree, self.overrides, values);
        checked.scene.ok_or_else(|| first_error(&checked.diagnostics))
    }

    /// Every parameter, with these values where they are given.
    pub fn parameters(&self, values: &[Setting]) -> Vec<Parameter> {
        model::parameters(self.sources, self.tree, self.overrides, values)
    }

    /// The measures with some parameters at these values. `choose` finds the questions in the scene.
    pub fn measure(
        &self,
        values: &[Setting],
        choose: impl Fn(&CheckedScene) -> Vec<Question>,
    ) -> Result<Vec<Measurement>, String> {
        let scene = self.scene(values)?;
        self.measure_scene(&scene, &choose(&scene), None)
    }

    /// The measures of a scene. `known` modes and poles are not computed again.
    pub fn measure_scene(
        &self,
        scene: &CheckedScene,
        questions: &[Question],
        known: Option<(&Modes, &Poles)>,
    ) -> Result<Vec<Measurement>, String> {
        self.applied(scene, questions, known, |measured, probes| measured.measure(probes))
    }

    /// How the measure of a question compares with its value, decided exactly; `None` where that cannot be done.
    pub fn compared(&self, scene: &CheckedScene, question: &Question) -> Option<Ordering> {
        let questions = std::slice::from_ref(question);
        self.applied(scene, questions, None, |measured, probes| exact::compare(measured, &probes[0], question)).ok()?
    }

    /// Lowers a scene with an output for each question, computes what their probes need, and applies something to it.
    fn applied<T>(
        &self,
        scene: &CheckedScene,
        questions: &[Question],
        known: Option<(&Modes, &Poles)>,
        apply: impl FnOnce(&Measured, &[Probe]) -> T,
    ) -> Result<T, String> {
        let mut with_outputs = scene.scene().clone();
        let probes = prepare(&mut with_outputs, questions);
        let scene = &CheckedScene::new(with_outputs);
        let mut said = Diagnostics::new();
        let lowered = (self.stages.lower)(scene, &mut said).ok_or_else(|| first_error(&said))?;
        let computed = if known.is_none() { Some(computed(&lowered.system, &probes)?) } else { None };
        let (modes, poles) = match (known, &computed) {
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
        let mut said = Diagnostics::new();
        let lowered = (self.stages.lower)(&scene, &mut said).ok_or_else(|| first_error(&said))?;
        modal(&lowered.system, request).map_err(|error| error.to_diagnostic().message)
    }

    /// How long the motion is followed for a measure of it.
    pub fn followed(&self, measure: &Measure) -> Option<Number> {
        matches!(measure, Measure::Peak { .. } | Measure::Rms { .. }).then(|| self.until.cloned()).flatten()
    }

    /// How long the motion of a scene is followed where nobody says it: from its poles and signals. The time stays the same
    /// in all trials, so that measures do not jump with it.
    pub fn usual_time(&self, scene: &CheckedScene) -> Option<Number> {
        let (solves, requires) = (&scene.scene().solves, &scene.scene().requires);
        let questions = solves.iter().map(|s| &s.question).chain(requires.iter().map(|r| &r.question));
        let is_of_time = |measure: &Measure| matches!(measure, Measure::Peak { .. } | Measure::Rms { .. });
        let mut measures = questions.map(|question| &question.measure);
        if !measures.any(is_of_time) {
            return None;
        }
        let mut said = Diagnostics::new();
        let system = (self.stages.lower)(scene, &mut said)?.system;
        let drives = (self.stages.drives)(scene, &mut said)?;
        let poles = poles(&system, &modes(&system).ok()?).ok()?;
        peak::usual_time(&poles, &drives)
    }

    /// The signals, where a probe needs them.
    pub fn context(&self, scene: &CheckedScene, probes: &[Probe]) -> Result<Context, String> {
        if !probes.iter().any(Probe::of_signals) {
            return Ok(Context::default());
        }
        let mut said = Diagnostics::new();
        let drives = (self.stages.drives)(scene, &mut said).ok_or_else(|| first_error(&said))?;
        Ok(Context { drives, until: self.until.cloned() })
    }
}

/// The modes and poles that the probes need.
fn computed(system: &LinearSystem, probes: &[Probe]) -> Result<(Option<Modes>, Option<Poles>), String> {
    if !probes.iter().any(Probe::of_modes) {
        return Ok((None, None));
    }
    let of_poles = probes.iter().any(Probe::of_poles);
    let highest = probes.iter().map(|probe| if let Probe::Frequency(mode) = probe { *mode } else { 0 }).max();
    let lowest = Which::Lowest(highest.unwrap_or(1));
    let said = |error: AnalysisError| error.to_diagnostic().message;
    let found = match of_poles || system.n() <= FEW {
        true => modes(system),
        false => modes_as(system, &Request { which: lowest, ..Request::default() }),
    };
    let modes = found.map_err(said)?;
    let poles = if of_poles { Some(poles(system, &modes).map_err(said)?) } else { None };
    Ok((Some(modes), poles))
}

/// What stopped a trial.
fn first_error(said: &Diagnostics) -> String {
    said.iter().find(|finding| finding.is_error()).map_or_else(String::new, |error| error.message.clone())
}
