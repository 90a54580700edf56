//! The pieces of a declaration after its keyword, in order, with the phrases that messages use for them.

use super::SignalKind;
use crate::base::Dimension;

/// The name space that a name belongs to (spec.md#names): values and parts have one each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Space {
    /// Parameters, points and indices.
    Values,
    /// Bodies, bases, joints, couplings, elements, inputs, outputs.
    Parts,
    /// Places of components, whose names belong to both other name spaces.
    Places,
    /// Components, which are named after `=` in a `place`.
    Components,
}

/// The role of a name or word in a declaration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Naming {
    /// The model's own name.
    Title,
    /// Declares a name.
    New(Space),
    /// The index of a `repeat`.
    Index,
    /// Refers to a name that another declaration declares.
    Of(Space),
}

/// A piece of a declaration. The grammar says where blanks may stand between pieces.
#[derive(Clone, Copy, Debug)]
pub enum Piece {
    /// A blank, before a name or a word.
    Blank,
    /// A blank or a bracket, before a value.
    Apart,
    /// A word without indices, and a phrase for what it names.
    Word(Naming, &'static str),
    /// A name, and a phrase for what it names.
    Name(Naming, &'static str),
    /// A name that may be inside a component at a place, such as `front.k`, and a phrase for what it names.
    Path(Naming, &'static str),
    /// A sign, and a phrase for its place.
    Sign(&'static str, &'static str),
    /// A word of the language, and a phrase for its place.
    Marker(&'static str, &'static str),
    /// One of several words, a phrase for their place, and the pieces that follow each of them.
    OneOf(&'static [&'static str], &'static str, &'static [&'static [Piece]]),
    /// An expression: a phrase for it, and its contents.
    Value(&'static str, Content),
    /// Expressions in brackets, a phrase for the place of the brackets, and one for each expression.
    Arguments(&'static str, &'static str),
    /// An end, `block@A`, and a phrase for it.
    End(&'static str),
    /// `-- block@A`, optional.
    OtherEnd(&'static str),
    /// `along (1, 0)`, optional.
    Along,
    /// `= harmonic(10 N, 1.5 Hz)`, optional, and the kind of signal that is expected.
    Signal(&'static SignalKind),
    /// `in mm`, optional, and a phrase for the unit.
    InUnit(&'static str),
    /// Fields in braces.
    Fields,
    /// Ports and parameters of a component: `(part chassis, m: kg, k = 150 kN/m)`.
    Formals,
    /// Values for ports and parameters: `(chassis = frame, m = 40 kg)`.
    Actuals,
    /// `at (1 m, 0) mirrored x turned 10 deg`; each of these may be missing.
    Placing,
    /// Parameters and their ranges: `c in 1 N*s/m .. 100 N*s/m, k in 1 N/m .. 50 N/m`.
    Varied,
    /// `while peak(y) < 20 mm`, optional.
    Limits,
    /// `spread 10 % within 30 %`, each optional.
    Tolerance,
    /// A file's name in quotes, and a phrase for it.
    Text(&'static str),
}

/// The contents of an expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Numbers of any dimension.
    Any,
    /// A number of this dimension, or a pair of such numbers.
    Number(Dimension),
    /// Motions of parts.
    Motions,
    /// Measures and numbers.
    Measures,
}
