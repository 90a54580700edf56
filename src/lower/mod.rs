//! From a scene to its linear system: joint tree, rest, exact second-order linearisation, assembly. The only place where
//! scene and system meet. See docs/method/kinematics.md, docs/method/rest.md and docs/method/linearisation.md.
//!
//! # Steps
//! 1. [`tree`]: which part carries which
//! 2. [`kinematics`]: how points move with the coordinates
//! 3. [`constraints`]: joints that close loops, and couplings
//! 4. [`rest`]: the static equilibrium
//! 5. [`assembly`]: M, C, K, inputs, outputs and initial state about that rest
//! 6. [`reactions`]: what joints carry, where an output asks for it

pub mod account;
pub mod assembly;
mod belts;
mod chain;
pub mod constraints;
mod drives;
pub mod error;
mod idle;
pub mod initial;
pub mod kinematics;
pub mod law;
pub mod loads;
pub mod mechanism;
mod nodes;
pub mod poses;
pub mod reactions;
pub mod rest;
pub mod tree;

pub use account::{Account, Remark, account};
pub use drives::{declared_signals, drives, noises, spectra};
pub use law::LawAtRest;
pub use mechanism::{Mechanism, Readout, SpringAtRest};
pub use nodes::{ShapeNode, nodes};
pub use poses::{Carried, Displacement, Poses};
pub use rest::{Dependent, Proven, Rest, Tension};

use crate::base::{Diagnostic, Diagnostics, runs};
use crate::model::CheckedScene;
use crate::model::scene::Scene;
use crate::system::LinearSystem;
use crate::system::chain::TooLong;
use assembly::{Terms, losses};
use error::LowerError;
use kinematics::Kinematics;
use reactions::Holding;

/// The result of lowering a scene.
#[derive(Clone, Debug)]
pub struct Lowered {
    pub system: LinearSystem,
    pub rest: Rest,
    /// The mechanism of the scene at its rest, for later questions.
    pub mechanism: Mechanism,
}

/// A lowered scene, unless there are errors.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub lowered: Option<Lowered>,
    pub diagnostics: Diagnostics,
}

/// The linear system of a scene about its rest.
pub fn lower(scene: &CheckedScene) -> Outcome {
    outcome(scene, Terms::Kept)
}

/// All that [`lower`] finds in a scene, in less memory: where the rest is known without its stiffness, the system is not kept.
pub fn check(scene: &CheckedScene) -> Diagnostics {
    outcome(scene, Terms::Dropped).diagnostics
}

fn outcome(scene: &CheckedScene, terms: Terms) -> Outcome {
    runs::begins("lower");
    let mut diagnostics = Diagnostics::new();
    let lowered = match lower_scene(scene.scene(), terms) {
        Ok((lowered, notes)) => {
            diagnostics.extend(notes);
            Some(lowered)
        }
        Err(errors) => {
            diagnostics.extend(errors.iter().map(LowerError::to_diagnostic));
            None
        }
    };
    Outcome { lowered, diagnostics }
}

impl Lowered {
    /// Writes chained rows out over the coordinates, as most analyses need them. If they do not fit into memory,
    /// returns an error and changes nothing.
    pub fn flatten(&mut self) -> Result<(), LowerError> {
        let found = self.system.flatten(kinematics::MAX_WRITTEN_OUT);
        found.map_err(|TooLong { entries, deepest }| {
            let span = self.system.coordinates[deepest.index()].span;
            LowerError::TooDeep { entries, span }
        })
    }
}

/// The lowered scene, and its notes. If the terms may be dropped, the system may be without them.
fn lower_scene(scene: &Scene, terms: Terms) -> Result<(Lowered, Vec<Diagnostic>), Vec<LowerError>> {
    let tree = tree::build(scene)?;
    let kinematics = Kinematics::new(scene, tree);
    kinematics.check(scene)?;
    let (constraints, notes) = constraints::build(scene, &kinematics)?;
    let mut found = rest::find(scene, &kinematics, &constraints)?;
    let reduction = constraints.reduction(scene, &kinematics, &found.state)?;
    constraints.check_redundant(scene, &kinematics, &found.state)?;
    constraints.check_freedom(scene, &kinematics, &reduction)?;
    let tensions = assembly::Tensions { held: found.held.as_ref(), slack: &found.slack };
    let is_needed = !found.is_complete() || !constraints.is_empty() || kinematics.hangs_deep(scene);
    let terms = if is_needed { Terms::Kept } else { terms };
    let (system, idle) =
        assembly::assemble(scene, &kinematics, &constraints, &reduction, &found.state, tensions, terms)?;
    let holding = Holding { constraints, held: found.held.take(), slack: std::mem::take(&mut found.slack) };
    let (rest, state) = match terms {
        Terms::Kept => found.finish(scene, &kinematics, &reduction, &system)?,
        Terms::Dropped => found.as_found(),
    };
    let notes = notes.into_iter().chain(idle::findings(scene, &kinematics, &idle));
    let mut notes: Vec<Diagnostic> = notes.chain(unproven(&system, &rest)).collect();
    let system = LinearSystem { losses: losses::losses(scene, &kinematics, &reduction, &state), ..system };
    let mechanism = Mechanism::new(kinematics, reduction, state, holding);
    notes.extend(belts::findings(scene, &mechanism, &rest));
    let rest = Rest { laws: mechanism.laws_at_rest(scene), ..rest };
    let mut lowered = Lowered { system, rest, mechanism };
    lowered.carry(scene, &scene.outputs, 0).map_err(|error| vec![error])?;
    Ok((lowered, notes))
}

/// The warning about an unproven rest, at the coordinate that moved farthest, or at the first one if none moved.
fn unproven(system: &LinearSystem, rest: &Rest) -> Option<Diagnostic> {
    if rest.is_proven() {
        return None;
    }
    let moved = |place: &usize| rest.displacement.get(*place).map_or(0.0, |value| value.to_f64().abs());
    let farthest = (0..system.n()).rev().max_by(|a, b| moved(a).total_cmp(&moved(b)))?;
    let coordinate = &system.coordinates[farthest];
    let name = (moved(&farthest) > 0.0).then(|| system.display(coordinate.name));
    Some(error::unproven(name.as_deref(), coordinate.span))
}
