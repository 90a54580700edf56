//! Components at their places. In: `component`, `place` and `use`. Out: for each place a [`Frame`], the context in
//! which the names in the component are evaluated, and the declarations of its body as separate instances. See
//! spec.md#components.
//!
//! A component is not copied: its declarations stay where they are, and each place is an environment in which they are
//! evaluated. Positions and directions are computed in the component's own axes, exactly as they are written, and
//! converted to those of the scene when they enter it ([`Placed`]).

use super::Check;
use super::error::{NameError, PlaceError, QuestionError, ValueError};
use super::evaluate::{Evaluated, Stop};
use super::scope::{self, Definition, DefinitionId, DefinitionKind, Environment, Group, Instance, Role, State};
use super::suggestion::nearest;
use super::value::Value;
use crate::base::{Dimension, FileId, Name, Number, Place, Span, Symbol, Vec3};
use crate::kinds::motions::is_motion;
use crate::syntax::tree::{Component, Decl, DeclKind, ExprId, ExprKind, FormalKind, Ident, Path, Placing, Rare};
use std::collections::HashMap;
use std::sync::Arc;

/// Levels of components in components.
pub const MAX_LEVELS: usize = 64;

/// Index into the places of a scene, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameId(pub u32);

/// A component at one of its places.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The space of the names inside.
    pub place: Place,
    /// `None` if it is unknown or its arguments are wrong; nothing inside it is then reported.
    pub component: Option<u32>,
    /// The environment of the `place` declaration.
    pub outer: Environment,
    /// The environment of the component's declarations.
    pub inside: Environment,
    /// The name that the `place` declares.
    pub span: Span,
    pub at: Option<DefinitionId>,
    pub turned: Option<DefinitionId>,
    mirrored: [bool; 2],
    placed: Option<Evaluated<Placed>>,
}

impl Frame {
    /// A component that lies in its own axes, in no scene.
    pub fn in_own_axes(place: Place, component: u32, inside: Environment, span: Span) -> Frame {
        let still = Arc::new(Motion::at_rest(Some(Vec3::ZERO)));
        Frame {
            place,
            component: Some(component),
            outer: Environment::TOP,
            inside,
            span,
            at: None,
            turned: None,
            mirrored: [false, false],
            placed: Some(Ok(Placed { around: still.clone(), scene: still })),
        }
    }
}

/// A part that a component ties to.
#[derive(Clone, Debug)]
pub struct Port {
    /// The argument and the environment in which it is evaluated; `None` if the component is placed alone.
    tied: Option<(Environment, ExprId)>,
    /// The port's name in the component.
    declared: Span,
    part: Option<Evaluated<scope::Part>>,
}

impl Port {
    pub fn tie(environment: Environment, argument: ExprId, declared: Span) -> Port {
        Port { tied: Some((environment, argument)), declared, part: None }
    }
}

/// The position and orientation of a component: in the axes around its place, and in those of the scene.
#[derive(Clone, Debug)]
pub struct Placed {
    pub around: Arc<Motion>,
    pub scene: Arc<Motion>,
}

/// x -> o + R S x: mirrored by the signs S, turned by R, moved to o.
#[derive(Clone, Debug)]
pub struct Motion {
    /// `None` if the place has no position.
    pub origin: Option<Vec3>,
    pub angle: Number,
    /// Sine and cosine of the angle.
    pub sine: Number,
    pub cosine: Number,
    /// Whether x and y change their signs.
    pub mirrored: [bool; 2],
}

impl Motion {
    /// A motion without rotation or reflection.
    pub fn at_rest(origin: Option<Vec3>) -> Motion {
        Motion { origin, angle: Number::ZERO, sine: Number::ZERO, cosine: Number::ONE, mirrored: [false, false] }
    }

    /// Lengths and directions stay as they are.
    pub fn keeps_directions(&self) -> bool {
        self.angle.is_zero() && self.mirrored == [false, false]
    }

    /// Counter-clockwise becomes clockwise.
    pub fn reverses(&self) -> bool {
        self.mirrored[0] != self.mirrored[1]
    }

    /// A direction or a difference of places.
    pub fn direction(&self, v: &Vec3) -> Vec3 {
        let signed = |number: &Number, is_mirrored| if is_mirrored { -number } else { number.clone() };
        let (x, y) = (signed(&v.x, self.mirrored[0]), signed(&v.y, self.mirrored[1]));
        if self.angle.is_zero() {
            return Vec3::planar(x, y);
        }
        let (sine, cosine) = (&self.sine, &self.cosine);
        Vec3::planar(&(cosine * &x) - &(sine * &y), &(sine * &x) + &(cosine * &y))
    }

    /// A position in the outer axes; `None` if the component has no position.
    pub fn place(&self, v: &Vec3) -> Option<Vec3> {
        Some(self.origin.as_ref()?.add(&self.direction(v)))
    }

