//! `rest as drawn`: the smallest tensions of springs that hold the drawing. In: a scene and the state as drawn. Out: a
//! tension for each spring for which none is given, or the coordinates that no tension can hold.
//! See docs/method/rest.md#rest-as-drawn.
//!
//! With the rate t_e = T_e / |d_e| of each such spring and r_e = d_e . du_e/dq, balance requires sum_e r_e t_e = f, and
//! the solution with the least sum of T_e^2 = |d_e|^2 t_e^2 is t_e = (r_e . y) / |d_e|^2 with G y = f, G = sum_e r_e
//! r_e^T / |d_e|^2. All of this is rational if the drawing is. If only one spring acts on a coordinate, its rate follows
//! directly and is found first: the statically determinate part takes time proportional to its size.

use super::linear::{Stiffness, solve_proven};
use super::potential::Detail;
use super::proof::Proven;
use super::{Tension, survey};
use crate::base::{Ball, Number};
use crate::elements::Scalar;
use crate::lower::constraints::Reduction;
use crate::lower::error::{LowerError, Unbalanced};
use crate::lower::kinematics::{Index, Kinematics, PathEvaluation, State};
use crate::lower::loads::{self, EndPath};
use crate::model::scene::{ElementId, Geometry, Law, Scene};
use crate::system::Label;

/// The tensions that hold a drawing.
#[derive(Clone, Debug)]
pub struct Held {
    /// For each element of the scene, its tension over its length (N/m, or N m for a torsion); `None` if it is given.
    rates: Vec<Option<Number>>,
    /// dV/dq with these tensions, on all coordinates: balanced by the reactions of closing joints and couplings.
    pub slopes: Vec<Number>,
    pub tensions: Vec<Tension>,
    /// Largest unbalanced force, relative to the largest that acts.
    pub residual: f64,
    pub proven: Option<Proven>,
}

impl Held {
    /// Tension over length of an element whose tension follows from the drawing.
    pub fn rate(&self, element: usize) -> Option<&Number> {
        self.rates[element].as_ref()
    }
}

/// A spring whose tension is unknown.
struct Column {
    element: usize,
    /// d . du/dq over the free coordinates; empty if all are independent.
    pulls: Vec<(Index, Number)>,
    /// d . du/dq over the independent coordinates.
    row: Vec<(Index, Number)>,
    length_squared: Number,
    rate: Option<Number>,
}

/// The balance of forces as drawn.
struct Balance<'a> {
    scene: &'a Scene,
    kinematics: &'a Kinematics,
    columns: Vec<Column>,
    /// The columns at each coordinate.
    at: Vec<Vec<u32>>,
    /// The forces that the tensions found so far leave unbalanced, on independent coordinates.
    forces: Vec<Number>,
    /// dV/dq of the loads alone, on all coordinates.
    slopes: Vec<Number>,
    left: Vec<Unbalanced>,
    /// Forces and pivots that may be zero, and are treated as zero.
    unsettled: Vec<Number>,
    proven: Option<Proven>,
    /// The sum of the magnitudes of all loads on each coordinate.
    sizes: Vec<f64>,
    /// The largest force left unbalanced because it may be zero, relative to the loads there.
    residual: f64,
}

/// Limit on the coordinates of an elimination in fractions: they end with a thousand digits.
const MAX_EXACT: usize = 60;
/// Limit on the coordinates of an elimination in balls; larger parts are solved by factors in binary64 and refinement.
const MAX_DENSE: usize = 300;

/// Finds the tensions, or reports the forces that they cannot balance.
pub fn hold(
    scene: &Scene,
    kinematics: &Kinematics,
    reduction: &Reduction,
    state: &State<Number>,
) -> Result<Held, Vec<LowerError>> {
    let mut balance = Balance::new(scene, kinematics, reduction, state);
    balance.determinate();
    for part in balance.parts() {
        balance.part(&part);
    }
    balance.finish()
}

