//! Response spectra as plain data: the largest motion of single oscillators over their natural frequencies, as a model states
//! it in place of a history. See docs/method/response_spectra.md.

use super::density::{Band, Course};
use super::number::{Ball, Number};

/// The largest motion of oscillators with one damping ratio, straight in the logarithms between its points.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponseSpectrum {
    /// The bands, ascending and without gaps.
    pub bands: Vec<Band>,
    /// 0: displacements relative to the base, 1: pseudo-velocities, 2: pseudo-accelerations; each is omega times the
    /// one before.
    pub derivative: u8,
    pub damping: Number,
}

impl ResponseSpectrum {
    /// The spectrum through points, at least two of them, with ascending frequencies and positive values.
    pub fn of(points: &[(Number, Number)], derivative: u8, damping: Number) -> ResponseSpectrum {
        let bands = points.windows(2).map(|pair| {
            let [(from, low), (to, high)] = [&pair[0], &pair[1]];
            Band { from: from.clone(), to: to.clone(), course: Course::between([from, to], [low, high]) }
        });
        ResponseSpectrum { bands: bands.collect(), derivative, damping }
    }

    /// The lowest and the highest frequency, Hz.
    pub fn ends(&self) -> Option<(&Number, &Number)> {
        Some((&self.bands.first()?.from, &self.bands.last()?.to))
    }

    /// The pseudo-acceleration of the highest point, with which all stiffer oscillators follow the base.
    pub fn rigid(&self) -> Option<Ball> {
        let last = self.bands.last()?;
        Some(self.acceleration(last.at(&last.to)?.to_ball(), last.to.to_ball()))
    }

    /// The pseudo-acceleration at a frequency in Hz; `None` if it is certainly below the lowest point, or if the value
    /// leaves its range.
    pub fn at(&self, hertz: Ball) -> Option<Ball> {
        let (low, high) = self.ends()?;
        if (hertz - high.to_ball()).is_positive() {
            return self.rigid();
        }
        if !low.is_zero() && (hertz - low.to_ball()).is_negative() {
            return None;
        }
        let frequency = Number::Ball(hertz);
        let mut found: Option<Ball> = None;
        for band in &self.bands {
            let (from, to) = (hertz - band.from.to_ball(), hertz - band.to.to_ball());
            if from.is_negative() || to.is_positive() {
                continue;
            }
            let value = self.acceleration(band.at(&frequency)?.to_ball(), hertz);
            // At a corner, the frequency may be on either side.
            found = Some(found.map_or(value, |other| hull(other, value)));
        }
        found
    }

    fn acceleration(&self, value: Ball, hertz: Ball) -> Ball {
        let omega = hertz * Ball::PI * Ball::from(2.0);
        (self.derivative..2).fold(value, |value, _| value * omega)
    }
}

/// A ball that holds two others.
fn hull(a: Ball, b: Ball) -> Ball {
    a.widen((a - b).magnitude() + b.rad)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_straight_in_logarithms_and_rigid_above() {
        let n = Number::from;
        let points = [(n("0.5"), n("3")), (n("2"), n("12")), (n("8"), n("12")), (n("32"), n("3"))];
        let spectrum = ResponseSpectrum::of(&points, 2, n("0.05"));
        let at = |hertz: f64| spectrum.at(Ball::from(hertz)).map(|value| value.to_f64());
        for (hertz, value) in [(0.5, 3.0), (1.0, 6.0), (2.0, 12.0), (5.0, 12.0), (16.0, 6.0), (32.0, 3.0), (90.0, 3.0)]
        {
            assert!((at(hertz).expect("a value") - value).abs() < 1e-14, "{hertz}");
        }
        assert_eq!(at(0.49), None);
        // A displacement of 1 m at 1 Hz to 2 m at 2 Hz.
        let spectrum = ResponseSpectrum::of(&[(n("1"), n("1")), (n("2"), n("2"))], 0, n("0.05"));
        let square = (2.0 * std::f64::consts::PI * 1.5f64).powi(2);
        let value = spectrum.at(Ball::from(1.5)).expect("a value");
        assert!((value.to_f64() - 1.5 * square).abs() < 1e-12 && value.rad < 1e-24);
    }
}
