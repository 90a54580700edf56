//! Sensitivities: the derivatives of frequencies and damping ratios with respect to each parameter. In: the text, and the
//! modes and poles that the report shows. Out: for each parameter a slope for each of them. See docs/method/measures.md.
//!
//! The derivatives of simple eigenvalues and poles are enclosed: first their vectors, once, from equations bordered to be
//! regular; then the derivative of the matrices for each parameter. If no enclosure is found, differences give a value
//! without a bound.

use super::answer::{Derivative, Sensitivity, Slope};
use super::derivative::{NoSlope, slope, step};
use super::range_enclosure::{frequency_slope, ratio_slope};
use super::trial::Text;
use crate::analysis::measures::damped_motion;
use crate::analysis::range::Family;
use crate::analysis::{Mode, ModeKind, Modes, Pole, PoleKind, Poles, Request};
use crate::base::{Ball, Jet, Number, Quantity, Unproven};
use crate::kernel::complex::Complex;
use crate::kernel::dense::Matrix;
use crate::lower::rest::Rest;
use crate::model::Setting;
use crate::model::scene::Parameter;
use crate::system::LinearSystem;

/// In larger systems, the poles are not computed two more times for each parameter.
const MOST_BY_DIFFERENCES: usize = 60;
/// Slopes of equal frequencies with a relative difference below this count as one.
const ALIKE: f64 = 1e-9;

/// The derivatives with respect to every parameter, in order of declaration.
pub fn sensitivities(
    text: &Text,
    settings: &[Setting],
    request: &Request,
    (system, rest): (&LinearSystem, &Rest),
    modes: &Modes,
    poles: &Poles,
) -> Vec<Sensitivity> {
    let here = Spectrum::of(modes, poles);
    let vectors = Vectors::of(system, &here);
    let parameters = text.parameters(settings);
    let (here, vectors, n) = (&here, &vectors, system.n());
    let of = |parameter| SlopeComputation { text, settings, request, parameter, here, vectors, n, rest };
    parameters.iter().map(of).map(|of| of.sensitivity()).collect()
}

/// The reported numbers of a system: `None` for a mode that does not oscillate.
struct Spectrum {
    /// Number of the first mode.
    first: usize,
    /// Hz
    frequencies: Vec<Option<Ball>>,
    /// omega^2, and the cluster of modes that are certified only together.
    squares: Vec<(Ball, Option<u32>)>,
    /// A pole of each damped motion.
    motions: Vec<Pole>,
    poles: Vec<Pole>,
}

impl Spectrum {
    fn of(modes: &Modes, poles: &Poles) -> Spectrum {
        let frequency = |mode: &Mode| mode.frequency().filter(|_| mode.kind == ModeKind::Oscillation);
        let is_damped = poles.list.iter().any(|pole| !pole.re.is_zero());
        let motions = (1..).map_while(|i| damped_motion(poles, i).ok().cloned());
        Spectrum {
            first: modes.before.count() + 1,
            frequencies: modes.list.iter().map(frequency).collect(),
            squares: modes.list.iter().map(|mode| (mode.omega_squared, mode.cluster)).collect(),
            motions: if is_damped { motions.collect() } else { Vec::new() },
            poles: poles.list.clone(),
        }
    }

    /// The largest relative error among the numbers that are known well enough to be reported.
    fn relative_error(&self) -> f64 {
        let ratios = self.motions.iter().filter_map(|pole| pole.damping_ratio);
        let balls = self.frequencies.iter().flatten().copied().chain(ratios);
        balls.map(|ball| ball.relative_error()).filter(|error| *error < 1e-6).fold(0.0, f64::max)
    }

    /// The damping ratio of the pole nearest to a previous one: the order may change if two are equally far from zero.
    fn ratio_near(&self, pole: &Pole) -> Option<Ball> {
        let distance = |other: &Pole| {
            let (re, im) = (other.re.mid - pole.re.mid, other.im.mid - pole.im.mid);
            (re * re + im * im).to_f64()
        };
        let nearest = self.poles.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        nearest.damping_ratio
    }
}

