//! A system as uncoupled oscillators: the parameters of each, the forces of the sources on them, the outputs as rows
//! over them, and bounds of what is neglected. See docs/method/response.md#modal-steps.

use super::blocks::Blocks;
use super::{Change, Coordinates, OutputErrors, Row};
use crate::analysis::answer::Modes;
use crate::analysis::response::channel::{Channel, derivatives, exogenous, fed_approximations};
use crate::analysis::response::{UNIT, UP};
use crate::analysis::transfer::modal::{ModalSum, OffDiagonal};
use crate::base::{Ball, Dd, Number, Power, rounding};
use crate::kernel::squares::Squares;
use crate::system::{self, CoordinateId, LinearSystem};

/// eta'' + c eta' + k eta = force . w for each mode, as z' = A z + B w with z = (s eta, eta').
pub struct Oscillators {
    modes: ModalSum,
    /// sqrt |k|, or the reciprocal of the total time if that is larger.
    s: Vec<Dd>,
    /// k / s
    back: Vec<Dd>,
    largest_s: f64,
    /// Bounds of |E_M| and |E_C|.
    inertia_defect: f64,
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
    /// With their blocks. `None` if modes are missing or coupled by the damping.
    pub fn of(
        system: &LinearSystem,
        modes: &Modes,
        channels: &[Channel],
        times: &[Number],
    ) -> Option<(Oscillators, Blocks)> {
        let modes = ModalSum::of(system, modes)?;
        let n = modes.k.len();
        let horizon = times.iter().map(Number::to_f64).fold(0.0, f64::max);
        let slowest = if horizon > 0.0 { 1.0 / horizon } else { 1.0 };
        let s = |k: &Dd| if k.hi.abs() > slowest * slowest { k.abs().sqrt() } else { Dd::from(slowest) };
        let s: Vec<Dd> = modes.k.iter().map(s).collect();
        let back: Vec<Dd> = modes.k.iter().zip(&s).map(|(&k, &s)| k / s).collect();
        let mut sources = exogenous(system, channels, times);
        let relaxation = relaxation(&modes, horizon);
        sources.longest.iter_mut().for_each(|time| *time = time.min(relaxation));
        let mut force = vec![vec![[Ball::ZERO; 2]; n]; sources.count];
        for &(i, state, factor) in &sources.force {
            for (mode, [_, force]) in force[state].iter_mut().enumerate() {
                *force = *force + Ball::exact(modes.shapes[(i, mode)]) * factor;
            }
        }
        let minus = |values: &[Dd]| values.iter().map(|&x| -x).collect::<Vec<Dd>>();
        let a = [vec![Dd::ZERO; n], s.clone(), minus(&back), minus(&modes.c)];
        let mut all = Oscillators { modes, s, back, largest_s: 0.0, inertia_defect: 0.0, damping_defect: 0.0 };
        let mut blocks = Blocks::of(a, force, &sources, all.rate());
        all.measure(&mut blocks);
        blocks.is_finite().then_some((all, blocks))
    }

    /// (A + A^T) / 2 = [[0, (s - k/s) / 2], [., -c]]
    fn rate(&self) -> f64 {
        let rate = |i: usize| {
            let skew = (self.s[i] - self.back[i]).abs().hi * 0.5 + UNIT * self.s[i].hi;
            skew + (-self.modes.c[i].hi).max(0.0)
        };
        (0..self.s.len()).map(rate).fold(0.0, f64::max) * UP
    }

    /// Fills in the bounds of what couples the modes.
    fn measure(&mut self, blocks: &mut Blocks) {
        // s and k / s are used as stored: k is taken as their product, and its rounding error counts as a disturbance.
        self.largest_s = self.s.iter().map(|s| s.hi).fold(0.0, f64::max) * UP;
        let OffDiagonal { m, c, k } = &self.modes.off;
        // The Frobenius norm of a matrix whose columns have these norms, each times a number of its mode.
        let norm = |columns: &[f64], factor: &dyn Fn(usize) -> f64| {
            columns.iter().enumerate().map(|(i, x)| (x * factor(i)).power(2)).sum::<f64>().sqrt() * UP
        };
        self.inertia_defect = norm(m, &|_| 1.0);
        self.damping_defect = norm(c, &|_| 1.0);
        let more = 1.0 / (1.0 - self.inertia_defect) * UP;
        // (1 + E_M)^-1 E_M times the oscillators' accelerations, and (1 + E_M)^-1 times the coupling.
        let diagonal = norm(m, &|i| self.back[i].hi.abs()) + norm(m, &|i| self.modes.c[i].hi);
        let joined = self.damping_defect + norm(k, &|i| 1.0 / self.s[i].hi) + 4.0 * UNIT * blocks.norm;
        blocks.defect = more * (diagonal + joined) * UP;
        blocks.force_defect = more * self.inertia_defect * blocks.force_norm * UP;
    }

    fn participation(&self, a: &[(CoordinateId, Number)]) -> Vec<Ball> {
        self.modes.participation(a)
    }

