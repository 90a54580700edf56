//! The description of a kind of joint: its words, and the degrees of freedom that it leaves between the two parts it
//! connects. See spec.md and docs/method/kinematics.md.

use crate::base::Manual;

/// A kind of joint.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    pub keyword: &'static str,
    /// An example of a declaration.
    pub form: &'static str,
    pub manual: Manual,
    /// Its names in other programs and textbooks.
    pub synonyms: &'static [&'static str],
    /// Whether the relative rotation is left free.
    pub turns: bool,
    /// Whether the parts slide along each other: then a direction follows the ends, `along (1, 0)`.
    pub slides: bool,
}

impl Kind {
    /// Whether the two parts move as one.
    pub fn is_rigid(&self) -> bool {
        !self.turns && !self.slides
    }
}

impl PartialEq for Kind {
    /// Each keyword has one kind.
    fn eq(&self, other: &Kind) -> bool {
        self.keyword == other.keyword
    }
}
