//! A slide: the carried part moves along a direction fixed to the other and does not turn against it.

use super::{Displacement, Held, Relative};
use crate::base::Vec3;

pub fn freedoms(along: &Vec3) -> Relative {
    Relative { holds_point: false, turns: false, slide: Some(along.clone()) }
}

pub fn held(along: &Vec3) -> Held {
    Held { displacement: Displacement::Across(along.clone()), turn: true }
}
