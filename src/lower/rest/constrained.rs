//! The descent along constraints: from the drawing to a rest of one part whose coordinates depend on each other, in
//! binary64. See docs/method/rest.md#closed-loops.
//!
//! Sequential quadratic steps in the null space of the constraints (J. Nocedal, S. J. Wright, *Numerical Optimization*,
//! 2nd ed. 2006, sections 15.3 and 18.1): let G be the gradients of the constraints, the columns of Z a basis of G z = 0,
//! and lambda the multipliers that minimise the remainder grad V + G^T lambda. A step p = Z y minimises V + lambda g
//! within a trust radius, and Newton steps across the constraints bring it back onto g = 0. Every step lowers the energy.

use super::newton::{BALANCED, DescentResult, FIRST_RADIUS, LARGEST_RADIUS, MAX_STEPS, NEGLIGIBLE_STEP};
use super::potential::{Detail, ELSEWHERE, Energy, Potential};
use super::trust::{Region, ShiftedMatrix};
use crate::lower::constraints::equation::Equation;
use crate::lower::kinematics::{Index, Kinematics, PathEvaluation, State};
use nalgebra::linalg::{Cholesky, QR};
use nalgebra::{DMatrix, DVector, Dyn};

/// A part with constraints during the descent.
pub struct Descent<'a> {
    pub kinematics: &'a Kinematics,
    pub coordinates: &'a [Index],
    pub local: &'a [u32],
    pub potential: Potential<f64>,
    pub equations: Vec<Equation<f64>>,
    pub state: &'a mut State<f64>,
    /// The unit of length, m.
    pub length: f64,
}

/// Limit on the Newton steps across the constraints, after which a step counts as too long to be brought back.
const MAX_RETURNS: u32 = 30;
/// Permitted violation of a constraint, in radians or lengths of the part: rounding errors of sums of a few lengths.
const CLOSURE_TOLERANCE: f64 = 1e-14;
/// Radians or lengths beyond which the part counts as falling.
const FALLEN: f64 = 1e6;

/// The result of the descent.
pub enum ConstrainedResult {
    Settled(DescentResult),
    /// No position near the drawing satisfies the constraints.
    Open,
}

/// The data for a step, in units of motion: radians, lengths of the part.
struct Evaluation {
    energy: Energy<f64>,
    /// grad V + G^T lambda.
    left: DVector<f64>,
    /// An orthonormal basis of the motions that the constraints allow.
    basis: DMatrix<f64>,
    /// Z^T (grad^2 V + lambda . grad^2 g) Z.
    curvature: DMatrix<f64>,
    multipliers: DVector<f64>,
}

