//! The potential energy of loads and springs in any state, with first and second derivatives: in binary64 for the search,
//! in [`Number`](crate::base::Number) for results. See docs/method/rest.md.

use crate::base::Number;
use crate::base::number::jet;
use crate::elements::{DeadForce, Response, Scalar, Spring, Stretch, Vector};
use crate::lower::kinematics::{Index, Kinematics, Path, PathEvaluation, State};
use crate::lower::loads::{self, EndPath};

/// The sources of potential energy of a set of coordinates.
#[derive(Clone, Debug)]
pub struct Potential<S> {
    pub springs: Vec<(Spring<S>, EndPath<S>)>,
    /// Weights and constant forces.
    pub dead: Vec<(DeadForce<S>, Path<S>)>,
    /// Constant torques on angles.
    pub torques: Vec<(Index, S)>,
}

impl<S> Default for Potential<S> {
    fn default() -> Potential<S> {
        Potential { springs: Vec::new(), dead: Vec::new(), torques: Vec::new() }
    }
}

/// Energy and derivatives in a state, over the coordinates of one part of the scene with local indices.
#[derive(Clone, Debug)]
pub struct Energy<S> {
    pub value: S,
    pub gradient: Vec<S>,
    /// For each coordinate, the sum of force times lever arm over everything that acts on it, to compare the gradient
    /// with. Only with `Detail::Sizes` or more.
    pub forces: Vec<f64>,
    /// Sum of the magnitudes of all energies, for the rounding error of their sum.
    pub size: f64,
    /// Entries of the second derivative in a fixed order of places; each pair in one order only, places may repeat.
    pub curvature: Vec<(u32, u32, S)>,
}

/// The parts of an energy that are computed; each includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Detail {
    Gradient,
    Sizes,
    Curvature,
}

/// The local index of a coordinate that is in no part, such as a prescribed one.
pub const ELSEWHERE: u32 = u32::MAX;

impl Potential<Number> {
    /// Whether it depends on a parameter that is a range, be it in places that no force comes from at rest.
    pub fn is_ranged(&self) -> bool {
        let is_curve = |spring: &Spring<Number>| match &spring.response {
            Response::Curve { curve, .. } => curve.is_ranged(),
            Response::Linear { .. } => false,
        };
        // A number of a range is noted when one is taken for all of it.
        self.springs.iter().any(|(spring, _)| is_curve(spring))
            || jet::without_division(|| self.convert::<f64>()).is_none()
    }

    pub fn convert<S: Scalar>(&self) -> Potential<S> {
        let vector = |v: &Vector<Number>| Vector { x: S::of(&v.x), y: S::of(&v.y), z: S::of(&v.z) };
        let stretch = |stretch: &Stretch<Number>| match stretch {
            Stretch::Line { drawn } => Stretch::Line { drawn: vector(drawn) },
            Stretch::Along { direction } => Stretch::Along { direction: vector(direction) },
            Stretch::Torsion => Stretch::Torsion,
            Stretch::Span { drawn, gap, left } => Stretch::Span { drawn: vector(drawn), gap: S::of(gap), left: *left },
        };
        let spring = |spring: &Spring<Number>| spring.convert(stretch(&spring.stretch), S::of);
        Potential {
            springs: self.springs.iter().map(|(s, between)| (spring(s), between.convert())).collect(),
            dead: self.dead.iter().map(|(f, path)| (DeadForce { force: vector(&f.force) }, path.convert())).collect(),
            torques: self.torques.iter().map(|(angle, torque)| (*angle, S::of(torque))).collect(),
        }
    }
}

impl<S: Scalar> Potential<S> {
    /// Energy and derivatives over `n` coordinates.
    pub fn at(&self, kinematics: &Kinematics, state: &State<S>, local: &[u32], n: usize, detail: Detail) -> Energy<S> {
        let mut sum = Sum::new(kinematics, state, local, n, detail);
        for (spring, between) in &self.springs {
            sum.spring(spring, between);
        }
        for (dead, path) in &self.dead {
            sum.dead(dead, path);
        }
        for (angle, torque) in &self.torques {
            sum.torque(*angle, torque);
        }
        sum.energy
    }
}

/// A sum of energies in progress.
pub struct Sum<'a, S> {
    kinematics: &'a Kinematics,
    state: &'a State<S>,
    local: &'a [u32],
    detail: Detail,
    pub energy: Energy<S>,
    reach: PathEvaluation<S>,
    row: Vec<(Index, S)>,
}

