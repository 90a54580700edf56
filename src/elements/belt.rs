//! A belt round two disks: two elastic spans along the common tangents, each with the energy T0 e + k e^2 / 2 of its own
//! stretch ([`Span`](super::stretch::Stretch)). It does not slip. See docs/method/linearisation.md#belts.

use super::kind::{Acts, Kind, Negative, Order};
use crate::base::{Code, Dimension, Expected, Field, Manual, Takes};

pub const KIND: Kind = Kind {
    keyword: "belt",
    noun: "a belt",
    plural: "belts",
    form: "belt r: motor -- pump { k = 200 kN/m }",
    manual: Manual {
        forms: "belt r: motor -- pump { k = 200 kN/m }\nbelt r: motor -- pump { k = 200 kN/m, preload = 80 N, crossed }",
        summary: "A belt round two disks, along their common tangents. It stretches and does not slip.",
        rules: "`k` is the stiffness of each of its two spans, and `preload` the tension of each as drawn. `crossed` makes the disks \
                turn against each other. The disks may move.\n\n\
                A span is taken to be tight: give a preload that keeps it so. One that pushes at rest is a warning.",
        heading: "Belts",
    },
    synonyms: &["chain_drive", "timing_belt"],
    fields: &[
        Field::number(
            "k",
            Expected::new("a stiffness", Dimension::STIFFNESS, "k = 200 kN/m"),
            "The stiffness of each of its two spans, N/m.",
        ),
        Field::number(
            "preload",
            Expected::new("a force", Dimension::FORCE, "preload = 80 N"),
            "The tension of each span as drawn.",
        ),
        Field::new("crossed", Takes::Nothing, "crossed", "It crosses, so that the disks turn against each other."),
    ],
    units: ["N/m", "N/m"],
    order: Order::Displacement,
    negative: Negative::Noted(
        Code::model("vib::spring::negative"),
        "this stiffness is negative: it pushes away from the rest",
    ),
    acts: Acts::RoundDisks,
};
