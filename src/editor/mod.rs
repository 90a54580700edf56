//! Support for editors: the standard layout of a model file, and information about the text at a place while it is
//! typed.
//!
//! [`document`] is a text with the results of all stages; each other module answers one kind of question from it, in
//! bytes and plain words. Only [`server`] knows the protocol. See spec.md#layout and docs/editors.md.

pub mod completion;
pub mod document;
pub mod fixes;
pub mod format;
pub mod highlight;
pub mod hints;
pub mod hover;
pub mod lexed;
pub mod names;
pub mod outline;
mod pages;
mod preview;
pub mod project;
pub mod roles;
pub mod server;
mod shown;
pub mod signature;
pub mod symbols;
pub mod tokens;

pub use pages::meanings;
