//! The lines `minimise` and `maximise`. In: the text and its scene. Out: a value for each parameter that they vary,
//! with the evidence that no other values are better; and the scene with these values and those that `solve`
//! determines. See docs/method/measures.md#optima.
//!
//! # Steps
//! 1. [`settle`]: which line and which `solve` depends on which parameter, and so their order
//! 2. [`search`]: places over all ranges, and a descent from the best of them; for gains by |H| in binary64
//! 3. [`proof`]: for gains, the exact place and the proof that there is none better; for one parameter, by the enclosures of `solve`
//! 4. [`robust`]: where asked for, the same for the worst case within the tolerances

mod proof;
mod robust;
mod search;

use super::answer::{Best, Optimised, OptimisedParameter, Robust, shown_in, shown_text};
use super::error::AskedError;
use super::require::{holds_for, margin};
use super::trial::{Facts, Text};
use super::unknowns::{self, Settled, interpolate, shortest};
use crate::analysis::{Measurement, Stability};
use crate::base::{Ball, Dd, Number, OrderBy, Quantity};
use crate::model::scene::{Measure, Optimum, Question, Varied};
use crate::model::{CheckedScene, Setting};
use search::{Rough, Search, Seen};

/// Finds every parameter that the model varies or solves for. `robust`: what is optimised is the worst case within the tolerances.
pub fn settle(text: &Text, scene: &CheckedScene, robust: bool) -> Result<Settled, Vec<AskedError>> {
    let mut settled = find_optima(text, scene, robust)?;
    let growth = growth(text, &settled.scene);
    settled.unsettled.extend(growth);
    Ok(settled)
}

fn find_optima(text: &Text, scene: &CheckedScene, robust: bool) -> Result<Settled, Vec<AskedError>> {
    let optima = &scene.scene().optima;
    if optima.is_empty() {
        return unknowns::solve(text, scene);
    }
    let all = Lines { text: *text, optima, solves_inside: solves_depend(text, scene), robust: false };
    // Unknowns that do not depend on the optima are solved for first.
    let before = match all.solves_inside || scene.scene().solves.is_empty() {
        true => None,
        false => Some(unknowns::solve(text, scene)?),
    };
    let mut settings = before.as_ref().map_or_else(Vec::new, |settled| settled.settings.clone());
    let mut optimised = Vec::new();
    let mut warnings = Vec::new();
    for index in all.order_lines(&settings)? {
        let (found, values) = match robust {
            true => all.find_robust(index, &settings, scene.scene(), &mut warnings)?,
            false => all.find(index, &settings, &mut warnings)?,
        };
        settings.extend(values);
        optimised.push((index, found));
    }
    optimised.order_by_key(|(index, _)| *index);
    let optimised = optimised.into_iter().map(|(_, found)| found).collect();
    let text = Text { fixed: &settings, ..*text };
    let refused = |why: String| {
        let Optimum { span, question, .. } = &optima[0];
        vec![AskedError::NoOptimum { span: *span, measure: all.measure(question), at: question.span, why }]
    };
    let scene = text.scene(&[]).map_err(refused)?;
    let mut settled = match before {
        Some(before) => Settled { scene, ..before },
        None => unknowns::solve(&text, &scene)?,
    };
    let solved = std::mem::take(&mut settled.settings);
    let own = |(name, _): &&Setting| !settings.iter().any(|(known, _)| known == name);
    let more: Vec<Setting> = solved.iter().filter(own).cloned().collect();
    settled.settings = [settings, more].concat();
    settled.unsettled.extend(warnings);
    Ok(Settled { optimised, ..settled })
}

/// The warning if a free motion grows with the parameters that were found, or may grow where a response is measured. No
/// transfer function shows that, and no undamped frequency.
fn growth(text: &Text, found: &CheckedScene) -> Option<AskedError> {
    let scene = found.scene();
    if scene.requires.iter().any(|require| matches!(require.question.measure, Measure::Stable)) {
        return None;
    }
    let stability = text.stability(found).ok()?;
    let warned = |measure: &Measure, optimum: bool| match stability {
        Stability::Stable | Stability::Neutral => false,
        Stability::Unstable => optimum || measure.is_of_transfer(),
        Stability::Undetermined => measure.is_of_transfer(),
    };
    let proved = stability == Stability::Unstable;
    let optimum = scene.optima.iter().find(|optimum| warned(&optimum.question.measure, true)).map(|optimum| {
        let names = optimum.varied.iter().map(|varied| varied.parameter.name.clone()).collect();
        AskedError::Unstable { span: optimum.span, names, optimum: true, proved }
    });
    let solve = || {
        let solve = scene.solves.iter().find(|solve| warned(&solve.question.measure, false))?;
        let names = vec![solve.parameter.name.clone()];
        Some(AskedError::Unstable { span: solve.span, names, optimum: false, proved })
    };
    optimum.or_else(solve)
}

