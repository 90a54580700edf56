//! From a rest in binary64 to one that is known: refined in double-double, then proven. Clause: spec.md, "Rest".
//!
//! With Y near the inverse of H = grad^2 V, the Krawczyk operator m - Y g(m) + (1 - Y H(X)) (X - m) maps the box X about m
//! into its interior only if X holds exactly one rest (R. Krawczyk, *Newton-Algorithmen zur Bestimmung von Nullstellen mit
//! Fehlerschranken*, Computing 4 (1969) 187-201; R. E. Moore, *A test for existence of solutions to nonlinear systems*, SIAM
//! J. Numer. Anal. 14 (1977) 611-615). H(X) and g(m) are evaluated in ball arithmetic.

use super::convex;
use super::exact::simplest;
use super::potential::{Detail, ELSEWHERE, Energy, Potential};
use super::survey::Part;
use crate::base::{Ball, Dd, Number};
use crate::lower::kinematics::{Index, Kinematics, State};
use nalgebra::{DMatrix, DVector};

/// A part near its rest.
pub struct Refinement<'a> {
    pub kinematics: &'a Kinematics,
    pub coordinates: &'a [Index],
    pub potential: &'a Potential<Number>,
    pub state: &'a mut State<Number>,
    /// The longest spring or arm of the part, m.
    length: f64,
}

/// What is known of a rest.
#[derive(Clone, Debug)]
pub struct Refined {
    /// Largest force that is left, relative to the largest that acts.
    pub residual: f64,
    pub proven: bool,
}

/// Parts with more coordinates are refined and proven with sparse factors.
pub const MAX_DENSE: usize = 300;
/// Each step gains the sixteen digits of binary64, less those that the conditioning takes.
pub const MAX_REFINEMENTS: usize = 8;
/// Coordinates nearer to the drawing than this, in radians or lengths of the part, may be there exactly.
pub const NEAR: f64 = 1e-9;