    /// First `inner`, then this.
    fn compose(&self, inner: &Motion) -> Option<Motion> {
        let angle = if self.reverses() { -&inner.angle } else { inner.angle.clone() };
        let angle = &self.angle + &angle;
        let (sine, cosine) = angle.sin_cos()?;
        let origin = inner.origin.as_ref().and_then(|origin| self.place(origin));
        let mirrored = [0, 1].map(|axis| self.mirrored[axis] != inner.mirrored[axis]);
        Some(Motion { origin, angle, sine, cosine, mirrored })
    }
}

/// The components that each file knows by name: its own and those of the files that it uses.
#[derive(Debug, Default)]
pub struct ComponentNames<'a> {
    by_name: HashMap<(FileId, &'a str), u32>,
    /// The names in order, for suggestions.
    names: HashMap<FileId, Vec<&'a str>>,
    /// Components that cannot be placed, since they contain themselves.
    pub broken: Vec<bool>,
}

const ANGLE: super::expect::Expected = super::expect::Expected::new("an angle", Dimension::NONE, "turned 10 deg");

impl<'a> Check<'a> {
    // ---- Files and components, before anything is placed ----

    /// Reports errors of `use` lines and of components, independent of their places.
    pub fn components(&mut self) {
        let tree = self.tree;
        if tree.components.is_empty() && tree.uses.is_empty() {
            return;
        }
        self.collect_uses();
        self.known_components();
        for component in &tree.components {
            self.formals(component);
            self.component_body(&component.body);
        }
        self.recursions();
    }

    fn collect_uses(&mut self) {
        let tree = self.tree;
        for using in &tree.uses {
            let reason = match self.sources.used_file(using.text) {
                None => "it was not read: a model uses at most 32 files".to_string(),
                Some(file) => match &self.sources.file(file).unread {
                    Some(reason) => reason.clone(),
                    None if tree.no_models.contains(&file) => "it is no model file".into(),
                    None => continue,
                },
            };
            // Everything placed from it would be unknown for this reason alone.
            self.lacks_components = true;
            self.report(Environment::TOP, PlaceError::Unread { span: using.text, reason });
        }
        let mut done = Vec::new();
        self.use_cycles(&mut vec![tree.file], &mut done);
    }

    /// Walks from file to file; the number of files is limited far below what the stack holds.
    fn use_cycles(&mut self, path: &mut Vec<FileId>, done: &mut Vec<FileId>) {
        let tree = self.tree;
        let Some(&file) = path.last() else { return };
        for using in tree.uses.iter().filter(|using| using.text.file() == file) {
            let Some(used) = self.sources.used_file(using.text) else { continue };
            if let Some(start) = path.iter().position(|known| *known == used) {
                let name =
                    |file: &FileId| format!("`{}`", crate::base::readable::readable(&self.sources.file(*file).name));
                let files = path[start..].iter().chain([&used]).map(name).collect();
                self.report(Environment::TOP, PlaceError::UseCycle { span: using.text, files });
            } else if !done.contains(&used) {
                path.push(used);
                self.use_cycles(path, done);
                path.pop();
            }
        }
        done.push(file);
    }

    pub fn known_components(&mut self) {
        let tree = self.tree;
        self.known.broken = vec![false; tree.components.len()];
        let mut files: Vec<FileId> = vec![tree.file];
        files.extend(tree.components.iter().map(|component| component.name.file()));
        files.extend(tree.uses.iter().map(|using| using.text.file()));
        files.sort_unstable();
        files.dedup();
        for &file in &files {
            for (index, component) in tree.components_of(file) {
                self.add_known_component(file, index, component, component.name);
            }
        }
        for &file in &files {
            let mut seen = vec![file];
            for using in tree.uses.iter().filter(|using| using.text.file() == file) {
                let Some(used) = self.sources.used_file(using.text).filter(|used| !seen.contains(used)) else {
                    continue;
                };
                seen.push(used);
                for (index, component) in tree.components_of(used) {
                    self.add_known_component(file, index, component, using.text);
                }
            }
        }
    }

    /// Adds a component to those that a file knows; `at` is the place that introduces it.
    fn add_known_component(&mut self, file: FileId, index: u32, component: &Component, at: Span) {
        let word = self.sources.slice(component.name);
        if let Some(&other) = self.known.by_name.get(&(file, word)) {
            let other = self.tree.component(other).name;
            let own = if at == component.name { Vec::new() } else { vec![component.name] };
            // If the file itself declares one of them, that is the one to rename.
            let (span, others) = match other.file() == file && at != component.name {
                true => (other, own),
                false => (at, std::iter::once(other).chain(own).collect()),
            };
            return self
                .report(Environment::TOP, PlaceError::DuplicateComponent { span, word: word.to_string(), others });
        }
        self.known.by_name.insert((file, word), index);
        self.known.names.entry(file).or_default().push(word);
    }

