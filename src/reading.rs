//! The start of every run: from the text of a model to its checked scene, with everything it solves for at the values
//! found. In: the texts. Out: a [`Reading`], which the rest of the run uses.

use crate::Study;
use crate::analysis::discrete::parameter::{MULTIPLES, Parameterised, fit};
use crate::analysis::{Modes, Poles};
use crate::base::{Code, Diagnostic, Diagnostics, FileId, Number, Quantity, SourceFile, SourceKind, Sources, Span};
use crate::dynamics::{self, WrittenOut};
use crate::library;
use crate::model::{self, Checked, CheckedScene, Overrides, Setting, Swept, Written};
use crate::questions::error::AskedError;
use crate::questions::{self, Facts, Optimised, Requirement, Settled, Solved, Text, trial};
use crate::syntax;
use crate::syntax::tree::Tree;
use crate::system::LinearSystem;
use std::collections::HashMap;
use std::path::Path;

/// A model that has been read.
pub(crate) struct Reading<'a> {
    sources: &'a Sources,
    overrides: &'a Overrides,
    /// Simulated time, s, if it is given or was looked for.
    until: Option<Number>,
    /// Whether it is not given, but the usual one of the model.
    is_usual: bool,
    /// Whether the worst case within the tolerances is optimised.
    robust: bool,
    pub tree: Tree,
    pub scene: CheckedScene,
    /// The values that `solve`, `minimise` and `maximise` give to parameters.
    pub settings: Vec<Setting>,
    pub solved: Vec<Solved>,
    pub optimised: Vec<Optimised>,
}

/// The tree of a text, and its scene unless there are errors. `None` if a file is not text.
pub(crate) fn read_and_check(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    diagnostics: &mut Diagnostics,
) -> Option<(Tree, Option<CheckedScene>)> {
    let check = |tree: &mut Tree, _| (model::check(sources, tree, overrides), ());
    check_with(sources, model, overrides, diagnostics, check).map(|(tree, scene, ())| (tree, scene))
}

/// Like [`read_and_check`], of a study: `check` may add to the tree, and returns the values of parameters as well.
pub(crate) fn read_and_check_swept(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    diagnostics: &mut Diagnostics,
    check: impl FnOnce(&mut Tree) -> (Checked, Vec<Swept>),
) -> Option<(Tree, Option<CheckedScene>, Vec<Swept>)> {
    check_with(sources, model, overrides, diagnostics, |tree, _| check(tree))
}

/// Like [`read_and_check`], with a check that returns something in addition; it is told whether the text has errors of syntax.
fn check_with<T>(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    diagnostics: &mut Diagnostics,
    check: impl FnOnce(&mut Tree, bool) -> (Checked, T),
) -> Option<(Tree, Option<CheckedScene>, T)> {
    let files = [Some(model), overrides.settings, overrides.arguments];
    diagnostics.extend(files.into_iter().flatten().filter_map(|file| not_utf8(sources, file)));
    if diagnostics.has_errors() {
        return None;
    }
    let mut parsed = syntax::parse(sources, model);
    let broken = parsed.errors.has_errors();
    diagnostics.extend(parsed.errors);
    // A broken declaration does not hide the errors of the others.
    let (checked, more) = check(&mut parsed.tree, broken);
    diagnostics.extend(checked.diagnostics);
    Some((parsed.tree, checked.scene.filter(|_| !broken), more))
}

/// The scene and the expressions of its numbers, with every unknown of its `solve` lines at its value.
pub(crate) fn read_written(
    sources: &Sources,
    model: FileId,
    overrides: &Overrides,
    diagnostics: &mut Diagnostics,
) -> Option<(CheckedScene, Written)> {
    // A declaration that is not read is in the tree, but not in the scene.
    let check = |tree: &mut Tree, broken| match broken {
        true => (model::check(sources, tree, overrides), None),
        false => model::check_written(sources, tree, overrides, &[]),
    };
    let (tree, scene, written) = check_with(sources, model, overrides, diagnostics, check)?;
    let scene = scene?;
    if !scene.scene().determines_parameters() {
        return Some((scene, written?));
    }
    let mut reading = Reading::read_declared(sources, overrides, tree, scene);
    reading.settle(diagnostics)?;
    let (checked, written) = model::check_written(sources, &reading.tree, overrides, &reading.settings);
    Some((checked.scene?, written?))
}

