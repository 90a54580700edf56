//! Types that every layer may use: places in texts, diagnostics, numbers, quantities, names.

pub mod density;
pub mod diagnostic;
pub mod dimension;
pub mod field;
pub mod line_index;
pub mod manual;
pub mod name;
pub mod number;
pub mod order;
pub mod readable;
pub mod response_spectrum;
pub mod runs;
pub mod source;
pub mod unit;
pub mod vector;

pub use density::Density;
pub use diagnostic::{Change, Code, Diagnostic, Diagnostics, Failure, Fix, Label, Severity};
pub use dimension::{Angle, Dimension, Quantity};
pub use field::{Expected, Field, Takes};
pub use line_index::LineIndex;
pub use manual::Manual;
pub use name::{Name, Place, Symbol, Words};
pub use number::{
    Ball, Bound, Dd, Jet, Literals, Number, Power, Rational, Rounded, Unproven, down, larger, rounding, two_to, up,
};
pub use order::{OrderBy, first_by};
pub use response_spectrum::ResponseSpectrum;
pub use source::{FileId, Position, SourceFile, SourceKind, Sources, Span};
pub use vector::Vec3;
