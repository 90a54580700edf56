//! Every example is analysed without findings; its report, its transfer table and its motion are kept as snapshots, to
//! be compared with the answers stated in the example's first lines.

use std::fs;
use std::path::{Path, PathBuf};
use vibc::analysis::{Frequency, Methods, Sweep, grid, table};
use vibc::answers;
use vibc::backend::{ReportOptions, report};
use vibc::base::{FileId, Number, Rational, SourceFile, Sources};
use vibc::model::Overrides;

/// The examples, sorted by name.
pub fn examples() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let entries = fs::read_dir(folder).expect("the examples").map(|entry| entry.expect("an example").path());
    let mut examples: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|e| e == "vib")).collect();
    examples.sort();
    examples
}

/// Adds the files that an example uses.
pub fn add_used_files(sources: &mut Sources, model: FileId) {
    vibc::add_used_files(sources, model, None, |name| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name);
        fs::read(path).map(|bytes| (name.to_string(), bytes)).map_err(|error| error.to_string())
    });
}

#[test]
fn every_example_analyses_to_its_report() {
    for path in examples() {
        let (stem, sources, model) = loaded(&path);
        let outcome = vibc::analyze(&sources, model, &Overrides::default());
        assert!(outcome.diagnostics.is_empty(), "{stem}: {:?}", outcome.diagnostics);
        let text = report::text(&outcome.answer.unwrap(), &ReportOptions::default());
        insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
            insta::assert_snapshot!(stem, text);
        });
    }
}

fn loaded(path: &Path) -> (String, Sources, FileId) {
    let stem = path.file_stem().expect("a file").to_string_lossy().into_owned();
    let mut sources = Sources::new();
    let model = sources.add(SourceFile::model(format!("{stem}.vib"), fs::read_to_string(path).expect("an example")));
    add_used_files(&mut sources, model);
    (stem, sources, model)
}

/// Transfer tables from every input to every output of the examples that have both.
#[test]
fn every_example_has_its_transfer_table() {
    for path in examples() {
        let (stem, sources, model) = loaded(&path);
        let outcome = vibc::dynamics(&sources, model, &Overrides::default());
        let dynamics = outcome.answer.unwrap_or_else(|| panic!("{stem}: {:?}", outcome.diagnostics));
        let system = &dynamics.system;
        if system.inputs.is_empty() || system.outputs.is_empty() {
            continue;
        }
        let modes = dynamics.modes.clone().unwrap_or_default();
        // A hundred peaks are too many for a snapshot.
        let few = (1..=5).map(|tenths| Frequency::hertz(&Number::from(Rational::new(tenths, 10)))).collect();
        let sweep = Sweep {
            at: if system.n() > 20 { few } else { Vec::new() },
            inputs: (0..system.inputs.len()).collect(),
            outputs: (0..system.outputs.len()).collect(),
            ..Sweep::default()
        };
        let poles = dynamics.poles_for(&sweep).expect("no error").unwrap_or_default();
        let table = table(&Methods::of(system, &modes), &poles, &sweep).expect("a small table");
        insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
            insta::assert_snapshot!(format!("transfer_{stem}"), without_noise(&report::all_laid_out(&answers::report::transfer(&dynamics.model, system, &table), report::WIDTH)));
        });
    }
}

/// Removes the residual values at undamped antiresonances, which only show how close the search came: just their
/// frequencies are kept.
fn without_noise(text: &str) -> String {
    let line = |line: &str| match line.trim_start().strip_prefix("antiresonance") {
        Some(rest) => format!("  antiresonance  {}", rest.split_whitespace().next().unwrap_or_default()),
        None => line.to_string(),
    };
    text.lines().map(|text| line(text) + "\n").collect()
}

/// Ten seconds of the motion of the examples with an output.
#[test]
fn every_example_moves_as_it_did() {
    for path in examples() {
        let (stem, sources, model) = loaded(&path);
        let times = grid(&Number::from(10), &Number::from(Rational::new(1, 20)));
        let outcome = vibc::simulate(&sources, model, &Overrides::default(), &times);
        if fs::read_to_string(&path).expect("an example").contains("loss = ") {
            let codes: Vec<String> = outcome.diagnostics.iter().map(|found| found.code.0.to_string()).collect();
            assert_eq!(codes, ["vib::limit::loss"], "{stem} has no motion in time");
            continue;
        }
        let motion = outcome.answer.unwrap_or_else(|| panic!("{stem}: {:?}", outcome.diagnostics));
        let text = report::laid_out(
            &answers::report::motion(&motion.model, &motion.system, &motion.history, &motion.steady),
            report::WIDTH,
        );
        insta::with_settings!({ prepend_module_to_snapshot => false, omit_expression => true }, {
            insta::assert_snapshot!(format!("motion_{stem}"), text);
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
