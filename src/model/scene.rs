//! The checked scene: plain data in SI units, every name resolved to an index, every item with the place that declares
//! it.
//!
//! All positions are scene coordinates in the drawing. Vectors hold items in order of declaration (with `repeat`
//! unrolled), and ids are indices into them. Positions, directions and laws are shared (`Arc`), and what few items have is
//! boxed: a scene of a million bodies has many more ends than places, and few inertias.

use crate::base::{Bound, Density, Name, Number, Quantity, ResponseSpectrum, Span, Vec3, Words};
use crate::elements::Curve;
pub use crate::kinds::motions::ReactionComponent;
use crate::system::Signal as Function;
use crate::{elements, joints};
use std::ops::Deref;
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
    /// The words of every [`Name`] below.
    pub words: Words,
    /// Acceleration of free fall, m/s^2; zero if none is declared.
    pub gravity: Vec3,
    /// The place where gravity is declared.
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
    /// The parameters that have a tolerance or a spread, in order of declaration.
    pub tolerances: Vec<Tolerance>,
    /// The correlations among them; together they are positive definite.
    pub correlations: Vec<Correlation>,
    pub solves: Vec<Solve>,
    pub optima: Vec<Optimum>,
    pub requires: Vec<Require>,
    /// Measures that are asked for from outside the model, with zero as the value.
    pub asked: Vec<Question>,
}

/// A rigid body.
#[derive(Clone, Debug)]
pub struct Body {
    pub name: Name,
    /// The name in the declaration, where messages about the body point.
    pub span: Span,
    /// Centre of mass as drawn, m; `None` for a body without a position.
    pub centre: Option<Arc<Vec3>>,
    /// Shared by bodies that are alike: a scene of a million bodies has few different ones.
    pub matter: Arc<Matter>,
}

/// What a body is, wherever it is; a [`Body`] is read as if these were fields of its own.
#[derive(Clone, Debug, Default)]
pub struct Matter {
    /// kg; `None` if not given (an error if a degree of freedom needs it).
    pub mass: Option<Number>,
    /// Moment of inertia about the centre, kg m^2; `None` if it is neither given nor follows from a shape.
    pub inertia: Option<Box<Number>>,
    /// The shape for figures; the mass properties that follow from it are in the fields above.
    pub shape: Option<Arc<Shape>>,
    pub freedom: Freedom,
}

impl Deref for Body {
    type Target = Matter;

    fn deref(&self) -> &Matter {
        &self.matter
    }
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
    /// A rectangle.
    Box {
        width: Number,
        height: Number,
        /// The direction of its width: x, unless it is in a component that is placed with a turn.
        along: Arc<Vec3>,
    },
}

/// The freedom clause of a body.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Freedom {
    /// No clause: the joints determine the body's degrees of freedom.
    #[default]
    FromJoints,
    /// Attached to the ground, with these motions.
    OnGround {
        /// Directions of translation: `x`, `y`, `x y`, or a single oblique one (not normalised).
        translations: Arc<Vec<Translation>>,
        turns: bool,
    },
}

/// A motion along a fixed direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Translation {
    /// The direction as written; the coordinate is a length along it, so it is normalised where that matters (length 1
    /// for x and y).
    pub direction: Vec3,
    /// `x`, `y`, or `along` for an oblique direction.
    pub motion: &'static str,
}

/// A support whose motion is prescribed.
#[derive(Clone, Debug)]
pub struct Base {
    pub name: Name,
    pub span: Span,
    /// Drawn position, m; the centre of rotation of a base that turns.
    pub at: Option<Arc<Vec3>>,
    pub translations: Arc<Vec<Translation>>,
    pub turns: bool,
}