/// Enclosed vectors of modes and motions.
struct Vectors {
    /// The vectors of each mode with the enclosure of omega^2 for which they are valid; the modes of a cluster share
    /// theirs.
    modes: Vec<Option<(Ball, Matrix<Ball>)>>,
    motions: Vec<Option<Vec<Complex<Ball>>>>,
}

impl Vectors {
    fn of(system: &LinearSystem, here: &Spectrum) -> Vectors {
        let Some(family) = Family::of(system, false) else {
            return Vectors { modes: vec![None; here.squares.len()], motions: vec![None; here.motions.len()] };
        };
        let mode = |&(square, cluster): &(Ball, Option<u32>)| {
            let together: Vec<Ball> = match cluster {
                None => vec![square],
                Some(_) => {
                    here.squares.iter().filter(|(_, other)| *other == cluster).map(|(square, _)| *square).collect()
                }
            };
            let all = hull(&together);
            Some((all, family.modes_at(all, together.len())?))
        };
        let motion = |pole: &Pole| match pole.kind {
            PoleKind::Oscillation | PoleKind::Flutter => family.motion_at(Complex::new(pole.re, pole.im)),
            _ => None,
        };
        Vectors { modes: here.squares.iter().map(mode).collect(), motions: here.motions.iter().map(motion).collect() }
    }
}

/// A ball that contains all of the given ones.
fn hull(balls: &[Ball]) -> Ball {
    let first = balls[0];
    let reach = |ball: &Ball| (*ball - Ball::exact(first.mid)).magnitude();
    Ball::exact(first.mid).widen(balls[1..].iter().map(reach).fold(first.rad, f64::max))
}

/// The slopes with respect to one parameter.
struct SlopeComputation<'a> {
    text: &'a Text<'a>,
    settings: &'a [Setting],
    request: &'a Request,
    parameter: &'a Parameter,
    here: &'a Spectrum,
    vectors: &'a Vectors,
    n: usize,
    rest: &'a Rest,
}

/// The system on both sides of the parameter's value.
struct Sides {
    h: Number,
    before: Option<Spectrum>,
    after: Option<Spectrum>,
}

