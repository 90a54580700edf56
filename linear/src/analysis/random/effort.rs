//! The effort that searches and integrals without success may take, for all outputs together, so that a report does not
//! take the limit for each.

use std::cell::Cell;

/// Each may take half of what is left; a successful one takes nothing from it.
pub struct Effort(Cell<usize>);

impl Effort {
    pub fn of(first: usize) -> Effort {
        Effort(Cell::new(2 * first))
    }

    /// The effort that the next one may take.
    pub fn limit(&self) -> usize {
        self.0.get() / 2
    }

    pub fn record_failure(&self, spent: usize) {
        self.0.set(self.0.get().saturating_sub(spent));
    }
}
