//! A system as independent blocks of two states, driven by sources: the data that the loops over steps need, and bounds
//! of what the
//! blocks leave out. The states are those of oscillators ([`super::oscillators`]) or of poles ([`super::poles`]).
//! See docs/method/response.md#modal-steps.

use crate::analysis::response::UP;
use crate::analysis::response::propagator::{Exogenous, scales};
use crate::base::{Ball, Dd, Power};
use crate::kernel::dense::Matrix;

/// z' = A_i z + B_i w for each block, w' = G w.
#[derive(Clone, Debug)]
pub struct Blocks {
    /// The A_i by rows.
    pub a: [Vec<Dd>; 4],
    /// The B_i by state of a source, then by block.
    pub force: Vec<Vec<[Ball; 2]>>,
    /// G
    generator: Vec<(usize, usize, Ball)>,
    /// Powers of two with w = W w~; all other fields refer to w~.
    pub scale: Vec<f64>,
    /// A bound of |[[A_i, B_i], [0, G]]| for every block, and of its error.
    pub norm: f64,
    pub radius: f64,
    /// A bound of |B| over all blocks.
    pub force_norm: f64,
    /// Bounds of the logarithmic norms of all A_i, and of G.
    pub rate: f64,
    pub rate_of_sources: f64,
    /// Bounds of the disturbances of z' for a state, and for a force, of norm one.
    pub defect: f64,
    pub force_defect: f64,
}

impl Blocks {
    /// Blocks without disturbances, which the caller adds if it knows them; `force` by state of a source, unscaled, and
    /// `rate` a bound of the logarithmic norms of the A_i.
    pub fn of(a: [Vec<Dd>; 4], mut force: Vec<Vec<[Ball; 2]>>, sources: &Exogenous, rate: f64) -> Blocks {
        let n = a[0].len();
        let scale = scales(&Matrix::from_fn(2 * n, sources.count, |i, j| force[j][i / 2][i % 2]), sources);
        for (force, &w) in force.iter_mut().zip(&scale) {
            force.iter_mut().flatten().for_each(|b| *b = *b * Ball::from(w));
        }
        let scaled = |&(i, j, value): &(usize, usize, Ball)| (i, j, value * Ball::from(scale[j] / scale[i]));
        let generator: Vec<(usize, usize, Ball)> = sources.generator.iter().map(scaled).collect();
        let sum = |values: &mut dyn Iterator<Item = f64>| values.map(|x| x * x).sum::<f64>();
        let entries = || force.iter().flatten().flatten();
        let forces: f64 = sum(&mut entries().map(Ball::magnitude));
        let radii: f64 = sum(&mut entries().map(|b| b.rad));
        let generator_size = sum(&mut generator.iter().map(|(_, _, value)| value.magnitude()));
        let generator_radii = sum(&mut generator.iter().map(|(_, _, value)| value.rad));
        let own = |i: usize| a.iter().map(|entries| entries[i].hi.power(2)).sum::<f64>();
        let largest_own = (0..n).map(own).fold(0.0, f64::max);
        Blocks {
            norm: (largest_own + forces + generator_size).sqrt() * UP,
            radius: (radii + generator_radii).sqrt() * UP,
            force_norm: forces.sqrt() * UP,
            rate,
            rate_of_sources: rate_of(&generator),
            defect: 0.0,
            force_defect: 0.0,
            a,
            force,
            generator,
            scale,
        }
    }

    pub fn count(&self) -> usize {
        self.a[0].len()
    }

    /// G restricted to the active states.
    pub fn generator_of(&self, on: &[usize]) -> Vec<(usize, usize, Dd)> {
        let place = |state: usize| on.iter().position(|&known| known == state);
        let entry = |&(i, j, value): &(usize, usize, Ball)| Some((place(i)?, place(j)?, value.mid));
        self.generator.iter().filter_map(entry).collect()
    }

    pub fn is_finite(&self) -> bool {
        self.norm.is_finite() && self.radius.is_finite() && self.defect.is_finite() && self.force_defect.is_finite()
    }
}

/// Upper bound of the 2-norm of (G + G^T) / 2. Harmonic sources are skew and add nothing; an integrator chain has one entry a row.
fn rate_of(generator: &[(usize, usize, Ball)]) -> f64 {
    let of = |&(i, j, value): &(usize, usize, Ball)| {
        let back = generator.iter().find(|&&(k, l, _)| (k, l) == (j, i));
        let sum = back.map_or(value, |&(_, _, back)| value + back);
        sum.magnitude() * 0.5
    };
    // Each row of the symmetric part has at most two entries.
    generator.iter().map(of).fold(0.0, f64::max) * 2.0 * UP
}
