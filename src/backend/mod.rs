//! Answers and systems to text and JSON; diagnostics to what people and programs read. Nothing is computed here that an
//! analysis could have computed, and rounding happens nowhere else. Clause: spec.md, "Report" and "Diagnostics".

pub mod decimal;
pub mod diagnostics;
pub mod explain;
pub mod json;
pub mod report;
#[cfg(test)]
mod samples;
pub mod simulation;
pub mod transfer;

use crate::analysis::{Modes, Normalise, Poles, Stability};
use crate::lower::Rest;
use crate::system::LinearSystem;

/// All that a modal report says.
#[derive(Clone, Debug)]
pub struct ModalAnswer {
    /// The model's name.
    pub model: String,
    pub system: LinearSystem,
    pub rest: Rest,
    pub modes: Modes,
    pub poles: Poles,
    pub stability: Stability,
}

/// What of it is wanted, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReportOptions {
    pub normalise: Normalise,
    /// The matrices, however large.
    pub matrices: bool,
}
