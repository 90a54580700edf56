//! Groups tokens into statements: the start and end of each declaration of a text, and the `repeat` or `component` that
//! contains it, whether it conforms to the grammar or not. See spec.md#declarations.
//!
//! It works like the parser's own splitting (`syntax::split`), but never fails: if a bracket stays open, the next line
//! that looks like the start of a declaration starts one.

use super::tokens::{Token, TokenKind};
use crate::syntax::words;
use std::ops::Range;

/// A declaration, or text in the place of one.
#[derive(Clone, Debug)]
pub struct Statement {
    /// Its tokens from the keyword on; for a `repeat` or `component`, the tokens of the head including its `{`.
    pub tokens: Range<usize>,
    /// The enclosing `repeat` or `component`.
    pub inside: Option<usize>,
    /// For a `repeat` or `component`, the token of the `}`.
    pub close: Option<usize>,
}

/// The statements of a text, in order.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    pub statements: Vec<Statement>,
}

impl Outline {
    pub fn new(text: &str, tokens: &[Token]) -> Outline {
        let mut outline = Outline::default();
        let mut open: Vec<usize> = Vec::new();
        let mut at = 0;
        while let Some(token) = tokens.get(at) {
            match token.kind {
                TokenKind::LineEnd | TokenKind::Comment => at += 1,
                TokenKind::Close => {
                    if let Some(repeat) = open.pop() {
                        outline.statements[repeat].close = Some(at);
                    }
                    at += 1;
                }
                _ => {
                    let end = end(text, tokens, at, open.is_empty());
                    let opens = words::has_body(token.text(text)) && tokens[end - 1].text(text) == "{";
                    let inside = open.last().copied();
                    outline.statements.push(Statement { tokens: at..end, inside, close: None });
                    if opens {
                        open.push(outline.statements.len() - 1);
                    }
                    at = end;
                }
            }
        }
        outline
    }

    /// The statement that contains a byte, or that ends immediately before it on the same line.
    pub fn at(&self, text: &str, tokens: &[Token], offset: usize) -> Option<usize> {
        let index = self.statements.partition_point(|s| tokens[s.tokens.start].range.start <= offset).checked_sub(1)?;
        let end = tokens[self.statements[index].tokens.end - 1].range.end;
        let between = text.get(end..offset).unwrap_or("");
        let opens =
            self.statements[index].close.is_some() || tokens[self.statements[index].tokens.end - 1].text(text) == "{";
        let is_head = words::has_body(tokens[self.statements[index].tokens.start].text(text)) && opens;
        (!between.contains('\n') && (!is_head || offset < end)).then_some(index)
    }

    /// The enclosing `repeat`s and component of a statement, from the innermost outwards.
    pub fn enclosing(&self, statement: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(self.statements[statement].inside, |repeat| self.statements[*repeat].inside)
    }
}

/// The position after the last token of the statement that starts at a token.
fn end(text: &str, tokens: &[Token], start: usize, outermost: bool) -> usize {
    let has_body = words::has_body(tokens[start].text(text));
    let mut open: Vec<&str> = Vec::new();
    let mut end = start + 1;
    for (at, token) in tokens.iter().enumerate().skip(start) {
        match token.kind {
            TokenKind::LineEnd if open.is_empty() => break,
            TokenKind::LineEnd if words::starts_declaration(&text.as_bytes()[token.range.end..]).is_some() => break,
            TokenKind::LineEnd | TokenKind::Comment => continue,
            TokenKind::Open if has_body && open.is_empty() && token.text(text) == "{" => return at + 1,
            TokenKind::Open => open.push(token.text(text)),
            TokenKind::Close if token.text(text) == "}" && !outermost && !open.contains(&"{") => break,
            TokenKind::Close => drop(open.pop()),
            _ => {}
        }
        end = at + 1;
    }
    end
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    fn first_words(text: &str) -> Vec<(String, Option<usize>)> {
        let tokens = tokens(text);
        let outline = Outline::new(text, &tokens);
        let word = |s: &Statement| tokens[s.tokens.start].text(text).to_string();
        outline.statements.iter().map(|s| (word(s), s.inside)).collect()
    }

    #[test]
    fn broken_statements_end_where_the_next_one_starts() {
        let text = "body b { mass = 1 kg,\nparam k = (1\nrepeat i in 1..2 {\n spring s[i: a -- b { k = 1 N/m\n}\noutput y = b.x\n";
        let found = first_words(text);
        let words: Vec<&str> = found.iter().map(|(word, _)| word.as_str()).collect();
        assert_eq!(words, ["body", "param", "repeat", "spring", "output"]);
        assert_eq!(found[3].1, Some(2));
    }
}
