//! Reactions as rows: the force on a released motion, to first order about the rest. In: a mechanism with released
//! motions. Out, for each released motion: a row over the motions of the scene for each derivative, the contribution of
//! the inputs, and the force at rest. See docs/method/linearisation.md#reactions.
//!
//! A square w r r^T of M, C or K is a force w r_e (r . q) on the released motion e, whose whole row r is known. The
//! pairs of the geometric stiffness and the columns of the inputs are split in the same way.

use super::{Assembly, Order, Row, Sparse, Tensions, equation, loads};
use crate::base::Number;
use crate::lower::constraints::{Constraints, Reduction};
use crate::lower::kinematics::{Index, Released, State};
use crate::lower::rest::survey;
use crate::model::scene::Scene;
use crate::system;

/// The forces on released motions.
#[derive(Clone, Debug, Default)]
pub struct Forces {
    /// The coordinate of the first released motion.
    first: Index,
    /// For each released motion: a row over all coordinates for each derivative.
    rows: Vec<[Row; 3]>,
    /// For each released motion and each derivative of the inputs: the inputs other than base motions, and the work
    /// that a unit of each does on the motion.
    inputs: Vec<[Row; 3]>,
}

/// A reaction: its change from rest as an output, and its value at rest.
#[derive(Clone, Debug)]
pub struct Carried {
    pub p: [Sparse; 3],
    pub d: [Vec<(u32, Number)>; 3],
    /// N or N m.
    pub at_rest: Number,
}

impl Forces {
    fn new(released: &Released) -> Forces {
        let count = released.acts_on_moved.len();
        Forces { first: released.first, rows: vec![Default::default(); count], inputs: vec![Default::default(); count] }
    }

    /// The number of the released motion with this coordinate.
    fn number(&self, coordinate: Index) -> Option<usize> {
        let number = coordinate.checked_sub(self.first)? as usize;
        (number < self.rows.len()).then_some(number)
    }

    /// The force of a square over a row without dependent coordinates.
    pub fn square(&mut self, order: Order, weight: &Number, row: &Row) {
        self.product(order, weight, row, row);
    }

    /// The force of weight left right^T on the released motions in `left`.
    pub fn product(&mut self, order: Order, weight: &Number, left: &Row, right: &Row) {
        for (coordinate, value) in left {
            let Some(number) = self.number(*coordinate) else { continue };
            let factor = weight * value;
            let moving = right.iter().filter(|(other, _)| self.number(*other).is_none());
            let entries: Row = moving.map(|(other, entry)| (*other, &factor * entry)).collect();
            self.rows[number][order as usize].extend(entries);
        }
    }

    /// Adds the work of a derivative of an input, given its column over all coordinates.
    pub fn input(&mut self, input: usize, order: Order, column: &Row) {
        for (coordinate, value) in column {
            if let Some(number) = self.number(*coordinate) {
                self.inputs[number][order as usize].push((input as Index, value.clone()));
            }
        }
    }
}

/// The reactions on released motions, in their order.
pub fn released_reactions(
    scene: &Scene,
    released: &Released,
    (constraints, reduction): (&Constraints, &Reduction),
    state: &State<Number>,
    tensions: Tensions,
) -> Vec<Carried> {
    let mut assembly = Assembly::new(scene, &released.kinematics, reduction, state, tensions);
    assembly.released = Some(Forces::new(released));
    assembly.inertia();
    assembly.gravity();
    for (number, element) in scene.elements.iter().enumerate() {
        assembly.element(number, element);
    }
    assembly.reactions(constraints);
    for (index, input) in scene.inputs.iter().enumerate() {
        assembly.constant_load(index, input);
    }
    for (index, input) in scene.inputs.iter().enumerate() {
        assembly.input(index, input);
    }
    let slopes = assembly.slopes();
    let forces = assembly.released.take().unwrap_or_default();
    let carried = |(number, (rows, inputs)): (usize, ([Row; 3], [Row; 3]))| {
        let sign = Number::from(if released.acts_on_moved[number] { 1 } else { -1 });
        let signed = |row: Row| -> Row { row.into_iter().map(|(i, value)| (i, &value * &sign)).collect() };
        let rows = rows.map(|row| equation::merge_entries(signed(row)));
        let p = rows.each_ref().map(|row| {
            row.iter().filter_map(|(i, value)| Some((reduction.place(*i)?, value.clone()))).collect::<Sparse>()
        });
        let mut d: [Row; 3] = rows.each_ref().map(|row| {
            row.iter().filter_map(|(i, value)| Some((assembly.input_of(*i)? as u32, value.clone()))).collect()
        });
        // The joint carries the forces that the inputs do not balance.
        for (d, inputs) in d.iter_mut().zip(inputs) {
            d.extend(signed(inputs).into_iter().map(|(input, value)| (input, -&value)));
        }
        let at_rest = assembly.force_at_rest(&slopes, released.coordinate(number));
        Carried { p, d: d.map(equation::merge_entries), at_rest: &at_rest * &sign }
    };
    forces.rows.into_iter().zip(forces.inputs).enumerate().map(carried).collect()
}

