//! Names: where they are declared and used, and what they may be renamed to. See spec.md#names.

use super::document::Document;
use super::roles::{Role, Space};
use crate::model::is_reserved;
use crate::syntax::words;
use std::ops::Range;

/// The name that contains a byte.
pub fn name_at(document: &Document, offset: usize) -> Option<usize> {
    document.token_at(offset).filter(|token| document.roles[*token].name().is_some())
}

/// The tokens of one name: only declarations, or all places. Names with indices are one name: `m[1]` and `m[i]`.
fn places(document: &Document, name: usize, declarations_only: bool) -> Vec<usize> {
    let (word, key) = (document.token_text(name), document.roles[name].name());
    let same = |token: &usize| {
        let role = document.roles[*token];
        let wanted = matches!(role, Role::Declaration { .. }) || !declarations_only;
        wanted && role.name() == key && document.token_text(*token) == word
    };
    (0..document.tokens.len()).filter(same).collect()
}

fn ranges(document: &Document, tokens: Vec<usize>) -> Vec<Range<usize>> {
    tokens.into_iter().map(|token| document.tokens[token].range.clone()).collect()
}

/// The declarations of the name at a token.
pub fn declarations(document: &Document, name: usize) -> Vec<Range<usize>> {
    ranges(document, places(document, name, true))
}

/// The places of a name, with or without its declarations.
pub fn references(document: &Document, name: usize, with_declarations: bool) -> Vec<Range<usize>> {
    let declares = |token: &usize| matches!(document.roles[*token], Role::Declaration { .. });
    let all = places(document, name, false);
    ranges(document, all.into_iter().filter(|token| with_declarations || !declares(token)).collect())
}

/// The ranges to change for a new name; an error says why it cannot be used.
pub fn rename(document: &Document, name: usize, new: &str) -> Result<Vec<Range<usize>>, String> {
    let Some((space, scope)) = document.roles[name].name() else { return Err("there is no name here".into()) };
    // Names after the name of a place, here and in other files, cannot be found by words alone.
    let in_component = scope.is_some_and(|scope| document.keyword(scope) == "component");
    if in_component || matches!(space, Space::Places | Space::Components) {
        return Err("names of components and in them are not renamed: places in other files may refer to them".into());
    }
    if places(document, name, true).is_empty() {
        return Err(format!("`{}` is not declared in this file", document.token_text(name)));
    }
    if !is_word(new) {
        return Err(format!("`{new}` is not a name: names start with a letter and consist of letters, digits and `_`"));
    }
    let reserved = match space {
        Space::Values => is_reserved(new),
        Space::Parts => new == "ground",
        Space::Places => new == "ground" || is_reserved(new),
        Space::Components => false,
    };
    if reserved {
        return Err(format!("`{new}` is a word of the language"));
    }
    let taken = |token: usize| {
        let role = document.roles[token];
        // An index is known only in its `repeat`, but no other value may have its name there.
        let same_space = role.name().is_some_and(|(other, _)| other == space);
        matches!(role, Role::Declaration { .. }) && same_space && document.token_text(token) == new
    };
    let index_again = |token: usize| scope.is_some() && document.roles[token].name() != document.roles[name].name();
    let clash = (0..document.tokens.len()).find(|token| taken(*token) && (scope.is_none() || index_again(*token)));
    match clash {
        Some(_) if new != document.token_text(name) => Err(format!("`{new}` is declared already")),
        _ => Ok(references(document, name, true)),
    }
}

pub fn is_word(text: &str) -> bool {
    let mut letters = text.chars();
    letters.next().is_some_and(words::is_letter) && letters.all(|c| words::is_letter(c) || c.is_ascii_digit())
}

/// The declared names of a space, each once, in order of declaration, by the token of the first declaration.
pub fn declared(document: &Document, space: Space) -> Vec<usize> {
    let mut seen: Vec<&str> = Vec::new();
    let mut list = Vec::new();
    for (token, role) in document.roles.iter().enumerate() {
        let global = *role == Role::Declaration { space, scope: None };
        if global && !seen.contains(&document.token_text(token)) {
            seen.push(document.token_text(token));
            list.push(token);
        }
    }
    list
}
