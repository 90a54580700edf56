//! What can be wrong with a model: facts, and what is said about them. Each variant has one code, one primary place, and
//! a help that says what to type. Clause: spec.md, "Diagnostics".

use super::expect::Expected;
use super::scope::DefinitionKind;
use super::value::Fault;
use crate::base::{Angle, Code, Diagnostic, Dimension, Span};
use crate::syntax::tree::Binary;

/// A finding of the check.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    // Units and numbers
    UnitUnknown {
        span: Span,
        symbol: String,
        suggestion: Option<String>,
        is_value: bool,
    },
    UnitAmbiguous {
        span: Span,
        head: String,
        tail: String,
    },
    UnitMalformed {
        span: Span,
    },
    DecibelInProduct {
        span: Span,
    },
    UnitMissing {
        span: Span,
        number: String,
        expected: Expected,
    },
    UnitMismatch {
        span: Span,
        found: Dimension,
        expected: Expected,
        declared: Option<(String, Span)>,
    },
    FrequencyReading {
        span: Span,
        value: f64,
    },
    Overflow {
        span: Span,
    },

    // Expressions
    Operation {
        fault: Fault,
        operator: Binary,
        left: Span,
        right: Span,
    },
    Function {
        fault: Fault,
        function: &'static str,
        argument: Span,
        span: Span,
    },
    Pair {
        fault: Fault,
        left: Span,
        right: Span,
    },
    Kind {
        span: Span,
        needed: &'static str,
        found: &'static str,
    },
    MotionAsValue {
        span: Span,
    },
    ArrowAsValue {
        span: Span,
    },
    ComparisonAsValue {
        span: Span,
    },
    ArgumentCount {
        span: Span,
        function: &'static str,
        expected: usize,
        found: usize,
    },
    Components {
        span: Span,
        found: usize,
    },
    NoDirection {
        span: Span,
    },

    // Names and repetitions
    UnknownValue {
        span: Span,
        word: String,
        suggestion: Option<String>,
        help: Option<String>,
    },
    UnknownPart {
        span: Span,
        word: String,
        wanted: &'static str,
        suggestion: Option<String>,
        help: Option<String>,
    },
    UnknownFunction {
        span: Span,
        word: String,
        suggestion: Option<String>,
        help: Option<String>,
    },
    IndexOutOfRange {
        span: Span,
        name: String,
        word: String,
        given: usize,
        ranges: Vec<(i32, i32)>,
        declared: Span,
    },
    TooManyIndices {
        span: Span,
    },
    NotWhole {
        span: Span,
    },
    Duplicate {
        span: Span,
        name: String,
        first: Option<Span>,
    },
    Reserved {
        span: Span,
        word: String,
    },
    Cycle {
        span: Span,
        members: Vec<(String, Span)>,
    },
    TooManyInstances {
        span: Span,
        limit: u64,
    },
    ReversedBounds {
        span: Span,
        first: i64,
        last: i64,
    },
    SettingTwice {
        span: Span,
        first: Span,
        what: &'static str,
    },

    // Values from outside
    NoEqualsSign {
        span: Span,
    },
    NotToml {
        span: Span,
        message: String,
    },
    SettingName {
        span: Span,
    },
    SettingValue {
        span: Span,
    },
    UnknownParameter {
        span: Span,
        word: String,
        suggestion: Option<String>,
        known: Vec<String>,
    },
    NotAParameter {
        span: Span,
        word: String,
        kind: DefinitionKind,
        declared: Span,
    },
    UnlikeDeclared {
        span: Span,
        found: Dimension,
        wanted: Dimension,
        declared: Option<(String, Span)>,
    },
    ReadingLike {
        span: Span,
        declared: Angle,
    },

    // Fields
    UnknownField {
        span: Span,
        word: String,
        suggestion: Option<&'static str>,
        known: &'static [&'static str],
    },
    FieldTwice {
        span: Span,
        first: Span,
        word: String,
    },
    FieldWithoutValue {
        span: Span,
        word: String,
    },
    FlagWithValue {
        span: Span,
        word: String,
    },
    AboutElsewhere {
        span: Span,
    },
    FieldMissing {
        span: Span,
        expected: Expected,
    },

    // Bodies and bases
    NotABody {
        span: Span,
        word: String,
        found: &'static str,
        declared: Span,
    },
    Negative {
        span: Span,
        what: &'static str,
    },
    InertiaWithoutPlace {
        span: Span,
        name: String,
    },
    InertiaTooSmall {
        span: Span,
        least: f64,
        given: f64,
    },
    GivenTwice {
        span: Span,
        other: Span,
        what: &'static str,
    },
    UnknownShape {
        span: Span,
        suggestion: Option<&'static str>,
    },
    ShapeSize {
        span: Span,
        what: &'static str,
    },
    FreeAndMore {
        span: Span,
        free: Span,
    },
    MovesWhere {
        span: Span,
    },
    BaseWithoutMotion {
        span: Span,
        name: String,
    },
    NoFreedom {
        span: Span,
        name: String,
    },
    PropertyMissing {
        span: Span,
        name: String,
        what: &'static str,
        freedom: &'static str,
    },
    CentreMissing {
        span: Span,
        name: String,
    },
    Empty {
        span: Span,
    },

    // Joints
    JointOfOnePart {
        span: Span,
        part: String,
    },
    SlideWithoutDirection {
        span: Span,
    },
    PivotWithoutPlace {
        span: Span,
        part: String,
    },
    EndsApart {
        spans: [Span; 2],
        places: [(f64, f64); 2],
    },

    // Elements
    EqualEnds {
        span: Span,
        part: String,
    },
    ZeroLength {
        span: Span,
    },
    DirectionUnknown {
        span: Span,
        part: String,
    },
    DirectionOfTorsion {
        span: Span,
    },
    NoEndTurns {
        span: Span,
    },
    FreeLengthAndPreload {
        span: Span,
        free: Span,
    },
    NoDrawnLength {
        span: Span,
    },
    NegativeStiffness {
        span: Span,
    },
    NegativeDamping {
        span: Span,
    },

    // Inputs and signals
    ForceWithoutDirection {
        span: Span,
    },
    InputWithoutEffect {
        span: Span,
        part: String,
    },
    SignalOfManyMotions {
        span: Span,
    },
    NotASignal {
        span: Span,
    },
    UnknownSignal {
        span: Span,
        word: String,
        suggestion: Option<&'static str>,
    },
    SignalArguments {
        span: Span,
        name: &'static str,
        form: &'static str,
    },
    TimesReversed {
        span: Span,
    },

    // Motions
    NoMotion {
        span: Span,
    },
    NonLinear {
        span: Span,
    },
    PointWithoutMotion {
        span: Span,
    },
    MotionOfWhat {
        span: Span,
    },
    UnknownMotion {
        span: Span,
        word: String,
        of: &'static str,
        suggestion: Option<&'static str>,
        known: Vec<&'static str>,
    },
    NoSuchFreedom {
        span: Span,
        name: String,
        turns: bool,
    },
    CoupleOfOthers {
        span: Span,
    },
    NoInitialState {
        span: Span,
        word: String,
        found: &'static str,
    },

    // Measures
    NotAMeasure {
        span: Span,
    },
    UnknownMeasure {
        span: Span,
        word: String,
        suggestion: Option<&'static str>,
    },
    MeasureArguments {
        span: Span,
        name: &'static str,
        form: &'static str,
    },
    ArrowMissing {
        span: Span,
    },
    NotAnInput {
        span: Span,
        found: &'static str,
    },
    NotAnOutput {
        span: Span,
        word: String,
        found: &'static str,
        declared: Span,
    },
    ModeNumber {
        span: Span,
    },
    RangeReversed {
        span: Span,
    },
    RequireWhat {
        span: Span,
    },

    // What is idle, and what is not there yet
    Unused {
        span: Span,
        name: String,
        kind: DefinitionKind,
    },
    Idle {
        span: Span,
        name: String,
        word: &'static str,
        why: &'static str,
    },
    IdleGravity {
        span: Span,
    },
    NotAvailable {
        span: Span,
        what: &'static str,
    },
}

