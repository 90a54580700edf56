//! Requirements exactly at their limit, decided on rational numbers: for cases in which the enclosure of a measure
//! contains the limit, but the model is rational and the measure is a ratio of polynomials in its numbers. In: the
//! system, a probe, the limit. Out: how the measure certainly compares; `None` if that cannot be decided. See
//! docs/method/measures.md.

use super::probe::{Measured, Probe};
use crate::analysis::rates::{Rate, from_rate};
use crate::base::{Number, Rational};
use crate::kernel::dense::echelon::{is_singular, solution};
use crate::model::scene::Question;
use crate::system::{Form, LinearSystem, Output};
use std::cmp::Ordering;

/// Maximum number of coordinates: with more, elimination in fractions takes too long.
const MOST: usize = 12;

/// The exact order of a measure and the value in the question.
pub fn compare(measured: &Measured, probe: &Probe, question: &Question) -> Option<Ordering> {
    let system = &measured.lowered.system;
    if system.n() > MOST || system.losses.is_some() {
        return None;
    }
    match probe {
        Probe::Static(output) => static_value(system, *output, &measured.loads())?.compare(&question.value),
        Probe::Gain(input, output, frequency) if frequency.is_zero() => {
            let load = [(*input, Number::ONE)];
            static_value(system, *output, &load)?.abs().compare(&question.value)
        }
        Probe::ByRate(derivative, probe) => match &**probe {
            Probe::Gain(input, output, frequency) if frequency.is_zero() => {
                let rate = Rate { input: *input, derivative: *derivative, word: "" };
                let driven = from_rate(system, rate, *output).ok()?;
                let load = [(driven.inputs.len() - 1, Number::ONE)];
                static_value(&driven, 0, &load)?.abs().compare(&question.value)
            }
            _ => None,
        },
        Probe::Frequency(mode) => is_frequency(measured, *mode, question.radians.as_ref()?).then_some(Ordering::Equal),
        Probe::Rest(terms, span) => {
            let lowered = measured.lowered;
            let found = lowered.mechanism.at_rest(measured.scene, &lowered.rest, terms, *span).ok()?;
            found.exact()?;
            found.compare(&question.value)
        }
        Probe::Damping(1) if system.n() == 1 => damping(system, &question.value),
        _ => None,
    }
}

/// P0 K^-1 B0 u + D0 u
fn static_value(system: &LinearSystem, output: usize, loads: &[(usize, Number)]) -> Option<Number> {
    let n = system.n();
    let mut force = vec![Rational::ZERO; n];
    for (input, load) in loads {
        for (i, factor) in &system.inputs[*input].b[0] {
            force[i.index()] = &force[i.index()] + (factor * load).exact()?;
        }
    }
    let (x, only) = solution(&system.k.rational_entries(n)?, &force)?;
    let x: Vec<Number> = only.then(|| x.into_iter().map(Number::from).collect())?;
    let Output { p, d, .. } = &system.outputs[output];
    let moved = p[0].iter().fold(Number::ZERO, |sum, (i, factor)| &sum + &(factor * &x[i.index()]));
    let load = |input: u32| loads.iter().find(|(known, _)| *known == input as usize).map(|(_, load)| load);
    let value = d[0].iter().filter_map(|(input, factor)| load(*input).map(|load| factor * load));
    let value = value.fold(moved, |sum, part| &sum + &part);
    value.exact().map(|_| value.clone())
}

/// Whether K - omega^2 M is singular, and only this mode's enclosure contains omega.
fn is_frequency(measured: &Measured, mode: usize, omega: &Number) -> bool {
    let system = &measured.lowered.system;
    let (Some(modes), Some(omega)) = (measured.modes, omega.exact()) else { return false };
    let holds = |i: usize| (modes.list[i].omega - omega.to_ball()).contains_zero();
    let alone = (0..modes.list.len()).all(|i| holds(i) == (i + 1 == mode));
    let n = system.n();
    let (Some(k), Some(m)) = (system.k.rational_entries(n), system.m.rational_entries(n)) else { return false };
    let square = omega * omega;
    let shifted = k.iter().zip(&m).map(|(k, m)| k.iter().zip(m).map(|(k, m)| k - &(&square * m)).collect()).collect();
    alone && modes.is_complete() && is_singular(shifted)
}

/// Compares zeta = c / (2 sqrt(k m)) with a limit: c^2 against 4 zeta^2 k m.
fn damping(system: &LinearSystem, limit: &Number) -> Option<Ordering> {
    let entry = |form: &Form| form.rational_entries(1).map(|entries| Number::from(entries[0][0].clone()));
    let [m, c, k] = [&system.m, &system.c, &system.k].map(entry);
    let (m, c, k) = (m?, c?, k?);
    let oscillates = (&(&k * &m) * &Number::from(4)).compare(&c.square()) == Some(Ordering::Greater);
    if !oscillates || c.is_negative() || limit.is_negative() || limit.exact().is_none() {
        return None;
    }
    c.square().compare(&(&(&Number::from(4) * &limit.square()) * &(&k * &m)))
}
