//! One step of a trust region: p that minimises g . p + p . H p / 2 for |p|_D <= radius. In: a matrix that can be
//! factored with a shift s D, and the gradient. Out: the step and the predicted decrease. See docs/method/rest.md#search.
//!
//! p = -(H + s D)^-1 g with the least s >= 0 for which H + s D is positive definite and |p|_D is at most the radius (J.
//! J. Moré, D. C. Sorensen, *Computing a trust region step*, SIAM J. Sci. Stat. Comput. 4 (1983) 553-572). If H is not
//! positive definite, the step reaches the edge of the region, however small g is: near the top of a hill the way down is
//! long. If g has hardly any component along the direction z of negative curvature, p is continued along z to the edge,
//! downhill. If that component is zero up to rounding, z is not used: a coordinate without force stays where it is drawn,
//! even on top of a hill.

use crate::base::Power;

/// H + s D in factored form.
pub trait ShiftedMatrix {
    type Factors;

    /// `None` if the shifted matrix is not positive definite to working precision.
    fn factor(&self, shift: f64) -> Option<Self::Factors>;

    /// x <- (H + s D)^-1 x.
    fn solve(&self, factors: &Self::Factors, x: &mut [f64]);
}

/// A step and the predicted decrease.
pub struct Step {
    pub direction: Vec<f64>,
    /// |p|_D
    pub length: f64,
    /// The decrease of the quadratic model of the energy.
    pub predicted: f64,
}

/// The trust region: gradient, measure and radius.
pub struct Region<'a> {
    pub gradient: &'a [f64],
    /// Bound of the rounding error of each entry of the gradient, besides a few units in its last place.
    pub noise: &'a [f64],
    /// The diagonal of D.
    pub measure: &'a [f64],
    /// The largest of the entries of H, and of the gradient over the radius: the unit in which they are measured.
    pub scale: f64,
    pub radius: f64,
}

/// The longest step so far for a matrix that is not positive definite.
struct Short<F> {
    shift: f64,
    factors: F,
    step: Step,
}

const MAX_TRIALS: usize = 200;
/// The least shift, as a share of the scale: smaller negative curvature is a rounding error.
const LEAST_SHIFT: f64 = 1e-10;
/// A step that ends beyond the edge by up to this factor counts as inside the region.
const OVERSHOOT: f64 = 1.1;
/// A step that reaches this share of the way to the edge is long enough if H is not positive definite.
const FAR_ENOUGH: f64 = 0.1;
/// Shifts this close to each other count as equal: the factors cannot distinguish them.
const EQUAL_SHIFTS: f64 = 1e-12;
/// The share of a step below which rounding makes it indistinguishable from zero.
const ROUNDING: f64 = 1e-13;
const INVERSE_STEPS: usize = 3;

