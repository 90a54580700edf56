//! Counts the runs of the stages on this thread, so that unit tests can check that no stage runs twice for one answer. Outside unit tests
//! nothing is counted.

#[cfg(test)]
use std::cell::RefCell;

#[cfg(test)]
thread_local! {
    static RUNS: RefCell<Vec<&'static str>> = const { RefCell::new(Vec::new()) };
}

/// Records that a stage begins.
#[inline]
pub fn begins(stage: &'static str) {
    #[cfg(test)]
    RUNS.with_borrow_mut(|runs| runs.push(stage));
    #[cfg(not(test))]
    let _ = stage;
}

/// The stages that began on this thread meanwhile, in order.
#[cfg(test)]
pub fn stages_of(run: impl FnOnce()) -> Vec<&'static str> {
    RUNS.with_borrow_mut(Vec::clear);
    run();
    RUNS.with_borrow_mut(std::mem::take)
}
