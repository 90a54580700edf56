//! Signals of inputs: a sum of `constant`, `step`, `harmonic` and so on. In: the expression after `=`. Out: the signals
//! in SI units. See spec.md.

use super::Check;
use super::error::{PartError, ValueError};
use super::evaluate::{Evaluated, Stop};
use super::expect::Expected;
use super::scene::Signal;
use super::scope::Environment;
use super::suggestion::nearest;
use super::value::Value;
use super::{delays, noise, spectrum, tables};
use crate::base::{Dimension, Number, Span};
use crate::kinds::functions::{self, Named, SIGNALS, SignalKind};
use crate::syntax::tree::{Binary, ExprId, ExprKind};
use crate::system::Signal as Function;
use std::sync::Arc;

const TIME: Expected = Expected::new("a time", Dimension::TIME, "0.5 s");
const SPEED: Expected = Expected::new("a speed", Dimension::VELOCITY, "20 m/s");
const PHASE: Expected = Expected::new("an angle", Dimension::NONE, "30 deg");

/// The signals that drive an input.
#[derive(Debug, Default)]
pub struct Signals {
    pub list: Vec<Signal>,
    pub span: Option<Span>,
    /// The derivative of the motion that the signal gives: the index of its kind among those that the input takes.
    pub derivative: u8,
    /// Another input's signal in place of the list.
    pub delay: Option<delays::Written>,
}

/// A call of a signal's function, with its arguments sorted out.
struct Called {
    signal: functions::Signal,
    span: Span,
    given: Vec<ExprId>,
    /// In the order of the function's own list.
    named: Vec<Option<ExprId>>,
}

impl<'a> Check<'a> {
    /// The sum of signals in an expression, and its span; empty without an expression. All signals are of the same
    /// kind.
    pub fn signal(
        &mut self,
        expr: Option<ExprId>,
        kinds: &[SignalKind],
        environment: Environment,
    ) -> Evaluated<Signals> {
        let Some(expr) = expr else { return Ok(Signals::default()) };
        let span = self.tree.expr(expr).span;
        let mut found = Signals { span: Some(span), ..Signals::default() };
        let mut terms = Vec::new();
        // A sum associates to the left: its last term is the right operand at the top.
        let mut rest = expr;
        while let ExprKind::Binary { operator: Binary::Add, left, right } = self.tree.expr(rest).kind {
            terms.push(right);
            rest = left;
        }
        terms.push(rest);
        let mut known = None;
        for &term in terms.iter().rev() {
            let called = self.called_signal(term, environment)?;
            if called.signal == functions::Signal::Delayed {
                if terms.len() > 1 {
                    return self.fail(environment, PartError::DelayInSum { span: called.span });
                }
                let by = self.number(called.given[1], environment, &TIME)?;
                if by.is_negative() {
                    let span = self.tree.expr(called.given[1]).span;
                    return self.fail(environment, PartError::DelayNegative { span });
                }
                found.delay = Some(delays::Written { source: called.given[0], by });
                return Ok(found);
            }
            if called.signal == functions::Signal::Spectrum {
                if terms.len() > 1 {
                    return self.fail(environment, PartError::SpectrumInSum { span: called.span });
                }
                let Called { span, given, named, .. } = called;
                let damping = named.first().copied().flatten();
                let spectrum = self.spectrum(&spectrum::SpectrumCall { span, given, damping }, kinds, environment)?;
                found.derivative = spectrum.derivative;
                found.list.push(Signal::Spectrum(spectrum));
                return Ok(found);
            }
            if called.signal == functions::Signal::Noise {
                let Called { span, given, .. } = called;
                let noisy = self.noise(&noise::NoiseCall { span, given }, kinds, environment)?;
                if known.is_some_and(|known| known != noisy.derivative) {
                    return self.fail(environment, PartError::SignalsDiffer { span });
                }
                known = Some(noisy.derivative);
                found.list.push(Signal::Noise(noisy.density));
                continue;
            }
            let derivative = self.kind_of(&called, kinds, environment)?.or(known);
            let kind = &kinds[derivative.unwrap_or(0)];
            self.signal_of(&called, kind, environment, &mut found.list)?;
            if known.is_some() && derivative != known {
                return self.fail(environment, PartError::SignalsDiffer { span: called.span });
            }
            if derivative.unwrap_or(0) > 0 && called.signal == functions::Signal::Constant {
                let noun = kind.amplitude.noun;
                return self.fail(environment, PartError::ConstantOfRate { span: called.span, noun });
            }
            known = derivative;
        }
        found.derivative = known.unwrap_or(0) as u8;
        Ok(found)
    }

