//! Names and their declarations, with `repeat` unrolled. In: the tree. Out: for each kind of declaration its instances
//! in order, and the two name spaces (spec.md#names): values (parameters, points, indices) and parts.
//!
//! A scene of a million bodies is a `repeat` of a few lines, so an instance is a reference to its declaration and the
//! environment with the values of the indices: sixteen bytes.

use super::evaluate::Evaluated;
use super::places::FrameId;
use super::value::Value;
use crate::base::{Name, Place, Span, Symbol};
use crate::syntax::tree::{Decl, ExprId};
use std::borrow::Cow;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// The values of the indices around a declaration: index into [`Environments`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Environment(u32);

/// One index of a `repeat` with its value, inside another environment; or the inside of a placed component, from which
/// nothing around it is visible.
#[derive(Clone, Copy, Debug)]
struct Binding {
    outer: Environment,
    index: Option<(Symbol, i32)>,
    frame: Option<FrameId>,
}

/// Every repetition of the model.
#[derive(Debug, Default)]
pub struct Environments {
    bindings: Vec<Binding>,
}

impl Environment {
    /// Outside of every `repeat`.
    pub const TOP: Environment = Environment(0);

    pub fn is_top(self) -> bool {
        self == Environment::TOP
    }
}

impl Environments {
    pub fn bind(&mut self, outer: Environment, symbol: Symbol, value: i32) -> Environment {
        let frame = self.frame(outer);
        self.push(Binding { outer, index: Some((symbol, value)), frame })
    }

    /// The inside of a component at one of its places.
    pub fn enter(&mut self, frame: FrameId) -> Environment {
        self.push(Binding { outer: Environment::TOP, index: None, frame: Some(frame) })
    }

    /// The place of the component that a declaration belongs to; `None` for the scene.
    pub fn frame(&self, environment: Environment) -> Option<FrameId> {
        self.innermost(environment)?.frame
    }

    fn push(&mut self, binding: Binding) -> Environment {
        self.bindings.push(binding);
        Environment(u32::try_from(self.bindings.len()).expect("the number of repetitions is limited far below"))
    }

    /// The number of bindings, for [`Environments::release`].
    pub fn mark(&self) -> usize {
        self.bindings.len()
    }

    /// Drops the bindings made since the mark.
    pub fn release(&mut self, mark: usize) {
        self.bindings.truncate(mark);
    }

    /// The innermost index and its value.
    fn innermost(&self, environment: Environment) -> Option<&Binding> {
        self.bindings.get((environment.0 as usize).checked_sub(1)?)
    }

    /// The bindings from the innermost outwards.
    fn chain(&self, environment: Environment) -> impl Iterator<Item = (Symbol, i32)> {
        std::iter::successors(self.innermost(environment), |binding| self.innermost(binding.outer))
            .filter_map(|binding| binding.index)
    }

    pub fn value(&self, environment: Environment, symbol: Symbol) -> Option<i32> {
        self.chain(environment).find(|(known, _)| *known == symbol).map(|(_, value)| value)
    }

    /// Indices and values from the outermost inwards.
    pub fn indices(&self, environment: Environment) -> Vec<(Symbol, i32)> {
        let mut indices: Vec<_> = self.chain(environment).collect();
        indices.reverse();
        indices
    }
}

/// Names in order of declaration: as long as none has indices or is in a component, their words alone.
#[derive(Debug)]
pub enum Names {
    Words(Vec<Symbol>),
    Any(Vec<Name>),
}

impl Default for Names {
    fn default() -> Names {
        Names::Words(Vec::new())
    }
}

impl Names {
    pub fn push(&mut self, name: Name) {
        match self {
            Names::Words(words) if name.is_plain() => words.push(name.symbol),
            Names::Words(words) => {
                *self = Names::Any(words.iter().map(|word| Name::plain(*word)).chain([name]).collect());
            }
            Names::Any(names) => names.push(name),
        }
    }

    pub fn at(&self, index: usize) -> Name {
        match self {
            Names::Words(words) => Name::plain(words[index]),
            Names::Any(names) => names[index],
        }
    }
}

/// A declaration in one repetition.
#[derive(Clone, Copy, Debug)]
pub struct Instance<'a> {
    pub decl: &'a Decl,
    pub environment: Environment,
}

/// The kind of declaration behind a name of the first name space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DefinitionKind {
    Param,
    Let,
    Point,
}

/// Index into `Check::definitions`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DefinitionId(pub u32);

/// A `param`, `let` or `point`.
#[derive(Clone, Debug)]
pub struct Definition {
    pub kind: DefinitionKind,
    pub name: Name,
    /// The span of the word that it declares.
    pub span: Span,
    pub expr: ExprId,
    /// The environment in which the expression is evaluated; for an argument of a place, the one outside the component.
    pub environment: Environment,
    pub state: State,
    pub used: bool,
    pub role: Role,
}

/// The origin of a definition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A declaration of its own.
    Declared,
    /// A parameter of a component: at which place, which, and whether the place gives its value.
    Parameter { frame: FrameId, formal: u32, given: bool },
    /// `at` or `turned` of a place.
    Placing,
}

