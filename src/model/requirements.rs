//! Comparisons of `require` and `solve`: arithmetic of measures, chains of comparisons. In: both sides. Out: a measure, and the
//! number that it is compared with. See spec.md#requirements.

use super::Check;
use super::error::{QuestionError, ValueError};
use super::evaluate::Evaluated;
use super::expect::Expected;
use super::measures::Measured;
use super::scene::{Arithmetic, Combined, Comparison, Measure, Question, Require, Written};
use super::scope::{Environment, Instance};
use super::suggestion::nearest;
use super::value::{Scalar, Value};
use crate::base::{Angle, Dimension, Number, Span};
use crate::syntax::tree::{Binary, DeclKind, ExprId, ExprKind, Rare};

/// A part of an expression of measures and its dimension; a bare zero has no dimension.
struct Term {
    combined: Combined<Measure>,
    dimension: Option<Dimension>,
}

const ANY_NUMBER: Expected = Expected::new("a number", Dimension::NONE, "2");

impl<'a> Check<'a> {
    pub fn requires(&mut self) {
        for index in 0..self.instances.requires.len() {
            let Instance { decl, environment } = self.instances.requires[index];
            let DeclKind::Rare { index } = decl.kind else { continue };
            let Rare::Require { condition } = self.tree.rare[index as usize] else { continue };
            self.walk.varies = false;
            // Otherwise an error has been reported.
            if let Ok(list) = self.requirement(condition, environment) {
                self.scene.requires.extend(list);
            }
        }
    }

    /// `stable`, `left < right`, or a chain of comparisons in one direction: a requirement for each comparison.
    pub(super) fn requirement(&mut self, condition: ExprId, environment: Environment) -> Evaluated<Vec<Require>> {
        let node = *self.tree.expr(condition);
        let mut sides = Vec::new();
        let mut rest = condition;
        // A chain associates to the left.
        while let ExprKind::Binary { operator, left, right } = self.tree.expr(rest).kind {
            let Some(comparison) = comparison(operator) else { break };
            sides.push((comparison, right));
            rest = left;
        }
        if sides.is_empty() {
            let question = self.stable(condition, environment)?;
            return Ok(vec![Require { span: node.span, question, comparison: None }]);
        }
        sides.reverse();
        let rises = |comparison| matches!(comparison, Comparison::Less | Comparison::LessEqual);
        if sides.windows(2).any(|pair| rises(pair[0].0) != rises(pair[1].0)) {
            return self.fail(environment, QuestionError::RequireChain { span: node.span });
        }
        let is_chain = sides.len() > 1;
        let mut list = Vec::new();
        let mut left = rest;
        for (comparison, right) in sides {
            let span = self.tree.expr(left).span.to(self.tree.expr(right).span);
            if is_chain && !self.has_measure(left) && !self.has_measure(right) {
                return self.fail(environment, QuestionError::ChainWithoutMeasure { span });
            }
            let flips = !self.has_measure(left) && self.has_measure(right);
            let (side, other) = if flips { (right, left) } else { (left, right) };
            let question = self.comparison_side(side, other, environment)?;
            let comparison = if flips { flip(comparison) } else { comparison };
            list.push(Require { span, question, comparison: Some(comparison) });
            left = right;
        }
        Ok(list)
    }

    /// `require stable`
    fn stable(&mut self, condition: ExprId, environment: Environment) -> Evaluated<Question> {
        let node = *self.tree.expr(condition);
        if let ExprKind::Name { .. } = node.kind
            && self.sources.slice(node.span) != "stable"
        {
            let suggestion = nearest(self.sources.slice(node.span), ["stable"]);
            return self.fail(environment, QuestionError::RequireWhat { span: node.span, suggestion });
        }
        if matches!(node.kind, ExprKind::Binary { .. }) {
            return self.fail(environment, QuestionError::RequireWhat { span: node.span, suggestion: None });
        }
        match self.measure(condition, environment)?.measure {
            Measure::Stable => {
                let unit = Written { text: String::new(), factor: Some(Number::ONE) };
                let (span, value) = (node.span, Number::ZERO);
                let within = self.describe_environment(environment, "");
                Ok(Question { measure: Measure::Stable, span, value, radians: None, unit, within })
            }
            _ => self.fail(environment, QuestionError::RequireWhat { span: node.span, suggestion: None }),
        }
    }

