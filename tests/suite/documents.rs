//! The documents are consistent: every model that they show is valid, and every page that the sources or the documents
//! cite exists, with the cited heading.

use crate::models::SOURCES;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Write;
use std::path::{Component, Path, PathBuf};
use std::process::{Command, Stdio};
use vibc::backend::diagnostics::{HumanStyle, human};
use vibc::base::{SourceFile, SourceKind, Sources};
use vibc::kinds::DECLARATIONS;
use vibc::model::Overrides;

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

pub fn page(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The fenced blocks of a kind.
pub fn blocks(page: &str, kind: &str) -> Vec<String> {
    let fence = format!("```{kind}\n");
    page.split(&fence).skip(1).filter_map(|rest| rest.split("```").next()).map(String::from).collect()
}

/// The files that people write and read, below the root: sources, tests, tools and documents.
fn texts() -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![root().to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
            let name = entry.file_name().expect("a name").to_string_lossy().into_owned();
            let extension = entry.extension().unwrap_or_default().to_string_lossy().into_owned();
            if entry.is_dir() {
                let foreign = matches!(name.as_str(), "target" | "node_modules" | ".git" | "corpus" | "snapshots");
                folders.extend((!foreign).then_some(entry));
            } else if folder.ends_with("editors/vscode") && name == "CHANGELOG.md" {
                // A copy from which the package of the extension is made.
            } else if matches!(extension.as_str(), "rs" | "md" | "py" | "pest" | "c" | "js" | "vib" | "lua" | "toml") {
                files.push(entry);
            }
        }
    }
    files.sort();
    files
}

/// The anchor of a heading: lower-case letters and digits, with spaces replaced by hyphens and other characters
/// removed.
fn anchor(heading: &str) -> String {
    let letters = heading.trim().chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    letters.flat_map(char::to_lowercase).map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// The anchors of a page.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut anchors = BTreeSet::new();
    let mut fenced = false;
    for line in text.lines() {
        fenced ^= line.starts_with("```");
        let heading = line.trim_start_matches('#');
        if !fenced && heading.len() < line.len() && heading.starts_with(' ') {
            anchors.insert(anchor(heading));
        }
    }
    anchors
}

/// `docs/method/modes.md#certificate` in running text, from the root.
fn citations(text: &str) -> impl Iterator<Item = (&str, Option<&str>)> {
    let part_of_a_path = |c: char| c.is_ascii_alphanumeric() || matches!(c, '/' | '_' | '-' | '.' | '#');
    text.split(move |c| !part_of_a_path(c)).filter_map(|word| {
        let word = word.trim_end_matches('.');
        let (path, anchor) = word.split_once('#').map_or((word, None), |(path, anchor)| (path, Some(anchor)));
        let cited = path == "spec.md" || path.starts_with("docs/") && path.ends_with(".md");
        cited.then_some((path, anchor))
    })
}

/// The targets of Markdown links without a scheme.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets.filter(|target| !target.contains("://") && !target.contains(' '))
}

/// A path without `.` and `..`.
fn resolved(path: &Path) -> PathBuf {
    let mut resolved = PathBuf::new();
    for component in path.components() {
        match component {
            Component::ParentDir => drop(resolved.pop()),
            Component::CurDir => {}
            other => resolved.push(other),
        }
    }
    resolved
}

/// Pages read so far, and missing ones.
#[derive(Default)]
struct Library {
    anchors: BTreeMap<PathBuf, BTreeSet<String>>,
    missing: Vec<String>,
}

impl Library {
    fn look_up(&mut self, citing: &Path, path: PathBuf, anchor: Option<&str>) {
        if !path.exists() {
            return self.missing.push(format!("{}: {} does not exist", citing.display(), path.display()));
        }
        let Some(anchor) = anchor else { return };
        let read = || anchors(&fs::read_to_string(&path).unwrap_or_default());
        if !self.anchors.entry(path.clone()).or_insert_with(read).contains(anchor) {
            self.missing.push(format!("{}: {} has no heading `{anchor}`", citing.display(), path.display()));
        }
    }
}