/// The scene with every `solve` line evaluated.
pub(crate) fn read_and_solve<'a>(
    sources: &'a Sources,
    model: FileId,
    overrides: &'a Overrides,
    until: Option<&'a Number>,
    diagnostics: &mut Diagnostics,
) -> Option<Reading<'a>> {
    read_for(sources, model, overrides, &Study { until, ..Study::default() }, diagnostics)
}

/// Like [`read_and_solve`], with the simulated time of a study, and what it optimises.
pub(crate) fn read_for<'a>(
    sources: &'a Sources,
    model: FileId,
    overrides: &'a Overrides,
    study: &Study,
    diagnostics: &mut Diagnostics,
) -> Option<Reading<'a>> {
    let (tree, scene) = read_and_check(sources, model, overrides, diagnostics)?;
    let declared = Reading::read_declared(sources, overrides, tree, scene?);
    let mut reading = Reading { until: study.until.cloned(), robust: study.robust, ..declared };
    reading.settle(diagnostics)?;
    Some(reading)
}

impl<'a> Reading<'a> {
    /// A scene as it is declared.
    pub fn read_declared(
        sources: &'a Sources,
        overrides: &'a Overrides,
        tree: Tree,
        scene: CheckedScene,
    ) -> Reading<'a> {
        Reading {
            sources,
            overrides,
            until: None,
            is_usual: false,
            robust: false,
            tree,
            scene,
            settings: Vec::new(),
            solved: Vec::new(),
            optimised: Vec::new(),
        }
    }

    /// Finds what the model solves for. `None` after an error.
    pub fn settle(&mut self, diagnostics: &mut Diagnostics) -> Option<()> {
        if !self.scene.scene().determines_parameters() {
            return Some(());
        }
        if self.until.is_none() && trial::asks_of_motion(&self.scene) {
            // The system of the scene as declared. It stays the same in all trials, so that measures do not jump with
            // it.
            let system = dynamics::lower_written_out(&self.scene, &mut Diagnostics::new());
            let spectrum = system.as_ref().and_then(trial::spectrum);
            self.until = spectrum.and_then(|(_, poles)| trial::usual_time(&self.scene, &poles));
            self.is_usual = true;
        }
        match questions::settle(&self.text(), &self.scene, self.robust) {
            Ok(Settled { scene, settings, solved, optimised, unsettled }) => {
                diagnostics.extend(unsettled.iter().map(AskedError::to_diagnostic));
                (self.scene, self.settings, self.solved, self.optimised) = (scene, settings, solved, optimised);
                Some(())
            }
            Err(errors) => {
                diagnostics.extend(errors.iter().map(AskedError::to_diagnostic));
                None
            }
        }
    }

    /// Drops the tree, which takes some two times the text of a large file: nothing is asked of the text any more.
    pub fn forget_tree(&mut self) {
        self.tree = Tree::new(self.tree.file);
    }

    /// The model's name.
    pub fn name(&self) -> String {
        self.scene.scene().name.clone()
    }

    /// The text that questions are evaluated on.
    pub fn text(&self) -> Text<'_> {
        let Reading { sources, overrides, until, is_usual, tree, .. } = self;
        Text { sources, tree, overrides, until: until.as_ref(), is_usual: *is_usual, case: &[], fixed: &[] }
    }

    /// Whether the requirements hold. The system, modes and poles are not computed again if they are known.
    pub fn requirements(
        &mut self,
        system: Option<&WrittenOut>,
        spectrum: Option<(&Modes, &Poles)>,
        diagnostics: &mut Diagnostics,
    ) -> Vec<Requirement> {
        if self.scene.scene().requires.is_empty() {
            return Vec::new();
        }
        let mut spectrum = spectrum.filter(|(modes, poles)| modes.is_complete() && poles.left_out == 0);
        let found;
        if self.until.is_none() && trial::asks_of_motion(&self.scene) {
            if spectrum.is_none() {
                found = system.and_then(trial::spectrum);
                spectrum = found.as_ref().map(|(modes, poles)| (modes, poles));
            }
            self.until = spectrum.and_then(|(_, poles)| trial::usual_time(&self.scene, poles));
            self.is_usual = true;
        }
        let known = Facts { system, spectrum };
        let (list, errors) = questions::requirements(&self.text(), &self.scene, &self.settings, known);
        diagnostics.extend(errors.iter().map(AskedError::to_diagnostic));
        if let (Some(written), Some(until)) = (system, &self.until)
            && trial::asks_of_motion(&self.scene)
            && let Some(drives) = dynamics::drives(&self.scene, diagnostics)
        {
            diagnostics.extend(dynamics::beyond_tangents(&self.scene, &written.lowered, &drives, until));
        }
        list
    }

    /// The linear system as a function of a parameter.
    pub fn over_parameter(&self, name: &str) -> Result<Parameterised, String> {
        if self.scene.scene().determines_parameters() {
            return Err("the model determines parameters, which would change with it".into());
        }
        let all = self.text().parameters(&[]);
        let Some(parameter) = all.iter().find(|parameter| parameter.name == name) else {
            let names: Vec<&str> = all.iter().map(|parameter| parameter.name.as_str()).collect();
            return Err(format!("it is not a parameter of the model; the parameters are {}", names.join(", ")));
        };
        let si = &parameter.value.si;
        if si.may_be_zero() {
            return Err("its value is zero, so there is no range to vary it in".into());
        }
        let system = |(a, b): &(i64, i64)| {
            let value = &(si * &Number::from(*a)) / &Number::from(*b);
            let setting = (name.to_string(), Quantity { si: value, ..parameter.value.clone() });
            let checked = model::check_with(self.sources, &self.tree, self.overrides, &[setting]);
            let found = checked.scene.and_then(|scene| dynamics::about_rest(&scene, &mut Diagnostics::new()));
            Ok(found.ok_or("the model has errors, or no rest that is proven, at other values of it")?.into_parts().0)
        };
        let systems: Result<Vec<LinearSystem>, String> = MULTIPLES.iter().map(system).collect();
        fit(name, si, &systems?)
    }
}

