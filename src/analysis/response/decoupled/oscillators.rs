//! A system as uncoupled oscillators: the parameters of each, the forces of the sources on them, the outputs as rows
//! over them, and bounds of what is neglected. See docs/method/response.md#modal-steps.

use super::{OutputErrors, Row};
use crate::analysis::answer::Modes;
use crate::analysis::modes::modes;
use crate::analysis::response::channel::{Channel, derivatives, exogenous, fed_approximations};
use crate::analysis::response::propagator::scales;
use crate::analysis::response::{UNIT, UP};
use crate::analysis::transfer::modal::ModalSum;
use crate::base::{Ball, Dd, Number, Power, rounding};
use crate::kernel::dense::Matrix;
use crate::kernel::squares::Squares;
use crate::system::{CoordinateId, LinearSystem};

/// eta'' + c eta' + k eta = force . w for each mode, as z' = A z + B w with z = (s eta, eta').
pub struct Oscillators {
    modes: ModalSum,
    /// sqrt |k|, or the reciprocal of the total time if that is larger.
    pub s: Vec<Dd>,
    /// k / s
    pub back: Vec<Dd>,
    pub c: Vec<Dd>,
    /// By state of a source, then by mode.
    pub force: Vec<Vec<Ball>>,
    /// The sources' own equation w' = G w.
    generator: Vec<(usize, usize, Ball)>,
    /// Powers of two with w = W w~; all other fields refer to w~.
    pub scale: Vec<f64>,
    /// A bound of |[[A_i, B_i], [0, G]]| for every mode, and of its error.
    pub norm: f64,
    pub radius: f64,
    /// A bound of |B| over all modes.
    pub force_norm: f64,
    /// Bounds of the logarithmic norms of all A_i, and of G.
    pub rate: f64,
    pub rate_of_sources: f64,
    /// Bounds of the disturbances of eta'' for a state, and for a force, of norm one.
    pub defect: f64,
    pub force_defect: f64,
    largest_s: f64,
    /// A bound of |E_C|.
    damping_defect: f64,
}

/// An output as a row over the state and one over the sources' states.
pub struct Output {
    pub row: Row,
    sources: Vec<Ball>,
    /// Norms of the row and of its radii, and those for the sources.
    norm: f64,
    radii: f64,
    source_norm: f64,
    source_radii: f64,
    /// The norm of the row over the modes' accelerations.
    acceleration: f64,
    rounding: f64,
}

/// (2^-53)^2
const SQUARE: f64 = rounding::UNIT_SQUARED;

impl Oscillators {
    /// `None` if modes are missing or coupled by the damping; `known` are all modes.
    pub fn of(
        system: &LinearSystem,
        known: Option<&Modes>,
        channels: &[Channel],
        times: &[Number],
    ) -> Option<Oscillators> {
        let modes = match known {
            Some(modes) => ModalSum::of(system, modes)?,
            None => ModalSum::of(system, &modes(system).ok()?)?,
        };
        let n = modes.k.len();
        let horizon = times.iter().map(Number::to_f64).fold(0.0, f64::max);
        let slowest = if horizon > 0.0 { 1.0 / horizon } else { 1.0 };
        let s = |k: &Dd| if k.hi.abs() > slowest * slowest { k.abs().sqrt() } else { Dd::from(slowest) };
        let s: Vec<Dd> = modes.k.iter().map(s).collect();
        let back: Vec<Dd> = modes.k.iter().zip(&s).map(|(&k, &s)| k / s).collect();
        let c = modes.c.clone();
        let mut sources = exogenous(system, channels, times);
        let relaxation = relaxation(&modes, horizon);
        sources.longest.iter_mut().for_each(|time| *time = time.min(relaxation));
        let mut force = vec![vec![Ball::ZERO; n]; sources.count];
        for &(i, state, factor) in &sources.force {
            for (mode, force) in force[state].iter_mut().enumerate() {
                *force = *force + Ball::exact(modes.shapes[(i, mode)]) * factor;
            }
        }
        let scale = scales(&Matrix::from_fn(n, sources.count, |i, j| force[j][i]), &sources);
        for (force, &w) in force.iter_mut().zip(&scale) {
            force.iter_mut().for_each(|b| *b = *b * Ball::from(w));
        }
        let scaled = |&(i, j, value): &(usize, usize, Ball)| (i, j, value * Ball::from(scale[j] / scale[i]));
        let generator: Vec<(usize, usize, Ball)> = sources.generator.iter().map(scaled).collect();
        let mut all = Oscillators {
            s,
            back,
            c,
            force,
            generator,
            scale,
            norm: 0.0,
            radius: 0.0,
            force_norm: 0.0,
            rate: 0.0,
            rate_of_sources: 0.0,
            defect: 0.0,
            force_defect: 0.0,
            largest_s: 0.0,
            damping_defect: 0.0,
            modes,
        };
        all.measure();
        (all.norm.is_finite() && all.defect.is_finite()).then_some(all)
    }

