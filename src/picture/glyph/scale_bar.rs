//! The scale: a bar of a round length, with its unit.

use super::{Sheet, Subject, arrow};
use crate::picture::figure::{Kind, Pen, Stroke};
use crate::picture::geometry::{Bounds, Point};
use crate::picture::occupied::Occupied;

/// Maximum length of the bar, px.
const LONGEST: f64 = 120.0;

pub fn draw(sheet: &mut Sheet, bounds: Bounds, room: &mut Occupied) {
    let Some(scale) = sheet.layout.scale else { return };
    let Some((length, text)) = round_length(LONGEST / scale) else { return };
    let (left, right) = (bounds.low.x, bounds.low.x + length * scale);
    // Below the scene, or further down if there is a name already.
    let tries = arrow::offsets(24.0).map(|off| {
        let y = bounds.high.y + off;
        let mark = |x: f64| Stroke::line([Point::new(x, y - 4.0), Point::new(x, y + 4.0)], Pen::Normal);
        vec![Stroke::line([Point::new(left, y), Point::new(right, y)], Pen::Normal), mark(left), mark(right)]
    });
    let of = Subject { title: format!("scale: {text}"), span: None };
    if let Some(bounds) = sheet.choose(Kind::ScaleBar, of, tries.collect(), room) {
        sheet.label_beside(text, None, bounds, &[Point::new(1.0, 0.0), Point::new(0.0, 1.0)]);
    }
}

/// The largest of 1, 2 and 5 times a power of ten that is not longer, m, with a unit that makes it read well.
fn round_length(most: f64) -> Option<(f64, String)> {
    const UNITS: [(i32, &str); 5] = [(3, "km"), (0, "m"), (-3, "mm"), (-6, "um"), (-9, "nm")];
    let (mantissa, exponent) = format!("{most:e}")
        .split_once('e')
        .and_then(|(digits, power)| Some((digits.parse::<f64>().ok()?, power.parse::<i32>().ok()?)))?;
    let digit = if mantissa >= 5.0 {
        5
    } else if mantissa >= 2.0 {
        2
    } else {
        1
    };
    let length: f64 = format!("{digit}e{exponent}").parse().ok()?;
    let text = match UNITS.iter().find(|(power, _)| exponent >= *power && exponent < power + 3) {
        Some((power, unit)) => format!("{digit}{} {unit}", "0".repeat((exponent - power) as usize)),
        None => format!("{digit}e{exponent} m"),
    };
    Some((length, text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_round() {
        let text = |most: f64| round_length(most).map(|(_, text)| text);
        assert_eq!(text(0.73).as_deref(), Some("500 mm"));
        assert_eq!(text(2.4).as_deref(), Some("2 m"));
        assert_eq!(text(1e12).as_deref(), Some("1e12 m"));
        assert_eq!(text(4.2e-5).as_deref(), Some("20 um"));
    }
}
