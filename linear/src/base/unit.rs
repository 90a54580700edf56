//! The unit table and the reading of unit expressions such as `N*s/m`: text in; exact factor to SI, dimension and kind
//! of angle out. See spec.md#units.
//!
//! Factors are exact fractions, also those of the inch-pound units (NIST SP 811, appendix B.8: the inch, the pound and
//! the standard acceleration are defined, the others follow), or such a fraction of pi.

use super::dimension::{Angle, Dimension};
use super::number::{Number, Rational};
use std::ops::Range;

/// The meaning of a number followed by a unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    pub scale: Scale,
    pub dimension: Dimension,
    pub angle: Angle,
}

/// The relation between the number and the SI value.
#[derive(Clone, Debug, PartialEq)]
pub enum Scale {
    /// value = number times factor.
    Linear(Number),
    /// value = 10^(number / 20).
    Decibel,
}

/// Why a unit expression cannot be read. Ranges are bytes of its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum UnitError {
    /// A word that is not a unit.
    Unknown { word: Range<usize> },
    /// `N/m*s`: is only the metre in the denominator, or the second too?
    Ambiguous { tail: Range<usize> },
    /// Not of the form `N*s/m^2`.
    Malformed { at: Range<usize> },
    /// `dB` with other units.
    DecibelInProduct { word: Range<usize> },
    /// A power out of range.
    Power { at: Range<usize> },
}

/// A line of the table.
struct Entry {
    symbol: &'static str,
    factor: Factor,
    dimension: Dimension,
    angle: Angle,
    /// Whether it takes SI prefixes.
    prefixed: bool,
}

enum Factor {
    /// numerator / denominator
    Exact(i64, i64),
    /// numerator / denominator times pi
    Pi(i64, i64),
}

const fn si(symbol: &'static str, dimension: Dimension) -> Entry {
    Entry { symbol, factor: Factor::Exact(1, 1), dimension, angle: Angle::Plain, prefixed: true }
}

const fn unit(symbol: &'static str, numerator: i64, denominator: i64, dimension: Dimension) -> Entry {
    let factor = Factor::Exact(numerator, denominator);
    Entry { symbol, factor, dimension, angle: Angle::Plain, prefixed: false }
}

const fn turn(symbol: &'static str, numerator: i64, denominator: i64, dimension: Dimension) -> Entry {
    let factor = Factor::Pi(numerator, denominator);
    Entry { symbol, factor, dimension, angle: Angle::Radians, prefixed: false }
}

/// 1 lbf = 0.45359237 kg x 9.80665 m/s^2 = 4.4482216152605 N, in units of 1e-13 N.
const LBF: i64 = 44_482_216_152_605;
const TEN_13: i64 = 10_000_000_000_000;

const TABLE: [Entry; 26] = [
    Entry { factor: Factor::Exact(1, 1000), ..si("g", Dimension::MASS) },
    si("m", Dimension::LENGTH),
    si("s", Dimension::TIME),
    si("K", Dimension::TEMPERATURE),
    si("N", Dimension::FORCE),
    si("J", Dimension::TORQUE),
    si("W", Dimension::of(1, 2, -3)),
    si("Pa", Dimension::of(1, -1, -2)),
    Entry { angle: Angle::Cycles, ..si("Hz", Dimension::FREQUENCY) },
    Entry { angle: Angle::Radians, ..si("rad", Dimension::NONE) },
    turn("deg", 1, 180, Dimension::NONE),
    turn("\u{b0}", 1, 180, Dimension::NONE),
    turn("rev", 2, 1, Dimension::NONE),
    turn("rpm", 1, 30, Dimension::FREQUENCY),
    unit("t", 1000, 1, Dimension::MASS),
    unit("min", 60, 1, Dimension::TIME),
    unit("h", 3600, 1, Dimension::TIME),
    unit("%", 1, 100, Dimension::NONE),
    unit("g0", 980_665, 100_000, Dimension::ACCELERATION),
    unit("inch", 254, 10_000, Dimension::LENGTH),
    unit("ft", 3048, 10_000, Dimension::LENGTH),
    unit("lb", 45_359_237, 100_000_000, Dimension::MASS),
    unit("lbf", LBF, TEN_13, Dimension::FORCE),
    // lbf s^2/ft
    unit("slug", LBF, TEN_13 / 10_000 * 3048, Dimension::MASS),
    // lbf/inch^2
    unit("psi", LBF, TEN_13 / 100_000_000 * 64_516, Dimension::of(1, -1, -2)),
    unit("kip", LBF, TEN_13 / 1000, Dimension::FORCE),
];

