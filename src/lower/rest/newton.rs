//! The descent: from the drawing to a rest of one part, in binary64. See docs/method/rest.md.
//!
//! Newton steps with a trust region ([`trust`](super::trust)). D measures angles in radians and translations in lengths
//! of the part. Every step lowers the energy, so the descent ends in a minimum. A coordinate without force stays where it
//! is drawn, even on top of a hill. A coordinate with any force leaves it: the first step follows the forces as drawn in
//! the model's own numbers, which are not rounding errors however small they are.

use super::potential::{Detail, Energy, Potential};
use super::trust::{Region, ShiftedMatrix, Step};
use crate::base::Power;
use crate::kernel::sparse::ldl::{Factors, Symmetric};
use crate::lower::kinematics::{Index, Kinematics, State};

/// A part of the scene during the descent.
pub struct Descent<'a> {
    pub kinematics: &'a Kinematics,
    pub coordinates: &'a [Index],
    pub local: &'a [u32],
    pub potential: Potential<f64>,
    pub state: &'a mut State<f64>,
    /// dV/dq as drawn, each number accurate to its last digits.
    pub drawn: Vec<f64>,
    /// The longest spring or arm of the part, m.
    pub length: f64,
    pub linear: bool,
}

/// The result of the descent.
#[derive(Clone, Debug)]
pub struct DescentResult {
    pub settled: bool,
    pub steps: u32,
    pub energy: Energy<f64>,
}

/// Limit on the steps: at first, a step is at most half a radian or half a length of the part.
pub const MAX_STEPS: u32 = 500;
/// A step this small in the measure D changes nothing that binary64 can resolve: positions have a rounding error of
/// 1e-16.
pub const NEGLIGIBLE_STEP: f64 = 1e-13;
/// Forces that balance up to this share of their magnitudes: rounding errors of sums of a few terms.
pub const BALANCED: f64 = 1e-14;
/// Forces that are unbalanced by more than this share of their magnitudes after the last step are not rounding errors.
const KINKED: f64 = 0.1;
pub const FIRST_RADIUS: f64 = 0.5;
/// Angles turn by no more than about this in one step, so that no rest is skipped.
pub const LARGEST_RADIUS: f64 = 1.0;
/// Lengths of the part beyond which it counts as falling.
const FALLEN: f64 = 1e6;
/// A pivot below this share of the terms it was made from is a rounding error.
pub const LEAST_PIVOT: f64 = 1e-13;

impl Descent<'_> {
    pub fn run(mut self) -> DescentResult {
        let measure = self.measure();
        let turning = self.coordinates.iter().any(|&coordinate| self.kinematics.is_angle(coordinate));
        let mut radius = if self.linear { FALLEN } else { FIRST_RADIUS };
        let mut matrix = Matrix::default();
        let mut energy = self.energy(Detail::Curvature);
        energy.gradient.clone_from(&self.drawn);
        for steps in 0..MAX_STEPS {
            matrix.take(&energy);
            if imbalance(&energy) <= BALANCED && (steps > 0 || !matrix.is_a_hill(&measure)) {
                return DescentResult { settled: true, steps, energy };
            }
            let unsure = if steps == 0 { 0.0 } else { BALANCED };
            let noise: Vec<f64> = energy.forces.iter().map(|force| unsure * force).collect();
            let Some(step) = matrix.step(&energy.gradient, &noise, &measure, radius) else { break };
            let before = self.values();
            self.walk(&step.direction);
            let next = self.energy(Detail::Curvature);
            // Rounding errors of the energies, a few units in the last place of each.
            let noise = 1e-15 * (energy.size + next.size);
            if step.predicted <= noise {
                // The energies can no longer decide, so the forces do.
                if imbalance(&next) > 0.5 * imbalance(&energy) {
                    self.put(&before);
                    return DescentResult { settled: true, steps, energy };
                }
                energy = next;
                continue;
            }
            let gain = (energy.value - next.value + noise) / (step.predicted + noise);
            if gain.is_nan() || gain < 0.1 {
                self.put(&before);
                radius = step.length / 4.0;
            } else {
                energy = next;
                if gain > 0.75 {
                    let largest = if turning { LARGEST_RADIUS } else { FALLEN };
                    radius = radius.max(2.0 * step.length).min(largest);
                } else if gain < 0.25 {
                    radius = step.length / 4.0;
                }
            }
            if step.length <= NEGLIGIBLE_STEP {
                // Steps that do not help shrink too, for example towards a kink, where a spring that still pulls has
                // zero length.
                let settled = imbalance(&energy) <= KINKED;
                return DescentResult { settled, steps: steps + 1, energy };
            }
            if self.is_away(&measure) {
                break;
            }
        }
        DescentResult { settled: false, steps: MAX_STEPS, energy }
    }

    fn energy(&self, detail: Detail) -> Energy<f64> {
        self.potential.at(self.kinematics, self.state, self.local, self.coordinates.len(), detail)
    }

    fn values(&self) -> Vec<f64> {
        self.coordinates.iter().map(|coordinate| *self.state.value(*coordinate)).collect()
    }

    fn put(&mut self, values: &[f64]) {
        for (coordinate, value) in self.coordinates.iter().zip(values) {
            self.state.set(self.kinematics, *coordinate, *value);
        }
    }

    fn walk(&mut self, direction: &[f64]) {
        let values: Vec<f64> = self.values().iter().zip(direction).map(|(value, step)| value + step).collect();
        self.put(&values);
    }

    /// The part stays as drawn, since no force is certainly unbalanced.
    pub fn remain_as_drawn(self) -> DescentResult {
        DescentResult { settled: true, steps: 0, energy: self.energy(Detail::Sizes) }
    }

    /// The diagonal of D: 1 for an angle, 1 / length^2 for a translation.
    fn measure(&self) -> Vec<f64> {
        let weight =
            |coordinate: &Index| if self.kinematics.is_angle(*coordinate) { 1.0 } else { self.length.power(-2) };
        self.coordinates.iter().map(weight).collect()
    }

    fn is_away(&self, measure: &[f64]) -> bool {
        let far = |(coordinate, weight): (&Index, &f64)| self.state.value(*coordinate).abs() * weight.sqrt() > FALLEN;
        self.coordinates.iter().zip(measure).any(far)
    }
}

