//! The description of a kind of joint: its words, and the degrees of freedom that it leaves between the two parts it
//! connects. See spec.md and docs/method/kinematics.md.

/// A kind of joint.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    pub keyword: &'static str,
    /// An example of a declaration.
    pub form: &'static str,
    /// More examples, one per line.
    pub forms: &'static str,
    /// What it declares, in one sentence.
    pub summary: &'static str,
    /// Its rules, as Markdown paragraphs.
    pub rules: &'static str,
    /// The heading of `spec.md` under which it is described in full.
    pub heading: &'static str,
    /// What other programs and textbooks call it.
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
