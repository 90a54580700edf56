//! The manual's entry for a declaration, a kind of element or a kind of joint.

#[derive(Clone, Copy, Debug)]
pub struct Manual {
    /// Examples, one per line.
    pub forms: &'static str,
    /// The declaration's meaning, in one sentence.
    pub summary: &'static str,
    /// Its rules, as Markdown paragraphs.
    pub rules: &'static str,
    /// The heading of `spec.md` under which it is described in full.
    pub heading: &'static str,
}
