//! Functions of the language, grouped by where they are used: shapes, signals, measures, kinds of damping, and functions
//! of numbers. See spec.md#expressions, spec.md#bodies, spec.md#signals, spec.md#scene and spec.md#measures.

use crate::base::{Dimension, Expected};

/// A function: its words and its arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Function {
    pub name: &'static str,
    /// The form with names for its arguments: `step(a, at)`.
    pub form: &'static str,
    /// An example with values for its arguments: `step(10 N, 0 s)`.
    pub example: &'static str,
    pub meaning: &'static str,
    pub arguments: &'static [Argument],
    /// Number of arguments at the end that may be left out.
    pub optional: usize,
    /// Arguments that are given by name, as in `speed = 20 m/s`; each may be left out.
    pub named: &'static [NamedArgument],
}

/// An argument that is given by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NamedArgument {
    pub name: &'static str,
    pub expected: Expected,
}

/// The type of an argument of a function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Argument {
    /// A number of any dimension.
    Any,
    Number(Dimension),
    Frequency,
    Position,
    /// The size of an input.
    Amplitude,
    /// The integral of an input over time.
    Impulse,
    /// A time; `LaterTime` must come after the time before it.
    Time,
    LaterTime,
    /// The name of a file in quotes.
    File,
    /// A call of `table`.
    Table,
    /// An input with a signal.
    Input,
    /// The number of a mode, from 1.
    Mode,
    /// An output: its name, or a combination of motions.
    Output,
    /// `input -> output`
    Path,
    /// `1 Hz .. 50 Hz`
    Frequencies,
    /// `noise` or `time`
    Cause,
    /// The values that define a noise: densities and frequencies.
    Densities,
}

impl Function {
    /// Whether the function takes this number of arguments.
    pub fn takes(&self, count: usize) -> bool {
        count <= self.arguments.len() && count + self.optional >= self.arguments.len()
    }
}

/// The dimensions that the signal of an input may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SignalKind {
    pub amplitude: Expected,
    /// Its integral over time.
    pub impulse: Expected,
    /// Its power spectral density: its square per frequency.
    pub density: Expected,
}

impl SignalKind {
    /// Whether it is a force or a torque.
    pub fn is_load(&self) -> bool {
        [FORCE_SIGNAL, TORQUE_SIGNAL].contains(self)
    }

    /// Whether it is the motion of a base itself, not its rate or acceleration.
    pub fn is_motion(&self) -> bool {
        [DISPLACEMENT_SIGNAL, ANGLE_SIGNAL].contains(self)
    }
}

pub const FORCE_SIGNAL: SignalKind = SignalKind {
    amplitude: Expected::new("a force", Dimension::FORCE, "10 N"),
    impulse: Expected::new("an impulse", Dimension::IMPULSE, "3 N*s"),
    density: Expected::new("a power spectral density of a force", Dimension::of(2, 2, -3), "3 N^2/Hz"),
};
pub const TORQUE_SIGNAL: SignalKind = SignalKind {
    amplitude: Expected::new("a torque", Dimension::TORQUE, "2 N*m"),
    impulse: Expected::new("an angular impulse", Dimension::ANGULAR_IMPULSE, "2 N*m*s"),
    density: Expected::new("a power spectral density of a torque", Dimension::of(2, 4, -3), "2 N^2*m^2/Hz"),
};
pub const DISPLACEMENT_SIGNAL: SignalKind = SignalKind {
    amplitude: Expected::new("a displacement", Dimension::LENGTH, "1 mm"),
    impulse: Expected::new("a displacement times a time", Dimension::of(0, 1, 1), "1 mm*s"),
    density: Expected::new("a power spectral density of a displacement", Dimension::of(0, 2, 1), "1e-6 m^2/Hz"),
};
pub const ANGLE_SIGNAL: SignalKind = SignalKind {
    amplitude: Expected::new("an angle", Dimension::NONE, "2 deg"),
    impulse: Expected::new("an angle times a time", Dimension::TIME, "1 rad*s"),
    density: Expected::new("a power spectral density of an angle", Dimension::of(0, 0, 1), "1e-6 rad^2/Hz"),
};