fn error(code: &'static str, span: Span, message: impl Into<String>) -> Diagnostic {
    Diagnostic::error(Code(code), span, message)
}

impl Error {
    /// Adds where the parameter is declared.
    pub fn declared_at(mut self, declaration: (String, Span)) -> Error {
        if let Error::UnlikeDeclared { declared, .. } = &mut self {
            *declared = Some(declaration);
        }
        self
    }

    /// What is said about it.
    pub fn diagnostic(self) -> Diagnostic {
        use Error::*;
        match self {
            UnitUnknown { span, symbol, suggestion, is_value } => unit_unknown(span, &symbol, suggestion, is_value),
            UnitAmbiguous { span, head, tail } => {
                let divided = format!("{head}/{}", tail.replace('*', "/"));
                error("vib::unit::ambiguous", span, "this unit can be read in two ways")
                    .label(format!("({head})*{tail} or {}?", below(&head, &tail)))
                    .help(format!("write `{}` or `{divided}`", swapped(&head, &tail)))
            }
            UnitMalformed { span } => error("vib::unit::malformed", span, "this is not a unit")
                .help("write units glued together, as in `N*s/m^2`"),
            DecibelInProduct { span } => error("vib::unit::malformed", span, "`dB` stands alone, it is a ratio")
                .help("write a level, such as `-12 dB`"),
            UnitMissing { span, number, expected } => unit_missing(span, &number, expected),
            UnitMismatch { span, found, expected, declared } => unit_mismatch(span, found, expected, declared),
            FrequencyReading { span, value } => frequency_reading(span, value),
            Overflow { span } => {
                error("vib::number::overflow", span, "this number is beyond what can be computed with")
                    .help("sizes from 1e-300 to 1e300 in SI units can be used")
                    .help("sizes from 1e-300 to 1e300 in SI units can be used")
            }

            Operation { fault, operator, left, right } => operation(fault, operator, left, right),
            Function { fault, function, argument, span } => function_fault(fault, function, argument, span),
            Pair { fault, left, right } => pair(fault, left, right),
            Kind { span, needed, found } => {
                error("vib::value::kind", span, format!("{needed} is expected here, this is {found}"))
            }
            MotionAsValue { span } => {
                error("vib::value::motion", span, "a motion has no value before the model is analysed")
                    .help("motions stand in `output`, `couple`, `solve` and `require`")
            }
            ArrowAsValue { span } => error("vib::value::motion", span, "`->` leads from an input to an output")
                .help("it stands in `gain(input -> output, f)` and `phase(input -> output, f)`"),
            ComparisonAsValue { span } => error("vib::value::comparison", span, "a comparison has no value")
                .help("comparisons stand in `require`, as in `require frequency(1) > 2 Hz`"),
            ArgumentCount { span, function, expected, found } => argument_count(span, function, expected, found),
            Components { span, found } => components(span, found),
            NoDirection { span } => error("vib::direction::zero", span, "this vector has no direction")
                .label("zero")
                .help("write `x`, `y` or a vector that is not zero, such as `(1, 1)`"),

            UnknownValue { span, word, suggestion, help } => {
                let message = format!("there is no parameter or point `{word}`");
                let help = help.or_else(|| Some(format!("declare it: `param {word} = ...` or `point {word} = ...`")));
                with_suggestion(error("vib::name::unknown", span, message), suggestion, help)
            }
            UnknownPart { span, word, wanted, suggestion, help } => {
                let message = format!("there is no {wanted} `{word}`");
                let declare = || format!("declare it: `body {word} {{ mass = 1 kg, moves x }}`");
                let help = help.or_else(|| (wanted == "body").then(declare));
                with_suggestion(error("vib::part::unknown", span, message), suggestion, help)
            }
            UnknownFunction { span, word, suggestion, help } => {
                let message = format!("there is no function `{word}`");
                with_suggestion(error("vib::function::unknown", span, message), suggestion, help)
            }
            IndexOutOfRange { span, name, word, given, ranges, declared } => {
                index_out_of_range(span, &name, &word, given, &ranges, declared)
            }
            TooManyIndices { span } => error("vib::index::too_many", span, "a name has at most three indices"),
            NotWhole { span } => error("vib::index::not_whole", span, "a whole number is expected here")
                .help("indices and bounds are whole numbers without a unit, below 2^31"),
            Duplicate { span, name, first } => duplicate(span, &name, first),
            Reserved { span, word } => error("vib::name::reserved", span, format!("`{word}` has a meaning of its own"))
                .help("choose another name"),
            Cycle { span, members } => cycle(span, &members),
            TooManyInstances { span, limit } => {
                error("vib::limit::repeat", span, format!("this makes more than {limit} declarations"))
                    .help("repeat less often, or split the model")
            }
            ReversedBounds { span, first, last } => {
                error("vib::repeat::reversed", span, "the last value of the index is below the first one")
                    .help(format!("write `{last}..{first}`"))
            }

            NoEqualsSign { span } => {
                error("vib::setting::form", span, "this sets nothing").help("write `NAME=VALUE`, such as `k=12N/m`")
            }
            NotToml { span, message } => error("vib::setting::toml", span, format!("this is not TOML: {message}"))
                .help("write a line for each parameter, such as `k = \"12 N/m\"`"),
            SettingName { span } => error("vib::setting::form", span, "this is no name of a parameter")
                .help("write `NAME=VALUE`, such as `k=12N/m` or `k[3]=12N/m`"),
            SettingValue { span } => error("vib::setting::form", span, "a number with its unit is expected here")
                .help("write it as in a model: `12N/m`, `30 Hz`, `2 %`; in TOML in quotes"),
            UnknownParameter { span, word, suggestion, known } => {
                let message = format!("the model has no parameter `{word}`");
                let known: Vec<&str> = known.iter().map(String::as_str).collect();
                let help = if known.is_empty() { "it has none".into() } else { format!("it has {}", listed(&known)) };
                with_suggestion(error("vib::setting::unknown", span, message), suggestion, Some(help))
            }
            NotAParameter { span, word, kind, declared } => not_a_parameter(span, &word, kind, declared),
            UnlikeDeclared { span, found, wanted, declared } => unlike_declared(span, found, wanted, declared),
            ReadingLike { span, declared } => {
                let unit = if declared == Angle::Cycles { "Hz" } else { "rad/s" };
                error("vib::unit::frequency", span, "this is in 1/s: are these radians or cycles?")
                    .label(format!("the parameter is declared in {unit}"))
                    .help(format!("write the unit, such as `10 {unit}`"))
            }
            SettingTwice { span, first, what } => {
                error("vib::setting::duplicate", span, format!("{what} is declared twice"))
                    .related(first, "declared first here")
                    .help("keep one of them")
            }

            UnknownField { span, word, suggestion, known } => {
                let help = suggestion.is_none().then(|| format!("known here: {}", listed(known)));
                let message = format!("there is no field `{word}` here");
                with_suggestion(error("vib::field::unknown", span, message), suggestion.map(str::to_string), help)
            }
            FieldTwice { span, first, word } => {
                error("vib::field::duplicate", span, format!("`{word}` is given twice"))
                    .related(first, "given first here")
                    .help("keep one of them")
            }
            FieldWithoutValue { span, word } => error("vib::field::value", span, format!("`{word}` needs a value"))
                .help(format!("write `{word} = ...`")),
            FlagWithValue { span, word } => error("vib::field::value", span, format!("`{word}` takes no value"))
                .help(format!("write `{word}` alone")),
            AboutElsewhere { span } => error("vib::field::value", span, "`about` belongs to `inertia` only")
                .help("write `inertia = 0.8 kg*m^2 about A`"),
            FieldMissing { span, expected } => {
                error("vib::field::missing", span, format!("{} is missing here", expected.noun))
                    .help(format!("add `{}`", expected.example))
            }

            NotABody { span, word, found, declared } => {
                error("vib::part::kind", span, format!("`{word}` is {found}, no body"))
                    .related(declared, "declared here")
                    .help("name a body, a base or `ground`")
            }
            Negative { span, what } => error("vib::value::negative", span, format!("{what} cannot be negative")),
            InertiaWithoutPlace { span, name } => {
                error("vib::body::no_place", span, "an inertia about a point needs the place of the centre of mass")
                    .help(format!("give `{name}` its centre, such as `at = (0.4 m, 0)`"))
            }
            InertiaTooSmall { span, least, given } => {
                error("vib::inertia::too_small", span, "the mass alone has more inertia about that point")
                    .label(format!("{} kg*m^2, the mass alone {} kg*m^2", short(given), short(least)))
                    .help("an inertia about a point is at least mass times distance squared of the centre `at`")
            }
            GivenTwice { span, other, what } => {
                error("vib::body::given_twice", span, format!("{what} follows from the shape already"))
                    .related(other, "from this shape")
                    .help("keep one of them")
            }
            UnknownShape { span, suggestion } => {
                let help =
                    suggestion.is_none().then(|| "write `rod(A, B)`, `disk(r)`, `ring(r)` or `box(w, h)`".into());
                with_suggestion(
                    error("vib::shape::unknown", span, "this is no shape"),
                    suggestion.map(str::to_string),
                    help,
                )
            }
            ShapeSize { span, what } => error("vib::shape::size", span, what),
            FreeAndMore { span, free } => {
                error("vib::body::freedom", span, "`free` gives the body every motion already")
                    .related(free, "here")
                    .help("keep `free`, or the single motions")
            }
            MovesWhere { span } => error("vib::body::freedom", span, "where it moves is not clear")
                .help("write `moves x`, `moves y`, `moves x y` or `moves along (1, 1)`"),
            BaseWithoutMotion { span, name } => {
                error("vib::base::no_motion", span, format!("the base `{name}` has no motion"))
                    .help("write `moves x`, `moves y` or `turns` in it; what never moves is `ground`")
            }
            NoFreedom { span, name } => error("vib::body::no_freedom", span, format!("`{name}` has no freedom"))
                .label("neither a freedom clause nor a joint")
                .help(format!(
                    "say how it moves, such as `moves x`, or tie it with a joint: `pivot p: ground@(0, 0) -- {name}`"
                )),

            PropertyMissing { span, name, what, freedom } => property_missing(span, &name, what, freedom),
            CentreMissing { span, name } => {
                error("vib::body::no_place", span, format!("`{name}` turns, and the place of its mass is not known"))
                    .label("no position")
                    .help("give the centre of mass: `at = (0, -1 m)`, or `shape = rod(A, B)`")
            }
            Empty { span } => error("vib::scene::empty", span, "there is no body in this model")
                .help("declare one, such as `body block { mass = 1 kg, moves x }`"),

            JointOfOnePart { span, part } => {
                error("vib::joint::equal_ends", span, format!("both ends of the joint are on `{part}`"))
                    .help("a joint ties two different parts")
            }
            SlideWithoutDirection { span } => error("vib::joint::direction", span, "a slide needs a direction")
                .help("add it: `slide g: a -- b along (1, 0)`"),
            PivotWithoutPlace { span, part } => error("vib::joint::no_place", span, "where the pivot is, is not known")
                .help(format!("write the point after one of the ends: `{part}@(0, 0)`")),
            EndsApart { spans, places } => ends_apart(spans, places),

            EqualEnds { span, part } => error("vib::element::equal_ends", span, format!("both ends are on `{part}`"))
                .help("the two ends are on different parts; what acts within one part moves nothing"),
            ZeroLength { span } => error("vib::element::zero_length", span, "the two ends are the same point as drawn")
                .label("no line between them")
                .help("draw the ends apart, or give a fixed direction: `along = x`"),
            DirectionUnknown { span, part } => {
                error("vib::element::direction_unknown", span, "the direction in which this acts is not known")
                    .label(format!("`{part}` has no position"))
                    .help(format!("give the end a point, `{part}@(0, 0)`, or give a direction: `along = x`"))
            }
            DirectionOfTorsion { span } => {
                error("vib::element::torsion_along", span, "what acts on the rotation has no direction")
                    .help("leave `along` out, or write a stiffness in N/m or a damping coefficient in N*s/m")
            }
            NoEndTurns { span } => error("vib::element::no_end_turns", span, "none of these parts can turn")
                .help("give a body the freedom to turn: `turns`, `free` or a pivot"),
            FreeLengthAndPreload { span, free } => {
                error("vib::spring::free_length_and_preload", span, "a spring has a free length or a preload, not both")
                    .related(free, "the free length")
                    .help("keep one: the other follows from it and the drawing")
            }
            NoDrawnLength { span } => error(
                "vib::spring::no_length",
                span,
                "without positions the spring has no drawn length to compare with",
            )
            .help("give `preload` in place of `free_length`, or draw the ends: `ground@(-0.5 m, 0)`"),
            NegativeStiffness { span } => Diagnostic::note(
                Code("vib::spring::negative"),
                span,
                "this stiffness is negative: it drives away from rest",
            ),
            NegativeDamping { span } => {
                Diagnostic::note(Code("vib::damper::negative"), span, "this damping is negative: it feeds energy in")
            }

            ForceWithoutDirection { span } => {
                error("vib::input::direction_unknown", span, "the direction of this force is not known")
                    .help("add it: `along x` or `along (1, 1)`")
            }
            InputWithoutEffect { span, part } => {
                error("vib::input::no_effect", span, format!("nothing on `{part}` moves by this"))
                    .help("a force or torque acts on a body")
            }
            SignalOfManyMotions { span } => {
                error("vib::signal::many_motions", span, "the base has several motions: which one has this signal?")
                    .help("declare one base for each motion")
            }
            NotASignal { span } => error("vib::signal::unknown", span, "a signal is expected here")
                .help("write `constant(10 N)`, `step(10 N, 0 s)`, `harmonic(10 N, 1.5 Hz)`, ... or a sum of them"),
            UnknownSignal { span, word, suggestion } => {
                let help = "known are constant, step, impulse, ramp, pulse, harmonic, chirp, table".to_string();
                let message = format!("there is no signal `{word}`");
                let help = suggestion.is_none().then_some(help);
                with_suggestion(error("vib::signal::unknown", span, message), suggestion.map(str::to_string), help)
            }
            SignalArguments { span, name, form } => {
                error("vib::signal::arguments", span, format!("`{name}` has other arguments"))
                    .help(format!("write `{form}`"))
            }
            TimesReversed { span } => error("vib::signal::times", span, "this time is not after the one before it"),

            NoMotion { span } => error("vib::motion::none", span, "there is no motion in this")
                .help("write a motion, such as `block.x`, `rod.angle` or `s.force`"),
            NonLinear { span } => error("vib::motion::non_linear", span, "this is not linear in the motions")
                .help("motions may be added, and multiplied by numbers; nothing else"),
            PointWithoutMotion { span } => {
                error("vib::motion::none", span, "which motion of this point?").help("add it, as in `rod@(0, -2 m).x`")
            }
            MotionOfWhat { span } => {
                error("vib::motion::none", span, "a motion belongs to a body, a spring or a damper")
                    .help("write its name before the dot, as in `block.x`")
            }
            UnknownMotion { span, word, of, suggestion, known } => {
                let help = suggestion.is_none().then(|| format!("{of} has {}", listed(&known)));
                let message = format!("{of} has no `{word}`");
                with_suggestion(error("vib::motion::unknown", span, message), suggestion.map(str::to_string), help)
            }
            NoSuchFreedom { span, name, turns } => {
                let message =
                    if turns { format!("`{name}` does not turn") } else { format!("`{name}` does not move so") };
                error("vib::motion::impossible", span, message)
                    .label("always zero")
                    .help(format!("give `{name}` that freedom, or leave this motion out"))
            }
            CoupleOfOthers { span } => {
                error("vib::couple::motions", span, "a coupling relates displacements and angles of bodies")
                    .help("write it in `x`, `y` and `angle`, as in `wheel.angle = -block.x / 0.3 m`")
            }
            NoInitialState { span, word, found } => {
                error("vib::part::kind", span, format!("`{word}` is {found}: only bodies have an initial state"))
            }

            NotAMeasure { span } => error("vib::measure::unknown", span, "a measure is expected here")
                .help("write `frequency(1)`, `damping(1)`, `gain(input -> output, 30 Hz)`, `stable`, ..."),
            UnknownMeasure { span, word, suggestion } => {
                let help =
                    "known are frequency, damping, gain, phase, amplitude, static, peak, rms, stable".to_string();
                let help = suggestion.is_none().then_some(help);
                let message = format!("there is no measure `{word}`");
                with_suggestion(error("vib::measure::unknown", span, message), suggestion.map(str::to_string), help)
            }
            MeasureArguments { span, name, form } => {
                error("vib::measure::arguments", span, format!("`{name}` has other arguments"))
                    .help(format!("write `{form}`"))
            }
            ArrowMissing { span } => error("vib::measure::arguments", span, "from which input to which output?")
                .help("write `input -> output`, as in `gain(floor -> table.y, 30 Hz)`"),
            NotAnInput { span, found } => {
                error("vib::measure::input", span, format!("one input is expected here, this is {found}")).help(
                    "name a force, a torque or a base; of a base with several motions one of them, as in `floor.y`",
                )
            }
            NotAnOutput { span, word, found, declared } => {
                error("vib::measure::output", span, format!("`{word}` is {found}, no output"))
                    .related(declared, "declared here")
                    .help("name an output, or a motion such as `table.y`")
            }
            ModeNumber { span } => error("vib::measure::mode", span, "modes are numbered from 1"),
            RangeReversed { span } => {
                error("vib::solve::range", span, "the range is empty").help("write the lower bound first")
            }
            RequireWhat { span } => error("vib::require::form", span, "a comparison of a measure is expected here")
                .help("write `require frequency(1) > 2 Hz` or `require stable`"),

            Unused { span, name, kind } => unused(span, &name, kind),
            Idle { span, name, word, why } => {
                let message = format!("this {word} of `{name}` {why}");
                Diagnostic::warning(Code("vib::unused::property"), span, message)
                    .help("leave it out, or add the freedom that uses it")
            }
            IdleGravity { span } => {
                Diagnostic::note(Code("vib::unused::gravity"), span, "gravity moves nothing in this scene")
            }
            NotAvailable { span, what } => {
                error("vib::feature::not_available", span, format!("{what} is not available in this version"))
                    .help("it is checked already; analyses take it into account in a later version")
            }
        }
    }
}

