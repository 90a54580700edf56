//! Which coordinates depend on which: Gauss-Jordan elimination of the gradients of the constraints, in exact numbers where
//! the state is exact. In: sparse rows over all coordinates; out: each dependent coordinate as a combination of independent
//! and prescribed ones. Clause: spec.md, 6.7.
//!
//! Columns are measured in units of motion (a radian, a length of the loops), and the pivot of a row is its largest entry.
//! Then dependent and independent coordinates are exchanged as long as one moves more than its unit for a unit of the
//! other: every exchange makes the determinant of the dependent columns larger, so the exchanges end, with all entries of
//! the solution at most 1 (S. A. Goreinov, E. E. Tyrtyshnikov, *The maximal-volume concept in approximation by low-rank
//! matrices*, Contemp. Math. 280 (2001) 47-51).

use crate::base::Number;
use crate::lower::kinematics::Index;
use std::collections::{BTreeMap, BTreeSet};

pub type Row = BTreeMap<Index, Number>;

/// q_d + sum of entry times q_i = 0 over the coordinates that are not dependent.
#[derive(Clone, Debug)]
pub struct Solved {
    pub row: Row,
    /// The factors of the constraints that add up to this equation.
    pub combination: BTreeMap<u32, Number>,
}

/// A row that others leave nothing of but prescribed motions.
#[derive(Clone, Debug)]
pub struct Left {
    /// The number of the row.
    pub row: u32,
    /// The factors of the rows that add up to it: its own is 1.
    pub combination: BTreeMap<u32, Number>,
    /// What prescribed motions leave.
    pub driven: Row,
    /// Whether zero was not to be told from what is left.
    pub unclear: bool,
}

/// The equations solved for the dependent coordinates.
#[derive(Clone, Debug, Default)]
pub struct Elimination {
    pub solved: BTreeMap<Index, Solved>,
    pub left: Vec<Left>,
    /// The row at which there was no room for more: what follows was not looked at.
    pub full: Option<u32>,
    /// Entries of all equations and combinations together.
    pub entries: usize,
    /// For each coordinate that is not dependent: the dependent ones whose equations hold it.
    users: BTreeMap<Index, BTreeSet<Index>>,
}

/// Entries smaller than this part of their row as it was are rounding: balls have thirty digits.
const NOTHING: f64 = 1e-15;
/// A coordinate may move this much more than its unit before it is exchanged.
const MARGIN: f64 = 1.0 + 1e-6;

/// Entries of all equations together: about 400 MB of them.
const MAX_ENTRIES: usize = 4_000_000;

/// Eliminates rows in order; coordinates from `free` on are prescribed. `unit` is what a coordinate is measured in.
pub fn eliminate(rows: Vec<Vec<(Index, Number)>>, free: usize, unit: impl Fn(Index) -> f64) -> Elimination {
    let mut elimination = Elimination::default();
    for (number, row) in rows.into_iter().enumerate() {
        elimination.take(number as u32, row, free as Index, &unit);
        if elimination.entries > MAX_ENTRIES {
            elimination.full = Some(number as u32);
            return elimination;
        }
    }
    elimination.exchange(free as Index, &unit);
    elimination
}

impl Elimination {
    fn take(&mut self, number: u32, row: Vec<(Index, Number)>, free: Index, unit: &impl Fn(Index) -> f64) {
        let weight = |(coordinate, entry): (&Index, &Number)| entry.to_f64().abs() * unit(*coordinate);
        let mut solved =
            Solved { row: row.into_iter().collect(), combination: BTreeMap::from([(number, Number::ONE)]) };
        let before = solved.row.iter().map(weight).fold(0.0, f64::max);
        let known: Vec<Index> = solved.row.keys().copied().filter(|i| self.solved.contains_key(i)).collect();
        for coordinate in known {
            solved.subtract(coordinate, &self.solved[&coordinate]);
        }
        let is_something = |entry: &(&Index, &Number)| {
            !entry.1.may_be_zero() && weight(*entry) > if entry.1.exact().is_some() { 0.0 } else { NOTHING * before }
        };
        let candidates = solved.row.iter().filter(|(coordinate, _)| **coordinate < free).filter(is_something);
        // Of equal ones the later: what is declared first stays a coordinate.
        let pivot = candidates.max_by(|a, b| weight(*a).total_cmp(&weight(*b)).then(a.0.cmp(b.0))).map(|(i, _)| *i);
        match pivot {
            Some(pivot) => self.adopt(pivot, solved),
            None => {
                let unclear = solved.row.iter().any(|(coordinate, entry)| {
                    *coordinate < free && entry.to_ball().magnitude() * unit(*coordinate) > NOTHING * before
                });
                let driven = solved.row.into_iter().filter(|(coordinate, _)| *coordinate >= free).collect();
                self.left.push(Left { row: number, combination: solved.combination, driven, unclear });
            }
        }
    }