/// Whether the condition of some `solve` depends on a parameter that is varied.
fn solves_depend(text: &Text, scene: &CheckedScene) -> bool {
    let (optima, solves) = (&scene.scene().optima, &scene.scene().solves);
    if solves.is_empty() {
        return false;
    }
    let middle = solves.iter().map(|solve| (solve.parameter.clone(), interpolate(&solve.low, &solve.high, 1, 3)));
    let middle: Vec<Setting> =
        middle.map(|(parameter, si)| (parameter.name.clone(), Quantity { si, ..parameter.value })).collect();
    let at = |part: i64| {
        let varied = optima.iter().flat_map(|optimum| &optimum.varied);
        let moved = varied.map(|varied| setting(varied, interpolate(&varied.low, &varied.high, part, 5)));
        let settings: Vec<Setting> = middle.iter().cloned().chain(moved).collect();
        let questions =
            |scene: &CheckedScene| scene.scene().solves.iter().map(|solve| solve.question.clone()).collect();
        text.crossings(&settings, questions)
    };
    let (one, other) = (at(1), at(3));
    let known = |list: &[Measurement]| list.iter().all(|measured| matches!(measured, Measurement::Value(_)));
    !matches!((one, other), (Ok(a), Ok(b)) if a == b && known(&a))
}

fn setting(varied: &Varied, si: Number) -> Setting {
    (varied.parameter.name.clone(), Quantity { si, ..varied.parameter.value.clone() })
}

/// All lines and the data that they share.
#[derive(Clone, Copy)]
struct Lines<'a> {
    text: Text<'a>,
    optima: &'a [Optimum],
    /// Whether `solve` is repeated at each trial.
    solves_inside: bool,
    /// Whether the line is about all values within the tolerances.
    robust: bool,
}

/// A measured place.
#[derive(Clone, Debug)]
struct Trial {
    value: Measurement,
    /// The amount by which the worst condition fails, relative to its limit; 0 if all of them hold.
    broken: f64,
    /// Whether a free motion grows, where none may.
    grows: bool,
}

