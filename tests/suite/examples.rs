//! Every example analyses without a finding; its report is kept as a snapshot, to be read beside the answers that the
//! example's first lines promise.

use std::fs;
use std::path::{Path, PathBuf};
use vibc::backend::{ReportOptions, report};
use vibc::base::{SourceFile, Sources};
use vibc::model::Overrides;

/// The examples, sorted by name.
pub fn examples() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let entries = fs::read_dir(folder).expect("the examples").map(|entry| entry.expect("an example").path());
    let mut examples: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|e| e == "vib")).collect();
    examples.sort();
    examples
}

#[test]
fn every_example_analyses_to_its_report() {
    for path in examples() {
        let stem = path.file_stem().expect("a file").to_string_lossy().into_owned();
        let mut sources = Sources::new();
        let model = sources.add(SourceFile::model(format!("{stem}.vib"), fs::read_to_string(&path).unwrap()));
        let outcome = vibc::analyze(&sources, model, &Overrides::default());
        assert!(outcome.diagnostics.is_empty(), "{stem}: {:?}", outcome.diagnostics);
        let text = report::text(&outcome.answer.unwrap(), &ReportOptions::default());
        insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
            insta::assert_snapshot!(stem, text);
        });
    }
}

#[test]
fn every_example_says_what_to_expect() {
    for path in examples() {
        let text = fs::read_to_string(&path).unwrap();
        let head: Vec<&str> = text.lines().take_while(|line| line.starts_with("//")).collect();
        assert!(head.iter().any(|line| line.starts_with("/// Answer:")), "{} promises no answer", path.display());
    }
}
