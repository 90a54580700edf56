//! The ports, parameters and defaults that a place gives to its component. In: the brackets of a `place` and those of
//! the `component`. Out: ports, and parameters as definitions; or the errors in the arguments. See
//! spec.md#places-of-components.

use super::Check;
use super::error::PlaceError;
use super::evaluate::{Evaluated, Stop};
use super::places::{Frame, FrameId, Port};
use super::scope::{self, Definition, DefinitionId, DefinitionKind, Environment, Group, Role, State};
use super::suggestion::nearest;
use super::value::{Scalar, Value};
use crate::base::{Name, Number, Quantity, Span, Symbol};
use crate::syntax::tree::{ExprId, FieldValue, Fields, Formal, FormalKind};
use std::sync::Arc;

/// The brackets of a `place`, evaluated once for all repetitions of a `repeat`.
#[derive(Clone, Debug)]
pub struct Brackets {
    pub component: u32,
    formals: Arc<[Bound]>,
}

/// A port or parameter, and the expression that it is bound to.
#[derive(Clone, Copy, Debug)]
struct Bound {
    /// Its number in the component's brackets.
    formal: u32,
    symbol: Symbol,
    name: Span,
    to: To,
}

#[derive(Clone, Copy, Debug)]
enum To {
    Port(ExprId),
    /// The argument of the place.
    Given(ExprId),
    /// The default of the component.
    Default(ExprId),
}

impl<'a> Check<'a> {
    /// The component that a `place` names, and its arguments. Errors in them are reported once, and then nothing in the
    /// component is checked.
    pub fn brackets(&mut self, word: Span, arguments: Fields, environment: Environment) -> Evaluated<Brackets> {
        if let Some(known) = self.memory.brackets.get(&word) {
            return known.clone();
        }
        let brackets = match self.component_named(word, environment) {
            Some(component) => self.read_brackets(component, word, arguments, environment),
            None => Err(Stop::Reported),
        };
        self.memory.brackets.insert(word, brackets.clone());
        brackets
    }

    fn read_brackets(
        &mut self,
        component: u32,
        word: Span,
        arguments: Fields,
        environment: Environment,
    ) -> Evaluated<Brackets> {
        let tree = self.tree;
        let formals = &tree.component(component).formals;
        let name = || self.sources.slice(tree.component(component).name).to_string();
        let mut given: Vec<Option<(Span, ExprId)>> = vec![None; formals.len()];
        let mut errors = Vec::new();
        for field in tree.fields(arguments) {
            let text = self.sources.slice(field.key);
            let FieldValue::Expr(expr) = field.value else { continue };
            match formals.iter().position(|formal| self.sources.slice(formal.name) == text) {
                Some(index) => match given[index] {
                    None => given[index] = Some((field.key, expr)),
                    Some((first, _)) => {
                        errors.push(PlaceError::ArgumentTwice { span: field.key, first, word: text.to_string() });
                    }
                },
                None => {
                    let known = || formals.iter().map(|formal| self.sources.slice(formal.name));
                    let suggestion = nearest(text, known()).map(str::to_string);
                    let known = known().map(str::to_string).collect();
                    let (span, word, component) = (field.key, text.to_string(), name());
                    errors.push(PlaceError::UnknownArgument { span, word, component, suggestion, known });
                }
            }
        }
        let lacks = |(formal, given): &(&Formal, &Option<_>)| {
            let has_default = matches!(formal.kind, FormalKind::Number { default: Some(_), .. });
            given.is_none() && !has_default
        };
        let missing: Vec<&Formal> = formals.iter().zip(&given).filter(lacks).map(|(formal, _)| formal).collect();
        // A word that is spelt wrongly is missing too: that is one mistake.
        if !missing.is_empty() && errors.is_empty() {
            let example = missing.iter().map(|formal| {
                let word = self.sources.slice(formal.name);
                match formal.kind {
                    FormalKind::Port => format!("{word} = ground"),
                    FormalKind::Number { unit, .. } => {
                        let unit = unit.map_or("1", |unit| self.sources.slice(unit));
                        if unit == "1" { format!("{word} = 1") } else { format!("{word} = 1 {unit}") }
                    }
                }
            });
            let example = example.collect::<Vec<_>>().join(", ");
            let missing = missing.iter().map(|formal| (self.sources.slice(formal.name).to_string(), formal.name));
            errors.push(PlaceError::MissingArguments {
                span: word,
                component: name(),
                missing: missing.collect(),
                example,
            });
        }
        let broken = !errors.is_empty();
        for error in errors {
            self.report(environment, error);
        }
        if broken {
            return Err(Stop::Reported);
        }
        let bound = (0..).zip(formals.iter().zip(given)).filter_map(|(number, (formal, given))| {
            let given = given.map(|(_, expr)| expr);
            let to = match (formal.kind, given) {
                (FormalKind::Port, given) => To::Port(given?),
                (FormalKind::Number { .. }, Some(given)) => To::Given(given),
                (FormalKind::Number { default, .. }, None) => To::Default(default?),
            };
            let symbol = self.words.intern(self.sources.slice(formal.name));
            Some(Bound { formal: number, symbol, name: formal.name, to })
        });
        Ok(Brackets { component, formals: bound.collect() })
    }

