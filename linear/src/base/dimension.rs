//! Dimensions and quantities: a number in SI with the exponents of kilogram, metre, second and kelvin.
//!
//! Angles have no dimension (spec.md#units: `rad` is 1 in arithmetic), but their unit is kept where it matters:
//! a frequency may have been written in cycles (`Hz`) or in radians (`rad/s`), and where a frequency is expected a value
//! that is neither (such as `sqrt(k/m)`) is refused.

use super::number::Number;
use std::fmt;

/// A rational exponent in lowest terms with a positive denominator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Exponent {
    numerator: i16,
    denominator: i16,
}

impl Exponent {
    pub const ZERO: Exponent = Exponent { numerator: 0, denominator: 1 };

    /// `None` if it does not fit: exponents beyond a few thousand are mistakes.
    fn new(numerator: i64, denominator: i64) -> Option<Exponent> {
        let divisor = num_integer::gcd(numerator, denominator).max(1) * denominator.signum();
        Some(Exponent {
            numerator: i16::try_from(numerator / divisor).ok()?,
            denominator: i16::try_from(denominator / divisor).ok()?,
        })
    }

    fn add(self, other: Exponent) -> Option<Exponent> {
        let (a, b) = (i64::from(self.numerator), i64::from(self.denominator));
        let (c, d) = (i64::from(other.numerator), i64::from(other.denominator));
        Exponent::new(a * d + c * b, b * d)
    }

    fn mul(self, numerator: i64, denominator: i64) -> Option<Exponent> {
        let a = i64::from(self.numerator).checked_mul(numerator)?;
        let b = i64::from(self.denominator).checked_mul(denominator)?;
        Exponent::new(a, b)
    }
}

/// Exponents of kg, m, s, K.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Dimension {
    exponents: [Exponent; 4],
}

const SYMBOLS: [&str; 4] = ["kg", "m", "s", "K"];

impl Dimension {
    pub const NONE: Dimension = Dimension::of(0, 0, 0);
    pub const MASS: Dimension = Dimension::of(1, 0, 0);
    pub const LENGTH: Dimension = Dimension::of(0, 1, 0);
    pub const TIME: Dimension = Dimension::of(0, 0, 1);
    pub const FREQUENCY: Dimension = Dimension::of(0, 0, -1);
    pub const VELOCITY: Dimension = Dimension::of(0, 1, -1);
    pub const ACCELERATION: Dimension = Dimension::of(0, 1, -2);
    pub const ANGULAR_VELOCITY: Dimension = Dimension::of(0, 0, -1);
    pub const ANGULAR_ACCELERATION: Dimension = Dimension::of(0, 0, -2);
    pub const FORCE: Dimension = Dimension::of(1, 1, -2);
    /// The dimension of a torque, which is also that of an energy.
    pub const TORQUE: Dimension = Dimension::of(1, 2, -2);
    pub const IMPULSE: Dimension = Dimension::of(1, 1, -1);
    pub const ANGULAR_IMPULSE: Dimension = Dimension::of(1, 2, -1);
    pub const STIFFNESS: Dimension = Dimension::of(1, 0, -2);
    pub const TORSIONAL_STIFFNESS: Dimension = Dimension::TORQUE;
    pub const DAMPING: Dimension = Dimension::of(1, 0, -1);
    pub const TORSIONAL_DAMPING: Dimension = Dimension::of(1, 2, -1);
    pub const INERTIA: Dimension = Dimension::of(1, 2, 0);
    /// A mass times its distance from an axis.
    pub const UNBALANCE: Dimension = Dimension::of(1, 1, 0);
    pub const TEMPERATURE: Dimension = Dimension {
        exponents: [Exponent::ZERO, Exponent::ZERO, Exponent::ZERO, Exponent { numerator: 1, denominator: 1 }],
    };

    /// kg^mass m^length s^time.
    pub const fn of(mass: i16, length: i16, time: i16) -> Dimension {
        Dimension {
            exponents: [
                Exponent { numerator: mass, denominator: 1 },
                Exponent { numerator: length, denominator: 1 },
                Exponent { numerator: time, denominator: 1 },
                Exponent::ZERO,
            ],
        }
    }

    pub fn is_none(self) -> bool {
        self == Dimension::NONE
    }

    /// The dimension of a product; `None` if an exponent leaves its range.
    pub fn times(self, other: Dimension) -> Option<Dimension> {
        let mut exponents = self.exponents;
        for (mine, theirs) in exponents.iter_mut().zip(other.exponents) {
            *mine = mine.add(theirs)?;
        }
        Some(Dimension { exponents })
    }

    pub fn per(self, other: Dimension) -> Option<Dimension> {
        self.times(other.pow(-1, 1)?)
    }

    /// self^(numerator/denominator); `None` if an exponent leaves its range. The denominator must not be zero.
    pub fn pow(self, numerator: i64, denominator: i64) -> Option<Dimension> {
        let mut exponents = self.exponents;
        for exponent in &mut exponents {
            *exponent = exponent.mul(numerator, denominator)?;
        }
        Some(Dimension { exponents })
    }

