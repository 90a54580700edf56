//! Syntax tree to the scene that was meant: names, units, freedoms. See spec.md#units and docs/method/kinematics.md.
//!
//! # Steps
//! 1. `overrides`, `collect`: values from outside; names and instances, `repeat` unrolled
//! 2. `evaluate`: every parameter gets its value
//! 3. `bodies`, `joints`, `freedoms`, `needs`: what moves, and how
//! 4. `elements`, `inputs`, `motions`, `couplings`, `measures`: what acts on it, and what is asked
//! 5. `needs` again: what is declared and never used

mod bodies;
mod collect;
mod couplings;
mod elements;
mod ends;
mod error;
mod evaluate;
mod expect;
mod fields;
mod freedoms;
mod inputs;
mod joints;
mod measures;
mod motions;
mod needs;
mod overrides;
pub mod scene;
mod scope;
mod settings;
mod signals;
mod suggestion;
mod tables;
#[cfg(test)]
mod tests;
mod unknown;
mod value;
pub mod written;

use crate::base::unit::Unit;
use crate::base::{Code, Diagnostic, Diagnostics, FileId, Literals, Quantity, Sources, Span, Symbol, Vec3, Words};
use crate::syntax::limits;
use crate::syntax::tree::Tree;
use bodies::Directions;
use collect::Instances;
pub use error::TABLE_UNREADABLE;
use error::{Error, NameError};
use evaluate::{Evaluated, Stop, Walk};
use expect::Memory;
use freedoms::Freedoms;
use overrides::Given;
use scene::{BaseId, BodyId, Parameter, Scene, TableRows};
use scope::{Definition, DefinitionId, Environment, Environments, Part, Space, State, Table};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;
pub use value::{Scalar, Value, Vector};
use written::Writer;
pub use written::Written;

/// What is said about a model from outside: values of its parameters, checked like the model itself, and how it is read.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides {
    /// `--set NAME=VALUE`, one a line.
    pub arguments: Option<FileId>,
    /// A TOML file of settings.
    pub settings: Option<FileId>,
    /// How all literals are read, those of the model too.
    pub literals: Literals,
}

/// A scene that has passed every check: lowering takes nothing else.
#[derive(Clone, Debug)]
pub struct CheckedScene {
    scene: Scene,
}

impl CheckedScene {
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// This scene without the damping that is declared for the whole of it. A scene without damping passes every check that
    /// one with damping passes.
    pub fn without_damping(&self) -> CheckedScene {
        CheckedScene { scene: Scene { damping: None, ..self.scene.clone() } }
    }
}

/// What the check makes of a tree: a scene, unless there are errors.
#[derive(Clone, Debug)]
pub struct Checked {
    pub scene: Option<CheckedScene>,
    pub diagnostics: Diagnostics,
}

/// The scene that a tree means.
pub fn check(sources: &Sources, tree: &Tree, overrides: &Overrides) -> Checked {
    check_with(sources, tree, overrides, &[])
}

/// A parameter by its name, `k` or `m[3]`, and a value like its declared one.
pub type Setting = (String, Quantity);

/// The same with some parameters at other values, whatever the model or the overrides say.
pub fn check_with(sources: &Sources, tree: &Tree, overrides: &Overrides, values: &[Setting]) -> Checked {
    checking(sources, tree, overrides, values).finish()
}

/// The same, and the expressions that the numbers of the scene were written as.
pub fn check_written(
    sources: &Sources,
    tree: &Tree,
    overrides: &Overrides,
    values: &[Setting],
) -> (Checked, Option<Written>) {
    let mut check = checking(sources, tree, overrides, values);
    let written = if check.diagnostics.has_errors() { None } else { Writer::new(&mut check).run() };
    (check.finish(), written)
}

