//! The cases of a study: the model at other values of its parameters, each with the answers that were requested. In:
//! the text and the values. Out: the columns of a table, and a row for each case. No case depends on another. See
//! docs/method/studies.md.

use super::answer::{Case, Column, Entry, Holds, Value, shown_in};
use super::error::AskedError;
use super::follow::{Unfollowed, follow};
use super::followed::Followed;
use super::lines::Lines;
use super::optimum::settle;
use super::require;
use super::samples::Samples;
use super::trial::{self, Facts, Text};
use crate::analysis::{self, Measurement, Modal, Modes, Poles, Request, Which};
use crate::base::readable::readable;
use crate::base::{Diagnostics, Number, Sources, Unproven};
use crate::dynamics::{self, WrittenOut};
use crate::lower;
use crate::model::scene::{Parameter, Question, Written};
use crate::model::{self, CheckedScene, Overrides, Setting, Swept};
use crate::syntax::tree::Tree;

/// The answers requested for each case, in addition to the requirements of the model.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// The number of lowest modes.
    pub modes: usize,
    pub poles: bool,
    /// Whether parameters that the model determines keep the values that they have in the declared model.
    pub hold_solved: bool,
    /// Simulated time for `peak` and `rms`, s; if not given, it follows from the poles and signals of each case.
    pub until: Option<Number>,
    /// A relative error bound that is small enough for a frequency.
    pub tolerance: f64,
}

/// The parameters that vary, and their values.
#[derive(Clone, Debug)]
pub enum Varied {
    /// Every combination of these values.
    Over(Vec<Swept>),
    /// Random values.
    Drawn(Samples),
}

impl Varied {
    /// The number of cases; at most `u64::MAX`.
    fn count(&self) -> u64 {
        match self {
            Varied::Over(swept) => swept.iter().fold(1, |count: u64, swept| count.saturating_mul(swept.points.count())),
            Varied::Drawn(samples) => samples.draws.count,
        }
    }

    fn parameters(&self) -> Vec<&Parameter> {
        match self {
            Varied::Over(swept) => swept.iter().map(|swept| &swept.parameter).collect(),
            Varied::Drawn(samples) => samples.tolerances.iter().map(|tolerance| &tolerance.parameter).collect(),
        }
    }

    /// The values of a case. In a study of combinations, the last parameter varies fastest.
    fn values(&self, number: u64) -> Vec<Setting> {
        let swept = match self {
            Varied::Over(swept) => swept,
            Varied::Drawn(samples) => return samples.values(number),
        };
        let mut rest = number;
        let mut values: Vec<Setting> = Vec::with_capacity(swept.len());
        for swept in swept.iter().rev() {
            let count = swept.points.count();
            values.push((swept.parameter.name.clone(), swept.quantity(rest % count)));
            rest /= count;
        }
        values.reverse();
        values
    }
}

/// A study of a model.
#[derive(Clone, Debug)]
pub struct Study<'a> {
    pub sources: &'a Sources,
    pub tree: Tree,
    pub overrides: &'a Overrides,
    pub varied: Varied,
    pub asked: Asked,
    /// The values that determined parameters are held at.
    pub held: Vec<Setting>,
    pub columns: Vec<Column>,
    /// The modes as curves, if they are followed.
    pub followed: Option<Followed>,
    /// The number of columns with numbered modes.
    pub(super) width: usize,
    /// The numbers of columns for frequencies and for poles.
    pub(super) sizes: (usize, usize),
    /// Cases that differ in a single parameter.
    pub(super) lines: Lines,
    /// Whether the measure of each requirement has its own column because no other column shows it.
    pub(super) measured: Vec<bool>,
}

/// The reason for a missing value, if only the answers for one case can give it.
const ASK: &str = "`vibc analyze --set ...` with the values of the case says why";

/// The reason why a case has no answers.
type Stopped = &'static str;

