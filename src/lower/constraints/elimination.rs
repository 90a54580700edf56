//! Dependent and independent coordinates: elimination of the gradients of the constraints, in exact numbers if the state
//! is exact. In: sparse rows over all coordinates. Out: each dependent coordinate as a combination of independent and
//! prescribed ones. See docs/method/kinematics.md#independent-coordinates.
//!
//! Columns are measured in units of motion (a radian, a length of the loops), and the pivot of a row is its largest
//! entry. In the forward pass, the pivots of earlier rows are eliminated from each row in turn; in the backward pass,
//! from the last row to the first, those of later rows. Of the factors that combine the rows into an equation, only those
//! of single steps are kept: a chain of n couplings has n² / 2 combined factors, with digits that grow along the chain.
//! They are multiplied out on demand ([`Elimination::combination`]).
//!
//! Fractions stay exact as long as that is affordable ([`Work`]).
//!
//! Then dependent and independent coordinates are exchanged as long as one moves by more than its unit for a unit of the
//! other: every exchange increases the determinant of the dependent columns, so the exchanges end, with all entries of
//! the solution at most 1 (S. A. Goreinov, E. E. Tyrtyshnikov, *The maximal-volume concept in approximation by low-rank
//! matrices*, Contemp. Math. 280 (2001) 47-51).

use crate::base::Number;
use crate::lower::kinematics::Index;
use std::collections::{BTreeMap, BTreeSet};

/// Entries by coordinate, ascending.
pub type Row = Vec<(Index, Number)>;
/// Factors of constraints by their numbers, ascending.
pub type Combination = Vec<(u32, Number)>;
/// A row during elimination.
type Open = BTreeMap<Index, Number>;

/// A constraint that depends on earlier ones except for its prescribed (base-motion) entries.
#[derive(Clone, Debug)]
pub struct DependentRow {
    /// The number of the row.
    pub row: u32,
    /// The factors of the rows that add up to it: its own is 1.
    pub combination: Combination,
    /// The entries of prescribed motions that remain.
    pub driven: Row,
    /// Whether the remainder could not be distinguished from zero.
    pub unclear: bool,
}

/// The equations solved for the dependent coordinates.
#[derive(Clone, Debug, Default)]
pub struct Elimination {
    /// For each dependent coordinate d, q_d + sum of entry times q_i = 0 over the coordinates that are not dependent.
    pub solved: BTreeMap<Index, Row>,
    pub left: Vec<DependentRow>,
    /// The row at which [`MAX_ENTRIES`] was exceeded; later rows were not processed.
    pub full: Option<u32>,
    /// Number of entries of all equations and combinations together; entries with many digits count more than once.
    pub entries: usize,
    work: Work,
    /// The equations after the forward pass, in its order.
    steps: Vec<Step>,
    /// The step that made a coordinate dependent.
    step_of: BTreeMap<Index, usize>,
    /// For each coordinate that is not dependent, the dependent ones whose equations contain it.
    users: BTreeMap<Index, BTreeSet<Index>>,
}

/// q_pivot + row . q = 0, where the row contains no pivot of an earlier step: `scale` times (row `number` minus the
/// equations of earlier steps times the factors in `less`).
#[derive(Clone, Debug)]
struct Step {
    number: u32,
    pivot: Index,
    row: Row,
    scale: Number,
    less: Vec<(usize, Number)>,
}

/// Entries below this share of the original row are rounding errors: balls have thirty digits.
const NOTHING: f64 = 1e-15;
/// A coordinate is exchanged only if it moves by more than its unit by this factor.
const MARGIN: f64 = 1.0 + 1e-6;

/// Limit on the entries of all equations and combinations together: about 400 MB.
pub const MAX_ENTRIES: usize = 4_000_000;
/// Number of bits of an exact number that take as much room as an entry.
const BITS_OF_ENTRY: u64 = 800;

/// The cost of products of entries so far, in products of single 64-bit words. Below [`MAX_WORK`], products of fractions
/// stay fractions; after that, those with many digits become balls.
#[derive(Clone, Copy, Debug, Default)]
struct Work(u64);

/// Some seconds of work: fractions are reduced, which takes as long for each pair of words as about a dozen products.
const MAX_WORK: u64 = 20_000_000;
/// Fractions with at most this many bits stay exact regardless of the work done.
const SHORT: u64 = 512;

