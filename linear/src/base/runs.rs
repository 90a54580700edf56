//! Records which stages run on this thread, so that tests can check that no stage runs twice for one answer. Nothing is recorded
//! unless a test asks for it.

use std::cell::RefCell;

thread_local! {
    static RUNS: RefCell<Option<Vec<&'static str>>> = const { RefCell::new(None) };
}

/// Records that a stage begins.
pub fn begins(stage: &'static str) {
    RUNS.with_borrow_mut(|runs| runs.iter_mut().for_each(|runs| runs.push(stage)));
}

/// The stages that begin on this thread while a function runs, in order.
pub fn stages_of(run: impl FnOnce()) -> Vec<&'static str> {
    RUNS.set(Some(Vec::new()));
    run();
    RUNS.take().unwrap_or_default()
}
