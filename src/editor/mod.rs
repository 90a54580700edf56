//! What an editor asks for: the one layout of a model file.
//!
//! Clause: spec.md, "Layout".

pub mod format;
pub mod tokens;
