//! Laws of springs and dampers: `law = 10 N/m * stretch + 2e5 N/m^3 * stretch^3`, or a table. In: the expression. Out:
//! a [`Curve`] in SI, and whether its element acts on rotation, which its dimensions decide: a force over a length, or
//! a torque over an angle. See spec.md#springs-and-dampers.
//!
//! The expression is first listed in postfix order, with the values of all names. Then its dimensions are checked for
//! both readings by the rules of ordinary values: everything that depends on the variable is represented by its
//! dimension and the value 1/2, at which every function is defined.

use super::Check;
use super::error::{LawError, PartError, ValueError};
use super::evaluate::Evaluated;
use super::expect::Expected;
use super::scope::Environment;
use super::tables::{First, TableRequest};
use super::value::{self, Fault, Function, Scalar, Value};
use crate::base::unit::Scale;
use crate::base::{Dimension, Number, Quantity, Rational, Span};
use crate::elements::curve::{self, Curve, Operation, Rows, Step};
use crate::syntax::tree::{Binary, ExprId, ExprKind};
use std::sync::Arc;

/// A law as it was read.
#[derive(Clone, Debug)]
pub struct Read {
    pub curve: Arc<Curve>,
    pub torsional: bool,
}

/// The variable of a law, and its dimension for an element along a line and for a torsional one.
pub struct Reading {
    /// `stretch` or `rate`.
    pub word: &'static str,
    pub over: [Dimension; 2],
}

const FORCES: [Expected; 2] = [
    Expected::new("a force", Dimension::FORCE, "law = 10 N/m * stretch"),
    Expected::new("a torque", Dimension::TORQUE, "law = 3 N*m/rad * stretch"),
];

/// A piece of an expression in postfix order.
#[derive(Clone, Debug)]
enum Node {
    Value(Value),
    Variable,
    Negate,
    Binary(Binary, [Span; 2]),
    /// A function call with its number of arguments and the place of the first one.
    Call(&'static Function, usize, Span),
}

/// A part of the expression with known dimension.
struct Typed {
    value: Value,
    varies: bool,
    /// The index of its first operation.
    start: usize,
}

impl<'a> Check<'a> {
    /// The law that an expression gives.
    pub fn law(&mut self, expr: ExprId, reading: &Reading, environment: Environment) -> Evaluated<Read> {
        if let Some(given) = self.table_of_law(expr) {
            return self.tabulated_law(expr, &given, reading, environment);
        }
        let mut nodes = Vec::new();
        self.law_over = Some(reading.word);
        let listed = self.list_nodes(expr, reading.word, environment, &mut nodes);
        self.law_over = None;
        listed?;
        let readings = reading.over.map(|over| type_expression(&nodes, over));
        let gives = |turns: usize| match &readings[turns] {
            Ok((Value::Scalar(scalar), _)) => scalar.dimension().is_none_or(|found| found == FORCES[turns].dimension),
            _ => false,
        };
        let means_a_torque = match &readings[1] {
            Ok((Value::Scalar(scalar), _)) => readings[0].is_err() && scalar.dimension() != Some(FORCES[0].dimension),
            _ => false,
        };
        let turns = usize::from(!gives(0) && (gives(1) || means_a_torque));
        let [line, turn] = readings;
        match if turns == 0 { line } else { turn } {
            Ok((value, steps)) => {
                self.as_number(&value, expr, environment, &FORCES[turns])?;
                match Curve::new(steps) {
                    Some(curve) => Ok(Read { curve: Arc::new(curve), torsional: turns == 1 }),
                    None => self.not_a_law(expr, environment),
                }
            }
            Err(error) => self.fail(environment, error),
        }
    }

    fn not_a_law<T>(&mut self, expr: ExprId, environment: Environment) -> Evaluated<T> {
        let span = self.tree.expr(expr).span;
        self.fail(environment, ValueError::Kind { span, needed: "a law", found: "a point" })
    }