    /// An expression of measures and what it is compared with: a number, or another such expression. For two
    /// expressions, their difference is compared with zero.
    pub fn comparison_side(&mut self, side: ExprId, other: ExprId, environment: Environment) -> Evaluated<Question> {
        let span = self.tree.expr(side).span;
        let compares_two = self.has_measure(other);
        if !self.has_measure(side) || self.is_measure(side) && !compares_two {
            let measured = self.measure(side, environment)?;
            return self.question(measured, span, other, environment);
        }
        let left = self.term(side, environment)?;
        if compares_two {
            let right = self.term(other, environment)?;
            let whole = span.to(self.tree.expr(other).span);
            let difference = self.join(Arithmetic::Subtract, left, right, whole, environment)?;
            let dimension = difference.dimension.unwrap_or(Dimension::NONE);
            let measure = Measure::Combined(Box::new(difference.combined));
            let unit = unit_of(&measure, dimension);
            let within = self.describe_environment(environment, "");
            return Ok(Question { measure, span: whole, value: Number::ZERO, radians: None, unit, within });
        }
        let dimension = left.dimension.unwrap_or(Dimension::NONE);
        let measured = Measured { measure: Measure::Combined(Box::new(left.combined)), dimension };
        self.question(measured, span, other, environment)
    }

