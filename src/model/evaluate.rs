//! Evaluates expressions: literals exactly, names by lookup, and parameters on demand, in whatever order they are
//! declared. See spec.md#units and spec.md#names.
//!
//! The walk recurses over an expression (the parser limits its depth) and over the definitions that it refers to. If both
//! together would get too deep, the walk stops with [`Stop::Deep`], the definitions it is in the middle of wait on a
//! list, and the innermost is evaluated first, from a fresh start: a chain of a million parameters needs no deep stack.

use super::Check;
use super::error::{NameError, PlaceError, ValueError};
use super::overrides;
use super::places::{Frame, FrameId};
use super::scope::{DefinitionId, DefinitionKind, Environment, Role, State};
use super::value::{self, Function, Scalar, Value};
use crate::base::unit::{self, Scale, Unit};
use crate::base::{Dimension, Name, Number, Place, Quantity, Rational, Span, Symbol};
use crate::syntax::tree::{Binary, ExprId, ExprKind, ExprList, FormalKind, Ident};

/// A value, or the reason why there is none.
pub type Evaluated<T> = Result<T, Stop>;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// An error that has been reported.
    Reported,
    /// Definitions that the value depends on have to be evaluated first.
    Deep,
}

/// Levels of expressions and definitions beyond which a walk starts no further definition. One more expression may come
/// on top (256 levels, see syntax::limits); a level takes less than 2 KiB of stack in an unoptimised build.
const MAX_DEPTH: usize = 256;

/// The state of the walk.
#[derive(Debug, Default)]
pub struct Walk {
    pub depth: usize,
    /// Definitions that are being evaluated, each needed by the one before it.
    in_progress: Vec<DefinitionId>,
    /// Whether an index of a `repeat` has been used.
    pub varies: bool,
}

