//! Text to syntax tree. See spec.md#text.
//!
//! In: a model file. Out: the tree of every declaration that matches the grammar (`grammar/vib.pest`), and an error for
//! every one that does not. `split` cuts the text into declarations, `recognise` lets pest find the rules in each, `build` makes
//! nodes of them, and `explain` finds the mistakes in those that pest refuses.

mod build;
mod error;
mod explain;
pub mod limits;
mod recognise;
mod report;
mod split;
pub mod tree;
pub mod words;

pub use error::SyntaxError;

use crate::base::{Diagnostics, FileId, Sources, Span, runs};
use build::{Built, ComponentHead, Head, Refused, RepeatHead, Yard};
use error::{Expected, Intent, Remark};
use recognise::{Cut, Declaration, next_pieces};
use report::Report;
use split::{Piece, Pieces, SplitError};
use std::collections::HashSet;
use std::ops::Range;
use tree::{Component, Decl, DeclKind, ExprId, Rare, Repeat, Tree};

/// A parsed file.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// Every declaration that is in the grammar.
    pub tree: Tree,
    pub errors: Diagnostics,
}

/// Parses a single file; the tree has only the names of the files that it uses.
pub fn parse_alone(sources: &Sources, file: FileId) -> Parsed {
    runs::begins("parse");
    parse_into(Tree::new(file), sources.text(file))
}

/// Parses a model file, and for their components the files that it uses, as far as they are among the sources.
pub fn parse(sources: &Sources, file: FileId) -> Parsed {
    let mut parsed = parse_alone(sources, file);
    let mut read = vec![file];
    let mut next = 0;
    while let Some(using) = parsed.tree.uses.get(next) {
        next += 1;
        let Some(used) = sources.used_file(using.text).filter(|used| !read.contains(used)) else { continue };
        read.push(used);
        // Only the components of a used file are added.
        let declarations = std::mem::take(&mut parsed.tree.decls);
        parsed.tree.file = used;
        let more = parse_into(parsed.tree, sources.text(used));
        parsed.tree = more.tree;
        let is_model = !parsed.tree.decls.is_empty() || more.errors.iter().next().is_none();
        parsed.tree.file = file;
        parsed.tree.decls = declarations;
        if is_model {
            parsed.errors.extend(more.errors);
        } else {
            // No part of the file is a declaration, so its contents are not shown.
            parsed.tree.broken.retain(|span| span.file() != used);
            parsed.tree.no_models.push(used);
        }
    }
    parsed.tree.sort_docs();
    parsed
}

/// The files that `use` lines of a text name, each once, in order.
pub fn used_files(text: &str) -> Vec<String> {
    let mut files: Vec<String> = Vec::new();
    if !text.contains("use") {
        return files;
    }
    let mut seen = HashSet::new();
    let starts_use = |line: &&str| line.trim_start_matches([' ', '\t', '\u{feff}']).starts_with("use");
    for line in text.lines().filter(starts_use) {
        let rest = &line[line.find("use").map_or(0, |at| at + 3)..];
        let named = rest.trim_start_matches([' ', '\t']).strip_prefix('"').and_then(|rest| rest.split('"').next());
        if let Some(file) = named.filter(|file| seen.insert(*file)) {
            files.push(file.to_string());
        }
    }
    files
}

/// Parses the text of the tree's file and adds it to the tree.
fn parse_into(tree: Tree, text: &str) -> Parsed {
    let mut parse = Parse::new(text, tree);
    if text.len() > limits::FILE {
        parse.report.push_error(SyntaxError::FileLength { at: parse.span(0..1) });
        return parse.finish();
    }
    let mut pieces = Pieces::new(text);
    loop {
        let (cuts, recognised) = next_pieces(&mut pieces, text);
        if cuts.is_empty() {
            break;
        }
        for (cut, found) in cuts.into_iter().zip(recognised.iter().flat_map(|some| some.declarations())) {
            parse.piece(cut, found);
        }
    }
    parse.close_rest();
    parse.finish()
}

