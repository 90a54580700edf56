//! Optima of the worst case (`--robust`): the values at which the measure, over all values within the tolerances, is at worst as good as
//! it can be. In: a line, and the tolerances. Out: the values, their worst case, and the best that is possible. See
//! docs/method/measures.md#worst-cases.
//!
//! # Steps
//! 1. The search looks at the worst of a few places within the tolerances, at first the declared values alone.
//! 2. A place at which the values that were found are worse than that is added, and the search is repeated (J. W. Blankenship,
//!    J. E. Falk, J. Optim. Theory Appl. 19, 1976, 261): first corners, then what the enclosure over the whole box reaches.

use super::search::{Rough, Search, Seen};
use super::{Lines, Outcome, Trial, setting};
use crate::analysis::Measurement;
use crate::base::{Ball, Bound, Number, OrderBy, Quantity, up};
use crate::model::Setting;
use crate::model::scene::{Optimum, Scene, Tolerance};
use crate::questions::answer::{Best, Optimised, Proved, Robust, Throughout, WorstCase};
use crate::questions::error::AskedError;
use crate::questions::search::to_fraction;
use crate::questions::tolerated::{Design, best_possible, others, parameter, places, varied_tolerances, worst};
use crate::questions::unknowns;

/// How often a place is added at most.
const MOST_ROUNDS: usize = 16;
/// The share by which a place has to be worse to be added.
const WORSE: f64 = 1e-9;
/// Places whose own optimum is proved, those at which the measure is worst.
const MOST_PROVED: usize = 2;

/// A place within the tolerances, as the share of each range that lies below: it moves with the ranges.
type Shares = Vec<Number>;

/// A line with the tolerances.
struct Uncertain<'a> {
    lines: Lines<'a>,
    index: usize,
    settings: &'a [Setting],
    declared: &'a Scene,
}

/// Values of the varied parameters, with their worst case.
struct Candidate {
    values: Vec<Number>,
    worst: Option<WorstCase>,
}

impl Lines<'_> {
    /// Like [`Lines::find`] for the worst case.
    pub(super) fn find_robust(
        &self,
        index: usize,
        settings: &[Setting],
        declared: &Scene,
        warnings: &mut Vec<AskedError>,
    ) -> Result<(Optimised, Vec<Setting>), Vec<AskedError>> {
        let (nominal, count) = self.locate(index, settings)?;
        let line = Uncertain { lines: Lines { robust: true, ..*self }, index, settings, declared };
        if line.free(&line.with(&nominal.values)).is_empty() {
            return Ok(self.with_remarks(index, (nominal, count), None, warnings));
        }
        let (best, evaluations, scenarios) = line.best(&nominal)?;
        let nominal_value = nominal.value;
        let nominal = Candidate { worst: line.worst(&nominal.values), values: nominal.values };
        // A search may miss what the nominal optimum shows.
        let chosen = if line.is_better(&nominal, &best) { &nominal } else { &best };
        let values = &chosen.values;
        let value = self.trial(index, &line.with(values)).value;
        let holds = chosen.worst.as_ref().filter(|worst| !fails(worst));
        let (Some(found), Measurement::Value(value)) = (holds, value) else {
            let why = super::search::Nothing::Broken { tried: count + evaluations, grows: false };
            return Err(vec![line.lines.no_optimum(line.optimum(), why)]);
        };
        let best_possible = line.best_possible(values, found, &scenarios);
        let best = match (found.bound, best_possible) {
            (Some((bound, _)), Some((least, proved))) => {
                let gap = bound - least;
                Best::Everywhere { gap: Bound::by_proof((gap.magnitude() + gap.rad) * up::FEW), proof: proved.into() }
            }
            _ => Best::Seen,
        };
        let free = line.free(&line.with(values));
        let robust = Robust {
            parameters: free.iter().filter_map(parameter).collect(),
            worst: found.clone(),
            nominal: nominal.values.clone(),
            nominal_value,
            nominal_worst: nominal.worst.clone(),
            conditions: line
                .optimum()
                .limits
                .iter()
                .map(|limit| self.text.sources.slice(limit.span).to_string())
                .collect(),
            best_possible,
        };
        let within = vec![None; values.len()];
        let outcome = Outcome { values: values.clone(), value, within, best, equal: Vec::new() };
        Ok(self.with_remarks(index, (outcome, count + evaluations), Some(robust), warnings))
    }
}