fn with_suggestion(diagnostic: Diagnostic, suggestion: Option<String>, help: Option<String>) -> Diagnostic {
    match (suggestion, help) {
        (Some(word), _) => diagnostic.help(format!("did you mean `{word}`?")),
        (None, Some(help)) => diagnostic.help(help),
        (None, None) => diagnostic,
    }
}

/// `mass`, `moves`, `at`
fn listed(words: &[&str]) -> String {
    words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ")
}

/// Five digits, for the eye.
fn short(value: f64) -> String {
    format!("{value:.4e}").parse::<f64>().unwrap_or(value).to_string()
}

fn unit_unknown(span: Span, symbol: &str, suggestion: Option<String>, is_value: bool) -> Diagnostic {
    let diagnostic = error("vib::unit::unknown", span, format!("unknown unit `{symbol}`"));
    match (is_value, suggestion) {
        (true, _) => {
            diagnostic.help(format!("`{symbol}` is a parameter: write spaces around `*` or `/` to calculate with it"))
        }
        (false, Some(meant)) => diagnostic.help(format!("did you mean `{meant}`?")),
        (false, None) => diagnostic.help("a word glued to a number is its unit; to multiply, write ` * ` with spaces"),
    }
}

/// `N/(m*s)` for `N/m*s`: the other reading.
fn below(head: &str, tail: &str) -> String {
    let (above, below) = head.rsplit_once('/').unwrap_or((head, ""));
    format!("{above}/({below}*{tail})")
}