/// The part that an end is attached to.
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
    /// Drawn position, m: the point after `@`, otherwise the part's own; `None` if it has no position.
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
    /// The degrees of freedom it leaves if it carries a part.
    pub fn freedoms(&self) -> joints::Relative {
        self.kind.freedoms(self.along.as_ref())
    }

    /// The motions it prevents if it closes a loop.
    pub fn constrained_motions(&self) -> joints::Held {
        self.kind.constrained_motions(self.along.as_ref())
    }
}

/// A linear relation between motions: sum of coefficient times motion = 0. It holds as drawn and at all times.
#[derive(Clone, Debug)]
pub struct Couple {
    pub name: Name,
    pub span: Span,
    /// The dimension of that sum.
    pub dimension: crate::base::Dimension,
    pub terms: Vec<MotionTerm>,
}

/// A coefficient times a motion of a body or base.
#[derive(Clone, Debug)]
pub struct MotionTerm {
    pub coefficient: Number,
    pub motion: Motion,
}

/// A scalar determined by the motion of the scene.
#[derive(Clone, Debug)]
pub enum Motion {
    /// Displacement, velocity or acceleration (derivative 0, 1, 2), measured from rest, of a point of a part along a
    /// fixed direction.
    Point { part: Part, at: Option<Arc<Vec3>>, direction: Vec3, derivative: u8 },
    /// Rotation, angular velocity or angular acceleration, measured from rest.
    Turn { part: Part, derivative: u8 },
    /// Change of an element's tension or force from rest, N or N m.
    Force { element: ElementId },
    /// Change of an element's stretch from rest, m or rad.
    Stretch { element: ElementId },
    /// Change of a reaction from rest, N or N m.
    Reaction(Reaction),
}

/// A component of the force or moment by which something holds parts, acting on the part that it holds (the second one
/// of a joint).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Reaction {
    pub holder: Holder,
    pub component: ReactionComponent,
}

/// An item that restricts motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Holder {
    Joint(JointId),
    /// Index into [`Scene::couples`].
    Couple(u32),
    /// The rails that represent a freedom clause.
    Support(BodyId),
}

impl Holder {
    pub fn name(self, scene: &Scene) -> Name {
        match self {
            Holder::Joint(joint) => scene.joints[joint.index()].name,
            Holder::Couple(couple) => scene.couples[couple as usize].name,
            Holder::Support(body) => scene.bodies[body.index()].name,
        }
    }

    pub fn span(self, scene: &Scene) -> Span {
        match self {
            Holder::Joint(joint) => scene.joints[joint.index()].span,
            Holder::Couple(couple) => scene.couples[couple as usize].span,
            Holder::Support(body) => scene.bodies[body.index()].span,
        }
    }
}

/// An element: a spring, a damper, ...
#[derive(Clone, Debug)]
pub struct Element {
    pub name: Name,
    pub span: Span,
    pub ends: [Attachment; 2],
    /// Shared by elements that are alike: a scene of a million springs has few different ones.
    pub law: Arc<Law>,
}

/// The constitutive law: force = coefficient times the derivative of the stretch given by its kind, plus, for an elastic
/// element, the tension it has as drawn.
#[derive(Clone, Debug)]
pub struct Law {
    pub kind: &'static elements::Kind,
    /// What its stretch is.
    pub geometry: Geometry,
    /// In the SI units of its kind, translational or torsional. For a nonlinear damper, the tangent at rest; not used
    /// for a nonlinear spring.
    pub coefficient: Number,
    /// [`SpringRest::AsDrawn`] if the kind is not elastic.
    pub rest: SpringRest,
    /// The force as a function of the stretch or the rate, unless it is proportional to it.
    pub curve: Option<Arc<Curve>>,
    /// The loss factor of a spring; `None` if it has none.
    pub loss: Option<Box<Number>>,
}

impl Law {
    /// Stiffness and rest of an elastic element.
    pub fn spring(&self) -> Option<(&Number, &SpringRest)> {
        self.kind.is_elastic().then_some((&self.coefficient, &self.rest))
    }