fn checking<'a>(sources: &'a Sources, tree: &'a Tree, overrides: &Overrides, values: &[Setting]) -> Check<'a> {
    let mut check = Check::new(sources, tree, overrides.literals);
    check.overrides(overrides);
    check.set(values);
    check.collect();
    check.overridden_names();
    check.settle_definitions();
    check.bodies();
    check.bases();
    check.joints();
    check.freedoms();
    check.settings();
    check.needs();
    check.elements();
    check.inputs();
    check.outputs();
    check.couples();
    check.initials();
    check.solves();
    check.requires();
    check.unused();
    check
}

/// Every `param` that is a number, with the value in use, in order of declaration.
pub fn parameters(sources: &Sources, tree: &Tree, overrides: &Overrides, values: &[Setting]) -> Vec<Parameter> {
    let mut check = Check::new(sources, tree, overrides.literals);
    check.overrides(overrides);
    check.set(values);
    check.collect();
    check.settle_definitions();
    check.parameters()
}

/// A `param`, `let` or `point` in one repetition, with its value.
#[derive(Clone, Debug)]
pub struct Defined {
    pub name: String,
    /// Of the word that it declares.
    pub span: Span,
    /// `None` where something is wrong with it.
    pub value: Option<Value>,
}

/// The values of the parameters of a tree, whatever else is wrong with it, in order of declaration: for editors.
pub fn values(sources: &Sources, tree: &Tree, overrides: &Overrides, settings: &[Setting]) -> Vec<Defined> {
    let mut check = Check::new(sources, tree, overrides.literals);
    check.overrides(overrides);
    check.set(settings);
    check.collect();
    check.settle_definitions();
    let defined = check.definitions.iter().map(|definition| Defined {
        name: check.words.display(definition.name),
        span: definition.span,
        value: match &definition.state {
            State::Settled(value) => value.clone().ok(),
            State::Unsettled | State::InProgress => None,
        },
    });
    defined.collect()
}

/// A word that means something wherever a number stands: no parameter is called so.
pub fn is_reserved(word: &str) -> bool {
    word == "pi" || value::Function::named(word).is_some()
}

/// The functions of numbers.
pub fn functions() -> impl Iterator<Item = &'static str> {
    value::FUNCTIONS.iter().map(|function| function.name)
}

/// The check in progress.
struct Check<'a> {
    sources: &'a Sources,
    tree: &'a Tree,
    literals: Literals,
    words: Words,
    /// Symbols of words by their place.
    symbols: Table<u32, Symbol>,
    units: HashMap<&'a str, Unit>,
    diagnostics: Diagnostics,
    /// What has been said, so that the repetitions of a `repeat` say it once.
    said: HashSet<(Code, Span)>,
    /// How many errors, and how many other findings.
    told: [Told; 2],
    overrides: Given,
    /// Whether this is a value from outside, which knows no name of the model.
    outside: bool,
    /// Words of declarations that could not be read or unrolled: no message calls them unknown.
    broken_words: HashSet<&'a str>,
    /// Searches for a similar word that have been made.
    searches: u32,
    environments: Environments,
    definitions: Vec<Definition>,
    values: Space<DefinitionId>,
    parts: Space<Part>,
    instances: Instances<'a>,
    walk: Walk,
    memory: Memory,
    directions: Directions,
    freedoms: Freedoms,
    /// Where an inertia is given about a point of a body without a mass.
    inertia_points: HashMap<BodyId, Arc<Vec3>>,
    /// What could not be checked: what depends on it is not said.
    broken_bodies: HashSet<BodyId>,
    broken_bases: HashSet<BaseId>,
    broken_joints: bool,
    broken_elements: bool,
    broken_inputs: bool,
    /// Tables that have been read, each once; `None` where something is wrong with one.
    tables: HashMap<FileId, Option<Arc<TableRows>>>,
    scene: Scene,
}