impl Work {
    /// Counts the product or quotient that made a number, and returns the number in the form in which it is kept.
    fn round_if_costly(&mut self, number: Number) -> Number {
        let bits = bits(&number);
        self.0 += (1 + bits / 128).pow(2);
        if bits > SHORT && self.0 > MAX_WORK { Number::Ball(number.to_ball()) } else { number }
    }
}

/// Eliminates rows in order; coordinates from `free` on are prescribed. `unit` gives the unit in which a coordinate is
/// measured.
pub fn eliminate(rows: Vec<Vec<(Index, Number)>>, free: usize, unit: impl Fn(Index) -> f64) -> Elimination {
    let mut elimination = Elimination::default();
    for (number, row) in rows.into_iter().enumerate() {
        elimination.eliminate_row(number as u32, row, free as Index, &unit);
        if elimination.is_full(number as u32) {
            return elimination;
        }
    }
    elimination.solve_back();
    if elimination.full.is_none() {
        elimination.exchange(free as Index, &unit);
    }
    elimination
}

impl Elimination {
    fn is_full(&mut self, row: u32) -> bool {
        if self.entries > MAX_ENTRIES {
            self.full = Some(row);
        }
        self.full.is_some()
    }

    fn eliminate_row(&mut self, number: u32, row: Vec<(Index, Number)>, free: Index, unit: &impl Fn(Index) -> f64) {
        let weight = |(coordinate, entry): (&Index, &Number)| entry.to_f64().abs() * unit(*coordinate);
        let mut row: Open = row.into_iter().collect();
        let before = row.iter().map(weight).fold(0.0, f64::max);
        let mut less = self.eliminate_pivots(&mut row);
        let is_something = |entry: &(&Index, &Number)| {
            !entry.1.may_be_zero() && weight(*entry) > if entry.1.exact().is_some() { 0.0 } else { NOTHING * before }
        };
        let candidates = row.iter().filter(|(coordinate, _)| **coordinate < free).filter(is_something);
        // Among equal candidates, the later one: what is declared first stays a coordinate.
        let pivot = candidates.max_by(|a, b| weight(*a).total_cmp(&weight(*b)).then(a.0.cmp(b.0))).map(|(i, _)| *i);
        let Some(pivot) = pivot else {
            let unclear = row.iter().any(|(coordinate, entry)| {
                *coordinate < free && entry.to_ball().magnitude() * unit(*coordinate) > NOTHING * before
            });
            let driven = row.into_iter().filter(|(coordinate, _)| *coordinate >= free).collect();
            let less = less.into_iter().map(|(step, factor)| (step, -&factor)).collect();
            let mut combination = self.expand_steps(less);
            // The rows of these steps come before this one.
            combination.push((number, Number::ONE));
            self.entries += size(&combination);
            return self.left.push(DependentRow { row: number, combination, driven, unclear });
        };
        let scale = normalise(&mut row, pivot, &mut self.work);
        let row: Row = row.into_iter().collect();
        less.shrink_to_fit();
        self.entries += size(&row) + size(&less);
        self.step_of.insert(pivot, self.steps.len());
        self.steps.push(Step { number, pivot, row, scale, less });
    }

    /// Eliminates every pivot from a row, and returns the steps used with their factors. Their rows contain only pivots
    /// of later steps, so each is used once.
    fn eliminate_pivots(&mut self, row: &mut Open) -> Vec<(usize, Number)> {
        let mut less = Vec::new();
        let mut waiting: BTreeSet<usize> = row.keys().filter_map(|i| self.step_of.get(i)).copied().collect();
        while let Some(number) = waiting.pop_first() {
            let step = &self.steps[number];
            if let Some(factor) = subtract(row, step.pivot, &step.row, &mut self.work) {
                waiting.extend(step.row.iter().filter_map(|(i, _)| self.step_of.get(i)));
                less.push((number, factor));
            }
        }
        less
    }

    /// Eliminates the pivots of later steps from each equation.
    fn solve_back(&mut self) {
        for number in (0..self.steps.len()).rev() {
            let step = &self.steps[number];
            let (pivot, mut row): (Index, Open) = (step.pivot, step.row.iter().cloned().collect());
            let pivots: Vec<Index> = row.keys().copied().filter(|i| self.solved.contains_key(i)).collect();
            for other in pivots {
                subtract(&mut row, other, &self.solved[&other], &mut self.work);
            }
            self.store_equation(pivot, row);
            if self.is_full(self.steps[number].number) {
                return;
            }
        }
    }

