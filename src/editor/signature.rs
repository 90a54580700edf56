//! The function or component whose arguments are being typed: its form, its meaning, and the current argument.

use super::document::Document;
use super::project::{At, Project};
use super::roles::{Role, Space};
use super::tokens::TokenKind;
use crate::kinds::functions::{self, Function};
use std::ops::Range;

/// A function or a component at a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signature {
    /// `step(a, at)`
    pub form: String,
    pub meaning: String,
    /// The bytes of each argument in the form.
    pub arguments: Vec<Range<usize>>,
    /// The index of the current argument; `None` if all are given.
    pub argument: Option<usize>,
}

/// The innermost call of a known function, or the component of a place, that is open at a place.
pub fn signature(document: &Document, project: &Project, offset: usize) -> Option<Signature> {
    let before = document.tokens.partition_point(|token| token.range.end <= offset);
    let (mut depth, mut argument) = (0usize, 0);
    for token in (0..before).rev() {
        match (document.tokens[token].kind, document.token_text(token)) {
            (TokenKind::LineEnd, _) if depth == 0 && !in_place(document, token) => return None,
            (TokenKind::Close, _) => depth += 1,
            (TokenKind::Open, "(") if depth == 0 => {
                let name = token.checked_sub(1)?;
                if matches!(document.roles[name], Role::Reference { space: Space::Components, .. }) {
                    return of_component(document, project, name, before);
                }
                match functions::function(document.token_text(name)) {
                    Some((_, function)) => return Some(of_function(function, argument)),
                    // Brackets of a position or of a sum: the call around them is what matters.
                    None => argument = 0,
                }
            }
            (TokenKind::Open, _) if depth == 0 => return None,
            (TokenKind::Open, _) => depth -= 1,
            (TokenKind::Sign, ",") if depth == 0 => argument += 1,
            _ => {}
        }
    }
    None
}

/// Whether a line end stands in the brackets of a `place`, which may take several lines.
fn in_place(document: &Document, token: usize) -> bool {
    document.statement_of(token).is_some_and(|statement| document.keyword(statement) == "place")
}

fn of_function(function: &Function, argument: usize) -> Signature {
    let form = function.form;
    let mut arguments = Vec::new();
    if let (Some(open), Some(close)) = (form.find('('), form.rfind(')')) {
        let mut at = open + 1;
        for argument in form[open + 1..close].split(',') {
            let start = at + (argument.len() - argument.trim_start().len());
            arguments.push(start..start + argument.trim().len());
            at += argument.len() + 1;
        }
    }
    let meaning = format!("{}, such as {}", function.meaning, function.example);
    Signature { form: form.into(), meaning, arguments, argument: Some(argument) }
}

/// `axle(m: kg, k = 150 kN/m)`; the current argument is the one that is named, or the first that is not given.
fn of_component(document: &Document, project: &Project, name: usize, before: usize) -> Option<Signature> {
    let component = project.body_of(&project.component(0, document.token_text(name))?)?;
    let lexed = project.lexed_text(component.0);
    let mut form = format!("{}(", document.token_text(name));
    let (mut words, mut arguments) = (Vec::new(), Vec::new());
    for formal in project.formals(component) {
        if !arguments.is_empty() {
            form += ", ";
        }
        let start = form.len();
        form += &lexed.text()[formal.range].split_whitespace().collect::<Vec<_>>().join(" ");
        arguments.push(start..form.len());
        words.push(lexed.token_text(formal.name));
    }
    form.push(')');
    let is_field = |token: &usize| document.roles[*token] == Role::Field;
    let given: Vec<&str> = (name..before).filter(is_field).map(|token| document.token_text(token)).collect();
    let last_comma = (name..before).rev().find(|token| document.token_text(*token) == "," || *token == name + 1)?;
    let named = (last_comma..before).find(is_field).map(|token| document.token_text(token));
    let argument = match named {
        Some(word) => words.iter().position(|known| *known == word),
        None => words.iter().position(|known| !given.contains(known)),
    };
    Some(Signature { form, meaning: lexed.doc(component.1), arguments, argument })
}

/// The parameters and ports that a `place` around a token does not give yet.
pub fn missing_arguments(document: &Document, project: &Project, statement: usize) -> Vec<(At, String)> {
    let Some(component) = project.placed_component(0, statement) else { return Vec::new() };
    let lexed = project.lexed_text(component.0);
    let tokens = document.outline.statements[statement].tokens.clone();
    let given: Vec<&str> =
        tokens.filter(|token| document.roles[*token] == Role::Field).map(|token| document.token_text(token)).collect();
    let formals = project.formals(component).into_iter();
    formals
        .filter(|formal| !given.contains(&lexed.token_text(formal.name)))
        .map(|formal| (At { file: component.0, token: formal.name }, lexed.text()[formal.range].to_string()))
        .collect()
}
