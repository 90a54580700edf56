//! Equations of motion as text, LaTeX, Typst, MathML and JSON: one layout value, and a file for each format. Clause:
//! docs/equations.md.

mod assumptions;
mod build;
mod document;
mod element_forces;
mod energies;
mod fold;
mod formula;
mod json;
mod latex;
mod lengths;
mod lines;
mod mathml;
mod motions;
mod results;
mod roots;
mod solutions;
mod text;
mod typst;
mod values;
mod write;

pub use document::{Document, Section, document};
pub use json::json;
pub use latex::latex;
pub use mathml::{mathml, section as mathml_section};
pub use text::{of_bodies, text};
pub use typst::typst;
