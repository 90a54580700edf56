//! Errors of bodies, joints, elements and inputs.

use super::{error, short, with_suggestion};
use crate::base::{Change, Code, Diagnostic, Span};
use crate::elements::Kind;
use crate::joints;
use crate::kinds::enumeration;
use crate::kinds::functions::{Function, SHAPES, SIGNALS};

/// A table that cannot be read, or was not given to the check.
pub const TABLE_UNREADABLE: Code = Code::file("vib::table::unreadable");

/// Errors of the parts of a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum PartError {
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
    /// `moves y angle`, and the translations among the words.
    MovesAndTurns {
        span: Span,
        translations: String,
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
    JointOfOnePart {
        span: Span,
        part: String,
    },
    SlideWithoutDirection {
        span: Span,
        kind: &'static joints::Kind,
    },
    PivotWithoutPlace {
        span: Span,
        part: String,
    },
    EndsApart {
        spans: [Span; 2],
        places: [(f64, f64); 2],
    },
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
        kind: &'static Kind,
    },
    NoEndTurns {
        span: Span,
        torsional: Option<(Span, &'static Kind)>,
    },
    FreeLengthAndPreload {
        span: Span,
        free: Span,
    },
    NoDrawnLength {
        span: Span,
    },
    NegativeCoefficient {
        span: Span,
        code: Code,
        message: &'static str,
    },
    DampingFeeds {
        span: Span,
    },
    DampingOverCritical {
        span: Span,
        ratio: f64,
    },
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
        function: &'static Function,
    },
    NoiseArguments {
        span: Span,
    },
    UnknownNoise {
        span: Span,
        word: String,
        suggestion: Option<&'static str>,
    },
    TimesReversed {
        span: Span,
    },
    /// A signal that begins before t = 0.
    SignalCut {
        span: Span,
        at: f64,
    },
    /// A signal that is over by t = 0.
    SignalOver {
        span: Span,
        at: f64,
    },
    PeriodicOf {
        span: Span,
    },
    PeriodNotPositive {
        span: Span,
    },
    PeriodShort {
        span: Span,
        named: Span,
        covered: f64,
    },
    PeriodLong {
        span: Span,
        named: Span,
        rest: f64,
        longest: f64,
    },
    PeriodOpen {
        span: Span,
        named: Span,
    },
    TableUnread {
        span: Span,
        reason: String,
    },
    TableRow {
        span: Span,
        found: RowFault,
        named: Span,
    },
    TableOrder {
        span: Span,
        named: Span,
    },
    TableTooShort {
        span: Span,
        rows: usize,
    },
    TableHeading {
        span: Span,
        named: Span,
        word: String,
        read: &'static str,
    },
    TableWithoutUnit {
        span: Span,
        read: &'static str,
    },
    TableUnitUnknown {
        span: Span,
        named: Span,
    },
    TableUnitsDiffer {
        span: Span,
        heading: Span,
    },
    TableUnitZero {
        span: Span,
    },
    TableSpeed {
        span: Span,
    },
    TableFirstColumn {
        span: Span,
        named: Span,
        is_distance: bool,
    },
    SignalsDiffer {
        span: Span,
    },
    ConstantOfRate {
        span: Span,
        noun: &'static str,
    },
    DelayInSum {
        span: Span,
    },
    DelayNegative {
        span: Span,
    },
    DelayOfOtherKind {
        span: Span,
        name: String,
        declared: Span,
    },
    DelayOfNothing {
        span: Span,
        name: String,
        declared: Span,
    },
    DelayOfItself {
        span: Span,
        name: String,
    },
    NotATable {
        span: Span,
        line: usize,
    },
    TableFrequencies {
        span: Span,
        named: Span,
    },
    NoiseTable {
        span: Span,
    },
    SpectrumDamping {
        span: Span,
        given: bool,
    },
    SpectrumArguments {
        span: Span,
    },
    SpectrumFrequency {
        span: Span,
    },
    SpectrumValue {
        span: Span,
    },
    SpectrumTable {
        span: Span,
    },
    SpectrumOfNoBase {
        span: Span,
    },
    SpectrumInSum {
        span: Span,
    },
    DelayOfSpectrum {
        span: Span,
        name: String,
        declared: Span,
    },
    NoiseDensity {
        span: Span,
    },
    NoiseFrequency {
        span: Span,
        is_first: bool,
    },
    RoadOfNoBase {
        span: Span,
    },
    RoadSpeed {
        span: Span,
    },
}