impl<'a> Refinement<'a> {
    pub fn new(kinematics: &'a Kinematics, part: &'a Part, state: &'a mut State<Number>) -> Refinement<'a> {
        let (coordinates, potential) = (&part.coordinates[..], &part.potential);
        Refinement { kinematics, coordinates, potential, state, length: part.length() }
    }

    /// Refines the state from these values in binary64 and encloses the rest.
    pub fn run(mut self, local: &mut [u32], values: &[f64]) -> Refined {
        let drawn = self.energy(local, values.len(), Detail::Sizes);
        for (coordinate, value) in self.coordinates.iter().zip(values) {
            self.set(*coordinate, Ball::from(*value));
        }
        let moving = self.moving(local, values);
        // The places of those that move, in their own order; the others are fixed.
        for coordinate in self.coordinates {
            local[*coordinate as usize] = ELSEWHERE;
        }
        for (place, coordinate) in moving.iter().enumerate() {
            local[*coordinate as usize] = place as u32;
        }
        let proven = self.refine_and_prove(local, &moving);
        for (place, coordinate) in self.coordinates.iter().enumerate() {
            local[*coordinate as usize] = place as u32;
        }
        let energy = self.energy(local, values.len(), Detail::Sizes);
        Refined { residual: residual(&self, &drawn, &energy), proven }
    }

    fn set(&mut self, coordinate: Index, value: Ball) {
        let value = if value.is_zero() { Number::ZERO } else { Number::Ball(value) };
        self.state.set(self.kinematics, coordinate, value);
    }

    pub fn energy(&self, local: &[u32], n: usize, detail: Detail) -> Energy<Number> {
        self.potential.at(self.kinematics, self.state, local, n, detail)
    }

    /// The coordinates that leave the drawing. One that came back to it stays there exactly if no force acts on it there,
    /// wherever the others are: its force is then a sum of exact zeros.
    fn moving(&mut self, local: &[u32], values: &[f64]) -> Vec<Index> {
        let coordinates = self.coordinates;
        let near = |i: Index| NEAR * if self.kinematics.is_angle(i) { 1.0 } else { self.length };
        let mut stays: Vec<bool> = coordinates.iter().zip(values).map(|(i, value)| value.abs() < near(*i)).collect();
        for (coordinate, _) in coordinates.iter().zip(&stays).filter(|(_, stays)| **stays) {
            self.set(*coordinate, Ball::ZERO);
        }
        loop {
            let energy = self.energy(local, values.len(), Detail::Gradient);
            let moved: Vec<usize> = (0..values.len()).filter(|&i| stays[i] && !energy.gradient[i].is_zero()).collect();
            if moved.is_empty() {
                break;
            }
            for place in moved {
                stays[place] = false;
                // A ball that is not exactly zero, so that what depends on it is not either.
                self.set(coordinates[place], Ball::new(Dd::from(values[place]), f64::MIN_POSITIVE));
            }
        }
        coordinates.iter().zip(&stays).filter(|(_, stays)| !**stays).map(|(coordinate, _)| *coordinate).collect()
    }

    fn refine_and_prove(&mut self, local: &[u32], moving: &[Index]) -> bool {
        if moving.is_empty() {
            return true;
        }
        if moving.len() > MAX_DENSE {
            return convex::refine_and_prove(self, local, moving);
        }
        let Some(inverse) = self.inverse(local, moving) else { return false };
        let mut middle: Vec<Dd> = moving.iter().map(|i| self.state.value(*i).to_ball().mid).collect();
        if inverse.neutral.ncols() > 0 {
            inverse.without_drift(&mut middle);
        }
        let mut last = f64::INFINITY;
        for _ in 0..MAX_REFINEMENTS {
            self.place(moving, &middle, |_| 0.0);
            let energy = self.energy(local, moving.len(), Detail::Gradient);
            let step = inverse.apply(&energy.gradient);
            let size =
                step.iter().zip(&middle).map(|(step, at)| step.abs() / at.hi.abs().max(NEAR)).fold(0.0, f64::max);
            if size >= last {
                break;
            }
            last = size;
            for (at, step) in middle.iter_mut().zip(&step) {
                *at -= Dd::from(*step);
            }
        }
        let proven = inverse.prove(self, local, moving, &middle);
        if !proven {
            // An estimate: another step would gain as many digits as the last one did.
            let radius = |i: usize| last * middle[i].hi.abs().max(NEAR);
            self.place(moving, &middle, radius);
        }
        // Along a motion that nothing holds there is a choice of rests.
        let known = if inverse.neutral.ncols() > 0 { 1e-14 } else { 1e-28 };
        self.is_exactly_rational(local, moving, known) || proven
    }

    /// Whether all forces vanish exactly at the simplest fractions within the relative distance `known`; leaves the state there then.
    fn is_exactly_rational(&mut self, local: &[u32], moving: &[Index], known: f64) -> bool {
        let balls: Vec<Ball> = moving.iter().map(|i| self.state.value(*i).to_ball()).collect();
        let fractions: Option<Vec<_>> = balls.iter().map(|ball| simplest(*ball, known)).collect();
        let Some(fractions) = fractions else { return false };
        for (coordinate, fraction) in moving.iter().zip(fractions) {
            self.state.set(self.kinematics, *coordinate, Number::Exact(fraction));
        }
        let exact = self.energy(local, moving.len(), Detail::Gradient).gradient.iter().all(Number::is_zero);
        if !exact {
            for (coordinate, ball) in moving.iter().zip(balls) {
                self.set(*coordinate, ball);
            }
        }
        exact
    }

    /// Puts the moving coordinates at these middles with these radii.
    pub fn place(&mut self, moving: &[Index], middle: &[Dd], radius: impl Fn(usize) -> f64) {
        for (place, coordinate) in moving.iter().enumerate() {
            self.set(*coordinate, Ball::new(middle[place], radius(place)));
        }
    }

    /// Y; `None` where the second derivative is singular to working precision.
    fn inverse(&mut self, local: &[u32], moving: &[Index]) -> Option<Inverse> {
        let n = moving.len();
        let (curvature, _) = dense(&self.energy(local, n, Detail::Curvature), n);
        // Scaled so that what is small for its units only does not count as singular.
        let scale: Vec<f64> = (0..n).map(|i| curvature[(i, i)].abs().sqrt().max(f64::MIN_POSITIVE).recip()).collect();
        let scaled = DMatrix::from_fn(n, n, |i, j| curvature[(i, j)] * scale[i] * scale[j]);
        let (inverse, neutral) = inverted(scaled)?;
        let y = DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] * scale[i] * scale[j]);
        let neutral = DMatrix::from_fn(n, neutral.ncols(), |i, j| neutral[(i, j)] * scale[i]);
        y.iter().all(|entry| entry.is_finite()).then_some(Inverse { y, neutral })
    }
}

/// The inverse; where it is singular to working precision, the inverse of what is not, and the motions that nothing holds.
fn inverted(matrix: DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let n = matrix.nrows();
    if let Some(inverse) = matrix.clone().try_inverse() {
        let wrong = (&inverse * &matrix - DMatrix::identity(n, n)).amax();
        if wrong < 0.1 {
            return Some((inverse, DMatrix::zeros(n, 0)));
        }
    }
    let eigen = matrix.try_symmetric_eigen(f64::EPSILON, 0)?;
    // Below this an eigenvalue is the rounding of a few hundred sums.
    let least = 1e-12 * eigen.eigenvalues.amax();
    let inverse = eigen.eigenvalues.map(|value| if value.abs() > least { value.recip() } else { 0.0 });
    let neutral: Vec<usize> = (0..n).filter(|&i| eigen.eigenvalues[i].abs() <= least).collect();
    let inverse = &eigen.eigenvectors * DMatrix::from_diagonal(&inverse) * eigen.eigenvectors.transpose();
    Some((inverse, eigen.eigenvectors.select_columns(&neutral)))
}

/// An approximate inverse of the second derivative, and the motions that it leaves out because nothing holds them.
struct Inverse {
    y: DMatrix<f64>,
    neutral: DMatrix<f64>,
}