/// SI prefixes and their powers of ten; `µ` is both U+00B5 and U+03BC.
const PREFIXES: [(&str, i32); 15] = [
    ("da", 1),
    ("h", 2),
    ("k", 3),
    ("M", 6),
    ("G", 9),
    ("T", 12),
    ("d", -1),
    ("c", -2),
    ("m", -3),
    ("u", -6),
    ("\u{b5}", -6),
    ("\u{3bc}", -6),
    ("n", -9),
    ("p", -12),
    ("f", -15),
];

/// The largest power of a single unit.
const MAX_POWER: i64 = 24;

/// Reads `N/m`, `kg*m^2`, `/s`, `1/s`, `%`, `dB`, `N^2/(rad/s)`.
pub fn parse(text: &str) -> Result<Unit, UnitError> {
    if text == "dB" {
        return Ok(Unit { scale: Scale::Decibel, dimension: Dimension::NONE, angle: Angle::Plain });
    }
    if let Some(above) = text.strip_suffix(PER_RADIAN) {
        let unit = parse(above)?;
        let dimension = unit.dimension.times(Dimension::TIME).ok_or(UnitError::Power { at: 0..text.len() })?;
        return match unit.scale {
            Scale::Linear(_) => Ok(Unit { dimension, angle: Angle::PerRadian, ..unit }),
            Scale::Decibel => Err(UnitError::DecibelInProduct { word: 0..above.len() }),
        };
    }
    let mut product = Product { factor: Number::ONE, dimension: Dimension::NONE, cycles: 0, radians: 0 };
    let mut divided = false;
    let mut ambiguous = None;
    let mut at = 0;
    let mut divide = leading_slash(text, &mut at);
    loop {
        divided |= divide;
        let end = text[at..].find(OPERATORS).map_or(text.len(), |offset| at + offset);
        product.times(text, at..end, divide)?;
        if end == text.len() {
            // Reported last: in `2 N/m*L`, the mistake is the `L`.
            return ambiguous.map_or_else(|| Ok(product.unit()), Err);
        }
        divide = text[end..].starts_with('/');
        if divided && !divide {
            ambiguous.get_or_insert(UnitError::Ambiguous { tail: end..text.len() });
        }
        at = end + text[end..].chars().next().map_or(1, char::len_utf8);
    }
}

/// The end of the unit of a density over a frequency in radians.
const PER_RADIAN: &str = "/(rad/s)";

/// The operators between the factors of a unit; the two dots are those of typeset text, U+00B7 and U+22C5.
const OPERATORS: [char; 4] = ['*', '/', '\u{b7}', '\u{22c5}'];

/// Steps over the `/` or `1/` of `0.1 /s`.
fn leading_slash(text: &str, at: &mut usize) -> bool {
    let len = ["/", "1/"].into_iter().find(|slash| text.starts_with(slash)).map_or(0, str::len);
    *at = len;
    len > 0
}

/// The product so far, with the powers of its cycles and of its angles.
struct Product {
    factor: Number,
    dimension: Dimension,
    cycles: i64,
    radians: i64,
}

impl Product {
    /// Multiplies by the factor at `range`, such as `m^2`.
    fn times(&mut self, text: &str, range: Range<usize>, divide: bool) -> Result<(), UnitError> {
        let part = &text[range.clone()];
        let (symbol, power) = symbol_and_power(part).ok_or(UnitError::Malformed { at: range.clone() })?;
        let word = range.start..range.start + symbol.len();
        if symbol.is_empty() {
            return Err(UnitError::Malformed { at: range });
        }
        if symbol == "dB" {
            return Err(UnitError::DecibelInProduct { word });
        }
        let (entry, prefix) = find(symbol).ok_or(UnitError::Unknown { word })?;
        let power = if divide { -power } else { power };
        self.multiply(entry, prefix, power).ok_or(UnitError::Power { at: range })
    }

    /// `None` if a power leaves its range.
    fn multiply(&mut self, entry: &Entry, prefix: i32, power: i64) -> Option<()> {
        let exponent = i32::try_from(power).ok().filter(|_| power.abs() <= MAX_POWER)?;
        let one = &entry.factor.number() * &Number::from(10).powi(prefix)?;
        self.factor = &self.factor * &one.powi(exponent)?;
        self.dimension = self.dimension.times(entry.dimension.pow(power, 1)?)?;
        match entry.angle {
            Angle::Cycles => self.cycles += power,
            Angle::Radians => self.radians += power,
            Angle::Plain | Angle::PerCycle | Angle::PerRadian => {}
        }
        Some(())
    }

    fn unit(self) -> Unit {
        let angle = match (self.radians, self.cycles) {
            (0, 0) => Angle::Plain,
            (0, 1) => Angle::Cycles,
            (_, -1) => Angle::PerCycle,
            (0, _) => Angle::Plain,
            _ => Angle::Radians,
        };
        Unit { scale: Scale::Linear(self.factor), dimension: self.dimension, angle }
    }
}

