//! The coordinates that move one point relative to another, and that motion with its derivatives at a state. See
//! docs/method/kinematics.md.

use super::{Group, Index, Kinematics, NO_TURN};
use crate::base::Number;
use crate::elements::{Scalar, Vector};
use std::collections::BTreeMap;

/// The coordinates that move one point relative to another: arms of groups and slides, as drawn.
#[derive(Clone, Debug)]
pub struct Path<S> {
    pub(super) turns: Vec<Turn<S>>,
    pub(super) runs: Vec<Run<S>>,
}

/// The arm of a turning group.
#[derive(Clone, Debug)]
pub(super) struct Turn<S> {
    pub group: u32,
    pub arm: Vector<S>,
}

/// A slide on the path, and the group with which its direction turns.
#[derive(Clone, Debug)]
pub(super) struct Run<S> {
    pub coordinate: Index,
    pub group: u32,
    pub direction: Vector<S>,
}

impl<S> Default for Path<S> {
    fn default() -> Path<S> {
        Path { turns: Vec::new(), runs: Vec::new() }
    }
}

impl<S> Path<S> {
    pub(super) fn clear(&mut self) {
        self.turns.clear();
        self.runs.clear();
    }

    pub fn is_empty(&self) -> bool {
        self.turns.is_empty() && self.runs.is_empty()
    }

    /// Frees memory reserved for longer paths, which a stored path does not need.
    pub fn shrink_to_fit(&mut self) {
        self.turns.shrink_to_fit();
        self.runs.shrink_to_fit();
    }
}

impl<S> Path<S> {
    /// Whether all motion along this path is in fixed directions.
    pub fn is_straight(&self) -> bool {
        self.turns.is_empty() && self.runs.iter().all(|run| run.group == NO_TURN)
    }

    /// The coordinates of the path one by one; a slide in a turning group comes with the angle of that group.
    pub fn coordinates<'a>(&'a self, kinematics: &'a Kinematics) -> impl Iterator<Item = (Index, Option<Index>)> + 'a {
        let angle = |group: u32| kinematics.groups[group as usize].coordinate;
        let turns = self.turns.iter().map(move |turn| (angle(turn.group), None));
        let carried = move |group: u32| (group != NO_TURN).then(|| angle(group));
        turns.chain(self.runs.iter().map(move |run| (run.coordinate, carried(run.group))))
    }
}

impl Path<Number> {
    /// Whether all motion along this path is in one fixed direction.
    pub fn keeps_to(&self, direction: &Vector<Number>) -> bool {
        self.is_straight() && self.runs.iter().all(|run| run.direction.cross(direction).is_zero())
    }

    /// The longest arm, m.
    pub fn longest_arm(&self) -> f64 {
        self.turns.iter().map(|turn| turn.arm.norm_squared().to_f64().sqrt()).fold(0.0, f64::max)
    }

    /// The sections of a path that carries a fixed force, by the part of the scene they belong to; this is possible
    /// because such a path is a sum.
    pub fn split(
        self,
        kinematics: &Kinematics,
        part_of: impl Fn(Index) -> Option<usize>,
    ) -> BTreeMap<usize, Path<Number>> {
        let mut parts: BTreeMap<usize, Path<Number>> = BTreeMap::new();
        for turn in self.turns {
            if let Some(part) = part_of(kinematics.groups[turn.group as usize].coordinate) {
                parts.entry(part).or_default().turns.push(turn);
            }
        }
        for run in self.runs {
            if let Some(part) = part_of(run.coordinate) {
                parts.entry(part).or_default().runs.push(run);
            }
        }
        parts
    }

    pub fn convert<S: Scalar>(&self) -> Path<S> {
        let vector = |v: &Vector<Number>| Vector { x: S::of(&v.x), y: S::of(&v.y), z: S::of(&v.z) };
        let turn = |turn: &Turn<Number>| Turn { group: turn.group, arm: vector(&turn.arm) };
        let run =
            |run: &Run<Number>| Run { coordinate: run.coordinate, group: run.group, direction: vector(&run.direction) };
        Path { turns: self.turns.iter().map(turn).collect(), runs: self.runs.iter().map(run).collect() }
    }
}