impl<'a> Balance<'a> {
    fn new(scene: &'a Scene, kinematics: &'a Kinematics, reduction: &Reduction, state: &State<Number>) -> Balance<'a> {
        let loads = survey::energy(scene, kinematics, state, true, Detail::Sizes);
        let forces = reduction.left_of(&loads.gradient).iter().map(|slope| -slope).collect();
        let columns = columns(scene, kinematics, reduction, state);
        let mut at = vec![Vec::new(); kinematics.n()];
        for (number, column) in columns.iter().enumerate() {
            for (coordinate, _) in &column.row {
                at[*coordinate as usize].push(number as u32);
            }
        }
        Balance {
            scene,
            kinematics,
            columns,
            at,
            forces,
            slopes: loads.gradient,
            left: Vec::new(),
            unsettled: Vec::new(),
            proven: Proven::prove_balance(&[]),
            sizes: loads.forces,
            residual: 0.0,
        }
    }

    /// Finds tensions one by one, as long as some coordinate has a single unknown one.
    fn determinate(&mut self) {
        let mut waiting: Vec<Index> = (0..self.forces.len() as Index).rev().collect();
        while let Some(coordinate) = waiting.pop() {
            let Some(only) = self.only_open(coordinate) else { continue };
            let column = &self.columns[only];
            let Some((_, entry)) = column.row.iter().find(|(i, _)| *i == coordinate) else { continue };
            if let Some(rate) = self.forces[coordinate as usize].checked_div(entry) {
                waiting.extend(column.row.iter().map(|(i, _)| *i).filter(|i| *i != coordinate));
                self.settle(only, rate);
                // Exactly zero by the choice of the rate.
                self.forces[coordinate as usize] = Number::ZERO;
            }
        }
    }

    /// The column whose tension is the only unknown one at a coordinate.
    fn only_open(&self, coordinate: Index) -> Option<usize> {
        let mut open = self.open(coordinate);
        let only = open.next()?;
        open.next().is_none().then_some(only as usize)
    }

    fn open(&self, coordinate: Index) -> impl Iterator<Item = u32> + '_ {
        let columns = self.at[coordinate as usize].iter().copied();
        columns.filter(|column| self.columns[*column as usize].rate.is_none())
    }

    /// Sets the rate of a column and subtracts its contribution from the forces.
    fn settle(&mut self, column: usize, rate: Number) {
        let column = &mut self.columns[column];
        for (coordinate, entry) in &column.row {
            let force = &mut self.forces[*coordinate as usize];
            *force = &*force - &(entry * &rate);
        }
        column.rate = Some(rate);
    }

    /// Sets of coordinates that are connected by open columns, each ascending.
    fn parts(&self) -> Vec<Vec<Index>> {
        let mut part_of = vec![false; self.forces.len()];
        let mut parts = Vec::new();
        for first in 0..self.forces.len() as Index {
            let mut part = Vec::new();
            let mut reached = vec![first];
            while let Some(coordinate) = reached.pop() {
                if std::mem::replace(&mut part_of[coordinate as usize], true) {
                    continue;
                }
                part.push(coordinate);
                let rows = self.open(coordinate).flat_map(|column| &self.columns[column as usize].row);
                reached.extend(rows.map(|(i, _)| *i).filter(|i| !part_of[*i as usize]));
            }
            part.sort_unstable();
            if !part.is_empty() {
                parts.push(part);
            }
        }
        parts
    }

    fn part(&mut self, part: &[Index]) {
        let loaded = part.iter().any(|i| !self.forces[*i as usize].is_zero());
        if !loaded {
            return;
        }
        match part {
            [only] if self.open(*only).next().is_none() => self.judge(*only, &self.forces[*only as usize].clone()),
            _ if part.len() <= MAX_DENSE => self.eliminate(part),
            _ => self.refine(part),
        }
    }

    /// Judges a force that no tension is left to balance.
    fn judge(&mut self, coordinate: Index, force: &Number) {
        if force.is_zero() {
            return;
        }
        if force.may_be_zero() {
            self.unsettled.push(force.clone());
            let left = force.to_ball().magnitude() / self.sizes[coordinate as usize].max(f64::MIN_POSITIVE);
            self.residual = self.residual.max(left);
            return;
        }
        let body = &self.scene.bodies[self.kinematics.free[coordinate as usize].index()];
        let measured = match self.kinematics.length_squared(coordinate) {
            Some(length_squared) => force.over(&length_squared.root()),
            None => force.clone(),
        };
        self.left.push(Unbalanced {
            coordinate: format!(
                "{}.{}",
                self.scene.words.display(body.name),
                self.kinematics.motion(self.scene, coordinate)
            ),
            span: body.span,
            force: measured.to_f64(),
            turns: self.kinematics.is_angle(coordinate),
        });
    }

    /// Solves G y = f by elimination: exactly if the numbers are exact, otherwise in balls.
    fn eliminate(&mut self, part: &[Index]) {
        let exact = part.len() <= MAX_EXACT;
        let number = |value: &Number| if exact { value.clone() } else { Number::Ball(value.to_ball()) };
        let local = |coordinate: &Index| part.binary_search(coordinate).ok();
        let n = part.len();
        let mut matrix = vec![vec![Number::ZERO; n]; n];
        let columns = self.columns_of(part);
        for &column in &columns {
            let Column { row, length_squared, .. } = &self.columns[column];
            let row: Vec<(usize, &Number)> = row.iter().filter_map(|(i, entry)| Some((local(i)?, entry))).collect();
            for (i, left) in &row {
                let weighted = &number(left) / length_squared;
                for (j, right) in &row {
                    matrix[*i][*j] = &matrix[*i][*j] + &(&weighted * *right);
                }
            }
        }
        let mut forces: Vec<Number> = part.iter().map(|i| number(&self.forces[*i as usize])).collect();
        let pivots = reduce(&mut matrix, &mut forces);
        for i in (0..n).filter(|i| !pivots.contains(i)) {
            // A motion certainly has no stiffness only if its pivot is an exact zero.
            self.unsettled.push(matrix[i][i].clone());
            self.judge(part[i], &forces[i]);
        }
        let y = substitute(&matrix, &forces, &pivots);
        for column in columns {
            let Column { row, length_squared, .. } = &self.columns[column];
            let pull = row.iter().filter_map(|(i, entry)| Some(entry * &y[local(i)?]));
            let pull = pull.fold(Number::ZERO, |sum, pull| &sum + &pull);
            self.columns[column].rate = Some(&pull / &length_squared.clone());
        }
    }

    /// Solves G y = f for many coordinates, by factors in binary64 and iterative refinement.
    fn refine(&mut self, part: &[Index]) {
        let columns = self.columns_of(part);
        let local = |coordinate: &Index| part.binary_search(coordinate).unwrap_or(usize::MAX);
        let mut squares = Stiffness::new(part.len());
        for &column in &columns {
            let Column { row, length_squared, .. } = &self.columns[column];
            let row = row.iter().map(|(i, entry)| (local(i) as u32, entry.to_ball()));
            squares.push(Ball::from(1.0) / length_squared.to_ball(), row);
        }
        let forces: Vec<Ball> = part.iter().map(|i| self.forces[*i as usize].to_ball()).collect();
        let solution = match solve_proven(&squares, &forces) {
            Ok(solution) => solution,
            Err(row) => return self.judge(part[row], &Number::Ball(forces[row])),
        };
        self.proven = Proven::and(self.proven, solution.proven);
        self.residual = self.residual.max(solution.residual);
        for column in columns {
            let Column { row, length_squared, .. } = &self.columns[column];
            let pull = row.iter().map(|(i, entry)| entry.to_ball() * solution.values[local(i)]);
            let pull = pull.fold(Ball::ZERO, |sum, pull| sum + pull);
            self.columns[column].rate = Some(Number::Ball(pull / length_squared.to_ball()));
        }
    }

    /// The open columns of a part, ascending.
    fn columns_of(&self, part: &[Index]) -> Vec<usize> {
        let mut columns: Vec<usize> = part.iter().flat_map(|i| self.open(*i)).map(|column| column as usize).collect();
        columns.sort_unstable();
        columns.dedup();
        columns
    }

    fn finish(self) -> Result<Held, Vec<LowerError>> {
        if !self.left.is_empty() {
            let declared = self.scene.rest_as_drawn.unwrap_or(self.left[0].span);
            let given =
                self.scene.elements.iter().find(|element| gives_tension(&element.law)).map(|element| element.span);
            return Err(vec![LowerError::Unheld { declared, left: self.left, given }]);
        }
        let mut rates: Vec<Option<Number>> = vec![None; self.scene.elements.len()];
        let mut tensions = Vec::with_capacity(self.columns.len());
        let mut slopes = self.slopes;
        for column in self.columns {
            for (coordinate, entry) in column.pulls {
                let slope = &mut slopes[coordinate as usize];
                *slope = &*slope + &(&entry * column.rate.as_ref().unwrap_or(&Number::ZERO));
            }
            let element = &self.scene.elements[column.element];
            let rate = column.rate.unwrap_or(Number::ZERO);
            let tension = if rate.is_zero() { Number::ZERO } else { &rate * &column.length_squared.root() };
            let spring = Label { name: element.name, motion: "" };
            let id = ElementId(column.element as u32);
            tensions.push(Tension { element: id, spring, tension, turns: element.law.geometry == Geometry::Torsion });
            rates[column.element] = Some(rate);
        }
        let proven = Proven::and(self.proven, Proven::prove_balance(&self.unsettled));
        Ok(Held { rates, slopes, tensions, residual: self.residual, proven })
    }
}

