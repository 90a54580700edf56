//! The entries of steps for eight frequencies side by side: of the short steps on which maxima are looked for, and of whole
//! pieces of the motion, which take one step each. See docs/method/shock.md#steps.

use super::course::{Course, LIGHT, TINY};
use super::oscillator::{Factorials, Step, double_step, step};
use crate::base::rounding::UNIT;
use crate::base::{Ball, up};
use crate::kernel::simd::{Eight, LANES};

/// A row of entries, one for each lane, in one line of the cache.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub struct Row(pub [f64; LANES]);

/// Rows of any step. From [`row::FORCING`] on there are two for each derivative of the acceleration, first for x and then for v;
/// those of [`short`] or [`whole`] follow.
pub mod row {
    pub const A11: usize = 0;
    pub const A12: usize = 1;
    pub const A22: usize = 2;
    /// Factor of the error.
    pub const DECAY: usize = 3;
    pub const FORCING: usize = 4;
}

/// Further rows of a short step.
pub mod short {
    pub const THETA: usize = 0;
    /// Factors in the bound of how far the motion leaves a parabola: of |a'|, |a|, and the size of the state.
    pub const BENT: usize = 1;
    pub const DRIVEN: usize = 2;
    pub const OWN: usize = 3;
    /// The length in each lane.
    pub const LENGTH: usize = 4;
    pub const COUNT: usize = 5;
}

/// Further rows of a whole piece: the motion that a line's acceleration a + a' t leaves at rest on is x = a / omega - 2 zeta a' / omega^2,
/// v = a' / omega^2.
pub mod whole {
    pub const RATE: usize = 0;
    pub const LAG: usize = 1;
    pub const SWAY: usize = 2;
    /// h / omega
    pub const RISE: usize = 3;
    /// Bound of the rounding of what is computed by these, over the largest |a|.
    pub const SLACK: usize = 4;
    pub const COUNT: usize = 5;
}

/// Rows for each length of the pieces.
pub struct Table {
    rows: Vec<Row>,
    /// Rows of any step, and all rows, of one length.
    common: usize,
    each: usize,
}

/// The entries of a group of up to eight frequencies.
pub struct Entries {
    /// Of the short steps of a piece, and how many there are, a power of two.
    pub short: Table,
    pub steps: Vec<f64>,
    /// Of whole pieces.
    pub whole: Table,
}

impl Table {
    fn new(classes: usize, terms: usize, more: usize) -> Table {
        let common = row::FORCING + 2 * terms;
        Table { rows: vec![Row([0.0; LANES]); classes * (common + more)], common, each: common + more }
    }

    /// The rows that any step has, and the further ones.
    #[inline(always)]
    pub fn of(&self, class: u32) -> (&[Row], &[Row]) {
        self.rows[class as usize * self.each..][..self.each].split_at(self.common)
    }

    fn of_mut(&mut self, class: usize) -> (&mut [Row], &mut [Row]) {
        self.rows[class * self.each..][..self.each].split_at_mut(self.common)
    }
}

impl Entries {
    pub fn of(course: &Course, damping: Ball, group: &[Ball], factorials: &Factorials) -> Entries {
        let fastest = group.iter().map(Ball::magnitude).fold(0.0, f64::max) * (2.0 * damping.magnitude()).max(1.0);
        let (classes, terms) = (course.classes(), course.terms);
        let mut entries = Entries {
            short: Table::new(classes, terms, short::COUNT),
            steps: (0..classes).map(|class| course.steps(class, fastest)).collect(),
            whole: Table::new(classes, terms, whole::COUNT),
        };
        for lane in 0..LANES {
            // Lanes that are left over repeat the last frequency.
            let omega = group[lane.min(group.len() - 1)];
            for class in 0..classes {
                let (mut length, mut count) = (course.length(class, entries.steps[class]), entries.steps[class]);
                let mut own = step(omega, damping, length, terms, factorials);
                put_short(entries.short.of_mut(class), lane, &own, [omega, damping, length]);
                while count > 1.0 {
                    own = double_step(&own, length, factorials);
                    (length, count) = (length * Ball::from(2.0), 0.5 * count);
                }
                put_whole(entries.whole.of_mut(class), lane, &own, [omega, damping, length]);
            }
        }
        entries
    }
}

