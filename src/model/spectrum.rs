//! `spectrum(...)`: a response spectrum in place of a history. In: the arguments of the call. Out: the spectrum in SI, and of
//! which derivative of the base's motion it is. See spec.md#signals.

use super::Check;
use super::corner_points::CornerPoints;
use super::error::PartError;
use super::evaluate::Evaluated;
use super::expect::Expected;
use super::scope::Environment;
use super::tables::{First, TableRequest};
use super::value::Value;
use crate::base::{Dimension, Number, ResponseSpectrum, Span};
use crate::kinds::functions::SignalKind;
use crate::syntax::tree::{ExprId, ExprKind};

const DAMPING: Expected = Expected::new("a damping ratio", Dimension::NONE, "5 %");

/// A call of `spectrum`.
pub struct SpectrumCall {
    pub span: Span,
    pub given: Vec<ExprId>,
    pub damping: Option<ExprId>,
}

impl<'a> Check<'a> {
    /// A spectrum moves a base, alone.
    pub fn spectrum(
        &mut self,
        call: &SpectrumCall,
        kinds: &[SignalKind],
        environment: Environment,
    ) -> Evaluated<ResponseSpectrum> {
        if kinds.len() == 1 {
            return self.fail(environment, PartError::SpectrumOfNoBase { span: call.span });
        }
        let Some(damping) = call.damping else {
            return self.fail(environment, PartError::SpectrumDamping { span: call.span, given: false });
        };
        let ratio = self.number(damping, environment, &DAMPING)?;
        if ratio.is_negative() {
            let span = self.tree.expr(damping).span;
            return self.fail(environment, PartError::SpectrumDamping { span, given: true });
        }
        let (points, derivative) = match call.given[..] {
            [table] if matches!(self.tree.expr(table).kind, ExprKind::Call { .. }) => {
                self.spectrum_table(table, kinds, call, environment)?
            }
            _ => self.spectrum_points(call, kinds, environment)?,
        };
        Ok(ResponseSpectrum::of(&points, derivative, ratio))
    }

    fn spectrum_points(
        &mut self,
        call: &SpectrumCall,
        kinds: &[SignalKind],
        environment: Environment,
    ) -> Evaluated<CornerPoints<u8>> {
        let rises = |check: &mut Self, before: &Number, frequency: &Number, at| {
            if (frequency - before).is_positive() {
                return Ok(());
            }
            let span = check.tree.expr(at).span;
            check.fail(environment, PartError::SpectrumFrequency { span })
        };
        let value = |check: &mut Self, value| check.spectrum_value(value, kinds, environment);
        match self.corner_points(&call.given, environment, rises, value)? {
            Some(points) => Ok(points),
            None => self.no_points(call, environment),
        }
    }

    fn no_points<T>(&mut self, call: &SpectrumCall, environment: Environment) -> Evaluated<T> {
        self.fail(environment, PartError::SpectrumArguments { span: call.span })
    }

    /// `table("spectrum.csv", 1 g0)`: frequencies and values.
    fn spectrum_table(
        &mut self,
        table: ExprId,
        kinds: &[SignalKind],
        call: &SpectrumCall,
        environment: Environment,
    ) -> Evaluated<CornerPoints<u8>> {
        let node = *self.tree.expr(table);
        let ExprKind::Call { name_len, arguments } = node.kind else { return self.no_points(call, environment) };
        let start = node.span.start();
        let word = self.sources.slice(Span::new(node.span.file(), start, start + usize::from(name_len)));
        let [name, unit] = match self.tree.list(arguments) {
            [name, unit] if word == "table" && matches!(self.tree.expr(*name).kind, ExprKind::Text) => [*name, *unit],
            _ => return self.no_points(call, environment),
        };
        let (factor, derivative) = self.spectrum_value(unit, kinds, environment)?;
        let span = self.tree.expr(name).span;
        let file = self.sources.slice(span).trim_matches('"').to_string();
        let Some(table) = self.sources.table(span.file(), &file) else { return Ok((Vec::new(), derivative)) };
        let read = kinds[usize::from(derivative)].amplitude;
        let unit = Some((factor, self.tree.expr(unit).span));
        let asked = TableRequest { named: span, unit, first: First::Frequency, read: &read };
        let rows = self.table_rows(table, &asked, environment)?;
        let is_right = |(f, a): (&Number, &Number)| f.is_positive() && a.is_positive();
        if rows.times.len() < 2 || !rows.times.iter().zip(&rows.values).all(is_right) {
            return self.fail(environment, PartError::SpectrumTable { span });
        }
        Ok((rows.times.iter().cloned().zip(rows.values.iter().cloned()).collect(), derivative))
    }

    /// A value above zero, and which derivative of a displacement it is.
    fn spectrum_value(
        &mut self,
        expr: ExprId,
        kinds: &[SignalKind],
        environment: Environment,
    ) -> Evaluated<(Number, u8)> {
        let value = self.evaluate(expr, environment)?;
        let found = match &value {
            Value::Scalar(scalar) => scalar.dimension(),
            Value::Vector(_) => None,
        };
        let place = kinds.iter().position(|kind| Some(kind.amplitude.dimension) == found).unwrap_or(kinds.len() - 1);
        let size = self.as_number(&value, expr, environment, &kinds[place].amplitude)?;
        if !size.is_positive() {
            let span = self.tree.expr(expr).span;
            return self.fail(environment, PartError::SpectrumValue { span });
        }
        Ok((size, place as u8))
    }
}
