//! How often the stages ran on this thread: unit tests count that no stage runs twice for one answer. Outside of unit tests
//! nothing is counted.

#[cfg(test)]
use std::cell::RefCell;

#[cfg(test)]
thread_local! {
    static RUNS: RefCell<Vec<&'static str>> = const { RefCell::new(Vec::new()) };
}

/// Notes that a stage begins.
#[inline]
pub fn begins(stage: &'static str) {
    #[cfg(test)]
    RUNS.with_borrow_mut(|runs| runs.push(stage));
    #[cfg(not(test))]
    let _ = stage;
}

/// The stages that began on this thread in the meantime, in their order.
#[cfg(test)]
pub fn during(run: impl FnOnce()) -> Vec<&'static str> {
    RUNS.with_borrow_mut(Vec::clear);
    run();
    RUNS.with_borrow_mut(std::mem::take)
}