/// Errors of a row of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowFault {
    /// The number of fields, which should be two.
    Fields(usize),
    /// The field for the time is not a number.
    Time,
    Value,
}

impl PartError {
    /// The diagnostic for it.
    pub fn diagnostic(self) -> Diagnostic {
        use PartError::*;
        match self {
            InertiaWithoutPlace { span, name } => {
                error("vib::body::no_place", span, "an inertia about a point needs the place of the centre of mass")
                    .help(format!("give `{name}` its centre, such as `at = (0.4 m, 0)`"))
                    .fix_by_field(span, &["at = (0.4 m, 0)"])
            }
            InertiaTooSmall { span, least, given } => {
                error("vib::inertia::too_small", span, "the mass alone has more inertia about that point")
                    .label(format!("{} kg*m^2, the mass alone {} kg*m^2", short(given), short(least)))
                    .help("an inertia about a point is at least mass times distance squared of the centre `at`")
            }
            GivenTwice { span, other, what } => {
                error("vib::body::given_twice", span, format!("the shape already determines {what}"))
                    .with_related(other, "from this shape")
                    .help("keep one of them")
                    .fix(span, Change::DropField)
            }
            UnknownShape { span, suggestion } => {
                let forms = || SHAPES.iter().map(|shape| format!("`{}`", shape.function.form)).collect::<Vec<_>>();
                let help = suggestion.is_none().then(|| format!("write {}", enumeration(&forms(), "or")));
                with_suggestion(
                    error("vib::shape::unknown", span, "this is not a shape"),
                    suggestion.map(str::to_string),
                    help,
                )
            }
            ShapeSize { span, what } => error("vib::shape::size", span, what),
            FreeAndMore { span, free } => error("vib::body::freedom", span, "`free` already includes every motion")
                .with_related(free, "here")
                .help("keep `free`, or the single motions")
                .fix(span, Change::DropField)
                .fix(free, Change::DropField),
            MovesWhere { span } => error("vib::body::freedom", span, "the direction of its motion is not clear")
                .help("write `moves x`, `moves y`, `moves x y` or `moves along (1, 1)`"),
            MovesAndTurns { span, translations } => {
                error("vib::body::freedom", span, "`moves` names translations; a rotation is `turns`")
                    .help(format!("write `moves {translations}, turns`"))
                    .fix(span, Change::Replace(format!("{translations}, turns")))
            }
            BaseWithoutMotion { span, name } => {
                error("vib::base::no_motion", span, format!("the base `{name}` has no motion"))
                    .help("write `moves x`, `moves y` or `turns` in it; a support that never moves is `ground`")
                    .fix_by_field(span, &["moves x", "moves y", "turns"])
            }
            NoFreedom { span, name } => error(
                "vib::body::no_freedom",
                span,
                format!("`{name}` has no degree of freedom"),
            )
            .label("neither a freedom clause nor a joint")
            .help(format!(
                "say how it moves, such as `moves x`, or connect it with a joint: `pivot p: ground@(0, 0) -- {name}`"
            ))
            .fix_by_field(span, &["moves x", "moves y", "turns", "free"]),
            PropertyMissing { span, name, what, freedom } => property_missing(span, &name, what, freedom),
            CentreMissing { span, name } => {
                error("vib::body::no_place", span, format!("`{name}` turns, but its centre of mass is not known"))
                    .label("no position")
                    .help("give the centre of mass: `at = (0, -1 m)`, or `shape = rod(A, B)`")
                    .fix_by_field(span, &["at = (0, -1 m)"])
            }
            Empty { span } => error("vib::scene::empty", span, "there is no body in this model")
                .help("declare one, such as `body block { mass = 1 kg, moves x }`")
                .fix(span, Change::Declare("body block { mass = 1 kg, moves x }")),
            JointOfOnePart { span, part } => {
                error("vib::joint::equal_ends", span, format!("both ends of the joint are on `{part}`"))
                    .help("a joint connects two different parts")
            }
            SlideWithoutDirection { span, kind } => {
                error("vib::joint::direction", span, format!("a {} needs a direction", kind.keyword))
                    .help(format!("add it: `{}`", kind.form))
                    .fix(span, Change::Append(" along (1, 0)"))
                    .fix(span, Change::Append(" along (0, 1)"))
            }
            PivotWithoutPlace { span, part } => {
                error("vib::joint::no_place", span, "the place of the pivot is not known")
                    .help(format!("write the point after one of the ends: `{part}@(0, 0)`"))
                    .fix(span, Change::After("@(0, 0)".into()))
            }
            EndsApart { spans, places } => ends_apart(spans, places),
            EqualEnds { span, part } => error("vib::element::equal_ends", span, format!("both ends are on `{part}`"))
                .help("the two ends must be on different parts: a force within one part has no effect"),
            ZeroLength { span } => error("vib::element::zero_length", span, "the two ends are the same point as drawn")
                .label("no line between them")
                .help("draw the ends apart, or give a fixed direction: `along = x`")
                .fix_by_field(span, &["along = x", "along = y"]),
            DirectionUnknown { span, part } => {
                error("vib::element::direction_unknown", span, "the direction in which this acts is not known")
                    .label(format!("`{part}` has no position"))
                    .help(format!("give the end a point, `{part}@(0, 0)`, or give a direction: `along = x`"))
                    .fix_by_field(span, &["along = x", "along = y"])
            }
            DirectionOfTorsion { span, kind } => {
                let (noun, unit) = (kind.coefficient().expected_number(false).noun, kind.unit(false));
                error("vib::element::torsion_along", span, "a torsional element has no direction")
                    .help(format!("leave `along` out, or write {noun} in {unit}"))
                    .fix(span, Change::DropField)
            }
            NoEndTurns { span, torsional } => no_end_turns(span, torsional),
            FreeLengthAndPreload { span, free } => {
                error("vib::spring::free_length_and_preload", span, "a spring has a free length or a preload, not both")
                    .with_related(free, "the free length")
                    .help("keep one: the other follows from it and the drawing")
                    .fix(span, Change::DropField)
                    .fix(free, Change::DropField)
            }
            NoDrawnLength { span } => error(
                "vib::spring::no_length",
                span,
                "without positions the spring has no drawn length to compare with",
            )
            .help("give `preload` instead of `free_length`, or draw the ends: `ground@(-0.5 m, 0)`"),
            NegativeCoefficient { span, code, message } => Diagnostic::note(code, span, message),
            DampingFeeds { span } => Diagnostic::note(
                Code::model("vib::damping::negative"),
                span,
                "this damping is negative: it adds energy",
            ),
            DampingOverCritical { span, ratio } => {
                let message =
                    format!("a damping ratio of {} is {} %: no mode oscillates", short(ratio), short(100.0 * ratio));
                Diagnostic::warning(Code::model("vib::damping::large"), span, message)
                    .help("critical damping is 1, or 100 %; write a ratio in percent as `2 %`")
            }
            ForceWithoutDirection { span } => {
                error("vib::input::direction_unknown", span, "the direction of this force is not known")
                    .help("add it: `along x` or `along (1, 1)`")
                    .fix(span, Change::After(" along x".into()))
                    .fix(span, Change::After(" along y".into()))
            }
            InputWithoutEffect { span, part } => {
                error("vib::input::no_effect", span, format!("this moves nothing on `{part}`"))
                    .help("a force or torque acts on a body")
            }
            SignalOfManyMotions { span } => error(
                "vib::signal::many_motions",
                span,
                "the base has several motions: which of them does this signal prescribe?",
            )
            .help("declare one base for each motion"),
            NotASignal { span } => error("vib::signal::unknown", span, "a signal is expected here")
                .help("write `constant(10 N)`, `step(10 N, 0 s)`, `harmonic(10 N, 1.5 Hz)`, ... or a sum of them"),
            UnknownSignal { span, word, suggestion } => {
                let names: Vec<&str> = SIGNALS.iter().map(|signal| signal.function.name).collect();
                let help = format!("the signals are {}", names.join(", "));
                let message = format!("there is no signal `{word}`");
                let help = suggestion.is_none().then_some(help);
                with_suggestion(error("vib::signal::unknown", span, message), suggestion.map(str::to_string), help)
            }
            SignalArguments { span, function } => {
                error("vib::signal::arguments", span, format!("`{}` has other arguments", function.name))
                    .help(format!("write `{}`", function.example))
            }
            NoiseArguments { span } => error("vib::signal::arguments", span, "`noise` has other arguments").help(
                "write `noise(white 3 N^2/Hz)`, `noise(3 N^2/Hz, 20 Hz .. 2 kHz)`, \
                 `noise((20 Hz, 1 N^2/Hz), (80 Hz, 4 N^2/Hz))` or `noise(road(16e-6 m^3, 20 m/s))`",
            ),
            UnknownNoise { span, word, suggestion } => {
                let help = suggestion.is_none().then(|| {
                    "the forms are `noise(road(16e-6 m^3, 20 m/s))` and `noise(table(\"psd.csv\", 1 m^2/Hz))`"
                        .to_string()
                });
                let message = format!("`noise` knows no function `{word}`");
                with_suggestion(error("vib::signal::arguments", span, message), suggestion.map(str::to_string), help)
            }
            TimesReversed { span } => {
                error("vib::signal::times", span, "this time is not later than the one before it")
                    .help("the times of a signal are points in time, each later than the one before it, not durations")
            }
            SignalCut { span, at } => {
                let message = format!("this begins at {} s, and what it is before t = 0 is left out", short(at));
                Diagnostic::note(Code::model("vib::signal::cut"), span, message)
                    .help("signals act from t = 0 on; write later times if all of it is meant")
            }
            SignalOver { span, at } => {
                let message =
                    format!("this has no effect: it is over at {} s, and signals act from t = 0 on", short(at));
                Diagnostic::warning(Code::model("vib::unused::signal"), span, message)
                    .help("write times from `0 s` on; a body that moves already at t = 0 has a line such as `initial a { vx = 1 m/s }`")
            }
            PeriodicOf { span } => error("vib::signal::arguments", span, "`periodic` repeats a table")
                .help("write `periodic(table(\"file.csv\", 1 kN), 0.5 s)`"),
            PeriodNotPositive { span } => error("vib::signal::period", span, "a period must be longer than 0 s")
                .help("write the time after which the rows of the table come again, such as `0.5 s`"),
            PeriodShort { span, named, covered } => {
                let message = format!("this period is shorter than its table, whose rows cover {} s", short(covered));
                error("vib::signal::period", span, message)
                    .with_related(named, "the table is named here")
                    .help("give the whole period, or remove the rows after it")
            }
            PeriodLong { span, named, rest, longest } => {
                let (rest, longest) = (short(rest), short(longest));
                let message = format!("this period ends {rest} s after the last row of its table");
                error("vib::signal::period", span, message)
                    .label(format!("no two rows are more than {longest} s apart"))
                    .with_related(named, "the table is named here")
                    .help("write rows up to the end of the period; the last one may have the time of the next period's first row")
            }
            PeriodOpen { span, named } => {
                error("vib::signal::period", span, "this motion would jump at the end of each period")
                    .with_related(named, "the last row of this table has another value than its first row")
                    .help("end the table with the value of its first row; a steep flank takes rows of its own")
            }
            TableUnread { span, reason } => Diagnostic::error(TABLE_UNREADABLE, span, "this table cannot be read")
                .label(reason)
                .help("the file's path is relative to the model's folder"),
            TableRow { span, found, named } => table_row(span, found, named),
            TableOrder { span, named } => {
                error("vib::table::order", span, "this time is not later than that of the previous row")
                    .with_related(named, "the table is named here")
                    .help("sort the rows by time, each time once")
            }
            TableTooShort { span, rows } => {
                let found = if rows == 0 { "no row" } else { "one row" };
                error("vib::table::too_short", span, "a table needs at least two rows")
                    .label(format!("{found} in this file"))
                    .help("write a row for each time, such as `0.5, 12`: time in s, value in SI units")
            }
            TableHeading { span, named, word, read } => {
                let message = format!("the values of this table are read as {read}, but its heading says `{word}`");
                error("vib::table::heading", span, message)
                    .with_related(named, "the table is named here")
                    .help("give the unit in the heading, as in `acceleration [m/s^2]`, or in the call: `table(\"file.csv\", 1 g0)`")
            }
            TableWithoutUnit { span, read } => {
                let message = format!("this table does not give a unit: its values are read as {read} in SI units");
                Diagnostic::warning(Code::model("vib::table::unit"), span, message)
                    .help("give the unit in the call, as in `table(\"file.csv\", 1 kN)`, or in the heading, as in `force [kN]`")
            }
            TableUnitUnknown { span, named } => {
                error("vib::unit::unknown", span, "the brackets of this heading do not contain a unit")
                    .with_related(named, "the table is named here")
                    .help("write a unit in square brackets, as in `acceleration [m/s^2]`")
            }
            TableUnitsDiffer { span, heading } => {
                error("vib::table::units_differ", span, "this unit is not the one in the heading of the table")
                    .with_related(heading, "the heading")
                    .help("keep one of them, or make them agree")
            }
            TableUnitZero { span } => error("vib::table::scale", span, "the unit of a table cannot be zero")
                .help("write the unit of the values, such as `1 mm`"),
            TableSpeed { span } => error("vib::table::scale", span, "the speed along a table must be positive")
                .help("write the speed along the first column, such as `speed = 20 m/s`"),
            TableFirstColumn { span, named, is_distance } => {
                let (message, help) = if is_distance {
                    ("the first column of this table is a distance", "give the speed: `speed = 20 m/s`")
                } else {
                    (
                        "the first column of this table is not in a unit of time or, with a speed, of length",
                        "write `time [s]`, or with `speed = 20 m/s` in the call `distance [m]`",
                    )
                };
                error("vib::table::first_column", span, message)
                    .with_related(named, "the table is named here")
                    .help(help)
            }
            TableFrequencies { span, named } => {
                error("vib::table::first_column", span, "the first column of a density is a frequency in Hz")
                    .with_related(named, "the table is named here")
                    .help("write `frequency [Hz]`")
            }
            NoiseTable { span } => error(
                "vib::noise::density",
                span,
                "this table has a frequency or a density below zero, or no density at all",
            )
            .help("the first column is the frequency in Hz, the second the one-sided density"),
            SignalsDiffer { span } => {
                error("vib::signal::differ", span, "this signal is not of the same dimension as the one before it")
                    .help("the signals of a base are all displacements, all velocities or all accelerations")
            }
            ConstantOfRate { span, noun } => {
                error("vib::signal::constant_rate", span, format!("a base that has {noun} at rest is never at rest"))
                    .help("write `step(...)` for one that starts at a time, or a constant displacement")
            }
            DelayInSum { span } => error("vib::signal::delayed", span, "`delayed` cannot be part of a sum")
                .help("add the other signals to the input from which it is delayed"),
            DelayNegative { span } => error("vib::signal::delayed", span, "a delay cannot be negative")
                .help("swap the two inputs, and give the later one the delay"),
            DelayOfOtherKind { span, name, declared } => error(
                "vib::signal::delayed",
                span,
                format!("`{name}` is an input of another kind"),
            )
            .with_related(declared, "declared here")
            .help(
                "a force can be delayed from a force, a torque from a torque, a translation of a base from another one",
            ),
            DelayOfNothing { span, name, declared } => {
                error("vib::signal::delayed", span, format!("`{name}` has no signal"))
                    .with_related(declared, "declared here")
                    .help("give it one, such as `= step(...)`")
            }
            DelayOfItself { span, name } => {
                error("vib::signal::cycle", span, format!("the signal of `{name}` is delayed from itself"))
                    .help("give one of the inputs in this cycle its own signal")
            }
            SpectrumDamping { span, given: false } => error(
                "vib::spectrum::damping",
                span,
                "this response spectrum does not say for which damping ratio it is",
            )
            .help("add it: `spectrum((0.5 Hz, 0.3 g0), (33 Hz, 0.3 g0), damping = 5 %)`"),
            SpectrumDamping { span, given: true } => {
                error("vib::spectrum::damping", span, "the damping ratio of a response spectrum is negative")
                    .help("write one of zero or more, such as `5 %`")
            }
            SpectrumArguments { span } => error("vib::signal::arguments", span, "`spectrum` has other arguments").help(
                "write two or more points, `spectrum((0.5 Hz, 0.3 g0), (33 Hz, 0.3 g0), damping = 5 %)`, or \
                 `spectrum(table(\"spectrum.csv\", 1 g0), damping = 5 %)`",
            ),
            SpectrumFrequency { span } => {
                error("vib::spectrum::points", span, "this frequency is not above zero and the one before it")
                    .help("write the frequencies of a spectrum in ascending order")
            }
            SpectrumValue { span } => {
                error("vib::spectrum::points", span, "this value of a spectrum is not above zero")
                    .help("write a magnitude; between the points the spectrum is straight in the logarithms")
            }
            SpectrumTable { span } => error(
                "vib::spectrum::points",
                span,
                "this table has fewer than two rows, or a frequency or value that is not above zero",
            )
            .help("the first column is the frequency in Hz, the second the value of the spectrum"),
            SpectrumOfNoBase { span } => {
                error("vib::spectrum::input", span, "a response spectrum is of the motion of a base")
                    .help("write it behind a base, as in `base quake { moves x } = spectrum(...)`")
            }
            SpectrumInSum { span } => {
                error("vib::spectrum::input", span, "a response spectrum cannot be part of a sum")
                    .help("maxima are not simultaneous, so they cannot be added to other signals")
            }
            DelayOfSpectrum { span, name, declared } => error(
                "vib::spectrum::input",
                span,
                format!("`{name}` has a response spectrum, which has no time history"),
            )
            .with_related(declared, "declared here")
            .help("give both inputs a history, or each a spectrum of its own"),
            NoiseDensity { span } => error("vib::noise::density", span, "this density is not above zero")
                .help("write a density above zero; outside its range or its points it is zero"),
            NoiseFrequency { span, is_first } => {
                let message = if is_first {
                    "this frequency is not above zero"
                } else {
                    "this frequency is not above the one before it"
                };
                error("vib::noise::frequency", span, message)
                    .help("write the frequencies of a density in ascending order")
            }
            RoadOfNoBase { span } => error("vib::noise::road", span, "a road moves a base along a line")
                .help("write it behind a base, as in `base lane { moves y } = noise(road(16e-6 m^3, 20 m/s))`"),
            RoadSpeed { span } => error("vib::noise::road", span, "the speed along a road is not above zero")
                .help("write how fast the road is covered, such as `20 m/s`"),
            NotATable { span, line } => error("vib::table::row", span, "this file is not a table")
                .label(format!("its line {line} is not a time and a value"))
                .help("write a time in s and a value in SI units in each line, such as `0.5, 12`"),
        }
    }
}

