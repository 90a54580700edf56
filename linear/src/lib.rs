//! Linear systems of mechanical vibrations and their analyses, each answer with its error bound. Nothing here knows the
//! language or a scene: the crate `vibc` makes systems of scenes and reports of answers.
//!
//! This is a part of the program, not an interface: what other programs may use is re-exported by `vibc`. See
//! ARCHITECTURE.md#two-crates.

// `kernel::simd` alone allows it, with its reasons.
#![deny(unsafe_code)]
// Tests compare with the platform's functions to a few digits only.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

pub mod analysis;
pub mod base;
pub mod bench;
pub mod kernel;
pub mod system;