/// `N*s/m` for `N/m*s`.
fn swapped(head: &str, tail: &str) -> String {
    match head.split_once('/') {
        Some(("", below)) => format!("{tail}/{below}"),
        Some((above, below)) => format!("{above}*{tail}/{below}"),
        None => format!("{head}*{tail}"),
    }
}

fn unit_missing(span: Span, number: &str, expected: Expected) -> Diagnostic {
    let unit = expected.dimension.usual_unit();
    error("vib::unit::missing", span, format!("{} is expected here, this number has no unit", expected.noun))
        .label("a plain number")
        .help(format!("write the unit after it, such as `{number} {unit}`"))
}

fn unit_mismatch(span: Span, found: Dimension, expected: Expected, declared: Option<(String, Span)>) -> Diagnostic {
    let what = found.noun().map_or_else(|| format!("a quantity in {found}"), str::to_string);
    let message = format!("{} is expected here, this is {what}", expected.noun);
    let unit = found.usual_unit();
    let mut diagnostic = error("vib::unit::mismatch", span, message)
        .label(if unit.is_empty() { "no unit".to_string() } else { unit })
        .help(format!("write {}, such as `{}`", expected.noun, expected.example));
    if let Some((name, place)) = declared {
        diagnostic = diagnostic.related(place, format!("`{name}` is declared here"));
    }
    diagnostic
}