impl Inverse {
    /// Takes back the drift along motions that nothing holds: the rest nearest to the drawing is meant.
    fn without_drift(&self, middle: &mut [Dd]) {
        let Some(inverse) = (self.neutral.transpose() * &self.neutral).try_inverse() else { return };
        let at = DVector::from_iterator(middle.len(), middle.iter().map(|at| at.to_f64()));
        let drift = &self.neutral * (inverse * (self.neutral.transpose() * at));
        for (at, drift) in middle.iter_mut().zip(drift.iter()) {
            *at -= Dd::from(*drift);
        }
    }

    /// Y g, in binary64.
    fn apply(&self, gradient: &[Number]) -> Vec<f64> {
        let gradient = DVector::from_iterator(gradient.len(), gradient.iter().map(Number::to_f64));
        (&self.y * gradient).iter().copied().collect()
    }

    /// Finds radii that the Krawczyk operator maps into themselves; leaves the state in that box.
    fn prove(&self, part: &mut Refinement, local: &[u32], moving: &[Index], middle: &[Dd]) -> bool {
        let n = moving.len();
        part.place(moving, middle, |_| 0.0);
        let gradient = part.energy(local, n, Detail::Gradient).gradient;
        let defect: Vec<f64> = (0..n).map(|i| self.defect(i, &gradient)).collect();
        let mut radius: Vec<f64> =
            (0..n).map(|i| 2.0 * defect[i] + middle[i].hi.abs() * Dd::EPSILON + f64::MIN_POSITIVE).collect();
        for _ in 0..6 {
            part.place(moving, middle, |i| radius[i]);
            let mapped = self.mapped(&part.energy(local, n, Detail::Curvature), &defect, &radius);
            if mapped.iter().zip(&radius).all(|(mapped, radius)| mapped < radius) {
                return true;
            }
            for (radius, mapped) in radius.iter_mut().zip(&mapped) {
                *radius = 4.0 * mapped.max(*radius);
            }
        }
        false
    }

    /// A bound of |Y g|_i.
    fn defect(&self, i: usize, gradient: &[Number]) -> f64 {
        let products = gradient.iter().enumerate().map(|(j, force)| force.to_ball() * Ball::from(self.y[(i, j)]));
        products.fold(Ball::ZERO, |sum, product| sum + product).magnitude()
    }

    /// A bound of |Y g| + |1 - Y H(X)| r, rounding included.
    fn mapped(&self, energy: &Energy<Number>, defect: &[f64], radius: &[f64]) -> Vec<f64> {
        let n = radius.len();
        let (middle, spread) = dense(energy, n);
        let product = &self.y * &middle;
        let sizes = self.y.abs() * (middle.abs() * ((n + 2) as f64 * f64::EPSILON) + spread);
        let radii = DVector::from_column_slice(radius);
        let wrong = DMatrix::from_fn(n, n, |i, j| {
            let identity = if i == j { 1.0 } else { 0.0 };
            (identity - product[(i, j)]).abs() * (1.0 + f64::EPSILON) + sizes[(i, j)]
        });
        // Sums of n positive numbers: each is right to n roundings, which the factor covers for all n up to MAX_DENSE.
        (wrong * radii).iter().zip(defect).map(|(moved, defect)| (moved + defect) * (1.0 + 1e-12)).collect()
    }
}

/// The second derivative as binary64 numbers and what they may be wrong by.
fn dense(energy: &Energy<Number>, n: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    let mut sums = vec![Number::ZERO; n * n];
    for (i, j, value) in &energy.curvature {
        let sum = &mut sums[*i.max(j) as usize * n + *i.min(j) as usize];
        *sum = &*sum + value;
    }
    let at = |i: usize, j: usize| sums[i.max(j) * n + i.min(j)].to_ball();
    let middle = DMatrix::from_fn(n, n, |i, j| at(i, j).mid.hi);
    // The low part of the middle, and the radius.
    let spread = DMatrix::from_fn(n, n, |i, j| {
        let ball = at(i, j);
        (ball.mid.lo.abs() + ball.rad) * (1.0 + 1e-15)
    });
    (middle, spread)
}

/// The largest force that is left, relative to the largest that acts in the part, as drawn or at rest: of the same kind, or
/// of the other with the length of the part as lever.
fn residual(part: &Refinement, drawn: &Energy<Number>, energy: &Energy<Number>) -> f64 {
    let turns = |place: usize| part.kinematics.is_angle(part.coordinates[place]);
    let largest = |turning: bool| {
        let sizes = drawn.forces.iter().zip(&energy.forces).map(|(drawn, now)| drawn.max(*now));
        sizes.enumerate().filter(|(place, _)| turns(*place) == turning).map(|(_, size)| size).fold(0.0, f64::max)
    };
    let (pull, torque) = (largest(false), largest(true));
    let scale = |turning: bool| if turning { torque.max(pull * part.length) } else { pull.max(torque / part.length) };
    let relative = |(place, force): (usize, &Number)| match force.to_ball().magnitude() {
        0.0 => 0.0,
        left => left / scale(turns(place)),
    };
    energy.gradient.iter().enumerate().map(relative).fold(0.0, f64::max)
}
