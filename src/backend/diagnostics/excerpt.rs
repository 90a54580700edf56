//! The few lines that a diagnostic points at, extracted from their files and made readable: everything that is drawn
//! around a place.
//!
//! Lines are clipped to the width of a screen and control characters are made visible, so the excerpt has offsets of
//! its own: a label knows its place in the excerpt as well as its line and column in the file.

use super::places::Places;
use crate::base::readable::{readable, visible};
use crate::base::{Diagnostic, FileId, Label, OrderBy, Position};
use miette::{LabeledSpan, MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use std::ops::Range;

/// Lines shown above and below a place.
pub const CONTEXT: usize = 1;
/// A place that covers more lines is represented by its first line.
const MAX_LINES: usize = 6;
/// Longer lines are clipped around the place, in characters.
const MAX_COLUMNS: usize = 90;
/// Characters kept before a place in a clipped line.
const LEAD: usize = 30;

/// Windows into files, one after another in one text.
#[derive(Debug, Default)]
pub struct Excerpt {
    windows: Vec<Window>,
    /// Each label's place in the excerpt, and where it starts in its file.
    labels: Vec<(LabeledSpan, Position)>,
}

/// Consecutive lines of one file.
#[derive(Debug)]
struct Window {
    name: String,
    /// Number of the first line, from 0.
    first_line: usize,
    /// Offset of the text in the excerpt.
    start: usize,
    /// Lines, each with its line feed.
    text: String,
    /// Offset of each line in `text`.
    lines: Vec<usize>,
}

/// A label and the lines that it covers, from 0.
struct Mark<'a> {
    label: &'a Label,
    primary: bool,
    lines: Range<usize>,
    /// Bytes of the file, clipped to the shown part.
    bytes: Range<usize>,
}

impl Excerpt {
    pub fn new(places: &Places, diagnostic: &Diagnostic) -> Excerpt {
        let marks = marks(places, diagnostic);
        let mut excerpt = Excerpt::default();
        for file in files(&marks) {
            let marks: Vec<&Mark> = marks.iter().filter(|mark| mark.label.span.file() == file).collect();
            for lines in windows(places, file, &marks) {
                excerpt.add_window(places, file, lines, &marks);
            }
        }
        excerpt
    }

    pub fn labels(&self) -> impl Iterator<Item = LabeledSpan> {
        self.labels.iter().map(|(label, _)| label.clone())
    }

    /// Adds the lines and every mark in them.
    fn add_window(&mut self, places: &Places, file: FileId, lines: Range<usize>, marks: &[&Mark]) {
        let start = self.windows.last().map_or(0, |window| window.start + window.text.len() + 1);
        let name = readable(&places.sources.file(file).name).into_owned();
        let mut window = Window { name, first_line: lines.start, start, text: String::new(), lines: Vec::new() };
        let inside: Vec<&&Mark> = marks.iter().filter(|mark| lines.contains(&mark.lines.start)).collect();
        // Offsets in the excerpt of both ends of each mark, known once their lines are written.
        let mut ends = vec![(0, 0); inside.len()];
        for line in lines {
            let bytes = places.lines(file).line_range(places.sources.text(file), line);
            let shown = window.push_line(places.sources.text(file), bytes, line, &inside);
            for (mark, end) in inside.iter().zip(&mut ends) {
                if mark.lines.start == line {
                    end.0 = start + shown.offset(mark.bytes.start);
                }
                if mark.lines.end - 1 == line {
                    end.1 = start + shown.offset(mark.bytes.end);
                }
            }
        }
        for (mark, (from, to)) in inside.iter().zip(ends) {
            let text = (!mark.label.text.is_empty()).then(|| readable(&mark.label.text).into_owned());
            let span = (from, to.saturating_sub(from));
            let label = if mark.primary {
                LabeledSpan::new_primary_with_span(text, span)
            } else {
                LabeledSpan::new_with_span(text, span)
            };
            self.labels.push((label, places.position(file, mark.label.span.start())));
        }
        self.windows.push(window);
    }

    fn position_of(&self, span: &SourceSpan) -> Option<Position> {
        self.labels.iter().find(|(label, _)| label.inner() == span).map(|(_, position)| *position)
    }
}

/// Every label of a diagnostic, the primary one first.
fn marks<'a>(places: &Places, diagnostic: &'a Diagnostic) -> Vec<Mark<'a>> {
    let labels =
        std::iter::once((&diagnostic.primary, true)).chain(diagnostic.related.iter().map(|label| (label, false)));
    labels.map(|(label, primary)| mark(places, label, primary)).collect()
}

fn mark<'a>(places: &Places, label: &'a Label, primary: bool) -> Mark<'a> {
    let span = label.span;
    let (text, lines) = (places.sources.text(span.file()), places.lines(span.file()));
    let end = span.end().min(text.len()).max(span.start());
    let first = lines.line(span.start());
    // A span that ends at the start of a line does not cover it.
    let last = lines.line(end.saturating_sub(1).max(span.start()));
    if last - first < MAX_LINES {
        return Mark { label, primary, lines: first..last + 1, bytes: span.start()..end };
    }
    let line_end = lines.line_range(text, first).end.max(span.start());
    Mark { label, primary, lines: first..first + 1, bytes: span.start()..line_end }
}

