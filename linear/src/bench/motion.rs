//! Methods for the motion in time: the exact one, and methods step by step: a matrix exponential, Runge-Kutta of order
//! four, Newmark with constant acceleration, the generalised alpha method (Chung and Hulbert 1993, rho = 0.8).

use super::ordinary::Matrices;
use super::{Call, Clock, Entry, MOST_DENSE, Question, Reference, time_best};
use crate::analysis::{self, AnalysisError, History, Signal};
use crate::base::{Dd, Number, Rational};
use crate::system::{CoordinateId, LinearSystem, Output};
use nalgebra::{DMatrix, DVector};

/// The motion that is computed.
#[derive(Clone, Debug)]
pub struct Problem {
    /// Whether it uses the model's own signals and initial state; otherwise the first coordinate is released at 1.
    pub own: bool,
    /// End time, s.
    pub until: f64,
}

/// Number of samples that are compared, in addition to the start.
const SAMPLES: usize = 10;
/// Steps of the coarsest run in a period of the highest frequency, and the number of refinements.
const PER_PERIOD: f64 = 20.0;
const REFINEMENTS: [usize; 4] = [1, 4, 16, 64];
const MOST_STEPS: usize = 100_000;

pub fn motion(
    system: &LinearSystem,
    drives: &[Vec<Signal>],
    reference: &Reference,
    clock: &mut Clock,
) -> Result<(Problem, Vec<Entry>), AnalysisError> {
    let (mut system, mut drives, mut own) = problem(system, drives);
    let omegas = reference.oscillations();
    let (slow, fast) = (omegas.first().copied().unwrap_or(1.0), omegas.last().copied().unwrap_or(1.0));
    let turn = 2.0 * std::f64::consts::PI;
    // Ten samples over nine periods of the slowest motion, with a whole number of steps between them. They are not at
    // whole periods, where a phase error would hardly show.
    let between = 0.93 * turn / slow;
    let steps = (between * fast / turn * PER_PERIOD).ceil().max(PER_PERIOD);
    let spacing = Rational::from_f64(between).map_or(Number::ONE, Number::from);
    let times: Vec<Number> = (0..=SAMPLES as i64).map(|i| &spacing * &Number::from(i)).collect();
    let is_still = |history: &History| history.values.iter().all(|row| row[0].mid.is_zero());
    let (mut history, mut seconds) = time_best(clock, || analysis::respond(&system, &drives, &times));
    if own && history.as_ref().is_ok_and(is_still) {
        // Nothing moves, so no error has a size to be compared with.
        (system, drives, own) = release(system);
        (history, seconds) = time_best(clock, || analysis::respond(&system, &drives, &times));
    }
    let history = history?;
    let truth: Vec<Dd> = history.values.iter().map(|row| row[0].mid).collect();
    let size = truth.iter().map(|y| y.to_f64().abs()).fold(0.0, f64::max);
    let off = |values: &[f64]| {
        let errors = values.iter().zip(&truth).map(|(y, truth)| (Dd::from(*y) - *truth).abs().to_f64() / size);
        errors.fold(0.0, |worst: f64, error| if error <= worst { worst } else { error })
    };
    let printed: Vec<f64> = truth.iter().map(|y| y.to_f64()).collect();
    let bound = history.values.iter().map(|row| row[0].rad / size).fold(0.0, f64::max) + off(&printed);
    let mut entries = vec![Entry::of_vibc(Question::Motion, "vibc, exact", seconds, off(&printed), bound).choose()];
    let problem = Problem { own, until: between * SAMPLES as f64 };
    if system.n() > MOST_DENSE {
        return Ok((problem, entries));
    }
    let Some(stepper) = Stepper::of(&system, &drives, between) else { return Ok((problem, entries)) };
    for refinement in REFINEMENTS {
        let count = steps as usize * refinement;
        if count * SAMPLES > MOST_STEPS {
            continue;
        }
        let force = stepper.forces(count);
        let methods: [(&str, Call<Vec<f64>>); 4] = [
            ("matrix exponential in binary64", &|| stepper.exponential(count)),
            ("Runge-Kutta 4", &|| stepper.runge_kutta(count, &force)),
            ("Newmark", &|| stepper.newmark(count, &force)),
            ("generalised alpha", &|| stepper.alpha(count, &force)),
        ];
        for (method, call) in methods.into_iter().skip(usize::from(!stepper.free)) {
            let method = format!("{method}, {:.0} steps per period", PER_PERIOD * refinement as f64);
            let (values, seconds) = time_best(clock, call);
            let error = values.map(|values| off(&values));
            let entry = Entry::ordinary(Question::Motion, &method, seconds, error);
            let failed = entry.error.is_none();
            entries.push(if failed { entry.note("fails or overflows") } else { entry });
        }
    }
    Ok((problem, entries))
}

