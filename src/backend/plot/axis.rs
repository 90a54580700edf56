//! Axes with scales in decades or linear: their range, the positions of values, and their ticks.

/// An axis with its title: `frequency [Hz]`.
#[derive(Clone, Debug)]
pub struct Axis {
    pub title: String,
    pub scale: Scale,
    /// Ends, in the units of [`Axis::place`]: powers of ten for decades.
    low: f64,
    high: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    Linear,
    Decades,
    /// Linear, with ticks at multiples of 45.
    Degrees,
}

/// A tick: its position on the axis and its label.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    pub at: f64,
    /// Empty for lines between decades.
    pub label: String,
}

/// Approximate number of ticks on a linear axis.
const TICKS: f64 = 6.0;
/// The most labels of decades.
const LABELS: i32 = 8;

impl Axis {
    /// An axis that covers some values; values that are not finite, and for decades not positive, are ignored.
    pub fn holding(title: impl Into<String>, scale: Scale, values: impl Iterator<Item = f64>) -> Axis {
        let mut axis = Axis { title: title.into(), scale, low: f64::INFINITY, high: f64::NEG_INFINITY };
        let places = values.filter_map(|value| axis.place(value));
        let (low, high) = places.fold((axis.low, axis.high), |(low, high), at| (low.min(at), high.max(at)));
        (axis.low, axis.high) = if low > high { (0.0, 1.0) } else { (low, high) };
        match scale {
            Scale::Linear => {
                let room = (axis.high - axis.low) * 0.05;
                // A constant has room around it; that is all zero, the unit.
                let around = if axis.high == 0.0 { 1.0 } else { (axis.high.abs() * 0.1).max(f64::MIN_POSITIVE) };
                let room = if room > 0.0 { room } else { around };
                (axis.low, axis.high) = (axis.low - room, axis.high + room);
            }
            Scale::Degrees => (axis.low, axis.high) = (-190.0, 190.0),
            Scale::Decades => {}
        }
        axis
    }

    /// An axis exactly from the lowest to the highest value, as for time.
    pub fn tight(title: impl Into<String>, scale: Scale, from: f64, to: f64) -> Axis {
        let mut axis = Axis::holding(title, scale, [from, to].into_iter());
        if let (Some(low), Some(high)) = (axis.place(from), axis.place(to))
            && low < high
        {
            (axis.low, axis.high) = (low, high);
        }
        axis
    }

    /// Extends the axis to whole decades, at most `most` of them below the highest value.
    pub fn in_whole_decades(mut self, most: f64) -> Axis {
        self.high = self.high.ceil();
        self.low = self.low.floor().max(self.high - most).min(self.high - 1.0);
        self
    }

    /// The position of a value in units of the axis; `None` if the axis cannot show it.
    pub fn place(&self, value: f64) -> Option<f64> {
        match self.scale {
            Scale::Linear | Scale::Degrees => value.is_finite().then_some(value),
            Scale::Decades => (value.is_finite() && value > 0.0).then(|| decades(value)),
        }
    }

    /// The position of a value as a share of the axis length; outside of 0 to 1 it is off the axis.
    pub fn share(&self, value: f64) -> Option<f64> {
        Some((self.place(value)? - self.low) / (self.high - self.low))
    }

    /// The ticks, with positions as shares of the length.
    pub fn ticks(&self) -> Vec<Tick> {
        let share = |at: f64| (at - self.low) / (self.high - self.low);
        let on_it = |tick: &Tick| (-1e-9..=1.0 + 1e-9).contains(&tick.at);
        match self.scale {
            Scale::Linear => self.linear(),
            Scale::Degrees => {
                (-4..=4).map(|k| Tick { at: share(f64::from(k) * 45.0), label: (k * 45).to_string() }).collect()
            }
            Scale::Decades => {
                let (first, last) = (self.low.floor() as i32, self.high.ceil() as i32);
                let every = (last - first) / LABELS + 1;
                let mut ticks = Vec::new();
                for decade in first..=last {
                    let labelled = decade.rem_euclid(every) == 0;
                    let label = if labelled { power_of_ten(decade) } else { String::new() };
                    ticks.push(Tick { at: share(f64::from(decade)), label });
                    if last - first <= 4 {
                        let between = (2..=9).map(|digit| Tick {
                            at: share(f64::from(decade) + decades(f64::from(digit))),
                            // A range within two decades has few other labels.
                            label: if self.high - self.low < 2.0 && [2, 5].contains(&digit) {
                                format_digit(digit, decade)
                            } else {
                                String::new()
                            },
                        });
                        ticks.extend(between);
                    }
                }
                ticks.retain(on_it);
                ticks
            }
        }
    }

