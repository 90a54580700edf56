//! Tolerances of parameters, their random spread and its correlation. In: the clauses after a `param`, and `correlate`.
//! Out: for each such parameter the range in SI units, which contains its value, and its distribution; and coefficients of
//! correlation that some joint distribution has. See spec.md#tolerances.

use super::Check;
use super::error::{QuestionError, ToleranceError};
use super::evaluate::Evaluated;
use super::expect::Expected;
use super::overrides::{ANY_NUMBER, coerce_to};
use super::scene::{Correlation, Spread, Tolerance};
use super::scope::{DefinitionId, Environment, Instance, State};
use super::value::{Scalar, Value};
use crate::base::{Dimension, Number, Span};
use crate::syntax::tree::{self, DeclKind, ExprId, Path, Rare};

/// Maximum number of parameters that are correlated with others: whether their matrix is positive definite is decided
/// exactly, and the digits grow with the number of rows.
const MAX_CORRELATED: usize = 64;

const COEFFICIENT: Expected = Expected::new("a coefficient of correlation", Dimension::NONE, "0.8");

/// A tolerance in the text, and the parameter that it is for.
#[derive(Clone, Copy, Debug)]
pub struct Tolerated {
    pub parameter: DefinitionId,
    /// Index into the tree's tolerances.
    pub index: u32,
}

impl<'a> Check<'a> {
    /// Tolerances belong to the declared values: a scene with values that an analysis tries has none.
    pub fn tolerances(&mut self) {
        if self.overrides.has_trials() {
            return;
        }
        let mut known = Vec::new();
        for place in 0..self.instances.tolerances.len() {
            let Tolerated { parameter, index } = self.instances.tolerances[place];
            let definition = &self.definitions[parameter.0 as usize];
            let environment = definition.environment;
            let State::Settled(Ok(Value::Scalar(value))) = definition.state.clone() else { continue };
            self.walk.varies = false;
            if let Ok(tolerance) = self.tolerance(parameter, &value, self.tree.tolerances[index as usize], environment)
            {
                self.scene.tolerances.push(tolerance);
                known.push(parameter);
            }
        }
        self.correlations(&known);
    }

    fn tolerance(
        &mut self,
        id: DefinitionId,
        value: &Scalar,
        written: tree::Tolerance,
        environment: Environment,
    ) -> Evaluated<Tolerance> {
        let spread = match written.spread {
            None => None,
            Some(tree::Spread::Uniform) if written.within.is_none() => {
                return self.fail(environment, ToleranceError::UniformWithoutRange { span: written.span });
            }
            Some(tree::Spread::Uniform) => Some(Spread::Uniform),
            Some(tree::Spread::Normal(expr)) => {
                Some(Spread::Normal { deviation: self.width(value, expr, "deviation", environment)?.0 })
            }
            Some(tree::Spread::Lognormal(expr)) => Some(self.lognormal(value, expr, environment)?),
        };
        let mut is_share = false;
        let within = match (written.within, written.upper) {
            (None, _) => None,
            (Some(low), Some(high)) => Some(self.limits(id, value, (low, high), environment)?),
            (Some(half), None) => {
                let (half, of_value) = self.width(value, half, "half-width", environment)?;
                is_share = of_value;
                let middle = &value.quantity.si;
                Some([middle - &half, middle + &half])
            }
        };
        let parameter = self.parameter(id, value);
        Ok(Tolerance { parameter, span: written.span, within, is_share, spread })
    }

    /// A half-width or a standard deviation in SI units, and whether it is a share of the value or of its own dimension.
    fn width(
        &mut self,
        value: &Scalar,
        expr: ExprId,
        what: &'static str,
        environment: Environment,
    ) -> Evaluated<(Number, bool)> {
        let given = self.evaluate(expr, environment)?;
        let given = self.as_scalar(&given, expr, environment, &ANY_NUMBER)?.clone();
        self.check_range(&given.quantity.si, expr, environment)?;
        let span = self.tree.expr(expr).span;
        if !given.quantity.si.is_positive() {
            return self.fail(environment, ToleranceError::NotPositive { span, what });
        }
        let is_plain = value.dimension() == Some(Dimension::NONE);
        if is_plain {
            let spread = what == "deviation";
            return self.fail(environment, ToleranceError::OfPlainNumber { span, spread });
        }
        if given.quantity.dimension == Dimension::NONE {
            if value.quantity.si.may_be_zero() {
                return self.fail(environment, ToleranceError::ShareOfZero { span });
            }
            return Ok((&value.quantity.si.abs() * &given.quantity.si, true));
        }
        match coerce_to(value, &given) {
            Ok(width) => Ok((width.quantity.si, false)),
            Err(mismatch) => self.fail(environment, mismatch.error(span, value)),
        }
    }

    fn lognormal(&mut self, value: &Scalar, expr: ExprId, environment: Environment) -> Evaluated<Spread> {
        const DEVIATION: Expected = Expected::new("the deviation of the logarithm", Dimension::NONE, "3 %");
        let deviation = self.number(expr, environment, &DEVIATION)?;
        let span = self.tree.expr(expr).span;
        if !deviation.is_positive() {
            return self.fail(environment, ToleranceError::NotPositive { span, what: "deviation" });
        }
        if !value.quantity.si.is_positive() {
            return self.fail(environment, ToleranceError::LognormalOfNegative { span });
        }
        Ok(Spread::Lognormal { deviation })
    }

