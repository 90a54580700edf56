//! What springs feel at rest. In: a scene and its rest; out: the tension and the stretch of each spring. For people who
//! look at one of them: nothing that lowering needs. Clause: spec.md, "Rest".

use super::kinematics::{Kinematics, Reach, State};
use super::loads::{self, Between};
use super::rest::Rest;
use super::{assembly, tree};
use crate::base::Number;
use crate::elements::stretch::over_length;
use crate::model::CheckedScene;
use crate::model::scene::{ElementId, Law, Scene};
use crate::system::LinearSystem;

/// A spring at rest.
#[derive(Clone, Debug)]
pub struct SpringAtRest {
    pub element: ElementId,
    /// N or N m; pull is positive.
    pub tension: Number,
    /// From the drawing to the rest, m or rad.
    pub change: Number,
}

/// Every spring of a scene at a rest that was found for it; empty where the scene has none of that shape.
pub fn springs_at_rest(scene: &CheckedScene, system: &LinearSystem, rest: &Rest) -> Vec<SpringAtRest> {
    let scene = scene.scene();
    let Ok(tree) = tree::build(scene) else { return Vec::new() };
    let kinematics = Kinematics::new(scene, tree);
    let mut state = loads::drawn(scene, &kinematics);
    let own = system.coordinates.iter().zip(&rest.displacement);
    let dependent = rest.dependent.iter().map(|dependent| (&dependent.coordinate, &dependent.displacement));
    let (mut own, mut dependent) = (own.peekable(), dependent.peekable());
    for index in 0..kinematics.n() {
        let name = assembly::coordinate(scene, &kinematics, index as u32).name;
        let found = own.next_if(|(coordinate, _)| coordinate.name == name);
        let found = found.or_else(|| dependent.next_if(|(coordinate, _)| coordinate.name == name));
        let Some((_, displacement)) = found else { return Vec::new() };
        if !displacement.is_zero() {
            let length_squared = kinematics.length_squared(index as u32).cloned().unwrap_or(Number::ONE);
            state.set(&kinematics, index as u32, over_length(displacement.clone(), &length_squared));
        }
    }
    let mut list = springs(scene, &kinematics, &state);
    // What holds the drawing where it is declared to be the rest.
    for found in &rest.tensions {
        let of_it = |spring: &&mut SpringAtRest| scene.elements[spring.element.index()].name == found.spring.name;
        if let Some(spring) = list.iter_mut().find(of_it) {
            spring.tension = found.tension.clone();
        }
    }
    list
}

fn springs(scene: &Scene, kinematics: &Kinematics, state: &State<Number>) -> Vec<SpringAtRest> {
    let (mut between, mut reach) = (Between::default(), Reach::default());
    let mut list = Vec::new();
    for (index, element) in scene.elements.iter().enumerate() {
        let Law::Spring { stiffness, rest } = &element.law else { continue };
        let spring = loads::spring(kinematics, &element.ends, &element.geometry, (stiffness, rest), &mut between);
        reach.measure(kinematics, state, &between.path);
        let stretched = spring.stretch.at(&reach.displacement, &between.turn(state));
        let (tension, change) = (spring.tension(&stretched), stretched.change().clone());
        list.push(SpringAtRest { element: ElementId(index as u32), tension, change });
    }
    list
}
