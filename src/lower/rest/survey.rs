//! A survey of the sets of coupled coordinates: which of them are loaded, and how, so that the search is limited to what
//! moves. See docs/method/rest.md.
//!
//! Two coordinates are coupled if the same spring depends on both, or if a slide turns with an angle. A set is linear if
//! its energy is quadratic: no loaded arm turns, and every spring is linear and acts along a fixed direction.

use super::potential::{Detail, ELSEWHERE, Energy, Potential, Sum};
use crate::base::Number;
use crate::elements::{DeadForce, Response, Stretch};
use crate::lower::constraints::Constraints;
use crate::lower::kinematics::{Index, Kinematics, Path, PathEvaluation, State};
use crate::lower::loads::{self, EndPath, Load};
use crate::model::scene::Scene;

/// A set of coupled coordinates with a load on at least one of them.
#[derive(Clone, Debug)]
pub struct Part {
    /// Ascending.
    pub coordinates: Vec<Index>,
    /// Empty for a large linear set, whose stiffness is in the matrices.
    pub potential: Potential<Number>,
    pub linear: bool,
    /// Indices of the constraints on its coordinates.
    pub constraints: Vec<u32>,
    /// Whether some force on it is certainly not zero.
    pub unbalanced: bool,
}

/// The loaded parts of a scene.
#[derive(Clone, Debug)]
pub struct Survey {
    pub parts: Vec<Part>,
    /// The index of each coordinate, including prescribed ones, in its own part.
    pub local: Vec<u32>,
    /// dV/dq as drawn, N or N m.
    pub forces: Vec<Number>,
}

/// dV/dq of all free coordinates in a state; the sum excludes what `loaded_only` leaves out.
pub fn forces(scene: &Scene, kinematics: &Kinematics, state: &State<Number>, loaded_only: bool) -> Vec<Number> {
    energy(scene, kinematics, state, loaded_only, Detail::Gradient).gradient
}

/// Like [`forces`], of all coordinates, prescribed and released ones included.
pub fn all_forces(scene: &Scene, kinematics: &Kinematics, state: &State<Number>, loaded_only: bool) -> Vec<Number> {
    let local: Vec<u32> = (0..kinematics.total() as u32).collect();
    sum_energy(scene, kinematics, state, loaded_only, (&local, kinematics.total(), Detail::Gradient)).gradient
}

/// The energy in a state, over all free coordinates; the sum excludes what `loaded_only` leaves out.
pub fn energy(
    scene: &Scene,
    kinematics: &Kinematics,
    state: &State<Number>,
    loaded_only: bool,
    detail: Detail,
) -> Energy<Number> {
    let mut local: Vec<u32> = (0..kinematics.total() as u32).collect();
    local[kinematics.n()..].fill(ELSEWHERE);
    sum_energy(scene, kinematics, state, loaded_only, (&local, kinematics.n(), detail))
}

/// The energy over `n` coordinates, whose places `local` gives.
fn sum_energy(
    scene: &Scene,
    kinematics: &Kinematics,
    state: &State<Number>,
    loaded_only: bool,
    (local, n, detail): (&[u32], usize, Detail),
) -> Energy<Number> {
    let mut sum = Sum::new(kinematics, state, local, n, detail);
    loads::visit(scene, kinematics, loaded_only, |load| match load {
        Load::Spring(spring, between) => sum.spring(spring, between),
        Load::Dead(force, path) => sum.dead(&DeadForce { force: force.clone() }, path),
        Load::Torque(angle, torque) => sum.torque(angle, torque),
    });
    sum.energy
}