    /// Makes a coordinate dependent by means of an equation that contains it.
    fn make_dependent(&mut self, pivot: Index, mut equation: Open) {
        normalise(&mut equation, pivot, &mut self.work);
        let equation: Row = equation.into_iter().collect();
        for user in self.users.remove(&pivot).unwrap_or_default() {
            let Some(mut other) = self.remove_equation(user) else { continue };
            subtract(&mut other, pivot, &equation, &mut self.work);
            self.store_equation(user, other);
        }
        self.store_equation(pivot, equation.into_iter().collect());
    }

    fn store_equation(&mut self, dependent: Index, equation: Open) {
        let equation: Row = equation.into_iter().collect();
        self.entries += size(&equation);
        for (coordinate, _) in &equation {
            self.users.entry(*coordinate).or_default().insert(dependent);
        }
        self.solved.insert(dependent, equation);
    }

    fn remove_equation(&mut self, dependent: Index) -> Option<Open> {
        let equation = self.solved.remove(&dependent)?;
        self.entries -= size(&equation);
        for (coordinate, _) in &equation {
            if let Some(users) = self.users.get_mut(coordinate) {
                users.remove(&dependent);
            }
        }
        Some(equation.into_iter().collect())
    }

    /// Exchanges dependent and independent coordinates until none moves by more than its unit for a unit of another.
    fn exchange(&mut self, free: Index, unit: &impl Fn(Index) -> f64) {
        let mut waiting: BTreeSet<Index> = self.solved.keys().copied().collect();
        while let Some(dependent) = waiting.pop_first() {
            let Some(equation) = self.solved.get(&dependent) else { continue };
            let ratio =
                |(coordinate, entry): &(Index, Number)| entry.to_f64().abs() * unit(*coordinate) / unit(dependent);
            let entries = equation.iter().filter(|(coordinate, entry)| *coordinate < free && !entry.may_be_zero());
            let largest = entries.max_by(|a, b| ratio(a).total_cmp(&ratio(b)).then(a.0.cmp(&b.0)));
            let Some((coordinate, _)) = largest.filter(|entry| ratio(entry) > MARGIN) else { continue };
            let coordinate = *coordinate;
            let Some(mut equation) = self.remove_equation(dependent) else { continue };
            equation.insert(dependent, Number::ONE);
            waiting.extend(self.users.get(&coordinate).into_iter().flatten());
            self.make_dependent(coordinate, equation);
            waiting.insert(coordinate);
            if self.is_full(self.steps.last().map_or(0, |step| step.number)) {
                return;
            }
        }
    }

    /// The factors of the constraints whose gradients add up to a sum of equations; each equation is given by its
    /// dependent coordinate and its factor.
    pub fn combination(&self, equations: &[(Index, Number)]) -> Combination {
        let mut work = self.work;
        let mut left = Open::new();
        for (dependent, factor) in equations {
            let Some(row) = self.solved.get(dependent) else { continue };
            add(&mut left, *dependent, factor);
            for (coordinate, entry) in row {
                add(&mut left, *coordinate, &work.round_if_costly(factor * entry));
            }
        }
        // Expresses the sum in equations of the forward pass: among the remaining steps, only the earliest contains its
        // own pivot.
        let mut of_steps = BTreeMap::new();
        let mut waiting: BTreeSet<usize> = left.keys().filter_map(|i| self.step_of.get(i)).copied().collect();
        while let Some(number) = waiting.pop_first() {
            let step = &self.steps[number];
            if let Some(factor) = subtract(&mut left, step.pivot, &step.row, &mut work) {
                waiting.extend(step.row.iter().filter_map(|(i, _)| self.step_of.get(i)));
                of_steps.insert(number, factor);
            }
        }
        self.expand_steps(of_steps)
    }

    /// A sum of equations of the forward pass, given by their factors, as a sum of the constraints' gradients.
    fn expand_steps(&self, mut of_steps: BTreeMap<usize, Number>) -> Combination {
        let mut work = self.work;
        let mut combination = Combination::new();
        while let Some((number, factor)) = of_steps.pop_last() {
            let step = &self.steps[number];
            let factor = work.round_if_costly(&factor * &step.scale);
            for (earlier, less) in &step.less {
                add(&mut of_steps, *earlier, &-&work.round_if_costly(&factor * less));
            }
            if !factor.is_zero() {
                combination.push((step.number, factor));
            }
        }
        combination.reverse();
        combination
    }
}

