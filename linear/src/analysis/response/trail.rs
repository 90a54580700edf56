//! The error bound of a state from step to step. In: the factor with which each step carries errors over, and the error
//! that it adds. Out: a bound that decays if the motion does. See docs/method/response.md#matrix-exponential.
//!
//! The norm of one step is hardly below one, however strong the damping: the energy of the least damped direction
//! remains. The norm of many steps together is far below it, so the error at some step (the anchor) is carried by the
//! norm of all steps since then, and the errors added since are kept separately.

use super::UP;

/// A bound of the error of a state.
#[derive(Clone, Debug, Default)]
pub struct Trail {
    /// The current bound.
    pub error: f64,
    /// The bound at the anchor.
    anchor: f64,
    /// Error added since the anchor.
    fresh: f64,
    /// Number of equal steps since the anchor.
    steps: usize,
}

impl Trail {
    /// Takes one more step, which carries an error over with the factor `own` and adds `local` to it.
    pub fn step(&mut self, own: f64, local: f64) {
        let local = if local > 0.0 || self.error > 0.0 { local + UNDERFLOW } else { 0.0 };
        self.error = (own * self.error + local) * UP;
        self.fresh = (own * self.fresh + local) * UP;
        self.steps += 1;
    }

    /// Adds to the uncertainty of the state.
    pub fn add(&mut self, by: f64) {
        self.error = (self.error + by) * UP;
        self.fresh = (self.fresh + by) * UP;
    }

    /// Begins a new anchor, because steps of another length, or with other sources, follow.
    pub fn turn(&mut self) {
        (self.anchor, self.fresh, self.steps) = (self.error, 0.0, 0);
    }

    /// Tests for decay after a number of steps that is a power of two; `bound(k)` is the norm of 2^k steps together.
    /// For fewer than `least` steps it is not evaluated.
    pub fn decay(&mut self, least: usize, bound: impl FnOnce(u32) -> f64) {
        if self.steps < least.max(LEAST) || !self.steps.is_power_of_two() {
            return;
        }
        let norm = bound(self.steps.trailing_zeros());
        if norm <= WORTH_IT {
            self.error = self.error.min((norm * self.anchor + self.fresh) * UP);
            self.turn();
        }
    }
}

/// Underflow error in the sums of a step: 400 rows of products, 2^-1074 each.
const UNDERFLOW: f64 = 1e-316;
const LEAST: usize = 16;
const WORTH_IT: f64 = 0.5;

#[cfg(test)]
mod tests {
    use super::*;

    /// A state that shrinks by a hundredth at each step, although its norm does not show it.
    #[test]
    fn an_error_decays_with_the_motion() {
        let mut trail = Trail::default();
        trail.add(1.0);
        trail.turn();
        for _ in 0..4096 {
            trail.step(1.0, 0.0);
            trail.decay(0, |k| 0.99f64.powi(1 << k));
        }
        // 0.99^4096 = 1.3e-18
        assert!(trail.error >= 0.99f64.powi(4096) && trail.error < 1e-17, "{:e}", trail.error);
        trail.step(1.0, 1e-3);
        assert!(trail.error >= 1e-3 && trail.error < 1.001e-3);
    }

    /// Errors that nothing reduces: those of sixteen steps add up to sixteen times as much, whatever happened to the
    /// anchor.
    #[test]
    fn errors_since_the_anchor_are_all_there() {
        let mut trail = Trail::default();
        trail.add(100.0);
        trail.turn();
        (0..16).for_each(|_| trail.step(1.0, 1.0));
        let mut other = trail.clone();
        trail.decay(0, |_| 0.1);
        assert!(trail.error >= 26.0 && trail.error < 26.001, "{}", trail.error);
        other.add(5.0);
        other.decay(0, |_| 0.1);
        assert!(other.error >= 31.0 && other.error < 31.001, "{}", other.error);
    }
}