    /// Its engineering name with an article: "a stiffness"; `None` for a dimension without a name.
    pub fn noun(self) -> Option<&'static str> {
        NOUNS.iter().find(|(dimension, ..)| *dimension == self).map(|(_, noun, _)| *noun)
    }

    /// The usual unit, such as `N/m` for a stiffness; the base units otherwise.
    pub fn usual_unit(self) -> String {
        NOUNS
            .iter()
            .find(|(dimension, ..)| *dimension == self)
            .map_or_else(|| self.to_string(), |(_, _, unit)| (*unit).to_string())
    }
}

/// Dimension, noun with article, usual unit. The first match is used.
const NOUNS: [(Dimension, &str, &str); 20] = [
    (Dimension::NONE, "a plain number", ""),
    (Dimension::MASS, "a mass", "kg"),
    (Dimension::LENGTH, "a length", "m"),
    (Dimension::TIME, "a time", "s"),
    (Dimension::FREQUENCY, "a frequency", "Hz"),
    (Dimension::VELOCITY, "a velocity", "m/s"),
    (Dimension::ACCELERATION, "an acceleration", "m/s^2"),
    (Dimension::ANGULAR_ACCELERATION, "an angular acceleration", "rad/s^2"),
    (Dimension::FORCE, "a force", "N"),
    (Dimension::TORQUE, "a torque", "N*m"),
    (Dimension::STIFFNESS, "a stiffness", "N/m"),
    (Dimension::DAMPING, "a damping coefficient", "N*s/m"),
    (Dimension::TORSIONAL_DAMPING, "a torsional damping coefficient", "N*m*s/rad"),
    (Dimension::IMPULSE, "an impulse", "N*s"),
    (Dimension::INERTIA, "a moment of inertia", "kg*m^2"),
    (Dimension::of(0, 2, 0), "an area", "m^2"),
    (Dimension::of(1, -1, -2), "a pressure", "Pa"),
    (Dimension::of(1, 2, -3), "a power", "W"),
    (Dimension::TEMPERATURE, "a temperature", "K"),
    (Dimension::of(-1, 0, 2), "a compliance", "m/N"),
];

impl fmt::Display for Dimension {
    /// Writes the dimension in base units, such as `kg*m/s^2`, and nothing for a plain number.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let write = |f: &mut fmt::Formatter<'_>, negative: bool, mut first: bool| -> Result<bool, fmt::Error> {
            for (symbol, exponent) in SYMBOLS.iter().zip(self.exponents) {
                if exponent.numerator == 0 || (exponent.numerator < 0) != negative {
                    continue;
                }
                match (negative, first) {
                    (true, _) => f.write_str("/")?,
                    (false, false) => f.write_str("*")?,
                    (false, true) => {}
                }
                first = false;
                f.write_str(symbol)?;
                match (exponent.numerator.abs(), exponent.denominator) {
                    (1, 1) => {}
                    (n, 1) => write!(f, "^{n}")?,
                    (n, d) => write!(f, "^({n}/{d})")?,
                }
            }
            Ok(first)
        };
        let first = write(f, false, true)?;
        write(f, true, first)?;
        Ok(())
    }
}

/// The unit in which the angle in a value was written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Angle {
    /// No angle: `10 N/m`, `sqrt(k/m)`.
    Plain,
    /// Radians (or degrees, revolutions): `2 rad/s`, `30 deg`, `60 rpm`.
    Radians,
    /// Cycles: `30 Hz`.
    Cycles,
    /// A density over a frequency in cycles: `3 N^2/Hz`.
    PerCycle,
    /// A density over a frequency in radians: `3 N^2/(rad/s)`.
    PerRadian,
}

/// A checked value: SI number, dimension, and how its angle was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    pub si: Number,
    pub dimension: Dimension,
    pub angle: Angle,
}

impl Quantity {
    pub fn new(si: Number, dimension: Dimension) -> Quantity {
        Quantity { si, dimension, angle: Angle::Plain }
    }

    pub fn plain(si: Number) -> Quantity {
        Quantity::new(si, Dimension::NONE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dimensions_are_exact_and_read_like_units() {
        let stiffness_per_mass = Dimension::STIFFNESS.per(Dimension::MASS).and_then(|d| d.pow(1, 2));
        assert_eq!(stiffness_per_mass, Some(Dimension::FREQUENCY));
        assert_eq!(Dimension::FORCE.to_string(), "kg*m/s^2");
        assert_eq!(Dimension::FORCE.pow(1, 2).map(|d| d.to_string()).as_deref(), Some("kg^(1/2)*m^(1/2)/s"));
        assert_eq!(Dimension::STIFFNESS.noun(), Some("a stiffness"));
    }

    #[test]
    fn an_absurd_power_is_refused() {
        assert_eq!(Dimension::MASS.pow(40_000, 1), None);
    }
}