impl Factor {
    fn number(&self) -> Number {
        match *self {
            Factor::Exact(numerator, denominator) => Rational::new(numerator, denominator).into(),
            Factor::Pi(numerator, denominator) => Number::of_pi(Rational::new(numerator, denominator)),
        }
    }
}

/// `m^2` or `m\u{b2}` as m and 2.
fn symbol_and_power(part: &str) -> Option<(&str, i64)> {
    if let Some((symbol, power)) = part.split_once('^') {
        return Some((symbol, read_power(power)?));
    }
    let raised = [('\u{b2}', 2), ('\u{b3}', 3)].into_iter().find_map(|(sign, n)| Some((part.strip_suffix(sign)?, n)));
    Some(raised.unwrap_or((part, 1)))
}

/// A whole number, signed or not, of few digits.
fn read_power(text: &str) -> Option<i64> {
    let digits = text.strip_prefix('-').unwrap_or(text);
    let plain = !digits.is_empty() && digits.len() < 10 && digits.bytes().all(|byte| byte.is_ascii_digit());
    plain.then(|| text.parse().ok())?
}

/// The entry and the prefix's power of ten.
fn find(symbol: &str) -> Option<(&'static Entry, i32)> {
    if let Some(entry) = TABLE.iter().find(|entry| entry.symbol == symbol) {
        return Some((entry, 0));
    }
    PREFIXES.iter().find_map(|(prefix, power)| {
        let rest = symbol.strip_prefix(prefix)?;
        TABLE.iter().find(|entry| entry.prefixed && entry.symbol == rest).map(|entry| (entry, *power))
    })
}

/// Whether a single word is a unit.
pub fn is_known(symbol: &str) -> bool {
    symbol == "dB" || find(symbol).is_some()
}

