//! What a model asks: parameters that are solved for, requirements, and what moves them. In: the text, to be tried with
//! parameters at other values. Out: the scene with what was solved, and an answer or a finding for each line.
//! See docs/method/measures.md.
//!
//! # Steps
//! 1. [`trial`]: values of parameters to a scene, a system, and the measures asked
//! 2. [`together`]: the unknowns in an order; one by one ([`search`]) or several at once ([`newton`])
//! 3. [`require`]: whether measures keep their limits, and by how much
//! 4. [`sensitivity`]: what moves frequencies and damping ratios

mod advice;
mod alone;
pub mod answer;
pub mod cover;
mod derivative;
pub mod error;
mod exact;
mod newton;
mod over;
mod probe;
mod require;
mod search;
mod sensitivity;
mod together;
pub mod trial;

pub use answer::{Requirement, Sensitivity, Solved};
pub use require::requirements;
pub use sensitivity::sensitivities;
pub use together::{Settled, solve};
pub use trial::{Known, Text};
