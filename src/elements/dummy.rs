//! A damper under another name, for unit tests only. `kinds` takes it through every stage, which reveals any place that
//! names kinds by hand.

use super::kind::{ALONG, Acts, Kind, Negative, Order};
use crate::base::{Dimension, Expected, Field, Manual};

pub const KIND: Kind = Kind {
    keyword: "gadget",
    noun: "a gadget",
    plural: "gadgets",
    form: "gadget g: ground -- block { grip = 4 N*s/m }",
    manual: Manual {
        forms: "gadget g: ground -- block { grip = 4 N*s/m }",
        summary: "A gadget between two parts.",
        rules: "It stands for the next kind of element.",
        heading: "Springs and dampers",
    },
    synonyms: &["gizmo"],
    fields: &[
        Field::by_motion(
            "grip",
            Expected::new("a grip", Dimension::DAMPING, "grip = 4 N*s/m"),
            Expected::new("a grip", Dimension::TORSIONAL_DAMPING, "grip = 4 N*m*s/rad"),
            "How much it grips.",
        ),
        ALONG,
    ],
    units: ["N*s/m", "N*m*s/rad"],
    order: Order::Velocity,
    negative: Negative::Refused,
    acts: Acts::BetweenEnds,
};
