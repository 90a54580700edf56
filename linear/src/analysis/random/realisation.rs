//! A realisation of noise: the motion of every output under lines of random phases that have acted for ever. In: a
//! stable system, noises in bands, a seed, times. Out: an enclosure for each output and time. See
//! docs/method/random.md#realisations.

use super::gramian::{Obstacle, Space};
use super::why;
use crate::analysis::answer::Modes;
use crate::analysis::transfer::{Frequency, Gain, Transfer};
use crate::base::density::{Band, Density};
use crate::base::{Ball, Number, Rational};
use crate::kernel::complex::Complex;
use crate::kernel::disc::Disc;
use crate::kernel::philox::philox;
use crate::system::{LinearSystem, Noise};

type Point = Complex<Ball>;

/// Least number of lines of a noise.
const LEAST_LINES: i64 = 64;
const MOST_LINES: f64 = 20_000.0;
/// Limit on the product of lines, samples and outputs.
const MOST_TERMS: f64 = 1e8;
/// Number of steps after which the phase of a line is computed from the time again.
const RESTART: usize = 256;
/// Spacings from 2^-40 to 2^40 Hz.
const FINEST: i32 = 40;

/// A(w) e^(i w t) of one line, its frequency in Hz.
struct Line {
    frequency: Number,
    /// For each output.
    amplitudes: Vec<Point>,
}

/// The motion of every output at ascending times, s, under the noise of this seed; or the reason why there is none.
pub fn realisation(
    system: &LinearSystem,
    modes: &Modes,
    noises: &[Noise],
    seed: u64,
    times: &[Number],
) -> Result<Vec<Vec<Ball>>, &'static str> {
    let outputs: Vec<usize> = (0..system.outputs.len()).collect();
    let transfer = Transfer::of(system);
    if !Space::of(system, modes, None).map_err(why)?.decays() {
        return Err(why(Obstacle::NotStable));
    }
    let until = times.last().cloned().unwrap_or(Number::ZERO);
    let mut lines = Vec::new();
    for noise in noises {
        for (frequency, phasor) in phasors(noise, seed, &until)? {
            let amplitudes = responses(&transfer, noise, &frequency, phasor, &outputs)?;
            lines.push(Line { frequency, amplitudes });
        }
        let is_much = lines.len() as f64 * times.len() as f64 * (outputs.len() as f64 + 1.0) > MOST_TERMS;
        if is_much {
            return Err(TOO_MANY);
        }
    }
    let mut values = vec![vec![Ball::ZERO; outputs.len()]; times.len()];
    let steps = Steps::of(times);
    for line in &lines {
        line.add_to(&mut values, &steps)?;
    }
    Ok(values)
}

const WHITE: &str = "white noise has no realisation: its mean square is infinite, so give it a band";
const TOO_MANY: &str = "that takes too many lines: choose a shorter time or a narrower band";
const RANGE: &str = "the numbers leave their range";

/// The lines of a noise: frequencies in Hz, and amplitudes with their random phases. Each has the mean square of the
/// density in its cell of a grid, whose spacing is a power of two that is fine enough for the motion not to repeat
/// within the time.
fn phasors(noise: &Noise, seed: u64, until: &Number) -> Result<Vec<(Number, Point)>, &'static str> {
    let Density::Bands(bands) = &noise.density else { return Err(WHITE) };
    let (Some(first), Some(last)) = (bands.first(), bands.last()) else { return Ok(Vec::new()) };
    let spacing = spacing(&(&last.to - &first.from), until).ok_or(TOO_MANY)?;
    let source = noise.inputs.first().map_or(0, |(input, _)| *input);
    let mut list = Vec::new();
    for (index, band) in bands.iter().enumerate() {
        let cell_of = |frequency: &Number| (frequency / &spacing).to_f64();
        let (low, high) = (cell_of(&band.from).floor(), cell_of(&band.to).ceil());
        let count = high - low + list.len() as f64;
        let is_few = count < MOST_LINES && high < 1e15;
        if !is_few {
            return Err(TOO_MANY);
        }
        for cell in low as i64..high as i64 {
            let Some((frequency, square)) = line_of(band, cell, &spacing)? else { continue };
            let [turn, ..] = philox(
                [cell as u32, (cell >> 32) as u32, source as u32, index as u32],
                [seed as u32, (seed >> 32) as u32],
            );
            let turns = Rational::new(2 * i64::from(turn), 1 << 32);
            let (sine, cosine) = Number::of_pi(turns).sin_cos().ok_or(RANGE)?;
            let phasor = Complex::new(cosine.to_ball(), sine.to_ball());
            list.push((frequency, Complex::scale(phasor, square.sqrt())));
        }
    }
    Ok(list)
}

/// The largest power of two, Hz, whose period is at least the time and that gives enough lines in a range.
fn spacing(range: &Number, until: &Number) -> Option<Number> {
    let fits = |spacing: &Number| {
        let lines = range / spacing;
        !(&Number::ONE - &(until * spacing)).is_negative() && !(&lines - &Number::from(LEAST_LINES)).is_negative()
    };
    (-FINEST..=FINEST).rev().filter_map(|power| Number::from(2).powi(power)).find(fits)
}