impl Uncertain<'_> {
    fn optimum(&self) -> &Optimum {
        &self.lines.optima[self.index]
    }

    /// All values that are known, with those of the varied parameters.
    fn with(&self, values: &[Number]) -> Vec<Setting> {
        let own = self.optimum().varied.iter().zip(values).map(|(varied, si)| setting(varied, si.clone()));
        self.settings.iter().cloned().chain(own).collect()
    }

    /// The same with those that a `solve` determines for them.
    fn held_settings(&self, values: &[Number]) -> Result<Vec<Setting>, String> {
        let held = self.with(values);
        if !self.lines.solves_inside {
            return Ok(held);
        }
        let text = super::Text { fixed: &held, ..self.lines.text };
        let first = |errors: Vec<AskedError>| errors.first().map_or_else(String::new, |e| e.to_diagnostic().message);
        let solved = unknowns::solve(&text, &text.scene(&[])?).map_err(first)?;
        Ok([held, solved.settings].concat())
    }

    fn free(&self, held: &[Setting]) -> Vec<Tolerance> {
        varied_tolerances(self.declared, held)
    }

    /// The line where all `solve` lines have been followed.
    fn settled_lines(&self) -> Lines<'_> {
        Lines { solves_inside: false, ..self.lines }
    }

    /// The worst of some places within the tolerances.
    fn trial(&self, values: &[Number], scenarios: &[Shares]) -> Trial {
        let failed = |why: String| Trial { value: Measurement::Failed(why), broken: f64::INFINITY, grows: false };
        let held = match self.held_settings(values) {
            Ok(held) => held,
            Err(why) => return failed(why),
        };
        let free = self.free(&held);
        let at = |shares: &Shares| self.settled_lines().trial(self.index, &at_place(&held, &free, shares));
        let all = scenarios.iter().map(at).reduce(|one, other| self.worse(one, other));
        all.unwrap_or_else(|| failed(String::new()))
    }

    /// Of two trials what is worst in either.
    fn worse(&self, one: Trial, other: Trial) -> Trial {
        let (broken, grows) = (one.broken.max(other.broken), one.grows || other.grows);
        let value = match (one.value, other.value) {
            (Measurement::Value(a), Measurement::Value(b)) => {
                let first = if self.optimum().highest { (b - a).mid.hi >= 0.0 } else { (a - b).mid.hi >= 0.0 };
                Measurement::Value(if first { a } else { b })
            }
            // Of what is maximised, the least one counts.
            (Measurement::Infinite, value @ Measurement::Value(_)) if self.optimum().highest => value,
            (value @ Measurement::Value(_), Measurement::Infinite) if self.optimum().highest => value,
            (Measurement::Value(_), none) | (none, _) => none,
        };
        Trial { value, broken, grows }
    }

    /// Whether values are better than others: they have a worst case, no condition fails somewhere, and what is proved of the worst case
    /// is less, or what is reached if there is no proof for both.
    fn is_better(&self, candidate: &Candidate, than: &Candidate) -> bool {
        let Some(own) = &candidate.worst else { return false };
        let Some(other) = &than.worst else { return true };
        let size = |ball: Ball| self.sign() * ball.to_f64();
        let [own_size, other_size] = match (&own.bound, &other.bound) {
            (Some((own, _)), Some((other, _))) => [size(*own), size(*other)],
            _ => [size(own.reached), size(other.reached)],
        };
        (fails(own), own_size) < (fails(other), other_size)
    }

    fn sign(&self) -> f64 {
        if self.optimum().highest { -1.0 } else { 1.0 }
    }

    /// The best values for the worst case that were found, with the places that were looked at; all but the last of these were worse than
    /// others at some values.
    fn best(&self, nominal: &Outcome) -> Result<(Candidate, usize, Vec<Shares>), Vec<AskedError>> {
        let held = self.with(&nominal.values);
        let free = self.free(&held);
        let centre = free.iter().map(|tolerance| tolerance.parameter.value.si.clone()).collect::<Vec<_>>();
        let mut scenarios = vec![shares(&free, &centre)];
        let mut corners: Vec<Shares> =
            places(&self.lines.text, &held, &free).iter().map(|place| shares(&free, place)).collect();
        let mut values = nominal.values.clone();
        let mut evaluations = 0;
        let mut best: Option<Candidate> = None;
        for round in 0..MOST_ROUNDS {
            if round > 0 {
                let trial = |values: &[Number]| self.trial(values, &scenarios);
                let mut search = Search::new(self.optimum(), &trial, self.lines.solves_inside);
                let rough = self.rough(&scenarios);
                let seen = search.run(rough.as_ref().map(|rough| &**rough as &Rough));
                let seen: Seen = seen.map_err(|why| vec![self.lines.no_optimum(self.optimum(), why)])?;
                values = search.finish(seen).values;
                evaluations += search.count();
            }
            let here = self.trial(&values, &scenarios);
            let at_corners = corners.iter().map(|corner| (corner, self.trial(&values, std::slice::from_ref(corner))));
            let worst = at_corners.max_by(|(_, a), (_, b)| self.order(a, b));
            if let Some((corner, _)) = worst.filter(|(_, trial)| self.is_worse(trial, &here)) {
                scenarios.push(corner.clone());
                continue;
            }
            let candidate = Candidate { worst: self.worst(&values), values: values.clone() };
            let free = self.free(&self.held_settings(&values).unwrap_or_default());
            let failing = |worst: &WorstCase| {
                worst.conditions.iter().find_map(|condition| match condition {
                    Throughout::FailsAt(place) => Some(place.clone()),
                    _ => None,
                })
            };
            let more = candidate.worst.as_ref().and_then(|worst| failing(worst).or_else(|| Some(worst.at.clone())));
            if best.as_ref().is_none_or(|best| self.is_better(&candidate, best)) {
                best = Some(candidate);
            }
            let Some(more) = more.map(|place| shares(&free, &place)) else { break };
            let is_worse = self.is_worse(&self.trial(&values, std::slice::from_ref(&more)), &here);
            if !is_worse || scenarios.contains(&more) {
                break;
            }
            corners.push(more.clone());
            scenarios.push(more);
        }
        let best = best.unwrap_or_else(|| Candidate { worst: self.worst(&values), values });
        Ok((best, evaluations, scenarios))
    }

    /// In the order of how bad they are.
    fn order(&self, a: &Trial, b: &Trial) -> std::cmp::Ordering {
        let value = |trial: &Trial| match &trial.value {
            Measurement::Value(value) => self.sign() * value.to_f64(),
            Measurement::Infinite => self.sign() * f64::INFINITY,
            Measurement::None(_) | Measurement::Failed(_) => f64::INFINITY,
        };
        a.broken.total_cmp(&b.broken).then(value(a).total_cmp(&value(b)))
    }

    fn is_worse(&self, a: &Trial, than: &Trial) -> bool {
        let by = |trial: &Trial| match &trial.value {
            Measurement::Value(value) => Some(value.to_f64()),
            _ => None,
        };
        let little = |a: f64, b: f64| (a - b).abs() <= WORSE * b.abs();
        let is_same = a.broken <= than.broken && by(a).zip(by(than)).is_some_and(|(a, b)| little(a, b));
        self.order(a, than).is_gt() && !is_same
    }

    fn worst(&self, values: &[Number]) -> Option<WorstCase> {
        let held = self.held_settings(values).ok()?;
        let free = self.free(&held);
        worst(&self.lines.text, (self.optimum(), self.index), &held, &free)
    }

    /// The line at a place within the tolerances: values of all parameters but the varied ones, and the ranges of these there.
    fn at(&self, values: &[Number], shares: &Shares) -> Option<(Vec<Setting>, Vec<Optimum>)> {
        let held = self.held_settings(values).ok()?;
        let free = self.free(&held);
        let is_varied = |name: &str| self.optimum().varied.iter().any(|varied| varied.parameter.name == name);
        let mut settings = at_place(&held, &free, shares);
        settings.retain(|(name, _)| !is_varied(name));
        let mut optima = self.lines.optima.to_vec();
        for varied in &mut optima[self.index].varied {
            let moves =
                free.iter().zip(shares).find(|(tolerance, _)| tolerance.parameter.name == varied.parameter.name);
            let Some((tolerance, share)) = moves else { continue };
            let zero = (varied.low.may_be_zero() || varied.low.is_negative()) && !varied.high.is_negative();
            let ends = [&varied.low, &varied.high].map(|end| value_at(&tolerance.about(end), share));
            // A share turns round at 0.
            let ends: Vec<Number> = ends.into_iter().chain(zero.then_some(Number::ZERO)).collect();
            let pick =
                |sign: f64| ends.iter().max_by(|a, b| (sign * a.to_f64()).total_cmp(&(sign * b.to_f64()))).cloned();
            (varied.low, varied.high) = (pick(-1.0)?, pick(1.0)?);
        }
        Some((settings, optima))
    }

    /// |H| in binary64 at the worst of some places, for the search.
    fn rough(&self, scenarios: &[Shares]) -> Option<Box<Rough<'_>>> {
        let middle: Vec<Number> = self.optimum().varied.iter().map(|varied| varied.low.clone()).collect();
        let each = scenarios.iter().map(|shares| {
            let (settings, optima) = self.at(&middle, shares)?;
            let line = Lines { optima: &optima, ..self.settled_lines() };
            Some((shares.clone(), line.rough_peaks(self.index, &settings)?))
        });
        let each = each.collect::<Option<Vec<_>>>()?;
        let varied = &self.optimum().varied;
        let moved = varied_tolerances(self.declared, &[]);
        let place = move |i: usize| {
            moved
                .iter()
                .position(|tolerance| tolerance.parameter.name == varied[i].parameter.name)
                .map(|at| (at, moved[at].clone()))
        };
        let places: Vec<Option<(usize, Tolerance)>> = (0..varied.len()).map(place).collect();
        Some(Box::new(move |values: &[Number]| {
            let at = |shares: &Shares, (i, value): (usize, &Number)| match &places[i] {
                Some((own, tolerance)) => value_at(&tolerance.about(value), &shares[*own]),
                None => value.clone(),
            };
            let highest = |(shares, peaks): &(Shares, super::proof::RoughPeaks)| {
                peaks.highest(&values.iter().enumerate().map(|value| at(shares, value)).collect::<Vec<_>>())
            };
            each.iter().map(highest).try_fold(0.0, |most: f64, own| Some(most.max(own?)))
        }))
    }

    /// What no values in the ranges improve: the best that is possible at one place, or at the worst of all.
    fn best_possible(&self, values: &[Number], found: &WorstCase, scenarios: &[Shares]) -> Option<(Ball, Proved)> {
        if self.lines.solves_inside {
            return None;
        }
        let mut order: Vec<(Trial, &Shares)> =
            scenarios.iter().map(|shares| (self.trial(values, std::slice::from_ref(shares)), shares)).collect();
        order.order_by(|a, b| self.order(&b.0, &a.0));
        let better = |a: &(Ball, Proved), b: &(Ball, Proved)| self.sign() * (a.0.to_f64() - b.0.to_f64()) > 0.0;
        let mut all = Vec::new();
        let mut designs = Vec::new();
        for (place, (_, shares)) in order.iter().enumerate() {
            let (held, optima) = self.at(values, shares)?;
            let line = Lines { optima: &optima, ..self.settled_lines() };
            if place < MOST_PROVED
                && let Ok((Outcome { value, best: Best::Everywhere { gap, proof }, .. }, _)) =
                    line.locate(self.index, &held)
            {
                let least = value - Ball::from(self.sign() * gap.value());
                all.push((least, proof.into()));
            }
            let range = |varied: &super::Varied| Tolerance {
                parameter: varied.parameter.clone(),
                span: varied.span,
                within: Some([varied.low.clone(), varied.high.clone()]),
                is_share: false,
                spread: None,
            };
            let ranges = optima[self.index].varied.iter().map(range).collect();
            designs.push(Design { held, ranges });
        }
        all.extend(best_possible(&self.lines.text, (self.optimum(), self.index), &designs, found.reached));
        all.into_iter().reduce(|a, b| if better(&b, &a) { b } else { a })
    }
}

