//! A damper: force c de/dt of a stretch e. It exerts no force at rest, so it adds C = c (grad e)(grad e)^T and no
//! stiffness. See docs/method/linearisation.md.

use super::kind::{ALONG, Acts, Kind, Negative, Order};
use crate::base::{Code, Dimension, Expected, Field, Manual, Takes};

const LAW: Field = Field::new(
    "law",
    Takes::Law("rate"),
    "law = 3 N*s/m * rate + 1 N*s^2/m^2 * rate * abs(rate)",
    "Its force over the `rate` of its stretch, in place of a coefficient: an expression, or a table.",
);

pub const KIND: Kind = Kind {
    keyword: "damper",
    noun: "a damper",
    plural: "dampers",
    form: "damper d: ground -- block { c = 5 N*s/m }",
    manual: Manual {
        forms: "damper d: ground -- block { c = 5 N*s/m }\ndamper t: ground -- rod { c = 2 N*m*s/rad }",
        summary: "A viscous damper between two parts; torsional if its coefficient is in N*m*s/rad.",
        rules: "It acts in the fixed direction `along = x`, if that is given. Otherwise it acts on the line between its ends where \
                they have different known places, and otherwise along the one line on which both parts can move.\n\n\
                `law` gives the force over the `rate` in place of `c`; motions about the rest use its tangent at zero.",
        heading: "Springs and dampers",
    },
    synonyms: &["dashpot"],
    fields: &[
        Field::by_motion(
            "c",
            Expected::new("a damping coefficient", Dimension::DAMPING, "c = 5 N*s/m"),
            Expected::new("a damping coefficient", Dimension::TORSIONAL_DAMPING, "c = 5 N*s/m"),
            "The damping coefficient, N*s/m; in N*m*s/rad the damper is torsional.",
        ),
        ALONG,
        LAW,
    ],
    units: ["N*s/m", "N*m*s/rad"],
    order: Order::Velocity,
    negative: Negative::Noted(Code::model("vib::damper::negative"), "this damping is negative: it adds energy"),
    acts: Acts::BetweenEnds,
};
