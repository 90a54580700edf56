//! The one file with `unsafe` code, under AddressSanitizer: what reads or writes beyond a slice is seen.

use std::path::Path;
use std::process::Command;

/// Compiles the file by itself, with its tests, and runs them. (The sanitizer is an option of nightly compilers, which every
/// compiler takes with RUSTC_BOOTSTRAP.)
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
#[test]
fn wide_loops_stay_within_their_slices() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("linear/src/kernel/simd.rs");
    let folder = tempfile::tempdir().expect("a folder");
    let root = folder.path().join("simd.rs");
    let text = format!(
        "pub mod base {{ pub struct Dd; }}\npub mod kernel {{ #[path = {:?}] pub mod simd; }}\n",
        source.display().to_string()
    );
    std::fs::write(&root, text).expect("a file");
    let program = folder.path().join("simd");
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let compiled = Command::new(rustc)
        .env("RUSTC_BOOTSTRAP", "1")
        .args(["--edition", "2024", "--test", "-O", "-Zsanitizer=address", "--cap-lints", "allow", "-o"])
        .args([&program, &root])
        .output()
        .expect("the compiler");
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let ran = Command::new(&program).output().expect("the program");
    let messages = String::from_utf8_lossy(&ran.stdout);
    assert!(ran.status.success(), "{messages}{}", String::from_utf8_lossy(&ran.stderr));
    assert!(messages.contains("test result: ok. 5 passed"), "{messages}");
}