    /// Whether it may have a tension as drawn: its free length or preload is given, or it has a law.
    pub fn may_be_loaded(&self) -> bool {
        self.kind.is_elastic() && (self.rest != SpringRest::AsDrawn || self.curve.is_some())
    }

    /// Whether it has no effect because its coefficient is zero. The tangent of a spring's law is known only at rest.
    pub fn is_zero(&self) -> bool {
        self.coefficient.is_zero() && !(self.curve.is_some() && self.kind.is_elastic())
    }
}

/// The tension of a spring as drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum SpringRest {
    /// Unstretched as drawn.
    AsDrawn,
    /// Free length (or angle): m or rad.
    FreeLength(Number),
    /// Its tension as drawn, N or N m; pull is positive.
    Preload(Number),
}

/// The definition of an element's stretch.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// The distance of the two points, large displacements included.
    Line,
    /// The relative displacement along a fixed direction (not normalised), second end minus first.
    Along(Arc<Vec3>),
    /// The relative rotation, second end minus first.
    Torsion,
    /// A span of a belt, from disk to disk.
    Span(Arc<BeltSpan>),
}

/// A span of a belt along a common tangent of two disks.
#[derive(Clone, Debug, PartialEq)]
pub struct BeltSpan {
    /// Whether it touches the first disk on the left of the direction to the second.
    pub left: bool,
    /// Distance of the centres across the span, towards the side on which it touches the first disk, m.
    pub gap: Number,
    /// Increase of its length per turn of each disk, m/rad.
    pub turns: [Number; 2],
}

impl BeltSpan {
    /// Whether it touches its disks on opposite sides.
    pub fn is_crossed(&self) -> bool {
        self.turns[0].is_positive() == self.turns[1].is_positive()
    }
}

/// An external excitation of the scene. Bases are inputs too: one for each of their motions.
#[derive(Clone, Debug)]
pub struct Input {
    /// Base name for a base's motion.
    pub name: Name,
    pub span: Span,
    pub kind: InputKind,
    /// A sum of signals; empty if none is declared.
    pub signal: Vec<Signal>,
    /// The derivative of the input that the signal gives: for a base 0 the motion itself, 1 its rate, 2 its
    /// acceleration; for an unbalance 2.
    pub derivative: u8,
    /// The place where the signal is written.
    pub signal_span: Option<Span>,
}

#[derive(Clone, Debug)]
pub enum InputKind {
    /// A force along a fixed direction on `ends[0]`, and its opposite on `ends[1]` if there are two.
    Force { ends: Vec<Attachment>, direction: Vec3 },
    /// A force along the line between two points; if positive, it drives `ends[0]` and `ends[1]` apart.
    ForceBetween { ends: [Attachment; 2] },
    /// A torque on `ends[0]`, and its opposite on `ends[1]` if there are two.
    Torque { ends: Vec<Attachment> },
    /// A component of a rotating unbalance, in kg m: the component along `direction` of the heavy spot's motion times
    /// its mass. Its second derivative is the force on `end`, with the opposite sign.
    Unbalance { end: [Attachment; 1], direction: Vec3, axis: Axis, clockwise: bool, needs_speed: bool },
    /// Motion number `translation` of a base, or its rotation if that is `None`.
    Base { base: BaseId, translation: Option<usize> },
}

/// An axis of the drawing, or of the component in which a part is declared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    X,
    Y,
}

impl Axis {
    pub fn name(self) -> &'static str {
        match self {
            Axis::X => "x",
            Axis::Y => "y",
        }
    }
}

impl InputKind {
    /// The base whose motion this is.
    pub fn base(&self) -> Option<BaseId> {
        if let InputKind::Base { base, .. } = self { Some(*base) } else { None }
    }

    /// The points at which it acts; none for a base.
    pub fn ends(&self) -> &[Attachment] {
        match self {
            InputKind::Force { ends, .. } | InputKind::Torque { ends } => ends,
            InputKind::ForceBetween { ends } => ends,
            InputKind::Unbalance { end, .. } => end,
            InputKind::Base { .. } => &[],
        }
    }
}

