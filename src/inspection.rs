//! A model taken through the stages before any analysis, with the result of each stage: for editors, which also show what
//! is known about a model with errors.

use crate::base::{Diagnostics, FileId, Sources};
use crate::dynamics;
use crate::lower::Lowered;
use crate::model::scene::Damping;
use crate::model::{CheckedScene, Overrides, Setting};
use crate::questions::{Optimised, Requirement, Solved};
use crate::reading::{self, Reading};
use crate::syntax::tree::Tree;

/// The result of each stage for a model.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Inspection {
    /// `None` if a file is not text.
    pub tree: Option<Tree>,
    /// The scene with the values of solved parameters, if these were searched for.
    pub scene: Option<CheckedScene>,
    /// The linear system with all of its damping, unless something was left out.
    pub lowered: Option<Lowered>,
    /// The results of `solve` lines, and the values that they give to parameters.
    pub solved: Vec<Solved>,
    pub optimised: Vec<Optimised>,
    pub settings: Vec<Setting>,
    pub requirements: Vec<Requirement>,
    pub diagnostics: Diagnostics,
    /// Whether nothing was left out.
    pub is_whole: bool,
}

/// The extent to which a model is processed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Completely if the scene as declared has at most this many coordinates. Otherwise only as declared, without the
    /// lines that take many evaluations or all modes (`solve`, `require`, `damping modal`).
    UpTo(usize),
    Whole,
}

/// Takes the text of a model through the stages up to the linear system.
pub fn inspect(sources: &Sources, model: FileId, overrides: &Overrides, effort: Effort) -> Inspection {
    let mut diagnostics = Diagnostics::new();
    let inspection = match reading::read_and_check(sources, model, overrides, &mut diagnostics) {
        None => Inspection { is_whole: true, ..Inspection::default() },
        Some((tree, None)) => Inspection { tree: Some(tree), is_whole: true, ..Inspection::default() },
        Some((tree, Some(scene))) => {
            of_reading(Reading::read_declared(sources, overrides, tree, scene), effort, &mut diagnostics)
        }
    };
    Inspection { diagnostics, ..inspection }
}

fn of_reading(mut reading: Reading, effort: Effort, diagnostics: &mut Diagnostics) -> Inspection {
    let mut found = Diagnostics::new();
    let mut lowered = None;
    let is_whole = match effort {
        Effort::Whole => true,
        Effort::UpTo(most) => {
            lowered = dynamics::lower_undamped(&reading.scene, &mut found);
            lowered.as_ref().is_none_or(|lowered| lowered.system.n() <= most)
        }
    };
    // Findings about the scene as declared hold for the complete one, unless its unknowns get other values.
    let solves = reading.scene.scene().determines_parameters();
    if is_whole && (effort == Effort::Whole || solves) {
        if reading.settle(diagnostics).is_none() {
            return Inspection { tree: Some(reading.tree), is_whole, ..Inspection::default() };
        }
        found = Diagnostics::new();
        lowered = dynamics::lower_undamped(&reading.scene, &mut found);
    }
    diagnostics.extend(found);
    let is_modal = matches!(reading.scene.scene().damping, Some(Damping::Modal { .. }));
    let system = match lowered {
        Some(lowered) if is_whole || !is_modal => dynamics::with_damping(&reading.scene, lowered, diagnostics)
            .ok()
            .and_then(|damped| damped.into_written_out(diagnostics)),
        Some(lowered) => {
            return Inspection {
                tree: Some(reading.tree),
                scene: Some(reading.scene),
                lowered: Some(lowered),
                ..Inspection::default()
            };
        }
        None => None,
    };
    let asks = is_whole && system.is_some();
    let requirements = if asks { reading.requirements(system.as_ref(), None, diagnostics) } else { Vec::new() };
    let Reading { tree, scene, settings, solved, optimised, .. } = reading;
    Inspection {
        tree: Some(tree),
        scene: Some(scene),
        lowered: system.map(|system| system.lowered),
        solved,
        optimised,
        settings,
        requirements,
        diagnostics: Diagnostics::new(),
        is_whole,
    }
}
