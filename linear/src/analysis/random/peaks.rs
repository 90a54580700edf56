//! Peaks of an output's power spectral density. In: a transfer function as zeros and poles, a noise. Out: the
//! frequencies and densities of all peaks as enclosures, or the reason why completeness is not proved. See
//! docs/method/random.md#peaks.

use super::density::density;
use super::maxima::{Reaching, Share, maxima};
use super::several::{Range, ranges};
use super::{Reach, Spread};
use crate::analysis::transfer::Transfer;
use crate::analysis::transfer::extrema::{Exactly, Extrema, FeatureKind};
use crate::base::density::{Course, Density};
use crate::base::{Ball, Number};
use crate::system::{LinearSystem, Noise, Output};

/// A maximum of a density, not at the end of a band.
#[derive(Clone, Debug)]
pub struct Peak {
    /// Hz
    pub frequency: Ball,
    /// In the square of the output's unit per Hz.
    pub density: Ball,
}

const UNPROVED: &str = "it is not proved that no peak is missing";
const MANY: &str = "peaks are found under densities of up to 64 bands";
/// Limit on the bands, each of which is searched separately.
const MOST_BANDS: usize = 64;
/// Above this multiple of the largest zero or pole there is no peak.
const BEYOND: f64 = 1000.0;

/// Every peak of the density of an output, ascending.
pub fn peaks(
    transfer: &Transfer,
    system: &LinearSystem,
    noises: &[Noise],
    reach: &Reach,
    output: usize,
    by_modes: impl Fn() -> Result<Vec<Ball>, &'static str>,
) -> Result<Vec<Peak>, &'static str> {
    let reached = &system.outputs[output];
    let mut reaching: Vec<Reaching> = Vec::new();
    for noise in noises {
        let own = noise.inputs.iter().filter(|(input, _)| reach.from_input(system, *input, reached));
        let inputs: Vec<(usize, Number)> = own.cloned().collect();
        if !inputs.is_empty() {
            reaching.push((noise, inputs));
        }
    }
    let at_once = |inputs: &[(usize, Number)]| inputs.iter().all(|(_, delay)| (delay - &inputs[0].1).is_zero());
    if reaching.iter().map(|(noise, _)| noise.density.bands()).sum::<usize>() > MOST_BANDS {
        return Err(MANY);
    }
    let shares = || Share::all_by_roots(transfer, &reaching, output);
    let list = match &reaching[..] {
        _ if system.losses.is_some() => by_modes()?,
        [(noise, inputs)] if inputs.len() == 1 && transfer.zero_pole_form(inputs[0].0, output).is_some() => {
            under_one(transfer, noise, inputs[0].0, output)?
        }
        _ => {
            let is_at_once = reaching.iter().all(|(_, inputs)| at_once(inputs));
            let at_once = is_at_once.then(|| under_several(system, &reaching, reached).ok()).flatten();
            match (at_once, shares()) {
                (Some(list), _) => list,
                (None, Some(shares)) => maxima(&shares, None)?,
                (None, None) => by_modes()?,
            }
        }
    };
    let peak = |frequency: Ball| match density(transfer, system, noises, output, &Number::Ball(frequency)) {
        Spread::Finite(density) => Ok(Peak { frequency, density }),
        Spread::Infinite(_) | Spread::Unknown(_) => Err(UNPROVED),
    };
    list.into_iter().map(peak).collect()
}

/// For one noise of one input.
fn under_one(transfer: &Transfer, noise: &Noise, input: usize, output: usize) -> Result<Vec<Ball>, &'static str> {
    let exactly = transfer.zero_pole_form(input, output).ok_or(UNPROVED)?;
    let integrals = Ball::from(-f64::from(noise.derivative));
    let Density::Bands(bands) = &noise.density else { return above(exactly, integrals, Ball::ZERO) };
    let mut list: Vec<Ball> = Vec::new();
    for band in bands {
        let whole = exactly.with_power(integrals);
        let half = Ball::from(0.5);
        let weighed = match &band.course {
            // A line contains a factor w - w0, where w0 is its zero; a line through zero at 0 Hz is a power law.
            Course::Line { low, high } if !(low - high).is_zero() => {
                let apart = &(low * &band.to) - &(high * &band.from);
                let root = apart.checked_div(&(low - high)).ok_or(UNPROVED)?;
                match root.may_be_zero() {
                    // At an end of the band the slope of the logarithm is infinite, but that of the density is not.
                    false if low.is_zero() || high.is_zero() => {
                        let own = Noise { density: Density::Bands(vec![band.clone()]), ..noise.clone() };
                        let own = [(&own, vec![(input, Number::ZERO)])];
                        list.extend(maxima(&Share::all_by_roots(transfer, &own, output).ok_or(UNPROVED)?, None)?);
                        continue;
                    }
                    false => whole.with_factor(radians(&root), half),
                    true if root.is_zero() => exactly.with_power(integrals + half),
                    true => return Err(UNPROVED),
                }
            }
            Course::Line { low, .. } if low.is_zero() => continue,
            Course::Line { .. } => whole,
            _ => exactly.with_power(integrals + band.slope().ok_or(UNPROVED)?.to_ball() * half),
        };
        list.extend(between(&weighed, radians(&band.from), radians(&band.to))?);
    }
    Ok(list)
}

/// For noises that drive all their inputs at the same time.
fn under_several(
    system: &LinearSystem,
    reaching: &[(&Noise, Vec<(usize, Number)>)],
    output: &Output,
) -> Result<Vec<Ball>, &'static str> {
    let mut list = Vec::new();
    for Range { from, to, whole, power } in ranges(system, reaching, output)? {
        list.extend(match to {
            Some(to) => between(&whole.with_power(power), radians(&from), radians(&to))?,
            None => above(&whole, power, radians(&from))?,
        });
    }
    Ok(list)
}

fn radians(frequency: &Number) -> Ball {
    frequency.to_ball() * Ball::PI * Ball::from(2.0)
}

/// The frequencies in Hz of the maxima of |H| w^power above a frequency.
fn above(exactly: &Exactly, power: Ball, low: Ball) -> Result<Vec<Ball>, &'static str> {
    let top = (BEYOND * exactly.largest()).max(2.0 * low.magnitude());
    let excess = exactly.excess().ok_or(UNPROVED)? as f64 + power.to_f64();
    // For w >= K |z|, each zero or pole contributes w t / (t^2 + a^2) = 1 +- 2 / K to the slope.
    let is_settled = 4.0 * exactly.roots() as f64 <= BEYOND * excess.abs() && excess != 0.0;
    if !is_settled {
        return Err(UNPROVED);
    }
    between(&exactly.with_power(power), low, Ball::from(top))
}

/// The frequencies in Hz of the maxima between two angular frequencies.
fn between(weighed: &Exactly, low: Ball, high: Ball) -> Result<Vec<Ball>, &'static str> {
    let Extrema { list, complete, .. } = weighed.extrema(low, high);
    complete.ok_or(UNPROVED)?;
    let maxima = list.into_iter().filter(|extremum| extremum.kind == FeatureKind::Peak);
    Ok(maxima.map(|extremum| extremum.frequency).collect())
}
