//! From a syntax tree to the scene it describes: names, units, freedoms. See spec.md#units and docs/method/kinematics.md.
//!
//! # Steps
//! 1. `overrides`, `collect`, `places`, `arguments`: values from outside; names and instances, `repeat` unrolled, components placed
//! 2. `evaluate`: every parameter gets its value
//! 3. `bodies`, `joints`, `freedoms`, `needs`: what moves, and how
//! 4. `elements`, `inputs`, `motions`, `couplings`, `measures`: what acts on the bodies, and the questions
//! 5. `needs` again: declarations that are never used

mod arguments;
mod belts;
mod bodies;
mod collect;
mod corner_points;
mod couplings;
mod delays;
mod drafts;
mod elements;
mod ends;
mod error;
mod evaluate;
mod expect;
mod fields;
mod freedoms;
mod inputs;
mod joints;
mod laws;
mod measures;
mod motions;
mod needs;
mod noise;
mod overrides;
mod places;
mod reactions;
mod requirements;
pub mod scene;
mod scope;
mod settings;
mod shared;
mod signals;
mod spectrum;
mod suggestion;
mod swept;
mod tables;
#[cfg(test)]
mod tests;
mod tolerances;
mod unknown;
mod value;
pub mod written;

use crate::base::unit::Unit;
use crate::base::{
    Code, Diagnostic, Diagnostics, FileId, Literals, Quantity, Sources, Span, Symbol, Vec3, Words, runs,
};
use crate::syntax::limits;
use crate::syntax::tree::Tree;
use bodies::Directions;
use collect::{Count, Instances};
pub use error::TABLE_UNREADABLE;
use error::{Error, NameError};
use evaluate::{Evaluated, Stop, Walk};
use expect::Cache;
use freedoms::Freedoms;
use overrides::Given;
pub use places::MAX_LEVELS;
use places::{ComponentNames, Frame, Port};
use scene::{BaseId, BodyId, Law, Matter, Parameter, Scene, TableRows};
use scope::{Definition, DefinitionId, Environment, Environments, Part, Space, State, Table};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;
pub use swept::{Points, Swept, in_integers, shape_of_values};
pub use value::{Scalar, Value, Vector};
use written::Writer;
pub use written::Written;

/// Settings from outside a model: values of its parameters, checked like the model itself, and how literals are read.
#[derive(Clone, Copy, Debug, Default)]
pub struct Overrides {
    /// `--set NAME=VALUE`, one per line.
    pub arguments: Option<FileId>,
    /// A TOML file of settings.
    pub settings: Option<FileId>,
    /// The reading of all literals, including those of the model.
    pub literals: Literals,
}

/// A scene that has passed every check. Lowering accepts nothing else.
#[derive(Clone, Debug)]
pub struct CheckedScene {
    scene: Scene,
}

impl CheckedScene {
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The scene without the damping declared for the whole of it. A scene without damping passes every check that one
    /// with damping passes.
    pub fn without_damping(&self) -> CheckedScene {
        CheckedScene { scene: Scene { damping: None, ..self.scene.clone() } }
    }
}

/// The result of checking a tree: a scene, unless there are errors.
#[derive(Clone, Debug)]
pub struct Checked {
    pub scene: Option<CheckedScene>,
    pub diagnostics: Diagnostics,
}

/// Checks a tree and builds its scene.
pub fn check(sources: &Sources, tree: &Tree, overrides: &Overrides) -> Checked {
    check_with(sources, tree, overrides, &[])
}

/// A parameter by its name, `k` or `m[3]`, and a value like its declared one.
pub type Setting = (String, Quantity);

/// Like [`check`], with some parameters at other values that override the model and the overrides.
pub fn check_with(sources: &Sources, tree: &Tree, overrides: &Overrides, values: &[Setting]) -> Checked {
    new_check(sources, tree, overrides, values).finish()
}

/// Like [`check_with`], and returns the expressions behind the numbers of the scene as well.
pub fn check_written(
    sources: &Sources,
    tree: &Tree,
    overrides: &Overrides,
    values: &[Setting],
) -> (Checked, Option<Written>) {
    let mut check = new_check(sources, tree, overrides, values);
    let written = if check.diagnostics.has_errors() { None } else { Writer::new(&mut check).run() };
    (check.finish(), written)
}

fn new_check<'a>(sources: &'a Sources, tree: &'a Tree, overrides: &Overrides, values: &[Setting]) -> Check<'a> {
    runs::begins("check");
    let mut check = Check::new(sources, tree, overrides.literals);
    check.overrides(overrides);
    check.set(values);
    check.run();
    check
}

