//! A pivot: the two parts share a point and turn about it (about z in planar scenes).

use super::{Displacement, Held, Relative};

pub fn freedoms() -> Relative {
    Relative { holds_point: true, turns: true, slide: None }
}

pub fn held() -> Held {
    Held { displacement: Displacement::All, turn: false }
}