/// Parses a stand-alone value, such as that of `--set NAME=VALUE`; `None` if it is not an expression of the language.
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

/// Adds the measures of a file, one a line, to a tree; the first line that is no expression of the language, if there is one.
pub fn parse_asked(tree: &mut Tree, sources: &Sources, file: FileId) -> Result<(), Span> {
    let own = std::mem::replace(&mut tree.file, file);
    let mut start = 0;
    let read = sources.text(file).split_inclusive('\n').try_for_each(|line| {
        let (at, text) = (start, line.trim_end_matches('\n'));
        start += line.len();
        let brackets = text.bytes().filter(|byte| matches!(byte, b'(' | b'[')).count();
        let fits = text.len() <= limits::NUMBER && brackets <= limits::BRACKETS;
        let value = if fits { build::value(tree, text, at).ok() } else { None };
        tree.asked.push(value.ok_or(Span::new(file, at, at + text.len()))?);
        Ok(())
    });
    tree.file = own;
    read
}

/// A `repeat` or `component` whose `}` has not been reached.
struct Opened {
    range: Range<usize>,
    doc: Option<Range<usize>>,
    /// `None` if it does not match the grammar.
    head: Option<Head>,
    body: Vec<Decl>,
}

struct Parse<'a> {
    text: &'a str,
    tree: Tree,
    yard: Yard,
    report: Report,
    open: Vec<Opened>,
    /// The previous declaration lacks its `{`: everything up to the next keyword belongs to it.
    missing_brace: bool,
    /// Number of brackets reported as unclosed: as many closing ones may still follow, without another error.
    abandoned: usize,
}