/// The parts that are loaded according to `forces`.
pub fn survey(
    scene: &Scene,
    kinematics: &Kinematics,
    constraints: &Constraints,
    state: &State<Number>,
    forces: Vec<Number>,
) -> Survey {
    let mut sets = Sets::new(kinematics);
    loads::visit(scene, kinematics, false, |load| sets.tie(load));
    let displaced = sets.tie_constraints(constraints, state);
    let parts_of_roots = sets.loaded_sets(&forces, &displaced);
    let mut survey = Survey { parts: Vec::new(), local: vec![ELSEWHERE; kinematics.total()], forces };
    let mut part_of = vec![ELSEWHERE; kinematics.total()];
    for (coordinate, part) in part_of[..kinematics.n()].iter_mut().enumerate() {
        let root = sets.find(coordinate);
        *part = parts_of_roots[root];
        if *part != ELSEWHERE {
            survey.join(*part as usize, coordinate, !sets.curved[root]);
        }
    }
    for (number, constraint) in constraints.list.iter().enumerate() {
        let part = constraint.equation.coordinates(kinematics).map(|i| part_of[i as usize]).find(|p| *p != ELSEWHERE);
        if let Some(part) = part {
            survey.parts[part as usize].constraints.push(number as u32);
        }
    }
    if survey.parts.iter().any(|part| !part.is_large_and_linear()) {
        loads::visit(scene, kinematics, false, |load| survey.collect(kinematics, &part_of, load));
    }
    survey
}

impl Part {
    /// The longest spring or arm, m; 1 m if there is none.
    pub fn length(&self) -> f64 {
        let line = |stretch: &Stretch<Number>| match stretch {
            Stretch::Line { drawn } | Stretch::Span { drawn, .. } => drawn.norm_squared().to_f64().sqrt(),
            Stretch::Along { .. } | Stretch::Torsion => 0.0,
        };
        let springs = self.potential.springs.iter();
        let springs = springs.map(|(spring, between)| line(&spring.stretch).max(between.path.longest_arm()));
        let longest = springs.fold(0.0, f64::max);
        if longest > 0.0 { longest } else { 1.0 }
    }
}

impl Survey {
    /// Adds a coordinate to a part. New parts are added in order.
    fn join(&mut self, part: usize, coordinate: usize, linear: bool) {
        if part == self.parts.len() {
            let potential = Potential::default();
            let (coordinates, constraints) = (Vec::new(), Vec::new());
            self.parts.push(Part { coordinates, potential, linear, constraints, unbalanced: false });
        }
        let members = &mut self.parts[part];
        self.local[coordinate] = members.coordinates.len() as u32;
        members.coordinates.push(coordinate as Index);
        members.unbalanced |= !self.forces[coordinate].may_be_zero();
    }

    /// Adds a load to the parts that it acts on, except to large linear ones.
    fn collect(&mut self, kinematics: &Kinematics, part_of: &[u32], load: Load) {
        let part = |coordinate: Index| match part_of[coordinate as usize] {
            ELSEWHERE => None,
            part => Some(part as usize),
        };
        match load {
            Load::Spring(spring, between) => {
                let first = coordinates(kinematics, between).find_map(part);
                if let Some(part) = first.map(|part| &mut self.parts[part]).filter(|part| !part.is_large_and_linear()) {
                    part.potential.springs.push((spring.clone(), between.clone()));
                }
            }
            Load::Dead(force, path) => {
                let small = |coordinate| part(coordinate).filter(|part| !self.parts[*part].is_large_and_linear());
                for (part, path) in path.clone().split(kinematics, small) {
                    self.parts[part].potential.dead.push((DeadForce { force: force.clone() }, path));
                }
            }
            Load::Torque(angle, torque) => {
                if let Some(part) = part(angle) {
                    self.parts[part].potential.torques.push((angle, torque.clone()));
                }
            }
        }
    }
}

/// The coordinates that a spring depends on.
fn coordinates<'a>(kinematics: &'a Kinematics, between: &'a EndPath<Number>) -> impl Iterator<Item = Index> + 'a {
    let way = between.path.coordinates(kinematics).flat_map(|(coordinate, angle)| [Some(coordinate), angle]);
    way.flatten().chain(between.angles.into_iter().flatten())
}

/// Sets of free coordinates (union-find with path halving; the least member represents the set).
struct Sets<'a> {
    kinematics: &'a Kinematics,
    parents: Vec<u32>,
    /// For each root: whether the energy is more than quadratic.
    curved: Vec<bool>,
}

