//! The description of a field: its name, its value, an example to type, and its documentation.

use super::Dimension;

/// A number that a place of the model expects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Expected {
    /// The noun with its article: "a mass".
    pub noun: &'static str,
    pub dimension: Dimension,
    /// An example to type, such as `mass = 1 kg`.
    pub example: &'static str,
}

impl Expected {
    pub const fn new(noun: &'static str, dimension: Dimension, example: &'static str) -> Expected {
        Expected { noun, dimension, example }
    }
}

/// A field in the braces of a declaration.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    pub name: &'static str,
    pub takes: Takes,
    /// An example to type, such as `mass = 1 kg`.
    pub example: &'static str,
    /// One or two sentences for editors.
    pub meaning: &'static str,
}

/// The value of a field.
#[derive(Clone, Copy, Debug)]
pub enum Takes {
    Number(Expected),
    /// A number of an element: for a translation, or for a rotation if the element is torsional.
    Either {
        line: Expected,
        turn: Expected,
    },
    /// A point of the drawing.
    Position,
    /// `x`, `y` or a vector.
    Direction,
    /// `rod(A, B)`, `disk(r)`, ...
    Shape,
    /// The motions that follow `moves`.
    Motions,
    /// A force over this word, `stretch` or `rate`.
    Law(&'static str),
    /// No value: the word alone.
    Nothing,
}

impl Field {
    pub const fn number(name: &'static str, expected: Expected, meaning: &'static str) -> Field {
        Field { name, takes: Takes::Number(expected), example: expected.example, meaning }
    }

    pub const fn either(name: &'static str, line: Expected, turn: Expected, meaning: &'static str) -> Field {
        Field { name, takes: Takes::Either { line, turn }, example: line.example, meaning }
    }

    pub const fn new(name: &'static str, takes: Takes, example: &'static str, meaning: &'static str) -> Field {
        Field { name, takes, example, meaning }
    }

    /// The number that the field takes; of an element, the translational or, if `turns`, the torsional one.
    pub const fn expected(&self, turns: bool) -> Expected {
        match self.takes {
            Takes::Number(expected) => expected,
            Takes::Either { turn, .. } if turns => turn,
            Takes::Either { line, .. } => line,
            _ => panic!("this field takes no number"),
        }
    }

    /// Whether the word may appear without `=`.
    pub fn stands_alone(&self) -> bool {
        matches!(self.takes, Takes::Motions | Takes::Nothing)
    }
}

/// The index of a field in a table, for constants: a name that is not in the table does not compile.
pub const fn place(fields: &[Field], name: &str) -> usize {
    let mut place = 0;
    while place < fields.len() {
        if is_same(fields[place].name, name) {
            return place;
        }
        place += 1;
    }
    panic!("no field has this name")
}

const fn is_same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    if a.len() != b.len() {
        return false;
    }
    let mut at = 0;
    while at < a.len() {
        if a[at] != b[at] {
            return false;
        }
        at += 1;
    }
    true
}