    /// Ties the ports of a place and declares its parameters.
    pub fn bind(&mut self, frame: FrameId, brackets: &Brackets) {
        let Frame { outer, inside, place, .. } = *self.frame(frame);
        let group = Group::of_component(brackets.component);
        for &Bound { formal, symbol, name: span, to } in &*brackets.formals {
            let name = Name::plain(symbol).in_place(place);
            // Duplicate names were reported for the component.
            let (expr, environment, given) = match to {
                To::Port(argument) => {
                    let port = scope::Part::Port(self.ports.len() as u32);
                    if self.parts.declare(group, name, port).is_ok() {
                        self.ports.push(Port::tie(outer, argument, span));
                    }
                    continue;
                }
                To::Given(expr) => (expr, outer, true),
                To::Default(expr) => (expr, inside, false),
            };
            let id = DefinitionId(self.definitions.len() as u32);
            if self.values.declare(group, name, id).is_ok() {
                let role = Role::Parameter { frame, formal, given };
                let (kind, state) = (DefinitionKind::Param, State::Unsettled);
                self.definitions.push(Definition { kind, name, span, expr, environment, state, used: false, role });
            }
        }
    }

    /// The number that a parameter of a component is like: of its unit, or of its default.
    pub fn formal_like(&mut self, component: u32, formal: u32, inside: Environment) -> Evaluated<Option<Scalar>> {
        if let Some(known) = self.formals_like.get(&(component, formal)) {
            return known.clone();
        }
        let described = self.tree.component(component).formals[formal as usize];
        let FormalKind::Number { unit, default } = described.kind else { return Ok(None) };
        let like = match (unit, default) {
            (Some(unit), _) => self.of_unit(unit, inside).map(Some),
            (None, Some(default)) => match self.walk(default, inside) {
                Err(Stop::Deep) => return Err(Stop::Deep),
                Ok(Value::Scalar(scalar)) => Ok(Some(scalar)),
                // Reported where the default is used.
                Ok(Value::Vector(_)) | Err(Stop::Reported) => Ok(None),
            },
            (None, None) => Err(Stop::Reported),
        };
        self.formals_like.insert((component, formal), like.clone());
        like
    }

    /// The value 1 in a unit that is written in the brackets of a component.
    fn of_unit(&mut self, span: Span, environment: Environment) -> Evaluated<Scalar> {
        let text: &'a str = self.sources.slice(span);
        if text == "1" {
            return Ok(Scalar::new(Quantity::plain(Number::ONE)));
        }
        let per = text.starts_with('/');
        let text = text.trim_start_matches('/');
        let unit = self.unit(text, Span::new(span.file(), span.end() - text.len(), span.end()), environment)?;
        let dimension = if per { unit.dimension.pow(-1, 1).ok_or(Stop::Reported)? } else { unit.dimension };
        Ok(Scalar::new(Quantity { si: Number::ONE, dimension, angle: unit.angle }))
    }
}
