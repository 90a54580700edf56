//! The part of a system in harmonic motion that comes from loss factors. In: a scene at its rest. Out: a square for each spring with a loss
//! factor, and its parts in inputs and outputs; nothing for a scene without them. See docs/method/system.md#loss-factors.

use super::{Assembly, Sparse, Tensions, equation, merge_column};
use crate::base::Number;
use crate::elements::Order;
use crate::lower::constraints::Reduction;
use crate::lower::kinematics::{Kinematics, State};
use crate::lower::rest::Slack;
use crate::model::scene::{Element, Motion, Output, Scene};
use crate::system::{Losses, Origin, Source};

/// The part of an output that loss factors add: over the coordinates, and over the inputs.
type Read = (Sparse, Vec<(u32, Number)>);

/// Whether a spring of the scene has a loss factor.
pub fn has_losses(scene: &Scene) -> bool {
    scene.elements.iter().any(|element| element.law.loss.is_some())
}

/// The contributions of loss factors to the system of a scene and to its outputs; `None` if there are none.
pub fn losses(
    scene: &Scene,
    kinematics: &Kinematics,
    reduction: &Reduction,
    state: &State<Number>,
) -> Option<Box<Losses>> {
    if !has_losses(scene) {
        return None;
    }
    let mut assembly = Assembly::new(scene, kinematics, reduction, state, NO_TENSIONS);
    for (number, element) in scene.elements.iter().enumerate() {
        assembly.loss(number, element);
    }
    let columns = std::mem::take(&mut assembly.columns);
    let b = columns.into_iter().map(|[_, column, _]| merge_column(column)).collect();
    let (p, d) = scene.outputs.iter().map(|output| assembly.lost_in(output)).unzip();
    Some(Box::new(Losses { h: assembly.c, b, p, d, by_rate: Vec::new() }))
}

/// The contributions of loss factors to further outputs.
pub fn of_outputs(
    scene: &Scene,
    kinematics: &Kinematics,
    reduction: &Reduction,
    state: &State<Number>,
    outputs: &[Output],
) -> Vec<Read> {
    let mut assembly = Assembly::new(scene, kinematics, reduction, state, NO_TENSIONS);
    outputs.iter().map(|output| assembly.lost_in(output)).collect()
}

/// Stiffness due to tensions has no loss.
const NO_TENSIONS: Tensions<'static> = Tensions { held: None, slack: &Slack::NONE };

impl Assembly<'_> {
    /// Adds k loss (grad e)(grad e)^T, as of a damper.
    fn loss(&mut self, number: usize, element: &Element) {
        let Some(loss) = &element.law.loss else { return };
        let stretch = self.between.set_ends(self.kinematics, &element.ends, &element.law.geometry);
        let stretched = self.measure_stretch(&stretch);
        let source = self.c.source(Source { name: element.name, origin: Origin::Element(number as u32) });
        let weight = &element.law.coefficient * loss;
        self.slope_square(Order::Velocity, source, &weight, &stretched);
    }

    /// The forces of springs among the terms of an output, times their loss factors.
    fn lost_in(&mut self, output: &Output) -> Read {
        let mut row = super::Row::new();
        for term in &output.terms {
            let Motion::Force { element } = &term.motion else { continue };
            let element = &self.scene.elements[element.index()];
            let Some(loss) = &element.law.loss else { continue };
            let factor = &output.coefficient(term) * loss;
            row.extend(self.element_force(element).1.into_iter().map(|(i, value)| (i, &value * &factor)));
        }
        let row = equation::merge_entries(row);
        let p = row.iter().filter_map(|(i, value)| Some((self.reduction.place(*i)?, value.clone()))).collect();
        let d = row.iter().filter_map(|(i, value)| Some((self.input_of(*i)? as u32, value.clone()))).collect();
        (p, d)
    }
}
