//! Typed values: a mass, a position, a frequency. In: an expression. Out: its SI number, with its dimension checked and
//! its size within the range of binary64, or a message that names what was expected and what was found. See
//! spec.md#units.

use super::Check;
use super::arguments::Brackets;
use super::elements::Coefficient;
use super::error::ValueError;
use super::evaluate::{Evaluated, Stop};
use super::laws;
use super::scope::{DefinitionId, Environment, Table};
use super::value::{Scalar, Value, Vector};
pub use crate::base::Expected;
use crate::base::{Angle, Dimension, Number, Quantity, Span, Vec3};
use crate::syntax::tree::{ExprId, ExprKind};
use std::sync::Arc;

/// Values that were computed once and hold in every repetition.
#[derive(Debug, Default)]
pub struct Cache {
    numbers: Table<ExprId, Evaluated<Number>>,
    places: Table<ExprId, Evaluated<Arc<Vec3>>>,
    pub coefficients: Table<ExprId, Evaluated<Coefficient>>,
    pub laws: Table<ExprId, Evaluated<laws::Read>>,
    /// The declared values of parameters, `let`s and points.
    pub values: Table<ExprId, Value>,
    /// The arguments of a place, by the word of its component.
    pub brackets: Table<Span, Evaluated<Brackets>>,
}

const POSITION: Expected = Expected::new("a position", Dimension::LENGTH, "(0, 1 m)");
const FREQUENCY: Expected = Expected::new("a frequency", Dimension::FREQUENCY, "30 Hz");

impl<'a> Check<'a> {
    /// A number of the expected dimension.
    pub fn number(&mut self, expr: ExprId, environment: Environment, expected: &Expected) -> Evaluated<Number> {
        self.cache(
            expr,
            environment,
            |memory| &mut memory.numbers,
            |check| {
                let value = check.evaluate(expr, environment)?;
                check.as_number(&value, expr, environment, expected)
            },
        )
    }

