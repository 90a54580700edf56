//! Why ranges of quantities are not proved, where one thing is to blame for all of them. See docs/method/studies.md#tolerances.

use super::MOST_CUT;
use super::boxes::{Boxes, Point};
use crate::analysis::range::MOST;
use crate::model::scene::Damping;

impl Boxes<'_> {
    /// `declared`: the model at the declared values.
    pub fn why_unproved(&self, declared: &Point) -> Option<&'static str> {
        let lowered = &declared.system()?.lowered;
        let (system, rest) = (&lowered.system, &lowered.rest);
        if self.corners.free.len() > MOST_CUT {
            return Some("more than 30 parameters have a range");
        }
        if system.n() > MOST {
            return Some("the model has more than 30 coordinates");
        }
        if system.losses.is_some() {
            return Some("it has loss factors");
        }
        if rest.moves_terms && !self.is_lowered() {
            return Some("the system depends on the rest, which moves with these parameters");
        }
        let is_modal = matches!(declared.scene()?.scene().damping, Some(Damping::Modal { .. }));
        is_modal.then_some("its damping is given by modes")
    }
}
