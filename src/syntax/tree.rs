//! The syntax tree: the text as written, with its places, before any name or unit is resolved.
//!
//! The tree is flat: nodes are stored in a few vectors and refer to each other by index; lists are ranges of those
//! vectors. So a file of a million declarations costs some three times its text, nothing in the tree is nested deeper
//! than the text itself (which the parser limits), and dropping it does not recurse. Texts are not copied: a node has a
//! [`Span`], and its words are read from the source.

use crate::base::{FileId, OrderBy, Span};
use crate::kinds::{ElementId, JointId};
use std::num::NonZeroU32;

/// One parsed file, with the components of the files that it uses.
#[derive(Clone, Debug)]
pub struct Tree {
    /// The file of the declarations; components may be in other files.
    pub file: FileId,
    /// Top-level declarations in order; the bodies of `repeat` are in [`Repeat::body`].
    pub decls: Vec<Decl>,
    /// Expressions; operands come before the expressions that use them.
    exprs: Vec<Expr>,
    /// Storage of every [`ExprList`]: the number of its items, then the items' indices into `exprs`.
    lists: Vec<ExprId>,
    pub fields: Vec<Field>,
    pub ends: Vec<End>,
    pub repeats: Vec<Repeat>,
    /// The components of all files.
    pub components: Vec<Component>,
    /// `use` lines of all files, file by file.
    pub uses: Vec<Use>,
    /// The parameters that `minimise` and `maximise` vary.
    pub varied: Vec<Varied>,
    /// The tolerances of parameters.
    pub tolerances: Vec<Tolerance>,
    /// Declarations that are too large or too rare to sit in [`DeclKind`].
    pub rare: Vec<Rare>,
    /// The `///` lines before a declaration: where the declaration starts, and their span; in order.
    docs: Vec<((FileId, u32), Span)>,
    /// Texts that are not declarations; the check reports nothing about names that occur in them.
    pub broken: Vec<Span>,
    /// Used files that contain text but no declaration.
    pub no_models: Vec<FileId>,
    /// Measures that are asked for from outside the model.
    pub asked: Vec<ExprId>,
}

/// An expression of the tree, see [`Tree::expr`]: an index plus one, so that `Option<ExprId>` is no larger.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ExprId(NonZeroU32);

/// A list of expressions, see [`Tree::list`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExprList(Option<ExprId>);

/// A range of [`Tree::fields`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fields {
    pub start: u32,
    pub len: u32,
}

/// Index into [`Tree::ends`]; the other end of a pair is the next one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EndId(pub u32);

/// A word with the expressions of its indices: `m[i-1]`. The span is the word's; indices have their own.
#[derive(Clone, Copy, Debug)]
pub struct Ident {
    pub span: Span,
    pub indices: ExprList,
}

/// A declaration.
#[derive(Clone, Copy, Debug)]
pub struct Decl {
    /// The declaration from its keyword to its last character.
    pub span: Span,
    pub kind: DeclKind,
}

#[derive(Clone, Copy, Debug)]
pub enum DeclKind {
    /// `model cart`
    Model { name: Span },
    /// `param k = 10 N/m within 5 %`: `tolerance` is an index into [`Tree::tolerances`].
    Param { name: Ident, value: ExprId, tolerance: Option<u32> },
    /// `let w = sqrt(k / m)`
    Let { name: Ident, value: ExprId },
    /// `gravity 9.81 m/s^2`, `gravity (0, -9.81 m/s^2)`
    Gravity { value: ExprId },
    /// `point A = (0, 0)`
    Point { name: Ident, value: ExprId },
    /// `body b { ... }`
    Body { name: Ident, fields: Fields },
    /// `spring s: a -- b { ... }`, `damper ...`, ...
    Element { kind: ElementId, name: Ident, ends: EndId, fields: Fields },
    /// `repeat i in 2..100 { ... }`: index into [`Tree::repeats`].
    Repeat { index: u32 },
    /// `component axle(m: kg) { ... }`: index into [`Tree::components`].
    Component { index: u32 },
    /// Index into [`Tree::rare`].
    Rare { index: u32 },
}

