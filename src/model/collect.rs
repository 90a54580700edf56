//! The first walk over the tree: declares every name and unrolls every `repeat`. In: the tree. Out: both name spaces and,
//! for each kind of declaration, its instances in order. See spec.md#names.
//!
//! Top-level parameters come first, so that the bounds of a `repeat` may use them wherever they are declared. The
//! instances are counted before any is made, so that an excessive number is refused without work.

use super::Check;
use super::error::NameError;
use super::evaluate::{Evaluated, Stop};
use super::scope::{Definition, DefinitionId, DefinitionKind, Environment, Instance, Names, Part, Role, State};
use super::tolerances::Tolerated;
use super::value::Function;
use crate::base::{Name, Span, Symbol};
use crate::kinds;
use crate::syntax::tree::{Decl, DeclKind, ExprId, Ident, Rare, Repeat};

/// Limit on the declarations that all `repeat`s together unroll to: a million bodies with a spring, a damper and an output
/// each.
pub const MAX_INSTANCES: u64 = 4_000_000;
/// Limit on the bodies among them: each has coordinates, and takes some 400 bytes even without these.
pub const MAX_BODIES: u64 = 1_000_000;
/// Limit on the joints, couplings, inputs, outputs and questions among them: a force with its signal takes a kilobyte.
pub const MAX_OTHERS: u64 = 1_000_000;

/// The number of declarations that `repeat`s unroll to.
#[derive(Clone, Copy, Debug, Default)]
pub struct Count {
    instances: u64,
    bodies: u64,
    /// Declarations other than bodies and the most common kinds: springs, dampers and values.
    others: u64,
}

impl Count {
    /// Adds the counts of a block itself, multiplied by the number of its repetitions.
    pub fn add(&mut self, body: &[Decl], times: u64) {
        let number = |is: fn(&DeclKind) -> bool| body.iter().filter(|decl| is(&decl.kind)).count() as u64;
        let own = number(|kind| !matches!(kind, DeclKind::Repeat { .. })).max(1);
        let bodies = number(|kind| matches!(kind, DeclKind::Body { .. }));
        let others = number(|kind| matches!(kind, DeclKind::Rare { .. }));
        self.instances = self.instances.saturating_add(times.saturating_mul(own));
        self.bodies = self.bodies.saturating_add(times.saturating_mul(bodies));
        self.others = self.others.saturating_add(times.saturating_mul(others));
    }

    /// The limit that is exceeded, and of what.
    pub fn exceeded_limit(&self) -> Option<(u64, &'static str)> {
        let limits = [
            (self.instances, MAX_INSTANCES, "declarations"),
            (self.bodies, MAX_BODIES, "bodies"),
            (self.others, MAX_OTHERS, "joints, inputs and outputs"),
        ];
        limits.into_iter().find(|(count, limit, _)| count > limit).map(|(_, limit, what)| (limit, what))
    }
}

/// The name that a declaration declares, and a function from the index of the instance to the declared item.
type Declares = Option<(Ident, fn(u32) -> Part)>;

/// The instances of each kind, in order.
#[derive(Debug, Default)]
pub struct Instances<'a> {
    pub bodies: Vec<Instance<'a>>,
    /// The names of the bodies and of the elements, in the same order.
    pub body_names: Names,
    pub bases: Vec<Instance<'a>>,
    pub joints: Vec<Instance<'a>>,
    pub couples: Vec<Instance<'a>>,
    pub elements: Vec<Instance<'a>>,
    pub element_names: Names,
    /// Forces, torques and bases: the inputs.
    pub inputs: Vec<Instance<'a>>,
    pub outputs: Vec<Instance<'a>>,
    pub initials: Vec<Instance<'a>>,
    pub tolerances: Vec<Tolerated>,
    pub correlations: Vec<Instance<'a>>,
    pub solves: Vec<Instance<'a>>,
    pub optima: Vec<Instance<'a>>,
    pub requires: Vec<Instance<'a>>,
    /// Declarations that a scene has at most once: model, gravity, damping, rest.
    pub settings: Vec<Instance<'a>>,
}