/// One output, the first coordinate that the model observes; its own signals if an ordinary program can follow them.
fn problem(system: &LinearSystem, drives: &[Vec<Signal>]) -> (LinearSystem, Vec<Vec<Signal>>, bool) {
    let mut system = system.clone();
    let seen = system.outputs.iter().flat_map(|output| &output.p[0]).map(|(i, _)| *i).next();
    let at = vec![(seen.unwrap_or(CoordinateId(0)), Number::ONE)];
    let name = system.coordinates[at[0].0.index()].name;
    let nothing = || [Vec::new(), Vec::new(), Vec::new()];
    system.outputs = vec![Output { name, unit: "m".into(), p: [at, Vec::new(), Vec::new()], d: nothing() }];
    let plain = |signal: &Signal| match signal {
        Signal::Harmonic { at, .. } => at.is_zero(),
        signal => matches!(signal, Signal::Step { .. }),
    };
    let forces = |(input, signals): (&crate::system::Input, &Vec<Signal>)| {
        signals.is_empty() || input.b[1].is_empty() && input.b[2].is_empty() && signals.iter().all(plain)
    };
    let driven = drives.iter().any(|signals| !signals.is_empty());
    let own = (driven || !system.initial.is_empty()) && system.inputs.iter().zip(drives).all(forces);
    if own {
        return (system, drives.to_vec(), true);
    }
    release(system)
}

/// The observed coordinate released at 1.
fn release(mut system: LinearSystem) -> (LinearSystem, Vec<Vec<Signal>>, bool) {
    system.initial = vec![(system.outputs[0].p[0][0].0, Number::ONE, Number::ZERO)];
    (system, Vec::new(), false)
}

/// M x'' + C x' + K x = f(t) from (x, v), sampled at the first output.
struct Stepper {
    matrices: Matrices,
    x: DVector<f64>,
    v: DVector<f64>,
    output: usize,
    /// Time between samples, s.
    between: f64,
    drives: Vec<(DVector<f64>, Signal)>,
    free: bool,
}

impl Stepper {
    fn of(system: &LinearSystem, drives: &[Vec<Signal>], between: f64) -> Option<Stepper> {
        let n = system.n();
        let (mut x, mut v) = (DVector::zeros(n), DVector::zeros(n));
        for (i, displacement, velocity) in &system.initial {
            (x[i.index()], v[i.index()]) = (displacement.to_f64(), velocity.to_f64());
        }
        let mut list = Vec::new();
        for (input, signals) in system.inputs.iter().zip(drives) {
            let mut load = DVector::zeros(n);
            input.b[0].iter().for_each(|(i, value)| load[i.index()] += value.to_f64());
            list.extend(signals.iter().map(|signal| (load.clone(), signal.clone())));
        }
        let output = system.outputs[0].p[0].first()?.0.index();
        Some(Stepper { matrices: Matrices::of(system), x, v, output, between, free: list.is_empty(), drives: list })
    }

    /// f at every half step, computed in advance so that it does not count for any method.
    fn forces(&self, count: usize) -> Vec<DVector<f64>> {
        let n = self.x.len();
        if self.free {
            return vec![DVector::zeros(n); 2 * count * SAMPLES + 1];
        }
        let half = 0.5 * self.between / count as f64;
        let mut waves: Vec<Wave> = self.drives.iter().map(|(_, signal)| Wave::of(signal, half)).collect();
        let at = |index: usize| {
            let mut sum = DVector::zeros(n);
            for ((load, _), wave) in self.drives.iter().zip(&mut waves) {
                sum += load * wave.at(index);
            }
            sum
        };
        (0..=2 * count * SAMPLES).map(at).collect()
    }

    fn exponential(&self, count: usize) -> Option<Vec<f64>> {
        let (n, a) = (self.x.len(), self.matrices.first_order()?);
        let step = (a * (self.between / count as f64)).exp();
        let mut z = DVector::from_fn(2 * n, |i, _| if i < n { self.x[i] } else { self.v[i - n] });
        Some(self.sample(count, |_| {
            z = &step * &z;
            z[self.output]
        }))
    }

    fn runge_kutta(&self, count: usize, force: &[DVector<f64>]) -> Option<Vec<f64>> {
        let h = self.between / count as f64;
        let inverse = self.matrices.m.clone().try_inverse()?;
        let (k, c) = (&inverse * &self.matrices.k, &inverse * &self.matrices.c);
        let acceleration = |x: &DVector<f64>, v: &DVector<f64>, f: &DVector<f64>| &inverse * f - &k * x - &c * v;
        let (mut x, mut v) = (self.x.clone(), self.v.clone());
        Some(self.sample(count, |i| {
            let (f0, f1, f2) = (&force[2 * i], &force[2 * i + 1], &force[2 * i + 2]);
            let (v1, a1) = (v.clone(), acceleration(&x, &v, f0));
            let v2 = &v + &a1 * (0.5 * h);
            let a2 = acceleration(&(&x + &v1 * (0.5 * h)), &v2, f1);
            let v3 = &v + &a2 * (0.5 * h);
            let a3 = acceleration(&(&x + &v2 * (0.5 * h)), &v3, f1);
            let v4 = &v + &a3 * h;
            let a4 = acceleration(&(&x + &v3 * h), &v4, f2);
            x += (v1 + (v2 + v3) * 2.0 + v4) * (h / 6.0);
            v += (a1 + (a2 + a3) * 2.0 + a4) * (h / 6.0);
            x[self.output]
        }))
    }