    fn called_signal(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Called> {
        let tree = self.tree;
        let node = *tree.expr(expr);
        let ExprKind::Call { name_len, arguments } = node.kind else {
            return self.fail(environment, PartError::NotASignal { span: node.span });
        };
        let word = Span::new(node.span.file(), node.span.start(), node.span.start() + usize::from(name_len));
        let text = self.sources.slice(word);
        let Some(Named { kind: signal, function }) = functions::by_name(SIGNALS, text) else {
            let suggestion = nearest(text, SIGNALS.iter().map(|signal| signal.function.name));
            return self.fail(environment, PartError::UnknownSignal { span: word, word: text.to_string(), suggestion });
        };
        let (mut given, mut named) = (Vec::new(), vec![None; function.named.len()]);
        for &argument in tree.list(arguments) {
            let node = *tree.expr(argument);
            // `white 3 N^2/Hz` is read by `noise` itself, which takes any number of corner points.
            let ExprKind::Named { name_len, value } = node.kind else {
                given.push(argument);
                continue;
            };
            if *signal == functions::Signal::Noise {
                given.push(argument);
                continue;
            }
            let start = node.span.start();
            let name = self.sources.slice(Span::new(node.span.file(), start, start + usize::from(name_len)));
            match function.named.iter().position(|known| known.name == name) {
                Some(place) if named[place].is_none() => named[place] = Some(value),
                _ => return self.fail(environment, PartError::SignalArguments { span: node.span, function }),
            }
        }
        // These take any number of points.
        let is_open = matches!(signal, functions::Signal::Noise | functions::Signal::Spectrum) && !given.is_empty();
        if !is_open && !function.takes(given.len()) {
            return self.fail(environment, PartError::SignalArguments { span: node.span, function });
        }
        Ok(Called { signal: *signal, span: node.span, given, named })
    }

    /// The index of the kind that a signal's dimension determines; `None` for a bare zero, and for a dimension of no
    /// kind.
    fn kind_of(&mut self, called: &Called, kinds: &[SignalKind], environment: Environment) -> Evaluated<Option<usize>> {
        use functions::Signal as Word;
        if kinds.len() == 1 {
            return Ok(Some(0));
        }
        let found = match called.signal {
            Word::Table => self.table_dimension(&called.given, environment)?,
            Word::Periodic => {
                let table = self.repeated_table(called, environment)?;
                self.table_dimension(&table.given, environment)?
            }
            _ => match self.evaluate(called.given[0], environment)? {
                Value::Scalar(scalar) => scalar.dimension(),
                Value::Vector(_) => None,
            },
        };
        let of = |kind: &SignalKind| if called.signal == Word::Impulse { kind.impulse } else { kind.amplitude };
        Ok(found.and_then(|found| kinds.iter().position(|kind| of(kind).dimension == found)))
    }

    /// Adds the signals that a call denotes.
    fn signal_of(
        &mut self,
        called: &Called,
        kind: &SignalKind,
        environment: Environment,
        list: &mut Vec<Signal>,
    ) -> Evaluated<()> {
        use functions::Signal as Word;
        let given = &called.given;
        if called.signal == Word::Table {
            let table = self.table(called, &kind.amplitude, environment)?;
            list.extend(self.table_from_zero(table, kind, called.span, environment));
            return Ok(());
        }
        if called.signal == Word::Periodic {
            let table = self.repeated_table(called, environment)?;
            let table = self.table(&table, &kind.amplitude, environment)?;
            list.push(self.periodic(table, given[1], kind.is_motion(), environment)?);
            return Ok(());
        }
        let expected = if called.signal == Word::Impulse { &kind.impulse } else { &kind.amplitude };
        let value = self.number(given[0], environment, expected);
        let time = |check: &mut Check<'a>, index: usize| check.number(given[index], environment, &TIME);
        let made = match called.signal {
            Word::Constant => {
                list.push(Signal::Constant { value: value? });
                return Ok(());
            }
            Word::Step => {
                let at = time(self, 1)?;
                self.note_before_zero(called.span, &at, None, environment);
                vec![Function::Step { at, value: value? }]
            }
            Word::Impulse => {
                let at = time(self, 1)?;
                self.note_before_zero(called.span, &at, Some(&at), environment);
                vec![Function::Impulse { at, value: value? }]
            }
            Word::Ramp | Word::Pulse | Word::HalfSine | Word::Haversine | Word::Sawtooth => {
                let (from, to) = (time(self, 1)?, time(self, 2)?);
                self.require_later(&from, &to, given[2], environment)?;
                let end = (called.signal != Word::Ramp).then_some(&to);
                self.note_before_zero(called.span, &from, end, environment);
                pulse(called.signal, value?, from, to)
            }
            Word::Trapezoid => {
                let times = [time(self, 1)?, time(self, 2)?, time(self, 3)?, time(self, 4)?];
                for i in 1..4 {
                    self.require_later(&times[i - 1], &times[i], given[i + 1], environment)?;
                }
                let [from, rise, fall, to] = times;
                self.note_before_zero(called.span, &from, Some(&to), environment);
                let value = value?;
                let falls = Function::Ramp { value: -&value, from: fall, to };
                vec![Function::Ramp { value, from, to: rise }, falls]
            }
            Word::Harmonic => {
                let frequency = self.frequency(given[1], environment)?;
                let phase = given.get(2).map(|&phase| self.number(phase, environment, &PHASE)).transpose()?;
                let (phase, at) = (phase.unwrap_or(Number::ZERO), Number::ZERO);
                vec![Function::Harmonic { value: value?, frequency, phase, at }]
            }
            Word::Chirp | Word::Table | Word::Periodic | Word::Delayed | Word::Noise | Word::Spectrum => {
                let (from, to) = (self.frequency(given[1], environment)?, self.frequency(given[2], environment)?);
                let duration = self.number(given[3], environment, &TIME)?;
                self.require_later(&Number::ZERO, &duration, given[3], environment)?;
                let (at, phase) = (Number::ZERO, Number::ZERO);
                vec![Function::Chirp { value: value?, from, to, duration, at, phase }]
            }
        };
        list.extend(made.into_iter().flat_map(Function::from_zero).map(Signal::from));
        Ok(())
    }

    /// Says what of a signal is left out because it is before t = 0. `end`: when it is over, if it ever is.
    fn note_before_zero(&mut self, span: Span, begin: &Number, end: Option<&Number>, environment: Environment) {
        if !begin.is_negative() {
            return;
        }
        let error = match end {
            Some(end) if end.is_negative() || end.is_zero() => PartError::SignalOver { span, at: end.to_f64() },
            _ => PartError::SignalCut { span, at: begin.to_f64() },
        };
        self.report(environment, error);
    }

    /// The rows of a table from t = 0 on. A spline keeps those before, which determine its course.
    fn table_from_zero(
        &mut self,
        table: Signal,
        kind: &SignalKind,
        span: Span,
        environment: Environment,
    ) -> Option<Signal> {
        let Signal::Table { file, span: named, rows: Some(rows), period: None } = table else { return Some(table) };
        if let Some((first, last)) = rows.times.first().zip(rows.times.last()) {
            let end = (!kind.is_load() && !kind.is_motion()).then_some(last);
            self.note_before_zero(span, first, end, environment);
        }
        let rows = if kind.is_motion() { rows } else { rows.from_zero(kind.is_load()).map_or(rows, Arc::new) };
        (!rows.times.is_empty()).then_some(Signal::Table { file, span: named, rows: Some(rows), period: None })
    }

    /// Checks that the later time is certainly later.
    fn require_later(&mut self, from: &Number, to: &Number, at: ExprId, environment: Environment) -> Evaluated<()> {
        if (to - from).is_positive() {
            return Ok(());
        }
        let span = self.tree.expr(at).span;
        self.fail(environment, PartError::TimesReversed { span })
    }

    /// The dimension that the call or the heading of a table states for its values.
    fn table_dimension(&mut self, given: &[ExprId], environment: Environment) -> Evaluated<Option<Dimension>> {
        if let Some(&unit) = given.get(1) {
            return Ok(match self.evaluate(unit, environment)? {
                Value::Scalar(scalar) => scalar.dimension(),
                Value::Vector(_) => None,
            });
        }
        let span = self.tree.expr(given[0]).span;
        let file = self.sources.slice(span).trim_matches('"').to_string();
        let Some(table) = self.sources.table(span.file(), &file) else { return Ok(None) };
        Ok(self.heading(table).and_then(|heading| heading.values.unit.map(|unit| unit.dimension)))
    }

    /// The call of `table` that `periodic` repeats.
    fn repeated_table(&mut self, called: &Called, environment: Environment) -> Evaluated<Called> {
        let node = *self.tree.expr(called.given[0]);
        if matches!(node.kind, ExprKind::Call { .. }) {
            let inner = self.called_signal(called.given[0], environment)?;
            if inner.signal == functions::Signal::Table {
                return Ok(inner);
            }
        }
        self.fail(environment, PartError::PeriodicOf { span: node.span })
    }

    /// A table whose rows come again after a period. `moves`: it is the displacement of a base.
    fn periodic(&mut self, table: Signal, period: ExprId, moves: bool, environment: Environment) -> Evaluated<Signal> {
        let Signal::Table { file, span: named, rows, .. } = table else { return Err(Stop::Reported) };
        let value = self.number(period, environment, &TIME)?;
        let span = self.tree.expr(period).span;
        if !value.is_positive() {
            return self.fail(environment, PartError::PeriodNotPositive { span });
        }
        if let Some(rows) = &rows
            && let Some((first, last)) = rows.times.first().zip(rows.times.last())
        {
            let covered = last - first;
            let rest = &value - &covered;
            let longest = rows.times.windows(2).map(|pair| (&pair[1] - &pair[0]).to_f64()).fold(0.0, f64::max);
            if !(rest.is_zero() || rest.is_positive()) {
                return self.fail(environment, PartError::PeriodShort { span, named, covered: covered.to_f64() });
            }
            // The rows of a sampled signal are one step apart; a table does not say what the signal does in a longer
            // gap.
            if rest.to_f64() > longest * (1.0 + f64::EPSILON) {
                return self.fail(environment, PartError::PeriodLong { span, named, rest: rest.to_f64(), longest });
            }
            if moves && rest.is_zero() && rows.values.first() != rows.values.last() {
                return self.fail(environment, PartError::PeriodOpen { span, named });
            }
        }
        Ok(Signal::Table { file, span: named, rows, period: Some(value) })
    }

    fn table(&mut self, called: &Called, read: &Expected, environment: Environment) -> Evaluated<Signal> {
        let (given, speed) = (&called.given, called.named.first().copied().flatten());
        let node = *self.tree.expr(given[0]);
        if !matches!(node.kind, ExprKind::Text) {
            let error = ValueError::Kind { span: node.span, needed: "a file name in quotes", found: "a number" };
            return self.fail(environment, error);
        }
        let unit = match given.get(1) {
            Some(&unit) => {
                let factor = self.number(unit, environment, read)?;
                if factor.may_be_zero() {
                    let span = self.tree.expr(unit).span;
                    return self.fail(environment, PartError::TableUnitZero { span });
                }
                Some((factor, self.tree.expr(unit).span))
            }
            None => None,
        };
        let speed = match speed {
            Some(speed) => {
                let value = self.number(speed, environment, &SPEED)?;
                if !value.is_positive() {
                    let span = self.tree.expr(speed).span;
                    return self.fail(environment, PartError::TableSpeed { span });
                }
                Some(value)
            }
            None => None,
        };
        let file = self.sources.slice(node.span).trim_matches('"').to_string();
        let rows = match self.sources.table(node.span.file(), &file) {
            Some(table) => {
                let first = speed.map_or(tables::First::Time, tables::First::Distance);
                let asked = tables::TableRequest { named: node.span, unit, first, read };
                Some(self.table_rows(table, &asked, environment)?)
            }
            None => None,
        };
        Ok(Signal::Table { file, span: node.span, rows, period: None })
    }
}

/// A pulse between two times as a sum of signals that exist.
fn pulse(signal: functions::Signal, value: Number, from: Number, to: Number) -> Vec<Function> {
    use functions::Signal as Word;
    let duration = &to - &from;
    let at = from.clone();
    // Number of half turns in between.
    let wave = |value: Number, halves: i64, phase: Number| {
        let frequency = &Number::from(halves) / &(&duration * &Number::from(2));
        let (from, to, at, duration) = (frequency.clone(), frequency, at.clone(), duration.clone());
        Function::Chirp { value, from, to, duration, at, phase }
    };
    match signal {
        Word::Ramp => vec![Function::Ramp { value, from, to }],
        Word::HalfSine => vec![wave(value, 1, Number::ZERO)],
        // a (1 - cos) / 2
        Word::Haversine => {
            let half = &value / &Number::from(2);
            let quarter = &Number::pi() / &Number::from(2);
            vec![Function::Pulse { value: half.clone(), from, to }, wave(-&half, 2, quarter)]
        }
        Word::Sawtooth => {
            let end = Function::Step { value: -&value, at: to.clone() };
            vec![Function::Ramp { value, from, to }, end]
        }
        _ => vec![Function::Pulse { value, from, to }],
    }
}
