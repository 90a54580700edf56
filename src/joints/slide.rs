//! A slide: the carried part moves along a direction fixed to the other and does not rotate relative to it.

use super::Kind;
use crate::base::Manual;

pub const KIND: Kind = Kind {
    keyword: "slide",
    form: "slide g: arm -- slug along (1, 0)",
    manual: Manual {
        forms: "slide g: arm -- slug along (1, 0)",
        summary: "A prismatic joint: the second part slides on the first along one direction and does not rotate relative to it.",
        rules: "The direction is fixed to the first part and is given as drawn. A slide that closes a loop becomes a constraint.",
        heading: "Joints",
    },
    synonyms: &["slider", "prismatic"],
    turns: false,
    slides: true,
};