#[test]
fn every_page_and_heading_that_is_cited_exists() {
    let mut library = Library::default();
    let mut cited = 0;
    for file in texts() {
        let text = String::from_utf8_lossy(&fs::read(&file).expect("a file")).into_owned();
        let document = file.extension().is_some_and(|extension| extension == "md");
        for (path, anchor) in citations(&text).filter(|_| !document) {
            cited += 1;
            library.look_up(&file, root().join(path), anchor);
        }
        for link in links(&text).filter(|_| document) {
            let (path, anchor) = link.split_once('#').map_or((link, None), |(path, anchor)| (path, Some(anchor)));
            let folder = file.parent().expect("a folder");
            let target = if path.is_empty() { file.clone() } else { resolved(&folder.join(path)) };
            library.look_up(&file, target, anchor);
        }
    }
    assert!(cited > 200, "{cited} citations found: does the scan still see them?");
    assert!(library.missing.is_empty(), "{}", library.missing.join("\n"));
}

/// Clauses once had numbers; a number is meaningless when the page changes.
#[test]
fn no_source_cites_a_clause_by_number() {
    let number = |rest: &str| {
        rest.trim_start_matches(',')
            .strip_prefix(' ')
            .is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit() || c == '"'))
    };
    for file in texts().iter().filter(|file| SOURCES.iter().any(|folder| file.starts_with(root().join(folder)))) {
        let text = fs::read_to_string(file).expect("UTF-8");
        let old = text.split("spec.md").skip(1).find(|rest| number(rest));
        assert!(old.is_none(), "{}: spec.md{:.12}", file.display(), old.unwrap_or_default());
    }
}

/// Documents whose models are complete: each `vib` block stands alone.
const WITH_MODELS: [&str; 1] = ["spec.md"];

#[test]
fn every_model_that_is_shown_is_a_model() {
    for path in WITH_MODELS {
        for block in blocks(&page(path), "vib") {
            let mut sources = Sources::new();
            let model = sources.add(SourceFile::model("shown.vib", block.as_str()));
            vibc::add_used_files(&mut sources, model, None, |path| Err(format!("there is no `{path}`")));
            for table in vibc::table_files(&sources, model) {
                let rows = b"time_s,force_N\n0,0\n1,2\n".to_vec();
                sources.add(SourceFile::decode(SourceKind::Table, table, rows));
            }
            let found = vibc::analyze(&sources, model, &Overrides::default()).diagnostics;
            assert!(found.is_empty(), "{path}:\n{block}\n{}", human(&sources, &found, HumanStyle::default()));
        }
    }
}

#[test]
fn every_model_that_is_shown_is_laid_out() {
    for path in WITH_MODELS {
        for block in blocks(&page(path), "vib") {
            let mut format = Command::new(env!("CARGO_BIN_EXE_vibc"));
            let mut format =
                format.args(["fmt", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("starts");
            format.stdin.take().expect("a pipe").write_all(block.as_bytes()).expect("is read");
            let layout = format.wait_with_output().expect("ends").stdout;
            assert_eq!(String::from_utf8(layout).expect("UTF-8"), block, "{path}");
        }
    }
}

#[test]
fn the_manual_leads_to_headings_of_the_language_page() {
    let anchors = anchors(&page("spec.md"));
    for entry in &DECLARATIONS {
        let heading = entry.manual.heading;
        assert!(anchors.contains(&anchor(heading)), "`{}`: spec.md has no heading `{heading}`", entry.keyword);
    }
}

/// The rows of docs/method/routes.md that name a constant: file, constant, value.
fn thresholds() -> Vec<[String; 3]> {
    let text = page("docs/method/routes.md");
    let rows = text.lines().filter_map(|line| line.strip_prefix("| `"));
    let rows = rows.filter(|row| SOURCES.iter().any(|folder| row.starts_with(&format!("{folder}/"))));
    rows.map(|row| {
        let cells: Vec<&str> = row.split('|').map(|cell| cell.trim().trim_matches('`')).collect();
        [cells[0].to_string(), cells[1].to_string(), cells[2].replace(',', "")]
    })
    .collect()
}

#[test]
fn the_thresholds_of_the_routes_are_those_of_the_sources() {
    let rows = thresholds();
    assert!(rows.len() > 20, "{} rows", rows.len());
    for [file, constant, value] in rows {
        let source = page(&file);
        let declared = source.split(&format!("const {constant}: ")).nth(1).and_then(|rest| rest.split(';').next());
        let declared = declared.and_then(|text| text.split("= ").nth(1)).map(|number| number.replace('_', ""));
        assert_eq!(declared.as_deref(), Some(value.as_str()), "{file}: {constant}");
    }
}
