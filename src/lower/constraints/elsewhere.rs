//! Equations that follow from the others as drawn, to the second order, compared where the parts have moved. In: these
//! equations, the elimination as drawn. Out: those that do not hold there. See
//! docs/method/kinematics.md#dependent-constraints.
//!
//! The middle of Watt's linkage is on a straight line as drawn, with its tangent and curvature, and leaves it further
//! away: a guide along that line locks it. The loops are followed by the chord method (J. M. Ortega, W. C. Rheinboldt,
//! *Iterative Solution of Nonlinear Equations in Several Variables*, 1970, section 7.1): Newton steps with the derivatives
//! of the drawing.

use super::elimination::{Chord, DependentRow, Elimination};
use super::equation::Equation;
use super::{Constraints, NOTHING, unit};
use crate::lower::kinematics::{Index, Kinematics, PathEvaluation, State};
use std::collections::{BTreeMap, BTreeSet};

/// Motion of each independent coordinate at first, in radians or lengths of its loops; half of it where these do not close.
const FAR: f64 = 0.25;
/// How often it is halved: down to a thousandth.
const HALVINGS: u32 = 8;
/// What is zero at one position by chance is not at another.
const POSITIONS: usize = 2;
/// Limit on the steps of one position: fifty that halve the distance reach the last digit.
const MAX_STEPS: u32 = 60;
/// A violation that counts as closed, in radians or lengths: rounding errors of sums of a few lengths.
const CLOSED: f64 = 1e-14;

/// What other positions say about an equation that follows from others as drawn, the best first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Elsewhere {
    /// All of these equations are linear: what is so as drawn is so everywhere.
    Same,
    Holds,
    Broken,
    /// The loops do not close even where little has moved.
    Unknown,
}

/// What other positions say about each of some rows, in their order.
pub fn compare(
    kinematics: &Kinematics,
    all: &Constraints,
    elimination: &Elimination,
    rows: &[&DependentRow],
) -> Vec<Elsewhere> {
    let is_bent =
        |row: &DependentRow| row.combination.iter().any(|(number, _)| !all.list[*number as usize].equation.is_linear());
    let mut said = vec![Elsewhere::Same; rows.len()];
    let bent: Vec<usize> = (0..rows.len()).filter(|place| is_bent(rows[*place])).collect();
    if bent.is_empty() {
        return said;
    }
    let left: BTreeSet<u32> = elimination.left.iter().map(|row| row.row).collect();
    let loops = Connections::of(kinematics, all);
    let mut of_row: BTreeMap<u32, Elsewhere> = BTreeMap::new();
    for place in bent {
        let row = rows[place].row;
        if !of_row.contains_key(&row) {
            let (numbers, coordinates) = loops.reach(row);
            let (followed, kept): (Vec<u32>, Vec<u32>) = numbers.iter().partition(|number| left.contains(number));
            let part = Part::new(kinematics, all, elimination.chord(&kept, &coordinates), (kept, coordinates));
            of_row.extend(followed.iter().copied().zip(part.compare(all, &followed)));
        }
        said[place] = of_row[&row];
    }
    said
}

/// Which equations contain which coordinates.
struct Connections {
    coordinates: Vec<Vec<Index>>,
    equations: BTreeMap<Index, Vec<u32>>,
}

impl Connections {
    fn of(kinematics: &Kinematics, all: &Constraints) -> Connections {
        let mut connections =
            Connections { coordinates: Vec::with_capacity(all.list.len()), equations: BTreeMap::new() };
        for (number, constraint) in (0..).zip(&all.list) {
            let mut coordinates: Vec<Index> = constraint.equation.coordinates(kinematics).collect();
            coordinates.sort_unstable();
            coordinates.dedup();
            for coordinate in &coordinates {
                connections.equations.entry(*coordinate).or_default().push(number);
            }
            connections.coordinates.push(coordinates);
        }
        connections
    }

    /// The equations and coordinates that are connected with an equation, each ascending.
    fn reach(&self, equation: u32) -> (Vec<u32>, Vec<Index>) {
        let (mut equations, mut coordinates) = (BTreeSet::from([equation]), BTreeSet::new());
        let mut waiting = vec![equation];
        while let Some(number) = waiting.pop() {
            for coordinate in &self.coordinates[number as usize] {
                if coordinates.insert(*coordinate) {
                    waiting.extend(self.equations[coordinate].iter().filter(|number| equations.insert(**number)));
                }
            }
        }
        (equations.into_iter().collect(), coordinates.into_iter().collect())
    }
}

