//! Lines and numbers of a report as plain text. The space between a number and its unit must not break: it is
//! [`NO_BREAK`], which the layout replaces at the end.

use super::decimal::{Decimal, certain_number, round_unproven, upper};
use crate::answers::report::{Figure, Line, Part, Value};
use crate::base::readable::readable;
use crate::base::{Ball, Dd, Unproven};

/// A space at which lines are not broken.
pub const NO_BREAK: char = '\u{a0}';

/// The words, names and numbers of a line; in names, characters that control a terminal are made visible.
pub fn line(line: &Line) -> String {
    line.parts.iter().map(part).collect()
}

fn part(part: &Part) -> String {
    match part {
        Part::Words(words) => (*words).to_string(),
        Part::Named(named) => readable(&named.text).into_owned(),
        Part::Figure(number) => figure(number),
    }
}

/// A number for reading: its certain digits and its unit.
pub fn figure(figure: &Figure) -> String {
    let number = match &figure.value {
        Value::Enclosed { number, digits } => certain_number(number, *digits),
        Value::Hundredths(ball) => hundredths(ball),
        Value::Unproven { number, digits } => round_unproven(*number, *digits),
        Value::Share(part) => percent(*part),
        Value::Bound(bound) => upper(*bound),
        Value::Exact => "exact".into(),
        Value::Count(count) => count.to_string(),
    };
    match &figure.unit[..] {
        "" => number,
        unit => format!("{number}{NO_BREAK}{}", readable(unit)),
    }
}

/// A share in whole per cent; a smaller one with its first digit.
fn percent(Unproven(part): Unproven) -> String {
    let percent = 100.0 * part;
    let number = match percent.abs() {
        0.0 => "0".into(),
        size if !size.is_finite() => "?".into(),
        size if size < 0.95 => Decimal::round(Dd::from(percent), 1).text(),
        _ => format!("{percent:.0}"),
    };
    format!("{number}{NO_BREAK}%")
}

/// Two digits after the point, as is usual for levels and angles.
fn hundredths(value: &Ball) -> String {
    if !value.is_finite() || value.rad > 0.005 {
        return "?".into();
    }
    let steps = (value.mid * 100.0).to_f64().round();
    let (sign, size) = (if steps < 0.0 { "-" } else { "" }, steps.abs() as u64);
    format!("{sign}{}.{:02}", size / 100, size % 100)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_shares_keep_a_digit() {
        let shown = |part| percent(Unproven(part)).replace(NO_BREAK, " ");
        assert_eq!(shown(0.333), "33 %");
        assert_eq!(shown(0.0008), "0.08 %");
        assert_eq!(shown(0.0094), "0.9 %");
        assert_eq!(shown(0.0096), "1 %");
        assert_eq!(shown(-0.25), "-25 %");
        assert_eq!(shown(1.0), "100 %");
        assert_eq!(shown(f64::NAN), "?\u{20}%");
    }
}