/// Whether a condition certainly fails somewhere within the tolerances.
fn fails(worst: &WorstCase) -> bool {
    worst.conditions.iter().any(|condition| matches!(condition, Throughout::FailsAt(_)))
}

/// All values, with those at a place within the tolerances.
fn at_place(held: &[Setting], free: &[Tolerance], shares: &Shares) -> Vec<Setting> {
    let place = free.iter().zip(shares).map(|(tolerance, share)| {
        let si = value_at(tolerance, share);
        (tolerance.parameter.name.clone(), Quantity { si, ..tolerance.parameter.value.clone() })
    });
    others(held, free).into_iter().chain(place).collect()
}

fn value_at(tolerance: &Tolerance, share: &Number) -> Number {
    match &tolerance.within {
        Some([low, high]) if !share.is_one() => low + &(share * &(high - low)),
        Some([_, high]) => high.clone(),
        None => tolerance.parameter.value.si.clone(),
    }
}

fn shares(free: &[Tolerance], place: &[Number]) -> Shares {
    let share = |(tolerance, value): (&Tolerance, &Number)| {
        let Some([low, high]) = &tolerance.within else { return Number::ZERO };
        let share = (value - low).checked_div(&(high - low)).unwrap_or(Number::ZERO);
        let share = if share.exact().is_some() { share } else { to_fraction(share.to_ball().mid) };
        if share.is_negative() {
            Number::ZERO
        } else if (&share - &Number::ONE).is_positive() {
            Number::ONE
        } else {
            share
        }
    };
    free.iter().zip(place).map(share).collect()
}
