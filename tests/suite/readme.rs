//! What the README, the tutorial and the pages on components and equations print is what the program prints. `UPDATE_DOCS=1 cargo test readme` writes it anew.

use super::documents::{blocks, page, root};
use std::fs;
use std::path::Path;
use std::process::Command;

/// A step of a document that its readers follow, in order.
enum Step<'a> {
    /// Text to be saved under a name: a `vib` block after a comment `file: NAME`.
    Save(&'a str, &'a str),
    /// A `console` block: commands, each with its output.
    Console(&'a str),
}

const FILE: &str = "<!-- file: ";
const MODEL: &str = "```vib\n";
const CONSOLE: &str = "```console\n";
const FENCE: &str = "```";

/// The steps of a document, each with the start of its block.
fn steps(document: &str) -> Vec<(usize, Step<'_>)> {
    let mut steps = Vec::new();
    let mut name = None;
    let mut at = 0;
    while let Some(line) = document[at..].split_inclusive('\n').next() {
        let start = at + line.len();
        let block = || document[start..].find(FENCE).map_or("", |end| &document[start..start + end]);
        at = start;
        if let Some(rest) = line.strip_prefix(FILE) {
            name = rest.split(' ').next();
        } else if line == MODEL {
            at += block().len() + FENCE.len();
            steps.extend(name.take().map(|name| (start, Step::Save(name, block()))));
        } else if line == CONSOLE {
            at += block().len() + FENCE.len();
            steps.push((start, Step::Console(block())));
        }
    }
    steps
}

/// A console block with the program's current output.
fn filled(block: &str, folder: &Path) -> String {
    let mut text = String::new();
    for command in block.lines().filter_map(|line| line.strip_prefix("$ ")) {
        let words: Vec<&str> = command.split_whitespace().collect();
        assert_eq!(words[0], "vibc", "{command}");
        let output = Command::new(env!("CARGO_BIN_EXE_vibc"))
            .args(&words[1..])
            .current_dir(folder)
            .output()
            .expect("the program starts");
        let printed =
            String::from_utf8(output.stdout).expect("UTF-8") + &String::from_utf8(output.stderr).expect("UTF-8");
        text += &format!("$ {command}\n{printed}");
    }
    text
}

/// Follows a document in a folder, and compares or rewrites each console block.
fn follow(path: &str, folder: &Path) {
    let document = page(path);
    let mut written = String::new();
    let mut copied = 0;
    for (start, step) in steps(&document) {
        match step {
            Step::Save(name, text) => fs::write(folder.join(name), text).expect("a temporary file"),
            Step::Console(block) => {
                written += &document[copied..start];
                written += &filled(block, folder);
                copied = start + block.len();
            }
        }
    }
    assert!(copied > 0, "{path} has no console block");
    written += &document[copied..];
    match std::env::var_os("UPDATE_DOCS") {
        Some(_) => fs::write(root().join(path), written).expect("the document is written"),
        None => assert!(
            written == document,
            "{path} shows other output than the program prints; UPDATE_DOCS=1 writes it anew:\n{written}"
        ),
    }
}

#[test]
fn the_readme_shows_what_the_program_prints() {
    follow("README.md", root());
}

#[test]
fn the_tutorial_shows_what_the_program_prints() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    follow("docs/tutorial.md", folder.path());
}

#[test]
fn the_page_on_components_shows_what_the_program_prints() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    follow("docs/components.md", folder.path());
}

#[test]
fn the_page_on_equations_shows_what_the_program_prints() {
    follow("docs/equations.md", root());
}

#[test]
fn the_model_that_is_shown_is_the_example() {
    let cart = fs::read_to_string(root().join("examples/cart.vib")).unwrap();
    assert!(blocks(&page("README.md"), "vib").contains(&cart), "README.md shows examples/cart.vib as it is");
    let hall = fs::read_to_string(root().join("examples/test_hall.vib")).unwrap();
    assert!(blocks(&page("docs/components.md"), "vib").contains(&hall), "and docs/components.md the test hall");
}

/// The set-up consists of two commands, and the gate runs the second.
#[test]
fn the_gate_runs_the_test_command_of_the_readme() {
    let set_up = blocks(&page("README.md"), "sh");
    assert_eq!(
        set_up.first().map(String::as_str),
        Some("cargo run --release -- analyze examples/cart.vib\ncargo test --locked\n")
    );
    let gate = fs::read_to_string(root().join(".ci/run")).unwrap();
    assert!(gate.lines().any(|line| line == "cargo test --locked"));
}

#[test]
fn the_readme_names_the_least_version_of_rust() {
    let cargo = page("Cargo.toml");
    let least = cargo.lines().find_map(|line| line.strip_prefix("rust-version = \"")?.strip_suffix('"'));
    let least = least.expect("Cargo.toml names the least version");
    assert!(page("README.md").contains(&format!("Rust {least} or later")), "README.md does not name Rust {least}");
}
