//! The kind of each token, for syntax colouring.

use super::document::Document;
use super::roles::{Role, Space};
use super::tokens::TokenKind;
use std::ops::Range;

/// Names of token kinds in the protocol, in the order of their numbers.
pub const KINDS: [&str; 11] = [
    "keyword",
    "variable",
    "class",
    "property",
    "function",
    "number",
    "string",
    "comment",
    "operator",
    "type",
    "parameter",
];
/// Modifiers that a token may have in addition to its kind.
pub const MARKS: [&str; 3] = ["declaration", "readonly", "documentation"];

/// A coloured piece of text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    pub range: Range<usize>,
    /// Index into [`KINDS`].
    pub kind: usize,
    /// A bit for each of [`MARKS`].
    pub marks: u32,
}

const DECLARATION: u32 = 1;
const READONLY: u32 = 2;
const DOCUMENTATION: u32 = 4;

/// The pieces of a text, in order; no piece extends over a line end.
pub fn pieces(document: &Document) -> Vec<Piece> {
    let mut pieces = Vec::with_capacity(document.tokens.len());
    let text = document.text();
    for (token, role) in document.tokens.iter().zip(&document.roles) {
        let mut push = |range: Range<usize>, kind: &str, marks: u32| {
            let kind = KINDS.iter().position(|known| *known == kind).unwrap_or(0);
            pieces.push(Piece { range, kind, marks });
        };
        let range = token.range.clone();
        match token.kind {
            TokenKind::Number { number_len } => {
                push(range.start..range.start + number_len, "number", 0);
                if let Some(unit) = token.unit(text) {
                    push(unit, "type", 0);
                }
            }
            TokenKind::Text => push(range, "string", 0),
            TokenKind::Comment => {
                let marks = if token.text(text).starts_with("///") { DOCUMENTATION } else { 0 };
                push(range, "comment", marks);
            }
            TokenKind::Sign if !matches!(token.text(text), "," | ":" | ".") => push(range, "operator", 0),
            TokenKind::Word => {
                if let Some((kind, marks)) = of_role(*role) {
                    push(range, kind, marks);
                }
            }
            _ => {}
        }
    }
    pieces
}

fn of_role(role: Role) -> Option<(&'static str, u32)> {
    Some(match role {
        Role::None => return None,
        Role::Keyword | Role::Word => ("keyword", 0),
        Role::Direction | Role::Field | Role::Member => ("property", 0),
        Role::Function => ("function", 0),
        Role::Constant => ("variable", READONLY),
        Role::Title => ("class", DECLARATION),
        Role::Declaration { space: Space::Values, scope: None } => ("variable", DECLARATION),
        Role::Reference { space: Space::Values, scope: None } => ("variable", 0),
        Role::Declaration { space: Space::Values, .. } => ("parameter", DECLARATION),
        Role::Reference { space: Space::Values, .. } => ("parameter", 0),
        Role::Declaration { space: Space::Parts, .. } => ("class", DECLARATION),
        Role::Reference { space: Space::Parts, .. } => ("class", 0),
        Role::Declaration { space: Space::Places, .. } => ("class", DECLARATION),
        Role::Reference { space: Space::Places, .. } => ("class", 0),
        Role::Declaration { space: Space::Components, .. } => ("type", DECLARATION),
        Role::Reference { space: Space::Components, .. } => ("type", 0),
    })
}