    fn list_nodes(
        &mut self,
        expr: ExprId,
        word: &'static str,
        environment: Environment,
        nodes: &mut Vec<(Node, Span)>,
    ) -> Evaluated<()> {
        let tree = self.tree;
        let node = *tree.expr(expr);
        let made = match node.kind {
            ExprKind::Name { indices } if indices.is_empty() && self.sources.slice(node.span) == word => Node::Variable,
            ExprKind::Negate { operand } if !matches!(tree.expr(operand).kind, ExprKind::Literal { .. }) => {
                self.list_nodes(operand, word, environment, nodes)?;
                Node::Negate
            }
            ExprKind::Binary { operator, left, right }
                if matches!(
                    operator,
                    Binary::Add | Binary::Subtract | Binary::Multiply | Binary::Divide | Binary::Power
                ) =>
            {
                self.list_nodes(left, word, environment, nodes)?;
                self.list_nodes(right, word, environment, nodes)?;
                Node::Binary(operator, [tree.expr(left).span, tree.expr(right).span])
            }
            ExprKind::Call { name_len, arguments } => {
                let name = Span::new(node.span.file(), node.span.start(), node.span.start() + usize::from(name_len));
                let given = tree.list(arguments);
                let Some(function) = Function::by_name(self.sources.slice(name)) else {
                    let error = self.unknown_function(name);
                    return self.fail(environment, error);
                };
                let (least, most) = function.arguments;
                if given.len() < least || given.len() > most {
                    let (expected, found) = (least, given.len());
                    let error = ValueError::ArgumentCount { span: node.span, function: function.name, expected, found };
                    return self.fail(environment, error);
                }
                for &argument in given {
                    self.list_nodes(argument, word, environment, nodes)?;
                }
                Node::Call(function, given.len(), tree.expr(given[0]).span)
            }
            _ => match self.evaluate(expr, environment)? {
                Value::Vector(_) => {
                    let error = ValueError::Kind { span: node.span, needed: "a number", found: "a point" };
                    return self.fail(environment, error);
                }
                value => Node::Value(value),
            },
        };
        nodes.push((made, node.span));
        Ok(())
    }

    /// The arguments of a law that is a table.
    fn table_of_law(&self, expr: ExprId) -> Option<Vec<ExprId>> {
        let node = *self.tree.expr(expr);
        let ExprKind::Call { name_len, arguments } = node.kind else { return None };
        let start = node.span.start();
        let name = self.sources.slice(Span::new(node.span.file(), start, start + usize::from(name_len)));
        (name == "table").then(|| self.tree.list(arguments).to_vec())
    }