/// The largest unbalanced force, relative to the forces that act on its coordinate.
fn imbalance(energy: &Energy<f64>) -> f64 {
    let relative = |(left, forces): (&f64, &f64)| if *left == 0.0 { 0.0 } else { left.abs() / forces };
    energy.gradient.iter().zip(&energy.forces).map(relative).fold(0.0, f64::max)
}

/// The second derivative; its pattern is kept from step to step.
#[derive(Default)]
pub struct Matrix {
    places: Vec<(u32, u32)>,
    symmetric: Option<Symmetric>,
}

impl Matrix {
    pub fn take(&mut self, energy: &Energy<f64>) {
        let places = energy.curvature.iter().map(|(i, j, _)| (*i, *j));
        if self.symmetric.is_none() || !places.clone().eq(self.places.iter().copied()) {
            self.places = places.collect();
            self.symmetric = Some(Symmetric::pattern(energy.gradient.len(), &self.places));
        }
        if let Some(symmetric) = &mut self.symmetric {
            symmetric.fill(energy.curvature.iter().map(|(_, _, value)| *value));
        }
    }

    /// The factors of the matrix itself, if it is positive definite.
    pub fn factor(&self) -> Option<Factors> {
        self.symmetric.as_ref()?.factor(|_| 0.0, LEAST_PIVOT).ok()
    }

    /// Whether the energy certainly has negative curvature along some motion.
    fn is_a_hill(&self, measure: &[f64]) -> bool {
        let Some(symmetric) = &self.symmetric else { return false };
        let shift = 1e-10 * self.size(measure);
        symmetric.factor(|row| shift * measure[row], LEAST_PIVOT).is_err()
    }

    /// The largest entry of the diagonal, measured by D.
    fn size(&self, measure: &[f64]) -> f64 {
        let sizes = self.symmetric.as_ref().map_or(Vec::new(), Symmetric::diagonal);
        sizes.iter().zip(measure).map(|(size, weight)| size.abs() / weight).fold(0.0, f64::max)
    }

    /// `None` if no shift yields a step: numbers are outside the range of binary64.
    fn step(&self, gradient: &[f64], noise: &[f64], measure: &[f64], radius: f64) -> Option<Step> {
        let symmetric = self.symmetric.as_ref()?;
        let pulls = gradient.iter().zip(measure).map(|(pull, weight)| pull.abs() / weight.sqrt()).fold(0.0, f64::max);
        // If nothing is stiff, the force itself sets the scale: a step as long as the radius.
        let scale = self.size(measure).max(pulls / radius);
        Region { gradient, noise, measure, scale, radius }.step(&Measured { symmetric, measure })
    }
}

/// A matrix with the measure by which it is shifted.
struct Measured<'a> {
    symmetric: &'a Symmetric,
    measure: &'a [f64],
}

impl ShiftedMatrix for Measured<'_> {
    type Factors = Factors;

    fn factor(&self, shift: f64) -> Option<Factors> {
        self.symmetric.factor(|row| shift * self.measure[row], LEAST_PIVOT).ok()
    }

    fn solve(&self, factors: &Factors, x: &mut [f64]) {
        factors.solve(x);
    }
}