impl Elimination {
    /// The elimination of some independent rows, ascending, in binary64. Their coordinates, ascending, are counted by their
    /// places in the list.
    pub fn chord(&self, rows: &[u32], coordinates: &[Index]) -> Chord {
        let place = |coordinate: &Index| coordinates.binary_search(coordinate).ok();
        let chosen: Vec<usize> =
            (0..self.steps.len()).filter(|step| rows.binary_search(&self.steps[*step].number).is_ok()).collect();
        let step = |number: &usize| {
            let Step { pivot, row, scale, less, .. } = &self.steps[*number];
            Some(ChordStep {
                pivot: place(pivot)?,
                row: row.iter().filter_map(|(i, entry)| Some((place(i)?, entry.to_f64()))).collect(),
                scale: scale.to_f64(),
                less: (less.iter())
                    .filter_map(|(earlier, factor)| Some((chosen.binary_search(earlier).ok()?, factor.to_f64())))
                    .collect(),
            })
        };
        Chord { steps: chosen.iter().filter_map(step).collect() }
    }
}

/// An elimination in binary64, for the chord method: steps with the derivatives of the drawing.
pub struct Chord {
    steps: Vec<ChordStep>,
}

/// As [`Step`].
struct ChordStep {
    pivot: usize,
    row: Vec<(usize, f64)>,
    scale: f64,
    less: Vec<(usize, f64)>,
}

impl Chord {
    /// Sets the motion of the pivots so that, with that of the others, each row changes by the opposite of `off`.
    pub fn correct(&self, off: &[f64], motion: &mut [f64]) {
        let mut changes: Vec<f64> = Vec::with_capacity(off.len());
        for (step, off) in self.steps.iter().zip(off) {
            let earlier: f64 = step.less.iter().map(|(earlier, factor)| factor * changes[*earlier]).sum();
            changes.push(-step.scale * (off + earlier));
        }
        for (step, change) in self.steps.iter().zip(&changes).rev() {
            let others: f64 = step.row.iter().map(|(place, entry)| entry * motion[*place]).sum();
            motion[step.pivot] = change - others;
        }
    }
}

/// Divides a row by the entry of a coordinate and removes that entry; returns the factor that the other entries were
/// multiplied by.
fn normalise(row: &mut Open, coordinate: Index, work: &mut Work) -> Number {
    let Some(factor) = row.remove(&coordinate) else { return Number::ONE };
    for entry in row.values_mut() {
        *entry = work.round_if_costly(&*entry / &factor);
    }
    &Number::ONE / &factor
}

/// Eliminates a coordinate from a row by the equation that gives it; returns the factor, if the row contains it.
fn subtract(row: &mut Open, coordinate: Index, by: &Row, work: &mut Work) -> Option<Number> {
    let factor = row.remove(&coordinate)?;
    for (other, entry) in by {
        add(row, *other, &-&work.round_if_costly(&factor * entry));
    }
    Some(factor)
}

/// Adds to an entry, and removes it if it becomes exactly zero.
fn add<K: Ord + Copy>(row: &mut BTreeMap<K, Number>, at: K, part: &Number) {
    let sum = row.get(&at).map_or_else(|| part.clone(), |entry| entry + part);
    if sum.is_zero() {
        row.remove(&at);
    } else {
        row.insert(at, sum);
    }
}

/// The number of entries; those with many digits count more than once.
fn size<K>(entries: &[(K, Number)]) -> usize {
    entries.iter().map(|(_, entry)| 1 + (bits(entry) / BITS_OF_ENTRY) as usize).sum()
}