fn frequency_reading(span: Span, value: f64) -> Diagnostic {
    let hertz = short(value / std::f64::consts::TAU);
    let value = short(value);
    error("vib::unit::frequency", span, "this is in 1/s: are these radians or cycles?")
        .label(format!("{value} rad/s = {hertz} Hz, or {value} Hz?"))
        .help("multiply by `1 rad` where it is an angular frequency, such as sqrt(k/m), or by `1 rev` where it counts cycles")
}

/// What an operator does, as a verb.
fn verb(operator: Binary) -> &'static str {
    match operator {
        Binary::Add => "added to",
        Binary::Subtract => "subtracted from",
        _ => "compared with",
    }
}

fn named(dimension: Dimension) -> String {
    dimension.noun().map_or_else(|| format!("a quantity in {dimension}"), str::to_string)
}

fn unit_or_none(dimension: Dimension) -> String {
    let unit = dimension.usual_unit();
    if unit.is_empty() { "no unit".into() } else { unit }
}

fn operation(fault: Fault, operator: Binary, left: Span, right: Span) -> Diagnostic {
    match fault {
        Fault::Dimensions(a, b) => {
            let message = format!("{} cannot be {} {}", named(b), verb(operator), named(a));
            error("vib::unit::mismatch", right, message)
                .label(unit_or_none(b))
                .related(left, unit_or_none(a))
                .help("both sides need the same unit")
        }
        Fault::Kind { needed, found } => {
            error("vib::value::kind", right, format!("{needed} is expected here, this is {found}"))
                .related(left, "the other side")
        }
        Fault::NotPlain(found) => {
            error("vib::unit::mismatch", right, "an exponent is a plain number").label(unit_or_none(found))
        }
        Fault::Exponent => {
            error("vib::unit::exponent", right, "a quantity with a unit needs a small fraction as its exponent")
                .help("write a power such as `^2` or `^(1/2)`")
        }
        Fault::DivisionByZero => error("vib::number::division_by_zero", right, "division by zero").label("zero"),
        Fault::RootOfNegative => error("vib::number::root_of_negative", left, "a root of a negative number"),
        Fault::Domain(_) | Fault::Overflow => {
            error("vib::number::overflow", left.to(right), "this number is beyond what can be computed with")
                .help("sizes from 1e-300 to 1e300 in SI units can be used")
        }
    }
}

