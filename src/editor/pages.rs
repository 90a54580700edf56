//! What an editor tells of the words of the language: keywords, fields, functions, motions, units.

use super::shown;
use crate::base::unit::{self, Scale};
use crate::base::{Number, Quantity};
use crate::syntax::manual;

/// A keyword's page.
pub fn keyword(word: &str) -> Option<String> {
    manual::entry(word).map(manual::Entry::markdown)
}

/// The fields of a declaration, each with a form to type and what it says.
pub fn fields(keyword: &str) -> &'static [(&'static str, &'static str, &'static str)] {
    match keyword {
        "body" => &[
            ("mass", "mass = 1 kg", "The body's mass, kg."),
            ("moves", "moves x", "The body stands on the ground and moves so: `x`, `y`, `x y`, or `along (1, 1)`."),
            ("turns", "turns", "The body turns about its place on the ground."),
            ("free", "free", "The body moves along x and y and turns."),
            ("at", "at = (0, 0)", "The centre of mass in the drawing."),
            (
                "shape",
                "shape = rod((0, 0), (0, 1 m))",
                "`rod(A, B)`, `disk(r)`, `ring(r)` or `box(w, h)`: centre and inertia follow.",
            ),
            (
                "inertia",
                "inertia = 0.8 kg*m^2",
                "The moment of inertia about the centre, kg*m^2; `about A` about a point.",
            ),
        ],
        "base" => &[
            ("moves", "moves y", "The motion that is prescribed: `x`, `y`, `x y`, or `along (1, 1)`."),
            ("turns", "turns", "The base turns as prescribed."),
            ("at", "at = (0, 0)", "The place of the base in the drawing; it turns about it."),
        ],
        "spring" => &[
            ("k", "k = 10 N/m", "The stiffness, N/m; in N*m/rad the spring is torsional."),
            ("along", "along = x", "The fixed direction in which it acts."),
            ("free_length", "free_length = 0.5 m", "Its length without tension."),
            ("preload", "preload = 2 N", "Its tension as drawn; pull is positive."),
        ],
        "damper" => &[
            ("c", "c = 5 N*s/m", "The damping coefficient, N*s/m; in N*m*s/rad the damper is torsional."),
            ("along", "along = x", "The fixed direction in which it acts."),
        ],
        "initial" => &[
            ("x", "x = 1 mm", "Displacement along x at t = 0, from rest."),
            ("y", "y = 1 mm", "Displacement along y at t = 0, from rest."),
            ("angle", "angle = 1 deg", "Rotation at t = 0, from rest; counter-clockwise."),
            ("vx", "vx = 0.1 m/s", "Velocity along x at t = 0."),
            ("vy", "vy = 0.1 m/s", "Velocity along y at t = 0."),
            ("omega", "omega = 1 rad/s", "Angular velocity at t = 0."),
        ],
        _ => &[],
    }
}

pub fn field(keyword: &str, word: &str) -> Option<String> {
    let (_, form, meaning) = fields(keyword).iter().find(|(name, ..)| *name == word)?;
    Some(format!("`{form}`\n\n{meaning}"))
}

