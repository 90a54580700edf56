//! The outline of a text: a symbol for each declaration, and the ranges that can be folded.

use super::document::Document;
use super::roles::{Role, keyword};
use super::tokens::TokenKind;
use crate::base::OrderBy;
use crate::syntax::words;
use std::ops::Range;

/// A declaration in the outline.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    pub name: String,
    /// The keyword.
    pub detail: String,
    pub range: Range<usize>,
    /// The name, or the keyword of a declaration without one.
    pub selection: Range<usize>,
    /// The declarations in a `repeat`.
    pub children: Vec<Symbol>,
}

pub fn symbols(document: &Document) -> Vec<Symbol> {
    symbols_in(document, None)
}

/// The symbols in a `repeat`, or at the top level. The grammar allows at most eight nested `repeat`s; text that does
/// not parse is cut at the same depth.
fn symbols_in(document: &Document, repeat: Option<usize>) -> Vec<Symbol> {
    let statements = document.outline.statements.iter().enumerate();
    let own = statements.filter(|(index, s)| s.inside == repeat && document.outline.enclosing(*index).count() <= DEPTH);
    own.filter_map(|(index, _)| symbol(document, index)).collect()
}

const DEPTH: usize = 8;

fn symbol(document: &Document, index: usize) -> Option<Symbol> {
    let statement = &document.outline.statements[index];
    let word = keyword(document.text(), &document.tokens, statement);
    if word.is_empty() {
        return None;
    }
    let second = statement.tokens.start + 1;
    let is_name = |role: Role| matches!(role, Role::Declaration { .. } | Role::Title | Role::Reference { .. });
    let named = statement.tokens.contains(&second) && is_name(document.roles[second]);
    let selection = document.tokens[if named { second } else { statement.tokens.start }].range.clone();
    let range = document.range_of(index);
    let end = statement.close.map_or(range.end, |close| document.tokens[close].range.end);
    let name = if named { full_name(document, second) } else { word.to_string() };
    let children = if words::has_body(word) { symbols_in(document, Some(index)) } else { Vec::new() };
    Some(Symbol { name, detail: word.to_string(), range: range.start..end, selection, children })
}

/// A name with its indices.
fn full_name(document: &Document, token: usize) -> String {
    let start = document.tokens[token].range.clone();
    let rest = &document.text()[start.end..];
    let indices = if rest.starts_with('[') { rest.find(']').map_or(0, |end| end + 1) } else { 0 };
    document.text()[start.start..start.end + indices].to_string()
}

/// A range of lines that can be folded: from the line of the first byte to that of the last.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fold {
    pub range: Range<usize>,
    pub is_comment: bool,
}

pub fn folds(document: &Document) -> Vec<Fold> {
    let mut folds = Vec::new();
    for (index, statement) in document.outline.statements.iter().enumerate() {
        let range = document.range_of(index);
        let end = statement.close.map_or(range.end, |close| document.tokens[close].range.end);
        folds.push(Fold { range: range.start..end, is_comment: false });
    }
    folds.extend(comments(document));
    folds.retain(|fold| document.text()[fold.range.clone()].contains('\n'));
    folds.order_by_key(|fold| fold.range.start);
    folds
}

/// Comments on consecutive lines.
fn comments(document: &Document) -> Vec<Fold> {
    let mut folds: Vec<Fold> = Vec::new();
    let mut at = 0;
    while at < document.tokens.len() {
        let fresh = at == 0 || document.tokens[at - 1].kind == TokenKind::LineEnd;
        if !fresh || document.tokens[at].kind != TokenKind::Comment {
            at += 1;
            continue;
        }
        let start = at;
        let kind = |at: usize| document.tokens.get(at).map(|token| token.kind);
        while kind(at + 1) == Some(TokenKind::LineEnd) && kind(at + 2) == Some(TokenKind::Comment) {
            at += 2;
        }
        let range = document.tokens[start].range.start..document.tokens[at].range.end;
        folds.push(Fold { range, is_comment: true });
        at += 1;
    }
    folds
}
