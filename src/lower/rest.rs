//! The static rest: where the scene stays when nothing moves. Clause: spec.md, "Rest".

use super::error::LowerError;
use super::kinematics::{Index, Kinematics, Path, Reach, State};
use super::loads::{self, Between};
use crate::base::Number;
use crate::elements::stretch::over_length;
use crate::elements::{Scalar, Spring, Vector};
use crate::model::scene::{InputKind, Law, Scene, SpringRest};

/// The rest that lowering found, measured from the drawing.
#[derive(Clone, Debug)]
pub struct Rest {
    /// Displacement of each coordinate from the drawing, m or rad, in the order of the system's coordinates. An enclosure:
    /// the true rest lies in these balls (exact zeros where the drawing is the rest).
    pub displacement: Vec<Number>,
    /// Largest unbalanced generalised force that was left, relative to the largest force of a single element or weight;
    /// exactly 0 where the drawing is the rest.
    pub residual: f64,
    /// Whether the enclosure is proven (see spec.md, "Rest").
    pub proven: bool,
    /// Newton steps that were taken; 0 where the drawing is the rest.
    pub steps: u32,
}

/// The rest of a scene, and the state of all coordinates there.
pub fn find(scene: &Scene, kinematics: &Kinematics) -> Result<(Rest, State<Number>), Vec<LowerError>> {
    let state = State::drawn();
    let forces = forces(scene, kinematics, &state);
    if let Some(index) = forces.iter().position(|force| !force.is_zero()) {
        let span = scene.bodies[kinematics.free[index].body.index()].span;
        return Err(vec![LowerError::NotAvailable { what: "a rest that is not as drawn", span }]);
    }
    let displacement = vec![Number::ZERO; kinematics.n()];
    Ok((Rest { displacement, residual: 0.0, proven: true, steps: 0 }, state))
}

/// dV/dq at a state; empty where nothing loads the scene.
fn forces(scene: &Scene, kinematics: &Kinematics, state: &State<Number>) -> Vec<Number> {
    let mut gradient = Gradient { kinematics, state, sum: Vec::new(), reach: Reach::default(), row: Vec::new() };
    if !scene.gravity.is_zero() {
        let path = kinematics.weighted_way(scene, &scene.gravity);
        gradient.dead(&path, &Vector::of(&scene.gravity).negated());
    }
    let mut between = Between::default();
    for element in &scene.elements {
        if let Law::Spring { stiffness, rest } = &element.law
            && *rest != SpringRest::AsDrawn
        {
            let law = (stiffness, rest);
            let spring = loads::spring(kinematics, &element.ends, &element.geometry, law, &mut between);
            gradient.spring(&spring, &between);
        }
    }
    for input in &scene.inputs {
        let Some(load) = loads::constant(input) else { continue };
        match &input.kind {
            InputKind::Force { ends, direction } => {
                let direction = Vector::of(direction);
                let size = over_length(load, &direction.norm_squared());
                for (end, sign) in ends.iter().zip([-1, 1]) {
                    loads::absolute(kinematics, kinematics.end(end), &mut between.path);
                    gradient.dead(&between.path, &direction.scaled(&(&size * &Number::from(sign))));
                }
            }
            InputKind::ForceBetween { ends } => {
                let spring = loads::push(kinematics, ends, &load, &mut between);
                gradient.spring(&spring, &between);
            }
            InputKind::Torque { ends } => {
                for (end, sign) in ends.iter().zip([-1, 1]) {
                    if let Some(angle) = kinematics.angle(kinematics.tree.piece(end.part)) {
                        gradient.add(angle, &load * &Number::from(sign));
                    }
                }
            }
            InputKind::Base { .. } => {}
        }
    }
    gradient.sum
}

struct Gradient<'a> {
    kinematics: &'a Kinematics,
    state: &'a State<Number>,
    sum: Vec<Number>,
    reach: Reach<Number>,
    row: Vec<(Index, Number)>,
}

impl Gradient<'_> {
    fn add(&mut self, coordinate: Index, value: Number) {
        if self.sum.is_empty() {
            self.sum = vec![Number::ZERO; self.kinematics.n()];
        }
        if let Some(sum) = self.sum.get_mut(coordinate as usize) {
            *sum = &*sum + &value;
        }
    }

    fn dead(&mut self, path: &Path<Number>, force: &Vector<Number>) {
        self.reach.measure(self.kinematics, self.state, path);
        self.reach.row(force, &mut self.row);
        for (coordinate, value) in std::mem::take(&mut self.row) {
            self.add(coordinate, value);
        }
    }

    fn spring(&mut self, spring: &Spring<Number>, between: &Between<Number>) {
        self.reach.measure(self.kinematics, self.state, &between.path);
        let stretched = spring.stretch.at(&self.reach.displacement, &between.turn(self.state));
        let tension = spring.tension(&stretched);
        if tension.is_zero() {
            return;
        }
        match stretched.force(&tension) {
            Some(force) => self.reach.row(&force, &mut self.row),
            None => {
                between.turn_row(&mut self.row);
                for (_, value) in &mut self.row {
                    *value = value.times(&tension);
                }
            }
        }
        for (coordinate, value) in std::mem::take(&mut self.row) {
            self.add(coordinate, value);
        }
    }
}