impl<'a> Check<'a> {
    pub fn collect(&mut self) {
        let tree = self.tree;
        self.components();
        for span in &tree.broken {
            let text = self.sources.slice(*span).trim_start();
            let words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
            // A joint that could not be read, or a line that may have been meant as one.
            let keyword = words.clone().next().and_then(kinds::declaration);
            self.broken_joints |= keyword.is_none_or(|declaration| matches!(declaration.shape, kinds::Shape::Joint(_)));
            self.broken_words.extend(words);
        }
        for decl in &tree.decls {
            self.declare_value(Instance { decl, environment: Environment::TOP });
        }
        for decl in &tree.decls {
            let instance = Instance { decl, environment: Environment::TOP };
            match decl.kind {
                DeclKind::Repeat { index } => self.count_and_unroll(&tree.repeats[index as usize], Environment::TOP),
                _ => self.declare_part(instance),
            }
        }
        self.tie_ports();
    }

    /// Unrolls an outermost `repeat`, if the result is not too large.
    pub fn count_and_unroll(&mut self, repeat: &'a Repeat, environment: Environment) {
        let mut counted = self.counted;
        match self.count(repeat, environment, &mut counted) {
            Ok(()) => {
                self.counted = counted;
                self.unroll(repeat, environment);
            }
            Err(_) => self.remember_as_broken(&repeat.body),
        }
    }

    /// Adds the declarations that a `repeat` unrolls to; an error if there are too many.
    fn count(&mut self, repeat: &'a Repeat, environment: Environment, count: &mut Count) -> Evaluated<()> {
        let (first, last) = self.bounds(repeat, environment)?;
        let repetitions = u64::try_from(i64::from(last) - i64::from(first) + 1).unwrap_or(0);
        let nested: Vec<&Repeat> = repeat.body.iter().filter_map(|decl| self.nested_repeat(decl)).collect();
        count.add(&repeat.body, repetitions);
        if let Some((limit, what)) = count.exceeded_limit() {
            return self.too_many(repeat, limit, what, environment);
        }
        if nested.is_empty() {
            return Ok(());
        }
        let symbol = self.words.intern(self.sources.slice(repeat.index));
        for value in first..=last {
            let mark = self.environments.mark();
            let inside = self.environments.bind(environment, symbol, value);
            let counted = nested.iter().try_for_each(|repeat| self.count(repeat, inside, count));
            self.environments.release(mark);
            counted?;
        }
        Ok(())
    }

