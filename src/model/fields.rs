//! Fields in braces: each at most once, none unknown. In: the fields of a declaration. Out: the field of a given name, or
//! all of them by their place in the table of kinds. See spec.md.

use super::Check;
use super::error::NameError;
use super::evaluate::{Evaluated, Stop};
use super::expect::Expected;
use super::scope::Environment;
use super::suggestion::nearest;
use crate::base::{self, Number, Span};
use crate::syntax::tree::{ExprId, Field, FieldValue, Fields};

/// Upper bound on the number of fields of a declaration.
const MOST: usize = 8;

/// The fields of one declaration, in the order of the table.
#[derive(Clone, Copy, Debug)]
pub struct Given<'a> {
    table: &'static [base::Field],
    fields: [Option<&'a Field>; MOST],
    /// Whether a field could not be read; a missing field is then not reported.
    pub broken: bool,
}

impl<'a> Given<'a> {
    /// The field at this place of the table.
    pub fn get(&self, place: usize) -> Option<&'a Field> {
        self.fields[place]
    }

    /// The field of this name, with its entry in the table; `None` if it is not given, or not in the table.
    pub fn by_name(&self, name: &str) -> Option<(&'a Field, &'static base::Field)> {
        let place = self.table.iter().position(|field| field.name == name)?;
        Some((self.fields[place]?, &self.table[place]))
    }
}

impl<'a> Check<'a> {
    /// Sorts the fields by the table; reports unknown fields and fields that are given twice.
    pub fn fields(&mut self, fields: Fields, table: &'static [base::Field], environment: Environment) -> Given<'a> {
        let tree = self.tree;
        let mut given = Given { table, fields: [None; MOST], broken: false };
        for field in tree.fields(fields) {
            let word = self.sources.slice(field.key);
            let error = match table.iter().position(|known| known.name == word) {
                None if self.is_direction_of(word, given.fields[..].iter().flatten()) => {
                    NameError::DirectionApart { span: field.key, word: word.to_string() }
                }
                None => self.unknown_field(field, word, table),
                Some(place) => match given.fields[place] {
                    None => {
                        given.fields[place] = Some(field);
                        continue;
                    }
                    Some(first) => NameError::FieldTwice { span: field.key, first: first.key, word: word.to_string() },
                },
            };
            given.broken = true;
            self.report(environment, error);
        }
        given
    }

    /// Whether a word is the second direction of `moves x, y`.
    fn is_direction_of<'b>(&self, word: &str, mut given: impl Iterator<Item = &'b &'b Field>) -> bool {
        matches!(word, "x" | "y") && given.any(|field| matches!(field.value, FieldValue::Moves { .. }))
    }

    fn unknown_field(&self, field: &Field, word: &str, table: &'static [base::Field]) -> NameError {
        let known: Vec<&str> = table.iter().map(|field| field.name).collect();
        let suggestion = nearest(word, known.iter().copied());
        NameError::UnknownField { span: field.key, word: word.to_string(), suggestion, known }
    }

    /// The expression of `name = expression`.
    pub fn field_expr(&mut self, field: &Field, environment: Environment) -> Evaluated<ExprId> {
        match field.value {
            FieldValue::Expr(expr) => Ok(expr),
            FieldValue::About(list) => {
                let span = self.tree.expr(self.tree.about_parts(list).1).span;
                self.fail(environment, NameError::AboutElsewhere { span })
            }
            FieldValue::Flag | FieldValue::Moves { .. } | FieldValue::MovesAlong(_) => {
                let word = self.sources.slice(field.key).to_string();
                self.fail(environment, NameError::FieldWithoutValue { span: field.key, word })
            }
        }
    }

    /// The number of `name = number`; `None` without the field.
    pub fn field_number(
        &mut self,
        field: Option<&Field>,
        environment: Environment,
        expected: &Expected,
    ) -> Evaluated<Option<(Number, Span)>> {
        let Some(field) = field else { return Ok(None) };
        let expr = self.field_expr(field, environment)?;
        let number = self.number(expr, environment, expected)?;
        Ok(Some((number, self.tree.expr(expr).span)))
    }

    /// A word alone, such as `turns`.
    pub fn flag(&mut self, field: Option<&Field>, environment: Environment) -> Evaluated<bool> {
        match field.map(|field| (field.value, field.key)) {
            None => Ok(false),
            Some((FieldValue::Flag, _)) => Ok(true),
            Some((_, span)) => {
                let word = self.sources.slice(span).to_string();
                self.report(environment, NameError::FlagWithValue { span, word });
                Err(Stop::Reported)
            }
        }
    }
}
