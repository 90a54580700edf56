//! Scene to linear system: joint tree, rest, exact second-order linearisation, assembly. The only place where scene and
//! system meet. Clause: spec.md, "Freedoms", "Rest", "Linearisation".

pub mod rest;

pub use rest::Rest;

use crate::system::LinearSystem;

/// What lowering makes of a scene.
#[derive(Clone, Debug)]
pub struct Lowered {
    pub system: LinearSystem,
    pub rest: Rest,
}