/// The declarations that a scene has few of.
#[derive(Clone, Copy, Debug)]
pub enum Rare {
    /// `pivot p: a@A -- b`, `slide g: a -- b along (1, 0)`, `weld w: a -- b`
    Joint { kind: JointId, name: Ident, ends: EndId, along: Option<ExprId> },
    /// `couple r: wheel.angle = -block.x / 0.3 m`
    Couple { name: Ident, left: ExprId, right: ExprId },
    /// `base floor { moves y }`, `base floor { moves y } = harmonic(1 mm, 30 Hz)`
    Base { name: Ident, fields: Fields, signal: Option<ExprId> },
    /// `force F: a@A along x = harmonic(10 N, 1.5 Hz)`, `force F: a -- b`
    Force { name: Ident, from: EndId, to: Option<EndId>, along: Option<ExprId>, signal: Option<ExprId> },
    /// `torque T: a`, `torque T: a -- b = step(1 N*m, 0 s)`
    Torque { name: Ident, from: EndId, to: Option<EndId>, signal: Option<ExprId> },
    /// `unbalance U: rotor@A { me = 0.01 kg*m, speed = 3000 rpm }`
    Unbalance { name: Ident, end: EndId, fields: Fields },
    /// `initial block { x = 16 mm, vx = 0.375 m/s }`
    Initial { body: Path, fields: Fields },
    /// `output theta = rod.angle`, `output tip in mm = rod@A.x`
    Output { name: Ident, unit: Option<Span>, value: ExprId },
    /// `damping modal 2 %`
    DampingModal { ratio: ExprId },
    /// `damping rayleigh(0.1 /s, 1e-4 s)`
    DampingRayleigh { arguments: ExprList },
    /// `rest as drawn`
    RestAsDrawn,
    /// `solve fn in 5 Hz .. 29 Hz: gain(floor -> table.y, 30 Hz) = -12 dB`
    Solve { parameter: Path, low: ExprId, high: ExprId, measure: ExprId, value: ExprId },
    /// `minimise peak_gain(F -> x) over c in 1 N*s/m .. 9 N*s/m while peak(y) < 20 mm`; `varied` are indices of [`Tree::varied`].
    Optimum { highest: bool, measure: ExprId, varied: (u32, u32), limits: ExprList },
    /// `correlate k, m 0.8`
    Correlate { first: Path, second: Path, coefficient: ExprId },
    /// `require frequency(1) > 2 Hz`, `require stable`
    Require { condition: ExprId },
    /// `place front = axle(m = 40 kg) at (1.2 m, 0) turned 10 deg`
    Place { name: Ident, component: Span, arguments: Fields, placing: Placing },
    /// `use "axles.vib"`: index into [`Tree::uses`].
    Use { index: u32 },
}

/// `spread 10 % within 30 %`, after the value of a `param`; at least one of the clauses is there.
#[derive(Clone, Copy, Debug)]
pub struct Tolerance {
    /// Both clauses, without the blank before them.
    pub span: Span,
    pub spread: Option<Spread>,
    /// The half-width, or the lower bound.
    pub within: Option<ExprId>,
    /// The upper bound of `within low .. high`.
    pub upper: Option<ExprId>,
}

/// The distribution that a `param` is drawn from.
#[derive(Clone, Copy, Debug)]
pub enum Spread {
    /// `spread 3 %`
    Normal(ExprId),
    /// `spread lognormal 3 %`
    Lognormal(ExprId),
    /// `spread uniform`
    Uniform,
}

/// `c in 1 N*s/m .. 100 N*s/m`
#[derive(Clone, Copy, Debug)]
pub struct Varied {
    pub parameter: Path,
    pub low: ExprId,
    pub high: ExprId,
}

/// The placement of a component: mirrored first, then turned, then moved.
#[derive(Clone, Copy, Debug, Default)]
pub struct Placing {
    /// `at (1.2 m, 0)`
    pub at: Option<ExprId>,
    /// `turned 10 deg`
    pub turned: Option<ExprId>,
    /// The axis of `mirrored x`.
    pub mirrored: Option<Span>,
}

/// `use "axles.vib"`
#[derive(Clone, Copy, Debug)]
pub struct Use {
    /// The file's name with its quotes.
    pub text: Span,
}

/// `component axle(part chassis, m: kg, k = 150 kN/m) { body }`
#[derive(Clone, Debug)]
pub struct Component {
    pub name: Span,
    pub formals: Vec<Formal>,
    pub body: Vec<Decl>,
}

/// A port or a parameter of a component.
#[derive(Clone, Copy, Debug)]
pub struct Formal {
    pub name: Span,
    pub kind: FormalKind,
}