/// The sine and the cosine of an angle. One that takes many values is the sum of two, about which a vector turns one after the other: so
/// the lever arms of a range are as narrow as those about its middle.
#[derive(Clone, Debug)]
pub(super) struct Rotation<S> {
    first: (S, S),
    then: Option<(S, S)>,
}

impl<S: Scalar> Rotation<S> {
    fn by(angle: &S) -> Rotation<S> {
        match angle.middle_and_change() {
            Some((middle, change)) => Rotation { first: middle.sin_cos(), then: Some(change.sin_cos()) },
            None => Rotation { first: angle.sin_cos(), then: None },
        }
    }

    fn of(&self, v: &Vector<S>, axis: &Vector<S>) -> Vector<S> {
        let turned = v.rotate(axis, &self.first.0, &self.first.1);
        match &self.then {
            Some((sine, cosine)) => turned.rotate(axis, sine, cosine),
            None => turned,
        }
    }
}

/// Values of the coordinates, with the rotations of the groups evaluated.
#[derive(Clone, Debug)]
pub struct State<S> {
    /// Empty if all are as drawn.
    pub(super) values: Vec<S>,
    /// The rotation of each group; `None` if it has not turned.
    pub(super) turned: Vec<Option<Rotation<S>>>,
    zero: S,
}

impl<S: Scalar> State<S> {
    /// Everything as drawn.
    pub fn as_drawn() -> State<S> {
        State { values: Vec::new(), turned: Vec::new(), zero: S::zero() }
    }

    pub fn is_drawn(&self) -> bool {
        self.values.is_empty()
    }

    pub fn value(&self, coordinate: Index) -> &S {
        self.values.get(coordinate as usize).unwrap_or(&self.zero)
    }

    /// A vector rotated by an angle coordinate.
    pub fn rotate_by(&self, kinematics: &Kinematics, angle: Index, v: &Vector<S>) -> Vector<S> {
        match self.turned.get(kinematics.group_of[angle as usize] as usize) {
            Some(Some(rotation)) => rotation.of(v, &kinematics.axis(angle)),
            _ => v.clone(),
        }
    }

    /// Moves one coordinate.
    pub fn set(&mut self, kinematics: &Kinematics, coordinate: Index, value: S) {
        if self.values.is_empty() {
            self.values = vec![S::zero(); kinematics.total()];
            self.turned = vec![None; kinematics.groups.len()];
        }
        let group = kinematics.group_of[coordinate as usize];
        if group != NO_TURN {
            self.turned[group as usize] = (!value.is_zero()).then(|| Rotation::by(&value));
        }
        self.values[coordinate as usize] = value;
    }
}

impl State<Number> {
    /// Whether some coordinate depends on a parameter that is a range.
    pub fn is_ranged(&self) -> bool {
        self.values.iter().any(Number::is_range)
    }

    pub fn convert<S: Scalar>(&self, kinematics: &Kinematics) -> State<S> {
        let mut state = State::as_drawn();
        for (coordinate, value) in self.values.iter().enumerate().filter(|(_, value)| !value.is_zero()) {
            state.set(kinematics, coordinate as Index, S::of(value));
        }
        state
    }
}

/// A path at a state: displacement of its far end relative to the near end, and the derivatives.
#[derive(Clone, Debug)]
pub struct PathEvaluation<S> {
    pub displacement: Vector<S>,
    /// d(displacement)/dq; coordinates are distinct. Those of `swept` come first, then the directions of the slides.
    pub columns: Vec<(Index, Vector<S>)>,
    /// w_g of each group on the way, with its axis and coordinate.
    swept: Vec<Swept<S>>,
    /// The index in `swept` of the group of each slide; `None` if its direction does not turn.
    carried: Vec<Option<usize>>,
}

#[derive(Clone, Debug)]
struct Swept<S> {
    group: u32,
    coordinate: Index,
    axis: Vector<S>,
    arm: Vector<S>,
}

impl<S: Scalar> Default for PathEvaluation<S> {
    fn default() -> PathEvaluation<S> {
        PathEvaluation { displacement: Vector::zero(), columns: Vec::new(), swept: Vec::new(), carried: Vec::new() }
    }
}

