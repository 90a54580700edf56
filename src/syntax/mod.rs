//! Text to syntax tree. Clause: spec.md, "Grammar".

pub mod tree;
