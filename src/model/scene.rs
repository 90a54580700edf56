//! The scene that was meant: plain data, SI, every name resolved to an index, every item with the place that made it.
//!
//! All positions are scene coordinates in the one drawn configuration. Vectors hold items in order of declaration
//! (a `repeat` unrolled), and ids are indices into them. Positions and directions are shared (`Arc`): a scene of a
//! million bodies has many more ends than places.

use crate::base::{Name, Number, Quantity, Span, Vec3, Words};
use crate::{elements, joints};
use std::sync::Arc;

macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u32);

        impl $name {
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(/// Index into [`Scene::bodies`].
    BodyId);
id!(/// Index into [`Scene::bases`].
    BaseId);
id!(/// Index into [`Scene::joints`].
    JointId);
id!(/// Index into [`Scene::elements`].
    ElementId);
id!(/// Index into [`Scene::inputs`].
    InputId);
id!(/// Index into [`Scene::outputs`].
    OutputId);

/// A resolved and checked model: see [`super::CheckedScene`], which only the check makes.
#[derive(Clone, Debug)]
pub struct Scene {
    pub name: String,
    /// The words that every [`Name`] below is made of.
    pub words: Words,
    /// Acceleration of free fall, m/s^2; zero where none is declared.
    pub gravity: Vec3,
    /// Where gravity is declared.
    pub gravity_span: Option<Span>,
    pub bodies: Vec<Body>,
    pub bases: Vec<Base>,
    pub joints: Vec<Joint>,
    pub couples: Vec<Couple>,
    pub elements: Vec<Element>,
    pub inputs: Vec<Input>,
    pub outputs: Vec<Output>,
    pub initial: Vec<Initial>,
    pub damping: Option<Damping>,
    pub rest_as_drawn: Option<Span>,
    pub solves: Vec<Solve>,
    pub requires: Vec<Require>,
}

/// A rigid body.
#[derive(Clone, Debug)]
pub struct Body {
    pub name: Name,
    /// The declaration's name: where messages about the body point.
    pub span: Span,
    /// kg; `None` where not given (an error if a freedom needs it).
    pub mass: Option<Number>,
    /// Moment of inertia about the centre, kg m^2; `None` where neither given nor following from a shape.
    pub inertia: Option<Number>,
    /// Centre of mass as drawn, m; `None` for a body without a position.
    pub centre: Option<Arc<Vec3>>,
    /// The form that it is drawn with; mass properties are worked out above.
    pub shape: Option<Arc<Shape>>,
    pub freedom: Freedom,
}

/// The shape of a body as declared, in m.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A slender rod between two points.
    Rod {
        ends: [Vec3; 2],
    },
    Disk {
        radius: Number,
    },
    Ring {
        radius: Number,
    },
    /// A rectangle with its sides along the axes.
    Box {
        width: Number,
        height: Number,
    },
}

/// What the freedom clause of a body says.
#[derive(Clone, Debug, PartialEq)]
pub enum Freedom {
    /// No clause: the joints give the body its freedoms.
    FromJoints,
    /// On the ground with these motions.
    OnGround {
        /// Directions of translation, unit vectors where rational: `x`, `y`, `x y`, or one oblique one (not normalised).
        translations: Arc<[Translation]>,
        turns: bool,
    },
}

/// A motion along a fixed direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Translation {
    /// The direction as written; normalised only where the coordinate is measured (length 1 for x and y).
    pub direction: Vec3,
    /// `x`, `y`, or `along` for an oblique direction.
    pub motion: &'static str,
}

/// A support whose motion is prescribed.
#[derive(Clone, Debug)]
pub struct Base {
    pub name: Name,
    pub span: Span,
    /// Drawn position, m; the turning point of a turning base.
    pub at: Option<Arc<Vec3>>,
    pub translations: Arc<[Translation]>,
    pub turns: bool,
}

/// What an end is attached to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Part {
    Ground,
    Body(BodyId),
    Base(BaseId),
}

/// An end of an element, joint or input.
#[derive(Clone, Debug)]
pub struct Attachment {
    pub part: Part,
    /// Drawn position, m: the point after `@`, else the part's own; `None` where it has no position.
    pub at: Option<Arc<Vec3>>,
    /// The end as written.
    pub span: Span,
}

