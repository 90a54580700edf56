//! A question over a whole range of a parameter: whether the measure can reach the target anywhere in it, and whether
//! it is monotone. In: the model with a parameter that is a range. Out: enclosures, if any were found. See
//! docs/method/measures.md.

use super::probe::Probe;
use crate::analysis::range::{Course, Family, Phasor};
use crate::base::number::jet;
use crate::base::{Ball, Jet, Number, up};
use crate::kernel::complex::Complex;
use crate::model::scene::Question;
use crate::system::{Noise, Signal};

/// An enclosure of a measure over a range of a parameter.
#[derive(Clone, Debug)]
pub struct RangeEnclosure {
    /// A number that is zero wherever the measure is at its target, and its derivative.
    test: Option<Jet>,
    /// Set if all eigenvalues move in one direction, or at least not in the other.
    course: Option<Course>,
    /// The measure cannot reach the target, whatever the test says.
    apart: bool,
    /// Smaller ranges will not give any information either.
    hopeless: bool,
}

impl RangeEnclosure {
    /// Whether the measure reaches the target nowhere in the range.
    pub fn excludes(&self) -> bool {
        self.apart || self.test.as_ref().is_some_and(|test| test.value.is_finite() && !test.value.contains_zero())
    }

    /// Whether the measure minus its target changes sign at most once in the range. Where all eigenvalues rise or stay it may be zero
    /// in a whole part of it.
    pub fn is_monotone(&self) -> bool {
        self.course.is_some() || self.is_strict()
    }

    /// Whether the measure is at its target at one number of the range at most.
    pub fn is_strict(&self) -> bool {
        self.test.as_ref().is_some_and(|test| test.slope.is_finite() && !test.slope.contains_zero())
    }

    /// Whether the measure cannot be enclosed over any range.
    pub fn is_hopeless(&self) -> bool {
        self.hopeless
    }

    /// The enclosure of a measure that is known as a function.
    #[cfg(test)]
    pub fn sample(value: Ball, slope: Ball) -> RangeEnclosure {
        RangeEnclosure { test: Some(Jet { value, slope }), ..RangeEnclosure::silent() }
    }

    pub fn silent() -> RangeEnclosure {
        RangeEnclosure { test: None, course: None, apart: false, hopeless: false }
    }

    /// Whether there is no information about the measure.
    pub fn is_silent(&self) -> bool {
        self.test.is_none() && self.course.is_none() && !self.apart
    }
}

/// The excitation of the family: for each input its signals, and their lasting part.
pub struct Drive<'a> {
    pub signals: &'a [Vec<Signal>],
    pub loads: &'a [(usize, Number)],
}

/// A question asked of a family of systems.
pub struct QuestionOverRange<'a> {
    /// `None` if the system has too many coordinates for dense equations.
    pub family: Option<&'a Family<'a>>,
    pub course: Option<Course>,
    pub drive: &'a Drive<'a>,
    pub probe: &'a Probe,
    pub question: &'a Question,
}

/// How often the enclosure over a box is widened until it holds, and narrowed after that.
const WIDENED: usize = 6;
const NARROWED: usize = 2;

/// An eigenvalue or a pole that a measure depends on, enclosed over the family.
#[derive(Clone, Copy, Debug)]
pub enum Centre {
    /// omega^2
    Eigenvalue(Ball),
    /// Real and imaginary part.
    Pole(Ball, Ball),
    /// The measure depends on no eigenvalue and no pole.
    None,
}

/// The derivative of the eigenvalue or pole in a centre, over the family.
#[derive(Clone, Copy, Debug)]
pub enum Moved {
    Eigenvalue(Ball),
    Pole(Ball, Ball),
    None,
}

impl Centre {
    /// An enclosure of the eigenvalue or pole over a whole box about the values for which this one holds; `moved` are
    /// its derivatives over the box, valid wherever it lies in an enclosure and is simple. `None` if it may leave the
    /// enclosures tried.
    pub fn over_box(&self, radius: &[f64], moved: impl Fn(&Centre) -> Option<Vec<Moved>>) -> Option<Centre> {
        let wide = self.widen(&moved(self)?, radius, 4.0);
        wide.holds(self, &moved(&wide)?, radius).then_some(wide)
    }