impl<'a> Check<'a> {
    /// The value of an expression.
    pub fn evaluate(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Value> {
        loop {
            self.walk.depth = 0;
            match self.walk(expr, environment) {
                Err(Stop::Deep) => self.evaluate_waiting(),
                done => return done,
            }
        }
    }

    /// Evaluates every parameter, used or not, in order of declaration.
    pub fn evaluate_definitions(&mut self) {
        for index in 0..self.definitions.len() {
            let id = DefinitionId(index as u32);
            if matches!(self.definitions[index].state, State::Unsettled) {
                self.begin(id);
                self.evaluate_waiting();
            }
        }
    }

    /// Evaluates the definitions in progress, the innermost first.
    pub fn evaluate_waiting(&mut self) {
        while let Some(&id) = self.walk.in_progress.last() {
            self.walk.depth = 0;
            // Definitions that have to be evaluated first are now behind this one on the list.
            let _ = self.evaluate_definition(id);
        }
    }

    fn begin(&mut self, id: DefinitionId) {
        self.definitions[id.0 as usize].state = State::InProgress;
        self.walk.in_progress.push(id);
    }

    /// Evaluates the definition at the end of the list, and removes it unless others have to come first.
    fn evaluate_definition(&mut self, id: DefinitionId) -> Evaluated<Value> {
        let definition = &self.definitions[id.0 as usize];
        let (expr, environment, kind) = (definition.expr, definition.environment, definition.kind);
        let result = self.declared_value(expr, environment);
        if matches!(result, Err(Stop::Deep)) {
            return result;
        }
        let result = result.and_then(|value| self.define(id, kind, value));
        self.walk.in_progress.pop();
        self.definitions[id.0 as usize].state = State::Settled(result.clone());
        result
    }

    /// The value of a definition's expression; one that holds in every repetition and at every place is computed once.
    fn declared_value(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Value> {
        if !environment.is_top()
            && let Some(known) = self.memory.values.get(&expr)
        {
            return Ok(known.clone());
        }
        let varies = std::mem::take(&mut self.walk.varies);
        let value = self.walk(expr, environment);
        let holds_everywhere = !std::mem::replace(&mut self.walk.varies, varies);
        if holds_everywhere
            && !environment.is_top()
            && let Ok(value) = &value
        {
            self.memory.values.insert(expr, value.clone());
        }
        value
    }

    /// The value that a definition gives to its name.
    fn define(&mut self, id: DefinitionId, kind: DefinitionKind, value: Value) -> Evaluated<Value> {
        let definition = &self.definitions[id.0 as usize];
        let (expr, environment, role) = (definition.expr, definition.environment, definition.role);
        match (kind, value) {
            (DefinitionKind::Point, value) => self.as_position(value, expr, environment).map(Value::Vector),
            (DefinitionKind::Param, Value::Vector(_)) => {
                let span = self.tree.expr(expr).span;
                self.fail(environment, ValueError::Kind { span, needed: "a number", found: "a point" })
            }
            (DefinitionKind::Param, Value::Scalar(scalar)) => {
                self.check_range(&scalar.quantity.si, expr, environment)?;
                let scalar = match role {
                    Role::Parameter { frame, formal, given } => {
                        self.like_formal(frame, formal, given, scalar, expr, environment)?
                    }
                    Role::Declared | Role::Placing => scalar,
                };
                self.overridden(id, scalar).map(Value::Scalar)
            }
            (DefinitionKind::Let, value) => Ok(value),
        }
    }

    /// The argument for a parameter, in the kind of number that its unit or default declares: a frequency is converted
    /// to cycles or radians, and a bare zero gets the dimension.
    fn like_formal(
        &mut self,
        frame: FrameId,
        formal: u32,
        given: bool,
        scalar: Scalar,
        expr: ExprId,
        environment: Environment,
    ) -> Evaluated<Scalar> {
        let Frame { component: Some(component), inside, .. } = *self.frame(frame) else { return Err(Stop::Reported) };
        let described = self.tree.component(component).formals[formal as usize];
        let FormalKind::Number { unit, .. } = described.kind else { return Ok(scalar) };
        if !given && unit.is_none() {
            return Ok(scalar);
        }
        let Some(like) = self.formal_like(component, formal, inside)? else { return Err(Stop::Reported) };
        overrides::coerce_to(&like, &scalar).or_else(|mismatch| {
            let span = self.tree.expr(expr).span;
            let declared = (self.sources.slice(described.name).to_string(), described.name);
            match (given, unit) {
                (false, Some(unit)) => {
                    let (found, wanted) = (scalar.dimension(), like.quantity.dimension);
                    self.fail(environment, PlaceError::UnlikeUnit { span, unit, found, wanted })
                }
                _ => self.fail(environment, mismatch.error(span, &like).declared_at(declared)),
            }
        })
    }

    pub fn walk(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Value> {
        self.walk.depth += 1;
        let value = self.walk_kind(expr, environment);
        self.walk.depth -= 1;
        value
    }

    fn walk_kind(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Value> {
        let node = *self.tree.expr(expr);
        match node.kind {
            ExprKind::Literal { number_len } => self.literal(node.span, number_len, false, environment),
            ExprKind::Name { indices } => self.name_value(node.span, indices, environment),
            ExprKind::Negate { operand } => self.negation(operand, environment),
            ExprKind::Binary { operator, left, right } => self.binary(node.span, operator, left, right, environment),
            ExprKind::Call { name_len, arguments } => self.call(node.span, name_len, arguments, environment),
            ExprKind::Tuple { items } => self.tuple(node.span, items, environment),
            ExprKind::Member { base, member_len, indices } => match self.place_at(base, environment)? {
                Some(frame) => self.member_value(frame, self.tree.member(base, member_len, indices), environment),
                None => self.motion_as_value(node.span, base, environment),
            },
            ExprKind::At { .. } => self.fail(environment, ValueError::MotionAsValue { span: node.span }),
            ExprKind::Named { .. } => self.fail(environment, ValueError::ArgumentName { span: node.span }),
            ExprKind::Range { .. } => {
                self.fail(environment, ValueError::Kind { span: node.span, needed: "a number", found: "a range" })
            }
            ExprKind::Text => {
                self.fail(environment, ValueError::Kind { span: node.span, needed: "a number", found: "a text" })
            }
        }
    }

    /// The error for a motion in place of a number or, in a scene with places, for a name before a `.` that is not a
    /// place.
    fn motion_as_value<T>(&mut self, span: Span, base: ExprId, environment: Environment) -> Evaluated<T> {
        if let ExprKind::Name { .. } = self.tree.expr(base).kind {
            let word = self.word_of(self.tree.expr(base).span);
            if self.broken_words.contains(self.sources.slice(word)) {
                return Err(Stop::Reported);
            }
        }
        self.fail(environment, ValueError::MotionAsValue { span })
    }

    /// `10 N/m`, or `-12 dB` with `negated`, whose minus sign belongs to the level.
    fn literal(&mut self, span: Span, number_len: u16, negated: bool, environment: Environment) -> Evaluated<Value> {
        let text = self.sources.slice(span);
        let (digits, rest) = text.split_at(usize::from(number_len).min(text.len()));
        let Some(number) = Rational::from_literal(digits, self.literals) else {
            return self.fail(environment, ValueError::Overflow { span });
        };
        let number = if negated { Number::from(-&number) } else { Number::from(number) };
        let unit_text = rest.trim_start();
        if unit_text.is_empty() {
            return Ok(if number.is_zero() {
                Value::Scalar(Scalar::bare_zero())
            } else {
                Quantity::plain(number).into()
            });
        }
        let unit_span = Span::new(span.file(), span.end() - unit_text.len(), span.end());
        let unit = self.unit(unit_text, unit_span, environment)?;
        let (dimension, angle) = (unit.dimension, unit.angle);
        let si = match unit.scale {
            Scale::Linear(factor) => &number * &factor,
            Scale::Decibel => match number.from_decibel() {
                Some(ratio) => ratio,
                None => return self.fail(environment, ValueError::Overflow { span }),
            },
        };
        Ok(Quantity { si, dimension, angle }.into())
    }

    /// The unit with this text, parsed only once.
    pub fn unit(&mut self, text: &'a str, span: Span, environment: Environment) -> Evaluated<Unit> {
        if let Some(unit) = self.units.get(text) {
            return Ok(unit.clone());
        }
        match unit::parse(text) {
            Ok(unit) => {
                self.units.insert(text, unit.clone());
                Ok(unit)
            }
            Err(error) => {
                let error = self.unit_error(text, span, error, environment);
                self.fail(environment, error)
            }
        }
    }

    fn negation(&mut self, operand: ExprId, environment: Environment) -> Evaluated<Value> {
        let node = *self.tree.expr(operand);
        if let ExprKind::Literal { number_len } = node.kind
            && self.sources.slice(node.span).ends_with("dB")
        {
            return self.literal(node.span, number_len, true, environment);
        }
        Ok(value::negate(&self.walk(operand, environment)?))
    }

    fn binary(
        &mut self,
        span: Span,
        operator: Binary,
        left: ExprId,
        right: ExprId,
        environment: Environment,
    ) -> Evaluated<Value> {
        let operation = match operator {
            Binary::Add => value::add,
            Binary::Subtract => value::subtract,
            Binary::Multiply => value::multiply,
            Binary::Divide => value::divide,
            Binary::Power => value::power,
            Binary::Arrow => return self.fail(environment, ValueError::ArrowAsValue { span }),
            _ => return self.fail(environment, ValueError::ComparisonAsValue { span }),
        };
        // Both sides are evaluated, so that mistakes on both sides are reported.
        let a = self.walk(left, environment);
        if a == Err(Stop::Deep) {
            return a;
        }
        let b = self.walk(right, environment)?;
        operation(&a?, &b).or_else(|fault| {
            let (left, right) = (self.tree.expr(left).span, self.tree.expr(right).span);
            self.fail(environment, ValueError::Operation { fault, operator, left, right })
        })
    }

    fn call(&mut self, span: Span, name_len: u16, arguments: ExprList, environment: Environment) -> Evaluated<Value> {
        let word = Span::new(span.file(), span.start(), span.start() + usize::from(name_len));
        let Some(function) = Function::by_name(self.sources.slice(word)) else {
            let error = self.unknown_function(word);
            return self.fail(environment, error);
        };
        let tree = self.tree;
        let given = tree.list(arguments);
        let (least, most) = function.arguments;
        if given.len() < least || given.len() > most {
            let error =
                ValueError::ArgumentCount { span, function: function.name, expected: least, found: given.len() };
            return self.fail(environment, error);
        }
        let mut values = Vec::with_capacity(given.len());
        for &argument in given {
            values.push(self.walk(argument, environment)?);
        }
        let argument = tree.expr(given[0]).span;
        function.apply(&values).or_else(|fault| {
            self.fail(environment, ValueError::Function { fault, function: function.name, argument, span })
        })
    }

    fn tuple(&mut self, span: Span, items: ExprList, environment: Environment) -> Evaluated<Value> {
        let tree = self.tree;
        let &[x, y] = tree.list(items) else {
            return self.fail(environment, ValueError::Components { span, found: tree.list(items).len() });
        };
        let a = self.component(x, environment);
        if let Err(Stop::Deep) = a {
            return Err(Stop::Deep);
        }
        let b = self.component(y, environment)?;
        value::vector(&a?, &b).map(Value::Vector).or_else(|fault| {
            let (left, right) = (tree.expr(x).span, tree.expr(y).span);
            self.fail(environment, ValueError::Pair { fault, left, right })
        })
    }

    fn component(&mut self, expr: ExprId, environment: Environment) -> Evaluated<Scalar> {
        match self.walk(expr, environment)? {
            Value::Scalar(scalar) => Ok(scalar),
            Value::Vector(_) => {
                let span = self.tree.expr(expr).span;
                self.fail(environment, ValueError::Kind { span, needed: "a number", found: "a point" })
            }
        }
    }

    /// The span of a name's word, without its indices.
    pub fn word_of(&self, span: Span) -> Span {
        let text = self.sources.slice(span);
        let len = text.find(['[', ' ', '\t', '\n', '\r']).unwrap_or(text.len());
        Span::new(span.file(), span.start(), span.start() + len)
    }

    fn name_value(&mut self, span: Span, indices: ExprList, environment: Environment) -> Evaluated<Value> {
        let word = if indices.is_empty() { span } else { self.word_of(span) };
        if indices.is_empty() && self.sources.slice(word) == "pi" {
            return Ok(Value::Scalar(Scalar::pi()));
        }
        let Some(symbol) = self.known_symbol(word, environment) else {
            let error = self.unknown_value(Ident { span: word, indices }, None, environment);
            return self.fail_unless_broken(environment, word, error);
        };
        if indices.is_empty()
            && let Some(index) = self.environments.value(environment, symbol)
        {
            self.walk.varies = true;
            return Ok(Quantity::plain(Number::from(i64::from(index))).into());
        }
        let name = self.evaluate_indexed(symbol, indices, environment)?;
        match self.values.get(name) {
            Some(id) => {
                self.walk.varies |= name.place != Place::SCENE;
                self.value_of(id, span, environment)
            }
            None => {
                let error = self.unknown_value(Ident { span: word, indices }, Some(name), environment);
                self.fail_unless_broken(environment, word, error)
            }
        }
    }

    /// The symbol of a word that occurs in the model; within a `repeat` it is cached by its position.
    fn known_symbol(&mut self, word: Span, environment: Environment) -> Option<Symbol> {
        if environment.is_top() {
            return self.words.get(self.sources.slice(word));
        }
        if let Some(&symbol) = self.symbols.get(&word) {
            return Some(symbol);
        }
        let symbol = self.words.get(self.sources.slice(word))?;
        self.symbols.insert(word, symbol);
        Some(symbol)
    }

    /// The value of a definition, evaluated now if necessary.
    pub fn value_of(&mut self, id: DefinitionId, span: Span, environment: Environment) -> Evaluated<Value> {
        let definition = &mut self.definitions[id.0 as usize];
        definition.used = true;
        match &definition.state {
            State::Settled(value) => value.clone(),
            State::InProgress => {
                let error = self.cycle(id, span);
                self.fail(environment, error)
            }
            State::Unsettled => {
                self.begin(id);
                if self.walk.depth > MAX_DEPTH { Err(Stop::Deep) } else { self.evaluate_definition(id) }
            }
        }
    }

    /// The error for a definition that refers to itself: the definitions from `id` on, of which the last one mentions
    /// `id` at `span`.
    fn cycle(&self, id: DefinitionId, span: Span) -> NameError {
        let start = self.walk.in_progress.iter().rposition(|&member| member == id).unwrap_or(0);
        let members = self.walk.in_progress[start..].iter().map(|member| {
            let definition = &self.definitions[member.0 as usize];
            (self.words.display(definition.name), definition.span)
        });
        NameError::Cycle { span, members: members.collect() }
    }

    /// A word with the values of its indices, among the names that the environment sees.
    pub fn evaluate_indexed(&mut self, symbol: Symbol, indices: ExprList, environment: Environment) -> Evaluated<Name> {
        let place = self.place_of(environment);
        if indices.is_empty() {
            return Ok(Name::plain(symbol).in_place(place));
        }
        let tree = self.tree;
        let given = tree.list(indices);
        let mut values = [0; crate::base::name::MAX_INDICES];
        if given.len() > values.len() {
            let span = tree.expr(given[values.len()]).span;
            return self.fail(environment, NameError::TooManyIndices { span });
        }
        for (value, &index) in values.iter_mut().zip(given) {
            *value = self.index(index, environment)?;
        }
        let name = Name::with_indices(symbol, &values[..given.len()]).expect("their number has been checked");
        Ok(name.in_place(place))
    }

    fn index(&mut self, expr: ExprId, environment: Environment) -> Evaluated<i32> {
        if let Some(index) = self.plain_index(expr, environment).and_then(|index| i32::try_from(index).ok()) {
            return Ok(index);
        }
        let value = self.walk(expr, environment)?;
        self.as_whole(&value, expr, environment)
    }

    /// `i`, `i-1`, `2*i+1`: sums and products of indices and whole numbers, evaluated without quantities because a chain
    /// of a million springs has three million of them; `None` for everything else.
    fn plain_index(&mut self, expr: ExprId, environment: Environment) -> Option<i64> {
        let node = *self.tree.expr(expr);
        match node.kind {
            ExprKind::Literal { .. } => self.sources.slice(node.span).parse().ok(),
            ExprKind::Name { indices } if indices.is_empty() => {
                let symbol = self.known_symbol(node.span, environment)?;
                let index = self.environments.value(environment, symbol)?;
                self.walk.varies = true;
                Some(i64::from(index))
            }
            ExprKind::Binary { operator, left, right } => {
                let left = self.plain_index(left, environment)?;
                let right = self.plain_index(right, environment)?;
                match operator {
                    Binary::Add => left.checked_add(right),
                    Binary::Subtract => left.checked_sub(right),
                    Binary::Multiply => left.checked_mul(right),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// The name that an identifier denotes; its word is added to the table of words.
    pub fn name(&mut self, ident: Ident, environment: Environment) -> Evaluated<Name> {
        let symbol = match self.known_symbol(ident.span, environment) {
            Some(symbol) => symbol,
            None => self.words.intern(self.sources.slice(ident.span)),
        };
        loop {
            self.walk.depth = 0;
            match self.evaluate_indexed(symbol, ident.indices, environment) {
                Err(Stop::Deep) => self.evaluate_waiting(),
                done => return done,
            }
        }
    }

    /// A whole number in the range of an index.
    pub fn as_whole(&mut self, value: &Value, expr: ExprId, environment: Environment) -> Evaluated<i32> {
        let whole = self.as_integer(value, expr, environment)?;
        self.as_index(whole, expr, environment)
    }

    pub fn as_index(&mut self, whole: i64, expr: ExprId, environment: Environment) -> Evaluated<i32> {
        let span = self.tree.expr(expr).span;
        i32::try_from(whole).or_else(|_| self.fail(environment, NameError::NotWhole { span }))
    }

    pub fn as_integer(&mut self, value: &Value, expr: ExprId, environment: Environment) -> Evaluated<i64> {
        let span = self.tree.expr(expr).span;
        let Value::Scalar(Scalar { quantity, .. }) = value else {
            return self.fail(environment, ValueError::Kind { span, needed: "a whole number", found: "a point" });
        };
        match quantity.si.exact().and_then(Rational::to_i64) {
            Some(whole) if quantity.dimension == Dimension::NONE => Ok(whole),
            _ => self.fail(environment, NameError::NotWhole { span }),
        }
    }

    /// The span of an identifier, including its indices.
    pub fn ident_span(&self, ident: Ident) -> Span {
        let Some(&last) = self.tree.list(ident.indices).last() else { return ident.span };
        let end = self.tree.expr(last).span.end();
        let rest = self.sources.text(ident.span.file()).get(end..).unwrap_or("");
        let bracket = rest.find(']').map_or(0, |at| at + 1);
        Span::new(ident.span.file(), ident.span.start(), end + bracket)
    }
}
