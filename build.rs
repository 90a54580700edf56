//! How the program is linked on Linux: at a fixed address. A position-independent program of this size spends a sixth of
//! `vibc analyze examples/cart.vib` on the addresses of its own tables, which the loader writes into 70 pages at every
//! start; at a fixed address the linker has written them. See ARCHITECTURE.md#dependencies.

use std::env::var;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let target = |key: &str| var(format!("CARGO_CFG_TARGET_{key}")).unwrap_or_default();
    if target("OS") == "linux" && target("ENV") == "gnu" {
        println!("cargo::rustc-link-arg-bin=vibc=-no-pie");
    }
}
