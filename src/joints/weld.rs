//! A weld: the two parts move as one.

use super::Relative;

pub fn freedoms() -> Relative {
    Relative { holds_point: false, turns: false, slide: None }
}