fn gives_tension(law: &Law) -> bool {
    law.may_be_loaded()
}

/// The springs whose tension is not given and that act on some coordinate.
fn columns(scene: &Scene, kinematics: &Kinematics, reduction: &Reduction, state: &State<Number>) -> Vec<Column> {
    let (mut between, mut reach, mut row) = (EndPath::default(), PathEvaluation::default(), Vec::new());
    let mut columns = Vec::new();
    for (element, declared) in scene.elements.iter().enumerate() {
        if !declared.law.kind.is_elastic() || gives_tension(&declared.law) {
            continue;
        }
        let spring = loads::spring(kinematics, &declared.ends, &declared.law, &mut between);
        reach.measure(kinematics, state, &between.path);
        let stretched = spring.stretch.at(&reach.displacement, &between.turn(state));
        let length_squared = loads::slope(&stretched, &reach, &between, &mut row);
        row.retain(|(coordinate, _)| (*coordinate as usize) < kinematics.n());
        let pulls = if reduction.is_trivial() { Vec::new() } else { row.clone() };
        reduction.reduce(&mut row);
        row.retain(|(coordinate, _)| (*coordinate as usize) < kinematics.n());
        if !row.is_empty() {
            columns.push(Column { element, pulls, row: std::mem::take(&mut row), length_squared, rate: None });
        }
    }
    columns
}

