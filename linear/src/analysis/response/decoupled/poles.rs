//! A system whose damping couples its modes, in coordinates of its poles: zeta_j' = s_j zeta_j + the effect of inputs,
//! as two real states for one of each conjugate pair. See docs/method/response.md#pole-steps.

use super::blocks::Blocks;
use super::oscillators::{MANY_TURNS, Output, feed_through};
use super::{Change, Coordinates};
use crate::analysis::answer::Modes;
use crate::analysis::poles::coordinates::PoleCoordinates;
use crate::analysis::poles::pole_coordinates;
use crate::analysis::response::UP;
use crate::analysis::response::channel::{Channel, derivatives, exogenous};
use crate::base::{Ball, Dd, Number, Power};
use crate::kernel::complex::Complex;
use crate::system::{self, LinearSystem};
use std::sync::Arc;

/// The coordinates, with a bound of their coupling.
pub struct PoleBlocks {
    of: Arc<PoleCoordinates>,
}

impl PoleBlocks {
    /// With their blocks. `None` if the poles are not coordinates of the motion.
    pub fn of(
        system: &LinearSystem,
        modes: &Modes,
        channels: &[Channel],
        times: &[Number],
    ) -> Option<(PoleBlocks, Blocks)> {
        let of = pole_coordinates(&only_driven(system, channels), modes)?;
        let n = of.pairs.len();
        let part = |entry: fn(&Complex<Dd>) -> Dd| of.pairs.iter().map(|pair| entry(&pair.s)).collect::<Vec<Dd>>();
        let a = [part(|s| s.re), part(|s| -s.im), part(|s| s.im), part(|s| s.re)];
        let mut sources = exogenous(system, channels, times);
        let relaxation = relaxation(&of, times);
        sources.longest.iter_mut().for_each(|time| *time = time.min(relaxation));
        let mut force = vec![vec![[Ball::ZERO; 2]; n]; sources.count];
        for channel in channels {
            for (b, derivative) in of.inputs[channel.input].iter().zip(derivatives(&channel.source)) {
                let Some(b) = b else { continue };
                for (state, factor) in derivative {
                    for ([re, im], b) in force[channel.first + state].iter_mut().zip(b) {
                        (*re, *im) = (*re + b.re * factor, *im + b.im * factor);
                    }
                }
            }
        }
        // (A + A^T) / 2 = re s_j, and the disturbance moves the true state no faster than its own norm.
        let fastest_growth = of.pairs.iter().map(|pair| pair.s.re.hi).fold(0.0, f64::max);
        let mut blocks = Blocks::of(a, force, &sources, (fastest_growth + of.coupling) * UP);
        blocks.defect = of.coupling * UP;
        blocks.is_finite().then_some((PoleBlocks { of }, blocks))
    }

    /// The effect of an input on each coordinate by a power of its derivative; `None` if it has none.
    fn excitation(&self, input: usize, power: usize) -> Option<&Vec<Complex<Ball>>> {
        self.of.inputs[input][power].as_ref()
    }
}

/// Without the columns of inputs that have no signal, because they are not used.
fn only_driven(system: &LinearSystem, channels: &[Channel]) -> LinearSystem {
    let mut driven = system.clone();
    driven.outputs.clear();
    for (input, of) in driven.inputs.iter_mut().enumerate() {
        if !channels.iter().any(|channel| channel.input == input) {
            of.b = Default::default();
        }
    }
    driven
}

/// Approximate time in which all motions decay, if the horizon contains many of the fastest one's periods.
fn relaxation(of: &PoleCoordinates, times: &[Number]) -> f64 {
    let horizon = times.iter().map(Number::to_f64).fold(0.0, f64::max);
    let fastest = of.pairs.iter().map(|pair| pair.s.to_f64().abs()).fold(0.0, f64::max);
    let slowest = of.pairs.iter().map(|pair| -pair.s.re.hi).fold(f64::INFINITY, f64::min);
    if fastest * horizon > MANY_TURNS && slowest > 0.0 { 2.0 / slowest } else { f64::INFINITY }
}

fn length(z: &[[Ball; 2]]) -> f64 {
    z.iter().flatten().map(|x| x.magnitude().power(2)).sum::<f64>().sqrt() * UP
}

