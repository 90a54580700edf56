//! Runs models through the library, for the tests of findings.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use vibc::analysis::{Methods, Poles, Sweep, table};
use vibc::backend::diagnostics::{HumanStyle, human};
use vibc::base::{Diagnostic, FileId, Number, SourceFile, SourceKind, Sources};
use vibc::model::Overrides;
use vibc::{DiscreteOptions, Frequency, Hold, Precision};

/// A model that was analysed, and its findings.
///
/// Lines in the model's leading comments control the run: `// --set k=3` and `// settings: k = "3 N/m"` give overrides,
/// `// simulate` asks for its motion over a minute instead of its modal report, `// simulate seeded` with a realisation of noise, `// transfer` for a value of each transfer function at 1 Hz, and `// emit` for its code, `// emit held` for code that takes the inputs from sample to sample. Tables are next to the models.
pub struct Run {
    sources: Sources,
    pub diagnostics: Vec<Diagnostic>,
}

impl Run {
    pub fn new(name: &str, bytes: &[u8]) -> Run {
        let mut sources = Sources::new();
        let model = sources.add(SourceFile::decode(SourceKind::Model, name, bytes.to_vec()));
        let lines = |prefix: &str| -> String {
            let leading = sources.text(model).lines().take_while(|line| line.starts_with("//"));
            leading.filter_map(|line| line.strip_prefix(prefix)).map(|line| format!("{line}\n")).collect()
        };
        let (settings, arguments) = (lines("// settings: "), lines("// --set "));
        let mut add = |kind, name: &str, text: String| {
            (!text.is_empty()).then(|| sources.add(SourceFile::decode(kind, name, text.into_bytes())))
        };
        let overrides = Overrides {
            settings: add(SourceKind::Settings, "settings.toml", settings),
            arguments: add(SourceKind::Arguments, "--set", arguments),
            ..Overrides::default()
        };
        vibc::add_used_files(&mut sources, model, Some(name.to_string()), |file| {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics").join(file);
            // What a platform says of a missing file differs.
            fs::read(path).map(|bytes| (file.to_string(), bytes)).map_err(|_| "no such file".to_string())
        });
        for table in vibc::table_files(&sources, model) {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics").join(&table);
            let file = match fs::read(path) {
                Ok(bytes) => SourceFile::decode(SourceKind::Table, table, bytes),
                // The platform's message for a missing file varies.
                Err(_) => SourceFile::unread(SourceKind::Table, table, "no such file"),
            };
            sources.add(file);
        }
        let asks =
            |word: &str| sources.text(model).lines().take_while(|line| line.starts_with("//")).any(|line| line == word);
        let diagnostics = if asks("// emit") || asks("// emit held") {
            let options = DiscreteOptions {
                step: Number::from("0.001"),
                hold: Hold::Zero,
                precision: Precision::Double,
                tolerance: None,
                unpruned: false,
                built_in: asks("// emit"),
                internal: Vec::new(),
                until: None,
            };
            vibc::discrete(&sources, model, &overrides, &options).diagnostics
        } else if asks("// simulate") || asks("// simulate seeded") {
            let times = [Number::ZERO, Number::from(60)];
            let seed = asks("// simulate seeded").then_some(7);
            vibc::simulate_with_noise(&sources, model, &overrides, &times, seed).diagnostics
        } else if asks("// transfer") {
            transfer_findings(&sources, model, &overrides)
        } else {
            vibc::analyze(&sources, model, &overrides).diagnostics
        };
        Run { sources, diagnostics }
    }

    pub fn codes(&self) -> Vec<&'static str> {
        self.diagnostics.iter().map(|diagnostic| diagnostic.code.0).collect()
    }

    /// The findings drawn for people, without colour.
    pub fn drawn(&self) -> String {
        human(&self.sources, &self.diagnostics, HumanStyle::default())
    }
}

/// The findings about a model and the values of its transfer functions at 1 Hz.
fn transfer_findings(sources: &Sources, model: FileId, overrides: &Overrides) -> Vec<Diagnostic> {
    let outcome = vibc::dynamics(sources, model, overrides);
    let Some(dynamics) = &outcome.answer else { return outcome.diagnostics };
    let (inputs, outputs) = (dynamics.system.inputs.len(), dynamics.system.outputs.len());
    let at = vec![Frequency::hertz(&Number::ONE)];
    let sweep = Sweep { at, inputs: (0..inputs).collect(), outputs: (0..outputs).collect(), ..Sweep::default() };
    let methods = Methods::of(&dynamics.system, dynamics.modes.as_ref().expect("few coordinates"));
    let table = table(&methods, &Poles::default(), &sweep).expect("one row");
    [outcome.diagnostics, dynamics.findings(&table, &sweep)].concat()
}

/// The sources of the program's two crates, below the root.
pub const SOURCES: [&str; 2] = ["src", "linear/src"];

/// Every `"vib::..."` in the sources.
pub fn codes_in_sources() -> BTreeSet<String> {
    let mut codes = BTreeSet::new();
    for folder in SOURCES {
        collect(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut codes);
    }
    codes
}

fn collect(folder: &Path, codes: &mut BTreeSet<String>) {
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry of the folder").path();
        if path.is_dir() {
            collect(&path, codes);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path).expect("a source");
            let shipped = text.split("\n#[cfg(test)]\nmod tests {").next().unwrap_or_default();
            codes.extend(shipped.split('"').filter(|literal| is_code(literal)).map(String::from));
        }
    }
}

/// `vib::unit::mismatch`: three words, the first `vib`.
fn is_code(literal: &str) -> bool {
    let words: Vec<&str> = literal.split("::").collect();
    let plain = |word: &&str| {
        !word.is_empty() && word.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
    };
    words.len() == 3 && words[0] == "vib" && words.iter().all(plain)
}
