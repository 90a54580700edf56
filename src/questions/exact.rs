//! Requirements exactly at their limit, decided on rational numbers: for cases in which the enclosure of a measure
//! contains the limit, but the model is rational and the measure is a ratio of polynomials in its numbers. In: the
//! system, a probe, the limit. Out: how the measure certainly compares; nothing if that cannot be decided. See
//! docs/method/measures.md.

use super::probe::{Measured, Probe};
use crate::base::Number;
use crate::model::scene::Question;
use crate::system::{Form, LinearSystem, Output};
use std::cmp::Ordering;

/// With more coordinates, elimination in fractions takes too long.
const MOST: usize = 12;

/// How a measure compares with the value in the question.
pub fn compare(measured: &Measured, probe: &Probe, question: &Question) -> Option<Ordering> {
    let system = &measured.lowered.system;
    if system.n() > MOST {
        return None;
    }
    match probe {
        Probe::Static(output) => static_value(system, *output, &measured.loads())?.compare(&question.value),
        Probe::Gain(input, output, frequency) if frequency.is_zero() => {
            let load = [(*input, Number::ONE)];
            static_value(system, *output, &load)?.abs().compare(&question.value)
        }
        Probe::Frequency(mode) => is_frequency(measured, *mode, question.radians.as_ref()?).then_some(Ordering::Equal),
        Probe::Damping(1) if system.n() == 1 => damping(system, &question.value),
        _ => None,
    }
}

/// P0 K^-1 B0 u + D0 u
fn static_value(system: &LinearSystem, output: usize, loads: &[(usize, Number)]) -> Option<Number> {
    let n = system.n();
    let mut force = vec![Number::ZERO; n];
    for (input, load) in loads {
        for (i, factor) in &system.inputs[*input].b[0] {
            force[i.index()] = &force[i.index()] + &(factor * load);
        }
    }
    let x = solve(exact(&system.k, n)?, force)?;
    let Output { p, d, .. } = &system.outputs[output];
    let moved = p[0].iter().fold(Number::ZERO, |sum, (i, factor)| &sum + &(factor * &x[i.index()]));
    let load = |input: u32| loads.iter().find(|(known, _)| *known == input as usize).map(|(_, load)| load);
    let value = d[0].iter().filter_map(|(input, factor)| load(*input).map(|load| factor * load));
    let value = value.fold(moved, |sum, part| &sum + &part);
    value.exact().map(|_| value.clone())
}

/// Whether K - omega^2 M is singular, and the enclosure of this mode alone contains omega.
fn is_frequency(measured: &Measured, mode: usize, omega: &Number) -> bool {
    let system = &measured.lowered.system;
    let (Some(modes), Some(_)) = (measured.modes, omega.exact()) else { return false };
    let holds = |i: usize| (modes.list[i].omega - omega.to_ball()).contains_zero();
    let alone = (0..modes.list.len()).all(|i| holds(i) == (i + 1 == mode));
    let n = system.n();
    let (Some(k), Some(m)) = (exact(&system.k, n), exact(&system.m, n)) else { return false };
    let square = omega.square();
    let shifted = k.iter().zip(&m).map(|(k, m)| k.iter().zip(m).map(|(k, m)| k - &(&square * m)).collect()).collect();
    alone && modes.is_complete() && is_singular(shifted)
}

/// Compares zeta = c / (2 sqrt(k m)) with a limit: c^2 against 4 zeta^2 k m.
fn damping(system: &LinearSystem, limit: &Number) -> Option<Ordering> {
    let [m, c, k] = [&system.m, &system.c, &system.k].map(|form| exact(form, 1).map(|entries| entries[0][0].clone()));
    let (m, c, k) = (m?, c?, k?);
    let oscillates = (&(&k * &m) * &Number::from(4)).compare(&c.square()) == Some(Ordering::Greater);
    if !oscillates || c.is_negative() || limit.is_negative() || limit.exact().is_none() {
        return None;
    }
    c.square().compare(&(&(&Number::from(4) * &limit.square()) * &(&k * &m)))
}

/// The entries of a form, if all of them are rational.
fn exact(form: &Form, n: usize) -> Option<Vec<Vec<Number>>> {
    let entries = form.entries(n);
    entries.iter().flatten().all(|entry| entry.exact().is_some()).then_some(entries)
}

/// Gaussian elimination; `None` if the matrix is singular.
fn solve(mut a: Vec<Vec<Number>>, mut b: Vec<Number>) -> Option<Vec<Number>> {
    let n = b.len();
    for step in 0..n {
        let pivot = (step..n).find(|&row| !a[row][step].is_zero())?;
        a.swap(step, pivot);
        b.swap(step, pivot);
        for row in (0..n).filter(|&row| row != step) {
            let factor = &a[row][step] / &a[step][step];
            let top = a[step].clone();
            a[row].iter_mut().zip(&top).for_each(|(x, by)| *x = &*x - &(&factor * by));
            b[row] = &b[row] - &(&factor * &b[step]);
        }
    }
    Some((0..n).map(|i| &b[i] / &a[i][i]).collect())
}

fn is_singular(a: Vec<Vec<Number>>) -> bool {
    let n = a.len();
    solve(a, vec![Number::ZERO; n]).is_none()
}
