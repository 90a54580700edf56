//! A weld: the two parts move as one.

use super::{Displacement, Held, Relative};

pub fn freedoms() -> Relative {
    Relative { holds_point: false, turns: false, slide: None }
}

pub fn held() -> Held {
    Held { displacement: Displacement::All, turn: true }
}
