//! Signals of inputs: a sum of `constant`, `step`, `harmonic` and their like. In: the expression after `=`; out: the
//! signals in SI. See spec.md.

use super::Check;
use super::error::{PartError, ValueError};
use super::evaluate::Evaluated;
use super::expect::Expected;
use super::scene::Signal;
use super::scope::Environment;
use super::suggestion::nearest;
use crate::base::{Dimension, Number, Span};
use crate::syntax::tree::{Binary, ExprId, ExprKind};

/// What an input is measured in.
#[derive(Clone, Copy, Debug)]
pub struct SignalKind {
    amplitude: Expected,
    /// Its integral over time.
    impulse: Expected,
}

pub const FORCE_SIGNAL: SignalKind = SignalKind {
    amplitude: Expected::new("a force", Dimension::FORCE, "10 N"),
    impulse: Expected::new("an impulse", Dimension::IMPULSE, "3 N*s"),
};
pub const TORQUE_SIGNAL: SignalKind = SignalKind {
    amplitude: Expected::new("a torque", Dimension::TORQUE, "2 N*m"),
    impulse: Expected::new("an angular impulse", Dimension::ANGULAR_IMPULSE, "2 N*m*s"),
};
pub const DISPLACEMENT_SIGNAL: SignalKind = SignalKind {
    amplitude: Expected::new("a displacement", Dimension::LENGTH, "1 mm"),
    impulse: Expected::new("a displacement times a time", Dimension::of(0, 1, 1), "1 mm*s"),
};
pub const ANGLE_SIGNAL: SignalKind = SignalKind {
    amplitude: Expected::new("an angle", Dimension::NONE, "2 deg"),
    impulse: Expected::new("an angle times a time", Dimension::TIME, "1 rad*s"),
};

const TIME: Expected = Expected::new("a time", Dimension::TIME, "0.5 s");
const PHASE: Expected = Expected::new("an angle", Dimension::NONE, "30 deg");

/// Every signal with its least and largest number of arguments and its form.
const SIGNALS: [(&str, usize, usize, &str); 8] = [
    ("constant", 1, 1, "constant(10 N)"),
    ("step", 2, 2, "step(10 N, 0 s)"),
    ("impulse", 2, 2, "impulse(3 N*s, 0 s)"),
    ("ramp", 3, 3, "ramp(10 N, 0 s, 1 s)"),
    ("pulse", 3, 3, "pulse(10 N, 0 s, 1 s)"),
    ("harmonic", 2, 3, "harmonic(10 N, 1.5 Hz, 90 deg)"),
    ("chirp", 4, 4, "chirp(10 N, 1 Hz, 20 Hz, 60 s)"),
    ("table", 1, 1, "table(\"file.csv\")"),
];

impl<'a> Check<'a> {
    /// The signals that an expression adds up, and where it stands; nothing without one.
    pub fn signal(
        &mut self,
        expr: Option<ExprId>,
        kind: &SignalKind,
        environment: Environment,
    ) -> Evaluated<(Vec<Signal>, Option<Span>)> {
        let Some(expr) = expr else { return Ok((Vec::new(), None)) };
        let mut signals = Vec::new();
        // A sum leans to the left: its last term is the right operand at the top.
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
        let Some(&(name, least, most, form)) = SIGNALS.iter().find(|(name, ..)| *name == text) else {
            let suggestion = nearest(text, SIGNALS.iter().map(|(name, ..)| *name));
            return self.fail(environment, PartError::UnknownSignal { span: word, word: text.to_string(), suggestion });
        };
        if given.len() < least || given.len() > most {
            return self.fail(environment, PartError::SignalArguments { span: node.span, name, form });
        }
        self.signal_of(name, given, kind, environment)
    }

    fn signal_of(
        &mut self,
        name: &str,
        given: &[ExprId],
        kind: &SignalKind,
        environment: Environment,
    ) -> Evaluated<Signal> {
        if name == "table" {
            return self.table(given[0], &kind.amplitude, environment);
        }
        let expected = if name == "impulse" { &kind.impulse } else { &kind.amplitude };
        let value = self.number(given[0], environment, expected);
        let time = |check: &mut Check<'a>, index: usize| check.number(given[index], environment, &TIME);
        let signal = match name {
            "constant" => Signal::Constant { value: value? },
            "step" => Signal::Step { at: time(self, 1)?, value: value? },
            "impulse" => Signal::Impulse { at: time(self, 1)?, value: value? },
            "ramp" | "pulse" => {
                let (from, to) = (time(self, 1)?, time(self, 2)?);
                self.ordered(&from, &to, given[2], environment)?;
                if name == "ramp" {
                    Signal::Ramp { value: value?, from, to }
                } else {
                    Signal::Pulse { value: value?, from, to }
                }
            }
            "harmonic" => {
                let frequency = self.frequency(given[1], environment)?;
                let phase = given.get(2).map(|&phase| self.number(phase, environment, &PHASE)).transpose()?;
                Signal::Harmonic { value: value?, frequency, phase: phase.unwrap_or(Number::ZERO) }
            }
            _ => {
                let (from, to) = (self.frequency(given[1], environment)?, self.frequency(given[2], environment)?);
                let duration = self.number(given[3], environment, &TIME)?;
                self.ordered(&Number::ZERO, &duration, given[3], environment)?;
                Signal::Chirp { value: value?, from, to, duration }
            }
        };
        Ok(signal)
    }

    /// The later time is certainly later.
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