/// The files of the marks, the primary one first.
fn files(marks: &[Mark]) -> Vec<FileId> {
    let mut files: Vec<FileId> = Vec::new();
    for mark in marks {
        if !files.contains(&mark.label.span.file()) {
            files.push(mark.label.span.file());
        }
    }
    files
}

/// The lines of a file to show: those of the marks with their context, merged if they touch.
fn windows(places: &Places, file: FileId, marks: &[&Mark]) -> Vec<Range<usize>> {
    let text = places.sources.text(file);
    // The empty line after the last line feed is not shown, unless it is the place itself.
    let count = places.lines(file).line_count() - usize::from(text.ends_with('\n'));
    let end = |mark: &&Mark| (mark.lines.end + CONTEXT).min(count).max(mark.lines.end);
    let around = |mark: &&Mark| mark.lines.start.saturating_sub(CONTEXT)..end(mark);
    let mut wanted: Vec<Range<usize>> = marks.iter().map(around).collect();
    wanted.order_by_key(|lines| lines.start);
    let mut merged: Vec<Range<usize>> = Vec::new();
    for lines in wanted {
        match merged.last_mut() {
            Some(last) if lines.start <= last.end => last.end = last.end.max(lines.end),
            _ => merged.push(lines),
        }
    }
    merged
}

/// A line as it was written into a window.
struct Shown<'a> {
    /// The shown bytes of the file.
    bytes: Range<usize>,
    content: &'a str,
    /// Offset in the window's text of the first shown byte.
    start: usize,
}

impl Shown<'_> {
    /// Offset in the window's text of a byte of the file; clipped to what is shown.
    fn offset(&self, byte: usize) -> usize {
        let within = byte.clamp(self.bytes.start, self.bytes.end) - self.bytes.start;
        let before = self.content.char_indices().take_while(|(at, _)| *at < within).map(|(_, c)| shown_char(c));
        self.start + before.map(char::len_utf8).sum::<usize>()
    }
}

impl Window {
    /// Writes a line, clipped around the mark in it, the primary one first.
    fn push_line<'a>(&mut self, text: &'a str, bytes: Range<usize>, line: usize, marks: &[&&Mark]) -> Shown<'a> {
        let content = text.get(bytes.clone()).unwrap_or("");
        let of_interest = marks.iter().filter(|mark| mark.lines.start == line).min_by_key(|mark| !mark.primary);
        let clip = clip(content, of_interest.map_or(0, |mark| mark.bytes.start.saturating_sub(bytes.start)));
        self.lines.push(self.text.len());
        if clip.start > 0 {
            self.text.push('…');
        }
        let start = self.text.len();
        self.text.extend(content[clip.clone()].chars().map(shown_char));
        if clip.end < content.len() {
            self.text.push('…');
        }
        self.text.push('\n');
        Shown { bytes: bytes.start + clip.start..bytes.start + clip.end, content: &content[clip], start }
    }

    fn contains(&self, span: &SourceSpan) -> bool {
        self.start <= span.offset() && span.offset() + span.len() <= self.start + self.text.len()
    }

    /// The line that contains an offset of the window's text.
    fn line(&self, offset: usize) -> usize {
        self.lines.partition_point(|start| *start <= offset).saturating_sub(1)
    }
}

/// Tabs are kept: the drawing aligns the marks below them.
fn shown_char(c: char) -> char {
    if c == '\t' { c } else { visible(c) }
}

/// The part of a line that is shown when the place of interest is at byte `at`.
fn clip(content: &str, at: usize) -> Range<usize> {
    let boundary = |characters: usize, from: usize| {
        content[from..].char_indices().nth(characters).map_or(content.len(), |(offset, _)| from + offset)
    };
    // This many bytes contain at most as many characters, so short lines need no counting.
    if content.len() <= MAX_COLUMNS || boundary(MAX_COLUMNS, 0) == content.len() {
        return 0..content.len();
    }
    let at = (0..=at.min(content.len())).rev().find(|at| content.is_char_boundary(*at)).unwrap_or(0);
    let start = content[..at].char_indices().rev().nth(LEAD - 1).map_or(0, |(offset, _)| offset);
    start..boundary(MAX_COLUMNS, start)
}

impl SourceCode for Excerpt {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let window = self.windows.iter().find(|window| window.contains(span)).ok_or(MietteError::OutOfBounds)?;
        let from = span.offset() - window.start;
        let to = from + span.len();
        let first = window.line(from).saturating_sub(before);
        let last = (window.line(to.saturating_sub(1).max(from)) + after).min(window.lines.len() - 1);
        let data = if before == 0 { from } else { window.lines[first] }
            ..window.lines.get(last + 1).copied().unwrap_or(window.text.len());
        // A call without context asks for the position of the span's start in the file.
        let place = if before == 0 { self.position_of(span) } else { None };
        let (line, column) = place.map_or((window.first_line + first, 0), |place| (place.line - 1, place.column - 1));
        Ok(Box::new(MietteSpanContents::new_named(
            window.name.clone(),
            &window.text.as_bytes()[data.clone()],
            (window.start + data.start, data.len()).into(),
            line,
            column,
            last + 1 - first,
        )))
    }
}