/// Words that people write for units of the table.
const OTHER_WORDS: [(&str, &str); 34] = [
    ("sec", "s"),
    ("secs", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("minute", "min"),
    ("minutes", "min"),
    ("hour", "h"),
    ("hours", "h"),
    ("hr", "h"),
    ("metre", "m"),
    ("metres", "m"),
    ("meter", "m"),
    ("meters", "m"),
    ("micron", "um"),
    ("in", "inch"),
    ("inches", "inch"),
    ("foot", "ft"),
    ("feet", "ft"),
    ("gram", "g"),
    ("grams", "g"),
    ("kilo", "kg"),
    ("kgs", "kg"),
    ("ton", "t"),
    ("tonne", "t"),
    ("lbs", "lb"),
    ("lbm", "lb"),
    ("pound", "lb"),
    ("newton", "N"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("cps", "Hz"),
    ("percent", "%"),
];

/// Prefixed units that a suggestion may name, in addition to those of the table.
const COMMON: [&str; 14] = ["kg", "mg", "mm", "cm", "km", "um", "ms", "kN", "MN", "kPa", "MPa", "GPa", "kHz", "mrad"];

/// The unit that was probably meant by an unknown word: `Hz` for `hz`, `N*m` for `Nm`.
pub fn suggestion(word: &str) -> Option<String> {
    if let Some((_, meant)) = OTHER_WORDS.iter().find(|(other, _)| other.eq_ignore_ascii_case(word)) {
        return Some((*meant).to_string());
    }
    let candidates = || TABLE.iter().map(|entry| entry.symbol).chain(COMMON).chain(["dB"]);
    if let Some(same) = candidates().find(|candidate| candidate.eq_ignore_ascii_case(word)) {
        return Some(same.to_string());
    }
    if let Some(product) = as_product(word) {
        return Some(product);
    }
    // One wrong letter, in words that are long enough for that to be likely.
    (word.chars().count() >= 3)
        .then(|| candidates().find(|candidate| strsim::damerau_levenshtein(candidate, word) == 1))?
        .map(str::to_string)
}

/// `Nm` as `N*m`, `kgm` as `kg*m`: only forces and masses are written like this.
fn as_product(word: &str) -> Option<String> {
    let dimension = |symbol: &str| find(symbol).map(|(entry, _)| entry.dimension);
    let are_a_product = |first: &str, second: &str| {
        let (first, second) = (dimension(first), dimension(second));
        // A mass times a mass is a typing error: `kgg`.
        [Some(Dimension::FORCE), Some(Dimension::MASS)].contains(&first) && second.is_some() && first != second
    };
    let mut splits = word.char_indices().skip(1).map(|(at, _)| word.split_at(at));
    let (first, second) = splits.find(|(first, second)| are_a_product(first, second))?;
    Some(format!("{first}*{second}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn factor(text: &str) -> Number {
        match parse(text).expect("a unit").scale {
            Scale::Linear(factor) => factor,
            Scale::Decibel => panic!("a level"),
        }
    }

    fn dimension(text: &str) -> Dimension {
        parse(text).expect("a unit").dimension
    }

    #[test]
    fn si_units_and_prefixes_are_exact() {
        assert_eq!(factor("kg"), Number::ONE);
        assert_eq!(factor("g"), Number::from("0.001"));
        assert_eq!(factor("mm"), Number::from("0.001"));
        assert_eq!(factor("kN/mm"), Number::from(1_000_000));
        assert_eq!(factor("um"), factor("µm"));
        assert_eq!(factor("m/s^2"), Number::ONE);
        assert_eq!(factor("mm^2"), Number::from("1e-6"));
        assert_eq!(factor("min"), Number::from(60));
        assert_eq!(factor("kg·m²"), Number::ONE);
        assert_eq!(factor("°"), factor("deg"));
        assert_eq!(dimension("N*s/m"), Dimension::DAMPING);
        assert_eq!(dimension("kg*m^2"), Dimension::INERTIA);
        assert_eq!(dimension("N*m/rad"), Dimension::TORSIONAL_STIFFNESS);
        assert_eq!(dimension("/s"), Dimension::FREQUENCY);
        assert_eq!(dimension("1/s"), Dimension::FREQUENCY);
        assert_eq!(dimension("s^-2"), Dimension::ANGULAR_ACCELERATION);
        assert_eq!(dimension("J/kg/K").to_string(), "m^2/s^2/K");
    }

    /// NIST SP 811 (2008), appendix B.8.
    #[test]
    fn inch_pound_units_have_their_defined_values() {
        assert_eq!(factor("inch"), Number::from("0.0254"));
        assert_eq!(factor("ft"), Number::from("0.3048"));
        assert_eq!(factor("lb"), Number::from("0.45359237"));
        assert_eq!(factor("lbf"), &factor("lb") * &factor("g0"));
        assert_eq!(factor("slug"), factor("lbf*s^2/ft"));
        assert_eq!(factor("psi"), factor("lbf/inch^2"));
        assert_eq!(factor("kip"), &Number::from(1000) * &factor("lbf"));
        assert!((factor("slug").to_f64() - 14.593_903).abs() < 1e-6);
        assert!((factor("psi").to_f64() - 6_894.757).abs() < 1e-3);
    }

    #[test]
    fn angles_are_remembered() {
        let angle = |text| parse(text).expect("a unit").angle;
        assert_eq!(angle("Hz"), Angle::Cycles);
        assert_eq!(angle("kHz"), Angle::Cycles);
        assert_eq!(angle("rad/s"), Angle::Radians);
        assert_eq!(angle("rpm"), Angle::Radians);
        assert_eq!(angle("/s"), Angle::Plain);
        assert_eq!(angle("N/m"), Angle::Plain);
        assert!((factor("rpm").to_f64() - std::f64::consts::TAU / 60.0).abs() < 1e-16);
        assert!((factor("deg").to_f64() - std::f64::consts::PI / 180.0).abs() < 1e-17);
    }

    #[test]
    fn unknown_units_are_refused_at_their_place() {
        assert_eq!(parse("N*L/m"), Err(UnitError::Unknown { word: 2..3 }));
        assert_eq!(parse("N/m*s"), Err(UnitError::Ambiguous { tail: 3..5 }));
        assert_eq!(parse("dB/s"), Err(UnitError::DecibelInProduct { word: 0..2 }));
        assert_eq!(parse("m^x"), Err(UnitError::Malformed { at: 0..3 }));
        assert_eq!(parse("m^99"), Err(UnitError::Power { at: 0..4 }));
        assert_eq!(parse("kkg"), Err(UnitError::Unknown { word: 0..3 }));
        assert_eq!(parse("klb"), Err(UnitError::Unknown { word: 0..3 }));
        for text in ["", "/", "*", "N*", "N//m", "^2", "m^", "m^-", "m^--1"] {
            assert!(parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn suggestions_name_the_nearest_unit() {
        for (word, meant) in [
            ("hz", "Hz"),
            ("KN", "kN"),
            ("Nm", "N*m"),
            ("kNm", "kN*m"),
            ("sec", "s"),
            ("lbs", "lb"),
            ("Kg", "kg"),
            ("degs", "deg"),
            ("kgg", "kg"),
            ("kgm", "kg*m"),
            ("Mpa", "MPa"),
        ] {
            assert_eq!(suggestion(word).as_deref(), Some(meant), "{word}");
        }
        assert_eq!(suggestion("L"), None);
    }
}
