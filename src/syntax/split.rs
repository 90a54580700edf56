//! Splits a file's text into declarations: the start and end of each, and the brackets and quotes that do not match.
//!
//! In: the text. Out: [`Piece`]s, in order. One pass over the bytes; only the open brackets of the current declaration
//! are kept. A declaration ends at the first line end outside all brackets; the body of a `repeat` or `component` is a
//! list of declarations of its own. If a bracket stays open, the next line that looks like the start of a declaration
//! starts one: no field and no expression has a line of the form `body b`. See spec.md#declarations.

use super::limits;
use super::words;
use std::ops::Range;

/// A piece of the text: a declaration, the start or the end of a `repeat`, or an error between declarations.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Piece {
    /// A declaration without blanks and comments around it.
    Declaration { range: Range<usize>, error: Option<SplitError> },
    /// The head of a `repeat` or `component`, its `{` included.
    Open { range: Range<usize>, error: Option<SplitError> },
    /// The `}` of a `repeat` or `component`.
    Close { at: usize },
    /// A character that is not allowed anywhere, in a comment or between declarations.
    Character { range: Range<usize> },
    /// A `)`, `]` or `}` between declarations.
    Stray { at: usize },
}

/// The first error in a declaration that shows before its words are read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum SplitError {
    /// Unclosed brackets: the innermost, their number, and the keyword that starts the next declaration.
    Unclosed { open: usize, count: usize, before: Option<Range<usize>> },
    /// A bracket that is closed by one of another kind.
    Mismatch { open: usize, close: usize },
    /// A closing bracket without its opening one.
    Stray { at: usize },
    /// A string without its closing quote.
    Text { open: usize },
    /// A character that is not allowed anywhere.
    Character { range: Range<usize> },
    /// More brackets inside each other than [`limits::BRACKETS`].
    Nesting { at: usize },
    /// Longer than [`limits::DECLARATION`].
    Length,
    /// Starts on the line on which a `repeat` ends.
    SameLine,
}

/// The declarations of a text.
pub(super) struct Pieces<'a> {
    bytes: &'a [u8],
    text: &'a str,
    at: usize,
    /// Open `repeat`s and `component`s.
    repeats: usize,
    /// Whether there were only blanks since the line began or a `repeat` was opened.
    fresh: bool,
    /// The `///` lines since the last declaration.
    doc: Option<Range<usize>>,
    /// The comments inside the current declaration.
    comments: Vec<Range<usize>>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Class {
    Plain,
    Blank,
    LineEnd,
    Slash,
    Quote,
    Open,
    Close,
    /// Part of a character outside ASCII.
    High,
    Control,
}

const CLASSES: [Class; 256] = classes();

const fn classes() -> [Class; 256] {
    let mut table = [Class::Plain; 256];
    let mut byte = 0;
    while byte < 256 {
        table[byte] = match byte as u8 {
            b' ' | b'\t' => Class::Blank,
            b'\n' => Class::LineEnd,
            b'/' => Class::Slash,
            b'"' => Class::Quote,
            b'(' | b'[' | b'{' => Class::Open,
            b')' | b']' | b'}' => Class::Close,
            0x80.. => Class::High,
            0..0x20 | 0x7f => Class::Control,
            _ => Class::Plain,
        };
        byte += 1;
    }
    table
}

fn class(byte: u8) -> Class {
    CLASSES[byte as usize]
}

/// The brackets that are open in a declaration.
#[derive(Default)]
struct Brackets {
    open: Vec<usize>,
    /// Number of brackets beyond the limit, which are only counted.
    beyond: usize,
}

impl Brackets {
    fn is_empty(&self) -> bool {
        self.open.is_empty()
    }
}

fn closes(open: u8, close: u8) -> bool {
    matches!((open, close), (b'(', b')') | (b'[', b']') | (b'{', b'}'))
}

