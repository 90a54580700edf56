//! The static rest: where the scene stays when nothing moves. Clause: spec.md, "Rest".

use crate::base::Number;

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