impl<'a> Study<'a> {
    /// A study of a scene as declared; its tree holds the requested measures.
    pub fn new(
        (sources, tree, overrides): (&'a Sources, Tree, &'a Overrides),
        scene: &CheckedScene,
        varied: Varied,
        held: Vec<Setting>,
        asked: Asked,
    ) -> Study<'a> {
        let (columns, sizes, measured) = (Vec::new(), (0, 0), Vec::new());
        let mut study = Study {
            sources,
            tree,
            overrides,
            varied,
            asked,
            held,
            columns,
            followed: None,
            width: 0,
            sizes,
            lines: Lines::default(),
            measured,
        };
        let most = [Some(scene.clone()), study.scene_of(0), study.scene_of(study.count().saturating_sub(1))];
        let coordinates = most.iter().flatten().filter_map(|scene| Some(lower::lower(scene).lowered?.system.n()));
        let n = coordinates.max().unwrap_or(0);
        study.sizes = (study.asked.modes.min(n), if study.asked.poles { 2 * n } else { 0 });
        (study.columns, study.measured) = study.columns_of(scene);
        study.width = study.columns.len();
        study
    }

    /// The number of cases; at most `u64::MAX`.
    pub fn count(&self) -> u64 {
        self.varied.count()
    }

    /// Follows the modes, so that columns and rows are those of curves. `orders`: multiples of the parameter, a rate of
    /// rotation.
    pub fn follow(&mut self, orders: &[u32]) -> Result<(), Unfollowed> {
        let followed = follow(self, orders)?;
        self.columns = followed.columns(&self.columns, self.sizes.0);
        self.followed = Some(followed);
        Ok(())
    }

    /// The number of columns of frequencies.
    pub(super) fn frequencies_asked(&self) -> usize {
        self.sizes.0
    }

    pub(super) fn values(&self, number: u64) -> Vec<Setting> {
        self.varied.values(number)
    }

    /// The model with these values of the parameters.
    pub(super) fn scene_at(&self, values: &[Setting]) -> Option<CheckedScene> {
        model::check_with(self.sources, &self.tree, self.overrides, &[&self.held[..], values].concat()).scene
    }

    fn scene_of(&self, number: u64) -> Option<CheckedScene> {
        self.scene_at(&self.values(number))
    }

    fn columns_of(&self, scene: &CheckedScene) -> (Vec<Column>, Vec<bool>) {
        let scene = scene.scene();
        let column = |name: String, unit: &str, holds| Column { name, unit: unit.to_string(), holds };
        let mut list: Vec<Column> = Vec::new();
        for parameter in self.varied.parameters() {
            list.push(column(parameter.name.clone(), &parameter.unit.text, Holds::Parameter));
        }
        if !self.asked.hold_solved {
            let varied = scene.optima.iter().flat_map(|optimum| &optimum.varied).map(|varied| &varied.parameter);
            for parameter in scene.solves.iter().map(|solve| &solve.parameter).chain(varied) {
                list.push(column(parameter.name.clone(), &parameter.unit.text, Holds::Determined));
            }
        }
        for mode in 1..=self.sizes.0 {
            list.push(column(format!("frequency_{mode}"), "Hz", Holds::Frequency));
        }
        for pole in 1..=self.sizes.1 {
            list.push(column(format!("pole_{pole}_re"), "1/s", Holds::PoleRe));
            list.push(column(format!("pole_{pole}_im"), "rad/s", Holds::PoleIm));
        }
        let mut measured = Vec::with_capacity(scene.requires.len());
        for require in &scene.requires {
            let of_measure = self.measure_column(&require.question, Holds::Required);
            measured.push(require.comparison.is_some() && !list.contains(&of_measure));
            if measured.ends_with(&[true]) {
                list.push(of_measure);
            }
            let verdict = require.question.name(&one_line(self.sources.slice(require.span)));
            list.push(column(verdict, "", Holds::Verdict));
        }
        list.extend(scene.asked.iter().map(|question| self.measure_column(question, Holds::Measure)));
        (list, measured)
    }

    fn measure_column(&self, question: &Question, holds: Holds) -> Column {
        let name = question.name(&one_line(self.sources.slice(question.span)));
        Column { name, unit: question.unit.text.clone(), holds }
    }

    /// Whether only the lowest frequencies and the poles are requested.
    pub(super) fn asks_modes_alone(&self) -> bool {
        use Holds::{Curve, Frequency, Link, Parameter, PoleIm, PoleRe};
        let is_of_modes =
            |column: &Column| matches!(column.holds, Parameter | Frequency | Curve | Link | PoleRe | PoleIm);
        self.columns.iter().all(is_of_modes) && self.sizes != (0, 0)
    }

    /// The columns of the parameters.
    pub(super) fn parameter_entries(&self, values: &[Setting]) -> Vec<Entry> {
        let parameters = self.varied.parameters();
        let entry = |(parameter, (_, quantity)): (&Parameter, &Setting)| {
            Entry::Enclosed(shown_in(&quantity.si, &parameter.unit, false).number)
        };
        parameters.into_iter().zip(values).map(entry).collect()
    }

    /// The row of a case, by the methods of `analyze`.
    pub fn case(&self, number: u64) -> Case {
        let values = self.values(number);
        let mut entries = self.parameter_entries(&values);
        let code = match self.answers(&values, &mut entries) {
            Ok(warned) => warned,
            Err(code) => {
                // An answer found before the error is left out together with the others.
                entries.truncate(values.len());
                Some(code)
            }
        };
        entries.resize(self.width, Entry::None(None));
        Case { number, entries, code }
    }

    /// Adds the answers for a case and returns the code of a warning about them, if there is one.
    fn answers(&self, values: &[Setting], entries: &mut Vec<Entry>) -> Result<Option<Stopped>, Stopped> {
        let all = [&self.held[..], values].concat();
        let text = Text {
            sources: self.sources,
            tree: &self.tree,
            overrides: self.overrides,
            until: self.asked.until.as_ref(),
            is_usual: false,
            case: &all,
            fixed: &[],
        };
        let checked = model::check_with(self.sources, &self.tree, self.overrides, &all);
        let mut scene = checked.scene.ok_or_else(|| first_code(&checked.diagnostics))?;
        let usual = match text.until.is_none() && trial::asks_of_motion(&scene) {
            true => usual_time(&scene),
            false => None,
        };
        let text = Text { until: text.until.or(usual.as_ref()), ..text };
        let mut warned = None;
        if scene.scene().determines_parameters() && !self.asked.hold_solved {
            let settled = settle(&text, &scene, false).map_err(|errors| code_of(&errors))?;
            warned = settled.unsettled.first().map(|warning| warning.to_diagnostic().code.0);
            for solved in &settled.solved {
                entries.push(determined_entry(&solved.value, solved.bound, &solved.unit));
            }
            for parameter in settled.optimised.iter().flat_map(|optimised| &optimised.parameters) {
                entries.push(determined_entry(&parameter.value, parameter.bound, &parameter.unit));
            }
            scene = settled.scene;
        }
        self.measure(&text, &scene, entries)?;
        Ok(warned)
    }

    /// Adds the frequencies, poles and measures of a scene.
    fn measure(&self, text: &Text, scene: &CheckedScene, entries: &mut Vec<Entry>) -> Result<(), Stopped> {
        let mut diagnostics = Diagnostics::new();
        let written = dynamics::lower_written_out(scene, &mut diagnostics);
        let mut written = written.ok_or_else(|| first_code(&diagnostics))?;
        if !written.lowered.rest.is_proven() {
            return Err(lower::error::UNPROVEN.0);
        }
        let spectrum = self.spectrum(&written)?;
        if let Some((modes, poles)) = &spectrum {
            let frequencies = modes.list.iter().map(|mode| mode.frequency().map_or(Entry::None(None), Entry::Enclosed));
            pad(entries, frequencies, self.sizes.0);
            let poles = poles.iter().flat_map(|poles| &poles.list);
            let parts = poles.flat_map(|pole| [Entry::Enclosed(pole.re), Entry::Enclosed(pole.im)]);
            pad(entries, parts, 2 * self.sizes.1);
        }
        let scene_of = scene.scene();
        if scene_of.requires.is_empty() && scene_of.asked.is_empty() {
            return Ok(());
        }
        let complete = spectrum.as_ref().filter(|(modes, _)| modes.is_complete());
        if let Some((modes, _)) = complete {
            written.modes.get_or_insert_with(|| modes.clone());
        }
        let both = complete.and_then(|(modes, poles)| Some((modes, poles.as_ref()?)));
        let known = Facts { system: Some(&written), spectrum: both.filter(|(_, poles)| poles.left_out == 0) };
        if !scene_of.requires.is_empty() {
            for (requirement, has_column) in require::judge(text, scene, known).iter().zip(&self.measured) {
                let value = match (&requirement.value, requirement.shown_value()) {
                    (_, Some(shown)) => Entry::Enclosed(shown.number),
                    (Value::Infinite, None) => Entry::Infinite,
                    _ => Entry::None(Some(ASK)),
                };
                entries.extend(has_column.then_some(value));
                entries.push(requirement.holds.map_or(Entry::None(None), Entry::Verdict));
            }
        }
        if !scene_of.asked.is_empty() {
            let measured = text.measure_scene(scene, &scene_of.asked, known);
            let measured = measured.unwrap_or_else(|why| vec![Measurement::Failed(why); scene_of.asked.len()]);
            for (question, measured) in scene_of.asked.iter().zip(measured) {
                entries.push(match measured {
                    Measurement::Value(value) => {
                        Entry::Enclosed(shown_in(&Number::Ball(value), &question.unit, false).number)
                    }
                    Measurement::Infinite => Entry::Infinite,
                    Measurement::None(reason) => Entry::None(Some(reason)),
                    Measurement::Failed(_) => Entry::None(Some(ASK)),
                });
            }
        }
        Ok(())
    }

    /// The modes and the poles that the columns need.
    fn spectrum(&self, written: &WrittenOut) -> Result<Option<(Modes, Option<Poles>)>, Stopped> {
        let (system, code) = (&written.lowered.system, |error: analysis::AnalysisError| error.to_diagnostic().code.0);
        if self.asked.poles {
            let found = analysis::modal_from(system, written.modes.as_ref(), &Request::default());
            let Modal { modes, poles, .. } = found.map_err(code)?;
            return Ok(Some((modes, Some(poles))));
        }
        if self.sizes.0 == 0 {
            return Ok(None);
        }
        let lowest = Request { which: Which::Lowest(self.sizes.0), ..Request::default() };
        let modes = written.modes.clone().map_or_else(|| analysis::modes_as(system, &lowest), Ok);
        Ok(Some((modes.map_err(code)?, None)))
    }
}

