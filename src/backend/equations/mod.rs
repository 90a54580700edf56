//! Equations of motion as text, LaTeX, Typst, MathML and JSON: one layout value, and a file for each form. Clause: docs/equations.md.

mod build;
mod document;
mod formula;
mod json;
pub mod latex;
pub mod mathml;
mod solutions;
pub mod text;
pub mod typst;

pub use document::{Document, document};
pub use json::json;
pub use latex::latex;
pub use mathml::mathml;
pub use text::text;
pub use typst::typst;
