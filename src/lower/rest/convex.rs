//! The rest of a large curved part, refined with sparse factors and enclosed by strong convexity. Clause: spec.md 7.5.
//!
//! In z = (q - m)/s, s_i = H_ii^(-1/2), let every eigenvalue of S H(X) S be at least c > 0 for all X with |z| <= rho. On
//! the sphere |z| = rho then grad V . z >= c rho^2 - |S g(m)| rho. Where that is not negative, |S g(m)| <= c rho, a rest
//! lies within (J. M. Ortega, W. C. Rheinboldt, *Iterative Solution of Nonlinear Equations in Several Variables* (1970),
//! 6.3.4), and only one, for V is convex there.
//!
//! That c is a bound is shown by elimination: where L D L^T of S H S - sigma comes to its end in binary64 with positive D,
//! the least eigenvalue is above sigma - e, e = 2^-52 n (longest row + 4) (S. M. Rump, *Verification of positive
//! definiteness*, BIT 46 (2006) 433: every entry rounds by gamma of its row times the roots of two diagonal entries, here
//! ones). What H(X) differs by from the matrix eliminated is bounded by its largest row of radii.

use super::enclosure::Refinement;
use super::krawczyk::{MAX_REFINEMENTS, NEAR};
use super::potential::{Detail, Energy};
use crate::base::{Dd, Number};
use crate::lower::kinematics::Index;
use crate::system::ldl::{Factors, Symmetric};

/// A second derivative scaled to ones on its diagonal: one entry for each place, with what it may be wrong by.
struct Scaled {
    places: Vec<(u32, u32)>,
    middles: Vec<f64>,
    spreads: Vec<f64>,
    /// H_ii^(-1/2)
    scale: Vec<f64>,
}

/// A pivot that is less than this part of what it was made from is rounding.
const LEAST_PIVOT: f64 = 1e-13;
/// Steps of inverse iteration: each makes the share of all other motions smaller by the ratio of their eigenvalues.
const INVERSE_STEPS: usize = 12;

/// Refines the state and encloses the rest; false where that is not proven, the radii are estimates then.
pub fn refine_and_prove(part: &mut Refinement, local: &[u32], moving: &[Index]) -> bool {
    let mut middle: Vec<Dd> = moving.iter().map(|i| part.state.value(*i).to_ball().mid).collect();
    let sizes = |middle: &[Dd], i: usize| middle[i].hi.abs().max(NEAR);
    let curvature = scaled(&part.energy(local, moving.len(), Detail::Curvature), moving.len());
    let factors = curvature.as_ref().and_then(|curvature| curvature.factor(0.0, LEAST_PIVOT));
    let (Some(curvature), Some(factors)) = (curvature, factors) else {
        // The search in binary64 stops where a step is 1e-13 of an angle or a length.
        part.place(moving, &middle, |i| 1e-13 * sizes(&middle, i).max(1.0));
        return false;
    };
    let mut last = f64::INFINITY;
    for _ in 0..MAX_REFINEMENTS {
        part.place(moving, &middle, |_| 0.0);
        let gradient = part.energy(local, moving.len(), Detail::Gradient).gradient;
        let step = curvature.solve(&factors, &gradient);
        let size = step.iter().enumerate().map(|(i, step)| step.abs() / sizes(&middle, i)).fold(0.0, f64::max);
        if size.is_nan() || size >= last {
            break;
        }
        last = size;
        for (at, step) in middle.iter_mut().zip(&step) {
            *at -= Dd::from(*step);
        }
    }
    let proven = prove(part, local, moving, &middle, &curvature, &factors);
    if !proven {
        // Another step would gain as many digits as the last one did.
        part.place(moving, &middle, |i| last * sizes(&middle, i));
    }
    proven
}