impl<'a> Pieces<'a> {
    pub fn new(text: &'a str) -> Pieces<'a> {
        let at = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        Pieces { bytes: text.as_bytes(), text, at, repeats: 0, fresh: true, doc: None, comments: Vec::new() }
    }

    /// The `///` lines before the declaration that came last.
    pub fn take_doc(&mut self) -> Option<Range<usize>> {
        self.doc.take()
    }

    /// The comments inside the declaration that came last, and possibly one after it.
    pub fn take_comments(&mut self) -> Vec<Range<usize>> {
        std::mem::take(&mut self.comments)
    }

    /// How far the text is read.
    pub fn at(&self) -> usize {
        self.at
    }

    fn byte(&self, at: usize) -> u8 {
        self.bytes.get(at).copied().unwrap_or(b'\n')
    }

    /// A forbidden character at `at`: a control character, which terminals obey, or one that reverses the display order,
    /// so that a reviewer sees a different text from the compiler (CVE-2021-42574).
    fn forbidden_character(&self, at: usize) -> Option<Range<usize>> {
        let len = match (class(self.byte(at)), self.byte(at)) {
            (Class::Control, b'\r') if self.byte(at + 1) == b'\n' => return None,
            (Class::Control, _) => 1,
            (_, 0xc2) if self.byte(at + 1) < 0xa0 => 2,
            (_, 0xe2)
                if matches!((self.byte(at + 1), self.byte(at + 2)), (0x80, 0xaa..=0xae) | (0x81, 0xa6..=0xa9)) =>
            {
                3
            }
            _ => return None,
        };
        Some(at..at + len)
    }

    /// Steps over a comment up to its line end; returns the first forbidden character in it.
    fn skip_comment(&mut self) -> Option<Range<usize>> {
        self.skip_until(|byte| byte == b'\n')
    }

    fn skip_until(&mut self, ends: impl Fn(u8) -> bool) -> Option<Range<usize>> {
        let mut found = None;
        while self.at < self.bytes.len() && !ends(self.bytes[self.at]) {
            if found.is_none() && matches!(class(self.bytes[self.at]), Class::Control | Class::High) {
                found = self.forbidden_character(self.at);
            }
            self.at += 1;
        }
        found
    }

    /// Steps over blanks, line ends and comments between declarations.
    fn skip_between(&mut self) -> Option<Piece> {
        while self.at < self.bytes.len() {
            match class(self.byte(self.at)) {
                Class::Blank => self.at += 1,
                Class::LineEnd => {
                    self.fresh = true;
                    self.at += 1;
                }
                Class::Slash if self.byte(self.at + 1) == b'/' => {
                    if let Some(range) = self.comment_between() {
                        return Some(Piece::Character { range });
                    }
                }
                Class::Control if self.byte(self.at) == b'\r' && self.byte(self.at + 1) == b'\n' => self.at += 1,
                _ => return None,
            }
        }
        None
    }

    /// Steps over a comment on a separate line or after a declaration. On a separate line, three slashes make it
    /// documentation.
    fn comment_between(&mut self) -> Option<Range<usize>> {
        let start = self.at;
        let forbidden = self.skip_comment();
        let comment = &self.text[start..self.at];
        if self.fresh && comment.starts_with("///") && !comment.starts_with("////") {
            let first = self.doc.as_ref().map_or(start, |doc| doc.start);
            self.doc = Some(first..start + comment.trim_end().len());
        }
        forbidden
    }

    fn next_piece(&mut self) -> Option<Piece> {
        if let Some(piece) = self.skip_between() {
            return Some(piece);
        }
        if self.at >= self.bytes.len() {
            return None;
        }
        let at = self.at;
        if class(self.byte(at)) == Class::Close {
            self.at += 1;
            if self.byte(at) == b'}' && self.repeats > 0 {
                self.repeats -= 1;
                self.fresh = false;
                return Some(Piece::Close { at });
            }
            return Some(Piece::Stray { at });
        }
        Some(self.declaration())
    }

    fn declaration(&mut self) -> Piece {
        let start = self.at;
        let mut end = start;
        let mut brackets = Brackets::default();
        let mut error = (!self.fresh).then_some(SplitError::SameLine);
        self.fresh = false;
        self.comments.clear();
        let mut before = None;
        let mut braces = false;
        while self.at < self.bytes.len() {
            let at = self.at;
            match class(self.byte(at)) {
                Class::Plain => {
                    self.skip_plain();
                    end = self.at;
                    continue;
                }
                Class::Blank => {}
                Class::LineEnd if brackets.is_empty() => break,
                Class::LineEnd => {
                    before = words::starts_declaration(&self.bytes[at + 1..])
                        .map(|word| at + 1 + word.start..at + 1 + word.end);
                    if before.is_some() {
                        break;
                    }
                }
                Class::Slash if self.byte(at + 1) == b'/' => {
                    let forbidden = self.skip_comment();
                    self.comments.push(at..self.at);
                    if let Some(range) = forbidden {
                        error.get_or_insert(SplitError::Character { range });
                    }
                    continue;
                }
                Class::Slash => end = at + 1,
                Class::Quote => {
                    if let Some(found) = self.skip_text() {
                        error.get_or_insert(found);
                    }
                    end = self.at;
                    continue;
                }
                Class::Open => {
                    end = at + 1;
                    let first_brace = self.byte(at) == b'{' && !std::mem::replace(&mut braces, true);
                    if first_brace && brackets.is_empty() && self.opens_repeat(start, at) {
                        self.at = end;
                        self.repeats += 1;
                        self.fresh = true;
                        return Piece::Open { range: start..end, error: error.or_else(|| too_long(start..end)) };
                    }
                    if brackets.open.len() < limits::BRACKETS {
                        brackets.open.push(at);
                    } else {
                        brackets.beyond += 1;
                        error.get_or_insert(SplitError::Nesting { at });
                    }
                }
                Class::Close => {
                    if self.byte(at) == b'}' && self.repeats > 0 && !self.closes_own(&brackets) {
                        break;
                    }
                    end = at + 1;
                    if let Some(found) = self.close(&mut brackets) {
                        error.get_or_insert(found);
                    }
                }
                Class::Control | Class::High => {
                    if let Some(range) = self.forbidden_character(at) {
                        self.at = range.end;
                        end = self.at;
                        error.get_or_insert(SplitError::Character { range });
                        continue;
                    }
                    if self.byte(at) != b'\r' {
                        end = at + 1;
                    }
                }
            }
            self.at += 1;
        }
        if let Some(&open) = brackets.open.last() {
            let count = brackets.open.len() + brackets.beyond;
            error.get_or_insert(SplitError::Unclosed { open, count, before });
        }
        Piece::Declaration { range: start..end, error: error.or_else(|| too_long(start..end)) }
    }

    /// Whether the `{` opens the body of a `repeat`, or of a declaration meant as one.
    fn opens_repeat(&self, start: usize, at: usize) -> bool {
        if at == start {
            return words::starts_declaration(self.bytes[at + 1..].trim_ascii_start()).is_some();
        }
        words::opens_repeat(&self.text[start..at])
    }

    fn skip_plain(&mut self) {
        while self.at < self.bytes.len() && class(self.bytes[self.at]) == Class::Plain {
            self.at += 1;
        }
    }

    /// Steps over a string; an unclosed one ends with its line.
    fn skip_text(&mut self) -> Option<SplitError> {
        let open = self.at;
        self.at += 1;
        let forbidden = self.skip_until(|byte| matches!(byte, b'"' | b'\n'));
        if self.byte(self.at) != b'"' {
            return Some(SplitError::Text { open });
        }
        self.at += 1;
        forbidden.map(|range| SplitError::Character { range })
    }

    /// Whether a `}` belongs to this declaration rather than to the enclosing `repeat`.
    fn closes_own(&self, brackets: &Brackets) -> bool {
        brackets.beyond > 0 || brackets.open.iter().any(|&open| self.byte(open) == b'{')
    }

    /// Matches the closing bracket at the current position with the open ones.
    fn close(&self, brackets: &mut Brackets) -> Option<SplitError> {
        let close = self.at;
        if brackets.beyond > 0 {
            brackets.beyond -= 1;
            return None;
        }
        let Some(&top) = brackets.open.last() else { return Some(SplitError::Stray { at: close }) };
        if closes(self.byte(top), self.byte(close)) {
            brackets.open.pop();
            return None;
        }
        match brackets.open.iter().rposition(|&open| closes(self.byte(open), self.byte(close))) {
            // The brackets inside the matching one were not closed.
            Some(matching) => brackets.open.truncate(matching),
            // In braces a line end ends a value, so the surplus bracket is the closing one.
            None if self.byte(top) == b'{' => return Some(SplitError::Stray { at: close }),
            None => {
                brackets.open.pop();
            }
        }
        Some(SplitError::Mismatch { open: top, close })
    }
}

impl Iterator for Pieces<'_> {
    type Item = Piece;

    fn next(&mut self) -> Option<Piece> {
        self.next_piece()
    }
}

fn too_long(range: Range<usize>) -> Option<SplitError> {
    (range.len() > limits::DECLARATION).then_some(SplitError::Length)
}