    /// Like [`Self::over_box`], with wider and wider enclosures, and in the end one as narrow as the derivatives allow.
    pub fn over_box_narrow(
        &self,
        radius: &[f64],
        moved: impl Fn(&Centre) -> Option<Vec<Moved>>,
    ) -> Option<(Centre, Vec<Moved>)> {
        let mut slopes = moved(self)?;
        let mut found = None;
        for _ in 0..WIDENED {
            let wide = self.widen(&slopes, radius, 2.0);
            slopes = moved(&wide)?;
            if wide.holds(self, &slopes, radius) {
                found = Some((wide, slopes));
                break;
            }
        }
        let mut known = found?;
        for _ in 0..NARROWED {
            // From the middle it moves by no more than the derivatives in the enclosure allow.
            let narrow = self.widen(&known.1, radius, up::THOUSANDS);
            let Some(slopes) = moved(&narrow) else { break };
            known = (narrow, slopes);
        }
        Some(known)
    }

    /// The enclosure widened by `times` the change that these derivatives allow over a box of these radii.
    fn widen(&self, moved: &[Moved], radius: &[f64], times: f64) -> Centre {
        let by = reach(moved, radius);
        match *self {
            Centre::Eigenvalue(square) => Centre::Eigenvalue(square.widen(times * by.0)),
            Centre::Pole(re, im) => Centre::Pole(re.widen(times * by.0), im.widen(times * by.1)),
            Centre::None => Centre::None,
        }
    }

    /// Whether an eigenvalue or pole that lies in `start` at the middle of the box stays in this enclosure, given these
    /// derivatives over it.
    fn holds(&self, start: &Centre, moved: &[Moved], radius: &[f64]) -> bool {
        let by = reach(moved, radius);
        let inside = |wide: Ball, start: Ball, by: f64| start.rad + by * up::THOUSANDS < wide.rad || by == 0.0;
        match (*self, *start) {
            (Centre::Eigenvalue(wide), Centre::Eigenvalue(start)) => inside(wide, start, by.0),
            (Centre::Pole(re, im), Centre::Pole(re_start, im_start)) => {
                inside(re, re_start, by.0) && inside(im, im_start, by.1)
            }
            (Centre::None, Centre::None) => true,
            _ => false,
        }
    }
}

/// Bounds of the changes of the real and the imaginary part over a box.
fn reach(moved: &[Moved], radius: &[f64]) -> (f64, f64) {
    moved.iter().zip(radius).fold((0.0, 0.0), |(re, im), (moved, radius)| match moved {
        Moved::Eigenvalue(slope) => (re + slope.magnitude() * radius, im),
        Moved::Pole(a, b) => (re + a.magnitude() * radius, im + b.magnitude() * radius),
        Moved::None => (re, im),
    })
}

