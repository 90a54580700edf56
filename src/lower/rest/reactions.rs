//! The rest of a part with constraints: coordinates and multipliers are found together.
//! See docs/method/rest.md#closed-loops.
//!
//! The equations are grad V + G^T lambda = 0 and g = 0 in z = (q, lambda), with the symmetric derivative
//! [W G^T; G 0], W = grad^2 V + lambda . grad^2 g: refined and enclosed as in [`krawczyk`].

use super::enclosure::{self, MAX_DENSE, Refined};
use super::exact::simplest;
use super::krawczyk::{self, Equations, Inverse, NEAR};
use super::potential::{Detail, ELSEWHERE, Potential};
use super::proof::Proven;
use crate::base::{Ball, Dd, Number, Rational};
use crate::lower::constraints::equation::Equation;
use crate::lower::kinematics::{Index, Kinematics, PathEvaluation, State};
use nalgebra::{DMatrix, DVector};

/// A part with constraints near its rest.
pub struct Balance<'a> {
    pub kinematics: &'a Kinematics,
    pub coordinates: &'a [Index],
    pub local: &'a [u32],
    pub potential: &'a Potential<Number>,
    pub equations: Vec<&'a Equation<Number>>,
    pub state: &'a mut State<Number>,
    pub multipliers: Vec<Number>,
    /// The longest spring or arm of the part, m.
    pub length: f64,
}

impl Balance<'_> {
    /// Refines the state, starting from these values in binary64, and encloses the rest.
    pub fn run(mut self, values: &[f64]) -> Refined {
        let n = values.len();
        let drawn = self.sizes();
        let mut middle: Vec<Dd> = values.iter().copied().map(Dd::from).collect();
        middle.resize(n + self.equations.len(), Dd::ZERO);
        self.place(&middle, &|_| 0.0);
        for (at, multiplier) in middle[n..].iter_mut().zip(self.least_multipliers()) {
            *at = Dd::from(multiplier);
        }
        let proven = self.refine_and_prove(&mut middle);
        Refined { residual: self.residual(&drawn), proven, reached: None }
    }

    fn refine_and_prove(&mut self, middle: &mut [Dd]) -> Option<Proven> {
        if middle.len() > 2 * MAX_DENSE {
            // The search in binary64 stops at steps of 1e-13 of an angle or a length.
            let sizes: Vec<f64> = middle.iter().map(|at| at.hi.abs().max(1.0)).collect();
            self.place(middle, &|i| 1e-12 * sizes[i]);
            return None;
        }
        self.place(middle, &|_| 0.0);
        let (slope, _) = self.slope();
        let inverse = Inverse::of(&slope, &equilibrium(&slope))?;
        if inverse.is_singular() {
            inverse.without_drift(middle);
        }
        let last = inverse.refine(self, middle);
        let proven = inverse.prove(self, middle);
        if proven.is_none() {
            // An estimate: another step would gain as many digits as the last one.
            let radius = |i: usize| last * middle[i].hi.abs().max(NEAR);
            self.place(middle, &radius);
        }
        // If nothing restrains some motion, there is a choice of rests along it.
        let known = if inverse.is_singular() { 1e-14 } else { 1e-28 };
        self.is_exactly_rational(known).or(proven)
    }

    /// Whether everything balances exactly at the simplest fractions within the relative distance `known`; if so, leaves
    /// the state there.
    fn is_exactly_rational(&mut self, known: f64) -> Option<Proven> {
        let fraction = |ball: Ball| if ball.contains_zero() { Some(Rational::ZERO) } else { simplest(ball, known) };
        let balls: Vec<Ball> = self.coordinates.iter().map(|i| self.state.value(*i).to_ball()).collect();
        let multipliers = self.multipliers.clone();
        let fractions: Option<Vec<_>> =
            balls.iter().copied().chain(multipliers.iter().map(Number::to_ball)).map(fraction).collect();
        for (place, fraction) in fractions?.into_iter().map(Number::Exact).enumerate() {
            match self.coordinates.get(place) {
                Some(coordinate) => self.state.set(self.kinematics, *coordinate, fraction),
                None => self.multipliers[place - self.coordinates.len()] = fraction,
            }
        }
        let exact = Proven::prove_balance(&self.remaining_forces());
        if exact.is_none() {
            for (coordinate, ball) in self.coordinates.iter().zip(balls) {
                self.set(*coordinate, ball);
            }
            self.multipliers = multipliers;
        }
        exact
    }

    fn set(&mut self, coordinate: Index, value: Ball) {
        let value = if value.is_zero() { Number::ZERO } else { Number::Ball(value) };
        self.state.set(self.kinematics, coordinate, value);
    }

    /// The multipliers that minimise the remaining forces, in binary64.
    fn least_multipliers(&self) -> Vec<f64> {
        let (n, m) = (self.coordinates.len(), self.equations.len());
        let gradient = self.potential.at(self.kinematics, self.state, self.local, n, Detail::Gradient).gradient;
        let gradient = DVector::from_iterator(n, gradient.iter().map(Number::to_f64));
        let mut rows = DMatrix::zeros(m, n);
        for (k, (_, row)) in self.measure().iter().enumerate() {
            for (place, entry) in row {
                rows[(k, *place as usize)] = entry.to_f64();
            }
        }
        let square = &rows * rows.transpose();
        square.lu().solve(&-(&rows * gradient)).map_or(vec![0.0; m], |found| found.iter().copied().collect())
    }

    /// g and its gradient over the places of the part.
    fn measure(&self) -> Vec<(Number, Vec<(u32, Number)>)> {
        let mut reach = PathEvaluation::default();
        let of = |equation: &&Equation<Number>| {
            let (value, row) = equation.measure(self.kinematics, self.state, &mut reach);
            let placed = row.into_iter().map(|(coordinate, entry)| (self.local[coordinate as usize], entry));
            (value, placed.filter(|(place, _)| *place != ELSEWHERE).collect())
        };
        self.equations.iter().map(of).collect()
    }

    /// Sizes of the forces that act.
    fn sizes(&self) -> Vec<f64> {
        self.potential.at(self.kinematics, self.state, self.local, self.coordinates.len(), Detail::Sizes).forces
    }

    /// The largest unbalanced force, relative to the largest that acts, as drawn or at rest, including reactions.
    fn residual(&self, drawn: &[f64]) -> f64 {
        let n = self.coordinates.len();
        let mut sizes: Vec<f64> = self.sizes().iter().zip(drawn).map(|(now, drawn)| now.max(*drawn)).collect();
        if sizes.iter().all(|size| *size == 0.0) {
            // Nothing acts: the reactions are rounding errors of zero.
            return 0.0;
        }
        for ((_, row), multiplier) in self.measure().iter().zip(&self.multipliers) {
            for (place, entry) in row {
                sizes[*place as usize] += (entry.to_f64() * multiplier.to_f64()).abs();
            }
        }
        enclosure::relative(self.kinematics, self.coordinates, self.length, &sizes, &self.remaining_forces()[..n])
    }
}