impl Descent<'_> {
    /// `moves`: whether some force is certainly unbalanced as drawn.
    pub fn run(mut self, moves: bool) -> ConstrainedResult {
        if !self.comes_back() {
            return ConstrainedResult::Open;
        }
        let mut here = self.evaluate();
        if !moves {
            return ConstrainedResult::Settled(self.outcome(true, 0, here));
        }
        let mut radius = FIRST_RADIUS;
        for steps in 0..MAX_STEPS {
            let gradient = here.basis.transpose() * &here.left;
            if self.imbalance(&here) <= BALANCED {
                return ConstrainedResult::Settled(self.outcome(true, steps, here));
            }
            let noise = BALANCED * self.total_magnitudes(&here).amax();
            let Some((step, predicted)) = step(&here.curvature, &gradient, noise, radius) else { break };
            let (before, length) = (self.values(), step.norm());
            self.walk(&(&here.basis * step));
            let back = self.comes_back();
            let next = self.evaluate();
            let noise = 1e-15 * (here.energy.size + next.energy.size);
            if back && predicted <= noise {
                // The energies can no longer decide, so the forces do.
                if self.imbalance(&next) > 0.5 * self.imbalance(&here) {
                    self.put(&before);
                    return ConstrainedResult::Settled(self.outcome(true, steps, here));
                }
                here = next;
                continue;
            }
            let gain = (here.energy.value - next.energy.value + noise) / (predicted + noise);
            if !back || gain.is_nan() || gain < 0.1 {
                self.put(&before);
                radius = length / 4.0;
            } else {
                here = next;
                if gain > 0.75 {
                    radius = radius.max(2.0 * length).min(LARGEST_RADIUS);
                } else if gain < 0.25 {
                    radius = length / 4.0;
                }
            }
            if length <= NEGLIGIBLE_STEP {
                return ConstrainedResult::Settled(self.outcome(true, steps + 1, here));
            }
            let measured = self.values();
            if measured.iter().zip(self.coordinates).any(|(value, i)| (value / self.unit(*i)).abs() > FALLEN) {
                break;
            }
        }
        ConstrainedResult::Settled(self.outcome(false, MAX_STEPS, here))
    }

    /// The unbalanced forces are reported as the gradient.
    fn outcome(&self, settled: bool, steps: u32, here: Evaluation) -> DescentResult {
        let mut energy = here.energy;
        for (place, coordinate) in self.coordinates.iter().enumerate() {
            energy.gradient[place] = here.left[place] / self.unit(*coordinate);
        }
        DescentResult { settled, steps, energy }
    }

    fn unit(&self, coordinate: Index) -> f64 {
        if self.kinematics.is_angle(coordinate) { 1.0 } else { self.length }
    }

    fn units(&self) -> DVector<f64> {
        DVector::from_iterator(self.coordinates.len(), self.coordinates.iter().map(|i| self.unit(*i)))
    }

    fn values(&self) -> Vec<f64> {
        self.coordinates.iter().map(|coordinate| *self.state.value(*coordinate)).collect()
    }

    fn put(&mut self, values: &[f64]) {
        for (coordinate, value) in self.coordinates.iter().zip(values) {
            self.state.set(self.kinematics, *coordinate, *value);
        }
    }

    fn walk(&mut self, step: &DVector<f64>) {
        let steps = step.component_mul(&self.units());
        let moved: Vec<f64> = self.values().iter().zip(steps.iter()).map(|(at, step)| at + step).collect();
        self.put(&moved);
    }

    /// g and G, with lengths in units of the part's length.
    fn constraints(&self) -> (DVector<f64>, DMatrix<f64>) {
        let mut reach = PathEvaluation::default();
        let mut values = DVector::zeros(self.equations.len());
        let mut rows = DMatrix::zeros(self.equations.len(), self.coordinates.len());
        for (k, equation) in self.equations.iter().enumerate() {
            let (value, row) = equation.measure(self.kinematics, self.state, &mut reach);
            let scale = if equation.components.is_empty() { 1.0 } else { 1.0 / self.length };
            values[k] = value * scale;
            for (coordinate, entry) in row {
                let place = self.local[coordinate as usize];
                if place != ELSEWHERE {
                    rows[(k, place as usize)] = entry * scale * self.unit(coordinate);
                }
            }
        }
        (values, rows)
    }

    /// Newton steps across the constraints, each the shortest possible; `false` if they do not lead back.
    fn comes_back(&mut self) -> bool {
        let mut last = f64::INFINITY;
        for _ in 0..MAX_RETURNS {
            let (values, rows) = self.constraints();
            let off = values.amax();
            if off <= CLOSURE_TOLERANCE {
                return true;
            }
            // Near the end, rounding errors stop the convergence.
            if off.is_nan() || (off >= last && off < 1e3 * CLOSURE_TOLERANCE) {
                return off.is_finite();
            }
            if off > 1e3 * last {
                return false;
            }
            last = off;
            let square = &rows * rows.transpose();
            let Some(weights) = square.lu().solve(&values) else { return false };
            self.walk(&(-(rows.transpose() * weights)));
        }
        false
    }

    fn evaluate(&self) -> Evaluation {
        let n = self.coordinates.len();
        let energy = self.potential.at(self.kinematics, self.state, self.local, n, Detail::Curvature);
        let units = self.units();
        let (_, rows) = self.constraints();
        let gradient = DVector::from_column_slice(&energy.gradient).component_mul(&units);
        let (basis, multipliers) = split(&rows, &gradient);
        let left = &gradient + rows.transpose() * &multipliers;
        let mut curvature = DMatrix::zeros(n, n);
        let mut add = |i: u32, j: u32, value: f64| {
            let (i, j) = (i as usize, j as usize);
            let value = value * units[i] * units[j];
            curvature[(i, j)] += value;
            if i != j {
                curvature[(j, i)] += value;
            }
        };
        for (i, j, value) in &energy.curvature {
            add(*i, *j, *value);
        }
        let mut reach = PathEvaluation::default();
        for (equation, multiplier) in self.equations.iter().zip(multipliers.iter()) {
            let scale = if equation.components.is_empty() { 1.0 } else { 1.0 / self.length };
            equation.curvature(self.kinematics, self.state, &(multiplier * scale), &mut reach, |i, j, value| {
                let (i, j) = (self.local[i as usize], self.local[j as usize]);
                if i != ELSEWHERE && j != ELSEWHERE {
                    add(i, j, value);
                }
            });
        }
        let curvature = basis.transpose() * curvature * &basis;
        Evaluation { energy, left, basis, curvature, multipliers }
    }

    /// The largest unbalanced force, relative to the forces that act on its coordinate, including reactions.
    fn imbalance(&self, here: &Evaluation) -> f64 {
        let acting = self.total_magnitudes(here);
        let relative = |place: usize| {
            let left = here.left[place].abs();
            if left == 0.0 { 0.0 } else { left / acting[place] }
        };
        (0..here.left.len()).map(relative).fold(0.0, f64::max)
    }

    /// The sum of the magnitudes of all forces and reactions on each coordinate.
    fn total_magnitudes(&self, here: &Evaluation) -> DVector<f64> {
        let (_, rows) = self.constraints();
        let reactions = rows.map(f64::abs).transpose() * here.multipliers.map(f64::abs);
        let forces = here.energy.forces.iter().zip(self.coordinates).map(|(force, i)| force * self.unit(*i));
        DVector::from_iterator(self.coordinates.len(), forces) + reactions
    }
}