    /// Fills in the bounds.
    fn measure(&mut self) {
        let n = self.count();
        let sum = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
        let forces: f64 = sum(&mut self.force.iter().flatten().map(Ball::magnitude));
        let radii: f64 = sum(&mut self.force.iter().flatten().map(|b| b.rad));
        let generator = sum(&mut self.generator.iter().map(|(_, _, value)| value.magnitude()));
        let generator_radii = sum(&mut self.generator.iter().map(|(_, _, value)| value.rad));
        let own = |i: usize| self.s[i].hi.power(2) + self.back[i].hi.power(2) + self.c[i].hi.power(2);
        let largest_own = (0..n).map(own).fold(0.0, f64::max);
        self.force_norm = forces.sqrt() * UP;
        self.norm = (largest_own + forces + generator).sqrt() * UP;
        // s and k / s are used as stored: k is taken as their product, and its rounding error counts as a disturbance.
        self.radius = (radii + generator_radii).sqrt() * UP;
        // (A + A^T) / 2 = [[0, (s - k/s) / 2], [., -c]]
        let rate = |i: usize| {
            let skew = (self.s[i] - self.back[i]).abs().hi * 0.5 + UNIT * self.s[i].hi;
            skew + (-self.c[i].hi).max(0.0)
        };
        self.rate = (0..n).map(rate).fold(0.0, f64::max) * UP;
        self.rate_of_sources = self.rate_of_generator();
        self.largest_s = self.s.iter().map(|s| s.hi).fold(0.0, f64::max) * UP;
        let ModalSum { epsilon, k_size, c_size, .. } = &self.modes;
        let off = epsilon * n as f64;
        let inverse = off / (1.0 - off) * UP;
        let stiffness: f64 = k_size.iter().sum();
        let seen: f64 = k_size.iter().zip(&self.s).map(|(k, s)| k / (s.hi * s.hi)).sum();
        let damping: f64 = c_size.iter().sum();
        let diagonal = self.norm + self.norm;
        self.damping_defect = epsilon * damping * UP;
        let joined = self.damping_defect + epsilon * (stiffness * seen).sqrt() + 4.0 * UNIT * self.norm;
        self.defect = (inverse * diagonal + (1.0 + inverse) * joined) * UP;
        self.force_defect = inverse * self.force_norm * UP;
    }

    /// Upper bound of the 2-norm of (G + G^T) / 2. Harmonic sources are skew and add nothing; an integrator chain has
    /// one entry a row.
    fn rate_of_generator(&self) -> f64 {
        let of = |&(i, j, value): &(usize, usize, Ball)| {
            let back = self.generator.iter().find(|&&(k, l, _)| (k, l) == (j, i));
            let sum = back.map_or(value, |&(_, _, back)| value + back);
            sum.magnitude() * 0.5
        };
        // Each row of the symmetric part has at most two entries.
        self.generator.iter().map(of).fold(0.0, f64::max) * 2.0 * UP
    }