impl Equations for Balance<'_> {
    fn place(&mut self, middle: &[Dd], radius: &dyn Fn(usize) -> f64) {
        let (coordinates, n) = (self.coordinates, self.coordinates.len());
        for (place, coordinate) in coordinates.iter().enumerate() {
            self.set(*coordinate, Ball::new(middle[place], radius(place)));
        }
        let ball = |place: usize| Number::Ball(Ball::new(middle[place], radius(place)));
        self.multipliers = (n..middle.len()).map(ball).collect();
    }

    fn remaining_forces(&self) -> Vec<Number> {
        let n = self.coordinates.len();
        let mut left = self.potential.at(self.kinematics, self.state, self.local, n, Detail::Gradient).gradient;
        let measured = self.measure();
        for ((_, row), multiplier) in measured.iter().zip(&self.multipliers) {
            for (place, entry) in row {
                let sum = &left[*place as usize] + &(multiplier * entry);
                left[*place as usize] = sum;
            }
        }
        left.extend(measured.into_iter().map(|(value, _)| value));
        left
    }

    fn slope(&self) -> (DMatrix<f64>, DMatrix<f64>) {
        let n = self.coordinates.len();
        let mut entries = self.potential.at(self.kinematics, self.state, self.local, n, Detail::Curvature).curvature;
        let mut reach = PathEvaluation::default();
        for (equation, multiplier) in self.equations.iter().zip(&self.multipliers) {
            equation.curvature(self.kinematics, self.state, multiplier, &mut reach, |i, j, value| {
                let (i, j) = (self.local[i as usize], self.local[j as usize]);
                if i != ELSEWHERE && j != ELSEWHERE {
                    entries.push((i, j, value));
                }
            });
        }
        for (k, (_, row)) in self.measure().into_iter().enumerate() {
            entries.extend(row.into_iter().map(|(place, entry)| ((n + k) as u32, place, entry)));
        }
        krawczyk::dense(entries.iter().map(|(i, j, value)| (*i, *j, value)), n + self.equations.len())
    }
}

/// Scale factors for rows and columns that bring the largest entry of each to about 1: a few iterations of D. Ruiz, *A
/// scaling algorithm to equilibrate both rows and columns norms in matrices*, RAL-TR-2001-034.
pub fn equilibrium(matrix: &DMatrix<f64>) -> Vec<f64> {
    let n = matrix.nrows();
    let mut scale = vec![1.0; n];
    for _ in 0..8 {
        let largest = |i: usize| (0..n).map(|j| (matrix[(i, j)] * scale[j]).abs()).fold(0.0, f64::max) * scale[i];
        let rows: Vec<f64> = (0..n).map(largest).collect();
        for (scale, row) in scale.iter_mut().zip(rows) {
            if row > 0.0 {
                *scale /= row.sqrt();
            }
        }
    }
    scale
}
