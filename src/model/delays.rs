//! `delayed(front, 0.1 s)`: the signal of another input, delayed. In: inputs, and the inputs that they delay. Out: the
//! same inputs with the delayed signals. See spec.md.

use super::Check;
use super::error::PartError;
use super::measures::dimension_of;
use super::scene::Signal;
use super::scope::Environment;
use crate::base::{Number, Span};
use crate::syntax::tree::ExprId;
use std::sync::Arc;

/// An input whose signal is that of another input, delayed.
#[derive(Debug)]
pub struct Delay {
    /// The input that has it.
    input: usize,
    /// The input that it names.
    source: ExprId,
    /// s
    by: Number,
    environment: Environment,
}

/// A delay as it is written, before its input has a number.
#[derive(Debug)]
pub struct Written {
    pub source: ExprId,
    pub by: Number,
}

impl<'a> Check<'a> {
    /// Notes that the input which comes next is delayed.
    pub fn delay_next_input(&mut self, written: Written, environment: Environment) {
        let Written { source, by } = written;
        self.delays.push(Delay { input: self.scene.inputs.len(), source, by, environment });
    }

    /// Gives every delayed input its signal.
    pub fn settle_delays(&mut self) {
        let delays = std::mem::take(&mut self.delays);
        // For each input its delay, if it has one, and for each delay the input that it names.
        let mut own: Vec<Option<usize>> = vec![None; self.scene.inputs.len()];
        for (place, delay) in delays.iter().enumerate() {
            own[delay.input] = Some(place);
        }
        let sources: Vec<Option<usize>> = delays.iter().map(|delay| self.source_of(delay)).collect();
        let mut shared: Vec<Option<Arc<[Signal]>>> = vec![None; self.scene.inputs.len()];
        // The input that a delay leads to in the end, and how much later it is by then.
        let mut ends: Vec<Option<(usize, Number)>> = vec![None; delays.len()];
        let mut state = vec![State::New; delays.len()];
        for first in 0..delays.len() {
            let mut path = Vec::new();
            let mut at = first;
            let end = loop {
                if state[at] == State::Settled {
                    break ends[at].clone();
                }
                if state[at] == State::OnPath {
                    self.circle(&delays[at]);
                    break None;
                }
                state[at] = State::OnPath;
                path.push(at);
                let Some(source) = sources[at] else { break None };
                match own[source] {
                    Some(next) => at = next,
                    None => break Some((source, Number::ZERO)),
                }
            };
            let mut end = end;
            for place in path.into_iter().rev() {
                end = end.map(|(source, by)| (source, &by + &delays[place].by));
                state[place] = State::Settled;
                ends[place] = end.clone();
            }
        }
        for (delay, end) in delays.iter().zip(ends) {
            let Some((source, by)) = end else { continue };
            let from = &self.scene.inputs[source];
            let signals = shared[source].get_or_insert_with(|| {
                from.signal.iter().filter(|signal| !matches!(signal, Signal::Constant { .. })).cloned().collect()
            });
            // A constant load is always present.
            let constants = from.signal.iter().filter(|signal| matches!(signal, Signal::Constant { .. })).cloned();
            let mut signal: Vec<Signal> = constants.collect();
            signal.push(Signal::Delayed { by, of: source, signals: signals.clone() });
            let derivative = from.derivative;
            let input = &mut self.scene.inputs[delay.input];
            (input.signal, input.derivative) = (signal, derivative);
        }
    }

    /// The input that a delay names: one with a signal, and of the same kind.
    fn source_of(&mut self, delay: &Delay) -> Option<usize> {
        let (input, of) = self.measured_input(delay.source, delay.environment).ok()?;
        let span = self.tree.expr(delay.source).span;
        let own = dimension_of(&self.scene.inputs[delay.input].kind);
        let source = &self.scene.inputs[input.index()];
        let (name, declared) = (self.words.display(source.name), source.span);
        let error = if of != own {
            PartError::DelayOfOtherKind { span, name, declared }
        } else if source.signal_span.is_none() {
            PartError::DelayOfNothing { span, name, declared }
        } else if source.signal.iter().any(|signal| matches!(signal, Signal::Spectrum(_))) {
            PartError::DelayOfSpectrum { span, name, declared }
        } else {
            return Some(input.index());
        };
        self.report(delay.environment, error);
        None
    }

    fn circle(&mut self, delay: &Delay) {
        let span: Span = self.tree.expr(delay.source).span;
        let name = self.words.display(self.scene.inputs[delay.input].name);
        self.report(delay.environment, PartError::DelayOfItself { span, name });
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    New,
    OnPath,
    Settled,
}