    /// Ticks at whole multiples of a step of 1, 2 or 5 times a power of ten, so that no errors add up.
    fn linear(&self) -> Vec<Tick> {
        let rough = (self.high - self.low) / TICKS;
        let written = format!("{rough:e}");
        let (mantissa, exponent) = written.split_once('e').unwrap_or(("1", "0"));
        let (mantissa, exponent) = (mantissa.parse::<f64>().unwrap_or(1.0), exponent.parse::<i32>().unwrap_or(0));
        let (digit, exponent) = match mantissa {
            m if m > 5.0 => (1, exponent + 1),
            m if m > 2.0 => (5, exponent),
            m if m > 1.0 => (2, exponent),
            _ => (1, exponent),
        };
        let step: f64 = format!("{digit}e{exponent}").parse().unwrap_or(1.0);
        let (first, last) = ((self.low / step).ceil() as i64, (self.high / step).floor() as i64);
        let place = |k: i64| (k as f64 * step - self.low) / (self.high - self.low);
        (first..=last).map(|k| Tick { at: place(k), label: decimal(k * digit, exponent) }).collect()
    }
}

fn format_digit(digit: i32, decade: i32) -> String {
    decimal(i64::from(digit), decade)
}

/// `0.01`, `1`, `100`, `1e6`
fn power_of_ten(decade: i32) -> String {
    decimal(1, decade)
}

/// A whole number times a power of ten.
fn decimal(number: i64, exponent: i32) -> String {
    if number == 0 {
        return "0".into();
    }
    let (sign, digits) = (if number < 0 { "-" } else { "" }, number.unsigned_abs().to_string());
    match exponent {
        0..=4 => format!("{sign}{digits}{}", "0".repeat(exponent as usize)),
        -4..=-1 => {
            let places = -exponent as usize;
            let padded = format!("{digits:0>width$}", width = places + 1);
            let (whole, fraction) = padded.split_at(padded.len() - places);
            let fraction = fraction.trim_end_matches('0');
            format!("{sign}{whole}{}{fraction}", if fraction.is_empty() { "" } else { "." })
        }
        _ => {
            let trimmed = digits.trim_end_matches('0');
            let exponent = exponent + (digits.len() - trimmed.len()) as i32;
            format!("{sign}{trimmed}e{exponent}")
        }
    }
}

/// log10, accurate enough for a picture: from the decimal exponent and the digits before it.
pub fn decades(x: f64) -> f64 {
    let written = format!("{x:e}");
    let (digits, exponent) = written.split_once('e').unwrap_or(("1", "0"));
    let (digits, exponent) = (digits.parse().unwrap_or(1.0), exponent.parse().unwrap_or(0.0));
    exponent + fraction_of_decade(digits)
}

/// log10 of 1..10 bit by bit, by squaring: the same on every machine.
fn fraction_of_decade(mut x: f64) -> f64 {
    let (mut sum, mut part) = (0.0, 0.5);
    for _ in 0..24 {
        x *= x;
        if x >= 10.0 {
            x /= 10.0;
            sum += part;
        }
        part *= 0.5;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_are_logarithms() {
        for x in [1e-17, 3.7e-5, 1.0, 2.5, 9.9e3] {
            assert!((decades(x) - x.log10()).abs() < 1e-6, "{x}");
        }
    }

    #[test]
    fn ticks_are_round() {
        let labels = |axis: &Axis| axis.ticks().into_iter().map(|tick| tick.label).collect::<Vec<_>>();
        let time = Axis::tight("t", Scale::Linear, 0.0, 10.0);
        assert_eq!(labels(&time), ["0", "2", "4", "6", "8", "10"]);
        assert!((time.ticks()[5].at - 1.0).abs() < 1e-12);
        let small = Axis::tight("x", Scale::Linear, -0.003, 0.001);
        assert_eq!(labels(&small), ["-0.003", "-0.002", "-0.001", "0", "0.001"]);
        let gain = Axis::holding("g", Scale::Decades, [2e-7, 30.0].into_iter()).in_whole_decades(20.0);
        assert_eq!(labels(&gain).into_iter().filter(|label| !label.is_empty()).count(), 5);
        assert_eq!(decimal(25, -3), "0.025");
        assert_eq!(decimal(-5, 6), "-5e6");
    }
}