/// Finds a radius about the middle that holds a rest; leaves the state in that box.
fn prove(
    part: &mut Refinement,
    local: &[u32],
    moving: &[Index],
    middle: &[Dd],
    curvature: &Scaled,
    factors: &Factors,
) -> bool {
    let n = moving.len();
    part.place(moving, middle, |_| 0.0);
    let gradient = part.energy(local, n, Detail::Gradient).gradient;
    let scale = &curvature.scale;
    let forces = gradient.iter().zip(scale).map(|(force, scale)| (force.to_ball().magnitude() * scale).powi(2));
    // Sums and products of n positive numbers: the factor covers their roundings for n below 1e8.
    let force = forces.sum::<f64>().sqrt() * (1.0 + 1e-7);
    let sigma = 0.5 * least_eigenvalue(factors, n);
    // Twice what is needed where half of sigma is left, and never below what the middle itself rounds by.
    let rounding = middle.iter().zip(scale).map(|(at, scale)| at.hi.abs() * Dd::EPSILON / scale).fold(0.0, f64::max);
    let radius = (4.0 * force / sigma).max(rounding);
    if !radius.is_finite() {
        return false;
    }
    part.place(moving, middle, |i| radius * scale[i] * (1.0 + 1e-15));
    let box_curvature = part.energy(local, n, Detail::Curvature);
    let Some(within) = scaled_by(&box_curvature, scale.clone()) else { return false };
    let Some(shifted) = within.factor(sigma, 0.0) else { return false };
    let rounding = f64::EPSILON * n as f64 * (shifted.longest_row() as f64 + 4.0);
    let least = sigma - rounding - within.largest_spread();
    least > 0.0 && force <= least * radius * (1.0 - 1e-15)
}

/// An estimate of the least eigenvalue of the matrix of these factors, by inverse iteration.
fn least_eigenvalue(factors: &Factors, n: usize) -> f64 {
    let mut x = vec![1.0 / (n as f64).sqrt(); n];
    let mut size = 1.0;
    for _ in 0..INVERSE_STEPS {
        factors.solve(&mut x);
        size = x.iter().map(|x| x * x).sum::<f64>().sqrt();
        x.iter_mut().for_each(|x| *x /= size);
    }
    1.0 / size
}

/// The curvature scaled by its own diagonal; `None` where that is not positive.
fn scaled(energy: &Energy<Number>, n: usize) -> Option<Scaled> {
    let mut diagonal = vec![0.0; n];
    for (i, _, value) in energy.curvature.iter().filter(|(i, j, _)| i == j) {
        diagonal[*i as usize] += value.to_f64();
    }
    let usable = diagonal.iter().all(|entry| *entry > 0.0 && entry.is_finite());
    usable.then(|| scaled_by(energy, diagonal.iter().map(|entry| entry.sqrt().recip()).collect()))?
}

fn scaled_by(energy: &Energy<Number>, scale: Vec<f64>) -> Option<Scaled> {
    let mut order: Vec<usize> = (0..energy.curvature.len()).collect();
    let place = |at: usize| {
        let (i, j, _) = &energy.curvature[at];
        (*i.max(j), *i.min(j))
    };
    order.sort_by_key(|&at| place(at));
    let mut result = Scaled { places: Vec::new(), middles: Vec::new(), spreads: Vec::new(), scale };
    let mut at = 0;
    while at < order.len() {
        let here = place(order[at]);
        let mut sum = Number::ZERO;
        while at < order.len() && place(order[at]) == here {
            sum = &sum + &energy.curvature[order[at]].2;
            at += 1;
        }
        let (ball, factor) = (sum.to_ball(), result.scale[here.0 as usize] * result.scale[here.1 as usize]);
        if !ball.is_finite() {
            return None;
        }
        let middle = ball.mid.hi * factor;
        result.places.push(here);
        result.middles.push(middle);
        // The low part, the radius, and the roundings of two products.
        result
            .spreads
            .push((ball.mid.lo.abs() + ball.rad) * factor * (1.0 + 1e-14) + 2.0 * f64::EPSILON * middle.abs());
    }
    Some(result)
}

impl Scaled {
    fn factor(&self, sigma: f64, least: f64) -> Option<Factors> {
        let mut matrix = Symmetric::pattern(self.scale.len(), &self.places);
        matrix.fill(self.middles.iter().copied());
        matrix.factor(|_| -sigma, least).ok()
    }

    /// H^-1 g.
    fn solve(&self, factors: &Factors, gradient: &[Number]) -> Vec<f64> {
        let mut step: Vec<f64> = gradient.iter().zip(&self.scale).map(|(g, scale)| g.to_f64() * scale).collect();
        factors.solve(&mut step);
        step.iter().zip(&self.scale).map(|(z, scale)| z * scale).collect()
    }

    /// The largest row of spreads: a bound of the norm of what the matrix may be wrong by.
    fn largest_spread(&self) -> f64 {
        let mut rows = vec![0.0; self.scale.len()];
        for ((i, j), spread) in self.places.iter().zip(&self.spreads) {
            rows[*i as usize] += spread;
            if i != j {
                rows[*j as usize] += spread;
            }
        }
        rows.into_iter().fold(0.0, f64::max) * (1.0 + 1e-9)
    }
}