impl QuestionOverRange<'_> {
    /// Encloses the measure over the range of the family.
    pub fn enclose_measure(&self) -> RangeEnclosure {
        let test =
            |test: Option<Jet>| RangeEnclosure { test, course: None, apart: false, hopeless: self.family.is_none() };
        let jet = |number: Option<Number>| self.family.and_then(|family| Some(family.jet_of(&number?)));
        let target = &self.question.value;
        match self.probe.without_rate().0 {
            Probe::Frequency(_) | Probe::Square(_) => {
                let square = (target * &two_pi()).square();
                let course = self.course.filter(|_| !matches!(target, Number::Jet(_)));
                RangeEnclosure {
                    test: self.family.and_then(|family| family.resonance(&square)),
                    course,
                    apart: false,
                    hopeless: self.family.is_none() && course.is_none(),
                }
            }
            Probe::Critical(1) => test(jet(self.family.and_then(Family::single_discriminant))),
            Probe::Damping(1) => test(jet(self.family.and_then(Family::single_ratio).map(|ratio| &ratio - target))),
            Probe::Gain(..) | Probe::Amplitude(_) => {
                let direct = || Some(&self.phasor()?.square() - &target.square());
                // Near a resonance: the force that would bring the motion to the target, minus the actual force.
                let inverse = || {
                    let (z, force) = self.inverse()?;
                    let wanted = force.checked_div(target)?;
                    Some(&z.square() - &wanted.square())
                };
                test(jet(direct().or_else(inverse)))
            }
            Probe::Phase(..) => {
                let direct = || self.phasor()?.rotate(&Number::ONE, &-target);
                let turned = direct().or_else(|| self.inverse()?.0.rotate(&Number::ONE, target));
                let apart = turned.as_ref().is_some_and(|z| z.re.is_negative());
                RangeEnclosure { apart, ..test(jet(turned.map(|z| z.im))) }
            }
            Probe::Static(_) => {
                let direct = || Some(&self.phasor()?.re - target);
                let inverse = || {
                    let (z, force) = self.inverse()?;
                    Some(&z.re - &force.checked_div(target)?)
                };
                test(jet(direct().or_else(inverse)))
            }
            Probe::Damping(_)
            | Probe::Critical(_)
            | Probe::Growth
            | Probe::Peak(_)
            | Probe::Settling(..)
            | Probe::Overshoot(_)
            | Probe::Rms(..)
            | Probe::RmsWithin(..)
            | Probe::Psd(..)
            | Probe::Crossings(_)
            | Probe::PeakGain(..)
            | Probe::EffectiveMass(..)
            | Probe::Rest(..)
            | Probe::LoadFactor
            | Probe::Combined(_)
            | Probe::ByRate(..)
            | Probe::Stable => RangeEnclosure { hopeless: true, ..test(None) },
        }
    }

    /// The measure of harmonic motion or of a lasting load with its derivative; `None` for other measures, and if it may be infinite.
    pub fn measure(&self) -> Option<Jet> {
        let found = match self.probe.without_rate().0 {
            Probe::Gain(..) => {
                let direct = || self.phasor()?.size();
                // Near a resonance the force that makes the motion 1 is better known than the motion.
                let inverse = || Number::ONE.checked_div(&number(self.inverse()?.0.size()?));
                direct().map(number).or_else(inverse)
            }
            Probe::Amplitude(output) => amplitude(self.family?, self.drive.signals, *output),
            Probe::Phase(..) => {
                let direct = || self.phasor().and_then(|z| Number::atan2(&z.im, &z.re));
                let inverse = || self.inverse().and_then(|(z, _)| Number::atan2(&-&z.im, &z.re));
                direct().or_else(inverse)
            }
            Probe::Static(_) => {
                let direct = || Some(self.phasor()?.re);
                let inverse = || {
                    let (z, force) = self.inverse()?;
                    force.checked_div(&z.re)
                };
                direct().or_else(inverse)
            }
            _ => None,
        };
        let jet = self.family?.jet_of(&found?);
        jet.value.is_finite().then_some(jet)
    }

    /// The complex number whose magnitude or phase is the measure.
    fn phasor(&self) -> Option<Phasor> {
        let family = self.family?;
        let (probe, derivative) = self.probe.without_rate();
        match probe {
            Probe::Gain(input, output, at) | Probe::Phase(input, output, at) => {
                let omega = at * &two_pi();
                family.response(*input, *output, &omega)?.times_power(&omega, -i32::from(derivative))
            }
            Probe::Static(output) => {
                lasting_response(family, self.drive.loads, *output).map(|re| Phasor { re, im: Number::ZERO })
            }
            Probe::Amplitude(_) if self.drive.signals.iter().flatten().any(Signal::comes_again) => None,
            Probe::Amplitude(output) => harmonic_response(family, self.drive.signals, *output),
            _ => None,
        }
    }

    /// The reciprocal of the response behind the measure, and the force, if a single force causes the motion.
    fn inverse(&self) -> Option<(Phasor, Number)> {
        let family = self.family?;
        let (probe, derivative) = self.probe.without_rate();
        match probe {
            Probe::Gain(input, output, at) | Probe::Phase(input, output, at) => {
                let omega = at * &two_pi();
                let inverse = family.inverse_response(*input, *output, &omega)?;
                Some((inverse.times_power(&omega, i32::from(derivative))?, Number::ONE))
            }
            Probe::Static(output) => {
                let mut loads = self.drive.loads.iter().filter(|(_, load)| !load.is_zero());
                let (input, load) = loads.next().filter(|_| loads.next().is_none())?;
                Some((family.inverse_response(*input, *output, &Number::ZERO)?, load.clone()))
            }
            Probe::Amplitude(_) if self.drive.signals.iter().flatten().any(Signal::comes_again) => None,
            Probe::Amplitude(output) => {
                let signals = self.drive.signals.iter().enumerate();
                let mut harmonic = signals.flat_map(|(input, signals)| {
                    signals.iter().filter_map(move |signal| match signal {
                        Signal::Harmonic { value, frequency, .. } => Some((input, value, frequency)),
                        _ => None,
                    })
                });
                let (input, value, frequency) = harmonic.next().filter(|_| harmonic.next().is_none())?;
                Some((family.inverse_response(input, *output, &(frequency * &two_pi()))?, value.clone()))
            }
            _ => None,
        }
    }

    /// The derivative of an eigenvalue or a pole in the centre, if it is simple.
    pub fn derivative_in_centre(&self, centre: &Centre) -> Option<Moved> {
        match *centre {
            Centre::Eigenvalue(square) => {
                let family = self.family?;
                family.eigenvalue_slope(square, &family.modes_at(square, 1)?).map(Moved::Eigenvalue)
            }
            Centre::Pole(re, im) => {
                let (family, s) = (self.family?, Complex::new(re, im));
                family.pole_slope(s, &family.motion_at(s)?).map(|s| Moved::Pole(s.re, s.im))
            }
            Centre::None => Some(Moved::None),
        }
    }

    /// The derivative of the measure, over the family; the centre contains the eigenvalue or pole that the measure
    /// depends on.
    pub fn slope(&self, centre: &Centre) -> Option<Ball> {
        let slope = match (self.probe, *centre, self.derivative_in_centre(centre)?) {
            (Probe::Frequency(_), Centre::Eigenvalue(square), Moved::Eigenvalue(slope)) => {
                frequency_slope(square, slope)
            }
            (Probe::Damping(_), Centre::Pole(re, im), Moved::Pole(re_slope, im_slope)) => {
                ratio_slope((re, im), (re_slope, im_slope))
            }
            _ => {
                let jet = |number: Number| self.family.map(|family| family.jet_of(&number));
                let z = self.phasor()?;
                let (re, im) = (jet(z.re)?, jet(z.im)?);
                let square = re.value.square() + im.value.square();
                match self.probe.without_rate().0 {
                    Probe::Static(_) => re.slope,
                    Probe::Gain(..) | Probe::Amplitude(_) => {
                        (re.value * re.slope + im.value * im.slope) / square.sqrt()
                    }
                    Probe::Phase(..) => (re.value * im.slope - im.value * re.slope) / square,
                    _ => return None,
                }
            }
        };
        slope.is_finite().then_some(slope)
    }
}