    /// The objective of `minimise` or `maximise`: an expression of measures that is not compared with anything.
    pub(super) fn objective(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Question> {
        let span = self.tree.expr(expr).span;
        let Measured { measure, dimension } = if self.is_measure(expr) || !self.has_measure(expr) {
            self.measure(expr, environment)?
        } else {
            let Term { combined, dimension } = self.term(expr, environment)?;
            Measured { measure: Measure::Combined(Box::new(combined)), dimension: dimension.unwrap_or(Dimension::NONE) }
        };
        if matches!(measure, Measure::Stable) {
            return self.fail(environment, QuestionError::MeasureAsValue { span });
        }
        let unit = unit_of(&measure, dimension);
        let within = self.describe_environment(environment, "");
        Ok(Question { measure, span, value: Number::ZERO, radians: None, unit, within })
    }

    /// A measure and the number that it is compared with.
    fn question(
        &mut self,
        measured: Measured,
        at: Span,
        value: ExprId,
        environment: Environment,
    ) -> Evaluated<Question> {
        let number = self.value_of_measure(&measured, value, environment)?;
        let is_frequency = measured.dimension == Dimension::FREQUENCY
            && matches!(measured.measure, Measure::Frequency { .. } | Measure::Combined(_));
        let radians = match (is_frequency, self.evaluate(value, environment)?) {
            (true, Value::Scalar(Scalar { quantity, .. })) => (quantity.angle == Angle::Radians).then_some(quantity.si),
            _ => None,
        };
        let mut unit = self.written_unit(value, measured.dimension);
        if unit.text.is_empty() {
            unit.text = match measured.measure {
                Measure::Phase { .. } => "rad".to_string(),
                _ if is_frequency => if radians.is_some() { "rad/s" } else { "Hz" }.to_string(),
                _ => unit.text,
            };
        }
        let within = self.describe_environment(environment, "");
        Ok(Question { measure: measured.measure, span: at, value: number, radians, unit, within })
    }

    /// Whether an expression mentions a measure.
    fn has_measure(&self, expr: ExprId) -> bool {
        let tree = self.tree;
        match tree.expr(expr).kind {
            _ if self.is_measure(expr) => true,
            ExprKind::Negate { operand } => self.has_measure(operand),
            ExprKind::Binary { left, right, .. } => self.has_measure(left) || self.has_measure(right),
            ExprKind::Call { arguments, .. } => tree.list(arguments).iter().any(|&item| self.has_measure(item)),
            _ => false,
        }
    }

    /// Measures and numbers, added, subtracted, multiplied and divided.
    fn term(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Term> {
        let node = *self.tree.expr(expr);
        if self.is_measure(expr) {
            let Measured { measure, dimension } = self.measure(expr, environment)?;
            if matches!(measure, Measure::Stable) {
                return self.fail(environment, QuestionError::MeasureAsValue { span: node.span });
            }
            return Ok(Term { combined: Combined::Measure(measure), dimension: Some(dimension) });
        }
        if !self.has_measure(expr) {
            return self.number_term(expr, environment);
        }
        match node.kind {
            ExprKind::Negate { operand } => {
                let Term { combined, dimension } = self.term(operand, environment)?;
                Ok(Term { combined: Combined::Negated(Box::new(combined)), dimension })
            }
            ExprKind::Binary { operator, left, right } => {
                let Some(operator) = arithmetic(operator) else {
                    return self.fail(environment, QuestionError::MeasureAsValue { span: node.span });
                };
                let a = self.term(left, environment);
                let b = self.term(right, environment)?;
                self.join(operator, a?, b, node.span, environment)
            }
            ExprKind::Call { name_len, .. } => {
                let function = self.sources.slice(node.span)[..usize::from(name_len)].to_string();
                self.fail(environment, QuestionError::MeasureInFunction { span: node.span, function })
            }
            _ => self.fail(environment, QuestionError::MeasureAsValue { span: node.span }),
        }
    }

    /// A number among measures; a frequency in Hz, like the measures.
    fn number_term(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Term> {
        let value = self.evaluate(expr, environment)?;
        let scalar = self.as_scalar(&value, expr, environment, &ANY_NUMBER)?.clone();
        let dimension = scalar.dimension();
        self.check_range(&scalar.quantity.si, expr, environment)?;
        let number = match dimension {
            Some(Dimension::FREQUENCY) => self.in_hertz(&scalar.quantity, expr, environment)?,
            _ => scalar.quantity.si,
        };
        Ok(Term { combined: Combined::Number(number), dimension })
    }

    fn join(
        &mut self,
        operator: Arithmetic,
        left: Term,
        right: Term,
        span: Span,
        environment: Environment,
    ) -> Evaluated<Term> {
        // A bare zero is a plain number in a product.
        let plain = |dimension: Option<Dimension>| dimension.unwrap_or(Dimension::NONE);
        let dimension = match (operator, left.dimension, right.dimension) {
            (Arithmetic::Add | Arithmetic::Subtract, Some(a), Some(b)) if a != b => {
                return self.fail(environment, QuestionError::MeasuresDiffer { span, left: a, right: b });
            }
            (Arithmetic::Add | Arithmetic::Subtract, a, b) => a.or(b),
            (product, a, b) => {
                let of_both = match product {
                    Arithmetic::Multiply => plain(a).times(plain(b)),
                    _ => plain(a).per(plain(b)),
                };
                match of_both {
                    Some(dimension) => Some(dimension),
                    None => return self.fail(environment, ValueError::Overflow { span }),
                }
            }
        };
        let (left, right) = (Box::new(left.combined), Box::new(right.combined));
        Ok(Term { combined: Combined::Binary { operator, left, right }, dimension })
    }
}

/// The unit of a value that is not compared with one of a unit of its own. Frequencies are in Hz, also in products.
fn unit_of(measure: &Measure, dimension: Dimension) -> Written {
    let text = match measure {
        Measure::Phase { .. } => "rad".to_string(),
        _ if dimension == Dimension::FREQUENCY => "Hz".to_string(),
        Measure::Combined(combined) if dimension == Dimension::ANGULAR_ACCELERATION && has_frequency(combined) => {
            "Hz^2".to_string()
        }
        _ => dimension.usual_unit(),
    };
    Written { text, factor: Some(Number::ONE) }
}

fn has_frequency(combined: &Combined<Measure>) -> bool {
    match combined {
        Combined::Number(_) => false,
        Combined::Measure(measure) => matches!(measure, Measure::Frequency { .. }),
        Combined::Negated(operand) => has_frequency(operand),
        Combined::Binary { left, right, .. } => has_frequency(left) || has_frequency(right),
    }
}

fn arithmetic(operator: Binary) -> Option<Arithmetic> {
    match operator {
        Binary::Add => Some(Arithmetic::Add),
        Binary::Subtract => Some(Arithmetic::Subtract),
        Binary::Multiply => Some(Arithmetic::Multiply),
        Binary::Divide => Some(Arithmetic::Divide),
        _ => None,
    }
}

fn comparison(operator: Binary) -> Option<Comparison> {
    match operator {
        Binary::Less => Some(Comparison::Less),
        Binary::LessEqual => Some(Comparison::LessEqual),
        Binary::Greater => Some(Comparison::Greater),
        Binary::GreaterEqual => Some(Comparison::GreaterEqual),
        _ => None,
    }
}

fn flip(comparison: Comparison) -> Comparison {
    match comparison {
        Comparison::Less => Comparison::Greater,
        Comparison::LessEqual => Comparison::GreaterEqual,
        Comparison::Greater => Comparison::Less,
        Comparison::GreaterEqual => Comparison::LessEqual,
    }
}