/// Like [`check`], and reads the values that a study gives to parameters, one parameter a line.
pub fn check_swept(sources: &Sources, tree: &Tree, overrides: &Overrides, lines: FileId) -> (Checked, Vec<Swept>) {
    let mut check = Check::new(sources, tree, overrides.literals);
    check.overrides(overrides);
    let lines = check.swept_lines(lines);
    check.run();
    let swept = check.sweep_lines(&lines);
    (check.finish(), swept)
}

/// Every `param` that is a number, with its current value, in order of declaration.
pub fn parameters(sources: &Sources, tree: &Tree, overrides: &Overrides, values: &[Setting]) -> Vec<Parameter> {
    let mut check = Check::new(sources, tree, overrides.literals);
    check.overrides(overrides);
    check.set(values);
    check.collect();
    check.evaluate_definitions();
    check.parameters()
}

/// A `param`, `let` or `point` in one repetition, with its value.
#[derive(Clone, Debug)]
pub struct Defined {
    pub name: String,
    /// The span of the word that it declares.
    pub span: Span,
    /// `None` if there is an error in it.
    pub value: Option<Value>,
}

/// The values of the parameters of a tree, in order of declaration, even if the tree has errors: for editors.
pub fn values(sources: &Sources, tree: &Tree, overrides: &Overrides, settings: &[Setting]) -> Vec<Defined> {
    let mut check = Check::new(sources, tree, overrides.literals);
    check.overrides(overrides);
    check.set(settings);
    check.collect();
    check.evaluate_definitions();
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

/// Whether a word has a fixed meaning wherever a number may stand, so that no parameter can have this name.
pub fn is_reserved(word: &str) -> bool {
    word == "pi" || value::Function::by_name(word).is_some()
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
    /// Symbols of words, by their position.
    symbols: Table<Span, Symbol>,
    units: HashMap<&'a str, Unit>,
    diagnostics: Diagnostics,
    /// Findings that have been reported, so that the repetitions of a `repeat` report them once.
    reported: HashSet<(Code, Span)>,
    /// Counts of errors and of other findings.
    tallies: [Tally; 2],
    overrides: Given,
    /// Whether this check evaluates a value from outside, which knows no names of the model.
    outside: bool,
    /// The variable of the law that is being read: `stretch` or `rate`.
    law_over: Option<&'static str>,
    /// Words of declarations that could not be read or unrolled: no message calls them unknown.
    broken_words: HashSet<&'a str>,
    /// The last unit in brackets that was reported: what is glued to it is the same mistake.
    unit_in_brackets: Option<Span>,
    /// Number of searches for a similar word so far.
    searches: u32,
    environments: Environments,
    definitions: Vec<Definition>,
    values: Space<DefinitionId>,
    parts: Space<Part>,
    instances: Instances<'a>,
    counted: Count,
    /// Whether it has been reported that places declare too much.
    is_full: bool,
    known: ComponentNames<'a>,
    /// Whether a file of components is missing, so that unknown names may be defined in it.
    lacks_components: bool,
    frames: Vec<Frame>,
    ports: Vec<Port>,
    /// The motion of a place that is neither positioned, turned nor mirrored.
    unmoved: Arc<places::Motion>,
    /// The dimensions of the parameters of components.
    formals_like: Table<(u32, u32), Evaluated<Option<Scalar>>>,
    drafts: drafts::Drafts,
    /// Bodies whose line has the opposite direction in their component.
    reversed: HashSet<BodyId>,
    walk: Walk,
    memory: Cache,
    directions: Directions,
    recent_laws: shared::Recent<Law>,
    recent_matters: shared::Recent<Matter>,
    freedoms: Freedoms,
    /// The points about which inertias are given, for bodies without a mass.
    inertia_points: HashMap<BodyId, Arc<Vec3>>,
    /// Parts that could not be checked: errors that follow from that are not reported.
    broken_bodies: HashSet<BodyId>,
    broken_bases: HashSet<BaseId>,
    broken_joints: bool,
    broken_elements: bool,
    broken_inputs: bool,
    /// Motions are read as they are at rest.
    reads_rest: bool,
    /// Inputs whose signal is that of another input, delayed.
    delays: Vec<delays::Delay>,
    /// Tables that have been read, each once; `None` for one with an error.
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
            reported: HashSet::new(),
            tallies: Default::default(),
            overrides: Given::default(),
            outside: false,
            law_over: None,
            broken_words: HashSet::new(),
            unit_in_brackets: None,
            searches: 0,
            environments: Environments::default(),
            definitions: Vec::new(),
            values: Space::default(),
            parts: Space::default(),
            instances: Instances::default(),
            counted: Count::default(),
            is_full: false,
            known: ComponentNames::default(),
            lacks_components: false,
            frames: Vec::new(),
            ports: Vec::new(),
            unmoved: Arc::new(places::Motion::at_rest(None)),
            formals_like: Table::default(),
            drafts: drafts::Drafts::default(),
            reversed: HashSet::new(),
            walk: Walk::default(),
            memory: Cache::default(),
            directions: Directions::default(),
            recent_laws: Default::default(),
            recent_matters: Default::default(),
            freedoms: Freedoms::default(),
            inertia_points: HashMap::new(),
            broken_bodies: HashSet::new(),
            broken_bases: HashSet::new(),
            broken_joints: false,
            broken_elements: false,
            broken_inputs: false,
            reads_rest: false,
            delays: Vec::new(),
            tables: HashMap::new(),
            scene: empty_scene(sources.file(tree.file).stem()),
        }
    }

    /// Reports an error, once for each place.
    fn report(&mut self, environment: Environment, error: impl Into<Error>) {
        let mut diagnostic = error.into().diagnostic();
        if self.reported.contains(&(diagnostic.code, diagnostic.primary.span)) {
            return;
        }
        if self.walk.varies && !environment.is_top() {
            let indices = self.describe_environment(environment, "`");
            let text = &mut diagnostic.primary.text;
            *text = if text.is_empty() { indices } else { format!("{text}, {indices}") };
        }
        if let Some(diagnostic) = self.blame_argument(diagnostic, environment) {
            self.say(diagnostic);
        }
    }

    /// The place of a component and the values of the indices of an environment: `in front, i = 2`, with marks around the name.
    fn describe_environment(&self, environment: Environment, marks: &str) -> String {
        if environment.is_top() {
            return String::new();
        }
        let place = self.words.place_name(self.place_of(environment));
        let place = place.map(|name| format!("in {marks}{}{marks}", self.words.display(name)));
        let indices = self.environments.indices(environment);
        let indices = indices.iter().map(|(symbol, value)| format!("{} = {value}", self.words.text(*symbol)));
        place.into_iter().chain(indices).collect::<Vec<_>>().join(", ")
    }

    /// Adds a finding, once for each place, unless there are too many.
    fn say(&mut self, diagnostic: Diagnostic) {
        let place = diagnostic.primary.span;
        if self.reported.insert((diagnostic.code, place))
            && self.tallies[usize::from(!diagnostic.is_error())].counts(place)
        {
            self.diagnostics.push(diagnostic);
        }
    }

    /// Reports an error and stops here.
    fn fail<T>(&mut self, environment: Environment, error: impl Into<Error>) -> Evaluated<T> {
        self.report(environment, error);
        Err(Stop::Reported)
    }

    /// Every step, in order.
    fn run(&mut self) {
        self.collect();
        self.overridden_names();
        self.evaluate_definitions();
        self.bodies();
        self.bases();
        self.joints();
        self.freedoms();
        self.settings();
        self.needs();
        self.elements();
        self.inputs();
        self.settle_delays();
        self.couples();
        self.outputs();
        self.initials();
        self.tolerances();
        self.solves();
        self.optima();
        self.requires();
        self.check_asked_measures();
        self.unplaced_components();
        self.warn_unused();
    }

    fn finish(mut self) -> Checked {
        let [errors, others] = self.tallies;
        self.diagnostics
            .extend(errors.unreported_count(|span, count| NameError::MoreErrors { span, count }.diagnostic()));
        self.diagnostics
            .extend(others.unreported_count(|span, count| NameError::MoreWarnings { span, count }.diagnostic()));
        self.scene.words = std::mem::take(&mut self.words);
        let scene = (!self.diagnostics.has_errors()).then_some(CheckedScene { scene: self.scene });
        Checked { scene, diagnostics: self.diagnostics }
    }
}

/// Findings of one kind: the first ones are reported, the others counted.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    count: usize,
    /// The last place in the texts among all findings.
    last: Option<Span>,
}

impl Tally {
    /// Counts a finding; returns whether it is to be reported.
    fn counts(&mut self, place: Span) -> bool {
        self.count += 1;
        let order = |span: Span| (span.file(), span.start());
        if self.last.is_none_or(|last| order(last) < order(place)) {
            self.last = Some(place);
        }
        self.count <= limits::ERRORS
    }

    /// The finding that gives the number of unreported ones, placed after all others.
    fn unreported_count(self, tell: fn(Span, usize) -> Diagnostic) -> Option<Diagnostic> {
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
        tolerances: Vec::new(),
        correlations: Vec::new(),
        solves: Vec::new(),
        optima: Vec::new(),
        requires: Vec::new(),
        asked: Vec::new(),
    }
}
