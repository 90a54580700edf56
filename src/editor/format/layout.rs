//! Turns declarations into lines: on one line if it fits, otherwise each field on its own line. See spec.md#layout.

use super::items::Item;
use super::spacing::{Piece, Role, join, needs_space, pieces};
use super::{INDENT, WIDTH};
use crate::editor::tokens::Token;
use crate::syntax::tree::Tree;
use std::ops::Range;

/// A line of the layout.
#[derive(Debug)]
pub(super) struct Line {
    pub indent: usize,
    pub content: Content,
    pub comment: Option<String>,
    /// The columns of lines in one group are aligned.
    pub group: usize,
}

#[derive(Debug, PartialEq, Eq)]
pub(super) enum Content {
    Blank,
    /// Text as it is; empty if there is only a comment.
    Plain(String),
    /// A keyword (empty for fields), a name, and the text after it: `= ...`, the part after a colon, or `{ ...`.
    Named {
        keyword: String,
        name: String,
        sort: Sort,
        rest: String,
    },
}

/// The kind of text after a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sort {
    Value,
    Ends,
    Fields,
}

pub(super) fn lines(text: &str, tree: &Tree, tokens: &[Token], items: &[Item]) -> Vec<Line> {
    let mut layout = Layout { text, tree, tokens, lines: Vec::new(), level: 0, group: 0 };
    for item in items {
        layout.item(item);
    }
    layout.lines
}

struct Layout<'a> {
    text: &'a str,
    tree: &'a Tree,
    tokens: &'a [Token],
    lines: Vec<Line>,
    /// Number of open `repeat`s and braces.
    level: usize,
    group: usize,
}

impl Layout<'_> {
    fn item(&mut self, item: &Item) {
        match item {
            Item::Blank => self.blank(),
            Item::Comment(token) => self.push(Content::Plain(String::new()), Some(*token)),
            Item::Declaration { tokens, comment } => self.declaration(tokens.clone(), *comment),
            Item::Open { tokens, comment } => {
                let head = pieces(self.text, &self.tokens[tokens.clone()]);
                let line = join(head.iter().filter(|piece| piece.role != Role::LineEnd));
                self.in_own_group(|layout| match has_comment(&head) {
                    true => layout.as_written(&head, *comment),
                    false => layout.push(Content::Plain(line), *comment),
                });
                self.level += 1;
            }
            Item::Close { comment } => {
                self.level = self.level.saturating_sub(1);
                self.in_own_group(|layout| layout.push(Content::Plain("}".into()), *comment));
            }
        }
    }

    /// Puts lines into a separate group.
    fn in_own_group(&mut self, lines: impl FnOnce(&mut Self)) {
        self.group += 1;
        lines(self);
        self.group += 1;
    }

    fn blank(&mut self) {
        self.group += 1;
        self.lines.push(Line { indent: 0, content: Content::Blank, comment: None, group: self.group });
        self.group += 1;
    }

    fn push(&mut self, content: Content, comment: Option<usize>) {
        let comment = comment.map(|token| self.tokens[token].text(self.text).to_string());
        self.push_line(content, comment);
    }

    fn push_line(&mut self, content: Content, comment: Option<String>) {
        self.lines.push(Line { indent: INDENT * self.level, content, comment, group: self.group });
    }

    fn declaration(&mut self, tokens: Range<usize>, comment: Option<usize>) {
        let all = pieces(self.text, &self.tokens[tokens]);
        let line = self.one_line(&all);
        let is_plain = !has_comment(&all);
        if is_plain && INDENT * self.level + join(&line).chars().count() <= WIDTH {
            return self.push(content(&line), comment);
        }
        let braces =
            braces(&all).filter(|braces| !has_comment(&all[..braces.start]) && !has_comment(&all[braces.end..]));
        self.in_own_group(|layout| match braces {
            Some(braces) => layout.fields(&all, braces, comment),
            None if is_plain && !all.iter().any(|piece| piece.role == Role::LineEnd) => {
                layout.push(content(&line), comment)
            }
            None => layout.as_written(&all, comment),
        });
    }

    /// Whether a word starts a field.
    fn is_field(&self, piece: &Piece) -> bool {
        self.tree.fields.binary_search_by_key(&piece.at, |field| field.key.start()).is_ok()
    }

    /// The pieces on one line, with fields separated by commas.
    fn one_line(&self, all: &[Piece]) -> Vec<Piece> {
        let comma = || Piece { text: ",".into(), role: Role::Comma, at: 0 };
        let mut line: Vec<Piece> = Vec::with_capacity(all.len());
        let mut open = Vec::new();
        for piece in all {
            match piece.role {
                Role::Open(bracket) => open.push(bracket),
                Role::Close => drop(open.pop()),
                _ => {}
            }
            let separates = piece.role == Role::Comma && open.last() == Some(&'{');
            if separates || matches!(piece.role, Role::LineEnd | Role::Comment) {
                continue;
            }
            let first = line.last().is_none_or(|last| last.role == Role::Open('{'));
            if open.last() == Some(&'{') && self.is_field(piece) && !first {
                line.push(comma());
            }
            line.push(piece.clone());
        }
        line
    }

    /// `body b {`, each field on a separate line, `}`.
    fn fields(&mut self, all: &[Piece], braces: Range<usize>, comment: Option<usize>) {
        let mut at = braces.start + 1;
        let head = join(all[..at].iter().filter(|piece| piece.role != Role::LineEnd));
        let beside = self.take_comment(all, &mut at);
        self.push_line(Content::Plain(head), beside);
        self.level += 1;
        self.group += 1;
        let last = braces.end - 1;
        while at < last {
            at = self.field_or_gap(all, at, last);
        }
        self.level -= 1;
        self.group += 1;
        let tail: Vec<Piece> = self.one_line(&all[last..]);
        self.push(Content::Plain(join(&tail)), comment);
    }

    /// Writes the content of braces at `at` (a field, a comment on a line of its own, or line ends); returns the place
    /// after it.
    fn field_or_gap(&mut self, all: &[Piece], mut at: usize, last: usize) -> usize {
        let start = at;
        match all[at].role {
            Role::LineEnd => {
                while at < last && all[at].role == Role::LineEnd {
                    at += 1;
                }
                let first = self.lines.last().is_some_and(|line| line.indent < INDENT * self.level);
                if at - start > 1 && at < last && !first {
                    self.blank();
                }
                at
            }
            Role::Comma => at + 1,
            Role::Comment => {
                self.push_line(Content::Plain(String::new()), Some(all[at].text.clone()));
                at + 1
            }
            _ => {
                let next = (at + 1..last).find(|&next| self.is_field(&all[next])).unwrap_or(last);
                let end = field_end(all, at, next);
                self.field(&all[start..end], all, end)
            }
        }
    }

    fn field(&mut self, field: &[Piece], all: &[Piece], mut end: usize) -> usize {
        if all[end].role == Role::Comma {
            end += 1;
        }
        let beside = self.take_comment(all, &mut end);
        if has_comment(field) {
            self.in_own_group(|layout| layout.written_lines(field, beside));
            return end;
        }
        let line: Vec<Piece> = field.iter().filter(|piece| piece.role != Role::LineEnd).cloned().collect();
        let content = match line.get(1) {
            Some(sign) if sign.text == "=" => {
                let (name, rest) = (line[0].text.clone(), join(&line[1..]));
                Content::Named { keyword: String::new(), name, sort: Sort::Value, rest }
            }
            _ => Content::Plain(join(&line)),
        };
        self.push_line(content, beside);
        end
    }

    /// The comment on the current line.
    fn take_comment(&self, all: &[Piece], at: &mut usize) -> Option<String> {
        let comment = all.get(*at).filter(|piece| piece.role == Role::Comment)?;
        *at += 1;
        Some(comment.text.clone())
    }

    /// Keeps the original line breaks, with the layout's spaces and indents.
    fn as_written(&mut self, all: &[Piece], comment: Option<usize>) {
        let comment = comment.map(|token| self.tokens[token].text(self.text).to_string());
        self.written_lines(all, comment);
    }

    fn written_lines(&mut self, all: &[Piece], comment: Option<String>) {
        let mut depth = 0_usize;
        let lines: Vec<&[Piece]> =
            all.split(|piece| piece.role == Role::LineEnd).filter(|line| !line.is_empty()).collect();
        for (number, line) in lines.iter().enumerate() {
            let closes = line.iter().take_while(|piece| piece.role == Role::Close).count();
            let inner = depth.saturating_sub(closes) + usize::from(number > 0 && closes == 0 && depth == 0);
            depth = line.iter().fold(depth, |depth, piece| match piece.role {
                Role::Open(_) => depth + 1,
                Role::Close => depth.saturating_sub(1),
                _ => depth,
            });
            let (code, beside) = match line.split_last() {
                Some((last, code)) if last.role == Role::Comment => (code, Some(last.text.clone())),
                _ => (*line, None),
            };
            let beside = if number + 1 == lines.len() { comment.clone().or(beside) } else { beside };
            self.level += inner;
            self.push_line(Content::Plain(join(code)), beside);
            self.level -= inner;
        }
    }
}

