//! The language server as a client sees it, request by request. See docs/editors.md.

mod client;
mod mends;
mod process;
mod requests;
mod robust;