    /// Names and defaults in the brackets of a component.
    fn formals(&mut self, component: &'a Component) {
        let mut seen: HashMap<&str, Span> = HashMap::new();
        for formal in &component.formals {
            let word = self.sources.slice(formal.name);
            if let Some(&first) = seen.get(word) {
                let error = NameError::Duplicate { span: formal.name, name: word.into(), first: Some(first) };
                self.report(Environment::TOP, error);
                continue;
            }
            seen.insert(word, formal.name);
            match formal.kind {
                FormalKind::Port if word == "ground" => {
                    let error = NameError::Reserved { span: formal.name, word: word.into() };
                    self.report(Environment::TOP, error);
                }
                FormalKind::Port => self.no_motion_name(formal.name),
                FormalKind::Number { unit: None, default: None } => {
                    let error = PlaceError::Undetermined { span: formal.name, word: word.into() };
                    self.report(Environment::TOP, error);
                }
                FormalKind::Number { .. } => {
                    self.not_reserved(formal.name, Environment::TOP);
                }
            }
        }
    }

    fn no_motion_name(&mut self, span: Span) {
        let word = self.sources.slice(span);
        if is_motion(word) {
            self.report(Environment::TOP, PlaceError::MotionName { span, word: word.to_string() });
        }
    }

    /// Reports declarations that a component may not contain, and names that it may not declare.
    fn component_body(&mut self, body: &'a [Decl]) {
        const WHOLE: (&str, &str) =
            ("it holds for the whole scene", "declare it in the scene, outside of the component");
        for decl in body {
            let (reason, help) = match decl.kind {
                DeclKind::Param { .. } => (
                    "its parameters are written in the brackets after its name",
                    "write it there, `component axle(k = 10 N/m)`, or as `let` if it follows from others",
                ),
                DeclKind::Model { .. } | DeclKind::Gravity { .. } => WHOLE,
                DeclKind::Repeat { index } => {
                    self.component_body(&self.tree.repeat(index).body);
                    continue;
                }
                DeclKind::Rare { index } => match self.tree.rare(index) {
                    Rare::DampingModal { .. } | Rare::DampingRayleigh { .. } | Rare::RestAsDrawn => WHOLE,
                    Rare::Solve { .. } => {
                        ("it finds a parameter for the whole scene", "write it in the scene: `solve front.k in ...`")
                    }
                    Rare::Correlate { .. } => {
                        ("it relates parameters of the scene", "write it in the scene, outside of the component")
                    }
                    Rare::Optimum { .. } => (
                        "it finds parameters for the whole scene",
                        "write it in the scene: `minimise ... over front.k in ...`",
                    ),
                    Rare::Place { name, .. } => {
                        self.no_motion_name(name.span);
                        continue;
                    }
                    _ => {
                        self.declared_ident(decl).into_iter().for_each(|ident| self.no_motion_name(ident.span));
                        continue;
                    }
                },
                DeclKind::Body { name, .. } | DeclKind::Element { name, .. } => {
                    self.no_motion_name(name.span);
                    continue;
                }
                DeclKind::Let { .. } | DeclKind::Point { .. } | DeclKind::Component { .. } => continue,
            };
            let text = self.sources.slice(decl.span);
            let end = text.find(|c: char| !c.is_ascii_lowercase()).unwrap_or(text.len());
            let span = Span::new(decl.span.file(), decl.span.start(), decl.span.start() + end);
            let keyword = text[..end].to_string();
            self.report(Environment::TOP, PlaceError::Forbidden { span, keyword, reason, help });
        }
    }

    /// Components that contain themselves, or contain each other too deep.
    fn recursions(&mut self) {
        #[derive(Clone, Copy, PartialEq)]
        enum Visit {
            No,
            /// On the way from the first one.
            Open,
            Done {
                levels: usize,
            },
        }
        let tree = self.tree;
        let contained: Vec<Vec<(u32, Span)>> =
            tree.components.iter().map(|c| self.placed_components(&c.body)).collect();
        let mut seen = vec![Visit::No; tree.components.len()];
        for first in 0..tree.components.len() {
            if seen[first] != Visit::No {
                continue;
            }
            // Each entry: a component, the number of components in it that have been visited, and the levels below it
            // so far.
            let mut path: Vec<(usize, usize, usize)> = vec![(first, 0, 0)];
            seen[first] = Visit::Open;
            while let Some((index, next, levels)) = path.last_mut() {
                let Some(&(inner, span)) = contained[*index].get(*next) else {
                    let done = *levels + 1;
                    seen[*index] = Visit::Done { levels: done };
                    path.pop();
                    if let Some((_, _, levels)) = path.last_mut() {
                        *levels = done.max(*levels);
                    }
                    continue;
                };
                *next += 1;
                match seen[inner as usize] {
                    Visit::Done { levels: below } => {
                        *levels = below.max(*levels);
                        if below >= MAX_LEVELS {
                            let index = *index;
                            self.known.broken[index] = true;
                            // The components around it are too deep because of it.
                            if below == MAX_LEVELS {
                                self.report(Environment::TOP, PlaceError::TooDeep { span, limit: MAX_LEVELS });
                            }
                        }
                    }
                    Visit::No => {
                        seen[inner as usize] = Visit::Open;
                        path.push((inner as usize, 0, 0));
                    }
                    Visit::Open => {
                        let start = path.iter().position(|entry| entry.0 == inner as usize).unwrap_or(0);
                        let members: Vec<usize> =
                            path[start..].iter().map(|entry| entry.0).chain([inner as usize]).collect();
                        for member in &members {
                            self.known.broken[*member] = true;
                        }
                        /// A longer list would not help.
                        const SHOWN: usize = 8;
                        let word = |member: &usize| format!("`{}`", self.sources.slice(tree.components[*member].name));
                        let mut chain: Vec<String> = members.iter().take(SHOWN).map(word).collect();
                        if members.len() > SHOWN {
                            chain.push("...".into());
                            chain.extend(members.last().map(word));
                        }
                        self.report(Environment::TOP, PlaceError::Recursion { span, chain });
                    }
                }
            }
        }
        // A component that contains a broken one cannot be placed either.
        let mut changed = true;
        while std::mem::take(&mut changed) {
            for (index, inner) in contained.iter().enumerate() {
                if !self.known.broken[index] && inner.iter().any(|(inner, _)| self.known.broken[*inner as usize]) {
                    self.known.broken[index] = true;
                    changed = true;
                }
            }
        }
    }

