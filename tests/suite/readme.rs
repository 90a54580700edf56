//! What the README prints is what the program prints.

use std::fs;
use std::path::Path;
use std::process::Command;
use vibc::base::{SourceFile, Sources};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn readme() -> String {
    fs::read_to_string(root().join("README.md")).expect("README.md")
}

/// The fenced blocks of a kind.
fn blocks(readme: &str, kind: &str) -> Vec<String> {
    let fence = format!("```{kind}\n");
    readme.split(&fence).skip(1).filter_map(|rest| rest.split("```").next()).map(String::from).collect()
}

/// Commands of a console block, each with what the block prints after it.
fn commands(block: &str) -> Vec<(String, String)> {
    let mut commands: Vec<(String, String)> = Vec::new();
    for line in block.lines() {
        match (line.strip_prefix("$ "), commands.last_mut()) {
            (Some(command), _) => commands.push((command.to_string(), String::new())),
            (None, Some((_, output))) => *output += &format!("{line}\n"),
            (None, None) => panic!("a console block begins with a command: {line}"),
        }
    }
    commands
}

#[test]
fn each_console_block_is_what_the_program_prints() {
    let blocks = blocks(&readme(), "console");
    let commands: Vec<(String, String)> = blocks.iter().flat_map(|block| commands(block)).collect();
    assert!(!commands.is_empty());
    for (command, shown) in commands {
        let words: Vec<&str> = command.split_whitespace().collect();
        assert_eq!(words[0], "vibc", "{command}");
        let output = Command::new(env!("CARGO_BIN_EXE_vibc")).args(&words[1..]).current_dir(root()).output().unwrap();
        let printed = String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap();
        assert_eq!(printed, shown, "{command}");
    }
}

#[test]
fn the_model_that_is_shown_is_the_example() {
    let cart = fs::read_to_string(root().join("examples/cart.vib")).unwrap();
    assert!(blocks(&readme(), "vib").contains(&cart), "README.md shows examples/cart.vib as it is");
}

/// What the README shows of the language is in the language.
#[test]
fn every_model_block_is_in_the_grammar() {
    for block in blocks(&readme(), "vib") {
        let mut sources = Sources::new();
        let file = sources.add(SourceFile::model("README.md", block));
        let errors = vibc::syntax::parse(&sources, file).errors;
        assert!(errors.is_empty(), "{:?}", errors.iter().collect::<Vec<_>>());
    }
}

/// Two commands are the whole set-up, and the gate runs the second.
#[test]
fn the_gate_runs_the_test_command_of_the_readme() {
    let set_up = blocks(&readme(), "sh");
    assert_eq!(
        set_up.first().map(String::as_str),
        Some("cargo run --release -- analyze examples/cart.vib\ncargo test --locked\n")
    );
    let gate = fs::read_to_string(root().join(".ci/run")).unwrap();
    assert!(gate.lines().any(|line| line == "cargo test --locked"));
}

/// A file that the README names is there.
#[test]
fn links_lead_somewhere() {
    let readme = readme();
    let links = readme.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    for link in links.filter(|link| !link.contains("://")) {
        match link.strip_prefix('#') {
            Some(section) => {
                let heading = |line: &str| line.trim_start_matches('#').trim().to_lowercase().replace(' ', "-");
                assert!(readme.lines().any(|line| line.starts_with("## ") && heading(line) == section), "{link}");
            }
            None => assert!(root().join(link).exists(), "{link}"),
        }
    }
}
