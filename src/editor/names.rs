//! Names: their declarations, their uses, and their possible new names. See spec.md#names and spec.md#components.

use super::lexed::Lexed;
use super::project::{At, Meaning, Project};
use super::roles::{Role, Space};
use crate::kinds::motions::is_motion;
use crate::model::is_reserved;
use crate::syntax::words;

/// The name that contains a byte of the file that is asked about.
pub fn name_at(project: &Project, offset: usize) -> Option<At> {
    let token = project.lexed_text(0).token_at(offset)?;
    Some(At { file: 0, token }).filter(|at| project.is_name(*at))
}

/// The declarations of a name.
pub fn declarations(project: &Project, name: At) -> Vec<At> {
    let Some(meaning) = project.meaning(name) else { return Vec::new() };
    project.declarations(&meaning).iter().map(|token| At { file: meaning.file, token: *token }).collect()
}

/// The places of a name in every file, with or without its declarations. Names with indices are one name: `m[1]` and `m[i]`.
pub fn references(project: &Project, name: At, with_declarations: bool) -> Vec<At> {
    let Some(meaning) = project.meaning(name) else { return Vec::new() };
    let mut all = Vec::new();
    for (file, of) in project.files.iter().enumerate() {
        let wanted = |token: &usize| {
            let declares = matches!(of.lexed.roles[*token], Role::Declaration { .. });
            (with_declarations || !declares) && of.lexed.token_text(*token) == meaning.word
        };
        let places = (0..of.lexed.tokens.len()).filter(wanted).map(|token| At { file, token });
        all.extend(places.filter(|at| project.meaning(*at) == Some(meaning)));
    }
    all
}

/// The places to change for a new name, or the reason why it cannot be used.
pub fn rename(project: &Project, name: At, new: &str) -> Result<Vec<At>, String> {
    let Some(meaning) = project.meaning(name) else { return Err("there is no name here".into()) };
    if !project.is_declared(&meaning) {
        return Err(format!("`{}` is not declared in the files that are open", meaning.word));
    }
    if project.files[meaning.file].is_of_program() {
        return Err(format!("`{}` is part of the program, which is not changed here", meaning.word));
    }
    if !is_word(new) {
        return Err(format!("`{new}` is not a name: names start with a letter and consist of letters, digits and `_`"));
    }
    if is_taken_by_language(project, &meaning, new) {
        return Err(format!("`{new}` is a word of the language"));
    }
    if new != meaning.word && clashes(project, &meaning, new) {
        return Err(format!("`{new}` is declared already"));
    }
    Ok(references(project, name, true))
}

fn is_taken_by_language(project: &Project, meaning: &Meaning, new: &str) -> bool {
    // From outside, `front.x` would have two meanings.
    let in_component = home(project.lexed_text(meaning.file), meaning.scope).is_some() && is_motion(new);
    match meaning.space {
        Space::Values => is_reserved(new),
        Space::Parts => new == "ground" || in_component,
        Space::Places => new == "ground" || is_reserved(new) || in_component,
        Space::Components => false,
    }
}

/// The component to which the names of a `repeat` or component belong; `None` for the scene.
fn home(lexed: &Lexed, scope: Option<usize>) -> Option<usize> {
    lexed.component_around(scope?)
}

/// Whether a name would have two meanings.
fn clashes<'a>(project: &Project<'a>, meaning: &Meaning<'a>, new: &str) -> bool {
    if meaning.space == Space::Components {
        // The new name must not be known where the old name is known.
        let knows = |file: &usize| project.component(*file, meaning.word) == Some(*meaning);
        let known = |file: usize| {
            project.components(file).iter().any(|at| project.lexed_text(at.file).token_text(at.token) == new)
        };
        return (0..project.files.len()).filter(knows).any(known);
    }
    let lexed = project.lexed_text(meaning.file);
    let own_home = home(lexed, meaning.scope);
    let head = own_home.map(|component| lexed.outline.statements[component].tokens.clone());
    // Ports and parameters are given by name at a place, so they have one name space.
    let in_head = |token: &usize| head.as_ref().is_some_and(|head| head.contains(token));
    let is_formal = project.declarations(meaning).iter().any(in_head);
    let rival = |token: usize| {
        let Role::Declaration { space, scope } = lexed.roles[token] else { return false };
        let same_space = space == meaning.space
            || space == Space::Places && meaning.space != Space::Components
            || meaning.space == Space::Places && space != Space::Components
            || is_formal && in_head(&token);
        same_space
            && lexed.token_text(token) == new
            && home(lexed, scope) == own_home
            && (is_index(lexed, meaning.scope) != is_index(lexed, scope)
                || scope == meaning.scope
                || is_nested(lexed, meaning.scope, scope))
    };
    (0..lexed.tokens.len()).any(rival)
}

/// Whether a scope is a `repeat`, whose name is its index.
fn is_index(lexed: &Lexed, scope: Option<usize>) -> bool {
    scope.is_some_and(|scope| lexed.keyword(scope) == "repeat")
}

/// Whether one of two statements is nested in the other.
fn is_nested(lexed: &Lexed, one: Option<usize>, other: Option<usize>) -> bool {
    let inside = |a: usize, b: usize| lexed.outline.enclosing(a).any(|around| around == b);
    one.zip(other).is_some_and(|(one, other)| inside(one, other) || inside(other, one))
}

pub fn is_word(text: &str) -> bool {
    let mut letters = text.chars();
    letters.next().is_some_and(words::is_letter) && letters.all(|c| words::is_letter(c) || c.is_ascii_digit())
}

/// The names of a space that a component declares, or the scene, each once, in order of declaration, by the token of the first
/// declaration.
pub fn declared_names(lexed: &Lexed, space: Space, scope: Option<usize>) -> Vec<usize> {
    let mut seen: Vec<&str> = Vec::new();
    let mut list = Vec::new();
    for (token, role) in lexed.roles.iter().enumerate() {
        if *role == (Role::Declaration { space, scope }) && !seen.contains(&lexed.token_text(token)) {
            seen.push(lexed.token_text(token));
            list.push(token);
        }
    }
    list
}
