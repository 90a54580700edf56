//! Quantities as shown in an editor: few digits, the usual unit. The back end does the rounding.

use crate::analysis::derived;
use crate::backend::decimal::{certain, certain_number};
use crate::base::unit::{self, Scale};
use crate::base::{Angle, Ball, Dimension, Number, Quantity};
use crate::model::{Scalar, Value};

/// Number of digits that are shown.
const DIGITS: usize = 6;
/// Number of digits in a line of several numbers.
const FEW: usize = 4;

/// The unit in which a value of a dimension is shown; the unit in which it was written decides between cycles and
/// radians.
pub fn usual_unit(dimension: Dimension, angle: Angle) -> String {
    match (dimension, angle) {
        (Dimension::FREQUENCY, Angle::Plain) => "1/s".into(),
        (Dimension::FREQUENCY, Angle::Radians) => "rad/s".into(),
        (Dimension::NONE, Angle::Radians) => "rad".into(),
        _ => dimension.usual_unit(),
    }
}

/// A number with its usual unit, such as `10 N/m`.
pub fn quantity(quantity: &Quantity) -> String {
    // Every usual unit is the SI unit.
    with_unit(&quantity.si, &usual_unit(quantity.dimension, quantity.angle))
}

pub fn with_unit(number: &Number, unit: &str) -> String {
    let digits = certain_number(number, DIGITS);
    if unit.is_empty() { digits } else { format!("{digits} {unit}") }
}

/// A number in SI base units, such as `10 kg/s^2`.
pub fn in_base_units(quantity: &Quantity) -> String {
    with_unit(&quantity.si, &quantity.dimension.to_string())
}

/// A quantity in the unit of its source text; `None` if that has another dimension.
pub fn in_unit(quantity: &Quantity, written: &str) -> Option<String> {
    let unit = unit::parse(written).ok().filter(|unit| unit.dimension == quantity.dimension)?;
    match unit.scale {
        Scale::Linear(factor) => Some(with_unit(&(&quantity.si / &factor), written)),
        Scale::Decibel => None,
    }
}

/// Any value of the language.
pub fn value(value: &Value) -> String {
    match value {
        Value::Scalar(Scalar { quantity: scalar, .. }) => quantity(scalar),
        Value::Vector(vector) => {
            let unit = vector.dimension.map_or(String::new(), Dimension::usual_unit);
            format!("({}, {})", with_unit(&vector.si.x, &unit), with_unit(&vector.si.y, &unit))
        }
    }
}

/// A frequency in Hz, with few digits, from an angular one.
pub fn hertz(omega: &Ball) -> String {
    format!("{} Hz", certain(&derived::hertz(*omega), FEW))
}

/// A ratio in per cent, with few digits.
pub fn per_cent(ratio: &Ball) -> String {
    format!("{} %", certain(&(*ratio * Ball::from(100.0)), FEW))
}