/// The derivative of a frequency in Hz, from omega^2 and its derivative.
pub fn frequency_slope(square: Ball, slope: Ball) -> Ball {
    slope / (square.sqrt() * Ball::PI * Ball::from(4.0))
}

/// The derivative of a damping ratio -re / |s|, from a pole and its derivative.
pub fn ratio_slope((re, im): (Ball, Ball), (re_slope, im_slope): (Ball, Ball)) -> Ball {
    // d(-re / |s|) = (-re' im^2 + re im im') / |s|^3
    let size = (re.square() + im.square()).sqrt();
    (re * im_slope - re_slope * im) * im / (size * size * size)
}

/// sum H(0) load
fn lasting_response(family: &Family, loads: &[(usize, Number)], output: usize) -> Option<Number> {
    loads.iter().filter(|(_, load)| !load.is_zero()).try_fold(Number::ZERO, |sum, (input, load)| {
        Some(&sum + &(load * &family.response(*input, output, &Number::ZERO)?.re))
    })
}

/// The one-sided density of an output under noises, each of which may reach several inputs with delays; `None` if it may be infinite, or
/// the density of a noise has not one form over the range.
pub fn spectral_density(family: &Family, noises: &[Noise], output: usize, frequency: &Number) -> Option<Number> {
    let omega = frequency * &two_pi();
    noises.iter().try_fold(Number::ZERO, |sum, noise| {
        let density = jet::without_division(|| noise.density.at(frequency))??;
        let gain = noise.inputs.iter().try_fold(Phasor::ZERO, |gain, (input, delay)| {
            let response = family.response(*input, output, &omega)?;
            Some(gain.plus(&response.rotate(&Number::ONE, &-&(&omega * delay))?))
        })?;
        let gain = gain.times_power(&omega, -i32::from(noise.derivative))?;
        Some(&sum + &(&gain.square() * &density))
    })
}

