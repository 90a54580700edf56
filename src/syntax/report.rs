//! The errors of a file: the first ones are kept, the others only counted. See spec.md#limits.

use super::error::SyntaxError;
use super::limits;
use crate::base::{Diagnostics, Span};

#[derive(Debug, Default)]
pub(super) struct Report {
    reported: Vec<SyntaxError>,
    /// The first further error, and how many there are.
    more: Option<(Span, usize)>,
}

impl Report {
    pub fn push_error(&mut self, error: SyntaxError) {
        if self.is_full() {
            self.count(error.at());
        } else {
            self.reported.push(error);
        }
    }

    /// Counts an error that is not reported, since there are enough.
    pub fn count(&mut self, at: Span) {
        let (_, count) = self.more.get_or_insert((at, 0));
        *count += 1;
    }

    /// Whether further errors are only counted, so that no message has to be composed for them.
    pub fn is_full(&self) -> bool {
        self.reported.len() >= limits::ERRORS
    }

    pub fn finish(mut self) -> Diagnostics {
        self.reported.extend(self.more.map(|(at, count)| SyntaxError::More { at, count }));
        let mut diagnostics = Diagnostics::new();
        diagnostics.extend(self.reported.iter().map(SyntaxError::to_diagnostic));
        diagnostics
    }
}