fn function_fault(fault: Fault, function: &str, argument: Span, span: Span) -> Diagnostic {
    match fault {
        Fault::NotPlain(found) => {
            let message = format!("`{function}` is of a plain number or an angle, this is {}", named(found));
            error("vib::unit::mismatch", argument, message).label(unit_or_none(found))
        }
        Fault::Dimensions(a, b) => {
            let message = format!("`{function}` compares {} with {}", named(a), named(b));
            error("vib::unit::mismatch", span, message).help("all arguments need the same unit")
        }
        Fault::Kind { needed, found } => {
            error("vib::value::kind", argument, format!("{needed} is expected here, this is {found}"))
        }
        Fault::RootOfNegative => error("vib::number::root_of_negative", argument, "the root of a negative number"),
        Fault::DivisionByZero => error("vib::number::division_by_zero", span, format!("`{function}` is infinite here")),
        Fault::Domain(domain) => error("vib::number::domain", argument, format!("`{function}` has no value here"))
            .help(format!("its argument is {domain}")),
        Fault::Exponent | Fault::Overflow => {
            error("vib::number::overflow", span, "this number is beyond what can be computed with")
                .help("sizes from 1e-300 to 1e300 in SI units can be used")
        }
    }
}

fn pair(fault: Fault, left: Span, right: Span) -> Diagnostic {
    let Fault::Dimensions(a, b) = fault else {
        return operation(fault, Binary::Add, left, right);
    };
    error("vib::unit::mismatch", right, format!("this is {}, the first component is {}", named(b), named(a)))
        .label(unit_or_none(b))
        .related(left, unit_or_none(a))
        .help("both components need the same unit; a bare 0 fits any")
}