impl<S: Scalar> PathEvaluation<S> {
    /// Evaluates a path at a state.
    pub fn measure(&mut self, kinematics: &Kinematics, state: &State<S>, path: &Path<S>) {
        self.displacement = Vector::zero();
        self.columns.clear();
        self.swept.clear();
        self.carried.clear();
        for turn in &path.turns {
            let arm = self.rotate(kinematics, state, turn.group, &turn.arm);
            if let Some(arm) = &arm {
                self.displacement = self.displacement.plus(&arm.minus(&turn.arm));
            }
            self.push_swept(kinematics, turn.group, arm.unwrap_or_else(|| turn.arm.clone()));
        }
        // Indices in `swept` of the groups of slides; empty if none of them turns.
        let mut places: BTreeMap<u32, usize> = BTreeMap::new();
        if path.runs.iter().any(|run| run.group != NO_TURN) {
            places.extend(self.swept.iter().enumerate().map(|(place, swept)| (swept.group, place)));
        }
        for run in &path.runs {
            let rotated = self.rotate(kinematics, state, run.group, &run.direction);
            let direction = rotated.unwrap_or_else(|| run.direction.clone());
            let value = state.value(run.coordinate);
            let way = (!value.is_zero()).then(|| direction.scale(value));
            if let Some(way) = &way {
                self.displacement = self.displacement.plus(way);
            }
            let place = (run.group != NO_TURN).then(|| {
                let way = way.unwrap_or_else(Vector::zero);
                self.sweep(kinematics, run.group, way, &mut places)
            });
            self.carried.push(place);
            self.columns.push((run.coordinate, direction));
        }
        let turning = self.swept.iter().map(|swept| (swept.coordinate, swept.axis.cross(&swept.arm)));
        self.columns.extend(turning);
        self.columns.rotate_right(self.swept.len());
    }

    /// Whether no group turns on the way, so that the displacement is linear in the coordinates.
    pub fn is_straight(&self) -> bool {
        self.swept.is_empty()
    }

    /// R_g v; `None` if the group has not turned.
    fn rotate(&self, kinematics: &Kinematics, state: &State<S>, group: u32, v: &Vector<S>) -> Option<Vector<S>> {
        let rotation = state.turned.get(group as usize)?.as_ref()?;
        Some(rotation.of(v, &Vector::of(&kinematics.groups[group as usize].axis)))
    }

    /// Adds an arm to the entry of its group in `swept`, and returns the index of that entry.
    fn sweep(
        &mut self,
        kinematics: &Kinematics,
        group: u32,
        arm: Vector<S>,
        places: &mut BTreeMap<u32, usize>,
    ) -> usize {
        let place = *places.entry(group).or_insert(self.swept.len());
        match self.swept.get_mut(place) {
            Some(swept) => swept.arm = swept.arm.plus(&arm),
            None => self.push_swept(kinematics, group, arm),
        }
        place
    }

    /// Adds an entry for a group; a path has each group once.
    fn push_swept(&mut self, kinematics: &Kinematics, group: u32, arm: Vector<S>) {
        let Group { coordinate, axis } = &kinematics.groups[group as usize];
        self.swept.push(Swept { group, coordinate: *coordinate, axis: Vector::of(axis), arm });
    }

    /// direction . d(displacement)/dq, without zeros.
    pub fn row(&self, direction: &Vector<S>, row: &mut Vec<(Index, S)>) {
        row.clear();
        row.extend(self.columns.iter().filter_map(|(coordinate, column)| {
            let entry = direction.dot(column);
            (!entry.is_zero()).then_some((*coordinate, entry))
        }));
    }

    /// d2(force . displacement)/dq_i dq_j for a fixed force, without zeros, each pair once.
    pub fn curvature(&self, force: &Vector<S>, mut visit: impl FnMut(Index, Index, S)) {
        for swept in &self.swept {
            let second = swept.axis.cross(&swept.axis.cross(&swept.arm));
            let entry = force.dot(&second);
            if !entry.is_zero() {
                visit(swept.coordinate, swept.coordinate, entry);
            }
        }
        for (place, (coordinate, direction)) in self.carried.iter().zip(&self.columns[self.swept.len()..]) {
            // A slide in a turning group has an entry in `swept`, even if its arm is zero.
            let Some(swept) = place.map(|place| &self.swept[place]) else { continue };
            let entry = force.dot(&swept.axis.cross(direction));
            if !entry.is_zero() {
                visit(swept.coordinate, *coordinate, entry);
            }
        }
    }
}