impl<'a, S: Scalar> Sum<'a, S> {
    pub fn new(
        kinematics: &'a Kinematics,
        state: &'a State<S>,
        local: &'a [u32],
        n: usize,
        detail: Detail,
    ) -> Sum<'a, S> {
        let energy = Energy {
            value: S::zero(),
            gradient: vec![S::zero(); n],
            forces: vec![0.0; n],
            size: 0.0,
            curvature: Vec::new(),
        };
        Sum { kinematics, state, local, detail, energy, reach: PathEvaluation::default(), row: Vec::new() }
    }

    pub fn spring(&mut self, spring: &Spring<S>, between: &EndPath<S>) {
        self.reach.measure(self.kinematics, self.state, &between.path);
        let stretched = spring.stretch.at(&self.reach.displacement, &between.turn(self.state));
        self.value(spring.energy(&stretched));
        let tension = spring.tension(&stretched);
        let rate = stretched.rate(&tension);
        let length_squared = loads::slope(&stretched, &self.reach, between, &mut self.row);
        self.force(&rate);
        if let Some(force) = stretched.force(&rate) {
            self.sizes(&force);
            self.wind_sizes(&tension, between);
        } else {
            self.turn_sizes(&tension);
        }
        if self.detail < Detail::Curvature {
            return;
        }
        self.square(&spring.stiffness(&stretched).over(&length_squared));
        for square in stretched.tension_squares(&rate).into_iter().flatten() {
            self.reach.row(&square.direction, &mut self.row);
            self.square(&square.weight);
        }
        if let Some(force) = stretched.force(&rate) {
            self.curvature(&force);
        }
    }

    pub fn dead(&mut self, dead: &DeadForce<S>, path: &Path<S>) {
        self.reach.measure(self.kinematics, self.state, path);
        self.value(dead.energy(&self.reach.displacement));
        self.reach.row(&dead.force, &mut self.row);
        self.force(&S::one().negate());
        self.sizes(&dead.force);
        if self.detail == Detail::Curvature {
            self.curvature(&dead.force.negate());
        }
    }

    pub fn torque(&mut self, angle: Index, torque: &S) {
        self.value(torque.times(self.state.value(angle)).negate());
        self.row.clear();
        self.row.push((angle, S::one()));
        self.force(&torque.negate());
        self.turn_sizes(torque);
    }

    fn value(&mut self, value: S) {
        self.energy.size += value.to_f64().abs();
        self.energy.value = self.energy.value.plus(&value);
    }

    /// gradient += rate row.
    fn force(&mut self, rate: &S) {
        for (coordinate, entry) in &self.row {
            let place = self.local[*coordinate as usize];
            if place != ELSEWHERE {
                let sum = &mut self.energy.gradient[place as usize];
                *sum = sum.plus(&rate.times(entry));
            }
        }
    }

    /// Adds force times lever arm to every coordinate of the path in `reach`.
    fn sizes(&mut self, force: &Vector<S>) {
        if self.detail < Detail::Sizes {
            return;
        }
        let size = force.norm_squared().to_f64().sqrt();
        for (coordinate, column) in &self.reach.columns {
            if let Some(sum) = self.energy.forces.get_mut(self.local[*coordinate as usize] as usize) {
                *sum += size * column.norm_squared().to_f64().sqrt();
            }
        }
    }

    /// Adds the moments that a span of a belt has about its disks.
    fn wind_sizes(&mut self, tension: &S, between: &EndPath<S>) {
        let Some(winds) = &between.winds else { return };
        for (angle, wind) in between.angles.iter().zip(winds) {
            let place = angle.and_then(|angle| self.local.get(angle as usize)).map_or(ELSEWHERE, |place| *place);
            if let Some(sum) = self.energy.forces.get_mut(place as usize) {
                *sum += (tension.to_f64() * wind.to_f64()).abs();
            }
        }
    }

    /// Adds the magnitude of a torque to every angle of the row.
    fn turn_sizes(&mut self, torque: &S) {
        for (coordinate, _) in &self.row {
            if let Some(sum) = self.energy.forces.get_mut(self.local[*coordinate as usize] as usize) {
                *sum += torque.to_f64().abs();
            }
        }
    }

    /// curvature += weight row row^T.
    fn square(&mut self, weight: &S) {
        for (a, (i, left)) in self.row.iter().enumerate() {
            let weighted = weight.times(left);
            for (j, right) in &self.row[..=a] {
                let (i, j) = (self.local[*i as usize], self.local[*j as usize]);
                if i != ELSEWHERE && j != ELSEWHERE {
                    self.energy.curvature.push((i, j, weighted.times(right)));
                }
            }
        }
    }

    /// curvature += force . grad^2 of the path in `reach`.
    fn curvature(&mut self, force: &Vector<S>) {
        let (local, entries) = (self.local, &mut self.energy.curvature);
        self.reach.curvature(force, |i, j, value| {
            let (i, j) = (local[i as usize], local[j as usize]);
            if i != ELSEWHERE && j != ELSEWHERE {
                entries.push((i, j, value));
            }
        });
    }
}
