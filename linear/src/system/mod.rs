//! The linear system M q'' + C q' + K q = (B0 + B1 s + B2 s^2) u, y = (P0 + P1 s + P2 s^2) q + (D0 + D1 s + D2 s^2) u,
//! kept as the terms it is the sum of. It knows neither the language nor springs, only names and places in the text for
//! its coordinates and terms. See docs/method/system.md.
//!
//! Each of M, C and K is a sum of signed squares `w a a^T` with a sparse row `a`. The terms hold more digits than the
//! matrix: those of a chain of springs determine every frequency to the last digit whatever the stiffness ratios, the
//! assembled matrix does not (a principle also found in Demmel et al., LAA 299 (1999) 21-80).

pub mod chain;
pub mod form;
pub mod losses;
pub mod noise;
pub mod numbers;
pub mod signal;
pub mod spline;

pub use form::{Form, Nature, Row, Term, Terms};
pub use losses::{ByRate, Losses};
pub use noise::Noise;
pub use signal::{Course, Signal, Table};

use crate::base::unit::{self, Scale};
use crate::base::{Name, Number, Span, Words};

/// Index of a coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CoordinateId(pub u32);

impl CoordinateId {
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A generalised coordinate: a deviation from rest.
#[derive(Clone, Debug)]
pub struct Coordinate {
    /// `block.x`, `rod.angle`, `m[3].x`.
    pub name: Label,
    pub kind: CoordinateKind,
    /// The place where the body is declared.
    pub span: Span,
}

/// The kind of a coordinate, which decides its unit: m or rad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CoordinateKind {
    Translation,
    Rotation,
}

/// The name of a coordinate, term, input or output: a name of the model and, for coordinates, a motion. It is formatted
/// only when it is shown (see [`LinearSystem::display`]): a scene of a million masses has millions of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Label {
    pub name: Name,
    /// `x`, `y`, `angle`, ...; empty for a part's own name.
    pub motion: &'static str,
}

/// The item of the model that terms of a form come from, with the name to show. Two sources may have the same name (a
/// spring may be called `gravity`); their origins differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    pub name: Name,
    pub origin: Origin,
}

/// The kind of item that terms come from, and its index among the items of that kind in order of declaration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Origin {
    Body(u32),
    /// A spring, a damper or an inerter.
    Element(u32),
    /// A load that is part of the rest.
    Input(u32),
    /// The reaction of a joint or coupling that closes a loop.
    Constraint(u32),
    /// The weights of all bodies.
    Gravity,
    /// Damping that is declared for the whole system.
    Damping,
    /// No item: the system was not lowered from a model.
    None,
}

impl From<Label> for Source {
    fn from(name: Label) -> Source {
        Source { name: name.name, origin: Origin::None }
    }
}

impl From<Source> for Label {
    fn from(source: Source) -> Label {
        Label { name: source.name, motion: "" }
    }
}

/// The whole linear system about a rest.
#[derive(Clone, Debug)]
pub struct LinearSystem {
    /// The words that labels consist of.
    pub words: Words,
    pub coordinates: Vec<Coordinate>,
    pub m: Form,
    pub c: Form,
    pub k: Form,
    /// Motions that rows of M, C and K may refer to besides coordinates, with ids from n on; empty except in scenes that
    /// hang deep (see `chain`). Most analyses need systems without them.
    pub chain: Vec<chain::ChainedRow>,
    pub inputs: Vec<Input>,
    pub outputs: Vec<Output>,
    /// State at t = 0: displacement and velocity of each coordinate that does not start at zero.
    pub initial: Vec<(CoordinateId, Number, Number)>,
    /// The loss factors of springs, which harmonic motion alone has; `None` in most systems.
    pub losses: Option<Box<Losses>>,
}

impl LinearSystem {
    /// Number of coordinates.
    pub fn n(&self) -> usize {
        self.coordinates.len()
    }

    /// The system with one more input, which drives others by factors: (input, factor).
    pub fn with_sum_of_inputs(&self, parts: &[(usize, Number)]) -> LinearSystem {
        let mut system = self.clone();
        let Some((first, _)) = parts.first() else { return system };
        let mut sum = Input { b: Default::default(), undamped: None, ..self.inputs[*first].clone() };
        let new = self.inputs.len() as u32;
        for (input, factor) in parts {
            for (sum, b) in sum.b.iter_mut().zip(&self.inputs[*input].b) {
                for (i, value) in b {
                    match sum.iter_mut().find(|(known, _)| known == i) {
                        Some((_, known)) => *known = &*known + &(factor * value),
                        None => sum.push((*i, factor * value)),
                    }
                }
            }
            for d in system.outputs.iter_mut().flat_map(|output| &mut output.d) {
                let fed = d.iter().filter(|(of, _)| *of as usize == *input).map(|(_, value)| factor * value);
                let fed: Vec<(u32, Number)> = fed.map(|value| (new, value)).collect();
                d.extend(fed);
            }
        }
        system.inputs.push(sum);
        system
    }

    /// `block.x`, `m[3].x`, `s`.
    pub fn display(&self, label: impl Into<Label>) -> String {
        let label = label.into();
        let mut text = self.words.display(label.name);
        if !label.motion.is_empty() {
            text.push('.');
            text.push_str(label.motion);
        }
        text
    }

    /// See [`column`].
    pub fn column(&self, output: &Output) -> String {
        column(&self.display(output.name), &output.unit)
    }

    /// The names of the coordinates, in order.
    pub fn coordinate_names(&self) -> Vec<String> {
        self.coordinates.iter().map(|coordinate| self.display(coordinate.name)).collect()
    }
}

/// The heading of a column with the values of an output: its name, and its unit if that is not the SI unit, `tip [mm]`.
pub fn column(name: &str, unit: &str) -> String {
    let is_si = unit::parse(unit).map_or(true, |unit| unit.scale == Scale::Linear(Number::ONE));
    if is_si { name.to_string() } else { format!("{name} [{unit}]") }
}

/// A scalar input u: contributes (b0 + b1 s + b2 s^2) u to the right-hand side. Sparse columns, SI.
#[derive(Clone, Debug)]
pub struct Input {
    pub name: Label,
    /// The declaration's name in the model, where messages about its signal point.
    pub span: Span,
    pub unit: &'static str,
    pub b: [Vec<(CoordinateId, Number)>; 3],
    /// b1 without the damping that is declared for the whole system, if that acts on motion relative to what follows this input
    /// at rest: the rest of b1 is then D r with K r = b0, D being the terms of C from [`Origin::Damping`], whatever digits b1 has.
    pub undamped: Option<Vec<(CoordinateId, Number)>>,
}

/// A scalar output y = sum_i s^i (p_i q + d_i u). Sparse rows, SI.
#[derive(Clone, Debug)]
pub struct Output {
    pub name: Label,
    pub unit: String,
    pub p: [Vec<(CoordinateId, Number)>; 3],
    /// Feed-through of inputs (a base's own motion in a relative output): input index and value.
    pub d: [Vec<(u32, Number)>; 3],
}