impl<'a> Sets<'a> {
    fn new(kinematics: &'a Kinematics) -> Sets<'a> {
        let n = kinematics.n();
        Sets { kinematics, parents: (0..n as u32).collect(), curved: vec![false; n] }
    }

    fn find(&mut self, coordinate: usize) -> usize {
        let mut at = coordinate;
        while self.parents[at] as usize != at {
            self.parents[at] = self.parents[self.parents[at] as usize];
            at = self.parents[at] as usize;
        }
        at
    }

    fn unite(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.parents[a.max(b)] = a.min(b) as u32;
        self.curved[a.min(b)] |= self.curved[a.max(b)];
    }

    fn mark_curved(&mut self, coordinate: Index) {
        if (coordinate as usize) < self.parents.len() {
            let root = self.find(coordinate as usize);
            self.curved[root] = true;
        }
    }

    fn tie(&mut self, load: Load) {
        let n = self.parents.len();
        match load {
            Load::Spring(spring, between) => {
                let linear = match (&spring.response, &spring.stretch) {
                    (Response::Curve { .. }, _) | (_, Stretch::Line { .. }) => false,
                    (_, Stretch::Along { .. }) => between.path.is_straight(),
                    (_, Stretch::Torsion) => true,
                    (_, Stretch::Span { .. }) => between.path.is_empty(),
                };
                let mut first = None;
                for coordinate in coordinates(self.kinematics, between).filter(|i| (*i as usize) < n) {
                    match first {
                        None => first = Some(coordinate),
                        Some(first) => self.unite(first as usize, coordinate as usize),
                    }
                }
                if let Some(first) = first.filter(|_| !linear) {
                    self.mark_curved(first);
                }
            }
            Load::Dead(_, path) => self.tie_way(path),
            Load::Torque(..) => {}
        }
    }

    /// A fixed force acts on each group separately, and on a slide in a turning group together with its angle.
    fn tie_way(&mut self, path: &Path<Number>) {
        if path.is_straight() {
            return;
        }
        let kinematics = self.kinematics;
        for (coordinate, angle) in path.coordinates(kinematics) {
            match angle {
                Some(angle) if (angle as usize) < self.parents.len() && (coordinate as usize) < self.parents.len() => {
                    self.unite(angle as usize, coordinate as usize);
                    self.mark_curved(coordinate);
                }
                _ if kinematics.is_angle(coordinate) => self.mark_curved(coordinate),
                _ => {}
            }
        }
    }

    /// The coordinates of a constraint are coupled; returns a coordinate of each constraint that displaced bases violate.
    fn tie_constraints(&mut self, constraints: &Constraints, state: &State<Number>) -> Vec<usize> {
        let n = self.parents.len();
        let kinematics = self.kinematics;
        let mut reach = PathEvaluation::default();
        let mut displaced = Vec::new();
        for constraint in &constraints.list {
            let equation = &constraint.equation;
            let mut held = equation.coordinates(kinematics).filter(|i| (*i as usize) < n);
            let Some(first) = held.next() else { continue };
            for coordinate in held {
                self.unite(first as usize, coordinate as usize);
            }
            if !equation.is_linear() {
                self.mark_curved(first);
            }
            if !state.is_drawn() && !equation.measure(kinematics, state, &mut reach).0.is_zero() {
                displaced.push(first as usize);
            }
        }
        displaced
    }

    /// For each root, the index of its set among the loaded sets, which are ordered by their first coordinate.
    fn loaded_sets(&mut self, forces: &[Number], displaced: &[usize]) -> Vec<u32> {
        let mut loaded = vec![false; self.parents.len()];
        let forced = (0..forces.len()).filter(|&i| !forces[i].is_zero());
        for coordinate in forced.chain(displaced.iter().copied()) {
            let root = self.find(coordinate);
            loaded[root] = true;
        }
        let mut next = 0..;
        loaded.iter().map(|&loaded| if loaded { next.next().unwrap_or(ELSEWHERE) } else { ELSEWHERE }).collect()
    }
}
