//! How the program is linked on Linux: at a fixed address, and with the code that unwinds panics in it. See
//! ARCHITECTURE.md#dependencies.
//!
//! A position-independent program of this size spends a sixth of `vibc analyze examples/cart.vib` on the addresses of its
//! own tables, which the loader writes into 70 pages at every start; at a fixed address the linker has written them.
//! Finding, mapping and starting the library `libgcc_s` takes a thirtieth more: it asks the processor what it is, which
//! virtual machines answer slowly.

use std::env::var;
use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let target = |key: &str| var(format!("CARGO_CFG_TARGET_{key}")).unwrap_or_default();
    if target("OS") == "linux" && target("ENV") == "gnu" {
        println!("cargo::rustc-link-arg-bin=vibc=-no-pie");
        if has_unwinder() {
            println!("cargo::rustc-link-arg-bin=vibc=-Wl,--push-state,--whole-archive,-lgcc_eh,--pop-state");
        }
    }
}

/// Whether the linker has the unwinder as a static library. Without it the program loads the shared one, as others do.
fn has_unwinder() -> bool {
    // A linker for another target is not asked: its name is not known here.
    if var("HOST").ok() != var("TARGET").ok() {
        return false;
    }
    let linker = var("RUSTC_LINKER").unwrap_or_else(|_| "cc".into());
    let asked = Command::new(linker).arg("-print-file-name=libgcc_eh.a").output();
    // A name without a folder comes back as it is if there is no such file.
    asked.is_ok_and(|found| {
        let path = String::from_utf8_lossy(&found.stdout).trim().to_string();
        Path::new(&path).is_absolute() && Path::new(&path).exists()
    })
}