impl Carried {
    /// Adds a multiple of it to an output.
    pub fn add_to(&self, output: &mut system::Output, factor: &Number) {
        for order in 0..3 {
            let add = |sum: &mut Vec<(u32, Number)>, more: &mut dyn Iterator<Item = (u32, Number)>| {
                let all = sum.drain(..).chain(more).collect();
                *sum = equation::merge_entries(all);
            };
            let mut p: Vec<(u32, Number)> = output.p[order].drain(..).map(|(i, value)| (i.0, value)).collect();
            add(&mut p, &mut self.p[order].iter().map(|(i, value)| (i.0, value * factor)));
            output.p[order] = p.into_iter().map(|(i, value)| (system::CoordinateId(i), value)).collect();
            add(&mut output.d[order], &mut self.d[order].iter().map(|(i, value)| (*i, value * factor)));
        }
    }

    /// Adds the force of the damping alpha M + beta K, of which beta acts on the rates of strains: bases have their part in these.
    pub fn damp(&mut self, alpha: &Number, beta: &Number, is_base: impl Fn(u32) -> bool) {
        let of_bases = self.d[0].iter().filter(|(input, _)| is_base(*input));
        let more: Vec<(u32, Number)> = of_bases.map(|(input, value)| (*input, value * beta)).collect();
        self.d[1].extend(more.into_iter().filter(|(_, value)| !value.is_zero()));
        for (order, factor) in [(2, alpha), (0, beta)] {
            let more: Sparse = self.p[order].iter().map(|(i, value)| (*i, value * factor)).collect();
            self.p[1].extend(more);
        }
        let row = self.p[1].drain(..).map(|(i, value)| (i.0, value)).collect();
        self.p[1] =
            equation::merge_entries(row).into_iter().map(|(i, value)| (system::CoordinateId(i), value)).collect();
    }
}

impl Assembly<'_> {
    /// dV/dq in this state: on free coordinates, and on released motions if there are any.
    pub(super) fn slopes(&mut self) -> Vec<Number> {
        let (scene, kinematics, state) = (self.scene, self.kinematics, self.state);
        match (self.tensions.held, &self.released) {
            (Some(held), None) => held.slopes.clone(),
            (None, None) => survey::forces(scene, kinematics, state, state.is_drawn()),
            (held, Some(_)) => {
                let mut slopes = survey::all_forces(scene, kinematics, state, held.is_some() || state.is_drawn());
                for (number, element) in scene.elements.iter().enumerate() {
                    let Some(rate) = held.and_then(|held| held.rate(number)) else { continue };
                    let stretch = self.between.set_ends(kinematics, &element.ends, &element.law.geometry);
                    let stretched = self.measure_stretch(&stretch);
                    loads::slope(&stretched, &self.reach, &self.between, &mut self.row);
                    for (coordinate, entry) in self.row.drain(..) {
                        let slope = &mut slopes[coordinate as usize];
                        *slope = &*slope + &(rate * &entry);
                    }
                }
                let mut row: Row = (0..).zip(slopes.iter().cloned()).filter(|(_, slope)| !slope.is_zero()).collect();
                kinematics.unfold(&mut row);
                slopes.fill(Number::ZERO);
                row.into_iter().for_each(|(coordinate, slope)| slopes[coordinate as usize] = slope);
                slopes
            }
        }
    }

    /// The force on a released motion, given the forces on all coordinates.
    fn force_at_rest(&self, slopes: &[Number], coordinate: Index) -> Number {
        let mut force = slopes[coordinate as usize].clone();
        for dependent in self.reduction.dependent() {
            let Some((_, row)) = self.reduction.equation(dependent) else { continue };
            if let Some((_, entry)) = row.iter().find(|(i, _)| *i == coordinate) {
                force = &force - &(&slopes[dependent as usize] * entry);
            }
        }
        force
    }
}
