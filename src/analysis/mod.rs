//! Linear system to answers: modes, poles, and what they say about stability. Each answer carries its error bound and the
//! route that found it. Nothing here knows the language or the scene. Clause: spec.md, "Modes" and "Poles".

pub mod answer;
pub mod dense;
pub mod squares;

pub use answer::{Mode, ModeKind, Modes, Pole, PoleKind, Poles, Route, Share, Stability};
