//! Lines and columns of a text of any size, found without walking through the text for each place: a million findings
//! in a file of 50 MB cost a million short searches, not a million scans.

use super::source::Position;

/// The starts of the lines of a text, and the number of characters before each of its blocks.
///
/// A line ends with a line feed. Valid for one text; with another one the place is wrong, but nothing panics.
#[derive(Clone, Debug)]
pub struct LineIndex {
    /// Byte offset of the start of each line; the first is 0.
    starts: Vec<u32>,
    /// Number of characters that start before byte `BLOCK * i`.
    characters: Vec<u32>,
}

/// Maximum number of bytes that one search scans.
const BLOCK: usize = 1024;

impl LineIndex {
    pub fn new(text: &str) -> LineIndex {
        let bytes = text.as_bytes();
        let mut starts = vec![0];
        let mut characters = Vec::with_capacity(bytes.len() / BLOCK + 1);
        let mut seen = 0;
        for (number, block) in bytes.chunks(BLOCK).enumerate() {
            characters.push(seen as u32);
            seen += count_starts(block);
            let feeds = block.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
            starts.extend(feeds.map(|(at, _)| (number * BLOCK + at + 1) as u32));
        }
        LineIndex { starts, characters }
    }

    pub fn line_count(&self) -> usize {
        self.starts.len()
    }

    /// The line, from 0, that contains a byte offset; an offset beyond the end is in the last line.
    pub fn line(&self, offset: usize) -> usize {
        self.starts.partition_point(|start| *start as usize <= offset) - 1
    }

    /// The bytes of a line, from 0, without its line end. Empty after the last line.
    pub fn line_range(&self, text: &str, line: usize) -> std::ops::Range<usize> {
        let start_of = |line: usize| self.starts.get(line).map_or(text.len(), |start| *start as usize);
        let (start, next) = (start_of(line), start_of(line + 1));
        let whole = text.get(start..next).unwrap_or("");
        let content = whole.strip_suffix('\n').unwrap_or(whole);
        start..start + content.strip_suffix('\r').unwrap_or(content).len()
    }

    /// Line and column of a byte offset, both from 1, the column in characters.
    pub fn position(&self, text: &str, offset: usize) -> Position {
        let offset = offset.min(text.len());
        let line = self.line(offset);
        let start = self.starts[line] as usize;
        let column = self.characters_before(text, offset).saturating_sub(self.characters_before(text, start));
        Position { line: line + 1, column: column + 1 }
    }

    /// The number of characters that start before a byte offset.
    fn characters_before(&self, text: &str, offset: usize) -> usize {
        let Some(last) = self.characters.len().checked_sub(1) else { return 0 };
        let block = (offset / BLOCK).min(last);
        let rest = text.as_bytes().get(block * BLOCK..offset).unwrap_or(&[]);
        self.characters[block] as usize + count_starts(rest)
    }
}

/// Counts the bytes that are not continuation bytes of UTF-8, which is the number of characters that start here.
fn count_starts(bytes: &[u8]) -> usize {
    bytes.iter().filter(|byte| **byte & 0xc0 != 0x80).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::SourceFile;

    #[test]
    fn it_agrees_with_counting_from_the_start() {
        let text = "param ω = 1\r\n\n// ∑ of all\n".repeat(150) + "last";
        let (file, index) = (SourceFile::model("a.vib", text.clone()), LineIndex::new(&text));
        for offset in (0..=text.len()).filter(|offset| text.is_char_boundary(*offset)) {
            assert_eq!(index.position(&text, offset), file.position(offset), "at {offset}");
        }
    }

    #[test]
    fn lines_come_without_their_ends() {
        let text = "one\r\ntwo\n";
        let index = LineIndex::new(text);
        let lines: Vec<&str> = (0..=index.line_count()).map(|line| &text[index.line_range(text, line)]).collect();
        assert_eq!(lines, ["one", "two", "", ""]);
    }

    #[test]
    fn an_empty_text_has_one_line() {
        let index = LineIndex::new("");
        assert_eq!((index.line_count(), index.position("", 5)), (1, Position { line: 1, column: 1 }));
    }
}