    pub fn count(&self) -> usize {
        self.s.len()
    }

    /// G restricted to the active states.
    pub fn generator_of(&self, on: &[usize]) -> Vec<(usize, usize, Dd)> {
        let place = |state: usize| on.iter().position(|&known| known == state);
        let entry = |&(i, j, value): &(usize, usize, Ball)| Some((place(i)?, place(j)?, value.mid));
        self.generator.iter().filter_map(entry).collect()
    }

    pub fn participation(&self, a: &[(CoordinateId, Number)]) -> Vec<Ball> {
        self.modes.participation(a)
    }

    /// Initial eta and eta', X^T M q and X^T M q', up to the disturbances.
    pub fn start(&self, system: &LinearSystem) -> (Vec<Ball>, Vec<Ball>) {
        let n = system.n();
        let (mut q, mut v) = (vec![Ball::ZERO; n], vec![Ball::ZERO; n]);
        for (i, displacement, velocity) in &system.initial {
            q[i.index()] = displacement.to_ball();
            v[i.index()] = velocity.to_ball();
        }
        let m = Squares::of_form(&system.m);
        let seen = |x: &[Ball]| -> Vec<Ball> {
            let mut image = vec![Ball::ZERO; n];
            for t in 0..m.len() {
                let (indices, factors) = m.row(t);
                let stretch = indices.iter().zip(factors).fold(Ball::ZERO, |sum, (&i, &a)| sum + a * x[i as usize]);
                let tension = m.weights[t] * stretch;
                indices.iter().zip(factors).for_each(|(&i, &a)| image[i as usize] = image[i as usize] + a * tension);
            }
            let along = |mode: usize| {
                let column = self.modes.shapes.column(mode);
                column.iter().zip(&image).fold(Ball::ZERO, |sum, (&x, &y)| sum + Ball::exact(x) * y)
            };
            (0..self.count()).map(along).collect()
        };
        (seen(&q), seen(&v))
    }

    /// Error of a change of the state computed as X^T (..), from the magnitudes of its two parts.
    pub fn defect_of_change(&self, eta: f64, rate: f64) -> f64 {
        let off = self.modes.epsilon * self.count() as f64;
        (off / (1.0 - off) * (self.largest_s * eta + rate + self.damping_defect * eta) + self.damping_defect * eta) * UP
    }

    /// Errors of the sources' approximations, as accelerations of the modes.
    pub fn approximations(&self, system: &LinearSystem, channels: &[Channel]) -> f64 {
        let of = |channel: &Channel| -> f64 {
            let b = &system.inputs[channel.input].b;
            let size = |k: usize| {
                let square: f64 = self.participation(&b[k]).iter().map(|b| b.magnitude().power(2)).sum();
                square.sqrt() * channel.approximation(k) * 2.0
            };
            (0..3).filter(|&k| channel.approximation(k) > 0.0 && !b[k].is_empty()).map(size).sum()
        };
        channels.iter().map(of).sum()
    }