    /// The ends of `within low .. high`, which contain the value.
    fn limits(
        &mut self,
        id: DefinitionId,
        value: &Scalar,
        (low, high): (ExprId, ExprId),
        environment: Environment,
    ) -> Evaluated<[Number; 2]> {
        let span = self.tree.expr(low).span.to(self.tree.expr(high).span);
        let ends = self.range_of(value, low, high, environment)?;
        let [low, high] = [ends.0.si, ends.1.si];
        if !(&high - &low).is_positive() {
            return self.fail(environment, QuestionError::RangeReversed { span });
        }
        let (name, middle) = (self.definitions[id.0 as usize].name, &value.quantity.si);
        let is_outside = (middle - &low).is_negative() || (&high - middle).is_negative();
        if is_outside {
            let expr = self.definitions[id.0 as usize].expr;
            let place = self.overrides.given_at(name).unwrap_or(self.tree.expr(expr).span);
            let word = self.words.display(name);
            return self.fail(environment, ToleranceError::ValueOutside { span, word, value: place });
        }
        Ok([low, high])
    }

    fn correlations(&mut self, known: &[DefinitionId]) {
        let mut complete = true;
        for place in 0..self.instances.correlations.len() {
            let Instance { decl, environment } = self.instances.correlations[place];
            let DeclKind::Rare { index } = decl.kind else { continue };
            let Rare::Correlate { first, second, coefficient } = self.tree.rare[index as usize] else { continue };
            self.walk.varies = false;
            if self.correlation((first, second), coefficient, decl.span, known, environment).is_err() {
                complete = false;
            }
        }
        if complete {
            self.joint_distribution();
        }
    }

    fn correlation(
        &mut self,
        (first, second): (Path, Path),
        coefficient: ExprId,
        span: Span,
        known: &[DefinitionId],
        environment: Environment,
    ) -> Evaluated<()> {
        let one = self.correlated_tolerance(first, known, environment);
        let other = self.correlated_tolerance(second, known, environment);
        let number = self.number(coefficient, environment, &COEFFICIENT)?;
        let (first, other) = (one?, other?);
        if first == other {
            let span = self.path_span(second);
            return self.fail(environment, ToleranceError::CorrelatedWithItself { span });
        }
        if !(&Number::ONE - &number.abs()).is_positive() {
            let span = self.tree.expr(coefficient).span;
            return self.fail(environment, ToleranceError::BeyondOne { span });
        }
        let pair = [first.min(other), first.max(other)];
        if let Some(earlier) = self.scene.correlations.iter().find(|earlier| earlier.pair == pair) {
            let first = earlier.span;
            return self.fail(environment, ToleranceError::CorrelatedTwice { span, first });
        }
        self.scene.correlations.push(Correlation { pair, coefficient: number, span });
        Ok(())
    }

    /// Refuses correlations that no joint distribution has. Only all of them together decide that: some pairs alone, with 0 for
    /// the others, may be impossible.
    fn joint_distribution(&mut self) {
        let Some(last) = self.scene.correlations.last() else { return };
        let span = last.span;
        let most = match positive_definite(&self.scene.correlations) {
            Definite::Yes => return,
            Definite::TooMany => Some(MAX_CORRELATED),
            Definite::No => None,
        };
        self.report(Environment::TOP, ToleranceError::NotDefinite { span, most });
    }

    /// The tolerance of a correlated parameter: its index in the scene.
    fn correlated_tolerance(
        &mut self,
        path: Path,
        known: &[DefinitionId],
        environment: Environment,
    ) -> Evaluated<usize> {
        let (id, _) = self.solved_parameter(path, environment)?;
        if let Some(index) = known.iter().position(|known| *known == id) {
            return Ok(index);
        }
        let definition = &self.definitions[id.0 as usize];
        let (span, word, declared) = (self.path_span(path), self.words.display(definition.name), definition.span);
        if self.instances.tolerances.iter().any(|tolerated| tolerated.parameter == id) {
            // Its tolerance has an error.
            return Err(super::evaluate::Stop::Reported);
        }
        self.fail(environment, ToleranceError::WithoutTolerance { span, word, declared })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Definite {
    Yes,
    No,
    TooMany,
}

/// Whether the matrix of correlations is positive definite: all pivots of its elimination without exchanges are positive.
fn positive_definite(correlations: &[Correlation]) -> Definite {
    let mut members: Vec<usize> = correlations.iter().flat_map(|correlation| correlation.pair).collect();
    members.sort_unstable();
    members.dedup();
    let n = members.len();
    if n > MAX_CORRELATED {
        return Definite::TooMany;
    }
    let mut matrix = vec![vec![Number::ZERO; n]; n];
    for (i, row) in matrix.iter_mut().enumerate() {
        row[i] = Number::ONE;
    }
    for Correlation { pair, coefficient, .. } in correlations {
        let place = pair.map(|index| members.partition_point(|member| *member < index));
        // Only the part below the diagonal is read.
        matrix[place[1]][place[0]] = coefficient.clone();
    }
    for k in 0..n {
        let (above, below) = matrix.split_at_mut(k + 1);
        let pivot = &above[k][k];
        if !pivot.is_positive() {
            return Definite::No;
        }
        let column: Vec<Number> = below.iter().map(|row| row[k].clone()).collect();
        for (i, row) in below.iter_mut().enumerate().filter(|(i, _)| !column[*i].is_zero()) {
            let factor = &column[i] / pivot;
            for (j, entry) in row[k + 1..=k + 1 + i].iter_mut().enumerate() {
                *entry = &*entry - &(&factor * &column[j]);
            }
        }
    }
    Definite::Yes
}
