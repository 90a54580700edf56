//! The scalar equations of closing joints and couplings. In: scene and kinematics. Out: a list in order of declaration,
//! joints first. See docs/method/kinematics.md#constraints.

use super::equation::{Component, Equation};
use super::{Constraint, Source};
use crate::base::{Number, Vec3};
use crate::elements::{Scalar, Vector};
use crate::joints::Displacement;
use crate::kinds::motions::ReactionComponent;
use crate::lower::kinematics::{End, Index, Kinematics, Path, axis_of};
use crate::lower::loads;
use crate::model::scene::{Couple, Joint, Motion, MotionTerm, Scene};

/// The number of a joint's equation of angles.
const TURN: u8 = 2;

impl Constraint {
    /// Lets its left side be a released motion instead of zero; `false` if it does not hold that motion.
    pub fn release(&mut self, component: ReactionComponent, coordinate: Index) -> bool {
        match axis_of(component) {
            Some(axis) if self.part != TURN => {
                self.equation.components.iter_mut().for_each(|component| component.path.release(coordinate, axis));
            }
            None if self.part == TURN || component == ReactionComponent::Coupling => {
                self.equation.turns.push((coordinate, Number::from(-1)));
            }
            _ => return false,
        }
        true
    }
}

/// Every equation of a scene.
pub fn constraint_equations(scene: &Scene, kinematics: &Kinematics) -> Vec<Constraint> {
    let mut list = Vec::new();
    for id in &kinematics.tree.closing {
        let equations = of_joint(kinematics, &scene.joints[id.index()]);
        let source = Source::Joint(*id);
        list.extend(equations.into_iter().map(|(part, equation)| Constraint { source, part, equation }));
    }
    for (number, couple) in scene.couples.iter().enumerate() {
        let source = Source::Couple(number as u32);
        list.push(Constraint { source, part: 0, equation: of_couple(kinematics, couple) });
    }
    list
}

fn of_joint(kinematics: &Kinematics, joint: &Joint) -> Vec<(u8, Equation<Number>)> {
    let held = joint.constrained_motions();
    let pieces = [0, 1].map(|end| kinematics.tree.piece(joint.ends[end].part));
    let angles = pieces.map(|piece| kinematics.angle(piece));
    // Parts without relative rotation may be compared at any known point.
    let anchor = |end: usize| kinematics.tree.pieces[pieces[end] as usize].anchor.as_deref();
    let given = |end: usize| joint.ends[end].at.as_deref();
    let at = given(0).or_else(|| given(1)).or_else(|| anchor(0)).or_else(|| anchor(1));
    let mut path = Path::default();
    kinematics.path_between(End { piece: pieces[0], at }, End { piece: pieces[1], at }, &mut path);
    let component = |direction: Vector<Number>, carrier| {
        let components = vec![Component { path: path.clone(), direction, carrier }];
        Equation { components, turns: Vec::new() }
    };
    let displacements = match &held.displacement {
        Displacement::All => [Vec3::X, Vec3::Y].map(|axis| component(Vector::of(&axis), None)).to_vec(),
        Displacement::Across(along) => vec![component(Vector::of(&Vec3::Z.cross(along)), angles[0])],
    };
    let mut equations: Vec<(u8, Equation<Number>)> = (0..).zip(displacements).collect();
    if held.turn && angles[0] != angles[1] {
        let turn = |end: usize, factor: i64| angles[end].map(|angle| (angle, Number::from(factor)));
        let turns = [turn(0, -1), turn(1, 1)].into_iter().flatten().collect();
        equations.push((TURN, Equation { components: Vec::new(), turns }));
    }
    equations
}

/// Sum of coefficient times displacement or angle, measured from the drawing.
fn of_couple(kinematics: &Kinematics, couple: &Couple) -> Equation<Number> {
    let mut equation = Equation { components: Vec::new(), turns: Vec::new() };
    for MotionTerm { coefficient, motion } in &couple.terms {
        match motion {
            Motion::Point { part, at, direction, .. } => {
                let mut path = Path::default();
                loads::path_from_ground(kinematics, kinematics.point(*part, at.as_deref()), &mut path);
                path.shrink_to_fit();
                let direction = Vector::of(direction).scale(coefficient);
                equation.components.push(Component { path, direction, carrier: None });
            }
            Motion::Turn { part, .. } => {
                let angle = kinematics.angle(kinematics.tree.piece(*part));
                equation.turns.extend(angle.map(|angle| (angle, coefficient.clone())));
            }
            // The check accepts displacements and angles only.
            Motion::Force { .. } | Motion::Stretch { .. } | Motion::Reaction(_) => {}
        }
    }
    equation.turns.retain(|(_, factor)| !Scalar::is_zero(factor));
    equation.components.shrink_to_fit();
    equation.turns.shrink_to_fit();
    equation
}