    /// The components that a body places, and the spans that name them.
    fn placed_components(&self, body: &'a [Decl]) -> Vec<(u32, Span)> {
        let mut all = Vec::new();
        for decl in body {
            match decl.kind {
                DeclKind::Repeat { index } => all.extend(self.placed_components(&self.tree.repeat(index).body)),
                DeclKind::Rare { index } => {
                    if let Rare::Place { component, .. } = self.tree.rare(index) {
                        let known = self.known.by_name.get(&(component.file(), self.sources.slice(*component)));
                        all.extend(known.map(|index| (*index, *component)));
                    }
                }
                _ => {}
            }
        }
        all
    }

    // ---- Places ----

    /// The space of the names of an environment.
    pub fn place_of(&self, environment: Environment) -> Place {
        self.environments.frame(environment).map_or(Place::SCENE, |frame| self.frame(frame).place)
    }

    pub fn group_of(&self, environment: Environment) -> Group {
        let frame = self.environments.frame(environment);
        frame.and_then(|frame| self.frame(frame).component).map_or(Group::SCENE, Group::of_component)
    }

    pub fn frame(&self, id: FrameId) -> &Frame {
        &self.frames[id.0 as usize]
    }

    /// Declares a place and everything in it.
    pub fn declare_place(&mut self, instance: Instance<'a>) {
        let Instance { decl, environment } = instance;
        let DeclKind::Rare { index } = decl.kind else { return };
        let Rare::Place { name: ident, component: word, arguments, placing } = self.tree.rare[index as usize] else {
            return;
        };
        let span = ident.span;
        if self.sources.slice(span) == "ground" || !self.not_reserved(span, environment) {
            if self.sources.slice(span) == "ground" {
                self.report(environment, NameError::Reserved { span, word: "ground".into() });
            }
            return;
        }
        let Ok(name) = self.declared_name(ident, environment) else { return };
        let id = FrameId(self.frames.len() as u32);
        let group = self.group_of(environment);
        let value = self.values.get(name).map(|other| self.value_span(other));
        let taken = value.or_else(|| self.parts.get(name).map(|other| self.part_span(other)));
        if taken.is_some() {
            let name = self.words.display(name);
            return self.report(environment, NameError::Duplicate { span, name, first: taken });
        }
        let place = self.words.declare_place(name);
        let brackets = self.brackets(word, arguments, environment);
        let inside = self.environments.enter(id);
        let mirrored = self.mirror(placing, environment);
        let (at, turned) = self.placing_definitions(name, span, placing, environment);
        self.frames.push(Frame {
            place,
            component: None,
            outer: environment,
            inside,
            span,
            at,
            turned,
            mirrored: mirrored.unwrap_or_default(),
            placed: mirrored.is_err().then_some(Err(Stop::Reported)),
        });
        // Not before: whatever is declared can be looked up. It is free, as was seen above.
        let _ = self.parts.declare(group, name, scope::Part::Place(id));
        let Ok(brackets) = brackets else { return };
        self.bind(id, &brackets);
        if self.drafts.is_draft {
            // The components in it are looked at by themselves.
            return;
        }
        self.frames[id.0 as usize].component = Some(brackets.component);
        self.declare_body(brackets.component, word, inside);
    }