/// Adds the files of components that a model uses, and the files that these use in turn, to the sources, each once. The
/// caller's `read` reads them by path; `Err` says why one cannot be read. The key returned by `read` identifies a file;
/// the model's own is `key`. The components of `std/...` are part of the program. A model that uses no files is not
/// even parsed.
pub fn add_used_files(
    sources: &mut Sources,
    model: FileId,
    key: Option<String>,
    mut read: impl FnMut(&str) -> Result<(String, Vec<u8>), String>,
) {
    let mut known: HashMap<String, FileId> = key.into_iter().map(|key| (key, model)).collect();
    let mut waiting = vec![model];
    while let Some(file) = waiting.pop() {
        for written in syntax::used_files(sources.text(file)) {
            let name = match written.strip_prefix(library::PREFIX) {
                Some(_) => written.clone(),
                None => sources.file(file).relative_name(&written),
            };
            let (key, content) = match written.strip_prefix(library::PREFIX) {
                Some(of_program) => (written.clone(), of_library(of_program)),
                None => match used_content(&name, &mut read) {
                    Ok((key, text)) => (key, Ok(text)),
                    Err(reason) => (format!("unread {name}"), Err(reason)),
                },
            };
            if let Some(&to) = known.get(&key) {
                sources.link(file, written, to);
                continue;
            }
            if known.len() > MOST_USED {
                // The excess is reported at its own line, and nothing more is added.
                continue;
            }
            let to = sources.add(match content {
                Ok(text) => SourceFile::model(name, text),
                Err(reason) => SourceFile::unread(SourceKind::Model, name, reason),
            });
            known.insert(key, to);
            sources.link(file, written, to);
            waiting.push(to);
        }
    }
}

fn of_library(name: &str) -> Result<String, String> {
    library::text(name).map(str::to_string).ok_or_else(|| {
        let names: Vec<String> = library::names().map(|name| format!("`{name}`")).collect();
        format!("the program comes with {}", names.join(", "))
    })
}

/// The text of a file of components, and the key that identifies it. Only the contents of `.vib` files appear in
/// messages: another file may be a secret.
fn used_content(
    name: &str,
    read: &mut impl FnMut(&str) -> Result<(String, Vec<u8>), String>,
) -> Result<(String, String), String> {
    let is_model = |name: &str| Path::new(name).extension().is_some_and(|extension| extension == "vib");
    if !is_model(name) {
        return Err("its name does not end with `.vib`".into());
    }
    let (key, bytes) = read(name)?;
    // A link may lead to anything.
    if !is_model(&key) {
        return Err("it is a link to a file whose name does not end with `.vib`".into());
    }
    match String::from_utf8(bytes) {
        Ok(text) => Ok((key, text)),
        Err(_) => Err("it is not UTF-8 text".into()),
    }
}

/// Different files that a model uses; a run has room for 256 files.
const MOST_USED: usize = 32;