    fn nested_repeat(&self, decl: &'a Decl) -> Option<&'a Repeat> {
        let DeclKind::Repeat { index } = decl.kind else { return None };
        Some(&self.tree.repeats[index as usize])
    }

    fn too_many<T>(
        &mut self,
        repeat: &Repeat,
        limit: u64,
        what: &'static str,
        environment: Environment,
    ) -> Evaluated<T> {
        let span = self.tree.expr(repeat.first).span.to(self.tree.expr(repeat.last).span);
        self.fail(environment, NameError::TooManyInstances { span, limit, what })
    }

    fn unroll(&mut self, repeat: &'a Repeat, environment: Environment) {
        let Ok((first, last)) = self.bounds(repeat, environment) else { return };
        let symbol = self.words.intern(self.sources.slice(repeat.index));
        self.not_reserved(repeat.index, environment);
        if let Some(other) = self.taken_index(symbol, environment) {
            let (span, name) = (repeat.index, self.words.text(symbol).to_string());
            self.report(environment, NameError::Duplicate { span, name, first: other });
        }
        for value in first..=last {
            let inside = self.environments.bind(environment, symbol, value);
            for decl in &repeat.body {
                let instance = Instance { decl, environment: inside };
                match self.nested_repeat(decl) {
                    Some(repeat) => self.unroll(repeat, inside),
                    None => {
                        self.declare_value(instance);
                        self.declare_part(instance);
                    }
                }
            }
        }
    }

    /// The place where an index's word is declared already.
    fn taken_index(&self, symbol: Symbol, environment: Environment) -> Option<Option<Span>> {
        if self.environments.value(environment, symbol).is_some() {
            return Some(None);
        }
        self.values.family(self.group_of(environment), symbol).map(|family| Some(self.value_span(family.first)))
    }

    /// First and last value of the index; last = first - 1 repeats nothing.
    fn bounds(&mut self, repeat: &Repeat, environment: Environment) -> Evaluated<(i32, i32)> {
        let first = self.repeat_bound(repeat.first, environment);
        let last = self.repeat_bound(repeat.last, environment)?;
        let first = first?;
        // Both are smaller than 2^63 in magnitude, so their difference fits in 128 bits.
        let repetitions = i128::from(last) - i128::from(first) + 1;
        if repetitions > i128::from(MAX_INSTANCES) {
            return self.too_many(repeat, MAX_INSTANCES, "declarations", environment);
        }
        if repetitions < 0 {
            let span = self.tree.expr(repeat.first).span.to(self.tree.expr(repeat.last).span);
            return self.fail(environment, NameError::ReversedBounds { span, first, last });
        }
        Ok((self.as_index(first, repeat.first, environment)?, self.as_index(last, repeat.last, environment)?))
    }

    fn repeat_bound(&mut self, expr: ExprId, environment: Environment) -> Evaluated<i64> {
        let value = self.evaluate(expr, environment)?;
        self.as_integer(&value, expr, environment)
    }

    pub fn whole(&mut self, expr: ExprId, environment: Environment) -> Evaluated<i32> {
        let value = self.evaluate(expr, environment)?;
        self.as_whole(&value, expr, environment)
    }

    pub fn declare_value(&mut self, instance: Instance<'a>) {
        let (kind, name, expr) = match instance.decl.kind {
            DeclKind::Param { name, value, .. } => (DefinitionKind::Param, name, value),
            DeclKind::Let { name, value } => (DefinitionKind::Let, name, value),
            DeclKind::Point { name, value } => (DefinitionKind::Point, name, value),
            _ => return,
        };
        let environment = instance.environment;
        if !self.not_reserved(name.span, environment) {
            return;
        }
        let (span, id) = (name.span, DefinitionId(self.definitions.len() as u32));
        let Ok(name) = self.declared_name(name, environment) else { return };
        let group = self.group_of(environment);
        let place = self.parts.get(name).filter(|part| matches!(part, Part::Place(_)));
        let other = place.map(|place| self.part_span(place));
        let declared = self.values.declare(group, name, id);
        let first = other.or_else(|| declared.err().map(|other| self.value_span(other)));
        if first.is_some() {
            let name = self.words.display(name);
            self.report(environment, NameError::Duplicate { span, name, first });
        }
        if declared.is_err() {
            return;
        }
        let (state, used, role) = (State::Unsettled, first.is_some(), Role::Declared);
        self.definitions.push(Definition { kind, name, span, expr, environment, state, used, role });
        if let DeclKind::Param { tolerance: Some(index), .. } = instance.decl.kind {
            self.instances.tolerances.push(Tolerated { parameter: id, index });
        }
    }

    /// Reports names that have a fixed meaning wherever a number may stand; returns whether the name is free.
    pub fn not_reserved(&mut self, span: Span, environment: Environment) -> bool {
        let word = self.sources.slice(span);
        let reserved = word == "pi" || Function::by_name(word).is_some();
        if reserved {
            self.report(environment, NameError::Reserved { span, word: word.to_string() });
        }
        !reserved
    }

    /// The declared name. Its word counts as known from now on, even if its indices have no value.
    pub fn declared_name(&mut self, ident: Ident, environment: Environment) -> Evaluated<Name> {
        let name = self.name(ident, environment);
        if let Err(Stop::Reported) = name {
            self.broken_words.insert(self.sources.slice(ident.span));
        }
        name
    }

    pub fn declare_part(&mut self, instance: Instance<'a>) {
        let list = &mut self.instances;
        let (list, part): (&mut Vec<Instance<'a>>, Declares) = match instance.decl.kind {
            DeclKind::Body { name, .. } => (&mut list.bodies, Some((name, Part::Body))),
            DeclKind::Element { name, .. } => (&mut list.elements, Some((name, Part::Element))),
            DeclKind::Model { .. } | DeclKind::Gravity { .. } => (&mut list.settings, None),
            DeclKind::Rare { index } => match self.tree.rare[index as usize] {
                Rare::Joint { name, .. } => (&mut list.joints, Some((name, Part::Joint))),
                Rare::Couple { name, .. } => (&mut list.couples, Some((name, Part::Couple))),
                Rare::Base { name, .. } => {
                    list.inputs.push(instance);
                    (&mut list.bases, Some((name, Part::Base)))
                }
                Rare::Force { name, .. } | Rare::Torque { name, .. } | Rare::Unbalance { name, .. } => {
                    (&mut list.inputs, Some((name, Part::Input)))
                }
                Rare::Output { name, .. } => (&mut list.outputs, Some((name, Part::Output))),
                Rare::Initial { .. } => (&mut list.initials, None),
                Rare::Solve { .. } => (&mut list.solves, None),
                Rare::Optimum { .. } => (&mut list.optima, None),
                Rare::Require { .. } => (&mut list.requires, None),
                Rare::Correlate { .. } => (&mut list.correlations, None),
                Rare::DampingModal { .. } | Rare::DampingRayleigh { .. } | Rare::RestAsDrawn => {
                    (&mut list.settings, None)
                }
                Rare::Place { .. } => return self.declare_place(instance),
                Rare::Use { .. } => return,
            },
            DeclKind::Param { .. } | DeclKind::Let { .. } | DeclKind::Point { .. } => return,
            DeclKind::Repeat { .. } | DeclKind::Component { .. } => return,
        };
        let index = list.len() as u32;
        list.push(instance);
        if let Some((ident, part)) = part {
            self.declare_part_name(ident, part(index), instance.environment);
        }
    }

    fn declare_part_name(&mut self, ident: Ident, part: Part, environment: Environment) {
        let name = self.part_name_declared(ident, part, environment);
        let name = name.unwrap_or_else(|_| {
            let symbol = self.words.intern(self.sources.slice(ident.span));
            Name::plain(symbol).in_place(self.place_of(environment))
        });
        match part {
            Part::Body(_) => self.instances.body_names.push(name),
            Part::Element(_) => self.instances.element_names.push(name),
            _ => {}
        }
    }

    fn part_name_declared(&mut self, ident: Ident, part: Part, environment: Environment) -> Evaluated<Name> {
        let span = ident.span;
        if self.sources.slice(span) == "ground" {
            return self.fail(environment, NameError::Reserved { span, word: "ground".into() });
        }
        let name = self.declared_name(ident, environment)?;
        if let Err(other) = self.parts.declare(self.group_of(environment), name, part) {
            let (name, first) = (self.words.display(name), self.part_span(other));
            self.report(environment, NameError::Duplicate { span, name, first: Some(first) });
        }
        Ok(name)
    }

    /// The place where a value is declared: the word of its name.
    pub fn value_span(&self, value: DefinitionId) -> Span {
        self.definitions[value.0 as usize].span
    }

    /// The place where a part is declared: the word of its name.
    pub fn part_span(&self, part: Part) -> Span {
        let (list, index) = match part {
            Part::Body(index) => (&self.instances.bodies, index),
            Part::Base(index) => (&self.instances.bases, index),
            Part::Joint(index) => (&self.instances.joints, index),
            Part::Couple(index) => (&self.instances.couples, index),
            Part::Element(index) => (&self.instances.elements, index),
            Part::Input(index) => (&self.instances.inputs, index),
            Part::Output(index) => (&self.instances.outputs, index),
            Part::Place(frame) => return self.frame(frame).span,
            Part::Port(port) => return self.port_span(port),
            Part::Ground => return Span::new(self.tree.file, 0, 0),
        };
        let decl = list[index as usize].decl;
        self.declared_ident(decl).map_or(decl.span, |ident| ident.span)
    }

    /// The kind of a part, with its article.
    pub fn noun_of(&self, part: Part) -> &'static str {
        match part {
            Part::Body(_) => "a body",
            Part::Base(_) => "a base",
            Part::Joint(_) => "a joint",
            Part::Couple(_) => "a coupling",
            Part::Element(index) => match self.instances.elements[index as usize].decl.kind {
                DeclKind::Element { kind, .. } => kind.kind().noun,
                _ => "an element",
            },
            Part::Input(_) => "a force or torque",
            Part::Output(_) => "an output",
            Part::Place(_) => "a place of a component",
            Part::Port(_) => "a port",
            Part::Ground => "the ground",
        }
    }