    /// Declares the contents of a component, unless there are too many.
    pub fn declare_body(&mut self, component: u32, word: Span, inside: Environment) {
        let body: &'a [Decl] = &self.tree.component(component).body;
        let mut counted = self.counted;
        counted.add(body, 1);
        if let Some((limit, what)) = counted.exceeded_limit() {
            // Every later place is too much as well.
            if !std::mem::replace(&mut self.is_full, true) {
                self.report(Environment::TOP, NameError::TooManyInstances { span: word, limit, what });
            }
            return;
        }
        self.counted = counted;
        for decl in body {
            self.declare_value(Instance { decl, environment: inside });
        }
        for decl in body {
            let instance = Instance { decl, environment: inside };
            match decl.kind {
                DeclKind::Repeat { index } => self.count_and_unroll(self.tree.repeat(index), inside),
                // Reported where the component is declared.
                DeclKind::Param { .. } | DeclKind::Model { .. } | DeclKind::Gravity { .. } => {}
                DeclKind::Rare { index } => match self.tree.rare(index) {
                    Rare::Solve { .. }
                    | Rare::Optimum { .. }
                    | Rare::Correlate { .. }
                    | Rare::DampingModal { .. }
                    | Rare::DampingRayleigh { .. }
                    | Rare::RestAsDrawn => {}
                    _ => self.declare_part(instance),
                },
                _ => self.declare_part(instance),
            }
        }
    }

    pub fn component_named(&mut self, word: Span, environment: Environment) -> Option<u32> {
        let text = self.sources.slice(word);
        if let Some(&index) = self.known.by_name.get(&(word.file(), text)) {
            return (!self.known.broken[index as usize]).then_some(index);
        }
        if self.lacks_components || self.broken_words.contains(text) {
            return None;
        }
        let known = self.known.names.get(&word.file()).map_or(&[][..], Vec::as_slice);
        let suggestion = nearest(text, known.iter().copied()).map(str::to_string);
        let known = known.iter().take(8).map(|word| word.to_string()).collect();
        self.report(
            environment,
            PlaceError::UnknownComponent { span: word, word: text.to_string(), suggestion, known },
        );
        None
    }

    fn mirror(&mut self, placing: Placing, environment: Environment) -> Evaluated<[bool; 2]> {
        let Some(axis) = placing.mirrored else { return Ok([false, false]) };
        match self.sources.slice(axis) {
            "x" => Ok([true, false]),
            "y" => Ok([false, true]),
            _ => self.fail(environment, PlaceError::MirrorAxis { span: axis }),
        }
    }

    /// `at` and `turned` as definitions without a word: they are settled when they are needed, like any other.
    fn placing_definitions(
        &mut self,
        name: Name,
        span: Span,
        placing: Placing,
        environment: Environment,
    ) -> (Option<DefinitionId>, Option<DefinitionId>) {
        let mut define = |expr: Option<ExprId>, kind| {
            let expr = expr?;
            let id = DefinitionId(self.definitions.len() as u32);
            let (state, role) = (State::Unsettled, Role::Placing);
            self.definitions.push(Definition { kind, name, span, expr, environment, state, used: true, role });
            Some(id)
        };
        (define(placing.at, DefinitionKind::Point), define(placing.turned, DefinitionKind::Let))
    }

    // ---- Where a component lies ----

    /// The position and orientation of the component that contains an environment; `None` for the scene.
    pub fn placement(&mut self, environment: Environment) -> Evaluated<Option<Placed>> {
        match self.environments.frame(environment) {
            None => Ok(None),
            Some(frame) => loop {
                self.walk.depth = 0;
                match self.placed_frame(frame) {
                    Err(Stop::Deep) => self.evaluate_waiting(),
                    placed => return placed.map(Some),
                }
            },
        }
    }

    /// The frame of a place with its position; may be called in the middle of a walk.
    pub fn placed_frame(&mut self, id: FrameId) -> Evaluated<Placed> {
        if let Some(placed) = &self.frame(id).placed {
            return placed.clone();
        }
        let placed = self.place_frame(id);
        if !matches!(placed, Err(Stop::Deep)) {
            self.frames[id.0 as usize].placed = Some(placed.clone());
        }
        placed
    }

    fn place_frame(&mut self, id: FrameId) -> Evaluated<Placed> {
        let Frame { outer, span, .. } = *self.frame(id);
        let around = self.motion_around(id)?;
        let scene = match self.environments.frame(outer) {
            None => around.clone(),
            Some(frame) => match self.placed_frame(frame)?.scene.compose(&around) {
                Some(scene) => Arc::new(scene),
                None => return self.fail(outer, ValueError::Overflow { span }),
            },
        };
        Ok(Placed { around, scene })
    }

