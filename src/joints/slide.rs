//! A slide: the carried part moves along a direction fixed to the other and does not turn against it.

use super::Relative;
use crate::base::Vec3;

pub fn freedoms(along: &Vec3) -> Relative {
    Relative { holds_point: false, turns: false, slide: Some(along.clone()) }
}