    /// A change of displacements and velocities of the modes, which are known up to the disturbances.
    fn change(&self, eta: &[Ball], rate: &[Ball]) -> Change {
        let length = |list: &[Ball]| list.iter().map(|x| x.magnitude().power(2)).sum::<f64>().sqrt() * UP;
        let defect = self.defect_of_change(length(eta), length(rate));
        let z = self.s.iter().zip(eta).zip(rate).map(|((&s, &eta), &rate)| [Ball::exact(s) * eta, rate]);
        Change { z: z.collect(), defect }
    }

    /// Error of a change of the state computed as X^T (..), from the magnitudes of its two parts.
    fn defect_of_change(&self, eta: f64, rate: f64) -> f64 {
        let off = self.inertia_defect;
        (off / (1.0 - off) * (self.largest_s * eta + rate + self.damping_defect * eta) + self.damping_defect * eta) * UP
    }
}

impl Coordinates for Oscillators {
    /// Initial eta and eta', X^T M q and X^T M q', up to the disturbances.
    fn start(&self, system: &LinearSystem) -> Change {
        let n = system.n();
        let (mut q, mut v) = (vec![Ball::ZERO; n], vec![Ball::ZERO; n]);
        for (i, displacement, velocity) in &system.initial {
            q[i.index()] = displacement.to_ball();
            v[i.index()] = velocity.to_ball();
        }
        let m = Squares::of_form(&system.m);
        let seen = |x: &[Ball]| -> Vec<Ball> {
            let image = m.image(x);
            let along = |mode: usize| {
                let column = self.modes.shapes.column(mode);
                column.iter().zip(&image).fold(Ball::ZERO, |sum, (&x, &y)| sum + Ball::exact(x) * y)
            };
            (0..self.s.len()).map(along).collect()
        };
        self.change(&seen(&q), &seen(&v))
    }

    fn impulse(&self, system: &LinearSystem, input: usize, value: Ball) -> Change {
        let kick: Vec<Ball> = self.participation(&system.inputs[input].b[0]).into_iter().map(|x| x * value).collect();
        self.change(&vec![Ball::ZERO; kick.len()], &kick)
    }

    fn jump(&self, system: &LinearSystem, input: usize, [u, speed]: [Ball; 2]) -> Change {
        let b = &system.inputs[input].b;
        let (b1, b2) = (self.participation(&b[1]), self.participation(&b[2]));
        let eta: Vec<Ball> = b2.iter().map(|&b| b * u).collect();
        let kick = b1.iter().zip(&b2).map(|(&b1, &b2)| b1 * u + b2 * speed);
        let rate: Vec<Ball> =
            kick.zip(&self.modes.c).zip(&eta).map(|((kick, &c), &eta)| kick - Ball::exact(c) * eta).collect();
        self.change(&eta, &rate)
    }

    fn force_size(&self, system: &LinearSystem, input: usize, power: usize) -> f64 {
        let participation = self.participation(&system.inputs[input].b[power]);
        participation.iter().map(|b| b.magnitude().power(2)).sum::<f64>().sqrt()
    }

    fn outputs(&self, system: &LinearSystem, channels: &[Channel], blocks: &Blocks) -> Vec<Output> {
        let n = blocks.count();
        let of = |output: &system::Output| {
            let [p, v, a] = [0, 1, 2].map(|k| self.participation(&output.p[k]));
            let mut row: Vec<(u32, Ball)> = Vec::new();
            for i in 0..n {
                let s = Ball::exact(self.s[i]);
                let along = p[i] / s - a[i] * Ball::exact(self.back[i]);
                row.push((2 * i as u32, along));
                row.push((2 * i as u32 + 1, v[i] - a[i] * Ball::exact(self.modes.c[i])));
            }
            row.retain(|(_, factor)| !factor.is_zero());
            let own = |force: &Vec<[Ball; 2]>| a.iter().zip(force).fold(Ball::ZERO, |sum, (&a, &[_, b])| sum + a * b);
            let mut sources: Vec<Ball> = blocks.force.iter().map(own).collect();
            feed_through(output, channels, &blocks.scale, &mut sources);
            let accelerations = a.iter().map(|a| a.magnitude().power(2)).sum::<f64>().sqrt() * UP;
            Output::of(row, sources, accelerations)
        };
        system.outputs.iter().map(of).collect()
    }
}

/// Adds what sources add to an output directly, by their states.
pub fn feed_through(output: &system::Output, channels: &[Channel], scale: &[f64], sources: &mut [Ball]) {
    for channel in channels {
        for (d, derivative) in output.d.iter().zip(derivatives(&channel.source)) {
            for (_, value) in d.iter().filter(|(input, _)| *input as usize == channel.input) {
                for (k, factor) in &derivative {
                    let index = channel.first + k;
                    sources[index] = sources[index] + value.to_ball() * *factor * Ball::from(scale[index]);
                }
            }
        }
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
pub const MANY_TURNS: f64 = 1e6;

impl Output {
    pub fn of(row: Vec<(u32, Ball)>, sources: Vec<Ball>, acceleration: f64) -> Output {
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