fn bits(number: &Number) -> u64 {
    number.exact().map_or(64, |value| value.bits())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Rational;

    /// Rows of three entries in 1..=9 over 24 coordinates, the last four of them prescribed; every fifth row is the sum
    /// of two earlier ones.
    fn random_rows(mut seed: u64) -> Vec<Row> {
        let mut next = |below: u64| {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 33) % below
        };
        let mut rows: Vec<Row> = Vec::new();
        for number in 0..20 {
            let mut row = Open::new();
            if number % 5 == 4 {
                for of in [next(number), next(number)] {
                    for (coordinate, entry) in &rows[of as usize] {
                        add(&mut row, *coordinate, entry);
                    }
                }
            } else {
                for _ in 0..3 {
                    row.insert(next(24) as Index, Number::from(Rational::from(1 + next(9) as i64)));
                }
            }
            rows.push(row.into_iter().collect());
        }
        rows
    }

    fn sum(rows: &[Row], combination: &Combination) -> Row {
        let mut sum = Open::new();
        for (number, factor) in combination {
            for (coordinate, entry) in &rows[*number as usize] {
                add(&mut sum, *coordinate, &(factor * entry));
            }
        }
        sum.into_iter().collect()
    }

    /// The factors of every equation, and of every row that follows from others, add up exactly.
    #[test]
    fn combinations_add_up_to_their_equations() {
        let (mut dependent, mut left) = (0, 0);
        for seed in 0..60 {
            let rows = random_rows(seed);
            let found = eliminate(rows.clone(), 20, |coordinate| 1.0 + f64::from(coordinate % 3));
            for (coordinate, row) in &found.solved {
                let mut equation: Open = row.iter().cloned().collect();
                assert!(equation.keys().all(|i| !found.solved.contains_key(i)), "{equation:?}");
                equation.insert(*coordinate, Number::ONE);
                let equation: Row = equation.into_iter().collect();
                assert_eq!(sum(&rows, &found.combination(&[(*coordinate, Number::ONE)])), equation, "seed {seed}");
            }
            for row in &found.left {
                assert_eq!(sum(&rows, &row.combination), row.driven, "seed {seed}");
            }
            // The combination of all equations is the sum of their combinations.
            let all: Vec<(Index, Number)> = found.solved.keys().map(|i| (*i, Number::ONE)).collect();
            let whole = sum(&rows, &found.combination(&all));
            assert!(all.iter().all(|(i, _)| whole.iter().any(|(j, entry)| i == j && entry.is_one())), "seed {seed}");
            (dependent, left) = (dependent + found.solved.len(), left + found.left.len());
        }
        assert!(dependent > 500 && left > 100, "{dependent} {left}");
    }

    /// q_i = factor q_(i-1), in an order that joins separate pieces of the chain.
    fn chain(n: u32, factor: &Number) -> Vec<Row> {
        let row = |i: u32| vec![(i, -factor), (i + 1, Number::ONE)];
        (0..n).step_by(3).chain((1..n).step_by(3)).chain((2..n).step_by(3)).map(row).collect()
    }

    #[test]
    fn chains_take_work_and_room_in_proportion_to_their_length() {
        let exact = |a: i64, b: i64| Number::from(&Rational::from(a) / &Rational::from(b));
        let enclosed = Number::Ball(exact(15, 14).to_ball());
        for factor in [Number::ONE, exact(15, 14), exact(14, 15), enclosed] {
            let [one, two] = [4000, 8000].map(|n| eliminate(chain(n, &factor), n as usize + 1, |_| 1.0));
            assert_eq!((one.solved.len(), two.solved.len()), (4000, 8000));
            assert!(one.full.is_none() && two.full.is_none());
            assert!(two.work.0 < 3 * one.work.0, "{} {}", one.work.0, two.work.0);
            assert!(two.entries < 3 * one.entries, "{} {}", one.entries, two.entries);
        }
    }

    /// Beyond [`MAX_WORK`] long fractions become balls, and everything derived from them is still true.
    #[test]
    fn fractions_that_cost_too_much_become_balls() {
        let ratio = Number::from(&Rational::from(15) / &Rational::from(14));
        let mut work = Work(MAX_WORK);
        let (mut kept, mut exact) = (Number::ONE, Rational::from(1));
        for _ in 0..200 {
            kept = work.round_if_costly(&kept * &ratio);
            exact = &exact * ratio.exact().expect("exact");
        }
        assert!(kept.exact().is_none() && bits(&Number::from(exact.clone())) > SHORT);
        assert!((kept.to_ball() - exact.to_ball()).contains_zero());
        assert!(kept.to_ball().relative_error() < 1e-25);
        let mut fresh = Work::default();
        assert_eq!(fresh.round_if_costly(Number::from(exact.clone())), Number::from(exact));
    }
}