    /// The identifier that a declaration declares.
    pub fn declared_ident(&self, decl: &Decl) -> Option<Ident> {
        match decl.kind {
            DeclKind::Param { name, .. } | DeclKind::Let { name, .. } | DeclKind::Point { name, .. } => Some(name),
            DeclKind::Body { name, .. } | DeclKind::Element { name, .. } => Some(name),
            DeclKind::Rare { index } => match self.tree.rare[index as usize] {
                Rare::Joint { name, .. } | Rare::Couple { name, .. } | Rare::Base { name, .. } => Some(name),
                Rare::Force { name, .. } | Rare::Torque { name, .. } | Rare::Output { name, .. } => Some(name),
                Rare::Unbalance { name, .. } => Some(name),
                Rare::Place { name, .. } => Some(name),
                _ => None,
            },
            _ => None,
        }
    }

    /// Remembers the words of declarations that are not unrolled, so that no message calls them unknown.
    fn remember_as_broken(&mut self, body: &'a [Decl]) {
        for decl in body {
            if let Some(ident) = self.declared_ident(decl) {
                self.broken_words.insert(self.sources.slice(ident.span));
            }
            if let Some(repeat) = self.nested_repeat(decl) {
                self.remember_as_broken(&repeat.body);
            }
        }
    }
}