/// Connected loops, in binary64.
struct Part<'a> {
    kinematics: &'a Kinematics,
    /// The independent equations.
    kept: Vec<Equation<f64>>,
    coordinates: Vec<Index>,
    chord: Chord,
    /// The longest arm, m.
    length: f64,
}

impl<'a> Part<'a> {
    fn new(
        kinematics: &'a Kinematics,
        all: &Constraints,
        chord: Chord,
        (kept, coordinates): (Vec<u32>, Vec<Index>),
    ) -> Part<'a> {
        let equation = |number: &u32| &all.list[*number as usize].equation;
        let longest = kept.iter().map(|number| equation(number).length()).fold(0.0, f64::max);
        let length = if longest > 0.0 { longest } else { all.length };
        let kept = kept.iter().map(|number| equation(number).convert()).collect();
        Part { kinematics, kept, coordinates, chord, length }
    }

    fn compare(&self, all: &Constraints, followed: &[u32]) -> Vec<Elsewhere> {
        let equations: Vec<Equation<f64>> =
            followed.iter().map(|number| all.list[*number as usize].equation.convert()).collect();
        let mut said = vec![Elsewhere::Holds; followed.len()];
        for position in 0..POSITIONS {
            let at = (0..=HALVINGS).find_map(|halvings| self.close(FAR / f64::from(1 << halvings), position));
            let mut reach = PathEvaluation::default();
            for (said, equation) in said.iter_mut().zip(&equations) {
                match &at {
                    Some(state) if self.violation(equation, state, &mut reach).abs() > NOTHING => {
                        *said = Elsewhere::Broken
                    }
                    None if *said == Elsewhere::Holds => *said = Elsewhere::Unknown,
                    _ => {}
                }
            }
        }
        said
    }

    /// In radians or lengths.
    fn violation(&self, equation: &Equation<f64>, state: &State<f64>, reach: &mut PathEvaluation<f64>) -> f64 {
        let (value, _) = equation.measure(self.kinematics, state, reach);
        if equation.components.is_empty() { value } else { value / self.length }
    }

    /// A position in which the independent coordinates have moved by up to `far` and the loops are closed, if it is found.
    fn close(&self, far: f64, position: usize) -> Option<State<f64>> {
        let mut state = State::as_drawn();
        let mut reach = PathEvaluation::default();
        // What this says of the pivots is overwritten.
        let by = |(place, coordinate): (usize, &Index)| {
            far * unit(self.kinematics, *coordinate, self.length) * direction(place, position)
        };
        let mut motion: Vec<f64> = self.coordinates.iter().enumerate().map(by).collect();
        let mut off = vec![0.0; self.kept.len()];
        let mut last = f64::INFINITY;
        for _ in 0..MAX_STEPS {
            self.chord.correct(&off, &mut motion);
            for (coordinate, step) in self.coordinates.iter().zip(&mut motion) {
                let value = state.value(*coordinate) + std::mem::take(step);
                state.set(self.kinematics, *coordinate, value);
            }
            let mut worst = 0.0f64;
            for (off, equation) in off.iter_mut().zip(&self.kept) {
                *off = equation.measure(self.kinematics, &state, &mut reach).0;
                let violation = if equation.components.is_empty() { *off } else { *off / self.length };
                worst = if violation.is_nan() { f64::NAN } else { worst.max(violation.abs()) };
            }
            // Near the end, rounding errors stop the convergence.
            if worst <= CLOSED || worst >= 0.5 * last && worst <= 1e3 * CLOSED {
                return Some(state);
            }
            if worst.is_nan() || worst > 2.0 * last {
                return None;
            }
            last = worst;
        }
        None
    }
}

/// A number between a half and one, of either sign, that has nothing in common with those of other coordinates: steps of
/// the golden ratio.
fn direction(place: usize, position: usize) -> f64 {
    let turn = ((1 + place + 7 * position) as f64 * 0.618_033_988_749_894_9).fract();
    let size = if turn < 0.5 { -0.5 - turn } else { turn };
    if position.is_multiple_of(2) { size } else { -size }
}