    /// `table("law.csv", 1 mm, 1 N)`, or with both units in its heading.
    fn tabulated_law(
        &mut self,
        call: ExprId,
        given: &[ExprId],
        reading: &Reading,
        environment: Environment,
    ) -> Evaluated<Read> {
        let arguments = LawError::TableArguments { span: self.tree.expr(call).span };
        let Some(&file) = given.first() else { return self.fail(environment, arguments) };
        let named = self.tree.expr(file).span;
        if !matches!(self.tree.expr(file).kind, ExprKind::Text) || !matches!(given.len(), 1 | 3) {
            return self.fail(environment, arguments);
        }
        let mut units = Vec::new();
        for &unit in &given[1..] {
            let span = self.tree.expr(unit).span;
            match self.evaluate(unit, environment)? {
                Value::Scalar(Scalar { quantity, bare_zero: false, .. }) if !quantity.si.may_be_zero() => {
                    units.push((unit, quantity, span));
                }
                _ => return self.fail(environment, PartError::TableUnitZero { span }),
            }
        }
        let text = self.sources.slice(named).trim_matches('"').to_string();
        let Some(table) = self.sources.table(named.file(), &text) else {
            return self.fail(environment, LawError::TableNotGiven { span: named });
        };
        let heading = self.heading(table);
        let in_heading = heading.as_ref().and_then(|heading| heading.values.unit.as_ref());
        let dimension = units.get(1).map(|unit| unit.1.dimension).or(in_heading.map(|unit| unit.dimension));
        let turns = usize::from(dimension == Some(FORCES[1].dimension));
        let (over, read) = (reading.over[turns], &FORCES[turns]);
        if let Some((unit, quantity, _)) = units.first()
            && quantity.dimension != over
        {
            let (unit, found) = (*unit, quantity.dimension);
            let noun = if reading.word == "stretch" { "a stretch" } else { "a rate" };
            let example = if reading.word == "stretch" { "1 mm" } else { "1 m/s" };
            return Err(self.mismatch(found, unit, environment, &Expected::new(noun, over, example)));
        }
        let unit = match units.get(1) {
            Some((unit, _, span)) => Some((self.number(*unit, environment, read)?, *span)),
            None => None,
        };
        let own = heading.as_ref().and_then(|heading| Some((heading.first.unit.clone()?, heading.first.span)));
        if units.is_empty() && (own.is_none() || in_heading.is_none()) {
            return self.fail(environment, arguments);
        }
        if let Some((first, span)) = own.as_ref().filter(|(first, _)| units.is_empty() && first.dimension != over) {
            let (span, found) = (*span, first.dimension);
            return self.fail(environment, LawError::TableFirst { span, named, found, over });
        }
        if let (Some((unit, span)), Some((_, given, at))) = (&own, units.first())
            && !matches!(&unit.scale, Scale::Linear(factor) if unit.dimension == over && *factor == given.si)
        {
            return self.fail(environment, PartError::TableUnitsDiffer { span: *at, heading: *span });
        }
        let asked = TableRequest { named, unit, first: First::Variable(over), read };
        let rows = self.table_rows(table, &asked, environment)?;
        let factor = match (&own, units.first()) {
            (None, Some((_, quantity, _))) => quantity.si.clone(),
            _ => Number::ONE,
        };
        let x = rows.times.iter().map(|x| x * &factor).collect();
        let Some(rows) = Rows::new(x, rows.values.clone()) else {
            return self.fail(environment, LawError::TableUndecided { span: named });
        };
        let steps = [Operation::Variable, Operation::Table(Arc::new(rows))];
        let steps = steps.map(|operation| Step { operation, span: named });
        match Curve::new(steps.into()) {
            Some(curve) => Ok(Read { curve: Arc::new(curve), torsional: turns == 1 }),
            None => self.fail(environment, arguments),
        }
    }
}

/// The value of an expression with the variable in a dimension, and its operations.
fn type_expression(nodes: &[(Node, Span)], over: Dimension) -> Result<(Value, Vec<Step>), ValueError> {
    let mut steps: Vec<Step> = Vec::new();
    let mut stack: Vec<Typed> = Vec::new();
    for (node, span) in nodes {
        let count = match node {
            Node::Value(_) | Node::Variable => 0,
            Node::Negate => 1,
            Node::Binary(..) => 2,
            Node::Call(_, count, _) => *count,
        };
        let operands = stack.split_off(stack.len().saturating_sub(count));
        let varies = matches!(node, Node::Variable) || operands.iter().any(|operand| operand.varies);
        let start = operands.first().map_or(steps.len(), |operand| operand.start);
        let (value, operation) = apply(node, *span, &operands, over)?;
        if varies {
            steps.push(Step { operation, span: *span });
        } else {
            steps.truncate(start);
            let Value::Scalar(scalar) = &value else { continue };
            steps.push(Step { operation: Operation::Constant(scalar.quantity.si.clone()), span: *span });
        }
        stack.push(Typed { value: if varies { stand_in(value) } else { value }, varies, start });
    }
    let value = stack.pop().map_or(Value::Scalar(Scalar::bare_zero()), |typed| typed.value);
    Ok((value, steps))
}

/// The value 1/2 with the same dimension.
fn stand_in(value: Value) -> Value {
    match value {
        Value::Scalar(mut scalar) => {
            scalar.quantity.si = Number::from(Rational::new(1, 2));
            scalar.bare_zero = false;
            Value::Scalar(scalar)
        }
        vector => vector,
    }
}

fn apply(node: &Node, span: Span, operands: &[Typed], over: Dimension) -> Result<(Value, Operation), ValueError> {
    Ok(match node {
        Node::Value(value) => (value.clone(), Operation::Variable),
        Node::Variable => {
            (stand_in(Quantity { dimension: over, ..Quantity::plain(Number::ONE) }.into()), Operation::Variable)
        }
        Node::Negate => (value::negate(&operands[0].value), Operation::Negate),
        Node::Binary(operator, [left, right]) => {
            let (a, b) = (&operands[0], &operands[1]);
            let found = match operator {
                Binary::Add => value::add(&a.value, &b.value),
                Binary::Subtract => value::subtract(&a.value, &b.value),
                Binary::Multiply => value::multiply(&a.value, &b.value),
                Binary::Divide => value::divide(&a.value, &b.value),
                _ if b.varies && has_dimension(&a.value) => Err(Fault::Exponent),
                _ => value::power(&a.value, &b.value),
            };
            let operation = match operator {
                Binary::Add => Operation::Add,
                Binary::Subtract => Operation::Subtract,
                Binary::Multiply => Operation::Multiply,
                Binary::Divide => Operation::Divide,
                _ => Operation::Power,
            };
            let (left, right, operator) = (*left, *right, *operator);
            (found.map_err(|fault| ValueError::Operation { fault, operator, left, right })?, operation)
        }
        Node::Call(function, count, argument) => {
            let values: Vec<Value> = operands.iter().map(|operand| operand.value.clone()).collect();
            let failed = |fault| ValueError::Function { fault, function: function.name, argument: *argument, span };
            let value = function.apply(&values).map_err(failed)?;
            let known = curve::Function::by_name(function.name);
            (value, known.map_or(Operation::Negate, |function| Operation::Call(function, *count)))
        }
    })
}

fn has_dimension(value: &Value) -> bool {
    matches!(value, Value::Scalar(scalar) if !scalar.quantity.dimension.is_none())
}