/// A signal that drives an input, or a constant load.
#[derive(Clone, Debug, PartialEq)]
pub enum Signal {
    /// A load that belongs to the rest; it drives nothing.
    Constant { value: Number },
    /// A function of time that refers to nothing else in the model.
    Function(Function),
    /// Two columns: time in s, value in SI units.
    Table {
        file: String,
        span: Span,
        /// `None` if the file was not given to the check.
        rows: Option<Arc<TableRows>>,
        /// s: after this time the rows come again.
        period: Option<Number>,
    },
    /// The signals of another input, so much later, and the index of that input.
    Delayed { by: Number, of: usize, signals: Arc<[Signal]> },
    /// Stationary noise, by its density.
    Noise(Density),
    /// A response spectrum in place of a history.
    Spectrum(ResponseSpectrum),
}

impl Signal {
    /// Whether it is noise, or a delay of noise.
    pub fn has_noise(&self) -> bool {
        match self {
            Signal::Noise(_) => true,
            Signal::Delayed { signals, .. } => signals.iter().any(Signal::has_noise),
            _ => false,
        }
    }

    /// Whether it is a function of time that moves something: noise is none, and a constant load is part of the rest.
    pub fn has_course(&self) -> bool {
        match self {
            Signal::Constant { .. } | Signal::Noise(_) | Signal::Spectrum(_) => false,
            Signal::Delayed { signals, .. } => signals.iter().any(Signal::has_course),
            _ => true,
        }
    }

    /// The signal with the opposite sign.
    pub fn negate(&self) -> Signal {
        let mut signal = self.clone();
        match &mut signal {
            Signal::Constant { value } => *value = -&*value,
            Signal::Function(function) => *function = function.negate(),
            Signal::Table { rows, .. } => {
                if let Some(rows) = rows {
                    let values = rows.values.iter().map(|value| -value).collect();
                    *rows = Arc::new(TableRows { times: rows.times.clone(), values });
                }
            }
            Signal::Delayed { signals, .. } => *signals = signals.iter().map(Signal::negate).collect(),
            Signal::Noise(_) | Signal::Spectrum(_) => {}
        }
        signal
    }
}

impl From<Function> for Signal {
    fn from(function: Function) -> Signal {
        Signal::Function(function)
    }
}

/// A table's times, ascending, and its values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TableRows {
    pub times: Vec<Number>,
    pub values: Vec<Number>,
}

impl TableRows {
    /// The rows from t = 0 on if there are earlier ones, with the value on the line at t = 0 as the first. `keeps`: the last value
    /// remains after the last row, else there is nothing left of a table that ends by then.
    pub fn from_zero(&self, keeps: bool) -> Option<TableRows> {
        self.times.first().filter(|first| first.is_negative())?;
        let Some(next) = self.times.iter().position(|time| !time.is_negative()) else {
            let last = self.values.last().filter(|_| keeps).cloned();
            return Some(TableRows {
                times: last.iter().map(|_| Number::ZERO).collect(),
                values: last.into_iter().collect(),
            });
        };
        let (mut times, mut values) = (self.times[next..].to_vec(), self.values[next..].to_vec());
        if times[0].is_zero() {
            // The last row alone is no course.
            let is_over = times.len() == 1 && !keeps;
            return Some(if is_over { TableRows::default() } else { TableRows { times, values } });
        }
        let (before, after) = (&self.times[next - 1], &self.times[next]);
        let rise = &self.values[next] - &self.values[next - 1];
        let at_zero = &self.values[next] - &(&rise * &(after / &(after - before)));
        times.insert(0, Number::ZERO);
        values.insert(0, at_zero);
        Some(TableRows { times, values })
    }
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
    /// The unit that it is shown in, if the model gives one.
    pub unit: Option<Written>,
}

