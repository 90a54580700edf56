//! The power spectral density of an output at one frequency. In: enclosed gains, the noises. Out: an enclosure. See
//! docs/method/random.md#measures.

use super::{Reach, Spread};
use crate::analysis::rates::{Rate, from_rate_at_rest};
use crate::analysis::transfer::{Disc, Frequency, Gain, Transfer};
use crate::base::{Ball, Number};
use crate::kernel::complex::Complex;
use crate::system::{LinearSystem, Noise};

/// The one-sided density of an output at a frequency, Hz, in the square of its SI unit per Hz.
pub fn density(
    transfer: &Transfer,
    system: &LinearSystem,
    noises: &[Noise],
    output: usize,
    frequency: &Number,
) -> Spread {
    let at = Frequency::hertz(frequency);
    let reach = Reach::of(system);
    let mut sum = Ball::ZERO;
    let reached = &system.outputs[output];
    for noise in noises.iter().filter(|noise| reach.from_noise(system, noise, reached)) {
        let Some(density) = noise.density.at(frequency) else {
            return Spread::Unknown("the density leaves the range of numbers");
        };
        if density.is_zero() {
            continue;
        }
        let inputs: Vec<&(usize, Number)> =
            noise.inputs.iter().filter(|(input, _)| reach.from_input(system, *input, reached)).collect();
        if noise.derivative > 0 && frequency.may_be_zero() {
            let gain =
                if frequency.is_zero() { at_rest(system, &inputs, noise.derivative, output) } else { Err(NEAR_ZERO) };
            match gain {
                Ok(gain) => sum = sum + gain.square() * density.to_ball(),
                Err(why) => return why,
            }
            continue;
        }
        let by_rate = (0..2 * noise.derivative).fold(Ball::ONE, |product, _| product / at.omega);
        match gain(transfer, &at, &inputs, output) {
            Ok(gain) => sum = sum + gain.square() * density.to_ball() * by_rate,
            Err(why) => return why,
        }
    }
    Spread::Finite(sum)
}

const NEAR_ZERO: Spread = Spread::Unknown("the density of what a base integrates is not known at 0 Hz");

/// |sum H_j| at 0 Hz, from the velocities or accelerations of bases; delays have no phase there.
fn at_rest(system: &LinearSystem, inputs: &[&(usize, Number)], derivative: u8, output: usize) -> Result<Ball, Spread> {
    let mut sum = Complex::ZERO;
    for (input, _) in inputs {
        let rate = Rate { input: *input, derivative, word: "" };
        let driven = from_rate_at_rest(system, rate, output).map_err(Spread::Unknown)?;
        match Transfer::of(&driven).between(&Frequency::hertz(&Number::ZERO), &[driven.inputs.len() - 1], &[0])[0][0] {
            Gain::Finite(disc) => {
                let value = disc.value.to_ball();
                sum = sum + Complex::new(value.re.widen(disc.radius), value.im.widen(disc.radius));
            }
            // Two that are infinite may cancel.
            Gain::Infinite if inputs.len() == 1 => {
                return Err(Spread::Infinite("infinite at 0 Hz: the output drifts with the base".into()));
            }
            Gain::Infinite | Gain::Unknown => return Err(NEAR_ZERO),
        }
    }
    Ok((sum.re.square() + sum.im.square()).sqrt())
}

/// |sum H_j e^(-i w t_j)| over inputs with delays, s.
fn gain(transfer: &Transfer, at: &Frequency, inputs: &[&(usize, Number)], output: usize) -> Result<Ball, Spread> {
    let list: Vec<usize> = inputs.iter().map(|(input, _)| *input).collect();
    let gains = transfer.between(at, &list, &[output]);
    let discs: Vec<Disc> = gains
        .iter()
        .flatten()
        .map(|gain| match gain {
            Gain::Finite(disc) => Ok(*disc),
            // Two that are infinite may cancel.
            Gain::Infinite if list.len() == 1 => {
                Err(Spread::Infinite("infinite: an undamped motion is excited at its own frequency".into()))
            }
            Gain::Infinite | Gain::Unknown => Err(Spread::Unknown("the gain is not known at this frequency")),
        })
        .collect::<Result<_, _>>()?;
    if let [disc] = discs[..] {
        return Ok(disc.gain());
    }
    let turned = |(disc, (_, delay)): (&Disc, &&(usize, Number))| {
        let (sine, cosine) = Number::Ball(at.omega * delay.to_ball()).sin_cos()?;
        let value = disc.value.to_ball();
        let value = Complex::new(value.re.widen(disc.radius), value.im.widen(disc.radius));
        Some(value * Complex::new(cosine.to_ball(), -sine.to_ball()))
    };
    let sum = discs.iter().zip(inputs).try_fold(Complex::ZERO, |sum: Complex<Ball>, each| Some(sum + turned(each)?));
    let sum = sum.ok_or(Spread::Unknown("the phase of a delay is not known at this frequency"))?;
    Ok((sum.re.square() + sum.im.square()).sqrt())
}
