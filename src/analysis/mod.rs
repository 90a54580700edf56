//! Linear system to answers: modes, poles, and what they say about stability. Each answer carries its error bound and the
//! route that found it. Nothing here knows the language or the scene. Clause: spec.md, "Modes" and "Poles".

pub mod answer;
pub mod certificate;
mod companion;
pub mod complex;
pub mod dense;
mod discs;
pub mod error;
pub mod gram;
pub mod jacobi;
pub mod modes;
mod pencil;
mod pole_parts;
mod pole_proportional;
mod pole_quadratic;
mod pole_rigid;
mod poles;
mod refinement;
pub mod residues;
pub mod shape;
pub mod squares;
mod stability;
pub mod structure;
#[cfg(test)]
mod test_systems;
pub mod transfer;
mod transfer_exact;
mod transfer_inverse;

pub use answer::{Mode, ModeKind, Modes, Pole, PoleKind, Poles, Route, Share, Stability};
pub use error::AnalysisError;
pub use modes::modes;
pub use poles::poles;
pub use shape::{Normalise, normalise};
pub use stability::stability;
pub use transfer::{Disc, Frequency, Gain, Transfer};
