//! A text with everything that the stages know about it, from which every request of an editor is answered.

use super::lexed::Lexed;
use crate::analysis::{self, AnalysisError, Modal, Modes, Request, Which};
use crate::base::{Diagnostic, FileId, Sources};
use crate::inspection::{self, Effort, Inspection};
use crate::lower::{Lowered, Mechanism, Rest};
use crate::model::{self, CheckedScene, Defined, Overrides};
use crate::questions::{Optimised, Requirement, Solved};
use crate::syntax::{self, tree::Tree};
use crate::system::LinearSystem;
use std::ops::Deref;
use std::sync::Arc;

/// A text, its tokens, and the results of the pipeline.
#[derive(Clone, Debug)]
pub struct Document {
    pub sources: Sources,
    pub file: FileId,
    /// The text and its tokens. A document dereferences to them, for callers that need no stage.
    lexed: Lexed,
    pub tree: Tree,
    pub findings: Vec<Diagnostic>,
    /// The values of parameters, points and derived quantities, available even if the rest has errors.
    pub values: Vec<Defined>,
    /// The results of `solve` lines and of requirements.
    pub solved: Vec<Solved>,
    pub optimised: Vec<Optimised>,
    pub requirements: Vec<Requirement>,
    /// Results of the last version of the text that had a scene; their places refer to that version.
    pub known: Option<Arc<Results>>,
    /// Whether `known` belongs to this text.
    pub is_current: bool,
    /// Whether every stage has run, so that nothing more can be found.
    pub is_whole: bool,
}

/// Results for a text without errors.
#[derive(Clone, Debug)]
pub struct Results {
    /// The texts that it is of.
    pub sources: Sources,
    pub scene: CheckedScene,
    pub motions: Option<Motions>,
}

/// The linear system of a scene, and its modes.
#[derive(Clone, Debug)]
pub struct Motions {
    pub system: LinearSystem,
    pub rest: Rest,
    pub mechanism: Mechanism,
    /// The lowest modes.
    pub modes: Modes,
    /// Modes with their damping; `None` without dampers, or if it has not been computed yet.
    pub modal: Option<Modal>,
}

/// Number of modes that are computed: more than anybody reads in a line.
const MODES: usize = 12;

/// Up to this many coordinates, every stage runs between two keystrokes.
const FEW: usize = 20;
/// Up to this many coordinates, the lowest modes are computed between two keystrokes.
const MANY: usize = 2000;

/// The request to the analyses.
pub fn request() -> Request {
    Request { which: Which::Lowest(MODES), ..Request::default() }
}

impl Document {
    /// A model with its texts, analysed as far as time between two keystrokes allows. Results of the previous version
    /// are kept while this one has errors.
    pub fn new(sources: Sources, file: FileId, before: Option<&Document>) -> Document {
        let inspection = inspection::inspect(&sources, file, &Overrides::default(), Effort::UpTo(FEW));
        if inspection.is_whole {
            return Document::of_whole(sources, file, inspection, before);
        }
        let n = inspection.lowered.as_ref().map_or(0, |lowered| lowered.system.n());
        let mut document = Document::of(sources, file, inspection, before, |system| match system.n() <= MANY {
            true => Ok(Some((analysis::modes_as(system, &request())?, None))),
            false => Ok(None),
        });
        document.is_whole = n <= MANY && !document.asks_more();
        document
    }

    /// A model analysed through every stage, however long it takes.
    pub fn whole(sources: Sources, file: FileId, before: Option<&Document>) -> Document {
        let inspection = inspection::inspect(&sources, file, &Overrides::default(), Effort::Whole);
        Document::of_whole(sources, file, inspection, before)
    }

    fn of_whole(sources: Sources, file: FileId, inspection: Inspection, before: Option<&Document>) -> Document {
        Document::of(sources, file, inspection, before, |system| {
            if system.c.is_empty() {
                return Ok(Some((analysis::modes_as(system, &request())?, None)));
            }
            let modal = analysis::modal(system, &request())?;
            Ok(Some((modal.modes.clone(), Some(modal))))
        })
    }

    /// Whether the scene has dampers, or lines whose answer takes many evaluations.
    fn asks_more(&self) -> bool {
        let Some(known) = self.known.as_ref().filter(|_| self.is_current) else { return false };
        let scene = known.scene.scene();
        let is_damped = known.motions.as_ref().is_some_and(|motions| !motions.system.c.is_empty());
        is_damped || scene.damping.is_some() || scene.determines_parameters() || !scene.requires.is_empty()
    }

    fn of(
        sources: Sources,
        file: FileId,
        mut inspection: Inspection,
        before: Option<&Document>,
        analyse: impl FnOnce(&LinearSystem) -> Result<Option<(Modes, Option<Modal>)>, AnalysisError>,
    ) -> Document {
        let overrides = Overrides::default();
        let tree = inspection.tree.take().unwrap_or_else(|| syntax::parse(&sources, file).tree);
        let values = model::values(&sources, &tree, &overrides, &inspection.settings);
        let lexed = Lexed::new(sources.text(file));
        let motions =
            inspection.lowered.take().and_then(|Lowered { system, rest, mechanism }| match analyse(&system) {
                Ok(found) => found.map(|(modes, modal)| {
                    // Hints have no room to say that a number has no bound because the rest is unproven.
                    let (modes, modal) = if rest.is_proven() { (modes, modal) } else { (Modes::default(), None) };
                    Motions { system, rest, mechanism, modes, modal }
                }),
                Err(error) => {
                    inspection.diagnostics.push(error.to_diagnostic());
                    None
                }
            });
        let now = inspection.scene.map(|scene| Arc::new(Results { sources: sources.clone(), scene, motions }));
        let is_current = now.is_some();
        let mut findings = inspection.diagnostics.into_sorted();
        if holds_components_alone(&lexed) {
            // It is used by models, and is not a model itself.
            findings.retain(|finding| finding.code.0 != "vib::scene::empty");
        }
        let known = now.or_else(|| before.and_then(|document| document.known.clone()));
        Document {
            file,
            lexed,
            tree,
            findings,
            solved: inspection.solved,
            optimised: inspection.optimised,
            requirements: inspection.requirements,
            values,
            known,
            is_current,
            is_whole: true,
            sources,
        }
    }
}

/// Whether a text declares only components and the files that it uses.
fn holds_components_alone(lexed: &Lexed) -> bool {
    let statements = &lexed.outline.statements;
    let mut outer =
        (0..statements.len()).filter(|index| statements[*index].inside.is_none()).map(|index| lexed.keyword(index));
    !statements.is_empty() && outer.all(|keyword| matches!(keyword, "component" | "use"))
}

impl Deref for Document {
    type Target = Lexed;

    fn deref(&self) -> &Lexed {
        &self.lexed
    }
}
