//! The questions of a model: parameters to be solved for, requirements, and the parameters that affect them. In: the
//! text, which is evaluated with parameters at other values. Out: the scene with the parameters that were solved for,
//! and an answer or a finding for each line. See docs/method/measures.md.
//!
//! # Steps
//! 1. [`trial`]: from values of the parameters to a scene, a system, and its measures
//! 2. [`unknowns`]: puts the unknowns in an order; one by one ([`search`]) or several at once ([`newton`])
//! 3. [`optimum`]: parameters at which a measure is least or largest
//! 4. [`require`]: whether measures keep their limits, and by how much
//! 5. [`sensitivity`]: how frequencies and damping ratios depend on parameters

mod advice;
pub mod answer;
pub mod cases;
mod combined;
pub mod cover;
mod derivative;
pub mod error;
mod exact;
pub mod follow;
mod followed;
pub mod lines;
mod newton;
mod one_unknown;
mod optimum;
pub mod pole_updates;
mod probe;
mod range_enclosure;
mod ranges;
mod require;
pub mod rows;
pub mod samples;
mod search;
mod sensitivity;
pub mod tolerated;
pub mod trial;
mod unknowns;
pub mod updates;

pub use answer::{Optimised, Requirement, Sensitivity, Solved};
pub use optimum::settle;
pub use require::requirements;
pub use sensitivity::sensitivities;
pub use trial::{Facts, Text};
pub use unknowns::Settled;