#[derive(Clone, Copy, Debug)]
pub enum FormalKind {
    /// `part chassis`
    Port,
    /// `m: kg`, `k = 150 kN/m`: the unit that says the dimension, and the default.
    Number { unit: Option<Span>, default: Option<ExprId> },
}

/// A name of the scene, or one behind the name of a place.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// The first name.
    pub first: Ident,
    /// The whole path as a [`ExprKind::Member`], if it has more than one name.
    pub whole: Option<ExprId>,
}

/// `repeat i in first..last { body }`, bounds included.
#[derive(Clone, Debug)]
pub struct Repeat {
    pub index: Span,
    pub first: ExprId,
    pub last: ExprId,
    pub body: Vec<Decl>,
}

/// One end of an element, joint or input: `block`, `block@A`, `ground@(0, 1 m)`.
#[derive(Clone, Copy, Debug)]
pub struct End {
    /// The end, from its part to its point.
    pub span: Span,
    /// Bytes of the part's first word.
    pub(super) word_len: u16,
    pub(super) indices: ExprList,
    pub(super) whole: Option<ExprId>,
    /// The expression after `@`.
    pub at: Option<ExprId>,
}

impl End {
    /// The part as named.
    pub fn part(&self) -> Path {
        let start = self.span.start();
        let span = Span::new(self.span.file(), start, start + usize::from(self.word_len));
        Path { first: Ident { span, indices: self.indices }, whole: self.whole }
    }
}

/// A field in braces: `mass = 1 kg`, `moves x y`, `inertia = 1 kg*m^2 about A`.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// The field's word: `mass`, `moves`, `turns`, `free`.
    pub key: Span,
    pub value: FieldValue,
}

impl Field {
    /// The words after `moves`, with blanks between them.
    pub fn directions(&self) -> Option<Span> {
        let FieldValue::Moves { start, len } = self.value else { return None };
        Some(Span::new(self.key.file(), start as usize, start as usize + usize::from(len)))
    }
}

#[derive(Clone, Copy, Debug)]
pub enum FieldValue {
    /// `mass = 1 kg`
    Expr(ExprId),
    /// `inertia = 0.8 kg*m^2 about A`: value and point, see [`Tree::about_parts`]. It is rare, so it is stored as a list to
    /// keep fields small.
    About(ExprList),
    /// A word alone: `turns`, `free`.
    Flag,
    /// `moves x`, `moves y`, `moves x y`: where the words after `moves` are, see [`Field::directions`]. The length saturates: so many
    /// words are a mistake in any case.
    Moves { start: u32, len: u16 },
    /// `moves along (1, 1)`
    MovesAlong(ExprId),
}

#[derive(Clone, Copy, Debug)]
pub struct Expr {
    pub span: Span,
    pub kind: ExprKind,
}

#[derive(Clone, Copy, Debug)]
pub enum ExprKind {
    /// A number with or without a unit; the first `number_len` bytes of the span are the number, the unit follows
    /// after at most one space.
    Literal {
        number_len: u16,
    },
    /// `k`, `m[i-1]`, `pi`, `table`, `stable`; the word's length is the rest of the span before the first `[`.
    Name {
        indices: ExprList,
    },
    /// `"file.csv"`, quotes included in the span.
    Text,
    /// `-x`
    Negate {
        operand: ExprId,
    },
    Binary {
        operator: Binary,
        left: ExprId,
        right: ExprId,
    },
    /// `sqrt(x)`, `rod(A, B)`, `gain(u -> y, f)`; `name_len` bytes of the span are the function's word.
    Call {
        name_len: u16,
        arguments: ExprList,
    },
    /// `(x, y)`; a parenthesised expression is the expression itself.
    Tuple {
        items: ExprList,
    },
    /// `rod.angle`, `front.m[3]`: the member's word is `member_len` bytes long and begins behind the dot that follows the
    /// base, see [`Tree::member`].
    Member {
        base: ExprId,
        member_len: u16,
        indices: ExprList,
    },
    /// `rod@(0, -2 m)`, before a member.
    At {
        base: ExprId,
        point: ExprId,
    },
    /// `1 Hz .. 50 Hz`, an argument of a call.
    Range {
        low: ExprId,
        high: ExprId,
    },
    /// `speed = 20 m/s` or `white 3 N^2/Hz`, an argument of a call.
    Named {
        name_len: u16,
        value: ExprId,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    /// `floor -> table.y`
    Arrow,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    /// `==` is not an operator of the language; it is parsed so that its message can be a good one.
    Equal,
}

/// The lengths of the arenas at some point, so that what is appended later can be removed.
pub(super) struct Mark {
    exprs: usize,
    lists: usize,
    fields: usize,
    ends: usize,
    uses: usize,
    varied: usize,
    tolerances: usize,
    rare: usize,
}

impl Tree {
    pub fn new(file: FileId) -> Tree {
        Tree {
            file,
            decls: Vec::new(),
            exprs: Vec::new(),
            lists: Vec::new(),
            fields: Vec::new(),
            ends: Vec::new(),
            repeats: Vec::new(),
            components: Vec::new(),
            uses: Vec::new(),
            varied: Vec::new(),
            tolerances: Vec::new(),
            rare: Vec::new(),
            docs: Vec::new(),
            broken: Vec::new(),
            no_models: Vec::new(),
            asked: Vec::new(),
        }
    }

