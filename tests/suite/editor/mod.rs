//! The language server as a client sees it, request by request. See docs/editors.md.

mod client;
mod files;
mod fixes;
mod process;
mod requests;
mod robust;