impl Lines<'_> {
    fn measure(&self, question: &Question) -> String {
        question.name(self.text.sources.slice(question.span))
    }

    /// The measure of a line and its conditions, with parameters at these values.
    fn trial(&self, index: usize, settings: &[Setting]) -> Trial {
        let failed = |why: String| Trial { value: Measurement::Failed(why), broken: f64::INFINITY, grows: false };
        let text = Text { fixed: settings, ..self.text };
        let mut scene = match text.scene(&[]) {
            Ok(scene) => scene,
            Err(why) => return failed(why),
        };
        if self.solves_inside {
            scene = match unknowns::solve(&text, &scene) {
                Ok(settled) => settled.scene,
                Err(errors) => {
                    return failed(errors.first().map_or_else(String::new, |error| error.to_diagnostic().message));
                }
            };
        }
        let Some(optimum) = scene.scene().optima.get(index) else { return failed(String::new()) };
        let limits = optimum.limits.clone();
        let questions: Vec<Question> =
            std::iter::once(&optimum.question).chain(limits.iter().map(|limit| &limit.question)).cloned().collect();
        // A response that is never seen because a free motion outgrows it is no design.
        let must_settle = questions.iter().any(|question| question.measure.is_of_transfer());
        let measured = match must_settle {
            true => text.measure_with_growth(&scene, &questions),
            false => text.measure_scene(&scene, &questions, Facts::default()),
        };
        let mut measured = match measured {
            Ok(measured) => measured.into_iter(),
            Err(why) => return failed(why),
        };
        let growth = match must_settle.then(|| measured.next_back()).flatten() {
            Some(Measurement::Value(rate)) => rate.to_f64(),
            _ => 0.0,
        };
        let value = measured.next().unwrap_or(Measurement::None("it could not be computed"));
        let broken = measured.zip(&limits).map(|(measured, limit)| {
            match (holds_for(&measured, limit.comparison, &limit.question.value), &measured, limit.comparison) {
                (Some(true), ..) => 0.0,
                (_, Measurement::Value(value), Some(comparison)) => {
                    (-margin(value, comparison, &limit.question.value).to_f64()).max(f64::MIN_POSITIVE)
                }
                _ => f64::MAX,
            }
        });
        Trial { value, broken: broken.fold(growth, f64::max), grows: growth > 0.0 }
    }

    /// The lines in an order in which each depends on earlier ones only.
    fn order_lines(&self, settings: &[Setting]) -> Result<Vec<usize>, Vec<AskedError>> {
        let count = self.optima.len();
        if count == 1 {
            return Ok(vec![0]);
        }
        let all = |moved: Option<usize>| -> Vec<Setting> {
            let lines = self.optima.iter().enumerate();
            let values = lines.flat_map(|(line, optimum)| {
                let part = if moved == Some(line) { 3 } else { 2 };
                optimum
                    .varied
                    .iter()
                    .map(move |varied| setting(varied, interpolate(&varied.low, &varied.high, part, 5)))
            });
            settings.iter().cloned().chain(values).collect()
        };
        let here: Vec<Trial> = (0..count).map(|line| self.trial(line, &all(None))).collect();
        let depends = |line: usize, on: usize| {
            let there = self.trial(line, &all(Some(on)));
            line != on && (there.value != here[line].value || there.broken != here[line].broken)
        };
        let depends: Vec<Vec<bool>> = (0..count).map(|line| (0..count).map(|on| depends(line, on)).collect()).collect();
        let mut order: Vec<usize> = Vec::new();
        while order.len() < count {
            let left = |line: &usize| !order.contains(line);
            let ready = |line: &usize| (0..count).all(|on| !depends[*line][on] || order.contains(&on));
            let Some(next) = (0..count).filter(left).find(ready) else {
                let lines: Vec<usize> = (0..count).filter(left).collect();
                let others = lines[1..].iter().map(|&line| self.optima[line].span).collect();
                return Err(vec![AskedError::Circle { span: self.optima[lines[0]].span, others }]);
            };
            order.push(next);
        }
        Ok(order)
    }

    /// The optimum of one line, and the settings for it.
    fn find(
        &self,
        index: usize,
        settings: &[Setting],
        warnings: &mut Vec<AskedError>,
    ) -> Result<(Optimised, Vec<Setting>), Vec<AskedError>> {
        let (best, count) = self.locate(index, settings)?;
        Ok(self.with_remarks(index, (best, count), None, warnings))
    }

    /// The place of the optimum of one line, and the number of places that were measured.
    fn locate(&self, index: usize, settings: &[Setting]) -> Result<(Outcome, usize), Vec<AskedError>> {
        let optimum = &self.optima[index];
        let with = |values: &[Number]| -> Vec<Setting> {
            let own = optimum.varied.iter().zip(values).map(|(varied, si)| setting(varied, si.clone()));
            settings.iter().cloned().chain(own).collect()
        };
        let trial = |values: &[Number]| self.trial(index, &with(values));
        let mut search = Search::new(optimum, &trial, self.solves_inside);
        let peaks = self.rough_peaks(index, settings);
        let rough = peaks.as_ref().map(|peaks| |values: &[Number]| peaks.highest(values));
        let rough = rough.as_ref().map(|rough| rough as &Rough);
        let seen = search.run(rough).map_err(|why| vec![self.no_optimum(optimum, why)])?;
        if let Some(plateau) = self.plateau(optimum, &mut search, &seen) {
            return Err(vec![plateau]);
        }
        let proved = self.prove(index, settings, &seen, &mut search);
        Ok((proved.unwrap_or_else(|| search.finish(seen).into()), search.count()))
    }

    /// The answer to a line, and the settings for it.
    fn with_remarks(
        &self,
        index: usize,
        (best, evaluations): (Outcome, usize),
        robust: Option<Robust>,
        warnings: &mut Vec<AskedError>,
    ) -> (Optimised, Vec<Setting>) {
        let optimum = &self.optima[index];
        let values: Vec<Number> = best.values.clone();
        let at_end = |i: usize| values[i] == optimum.varied[i].low || values[i] == optimum.varied[i].high;
        for (i, varied) in optimum.varied.iter().enumerate().filter(|(i, _)| at_end(*i)) {
            let (name, unit) = (varied.parameter.name.clone(), &varied.parameter.unit);
            let value = shown_text(&shown_in(&values[i], unit, false));
            let is_low = values[i] == varied.low;
            warnings.push(AskedError::AtAnEnd { span: varied.span, name, value, is_low, highest: optimum.highest });
        }
        let parameters = optimum.varied.iter().zip(&values).zip(&best.within);
        let parameters = parameters.map(|((varied, value), within)| OptimisedParameter {
            parameter: varied.parameter.name.clone(),
            span: varied.span,
            value: value.clone(),
            unit: varied.parameter.unit.clone(),
            bound: *within,
        });
        let found = Optimised {
            highest: optimum.highest,
            span: optimum.span,
            measure: self.measure(&optimum.question),
            value: best.value,
            unit: optimum.question.unit.clone(),
            parameters: parameters.collect(),
            best: best.best,
            equal: best.equal,
            evaluations,
            until: self.text.simulated_time(&optimum.question.measure),
            robust,
        };
        let own = optimum.varied.iter().zip(values).map(|(varied, si)| setting(varied, si)).collect();
        (found, own)
    }

    /// The error if nothing was found.
    fn no_optimum(&self, optimum: &Optimum, why: search::Nothing) -> AskedError {
        let (span, measure, at) = (optimum.span, self.measure(&optimum.question), optimum.question.span);
        match why {
            search::Nothing::NoValue(why) => AskedError::NoOptimum { span, measure, at, why },
            search::Nothing::Unbounded(values) => {
                let text = |(varied, value): (&Varied, &Number)| {
                    format!(
                        "{} = {}",
                        varied.parameter.name,
                        shown_text(&shown_in(value, &varied.parameter.unit, false))
                    )
                };
                let place: Vec<String> = optimum.varied.iter().zip(&values).map(text).collect();
                AskedError::NoOptimum { span, measure, at, why: format!("it is infinite at {}", place.join(", ")) }
            }
            search::Nothing::Broken { grows, .. } if optimum.limits.is_empty() && grows => {
                let why = "a free motion grows at each of the values that were tried".to_string();
                AskedError::NoOptimum { span, measure, at, why }
            }
            search::Nothing::Broken { tried, grows } => {
                let at = optimum.limits.first().map_or(span, |limit| limit.span);
                AskedError::NeverMet { span: at, tried, grows, robust: self.robust }
            }
        }
    }

    /// The error if a parameter has no effect around the place that was found.
    fn plateau(&self, optimum: &Optimum, search: &mut Search, seen: &Seen) -> Option<AskedError> {
        let flat = |i: &usize| search.is_flat(seen, *i);
        let idle = (0..optimum.varied.len()).filter(flat).collect::<Vec<_>>();
        let varied = &optimum.varied[*idle.first()?];
        let (name, measure) = (varied.parameter.name.clone(), self.measure(&optimum.question));
        let value = shown_text(&shown_in(&seen.values[idle[0]], &varied.parameter.unit, false));
        Some(AskedError::Plateau { span: varied.span, name, value, measure, at: optimum.question.span })
    }
}

/// A place, and the results of its proof.
struct Outcome {
    values: Vec<Number>,
    value: Ball,
    within: Vec<Option<f64>>,
    best: Best,
    equal: Vec<f64>,
}

impl From<Seen> for Outcome {
    fn from(seen: Seen) -> Outcome {
        let within = vec![None; seen.values.len()];
        Outcome { values: seen.values, value: seen.value, within, best: Best::Seen, equal: Vec::new() }
    }
}

/// The number with the fewest digits within this relative distance of a parameter's value.
fn short(varied: &Varied, near: Dd, within: f64) -> Number {
    shortest(&super::search::Root::seen_root(near, within), varied.parameter.unit.factor.as_ref())
}
