//! An inerter: force b d2e/dt2 of a stretch e, energy b (de/dt)^2 / 2 (Smith, IEEE Trans. Automat. Control 47 (2002) 1648).
//!
//! With e(q), Lagrange's equations give b grad e (grad e . q'' + q'^T grad^2 e q'). At rest q' = 0: it exerts no force
//! and, to first order, adds M = b (grad e)(grad e)^T, with the gradient at that rest, and nothing to C and K. See
//! docs/method/linearisation.md.

use super::kind::{ALONG, Acts, Kind, Negative, Order};
use crate::base::{Dimension, Expected, Field, Manual};

pub const KIND: Kind = Kind {
    keyword: "inerter",
    noun: "an inerter",
    plural: "inerters",
    form: "inerter b: ground -- block { b = 20 kg }",
    manual: Manual {
        forms: "inerter b: ground -- block { b = 20 kg }\ninerter t: ground -- rod { b = 0.5 kg*m^2 }",
        summary: "An inerter between two parts: its force is proportional to the relative acceleration of its ends; \
                  torsional if its inertance is in kg*m^2.",
        rules: "It acts in the fixed direction `along = x`, if that is given. Otherwise it acts on the line between its ends where \
                they have different known places, and otherwise along the one line on which both parts can move.\n\n\
                It adds inertia to the motions that stretch it and no weight: gravity does not pull at it, and at rest it has \
                no force. Its inertance is not negative.",
        heading: "Springs and dampers",
    },
    synonyms: &["inertor", "flywheel"],
    fields: &[
        Field::by_motion(
            "b",
            Expected::new("an inertance", Dimension::MASS, "b = 20 kg"),
            Expected::new("an inertance", Dimension::INERTIA, "b = 0.5 kg*m^2"),
            "The inertance, kg; in kg*m^2 the inerter is torsional.",
        ),
        ALONG,
    ],
    units: ["kg", "kg*m^2"],
    order: Order::Acceleration,
    negative: Negative::Refused,
    acts: Acts::BetweenEnds,
};