fn put_short((rows, more): (&mut [Row], &mut [Row]), lane: usize, step: &Step, [omega, damping, h]: [Ball; 3]) {
    let theta = omega * h;
    put(rows, lane, step, damping, theta);
    let (long, length, zeta) = (theta.magnitude(), h.magnitude(), damping.magnitude());
    let (bent, curved) = (long / 12.0, 1.0 + 2.0 * zeta + 4.0 * zeta * zeta);
    more[short::THETA].0[lane] = theta.mid.hi;
    more[short::BENT].0[lane] = bent * length * length * up::DOZENS;
    more[short::DRIVEN].0[lane] = length * (bent * long * (2.0 * zeta + long * curved) + 32.0 * UNIT) * up::DOZENS;
    more[short::OWN].0[lane] = (bent * long * long * curved + 32.0 * UNIT) * up::DOZENS;
    more[short::LENGTH].0[lane] = length;
}

fn put_whole((rows, more): (&mut [Row], &mut [Row]), lane: usize, step: &Step, [omega, damping, h]: [Ball; 3]) {
    let theta = omega * h;
    put(rows, lane, step, damping, theta);
    let rate = Ball::ONE / omega;
    let sway = rate.square();
    let parts = rate.magnitude() * (2.0 + (1.0 + 2.0 * damping.magnitude()) / theta.mignitude());
    more[whole::RATE].0[lane] = rate.mid.hi;
    more[whole::LAG].0[lane] = -2.0 * (damping * sway).mid.hi;
    more[whole::SWAY].0[lane] = sway.mid.hi;
    more[whole::RISE].0[lane] = (h * rate).mid.hi;
    more[whole::SLACK].0[lane] = 16.0 * UNIT * parts * up::DOZENS + TINY;
}

/// The rows that both kinds of steps have.
fn put(rows: &mut [Row], lane: usize, step: &Step, damping: Ball, theta: Ball) {
    let Step { own, forcing } = step;
    rows[row::A11].0[lane] = own[0].mid.hi;
    rows[row::A12].0[lane] = own[1].mid.hi;
    rows[row::A22].0[lane] = own[2].mid.hi;
    let is_light = damping.magnitude() <= LIGHT;
    rows[row::DECAY].0[lane] = if is_light { decay((damping * theta).mignitude()) } else { 1.0 };
    for (k, (x, v)) in forcing.iter().enumerate() {
        rows[row::FORCING + 2 * k].0[lane] = x.mid.hi;
        rows[row::FORCING + 2 * k + 1].0[lane] = v.mid.hi;
    }
}

/// A bound of exp(-z), z >= 0: exp(-z) = exp(-z / 2^k)^(2^k), and below 1 its series cut after a positive term is above it.
fn decay(z: f64) -> f64 {
    let (mut z, mut squarings) = (z.min(700.0), 0);
    while z > 0.25 {
        (z, squarings) = (0.5 * z, squarings + 1);
    }
    let series = 1.0 - z * (1.0 - z / 2.0 * (1.0 - z / 3.0 * (1.0 - z / 4.0 * (1.0 - z / 5.0 * (1.0 - z / 6.0)))));
    let once = (series * up::FEW).min(1.0);
    (0..squarings).fold(once, |decay, _| decay * decay * up::FEW)
}

/// The state after a step with the derivatives of the acceleration: the first two, and all others.
#[inline(always)]
pub fn state_after<V: Eight>(rows: &[Row], line: [f64; 2], bends: &[f64], [x, v]: [V; 2]) -> [V; 2] {
    let [a11, a12, a22, _, f0, g0, f1, g1, others @ ..] = rows else { return [x, v] };
    let (d0, d1) = (V::splat(line[0]), V::splat(line[1]));
    let mut x1 = V::load(&f1.0).mul_add(d1, V::load(&f0.0) * d0);
    let mut v1 = V::load(&g1.0).mul_add(d1, V::load(&g0.0) * d0);
    // By slice patterns: an iterator over pairs is not inlined across codegen units, and its call takes as long as all the rest.
    let mut others = others;
    for &d in bends {
        let [f, g, rest @ ..] = others else { break };
        let d = V::splat(d);
        x1 = V::load(&f.0).mul_add(d, x1);
        v1 = V::load(&g.0).mul_add(d, v1);
        others = rest;
    }
    let (a11, a12, a22) = (V::load(&a11.0), V::load(&a12.0), V::load(&a22.0));
    [a11.mul_add(x, a12.mul_add(v, x1)), a22.mul_add(v, (-a12).mul_add(x, v1))]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Near one, far below it, and beside the platform's own exponential.
    #[test]
    fn a_decay_is_bounded_from_above_and_closely() {
        for z in [0.0, 1e-18, 1e-9, 1e-3, 0.2, 0.25, 0.26, 1.0, 7.5, 100.0, 690.0] {
            let (bound, true_one) = (decay(z), libm::exp(-z));
            assert!(bound >= true_one * (1.0 - 1e-15) && bound <= true_one * (1.0 + 1e-5), "{z}: {bound} {true_one}");
        }
        assert!(decay(1e9) > 0.0);
    }
}