    /// A frequency in Hz: cycles as they are, radians divided by 2 pi; it is an error if the unit says neither.
    pub fn frequency(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Number> {
        let value = self.evaluate(expr, environment)?;
        let number = self.as_number(&value, expr, environment, &FREQUENCY)?;
        match value {
            Value::Scalar(Scalar { quantity, bare_zero: false, .. }) => self.in_hertz(&quantity, expr, environment),
            _ => Ok(number),
        }
    }

    pub fn in_hertz(&mut self, quantity: &Quantity, expr: ExprId, environment: Environment) -> Evaluated<Number> {
        match quantity.angle {
            Angle::Cycles => Ok(quantity.si.clone()),
            Angle::Radians => Ok(&quantity.si / &(&Number::from(2) * &Number::pi())),
            Angle::Plain | Angle::PerCycle | Angle::PerRadian => {
                let (span, value) = (self.tree.expr(expr).span, quantity.si.to_f64());
                self.fail(environment, ValueError::FrequencyReading { span, value })
            }
        }
    }

    /// A position in the scene, m.
    pub fn position(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Arc<Vec3>> {
        let local = self.cache(
            expr,
            environment,
            |memory| &mut memory.places,
            |check| {
                let value = check.evaluate(expr, environment)?;
                Ok(check.as_position(value, expr, environment)?.si)
            },
        )?;
        self.in_scene(local, expr, environment)
    }

    /// A direction in the scene: `x`, `y`, or a vector that is not zero. Its length does not matter.
    pub fn direction(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Arc<Vec3>> {
        let own = self.own_direction(expr, environment)?;
        self.rotate_to_scene(own, environment)
    }

    /// The direction in the axes of the component in which it is written.
    pub fn own_direction(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Arc<Vec3>> {
        self.cache(
            expr,
            environment,
            |memory| &mut memory.places,
            |check| match check.axis(expr) {
                Some(axis) => Ok(Arc::new(axis)),
                None => check.oblique_direction(expr, environment),
            },
        )
    }

    /// `x`, `y`, `-x`, `-y`.
    fn axis(&self, expr: ExprId) -> Option<Vec3> {
        let node = self.tree.expr(expr);
        match node.kind {
            ExprKind::Name { .. } if self.sources.slice(node.span) == "x" => Some(Vec3::X),
            ExprKind::Name { .. } if self.sources.slice(node.span) == "y" => Some(Vec3::Y),
            ExprKind::Negate { operand } => {
                let named = matches!(self.tree.expr(operand).kind, ExprKind::Name { .. });
                named.then(|| self.axis(operand))?.map(|axis| axis.scale(&Number::from(-1)))
            }
            _ => None,
        }
    }

    fn oblique_direction(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Arc<Vec3>> {
        let span = self.tree.expr(expr).span;
        let Value::Vector(Vector { si, .. }) = self.evaluate(expr, environment)? else {
            return self.fail(environment, ValueError::Kind { span, needed: "a direction", found: "a number" });
        };
        if si.may_be_zero() {
            return self.fail(environment, ValueError::NoDirection { span });
        }
        Ok(si)
    }

    /// The cached value of this expression if no index of a `repeat` enters it; otherwise the result of `make`.
    pub fn cache<T: Clone>(
        &mut self,
        expr: ExprId,
        environment: Environment,
        table: fn(&mut Cache) -> &mut Table<ExprId, Evaluated<T>>,
        make: impl FnOnce(&mut Check<'a>) -> Evaluated<T>,
    ) -> Evaluated<T> {
        if environment.is_top() {
            return make(self);
        }
        if let Some(known) = table(&mut self.memory).get(&expr) {
            return known.clone();
        }
        self.walk.varies = false;
        let made = make(self);
        if !self.walk.varies {
            table(&mut self.memory).insert(expr, made.clone());
        }
        made
    }

    pub fn as_number(
        &mut self,
        value: &Value,
        expr: ExprId,
        environment: Environment,
        expected: &Expected,
    ) -> Evaluated<Number> {
        let scalar = self.as_scalar(value, expr, environment, expected)?;
        match scalar.dimension() {
            None => Ok(Number::ZERO),
            Some(found) if found == expected.dimension => {
                self.check_range(&scalar.quantity.si, expr, environment)?;
                self.cycles_for_radians(scalar, expr, environment, expected);
                Ok(scalar.quantity.si.clone())
            }
            Some(found) => Err(self.mismatch(found, expr, environment, expected)),
        }
    }

    /// Warns if a frequency in cycles went into something that is not a frequency.
    fn cycles_for_radians(&mut self, scalar: &Scalar, expr: ExprId, environment: Environment, expected: &Expected) {
        let is_rate = [Dimension::NONE, Dimension::FREQUENCY].contains(&expected.dimension);
        if is_rate || scalar.cycles <= 0.0 {
            return;
        }
        self.report_cycles(scalar.quantity.si.to_f64(), expr, environment, expected);
    }

    /// Warns that a number with a factor in cycles belongs to angular frequencies.
    pub fn report_cycles(&mut self, value: f64, expr: ExprId, environment: Environment, expected: &Expected) {
        let span = self.tree.expr(expr).span;
        let declared = self.declaration_of(expr, environment);
        self.report(environment, ValueError::CyclesForRadians { span, value, expected: Box::new(*expected), declared });
    }

    pub fn as_scalar<'v>(
        &mut self,
        value: &'v Value,
        expr: ExprId,
        environment: Environment,
        expected: &Expected,
    ) -> Evaluated<&'v Scalar> {
        match value {
            Value::Scalar(scalar) => Ok(scalar),
            Value::Vector(_) => {
                let span = self.tree.expr(expr).span;
                self.fail(environment, ValueError::Kind { span, needed: expected.noun, found: "a point" })
            }
        }
    }

    /// Reports that the value has another dimension than expected.
    pub fn mismatch(&mut self, found: Dimension, expr: ExprId, environment: Environment, expected: &Expected) -> Stop {
        let node = *self.tree.expr(expr);
        let (span, expected) = (node.span, *expected);
        let error = match node.kind {
            ExprKind::Literal { .. } if found.is_none() && !self.sources.slice(span).ends_with('%') => {
                ValueError::UnitMissing { span, number: self.sources.slice(span).to_string(), expected }
            }
            ExprKind::Literal { .. } if is_gram_for_gravity(found, expected) => ValueError::GramForGravity { span },
            _ => ValueError::UnitMismatch {
                span,
                found,
                expected: Box::new(expected),
                declared: self.declaration_of(expr, environment),
            },
        };
        self.report(environment, error);
        Stop::Reported
    }

    /// The name that an expression consists of, and where it is declared.
    pub fn declaration_of(&mut self, expr: ExprId, environment: Environment) -> Option<(String, Span)> {
        let node = *self.tree.expr(expr);
        let ExprKind::Name { indices } = node.kind else { return None };
        let word = self.word_of(node.span);
        let symbol = self.words.get(self.sources.slice(word))?;
        let name = self.evaluate_indexed(symbol, indices, environment).ok()?;
        let id: DefinitionId = self.values.get(name)?;
        let definition = &self.definitions[id.0 as usize];
        Some((self.words.display(definition.name), definition.span))
    }

    pub fn as_position(&mut self, value: Value, expr: ExprId, environment: Environment) -> Evaluated<Vector> {
        let span = self.tree.expr(expr).span;
        let Value::Vector(vector) = value else {
            return self.fail(environment, ValueError::Kind { span, needed: "a position", found: "a number" });
        };
        if let Some(found) = vector.dimension.filter(|&found| found != Dimension::LENGTH) {
            return Err(self.mismatch(found, expr, environment, &POSITION));
        }
        self.check_range(&vector.si.x, expr, environment)?;
        self.check_range(&vector.si.y, expr, environment)?;
        Ok(Vector { si: vector.si, dimension: Some(Dimension::LENGTH) })
    }

    /// Checks that a number may be zero, or has a magnitude that binary64 represents in full precision.
    pub fn check_range(&mut self, number: &Number, expr: ExprId, environment: Environment) -> Evaluated<()> {
        let size = match number {
            // Every value of the range.
            Number::Jet(jet) => jet.value.mignitude(),
            _ => number.to_f64().abs(),
        };
        if number.is_finite() && (size >= f64::MIN_POSITIVE || number.may_be_zero()) {
            return Ok(());
        }
        let span = self.tree.expr(expr).span;
        self.fail(environment, ValueError::Overflow { span })
    }
}

/// `9.81 g`: a mass instead of an acceleration.
fn is_gram_for_gravity(found: Dimension, expected: Expected) -> bool {
    found == Dimension::MASS && expected.dimension == Dimension::ACCELERATION
}
