//! Rests without any tension: a body that floats on a spring, or parts held only by their own springs. In: a part near
//! such a rest. Out: a proven rest in which every spring is exactly slack. See docs/method/rest.md#proof.
//!
//! If springs are the only loads, every position in which all of them have their free lengths is a rest. If such rests
//! leave motions free, there are many, and no operator contracts to one of them. The one nearest to the drawing is unique
//! (or, if that is not found, the one nearest to where the search ended): with e the stretches beyond the free lengths, D
//! the measure of [`newton`](super::newton) and q0 the position it is to be near, it solves
//!
//!   D (q - q0) + sum lambda_e grad e = 0,   e(q) = 0,
//!
//! which is enclosed as in [`krawczyk`]. A solution in the box is a position without tension, whatever its lambda are.

use super::krawczyk::{self, Equations, Inverse};
use super::potential::{Detail, ELSEWHERE, Potential};
use super::proof::Proven;
use super::reactions::equilibrium;
use super::survey::Part;
use crate::base::{Ball, Dd, Number};
use crate::elements::{Response, Scalar, Spring};
use crate::lower::kinematics::{Index, Kinematics, PathEvaluation, State};
use crate::lower::loads::{self, EndPath};
use nalgebra::DMatrix;

/// The coordinates of parts that rest without any tension.
#[derive(Clone, Debug, Default)]
pub struct Slack {
    /// Empty if there are none.
    of: Vec<bool>,
}

impl Slack {
    pub const NONE: Slack = Slack { of: Vec::new() };

    /// Whether a spring has exactly no tension at rest.
    pub fn contains(&self, kinematics: &Kinematics, between: &EndPath<Number>) -> bool {
        let of = |i: Index| self.of.get(i as usize) == Some(&true);
        !self.of.is_empty()
            && (between.path.coordinates(kinematics).any(|(i, angle)| of(i) || angle.is_some_and(of))
                || between.angles.into_iter().flatten().any(of))
    }

    pub fn add(&mut self, kinematics: &Kinematics, part: &Part) {
        self.of.resize(kinematics.total(), false);
        part.coordinates.iter().for_each(|i| self.of[*i as usize] = true);
    }
}

/// Limit on the number of coordinates plus springs, for dense matrices.
const MAX_DENSE: usize = 300;
/// Limit on the Newton steps: each gains sixteen digits at the end, but more of them are needed on a curved path.
const MAX_STEPS: usize = 20;
/// Relative size of a step after which another would change nothing.
const NEGLIGIBLE_STEP: f64 = 1e-20;

/// Moves the part to a rest without tension near the values found in binary64, and proves it; if it cannot, leaves the
/// state where it was.
pub fn prove(
    kinematics: &Kinematics,
    part: &Part,
    local: &[u32],
    values: &[f64],
    state: &mut State<Number>,
) -> Option<Proven> {
    let potential = &part.potential;
    let nothing_else = potential.dead.is_empty() && potential.torques.is_empty() && part.constraints.is_empty();
    let is_stiff = |spring: &Spring<Number>| matches!(&spring.response, Response::Linear { stiffness, .. } if stiffness.is_positive());
    let all_springs = potential.springs.iter().all(|(spring, _)| is_stiff(spring));
    if !(nothing_else && all_springs) || values.len() + potential.springs.len() > MAX_DENSE {
        return None;
    }
    let before: Vec<Number> = part.coordinates.iter().map(|i| state.value(*i).clone()).collect();
    let unit = |i: &Index| if kinematics.is_angle(*i) { 1.0 } else { part.length() };
    let units: Vec<f64> = part.coordinates.iter().map(unit).collect();
    let drawing = vec![0.0; values.len()];
    let mut nearest = Nearest { kinematics, part, local, from: &drawing, units, state, multipliers: Vec::new() };
    let mut proven = nearest.prove(values);
    if proven.is_none() {
        nearest.from = values;
        proven = nearest.prove(values);
    }
    if proven.is_none() {
        for (coordinate, value) in part.coordinates.iter().zip(before) {
            state.set(kinematics, *coordinate, value);
        }
    }
    proven
}