fn times(list: &[Complex<Ball>], factor: Ball) -> impl Iterator<Item = Complex<Ball>> {
    list.iter().map(move |z| z.scale(factor))
}

fn parts(list: impl Iterator<Item = Complex<Ball>>) -> Vec<[Ball; 2]> {
    list.map(|z| [z.re, z.im]).collect()
}

impl Coordinates for PoleBlocks {
    fn start(&self, _: &LinearSystem) -> Change {
        Change { z: parts(self.of.start.iter().copied()), defect: 0.0 }
    }

    fn impulse(&self, _: &LinearSystem, input: usize, value: Ball) -> Change {
        let none = vec![Complex::ZERO; self.of.pairs.len()];
        Change { z: parts(times(self.excitation(input, 0).unwrap_or(&none), value)), defect: 0.0 }
    }

    /// Forces g0 delta + g1 delta', g0 = b1 u + b2 u' and g1 = b2 u, change zeta by P g0 + (D - T) P g1, where P g are the
    /// coordinates of a force.
    fn jump(&self, _: &LinearSystem, input: usize, [u, rate]: [Ball; 2]) -> Change {
        let none = vec![Complex::ZERO; self.of.pairs.len()];
        let (b1, b2) = (self.excitation(input, 1).unwrap_or(&none), self.excitation(input, 2).unwrap_or(&none));
        let slope = parts(times(b2, u));
        let by_slope = times(b2, u).zip(&self.of.pairs).map(|(z, pair)| z * pair.s.to_ball());
        let all = times(b1, u).zip(times(b2, rate)).zip(by_slope).map(|((a, b), c)| a + b + c);
        Change { z: parts(all), defect: self.of.coupling * length(&slope) * UP }
    }

    fn force_size(&self, _: &LinearSystem, input: usize, power: usize) -> f64 {
        self.excitation(input, power).map_or(0.0, |list| length(&parts(list.iter().copied())))
    }

    fn outputs(&self, system: &LinearSystem, channels: &[Channel], blocks: &Blocks) -> Vec<Output> {
        system.outputs.iter().map(|output| self.output(output, channels, blocks)).collect()
    }
}

impl PoleBlocks {
    /// p0 q + p1 q' + p2 q'': with eta_j = g_j zeta_j each pole adds p . x_j s_j^k eta_j, and its conjugate the conjugate; the
    /// accelerations are sum s_j x_j eta_j' with eta' = (D - T) eta + what inputs add.
    fn output(&self, output: &system::Output, channels: &[Channel], blocks: &Blocks) -> Output {
        let of = &self.of;
        let sees = |power: usize| {
            let row: Vec<(usize, Ball)> = output.p[power].iter().map(|(i, p)| (i.index(), p.to_ball())).collect();
            (!row.is_empty()).then(|| of.sees(&row))
        };
        let seen = [0, 1, 2].map(sees);
        let factor = |j: usize| Ball::from(of.scale[j] * if of.pairs[j].is_real() { 1.0 } else { 2.0 });
        let mut row: Vec<(u32, Ball)> = Vec::with_capacity(2 * of.pairs.len());
        let mut of_rates = vec![Complex::ZERO; of.pairs.len()];
        for (j, pair) in of.pairs.iter().enumerate() {
            let s = pair.s.to_ball();
            let at =
                |power: usize| seen[power].as_ref().map_or(Complex::ZERO, |seen: &Vec<_>| seen[j].scale(factor(j)));
            of_rates[j] = at(2) * s;
            let sum = at(0) + (at(1) + of_rates[j]) * s;
            row.extend([(2 * j as u32, sum.re), (2 * j as u32 + 1, -sum.im)]);
        }
        row.retain(|(_, factor)| !factor.is_zero());
        let own = |force: &Vec<[Ball; 2]>| {
            let terms = of_rates.iter().zip(force).map(|(rate, &[re, im])| rate.re * re - rate.im * im);
            terms.fold(Ball::ZERO, |sum, term| sum + term)
        };
        let mut sources: Vec<Ball> = blocks.force.iter().map(own).collect();
        feed_through(output, channels, &blocks.scale, &mut sources);
        Output::of(row, sources, length(&parts(of_rates.iter().copied())))
    }
}
