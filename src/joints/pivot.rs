//! A pivot: the two parts share a point and turn about it (about z in planar scenes).

use super::Relative;
use crate::base::Vec3;

pub fn freedoms(at: &Vec3) -> Relative {
    Relative { anchor: Some(at.clone()), turns: true, slide: None }
}
