//! A compiler for mechanical vibrations: from a drawn scene to matrices, modes, poles and simulation code.
//!
//! # Steps
//! 1. [`syntax`]: text to syntax tree
//! 2. [`model`]: tree to checked scene
//! 3. [`lower`]: scene to linear system about its rest
//! 4. [`analysis`]: system to answers, each with its error bound
//! 5. [`backend`]: answers and systems to text, JSON, CSV, code
//!
//! The core does no input or output: text in, data out. Standard streams and files are touched in `main.rs` only.

pub mod analysis;
pub mod backend;
pub mod base;
pub mod elements;
pub mod joints;
pub mod lower;
pub mod model;
pub mod syntax;
pub mod system;