    pub fn expr(&self, id: ExprId) -> &Expr {
        &self.exprs[id.index()]
    }

    /// Any expression; `None` in a tree without expressions.
    pub fn any_expr(&self) -> Option<ExprId> {
        (!self.exprs.is_empty()).then_some(ExprId(NonZeroU32::MIN))
    }

    /// The names without indices in a piece of text, once for each occurrence.
    pub fn names_within(&self, span: Span) -> impl Iterator<Item = Span> {
        let inside =
            move |own: Span| own.file() == span.file() && span.start() <= own.start() && own.end() <= span.end();
        let is_name = |kind: &ExprKind| matches!(kind, ExprKind::Name { indices } if indices.is_empty());
        self.exprs.iter().filter(move |expr| inside(expr.span) && is_name(&expr.kind)).map(|expr| expr.span)
    }

    /// The first words of the ends in a piece of text: `chassis` of `chassis@(0, 1 m)`.
    pub fn ends_within(&self, span: Span) -> impl Iterator<Item = Span> {
        let inside =
            move |own: Span| own.file() == span.file() && span.start() <= own.start() && own.end() <= span.end();
        self.ends.iter().filter(move |end| inside(end.span)).map(|end| end.part().first.span)
    }

    /// Every text in quotes, quotes included, in the order of the file: the names of tables.
    pub fn texts(&self) -> impl Iterator<Item = Span> {
        self.exprs.iter().filter(|expr| matches!(expr.kind, ExprKind::Text)).map(|expr| expr.span)
    }

    /// The member of a [`ExprKind::Member`] with that base.
    pub fn member(&self, base: ExprId, member_len: u16, indices: ExprList) -> Ident {
        let base = self.expr(base).span;
        let start = base.end() + 1;
        Ident { span: Span::new(base.file(), start, start + usize::from(member_len)), indices }
    }

    /// Every word after a dot, in the order of the file.
    pub fn members(&self) -> impl Iterator<Item = Span> {
        self.exprs.iter().filter_map(|expr| match expr.kind {
            ExprKind::Member { base, member_len, indices } => Some(self.member(base, member_len, indices).span),
            _ => None,
        })
    }

    pub fn list(&self, list: ExprList) -> &[ExprId] {
        let Some(head) = list.0 else { return &[] };
        let start = head.index() + 1;
        &self.lists[start..start + self.lists[head.index()].0.get() as usize]
    }

    /// The value and the point of a [`FieldValue::About`].
    pub fn about_parts(&self, list: ExprList) -> (ExprId, ExprId) {
        let items = self.list(list);
        (items[0], items[1])
    }

    pub fn fields(&self, fields: Fields) -> &[Field] {
        &self.fields[fields.start as usize..(fields.start + fields.len) as usize]
    }

    pub fn end(&self, id: EndId) -> &End {
        &self.ends[id.0 as usize]
    }

    /// Both ends of an element or joint.
    pub fn pair(&self, first: EndId) -> (&End, &End) {
        (self.end(first), self.end(EndId(first.0 + 1)))
    }

    pub fn repeat(&self, index: u32) -> &Repeat {
        &self.repeats[index as usize]
    }

    pub fn rare(&self, index: u32) -> &Rare {
        &self.rare[index as usize]
    }

    /// The `///` lines before a declaration, slashes included, from the first to the end of the last.
    pub fn doc(&self, decl: &Decl) -> Option<Span> {
        let place = (decl.span.file(), decl.span.start() as u32);
        let at = self.docs.binary_search_by_key(&place, |(start, _)| *start).ok()?;
        Some(self.docs[at].1)
    }