impl Region<'_> {
    /// `None` if no shift yields a step: numbers are outside the range of binary64.
    pub fn step<M: ShiftedMatrix>(&self, matrix: &M) -> Option<Step> {
        // A shift for which H + s D is not positive definite.
        let mut low: Option<f64> = None;
        let mut short: Option<Short<M::Factors>> = None;
        let mut shift = 0.0;
        for _ in 0..MAX_TRIALS {
            let Some(factors) = matrix.factor(shift) else {
                low = Some(shift);
                shift = match &short {
                    Some(found) if found.shift - shift <= EQUAL_SHIFTS * found.shift => break,
                    Some(found) => midpoint(shift, found.shift),
                    None if shift == 0.0 => LEAST_SHIFT * self.scale,
                    None => 4.0 * shift,
                };
                continue;
            };
            let step = self.at(matrix, &factors, shift);
            if !step.length.is_finite() || shift > 1e30 * self.scale {
                return None;
            }
            let fits = step.length <= OVERSHOOT * self.radius;
            let negative = low.filter(|low| *low >= LEAST_SHIFT * self.scale);
            if fits && (negative.is_none() || step.length >= FAR_ENOUGH * self.radius) {
                return Some(step);
            }
            let next = shift + self.correction(matrix, &factors, &step);
            let Some(low) = negative.filter(|_| fits) else {
                shift = next;
                continue;
            };
            let together = shift - low <= EQUAL_SHIFTS * shift || self.gradient.iter().all(|pull| *pull == 0.0);
            short = Some(Short { shift, factors, step });
            if together {
                break;
            }
            shift = if next > low && next < shift { next } else { midpoint(low, shift) };
        }
        short.map(|short| self.led_downhill(matrix, short))
    }

    fn at<M: ShiftedMatrix>(&self, matrix: &M, factors: &M::Factors, shift: f64) -> Step {
        let mut direction: Vec<f64> = self.gradient.iter().map(|pull| -pull).collect();
        matrix.solve(factors, &mut direction);
        let length = self.norm(&direction);
        let predicted = 0.5 * (shift * length * length - dot(self.gradient, &direction));
        Step { direction, length, predicted }
    }

    /// One Newton step of 1 / |p(shift)| towards 1 / radius.
    fn correction<M: ShiftedMatrix>(&self, matrix: &M, factors: &M::Factors, step: &Step) -> f64 {
        let weighted = self.weigh(&step.direction);
        let mut response = weighted.clone();
        matrix.solve(factors, &mut response);
        (step.length / self.radius - 1.0) * step.length * step.length / dot(&response, &weighted)
    }

    /// A short step, continued along the direction of most negative curvature to the edge; the step itself if the
    /// gradient does not show which way is downhill.
    fn led_downhill<M: ShiftedMatrix>(&self, matrix: &M, short: Short<M::Factors>) -> Step {
        let Short { shift, factors, step } = short;
        // A start that is not orthogonal to z because of some symmetry.
        let start = |(i, weight): (usize, &f64)| (1.0 + 0.1 * (i % 7) as f64) / weight.sqrt();
        let mut z: Vec<f64> = self.measure.iter().enumerate().map(start).collect();
        // z . (H + s D) z
        let mut above = 0.0;
        for _ in 0..INVERSE_STEPS {
            let length = self.norm(&z);
            z.iter_mut().for_each(|z| *z /= length);
            let weighted = self.weigh(&z);
            let mut next = weighted.clone();
            matrix.solve(&factors, &mut next);
            above = dot(&next, &weighted) / self.norm(&next).power(2);
            z = next;
        }
        let length = self.norm(&z);
        z.iter_mut().for_each(|z| *z /= length);
        // The part of p along z is -(g . z) / above: so near the pole it is large compared with z's contamination by
        // other directions.
        let along = dot(&self.weigh(&z), &step.direction);
        let noise: f64 = self.noise.iter().zip(&z).map(|(noise, z)| noise * z.abs()).sum();
        let is_reported = along.abs() > ROUNDING * step.length + noise / above;
        let curvature = above - shift;
        if !(is_reported && curvature < 0.0 && self.radius > step.length) {
            return step;
        }
        let way = along.signum() * (self.radius - step.length);
        let predicted = step.predicted + way * above * along - (0.5 * way * way + way * along) * curvature;
        let direction: Vec<f64> = step.direction.iter().zip(&z).map(|(step, z)| step + way * z).collect();
        Step { length: self.norm(&direction), direction, predicted }
    }

    fn norm(&self, step: &[f64]) -> f64 {
        step.iter().zip(self.measure).map(|(step, weight)| step * step * weight).sum::<f64>().sqrt()
    }

    fn weigh(&self, step: &[f64]) -> Vec<f64> {
        step.iter().zip(self.measure).map(|(step, weight)| step * weight).collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A number between two; their geometric mean if they are far apart.
fn midpoint(low: f64, high: f64) -> f64 {
    if high > 4.0 * low && low > 0.0 { low.sqrt() * high.sqrt() } else { 0.5 * (low + high) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// diag(h) with D = 1.
    struct Diagonal(Vec<f64>);

    impl ShiftedMatrix for Diagonal {
        type Factors = Vec<f64>;

        fn factor(&self, shift: f64) -> Option<Vec<f64>> {
            let pivots: Vec<f64> = self.0.iter().map(|h| h + shift).collect();
            pivots.iter().zip(&self.0).all(|(pivot, h)| *pivot > 1e-13 * (h.abs() + shift)).then_some(pivots)
        }

        fn solve(&self, pivots: &Vec<f64>, x: &mut [f64]) {
            x.iter_mut().zip(pivots).for_each(|(x, pivot)| *x /= pivot);
        }
    }

    fn step(h: &[f64], gradient: &[f64], noise: f64) -> Step {
        let n = h.len();
        let (noise, measure) = (vec![noise; n], vec![1.0; n]);
        let region = Region { gradient, noise: &noise, measure: &measure, scale: 2.0, radius: 0.5 };
        region.step(&Diagonal(h.to_vec())).expect("finite")
    }

    #[test]
    fn inside_the_region_it_is_newtons_step() {
        let step = step(&[2.0, 1.0], &[0.4, -0.1], 0.0);
        assert_eq!(step.direction, [-0.2, 0.1]);
        assert!((step.predicted - 0.045).abs() < 1e-15);
    }

    /// From the top of a hill the step is long, however small the slope is: down to 1e-300.
    #[test]
    fn on_a_hill_the_step_reaches_the_edge() {
        for slope in [1e-1, 1e-7, -1e-9, 1e-12, -1e-15, 1e-40, 1e-300] {
            let step = step(&[-1.0, 3.0], &[slope, 0.0], 0.0);
            assert!(step.length >= 0.05 && step.length <= 0.55, "{slope:e}: {}", step.length);
            assert!(step.direction[0] * slope < 0.0 && step.direction[1].abs() < 1e-12);
            assert!(step.predicted > 1e-3, "{slope:e}: {}", step.predicted);
        }
    }

    /// A coordinate without force stays on top of its hill, and so does one whose force is only a rounding error.
    #[test]
    fn without_a_slope_there_is_no_way_down() {
        for (slope, noise) in [(0.0, 0.0), (1e-16, 1e-15)] {
            let step = step(&[-1.0, 3.0], &[slope, 0.03], noise);
            assert!(
                step.direction[0].abs() < 1e-2 && (step.direction[1] + 0.0075).abs() < 1e-3,
                "{:?}",
                step.direction
            );
        }
    }
}