#[derive(Clone, Debug)]
pub enum State {
    Unsettled,
    InProgress,
    Settled(Evaluated<Value>),
}

/// The part behind a name of the second name space: an index into the instances of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    Body(u32),
    Base(u32),
    Joint(u32),
    Couple(u32),
    Element(u32),
    /// A force or torque: its index in [`Instances::inputs`].
    Input(u32),
    Output(u32),
    /// A component at one of its places.
    Place(FrameId),
    /// A part that a component ties to.
    Port(u32),
    /// The ground, a possible target of a port like bodies and bases.
    Ground,
}

/// The scope of the words that messages suggest: the scene, or a component at all its places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Group(u32);

impl Group {
    pub const SCENE: Group = Group(0);

    pub fn of_component(index: u32) -> Group {
        Group(index + 1)
    }
}

/// The indices with which a word was declared.
#[derive(Clone, Debug)]
pub struct Family<T> {
    /// What a declaration of the word declares.
    pub first: T,
    /// Least and greatest value of each index.
    pub ranges: Vec<(i32, i32)>,
}

/// A name space.
///
/// The names that a `repeat` declares come in runs: `m[1]`, `m[2]`, ... A run is found by the name without its last
/// index and is an array from there. The names that places of one component declare form runs too: the wheel of its
/// first place, of its second, ... A name that fits no run has an entry of its own.
#[derive(Debug)]
pub struct Space<T> {
    runs: Table<Name, Run<T>>,
    /// The names without indices in the scene, by word: a file that is written out has nothing else.
    plain: Vec<Option<T>>,
    /// The names without indices in places, by component and word: runs over the places of the component.
    columns: Table<(Group, Symbol), Run<T>>,
    /// The places that declare something.
    members: Members,
    others: Table<Name, T>,
    families: Table<(Group, Symbol), Family<T>>,
    /// Words in order of declaration, for suggestions.
    words: Table<Group, Vec<Symbol>>,
}

/// Names that differ in their last index, or in the number of their place among those of a component, which increases
/// by one.
#[derive(Debug)]
struct Run<T> {
    first: i32,
    items: Vec<T>,
}

/// For each place in which something is declared: its component, and its number among the places of that component.
#[derive(Debug, Default)]
struct Members {
    by_place: Vec<Option<(Group, i32)>>,
    counts: Table<Group, i32>,
}

impl Members {
    fn get(&self, place: Place) -> Option<(Group, i32)> {
        *self.by_place.get(place.index()?)?
    }

    /// Assigns a number to the place, unless it has one; `None` for the scene, which is unique.
    fn enter(&mut self, place: Place, group: Group) -> Option<(Group, i32)> {
        let index = place.index()?;
        if index >= self.by_place.len() {
            self.by_place.resize(index + 1, None);
        }
        if self.by_place[index].is_none() {
            let count = self.counts.entry(group).or_default();
            self.by_place[index] = Some((group, *count));
            *count += 1;
        }
        self.by_place[index]
    }
}

impl<T> Default for Space<T> {
    fn default() -> Space<T> {
        Space {
            runs: Table::default(),
            plain: Vec::new(),
            columns: Table::default(),
            members: Members::default(),
            others: Table::default(),
            families: Table::default(),
            words: Table::default(),
        }
    }
}

impl<T: Copy> Space<T> {
    pub fn get(&self, name: Name) -> Option<T> {
        if name.is_plain() {
            return self.plain(name.symbol);
        }
        let in_run = match split_last(name) {
            Some((run, last)) => self.runs.get(&run).and_then(|run| run.get(last)),
            None => self
                .members
                .get(name.place)
                .and_then(|(group, number)| self.columns.get(&(group, name.symbol))?.get(number)),
        };
        in_run.or_else(|| self.others.get(&name).copied())
    }

    /// Declares a name; if it is taken, returns its present meaning.
    pub fn declare(&mut self, group: Group, name: Name, what: T) -> Result<(), T> {
        if let Some(continued) = self.next_of_run(name, what) {
            continued?;
            self.widen_family(group, name, what);
            return Ok(());
        }
        if let Some(first) = self.get(name) {
            return Err(first);
        }
        if name.is_plain() {
            self.declare_plain(name.symbol, what);
            return Ok(());
        }
        if !self.extend_run(group, name, what) {
            self.others.insert(name, what);
        }
        self.widen_family(group, name, what);
        Ok(())
    }

    /// Appends a name of the scene to the run that it continues, as nearly all names of a `repeat` do, with one look into the
    /// table; `None` if it continues none.
    fn next_of_run(&mut self, name: Name, what: T) -> Option<Result<(), T>> {
        if name.place != Place::SCENE || !self.others.is_empty() {
            return None;
        }
        let (run, last) = split_last(name)?;
        let run = self.runs.get_mut(&run)?;
        match run.get(last) {
            Some(first) => Some(Err(first)),
            None => run.push(last, what).then_some(Ok(())),
        }
    }

