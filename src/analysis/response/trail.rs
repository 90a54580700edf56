//! The bound of a state's error from step to step. In: what each step carries over and what it adds. Out: a bound that
//! decays where the motion does. See docs/method/response.md#matrix-exponential.
//!
//! One step's norm is hardly below one, however strong the damping: the energy of the least damped direction stays. The
//! norm of many steps at once is far below it, so the error at some step (the anchor) is carried by the norm of all steps
//! since then, and what these added themselves is kept apart.

use super::UP;

/// A bound of what a state is off by.
#[derive(Clone, Debug, Default)]
pub struct Trail {
    /// At present.
    pub error: f64,
    /// At the anchor.
    anchor: f64,
    /// What has come since the anchor.
    fresh: f64,
    /// Equal steps since the anchor.
    steps: usize,
}

impl Trail {
    /// After one more step, which carries an error over with the factor `own` and adds `local` to it.
    pub fn step(&mut self, own: f64, local: f64) {
        let local = if local > 0.0 || self.error > 0.0 { local + UNDERFLOW } else { 0.0 };
        self.error = (own * self.error + local) * UP;
        self.fresh = (own * self.fresh + local) * UP;
        self.steps += 1;
    }

    /// The state has become uncertain by so much more.
    pub fn add(&mut self, by: f64) {
        self.error = (self.error + by) * UP;
        self.fresh = (self.fresh + by) * UP;
    }

    /// Steps of another length, or of other sources, follow.
    pub fn turn(&mut self) {
        (self.anchor, self.fresh, self.steps) = (self.error, 0.0, 0);
    }

    /// Looks for decay after a power of two of steps; `bound(k)` is the norm of 2^k steps at once. Fewer than `least` are
    /// not worth the look.
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

/// What the sums of a step may lose below the least numbers of binary64: 400 rows of products, 2^-1074 each.
const UNDERFLOW: f64 = 1e-316;
const LEAST: usize = 16;
const WORTH_IT: f64 = 0.5;

#[cfg(test)]
mod tests {
    use super::*;

    /// A state that loses a hundredth of its size at each step, by a norm that does not see it.
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

    /// Errors of a step that nothing takes away: sixteen of them are sixteen times as large, whatever became of the anchor.
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
