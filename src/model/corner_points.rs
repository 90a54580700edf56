//! Corner points, as in `(20 Hz, 1 N^2/Hz), (80 Hz, 4 N^2/Hz)`: the course of a density or of a response spectrum. In:
//! the arguments of the call. Out: frequencies in ascending order with their values, and the derivative that the values
//! refer to.

use super::Check;
use super::error::PartError;
use super::evaluate::Evaluated;
use super::scope::Environment;
use crate::base::Number;
use crate::syntax::tree::{ExprId, ExprKind};

/// Frequencies in Hz with their values in SI, and the derivative that the values refer to.
pub type CornerPoints<D> = (Vec<(Number, Number)>, D);

impl<'a> Check<'a> {
    /// `None` if there are fewer than two pairs. `rises` checks a frequency against the one before it, or against zero.
    pub fn corner_points<D: Copy + PartialEq>(
        &mut self,
        given: &[ExprId],
        environment: Environment,
        rises: impl Fn(&mut Self, &Number, &Number, ExprId) -> Evaluated<()>,
        value: impl Fn(&mut Self, ExprId) -> Evaluated<(Number, D)>,
    ) -> Evaluated<Option<CornerPoints<D>>> {
        let mut points: Vec<(Number, Number)> = Vec::new();
        let mut known = None;
        for &point in given {
            let pair = match self.tree.expr(point).kind {
                ExprKind::Tuple { items } => <[ExprId; 2]>::try_from(self.tree.list(items)).ok(),
                _ => None,
            };
            let Some([at, written]) = pair else { return Ok(None) };
            let frequency = self.frequency(at, environment)?;
            let before = points.last().map_or(&Number::ZERO, |(before, _)| before);
            rises(self, before, &frequency, at)?;
            let (value, derivative) = value(self, written)?;
            if known.is_some_and(|known| known != derivative) {
                let span = self.tree.expr(written).span;
                return self.fail(environment, PartError::SignalsDiffer { span });
            }
            known = Some(derivative);
            points.push((frequency, value));
        }
        Ok(known.filter(|_| points.len() > 1).map(|derivative| (points, derivative)))
    }
}
