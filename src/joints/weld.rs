//! A weld: the two parts move as one.

use super::Kind;
use crate::base::Manual;

pub const KIND: Kind = Kind {
    keyword: "weld",
    form: "weld w: block -- box",
    manual: Manual {
        forms: "weld w: block -- box",
        summary: "Fixes two parts to each other, as drawn.",
        rules: "If both ends name a point, the points must coincide. A weld that closes a loop becomes a constraint.",
        heading: "Joints",
    },
    synonyms: &["fixed"],
    turns: false,
    slides: false,
};