    fn newmark(&self, count: usize, force: &[DVector<f64>]) -> Option<Vec<f64>> {
        self.implicit(count, force, [0.0, 0.0, 0.5, 0.25])
    }

    fn alpha(&self, count: usize, force: &[DVector<f64>]) -> Option<Vec<f64>> {
        let rho = 0.8;
        let (am, af) = ((2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0));
        self.implicit(count, force, [am, af, 0.5 - am + af, 0.25 * (1.0 - am + af) * (1.0 - am + af)])
    }

    /// (1 - am) M a1 + am M a0 + C v + K x = f, with v and x at the fraction 1 - af of the step.
    fn implicit(&self, count: usize, force: &[DVector<f64>], [am, af, gamma, beta]: [f64; 4]) -> Option<Vec<f64>> {
        let h = self.between / count as f64;
        let Matrices { m, c, k } = &self.matrices;
        let whole: DMatrix<f64> = m * (1.0 - am) + (c * (gamma * h) + k * (beta * h * h)) * (1.0 - af);
        let factors = whole.lu();
        let (mut x, mut v) = (self.x.clone(), self.v.clone());
        let mut a = m.clone().lu().solve(&(&force[0] - c * &v - k * &x))?;
        let mut fine = true;
        let values = self.sample(count, |i| {
            let x1 = &x + &v * h + &a * ((0.5 - beta) * h * h);
            let v1 = &v + &a * ((1.0 - gamma) * h);
            let load = &force[2 * i + 2] * (1.0 - af) + &force[2 * i] * af;
            let rest = load - m * &a * am - c * (&v1 * (1.0 - af) + &v * af) - k * (&x1 * (1.0 - af) + &x * af);
            match factors.solve(&rest) {
                Some(next) => {
                    (x, v) = (x1 + &next * (beta * h * h), v1 + &next * (gamma * h));
                    a = next;
                }
                None => fine = false,
            }
            x[self.output]
        });
        fine.then_some(values)
    }

    /// The output at the samples.
    fn sample(&self, count: usize, mut step: impl FnMut(usize) -> f64) -> Vec<f64> {
        let mut values = vec![self.x[self.output]];
        for i in 0..count * SAMPLES {
            let y = step(i);
            if (i + 1) % count == 0 {
                values.push(y);
            }
        }
        values
    }
}

/// A signal at multiples of a time, in binary64; a sine by rotation, recomputed from its formula now and then.
struct Wave<'a> {
    signal: &'a Signal,
    step: f64,
    turn: (f64, f64),
    state: (f64, f64),
}

/// Number of rotations between two evaluations of the formula.
const ROTATIONS: usize = 64;

impl Wave<'_> {
    fn of(signal: &Signal, step: f64) -> Wave<'_> {
        let turn = match signal {
            Signal::Harmonic { frequency, .. } => angle(&(frequency * &exact(step)), &Number::ZERO),
            _ => (0.0, 1.0),
        };
        Wave { signal, step, turn, state: (0.0, 1.0) }
    }

    /// The value at an index; indices must ascend.
    fn at(&mut self, index: usize) -> f64 {
        match self.signal {
            Signal::Harmonic { value, frequency, phase, .. } => {
                self.state = if index.is_multiple_of(ROTATIONS) {
                    let time = &exact(self.step) * &Number::from(index as i64);
                    angle(&(frequency * &time), phase)
                } else {
                    let ((s, c), (ts, tc)) = (self.state, self.turn);
                    (s * tc + c * ts, c * tc - s * ts)
                };
                value.to_f64() * self.state.0
            }
            Signal::Step { value, at } if self.step * index as f64 >= at.to_f64() => value.to_f64(),
            _ => 0.0,
        }
    }
}

fn exact(x: f64) -> Number {
    Rational::from_f64(x).map_or(Number::ZERO, Number::from)
}

/// Sine and cosine of a number of turns and a phase.
fn angle(turns: &Number, phase: &Number) -> (f64, f64) {
    let angle = &(&(&Number::pi() * &Number::from(2)) * turns) + phase;
    angle.sin_cos().map_or((0.0, 1.0), |(s, c)| (s.to_f64(), c.to_f64()))
}