fn argument_count(span: Span, function: &str, expected: usize, found: usize) -> Diagnostic {
    let plural = if expected == 1 { "argument" } else { "arguments" };
    error("vib::function::arguments", span, format!("`{function}` takes {expected} {plural}, {found} are given"))
}

fn components(span: Span, found: usize) -> Diagnostic {
    if found == 3 {
        return error("vib::value::components", span, "a third coordinate is reserved for spatial scenes")
            .help("write (x, y)");
    }
    error("vib::value::components", span, "a point has two coordinates").help("write (x, y)")
}

fn index_out_of_range(
    span: Span,
    name: &str,
    word: &str,
    given: usize,
    ranges: &[(i32, i32)],
    declared: Span,
) -> Diagnostic {
    let diagnostic =
        error("vib::name::index", span, format!("there is no `{name}`")).related(declared, "declared here");
    let indices: String = ranges.iter().map(|(low, high)| format!("[{low}..{high}]")).collect();
    match (given == ranges.len(), ranges.is_empty()) {
        (true, _) => diagnostic.help(format!("declared are `{word}{indices}`")),
        (false, true) => diagnostic.help(format!("`{word}` has no index: write `{word}`")),
        (false, false) => diagnostic.help(format!("its indices are `{word}{indices}`")),
    }
}