/// Functions with their forms and meanings: shapes, signals, measures, and those of numbers.
pub const FUNCTIONS: [(&str, &str, &str, Kind); 35] = [
    ("rod", "rod(A, B)", "A slender rod from A to B.", Kind::Shape),
    ("disk", "disk(r)", "A disk of radius r.", Kind::Shape),
    ("ring", "ring(r)", "A thin ring of radius r.", Kind::Shape),
    ("box", "box(w, h)", "A rectangle of width w and height h.", Kind::Shape),
    ("constant", "constant(a)", "A load that is there always: part of rest.", Kind::Signal),
    ("step", "step(a, at)", "Nothing before the time `at`, then a.", Kind::Signal),
    ("impulse", "impulse(J, at)", "A blow of J at the time `at`.", Kind::Signal),
    ("ramp", "ramp(a, from, to)", "From 0 to a between two times.", Kind::Signal),
    ("pulse", "pulse(a, from, to)", "a between two times.", Kind::Signal),
    ("harmonic", "harmonic(a, f, phase)", "a sin(2 pi f t + phase); the phase may be left out.", Kind::Signal),
    ("chirp", "chirp(a, f0, f1, duration)", "A sine whose frequency goes from f0 to f1.", Kind::Signal),
    ("table", "table(\"file.csv\")", "Two columns of a file: time in s, value in SI units.", Kind::Signal),
    ("frequency", "frequency(1)", "The natural frequency of a mode, Hz.", Kind::Measure),
    ("damping", "damping(1)", "The damping ratio of a mode.", Kind::Measure),
    (
        "gain",
        "gain(input -> output, f)",
        "The amplitude of the output over that of the input at a frequency.",
        Kind::Measure,
    ),
    ("phase", "phase(input -> output, f)", "The phase of the output against the input at a frequency.", Kind::Measure),
    ("amplitude", "amplitude(output)", "The amplitude in the steady state under the harmonic signals.", Kind::Measure),
    ("static", "static(output)", "The value that the output settles at.", Kind::Measure),
    ("peak", "peak(output)", "The largest size over the simulated time.", Kind::Measure),
    ("rms", "rms(output)", "The root mean square over the simulated time.", Kind::Measure),
    ("rayleigh", "rayleigh(a, b)", "Damping a M + b K: a rate and a time.", Kind::Damping),
    ("sqrt", "sqrt(x)", "The square root.", Kind::Number),
    ("abs", "abs(x)", "The size without the sign.", Kind::Number),
    ("min", "min(a, b)", "The least of its arguments.", Kind::Number),
    ("max", "max(a, b)", "The greatest of its arguments.", Kind::Number),
    ("sin", "sin(x)", "The sine of an angle.", Kind::Number),
    ("cos", "cos(x)", "The cosine of an angle.", Kind::Number),
    ("tan", "tan(x)", "The tangent of an angle.", Kind::Number),
    ("asin", "asin(x)", "The angle whose sine is x.", Kind::Number),
    ("acos", "acos(x)", "The angle whose cosine is x.", Kind::Number),
    ("atan", "atan(x)", "The angle whose tangent is x.", Kind::Number),
    ("atan2", "atan2(y, x)", "The angle of the direction (x, y).", Kind::Number),
    ("exp", "exp(x)", "e to the power of x.", Kind::Number),
    ("ln", "ln(x)", "The natural logarithm.", Kind::Number),
    ("stable", "stable", "Whether every motion stays small.", Kind::Measure),
];

/// Where a function stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Shape,
    Signal,
    Measure,
    Damping,
    Number,
}

pub fn function(word: &str) -> Option<String> {
    let (_, form, meaning, _) = FUNCTIONS.iter().find(|(name, ..)| *name == word)?;
    Some(format!("`{form}`\n\n{meaning}"))
}

/// What may be asked of a part, after a dot.
pub const BODY_MOTIONS: [(&str, &str); 9] = [
    ("x", "Displacement along x from rest, m."),
    ("y", "Displacement along y from rest, m."),
    ("angle", "Rotation from rest, rad, counter-clockwise."),
    ("vx", "Velocity along x, m/s."),
    ("vy", "Velocity along y, m/s."),
    ("omega", "Angular velocity, rad/s."),
    ("ax", "Acceleration along x, m/s^2."),
    ("ay", "Acceleration along y, m/s^2."),
    ("alpha", "Angular acceleration, rad/s^2."),
];

pub const ELEMENT_MOTIONS: [(&str, &str); 2] = [
    ("force", "The change of a spring's tension from rest (pull positive); a damper's force. N or N*m."),
    ("stretch", "The change of its stretch from rest, m or rad."),
];

pub fn motion(word: &str) -> Option<&'static str> {
    BODY_MOTIONS.iter().chain(&ELEMENT_MOTIONS).find(|(name, _)| *name == word).map(|(_, meaning)| *meaning)
}

/// Words between: what they say where they stand.
pub fn word(word: &str) -> Option<&'static str> {
    Some(match word {
        "ground" => "What never moves.",
        "pi" => "The circle constant.",
        "stable" => "A measure: whether every motion stays small.",
        "moves" => "The body stands on the ground and moves so: `x`, `y`, `x y`, or `along (1, 1)`.",
        "turns" => "The body turns about its place.",
        "free" => "The body moves along x and y and turns.",
        "along" => "A fixed direction: `x`, `y` or a vector, whose length does not matter.",
        "about" => "The point that an inertia is given about.",
        "in" => "The range, bounds included.",
        "modal" => "The same damping ratio for every oscillation.",
        "as" | "drawn" => "The drawing is the rest: the tensions that make it so are found.",
        _ => return None,
    })
}