/// Gaussian elimination of a positive semidefinite matrix with pivots on its diagonal, in the order returned. Pivots that
/// may be zero are left out; the forces that remain in their rows cannot be balanced by the others.
fn reduce(matrix: &mut [Vec<Number>], forces: &mut [Number]) -> Vec<usize> {
    let n = forces.len();
    let sizes: Vec<f64> = (0..n).map(|i| matrix[i][i].to_f64()).collect();
    let mut open: Vec<usize> = (0..n).collect();
    let mut pivots = Vec::new();
    loop {
        let share = |i: &usize| matrix[*i][*i].to_f64() / sizes[*i];
        let certain = open.iter().copied().filter(|i| matrix[*i][*i].is_positive());
        let Some(pivot) = certain.max_by(|a, b| share(a).total_cmp(&share(b)).then(b.cmp(a))) else { break };
        open.retain(|i| *i != pivot);
        let row = matrix[pivot].clone();
        for &i in &open {
            let factor = &matrix[i][pivot] / &row[pivot];
            if factor.is_zero() {
                continue;
            }
            for &j in &open {
                matrix[i][j] = &matrix[i][j] - &(&factor * &row[j]);
            }
            forces[i] = &forces[i] - &(&factor * &forces[pivot]);
        }
        pivots.push(pivot);
    }
    pivots
}

/// y from the rows of the pivots, starting from the last one; zero for the others.
fn substitute(matrix: &[Vec<Number>], forces: &[Number], pivots: &[usize]) -> Vec<Number> {
    let mut y = vec![Number::ZERO; forces.len()];
    for (step, &pivot) in pivots.iter().enumerate().rev() {
        let known = pivots[step + 1..].iter().map(|&later| &matrix[pivot][later] * &y[later]);
        let known = known.fold(Number::ZERO, |sum, part| &sum + &part);
        y[pivot] = &(&forces[pivot] - &known) / &matrix[pivot][pivot];
    }
    y
}
