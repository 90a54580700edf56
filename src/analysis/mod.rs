//! Linear system to answers: modes, poles, and what they say about stability. Each answer carries its error bound and the
//! route that found it. Nothing here knows the language or the scene. Clause: spec.md, "Modes" and "Poles".

pub mod answer;
pub mod certificate;
pub mod dense;
pub mod error;
pub mod gram;
pub mod jacobi;
pub mod modes;
pub mod residues;
pub mod shape;
pub mod squares;
pub mod structure;

pub use answer::{Mode, ModeKind, Modes, Pole, PoleKind, Poles, Route, Share, Stability};
pub use error::AnalysisError;
pub use modes::modes;
pub use shape::{Normalise, normalise};