impl<'a> Parse<'a> {
    fn new(text: &'a str, tree: Tree) -> Parse<'a> {
        Parse {
            text,
            tree,
            yard: Yard::default(),
            report: Report::default(),
            open: Vec::new(),
            missing_brace: false,
            abandoned: 0,
        }
    }

    fn finish(self) -> Parsed {
        Parsed { tree: self.tree, errors: self.report.finish() }
    }

    fn span(&self, range: Range<usize>) -> Span {
        Span::new(self.tree.file, range.start, range.end)
    }

    fn piece(&mut self, cut: Cut, found: Option<Declaration<'_>>) {
        match cut.piece {
            Piece::Declaration { .. } => {
                if let Some(Built::Decl(decl)) = self.build(&cut, found) {
                    self.push(decl, cut.doc);
                }
            }
            Piece::Open { .. } => self.open(cut, found),
            Piece::Close { at } => self.close(at + 1),
            Piece::Character { range } => {
                self.report_split_error(&range, SplitError::Character { range: range.clone() })
            }
            Piece::Stray { at } => self.report_stray(at),
        }
    }

    fn push(&mut self, decl: Decl, doc: Option<Range<usize>>) {
        if let Some(doc) = doc {
            self.tree.push_doc(decl.span.start(), self.span(doc));
        }
        let is_use = matches!(decl.kind, DeclKind::Rare { index } if matches!(self.tree.rare(index), Rare::Use { .. }));
        if is_use && !self.open.is_empty() {
            self.report.push_error(SyntaxError::InnerComponent { at: decl.span, keyword: "use" });
        }
        match self.open.last_mut() {
            Some(opened) => opened.body.push(decl),
            None => self.tree.decls.push(decl),
        }
    }

    /// Records a text that is not a declaration. Neighbours are merged, so that a file of nothing but such texts takes
    /// little memory.
    fn push_broken(&mut self, range: Range<usize>) {
        // A broken `repeat` contains the broken texts of its body.
        let file = self.tree.file;
        let here = |last: &Span| last.file() == file;
        while self.tree.broken.last().is_some_and(|last| here(last) && range.start <= last.start()) {
            self.tree.broken.pop();
        }
        if let Some(last) = self.tree.broken.last_mut().filter(|last| here(last)) {
            let adjacent = last.end() <= range.start && self.text[last.end()..range.start].trim().is_empty();
            if adjacent && range.end - last.start() < Span::MAX_LEN {
                *last = Span::new(last.file(), last.start(), range.end);
                return;
            }
        }
        self.tree.broken.push(self.span(range));
    }

    fn build(&mut self, cut: &Cut, found: Option<Declaration<'_>>) -> Option<Built> {
        let built = self.try_build(cut, found);
        if built.is_none() {
            self.push_broken(cut.range());
        }
        built
    }

    fn try_build(&mut self, cut: &Cut, found: Option<Declaration<'_>>) -> Option<Built> {
        let range = &cut.range();
        if self.missing_brace && self.belongs_to_headless(range) {
            return None;
        }
        if let Piece::Declaration { error: Some(error), .. } | Piece::Open { error: Some(error), .. } = &cut.piece {
            self.report_split_error(range, error.clone());
            return None;
        }
        self.tree.make_room(range.start, self.text.len());
        let mut blanked = String::new();
        let text = cut.text(self.text, &mut blanked);
        let built = found.map(|found| build::declaration(&mut self.tree, &mut self.yard, found, text, range.start));
        let refused = match built {
            Some(Ok(built)) => return Some(built),
            Some(Err(refused)) => refused,
            None => Refused::Grammar,
        };
        let error = match refused {
            Refused::Grammar if self.report.is_full() => {
                self.report.count(self.span(range.clone()));
                return None;
            }
            Refused::Grammar => self.explain(text, range.start),
            Refused::TooDeep(at) => SyntaxError::ExpressionDepth { at },
            Refused::LongWord(at) => SyntaxError::WordLength { at },
            Refused::LongNumber(at) => SyntaxError::NumberLength { at },
            Refused::Twice(at) => {
                let found = Some(explain::quoted_source(&self.text[at.range()]));
                SyntaxError::Unexpected { at, found, expected: Expected::LineEnd, remark: Remark::OnceEach }
            }
        };
        self.missing_brace = error.lacks_brace();
        self.abandoned += usize::from(self.missing_brace);
        self.report.push_error(error);
        None
    }

    /// Whether the previous declaration lacks its `{` and this text is not a declaration: most likely it is one of its
    /// fields.
    fn belongs_to_headless(&mut self, range: &Range<usize>) -> bool {
        let text = &self.text[range.clone()];
        let belongs = explain::declaration_of(text).is_none();
        self.missing_brace = belongs && !text.starts_with('{');
        belongs
    }

    fn explain(&self, text: &str, offset: usize) -> SyntaxError {
        let place = |at: Range<usize>| self.span(offset + at.start..offset + at.end);
        let Some(declaration) = explain::declaration_of(text) else {
            let at = explain::token_range(text, 0);
            let word = &text[at.clone()];
            let found = explain::quoted_source(word);
            return SyntaxError::UnknownKeyword {
                at: place(at.clone()),
                found,
                meant: guess_intent(word, &text[at.end..]),
            };
        };
        let problem = explain::explain(declaration, text);
        let (found, expected, remark) = (problem.found, problem.expected, problem.remark);
        SyntaxError::Unexpected { at: place(problem.at), found, expected, remark }
    }

    fn report_split_error(&mut self, range: &Range<usize>, error: SplitError) {
        if let SplitError::Unclosed { count, .. } = &error {
            self.abandoned += count;
        }
        let one = |at: usize| self.span(at..at + 1);
        let error = match error {
            SplitError::Unclosed { open, before, .. } => {
                let before = before.map(|before| self.span(before));
                SyntaxError::Unclosed { open: one(open), bracket: self.char_at(open), before, of: None }
            }
            SplitError::Mismatch { open, close } => SyntaxError::Mismatch {
                open: one(open),
                bracket: self.char_at(open),
                close: one(close),
                found: self.char_at(close),
            },
            SplitError::Stray { at } => return self.stray_inside(range, at),
            SplitError::Text { open } => SyntaxError::UnclosedString { open: one(open) },
            SplitError::Character { range } => {
                SyntaxError::Character { at: self.span(range.clone()), character: self.char_at(range.start) }
            }
            SplitError::Nesting { at } => SyntaxError::Nesting { at: one(at) },
            SplitError::Length => SyntaxError::DeclarationLength { at: self.span(range.start..range.start + 1) },
            SplitError::SameLine => {
                let at = explain::token_range(self.text, range.start);
                let found = Some(explain::quoted_source(&self.text[at.clone()]));
                let (expected, remark) = (Expected::LineEnd, Remark::LineOfItsOwn);
                SyntaxError::Unexpected { at: self.span(at), found, expected, remark }
            }
        };
        self.report.push_error(error);
    }

    fn char_at(&self, at: usize) -> char {
        self.text[at..].chars().next().unwrap_or('\n')
    }

    /// Reports a surplus closing bracket in a declaration. Most often its opening bracket is missing, and the error is
    /// where that belongs.
    fn stray_inside(&mut self, range: &Range<usize>, at: usize) {
        let before = self.text[range.start..at].trim_end();
        if explain::declaration_of(before).is_some() && !self.report.is_full() {
            let error = self.explain(before, range.start);
            if matches!(&error, SyntaxError::Unexpected { found: Some(_), expected, .. } if *expected != Expected::Form)
            {
                return self.report.push_error(error);
            }
        }
        self.report_stray(at);
    }

    fn report_stray(&mut self, at: usize) {
        if std::mem::take(&mut self.missing_brace) {
            return;
        }
        if self.abandoned > 0 {
            self.abandoned -= 1;
            return;
        }
        self.report.push_error(SyntaxError::Stray { at: self.span(at..at + 1), bracket: self.char_at(at) });
    }

    fn open(&mut self, cut: Cut, found: Option<Declaration<'_>>) {
        let range = cut.range();
        if self.open.len() == limits::REPEATS {
            self.report.push_error(SyntaxError::RepeatNesting { at: self.span(range.clone()) });
        }
        let head = match self.open.len() {
            // Reported once, for the outermost one that is too deep.
            limits::REPEATS.. => None,
            _ => match self.build(&cut, found) {
                Some(Built::Head(Head::Component(head))) if !self.open.is_empty() => {
                    self.report.push_error(SyntaxError::InnerComponent { at: head.name, keyword: "component" });
                    None
                }
                Some(Built::Head(head)) => Some(head),
                _ => None,
            },
        };
        self.open.push(Opened { range, doc: cut.doc, head, body: Vec::new() });
    }

    fn close(&mut self, end: usize) {
        let Some(Opened { range, doc, head, body }) = self.open.pop() else { return };
        let kind = match head {
            None => return self.push_broken(range.start..end),
            Some(Head::Repeat(RepeatHead { index, first, last })) => {
                self.tree.repeats.push(Repeat { index, first, last, body });
                DeclKind::Repeat { index: (self.tree.repeats.len() - 1) as u32 }
            }
            Some(Head::Component(ComponentHead { name, formals })) => {
                self.tree.components.push(Component { name, formals, body });
                DeclKind::Component { index: (self.tree.components.len() - 1) as u32 }
            }
        };
        self.push(Decl { span: self.span(range.start..end), kind }, doc);
    }

    /// Reports the `repeat`s that are still open at the end of the file, and closes them.
    fn close_rest(&mut self) {
        while let Some(opened) = self.open.last() {
            let open = opened.range.end - 1;
            let of =
                Some(if self.text[opened.range.clone()].starts_with("component") { "component" } else { "repeat" });
            let error = SyntaxError::Unclosed { open: self.span(open..open + 1), bracket: '{', before: None, of };
            self.report.push_error(error);
            self.close(self.text.len());
        }
    }
}

/// The likely intention behind a declaration that starts with this word.
fn guess_intent(word: &str, rest: &str) -> Intent {
    let is_word = word.starts_with(words::is_letter);
    if word.starts_with('#') {
        return Intent::Comment;
    }
    match rest.trim_start().chars().next() {
        Some('=') if is_word => Intent::Value,
        Some(':') if is_word => Intent::Part,
        _ => words::nearest(word).map_or(Intent::Nothing, Intent::Declaration),
    }
}