impl SlopeComputation<'_> {
    fn sensitivity(&self) -> Sensitivity {
        let Parameter { name, value, unit, .. } = self.parameter;
        let point = Jet::of_parameter(value.si.enclosure());
        let (mut frequencies, mut ratios) = (Vec::new(), Vec::new());
        self.text.family(&self.settings_at(point), self.rest, |undamped, damped| {
            frequencies = (0..self.here.squares.len()).map(|i| self.frequency(undamped?, i)).collect();
            ratios = (0..self.here.motions.len()).map(|i| self.ratio(damped?, i)).collect();
        });
        frequencies.resize(self.here.squares.len(), None);
        ratios.resize(self.here.motions.len(), None);
        // A missing number has no slope; other missing slopes are computed by differences.
        let is_incomplete = |found: &[Option<Slope>], known: &mut dyn Iterator<Item = bool>| {
            found.iter().zip(known).any(|(slope, known)| slope.is_none() && known)
        };
        let left = is_incomplete(&frequencies, &mut self.here.frequencies.iter().map(Option::is_some))
            || is_incomplete(&ratios, &mut self.here.motions.iter().map(|pole| pole.damping_ratio.is_some()));
        let sides = if left { Some(self.sides()) } else { None };
        for (i, slope) in frequencies.iter_mut().enumerate() {
            *slope = slope
                .take()
                .or_else(|| self.by_differences(&sides, self.here.frequencies[i], &|there| there.frequencies[i]));
        }
        for (slope, pole) in ratios.iter_mut().zip(&self.here.motions) {
            if slope.is_none() && pole.damping_ratio.is_some() && self.n > MOST_BY_DIFFERENCES {
                *slope = Some(Slope::NotComputed);
            }
            *slope = slope
                .take()
                .or_else(|| self.by_differences(&sides, pole.damping_ratio, &|there| there.ratio_near(pole)));
        }
        Sensitivity {
            parameter: name.clone(),
            value: value.si.clone(),
            unit: unit.clone(),
            first: self.here.first,
            frequencies,
            ratios,
        }
    }

    fn settings_at(&self, si: Number) -> Vec<Setting> {
        let quantity = Quantity { si, ..self.parameter.value.clone() };
        let others = self.settings.iter().filter(|(name, _)| *name != self.parameter.name).cloned();
        others.chain([(self.parameter.name.clone(), quantity)]).collect()
    }

    fn smooth(&self, slope: Derivative, known: Ball) -> Slope {
        Slope::Smooth { absolute: slope, relative: slope.scale(self.parameter.value.si.to_ball() / known) }
    }

    /// The enclosed slope of a frequency.
    fn frequency(&self, family: &Family, i: usize) -> Option<Slope> {
        let known = self.here.frequencies[i]?;
        let (square, x) = self.vectors.modes[i].as_ref()?;
        if x.columns() == 1 {
            let slope = frequency_slope(self.here.squares[i].0, family.eigenvalue_slope(*square, x)?);
            return slope.is_finite().then(|| self.smooth(Derivative::Enclosed(slope), known));
        }
        let (all, each) = family.cluster_slopes(*square, x)?;
        let in_hertz = |slope: Ball| frequency_slope(self.here.squares[i].0, slope);
        if all.rad <= ALIKE * all.mid.hi.abs() || all.is_zero() {
            return Some(self.smooth(Derivative::Enclosed(in_hertz(all)), known));
        }
        let factor = in_hertz(Ball::ONE);
        Some(Slope::Splits(each.iter().map(|slope| Unproven(slope * factor.to_f64())).collect()))
    }

    /// The enclosed slope of a damping ratio.
    fn ratio(&self, family: &Family, i: usize) -> Option<Slope> {
        let pole = &self.here.motions[i];
        let slope = family.pole_slope(Complex::new(pole.re, pole.im), self.vectors.motions[i].as_ref()?)?;
        let slope = ratio_slope((pole.re, pole.im), (slope.re, slope.im));
        let known = pole.damping_ratio?;
        slope.is_finite().then(|| self.smooth(Derivative::Enclosed(slope), known))
    }

    fn sides(&self) -> Sides {
        let value = &self.parameter.value.si;
        let unit = self.parameter.unit.factor.clone().unwrap_or(Number::ONE);
        let h = step(value, &unit, self.here.relative_error());
        let at = |si: Number| {
            let settings = self.settings_at(si);
            if self.n > MOST_BY_DIFFERENCES && !self.here.motions.is_empty() {
                let modes = self.text.undamped_modes(&settings, self.request).ok()?;
                return Some(Spectrum::of(&modes, &Poles::default()));
            }
            let modal = self.text.modal(&settings, self.request).ok()?;
            Some(Spectrum::of(&modal.modes, &modal.poles))
        };
        Sides { before: at(value - &h), after: at(value + &h), h }
    }

    fn by_differences(
        &self,
        sides: &Option<Sides>,
        known: Option<Ball>,
        of: &dyn Fn(&Spectrum) -> Option<Ball>,
    ) -> Option<Slope> {
        let known = known?;
        let Sides { h, before, after } = sides.as_ref()?;
        let there = |spectrum: &Option<Spectrum>| {
            spectrum.as_ref().filter(|there| there.frequencies.len() == self.here.frequencies.len()).and_then(of)
        };
        Some(match slope(there(before), Some(known), there(after), h) {
            Ok(seen) => self.smooth(Derivative::Estimated(Unproven(seen.to_f64())), known),
            Err(NoSlope::Kink) => Slope::Splits(Vec::new()),
            Err(NoSlope::Undefined) => Slope::Undefined,
        })
    }
}