/// The files of tables that a model names, each once, as written. The caller adds them to the sources (see
/// [`crate::base::SourceFile::relative_name`]) before any other step. A model that names no table is not even parsed.
pub fn table_files(sources: &Sources, model: FileId) -> Vec<String> {
    let mut files: Vec<String> = Vec::new();
    if !sources.text(model).contains("table") {
        return files;
    }
    let tree = syntax::parse(sources, model).tree;
    for span in tree.texts().filter(|span| span.file() == model) {
        let file = sources.slice(span).trim_matches('"');
        if files.len() < MOST_TABLES && files.iter().all(|known| known != file) {
            files.push(file.to_string());
        }
    }
    files
}

/// Limit on the different tables of one model; a run has room for 256 files.
const MOST_TABLES: usize = 200;

/// A byte that is not part of any character: most likely the file is not text at all.
const NOT_UTF8: Code = Code::model("vib::file::not_utf8");

pub(crate) fn not_utf8(sources: &Sources, file: FileId) -> Option<Diagnostic> {
    let (offset, byte) = sources.file(file).first_bad_byte?;
    // The replacement character for the byte is three bytes long.
    let span = Span::new(file, offset, offset + 3);
    let diagnostic = Diagnostic::error(NOT_UTF8, span, "this file is not UTF-8 text")
        .label(format!("byte 0x{byte:02x} is not part of a UTF-8 character"))
        .help("save the file as UTF-8 (plain ASCII is UTF-8 too); a `.vib` file of another program cannot be read");
    Some(diagnostic)
}

#[cfg(test)]
mod tests {
    use crate::base::{SourceFile, runs};
    use crate::inspection::Effort;
    use crate::{FileId, Overrides, Request, Sources, Study};

    /// Damping ratios need modes and poles, peaks a time to follow the motion for.
    const MODEL: &str = "model cart\n\
        body cart { mass = 2 kg, moves x }\n\
        spring s: ground -- cart { k = 200 N/m }\n\
        damper d: ground -- cart { c = 4 N*s/m }\n\
        force push: cart along x = step(1 N, 0 s)\n\
        output place = cart.x\n\
        require peak(place) <= 1 m\n\
        require rms(place) <= 1 m\n\
        require damping(1) >= 1 %\n";

    /// The stages that begin while a function runs on a model.
    fn stages(model: &str, ask: impl FnOnce(&Sources, FileId)) -> Vec<&'static str> {
        let mut sources = Sources::new();
        let file = sources.add(SourceFile::model("cart.vib", model));
        runs::stages_of(|| ask(&sources, file))
    }

    #[test]
    fn no_stage_runs_twice_for_one_answer() {
        let (nothing, request, study) = (Overrides::default(), Request::default(), Study::default());
        let once = ["parse", "check", "lower", "modes", "poles"];
        let analyze = stages(MODEL, |sources, file| {
            let outcome = crate::analyze_with(sources, file, &nothing, &request, &study);
            assert_eq!(outcome.answer.expect("an answer").requirements.len(), 3, "{:?}", outcome.diagnostics);
        });
        assert_eq!(analyze, once);
        let explain = stages(MODEL, |sources, file| {
            assert!(crate::analyze_and_explain(sources, file, &nothing, &request, &study).0.answer.is_some());
        });
        assert_eq!(explain, once);
        let check = stages(MODEL, |sources, file| {
            assert_eq!(crate::check(sources, file, &nothing, None).answer.expect("an answer").len(), 3);
        });
        assert_eq!(check, once);
        for effort in [Effort::Whole, Effort::UpTo(100)] {
            let editor = stages(MODEL, |sources, file| {
                assert_eq!(crate::inspection::inspect(sources, file, &nothing, effort).requirements.len(), 3);
            });
            assert_eq!(editor, once, "{effort:?}");
        }
    }

    /// With a given time, `check` computes no modes unless a requirement needs them.
    #[test]
    fn unneeded_stages_do_not_run() {
        let peak_only: String =
            MODEL.lines().filter(|line| !line.contains("damping(")).map(|line| format!("{line}\n")).collect();
        let nothing = Overrides::default();
        let until = crate::Number::from(2);
        let check = stages(&peak_only, |sources, file| {
            assert_eq!(crate::check(sources, file, &nothing, Some(&until)).answer.expect("an answer").len(), 2);
        });
        assert_eq!(check, ["parse", "check", "lower"]);
    }
}