/// A basis of the motions that the rows allow, and the multipliers that minimise what remains of a gradient.
fn split(rows: &DMatrix<f64>, gradient: &DVector<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let (m, n) = rows.shape();
    let qr = QR::new(rows.transpose());
    let mut turned = DMatrix::identity(n, n);
    qr.q_tr_mul(&mut turned);
    let across = turned.rows(0, m.min(n)).into_owned();
    let basis = turned.rows(m.min(n), n - m.min(n)).transpose();
    // G^T = Y R: the least-squares solution of G^T lambda = -gradient.
    let multipliers = qr.r().solve_upper_triangular(&(-(across * gradient)));
    (basis, multipliers.unwrap_or_else(|| DVector::zeros(m)))
}

/// The trust-region step in the coordinates of the basis; `None` if numbers leave the range of binary64. `noise` bounds
/// the rounding error of an entry of the gradient.
fn step(curvature: &DMatrix<f64>, gradient: &DVector<f64>, noise: f64, radius: f64) -> Option<(DVector<f64>, f64)> {
    let n = gradient.len();
    if n == 0 {
        return Some((DVector::zeros(0), 0.0));
    }
    let scale = curvature.amax().max(gradient.amax() / radius);
    let (noise, measure) = (vec![noise; n], vec![1.0; n]);
    let region = Region { gradient: gradient.as_slice(), noise: &noise, measure: &measure, scale, radius };
    let found = region.step(&Dense(curvature))?;
    Some((DVector::from_vec(found.direction), found.predicted))
}

struct Dense<'a>(&'a DMatrix<f64>);

impl ShiftedMatrix for Dense<'_> {
    type Factors = Cholesky<f64, Dyn>;

    fn factor(&self, shift: f64) -> Option<Cholesky<f64, Dyn>> {
        let n = self.0.nrows();
        let shifted = self.0 + DMatrix::identity(n, n) * shift;
        shifted.clone().cholesky().filter(|factors| is_sound(factors.l_dirty(), &shifted))
    }

    fn solve(&self, factors: &Cholesky<f64, Dyn>, x: &mut [f64]) {
        let solved = factors.solve(&DVector::from_column_slice(x));
        x.copy_from_slice(solved.as_slice());
    }
}

/// Whether every pivot exceeds the rounding error of the terms it was made from.
fn is_sound(l: &DMatrix<f64>, matrix: &DMatrix<f64>) -> bool {
    (0..matrix.nrows()).all(|i| l[(i, i)] * l[(i, i)] > super::newton::LEAST_PIVOT * matrix[(i, i)].abs())
}
