//! From rows over all coordinates of the joint tree to rows over the independent ones, which are the coordinates of the
//! linear system. In: an elimination. Out: a map of rows, forces and multipliers.
//! See docs/method/kinematics.md#independent-coordinates and docs/method/linearisation.md#constraint-forces.

use super::elimination::{Combination, Elimination, Row};
use super::equation::merge_entries;
use crate::base::Number;
use crate::lower::kinematics::{Index, Kinematics, State};
use crate::system::CoordinateId;

/// The coordinates of the linear system.
#[derive(Clone, Debug)]
pub struct Reduction {
    /// Number of free coordinates of the tree.
    free: usize,
    /// Empty if all are independent.
    elimination: Elimination,
    /// The index in the system of each free coordinate; `DEPENDENT` for dependent ones. Empty if all are independent.
    places: Vec<u32>,
    independent: Vec<Index>,
    /// Ascending.
    dependent: Vec<Index>,
}

const DEPENDENT: u32 = u32::MAX;

impl Reduction {
    /// Without constraints: every coordinate of the tree is a coordinate of the system.
    pub fn identity(free: usize) -> Reduction {
        Reduction {
            free,
            elimination: Elimination::default(),
            places: Vec::new(),
            independent: Vec::new(),
            dependent: Vec::new(),
        }
    }

    pub fn new(free: usize, elimination: Elimination) -> Reduction {
        let solved = &elimination.solved;
        let independent: Vec<Index> = (0..free as Index).filter(|i| !solved.contains_key(i)).collect();
        let mut places = vec![DEPENDENT; free];
        for (place, coordinate) in independent.iter().enumerate() {
            places[*coordinate as usize] = place as u32;
        }
        let dependent = solved.keys().copied().collect();
        Reduction { free, elimination, places, independent, dependent }
    }

    /// Whether no coordinate depends on others.
    pub fn is_trivial(&self) -> bool {
        self.elimination.solved.is_empty()
    }

    /// Number of coordinates of the system.
    pub fn n(&self) -> usize {
        self.free - self.elimination.solved.len()
    }

    /// The index in the system of a coordinate of the tree; `None` for dependent and prescribed ones.
    #[inline]
    pub fn place(&self, coordinate: Index) -> Option<CoordinateId> {
        if self.is_trivial() {
            return ((coordinate as usize) < self.free).then_some(CoordinateId(coordinate));
        }
        let place = *self.places.get(coordinate as usize)?;
        (place != DEPENDENT).then_some(CoordinateId(place))
    }

    /// The coordinate of the tree with this index in the system.
    pub fn at(&self, place: usize) -> Index {
        if self.is_trivial() { place as Index } else { self.independent[place] }
    }

    /// Coordinates of the tree that depend on others, ascending.
    pub fn dependent(&self) -> impl Iterator<Item = Index> + '_ {
        self.dependent.iter().copied()
    }

    /// The index of a dependent coordinate among the dependent ones, and the row of q_d + row . q = 0.
    pub fn equation(&self, coordinate: Index) -> Option<(usize, &Row)> {
        let row = self.elimination.solved.get(&coordinate)?;
        Some((self.dependent.binary_search(&coordinate).ok()?, row))
    }

    /// The factors of constraints with which their gradients add up to one at this dependent coordinate and zero at the
    /// others.
    pub fn combination(&self, dependent: Index) -> Combination {
        self.elimination.combination(&[(dependent, Number::ONE)])
    }

    /// Moves the dependent coordinates to the values that prescribed motions give them, in a state whose independent
    /// coordinates are as drawn.
    pub fn follow(&self, kinematics: &Kinematics, state: &mut State<Number>) {
        for (dependent, equation) in &self.elimination.solved {
            let parts = equation.iter().map(|(i, entry)| entry * state.value(*i));
            let value = parts.fold(Number::ZERO, |sum, part| &sum - &part);
            state.set(kinematics, *dependent, value);
        }
    }

    /// Rewrites a row over all coordinates as one over independent and prescribed coordinates, ascending.
    pub fn reduce(&self, row: &mut Vec<(Index, Number)>) {
        if !row.iter().any(|(coordinate, _)| self.elimination.solved.contains_key(coordinate)) {
            return;
        }
        let mut reduced = Vec::with_capacity(row.len());
        for (coordinate, value) in row.drain(..) {
            match self.elimination.solved.get(&coordinate) {
                Some(equation) => reduced.extend(equation.iter().map(|(i, entry)| (*i, -&(&value * entry)))),
                None => reduced.push((coordinate, value)),
            }
        }
        *row = merge_entries(reduced);
    }

    /// Generalised forces reduced to the independent coordinates; zero on the dependent ones.
    pub fn left_of(&self, forces: &[Number]) -> Vec<Number> {
        let mut left = forces.to_vec();
        for (dependent, equation) in &self.elimination.solved {
            let force = std::mem::replace(&mut left[*dependent as usize], Number::ZERO);
            for (coordinate, entry) in equation.iter().filter(|(i, _)| (*i as usize) < self.free) {
                let sum = &left[*coordinate as usize] - &(&force * entry);
                left[*coordinate as usize] = sum;
            }
        }
        left
    }

    /// The multipliers that balance the forces dV/dq on the dependent coordinates: grad V + G^T lambda = 0 there.
    pub fn multipliers(&self, forces: &[Number], count: usize) -> Vec<Number> {
        let mut multipliers = vec![Number::ZERO; count];
        let loaded = self.dependent.iter().map(|i| (*i, forces[*i as usize].clone()));
        let loaded: Vec<(Index, Number)> = loaded.filter(|(_, force)| !force.is_zero()).collect();
        for (constraint, factor) in self.elimination.combination(&loaded) {
            multipliers[constraint as usize] = -&factor;
        }
        multipliers
    }
}
