//! The rest of a large curved part, refined with sparse factors and enclosed by strong convexity.
//! See docs/method/rest.md#proof.
//!
//! In z = (q - m)/s, s_i = H_ii^(-1/2), let every eigenvalue of S H(X) S be at least c > 0 for all X with |z| <= rho.
//! Then grad V . z >= c rho^2 - |S g(m)| rho on the sphere |z| = rho. If that is not negative, that is if |S g(m)| <= c
//! rho, there is a rest within (J. M. Ortega, W. C. Rheinboldt, *Iterative Solution of Nonlinear Equations in Several
//! Variables* (1970), 6.3.4), and only one, because V is convex there.
//!
//! Elimination shows that c is a bound: [`Scaled::least_eigenvalue`].

use super::definite::{Scaled, estimate};
use super::krawczyk::{MAX_REFINEMENTS, NEAR};
use super::potential::{Detail, Energy};
use super::proof::Proven;
use super::refinement::Refinement;
use crate::base::{Ball, Dd, Number, Power, up};
use crate::kernel::sparse::ldl::Factors;
use crate::lower::kinematics::Index;

/// A pivot below this share of the terms it was made from is a rounding error.
const LEAST_PIVOT: f64 = 1e-13;
/// Refines the state and encloses the rest; if that is not proven, the radii are estimates.
pub fn refine_and_prove(part: &mut Refinement, local: &[u32], moving: &[Index]) -> Option<Proven> {
    let mut middle: Vec<Dd> = moving.iter().map(|i| part.state.value(*i).to_ball().mid).collect();
    let sizes = |middle: &[Dd], i: usize| middle[i].hi.abs().max(NEAR);
    let curvature = Scaled::to_ones(moving.len(), entries(part.energy(local, moving.len(), Detail::Curvature)));
    let factors = curvature.as_ref().and_then(|curvature| curvature.factor(0.0, LEAST_PIVOT));
    let (Some(curvature), Some(factors)) = (curvature, factors) else {
        // The search in binary64 stops at steps of 1e-13 of an angle or a length.
        part.place(moving, &middle, |i| 1e-13 * sizes(&middle, i).max(1.0));
        return None;
    };
    let mut last = f64::INFINITY;
    for _ in 0..MAX_REFINEMENTS {
        part.place(moving, &middle, |_| 0.0);
        let gradient = part.energy(local, moving.len(), Detail::Gradient).gradient;
        let step = curvature.solve(&factors, gradient.iter().map(Number::to_f64));
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
    if proven.is_none() {
        // Another step would gain as many digits as the last one.
        part.place(moving, &middle, |i| last * sizes(&middle, i));
    }
    proven
}

/// Finds a radius around the middle for which the ball contains a rest; leaves the state as that box.
fn prove(
    part: &mut Refinement,
    local: &[u32],
    moving: &[Index],
    middle: &[Dd],
    curvature: &Scaled,
    factors: &Factors,
) -> Option<Proven> {
    let n = moving.len();
    part.place(moving, middle, |_| 0.0);
    let gradient = part.energy(local, n, Detail::Gradient).gradient;
    let scale = &curvature.scale;
    let forces = gradient.iter().zip(scale).map(|(force, scale)| (force.to_ball().magnitude() * scale).power(2));
    // Sums and products of n positive numbers: the factor covers their roundings for n below 1e8.
    let force = forces.sum::<f64>().sqrt() * up::HUNDREDS_OF_MILLIONS;
    let sigma = 0.5 * estimate(factors, n);
    // Twice the radius that suffices if half of sigma remains, and never below the rounding error of the middle itself.
    let rounding = middle.iter().zip(scale).map(|(at, scale)| at.hi.abs() * Dd::EPSILON / scale).fold(0.0, f64::max);
    let radius = (4.0 * force / sigma).max(rounding);
    if !radius.is_finite() {
        return None;
    }
    part.place(moving, middle, |i| radius * scale[i] * up::FEW);
    let within = Scaled::with_scale(scale.clone(), entries(part.energy(local, n, Detail::Curvature)));
    Proven::convexity(force, within?.least_eigenvalue(sigma)?, radius)
}

fn entries(energy: Energy<Number>) -> Vec<(u32, u32, Ball)> {
    energy.curvature.into_iter().map(|(i, j, value)| (i, j, value.to_ball())).collect()
}
