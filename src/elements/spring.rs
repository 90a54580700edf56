//! A spring: tension T = T0 + k e of a stretch e, energy V = T0 e + k e^2 / 2; or a law T(e), energy its integral, k = T'(e).
//!
//! grad V = T grad e; grad^2 V = k (grad e)(grad e)^T + T grad^2 e. With grad e = d / |d|, the first is the square
//! (k / |d|^2) (d . delta)^2. See docs/method/linearisation.md.

use super::kind::{ALONG, Acts, Kind, Negative, Order};
use super::{Curve, Scalar, Stretch, Stretched};
use crate::base::{Code, Dimension, Expected, Field, Manual, Takes};
use std::sync::Arc;

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
                spring is unstretched as drawn. A negative stiffness is allowed and noted.\n\n\
                `loss` is its loss factor: in harmonic motion its stiffness is k (1 + i loss). Motions in time are not \
                computed with it.\n\n\
                `law` gives the tension over the `stretch` in place of `k` and `preload`; motions about the rest use its tangent.",
        heading: "Springs and dampers",
    },
    synonyms: &[],
    fields: &[
        Field::by_motion(
            "k",
            Expected::new("a stiffness", Dimension::STIFFNESS, "k = 10 N/m"),
            Expected::new("a stiffness", Dimension::TORSIONAL_STIFFNESS, "k = 10 N/m"),
            "The stiffness, N/m; in N*m/rad the spring is torsional.",
        ),
        ALONG,
        Field::by_motion(
            "free_length",
            Expected::new("a length", Dimension::LENGTH, "free_length = 0.5 m"),
            Expected::new("an angle", Dimension::NONE, "free_length = 30 deg"),
            "Its length without tension.",
        ),
        Field::by_motion(
            "preload",
            Expected::new("a force", Dimension::FORCE, "preload = 20 N"),
            Expected::new("a torque", Dimension::TORQUE, "preload = 2 N*m"),
            "Its tension as drawn; pull is positive.",
        ),
        LOSS,
        LAW,
    ],
    units: ["N/m", "N*m/rad"],
    order: Order::Displacement,
    negative: Negative::Noted(
        Code::model("vib::spring::negative"),
        "this stiffness is negative: it pushes away from the rest",
    ),
    acts: Acts::BetweenEnds,
};

/// The loss factor.
pub const LOSS: Field = Field::number(
    "loss",
    Expected::new("a loss factor", Dimension::NONE, "loss = 0.1"),
    "Its loss factor: in harmonic motion its stiffness is k (1 + i loss).",
);

const LAW: Field = Field::new(
    "law",
    Takes::Law("stretch"),
    "law = 10 N/m * stretch + 2e5 N/m^3 * stretch^3",
    "Its tension over its `stretch`, in place of a stiffness: an expression, or a table.",
);

#[derive(Clone, Debug)]
pub struct Spring<S> {
    pub stretch: Stretch<S>,
    pub response: Response<S>,
}

/// The tension of a spring over its stretch; pull is positive.
#[derive(Clone, Debug)]
pub enum Response<S> {
    Linear {
        /// N/m or N m/rad.
        stiffness: S,
        /// Tension as drawn, N or N m.
        preload: S,
    },
    Curve {
        curve: Arc<Curve>,
        /// The stretch of the law as drawn: the drawn length beyond the free length, m or rad.
        offset: S,
    },
}

impl<S: Scalar> Spring<S> {
    pub fn tension(&self, state: &Stretched<S>) -> S {
        match &self.response {
            Response::Linear { stiffness, preload } => preload.plus(&stiffness.times(state.change())),
            Response::Curve { curve, offset } => curve.of(&offset.plus(state.change())).0,
        }
    }

    /// The derivative of the tension by the stretch.
    pub fn stiffness(&self, state: &Stretched<S>) -> S {
        match &self.response {
            Response::Linear { stiffness, .. } => stiffness.clone(),
            Response::Curve { curve, offset } => curve.of(&offset.plus(state.change())).1,
        }
    }

    /// Beside that of the drawing. Of a curve only a search knows it.
    pub fn energy(&self, state: &Stretched<S>) -> S {
        let e = state.change();
        match &self.response {
            Response::Linear { stiffness, preload } => {
                let half = S::one().over(&S::one().plus(&S::one()));
                e.times(&preload.plus(&stiffness.times(e).times(&half)))
            }
            Response::Curve { curve, offset } => {
                let offset = offset.to_f64();
                S::integral(|change| curve.of(&(offset + change)).0, e)
            }
        }
    }

    /// This spring, converted to other numbers.
    pub fn convert<T: Scalar>(&self, stretch: Stretch<T>, number: impl Fn(&S) -> T) -> Spring<T> {
        let response = match &self.response {
            Response::Linear { stiffness, preload } => {
                Response::Linear { stiffness: number(stiffness), preload: number(preload) }
            }
            Response::Curve { curve, offset } => Response::Curve { curve: curve.clone(), offset: number(offset) },
        };
        Spring { stretch, response }
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
            response: Response::Linear { stiffness: 30.0, preload: 5.0 },
        };
        let at = |x: f64| spring.stretch.at(&Vector { x, y: 0.0, z: 0.0 }, &0.0);
        let h = 1e-6;
        let slope = (spring.energy(&at(0.5 + h)) - spring.energy(&at(0.5 - h))) / (2.0 * h);
        // The energy is quadratic, so the only error is rounding, eps V / h.
        assert!((slope - spring.tension(&at(0.5))).abs() < 1e-8);
        assert_eq!(spring.tension(&at(0.5)), 20.0);
    }
}