/// The equations in the text of this module.
struct Nearest<'a> {
    kinematics: &'a Kinematics,
    part: &'a Part,
    local: &'a [u32],
    from: &'a [f64],
    units: Vec<f64>,
    state: &'a mut State<Number>,
    multipliers: Vec<Number>,
}

impl Nearest<'_> {
    fn prove(&mut self, start: &[f64]) -> Option<Proven> {
        let mut middle: Vec<Dd> = start.iter().copied().map(Dd::from).collect();
        middle.resize(start.len() + self.part.potential.springs.len(), Dd::ZERO);
        for _ in 0..MAX_STEPS {
            self.place(&middle, &|_| 0.0);
            let (slope, _) = self.slope();
            let inverse = Inverse::of(&slope, &equilibrium(&slope)).filter(|inverse| !inverse.is_singular())?;
            if inverse.refine(self, &mut middle) <= NEGLIGIBLE_STEP {
                return inverse.prove(self, &middle);
            }
        }
        None
    }

    /// 1 / unit^2
    fn weight(&self, place: usize) -> Number {
        Number::Ball(Ball::from(1.0) / Ball::from(self.units[place]) / Ball::from(self.units[place]))
    }

    /// The potential with the gradient sum lambda grad e: each spring has a tension but no stiffness.
    fn pulls(&self) -> Potential<Number> {
        let pull = |((spring, between), multiplier): (&(Spring<Number>, EndPath<Number>), &Number)| {
            let (stretch, preload) = (spring.stretch.clone(), multiplier.clone());
            (Spring { stretch, response: Response::Linear { stiffness: Number::ZERO, preload } }, between.clone())
        };
        let springs = self.part.potential.springs.iter().zip(&self.multipliers).map(pull).collect();
        Potential { springs, ..Potential::default() }
    }

    /// The stretch of each spring beyond its free length, and its gradient over the places of the part.
    fn stretches(&self) -> Vec<(Number, Vec<(u32, Number)>)> {
        let (mut reach, mut row) = (PathEvaluation::default(), Vec::new());
        let of = |(spring, between): &(Spring<Number>, EndPath<Number>)| {
            reach.measure(self.kinematics, self.state, &between.path);
            let stretched = spring.stretch.at(&reach.displacement, &between.turn(self.state));
            let length = loads::slope(&stretched, &reach, between, &mut row).root();
            let placed = row.iter().map(|(i, entry)| (self.local[*i as usize], entry / &length));
            let placed = placed.filter(|(place, _)| *place != ELSEWHERE).collect();
            (&spring.tension(&stretched) / &spring.stiffness(&stretched), placed)
        };
        self.part.potential.springs.iter().map(of).collect()
    }
}

impl Equations for Nearest<'_> {
    fn place(&mut self, middle: &[Dd], radius: &dyn Fn(usize) -> f64) {
        let ball = |place: usize| Number::Ball(Ball::new(middle[place], radius(place)));
        let n = self.from.len();
        for (place, coordinate) in self.part.coordinates.iter().enumerate() {
            self.state.set(self.kinematics, *coordinate, ball(place));
        }
        self.multipliers = (n..middle.len()).map(ball).collect();
    }

    fn remaining_forces(&self) -> Vec<Number> {
        let n = self.from.len();
        let mut left = self.pulls().at(self.kinematics, self.state, self.local, n, Detail::Gradient).gradient;
        for (place, coordinate) in self.part.coordinates.iter().enumerate() {
            let moved = self.state.value(*coordinate) - &Number::Ball(Ball::from(self.from[place]));
            left[place] = &left[place] + &(&self.weight(place) * &moved);
        }
        left.extend(self.stretches().into_iter().map(|(stretch, _)| stretch));
        left
    }

    fn slope(&self) -> (DMatrix<f64>, DMatrix<f64>) {
        let n = self.from.len();
        let mut entries = self.pulls().at(self.kinematics, self.state, self.local, n, Detail::Curvature).curvature;
        entries.extend((0..n).map(|place| (place as u32, place as u32, self.weight(place))));
        for (k, (_, row)) in self.stretches().into_iter().enumerate() {
            entries.extend(row.into_iter().map(|(place, entry)| ((n + k) as u32, place, entry)));
        }
        krawczyk::dense(entries.iter().map(|(i, j, value)| (*i, *j, value)), n + self.multipliers.len())
    }
}
