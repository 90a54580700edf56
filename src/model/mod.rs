//! Syntax tree to the scene that was meant: names, units, freedoms. Clause: spec.md, "Names" to "Freedoms".

pub mod scene;

use crate::base::FileId;
use scene::Scene;

/// What overrides parameters of the model, checked like the model itself.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides {
    /// `--set NAME=VALUE`, one a line.
    pub arguments: Option<FileId>,
    /// A TOML file of settings.
    pub settings: Option<FileId>,
}

/// A scene that has passed every check: lowering takes nothing else.
#[derive(Clone, Debug)]
pub struct CheckedScene {
    scene: Scene,
}

impl CheckedScene {
    /// For the check alone, and for tests of what comes after it.
    pub fn new(scene: Scene) -> CheckedScene {
        CheckedScene { scene }
    }

    pub fn scene(&self) -> &Scene {
        &self.scene
    }
}