impl Output {
    /// The SI value of one unit that the output is shown in.
    pub fn unit_factor(&self) -> Option<&Number> {
        self.unit.as_ref().and_then(|unit| unit.factor.as_ref())
    }

    /// The coefficient of a term of an output, in the unit that the output is shown in.
    pub fn coefficient(&self, term: &MotionTerm) -> Number {
        match self.unit_factor() {
            Some(factor) => &term.coefficient / factor,
            None => term.coefficient.clone(),
        }
    }
}

/// Deviations from rest at t = 0; the ones not given are zero.
#[derive(Clone, Debug)]
pub struct Initial {
    pub body: BodyId,
    pub span: Span,
    /// Motion (as in [`Motion`], derivative 0 or 1) and its value, SI.
    pub values: Vec<(Motion, Number, Span)>,
}

#[derive(Clone, Debug)]
pub enum Damping {
    /// One damping ratio for every mode.
    Modal { ratio: Number, span: Span },
    /// C = alpha M + beta K, 1/s and s.
    Rayleigh { alpha: Number, beta: Number, span: Span },
}

/// A `param` with its current value, which `solve` and sensitivities vary.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// The name with its indices, as in a model: `k`, `m[3]`.
    pub name: String,
    /// The word that declares it, or the value that a place gives for it.
    pub span: Span,
    pub value: Quantity,
    pub unit: Written,
}

/// How far a `param` may lie from its value, and how its values are distributed. At least one of both is there.
#[derive(Clone, Debug)]
pub struct Tolerance {
    pub parameter: Parameter,
    /// The clauses after its value.
    pub span: Span,
    /// Both ends in SI units, the lower one first. They contain the value, rounding apart. Without it a normal or lognormal
    /// distribution is not truncated.
    pub within: Option<[Number; 2]>,
    /// Whether its half-width is a share of the value.
    pub is_share: bool,
    /// `None` with `within` alone: any value in the range, drawn uniformly where samples are drawn.
    pub spread: Option<Spread>,
}

impl Tolerance {
    /// The same about another value, SI: a share is one of that, and otherwise both ends keep their distances from the value.
    pub fn about(&self, si: &Number) -> Tolerance {
        let value = &self.parameter.value.si;
        let moved = |[low, high]: &[Number; 2]| {
            let (below, above) = (low - value, high - value);
            let times = if self.is_share { si.abs().checked_div(&value.abs()) } else { None };
            match times {
                Some(times) => [si + &(&below * &times), si + &(&above * &times)],
                None => [si + &below, si + &above],
            }
        };
        let within = self.within.as_ref().map(moved);
        let value = Quantity { si: si.clone(), ..self.parameter.value.clone() };
        let parameter = Parameter { value, ..self.parameter.clone() };
        Tolerance { parameter, within, ..self.clone() }
    }
}

/// The distribution of a parameter. A range `within` truncates it.
#[derive(Clone, Debug)]
pub enum Spread {
    /// About the value, with this standard deviation in SI units (before it is truncated).
    Normal { deviation: Number },
    /// The value is the median, and this is the standard deviation of the logarithm.
    Lognormal { deviation: Number },
    /// Over the range `within`, which is there.
    Uniform,
}

/// `correlate k, m 0.8`: the correlation of the two standard normal variables that the parameters are monotone functions
/// of. For two normal parameters that are not truncated it is their own.
#[derive(Clone, Debug)]
pub struct Correlation {
    /// Indices of [`Scene::tolerances`], the smaller one first. A pair occurs once.
    pub pair: [usize; 2],
    /// Between -1 and 1, both excluded.
    pub coefficient: Number,
    pub span: Span,
}

/// The unit that a number was written in.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// `N*m/rad`, `%`, `dB`; empty for a plain number.
    pub text: String,
    /// The SI value of one such unit; `None` for `dB`, which is not linear.
    pub factor: Option<Number>,
}