/// The possible signals of a base: the motion itself, its rate or its acceleration, in this order.
pub const TRANSLATION_SIGNALS: [SignalKind; 3] = [
    DISPLACEMENT_SIGNAL,
    SignalKind {
        amplitude: Expected::new("a velocity", Dimension::VELOCITY, "0.1 m/s"),
        impulse: Expected::new("a displacement", Dimension::LENGTH, "1 mm"),
        density: Expected::new("a power spectral density of a velocity", Dimension::of(0, 2, -1), "1e-4 m^2/s^2/Hz"),
    },
    SignalKind {
        amplitude: Expected::new("an acceleration", Dimension::ACCELERATION, "2 m/s^2"),
        impulse: Expected::new("a change of velocity", Dimension::VELOCITY, "0.1 m/s"),
        density: Expected::new("a power spectral density of an acceleration", Dimension::of(0, 2, -3), "0.01 g0^2/Hz"),
    },
];
pub const ROTATION_SIGNALS: [SignalKind; 3] = [
    ANGLE_SIGNAL,
    SignalKind {
        amplitude: Expected::new("an angular velocity", Dimension::ANGULAR_VELOCITY, "1 rad/s"),
        impulse: Expected::new("an angle", Dimension::NONE, "2 deg"),
        density: Expected::new(
            "a power spectral density of an angular velocity",
            Dimension::of(0, 0, -1),
            "1e-4 rad^2/s^2/Hz",
        ),
    },
    SignalKind {
        amplitude: Expected::new("an angular acceleration", Dimension::ANGULAR_ACCELERATION, "1 rad/s^2"),
        impulse: Expected::new("a change of angular velocity", Dimension::ANGULAR_VELOCITY, "1 rad/s"),
        density: Expected::new(
            "a power spectral density of an angular acceleration",
            Dimension::of(0, 0, -3),
            "1e-4 rad^2/s^4/Hz",
        ),
    },
];

/// A function and its meaning for the stage that reads it.
#[derive(Clone, Copy, Debug)]
pub struct Named<K> {
    pub kind: K,
    pub function: Function,
}

