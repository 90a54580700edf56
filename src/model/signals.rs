//! Signals of inputs: a sum of `constant`, `step`, `harmonic` and so on. In: the expression after `=`. Out: the signals
//! in SI units. See spec.md.

use super::Check;
use super::error::{PartError, ValueError};
use super::evaluate::Evaluated;
use super::expect::Expected;
use super::scene::Signal;
use super::scope::Environment;
use super::suggestion::nearest;
use crate::base::{Dimension, Number, Span};
use crate::kinds::functions::{self, Named, SIGNALS, SignalKind};
use crate::syntax::tree::{Binary, ExprId, ExprKind};

const TIME: Expected = Expected::new("a time", Dimension::TIME, "0.5 s");
const PHASE: Expected = Expected::new("an angle", Dimension::NONE, "30 deg");

impl<'a> Check<'a> {
    /// The signals that an expression adds up, and its span; nothing without an expression.
    pub fn signal(
        &mut self,
        expr: Option<ExprId>,
        kind: &SignalKind,
        environment: Environment,
    ) -> Evaluated<(Vec<Signal>, Option<Span>)> {
        let Some(expr) = expr else { return Ok((Vec::new(), None)) };
        let mut signals = Vec::new();
        // A sum associates to the left: its last term is the right operand at the top.
        let mut rest = expr;
        while let ExprKind::Binary { operator: Binary::Add, left, right } = self.tree.expr(rest).kind {
            signals.push(self.single_signal(right, kind, environment)?);
            rest = left;
        }
        signals.push(self.single_signal(rest, kind, environment)?);
        signals.reverse();
        Ok((signals, Some(self.tree.expr(expr).span)))
    }

    fn single_signal(&mut self, expr: ExprId, kind: &SignalKind, environment: Environment) -> Evaluated<Signal> {
        let tree = self.tree;
        let node = *tree.expr(expr);
        let ExprKind::Call { name_len, arguments } = node.kind else {
            return self.fail(environment, PartError::NotASignal { span: node.span });
        };
        let word = Span::new(node.span.file(), node.span.start(), node.span.start() + usize::from(name_len));
        let text = self.sources.slice(word);
        let given = tree.list(arguments);
        let Some(Named { kind: signal, function }) = functions::named(SIGNALS, text) else {
            let suggestion = nearest(text, SIGNALS.iter().map(|signal| signal.function.name));
            return self.fail(environment, PartError::UnknownSignal { span: word, word: text.to_string(), suggestion });
        };
        if !function.takes(given.len()) {
            return self.fail(environment, PartError::SignalArguments { span: node.span, function });
        }
        self.signal_of(*signal, given, kind, environment)
    }

    fn signal_of(
        &mut self,
        signal: functions::Signal,
        given: &[ExprId],
        kind: &SignalKind,
        environment: Environment,
    ) -> Evaluated<Signal> {
        use functions::Signal as Word;
        if signal == Word::Table {
            return self.table(given[0], &kind.amplitude, environment);
        }
        let expected = if signal == Word::Impulse { &kind.impulse } else { &kind.amplitude };
        let value = self.number(given[0], environment, expected);
        let time = |check: &mut Check<'a>, index: usize| check.number(given[index], environment, &TIME);
        let signal = match signal {
            Word::Constant => Signal::Constant { value: value? },
            Word::Step => Signal::Step { at: time(self, 1)?, value: value? },
            Word::Impulse => Signal::Impulse { at: time(self, 1)?, value: value? },
            Word::Ramp | Word::Pulse => {
                let (from, to) = (time(self, 1)?, time(self, 2)?);
                self.ordered(&from, &to, given[2], environment)?;
                if signal == Word::Ramp {
                    Signal::Ramp { value: value?, from, to }
                } else {
                    Signal::Pulse { value: value?, from, to }
                }
            }
            Word::Harmonic => {
                let frequency = self.frequency(given[1], environment)?;
                let phase = given.get(2).map(|&phase| self.number(phase, environment, &PHASE)).transpose()?;
                Signal::Harmonic { value: value?, frequency, phase: phase.unwrap_or(Number::ZERO) }
            }
            Word::Chirp | Word::Table => {
                let (from, to) = (self.frequency(given[1], environment)?, self.frequency(given[2], environment)?);
                let duration = self.number(given[3], environment, &TIME)?;
                self.ordered(&Number::ZERO, &duration, given[3], environment)?;
                Signal::Chirp { value: value?, from, to, duration }
            }
        };
        Ok(signal)
    }

    /// Checks that the later time is certainly later.
    fn ordered(&mut self, from: &Number, to: &Number, at: ExprId, environment: Environment) -> Evaluated<()> {
        if (to - from).is_positive() {
            return Ok(());
        }
        let span = self.tree.expr(at).span;
        self.fail(environment, PartError::TimesReversed { span })
    }

    fn table(&mut self, expr: ExprId, read: &Expected, environment: Environment) -> Evaluated<Signal> {
        let node = *self.tree.expr(expr);
        if !matches!(node.kind, ExprKind::Text) {
            let error = ValueError::Kind { span: node.span, needed: "a file name in quotes", found: "a number" };
            return self.fail(environment, error);
        }
        let file = self.sources.slice(node.span).trim_matches('"').to_string();
        let rows = match self.sources.table(node.span.file(), &file) {
            Some(table) => Some(self.table_rows(table, node.span, read, environment)?),
            None => None,
        };
        Ok(Signal::Table { file, span: node.span, rows })
    }
}