fn duplicate(span: Span, name: &str, first: Option<Span>) -> Diagnostic {
    let diagnostic = error("vib::name::duplicate", span, format!("`{name}` is declared twice"));
    match first {
        Some(first) if first == span => {
            diagnostic.help(format!("each repetition needs a name of its own: write `{name}[i]`"))
        }
        Some(first) => diagnostic.related(first, "declared first here").help("choose another name for one of them"),
        None => diagnostic.help("the `repeat` around it has this index already: choose another one"),
    }
}

fn cycle(span: Span, members: &[(String, Span)]) -> Diagnostic {
    /// More of them say no more.
    const SHOWN: usize = 8;
    let mut names: Vec<String> = members.iter().take(SHOWN).map(|(name, _)| format!("`{name}`")).collect();
    if members.len() > SHOWN {
        names.push("...".into());
    }
    names.extend(members.first().map(|(name, _)| format!("`{name}`")));
    let message = format!("the value depends on itself: {}", names.join(" -> "));
    let mut diagnostic = error("vib::parameter::cycle", span, message).label("closes the circle");
    for (name, place) in members.iter().take(SHOWN) {
        diagnostic = diagnostic.related(*place, format!("`{name}` is declared here"));
    }
    diagnostic.help("give one of them a value of its own")
}

fn kind_noun(kind: DefinitionKind) -> &'static str {
    match kind {
        DefinitionKind::Param => "parameter",
        DefinitionKind::Let => "value",
        DefinitionKind::Point => "point",
    }
}

fn unused(span: Span, name: &str, kind: DefinitionKind) -> Diagnostic {
    let code = match kind {
        DefinitionKind::Point => Code("vib::unused::point"),
        DefinitionKind::Param | DefinitionKind::Let => Code("vib::unused::parameter"),
    };
    Diagnostic::warning(code, span, format!("the {} `{name}` is never used", kind_noun(kind)))
        .help("use it, or leave it out")
}

fn not_a_parameter(span: Span, word: &str, kind: DefinitionKind, declared: Span) -> Diagnostic {
    let what = if kind == DefinitionKind::Let { "derived: declared with `let`" } else { "a point" };
    error("vib::setting::not_a_parameter", span, format!("`{word}` is no parameter, it is {what}"))
        .related(declared, "declared here")
        .help("declare it with `param` to give it a value from outside or to solve for it")
}

fn unlike_declared(span: Span, found: Dimension, wanted: Dimension, declared: Option<(String, Span)>) -> Diagnostic {
    let unit = wanted.usual_unit();
    let (message, help) = match unit.as_str() {
        "" => (
            format!("a plain number is expected here, this is {}", named(found)),
            "write it without a unit".to_string(),
        ),
        _ => (
            format!("{} is expected here, this is {}", named(wanted), named(found)),
            format!("write it in {unit} or another unit of that kind"),
        ),
    };
    let mut diagnostic = error("vib::unit::mismatch", span, message).label(unit_or_none(found)).help(help);
    if let Some((name, place)) = declared {
        diagnostic = diagnostic.related(place, format!("`{name}` is declared here"));
    }
    diagnostic
}

fn property_missing(span: Span, name: &str, what: &str, freedom: &str) -> Diagnostic {
    let (code, example) = match what {
        "mass" => ("vib::mass::missing", "mass = 1 kg"),
        _ => ("vib::inertia::missing", "inertia = 0.8 kg*m^2"),
    };
    error(code, span, format!("`{name}` {freedom}, and its {what} is missing"))
        .label(format!("needs its {what}"))
        .help(format!("add `{example}`"))
}

fn ends_apart(spans: [Span; 2], places: [(f64, f64); 2]) -> Diagnostic {
    let place = |(x, y): (f64, f64)| format!("at ({} m, {} m)", short(x), short(y));
    error("vib::joint::ends_apart", spans[1], "the ends of the joint are at different points as drawn")
        .label(place(places[1]))
        .related(spans[0], place(places[0]))
        .help("draw both ends at the same point, or give the point at one end only")
}