    fn plain(&self, symbol: Symbol) -> Option<T> {
        *self.plain.get(symbol.index())?
    }

    /// Declares a word without indices in the scene. It is a family of its own, unless the word was declared with indices
    /// before.
    fn declare_plain(&mut self, symbol: Symbol, what: T) {
        if self.plain.len() <= symbol.index() {
            self.plain.resize(symbol.index() + 1, None);
        }
        self.plain[symbol.index()] = Some(what);
        if !self.families.contains_key(&(Group::SCENE, symbol)) {
            self.words.entry(Group::SCENE).or_default().push(symbol);
        }
    }

    /// Appends to the run that the name continues or begins; `false` if there is no such run.
    fn extend_run(&mut self, group: Group, name: Name, what: T) -> bool {
        let member = self.members.enter(name.place, group);
        match (split_last(name), member) {
            (Some((run, last)), _) => self.runs.entry(run).or_insert_with(|| Run::from(last)).push(last, what),
            (None, Some((group, number))) => {
                let column = self.columns.entry((group, name.symbol)).or_insert_with(|| Run::from(number));
                column.push(number, what)
            }
            (None, None) => false,
        }
    }

    fn widen_family(&mut self, group: Group, name: Name, what: T) {
        if group == Group::SCENE
            && self.plain(name.symbol).is_some()
            && !self.families.contains_key(&(group, name.symbol))
        {
            return;
        }
        let words = &mut self.words;
        let family = self.families.entry((group, name.symbol)).or_insert_with(|| {
            words.entry(group).or_default().push(name.symbol);
            Family { first: what, ranges: name.indices().iter().map(|&index| (index, index)).collect() }
        });
        for ((low, high), &index) in family.ranges.iter_mut().zip(name.indices()) {
            *low = index.min(*low);
            *high = index.max(*high);
        }
    }

    /// The indices with which a word is declared; `None` if it is not declared.
    pub fn family(&self, group: Group, symbol: Symbol) -> Option<Cow<'_, Family<T>>> {
        let indexed = self.families.get(&(group, symbol)).map(Cow::Borrowed);
        let plain = |first: T| Cow::Owned(Family { first, ranges: Vec::new() });
        indexed.or_else(|| self.plain(symbol).filter(|_| group == Group::SCENE).map(plain))
    }

    /// The indices with which a word is declared in the place of a name; `None` if it is not declared there.
    pub fn ranges(&self, group: Group, name: Name) -> Option<Vec<(i32, i32)>> {
        let all = self.family(group, name.symbol)?;
        if name.place == Place::SCENE || all.ranges.len() != 1 {
            return Some(all.into_owned().ranges);
        }
        // Another place of the component may have more.
        let run = self.runs.get(&Name::plain(name.symbol).in_place(name.place))?;
        Some(vec![(run.first, run.first + run.items.len() as i32 - 1)])
    }

    pub fn words(&self, group: Group) -> &[Symbol] {
        self.words.get(&group).map_or(&[], Vec::as_slice)
    }
}

impl<T: Copy> Run<T> {
    fn from(first: i32) -> Run<T> {
        Run { first, items: Vec::new() }
    }

    /// Appends an item, if it is the next one.
    fn push(&mut self, index: i32, item: T) -> bool {
        let follows = self.next() == i64::from(index);
        if follows {
            self.items.push(item);
        }
        follows
    }

    fn get(&self, index: i32) -> Option<T> {
        let place = i64::from(index) - i64::from(self.first);
        self.items.get(usize::try_from(place).ok()?).copied()
    }

    /// The index that would continue the run.
    fn next(&self) -> i64 {
        i64::from(self.first) + self.items.len() as i64
    }
}

/// The name without its last index, and that index.
fn split_last(name: Name) -> Option<(Name, i32)> {
    let (last, most) = name.indices().split_last()?;
    Some((Name::with_indices(name.symbol, most)?.in_place(name.place), *last))
}

/// Multiply and rotate, as in rustc's own tables: names are a few small integers, and the tables are never iterated.
#[derive(Clone, Copy, Debug, Default)]
pub struct NameHasher(u64);

/// 2^64 divided by the golden ratio, rounded to an odd number.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

impl NameHasher {
    #[inline]
    fn mix(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(GOLDEN);
    }
}

impl Hasher for NameHasher {
    #[inline]
    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.mix(u64::from_le_bytes(word));
        }
    }

    #[inline]
    fn write_u8(&mut self, n: u8) {
        self.mix(u64::from(n));
    }

    #[inline]
    fn write_u32(&mut self, n: u32) {
        self.mix(u64::from(n));
    }

    #[inline]
    fn write_usize(&mut self, n: usize) {
        self.mix(n as u64);
    }

    /// The multiplication leaves the best bits on top, but the table uses the lowest bits too.
    #[inline]
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }
}

/// A table with small integers as keys.
pub type Table<K, V> = HashMap<K, V, BuildHasherDefault<NameHasher>>;