    /// Makes the coordinate dependent by an equation that holds it.
    fn adopt(&mut self, pivot: Index, mut equation: Solved) {
        equation.normalise(pivot);
        for user in self.users.remove(&pivot).unwrap_or_default() {
            let Some(mut other) = self.solved.remove(&user) else { continue };
            self.forget(user, &other);
            other.subtract(pivot, &equation);
            self.remember(user, &other);
            self.solved.insert(user, other);
        }
        self.remember(pivot, &equation);
        self.solved.insert(pivot, equation);
    }

    fn remember(&mut self, dependent: Index, equation: &Solved) {
        self.entries += equation.row.len() + equation.combination.len();
        for coordinate in equation.row.keys() {
            self.users.entry(*coordinate).or_default().insert(dependent);
        }
    }

    fn forget(&mut self, dependent: Index, equation: &Solved) {
        self.entries -= equation.row.len() + equation.combination.len();
        for coordinate in equation.row.keys() {
            if let Some(users) = self.users.get_mut(coordinate) {
                users.remove(&dependent);
            }
        }
    }

    /// Exchanges dependent and independent coordinates until none moves more than its unit for a unit of another.
    fn exchange(&mut self, free: Index, unit: &impl Fn(Index) -> f64) {
        let mut waiting: BTreeSet<Index> = self.solved.keys().copied().collect();
        while let Some(dependent) = waiting.pop_first() {
            let Some(equation) = self.solved.get(&dependent) else { continue };
            let ratio =
                |(coordinate, entry): (&Index, &Number)| entry.to_f64().abs() * unit(*coordinate) / unit(dependent);
            let entries = equation.row.iter().filter(|(coordinate, entry)| **coordinate < free && !entry.may_be_zero());
            let largest = entries.max_by(|a, b| ratio(*a).total_cmp(&ratio(*b)).then(a.0.cmp(b.0)));
            let Some((coordinate, _)) = largest.filter(|entry| ratio(*entry) > MARGIN) else { continue };
            let coordinate = *coordinate;
            let Some(mut equation) = self.solved.remove(&dependent) else { continue };
            self.forget(dependent, &equation);
            equation.row.insert(dependent, Number::ONE);
            waiting.extend(self.users.get(&coordinate).into_iter().flatten());
            self.adopt(coordinate, equation);
            waiting.insert(coordinate);
        }
    }
}

impl Solved {
    /// Makes the factor of a coordinate 1 and leaves it out.
    fn normalise(&mut self, coordinate: Index) {
        let Some(factor) = self.row.remove(&coordinate) else { return };
        for entry in self.row.values_mut().chain(self.combination.values_mut()) {
            *entry = &*entry / &factor;
        }
    }

    /// Takes a coordinate out by the equation that gives it.
    fn subtract(&mut self, coordinate: Index, by: &Solved) {
        let Some(factor) = self.row.remove(&coordinate) else { return };
        for (other, entry) in &by.row {
            let sum = self.row.entry(*other).or_insert(Number::ZERO);
            *sum = &*sum - &(&factor * entry);
        }
        for (other, entry) in &by.combination {
            let sum = self.combination.entry(*other).or_insert(Number::ZERO);
            *sum = &*sum - &(&factor * entry);
        }
        self.row.retain(|_, entry| !entry.is_zero());
        self.combination.retain(|_, entry| !entry.is_zero());
    }
}
