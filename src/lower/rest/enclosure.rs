//! The rest of a part without constraints: refined in double-double, then proven. See docs/method/rest.md.

use super::convex;
use super::exact::simplest;
use super::krawczyk::{self, Along, Equations, Inverse, NEAR, Part};
use super::potential::{Detail, ELSEWHERE, Energy};
use super::proof::{Proven, Reached};
use super::refinement::Refinement;
use crate::base::number::series::Series;
use crate::base::{Ball, Dd, Jet, Number};
use crate::lower::kinematics::{Index, Kinematics};
use nalgebra::DMatrix;

/// A refined rest.
#[derive(Clone, Debug)]
pub struct Refined {
    /// Largest unbalanced force, relative to the largest that acts.
    pub residual: f64,
    pub proven: Option<Proven>,
    /// Whether the search ends here for all values of parameters that are ranges, where it was tried.
    pub reached: Option<Reached>,
}

/// Larger parts are refined and proven with sparse factors.
pub const MAX_DENSE: usize = 300;

impl Refinement<'_> {
    /// Refines the state, starting from these values in binary64, and encloses the rest.
    pub fn run(mut self, local: &mut [u32], values: &[f64]) -> Refined {
        let drawn = self.energy(local, values.len(), Detail::Sizes);
        for (coordinate, value) in self.coordinates.iter().zip(values) {
            self.set(*coordinate, Ball::from(*value));
        }
        let moving = self.moving_coordinates(local, values);
        // The places of the coordinates that move, numbered on their own; the others are fixed.
        for coordinate in self.coordinates {
            local[*coordinate as usize] = ELSEWHERE;
        }
        for (place, coordinate) in moving.iter().enumerate() {
            local[*coordinate as usize] = place as u32;
        }
        let (proven, reached) = self.refine_and_prove(local, &moving);
        for (place, coordinate) in self.coordinates.iter().enumerate() {
            local[*coordinate as usize] = place as u32;
        }
        let energy = self.energy(local, values.len(), Detail::Sizes);
        Refined { residual: residual(&self, &drawn, &energy), proven, reached }
    }

    /// The coordinates that leave the drawing. One that returned to it is exactly there only if no force acts on it
    /// there, wherever the others are: its force is then a sum of exact zeros.
    fn moving_coordinates(&mut self, local: &[u32], values: &[f64]) -> Vec<Index> {
        let coordinates = self.coordinates;
        let near = |i: Index| NEAR * if self.kinematics.is_angle(i) { 1.0 } else { self.length };
        let mut stays: Vec<bool> = coordinates.iter().zip(values).map(|(i, value)| value.abs() < near(*i)).collect();
        for (coordinate, _) in coordinates.iter().zip(&stays).filter(|(_, stays)| **stays) {
            self.set(*coordinate, Ball::ZERO);
        }
        loop {
            let energy = self.energy(local, values.len(), Detail::Gradient);
            // Over a range of a parameter, one that moves for some values moves.
            let moved: Vec<usize> = (0..values.len()).filter(|&i| stays[i] && !energy.gradient[i].vanishes()).collect();
            if moved.is_empty() {
                break;
            }
            for place in moved {
                stays[place] = false;
                // A ball that is not exactly zero, so that whatever depends on it is not exactly zero either.
                self.set(coordinates[place], Ball::new(Dd::from(values[place]), f64::MIN_POSITIVE));
            }
        }
        coordinates.iter().zip(&stays).filter(|(_, stays)| !**stays).map(|(coordinate, _)| *coordinate).collect()
    }

    fn refine_and_prove(&mut self, local: &[u32], moving: &[Index]) -> (Option<Proven>, Option<Reached>) {
        if moving.is_empty() {
            // A part stays as drawn only if no force acts on it.
            return (Proven::prove_balance(&[]), Some(Reached::as_drawn()));
        }
        if moving.len() > MAX_DENSE {
            return (convex::refine_and_prove(self, local, moving), None);
        }
        let mut middle: Vec<Dd> = moving.iter().map(|i| self.state.value(*i).to_ball().mid).collect();
        let energy = self.energy(local, moving.len(), Detail::Curvature);
        let numbers = energy.gradient.iter().chain(energy.curvature.iter().map(|(_, _, value)| value));
        let ranged = numbers.clone().any(Number::is_range);
        let has_series = ranged && numbers.clone().any(|x| x.is_range() && Series::of(x).is_some());
        let mut forces = Forces { part: self, local, moving, ranged };
        let Some(inverse) = forces.inverse(&energy) else { return (None, None) };
        if inverse.is_singular() {
            inverse.without_drift(&mut middle);
        }
        let last = inverse.refine(&mut forces, &mut middle);
        if has_series {
            let Some((enclosed, rest)) = inverse.prove_along(&mut forces, &middle) else { return (None, None) };
            forces.place_along(&rest);
            return (Some(enclosed.proven), enclosed.reached);
        }
        if ranged {
            let Some((enclosed, rest)) = inverse.prove_over_ranges(&mut forces, &middle) else { return (None, None) };
            for (coordinate, jet) in moving.iter().zip(rest) {
                self.state.set(self.kinematics, *coordinate, Number::from(jet));
            }
            return (Some(enclosed.proven), enclosed.reached);
        }
        let proven = inverse.prove(&mut forces, &middle);
        if proven.is_none() {
            // An estimate: another step would gain as many digits as the last one.
            forces.place(&middle, &|i| last * middle[i].hi.abs().max(NEAR));
        }
        // If nothing restrains some motion, there is a choice of rests along it.
        let known = if inverse.is_singular() { 1e-14 } else { 1e-28 };
        (self.is_exactly_rational(local, moving, known).or(proven), None)
    }

    /// Whether all forces vanish exactly at the simplest fractions within the relative distance `known`; if so, leaves
    /// the state there.
    fn is_exactly_rational(&mut self, local: &[u32], moving: &[Index], known: f64) -> Option<Proven> {
        let balls: Vec<Ball> = moving.iter().map(|i| self.state.value(*i).to_ball()).collect();
        let fractions: Option<Vec<_>> = balls.iter().map(|ball| simplest(*ball, known)).collect();
        for (coordinate, fraction) in moving.iter().zip(fractions?) {
            self.state.set(self.kinematics, *coordinate, Number::Exact(fraction));
        }
        let exact = Proven::prove_balance(&self.energy(local, moving.len(), Detail::Gradient).gradient);
        if exact.is_none() {
            for (coordinate, ball) in moving.iter().zip(balls) {
                self.set(*coordinate, ball);
            }
        }
        exact
    }
}