/// A joint.
#[derive(Clone, Debug)]
pub struct Joint {
    pub name: Name,
    pub span: Span,
    pub kind: &'static joints::Kind,
    pub ends: [Attachment; 2],
    /// The common point of a joint that turns; both attachments have it too.
    pub at: Option<Vec3>,
    /// The direction of a joint that slides, fixed to the first end's part as drawn.
    pub along: Option<Vec3>,
}

impl Joint {
    /// What it leaves free where it carries a part.
    pub fn freedoms(&self) -> joints::Relative {
        self.kind.freedoms(self.along.as_ref())
    }

    /// What it holds where it closes a loop.
    pub fn held(&self) -> joints::Held {
        self.kind.held(self.along.as_ref())
    }
}

/// A linear relation of motions: sum of coefficient times motion = 0. It holds as drawn and always.
#[derive(Clone, Debug)]
pub struct Couple {
    pub name: Name,
    pub span: Span,
    pub terms: Vec<MotionTerm>,
}

/// coefficient times a motion of a body or base.
#[derive(Clone, Debug)]
pub struct MotionTerm {
    pub coefficient: Number,
    pub motion: Motion,
}

/// A scalar that the motion of the scene determines.
#[derive(Clone, Debug)]
pub enum Motion {
    /// Displacement, velocity or acceleration (derivative 0, 1, 2) from rest of a point of a part along a fixed direction.
    Point { part: Part, at: Option<Vec3>, direction: Vec3, derivative: u8 },
    /// Rotation, angular velocity or angular acceleration from rest.
    Turn { part: Part, derivative: u8 },
    /// Change of an element's tension or force from rest, N or N m.
    Force { element: ElementId },
    /// Change of an element's stretch from rest, m or rad.
    Stretch { element: ElementId },
}

/// An element: a spring, a damper, ...
#[derive(Clone, Debug)]
pub struct Element {
    pub name: Name,
    pub span: Span,
    pub ends: [Attachment; 2],
    pub law: Law,
    pub geometry: Geometry,
}

/// The constitutive law: force = coefficient times the derivative of the stretch that its kind names, beside the tension
/// that an elastic element has as drawn.
#[derive(Clone, Debug)]
pub struct Law {
    pub kind: &'static elements::Kind,
    /// In the SI units of its kind, along a line or on the rotation.
    pub coefficient: Number,
    /// [`SpringRest::AsDrawn`] where the kind is not elastic.
    pub rest: SpringRest,
}

impl Law {
    /// Stiffness and rest of an element that holds its ends where they are.
    pub fn spring(&self) -> Option<(&Number, &SpringRest)> {
        self.kind.is_elastic().then_some((&self.coefficient, &self.rest))
    }
}

/// When a spring pulls as drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum SpringRest {
    /// Unstretched as drawn.
    AsDrawn,
    /// Its length (or angle) without tension: m or rad.
    FreeLength(Number),
    /// Its tension as drawn, N or N m; pull is positive.
    Preload(Number),
}

/// What the stretch of an element is.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// The distance of the two points, large displacements included.
    Line,
    /// The relative displacement along a fixed direction (normalised by whoever uses it), second end minus first.
    Along(Arc<Vec3>),
    /// The relative rotation, second end minus first.
    Torsion,
}

/// Something that drives the scene from outside. Bases are inputs too: one for each of their motions.
#[derive(Clone, Debug)]
pub struct Input {
    /// Base name for a base's motion.
    pub name: Name,
    pub span: Span,
    pub kind: InputKind,
    /// A sum of signals; empty where none is declared.
    pub signal: Vec<Signal>,
    /// Where the signal is written.
    pub signal_span: Option<Span>,
}

#[derive(Clone, Debug)]
pub enum InputKind {
    /// A force along a fixed direction on `ends[0]`, and its opposite on `ends[1]` where there are two.
    Force { ends: Vec<Attachment>, direction: Vec3 },
    /// A force along the line between two points: pulls `ends[0]` and `ends[1]` apart where positive.
    ForceBetween { ends: [Attachment; 2] },
    /// A torque on `ends[0]`, and its opposite on `ends[1]` where there are two.
    Torque { ends: Vec<Attachment> },
    /// Motion number `translation` of a base; its rotation for `None`.
    Base { base: BaseId, translation: Option<usize> },
}

