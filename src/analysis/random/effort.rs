//! What searches and integrals without success may cost, all outputs together: a report must not take the limit of each.

use std::cell::Cell;

/// Each may take half of what is left; what succeeds costs nothing of it.
pub struct Effort(Cell<usize>);

impl Effort {
    pub fn of(first: usize) -> Effort {
        Effort(Cell::new(2 * first))
    }

    /// What the next one may take.
    pub fn limit(&self) -> usize {
        self.0.get() / 2
    }

    pub fn failed(&self, spent: usize) {
        self.0.set(self.0.get().saturating_sub(spent));
    }
}