    /// The parameters that a [`Rare::Optimum`] varies.
    pub fn varied_parameters(&self, (start, end): (u32, u32)) -> &[Varied] {
        &self.varied[start as usize..end as usize]
    }

    pub fn component(&self, index: u32) -> &Component {
        &self.components[index as usize]
    }

    /// The component of this file that a word names.
    pub fn components_of(&self, file: FileId) -> impl Iterator<Item = (u32, &Component)> {
        (0..).zip(&self.components).filter(move |(_, component)| component.name.file() == file)
    }

    /// Reserves room for the rest of the file, estimated from the part that is parsed: `done` of `total` bytes. An arena
    /// that doubles whenever it is full would hold up to twice what it needs, and old and new memory side by side while
    /// it is copied.
    pub(super) fn make_room(&mut self, done: usize, total: usize) {
        reserve_for_rest(&mut self.decls, done, total);
        reserve_for_rest(&mut self.exprs, done, total);
        reserve_for_rest(&mut self.lists, done, total);
        reserve_for_rest(&mut self.fields, done, total);
        reserve_for_rest(&mut self.ends, done, total);
    }

    pub(super) fn push_expr(&mut self, expr: Expr) -> ExprId {
        self.exprs.push(expr);
        ExprId::at(self.exprs.len() - 1)
    }

    pub(super) fn push_list(&mut self, items: &[ExprId]) -> ExprList {
        let Some(count) = NonZeroU32::new(items.len() as u32) else { return ExprList::EMPTY };
        self.lists.push(ExprId(count));
        self.lists.extend_from_slice(items);
        ExprList(Some(ExprId::at(self.lists.len() - 1 - items.len())))
    }

    pub(super) fn mark(&self) -> Mark {
        Mark {
            exprs: self.exprs.len(),
            lists: self.lists.len(),
            fields: self.fields.len(),
            ends: self.ends.len(),
            uses: self.uses.len(),
            varied: self.varied.len(),
            tolerances: self.tolerances.len(),
            rare: self.rare.len(),
        }
    }

    pub(super) fn truncate(&mut self, mark: Mark) {
        self.exprs.truncate(mark.exprs);
        self.lists.truncate(mark.lists);
        self.fields.truncate(mark.fields);
        self.ends.truncate(mark.ends);
        self.uses.truncate(mark.uses);
        self.varied.truncate(mark.varied);
        self.tolerances.truncate(mark.tolerances);
        self.rare.truncate(mark.rare);
    }

    /// Docs come in the order of the text, file by file.
    pub(super) fn push_doc(&mut self, decl_start: usize, doc: Span) {
        self.docs.push(((doc.file(), decl_start as u32), doc));
    }

    /// Sorts the doc comments of this file by position, before another file is parsed.
    pub(super) fn sort_docs(&mut self) {
        self.docs.order_by_key(|(start, _)| *start);
    }
}

impl ExprId {
    fn at(index: usize) -> ExprId {
        let number = u32::try_from(index + 1).ok().and_then(NonZeroU32::new);
        ExprId(number.expect("the limit of a file's size keeps its expressions below 2^32"))
    }

    pub fn index(self) -> usize {
        self.0.get() as usize - 1
    }
}

impl ExprList {
    pub const EMPTY: ExprList = ExprList(None);

    pub fn is_empty(self) -> bool {
        self.0.is_none()
    }
}

/// Room reserved in advance: more than nearly any single declaration needs.
const AT_ONCE: usize = 64;

fn reserve_for_rest<T>(arena: &mut Vec<T>, done: usize, total: usize) {
    if arena.capacity() - arena.len() >= AT_ONCE || arena.is_empty() && done > 0 {
        return;
    }
    // At the rate so far for the rest of the file, and a little more, since the rate varies; at most eight times the
    // present length, since the start of a file is not representative. Memory that is reserved and never used is never
    // touched.
    let expected = arena.len() as u128 * total as u128 * 33 / (done.max(1) as u128 * 32);
    let most = arena.len() * 8;
    arena.reserve_exact(AT_ONCE + (expected.min(most as u128) as usize).saturating_sub(arena.len()));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_stay_small() {
        assert_eq!(std::mem::size_of::<Decl>(), 36);
        assert_eq!(std::mem::size_of::<Expr>(), 20);
        assert_eq!(std::mem::size_of::<Field>(), 16);
        assert_eq!(std::mem::size_of::<End>(), 24);
    }
}