impl Written {
    /// A bound in SI as a bound in this unit.
    pub fn bound(&self, bound: Bound) -> Bound {
        self.factor.as_ref().map_or(bound, |factor| bound.per(factor.enclosure()))
    }
}

/// A measure, the value it is compared with, and how both were written.
#[derive(Clone, Debug)]
pub struct Question {
    pub measure: Measure,
    /// The span of the measure as written.
    pub span: Span,
    /// In SI units; a frequency in Hz, an angle in radians.
    pub value: Number,
    /// The value as an angular frequency, rad/s, if it was written as one: it may be exact in rad/s but not in Hz.
    pub radians: Option<Number>,
    pub unit: Written,
    /// The place of a component and the repetitions that it is written in: `in front, i = 2`; empty outside of these.
    pub within: String,
}

impl Question {
    /// A text of the model about it, with the place and the repetitions that it is written in: the same text is there once for each.
    pub fn name(&self, text: &str) -> String {
        if self.within.is_empty() { text.to_string() } else { format!("{text} ({})", self.within) }
    }
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

/// `minimise measure over p in low .. high, ... while conditions`, or `maximise`.
#[derive(Clone, Debug)]
pub struct Optimum {
    /// The whole line.
    pub span: Span,
    /// Whether the objective is maximised.
    pub highest: bool,
    /// The objective; nothing is compared.
    pub question: Question,
    pub varied: Vec<Varied>,
    pub limits: Vec<Require>,
}

/// A parameter that `minimise` or `maximise` varies.
#[derive(Clone, Debug)]
pub struct Varied {
    pub parameter: Parameter,
    /// The parameter as named in the line.
    pub span: Span,
    pub low: Number,
    pub high: Number,
}

/// `require left < right`; `require stable` has a measure only.
#[derive(Clone, Debug)]
pub struct Require {
    /// The whole comparison.
    pub span: Span,
    pub question: Question,
    /// The comparison that must hold; `None` for `stable`.
    pub comparison: Option<Comparison>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comparison {
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
}

/// What drives an output in a transfer function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Drive {
    pub input: InputId,
    /// 0 for the input itself; 1 for the velocity and 2 for the acceleration of a base.
    pub derivative: u8,
}

/// A number that an analysis computes. Frequencies in Hz.
#[derive(Clone, Debug)]
pub enum Measure {
    Frequency {
        mode: u32,
    },
    DampingRatio {
        mode: u32,
    },
    Gain {
        input: Drive,
        output: Vec<MotionTerm>,
        frequency: Number,
    },
    Phase {
        input: Drive,
        output: Vec<MotionTerm>,
        frequency: Number,
    },
    Amplitude {
        output: Vec<MotionTerm>,
    },
    Static {
        output: Vec<MotionTerm>,
    },
    Peak {
        output: Vec<MotionTerm>,
    },
    /// The time after which the output stays within `band` of its final value, as a part of that.
    Settling {
        output: Vec<MotionTerm>,
        band: Number,
    },
    Overshoot {
        output: Vec<MotionTerm>,
    },
    Rms {
        output: Vec<MotionTerm>,
        of: Cause,
    },
    /// Root mean square under noise, of the part of the output between two frequencies.
    RmsWithin {
        output: Vec<MotionTerm>,
        range: [Number; 2],
    },
    /// The one-sided power spectral density under noise.
    Psd {
        output: Vec<MotionTerm>,
        frequency: Number,
    },
    /// Upward zero crossings under noise.
    Crossings {
        output: Vec<MotionTerm>,
    },
    /// The largest gain over all frequencies, or from one to another one.
    PeakGain {
        input: Drive,
        output: Vec<MotionTerm>,
        range: Option<[Number; 2]>,
    },
    /// The effective mass of a mode under the motion of a base.
    EffectiveMass {
        input: InputId,
        mode: u32,
    },
    /// Motions at rest, measured from the drawing; of a spring's force its whole tension.
    Rest {
        terms: Vec<MotionTerm>,
    },
    /// How far the loads at rest can grow before the scene buckles.
    LoadFactor,
    Stable,
    /// Sums, differences, products and quotients of measures and numbers.
    Combined(Box<Combined<Measure>>),
}

/// The cause of the motion whose root mean square is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    Noise,
    /// Signals and the initial state, over the simulated time.
    Time,
    /// Either of them, whichever reaches the output.
    Either,
}

