//! The language server as a client sees it, request by request. Clause: spec.md, "Editors".

mod client;
mod mends;
mod process;
mod requests;
mod robust;
