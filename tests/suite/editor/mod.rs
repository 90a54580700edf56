//! The language server as a client sees it, request by request. Clause: spec.md, "Editors".

mod client;
mod mends;
mod requests;
mod robust;