impl<'a> Check<'a> {
    fn new(sources: &'a Sources, tree: &'a Tree, literals: Literals) -> Check<'a> {
        Check {
            sources,
            tree,
            literals,
            words: Words::new(),
            symbols: Table::default(),
            units: HashMap::new(),
            diagnostics: Diagnostics::new(),
            said: HashSet::new(),
            told: Default::default(),
            overrides: Given::default(),
            outside: false,
            broken_words: HashSet::new(),
            searches: 0,
            environments: Environments::default(),
            definitions: Vec::new(),
            values: Space::default(),
            parts: Space::default(),
            instances: Instances::default(),
            walk: Walk::default(),
            memory: Memory::default(),
            directions: Directions::default(),
            freedoms: Freedoms::default(),
            inertia_points: HashMap::new(),
            broken_bodies: HashSet::new(),
            broken_bases: HashSet::new(),
            broken_joints: false,
            broken_elements: false,
            broken_inputs: false,
            tables: HashMap::new(),
            scene: empty_scene(sources.file(tree.file).stem()),
        }
    }

    /// Says what is wrong, once for each place.
    fn report(&mut self, environment: Environment, error: impl Into<Error>) {
        let mut diagnostic = error.into().diagnostic();
        let place = diagnostic.primary.span;
        if !self.said.insert((diagnostic.code, place)) || !self.told[usize::from(!diagnostic.is_error())].counts(place)
        {
            return;
        }
        if self.walk.varies && !environment.is_top() {
            let text = &mut diagnostic.primary.text;
            let indices = self.environments.indices(environment);
            let indices = indices.iter().map(|(symbol, value)| format!("{} = {value}", self.words.text(*symbol)));
            let indices = indices.collect::<Vec<_>>().join(", ");
            *text = if text.is_empty() { indices } else { format!("{text}, {indices}") };
        }
        self.diagnostics.push(diagnostic);
    }

    /// Says what is wrong and stops here.
    fn fail<T>(&mut self, environment: Environment, error: impl Into<Error>) -> Evaluated<T> {
        self.report(environment, error);
        Err(Stop::Reported)
    }

    fn finish(mut self) -> Checked {
        let [errors, others] = self.told;
        self.diagnostics.extend(errors.more(|span, count| NameError::MoreErrors { span, count }.diagnostic()));
        self.diagnostics.extend(others.more(|span, count| NameError::MoreWarnings { span, count }.diagnostic()));
        self.scene.words = std::mem::take(&mut self.words);
        let scene = (!self.diagnostics.has_errors()).then_some(CheckedScene { scene: self.scene });
        Checked { scene, diagnostics: self.diagnostics }
    }
}

/// Findings of one kind: the first ones are reported, the others counted.
#[derive(Clone, Copy, Debug, Default)]
struct Told {
    count: usize,
    /// The last place in the texts that was found.
    last: Option<Span>,
}

impl Told {
    /// Counts one; whether it is reported.
    fn counts(&mut self, place: Span) -> bool {
        self.count += 1;
        let order = |span: Span| (span.file(), span.start());
        if self.last.is_none_or(|last| order(last) < order(place)) {
            self.last = Some(place);
        }
        self.count <= limits::ERRORS
    }

    /// What says how many were not told, behind all that were.
    fn more(self, tell: fn(Span, usize) -> Diagnostic) -> Option<Diagnostic> {
        let count = self.count.checked_sub(limits::ERRORS).filter(|count| *count > 0)?;
        self.last.map(|last| tell(last, count))
    }
}

fn empty_scene(name: String) -> Scene {
    Scene {
        name,
        words: Words::new(),
        gravity: Vec3::ZERO,
        gravity_span: None,
        bodies: Vec::new(),
        bases: Vec::new(),
        joints: Vec::new(),
        couples: Vec::new(),
        elements: Vec::new(),
        inputs: Vec::new(),
        outputs: Vec::new(),
        initial: Vec::new(),
        damping: None,
        rest_as_drawn: None,
        solves: Vec::new(),
        requires: Vec::new(),
    }
}