/// Adds the first `count` entries, with empty ones behind them if there are fewer.
fn pad(to: &mut Vec<Entry>, entries: impl Iterator<Item = Entry>, count: usize) {
    to.extend(entries.chain(std::iter::repeat(Entry::None(None))).take(count));
}

/// A value that the model gives to a parameter, with the bound of its distance from the true one.
fn determined_entry(value: &Number, bound: Option<f64>, unit: &Written) -> Entry {
    let exact = shown_in(value, unit, false).number;
    match bound {
        Some(bound) => Entry::Enclosed(shown_in(&Number::Ball(value.to_ball().widen(bound)), unit, false).number),
        None => Entry::Unproven(Unproven(exact.to_f64())),
    }
}

/// The simulated time of a case, as `analyze` chooses it.
fn usual_time(scene: &CheckedScene) -> Option<Number> {
    let system = dynamics::lower_written_out(scene, &mut Diagnostics::new())?;
    trial::usual_time(scene, &trial::spectrum(&system)?.1)
}

fn first_code(diagnostics: &Diagnostics) -> Stopped {
    diagnostics.iter().find(|finding| finding.is_error()).map_or("", |error| error.code.0)
}

fn code_of(errors: &[AskedError]) -> Stopped {
    errors.first().map_or("", |error| error.to_diagnostic().code.0)
}

/// A text of the model in one line.
fn one_line(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    readable(&words.join(" ")).into_owned()
}
