//! The program, run on a model that a test writes: its answers and what it finds.

use serde_json::Value;
use std::fs;
use std::process::{Command, Output};

/// `vibc ARGUMENTS m.vib` in a folder of its own.
pub fn ran(model: &str, arguments: &[&str]) -> Output {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("m.vib"), model).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_vibc"));
    command.args(arguments).arg("m.vib").current_dir(folder.path()).output().expect("the program starts")
}

/// What it prints.
pub fn text(model: &str, arguments: &[&str]) -> String {
    let output = ran(model, arguments);
    assert!(output.status.success(), "{model}\n{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// What it prints with `--format json`.
pub fn json(model: &str, arguments: &[&str]) -> Value {
    let text = text(model, &[arguments, &["--format", "json"]].concat());
    serde_json::from_str(&text).expect("JSON")
}

/// Its only finding.
pub fn finding(model: &str, arguments: &[&str]) -> Value {
    let output = ran(model, &[arguments, &["--message-format", "json"]].concat());
    let text = String::from_utf8_lossy(&output.stderr);
    let mut found: Vec<Value> =
        text.lines().map(|line| serde_json::from_str(line).expect("one object a line")).collect();
    assert_eq!(found.len(), 1, "{model}: {text}");
    found.remove(0)
}

/// The code of its only finding.
pub fn code(model: &str, arguments: &[&str]) -> String {
    finding(model, arguments)["code"].as_str().expect("a code").to_string()
}

/// The rows that the emitted program of a model prints, compiled by gcc.
pub fn emitted(model: &str, step: &str, until: &str) -> Vec<Vec<f64>> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("m.vib"), model).expect("a file");
    let run = |program: &str, arguments: &[&str]| {
        let output = Command::new(program).args(arguments).current_dir(folder.path()).output().expect("it starts");
        assert!(output.status.success(), "{program}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).expect("text")
    };
    let emit = ["emit", "m.vib", "--target", "c", "--program", "--step", step, "--until", until, "-o", "code"];
    run(env!("CARGO_BIN_EXE_vibc"), &emit);
    run("gcc", &["-O1", "-o", "code/run", "code/m.c", "code/main.c", "-lm"]);
    let printed = run("code/run", &[]);
    printed.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().expect("a number")).collect()).collect()
}
