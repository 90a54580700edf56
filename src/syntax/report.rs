//! The errors of a file: the first ones told, the others counted. See spec.md#limits.

use super::error::SyntaxError;
use super::limits;
use crate::base::{Diagnostics, Span};

#[derive(Debug, Default)]
pub(super) struct Report {
    told: Vec<SyntaxError>,
    /// How many more there are, and where the first of them is.
    more: Option<(Span, usize)>,
}

impl Report {
    pub fn tell(&mut self, error: SyntaxError) {
        if self.is_full() {
            self.count(error.at());
        } else {
            self.told.push(error);
        }
    }

    /// An error that is not told, since there are enough.
    pub fn count(&mut self, at: Span) {
        let (_, count) = self.more.get_or_insert((at, 0));
        *count += 1;
    }

    /// Errors from now on are counted: no need to find words for them.
    pub fn is_full(&self) -> bool {
        self.told.len() >= limits::ERRORS
    }

    pub fn finish(mut self) -> Diagnostics {
        self.told.extend(self.more.map(|(at, count)| SyntaxError::More { at, count }));
        let mut diagnostics = Diagnostics::new();
        diagnostics.extend(self.told.iter().map(SyntaxError::to_diagnostic));
        diagnostics
    }
}
