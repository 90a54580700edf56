//! A text in tokens, with the declarations that they form and the role of each word: everything that an editor knows
//! about a file without running a stage, whether it parses or not.

use super::outline::Outline;
use super::roles::{self, Role};
use super::tokens::{self, Token, TokenKind};
use crate::base::LineIndex;
use std::ops::Range;

/// A text and its words.
#[derive(Clone, Debug)]
pub struct Lexed {
    text: String,
    pub lines: LineIndex,
    pub tokens: Vec<Token>,
    pub outline: Outline,
    /// The role of each token.
    pub roles: Vec<Role>,
}

impl Lexed {
    pub fn new(text: &str) -> Lexed {
        let tokens = tokens::tokens(text);
        let outline = Outline::new(text, &tokens);
        let roles = roles::roles(text, &tokens, &outline);
        Lexed { text: text.to_string(), lines: LineIndex::new(text), tokens, outline, roles }
    }

    pub fn text(&self) -> &str {
        &self.text
    }

    pub fn token_text(&self, token: usize) -> &str {
        self.tokens[token].text(&self.text)
    }

    /// The token that contains a byte, or a word that ends there.
    pub fn token_at(&self, offset: usize) -> Option<usize> {
        let index = self.tokens.partition_point(|token| token.range.end < offset);
        let holds = |index: usize| {
            let token = self.tokens.get(index)?;
            (token.range.start <= offset && offset <= token.range.end).then_some(token.kind)
        };
        match (holds(index), holds(index + 1)) {
            // Between two adjacent tokens, the word is taken.
            (_, Some(TokenKind::Word)) => Some(index + 1),
            (Some(_), None) => Some(index),
            (Some(TokenKind::Word), Some(_)) => Some(index),
            (_, Some(_)) => Some(index + 1),
            (None, None) => None,
        }
    }

    /// The statement that a token belongs to.
    pub fn statement_of(&self, token: usize) -> Option<usize> {
        let statements = &self.outline.statements;
        let index = statements.partition_point(|s| s.tokens.start <= token).checked_sub(1)?;
        statements[index].tokens.contains(&token).then_some(index)
    }

    pub fn keyword(&self, statement: usize) -> &str {
        roles::keyword(&self.text, &self.tokens, &self.outline.statements[statement])
    }

    /// The bytes of a statement; for a `repeat` or a `component`, those of its head.
    pub fn range_of(&self, statement: usize) -> Range<usize> {
        let tokens = &self.outline.statements[statement].tokens;
        self.tokens[tokens.start].range.start..self.tokens[tokens.end - 1].range.end
    }

    /// The line of a token.
    pub fn line_of(&self, token: usize) -> &str {
        let line = self.lines.line(self.tokens[token].range.start);
        &self.text[self.lines.line_range(&self.text, line)]
    }

    /// The `///` lines before a statement, without the slashes.
    pub fn doc(&self, statement: usize) -> String {
        let mut at = self.outline.statements[statement].tokens.start;
        let mut lines = Vec::new();
        while let Some(before) = at.checked_sub(1) {
            match self.tokens[before].kind {
                TokenKind::LineEnd => {}
                TokenKind::Comment => match self.token_text(before).strip_prefix("///") {
                    Some(line) if !line.starts_with('/') => lines.push(line.trim()),
                    _ => break,
                },
                _ => break,
            }
            at = before;
        }
        lines.reverse();
        lines.join("\n")
    }

    /// The component that a declaration is in, or that it is.
    pub fn component_around(&self, statement: usize) -> Option<usize> {
        std::iter::once(statement).chain(self.outline.enclosing(statement)).find(|s| self.keyword(*s) == "component")
    }

    /// The names before a member and the member itself, `[front, tyre]` for `tyre` in `front.tyre.k`; `None` if the
    /// text before it does not consist of names, or is longer than any name.
    pub fn chain(&self, member: usize) -> Option<Vec<usize>> {
        let mut chain = vec![member];
        let mut at = member;
        while at > 0 && self.token_text(at - 1) == "." {
            at = self.before_indices(at.checked_sub(2)?)?;
            if self.tokens[at].kind != TokenKind::Word || chain.len() > crate::model::MAX_LEVELS {
                return None;
            }
            chain.push(at);
        }
        chain.reverse();
        Some(chain)
    }

    /// The last token of a name without its indices: `mount` for the last bracket of `mount[3]`.
    fn before_indices(&self, last: usize) -> Option<usize> {
        let mut at = last;
        while self.token_text(at) == "]" {
            let mut depth = 0_usize;
            loop {
                match self.tokens[at].kind {
                    TokenKind::Close => depth += 1,
                    TokenKind::Open => depth = depth.checked_sub(1)?,
                    TokenKind::LineEnd => return None,
                    _ => {}
                }
                at = at.checked_sub(1)?;
                if depth == 0 {
                    break;
                }
            }
        }
        Some(at)
    }

    /// The first token that follows a name and its indices.
    pub fn after_indices(&self, name: usize) -> Option<usize> {
        let mut at = name + 1;
        while self.tokens.get(at)?.text(&self.text) == "[" {
            let mut depth = 0_usize;
            loop {
                match self.tokens.get(at)?.kind {
                    TokenKind::Open => depth += 1,
                    TokenKind::Close => depth = depth.saturating_sub(1),
                    TokenKind::LineEnd => return None,
                    _ => {}
                }
                at += 1;
                if depth == 0 {
                    break;
                }
            }
        }
        (at < self.tokens.len()).then_some(at)
    }
}
