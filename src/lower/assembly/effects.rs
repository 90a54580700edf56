//! What the terms of a system act on: coordinates that nothing determines, coordinates that are parts of the state, and
//! items without an effect. In: an assembly. Out: these, whether its terms are kept or dropped one by one.

use super::{Assembly, Row};
use crate::base::Number;
use crate::lower::error::LowerError;
use crate::lower::kinematics::Index;
use crate::lower::loads;
use crate::model::scene::{Damping, Element};
use crate::system::Form;

/// A spring, damper or input that has no effect on anything that moves: its index in the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Idle {
    Element(usize),
    Input(usize),
    /// A spring whose law has zero slope at rest.
    Flat(usize),
}

impl Assembly<'_> {
    /// Notes what the terms act on and drops them, unless they are kept.
    pub(super) fn drop_terms(&mut self) {
        let Some(felt) = &mut self.felt else { return };
        for (form, felt) in [&mut self.m, &mut self.c, &mut self.k].into_iter().zip(felt) {
            mark(form, felt);
            form.clear();
        }
    }

    /// Which displacements and which velocities of the coordinates are parts of the state: displacements of what has mass or
    /// damping, velocities of what has mass. Of two coordinates that move one mass together, both count: motions in time
    /// refuse them.
    pub fn states(&self) -> [Vec<bool>; 2] {
        // C = alpha M + beta K
        let is_damped = matches!(&self.scene.damping, Some(Damping::Rayleigh { beta, .. }) if !beta.is_zero());
        [self.touched_coordinates(if is_damped { 3 } else { 2 }), self.touched_coordinates(1)]
    }

    /// The coordinates that some term of the first so many of M, C and K contains.
    fn touched_coordinates(&self, count: usize) -> Vec<bool> {
        let n = self.reduction.n();
        let mut touched = vec![false; n + self.chain.len()];
        for form in [&self.m, &self.c, &self.k].into_iter().take(count) {
            mark(form, &mut touched);
        }
        for felt in self.felt.iter().flat_map(|felt| &felt[..count]) {
            touched.iter_mut().zip(felt).for_each(|(touched, felt)| *touched |= felt);
        }
        // A chained row refers to coordinates and to chained rows before it.
        for (place, row) in self.chain.iter().enumerate().rev() {
            if touched[n + place] {
                row.iter().for_each(|(i, _)| touched[i.index()] = true);
            }
        }
        touched.truncate(n);
        touched
    }

    /// Every degree of freedom without inertia must follow the others by its springs, or lag behind them by its dampers;
    /// otherwise its position is undetermined. Combinations of degrees of freedom that are undetermined only together are
    /// found by the analyses.
    pub(super) fn every_freedom_is_determined(&self) -> Result<(), Vec<LowerError>> {
        let felt = self.touched_coordinates(3);
        let idle = |place: usize| self.idle_error(self.reduction.at(place));
        let idle: Vec<LowerError> = (0..felt.len()).filter(|place| !felt[*place]).map(idle).collect();
        if idle.is_empty() { Ok(()) } else { Err(idle) }
    }

    fn idle_error(&self, coordinate: Index) -> LowerError {
        let body = &self.scene.bodies[self.kinematics.free[coordinate as usize].index()];
        let name = self.words.display(body.name);
        LowerError::NoInertia {
            coordinate: format!("{name}.{}", self.kinematics.motion(self.scene, coordinate)),
            body: name,
            span: body.span,
            turns: self.kinematics.is_angle(coordinate),
        }
    }

    /// Items that are declared to act but have no effect; those with the value zero are not reported.
    pub(super) fn idle_parts(&self) -> Vec<Idle> {
        let acts = |element: &Element| !element.law.is_zero();
        let elements = self.idle.iter().copied().filter(|number| acts(&self.scene.elements[*number]));
        // A law without a tangent is reported by itself.
        let counts = |factor: &Number| !factor.is_zero() || !self.flat.is_empty();
        let still = |columns: &[Row; 3]| !columns.iter().flatten().any(|(_, factor)| counts(factor));
        let inputs = self.columns.iter().enumerate().filter(|(_, columns)| still(columns)).map(|(number, _)| number);
        let inputs = inputs.filter(|number| {
            !self.stiffening.contains(number) && !loads::displaces_a_base(self.scene, &self.scene.inputs[*number])
        });
        let flat = self.flat.iter().copied().map(Idle::Flat);
        elements.map(Idle::Element).chain(flat).chain(inputs.map(Idle::Input)).collect()
    }
}

/// Marks the coordinates that the terms of a form contain.
fn mark(form: &Form, touched: &mut [bool]) {
    for i in form.coordinates() {
        touched[i.index()] = true;
    }
}
