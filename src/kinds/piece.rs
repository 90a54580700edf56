//! What a declaration is made of after its keyword: pieces in the order in which they stand, with what messages call them.

use super::SignalKind;
use crate::base::Dimension;

/// The two name spaces (spec.md#names).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Space {
    /// Parameters, points and indices.
    Values,
    /// Bodies, bases, joints, couplings, elements, inputs, outputs.
    Parts,
}

/// What a name or word of a declaration does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Naming {
    /// The model's own name.
    Title,
    /// Declares a name.
    New(Space),
    /// The index of a `repeat`.
    Index,
    /// Refers to what another declaration declares.
    Of(Space),
}

/// A piece of a declaration. Where blanks may stand between pieces, the grammar says so.
#[derive(Clone, Copy, Debug)]
pub enum Piece {
    /// A blank, before a name or a word.
    Blank,
    /// A blank or a bracket, before a value.
    Apart,
    /// A word without indices, and whose name it is.
    Word(Naming, &'static str),
    /// A name, and whose.
    Name(Naming, &'static str),
    /// A sign, and between or after what it stands.
    Sign(&'static str, &'static str),
    /// A word of the language, and between or after what it stands.
    Marker(&'static str, &'static str),
    /// One of several words, what they stand after, and what follows each of them.
    OneOf(&'static [&'static str], &'static str, &'static [&'static [Piece]]),
    /// An expression: what it is, and what it is made of.
    Value(&'static str, Content),
    /// Expressions in brackets, what they stand before, and what each of them is.
    Arguments(&'static str, &'static str),
    /// An end: `block@A`, and which.
    End(&'static str),
    /// `-- block@A`, which may be missing.
    OtherEnd(&'static str),
    /// `along (1, 0)`, which may be missing.
    Along,
    /// `= harmonic(10 N, 1.5 Hz)`, which may be missing, and what the signal is measured in.
    Signal(&'static SignalKind),
    /// Fields in braces.
    Fields,
}

/// What an expression is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Numbers of any dimension.
    Any,
    /// A number of this dimension, or a pair of such.
    Number(Dimension),
    /// Motions of parts.
    Motions,
    /// Measures and numbers.
    Measures,
}
