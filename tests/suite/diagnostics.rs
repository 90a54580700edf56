//! Each code has its smallest failing model in `tests/diagnostics`, which gives only that finding; its drawing is
//! stored next to it and read by a reviewer.

use super::models::{Run, codes_in_sources};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The models, sorted by name.
fn models() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics");
    let entries =
        fs::read_dir(folder).expect("the folder of models").map(|entry| entry.expect("an entry of the folder").path());
    let mut models: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|e| e == "vib")).collect();
    models.sort();
    models
}

fn name(path: &Path) -> String {
    path.file_name().expect("a file").to_string_lossy().into_owned()
}

/// The code that the first line of a model announces.
fn promised(bytes: &[u8]) -> String {
    let line = bytes.split(|byte| *byte == b'\n').next().unwrap_or_default();
    String::from_utf8_lossy(line).trim_start_matches("//").trim().to_string()
}

/// Codes that no model produces: the check or the lowering refuses it earlier, and the analyses report them for systems
/// built by hand (shown by their own tests); those that only `vibc equations` reports (`equations`); that of answers
/// whose size the command line says (`hostile`); and those that follow a hundred others (`language`, `hostile`).
const OF_NO_MODEL: [&str; 7] = [
    "vib::equations::defect",
    "vib::equations::no_form",
    "vib::equations::too_large",
    "vib::limit::values",
    "vib::mass::indefinite",
    "vib::scene::more_findings",
    "vib::syntax::more_errors",
];

#[test]
fn every_code_has_a_model_that_reports_only_it() {
    let mut wrong = Vec::new();
    let mut shown = BTreeSet::new();
    for path in models() {
        let bytes = fs::read(&path).unwrap();
        let promised = promised(&bytes);
        let run = Run::new(&name(&path), &bytes);
        if run.codes() != [promised.as_str()] {
            wrong.push(format!("{}: {promised} was promised, found {:?}", name(&path), run.codes()));
        }
        shown.insert(promised);
    }
    let codes = codes_in_sources();
    let unshown = codes.difference(&shown).filter(|code| !OF_NO_MODEL.contains(&code.as_str()));
    wrong.extend(unshown.map(|code| format!("{code}: no model in tests/diagnostics shows it")));
    wrong.extend(shown.difference(&codes).map(|code| format!("{code}: shown by a model, but no such code exists")));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn excerpts_show_the_source_as_read() {
    for path in models() {
        let run = Run::new(&name(&path), &fs::read(&path).unwrap());
        insta::with_settings!({
            snapshot_path => "../diagnostics/snapshots",
            prepend_module_to_snapshot => false,
            omit_expression => true,
        }, {
            let drawn = run.drawn();
            let is_broken = |line: &&str| line.ends_with('/') && !line.contains('│');
            assert_eq!(drawn.lines().find(is_broken), None, "a unit is broken at its slash in {}", path.display());
            insta::assert_snapshot!(path.file_stem().unwrap().to_string_lossy().into_owned(), drawn);
        });
    }
}

#[test]
fn two_directions_stand_after_one_word() {
    for (moves, help) in [
        ("moves x, y", "write both directions after `moves`, without a comma: `moves x y`"),
        ("moves x, moves y", "keep one of them; both directions together are `moves x y`"),
        ("move y", "the word before directions of motion is `moves`: `moves y`"),
        ("move x y", "the word before directions of motion is `moves`: `moves x y`"),
        ("move along (1, 2)", "the word before directions of motion is `moves`: `moves along (a, b)`"),
        ("move up", "the word before directions of motion is `moves`: `moves x`"),
        ("turns, y", "known here: `mass`, `moves`, `at`, `shape`, `turns`, `inertia`, `free`"),
    ] {
        let model = format!("body b {{ mass = 2 kg, {moves} }}\nspring s: ground -- b {{ k = 9 N/m, along = x }}\n");
        assert_eq!(crate::program::finding(&model, &["check"])["help"], help, "{moves}");
    }
}