    /// The position and orientation of a place in the axes around it.
    fn motion_around(&mut self, id: FrameId) -> Evaluated<Arc<Motion>> {
        let Frame { at, turned, mirrored, outer, span, .. } = *self.frame(id);
        if (at, turned, mirrored) == (None, None, [false, false]) {
            // Rows of torsional or one-dimensional components have many of these.
            return Ok(self.unmoved.clone());
        }
        let origin = match at {
            None => None,
            Some(at) => match self.value_of(at, span, outer)? {
                Value::Vector(vector) => Some((*vector.si).clone()),
                Value::Scalar(_) => return Err(Stop::Reported),
            },
        };
        let Some(turned) = turned else { return Ok(Arc::new(Motion { mirrored, ..Motion::at_rest(origin) })) };
        let value = self.value_of(turned, span, outer)?;
        let expr = self.definitions[turned.0 as usize].expr;
        let angle = self.as_number(&value, expr, outer, &ANGLE)?;
        match angle.sin_cos() {
            Some((sine, cosine)) => Ok(Arc::new(Motion { origin, angle, sine, cosine, mirrored })),
            None => self.fail(outer, ValueError::Overflow { span: self.tree.expr(expr).span }),
        }
    }

    /// A place of a component in the scene.
    pub fn in_scene(&mut self, local: Arc<Vec3>, expr: ExprId, environment: Environment) -> Evaluated<Arc<Vec3>> {
        let Some(placed) = self.placement(environment)? else { return Ok(local) };
        match placed.scene.place(&local) {
            Some(place) => Ok(Arc::new(place)),
            None => {
                let needs = self.tree.expr(expr).span;
                Err(self.no_position(environment, needs))
            }
        }
    }

    /// Reports that a component has positions, but its place or one around it has none.
    fn no_position(&mut self, environment: Environment, needs: Span) -> Stop {
        let mut inner = self.environments.frame(environment);
        while let Some(frame) = inner {
            let Frame { at, outer, span, component, .. } = *self.frame(frame);
            if at.is_none() {
                let name = component.map_or("", |index| self.sources.slice(self.tree.component(index).name));
                let error = PlaceError::NoPosition { span, component: name.to_string(), needs };
                self.report(outer, error);
                break;
            }
            inner = self.environments.frame(outer);
        }
        Stop::Reported
    }

    /// A direction of a component in the scene.
    pub fn rotate_to_scene(&mut self, local: Arc<Vec3>, environment: Environment) -> Evaluated<Arc<Vec3>> {
        match self.placement(environment)? {
            Some(placed) if !placed.scene.keeps_directions() => Ok(Arc::new(placed.scene.direction(&local))),
            _ => Ok(local),
        }
    }

    /// Whether a counter-clockwise rotation in a component is clockwise in the scene.
    pub fn reverses(&mut self, environment: Environment) -> Evaluated<bool> {
        Ok(self.placement(environment)?.is_some_and(|placed| placed.scene.reverses()))
    }

    /// A place of a component as it is seen from an environment around it.
    fn seen_from(
        &mut self,
        mut frame: FrameId,
        mut place: Vec3,
        environment: Environment,
        needs: Span,
    ) -> Evaluated<Vec3> {
        let viewer = self.environments.frame(environment);
        if viewer.is_none() {
            let placed = self.placed_frame(frame)?;
            let inside = self.frame(frame).span;
            return match placed.scene.place(&place) {
                Some(place) => Ok(place),
                None => Err(self.no_position_of(frame, needs, inside)),
            };
        }
        loop {
            let placed = self.placed_frame(frame)?;
            place = match placed.around.place(&place) {
                Some(place) => place,
                None => return Err(self.no_position_of(frame, needs, self.frame(frame).span)),
            };
            let outer = self.environments.frame(self.frame(frame).outer);
            match outer {
                Some(outer) if Some(outer) != viewer => frame = outer,
                _ => return Ok(place),
            }
        }
    }

    fn no_position_of(&mut self, frame: FrameId, needs: Span, span: Span) -> Stop {
        let Frame { component, outer, .. } = *self.frame(frame);
        let name = component.map_or("", |index| self.sources.slice(self.tree.component(index).name));
        self.report(outer, PlaceError::NoPosition { span, component: name.to_string(), needs });
        Stop::Reported
    }

    // ---- Names behind the name of a place ----

