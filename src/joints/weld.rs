//! A weld: the two parts move as one.

use super::Relative;

pub fn freedoms() -> Relative {
    Relative { anchor: None, turns: false, slide: None }
}