/// A signal of time; SI, angles in radians, frequencies in Hz.
#[derive(Clone, Debug, PartialEq)]
pub enum Signal {
    Constant {
        value: Number,
    },
    Step {
        value: Number,
        at: Number,
    },
    /// Time integral of the input.
    Impulse {
        value: Number,
        at: Number,
    },
    Ramp {
        value: Number,
        from: Number,
        to: Number,
    },
    Pulse {
        value: Number,
        from: Number,
        to: Number,
    },
    /// value sin(2 pi frequency t + phase)
    Harmonic {
        value: Number,
        frequency: Number,
        phase: Number,
    },
    Chirp {
        value: Number,
        from: Number,
        to: Number,
        duration: Number,
    },
    /// Two columns: time in s, value in SI units.
    Table {
        file: String,
        span: Span,
        /// `None` where the file was not given to the check.
        rows: Option<Arc<TableRows>>,
    },
}

/// A table's times, ascending, and its values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TableRows {
    pub times: Vec<Number>,
    pub values: Vec<Number>,
}

/// A named linear combination of motions.
#[derive(Clone, Debug)]
pub struct Output {
    pub name: Name,
    pub span: Span,
    pub terms: Vec<MotionTerm>,
    pub dimension: crate::base::Dimension,
    /// Whether it is an angle (then shown in rad).
    pub is_angle: bool,
}

/// Deviations from rest at t = 0. Absent ones are zero.
#[derive(Clone, Debug)]
pub struct Initial {
    pub body: BodyId,
    pub span: Span,
    /// Motion (as in [`Motion`], derivative 0 or 1) and its value, SI.
    pub values: Vec<(Motion, Number, Span)>,
}

#[derive(Clone, Debug)]
pub enum Damping {
    /// One damping ratio for every oscillation.
    Modal { ratio: Number, span: Span },
    /// C = alpha M + beta K, 1/s and s.
    Rayleigh { alpha: Number, beta: Number, span: Span },
}

/// A `param` with the value in use: what `solve` and sensitivities vary.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// With its indices, as in a model: `k`, `m[3]`.
    pub name: String,
    /// The word that declares it.
    pub span: Span,
    pub value: Quantity,
    pub unit: Written,
}

/// The unit that a number was written in.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// `N*m/rad`, `%`, `dB`; empty for a plain number.
    pub text: String,
    /// The SI value of one of it; `None` for `dB`, which is no multiple.
    pub factor: Option<Number>,
}

/// A measure, what it is compared with, and how both were written.
#[derive(Clone, Debug)]
pub struct Question {
    pub measure: Measure,
    /// Of the measure as written.
    pub span: Span,
    /// In SI, a frequency in Hz, an angle in radians.
    pub value: Number,
    /// The same as an angular frequency, rad/s, where it was written as one: what may be exact.
    pub radians: Option<Number>,
    pub unit: Written,
}

/// `solve p in low .. high: measure = value`.
#[derive(Clone, Debug)]
pub struct Solve {
    pub parameter: Parameter,
    /// The parameter as named in the line.
    pub span: Span,
    pub low: Number,
    pub high: Number,
    pub question: Question,
}

/// `require left < right`; `require stable` is a measure alone.
#[derive(Clone, Debug)]
pub struct Require {
    /// The whole comparison.
    pub span: Span,
    pub question: Question,
    /// How the measure has to compare; `None` for `stable`.
    pub comparison: Option<Comparison>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comparison {
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
}

/// A number that an analysis gives. Frequencies in Hz.
#[derive(Clone, Debug)]
pub enum Measure {
    Frequency { mode: u32 },
    DampingRatio { mode: u32 },
    Gain { input: InputId, output: Vec<MotionTerm>, frequency: Number },
    Phase { input: InputId, output: Vec<MotionTerm>, frequency: Number },
    Amplitude { output: Vec<MotionTerm> },
    Static { output: Vec<MotionTerm> },
    Peak { output: Vec<MotionTerm> },
    Rms { output: Vec<MotionTerm> },
    Stable,
}
