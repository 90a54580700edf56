//! Syntax tree to the scene that was meant: names, units, freedoms. Clause: spec.md, "Names" to "Freedoms".

pub mod scene;