/// The function of this name in a table.
pub fn by_name<K>(table: &'static [Named<K>], name: &str) -> Option<&'static Named<K>> {
    table.iter().find(|entry| entry.function.name == name)
}

const fn entry<K: Copy>(
    kind: K,
    words: [&'static str; 3],
    meaning: &'static str,
    arguments: &'static [Argument],
) -> Named<K> {
    let [name, form, example] = words;
    Named { kind, function: Function { name, form, example, meaning, arguments, optional: 0, named: &[] } }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    Rod,
    Disk,
    Ring,
    Box,
}

const LENGTH: Argument = Argument::Number(Dimension::LENGTH);

/// Every shape of a body.
pub const SHAPES: &[Named<Shape>] = &[
    entry(
        Shape::Rod,
        ["rod", "rod(A, B)", "rod(A, B)"],
        "A slender rod from A to B.",
        &[Argument::Position, Argument::Position],
    ),
    entry(Shape::Disk, ["disk", "disk(r)", "disk(0.3 m)"], "A disk of radius r.", &[LENGTH]),
    entry(Shape::Ring, ["ring", "ring(r)", "ring(0.3 m)"], "A thin ring of radius r.", &[LENGTH]),
    entry(
        Shape::Box,
        ["box", "box(w, h)", "box(0.3 m, 0.2 m)"],
        "A rectangle of width w and height h.",
        &[LENGTH, LENGTH],
    ),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Signal {
    Constant,
    Step,
    Impulse,
    Ramp,
    Pulse,
    Harmonic,
    Chirp,
    HalfSine,
    Haversine,
    Sawtooth,
    Trapezoid,
    Table,
    Periodic,
    Delayed,
    Noise,
    Spectrum,
}

/// Every signal of an input.
pub const SIGNALS: &[Named<Signal>] = &[
    entry(
        Signal::Constant,
        ["constant", "constant(a)", "constant(10 N)"],
        "A permanent load: it takes part in the rest.",
        &[Argument::Amplitude],
    ),
    entry(
        Signal::Step,
        ["step", "step(a, at)", "step(10 N, 0 s)"],
        "Zero before the time `at`, then a.",
        &[Argument::Amplitude, Argument::Time],
    ),
    entry(
        Signal::Impulse,
        ["impulse", "impulse(J, at)", "impulse(3 N*s, 0 s)"],
        "An impulse J at the time `at`.",
        &[Argument::Impulse, Argument::Time],
    ),
    entry(
        Signal::Ramp,
        ["ramp", "ramp(a, from, to)", "ramp(10 N, 0 s, 1 s)"],
        "From 0 to a between two times.",
        &[Argument::Amplitude, Argument::Time, Argument::LaterTime],
    ),
    entry(
        Signal::Pulse,
        ["pulse", "pulse(a, from, to)", "pulse(10 N, 0 s, 1 s)"],
        "a between two times.",
        &[Argument::Amplitude, Argument::Time, Argument::LaterTime],
    ),
    Named {
        kind: Signal::Harmonic,
        function: Function {
            name: "harmonic",
            form: "harmonic(a, f, phase)",
            example: "harmonic(10 N, 1.5 Hz, 90 deg)",
            meaning: "a sin(2 pi f t + phase); the phase may be left out.",
            arguments: &[Argument::Amplitude, Argument::Frequency, Argument::Number(Dimension::NONE)],
            optional: 1,
            named: &[],
        },
    },
    entry(
        Signal::Chirp,
        ["chirp", "chirp(a, f0, f1, duration)", "chirp(10 N, 1 Hz, 20 Hz, 60 s)"],
        "A sine whose frequency goes from f0 to f1.",
        &[Argument::Amplitude, Argument::Frequency, Argument::Frequency, Argument::Time],
    ),
    entry(
        Signal::HalfSine,
        ["half_sine", "half_sine(a, from, to)", "half_sine(50 N, 0 s, 11 ms)"],
        "Half a wave of a sine with the peak a, between two times.",
        &[Argument::Amplitude, Argument::Time, Argument::LaterTime],
    ),
    entry(
        Signal::Haversine,
        ["haversine", "haversine(a, from, to)", "haversine(50 N, 0 s, 11 ms)"],
        "A whole wave a (1 - cos) / 2 with the peak a, between two times.",
        &[Argument::Amplitude, Argument::Time, Argument::LaterTime],
    ),
    entry(
        Signal::Sawtooth,
        ["sawtooth", "sawtooth(a, from, to)", "sawtooth(50 N, 0 s, 11 ms)"],
        "From 0 to the terminal peak a, then 0 at once.",
        &[Argument::Amplitude, Argument::Time, Argument::LaterTime],
    ),
    entry(
        Signal::Trapezoid,
        ["trapezoid", "trapezoid(a, from, rise, fall, to)", "trapezoid(50 N, 0 s, 1 ms, 10 ms, 11 ms)"],
        "Rises from 0 at `from` to a at `rise`, falls from a at `fall` to 0 at `to`.",
        &[Argument::Amplitude, Argument::Time, Argument::LaterTime, Argument::LaterTime, Argument::LaterTime],
    ),
    Named {
        kind: Signal::Table,
        function: Function {
            name: "table",
            form: "table(\"file.csv\", unit)",
            example: "table(\"file.csv\", 1 kN)",
            meaning: "Two columns of a file: time, and value in multiples of the unit, which the heading may give instead. \
                      With `speed = 20 m/s` the first column is a distance.",
            arguments: &[Argument::File, Argument::Amplitude],
            optional: 1,
            named: &[NamedArgument {
                name: "speed",
                expected: Expected::new("a speed", Dimension::VELOCITY, "20 m/s"),
            }],
        },
    },
    entry(
        Signal::Periodic,
        ["periodic", "periodic(table(\"file.csv\", unit), T)", "periodic(table(\"file.csv\", 1 kN), 0.5 s)"],
        "A table that comes again after each period T, from t = 0 on.",
        &[Argument::Table, Argument::Time],
    ),
    entry(
        Signal::Delayed,
        ["delayed", "delayed(input, time)", "delayed(front, 0.1 s)"],
        "The signal of another input, later.",
        &[Argument::Input, Argument::Time],
    ),
    Named {
        kind: Signal::Noise,
        function: Function {
            name: "noise",
            form: "noise(density, from .. to)",
            example: "noise(3 N^2/Hz, 20 Hz .. 2 kHz)",
            meaning: "Stationary noise by its one-sided power spectral density: flat in a band, `white 3 N^2/Hz`, corner points \
                      `(20 Hz, 0.01 g0^2/Hz), (80 Hz, 0.04 g0^2/Hz)` (straight in log-log), or \
                      `road(16e-6 m^3, 20 m/s)` (ISO 8608).",
            arguments: &[Argument::Densities, Argument::Frequencies],
            optional: 1,
            named: &[],
        },
    },
    Named {
        kind: Signal::Spectrum,
        function: Function {
            name: "spectrum",
            form: "spectrum((f, a), (f, a), damping = ratio)",
            example: "spectrum((0.5 Hz, 0.3 g0), (33 Hz, 0.3 g0), damping = 5 %)",
            meaning: "A response spectrum in place of a history: the largest pseudo-accelerations (pseudo-velocities, relative \
                      displacements) of oscillators of one damping ratio, straight in log-log between its points, or by \
                      `table(\"spectrum.csv\", 1 g0)`.",
            arguments: &[Argument::Any, Argument::Any],
            optional: 1,
            named: &[NamedArgument {
                name: "damping",
                expected: Expected::new("a damping ratio", Dimension::NONE, "5 %"),
            }],
        },
    },
];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    Frequency,
    Damping,
    Gain,
    Phase,
    Amplitude,
    Static,
    Peak,
    Settling,
    Overshoot,
    Rms,
    Psd,
    Crossings,
    PeakGain,
    EffectiveMass,
    Rest,
    LoadFactor,
    Stable,
}

/// Every measure of `solve` and `require`.
pub const MEASURES: &[Named<Measure>] = &[
    entry(
        Measure::Frequency,
        ["frequency", "frequency(1)", "frequency(1)"],
        "The natural frequency of a mode, Hz.",
        &[Argument::Mode],
    ),
    entry(Measure::Damping, ["damping", "damping(1)", "damping(1)"], "The damping ratio of a mode.", &[Argument::Mode]),
    entry(
        Measure::Gain,
        ["gain", "gain(input -> output, f)", "gain(input -> output, 30 Hz)"],
        "The amplitude of the output over that of the input at a frequency.",
        &[Argument::Path, Argument::Frequency],
    ),
    entry(
        Measure::Phase,
        ["phase", "phase(input -> output, f)", "phase(input -> output, 30 Hz)"],
        "The phase of the output relative to the input at a frequency.",
        &[Argument::Path, Argument::Frequency],
    ),
    entry(
        Measure::Amplitude,
        ["amplitude", "amplitude(output)", "amplitude(output)"],
        "The amplitude in the steady state under the harmonic signals.",
        &[Argument::Output],
    ),
    entry(
        Measure::Static,
        ["static", "static(output)", "static(output)"],
        "The final value of the output.",
        &[Argument::Output],
    ),
    entry(
        Measure::Peak,
        ["peak", "peak(output)", "peak(output)"],
        "The largest absolute value over the simulated time.",
        &[Argument::Output],
    ),
    entry(
        Measure::Settling,
        ["settling", "settling(output, band)", "settling(output, 2 %)"],
        "The time after which the output stays within a band about its final value under the declared signals.",
        &[Argument::Output, Argument::Number(Dimension::NONE)],
    ),
    entry(
        Measure::Overshoot,
        ["overshoot", "overshoot(output)", "overshoot(output)"],
        "How far the output goes beyond its final value under the declared signals, as a part of that value.",
        &[Argument::Output],
    ),
    Named {
        kind: Measure::Rms,
        function: Function {
            name: "rms",
            form: "rms(output, noise)",
            example: "rms(output, noise)",
            meaning: "The root mean square: under noise, or over the simulated time where no noise acts. Where both act, \
                      `rms(output, noise)` or `rms(output, time)`; under noise, within a band: `rms(output, 20 Hz .. 2 kHz)`.",
            arguments: &[Argument::Output, Argument::Cause],
            optional: 1,
            named: &[],
        },
    },
    entry(
        Measure::Psd,
        ["psd", "psd(output, f)", "psd(output, 30 Hz)"],
        "The one-sided power spectral density of the output under noise, at a frequency.",
        &[Argument::Output, Argument::Frequency],
    ),
    entry(
        Measure::Crossings,
        ["crossings", "crossings(output)", "crossings(output)"],
        "The expected number of upward zero crossings under noise, Hz.",
        &[Argument::Output],
    ),
    Named {
        kind: Measure::PeakGain,
        function: Function {
            name: "peak_gain",
            form: "peak_gain(input -> output, from .. to)",
            example: "peak_gain(input -> output, 1 Hz .. 50 Hz)",
            meaning: "The largest amplitude of the output over that of the input, at all frequencies or between two.",
            arguments: &[Argument::Path, Argument::Frequencies],
            optional: 1,
            named: &[],
        },
    },
    entry(
        Measure::EffectiveMass,
        ["effective_mass", "effective_mass(base, i)", "effective_mass(base, 1)"],
        "The effective mass of a mode under the motion of a base, kg; kg*m^2 if the base turns.",
        &[Argument::Input, Argument::Mode],
    ),
    entry(
        Measure::Rest,
        ["rest", "rest(quantity)", "rest(spring.tension)"],
        "What a quantity is at rest: the tension of a spring, or how far a motion or a stretch has gone from the drawing.",
        &[Argument::Any],
    ),
    entry(
        Measure::LoadFactor,
        ["load_factor", "load_factor", "load_factor"],
        "The factor by which all loads at rest can grow before some motion loses its stiffness; below 1 the scene has buckled.",
        &[],
    ),
    entry(
        Measure::Stable,
        ["stable", "stable", "stable"],
        "Whether the rest is stable: no small motion grows, and stiffness restrains every motion.",
        &[],
    ),
];

/// The kinds of damping that take arguments.
pub const DAMPINGS: &[Named<()>] = &[entry(
    (),
    ["rayleigh", "rayleigh(a, b)", "rayleigh(0.1 /s, 1e-4 s)"],
    "Damping a M + b K: a rate and a time.",
    &[Argument::Frequency, Argument::Time],
)];

const ANGLE: Argument = Argument::Number(Dimension::NONE);

/// The functions of numbers; `model::value` has their values.
pub const NUMBERS: &[Named<()>] = &[
    entry((), ["sqrt", "sqrt(x)", "sqrt(x)"], "The square root.", &[Argument::Any]),
    entry((), ["abs", "abs(x)", "abs(x)"], "The absolute value.", &[Argument::Any]),
    entry((), ["min", "min(a, b)", "min(a, b)"], "The least of its arguments.", &[Argument::Any]),
    entry((), ["max", "max(a, b)", "max(a, b)"], "The greatest of its arguments.", &[Argument::Any]),
    entry((), ["sin", "sin(x)", "sin(x)"], "The sine of an angle.", &[ANGLE]),
    entry((), ["cos", "cos(x)", "cos(x)"], "The cosine of an angle.", &[ANGLE]),
    entry((), ["tan", "tan(x)", "tan(x)"], "The tangent of an angle.", &[ANGLE]),
    entry((), ["asin", "asin(x)", "asin(x)"], "The angle whose sine is x.", &[Argument::Any]),
    entry((), ["acos", "acos(x)", "acos(x)"], "The angle whose cosine is x.", &[Argument::Any]),
    entry((), ["atan", "atan(x)", "atan(x)"], "The angle whose tangent is x.", &[Argument::Any]),
    entry(
        (),
        ["atan2", "atan2(y, x)", "atan2(y, x)"],
        "The angle of the direction (x, y).",
        &[Argument::Any, Argument::Any],
    ),
    entry((), ["exp", "exp(x)", "exp(x)"], "e to the power of x.", &[Argument::Any]),
    entry((), ["ln", "ln(x)", "ln(x)"], "The natural logarithm.", &[Argument::Any]),
];

/// The kind of a function, which decides where it may be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FunctionKind {
    Shape,
    Signal,
    Measure,
    Damping,
    Number,
}

impl FunctionKind {
    /// Describes a function of this kind and where it may be used, for messages about one that is used elsewhere.
    pub fn describe(self, function: &Function) -> String {
        match self {
            FunctionKind::Shape => format!("a shape: write `shape = {}` in a body", function.example),
            FunctionKind::Signal => "a signal: it follows a force, a torque or a base".into(),
            FunctionKind::Measure => "a measure: use it in `solve` and `require`".into(),
            FunctionKind::Damping => format!("a kind of damping: write `damping {}`", function.example),
            FunctionKind::Number => "a function of numbers".into(),
        }
    }
}

fn of<K>(table: &'static [Named<K>], kind: FunctionKind) -> impl Iterator<Item = (FunctionKind, &'static Function)> {
    table.iter().map(move |entry| (kind, &entry.function))
}

/// Every function with its kind.
pub fn functions() -> impl Iterator<Item = (FunctionKind, &'static Function)> {
    let shapes = of(SHAPES, FunctionKind::Shape).chain(of(SIGNALS, FunctionKind::Signal));
    let asked = of(MEASURES, FunctionKind::Measure).chain(of(DAMPINGS, FunctionKind::Damping));
    shapes.chain(asked).chain(of(NUMBERS, FunctionKind::Number))
}

/// The function of this name.
pub fn function(name: &str) -> Option<(FunctionKind, &'static Function)> {
    functions().find(|(_, function)| function.name == name)
}
