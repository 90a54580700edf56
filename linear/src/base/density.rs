//! Power spectral densities of stationary noise as plain data, as a model states them and analyses integrate them. They
//! are one-sided: the mean square is the integral over frequencies from 0 up. See docs/method/random.md.

use super::number::Number;

/// A one-sided power spectral density, SI^2/Hz.
#[derive(Clone, Debug, PartialEq)]
pub enum Density {
    /// A constant density, the same at every frequency.
    White(Number),
    /// Bands in ascending order. The density is zero between bands and outside them.
    Bands(Vec<Band>),
}

/// A density between two frequencies, Hz.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    pub from: Number,
    pub to: Number,
    pub course: Course,
}

/// The course of a density from the lower to the upper end of a band.
#[derive(Clone, Debug, PartialEq)]
pub enum Course {
    Flat(Number),
    /// A straight line in logarithmic axes: the values at both ends, and the slope if it is known to be an integer.
    Power {
        low: Number,
        high: Number,
        slope: Option<i32>,
    },
    /// A line.
    Line {
        low: Number,
        high: Number,
    },
}

impl Density {
    /// The number of bands; white noise has none.
    pub fn bands(&self) -> usize {
        if let Density::Bands(bands) = self { bands.len() } else { 0 }
    }

    /// The density at a frequency in Hz. At a jump it is the larger of the two one-sided values.
    ///
    /// `None` if the number leaves its range.
    pub fn at(&self, frequency: &Number) -> Option<Number> {
        match self {
            Density::White(value) => Some(value.clone()),
            Density::Bands(bands) => {
                let holds =
                    |band: &&Band| !(frequency - &band.from).is_negative() && !(&band.to - frequency).is_negative();
                let mut largest = Number::ZERO;
                for band in bands.iter().filter(holds) {
                    let value = band.at(frequency)?;
                    if (&value - &largest).is_positive() {
                        largest = value;
                    }
                }
                Some(largest)
            }
        }
    }
}

impl Band {
    /// The density at a frequency of the band.
    pub fn at(&self, frequency: &Number) -> Option<Number> {
        match &self.course {
            Course::Flat(value) => Some(value.clone()),
            Course::Power { low, slope: Some(slope), .. } => {
                Some(low * &frequency.checked_div(&self.from)?.powi(*slope)?)
            }
            Course::Power { low, high, slope: None } => {
                if (frequency - &self.from).is_zero() {
                    return Some(low.clone());
                }
                if (frequency - &self.to).is_zero() {
                    return Some(high.clone());
                }
                let part = frequency.checked_div(&self.from)?.ln()?.checked_div(&self.octaves()?)?;
                let rise = high.checked_div(low)?.ln()?;
                Some(low * &(&rise * &part).exp()?)
            }
            Course::Line { low, high } => {
                let part = (frequency - &self.from).checked_div(&(&self.to - &self.from))?;
                Some(low + &(&(high - low) * &part))
            }
        }
    }

    /// ln(to / from)
    fn octaves(&self) -> Option<Number> {
        self.to.checked_div(&self.from)?.ln()
    }

    /// The slope in the logarithms of frequency and density.
    pub fn slope(&self) -> Option<Number> {
        match &self.course {
            Course::Flat(_) => Some(Number::ZERO),
            Course::Power { slope: Some(slope), .. } => Some(Number::from(i64::from(*slope))),
            Course::Power { low, high, slope: None } => high.checked_div(low)?.ln()?.checked_div(&self.octaves()?),
            Course::Line { .. } => None,
        }
    }
}

impl Course {
    /// The straight line in logarithmic axes between two points. Finds integer slopes that the numbers satisfy exactly.
    pub fn between([from, to]: [&Number; 2], [low, high]: [&Number; 2]) -> Course {
        const STEEPEST: i32 = 12;
        if (high - low).is_zero() {
            return Course::Flat(low.clone());
        }
        let ratio = to.checked_div(from);
        let rise = high.checked_div(low);
        let is_slope = |slope: &i32| match (&ratio, &rise) {
            (Some(ratio), Some(rise)) => ratio.powi(*slope).is_some_and(|power| (&power - rise).is_zero()),
            _ => false,
        };
        let slope = (-STEEPEST..=STEEPEST).find(is_slope);
        Course::Power { low: low.clone(), high: high.clone(), slope }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_whole_slope_is_found() {
        let n = Number::from;
        let course = Course::between([&n("20"), &n("80")], [&n("0.01"), &n("0.04")]);
        assert_eq!(course, Course::Power { low: n("0.01"), high: n("0.04"), slope: Some(1) });
        let course = Course::between([&n("20"), &n("80")], [&n("0.01"), &n("0.05")]);
        assert!(matches!(course, Course::Power { slope: None, .. }));
        assert_eq!(Course::between([&n("1"), &n("2")], [&n("3"), &n("3")]), Course::Flat(n("3")));
    }

    #[test]
    fn between_corners_it_is_straight_in_logarithms() {
        let n = Number::from;
        let course = Course::between([&n("1"), &n("100")], [&n("2"), &n("7")]);
        let band = Band { from: n("1"), to: n("100"), course };
        let middle = band.at(&n("10")).expect("a number").to_f64();
        assert!((middle - 14f64.sqrt()).abs() < 1e-14, "{middle}");
        let density = Density::Bands(vec![band]);
        assert_eq!(density.at(&n("0.5")), Some(Number::ZERO));
        assert_eq!(density.at(&n("100")), Some(n("7")));
    }
}
