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
use crate::base::Number;
use crate::lower::kinematics::{Index, Kinematics, PathEvaluation, State};
use std::collections::{BTreeMap, BTreeSet};

/// The farthest motion of the coordinate that bends the loops most, in radians or lengths.
const FAR: f64 = 0.25;
/// How often it is halved for the first step: 6e-5.
const HALVINGS: u32 = 12;
/// An equation that holds up to here counts as compared.
const NEAR: f64 = 1e-3;
/// A violation that grows by more, as the motion doubles, is of another branch: a contact of order eight grows by so much.
const JUMP: f64 = 256.0;
/// An equation may be off by so many times what the loops are left open by: near a fold their links act as levers.
const LEVER: f64 = 1e3;
/// A violation that rounding alone may make.
const NOISE: f64 = 1e-15;
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
            let chord = elimination.chord(&kept, &coordinates);
            let part = Part::new(kinematics, all, chord, (&kept, &followed), coordinates);
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
    kept: Vec<Closure>,
    coordinates: Vec<Index>,
    /// The unit of each coordinate, and whether some equation bends with it: a wheel of a gear may turn as often as it likes.
    units: Vec<(f64, bool)>,
    chord: Chord,
}

/// An equation and the length, m, that its violation is measured by; 1 for an equation of angles.
struct Closure {
    equation: Equation<f64>,
    length: f64,
}

impl Closure {
    fn new(equation: &Equation<Number>) -> Closure {
        let length = if equation.components.is_empty() { 1.0 } else { equation.length() };
        Closure { equation: equation.convert(), length: if length > 0.0 { length } else { 1.0 } }
    }

    fn value(&self, kinematics: &Kinematics, state: &State<f64>, reach: &mut PathEvaluation<f64>) -> f64 {
        self.equation.measure(kinematics, state, reach).0
    }

    /// In radians or lengths.
    fn violation(&self, value: f64) -> f64 {
        (value / self.length).abs()
    }
}

impl<'a> Part<'a> {
    fn new(
        kinematics: &'a Kinematics,
        all: &Constraints,
        chord: Chord,
        (kept, followed): (&[u32], &[u32]),
        coordinates: Vec<Index>,
    ) -> Part<'a> {
        let equation = |number: &u32| &all.list[*number as usize].equation;
        let is_bent = |number: &&u32| !equation(number).is_linear();
        let bent: BTreeSet<Index> = (kept.iter().chain(followed).filter(is_bent))
            .flat_map(|number| equation(number).coordinates(kinematics))
            .collect();
        let longest = kept.iter().map(|number| equation(number).length()).fold(0.0, f64::max);
        let kept: Vec<Closure> = kept.iter().map(|number| Closure::new(equation(number))).collect();
        let length = if longest > 0.0 { longest } else { all.length };
        let units = coordinates.iter().map(|i| (unit(kinematics, *i, length), bent.contains(i))).collect();
        Part { kinematics, kept, coordinates, units, chord }
    }

    fn compare(&self, all: &Constraints, followed: &[u32]) -> Vec<Elsewhere> {
        let equations: Vec<Closure> =
            followed.iter().map(|number| Closure::new(&all.list[*number as usize].equation)).collect();
        let mut said = vec![Elsewhere::Holds; followed.len()];
        for position in 0..POSITIONS {
            let (reached, largest) = self.follow(&equations, position);
            for (said, violation) in said.iter_mut().zip(largest) {
                match *said {
                    _ if violation > NOTHING => *said = Elsewhere::Broken,
                    Elsewhere::Holds if reached < NEAR => *said = Elsewhere::Unknown,
                    _ => {}
                }
            }
        }
        said
    }

    /// How far the coordinates have been moved on the branch of the drawing, and how far each equation is off there: in steps
    /// that double, while the loops close. Beyond a fold they may close on another branch, where an equation that holds on this
    /// one is off at once and not by and by.
    fn follow(&self, equations: &[Closure], position: usize) -> (f64, Vec<f64>) {
        let direction = self.direction(position);
        let (mut reached, mut largest, mut before_open) = (0.0, vec![0.0f64; equations.len()], 0.0);
        for halvings in (0..=HALVINGS).rev() {
            let far = FAR / f64::from(1 << halvings);
            let Some((state, open)) = self.close(far, &direction) else { break };
            let mut reach = PathEvaluation::default();
            let mut violation = |closure: &Closure| {
                let off = closure.violation(closure.value(self.kinematics, &state, &mut reach));
                if off.is_nan() { off } else { (off - LEVER * open).max(0.0) }
            };
            let here: Vec<f64> = equations.iter().map(&mut violation).collect();
            // Those before are the largest so far: violations of a contact grow.
            let noise = NOISE.max(LEVER * before_open);
            if here.iter().zip(&largest).any(|(here, before)| here.is_nan() || *here > JUMP * before.max(noise)) {
                break;
            }
            before_open = open;
            reached = far;
            largest.iter_mut().zip(here).for_each(|(largest, here)| *largest = largest.max(here));
        }
        (reached, largest)
    }

    /// A motion that the equations allow as drawn, in which the coordinate that bends them most moves by its unit.
    fn direction(&self, position: usize) -> Vec<f64> {
        let by = |(place, (unit, _)): (usize, &(f64, bool))| unit * direction(place, position);
        let mut motion: Vec<f64> = self.units.iter().enumerate().map(by).collect();
        self.chord.correct(&vec![0.0; self.kept.len()], &mut motion);
        let size = |(motion, (unit, is_bent)): (&f64, &(f64, bool))| if *is_bent { (motion / unit).abs() } else { 0.0 };
        let most = motion.iter().zip(&self.units).map(size).fold(0.0, f64::max);
        if most > 0.0 {
            motion.iter_mut().for_each(|motion| *motion /= most);
        }
        motion
    }

    /// A position so far along a motion in which the loops are closed, and what is left open of them, if it is found.
    fn close(&self, far: f64, direction: &[f64]) -> Option<(State<f64>, f64)> {
        let mut state = State::as_drawn();
        let mut reach = PathEvaluation::default();
        let mut motion: Vec<f64> = direction.iter().map(|motion| motion * far).collect();
        let mut off = vec![0.0; self.kept.len()];
        let mut last = f64::INFINITY;
        for _ in 0..MAX_STEPS {
            self.chord.correct(&off, &mut motion);
            for (coordinate, step) in self.coordinates.iter().zip(&mut motion) {
                let value = state.value(*coordinate) + std::mem::take(step);
                state.set(self.kinematics, *coordinate, value);
            }
            let mut worst = 0.0f64;
            for (off, closure) in off.iter_mut().zip(&self.kept) {
                *off = closure.value(self.kinematics, &state, &mut reach);
                let violation = closure.violation(*off);
                worst = if violation.is_nan() { f64::NAN } else { worst.max(violation) };
            }
            // Near the end, rounding errors stop the convergence.
            if worst <= CLOSED || worst >= last && worst <= 1e3 * CLOSED {
                return Some((state, worst));
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
