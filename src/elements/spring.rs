//! A spring: tension T = T0 + k e of a stretch e, energy V = T0 e + k e^2 / 2.
//!
//! grad V = T grad e; grad^2 V = k (grad e)(grad e)^T + T grad^2 e. With grad e = d / |d|, the first is the square
//! (k / |d|^2) (d . delta)^2. See docs/method/linearisation.md.

use super::{Scalar, Stretch, Stretched};

#[derive(Clone, Debug)]
pub struct Spring<S> {
    pub stretch: Stretch<S>,
    /// N/m or N m/rad.
    pub stiffness: S,
    /// Tension as drawn, N or N m; pull is positive.
    pub preload: S,
}

impl<S: Scalar> Spring<S> {
    pub fn tension(&self, state: &Stretched<S>) -> S {
        self.preload.plus(&self.stiffness.times(state.change()))
    }

    pub fn energy(&self, state: &Stretched<S>) -> S {
        let half = S::one().over(&S::one().plus(&S::one()));
        let e = state.change();
        e.times(&self.preload.plus(&self.stiffness.times(e).times(&half)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::Vector;

    #[test]
    fn tension_is_the_slope_of_the_energy() {
        let spring = Spring {
            stretch: Stretch::Line { drawn: Vector { x: 2.0, y: 0.0, z: 0.0 } },
            stiffness: 30.0,
            preload: 5.0,
        };
        let at = |x: f64| spring.stretch.at(&Vector { x, y: 0.0, z: 0.0 }, &0.0);
        let h = 1e-6;
        let slope = (spring.energy(&at(0.5 + h)) - spring.energy(&at(0.5 - h))) / (2.0 * h);
        // The energy is quadratic: only rounding is left, eps V / h.
        assert!((slope - spring.tension(&at(0.5))).abs() < 1e-8);
        assert_eq!(spring.tension(&at(0.5)), 20.0);
    }
}
