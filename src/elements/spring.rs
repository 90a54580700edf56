//! A spring: tension T = T0 + k e of a stretch e, energy V = T0 e + k e^2 / 2.
//!
//! grad V = T grad e; grad^2 V = k (grad e)(grad e)^T + T grad^2 e. With grad e = d / |d|, the first is the square
//! (k / |d|^2) (d . delta)^2. See docs/method/linearisation.md.

use super::kind::{ALONG, Kind, Negative, Order};
use super::{Scalar, Stretch, Stretched};
use crate::base::{Code, Dimension, Expected, Field, Manual};

pub const KIND: Kind = Kind {
    keyword: "spring",
    noun: "a spring",
    plural: "springs",
    form: "spring s: ground -- block { k = 10 N/m }",
    manual: Manual {
        forms: "spring s: ground -- block { k = 10 N/m }\nspring t: ground -- rod { k = 3 N*m/rad }",
        summary: "A linear spring between two parts; torsional if its stiffness is in N*m/rad.",
        rules: "It acts in the fixed direction `along = x`, if that is given. Otherwise it acts on the line between its ends, with \
                the geometry of large displacements, where the ends have different known places; and otherwise along the one \
                line on which both parts can move.\n\n\
                `free_length` or `preload` (the tension as drawn, pull positive) may be given, not both. With neither the \
                spring is unstretched as drawn. A negative stiffness is allowed and noted.",
        heading: "Springs and dampers",
    },
    synonyms: &[],
    fields: &[
        Field::either(
            "k",
            Expected::new("a stiffness", Dimension::STIFFNESS, "k = 10 N/m"),
            Expected::new("a stiffness", Dimension::TORSIONAL_STIFFNESS, "k = 10 N/m"),
            "The stiffness, N/m; in N*m/rad the spring is torsional.",
        ),
        ALONG,
        Field::either(
            "free_length",
            Expected::new("a length", Dimension::LENGTH, "free_length = 0.5 m"),
            Expected::new("an angle", Dimension::NONE, "free_length = 30 deg"),
            "Its length without tension.",
        ),
        Field::either(
            "preload",
            Expected::new("a force", Dimension::FORCE, "preload = 20 N"),
            Expected::new("a torque", Dimension::TORQUE, "preload = 2 N*m"),
            "Its tension as drawn; pull is positive.",
        ),
    ],
    units: ["N/m", "N*m/rad"],
    order: Order::Displacement,
    negative: Negative::Noted(
        Code::model("vib::spring::negative"),
        "this stiffness is negative: it pushes away from the rest",
    ),
};

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
