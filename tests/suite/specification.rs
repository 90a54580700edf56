//! Every code that the program can report has one page in docs/diagnostics, in a fixed form, with an example that shows
//! it; every keyword has its entry in the manual.

use super::models::{Run, codes_in_sources};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use vibc::backend::explain::{PAGES, explain};
use vibc::base::{SourceFile, Sources};
use vibc::kinds::DECLARATIONS;
use vibc::syntax;

/// Codes that no check of a model's text can show (bytes, tables, `vibc simulate`, `vibc equations`, systems that no
/// model gives): their pages describe the example in words.
const IN_WORDS: [&str; 37] = [
    "vib::equations::defect",
    "vib::equations::no_form",
    "vib::equations::too_large",
    "vib::file::not_utf8",
    "vib::limit::signal",
    "vib::limit::loss",
    "vib::limit::states",
    "vib::limit::transfer",
    "vib::limit::values",
    "vib::mass::indefinite",
    "vib::mass::singular",
    "vib::motion::still",
    "vib::motion::unsettled",
    "vib::noise::emit",
    "vib::noise::left_out",
    "vib::noise::realisation",
    "vib::scene::more_findings",
    "vib::signal::base_impulse",
    "vib::spectrum::emit",
    "vib::spectrum::left_out",
    "vib::syntax::character",
    "vib::syntax::more_errors",
    "vib::signal::period",
    "vib::table::drift",
    "vib::table::first_column",
    "vib::table::heading",
    "vib::table::order",
    "vib::table::row",
    "vib::table::scale",
    "vib::table::too_short",
    "vib::table::unit",
    "vib::table::units_differ",
    "vib::table::unreadable",
    "vib::unbalance::emit",
    "vib::unbalance::speed",
    "vib::use::cycle",
    "vib::use::unreadable",
];

/// The code of each file of docs/diagnostics, by its folder and name.
fn codes_of_files() -> BTreeSet<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/diagnostics");
    let entries =
        |folder: &Path| fs::read_dir(folder).expect("a folder of pages").map(|entry| entry.expect("an entry").path());
    let name = |path: &Path| path.file_stem().expect("a name").to_string_lossy().into_owned();
    let families = entries(&root).filter(|path| path.is_dir());
    let pages = families.flat_map(|family| {
        entries(&family).map(|page| format!("vib::{}::{}", name(&family), name(&page))).collect::<Vec<_>>()
    });
    pages.collect()
}

#[test]
fn every_code_has_a_file_and_every_file_a_code() {
    let files = codes_of_files();
    assert_eq!(codes_in_sources(), files, "codes of the sources, and files of docs/diagnostics");
    let listed: Vec<&str> = PAGES.iter().map(|page| page.code).collect();
    assert!(listed.iter().eq(&files), "src/backend/explain/pages.rs lists the files in alphabetical order");
}

#[test]
fn every_page_has_the_one_form() {
    for page in PAGES {
        let (title, text) = page.markdown.split_once("\n\n").expect("a title, an empty line and a text");
        assert_eq!(title, format!("# {}", page.code));
        let meaning = text.split("```").next().unwrap_or_default().trim();
        assert!(meaning.len() > 20, "{} does not say what it means", page.code);
        assert!(text.lines().any(|line| line.starts_with("Fix:")), "{} does not say what to do", page.code);
    }
}

#[test]
fn the_example_of_a_page_gives_just_its_code() {
    let mut wrong = Vec::new();
    for page in PAGES {
        let code = page.code;
        match page.markdown.split("```vib\n").nth(1).and_then(|rest| rest.split("```").next()) {
            Some(example) => {
                let found = Run::new(code, example.as_bytes()).codes();
                if found != [code] {
                    wrong.push(format!("{code}: its example gives {found:?}"));
                }
            }
            None if IN_WORDS.contains(&code) => {
                assert!(page.markdown.contains("Example:"), "{code}: no example in words")
            }
            None => wrong.push(format!("{code} has no `vib` block")),
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn explain_prints_the_page() {
    let shown = explain("rest::unbalanced", std::iter::empty(), vibc::backend::explain::WIDTH).expect("a known code");
    assert!(shown.starts_with("vib::rest::unbalanced\n\n") && shown.contains("\n    rest as drawn\n"), "{shown}");
}

#[test]
fn the_forms_of_the_manual_parse() {
    for declaration in &DECLARATIONS {
        let mut sources = Sources::new();
        let forms = declaration.manual.forms;
        let file = sources.add(SourceFile::model(declaration.keyword, forms));
        assert_eq!(syntax::parse(&sources, file).errors.iter().count(), 0, "{forms}");
        let starts = |line: &str| line.starts_with(&format!("{} ", declaration.keyword));
        assert!(forms.lines().any(starts), "{forms}");
    }
}
