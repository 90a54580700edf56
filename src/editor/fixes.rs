//! Edits that fix a finding: the changes that a stage proposes (`base::Change`), at their places in the text.

use super::document::Document;
use super::names::is_word;
use super::roles::Role;
use super::tokens::TokenKind;
use crate::base::{Change, Diagnostic, Fix, Span};
use crate::syntax::tree::FieldValue;
use crate::syntax::words;
use std::ops::Range;

/// A named change of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Action {
    pub title: String,
    /// The replaced ranges and their new text.
    pub edits: Vec<(Range<usize>, String)>,
}

/// All edits that may fix a finding, the likeliest first.
pub fn actions(document: &Document, finding: &Diagnostic) -> Vec<Action> {
    let own = finding.fixes.iter().filter(|fix| fix.at.file() == document.file);
    own.filter_map(|fix| action(document, fix)).collect()
}

fn action(document: &Document, fix: &Fix) -> Option<Action> {
    let at = fix.at.range();
    let (title, range, text) = match &fix.change {
        Change::Replace(text) if text.is_empty() => {
            ("delete it".to_string(), without_blanks(document.text(), at), String::new())
        }
        Change::Replace(text) => (format!("write `{}`", text.trim()), at, text.clone()),
        Change::After(text) => (format!("write `{}`", text.trim()), at.end..at.end, text.clone()),
        Change::Unit(unit) => {
            let last = document.outline.statements[statement(document, at.start)?].tokens.end - 1;
            let plain = matches!(document.tokens[last].kind, TokenKind::Number { .. })
                && document.tokens[last].unit(document.text()).is_none();
            let end = document.tokens[last].range.end;
            plain.then(|| (format!("write `{} {unit}`", document.token_text(last)), end..end, format!(" {unit}")))?
        }
        Change::Times(factor) => times(document, at, factor),
        Change::Close(bracket) => {
            let place = closing_place(document, at.start, *bracket);
            let blank = if *bracket == '}' { " " } else { "" };
            (format!("write `{bracket}`"), place..place, format!("{blank}{bracket}"))
        }
        Change::AddField(field) => add_field(document, at.start, field)?,
        Change::Append(text) => {
            let end = document.range_of(statement(document, at.start)?).end;
            (format!("write `{}`", text.trim()), end..end, text.to_string())
        }
        Change::DropField => drop_field(document, at.start)?,
        Change::DropValue => drop_value(document, at.start)?,
        Change::DropDeclaration => drop_declaration(document, at.start)?,
        Change::Rename => rename(document, at)?,
        Change::Declare(text) => {
            let end = document.text().trim_end().len();
            (
                format!("write `{text}`"),
                end..document.text().len(),
                format!("\n{text}\n").trim_start_matches(|_| end == 0).into(),
            )
        }
    };
    Some(Action { title, edits: vec![(range, text)] })
}

fn statement(document: &Document, offset: usize) -> Option<usize> {
    document.outline.at(document.text(), &document.tokens, offset)
}

/// A range extended by the blanks before it.
fn without_blanks(text: &str, at: Range<usize>) -> Range<usize> {
    let before = text[..at.start].trim_end_matches([' ', '\t']).len();
    let line_starts = text[..before].is_empty() || text[..before].ends_with('\n');
    if line_starts { at } else { before..at.end }
}