fn table_row(span: Span, found: RowFault, named: Span) -> Diagnostic {
    let (message, label) = match found {
        RowFault::Fields(1) => ("this row of the table lacks a field", "one field"),
        RowFault::Fields(_) => ("this row of the table has too many fields", "more than two fields"),
        RowFault::Time => ("this row of the table has no time", "not a number"),
        RowFault::Value => ("this row of the table has no value", "not a number"),
    };
    error("vib::table::row", span, message)
        .label(label)
        .with_related(named, "the table is named here")
        .help("write a time in s and a value in SI units, such as `0.5, 12`")
}

/// `torsional` is the coefficient of an element whose unit requires a rotation.
fn no_end_turns(span: Span, torsional: Option<(Span, &'static Kind)>) -> Diagnostic {
    let diagnostic = error("vib::element::no_end_turns", span, "none of these parts can turn");
    let turns = "let a body turn: `turns`, `free` or a pivot";
    match torsional {
        Some((value, kind)) => {
            let (noun, unit) = (kind.coefficient().expected_number(false).noun, kind.unit(false));
            diagnostic
                .with_related(value, "its unit makes the element torsional")
                .help(format!("{turns}; {noun} along a line is in {unit}"))
        }
        None => diagnostic.help(turns),
    }
}

fn property_missing(span: Span, name: &str, what: &str, freedom: &str) -> Diagnostic {
    let (code, example) = match what {
        "mass" => ("vib::mass::missing", "mass = 1 kg"),
        _ => ("vib::inertia::missing", "inertia = 0.8 kg*m^2"),
    };
    error(code, span, format!("`{name}` {freedom}, but its {what} is missing"))
        .label(format!("needs its {what}"))
        .help(format!("add `{example}`"))
        .fix_by_field(span, &[example])
}

fn ends_apart(spans: [Span; 2], places: [(f64, f64); 2]) -> Diagnostic {
    let place = |(x, y): (f64, f64)| format!("at ({} m, {} m)", short(x), short(y));
    error("vib::joint::ends_apart", spans[1], "the ends of the joint are at different points as drawn")
        .label(place(places[1]))
        .with_related(spans[0], place(places[0]))
        .help("draw both ends at the same point, or give the point at one end only")
}