/// The middle of the part of a band in a cell of the grid, and twice its mean square.
fn line_of(band: &Band, cell: i64, spacing: &Number) -> Result<Option<(Number, Ball)>, &'static str> {
    let [below, above] = [cell, cell + 1].map(|cell| &Number::from(cell) * spacing);
    let from = if (&below - &band.from).is_positive() { below } else { band.from.clone() };
    let to = if (&band.to - &above).is_positive() { above } else { band.to.clone() };
    let width = &to - &from;
    if !width.is_positive() {
        return Ok(None);
    }
    let middle = &(&from + &to) / &Number::from(2);
    let density = band.at(&middle).ok_or(RANGE)?;
    Ok(Some((middle, (&(&density * &width) * &Number::from(2)).to_ball())))
}

/// The response of each output to a line: sum H e^(-i w t) (i w)^-d over the inputs that the noise drives.
fn responses(
    transfer: &Transfer,
    noise: &Noise,
    frequency: &Number,
    phasor: Point,
    outputs: &[usize],
) -> Result<Vec<Point>, &'static str> {
    let at = Frequency::hertz(frequency);
    let inputs: Vec<usize> = noise.inputs.iter().map(|(input, _)| *input).collect();
    let mut own = phasor;
    for _ in 0..noise.derivative {
        // Divided by i w.
        own = Complex::new(own.im / at.omega, -own.re / at.omega);
    }
    let mut sums = vec![Complex::ZERO; outputs.len()];
    for (row, (_, delay)) in transfer.between(&at, &inputs, outputs).iter().zip(&noise.inputs) {
        let (sine, cosine) = sine_and_cosine(frequency, delay).ok_or(RANGE)?;
        let own = own * Complex::new(cosine, -sine);
        for (sum, gain) in sums.iter_mut().zip(row) {
            let Gain::Finite(disc) = gain else { return Err("a gain is not known at the frequency of a line") };
            let value = disc.value.to_ball();
            let value = Complex::new(value.re.widen(disc.radius), value.im.widen(disc.radius));
            *sum = *sum + value * own;
        }
    }
    Ok(sums)
}

/// Sine and cosine of 2 pi f t.
fn sine_and_cosine(frequency: &Number, time: &Number) -> Option<(Ball, Ball)> {
    let cycles = frequency * time;
    let angle = match cycles.exact() {
        Some(cycles) => Number::of_pi(&Rational::from(2i64) * cycles),
        None => &(&Number::pi() * &Number::from(2)) * &cycles,
    };
    let (sine, cosine) = angle.sin_cos()?;
    Some((sine.to_ball(), cosine.to_ball()))
}

/// Ascending times, s.
struct Steps<'t> {
    times: &'t [Number],
    /// The first step.
    step: Option<Number>,
    /// Whether a time follows the previous one by exactly such a step.
    is_next: Vec<bool>,
}

impl<'t> Steps<'t> {
    fn of(times: &'t [Number]) -> Steps<'t> {
        let step = match times {
            [first, second, ..] => Some(second - first),
            _ => None,
        };
        let is_step =
            |before: &Number, time: &Number| step.as_ref().is_some_and(|step| (&(time - before) - step).is_zero());
        let follows = (1..times.len()).map(|index| is_step(&times[index - 1], &times[index]) && index % RESTART != 0);
        let is_next = std::iter::once(false).chain(follows).collect();
        Steps { times, step, is_next }
    }
}

impl Line {
    /// Adds the real parts of its amplitudes times e^(i w t), rotating them by one step at a time.
    fn add_to(&self, values: &mut [Vec<Ball>], steps: &Steps) -> Result<(), &'static str> {
        let point = |time: &Number| {
            let (sine, cosine) = sine_and_cosine(&self.frequency, time).ok_or(RANGE)?;
            Ok::<Point, &'static str>(Complex::new(cosine, sine))
        };
        let by = steps.step.as_ref().map(point).transpose()?.map(Disc::of);
        // A rectangle would grow with each rotation.
        let mut phase = Disc::ZERO;
        for ((time, is_next), row) in steps.times.iter().zip(&steps.is_next).zip(values) {
            phase = match by {
                Some(by) if *is_next => phase * by,
                _ => Disc::of(point(time)?),
            };
            let [re, im] = [phase.value.re, phase.value.im].map(|part| Ball::new(part, phase.radius));
            for (value, amplitude) in row.iter_mut().zip(&self.amplitudes) {
                *value = *value + amplitude.re * re - amplitude.im * im;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean squares of the lines are those of the density: exactly of a flat one, whatever the time is.
    #[test]
    fn lines_have_the_mean_square_of_the_band() {
        let n = |text: &str| Number::from(text);
        let course = crate::base::density::Course::Flat(n("3"));
        let band = Band { from: n("0.3"), to: n("7.1"), course };
        let noise = Noise { inputs: vec![(0, Number::ZERO)], derivative: 0, density: Density::Bands(vec![band]) };
        for until in ["0.1", "3", "100"] {
            let lines = phasors(&noise, 7, &n(until)).expect("lines");
            let square = |z: &Point| (z.re.square() + z.im.square()).to_f64() / 2.0;
            let sum: f64 = lines.iter().map(|(_, z)| square(z)).sum();
            assert!((sum - 3.0 * 6.8).abs() < 1e-11, "{sum}");
            let spacing = (&lines[2].0 - &lines[1].0).to_f64();
            assert!(spacing * n(until).to_f64() <= 1.0 && lines.len() >= LEAST_LINES as usize, "{spacing}");
        }
        let other = phasors(&noise, 8, &n("3")).expect("lines");
        assert_ne!(other[0].1, phasors(&noise, 7, &n("3")).expect("lines")[0].1);
        assert!(phasors(&noise, 7, &n("1e6")).is_err());
    }
}
