//! Why ranges of quantities are not proved, where one thing is to blame for all of them, or the measure
//! itself is never enclosed. See docs/method/studies.md#tolerances.

use super::{Asked, MOST_CUT};
use crate::analysis::range::MOST;
use crate::model::scene::{Damping, Measure};

impl Asked<'_> {
    pub fn why_unproved(&self) -> Option<&'static str> {
        let declared = self.points.first()?;
        let system = &declared.system()?.lowered.system;
        let corners = self.boxes.corners;
        if corners.free.len() > MOST_CUT {
            return Some("more than 30 parameters have a range");
        }
        if system.n() > MOST {
            return Some("the model has more than 30 coordinates");
        }
        if system.losses.is_some() {
            return Some("it has loss factors");
        }
        if !self.keeps_rest || self.boxes.strays() {
            return Some(match corners.rest_over_all() {
                Some(_) => "for some of these values the model comes to rest elsewhere",
                None => "the rest moves with these parameters, too far or too freely to be enclosed",
            });
        }
        let is_modal = matches!(declared.scene()?.scene().damping, Some(Damping::Modal { .. }));
        is_modal.then_some("its damping is given by modes")
    }
}

/// Why the values of a measure are not enclosed over any box.
pub(super) fn why_never(measure: &Measure) -> Option<&'static str> {
    match measure {
        Measure::Peak { .. } => Some("the largest of a motion in time is not enclosed over ranges"),
        Measure::Settling { .. } => {
            Some("a settling time may jump from one swing to the next, and is not enclosed over ranges")
        }
        Measure::Overshoot { .. } => Some("the overshoot of a motion in time is not enclosed over ranges"),
        Measure::Rms { .. } | Measure::RmsWithin { .. } => Some("mean squares are not enclosed over ranges"),
        Measure::Crossings { .. } => {
            Some("a rate of crossings is a quotient of mean squares, which are not enclosed over ranges")
        }
        Measure::LoadFactor => Some("the factor of buckling is not enclosed over ranges"),
        Measure::Combined(combined) => {
            let mut why = None;
            combined.map(&mut |part| why = why.or_else(|| why_never(part)));
            why
        }
        Measure::Frequency { .. }
        | Measure::DampingRatio { .. }
        | Measure::Gain { .. }
        | Measure::Phase { .. }
        | Measure::Amplitude { .. }
        | Measure::Static { .. }
        | Measure::Psd { .. }
        | Measure::PeakGain { .. }
        | Measure::EffectiveMass { .. }
        | Measure::Rest { .. }
        | Measure::Stable => None,
    }
}