/// `x * 1 rad`, `(a + b) * 1 rad`
fn times(document: &Document, at: Range<usize>, factor: &str) -> (String, Range<usize>, String) {
    let written = &document.text()[at.clone()];
    let tokens = super::tokens::tokens(written);
    let mut depth = 0_usize;
    let loose = tokens.iter().any(|token| {
        match token.kind {
            TokenKind::Open => depth += 1,
            TokenKind::Close => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0 && matches!(token.text(written), "+" | "-")
    });
    let text = if loose { format!("({written}) * {factor}") } else { format!("{written} * {factor}") };
    (format!("multiply by `{factor}`"), at, text)
}

/// The place at which an open bracket or quote should be closed: after the last visible token of its statement, but
/// before the end of an outer bracket, and before the next field.
fn closing_place(document: &Document, open: usize, bracket: char) -> usize {
    let text = document.text();
    let Some(first) = document.tokens.iter().position(|token| token.range.start == open) else { return open };
    if bracket == '"' {
        // The rest of the line became part of the string.
        return open + document.token_text(first).trim_end_matches([')', '}', ' ', ',']).len();
    }
    let mut depth = 0_usize;
    let mut end = document.tokens[first].range.end;
    for at in first..statement_end(document, first) {
        let token = &document.tokens[at];
        match token.kind {
            TokenKind::LineEnd | TokenKind::Comment => continue,
            TokenKind::Sign
                if depth == 1 && bracket != '}' && token.text(text) == "," && field_follows(document, at) =>
            {
                break;
            }
            TokenKind::Open => depth += 1,
            TokenKind::Close if depth == 1 && !token.text(text).starts_with(bracket) => break,
            TokenKind::Close => depth = depth.saturating_sub(1),
            _ => {}
        }
        end = token.range.end;
    }
    end
}

/// The end of the statement of a token; a `repeat` that is opened there extends to the end of the text.
fn statement_end(document: &Document, token: usize) -> usize {
    let Some(index) = document.statement_of(token) else { return document.tokens.len() };
    let end = document.outline.statements[index].tokens.end;
    if words::has_body(document.keyword(index)) && end == token + 1 { document.tokens.len() } else { end }
}

/// Whether a field or a direction follows a comma.
fn field_follows(document: &Document, comma: usize) -> bool {
    let word = |at: usize| document.tokens.get(at).map_or("", |token| token.text(document.text()));
    word(comma + 2) == "=" || matches!(word(comma + 1), "moves" | "turns" | "free")
}

/// Adds a field before the `}` of the enclosing declaration, with new braces if it has none.
fn add_field(document: &Document, offset: usize, field: &str) -> Option<(String, Range<usize>, String)> {
    let text = document.text();
    let title = format!("add `{field}`");
    let tokens = document.outline.statements[statement(document, offset)?].tokens.clone();
    let close = tokens.clone().rev().find(|token| document.token_text(*token) == "}");
    let Some(close) = close else {
        let end = document.tokens[tokens.end - 1].range.end;
        return Some((title, end..end, format!(" {{ {field} }}")));
    };
    let last = (tokens.start..close).rev().find(|token| !is_gap(document, *token))?;
    let (before, at) = (document.tokens[last].range.end, document.tokens[close].range.start);
    let edit = match (document.token_text(last), text[before..at].contains('\n')) {
        ("{", _) => (before..at, format!(" {field} ")),
        (",", false) => (before..before, format!(" {field}")),
        (_, false) => (before..before, format!(", {field}")),
        (_, true) => (before..before, format!("\n{}{field}", indent(text, document.tokens[last].range.start))),
    };
    Some((title, edit.0, edit.1))
}

fn is_gap(document: &Document, token: usize) -> bool {
    matches!(document.tokens[token].kind, TokenKind::LineEnd | TokenKind::Comment)
}

/// The blanks at the start of a line.
fn indent(text: &str, offset: usize) -> &str {
    let start = text[..offset].rfind('\n').map_or(0, |at| at + 1);
    let line = &text[start..offset];
    &line[..line.len() - line.trim_start().len()]
}

/// Removes the field that starts at a place, with its comma.
fn drop_field(document: &Document, offset: usize) -> Option<(String, Range<usize>, String)> {
    let statement = statement(document, offset)?;
    let tokens = document.outline.statements[statement].tokens.clone();
    // A place in a value refers to its field.
    let first = tokens
        .clone()
        .rev()
        .find(|token| document.tokens[*token].range.start <= offset && starts_field(document, *token))?;
    let word = document.token_text(first).to_string();
    let next =
        (first + 1..tokens.end).find(|token| starts_field(document, *token) || document.token_text(*token) == "}")?;
    let title = format!("leave out `{word}`");
    if document.token_text(next) != "}" {
        return Some((title, document.tokens[first].range.start..document.tokens[next].range.start, String::new()));
    }
    let before = first.checked_sub(1).filter(|token| document.token_text(*token) == ",");
    let start = before.map_or(document.tokens[first].range.start, |comma| document.tokens[comma].range.start);
    let end = document.tokens[(first..next).rev().find(|token| !is_gap(document, *token))?].range.end;
    Some((title, start..end, String::new()))
}

/// Whether a word in braces starts a field.
fn starts_field(document: &Document, token: usize) -> bool {
    let is_word = matches!(document.roles[token], Role::Field | Role::Word);
    let before = (0..token).rev().find(|token| document.tokens[*token].kind != TokenKind::Comment);
    is_word
        && before.is_some_and(|before| {
            matches!(document.token_text(before), "{" | ",") || document.tokens[before].kind == TokenKind::LineEnd
        })
}

/// Changes `turns = 1` to `turns`.
fn drop_value(document: &Document, offset: usize) -> Option<(String, Range<usize>, String)> {
    let is_here = |key: Span| key.file() == document.file && key.start() == offset;
    let field = document.tree.fields.iter().find(|field| is_here(field.key))?;
    let end = match field.value {
        FieldValue::Expr(expr) => document.tree.expr(expr).span.end(),
        _ => return None,
    };
    let word = document.sources.slice(field.key);
    Some((format!("write `{word}` alone"), field.key.end()..end, String::new()))
}

/// Removes a declaration with its line.
fn drop_declaration(document: &Document, offset: usize) -> Option<(String, Range<usize>, String)> {
    let text = document.text();
    let range = document.range_of(statement(document, offset)?);
    let line = text[range.clone()].lines().next().unwrap_or_default().to_string();
    let start = text[..range.start].trim_end_matches([' ', '\t']).len();
    let end = range.end + text[range.end..].find('\n').map_or(text.len() - range.end, |at| at + 1);
    let alone = text[range.end..end].trim().is_empty() && (start == 0 || text[..start].ends_with('\n'));
    let range = if alone { start..end } else { range };
    Some((format!("leave out `{line}`"), range, String::new()))
}

/// Changes a name: adds the index of the enclosing `repeat`, or the next free number.
fn rename(document: &Document, at: Range<usize>) -> Option<(String, Range<usize>, String)> {
    let name = &document.text()[at.clone()];
    let token = document.token_at(at.start)?;
    let statement = document.statement_of(token)?;
    let indexed = document.text()[at.end..].starts_with('[');
    if let Some(repeat) = document.outline.statements[statement].inside.filter(|_| !indexed) {
        let index = document.token_text(document.outline.statements[repeat].tokens.start + 1);
        return Some((format!("write `{name}[{index}]`"), at.end..at.end, format!("[{index}]")));
    }
    let taken = |new: &str| document.tokens.iter().any(|token| token.text(document.text()) == new);
    let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let new = (2..1000).map(|number| format!("{stem}{number}")).find(|new| is_word(new) && !taken(new))?;
    Some((format!("call it `{new}`"), at, new))
}
