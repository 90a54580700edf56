//! The syntax tree: what was written, with its places, before any name or unit is looked at.
//!
//! The tree is flat: nodes sit in a few vectors and refer to each other by index, lists are ranges of those vectors.
//! So a file of a million declarations costs some three times its text, nothing in it is deeper than the text's own
//! nesting (which the parser limits), and dropping it recurses into nothing. Texts are not copied: a node has a [`Span`]
//! and its words are read from the source.

use crate::base::{FileId, Span};

/// One parsed file.
#[derive(Clone, Debug)]
pub struct Tree {
    pub file: FileId,
    /// Top-level declarations in order; the bodies of `repeat` are in [`Repeat::body`].
    pub decls: Vec<Decl>,
    pub exprs: Vec<Expr>,
    /// Storage of every [`ExprList`].
    pub expr_lists: Vec<ExprId>,
    pub fields: Vec<Field>,
    pub ends: Vec<End>,
    pub repeats: Vec<Repeat>,
    /// Declarations that are too large or too rare to sit in [`DeclKind`].
    pub rare: Vec<Rare>,
}

/// Index into [`Tree::exprs`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ExprId(pub u32);

/// A range of [`Tree::expr_lists`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExprList {
    pub start: u32,
    pub len: u32,
}

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
    /// From the keyword to the last character.
    pub span: Span,
    /// The `///` lines before it, as one span; `None` without.
    pub doc: Option<DocSpan>,
    pub kind: DeclKind,
}

/// Bytes between a declaration's start and the start of its doc comment: the comment ends where the declaration starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DocSpan(pub std::num::NonZeroU32);

#[derive(Clone, Copy, Debug)]
pub enum DeclKind {
    /// `model cart`
    Model { name: Span },
    /// `param k = 10 N/m`
    Param { name: Ident, value: ExprId },
    /// `let w = sqrt(k / m)`
    Let { name: Ident, value: ExprId },
    /// `gravity 9.81 m/s^2`, `gravity (0, -9.81 m/s^2)`
    Gravity { value: ExprId },
    /// `point A = (0, 0)`
    Point { name: Ident, value: ExprId },
    /// `body b { ... }`
    Body { name: Ident, fields: Fields },
    /// `spring s: a -- b { ... }`, `damper ...`
    Element { kind: ElementKeyword, name: Ident, ends: EndId, fields: Fields },
    /// `repeat i in 2..100 { ... }`: index into [`Tree::repeats`].
    Repeat { index: u32 },
    /// Index into [`Tree::rare`].
    Rare { index: u32 },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementKeyword {
    Spring,
    Damper,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKeyword {
    Pivot,
    Slide,
    Weld,
}

/// The declarations of which a scene has few.
#[derive(Clone, Copy, Debug)]
pub enum Rare {
    /// `pivot p: a@A -- b`, `slide g: a -- b along (1, 0)`, `weld w: a -- b`
    Joint { kind: JointKeyword, name: Ident, ends: EndId, along: Option<ExprId> },
    /// `couple r: wheel.angle = -block.x / 0.3 m`
    Couple { name: Ident, left: ExprId, right: ExprId },
    /// `base floor { moves y }`, `base floor { moves y } = harmonic(1 mm, 30 Hz)`
    Base { name: Ident, fields: Fields, signal: Option<ExprId> },
    /// `force F: a@A along x = harmonic(10 N, 1.5 Hz)`, `force F: a -- b`
    Force { name: Ident, from: EndId, to: Option<EndId>, along: Option<ExprId>, signal: Option<ExprId> },
    /// `torque T: a`, `torque T: a -- b = step(1 N*m, 0 s)`
    Torque { name: Ident, from: EndId, to: Option<EndId>, signal: Option<ExprId> },
    /// `initial block { x = 16 mm, vx = 0.375 m/s }`
    Initial { body: Ident, fields: Fields },
    /// `output theta = rod.angle`
    Output { name: Ident, value: ExprId },
    /// `damping modal 2 %`
    DampingModal { ratio: ExprId },
    /// `damping rayleigh(0.1 /s, 1e-4 s)`
    DampingRayleigh { arguments: ExprList },
    /// `rest as drawn`
    RestAsDrawn,
    /// `solve fn in 5 Hz .. 29 Hz: gain(floor -> table.y, 30 Hz) = -12 dB`
    Solve { parameter: Ident, low: ExprId, high: ExprId, measure: ExprId, value: ExprId },
    /// `require frequency(1) > 2 Hz`, `require stable`
    Require { condition: ExprId },
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
    /// From the part to the point.
    pub span: Span,
    pub part: Ident,
    /// The expression after `@`.
    pub at: Option<ExprId>,
}

/// What stands in braces: `mass = 1 kg`, `moves x y`, `inertia = 1 kg*m^2 about A`.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// The field's word: `mass`, `moves`, `turns`, `free`.
    pub key: Span,
    pub value: FieldValue,
}

#[derive(Clone, Copy, Debug)]
pub enum FieldValue {
    /// `mass = 1 kg`
    Expr(ExprId),
    /// `inertia = 0.8 kg*m^2 about A`
    About(ExprId, ExprId),
    /// A word alone: `turns`, `free`.
    Flag,
    /// `moves x`, `moves y`, `moves x y`: the words after `moves`, each an [`ExprKind::Name`].
    Moves(ExprList),
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
    /// `rod.angle`: the member's span is the end of this one's, `member_len` bytes long.
    Member {
        base: ExprId,
        member_len: u16,
    },
    /// `rod@(0, -2 m)`, before a member.
    At {
        base: ExprId,
        point: ExprId,
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
    /// `==` is no operator of the language; it is parsed so that its message can be a good one.
    Equal,
}

impl Tree {
    pub fn expr(&self, id: ExprId) -> &Expr {
        &self.exprs[id.0 as usize]
    }

    pub fn list(&self, list: ExprList) -> &[ExprId] {
        &self.expr_lists[list.start as usize..(list.start + list.len) as usize]
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
}

impl ExprList {
    pub const EMPTY: ExprList = ExprList { start: 0, len: 0 };

    pub fn is_empty(self) -> bool {
        self.len == 0
    }
}
