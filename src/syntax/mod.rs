//! Text to syntax tree. Clause: spec.md, "Grammar".
//!
//! In: a model file. Out: the tree of every declaration that is in the grammar (`grammar/vib.pest`), and an error for
//! every one that is not. `split` cuts the text into declarations, `build` parses them one by one.

mod build;
pub mod limits;
mod split;
pub mod tree;
pub mod words;

use crate::base::{Code, Diagnostic, Diagnostics, FileId, Sources, Span};
use build::{Built, Refused, RepeatHead, Yard};
use split::{Piece, Pieces, Trouble};
use std::ops::Range;
use tree::{Decl, DeclKind, ExprId, Repeat, Tree};

/// A parsed file.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// Every declaration that is in the grammar.
    pub tree: Tree,
    pub errors: Diagnostics,
}

/// Parses a model file.
pub fn parse(sources: &Sources, file: FileId) -> Parsed {
    let text = sources.text(file);
    let mut pieces = Pieces::new(text);
    let mut parse =
        Parse { text, tree: Tree::new(file), yard: Yard::default(), errors: Diagnostics::new(), open: Vec::new() };
    while let Some(piece) = pieces.next() {
        parse.piece(piece, pieces.take_doc());
    }
    parse.close_rest();
    Parsed { tree: parse.tree, errors: parse.errors }
}

/// Parses a value that stands alone, as that of `--set NAME=VALUE`; `None` where it is no expression of the language.
pub fn parse_value(sources: &Sources, value: Span) -> Option<(Tree, ExprId)> {
    let text = sources.slice(value);
    let brackets = text.bytes().filter(|byte| matches!(byte, b'(' | b'[')).count();
    if text.len() > limits::NUMBER || brackets > limits::BRACKETS {
        return None;
    }
    let mut tree = Tree::new(value.file());
    let value = build::value(&mut tree, text, value.start()).ok()?;
    Some((tree, value))
}

/// A `repeat` whose `}` has not come yet.
struct OpenRepeat {
    range: Range<usize>,
    /// `None` where it is not in the grammar.
    head: Option<RepeatHead>,
    body: Vec<Decl>,
}

struct Parse<'a> {
    text: &'a str,
    tree: Tree,
    yard: Yard,
    errors: Diagnostics,
    open: Vec<OpenRepeat>,
}

impl Parse<'_> {
    fn span(&self, range: Range<usize>) -> Span {
        Span::new(self.tree.file, range.start, range.end)
    }

    fn piece(&mut self, piece: Piece, doc: Option<Range<usize>>) {
        match piece {
            Piece::Declaration { range, trouble } => {
                if let Some(Built::Decl(decl)) = self.build(&range, trouble) {
                    self.push(decl, doc);
                }
            }
            Piece::Open { range, trouble } => {
                let head = match self.build(&range, trouble) {
                    Some(Built::Repeat(head)) => Some(head),
                    _ => None,
                };
                self.open.push(OpenRepeat { range, head, body: Vec::new() });
            }
            Piece::Close { at } => self.close(at + 1),
            Piece::Character { range } => self.trouble(&range, Trouble::Character { range: range.clone() }),
            Piece::Stray { at } => self.trouble(&(at..at + 1), Trouble::Stray { at }),
        }
    }

    fn push(&mut self, decl: Decl, doc: Option<Range<usize>>) {
        if let Some(doc) = doc {
            self.tree.push_doc(decl.span.start(), self.span(doc));
        }
        match self.open.last_mut() {
            Some(repeat) => repeat.body.push(decl),
            None => self.tree.decls.push(decl),
        }
    }

    fn build(&mut self, range: &Range<usize>, trouble: Option<Trouble>) -> Option<Built> {
        let built = self.try_build(range, trouble);
        if built.is_none() {
            self.tree.broken.push(self.span(range.clone()));
        }
        built
    }

    fn try_build(&mut self, range: &Range<usize>, trouble: Option<Trouble>) -> Option<Built> {
        if let Some(trouble) = trouble {
            self.trouble(range, trouble);
            return None;
        }
        match build::declaration(&mut self.tree, &mut self.yard, &self.text[range.clone()], range.start) {
            Ok(built) => Some(built),
            Err(Refused::Grammar) => {
                let span = self.span(range.clone());
                self.errors.push(Diagnostic::error(UNEXPECTED, span, "this declaration is not understood"));
                None
            }
            Err(Refused::TooDeep(span)) => {
                self.errors.push(Diagnostic::error(TOO_DEEP, span, "this expression is too deep"));
                None
            }
            Err(Refused::TooLong(span)) => {
                self.errors.push(Diagnostic::error(TOO_LARGE, span, "this is too long"));
                None
            }
        }
    }

    fn trouble(&mut self, range: &Range<usize>, trouble: Trouble) {
        let span = match &trouble {
            Trouble::Unclosed { open } | Trouble::Mismatch { open, .. } | Trouble::Text { open } => {
                self.span(*open..open + 1)
            }
            Trouble::Stray { at } | Trouble::Nesting { at } => self.span(*at..at + 1),
            Trouble::Character { range } => self.span(range.clone()),
            Trouble::Length | Trouble::SameLine => self.span(range.clone()),
        };
        let message = format!("this does not fit: {trouble:?}");
        self.errors.push(Diagnostic::error(UNEXPECTED, span, message));
    }

    fn close(&mut self, end: usize) {
        let Some(OpenRepeat { range, head, body }) = self.open.pop() else { return };
        let Some(head) = head else {
            self.tree.broken.push(self.span(range.start..end));
            return;
        };
        self.tree.repeats.push(Repeat { index: head.index, first: head.first, last: head.last, body });
        let kind = DeclKind::Repeat { index: (self.tree.repeats.len() - 1) as u32 };
        self.push(Decl { span: self.span(range.start..end), kind }, None);
    }

    /// At the end of the file: what is still open was not closed.
    fn close_rest(&mut self) {
        while let Some(repeat) = self.open.last() {
            let range = repeat.range.clone();
            self.trouble(&range, Trouble::Unclosed { open: range.end - 1 });
            self.close(self.text.len());
        }
    }
}

const UNEXPECTED: Code = Code("vib::syntax::unexpected");
const TOO_DEEP: Code = Code("vib::syntax::too_deep");
const TOO_LARGE: Code = Code("vib::syntax::too_large");
