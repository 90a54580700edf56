//! Runs the emitted steps next to the same steps in double-double, to measure the effect of the target's rounding (of
//! coefficients and of operations) on the outputs of code that needs no external inputs and whose run is therefore
//! known. In: a discrete system and its unrounded coefficients. Out: bounds of the outputs' errors over a number of
//! steps. See docs/method/emit.md.
//!
//! The states are those of the emitted code to the last bit: the same operations in the same order, each rounded to the
//! target. An output's error is bounded by the sum of the largest errors of its states, and by the rounding of its own
//! sum.

use crate::analysis::discrete::cell::{Cell, ExactCell, Form, Operand};
use crate::analysis::discrete::lift::{Decay, Lift};
use crate::analysis::discrete::precision::Precision;
use crate::analysis::discrete::{DiscreteSystem, Measured};
use crate::base::{Bound, Dd};

/// A discrete system before rounding.
#[derive(Clone, Debug)]
pub struct Exact {
    pub cells: Vec<ExactCell>,
    pub start: Vec<Dd>,
    /// Unrounded changes, as in [`DiscreteSystem::events`].
    pub events: Vec<Vec<Dd>>,
}

/// Limit on the products in double-double that a run may take.
const MOST_PRODUCTS: f64 = 4e6;
/// Numbers of steps whose errors are reported.
const FEW: u64 = 1000;
const MANY: u64 = 100_000;

/// Error bounds after few steps and after many, or after as many as time allows.
pub fn measure_rounding(system: &DiscreteSystem, exact: &Exact, last: Option<u64>) -> Vec<Measured> {
    let products = |cell: &ExactCell| cell.f.rows() * cell.f.rows() + cell.input.iter().map(Vec::len).sum::<usize>();
    let mut run = Run::new(system, exact);
    let looks = run.seen.iter().map(Vec::len).sum::<usize>();
    let products = exact.cells.iter().map(products).sum::<usize>() as f64 + 0.1 * looks as f64;
    let mut most = MANY;
    while most > FEW && most as f64 * products > MOST_PRODUCTS {
        most /= 10;
    }
    let most = last.map_or(most, |last| most.min(last.max(1)));
    let mut found = Vec::new();
    for step in 1..=most {
        run.step();
        if step == most || step == FEW {
            found.push(Measured { steps: step, error: Bound::by_proof(run.error()) });
        }
    }
    found
}

struct Run<'a> {
    system: &'a DiscreteSystem,
    exact: &'a Exact,
    tick: u64,
    event: usize,
    states: Vec<f64>,
    true_states: Vec<Dd>,
    /// The largest magnitude of each state, and of its error.
    sizes: Vec<f64>,
    errors: Vec<f64>,
    /// The largest magnitude of each output.
    outputs: Vec<f64>,
    /// For each output the states that it reads, by their index among all, with their factors.
    seen: Vec<Vec<(usize, f64)>>,
}

impl<'a> Run<'a> {
    fn new(system: &'a DiscreteSystem, exact: &'a Exact) -> Run<'a> {
        let states: Vec<f64> = system.cells.iter().flat_map(|cell| cell.start.clone()).collect();
        let zeros = vec![0.0; states.len()];
        let mut run = Run {
            system,
            exact,
            tick: 0,
            event: 0,
            states,
            true_states: exact.start.clone(),
            sizes: zeros.clone(),
            errors: zeros,
            outputs: vec![0.0; system.outputs.len()],
            seen: (0..system.outputs.len()).map(|output| states_read_by(system, output).collect()).collect(),
        };
        run.record_extremes();
        run
    }

    /// Updates the largest values and errors.
    fn record_extremes(&mut self) {
        for (i, (&state, &truth)) in self.states.iter().zip(&self.true_states).enumerate() {
            self.sizes[i] = self.sizes[i].max(state.abs());
            self.errors[i] = self.errors[i].max((truth - Dd::from(state)).hi.abs());
        }
        for (seen, most) in self.seen.iter().zip(&mut self.outputs) {
            let sum: f64 = seen.iter().map(|&(state, c)| c * self.states[state]).sum();
            *most = most.max(sum.abs());
        }
    }

    fn step(&mut self) {
        let precision = self.system.precision;
        let mut next = Vec::with_capacity(self.states.len());
        let mut truth = Vec::with_capacity(self.states.len());
        for (cell, exact) in self.system.cells.iter().zip(&self.exact.cells) {
            let first = next.len();
            let range = first..first + cell.size();
            emitted_step(cell, &self.states, first, precision, &mut next);
            let own = &self.true_states[range];
            for (i, input) in exact.input.iter().enumerate() {
                let driven = input.iter().fold(Dd::ZERO, |sum, &(operand, g)| match operand {
                    Operand::Signal(state) => sum + g * self.true_states[state],
                    _ => sum,
                });
                truth.push(own.iter().enumerate().fold(driven, |sum, (j, &w)| sum + exact.f[(i, j)] * w));
            }
        }
        (self.states, self.true_states) = (next, truth);
        self.tick = self.tick.wrapping_add(1);
        if let Some(event) = self.system.events.get(self.event).filter(|event| event.tick == self.tick) {
            for (i, change) in self.exact.events[self.event].iter().enumerate() {
                if self.system.set[i] {
                    (self.states[i], self.true_states[i]) = (event.change[i], *change);
                } else {
                    self.states[i] = round(precision, self.states[i] + event.change[i]);
                    self.true_states[i] += *change;
                }
            }
            self.event += 1;
            if let Some(again) = self.system.repeat.filter(|_| self.event == self.system.events.len()) {
                self.event = again.first;
                self.tick = self.tick.wrapping_sub(again.ticks);
            }
        }
        self.record_extremes();
    }

    /// The largest error of an output, relative to its largest value.
    fn error(&self) -> f64 {
        let of = |output: usize| {
            let (mut error, mut size, mut terms) = (0.0, 0.0, 0.0);
            for &(state, c) in &self.seen[output] {
                error += c.abs() * self.errors[state];
                size += c.abs() * self.sizes[state];
                terms += 1.0;
            }
            // Rounding errors of coefficients, products and sums.
            let bound = error + (terms + 2.0) * self.system.precision.unit() * size;
            if bound == 0.0 { 0.0 } else { bound / self.outputs[output] }
        };
        (0..self.outputs.len()).map(of).fold(0.0, f64::max) * (1.0 + 1e-6)
    }
}