fn has_comment(pieces: &[Piece]) -> bool {
    pieces.iter().any(|piece| piece.role == Role::Comment)
}

/// The range from the `{` of a declaration's fields to just after their `}`.
fn braces(all: &[Piece]) -> Option<Range<usize>> {
    let start = all.iter().position(|piece| piece.role == Role::Open('{'))?;
    let end = all[start..].iter().position(|piece| piece.text == "}")?;
    Some(start..start + end + 1)
}

/// The end of a field: after its last visible piece before the next field.
fn field_end(all: &[Piece], start: usize, next: usize) -> usize {
    let gap = |piece: &Piece| matches!(piece.role, Role::LineEnd | Role::Comment | Role::Comma);
    let visible = all[start..next].iter().rposition(|piece| !gap(piece)).unwrap_or(0);
    start + visible + 1
}

/// The single line of a declaration, split at possible columns.
fn content(line: &[Piece]) -> Content {
    let cut =
        line.iter().position(|piece| piece.role == Role::Colon || piece.role == Role::Open('{') || piece.text == "=");
    let named = line.first().is_some_and(|keyword| is_named(&keyword.text));
    let Some(cut) = cut.filter(|cut| named && *cut > 1) else { return Content::Plain(join(line)) };
    let (sort, rest) = match line[cut].role {
        Role::Colon => (Sort::Ends, cut + 1),
        Role::Relation => (Sort::Value, cut),
        _ => (Sort::Fields, cut),
    };
    debug_assert!(needs_space(&line[0], &line[1]), "a blank stands after a keyword");
    let (keyword, name) = (line[0].text.clone(), join(&line[1..cut]));
    Content::Named { keyword, name, sort, rest: join(&line[rest..]) }
}

/// Whether a name follows this keyword, so that the line has columns.
fn is_named(keyword: &str) -> bool {
    !matches!(
        keyword,
        "model"
            | "gravity"
            | "damping"
            | "rest"
            | "repeat"
            | "solve"
            | "minimise"
            | "maximise"
            | "require"
            | "correlate"
            | "component"
            | "use"
    )
}
