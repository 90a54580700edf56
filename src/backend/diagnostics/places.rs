//! Lines and columns of many places: each file is indexed once, when it is first needed.

use crate::base::{FileId, LineIndex, Position, Sources, Span};
use std::cell::OnceCell;

pub struct Places<'a> {
    pub sources: &'a Sources,
    indices: Vec<OnceCell<LineIndex>>,
}

impl<'a> Places<'a> {
    pub fn new(sources: &'a Sources) -> Places<'a> {
        Places { sources, indices: vec![OnceCell::new(); sources.len()] }
    }

    pub fn lines(&self, file: FileId) -> &LineIndex {
        self.indices[file.0 as usize].get_or_init(|| LineIndex::new(self.sources.text(file)))
    }

    pub fn position(&self, file: FileId, offset: usize) -> Position {
        self.lines(file).position(self.sources.text(file), offset)
    }

    /// The start and the end of a span.
    pub fn positions(&self, span: Span) -> (Position, Position) {
        (self.position(span.file(), span.start()), self.position(span.file(), span.end()))
    }
}