/// The states that an output reads, by their index among all, with their factors.
fn states_read_by(system: &DiscreteSystem, output: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
    let direct = system.direct[output].iter().filter_map(|&(operand, c)| match operand {
        Operand::Signal(state) => Some((state, c)),
        _ => None,
    });
    let states = system.cells.iter().flat_map(|cell| (0..cell.output.len()).map(move |state| (cell, state)));
    let read = move |(index, (cell, state)): (usize, (&Cell, usize))| Some((index, cell.contribution(state, output)?));
    direct.chain(states.enumerate().filter_map(read))
}

fn round(precision: Precision, x: f64) -> f64 {
    match precision {
        Precision::Double => x,
        // Sums and products of single-precision numbers are the same if they are rounded to double first (53 >= 2 * 24
        // + 2).
        Precision::Single => f64::from(x as f32),
    }
}

/// Takes a step of a cell exactly like the emitted code.
fn emitted_step(cell: &Cell, states: &[f64], first: usize, precision: Precision, next: &mut Vec<f64>) {
    let round = |x: f64| round(precision, x);
    let plus = |so_far: Option<f64>, factor: f64, of: f64| {
        let term = if factor.abs() == 1.0 { factor * of } else { round(factor * of) };
        Some(so_far.map_or(term, |so_far| round(so_far + term)))
    };
    let driven = |so_far: Option<f64>, state: usize| {
        cell.input[state].iter().fold(so_far, |so_far, &(operand, g)| match operand {
            Operand::Signal(of) => plus(so_far, g, states[of]),
            _ => so_far,
        })
    };
    let w = &states[first..first + cell.size()];
    match &cell.form {
        Form::Keep(r) => next.push(driven(if *r == 0.0 { None } else { plus(None, *r, w[0]) }, 0).unwrap_or(0.0)),
        Form::Lose(d) => {
            let change = driven(None, 0);
            let change = if *d == 0.0 { change } else { plus(change, -d, w[0]) };
            next.push(change.map_or(w[0], |change| round(w[0] + change)));
        }
        Form::Dense { turned, rows } => {
            for (i, row) in rows.iter().enumerate() {
                let own = row.iter().zip(w).filter(|(e, _)| **e != 0.0);
                let change = own.fold(driven(None, i), |so_far, (&e, &w)| plus(so_far, e, w));
                let sign = if *turned { -1.0 } else { 1.0 };
                next.push(change.map_or(sign * w[i], |change| round(sign * w[i] + change)));
            }
        }
        Form::Pair(Lift { turned, decay, k, p }) => {
            let sign = if *turned { -1.0 } else { 1.0 };
            let base = match decay {
                Decay::Lose(0.0) => sign * w[1],
                Decay::Lose(c) => round(sign * (w[1] - round(c * w[1]))),
                Decay::Keep(r) => round(sign * (r * w[1])),
            };
            let v = driven(Some(base), 1);
            let v = if *k == 0.0 { v } else { plus(v, -sign * k, w[0]) }.unwrap_or(0.0);
            let advance = if *p == 1.0 { v } else { round(p * v) };
            next.push(driven(Some(round(sign * w[0] + advance)), 0).unwrap_or(0.0));
            next.push(v);
        }
    }
}
