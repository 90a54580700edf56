//! Answers and systems to text and JSON; diagnostics to what people and programs read. Nothing is computed here that an
//! analysis could have computed, and rounding happens nowhere else. Clause: spec.md, "Report" and "Diagnostics".

pub mod bench;
pub mod decimal;
pub mod diagnostics;
pub mod emit;
pub mod explain;
pub mod json;
mod json_number;
pub mod report;
#[cfg(test)]
mod samples;
pub mod simulation;
pub mod transfer;

use crate::analysis::{Buckling, Modes, Normalise, Poles, Verdict};
use crate::base::Number;
use crate::base::readable::escaped;
use crate::lower::{Account, Rest};
use crate::questions::answer::{Requirement, Sensitivity, Solved};
use crate::system::{Coordinate, LinearSystem};

/// All that a modal report says.
#[derive(Clone, Debug)]
pub struct ModalAnswer {
    /// The model's name.
    pub model: String,
    pub system: LinearSystem,
    pub rest: Rest,
    pub modes: Modes,
    pub poles: Poles,
    pub stability: Verdict,
    /// Where gravity, tensions or reactions take stiffness away.
    pub buckling: Option<Buckling>,
    /// What was kept of the model and what was left out, where that was asked for.
    pub account: Option<Account>,
    /// Parameters that were solved for, in order of their lines.
    pub solved: Vec<Solved>,
    pub requirements: Vec<Requirement>,
    /// Where they were asked for.
    pub sensitivities: Vec<Sensitivity>,
}

/// A value as JSON that steers no terminal.
fn json_text(value: &impl serde::Serialize) -> String {
    escaped(serde_json::to_string(value).expect("strings and numbers always have a JSON form"))
}

impl ModalAnswer {
    /// Every coordinate with its displacement at rest: those of the system, then those that depend on them.
    fn displacements(&self) -> impl Iterator<Item = (&Coordinate, &Number)> {
        let own = self.system.coordinates.iter().zip(&self.rest.displacement);
        let dependent = self.rest.dependent.iter().map(|dependent| (&dependent.coordinate, &dependent.displacement));
        own.chain(dependent)
    }
}

/// `1, 2, 3, ... 17 more`
fn counted_names(names: &[String]) -> String {
    const MOST: usize = 6;
    match names.len().checked_sub(MOST) {
        Some(more) if more > 1 => format!("{}, {more} more", names[..MOST].join(", ")),
        _ => names.join(", "),
    }
}

/// What of it is wanted, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReportOptions {
    pub normalise: Normalise,
    /// The matrices, however large.
    pub matrices: bool,
    /// Digits of frequencies and poles, as many of them as are certain; a handful in the text without it.
    pub digits: Option<u32>,
}

impl ReportOptions {
    /// Digits of a number that shows so many without being asked for more.
    fn digits(&self, usual: usize) -> usize {
        self.digits.map_or(usual, |digits| digits as usize)
    }
}
