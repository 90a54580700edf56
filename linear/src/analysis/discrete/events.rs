//! Changes between samples: the states of piecewise signals are set at the next sample, and the states of the blocks
//! are corrected for a signal that changed, or an impulse that acted, during the step. In: the signals, the blocks and
//! their cells. Out: changes in numbers of the target. See docs/method/emit.md.

use crate::analysis::discrete::Event;
use crate::analysis::discrete::block::{Block, product};
use crate::analysis::discrete::cell::{Made, MadeSignal};
use crate::analysis::discrete::hold::propagate;
use crate::analysis::discrete::pieces::FeedThroughOrders;
use crate::analysis::discrete::pieces::MOST_EVENTS;
use crate::analysis::discrete::precision::Precision;
use crate::analysis::discrete::signals::Signals;
use crate::base::Dd;
use crate::kernel::dense::Matrix;
use std::collections::BTreeSet;

/// Why the events could not be computed.
pub enum Fault {
    TooMany { input: usize },
    OutOfRange,
}

/// The changes with the samples at which they are made: states of signals first, then those of the blocks.
pub fn changes(
    signals: &Signals,
    blocks: &[Block],
    made_signals: &[MadeSignal],
    made: &[Made],
    seen: impl Fn(usize) -> FeedThroughOrders,
    h: Dd,
) -> Result<Vec<(u64, Vec<Dd>)>, Fault> {
    let mut ticks: BTreeSet<u64> = signals.impulses.iter().map(|impulse| impulse.when.tick).collect();
    for chain in &signals.chains {
        ticks.extend(chain.ticks());
        if ticks.len() > MOST_EVENTS {
            return Err(Fault::TooMany { input: chain.input });
        }
    }
    if let Some(impulse) = signals.impulses.first().filter(|_| ticks.len() > MOST_EVENTS) {
        return Err(Fault::TooMany { input: impulse.input });
    }
    let change = |tick: u64| -> Option<Vec<Dd>> {
        let mut change = Vec::new();
        for (chain, signal) in signals.chains.iter().zip(made_signals) {
            change.extend(match signal.set {
                true => image(&signal.s, &chain.states_used(tick, seen(chain.input))),
                false => vec![Dd::ZERO; chain.size()],
            });
        }
        for (block, made) in blocks.iter().zip(made) {
            let mut own = vec![Dd::ZERO; block.size()];
            for chain in &signals.chains {
                let lacking = chain.correction(block, tick, seen(chain.input), h)?;
                own.iter_mut().zip(lacking).for_each(|(sum, x)| *sum += x);
            }
            for impulse in signals.impulses_at(tick) {
                let moment: Vec<Dd> = block.b.column(impulse.input).iter().map(|&b| b * impulse.value).collect();
                let moved = propagate(&block.a, &moment, impulse.when.before * h)?;
                own.iter_mut().zip(moved).for_each(|(sum, x)| *sum += x);
            }
            change.extend(image(&made.s, &own));
        }
        Some(change)
    };
    ticks.into_iter().map(|tick| Some((tick, change(tick)?))).collect::<Option<_>>().ok_or(Fault::OutOfRange)
}

fn image(m: &Matrix<Dd>, x: &[Dd]) -> Vec<Dd> {
    product(m, &Matrix::from_fn(x.len(), 1, |i, _| x[i])).column(0).to_vec()
}

/// The changes after the first sample, rounded and unrounded; those at the first sample are part of the start. `set`:
/// the states that are set instead of added to.
pub fn after_start(
    changes: Vec<(u64, Vec<Dd>)>,
    set: &[bool],
    start: &mut [Dd],
    precision: Precision,
) -> (Vec<Event>, Vec<Vec<Dd>>) {
    let mut events = (Vec::new(), Vec::new());
    for (tick, exact) in changes {
        if tick > 0 {
            let change: Vec<f64> = exact.iter().map(|&x| precision.round(x)).collect();
            if set.contains(&true) || change.iter().any(|x| *x != 0.0) {
                events.0.push(Event { tick, change });
                events.1.push(exact);
            }
            continue;
        }
        for ((state, change), set) in start.iter_mut().zip(exact).zip(set) {
            *state = if *set { change } else { *state + change };
        }
    }
    events
}
