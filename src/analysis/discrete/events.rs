//! What happens between samples, as changes of all states at the next sample: a signal that comes on, a blow. In: the events of
//! the signals, the blocks and their cells. Out: changes in numbers of the target. Clause: spec.md, "Simulation code".

use crate::analysis::discrete::Event;
use crate::analysis::discrete::block::{Block, product};
use crate::analysis::discrete::cell::{Cell, Made, MadeSignal};
use crate::analysis::discrete::hold::{exponential, moved};
use crate::analysis::discrete::precision::Precision;
use crate::analysis::discrete::signals::{Change, Signals};
use crate::analysis::numeric::dense::Matrix;
use crate::base::Dd;

/// The changes, by the step before which they are made: states of signals first, then of the blocks.
pub fn changes(
    signals: &Signals,
    blocks: &[Block],
    made_signals: &[MadeSignal],
    made: &[Made],
    h: Dd,
) -> Option<Vec<(u64, Vec<Dd>)>> {
    let mut changes: Vec<(u64, Vec<Dd>)> = Vec::new();
    for event in &signals.events {
        let mut change = Vec::new();
        let before = event.before;
        for (i, signal) in made_signals.iter().enumerate() {
            let chain = &signals.chains[i];
            match &event.change {
                Change::Chain(of, jump) if *of == i => {
                    let later = exponential(chain.generator.map(|x| x * before))?;
                    change.extend(image(&signal.s, &image(&later, jump)));
                }
                _ => change.extend(vec![Dd::ZERO; chain.size()]),
            }
        }
        for (block, made) in blocks.iter().zip(made) {
            let own = match &event.change {
                Change::Chain(of, jump) => image(&signals.chains[*of].on(block, before, h)?, jump),
                Change::Blow(input, value) => {
                    let blow: Vec<Dd> = block.b.column(*input).iter().map(|&b| b * *value).collect();
                    moved(&block.a, &blow, before * h)?
                }
            };
            change.extend(image(&made.s, &own));
        }
        match changes.last_mut() {
            Some((tick, sum)) if *tick == event.tick => sum.iter_mut().zip(change).for_each(|(sum, x)| *sum += x),
            _ => changes.push((event.tick, change)),
        }
    }
    Some(changes)
}

fn image(m: &Matrix<Dd>, x: &[Dd]) -> Vec<Dd> {
    product(m, &Matrix::from_fn(x.len(), 1, |i, _| x[i])).column(0).to_vec()
}

/// The changes after the first step; those before it are part of the start.
pub fn after_start(changes: Vec<(u64, Vec<Dd>)>, cells: &mut [Cell], precision: Precision) -> Vec<Event> {
    let mut events = Vec::new();
    for (tick, change) in changes {
        let change: Vec<f64> = change.into_iter().map(|x| precision.round(x)).collect();
        if tick > 0 {
            if change.iter().any(|x| *x != 0.0) {
                events.push(Event { tick, change });
            }
            continue;
        }
        let states = cells.iter_mut().flat_map(|cell| &mut cell.start);
        states.zip(change).for_each(|(state, change)| *state = precision.round(Dd::new(*state, change)));
    }
    events
}
