//! What moves the frequencies and damping ratios: their derivatives by each parameter. In: the text, and the modes and poles
//! that the report shows. Out: for each parameter a slope for each of them. Clause: spec.md, "Measures, `solve`, `require`".

use super::answer::{Sensitivity, Slope};
use super::derivative::{NoSlope, slope, step};
use super::trial::Text;
use crate::analysis::measures::damped_motion;
use crate::analysis::{ModeKind, Modes, Pole, Poles, Request};
use crate::base::{Ball, Number, Quantity};
use crate::model::Setting;
use crate::model::scene::Parameter;

/// The derivatives by every parameter, in order of declaration.
pub fn sensitivities(
    text: &Text,
    settings: &[Setting],
    request: &Request,
    modes: &Modes,
    poles: &Poles,
) -> Vec<Sensitivity> {
    let here = Spectrum::of(modes, poles);
    let parameters = text.parameters(settings);
    parameters.iter().map(|parameter| sensitivity(text, settings, request, parameter, &here)).collect()
}

/// The numbers that are told of a system: none where a mode does not oscillate.
struct Spectrum {
    /// Number of the first mode.
    first: usize,
    /// Hz
    frequencies: Vec<Option<Ball>>,
    /// A pole of each damped motion.
    motions: Vec<Pole>,
    poles: Vec<Pole>,
}

impl Spectrum {
    fn of(modes: &Modes, poles: &Poles) -> Spectrum {
        let turn = Ball::from(2.0) * Ball::PI;
        let frequency = |kind: ModeKind, omega: Ball| (kind == ModeKind::Oscillation).then_some(omega / turn);
        let is_damped = poles.list.iter().any(|pole| !pole.re.is_zero());
        let motions = (1..).map_while(|i| damped_motion(poles, i).ok().cloned());
        Spectrum {
            first: modes.before.count() + 1,
            frequencies: modes.list.iter().map(|mode| frequency(mode.kind, mode.omega)).collect(),
            motions: if is_damped { motions.collect() } else { Vec::new() },
            poles: poles.list.clone(),
        }
    }

    /// The largest relative error of what is known well enough to be told.
    fn relative_error(&self) -> f64 {
        let ratios = self.motions.iter().filter_map(|pole| pole.damping_ratio);
        let balls = self.frequencies.iter().flatten().copied().chain(ratios);
        balls.map(|ball| ball.relative_error()).filter(|error| *error < 1e-6).fold(0.0, f64::max)
    }

    /// The damping ratio of the pole that is nearest to one of before: order may change where two are equally far from zero.
    fn ratio_near(&self, pole: &Pole) -> Option<Ball> {
        let distance = |other: &Pole| {
            let (re, im) = (other.re.mid - pole.re.mid, other.im.mid - pole.im.mid);
            (re * re + im * im).to_f64()
        };
        let nearest = self.poles.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        nearest.damping_ratio
    }
}

fn sensitivity(
    text: &Text,
    settings: &[Setting],
    request: &Request,
    parameter: &Parameter,
    here: &Spectrum,
) -> Sensitivity {
    let value = &parameter.value.si;
    let unit = parameter.unit.factor.clone().unwrap_or(Number::ONE);
    let h = step(value, &unit, here.relative_error());
    let at = |si: Number| {
        let quantity = Quantity { si, ..parameter.value.clone() };
        let others = settings.iter().filter(|(name, _)| *name != parameter.name).cloned();
        let moved: Vec<Setting> = others.chain([(parameter.name.clone(), quantity)]).collect();
        text.modal(&moved, request).map(|modal| Spectrum::of(&modal.modes, &modal.poles)).ok()
    };
    let (before, after) = (at(value - &h), at(value + &h));
    let told = |known: Option<Ball>, of: &dyn Fn(&Spectrum) -> Option<Ball>| {
        let known = known?;
        let there = |spectrum: &Option<Spectrum>| {
            spectrum.as_ref().filter(|there| there.frequencies.len() == here.frequencies.len()).and_then(of)
        };
        Some(match slope(there(&before), Some(known), there(&after), &h) {
            Ok(absolute) => Slope::Smooth { absolute, relative: absolute * value.to_ball() / known },
            Err(NoSlope::Kink) => Slope::Splits,
            Err(NoSlope::Undefined) => Slope::Undefined,
        })
    };
    let frequencies = here.frequencies.iter().enumerate();
    let motions = here.motions.iter();
    Sensitivity {
        parameter: parameter.name.clone(),
        value: value.clone(),
        unit: parameter.unit.clone(),
        first: here.first,
        frequencies: frequencies.map(|(i, known)| told(*known, &|there| there.frequencies[i])).collect(),
        ratios: motions.map(|pole| told(pole.damping_ratio, &|there| there.ratio_near(pole))).collect(),
    }
}