    /// Every output as rows.
    pub fn outputs(&self, system: &LinearSystem, channels: &[Channel]) -> Vec<Output> {
        let n = self.count();
        let of = |output: &crate::system::Output| {
            let [p, v, a] = [0, 1, 2].map(|k| self.participation(&output.p[k]));
            let mut row: Vec<(u32, Ball)> = Vec::new();
            for i in 0..n {
                let s = Ball::exact(self.s[i]);
                let along = p[i] / s - a[i] * Ball::exact(self.back[i]);
                row.push((2 * i as u32, along));
                row.push((2 * i as u32 + 1, v[i] - a[i] * Ball::exact(self.c[i])));
            }
            row.retain(|(_, factor)| !factor.is_zero());
            let mut sources: Vec<Ball> = (self.force.iter())
                .map(|force| a.iter().zip(force).fold(Ball::ZERO, |sum, (&a, &b)| sum + a * b))
                .collect();
            for channel in channels {
                for (d, derivative) in output.d.iter().zip(derivatives(&channel.source)) {
                    for (_, value) in d.iter().filter(|(input, _)| *input as usize == channel.input) {
                        for (k, factor) in &derivative {
                            let index = channel.first + k;
                            let entry = value.to_ball() * *factor * Ball::from(self.scale[index]);
                            sources[index] = sources[index] + entry;
                        }
                    }
                }
            }
            let accelerations = a.iter().map(|a| a.magnitude().power(2)).sum::<f64>().sqrt() * UP;
            Output::of(row, sources, accelerations)
        };
        system.outputs.iter().map(of).collect()
    }
}

/// Approximate time in which all modes lose most of their energy, if the horizon contains many of their periods; see
/// [`crate::analysis::response::propagator::scales`].
fn relaxation(modes: &ModalSum, horizon: f64) -> f64 {
    let rates = modes.k.iter().zip(&modes.c).map(|(k, c)| {
        let (k, half) = (k.hi, 0.5 * c.hi);
        if k > half * half { half } else { half - (half * half - k).sqrt() }
    });
    let fastest = modes.k.iter().map(|k| k.hi.abs().sqrt()).fold(0.0, f64::max);
    let slowest = rates.fold(f64::INFINITY, f64::min);
    if fastest * horizon > MANY_TURNS && slowest > 0.0 { 2.0 / slowest } else { f64::INFINITY }
}

/// Shorter motions do not need this.
const MANY_TURNS: f64 = 1e6;

impl Output {
    fn of(row: Vec<(u32, Ball)>, sources: Vec<Ball>, acceleration: f64) -> Output {
        let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>().sqrt() * UP;
        let terms = row.len() as f64 + 3.0;
        let length = norm(&mut row.iter().map(|(_, factor)| factor.magnitude()));
        Output {
            norm: length,
            radii: norm(&mut row.iter().map(|(_, factor)| factor.rad)),
            source_norm: norm(&mut sources.iter().map(Ball::magnitude)),
            source_radii: norm(&mut sources.iter().map(|factor| factor.rad)),
            acceleration,
            rounding: terms * terms * SQUARE * length,
            row: row.into_iter().map(|(index, factor)| (index, factor.mid)).collect(),
            sources,
        }
    }

    /// Adds the direct feed-through of the sources; `w` holds the active ones.
    pub fn with_sources(&self, value: Dd, w: &[Dd], channels: &[Channel]) -> Dd {
        if self.source_norm == 0.0 {
            return value;
        }
        let on = channels.iter().flat_map(|c| c.first..c.first + c.states_on());
        on.zip(w).fold(value, |sum, (state, &w)| sum + self.sources[state].mid * w)
    }

    /// The bound of a value.
    pub fn radius(&self, off: &OutputErrors, value: Dd) -> f64 {
        let own = self.norm * off.error + (self.radii + self.rounding) * (off.z + off.error);
        let sums = (self.sources.len() as f64 + 2.0) * UNIT * (self.source_norm * off.w + value.hi.abs());
        let fed = if self.source_norm == 0.0 {
            0.0
        } else {
            self.source_norm * off.w_error + self.source_radii * off.w + sums
        };
        own + fed + self.acceleration * off.acceleration
    }

    /// The largest value that a state and sources of these norms could produce.
    pub fn scale(&self, z: f64, w: f64) -> f64 {
        self.norm * z + self.source_norm * w
    }

    /// Error in the direct feed-through caused by approximating the input signals.
    pub fn approximations(&self, channels: &[Channel], scale: &[f64]) -> f64 {
        fed_approximations(channels, |state| self.sources[state].magnitude() / scale[state])
    }
}