/// The motion under harmonic signals that all have the same frequency.
fn harmonic_response(family: &Family, signals: &[Vec<Signal>], output: usize) -> Option<Phasor> {
    let mut known: Option<&Number> = None;
    let mut sum = Phasor::ZERO;
    for (input, signals) in signals.iter().enumerate() {
        for signal in signals {
            let Signal::Harmonic { value, frequency, phase, .. } = signal else { continue };
            let same = |other: &Number| (other - frequency).is_zero() && frequency.exact().is_some();
            if !known.is_none_or(same) {
                return None;
            }
            known = Some(frequency);
            let response = family.response(input, output, &(frequency * &two_pi()))?;
            sum = sum.plus(&response.rotate(value, phase)?);
        }
    }
    known.map(|_| sum)
}

/// The amplitude under harmonic signals: those of one frequency add as complex numbers, amplitudes of different frequencies add up.
fn amplitude(family: &Family, signals: &[Vec<Signal>], output: usize) -> Option<Number> {
    let mut sums: Vec<(&Number, Phasor)> = Vec::new();
    for (input, signals) in signals.iter().enumerate() {
        for signal in signals {
            let (value, frequency, phase) = match signal {
                Signal::Harmonic { value, frequency, phase, .. } => (value, frequency, phase),
                // What is delayed may be harmonic.
                Signal::Delayed { .. } => return None,
                _ => continue,
            };
            let own = family.response(input, output, &(frequency * &two_pi()))?.rotate(value, phase)?;
            if own.square().is_zero() {
                continue;
            }
            let certain = |(known, _): &(&Number, Phasor)| known.exact().is_some() && frequency.exact().is_some();
            match sums.iter().position(|(known, _)| (*known - frequency).is_zero()) {
                Some(place) => sums[place].1 = sums[place].1.plus(&own),
                // Whether two frequencies are the same has to be certain.
                None if sums.iter().all(certain) => sums.push((frequency, own)),
                None => return None,
            }
        }
    }
    sums.iter().map(|(_, sum)| sum.size()).try_fold(Number::ZERO, |total, size| Some(&total + &number(size?)))
}

fn number(jet: Jet) -> Number {
    Number::from(jet)
}

pub fn two_pi() -> Number {
    &Number::pi() * &Number::from(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An eigenvalue 1 that moves by its slope times a parameter within 0.1 of zero, and by more the farther it is.
    #[test]
    fn an_eigenvalue_that_may_leave_its_enclosure_has_none() {
        let over_box = |slope: f64, growth: f64| {
            let start = Centre::Eigenvalue(Ball::ONE.widen(1e-9));
            let found = start.over_box(&[0.1], |centre| {
                let Centre::Eigenvalue(square) = centre else { return None };
                Some(vec![Moved::Eigenvalue(Ball::from(slope).widen(growth * square.rad))])
            });
            found.map(|centre| match centre {
                Centre::Eigenvalue(square) => square.rad,
                Centre::Pole(..) | Centre::None => 0.0,
            })
        };
        assert!(over_box(1.0, 0.0).is_some_and(|rad| (0.1..1.0).contains(&rad)));
        assert!(over_box(1.0, 5.0).is_some_and(|rad| rad >= 0.1 * (1.0 + 5.0 * rad)));
        // With a slope of 1 +- 15 * 0.4 it may move by 0.7, and not stay within 0.4.
        assert_eq!(over_box(1.0, 15.0), None);
        let pole = Centre::Pole(-Ball::ONE, Ball::from(2.0));
        let moved = |re: f64, im: f64| {
            move |centre: &Centre| {
                let Centre::Pole(a, b) = centre else { return None };
                Some(vec![Moved::Pole(Ball::ONE.widen(re * a.rad), Ball::ONE.widen(im * b.rad))])
            }
        };
        assert!(pole.over_box(&[0.1], moved(1.0, 1.0)).is_some());
        assert!(pole.over_box(&[0.1], moved(15.0, 1.0)).is_none() && pole.over_box(&[0.1], moved(1.0, 15.0)).is_none());
    }
}