/// What a unit measures, and how large it is.
pub fn unit(text: &str) -> Option<String> {
    let unit = unit::parse(text).ok()?;
    let what = unit.dimension.noun().map_or_else(|| unit.dimension.to_string(), str::to_string);
    Some(match unit.scale {
        Scale::Decibel => "a level: the ratio 10^(x/20)".into(),
        Scale::Linear(factor) => {
            let one = Quantity { si: factor, dimension: unit.dimension, angle: unit.angle };
            let base = shown::in_base_units(&one);
            match one.si == Number::ONE && base == format!("1 {text}") {
                true => what,
                false => format!("{what}: 1 {text} = {base}"),
            }
        }
    })
}

/// Units that are offered.
const UNITS: [&str; 72] = [
    "kg",
    "g",
    "t",
    "lb",
    "slug",
    "m",
    "mm",
    "cm",
    "um",
    "km",
    "inch",
    "ft",
    "s",
    "ms",
    "us",
    "min",
    "h",
    "N",
    "kN",
    "MN",
    "lbf",
    "kip",
    "N/m",
    "kN/m",
    "N/mm",
    "kN/mm",
    "MN/m",
    "lbf/inch",
    "lbf/ft",
    "N*s/m",
    "kN*s/m",
    "N*s/mm",
    "N*m/rad",
    "kN*m/rad",
    "N*m/deg",
    "N*m*s/rad",
    "kN*m*s/rad",
    "N*m",
    "kN*m",
    "N*mm",
    "kg*m^2",
    "g*cm^2",
    "kg*mm^2",
    "m/s",
    "mm/s",
    "km/h",
    "m/s^2",
    "mm/s^2",
    "g0",
    "Hz",
    "kHz",
    "rad/s",
    "rpm",
    "deg/s",
    "/s",
    "rad/s^2",
    "deg/s^2",
    "rad",
    "deg",
    "rev",
    "%",
    "dB",
    "N*s",
    "N*m*s",
    "J",
    "W",
    "kW",
    "Pa",
    "kPa",
    "MPa",
    "GPa",
    "K",
];

/// The units of a dimension, the usual one first; all of them where none is wanted.
pub fn units(wanted: Option<crate::base::Dimension>) -> Vec<&'static str> {
    let fits = |text: &&str| match (wanted, unit::parse(text)) {
        (None, _) => true,
        (Some(wanted), Ok(unit)) => unit.dimension == wanted,
        (Some(_), Err(_)) => false,
    };
    UNITS.iter().copied().filter(fits).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::Dimension;

    /// Words of the models that spec.md shows.
    fn shown() -> Vec<&'static str> {
        let blocks = include_str!("../../spec.md").split("```vib\n").skip(1);
        let models = blocks.filter_map(|rest| rest.split("```").next());
        models.flat_map(|model| model.split(|c: char| !c.is_alphanumeric() && c != '_')).collect()
    }

    #[test]
    fn the_language_page_shows_every_word() {
        let shown = shown();
        let keywords = manual::ENTRIES.iter().map(|entry| entry.keyword);
        let fields = manual::ENTRIES.iter().flat_map(|entry| fields(entry.keyword)).map(|(name, ..)| *name);
        let functions = FUNCTIONS.iter().map(|(name, ..)| *name);
        let motions = BODY_MOTIONS.iter().chain(&ELEMENT_MOTIONS).map(|(name, _)| *name);
        let words = keywords.chain(fields).chain(functions).chain(motions);
        let missing: Vec<&str> = words.filter(|word| !shown.contains(word)).collect();
        assert!(missing.is_empty(), "no model of spec.md shows {missing:?}");
    }

    #[test]
    fn every_unit_that_is_offered_is_one() {
        for text in UNITS {
            assert!(unit::parse(text).is_ok(), "{text}");
        }
        assert_eq!(units(Some(Dimension::STIFFNESS)).first(), Some(&"N/m"));
        assert_eq!(unit("kN/m").as_deref(), Some("a stiffness: 1 kN/m = 1000 kg/s^2"));
    }

    #[test]
    fn every_function_of_the_model_is_told() {
        for name in crate::model::functions() {
            assert!(function(name).is_some(), "{name}");
        }
    }
}