/// An arithmetic expression of measures and numbers; frequencies in Hz.
#[derive(Clone, Debug)]
pub enum Combined<M> {
    Measure(M),
    Number(Number),
    Negated(Box<Combined<M>>),
    Binary { operator: Arithmetic, left: Box<Combined<M>>, right: Box<Combined<M>> },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arithmetic {
    Add,
    Subtract,
    Multiply,
    Divide,
}

impl<M> Combined<M> {
    /// The expression with its operands mapped.
    pub fn map<N>(&self, f: &mut impl FnMut(&M) -> N) -> Combined<N> {
        match self {
            Combined::Measure(measure) => Combined::Measure(f(measure)),
            Combined::Number(number) => Combined::Number(number.clone()),
            Combined::Negated(part) => Combined::Negated(Box::new(part.map(f))),
            Combined::Binary { operator, left, right } => {
                let (left, right) = (Box::new(left.map(f)), Box::new(right.map(f)));
                Combined::Binary { operator: *operator, left, right }
            }
        }
    }

    /// Whether some measure in it satisfies a condition.
    pub fn any(&self, of: &dyn Fn(&M) -> bool) -> bool {
        match self {
            Combined::Measure(measure) => of(measure),
            Combined::Number(_) => false,
            Combined::Negated(part) => part.any(of),
            Combined::Binary { left, right, .. } => left.any(of) || right.any(of),
        }
    }
}

impl Scene {
    /// The motion of an input that moves a base: `x`, `y`, `along` or `angle`.
    pub fn motion_of_base(&self, kind: &InputKind) -> Option<&'static str> {
        match *kind {
            InputKind::Base { base, translation: Some(index) } => {
                Some(self.bases[base.index()].translations[index].motion)
            }
            InputKind::Base { translation: None, .. } => Some("angle"),
            _ => None,
        }
    }

    /// Whether the values of some parameters follow from `solve`, `minimise` or `maximise`.
    pub fn determines_parameters(&self) -> bool {
        !self.solves.is_empty() || !self.optima.is_empty()
    }

    /// The names of these parameters.
    pub fn determined_names(&self) -> impl Iterator<Item = &str> {
        let varied = self.optima.iter().flat_map(|optimum| &optimum.varied).map(|varied| &varied.parameter);
        self.solves.iter().map(|solve| &solve.parameter).chain(varied).map(|parameter| parameter.name.as_str())
    }
}

impl Measure {
    /// Whether the measure depends on the motion in time.
    pub fn is_of_time(&self) -> bool {
        match self {
            Measure::Peak { .. } | Measure::Rms { of: Cause::Time | Cause::Either, .. } => true,
            Measure::Combined(combined) => combined.any(&Measure::is_of_time),
            _ => false,
        }
    }

    /// Whether the measure, or a part of it, is an amplitude in the steady state.
    pub fn is_of_amplitude(&self) -> bool {
        match self {
            Measure::Amplitude { .. } => true,
            Measure::Combined(combined) => combined.any(&Measure::is_of_amplitude),
            _ => false,
        }
    }

    /// Whether the measure, or a part of it, is read from a transfer function. That has a value in a scene whose free
    /// motions grow, too, but no motion ever shows it there.
    pub fn is_of_transfer(&self) -> bool {
        match self {
            Measure::Gain { .. } | Measure::Phase { .. } | Measure::PeakGain { .. } => true,
            Measure::Combined(combined) => combined.any(&Measure::is_of_transfer),
            _ => false,
        }
    }
}
