//! A pivot: the two parts share a point and turn about it (about z in planar scenes).

use super::Kind;
use crate::base::Manual;

pub const KIND: Kind = Kind {
    keyword: "pivot",
    form: "pivot p: block@A -- rod",
    manual: Manual {
        forms: "pivot p: block@A -- rod",
        summary: "Pins two parts together: they share a point and turn freely about it.",
        rules: "One end names the point and the other end coincides there; if both ends name a point, or neither does, both \
                places must be known and equal. A pivot that closes a loop becomes a constraint, never a stiff spring.",
        heading: "Joints",
    },
    synonyms: &["hinge", "pin", "joint", "revolute"],
    turns: true,
    slides: false,
};