    /// The place that an expression names: `front`, `outer.inner[2]`; `None` if it names something else.
    pub fn place_at(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Option<FrameId>> {
        if self.frames.is_empty() {
            return Ok(None);
        }
        let node = *self.tree.expr(expr);
        let (ident, place) = match node.kind {
            ExprKind::Name { indices } => {
                (Ident { span: self.word_of(node.span), indices }, self.place_of(environment))
            }
            ExprKind::Member { base, member_len, indices } => match self.place_at(base, environment)? {
                Some(frame) => (self.tree.member(base, member_len, indices), self.frame(frame).place),
                None => return Ok(None),
            },
            _ => return Ok(None),
        };
        let Some(symbol) = self.words.get(self.sources.slice(ident.span)) else { return Ok(None) };
        let name = self.evaluate_indexed(symbol, ident.indices, environment)?.in_place(place);
        match self.parts.get(name) {
            Some(scope::Part::Place(frame)) => Ok(Some(frame)),
            _ => Ok(None),
        }
    }

    /// Whether a member is a quantity of a component, such as `front.k`, and not a motion.
    pub fn is_value_of_place(&mut self, base: ExprId, environment: Environment) -> bool {
        matches!(self.place_at(base, environment), Ok(Some(_)))
    }

    /// `front.k` in an expression: a parameter, a point or a `let`.
    pub fn member_value(&mut self, frame: FrameId, member: Ident, environment: Environment) -> Evaluated<Value> {
        let id = self.member_definition(frame, member, environment)?;
        let span = self.ident_span(member);
        let value = self.value_of(id, span, environment)?;
        self.walk.varies |= !environment.is_top();
        let definition = &self.definitions[id.0 as usize];
        match (definition.kind, value) {
            (DefinitionKind::Point, Value::Vector(vector)) => {
                let place = (*vector.si).clone();
                let si = Arc::new(self.seen_from(frame, place, environment, span)?);
                Ok(Value::Vector(super::value::Vector { si, dimension: Some(Dimension::LENGTH) }))
            }
            (_, Value::Vector(_)) => {
                let (word, declared) = (self.sources.slice(span).to_string(), definition.span);
                self.fail(environment, PlaceError::VectorOfPlace { span, word, declared })
            }
            (_, value) => Ok(value),
        }
    }

    /// The parameter, point or `let` behind the name of a place.
    pub fn member_definition(
        &mut self,
        frame: FrameId,
        member: Ident,
        environment: Environment,
    ) -> Evaluated<DefinitionId> {
        const WANTED: &str = "parameter or point";
        let Some(name) = self.member_name(frame, member, environment)? else {
            return self.unknown_member(frame, member, WANTED, environment);
        };
        if let Some(id) = self.values.get(name) {
            return Ok(id);
        }
        match self.parts.get(name) {
            Some(part) => {
                let (word, found) = (self.words.display(name), self.noun_of(part));
                let (span, declared) = (self.ident_span(member), self.part_span(part));
                self.fail(environment, PlaceError::OtherMember { span, word, found, wanted: WANTED, declared })
            }
            None => self.unknown_member(frame, member, WANTED, environment),
        }
    }

    fn member_name(&mut self, frame: FrameId, member: Ident, environment: Environment) -> Evaluated<Option<Name>> {
        if self.frame(frame).component.is_none() {
            return Err(Stop::Reported);
        }
        let Some(symbol) = self.words.get(self.sources.slice(member.span)) else { return Ok(None) };
        let place = self.frame(frame).place;
        Ok(Some(self.evaluate_indexed(symbol, member.indices, environment)?.in_place(place)))
    }

    fn unknown_member<T>(
        &mut self,
        frame: FrameId,
        member: Ident,
        wanted: &'static str,
        environment: Environment,
    ) -> Evaluated<T> {
        let Frame { place, component: Some(component), .. } = *self.frame(frame) else { return Err(Stop::Reported) };
        let word = self.sources.slice(member.span);
        if self.broken_words.contains(word) {
            return Err(Stop::Reported);
        }
        let group = Group::of_component(component);
        let wants_value = wanted == "parameter or point";
        if let Some(name) = self.member_name(frame, member, environment)? {
            let written = (member, self.words.without_indices(name));
            let error = match wants_value {
                true => self.wrong_index_of(&self.values, Check::value_span, name, written, group),
                false => self.wrong_index_of(&self.parts, Check::part_span, name, written, group),
            };
            if let Some(error) = error {
                return self.fail(environment, error);
            }
        }
        let words: &[Symbol] = if wants_value { self.values.words(group) } else { self.parts.words(group) };
        let suggestion = nearest(word, words.iter().map(|symbol| self.words.text(*symbol))).map(str::to_string);
        let suggestion = suggestion.filter(|other| other != word);
        let of = self.words.place_name(place).map_or(String::new(), |name| self.words.display(name));
        let (span, word, component) = (self.ident_span(member), word.to_string(), self.tree.component(component).name);
        self.fail(environment, PlaceError::UnknownMember { span, word, of, component, wanted, suggestion })
    }

    /// The part that a path names, a port's own part in place of the port.
    pub fn path_part(&mut self, path: Path, environment: Environment, wanted: &'static str) -> Evaluated<scope::Part> {
        match path.whole {
            None => self.named_part(path.first, environment, wanted),
            Some(expr) => self.expression_part(expr, environment, wanted),
        }
    }

    /// The part that an expression names: `wheel`, `front.wheel`.
    pub fn expression_part(
        &mut self,
        expr: ExprId,
        environment: Environment,
        wanted: &'static str,
    ) -> Evaluated<scope::Part> {
        let node = *self.tree.expr(expr);
        match node.kind {
            ExprKind::Name { indices } => {
                let ident = Ident { span: self.word_of(node.span), indices };
                self.named_part(ident, environment, wanted)
            }
            ExprKind::Member { base, member_len, indices } => {
                let member = self.tree.member(base, member_len, indices);
                let frame = self.frame_before(base, environment)?;
                self.member_part(frame, member, environment, wanted)
            }
            _ => self.fail(environment, QuestionError::MotionOfWhat { span: node.span }),
        }
    }

    /// The place before a `.`.
    pub fn frame_before(&mut self, base: ExprId, environment: Environment) -> Evaluated<FrameId> {
        self.walk.depth = 0;
        if let Some(frame) = self.place_at(base, environment)? {
            return Ok(frame);
        }
        let node = *self.tree.expr(base);
        let word = match node.kind {
            ExprKind::Name { .. } => self.word_of(node.span),
            _ => node.span,
        };
        let text = self.sources.slice(word).to_string();
        let is_known = |check: &Check, name| check.parts.get(name).is_some() || check.values.get(name).is_some();
        match node.kind {
            ExprKind::Member { base, member_len, indices } => {
                // The word before it may already not be a place.
                let frame = self.frame_before(base, environment)?;
                let member = self.tree.member(base, member_len, indices);
                match self.member_name(frame, member, environment)? {
                    Some(name) if is_known(self, name) => {}
                    _ => return self.unknown_member(frame, member, "place", environment),
                }
            }
            ExprKind::Name { indices } => {
                let ident = Ident { span: word, indices };
                let name = self.name(ident, environment)?;
                if !is_known(self, name) {
                    let error = self.unknown_part(ident, name, "place", environment);
                    return self.fail_unless_broken(environment, word, error);
                }
            }
            _ => {}
        }
        self.fail(environment, PlaceError::NoPlace { span: word, word: text })
    }

    fn member_part(
        &mut self,
        frame: FrameId,
        member: Ident,
        environment: Environment,
        wanted: &'static str,
    ) -> Evaluated<scope::Part> {
        let Some(name) = self.member_name(frame, member, environment)? else {
            return self.unknown_member(frame, member, wanted, environment);
        };
        if let Some(part) = self.parts.get(name) {
            return self.resolve_port(part);
        }
        match self.values.get(name) {
            Some(id) => {
                let definition = &self.definitions[id.0 as usize];
                let found = super::error::kind_with_article(definition.kind);
                let (word, declared, span) = (self.words.display(name), definition.span, self.ident_span(member));
                self.fail(environment, PlaceError::OtherMember { span, word, found, wanted, declared })
            }
            None => self.unknown_member(frame, member, wanted, environment),
        }
    }

    // ---- Ports ----

    /// Looks at every port, used or not.
    pub fn tie_ports(&mut self) {
        for index in 0..self.ports.len() {
            let _ = self.port(index as u32);
        }
    }

    /// The part that a port is tied to; any other part is returned unchanged.
    pub fn resolve_port(&mut self, part: scope::Part) -> Evaluated<scope::Part> {
        match part {
            scope::Part::Port(port) => self.port(port),
            part => Ok(part),
        }
    }

    /// The argument of a port and the environment in which it is evaluated; `None` for other parts, and for a component
    /// that is placed alone.
    pub fn tied_to(&self, part: scope::Part) -> Option<(Environment, ExprId)> {
        match part {
            scope::Part::Port(port) => self.ports[port as usize].tied,
            _ => None,
        }
    }

    /// The number of the next port.
    pub fn ports_count(&self) -> u32 {
        self.ports.len() as u32
    }

    /// Adds a port that is tied to nothing.
    pub fn tie_to_nothing(&mut self, declared: Span) {
        self.ports.push(Port { tied: None, declared, part: None });
    }

    /// The place where a port is declared.
    pub fn port_span(&self, port: u32) -> Span {
        self.ports[port as usize].declared
    }

    /// The part that a port is tied to. Ports of ports are as many as components have levels.
    fn port(&mut self, index: u32) -> Evaluated<scope::Part> {
        let Port { tied, declared, part } = self.ports[index as usize].clone();
        if let Some(part) = part {
            return part;
        }
        let Some((outer, argument)) = tied else { return Err(Stop::Reported) };
        let part = self.port_argument(argument, declared, outer);
        self.ports[index as usize].part = Some(part);
        part
    }

    fn port_argument(&mut self, argument: ExprId, declared: Span, outer: Environment) -> Evaluated<scope::Part> {
        let node = *self.tree.expr(argument);
        let is_ground = matches!(node.kind, ExprKind::Name { indices } if indices.is_empty())
            && self.sources.slice(node.span) == "ground";
        if is_ground {
            return Ok(scope::Part::Ground);
        }
        let is_name = matches!(node.kind, ExprKind::Name { .. } | ExprKind::Member { .. });
        if !is_name {
            let port = self.sources.slice(declared).to_string();
            return self.fail(outer, PlaceError::NoPart { span: node.span, port, declared });
        }
        match self.expression_part(argument, outer, "body")? {
            part @ (scope::Part::Body(_) | scope::Part::Base(_) | scope::Part::Ground) => Ok(part),
            other => {
                let (word, found) = (self.sources.slice(node.span).to_string(), self.noun_of(other));
                let declared = self.part_span(other);
                self.fail(outer, PlaceError::PortKind { span: node.span, word, found, declared })
            }
        }
    }
}
