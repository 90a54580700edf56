//! Emitted code: compiled as strictly as compilers can, run, and compared with the exact response. Clause: spec.md,
//! "Simulation code".

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;
use vibc::analysis::discrete::{Hold, Options, Precision};
use vibc::backend::emit::{self, Language};
use vibc::base::{Number, SourceFile, SourceKind, Sources};
use vibc::model::Overrides;

/// Flags under which emitted C must be silent.
pub const STRICT: [&str; 6] = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"];

pub fn options(step: &str) -> Options {
    Options {
        step: Number::from(step),
        hold: Hold::Zero,
        precision: Precision::Double,
        tolerance: None,
        unpruned: false,
        built_in: false,
        internal: Vec::new(),
        until: None,
    }
}

/// A model as emitted code computes it.
pub fn emission(name: &str, text: &str, options: &Options) -> vibc::Emission {
    let mut sources = Sources::new();
    let model = sources.add(SourceFile::decode(SourceKind::Model, name, text.as_bytes().to_vec()));
    let outcome = vibc::discrete(&sources, model, &Overrides::default(), options);
    outcome.answer.unwrap_or_else(|| panic!("{name}: {:?}", outcome.diagnostics))
}

/// The examples that have outputs: name and text.
pub fn examples() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut files: Vec<_> =
        fs::read_dir(folder).expect("examples").map(|entry| entry.expect("an example").path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "vib"));
    files.sort();
    let text = |path: &Path| fs::read_to_string(path).expect("an example");
    let name = |path: &Path| path.file_stem().expect("a name").to_string_lossy().into_owned();
    let all = files.iter().map(|path| (name(path), text(path)));
    all.filter(|(_, text)| text.lines().any(|line| line.starts_with("output"))).collect()
}

/// Whether a tool is there; where it is not, its tests say so and pass, but not in a gate that must run them.
pub fn has(tool: &str) -> bool {
    let there = Command::new(tool).arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        let mut stderr = std::io::stderr();
        let _ = std::io::Write::write_all(&mut stderr, format!("skipped: `{tool}` is not installed\n").as_bytes());
    }
    there
}

pub fn write(folder: &TempDir, files: &[emit::File]) {
    for file in files {
        fs::write(folder.path().join(&file.name), &file.text).expect("a temporary file");
    }
}

/// Runs a tool in a folder; it must succeed without a word.
pub fn silently(folder: &TempDir, tool: &str, arguments: &[&str]) {
    let output = run(folder, tool, arguments);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.is_empty(), "{tool} {arguments:?}: {said}");
}

fn run(folder: &TempDir, tool: &str, arguments: &[&str]) -> Output {
    Command::new(tool).args(arguments).current_dir(folder.path()).output().expect("the tool starts")
}

#[test]
fn emitted_code_compiles_without_a_word() {
    for (name, text) in examples() {
        let emission = emission(&name, &text, &options("0.01"));
        let folder = tempfile::tempdir().expect("a folder");
        for language in [Language::C, Language::Rust] {
            write(&folder, &emit::files(&emission.model, &emission.system, language, None));
        }
        let c = format!("{name}.c");
        for compiler in ["gcc", "clang"] {
            if has(compiler) {
                silently(&folder, compiler, &[&STRICT[..], &["-c", "-O1", &c, "-o", "c.o"]].concat());
            }
        }
        if has("g++") {
            let flags =
                ["-x", "c++", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-c", &c, "-o", "p.o"];
            silently(&folder, "g++", &flags);
        }
        // As a crate of its own, without `std`.
        let module = format!("{name}.rs");
        let crate_text = format!(
            "#![no_std]\n#![forbid(unsafe_code)]\n#![deny(warnings)]\n#[path = \"{module}\"]\npub mod model;\n"
        );
        fs::write(folder.path().join("lib.rs"), crate_text).expect("a temporary file");
        silently(&folder, "rustc", &["--edition", "2021", "--crate-type", "lib", "--emit", "metadata", "lib.rs"]);
    }
}

#[test]
fn the_same_model_gives_the_same_bytes() {
    for (name, text) in examples() {
        let one = |_: usize| {
            let emission = emission(&name, &text, &options("0.001"));
            [Language::C, Language::Rust].map(|language| emit::whole(&emission.model, &emission.system, language))
        };
        assert_eq!(one(0), one(1), "{name}");
    }
}
