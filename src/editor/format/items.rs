//! Groups tokens into declarations, comments on separate lines, and blank lines. See spec.md#declarations.

use crate::editor::tokens::{Token, TokenKind};
use crate::syntax::words;
use std::ops::Range;

/// An item of a file, in vertical order; ranges and places refer to tokens.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Item {
    /// One or more empty lines between two other items.
    Blank,
    Comment(usize),
    Declaration {
        tokens: Range<usize>,
        comment: Option<usize>,
    },
    /// The head of a `repeat` or `component` with its `{`.
    Open {
        tokens: Range<usize>,
        comment: Option<usize>,
    },
    /// The `}` of a `repeat` or `component`.
    Close {
        comment: Option<usize>,
    },
}

pub(super) fn items(text: &str, tokens: &[Token]) -> Vec<Item> {
    let mut cutter = Cutter { text, tokens, at: 0 };
    let mut items = Vec::new();
    while let Some(token) = tokens.get(cutter.at) {
        let item = match token.kind {
            TokenKind::LineEnd => cutter.line_ends(&items),
            TokenKind::Comment => Some(Item::Comment(cutter.step())),
            TokenKind::Close => {
                cutter.step();
                Some(Item::Close { comment: cutter.comment() })
            }
            _ => Some(cutter.declaration()),
        };
        items.extend(item);
    }
    items
}

struct Cutter<'a> {
    text: &'a str,
    tokens: &'a [Token],
    at: usize,
}

impl Cutter<'_> {
    fn kind(&self) -> Option<TokenKind> {
        self.tokens.get(self.at).map(|token| token.kind)
    }

    fn step(&mut self) -> usize {
        self.at += 1;
        self.at - 1
    }

    /// A comment on the current line.
    fn comment(&mut self) -> Option<usize> {
        (self.kind() == Some(TokenKind::Comment)).then(|| self.step())
    }

    /// Empty lines count between items, but not at the ends of a file or of a `repeat`.
    fn line_ends(&mut self, before: &[Item]) -> Option<Item> {
        let start = self.at;
        while self.kind() == Some(TokenKind::LineEnd) {
            self.step();
        }
        let inside = !matches!(before.last(), None | Some(Item::Open { .. }));
        let more = !matches!(self.kind(), None | Some(TokenKind::Close));
        (self.at - start > 1 && inside && more).then_some(Item::Blank)
    }

    /// A declaration: up to the line end outside all brackets, or to a brace that ends or opens a `repeat`.
    fn declaration(&mut self) -> Item {
        let start = self.at;
        let has_body = words::has_body(self.tokens[start].text(self.text));
        let mut depth = 0_usize;
        while let Some(token) = self.tokens.get(self.at) {
            match token.kind {
                TokenKind::LineEnd | TokenKind::Comment if depth == 0 => break,
                TokenKind::Open if has_body && depth == 0 && token.text(self.text) == "{" => {
                    self.step();
                    return Item::Open { tokens: start..self.at, comment: self.comment() };
                }
                TokenKind::Open => depth += 1,
                TokenKind::Close if depth == 0 => break,
                TokenKind::Close => depth -= 1,
                _ => {}
            }
            self.step();
        }
        Item::Declaration { tokens: start..self.at, comment: self.comment() }
    }
}