/// The forces on the coordinates that move.
struct Forces<'r, 'a> {
    part: &'r mut Refinement<'a>,
    local: &'r [u32],
    moving: &'r [Index],
    /// Whether a parameter that they depend on is a range.
    ranged: bool,
}

impl Forces<'_, '_> {
    /// `None` if the second derivative leaves the range of binary64.
    fn inverse(&self, energy: &Energy<Number>) -> Option<Inverse> {
        let n = self.moving.len();
        let (curvature, _) = self.dense(energy);
        let scale: Vec<f64> = (0..n).map(|i| curvature[(i, i)].abs().sqrt().max(f64::MIN_POSITIVE).recip()).collect();
        Inverse::of(&curvature, &scale)
    }

    fn dense(&self, energy: &Energy<Number>) -> (DMatrix<f64>, DMatrix<f64>) {
        let entries = energy.curvature.iter().map(|(i, j, value)| (*i, *j, value));
        match self.ranged {
            true => krawczyk::dense_over_ranges(entries, self.moving.len()),
            false => krawczyk::dense(entries, self.moving.len()),
        }
    }
}

impl Equations for Forces<'_, '_> {
    fn place(&mut self, middle: &[Dd], radius: &dyn Fn(usize) -> f64) {
        if self.ranged {
            // Every question about what depends on the place is noted, as those about the parameters are.
            for (place, coordinate) in self.moving.iter().enumerate() {
                let anywhere = Jet { value: Ball::new(middle[place], radius(place)), slope: Ball::ZERO };
                self.part.state.set(self.part.kinematics, *coordinate, Number::from(anywhere));
            }
            return;
        }
        self.part.place(self.moving, middle, radius);
    }

    fn remaining_forces(&self) -> Vec<Number> {
        self.part.energy(self.local, self.moving.len(), Detail::Gradient).gradient
    }

    fn slope(&self) -> (DMatrix<f64>, DMatrix<f64>) {
        self.dense(&self.part.energy(self.local, self.moving.len(), Detail::Curvature))
    }
}

impl Along for Forces<'_, '_> {
    fn place_along(&mut self, z: &[Series]) {
        for (coordinate, series) in self.moving.iter().zip(z) {
            self.part.state.set(self.part.kinematics, *coordinate, series.clone().into_number());
        }
    }

    fn slope_along(&self) -> Option<Vec<Part>> {
        let energy = self.part.energy(self.local, self.moving.len(), Detail::Curvature);
        let entries = energy.curvature.iter().map(|(i, j, value)| (*i, *j, value));
        krawczyk::dense_along(entries, self.moving.len())
    }
}

/// The largest unbalanced force, relative to the largest that acts in the part, as drawn or at rest.
fn residual(part: &Refinement, drawn: &Energy<Number>, energy: &Energy<Number>) -> f64 {
    let sizes: Vec<f64> = drawn.forces.iter().zip(&energy.forces).map(|(drawn, now)| drawn.max(*now)).collect();
    relative(part.kinematics, part.coordinates, part.length, &sizes, &energy.gradient)
}

/// The largest of some forces, relative to the largest acting force of the same kind, or of the other kind with a length
/// as lever arm.
pub fn relative(kinematics: &Kinematics, coordinates: &[Index], length: f64, acting: &[f64], left: &[Number]) -> f64 {
    let turns = |place: usize| kinematics.is_angle(coordinates[place]);
    let largest = |turning: bool| {
        let sizes = acting.iter().enumerate().filter(|(place, _)| turns(*place) == turning);
        sizes.map(|(_, size)| *size).fold(0.0, f64::max)
    };
    let (pull, torque) = (largest(false), largest(true));
    let scale = |turning: bool| if turning { torque.max(pull * length) } else { pull.max(torque / length) };
    let relative = |(place, force): (usize, &Number)| match force.enclosure().magnitude() {
        0.0 => 0.0,
        left => left / scale(turns(place)),
    };
    left.iter().enumerate().map(relative).fold(0.0, f64::max)
}
